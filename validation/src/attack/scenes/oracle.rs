//! The independent integration: the Dormand-Prince method on absolute coordinates, events by bisection of a step.
//!
//! In: a machine, loads, time spans. Out: positions and speeds. It uses quantities and their stops only, no positions
//! along a curve, and must not depend on the engine.
use super::newton::{Coordinates, Newton};
use crate::kinds::sketch::{Coordinate, Sketch, Stop};

/// Depth beyond a stop at which it counts as reached [m or rad], greater than the rounding error of the constraints.
const DEPTH: f64 = 1e-11;
/// Speed of an impact below which the machine rests [m/s or rad/s].
const SLOW: f64 = 1e-6;
/// Number of events after which a span counts as failed.
const EVENTS: usize = 3000;

/// Dormand and Prince (1980): stages, and the difference of the two solutions.
const STAGES: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// The element that holds the machine at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Held {
    Stop(usize),
    Lock,
    /// The losses of the drive.
    Drive,
}

/// Events within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    Lock,
    Stop(usize),
    /// The drive's power changes its sign.
    Drive,
    /// The law of friction changes its branch in a joint: the step ends there, without further action.
    Friction,
}

/// Positions and speeds.
#[derive(Clone, Copy, Debug)]
pub struct State {
    pub q: Coordinates,
    pub v: Coordinates,
}

/// A machine in motion.
#[derive(Clone)]
pub struct Oracle<'a> {
    newton: Newton<'a>,
    /// Coordinate that the drive acts on, and its efficiency.
    drive: (Coordinate, f64),
    pub state: State,
    touching: Vec<bool>,
    pub held: Option<Held>,
    /// Stop whose lock is engaged, and whether the machine was beyond the stop at engagement.
    lock: Option<(usize, bool)>,
    /// Whether the drive's power is transferred into the mechanism.
    forward: bool,
    load: f64,
    /// Largest step [s], allowed error of a step, and the next step [s].
    most: f64,
    error: f64,
    next: f64,
    /// Largest speed of the coordinate so far.
    pub fastest: f64,
}

fn axpy(sum: &mut Coordinates, factor: f64, x: &Coordinates) {
    sum.iter_mut().zip(x).for_each(|(sum, x)| *sum += factor * x);
}

impl<'a> Oracle<'a> {
    /// The machine at its start.
    pub fn new(sketch: &'a Sketch, most: f64, error: f64) -> Option<Self> {
        let newton = Newton::new(sketch)?;
        let mut state = State { q: newton.start, v: [0.0; 9] };
        newton.project(&mut state.q, &mut state.v);
        let [_, speed] = sketch.start;
        state.v = newton.free_motion(sketch.coordinate, &state.q)?.map(|x| x * speed);
        let (touching, drive) = (vec![false; sketch.stops.len()], sketch.loads.drive?);
        let (held, lock, forward, load, next, fastest) = (None, None, true, 0.0, 1e-5, speed.abs());
        Some(Self { newton, drive, state, touching, held, lock, forward, load, most, error, next, fastest })
    }

    /// This state with the coordinate changed by `perturbation` and its speed by that fraction. None if the machine is
    /// held or at a dead centre of the coordinate.
    pub fn perturbed(&self, perturbation: f64) -> Option<Self> {
        /// Largest allowed ratio of the change of another coordinate to that of the machine's coordinate.
        const LEVER: f64 = 1e3;
        let mut moved = self.clone();
        let coordinate = self.sketch().coordinate;
        let motion = moved.newton.free_motion(coordinate, &self.state.q)?;
        if self.held.is_some() || motion.iter().any(|part| part.is_nan() || part.abs() > LEVER) {
            return None;
        }
        let speed = self.coordinate()[1];
        axpy(&mut moved.state.q, perturbation, &motion);
        moved.newton.project(&mut moved.state.q, &mut moved.state.v);
        let motion = moved.newton.free_motion(coordinate, &moved.state.q)?;
        moved.state.v = motion.map(|part| part * speed * (1.0 + perturbation));
        Some(moved)
    }

    /// Whether the equations or the events had no solution during the motion.
    pub fn failed(&self) -> bool {
        self.newton.failed
    }

