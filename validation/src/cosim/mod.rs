//! Coupling of a mechanism and its hydraulic actuator: measurement of every scheme.
//!
//! In: two FMUs, or models in closed form. Out: error over communication step for each scheme. The host serves
//! measurements only; users couple with their own masters.
pub mod circuit;
pub mod fmus;
pub mod models;
mod page;
pub mod pair;
pub mod scenes;
pub mod schemes;

pub use page::table;
