//! Every function with valid, invalid and absurd arguments, and the status of each call in each phase.

use super::standard::Phase;
use crate::host::Gear;
use linkage_fmu::fmi2::types::{Byte, Component, FmuState, Status, Text};
use linkage_fmu::fmi2::*;
use std::ffi::c_int;
use std::ptr::{NonNull, null, null_mut};

/// A component with the references of some of its variables.
pub struct Target {
    pub c: Component,
    /// `actuator.force`, an input.
    pub input: u32,
    /// `crank.length`, a fixed parameter.
    pub parameter: u32,
    /// `crank.angle`, an output.
    pub output: u32,
    /// First reference that does not exist.
    pub beyond: u32,
}

impl Target {
    pub fn of(gear: &Gear) -> Self {
        Target {
            c: gear.c,
            input: gear.vr("actuator.force"),
            parameter: gear.vr("crank.length"),
            output: gear.vr("crank.angle"),
            beyond: gear.count(),
        }
    }

    /// The same references for another component.
    pub fn with(&self, c: Component) -> Self {
        Target { c, ..*self }
    }
}

/// One call.
pub struct Call {
    pub function: &'static str,
    /// Description of the arguments.
    pub what: &'static str,
    /// Status in each phase: instantiated, initialization, step, failed, terminated. `O` is fmi2OK, `D` fmi2Discard,
    /// `E` fmi2Error.
    pub statuses: &'static str,
    pub run: fn(&Target) -> Status,
}

impl Call {
    /// The expected status in a phase.
    pub fn expected(&self, phase: Phase) -> Status {
        match self.statuses.as_bytes()[phase as usize] {
            b'O' => Status::Ok,
            b'D' => Status::Discard,
            _ => Status::Error,
        }
    }
}

/// More elements than the memory can hold.
const HUGE: usize = 1 << 61;
const NAN: f64 = f64::NAN;
const INFINITE: f64 = f64::INFINITY;

/// A pointer that is aligned but must not be dereferenced. It is valid for an empty array only.
fn nowhere<T>() -> *mut T {
    NonNull::dangling().as_ptr()
}

/// A pointer to a Real that is not aligned.
fn crooked(values: &[f64]) -> *mut f64 {
    values.as_ptr().wrapping_byte_add(1).cast_mut()
}

/// A state of the instance, or NULL if it returns none. The state is never freed.
fn saved(c: Component) -> FmuState {
    let mut state = null_mut();
    // SAFETY: the component is NULL, foreign or valid.
    unsafe { fmi2GetFMUstate(c, &mut state) };
    state
}

/// Memory that is not a state.
fn no_state() -> FmuState {
    static ZEROS: [u64; 16] = [0; 16];
    ZEROS.as_ptr().cast_mut().cast()
}

/// A state of the instance as bytes, or one zero if it returns none.
fn serialized(c: Component) -> Vec<Byte> {
    let (mut state, mut size) = (saved(c), 0);
    // SAFETY: the component is NULL, foreign or valid, and so is the state; the array has the size that is passed.
    unsafe {
        if state.is_null() || fmi2SerializedFMUstateSize(c, state, &mut size) != Status::Ok {
            return vec![0];
        }
        let mut bytes = vec![0; size];
        assert_eq!(fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr(), size), Status::Ok);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), Status::Ok);
        bytes
    }
}

macro_rules! calls {
    ($($function:ident { $($what:literal $statuses:literal $arguments:tt;)* })*) => {
        vec![$($(Call {
            function: stringify!($function),
            what: $what,
            statuses: $statuses,
            run: calls!(@ $function $arguments),
        }),*),*]
    };
    (@ $function:ident (|$t:ident| $($argument:expr),*)) => {
        // SAFETY: the component is NULL or valid; every array that is read has the length that is passed.
        |$t: &Target| unsafe { $function($t.c $(, $argument)*) }
    };
}

