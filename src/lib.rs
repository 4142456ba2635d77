//! Planar mechanisms with one degree of freedom as FMUs for co-simulation.
//!
//! A linkage with one degree of freedom moves along a curve in configuration space. The curve is computed once, and its
//! parameter is its length sigma in the kinetic metric, T = sigma_dot^2 / 2. Influences of loads, coordinates and
//! reactions are tables over sigma. A step integrates sigma_ddot = sum of load sizes times influences.
//!
//! From low to high, where each layer uses only the layers before it: [`numerics`], [`codec`], [`variables`],
//! [`mod@format`], [`inspection`], [`integrator`], of the crate `linkage-fmu-foundation`; [`hydraulics`], models of the
//! crate `linkage-fmu-hydraulics`; [`mechanism`], the first kind of model; [`component`], any kind of
//! model; [`simulation`], its variables by name for Rust; [`fmi`], what all versions of the standard share; [`fmi2`],
//! FMI 2.0; [`fmi3`], FMI 3.0.
//!
//! # Notation
//! SI units; angles in rad, anticlockwise positive; the mechanism frame is fixed to the ground. theta, omega, alpha: an
//! angle and its rates. q: coordinates. S: displacement of a load, along which a unit load does
//! work. A time rate ends in
//! `_dot`, a derivative along the curve in `_sigma`. [HF08] is Hac and From (2008), [CK16] Cink and Kosucki (2016).
//!
//! # Invariants
//! No allocation, lock or text in a step, a get or a set. A call that returns an error changes nothing. Inputs and
//! outputs are finite. An element that does not act costs nothing. `ARCHITECTURE.md` names the test that guards each.
pub use ::hydraulics;
pub use foundation::{codec, format, inspection, integrator, numerics, variables};

pub mod component;
pub mod fmi;
pub mod fmi2;
pub mod fmi3;
pub mod mechanism;
pub mod simulation;
