//! Coupling schemes: one communication step each, by the calls of the two sides alone.
//!
//! In: a pair, a communication step. Out: the pair at the end of the step. They must not know what the sides are.
mod iterated;
mod parallel;
mod preview;
mod sequential;

pub use iterated::Iterated;
pub use parallel::Jacobi;
pub use preview::{Foreseen, Late};
pub use sequential::{GaussSeidel, HydraulicsFirst};

use super::pair::{Pair, Point, Refused};

/// A coupling scheme with its memory of the past.
pub trait Scheme {
    /// From the communication point `t` to `t + h` [s], both sides having the state at `t`.
    ///
    /// # Errors
    /// A side refuses a call.
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
