//! The key of a definition to which an error of the model belongs.
use crate::mechanism::closure::AssemblyError;
use crate::mechanism::curve::CurveError;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::error::ModelError;
use crate::mechanism::reduced::ReductionError;

/// Path of the key to which an error belongs; empty for the whole file.
pub fn of_error(error: &ModelError, mechanism: &Mechanism) -> String {
    match error {
        ModelError::Definition(fault) | ModelError::Reduction(ReductionError::Definition(fault)) => fault.path().into(),
        ModelError::Reduction(error) => of_reduction(error, mechanism),
        ModelError::NoEquilibrium { .. } => "start".to_owned(),
        ModelError::BeyondStop { name, .. } => format!("stops.{name}"),
        ModelError::LockStill { name, .. } => format!("locks.{name}.at"),
        ModelError::TooManyBumpers { .. } => "stops".into(),
        ModelError::Stroke { name, .. } | ModelError::Prescribed { name, .. } => element(name, mechanism),
        ModelError::Locked { joint, .. } => format!("joints.{joint}"),
        ModelError::Table { name, .. } if name == "friction" => name.clone(),
        ModelError::Table { name, .. } => element(name, mechanism),
        _ => String::new(),
    }
}

fn of_reduction(error: &ReductionError, mechanism: &Mechanism) -> String {
    let quantity = |name: &str| name.rsplit_once(".start_").map_or("start".into(), |(_, key)| format!("start.{key}"));
    match error {
        ReductionError::Assembly(AssemblyError::Guess { name, .. }) if mechanism.guess.get(name).is_some() => {
            format!("guess.{name}")
        }
        ReductionError::Assembly(AssemblyError::Open { joint, .. } | AssemblyError::TooLong { joint, .. })
        | ReductionError::Curve(CurveError::Inconsistent { joint, .. }) => format!("joints.{joint}"),
        ReductionError::Assembly(AssemblyError::Freedom { .. }) => "joints".into(),
        ReductionError::Assembly(_) => "guess".into(),
        ReductionError::EndsMeet { name, .. } | ReductionError::Table { what: name, .. } => element(name, mechanism),
        ReductionError::Start { name, .. }
        | ReductionError::Rigid { name, .. }
        | ReductionError::StartSpeed { name, .. } => quantity(name),
        _ => String::new(),
    }
}

/// Path of the element that has a variable such as `cylinder.force`; empty if there is none.
fn element(variable: &str, mechanism: &Mechanism) -> String {
    let name = variable.split('.').next().unwrap_or_default();
    let groups = [
        ("actuators", mechanism.actuators.get(name).is_some()),
        ("springs", mechanism.springs.get(name).is_some()),
        ("stops", mechanism.stops.get(name).is_some()),
        ("forces", mechanism.forces.get(name).is_some()),
        ("torques", mechanism.torques.get(name).is_some()),
        ("surfaces", mechanism.surfaces.get(name).is_some()),
        ("bodies", mechanism.bodies.get(name).is_some()),
    ];
    groups.into_iter().find(|(_, has)| *has).map_or_else(String::new, |(group, _)| format!("{group}.{name}"))
}
