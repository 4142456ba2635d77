//! Steps with the hydraulic circuit of a drive, and what they refuse.
//!
//! In: an equation of motion, the state of the circuit, inputs. Out: the state after the step, or what of the circuit
//! the motion has come to the end of. It must not know outputs.
use super::State;
use crate::hydraulics::circuit::{Left, SUPPLY};
use crate::hydraulics::definition::{ABOVE_VACUUM, is_pressure};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{DRIVEN, MOTION, Ports};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::resolved::PORTS;
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::contact::{Contact, Ends, Travel};
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::memory::{CircuitMemory, Memory};
use crate::mechanism::motion::witness::Witness;
use crate::mechanism::reduced::Reduced;
use crate::numerics::bits::same_bits;

/// A step of a motion with a circuit.
pub struct Driven<'a, 'e> {
    pub dynamics: &'a mut EquationOfMotion<'e>,
    pub memory: &'a mut CircuitMemory,
    pub ends: &'a Ends<'a>,
    pub contact: &'a mut Contact,
    pub witness: &'a mut Witness,
    pub tolerance: f64,
    pub inputs: &'a Inputs,
}

impl Driven<'_, '_> {
    /// Advance (sigma, sigma_dot) and the circuit by exactly `h` [s]. Returns the energy lost in impacts [J], and the
    /// state reached.
    pub fn run(self, [sigma, sigma_dot]: [f64; 2], h: f64, max_steps: u64) -> (Result<f64, Stopped>, [f64; DRIVEN]) {
        let Self { dynamics, memory, ends, contact, witness, tolerance, inputs } = self;
        let CircuitMemory { integrator, lookahead, circuit, before, ports } = memory;
        *before = *circuit;
        let mut z = [0.0; DRIVEN];
        (z[0], z[1]) = (sigma, sigma_dot);
        z[MOTION..].copy_from_slice(&circuit.values);
        let reduced = dynamics.whole;
        let Some(drive) = &reduced.loading().hydraulics else { return (Ok(0.0), z) };
        let Ok(length) = reduced.displacement(drive.load) else { return (Err(Stopped::Length), z) };
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
        dynamics.ports = Some(Ports::new(drive, length, inputs, circuit.time.now, h));
        let progress = Progress::within(integrator.attempts() + max_steps);
        let dynamics = &mut *dynamics;
        let advance = Advance { dynamics, integrator, lookahead, ends, contact, witness, tolerance, progress };
        let mut advanced = advance.run(&mut z, h);
        lookahead.end();
        let reached = match &advanced {
            Err(Stopped::Budget(progress) | Stopped::Event(progress) | Stopped::Pause(progress)) => progress.t,
            _ => h,
        };
        circuit.values.copy_from_slice(&z[MOTION..]);
        circuit.time.pass(reached);
        if let Err(Stopped::Integration(error)) = advanced {
            advanced = Err(dynamics
                .left(&z)
                .map_or_else(|| Stopped::Stuck(error, dynamics.describe_circuit(&z)), Stopped::Circuit));
        }
        (advanced, z)
    }
}

/// The error of a motion that has come to where the circuit ends.
#[cold]
pub fn left_circuit(reduced: &Reduced, left: Left) -> ModelError {
    match left {
        Left::Stroke(length) => stroke(reduced, length, "the end of the step"),
        Left::Vacuum(chamber) => ModelError::Vacuum { chamber: ["chamber_a", "chamber_b"][chamber] },
    }
}

/// The error of a length of the actuator that is not smooth along the motion.
#[cold]
pub fn rough_length(reduced: &Reduced) -> ModelError {
    let loading = reduced.loading();
    let name = loading.hydraulics.as_ref().map_or("", |drive| &loading.drives[drive.load].name);
    ModelError::Table { name: [name, ".length"].concat(), position: "its start".into() }
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
    let check = |sigma: f64, revolutions: f64, what: &str| {
        let length = reduced.displacement_at(drive.load, sigma) + revolutions * reduced.load_growth(drive.load);
        if drive.laws.has_length(length) { Ok(()) } else { Err(stroke(reduced, length, what)) }
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

impl State {
    /// The input with this index has this value: before the first step `supply.pressure` is the start of an
    /// accumulator.
    pub fn fill_accumulator(&mut self, reduced: &Reduced, input: usize, value: f64) {
        let Some(drive) = reduced.loading().hydraulics.as_ref().filter(|drive| drive.laws.supply_unit().is_some())
        else {
            return;
        };
        if let (true, Memory::WithCircuit(memory)) = (input == drive.first_input + 1, &mut self.saved.memory)
            && memory.circuit.time == Elapsed::default()
        {
            memory.circuit.values[SUPPLY] = value;
        }
    }
}

/// Refuse pressures of the ports at or below absolute zero, or beyond what a port may have, at the beginning or at the
/// end of a step of `h` [s].
///
/// # Errors
/// [`ModelError::Value`].
#[inline]
pub fn check_ports(reduced: &Reduced, inputs: &Inputs, h: f64) -> Result<(), ModelError> {
    let Some(drive) = &reduced.loading().hydraulics else { return Ok(()) };
    for (name, input) in [("supply.pressure", drive.first_input + 1), ("tank.pressure", drive.first_input + 2)] {
        let (value, end) = (inputs.reals[input], inputs.signal.at(input, inputs.reals[input], h));
        for (value, place) in [(value, ""), (end, " at the end of the step")] {
            if !is_pressure(value, drive.laws.ambient()) {
                let name = [name, place].concat();
                return Err(ModelError::Value { name, value, allowed: ABOVE_VACUUM.into() });
            }
        }
    }
    Ok(())
}
