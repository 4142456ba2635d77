//! Stops at the ends of the travel, and locks that hold the mechanism there.
use super::between::Between;
use crate::format::{Flag, Key, Owner, Range, Role, Visit, curve, either, element, keys, number, point, words};
use crate::variables::Unit::{
    Metre, Newton, NewtonMetre, NewtonMetrePerRadian, NewtonMetreSecondPerRadian, NewtonPerMetre, NewtonSecondPerMetre,
    One, Radian,
};

keys! {
    /// A stop ends the travel of the mechanism on one side. Each stop limits one quantity: the angle of a body, the
    /// position of a prismatic joint, the angle of a revolute joint, the distance between two points, or the angle
    /// between two bodies.
    pub struct Stop {
        /// Body whose angle the stop limits.
        body: Option<String> => element();
        /// Joint whose position or angle the stop limits, in place of the key `body`.
        joint: Option<String> => element();
        /// First of two points (`body.point`) whose distance the stop limits, in place of the key `body`.
        first: Option<String> => point();
        /// Second of the two points (`body.point`) whose distance the stop limits.
        second: Option<String> => point();
        /// First of two bodies between which the stop limits the angle, in place of the key `body`.
        first_body: Option<String> => element();
        /// Second of the two bodies between which the stop limits the angle. The angle of the stop is the angle of
        /// `second_body` relative to `first_body`.
        second_body: Option<String> => element();
        /// Kind of limit. `lower`: the stop limits the angle, position or distance from below. `upper`: the stop limits
        /// the angle, position or distance from above.
        limit: Limit => Key::PLAIN.required();
        /// Limit of the angle at the stop [rad]: for the key `body` the angle of the body, otherwise the angle of the
        /// second body relative to the first body.
        angle: Option<f64> => number(Radian, Range::Finite).parameter(Role::Load, "Limit of the angle at @");
        /// Position of the prismatic joint or of the slot at the stop [m].
        position: Option<f64> => number(Metre, Range::Finite).parameter(Role::Load, "Limit of the position at @");
        /// Distance between the two points at the stop [m], >= 0.
        length: Option<f64> => number(Metre, Range::NonNegative).parameter(Role::Load, "Distance between the two \
            points at @");
        /// true: the stop acts on the mechanism. false: the stop is ignored.
        enabled: bool = true => Key::PLAIN.parameter(Role::Load, "true: @ acts; false: the stop is ignored");
        /// true: a rigid stop with `restitution`. false: a bumper, which is a spring and damper that only pushes. A
        /// stop with `stiffness`, `damping` or `points` must also have the key `rigid`.
        rigid: Option<bool> => Key::PLAIN
            .parameter(Role::Load, "true: @ is rigid; false: the stop is a bumper, which is a spring and \
                damper that only pushes").absent("true");
        /// For a rigid stop: speed after an impact divided by the speed before the impact [1], 0 to 1.
        restitution: f64 => number(One, Range::Unit).parameter(Role::Law, "Speed of the mechanism after an impact on \
            @, divided by the speed before the impact");
        /// For a bumper: stiffness of the bumper [N/m or N.m/rad], >= 0.
        stiffness: f64 => either([NewtonPerMetre, NewtonMetrePerRadian], Range::NonNegative)
            .parameter(Role::Law, "Stiffness of @, if the stop is a bumper");
        /// For a bumper: damping coefficient of the bumper [N.s/m or N.m.s/rad], >= 0.
        damping: f64 => either([NewtonSecondPerMetre, NewtonMetreSecondPerRadian], Range::NonNegative)
            .parameter(Role::Law, "Damping coefficient of @, if the stop is a bumper");
        /// For a bumper: additional force as a curve over the compression [m or rad, N or N.m]. The list
        /// `points` contains pairs of compression and force. The first pair of `points` must be [0, 0], and the force
        /// must not decrease with the compression. Beyond the last pair, the force curve of the bumper is a straight
        /// line.
        points: Option<Vec<[f64; 2]>> => curve([Metre, Radian], [Newton, NewtonMetre], Range::Coordinate).brief();
        /// Name of the stop's Boolean output, which is true while the mechanism is at the stop or beyond the stop.
        /// Default: `<name>.reached`.
        flag: Option<String> => element();
    }

    /// A lock holds the mechanism at a stop while the input `<name>.engage` is true. The force of the lock acts on the
    /// point `at`, along the path of the point `at`.
    pub struct Lock {
        /// Name of the stop at which the lock holds the mechanism.
        stop: String => element().required();
        /// Point (`body.point`) on which the force of the lock acts.
        at: String => point().required();
        /// Start value of the input `<name>.engage`. true: the lock is engaged.
        engage: bool;
        /// Release force of a detent: force on the point `at` at which an engaged lock releases the mechanism [N], > 0.
        /// Without the key `release_force`, a lock holds any load. The stop of a lock with `release_force` must be
        /// rigid.
        release_force: Option<f64> => number(Newton, Range::Positive)
            .parameter(Role::Law, "Force at which @ releases the mechanism");
        /// Latch: force or torque of the stop above which the lock engages, while the input `<name>.engage` is true [N
        /// or N.m], > 0. Without the key `engage_force`, a lock engages as soon as the mechanism is at the stop. A lock
        /// cannot have both the keys `engage_force` and `release_force`.
        engage_force: Option<f64> => either([Newton, NewtonMetre], Range::Positive)
            .parameter(Role::Law, "Force of the stop at which @ engages").brief();
    }
}

words! {
    /// Side of a stop.
    pub enum Limit {
        /// The angle, position or distance cannot fall below the stated value.
        Lower = "lower",
        /// The angle, position or distance cannot rise above the stated value.
        Upper = "upper",
    }
}

impl Lock {
    pub(super) fn parameters(&mut self, name: &str, is_rotary: bool, visit: &mut Visit) {
        Owner { group: Some("locks"), kind: "the lock ", name, is_rotary }.parameters(self, &Some, visit);
    }
}

impl Stop {
    /// Where the stop acts; None for a stop of the angle of one body, or if the keys do not
    /// state one place.
    pub fn between(&self) -> Option<Between<'_>> {
        Between::of([&self.first, &self.second], &self.joint, [&self.first_body, &self.second_body])
    }

    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let is_rotary = self.angle.is_some();
        Owner { group: Some("stops"), kind: "the stop ", name, is_rotary }.parameters(self, &Some, visit);
    }

    pub(super) fn flags(&mut self, name: &str, visit: &mut dyn FnMut(Flag, &mut bool)) {
        Owner { group: Some("stops"), kind: "the stop ", name, is_rotary: false }.flags(self, visit);
    }
}
