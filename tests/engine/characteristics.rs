//! Springs with a force curve through points or with a gas, against a Runge-Kutta integration and the energy balance.

use crate::support::definition::{With, arm, block};
use crate::support::numeric::runge_kutta;
use crate::support::{Run, assert_says, changed, refusal};
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// Mass of the carriage [kg].
const MASS: f64 = 3.0;

/// A carriage on a level rail, at `start` [m], between a spring and the ground.
pub fn carriage(spring: Value, start: f64) -> Value {
    block(MASS).with(json!({
        "springs": { "strut": spring }, "start": { "position": start }, "guess": { "slide": start },
        "solver": { "tolerance": 1e-12 },
    }))
}

pub fn gas() -> Value {
    json!({ "joint": "slide", "free_length": 0.5,
            "gas": { "pressure": 8e5, "area": 3e-4, "volume": 9e-5, "exponent": 1.3, "ambient": 1e5 } })
}

#[test]
fn a_carriage_on_a_gas_spring_follows_the_gas_law() {
    let law = |s: f64| {
        let volume = 9e-5 + 3e-4 * (s - 0.5);
        (1e5 - 8e5 * (9e-5_f64 / volume).powf(1.3)) * 3e-4
    };
    // A second spring balances the gas, so that the carriage oscillates.
    let both = |s: f64| law(s) + 900.0 * (s - 0.35);
    let text = changed(carriage(gas(), 0.4), |m| {
        m["springs"]["coil"] = json!({ "joint": "slide", "stiffness": 900, "free_length": 0.35 });
        m["stops"] = json!({ "near": { "joint": "slide", "limit": "lower", "position": 0.25 } });
    });
    let mut run = Run::new(&text).started();
    let mut least = f64::INFINITY;
    for k in 1..=50 {
        run.step(0.02);
        let rate = |_: f64, [x, v]: [f64; 2]| [v, -both(x) / MASS];
        let [x, v] = runge_kutta(rate, [0.4, 0.0], 0.02 * f64::from(k), 400 * k);
        let (position, speed) = (run.get("slide.position"), run.get("slide.speed"));
        least = position.min(least);
        assert!((position - x).abs() < 1e-10 && (speed - v).abs() < 1e-9, "{k}: {position} {x}, {speed} {v}");
        assert!((run.get("strut.force") - law(x)).abs() < 1e-6);
        assert!(run.get("energy.drift").abs() < 1e-9, "{:e}", run.get("energy.drift"));
    }
    assert!(least > 0.26, "the carriage does not meet the stop: {least}");
}

#[test]
fn a_gas_variable_changes_the_gas() {
    let text = changed(carriage(gas(), 0.5), |m| {
        m["stops"] = json!({ "near": { "joint": "slide", "limit": "lower", "position": 0.3 } });
    });
    let mut run = Run::new(&text);
    for (name, value, force) in [
        ("strut.gas.ambient", 8e5, 0.0),
        ("strut.gas.pressure", 1e6, -60.0),
        ("strut.gas.area", 1e-4, -20.0),
        ("strut.gas.exponent", 1.0, -20.0),
    ] {
        run.set(name, value);
        run.initialize();
        assert!((run.get("strut.force") - force).abs() < 1e-9, "{name}: {}", run.get("strut.force"));
    }
    run.set("slide.start_position", 0.4);
    run.initialize();
    // Boyle's law: 90 cm3 are compressed to 80 cm3.
    assert!((run.get("strut.force") - (8e5 - 1e6 * 9.0 / 8.0) * 1e-4).abs() < 1e-9, "{}", run.get("strut.force"));
}

#[test]
fn points_on_a_line_are_a_stiffness() {
    let line = json!({ "joint": "slide", "points": [[-1, -50], [0.2, 10], [0.3, 15], [2, 100]] });
    let mut curve = Run::new(carriage(line, 0.7)).started();
    let mut coil = Run::new(carriage(json!({ "joint": "slide", "stiffness": 50 }), 0.7)).started();
    for _ in 0..100 {
        curve.step(0.05);
        coil.step(0.05);
        assert!((curve.get("slide.position") - coil.get("slide.position")).abs() < 1e-10);
        assert!((curve.get("energy.potential") - coil.get("energy.potential")).abs() < 1e-9);
    }
}

