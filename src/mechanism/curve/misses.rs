//! Positions where branches of motion almost cross, as a curve keeps them.
use crate::mechanism::linkage::{Linkage, Point};
use crate::numerics::plane::Vec2;
use std::sync::Arc;

/// A position where the motion turns off, as the lengths almost let branches cross there.
#[derive(Clone, Debug, PartialEq)]
pub struct NearMiss {
    /// sigma on the curve.
    pub sigma: f64,
    /// Coordinates by name and in words.
    pub position: String,
    /// How much the loops lack of crossing, in sizes of the linkage.
    pub miss: f64,
}

/// Near misses of a curve, and what was done about those that are small.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Near {
    /// The linkage as it was drawn, where points of its joints were moved.
    pub drawn: Option<Arc<Linkage>>,
    /// Positions where branches cross with the moved points, with the misses of the drawn linkage.
    pub snapped: Vec<(String, f64)>,
    /// Points of the joints of the drawn linkage, with their moves [m].
    pub moves: Vec<(Point, Vec2)>,
    /// Misses too large to be put right.
    pub misses: Vec<NearMiss>,
}
