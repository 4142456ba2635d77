//! Memory of the integration: of the kind that a step needs, kept from step to step.
//!
//! In: what of the right-hand side has changed. Out: the integrator and the step ahead that still hold, or begun anew.
//! It must not know loads, nor how a step is made.

use crate::codec::record::{Damaged, Record};
use crate::hydraulics::circuit::CIRCUIT;
use crate::integrator::{Integrator, Statistics};
use crate::mechanism::definition::MOST_CONTROL_STATES;
use crate::mechanism::dynamics::controlled::CONTROLLED;
use crate::mechanism::dynamics::hydraulic::DRIVEN;
use crate::mechanism::dynamics::network::{CAPACITY, NETWORKED};
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::events::Event;
use crate::mechanism::motion::hydraulic_motion::HydraulicMotion;
use crate::mechanism::motion::step_ahead::{Lookahead, Outdated};
use std::any::Any;
use std::sync::OnceLock;

/// Memory of the integration, with or without the energy lost and a circuit as components of the state. A step
/// allocates nothing, so there is no box where a step may go from one to another.
#[derive(Clone, Debug)]
pub enum Memory {
    /// No power is lost: the state is (sigma, sigma_dot).
    Conservative(Integrator<2>, Lookahead<2>),
    /// The energy lost is integrated too.
    WithDissipation(Integrator<3>, Lookahead<3>),
    /// The hydraulic circuit of a drive, the hydraulic network of the mechanism, or the states of controllers are
    /// integrated too.
    WithHydraulics(Box<dyn HydraulicMotion>),
}

/// State of a hydraulic circuit, a network or controllers of C components, with the memory of the integration.
#[derive(Clone, Debug, PartialEq)]
pub struct HydraulicMemory<const N: usize, const C: usize> {
    pub integrator: Integrator<N>,
    pub lookahead: Lookahead<N>,
    pub circuit: CircuitState<C>,
    /// State at the beginning of the last step, for a step that fails.
    pub before: CircuitState<C>,
    /// Inputs of the circuit or network at the beginning of the last step.
    pub ports: Vec<f64>,
}

/// Of the circuit of a drive.
pub type CircuitMemory = HydraulicMemory<DRIVEN, CIRCUIT>;
/// Of a network.
pub type NetworkMemory = HydraulicMemory<NETWORKED, CAPACITY>;
/// Of controllers.
pub type ControlMemory = HydraulicMemory<CONTROLLED, MOST_CONTROL_STATES>;

/// State of a hydraulic circuit, of a network, or of controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircuitState<const C: usize = CIRCUIT> {
    /// Time since the start.
    pub time: Elapsed,
    /// Of a circuit: pressures of the chambers A and B [Pa], position and speed of the spool, six energies [J],
    /// pressure of the accumulator [Pa]. Of a network: its components, then the volume of all chambers at the start
    /// [m3], then for each pressure lock 1 if it is engaged, else 0. Of controllers: their states [N or N.m].
    pub values: [f64; C],
}

impl<const C: usize> Default for CircuitState<C> {
    fn default() -> Self {
        Self { time: Elapsed::default(), values: [0.0; C] }
    }
}

impl CircuitState {
    /// Pressures of the chambers A and B [Pa].
    pub fn pressures(&self) -> [f64; 2] {
        [self.values[0], self.values[1]]
    }
}

impl<const N: usize, const C: usize> HydraulicMemory<N, C> {
    /// A circuit or network with so many inputs that begins in this state.
    pub fn new(circuit: CircuitState<C>, ports: usize) -> Self {
        Self {
            integrator: Integrator::keeping(),
            lookahead: Lookahead::default(),
            circuit,
            before: circuit,
            ports: vec![0.0; ports],
        }
    }

    /// Become the same as another one, without allocation.
    pub fn copy_from(&mut self, other: &Self) {
        self.integrator.copy_from(&other.integrator);
        self.lookahead.copy_from(&other.lookahead);
        (self.circuit, self.before) = (other.circuit, other.before);
        self.ports.copy_from_slice(&other.ports);
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.circuit.time.record(record)?;
        record.all_finite("state of the circuit", &mut self.circuit.values)?;
        if record.reads() {
            self.before = self.circuit;
        }
        record.all_finite("input of the circuit", &mut self.ports)?;
        self.integrator.record(record)?;
        self.lookahead.record(record)
    }
}