/// A curve with a plateau and a steep part. Beyond its ends it is extrapolated with its end slopes.
pub const POINTS: [[f64; 2]; 6] = [[-0.3, -40.0], [-0.1, -3.0], [0.0, 0.0], [0.1, 2.0], [0.25, 2.0], [0.3, 30.0]];

#[test]
fn a_curve_through_points_keeps_the_energy_and_repeats_its_period() {
    let mut run = Run::new(carriage(json!({ "joint": "slide", "points": POINTS }), 0.5)).started();
    for [s, force] in POINTS {
        let mut at = Run::new(carriage(json!({ "joint": "slide", "points": POINTS }), s)).started();
        assert!((at.get("strut.force") - force).abs() < 1e-11, "{s}: {} {force}", at.get("strut.force"));
    }
    // Turning points by linear interpolation of the speed over 1 ms.
    let mut turns = Vec::new();
    let (mut last, mut worst) = (0.0, 0.0_f64);
    for k in 1..=40_000 {
        run.step(1e-3);
        let speed = run.get("slide.speed");
        if last < 0.0 && speed >= 0.0 || last > 0.0 && speed <= 0.0 {
            turns.push(1e-3 * (f64::from(k) - speed / (speed - last)));
        }
        last = speed;
        worst = run.get("energy.drift").abs().max(worst);
    }
    // The energy is 21 J. The motion passes some 600 points of the curve, where the third derivative jumps.
    assert!(worst < 1e-7, "{worst:e} J");
    let periods: Vec<f64> = turns.windows(3).map(|t| t[2] - t[0]).collect();
    assert!(periods.len() > 10);
    assert!(periods.iter().all(|p| (p - periods[0]).abs() < 1e-5), "{periods:?}");
}

#[test]
fn wrong_curves_and_gases_are_rejected() {
    for (spring, pieces) in [
        (
            json!({ "joint": "slide", "points": [[0, 1]] }),
            &["springs.strut.points", "has 1 points", "needs 2 or more"][..],
        ),
        (
            json!({ "joint": "slide", "points": [[0, 1], [0, 2]] }),
            &["points[1]", "position = 0 must be larger than position = 0", "sort"],
        ),
        (json!({ "joint": "slide", "points": [[0, 1], [2, 1e101]] }), &["springs.strut.points[1]", "1e101"]),
        (json!({ "joint": "slide", "points": [[0, 1], [5e-324, 2]] }), &["springs.strut.points", "so close"]),
        (json!({ "joint": "slide", "points": [[0, 1, 2]] }), &["springs.strut.points[0]"]),
        (changed_gas(|g| g["points"] = json!([[0, 1], [1, 2]])), &["springs.strut.gas", "two springs"]),
        (changed_gas(|g| g["free_length"] = Value::Null), &["springs.strut", "add the key `free_length`"]),
        (changed_gas(|g| g["gas"]["volume"] = json!(0)), &["springs.strut.gas.volume = 0", "> 0"]),
        (changed_gas(|g| g["gas"]["exponent"] = json!(0.5)), &["springs.strut.gas.exponent", "from 1 to 2"]),
    ] {
        assert_says(refusal(carriage(spring, 0.5)), pieces);
    }
}

fn changed_gas(change: impl FnOnce(&mut Value)) -> Value {
    let mut gas = gas();
    change(&mut gas);
    if gas["free_length"].is_null() {
        gas.as_object_mut().unwrap().remove("free_length");
    }
    gas
}

