//! Coupling schemes: one communication step each, by the calls of the two sides alone.
//!
//! In: a pair, a communication step. Out: the pair at the end of the step. They must not know what the sides are.
//! Sources: Benedikt et al. 2013 (correction by the mean error, NEPCE); Sicklinger et al. 2014 (interface Jacobian).
use super::pair::{Motion, Pair, Point, Preview, Refused, hermite};

/// A coupling scheme with its memory of the past.
pub trait Scheme {
    /// From the communication point `t` to `t + h` [s], both sides having the state at `t`.
    fn step(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused>;
}

/// How a signal goes on within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extrapolation {
    /// By the polynomial of this degree, at most 2, through the past values.
    Past(usize),
    /// By Taylor's series with the rates that the sides tell.
    Rates,
}

/// Past values of a signal at equal steps, the last one first.
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

    /// Value and derivatives at the last value of the polynomial of this degree, or of as many values as are known.
    fn series(&self, degree: usize, h: f64) -> [f64; 3] {
        let [now, before, first] = self.values;
        match degree.min(self.known - 1) {
            0 => [now, 0.0, 0.0],
            1 => [now, (now - before) / h, 0.0],
            _ => [now, (1.5 * now - 2.0 * before + 0.5 * first) / h, ((now - before) - (before - first)) / (h * h)],
        }
    }
}

/// Rate of the force, and the difference of it from one step to the next over the step.
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

    /// The speed with acceleration and jerk under the force with this rate.
    fn speed(pair: &mut Pair, point: &Point, rate: f64) -> Result<[f64; 5], Refused> {
        let [jerk, mobility] = pair.mechanism.jerk()?;
        Ok([point.motion.speed, point.motion.acceleration, jerk + rate * mobility, 0.0, 0.0])
    }
}

/// Jacobi coupling with extrapolated inputs, with or without the correction by the mean error of the last step.
#[derive(Clone, Debug)]
pub struct Jacobi {
    extrapolation: Extrapolation,
    force: History,
    speed: History,
    rates: Rates,
    /// Inputs of the last step, force and speed, where the next step corrects them.
    corrects: bool,
    given: Option<[f64; 2]>,
}

impl Jacobi {
    /// Without correction.
    pub fn new(extrapolation: Extrapolation) -> Self {
        let (force, speed, rates) = Default::default();
        Self { extrapolation, force, speed, rates, corrects: false, given: None }
    }

    /// Held inputs plus the mean error of what was held in the last step: NEPCE.
    pub fn with_correction() -> Self {
        Self { corrects: true, ..Self::new(Extrapolation::Past(0)) }
    }

    /// Held inputs, each with the mean over the last step, by the trapezoidal rule, less what was given there.
    fn corrected(&mut self, now: [f64; 2], before: Option<[f64; 2]>) -> [f64; 2] {
        let Some((before, given)) = before.zip(self.given) else { return now };
        std::array::from_fn(|k| now[k] + 0.5 * (now[k] + before[k]) - given[k])
    }
}

