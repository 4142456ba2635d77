//! The start: the state that the definition states.
//!
//! In: the definition's start, inputs, a reduced model. Out: a state at rest or in motion, with the travel between the
//! stops. It must not know steps.
use super::circuit::begin_hydraulics;
use super::inputs::{Before, engaged_locks};
use super::ports::check_ports;
use super::{Counted, State, check_length, rates};
use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::dynamics::equation::Scratch;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::acting::{airspeed, blows_under, state_loads};
use crate::mechanism::motion::contact::{Contact, Place, Travel};
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::equilibrium::{AtRest, NoEquilibrium};
use crate::mechanism::motion::impacts::Impacts;
use crate::mechanism::motion::travel::{beyond_stop, can_hold, pressed_bumpers, travel, within_stops};
use crate::mechanism::motion::witness::Witness;
use crate::mechanism::reduced::{Reduced, ReductionError, Stated};
use crate::numerics::decimal::Decimal;
use std::sync::Arc;

/// The start as the parameters alone decide it: where the mechanism is, how fast, and its travel between the stops.
#[derive(Clone, Debug)]
pub struct Start {
    sigma: f64,
    sigma_dot: f64,
    revolutions: f64,
    /// Where it rests, if it starts at rest exactly at a stop.
    resting: Option<Place>,
    travel: Arc<Travel>,
}

impl Start {
    /// The start that a definition states.
    ///
    /// # Errors
    /// The start is not on the curve, or beyond a rigid stop; its speed is stated at a toggle; a lock holds nothing;
    /// the drive's cylinder does not have its length.
    pub fn new(reduced: &Reduced, mechanism: &Mechanism) -> Result<Self, ModelError> {
        let start = &mechanism.start;
        let linkage = reduced.linkage();
        if start.is_at_guess() {
            // A guess is rough, and a drawing rounded: the equilibrium is sought on this side of the stops.
            let (sigma, revolutions) = reduced.unwound(within_stops(reduced)?);
            return Self::resting(reduced, sigma, revolutions, None);
        }
        let Stated { coordinate, value, name, quantity } = Stated::new(mechanism, linkage);
        let variable = format!("{name}.start_{quantity}");
        let coordinate = coordinate.ok_or_else(|| {
            let allowed = format!("use one of the coordinates {}", linkage.coordinates.join(", "));
            ModelError::Definition(DefinitionError::unknown("start", name, allowed))
        })?;
        // Before the search for the start, as the curve may end at a stop of the body whose angle states the start.
        for (stop, angle) in reduced.own_stops(mechanism) {
            beyond_stop(stop, angle)?;
        }
        let stated = start.angle.or(start.position).unwrap_or(0.0);
        let (sigma, revolutions) = reduced.find(coordinate, value, &variable).map_err(|e| e.as_stated(stated))?;
        let mut begun = Self::resting(reduced, sigma, revolutions, None)?;
        if !start.equilibrium {
            begun.set_off(reduced, mechanism)?;
        }
        Ok(begun)
    }

    /// At rest at a position, with the travel around it or one that is known.
    fn resting(
        reduced: &Reduced,
        sigma: f64,
        revolutions: f64,
        known: Option<Arc<Travel>>,
    ) -> Result<Self, ModelError> {
        check_length(reduced, sigma, revolutions)?;
        let travel = match known {
            Some(travel) => travel,
            None => Arc::new(travel(reduced, sigma, revolutions)?),
        };
        let shift = revolutions * reduced.period().unwrap_or(0.0);
        let mut sigma = sigma;
        let mut resting = None;
        if let Some((place, position)) = travel.places().find(|(_, position)| *position == sigma + shift) {
            // What is at a place is known by equal numbers in the frame of sigma.
            sigma = position - shift;
            resting = Some(place);
        }
        can_hold(reduced, &travel)?;
        Ok(Self { sigma, sigma_dot: 0.0, revolutions, resting, travel })
    }

    /// Set off with the stated speed.
    fn set_off(&mut self, reduced: &Reduced, mechanism: &Mechanism) -> Result<(), ModelError> {
        let speed = mechanism.start.speed;
        let Stated { coordinate: Some(coordinate), name, quantity, .. } = Stated::new(mechanism, reduced.linkage())
        else {
            return Ok(());
        };
        if speed == 0.0 {
            return Ok(());
        }
        let variable = format!("{name}.start_{quantity}");
        // The table is exact where branches cross, too. Within some 1e-13 rad of a toggle, where the slope is below
        // 1e-6, the slope is rounding.
        let stretch = reduced.at(self.sigma);
        let table = stretch.coordinates().map_err(|at| ModelError::table(stretch, &variable, at, self.revolutions))?;
        let slope = table.value(table.position(self.sigma), 3 * coordinate + 1);
        if slope.abs() * reduced.scale() < 1e-6 {
            let name = format!("{name}.start_speed");
            return Err(ReductionError::StartSpeed { name, value: speed }.into());
        }
        self.sigma_dot = speed / slope;
        self.resting = self.resting.filter(|_| self.sigma_dot == 0.0);
        Ok(())
    }

