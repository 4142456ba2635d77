//! Iterated coupling: both sides repeat the step until the force at its end is the one that was assumed.
//!
//! In: values at both ends of a step. Out: a force that both sides agree on. Needs saved states. Source: Sicklinger et
//! al. 2014 (interface Jacobian).
use super::sequential::parabola;
use super::{Rates, Scheme};
use crate::cosim::pair::{Pair, Refused, hermite};

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
