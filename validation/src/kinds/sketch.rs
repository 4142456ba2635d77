//! A mechanism as one draws it: points, bodies between them, slides, and positions of all points in closed form.
//!
//! In: lengths, a closed form. Out: poses of all bodies with their derivatives with respect to the closed form's
//! parameter, joints. Must not depend on how the engine closes loops.
use super::jet::{Jet, Vector};
use crate::attack::random::Random;

/// Reason why a closed form has no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Miss {
    /// The lengths cannot be assembled there: two circles do not intersect.
    Apart,
    /// So near a limit of the travel that the parameter of the closed form is unsuitable.
    Near,
}

/// Orientation of a body's frame.
#[derive(Clone, Copy, Debug)]
pub enum Frame {
    /// Its x axis points from its origin to this point, at this distance [m].
    To(usize, f64),
    /// Its angle is constant: a body in a guide on the ground [rad].
    Fixed(f64),
    /// Its angle is that of another body plus this angle [rad].
    With(usize, f64),
}

/// A body: the points at its origin and, if given, at its other end, and further points in its frame [m].
#[derive(Clone, Debug)]
pub struct Body {
    pub name: String,
    pub origin: usize,
    pub frame: Frame,
    pub points: Vec<(usize, [f64; 2])>,
    pub mass: f64,
    pub center: [f64; 2],
    pub inertia: f64,
}

/// A guide on a body or on the ground (None), through its point `from`; the origin of the body `block` moves in it.
#[derive(Clone, Debug)]
pub struct Slide {
    pub name: String,
    pub on: Option<usize>,
    pub from: usize,
    pub axis: f64,
    pub block: usize,
}

/// A coordinate of the mechanism: its motion is compared in it, a stop limits it, a drive acts on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coordinate {
    /// Angle of a body.
    Angle(usize),
    /// Position in a slide.
    Position(usize),
    /// Distance between a fixed point and a point of the mechanism.
    Distance([f64; 2], usize),
}

/// Spring and damper between a fixed point and a point of the mechanism.
#[derive(Clone, Copy, Debug)]
pub struct Spring {
    pub anchor: [f64; 2],
    pub end: usize,
    pub stiffness: f64,
    pub damping: f64,
    pub free: f64,
}

/// Loads on a mechanism.
#[derive(Clone, Debug, Default)]
pub struct Loads {
    /// Acceleration [m/s2] and upward direction [rad].
    pub gravity: [f64; 2],
    /// Body, and torque on it [N.m].
    pub torques: Vec<(usize, f64)>,
    pub springs: Vec<Spring>,
    /// Friction in all joints: mu_S, mu_d, V_S, V_d.
    pub friction: Option<[f64; 4]>,
    /// Radii of the pins with friction, in the order of the joints [m].
    pub radii: Vec<f64>,
    /// Coordinate that a drive acts on, and its efficiency.
    pub drive: Option<(Coordinate, f64)>,
}

/// A stop, or a bumper.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    pub on: Coordinate,
    /// 1 for an upper stop, -1 for a lower one.
    pub sign: f64,
    pub value: f64,
    /// Restitution of a rigid stop; None for a bumper.
    pub rigid: Option<f64>,
    pub stiffness: f64,
    pub damping: f64,
}

/// Positions of all points, in order, for a value of the parameter.
pub type Places = Box<dyn Fn(Jet) -> Result<Vec<Vector>, Miss>>;

/// Pose of a body: origin and angle.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    pub origin: Vector,
    pub angle: Jet,
}

/// A mechanism.
pub struct Sketch {
    /// Name of the model.
    pub name: &'static str,
    /// Points of the ground.
    pub ground: Vec<(usize, [f64; 2])>,
    /// Bodies except the ground, in the order of the file.
    pub bodies: Vec<Body>,
    /// Prismatic joints.
    pub slides: Vec<Slide>,
    /// Coordinate in which the motion is defined and compared.
    pub coordinate: Coordinate,
    /// Start of the motion: the parameter [rad or m] and its rate.
    pub start: [f64; 2],
    /// Loads.
    pub loads: Loads,
    /// Stops; with a closed form none, or a lower and an upper one of the coordinate.
    pub stops: Vec<Stop>,
    /// The stop with a lock.
    pub lock: Option<usize>,
    /// Tolerance of the engine's integration.
    pub tolerance: f64,
    /// Greatest error of each number of the guess [rad or relative to the size].
    pub rough: f64,
    /// The closed form.
    pub places: Places,
}

/// A joint: its name, first and second body (None: ground), and the point on each.
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    pub ends: [(Option<usize>, usize); 2],
    /// Its slide, if it is prismatic.
    pub slide: Option<usize>,
}

