//! A mechanism in space with a planar motion, as in robot formats, and its projection to the plane.
//!
//! In: bodies and joints by positions and directions in space. Out: the planar linkage. A motion in more than one plane
//! is rejected.

use super::couple::{self, Ratio};
use super::planar::{Body, GROUND, Joint, Linkage, identifier};
use anyhow::{Result, bail, ensure};
use serde_json::{Value, json};
use std::f64::consts::TAU;

pub type Vector = [f64; 3];
/// A rotation by its columns: the axes of the rotated frame.
pub type Rotation = [Vector; 3];

/// Largest part of a direction off the plane or off the normal that counts as rounding of the file.
const OFF: f64 = 1e-6;

pub fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn add(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] + b[k])
}

pub fn scaled(a: Vector, factor: f64) -> Vector {
    a.map(|x| x * factor)
}

/// A unit vector in this direction. None for a vector of length 0.
pub fn unit(a: Vector) -> Option<Vector> {
    let length = dot(a, a).sqrt();
    (length > 0.0).then(|| scaled(a, 1.0 / length))
}

pub fn turned(rotation: &Rotation, v: Vector) -> Vector {
    std::array::from_fn(|k| (0..3).map(|j| rotation[j][k] * v[j]).sum())
}

/// The rotation `inner`, then `outer`.
pub fn after(outer: &Rotation, inner: &Rotation) -> Rotation {
    inner.map(|column| turned(outer, column))
}

pub const SAME: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Rotation by an angle about a unit vector (Rodrigues).
pub fn about(axis: Vector, angle: f64) -> Rotation {
    let (sin, cos) = angle.sin_cos();
    SAME.map(|e| add(add(scaled(e, cos), scaled(cross(axis, e), sin)), scaled(axis, dot(axis, e) * (1.0 - cos))))
}

/// A body in space at the position of the file.
#[derive(Clone, Debug, Default)]
pub struct Solid {
    pub name: String,
    /// Body to which it is fixed. None for a body with joints.
    pub fixed_to: Option<usize>,
    pub place: Vector,
    pub mass: f64,
    pub center: Vector,
    /// Tensor of inertia about the centre by its columns, in the global frame.
    pub inertia: [Vector; 3],
    /// Part of its weight that a force at its centre balances.
    pub lift: f64,
}

/// A linear spring with a damper: preload + stiffness (value - free) + damping rate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spring {
    /// Suffix of the name of the joint.
    pub suffix: &'static str,
    pub stiffness: f64,
    pub damping: f64,
    /// Value at which the force is the preload.
    pub free: f64,
    pub preload: f64,
}

/// A drive: its force at the start, and its controller.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drive {
    pub force: f64,
    pub control: Option<Control>,
}

/// Controller of a drive: force + position gain (command - value) + speed gain (commanded speed - rate), within limits.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    pub position_gain: Option<f64>,
    pub speed_gain: Option<f64>,
    /// Command at the start.
    pub command: f64,
    /// Smallest and largest force.
    pub limits: Option<[f64; 2]>,
}

/// Loads and limits along a coordinate: of a joint, relative to the position of the file, or the distance of two
/// points.
#[derive(Clone, Debug, Default)]
pub struct Acting {
    pub springs: Vec<Spring>,
    /// Smallest and largest value.
    pub range: Option<[f64; 2]>,
    pub drives: Vec<Drive>,
    /// Inertia of a rotor that only the rate of the coordinate moves.
    pub armature: f64,
    /// Constant friction that opposes the rate of the coordinate.
    pub friction: f64,
}

/// A joint in space.
#[derive(Clone, Debug, Default)]
pub struct Hinge {
    pub name: String,
    /// Bodies. 0 is the ground.
    pub first: usize,
    pub second: usize,
    pub place: Vector,
    /// Position on the second body, if it differs.
    pub other: Option<Vector>,
    /// Direction of the axis or of the slide. None for a connection of two points.
    pub axis: Option<Vector>,
    pub slides: bool,
    pub acting: Acting,
}

/// Loads and limits between two points of bodies.
#[derive(Clone, Debug)]
pub struct Strut {
    pub name: String,
    pub ends: [(usize, Vector); 2],
    pub acting: Acting,
}

/// A mechanism in space.
#[derive(Clone, Debug, Default)]
pub struct Space {
    pub name: String,
    /// Bodies. The first one is the ground.
    pub solids: Vec<Solid>,
    pub hinges: Vec<Hinge>,
    pub struts: Vec<Strut>,
    pub ratios: Vec<Ratio>,
    /// Markers: name, body, position.
    pub sites: Vec<(String, usize, Vector)>,
    pub gravity: Vector,
    pub notes: Vec<String>,
}

impl Control {
    /// The key `control` of a drive along a coordinate with this sign.
    fn value(&self, sign: f64) -> Value {
        let mut all = json!({});
        if let Some(gain) = self.position_gain {
            (all["position_gain"], all["command"]) = (json!(gain), json!(sign * self.command));
        }
        if let Some(gain) = self.speed_gain {
            all["speed_gain"] = json!(gain);
        }
        if let Some(limits) = self.limits {
            let mut limits = limits.map(|limit| sign * limit);
            limits.sort_by(f64::total_cmp);
            (all["min_force"], all["max_force"]) = (json!(limits[0]), json!(limits[1]));
        }
        all
    }
}

