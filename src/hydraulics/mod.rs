//! Hydraulic actuators: a servo valve, a differential cylinder and the oil between them.
//!
//! In: the definition of a circuit, the motion of the cylinder, valve commands. Out: pressures, flows, the force, energy
//! terms. It must not know what the cylinder moves, nor FMI.
pub mod circuit;
pub mod definition;
