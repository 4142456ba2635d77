//! Model exchange: the motion as differential equations with events, which the host's solver integrates.
//!
//! The states are x = sigma, counted on over whole revolutions, and v = sigma_dot. sigma is regular everywhere, while
//! the angle of a body turns back at a dead centre. The kinetic energy is T = sigma_dot^2 / 2, so that sigma is the
//! path in m of a mass of 1 kg with the same kinetic energy. The states of controllers follow.
//!
//! In: states that the host's solver tries, events that it has found. Out: derivatives, event indicators, the state
//! after an event. What a stop does to the motion is the law of co-simulation. It must not know FMI's life cycle.
mod prescribed;
mod states;
mod transitions;

use super::{Formulation, Model, ModelError};
use crate::codec::record::{Damaged, Record};
use crate::mechanism::definition::{MOST_STATES, Method};
use crate::mechanism::motion::contact::Ends;
use crate::mechanism::motion::{MOST_REVOLUTIONS, state::State};
use crate::mechanism::outputs::OutputError;
use crate::mechanism::quantity::Indicator;
use crate::mechanism::reduced::Reduced;
use crate::numerics::decimal::Decimal;
use crate::variables::Reference;
use prescribed::Instant;
use states::joined;
use std::sync::Arc;
use transitions::{ABSENT, Transition, transition, value_of};

/// Length of the present stretch of an open curve, times which a trial state may be beyond: farther, the curve would be
/// traced for a state that a shorter step of the solver avoids.
const FARTHEST: f64 = 8.0;

/// What model exchange keeps beside the state of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exchange {
    /// States x and v at the last event or completed step of the solver.
    last: [f64; 2],
    /// States that were set, where the motion has others: the curve ends before, x is rounded, or the motion is
    /// prescribed.
    tried: Option<[f64; 2]>,
    /// Under a prescribed motion: the last event.
    event: Option<Instant>,
    /// Under a prescribed motion: its next kink, a time event.
    next: Option<Instant>,
}

impl Exchange {
    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.all_finite("states at the last event", &mut self.last)?;
        record.option("states tried", &mut self.tried, Default::default, |record, states| {
            record.all_finite("state", states)
        })?;
        for instant in [&mut self.event, &mut self.next] {
            record.option(
                "event at which the prescribed motion changes",
                instant,
                Instant::default,
                |record, instant| {
                    record.finite("time of an event", &mut instant.time)?;
                    record.finite("time since the motion is prescribed", &mut instant.since)
                },
            )?;
        }
        Ok(())
    }
}

/// Why a question of the host's solver has no answer: no value at a trial state, which a shorter step avoids, or a
/// refusal.
#[derive(Clone, Debug, PartialEq)]
pub enum NoValue {
    /// At this state.
    AtState(String),
    /// Whatever the state.
    Refused(ModelError),
}

impl From<ModelError> for NoValue {
    fn from(error: ModelError) -> Self {
        Self::Refused(error)
    }
}

/// x of a state: sigma, counted on over whole revolutions.
fn counted(reduced: &Reduced, state: &State) -> f64 {
    match state.revolutions {
        0.0 => state.sigma,
        revolutions => state.sigma + revolutions * reduced.period().unwrap_or(0.0),
    }
}

impl Model {
    /// Serve model exchange from now on.
    ///
    /// # Errors
    /// A hydraulic circuit has states that are not told.
    pub fn serve_exchange(&mut self) -> Result<(), ModelError> {
        if self.continuous_time().is_none() {
            let reason = match self.original.reduced.linkage().is_massless {
                true => "a mechanism without masses has no continuous states; use co-simulation",
                false => "the states of a hydraulic circuit are integrated together with the motion; use co-simulation",
            };
            return Err(ModelError::Derivative { what: "model exchange".into(), reason: reason.into() });
        }
        self.exchange = Some(Exchange::default());
        Ok(())
    }

    /// The motion starts: for model exchange from its first states.
    ///
    /// # Errors
    /// The finite elements have more states.
    pub(super) fn begin_exchange(&mut self) -> Result<(), ModelError> {
        if self.exchange.is_none() {
            return Ok(());
        }
        if self.parameter_values.method() == Method::RigidFem {
            let reason = "solver.method = \"rigid_fem\" supports co-simulation only; choose solver.method = \
                          \"reduced\""
                .into();
            return Err(ModelError::Derivative { what: "model exchange".into(), reason });
        }
        self.exchange = Some(Exchange::default());
        Ok(())
    }

