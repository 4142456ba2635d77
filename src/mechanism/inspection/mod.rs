//! Inspection of a definition: what the mechanism is, and what is wrong with it.
//!
//! In: the text of a definition. Out: all its faults, or facts about the mechanism that it gives. It must not know
//! FMI's life cycle.
mod bends;
mod equilibrium;
mod facts;
mod friction;
mod path;
mod place;
mod poses;
mod scene;
mod slots;
mod travel;

pub use poses::{Attempt, Gap, Pose, Sweep, SweptStop, attempt};
pub use scene::{
    Connection, DrawnBody, DrawnJoint, DrawnLock, DrawnOutline, DrawnStop, NamedPoint, On, Scene, Surface, Weight,
};

use super::definition::Mechanism;
use super::model::Model;
use super::with_hydraulics::allow_hydraulics;
use crate::inspection::{Finding, Inspection};

/// Inspect the text of a definition.
pub fn inspect(text: &str) -> Inspection {
    allow_hydraulics();
    let mut out = Inspection::default();
    let (mechanism, faults) = match Mechanism::with_faults(text) {
        Ok(read) => read,
        Err(faults) => {
            out.findings.extend(faults.into_iter().map(|fault| Finding::fault(fault.path(), &fault)));
            return out;
        }
    };
    (out.is_readable, out.name) = (true, mechanism.name.clone());
    let is_sound = faults.are_of_unknown_keys();
    out.findings.extend(faults.into_iter().map(|fault| Finding::fault(fault.path(), &fault)));
    if !is_sound {
        out.findings.extend(mechanism.warnings());
        return out;
    }
    match Model::with_mechanism(mechanism.clone(), None) {
        Ok(mut model) => {
            out.findings.extend(model.warnings().iter().cloned());
            facts::collect(&mut model, &mut out);
            out.findings.extend(model.warnings_at_start());
        }
        Err(error) => {
            out.findings.push(Finding::error(path::of_error(&error, &mechanism), &error));
            out.findings.extend(mechanism.warnings());
            facts::collect_unassembled(&mechanism, &mut out);
        }
    }
    out
}
