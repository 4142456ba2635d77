//! The law of friction: the coefficient over slip speed.
//!
//! In: slip speed. Out: the coefficient with its sign, on a regime in which it is smooth. It must not know joints or
//! reactions. Source: [HF08] section 4, fig. 8.
use crate::numerics::dual::Number;

/// Coefficient of friction mu over slip speed v >= 0: proportional to v up to mu_S at V_S, a cubic step to mu_d at V_d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// mu_S [1], >= 0.
    pub static_coefficient: f64,
    /// mu_d [1], >= 0.
    pub kinetic_coefficient: f64,
    /// V_S [m/s], > 0.
    pub static_speed: f64,
    /// V_d [m/s], > V_S.
    pub kinetic_speed: f64,
}

/// A range of slip speeds in which the law is smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regime {
    /// |v| up to V_S: mu is proportional to v.
    Viscous,
    /// |v| between V_S and V_d: mu follows the cubic step. The number is the sign of v.
    Transition(f64),
    /// |v| above V_d: mu is constant. The number is the sign of v.
    Kinetic(f64),
}

impl Law {
    /// Regime at the slip speed v [m/s].
    pub fn regime(&self, v: f64) -> Regime {
        let sign = if v < 0.0 { -1.0 } else { 1.0 };
        if v.abs() <= self.static_speed {
            Regime::Viscous
        } else if v.abs() < self.kinetic_speed {
            Regime::Transition(sign)
        } else {
            Regime::Kinetic(sign)
        }
    }

    /// First and last v of a regime [m/s].
    pub fn range(&self, regime: Regime) -> (f64, f64) {
        let (low, high) = (self.static_speed, self.kinetic_speed);
        match regime {
            Regime::Viscous => (-low, low),
            Regime::Transition(sign) if sign > 0.0 => (low, high),
            Regime::Transition(_) => (-high, -low),
            Regime::Kinetic(sign) if sign > 0.0 => (high, f64::INFINITY),
            Regime::Kinetic(_) => (f64::NEG_INFINITY, -high),
        }
    }

    /// Regime next to `regime` in the direction of v.
    pub fn next(&self, regime: Regime, v: f64) -> Regime {
        let (low, high) = self.range(regime);
        let upward = v > 0.5 * (low.max(-f64::MAX) + high.min(f64::MAX));
        match regime {
            Regime::Viscous => Regime::Transition(if upward { 1.0 } else { -1.0 }),
            Regime::Transition(sign) if upward == (sign > 0.0) => Regime::Kinetic(sign),
            Regime::Transition(_) => Regime::Viscous,
            Regime::Kinetic(sign) => Regime::Transition(sign),
        }
    }

    /// mu with the sign of v [1] over the slip speed v [m/s] of any sign, on `regime`. The cubic continues smoothly
    /// beyond the regime, where trial steps may evaluate it.
    pub fn cubic(&self, regime: Regime) -> Cubic {
        let (low, high) = (self.static_coefficient, self.kinetic_coefficient);
        match regime {
            Regime::Viscous => Cubic { from: 0.0, rate: 1.0 / self.static_speed, terms: [0.0, low, 0.0, 0.0] },
            Regime::Transition(sign) => Cubic {
                from: sign * self.static_speed,
                rate: sign / (self.kinetic_speed - self.static_speed),
                terms: [low, 0.0, 3.0 * (high - low), -2.0 * (high - low)].map(|term| sign * term),
            },
            Regime::Kinetic(sign) => Cubic { from: 0.0, rate: 0.0, terms: [sign * high, 0.0, 0.0, 0.0] },
        }
    }
}

/// The law on one regime: a cubic in s = rate (v - from).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cubic {
    from: f64,
    rate: f64,
    terms: [f64; 4],
}

impl Cubic {
    /// Value at v.
    #[inline]
    pub fn at<T: Number>(&self, v: T) -> T {
        let s = (v - T::constant(self.from)) * T::constant(self.rate);
        let [a, b, c, d] = self.terms.map(T::constant);
        (a + s * b) + s * s * (c + s * d)
    }

    /// The cubic times a factor.
    pub fn times(self, factor: f64) -> Self {
        Self { terms: self.terms.map(|term| term * factor), ..self }
    }
}

#[cfg(test)]
mod tests;
