//! Derivatives of initial values with respect to parameters, and the variables that a host may set after the
//! initialisation.

use crate::host::Gear;
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::fmi2::{fmi2GetDirectionalDerivative, fmi2SetReal};

/// Derivative of an unknown with respect to a known.
fn derivative(gear: &Gear, unknown: &str, known: &str) -> Result<f64, Status> {
    let (unknown, known, mut value) = (gear.vr(unknown), gear.vr(known), f64::NAN);
    // SAFETY: one element each.
    let status = unsafe { fmi2GetDirectionalDerivative(gear.c, &unknown, 1, &known, 1, &1.0, &mut value) };
    if status == Status::Ok { Ok(value) } else { Err(status) }
}

/// A gear in initialization mode.
fn initializing() -> Gear {
    let gear = Gear::new();
    assert_eq!((gear.set_up(None, 0.0, None), gear.enter()), (Status::Ok, Status::Ok));
    gear
}

#[test]
fn initial_values_have_derivatives_along_parameters() {
    let gear = initializing();
    let of = |unknown: &str, known: &str| derivative(&gear, unknown, known).unwrap();
    // Closed form: the start states the angle and the speed. The energy is linear in a mass and quadratic in the speed.
    assert!((of("crank.angle", "crank.start_angle") - 1.0).abs() < 1e-11);
    assert!((of("crank.speed", "crank.start_speed") - 1.0).abs() < 1e-11);
    // Error: the rounding of an angle of 0.8 rad, divided by the change.
    assert!(of("crank.angle", "wheel.mass").abs() < 1e-12);
    assert_eq!(gear.set("crank.start_speed", 2.0), Status::Ok);
    let energy = gear.get("energy.kinetic").unwrap();
    assert!((of("energy.kinetic", "crank.start_speed") - energy).abs() < 1e-9 * energy);
    // Against a finite difference with respect to a length that moves every body.
    let length = gear.get("crank.length").unwrap();
    let at = |h: f64| {
        assert_eq!(gear.set("crank.length", length + h), Status::Ok);
        gear.get("actuator.length").unwrap()
    };
    let h = 1e-5;
    let difference = (at(h) - at(-h)) / (2.0 * h);
    at(0.0);
    let exact = of("actuator.length", "crank.length");
    assert!((exact - difference).abs() < 1e-8 * exact.abs().max(1.0), "{exact} {difference}");
    // With respect to an input the derivative is exact, as in motion.
    assert!(of("crank.acceleration", "actuator.force") != 0.0);
    // A parameter at its lower limit 0.
    assert_eq!(gear.get("upstop.restitution"), Ok(0.0));
    assert!(of("crank.angle", "upstop.restitution").abs() < 1e-12);
}

#[test]
fn discrete_outputs_have_the_derivative_0() {
    let gear = initializing();
    for (unknown, known) in [
        ("retracted", "actuator.force"),
        ("retracted", "crank.start_angle"),
        ("crank.acceleration", "uplock.engage"),
        ("crank.acceleration", "friction.enabled"),
        ("crank.acceleration", "solver.method"),
    ] {
        assert_eq!(derivative(&gear, unknown, known), Ok(0.0), "{unknown} along {known}");
    }
    assert_eq!(gear.exit(), Status::Ok);
    assert_eq!(derivative(&gear, "retracted", "actuator.force"), Ok(0.0));
    assert_eq!(derivative(&gear, "crank.acceleration", "uplock.engage"), Ok(0.0));
    // Parameters are knowns of initial values only.
    assert_eq!(derivative(&gear, "crank.acceleration", "crank.start_angle"), Err(Status::Error));
    assert_eq!(derivative(&gear, "crank.acceleration", "friction.enabled"), Err(Status::Error));
}

#[test]
fn tunable_parameters_are_set_between_steps_and_others_are_not() {
    let gear = Gear::stepping(0.0, None);
    assert_eq!(gear.step(0.0, 1e-3), Status::Ok);
    assert_eq!(gear.set("friction.kinetic_coefficient", 0.1), Status::Ok);
    assert_eq!(gear.get("friction.kinetic_coefficient"), Ok(0.1));
    assert_eq!(gear.set("solver.tolerance", 1e-6), Status::Ok);
    for name in ["crank.mass", "crank.start_angle"] {
        gear.log.take();
        assert_eq!(gear.set(name, 1.0), Status::Error);
        assert!(gear.refusal().contains("is a fixed parameter"), "{name}");
    }
    // All values are set or none: a valid value before a value out of range, and before a fixed parameter.
    let air = gear.vr("air.density");
    for (second, value) in [("upstop.restitution", 2.0), ("crank.mass", 1.0)] {
        // SAFETY: two elements each.
        let status = unsafe { fmi2SetReal(gear.c, [air, gear.vr(second)].as_ptr(), 2, [2.0, value].as_ptr()) };
        assert_eq!(status, Status::Error);
        assert_eq!(gear.get("air.density"), Ok(1.225));
    }
    assert_eq!(gear.step(1e-3, 1e-3), Status::Ok);
    assert_eq!(gear.reset(), Status::Ok);
    assert_eq!(gear.get("friction.kinetic_coefficient"), Ok(0.026));
}
