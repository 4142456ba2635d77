//! The law of friction: the coefficient over slip speed.
//!
//! In: slip speed. Out: the coefficient with its sign, on a regime in which it is smooth. It must not know joints or
//! reactions. Sources: [HF08] section 4, fig. 8; Coulomb's law with a Stribeck curve, which holds at rest.
use crate::numerics::dual::Number;

/// Coefficient of friction mu over slip speed v >= 0: up to V_S proportional to v, or mu_S if the law sticks; from V_S
/// on a cubic step from mu_S to mu_d at V_d, then mu_d. A law that sticks has every coefficient of either sign up to
/// mu_S at rest; with V_S = V_d = 0 it has mu_d at any slip speed but 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Whether friction holds at rest.
    pub sticks: bool,
    /// mu_S [1], >= 0.
    pub static_coefficient: f64,
    /// mu_d [1], >= 0.
    pub kinetic_coefficient: f64,
    /// V_S [m/s], > 0; >= 0 if the law sticks.
    pub static_speed: f64,
    /// V_d [m/s], > V_S; if the law sticks, both may be 0.
    pub kinetic_speed: f64,
}

/// A range of slip speeds in which the law is smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regime {
    /// |v| up to V_S: mu is proportional to v.
    Viscous,
    /// |v| up to V_S in a law that sticks: mu is mu_S. The number is the sign of v.
    Static(f64),
    /// |v| between V_S and V_d: mu follows the cubic step. The number is the sign of v.
    Transition(f64),
    /// |v| above V_d: mu is constant. The number is the sign of v.
    Kinetic(f64),
    /// v is kept 0 on a driven surface: the friction is what that takes, up to mu_S. No speed ends this regime.
    Sticking,
}

impl Regime {
    /// Sign of v; 0 where v has either sign or none.
    pub fn sign(self) -> f64 {
        match self {
            Self::Static(sign) | Self::Transition(sign) | Self::Kinetic(sign) => sign,
            Self::Viscous | Self::Sticking => 0.0,
        }
    }
}

impl Law {
    /// Regime at the slip speed v [m/s].
    pub fn regime(&self, v: f64) -> Regime {
        self.regime_towards(v, v)
    }

    /// Regime at the slip speed v [m/s]; if this is 0, that of a slip of the sign of `towards` as it begins.
    #[inline]
    pub fn regime_towards(&self, v: f64, towards: f64) -> Regime {
        let sign = if v < 0.0 || (v == 0.0 && towards < 0.0) { -1.0 } else { 1.0 };
        if self.sticks && self.static_speed > 0.0 && v.abs() <= self.static_speed {
            Regime::Static(sign)
        } else if !self.sticks && v.abs() <= self.static_speed {
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
            Regime::Static(sign) if sign > 0.0 => (0.0, low),
            Regime::Static(_) => (-low, 0.0),
            Regime::Transition(sign) if sign > 0.0 => (low, high),
            Regime::Transition(_) => (-high, -low),
            Regime::Kinetic(sign) if sign > 0.0 => (high, f64::INFINITY),
            Regime::Kinetic(_) => (f64::NEG_INFINITY, -high),
            Regime::Sticking => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Regime next to `regime` in the direction of v.
    pub fn next(&self, regime: Regime, v: f64) -> Regime {
        let (low, high) = self.range(regime);
        let upward = v > 0.5 * (low.max(-f64::MAX) + high.min(f64::MAX));
        match regime {
            Regime::Viscous => Regime::Transition(if upward { 1.0 } else { -1.0 }),
            Regime::Static(sign) if upward == (sign > 0.0) => Regime::Transition(sign),
            Regime::Static(sign) => Regime::Static(-sign),
            Regime::Transition(sign) if upward == (sign > 0.0) => Regime::Kinetic(sign),
            Regime::Transition(_) if !self.sticks => Regime::Viscous,
            Regime::Transition(sign) if self.static_speed > 0.0 => Regime::Static(sign),
            Regime::Transition(sign) => Regime::Transition(-sign),
            Regime::Kinetic(sign) if self.kinetic_speed > 0.0 => Regime::Transition(sign),
            Regime::Kinetic(sign) => Regime::Kinetic(-sign),
            Regime::Sticking => self.regime_towards(0.0, v),
        }
    }

    /// mu_S against a slip of the sign of `towards` [1]; 0 if that is 0.
    pub fn at_breakaway(&self, towards: f64) -> Cubic {
        let sign = if towards == 0.0 { 0.0 } else { towards.signum() };
        Cubic { from: 0.0, rate: 0.0, terms: [sign * self.static_coefficient, 0.0, 0.0, 0.0] }
    }

    /// mu with the sign of v [1] over the slip speed v [m/s] of any sign, on `regime`. The cubic continues smoothly
    /// beyond the regime, where trial steps may evaluate it.
    #[inline]
    pub fn cubic(&self, regime: Regime) -> Cubic {
        let (low, high) = (self.static_coefficient, self.kinetic_coefficient);
        match regime {
            Regime::Viscous => Cubic { from: 0.0, rate: 1.0 / self.static_speed, terms: [0.0, low, 0.0, 0.0] },
            Regime::Static(sign) => self.at_breakaway(sign),
            Regime::Transition(sign) => Cubic {
                from: sign * self.static_speed,
                rate: sign / (self.kinetic_speed - self.static_speed),
                terms: [low, 0.0, 3.0 * (high - low), -2.0 * (high - low)].map(|term| sign * term),
            },
            Regime::Kinetic(sign) => Cubic { from: 0.0, rate: 0.0, terms: [sign * high, 0.0, 0.0, 0.0] },
            Regime::Sticking => Cubic::default(),
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
