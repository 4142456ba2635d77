//! What all models share: tables and numbers, records in bytes, variables, definitions as JSON, and integrators.
//!
//! From low to high, where each module uses only the modules before it: [`numerics`], [`codec`], [`variables`],
//! [`mod@format`], [`inspection`], [`integrator`]. Must not know: any kind of model.
pub mod codec;
pub mod format;
pub mod inspection;
pub mod integrator;
pub mod numerics;
pub mod variables;
