//! Coupling of a mechanism and its hydraulic actuator: every scheme, measured.
//!
//! In: two FMUs, or models in closed form. Out: error against communication step for each scheme. The host is for
//! measuring; users couple with the masters that they have.
pub mod circuit;
pub mod fmus;
pub mod models;
mod page;
pub mod pair;
pub mod scenes;
pub mod schemes;

pub use page::table;
