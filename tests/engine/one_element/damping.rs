//! Springs and dampers: motions in closed form, energy balance, a spring that winds up over several turns.
use super::slider::{MASS, Slider};
use crate::support::definition::{With, wheel};
use crate::support::{Run, SLIDER_CRANK, changed};
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// Position and speed at time t of x'' + 2 zeta omega x' + omega^2 x = 0.
fn damped(zeta: f64, omega: f64, x: f64, v: f64, t: f64) -> (f64, f64) {
    let rate = zeta * omega;
    let decay = (-rate * t).exp();
    let slope = v + rate * x;
    // cos and sin / nu of the damped frequency; cosh and sinh; or 1 and t.
    let square = omega * omega - rate * rate;
    let nu = square.abs().sqrt();
    let (c, s) = if nu < 1e-9 * omega {
        (1.0, t)
    } else if square > 0.0 {
        ((nu * t).cos(), (nu * t).sin() / nu)
    } else {
        ((nu * t).cosh(), (nu * t).sinh() / nu)
    };
    (decay * (x * c + slope * s), decay * (v * c - (omega * omega * x + rate * v) * s))
}

#[test]
fn the_closed_form_solves_its_equation() {
    for zeta in [0.0, 0.1, 1.0, 2.5] {
        let (h, omega) = (1e-4, 3.0);
        let at = |t: f64| damped(zeta, omega, 0.7, -0.4, t);
        let ((x, v), before, after) = (at(0.8), at(0.8 - h), at(0.8 + h));
        assert!(((after.0 - before.0) / (2.0 * h) - v).abs() < 1e-6);
        let a = (after.1 - before.1) / (2.0 * h);
        assert!((a + 2.0 * zeta * omega * v + omega * omega * x).abs() < 1e-6);
    }
}

#[test]
fn a_damped_block_follows_the_closed_form() {
    let omega: f64 = 12.0;
    for zeta in [0.0, 0.02, 0.3, 1.0, 3.0] {
        let slider =
            Slider { stiffness: MASS * omega * omega, damping: 2.0 * zeta * omega * MASS, ..Slider::default() };
        let mut run = slider.run(1e-12);
        let (x, v) = (0.4, -2.0);
        run.place(("slide.start_position", x), ("slide.start_speed", v));
        let energy = |x: f64, v: f64| 0.5 * MASS * (v * v + omega * omega * x * x);
        let mut worst: f64 = 0.0;
        for k in 1..=200 {
            run.step(0.01);
            let (x, v) = damped(zeta, omega, x, v, 0.01 * f64::from(k));
            worst = worst.max((run.get("slide.position") - x).abs());
            worst = worst.max((run.get("slide.speed") - v).abs() / omega);
            let a = -2.0 * zeta * omega * v - omega * omega * x;
            worst = worst.max((run.get("slide.acceleration") - a).abs() / (omega * omega));
            let now = run.get("energy.kinetic") + run.get("energy.potential");
            assert!((now - energy(x, v)).abs() < 1e-9);
            assert!(run.get("energy.drift").abs() < 1e-10 * energy(0.4, -2.0));
        }
        assert!(worst < 1e-10, "zeta {zeta}: {worst:e}");
    }
}

/// A rotor on a torsional spring rotates over several turns in both directions: theta'' = -2 zeta omega theta' -
/// omega^2 theta.
#[test]
fn a_torsional_spring_winds_up_over_several_turns() {
    let (inertia, omega) = (0.3, 2.0);
    for zeta in [0.0, 0.05] {
        let mut spring = json!({ "joint": "hub", "stiffness": inertia * omega * omega, "free_angle": 1.5 });
        if zeta != 0.0 {
            spring["damping"] = json!(2.0 * zeta * omega * inertia);
        }
        let start = json!({ "angle": 0.2, "speed": 50 });
        let mut run = Run::new(wheel(inertia).with(json!({ "springs": { "spring": spring }, "start": start })));
        run.set("solver.tolerance", 1e-12);
        run.initialize();
        let (mut worst, mut most): (f64, f64) = (0.0, 0.0);
        for k in 1..=400 {
            run.step(0.02);
            let (stretch, v) = damped(zeta, omega, 0.2 - 1.5, 50.0, 0.02 * f64::from(k));
            worst = worst.max((run.get("wheel.angle") - stretch - 1.5).abs());
            worst = worst.max((run.get("wheel.speed") - v).abs() / omega);
            most = most.max(stretch.abs());
            let torque = inertia * (omega * omega * stretch + 2.0 * zeta * omega * v);
            assert!((run.get("spring.torque") - torque).abs() < 1e-9);
            assert!(run.get("energy.drift").abs() < 1e-9 * 375.0);
        }
        // 1e-10 rad per radian.
        assert!(most > 3.0 * TAU && worst < 1e-10 * most, "{worst:e}");
    }
}

fn sprung_crank(spring: Value) -> Run {
    let mut run = Run::new(changed(SLIDER_CRANK, |m| m["springs"] = json!({ "spring": spring })));
    run.set_all(&[("drive.torque", 0.0), ("piston.force_y", 0.0), ("solver.tolerance", 1e-12)]);
    run.place(("crank.start_angle", -1.0), ("crank.start_speed", 220.0));
    run
}

/// A torsional spring on the crank: kinetic energy + weight + k theta^2 / 2 is constant over several turns and back.
#[test]
fn a_crank_winds_up_a_spring_and_comes_back() {
    let stiffness = 0.4;
    let mut run = sprung_crank(json!({ "joint": "bearing", "stiffness": stiffness }));
    let energy = |run: &mut Run| {
        let (theta, y) = (run.get("crank.angle"), run.get("piston.y"));
        run.get("energy.kinetic") + 0.8 * 9.81 * y + 0.5 * stiffness * theta * theta
    };
    let start = energy(&mut run);
    let (mut most, mut least) = (0.0f64, 0.0f64);
    for _ in 0..1500 {
        run.step(1e-3);
        let theta = run.get("crank.angle");
        (most, least) = (most.max(theta), least.min(theta));
        assert!((energy(&mut run) - start).abs() < 1e-9 * start);
        assert!(run.get("energy.drift").abs() < 1e-9 * start);
        assert!((run.get("spring.torque") - stiffness * theta).abs() < 1e-12 * stiffness * most.max(1.0));
    }
    assert!(most > 2.0 * TAU && least < -2.0 * TAU);
}

/// A damper between bearing and piston: the dissipated energy is the integral of damping x length_dot^2, by Simpson's
/// rule.
#[test]
fn the_power_of_a_damper_is_the_loss_of_energy() {
    let damping = 8.0;
    let mut run = sprung_crank(json!({
        "first": "ground.origin", "second": "piston.origin", "stiffness": 500, "free_length": 0.18, "damping": damping
    }));
    let energy = |run: &mut Run| run.get("energy.kinetic") + run.get("energy.potential");
    // The damper's part of the force is damping x length_dot.
    let power = |run: &mut Run| damping * run.get("piston.velocity_y").powi(2);
    let (start, mut lost) = (energy(&mut run), 0.0);
    let h = 2e-5;
    let mut before = power(&mut run);
    for k in 0..4000 {
        run.step(h);
        let middle = power(&mut run);
        run.step(h);
        let after = power(&mut run);
        lost += h / 3.0 * (before + 4.0 * middle + after);
        before = after;
        if k % 100 == 0 {
            assert!((start - energy(&mut run) - lost).abs() < 1e-8 * start, "{k}");
            assert!(run.get("energy.drift").abs() < 1e-9 * start);
        }
    }
    assert!(lost > 0.2 * start);
}
