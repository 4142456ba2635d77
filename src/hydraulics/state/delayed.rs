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
use super::limits::{holds, passed};
use super::{Blind, Foreseen, Preview, SAME_STEP, Setting, State};
use crate::circuit::CIRCUIT;
use crate::inputs::Input;
use crate::systems::{ELEMENT, Element, IMPULSE, LENGTH, SPEED, with_element, without_element};
use foundation::codec::record::{Damaged, Record};

/// What the mechanism has been told of the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// Length [m] and speed [m/s] at the beginning of the motion foreseen: those of the mechanism, and the lead.
    pub start: [f64; 2],
    /// Length and speed of the mechanism at the beginning of the step, predicted.
    mechanism: [f64; 2],
    /// Force [N] in the mean force told that makes the mechanism catch up.
    catching_up: f64,
    /// The element, of the communication point before.
    pub element: Element<f64>,
    /// Correction of its load [N].
    pub correction: f64,
    /// The outputs.
    pub preview: Preview<f64>,
    /// Size of the step [s].
    pub step: f64,
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
    /// Whether a stop or a lock holds it at the end.
    is_held: bool,
}

impl Predicted {
    /// Holding force [N] expected at the end of a step of size h [s].
    pub fn load(&self, h: f64) -> f64 {
        self.element.load_at(self.motion[0], h) - self.correction
    }
}

impl Told {
    /// Of no meaning, to be read into.
    pub fn blank() -> Self {
        let (mass, mass_derivative, load, load_derivative, load_rate, length) = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let limits = [f64::NEG_INFINITY, f64::INFINITY];
        let element = Element { mass, mass_derivative, load, load_derivative, load_rate, length, limits };
        let preview = Preview::blind(0.0, [0.0; 3], 0.0, 1.0);
        let (start, mechanism, catching_up) = ([0.0; 2], [0.0; 2], 0.0);
        Self { start, mechanism, catching_up, element, correction: 0.0, preview, step: 1.0 }
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let Self { start, mechanism, catching_up, element, correction, preview, step } = self;
        record.positive("size of the predicted step", step)?;
        record.all_finite("predicted motion of the mechanism", mechanism)?;
        record.finite("force of the correction", catching_up)?;
        record.all_finite("start of the predicted motion", start)?;
        record.positive("reduced mass of the prediction", &mut element.mass)?;
        let Element { mass_derivative, load, load_derivative, load_rate, length, limits, .. } = element;
        limits.iter_mut().try_for_each(|limit| record.number("length limit", limit, |x| !x.is_nan(), "a number"))?;
        for value in [mass_derivative, load, load_derivative, load_rate, length, correction] {
            record.finite("mass or load of the prediction", value)?;
        }
        let Preview { force, force_rate, force_mean, length, speed, start_acceleration, acceleration } = preview;
        for value in [force, force_rate, force_mean, length, speed, start_acceleration, acceleration] {
            record.finite("predicted output", value)?;
        }
        Ok(())
    }
}

/// Time over which oil makes up for a way that is owed [s]: some periods of what the oil carries, so that the coupling
/// does not react to it.
const REPAYMENT: f64 = 0.1;

impl State {
    /// Way that the piston owes the oil [m] at the communication point: after a step whose force was for another one,
    /// with what the mechanism has gone further than the motion kept.
    pub(super) fn owed(&self, setting: &Setting<'_>) -> f64 {
        let last = self.last.as_ref().filter(|last| last.owes);
        self.owed + last.map_or(0.0, |last| setting.inputs.get(Input::Length) - last.end_length)
    }

    /// Part of it that a step of size h [s] repays [m].
    pub(super) fn repaid(&self, setting: &Setting<'_>, h: f64) -> f64 {
        let owed = self.owed(setting);
        if owed == 0.0 { 0.0 } else { owed * -(-h / REPAYMENT).exp_m1() }
    }

    /// The circuit at the beginning of a step of size h [s] that keeps the motion foreseen.
    pub(super) fn at_beginning(&self, setting: &Setting<'_>, h: f64) -> [f64; CIRCUIT] {
        match self.repaid(setting, h) {
            0.0 => self.circuit,
            way => setting.laws.displaced(&self.circuit, setting.inputs.get(Input::Length), way),
        }
    }

