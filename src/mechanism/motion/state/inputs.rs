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
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::acting::{airspeed, blows_under, state_loads};
use crate::mechanism::motion::contact::{Contact, EngagedLocks, Place, Places, Travel};
use crate::mechanism::motion::prescribed::PrescribedState;
use crate::mechanism::motion::saved::Applied;
use crate::mechanism::motion::step_ahead::Outdated;
use crate::mechanism::motion::travel::set_forces_of_locks;
use crate::mechanism::reduced::{Reduced, StateLoads};
use std::sync::Arc;

/// Largest size of an input whose loads are taken not to overflow. The loads of a larger one are tried before a step.
const LARGE: f64 = 1e100;

/// The inputs applied before, with the energy.
#[derive(Clone, Debug, Default)]
pub struct Before {
    pub(super) applied: Applied,
    pub(super) reference: f64,
    /// The prescribed motion, with the contact; none where no drive has a motion.
    pub(super) prescribed: Option<(Option<PrescribedState>, Contact)>,
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
        (saved.applied.version, saved.reference) = (0, reference);
        for end in Arc::make_mut(&mut saved.travel).rigid.iter_mut().flatten() {
            end.restitution = reduced.loading().stops[end.stop].restitution;
        }
        set_forces_of_locks(Arc::make_mut(&mut saved.travel), reduced)?;
        if let Err((stretch, end)) = reduced.reach(saved.sigma) {
            return Err(ModelError::travel((stretch, end), saved.sigma));
        }
        Self::from_saved(&saved, reduced, inputs)
    }

    /// The applied loads on the panel of the last step, if no drive has a motion. `air`: whether moving air is to be
    /// among the loads that the state decides.
    #[inline]
    pub fn panel_force(&self, air: bool) -> Option<&PanelForce> {
        (self.prescribed.is_none() && self.scratch.air == air).then_some(&self.scratch.panel_force)
    }

    /// Apply inputs that may have changed since the last step, for a step of `h` [s]. The change of the potential of
    /// the loads is work from outside.
    ///
    /// # Errors
    /// [`ModelError::Table`], [`ModelError::LoadOverflow`]; nothing has changed.
    pub(super) fn apply(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64) -> Result<(), ModelError> {
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
            let before = self.applied.sizes[load];
            if before.to_bits() != input.to_bits() {
                if !reduced.loading().is_command(load) {
                    work -= (input - before) * self.displacement(reduced, load);
                }
                largest = largest.max(input.abs());
                changed = true;
            }
        }
        let airspeed = airspeed(reduced, inputs);
        if airspeed.to_bits() != self.applied.airspeed.to_bits() {
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
            self.memory.drop_outdated(Outdated::State);
        }
        self.memory.set_dissipation(state_loads.is_some() || ahead);
        let Self { saved, before, .. } = self;
        let saved = &mut **saved;
        before.applied.copy_from(&saved.applied);
        before.reference = saved.reference;
        if saved.prescribed.is_some() {
            before.prescribed = Some((saved.prescribed, saved.contact));
        }
        let locks = (&*inputs.locks, saved.contact.engaged());
        let locked = engaged_locks(&saved.travel, reduced, locks, saved.memory.network_values());
        let applied = &mut saved.applied;
        (applied.airspeed, applied.air, applied.locked) = (airspeed, air, locked);
        // Inputs that change with time are others after the step.
        applied.version = if ahead { 0 } else { inputs.version() };
        if changed {
            saved.reference += work;
            applied.sizes[..loads].copy_from_slice(&inputs.reals[..loads]);
            if let Some(load) = driven {
                applied.sizes[load] = 0.0;
            }
        }
        if changed || ahead || self.is_retuned {
            saved.memory.drop_outdated(Outdated::Law);
            saved.prescribed.iter_mut().for_each(|prescribed| prescribed.ahead = None);
        }
        if saved.prescribed.is_some() && driven.is_none() {
            self.release_prescribed(reduced, locked);
        }
        Ok(())
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
        let mut sizes = self.applied.sizes.clone();
        sizes[..loads].copy_from_slice(&inputs.reals[..loads]);
        let (version, airspeed, revolutions) = (0, airspeed(reduced, inputs), self.revolutions);
        let applied = AppliedLoads { version, sizes: &sizes, airspeed, revolutions, change: inputs.change(reduced) };
        let (here, scratch) = (reduced.at(self.sigma), &mut Scratch::new(state_loads));
        let mut equation = EquationOfMotion::new(reduced, (here, state_loads), applied, scratch);
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
        self.memory.drop_outdated(Outdated::State);
        self.memory.undo_circuit();
        self.witness.forget();
        if applied {
            let Self { saved, before, .. } = self;
            saved.applied.copy_from(&before.applied);
            saved.reference = before.reference;
            if let Some(prescribed) = before.prescribed {
                (saved.prescribed, saved.contact) = prescribed;
            }
        }
        self.applied.version = 0;
        // These state loads exist: they were in use before this step.
        let state_loads = self.state_loads(reduced).unwrap_or_default();
        self.renew_scratch(state_loads);
        self.memory.set_dissipation(state_loads.is_some());
    }
}
