//! Random calls, and a model of their statuses: phases by `standard`, a clock, and the forces under which a step fails.

use super::calls::{self, Call, Target};
use super::standard::{Phase, is_legal};
use crate::host::Gear;
use linkage_fmu::fmi2::types::{FmuState, Status, Text};
use linkage_fmu::fmi2::*;
use proptest::prelude::*;
use std::ffi::{CStr, c_int};
use std::ptr::null_mut;

/// One call of a sequence.
#[derive(Clone, Debug)]
pub enum Op {
    /// Tolerance, start and length.
    Setup(Option<f64>, f64, Option<f64>),
    Enter,
    Exit,
    Terminate,
    Reset,
    SetForce(f64),
    /// The derivative of this order of the force, for the next step.
    SetForceRate(c_int, f64),
    SetStartAngle(f64),
    SetCrankLength(f64),
    ReadAngle,
    ReadSome,
    Step(f64),
    /// A step of this size from a communication point that is wrong by this number of steps.
    StepFromElsewhere(f64, f64),
    Logging(Logging),
    /// Save a state, either a new one or over the last one.
    Save,
    /// Continue from the saved state, if there is one.
    Restore,
    /// Serialize and deserialize the saved state.
    Serialize,
    Free,
    /// One of the calls of `calls` that are rejected in this phase, or have no effect.
    Other(usize),
}

#[derive(Clone, Copy, Debug)]
pub enum Logging {
    AllOn,
    AllOff,
    DebugOff,
    ErrorsOnly,
    DiscardsOff,
}

impl Logging {
    pub const ALL: [Self; 5] = [Self::AllOn, Self::AllOff, Self::DebugOff, Self::ErrorsOnly, Self::DiscardsOff];
}

/// Largest number of calls of a sequence.
pub const LONGEST: usize = 80;

/// With larger forces a step fails.
const ABSURD: f64 = 1e100;

/// The part of an instance that a saved state restores.
#[derive(Clone, Copy)]
struct Past {
    phase: Phase,
    start: f64,
    time: f64,
    stop: Option<f64>,
    force: f64,
    /// Derivatives of order 1 and 2 in the next step.
    rates: [f64; 2],
}

/// An instance with the model of its statuses.
pub struct Player {
    pub gear: Gear,
    target: Target,
    others: Vec<Call>,
    now: Past,
    state: FmuState,
    saved: Option<Past>,
    logs_errors: bool,
    logs_discards: bool,
    /// Variables that a rejected call must not change. They can be read fast in every phase.
    watched: Vec<u32>,
}

impl Past {
    const FRESH: Self =
        Past { phase: Phase::Instantiated, start: 0.0, time: 0.0, stop: None, force: 30_000.0, rates: [0.0; 2] };
}

impl Drop for Player {
    fn drop(&mut self) {
        // SAFETY: the component is valid, the state is one of its own or NULL.
        unsafe { fmi2FreeFMUstate(self.gear.c, &mut self.state) };
    }
}

impl Player {
    pub fn new() -> Self {
        let gear = Gear::new();
        gear.log.take();
        let target = Target::of(&gear);
        let names =
            ["actuator.force", "crank.start_angle", "crank.length", "crank.angle", "crank.speed", "energy.drift"];
        let watched = names.map(|name| gear.vr(name)).to_vec();
        // Calls with states have separate kinds, which free the states that they save.
        let own = |function: &str| function == "fmi2DoStep" || function.contains("FMUstate");
        let others = calls::all().into_iter().filter(|call| !own(call.function)).collect();
        let (now, state, saved) = (Past::FRESH, null_mut(), None);
        Player { gear, target, others, now, state, saved, logs_errors: true, logs_discards: true, watched }
    }

    /// Number of calls that [`Op::Other`] can select.
    pub fn others(&self) -> usize {
        self.others.len()
    }

    /// Return to the state after `new`.
    pub fn renew(&mut self) {
        self.play(&Op::Reset);
        self.play(&Op::Free);
        self.play(&Op::Logging(Logging::AllOn));
    }

