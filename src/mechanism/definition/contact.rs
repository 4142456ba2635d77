//! Stops at the ends of the travel, and locks that hold the mechanism there.
use super::{Role, Visit};
use crate::format::{Flag, Owner, Range};
use crate::variables::Unit;
use serde::{Deserialize, Serialize};

/// A stop: an end of the travel, stated by the angle of a turning body, the position of a prismatic joint, the angle of
/// a revolute joint, or the distance of two points.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Turning body.
    pub body: Option<String>,
    /// Joint, in place of a body.
    pub joint: Option<String>,
    /// One of two points (`body.point`), in place of a body.
    pub first: Option<String>,
    /// The other point.
    pub second: Option<String>,
    /// Whether the stated value is the lower or the upper end of the travel.
    pub limit: Limit,
    /// Angle of the body, or of a revolute joint's second body from the first [rad].
    pub angle: Option<f64>,
    /// Position along a prismatic joint [m].
    pub position: Option<f64>,
    /// Distance of the two points [m].
    pub length: Option<f64>,
    /// Whether the mechanism has this stop.
    #[serde(default = "yes")]
    pub enabled: bool,
    /// Whether the stop is rigid, as it is where absent; else a bumper, a spring and damper that only pushes.
    pub rigid: Option<bool>,
    /// Rigid: speed after an impact over the speed before [1], from 0 to 1.
    #[serde(default)]
    pub restitution: f64,
    /// Bumper: stiffness [N/m or N.m/rad], >= 0.
    #[serde(default)]
    pub stiffness: f64,
    /// Bumper: damping [N.s/m or N.m.s/rad], >= 0.
    #[serde(default)]
    pub damping: f64,
    /// Bumper: points of a further push over the depth beyond the stop: pairs [m or rad, N or N.m], from [0, 0] on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Vec<[f64; 2]>>,
    /// Name of the Boolean output that is true at this stop; `<name>.reached` where absent.
    pub flag: Option<String>,
}

fn yes() -> bool {
    true
}

/// Which end of the travel a stop is.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// The value may not fall below.
    Lower,
    /// The value may not rise above.
    Upper,
}

/// A lock, which holds the mechanism at a stop while its input `<name>.engage` is true, by a force at a point along the
/// path of the point.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Lock {
    /// Stop at which the lock holds.
    pub stop: String,
    /// Point on which the lock's force acts (`body.point`).
    pub at: String,
    /// Start value of `<name>.engage`.
    #[serde(default)]
    pub engage: bool,
}

impl Stop {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let (stiffness, damping) = if self.angle.is_some() {
            (Unit::NewtonMetrePerRadian, Unit::NewtonMetreSecondPerRadian)
        } else {
            (Unit::NewtonPerMetre, Unit::NewtonSecondPerMetre)
        };
        let mut list = Owner::new(Some("stops"), name, Role::Load, visit);
        list.add("angle", "Angle", Unit::Radian, Range::Finite, &mut self.angle);
        list.add("position", "Position", Unit::Metre, Range::Finite, &mut self.position);
        list.add("length", "Distance of the points", Unit::Metre, Range::NonNegative, &mut self.length);
        list.add("restitution", "Restitution", Unit::One, Range::Unit, &mut self.restitution);
        list.add("stiffness", "Stiffness as a bumper", stiffness, Range::NonNegative, &mut self.stiffness);
        list.add("damping", "Damping as a bumper", damping, Range::NonNegative, &mut self.damping);
    }

    pub(super) fn flags(&mut self, name: &str, visit: &mut dyn FnMut(Flag, &mut bool)) {
        visit(Flag::new(name, "enabled", ["Whether ", name, " is there"]), &mut self.enabled);
        let rigid = ["Whether ", name, " is rigid; else it is a spring and damper that only pushes"];
        visit(Flag::new(name, "rigid", rigid), self.rigid.get_or_insert(true));
    }
}
