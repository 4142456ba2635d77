//! Which variable may be read or set when (FMI 2.0.5, 4.2.4, with the causalities of 2.2.7).
//!
//! In: the table of variables, the phase, a value reference and the type that the called function handles. Out: leave,
//! or a refusal that names the variable.

use super::phase::Phase;
use super::refusal::Refusal;
use crate::variables::{Causality, Kind, Reference, Variable, Variables};

/// Leave to read: inputs and parameters always, outputs from initialization mode on.
///
/// # Errors
/// An unknown reference, another type, or an output before initialization mode.
#[inline]
pub fn may_get<Q: Copy>(
    variables: &Variables<Q>,
    phase: Phase,
    reference: Reference,
    kind: Kind,
) -> Result<(), Refusal> {
    let early = phase == Phase::Instantiated;
    match variables.get(reference) {
        Some(v) if v.kind == kind && !(early && v.causality == Causality::Output) => Ok(()),
        _ => Err(no_get(variables, reference, kind)),
    }
}

/// Why a variable may not be read.
#[cold]
fn no_get<Q: Copy>(variables: &Variables<Q>, reference: Reference, kind: Kind) -> Refusal {
    match of_kind(variables, reference, kind) {
        Ok(variable) => Refusal::error(format!(
            "'{}' (value reference {reference}) is an output; it has a value from fmi2EnterInitializationMode on",
            variable.name
        )),
        Err(refusal) => refusal,
    }
}

/// Leave to set: inputs always, parameters before `fmi2ExitInitializationMode`, outputs never.
///
/// # Errors
/// An unknown reference, another type, or a variable that is not the host's to set now.
pub fn may_set<Q: Copy>(
    variables: &Variables<Q>,
    phase: Phase,
    reference: Reference,
    kind: Kind,
) -> Result<(), Refusal> {
    let variable = of_kind(variables, reference, kind)?;
    let reason = match (variable.causality, phase) {
        (Causality::Input, _) => return Ok(()),
        (Causality::Parameter, Phase::Instantiated | Phase::Initialization) => return Ok(()),
        (Causality::Parameter, _) => "a parameter; it can be set before fmi2ExitInitializationMode, or after fmi2Reset",
        (Causality::Output, _) => "an output; it cannot be set",
    };
    Err(Refusal::error(format!("'{}' (value reference {reference}) is {reason}", variable.name)))
}

fn of_kind<Q: Copy>(variables: &Variables<Q>, reference: Reference, kind: Kind) -> Result<&Variable, Refusal> {
    match variables.get(reference) {
        Some(variable) if variable.kind == kind => Ok(variable),
        Some(variable) => Err(Refusal::error(format!(
            "'{}' (value reference {reference}) is a {:?}, not a {kind:?}; value references of {kind:?} variables: {}",
            variable.name,
            variable.kind,
            range(variables, kind)
        ))),
        None => Err(Refusal::error(format!(
            "value reference {reference} does not exist; value references of {kind:?} variables: {}",
            range(variables, kind)
        ))),
    }
}

fn range<Q: Copy>(variables: &Variables<Q>, kind: Kind) -> String {
    let is_of_kind = |variable: &Variable| variable.kind == kind;
    let list = variables.list();
    match (list.iter().position(is_of_kind), list.iter().rposition(is_of_kind)) {
        (Some(first), Some(last)) if first < last => format!("{first} to {last}"),
        (Some(only), _) => format!("{only}"),
        (None, _) => "there are none".to_owned(),
    }
}
