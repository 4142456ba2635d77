//! A host of the exported functions, for tests and benchmarks.
//!
//! In: a folder with `resources/mechanism.json`. Out: instances called through the C functions; statuses, values, saved
//! states, messages. Must not know: how a call works. Each method is one call and safe to use: arrays have the lengths
//! that are passed, and states come from this library. A name that the mechanism does not have becomes a value
//! reference that does not exist, so the call returns `fmi2Error`. A method with a result returns the status as an
//! error if the status is not `fmi2OK`.

use super::types::{
    Boolean, CO_SIMULATION, CallbackFunctions, Component, Environment, EventInfo, FALSE, FmuState, Integer,
    LoggerCallback, MODEL_EXCHANGE, Status, Text, ValueReference,
};
use super::*;
use crate::component;
use crate::fmi::exchange_calls;
use crate::variables::{Interface, Vector};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_int};
use std::path::Path;
use std::ptr::null_mut;
use std::sync::Arc;

/// Message of the logger.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Name of the instance.
    pub instance: String,
    /// `fmi2Status` as a number.
    pub status: c_int,
    /// Log category.
    pub category: String,
    /// Text.
    pub text: String,
}

/// Messages of one instance. The address of the log is the component environment.
#[derive(Debug, Default)]
pub struct Log(RefCell<Vec<Message>>);

impl Log {
    /// Adds a message.
    pub(crate) fn push(&self, message: Message) {
        self.0.borrow_mut().push(message);
    }

    /// The messages since the last call.
    pub fn take(&self) -> Vec<Message> {
        self.0.take()
    }
}

/// Copy of a text of the library.
pub(crate) fn owned(text: Text) -> String {
    // SAFETY: the library passes strings that end with a zero byte.
    unsafe { CStr::from_ptr(text) }.to_str().expect("texts are UTF-8").to_owned()
}

/// Zero-terminated copy of a text, up to the first zero byte.
fn terminated(text: &str) -> CString {
    CString::new(text.split('\0').next().unwrap_or_default()).unwrap_or_default()
}

unsafe extern "C-unwind" fn log(env: Environment, name: Text, status: c_int, category: Text, format: Text, text: Text) {
    assert_eq!(owned(format), "%s");
    // SAFETY: the environment is the `Log` passed to `callbacks`, which outlives the instance.
    let log = unsafe { &*env.cast::<Log>() };
    log.push(Message { instance: owned(name), status, category: owned(category), text: owned(text) });
}

/// The logger as the variadic function of the standard. On the ABIs of the supported platforms, the first variadic
/// pointer is passed like a named argument.
pub fn logger() -> LoggerCallback {
    let logger: unsafe extern "C-unwind" fn(Environment, Text, c_int, Text, Text, Text) = log;
    // SAFETY: see above. Rust cannot define a variadic function.
    unsafe { std::mem::transmute(logger) }
}

/// Callback functions with this logger, if there is one. The logger writes to `log`.
pub fn callbacks(logger: Option<LoggerCallback>, log: &Log) -> CallbackFunctions {
    let environment = (&raw const *log).cast_mut().cast();
    CallbackFunctions { logger, allocate_memory: None, free_memory: None, step_finished: None, environment }
}

/// The data of an FMU that an importer has before it creates an instance: variables, GUID, resource location.
#[derive(Debug)]
pub struct Description {
    component: component::Component,
    guid: CString,
    location: CString,
}

impl Description {
    /// The FMU of a folder with a definition file in `resources`.
    ///
    /// # Errors
    /// The file cannot be read or defines no model.
    pub fn read(folder: &Path) -> Result<Arc<Self>, String> {
        let resources = folder.join("resources");
        let name = component::Component::definition_files().into_iter().find(|name| resources.join(name).is_file());
        let name = name.ok_or_else(|| format!("{}: no definition file", resources.display()))?;
        let text = std::fs::read_to_string(resources.join(name)).map_err(|e| format!("{name}: {e}"))?;
        let component = component::Component::from_definition(name, &text).map_err(|e| e.0)?;
        let location = resources.canonicalize().map_err(|e| e.to_string())?;
        let (guid, location) = (terminated(component.interface().guid()), terminated(&location.to_string_lossy()));
        Ok(Arc::new(Self { component, guid, location }))
    }