    fn sketch(&self) -> &'a Sketch {
        self.newton.sketch
    }

    /// Value and speed of the coordinate.
    pub fn coordinate(&self) -> [f64; 2] {
        self.value(self.sketch().coordinate, &self.state)
    }

    /// Largest speed of a body, which is not 0 at a dead centre of the coordinate.
    fn speed(&self) -> f64 {
        self.state.v.iter().fold(0.0, |speed, v| speed.max(v.abs()))
    }

    fn value(&self, quantity: Coordinate, state: &State) -> [f64; 2] {
        [self.newton.quantity(quantity, &state.q).0, self.newton.rate(quantity, &state.q, &state.v)]
    }

    /// Depth beyond a stop and its rate.
    pub fn beyond(&self, k: usize, state: &State) -> [f64; 2] {
        let Stop { on, sign, value, .. } = self.sketch().stops[k];
        let [s, rate] = self.value(on, state);
        [sign * (s - value), sign * rate]
    }

    /// Depth, rate and force of a bumper.
    fn push(&self, k: usize, state: &State) -> [f64; 3] {
        let [beyond, rate] = self.beyond(k, state);
        let stop = &self.sketch().stops[k];
        [beyond, rate, stop.stiffness * beyond + stop.damping * rate]
    }

    /// Force of the drive on the mechanism, with its losses.
    fn driven(&self, forward: bool) -> f64 {
        let efficiency = self.drive.1;
        if forward { self.load * efficiency } else { self.load / efficiency }
    }

    fn acceleration(&mut self, state: &State, forward: bool) -> Coordinates {
        let (q, v) = (&state.q, &state.v);
        let mut forces = [0.0; 9];
        axpy(&mut forces, self.driven(forward), &self.newton.quantity(self.drive.0, q).1);
        for k in 0..self.touching.len() {
            if self.touching[k] {
                let Stop { on, sign, .. } = self.sketch().stops[k];
                axpy(&mut forces, -sign * self.push(k, state)[2], &self.newton.quantity(on, q).1);
            }
        }
        self.newton.acceleration(q, v, &forces)
    }

    /// One step and its error estimate.
    fn step(&mut self, h: f64) -> (State, f64) {
        let (start, forward) = (self.state, self.forward);
        let mut slopes = [(start.v, self.acceleration(&start, forward)); 7];
        let mut end = start;
        for (n, stage) in STAGES.iter().enumerate() {
            end = start;
            for (factor, (v, a)) in stage.iter().zip(&slopes) {
                axpy(&mut end.q, h * factor, v);
                axpy(&mut end.v, h * factor, a);
            }
            slopes[n + 1] = (end.v, self.acceleration(&end, forward));
        }
        let mut error: State = State { q: [0.0; 9], v: [0.0; 9] };
        for (factor, (v, a)) in ERROR.iter().zip(&slopes) {
            axpy(&mut error.q, h * factor, v);
            axpy(&mut error.v, h * factor, a);
        }
        let size = 1.0 + self.fastest;
        let worst = error.q.iter().map(|x| x.abs()).chain(error.v.iter().map(|x| x.abs() / size)).fold(0.0, f64::max);
        self.newton.project(&mut end.q, &mut end.v);
        (end, worst)
    }

    /// Branch of the law of friction in each joint.
    fn branches(&self, state: &State) -> [i8; 4] {
        let mut out = [0; 4];
        let Some([_, _, slow, fast]) = self.sketch().loads.friction else { return out };
        for (j, link) in self.newton.links.iter().enumerate() {
            if let Some(slip) = self.newton.slip(link, &state.q, &state.v) {
                let branch = i8::from(slip.abs() > slow) + i8::from(slip.abs() >= fast);
                out[j] = if slip < 0.0 { -branch } else { branch };
            }
        }
        out
    }

    /// Power of the drive divided by the magnitude of its force.
    fn power(&self, state: &State) -> f64 {
        self.load.signum() * self.value(self.drive.0, state)[1]
    }

    /// The first event before this state.
    fn event(&self, branches: [i8; 4], end: &State) -> Option<Event> {
        if let Some((k, was_beyond)) = self.lock {
            let beyond = self.beyond(k, end)[0];
            if if was_beyond { beyond < -DEPTH } else { beyond > DEPTH } {
                return Some(Event::Lock);
            }
        }
        for k in 0..self.touching.len() {
            let [beyond, rate, push] = self.push(k, end);
            let stop = &self.sketch().stops[k];
            let small = DEPTH * (stop.stiffness + stop.damping);
            let met = match stop.rigid {
                Some(_) => beyond > DEPTH && rate > 0.0,
                None if self.touching[k] => push < -small,
                None => beyond > DEPTH && push > small,
            };
            if met {
                return Some(Event::Stop(k));
            }
        }
        if self.drive.1 < 1.0 && self.load != 0.0 {
            let power = self.power(end);
            if if self.forward { power < -1e-10 } else { power > 1e-10 } {
                return Some(Event::Drive);
            }
        }
        (self.branches(end) != branches).then_some(Event::Friction)
    }

    /// Update which bumpers are in contact in this state.
    fn press(&mut self) {
        for k in 0..self.touching.len() {
            let [beyond, _, push] = self.push(k, &self.state);
            self.touching[k] = self.sketch().stops[k].rigid.is_none() && beyond > DEPTH && push > 0.0;
        }
    }

    /// Whether, from rest, the loads accelerate the machine such that a quantity changes with this sign; if so, sets
    /// the drive's direction of power to that of this motion.
    fn sets_off(&mut self, quantity: Coordinate, sign: f64) -> bool {
        let state = State { v: [0.0; 9], ..self.state };
        let Some(motion) = self.newton.free_motion(quantity, &state.q) else { return false };
        let moving = State { v: motion.map(|x| sign * x), ..state };
        let forward = self.power(&moving) >= 0.0;
        let a = self.acceleration(&state, forward);
        let off = sign * self.newton.rate(quantity, &state.q, &a) > 0.0;
        if off {
            self.forward = forward;
        }
        off
    }

    /// Whether the machine stays at rest against a stop.
    fn is_pressed(&mut self, k: usize) -> bool {
        let Stop { on, sign, .. } = self.sketch().stops[k];
        !self.sets_off(on, -sign)
    }

    /// Engage the lock of a stop, or release the lock.
    pub fn engage(&mut self, lock: Option<usize>) {
        if self.held == Some(Held::Lock) {
            if lock.is_some() {
                return;
            }
            let stop = self.lock.map_or(0, |(stop, _)| stop);
            self.held = self.sketch().stops[stop].rigid.map(|_| Held::Stop(stop));
        }
        if let Some(stop) = lock
            && self.held == Some(Held::Stop(stop))
        {
            self.held = Some(Held::Lock);
        }
        self.lock = lock.map(|stop| (stop, self.beyond(stop, &self.state)[0] > 0.0));
    }

    /// Integrate over a time span with a load; returns false on failure.
    pub fn advance(&mut self, load: f64, span: f64) -> bool {
        self.load = load;
        let (coordinate, efficient) = (self.sketch().coordinate, self.drive.1 >= 1.0);
        if self.held.is_none() && !efficient {
            if self.speed() < 1e-9 {
                self.state.v = [0.0; 9];
                self.held = Some(Held::Drive);
            } else {
                self.forward = self.power(&self.state) >= 0.0;
            }
        }
        let (mut t, mut events) = (0.0, 0);
        while t < span {
            let rests = match self.held {
                None => false,
                Some(Held::Lock) => true,
                Some(Held::Stop(k)) => self.is_pressed(k),
                Some(Held::Drive) => !self.sets_off(coordinate, 1.0) && !self.sets_off(coordinate, -1.0),
            };
            if rests {
                return true;
            }
            self.held = None;
            let branches = self.branches(&self.state);
            let h = self.next.min(self.most).min(span - t);
            let (end, error) = self.step(h);
            let ratio = error / self.error;
            let factor = if ratio > 0.0 { (0.9 * ratio.powf(-0.2)).clamp(0.2, 5.0) } else { 5.0 };
            if ratio > 1.0 && h > 1e-13 {
                self.next = h * factor;
                continue;
            }
            let Some(_) = self.event(branches, &end) else {
                (self.state, t) = (end, t + h);
                self.next = (h * factor).max(1e-9);
                self.fastest = self.fastest.max(self.coordinate()[1].abs());
                if self.failed() {
                    return false;
                }
                continue;
            };
            let (mut before, mut after, mut last) = (0.0, h, end);
            while after - before > 1e-15 + 1e-13 * h {
                let middle = 0.5 * (before + after);
                if middle <= before || middle >= after {
                    break;
                }
                let (end, _) = self.step(middle);
                if self.event(branches, &end).is_some() {
                    (after, last) = (middle, end);
                } else {
                    before = middle;
                }
            }
            let Some(event) = self.event(branches, &last) else { return false };
            (self.state, t, events) = (last, t + after, events + 1);
            self.change(event);
            if events > EVENTS || self.failed() {
                return false;
            }
        }
        !self.failed()
    }

    fn change(&mut self, event: Event) {
        match event {
            Event::Friction => {}
            Event::Lock => {
                (self.state.v, self.held) = ([0.0; 9], Some(Held::Lock));
                self.press();
            }
            Event::Drive => {
                // At a dead centre of the drive the motion continues; otherwise the machine is at rest, for an instant
                // or longer.
                self.forward = !self.forward;
                if self.speed() < 1e-6 {
                    (self.state.v, self.held) = ([0.0; 9], Some(Held::Drive));
                    self.press();
                }
            }
            Event::Stop(k) => match self.sketch().stops[k].rigid {
                None => self.touching[k] = !self.touching[k],
                Some(restitution) => {
                    let rate = self.beyond(k, &self.state)[1];
                    self.state.v = self.state.v.map(|v| -restitution * v);
                    self.press();
                    self.forward = self.power(&self.state) >= 0.0;
                    if restitution * rate < SLOW {
                        let moving = std::mem::replace(&mut self.state.v, [0.0; 9]);
                        self.press();
                        if self.is_pressed(k) {
                            self.held = Some(Held::Stop(k));
                        } else if moving.iter().any(|v| *v != 0.0) {
                            self.state.v = moving;
                            self.press();
                        }
                    }
                }
            },
        }
    }
}
