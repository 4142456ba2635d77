//! The scene: what there is to be drawn of a mechanism, in the frames of its bodies.
//!
//! In: a checked definition and its linkage. Out: bodies, joints, loads, stops and locks by name, with points in the
//! frames of the linkage's bodies, as plain data. It must not know positions, which `poses` gives.
use crate::mechanism::definition::{Between, DefinitionError, Limit, Mechanism};
use crate::mechanism::linkage::{Body, Freedom, Linkage, Outline, Point};
use crate::numerics::plane::{Vec2, turned};
use serde::Serialize;

/// A point in the frame of a body of the linkage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct On {
    /// Index of the body of the linkage; 0 is the ground.
    pub frame: usize,
    /// Position in its frame [m].
    pub at: [f64; 2],
}

/// A point with its name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedPoint {
    /// Name, of a body's point without the body's.
    pub name: String,
    /// The point.
    #[serde(flatten)]
    pub on: On,
}

/// A body of the definition. Bodies that are fixed to one another have one frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnBody {
    /// Name.
    pub name: String,
    /// Mass [kg].
    pub mass: f64,
    /// Centre of mass.
    pub center: On,
    /// Its points: `origin`, `end` if it has a length, and those named in the definition.
    pub points: Vec<NamedPoint>,
}

/// A joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnJoint {
    /// Name.
    pub name: String,
    /// Point of the first body; of a slot the pin.
    pub first: On,
    /// Point of the second body.
    pub second: On,
    /// Direction of sliding in the first body's frame, of length 1; None for a revolute joint.
    pub axis: Option<[f64; 2]>,
    /// Radius of the pin [m].
    pub pin_radius: Option<f64>,
}

/// What acts between two points, in a joint or between two bodies: a drive or a spring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Connection {
    /// Name.
    pub name: String,
    /// Its ends; None where it does not act between two points.
    pub ends: Option<[On; 2]>,
    /// Index of its joint.
    pub joint: Option<usize>,
    /// Centres of mass of the two bodies on whose angle it acts, the first body's first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bodies: Option<[On; 2]>,
}

/// A surface with drag: a strip, or an area at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Surface {
    /// Name.
    pub name: String,
    /// The middle, at which the drag of a uniform flow acts.
    pub middle: On,
    /// From the middle to the end of the strip or, of a flat area, of the side of a square as large [m]; None where the
    /// area is as large from all sides.
    pub half: Option<[f64; 2]>,
}

/// A line fixed to a body: the pitch curve of a wheel, the profile of a cam, a roller, a flat face or a slot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnOutline {
    /// Name of the coupling or of the joint that is a slot.
    pub name: String,
    /// Index of the body of the linkage; 0 is the ground.
    pub frame: usize,
    /// Its points in the frame of the body [m].
    pub points: Vec<[f64; 2]>,
    /// Whether the last point is joined to the first.
    pub is_closed: bool,
}

/// A stop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnStop {
    /// Name.
    pub name: String,
    /// Frame of the body whose angle it limits; None where it limits another quantity.
    pub frame: Option<usize>,
    /// The two points whose distance it limits, if it does.
    pub ends: Option<[On; 2]>,
    /// Index of the joint whose angle or position it limits, if it does.
    pub joint: Option<usize>,
    /// Centres of mass of the two bodies whose angle it limits, if it does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bodies: Option<[On; 2]>,
    /// Whether the value may not fall below; else it may not rise above.
    pub is_lower: bool,
    /// Value [rad or m].
    pub value: f64,
    /// Whether the value is an angle.
    pub is_angle: bool,
    /// Whether the stop acts.
    pub enabled: bool,
    /// Whether it is rigid; else it is a bumper.
    pub rigid: bool,
    /// Name of the Boolean output that is true at the stop.
    pub flag: String,
}

/// Point of a named stop at which a lock holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnLock {
    /// Name, and the point on which it acts.
    #[serde(flatten)]
    pub point: NamedPoint,
    /// Index of its stop.
    pub stop: usize,
}

/// Weight of a body of the linkage under the load factor 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Weight {
    /// Its centre of mass.
    pub on: On,
    /// The weight in the mechanism frame [N].
    pub force: [f64; 2],
}

