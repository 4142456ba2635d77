//! The rigid-link finite element method of [HF08] section 3: a second formulation, independent of the reduced model.
//!
//! In: a linkage of binary links with revolute joints, its loads, and an axial stiffness of each body. Out: the motion
//! of the nodes by Newmark's method, with the bodies' angles, the joints' forces and energies. It must not know the
//! curve.
//!
//! The unknowns are the positions x of the joints' points. Each body is one element ([`element`]): its exact inertia in
//! terms of its two nodes, and a rod whose stiffness E A / L resists a change of length. The equations of motion are
//!
//! ```text
//! M(x) a + c(x, v) + f(x) = Q(x, v)
//! ```
//!
//! with the mass matrix of eq. (19), the rods' forces f of eq. (18), both turned by the present angle (eqs. (22)-(25)),
//! and the loads Q by virtual work. All follow from one Lagrangian, so energy is conserved for any E A. As E A grows,
//! the motion tends to that of rigid links, with a difference proportional to 1 / (E A): the elastic limit.
pub mod element;
mod error;
mod lu;
mod mesh;
mod model;
mod newmark;
mod nodal_load;
mod outputs;
mod start;

pub use error::RigidFemError;
pub use model::{RigidFem, State};
pub use newmark::{Scratch, substeps};
