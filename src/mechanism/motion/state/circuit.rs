//! Steps with the hydraulic circuit of a drive or the network of the mechanism, and what they refuse.
//!
//! In: an equation of motion, the state of the circuit or network, inputs. Out: the state after the step, or what keeps
//! the motion from going on. It must not know outputs.
use super::inputs::engaged_locks;
use super::{State, set_locks};
use crate::hydraulics::circuit::SUPPLY;
use crate::hydraulics::definition::{ABOVE_VACUUM, is_pressure};
use crate::hydraulics::network::definition::HydraulicSystem;
use crate::hydraulics::network::laws::Laws;
use crate::integrator::{IntegrationError, System};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{DRIVEN, MOTION, Ports};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::network::{CAPACITY, NETWORKED, NetworkPorts, engage_locks, switch_locks};
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::contact::{Contact, Ends, EngagedLocks};
use crate::mechanism::motion::dynamics::Dynamics;
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::memory::{CircuitState, HydraulicMemory, Memory};
use crate::mechanism::motion::witness::{What, Witness};
use crate::mechanism::reduced::Reduced;
use crate::numerics::bits::same_bits;

/// A step of a motion with a circuit or network of C components.
pub struct Driven<'a, 'e, const N: usize, const C: usize> {
    pub dynamics: &'a mut EquationOfMotion<'e>,
    pub memory: &'a mut HydraulicMemory<N, C>,
    pub ends: &'a Ends<'a>,
    pub contact: &'a mut Contact,
    pub witness: &'a mut Witness,
    pub tolerance: f64,
    pub inputs: &'e Inputs,
}

/// A motion with the hydraulics that drive it.
pub trait Hydraulics<'e, const N: usize>: Dynamics<N> {
    /// Begin a step of `h` [s], `time` [s] after the start, with the Jacobian that implicit steps keep. None if a
    /// length is not smooth along the motion.
    fn begin(&mut self, inputs: &'e Inputs, time: f64, h: f64) -> Option<()>;

    /// Release and engage the locks that the pressures in the state z operate and that are due. Calls `changed` with
    /// each of them, by its index, and with whether it is engaged.
    fn switch_locks(&self, _z: &mut [f64; N], _changed: &mut impl FnMut(usize, bool)) {}

    /// Why the integration came no further from the state z.
    fn why_stuck(&self, error: IntegrationError, z: &[f64; N]) -> Stopped;
}

impl<'e> Hydraulics<'e, DRIVEN> for EquationOfMotion<'e> {
    fn begin(&mut self, inputs: &'e Inputs, time: f64, h: f64) -> Option<()> {
        let drive = self.whole.loading().hydraulics.as_ref()?;
        let length = self.whole.displacement(drive.load).ok()?;
        self.ports = Some(Ports::new(drive, length, inputs, time, h));
        Some(())
    }

    fn why_stuck(&self, error: IntegrationError, z: &[f64; DRIVEN]) -> Stopped {
        self.at_vacuum(z).map_or_else(|| Stopped::Stuck(error, self.describe_circuit(z)), Stopped::Vacuum)
    }
}

impl<'e> Hydraulics<'e, NETWORKED> for EquationOfMotion<'e> {
    fn begin(&mut self, inputs: &'e Inputs, _time: f64, h: f64) -> Option<()> {
        let drives = self.whole.loading().network.as_ref()?;
        self.network = Some(NetworkPorts::new(drives, self.whole, inputs, h)?);
        Some(())
    }

    fn switch_locks(&self, z: &mut [f64; NETWORKED], changed: &mut impl FnMut(usize, bool)) {
        if let Some(drives) = &self.whole.loading().network {
            switch_locks(&drives.laws, &mut z[MOTION..], changed);
        }
    }

    fn why_stuck(&self, error: IntegrationError, z: &[f64; NETWORKED]) -> Stopped {
        Stopped::Stuck(error, self.describe_network(z))
    }
}

