//! Stops, bumpers and locks: impacts, rest, holding forces, and energy.

use crate::support::definition::{With, block, weight};
use crate::support::{Run, SLIDER_CRANK, assert_says, changed, read_all, refusal};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

fn same_reactions(one: &mut Run, other: &mut Run) {
    for joint in ["joint1.force_x", "joint1.force_y", "joint2.force_x", "joint3.force_y", "joint4.force_x"] {
        let (a, b) = (one.get(joint), other.get(joint));
        assert!((a - b).abs() < 1e-7, "{joint}: {a} {b}");
    }
}

/// The gear at its start with these values.
fn gear(values: &[(&str, f64)]) -> Run {
    Run::gear().with(values).started()
}

/// The gear without its up stop, at the position of the up stop.
fn at_up_stop(values: &[(&str, f64)]) -> Run {
    Run::gear().with(&[("upstop.enabled", false)]).with(&[("crank.start_angle", -1.3)]).with(values).started()
}

#[test]
fn the_gear_is_up_and_stays_there() {
    let mut gear = gear(&[]);
    assert!(gear.is("extended") && !gear.is("retracted"));
    gear.step(0.2);
    assert!(gear.is("retracted") && !gear.is("extended"));
    assert!((gear.get("crank.angle") + 1.3).abs() < 1e-13, "{}", gear.get("crank.angle"));
    assert_eq!((gear.get("crank.speed"), gear.get("crank.acceleration")), (0.0, 0.0));
    // The actuator presses against the stop. The stop torque acts anticlockwise.
    assert!(gear.get("upstop.torque") > 0.0);
    assert!(gear.get("energy.drift").abs() < 1e-4, "{}", gear.get("energy.drift"));
}

/// Virtual work at rest: the torque of the stop balances the excess of the actuator force over the holding force.
#[test]
fn a_stop_carries_the_excess_force_of_the_actuator() {
    let mut gear = gear(&[]);
    gear.step(0.2);
    let (force, holding) = (30_000.0, gear.get("actuator.holding_force"));
    let mut moving = at_up_stop(&[("crank.start_speed", 1.0)]);
    let arm = moving.get("actuator.speed");
    let expected = -(force - holding) * arm;
    assert!((gear.get("upstop.torque") - expected).abs() < 1e-9 * expected.abs(), "{expected}");
}

/// A gear held by its stop has the same reactions as the gear at rest under an equal external torque.
#[test]
fn reactions_at_a_stop_are_those_under_its_torque() {
    let mut gear = gear(&[]);
    gear.step(0.2);
    let torque = gear.get("upstop.torque");
    let mut same = at_up_stop(&[("crank.torque", torque)]);
    assert!(same.get("crank.acceleration").abs() < 1e-9);
    same_reactions(&mut gear, &mut same);
}

/// A gear held by its uplock at the wheel has the same state as a gear held by a force at the wheel.
#[test]
fn a_lock_holds_by_a_force_at_its_point() {
    let mut gear = gear(&[]);
    gear.set("uplock.engage", true);
    gear.step(0.2);
    gear.set("actuator.force", 0.0);
    gear.step(0.1);
    assert!(gear.is("retracted"));
    assert_eq!((gear.get("upstop.torque"), gear.get("crank.speed")), (0.0, 0.0));
    let force = gear.get("uplock.force");
    assert!(force > 0.0);
    // The velocity of the wheel shows the direction of its path.
    let free = ("actuator.force", 0.0);
    let mut moving = at_up_stop(&[free, ("crank.start_speed", -1.0)]);
    let path = [moving.get("wheel.velocity_x"), moving.get("wheel.velocity_y")];
    let length = path[0].hypot(path[1]);
    let pull = [("wheel.force_x", force * path[0] / length), ("wheel.force_y", force * path[1] / length)];
    let mut same = at_up_stop(&[free, pull[0], pull[1]]);
    assert!(same.get("crank.acceleration").abs() < 1e-9, "{}", same.get("crank.acceleration"));
    same_reactions(&mut gear, &mut same);
    // After the release the gear falls.
    gear.set("uplock.engage", false);
    assert!(gear.get("crank.acceleration") > 0.0);
    gear.step(0.05);
    assert!(!gear.is("retracted") && gear.get("crank.speed") > 0.0);
}

