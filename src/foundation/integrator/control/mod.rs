//! Control of an integration: its memory between steps, the choice of the method, step sizes.
//!
//! In: a system, a point, a span, a tolerance. Out: accepted steps and their work. Must not know: the formulas of the
//! methods.
mod advance;
mod choice;
mod inverse_root;
mod memory;
mod sizes;
pub mod stiffness;

pub use memory::Integrator;
