//! Allowed values of a number, with their text in messages.
use std::f64::consts::TAU;

/// Allowed values of a parameter, all finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// >= 0.
    NonNegative,
    /// > 0.
    Positive,
    /// A length > 0 whose square is finite and not 0.
    Length,
    /// A size >= 0 with a finite square.
    Size,
    /// A coordinate of any sign with a finite square.
    Coordinate,
    /// An angle that counts revolutions. The last digit of the largest angle is 1e-10 rad.
    Turn,
    /// > 0 and <= 1.
    Fraction,
    /// From 0 to 1.
    Unit,
    /// A part of a revolution: > 0 and <= 2 pi rad.
    Revolution,
    /// A pressure angle of teeth [rad], from a force along the motion to a force almost perpendicular to the motion.
    Pressure,
    /// An eccentricity of elliptic gears, from circles to wheels whose ratio changes by a factor of 361.
    Eccentricity,
    /// A polytropic exponent, from an isothermal change of state to one steeper than any adiabatic change.
    Polytropic,
    /// A relative tolerance. Below the range, rounding errors dominate; above the range, the error estimate is
    /// meaningless.
    Tolerance,
    /// A whole number >= 1 that a double represents exactly.
    Count,
    /// A small length, relative to the size of a mechanism.
    Snap,
    /// A step of Newmark's method [s]. In a shorter step, rounding errors of the positions exceed their change.
    Substep,
}

impl Range {
    /// Whether a finite value is in the range, and the range as text.
    fn rule(self, value: f64) -> (bool, &'static str) {
        match self {
            Self::Finite => (true, "a finite number"),
            Self::NonNegative => (value >= 0.0, "a finite number >= 0"),
            Self::Positive => (value > 0.0, "a finite number > 0"),
            Self::Length => ((1e-100..=1e100).contains(&value), "a length > 0, from 1e-100 m to 1e100 m"),
            Self::Size => ((0.0..=1e100).contains(&value), "a finite number >= 0 and <= 1e100"),
            Self::Coordinate => (value.abs() <= 1e100, "a number from -1e100 to 1e100"),
            Self::Turn => (value.abs() <= 1e6, "an angle from -1e6 rad to 1e6 rad"),
            Self::Fraction => (value > 0.0 && value <= 1.0, "a number > 0 and <= 1"),
            Self::Unit => ((0.0..=1.0).contains(&value), "a number from 0 to 1"),
            Self::Revolution => {
                (value > 0.0 && value <= TAU, "an angle > 0 and <= 6.283185307 rad, one full revolution")
            }
            Self::Pressure => ((0.0..=1.2).contains(&value), "an angle from 0 to 1.2 rad"),
            Self::Eccentricity => ((0.0..=0.9).contains(&value), "a number from 0 to 0.9"),
            Self::Polytropic => ((1.0..=2.0).contains(&value), "a number from 1 to 2"),
            Self::Tolerance => ((1e-14..=1e-1).contains(&value), "a number from 1e-14 to 1e-1"),
            Self::Count => ((1.0..=1e15).contains(&value) && value.fract() == 0.0, "a whole number from 1 to 1e15"),
            Self::Snap => ((0.0..=0.01).contains(&value), "from 0 to 0.01, relative to the size of the mechanism"),
            Self::Substep => (value >= 1e-9, "a finite number >= 1e-9"),
        }
    }

    /// Lower and upper bound of the range, if they exist. The lower bound of values > 0 is 0.
    pub fn bounds(self) -> [Option<f64>; 2] {
        match self {
            Self::Finite => [None, None],
            Self::NonNegative | Self::Positive => [Some(0.0), None],
            Self::Length | Self::Size => [Some(0.0), Some(1e100)],
            Self::Coordinate => [Some(-1e100), Some(1e100)],
            Self::Turn => [Some(-1e6), Some(1e6)],
            Self::Fraction | Self::Unit => [Some(0.0), Some(1.0)],
            Self::Revolution => [Some(0.0), Some(TAU)],
            Self::Pressure => [Some(0.0), Some(1.2)],
            Self::Eccentricity => [Some(0.0), Some(0.9)],
            Self::Polytropic => [Some(1.0), Some(2.0)],
            Self::Tolerance => [Some(1e-14), Some(1e-1)],
            Self::Count => [Some(1.0), Some(1e15)],
            Self::Snap => [Some(0.0), Some(0.01)],
            Self::Substep => [Some(1e-9), None],
        }
    }

    /// Whether the lower bound is outside the range.
    pub fn is_open(self) -> bool {
        matches!(self, Self::Positive | Self::Length | Self::Fraction | Self::Revolution)
    }

    /// Whether the value is in the range.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite() && self.rule(value).0
    }

    /// The range as text.
    pub fn text(self) -> String {
        self.rule(0.0).1.to_owned()
    }
}
