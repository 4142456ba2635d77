//! Sides of a coupling that are no FMUs: a mass in closed form, and an actuator whose laws are integrated here.
//!
//! In: laws of an actuator. Out: an [`Actuator`] with preview. Used in tests of the schemes, and as a second
//! formulation for comparison with the FMUs.
use super::circuit::Circuit;
use super::pair::{Actuator, Element, Mechanism, Motion, Preview, Refused};
use crate::extrapolation::integrate;

/// Longest step of the integration [s].
const LONGEST: f64 = 5e-4;

/// A mass with a constant load.
#[derive(Clone, Debug)]
pub struct Mass {
    /// Mass [kg].
    pub mass: f64,
    /// Load W [N].
    pub load: f64,
    /// Length [m], speed [m/s].
    pub state: [f64; 2],
    force: [f64; 3],
    kept: [f64; 2],
}

impl Mass {
    /// A mass at a length, with a speed.
    pub fn new(mass: f64, load: f64, state: [f64; 2]) -> Self {
        Self { mass, load, state, force: [0.0; 3], kept: state }
    }
}

impl Mechanism for Mass {
    fn motion(&mut self) -> Result<Motion, Refused> {
        let [length, speed] = self.state;
        Ok(Motion { length, speed, acceleration: (self.force[0] - self.load) / self.mass })
    }

    fn jerk(&mut self) -> Result<[f64; 2], Refused> {
        Ok([0.0, 1.0 / self.mass])
    }

    fn element(&mut self) -> Result<Element, Refused> {
        Ok(Element { mass: self.mass, holding: self.load, ..Element::default() })
    }

    fn set_force(&mut self, force: [f64; 3]) -> Result<(), Refused> {
        self.force = force;
        Ok(())
    }

    /// The force is a parabola in time, so that speed and length are polynomials.
    fn step(&mut self, _t: f64, h: f64) -> Result<(), Refused> {
        let [f, first, second] = self.force;
        let a = [(f - self.load) / self.mass, first / self.mass, second / self.mass];
        let [s, v] = self.state;
        let rise = |k: [f64; 3]| h * (a[0] / k[0] + h * (a[1] / k[1] + h * a[2] / k[2]));
        self.state = [s + h * v + h * rise([2.0, 6.0, 24.0]), v + rise([1.0, 2.0, 6.0])];
        self.force = [f + h * (first + 0.5 * h * second), first + h * second, second];
        Ok(())
    }

    fn save(&mut self) -> Result<(), Refused> {
        self.kept = self.state;
        Ok(())
    }

    fn restore(&mut self) -> Result<(), Refused> {
        self.state = self.kept;
        Ok(())
    }

    fn energy(&mut self) -> Result<f64, Refused> {
        let [s, v] = self.state;
        Ok(0.5 * self.mass * v * v + self.load * s)
    }

    fn position(&mut self) -> Result<f64, Refused> {
        Ok(self.state[0])
    }
}

/// Laws of an actuator with up to four states.
pub trait Laws {
    /// Rates of the states x at the time t, length s, speed v.
    fn rates(&self, t: f64, s: f64, v: f64, x: &[f64; 4]) -> [f64; 4];
    /// Force.
    fn force(&self, v: f64, x: &[f64; 4]) -> f64;
    /// Rate of the force, from the rates of the states and the acceleration.
    fn force_rate(&self, v: f64, a: f64, rates: &[f64; 4]) -> f64;
    /// Stiffness and damping.
    fn compliance(&self, s: f64, v: f64, x: &[f64; 4]) -> [f64; 2];
}

/// Oil between a piston and a leaking volume: F' = -stiffness v - F / leak_time. With a mass m it oscillates with omega
/// = sqrt(stiffness / m) and zeta = 1 / (2 omega leak_time).
#[derive(Clone, Copy, Debug)]
pub struct OilSpring {
    /// Stiffness k [N/m].
    pub stiffness: f64,
    /// Time constant of the leakage [s].
    pub leak_time: f64,
}

impl Laws for OilSpring {
    fn rates(&self, _t: f64, _s: f64, v: f64, [force, ..]: &[f64; 4]) -> [f64; 4] {
        [-self.stiffness * v - force / self.leak_time, 0.0, 0.0, 0.0]
    }

    fn force(&self, _v: f64, [force, ..]: &[f64; 4]) -> f64 {
        *force
    }

    fn force_rate(&self, _v: f64, _a: f64, [rate, ..]: &[f64; 4]) -> f64 {
        *rate
    }

