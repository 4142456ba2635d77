//! The plain data of a linkage: written to a definition, or read from one without code of the engine.
use crate::support::{Vec2, turned};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
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
    /// Distance from `origin` to `end` [m], if these points are used.
    pub length: Option<f64>,
    /// Named points in the body's frame [m].
    pub points: Vec<(String, Vec2)>,
}

/// A body without joints, rigidly attached to a point of another.
#[derive(Clone, Copy)]
pub struct Rider {
    pub to: Attachment,
    pub angle: f64,
    /// In the frame of this body.
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
    /// Sliding along this direction in the frame of the first body [rad]. The second body is turned by `angle` [rad].
    /// The start position is `position` [m].
    Prismatic {
        axis: f64,
        angle: f64,
        position: f64,
    },
}

#[derive(Clone)]
pub struct Joint {
    pub name: String,
    pub freedom: Freedom,
    pub first: Attachment,
    pub second: Attachment,
}

/// Constant sizes of the loads, and their points of action.
#[derive(Clone, Default)]
pub struct Loads {
    /// Forces that push two points apart [N].
    pub pushes: Vec<(Attachment, Attachment, f64)>,
    /// Acceleration of free fall, upward direction, load factor.
    pub gravity: (f64, f64, f64),
    pub forces: Vec<(Attachment, Vec2)>,
    pub torques: Vec<(usize, f64)>,
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
    pub riders: Vec<Rider>,
    pub loads: Loads,
    pub start: (Coordinate, f64, f64),
    /// Added to each coordinate of the guess, in the order of [`Self::coordinates`].
    pub astray: Vec<f64>,
}

impl Linkage {
    pub fn local(&self, at: Attachment) -> Vec2 {
        self.bodies[at.body].points[at.point].1
    }

    /// Whether a body can rotate: no chain of prismatic joints connects it with the ground.
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
            Coordinate::Position(joint) => self.joints[joint].name.clone(),
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

    /// The definition. Every number is written so that it can be read back exactly.
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
        for own in &self.riders {
            let mut rider = json!({ "fixed_to": self.text(own.to), "angle": own.angle });
            add_mass(&mut rider, own.mass);
            bodies.insert("rider".into(), rider);
        }
        let joints: Map<String, Value> =
            self.joints.iter().map(|joint| (joint.name.clone(), self.joint(joint))).collect();
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
        let Loads { pushes, gravity: (g, up, factor), forces, torques } = &self.loads;
        let (&(a, b, push), &(at, force), &(on, torque)) = (&pushes[0], &forces[0], &torques[0]);
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

/// The text with which the case can be reproduced.
impl fmt::Debug for Linkage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.json())
    }
}

/// Frame of a body: index of the body that carries it, and position and angle in the frame of the carrier.
type Frame = (usize, Vec2, f64);

fn number(of: &Value, key: &str, default: f64) -> f64 {
    of.get(key).map_or(default, |value| value.as_f64().unwrap())
}

fn vector(of: &Value) -> Vec2 {
    let [x, y] = [0, 1].map(|axis| of[axis].as_f64().unwrap());
    Vec2::new(x, y)
}

/// Mass of a body, and its points including `origin` and `end`.
fn mass_and_points(body: &Value) -> (Mass, Vec<(String, Vec2)>) {
    let (mass, length) = (number(body, "mass", 0.0), number(body, "length", 0.0));
    let center = body.get("center").map_or(Vec2::zeros(), vector);
    let is_rod = body["shape"] == "uniform_rod";
    let mass = match is_rod {
        true => Mass { mass, center: Vec2::new(0.5 * length, 0.0), inertia: mass * length * length / 12.0 },
        false => Mass { mass, center, inertia: number(body, "inertia", 0.0) },
    };
    let mut points = vec![("origin".to_owned(), Vec2::zeros()), ("end".to_owned(), Vec2::new(length, 0.0))];
    let further = body["points"].as_object().into_iter().flatten();
    points.extend(further.map(|(name, point)| (name.clone(), vector(point))));
    (mass, points)
}

