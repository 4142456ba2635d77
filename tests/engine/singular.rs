//! Toggles, flat positions with crossings, full turns, redundant joints: the motion is exact at all of them.

use crate::support::definition::{self, With};
use crate::support::numeric::pseudo_random;
use crate::support::{Run, Vec2, assert_says, changed, refusal, turned, without_stops};
use linkage_fmu::simulation::{Simulation, SimulationError};
use serde_json::json;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn started(text: &str) -> Result<Run, SimulationError> {
    let mut simulation = Simulation::open(text)?;
    simulation.initialize()?;
    Ok(Run(simulation))
}

/// A four-bar of uniform rods of 1 kg/m: lengths of ground, crank, coupler and rocker; start of the crank; guess of
/// crank, coupler and rocker.
fn four_bar(lengths: [f64; 4], start: f64, speed: f64, guess: [f64; 3], gravity: f64) -> String {
    let more = json!({
        "gravity": { "acceleration": gravity, "up_angle": FRAC_PI_2 }, "torques": { "crank": { "on": "crank" } },
        "start": { "angle": start, "speed": speed }, "solver": { "tolerance": 1e-12 },
    });
    definition::four_bar(lengths, guess).with(more).to_string()
}

/// Reduced inertia of the gear at the crank angle, on the branch with the coupler above the diagonal: PHYSICS, equation
/// of motion in the crank angle, with closed-form angles.
fn gear_inertia(theta2: f64) -> f64 {
    let (l1, l2, l3, l4, l5): (f64, f64, f64, f64, f64) = (0.5729, 0.1755, 0.217, 0.34, 0.759);
    let (m2, m3, m4, m5, m5k) = (13.689, 0.72037056, 3.850704, 36.8, 19.5);
    let (bx, by) = (l2 * theta2.cos(), l2 * theta2.sin());
    let (dx, dy) = (l1 - bx, -by);
    let a = dx.hypot(dy);
    let along = (a * a + l3 * l3 - l4 * l4) / (2.0 * a);
    let up = (l3 * l3 - along * along).max(0.0).sqrt();
    let (cx, cy) = (bx + (dx * along - dy * up) / a, by + (dy * along + dx * up) / a);
    let (theta3, theta4) = ((cy - by).atan2(cx - bx), cy.atan2(cx - l1));
    let k3 = -l2 * (theta2 - theta4).sin() / (l3 * (theta3 - theta4).sin());
    let k4 = l2 * (theta2 - theta3).sin() / (l4 * (theta4 - theta3).sin());
    m2 * l2 * l2 / 3.0
        + (m5 / 3.0 + m5k) * l5 * l5
        + m4 * l4 * l4 * k4 * k4 / 3.0
        + m3 * (l2 * l2 + l3 * l3 * k3 * k3 / 3.0 + l2 * l3 * k3 * (theta2 - theta3).cos())
}

/// Largest crank angle of the gear [rad]: coupler and follower are in line.
fn toggle() -> f64 {
    ((0.5729f64.powi(2) + 0.1755f64.powi(2) - 0.557f64.powi(2)) / (2.0 * 0.5729 * 0.1755)).acos()
}

/// Length of the gear's closed curve in the kinetic metric. The lower branch mirrors the upper branch. With theta2 =
/// toggle sin(phi) the integrand is smooth and periodic, and the midpoint rule converges geometrically.
fn gear_length() -> f64 {
    let toggle = toggle();
    const POINTS: u32 = 4000;
    let step = PI / f64::from(POINTS);
    let value = |i: u32| {
        let phi = -FRAC_PI_2 + (f64::from(i) + 0.5) * step;
        gear_inertia(toggle * phi.sin()).sqrt() * toggle * phi.cos()
    };
    2.0 * step * (0..POINTS).map(value).sum::<f64>()
}

