//! A random linkage in plain data: what the definition's text says and what the oracle reads, from one source.
//!
//! Bodies are posed first and joints placed in the plane afterwards, so that every loop closes by construction.
use crate::support::Vec2;
use serde_json::{Map, Value, json};
use std::fmt;

/// Index of the ground among the bodies.
pub const GROUND: usize = 0;

/// Mass [kg], centre [m] in the carrier's frame, moment of inertia about the centre [kg.m2].
#[derive(Clone, Copy)]
pub struct Mass {
    pub mass: f64,
    pub center: Vec2,
    pub inertia: f64,
}

/// A body with its pose at the start.
#[derive(Clone)]
pub struct Body {
    pub name: String,
    pub position: Vec2,
    pub angle: f64,
    pub mass: Mass,
    /// Distance from `origin` to `end` [m], where points of these names are used.
    pub length: Option<f64>,
    /// Named points in the body's frame [m].
    pub points: Vec<(String, Vec2)>,
}

/// A body without joints, rigidly attached to a point of another.
#[derive(Clone, Copy)]
pub struct Rider {
    pub to: Attachment,
    pub angle: f64,
    /// In its own frame.
    pub mass: Mass,
}

/// A named point of a body, by indices.
#[derive(Clone, Copy, PartialEq)]
pub struct Attachment {
    pub body: usize,
    pub point: usize,
}

/// Degree of freedom of a joint.
#[derive(Clone, Copy)]
pub enum Freedom {
    Revolute,
    /// Sliding along this direction in the first body's frame [rad], the second body turned by `angle` [rad],
    /// `position` [m] at the start.
    Prismatic {
        axis: f64,
        angle: f64,
        position: f64,
    },
}

#[derive(Clone, Copy)]
pub struct Joint {
    pub freedom: Freedom,
    pub first: Attachment,
    pub second: Attachment,
}

/// Sizes of the loads and where they act; constant.
#[derive(Clone, Copy)]
pub struct Loads {
    pub actuator: (Attachment, Attachment, f64),
    /// Acceleration of free fall, upward direction, load factor.
    pub gravity: (f64, f64, f64),
    pub force: (Attachment, Vec2),
    pub torque: (usize, f64),
}

/// The angle of a body, or the position of a prismatic joint.
#[derive(Clone, Copy, PartialEq)]
pub enum Coordinate {
    Angle(usize),
    Position(usize),
}

/// A linkage at its start.
#[derive(Clone)]
pub struct Linkage {
    pub kind: &'static str,
    pub bodies: Vec<Body>,
    pub joints: Vec<Joint>,
    pub rider: Rider,
    pub loads: Loads,
    pub start: (Coordinate, f64, f64),
    /// Added to each coordinate of the guess, in the order of [`Self::coordinates`].
    pub astray: Vec<f64>,
}

impl Linkage {
    pub fn joint_name(joint: usize) -> String {
        format!("j{joint}")
    }

    pub fn local(&self, at: Attachment) -> Vec2 {
        self.bodies[at.body].points[at.point].1
    }

    /// Whether a body can rotate: no chain of prismatic joints holds it to the ground.
    pub fn rotates(&self, body: usize) -> bool {
        let mut held = vec![false; self.bodies.len()];
        held[GROUND] = true;
        for _ in &self.bodies {
            for j in self.joints.iter().filter(|j| matches!(j.freedom, Freedom::Prismatic { .. })) {
                let both = held[j.first.body] || held[j.second.body];
                (held[j.first.body], held[j.second.body]) = (both, both);
            }
        }
        !held[body]
    }

    /// Angles of the bodies that rotate, positions of the prismatic joints.
    pub fn coordinates(&self) -> Vec<Coordinate> {
        let angles = (0..self.bodies.len()).filter(|&b| self.rotates(b)).map(Coordinate::Angle);
        let slides = (0..self.joints.len()).filter(|&j| matches!(self.joints[j].freedom, Freedom::Prismatic { .. }));
        angles.chain(slides.map(Coordinate::Position)).collect()
    }

    pub fn name(&self, coordinate: Coordinate) -> String {
        match coordinate {
            Coordinate::Angle(body) => self.bodies[body].name.clone(),
            Coordinate::Position(joint) => Self::joint_name(joint),
        }
    }

