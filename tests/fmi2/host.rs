//! The landing gear as the tests use it: instances in any phase, arguments of `fmi2Instantiate` that a test can change,
//! folders.
#![allow(unsafe_code, dead_code, clippy::unwrap_used)]

#[path = "../support/folder.rs"]
mod folder;

pub use folder::Folder;
use linkage_fmu::fmi2::host::{Description, Host, Log, State, callbacks, logger};
use linkage_fmu::fmi2::types::{LoggerCallback, Status};
use linkage_fmu::fmi2::{fmi2FreeInstance, fmi2Instantiate};
use linkage_fmu::variables::Interface;
use std::ffi::{CString, c_char, c_int};
use std::ops::Deref;
use std::path::Path;
use std::ptr::null;
use std::sync::{Arc, OnceLock};

pub const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/LandingGearRetraction");
pub const RESOURCES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/LandingGearRetraction/resources");

/// The landing gear's description. It is read once, because the tests create many instances.
pub fn description() -> &'static Arc<Description> {
    static GEAR: OnceLock<Arc<Description>> = OnceLock::new();
    GEAR.get_or_init(|| Description::read(Path::new(FOLDER)).unwrap())
}

/// The variables of the landing gear.
pub fn interface() -> &'static Interface {
    description().interface()
}

/// Text of the landing gear's file.
pub fn mechanism() -> String {
    std::fs::read_to_string(Path::new(RESOURCES).join("mechanism.json")).unwrap()
}

pub fn c(text: &str) -> CString {
    CString::new(text).unwrap()
}

/// An instance of the landing gear.
pub struct Gear(Host);

impl Deref for Gear {
    type Target = Host;

    fn deref(&self) -> &Host {
        &self.0
    }
}

impl Gear {
    pub fn new() -> Self {
        Self::with_logger(Some(logger()), true)
    }

    pub fn with_logger(logger: Option<LoggerCallback>, logging_on: bool) -> Self {
        Gear(description().instantiate(logger, logging_on).unwrap())
    }

    /// An instance in step mode that starts at `start`.
    pub fn stepping(start: f64, stop: Option<f64>) -> Self {
        let gear = Self::new();
        assert_eq!(gear.set_up(None, start, stop), Status::Ok);
        assert_eq!(gear.initialize(), Status::Ok);
        gear.log.take();
        gear
    }

    pub fn find(&self, name: &str) -> Option<u32> {
        interface().find(name)
    }

    pub fn vr(&self, name: &str) -> u32 {
        self.find(name).unwrap()
    }

    /// Status and bits of the variable with this reference, read as a Real. The bits are 0 if it cannot be read.
    pub fn bits(&self, reference: u32) -> (Status, u64) {
        let mut value = [0.0];
        let status = self.reals(&[reference], &mut value);
        (status, if status == Status::Ok { value[0].to_bits() } else { 0 })
    }

    /// Statuses and bits of all variables, read as Reals.
    pub fn all_bits(&self) -> Vec<(Status, u64)> {
        let all = (0..self.count()).map(|reference| self.bits(reference)).collect();
        self.log.take();
        all
    }

    pub fn save(&self) -> State {
        let mut state = State::NONE;
        assert_eq!(self.save_into(&mut state), Status::Ok);
        assert!(!state.pointer().is_null());
        state
    }

    /// The only message since the last call, from a rejected call.
    pub fn refusal(&self) -> String {
        let messages = self.log.take();
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert_eq!((messages[0].status, messages[0].category.as_str()), (3, "logStatusError"));
        assert_eq!(messages[0].instance, "gear");
        messages[0].text.clone()
    }
}

/// Arguments of `fmi2Instantiate`, which a test changes one by one.
pub struct Arguments {
    pub name: *const c_char,
    pub fmu_type: c_int,
    pub guid: Option<CString>,
    pub location: Option<CString>,
}

impl Arguments {
    pub fn new() -> Self {
        let guid = Some(c(interface().guid()));
        Arguments { name: c"gear".as_ptr(), fmu_type: 1, guid, location: Some(c(RESOURCES)) }
    }

    pub fn at(location: &str) -> Self {
        Arguments { location: Some(c(location)), ..Self::new() }
    }

    /// Instantiate and free the instance. Returns the message if `fmi2Instantiate` fails.
    pub fn refused(&self) -> Option<String> {
        let log = Log::default();
        let pointer = |text: &Option<CString>| text.as_ref().map_or(null(), |text| text.as_ptr());
        let functions = callbacks(Some(logger()), &log);
        let (guid, location) = (pointer(&self.guid), pointer(&self.location));
        // SAFETY: all pointers are NULL or live during the calls.
        unsafe {
            let component = fmi2Instantiate(self.name, self.fmu_type, guid, location, &functions, 0, 0);
            fmi2FreeInstance(component);
            component.is_null().then(|| log.take().pop().unwrap().text)
        }
    }
}

impl Folder {
    /// The folder as an unpacked FMU with this definition in its resources.
    pub fn described(&self, definition: &str) -> Arc<Description> {
        self.write("resources/mechanism.json", definition);
        Description::read(&self.0).unwrap()
    }

    /// Path in the form in which a host passes it.
    pub fn location(&self) -> &str {
        self.0.to_str().unwrap()
    }
}
