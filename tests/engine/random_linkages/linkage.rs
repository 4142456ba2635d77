//! A random linkage in plain data: what the definition's text says and what the oracle reads, from one source.
//!
//! Bodies are posed first and joints placed in the plane afterwards, so that every loop closes by construction.
use nalgebra::Vector2;
use serde_json::{Map, Value, json};
use std::fmt;

pub type Vec2 = Vector2<f64>;

/// A vector turned by an angle [rad].
pub fn turned(a: Vec2, angle: f64) -> Vec2 {
    let (sin, cos) = angle.sin_cos();
    Vec2::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y)
}

/// Place of the ground among the bodies.
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
    pub to: Place,
    pub angle: f64,
    /// In its own frame.
    pub mass: Mass,
}

/// A named point of a body, by places.
#[derive(Clone, Copy, PartialEq)]
pub struct Place {
    pub body: usize,
    pub point: usize,
}

/// What a joint lets free.
#[derive(Clone, Copy)]
pub enum Freedom {
    Turn,
    /// Sliding along this direction in the first body's frame [rad], the second body turned by `angle` [rad], `position`
    /// [m] at the start.
    Slide {
        axis: f64,
        angle: f64,
        position: f64,
    },
}

#[derive(Clone, Copy)]
pub struct Joint {
    pub freedom: Freedom,
    pub first: Place,
    pub second: Place,
}

/// Sizes of the loads and where they act; constant.
#[derive(Clone, Copy)]
pub struct Loads {
    pub actuator: (Place, Place, f64),
    /// Acceleration of free fall, upward direction, load factor.
    pub gravity: (f64, f64, f64),
    pub force: (Place, Vec2),
    pub torque: (usize, f64),
}

/// The angle of a body, or the position of a prismatic joint.
#[derive(Clone, Copy, PartialEq)]
pub enum Coordinate {
    Turn(usize),
    Slide(usize),
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

    pub fn local(&self, place: Place) -> Vec2 {
        self.bodies[place.body].points[place.point].1
    }

    /// Whether a body can turn: no chain of prismatic joints holds it to the ground.
    pub fn revolutions(&self, body: usize) -> bool {
        let mut held = vec![false; self.bodies.len()];
        held[GROUND] = true;
        for _ in &self.bodies {
            for j in self.joints.iter().filter(|j| matches!(j.freedom, Freedom::Slide { .. })) {
                let both = held[j.first.body] || held[j.second.body];
                (held[j.first.body], held[j.second.body]) = (both, both);
            }
        }
        !held[body]
    }

    /// Angles of the bodies that turn, positions of the prismatic joints.
    pub fn coordinates(&self) -> Vec<Coordinate> {
        let revolutions = (0..self.bodies.len()).filter(|&b| self.revolutions(b)).map(Coordinate::Turn);
        let slides = (0..self.joints.len()).filter(|&j| matches!(self.joints[j].freedom, Freedom::Slide { .. }));
        revolutions.chain(slides.map(Coordinate::Slide)).collect()
    }

    pub fn name(&self, coordinate: Coordinate) -> String {
        match coordinate {
            Coordinate::Turn(body) => self.bodies[body].name.clone(),
            Coordinate::Slide(joint) => Self::joint_name(joint),
        }
    }

    /// Value of a coordinate in the pose of the bodies.
    pub fn value(&self, coordinate: Coordinate) -> f64 {
        match coordinate {
            Coordinate::Turn(body) => self.bodies[body].angle,
            Coordinate::Slide(joint) => match self.joints[joint].freedom {
                Freedom::Slide { position, .. } => position,
                Freedom::Turn => 0.0,
            },
        }
    }

    /// Name of a parameter of the start, `angle`, `position` or `speed`.
    pub fn start_name(&self, speed: bool) -> String {
        let quantity = match (speed, self.start.0) {
            (true, _) => "speed",
            (false, Coordinate::Turn(_)) => "angle",
            (false, Coordinate::Slide(_)) => "position",
        };
        format!("{}.start_{quantity}", self.name(self.start.0))
    }

    fn text(&self, place: Place) -> String {
        let body = &self.bodies[place.body];
        format!("{}.{}", body.name, body.points[place.point].0)
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
            Coordinate::Turn(_) => json!({ "body": self.name(coordinate), "angle": value, "speed": speed }),
            Coordinate::Slide(_) => json!({ "joint": self.name(coordinate), "position": value, "speed": speed }),
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
            "solver": { "tolerance": 1e-12 },
        })
        .to_string()
    }

    fn joint(&self, joint: &Joint) -> Value {
        let (first, second) = (self.text(joint.first), self.text(joint.second));
        match joint.freedom {
            Freedom::Turn => json!({ "type": "revolute", "first": first, "second": second }),
            Freedom::Slide { axis, angle, .. } => {
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