/// A motion with hydraulics that begins in this state, with so many inputs.
type Make<const C: usize> = fn(CircuitState<C>, usize) -> Box<dyn HydraulicMotion>;
/// Makers of motions with a circuit, with a network and with states of controllers.
static MAKERS: OnceLock<(Make<CIRCUIT>, Make<CAPACITY>, Make<MOST_CONTROL_STATES>)> = OnceLock::new();

/// State that mechanisms may have hydraulics or states of controllers. A library that never does so is without the code
/// of their steps.
pub fn allow_hydraulics() {
    MAKERS.get_or_init(|| {
        let circuit: Make<CIRCUIT> = |state, ports| Box::new(CircuitMemory::new(state, ports));
        let network: Make<CAPACITY> = |state, ports| Box::new(NetworkMemory::new(state, ports));
        let control: Make<MOST_CONTROL_STATES> = |state, ports| Box::new(ControlMemory::new(state, ports));
        (circuit, network, control)
    });
}

impl Default for Memory {
    fn default() -> Self {
        Self::Conservative(Integrator::default(), Lookahead::default())
    }
}

impl Memory {
    /// That before the first step of a motion with a circuit in this state, with so many inputs.
    ///
    /// # Errors
    /// [`ModelError::NoHydraulics`]: nothing called [`allow_hydraulics`].
    pub fn with_circuit(state: CircuitState, ports: usize) -> Result<Self, ModelError> {
        let (make, ..) = MAKERS.get().ok_or(ModelError::NoHydraulics)?;
        Ok(Self::WithHydraulics(make(state, ports)))
    }

    /// [`Self::with_circuit`] for a network.
    ///
    /// # Errors
    /// As [`Self::with_circuit`].
    pub fn with_network(state: CircuitState<CAPACITY>, ports: usize) -> Result<Self, ModelError> {
        let (_, make, _) = MAKERS.get().ok_or(ModelError::NoHydraulics)?;
        Ok(Self::WithHydraulics(make(state, ports)))
    }

    /// [`Self::with_circuit`] for states of controllers.
    ///
    /// # Errors
    /// As [`Self::with_circuit`].
    pub fn with_control(state: CircuitState<MOST_CONTROL_STATES>) -> Result<Self, ModelError> {
        let (.., make) = MAKERS.get().ok_or(ModelError::NoHydraulics)?;
        Ok(Self::WithHydraulics(make(state, 0)))
    }

    /// Become that before the first step, without a circuit.
    pub fn begin(&mut self, with_dissipation: bool) {
        match self {
            Self::Conservative(i, ahead) if !with_dissipation => begin(i, ahead),
            Self::WithDissipation(i, ahead) if with_dissipation => begin(i, ahead),
            _ => {
                *self = Self::default();
                self.set_dissipation(with_dissipation);
            }
        }
    }

    /// Integrate the energy lost or not: it counts in steps with loads that the state decides or with inputs that
    /// change.
    #[inline]
    pub fn set_dissipation(&mut self, with_dissipation: bool) {
        match self {
            Self::Conservative(i, _) if with_dissipation => {
                *self = Self::WithDissipation(i.with_components(), Lookahead::default())
            }
            Self::WithDissipation(i, _) if !with_dissipation => {
                *self = Self::Conservative(i.with_components(), Lookahead::default())
            }
            _ => {}
        }
    }

    /// Counts of the integration's work since the start.
    pub fn statistics(&self) -> Statistics {
        match self {
            Self::Conservative(i, _) => i.statistics(),
            Self::WithDissipation(i, _) => i.statistics(),
            Self::WithHydraulics(motion) => motion.statistics(),
        }
    }

    /// Steps that the integration has accepted and rejected since the start.
    #[inline]
    pub fn tried(&self) -> [u64; 2] {
        match self {
            Self::Conservative(i, _) => i.tried(),
            Self::WithDissipation(i, _) => i.tried(),
            Self::WithHydraulics(motion) => motion.tried(),
        }
    }

    /// State of the hydraulic circuit of a drive; none without one.
    #[inline]
    pub fn circuit(&self) -> Option<&CircuitState> {
        self.hydraulics::<CircuitMemory>().map(|memory| &memory.circuit)
    }

