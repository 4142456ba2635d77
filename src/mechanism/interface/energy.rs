//! Variables of the energy balance.
use super::builder::Builder;
use super::needs::{NONE, Needs, PLACED};
use crate::mechanism::quantity::Output;
use crate::variables::Unit::Joule;

pub(super) fn add(b: &mut Builder) {
    let loading = &b.source.loading;
    let gravity = loading.gravity.as_slice();
    let stored: Vec<usize> = gravity.iter().copied().chain(loading.sized()..loading.base()).collect();
    let kinetic = Needs { speed: true, inertia: true, ..PLACED };
    let potential = Needs { inputs: gravity, loads: &stored, ..PLACED };
    b.output("energy", "kinetic", &["Kinetic energy"], Joule, Output::Kinetic, kinetic);
    let text = "Potential energy of gravity at the present load factor, and of springs";
    b.output("energy", "potential", &[text], Joule, Output::Potential, potential);
    let text = "Energy now less energy at the start less work done: the error of the integration";
    b.output("energy", "drift", &[text], Joule, Output::Drift, NONE);
}