impl Space {
    /// Fix two bodies to each other, together with the bodies that are fixed to them.
    pub fn weld(&mut self, one: usize, other: usize) {
        let root = |mut body: usize| {
            while let Some(to) = self.solids[body].fixed_to {
                body = to;
            }
            body
        };
        let (one, other) = (root(one), root(other));
        if one != other {
            self.solids[one.max(other)].fixed_to = Some(one.min(other));
        }
    }
}

/// Project to the plane of the motion.
///
/// # Errors
/// There is no joint; axes, slides, struts and gravity do not lie in one plane; gears cannot represent a coupling.
pub fn project(space: Space) -> Result<Linkage> {
    let [along, up, normal] = plane(&space)?;
    // Rounding of rotated frames counts as 0.
    let flat = |v: Vector| [along, up].map(|axis| Some(dot(v, axis)).filter(|x| x.abs() > 1e-15).unwrap_or(0.0));
    let mut own = Linkage { name: identifier(&space.name, "Mechanism", &[]), ..Linkage::default() };
    own.notes = space.notes;
    let weight = flat(space.gravity);
    // Bodies that are fixed to the ground belong to the ground.
    let mut index_of: Vec<usize> = Vec::new();
    for (index, solid) in space.solids.iter().enumerate() {
        let fixed_to = solid.fixed_to.map(|to| index_of[to]);
        if fixed_to == Some(0) {
            index_of.push(0);
            continue;
        }
        index_of.push(own.bodies.len());
        let taken: Vec<&str> = own.bodies.iter().map(|body| body.name.as_str()).collect();
        let name = if index == 0 { GROUND.to_owned() } else { identifier(&solid.name, "body", &taken) };
        let inertia = dot(normal, turned(&solid.inertia, normal));
        let points = vec![if index == 0 { [0.0; 2] } else { flat(solid.place) }];
        let (mass, center) = (solid.mass, (solid.mass > 0.0).then(|| flat(solid.center)));
        let moves = index > 0;
        own.bodies.push(Body {
            name,
            points,
            mass: if moves { mass } else { 0.0 },
            center: center.filter(|_| moves),
            inertia: if moves { inertia } else { 0.0 },
            fixed_to,
            ..Body::default()
        });
        if moves && solid.lift * mass != 0.0 && weight != [0.0; 2] {
            let at = own.reference(own.bodies.len() - 1, flat(solid.center));
            let name = own.free_name(&format!("{}_lift", solid.name));
            let force = weight.map(|part| -solid.lift * mass * part);
            own.forces.push((name, json!({ "at": at, "force": force, "constant": true })));
        }
    }
    let size = dot(space.gravity, space.gravity).sqrt();
    if size > 0.0 {
        if dot(space.gravity, normal).abs() > OFF * size {
            own.notes.push("the component of gravity perpendicular to the plane of motion is left out".to_owned());
        }
        own.gravity = Some(weight[0].hypot(weight[1]));
    }
    let mut joints = Vec::new();
    for hinge in &space.hinges {
        let ends = [hinge.first, hinge.second].map(|body| index_of[body]);
        let gap = dot(add(hinge.other.unwrap_or(hinge.place), scaled(hinge.place, -1.0)), normal);
        ensure!(
            gap.abs() <= 1e-3,
            "the joint {} connects points that are {gap:.3} m apart across the plane of motion: move them into one \
                plane",
            hinge.name
        );
        joints.push(add_hinge(&mut own, hinge, ends, normal, flat)?);
    }
    couple::add(&mut own, &space.ratios, &joints)?;
    for strut in &space.struts {
        let between = add(strut.ends[0].1, scaled(strut.ends[1].1, -1.0));
        ensure!(
            dot(between, normal).abs() <= OFF * dot(between, between).sqrt(),
            "{} leaves the plane of motion: move its ends into one plane",
            strut.name
        );
        let [first, second] = strut.ends.map(|(body, place)| own.reference(index_of[body], flat(place)));
        let on = json!({ "first": first, "second": second });
        let name = own.free_name(&strut.name);
        act(&mut own, &name, &on, "length", &strut.acting, 1.0);
        if strut.acting.armature != 0.0 {
            let wanted = own.free_name(&format!("{name}_armature"));
            let screw = json!({ "lead": TAU, "inertia": strut.acting.armature });
            own.actuators.push((wanted, json!({ "first": first, "second": second, "screw": screw })));
        }
    }
    for (name, body, place) in &space.sites {
        let name = own.free_name(name);
        own.markers.push((name, index_of[*body], flat(*place)));
    }
    Ok(own)
}

