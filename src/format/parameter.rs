//! One parameter of a definition: its range, its role in the model, and its texts. The texts are joined only when they
//! are read.
use super::fault::{DefinitionError, Fault, Faults};
use super::keys::{Key, Keyed, Kind, Slot};
use crate::variables::Unit;
use std::f64::consts::TAU;
use std::fmt;

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

    /// Checks the value of a key.
    ///
    /// # Errors
    /// The value is out of the range.
    pub fn check(self, key: impl fmt::Display, value: f64) -> Result<(), DefinitionError> {
        self.check_in(Unit::One, key, value)
    }

    /// Checks the value of a key in this unit.
    ///
    /// # Errors
    /// The value is out of the range.
    pub fn check_in(self, unit: Unit, key: impl fmt::Display, value: f64) -> Result<(), DefinitionError> {
        if self.contains(value) { Ok(()) } else { Err(self.refused(unit, &key, value)) }
    }

    #[cold]
    #[inline(never)]
    fn refused(self, unit: Unit, key: &dyn fmt::Display, value: f64) -> DefinitionError {
        DefinitionError::new(key.to_string(), Fault::Range(value, unit, self))
    }

    /// The range as text.
    pub fn text(self) -> String {
        self.rule(0.0).1.to_owned()
    }
}

/// A text in pieces, so that a visit of all parameters allocates no memory.
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

/// The part of a model that a parameter changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The shape of the linkage.
    Geometry,
    /// Masses and moments of inertia.
    Inertia,
    /// The potential or the law of a load.
    Load,
    /// A number in the law of a load, such as friction, air, drag or the restitution of a stop. Tunable between steps.
    Law,
    /// The position at the start.
    StartPosition,
    /// The speed at the start.
    StartSpeed,
    /// Elastic lengthening of bodies as rods.
    Elasticity,
    /// The tolerance or the largest number of steps of the integration. Tunable between steps.
    Tolerance,
    /// The step of the finite elements.
    Step,
    /// The reference of the relative errors of the integration.
    Scale,
    /// The laws of a hydraulic circuit.
    Circuit,
    /// The pressures or the states of controllers at the start.
    CircuitStart,
    /// Only the numbers whose expressions contain the parameter.
    Named,
}

impl Role {
    /// Whether a host may change a parameter with this role between two steps.
    pub fn is_tunable(self) -> bool {
        matches!(self, Self::Law | Self::Tolerance)
    }
}

/// Function that is called with each parameter and its value.
pub type Visit<'v> = dyn FnMut(Parameter<'_>, &mut f64) + 'v;

/// Name of a coordinate in variables, and its index in the file.
pub const AXES: [(&str, &str); 2] = [("x", "[0]"), ("y", "[1]")];

/// A numeric parameter without its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter<'a> {
    /// Variable name, such as `crank.length`.
    pub name: Text<'a>,
    /// Path of the key in the file, such as `bodies.crank.length`.
    pub key: Text<'a>,
    /// One line of text.
    pub description: Text<'a>,
    /// Unit.
    pub unit: Unit,
    /// Allowed values.
    pub range: Range,
    /// The part of the model that the parameter changes.
    pub role: Role,
}

