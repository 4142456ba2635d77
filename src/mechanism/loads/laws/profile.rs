//! Motion over time of a drive that is prescribed: from rest to rest, or through points.
//!
//! With the distance D, the speed v, the acceleration a:
//!
//! ```text
//! trapezoid        acceleration a, speed v, deceleration a; without the middle part where D < v^2 / a
//! cycloidal, polynomial 345, polynomial 4567: the rises of `numerics/rise.rs`
//! constant speed   v without an end
//! table            a curve of `numerics/piecewise.rs`
//! ```
//!
//! Source of the trapezoid: VDI 2143 part 1; Norton, Design of Machinery, chapter 8. In: a time. Out: distance, speed,
//! acceleration, jerk. It must not know what moves.
use crate::numerics::piecewise::Piecewise;
use crate::numerics::rise::Rise;

/// Part of the time of a profile within which a time counts as that of a kink, so that sums of steps get there.
const CLOSE: f64 = 1e-12;
/// Durations of a profile up to which the time at rest before it counts in this.
const LATE: f64 = 1e3;

/// Distance [m or rad], speed, acceleration and jerk at a time.
pub type Kinematics = [f64; 4];

/// A time since the motion was first prescribed [s], and what its rounding has lost [s].
pub type Since = [f64; 2];

/// A motion over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Time at rest before it [s].
    pub start_time: f64,
    /// Law of the motion.
    pub shape: Shape,
}

/// The law of a motion over time.
#[expect(missing_docs, reason = "the sentence of a variant names its fields")]
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Acceleration with its sign, then duration of the acceleration and of the middle part [s].
    Trapezoid { acceleration: f64, ramp: f64, middle: f64 },
    /// A rise by the distance [m or rad] in the duration [s].
    Rise { law: Rise, distance: f64, duration: f64 },
    /// This speed [m/s or rad/s] from the beginning on.
    ConstantSpeed(f64),
    /// Through points.
    Table(Piecewise),
}

impl Shape {
    /// The trapezoid of a distance with these largest speed and acceleration, both > 0.
    pub fn trapezoid(distance: f64, speed: f64, acceleration: f64) -> Self {
        let way = distance.abs();
        let signed = acceleration.copysign(distance);
        if way * acceleration >= speed * speed {
            let ramp = speed / acceleration;
            Self::Trapezoid { acceleration: signed, ramp, middle: way / speed - ramp }
        } else {
            Self::Trapezoid { acceleration: signed, ramp: (way / acceleration).sqrt(), middle: 0.0 }
        }
    }

    /// Times of the kinks from the beginning [s]: of a table the last one up to a time t [s], and the one after it.
    fn kinks(&self, t: f64) -> [f64; 4] {
        match self {
            Self::Trapezoid { ramp, middle, .. } => [0.0, *ramp, ramp + middle, ramp + middle + ramp],
            Self::Rise { duration, .. } => [0.0, *duration, *duration, *duration],
            Self::ConstantSpeed(_) => [0.0; 4],
            Self::Table(table) => {
                let knots = table.knots();
                let next = knots.partition_point(|knot| *knot <= t);
                // One more of either side, as t may be that of a kink within rounding.
                let at = |k: usize| knots[k.min(knots.len() - 1)];
                [0.0, at(next.saturating_sub(1)), at(next), at(next + 1)]
            }
        }
    }

    /// Time of the last kink [s].
    pub fn duration(&self) -> f64 {
        self.kinks(f64::INFINITY).into_iter().fold(0.0, f64::max)
    }

    /// The motion at a time t [s] from the beginning, at a kink that which follows.
    fn at(&self, t: f64) -> Kinematics {
        match self {
            Self::Trapezoid { acceleration: a, ramp, middle } => {
                let (top, all) = (a * ramp, a * ramp * (ramp + middle));
                match t {
                    t if t < 0.0 => [0.0; 4],
                    t if t < *ramp => [0.5 * a * t * t, a * t, *a, 0.0],
                    t if t < ramp + middle => [top * (t - 0.5 * ramp), top, 0.0, 0.0],
                    t if t < ramp + middle + ramp => {
                        let left = ramp + middle + ramp - t;
                        [all - 0.5 * a * left * left, a * left, -a, 0.0]
                    }
                    _ => [all, 0.0, 0.0, 0.0],
                }
            }
            Self::Rise { law, distance, duration } => law.at(t, *distance, *duration),
            Self::ConstantSpeed(_) if t < 0.0 => [0.0; 4],
            Self::ConstantSpeed(speed) => [speed * t, *speed, 0.0, 0.0],
            Self::Table(table) => {
                let [value, slope, curvature] = table.at(t);
                [value, slope, curvature, table.third(t)]
            }
        }
    }
}

