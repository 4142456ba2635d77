//! Two shafts with one coupling: motion, transmitted force, and direction of the contact force.
use super::{BELT, GEARS, assert_near, shafts};
use crate::support::{Run, Vec2};

/// Check motion and transmitted force of two shafts with the speed ratio i: inertia J1 + i^2 J2 at the first shaft,
/// motor 3 N.m, load -1 N.m. Returns the run and the transmitted force.
fn check_shafts(coupling: &str, ratio: f64, arm: f64) -> (Run, f64) {
    let mut run = Run::new(shafts(coupling)).started();
    let acceleration = (3.0 - ratio) / (0.02 + ratio * ratio * 0.5);
    run.steps(10, 0.5);
    let t = 0.5;
    let angle = 0.4 + 0.5 * acceleration * t * t;
    assert_near(run.get("one.acceleration"), acceleration, acceleration.abs(), "acceleration");
    assert_near(run.get("two.acceleration"), ratio * acceleration, acceleration.abs(), "acceleration of the second");
    assert!((run.get("one.speed") - acceleration * t).abs() < 1e-8 * acceleration.abs());
    assert!((run.get("one.angle") - angle).abs() < 1e-8 * angle.abs());
    let second = 1.1 + ratio * (run.get("one.angle") - 0.4);
    assert_near(run.get("two.angle"), second, angle.abs(), "angle of the second, as it is in the guess");
    assert!(run.get("energy.drift").abs() < 1e-9 * run.get("energy.kinetic"));
    // Second shaft: J2 alpha2 = arm x force - 1. A positive force drives the second body forward.
    let transmitted = (0.5 * ratio * acceleration + 1.0) / arm;
    assert_near(run.get("mesh.transmitted_force"), transmitted, transmitted.abs(), "transmitted force");
    (run, transmitted)
}

/// The hinges carry the weights and the coupling forces. `on_second` is the coupling force on the second shaft.
fn check_hinges(run: &mut Run, on_second: Vec2) {
    let (a, b, mesh) = (run.force("a"), run.force("b"), run.force("mesh"));
    let size = on_second.norm() + 50.0;
    let near = |value: Vec2, expected: Vec2| {
        assert!((value - expected).norm() < 1e-13 * size, "{value} instead of {expected}");
    };
    near(mesh, on_second);
    near(a, on_second + Vec2::new(0.0, 2.0 * 9.81));
    near(b, -on_second + Vec2::new(0.0, 5.0 * 9.81));
    assert_near(run.get("mesh.force"), on_second.norm(), size, "magnitude");
}

/// Unit vector from the first centre to the second, and its normal, anticlockwise.
fn across() -> [Vec2; 2] {
    [Vec2::new(0.6, 0.8), Vec2::new(-0.8, 0.6)]
}

#[test]
fn gears_turn_against_one_another_and_press_apart() {
    let (ratio, arm) = (-17.0 / 43.0, 0.3 * 43.0 / 60.0);
    let [along, tangent] = across();
    for (angle, key) in
        [(20f64.to_radians(), ""), (0.0, r#", "pressure_angle": 0"#), (0.5, r#", "pressure_angle": 0.5"#)]
    {
        let (mut run, transmitted) = check_shafts(&format!("{GEARS}{key}"), ratio, arm);
        // When the second wheel turns forward (anticlockwise), its near side with the pitch point moves against the
        // tangent.
        check_hinges(&mut run, -transmitted * tangent + transmitted.abs() * angle.tan() * along);
    }
}

#[test]
fn teeth_press_apart_whichever_flank_bears() {
    let [along, tangent] = across();
    for motor in [3.0, -3.0] {
        let mut run = Run::new(shafts(GEARS)).started();
        run.set("motor.torque", motor);
        run.set("load.torque", 0.0);
        run.step(0.01);
        let transmitted = run.get("mesh.transmitted_force");
        assert!(transmitted * motor < 0.0);
        check_hinges(&mut run, -transmitted * tangent + transmitted.abs() * 20f64.to_radians().tan() * along);
    }
}

#[test]
fn a_pinion_turns_with_its_ring() {
    let [along, tangent] = across();
    let tan = 20f64.to_radians().tan();
    // Pinion as the first wheel: the pitch point is on its far side, and the ring is pushed towards the pinion.
    let internal = |teeth: [f64; 2]| {
        format!(r#""type": "gears", "internal": true, "first_teeth": {}, "second_teeth": {}"#, teeth[0], teeth[1])
    };
    let (mut run, transmitted) = check_shafts(&internal([17.0, 43.0]), 17.0 / 43.0, 0.3 * 43.0 / 26.0);
    check_hinges(&mut run, -transmitted * tangent - transmitted.abs() * tan * along);
    // Ring as the first wheel: the pitch point is beyond the pinion, which is pushed towards the centre of the ring.
    let (mut run, transmitted) = check_shafts(&internal([43.0, 17.0]), 43.0 / 17.0, 0.3 * 17.0 / 26.0);
    check_hinges(&mut run, transmitted * tangent - transmitted.abs() * tan * along);
}

#[test]
fn a_belt_pulls_along_its_spans() {
    let [along, across] = across();
    for (crossed, tension) in [(false, 0.0), (true, 0.0), (false, 400.0), (true, 400.0)] {
        let sign = if crossed { -1.0 } else { 1.0 };
        let keys = format!(r#"{BELT}, "crossed": {crossed}, "pretension": {tension}"#);
        let (mut run, transmitted) = check_shafts(&keys, sign * 0.05 / 0.08, 0.08);
        // Unit vectors along the spans, left and right of the line of centres, from the first pulley to the second.
        let cosine = (0.05 - sign * 0.08) / 0.3;
        let sine = f64::sqrt(1.0 - cosine * cosine);
        let [left, right] = [1.0, -1.0].map(|side| sine * along - side * cosine * across);
        // When the second pulley is driven forward, the left span of an open belt is tight, and the right span of a
        // crossed belt.
        let (one, other) = (tension + 0.5 * sign * transmitted, tension - 0.5 * sign * transmitted);
        check_hinges(&mut run, -(one * left + other * right));
    }
}

#[test]
fn a_stated_phase_counts_and_not_the_guess() {
    let mut run = Run::new(shafts(&format!(r#"{GEARS}, "phase": 0.25"#))).started();
    let first = run.get("one.angle");
    assert_near(run.get("two.angle"), 0.25 - 17.0 / 43.0 * first, 1.0, "phase");
    run.set("mesh.phase", -0.5);
    run.set("mesh.first_teeth", 20.0);
    let first = run.get("one.angle");
    assert_near(run.get("two.angle"), -0.5 - 20.0 / 43.0 * first, 1.0, "phase that was set");
}