    fn compliance(&self, _s: f64, _v: f64, _x: &[f64; 4]) -> [f64; 2] {
        [self.stiffness, 0.0]
    }
}

impl Laws for Circuit {
    fn rates(&self, t: f64, s: f64, v: f64, x: &[f64; 4]) -> [f64; 4] {
        Self::rates(self, t, s, v, x)
    }

    fn force(&self, v: f64, x: &[f64; 4]) -> f64 {
        Self::force(self, v, x)
    }

    fn force_rate(&self, v: f64, a: f64, rates: &[f64; 4]) -> f64 {
        let [area_a, area_b] = self.areas();
        area_a * rates[0] - area_b * rates[1] - self.friction(v)[1] * a
    }

    fn compliance(&self, s: f64, v: f64, x: &[f64; 4]) -> [f64; 2] {
        [self.stiffness(s, x), self.friction(v)[1]]
    }
}

/// State that a step of an [`Integrated`] actuator changes.
#[derive(Clone, Copy, Debug, Default)]
struct Present {
    x: [f64; 4],
    time: f64,
    length: f64,
    speed: [f64; 5],
    work: f64,
}

/// The element of a preview, with the data for the next step.
#[derive(Clone, Copy, Debug)]
struct Asked {
    element: Element,
    /// Time rate of W, used if its derivative along the length is not given [N/s].
    drift: f64,
    /// Whether the next step keeps the predicted motion.
    keeps: bool,
    past: Past,
}

/// Data of earlier steps for the next preview.
#[derive(Clone, Copy, Debug, Default)]
struct Past {
    /// W [N] and time [s] at the start of the last step.
    before: Option<[f64; 2]>,
    /// Speed predicted for the end of the last step [m/s], and the length of that step [s].
    predicted: Option<[f64; 2]>,
    /// Load missing in the element model, r [N].
    correction: f64,
}

/// An actuator with these laws, integrated by [`integrate`].
#[derive(Clone, Debug)]
pub struct Integrated<L> {
    /// The laws.
    pub laws: L,
    present: Present,
    saved: Present,
    past: Past,
    /// The last preview, consumed by the next step.
    asked: Option<Asked>,
    /// Whether the load is corrected by the error of the element model.
    pub corrects: bool,
}

impl<L: Laws> Integrated<L> {
    /// An actuator in a state, at t = 0.
    pub fn new(laws: L, x: [f64; 4]) -> Self {
        let present = Present { x, ..Present::default() };
        Self { laws, present, saved: present, past: Past::default(), asked: None, corrects: false }
    }

    /// State of the laws.
    pub fn state(&self) -> [f64; 4] {
        self.present.x
    }

    /// States, length, speed, moments of the force and work after h, predicted from the present motion.
    fn predict(&self, Asked { element, drift, .. }: Asked, h: f64) -> [f64; 9] {
        let Present { x, time, length, speed, .. } = self.present;
        let [a, b, c, d] = x;
        let mut f = |t: f64, y: &[f64; 9]| {
            let x = [y[0], y[1], y[2], y[3]];
            let (s, v) = (y[4], y[5]);
            let force = self.laws.force(v, &x);
            let rates = self.laws.rates(t, s, v, &x);
            let a = acceleration(&element, drift, [s - length, v, t - time], force);
            [rates[0], rates[1], rates[2], rates[3], v, a, force, force * (t - time) / h, force * v]
        };
        integrate(&mut f, time, [a, b, c, d, length, speed[0], 0.0, 0.0, 0.0], h, LONGEST)
    }
}

/// Acceleration of the element under a force, `way` [m] from its reference length, with the speed v [m/s], `t` [s]
/// later.
fn acceleration(element: &Element, drift: f64, [way, v, t]: [f64; 3], force: f64) -> f64 {
    let Element { mass, mass_derivative, holding, holding_derivative, .. } = *element;
    let load = holding + holding_derivative * way + drift * t + 0.5 * mass_derivative * v * v;
    (force - load) / (mass + mass_derivative * way)
}

/// The `times`-fold integral, at t, of a polynomial given by value and derivatives at 0.
fn taylor(derivatives: &[f64; 5], times: i32, t: f64) -> f64 {
    let (mut sum, mut power) = (0.0, 1.0);
    for k in 1..=times {
        power *= t / f64::from(k);
    }
    for (k, derivative) in derivatives.iter().enumerate() {
        sum += derivative * power;
        power *= t / (k as f64 + 1.0 + f64::from(times));
    }
    sum
}