impl Profile {
    /// The motion at a time t [s] of a step that begins so long after the motion was first prescribed, a time [s] and
    /// what its rounding has lost; at a kink that which follows. Within a step it is smooth to rounding of t, however
    /// late.
    pub fn at(&self, [since, lost]: Since, t: f64) -> Kinematics {
        let t = (since - self.start_time) + (lost + t);
        let close = self.close();
        let kink = self.shape.kinks(t).into_iter().find(|kink| (kink - t).abs() <= close);
        match (&self.shape, kink) {
            // A table may begin at any speed; before it the drive is at rest.
            (Shape::Table(table), None) if t < 0.0 => [table.at(0.0)[0], 0.0, 0.0, 0.0],
            _ => self.shape.at(kink.unwrap_or(t)),
        }
    }

    /// The first kink after a time t [s] of a step that begins so long after the motion was first prescribed, as a time
    /// of this step; infinite if none follows.
    pub fn next_kink(&self, [since, lost]: Since, t: f64) -> f64 {
        let close = self.close();
        let kinks = self.shape.kinks((since - self.start_time) + (lost + t));
        let kinks = kinks.into_iter().map(|kink| (kink - (since - self.start_time)) - lost);
        kinks.filter(|kink| *kink > t + close).fold(f64::INFINITY, f64::min)
    }

    /// The last time before a kink that does not count as that of the kink, both since the motion was first
    /// prescribed [s].
    pub fn just_before(&self, kink: f64) -> f64 {
        kink - 2.0 * self.close()
    }

    /// Distance of a time from a kink at which it counts as that of the kink [s].
    fn close(&self) -> f64 {
        let duration = match self.shape {
            Shape::ConstantSpeed(_) => self.start_time,
            _ => self.shape.duration(),
        };
        CLOSE * (duration + self.start_time.min(LATE * duration))
    }

