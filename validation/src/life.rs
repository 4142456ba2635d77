//! A whole life of the landing gear through the C functions, as a host calls them.
#![allow(unsafe_code)]

use linkage_fmu::fmi2::types::{CO_SIMULATION, CallbackFunctions, Component, FALSE, Status, TRUE};
use linkage_fmu::fmi2::{
    fmi2DoStep, fmi2EnterInitializationMode, fmi2ExitInitializationMode, fmi2FreeInstance, fmi2GetReal,
    fmi2Instantiate, fmi2SetupExperiment, fmi2Terminate,
};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::Reference;
use std::ffi::CString;
use std::path::Path;
use std::ptr::null_mut;

/// Duration of scene S1 [s].
const SPAN: f64 = 0.13;

/// What a host knows before it makes an instance.
pub struct Life {
    guid: CString,
    resources: CString,
    outputs: [Reference; Self::OUTPUTS.len()],
}

/// An instance.
pub struct Instance(pub Component);

impl Instance {
    /// Free it.
    pub fn free(self) {
        // SAFETY: the component is valid, and is not used again as `self` ends here (2.1.5).
        unsafe { fmi2FreeInstance(self.0) }
    }
}

fn text(text: &str) -> Result<CString, String> {
    CString::new(text).map_err(|e| e.to_string())
}

/// `Ok`, or what the call answered instead.
///
/// # Errors
/// The status is any other.
pub fn done(call: &str, status: Status) -> Result<(), String> {
    if status == Status::Ok { Ok(()) } else { Err(format!("{call}: {status:?}")) }
}

impl Life {
    /// Outputs read at the end.
    pub const OUTPUTS: [&str; 3] = ["crank.angle", "crank.speed", "energy.drift"];

    /// For the mechanism of a description folder.
    ///
    /// # Errors
    /// The file cannot be read or gives no mechanism; it has not these outputs.
    pub fn new(folder: &Path) -> Result<Self, String> {
        let model = Model::from_json(&crate::measure::mechanism(folder)?).map_err(|e| e.to_string())?;
        let resources = folder.join("resources").canonicalize().map_err(|e| e.to_string())?;
        let mut outputs = [0; Self::OUTPUTS.len()];
        for (reference, name) in outputs.iter_mut().zip(Self::OUTPUTS) {
            *reference = model.variables().find(name).ok_or_else(|| format!("there is no {name}"))?;
        }
        Ok(Self { guid: text(model.variables().guid())?, resources: text(&resources.to_string_lossy())?, outputs })
    }

    /// A new instance.
    ///
    /// # Errors
    /// It is refused.
    pub fn instantiate(&self) -> Result<Instance, String> {
        let functions = CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: null_mut(),
        };
        let (guid, resources) = (self.guid.as_ptr(), self.resources.as_ptr());
        // SAFETY: all pointers live during the call; there are no callbacks (2.1.5).
        let component =
            unsafe { fmi2Instantiate(c"gear".as_ptr(), CO_SIMULATION, guid, resources, &functions, FALSE, FALSE) };
        if component.is_null() { Err("fmi2Instantiate: refused".into()) } else { Ok(Instance(component)) }
    }

    /// From instantiate to free.
    ///
    /// # Errors
    /// A call is refused.
    pub fn live(&self) -> Result<(), String> {
        let Instance(c) = self.instantiate()?;
        let mut values = [0.0; Self::OUTPUTS.len()];
        // SAFETY: the component is valid until it is freed; the arrays have the length that is passed (2.1.7).
        unsafe {
            done("fmi2SetupExperiment", fmi2SetupExperiment(c, FALSE, 0.0, 0.0, TRUE, SPAN))?;
            done("fmi2EnterInitializationMode", fmi2EnterInitializationMode(c))?;
            done("fmi2ExitInitializationMode", fmi2ExitInitializationMode(c))?;
            done("fmi2DoStep", fmi2DoStep(c, 0.0, SPAN, TRUE))?;
            done("fmi2GetReal", fmi2GetReal(c, self.outputs.as_ptr(), values.len(), values.as_mut_ptr()))?;
            done("fmi2Terminate", fmi2Terminate(c))?;
            fmi2FreeInstance(c);
        }
        std::hint::black_box(values);
        Ok(())
    }
}