/// All that there is to be drawn of a mechanism.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Scene {
    /// Largest distance of two named points of one body [m].
    pub size: f64,
    /// Names of the linkage's bodies, each of which has a frame; the ground first.
    pub frames: Vec<String>,
    /// Bodies of the definition.
    pub bodies: Vec<DrawnBody>,
    /// Joints.
    pub joints: Vec<DrawnJoint>,
    /// Drives.
    pub actuators: Vec<Connection>,
    /// Springs and dampers.
    pub springs: Vec<Connection>,
    /// Points at which forces act.
    pub forces: Vec<NamedPoint>,
    /// Centres of mass of the bodies on which torques act.
    pub torques: Vec<NamedPoint>,
    /// Markers.
    pub markers: Vec<NamedPoint>,
    /// Outlines of the wheels and cams of couplings, and of slots.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub outlines: Vec<DrawnOutline>,
    /// Surfaces with drag.
    pub surfaces: Vec<Surface>,
    /// Direction in which the air flows, of length 1.
    pub flow: Option<[f64; 2]>,
    /// Stops.
    pub stops: Vec<DrawnStop>,
    /// Locks.
    pub locks: Vec<DrawnLock>,
    /// Weights.
    pub weights: Vec<Weight>,
}

impl From<Point> for On {
    fn from(point: Point) -> Self {
        Self { frame: point.body, at: point.local.into() }
    }
}

/// Reads the points of a definition as points of the linkage.
struct Reader<'a> {
    mechanism: &'a Mechanism,
    linkage: &'a Linkage,
}

impl Reader<'_> {
    fn on(&self, text: &str) -> Result<On, DefinitionError> {
        self.linkage.locate(self.mechanism, format_args!("{text}"), text).map(On::from)
    }

    fn named(&self, name: &str, text: &str) -> Result<NamedPoint, DefinitionError> {
        Ok(NamedPoint { name: name.into(), on: self.on(text)? })
    }

    /// A point given in the frame of a body of the definition.
    fn in_body(&self, body: &str, local: [f64; 2]) -> Result<On, DefinitionError> {
        let origin = self.on(&format!("{body}.origin"))?;
        let angle = self.linkage.carrier(self.mechanism, body).map_or(0.0, |(_, angle)| angle);
        Ok(On { frame: origin.frame, at: (Vec2::from(origin.at) + turned(local.into(), angle)).into() })
    }

    /// Centre of mass of a body of the definition.
    fn center(&self, name: &str) -> Result<On, DefinitionError> {
        let center = self.mechanism.bodies.get(name).map_or([0.0; 2], |body| body.center_of_mass());
        self.in_body(name, center)
    }

    fn connection(&self, name: &str, place: Option<Between>) -> Result<Connection, DefinitionError> {
        let mut connection = Connection { name: name.into(), ends: None, joint: None, bodies: None };
        match place {
            Some(Between::Points([first, second])) => connection.ends = Some([self.on(first)?, self.on(second)?]),
            Some(Between::Joint(joint)) => connection.joint = self.mechanism.joints.position(joint),
            Some(Between::Bodies([first, second])) => {
                connection.bodies = Some([self.center(first)?, self.center(second)?]);
            }
            None => {}
        }
        Ok(connection)
    }

    fn bodies(&self) -> Result<Vec<DrawnBody>, DefinitionError> {
        let mut bodies = Vec::new();
        for (name, body) in self.mechanism.bodies.iter() {
            let end = body.length.map(|_| "end");
            let names = ["origin"].into_iter().chain(end).chain(body.points.names());
            let points = names.map(|point| self.named(point, &format!("{name}.{point}")));
            bodies.push(DrawnBody {
                name: name.into(),
                mass: body.mass.unwrap_or(0.0),
                center: self.in_body(name, body.center_of_mass())?,
                points: points.collect::<Result<_, _>>()?,
            });
        }
        Ok(bodies)
    }

    fn joints(&self) -> Vec<DrawnJoint> {
        let defined = self.mechanism.joints.iter().map(|(_, joint)| joint);
        let drawn = self.linkage.joints.iter().zip(defined).map(|(joint, defined)| DrawnJoint {
            name: joint.name.clone(),
            // The pin of a slot is drawn, not the point to which its curve refers.
            first: if let Freedom::Slot(_) = joint.freedom { joint.second } else { joint.first }.into(),
            second: joint.second.into(),
            axis: match joint.freedom {
                Freedom::Revolute | Freedom::Slot(_) | Freedom::Coupling(_) => None,
                Freedom::Prismatic(axis) => Some(axis.into()),
            },
            pin_radius: defined.pin_radius,
        });
        drawn.collect()
    }

    fn outlines(&self) -> Vec<DrawnOutline> {
        let couplings = self.linkage.couplings.iter();
        let drawn = couplings.flat_map(|coupling| {
            let name = &self.linkage.joints[coupling.joint].name;
            self.linkage.outlines(coupling).into_iter().map(move |Outline { body, points, is_closed }| DrawnOutline {
                name: name.clone(),
                frame: body,
                points: points.into_iter().map(Vec2::into).collect(),
                is_closed,
            })
        });
        let slots = self.linkage.slots.iter().map(|slot| {
            let name = self.linkage.joints[slot.joint].name.clone();
            let Outline { body, points, is_closed } = self.linkage.slot_outline(slot);
            DrawnOutline { name, frame: body, points: points.into_iter().map(Vec2::into).collect(), is_closed }
        });
        drawn.chain(slots).collect()
    }

    fn surfaces(&self) -> Result<Vec<Surface>, DefinitionError> {
        let mut surfaces = Vec::new();
        for (name, s) in self.mechanism.surfaces.iter() {
            let (middle, half) = match (&s.from, &s.to, &s.at) {
                (Some(from), Some(to), _) => {
                    let (from, to) = (self.on(from)?, self.on(to)?);
                    let [a, b] = [from.at, to.at].map(Vec2::from);
                    (On { frame: from.frame, at: (0.5 * (a + b)).into() }, Some(0.5 * (b - a)))
                }
                (.., Some(at)) => {
                    let half = 0.5 * s.area.unwrap_or(0.0).sqrt();
                    let direction = s.surface_angle.map(|angle| angle + self.linkage.angle_of(self.mechanism, at));
                    (self.on(at)?, direction.map(|angle| turned(Vec2::new(half, 0.0), angle)))
                }
                _ => continue,
            };
            surfaces.push(Surface { name: name.into(), middle, half: half.map(Vec2::into) });
        }
        Ok(surfaces)
    }

    fn stops(&self) -> Result<Vec<DrawnStop>, DefinitionError> {
        let mut stops = Vec::new();
        for (name, s) in self.mechanism.stops.iter() {
            let Connection { name, ends, joint, bodies } = self.connection(name, s.between())?;
            let frame = s.body.as_ref().and_then(|body| self.linkage.carrier(self.mechanism, body));
            stops.push(DrawnStop {
                frame: frame.map(|(frame, _)| frame),
                ends,
                joint,
                bodies,
                is_lower: s.limit == Limit::Lower,
                value: s.angle.or(s.position).or(s.length).unwrap_or(0.0),
                is_angle: s.angle.is_some(),
                enabled: s.enabled,
                rigid: s.rigid.unwrap_or(true),
                flag: s.flag.clone().unwrap_or_else(|| format!("{name}.reached")),
                name,
            });
        }
        Ok(stops)
    }

    fn weights(&self) -> Vec<Weight> {
        let Some(gravity) = &self.mechanism.gravity else { return Vec::new() };
        let acceleration = -gravity.acceleration * Vec2::new(gravity.up_angle.cos(), gravity.up_angle.sin());
        let heavy = self.linkage.bodies.iter().enumerate().skip(1).filter(|(_, body)| body.mass > 0.0);
        let weight = |(frame, body): (usize, &Body)| Weight {
            on: On { frame, at: body.center.into() },
            force: (body.mass * acceleration).into(),
        };
        heavy.map(weight).collect()
    }
}

