//! Model exchange under a prescribed motion: a function of time or of inputs, whose kinks are time events.
//!
//! The solver of the host integrates x_dot = v and v_dot = sigma_ddot as ever, so that it has the states of the motion
//! when that is prescribed no longer; but all outputs are those at the position and speed that are prescribed, to
//! rounding. Each event takes the states there. In: the time of the host. Out: the state at this time, the next kink.
//! It must not know FMI's life cycle.
use super::{Exchange, Formulation, Model, ModelError, NoValue};
use crate::mechanism::loads::laws::profile::Profile;

/// An event: the host's time [s], and the time since the motion is prescribed [s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant {
    pub(super) time: f64,
    pub(super) since: f64,
}

impl Model {
    /// Whether the motion of a drive is prescribed.
    pub(in crate::mechanism::model) fn is_prescribed(&self) -> bool {
        self.original.reduced.loading().motion.is_some() && self.inputs.prescribes()
    }

    /// Follow the travel without time from now on: positions and speeds along the curve are set as the states of model
    /// exchange, whether or not a drive has a motion.
    ///
    /// # Errors
    /// A hydraulic circuit has states of its own.
    pub fn serve_travel(&mut self) -> Result<(), ModelError> {
        if !self.original.reduced.can_prescribe() {
            return self.serve_exchange();
        }
        self.inputs.locks.last_mut().into_iter().for_each(|is_prescribed| *is_prescribed = false);
        self.exchange = Some(Exchange::default());
        Ok(())
    }

    /// The host's solver asks for values at this time [s]. At a kink of a profile they are those before it, until the
    /// event is handled.
    pub fn set_time(&mut self, time: f64) {
        let (Some(exchange), Some(Formulation::Reduced(motion)), Some(reduced)) =
            (&mut self.exchange, &mut self.state, &self.reduced)
        else {
            return;
        };
        let Some(drive) = reduced.loading().motion.as_ref().filter(|_| self.inputs.prescribes()) else { return };
        let event = *exchange.event.get_or_insert(Instant { time, since: 0.0 });
        let kink = exchange.next.filter(|next| next.time == time);
        let since = match (kink, &drive.profile) {
            (Some(kink), Some(profile)) => profile.just_before(kink.since),
            _ => event.since + (time - event.time),
        };
        motion.state.set_time(since);
    }

    /// Time of the next kink of a prescribed motion [s]; none if none follows.
    pub fn next_event(&self) -> Option<f64> {
        Some(self.exchange?.next?.time)
    }

    /// A step of the host's solver has led to where the motion is prescribed now.
    pub(in crate::mechanism::model) fn adopt_prescribed(&mut self) {
        if let (true, Some(_), Some(Formulation::Reduced(motion)), Some(reduced)) =
            (self.is_prescribed(), self.exchange, &mut self.state, &self.reduced)
        {
            motion.adopt(reduced, &self.inputs);
        }
    }

    /// x_dot and v_dot under a prescribed motion.
    pub(super) fn prescribed_derivatives(&mut self) -> Result<[f64; 2], NoValue> {
        let [_, speed] = self.states_of_motion()?;
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised.into());
        };
        match motion.demanded(reduced, &self.inputs) {
            Ok(acceleration) if acceleration.is_finite() => Ok([speed, acceleration]),
            other => Err(self.no_derivatives(other)),
        }
    }

    /// In event mode, at the time `point` [s] of the host: the states are those that are prescribed; a motion is
    /// prescribed from now on, or no longer; the next kink is found.
    ///
    /// # Errors
    /// The mechanism is not where its motion is now prescribed to be; nothing has changed.
    pub(super) fn update_prescribed(&mut self, point: Option<f64>) -> Result<(), ModelError> {
        let (Some(exchange), Some(Formulation::Reduced(motion)), Some(reduced)) =
            (&mut self.exchange, &mut self.state, &self.reduced)
        else {
            return Ok(());
        };
        let (Some(drive), Some(before)) = (&reduced.loading().motion, motion.state.prescribed) else { return Ok(()) };
        let (was_active, is_active) = (before.is_active, self.inputs.prescribes());
        if was_active != is_active {
            motion.switch(reduced, &self.inputs)?;
        }
        if !(was_active || is_active) {
            return Ok(());
        }
        (exchange.tried, exchange.event) = (None, None);
        let next = exchange.next.take();
        let Some(time) = point.filter(|_| is_active) else { return Ok(()) };
        let since = match next.filter(|next| was_active && next.time == time) {
            Some(kink) => kink.since,
            None if was_active => before.time.now,
            None => 0.0,
        };
        motion.state.set_time(since);
        motion.adopt(reduced, &self.inputs);
        let event = Instant { time, since };
        exchange.event = Some(event);
        exchange.next = drive.profile.as_ref().and_then(|profile| next_kink(profile, event));
        Ok(())
    }
}

/// The first kink of a profile after an event, at a later time.
fn next_kink(profile: &Profile, event: Instant) -> Option<Instant> {
    let mut passed = 0.0;
    loop {
        passed = profile.next_kink([event.since, 0.0], passed);
        let time = event.time + passed;
        if passed == f64::INFINITY {
            return None;
        }
        if time > event.time {
            return Some(Instant { time, since: event.since + passed });
        }
    }
}