impl Scheme for Jacobi {
    fn step(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let point = pair.exchange()?;
        let Point { motion, force } = point;
        let before = (self.force.known > 0).then_some([self.force.values[0], self.speed.values[0]]);
        self.force.push(force);
        self.speed.push(motion.speed);
        let (force, speed) = match self.extrapolation {
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
        if self.corrects {
            let given = self.corrected([force[0], speed[0]], before);
            (force[0], speed[0], self.given) = (given[0], given[1], Some(given));
        }
        pair.mechanism.set_force(force)?;
        pair.actuator.set_motion(motion.length, speed)?;
        pair.step_mechanism(t, h)?;
        pair.step_actuator(t, h)
    }
}

/// Gauss-Seidel coupling: the mechanism first.
#[derive(Clone, Debug)]
pub struct GaussSeidel {
    extrapolation: Extrapolation,
    force: History,
    rates: Rates,
}

impl GaussSeidel {
    /// With the force extrapolated so.
    pub fn new(extrapolation: Extrapolation) -> Self {
        let (force, rates) = Default::default();
        Self { extrapolation, force, rates }
    }
}

impl Scheme for GaussSeidel {
    fn step(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let point = pair.exchange()?;
        self.force.push(point.force);
        let force = match self.extrapolation {
            Extrapolation::Past(degree) => self.force.series(degree, h),
            Extrapolation::Rates => self.rates.force(pair, &point, h)?,
        };
        pair.mechanism.set_force(force)?;
        pair.step_mechanism(t, h)?;
        let end = pair.mechanism.motion()?;
        pair.actuator.set_motion(point.motion.length, hermite(point.motion, end, h))?;
        pair.step_actuator(t, h)
    }
}

/// The actuator first, with the speed extrapolated by its rates; the mechanism has the parabola through the force and
/// its rate at the start and the new force.
#[derive(Clone, Debug, Default)]
pub struct HydraulicsFirst {
    rates: Rates,
}

impl Scheme for HydraulicsFirst {
    fn step(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let point = pair.exchange()?;
        let [force, rate, _] = self.rates.force(pair, &point, h)?;
        let speed = Rates::speed(pair, &point, rate)?;
        pair.actuator.set_motion(point.motion.length, speed)?;
        pair.step_actuator(t, h)?;
        let end = pair.actuator.force()?;
        pair.mechanism.set_force(parabola(force, rate, end, h))?;
        pair.step_mechanism(t, h)
    }
}

/// Value and derivatives at the start of the parabola with this value and rate there and this value after `h`.
fn parabola(value: f64, rate: f64, end: f64, h: f64) -> [f64; 3] {
    [value, rate, 2.0 * (end - value - rate * h) / (h * h)]
}

/// Difference of the assumed force from the one found that ends the iteration [N].
const AGREED: f64 = 1e-3;
/// Most repetitions of a step.
const MOST: usize = 30;

/// Waveform relaxation, or Newton's method with the interface Jacobian.
#[derive(Clone, Debug)]
pub struct Iterated {
    /// Degree of the force within a step: 1 or 2.
    degree: usize,
    /// Whether the end value follows from Newton's method; else it is the one found.
    newton: bool,
    rates: Rates,
}

impl Iterated {
    /// The force found is assumed in the next repetition.
    pub fn waveform(degree: usize) -> Self {
        Self { degree, newton: false, rates: Rates::default() }
    }

    /// Newton's method for the force at the end, with stiffness, damping and reduced mass; then the secant method.
    pub fn interface_jacobian(degree: usize) -> Self {
        Self { newton: true, ..Self::waveform(degree) }
    }
}

impl Scheme for Iterated {
    fn step(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let point = pair.exchange()?;
        let [force, rate, _] = self.rates.force(pair, &point, h)?;
        // d(found force)/d(assumed force) = -kappa: the mechanism goes by h^2/6m or h^2/12m further, by h/2m or h/3m
        // faster for each newton at the end of the line or of the parabola.
        let [stiffness, damping] = pair.actuator.compliance()?;
        let mass = pair.mechanism.element()?.mass;
        let [way, gain] = if self.degree == 1 { [6.0, 2.0] } else { [12.0, 3.0] };
        let kappa = stiffness * h * h / (way * mass) + damping * h / (gain * mass);
        let mut slope = -(1.0 + kappa);
        pair.mechanism.save()?;
        pair.actuator.save()?;
        let mut end = force + rate * h;
        let mut last: Option<[f64; 2]> = None;
        for _ in 0..MOST {
            let line = [force, (end - force) / h, 0.0];
            pair.mechanism.set_force(if self.degree == 1 { line } else { parabola(force, rate, end, h) })?;
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
            end += if self.newton { -residual / slope } else { residual };
            pair.mechanism.restore()?;
            pair.actuator.restore()?;
        }
        Err(format!("the force at {t} s + {h} s does not converge in {MOST} repetitions"))
    }
}

/// Coupling by preview.
#[derive(Clone, Copy, Debug)]
pub struct Foreseen {
    /// Whether the mechanism has the line foreseen; else its mean.
    linear: bool,
    /// Whether the mechanism steps first and the actuator follows it; else the actuator keeps the motion foreseen.
    two_passes: bool,
    /// Whether the mechanism tells dW/ds; else the actuator takes differences of W in time.
    with_slope: bool,
}

impl Foreseen {
    /// One pass, the mean force held.
    pub fn held() -> Self {
        Self { linear: false, two_passes: false, with_slope: true }
    }

    /// One pass, the line.
    pub fn linear() -> Self {
        Self { linear: true, ..Self::held() }
    }

