//! Vectors in the plane.
use nalgebra::Vector2;

/// A vector in the plane.
pub type Vec2 = Vector2<f64>;

/// Component of the cross product normal to the plane.
pub fn cross(a: Vec2, b: Vec2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// A vector turned by a right angle, anticlockwise.
pub fn perp(a: Vec2) -> Vec2 {
    Vec2::new(-a.y, a.x)
}

/// A vector turned by the angle with this cosine and sine.
pub fn rotated((cos, sin): (f64, f64), a: Vec2) -> Vec2 {
    Vec2::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y)
}

/// A vector turned by an angle [rad].
pub fn turned(a: Vec2, angle: f64) -> Vec2 {
    let (sin, cos) = angle.sin_cos();
    rotated((cos, sin), a)
}