impl<'e, const N: usize, const C: usize> Driven<'_, 'e, N, C>
where
    EquationOfMotion<'e>: Hydraulics<'e, N> + System<N>,
{
    /// Advance (sigma, sigma_dot) and the circuit or network by exactly `h` [s]. Returns the energy lost in impacts
    /// [J]; sigma, sigma_dot and the energy lost in the state reached; the places where a lock is engaged there.
    pub fn run(
        self,
        [sigma, sigma_dot]: [f64; 2],
        h: f64,
        max_steps: u64,
    ) -> (Result<f64, Stopped>, [f64; MOTION], EngagedLocks) {
        let Self { dynamics, memory, ends, contact, witness, tolerance, inputs } = self;
        let HydraulicMemory { integrator, lookahead, circuit, before, ports } = memory;
        *before = *circuit;
        let mut z = [0.0; N];
        (z[0], z[1]) = (sigma, sigma_dot);
        z[MOTION..].copy_from_slice(&circuit.values);
        let start = [sigma, sigma_dot, 0.0];
        let Some(first) = dynamics.whole.loading().first_port() else { return (Ok(0.0), start, ends.locked) };
        let now = &inputs.reals[first..first + ports.len()];
        if !same_bits(ports, now) {
            ports.copy_from_slice(now);
            if lookahead.invalidate() {
                integrator.branch_off();
            }
            integrator.refresh();
        }
        if dynamics.begin(inputs, circuit.time.now, h).is_none() {
            return (Err(Stopped::Length), start, ends.locked);
        }
        let mut progress = Progress::within(integrator.attempts() + max_steps);
        let mut ends = *ends;
        let mut advanced = loop {
            let mut is_changed = false;
            dynamics.switch_locks(&mut z, &mut |lock, engaged| {
                witness.tell(progress.t, What::Switched { lock, engaged });
                is_changed = true;
            });
            if is_changed {
                ends.locked = engaged_locks(ends.travel, dynamics.whole, &inputs.locks, Some(&z[MOTION..]));
                set_locks(contact, &ends, progress.t, witness);
            }
            if lookahead.begin(tolerance, ends.locked) {
                integrator.branch_off();
            }
            let (dynamics, integrator, lookahead) = (&mut *dynamics, &mut *integrator, &mut *lookahead);
            let (ends, contact, witness) = (&ends, &mut *contact, &mut *witness);
            let pauses = witness.pauses.at_events;
            let advance = Advance { dynamics, integrator, lookahead, ends, contact, witness, tolerance, progress };
            match advance.run(&mut z, h) {
                // A lock is to change.
                Err(Stopped::Event(reached)) if !(pauses && reached.t > 0.0) => progress = reached,
                advanced => break advanced,
            }
        };
        lookahead.end();
        let reached = match &advanced {
            Err(Stopped::Budget(progress) | Stopped::Event(progress) | Stopped::Pause(progress)) => progress.t,
            _ => h,
        };
        circuit.values.copy_from_slice(&z[MOTION..]);
        circuit.time.pass(reached);
        if let Err(Stopped::Integration(error)) = advanced {
            advanced = Err(dynamics.why_stuck(error, &z));
        }
        (advanced, [z[0], z[1], z[2]], ends.locked)
    }
}

/// The state of a network at its start, at these lengths of the cylinders [m].
pub fn network_at_start(system: &HydraulicSystem, laws: &Laws, lengths: &[f64]) -> CircuitState<CAPACITY> {
    let mut state = CircuitState::default();
    laws.fill_start(system, &mut state.values);
    state.values[laws.layout.components()] = laws.volume_at(|cylinder| lengths[cylinder]);
    engage_locks(laws, &mut state.values);
    state
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
    let is_rough = |load: &&usize| reduced.displacement(**load).is_err();
    let name = loading.hydraulic_loads().iter().find(is_rough).map_or("", |load| &loading.drives[*load].name);
    ModelError::Table { name: [name, ".length"].concat(), position: "its start".into() }
}

/// Refuse a start at which an actuator has a length that its cylinder has not.
///
/// # Errors
/// [`ModelError::Stroke`].
pub fn check_length(reduced: &Reduced, sigma: f64, revolutions: f64) -> Result<(), ModelError> {
    let loading = reduced.loading();
    for (index, &load) in loading.hydraulic_loads().iter().enumerate() {
        let Some(laws) = loading.cylinder(index) else { continue };
        let length = reduced.displacement_at(load, sigma, 0) + revolutions * reduced.load_growth(load);
        if !laws.has_length(length) {
            let name = [&loading.drives[load].name, ".length"].concat();
            return Err(ModelError::Stroke { name, length, lengths: laws.lengths() });
        }
    }
    Ok(())
}

impl State {
    /// Whether a pressure lock is to change in this state.
    pub fn is_lock_due(&self, reduced: &Reduced) -> bool {
        let Some((network, state)) = reduced.loading().network.as_ref().zip(self.memory.network()) else {
            return false;
        };
        let (mut values, mut is_due) = (state.values, false);
        switch_locks(&network.laws, &mut values, &mut |_, _| is_due = true);
        is_due
    }

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