    /// Bits of the watched variables, 0 for a variable that cannot be read.
    fn watch(&self) -> Vec<u64> {
        let bits = self.watched.iter().map(|reference| self.gear.bits(*reference).1).collect();
        self.gear.log.take();
        bits
    }

    /// Make the call and compare the answer with the model, the log and, if it was rejected, the watched values.
    /// Returns whether it was accepted.
    pub fn play(&mut self, op: &Op) -> bool {
        let Some(expected) = self.expected(op) else { return false };
        let refused = expected != Status::Ok;
        // A step that cannot be computed changes only the phase.
        let before = refused.then(|| self.watch());
        let phase = self.now.phase;
        let status = self.call(op);
        assert_eq!(status, expected, "{op:?} in {phase:?}: {:?}", self.gear.log.take());
        let complaints = self.gear.log.take().iter().filter(|m| m.status >= Status::Discard as c_int).count();
        let logged = match expected {
            Status::Ok => false,
            Status::Discard => self.logs_discards,
            _ => self.logs_errors,
        };
        assert_eq!(complaints, usize::from(logged), "{op:?} in {phase:?}");
        if let Some(before) = before {
            let after = self.watch();
            if self.fails(op) {
                self.now.phase = Phase::Failed;
            }
            assert_eq!(after, before, "{op:?} in {phase:?}");
        } else {
            self.accepted(op);
        }
        !refused
    }

    /// Status according to the standard. None if rounding decides.
    fn expected(&self, op: &Op) -> Option<Status> {
        let ok_if = |fine: bool| Some(if fine { Status::Ok } else { Status::Error });
        let legal = |function: &str| is_legal(function, self.now.phase);
        match op {
            Op::Setup(tolerance, start, length) => ok_if(
                legal("fmi2SetupExperiment")
                    && start.is_finite()
                    && length.is_none_or(|length| start + length >= *start && length.is_finite())
                    && tolerance.is_none_or(|tolerance| tolerance == 0.0 || (1e-14..=1e-2).contains(&tolerance)),
            ),
            Op::Enter => ok_if(legal("fmi2EnterInitializationMode")),
            Op::Exit => ok_if(legal("fmi2ExitInitializationMode")),
            Op::Terminate => ok_if(legal("fmi2Terminate")),
            Op::Reset => ok_if(legal("fmi2Reset")),
            Op::SetForce(force) => ok_if(legal("fmi2SetReal") && force.is_finite()),
            Op::SetForceRate(order, value) => {
                ok_if(legal("fmi2SetRealInputDerivatives") && value.is_finite() && [1, 2].contains(order))
            }
            // Parameters: before the end of initialization mode (2.2.7).
            Op::SetStartAngle(value) => ok_if(self.is_early() && value.is_finite()),
            Op::SetCrankLength(value) => ok_if(self.is_early() && value.is_finite() && *value > 0.0),
            Op::ReadAngle => ok_if(self.now.phase != Phase::Instantiated),
            Op::ReadSome => ok_if(true),
            Op::Step(h) => {
                let good = legal("fmi2DoStep") && *h > 0.0 && h.is_finite();
                match self.now.stop.map(|stop| self.now.time + h - stop) {
                    Some(past) if good && past.abs() < 0.3 * h => None,
                    Some(past) => ok_if(good && past < 0.0 && !self.is_absurd()),
                    None => ok_if(good && !self.is_absurd()),
                }
            }
            Op::StepFromElsewhere(..) => Some(Status::Error),
            Op::Logging(_) => ok_if(legal("fmi2SetDebugLogging")),
            Op::Save => ok_if(legal("fmi2GetFMUstate")),
            Op::Restore => ok_if(legal("fmi2SetFMUstate") && self.saved.is_some()),
            Op::Serialize => ok_if(legal("fmi2SerializeFMUstate") && self.saved.is_some()),
            Op::Free => ok_if(legal("fmi2FreeFMUstate")),
            Op::Other(index) => {
                let (call, expected) = (&self.others[*index], self.others[*index].expected(self.now.phase));
                let harmless = call.function.starts_with("fmi2Get") || call.function == "fmi2FreeFMUstate";
                (harmless || expected != Status::Ok).then_some(expected)
            }
        }
    }

