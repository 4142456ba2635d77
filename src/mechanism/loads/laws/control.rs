//! The law of a controlled drive.
//!
//! In: the force of the drive's input, commands, displacement x of the drive, its speed, the states of its controller.
//! Out: the force of the drive, the rates of the states. It must not know the linkage. Source: a position gain is a
//! spring whose rest position is the command, a speed gain is a damper whose other end moves with the commanded speed.
//! The integral part follows K. J. Astrom, T. Hagglund, Advanced PID Control (2006), section 3.5: anti-windup by
//! back-calculation.
use crate::numerics::dual::Number;

/// Law of a controlled drive: F_u = limited(F_d) with F_d = feed-forward + K_p (command - x) + K_v (command_speed -
/// x_dot) + I. The force F of the drive is F_u, or follows F_u: dF/dt = limited(F_u - F) / T.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// K_p [N/m or N.m/rad], >= 0; none without the input `command`.
    pub position_gain: Option<f64>,
    /// K_v [N.s/m or N.m.s/rad], >= 0; none without the input `command_speed`.
    pub speed_gain: Option<f64>,
    /// Law of the integral part I; none without one, and then I is 0.
    pub integral: Option<Integral>,
    /// T [s], > 0, with which F follows F_u; none where F is F_u.
    pub delay: Option<f64>,
    /// Smallest and largest F_u [N or N.m], then smallest and largest F_u - F that changes F: -R T and R T with the
    /// largest rate R; none where there is no limit.
    pub limits: [Option<f64>; 4],
}

/// Law of an integral part I [N or N.m]: dI/dt = K_i (command - x) + (F_r - F_d) / T_t, where F_r is F_u, or F plus the
/// limited difference F_u - F.
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

/// What a drive with a law gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Acting<T> {
    /// Force [N or N.m].
    pub force: T,
    /// Rates of the integral part and of the force [N/s or N.m/s]; 0 where they are no states.
    pub rates: [T; 2],
}

impl Control {
    /// Number of inputs: one for each gain.
    pub fn commands(&self) -> usize {
        usize::from(self.position_gain.is_some()) + usize::from(self.speed_gain.is_some())
    }

    /// F_d [N or N.m]: `own` is the force of the drive's input, `command` the command by its index, `motion` the
    /// displacement [m or rad] and the speed of the drive, `integral` its integral part.
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

    /// The force of the drive: `own`, `command` and `motion` as in [`Self::demanded`], `states` the integral part and
    /// the force as states. Without these an integral part is 0, and the force follows at once. `margin` is called for
    /// each limit with its index and with how far its quantity is within it, and returns a number with the sign that
    /// counts.
    #[inline]
    pub fn acting<T: Number>(
        &self,
        own: T,
        command: impl Fn(usize) -> T,
        motion: [T; 2],
        states: Option<[Option<T>; 2]>,
        mut margin: impl FnMut(usize, f64) -> f64,
    ) -> Acting<T> {
        let zero = T::constant(0.0);
        let integral = states.and_then(|[integral, _]| integral).unwrap_or(zero);
        let demanded = self.demanded(own, &command, motion, integral);
        let limited = self.limited(0, demanded, &mut margin);
        let (mut acting, mut reached) = (Acting { force: limited, rates: [zero; 2] }, limited);
        let Some([_, present]) = states else { return acting };
        if let (Some(time), Some(force)) = (self.delay, present) {
            let change = self.limited(2, limited - force, &mut margin);
            (acting.force, acting.rates[1]) = (force, change * T::constant(1.0 / time));
            reached = force + change;
        }
        if let Some(Integral { gain, tracking }) = self.integral {
            let lost = reached - demanded;
            acting.rates[0] = T::constant(gain) * (command(0) - motion[0]) + T::constant(tracking) * lost;
        }
        acting
    }

    /// How far a quantity is within a limit, by the index of the limit [N or N.m].
    #[inline]
    pub fn margin(side: usize, limit: f64, value: f64) -> f64 {
        if side.is_multiple_of(2) { value - limit } else { limit - value }
    }

