//! The clock: large start times, steps of one unit in the last place, ten million steps. Steps without a solution.

use crate::host::Gear;
use linkage_fmu::fmi2::fmi2GetRealStatus;
use linkage_fmu::fmi2::types::{LAST_SUCCESSFUL_TIME, Status};

/// Bits of the angle and the speed.
fn state(gear: &Gear) -> [u64; 2] {
    ["crank.angle", "crank.speed"].map(|name| gear.get(name).unwrap().to_bits())
}

fn time(gear: &Gear) -> f64 {
    let mut time = f64::NAN;
    // SAFETY: the component is valid, with room for one value.
    let status = unsafe { fmi2GetRealStatus(gear.c, LAST_SUCCESSFUL_TIME, &mut time) };
    assert_eq!(status, Status::Ok);
    time
}

/// The motion does not depend on the absolute time: equal steps from 0 and from +-1e9 s, where the last place is 1.2e-7
/// s, give bit-identical results, for each way in which a host computes its communication points.
#[test]
fn a_start_at_a_billion_seconds_changes_no_bit() {
    const STEP: f64 = 1e-3;
    let near = Gear::stepping(0.0, None);
    for k in 0..130 {
        assert_eq!(near.step(f64::from(k) * STEP, STEP), Status::Ok);
    }
    for start in [1e9, -1e9] {
        let (formed, summed) = (Gear::stepping(start, None), Gear::stepping(start, Some(start + 0.2)));
        let mut point = start;
        for k in 0..130 {
            assert_eq!(formed.step(start + f64::from(k) * STEP, STEP), Status::Ok);
            assert_eq!(summed.step(point, STEP), Status::Ok);
            point += STEP;
        }
        assert_eq!(state(&formed), state(&near));
        assert_eq!(state(&summed), state(&near));
        // The end of the last step, rounded once.
        assert_eq!(time(&formed), start + 129.0 * STEP + STEP);
        assert_eq!(time(&summed), point);
        // A communication point that is wrong by one step is rejected, for any time.
        assert_eq!(formed.step(start + 131.0 * STEP, STEP), Status::Error);
        assert!(formed.refusal().contains("currentCommunicationPoint"));
    }
}

/// Hosts pass a huge stop time for "no end". A lost or repeated step, or a step that is no number, is rejected
/// nevertheless.
#[test]
fn a_stop_time_without_end_hides_no_lost_step() {
    const STEP: f64 = 1e-3;
    for stop in [1e300, f64::MAX, 1e12] {
        let gear = Gear::stepping(0.0, Some(stop));
        for k in 0..20 {
            let point = f64::from(k) * STEP;
            let before = state(&gear);
            for wrong in [point + STEP, point - STEP, point + 0.02 * STEP, f64::NAN, 1e300, f64::INFINITY] {
                assert_eq!(gear.step(wrong, STEP), Status::Error, "{wrong} at {point}");
                assert!(gear.refusal().contains("currentCommunicationPoint"));
            }
            assert!(state(&gear) == before && (time(&gear) - point).abs() < 1e-15);
            assert_eq!(gear.step(point, STEP), Status::Ok);
            gear.log.take();
        }
    }
}

/// Steps of one unit in the last place of the time, from 1e-3 s and from 1e9 s on, end at the same state as one step of
/// their sum.
#[test]
fn steps_of_one_ulp_are_steps() {
    const STEPS: u32 = 100_000;
    /// The value of solver.tolerance in the file.
    const TOLERANCE: f64 = 1e-9;
    let falling = |start: f64| {
        let gear = Gear::new();
        assert_eq!(gear.set("crank.start_speed", -10.0), Status::Ok);
        assert_eq!(gear.set_up(None, start, None), Status::Ok);
        assert_eq!(gear.initialize(), Status::Ok);
        gear
    };
    for start in [1e-3_f64, 1e9] {
        let ulp = start.next_up() - start;
        let (gear, whole) = (falling(start), falling(0.0));
        let mut point = start;
        for _ in 0..STEPS {
            assert_eq!(gear.step(point, ulp), Status::Ok);
            point = point.next_up();
        }
        assert_eq!(time(&gear), point);
        assert_eq!(whole.step(0.0, f64::from(STEPS) * ulp), Status::Ok);
        let [angle, other] = [&gear, &whole].map(|gear| gear.get("crank.angle").unwrap());
        // In 0.012 s an error of the speed grows to less than its size. One long step needs at most some ten
        // integration steps.
        assert!((angle - other).abs() <= 10.0 * TOLERANCE * (0.8 - other) + 1e-13, "{start}: {angle} {other}");
        assert!(other < 0.8);
    }
}

/// Ten million steps of 10 ns through fmi2DoStep: theta2 of scene S1 at 0.1 s, and 0.1 s on the clock. A lost step
/// would be 2e-7 rad. The allowed error is the tolerance 1e-9 times its growth of some 50.
#[test]
fn ten_million_steps_lose_no_time() {
    const STEPS: u32 = 10_000_000;
    const STEP: f64 = 1e-8;
    let gear = Gear::stepping(0.0, None);
    for k in 0..STEPS {
        assert_eq!(gear.step(f64::from(k) * STEP, STEP), Status::Ok);
    }
    assert!((time(&gear) - 0.1).abs() <= 0.1 * f64::EPSILON, "{:e}", time(&gear) - 0.1);
    let error = gear.get("crank.angle").unwrap() + 0.409_135_231_200_168_4;
    assert!(error.abs() <= 5e-8, "{error:e}");
}

/// A step or an initialisation without a solution returns fmi2Error with a message.
#[test]
fn no_answer_is_an_error_with_a_message() {
    for (values, fragments) in [
        (&[("actuator.force", 1e308), ("crank.start_angle", 0.3)][..], &["solver.tolerance", "inputs"][..]),
        (&[("load_factor", -1e308), ("crank.start_angle", 0.3)], &["inputs"]),
    ] {
        let gear = Gear::new();
        for &(name, value) in values {
            assert_eq!(gear.set(name, value), Status::Ok);
        }
        // An energy beyond the largest number is an error of the initialisation, a force that no step can integrate an
        // error of the step.
        let mut status = gear.initialize();
        if status == Status::Ok {
            status = gear.step(0.0, 1e-3);
        }
        assert_eq!(status, Status::Error);
        let message = gear.log.take().pop().map_or_else(String::new, |last| last.text);
        assert!(fragments.iter().all(|f| message.contains(f)), "{message}");
    }
    for (name, value, fragment) in [
        ("crank.start_angle", -1.300_000_001, "beyond this stop"),
        ("crank.start_angle", 1.4, "beyond this stop"),
        ("crank.length", 1e-9, "close"),
        ("coupler.length", 1e9, "close"),
    ] {
        let gear = Gear::new();
        assert_eq!(gear.set(name, value), Status::Ok);
        assert_eq!(gear.initialize(), Status::Error, "{name} = {value}");
        let messages = gear.log.take();
        assert!(messages.iter().any(|m| m.text.contains(fragment)), "{name} = {value}: {messages:?}");
    }
}
