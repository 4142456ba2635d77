//! One parameter: what it may be, what it changes, and its texts, which are made only when somebody reads them.
use crate::variables::Unit;

/// What a parameter may be; always finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// >= 0.
    NonNegative,
    /// > 0.
    Positive,
    /// A length: > 0, and so that its square is a number.
    Length,
    /// A coordinate: of any sign, and so that its square is a number.
    Coordinate,
    /// An angle that counts whole turns, and so few that its digits still tell the place in a turn.
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
/// Largest angle that counts turns [rad]: its last digit is 1e-10 rad.
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

/// What a parameter changes: the positions, the masses, the start or the integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The shape of the linkage.
    Geometry,
    /// Masses and moments of inertia.
    Inertia,
    /// The potential of a load.
    Load,
    /// The position at the start.
    StartPosition,
    /// The speed at the start.
    StartSpeed,
    /// The stretch of bodies as rods.
    Elasticity,
    /// The tolerance or the step of the integration.
    Tolerance,
}

/// What is known of a parameter besides its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter<'a> {
    /// Which number it is.
    pub(super) place: Place<'a>,
    /// What it is, without what it belongs to.
    pub(super) words: &'static str,
    /// Unit.
    pub unit: Unit,
    /// What it may be.
    pub range: Range,
    /// What it changes.
    pub role: Role,
}

/// Which number of the definition a parameter is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place<'a> {
    /// Of a section that there is once: `section.quantity`.
    Section { section: &'static str, quantity: &'static str },
    /// Of a named element, where the file has it under a `key` of its own.
    Element { group: &'static str, element: &'a str, quantity: &'static str, key: &'static str },
    /// Coordinate of a body's point.
    Point { body: &'a str, point: &'a str, axis: usize },
    /// Component of a constant force.
    Force { force: &'a str, axis: usize },
    /// A constant torque, on this body.
    Torque { torque: &'a str, on: &'a str },
    /// What states the start of this body or joint.
    Start { of: &'a str, quantity: &'static str },
}

const AXES: [&str; 2] = ["x", "y"];

impl Parameter<'_> {
    /// Variable name, `<body>.<quantity>`.
    pub fn name(&self) -> String {
        match self.place {
            Place::Section { section, quantity } => [section, ".", quantity].concat(),
            Place::Element { element, quantity, .. } => [element, ".", quantity].concat(),
            Place::Point { body, point, axis } => [body, ".", point, "_", AXES[axis]].concat(),
            Place::Force { force, axis } => [force, ".force_", AXES[axis]].concat(),
            Place::Torque { torque, .. } => format!("{torque}.torque"),
            Place::Start { of, quantity } => format!("{of}.start_{quantity}"),
        }
    }

    /// Path of the key in the file.
    pub fn key(&self) -> String {
        match self.place {
            Place::Section { section, quantity } => format!("{section}.{quantity}"),
            Place::Element { group, element, key, .. } => format!("{group}.{element}.{key}"),
            Place::Point { body, point, axis } => format!("bodies.{body}.points.{point}[{axis}]"),
            Place::Force { force, axis } => format!("forces.{force}.force[{axis}]"),
            Place::Torque { torque, .. } => format!("torques.{torque}.torque"),
            Place::Start { quantity, .. } => format!("start.{quantity}"),
        }
    }

    /// One line of text.
    pub fn description(&self) -> String {
        let words = self.words;
        match self.place {
            Place::Section { .. } => words.into(),
            Place::Element { element, .. } => [words, " of ", element].concat(),
            Place::Point { body, point, axis } => [words, " ", point, ", ", AXES[axis], ", of ", body].concat(),
            Place::Force { force, axis } => format!("{words} at {force}, {}, mechanism frame", AXES[axis]),
            Place::Torque { on, .. } => format!("{words} on {on}"),
            Place::Start { of, quantity } => format!("{words} {quantity} of {of}"),
        }
    }
}

/// What is known of a Boolean parameter besides its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flag<'a> {
    /// The section or element to which it belongs.
    pub(super) owner: &'a str,
    pub(super) quantity: &'static str,
    /// What it says, before and after the name of an element; of a section, all in the first.
    pub(super) words: [&'static str; 2],
}

impl Flag<'_> {
    /// Variable name.
    pub fn name(&self) -> String {
        format!("{}.{}", self.owner, self.quantity)
    }

    /// One line of text.
    pub fn description(&self) -> String {
        match self.words {
            [text, ""] => text.into(),
            [before, after] => format!("{before} {} {after}", self.owner),
        }
    }
}
