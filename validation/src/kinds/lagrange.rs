//! Motion by Lagrange's equation in the parameter of a closed form, with a separate integration.
//!
//! With the inertia I(s) = sum of m |c'|^2 + J theta'^2 and the generalised force Q: I s'' = Q - I'/2 s'^2. The
//! extrapolation method of Gragg, Bulirsch and Stoer, based on the midpoint rule, integrates it.
//!
//! In: a sketch. Out: the parameter and its rate over time. Must not depend on the engine.
use super::jet::{Jet, Vector};
use super::sketch::{Miss, Pose, Sketch, Spring};
use crate::extrapolation;

/// Greatest number of columns of the extrapolation.
const COLUMNS: usize = 8;
/// Relative error of a step.
const ERROR: f64 = 2e-14;
/// Rate after an impact below which the mechanism rests, relative to the largest rate so far.
const SLOW: f64 = 1e-9;
/// Rate of an impact without restitution, relative to the largest rate so far, below which the contact is grazing:
/// errors of the size of the tolerance then decide whether the stop is reached.
const GRAZE: f64 = 1e-3;
/// Number of steps after which a motion counts as failed: a damper makes it stiff.
const STEPS: u32 = 4000;
/// Steps of the search for an impact.
const SEARCH: u32 = 60;

/// Result of the integration over a time span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// The end of the span is reached.
    Reached,
    /// The motion leaves the range of the closed form, or the integration has failed.
    Left,
}

/// A mechanism in motion.
#[derive(Clone)]
pub struct Motion<'a> {
    sketch: &'a Sketch,
    /// Parameter and rate.
    pub state: [f64; 2],
    /// Largest rate so far.
    pub fastest: f64,
    /// Whether a stop holds it at rest.
    pub held: bool,
    /// Sign of the rate with which it left a stop from rest. Without a damper it returns to that stop with the rate 0:
    /// grazing contact.
    released: f64,
    step: f64,
    taken: u32,
}

/// Positions of all points and bodies at one parameter.
pub struct Place {
    pub places: Vec<Vector>,
    pub poses: Vec<Pose>,
}

impl Place {
    pub fn of(sketch: &Sketch, s: f64) -> Result<Self, Miss> {
        let places = (sketch.places)(Jet::variable(s))?;
        let poses = sketch.poses(&places);
        Ok(Self { places, poses })
    }

    /// Inertia and half its derivative.
    pub fn inertia(&self, sketch: &Sketch) -> [f64; 2] {
        let (mut inertia, mut half) = (0.0, 0.0);
        for (body, pose) in sketch.bodies.iter().zip(&self.poses) {
            let center = Sketch::at(pose, body.center);
            for (mass, x) in [(body.mass, center.x), (body.mass, center.y), (body.inertia, pose.angle)] {
                inertia += mass * x.slope() * x.slope();
                half += mass * x.slope() * x.bend();
            }
        }
        [inertia, half]
    }

    /// Generalised force at a rate of the parameter.
    pub fn force(&self, sketch: &Sketch, rate: f64) -> f64 {
        let [g, up] = sketch.loads.gravity;
        let mut force = 0.0;
        for (body, pose) in sketch.bodies.iter().zip(&self.poses) {
            let center = Sketch::at(pose, body.center);
            force -= body.mass * g * (up.cos() * center.x.slope() + up.sin() * center.y.slope());
        }
        for (body, torque) in &sketch.loads.torques {
            force += torque * self.poses[*body].angle.slope();
        }
        for spring in &sketch.loads.springs {
            let [pull, length] = self.pull(spring, rate);
            force -= pull * length;
        }
        force
    }

    /// Force of a spring at a rate, and the derivative of its length.
    pub fn pull(&self, spring: &Spring, rate: f64) -> [f64; 2] {
        let length = (self.places[spring.end] - Vector::fixed(spring.anchor)).norm();
        let force = spring.stiffness * (length.value() - spring.free) + spring.damping * length.slope() * rate;
        [force, length.slope()]
    }

    /// The coordinate of the sketch.
    pub fn value(&self, sketch: &Sketch) -> Jet {
        sketch.value(sketch.coordinate, &self.places, &self.poses)
    }
}

impl<'a> Motion<'a> {
    /// The motion at its start.
    pub fn new(sketch: &'a Sketch) -> Self {
        let fastest = sketch.start[1].abs();
        Self { sketch, state: sketch.start, fastest, held: false, released: 0.0, step: 1e-3, taken: 0 }
    }

    /// This motion with its state changed by `perturbation` and its rate by that fraction.
    pub fn perturbed(&self, perturbation: f64) -> Self {
        let [s, rate] = self.state;
        Self { state: [s + perturbation, rate * (1.0 + perturbation)], ..self.clone() }
    }

