//! The oracle: an independent integration of a block or a slider-crank with stops, by Runge-Kutta steps in closed-form
//! equations.

use crate::support::numeric::runge_kutta;

/// The quantity that a stop limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Angle of the crank.
    Angle,
    /// Position of the slide.
    Slide,
    /// Distance of the block or of the crank's end from a post.
    Distance,
}

/// A block of a mass [kg] on a slide, or a slider-crank with an inertia [kg.m2] of the crank, a mass [kg] of the slider
/// and a rod without mass.
#[derive(Clone, Copy, Debug)]
pub enum Machine {
    Block(f64),
    Crank(f64, f64),
}

pub const CRANK: f64 = 0.3;
pub const ROD: f64 = 0.8;
pub const POST: [f64; 2] = [0.2, 0.7];

#[derive(Clone, Copy, Debug)]
pub struct Stop {
    pub quantity: Quantity,
    /// 1 for an upper stop, -1 for a lower one.
    pub sign: f64,
    pub value: f64,
    /// Restitution of a rigid stop.
    pub rigid: Option<f64>,
    pub stiffness: f64,
    pub damping: f64,
}

impl Machine {
    /// Slider position with its first two derivatives with respect to the crank angle.
    pub fn slide(theta: f64) -> [f64; 3] {
        let (sin, cos) = theta.sin_cos();
        let root = (ROD * ROD - CRANK * CRANK * sin * sin).sqrt();
        let (p, p1) = (CRANK * CRANK * sin * cos, CRANK * CRANK * (cos * cos - sin * sin));
        [CRANK * cos + root, -CRANK * sin - p / root, -CRANK * cos - p1 / root - p * p / root.powi(3)]
    }

    /// A quantity and its derivative with respect to the coordinate.
    pub fn quantity(self, quantity: Quantity, y: f64) -> [f64; 2] {
        match (self, quantity) {
            (Self::Crank(..), Quantity::Slide) => {
                let [x, slope, _] = Self::slide(y);
                [x, slope]
            }
            (Self::Crank(..), Quantity::Distance) => {
                let (sin, cos) = y.sin_cos();
                let gap = [CRANK * cos - POST[0], CRANK * sin - POST[1]];
                let length = gap[0].hypot(gap[1]);
                [length, (gap[1] * cos - gap[0] * sin) * CRANK / length]
            }
            (Self::Block(_), Quantity::Distance) => {
                let length = (y - POST[0]).hypot(POST[1]);
                [length, (y - POST[0]) / length]
            }
            _ => [y, 1.0],
        }
    }

    /// Acceleration of the coordinate under the force of the ram or the torque of the servo, and the generalised force
    /// of the bumpers.
    pub fn acceleration(self, load: f64, pushes: f64, y: f64, v: f64) -> f64 {
        match self {
            Self::Block(mass) => (load + pushes) / mass,
            Self::Crank(inertia, mass) => {
                let [_, slope, curvature] = Self::slide(y);
                (load + pushes - mass * slope * curvature * v * v) / (inertia + mass * slope * slope)
            }
        }
    }
}

/// The stop or lock that holds the machine at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Held {
    Stop(usize),
    Lock,
}

/// The independent integration.
#[derive(Clone, Debug)]
pub struct Oracle {
    pub machine: Machine,
    pub stops: Vec<Stop>,
    pub y: f64,
    pub v: f64,
    pub touching: Vec<bool>,
    pub held: Option<Held>,
    /// Stop whose lock is engaged, and whether the machine was beyond the stop when the lock was engaged.
    pub lock: Option<(usize, bool)>,
    /// Size of the integration steps [s].
    pub h: f64,
    /// Relative error of the speed at the start and after each event. It shows how much the motion amplifies small
    /// errors.
    pub perturbation: f64,
    /// Whether the machine has reversed so close to a rigid stop that rounding decides whether it reached the stop.
    pub grazed: bool,
}

/// Depth from which on a stop counts as reached [m or rad]. It is larger than the rounding.
pub const DEPTH: f64 = 1e-12;
/// Speed of an impact below which the machine rests.
pub const SLOW: f64 = 1e-6;

impl Oracle {
    /// Depth beyond a stop, its rate, and the generalised force for a contact force of 1.
    pub fn beyond(&self, stop: &Stop, y: f64, v: f64) -> [f64; 3] {
        let [s, slope] = self.machine.quantity(stop.quantity, y);
        [stop.sign * (s - stop.value), stop.sign * slope * v, -stop.sign * slope]
    }

    pub fn push(&self, k: usize, y: f64, v: f64) -> [f64; 3] {
        let stop = &self.stops[k];
        let [beyond, rate, effect] = self.beyond(stop, y, v);
        [beyond, stop.stiffness * beyond + stop.damping * rate, effect]
    }

