//! Joints that are curved slots: which keys go together, and the curve.
//!
//! In: a joint of a definition. Out: its curve, or what is wrong with it. It must not know how loops close.
use super::bodies::{Joint, JointKind};
use super::refusal::{Check, refused};
use crate::numerics::decimal::Decimal;
use crate::numerics::track::Track;
use std::f64::consts::TAU;

/// Most points of a slot.
const MOST_POINTS: usize = 1000;

impl Joint {
    /// Whether the joint has a position: a prismatic joint or a slot.
    pub fn slides(&self) -> bool {
        self.kind != JointKind::Revolute
    }

    /// The curve of a slot, relative to the first point and in the axes of the first body; None for another joint and
    /// for keys that state no curve.
    pub fn track(&self) -> Option<Track> {
        match (self.kind, self.radius, &self.path) {
            (JointKind::Slot, Some(radius), None) => {
                let from = self.from_angle.unwrap_or(0.0);
                let angle = self.to_angle.map_or(TAU, |to| to - from);
                (angle > 0.0).then_some(Track::Arc { radius, from, angle })
            }
            (JointKind::Slot, None, Some(points)) => Track::through(points),
            _ => None,
        }
    }

    /// The keys of a slot state one curve, and only a slot has them.
    pub(super) fn check_slot(&self, key: &str) -> Check {
        let given = [
            ("radius", self.radius.is_some()),
            ("path", self.path.is_some()),
            ("from_angle", self.from_angle.is_some()),
            ("to_angle", self.to_angle.is_some()),
        ];
        if self.kind != JointKind::Slot {
            return match given.into_iter().find(|(_, is_given)| *is_given) {
                Some((name, _)) => refused(format_args!("{key}.{name}"), "only a slot has this key: remove the key"),
                None => Ok(()),
            };
        }
        if self.radius.is_some() == self.path.is_some() {
            return refused(key, "give the key \"radius\" for an arc, or the key \"path\" for another curve");
        }
        if let Some(points) = &self.path {
            if let Some((name, _)) = given[2..].iter().find(|(_, is_given)| *is_given) {
                return refused(
                    format_args!("{key}.{name}"),
                    "only a slot with the key radius has this key: remove the key",
                );
            }
            if !(2..=MOST_POINTS).contains(&points.len()) {
                let message = format_args!("the path has {} points, but must have 2 to {MOST_POINTS}", points.len());
                return refused(format_args!("{key}.path"), message);
            }
            if let Some(k) = (1..points.len()).find(|k| points[*k] == points[k - 1]) {
                return refused(
                    format_args!("{key}.path[{k}]"),
                    "this point equals the point before: remove one of the two points",
                );
            }
            if self.track().is_none() {
                let message = "the smooth curve through these points would turn back on itself: add points where the \
                               direction changes strongly";
                return refused(format_args!("{key}.path"), message);
            }
            return Ok(());
        }
        let (from, to) = (self.from_angle.unwrap_or(0.0), self.to_angle);
        if let Some(to) = to.filter(|to| *to <= from) {
            let message = format_args!(
                "the slot ends at {} rad, but starts at {} rad: give a `to_angle` that is larger than `from_angle`",
                Decimal::rounded(to),
                Decimal::rounded(from)
            );
            return refused(format_args!("{key}.to_angle"), message);
        }
        Ok(())
    }
}
