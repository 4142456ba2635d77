//! The rigid ends of the cylinder are stops of the mechanism.
use super::*;

/// The retraction without stops, in a cylinder with a shorter stroke.
fn extension(restitution: f64) -> Run {
    let mut gear = Run::shared(HYDRAULIC_GEAR);
    gear.set_all(&[("downstop.enabled", false), ("upstop.enabled", false)]);
    gear.set_all(&[
        ("cylinder.stroke", 0.31),
        ("cylinder.restitution", restitution),
        ("cushion_b.length", 0.0),
        ("command.ramp_amplitude", 0.65),
        ("command.ramp_time", 0.1),
        ("solver.tolerance", 1e-10),
    ]);
    gear.started()
}

/// At the end, the cylinder carries the excess of the oil force over the load. The opposite command moves the piston
/// off the end.
#[test]
fn the_piston_rests_on_the_end_of_its_cylinder() {
    for restitution in [0.0, 0.5] {
        let mut gear = extension(restitution);
        gear.steps(50, 5.0);
        assert_eq!(gear.get("crank.speed"), 0.0);
        gear.near("cylinder.stroke_position", 0.31, 1e-12);
        let [oil, end, load] =
            ["actuator.force", "cylinder.end_force", "actuator.holding_force"].map(|name| gear.get(name));
        assert!(end < -2e4 && (oil + end - load).abs() < 1e-9 * oil, "{oil} {end} {load}");
        assert_eq!(gear.get("actuator.upper_limit"), gear.get("actuator.length"));
        balances(&mut gear, 1e-7);
        gear.set("valve.command", -1.3);
        gear.steps(10, 0.5);
        assert!(gear.get("cylinder.stroke_position") < 0.29 && gear.get("cylinder.end_force") == 0.0);
        balances(&mut gear, 1e-7);
    }
}

/// Communication steps from 1 ms to 5 s give the same rest position.
#[test]
fn the_end_is_reached_with_any_step() {
    let angle = |steps: u32| {
        let mut gear = extension(0.3);
        gear.steps(steps, 5.0);
        (gear.get("crank.angle"), gear.get("cylinder.end_force"))
    };
    let [one, some, many] = [1, 70, 5000].map(angle);
    assert!(one.0 == some.0 && one.0 == many.0);
    assert!((one.1 / many.1 - 1.0).abs() < 1e-6 && (some.1 / many.1 - 1.0).abs() < 1e-6, "{one:?} {some:?} {many:?}");
}

/// A stop of the mechanism before the end of the cylinder acts. A stop beyond the end never acts.
#[test]
fn the_first_of_stop_and_end_acts() {
    let mut gear = retraction(1e-8);
    gear.steps(50, 5.0);
    assert!(gear.is("retracted") && gear.get("upstop.torque") != 0.0 && gear.get("cylinder.end_force") == 0.0);
    let mut gear = retraction(1e-8).with(&[("cylinder.stroke", 0.31)]).started();
    gear.steps(50, 5.0);
    assert!(!gear.is("retracted") && gear.get("upstop.torque") == 0.0 && gear.get("cylinder.end_force") < 0.0);
}

/// If the piston never reaches an end, the ends of the cylinder do not change the results: bit-identical.
#[test]
fn an_end_that_is_not_reached_changes_nothing() {
    let run = |stroke: f64| {
        let mut gear = vibration(1e-9).with(&[("cylinder.stroke", stroke)]);
        // Equal chamber volumes: the dead volume decreases by the additional volume of the longer stroke.
        let area = 0.25 * std::f64::consts::PI * (0.045_f64.powi(2) - 0.025_f64.powi(2));
        gear.set("chamber_b.dead_volume", 1e-4 - area * (stroke - 0.33));
        let mut gear = gear.started();
        gear.steps(100, 1.0);
        gear.get("crank.angle")
    };
    let (near, far) = (run(0.33), run(0.34));
    assert!((near - far).abs() < 1e-13, "{near} {far}");
}
