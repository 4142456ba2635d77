//! One parameter of a definition: its range, its role in the model, and its texts, which are put together when somebody
//! reads them.
use super::DefinitionError;
use crate::numerics::decimal::Decimal;
use crate::variables::Unit;
use std::fmt;

/// Values that a parameter may have; all finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// >= 0.
    NonNegative,
    /// > 0.
    Positive,
    /// A length: > 0, with a square that is neither infinite nor 0.
    Length,
    /// A size >= 0 with a finite square.
    Size,
    /// A coordinate: of any sign, with a finite square.
    Coordinate,
    /// An angle that counts revolutions; the last digit of the largest is 1e-10 rad.
    Turn,
    /// > 0 and <= 1.
    Fraction,
    /// From 0 to 1.
    Unit,
    /// A pressure angle of teeth [rad]: from teeth that push along the motion to some that would hardly move anything.
    Pressure,
    /// An eccentricity of elliptic gears: from circles to wheels whose ratio changes by the factor 361.
    Eccentricity,
    /// A polytropic exponent: from an isothermal change of state to one steeper than any adiabatic one.
    Polytropic,
    /// A relative tolerance: below, rounding takes over; above, the error estimate means nothing.
    Tolerance,
    /// A whole number >= 1 that counts without rounding.
    Count,
    /// A step of Newmark's method [s]: in a shorter one, rounding of the positions outweighs their change.
    Substep,
}

impl Range {
    /// Whether a finite value is in the range, and the range in words.
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
            Self::Pressure => ((0.0..=1.2).contains(&value), "an angle from 0 to 1.2 rad"),
            Self::Eccentricity => ((0.0..=0.9).contains(&value), "a number from 0 to 0.9"),
            Self::Polytropic => ((1.0..=2.0).contains(&value), "a number from 1 to 2"),
            Self::Tolerance => ((1e-14..=1e-1).contains(&value), "a number from 1e-14 to 1e-1"),
            Self::Count => ((1.0..=1e15).contains(&value) && value.fract() == 0.0, "a whole number from 1 to 1e15"),
            Self::Substep => (value >= 1e-9, "a finite number >= 1e-9"),
        }
    }

    /// Least and largest number of the range, where there are such; what must be > 0 is bounded by 0.
    pub fn bounds(self) -> [Option<f64>; 2] {
        match self {
            Self::Finite => [None, None],
            Self::NonNegative | Self::Positive => [Some(0.0), None],
            Self::Length | Self::Size => [Some(0.0), Some(1e100)],
            Self::Coordinate => [Some(-1e100), Some(1e100)],
            Self::Turn => [Some(-1e6), Some(1e6)],
            Self::Fraction | Self::Unit => [Some(0.0), Some(1.0)],
            Self::Pressure => [Some(0.0), Some(1.2)],
            Self::Eccentricity => [Some(0.0), Some(0.9)],
            Self::Polytropic => [Some(1.0), Some(2.0)],
            Self::Tolerance => [Some(1e-14), Some(1e-1)],
            Self::Count => [Some(1.0), Some(1e15)],
            Self::Substep => [Some(1e-9), None],
        }
    }

    /// Whether the value is in the range.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite() && self.rule(value).0
    }

    /// Check the value of a key.
    ///
    /// # Errors
    /// The value is out of the range.
    pub fn check(self, key: impl fmt::Display, value: f64) -> Result<(), DefinitionError> {
        if self.contains(value) { Ok(()) } else { Err(DefinitionError::value(key, Decimal(value), self.text())) }
    }

    /// Check the value of a key in this unit.
    ///
    /// # Errors
    /// The value is out of the range.
    pub fn check_in(self, unit: Unit, key: impl fmt::Display, value: f64) -> Result<(), DefinitionError> {
        if self.contains(value) {
            return Ok(());
        }
        let name = if unit == Unit::One { String::new() } else { format!(" {}", unit.name()) };
        let allowed = match (self, unit) {
            // A file may state lengths and angles in another unit.
            (Self::Coordinate, Unit::Metre | Unit::Radian) => format!("a number from -1e100{name} to 1e100{name}"),
            _ => self.text(),
        };
        Err(DefinitionError::value(key, format_args!("{}{name}", Decimal(value)), allowed))
    }

    /// The range in words.
    pub fn text(self) -> String {
        self.rule(0.0).1.to_owned()
    }
}

