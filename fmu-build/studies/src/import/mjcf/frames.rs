//! Positions and rotations of MJCF's elements in space.
//!
//! In: an element, the frame of its parent. Out: its frame. Must not know: bodies and masses.
use super::Mjcf;
use crate::import::spatial::{Rotation, SAME, Vector, about, add, after, cross, dot, scaled, turned, unit};
use crate::import::xml::Element;
use anyhow::{Context, Result};

/// A position and a rotation in space.
pub(super) type Frame = (Vector, Rotation);

impl Mjcf {
    /// Position and rotation of an element in the frame of its parent.
    pub(super) fn frame(&self, node: &Element, (place, rotation): Frame) -> Result<Frame> {
        let own = node.fixed("pos")?.unwrap_or([0.0; 3]);
        let direction = |v: Vector, key: &str| {
            unit(v).with_context(|| {
                format!("{}: the vector of {key} is zero: write a vector whose length is not zero", node.at())
            })
        };
        let mut inner = SAME;
        if let Some(quat) = node.fixed("quat")? {
            inner = of_quaternion(quat);
        } else if let Some([x, y, z, angle]) = node.fixed("axisangle")? {
            inner = about(direction([x, y, z], "axisangle")?, self.angle(angle));
        } else if let Some(angles) = node.fixed::<3>("euler")? {
            for (letter, angle) in self.sequence.chars().zip(angles) {
                let axis = SAME["xyz".find(letter.to_ascii_lowercase()).unwrap_or_default()];
                let turn = about(axis, self.angle(angle));
                // Lower-case letters are rotations about the axes after the previous rotations.
                inner = if letter.is_ascii_lowercase() { after(&inner, &turn) } else { after(&turn, &inner) };
            }
        } else if let Some([a, b, c, d, e, f]) = node.fixed("xyaxes")? {
            let x = direction([a, b, c], "xyaxes")?;
            let y = direction(add([d, e, f], scaled(x, -dot(x, [d, e, f]))), "xyaxes")?;
            inner = [x, y, cross(x, y)];
        } else if let Some(z) = node.fixed("zaxis")? {
            inner = least_turn(direction(z, "zaxis")?);
        }
        Ok((add(place, turned(&rotation, own)), after(&rotation, &inner)))
    }
}

/// The rotation of a quaternion of any length.
pub(super) fn of_quaternion([w, x, y, z]: [f64; 4]) -> Rotation {
    let half = (x * x + y * y + z * z).sqrt();
    unit([x, y, z]).map_or(SAME, |axis| about(axis, 2.0 * half.atan2(w)))
}

/// The rotation with the smallest angle from z to a direction.
fn least_turn(z: Vector) -> Rotation {
    let axis = cross(SAME[2], z);
    let angle = dot(axis, axis).sqrt().atan2(z[2]);
    about(unit(axis).unwrap_or(SAME[0]), angle)
}

/// Frame and length of a shape between two ends.
pub(super) fn along(node: &Element, [ax, ay, az, bx, by, bz]: [f64; 6], frame: Frame) -> Result<(Frame, f64)> {
    let (a, b) = ([ax, ay, az], [bx, by, bz]);
    let between = add(a, scaled(b, -1.0));
    let direction = unit(between)
        .with_context(|| format!("{}: the two ends in fromto are at the same place: move one end", node.at()))?;
    let place = add(frame.0, turned(&frame.1, scaled(add(a, b), 0.5)));
    Ok(((place, after(&frame.1, &least_turn(direction))), dot(between, between).sqrt()))
}