#[test]
fn the_gear_coasts_through_both_toggles_ten_thousand_times() {
    let coasting = [("actuator.force", 0.0), ("load_factor", 0.0), ("crank.start_speed", -20.0)];
    let mut gear = Run::new(without_stops()).with(&coasting).started();
    let kinetic = gear.get("energy.kinetic");
    assert!((kinetic - 0.5 * gear_inertia(0.8) * 400.0).abs() < 1e-12 * kinetic);
    let period = gear_length() / (2.0 * kinetic).sqrt();
    let mut worst: f64 = 0.0;
    for turn in 1..=10_000 {
        // Uneven steps, so that the toggles occur anywhere within a step.
        gear.step(0.37 * period);
        gear.step(0.63 * period);
        if turn % 100 == 0 {
            worst = worst.max((gear.get("energy.kinetic") / kinetic - 1.0).abs());
            assert!(gear.get("energy.drift").abs() < 1e-9 * kinetic);
        }
    }
    let phase = (gear.get("crank.angle") - 0.8) / -20.0 / period;
    assert!(worst < 1e-9);
    // Length and quadrature agree to 1e-13. Ten thousand turns multiply this error.
    assert!(phase.abs() < 1e-8, "{phase:e}");
}

#[test]
fn a_start_exactly_at_a_toggle_works() {
    for toggle in [toggle(), -toggle()] {
        let start = [("crank.start_angle", toggle), ("solver.tolerance", 1e-12)];
        let mut gear = Run::new(without_stops()).with(&start).started();
        assert!((gear.get("crank.angle") - toggle).abs() < 1e-12);
        for _ in 0..200 {
            gear.step(1e-3);
            assert!(gear.get("energy.drift").abs() < 1e-6);
        }
        assert!(gear.get("energy.kinetic") > 10.0);
        // At its toggle the crank has the speed 0. The speed can be stated by the follower, but not by the crank.
        gear.set("crank.start_speed", 1.0);
        assert_says(gear.refusal(), &["crank.start_speed = 1", "dead centre"]);
        gear.set("crank.start_speed", 0.0);
        gear.initialize();
        let (coupler, follower) = (gear.get("coupler.angle"), gear.get("follower.angle"));
        let mut gear = Run::new(changed(without_stops(), |m| {
            m["start"] = json!({ "body": "follower", "angle": follower, "speed": 3 });
            // The follower has this angle in a second position, so the guess must be near.
            m["guess"] = json!({ "crank": toggle, "coupler": coupler, "follower": follower });
        }));
        assert!((gear.get("follower.speed") - 3.0).abs() < 1e-11);
        let (angle, speed) = (gear.get("crank.angle"), gear.get("crank.speed"));
        assert!((angle - toggle).abs() < 1e-12 && speed.abs() < 1e-6, "{angle} {toggle} {speed}");
    }
}

#[test]
fn a_start_beyond_the_toggle_is_rejected_with_the_range() {
    let error = Run::new(without_stops()).with(&[("crank.start_angle", 1.4)]).refusal();
    assert_says(error, &["crank.start_angle = 1.4", "-1.32", "1.32"]);
}

#[test]
fn flat_positions_are_crossed_straight_on_in_both_directions() {
    for (speed, torque) in [(3.0, 0.0), (-3.0, 0.0), (1e-3, 0.0), (0.0, 5.0), (0.0, -0.3)] {
        // A parallelogram. The guess is away from the crossing, the start exactly at the crossing.
        let mut bars = Run::new(four_bar([2.0, 1.0, 2.0, 1.0], 0.0, speed, [0.4, 0.0, 0.4], 0.0));
        bars.set("crank.torque", torque);
        bars.initialize();
        let span = if speed == 1e-3 { 100.0 } else { 0.01 };
        for _ in 0..5000 {
            bars.step(span);
            let (crank, rocker) = (bars.get("crank.angle"), bars.get("rocker.angle"));
            assert!((crank - rocker).abs() < 1e-12 * (1.0 + crank.abs()), "{crank} {rocker}");
            assert!(bars.get("coupler.angle").abs() < 1e-12);
        }
        let moved = bars.get("crank.angle");
        // The coupler translates: I = 1/3 + 2 + 1/3.
        let exact = speed * 5000.0 * span + 0.5 * torque / (8.0 / 3.0) * (50.0f64).powi(2);
        assert!((moved - exact).abs() < 1e-10 * exact.abs(), "{moved} {exact}");
    }
}

