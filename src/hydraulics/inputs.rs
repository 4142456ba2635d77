//! Inputs of a hydraulic actuator: what the host sets between steps, and how they change within a step.
//!
//! In: values and derivatives from the host. Out: each input as a polynomial in time, counted from the communication
//! point; the instants within a step at which the law of the command has a kink. It must not know what they act on.
use super::definition::Command;
use crate::common::{HostInputs, SPEED_ORDER};
use foundation::numerics::decimal::Decimal;
use std::f64::consts::TAU;

/// An input, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// Length of the actuator [m].
    Length,
    /// Speed of the actuator [m/s].
    Speed,
    /// Acceleration of the actuator [m/s2], for derivatives of outputs only.
    Acceleration,
    /// Command of the valve.
    Command,
    /// Pressure of the supply [Pa].
    Supply,
    /// Pressure of the tank [Pa].
    Tank,
    /// Mass of what the actuator moves, reduced to the actuator [kg]; 0: unknown.
    Mass,
    /// Derivative of that mass with respect to the length [kg/m].
    MassDerivative,
    /// Force that holds what the actuator moves at rest [N].
    Load,
    /// Derivative of that force with respect to the length [N/m]; 0: unknown.
    LoadDerivative,
    /// The next step of the host [s]; 0: as the last one.
    Horizon,
    /// Least length to which what the actuator moves can be pushed [m].
    LowerLimit,
    /// Largest length to which it can be pushed [m]; 0: unknown.
    UpperLimit,
}

impl Input {
    /// All inputs, in the order of their indices.
    pub const ALL: [Self; INPUTS] = [
        Self::Length,
        Self::Speed,
        Self::Acceleration,
        Self::Command,
        Self::Supply,
        Self::Tank,
        Self::Mass,
        Self::MassDerivative,
        Self::Load,
        Self::LoadDerivative,
        Self::Horizon,
        Self::LowerLimit,
        Self::UpperLimit,
    ];

    /// Whether the motion foreseen depends on it. `told`: the motion was told of before the inputs.
    pub fn changes_foresight(self, told: bool) -> bool {
        match self {
            Self::Command | Self::Supply | Self::Tank | Self::Horizon => true,
            Self::Acceleration => false,
            _ => !told,
        }
    }

    /// Largest order of the derivatives in time that count.
    pub fn order(self) -> usize {
        if self == Self::Speed { SPEED_ORDER } else { 2 }
    }
}

/// Number of inputs.
pub const INPUTS: usize = 13;

/// Values and time derivatives of the inputs; see [`HostInputs`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// Values.
    pub values: [f64; INPUTS],
    /// Derivatives of the orders 1 to 4.
    pub rates: [[f64; SPEED_ORDER]; INPUTS],
    /// Whether the derivatives apply to the next step; else they are those at the end of the last one.
    pub ahead: bool,
}

impl Inputs {
    /// Constant inputs.
    pub fn new(values: [f64; INPUTS]) -> Self {
        Self { values, rates: [[0.0; SPEED_ORDER]; INPUTS], ahead: false }
    }

    /// Value of an input.
    #[inline]
    pub fn get(&self, input: Input) -> f64 {
        self.values[input as usize]
    }

