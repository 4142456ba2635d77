//! A host of the exported functions of FMI 3.0, for tests and for tests with hostile input.
//!
//! In: a description. Out: instances called through the C functions; statuses, values, saved states, messages. Must not
//! know: how a call works. Each method is one call and safe to use: arrays have the lengths that are passed, and states
//! come from this library. Deliberately invalid arguments are rejected before they are read.

use super::types::{Boolean, Environment, FALSE, FmuState, Instance, Status, TRUE, Text, ValueReference};
use super::*;
use crate::fmi::exchange_calls;
use crate::fmi2::host::{Description, Log, Message, State, owned};
use std::cell::Cell;
use std::ffi::c_int;
use std::ptr::{NonNull, null, null_mut};
use std::sync::Arc;

/// The host's callback after an internal step. Argument: the time reached [s]. The callback may read the instance.
/// Result: the time [s] at which the step shall end, if the host requests an early end.
pub type Update = dyn Fn(&Calls, f64) -> Option<f64>;

/// Features of FMI that the host requests for an instance.
#[derive(Default)]
pub struct Wishes {
    /// Event mode between steps.
    pub event_mode: bool,
    /// Steps that end early.
    pub early_return: bool,
    /// `loggingOn`: events are logged too.
    pub logging: bool,
    /// A callback after internal steps.
    pub update: Option<Box<Update>>,
}

/// Results of a step in addition to its status.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stepped {
    /// Whether an event must be handled.
    pub event: bool,
    /// Whether the FMU requests the end of the simulation.
    pub terminate: bool,
    /// Whether the step ended early.
    pub early: bool,
    /// Time reached [s].
    pub last: f64,
}

/// The calls of an instance, with its messages.
pub struct Calls {
    c: Cell<Instance>,
    /// Messages of the instance.
    pub log: Log,
    update: Option<Box<Update>>,
}

/// An instance. Dropping the host frees the instance.
pub struct Host(Box<Calls>);

impl std::ops::Deref for Host {
    type Target = Calls;

    fn deref(&self) -> &Calls {
        &self.0
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: the instance is not used again.
        unsafe { fmi3FreeInstance(self.c.get()) }
    }
}

unsafe extern "C-unwind" fn log(environment: Environment, status: Status, category: Text, message: Text) {
    // SAFETY: the environment is the `Calls` of the instance, which is valid longer than the instance.
    let calls = unsafe { &*environment.cast::<Calls>() };
    let (status, category, text) = (status as c_int, owned(category), owned(message));
    calls.log.push(Message { instance: String::new(), status, category, text });
}

unsafe extern "C-unwind" fn call_update(
    environment: Environment,
    time: f64,
    set_requested: Boolean,
    get_allowed: Boolean,
    step_finished: Boolean,
    _can_return_early: Boolean,
    return_requested: *mut Boolean,
    return_time: *mut f64,
) {
    assert_eq!([set_requested, get_allowed, step_finished], [FALSE, TRUE, TRUE]);
    // SAFETY: as above; both pointers point to memory for one value (4.2.2).
    unsafe {
        let calls = &*environment.cast::<Calls>();
        if let Some(stop) = calls.update.as_ref().and_then(|update| update(calls, time)) {
            (*return_requested, *return_time) = (TRUE, stop);
        }
    }
}

impl Host {
    /// New instance of a description.
    ///
    /// # Errors
    /// The log messages if the instantiation fails.
    pub fn new(description: &Arc<Description>, wishes: Wishes) -> Result<Self, String> {
        let Wishes { event_mode, early_return, logging, update } = wishes;
        let has_update = update.is_some();
        // SAFETY: all pointers are valid during the call, and the `Calls` as long as the instance.
        Self::with(update, |environment| unsafe {
            fmi3InstantiateCoSimulation(
                c"gear".as_ptr(),
                description.guid().as_ptr(),
                description.location().as_ptr(),
                FALSE,
                logging.into(),
                event_mode.into(),
                early_return.into(),
                null(),
                0,
                environment,
                Some(log),
                has_update.then_some(call_update),
            )
        })
    }