    /// Whether a step is accepted but cannot be computed.
    fn fails(&self, op: &Op) -> bool {
        let in_time = |h: f64| self.now.stop.is_none_or(|stop| self.now.time + h < stop);
        matches!(op, Op::Step(h) if *h > 0.0 && h.is_finite() && in_time(*h))
            && self.now.phase == Phase::Step
            && self.is_absurd()
    }

    /// Whether the force is absurd and no stop balances it. The gear rests at its up stop or at its down stop.
    fn is_absurd(&self) -> bool {
        if self.now.force.abs() <= ABSURD {
            return false;
        }
        let mut values = [0.0; 2];
        let status = self.gear.reals(&self.watched[3..5], &mut values);
        let [angle, speed] = values;
        let pressed = (angle < -1.299 && self.now.force > 0.0) || (angle > 0.799 && self.now.force < 0.0);
        !(status == Status::Ok && speed == 0.0 && pressed)
    }

    /// Whether a step could not be computed.
    pub fn has_failed(&self) -> bool {
        self.now.phase == Phase::Failed
    }

    fn is_early(&self) -> bool {
        matches!(self.now.phase, Phase::Instantiated | Phase::Initialization)
    }

    fn call(&mut self, op: &Op) -> Status {
        let c = self.gear.c;
        // SAFETY: the component is valid; every array has the length that is passed.
        unsafe {
            match op {
                Op::Setup(tolerance, start, length) => {
                    self.gear.set_up(*tolerance, *start, length.map(|length| start + length))
                }
                Op::Enter => fmi2EnterInitializationMode(c),
                Op::Exit => fmi2ExitInitializationMode(c),
                Op::Terminate => fmi2Terminate(c),
                Op::Reset => fmi2Reset(c),
                Op::SetForce(value) => fmi2SetReal(c, &self.watched[0], 1, value),
                Op::SetForceRate(order, value) => fmi2SetRealInputDerivatives(c, &self.watched[0], 1, order, value),
                Op::SetStartAngle(value) => fmi2SetReal(c, &self.watched[1], 1, value),
                Op::SetCrankLength(value) => fmi2SetReal(c, &self.watched[2], 1, value),
                Op::ReadAngle => fmi2GetReal(c, &self.watched[3], 1, &mut 0.0),
                Op::ReadSome => fmi2GetReal(c, self.watched.as_ptr(), 3, [0.0; 3].as_mut_ptr()),
                Op::Step(h) => fmi2DoStep(c, self.now.time, *h, 1),
                Op::StepFromElsewhere(h, steps) => fmi2DoStep(c, self.now.time + steps * h, *h, 0),
                Op::Logging(logging) => {
                    let (on, names): (c_int, &[&CStr]) = match logging {
                        Logging::AllOn => (1, &[]),
                        Logging::AllOff => (0, &[c"logAll"]),
                        Logging::DebugOff => (0, &[]),
                        Logging::ErrorsOnly => (1, &[c"logStatusError"]),
                        Logging::DiscardsOff => (0, &[c"logStatusDiscard"]),
                    };
                    let pointers: Vec<Text> = names.iter().map(|name| name.as_ptr()).collect();
                    fmi2SetDebugLogging(c, on, pointers.len(), pointers.as_ptr())
                }
                Op::Save => fmi2GetFMUstate(c, &mut self.state),
                Op::Restore => fmi2SetFMUstate(c, self.state),
                Op::Serialize => {
                    let mut size = 0;
                    let status = fmi2SerializedFMUstateSize(c, self.state, &mut size);
                    if status != Status::Ok {
                        return status;
                    }
                    let mut bytes = vec![0; size];
                    assert_eq!(fmi2SerializeFMUstate(c, self.state, bytes.as_mut_ptr(), size), Status::Ok);
                    assert_eq!(fmi2FreeFMUstate(c, &mut self.state), Status::Ok);
                    fmi2DeSerializeFMUstate(c, bytes.as_ptr(), size, &mut self.state)
                }
                Op::Free => fmi2FreeFMUstate(c, &mut self.state),
                Op::Other(index) => (self.others[*index].run)(&self.target),
            }
        }
    }