    /// Two passes, with dW/ds or without.
    pub fn two_passes(with_slope: bool) -> Self {
        Self { two_passes: true, with_slope, ..Self::linear() }
    }
}

impl Scheme for Foreseen {
    fn step(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let Motion { length, speed, .. } = pair.mechanism.motion()?;
        let mut element = pair.mechanism.element()?;
        if !self.with_slope {
            element.holding_derivative = 0.0;
        }
        pair.actuator.set_motion(length, [speed, 0.0, 0.0, 0.0, 0.0])?;
        let foreseen = pair.actuator.preview(element, h, !self.two_passes)?;
        let [force, rate] = if self.linear { foreseen.line } else { [foreseen.mean, 0.0] };
        pair.mechanism.set_force([force, rate, 0.0])?;
        pair.step_mechanism(t, h)?;
        if self.two_passes {
            let end = pair.mechanism.motion()?;
            let [from, to] = foreseen.accelerations;
            let from = Motion { length, speed, acceleration: from };
            let to = Motion { acceleration: to, ..end };
            pair.actuator.set_motion(length, hermite(from, to, h))?;
        }
        pair.step_actuator(t, h)
    }
}

/// One pass in a host that passes every output on one step late, whatever feeds through: both sides step, then all
/// outputs are read, then all inputs are set. The force is foreseen from the motion foreseen before and the element of
/// the step before.
#[derive(Clone, Copy, Debug)]
pub struct Late {
    /// Whether the mechanism has the line foreseen; else its mean.
    linear: bool,
    /// What the actuator has told since its last step.
    told: Option<Preview>,
}

impl Late {
    /// With the line foreseen, or its mean held.
    pub fn new(linear: bool) -> Self {
        Self { linear, told: None }
    }
}

impl Scheme for Late {
    fn step(&mut self, pair: &mut Pair, t: f64, h: f64) -> Result<(), Refused> {
        let Motion { length, speed, .. } = pair.mechanism.motion()?;
        let now = pair.mechanism.element()?;
        // At the start no host knows anything but the start values: both sides tell them before the first step.
        pair.actuator.set_motion(length, [speed, 0.0, 0.0, 0.0, 0.0])?;
        let present = pair.actuator.preview(now, h, true)?;
        let foreseen = self.told.unwrap_or(present);
        let [force, rate] = if self.linear { foreseen.line } else { [foreseen.mean, 0.0] };
        pair.mechanism.set_force([force, rate, 0.0])?;
        pair.step_mechanism(t, h)?;
        pair.step_actuator(t, h)?;
        // The inputs of the actuator are still those of the step: its own motion, and the element at the beginning.
        self.told = Some(pair.actuator.preview(now, h, true)?);
        Ok(())
    }
}

/// A scheme's name on the page, and a new one of it.
pub type Named = (&'static str, fn() -> Box<dyn Scheme>);

/// Every scheme.
pub const ALL: [Named; 21] = [
    ("Jacobi 0", || Box::new(Jacobi::new(Extrapolation::Past(0)))),
    ("NEPCE on it", || Box::new(Jacobi::with_correction())),
    ("Jacobi 1", || Box::new(Jacobi::new(Extrapolation::Past(1)))),
    ("Jacobi 2", || Box::new(Jacobi::new(Extrapolation::Past(2)))),
    ("Jacobi rates", || Box::new(Jacobi::new(Extrapolation::Rates))),
    ("Gauss-Seidel 0", || Box::new(GaussSeidel::new(Extrapolation::Past(0)))),
    ("Gauss-Seidel 1", || Box::new(GaussSeidel::new(Extrapolation::Past(1)))),
    ("Gauss-Seidel rates", || Box::new(GaussSeidel::new(Extrapolation::Rates))),
    ("hydraulics first, rates", || Box::<HydraulicsFirst>::default()),
    ("waveform, linear F", || Box::new(Iterated::waveform(1))),
    ("waveform, quadratic F", || Box::new(Iterated::waveform(2))),
    ("interface Jacobian, linear F", || Box::new(Iterated::interface_jacobian(1))),
    ("interface Jacobian, quadratic F", || Box::new(Iterated::interface_jacobian(2))),
    ("preview, one pass, held", || Box::new(Foreseen::held())),
    ("preview, one pass, linear", || Box::new(Foreseen::linear())),
    ("preview, one pass, held, one step late", || Box::new(Late::new(false))),
    ("preview, one pass, linear, one step late", || Box::new(Late::new(true))),
    ("preview, delayed, held, one step late", || Box::new(Late::new(false))),
    ("preview, delayed, linear, one step late", || Box::new(Late::new(true))),
    ("preview, two passes, by difference", || Box::new(Foreseen::two_passes(false))),
    ("preview, two passes, with dW/ds", || Box::new(Foreseen::two_passes(true))),
];

/// Value of `coupling.mode` of the actuator that a scheme needs.
pub fn mode(name: &str) -> &'static str {
    let words = [("preview, one pass", "preview"), ("preview, delayed", "delayed")];
    words.into_iter().find(|(start, _)| name.starts_with(start)).map_or("follow", |(_, mode)| mode)
}

/// A scheme by its name in [`ALL`].
pub fn by_name(name: &str) -> Option<Box<dyn Scheme>> {
    ALL.iter().find(|(own, _)| *own == name).map(|(_, make)| make())
}
