//! Cylinders that meet the limits of their lengths.
use super::{Host, SYSTEM};

/// A cylinder stops at its limit within a step, whatever the size of the step, and the oil is that of short steps.
#[test]
fn a_cylinder_stops_at_its_limit_within_a_step() {
    let at_rest = |step: f64| {
        let mut host = Host::start(SYSTEM);
        host.run(2.0, step);
        assert!(host.get("volume.balance").abs() < 1e-12 * 3e-4, "{step}");
        ["door.length", "door.speed", "door.preview.acceleration", "door.chamber_a.pressure", "gear.length"]
            .map(|name| host.get(name))
    };
    let short = at_rest(1e-3);
    assert_eq!(short[..3], [0.495, 0.0, 0.0]);
    for step in [5e-3, 2e-2, 0.1] {
        let long = at_rest(step);
        assert_eq!(long[..3], short[..3], "{step}");
        assert!((long[3] - short[3]).abs() < 1e-3 * short[3], "{step} {} {}", long[3], short[3]);
        // The gear moves at less than 0.1 m/s; it starts with the step after the one in which the valve opens.
        assert!((long[4] - short[4]).abs() < 0.1 * step, "{step} {} {}", long[4], short[4]);
    }
}

/// The step in which a cylinder meets its limit predicts the length of the limit, no speed, and rest after it.
#[test]
fn the_prediction_ends_at_the_limit() {
    let mut host = Host::start(SYSTEM);
    host.run(0.3, 1e-3);
    let length = host.get("door.length");
    host.set("door.upper_limit", length + 1e-3);
    host.set("preview.horizon", 0.05);
    let [length, limit] = ["door.preview.length", "door.upper_limit"].map(|name| host.get(name));
    assert_eq!(length, limit);
    assert_eq!(["door.preview.speed", "door.preview.acceleration"].map(|name| host.get(name)), [0.0, 0.0]);
}

/// The difference of two times is the announced step but for rounding; another step is none.
#[test]
fn a_step_is_compared_with_the_horizon_but_for_rounding() {
    for (step, warns) in [(2.001 - 2.0, false), (1e-3 * (1.0 + 1e-8), true)] {
        let mut host = Host::start(SYSTEM);
        host.set("preview.horizon", 1e-3);
        host.0.step(step).unwrap();
        assert_eq!(host.0.take_warning().is_some(), warns, "{step}");
    }
}
