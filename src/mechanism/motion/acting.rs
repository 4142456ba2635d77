//! Which of the loads that the state decides act: in moving air, or without.

use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::table::Unresolved;

/// Whether air of this speed [m/s] acts on the surfaces.
pub fn blows(reduced: &Reduced, speed: f64) -> bool {
    reduced.loading().air.as_ref().is_some_and(|air| air.relative_wind || speed != 0.0)
}

/// Airspeed under these inputs [m/s]; 0 without air.
#[inline]
pub fn airspeed(reduced: &Reduced, inputs: &Inputs) -> f64 {
    reduced.loading().air.as_ref().and(inputs.reals.last().copied()).unwrap_or(0.0)
}

/// The loads that the state decides, under these inputs.
///
/// # Errors
/// [`Unresolved`]: a reaction that causes friction is not smooth.
#[inline]
pub fn state_loads_under<'a>(reduced: &'a Reduced, inputs: &Inputs) -> Result<Option<&'a StateLoads>, &'a Unresolved> {
    reduced.state_loads(blows_under(reduced, inputs))
}

/// Whether air acts on the surfaces at any time of a step under these inputs.
pub fn blows_under(reduced: &Reduced, inputs: &Inputs) -> bool {
    let changes = || inputs.change(reduced).is_some_and(|change| change.airspeed != [0.0; 2]);
    blows(reduced, airspeed(reduced, inputs)) || (reduced.loading().air.is_some() && changes())
}

/// The loads that the state decides, in moving air or not, with an error located after so many revolutions.
#[inline]
pub fn state_loads(reduced: &Reduced, air: bool, revolutions: f64) -> Result<Option<&StateLoads>, ModelError> {
    reduced.state_loads(air).map_err(|at| ModelError::table(reduced, "friction", at, revolutions))
}