    /// [`Self::circuit`], to change it.
    pub fn circuit_mut(&mut self) -> Option<&mut CircuitState> {
        let Self::WithHydraulics(motion) = self else { return None };
        (motion.as_mut() as &mut dyn Any).downcast_mut::<CircuitMemory>().map(|memory| &mut memory.circuit)
    }

    /// State of the hydraulic network of the mechanism; none without one.
    #[inline]
    pub fn network(&self) -> Option<&CircuitState<CAPACITY>> {
        self.hydraulics::<NetworkMemory>().map(|memory| &memory.circuit)
    }

    /// States of controllers [N or N.m]; none without one.
    #[inline]
    pub fn controllers(&self) -> Option<&[f64; MOST_CONTROL_STATES]> {
        self.hydraulics::<ControlMemory>().map(|memory| &memory.circuit.values)
    }

    /// Change the first states of controllers, if there are any: the integration starts anew.
    pub fn set_controllers(&mut self, values: &[f64]) {
        let Self::WithHydraulics(motion) = self else { return };
        if let Some(memory) = (motion.as_mut() as &mut dyn Any).downcast_mut::<ControlMemory>() {
            memory.circuit.values.iter_mut().zip(values).for_each(|(own, value)| *own = *value);
            drop_outdated(&mut memory.integrator, &mut memory.lookahead, Outdated::State);
        }
    }

    /// The motion with hydraulics of this type.
    #[inline]
    fn hydraulics<T: 'static>(&self) -> Option<&T> {
        let Self::WithHydraulics(motion) = self else { return None };
        (motion.as_ref() as &dyn Any).downcast_ref()
    }

    /// The numbers of this state.
    #[inline]
    pub fn network_values(&self) -> Option<&[f64]> {
        self.network().map(|network| &network.values[..])
    }

    /// A step has failed: the circuit or network is where it was.
    pub fn undo_circuit(&mut self) {
        if let Self::WithHydraulics(motion) = self {
            motion.undo();
        }
    }

    /// The event at the end of a step ahead.
    pub(super) fn event_ahead(&self) -> Option<Event> {
        match self {
            Self::Conservative(_, ahead) => ahead.step_ahead.as_ref()?.event,
            Self::WithDissipation(_, ahead) => ahead.step_ahead.as_ref()?.event,
            Self::WithHydraulics(motion) => motion.event_ahead(),
        }
    }

    /// Become the same as another one; copies no more than that one is.
    pub fn copy_from(&mut self, other: &Self) {
        match (self, other) {
            (Self::Conservative(own, own_ahead), Self::Conservative(other, other_ahead)) => {
                own.copy_from(other);
                own_ahead.copy_from(other_ahead);
            }
            (Self::WithDissipation(own, own_ahead), Self::WithDissipation(other, other_ahead)) => {
                own.copy_from(other);
                own_ahead.copy_from(other_ahead);
            }
            (Self::WithHydraulics(own), Self::WithHydraulics(other)) => {
                if !own.copy_from(other.as_ref()) {
                    *own = other.clone();
                }
            }
            (own, other) => *own = other.clone(),
        }
    }

    /// Keep only what does not depend on this.
    pub fn drop_outdated(&mut self, outdated: Outdated) {
        match self {
            Self::Conservative(i, ahead) => drop_outdated(i, ahead, outdated),
            Self::WithDissipation(i, ahead) => drop_outdated(i, ahead, outdated),
            Self::WithHydraulics(motion) => motion.drop_outdated(outdated),
        }
    }
}

/// [`Memory::begin`] of one kind.
fn begin<const N: usize>(integrator: &mut Integrator<N>, lookahead: &mut Lookahead<N>) {
    integrator.begin_anew();
    lookahead.begin_anew();
}

/// [`Memory::drop_outdated`] of one kind.
#[inline]
pub(super) fn drop_outdated<const N: usize>(
    integrator: &mut Integrator<N>,
    lookahead: &mut Lookahead<N>,
    outdated: Outdated,
) {
    let was_ahead = match outdated {
        Outdated::Count => lookahead.step_ahead.take().is_some(),
        _ => lookahead.invalidate(),
    };
    match outdated {
        Outdated::State => integrator.restart(),
        _ if was_ahead => integrator.branch_off(),
        Outdated::Law => integrator.refresh(),
        Outdated::Count => {}
    }
}