impl<'a> Parameter<'a> {
    /// Parameter with this variable name, path of the key in the file, and description.
    pub fn new<const N: usize, const K: usize, const D: usize>(
        name: [&'a str; N],
        key: [&'a str; K],
        description: [&'a str; D],
        (unit, range, role): (Unit, Range, Role),
    ) -> Self {
        Self { name: name.into(), key: key.into(), description: description.into(), unit, range, role }
    }

    /// Adds a fault with the parameter's name if the value is out of range.
    pub fn check(&self, value: f64, faults: &mut Faults) {
        // Names are joined only for a message.
        if !self.range.contains(value) {
            faults.push(DefinitionError::new(self.name.concat(), Fault::Range(value, Unit::One, self.range)));
        }
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

/// Owner of parameters: a section that occurs once, or a named element of a group.
pub struct Owner<'a> {
    /// Group of a named element.
    pub group: Option<&'static str>,
    /// Name of the owner.
    pub name: &'a str,
    /// Whether the element is rotary, which determines some units.
    pub is_rotary: bool,
}

impl Owner<'_> {
    /// Visits the parameters among the keys of an object. `refine` may change or omit a key.
    pub fn parameters(&self, object: &mut dyn Keyed, refine: &dyn Fn(Key) -> Option<Key>, visit: &mut Visit) {
        self.inside("", object, refine, visit);
    }

    /// Visits the Boolean parameters among the keys of an object. Absent values are set to their defaults. In the
    /// description, @ stands for the owner's name.
    pub fn flags(&self, object: &mut dyn Keyed, visit: &mut dyn FnMut(Flag, &mut bool)) {
        for (index, key) in object.table().keys.iter().enumerate().filter(|(_, key)| key.role.is_some()) {
            let mut slot = object.slot(index);
            if let (Kind::Flag, Slot::Maybe(maybe)) = (key.kind, &mut slot)
                && maybe.get().is_none()
                && let Slot::Flag(value) = maybe.make()
            {
                *value = key.absent == "true";
            }
            let value = match slot {
                Slot::Maybe(maybe) => maybe.get(),
                slot => Some(slot),
            };
            if let Some(Slot::Flag(value)) = value {
                let (before, after) = key.words.split_once('@').unwrap_or((key.words, ""));
                let named = if after.is_empty() { "" } else { self.name };
                let name = [self.name, ".", key.name].into();
                visit(Flag { name, description: [before, named, after].into() }, value);
            }
        }
    }

    fn inside(&self, of: &str, object: &mut dyn Keyed, refine: &dyn Fn(Key) -> Option<Key>, visit: &mut Visit) {
        for (index, key) in object.table().keys.iter().enumerate() {
            if let Some(key) = refine(*key) {
                self.visit(of, &key, object.slot(index), refine, visit);
            }
        }
    }

    /// Visits the value of a key of the owner, or of the object `of` in the owner.
    fn visit(&self, of: &str, key: &Key, slot: Slot, refine: &dyn Fn(Key) -> Option<Key>, visit: &mut Visit) {
        match (slot, key.role) {
            (Slot::Maybe(maybe), _) => {
                if let Some(slot) = maybe.get() {
                    self.visit(of, key, slot, refine, visit);
                }
            }
            (Slot::Object(object), _) => self.inside(key.name, object, refine, visit),
            (Slot::Number(value), Some(role)) => {
                let (unit, dot) = (key.unit(self.is_rotary), if of.is_empty() { "" } else { "." });
                let (name, kind) = ([self.name, ".", of, dot, key.name], (unit, key.range, role));
                visit(
                    match self.group {
                        Some(group) => {
                            let path = [group, ".", self.name, ".", of, dot, key.name];
                            // In the description, @ stands for the element or for the object in it.
                            let words = match key.words.split_once('@') {
                                Some((before, after)) => [before, self.name, dot, of, after],
                                None => [key.words, " of ", self.name, "", ""],
                            };
                            Parameter::new(name, path, words, kind)
                        }
                        None => Parameter::new(name, name, [key.words], kind),
                    },
                    value,
                );
            }
            (Slot::Pair(pair), Some(role)) => {
                for ((axis, index), value) in AXES.into_iter().zip(pair) {
                    let path = [self.group.unwrap_or_default(), ".", self.name, ".", key.name, index];
                    let description = [key.words, " of ", self.name, ": ", axis, " coordinate in the body frame"];
                    let kind = (key.unit(self.is_rotary), key.range, role);
                    visit(Parameter::new([self.name, ".", key.name, "_", axis], path, description, kind), value);
                }
            }
            _ => {}
        }
    }
}
