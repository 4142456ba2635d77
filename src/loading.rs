//! The loading of a mechanism: its loads of unit size, and what makes each as large as it is.
//!
//! In: a definition and its linkage. Out: loads in a fixed order - those that inputs size, those of constant size, springs -
//! with the laws of springs and the efficiencies of drives. It must not know the state.
use crate::definition::{DefinitionError, Mechanism};
use crate::linkage::{Freedom, Linkage, Point, Vec2};
use crate::loads::Load;

/// All loads of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Loading {
    /// Loads of unit size: one for each input, then those of constant size, then one for each spring.
    pub loads: Vec<Load>,
    /// Names of the inputs that size the first loads, such as `actuator.force`.
    pub inputs: Vec<String>,
    /// Sizes of the loads after them.
    pub constants: Vec<f64>,
    /// Laws of the last loads.
    pub springs: Vec<Spring>,
    /// Drives; each sizes the load at the same place.
    pub drives: Vec<Drive>,
    /// Place of gravity among the loads.
    pub gravity: Option<usize>,
}

/// Law of a spring and damper. Its pull on S is preload + stiffness (S - free) + damping S_dot.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Name.
    pub name: String,
    /// Place of its load.
    pub load: usize,
    /// Stiffness [N/m or N.m/rad].
    pub stiffness: f64,
    /// Damping [N.s/m or N.m.s/rad].
    pub damping: f64,
    /// S without force but the preload [m or rad].
    pub free: f64,
    /// Pull at this S [N or N.m].
    pub preload: f64,
}

impl Spring {
    /// Pull at rest [N or N.m].
    pub fn pull(&self, s: f64) -> f64 {
        self.preload + self.stiffness * (s - self.free)
    }

    /// Energy stored, less that at the free length [J].
    pub fn energy(&self, s: f64) -> f64 {
        let stretch = s - self.free;
        stretch * (self.preload + 0.5 * self.stiffness * stretch)
    }
}

/// A drive of the mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Name.
    pub name: String,
    /// Whether it turns; else it moves along a line.
    pub turns: bool,
    /// [CK16] eq. (5); none where it is 1 and no parameter.
    pub efficiency: Option<f64>,
}

/// The load of two points, or of a joint.
fn between(
    mechanism: &Mechanism,
    linkage: &Linkage,
    key: &str,
    first: &Option<String>,
    second: &Option<String>,
    joint: &Option<String>,
) -> Result<Load, DefinitionError> {
    let missing = || DefinitionError::Key { key: key.into(), message: "give first and second, or joint".into() };
    if let (Some(first), Some(second)) = (first, second) {
        let end = |k: &str, text: &str| linkage.locate(mechanism, &format!("{key}.{k}"), text);
        let (first, second) = (end("first", first)?, end("second", second)?);
        if first.body == second.body {
            let message =
                format!("both ends are on {}, so it cannot act: name two bodies", linkage.bodies[first.body].name);
            return Err(DefinitionError::Key { key: key.into(), message });
        }
        let ends = [first, second];
        let is_at = |a: Point, b: Point| a.body == b.body && (a.local - b.local).norm() <= 1e-12 * linkage.size;
        let pinned = linkage.joints.iter().find(|j| {
            let points = [[j.first, j.second], [j.second, j.first]];
            j.freedom == Freedom::Turn && points.iter().any(|p| is_at(p[0], ends[0]) && is_at(p[1], ends[1]))
        });
        if let Some(joint) = pinned {
            let message =
                format!("its two ends are the one point of {}, so its length is zero: name two points", joint.name);
            return Err(DefinitionError::Key { key: key.into(), message });
        }
        return Ok(Load::Pair { first, second });
    }
    let name = joint.as_ref().ok_or_else(missing)?;
    let place = linkage.joints.iter().position(|j| j.name == *name).ok_or_else(missing)?;
    let j = &linkage.joints[place];
    Ok(match j.freedom {
        Freedom::Turn => Load::Couple { first: j.first.body, second: j.second.body },
        Freedom::Slide(_) => Load::Slide { joint: place },
    })
}

impl Loading {
    /// Resolve the loads of a definition.
    ///
    /// # Errors
    /// A point, body or joint that does not exist; two ends on one body.
    pub fn new(mechanism: &Mechanism, linkage: &Linkage) -> Result<Self, DefinitionError> {
        let mut sized: Vec<(String, Load)> = Vec::new();
        let mut constant: Vec<(f64, Load)> = Vec::new();
        let mut drives = Vec::new();
        for (name, a) in mechanism.actuators.iter() {
            let load = between(mechanism, linkage, &format!("actuators.{name}"), &a.first, &a.second, &a.joint)?;
            let turns = matches!(load, Load::Couple { .. });
            sized.push((format!("{name}.{}", if turns { "torque" } else { "force" }), load));
            drives.push(Drive { name: name.into(), turns, efficiency: a.efficiency });
        }
        let gravity = mechanism.gravity.as_ref().map(|_| sized.len());
        if let Some(g) = &mechanism.gravity {
            let acceleration = -g.acceleration * Vec2::new(g.up_angle.cos(), g.up_angle.sin());
            sized.push(("load_factor".into(), Load::Gravity(acceleration)));
        }
        for (name, force) in mechanism.forces.iter() {
            let at = linkage.locate(mechanism, &format!("forces.{name}.at"), &force.at)?;
            for (axis, direction, size) in [("x", Vec2::x(), force.force[0]), ("y", Vec2::y(), force.force[1])] {
                let load = Load::Force { at, direction };
                if force.constant {
                    constant.push((size, load))
                } else {
                    sized.push((format!("{name}.force_{axis}"), load))
                }
            }
        }
        for (name, t) in mechanism.torques.iter() {
            let load = Load::Torque { body: linkage.carrier(mechanism, &t.on).map_or(0, |(body, _)| body) };
            if t.constant { constant.push((t.torque, load)) } else { sized.push((format!("{name}.torque"), load)) }
        }
        let (inputs, mut loads): (Vec<String>, Vec<Load>) = sized.into_iter().unzip();
        let (constants, more): (Vec<f64>, Vec<Load>) = constant.into_iter().unzip();
        loads.extend(more);
        let mut springs = Vec::new();
        for (name, s) in mechanism.springs.iter() {
            let load = between(mechanism, linkage, &format!("springs.{name}"), &s.first, &s.second, &s.joint)?;
            springs.push(Spring {
                name: name.into(),
                load: loads.len(),
                stiffness: s.stiffness,
                damping: s.damping.unwrap_or(0.0),
                free: s.free_length.or(s.free_angle).unwrap_or(0.0),
                preload: s.preload.unwrap_or(0.0),
            });
            loads.push(load);
        }
        Ok(Self { loads, inputs, constants, springs, drives, gravity })
    }

    /// Number of loads of a given size: inputs, then constants.
    pub fn sized(&self) -> usize {
        self.inputs.len() + self.constants.len()
    }

    /// Name of a load, to speak of it.
    pub fn name(&self, load: usize) -> String {
        match load.checked_sub(self.sized()) {
            Some(spring) => self.springs[spring].name.clone(),
            None => self.inputs.get(load).cloned().unwrap_or_else(|| "a constant load".into()),
        }
    }
}

/// Markers of a definition, in its order.
///
/// # Errors
/// A point that does not exist.
pub fn markers(mechanism: &Mechanism, linkage: &Linkage) -> Result<Vec<Point>, DefinitionError> {
    let named = mechanism.markers.iter();
    named.map(|(name, m)| linkage.locate(mechanism, &format!("markers.{name}.at"), &m.at)).collect()
}