impl Sketch {
    /// A mechanism with these points; it starts at this parameter, and its coordinate is the first body's angle.
    pub fn new(name: &'static str, start: f64, places: impl Fn(Jet) -> Result<Vec<Vector>, Miss> + 'static) -> Self {
        Self {
            name,
            ground: Vec::new(),
            bodies: Vec::new(),
            slides: Vec::new(),
            coordinate: Coordinate::Angle(0),
            start: [start, 0.0],
            loads: Loads::default(),
            stops: Vec::new(),
            lock: None,
            tolerance: 1e-9,
            rough: 0.0,
            places: Box::new(places),
        }
    }

    /// Add these points of the ground.
    pub fn ground(mut self, points: &[(usize, [f64; 2])]) -> Self {
        self.ground.extend_from_slice(points);
        self
    }

    fn with(mut self, name: &str, origin: usize, frame: Frame, points: &[(usize, [f64; 2])]) -> Self {
        let (name, points, mass, center, inertia) = (name.into(), points.to_vec(), 0.0, [0.0; 2], 0.0);
        self.bodies.push(Body { name, origin, frame, points, mass, center, inertia });
        self
    }

    /// Add a body from one point to another, which may have further points.
    pub fn plate(self, name: &str, from: usize, to: usize, length: f64, points: &[(usize, [f64; 2])]) -> Self {
        self.with(name, from, Frame::To(to, length), points)
    }

    /// Add a body in a guide along a line through a point of the ground (None) or of another body.
    pub fn slider(self, name: &str, at: usize, on: Option<usize>, from: usize, axis: f64) -> Self {
        let (block, guide) = (self.bodies.len(), format!("{name}_guide"));
        let frame = on.map_or(Frame::Fixed(axis), |body| Frame::With(body, axis));
        self.with(name, at, frame, &[]).guided(&guide, on, from, axis, block)
    }

    /// Add a guide between existing bodies.
    pub fn guided(mut self, name: &str, on: Option<usize>, from: usize, axis: f64, block: usize) -> Self {
        // The file has joints in the order of their names.
        let name = format!("slide{}_{name}", self.slides.len());
        self.slides.push(Slide { name, on, from, axis, block });
        self
    }

    /// Use this coordinate for the comparison of the motion.
    pub fn by(mut self, coordinate: Coordinate) -> Self {
        self.coordinate = coordinate;
        self
    }

    /// Give every body a random mass in this range, a centre of mass and a moment of inertia.
    pub fn weigh(&mut self, random: &mut Random, [low, high]: [f64; 2]) {
        let size = self.size();
        for body in &mut self.bodies {
            body.weigh(random.decades(low, high), 0.2 * size, random);
        }
    }

    /// The rate of the parameter that results from gravity over the mechanism's size, independent of its masses [1/s].
    pub fn own_motion(&self) -> f64 {
        (9.81 / self.size()).sqrt()
    }

    /// The largest distance between points of a body [m].
    pub fn size(&self) -> f64 {
        let lengths = self.bodies.iter().filter_map(|body| match body.frame {
            Frame::To(_, length) => Some(length),
            _ => None,
        });
        let ground = self.ground.iter().map(|(_, [x, y])| x.hypot(*y));
        lengths.chain(ground).fold(0.0, f64::max)
    }

    /// Reference value of its coordinate: a radian, or the size [m].
    pub fn scale(&self) -> f64 {
        if let Coordinate::Angle(_) = self.coordinate { 1.0 } else { self.size() }
    }

    /// The difference of two values of its coordinate, without whole turns.
    pub fn apart(&self, a: f64, b: f64) -> f64 {
        if let Coordinate::Angle(_) = self.coordinate { super::angle_apart(a, b) } else { a - b }
    }

    /// Poses of all bodies, from the positions of the points.
    pub fn poses(&self, places: &[Vector]) -> Vec<Pose> {
        let mut out: Vec<Pose> = Vec::new();
        for body in &self.bodies {
            let angle = match body.frame {
                Frame::To(end, _) => (places[end] - places[body.origin]).angle(),
                Frame::Fixed(angle) => angle.into(),
                Frame::With(other, angle) => out[other].angle + angle.into(),
            };
            out.push(Pose { origin: places[body.origin], angle });
        }
        out
    }

    /// Position of a point of a body's frame.
    pub fn at(pose: &Pose, local: [f64; 2]) -> Vector {
        pose.origin + Vector::fixed(local) * Vector::unit(pose.angle)
    }

    /// Position of a point in the frame of a body; None if the body has no such point.
    pub fn local(&self, body: Option<usize>, point: usize) -> Option<[f64; 2]> {
        let further = |points: &[(usize, [f64; 2])]| points.iter().find(|(own, _)| *own == point).map(|(_, at)| *at);
        let Some(body) = body.map(|body| &self.bodies[body]) else { return further(&self.ground) };
        match body.frame {
            _ if body.origin == point => Some([0.0; 2]),
            Frame::To(end, length) if end == point => Some([length, 0.0]),
            _ => further(&body.points),
        }
    }