    /// New instance of a description for model exchange.
    ///
    /// # Errors
    /// The log messages if the instantiation fails.
    pub fn exchange(description: &Arc<Description>, logging: bool) -> Result<Self, String> {
        let (token, path) = (description.guid().as_ptr(), description.location().as_ptr());
        // SAFETY: as above.
        Self::with(None, |environment| unsafe {
            let (name, logging) = (c"gear".as_ptr(), logging.into());
            fmi3InstantiateModelExchange(name, token, path, FALSE, logging, environment, Some(log))
        })
    }

    fn with(update: Option<Box<Update>>, instantiate: impl FnOnce(Environment) -> Instance) -> Result<Self, String> {
        let calls = Box::new(Calls { c: Cell::new(null_mut()), log: Log::default(), update });
        let c = instantiate((&raw const *calls).cast_mut().cast());
        if c.is_null() {
            return Err(format!("not instantiated: {:?}", calls.log.take()));
        }
        calls.c.set(c);
        Ok(Self(calls))
    }
}

/// Calls without an argument except the instance.
macro_rules! calls {
    ($($name:ident = $function:ident),* $(,)?) => {
        $(
            #[doc = concat!("`", stringify!($function), "`.")]
            pub fn $name(&self) -> Status {
                // SAFETY: the instance is valid.
                unsafe { $function(self.c.get()) }
            }
        )*
    };
}

impl Calls {
    calls!(
        exit = fmi3ExitInitializationMode,
        terminate = fmi3Terminate,
        reset = fmi3Reset,
        enter_event_mode = fmi3EnterEventMode,
        enter_step_mode = fmi3EnterStepMode,
        evaluate = fmi3EvaluateDiscreteStates,
    );
    exchange_calls!(
        fmi3EnterContinuousTimeMode,
        fmi3CompletedIntegratorStep,
        fmi3SetTime,
        fmi3SetContinuousStates,
        fmi3GetContinuousStateDerivatives,
        fmi3GetEventIndicators,
        fmi3GetContinuousStates,
        fmi3GetNominalsOfContinuousStates
    );

    /// The instance, for functions without a method here.
    pub fn instance(&self) -> Instance {
        self.c.get()
    }

