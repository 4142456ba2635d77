//! Steps with the hydraulic circuit of a drive, and what they refuse.
//!
//! In: an equation of motion, the state of the circuit, inputs. Out: the state after the step, or how the motion has left
//! what the circuit allows. It must not know outputs.
use crate::hydraulics::definition::ABOVE_VACUUM;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{DRIVEN, MOTION, Ports};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::resolved::PORTS;
use crate::mechanism::motion::advance::{Advance, Left, Progress, Stopped};
use crate::mechanism::motion::contact::{Contact, Ends, Travel};
use crate::mechanism::motion::saved::CircuitMemory;
use crate::mechanism::reduced::Reduced;
use crate::numerics::bits::same_bits;

/// Length beyond the ends of the cylinder's travel that rounding explains [m].
const SLACK: f64 = 1e-9;

/// A step of a motion with a circuit.
pub struct Driven<'a, 'e> {
    pub dynamics: &'a mut EquationOfMotion<'e>,
    pub memory: &'a mut CircuitMemory,
    pub ends: &'a Ends<'a>,
    pub contact: &'a mut Contact,
    pub tolerance: f64,
    pub inputs: &'a Inputs,
}

impl Driven<'_, '_> {
    /// Advance (sigma, sigma_dot) and the circuit by exactly `h` [s]. Returns the energy lost in impacts [J], and the
    /// state reached.
    pub fn run(self, [sigma, sigma_dot]: [f64; 2], h: f64, max_steps: u64) -> (Result<f64, Stopped>, [f64; DRIVEN]) {
        let Self { dynamics, memory, ends, contact, tolerance, inputs } = self;
        let CircuitMemory { integrator, lookahead, circuit, before, ports } = memory;
        *before = *circuit;
        let mut z = [0.0; DRIVEN];
        (z[0], z[1]) = (sigma, sigma_dot);
        z[MOTION..].copy_from_slice(&circuit.values);
        let reduced = dynamics.whole;
        let Some(drive) = &reduced.loading().hydraulics else { return (Ok(0.0), z) };
        let Ok(length) = reduced.displacement(drive.load) else { return (Err(Stopped::Circuit(Left::Length)), z) };
        if lookahead.begin(tolerance, ends.locked) {
            integrator.branch_off();
        }
        let now = &inputs.reals[drive.first_input..drive.first_input + PORTS];
        if !same_bits(ports, now) {
            ports.copy_from_slice(now);
            if lookahead.invalidate() {
                integrator.branch_off();
            }
            integrator.refresh();
        }
        dynamics.ports = Some(Ports::new(drive, length, inputs, circuit.time[0], h));
        let progress = Progress::within(integrator.attempts() + max_steps);
        let advance = Advance { dynamics: &mut *dynamics, integrator, lookahead, ends, contact, tolerance, progress };
        let mut advanced = advance.run(&mut z, h);
        lookahead.end();
        let reached = match &advanced {
            Err(Stopped::Budget(progress)) => progress.t,
            _ => h,
        };
        circuit.values.copy_from_slice(&z[MOTION..]);
        circuit.pass(reached);
        if matches!(advanced, Ok(_) | Err(Stopped::Budget(_)))
            && let Some(left) = left(dynamics, &z)
        {
            advanced = Err(Stopped::Circuit(left));
        }
        (advanced, z)
    }
}

/// How a state has left what the circuit allows.
fn left(dynamics: &EquationOfMotion<'_>, z: &[f64; DRIVEN]) -> Option<Left> {
    let drive = dynamics.reduced.loading().hydraulics.as_ref()?;
    let vacuum = -drive.laws.ambient();
    // At absolute zero a pressure has no rate, so that it may be no number after it.
    if let Some(chamber) = (0..2).find(|chamber| z[MOTION + chamber].is_nan() || z[MOTION + chamber] <= vacuum) {
        return Some(Left::Vacuum(chamber, z[MOTION + chamber]));
    }
    let (length, [least, most]) = (dynamics.actuator_length(z[0])?, drive.laws.lengths());
    (!(least - SLACK..=most + SLACK).contains(&length)).then_some(Left::Stroke(length))
}

/// The error for that.
#[cold]
pub fn left_circuit(reduced: &Reduced, left: Left) -> ModelError {
    let name =
        || reduced.loading().hydraulics.as_ref().map_or("", |d| &reduced.loading().drives[d.load].name).to_owned();
    match left {
        Left::Stroke(length) => stroke(reduced, length, "the end of the step"),
        Left::Vacuum(chamber, pressure) => {
            ModelError::Vacuum { chamber: ["chamber_a", "chamber_b"][chamber], pressure }
        }
        Left::Length => ModelError::Table { name: [name().as_str(), ".length"].concat(), position: "its start".into() },
    }
}

/// A place where the actuator has a length that the cylinder has not.
fn stroke(reduced: &Reduced, length: f64, what: &str) -> ModelError {
    let loading = reduced.loading();
    let (name, lengths) = match &loading.hydraulics {
        Some(drive) => (loading.drives[drive.load].name.as_str(), drive.laws.lengths()),
        None => ("", [0.0; 2]),
    };
    ModelError::Stroke { name: [name, ".length"].concat(), length, lengths, what: what.into() }
}

/// Refuse a start at which the actuator has a length that the cylinder has not, and a stop that it nowhere meets at a
/// length that the cylinder has.
///
/// # Errors
/// [`ModelError::Stroke`].
pub fn check_lengths(reduced: &Reduced, travel: &Travel, sigma: f64, revolutions: f64) -> Result<(), ModelError> {
    let loading = reduced.loading();
    let Some(drive) = &loading.hydraulics else { return Ok(()) };
    let [least, most] = drive.laws.lengths();
    let check = |sigma: f64, revolutions: f64, what: &str| {
        let length = reduced.displacement_at(drive.load, sigma) + revolutions * reduced.load_growth(drive.load);
        if (least - SLACK..=most + SLACK).contains(&length) { Ok(()) } else { Err(stroke(reduced, length, what)) }
    };
    check(sigma, revolutions, "the start")?;
    for (index, stop) in loading.stops.iter().enumerate() {
        let places = travel.places().filter(|(place, _)| travel.holds(*place, index));
        let met = places.map(|(_, position)| {
            let (sigma, revolutions) = reduced.unwound(position);
            check(sigma, revolutions, &stop.name)
        });
        met.reduce(Result::or).unwrap_or(Ok(()))?;
    }
    Ok(())
}

/// Refuse pressures of the ports at or below absolute zero.
///
/// # Errors
/// [`ModelError::Value`].
#[inline]
pub fn check_ports(reduced: &Reduced, inputs: &Inputs) -> Result<(), ModelError> {
    let Some(drive) = &reduced.loading().hydraulics else { return Ok(()) };
    for (name, input) in [("supply.pressure", drive.first_input + 1), ("tank.pressure", drive.first_input + 2)] {
        let value = inputs.reals[input];
        if value <= -drive.laws.ambient() {
            return Err(ModelError::Value { name: name.into(), value, allowed: ABOVE_VACUUM.into() });
        }
    }
    Ok(())
}
