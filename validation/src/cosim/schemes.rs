//! Coupling schemes: one communication step each, by calls of the two sides alone.
//!
//! In: a pair, a communication step. Out: the pair at the end of the step. Must not depend on the type of the sides.
//! Sources: Benedikt et al. 2013 (correction by the mean error, NEPCE); Sicklinger et al. 2014 (interface Jacobian).
use super::pair::{Motion, Pair, Point, Preview, Refused, hermite};

/// Extrapolation of a signal within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extrapolation {
    /// By the polynomial of this degree, at most 2, through past values.
    Past(usize),
    /// By the Taylor series with the rates that the sides output.
    Rates,
}

/// Kind of a scheme.
#[derive(Clone, Copy, Debug)]
pub enum Plan {
    /// Both sides step in parallel with extrapolated inputs. With `corrects` the inputs are held, with an addition: the
    /// mean over the last step by the trapezoidal rule minus the input of that step (NEPCE).
    #[expect(missing_docs, reason = "said above")]
    Jacobi { extrapolation: Extrapolation, corrects: bool },
    /// The mechanism first, with the force extrapolated; then the actuator, with the mechanism's motion as input.
    GaussSeidel(Extrapolation),
    /// The actuator first, with the speed extrapolated by its rates; the mechanism then has the parabola through the
    /// force and its rate at the start and the new force as input.
    HydraulicsFirst,
    /// Both sides repeat the step until the force at its end equals the assumed one, a polynomial of degree 1 or 2. The
    /// next assumed end value is the computed one (waveform relaxation), or follows from Newton's method with
    /// stiffness, damping and reduced mass, then the secant method (interface Jacobian). Requires saved states.
    #[expect(missing_docs, reason = "said above")]
    Iterated { degree: usize, newton: bool },
    /// Preview: from the mechanism as one element the actuator predicts the motion of both over the next step, and
    /// outputs a force of the correct impulse, as a line or its mean. In two passes the mechanism steps first and the
    /// actuator follows its motion; in one pass the actuator keeps the predicted motion. Without the slope dW/ds the
    /// actuator uses differences of W in time.
    #[expect(missing_docs, reason = "said above")]
    Predicted { linear: bool, two_passes: bool, with_slope: bool },
    /// Preview in one pass in a host that passes every output one step late, independently of the feedthrough: both
    /// sides step, then all outputs are read, then all inputs are set. The force is predicted from the motion of the
    /// prediction before and the element of the step before.
    #[expect(missing_docs, reason = "said above")]
    Late { linear: bool },
}

const fn jacobi(extrapolation: Extrapolation) -> Plan {
    Plan::Jacobi { extrapolation, corrects: false }
}

const fn one_pass(linear: bool) -> Plan {
    Plan::Predicted { linear, two_passes: false, with_slope: true }
}

const fn two_passes(with_slope: bool) -> Plan {
    Plan::Predicted { linear: true, two_passes: true, with_slope }
}

/// Every scheme by its name on the page.
pub const ALL: [(&str, Plan); 21] = [
    ("Jacobi 0", jacobi(Extrapolation::Past(0))),
    ("NEPCE on it", Plan::Jacobi { extrapolation: Extrapolation::Past(0), corrects: true }),
    ("Jacobi 1", jacobi(Extrapolation::Past(1))),
    ("Jacobi 2", jacobi(Extrapolation::Past(2))),
    ("Jacobi rates", jacobi(Extrapolation::Rates)),
    ("Gauss-Seidel 0", Plan::GaussSeidel(Extrapolation::Past(0))),
    ("Gauss-Seidel 1", Plan::GaussSeidel(Extrapolation::Past(1))),
    ("Gauss-Seidel rates", Plan::GaussSeidel(Extrapolation::Rates)),
    ("hydraulics first, rates", Plan::HydraulicsFirst),
    ("waveform, linear F", Plan::Iterated { degree: 1, newton: false }),
    ("waveform, quadratic F", Plan::Iterated { degree: 2, newton: false }),
    ("interface Jacobian, linear F", Plan::Iterated { degree: 1, newton: true }),
    ("interface Jacobian, quadratic F", Plan::Iterated { degree: 2, newton: true }),
    ("preview, one pass, held", one_pass(false)),
    ("preview, one pass, linear", one_pass(true)),
    ("preview, one pass, held, one step late", Plan::Late { linear: false }),
    ("preview, one pass, linear, one step late", Plan::Late { linear: true }),
    ("preview, delayed, held, one step late", Plan::Late { linear: false }),
    ("preview, delayed, linear, one step late", Plan::Late { linear: true }),
    ("preview, two passes, by difference", two_passes(false)),
    ("preview, two passes, with dW/ds", two_passes(true)),
];

/// Past values of a signal at equal steps, the latest first.
#[derive(Clone, Copy, Debug, Default)]
struct History {
    values: [f64; 3],
    known: usize,
}

impl History {
    fn push(&mut self, value: f64) {
        self.values = [value, self.values[0], self.values[1]];
        self.known = (self.known + 1).min(3);
    }

