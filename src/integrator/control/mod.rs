//! Control of an integration: its memory from step to step, the choice of the method, step sizes.
//!
//! In: a system, a point, a span, a tolerance. Out: accepted steps and the work they took. It must not know the
//! formulas of the methods.
mod advance;
mod choice;
mod inverse_root;
mod memory;
mod sizes;
pub mod stiffness;

pub use memory::Integrator;
