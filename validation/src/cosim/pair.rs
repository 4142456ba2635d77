//! The two sides of a coupling at one cylinder, and their exchanged quantities.
//!
//! In: nothing. Out: the traits that a coupling scheme uses. A side is an FMU or a model in closed form, without a
//! difference for the scheme.

/// Length s [m], speed v [m/s] and acceleration a [m/s2] of the cylinder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// s.
    pub length: f64,
    /// v.
    pub speed: f64,
    /// a under the present force.
    pub acceleration: f64,
}

/// The mechanism as one element at the cylinder: (m + m' s) a + m' v^2 / 2 + W + W' s = F, with s from the present
/// length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Element {
    /// Reduced mass m [kg]; 0 if not given.
    pub mass: f64,
    /// dm/ds [kg/m].
    pub mass_derivative: f64,
    /// Holding force W [N].
    pub holding: f64,
    /// dW/ds [N/m]; 0 if not given.
    pub holding_derivative: f64,
    /// Least and largest length within stops and locks [m]; 0 if not given.
    pub limits: [f64; 2],
}

/// The force that the actuator predicts for the next step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Preview {
    /// Start [N] and rate [N/s] of the line with the impulse and the first moment of the predicted force.
    pub line: [f64; 2],
    /// Mean [N].
    pub mean: f64,
    /// Predicted acceleration at the start and at the end of the step [m/s2].
    pub accelerations: [f64; 2],
}

/// Error message of a side of the coupling.
pub type Refused = String;

/// The side with the force as input and the motion as output.
///
/// # Errors
/// Of all methods: the side returns an error.
pub trait Mechanism {
    /// Motion with the present force.
    fn motion(&mut self) -> Result<Motion, Refused>;
    /// Rate of the acceleration at constant force [m/s3], and da/dF [1/kg].
    fn jerk(&mut self) -> Result<[f64; 2], Refused>;
    /// The mechanism as one element.
    fn element(&mut self) -> Result<Element, Refused>;
    /// Set the force at the beginning of the next step with its first and second time derivative [N, N/s, N/s2].
    fn set_force(&mut self, force: [f64; 3]) -> Result<(), Refused>;
    /// Advance from the communication point `t` by `h` [s].
    fn step(&mut self, t: f64, h: f64) -> Result<(), Refused>;
    /// Save the present state for [`Self::restore`].
    fn save(&mut self) -> Result<(), Refused>;
    /// Restore the state saved last.
    fn restore(&mut self) -> Result<(), Refused>;
    /// Kinetic and potential energy [J].
    fn energy(&mut self) -> Result<f64, Refused>;
    /// The coordinate whose error is measured.
    fn position(&mut self) -> Result<f64, Refused>;
}

fn lacking<T>(what: &str) -> Result<T, Refused> {
    Err(format!("the actuator has no {what}"))
}

/// The side with the motion as input and the force as output; optional methods return an error by default.
///
/// # Errors
/// Of all methods: the side returns an error.
pub trait Actuator {
    /// Set the length at the beginning of the next step, and the speed there with its time derivatives up to order 4.
    fn set_motion(&mut self, length: f64, speed: [f64; 5]) -> Result<(), Refused>;
    /// Force [N].
    fn force(&mut self) -> Result<f64, Refused>;
    /// Rate of the force at this acceleration [N/s].
    fn force_rate(&mut self, _acceleration: f64) -> Result<f64, Refused> {
        lacking("output derivatives")
    }
    /// Instantaneous stiffness -dF/ds [N/m], and damping -dF/dv [N.s/m].
    fn compliance(&mut self) -> Result<[f64; 2], Refused> {
        lacking("stiffness as an output")
    }
    /// The force predicted for a step of `h` [s] with this element from the present motion. With `keeps`, the next step
    /// follows the predicted motion; otherwise the motion that is set.
    fn preview(&mut self, _element: Element, _h: f64, _keeps: bool) -> Result<Preview, Refused> {
        lacking("preview")
    }
    /// Advance from the communication point `t` by `h` [s].
    fn step(&mut self, t: f64, h: f64) -> Result<(), Refused>;
    /// Save the present state for [`Self::restore`].
    fn save(&mut self) -> Result<(), Refused> {
        lacking("saved states")
    }
    /// Restore the state saved last.
    fn restore(&mut self) -> Result<(), Refused> {
        lacking("saved states")
    }
    /// Work done on the mechanism since the start [J].
    fn work(&mut self) -> Result<f64, Refused> {
        lacking("energy")
    }
}

/// Both sides, with their numbers of steps.
pub struct Pair<'a> {
    /// Side with the force as input.
    pub mechanism: &'a mut dyn Mechanism,
    /// Side with the force as output.
    pub actuator: &'a mut dyn Actuator,
    /// Number of steps of the mechanism and of the actuator.
    pub steps: [u64; 2],
}

/// Outputs of both sides at a communication point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Point {
    /// Motion of the mechanism with `force`.
    pub motion: Motion,
    /// Force of the actuator with the speed of `motion` [N].
    pub force: f64,
}

impl<'a> Pair<'a> {
    /// A pair at its start.
    pub fn new(mechanism: &'a mut dyn Mechanism, actuator: &'a mut dyn Actuator) -> Self {
        Self { mechanism, actuator, steps: [0; 2] }
    }

    /// Exchange the present values: the motion is set in the actuator, the force in the mechanism.
    pub fn exchange(&mut self) -> Result<Point, Refused> {
        let Motion { length, speed, .. } = self.mechanism.motion()?;
        self.actuator.set_motion(length, [speed, 0.0, 0.0, 0.0, 0.0])?;
        let force = self.actuator.force()?;
        self.mechanism.set_force([force, 0.0, 0.0])?;
        Ok(Point { motion: self.mechanism.motion()?, force })
    }

    /// [`Mechanism::step`], counted.
    pub fn step_mechanism(&mut self, t: f64, h: f64) -> Result<(), Refused> {
        self.steps[0] += 1;
        self.mechanism.step(t, h)
    }

    /// [`Actuator::step`], counted.
    pub fn step_actuator(&mut self, t: f64, h: f64) -> Result<(), Refused> {
        self.steps[1] += 1;
        self.actuator.step(t, h)
    }
}

/// The speed as the polynomial of degree 4 in time with the speeds and accelerations at both ends of a step of `h` [s]
/// and its change of length: value and derivatives at the start.
pub fn hermite(from: Motion, to: Motion, h: f64) -> [f64; 5] {
    // v(tau) = v0 + a0 tau + c2 x^2 + c3 x^3 + c4 x^4 with x = tau / h: three conditions for c.
    let speed = to.speed - from.speed - from.acceleration * h;
    let slope = (to.acceleration - from.acceleration) * h;
    let length = (to.length - from.length) / h - from.speed - 0.5 * from.acceleration * h;
    let c4 = 30.0 * (length - 0.5 * speed + slope / 12.0);
    let c3 = slope - 2.0 * speed - 2.0 * c4;
    let c2 = speed - c3 - c4;
    [from.speed, from.acceleration, 2.0 * c2 / (h * h), 6.0 * c3 / h.powi(3), 24.0 * c4 / h.powi(4)]
}
