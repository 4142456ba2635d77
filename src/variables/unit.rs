//! Units of the variables, with what the XML must say of them.

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
    /// Area [m2].
    SquareMetre,
    /// Speed [m/s].
    MetrePerSecond,
    /// Acceleration [m/s2].
    MetrePerSecondSquared,
    /// Mass [kg].
    Kilogram,
    /// Moment of inertia [kg.m2].
    KilogramSquareMetre,
    /// Mass density [kg/m3].
    KilogramPerCubicMetre,
    /// Force [N].
    Newton,
    /// Torque [N.m].
    NewtonMetre,
    /// Energy [J].
    Joule,
    /// Stiffness [N/m].
    NewtonPerMetre,
    /// Damping [N.s/m].
    NewtonSecondPerMetre,
    /// Torsional stiffness [N.m/rad].
    NewtonMetrePerRadian,
    /// Torsional damping [N.m.s/rad].
    NewtonMetreSecondPerRadian,
    /// Change of mass with length [kg/m].
    KilogramPerMetre,
    /// Change of moment of inertia with angle [kg.m2/rad].
    KilogramSquareMetrePerRadian,
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
            Self::SquareMetre => "m2",
            Self::MetrePerSecond => "m/s",
            Self::MetrePerSecondSquared => "m/s2",
            Self::Kilogram => "kg",
            Self::KilogramSquareMetre => "kg.m2",
            Self::KilogramPerCubicMetre => "kg/m3",
            Self::Newton => "N",
            Self::NewtonMetre => "N.m",
            Self::Joule => "J",
            Self::NewtonPerMetre => "N/m",
            Self::NewtonSecondPerMetre => "N.s/m",
            Self::NewtonMetrePerRadian => "N.m/rad",
            Self::NewtonMetreSecondPerRadian => "N.m.s/rad",
            Self::KilogramPerMetre => "kg/m",
            Self::KilogramSquareMetrePerRadian => "kg.m2/rad",
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
            Self::SquareMetre => (0, 2, 0, 0),
            Self::MetrePerSecond => (0, 1, -1, 0),
            Self::MetrePerSecondSquared => (0, 1, -2, 0),
            Self::Kilogram => (1, 0, 0, 0),
            Self::KilogramSquareMetre => (1, 2, 0, 0),
            Self::KilogramPerCubicMetre => (1, -3, 0, 0),
            Self::Newton => (1, 1, -2, 0),
            Self::NewtonMetre | Self::Joule => (1, 2, -2, 0),
            Self::NewtonPerMetre => (1, 0, -2, 0),
            Self::NewtonSecondPerMetre => (1, 0, -1, 0),
            Self::NewtonMetrePerRadian => (1, 2, -2, -1),
            Self::NewtonMetreSecondPerRadian => (1, 2, -1, -1),
            Self::KilogramPerMetre => (1, -1, 0, 0),
            Self::KilogramSquareMetrePerRadian => (1, 2, 0, -1),
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