    /// The continuous states x and v.
    fn states_of_motion(&mut self) -> Result<[f64; 2], ModelError> {
        let tried = self.exchange.and_then(|exchange| exchange.tried);
        let (state, reduced) = self.shown()?;
        Ok(tried.unwrap_or_else(|| [counted(reduced, state), state.sigma_dot]))
    }

    /// The continuous states: [`Self::state_count`] numbers, then zeros.
    ///
    /// # Errors
    /// The present parameters give no mechanism.
    pub fn continuous_states(&mut self) -> Result<[f64; MOST_STATES], ModelError> {
        let motion = self.states_of_motion()?;
        let controllers = self.shown()?.0.memory.controllers();
        Ok(joined(motion, controllers.map_or(&[], |all| all)))
    }

    /// Take the states that the host's solver tries; those that are not given stay. Where the curve ends at a rigid
    /// stop, the derivatives are continued beyond with those at its end.
    ///
    /// # Errors
    /// A state that is not finite, or beyond an end of the curve where no rigid stop is; nothing has changed.
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Result<(), NoValue> {
        let before = self.states_of_motion()?;
        let is_prescribed = self.is_prescribed();
        let (Some(Formulation::Reduced(motion)), Some(reduced), Some(exchange)) =
            (&mut self.state, &self.reduced, &mut self.exchange)
        else {
            return Err(ModelError::NotInitialised.into());
        };
        let [x, v, ref controllers @ ..] = *states else { return Err(ModelError::NotInitialised.into()) };
        if !(x.is_finite() && v.is_finite()) {
            return Err(NoValue::AtState(format!(
                "the continuous states are {} and {}; both states must be finite",
                Decimal(x),
                Decimal(v)
            )));
        }
        if let Some(value) = controllers.iter().find(|value| !value.is_finite()) {
            let why = format!("a state of a controller is {}; it must be finite", Decimal(*value));
            return Err(NoValue::AtState(why));
        }
        if is_prescribed {
            exchange.tried = Some([x, v]);
            return Ok(());
        }
        let state = &motion.state;
        let (sigma, revolutions) = if x.to_bits() == before[0].to_bits() {
            (state.sigma, state.revolutions)
        } else {
            place(reduced, state, x)?
        };
        if !controllers.is_empty() {
            motion.state.memory.set_controllers(controllers);
        }
        motion.move_to(sigma, v, revolutions);
        exchange.tried = (counted(reduced, &motion.state) != x).then_some([x, v]);
        Ok(())
    }