    /// Value and derivatives, at the latest value, of the polynomial of this degree or through as many values as there
    /// are.
    fn series(&self, degree: usize, h: f64) -> [f64; 3] {
        let [now, before, first] = self.values;
        match degree.min(self.known - 1) {
            0 => [now, 0.0, 0.0],
            1 => [now, (now - before) / h, 0.0],
            _ => [now, (1.5 * now - 2.0 * before + 0.5 * first) / h, ((now - before) - (before - first)) / (h * h)],
        }
    }
}

/// Rate of the force, and its difference between two steps divided by the step.
#[derive(Clone, Copy, Debug, Default)]
struct Rates(Option<f64>);

impl Rates {
    /// The force and its first and second derivative at a point.
    fn force(&mut self, pair: &mut Pair, point: &Point, h: f64) -> Result<[f64; 3], Refused> {
        let rate = pair.actuator.force_rate(point.motion.acceleration)?;
        let second = self.0.map_or(0.0, |before| (rate - before) / h);
        self.0 = Some(rate);
        Ok([point.force, rate, second])
    }

    /// The speed with acceleration and jerk for the force with this rate.
    fn speed(pair: &mut Pair, point: &Point, rate: f64) -> Result<[f64; 5], Refused> {
        let [jerk, mobility] = pair.mechanism.jerk()?;
        Ok([point.motion.speed, point.motion.acceleration, jerk + rate * mobility, 0.0, 0.0])
    }
}

/// Difference between the assumed and the computed force at which the iteration ends [N].
const AGREED: f64 = 1e-3;
/// Greatest number of repetitions of a step.
const MOST: usize = 30;

/// A scheme with its past values.
#[derive(Clone, Debug)]
pub struct Scheme {
    plan: Plan,
    force: History,
    speed: History,
    rates: Rates,
    /// Inputs of the last step, force and speed, for the correction in the next step.
    given: Option<[f64; 2]>,
    /// The actuator's preview since its last step.
    last_preview: Option<Preview>,
}

impl Scheme {
    /// Step from the communication point `t` to `t + h` [s], with both sides at `t`.
    ///
    /// # Errors
    /// A side returns an error, or an iteration does not converge.
    pub fn step(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        match self.plan {
            Plan::Jacobi { extrapolation, corrects } => self.jacobi(extrapolation, corrects, pair, t, h),
            Plan::GaussSeidel(extrapolation) => self.gauss_seidel(extrapolation, pair, t, h),
            Plan::HydraulicsFirst => self.hydraulics_first(pair, t, h),
            Plan::Iterated { degree, newton } => self.iterated(degree, newton, pair, t, h),
            Plan::Predicted { linear, two_passes, with_slope } => predicted(linear, two_passes, with_slope, pair, t, h),
            Plan::Late { linear } => self.late(linear, pair, t, h),
        }
    }

    fn jacobi(
        &mut self,
        extrapolation: Extrapolation,
        corrects: bool,
        pair: &mut Pair,
        t: f64,
        h: f64,
    ) -> Result<(), Refused> {
        let point = pair.exchange()?;
        let Point { motion, force } = point;
        let before = (self.force.known > 0).then_some([self.force.values[0], self.speed.values[0]]);
        self.force.push(force);
        self.speed.push(motion.speed);
        let (force, speed) = match extrapolation {
            Extrapolation::Past(degree) => {
                let [v, a, j] = self.speed.series(degree, h);
                (self.force.series(degree, h), [v, a, j, 0.0, 0.0])
            }
            Extrapolation::Rates => {
                let force = self.rates.force(pair, &point, h)?;
                (force, Rates::speed(pair, &point, force[1])?)
            }
        };
        let (mut force, mut speed) = (force, speed);
        if corrects {
            let now = [force[0], speed[0]];
            let given = match before.zip(self.given) {
                Some((before, given)) => [0, 1].map(|k: usize| now[k] + 0.5 * (now[k] + before[k]) - given[k]),
                None => now,
            };
            (force[0], speed[0], self.given) = (given[0], given[1], Some(given));
        }
        pair.mechanism.set_force(force)?;
        pair.actuator.set_motion(motion.length, speed)?;
        pair.step_mechanism(t, h)?;
        pair.step_actuator(t, h)
    }

    fn gauss_seidel(&mut self, extrapolation: Extrapolation, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let point = pair.exchange()?;
        self.force.push(point.force);
        let force = match extrapolation {
            Extrapolation::Past(degree) => self.force.series(degree, h),
            Extrapolation::Rates => self.rates.force(pair, &point, h)?,
        };
        pair.mechanism.set_force(force)?;
        pair.step_mechanism(t, h)?;
        let end = pair.mechanism.motion()?;
        pair.actuator.set_motion(point.motion.length, hermite(point.motion, end, h))?;
        pair.step_actuator(t, h)
    }

