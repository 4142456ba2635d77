//! The two ends of the travel: what stands at each, a rigid stop or a bumper and perhaps an engaged lock, and the
//! contact there, one small state machine for each end.
//!
//! | from | to | transition |
//! |---|---|---|
//! | Free, Touching | Resting | [`Contact::rests`]: an impact or the end of bouncing, without a lock engaged |
//! | Free, Touching | Latched | [`Contact::rests`]: the same with a lock engaged, which catches the mechanism |
//! | Resting | Latched | [`Contact::locks_set`]: a lock is engaged |
//! | Latched | Resting | [`Contact::locks_set`]: the last lock is disengaged |
//! | Resting | Free | [`Contact::released`]: the loads no longer press the mechanism against a rigid stop |
//! | Free | Touching | [`Contact::touched`]: a bumper begins to push |
//! | Touching | Free | [`Contact::released`]: the bumper would pull |
//!
//! In: positions and stops found at the start (`travel.rs`), locks, what happens at an end. Out: what an end does to a
//! motion that comes to it, the state of contact there. It must not know time, forces or what causes a transition.
use crate::codec::record::{Damaged, Record};

/// An end of the travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// sigma, counted on over whole revolutions.
    pub position: f64,
    /// Index of its stop.
    pub stop: usize,
    pub kind: StopKind,
}

/// What a stop does to a mechanism that comes to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StopKind {
    /// It reverses the speed in no time.
    Rigid {
        /// Speed after an impact over the speed before [1].
        restitution: f64,
    },
    /// It pushes back by a spring and a damper; index of the bumper among those of the state loads.
    Bumper(usize),
}

/// The end at the low and the one at the high side of sigma, if there are such.
pub type Travel = [Option<End>; 2];

/// The ends of the travel during a step; positions in the frame of sigma.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ends {
    pub travel: Travel,
    /// Whether a lock is engaged at each.
    pub locked: [bool; 2],
}

/// Sign of sigma_dot of a motion that comes to the end on this side.
#[inline]
pub fn outward(side: usize) -> f64 {
    if side == 0 { -1.0 } else { 1.0 }
}

impl Ends {
    /// Whether sigma is exactly at an end.
    #[inline]
    pub fn is_at(&self, side: usize, sigma: f64) -> bool {
        self.travel[side].is_some_and(|end| sigma == end.position)
    }

    /// Coefficient of restitution of the stop at an end, if it is rigid.
    #[inline]
    pub fn restitution(&self, side: usize) -> Option<f64> {
        if let StopKind::Rigid { restitution } = self.travel[side]?.kind { Some(restitution) } else { None }
    }

    #[inline]
    pub fn is_rigid(&self, side: usize) -> bool {
        self.restitution(side).is_some()
    }

    /// Index of the bumper at an end, if there is one.
    #[inline]
    pub fn bumper(&self, side: usize) -> Option<usize> {
        if let StopKind::Bumper(bumper) = self.travel[side]?.kind { Some(bumper) } else { None }
    }

    /// Whether a mechanism at rest at an end stays there without a lock: the stop is rigid, and `acceleration`,
    /// sigma_ddot without the stop, does not point away from it.
    #[inline]
    pub fn is_pressed(&self, side: usize, acceleration: f64) -> bool {
        self.is_rigid(side) && acceleration * outward(side) >= 0.0
    }
}

/// State of contact at one end of the travel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ContactState {
    /// No contact that lasts.
    #[default]
    Free,
    /// The bumper with this index pushes.
    Touching(usize),
    /// The mechanism rests at the end; a rigid stop holds it as long as the loads press it against the stop.
    Resting,
    /// The mechanism rests at the end, where a lock is engaged.
    Latched,
}

/// What holds a mechanism at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holder {
    /// A rigid stop, against which the loads press the mechanism.
    Stop,
    /// The locks at the end.
    Lock,
}

/// State of contact at the low and at the high end of the travel. The mechanism rests at one end at most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    ends: [ContactState; 2],
}

impl ContactState {
    /// Rest at an end, with a lock engaged or not.
    fn rest(locked: bool) -> Self {
        if locked { Self::Latched } else { Self::Resting }
    }

    fn is_rest(self) -> bool {
        matches!(self, Self::Resting | Self::Latched)
    }
}

impl Contact {
    /// At rest at an end, or at none.
    pub fn at_start(resting: Option<usize>) -> Self {
        let state = |side| if resting == Some(side) { ContactState::Resting } else { ContactState::Free };
        Self { ends: [0, 1].map(state) }
    }

