//! Where drives, springs and stops act: between two points, in a joint, or between two bodies.
//!
//! In: the keys of an element. Out: the one of the three places that the keys state. It must not know geometry.
use super::bodies::{Joint, JointKind};
use crate::format::Named;

/// The keys that state the place of a drive or a spring, for messages.
pub const PLACES: &str = "give the keys \"first\" and \"second\", the key \"joint\", or the keys \"first_body\" and \
                          \"second_body\"";

/// Where a load acts that has two ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between<'a> {
    /// Along the line between two points.
    Points([&'a str; 2]),
    /// In a joint.
    Joint(&'a str),
    /// On the angle of the second body relative to the first body.
    Bodies([&'a str; 2]),
}

impl<'a> Between<'a> {
    /// The place that keys state; None if they do not state one place.
    pub(super) fn of(
        points: [&'a Option<String>; 2],
        joint: &'a Option<String>,
        bodies: [&'a Option<String>; 2],
    ) -> Option<Self> {
        match (points.map(Option::as_deref), joint.as_deref(), bodies.map(Option::as_deref)) {
            ([Some(first), Some(second)], None, [None, None]) => Some(Self::Points([first, second])),
            ([None, None], Some(joint), [None, None]) => Some(Self::Joint(joint)),
            ([None, None], None, [Some(first), Some(second)]) => Some(Self::Bodies([first, second])),
            _ => None,
        }
    }

    /// Whether a load there is a torque.
    pub fn is_rotary(self, joints: &Named<Joint>) -> bool {
        match self {
            Self::Points(_) => false,
            Self::Joint(joint) => joints.get(joint).is_some_and(|joint| joint.kind == JointKind::Revolute),
            Self::Bodies(_) => true,
        }
    }
}
