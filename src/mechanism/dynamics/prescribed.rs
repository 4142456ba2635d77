//! The motion that a drive is given over a step: by inputs or by a profile.
//!
//! By inputs the position p, the speed v and the acceleration a of the drive are those at the communication point; over
//! the step that begins there
//!
//! ```text
//! s(t) = p + v t + a t^2 / 2 + a_1 t^3 / 6 + a_2 t^4 / 24
//! ```
//!
//! with the input derivatives a_1, a_2 of the acceleration, 0 unless set. In: inputs, a profile and where it began.
//! Out: position, speed, acceleration and jerk at a time of the step; kinks. It must not know the curve.
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::loads::laws::profile::{Kinematics, Profile, Since};
use crate::mechanism::loads::resolved::MotionDrive;
use crate::numerics::bracket::bisect;

/// Parts of a step in which the speed of a motion by inputs is looked at for a change of sign.
const PARTS: usize = 8;

/// Position [m or rad], speed, acceleration and its first two input derivatives.
pub type Given = [f64; 5];

/// The motion by inputs at the end of a step of `t` [s].
pub fn end_of(given: Given, t: f64) -> Given {
    let [position, speed, acceleration, _] = Prescribed::Given(given).at(t);
    [position, speed, acceleration, 0.0, 0.0]
}

/// Motion of a drive over a step.
#[derive(Clone, Copy, Debug)]
pub enum Prescribed<'a> {
    /// By inputs.
    Given(Given),
    /// By a profile, from a position on, so long after it was first prescribed.
    Profile { profile: &'a Profile, origin: f64, time: Since },
}

impl Inputs {
    /// Whether the motion of a drive is prescribed; the last of the Booleans tells it where a drive has a motion.
    #[inline]
    pub fn prescribes(&self) -> bool {
        self.locks.last().is_some_and(|enabled| *enabled)
    }

    /// A step of `h` [s] is done: position and speed of the motion that inputs prescribe are those at its end.
    pub fn move_on(&mut self, drive: &MotionDrive, h: f64) {
        if let (Some(given), Some(first)) = (self.given(drive), drive.first_input) {
            let [position, speed, ..] = end_of(given, h);
            self.followed().reals[first..first + 2].copy_from_slice(&[position, speed]);
        }
    }

    /// Position, speed and acceleration that inputs prescribe, with the input derivatives of the acceleration.
    pub fn given(&self, drive: &MotionDrive) -> Option<Given> {
        let first = drive.first_input?;
        let &[position, speed, acceleration] = self.reals.get(first..)?.first_chunk()?;
        let of = |derivatives: &[f64]| if self.signal.ahead { derivatives[first + 2] } else { 0.0 };
        Some([position, speed, acceleration, of(&self.signal.first), of(&self.signal.second)])
    }
}

impl<'a> Prescribed<'a> {
    /// The motion of a drive under these inputs; a profile was first prescribed at `origin`, so long ago.
    pub fn new(drive: &'a MotionDrive, inputs: &Inputs, origin: f64, time: Since) -> Option<Self> {
        match &drive.profile {
            Some(profile) => Some(Self::Profile { profile, origin, time }),
            None => inputs.given(drive).map(Self::Given),
        }
    }

    /// Position, speed, acceleration and jerk at a time t [s] of the step; at a kink those which follow.
    pub fn at(&self, t: f64) -> Kinematics {
        match *self {
            Self::Given([p, v, a, j, k]) => [
                p + t * (v + t * (0.5 * a + t * (j / 6.0 + t * k / 24.0))),
                v + t * (a + t * (0.5 * j + t * k / 6.0)),
                a + t * (j + 0.5 * t * k),
                j + t * k,
            ],
            Self::Profile { profile, origin, time } => {
                let [distance, speed, acceleration, jerk] = profile.at(time, t);
                [origin + distance, speed, acceleration, jerk]
            }
        }
    }

    /// The first time after t and up to `end` [s] of the step at which the motion is less smooth, or turns back.
    pub fn next_kink(&self, t: f64, end: f64) -> f64 {
        match *self {
            Self::Profile { profile, time, .. } => profile.next_kink(time, t).min(end),
            Self::Given(_) => {
                let speed = |t: f64| self.at(t)[1];
                let part = |k: usize| t + (end - t) * k as f64 / PARTS as f64;
                let turns = |k: &usize| speed(part(*k)) * speed(part(k + 1)) < 0.0;
                let Some(k) = (0..PARTS).find(turns) else { return end };
                let sign = speed(part(k)).signum();
                let [_, turn] = bisect(|t| speed(t) * sign <= 0.0, part(k), part(k + 1));
                if turn > t { turn.min(end) } else { end }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_by_inputs_is_a_polynomial_that_is_cut_where_it_turns_back() {
        let given = Prescribed::Given([1.0, 2.0, -8.0, 6.0, 0.0]);
        let t = 0.3;
        let expected = [1.0 + 0.6 - 0.36 + 0.027, 2.0 - 2.4 + 0.27, -8.0 + 1.8, 6.0];
        for (value, expected) in given.at(t).into_iter().zip(expected) {
            assert!((value - expected).abs() < 1e-15, "{value} {expected}");
        }
        // 2 - 8 t + 3 t^2 = 0.
        let turn = (8.0 - 40.0_f64.sqrt()) / 6.0;
        assert!((given.next_kink(0.0, 1.0) - turn).abs() < 1e-15);
        assert_eq!(given.next_kink(0.0, 0.2), 0.2);
        assert_eq!(given.next_kink(turn + 1e-9, 1.0), 1.0);
    }
}
