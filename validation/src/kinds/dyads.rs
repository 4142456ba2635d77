//! Pairs of bodies that close a loop, in closed form: circles and lines that meet.
use super::jet::{Jet, Vector};
use super::sketch::Miss;

/// Sine of the angle between two bodies below which they count as in one line: there a dyad reaches the end of its
/// travel, and by what moves it the motion cannot be told.
const FLAT: f64 = 0.05;

/// The point at the distances `r` from `a` and `s` from `b`: on the left of the line from a to b (side 1) or on its
/// right (side -1).
///
/// # Errors
/// The circles are apart or one is in the other; or they nearly touch.
pub fn circles(a: Vector, r: impl Into<Jet>, b: Vector, s: impl Into<Jet>, side: f64) -> Result<Vector, Miss> {
    let (r, s, apart) = (r.into(), s.into(), b - a);
    let square = apart.dot(apart);
    let along = 0.5 * (square + r.squared() - s.squared());
    // Along the line and across it, both times its length.
    let across = r.squared() * square - along.squared();
    if across.value() < 0.0 {
        return Err(Miss::Apart);
    }
    // across = (r s sin(angle between the rods))^2
    if across.value() < (FLAT * r.value() * s.value()).powi(2) {
        return Err(Miss::Near);
    }
    let (along, across) = (along / square, across.sqrt() / square);
    Ok(a + along * apart + (side * across) * apart.left())
}

/// The point at the distance `r` from `a` on the line through `from` in the direction `axis`: the farther one along the
/// line (side 1) or the other (side -1).
///
/// # Errors
/// The line passes the circle, or nearly touches it.
pub fn line(a: Vector, r: f64, from: Vector, axis: Jet, side: f64) -> Result<Vector, Miss> {
    let (unit, apart) = (Vector::unit(axis), a - from);
    let (along, off) = (unit.dot(apart), unit.left().dot(apart));
    let square = Jet::from(r * r) - off.squared();
    if square.value() < 0.0 {
        return Err(Miss::Apart);
    }
    if square.value() < (FLAT * r).powi(2) {
        return Err(Miss::Near);
    }
    Ok(from + (along + side * square.sqrt()) * unit)
}

/// The point of a body that lies from `a` towards `b`, in that body's frame.
pub fn on(a: Vector, b: Vector, length: f64, local: [f64; 2]) -> Vector {
    a + (1.0 / length) * (b - a).frame(local)
}

/// The point at a distance from a fixed point in the direction of an angle.
pub fn arm(from: Vector, length: f64, angle: Jet) -> Vector {
    from + length * Vector::unit(angle)
}

/// A point that does not move.
pub fn fixed(x: f64, y: f64) -> Vector {
    Vector::fixed([x, y])
}
