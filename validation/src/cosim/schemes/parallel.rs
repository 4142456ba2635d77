//! Jacobi coupling: both sides step at once, with what they knew at the beginning of the step.
//!
//! In: values at communication points. Out: extrapolated inputs. Source of the correction: Benedikt et al. 2013.
use super::{Extrapolation, History, Rates, Scheme};
use crate::cosim::pair::{Pair, Point, Refused};

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
