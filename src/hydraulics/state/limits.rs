//! The element at stops and locks, and at the ends of the cylinder: where they hold it, where it comes to a stop, where
//! it leaves one.
//!
//! In: an element with its limits, an integration of it with the circuit. Out: the state at an instant of the step, and
//! what the limits did until then. An impact on a stop is plastic: the speed is 0 after it. It must not know inputs.
//!
//! A stop or a lock holds the mechanism whatever the force of the actuator, so that the force is that of the oil. An
//! end of the cylinder holds the mechanism by the actuator alone: while the piston rests there, the force is the load,
//! and an impact is an impulse m (v' - v) of the force.
use super::march::{Levels, March};
use crate::error::HydraulicsError;
use crate::systems::{Coupled, ELEMENT, Element, Hold, IMPULSE, LENGTH, MOMENT, SPEED};
use foundation::integrator::{Direction, Integrator, Step};
use foundation::numerics::dual::Number;

/// Most halvings that find the instant at which an element leaves a stop.
const HALVINGS: usize = 60;

/// What limits did to the element over a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Whether they held it at the beginning.
    pub held_at_start: bool,
    /// Whether they hold it at the end.
    pub held_at_end: bool,
    /// Whether it left a stop: impulse and moment of the force are then those that give the motion from the beginning
    /// on.
    pub released: bool,
    /// Whether the piston was at an end of the cylinder.
    pub met_end: bool,
    /// Whether the piston rests there at the end of the step.
    pub rests_on_end: bool,
    /// Time [s], at least the step, in which a mean force that is held brings the mechanism there.
    pub settling: f64,
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
    /// What holds the element at rest at a length under this sum of force and load [N].
    fn hold_at(&self, length: f64, net: f64) -> Hold {
        if holds(self.element.limits, length, net) {
            Hold::Stop
        } else if holds(self.laws.lengths(), length, net) {
            Hold::End
        } else {
            Hold::Free
        }
    }

    /// What holds the element at the beginning of a step; a motion that leads out of its limits stops there. `rests`:
    /// whether the piston has rested at the end that is nearer, and has not left it since. Where the mechanism is not
    /// quite there, impulse and moment begin with what brings it there.
    pub fn begin(&mut self, y: &mut [f64; ELEMENT], rests: bool) -> Course {
        let (limits, length) = (self.element.limits, y[LENGTH]);
        if y[SPEED] > 0.0 && length >= limits[1] || y[SPEED] < 0.0 && length <= limits[0] {
            y[SPEED] = 0.0;
        }
        let is_stopped = y[SPEED] == 0.0 && holds(limits, length, net(self, y, 0.0));
        self.hold = if is_stopped { Hold::Stop } else { Hold::Free };
        let mut course = Course { held_at_start: is_stopped, ..Course::default() };
        let (end, outward) = self.laws.nearer_end(length);
        let is_beyond = (length - end) * outward >= 0.0;
        if is_stopped || !(rests || is_beyond) {
            return course;
        }
        let (net, speed) = (net(self, y, 0.0), y[SPEED]);
        let rests = rests && net * outward >= 0.0;
        if rests || is_beyond {
            y[LENGTH] = end;
            if rests {
                y[SPEED] = 0.0;
            } else if speed * outward > 0.0 {
                y[SPEED] = self.laws.after_impact(self.element.mass, speed, net * outward);
            }
            if y[SPEED] == 0.0 {
                self.hold = self.hold_at(end, net);
            }
            y[IMPULSE] = self.element.mass * (y[SPEED] - speed);
            y[MOMENT] = self.element.mass * (length - end);
            (course.held_at_start, course.met_end) = (self.hold.is_held(), true);
        }
        course
    }

    /// The element has come to a limit, t [s] after the beginning.
    fn arrive(&mut self, y: &mut [f64; ELEMENT], t: f64, (limit, direction): (f64, Direction), course: &mut Course) {
        y[LENGTH] = limit;
        if self.element.limits.contains(&limit) {
            y[SPEED] = 0.0;
        } else {
            let pressing = net(self, y, t) * if direction == Direction::Rising { 1.0 } else { -1.0 };
            let after = self.laws.after_impact(self.element.mass, y[SPEED], pressing);
            let mass = self.element.mass + self.element.mass_derivative * (limit - self.element.length);
            let impulse = mass * (after - y[SPEED]);
            y[SPEED] = after;
            y[IMPULSE] += impulse;
            y[MOMENT] += impulse * t;
            course.met_end = true;
        }
        self.hold = if y[SPEED] == 0.0 { self.hold_at(limit, net(self, y, t)) } else { Hold::Free };
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
        let ([lower, upper], [least, most]) = (system.element.limits, system.laws.lengths());
        let limits = [lower.max(least), upper.min(most)];
        while self.t < end {
            let Some(step) = self.once(end, memory, system, y, levels)? else { return Ok(false) };
            let step = self.cut_at_event(memory, system, step);
            if system.hold.is_held() {
                let at = |s: f64, y: &[f64; ELEMENT], system: &Coupled<'_>| {
                    system.hold_at(y[LENGTH], net(system, y, step.t + s * step.h)).is_held()
                };
                if at(1.0, &step.end, system) {
                    self.take(&step, y, end);
                } else {
                    self.forget_event();
                    let step = leave(memory, system, step, &at);
                    self.take(&step, y, end);
                    self.leave(memory, system, y, course);
                }
            } else if let Some((limit, direction)) = passed(limits, step.end[LENGTH]) {
                self.forget_event();
                let step = meet(memory, system, step, limit, direction);
                self.take(&step, y, end);
                system.arrive(y, self.t, (limit, direction), course);
                memory.restart();
                if system.laws.lengths().contains(&limit) {
                    self.meet_end(step.start[LENGTH], limit);
                }
            } else {
                self.take(&step, y, end);
            }
            if self.event().is_some() {
                break;
            }
        }
        course.held_at_end = system.hold.is_held();
        course.rests_on_end = system.hold == Hold::End;
        Ok(self.t >= end && self.event().is_none())
    }

    /// The element leaves the limit at the present instant. Where a stop has held it since the beginning, a force that
    /// gives its motion to what has been at rest until now equals the load so long.
    fn leave(
        &self,
        memory: &mut Integrator<ELEMENT>,
        system: &mut Coupled<'_>,
        y: &mut [f64; ELEMENT],
        course: &mut Course,
    ) {
        let was_stopped = system.hold == Hold::Stop;
        system.hold = Hold::Free;
        memory.refresh();
        if was_stopped && course.held_at_start && !course.released {
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
