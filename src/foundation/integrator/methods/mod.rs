//! The five methods, each as the stages of one step.
//!
//! In: a system, the start of a step, a step size. Out: the end of the step, its error estimate, its interpolant. Must
//! not know: how step sizes and methods are chosen, the other methods.
pub mod dop853;
pub mod dopri5;
pub mod radau;
pub mod rk4;
pub mod rkn86;