#[test]
fn the_antiparallelogram_stays_one() {
    // Antiparallelogram: crank at 1 rad, coupler and rocker turned the other way.
    let mut bars = Run::new(four_bar([2.0, 1.0, 2.0, 1.0], 1.0, 0.0, [1.0, -1.05, -2.1], 9.81));
    bars.initialize();
    bars.set("crank.torque", 45.0);
    let mut furthest: f64 = 0.0;
    for _ in 0..5000 {
        bars.step(2e-3);
        let (crank, rocker) = (bars.get("crank.angle"), bars.get("rocker.angle"));
        // tan(rocker/2) = -(ground + crank length)/(ground - crank length) tan(crank/2) on the crossed branch.
        let (a, b) = (0.5 * crank, 0.5 * rocker);
        let miss = b.sin() * a.cos() + 3.0 * a.sin() * b.cos();
        assert!(miss.abs() < 1e-10, "{crank} {rocker}: {miss}");
        furthest = furthest.max(crank.abs());
    }
    assert!(furthest > TAU, "it must have passed the flat positions: {furthest}");
    assert!(bars.get("energy.drift").abs() < 1e-7 * bars.get("energy.kinetic"));
}

/// A parallelogram with a length error of 0.1 to 1e-17 and without `snap`. The branches near the flat position are
/// connected by bends whose width is the root of the error. Down to 1e-5 the motion through the bends is exact. From
/// 1e-13 on they may count as a crossing. In between rounding would select the branch, and the model is rejected.
#[test]
fn branches_that_almost_cross_are_distinguished_or_rejected() {
    let speed = 5.0;
    for (which, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0), (3, 1.0), (3, -1.0)] {
        for power in 1..=17 {
            let mut lengths = [2.0, 1.0, 2.0, 1.0];
            lengths[which] += sign * 10f64.powi(-power);
            let text = four_bar(lengths, 0.8, speed, [0.8, 0.0, 0.8], 0.0);
            let text = changed(&text, |definition| definition["snap"] = json!(0));
            let mut bars = match started(&text) {
                Ok(bars) => bars,
                Err(error) => {
                    assert!((6..14).contains(&power), "{lengths:?}: {error}");
                    assert_says(error, &["almost cross"]);
                    continue;
                }
            };
            assert!(!(7..13).contains(&power), "{lengths:?} would have to be refused");
            let kinetic = bars.get("energy.kinetic");
            for _ in 0..1000 {
                bars.step(0.01);
                let (crank, rocker) = (bars.get("crank.angle"), bars.get("rocker.angle"));
                let x = lengths[0] + lengths[3] * rocker.cos() - lengths[1] * crank.cos();
                let y = lengths[3] * rocker.sin() - lengths[1] * crank.sin();
                let gap = x.hypot(y) - lengths[2];
                // At a bend that counts as a crossing, the error of the length is allowed.
                let taken = if power < 13 { 0.0 } else { 1.1 * 10f64.powi(-power) };
                assert!(gap.abs() < 3e-14 + taken, "{lengths:?} at {crank}: {gap}");
                // Kinetic energy in absolute coordinates, from the angular velocities of the model.
                let [w2, w3, w4] = ["crank", "coupler", "rocker"].map(|b| bars.get(&format!("{b}.speed")));
                let [_, l2, l3, l4] = lengths;
                let middle = turned(Vec2::new(0.0, l2 * w2), crank)
                    + turned(Vec2::new(0.0, 0.5 * l3 * w3), bars.get("coupler.angle"));
                let rotation = (l2.powi(3) * w2 * w2 + l4.powi(3) * w4 * w4) / 6.0 + l3.powi(3) * w3 * w3 / 24.0;
                let energy = rotation + 0.5 * l3 * middle.norm_squared();
                assert!((energy - kinetic).abs() < 1e-8 * kinetic, "{lengths:?} at {crank}: {energy} {kinetic}");
            }
        }
    }
}

