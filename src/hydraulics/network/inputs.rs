//! Inputs of a network: what the host sets between steps, and how they change within a step.
//!
//! In: values and derivatives from the host. Out: each input as a polynomial in time, counted from the communication
//! point. It must not know what they act on.
use super::layout::{Input, Layout, Part};
use crate::common::{HostInputs, SPEED_ORDER};
use crate::inputs::Polynomial;
use foundation::format::Range;

/// Values and time derivatives of the inputs; see [`HostInputs`].
#[derive(Clone, Debug, PartialEq)]
pub struct Inputs {
    /// Values.
    pub values: Vec<f64>,
    /// Derivatives of the orders 1 to 4.
    rates: Vec<[f64; SPEED_ORDER]>,
    /// Whether the derivatives apply to the next step; else they are those at the end of the last one.
    pub ahead: bool,
}

/// Largest order of the derivatives in time that count.
pub fn order(input: Input) -> usize {
    if matches!(input, Input::Cylinder(_, Part::Speed)) { SPEED_ORDER } else { 2 }
}

/// Range of an input that is no pressure.
pub fn range(input: Input) -> Range {
    match input {
        Input::Open(_) => Range::Unit,
        Input::Pump(_) | Input::Horizon | Input::Cylinder(_, Part::Mass | Part::LowerLimit | Part::UpperLimit) => {
            Range::NonNegative
        }
        _ => Range::Finite,
    }
}

/// Range in which the laws take an input, whatever the host says or extrapolates.
pub fn limits(input: Input) -> [f64; 2] {
    match input {
        Input::Command(_) => [-1.0, 1.0],
        Input::Open(_) => [0.0, 1.0],
        Input::Pump(_) => [0.0, f64::INFINITY],
        _ => [f64::NEG_INFINITY, f64::INFINITY],
    }
}

impl Inputs {
    /// Constant inputs.
    pub fn new(values: Vec<f64>) -> Self {
        Self { rates: vec![[0.0; SPEED_ORDER]; values.len()], values, ahead: false }
    }

    /// The input over the next step.
    #[inline]
    pub fn polynomial(&self, input: usize) -> Polynomial {
        let value = self.values[input];
        if !self.ahead {
            return Polynomial([value, 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
        let [a, b, c, d] = self.rates[input];
        Polynomial([value, a, b / 2.0, c / 6.0, d / 24.0, 0.0])
    }

    /// Length and speed of a cylinder over the next step: the length is its value plus the integral of the speed.
    pub fn motion(&self, layout: &Layout, cylinder: usize) -> [Polynomial; 2] {
        let speed = self.polynomial(layout.of_cylinder(cylinder, Part::Speed));
        let Polynomial([a, b, c, d, e, _]) = speed;
        let length = self.values[layout.of_cylinder(cylinder, Part::Length)];
        [Polynomial([length, a, b / 2.0, c / 3.0, d / 4.0, e / 5.0]), speed]
    }

    /// Rate of an input at the communication point. That of a length is the speed, that of a speed the acceleration.
    pub fn rate(&self, layout: &Layout, input: usize) -> f64 {
        match layout.input(input) {
            Input::Cylinder(_, Part::Length | Part::Speed) => self.values[input + 1],
            _ => self.rates[input][0],
        }
    }

    /// Whether an input has derivatives that are not 0.
    pub fn changes(&self, input: usize) -> bool {
        self.rates[input] != [0.0; SPEED_ORDER]
    }

    /// Value and derivatives of an input at the end of a step of size h with derivatives.
    pub fn end(&self, input: usize, h: f64) -> (f64, [f64; SPEED_ORDER]) {
        let [a, b, c, d] = self.rates[input];
        let rates = [a + h * (b + h * (c / 2.0 + h * d / 6.0)), b + h * (c + h * d / 2.0), c + h * d, d];
        (self.polynomial(input).at(h), rates)
    }

    /// A step of size h is done: the inputs keep their values at its end, and their derivatives there. Lengths and
    /// speeds are those of the state from `motion` on.
    pub fn leave(&mut self, layout: &Layout, h: f64, y: &[f64]) {
        for input in 0..self.values.len() {
            if self.ahead && self.changes(input) {
                (self.values[input], self.rates[input]) = self.end(input, h);
            } else if !self.ahead {
                self.rates[input] = [0.0; SPEED_ORDER];
            }
        }
        for cylinder in 0..layout.cylinders {
            let (own, length) = (layout.motion(cylinder), layout.of_cylinder(cylinder, Part::Length));
            self.values[length..length + 2].copy_from_slice(&y[own..own + 2]);
        }
        self.ahead = false;
    }
}

impl HostInputs for Inputs {
    fn constant(values: &[f64]) -> Self {
        Self::new(values.to_vec())
    }

    fn parts(&self) -> (&[f64], &[[f64; SPEED_ORDER]], bool) {
        (&self.values, &self.rates, self.ahead)
    }

    fn parts_mut(&mut self) -> (&mut [f64], &mut [[f64; SPEED_ORDER]], &mut bool) {
        (&mut self.values, &mut self.rates, &mut self.ahead)
    }
}
