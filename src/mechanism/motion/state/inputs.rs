//! Inputs that a state applies: sizes of loads, air, locks.
//!
//! In: inputs that may have changed since the last step. Out: a state with them applied, or as it was before; the loads
//! that the state decides under them. It must not know how a step is made.
use super::State;
use super::ports::check_ports;
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::network::is_engaged;
use crate::mechanism::dynamics::panel_force::{AppliedLoads, PanelForce};
use crate::mechanism::dynamics::state_loads::Mode;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::acting::{airspeed, blows_under, state_loads};
use crate::mechanism::motion::contact::{Contact, EngagedLocks, Place, Places, Travel};
use crate::mechanism::motion::prescribed::PrescribedState;
use crate::mechanism::motion::travel::set_forces_of_locks;
use crate::mechanism::reduced::{Reduced, StateLoads};
use std::sync::Arc;

/// Largest size of an input whose loads are taken not to overflow. The loads of a larger one are tried before a step.
const LARGE: f64 = 1e100;

/// Loads and energy before inputs were applied.
#[derive(Clone, Debug, Default)]
pub struct Before {
    /// Sizes of the loads.
    sizes: Vec<f64>,
    airspeed: f64,
    air: bool,
    reference: f64,
    /// The prescribed motion, with the contact; none where no drive has a motion.
    prescribed: Option<(Option<PrescribedState>, Contact)>,
}

impl Before {
    /// Nothing replaced yet, with as many sizes as these.
    pub fn new(sizes: &[f64]) -> Self {
        Self { sizes: sizes.to_vec(), ..Self::default() }
    }

    /// As many sizes as this.
    pub fn resize(&mut self, sizes: usize) {
        self.sizes.resize(sizes, 0.0);
    }
}

/// Whether a lock is engaged: as its input states, and, where a pressure lock of the network operates it, as that does.
/// `network`: the state of the network, if there is one.
pub fn engages(reduced: &Reduced, locks: &[bool], network: Option<&[f64]>, lock: usize) -> bool {
    let by_pressure = || {
        let drives = reduced.loading().network.as_ref()?;
        Some(is_engaged(&drives.laws, network?, drives.locks[lock]?))
    };
    locks[lock] && by_pressure().unwrap_or(true)
}

/// The places at which a lock is engaged, as [`engages`] states, or waits for the force of its stop, at which it has
/// not yet `engaged`.
pub fn engaged_locks(
    travel: &Travel,
    reduced: &Reduced,
    (locks, engaged): (&[bool], Places),
    network: Option<&[f64]>,
) -> EngagedLocks {
    let mut locked = EngagedLocks::default();
    if !locks.contains(&true) {
        return locked;
    }
    let all = reduced.loading().locks.iter().enumerate();
    for (_, lock) in all.filter(|(index, _)| engages(reduced, locks, network, *index)) {
        let bumpers = (0..travel.bumpers.len()).map(|k| Place::of_bumper(0, k));
        for place in [0, 1].map(Place::rigid).into_iter().chain(bumpers) {
            if travel.holds(place, lock.stop) {
                locked = locked.with(place, lock.engage.is_none() || engaged.contains(place));
            }
        }
    }
    locked
}

impl State {
    /// The same state under a reduced model with other laws on the same curve, with an energy that the balance refers
    /// to [J]. The inputs are applied anew with the next step.
    ///
    /// # Errors
    /// [`ModelError::Table`]: a reaction that causes friction is not smooth.
    pub fn retuned(&self, reduced: &Reduced, inputs: &Inputs, reference: f64) -> Result<Self, ModelError> {
        let mut saved = self.saved.clone();
        (saved.in_force, saved.reference) = (None, reference);
        for end in Arc::make_mut(&mut saved.travel).rigid.iter_mut().flatten() {
            end.restitution = reduced.loading().stops[end.stop].restitution;
        }
        set_forces_of_locks(Arc::make_mut(&mut saved.travel), reduced)?;
        if let Err((stretch, end)) = reduced.reach(saved.sigma) {
            return Err(ModelError::travel((stretch, end), saved.sigma));
        }
        Self::from_saved(&saved, reduced, inputs)
    }

    /// An input or a lock has changed: the inputs are applied with the next step.
    #[inline]
    pub fn inputs_changed(&mut self) {
        self.saved.in_force = None;
    }

    /// The applied loads on the panel of the last step, if its inputs are in force and do not change with time.
    /// `air`: whether moving air is to be among the loads that the state decides.
    #[inline]
    pub fn panel_force(&self, air: bool) -> Option<&PanelForce> {
        let is_known = self.in_force.is_some() && self.prescribed.is_none() && self.scratch.air == air;
        is_known.then_some(&self.scratch.panel_force)
    }

    /// Take over for the next step what outputs have evaluated last, under the same conditions.
    #[inline(always)]
    pub(super) fn share(&mut self, reduced: &Reduced, known: &Scratch) {
        let panel_force = self.panel_force(known.air).map(|_| &known.panel_force);
        self.scratch.panel_force.share(panel_force, reduced.at(self.saved.sigma).stretch, self.saved.sigma);
    }

