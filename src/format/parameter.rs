//! One parameter of a definition: its range, its role in the model, and its texts, which are put together when somebody
//! reads them.
use super::error::DefinitionError;
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
    /// A length: > 0, with a finite square.
    Length,
    /// A coordinate: of any sign, with a finite square.
    Coordinate,
    /// An angle that counts revolutions and still resolves the angle within one revolution.
    Turn,
    /// > 0 and <= 1.
    Fraction,
    /// From 0 to 1.
    Unit,
    /// From the first to the second.
    Between(f64, f64),
}

/// Largest length [m].
const FARTHEST: f64 = 1e100;
/// Largest angle that counts revolutions [rad]: its last digit is 1e-10 rad.
const MOST_TURNED: f64 = 1e6;

impl Range {
    /// Whether the value is in the range.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::NonNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::Length => value > 0.0 && value <= FARTHEST,
                Self::Coordinate => value.abs() <= FARTHEST,
                Self::Turn => value.abs() <= MOST_TURNED,
                Self::Fraction => value > 0.0 && value <= 1.0,
                Self::Unit => (0.0..=1.0).contains(&value),
                Self::Between(low, high) => (low..=high).contains(&value),
            }
    }

    /// Check the value of a key.
    ///
    /// # Errors
    /// The value is out of the range.
    pub fn check(self, key: impl fmt::Display, value: f64) -> Result<(), DefinitionError> {
        if self.contains(value) { Ok(()) } else { Err(DefinitionError::value(key, Decimal(value), self.text())) }
    }

    /// The range in words.
    pub fn text(self) -> String {
        match self {
            Self::Finite => "a finite number".into(),
            Self::NonNegative => "a finite number >= 0".into(),
            Self::Positive => "a finite number > 0".into(),
            Self::Length => format!("a number > 0 and <= {FARTHEST:e}"),
            Self::Coordinate => format!("a number from -{FARTHEST:e} to {FARTHEST:e}"),
            Self::Turn => format!("an angle from -{MOST_TURNED:e} to {MOST_TURNED:e} rad"),
            Self::Fraction => "a number > 0 and <= 1".into(),
            Self::Unit => "a number from 0 to 1".into(),
            Self::Between(low, high) => format!("a number from {low:e} to {high:e}"),
        }
    }
}

/// A text in pieces: a visit of all parameters allocates nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Text<'a>([&'a str; 7]);

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
    name: Text<'a>,
    key: Text<'a>,
    description: Text<'a>,
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

    /// Variable name, such as `crank.length`.
    pub fn name(&self) -> String {
        self.name.0.concat()
    }

    /// Path of the key in the file, such as `bodies.crank.length`.
    pub fn key(&self) -> String {
        self.key.0.concat()
    }

    /// One line of text.
    pub fn description(&self) -> String {
        self.description.0.concat()
    }
}

/// A Boolean parameter without its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flag<'a> {
    name: Text<'a>,
    description: Text<'a>,
}

impl<'a> Flag<'a> {
    /// Flag of a section or element.
    pub fn new<const D: usize>(owner: &'a str, quantity: &'a str, description: [&'a str; D]) -> Self {
        Self { name: [owner, ".", quantity].into(), description: description.into() }
    }

    /// Variable name, such as `friction.enabled`.
    pub fn name(&self) -> String {
        self.name.0.concat()
    }

    /// One line of text.
    pub fn description(&self) -> String {
        self.description.0.concat()
    }
}

/// Section that there is once, or named element of a group, which lists its parameters for a visitor.
pub struct Owner<'a, 'v, R> {
    /// Of an element only.
    group: Option<&'static str>,
    name: &'a str,
    /// Role of the parameters that are listed next.
    pub role: R,
    visit: &'v mut dyn FnMut(Parameter<R>, &mut f64),
}

impl<'a, 'v, R: Copy> Owner<'a, 'v, R> {
    /// Section that there is once.
    pub fn section(name: &'static str, role: R, visit: &'v mut dyn FnMut(Parameter<R>, &mut f64)) -> Self {
        Self { group: None, name, role, visit }
    }

    /// Named element of a group.
    pub fn element(
        group: &'static str,
        name: &'a str,
        role: R,
        visit: &'v mut dyn FnMut(Parameter<R>, &mut f64),
    ) -> Self {
        Self { group: Some(group), name, role, visit }
    }

    /// Visit the parameter `owner.quantity`, if it has a value; `words`: its description, without the owner's name.
    pub fn add<'x>(
        &mut self,
        quantity: &'static str,
        words: &'static str,
        unit: Unit,
        range: Range,
        value: impl Into<Option<&'x mut f64>>,
    ) {
        self.add_component(quantity, quantity, words, (unit, range), value);
    }

    /// [`Self::add`] for a parameter with a key of its own, such as `center[0]`.
    pub fn add_component<'x>(
        &mut self,
        quantity: &'static str,
        key: &'static str,
        words: &'static str,
        (unit, range): (Unit, Range),
        value: impl Into<Option<&'x mut f64>>,
    ) {
        let Some(value) = value.into() else { return };
        let (name, kind) = ([self.name, ".", quantity], (unit, range, self.role));
        let parameter = match self.group {
            Some(group) => Parameter::new(name, [group, ".", self.name, ".", key], [words, " of ", self.name], kind),
            None => Parameter::new(name, [self.name, ".", key], [words], kind),
        };
        (self.visit)(parameter, value);
    }
}
