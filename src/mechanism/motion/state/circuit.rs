//! Steps with the hydraulic circuit of a drive, the network of the mechanism or states of controllers, and what
//! they refuse.
//!
//! In: an equation of motion, the state of the circuit, network or controllers, inputs. Out: the state after the step,
//! or what keeps the motion from going on. It must not know outputs.
use super::inputs::engaged_locks;
use super::{State, set_locks};
use crate::codec::record::{Damaged, Record};
use crate::hydraulics::circuit::SUPPLY;
use crate::integrator::{IntegrationError, Statistics, System};
use crate::mechanism::definition::{ControlState, DefinitionError, MOST_CONTROL_STATES, Mechanism};
use crate::mechanism::dynamics::controlled::CONTROLLED;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{DRIVEN, MOTION};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::network::{NETWORKED, engage_locks, switch_locks};
use crate::mechanism::dynamics::ports::{NetworkPorts, Ports};
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::contact::EngagedLocks;
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::events::Event;
use crate::mechanism::motion::hydraulic_motion::{Driven, HydraulicMotion};
use crate::mechanism::motion::memory::{CircuitState, HydraulicMemory, Memory, drop_outdated};
use crate::mechanism::motion::step_ahead::Outdated;
use crate::mechanism::motion::witness::What;
use crate::mechanism::reduced::Reduced;
use crate::numerics::bits::become_same;
use crate::numerics::decimal::Decimal;
use std::any::Any;
use std::sync::OnceLock;

/// A motion with the hydraulics that drive it.
pub trait Hydraulics<'e, const N: usize> {
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

impl<'e> Hydraulics<'e, CONTROLLED> for EquationOfMotion<'e> {
    fn begin(&mut self, _inputs: &'e Inputs, _time: f64, _h: f64) -> Option<()> {
        Some(())
    }

    fn why_stuck(&self, error: IntegrationError, _z: &[f64; CONTROLLED]) -> Stopped {
        Stopped::Integration(error)
    }
}

impl<const N: usize, const C: usize> HydraulicMotion for HydraulicMemory<N, C>
where
    for<'e> EquationOfMotion<'e>: Hydraulics<'e, N> + System<N>,
{
    fn run<'e>(
        &mut self,
        driven: Driven<'_, 'e>,
        [sigma, sigma_dot]: [f64; 2],
        h: f64,
        max_steps: u64,
    ) -> (Result<f64, Stopped>, [f64; MOTION], EngagedLocks) {
        let Driven { dynamics, ends, contact, witness, tolerance, inputs } = driven;
        let Self { integrator, lookahead, circuit, before, ports } = self;
        *before = *circuit;
        let mut z = [0.0; N];
        (z[0], z[1]) = (sigma, sigma_dot);
        z[MOTION..].copy_from_slice(&circuit.values);
        let start = [sigma, sigma_dot, 0.0];
        // Controllers have no inputs but those that size loads.
        let first = dynamics.whole.loading().first_port().unwrap_or(0);
        let now = &inputs.reals[first..first + ports.len()];
        if become_same(ports, now) {
            drop_outdated(integrator, lookahead, Outdated::Law);
        }
        if dynamics.begin(inputs, circuit.time.now, h).is_none() {
            return (Err(Stopped::Length), start, ends.locked);
        }
        let mut progress = Progress::within(integrator.attempts() + max_steps);
        let mut ends = *ends;
        let mut advanced = loop {
            // A lock may have engaged by the force of its stop before the advance has stopped for another one.
            let mut is_changed = progress.t > 0.0;
            dynamics.switch_locks(&mut z, &mut |lock, engaged| {
                witness.tell(progress.t, What::Switched { lock, engaged });
                is_changed = true;
            });
            if is_changed {
                let locks = (&*inputs.locks, contact.engaged());
                ends.locked = engaged_locks(ends.travel, dynamics.whole, locks, Some(&z[MOTION..]));
                set_locks(contact, &ends, progress.t, witness);
            }
            if lookahead.begin(tolerance, ends.locked) {
                integrator.branch_off();
            }
            let (dynamics, integrator, lookahead) = (&mut *dynamics, &mut *integrator, &mut *lookahead);
            let (contact, witness) = (&mut *contact, &mut *witness);
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

    fn undo(&mut self) {
        self.circuit = self.before;
    }

    fn statistics(&self) -> Statistics {
        self.integrator.statistics()
    }

    fn tried(&self) -> [u64; 2] {
        self.integrator.tried()
    }

    fn event_ahead(&self) -> Option<Event> {
        self.lookahead.step_ahead.as_ref()?.event
    }

    fn drop_outdated(&mut self, outdated: Outdated) {
        drop_outdated(&mut self.integrator, &mut self.lookahead, outdated);
    }

    fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        Self::record(self, record)
    }

    fn duplicate(&self) -> Box<dyn HydraulicMotion> {
        Box::new(self.clone())
    }

    fn copy_from(&mut self, other: &dyn HydraulicMotion) -> bool {
        let other = (other as &dyn Any).downcast_ref();
        other.map(|other| Self::copy_from(self, other)).is_some()
    }
}