impl Linkage {
    /// The linkage of a definition in SI units without couplings, with its gravity and no other load.
    pub fn read(definition: &Value) -> Self {
        let group = |name: &str| definition[name].as_object().into_iter().flatten();
        let mut linkage = Self {
            kind: "read",
            bodies: Vec::new(),
            joints: Vec::new(),
            riders: Vec::new(),
            loads: Loads::default(),
            start: (Coordinate::Angle(GROUND), 0.0, 0.0),
            astray: Vec::new(),
        };
        let mut frames: BTreeMap<&str, Frame> = BTreeMap::new();
        let own = group("bodies").filter(|(_, body)| body.get("fixed_to").is_none());
        let (ground, moving): (Vec<_>, Vec<_>) = own.partition(|(name, _)| *name == "ground");
        for (name, body) in ground.into_iter().chain(moving) {
            let (mass, points) = mass_and_points(body);
            frames.insert(name, (linkage.bodies.len(), Vec2::zeros(), 0.0));
            let (name, position) = (name.clone(), Vec2::zeros());
            linkage.bodies.push(Body { name, position, angle: 0.0, mass, length: None, points });
        }
        // Riders may be fixed to riders. They are read from the bodies outward.
        while let Some((name, body)) = group("bodies").find(|(name, body)| {
            let to = body.get("fixed_to").and_then(|to| to.as_str().unwrap().split('.').next());
            !frames.contains_key(name.as_str()) && to.is_some_and(|to| frames.contains_key(to))
        }) {
            let to = linkage.point(body["fixed_to"].as_str().unwrap());
            let carrier = body["fixed_to"].as_str().unwrap().split('.').next().unwrap();
            let (at, angle) = (linkage.local(to), frames[carrier].2 + number(body, "angle", 0.0));
            let (mass, points) = mass_and_points(body);
            frames.insert(name, (to.body, at, angle));
            let placed =
                points.into_iter().map(|(point, local)| (format!("{name}.{point}"), at + turned(local, angle)));
            linkage.bodies[to.body].points.extend(placed);
            linkage.riders.push(Rider { to, angle, mass });
        }
        for (name, joint) in group("joints") {
            let [first, second] = ["first", "second"].map(|side| joint[side].as_str().unwrap());
            let turn = |of: &str| frames[of.split('.').next().unwrap()].2;
            let freedom = if joint["type"] == "revolute" {
                Freedom::Revolute
            } else {
                let (axis, angle) = (number(joint, "axis_angle", 0.0), number(joint, "angle", 0.0));
                let angle = angle + turn(first) - turn(second);
                Freedom::Prismatic { axis: axis + turn(first), angle, position: 0.0 }
            };
            let [first, second] = [first, second].map(|at| linkage.point(at));
            linkage.joints.push(Joint { name: name.clone(), freedom, first, second });
        }
        let gravity = &definition["gravity"];
        let of_gravity = ["acceleration", "up_angle"].map(|key| number(gravity, key, 0.0));
        linkage.loads.gravity = (of_gravity[0], of_gravity[1], number(gravity, "load_factor", 1.0));
        linkage
    }

    /// A point of a body or of a rider by its name.
    pub fn point(&self, name: &str) -> Attachment {
        let (of, own) = name.split_once('.').unwrap();
        let find = |body: usize, point: &str| self.bodies[body].points.iter().position(|(known, _)| known == point);
        let found = (0..self.bodies.len()).find_map(|body| {
            let point = if self.bodies[body].name == of { find(body, own) } else { find(body, name) };
            point.map(|point| Attachment { body, point })
        });
        found.unwrap_or_else(|| panic!("no point {name}"))
    }

    /// The body of this name, or the body that carries the rider of this name.
    pub fn body(&self, name: &str) -> usize {
        self.point(&format!("{name}.origin")).body
    }
}
