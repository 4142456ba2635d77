//! Refusals, by name, value and remedy, of the parameters and inputs that the finite elements do not have.
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::state::State;
use crate::mechanism::reduced::Reduced;

/// Rounding of a stop's quantity, relative to 1 and its value [rad or m].
const AT: f64 = 1e-10;

/// Refuse friction that is enabled, and air with drag. The mesh refuses losses in drives.
///
/// # Errors
/// [`ModelError::NotInRigidFem`].
pub fn refuse_losses(reduced: &Reduced, inputs: &Inputs) -> Result<(), ModelError> {
    let refuse = |name: &str, value: String, remedy: &str| {
        Err(ModelError::NotInRigidFem { name: name.into(), value, remedy: remedy.into() })
    };
    let loading = reduced.loading();
    if loading.friction.as_ref().is_some_and(|f| f.enabled && !f.friction_joints.is_empty()) {
        return refuse("friction.enabled", "true".into(), "set it to false");
    }
    if let Some(air) = loading.air.as_ref().filter(|air| !air.surfaces.is_empty()) {
        if air.relative_wind {
            return refuse("air.relative_wind", "true".into(), "set it to false");
        }
        if let Some(speed) = inputs.reals.last().filter(|speed| **speed != 0.0) {
            return refuse("airspeed", format!("{speed}"), "set it to 0");
        }
    }
    Ok(())
}

/// Refuse a lock that is engaged at its stop.
///
/// # Errors
/// [`ModelError::NotInRigidFem`].
pub fn refuse_locks(reduced: &Reduced, inputs: &Inputs, rigid: &State) -> Result<(), ModelError> {
    let mut locks = reduced.loading().locks.iter().zip(&inputs.locks);
    match locks.find(|(lock, engaged)| **engaged && rigid.at_stop(reduced, lock.stop)) {
        Some((lock, _)) => Err(ModelError::NotInRigidFem {
            name: format!("{}.engage", lock.name),
            value: "true".into(),
            remedy: "set it to false before the mechanism is at its stop".into(),
        }),
        None => Ok(()),
    }
}

/// Refuse a state beyond a stop, `time` [s] into the step and `substep` [s] after the last one. `displacement` gives S
/// of a load, or S_dot for the order 1.
///
/// # Errors
/// [`ModelError::StopPassed`].
pub fn refuse_passing(
    reduced: &Reduced,
    slack: &[f64],
    time: f64,
    substep: f64,
    displacement: &dyn Fn(usize, usize) -> f64,
) -> Result<(), ModelError> {
    for (stop, slack) in reduced.loading().stops.iter().zip(slack).filter(|(stop, _)| stop.enabled) {
        let [s, s_dot] = [0, 1].map(|order| displacement(stop.load, order));
        let beyond = stop.beyond(s) - slack;
        let outward = s_dot * (stop.beyond(1.0) - stop.beyond(0.0));
        if beyond > AT * (1.0 + stop.value.abs()) && outward > 0.0 {
            let name = format!("{}.{}", stop.name, stop.quantity);
            let time = time - (beyond / outward).min(substep);
            return Err(ModelError::StopPassed { name, value: stop.value, time });
        }
    }
    Ok(())
}
