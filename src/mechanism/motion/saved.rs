//! Saved states: the part of a state of motion that decides how it continues.
//!
//! In: a state, or a record. Out: a state that continues bit for bit as the saved one would have. It must not know
//! outputs.
use super::memory::Memory;
use super::state::{State, blows, state_loads, state_loads_in_air};
use crate::codec::record::{Damaged, Record};
use crate::mechanism::dynamics::equation::Scratch;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::contact::Contact;
use crate::mechanism::motion::ends::{End, StopKind, Travel};
use crate::mechanism::motion::events::Event;
use crate::mechanism::motion::step_ahead::{Lookahead, StepAhead};
use crate::mechanism::motion::travel::stop_kind;
use crate::mechanism::reduced::Reduced;
use crate::numerics::bits::{become_same, same_bits};

/// Part of a closed curve's length by which sigma may be beyond its ends by rounding.
const ROUNDING: f64 = 1e-12;
/// Most revolutions, so that one more of them still counts.
const MOST_REVOLUTIONS: f64 = 1e15;

/// A [`State`] without what is derived from it.
#[derive(Clone, Debug)]
pub struct SavedState {
    sigma: f64,
    sigma_dot: f64,
    revolutions: f64,
    contact: Contact,
    travel: Travel,
    applied: Vec<f64>,
    airspeed: f64,
    reference: f64,
    memory: Memory,
}

impl State {
    /// The part that decides how the state continues.
    pub fn saved(&self) -> SavedState {
        SavedState {
            sigma: self.sigma,
            sigma_dot: self.sigma_dot,
            revolutions: self.revolutions,
            contact: self.contact,
            travel: self.travel,
            applied: self.applied.clone(),
            airspeed: self.airspeed,
            reference: self.reference,
            memory: self.memory,
        }
    }

    /// [`Self::saved`] written over another one, without allocation.
    #[inline]
    pub fn save(&self, saved: &mut SavedState) {
        (saved.sigma, saved.sigma_dot, saved.revolutions) = (self.sigma, self.sigma_dot, self.revolutions);
        (saved.contact, saved.travel) = (self.contact, self.travel);
        become_same(&mut saved.applied, &self.applied);
        (saved.airspeed, saved.reference) = (self.airspeed, self.reference);
        saved.memory.copy_from(&self.memory);
    }

    /// A state that continues as the saved one did, under these inputs.
    ///
    /// # Errors
    /// [`ModelError::Table`]: a reaction that causes friction is not smooth.
    pub fn from_saved(saved: &SavedState, reduced: &Reduced, inputs: &Inputs) -> Result<Self, ModelError> {
        state_loads(reduced, inputs, saved.revolutions)?;
        let then = state_loads_in_air(reduced, saved.airspeed, saved.revolutions)?;
        Ok(Self {
            sigma: saved.sigma,
            sigma_dot: saved.sigma_dot,
            revolutions: saved.revolutions,
            contact: saved.contact,
            travel: saved.travel,
            applied: saved.applied.clone(),
            before: saved.applied.clone(),
            airspeed: saved.airspeed,
            reference: saved.reference,
            memory: saved.memory,
            scratch: Scratch::new(then),
        })
    }

    /// [`Self::from_saved`] in place, with the same reduced model; without allocation unless air has begun or ceased to
    /// act.
    ///
    /// # Errors
    /// As [`Self::from_saved`]; nothing has changed.
    #[inline]
    pub fn restore(&mut self, saved: &SavedState, reduced: &Reduced) -> Result<(), ModelError> {
        if blows(reduced, saved.airspeed) != self.scratch.air {
            self.renew_scratch(saved, reduced)?;
        }
        if !same_bits(&saved.applied, &self.applied) {
            self.applied.copy_from_slice(&saved.applied);
            self.scratch.panel_force.invalidate();
        }
        if saved.revolutions != self.revolutions {
            self.scratch.panel_force.invalidate();
        }
        (self.sigma, self.sigma_dot, self.revolutions) = (saved.sigma, saved.sigma_dot, saved.revolutions);
        (self.contact, self.travel) = (saved.contact, saved.travel);
        (self.airspeed, self.reference) = (saved.airspeed, saved.reference);
        self.memory.copy_from(&saved.memory);
        Ok(())
    }

    #[cold]
    fn renew_scratch(&mut self, saved: &SavedState, reduced: &Reduced) -> Result<(), ModelError> {
        let then = state_loads_in_air(reduced, saved.airspeed, saved.revolutions)?;
        if then.is_some_and(|s| s.air) != self.scratch.air {
            self.scratch = Scratch::new(then);
        }
        Ok(())
    }
}

impl SavedState {
    /// Read one for this reduced model.
    ///
    /// # Errors
    /// A field is not what this mechanism can have.
    pub fn read(record: &mut Record, reduced: &Reduced) -> Result<Self, ModelError> {
        let mut saved = Self {
            sigma: 0.0,
            sigma_dot: 0.0,
            revolutions: 0.0,
            contact: Contact::default(),
            travel: Travel::default(),
            applied: vec![0.0; reduced.components().sized],
            airspeed: 0.0,
            reference: 0.0,
            memory: Memory::new(false),
        };
        saved.record(record)?;
        saved.check(reduced)?;
        for end in saved.travel.iter_mut().flatten() {
            end.kind = stop_kind(reduced.loading(), end.stop);
        }
        Ok(saved)
    }

    /// All fields, written or read.
    ///
    /// # Errors
    /// A field is read that no state has.
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
        record.finite("energy", &mut self.reference)?;
        let mut with_dissipation = matches!(self.memory, Memory::WithDissipation(..));
        record.flag("lossy", &mut with_dissipation)?;
        if record.reads() && with_dissipation {
            self.memory = Memory::new(true);
        }
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
        for end in self.travel.iter().flatten() {
            if loading.stops.get(end.stop).is_none_or(|stop| !stop.enabled) {
                return refuse(format!("stop = {}: there is none enabled with this index", end.stop));
            }
        }
        if self.contact.at_rest().is_some_and(|side| self.travel[side].is_none()) {
            return refuse("resting where the travel has no end".into());
        }
        let state_loads = state_loads_in_air(reduced, self.airspeed, self.revolutions)?;
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
