//! Motions of a drive that a mechanism cannot make.
//!
//! In: a step under a prescribed motion, a position of the drive that is not found. Out: the error with limit and
//! remedy. It must not know how positions are found.
use super::Step;
use crate::mechanism::error::{ModelError, unit_of};
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::motion::contact::EngagedLocks;
use crate::mechanism::motion::prescribed::Missed;
use crate::numerics::decimal::Decimal;

/// Why a motion cannot be made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trouble {
    /// Time of the step [s].
    pub(super) time: f64,
    pub(super) cause: Cause,
}

/// What stands against a motion.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cause {
    /// Position, speed or acceleration of the drive overflows.
    Motion,
    /// The drive cannot have this position.
    Missed(f64, Missed),
    /// Friction locks the mechanism against its drive at this sigma.
    Locked(f64),
    /// The power overflows.
    Power,
}

impl Step<'_> {
    /// The error for the host.
    #[cold]
    pub(super) fn error(&self, Trouble { time, cause }: Trouble) -> ModelError {
        match cause {
            Cause::Motion => ModelError::Overflow { name: format!("prescribed {}", self.name()) },
            Cause::Missed(position, missed) => self.refusal(time, position, missed),
            Cause::Locked(sigma) => self.locked(time, sigma),
            Cause::Power => ModelError::Overflow { name: "the power of the prescribed motion".into() },
        }
    }

    /// The error of a motion that friction locks.
    fn locked(&self, time: f64, sigma: f64) -> ModelError {
        let whole = self.track.whole;
        let (within, _) = whole.unwound(sigma);
        let why = format!(
            "friction locks the mechanism against the drive at this position, mainly in {}; reduce the coefficients or \
             pin radii, or end the motion before this position",
            whole.locking_joint(within)
        );
        let [value, ..] = self.motion.at(time);
        ModelError::Prescribed { name: self.name(), value, time, why }
    }

    /// Name of the quantity that is prescribed.
    pub(super) fn name(&self) -> String {
        let loading = self.track.whole.loading();
        let quantity = match &loading.loads[self.drive.load] {
            Load::Couple { .. } | Load::Screw { .. } => "angle",
            Load::Slide { .. } => "position",
            _ => "length",
        };
        format!("{}.{quantity}", loading.drives[self.drive.load].name)
    }

    /// Why the drive cannot have a position.
    fn refusal(&self, time: f64, value: f64, missed: Missed) -> ModelError {
        let (whole, ends) = (self.track.whole, self.track.ends);
        let at = |sigma: f64| {
            let (within, more) = whole.unwound(sigma);
            whole.describe(within, self.track.revolutions + more)
        };
        let name = self.name();
        let reach = |sigma: f64| match self.track.displacement(sigma) {
            Ok([s, ..]) => format!("{} {} at {}", Decimal::rounded(s), unit_of(&name), at(sigma)),
            Err(_) => at(sigma),
        };
        let why = match missed {
            Missed::Idle(sigma) => {
                let s = self.track.displacement(sigma).map_or(f64::NAN, |[s, ..]| s);
                let (words, remedy) = whole.loading().loads[self.drive.load].idle_words(s, whole.linkage().size);
                format!(
                    "{words}, so the motion of the drive cannot be prescribed, and the force of the drive cannot \
                    be computed; {remedy}"
                )
            }
            Missed::DeadPoint(sigma) => format!(
                "the drive has a dead centre near {}, where no force of the drive moves the mechanism; end the motion \
                 before this position, or use another drive at this position",
                reach(sigma)
            ),
            Missed::End(side) => match ends.travel.rigid[side] {
                Some(end) => format!(
                    "{} ends the travel at {}; end the motion at this position, or set `enabled` of the stop to \
                     false",
                    whole.loading().stops[end.stop].name,
                    reach(ends.limits[side])
                ),
                None => format!("the travel ends at {}; end the motion before this position", reach(ends.limits[side])),
            },
            Missed::Curve(sigma) => {
                format!(
                    "the travel ends near {}, or the motion is not smooth there; end the motion before this position",
                    at(sigma)
                )
            }
            Missed::Far => {
                "the prescribed position is too far from the previous prescribed position; use shorter communication \
                 steps"
                    .to_owned()
            }
        };
        ModelError::Prescribed { name, value, time, why }
    }

    /// Refuse a motion away from a place where a lock holds the mechanism, or past one where a lock would catch it.
    pub(super) fn check_locks(&self, t: f64, from: f64, to: f64) -> Result<(), ModelError> {
        let ends = self.track.ends;
        if ends.locked == EngagedLocks::default() || from == to {
            return Ok(());
        }
        let is_passed = |position: f64| position == from || (position - from) * (position - to) < 0.0;
        let mut places = ends.travel.places().map(|(place, _)| place).filter(|place| ends.is_fast(*place));
        let Some(place) = places.find(|place| ends.position(*place).is_some_and(is_passed)) else { return Ok(()) };
        let stop = ends.travel.stop(place).map_or("a stop", |(stop, _)| &self.track.whole.loading().stops[stop].name);
        let why = format!("the motion leaves or passes {stop}, whose lock is engaged; disengage the lock first");
        let [value, ..] = self.motion.at(t);
        Err(ModelError::Prescribed { name: self.name(), value, time: t, why })
    }
}