/// PHYSICS: theta2 = -1.3 at 0.13205985274425970 s with omega = -30.257773253560312.
#[test]
fn the_impact_is_located() {
    let tight = [("solver.tolerance", 1e-12), ("upstop.restitution", 0.5)];
    let mut gear = gear(&tight);
    let (hit, after) = (0.132_059_852_744_259_7, 1e-4);
    gear.step(hit + after);
    let mut late = at_up_stop(&[tight[0], ("crank.start_speed", 0.5 * 30.257773253560312)]);
    late.step(after);
    // An error of 1e-10 s in the impact's time would give 4.5e-9 rad here.
    let miss = (gear.get("crank.angle") - late.get("crank.angle")).abs();
    assert!(miss < 1e-11, "{miss:e}");
    // The impact does not depend on the division into steps.
    let mut cut = Run::gear().with(&tight).started();
    cut.steps(1000, hit + after);
    assert!((gear.get("crank.angle") - cut.get("crank.angle")).abs() < 1e-11);
}

#[test]
fn a_dropped_gear_comes_to_rest_on_its_down_stop() {
    // The actuator pulls the gear from slightly above onto the down stop.
    let mut gear = gear(&[("crank.start_angle", 0.5), ("actuator.force", -20_000.0), ("downstop.restitution", 0.5)]);
    let start = gear.get("actuator.length");
    let mut bounces = 0;
    let mut last = gear.get("crank.speed");
    for _ in 0..2000 {
        gear.step(1e-3);
        let now = gear.get("crank.speed");
        bounces += u32::from(last > 0.0 && now < 0.0);
        last = now;
        assert!(gear.get("crank.angle") <= 0.8 + 1e-13);
    }
    assert!(bounces >= 3);
    assert!(gear.is("extended") && gear.get("crank.speed") == 0.0);
    assert!(gear.get("energy.drift").abs() < 1e-9 * 20_000.0 * (gear.get("actuator.length") - start).abs() * 10.0);
    let evaluations = gear.statistics().evaluations;
    gear.step(100.0);
    assert!(gear.statistics().evaluations - evaluations < 100, "rest costs nothing");
}

/// An impact with the restitution 1 conserves the energy.
#[test]
fn an_elastic_stop_gives_everything_back() {
    let drop = [("crank.start_angle", 0.6), ("actuator.force", -20_000.0), ("downstop.restitution", 1.0)];
    let mut gear = gear(&drop).with(&[("solver.tolerance", 1e-11)]).started();
    let energy = |gear: &mut Run| {
        gear.get("energy.kinetic") + gear.get("energy.potential") + 20_000.0 * gear.get("actuator.length")
    };
    let before = energy(&mut gear);
    for _ in 0..500 {
        gear.step(2e-3);
        assert!((energy(&mut gear) - before).abs() < 1e-6, "{}", energy(&mut gear) - before);
    }
}

#[test]
fn a_bumper_holds_by_its_spring() {
    let mut gear = Run::gear()
        .with(&[("upstop.rigid", false)])
        .with(&[("upstop.angle", -1.29), ("upstop.stiffness", 5e6), ("upstop.damping", 5e4)])
        .started();
    gear.step(3.0);
    assert!(gear.is("retracted"));
    let pressed = -1.29 - gear.get("crank.angle");
    assert!(pressed > 0.0 && gear.get("crank.speed").abs() < 1e-6, "{pressed} {}", gear.get("crank.speed"));
    assert!((gear.get("upstop.torque") - 5e6 * pressed).abs() < 1e-6 * 5e6 * pressed);
    assert!(gear.get("energy.drift").abs() < 1e-4, "{}", gear.get("energy.drift"));
    // A bumper without damping returns its energy. It never pulls.
    let mut gear = Run::gear()
        .with(&[("downstop.rigid", false)])
        .with(&[("crank.start_angle", 0.6), ("actuator.force", -20_000.0), ("downstop.stiffness", 5e5)])
        .with(&[("solver.tolerance", 1e-11)])
        .started();
    let mut highest: f64 = 0.0;
    for _ in 0..3000 {
        gear.step(1e-3);
        assert!(gear.get("downstop.torque") <= 0.0);
        assert!(gear.get("energy.drift").abs() < 1e-5);
        highest = highest.max(gear.get("crank.angle"));
        assert!(gear.get("crank.angle") > 0.6 - 1e-9);
    }
    assert!(highest > 0.8);
}

/// A lock catches at a bumper too, at the undeformed position of the bumper.
#[test]
fn a_lock_engages_at_a_bumper() {
    for damping in [0.0, 3e3] {
        let values = [("upstop.angle", -1.1), ("upstop.stiffness", 1e5), ("upstop.damping", damping)];
        for steps in [1, 20, 400] {
            let mut gear =
                Run::gear().with(&values).with(&[("upstop.rigid", false), ("uplock.engage", true)]).started();
            gear.steps(steps, 0.4);
            let (angle, speed) = (gear.get("crank.angle"), gear.get("crank.speed"));
            assert!((angle + 1.1).abs() < 1e-14 && speed == 0.0, "{angle} {speed}");
            // The actuator still pushes towards the stop.
            assert!(gear.get("uplock.force") < -1e3, "{}", gear.get("uplock.force"));
        }
    }
}