/// Get and set functions of a type that none of the target's variables has, with a value of the type.
macro_rules! other_type {
    ($get:ident $set:ident $value:expr) => {
        calls! {
            $get {
                "nothing" "OOOOO" (|_t| null(), 0, null_mut());
                "a Real" "EEEEE" (|t| &t.input, 1, &mut $value);
                "unknown" "EEEEE" (|t| &t.beyond, 1, &mut $value);
                "NULL references" "EEEEE" (|_t| null(), 1, &mut $value);
                "NULL values" "EEEEE" (|t| &t.input, 1, null_mut());
                "a huge count" "EEEEE" (|t| &t.input, HUGE << 1, &mut $value);
            }
            $set {
                "nothing" "OOOEE" (|_t| null(), 0, null());
                "a Real" "EEEEE" (|t| &t.input, 1, &$value);
                "unknown" "EEEEE" (|t| &t.beyond, 1, &$value);
                "NULL references" "EEEEE" (|_t| null(), 1, &$value);
                "NULL values" "EEEEE" (|t| &t.input, 1, null());
                "a huge count" "EEEEE" (|t| &t.input, HUGE << 1, &$value);
            }
        }
    };
}

/// Every function that takes an instance, each at least once.
#[rustfmt::skip]
pub fn all() -> Vec<Call> {
    let mut all = calls! {
        fmi2SetString { "a NULL string" "EEEEE" (|t| &t.input, 1, &null()); }
        fmi2SetDebugLogging {
            "all on" "OOOOO" (|_t| 1, 0, null());
            "a category" "OOOOO" (|_t| 1, 1, [c"logAll".as_ptr()].as_ptr());
            "any number but 0 is true" "OOOOO" (|_t| c_int::MIN, 1, [c"logAll".as_ptr()].as_ptr());
            "an unknown category" "EEEEE" (|_t| 1, 2, [c"logAll".as_ptr(), c"logNothing".as_ptr()].as_ptr());
            "an empty category" "EEEEE" (|_t| 1, 1, [c"".as_ptr()].as_ptr());
            "a NULL category" "EEEEE" (|_t| 1, 1, [null()].as_ptr());
            "NULL categories" "EEEEE" (|_t| 1, 1, null());
            "a huge count" "EEEEE" (|_t| 1, HUGE, nowhere());
        }
        fmi2SetupExperiment {
            "start time only" "OEEEE" (|_t| 0, NAN, -1.5, 0, NAN);
            "all" "OEEEE" (|_t| 1, 1e-6, 0.0, 1, 2.0);
            "start time is NaN" "EEEEE" (|_t| 0, 0.0, NAN, 0, 0.0);
            "start time is infinite" "EEEEE" (|_t| 0, 0.0, -INFINITE, 0, 0.0);
            "stop time is NaN" "EEEEE" (|_t| 0, 0.0, 0.0, 1, NAN);
            "stop time is infinite" "EEEEE" (|_t| 0, 0.0, 0.0, 1, INFINITE);
            "stop time is start time, to initialise only" "OEEEE" (|_t| 0, 0.0, 1.0, 1, 1.0);
            "stop before start" "EEEEE" (|_t| 0, 0.0, 1.0, c_int::MIN, 0.0);
            "tolerance is NaN" "EEEEE" (|_t| 1, NAN, 0.0, 0, 0.0);
            "tolerance is 0, which is none" "OEEEE" (|_t| 1, 0.0, 0.0, 0, 0.0);
            "tolerance is negative" "EEEEE" (|_t| -1, -1e-6, 0.0, 0, 0.0);
            "tolerance is infinite" "EEEEE" (|_t| 1, INFINITE, 0.0, 0, 0.0);
            "tolerance is beyond its range" "EEEEE" (|_t| 1, 1e9, 0.0, 0, 0.0);
            "tolerance is good, stop time is not" "EEEEE" (|_t| 1, 1e-5, 0.0, 1, NAN);
        }
        fmi2EnterInitializationMode { "" "OEEEE" (|_t|); }
        fmi2ExitInitializationMode { "" "EOEEE" (|_t|); }
        fmi2Terminate { "" "EEOOE" (|_t|); }
        fmi2Reset { "" "OOOOO" (|_t|); }

        fmi2GetReal {
            "an input" "OOOOO" (|t| &t.input, 1, &mut 0.0);
            "a parameter" "OOOOO" (|t| &t.parameter, 1, &mut 0.0);
            "an output" "EOOOO" (|t| &t.output, 1, &mut 0.0);
            "one twice" "OOOOO" (|t| [t.input, t.input].as_ptr(), 2, [0.0; 2].as_mut_ptr());
            "nothing, NULL" "OOOOO" (|_t| null(), 0, null_mut());
            "nothing, nowhere" "OOOOO" (|_t| nowhere(), 0, nowhere());
            "unknown" "EEEEE" (|t| &t.beyond, 1, &mut 0.0);
            "largest reference" "EEEEE" (|_t| &u32::MAX, 1, &mut 0.0);
            "known and unknown" "EEEEE" (|t| [t.input, t.beyond].as_ptr(), 2, [0.0; 2].as_mut_ptr());
            "NULL references" "EEEEE" (|_t| null(), 1, &mut 0.0);
            "NULL values" "EEEEE" (|t| &t.input, 1, null_mut());
            "values not aligned" "EEEEE" (|t| &t.input, 1, crooked(&[0.0; 2]));
            "a huge count" "EEEEE" (|t| &t.input, HUGE, &mut 0.0);
            "the largest count" "EEEEE" (|t| &t.input, usize::MAX, &mut 0.0);
        }
        fmi2SetReal {
            "an input" "OOOEE" (|t| &t.input, 1, &29_000.0);
            "a parameter" "OOEEE" (|t| &t.parameter, 1, &0.176);
            "nothing, NULL" "OOOEE" (|_t| null(), 0, null());
            "nothing, nowhere" "OOOEE" (|_t| nowhere(), 0, nowhere());
            "an output" "EEEEE" (|t| &t.output, 1, &0.0);
            "input and output" "EEEEE" (|t| [t.input, t.output].as_ptr(), 2, [1.0, 1.0].as_ptr());
            "input, then NaN" "EEEEE" (|t| [t.input, t.input].as_ptr(), 2, [1.0, NAN].as_ptr());
            "input is NaN" "EEEEE" (|t| &t.input, 1, &NAN);
            "input is infinite" "EEEEE" (|t| &t.input, 1, &INFINITE);
            "input is infinite, negative" "EEEEE" (|t| &t.input, 1, &-INFINITE);
            "parameter is NaN" "EEEEE" (|t| &t.parameter, 1, &NAN);
            "parameter is infinite" "EEEEE" (|t| &t.parameter, 1, &INFINITE);
            "parameter is out of its range" "EEEEE" (|t| &t.parameter, 1, &-1.0);
            "input and parameter out of its range" "EEEEE" (|t| [t.input, t.parameter].as_ptr(), 2, [1.0,
                -1.0].as_ptr());
            "unknown" "EEEEE" (|t| &t.beyond, 1, &0.0);
            "largest reference" "EEEEE" (|_t| &u32::MAX, 1, &0.0);
            "NULL references" "EEEEE" (|_t| null(), 1, &0.0);
            "NULL values" "EEEEE" (|t| &t.input, 1, null());
            "values not aligned" "EEEEE" (|t| &t.input, 1, crooked(&[0.0; 2]));
            "a huge count" "EEEEE" (|t| &t.input, HUGE, &0.0);
        }
        fmi2DoStep {
            "a step" "EEOEE" (|_t| 0.0, 1e-3, 1);
            "a small step, any number for a Boolean" "EEOEE" (|_t| 0.0, 1e-12, c_int::MIN);
            "of 0" "EEEEE" (|_t| 0.0, 0.0, 1);
            "of -0" "EEEEE" (|_t| 0.0, -0.0, 1);
            "backwards" "EEEEE" (|_t| 0.0, -1e-3, 1);
            "of NaN" "EEEEE" (|_t| 0.0, NAN, 1);
            "without end" "EEEEE" (|_t| 0.0, INFINITE, 1);
            "from NaN" "EEEEE" (|_t| NAN, 1e-3, 1);
            "from infinity" "EEEEE" (|_t| INFINITE, 1e-3, 1);
            "from another time" "EEEEE" (|_t| 1e-3, 1e-3, 1);
            "from an earlier time" "EEEEE" (|_t| -1e-3, 1e-3, 1);
            "from the largest time" "EEEEE" (|_t| f64::MAX, f64::MAX, 1);
        }
        fmi2CancelStep { "" "EEEEE" (|_t|); }
        fmi2GetStatus {
            "fmi2DoStepStatus" "EEOOO" (|_t| 0, &mut Status::Fatal as *mut Status);
            "fmi2PendingStatus" "EEDDD" (|_t| 1, &mut Status::Fatal as *mut Status);
            "fmi2LastSuccessfulTime" "EEDDD" (|_t| 2, &mut Status::Fatal as *mut Status);
            "fmi2Terminated" "EEDDD" (|_t| 3, &mut Status::Fatal as *mut Status);
            "no kind" "EEEEE" (|_t| 4, &mut Status::Fatal as *mut Status);
            "a negative kind" "EEEEE" (|_t| c_int::MIN, &mut Status::Fatal as *mut Status);
            "NULL" "EEEEE" (|_t| 0, null_mut());
        }
        fmi2GetRealStatus {
            "fmi2LastSuccessfulTime" "EEOOO" (|_t| 2, &mut 0.0);
            "fmi2DoStepStatus" "EEDDD" (|_t| 0, &mut 0.0);
            "no kind" "EEEEE" (|_t| c_int::MAX, &mut 0.0);
            "NULL" "EEEEE" (|_t| 2, null_mut());
            "not aligned" "EEEEE" (|_t| 2, crooked(&[0.0; 2]));
        }
        fmi2GetIntegerStatus {
            "fmi2LastSuccessfulTime" "EEDDD" (|_t| 2, &mut 0);
            "no kind" "EEEEE" (|_t| -1, &mut 0);
            "NULL" "EEDDD" (|_t| 2, null_mut());
        }
        fmi2GetBooleanStatus {
            "fmi2Terminated" "EEOOO" (|_t| 3, &mut 0);
            "fmi2PendingStatus" "EEDDD" (|_t| 1, &mut 0);
            "no kind" "EEEEE" (|_t| 17, &mut 0);
            "NULL" "EEEEE" (|_t| 3, null_mut());
        }
        fmi2GetStringStatus {
            "fmi2PendingStatus" "EEDDD" (|_t| 1, &mut null());
            "no kind" "EEEEE" (|_t| -7, &mut null());
            "NULL" "EEDDD" (|_t| 1, null_mut());
        }

        fmi2EnterEventMode { "" "EEEEE" (|_t|); }
        fmi2NewDiscreteStates { "NULL" "EEEEE" (|_t| null_mut()); }
        fmi2EnterContinuousTimeMode { "" "EEEEE" (|_t|); }
        fmi2CompletedIntegratorStep {
            "" "EEEEE" (|_t| 1, &mut 0, &mut 0);
            "NULL" "EEEEE" (|_t| 1, null_mut(), null_mut());
        }
        fmi2SetTime { "0" "EEEEE" (|_t| 0.0); "NaN" "EEEEE" (|_t| NAN); }
        fmi2SetContinuousStates { "none" "EEEEE" (|_t| null(), 0); "a huge count" "EEEEE" (|_t| null(), HUGE); }
        fmi2GetDerivatives { "none" "EEEEE" (|_t| null_mut(), 0); "a huge count" "EEEEE" (|_t| null_mut(), HUGE); }
        fmi2GetEventIndicators { "none" "EEEEE" (|_t| null_mut(), 0); "NULL" "EEEEE" (|_t| null_mut(), 1); }
        fmi2GetContinuousStates { "none" "EEEEE" (|_t| null_mut(), 0); "NULL" "EEEEE" (|_t| null_mut(), 2); }
        fmi2GetNominalsOfContinuousStates { "none" "EEEEE" (|_t| null_mut(), 0); "NULL" "EEEEE" (|_t| null_mut(), 2); }

        fmi2GetDirectionalDerivative {
            "an output by an input" "EOOOO" (|t| &t.output, 1, &t.input, 1, &1.0, &mut 0.0);
            "one input twice" "EOOOO" (|t| &t.output, 1, [t.input, t.input].as_ptr(), 2, [1.0, 2.0].as_ptr(), &mut 0.0);
            "by nothing" "EOOOO" (|t| &t.output, 1, null(), 0, null(), &mut 0.0);
            "of nothing" "EOOOO" (|t| null(), 0, &t.input, 1, &1.0, null_mut());
            "an input by itself" "EEEEE" (|t| &t.input, 1, &t.input, 1, &1.0, &mut 0.0);
            "by a parameter, of the initial value" "EOEEE" (|t| &t.output, 1, &t.parameter, 1, &1.0, &mut 0.0);
            "by an output" "EEEEE" (|t| &t.output, 1, &t.output, 1, &1.0, &mut 0.0);
            "unknown unknown" "EEEEE" (|t| &t.beyond, 1, &t.input, 1, &1.0, &mut 0.0);
            "unknown known" "EEEEE" (|t| &t.output, 1, &u32::MAX, 1, &1.0, &mut 0.0);
            "seed is NaN" "EEEEE" (|t| &t.output, 1, &t.input, 1, &NAN, &mut 0.0);
            "seed is infinite" "EEEEE" (|t| &t.output, 1, &t.input, 1, &INFINITE, &mut 0.0);
            "NULL" "EEEEE" (|_t| null(), 1, null(), 1, null(), null_mut());
            "NULL seeds" "EEEEE" (|t| &t.output, 1, &t.input, 1, null(), &mut 0.0);
            "NULL values" "EEEEE" (|t| &t.output, 1, &t.input, 1, &1.0, null_mut());
            "values not aligned" "EEEEE" (|t| &t.output, 1, &t.input, 1, &1.0, crooked(&[0.0; 2]));
            "a huge count" "EEEEE" (|_t| null(), HUGE, null(), HUGE, null(), null_mut());
        }
        fmi2SetRealInputDerivatives {
            "first" "OOOEE" (|t| &t.input, 1, &1, &0.0);
            "second" "OOOEE" (|t| &t.input, 1, &2, &0.0);
            "nothing" "OOOEE" (|_t| null(), 0, null(), null());
            "order 0" "EEEEE" (|t| &t.input, 1, &0, &1.0);
            "order 3" "EEEEE" (|t| &t.input, 1, &3, &1.0);
            "the least order" "EEEEE" (|t| &t.input, 1, &c_int::MIN, &1.0);
            "NaN" "EEEEE" (|t| &t.input, 1, &1, &NAN);
            "infinite" "EEEEE" (|t| &t.input, 1, &2, &INFINITE);
            "first, then order 3" "EEEEE" (|t| [t.input, t.input].as_ptr(), 2, [1, 3].as_ptr(), [1.0, 1.0].as_ptr());
            "a parameter" "EEEEE" (|t| &t.parameter, 1, &1, &0.0);
            "an output" "EEEEE" (|t| &t.output, 1, &1, &0.0);
            "unknown" "EEEEE" (|t| &t.beyond, 1, &1, &0.0);
            "NULL" "EEEEE" (|_t| null(), 1, null(), null());
            "NULL orders" "EEEEE" (|t| &t.input, 1, null(), &0.0);
            "NULL values" "EEEEE" (|t| &t.input, 1, &1, null());
            "a huge count" "EEEEE" (|t| &t.input, HUGE << 1, &1, &0.0);
        }
        fmi2GetRealOutputDerivatives {
            "an output" "EOOOO" (|t| &t.output, 1, &1, &mut 0.0);
            "nothing" "EOOOO" (|_t| null(), 0, null(), null_mut());
            "order 0" "EEEEE" (|t| &t.output, 1, &0, &mut 0.0);
            "order 2" "EEEEE" (|t| &t.output, 1, &2, &mut 0.0);
            "the largest order" "EEEEE" (|t| &t.output, 1, &c_int::MAX, &mut 0.0);
            "an input" "EEEEE" (|t| &t.input, 1, &1, &mut 0.0);
            "a parameter" "EEEEE" (|t| &t.parameter, 1, &1, &mut 0.0);
            "unknown" "EEEEE" (|t| &t.beyond, 1, &1, &mut 0.0);
            "NULL" "EEEEE" (|_t| null(), 1, null(), null_mut());
            "NULL values" "EEEEE" (|t| &t.output, 1, &1, null_mut());
            "values not aligned" "EEEEE" (|t| &t.output, 1, &1, crooked(&[0.0; 2]));
            "a huge count" "EEEEE" (|t| &t.output, HUGE << 1, &1, &mut 0.0);
        }

        fmi2GetFMUstate {
            "a new one" "OOOOO" (|_t| &mut null_mut());
            "over an old one" "OOOOO" (|t| &mut saved(t.c));
            "over no state" "EEEEE" (|_t| &mut no_state());
            "over a pointer that is not aligned" "EEEEE" (|_t| &mut no_state().wrapping_byte_add(1));
            "NULL" "EEEEE" (|_t| null_mut());
        }
        fmi2SetFMUstate {
            "its own" "OOOOO" (|t| saved(t.c));
            "no state" "EEEEE" (|_t| no_state());
            "not aligned" "EEEEE" (|_t| no_state().wrapping_byte_add(1));
            "NULL" "EEEEE" (|_t| null_mut());
        }
        fmi2FreeFMUstate {
            "a state" "OOOOO" (|t| &mut saved(t.c));
            "NULL" "OOOOO" (|_t| null_mut());
            "a pointer to NULL" "OOOOO" (|_t| &mut null_mut());
            "no state" "EEEEE" (|_t| &mut no_state());
        }
        fmi2SerializedFMUstateSize {
            "a state" "OOOOO" (|t| saved(t.c), &mut 0);
            "NULL values" "EEEEE" (|t| saved(t.c), null_mut());
            "no state" "EEEEE" (|_t| no_state(), &mut 0);
            "NULL" "EEEEE" (|_t| null_mut(), null_mut());
        }
        fmi2SerializeFMUstate {
            "a state" "OOOOO" (|t| saved(t.c), serialized(t.c).as_mut_ptr(), serialized(t.c).len());
            "too small" "EEEEE" (|t| saved(t.c), serialized(t.c).as_mut_ptr(), serialized(t.c).len() - 1);
            "too large" "EEEEE" (|t| saved(t.c), serialized(t.c).as_mut_ptr(), HUGE);
            "NULL values" "EEEEE" (|t| saved(t.c), null_mut(), serialized(t.c).len());
            "no state" "EEEEE" (|_t| no_state(), [0; 8].as_mut_ptr(), 8);
            "NULL" "EEEEE" (|_t| null_mut(), null_mut(), HUGE);
        }
        fmi2DeSerializeFMUstate {
            "a state" "OOOOO" (|t| serialized(t.c).as_ptr(), serialized(t.c).len(), &mut null_mut());
            "whatever was there" "OOOOO" (|t| serialized(t.c).as_ptr(), serialized(t.c).len(), &mut no_state());
            "cut off" "EEEEE" (|t| serialized(t.c).as_ptr(), serialized(t.c).len() - 1, &mut null_mut());
            "NULL values" "EEEEE" (|t| serialized(t.c).as_ptr(), serialized(t.c).len(), null_mut());
            "nothing" "EEEEE" (|_t| null(), 0, &mut null_mut());
            "zeros" "EEEEE" (|_t| [0; 64].as_ptr(), 64, &mut null_mut());
            "NULL" "EEEEE" (|_t| null(), HUGE, null_mut());
        }
    };
    all.extend(other_type!(fmi2GetInteger fmi2SetInteger 7));
    all.extend(other_type!(fmi2GetBoolean fmi2SetBoolean -1));
    all.extend(other_type!(fmi2GetString fmi2SetString c"x".as_ptr()));
    all
}

/// Texts from the functions without an instance.
pub fn text_functions() -> [fn() -> Text; 2] {
    [|| fmi2GetTypesPlatform(), || fmi2GetVersion()]
}
