//! Stops at the ends of the travel, and locks that hold the mechanism there.
use crate::format::{Flag, Key, Owner, Range, Role, Visit, curve, either, element, keys, number, point, words};
use crate::variables::Unit::{
    Metre, Newton, NewtonMetre, NewtonMetrePerRadian, NewtonMetreSecondPerRadian, NewtonPerMetre, NewtonSecondPerMetre,
    One, Radian,
};

keys! {
    /// An end of the travel, stated by the angle of a turning body, the position of a prismatic joint, the angle of a
    /// revolute joint, or the distance of two points.
    pub struct Stop {
        /// Turning body.
        body: Option<String> => element();
        /// Joint, in place of a body.
        joint: Option<String> => element();
        /// One of two points (`body.point`), in place of a body.
        first: Option<String> => point();
        /// The other point (`body.point`).
        second: Option<String> => point();
        /// Which end of the travel the value is. `lower`: the value may not fall below. `upper`: it may not rise above.
        limit: Limit => Key::PLAIN.required();
        /// Angle of the body, or of a revolute joint's second body from the first [rad].
        angle: Option<f64> => number(Radian, Range::Finite).parameter(Role::Load, "Angle");
        /// Position along a prismatic joint [m].
        position: Option<f64> => number(Metre, Range::Finite).parameter(Role::Load, "Position");
        /// Distance of the two points [m], >= 0.
        length: Option<f64> => number(Metre, Range::NonNegative).parameter(Role::Load, "Distance of the points");
        /// Whether the mechanism has this stop.
        enabled: bool = true => Key::PLAIN.parameter(Role::Load, "Whether @ is there");
        /// Whether the stop is rigid, with `restitution`; else a bumper, a spring and damper that only pushes. Must be
        /// given where there is a stiffness, a damping or a curve.
        rigid: Option<bool> => Key::PLAIN
            .parameter(Role::Load, "Whether @ is rigid; else it is a spring and damper that only \
                pushes").absent("true");
        /// Rigid: speed after an impact over the speed before [1], 0 to 1.
        restitution: f64 => number(One, Range::Unit).parameter(Role::Law, "Restitution");
        /// Bumper: stiffness [N/m or N.m/rad], >= 0.
        stiffness: f64 => either([NewtonPerMetre, NewtonMetrePerRadian], Range::NonNegative)
            .parameter(Role::Law, "Stiffness as a bumper");
        /// Bumper: damping [N.s/m or N.m.s/rad], >= 0.
        damping: f64 => either([NewtonSecondPerMetre, NewtonMetreSecondPerRadian], Range::NonNegative)
            .parameter(Role::Law, "Damping as a bumper");
        /// Bumper: curve of a further push over the depth beyond the value: pairs of depth and push
        /// [m or rad, N or N.m], from [0, 0] on, the push nowhere falling; straight on beyond the last.
        points: Option<Vec<[f64; 2]>> => curve([Metre, Radian], [Newton, NewtonMetre], Range::Coordinate).brief();
        /// Name of the Boolean output that is true at this stop; `<name>.reached` where absent.
        flag: Option<String> => element();
    }

    /// Holds the mechanism at a stop while its input `<name>.engage` is true, by a force at a point along the path of
    /// the point.
    pub struct Lock {
        /// Stop at which the lock holds.
        stop: String => element().required();
        /// Point (`body.point`) on which the lock's force acts.
        at: String => point().required();
        /// Start value of the input `<name>.engage`.
        engage: bool;
    }
}

words! {
    /// Which end of the travel a stop is.
    pub enum Limit {
        /// The value may not fall below.
        Lower = "lower",
        /// The value may not rise above.
        Upper = "upper",
    }
}

impl Stop {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let is_rotary = self.angle.is_some();
        Owner { group: Some("stops"), name, is_rotary }.parameters(self, &Some, visit);
    }

    pub(super) fn flags(&mut self, name: &str, visit: &mut dyn FnMut(Flag, &mut bool)) {
        Owner { group: Some("stops"), name, is_rotary: false }.flags(self, visit);
    }
}