    fn acceleration(&self, [s, rate]: [f64; 2]) -> Result<f64, Miss> {
        let place = Place::of(self.sketch, s)?;
        let [inertia, half] = place.inertia(self.sketch);
        Ok((place.force(self.sketch, rate) - half * rate * rate) / inertia)
    }

    /// A step; None if its error is too large.
    fn step(&self, h: f64) -> Result<Option<[f64; 2]>, Miss> {
        let scales = [1.0 + self.state[0].abs() * 0.01, self.fastest.max(1e-3)];
        let mut f = |_: f64, y: &[f64; 2]| self.acceleration(*y).map(|a| [y[1], a]);
        let agree = |a: &[f64; 2], b: &[f64; 2]| (0..2).all(|n| (a[n] - b[n]).abs() <= ERROR * scales[n]);
        let (end, is_met) = extrapolation::step(&mut f, 0.0, &self.state, h, COLUMNS, agree)?;
        Ok(is_met.then_some(end))
    }

    /// Distance of the coordinate beyond the stop; an angle is continuous, within half a turn of the middle of the
    /// stops.
    fn beyond(&self, s: f64) -> Result<f64, Miss> {
        let [low, high] = &self.sketch.stops[..] else { return Ok(-1.0) };
        let middle = 0.5 * (low.value + high.value);
        let value = middle + self.sketch.apart(Place::of(self.sketch, s)?.value(self.sketch).value(), middle);
        Ok((low.value - value).max(value - high.value))
    }

    /// Integrate over a time span.
    pub fn advance(&mut self, span: f64) -> End {
        let mut t = 0.0;
        while self.taken < STEPS {
            self.taken += 1;
            if self.held || t >= span * (1.0 - 1e-15) {
                return End::Reached;
            }
            let h = self.step.min(span - t);
            let Ok(Some(end)) = self.step(h) else {
                if h < 1e-9 {
                    return End::Left;
                }
                self.step = 0.5 * h;
                continue;
            };
            // A step may pass a stop and return: the farthest position is where the motion reverses.
            let turned = !self.sketch.stops.is_empty() && self.state[1] * end[1] < 0.0;
            let (out, farthest) = match turned.then(|| self.turn(h)) {
                None => (h, end),
                Some(Some(turn)) => turn,
                Some(None) => return End::Left,
            };
            let (h, end) = match self.beyond(farthest[0]) {
                Ok(beyond) if beyond > 0.0 => (out, farthest),
                _ => (h, end),
            };
            match self.beyond(end[0]) {
                Err(_) => return End::Left,
                Ok(beyond) if beyond > 0.0 => {
                    let Some(h) = self.impact(h) else { return End::Left };
                    t += h;
                }
                Ok(_) => {
                    if self.state[1] * self.released < 0.0 && end[1] * self.released >= 0.0 {
                        return End::Left;
                    }
                    (self.state, t) = (end, t + h);
                    self.step = 1.5 * h.max(1e-8);
                }
            }
            self.fastest = self.fastest.max(self.state[1].abs());
        }
        End::Left
    }

    /// Time of the sign change of the rate within a step, and the state there.
    fn turn(&self, h: f64) -> Option<(f64, [f64; 2])> {
        let (mut low, mut high, mut there) = (0.0, h, self.state);
        for _ in 0..SEARCH {
            let middle = 0.5 * (low + high);
            there = self.step(middle).ok()??;
            if there[1] * self.state[1] > 0.0 {
                low = middle
            } else {
                high = middle
            }
            if there[1].abs() < 1e-9 * self.fastest {
                break;
            }
        }
        Some((high, there))
    }

    /// Advance to the impact on the stop within a step and apply the restitution. Returns the time to the impact.
    fn impact(&mut self, h: f64) -> Option<f64> {
        // Newton's method on the length of the step, bracketed by lengths before and beyond the stop.
        let (mut low, mut high, mut at) = (0.0, h, h);
        let mut end = self.state;
        for _ in 0..SEARCH {
            end = self.step(at).ok()??;
            let beyond = self.beyond(end[0]).ok()?;
            if beyond > 0.0 {
                high = at
            } else {
                low = at
            }
            let place = Place::of(self.sketch, end[0]).ok()?;
            let next = at - beyond / (place.value(self.sketch).slope() * end[1]).abs();
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if beyond.abs() < 1e-15 || (next - at).abs() <= 1e-15 * h || high - low <= 1e-16 {
                break;
            }
            at = next;
        }
        let restitution = self.sketch.stops.first()?.rigid?;
        let rate = end[1];
        if restitution == 0.0 && rate.abs() < GRAZE * self.fastest {
            return None;
        }
        self.state = [end[0], -restitution * rate];
        if restitution * rate.abs() < SLOW * self.fastest {
            let pressed = self.acceleration([end[0], 0.0]).ok()? * rate >= 0.0;
            self.state[1] = 0.0;
            self.held = pressed;
            self.released = if restitution == 0.0 && !pressed { -rate } else { 0.0 };
        }
        Some(at)
    }
}
