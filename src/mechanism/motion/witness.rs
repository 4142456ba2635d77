//! What has happened within a step: impacts for the outputs of stops and, if somebody listens, every occurrence for the
//! log.
//!
//! In: transitions of an advance. Out: impacts of each stop, occurrences in order. A step in which nothing happens
//! costs nothing here, and nothing is allocated unless somebody listens. Events of a failed step are discarded. It
//! must not know words.
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::motion::impacts::{Impact, Impacts};

/// Most occurrences of one step that are kept for the log.
const MOST: usize = 10_000;

/// What happens at an instant. Stops, joints with friction and locks are told by index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// The mechanism meets a stop at this speed [rad/s or m/s], and the stop, if it is rigid, gives this impulse.
    Impact { stop: usize, speed: f64, impulse: f64, is_rigid: bool },
    /// It comes to rest at a stop.
    Rests { stop: usize },
    /// The motion of a drive is prescribed from now on, which changes the speed of the drive by so much, with an
    /// impulse.
    Gripped { change: f64, impulse: f64 },
    /// A bumper begins to push.
    Touched { stop: usize },
    /// A bumper ceases to push.
    Left { stop: usize },
    /// The lock of this stop engages by the force of the stop.
    Engages { stop: usize },
    /// A lock of this stop catches the mechanism.
    Caught { stop: usize },
    /// The locks of this stop let the mechanism go.
    LetGo { stop: usize },
    /// This pressure lock of the network engages or releases.
    Switched { lock: usize, engaged: bool },
    /// The motion reverses, and with it the losses of the drives.
    Reversal,
    /// Friction holds the mechanism at rest.
    Sticks,
    /// The loads overcome the friction that holds the mechanism.
    BreaksAway,
    /// A driven surface holds its body in this friction joint.
    Clings { joint: usize },
    /// The body starts to slip on the driven surface that held it.
    Slips { joint: usize },
    /// A friction joint changes to this regime of its law.
    Regime { joint: usize, regime: Regime },
}

/// Something that happens `t` [s] after the beginning of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occurrence {
    pub t: f64,
    pub what: What,
}

/// Which occurrences somebody listens to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Listens {
    /// All but details.
    pub events: bool,
    /// Details: regimes of friction.
    pub details: bool,
}

/// Where an advance pauses, so that somebody can read the state there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pauses {
    /// Where a stop is met or lets go.
    pub at_events: bool,
    /// After each internal step.
    pub at_steps: bool,
}

/// What has happened within the present step.
#[derive(Clone, Debug, Default)]
pub struct Witness {
    /// What is kept.
    pub listens: Listens,
    /// Where an advance pauses.
    pub pauses: Pauses,
    occurrences: Vec<Occurrence>,
    /// Number of occurrences beyond [`MOST`].
    pub left_out: u64,
    /// Impacts on each stop since the beginning of the step, with times from there.
    impacts: Vec<Impacts>,
    has_impacts: bool,
}

impl Witness {
    /// One for so many stops.
    pub fn new(stops: usize) -> Self {
        Self { impacts: vec![Impacts::default(); stops], ..Self::default() }
    }

    /// Keep an occurrence if somebody listens.
    #[inline(always)]
    pub fn tell(&mut self, t: f64, what: What) {
        let listens = if matches!(what, What::Regime { .. }) { self.listens.details } else { self.listens.events };
        if listens {
            self.keep(Occurrence { t, what });
        }
    }

    #[cold]
    #[inline(never)]
    fn keep(&mut self, occurrence: Occurrence) {
        if self.occurrences.len() < MOST {
            self.occurrences.push(occurrence);
        } else {
            self.left_out += 1;
        }
    }

    /// The mechanism meets a stop.
    #[cold]
    #[inline(never)]
    pub fn impact(&mut self, t: f64, (stop, is_rigid): (usize, bool), impact: Impact) {
        let (speed, impulse) = (impact.speed(), impact.impulse());
        if let Some(impacts) = self.impacts.get_mut(stop) {
            *impacts = Impacts { count: impacts.count + 1.0, time: t, impulse };
            self.has_impacts = true;
        }
        self.tell(t, What::Impact { stop, speed, impulse, is_rigid });
    }

    /// The step is done, from the time `point` [s] on: add its impacts to those before.
    #[inline(always)]
    pub fn settle(&mut self, all: &mut [Impacts], point: f64) {
        if self.has_impacts {
            self.add_impacts(all, point);
        }
    }

    #[cold]
    fn add_impacts(&mut self, all: &mut [Impacts], point: f64) {
        for (all, new) in all.iter_mut().zip(&mut self.impacts).filter(|(_, new)| new.count > 0.0) {
            all.add(new, point);
            *new = Impacts::default();
        }
        self.has_impacts = false;
    }

    /// The step has failed: nothing has happened.
    pub fn forget(&mut self) {
        self.impacts.fill(Impacts::default());
        self.has_impacts = false;
        self.take();
    }

    /// What has happened since the last call, in order.
    pub fn take(&mut self) -> Vec<Occurrence> {
        self.left_out = 0;
        std::mem::take(&mut self.occurrences)
    }

    /// Whether something is kept for the log.
    pub fn has_occurrences(&self) -> bool {
        !self.occurrences.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_step_has_met_nothing() {
        let mut witness = Witness::new(2);
        let mut all = [Impacts::default(); 2];
        let impact = Impact { slope: 0.5, before: 2.0, after: -1.0 };
        witness.listens.events = true;
        witness.impact(0.1, (1, true), impact);
        assert!(witness.has_occurrences());
        witness.forget();
        witness.settle(&mut all, 5.0);
        assert!(!witness.has_occurrences() && all == [Impacts::default(); 2]);
        // A step that is done: the number of its impacts, time and impulse of the last one.
        witness.impact(0.1, (1, true), impact);
        witness.impact(0.2, (1, true), impact);
        witness.settle(&mut all, 5.0);
        assert_eq!(all, [Impacts::default(), Impacts { count: 2.0, time: 5.2, impulse: 6.0 }]);
        assert_eq!(witness.take().len(), 2);
        // From 2^53 on the number stays.
        all[1].count = 9_007_199_254_740_992.0;
        witness.impact(0.1, (1, true), impact);
        witness.settle(&mut all, 6.0);
        assert_eq!(all[1].count, 9_007_199_254_740_992.0);
    }

    #[test]
    fn occurrences_are_bounded_and_silence_keeps_none() {
        let mut witness = Witness::new(0);
        witness.tell(0.0, What::Reversal);
        witness.listens.details = true;
        witness.tell(0.0, What::Reversal);
        assert!(!witness.has_occurrences());
        witness.listens.events = true;
        (0..MOST + 3).for_each(|_| witness.tell(0.0, What::Reversal));
        assert_eq!((witness.left_out, witness.take().len()), (3, MOST));
    }

    #[test]
    fn a_dead_centre_has_no_finite_impulse() {
        let at_dead_centre = Impact { slope: 0.0, before: 1.0, after: 0.0 };
        assert_eq!(at_dead_centre.impulse(), f64::MAX);
        assert_eq!(Impact { before: 0.0, ..at_dead_centre }.impulse(), 0.0);
    }
}
