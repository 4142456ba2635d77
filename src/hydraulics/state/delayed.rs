//! Hosts that pass every value one step late: the mechanism receives the force of a step at the start of the step, and
//! the actuator has computed it from the values of one step before.
//!
//! In: the state after a step, the element of the inputs. Out: the motion of the mechanism under the reported force,
//! and the force of the next step. It must not know variables.
//!
//! The mechanism uses the mean force of the motion that the actuator has *reported*. So the step keeps this motion,
//! even if the inputs meanwhile describe another one. The position of the mechanism at the end follows from the motion
//! of the inputs under the reported force; the next prediction starts there. The difference between the speed of the
//! mechanism and this prediction is the error of the element alone, and its correction does not see the delay: the pair
//! has the eigenvalues of a pair without a delay.
use super::{Blind, Foreseen, Preview, Setting, State};
use crate::codec::record::{Damaged, Record};
use crate::hydraulics::inputs::Input;
use crate::hydraulics::systems::{Element, IMPULSE};

/// What the mechanism has been told of the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// Length [m] and speed [m/s] of the mechanism at the beginning of the step, predicted.
    pub start: [f64; 2],
    /// The element, of the communication point before.
    pub element: Element<f64>,
    /// Correction of its load [N].
    pub correction: f64,
    /// The outputs.
    pub preview: Preview<f64>,
}

/// The mechanism at the end of a step, predicted.
#[derive(Clone, Copy, Debug)]
pub struct Predicted {
    /// Length [m] and speed [m/s].
    pub motion: [f64; 2],
    /// The element at the beginning of the step.
    element: Element<f64>,
    /// Correction of its load [N].
    pub correction: f64,
}

impl Told {
    /// Of no meaning, to be read into.
    pub fn blank() -> Self {
        let element =
            Element { mass: 1.0, mass_derivative: 0.0, load: 0.0, load_derivative: 0.0, load_rate: 0.0, length: 0.0 };
        Self { start: [0.0; 2], element, correction: 0.0, preview: Preview::blind(0.0, [0.0; 3], 0.0, 1.0) }
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let Self { start, element, correction, preview } = self;
        record.all_finite("motion reported", start)?;
        record.positive("mass reported", &mut element.mass)?;
        let Element { mass_derivative, load, load_derivative, load_rate, length, .. } = element;
        for value in [mass_derivative, load, load_derivative, load_rate, length, correction] {
            record.finite("element reported", value)?;
        }
        let Preview { force, force_rate, force_mean, length, speed, start_acceleration, acceleration } = preview;
        for value in [force, force_rate, force_mean, length, speed, start_acceleration, acceleration] {
            record.finite("preview reported", value)?;
        }
        Ok(())
    }
}

impl State {
    /// Where the mechanism of the inputs is at the end of a step of size h [s] under the force that it was told; in a
    /// first step, under that of the motion foreseen.
    ///
    /// # Errors
    /// Why it cannot be predicted.
    pub fn predict(&self, setting: &Setting<'_>, foreseen: &Foreseen, h: f64) -> Result<Predicted, Blind> {
        let (element, correction) = self.checked_element(setting, h)?;
        let force = self.told.map_or(foreseen.end[IMPULSE] / h, |told| told.preview.force_mean);
        let start = [Input::Length, Input::Speed].map(|input| setting.inputs.get(input));
        let motion = under_force(&element, force, start, h);
        if motion.iter().all(|x| x.is_finite()) {
            Ok(Predicted { motion, element, correction })
        } else {
            Err(Blind::Failed)
        }
    }

    /// Tell the mechanism of a step of size h [s] from here. `last`: size of the step before [s].
    pub fn tell(&mut self, setting: &Setting<'_>, predicted: &Predicted, last: f64, h: f64) -> Option<Foreseen> {
        let Predicted { motion: start, mut element, correction } = *predicted;
        element.load += element.load_rate * last;
        let seen = self.foresee_from(setting, start, (element, correction), h).ok()?;
        let preview = Preview::new(setting.laws, &element, (seen.start_force, start[1]), &seen.end, h);
        let finite = preview.values().iter().all(|value| value.is_finite()) && element.load.is_finite();
        if seen.reached < h || !finite {
            return None;
        }
        self.told = Some(Told { start, element, correction, preview });
        Some(seen)
    }
}

/// Length and speed of an element after h [s] under a constant force: one step of Runge and Kutta's method of order 4.
/// The element alone has no oil spring: it hardly changes in a step.
fn under_force(element: &Element<f64>, force: f64, start: [f64; 2], h: f64) -> [f64; 2] {
    let rates = |t: f64, [s, v]: [f64; 2]| [v, element.acceleration(force, s, v, t)];
    let at = |by: f64, k: [f64; 2]| [start[0] + by * k[0], start[1] + by * k[1]];
    let a = rates(0.0, start);
    let b = rates(0.5 * h, at(0.5 * h, a));
    let c = rates(0.5 * h, at(0.5 * h, b));
    let d = rates(h, at(h, c));
    std::array::from_fn(|k| start[k] + h / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Under a constant force m v' = F - W - W1 (s - s0): harmonic.
    #[test]
    fn an_element_moves_as_it_should_under_a_constant_force() {
        let element = Element { load: 100.0, load_derivative: 5e3, mass: 50.0, ..Told::blank().element };
        let (force, h, omega) = (400.0, 0.02, 10.0_f64);
        let [s, v] = under_force(&element, force, [0.0, 0.3], h);
        let (sin, cos) = (omega * h).sin_cos();
        let rest = 300.0 / 5e3;
        assert!((s - (rest - rest * cos + 0.3 / omega * sin)).abs() < 2e-7, "{s}");
        assert!((v - (rest * omega * sin + 0.3 * cos)).abs() < 2e-5, "{v}");
    }
}