    /// Largest distance between the closed form's points and those of the bodies, and between blocks and their guides,
    /// relative to the size; None where the closed form has no value.
    pub fn gap(&self, parameter: f64) -> Option<f64> {
        let places = (self.places)(Jet::variable(parameter)).ok()?;
        let poses = self.poses(&places);
        let length = |[x, y]: [f64; 2]| x.hypot(y);
        let mut gap = 0.0_f64;
        for (point, place) in places.iter().enumerate() {
            let on_bodies = poses.iter().enumerate();
            let ends = on_bodies.filter_map(|(k, pose)| Some(Self::at(pose, self.local(Some(k), point)?)));
            let ends = ends.chain(self.local(None, point).map(Vector::fixed));
            gap = ends.map(|end| length((end - *place).place())).fold(gap, f64::max);
        }
        for Slide { on, from, axis, block, .. } in &self.slides {
            let angle = on.map_or(Jet::default(), |body| poses[body].angle) + (*axis).into();
            let off = Vector::unit(angle).left().dot(poses[*block].origin - places[*from]);
            gap = gap.max(off.value().abs());
        }
        Some(gap / self.size())
    }

    /// Bodies that have a point; the ground first.
    fn owners(&self, point: usize) -> Vec<Option<usize>> {
        let bodies = std::iter::once(None).chain((0..self.bodies.len()).map(Some));
        bodies.filter(|&body| self.local(body, point).is_some()).collect()
    }

    /// The first body that has a point; None for the ground.
    pub fn owner(&self, point: usize) -> Option<usize> {
        self.owners(point).first().copied().flatten()
    }

    /// All joints: a pin where bodies share a point, then the slides.
    pub fn joints(&self) -> Vec<Joint> {
        let bodies = self.bodies.iter().flat_map(|body| {
            let end = if let Frame::To(end, _) = body.frame { Some(end) } else { None };
            [body.origin].into_iter().chain(end).chain(body.points.iter().map(|(point, _)| *point))
        });
        let mut points: Vec<usize> = bodies.collect();
        points.sort_unstable();
        points.dedup();
        let mut out = Vec::new();
        for point in points {
            let owners = self.owners(point);
            for other in owners.iter().skip(1) {
                let name = format!("pin{}", out.len());
                out.push(Joint { name, ends: [(owners[0], point), (*other, point)], slide: None });
            }
        }
        for (k, slide) in self.slides.iter().enumerate() {
            let block = (Some(slide.block), self.bodies[slide.block].origin);
            out.push(Joint { name: slide.name.clone(), ends: [(slide.on, slide.from), block], slide: Some(k) });
        }
        out
    }

    /// Value of a coordinate; for a slide the position of the block's origin along the axis, from the point of the
    /// guide.
    pub fn value(&self, coordinate: Coordinate, places: &[Vector], poses: &[Pose]) -> Jet {
        match coordinate {
            Coordinate::Angle(body) => poses[body].angle,
            Coordinate::Position(slide) => {
                let Slide { on, from, axis, block, .. } = self.slides[slide];
                let angle = on.map_or(Jet::default(), |body| poses[body].angle) + axis.into();
                Vector::unit(angle).dot(poses[block].origin - places[from])
            }
            Coordinate::Distance(place, point) => (places[point] - Vector::fixed(place)).norm(),
        }
    }

    /// Whether a body's rotation is independent of that of all bodies before it.
    pub fn turns(&self, body: usize) -> bool {
        matches!(self.bodies[body].frame, Frame::To(..))
    }

    /// Whether the positions in earlier slides determine that in this slide, as its bodies are connected by them.
    pub fn follows(&self, slide: usize) -> bool {
        let mut group: Vec<Option<usize>> = vec![self.slides[slide].on];
        for _ in 0..slide {
            for other in &self.slides[..slide] {
                match (group.contains(&other.on), group.contains(&Some(other.block))) {
                    (true, false) => group.push(Some(other.block)),
                    (false, true) => group.push(other.on),
                    _ => {}
                }
            }
        }
        group.contains(&Some(self.slides[slide].block))
    }
}

impl Body {
    /// Give it a mass, a centre of mass and a moment of inertia; a body without an end has this length.
    pub fn weigh(&mut self, mass: f64, length: f64, random: &mut Random) {
        self.mass = mass;
        let length = match self.frame {
            Frame::To(_, length) => {
                self.center = [length * random.within(0.2, 0.8), length * random.within(-0.1, 0.1)];
                length
            }
            _ => length,
        };
        self.inertia = mass * length * length * random.within(0.05, 0.15);
    }
}
