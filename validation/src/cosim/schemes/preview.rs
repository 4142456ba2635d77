//! Preview: the actuator knows the mechanism as one element, foresees the motion of both over the next step, and hands
//! over a force of the right impulse. No rollback, no repetition.
use super::Scheme;
use crate::cosim::pair::{Motion, Pair, Preview, Refused, hermite};

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
