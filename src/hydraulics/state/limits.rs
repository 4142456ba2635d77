//! The element at stops and locks: where they hold it, where it comes to a stop, where it leaves one.
//!
//! In: an element with its limits, an integration of it with the circuit. Out: the state at an instant of the step, and
//! what the limits did until then. An impact is plastic: the speed is 0 after it. It must not know inputs.
use super::march::{Levels, March};
use crate::hydraulics::error::HydraulicsError;
use crate::hydraulics::systems::{Coupled, ELEMENT, Element, IMPULSE, LENGTH, MOMENT, SPEED};
use crate::integrator::{Direction, Integrator, Step};
use crate::numerics::dual::Number;

/// Most halvings that find the instant at which an element leaves a stop.
const HALVINGS: usize = 60;

/// What limits did to the element over a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Whether they held it at the beginning.
    pub held_at_start: bool,
    /// Whether they hold it at the end.
    pub held_at_end: bool,
    /// Whether it left them: impulse and moment of the force are then those that give the motion from the beginning on.
    pub released: bool,
}

/// Whether limits hold an element at rest at a length under this sum of force and load [N].
pub fn holds([lower, upper]: [f64; 2], length: f64, net: f64) -> bool {
    length <= lower && net <= 0.0 || length >= upper && net >= 0.0
}

/// Force less load [N] of an element that rests.
fn net(system: &Coupled<'_>, y: &[f64; ELEMENT], t: f64) -> f64 {
    system.laws.force([y[0], y[1]], 0.0) - system.element.load_at(y[LENGTH], t)
}

/// The limit beyond which a length is, and the direction in which a motion to there passes it.
pub fn passed([lower, upper]: [f64; 2], end: f64) -> Option<(f64, Direction)> {
    if end > upper {
        Some((upper, Direction::Rising))
    } else if end < lower {
        Some((lower, Direction::Falling))
    } else {
        None
    }
}

impl Coupled<'_> {
    /// Whether limits hold the element at the beginning of a step; a motion that leads out of them stops there.
    pub fn begin(&mut self, y: &mut [f64; ELEMENT]) -> Course {
        let (limits, length, speed) = (self.element.limits, y[LENGTH], y[SPEED]);
        if speed > 0.0 && length >= limits[1] || speed < 0.0 && length <= limits[0] {
            y[SPEED] = 0.0;
        }
        self.is_held = y[SPEED] == 0.0 && holds(limits, length, net(self, y, 0.0));
        Course { held_at_start: self.is_held, ..Course::default() }
    }
}

impl March<'_> {
    /// [`Self::to`] with an element that limits may hold.
    pub fn within_limits(
        &mut self,
        end: f64,
        memory: &mut Integrator<ELEMENT>,
        system: &mut Coupled<'_>,
        (y, course): (&mut [f64; ELEMENT], &mut Course),
        levels: &Levels,
    ) -> Result<bool, HydraulicsError> {
        while self.t < end {
            let Some(step) = self.once(end, memory, system, y, levels)? else { return Ok(false) };
            if system.is_held {
                let at = |s: f64, y: &[f64; ELEMENT], system: &Coupled<'_>| {
                    holds(system.element.limits, y[LENGTH], net(system, y, step.t + s * step.h))
                };
                if at(1.0, &step.end, system) {
                    self.take(&step, y, end);
                } else {
                    let step = leave(memory, system, step, &at);
                    self.take(&step, y, end);
                    self.leave(memory, system, y, course);
                }
            } else if let Some((limit, direction)) = passed(system.element.limits, step.end[LENGTH]) {
                let step = meet(memory, system, step, limit, direction);
                self.take(&step, y, end);
                (y[LENGTH], y[SPEED]) = (limit, 0.0);
                system.is_held = holds(system.element.limits, limit, net(system, y, self.t));
                memory.restart();
            } else {
                self.take(&step, y, end);
            }
        }
        course.held_at_end = system.is_held;
        Ok(true)
    }

    /// The element leaves the limit at the present instant. Where it was held since the beginning, a force that gives
    /// its motion to what has been at rest until now equals the load so long.
    fn leave(
        &self,
        memory: &mut Integrator<ELEMENT>,
        system: &mut Coupled<'_>,
        y: &mut [f64; ELEMENT],
        course: &mut Course,
    ) {
        system.is_held = false;
        memory.refresh();
        if course.held_at_start && !course.released {
            let Element { load, load_rate, .. } = system.element;
            let t = self.t;
            y[IMPULSE] = t * (load + 0.5 * load_rate * t);
            y[MOMENT] = t * t * (0.5 * load + load_rate * t / 3.0);
            course.released = true;
        }
    }
}

