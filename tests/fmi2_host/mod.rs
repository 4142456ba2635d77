//! A host as a C program would be: raw pointers, a printf-style logger, temporary folders for resources.
#![allow(unsafe_code, dead_code, clippy::unwrap_used)]

use linkage_fmu::fmi2::types::{CallbackFunctions, Component, Environment, LoggerCallback, Status, Text};
use linkage_fmu::fmi2::*;
use linkage_fmu::mechanism::Model;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::{Path, PathBuf};
use std::ptr::null;
use std::sync::OnceLock;

pub const RESOURCES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/LandingGearRetraction/resources");

/// One message as the logger got it.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    pub instance: String,
    pub status: c_int,
    pub category: String,
    pub text: String,
}

/// The host's side of an instance; its address is the component environment.
#[derive(Default)]
pub struct Log {
    messages: RefCell<Vec<Message>>,
}

impl Log {
    /// The messages since the last call.
    pub fn take(&self) -> Vec<Message> {
        self.messages.take()
    }
}

fn owned(text: Text) -> String {
    // SAFETY: the library passes strings.
    unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned()
}

unsafe extern "C" fn logger(env: Environment, name: Text, status: c_int, category: Text, format: Text, text: Text) {
    assert_eq!(owned(format), "%s");
    // SAFETY: the environment is the host's `Log`.
    let log = unsafe { &*env.cast::<Log>() };
    let message = Message { instance: owned(name), status, category: owned(category), text: owned(text) };
    log.messages.borrow_mut().push(message);
}

/// The logger as the variadic function that the standard wants. On the ABIs in use here a first variadic pointer lies
/// where a named one would.
pub fn callback() -> LoggerCallback {
    let logger: unsafe extern "C" fn(Environment, Text, c_int, Text, Text, Text) = logger;
    // SAFETY: see above; Rust cannot define a variadic function.
    unsafe { std::mem::transmute(logger) }
}

pub fn callbacks(logger: Option<LoggerCallback>, log: &Log) -> CallbackFunctions {
    let environment = (&raw const *log).cast_mut().cast::<c_void>();
    CallbackFunctions { logger, allocate_memory: None, free_memory: None, step_finished: None, environment }
}

/// The gear as the engine sees it: for value references and the GUID. Read once, as a test makes many instances.
pub fn gear() -> Model {
    static GEAR: OnceLock<Model> = OnceLock::new();
    let read = || Model::from_json(&std::fs::read_to_string(Path::new(RESOURCES).join("mechanism.json")).unwrap());
    GEAR.get_or_init(|| read().unwrap()).clone()
}

pub fn c(text: &str) -> CString {
    CString::new(text).unwrap()
}

/// An instance of the landing gear with its log.
pub struct Gear {
    pub c: Component,
    pub log: Box<Log>,
    model: Model,
}

impl Gear {
    pub fn new() -> Self {
        Self::with_logger(Some(callback()), 1)
    }

    pub fn with_logger(logger: Option<LoggerCallback>, logging_on: c_int) -> Self {
        let (log, model) = (Box::<Log>::default(), gear());
        let (guid, location) = (c(model.variables().guid()), c(&format!("file://{RESOURCES}")));
        let component = {
            let functions = callbacks(logger, &log);
            // SAFETY: all pointers live during the call; the callbacks do so no longer, which is allowed.
            unsafe { fmi2Instantiate(c"gear".as_ptr(), 1, guid.as_ptr(), location.as_ptr(), &functions, 0, logging_on) }
        };
        assert!(!component.is_null(), "{:?}", log.take());
        Gear { c: component, log, model }
    }

    /// An instance in step mode that starts at `start`.
    pub fn stepping(start: f64, stop: Option<f64>) -> Self {
        let gear = Self::new();
        // SAFETY: the component is valid.
        unsafe {
            let stop_defined = c_int::from(stop.is_some());
            assert_eq!(fmi2SetupExperiment(gear.c, 0, 0.0, start, stop_defined, stop.unwrap_or(0.0)), Status::Ok);
            assert_eq!(fmi2EnterInitializationMode(gear.c), Status::Ok);
            assert_eq!(fmi2ExitInitializationMode(gear.c), Status::Ok);
        }
        gear.log.take();
        gear
    }