/// Directions of x and y in the plane of the motion, with y against the gravity, and the normal.
fn plane(space: &Space) -> Result<[Vector; 3]> {
    let turning = space.hinges.iter().filter(|hinge| !hinge.slides).find_map(|hinge| hinge.axis);
    let slides: Vec<Vector> = space.hinges.iter().filter(|hinge| hinge.slides).filter_map(|hinge| hinge.axis).collect();
    let across = || slides.iter().skip(1).find_map(|other| unit(cross(slides[0], *other)));
    let upward = unit(scaled(space.gravity, -1.0)).unwrap_or([0.0, 0.0, 1.0]);
    let sideways = || slides.first().and_then(|slide| unit(cross(*slide, upward)));
    let Some(normal) = turning.or_else(across).or_else(sideways) else {
        bail!("no hinge or slide defines the plane of the motion: add a joint");
    };
    for hinge in &space.hinges {
        let Some(axis) = hinge.axis else { continue };
        let off =
            if hinge.slides { dot(axis, normal).abs() } else { dot(cross(axis, normal), cross(axis, normal)).sqrt() };
        if off > OFF {
            let what = if hinge.slides { "slides out of" } else { "does not turn in" };
            bail!(
                "the joint {} {what} the plane of the other joints: only planar mechanisms can be imported",
                hinge.name
            );
        }
    }
    // y is as far upward as possible. In a horizontal plane x and y are those of the file.
    let in_plane = |v: Vector| unit(add(v, scaled(normal, -dot(v, normal)))).filter(|_| dot(v, normal).abs() < 0.99);
    if let Some(up) = in_plane(upward) {
        let along = cross(up, normal);
        let is_forward = dot(along, [1.0, 0.5, 0.0]) >= 0.0;
        let (along, normal) = if is_forward { (along, normal) } else { (scaled(along, -1.0), scaled(normal, -1.0)) };
        return Ok([along, up, normal]);
    }
    let normal = if dot(normal, upward) < 0.0 { scaled(normal, -1.0) } else { normal };
    let along = in_plane([1.0, 0.0, 0.0]).unwrap_or([0.0, 1.0, 0.0]);
    Ok([along, cross(normal, along), normal])
}

/// Add a joint with its loads and limits. The sign is -1 if the axis points against the normal.
fn add_hinge(
    own: &mut Linkage,
    hinge: &Hinge,
    [first, second]: [usize; 2],
    normal: Vector,
    flat: impl Fn(Vector) -> [f64; 2],
) -> Result<Option<couple::Coordinate>> {
    if first == second {
        own.notes.push(format!("the joint {} is inside one rigid body and is left out", hinge.name));
        return Ok(None);
    }
    let name = own.free_name(&hinge.name);
    let place = flat(hinge.place);
    let axis = hinge.axis.filter(|_| hinge.slides).map(|axis| {
        let [x, y] = flat(axis);
        y.atan2(x)
    });
    // An axis against the normal reverses the sign of the angle.
    let sign = match hinge.axis {
        Some(axis) if !hinge.slides && dot(axis, normal) < 0.0 => -1.0,
        _ => 1.0,
    };
    let Acting { armature, friction, .. } = hinge.acting;
    let index = own.joints.len();
    let other = hinge.other.map(&flat).filter(|other| (0..2).any(|k| (other[k] - place[k]).abs() > 1e-12));
    own.joints.push(Joint { name: name.clone(), first, second, place, other, axis, armature, friction });
    let quantity = if hinge.slides { "position" } else { "angle" };
    act(own, &name, &json!({ "joint": name }), quantity, &hinge.acting, sign);
    Ok(Some(couple::Coordinate { joint: index, sign }))
}

/// Add springs, stops and drives along a coordinate with this sign.
fn act(own: &mut Linkage, name: &str, on: &Value, quantity: &str, acting: &Acting, sign: f64) {
    let with = |fields: Value| {
        let mut all = on.clone();
        fields.as_object().into_iter().flatten().for_each(|(key, value)| all[key.as_str()] = value.clone());
        all
    };
    for spring in
        acting.springs.iter().filter(|spring| **spring != Spring { suffix: spring.suffix, ..Spring::default() })
    {
        let mut value = json!({ "stiffness": spring.stiffness, "damping": spring.damping });
        if spring.stiffness != 0.0 {
            let word = if quantity == "angle" { "free_angle" } else { "free_length" };
            value[word] = json!(sign * spring.free);
        }
        if spring.preload != 0.0 {
            value["preload"] = json!(sign * spring.preload);
        }
        let wanted = own.free_name(&format!("{name}_{}", spring.suffix));
        own.springs.push((wanted, with(value)));
    }
    if let Some(range) = acting.range {
        let mut ends = range.map(|value| sign * value);
        ends.sort_by(f64::total_cmp);
        for (limit, value) in ["lower", "upper"].into_iter().zip(ends).filter(|(_, value)| value.is_finite()) {
            let wanted = own.free_name(&format!("{name}_{limit}"));
            own.stops.push((wanted, with(json!({ "limit": limit, quantity: value }))));
        }
    }
    for drive in &acting.drives {
        let wanted = own.free_name(&format!("{name}_drive"));
        let word = if quantity == "angle" { "torque" } else { "force" };
        let mut value = with(json!({ word: sign * drive.force }));
        if let Some(control) = &drive.control {
            value["control"] = control.value(sign);
        }
        own.actuators.push((wanted, value));
    }
}
