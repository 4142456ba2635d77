//! Outputs on demand, at the present state under the present inputs.
//!
//! In: a formulation of the motion. Out: values of outputs and their exact derivatives. It must not know references or
//! FMI.
mod by_body;
mod cache;
mod controllers;
mod evaluator;
mod hydraulic;
mod network;
mod one_element;
mod reaction;
mod reduced_motion;
mod tabulated;
mod terms;
mod view;

pub use cache::{Computed, of_state};
pub use evaluator::{Kinematics, OutputError, evaluate};
pub use hydraulic::allow_hydraulics;
pub use reduced_motion::{ReducedMotion, Together};
pub use view::View;