    /// Time at which the last kink is [s].
    pub fn end(&self) -> f64 {
        self.start_time + self.shape.duration()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::monotone::monotone;

    fn all() -> Vec<Profile> {
        let (distance, duration) = (-0.7, 0.8);
        let rise = |law| Shape::Rise { law, distance, duration };
        let table = monotone(&[[0.0, 0.0], [0.1, 0.0], [0.3, -0.4], [0.5, -0.2], [0.8, -0.7], [1.0, -0.7]]).unwrap();
        let shapes = [
            Shape::trapezoid(distance, 1.5, 8.0),
            Shape::trapezoid(distance, 3.0, 8.0),
            rise(Rise::Cycloidal),
            rise(Rise::Polynomial345),
            rise(Rise::Polynomial4567),
            Shape::Table(table),
        ];
        shapes.map(|shape| Profile { start_time: 0.25, shape }).into()
    }

    #[test]
    fn each_profile_goes_its_distance_from_rest_to_rest() {
        for profile in all() {
            assert_eq!(profile.at([0.0; 2], 0.1), [0.0; 4]);
            let end = profile.at([0.0; 2], profile.end() + 1e-9);
            assert!((end[0] + 0.7).abs() < 1e-14 && end[1..] == [0.0; 3], "{profile:?} {end:?}");
            let before = profile.at([0.0; 2], profile.end() - 1e-9);
            assert!((before[0] + 0.7).abs() < 1e-8 && before[1].abs() < 1e-7, "{profile:?} {before:?}");
        }
    }

    #[test]
    fn speeds_near_the_end_are_exact_in_relation_to_themselves() {
        // 140 u^3 (1 - u)^3 and 30 u^2 (1 - u)^2 near u = 1, times D / T; the cycloid's 1 - cos(2 pi u) likewise.
        let w = 2.0_f64.powi(-12);
        let (u, mean) = (1.0 - w, -0.7 / 0.8);
        let exact = [2.0 * (std::f64::consts::PI * w).sin().powi(2), 30.0 * (u * w).powi(2), 140.0 * (u * w).powi(3)];
        for (profile, exact) in all()[2..5].iter().zip(exact) {
            let [_, speed, ..] = profile.shape.at(0.8 * u);
            assert!((speed / (mean * exact) - 1.0).abs() < 1e-11, "{profile:?}: {speed:e}");
        }
    }

    #[test]
    fn each_derivative_is_that_of_the_one_before() {
        let h = 1e-5;
        for profile in all() {
            for k in 0..200 {
                let t = 0.2 + 0.0061 * f64::from(k);
                if profile.next_kink([0.0; 2], t - 2.0 * h) < t + 2.0 * h {
                    continue;
                }
                let [now, before, after] = [t, t - h, t + h].map(|t| profile.at([0.0; 2], t));
                for order in 0..3 {
                    let slope = (after[order] - before[order]) / (2.0 * h);
                    let size = now[order + 1].abs().max(100.0_f64.powi(order as i32));
                    assert!((slope - now[order + 1]).abs() < 1e-5 * size, "{profile:?} {t} {order}: {slope} {now:?}");
                }
            }
        }
    }

    #[test]
    fn a_trapezoid_keeps_its_limits_and_takes_the_least_time() {
        // 0.7 m at 1.5 m/s and 8 m/s2: v / a + D / v; at 3 m/s the speed is not reached: 2 sqrt(D / a).
        let times = [1.5 / 8.0 + 0.7 / 1.5, 2.0 * (0.7_f64 / 8.0).sqrt()];
        for (profile, time) in all().iter().zip(times) {
            assert!((profile.shape.duration() - time).abs() < 1e-15);
        }
        let Shape::Trapezoid { ramp, middle, .. } = all()[0].shape else { unreachable!() };
        assert_eq!([ramp, middle], [1.5 / 8.0, 0.7 / 1.5 - 1.5 / 8.0]);
    }

    #[test]
    fn a_time_within_rounding_of_a_kink_is_that_of_the_kink() {
        let profile = Profile { start_time: 0.3, shape: Shape::trapezoid(1.0, 1.0, 10.0) };
        assert_eq!(profile.at([0.0; 2], 0.1 + 0.2 - 1e-16)[2], 10.0);
        assert_eq!(profile.at([0.0; 2], 0.3 - 1e-6)[2], 0.0);
        assert!((profile.next_kink([0.0; 2], 0.3) - 0.4).abs() < 1e-15);
    }

    /// Late in a run a step sees the motion as smooth as at the beginning; before a table the drive is at rest.
    #[test]
    fn a_late_profile_is_smooth_within_a_step_and_begins_at_rest() {
        let shape = Shape::Rise { law: Rise::Polynomial345, distance: 1.0, duration: 0.5 };
        let [early, late] = [0.0, 1e9].map(|start_time| Profile { start_time, shape: shape.clone() });
        for k in 1..50 {
            let t = 0.01 * f64::from(k);
            assert_eq!(late.at([1e9, 0.0], t), early.at([0.0; 2], t));
        }
        assert_eq!(late.next_kink([1e9, 0.0], 0.01), 0.5);
        // What the sum of the steps has lost counts.
        assert_eq!(late.at([1e9, 1e-9], 0.1), early.at([1e-9, 0.0], 0.1));
        let table = Shape::Table(monotone(&[[0.0, 0.0], [1.0, 2.0]]).unwrap());
        let constant = Profile { start_time: 0.3, shape: Shape::ConstantSpeed(-2.0) };
        assert_eq!(constant.at([0.0; 2], 0.2), [0.0; 4]);
        assert_eq!(constant.next_kink([0.0; 2], 0.2), 0.3);
        assert_eq!(constant.at([0.0; 2], 0.1 + 0.2 - 1e-16)[1], -2.0);
        assert_eq!(constant.at([1e9, 0.0], 0.5), [-2.0 * (1e9 - 0.3 + 0.5), -2.0, 0.0, 0.0]);
        assert_eq!(constant.next_kink([0.0; 2], 0.3), f64::INFINITY);
        let profile = Profile { start_time: 0.5, shape: table };
        assert_eq!(profile.at([0.0; 2], 0.2), [0.0; 4]);
        assert_eq!(profile.next_kink([0.0; 2], 0.2), 0.5);
        assert_eq!(profile.at([0.0; 2], 0.5)[1], 2.0);
        assert_eq!(profile.at([0.5, 0.0], 0.5)[0], 1.0);
    }
}
