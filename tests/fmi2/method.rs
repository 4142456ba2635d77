//! `solver.method` through the C interface: the run is bit-identical to a run without FMI.
use crate::host::Gear;
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::simulation::Simulation;

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");
/// E A of the gear's bodies, [N], and the step of the finite elements [s].
const SETTINGS: [(&str, f64); 4] = [
    ("crank.axial_stiffness", 2.1e9),
    ("coupler.axial_stiffness", 8.937_60e7),
    ("follower.axial_stiffness", 3.049_20e8),
    ("solver.fem_step", 1e-5),
];

#[test]
fn finite_elements_through_the_interface_are_the_native_ones() {
    let (gear, mut native) = (Gear::new(), Simulation::open(GEAR).unwrap());
    assert_eq!(gear.set_item("solver.method", "rigid_fem"), Status::Ok);
    native.set("solver.method", "rigid_fem").unwrap();
    for (name, value) in SETTINGS {
        assert_eq!(gear.set(name, value), Status::Ok, "{name}");
        native.set(name, value).unwrap();
    }
    assert_eq!(gear.initialize(), Status::Ok, "{:?}", gear.log.take());
    native.initialize().unwrap();
    for n in 0..130 {
        assert_eq!(gear.step(f64::from(n) * 1e-3, 1e-3), Status::Ok, "{:?}", gear.log.take());
        native.step(1e-3).unwrap();
        let [own, other] = [gear.get("crank.angle").unwrap(), native.get("crank.angle").unwrap()];
        assert_eq!(own.to_bits(), other.to_bits(), "step {n}: {own} {other}");
    }
}