    /// Time derivatives of the states; 0 where the mechanism is held.
    ///
    /// # Errors
    /// The acceleration has no value at this state.
    pub fn derivatives(&mut self) -> Result<[f64; MOST_STATES], NoValue> {
        let motion = self.derivatives_of_states()?;
        let (Some(Formulation::Reduced(state)), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised.into());
        };
        if state.state.memory.controllers().is_none() {
            return Ok(joined(motion, &[]));
        }
        match state.read(reduced, &self.inputs, |view| view.circuit_rates()) {
            Ok(rates) => Ok(joined(motion, &rates[..MOST_STATES - 2])),
            Err(error) => Err(self.no_derivatives(Err(error))),
        }
    }

    /// Time derivatives of x and v; 0 where the mechanism is held.
    fn derivatives_of_states(&mut self) -> Result<[f64; 2], NoValue> {
        self.state()?;
        if self.is_prescribed() {
            return self.prescribed_derivatives();
        }
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised.into());
        };
        let speed = motion.state.sigma_dot;
        match motion.read(reduced, &self.inputs, |view| view.forces().copied()) {
            Ok(forces) if forces.held.is_some() => Ok([0.0; 2]),
            Ok(forces) if forces.acceleration.is_finite() => Ok([speed, forces.acceleration]),
            other => Err(self.no_derivatives(other.map(|forces| forces.acceleration))),
        }
    }

    /// Why the acceleration, which is this, has no value.
    fn no_derivatives(&self, acceleration: Result<f64, OutputError>) -> NoValue {
        let why = self.reason(acceleration).unwrap_or_default();
        NoValue::AtState(format!("the derivatives of the continuous states cannot be computed: {why}"))
    }

    /// x, v, or the time derivative of v; NaN where that has no value.
    ///
    /// # Errors
    /// The present parameters give no mechanism.
    pub(super) fn state_of_motion(&mut self, order: usize) -> Result<f64, ModelError> {
        if order < 2 {
            return Ok(self.states_of_motion()?[order]);
        }
        self.state()?;
        let (Some(Formulation::Reduced(_)), Some(_)) = (&self.state, &self.reduced) else { return Ok(f64::NAN) };
        match self.derivatives_of_states() {
            Ok(derivatives) => Ok(derivatives[1]),
            Err(NoValue::AtState(_)) => Ok(f64::NAN),
            Err(NoValue::Refused(error)) => Err(error),
        }
    }

    /// Present value of an event indicator, not 0; NaN where it has none.
    ///
    /// # Errors
    /// The present parameters give no mechanism.
    pub(super) fn indicator(&mut self, indicator: Indicator) -> Result<f64, ModelError> {
        let [x, v] = self.states_of_motion()?;
        if self.is_prescribed() {
            return Ok(ABSENT);
        }
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Ok(ABSENT);
        };
        let locks = &self.inputs.locks;
        let value = motion.read(reduced, &self.inputs, |view| value_of(view, locks, indicator, [x, v]));
        Ok(match value {
            Ok(0.0) => f64::MIN_POSITIVE,
            Ok(value) if value.is_finite() => value,
            _ => f64::NAN,
        })
    }

    /// Why a state, its derivative or an event indicator has no value in the present state; None if it has one.
    #[cold]
    pub(super) fn undefined_exchange(&mut self, reference: Reference) -> Option<String> {
        if !self.real(reference).is_ok_and(f64::is_nan) {
            return None;
        }
        if matches!(self.state, Some(Formulation::RigidFem(_))) {
            return Some(
                "solver.method = \"rigid_fem\" has no acceleration along the motion of a rigid mechanism; read the \
                 acceleration of a body"
                    .into(),
            );
        }
        match self.derivatives() {
            Err(NoValue::AtState(why)) => Some(why),
            _ => Some("not smooth at this state".into()),
        }
    }

    /// A step of the host's solver is complete: whether event mode is to be entered, as a transition is due.
    ///
    /// # Errors
    /// Not initialised.
    pub fn completed_step(&mut self) -> Result<bool, ModelError> {
        self.adopt_prescribed();
        let is_due = self.due()?.is_some();
        if self.watched.watches {
            self.watch_contacts(None);
        }
        if !is_due {
            self.remember()?;
        }
        Ok(is_due)
    }

    /// Make the transitions that are due, at the time `point` [s] of the host. Returns whether the states have changed.
    ///
    /// # Errors
    /// The state after a transition cannot be computed.
    pub(super) fn update_discrete_states(&mut self, point: Option<f64>) -> Result<bool, ModelError> {
        let before = self.states_of_motion()?;
        self.update_prescribed(point)?;
        if let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) {
            let travel = Arc::clone(&motion.state.travel);
            let locked = motion.state.ends(reduced, &self.inputs.locks).locked;
            let ends = Ends::new(&travel, 0.0, locked);
            motion.state.contact.locks_set(&ends);
        }
        let most = 8 + 4 * self.original.parameter_values.mechanism().stops.len();
        for _ in 0..most {
            let Some(transition) = self.due()? else { break };
            self.make(transition, point)?;
            self.remember()?;
        }
        self.remember()?;
        Ok(self.states_of_motion()? != before)
    }

    /// In model exchange, the present states are those from which the solver goes on.
    pub(super) fn remember(&mut self) -> Result<(), ModelError> {
        if self.exchange.is_none() {
            return Ok(());
        }
        let last = self.states_of_motion()?;
        if let Some(exchange) = &mut self.exchange {
            exchange.last = last;
        }
        Ok(())
    }

    /// The next transition that is due, if there is one. What has no value at this state is not due.
    fn due(&mut self) -> Result<Option<Transition>, ModelError> {
        let now = self.states_of_motion()?;
        if self.is_prescribed() {
            return Ok(None);
        }
        let (Some(Formulation::Reduced(motion)), Some(reduced), Some(exchange)) =
            (&mut self.state, &self.reduced, &self.exchange)
        else {
            return Err(ModelError::NotInitialised);
        };
        let (last, locks) = (exchange.last, &self.inputs.locks);
        let due = motion.read(reduced, &self.inputs, |view| {
            let engaged = locks.iter().any(|engaged| *engaged);
            transition(view, engaged.then_some(&locks[..]), last, now)
        });
        Ok(due.ok().flatten())
    }

    /// Make a transition.
    fn make(&mut self, transition: Transition, point: Option<f64>) -> Result<(), ModelError> {
        let (Some(Formulation::Reduced(motion)), Some(exchange)) = (&mut self.state, &mut self.exchange) else {
            return Err(ModelError::NotInitialised);
        };
        let (state, tried) = (&mut motion.state, exchange.tried.take());
        match transition {
            Transition::Arrive(place) => {
                state.contact.arrives(place);
                if let Err(error) = self.follow_arrival(point) {
                    if let Some(Formulation::Reduced(motion)) = &mut self.state {
                        motion.state.contact.take_arrival();
                    }
                    self.exchange = self.exchange.map(|exchange| Exchange { tried, ..exchange });
                    return Err(error);
                }
                return Ok(());
            }
            Transition::Release(place) => {
                state.contact.released();
                let other = state.travel.places().find(|(other, position)| {
                    *other != place && other.bumper().is_none() && state.travel.position(place) == Some(*position)
                });
                if let Some((other, _)) = other {
                    state.contact.rests(other, false);
                }
            }
            Transition::Engage(place) => {
                state.contact.engages(place);
                // The places of locks are found anew with the next step.
                state.applied.version = 0;
                if let Some(reduced) = &self.reduced {
                    let (travel, locked) = (Arc::clone(&state.travel), state.ends(reduced, &self.inputs.locks).locked);
                    state.contact.locks_set(&Ends::new(&travel, 0.0, locked));
                }
            }
            Transition::Touch(bumper) => state.contact.touched(bumper),
            Transition::LetGo(bumper) => state.contact.let_go(bumper),
            Transition::Surface { side, surface, speed } => {
                state.sigma_dot = speed;
                state.contact.set_surface([side, surface]);
            }
            Transition::Halt => state.sigma_dot = 0.0,
        }
        Ok(())
    }
}