    /// Update the model after an accepted call.
    fn accepted(&mut self, op: &Op) {
        match op {
            Op::Setup(_, start, length) => {
                (self.now.start, self.now.time) = (*start, *start);
                self.now.stop = length.map(|length| start + length);
            }
            Op::Enter => self.now.phase = Phase::Initialization,
            Op::Exit => self.now.phase = Phase::Step,
            Op::Terminate => self.now.phase = Phase::Terminated,
            Op::Reset => self.now = Past::FRESH,
            Op::Save => self.saved = Some(self.now),
            Op::Restore => self.now = self.saved.unwrap(),
            Op::Free => self.saved = None,
            Op::SetForce(value) => self.now.force = *value,
            Op::SetForceRate(order, value) => self.now.rates[*order as usize - 1] = *value,
            Op::Step(h) => {
                self.now.time += h;
                let [first, second] = std::mem::take(&mut self.now.rates);
                self.now.force += h * (first + 0.5 * h * second);
            }
            Op::Logging(logging) => match logging {
                // Failures are not debug messages.
                Logging::AllOn | Logging::DebugOff => (self.logs_errors, self.logs_discards) = (true, true),
                Logging::AllOff => (self.logs_errors, self.logs_discards) = (false, false),
                Logging::ErrorsOnly => (self.logs_errors, self.logs_discards) = (true, false),
                Logging::DiscardsOff => self.logs_discards = false,
            },
            Op::SetStartAngle(_) | Op::SetCrankLength(_) | Op::ReadAngle | Op::ReadSome => {}
            Op::Serialize | Op::StepFromElsewhere(..) | Op::Other(_) => {}
        }
    }
}

fn force() -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => -40_000.0..40_000.0,
        1 => Just(1e300),
        1 => prop::sample::select(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY][..]),
    ]
}

/// Order and value of a derivative of the force. The order 3 is rejected.
fn rate() -> impl Strategy<Value = (c_int, f64)> {
    let value = prop_oneof![8 => -1e7..1e7, 1 => Just(0.0), 1 => odd()];
    (prop_oneof![6 => Just(1), 4 => Just(2), 1 => Just(3), 1 => Just(0)], value)
}

fn odd() -> impl Strategy<Value = f64> {
    prop::sample::select(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, -1e-3, -f64::MIN_POSITIVE][..])
}

/// A random call. `others` is the number of calls that [`Op::Other`] can select.
pub fn op(others: usize) -> impl Strategy<Value = Op> {
    let tolerance = prop_oneof![2 => Just(None), 2 => (1e-12..1e-6).prop_map(Some), 1 => odd().prop_map(Some)];
    let start = prop_oneof![2 => Just(0.0), 2 => -10.0..10.0, 1 => Just(f64::NAN)];
    let length = prop_oneof![2 => Just(None), 2 => (1e-3..0.2).prop_map(Some), 1 => odd().prop_map(Some)];
    prop_oneof![
        3 => (tolerance, start, length).prop_map(|(tolerance, start, length)| Op::Setup(tolerance, start, length)),
        4 => Just(Op::Enter),
        4 => Just(Op::Exit),
        1 => Just(Op::Terminate),
        1 => Just(Op::Reset),
        6 => force().prop_map(Op::SetForce),
        4 => rate().prop_map(|(order, value)| Op::SetForceRate(order, value)),
        3 => prop_oneof![4 => 0.3..0.8, 1 => Just(f64::NAN)].prop_map(Op::SetStartAngle),
        1 => odd().prop_map(Op::SetCrankLength),
        3 => Just(Op::ReadAngle),
        2 => Just(Op::ReadSome),
        12 => prop_oneof![6 => 1e-5..5e-3, 1 => odd()].prop_map(Op::Step),
        2 => (1e-5..1e-3, prop_oneof![0.01..3.0, -3.0..-0.01]).prop_map(|(h, off)| Op::StepFromElsewhere(h, off)),
        1 => prop::sample::select(&Logging::ALL[..]).prop_map(Op::Logging),
        3 => Just(Op::Save),
        4 => Just(Op::Restore),
        1 => Just(Op::Serialize),
        1 => Just(Op::Free),
        20 => (0..others).prop_map(Op::Other),
    ]
}
