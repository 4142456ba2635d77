//! A step that `solver.max_steps` interrupts returns fmi2Discard. The calls that may follow are those of FMI 2.0.5,
//! 4.2.2, and of the state stepFailed in 4.2.4. A step that is rejected at its start returns fmi2Error, and the
//! instance continues.

use crate::host::Gear;
use linkage_fmu::fmi2::host::State;
use linkage_fmu::fmi2::types::{DO_STEP_STATUS, LAST_SUCCESSFUL_TIME, PENDING_STATUS, Status, TERMINATED};
use linkage_fmu::fmi2::{
    fmi2GetBooleanStatus, fmi2GetDirectionalDerivative, fmi2GetRealOutputDerivatives, fmi2GetRealStatus, fmi2GetStatus,
    fmi2SetRealInputDerivatives,
};

const START: f64 = 5.0;

/// An instance at its start with this limit of integration steps per communication step.
fn bounded(max_steps: f64, friction: bool) -> Gear {
    let gear = Gear::new();
    assert_eq!(gear.set("solver.max_steps", max_steps), Status::Ok);
    assert_eq!(gear.set_boolean("friction.enabled", friction), Status::Ok);
    assert_eq!(gear.set_up(None, START, None), Status::Ok);
    assert_eq!(gear.initialize(), Status::Ok);
    gear.log.take();
    gear
}

fn last_time(gear: &Gear) -> f64 {
    let mut time = f64::NAN;
    // SAFETY: the component is valid, room for one value.
    assert_eq!(unsafe { fmi2GetRealStatus(gear.c, LAST_SUCCESSFUL_TIME, &mut time) }, Status::Ok);
    time
}

fn status(gear: &Gear) -> Status {
    let mut status = Status::Pending;
    // SAFETY: the component is valid, room for one value.
    assert_eq!(unsafe { fmi2GetStatus(gear.c, DO_STEP_STATUS, &mut status) }, Status::Ok);
    status
}

fn set_derivative(gear: &Gear, name: &str, order: i32, value: f64) -> Status {
    // SAFETY: the component is valid; one reference, one order, one value.
    unsafe { fmi2SetRealInputDerivatives(gear.c, &gear.vr(name), 1, &order, &value) }
}

#[test]
fn a_step_in_part_is_discarded_and_can_be_read() {
    for friction in [false, true] {
        let gear = bounded(6.0, friction);
        let before = gear.save();
        assert_eq!(set_derivative(&gear, "actuator.force", 1, -1e4), Status::Ok);
        assert_eq!(gear.step(START, 0.13), Status::Discard);
        let messages = gear.log.take();
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert_eq!((messages[0].status, messages[0].category.as_str()), (2, "logStatusDiscard"));
        for piece in ["fmi2DoStep: ", "solver.max_steps = 6", "of 0.13 s", "shorter communication steps", "steps"] {
            assert!(messages[0].text.contains(piece), "{messages:?}");
        }
        // The time reached.
        let time = last_time(&gear) - START;
        assert!(time > 0.0 && time < 0.13, "{time}");
        assert_eq!(status(&gear), Status::Discard);
        let mut terminated = 7;
        // SAFETY: the component is valid, room for one value.
        assert_eq!(unsafe { fmi2GetBooleanStatus(gear.c, TERMINATED, &mut terminated) }, Status::Ok);
        assert_eq!(terminated, 0);
        // SAFETY: as before.
        assert_eq!(unsafe { fmi2GetBooleanStatus(gear.c, PENDING_STATUS, &mut terminated) }, Status::Discard);
        // The values are those of a step up to the time reached, and the input has its value at this time.
        let force = gear.get("actuator.force").unwrap();
        assert!((force - (3e4 - 1e4 * time)).abs() < 1e-9 * 3e4, "{force}");
        let twin = bounded(1e6, friction);
        assert_eq!(set_derivative(&twin, "actuator.force", 1, -1e4), Status::Ok);
        assert_eq!(twin.step(START, time), Status::Ok, "{:?}", twin.log.take());
        for name in ["crank.angle", "crank.speed", "wheel.x", "joint1.force", "energy.drift"] {
            let [a, b] = [gear.get(name).unwrap(), twin.get(name).unwrap()];
            assert!((a - b).abs() <= 1e-6 * (1.0 + b.abs()), "{name}: {a} {b}");
        }
        assert!(gear.all_bits().iter().zip(twin.all_bits()).all(|(a, b)| a.0 == b.0), "what can be read");
        continues_from_a_saved_state(&gear, before);
    }
}