impl Scene {
    /// What there is to be drawn of this mechanism.
    ///
    /// # Errors
    /// A point that no body has.
    pub fn new(mechanism: &Mechanism, linkage: &Linkage) -> Result<Self, DefinitionError> {
        let reader = Reader { mechanism, linkage };
        let stop_of = |lock: &str| mechanism.stops.position(lock).unwrap_or(0);
        Ok(Self {
            size: linkage.size,
            frames: linkage.bodies.iter().map(|body| body.name.clone()).collect(),
            bodies: reader.bodies()?,
            joints: reader.joints(),
            actuators: collected(mechanism.actuators.iter().map(|(name, a)| reader.connection(name, a.between())))?,
            springs: collected(mechanism.springs.iter().map(|(name, s)| reader.connection(name, s.between())))?,
            forces: collected(mechanism.forces.iter().map(|(name, force)| reader.named(name, &force.at)))?,
            torques: collected(
                mechanism
                    .torques
                    .iter()
                    .map(|(name, torque)| Ok(NamedPoint { name: name.into(), on: reader.center(&torque.on)? })),
            )?,
            markers: collected(mechanism.markers.iter().map(|(name, marker)| reader.named(name, &marker.at)))?,
            outlines: reader.outlines(),
            surfaces: reader.surfaces()?,
            flow: mechanism.air.as_ref().map(|air| turned(Vec2::x(), air.flow_angle).into()),
            stops: reader.stops()?,
            locks: collected(mechanism.locks.iter().map(|(name, lock)| {
                Ok(DrawnLock { point: reader.named(name, &lock.at)?, stop: stop_of(&lock.stop) })
            }))?,
            weights: reader.weights(),
        })
    }
}

fn collected<T>(items: impl Iterator<Item = Result<T, DefinitionError>>) -> Result<Vec<T>, DefinitionError> {
    items.collect()
}
