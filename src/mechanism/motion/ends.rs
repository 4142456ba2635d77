//! The two ends of the travel during a step, and what stands at each: a rigid stop or a bumper, and perhaps an engaged
//! lock.
//!
//! In: positions and stops found at the start (`travel.rs`), locks. Out: distances, what an end does to a motion that
//! comes to it. It must not know time or forces.

/// An end of the travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// sigma, counted on over whole revolutions.
    pub position: f64,
    /// Index of its stop.
    pub stop: usize,
    /// What the stop is.
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
#[derive(Clone, Copy, Debug)]
pub struct Ends {
    /// Ends.
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
        match self.travel[side]?.kind {
            StopKind::Rigid { restitution } => Some(restitution),
            StopKind::Bumper(_) => None,
        }
    }

    /// Whether the stop at an end is rigid.
    #[inline]
    pub fn is_rigid(&self, side: usize) -> bool {
        self.restitution(side).is_some()
    }

    /// Index of the bumper at an end, if there is one.
    #[inline]
    pub fn bumper(&self, side: usize) -> Option<usize> {
        match self.travel[side]?.kind {
            StopKind::Rigid { .. } => None,
            StopKind::Bumper(bumper) => Some(bumper),
        }
    }

    /// Whether a mechanism at rest at an end stays there without a lock: the stop is rigid, and `acceleration`,
    /// sigma_ddot without the stop, does not point away from it.
    #[inline]
    pub fn is_pressed(&self, side: usize, acceleration: f64) -> bool {
        self.is_rigid(side) && acceleration * outward(side) >= 0.0
    }
}