    fn hydraulics_first(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let point = pair.exchange()?;
        let [force, rate, _] = self.rates.force(pair, &point, h)?;
        let speed = Rates::speed(pair, &point, rate)?;
        pair.actuator.set_motion(point.motion.length, speed)?;
        pair.step_actuator(t, h)?;
        let end = pair.actuator.force()?;
        pair.mechanism.set_force(parabola(force, rate, end, h))?;
        pair.step_mechanism(t, h)
    }

    fn iterated(&mut self, degree: usize, newton: bool, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let point = pair.exchange()?;
        let [force, rate, _] = self.rates.force(pair, &point, h)?;
        // d(computed force)/d(assumed force) = -kappa: for each newton at the end of the line or of the parabola the
        // mechanism moves h^2/6m or h^2/12m further, and is h/2m or h/3m faster.
        let [stiffness, damping] = pair.actuator.compliance()?;
        let mass = pair.mechanism.element()?.mass;
        let [way, gain] = if degree == 1 { [6.0, 2.0] } else { [12.0, 3.0] };
        let kappa = stiffness * h * h / (way * mass) + damping * h / (gain * mass);
        let mut slope = -(1.0 + kappa);
        pair.mechanism.save()?;
        pair.actuator.save()?;
        let mut end = force + rate * h;
        let mut last: Option<[f64; 2]> = None;
        for _ in 0..MOST {
            let line = [force, (end - force) / h, 0.0];
            pair.mechanism.set_force(if degree == 1 { line } else { parabola(force, rate, end, h) })?;
            pair.step_mechanism(t, h)?;
            let motion = pair.mechanism.motion()?;
            pair.actuator.set_motion(point.motion.length, hermite(point.motion, motion, h))?;
            pair.step_actuator(t, h)?;
            pair.actuator.set_motion(motion.length, [motion.speed, 0.0, 0.0, 0.0, 0.0])?;
            let residual = pair.actuator.force()? - end;
            if residual.abs() < AGREED {
                return Ok(());
            }
            if let Some([before, of_before]) = last
                && end != before
            {
                slope = (residual - of_before) / (end - before);
            }
            last = Some([end, residual]);
            end += if newton { -residual / slope } else { residual };
            pair.mechanism.restore()?;
            pair.actuator.restore()?;
        }
        Err(format!("the force at {t} s + {h} s does not converge in {MOST} repetitions"))
    }

    fn late(&mut self, linear: bool, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let Motion { length, speed, .. } = pair.mechanism.motion()?;
        let now = pair.mechanism.element()?;
        // At the start only start values are known: both sides output them before the first step.
        pair.actuator.set_motion(length, [speed, 0.0, 0.0, 0.0, 0.0])?;
        let present = pair.actuator.preview(now, h, true)?;
        let predicted = self.last_preview.unwrap_or(present);
        let [force, rate] = if linear { predicted.line } else { [predicted.mean, 0.0] };
        pair.mechanism.set_force([force, rate, 0.0])?;
        pair.step_mechanism(t, h)?;
        pair.step_actuator(t, h)?;
        // The inputs of the actuator are still those of the step: its own motion, and the element at its start.
        self.last_preview = Some(pair.actuator.preview(now, h, true)?);
        Ok(())
    }
}

fn predicted(linear: bool, two_passes: bool, with_slope: bool, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
    let Motion { length, speed, .. } = pair.mechanism.motion()?;
    let mut element = pair.mechanism.element()?;
    if !with_slope {
        element.holding_derivative = 0.0;
    }
    pair.actuator.set_motion(length, [speed, 0.0, 0.0, 0.0, 0.0])?;
    let predicted = pair.actuator.preview(element, h, !two_passes)?;
    let [force, rate] = if linear { predicted.line } else { [predicted.mean, 0.0] };
    pair.mechanism.set_force([force, rate, 0.0])?;
    pair.step_mechanism(t, h)?;
    if two_passes {
        let end = pair.mechanism.motion()?;
        let [from, to] = predicted.accelerations;
        let from = Motion { length, speed, acceleration: from };
        let to = Motion { acceleration: to, ..end };
        pair.actuator.set_motion(length, hermite(from, to, h))?;
    }
    pair.step_actuator(t, h)
}

/// Value and derivatives at the start of the parabola with this value and rate there and this value after `h`.
fn parabola(value: f64, rate: f64, end: f64, h: f64) -> [f64; 3] {
    [value, rate, 2.0 * (end - value - rate * h) / (h * h)]
}

/// Value of `coupling.mode` that a scheme needs in the actuator.
pub fn mode(name: &str) -> &'static str {
    let words = [("preview, one pass", "preview"), ("preview, delayed", "delayed")];
    words.into_iter().find(|(start, _)| name.starts_with(start)).map_or("follow", |(_, mode)| mode)
}

/// A scheme by its name in [`ALL`].
pub fn by_name(name: &str) -> Option<Scheme> {
    let (_, plan) = *ALL.iter().find(|(own, _)| *own == name)?;
    let (force, speed, rates) = Default::default();
    Some(Scheme { plan, force, speed, rates, given: None, last_preview: None })
}