    /// The input over the next step: coefficients of the powers of the time.
    #[inline]
    pub fn polynomial(&self, input: Input) -> Polynomial {
        let value = self.get(input);
        if !self.ahead {
            return Polynomial([value, 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
        let [a, b, c, d] = self.rates[input as usize];
        Polynomial([value, a, b / 2.0, c / 6.0, d / 24.0, 0.0])
    }

    /// The length over the next step: its value plus the integral of the speed.
    #[inline]
    pub fn length(&self) -> Polynomial {
        let Polynomial([a, b, c, d, e, _]) = self.polynomial(Input::Speed);
        Polynomial([self.get(Input::Length), a, b / 2.0, c / 3.0, d / 4.0, e / 5.0])
    }

    /// Rate of an input at the communication point. That of the length is the speed, that of the speed the
    /// acceleration; the acceleration has none.
    pub fn rate(&self, input: Input) -> f64 {
        match input {
            Input::Length => self.get(Input::Speed),
            Input::Speed => self.get(Input::Acceleration),
            _ => self.rates[input as usize][0],
        }
    }

    /// Whether an input has derivatives that are not 0.
    #[inline]
    pub fn changes(&self, input: Input) -> bool {
        self.rates[input as usize] != [0.0; SPEED_ORDER]
    }

    /// Value and derivatives of an input at the end of a step of size h with derivatives.
    #[inline]
    pub fn end(&self, input: Input, h: f64) -> (f64, [f64; SPEED_ORDER]) {
        let [a, b, c, d] = self.rates[input as usize];
        let rates = [a + h * (b + h * (c / 2.0 + h * d / 6.0)), b + h * (c + h * d / 2.0), c + h * d, d];
        (self.polynomial(input).at(h), rates)
    }

    /// A step of size h is done: the inputs keep their values at its end, and their derivatives there. `motion`: length
    /// and speed at the end, if they are not those of the inputs.
    pub fn leave(&mut self, h: f64, motion: Option<[f64; 2]>) {
        let length = self.length().at(h);
        if self.ahead {
            for input in Input::ALL {
                if self.changes(input) {
                    let index = input as usize;
                    (self.values[index], self.rates[index]) = self.end(input, h);
                }
            }
        } else {
            self.rates = [[0.0; SPEED_ORDER]; INPUTS];
        }
        [self.values[Input::Length as usize], self.values[Input::Speed as usize]] =
            motion.unwrap_or([length, self.get(Input::Speed)]);
        self.ahead = false;
    }
}

impl HostInputs for Inputs {
    fn constant(values: &[f64]) -> Self {
        Self::new(std::array::from_fn(|input| values[input]))
    }

    fn parts(&self) -> (&[f64], &[[f64; SPEED_ORDER]], bool) {
        (&self.values, &self.rates, self.ahead)
    }

    fn parts_mut(&mut self) -> (&mut [f64], &mut [[f64; SPEED_ORDER]], &mut bool) {
        (&mut self.values, &mut self.rates, &mut self.ahead)
    }
}

/// A polynomial of degree 5 in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial(pub [f64; 6]);

impl Polynomial {
    /// Value at t.
    #[inline]
    pub fn at(&self, t: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, term| sum * t + term)
    }

    /// Value at t of a polynomial of degree 2 at most: the same bits, but for the sign of 0.
    #[inline]
    pub fn quadratic_at(&self, t: f64) -> f64 {
        let [a, b, c, ..] = self.0;
        (c * t + b) * t + a
    }

    /// Coefficients of the derivative.
    fn derivative(&self) -> Self {
        Self(std::array::from_fn(|i| if i < 5 { (i + 1) as f64 * self.0[i + 1] } else { 0.0 }))
    }

    /// Bound of |value - first coefficient| over [0, h].
    #[inline]
    pub fn spread(&self, h: f64) -> f64 {
        self.0[1..].iter().rev().fold(0.0, |sum, term| (sum + term.abs()) * h)
    }

    /// Calls `found` with each instant in (0, h) at which the value passes the level, ascending.
    pub fn passages(&self, level: f64, h: f64, found: &mut impl FnMut(f64)) {
        if self.spread(h) < (self.0[0] - level).abs() {
            return;
        }
        let mut lifted = *self;
        lifted.0[0] -= level;
        let (roots, count) = lifted.roots(h);
        roots[..count].iter().for_each(|root| found(*root));
    }

    /// Instants in (0, h) at which the sign changes, ascending: between two extremes there is one at most.
    fn roots(&self, h: f64) -> ([f64; 5], usize) {
        let (mut roots, mut count) = ([0.0; 5], 0);
        let Some(degree) = self.0.iter().rposition(|term| *term != 0.0).filter(|degree| *degree > 0) else {
            return (roots, 0);
        };
        let (extremes, extreme_count) = if degree > 1 { self.derivative().roots(h) } else { ([0.0; 5], 0) };
        let mut low = 0.0;
        for &high in extremes[..extreme_count].iter().chain(&[h]) {
            let (below, above) = (self.at(low), self.at(high));
            if below * above < 0.0 {
                let root = bisect(|t| self.at(t) * above >= 0.0, low, high);
                if root > 0.0 && root < h {
                    roots[count] = root;
                    count += 1;
                }
            }
            low = high;
        }
        (roots, count)
    }
}

/// The least t in (low, high] for which `passed` holds, where it changes once.
fn bisect(passed: impl Fn(f64) -> bool, mut low: f64, mut high: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if passed(middle) { high = middle } else { low = middle }
    }
}

/// Command of the valve over one step: the input plus ramp and sine, between -1 and 1.
#[derive(Clone, Copy, Debug)]
pub struct CommandSignal {
    input: Polynomial,
    ramp: Option<[f64; 2]>,
    sine: Option<[f64; 2]>,
    /// Time at the beginning of the step [s].
    begin: f64,
}

impl CommandSignal {
    /// The command from the time `begin` [s] since the start on.
    #[inline]
    pub fn new(input: Polynomial, command: &Command, begin: f64) -> Self {
        let ramp = (command.ramp_amplitude != 0.0).then_some([command.ramp_amplitude, command.ramp_time]);
        let sine = (command.sine_amplitude != 0.0).then_some([command.sine_amplitude, TAU * command.sine_frequency]);
        Self { input, ramp, sine, begin }
    }