/// sigma and the whole revolutions before it, at x.
fn place(reduced: &Reduced, state: &State, x: f64) -> Result<(f64, f64), NoValue> {
    let (first, last) = reduced.curve().range;
    if let Some(period) = reduced.period() {
        let revolutions = ((x - first) / period).floor();
        if revolutions.abs() > MOST_REVOLUTIONS {
            let why = format!(
                "the position state of the mechanism is {} m, which is more revolutions than the program can count",
                Decimal(x)
            );
            return Err(NoValue::AtState(why));
        }
        return Ok(((x - revolutions * period).clamp(first, last), revolutions));
    }
    let too_far = |end: f64| {
        let (x, end, at) = (Decimal(x), Decimal(end), state.describe(reduced));
        let why = format!(
            "the position state of the mechanism is {x} m, beyond the end of the travel at {end} m; the previous \
             position was {at}; use a shorter step"
        );
        Err(NoValue::AtState(why))
    };
    let (low, high) = reduced.at(state.sigma).curve().range;
    let margin = FARTHEST * (high - low);
    if reduced.is_open() && !(low - margin..=high + margin).contains(&x) {
        return too_far(if x < low { low - margin } else { high + margin });
    }
    match reduced.reach(x) {
        Ok(_) => Ok((x, 0.0)),
        Err((stretch, _)) => {
            let (low, high) = stretch.curve().range;
            let (side, end) = if x < low { (0, low) } else { (1, high) };
            match state.travel.rigid[side] {
                Some(_) => Ok((end, 0.0)),
                None => too_far(end),
            }
        }
    }
}
