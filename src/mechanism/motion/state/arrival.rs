//! The end of a step: sigma within the curve, whole revolutions counted, the energy lost booked.
//!
//! In: how far a step has come. Out: the state there, or why the motion cannot be there; of a step that met its bound,
//! what took so many steps. It must not know how a step is made.
use super::State;
use crate::mechanism::definition::Solver;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::advance::Progress;
use crate::mechanism::motion::contact::Contact;
use crate::mechanism::motion::fast_forward::Waypoint;
use crate::mechanism::motion::saved::MOST_REVOLUTIONS;
use crate::mechanism::motion::step_ahead::Outdated;
use crate::mechanism::motion::work::Spent;
use crate::mechanism::reduced::{End, Reduced, ReductionError};
use crate::numerics::table::Unresolved;

/// Counts before a step, for the description of its work.
pub(super) struct Begin {
    pub(super) revolutions: f64,
    /// Steps that the integration has accepted and rejected.
    pub(super) tried: [u64; 2],
}

/// How far a step has come.
pub(super) struct Arrival {
    /// (sigma, sigma_dot), with sigma perhaps beyond the ends of a closed curve.
    pub(super) y: [f64; 2],
    /// Energy lost in the step [J].
    pub(super) lost: f64,
    pub(super) contact: Contact,
    /// Revolutions that sigma does not count.
    pub(super) passed: f64,
}

impl State {
    /// Take over the end of a step, with sigma within the curve.
    ///
    /// # Errors
    /// The motion or the revolutions overflow, or an open curve was left; nothing has changed.
    #[inline(always)]
    pub(super) fn arrive(&mut self, reduced: &Reduced, arrival: &Arrival) -> Result<(), ModelError> {
        let &Arrival { y, lost, contact, passed } = arrival;
        self.arrive_at(reduced, y, lost, passed)?;
        self.contact = contact;
        Ok(())
    }

    /// [`Self::arrive`] with the same contact.
    ///
    /// # Errors
    /// As [`Self::arrive`].
    #[inline(always)]
    pub(super) fn arrive_at(
        &mut self,
        reduced: &Reduced,
        mut y: [f64; 2],
        lost: f64,
        passed: f64,
    ) -> Result<(), ModelError> {
        if !(y[1] + lost).is_finite() || !(self.reference - lost).is_finite() {
            return Err(ModelError::Overflow { name: "the motion at the end of the step".into() });
        }
        let (first, last) = reduced.curve().range;
        if passed != 0.0 || !(first..last).contains(&y[0]) {
            y[0] = self.count_revolutions(reduced, y[0], passed)?;
        }
        let saved = &mut *self.saved;
        [saved.sigma, saved.sigma_dot] = y;
        saved.reference -= lost;
        Ok(())
    }

    /// From the start to a state on the way, in which nothing holds the mechanism.
    ///
    /// # Errors
    /// As [`Self::arrive`]; the contact is that of a mechanism that is free.
    pub fn go_to(
        &mut self,
        reduced: &Reduced,
        &Waypoint { sigma, sigma_dot, .. }: &Waypoint,
    ) -> Result<(), ModelError> {
        self.contact.released();
        self.arrive_at(reduced, [sigma, sigma_dot], 0.0, 0.0)
    }

    /// Refuse a state beyond an end of the curve, or on a stretch of it with state loads that are not smooth.
    #[cold]
    fn arrive_beyond(&self, reduced: &Reduced, sigma: f64) -> Result<(), ModelError> {
        let stretch = reduced.reach(sigma).map_err(|end| ModelError::travel(end, sigma))?;
        let failed = |at: &Unresolved| {
            let (position, what) = (stretch.curve().describe(at.sigma, 0.0), "friction".into());
            ModelError::travel((stretch, End::Failed(&ReductionError::Table { what, position })), sigma)
        };
        stretch.state_loads(self.applied.air).map_err(failed).map(|_| ())
    }

    /// sigma within the first revolution of a closed curve, with the others counted.
    ///
    /// # Errors
    /// The revolutions overflow, or an open curve was left; nothing has changed.
    #[cold]
    fn count_revolutions(&mut self, reduced: &Reduced, sigma: f64, passed: f64) -> Result<f64, ModelError> {
        let (first, last) = reduced.curve().range;
        let Some(period) = reduced.period() else {
            return self.arrive_beyond(reduced, sigma).map(|()| sigma);
        };
        let revolutions = ((sigma - first) / period).floor();
        let all = self.revolutions + revolutions + passed;
        if all.is_nan() || all.abs() > MOST_REVOLUTIONS {
            return Err(ModelError::Overflow { name: "the number of revolutions".into() });
        }
        let shift = self.revolutions * period;
        let place = self.travel.places().find(|(_, position)| position - shift == sigma);
        self.revolutions = all;
        // A step ahead is counted on over whole revolutions, but sigma is not any more.
        self.memory.drop_outdated(Outdated::Count);
        Ok(match place {
            // At a stop before, at the stop after: what is at a place is known by equal numbers.
            Some((_, position)) => position - all * period,
            // Over many revolutions the difference may be beyond the ends by rounding.
            None => (sigma - revolutions * period).clamp(first, last),
        })
    }

    /// Why a step has come no further.
    #[cold]
    pub(super) fn interrupted(&self, begin: &Begin, progress: &Progress, h: f64, solver: &Solver) -> ModelError {
        let &Progress { t: time, work, .. } = progress;
        let [[before, rejected], [now, all_rejected]] = [begin.tried, self.memory.tried()];
        let (accepted, rejected) = (now - before, all_rejected - rejected);
        let revolutions = self.revolutions - begin.revolutions;
        let why = Spent { accepted, rejected, work, revolutions, time, h, max_steps: solver.max_steps }.describe();
        ModelError::Interrupted { time, why }
    }
}
