//! Values with their first and second derivative with respect to one parameter, and points in the plane with such
//! components as complex numbers, whose product rotates and scales.
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value, its derivative and its second derivative with respect to the parameter of a closed form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet(pub [f64; 3]);

impl Jet {
    /// The parameter itself.
    pub fn variable(value: f64) -> Self {
        Self([value, 1.0, 0.0])
    }

    pub fn value(self) -> f64 {
        self.0[0]
    }

    pub fn slope(self) -> f64 {
        self.0[1]
    }

    /// Second derivative.
    pub fn bend(self) -> f64 {
        self.0[2]
    }

    /// A function of this value, from the function's value and its two derivatives.
    fn chain(self, [f, df, ddf]: [f64; 3]) -> Self {
        let [_, d, dd] = self.0;
        Self([f, df * d, df * dd + ddf * d * d])
    }

    /// Square root of a value > 0.
    pub fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain([root, 0.5 / root, -0.25 / (root * self.value())])
    }

    pub fn sin(self) -> Self {
        let (sin, cos) = self.value().sin_cos();
        self.chain([sin, cos, -sin])
    }

    pub fn cos(self) -> Self {
        let (sin, cos) = self.value().sin_cos();
        self.chain([cos, -sin, -cos])
    }

    pub fn tan(self) -> Self {
        let tan = self.value().tan();
        let slope = 1.0 + tan * tan;
        self.chain([tan, slope, 2.0 * tan * slope])
    }

    pub fn squared(self) -> Self {
        self * self
    }

    /// Angle of the vector (x, y), where `self` is y.
    pub fn atan2(self, x: Self) -> Self {
        // d(angle) = (x dy - y dx) / r^2; the derivative of that quotient gives the second.
        let ([y, dy, ddy], [x, dx, ddx]) = (self.0, x.0);
        let square = x * x + y * y;
        let slope = (x * dy - y * dx) / square;
        Self([y.atan2(x), slope, (x * ddy - y * ddx - 2.0 * (x * dx + y * dy) * slope) / square])
    }
}

impl From<f64> for Jet {
    fn from(value: f64) -> Self {
        Self([value, 0.0, 0.0])
    }
}

/// A point or a vector; a real number if y is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vector {
    pub x: Jet,
    pub y: Jet,
}

impl Vector {
    /// A constant vector.
    pub fn fixed([x, y]: [f64; 2]) -> Self {
        Self { x: x.into(), y: y.into() }
    }

    /// The unit vector in the direction of an angle.
    pub fn unit(angle: Jet) -> Self {
        Self { x: angle.cos(), y: angle.sin() }
    }

    /// The vector rotated by a quarter turn to the left.
    pub fn left(self) -> Self {
        Self { x: -self.y, y: self.x }
    }

    /// Scalar product.
    pub fn dot(self, other: Self) -> Jet {
        self.x * other.x + self.y * other.y
    }

    /// Length of a vector that is not 0.
    pub fn norm(self) -> Jet {
        self.dot(self).sqrt()
    }

    /// The values without derivatives.
    pub fn place(self) -> [f64; 2] {
        [self.x.value(), self.y.value()]
    }

    /// Angle from the X axis.
    pub fn angle(self) -> Jet {
        self.y.atan2(self.x)
    }
}

impl From<Jet> for Vector {
    fn from(x: Jet) -> Self {
        Self { x, y: Jet::default() }
    }
}

/// A binary operator between two types.
macro_rules! operator {
    ($(
        $own:ident $operator:ident $function:ident $other:ident -> $out:ident: $a:ident, $b:ident => $value:expr;
    )*) => {$(
        impl $operator<$other> for $own {
            type Output = $out;

            fn $function(self, other: $other) -> $out {
                let ($a, $b) = (self, other);
                $value
            }
        }
    )*};
}

operator! {
    Jet Add add Jet -> Jet: a, b => Jet([a.0[0] + b.0[0], a.0[1] + b.0[1], a.0[2] + b.0[2]]);
    Jet Sub sub Jet -> Jet: a, b => a + -b;
    Jet Mul mul Jet -> Jet: a, b => {
        let ([a, b, c], [d, e, f]) = (a.0, b.0);
        Jet([a * d, a * e + b * d, a * f + 2.0 * b * e + c * d])
    };
    Jet Div div Jet -> Jet: a, b => {
        let x = 1.0 / b.value();
        a * b.chain([x, -x * x, 2.0 * x * x * x])
    };
    f64 Mul mul Jet -> Jet: a, b => Jet(b.0.map(|x| a * x));
    Vector Add add Vector -> Vector: a, b => Vector { x: a.x + b.x, y: a.y + b.y };
    Vector Sub sub Vector -> Vector: a, b => a + -b;
    Vector Mul mul Vector -> Vector: a, b => Vector { x: a.x * b.x - a.y * b.y, y: a.x * b.y + a.y * b.x };
    Jet Mul mul Vector -> Vector: a, b => Vector { x: a * b.x, y: a * b.y };
    f64 Mul mul Vector -> Vector: a, b => Vector { x: a * b.x, y: a * b.y };
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Neg for Vector {
    type Output = Self;
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
}