    pub fn acceleration(&self, load: f64, y: f64, v: f64) -> f64 {
        let pushes = (0..self.stops.len()).filter(|&k| self.touching[k]).map(|k| {
            let [_, push, effect] = self.push(k, y, v);
            push * effect
        });
        self.machine.acceleration(load, pushes.sum(), y, v)
    }

    /// One Runge-Kutta step.
    pub fn step(&self, load: f64, h: f64) -> [f64; 2] {
        runge_kutta(|_, [y, v]| [v, self.acceleration(load, y, v)], [self.y, self.v], h, 1)
    }

    /// Update the bumpers that act in this state.
    pub fn press(&mut self) {
        for k in 0..self.stops.len() {
            let [beyond, push, _] = self.push(k, self.y, self.v);
            self.touching[k] = self.stops[k].rigid.is_none() && beyond > DEPTH && push > 0.0;
        }
    }

    /// The stop whose law has changed in this state.
    pub fn event(&self, [y, v]: [f64; 2]) -> Option<usize> {
        (0..self.stops.len()).find(|&k| {
            let stop = &self.stops[k];
            let [beyond, push, _] = self.push(k, y, v);
            let rate = self.beyond(stop, y, v)[1];
            if let Some((_, was_beyond)) = self.lock.filter(|(lock, _)| *lock == k)
                && (if was_beyond { beyond < -DEPTH } else { beyond > DEPTH })
            {
                return true;
            }
            let small = DEPTH * (stop.stiffness + stop.damping);
            match stop.rigid {
                Some(_) => beyond > DEPTH && rate > 0.0,
                None if self.touching[k] => push < -small,
                None => beyond > DEPTH && push > small,
            }
        })
    }

    /// Whether the loads press the resting machine against a rigid stop.
    pub fn is_pressed(&self, k: usize, load: f64) -> bool {
        let a = self.acceleration(load, self.y, 0.0);
        self.beyond(&self.stops[k], self.y, a)[1] >= 0.0
    }

    /// Whether a rigid stop that the machine approached is very near at this coordinate.
    pub fn approached_a_rigid_stop(&self, y: f64) -> bool {
        let is_near = |stop: &Stop| {
            let [beyond, rate, _] = self.beyond(stop, y, self.v);
            stop.rigid.is_some() && rate > 0.0 && beyond.abs() < 1e-6
        };
        self.stops.iter().any(is_near)
    }

    pub fn engage(&mut self, lock: Option<usize>) {
        if self.held == Some(Held::Lock) && lock.is_none() {
            let stop = self.lock.unwrap().0;
            self.held = self.stops[stop].rigid.map(|_| Held::Stop(stop));
        }
        if let Some(stop) = lock
            && self.held == Some(Held::Stop(stop))
        {
            self.held = Some(Held::Lock);
        }
        self.lock = lock.map(|stop| (stop, self.beyond(&self.stops[stop], self.y, 0.0)[0] > 0.0));
    }

    pub fn advance(&mut self, load: f64, span: f64) {
        let mut t = 0.0;
        while t < span {
            match self.held {
                Some(Held::Lock) => return,
                Some(Held::Stop(k)) if self.is_pressed(k, load) => return,
                _ => self.held = None,
            }
            let h = self.h.min(span - t);
            let end = self.step(load, h);
            if self.event(end).is_none() {
                self.grazed |= self.v * end[1] <= 0.0 && self.approached_a_rigid_stop(end[0]);
                ([self.y, self.v], t) = (end, t + h);
                continue;
            }
            let (mut before, mut after) = (0.0, h);
            for _ in 0..60 {
                let middle = 0.5 * (before + after);
                *(if self.event(self.step(load, middle)).is_some() { &mut after } else { &mut before }) = middle;
            }
            let k = self.event(self.step(load, after)).unwrap();
            [self.y, self.v] = self.step(load, after);
            t += after;
            self.change(k, load);
        }
    }

    /// A stop is reached, or a bumper starts or stops to act.
    pub fn change(&mut self, k: usize, load: f64) {
        self.v *= 1.0 + self.perturbation;
        let rate = self.beyond(&self.stops[k], self.y, self.v)[1];
        let caught = |(lock, was_beyond): (usize, bool)| {
            let beyond = self.beyond(&self.stops[k], self.y, self.v)[0];
            lock == k && if was_beyond { beyond < -DEPTH } else { beyond > DEPTH }
        };
        if self.lock.is_some_and(caught) {
            self.v = 0.0;
            self.held = Some(Held::Lock);
            self.press();
        } else if let Some(restitution) = self.stops[k].rigid {
            self.v *= -restitution;
            self.press();
            if restitution * rate < SLOW {
                let moving = std::mem::take(&mut self.v);
                self.press();
                if self.is_pressed(k, load) {
                    self.held = Some(Held::Stop(k));
                } else {
                    self.v = moving;
                    self.press();
                }
            }
        } else {
            self.touching[k] = !self.touching[k];
        }
    }
}