/// A text in pieces: a visit of all parameters allocates nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Text<'a>([&'a str; 7]);

impl Text<'_> {
    /// The whole text.
    pub fn concat(&self) -> String {
        self.0.concat()
    }
}

impl<'a, const N: usize> From<[&'a str; N]> for Text<'a> {
    fn from(pieces: [&'a str; N]) -> Self {
        const { assert!(N <= 7) };
        let mut all = [""; 7];
        all[..N].copy_from_slice(&pieces);
        Self(all)
    }
}

/// A numeric parameter without its value; `R`: the type of its role in the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter<'a, R> {
    /// Variable name, such as `crank.length`.
    pub name: Text<'a>,
    /// Path of the key in the file, such as `bodies.crank.length`.
    pub key: Text<'a>,
    /// One line of text.
    pub description: Text<'a>,
    /// Unit.
    pub unit: Unit,
    /// Values that it may have.
    pub range: Range,
    /// What it changes in the model.
    pub role: R,
}

impl<'a, R> Parameter<'a, R> {
    /// Parameter with this variable name, path of the key in the file, and description.
    pub fn new<const N: usize, const K: usize, const D: usize>(
        name: [&'a str; N],
        key: [&'a str; K],
        description: [&'a str; D],
        (unit, range, role): (Unit, Range, R),
    ) -> Self {
        Self { name: name.into(), key: key.into(), description: description.into(), unit, range, role }
    }

    /// The same parameter with another role.
    pub fn with<S>(self, role: S) -> Parameter<'a, S> {
        let Self { name, key, description, unit, range, .. } = self;
        Parameter { name, key, description, unit, range, role }
    }
}

/// A Boolean parameter without its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flag<'a> {
    /// Variable name, such as `friction.enabled`.
    pub name: Text<'a>,
    /// One line of text.
    pub description: Text<'a>,
}

impl<'a> Flag<'a> {
    /// Flag of a section or element.
    pub fn new<const D: usize>(owner: &'a str, quantity: &'a str, description: [&'a str; D]) -> Self {
        Self { name: [owner, ".", quantity].into(), description: description.into() }
    }
}

/// Section that there is once, or named element of a group, which lists its parameters for a visitor.
pub struct Owner<'a, 'v, R> {
    /// Of an element only.
    group: Option<&'static str>,
    name: &'a str,
    /// Role of the parameters that are listed next.
    pub role: R,
    /// Called with each parameter and its value.
    pub visit: &'v mut dyn FnMut(Parameter<R>, &mut f64),
}

impl<'a, 'v, R: Copy> Owner<'a, 'v, R> {
    /// Section that there is once; or named element of a group.
    pub fn new(
        group: Option<&'static str>,
        name: &'a str,
        role: R,
        visit: &'v mut dyn FnMut(Parameter<R>, &mut f64),
    ) -> Self {
        Self { group, name, role, visit }
    }

    /// Visit the parameter `owner.quantity`, if it has a value; `words`: its description, without the owner's name.
    #[inline]
    pub fn add<'x>(
        &mut self,
        quantity: &'static str,
        words: &'static str,
        unit: Unit,
        range: Range,
        value: impl Into<Option<&'x mut f64>>,
    ) {
        if let Some(value) = value.into() {
            self.list(quantity, words, unit, range, value);
        }
    }

    /// One copy of this for all that is added.
    #[inline(never)]
    fn list(&mut self, quantity: &'static str, words: &'static str, unit: Unit, range: Range, value: &mut f64) {
        let (name, kind) = ([self.name, ".", quantity], (unit, range, self.role));
        let parameter = match self.group {
            Some(group) => {
                Parameter::new(name, [group, ".", self.name, ".", quantity], [words, " of ", self.name], kind)
            }
            None => Parameter::new(name, name, [words], kind),
        };
        (self.visit)(parameter, value);
    }
}
