//! Steps with the hydraulic circuit of a drive, and what they refuse.
//!
//! In: an equation of motion, the state of the circuit, inputs. Out: the state after the step, or what keeps the motion
//! from going on. It must not know outputs.
use super::State;
use crate::hydraulics::circuit::SUPPLY;
use crate::hydraulics::definition::{ABOVE_VACUUM, is_pressure};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{DRIVEN, MOTION, Ports};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::resolved::PORTS;
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::contact::{Contact, Ends};
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
        let CircuitMemory { integrator, lookahead, circuit, before, ports, kept } = memory;
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
        let mut of_step = Ports::new(drive, length, inputs, circuit.time.now, h);
        of_step.kept = kept.take();
        dynamics.ports = Some(of_step);
        let progress = Progress::within(integrator.attempts() + max_steps);
        let dynamics = &mut *dynamics;
        let advance = Advance { dynamics, integrator, lookahead, ends, contact, witness, tolerance, progress };
        let mut advanced = advance.run(&mut z, h);
        lookahead.end();
        *kept = dynamics.ports.as_mut().and_then(|ports| ports.kept.take());
        let reached = match &advanced {
            Err(Stopped::Budget(progress) | Stopped::Event(progress) | Stopped::Pause(progress)) => progress.t,
            _ => h,
        };
        circuit.values.copy_from_slice(&z[MOTION..]);
        circuit.time.pass(reached);
        if let Err(Stopped::Integration(error)) = advanced {
            advanced = Err(dynamics
                .at_vacuum(&z)
                .map_or_else(|| Stopped::Stuck(error, dynamics.describe_circuit(&z)), Stopped::Vacuum));
        }
        (advanced, z)
    }
}

/// The error of a motion in which a chamber, A or B, of oil without air has come to absolute zero.
#[cold]
pub fn at_vacuum(chamber: usize) -> ModelError {
    ModelError::Vacuum { chamber: ["chamber_a", "chamber_b"][chamber] }
}

/// The error of a length of the actuator that is not smooth along the motion.
#[cold]
pub fn rough_length(reduced: &Reduced) -> ModelError {
    let loading = reduced.loading();
    let name = loading.hydraulics.as_ref().map_or("", |drive| &loading.drives[drive.load].name);
    ModelError::Table { name: [name, ".length"].concat(), position: "its start".into() }
}

/// Refuse a start at which the actuator has a length that the cylinder has not.
///
/// # Errors
/// [`ModelError::Stroke`].
pub fn check_length(reduced: &Reduced, sigma: f64, revolutions: f64) -> Result<(), ModelError> {
    let loading = reduced.loading();
    let Some(drive) = &loading.hydraulics else { return Ok(()) };
    let length = reduced.displacement_at(drive.load, sigma) + revolutions * reduced.load_growth(drive.load);
    if drive.laws.has_length(length) {
        return Ok(());
    }
    let name = [&loading.drives[drive.load].name, ".length"].concat();
    Err(ModelError::Stroke { name, length, lengths: drive.laws.lengths() })
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
