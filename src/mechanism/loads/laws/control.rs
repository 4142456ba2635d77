//! The law of a controlled drive.
//!
//! In: the force of the drive's input, commands, displacement x of the drive, its speed, its integral part. Out: the
//! force of the drive before and after its limits, the rate of the integral part. It must not know the linkage. Source:
//! a position gain is a spring whose rest position is the command, a speed gain is a damper whose other end moves with
//! the commanded speed. The integral part follows K. J. Astrom, T. Hagglund, Advanced PID Control (2006), section 3.5:
//! anti-windup by back-calculation.
use crate::numerics::dual::Number;

/// Law of a controlled drive: F = limited(F_d) with F_d = feed-forward + K_p (command - x) + K_v (command_speed -
/// x_dot) + I.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// K_p [N/m or N.m/rad], >= 0; none without the input `command`.
    pub position_gain: Option<f64>,
    /// K_v [N.s/m or N.m.s/rad], >= 0; none without the input `command_speed`.
    pub speed_gain: Option<f64>,
    /// Law of the integral part I; none without one, and then I is 0.
    pub integral: Option<Integral>,
    /// Smallest and largest force [N or N.m]; none where there is no limit.
    pub limits: [Option<f64>; 2],
}

/// Law of an integral part I [N or N.m]: dI/dt = K_i (command - x) + (F - F_d) / T_t.
///
/// Between the limits the second term is 0. At a limit it is the part of the force that the drive does not give, and I
/// approaches a value with which F_d is near the limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral {
    /// K_i [N/(m.s) or N.m/(rad.s)], >= 0.
    pub gain: f64,
    /// 1 / T_t [1/s], >= 0.
    pub tracking: f64,
}

impl Control {
    /// Number of inputs: one for each gain.
    pub fn commands(&self) -> usize {
        usize::from(self.position_gain.is_some()) + usize::from(self.speed_gain.is_some())
    }

    /// Force before the limits [N or N.m]: `own` is that of the drive's input, `command` the command by its index,
    /// `motion` the displacement [m or rad] and the speed of the drive, `integral` its integral part.
    #[inline]
    pub fn demanded<T: Number>(&self, own: T, command: impl Fn(usize) -> T, [x, speed]: [T; 2], integral: T) -> T {
        let mut force = own;
        if self.integral.is_some() {
            force = force + integral;
        }
        if let Some(gain) = self.position_gain {
            force = force + T::constant(gain) * (command(0) - x);
        }
        if let Some(gain) = self.speed_gain {
            force = force + T::constant(gain) * (command(self.commands() - 1) - speed);
        }
        force
    }

    /// Rate of the integral part [N/s or N.m/s] at the displacement x and a force before and after the limits.
    #[inline]
    pub fn rate<T: Number>(&self, command: impl Fn(usize) -> T, x: T, [demanded, limited]: [T; 2]) -> T {
        match self.integral {
            Some(Integral { gain, tracking }) => {
                T::constant(gain) * (command(0) - x) + T::constant(tracking) * (limited - demanded)
            }
            None => T::constant(0.0),
        }
    }

    /// How far a force before the limits is within a limit, the lower one or the upper one [N or N.m]; none without
    /// this limit.
    #[inline]
    pub fn margin(&self, upper: usize, demanded: f64) -> Option<f64> {
        self.limits[upper].map(|limit| if upper == 0 { demanded - limit } else { limit - demanded })
    }

    /// Force after the limits [N or N.m], where `margin` is a number with the sign of [`Self::margin`].
    #[inline]
    pub fn limited<T: Number>(&self, demanded: T, mut margin: impl FnMut(usize, f64) -> f64) -> T {
        let mut force = demanded;
        for upper in 0..2 {
            if let (Some(limit), Some(own)) = (self.limits[upper], self.margin(upper, demanded.value()))
                && margin(upper, own) < 0.0
            {
                force = T::constant(limit);
            }
        }
        force
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dual::Dual;

    const SERVO: Control =
        Control { position_gain: Some(40.0), speed_gain: Some(3.0), integral: None, limits: [Some(-20.0), Some(50.0)] };

    /// Force at the feed-forward 5, the command 0.5 and the commanded speed 2.
    fn force<T: Number>(control: &Control, x: T, speed: T) -> T {
        let demanded = control.demanded(T::constant(5.0), |k| T::constant([0.5, 2.0][k]), [x, speed], T::constant(9.0));
        control.limited(demanded, |_, margin| margin)
    }

    #[test]
    fn the_force_is_a_spring_and_a_damper_between_its_limits() {
        assert_eq!(force(&SERVO, 0.25, 1.0), 5.0 + 40.0 * 0.25 + 3.0);
        assert_eq!(force(&SERVO, -1.0, 1.0), 50.0);
        assert_eq!(force(&SERVO, 1.5, 1.0), -20.0);
        let speed_alone = Control { position_gain: None, ..SERVO };
        let demanded = speed_alone.demanded(5.0, |k| [2.0][k], [7.0, 1.0], 0.0);
        assert_eq!((speed_alone.commands(), demanded), (1, 8.0));
    }

    #[test]
    fn the_slopes_are_the_gains_and_0_at_a_limit() {
        let slopes = |x: f64| force(&SERVO, Dual::<2>::variable(x, 0), Dual::<2>::variable(1.0, 1)).slope;
        assert_eq!(slopes(0.25), [-40.0, -3.0]);
        assert_eq!(slopes(-1.0), [0.0, 0.0]);
    }

    #[test]
    fn the_integral_part_follows_the_error_and_the_force_that_a_limit_takes_away() {
        let control = Control { integral: Some(Integral { gain: 10.0, tracking: 4.0 }), ..SERVO };
        let rate = |integral: f64| {
            let demanded = control.demanded(5.0, |k| [0.5, 2.0][k], [0.25, 1.0], integral);
            control.rate(|_| 0.5, 0.25, [demanded, control.limited(demanded, |_, margin| margin)])
        };
        // Without the integral part the force is 18 N.
        assert_eq!([rate(30.0), rate(36.0), rate(-40.0)], [2.5, 2.5 - 16.0, 2.5 + 8.0]);
    }
}