/// In these random linkages the rounding of the coordinates is larger than usual. It must not be mistaken for a bend
/// that shorter panels would resolve.
#[test]
fn rounding_is_not_taken_for_a_bend() {
    for text in [include_str!("../fixtures/watt_with_a_slider.json"), include_str!("../fixtures/stephenson.json")] {
        let mut model = Run::new(text).started();
        for _ in 0..100 {
            model.step(0.02);
            let [work, drift] = ["energy.kinetic", "energy.drift"].map(|name| model.get(name));
            assert!(drift.abs() < 1e-9 * (1.0 + work), "{drift} of {work}");
        }
    }
    // This linkage is 5e-7 of its size away from a crossing.
    let text = include_str!("../fixtures/inverted_slider_crank.json");
    let as_drawn = changed(text, |definition| definition["snap"] = json!(0));
    assert_says(refusal(as_drawn), &["almost cross", "write \"snap\": "]);
    let mut model = Run::new(text).started();
    model.step(0.02);
    assert!(!model.0.model().remarks().is_empty());
}

/// Parallelograms and antiparallelograms with random masses and centres of mass: each curve is traced through its
/// crossings and tabulated, and none is rejected.
#[test]
fn crossings_are_tabulated_whatever_the_masses() {
    let mut random = pseudo_random(1);
    let mut refused = Vec::new();
    for _ in 0..100 {
        let length = 0.3 + 3.0 * random();
        for guess in [[0.4, 0.0, 0.4], [1.0, -1.05, -2.1]] {
            let text = four_bar([2.0, length, 2.0, length], guess[0], 1.0, guess, 9.81);
            let text = changed(&text, |m| {
                for (body, size) in [("crank", length), ("coupler", 2.0), ("rocker", length)] {
                    let (mass, center) = (0.2 + 4.0 * random(), [size * random(), 0.5 * size * (random() - 0.5)]);
                    let inertia = mass * size * size * (0.02 + 0.2 * random());
                    m["bodies"][body] = json!({ "length": size, "mass": mass, "center": center, "inertia": inertia });
                }
            });
            assert!(!text.contains("uniform_rod"));
            match started(&text) {
                Err(error) => refused.push(error.to_string()),
                Ok(mut bars) => {
                    let (mut worst, mut most): (f64, f64) = (0.0, 0.0);
                    for _ in 0..50 {
                        bars.step(0.1);
                        worst = worst.max(bars.get("energy.drift").abs());
                        most = most.max(bars.get("energy.kinetic"));
                    }
                    assert!(worst < 1e-9 * most, "{length} {guess:?}: drift {worst:e} of {most:e}");
                }
            }
        }
    }
    assert!(refused.is_empty(), "{} of 200: {refused:#?}", refused.len());
}

#[test]
fn a_guess_at_a_crossing_must_determine_the_branch() {
    let flat = four_bar([2.0, 1.0, 2.0, 1.0], 0.0, 1.0, [0.0, 0.0, 0.0], 0.0);
    assert_says(refusal(flat), &["branches", "away from the crossing"]);
}

#[test]
fn a_crank_that_turns_fully_round_counts_on() {
    let mut bars = Run::new(four_bar([4.0, 1.0, 3.0, 3.0], 0.5, 12.0, [0.5, 0.9, 2.0], 9.81));
    bars.initialize();
    let mut last = bars.get("crank.angle");
    let energy = bars.get("energy.kinetic") + bars.get("energy.potential");
    for _ in 0..2000 {
        bars.step(1e-2);
        let now = bars.get("crank.angle");
        assert!(now > last && now < last + 1.0, "{last} to {now}");
        last = now;
    }
    assert!(last > 20.0 * TAU);
    assert!(bars.get("energy.drift").abs() < 1e-9 * energy);
    assert!(bars.get("rocker.angle").abs() < PI);
    // A start some turns away is the same position.
    bars.set("crank.start_angle", 0.5 + 3.0 * TAU);
    bars.initialize();
    assert!((bars.get("crank.angle") - 0.5 - 3.0 * TAU).abs() < 1e-13);
}
