//! Permission to read or set a variable in each phase (FMI 2.0.5, 2.2.7).
//!
//! In: the instance, a value reference and the kind that the called function handles. Out: permission, or a refusal
//! that names the variable. Must not know: how a value is found.

use super::instance::Instance;
use super::phase::Phase;
use super::refusal::Refusal;
use crate::variables::{Causality, Kind, Reference, Variability, Variable};

/// Permission to read. Inputs and parameters can be read in every phase, outputs and local variables from
/// initialization mode on.
///
/// # Errors
/// An unknown reference, a variable of another kind, or an output or local variable before initialization mode.
#[inline]
pub fn may_get(instance: &Instance, reference: Reference, kind: Kind) -> Result<(), Refusal> {
    let early = instance.phase == Phase::Instantiated;
    match instance.component.interface().get(reference) {
        Some(v) if v.kind == kind && !(early && is_computed(v)) => Ok(()),
        _ => Err(no_get(instance, reference, kind)),
    }
}

/// Whether [`may_get`] permits to read each of these variables.
#[inline]
pub fn may_get_all(instance: &Instance, references: &[Reference], kind: Kind) -> bool {
    let (list, early) = (instance.component.interface().list(), instance.phase == Phase::Instantiated);
    let may = |reference: &Reference| {
        list.get(*reference as usize).is_some_and(|v| v.kind == kind && !(early && is_computed(v)))
    };
    references.iter().all(may)
}

/// Whether a variable has no value before initialization mode.
#[inline]
fn is_computed(variable: &Variable) -> bool {
    variable.is_output() || variable.causality == Causality::Local
}

/// Reason why a variable may not be read.
#[cold]
fn no_get(instance: &Instance, reference: Reference, kind: Kind) -> Refusal {
    match of_kind(instance, reference, kind) {
        Ok(variable) => Refusal::error(format!(
            "'{}' (value reference {reference}) is {}; the variable has no value before initialization mode",
            variable.name,
            if variable.causality == Causality::Local { "a local variable" } else { "an output" }
        )),
        Err(refusal) => refusal,
    }
}

/// How the value of a settable variable is applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// The component stores the value.
    Set,
    /// Tunable parameter: the new value changes the laws of a running simulation.
    Tuned,
}

/// Permission to set. Inputs can be set in every phase, except for discrete inputs in continuous-time mode. Parameters
/// can be set until initialization mode ends. Tunable parameters can also be set between steps and in event mode.
/// Outputs and local variables can never be set.
///
/// # Errors
/// An unknown reference, a variable of another kind, or a variable that the host may not set in this phase.
pub fn may_set(instance: &Instance, reference: Reference, kind: Kind) -> Result<Way, Refusal> {
    let variable = of_kind(instance, reference, kind)?;
    let reason = match (variable.causality, instance.phase) {
        (Causality::Input, Phase::Continuous) if variable.variability == Variability::Discrete => {
            "a discrete input; in model exchange, set a discrete input in event mode"
        }
        (Causality::Input, _) => return Ok(Way::Set),
        (Causality::Parameter, Phase::Instantiated | Phase::Initialization) => return Ok(Way::Set),
        (Causality::Parameter, Phase::Step | Phase::Event) if variable.variability == Variability::Tunable => {
            return Ok(Way::Tuned);
        }
        (Causality::Parameter, Phase::Continuous) if variable.variability == Variability::Tunable => {
            "a tunable parameter; in model exchange, set a tunable parameter in event mode"
        }
        (Causality::Parameter, _) => {
            "a fixed parameter; set a fixed parameter before initialization mode ends, or after a reset"
        }
        // The component returns the error, which names the parameters that determine the value.
        (Causality::CalculatedParameter, Phase::Instantiated | Phase::Initialization) => return Ok(Way::Set),
        (Causality::CalculatedParameter, _) => "a calculated parameter, which cannot be set",
        (Causality::Output, _) => "an output, which cannot be set",
        (Causality::Local, _) => "a local variable, which cannot be set",
    };
    Err(Refusal::error(format!("'{}' (value reference {reference}) is {reason}", variable.name)))
}

/// The variable with this reference, if the variable is of this kind.
///
/// # Errors
/// An unknown reference, or a variable of another kind.
pub fn of_kind(instance: &Instance, reference: Reference, kind: Kind) -> Result<&Variable, Refusal> {
    match instance.component.interface().get(reference) {
        Some(variable) if variable.kind == kind => Ok(variable),
        _ => Err(not_of_type(instance, reference, instance.version.type_of(kind), &range(instance, kind))),
    }
}

/// Rejects the first reference of a call for a type that no variable has. An empty list is accepted. `type_name` is the
/// type's name in the version of FMI.
pub fn none_of_type(instance: &Instance, references: &[Reference], type_name: &str) -> Result<(), Refusal> {
    let refusal = |&reference: &Reference| not_of_type(instance, reference, type_name, NONE);
    references.first().map_or(Ok(()), |reference| Err(refusal(reference)))
}

/// Text for the value references of a type that no variable has.
const NONE: &str = "there are none";

/// The refusal of a reference whose variable is not of this type. `range` lists the references of the type.
#[cold]
fn not_of_type(instance: &Instance, reference: Reference, type_name: &str, range: &str) -> Refusal {
    let what = match instance.described(reference) {
        Some((name, kind)) => {
            let own = instance.version.type_of(kind);
            format!("'{name}' (value reference {reference}) is a {own}, not a {type_name}")
        }
        None => format!("value reference {reference} does not exist"),
    };
    Refusal::error(format!("{what}; value references of {type_name} variables: {range}"))
}

/// Value references of the variables of a kind, for messages.
fn range(instance: &Instance, kind: Kind) -> String {
    let is_of_kind = |variable: &Variable| variable.kind == kind;
    let list = instance.component.interface().list();
    let further = if kind == Kind::Real && instance.version.has_vectors() {
        format!(", {} to {}", list.len(), list.len() + instance.vectors.len())
    } else {
        String::new()
    };
    match (list.iter().position(is_of_kind), list.iter().rposition(is_of_kind)) {
        (Some(first), Some(last)) if first < last => format!("{first} to {last}{further}"),
        (Some(only), _) => format!("{only}{further}"),
        (None, _) => NONE.to_owned(),
    }
}