impl<L: Laws> Actuator for Integrated<L> {
    fn set_motion(&mut self, length: f64, speed: [f64; 5]) -> Result<(), Refused> {
        (self.present.length, self.present.speed) = (length, speed);
        Ok(())
    }

    fn force(&mut self) -> Result<f64, Refused> {
        Ok(self.laws.force(self.present.speed[0], &self.present.x))
    }

    fn force_rate(&mut self, acceleration: f64) -> Result<f64, Refused> {
        let Present { x, time, length, speed: [v, ..], .. } = self.present;
        let rates = self.laws.rates(time, length, v, &x);
        Ok(self.laws.force_rate(v, acceleration, &rates))
    }

    fn compliance(&mut self) -> Result<[f64; 2], Refused> {
        let Present { x, length, speed: [v, ..], .. } = self.present;
        Ok(self.laws.compliance(length, v, &x))
    }

    /// A preview changes nothing on which a further preview depends.
    fn preview(&mut self, mut element: Element, h: f64, keeps: bool) -> Result<Preview, Refused> {
        let Present { time, speed: [v, ..], length, .. } = self.present;
        let (mut past, mut drift) = (self.past, 0.0);
        if element.holding_derivative == 0.0
            && let Some([holding, then]) = past.before
        {
            drift = (element.holding - holding) / (time - then);
        }
        past.before = Some([element.holding, time]);
        let force = self.force()?;
        if self.corrects
            && let Some([predicted, last]) = past.predicted
        {
            let missed = element.mass * (v - predicted) / last;
            // After a contact within the step the impulse is not that of the load.
            let is_load = missed.abs() <= force.abs() + element.holding.abs();
            past.correction = if is_load { past.correction - missed } else { 0.0 };
        }
        element.holding += past.correction;
        let from = acceleration(&element, drift, [0.0, v, 0.0], force);
        let mut asked = Asked { element, drift, keeps, past };
        let [a, b, c, d, s, end, impulse, moment, _] = self.predict(asked, h);
        let to = acceleration(&element, drift, [s - length, end, h], self.laws.force(end, &[a, b, c, d]));
        let [m0, m1] = [impulse / h, moment / h];
        let rate = 6.0 * (2.0 * m1 - m0) / h;
        asked.past.predicted = Some([end, h]);
        self.asked = Some(asked);
        Ok(Preview { line: [m0 - 0.5 * rate * h, rate], mean: m0, accelerations: [from, to] })
    }

    fn step(&mut self, _t: f64, h: f64) -> Result<(), Refused> {
        let asked = self.asked.take();
        if let Some(asked) = asked {
            self.past = asked.past;
        }
        if let Some(asked) = asked.filter(|asked| asked.keeps) {
            let [a, b, c, d, length, v, _, _, work] = self.predict(asked, h);
            (self.present.x, self.present.length) = ([a, b, c, d], length);
            self.present.work += work;
            self.present.speed = [v, 0.0, 0.0, 0.0, 0.0];
        } else {
            let Present { x: [a, b, c, d], time, length, speed, work } = self.present;
            let mut f = |t: f64, y: &[f64; 5]| {
                let x = [y[0], y[1], y[2], y[3]];
                let (s, v) = (length + taylor(&speed, 1, t - time), taylor(&speed, 0, t - time));
                let r = self.laws.rates(t, s, v, &x);
                [r[0], r[1], r[2], r[3], self.laws.force(v, &x) * v]
            };
            let [a, b, c, d, work] = integrate(&mut f, time, [a, b, c, d, work], h, LONGEST);
            (self.present.x, self.present.work) = ([a, b, c, d], work);
            self.present.length += taylor(&speed, 1, h);
            self.present.speed = [taylor(&speed, 0, h), 0.0, 0.0, 0.0, 0.0];
        }
        self.present.time += h;
        if self.present.x.iter().any(|x| !x.is_finite()) {
            return Err(format!("the state at {} s is not finite", self.present.time));
        }
        Ok(())
    }

    fn save(&mut self) -> Result<(), Refused> {
        self.saved = self.present;
        Ok(())
    }

    fn restore(&mut self) -> Result<(), Refused> {
        self.present = self.saved;
        Ok(())
    }

    fn work(&mut self) -> Result<f64, Refused> {
        Ok(self.present.work)
    }
}