    /// Value of a coordinate in the pose of the bodies.
    pub fn value(&self, coordinate: Coordinate) -> f64 {
        match coordinate {
            Coordinate::Angle(body) => self.bodies[body].angle,
            Coordinate::Position(joint) => match self.joints[joint].freedom {
                Freedom::Prismatic { position, .. } => position,
                Freedom::Revolute => 0.0,
            },
        }
    }

    /// Name of a parameter of the start, `angle`, `position` or `speed`.
    pub fn start_name(&self, speed: bool) -> String {
        let quantity = match (speed, self.start.0) {
            (true, _) => "speed",
            (false, Coordinate::Angle(_)) => "angle",
            (false, Coordinate::Position(_)) => "position",
        };
        format!("{}.start_{quantity}", self.name(self.start.0))
    }

    fn text(&self, at: Attachment) -> String {
        let body = &self.bodies[at.body];
        format!("{}.{}", body.name, body.points[at.point].0)
    }

    /// The definition; every number is written so that it is read back exactly.
    pub fn json(&self) -> String {
        let mut bodies = Map::new();
        for (i, b) in self.bodies.iter().enumerate() {
            let mut body = json!({});
            if let Some(length) = b.length {
                body["length"] = json!(length);
            }
            let own = b.points.iter().filter(|(name, _)| name != "origin" && name != "end");
            body["points"] = own.map(|(name, p)| (name.clone(), json!([p.x, p.y]))).collect::<Map<_, _>>().into();
            if i != GROUND {
                add_mass(&mut body, b.mass);
            }
            bodies.insert(b.name.clone(), body);
        }
        let mut rider = json!({ "fixed_to": self.text(self.rider.to), "angle": self.rider.angle });
        add_mass(&mut rider, self.rider.mass);
        bodies.insert("rider".into(), rider);
        let joints: Map<String, Value> =
            self.joints.iter().enumerate().map(|(j, joint)| (Self::joint_name(j), self.joint(joint))).collect();
        let guess: Map<String, Value> = self
            .coordinates()
            .into_iter()
            .zip(&self.astray)
            .map(|(c, off)| (self.name(c), json!(self.value(c) + off)))
            .collect();
        let (coordinate, value, speed) = self.start;
        let start = match coordinate {
            Coordinate::Angle(_) => json!({ "body": self.name(coordinate), "angle": value, "speed": speed }),
            Coordinate::Position(_) => json!({ "joint": self.name(coordinate), "position": value, "speed": speed }),
        };
        let Loads { actuator: (a, b, push), gravity: (g, up, factor), force: (at, force), torque: (on, torque) } =
            self.loads;
        json!({
            "name": "Random",
            "description": self.kind,
            "gravity": { "acceleration": g, "up_angle": up, "load_factor": factor },
            "bodies": bodies,
            "joints": joints,
            "actuators": { "push": { "first": self.text(a), "second": self.text(b), "force": push } },
            "forces": { "pull": { "at": self.text(at), "force": [force.x, force.y] } },
            "torques": { "twist": { "on": self.bodies[on].name, "torque": torque } },
            "markers": { "mark": { "at": self.text(at) } },
            "start": start,
            "guess": guess,
            "snap": 0, "solver": { "tolerance": 1e-12 },
        })
        .to_string()
    }

    fn joint(&self, joint: &Joint) -> Value {
        let (first, second) = (self.text(joint.first), self.text(joint.second));
        match joint.freedom {
            Freedom::Revolute => json!({ "type": "revolute", "first": first, "second": second }),
            Freedom::Prismatic { axis, angle, .. } => {
                json!({ "type": "prismatic", "first": first, "second": second, "axis_angle": axis, "angle": angle })
            }
        }
    }
}

fn add_mass(body: &mut Value, mass: Mass) {
    body["mass"] = json!(mass.mass);
    body["center"] = json!([mass.center.x, mass.center.y]);
    body["inertia"] = json!(mass.inertia);
}

/// The text that reproduces it.
impl fmt::Debug for Linkage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.json())
    }
}