    pub fn vr(&self, name: &str) -> u32 {
        self.model.variables().find(name).unwrap()
    }

    pub fn find(&self, name: &str) -> Option<u32> {
        self.model.variables().find(name)
    }

    pub fn count(&self) -> u32 {
        self.model.variables().list().len() as u32
    }

    pub fn get(&self, name: &str) -> Result<f64, Status> {
        let mut value = f64::NAN;
        // SAFETY: one reference, room for one value.
        match unsafe { fmi2GetReal(self.c, &self.vr(name), 1, &mut value) } {
            Status::Ok => Ok(value),
            status => Err(status),
        }
    }

    pub fn set(&self, name: &str, value: f64) -> Status {
        // SAFETY: one reference, one value.
        unsafe { fmi2SetReal(self.c, &self.vr(name), 1, &value) }
    }

    pub fn get_text(&self, name: &str) -> Result<String, Status> {
        let mut value = null();
        // SAFETY: one reference, room for one value, which is copied before the next call.
        match unsafe { fmi2GetString(self.c, &self.vr(name), 1, &mut value) } {
            Status::Ok => Ok(owned(value)),
            status => Err(status),
        }
    }

    pub fn set_text(&self, name: &str, value: &str) -> Status {
        // SAFETY: one reference, one value; the text does not outlive the call.
        unsafe { fmi2SetString(self.c, &self.vr(name), 1, &c(value).as_ptr()) }
    }

    /// From the instantiated phase into step mode.
    pub fn initialize(&self) -> Status {
        // SAFETY: the component is valid.
        unsafe {
            assert_eq!(fmi2EnterInitializationMode(self.c), Status::Ok);
            fmi2ExitInitializationMode(self.c)
        }
    }

    pub fn step(&self, point: f64, h: f64) -> Status {
        // SAFETY: the component is valid.
        unsafe { fmi2DoStep(self.c, point, h, 1) }
    }

    /// The only message since the last look, of a refused call.
    pub fn refusal(&self) -> String {
        let messages = self.log.take();
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert_eq!((messages[0].status, messages[0].category.as_str()), (3, "logStatusError"));
        assert_eq!(messages[0].instance, "gear");
        messages[0].text.clone()
    }
}

impl Drop for Gear {
    fn drop(&mut self) {
        // SAFETY: the component is not used again.
        unsafe { fmi2FreeInstance(self.c) }
    }
}

/// Arguments of `fmi2Instantiate`, to be spoiled one by one.
pub struct Arguments {
    pub name: *const c_char,
    pub fmu_type: c_int,
    pub guid: Option<CString>,
    pub location: Option<CString>,
}

impl Arguments {
    pub fn new() -> Self {
        let guid = Some(c(gear().variables().guid()));
        Arguments { name: c"gear".as_ptr(), fmu_type: 1, guid, location: Some(c(RESOURCES)) }
    }

    pub fn at(location: &str) -> Self {
        Arguments { location: Some(c(location)), ..Self::new() }
    }

    /// Instantiate and free again: the text of the refusal, if it is one.
    pub fn refused(&self) -> Option<String> {
        let log = Log::default();
        let pointer = |text: &Option<CString>| text.as_ref().map_or(null(), |text| text.as_ptr());
        let functions = callbacks(Some(callback()), &log);
        let (guid, location) = (pointer(&self.guid), pointer(&self.location));
        // SAFETY: all pointers are NULL or live during the calls.
        unsafe {
            let component = fmi2Instantiate(self.name, self.fmu_type, guid, location, &functions, 0, 0);
            fmi2FreeInstance(component);
            component.is_null().then(|| log.take().pop().unwrap().text)
        }
    }
}

/// A folder that vanishes with this value.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("linkage-fmu {} {name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
