//! Ranges of the inputs of a circuit or network.
//!
//! In: inputs, a step. Out: the refusal of a value out of range. It must not know the state.
use crate::hydraulics::definition::{ABOVE_VACUUM, is_pressure};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::reduced::Reduced;

/// Refuse inputs of the circuit or network out of range, such as pressures of ports at or below absolute zero, at the
/// beginning or at the end of a step of `h` [s].
///
/// # Errors
/// [`ModelError::Value`].
#[inline]
pub fn check_ports(reduced: &Reduced, inputs: &Inputs, h: f64) -> Result<(), ModelError> {
    let loading = reduced.loading();
    if let Some(drive) = &loading.hydraulics {
        for (name, input) in [("supply.pressure", drive.first_input + 1), ("tank.pressure", drive.first_input + 2)] {
            let is_allowed = |value| is_pressure(value, drive.laws.ambient());
            check_port(
                inputs,
                input,
                h,
                name,
                |value| if is_allowed(value) { None } else { Some(ABOVE_VACUUM.into()) },
            )?;
        }
    }
    let Some(network) = &loading.network else { return Ok(()) };
    for index in 0..network.laws.layout.flow_inputs() {
        let (input, name) = (network.first_input + index, &network.inputs[index]);
        check_port(inputs, input, h, name, |value| network.laws.refuses(index, value))?;
    }
    Ok(())
}

/// Refuse a value of an input at the beginning or at the end of a step of `h` [s] for which `refuses` states what is
/// allowed.
#[inline]
fn check_port(
    inputs: &Inputs,
    input: usize,
    h: f64,
    name: &str,
    refuses: impl Fn(f64) -> Option<String>,
) -> Result<(), ModelError> {
    let value = inputs.reals[input];
    for (value, place) in [(value, ""), (inputs.signal.at(input, value, h), " at the end of the step")] {
        if let Some(allowed) = refuses(value) {
            return Err(ModelError::Value { name: [name, place].concat(), value, allowed });
        }
    }
    Ok(())
}
