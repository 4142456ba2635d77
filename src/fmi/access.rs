//! Which variable may be read or set in which phase (FMI 2.0.5, 4.2.4, with the causalities of 2.2.7).
//!
//! In: the table of variables, the phase, a value reference and the kind that the called function handles. Out:
//! permission, or a refusal that names the variable. It must not know how a value is found.

use super::phase::Phase;
use super::refusal::Refusal;
use crate::variables::{Causality, Interface, Kind, Reference, Variable};

/// Permission to read: inputs and parameters always, outputs from initialization mode on.
///
/// # Errors
/// An unknown reference, another type, or an output before initialization mode.
#[inline]
pub fn may_get(interface: &Interface, phase: Phase, reference: Reference, kind: Kind) -> Result<(), Refusal> {
    let early = phase == Phase::Instantiated;
    match interface.get(reference) {
        Some(v) if v.kind == kind && !(early && v.causality == Causality::Output) => Ok(()),
        _ => Err(no_get(interface, reference, kind)),
    }
}

/// Reason why a variable may not be read.
#[cold]
fn no_get(interface: &Interface, reference: Reference, kind: Kind) -> Refusal {
    match of_kind(interface, reference, kind) {
        Ok(variable) => Refusal::error(format!(
            "'{}' (value reference {reference}) is an output; it has a value from initialization mode on",
            variable.name
        )),
        Err(refusal) => refusal,
    }
}

/// Permission to set: inputs always, parameters until initialization mode ends, outputs never.
///
/// # Errors
/// An unknown reference, another type, or a variable that is not the host's to set now.
pub fn may_set(interface: &Interface, phase: Phase, reference: Reference, kind: Kind) -> Result<(), Refusal> {
    let variable = of_kind(interface, reference, kind)?;
    let reason = match (variable.causality, phase) {
        (Causality::Input, _) => return Ok(()),
        (Causality::Parameter, Phase::Instantiated | Phase::Initialization) => return Ok(()),
        (Causality::Parameter, _) => "a parameter; it can be set until initialization mode ends, or after a reset",
        (Causality::Output, _) => "an output; it cannot be set",
    };
    Err(Refusal::error(format!("'{}' (value reference {reference}) is {reason}", variable.name)))
}

/// The variable with this reference, if it is of this kind.
fn of_kind(interface: &Interface, reference: Reference, kind: Kind) -> Result<&Variable, Refusal> {
    let word = kind.word();
    match interface.get(reference) {
        Some(variable) if variable.kind == kind => Ok(variable),
        Some(variable) => Err(Refusal::error(format!(
            "'{}' (value reference {reference}) is a {}, not a {word}; value references of {word} variables: {}",
            variable.name,
            variable.kind.word(),
            range(interface, kind)
        ))),
        None => Err(Refusal::error(format!(
            "value reference {reference} does not exist; value references of {word} variables: {}",
            range(interface, kind)
        ))),
    }
}

/// Value references of the variables of a kind, for messages.
fn range(interface: &Interface, kind: Kind) -> String {
    let is_of_kind = |variable: &Variable| variable.kind == kind;
    let list = interface.list();
    match (list.iter().position(is_of_kind), list.iter().rposition(is_of_kind)) {
        (Some(first), Some(last)) if first < last => format!("{first} to {last}"),
        (Some(only), _) => format!("{only}"),
        (None, _) => "there are none".to_owned(),
    }
}
