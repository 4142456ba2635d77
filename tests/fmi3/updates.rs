//! Intermediate updates: allowed calls in the callback, and the end of a step that the callback requests.
use crate::Fmu;
use linkage_fmu::fmi3::fmi3FreeInstance;
use linkage_fmu::fmi3::host::{Calls, Wishes};
use linkage_fmu::fmi3::types::Status;
use std::cell::{Cell, RefCell};
use std::rc::Rc;

const TOLERANCE: f64 = 1e-12;

/// Times and crank angles that the callback has read. From the first time [s] of `asks` on, the callback requests the
/// end of the step at the second time.
#[derive(Default)]
struct Updates {
    read: RefCell<Vec<[f64; 2]>>,
    asks: Cell<Option<[f64; 2]>>,
}

/// An instance in step mode, whose callback requests nothing yet.
fn with_updates() -> (Fmu, Rc<Updates>) {
    let updates = Rc::new(Updates::default());
    let references = Fmu::stepping().vrs(["crank.angle", "time", "actuator.force"]);
    let kept = Rc::clone(&updates);
    let update = move |calls: &Calls, time: f64| {
        let [angle, now, force] = references;
        let mut values = [f64::NAN; 2];
        assert_eq!(calls.reals(&[angle, now], &mut values), Status::Ok);
        assert_eq!(values[1], time);
        kept.read.borrow_mut().push([time, values[0]]);
        // The callback may only read, and the instance remains valid.
        assert_eq!(calls.set_reals(&[force], &[1.0]), Status::Error);
        assert_eq!(calls.step(time, 1e-3).0, Status::Error);
        assert_eq!((calls.reset(), calls.terminate()), (Status::Error, Status::Error));
        // SAFETY: the instance is valid; within a callback it is not freed.
        unsafe { fmi3FreeInstance(calls.instance()) };
        kept.asks.get().and_then(|[from, stop]| (time >= from).then_some(stop))
    };
    let gear = Fmu::gear(Wishes { early_return: true, update: Some(Box::new(update)), ..Wishes::default() });
    gear.initialize(TOLERANCE);
    (gear, updates)
}

fn angle_at(time: f64) -> f64 {
    let gear = Fmu::gear(Wishes::default());
    gear.initialize(TOLERANCE);
    gear.whole_step(0.0, time);
    gear.get(["crank.angle"])[0]
}

/// The callback also reads values after the impact on the up stop.
#[test]
fn the_callback_reads_values_after_each_internal_step() {
    let (gear, updates) = with_updates();
    gear.whole_step(0.0, 0.15);
    let read = updates.read.take();
    assert!(read.len() > 5 && read.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    assert!(read.iter().all(|[time, _]| 0.0 < *time && *time < 0.15));
    for [time, angle] in read.into_iter().step_by(3) {
        assert!((angle - angle_at(time)).abs() < 1e-9, "{time}: {angle}");
    }
    assert!((gear.get(["crank.angle"])[0] - angle_at(0.15)).abs() < 1e-12);
}

#[test]
fn the_callback_ends_a_step() {
    let (gear, updates) = with_updates();
    let early = |point: f64, h: f64| {
        let (status, stepped) = gear.step(point, h);
        assert_eq!((status, stepped.event, stepped.early), (Status::Ok, false, true));
        stepped.last
    };
    updates.asks.set(Some([0.05, 0.0625]));
    assert_eq!(early(0.0, 0.13), 0.0625);
    let [angle, time] = gear.get(["crank.angle", "time"]);
    assert!(time == 0.0625 && (angle - angle_at(0.0625)).abs() < 1e-9);
    // A requested time in the past ends the step after its first internal step.
    updates.asks.set(Some([0.0, -1.0]));
    updates.read.take();
    let last = early(0.0625, 0.0675);
    let read = updates.read.take();
    assert_eq!((read.len(), last), (1, read[0][0]));
    updates.asks.set(None);
    let (status, stepped) = gear.step(last, 0.13 - last);
    assert_eq!((status, stepped.event, stepped.early), (Status::Ok, false, false));
    assert!((gear.get(["crank.angle"])[0] - angle_at(0.13)).abs() < 1e-9);
}