    /// End at which the mechanism rests.
    #[inline]
    pub fn at_rest(&self) -> Option<usize> {
        (0..2).find(|&side| self.ends[side].is_rest())
    }

    /// Whether a lock holds the mechanism at an end.
    #[inline]
    pub fn is_latched(&self, side: usize) -> bool {
        self.ends[side] == ContactState::Latched
    }

    /// Bumper that pushes at each end.
    #[inline]
    pub fn touching(&self) -> [Option<usize>; 2] {
        self.ends.map(|end| if let ContactState::Touching(bumper) = end { Some(bumper) } else { None })
    }

    /// Locks are engaged or not at each end: where the mechanism rests, an engaged lock latches.
    #[inline]
    pub fn locks_set(&mut self, locked: [bool; 2]) {
        for (end, locked) in self.ends.iter_mut().zip(locked) {
            if end.is_rest() {
                *end = ContactState::rest(locked);
            }
        }
    }

    /// The mechanism has come to rest at an end.
    pub fn rests(&mut self, side: usize, locked: bool) {
        self.ends[side] = ContactState::rest(locked);
    }

    /// Nothing holds the mechanism at an end any longer, or the bumper there ceases to push.
    pub fn released(&mut self, side: usize) {
        self.ends[side] = ContactState::Free;
    }

    /// The bumper at an end begins to push.
    pub fn touched(&mut self, side: usize, bumper: usize) {
        self.ends[side] = ContactState::Touching(bumper);
    }

    /// What holds the mechanism at rest, and at which end, with locks as they are in `ends`. `acceleration` is
    /// sigma_ddot without stop and locks. A stop comes first: a lock carries what the stop cannot.
    pub fn holder(mut self, ends: &Ends, acceleration: f64) -> Option<(usize, Holder)> {
        self.locks_set(ends.locked);
        let side = self.at_rest()?;
        if ends.is_pressed(side, acceleration) {
            Some((side, Holder::Stop))
        } else {
            self.is_latched(side).then_some((side, Holder::Lock))
        }
    }

    /// The state at each end, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        for end in &mut self.ends {
            let (mut state, mut bumper) = match *end {
                ContactState::Free => (0, 0),
                ContactState::Touching(bumper) => (1, bumper),
                ContactState::Resting => (2, 0),
                ContactState::Latched => (3, 0),
            };
            record.choice("contact", &mut state, 4)?;
            if state == 1 {
                record.place("touching", &mut bumper, usize::MAX)?;
            }
            *end = match state {
                0 => ContactState::Free,
                1 => ContactState::Touching(bumper),
                2 => ContactState::Resting,
                _ => ContactState::Latched,
            };
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_latches_only_a_mechanism_at_rest() {
        let mut contact = Contact::default();
        contact.touched(1, 3);
        contact.locks_set([true, true]);
        assert_eq!((contact.at_rest(), contact.touching()), (None, [None, Some(3)]));
        contact.rests(1, true);
        assert_eq!((contact.at_rest(), contact.is_latched(1), contact.touching()), (Some(1), true, [None; 2]));
        contact.locks_set([true, false]);
        assert_eq!((contact.at_rest(), contact.is_latched(1)), (Some(1), false));
        contact.released(1);
        assert_eq!(contact, Contact::default());
    }

    #[test]
    fn a_lock_carries_what_the_stop_cannot() {
        let end = End { position: 0.0, stop: 0, kind: StopKind::Rigid { restitution: 0.0 } };
        let mut ends = Ends { travel: [Some(end), None], locked: [false, false] };
        let contact = Contact::at_start(Some(0));
        assert_eq!(contact.holder(&ends, -1.0), Some((0, Holder::Stop)));
        assert_eq!(contact.holder(&ends, 1.0), None);
        ends.locked[0] = true;
        assert_eq!(contact.holder(&ends, -1.0), Some((0, Holder::Stop)));
        assert_eq!(contact.holder(&ends, 1.0), Some((0, Holder::Lock)));
        assert_eq!(Contact::default().holder(&ends, -1.0), None);
    }

    #[test]
    fn each_state_is_read_as_it_was_written() {
        let mut contact = Contact::default();
        contact.touched(0, 7);
        contact.rests(1, true);
        let mut bytes = Vec::new();
        contact.record(&mut Record::Write(&mut bytes)).unwrap();
        let mut read = Contact::default();
        read.record(&mut Record::Read(&bytes)).unwrap();
        assert_eq!(read, contact);
    }
}
