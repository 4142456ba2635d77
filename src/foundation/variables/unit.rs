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

/// Common units, each with its SI unit, a factor and a divisor. With two numbers the conversion has only one rounding.
pub const COMMON: [(&str, Unit, f64, f64); 23] = [
    ("mm", Unit::Metre, 1.0, 1e3),
    ("cm", Unit::Metre, 1.0, 1e2),
    ("mm2", Unit::SquareMetre, 1.0, 1e6),
    ("cm2", Unit::SquareMetre, 1.0, 1e4),
    ("cm3", Unit::CubicMetre, 1.0, 1e6),
    ("l", Unit::CubicMetre, 1.0, 1e3),
    ("l/min", Unit::CubicMetrePerSecond, 1.0, 6e4),
    ("mm/s", Unit::MetrePerSecond, 1.0, 1e3),
    ("rpm", Unit::RadianPerSecond, std::f64::consts::PI, 30.0),
    ("ms", Unit::Second, 1.0, 1e3),
    ("min", Unit::Second, 60.0, 1.0),
    ("g", Unit::Kilogram, 1.0, 1e3),
    ("t", Unit::Kilogram, 1e3, 1.0),
    ("kN", Unit::Newton, 1e3, 1.0),
    ("kN.m", Unit::NewtonMetre, 1e3, 1.0),
    ("N/mm", Unit::NewtonPerMetre, 1e3, 1.0),
    ("kN/m", Unit::NewtonPerMetre, 1e3, 1.0),
    ("kJ", Unit::Joule, 1e3, 1.0),
    ("kW", Unit::Watt, 1e3, 1.0),
    ("kPa", Unit::Pascal, 1e3, 1.0),
    ("bar", Unit::Pascal, 1e5, 1.0),
    ("MPa", Unit::Pascal, 1e6, 1.0),
    ("%", Unit::One, 1.0, 1e2),
];

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

    /// Common units of the same quantity: name, factor and divisor. The display unit, if there is one, comes first.
    pub fn others(self) -> impl Iterator<Item = (&'static str, f64, f64)> {
        let display = self.display().map(|(name, factor)| (name, 1.0, factor));
        let common = COMMON.iter().filter(move |(_, si, ..)| *si == self);
        display.into_iter().chain(common.map(|(name, _, by, over)| (*name, *by, *over)))
    }

    /// A number that is stated in the unit `stated`, in this unit. None if `stated` is no unit of the same quantity.
    pub fn convert(self, number: f64, stated: &str) -> Option<f64> {
        // kNm, kN.m and kN·m are one unit; m/s^2, m/s² and m/s2 too.
        let plain = |name: &str| -> String {
            let signs = name.chars().filter(|c| !".^\u{b7}".contains(*c));
            let digits = signs.map(|c| match c {
                '\u{b2}' => '2',
                '\u{b3}' => '3',
                c => c,
            });
            digits.collect::<String>().replace('\u{b0}', "deg")
        };
        let stated = plain(stated);
        let own = (self != Self::One && plain(self.name()) == stated).then_some(number);
        own.or_else(|| self.others().find(|(name, ..)| plain(name) == stated).map(|(_, by, over)| number * by / over))
    }

    /// The unit of the quantity with this name of a unit, and the number in this unit.
    pub fn of_quantity(number: f64, stated: &str) -> Option<(Self, f64)> {
        Self::ALL.into_iter().find_map(|unit| Some((unit, unit.convert(number, stated)?)))
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
