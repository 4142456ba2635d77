//! Allowed results of a random call of a C function, and the calls of a host within a step.
use super::probe::Probe;
use super::random::Random;
use crate::host::{DISCARD, ERROR, Model, OK, WARNING};
use linkage_fmu::fmi2::host::Message;
use linkage_fmu::fmi3::host::{Calls, Update};
use linkage_fmu::variables::Kind;
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// Allowed results of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum May {
    /// OK, or a warning with a message.
    Succeed,
    /// An error.
    BeRefused,
    /// Success, an error, or fmi2Discard, depending on the values.
    Either,
}

impl May {
    /// Whether status and messages of a call are an allowed result; counts the errors.
    pub fn allows(self, status: i32, log: &[Message], probe: &mut Probe) -> bool {
        match (self, status) {
            (May::Succeed | May::Either, OK) => true,
            (May::Succeed | May::Either, WARNING) => !log.is_empty(),
            (May::BeRefused | May::Either, ERROR) | (May::Either, DISCARD) => {
                probe.count("calls refused");
                log.iter().filter(|message| message.status >= DISCARD).count() == 1
            }
            _ => false,
        }
    }

    /// This result if a condition holds; else an error.
    pub fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::BeRefused }
    }
}

/// A number that hosts seldom pass.
pub fn odd(random: &mut Random) -> f64 {
    random.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, 0.0, 1e300, -1e300, 5e-324])
}

/// A value different from this one.
pub fn changed(value: f64, random: &mut Random) -> f64 {
    match random.below(12) {
        0 => odd(random),
        1 => random.within(-1.0, 1.0),
        _ => value * random.decades(0.5, 2.0),
    }
}

/// Where undefined values and other faults in a callback are noted.
pub type Fault = Rc<RefCell<Option<String>>>;

/// The fault if values are undefined without a warning.
pub fn silent(status: i32, values: &[f64]) -> Option<String> {
    let is_silent = status == OK && values.iter().any(|value| !value.is_finite());
    is_silent.then(|| format!("values that do not exist without a warning: {values:?}"))
}

/// Number of value references: scalars, and in FMI 3.0 time and vectors.
pub fn count(model: &Model) -> usize {
    model.description.interface().list().len() + 1 + model.vectors
}

/// Number of values of a Float64 variable; None for other types.
pub fn size(model: &Model, reference: u32) -> Option<usize> {
    let list = model.description.interface().list();
    match list.get(reference as usize) {
        Some(variable) => (variable.kind == Kind::Real).then_some(1),
        None if reference as usize == list.len() => Some(1),
        None => ((reference as usize) < count(model)).then_some(2),
    }
}

/// The calls of a host in an intermediate update: it sometimes reads a variable, makes calls that are illegal there,
/// and sometimes requests the end of the step.
pub fn update(model: &'static Model, random: Random, fault: Fault) -> Box<Update> {
    let (random, updates) = (RefCell::new(random), Cell::new(0_usize));
    Box::new(move |calls: &Calls, time| {
        let mut random = random.borrow_mut();
        updates.set(updates.get() + 1);
        if updates.get() % 8 != 1 {
            return None;
        }
        let reference = random.below(count(model)) as u32;
        calls.log.take();
        if let Some(size) = size(model, reference) {
            let mut values = vec![0.0; size];
            let status = calls.reals(&[reference], &mut values) as i32;
            let refused = (status > WARNING).then(|| format!("update: status {status}"));
            if let Some(wrong) = silent(status, &values).or(refused) {
                fault.replace(Some(wrong));
            }
        }
        calls.log.take();
        let refused = [calls.set_reals(&[0], &[1.0]), calls.step(time, 1e-3).0, calls.reset()].map(|s| s as i32);
        if refused != [ERROR; 3] || calls.log.take().len() != 3 {
            fault.replace(Some(format!("calls within an update: {refused:?}")));
        }
        random.chance(0.1).then(|| time + random.pick(&[0.0, 1e-4, -1.0, f64::NAN, f64::INFINITY]))
    })
}
