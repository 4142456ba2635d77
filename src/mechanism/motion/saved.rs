//! Saved states: the part of a state of motion that decides how it continues, with the memory of the integration.
//!
//! In: a state, or a record. Out: a state that continues bit for bit as the saved one would have. It must not know
//! outputs.
use super::state::{blows, state_loads};
use crate::codec::record::{Damaged, Record};
use crate::integrator::{Integrator, Statistics};
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::contact::{Contact, End, StopKind, Travel};
use crate::mechanism::motion::events::Event;
use crate::mechanism::motion::step_ahead::{Lookahead, StepAhead};
use crate::mechanism::motion::travel::stop_kind;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::bits::become_same;

/// Part of a closed curve's length by which sigma may be beyond its ends by rounding.
const ROUNDING: f64 = 1e-12;
/// Most revolutions, so that one more of them still counts.
pub(super) const MOST_REVOLUTIONS: f64 = 1e15;

/// The part of a state of motion that decides how it continues.
#[derive(Clone, Debug, Default)]
pub struct SavedState {
    /// Length along the curve; on a closed curve within its first revolution.
    pub sigma: f64,
    /// Its rate.
    pub sigma_dot: f64,
    /// Whole revolutions of a closed curve made so far.
    pub revolutions: f64,
    pub contact: Contact,
    pub travel: Travel,
    /// Sizes of the loads in the last step, which the integration and the energy balance refer to.
    pub applied: Vec<f64>,
    /// Airspeed at the start of the last step [m/s].
    pub airspeed: f64,
    /// Whether air has acted on the surfaces at any time of the last step.
    pub air: bool,
    /// Energy at the start, plus the work of changing sizes, less the energy lost since.
    pub reference: f64,
    pub memory: Memory,
}

/// Memory of the integration, with or without the energy lost as a component of the state.
#[expect(clippy::large_enum_variant, reason = "a step allocates nothing, so there is no box")]
#[derive(Clone, Copy, Debug)]
pub enum Memory {
    /// No power is lost: the state is (sigma, sigma_dot).
    Conservative(Integrator<2>),
    /// The energy lost is integrated too, and steps may go on beyond the present.
    WithDissipation(Integrator<3>, Lookahead<3>),
}

impl Default for Memory {
    fn default() -> Self {
        Self::Conservative(Integrator::default())
    }
}

impl Memory {
    /// Integrate the energy lost or not: it counts in steps with loads that the state decides or with inputs that
    /// change.
    pub fn set_dissipation(&mut self, with_dissipation: bool) {
        match self {
            Self::Conservative(i) if with_dissipation => {
                *self = Self::WithDissipation(i.with_components(), Lookahead::default())
            }
            Self::WithDissipation(i, _) if !with_dissipation => *self = Self::Conservative(i.with_components()),
            _ => {}
        }
    }

    /// Counts of the integration's work since the start.
    pub fn statistics(&self) -> Statistics {
        match self {
            Self::Conservative(i) => i.statistics(),
            Self::WithDissipation(i, _) => i.statistics(),
        }
    }

    /// Become the same as another one; copies no more than that one is.
    pub fn copy_from(&mut self, other: &Self) {
        match (self, other) {
            (Self::Conservative(own), Self::Conservative(other)) => own.copy_from(other),
            (Self::WithDissipation(own, own_ahead), Self::WithDissipation(other, other_ahead)) => {
                own.copy_from(other);
                own_ahead.copy_from(other_ahead);
            }
            (own, other) => *own = *other,
        }
    }

    /// Clear all but the statistics.
    pub fn restart(&mut self) {
        match self {
            Self::Conservative(i) => i.restart(),
            Self::WithDissipation(i, ahead) => {
                i.restart();
                ahead.invalidate();
            }
        }
    }

    /// sigma is counted from another revolution.
    pub fn recount(&mut self) {
        if let Self::WithDissipation(i, ahead) = self
            && ahead.step_ahead.take().is_some()
        {
            i.branch_off();
        }
    }

    /// The right-hand side has changed.
    pub fn refresh(&mut self) {
        match self {
            Self::Conservative(i) => i.refresh(),
            Self::WithDissipation(i, ahead) => {
                if ahead.invalidate() {
                    i.branch_off();
                }
                i.refresh();
            }
        }
    }
}

