//! One instance: a model, its phase, its clock and its logger. Safe code; the boundary is in `mod` and `guard`.
//!
//! In: checked slices and plain numbers. Out: values, or a refusal that leaves the instance as it was.

use super::access;
use super::clock::Clock;
use super::location;
use super::logger::Logger;
use super::phase::Phase;
use super::refusal::Refusal;
use super::saved::Saved;
use super::types::{Boolean, CO_SIMULATION, FALSE, Integer, MODEL_EXCHANGE, Real, Status, TRUE, Text};
use super::types::{DO_STEP_STATUS, LAST_SUCCESSFUL_TIME, PENDING_STATUS, TERMINATED};
use crate::integrator::Method;
use crate::mechanism::Model;
use crate::numerics::decimal::Decimal;
use crate::variables::{Kind, Reference};
use std::ffi::{CStr, CString, c_int};
use std::fs::File;
use std::io::Read;
use std::mem::MaybeUninit;
use std::path::Path;

/// File in the resources folder that defines the mechanism.
const MECHANISM: &str = "mechanism.json";
/// Most bytes that file may have; a mechanism of 100 bodies has some 30 thousand.
const LARGEST: u64 = 16 << 20;

/// One instance of the FMU.
#[derive(Debug)]
pub struct Instance {
    /// Present phase; `guard` checks it before each call.
    pub phase: Phase,
    /// Where messages go.
    pub logger: Logger,
    /// Whether `fmi2SetupExperiment` was called.
    set_up: bool,
    /// That of the experiment, if it has one: it holds against solver.tolerance.
    tolerance: Option<Real>,
    clock: Clock,
    model: Model,
    /// Texts that `fmi2GetString` told last: its pointers lead here.
    texts: Vec<CString>,
}

/// Model of a new instance: read `mechanism.json`, now and not earlier, so that a user may edit its numbers.
///
/// # Errors
/// Another interface than co-simulation, no or an unreadable file, a faulty mechanism, a GUID that is not its own.
pub fn load(fmu_type: c_int, guid: Option<&CStr>, location: Option<&CStr>) -> Result<Model, Refusal> {
    match fmu_type {
        CO_SIMULATION => {}
        MODEL_EXCHANGE => {
            return Err(Refusal::error("fmuType is fmi2ModelExchange; this FMU is for co-simulation only"));
        }
        other => return Err(Refusal::error(format!("fmuType is {other}; it must be 1 (fmi2CoSimulation)"))),
    }
    let guid = guid
        .filter(|guid| !guid.is_empty())
        .ok_or_else(|| Refusal::error("fmuGUID is NULL or empty; pass the guid of modelDescription.xml"))?;
    let resources = match location.filter(|location| !location.is_empty()) {
        Some(location) => location::from_uri(location.to_bytes())?,
        None => location::beside_library()?,
    };
    let file = resources.join(MECHANISM);
    let json = read(&file)?;
    let model = Model::from_json(&json).map_err(|error| Refusal::error(format!("'{}': {error}", file.display())))?;
    if guid.to_bytes() != model.variables().guid().as_bytes() {
        return Err(Refusal::error(format!(
            "fmuGUID is '{}', but '{}' has the interface '{}'; import the FMU again, or restore the names in the file",
            guid.to_bytes().escape_ascii(),
            file.display(),
            model.variables().guid()
        )));
    }
    Ok(model)
}

/// Text of the file. What is no file, such as a pipe, is not opened, as that could wait for ever; what is too large is
/// not read.
fn read(file: &Path) -> Result<String, Refusal> {
    let refused = |reason: String| Refusal::error(format!("cannot read '{}': {reason}", file.display()));
    let metadata = std::fs::metadata(file).map_err(|error| refused(error.to_string()))?;
    if !metadata.is_file() {
        return Err(refused(format!("it is no file; put the mechanism's {MECHANISM} there")));
    }
    let too_large =
        |size: u64| refused(format!("it has {size} bytes, and a mechanism at most {LARGEST}; is it the right file?"));
    if metadata.len() > LARGEST {
        return Err(too_large(metadata.len()));
    }
    let mut text = String::new();
    let read = File::open(file).and_then(|file| file.take(LARGEST + 1).read_to_string(&mut text));
    match read {
        // The size that the system tells need not be the true one.
        Ok(size) if size as u64 > LARGEST => Err(too_large(size as u64)),
        Ok(_) => Ok(text),
        Err(error) => Err(refused(error.to_string())),
    }
}