    /// The variables of the FMU.
    pub fn interface(&self) -> &Interface {
        self.component.interface()
    }

    /// Value reference of a variable, or `u32::MAX`, which no variable has, if the name does not exist.
    pub fn reference(&self, name: &str) -> ValueReference {
        self.interface().find(name).unwrap_or(ValueReference::MAX)
    }

    /// Vectors of the FMU in FMI 3.0.
    pub fn vectors(&self) -> Vec<Vector> {
        self.component.vectors()
    }

    /// Whether an event may occur in a step.
    pub fn has_events(&self) -> bool {
        self.component.has_events()
    }

    /// GUID of the interface.
    pub(crate) fn guid(&self) -> &CStr {
        &self.guid
    }

    /// Folder of the resources, as a plain path.
    pub(crate) fn location(&self) -> &CStr {
        &self.location
    }

    /// Number of event indicators of model exchange.
    pub fn indicator_count(&self) -> usize {
        self.component.indicators().len()
    }

    /// Number of continuous states of model exchange.
    pub fn state_count(&self) -> usize {
        self.component.state_count()
    }

    /// New instance named `gear`, for co-simulation.
    ///
    /// # Errors
    /// The log messages if the instantiation fails.
    pub fn instantiate(self: &Arc<Self>, logger: Option<LoggerCallback>, logging_on: bool) -> Result<Host, String> {
        self.instantiate_as(CO_SIMULATION, logger, logging_on)
    }

    /// New instance named `gear`, for model exchange.
    ///
    /// # Errors
    /// As [`Self::instantiate`].
    pub fn exchange(self: &Arc<Self>, logger: Option<LoggerCallback>, logging_on: bool) -> Result<Host, String> {
        self.instantiate_as(MODEL_EXCHANGE, logger, logging_on)
    }

    fn instantiate_as(
        self: &Arc<Self>,
        fmu_type: c_int,
        logger: Option<LoggerCallback>,
        logging_on: bool,
    ) -> Result<Host, String> {
        let log = Box::<Log>::default();
        let functions = callbacks(logger, &log);
        let (name, guid, location) = (c"gear".as_ptr(), self.guid.as_ptr(), self.location.as_ptr());
        // SAFETY: all pointers are valid during the call, and the log as long as the instance.
        let c =
            unsafe { fmi2Instantiate(name, fmu_type, guid, location, &functions, FALSE, Boolean::from(logging_on)) };
        if c.is_null() {
            return Err(format!("fmi2Instantiate: refused: {:?}", log.take()));
        }
        Ok(Host { c, log, description: Arc::clone(self) })
    }
}

/// A saved state. [`Host::free`] frees it.
#[derive(Debug)]
pub struct State(FmuState);

impl State {
    /// No state yet: [`Host::save_into`] creates one.
    pub const NONE: Self = Self(null_mut());

    /// The pointer of the C interface.
    pub fn pointer(&self) -> FmuState {
        self.0
    }

    /// The variable that holds the pointer.
    pub(crate) fn place(&mut self) -> &mut FmuState {
        &mut self.0
    }
}

/// An instance with its messages. Dropping the host frees the instance.
#[derive(Debug)]
pub struct Host {
    /// The component of the C interface.
    pub c: Component,
    /// Messages of the instance.
    pub log: Box<Log>,
    description: Arc<Description>,
}

/// Calls without an argument except the component.
macro_rules! calls {
    ($($name:ident = $function:ident),*) => {
        $(
            #[doc = concat!("`", stringify!($function), "`.")]
            pub fn $name(&self) -> Status {
                // SAFETY: the component is valid.
                unsafe { $function(self.c) }
            }
        )*
    };
}

impl Host {
    calls!(
        enter = fmi2EnterInitializationMode,
        exit = fmi2ExitInitializationMode,
        terminate = fmi2Terminate,
        reset = fmi2Reset,
        enter_event_mode = fmi2EnterEventMode
    );
    exchange_calls!(
        fmi2EnterContinuousTimeMode,
        fmi2CompletedIntegratorStep,
        fmi2SetTime,
        fmi2SetContinuousStates,
        fmi2GetDerivatives,
        fmi2GetEventIndicators,
        fmi2GetContinuousStates,
        fmi2GetNominalsOfContinuousStates
    );

