//! What the predicted motion of the next step gives, in the words of the interface.
//!
//! In: the element, force and motion at the beginning, the state at the end, what limits did until then. Out: the line
//! of the force, its mean, motion and accelerations at the end. It must not know how the motion was predicted.
use super::limits::{Course, line_from_rest};
use crate::circuit::{Equations, settling_acceleration};
use crate::systems::{ELEMENT, Element, IMPULSE, LENGTH, MOMENT, SPEED};
use foundation::numerics::dual::Number;

/// What the foreseen motion tells of a step of size h, in the words of the interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preview<T> {
    /// Value and rate of the line with the impulse and the first moment of the force [N], [N/s].
    pub force: T,
    pub force_rate: T,
    /// Mean force [N].
    pub force_mean: T,
    /// Length and speed at the end [m], [m/s].
    pub length: T,
    pub speed: T,
    /// Accelerations under the force at the beginning and at the end [m/s2].
    pub start_acceleration: T,
    pub acceleration: T,
}

impl<T: Number> Preview<T> {
    /// From the element, the force, length and speed at the beginning, the state at the end with what limits did until
    /// then, and the step.
    pub fn new(
        laws: &Equations,
        element: &Element<T>,
        (first, [length, speed]): (T, [T; 2]),
        (end, course): (&[T; ELEMENT], Course),
        h: T,
    ) -> Self {
        let (mean, moment) = (end[IMPULSE] / h, end[MOMENT] / (h * h));
        let rate = (moment * 2.0 - mean) * 6.0 / h;
        let last = laws.force([end[0], end[1]], end[SPEED]);
        let (mut force, mut rate) = (mean - rate * h * 0.5, rate);
        // A line that presses on the stop first would lose that impulse to the stop.
        if course.released && ((force - element.load) * (mean - element.load)).value() < 0.0 {
            [force, rate] = line_from_rest(element.load, [end[IMPULSE], end[MOMENT]], h);
        }
        // Where the piston rests on its end, a mean force that is held brings the mechanism there.
        let mut force_mean = mean;
        if course.rests_on_end {
            let acceleration = settling_acceleration([length, end[LENGTH]], speed, course.settling, h);
            force_mean = element.load_at(end[LENGTH], h * 0.5) - element.mass * acceleration;
        }
        let held = T::constant(0.0);
        let acceleration = |is_held, force, length, speed, t| {
            if is_held { held } else { element.acceleration(force, length, speed, t) }
        };
        Self {
            force,
            force_rate: rate,
            force_mean,
            length: end[LENGTH],
            speed: end[SPEED],
            start_acceleration: acceleration(course.held_at_start, first, element.length, speed, held),
            acceleration: acceleration(course.held_at_end, last, end[LENGTH], end[SPEED], h),
        }
    }

    /// With values that nothing changes.
    pub fn constant<U: Number>(&self) -> Preview<U> {
        let [force, force_rate, force_mean, length, speed, start_acceleration, acceleration] =
            self.values().map(|value| U::constant(value.value()));
        Preview { force, force_rate, force_mean, length, speed, start_acceleration, acceleration }
    }

    /// All values.
    pub fn values(&self) -> [T; 7] {
        let Self { force, force_rate, force_mean, length, speed, start_acceleration, acceleration } = *self;
        [force, force_rate, force_mean, length, speed, start_acceleration, acceleration]
    }

    /// Where none is foreseen: the present force, and the motion of the inputs. `start_acceleration`: under that force.
    pub fn blind(force: T, [length, speed, acceleration]: [T; 3], start_acceleration: T, h: T) -> Self {
        Self {
            force,
            force_rate: T::constant(0.0),
            force_mean: force,
            length: length + speed * h,
            speed,
            start_acceleration,
            acceleration,
        }
    }
}
