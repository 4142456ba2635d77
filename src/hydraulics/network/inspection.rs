//! Inspection of a network: what its numbers amount to, and which look wrong.
//!
//! In: the text of a definition. Out: facts and findings. It must not know laws: the outputs tell.
use super::definition::HydraulicSystem;
use super::facts::facts;
use super::model::Model;
use foundation::inspection::{Finding, Inspection};

/// Inspect the text of a definition.
pub fn inspect(text: &str) -> Inspection {
    let mut out = Inspection::default();
    let (system, faults) = match HydraulicSystem::with_faults(text) {
        Ok(read) => read,
        Err(faults) => {
            out.findings.extend(faults.into_iter().map(|fault| Finding::fault(fault.path(), &fault)));
            return out;
        }
    };
    (out.is_readable, out.name) = (true, system.name.clone());
    let is_sound = faults.are_of_unknown_keys();
    out.findings.extend(faults.into_iter().map(|fault| Finding::fault(fault.path(), &fault)));
    if !is_sound {
        return out;
    }
    let mut model = match Model::new(system.clone()) {
        Ok(model) => model,
        Err(error) => {
            out.findings.push(Finding::error("", &error));
            return out;
        }
    };
    out.findings.extend(model.warnings());
    out.facts = facts(&system, &mut |name| {
        let reference = model.variables().find(name);
        reference.and_then(|reference| model.real(reference).ok()).unwrap_or(f64::NAN)
    });
    out
}