/// Memory of a motion with hydraulics or states of controllers at its start; None of another motion.
type AtStart = fn(&Mechanism, &Reduced, &Inputs, [f64; 2]) -> Result<Option<Memory>, ModelError>;
static AT_START: OnceLock<AtStart> = OnceLock::new();

/// State that mechanisms may have hydraulics or states of controllers.
pub fn allow_hydraulics() {
    AT_START.get_or_init(|| memory_at_start);
}

/// Memory of a motion with hydraulics or states of controllers at a start: sigma and whole revolutions. None of
/// another motion.
///
/// # Errors
/// A circuit or network cannot start so. [`ModelError::NoHydraulics`]: this library has no states of controllers.
pub fn begin_hydraulics(
    mechanism: &Mechanism,
    reduced: &Reduced,
    inputs: &Inputs,
    start: [f64; 2],
) -> Result<Option<Memory>, ModelError> {
    match AT_START.get() {
        Some(at_start) => at_start(mechanism, reduced, inputs, start),
        None if reduced.loading().control_states().next().is_some() => Err(ModelError::NoHydraulics),
        None => Ok(None),
    }
}

fn memory_at_start(
    mechanism: &Mechanism,
    reduced: &Reduced,
    inputs: &Inputs,
    [sigma, revolutions]: [f64; 2],
) -> Result<Option<Memory>, ModelError> {
    let loading = reduced.loading();
    if let (Some((_, _, circuit)), Some(drive)) = (mechanism.hydraulic_drive(), &loading.hydraulics) {
        // Its start is no part of the reduced model, which is checked when it is made.
        circuit.check()?;
        let values = drive.laws.start(circuit, inputs.reals[drive.first_input + 1]);
        let state = CircuitState { values, ..CircuitState::default() };
        return Memory::with_circuit(state, loading.ports()).map(Some);
    }
    if let (Some(system), Some(drives)) = (&mechanism.hydraulics, &loading.network) {
        system.check_elements()?;
        let growth = |load: usize| revolutions * reduced.load_growth(load);
        let length = |load: &usize| reduced.displacement_at(*load, sigma, 0) + growth(*load);
        let lengths: Vec<f64> = drives.loads.iter().map(length).collect();
        let (laws, mut state) = (&drives.laws, CircuitState::default());
        laws.fill_start(system, &mut state.values);
        state.values[laws.layout.components()] = laws.volume_at(|cylinder| lengths[cylinder]);
        engage_locks(laws, &mut state.values);
        return Memory::with_network(state, loading.ports()).map(Some);
    }
    if loading.control_states().next().is_none() {
        return Ok(None);
    }
    Memory::with_control(control_at_start(mechanism)?).map(Some)
}

/// The states of the controllers of a mechanism at its start, with stated forces alone.
///
/// # Errors
/// A stated force is beyond a limit of the force.
pub fn control_at_start(mechanism: &Mechanism) -> Result<CircuitState<MOST_CONTROL_STATES>, DefinitionError> {
    let mut state = CircuitState::default();
    for (value, (name, control, kind)) in state.values.iter_mut().zip(mechanism.control_states()) {
        let start = if kind == ControlState::Force { control.start_force } else { control.start_integral };
        *value = start.unwrap_or(0.0);
        let [least, most] = [control.min_force, control.max_force];
        let is_beyond = least.is_some_and(|least| *value < least) || most.is_some_and(|most| *value > most);
        if kind == ControlState::Force && start.is_some() && is_beyond {
            let key = format_args!("actuators.{name}.control.start_force");
            let limit = |name: &str, limit: Option<f64>| limit.map(|limit| format!("{name} = {}", Decimal(limit)));
            let limits = [limit(">= min_force", least), limit("<= max_force", most)].into_iter().flatten();
            let allowed = limits.collect::<Vec<_>>().join(" and ");
            return Err(DefinitionError::value(key, Decimal(*value), allowed));
        }
    }
    Ok(state)
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
        if input == drive.first_input + 1
            && let Some(circuit) = self.saved.memory.circuit_mut().filter(|circuit| circuit.time == Elapsed::default())
        {
            circuit.values[SUPPLY] = value;
        }
    }
}
