//! A planar linkage from other programs: bodies given by points in one plane, and joints between them.
//!
//! In: points, joints, masses, loads. Out: the text of a definition with drawn bodies.

use anyhow::{Result, bail};
use linkage_fmu::format::Named;
use serde::Serialize;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// Name of the body that does not move.
pub const GROUND: &str = "ground";

/// A planar linkage at one position; lengths in m, angles in rad.
#[derive(Clone, Debug, Default)]
pub struct Linkage {
    pub name: String,
    /// Moving bodies. The first body is the ground.
    pub bodies: Vec<Body>,
    pub joints: Vec<Joint>,
    /// Gravity, which acts along -y. None without gravity.
    pub gravity: Option<f64>,
    /// Joints with a drive, by index.
    pub drives: Vec<(String, usize)>,
    /// Drives with all their keys.
    pub actuators: Vec<(String, Value)>,
    pub couplings: Vec<(String, Value)>,
    pub springs: Vec<(String, Value)>,
    pub stops: Vec<(String, Value)>,
    /// Start speed of the first drive, if its joint is on the ground [rad/s].
    pub start_speed: Option<f64>,
    pub forces: Vec<(String, Value)>,
    /// Markers: name, body, position.
    pub markers: Vec<(String, usize, [f64; 2])>,
    /// Notes about omitted and added parts of the file.
    pub notes: Vec<String>,
}

/// A rigid body whose frame is parallel to the mechanism frame at this position.
#[derive(Clone, Debug, Default)]
pub struct Body {
    pub name: String,
    /// Positions of its points. The first point is the origin of its frame.
    pub points: Vec<[f64; 2]>,
    pub mass: f64,
    pub center: Option<[f64; 2]>,
    /// Moment of inertia about the centre.
    pub inertia: f64,
    /// Whether it is a block in a slot, without mass.
    pub is_block: bool,
    /// Body to which it is fixed.
    pub fixed_to: Option<usize>,
}

/// A joint at a position.
#[derive(Clone, Debug, Default)]
pub struct Joint {
    pub name: String,
    /// Bodies, by index.
    pub first: usize,
    pub second: usize,
    pub place: [f64; 2],
    /// Position on the second body, if the two positions differ in the file.
    pub other: Option<[f64; 2]>,
    /// For a prismatic joint: sliding direction in the first body.
    pub axis: Option<f64>,
    /// Inertia of a rotor that only the motion of the joint moves.
    pub armature: f64,
    /// Constant friction.
    pub friction: f64,
}

/// A part of the definition, whose keys keep their order.
#[derive(Serialize)]
#[serde(untagged)]
enum Part {
    One(Value),
    Group(Named<Value>),
}

/// A valid and unused name: letters, digits and underscores, starting with a letter.
pub fn identifier(wanted: &str, fallback: &str, taken: &[&str]) -> String {
    let mut name: String = wanted.trim().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name = format!("{fallback}_{name}").trim_end_matches('_').to_owned();
    }
    name.truncate(150);
    let base = name.clone();
    let mut count = 2;
    while taken.contains(&name.as_str()) {
        name = format!("{base}_{count}");
        count += 1;
    }
    name
}

/// Replace each -0 by 0.
fn without_negative_zeros(value: &mut Value) {
    match value {
        Value::Number(number) if number.as_f64() == Some(0.0) && number.is_f64() => *value = json!(0.0),
        Value::Array(list) => list.iter_mut().for_each(without_negative_zeros),
        Value::Object(object) => object.values_mut().for_each(without_negative_zeros),
        _ => {}
    }
}

/// Path of a number that is not finite, which JSON cannot represent.
fn unnumbered(value: &Value) -> Option<String> {
    let within = |key: String, value: &Value| {
        let inner = unnumbered(value)?;
        Some(if inner.is_empty() { key } else { format!("{key}.{inner}") })
    };
    match value {
        Value::Null => Some(String::new()),
        Value::Array(items) => items.iter().enumerate().find_map(|(index, item)| within(index.to_string(), item)),
        Value::Object(fields) => fields.iter().find_map(|(key, field)| within(key.clone(), field)),
        _ => None,
    }
}

impl Linkage {
    /// Index of the point of a body at this position. A new point is added.
    pub fn point(&mut self, body: usize, place: [f64; 2]) -> usize {
        let points = &mut self.bodies[body].points;
        let known = points.iter().position(|other| (0..2).all(|k| (other[k] - place[k]).abs() <= 1e-12));
        known.unwrap_or_else(|| {
            points.push(place);
            points.len() - 1
        })
    }

