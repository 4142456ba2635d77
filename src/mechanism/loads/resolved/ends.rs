//! The ends of a load: two points, the two sides of a joint, or two bodies.
//!
//! In: keys of a definition, its linkage. Out: the load of unit size between them, or why none can act there. It must
//! not know the state.
use crate::mechanism::definition::{Between, DefinitionError, Mechanism, PLACES};
use crate::mechanism::linkage::{Freedom, Linkage, Point};
use crate::mechanism::loads::unit_load::Load;
use std::collections::HashMap;
use std::fmt;

/// A point by its body and the bits of its coordinates.
type Key = (usize, [u64; 2]);

/// The points that revolute joints hold together, so that nobody searches all joints.
pub(super) struct Hinges {
    /// For each point of a revolute joint a number that stands for its place, and the index of a joint there.
    places: HashMap<Key, (usize, usize)>,
}

fn key(point: Point) -> Key {
    // -0 + 0 is 0.
    (point.body, [point.local.x, point.local.y].map(|x| (x + 0.0).to_bits()))
}

impl Hinges {
    pub(super) fn new(linkage: &Linkage) -> Self {
        let mut places: HashMap<Key, (usize, usize)> = HashMap::new();
        let mut points: Vec<Vec<Key>> = Vec::new();
        for (joint, of) in linkage.joints.iter().enumerate().filter(|(_, of)| of.freedom == Freedom::Revolute) {
            let [mut one, mut other] = [of.first, of.second].map(|point| {
                let key = key(point);
                places
                    .entry(key)
                    .or_insert_with(|| {
                        points.push(vec![key]);
                        (points.len() - 1, joint)
                    })
                    .0
            });
            if one == other {
                continue;
            }
            // The smaller group joins the larger one.
            if points[one].len() < points[other].len() {
                std::mem::swap(&mut one, &mut other);
            }
            let moved = std::mem::take(&mut points[other]);
            moved.iter().filter_map(|key| places.get_mut(key).map(|place| place.0 = one)).for_each(drop);
            points[one].extend(moved);
        }
        Self { places }
    }

    /// Index of a joint that holds two points at one place, with others if need be.
    fn joining(&self, one: Point, other: Point) -> Option<usize> {
        let [(one, joint), (other, _)] = [self.places.get(&key(one))?, self.places.get(&key(other))?];
        (one == other).then_some(*joint)
    }
}

/// Load between two points, in a joint or between two bodies.
pub(super) fn between(
    mechanism: &Mechanism,
    linkage: &Linkage,
    hinges: &Hinges,
    key: fmt::Arguments,
    place: Option<Between>,
) -> Result<Load, DefinitionError> {
    let missing = || DefinitionError::key(key, PLACES);
    match place.ok_or_else(missing)? {
        Between::Points([first, second]) => {
            let end = |k: &str, text: &str| linkage.locate(mechanism, format_args!("{key}.{k}"), text);
            let (first, second) = (end("first", first)?, end("second", second)?);
            if first.body == second.body {
                let message = format!(
                    "both ends are on {}, so this element has no effect: give points of two bodies",
                    linkage.bodies[first.body].name
                );
                return Err(DefinitionError::key(key, message));
            }
            if let Some(joint) = hinges.joining(first, second) {
                let name = &linkage.joints[joint].name;
                let message =
                    format!("both ends are the point {name}, so the length is zero: give two different points");
                return Err(DefinitionError::key(key, message));
            }
            Ok(Load::Pair { first, second, is_idle: false })
        }
        Between::Joint(name) => {
            let joint = mechanism.joints.position(name).ok_or_else(missing)?;
            let named = mechanism.joints.get(name).ok_or_else(missing)?;
            // The angle of a revolute joint is that of the bodies that the file names, which others may carry.
            let shift = linkage.angle_of(mechanism, &named.second) - linkage.angle_of(mechanism, &named.first);
            Ok(joint_load(linkage, joint, shift))
        }
        Between::Bodies(names) => {
            let [first, second] = names.map(|name| linkage.carrier(mechanism, name));
            let ((first, before), (second, after)) = (first.ok_or_else(missing)?, second.ok_or_else(missing)?);
            // The bodies of one group turn together, and the ground has no group.
            let [one, other] = [first, second].map(|body| linkage.bodies[body].angle_coordinate);
            if one == other {
                let message = format!(
                    "{} does not turn relative to {}, so this element has no effect: name two bodies that turn \
                     relative to each other",
                    names[1], names[0]
                );
                return Err(DefinitionError::key(key, message));
            }
            Ok(Load::Couple { first, second, shift: after - before, is_idle: false })
        }
    }
}

/// Load in a joint: a couple between the bodies of a revolute joint, whose S is the angle between them plus `shift`; a
/// force along the axis of a prismatic one.
pub(super) fn joint_load(linkage: &Linkage, joint: usize, shift: f64) -> Load {
    let j = &linkage.joints[joint];
    match j.freedom {
        Freedom::Revolute => Load::Couple { first: j.first.body, second: j.second.body, shift, is_idle: false },
        Freedom::Prismatic(_) | Freedom::Slot(_) | Freedom::Coupling(_) => {
            Load::Slide { joint, sign: 1.0, is_idle: false }
        }
    }
}
