//! Outputs on demand, at the present state under the present inputs.
//!
//! In: a formulation of the motion. Out: values of outputs and their exact derivatives. It must not know references or FMI.
mod cache;
mod error;
mod evaluator;
mod one_element;
mod panel_reaction;
mod reaction;
mod reduced_motion;
mod sensitivity;
mod view;

pub use cache::Computed;
pub use error::OutputError;
pub use evaluator::{Kinematics, evaluate};
pub use reduced_motion::ReducedMotion;
