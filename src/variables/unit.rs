//! Units of the variables, with their properties in the XML.

/// Unit of a Real. The table in [`Unit::row`] states the quantity of each unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Unit {
    #[default]
    One,
    Radian,
    RadianPerSecond,
    RadianPerSecondSquared,
    Second,
    Metre,
    SquareMetre,
    MetrePerSecond,
    MetrePerSecondSquared,
    Kilogram,
    KilogramSquareMetre,
    KilogramPerCubicMetre,
    Newton,
    NewtonMetre,
    Joule,
    NewtonPerMetre,
    NewtonSecondPerMetre,
    NewtonMetrePerRadian,
    NewtonMetreSecondPerRadian,
    KilogramPerMetre,
    KilogramSquareMetrePerRadian,
    PerSecond,
    Hertz,
    Pascal,
    CubicMetre,
    CubicMetrePerSecond,
    CubicMetrePerSecondPascal,
    Watt,
    NewtonPerSecond,
    NewtonMetrePerSecond,
    NewtonPerMetreSecond,
    NewtonMetrePerRadianSecond,
    NewtonSecond,
    KilogramSquareMetrePerSecond,
}

impl Unit {
    /// All units.
    pub const ALL: [Self; 34] = [
        Self::One,
        Self::Radian,
        Self::RadianPerSecond,
        Self::RadianPerSecondSquared,
        Self::Second,
        Self::Metre,
        Self::SquareMetre,
        Self::MetrePerSecond,
        Self::MetrePerSecondSquared,
        Self::Kilogram,
        Self::KilogramSquareMetre,
        Self::KilogramPerCubicMetre,
        Self::Newton,
        Self::NewtonMetre,
        Self::Joule,
        Self::NewtonPerMetre,
        Self::NewtonSecondPerMetre,
        Self::NewtonMetrePerRadian,
        Self::NewtonMetreSecondPerRadian,
        Self::KilogramPerMetre,
        Self::KilogramSquareMetrePerRadian,
        Self::PerSecond,
        Self::Hertz,
        Self::Pascal,
        Self::CubicMetre,
        Self::CubicMetrePerSecond,
        Self::CubicMetrePerSecondPascal,
        Self::Watt,
        Self::NewtonPerSecond,
        Self::NewtonMetrePerSecond,
        Self::NewtonPerMetreSecond,
        Self::NewtonMetrePerRadianSecond,
        Self::NewtonSecond,
        Self::KilogramSquareMetrePerSecond,
    ];

    /// Name, and exponents of kg, m, s and rad.
    const fn row(self) -> (&'static str, [i8; 4]) {
        match self {
            Self::One => ("1", [0, 0, 0, 0]),                                  // dimensionless
            Self::Radian => ("rad", [0, 0, 0, 1]),                             // angle
            Self::RadianPerSecond => ("rad/s", [0, 0, -1, 1]),                 // angular speed
            Self::RadianPerSecondSquared => ("rad/s2", [0, 0, -2, 1]),         // angular acceleration
            Self::Second => ("s", [0, 0, 1, 0]),                               // time
            Self::Metre => ("m", [0, 1, 0, 0]),                                // length
            Self::SquareMetre => ("m2", [0, 2, 0, 0]),                         // area
            Self::MetrePerSecond => ("m/s", [0, 1, -1, 0]),                    // speed
            Self::MetrePerSecondSquared => ("m/s2", [0, 1, -2, 0]),            // acceleration
            Self::Kilogram => ("kg", [1, 0, 0, 0]),                            // mass
            Self::KilogramSquareMetre => ("kg.m2", [1, 2, 0, 0]),              // moment of inertia
            Self::KilogramPerCubicMetre => ("kg/m3", [1, -3, 0, 0]),           // mass density
            Self::Newton => ("N", [1, 1, -2, 0]),                              // force
            Self::NewtonMetre => ("N.m", [1, 2, -2, 0]),                       // torque
            Self::Joule => ("J", [1, 2, -2, 0]),                               // energy
            Self::NewtonPerMetre => ("N/m", [1, 0, -2, 0]),                    // stiffness
            Self::NewtonSecondPerMetre => ("N.s/m", [1, 0, -1, 0]),            // damping
            Self::NewtonMetrePerRadian => ("N.m/rad", [1, 2, -2, -1]),         // torsional stiffness
            Self::NewtonMetreSecondPerRadian => ("N.m.s/rad", [1, 2, -1, -1]), // torsional damping
            Self::KilogramPerMetre => ("kg/m", [1, -1, 0, 0]),                 // change of mass with length
            // change of moment of inertia with angle
            Self::KilogramSquareMetrePerRadian => ("kg.m2/rad", [1, 2, 0, -1]),
            Self::PerSecond => ("1/s", [0, 0, -1, 0]), // rate of a ratio
            Self::Hertz => ("Hz", [0, 0, -1, 0]),      // frequency
            Self::Pascal => ("Pa", [1, -1, -2, 0]),    // pressure
            Self::CubicMetre => ("m3", [0, 3, 0, 0]),  // volume
            Self::CubicMetrePerSecond => ("m3/s", [0, 3, -1, 0]), // flow
            Self::CubicMetrePerSecondPascal => ("m3/(s.Pa)", [-1, 4, 1, 0]), // flow per pressure
            Self::Watt => ("W", [1, 2, -3, 0]),        // power
            Self::NewtonPerSecond => ("N/s", [1, 1, -3, 0]), // rate of a force
            Self::NewtonMetrePerSecond => ("N.m/s", [1, 2, -3, 0]), // rate of a torque
            Self::NewtonPerMetreSecond => ("N/(m.s)", [1, 0, -3, 0]), // integral gain
            Self::NewtonMetrePerRadianSecond => ("N.m/(rad.s)", [1, 2, -3, -1]), // integral gain of a torque
            Self::NewtonSecond => ("N.s", [1, 1, -1, 0]), // impulse
            Self::KilogramSquareMetrePerSecond => ("kg.m2/s", [1, 2, -1, 0]), // angular impulse
        }
    }

    /// Name in the XML, such as `N.m`.
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// Exponents of the SI base units that mechanics uses.
    pub fn base(self) -> [(&'static str, i8); 4] {
        let [kg, m, s, rad] = self.row().1;
        [("kg", kg), ("m", m), ("s", s), ("rad", rad)]
    }

    /// Display unit, if there is one: name and factor. Value in the display unit = factor * value.
    pub fn display(self) -> Option<(&'static str, f64)> {
        let name = match self {
            Self::Radian => "deg",
            Self::RadianPerSecond => "deg/s",
            Self::RadianPerSecondSquared => "deg/s2",
            _ => return None,
        };
        Some((name, 180.0 / std::f64::consts::PI))
    }
}