    fn instance(&self) -> Component {
        self.c
    }

    /// `fmi2NewDiscreteStates`. Returns the status, and whether the states jumped.
    pub fn update_discrete_states(&self) -> (Status, bool) {
        let (status, has_jumped, _) = self.update();
        (status, has_jumped)
    }

    /// [`Self::update_discrete_states`], and the time [s] of the next event if it is known.
    pub fn update(&self) -> (Status, bool, Option<f64>) {
        let mut info = EventInfo::default();
        // SAFETY: the component is valid; the pointer points to the struct.
        let status = unsafe { fmi2NewDiscreteStates(self.c, &mut info) };
        let next = (info.next_event_time_defined != FALSE).then_some(info.next_event_time);
        (status, info.values_changed != FALSE, next)
    }

    /// Value reference of a variable, or `u32::MAX` if the name does not exist.
    pub fn reference(&self, name: &str) -> ValueReference {
        self.description.reference(name)
    }

    /// Number of variables, which is the first value reference that does not exist.
    pub fn count(&self) -> u32 {
        self.description.interface().list().len() as u32
    }

    /// `fmi2GetReal`. Both slices have the same length.
    #[inline]
    pub fn reals(&self, references: &[ValueReference], values: &mut [f64]) -> Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: the component is valid; both arrays have the length that is passed.
        unsafe { fmi2GetReal(self.c, references.as_ptr(), references.len(), values.as_mut_ptr()) }
    }

    /// `fmi2SetReal`. Both slices have the same length.
    #[inline]
    pub fn set_reals(&self, references: &[ValueReference], values: &[f64]) -> Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: the component is valid; both arrays have the length that is passed.
        unsafe { fmi2SetReal(self.c, references.as_ptr(), references.len(), values.as_ptr()) }
    }

    /// `fmi2GetDirectionalDerivative` of some unknowns along one known, with the seed 1.
    #[inline]
    pub fn derivatives(&self, unknowns: &[ValueReference], known: ValueReference, values: &mut [f64]) -> Status {
        assert_eq!(unknowns.len(), values.len());
        let (unknown, count) = (unknowns.as_ptr(), unknowns.len());
        // SAFETY: the component is valid; two arrays have `count` elements, two have one.
        unsafe { fmi2GetDirectionalDerivative(self.c, unknown, count, &known, 1, &1.0, values.as_mut_ptr()) }
    }

    /// `fmi2SetRealInputDerivatives` of one input, with the orders 1, 2 and so on.
    #[inline]
    pub fn set_rates(&self, reference: ValueReference, rates: &[f64]) -> Status {
        const MOST: usize = 8;
        let (references, orders) = ([reference; MOST], [1, 2, 3, 4, 5, 6, 7, 8]);
        let count = rates.len().min(MOST);
        // SAFETY: the component is valid; all arrays have `count` elements or more.
        unsafe { fmi2SetRealInputDerivatives(self.c, references.as_ptr(), count, orders.as_ptr(), rates.as_ptr()) }
    }

    /// Value of one Real.
    pub fn get(&self, name: &str) -> Result<f64, Status> {
        let mut value = f64::NAN;
        self.reals(&[self.reference(name)], std::slice::from_mut(&mut value)).ok()?;
        Ok(value)
    }

    /// Sets one Real.
    pub fn set(&self, name: &str, value: f64) -> Status {
        self.set_reals(&[self.reference(name)], &[value])
    }

    /// Sets one Boolean.
    pub fn set_boolean(&self, name: &str, value: bool) -> Status {
        // SAFETY: the component is valid; one reference, one value.
        unsafe { fmi2SetBoolean(self.c, &self.reference(name), 1, &Boolean::from(value)) }
    }

    /// Name of the item of one Enumeration.
    pub fn get_item(&self, name: &str) -> Result<&'static str, Status> {
        let (reference, mut number) = (self.reference(name), 0);
        // SAFETY: the component is valid; one reference, one value.
        unsafe { fmi2GetInteger(self.c, &reference, 1, &mut number) }.ok()?;
        let items = self.description.interface().get(reference).map_or(&[][..], |variable| variable.details.items);
        Ok(items[number as usize - 1])
    }

    /// Sets one Enumeration by the name of an item. An unknown name is passed as 0.
    pub fn set_item(&self, name: &str, item: &str) -> Status {
        let reference = self.reference(name);
        let variable = self.description.interface().get(reference);
        let number = variable.and_then(|variable| variable.number_of(item)).unwrap_or_default();
        self.set_number(name, number as Integer)
    }

    /// Sets one Enumeration by the number of an item.
    pub fn set_number(&self, name: &str, number: Integer) -> Status {
        // SAFETY: the component is valid; one reference, one value.
        unsafe { fmi2SetInteger(self.c, &self.reference(name), 1, &number) }
    }

    /// `fmi2SetupExperiment`. An undefined tolerance or stop time is passed as NaN.
    pub fn set_up(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Status {
        let defined = |value: Option<f64>| (Boolean::from(value.is_some()), value.unwrap_or(f64::NAN));
        let ((has_tolerance, tolerance), (has_stop, stop)) = (defined(tolerance), defined(stop));
        // SAFETY: the component is valid.
        unsafe { fmi2SetupExperiment(self.c, has_tolerance, tolerance, start, has_stop, stop) }
    }

    /// Initializes the instance, up to step mode. Returns the first status that is not `fmi2OK`.
    pub fn initialize(&self) -> Status {
        self.enter().ok().map_or_else(|refused| refused, |()| self.exit())
    }

    /// `fmi2DoStep` of size `h` [s] from a communication point [s].
    #[inline]
    pub fn step(&self, point: f64, h: f64) -> Status {
        // SAFETY: the component is valid.
        unsafe { fmi2DoStep(self.c, point, h, FALSE) }
    }

    /// `fmi2GetFMUstate` into an existing state, or a new one for [`State::NONE`].
    #[inline]
    pub fn save_into(&self, state: &mut State) -> Status {
        // SAFETY: the component is valid; the state is NULL or belongs to this library.
        unsafe { fmi2GetFMUstate(self.c, &mut state.0) }
    }

    /// `fmi2SetFMUstate`.
    #[inline]
    pub fn restore(&self, state: &State) -> Status {
        // SAFETY: the component is valid; the state is NULL or belongs to this library.
        unsafe { fmi2SetFMUstate(self.c, state.0) }
    }

    /// `fmi2FreeFMUstate`. The state becomes [`State::NONE`].
    pub fn free(&self, state: &mut State) -> Status {
        // SAFETY: the component is valid; the state is NULL or belongs to this library.
        unsafe { fmi2FreeFMUstate(self.c, &mut state.0) }
    }

    /// Serialises a state.
    pub fn serialize(&self, state: &State) -> Result<Vec<u8>, Status> {
        let mut size = 0;
        // SAFETY: component and state are valid; the array has the size that is passed.
        unsafe {
            fmi2SerializedFMUstateSize(self.c, state.0, &mut size).ok()?;
            let mut bytes = vec![0_u8; size];
            fmi2SerializeFMUstate(self.c, state.0, bytes.as_mut_ptr().cast(), size).ok()?;
            Ok(bytes)
        }
    }

    /// Creates a state from bytes.
    pub fn deserialize(&self, bytes: &[u8]) -> Result<State, Status> {
        // A failed call does not change the pointer.
        let untouched: FmuState = null_mut::<u8>().wrapping_add(64).cast();
        let mut state = untouched;
        // SAFETY: the component is valid, the array has the length that is passed. The pointer is written, not read.
        let status = unsafe { fmi2DeSerializeFMUstate(self.c, bytes.as_ptr().cast(), bytes.len(), &mut state) };
        assert!(status == Status::Ok || state == untouched);
        status.ok().map(|()| State(state))
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: the component is not used again.
        unsafe { fmi2FreeInstance(self.c) }
    }
}
