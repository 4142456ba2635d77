//! The bound on the work of a communication step: what counts, how much is left, and what took it.
//!
//! In: the largest number of integration steps, the steps and transitions made. Out: whether to go on; why so many
//! steps were needed, in words. It must not know how a step is made.
use crate::numerics::decimal::Decimal;

/// What an advance has taken besides the steps of its integration, and how far it may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// Steps that the integration may have tried since its start, and `extra` with them, when the advance ends.
    pub most: u64,
    /// Steps taken again to locate an event, and transitions that took no time.
    pub extra: u64,
    /// Impacts on rigid stops.
    pub impacts: u64,
    /// Bumpers touched and left.
    pub bumpers: u64,
    /// Changes of friction's regime.
    pub regimes: u64,
    /// Reversals of drives with an efficiency.
    pub reversals: u64,
    /// Changes of sign of normal forces and of drives' forces.
    pub signs: u64,
}

impl Default for Work {
    fn default() -> Self {
        Self::within(u64::MAX)
    }
}

impl Work {
    /// Nothing done yet; see [`Self::most`].
    pub fn within(most: u64) -> Self {
        Self { most, extra: 0, impacts: 0, bumpers: 0, regimes: 0, reversals: 0, signs: 0 }
    }

    /// Whether nothing is left, after so many steps that the integration has tried since its start.
    #[inline(always)]
    pub fn is_spent(&self, attempts: u64) -> bool {
        attempts + self.extra >= self.most
    }
}

/// A communication step that met the bound.
pub struct Spent {
    /// Steps of the integration.
    pub accepted: u64,
    /// Steps of the integration that missed the tolerance.
    pub rejected: u64,
    pub work: Work,
    /// Whole revolutions of a closed curve made in the step.
    pub revolutions: f64,
    /// Time reached from the beginning of the step, and its size [s].
    pub time: f64,
    pub h: f64,
    /// The bound: `solver.max_steps`.
    pub max_steps: f64,
}

impl Spent {
    /// What took so many steps, how far they came, and the remedy.
    pub fn describe(&self) -> String {
        let Self { accepted, rejected, work, revolutions, time, h, max_steps } = self;
        let mut parts = vec![format!("{accepted} steps")];
        let counts = [
            (*rejected, "rejected steps"),
            (work.impacts, "impacts on stops"),
            (work.bumpers, "starts or ends of contact with bumpers"),
            (work.regimes, "changes of the friction regime"),
            (work.reversals, "reversals of drives with an efficiency"),
            (work.signs, "changes of sign of normal or drive forces"),
        ];
        parts.extend(counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")));
        if *revolutions != 0.0 {
            parts.push(format!("{} revolutions", revolutions.abs()));
        }
        format!(
            "solver.max_steps = {} was reached {} s after the start of a communication step of {} s, after {}: {}; use \
             shorter communication steps or a larger solver.max_steps",
            Decimal(*max_steps),
            Decimal(*time),
            Decimal(*h),
            parts.join(", "),
            self.cause()
        )
    }

    /// The phenomenon that most of the work went into.
    fn cause(&self) -> String {
        let Self { accepted, rejected, work, revolutions, time, .. } = self;
        let total = accepted + rejected + work.extra;
        // An impact takes about eight of the units that are counted, the other events three.
        if 16 * work.impacts > total {
            "the mechanism bounces on a rigid stop, so a lower restitution or more damping helps".into()
        } else if 8 * (work.bumpers + work.reversals + work.regimes + work.signs) > total {
            "the mechanism switches rapidly between bumpers, directions or friction regimes, so more damping helps"
                .into()
        } else if rejected > accepted {
            "most trial steps missed solver.tolerance, so a larger tolerance or smaller loads help".into()
        } else if revolutions.abs() >= 1.0 && *accepted as f64 <= 1e3 * revolutions.abs() {
            let rate = revolutions.abs() / time;
            format!("the mechanism makes {rate:.3e} revolutions per second on average")
        } else {
            let mean = time / (*accepted).max(1) as f64;
            format!(
                "the mean internal step was {mean:.1e} s; stiff friction, hard bumpers and large loads make steps short"
            )
        }
    }
}