    /// Apply inputs that may have changed since the last step, for a step of `h` [s], and return the places where a
    /// lock is engaged. The change of the loads' potential is work from outside.
    ///
    /// # Errors
    /// [`ModelError::Table`], [`ModelError::LoadOverflow`]; nothing has changed.
    pub(super) fn apply(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64) -> Result<EngagedLocks, ModelError> {
        let (air, ahead) = (blows_under(reduced, inputs), inputs.signal.ahead);
        let state_loads = state_loads(reduced.at(self.sigma), air, self.revolutions)?;
        check_ports(reduced, inputs, h)?;
        let loads = reduced.loading().inputs.len();
        let (mut work, mut largest) = (0.0, 0.0_f64);
        let mut changed = false;
        // The force of a drive under a prescribed motion is no input.
        let driven = reduced.loading().motion.as_ref().filter(|_| self.is_prescribed(inputs)).map(|drive| drive.load);
        let size = |load: usize, input: f64| if driven == Some(load) { 0.0 } else { input };
        for (load, input) in inputs.reals[..loads].iter().enumerate() {
            let input = &size(load, *input);
            if self.applied[load].to_bits() != input.to_bits() {
                if !reduced.loading().is_command(load) {
                    work -= (input - self.applied[load]) * self.displacement(reduced, load);
                }
                largest = largest.max(input.abs());
                changed = true;
            }
        }
        let airspeed = airspeed(reduced, inputs);
        if airspeed.to_bits() != self.airspeed.to_bits() {
            largest = largest.max(airspeed.abs());
            changed = true;
        }
        if ahead {
            largest = inputs.largest_at(h).max(largest);
        }
        if largest > LARGE {
            self.try_loads((reduced, state_loads), inputs, h, work)?;
        }
        if self.renew_scratch(state_loads) {
            self.memory.restart();
        }
        self.memory.set_dissipation(state_loads.is_some() || ahead);
        let Self { saved, before, .. } = self;
        before.sizes.copy_from_slice(&saved.applied);
        (before.airspeed, before.air, before.reference) = (saved.airspeed, saved.air, saved.reference);
        if saved.prescribed.is_some() {
            before.prescribed = Some((saved.prescribed, saved.contact));
        }
        (saved.airspeed, saved.air) = (airspeed, air);
        if changed {
            saved.reference += work;
            saved.applied[..loads].copy_from_slice(&inputs.reals[..loads]);
            if let Some(load) = driven {
                saved.applied[load] = 0.0;
            }
        }
        if changed || ahead || self.is_retuned {
            self.right_hand_side_changed();
        }
        let locks = (&*inputs.locks, self.contact.engaged());
        let locked = engaged_locks(&self.travel, reduced, locks, self.memory.network_values());
        if self.saved.prescribed.is_some() && driven.is_none() {
            self.release_prescribed(reduced, locked);
        }
        // Inputs that change with time are others after the step.
        self.in_force = (!ahead).then_some(locked);
        Ok(locked)
    }

    /// Refuse inputs so large that their work or their loads overflow at the start or at the end of a step of `h` [s],
    /// at the present position. `work`: that of their change [J].
    #[cold]
    fn try_loads(
        &self,
        (reduced, state_loads): (&Reduced, Option<&StateLoads>),
        inputs: &Inputs,
        h: f64,
        work: f64,
    ) -> Result<(), ModelError> {
        let loads = reduced.loading().inputs.len();
        let mut sizes = self.applied.clone();
        sizes[..loads].copy_from_slice(&inputs.reals[..loads]);
        let (airspeed, revolutions) = (airspeed(reduced, inputs), self.revolutions);
        let applied = AppliedLoads { sizes: &sizes, airspeed, revolutions, change: inputs.change(reduced) };
        let (mode, scratch) = (Mode::default(), &mut Scratch::new(state_loads));
        let (whole, reduced, time, locked, ports, network) = (reduced, reduced.at(self.sigma), 0.0, false, None, None);
        let mut equation =
            EquationOfMotion { whole, reduced, state_loads, applied, time, mode, scratch, locked, ports, network };
        let mut overflows = !(self.reference + work).is_finite();
        for time in [0.0, h] {
            equation.time = time;
            let force = equation.effect(self.sigma, self.sigma_dot);
            overflows |= force.is_ok_and(|force| !(force.acceleration.is_finite() && force.lost.is_finite()));
        }
        if !overflows {
            return Ok(());
        }
        let sizes = (0..inputs.reals.len()).map(|input| (input, inputs.size_at(input, h)));
        let acting = sizes.filter(|(input, _)| *input < loads || reduced.loading().air.is_some());
        let (input, value) = acting.max_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or_default();
        let name = reduced.loading().inputs.get(input).map_or("airspeed", String::as_str);
        Err(ModelError::LoadOverflow { name: name.into(), value })
    }

    /// After a step that failed: reverse [`Self::apply`] if it `applied` inputs. The integration starts anew.
    #[cold]
    pub(super) fn undo(&mut self, reduced: &Reduced, applied: bool) {
        self.memory.restart();
        self.memory.undo_circuit();
        self.witness.forget();
        if applied {
            let Self { saved, before, .. } = self;
            saved.applied.copy_from_slice(&before.sizes);
            (saved.airspeed, saved.air, saved.reference) = (before.airspeed, before.air, before.reference);
            saved.in_force = None;
            if let Some(prescribed) = before.prescribed {
                (saved.prescribed, saved.contact) = prescribed;
            }
        }
        // These state loads exist: they were in use before this step.
        let state_loads = self.state_loads(reduced).unwrap_or_default();
        self.renew_scratch(state_loads);
        self.memory.set_dissipation(state_loads.is_some());
        self.scratch.panel_force.invalidate();
    }
}