impl SavedState {
    /// Become the same as another one of this mechanism, without allocation. Returns whether the sizes of loads or the
    /// revolutions were others.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) -> bool {
        let others = become_same(&mut self.applied, &other.applied) || self.revolutions != other.revolutions;
        (self.sigma, self.sigma_dot, self.revolutions) = (other.sigma, other.sigma_dot, other.revolutions);
        (self.contact, self.travel) = (other.contact, other.travel);
        (self.airspeed, self.air, self.reference) = (other.airspeed, other.air, other.reference);
        self.memory.copy_from(&other.memory);
        others
    }

    /// The loads that the state decides, as in the last step.
    pub fn state_loads<'a>(&self, reduced: &'a Reduced) -> Result<Option<&'a StateLoads>, ModelError> {
        state_loads(reduced, self.air, self.revolutions)
    }

    /// Read one for this reduced model.
    ///
    /// # Errors
    /// A field is not what this mechanism can have.
    pub fn read(record: &mut Record, reduced: &Reduced) -> Result<Self, ModelError> {
        let mut saved = Self { applied: vec![0.0; reduced.components().sized], ..Self::default() };
        saved.record(record)?;
        saved.check(reduced)?;
        for end in saved.travel.iter_mut().flatten() {
            end.kind = stop_kind(reduced.loading(), end.stop);
        }
        Ok(saved)
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.finite("sigma", &mut self.sigma)?;
        record.finite("sigma_dot", &mut self.sigma_dot)?;
        let allowed = |revolutions: f64| revolutions.fract() == 0.0 && revolutions.abs() <= MOST_REVOLUTIONS;
        record.number("turns", &mut self.revolutions, allowed, "a whole number")?;
        self.contact.record(record)?;
        for end in &mut self.travel {
            // The kind of the stop follows from the parameters.
            let blank = || End { position: 0.0, stop: 0, kind: StopKind::Rigid { restitution: 0.0 } };
            record.option("end of the travel", end, blank, |record, end| {
                record.finite("end of the travel", &mut end.position)?;
                record.place("stop", &mut end.stop, usize::MAX)
            })?;
        }
        record.length("sizes", self.applied.len())?;
        record.all_finite("size", &mut self.applied)?;
        record.finite("airspeed", &mut self.airspeed)?;
        record.flag("air acts", &mut self.air)?;
        record.finite("energy", &mut self.reference)?;
        let mut with_dissipation = matches!(self.memory, Memory::WithDissipation(..));
        record.flag("energy lost integrated", &mut with_dissipation)?;
        self.memory.set_dissipation(with_dissipation);
        match &mut self.memory {
            Memory::Conservative(integrator) => integrator.record(record),
            Memory::WithDissipation(integrator, lookahead) => {
                integrator.record(record)?;
                lookahead.record(record)
            }
        }
    }

    /// Refuse what this mechanism cannot have.
    fn check(&self, reduced: &Reduced) -> Result<(), ModelError> {
        let refuse = |what: String| Err(Damaged(what).into());
        let (first, last) = reduced.curve().range;
        let slack = reduced.period().map_or(0.0, |period| ROUNDING * period);
        if !(first - slack..=last + slack).contains(&self.sigma) {
            return refuse(format!("sigma = {}: must be from {first} to {last}", self.sigma));
        }
        if reduced.period().is_none() && self.revolutions != 0.0 {
            return refuse(format!("turns = {}: must be 0, as the travel is open", self.revolutions));
        }
        let loading = reduced.loading();
        if (self.air && loading.air.is_none()) || (!self.air && blows(reduced, self.airspeed)) {
            return refuse(format!("air acts = {}: it does not fit to the airspeed {}", self.air, self.airspeed));
        }
        for end in self.travel.iter().flatten() {
            if loading.stops.get(end.stop).is_none_or(|stop| !stop.enabled) {
                return refuse(format!("stop = {}: there is none enabled with this index", end.stop));
            }
        }
        if self.contact.at_rest().is_some_and(|side| self.travel[side].is_none()) {
            return refuse("resting where the travel has no end".into());
        }
        let state_loads = self.state_loads(reduced)?;
        let bumpers = state_loads.map_or(0, |s| s.bumpers.len());
        if let Some(k) = self.contact.touching().into_iter().flatten().find(|k| *k >= bumpers) {
            return refuse(format!("touching = {k}: must be below {bumpers}"));
        }
        let constants = &self.applied[loading.inputs.len()..];
        if constants.iter().zip(&loading.constants).any(|(a, b)| a.to_bits() != b.to_bits()) {
            return refuse("the constant loads are not those of the parameters".into());
        }
        if let Memory::WithDissipation(
            _,
            Lookahead { step_ahead: Some(StepAhead { event: Some(Event::Regime(friction_joint)), .. }), .. },
        ) = self.memory
            && friction_joint >= state_loads.map_or(0, |s| s.friction_joints.len())
        {
            return refuse(format!("index of an event = {friction_joint}: there is no such joint with friction"));
        }
        // The energy lost is integrated if there are state loads, and in steps with inputs that change.
        if state_loads.is_some() && matches!(self.memory, Memory::Conservative(_)) {
            return refuse("the integration is not that of the parameters".into());
        }
        Ok(())
    }
}