    /// By how much the motion foreseen, which a step of size h [s] has kept, leads the mechanism at its end, length [m]
    /// and speed [m/s]: the command or a pressure has changed, the load has jumped or a lock has let go after the
    /// mechanism was told its force. Whatever else nobody foresaw is no lead: the next foresight begins where the
    /// mechanism is. To a load or a lock, which act for two steps before a force can react, the oil reacts from here on
    /// as if it had known of them.
    pub fn lead(
        &mut self,
        setting: &Setting<'_>,
        predicted: &Predicted,
        (before, foreseen): (&[f64; CIRCUIT], &Foreseen),
        h: f64,
    ) -> [f64; 2] {
        let Some(told) = self.told else { return [0.0; 2] };
        if foreseen.course.met_end {
            // The mechanism is where the force brings it that leads to the end of the cylinder.
            return [0.0; 2];
        }
        let end = [foreseen.end[LENGTH], foreseen.end[SPEED]];
        let expected = under_force(&told.element, told.preview.force_mean, told.mechanism, h);
        if (told.step - h).abs() > SAME_STEP * h {
            self.owed += expected[0] - end[0];
            return [0.0; 2];
        }
        if predicted.is_held {
            return [0.0; 2];
        }
        let [length, speed] = [told.start[0] - told.mechanism[0], told.start[1] - told.mechanism[1]];
        let gain = told.catching_up * h / predicted.element.mass;
        let mut lead = [
            length + (speed - 0.5 * gain) * h + (end[0] - told.preview.length),
            speed - gain + (end[1] - told.preview.speed),
        ];
        let [lower, upper] = told.element.limits;
        let is_other = lower == upper && predicted.element.limits != told.element.limits;
        // A mechanism that static friction alone has held at rest has set no limits.
        let let_go = is_other && self.last.is_some_and(|last| !last.rests);
        let steps = self.unanswered(setting, let_go);
        if steps > 0
            && let Some(reacted) = self.reaction(setting, predicted, (before, foreseen), (steps, h))
        {
            lead[0] += reacted[LENGTH] - end[0] + (expected[0] - predicted.motion[0]);
            lead[1] += reacted[SPEED] - end[1] + (expected[1] - predicted.motion[1]);
            self.circuit = without_element(&reacted);
        }
        lead
    }

    /// State at the end of a step of size h [s], had the oil known the element of the inputs for so many steps. Each of
    /// them starts from the state before the last one, with the change that the others have made: what the motion
    /// foreseen passes through in a step changes the reaction by little.
    fn reaction(
        &self,
        setting: &Setting<'_>,
        predicted: &Predicted,
        (before, foreseen): (&[f64; CIRCUIT], &Foreseen),
        (steps, h): (usize, f64),
    ) -> Option<[f64; ELEMENT]> {
        let before = with_element(before, foreseen.start);
        let (mut start, mut end) = (before, None);
        for _ in 0..steps {
            let from = (&without_element(&start), [start[LENGTH], start[SPEED]]);
            let seen = self.foresee_from(setting, from, (predicted.element, predicted.correction), h).ok()?;
            if !seen.is_whole() || seen.course.met_end || seen.course.held_at_end {
                return None;
            }
            start = std::array::from_fn(|k| before[k] + (seen.end[k] - foreseen.end[k]));
            end = Some(seen.end);
        }
        end
    }

    /// A way that is owed is repaid over a step of size h [s] that ends at this length [m].
    pub fn repay(&mut self, setting: &Setting<'_>, length: f64, h: f64) {
        let way = self.repaid(setting, h);
        if way != 0.0 {
            self.owed -= way;
            self.circuit = setting.laws.displaced(&self.circuit, length, way);
        }
    }

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
        let is_held = motion[1] == 0.0 && holds(element.limits, motion[0], force - element.load_at(motion[0], h));
        if motion.iter().all(|x| x.is_finite()) {
            Ok(Predicted { motion, element, correction, is_held })
        } else {
            Err(Blind::Failed)
        }
    }

    /// Tell the mechanism of a step of size h [s] from here. `last`: size of the step before [s]; `lead`: by how much
    /// the motion foreseen leads there. A force in addition makes the mechanism catch up in two steps.
    pub fn tell(
        &mut self,
        setting: &Setting<'_>,
        predicted: &Predicted,
        (last, lead): (f64, [f64; 2]),
        h: f64,
    ) -> Option<Foreseen> {
        let Predicted { motion: mechanism, mut element, correction, .. } = *predicted;
        element.load += element.load_rate * last;
        let start = [mechanism[0] + lead[0], mechanism[1] + lead[1]];
        let catching_up = element.mass * (lead[0] / h + 1.5 * lead[1]) / h;
        let seen = self.foresee_from(setting, (&self.circuit, start), (element, correction), h).ok()?;
        let mut preview = Preview::new(setting.laws, &element, (seen.start_force, start), (&seen.end, seen.course), h);
        preview.force += catching_up;
        preview.force_mean += catching_up;
        let finite = preview.values().iter().all(|value| value.is_finite()) && element.load.is_finite();
        if !seen.is_whole() || !finite {
            return None;
        }
        self.told = Some(Told { start, mechanism, catching_up, element, correction, preview, step: h });
        Some(seen)
    }
}

/// Length and speed of an element after h [s] under a constant force: one step of Runge and Kutta's method of order 4.
/// The element alone has no oil spring: it hardly changes in a step.
fn under_force(element: &Element<f64>, force: f64, start: [f64; 2], h: f64) -> [f64; 2] {
    if start[1] == 0.0 && holds(element.limits, start[0], force - element.load_at(start[0], 0.0)) {
        return start;
    }
    let rates = |t: f64, [s, v]: [f64; 2]| [v, element.acceleration(force, s, v, t)];
    let at = |by: f64, k: [f64; 2]| [start[0] + by * k[0], start[1] + by * k[1]];
    let a = rates(0.0, start);
    let b = rates(0.5 * h, at(0.5 * h, a));
    let c = rates(0.5 * h, at(0.5 * h, b));
    let d = rates(h, at(h, c));
    let [length, speed] = std::array::from_fn(|k| start[k] + h / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]));
    match passed(element.limits, length) {
        Some((limit, _)) => [limit, 0.0],
        None => [length, speed],
    }
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