    /// The command before it is clipped, t [s] after the beginning of the step.
    #[inline]
    pub fn wanted(&self, t: f64) -> f64 {
        let mut u = self.input.quadratic_at(t);
        let time = self.begin + t;
        if let Some([height, duration]) = self.ramp {
            u += if time < duration { height * time / duration } else { height };
        }
        if let Some([amplitude, omega]) = self.sine {
            u += amplitude * (omega * time).sin();
        }
        u
    }

    /// The command.
    #[inline]
    pub fn at(&self, t: f64) -> f64 {
        self.wanted(t).clamp(-1.0, 1.0)
    }

    /// Whether the command can be clipped within a step of size h.
    #[inline]
    pub fn may_clip(&self, h: f64) -> bool {
        let size = |part: Option<[f64; 2]>| part.map_or(0.0, |[amplitude, _]| amplitude.abs());
        self.input.0[0].abs() + self.input.spread(h) + size(self.ramp) + size(self.sine) > 1.0
    }

    /// The largest command that is clipped at the ends and the quarters of a step of size h; none if none is.
    #[inline]
    pub fn clipped(&self, h: f64) -> Option<f64> {
        if !self.may_clip(h) {
            return None;
        }
        let wanted = [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| self.wanted(part * h));
        let largest = wanted.into_iter().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        (largest.abs() > 1.0).then_some(largest)
    }

