//! Values with their first and second derivative by one parameter, and points of the plane made of them.
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value, its derivative and its second derivative by the parameter of a closed form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet(pub [f64; 3]);

impl Jet {
    /// The parameter itself.
    pub fn variable(value: f64) -> Self {
        Self([value, 1.0, 0.0])
    }

    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self([value, 0.0, 0.0])
    }

    /// Value.
    pub fn value(self) -> f64 {
        self.0[0]
    }

    /// Derivative.
    pub fn slope(self) -> f64 {
        self.0[1]
    }

    /// Second derivative.
    pub fn bend(self) -> f64 {
        self.0[2]
    }

    /// A function of this, from its value and its two derivatives.
    fn chain(self, [f, df, ddf]: [f64; 3]) -> Self {
        let [_, d, dd] = self.0;
        Self([f, df * d, df * dd + ddf * d * d])
    }

    /// Square root; of a value > 0.
    pub fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain([root, 0.5 / root, -0.25 / (root * self.value())])
    }

    /// Sine.
    pub fn sin(self) -> Self {
        let (sin, cos) = self.value().sin_cos();
        self.chain([sin, cos, -sin])
    }

    /// Cosine.
    pub fn cos(self) -> Self {
        let (sin, cos) = self.value().sin_cos();
        self.chain([cos, -sin, -cos])
    }

    /// Square.
    pub fn squared(self) -> Self {
        self * self
    }

    /// Angle of the vector (x, y), this being y.
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
        Self::constant(value)
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, Self([d, e, f]): Self) -> Self {
        let [a, b, c] = self.0;
        Self([a + d, b + e, c + f])
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, Self([d, e, f]): Self) -> Self {
        let [a, b, c] = self.0;
        Self([a * d, a * e + b * d, a * f + 2.0 * b * e + c * d])
    }
}

impl Div for Jet {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let x = 1.0 / other.value();
        self * other.chain([x, -x * x, 2.0 * x * x * x])
    }
}

impl Mul<Jet> for f64 {
    type Output = Jet;
    fn mul(self, jet: Jet) -> Jet {
        Jet(jet.0.map(|x| self * x))
    }
}

/// A point or a vector.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vector {
    pub x: Jet,
    pub y: Jet,
}

impl Vector {
    /// A fixed one.
    pub fn fixed([x, y]: [f64; 2]) -> Self {
        Self { x: x.into(), y: y.into() }
    }

    /// The unit vector in the direction of an angle.
    pub fn unit(angle: Jet) -> Self {
        Self { x: angle.cos(), y: angle.sin() }
    }

    /// Turned by a quarter to the left.
    pub fn left(self) -> Self {
        Self { x: -self.y, y: self.x }
    }

    /// Scalar product.
    pub fn dot(self, other: Self) -> Jet {
        self.x * other.x + self.y * other.y
    }

    /// Length; of a vector that is not 0.
    pub fn norm(self) -> Jet {
        self.dot(self).sqrt()
    }

    /// Angle from the X axis.
    pub fn angle(self) -> Jet {
        self.y.atan2(self.x)
    }

    /// A vector given in a frame of which this is the unit vector along x.
    pub fn frame(self, [x, y]: [f64; 2]) -> Self {
        x * self + y * self.left()
    }
}

impl Add for Vector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }
}

impl Neg for Vector {
    type Output = Self;
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
}

impl Sub for Vector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul<Vector> for Jet {
    type Output = Vector;
    fn mul(self, vector: Vector) -> Vector {
        Vector { x: self * vector.x, y: self * vector.y }
    }
}

impl Mul<Vector> for f64 {
    type Output = Vector;
    fn mul(self, vector: Vector) -> Vector {
        Vector { x: self * vector.x, y: self * vector.y }
    }
}
