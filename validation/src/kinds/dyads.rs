//! Pairs of bodies that close a loop, in closed form: intersections of circles and lines.
use super::jet::{Jet, Vector};
use super::sketch::Miss;

/// Sine of the angle between two bodies below which they count as collinear: there a dyad reaches the end of its
/// travel, and its motion is not determined by that of the driving body.
const FLAT: f64 = 0.05;

/// The point at the distances `r` from `a` and `s` from `b`: to the left of the line from a to b (side 1) or to its
/// right (side -1).
///
/// # Errors
/// The circles do not intersect, or are nearly tangent.
///
/// # Errors
/// The circles are apart or one is in the other; or they nearly touch.
pub fn circles(a: Vector, r: Jet, b: Vector, s: Jet, side: f64) -> Result<Vector, Miss> {
    let apart = b - a;
    let square = apart.dot(apart);
    let along = 0.5 * (square + r.squared() - s.squared());
    // Along the line and across it, both times its length: across = (r s sin(angle between the rods))^2.
    let across = clear(r.squared() * square - along.squared(), r.value() * s.value())?;
    let (along, across) = (along / square, across / square);
    Ok(a + along * apart + (side * across) * apart.left())
}

/// The point at the distance `r` from `a` on the line through `from` in the direction `axis`: the farther one along the
/// line (side 1) or the other (side -1).
///
/// # Errors
/// The line passes the circle, or nearly touches it.
pub fn line(a: Vector, r: Jet, from: Vector, axis: Jet, side: f64) -> Result<Vector, Miss> {
    let (unit, apart) = (Vector::unit(axis), a - from);
    let (along, off) = (unit.dot(apart), unit.left().dot(apart));
    Ok(from + (along + side * clear(r.squared() - off.squared(), r.value())?) * unit)
}

/// The root of a square that is large enough against a size.
fn clear(square: Jet, size: f64) -> Result<Jet, Miss> {
    match square.value() {
        value if value < 0.0 => Err(Miss::Apart),
        value if value < (FLAT * size).powi(2) => Err(Miss::Near),
        _ => Ok(square.sqrt()),
    }
}

/// The point `local` of a body whose frame has its origin at `a` and its x axis towards `b`, at the distance `length`.
pub fn on(a: Vector, b: Vector, length: f64, local: Vector) -> Vector {
    a + (1.0 / length) * ((b - a) * local)
}

/// The point at a distance from a point in the direction of an angle.
pub fn arm(from: Vector, length: f64, angle: Jet) -> Vector {
    from + length * Vector::unit(angle)
}

/// The point at a distance from `from` in the direction of `to`: the end of a lever with a slot, or of a barrel.
pub fn towards(from: Vector, to: Vector, length: Jet) -> Vector {
    let apart = to - from;
    from + (length / apart.norm()) * apart
}

/// A corner of a triangle over a side, on its left, from the lengths of its sides from both ends.
pub fn corner(side: f64, from: f64, to: f64) -> [f64; 2] {
    let x = 0.5 * (side * side + from * from - to * to) / side;
    [x, (from * from - x * x).sqrt()]
}