/// An interrupted instance allows exactly the calls of the state stepFailed. A state saved before the step restores the
/// instance.
fn continues_from_a_saved_state(gear: &Gear, mut before: State) {
    let (angle, time) = (gear.get("crank.angle").unwrap(), last_time(gear));
    gear.log.take();
    assert_eq!(gear.step(time, 1e-3), Status::Error);
    let refusal = gear.refusal();
    assert!(refusal.contains("solver.max_steps") && refusal.contains("fmi2DoStep"), "{refusal}");
    assert_eq!(gear.set("actuator.force", 1.0), Status::Error);
    assert_eq!(set_derivative(gear, "actuator.force", 1, 1.0), Status::Error);
    assert_eq!(gear.set_up(None, 0.0, None), Status::Error);
    assert_eq!([gear.enter(), gear.exit()], [Status::Error; 2]);
    let (output, input, mut value) = (gear.vr("crank.acceleration"), gear.vr("actuator.force"), 0.0);
    // SAFETY: the component is valid; one unknown, one known, one value; one reference, one order, one value.
    unsafe {
        assert_eq!(fmi2GetDirectionalDerivative(gear.c, &output, 1, &input, 1, &1.0, &mut value), Status::Ok);
        assert_eq!(fmi2GetRealOutputDerivatives(gear.c, &gear.vr("crank.angle"), 1, &1, &mut value), Status::Ok);
    }
    let speed = gear.get("crank.speed").unwrap();
    assert!((value - speed).abs() <= 1e-12 * speed.abs());
    // A state of the interrupted instance restores the same phase, time and values in another instance, through bytes.
    let mut state = gear.save();
    let bytes = gear.serialize(&state).unwrap();
    let other = Gear::new();
    let mut copy = other.deserialize(&bytes).unwrap();
    assert_eq!(other.restore(&copy), Status::Ok);
    other.log.take();
    assert_eq!((last_time(&other), status(&other)), (time, Status::Discard));
    assert_eq!(other.get("crank.angle"), Ok(angle));
    assert_eq!(other.step(time, 1e-3), Status::Error);
    assert_eq!(other.serialize(&other.save()).unwrap(), bytes);
    // Restore the state saved before the step.
    assert_eq!(gear.restore(&before), Status::Ok);
    assert_eq!((last_time(gear), status(gear)), (START, Status::Ok));
    let mut t = START;
    while t < START + 0.02 {
        assert_eq!(gear.step(t, 1e-3), Status::Ok, "{:?}", gear.log.take());
        t += 1e-3;
    }
    // Restore the interrupted state, then terminate, and reset.
    assert_eq!(gear.restore(&state), Status::Ok);
    assert_eq!(gear.get("crank.angle"), Ok(angle));
    assert_eq!(gear.terminate(), Status::Ok);
    assert_eq!(gear.get("crank.angle"), Ok(angle));
    assert_eq!(gear.restore(&state), Status::Ok);
    assert_eq!(gear.reset(), Status::Ok);
    assert_eq!(gear.initialize(), Status::Ok);
    assert_eq!(gear.step(0.0, 0.13), Status::Ok);
    [&mut state, &mut before].into_iter().for_each(|state| assert_eq!(gear.free(state), Status::Ok));
    assert_eq!(other.free(&mut copy), Status::Ok);
}

/// If an input, or the load of an input, overflows at the end of a step, the step is rejected at its start. The
/// instance continues as without this call.
#[test]
fn a_step_rejected_before_its_start_does_not_change_the_phase() {
    for (name, order, value, h) in [
        ("actuator.force", 1, 1e308, 100.0),
        ("airspeed", 2, -1e308, 100.0),
        ("actuator.demanded_acceleration", 2, 1e308, 100.0),
        ("load_factor", 1, 1e308, 1.0),
        ("load_factor", 0, -1e308, 1e-3),
        ("airspeed", 0, 1e200, 1e-3),
    ] {
        let (gear, twin) = (bounded(1e5, false), bounded(1e5, false));
        for gear in [&gear, &twin] {
            assert_eq!(gear.step(START, 1e-2), Status::Ok);
        }
        let now = gear.get(name).unwrap();
        let accepted = if order == 0 { gear.set(name, value) } else { set_derivative(&gear, name, order, value) };
        assert_eq!(accepted, Status::Ok, "{name}");
        gear.log.take();
        assert_eq!(gear.step(START + 1e-2, h), Status::Error, "{name}");
        assert!(gear.refusal().contains(name));
        assert_eq!((last_time(&gear), status(&gear)), (START + 1e-2, Status::Ok));
        let mended = if order == 0 { gear.set(name, now) } else { set_derivative(&gear, name, order, 0.0) };
        assert_eq!(mended, Status::Ok, "{name}");
        for gear in [&gear, &twin] {
            assert_eq!(gear.step(START + 1e-2, 1e-2), Status::Ok, "{name}: {:?}", gear.log.take());
        }
        assert_eq!(gear.all_bits(), twin.all_bits(), "{name}");
    }
    // A step that cannot be computed fails and changes the phase.
    let gear = bounded(1e5, false);
    assert_eq!(gear.set("actuator.force", 1e300), Status::Ok);
    assert_eq!(gear.step(START, 1e-3), Status::Error);
    assert_eq!(status(&gear), Status::Error);
    assert_eq!(gear.set("actuator.force", 1.0), Status::Error);
}
