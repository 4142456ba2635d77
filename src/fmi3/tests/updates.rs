//! Intermediate updates: what the callback may do, and where it ends a step.
use super::super::step::{intermediate_update, set_update};
use super::super::types::{Boolean, Environment};
use super::*;

const TOLERANCE: f64 = 1e-12;

/// A host with its instance, and what its callback has read: times and angles of the crank.
struct Host {
    c: Instance,
    told: Vec<[f64; 2]>,
    /// The callback asks for the end of the step at this time [s] once it is called after `asks_from`.
    asks_from: f64,
    stop: f64,
    /// Value references of the angle of the crank, the time, and the force of the actuator.
    references: [ValueReference; 3],
}

#[allow(clippy::too_many_arguments)]
unsafe extern "C-unwind" fn on_update(
    environment: Environment,
    time: f64,
    set_requested: Boolean,
    get_allowed: Boolean,
    step_finished: Boolean,
    can_return_early: Boolean,
    return_requested: *mut Boolean,
    return_time: *mut f64,
) {
    // SAFETY: the environment is the test's host, the pointers lead to one value each.
    unsafe {
        let host = &mut *environment.cast::<Host>();
        assert_eq!([set_requested, get_allowed, step_finished, can_return_early], [0, 1, 1, 1]);
        let [angle, now, force] = host.references;
        let [angle, now] = get(host.c, &[angle, now]);
        assert_eq!(now, time);
        host.told.push([time, angle]);
        // Nothing but reading is allowed, and the instance stays.
        assert_eq!(fmi3SetFloat64(host.c, &force, 1, &1.0, 1), Status::Error);
        assert_eq!(fmi3DoStep(host.c, time, 1e-3, 1, &mut 0, &mut 0, &mut 0, &mut 0.0), Status::Error);
        assert_eq!((fmi3Reset(host.c), fmi3Terminate(host.c)), (Status::Error, Status::Error));
        fmi3FreeInstance(host.c);
        if time >= host.asks_from {
            (*return_requested, *return_time) = (1, host.stop);
        }
    }
}

/// A host in step mode, whose callback asks for nothing.
fn host() -> *mut Host {
    let usage = Usage { event_mode: false, early_return: true, intermediate_update: true, model_exchange: false };
    let c = gear_for(usage);
    let (asks_from, stop) = (f64::INFINITY, 0.0);
    let references = references(["crank.angle", "time", "actuator.force"]);
    let host = Box::into_raw(Box::new(Host { c, told: Vec::new(), asks_from, stop, references }));
    // SAFETY: the instance is valid.
    unsafe {
        set_update(c, intermediate_update(on_update, host.cast(), true));
        assert_eq!(fmi3EnterInitializationMode(c, 1, TOLERANCE, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(c), Status::Ok);
    }
    host
}

/// A step: status, whether an event is needed, whether it returned early, time reached.
fn advance(c: Instance, point: f64, h: f64) -> (Status, [u8; 2], f64) {
    let (mut flags, mut last) = ([7; 3], f64::NAN);
    let [event, terminate, early] = &mut flags;
    // SAFETY: the instance is valid, each pointer leads to one value.
    let status = unsafe { fmi3DoStep(c, point, h, 1, event, terminate, early, &mut last) };
    (status, [flags[0], flags[2]], last)
}

fn angle_at(time: f64) -> f64 {
    let c = gear();
    // SAFETY: the instance is valid until it is freed.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(c, 1, TOLERANCE, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(c), Status::Ok);
        assert_eq!(advance(c, 0.0, time).0, Status::Ok);
        let [angle] = get(c, &references(["crank.angle"]));
        fmi3FreeInstance(c);
        angle
    }
}

/// Also past the impact on the up stop.
#[test]
fn the_callback_reads_values_after_each_internal_step() {
    let host = host();
    // SAFETY: the host and its instance are valid until they are freed; no reference to the host lives during a call.
    unsafe {
        let c = (*host).c;
        assert_eq!(advance(c, 0.0, 0.15), (Status::Ok, [0, 0], 0.15));
        let told = std::mem::take(&mut (*host).told);
        assert!(told.len() > 5 && told.windows(2).all(|pair| pair[0][0] < pair[1][0]));
        assert!(told.iter().all(|[time, _]| 0.0 < *time && *time < 0.15));
        for [time, angle] in told.into_iter().step_by(3) {
            assert!((angle - angle_at(time)).abs() < 1e-9, "{time}: {angle}");
        }
        let [angle] = get(c, &references(["crank.angle"]));
        assert!((angle - angle_at(0.15)).abs() < 1e-12);
        fmi3FreeInstance(c);
        drop(Box::from_raw(host));
    }
}

#[test]
fn the_callback_ends_a_step() {
    let host = host();
    // SAFETY: as above.
    unsafe {
        let c = (*host).c;
        ((*host).asks_from, (*host).stop) = (0.05, 0.0625);
        assert_eq!(advance(c, 0.0, 0.13), (Status::Ok, [0, 1], 0.0625));
        let [angle, time] = get(c, &references(["crank.angle", "time"]));
        assert!(time == 0.0625 && (angle - angle_at(0.0625)).abs() < 1e-9);
        // A time in the past is now: the step ends after its first internal step.
        ((*host).asks_from, (*host).stop) = (0.0, -1.0);
        (*host).told.clear();
        let (status, flags, last) = advance(c, 0.0625, 0.0675);
        assert_eq!((status, flags, (*host).told.len()), (Status::Ok, [0, 1], 1));
        assert_eq!(last, (&(*host).told)[0][0]);
        (*host).asks_from = f64::INFINITY;
        assert_eq!(advance(c, last, 0.13 - last).1, [0, 0]);
        let [angle] = get(c, &references(["crank.angle"]));
        assert!((angle - angle_at(0.13)).abs() < 1e-9);
        fmi3FreeInstance(c);
        drop(Box::from_raw(host));
    }
}
