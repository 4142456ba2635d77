//! Locks that release at a force: closed forms of the instant, of the motion after it and of the limit, saved states,
//! refusals.
use crate::support::definition::{G, With, arm, block, friction, weight};
use crate::support::{Run, assert_near, assert_rejected};
use serde_json::{Value, json};

const MASS: f64 = 3.0;
const FORCE: f64 = 12.0;

/// A block at a lower stop at 0, with a detent there.
fn detent(more: Value) -> Value {
    block(MASS)
        .with(json!({
            "forces": { "pull": { "at": "block.origin", "force": [0, 0] } },
            "stops": { "end": { "joint": "slide", "limit": "lower", "position": 0, "restitution": 0.5 } },
            "locks": { "detent": { "stop": "end", "at": "block.origin", "engage": true, "release_force": FORCE } },
            "solver": { "tolerance": 1e-12 },
        }))
        .with(more)
}

/// The pull grows in proportion to time, to the release force at the time 1.2 s.
#[test]
fn a_detent_releases_at_its_force() {
    let rate = FORCE / 1.2;
    for count in [1, 7, 40] {
        let mut run = Run::new(detent(json!({}))).started();
        for k in 1..=count {
            let [before, after] = [k - 1, k].map(|k| 2.0 * f64::from(k) / f64::from(count));
            run.set("pull.force_x", rate * before);
            run.set_derivative("pull.force_x", 1, rate);
            run.step(after - before);
            let late = (after - 1.2).max(0.0);
            // v = rate (t^2 - t0^2) / (2 m).
            let speed = rate * (2.4 * late + late * late) / (2.0 * MASS);
            let position = rate * (1.2 * late * late + late.powi(3) / 3.0) / (2.0 * MASS);
            run.near("slide.speed", speed, 1e-11);
            run.near("slide.position", position, 1e-11);
            run.near("energy.drift", 0.0, 1e-10);
            run.set("pull.force_x", rate * after);
            run.near("detent.force", if late > 0.0 { 0.0 } else { rate * after }, 1e-11);
            assert_eq!(run.is("end.reached"), late == 0.0);
        }
    }
}

/// Static friction carries a part of the pull, in steps of any size, and under a pull that does not change in the step.
#[test]
fn static_friction_helps_a_detent() {
    let rough = detent(json!({
        "gravity": weight(), "friction": friction([0.4, 0.2], [0.0; 2]).with(json!({ "law": "stick" })),
    }));
    let (high, low) = (0.4 * MASS * G, 0.2 * MASS * G);
    let after = |count: u32| {
        let mut run = Run::new(&rough).started();
        let h = 1.0 / f64::from(count);
        for k in 0..count {
            run.set("pull.force_x", 25.0 * h * f64::from(k));
            run.set_derivative("pull.force_x", 1, 25.0);
            run.step(h);
        }
        run.get("slide.position")
    };
    let late = 1.0 - (FORCE + high) / 25.0;
    let expected = (0.5 * (FORCE + high - low) + 25.0 / 6.0 * late) * late * late / MASS;
    for count in [1, 7, 40] {
        assert_near(after(count), expected, 1e-9, "position");
    }
    for (pull, holds) in [(FORCE + high - 0.01, true), (FORCE + high + 0.01, false)] {
        let mut run = Run::new(&rough).with(&[("pull.force_x", pull)]).started();
        run.step(0.1);
        assert_eq!(run.get("slide.speed") == 0.0, holds, "{pull}");
    }
}

/// It catches what comes to the stop, without a bounce, and holds a load below its force.
#[test]
fn a_detent_catches_and_holds_up_to_its_force() {
    let mut run =
        Run::new(detent(json!({ "start": { "position": 0.3, "speed": -1 } }))).with(&[("pull.force_x", 0.2)]).started();
    run.step(1.0);
    assert_eq!((run.get("slide.position"), run.get("slide.speed")), (0.0, 0.0));
    run.near("detent.force", 0.2, 1e-12);
    for (pull, holds) in [(0.999 * FORCE, true), (-50.0, true), (1.001 * FORCE, false)] {
        run.set("pull.force_x", pull);
        run.near("detent.force", if holds { pull.max(0.0) } else { 0.0 }, 1e-11);
        run.repeats(|run| run.step(0.5));
        assert_eq!(run.get("slide.speed") == 0.0, holds, "{pull}");
    }
    run.near("slide.speed", 0.5 * 1.001 * FORCE / MASS, 1e-11);
    // A lock that is not engaged holds nothing, and one without a release force holds any load.
    let mut run =
        Run::new(detent(json!({}))).with(&[("pull.force_x", 3.0)]).with(&[("detent.engage", false)]).started();
    run.near("slide.acceleration", 3.0 / MASS, 1e-13);
    let mut fast = detent(json!({}));
    fast["locks"]["detent"].as_object_mut().unwrap().remove("release_force");
    let mut run = Run::new(fast).with(&[("pull.force_x", 1e6)]).started();
    run.step(0.1);
    run.near("detent.force", 1e6, 1e-6);
}

/// The release force acts on the point of the lock: at the end of a level arm it is half the weight.
#[test]
fn the_release_force_acts_on_the_point_of_the_lock() {
    let text = arm(0.6, 2.0, 0.0).with(json!({
        "gravity": weight(),
        "stops": { "up": { "body": "arm", "limit": "upper", "angle": 0 } },
        "locks": { "catch": { "stop": "up", "at": "arm.end", "engage": true, "release_force": 1.0001 * G } },
    }));
    let mut run = Run::new(text).started();
    run.near("catch.force", G, 1e-11);
    run.step(0.3);
    run.near("arm.angle", 0.0, 1e-15);
    // The force may change during the run.
    run.set("catch.release_force", 0.9999 * G);
    run.step(1e-3);
    run.near("arm.speed", -1.5 * G / 0.6 * 1e-3, 1e-8);
    run.near("energy.drift", 0.0, 1e-10);
}

#[test]
fn a_detent_at_a_bumper_or_with_another_lock_is_refused() {
    assert_rejected("detents", detent(json!({})));
}