    /// `fmi3EnterInitializationMode`. An undefined tolerance or stop time is passed as NaN.
    pub fn enter(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Status {
        let defined = |value: Option<f64>| (Boolean::from(value.is_some()), value.unwrap_or(f64::NAN));
        let ((has_tolerance, tolerance), (has_stop, stop)) = (defined(tolerance), defined(stop));
        // SAFETY: the instance is valid.
        unsafe { fmi3EnterInitializationMode(self.c.get(), has_tolerance, tolerance, start, has_stop, stop) }
    }

    /// `fmi3GetFloat64`.
    #[inline]
    pub fn reals(&self, references: &[ValueReference], values: &mut [f64]) -> Status {
        // SAFETY: the instance is valid; both arrays have the length that is passed.
        unsafe {
            let (vr, out) = (references.as_ptr(), values.as_mut_ptr());
            fmi3GetFloat64(self.c.get(), vr, references.len(), out, values.len())
        }
    }

    /// `fmi3SetFloat64`.
    #[inline]
    pub fn set_reals(&self, references: &[ValueReference], values: &[f64]) -> Status {
        // SAFETY: as above.
        unsafe { fmi3SetFloat64(self.c.get(), references.as_ptr(), references.len(), values.as_ptr(), values.len()) }
    }

    /// `fmi3GetBoolean` of one variable.
    pub fn boolean(&self, reference: ValueReference, value: &mut Boolean) -> Status {
        // SAFETY: the instance is valid; one reference, one value.
        unsafe { fmi3GetBoolean(self.c.get(), &reference, 1, value, 1) }
    }

    /// `fmi3SetBoolean` of one variable. Any byte can be passed.
    pub fn set_boolean(&self, reference: ValueReference, value: Boolean) -> Status {
        // SAFETY: the instance is valid; one reference, one value.
        unsafe { fmi3SetBoolean(self.c.get(), &reference, 1, &value, 1) }
    }

    /// `fmi3GetInt64` of one variable.
    pub fn number(&self, reference: ValueReference) -> Status {
        // SAFETY: the instance is valid; one reference, one value.
        unsafe { fmi3GetInt64(self.c.get(), &reference, 1, &mut 0, 1) }
    }

    /// `fmi3SetInt64` of one variable.
    pub fn set_number(&self, reference: ValueReference, value: i64) -> Status {
        // SAFETY: the instance is valid; one reference, one value.
        unsafe { fmi3SetInt64(self.c.get(), &reference, 1, &value, 1) }
    }

    /// `fmi3GetDirectionalDerivative`, or with `is_adjoint` `fmi3GetAdjointDerivative`.
    pub fn derivative(
        &self,
        is_adjoint: bool,
        unknowns: &[ValueReference],
        knowns: &[ValueReference],
        seed: &[f64],
        values: &mut [f64],
    ) -> Status {
        let function = if is_adjoint { fmi3GetAdjointDerivative } else { fmi3GetDirectionalDerivative };
        let ((u, nu), (k, nk)) = ((unknowns.as_ptr(), unknowns.len()), (knowns.as_ptr(), knowns.len()));
        // SAFETY: the instance is valid; all arrays have the lengths that are passed.
        unsafe { function(self.c.get(), u, nu, k, nk, seed.as_ptr(), seed.len(), values.as_mut_ptr(), values.len()) }
    }

    /// `fmi3GetOutputDerivatives`. There is one order for each reference.
    pub fn output_derivatives(&self, references: &[ValueReference], orders: &[i32], values: &mut [f64]) -> Status {
        assert_eq!(references.len(), orders.len());
        let (vr, order, count) = (references.as_ptr(), orders.as_ptr(), references.len());
        // SAFETY: the instance is valid; all arrays have the lengths that are passed.
        unsafe { fmi3GetOutputDerivatives(self.c.get(), vr, count, order, values.as_mut_ptr(), values.len()) }
    }

    /// `fmi3GetNumberOfVariableDependencies`, then `fmi3GetVariableDependencies` if the first call succeeds.
    pub fn dependencies(&self, reference: ValueReference) -> Status {
        let mut count = 0;
        // SAFETY: the instance is valid; all arrays have the length that is passed.
        unsafe {
            let status = fmi3GetNumberOfVariableDependencies(self.c.get(), reference, &mut count);
            if status != Status::Ok {
                return status;
            }
            let (mut elements, mut knowns, mut kinds) = (vec![0; 2 * count], vec![0; count], vec![0; count]);
            let (first, second) = elements.split_at_mut(count);
            let (e, k, o) = (first.as_mut_ptr(), knowns.as_mut_ptr(), second.as_mut_ptr());
            fmi3GetVariableDependencies(self.c.get(), reference, e, k, o, kinds.as_mut_ptr(), count)
        }
    }

    /// `fmi3UpdateDiscreteStates`. Returns the status, and whether the state jumped.
    pub fn update_discrete_states(&self) -> (Status, bool) {
        let (status, has_jumped, _) = self.update();
        (status, has_jumped)
    }

    /// [`Self::update_discrete_states`], and the time [s] of the next event if it is known.
    pub fn update(&self) -> (Status, bool, Option<f64>) {
        let (mut flags, mut next) = ([FALSE; 5], f64::NAN);
        let [update, terminate, nominals, values, defined] = &mut flags;
        // SAFETY: the instance is valid; each pointer points to one value.
        let status =
            unsafe { fmi3UpdateDiscreteStates(self.c.get(), update, terminate, nominals, values, defined, &mut next) };
        (status, flags[3] != FALSE, (flags[4] != FALSE).then_some(next))
    }

    /// `fmi3DoStep` of size `h` [s] from a communication point [s].
    #[inline]
    pub fn step(&self, point: f64, h: f64) -> (Status, Stepped) {
        let (mut flags, mut last) = ([FALSE; 3], f64::NAN);
        let [event, terminate, early] = &mut flags;
        // SAFETY: the instance is valid; each pointer points to one value.
        let status = unsafe { fmi3DoStep(self.c.get(), point, h, FALSE, event, terminate, early, &mut last) };
        let [event, terminate, early] = flags.map(|flag| flag != FALSE);
        (status, Stepped { event, terminate, early, last })
    }

    /// `fmi3GetFMUState` into an existing state, or a new one for [`State::NONE`].
    pub fn save_into(&self, state: &mut State) -> Status {
        // SAFETY: the instance is valid; the state is NULL or belongs to this library.
        unsafe { fmi3GetFMUState(self.c.get(), state.place()) }
    }

    /// `fmi3SetFMUState`.
    pub fn restore(&self, state: &State) -> Status {
        // SAFETY: the instance is valid; the state is NULL or belongs to this library.
        unsafe { fmi3SetFMUState(self.c.get(), state.pointer()) }
    }

    /// `fmi3FreeFMUState`. The state becomes [`State::NONE`].
    pub fn free(&self, state: &mut State) -> Status {
        // SAFETY: the instance is valid; the state is NULL or belongs to this library.
        unsafe { fmi3FreeFMUState(self.c.get(), state.place()) }
    }

    /// `fmi3SerializeFMUState`: serialises a state.
    ///
    /// # Errors
    /// The status, if it is not `fmi3OK`.
    pub fn serialize(&self, state: &State) -> Result<Vec<u8>, Status> {
        let (c, mut size) = (self.c.get(), 0_usize);
        // SAFETY: the instance is valid; the state is NULL or belongs to this library; the array has the size that is
        // passed.
        unsafe {
            let status = fmi3SerializedFMUStateSize(c, state.pointer(), &mut size);
            if status != Status::Ok {
                return Err(status);
            }
            let mut bytes = vec![0_u8; size];
            let status = fmi3SerializeFMUState(c, state.pointer(), bytes.as_mut_ptr(), size);
            if status == Status::Ok { Ok(bytes) } else { Err(status) }
        }
    }

    /// `fmi3DeserializeFMUState`: creates a state from bytes.
    ///
    /// # Errors
    /// The status, if it is not `fmi3OK`.
    pub fn deserialize(&self, bytes: &[u8]) -> Result<State, Status> {
        let mut state = State::NONE;
        // SAFETY: the instance is valid; the array has the length that is passed.
        let status = unsafe { fmi3DeserializeFMUState(self.c.get(), bytes.as_ptr(), bytes.len(), state.place()) };
        if status == Status::Ok { Ok(state) } else { Err(status) }
    }

    /// Serialises and deserialises a state. Returns the first status that is not `fmi3OK`.
    pub fn renew(&self, state: &mut State) -> Status {
        match self.serialize(state).and_then(|bytes| self.deserialize(&bytes)) {
            Ok(new) => {
                let status = self.free(state);
                *state = new;
                status
            }
            Err(status) => status,
        }
    }

    /// One of [`SPOILED`] calls that are rejected in every phase. Reasons: NULL, an array that is misaligned or larger
    /// than memory, memory that is not a state, or a feature that the FMU does not have.
    pub fn spoiled(&self, index: usize) -> (&'static str, Status) {
        let (mut values, references) = ([0.0_f64; 2], [0; 1]);
        let (c, vr, one) = (self.c.get(), references.as_ptr(), values.as_mut_ptr());
        let misaligned = one.wrapping_byte_add(1);
        let dangling: *mut f64 = NonNull::dangling().as_ptr();
        let zeros = [0_u64; 16];
        let mut foreign: FmuState = zeros.as_ptr().cast_mut().cast();
        let (n, mut byte, mut count) = (null_mut::<Boolean>(), 0, 0);
        // SAFETY: NULL, misaligned pointers and huge counts are rejected before they are read. Memory that is not a
        // state is readable.
        unsafe {
            match index {
                0 => ("fmi3GetFloat64", fmi3GetFloat64(c, null(), 1, one, 1)),
                1 => ("fmi3GetFloat64", fmi3GetFloat64(c, vr, 1, null_mut(), 1)),
                2 => ("fmi3GetFloat64", fmi3GetFloat64(c, vr, 1, misaligned, 1)),
                3 => ("fmi3GetFloat64", fmi3GetFloat64(c, vr, 1, dangling, usize::MAX)),
                4 => ("fmi3SetFloat64", fmi3SetFloat64(c, null(), 1, one, 1)),
                5 => ("fmi3SetFloat64", fmi3SetFloat64(c, vr, 1, misaligned, 1)),
                6 => ("fmi3GetFloat64", fmi3GetFloat64(c, vr, 1, dangling, 0)),
                7 => ("fmi3DoStep", fmi3DoStep(c, 0.0, 1e-3, 0, n, n, n, null_mut())),
                8 => ("fmi3UpdateDiscreteStates", fmi3UpdateDiscreteStates(c, n, n, n, n, n, null_mut())),
                9 => ("fmi3GetInt32", fmi3GetInt32(c, vr, 1, &mut 0, 1)),
                10 => ("fmi3SetUInt8", fmi3SetUInt8(c, vr, 1, &0, 1)),
                11 => ("fmi3GetClock", fmi3GetClock(c, vr, 1, &mut byte)),
                12 => ("fmi3GetBinary", fmi3GetBinary(c, vr, 1, &mut count, &mut null(), 1)),
                13 => ("fmi3EnterConfigurationMode", fmi3EnterConfigurationMode(c)),
                14 => ("fmi3SetDebugLogging", fmi3SetDebugLogging(c, 1, 1, [c"logNothing".as_ptr()].as_ptr())),
                15 => ("fmi3SetDebugLogging", fmi3SetDebugLogging(c, 1, 1, [null()].as_ptr())),
                16 => ("fmi3SetFMUState", fmi3SetFMUState(c, foreign)),
                17 => ("fmi3GetFMUState", fmi3GetFMUState(c, &mut foreign)),
                18 => ("fmi3FreeFMUState", fmi3FreeFMUState(c, &mut foreign)),
                19 => ("fmi3SerializedFMUStateSize", fmi3SerializedFMUStateSize(c, null_mut(), &mut count)),
                20 => ("fmi3DeserializeFMUState", fmi3DeserializeFMUState(c, zeros.as_ptr().cast(), 128, &mut foreign)),
                21 => ("fmi3DeserializeFMUState", fmi3DeserializeFMUState(c, null(), usize::MAX, &mut foreign)),
                22 => (
                    "fmi3GetNumberOfVariableDependencies",
                    fmi3GetNumberOfVariableDependencies(c, ValueReference::MAX, &mut count),
                ),
                23 => ("fmi3GetOutputDerivatives", fmi3GetOutputDerivatives(c, null(), 1, null(), one, 1)),
                24 => {
                    ("fmi3GetDirectionalDerivative", fmi3GetDirectionalDerivative(c, vr, 1, vr, 1, null(), 1, one, 1))
                }
                _ => ("fmi3GetAdjointDerivative", fmi3GetAdjointDerivative(c, vr, 1, null(), 1, one, 1, misaligned, 1)),
            }
        }
    }
}

/// Number of calls of [`Calls::spoiled`].
pub const SPOILED: usize = 26;