/// Two stops at one position, or closer together than the tolerance of a start, leave no travel.
#[test]
fn stops_at_one_position_hold_whatever_pushes() {
    for (gap, restitution) in [(0.0, 0.0), (0.0, 1.0), (5e-11, 0.5)] {
        for angle in [0.3, -0.5] {
            for (force, speed) in [(3e4, 0.0), (-3e4, 0.0), (0.0, 0.0), (3e4, 5.0), (-3e4, -5.0), (-1e4, 2.0)] {
                let mut gear = Run::gear().with(&[
                    ("upstop.angle", angle),
                    ("downstop.angle", angle + gap),
                    ("crank.start_angle", angle),
                    ("crank.start_speed", speed),
                    ("upstop.restitution", restitution),
                    ("downstop.restitution", restitution),
                    ("actuator.force", force),
                ]);
                gear.0.initialize().unwrap();
                for _ in 0..3 {
                    gear.step(0.01);
                    let (now, speed_now) = (gear.get("crank.angle"), gear.get("crank.speed"));
                    assert!((now - angle).abs() < 1e-15 && speed_now == 0.0, "{force} {speed}: {now} {speed_now}");
                    // Rounding of the work when a force of 3e4 N over less than 1 m reverses.
                    assert!(gear.get("energy.drift").abs() <= 3e4 * f64::EPSILON);
                    let [up, down] = ["upstop.torque", "downstop.torque"].map(|name| gear.get(name));
                    assert!((up != 0.0) != (down != 0.0), "one holds: {up} {down}");
                    assert!(up >= 0.0 && down <= 0.0);
                    gear.set("actuator.force", -force);
                }
            }
        }
    }
}

#[test]
fn a_step_may_be_as_long_as_time_is() {
    for h in [1e3, 1e9, 1e12, 1e15, 1e300] {
        let mut gear = gear(&[]);
        gear.step(h);
        assert!(gear.is("retracted") && gear.get("crank.speed") == 0.0, "{h:e}");
    }
}

/// A flight with a height within the rounding of the position counts as rest, and must not end beyond the stop.
#[test]
fn a_flight_within_rounding_is_rest() {
    for speed in [-1e-3, -1e-5, -1e-7, -1e-9, -1e-11, -1e-13] {
        for force in [-30_000.0, -3_000.0, 3_000.0] {
            for h in [1e-9, 1e-7, 1e-5, 1e-3, 0.03] {
                let mut gear =
                    gear(&[("crank.start_angle", 0.8), ("crank.start_speed", speed), ("actuator.force", force)]);
                gear.step(h);
                let angle = gear.get("crank.angle");
                assert!(angle <= 0.8 + 1e-15, "{speed} {force} {h}: {:e} beyond", angle - 0.8);
                assert!(gear.get("energy.drift").abs() < 1e-9, "{}", gear.get("energy.drift"));
            }
        }
    }
}