#[test]
fn a_gas_without_volume_is_rejected() {
    // The gas has no volume if the strut is shorter than 0.2 m. A stop at 0.25 m prevents this.
    let stops = |least: f64| {
        changed(carriage(gas(), 0.4), |m| {
            m["stops"] = json!({ "near": { "joint": "slide", "limit": "lower", "position": least },
                                 "far": { "joint": "slide", "limit": "upper", "position": 1 } });
        })
    };
    assert_says(refusal(stops(0.15)), &["strut", "the length is 0.2 m", "increase the gas volume", "add a stop"]);
    assert!(Run::new(stops(0.25)).started().get("strut.force") < 0.0);
}

/// A narrow and weak detent is not skipped within a long step: energy is conserved in the detent.
#[test]
fn a_narrow_detent_is_seen_in_long_steps() {
    // 2 kg at 1 m/s. A force of up to 3 mN over 4 mm absorbs 6e-6 J and returns it.
    let points = json!([[0.1, 0], [0.102, 0.003], [0.104, 0], [0.106, -0.003], [0.108, 0]]);
    let text = block(2.0).with(json!({
        "springs": { "detent": { "joint": "slide", "points": points } }, "solver": { "tolerance": 1e-8 },
        "start": { "speed": 1 },
    }));
    let mut run = Run::new(text).started();
    let (mut deepest, mut drift) = (0.0_f64, 0.0_f64);
    for _ in 0..20 {
        run.step(0.0104);
        deepest = deepest.max(run.get("energy.potential"));
        drift = drift.max(run.get("energy.drift").abs());
    }
    assert!(drift < 1e-8, "{drift:e} J");
    assert!(deepest > 5e-6, "a communication point lies in the detent: {deepest} J");
}

#[test]
fn the_error_names_the_position_where_a_gas_has_no_volume_left() {
    // The rod angle at which the strut from (0.5, 0) is 0.3 m long: cos = (0.25 + 0.09 - 0.09) / (2 0.5 0.3). The strut
    // shortens further beyond it. At 0.3 m, 0.2 m below its free length, its gas has no volume.
    let text = arm(0.3, 1.0, 1.0).with(json!({
        "bodies": { "ground": { "points": { "eye": [0.5, 0] } } },
        "springs": { "strut": { "first": "ground.eye", "second": "arm.end", "free_length": 0.5,
                                "gas": { "pressure": 1e6, "area": 1e-3, "volume": 2e-4, "exponent": 1.2 } } },
    }));
    let angle = TAU - f64::acos(0.25 / 0.3);
    assert_says(refusal(text), &["strut", &format!("at arm = {angle:.5}"), "the length is 0.3 m"]);
}

/// A barrier between parts without force, which long steps could skip: as a function of a position, and of an angle
/// over several turns.
#[test]
fn a_barrier_between_regions_without_force_reverses_the_motion() {
    let barrier = |joint: &str, points: Value| json!({ "barrier": { "joint": joint, "points": points } });
    let slide = block(1.0).with(json!({
        "springs": barrier("slide", json!([[0, 0], [1, 0], [1.1, 8], [1.2, 0], [6, 0]])), "start": { "speed": 1 },
    }));
    let arm = arm(0.5, 2.0, 0.0).with(json!({
        "springs": barrier("pivot", json!([[0, 0], [2, 0], [2.1, 40], [2.2, 0], [6, 0]])), "start": { "speed": 5 },
    }));
    // A barrier of 0.8 J against 0.5 J, and one of 4 J against 2.1 J: both bodies return with their initial speed.
    for (definition, speed, expected) in [(slide, "slide.speed", -1.0), (arm, "arm.speed", -5.0)] {
        for h in [2.0, 0.5, 0.01, 0.001] {
            let mut run = Run::new(&definition).started();
            (0..(2.0_f64 / h).round() as usize).for_each(|_| run.step(h));
            let drift = run.get("energy.drift");
            assert!(drift.abs() < 1e-8, "{speed}, steps of {h} s: {drift:e} J");
            assert!((run.get(speed) - expected).abs() < 1e-7, "{speed}, steps of {h} s: {}", run.get(speed));
        }
    }
}
