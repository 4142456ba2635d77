//! Signs that select a law are held within a step. Closed forms of motions in which a normal force, or the direction of
//! a drive's power, changes its sign in motion.
use crate::support::Run;
use crate::support::definition::{G, With, block, friction, slider_crank};
use serde_json::{Value, json};

const MASS: f64 = 2.0;
const MU: f64 = 0.3;
const SPEED: f64 = 5.0;

/// A block on a slide along x without gravity, faster than V_d, pressed on the guide by a force along y.
fn sliding() -> Value {
    block(MASS).with(json!({
        "start": { "speed": SPEED }, "forces": { "press": { "at": "block.origin" } },
        "friction": friction([0.2, MU], [1e-3, 2e-3]), "solver": { "tolerance": 1e-9 },
    }))
}

/// Integral over [0, end] of |F| weight, where F and weight are polynomials of degree 2 and 1: Simpson's rule between
/// the zeros of F is exact.
fn integral(force: impl Fn(f64) -> f64, weight: impl Fn(f64) -> f64, zeros: &[f64], end: f64) -> f64 {
    let bounds: Vec<f64> = [0.0].into_iter().chain(zeros.iter().copied()).chain([end]).collect();
    let f = |t: f64| force(t).abs() * weight(t);
    bounds.windows(2).map(|w| (w[1] - w[0]) / 6.0 * (f(w[0]) + 4.0 * f(0.5 * (w[0] + w[1])) + f(w[1]))).sum()
}

/// A force along y by its value and two derivatives, its zeros in (0, 1), and the number of steps in 1 s.
fn pressed([f0, f1, f2]: [f64; 3], zeros: &[f64], steps: u32) {
    let mut block = Run::new(sliding()).started();
    let force = |t: f64| f0 + t * (f1 + 0.5 * t * f2);
    let h = 1.0 / f64::from(steps);
    for k in 0..steps {
        let t = f64::from(k) * h;
        block.set("press.force_y", force(t));
        block.set_derivative("press.force_y", 1, f1 + f2 * t);
        block.set_derivative("press.force_y", 2, f2);
        block.step(h);
    }
    let speed = SPEED - MU / MASS * integral(force, |_| 1.0, zeros, 1.0);
    let way = SPEED - MU / MASS * integral(force, |t| 1.0 - t, zeros, 1.0);
    let (v, x) = (block.get("slide.speed"), block.get("slide.position"));
    assert!((v - speed).abs() < 1e-9 * SPEED && (x - way).abs() < 1e-9, "{v} {speed}, {x} {way}, {steps} steps");
}

/// Friction follows the magnitude of a normal force that passes 0, in one step and in many.
#[test]
fn a_normal_force_passes_zero() {
    for steps in [1, 7, 1000] {
        pressed([30.0, -70.0, 0.0], &[30.0 / 70.0], steps);
        pressed([-20.0, 35.0, 10.0], &[(-35.0 + f64::sqrt(35.0 * 35.0 + 400.0)) / 10.0], steps);
    }
}

/// A normal force that passes 0 and soon returns.
#[test]
fn a_normal_force_dips_below_zero() {
    for width in [0.2, 0.04, 0.005] {
        for at in [0.31, 0.5, 0.63, 0.77] {
            let b = 200.0;
            pressed([b * (at * at - width * width), -2.0 * b * at, 2.0 * b], &[at - width, at + width], 1);
        }
    }
}

/// If the normal force is 0, its rounding causes no events.
#[test]
fn a_normal_force_of_zero_costs_nothing() {
    let weight = json!({ "gravity": { "acceleration": G, "up_angle": std::f64::consts::PI } });
    let mut block = Run::new(sliding().with(weight)).started();
    block.step(1.0);
    let expected = SPEED + G;
    assert!((block.get("slide.speed") - expected).abs() < 1e-9 * expected);
    assert!(block.statistics().accepted < 40, "{:?}", block.statistics());
}

/// A drive with losses holds back the slider of a crank that turns through both dead centres. The mechanism's gain of
/// kinetic energy is the work of the drive times eta or 1 / eta, by the direction of the power.
#[test]
fn the_power_of_a_drive_changes_its_direction_at_a_dead_centre() {
    let (crank, rod, efficiency, force): (f64, f64, f64, f64) = (0.2, 0.5, 0.6, 10.0);
    let place = |angle: f64| crank * angle.cos() + (rod * rod - (crank * angle.sin()).powi(2)).sqrt();
    let start: f64 = -1.0;
    let bodies = [
        json!({ "length": crank, "mass": 3, "inertia": 0.3, "center": [0.1, 0] }),
        json!({ "length": rod, "mass": 1, "inertia": 0.02, "center": [0.25, 0] }),
        json!({ "mass": 2, "inertia": 1 }),
    ];
    let definition = slider_crank(bodies, start).with(json!({
        "start": { "speed": 10 }, "actuators": { "load": { "joint": "guide", "efficiency": efficiency } },
        "solver": { "tolerance": 1e-9 },
    }));
    for h in [0.2, 0.45, 0.7] {
        let mut machine = Run::new(&definition).started();
        let before = machine.get("energy.kinetic");
        machine.set("load.force", force);
        machine.step(h);
        let (angle, s) = (machine.get("crank.angle"), machine.get("guide.position"));
        let [outer, inner] = [rod + crank, rod - crank];
        // The strokes of the slider: out, in, and out again.
        let mut work = efficiency * (outer - place(start));
        if angle < std::f64::consts::PI {
            work -= (outer - s) / efficiency;
        } else {
            work += efficiency * (s - inner) - (outer - inner) / efficiency;
        }
        let gained = machine.get("energy.kinetic") - before;
        assert!((gained - force * work).abs() < 1e-8 * before, "{h} s, {angle} rad: {gained} {}", force * work);
    }
}