    /// Calls `found` with instants in (0, h) at which the command has a kink: the end of the ramp, and, where no sine
    /// acts, the passages of -1 and 1. The error control meets those of a sine.
    pub fn kinks(&self, h: f64, found: &mut impl FnMut(f64)) {
        let mut polynomial = self.input;
        let mut end = h;
        if let Some([height, duration]) = self.ramp {
            let rest = duration - self.begin;
            if rest > 0.0 && rest < h {
                found(rest);
                end = rest;
            }
            if rest > 0.0 {
                polynomial.0[0] += height * self.begin / duration;
                polynomial.0[1] += height / duration;
            } else {
                polynomial.0[0] += height;
            }
        }
        if self.sine.is_some() || !self.may_clip(h) {
            return;
        }
        let mut clip = |polynomial: &Polynomial, from: f64, to: f64| {
            for level in [-1.0, 1.0] {
                polynomial.passages(level, to, &mut |t| {
                    if t > from {
                        found(t);
                    }
                });
            }
        };
        clip(&polynomial, 0.0, end);
        if let (true, Some([height, _])) = (end < h, self.ramp) {
            let mut after = self.input;
            after.0[0] += height;
            clip(&after, end, h);
        }
    }
}

/// What a host is told of a command that is clipped.
#[cold]
pub fn clipping(command: f64) -> String {
    let command = Decimal::rounded(command);
    format!(
        "valve.command plus the ramp and sine of command.* is {command}: the sum was clipped to the range from -1 to 1"
    )
}

/// Pressures of the ports and the command during a step.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Pressure of the supply port [Pa].
    pub supply: Polynomial,
    /// Pressure of the tank port [Pa].
    pub tank: Polynomial,
    /// Command of the valve, from -1 to 1.
    pub command: CommandSignal,
}

impl Surroundings {
    /// Pressures of supply and tank [Pa], and the command, t [s] after the beginning of the step.
    #[inline]
    pub fn at(&self, t: f64) -> [f64; 3] {
        // All inputs but the speed have derivatives up to the second.
        [self.supply.quadratic_at(t), self.tank.quadratic_at(t), self.command.at(t)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passages_are_all_found_in_order() {
        // (t - 0.1) (t - 0.4) (t - 0.5) (t - 0.9) (t - 2).
        let mut terms = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for (degree, root) in [0.1, 0.4, 0.5, 0.9, 2.0].into_iter().enumerate() {
            for k in (0..=degree + 1).rev() {
                terms[k] = if k > 0 { terms[k - 1] } else { 0.0 } - if k <= degree { root * terms[k] } else { 0.0 };
            }
        }
        let mut found = Vec::new();
        let mut lifted = Polynomial(terms);
        lifted.0[0] += 3.0;
        lifted.passages(3.0, 1.0, &mut |t| found.push(t));
        assert_eq!(found.len(), 4);
        for (found, root) in found.iter().zip([0.1, 0.4, 0.5, 0.9]) {
            assert!((found - root).abs() < 1e-14, "{found} {root}");
        }
        Polynomial([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]).passages(0.5, 1.0, &mut |_| panic!("it is never there"));
    }

    #[test]
    fn a_ramp_ends_and_is_clipped_where_it_should() {
        let command = Command { ramp_amplitude: 3.0, ramp_time: 0.3, ..Command::default() };
        let signal = CommandSignal::new(Polynomial([0.0; 6]), &command, 0.05);
        let mut kinks = Vec::new();
        signal.kinks(1.0, &mut |t| kinks.push(t));
        kinks.sort_by(f64::total_cmp);
        assert_eq!(kinks.len(), 2);
        assert!((kinks[0] - 0.05).abs() < 1e-15 && (kinks[1] - 0.25).abs() < 1e-15, "{kinks:?}");
        assert!((signal.at(0.02) - 0.7).abs() < 1e-15 && signal.at(0.1) == 1.0 && signal.wanted(0.5) == 3.0);
    }

    #[test]
    fn inputs_are_left_where_their_polynomials_end() {
        let mut inputs = Inputs::new([1.0; INPUTS]);
        inputs.set_rate(Input::Speed as usize, 1, 2.0);
        inputs.set_rate(Input::Speed as usize, 4, 24.0);
        inputs.set_rate(Input::Command as usize, 2, 2.0);
        inputs.leave(0.5, None);
        assert_eq!(inputs.get(Input::Speed), 1.0 + 1.0 + 0.0625);
        assert_eq!(inputs.get(Input::Length), 1.0 + 0.5 + 0.25 + 0.03125 / 5.0);
        assert_eq!((inputs.get(Input::Command), inputs.rate(Input::Command)), (1.25, 1.0));
        inputs.set(Input::Command as usize, 2.0);
        assert_eq!(inputs.rate(Input::Command), 0.0);
    }
}
