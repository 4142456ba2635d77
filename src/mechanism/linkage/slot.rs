//! Curved slots: a pin of one body on a curve that is fixed in another body.
//!
//! In: the position along the curve and the rotation of the body with the curve. Out: the point of the curve with its
//! derivatives, as the loop equations and the tree read it. It must not know definitions, loads or time.
//!
//! The position s is a coordinate. The pin is at c(s) from the first point of the joint, in axes that turn with the
//! first body, so that it has no force along the curve and no moment.
use crate::numerics::plane::{Vec2, rotated};
use crate::numerics::track::Track;

/// A curved slot.
#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    /// Index of its joint.
    pub joint: usize,
    /// Index of the coordinate that is the position s along the curve [m].
    pub coordinate: usize,
    /// The curve, from the first point of the joint.
    pub track: Track,
    /// Angle of the axes of the curve in the frame of the first body [rad].
    pub angle: f64,
    /// Cosine and sine of this angle.
    pub(super) turn: (f64, f64),
}

/// A slot at a position, in the mechanism frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Along {
    /// Position along the curve [m].
    pub position: f64,
    /// From the first point of the joint to the point of the curve [m].
    pub out: Vec2,
    /// Unit tangent, towards larger positions.
    pub axis: Vec2,
    /// Curvature vector [1/m].
    pub bend: Vec2,
}

impl Slot {
    /// Point of the curve in the frame of the first body, from the first point of the joint, with the tangent and the
    /// curvature vector.
    pub(super) fn local(&self, s: f64) -> [Vec2; 3] {
        self.track.at(s).map(|v| rotated(self.turn, v))
    }

    /// The slot at a position, where its body has this rotation.
    pub(super) fn along(&self, s: f64, rotation: (f64, f64)) -> Along {
        let [out, axis, bend] = self.local(s).map(|v| rotated(rotation, v));
        Along { position: s, out, axis, bend }
    }
}