#[test]
fn contradictory_settings_are_rejected() {
    for (values, fragments) in [
        (&[("crank.start_angle", 0.9)][..], &["downstop.angle = 0.8", "0.9", "enabled"][..]),
        (&[("upstop.angle", 0.85)], &["upstop.angle = 0.85", "0.8"]),
        (&[("friction.kinetic_speed", 0.005)], &["friction.kinetic_speed = 0.005", "friction.static_speed = 0.01"]),
    ] {
        assert_says(Run::gear().with(values).refusal(), fragments);
    }
    for (name, value, allowed) in [
        ("friction.static_coefficient", -0.1, ">= 0"),
        ("friction.kinetic_coefficient", -0.1, ">= 0"),
        ("friction.static_speed", 0.0, "> 0"),
        ("joint1.pin_radius", -0.01, ">= 0"),
        ("upstop.restitution", 1.1, "from 0 to 1"),
        ("upstop.restitution", -0.1, "from 0 to 1"),
        ("air.density", -1.0, ">= 0"),
        ("leg.width", -1.0, ">= 0"),
        ("wheel.drag_coefficient", f64::NAN, ">= 0"),
        ("upstop.stiffness", -1.0, ">= 0"),
    ] {
        assert_says(Run::gear().0.set(name, value).unwrap_err(), &[name, allowed]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Random drops and locks: no missed contact, no gain of energy, rest when pressed.
    #[test]
    fn drops_and_locks_never_gain_energy(
        start in -1.29..0.79f64,
        speed in -20.0..20.0f64,
        restitution in 0.0..0.95f64,
        forces in proptest::collection::vec((-30_000.0..30_000.0f64, any::<bool>(), any::<bool>(), 1e-4..0.1f64),
            1..12),
        friction in any::<bool>(),
        factor in -3.0..3.0f64,
        parts in 1..40u32,
    ) {
        let mut gear = Run::gear()
            .with(&[("friction.enabled", friction)])
            .with(&[("crank.start_angle", start), ("crank.start_speed", speed), ("load_factor", factor)])
            .with(&[("upstop.restitution", restitution), ("downstop.restitution", restitution)])
            .started();
        for (next, up, down, h) in forces {
            gear.set("actuator.force", next);
            gear.set("uplock.engage", up);
            gear.set("downlock.engage", down);
            let total =
                |g: &mut Run| g.get("energy.kinetic") + g.get("energy.potential") - next * g.get("actuator.length");
            let held = (gear.is("retracted") && up || gear.is("extended") && down) && gear.get("crank.speed") == 0.0;
            let (before, angle) = (total(&mut gear), gear.get("crank.angle"));
            for _ in 0..parts {
                gear.step(h / f64::from(parts));
                let now = gear.get("crank.angle");
                prop_assert!((-1.3 - 1e-12..=0.8 + 1e-12).contains(&now), "contact missed at {now}");
            }
            read_all(&mut gear);
            let after = total(&mut gear);
            // The tolerance 1e-9 of the energies of some 1e4 J, times the number of flights.
            prop_assert!(after <= before + 1e-3, "gained {}", after - before);
            prop_assert!(gear.get("energy.drift").abs() < 1e-2, "drift {}", gear.get("energy.drift"));
            if held {
                prop_assert_eq!(gear.get("crank.angle"), angle);
            }
        }
    }
}

/// A rotating crank has no end of travel at a stop that no number of revolutions reaches. The search for the stop ends.
#[test]
fn a_stop_beyond_all_numbers_is_never_reached() {
    for angle in [1e17, 1e100] {
        let mut crank = Run::new(changed(SLIDER_CRANK, |m| {
            m["stops"] = json!({ "far": { "body": "crank", "limit": "upper", "angle": angle } });
        }))
        .started();
        crank.step(0.1);
        assert!(!crank.0.boolean("far.reached").unwrap());
    }
}

/// A block of 2 kg on rubber of 10 kN/m: its static deflection is m g / k = 1.962 mm.
#[test]
fn a_mechanism_may_start_on_its_bumper() {
    const DEPTH: f64 = 2.0 * 9.81 / 1e4;
    let on_rubber = |start: Value| {
        let mut definition = block(2.0).with(json!({
            "joints": { "slide": { "axis_angle": FRAC_PI_2 } }, "gravity": weight(), "guess": { "slide": 0.1 },
            "stops": { "rubber": { "joint": "slide", "limit": "lower", "position": 0, "rigid": false, "stiffness": 1e4,
                "damping": 50 }, "end": { "joint": "slide", "limit": "lower", "position": -0.01 } },
        }));
        definition["start"] = start;
        definition
    };
    for start in [
        json!("equilibrium"),
        json!({ "joint": "slide", "position": -DEPTH }),
        json!({ "joint": "slide", "position": 0.05, "equilibrium": true }),
    ] {
        let mut run = Run::new(on_rubber(start.clone())).started();
        for _ in 0..10 {
            // The tolerance of positions is relative to 1 rad, here 1 m.
            assert!((run.get("slide.position") + DEPTH).abs() < 1e-8, "{start}: {}", run.get("slide.position"));
            assert!((run.get("rubber.force") - 2.0 * 9.81).abs() < 1e-4 && run.is("rubber.reached"), "{start}");
            run.step(0.1);
        }
        let equilibria = run.equilibria().unwrap();
        let [only] = &equilibria[..] else { panic!("{equilibria:?}") };
        assert!(
            only.is_stable && (only.stiffness - 5e3).abs() < 1e-6 && (only.damping - 25.0).abs() < 1e-8,
            "{only:?}"
        );
    }
    // From half of the deflection the block moves like a damped oscillator.
    let mut run = Run::new(on_rubber(json!({ "joint": "slide", "position": -0.5 * DEPTH }))).started();
    let (rate, omega) = (12.5, (5e3f64 - 12.5 * 12.5).sqrt());
    for k in 1..=20 {
        run.step(0.002);
        let t = 0.002 * f64::from(k);
        let (sin, cos) = (omega * t).sin_cos();
        let exact = -DEPTH + 0.5 * DEPTH * (-rate * t).exp() * (cos + rate / omega * sin);
        assert!((run.get("slide.position") - exact).abs() < 1e-8, "{k}: {} {exact}", run.get("slide.position"));
    }
    assert!(run.get("energy.drift").abs() < 1e-8);
    // A start beyond a rigid stop is rejected.
    let beyond = on_rubber(json!({ "joint": "slide", "position": -0.011 }));
    assert_says(refusal(beyond), &["end.position", "beyond this stop"]);
}