/// The step again, up to where the motion passes a limit.
#[cold]
fn meet(
    memory: &mut Integrator<ELEMENT>,
    system: &mut Coupled<'_>,
    step: Step<ELEMENT>,
    limit: f64,
    direction: Direction,
) -> Step<ELEMENT> {
    let starts_there = passed([step.start[LENGTH]; 2], limit).is_none_or(|(_, to)| to != direction);
    let part = memory.dense(system, &step).first_passage(LENGTH, limit, direction, starts_there);
    match part {
        Some(part) if part > 0.0 && part < 1.0 => memory.retake(system, &step, part * step.h),
        _ => step,
    }
}

/// The step again, up to where the limit no longer holds the element.
#[cold]
fn leave(
    memory: &mut Integrator<ELEMENT>,
    system: &mut Coupled<'_>,
    step: Step<ELEMENT>,
    held: &dyn Fn(f64, &[f64; ELEMENT], &Coupled<'_>) -> bool,
) -> Step<ELEMENT> {
    let dense = memory.dense(system, &step);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if held(middle, &dense.at(middle), system) { low = middle } else { high = middle }
    }
    if high < 1.0 { memory.retake(system, &step, high * step.h) } else { step }
}

/// Value and rate [N], [N/s] of the line that gives an element which a limit has held its motion from rest over a step
/// of size h: from where the line passes the load on, its impulse and moment beyond the load are those of the motion.
pub fn line_from_rest<T: Number>(load: T, [impulse, moment]: [T; 2], h: T) -> [T; 2] {
    // Beyond the load: c (t - h + d) over the last d of the step has the impulse c d^2/2 and the way c d^3/6.
    let gain = impulse - load * h;
    let way = gain * h - (moment - load * h * h * 0.5);
    let d = way * 3.0 / gain;
    let rate = gain * 2.0 / (d * d);
    [load - rate * (h - d), rate]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_holds_against_what_presses_on_it_and_a_lock_against_all() {
        assert!(holds([0.1, 0.5], 0.5, 3.0) && !holds([0.1, 0.5], 0.5, -3.0) && !holds([0.1, 0.5], 0.4, 3.0));
        assert!(holds([0.1, 0.5], 0.1, -3.0) && !holds([0.1, 0.5], 0.1, 3.0));
        assert!([-3.0, 0.0, 3.0].into_iter().all(|net| holds([0.3, 0.3], 0.3, net)));
    }

    /// A force that grows from the load on at the time 6 of 10 s: the line is that force.
    #[test]
    fn the_line_from_rest_is_a_force_that_grows_late() {
        let (load, rate, begin, h) = (100.0, 7.0, 6.0, 10.0);
        let d: f64 = h - begin;
        let impulse = load * h + 0.5 * rate * d * d;
        let moment = 0.5 * load * h * h + rate * d * d * (0.5 * begin + d / 3.0);
        let [value, found] = line_from_rest(load, [impulse, moment], h);
        assert!((found - rate).abs() < 1e-12 && (value - (load - rate * begin)).abs() < 1e-11, "{value} {found}");
    }
}