    /// Names in use.
    pub fn names(&self) -> impl Iterator<Item = String> {
        let bodies = self.bodies.iter().map(|body| &body.name).chain(self.joints.iter().map(|joint| &joint.name));
        let groups = [&self.springs, &self.stops, &self.actuators, &self.couplings, &self.forces];
        let groups = groups.into_iter().flatten().map(|(name, _)| name);
        let drives = self.drives.iter().map(|(name, _)| name);
        let points = self.markers.iter().map(|(name, ..)| name);
        bodies.chain(groups).chain(drives).chain(points).cloned()
    }

    /// An unused name that is similar to the wanted one.
    pub fn free_name(&self, wanted: &str) -> String {
        let taken: Vec<String> = self.names().collect();
        identifier(wanted, "part", &taken.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// `body.point` of the point at this position.
    pub fn reference(&mut self, body: usize, place: [f64; 2]) -> String {
        let index = self.point(body, place);
        let name = &self.bodies[body].name;
        if index == 0 { format!("{name}.origin") } else { format!("{name}.p{index}") }
    }

    /// The start: body and angle, or joint and position, of a drive, else of a joint on the ground.
    fn start(&self) -> Value {
        let by_name = |value: &Value| self.joints.iter().position(|joint| value["joint"] == joint.name.as_str());
        let other = || self.actuators.iter().find_map(|(_, value)| by_name(value));
        let driven = self.drives.first().map(|(_, joint)| *joint).or_else(other);
        let grounded = self.joints.iter().position(|joint| joint.first == 0 || joint.second == 0);
        let Some(joint) = driven.or(grounded).map(|index| &self.joints[index]) else {
            return json!("equilibrium");
        };
        let mut start = match joint.axis {
            // The position of a prismatic joint is that of its second point, which is drawn at the first.
            Some(_) => json!({ "joint": joint.name, "position": 0.0 }),
            None => {
                let body = if joint.second == 0 { joint.first } else { joint.second };
                json!({ "body": self.bodies[body].name, "angle": 0.0 })
            }
        };
        if let (Some(speed), Some(_), None) = (self.start_speed.filter(|_| !self.is_massless()), driven, joint.axis) {
            start["speed"] = json!(speed);
        }
        start
    }

    /// Whether no body has a mass, so that only a prescribed motion can move the linkage.
    pub fn is_massless(&self) -> bool {
        let has_rotors = self.joints.iter().any(|joint| joint.armature > 0.0);
        !has_rotors && self.bodies.iter().all(|body| body.mass <= 0.0 && body.inertia <= 0.0)
    }

    /// A drive. Without masses the first drive has the start speed as its prescribed motion.
    fn drive(&self, index: usize) -> (String, Value) {
        let (name, joint) = &self.drives[index];
        let joint = &self.joints[*joint];
        let value = match (self.start_speed, joint.axis) {
            (Some(speed), None) if index == 0 && self.is_massless() => {
                json!({ "joint": joint.name, "motion": { "profile": "constant_speed", "speed": speed } })
            }
            _ if self.is_massless() => json!({ "joint": joint.name }),
            (_, Some(_)) => json!({ "joint": joint.name, "force": 0.0 }),
            (_, None) => json!({ "joint": joint.name, "torque": 0.0 }),
        };
        (name.clone(), value)
    }

    /// The text of the definition.
    ///
    /// # Errors
    /// A number is not finite, such as the inertia of a body with a length of 1e200 m.
    pub fn definition(&self) -> Result<String> {
        let mut own = self.clone();
        // Bodies with open joints at this position cannot be drawn: they are assembled from their angles here.
        let is_drawn = own.joints.iter().all(|joint| joint.other.is_none());
        let joints: Vec<(String, Value)> = own.joints.clone().into_iter().map(|joint| own.joint(joint)).collect();
        let markers = own.markers.clone().into_iter().map(|(name, body, place)| {
            let at = own.reference(body, place);
            (name, json!({ "at": at }))
        });
        let markers: Vec<(String, Value)> = markers.collect();
        let fixed: Vec<(usize, usize)> =
            own.bodies.iter().enumerate().filter_map(|(index, body)| Some((index, body.fixed_to?))).collect();
        let fixed: Vec<(usize, String)> = fixed
            .into_iter()
            .map(|(body, to)| {
                let place = own.bodies[body].points.first().copied().unwrap_or_default();
                (body, own.reference(to, place))
            })
            .collect();
        let bodies = own.bodies.iter().enumerate().map(|(index, body)| {
            let to = fixed.iter().find(|(fixed, _)| *fixed == index).map(|(_, to)| to.as_str());
            (body.name.clone(), body.value(to, is_drawn))
        });
        let bodies: Vec<(String, Value)> = bodies.collect();
        let mut parts = vec![("name".to_owned(), Part::One(json!(own.name)))];
        if let Some(gravity) = own.gravity {
            parts.push(("gravity".to_owned(), Part::One(json!({ "acceleration": gravity, "up_angle": FRAC_PI_2 }))));
        }
        let groups = [
            ("bodies", bodies),
            ("joints", joints),
            ("couplings", own.couplings.clone()),
            ("actuators", (0..self.drives.len()).map(|index| self.drive(index)).chain(own.actuators.clone()).collect()),
            ("forces", own.forces.clone()),
            ("springs", own.springs.clone()),
            ("stops", own.stops.clone()),
            ("markers", markers),
        ];
        for (key, group) in groups {
            if !group.is_empty() {
                parts.push((key.to_owned(), Part::Group(group.into_iter().collect())));
            }
        }
        parts.push(("start".to_owned(), Part::One(self.start())));
        if !is_drawn {
            let turning = own.bodies.iter().skip(1).filter(|body| body.fixed_to.is_none()).map(|body| &body.name);
            let sliding = self.joints.iter().filter(|joint| joint.axis.is_some()).map(|joint| &joint.name);
            let guess: Named<Value> = turning.chain(sliding).map(|name| (name.clone(), json!(0.0))).collect();
            parts.push(("guess".to_owned(), Part::Group(guess)));
        }
        let mut parts: Named<Part> = parts.into_iter().collect();
        for (_, part) in parts.iter_mut() {
            match part {
                Part::One(value) => without_negative_zeros(value),
                Part::Group(group) => group.iter_mut().for_each(|(_, value)| without_negative_zeros(value)),
            }
        }
        if let Some(key) = unnumbered(&serde_json::to_value(&parts)?) {
            bail!(
                "{key} is not finite, because lengths, masses or forces of the file are too large; use larger units in \
                 the file"
            );
        }
        Ok(serde_json::to_string_pretty(&parts)? + "\n")
    }

    fn joint(&mut self, joint: Joint) -> (String, Value) {
        let first = self.reference(joint.first, joint.place);
        let second = self.reference(joint.second, joint.other.unwrap_or(joint.place));
        let mut value = match joint.axis {
            Some(0.0) => json!({ "type": "prismatic", "first": first, "second": second }),
            Some(axis) => json!({ "type": "prismatic", "first": first, "second": second, "axis_angle": axis }),
            None => json!({ "type": "revolute", "first": first, "second": second }),
        };
        for (key, size) in [("armature", joint.armature), ("frictionloss", joint.friction)] {
            if size != 0.0 {
                value[key] = json!(size);
            }
        }
        (joint.name, value)
    }
}

impl Body {
    /// The body in the form of the definition.
    fn value(&self, fixed_to: Option<&str>, is_drawn: bool) -> Value {
        let named = |from: usize, origin: [f64; 2]| -> Value {
            let points = self.points.iter().enumerate().skip(from);
            let place = |p: &[f64; 2]| json!([p[0] - origin[0], p[1] - origin[1]]);
            points.map(|(index, p)| (format!("p{index}"), place(p))).collect::<serde_json::Map<_, _>>().into()
        };
        let mut value = json!({});
        if self.name == GROUND {
            if self.points.len() > 1 {
                value["points"] = named(1, [0.0; 2]);
            }
            return value;
        }
        let origin = self.points.first().copied().unwrap_or_default();
        if self.mass > 0.0 {
            value["mass"] = json!(self.mass);
        }
        if self.inertia > 0.0 {
            value["inertia"] = json!(self.inertia);
        }
        if let Some(to) = fixed_to {
            value["fixed_to"] = json!(to);
        }
        if !is_drawn {
            if self.points.len() > 1 {
                value["points"] = named(1, origin);
            }
            if let Some(center) = self.center {
                value["center"] = json!([center[0] - origin[0], center[1] - origin[1]]);
            }
            return value;
        }
        value["drawn"] = json!({ "origin": origin });
        if self.points.len() > 1 {
            value["drawn"]["points"] = named(1, [0.0; 2]);
        }
        if let Some(center) = self.center {
            value["drawn"]["center"] = json!(center);
        }
        value
    }
}
