//! Curves over length and angle of springs, also over several revolutions.
use super::{MASS, body, names};
use crate::support::definition::{With, block};
use crate::support::numeric::runge_kutta;
use crate::support::{FOUR_BAR, Run, changed};
use linkage_fmu::numerics::monotone::monotone;
use serde_json::json;

/// Torque over five turns: a soft part, a plateau, a stiff part.
const COIL: [[f64; 2]; 6] = [[-10.0, -9.0], [-3.0, -1.0], [4.0, 2.0], [12.0, 2.0], [20.0, 11.0], [31.0, 40.0]];

#[test]
fn a_torsional_curve_winds_up_over_several_turns() {
    let law = monotone(&COIL).unwrap();
    let mut text = body(true, [1.0, 11.0]);
    text["springs"] = json!({ "coil": { "joint": "hub", "preload": 0.5, "stiffness": 0.1, "points": COIL } });
    let mut run = Run::new(&text).started();
    let (mut most, mut least) = (f64::MIN, f64::MAX);
    let before = run.get("energy.kinetic") + run.get("energy.potential");
    let mut state = [1.0, 11.0];
    for k in 1..=60 {
        run.step(0.2);
        let rate = |_: f64, [x, v]: [f64; 2]| [v, -(law.at(x)[0] + 0.5 + 0.1 * x) / MASS];
        state = runge_kutta(rate, state, 0.2, 4000);
        let [x, v] = state;
        let [angle, speed] = names(true).map(|name| run.get(name));
        (most, least) = (most.max(angle), least.min(angle));
        assert!((angle - x).abs() < 1e-8 && (speed - v).abs() < 1e-8, "{k}: {angle} {x} {speed} {v}");
        assert!((run.get("coil.torque") - law.at(x)[0] - 0.5 - 0.1 * x).abs() < 1e-7);
        let energy = run.get("energy.kinetic") + run.get("energy.potential");
        assert!((energy - before).abs() < 1e-8, "{:e}", energy - before);
        assert!(run.get("energy.drift").abs() < 1e-8, "{:e}", run.get("energy.drift"));
    }
    assert!(most > 3.0 * std::f64::consts::TAU && least < -std::f64::consts::TAU, "{least} {most}");
}

#[test]
fn a_four_bar_with_a_coil_keeps_its_energy_over_turns_both_ways() {
    let text = changed(FOUR_BAR, |m| {
        m["springs"] = json!({ "coil": { "joint": "S", "points": COIL } });
        m["solver"] = json!({ "tolerance": 1e-11 });
        m["start"]["speed"] = json!(60);
    });
    let law = monotone(&COIL).unwrap();
    let mut run = Run::new(&text).started();
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    let (at_rest, stored) = (law.integral(0.0), |angle: f64| law.integral(angle));
    let gravity = run.get("energy.potential") - (stored(run.get("coil.angle")) - at_rest);
    assert!(gravity.is_finite());
    for _ in 0..400 {
        run.step(5e-3);
        worst = worst.max(run.get("energy.drift").abs());
        most = most.max(run.get("coil.angle").abs());
        assert!((run.get("coil.torque") - law.at(run.get("coil.angle"))[0]).abs() < 1e-9);
    }
    assert!(most > 2.0 * std::f64::consts::TAU, "{most}");
    assert!(worst < 1e-7, "{worst:e}");
}

#[test]
fn a_wound_spring_has_its_equilibrium_turns_away() {
    let mut text = body(true, [0.0, 0.0]);
    text["springs"] = json!({ "coil": { "joint": "hub", "points": [[0, -3], [10, -1], [16, 0.5], [30, 9]] } });
    text["start"] = json!("equilibrium");
    let mut run = Run::new(&text).started();
    let angle = run.get("wheel.angle");
    let law = monotone(&[[0.0, -3.0], [10.0, -1.0], [16.0, 0.5], [30.0, 9.0]]).unwrap();
    assert!(angle > 10.0 && angle < 16.0 && law.at(angle)[0].abs() < 1e-9, "{angle}");
}

/// Far from the guess panels are wide. All points of a curve may lie between two nodes of a panel, and each point is a
/// border.
#[test]
fn a_spring_far_from_the_guess_has_its_curve() {
    for (at, guess) in [(3000.0, 0.0), (400.0, 0.0), (1000.0, 0.0), (0.0, 500.0), (0.0, 700.0), (0.0, 1e4), (0.0, 1e6)]
    {
        let points = [[-0.3, -50.0], [-0.1, -1.0], [0.0, 0.0], [0.05, 0.0], [0.1, 30.0], [0.3, 31.0]];
        let text = block(2.0).with(json!({
            "springs": { "k": { "joint": "slide", "points": points.map(|[s, force]| [at + s, force]) } },
            "start": { "position": at + 0.3 }, "guess": { "slide": guess },
        }));
        let mut run = Run::new(&text);
        run.initialize();
        let acceleration = run.get("slide.acceleration");
        assert!((acceleration + 15.5).abs() < 1e-5, "{at}, {guess}: {acceleration} m/s2");
        for _ in 0..20 {
            run.step(0.05);
            let drift = run.get("energy.drift");
            assert!(drift.abs() < 1e-5, "{at}, {guess}: {drift} J");
        }
    }
}