    /// A quantity within the limits of index `first` and `first` + 1.
    #[inline]
    fn limited<T: Number>(&self, first: usize, value: T, margin: &mut impl FnMut(usize, f64) -> f64) -> T {
        let mut within = value;
        for side in first..first + 2 {
            if let Some(limit) = self.limits[side]
                && margin(side, Self::margin(side, limit, value.value())) < 0.0
            {
                within = T::constant(limit);
            }
        }
        within
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dual::Dual;

    const SERVO: Control = Control {
        position_gain: Some(40.0),
        speed_gain: Some(3.0),
        integral: None,
        delay: None,
        limits: [Some(-20.0), Some(50.0), None, None],
    };

    /// At the feed-forward 5, the command 0.5 and the commanded speed 2, in these states.
    fn acting<T: Number>(control: &Control, motion: [T; 2], states: [Option<f64>; 2]) -> Acting<T> {
        let states = Some(states.map(|state| state.map(T::constant)));
        control.acting(T::constant(5.0), |k| T::constant([0.5, 2.0][k]), motion, states, |_, margin| margin)
    }

    #[test]
    fn the_force_is_a_spring_and_a_damper_between_its_limits() {
        let force = |x: f64| acting(&SERVO, [x, 1.0], [None; 2]).force;
        assert_eq!([force(0.25), force(-1.0), force(1.5)], [5.0 + 40.0 * 0.25 + 3.0, 50.0, -20.0]);
        let speed_alone = Control { position_gain: None, ..SERVO };
        let demanded = speed_alone.demanded(5.0, |k| [2.0][k], [7.0, 1.0], 0.0);
        assert_eq!((speed_alone.commands(), demanded), (1, 8.0));
    }

    #[test]
    fn the_slopes_are_the_gains_and_0_at_a_limit() {
        let motion = |x: f64| [Dual::<2>::variable(x, 0), Dual::<2>::variable(1.0, 1)];
        let slopes = |x: f64| acting(&SERVO, motion(x), [None; 2]).force.slope;
        assert_eq!(slopes(0.25), [-40.0, -3.0]);
        assert_eq!(slopes(-1.0), [0.0, 0.0]);
    }

    #[test]
    fn the_integral_part_follows_the_error_and_the_force_that_a_limit_takes_away() {
        let control = Control { integral: Some(Integral { gain: 10.0, tracking: 4.0 }), ..SERVO };
        let rate = |integral: f64| acting(&control, [0.25, 1.0], [Some(integral), None]).rates[0];
        // Without the integral part the force is 18 N.
        assert_eq!([rate(30.0), rate(36.0), rate(-40.0)], [2.5, 2.5 - 16.0, 2.5 + 8.0]);
    }

    /// F_u is 18 N, or the limit of 50 N. F changes by at most 16 N in the time constant of 0.25 s.
    #[test]
    fn a_delayed_force_follows_at_a_limited_rate_and_the_integral_part_follows_what_it_reaches() {
        let limits = [Some(-20.0), Some(50.0), Some(-16.0), Some(16.0)];
        let integral = Some(Integral { gain: 10.0, tracking: 4.0 });
        let control = Control { integral, delay: Some(0.25), limits, ..SERVO };
        let rates = |integral: f64, force: f64| {
            let found = acting(&control, [0.25, 1.0], [Some(integral), Some(force)]);
            assert_eq!(found.force, force);
            found.rates
        };
        assert_eq!(rates(0.0, 10.0), [2.5, 4.0 * 8.0]);
        assert_eq!(rates(0.0, -10.0), [2.5 - 4.0 * 12.0, 64.0]);
        assert_eq!(rates(0.0, 40.0), [2.5 + 4.0 * 6.0, -64.0]);
        assert_eq!(rates(36.0, 44.0), [2.5 - 16.0, 24.0]);
    }
}