impl Instance {
    /// Instance in the phase that follows `fmi2Instantiate`.
    pub fn new(logger: Logger, model: Model) -> Self {
        Instance {
            phase: Phase::Instantiated,
            logger,
            set_up: false,
            tolerance: None,
            clock: Clock::default(),
            model,
            texts: Vec::new(),
        }
    }

    /// `fmi2SetupExperiment`. Not called, the start time is 0 and there is no stop time.
    pub fn setup_experiment(
        &mut self,
        tolerance: Option<Real>,
        start: Real,
        stop: Option<Real>,
    ) -> Result<(), Refusal> {
        let clock = Clock::new(start, stop)?;
        if let Some(tolerance) = tolerance {
            if !(tolerance > 0.0 && tolerance.is_finite()) {
                return Err(Refusal::error(format!(
                    "tolerance is {}; it must be finite and greater than 0",
                    Decimal(tolerance)
                )));
            }
            self.model.set_tolerance(tolerance)?;
        }
        self.tolerance = tolerance;
        self.clock = clock;
        self.set_up = true;
        Ok(())
    }

    /// `fmi2EnterInitializationMode`. Nothing is computed until an output is read or the mode is left.
    pub fn enter_initialization_mode(&mut self) -> Result<(), Refusal> {
        if !self.set_up {
            let message = "fmi2EnterInitializationMode: no fmi2SetupExperiment before; startTime is 0, no stopTime";
            self.logger.log(Status::Warning, message);
        }
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`. Refused, the mode goes on: parameters can be corrected.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Refusal> {
        if let Some(tolerance) = self.tolerance {
            self.model.set_tolerance(tolerance)?;
        }
        self.model.initialize()?;
        self.phase = Phase::Step;
        self.logger.event(|| format!("initialized at t = {} s", self.clock.time()));
        Ok(())
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        self.phase = Phase::Terminated;
        self.logger.event(|| {
            let cost = self.model.statistics();
            let methods = Method::ALL.map(|method| format!("{} by {}", cost.accepted_by(method), method.name()));
            format!(
                "terminated at t = {} s after {} evaluations in {} accepted steps ({}) and {} rejected",
                self.clock.time(),
                cost.evaluations,
                cost.accepted,
                methods.join(", "),
                cost.rejected
            )
        });
        Ok(())
    }

    /// `fmi2Reset`: as after `fmi2Instantiate`, but for the log categories, which stay as the host chose them.
    pub fn reset(&mut self) -> Result<(), Refusal> {
        self.model.reset();
        self.clock = Clock::default();
        self.set_up = false;
        self.tolerance = None;
        self.phase = Phase::Instantiated;
        Ok(())
    }

    /// `fmi2GetFMUstate`: everything that decides what follows; the log categories are no part of it.
    pub fn save(&self) -> Saved {
        let Self { phase, set_up, tolerance, clock, .. } = *self;
        Saved { phase, set_up, tolerance, clock, model: self.model.snapshot() }
    }

    /// [`Self::save`] in the place of a state of this FMU, without allocation where that was one of the same kind.
    pub fn save_into(&self, saved: &mut Saved) {
        (saved.phase, saved.set_up) = (self.phase, self.set_up);
        (saved.tolerance, saved.clock) = (self.tolerance, self.clock);
        self.model.snapshot_into(&mut saved.model);
    }

    /// `fmi2SetFMUstate`: from here on as the instance that was saved, in the phase that it was in.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), Refusal> {
        self.model.restore(&saved.model)?;
        (self.phase, self.set_up) = (saved.phase, saved.set_up);
        (self.tolerance, self.clock) = (saved.tolerance, saved.clock);
        Ok(())
    }

    /// The state that these bytes tell. The instance stays as it is.
    pub fn deserialize(&self, bytes: &[u8]) -> Result<Saved, Refusal> {
        Saved::from_bytes(bytes, &self.model)
    }

    /// What a state must have been saved of.
    pub fn identity(&self) -> [u64; 2] {
        self.model.identity()
    }

    /// `fmi2GetReal`.
    pub fn get_real(&mut self, references: &[Reference], values: &mut [MaybeUninit<Real>]) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values) {
            access::may_get(self.model.variables(), self.phase, reference, Kind::Real)?;
            value.write(self.model.real(reference)?);
        }
        Ok(())
    }

    /// `fmi2GetBoolean`.
    pub fn get_boolean(
        &mut self,
        references: &[Reference],
        values: &mut [MaybeUninit<Boolean>],
    ) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values) {
            access::may_get(self.model.variables(), self.phase, reference, Kind::Boolean)?;
            value.write(if self.model.boolean(reference)? { TRUE } else { FALSE });
        }
        Ok(())
    }

    /// `fmi2GetString`: the pointers hold until the next call of it, or the end of the instance.
    pub fn get_string(&mut self, references: &[Reference], values: &mut [MaybeUninit<Text>]) -> Result<(), Refusal> {
        self.texts.clear();
        for (&reference, value) in references.iter().zip(values) {
            access::may_get(self.model.variables(), self.phase, reference, Kind::String)?;
            let text = CString::new(self.model.text(reference)?)
                .map_err(|_| Refusal::error(format!("value reference {reference}: the text holds a zero byte")))?;
            value.write(text.as_ptr());
            self.texts.push(text);
        }
        Ok(())
    }

    /// `fmi2GetInteger`: a mechanism has no variables of this type.
    pub fn get_none(&self, references: &[Reference], kind: Kind) -> Result<(), Refusal> {
        match references.first() {
            None => Ok(()),
            Some(&reference) => {
                access::may_get(self.model.variables(), self.phase, reference, kind)?;
                Err(Refusal::error(format!("value reference {reference} is a {kind:?}, which cannot be read")))
            }
        }
    }

    /// `fmi2SetReal`: all values, or none.
    pub fn set_real(&mut self, references: &[Reference], values: &[Real]) -> Result<(), Refusal> {
        for (&reference, &value) in references.iter().zip(values) {
            access::may_set(self.model.variables(), self.phase, reference, Kind::Real)?;
            self.model.check_real(reference, value)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.model.set_real(reference, value)?;
        }
        Ok(())
    }

    /// `fmi2GetDirectionalDerivative`.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[Real],
        values: &mut [MaybeUninit<Real>],
    ) -> Result<(), Refusal> {
        let mut tell = |place: usize, value: f64| {
            values[place].write(value);
        };
        Ok(self.model.directional_derivative(unknowns, knowns, seeds, &mut tell)?)
    }

    /// `fmi2GetRealOutputDerivatives`.
    pub fn output_derivatives(
        &mut self,
        references: &[Reference],
        orders: &[Integer],
        values: &mut [MaybeUninit<Real>],
    ) -> Result<(), Refusal> {
        for ((&reference, &order), value) in references.iter().zip(orders).zip(values) {
            value.write(self.model.output_derivative(reference, order)?);
        }
        Ok(())
    }

    /// `fmi2SetRealInputDerivatives`: all values, or none.
    pub fn set_input_derivatives(
        &mut self,
        references: &[Reference],
        orders: &[Integer],
        values: &[Real],
    ) -> Result<(), Refusal> {
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            self.model.check_input_derivative(reference, order, value)?;
        }
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            self.model.set_input_derivative(reference, order, value)?;
        }
        Ok(())
    }

    /// `fmi2SetBoolean`: all values, or none.
    pub fn set_boolean(&mut self, references: &[Reference], values: &[Boolean]) -> Result<(), Refusal> {
        for (&reference, &value) in references.iter().zip(values) {
            access::may_set(self.model.variables(), self.phase, reference, Kind::Boolean)?;
            self.model.check_boolean(reference, value != FALSE)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.model.set_boolean(reference, value != FALSE)?;
        }
        Ok(())
    }

    /// `fmi2SetString`: all values, or none.
    pub fn set_string(&mut self, references: &[Reference], values: &[Option<&CStr>]) -> Result<(), Refusal> {
        let mut texts = Vec::with_capacity(values.len());
        for (&reference, value) in references.iter().zip(values) {
            access::may_set(self.model.variables(), self.phase, reference, Kind::String)?;
            let value =
                value.ok_or_else(|| Refusal::error(format!("value reference {reference}: the text is NULL")))?;
            let text = value.to_string_lossy();
            self.model.check_text(reference, &text)?;
            texts.push(text);
        }
        for (&reference, text) in references.iter().zip(&texts) {
            self.model.set_text(reference, text)?;
        }
        Ok(())
    }

    /// `fmi2SetInteger`: a mechanism has no variables of this type.
    pub fn set_none(&self, references: &[Reference], kind: Kind) -> Result<(), Refusal> {
        match references.first() {
            None => Ok(()),
            Some(&reference) => {
                access::may_set(self.model.variables(), self.phase, reference, kind)?;
                Err(Refusal::error(format!("value reference {reference} is a {kind:?}, which cannot be set")))
            }
        }
    }

    /// `fmi2DoStep`: advance by exactly `h` [s] from the present communication point.
    ///
    /// The time after the step is the host's point plus `h`, so that the rounding of the host's sum is never held
    /// against it. A step that the model cannot compute leaves the state of the last communication point.
    pub fn do_step(&mut self, point: Real, h: Real) -> Result<(), Refusal> {
        let end = self.clock.end_of_step(point, h)?;
        if let Err(error) = self.model.step(h) {
            self.phase = Phase::Failed;
            return Err(error.into());
        }
        self.clock.advance_to(end);
        Ok(())
    }

    /// `fmi2GetStatus`: how the last step ended.
    pub fn status(&self, kind: c_int) -> Result<Status, Refusal> {
        match kind {
            DO_STEP_STATUS if self.phase == Phase::Failed => Ok(Status::Error),
            DO_STEP_STATUS => Ok(Status::Ok),
            _ => Err(no_such_status(kind)),
        }
    }

    /// `fmi2GetRealStatus`: end of the last successful step [s].
    pub fn real_status(&self, kind: c_int) -> Result<Real, Refusal> {
        match kind {
            LAST_SUCCESSFUL_TIME => Ok(self.clock.time()),
            _ => Err(no_such_status(kind)),
        }
    }

    /// `fmi2GetBooleanStatus`: a mechanism never asks for the end of the simulation.
    pub fn boolean_status(&self, kind: c_int) -> Result<Boolean, Refusal> {
        match kind {
            TERMINATED => Ok(FALSE),
            _ => Err(no_such_status(kind)),
        }
    }
}

/// Refusal of a status kind that the called function does not have.
pub fn no_such_status(kind: c_int) -> Refusal {
    match kind {
        DO_STEP_STATUS..=TERMINATED => {
            let name = ["fmi2DoStepStatus", "fmi2PendingStatus", "fmi2LastSuccessfulTime", "fmi2Terminated"];
            let hint = if kind == PENDING_STATUS { "; steps are never pending here" } else { "" };
            Refusal::discard(format!("no answer to {}{hint}", name[kind as usize]))
        }
        _ => Refusal::error(format!("the status kind is {kind}; it must be from 0 to 3")),
    }
}
