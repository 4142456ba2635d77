//! Disc cams: motion law of the follower, with the checks that need no geometry.
use super::interpolation::Interpolation;
use super::refusal::refused;
use crate::format::{DefinitionError, Key, Range, either, keys, number, words};
use crate::numerics::decimal::Decimal;
use crate::numerics::periodic::{Periodic, Segment};
use crate::numerics::rise::Rise;
use crate::variables::Unit::{Metre, Radian};
use std::f64::consts::TAU;

/// Largest error of a sum of angles that is to be one revolution, and of lifts that are to be 0, relative to its size.
const CLOSE: f64 = 1e-9;
/// Least number of points of a table.
const FEWEST: usize = 3;

keys! {
    /// A segment states the lift over a part of one revolution of a cam. The follower is at rest at both ends of the
    /// segment.
    pub struct CamSegment: Copy {
        /// Motion law of the lift over the segment. `dwell`: the lift is constant.
        law: CamLaw => Key::PLAIN.required();
        /// Cam angle over which the segment extends [rad], > 0. The key `angle` may be absent only in the last segment,
        /// which then extends to the end of the revolution.
        angle: Option<f64> => number(Radian, Range::Revolution);
        /// Change of the cam's lift over the segment, positive or negative [m or rad]. For an oscillating follower the
        /// lift is an angle in rad. A segment with the law `dwell` cannot have the key `rise`. The key `rise` may be
        /// absent only in the last segment, in which the lift then returns to 0.
        rise: Option<f64> => either([Metre, Radian], Range::Coordinate);
    }
}

words! {
    /// Shape of the follower.
    pub enum Follower {
        /// A roller.
        Roller = "roller",
        /// A flat face.
        Flat = "flat",
    }

    /// Law of the lift over a segment.
    pub enum CamLaw {
        /// No motion.
        Dwell = "dwell",
        /// Acceleration as one period of a sine.
        Cycloidal = "cycloidal",
        /// Polynomial of degree 5, without acceleration at its ends.
        Polynomial345 = "polynomial_345",
        /// Polynomial of degree 7, without acceleration and jerk at its ends.
        Polynomial4567 = "polynomial_4567",
    }
}

impl CamLaw {
    fn rise(self) -> Option<Rise> {
        match self {
            Self::Dwell => None,
            Self::Cycloidal => Some(Rise::Cycloidal),
            Self::Polynomial345 => Some(Rise::Polynomial345),
            Self::Polynomial4567 => Some(Rise::Polynomial4567),
        }
    }
}

/// The lift of segments. `turns`: whether the follower turns.
pub(super) fn of_segments(segments: &[CamSegment], key: &str, turns: bool) -> Result<Periodic, DefinitionError> {
    let unit = if turns { Radian } else { Metre };
    let last = segments.len().saturating_sub(1);
    let (mut angle, mut lift, mut largest) = (0.0, 0.0, 0.0_f64);
    let mut all = Vec::new();
    for (k, segment) in segments.iter().enumerate() {
        let at = |name: &str| format!("{key}.segments[{k}].{name}");
        let law = segment.law.rise();
        let length = match segment.angle {
            Some(length) => {
                Range::Revolution.check_in(Radian, at("angle"), length)?;
                length
            }
            None if k == last && angle < TAU * (1.0 - CLOSE) => TAU - angle,
            None if k == last => {
                let message = format_args!(
                    "the segments before this segment already fill the full revolution ({} rad): remove this segment",
                    Decimal::rounded(angle)
                );
                return refused(at("angle"), message);
            }
            None => return refused(at("angle"), "the angle is missing: only the last segment may be without an angle"),
        };
        let distance = match (law, segment.rise) {
            (None, Some(_)) => {
                let message = "a segment with the law `dwell` has no rise: remove the key `rise`, or choose another \
                    law";
                return refused(at("rise"), message);
            }
            (None, None) => 0.0,
            (Some(_), Some(rise)) => {
                Range::Coordinate.check_in(unit, at("rise"), rise)?;
                rise
            }
            (Some(_), None) if k == last => -lift,
            (Some(_), None) => {
                return refused(at("rise"), "the rise is missing: only the last segment may be without a rise");
            }
        };
        angle += length;
        lift += distance;
        largest = largest.max(distance.abs());
        all.push(Segment { length, distance, law });
    }
    if (angle - TAU).abs() > CLOSE * TAU {
        let message = format_args!(
            "the angles add up to {} rad instead of {} rad (2 pi): correct the angles, or leave out the angle of the \
             last segment",
            Decimal::rounded(angle),
            Decimal::rounded(TAU)
        );
        return refused(format!("{key}.segments"), message);
    }
    if lift.abs() > CLOSE * largest {
        let message = format_args!(
            "the rises add up to {} {} instead of 0, so the lift does not return to its start: correct the rises, or \
             leave out the rise of the last segment",
            Decimal::rounded(lift),
            unit.name()
        );
        return refused(format!("{key}.segments"), message);
    }
    Periodic::of_segments(&all)
        .map_or_else(|| refused(format!("{key}.segments"), "the list of segments is empty: add segments"), Ok)
}

/// The lift through points.
pub(super) fn of_points(
    points: &[[f64; 2]],
    interpolation: Interpolation,
    key: &str,
) -> Result<Periodic, DefinitionError> {
    let is_finite = points.iter().flatten().all(|value| value.is_finite());
    match interpolation.periodic(points).filter(|_| is_finite && points.len() >= FEWEST) {
        Some(lift) => Ok(lift),
        None => refused(
            format!("{key}.points"),
            "give 3 or more points [angle, lift] with ascending angles and finite numbers. All angles must lie within \
             less than one revolution (2 pi rad), because after the last point the curve returns to the first point",
        ),
    }
}