    /// The stable equilibrium under these inputs that is nearest to this start, with the stated speed.
    fn at_equilibrium(&self, reduced: &Reduced, mechanism: &Mechanism, inputs: &Inputs) -> Result<Self, ModelError> {
        let here = self.sigma + self.revolutions * reduced.period().unwrap_or(0.0);
        let found = AtRest::new(reduced, &self.travel, inputs, here)?.nearest(here).map_err(|none| {
            let near = reduced.describe(self.sigma, self.revolutions);
            let (reason, remedy) = match none {
                NoEquilibrium::Neutral => {
                    ("no load acts at rest, so every position is an equilibrium".to_owned(), "give a start position")
                }
                NoEquilibrium::None => (
                    "the loads move the mechanism at every position".to_owned(),
                    "add a spring or a stop that holds the mechanism at rest, or change the start values of the \
                     inputs so that an equilibrium exists",
                ),
            };
            ModelError::NoEquilibrium { near, reason, remedy }
        })?;
        let (sigma, revolutions) = reduced.unwound(found.position);
        let mut begun = Self::resting(reduced, sigma, revolutions, Some(Arc::clone(&self.travel)))?;
        begun.resting = begun.resting.or(found.place);
        begun.set_off(reduced, mechanism)?;
        Ok(begun)
    }
}

impl State {
    /// The state that a definition states.
    ///
    /// # Errors
    /// As [`Start::new`] and [`Self::from_start`].
    pub fn at_start(reduced: &Reduced, mechanism: &Mechanism, inputs: &Inputs) -> Result<Self, ModelError> {
        Self::from_start(&Start::new(reduced, mechanism)?, reduced, mechanism, inputs)
    }

    /// The state at a start under these inputs.
    ///
    /// # Errors
    /// As [`Self::put_at_start`].
    pub fn from_start(
        start: &Start,
        reduced: &Reduced,
        mechanism: &Mechanism,
        inputs: &Inputs,
    ) -> Result<Self, ModelError> {
        let state_loads = state_loads(reduced.at(start.sigma), blows_under(reduced, inputs), start.revolutions)?;
        let witness = Witness::new(reduced.loading().stops.len());
        let (saved, before, scratch) = (Counted::default(), Before::default(), Scratch::new(state_loads));
        let mut state = Self { saved, before, scratch, witness, rates: rates(reduced), is_retuned: false };
        state.put_at_start(start, reduced, mechanism, inputs)?;
        Ok(state)
    }

    /// [`Self::from_start`] in place, from a state of the same reduced model; without allocation unless air has begun
    /// or ceased to act. On an error the state is of no use.
    ///
    /// # Errors
    /// [`ModelError::Table`]: a reaction that causes friction is not smooth; a circuit cannot begin so; the energy
    /// overflows; there is no equilibrium.
    pub fn put_at_start(
        &mut self,
        start: &Start,
        reduced: &Reduced,
        mechanism: &Mechanism,
        inputs: &Inputs,
    ) -> Result<(), ModelError> {
        let found = match mechanism.start.equilibrium {
            true => Some(start.at_equilibrium(reduced, mechanism, inputs)?),
            false => None,
        };
        let start = found.as_ref().unwrap_or(start);
        let air = blows_under(reduced, inputs);
        let state_loads = state_loads(reduced.at(start.sigma), air, start.revolutions)?;
        self.renew_scratch(state_loads);
        self.witness.forget();
        // Nothing is to be applied with the first step, unless it is to be refused then.
        let is_applied = check_ports(reduced, inputs, 0.0).is_ok();
        let Self { saved, before, .. } = self;
        let saved = &mut **saved;
        (saved.sigma, saved.sigma_dot, saved.revolutions) = (start.sigma, start.sigma_dot, start.revolutions);
        let here = start.sigma + start.revolutions * reduced.period().unwrap_or(0.0);
        saved.contact = Contact::at_start(start.resting);
        saved.contact.set_touching(pressed_bumpers(reduced, &start.travel, here, start.sigma_dot));
        if !Arc::ptr_eq(&saved.travel, &start.travel) {
            saved.travel = Arc::clone(&start.travel);
        }
        let applied = &mut saved.applied;
        reduced.sizes_into(&inputs.reals, &mut applied.sizes);
        (applied.airspeed, applied.air) = (airspeed(reduced, inputs), air);
        applied.version = if is_applied { inputs.version() } else { 0 };
        saved.time = Elapsed::default();
        saved.impacts.clear();
        saved.impacts.resize(reduced.loading().stops.len(), Impacts::default());
        match begin_hydraulics(mechanism, reduced, inputs, [start.sigma, start.revolutions])? {
            Some(memory) => saved.memory = memory,
            None => saved.memory.begin(state_loads.is_some()),
        }
        let locks = (&*inputs.locks, saved.contact.engaged());
        saved.applied.locked = engaged_locks(&start.travel, reduced, locks, saved.memory.network_values());
        before.applied.sizes.resize(saved.applied.sizes.len(), 0.0);
        if reduced.can_prescribe() {
            self.begin_prescribed(reduced, inputs)?;
        }
        let (kinetic, potential) =
            (self.kinetic(), self.load_potential(reduced, |load| self.displacement(reduced, load)));
        self.reference = kinetic + potential;
        if self.reference.is_finite() {
            return Ok(());
        }
        let [kinetic, potential] = [kinetic, potential].map(Decimal::rounded);
        let name = format!("the energy at the start (kinetic {kinetic} J, potential of the loads {potential} J)");
        Err(ModelError::Overflow { name })
    }
}
