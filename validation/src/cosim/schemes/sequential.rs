//! Sequential coupling: one side steps first, and the other one knows how that went.
//!
//! In: values at communication points. Out: inputs extrapolated for the first side, interpolated for the second.
use super::{Extrapolation, History, Rates, Scheme};
use crate::cosim::pair::{Pair, Refused, hermite};

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
pub(super) fn parabola(value: f64, rate: f64, end: f64, h: f64) -> [f64; 3] {
    [value, rate, 2.0 * (end - value - rate * h) / (h * h)]
}
