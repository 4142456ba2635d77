//! The table of variables: what a host can see and set.
//!
//! In: the definition's names, quantities and start values. Out: one list that drives get and set, the generated
//! `modelDescription.xml`, its units and its ModelStructure. A variable's value reference is its place in the list.
//! This room knows nothing of the FMI functions; the words causality, variability and initial are the standard's own.

/// Place of a variable in the table; the FMI value reference.
pub type Reference = u32;

/// Type of a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 64-bit floating-point number.
    Real,
    /// 32-bit signed integer.
    Integer,
    /// Truth value.
    Boolean,
    /// Text.
    String,
}

/// FMI 2.0.5, 2.2.7: who determines the value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Causality {
    /// Fixed by the host before the simulation; `initial` is exact.
    Parameter,
    /// Set by the host between steps; carries no `initial`.
    Input,
    /// Computed here; `initial` is calculated.
    Output,
}

/// FMI 2.0.5, 2.2.7: when the value may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variability {
    /// Constant once initialised.
    Fixed,
    /// Changes at communication points only.
    Discrete,
    /// Changes with time.
    Continuous,
}

/// A start value, of the variable's kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Value of a Real.
    Real(f64),
    /// Value of an Integer.
    Integer(i32),
    /// Value of a Boolean.
    Boolean(bool),
    /// Value of a String.
    String(String),
}

/// Unit of a Real.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unit {
    /// Dimensionless [1].
    One,
    /// Angle [rad].
    Radian,
    /// Angular speed [rad/s].
    RadianPerSecond,
    /// Angular acceleration [rad/s2].
    RadianPerSecondSquared,
    /// Length [m].
    Metre,
    /// Speed [m/s].
    MetrePerSecond,
    /// Acceleration [m/s2].
    MetrePerSecondSquared,
    /// Mass [kg].
    Kilogram,
    /// Moment of inertia [kg.m2].
    KilogramSquareMetre,
    /// Force [N].
    Newton,
    /// Torque [N.m].
    NewtonMetre,
    /// Energy [J].
    Joule,
}

/// Unit of a Real for display: value in the display unit = factor * value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayUnit {
    /// Name, such as `deg`.
    pub name: &'static str,
    /// Factor from the unit to the display unit.
    pub factor: f64,
}

/// Exponents of a unit in the SI base units that mechanics uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaseUnit {
    /// Exponent of the kilogram.
    pub kg: i8,
    /// Exponent of the metre.
    pub m: i8,
    /// Exponent of the second.
    pub s: i8,
    /// Exponent of the radian.
    pub rad: i8,
}

impl Unit {
    /// Name as it stands in the XML, such as `N.m`.
    pub fn name(self) -> &'static str {
        match self {
            Self::One => "1",
            Self::Radian => "rad",
            Self::RadianPerSecond => "rad/s",
            Self::RadianPerSecondSquared => "rad/s2",
            Self::Metre => "m",
            Self::MetrePerSecond => "m/s",
            Self::MetrePerSecondSquared => "m/s2",
            Self::Kilogram => "kg",
            Self::KilogramSquareMetre => "kg.m2",
            Self::Newton => "N",
            Self::NewtonMetre => "N.m",
            Self::Joule => "J",
        }
    }

    /// Exponents in base units.
    pub fn base(self) -> BaseUnit {
        let (kg, m, s, rad) = match self {
            Self::One => (0, 0, 0, 0),
            Self::Radian => (0, 0, 0, 1),
            Self::RadianPerSecond => (0, 0, -1, 1),
            Self::RadianPerSecondSquared => (0, 0, -2, 1),
            Self::Metre => (0, 1, 0, 0),
            Self::MetrePerSecond => (0, 1, -1, 0),
            Self::MetrePerSecondSquared => (0, 1, -2, 0),
            Self::Kilogram => (1, 0, 0, 0),
            Self::KilogramSquareMetre => (1, 2, 0, 0),
            Self::Newton => (1, 1, -2, 0),
            Self::NewtonMetre | Self::Joule => (1, 2, -2, 0),
        };
        BaseUnit { kg, m, s, rad }
    }

    /// Display unit, where one is worth having.
    pub fn display(self) -> Option<DisplayUnit> {
        let name = match self {
            Self::Radian => "deg",
            Self::RadianPerSecond => "deg/s",
            Self::RadianPerSecondSquared => "deg/s2",
            _ => return None,
        };
        Some(DisplayUnit { name, factor: 180.0 / std::f64::consts::PI })
    }
}

/// One variable of the interface.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Structured name, such as `crank.angle`.
    pub name: String,
    /// One line of text.
    pub description: String,
    /// Type of its value.
    pub kind: Kind,
    /// Who determines it.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Unit; only a Real has one.
    pub unit: Option<Unit>,
    /// Start value: of every parameter and input, of no output.
    pub start: Option<Value>,
    /// Outputs only: the inputs on which its present value depends, ascending.
    pub dependencies: Vec<Reference>,
    /// Outputs only: the inputs and parameters on which its initial value depends, ascending.
    pub initial_dependencies: Vec<Reference>,
}

/// The table of variables of one mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Variables {
    list: Vec<Variable>,
    guid: String,
}

impl Variables {
    /// All variables; the index is the value reference.
    pub fn list(&self) -> &[Variable] {
        &self.list
    }
    /// The variable with this reference, if there is one.
    pub fn get(&self, reference: Reference) -> Option<&Variable> {
        self.list.get(reference as usize)
    }
    /// Reference of the variable with this name.
    pub fn find(&self, name: &str) -> Option<Reference> {
        self.list.iter().position(|v| v.name == name).map(|i| i as Reference)
    }
    /// GUID of the interface: a hash over names, kinds, causalities, variabilities and units, not over start values.
    pub fn guid(&self) -> &str {
        &self.guid
    }
}
