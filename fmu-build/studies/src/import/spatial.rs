//! A mechanism in space whose motion is in one plane, as robots' formats state it, and its projection to that plane.
//!
//! In: bodies and joints by places and directions in space. Out: the planar linkage. What does not move in one plane is
//! refused.

use super::planar::{Body, GROUND, Joint, Linkage, identifier};
use anyhow::{Result, bail};
use serde_json::{Value, json};

pub type Vector = [f64; 3];
/// A rotation by its columns: the axes of the turned frame.
pub type Rotation = [Vector; 3];

/// Largest part of a direction off the plane, or off the normal, that is rounding of the file.
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

/// A direction of length 1; none of a vector of length 0.
pub fn unit(a: Vector) -> Option<Vector> {
    let length = dot(a, a).sqrt();
    (length > 0.0).then(|| scaled(a, 1.0 / length))
}

pub fn turned(rotation: &Rotation, v: Vector) -> Vector {
    std::array::from_fn(|k| (0..3).map(|j| rotation[j][k] * v[j]).sum())
}

/// First `inner`, then `outer`.
pub fn after(outer: &Rotation, inner: &Rotation) -> Rotation {
    inner.map(|column| turned(outer, column))
}

pub const SAME: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Turn by an angle about an axis of length 1 (Rodrigues).
pub fn about(axis: Vector, angle: f64) -> Rotation {
    let (sin, cos) = angle.sin_cos();
    SAME.map(|e| add(add(scaled(e, cos), scaled(cross(axis, e), sin)), scaled(axis, dot(axis, e) * (1.0 - cos))))
}

/// A body in space at the position of the file.
#[derive(Clone, Debug, Default)]
pub struct Solid {
    pub name: String,
    /// Body to which it is fixed; none of one that joints hold.
    pub fixed_to: Option<usize>,
    pub place: Vector,
    pub mass: f64,
    pub center: Vector,
    /// Tensor of inertia about the centre, in the frame of space, by its columns.
    pub inertia: [Vector; 3],
}

/// A joint in space.
#[derive(Clone, Debug)]
pub struct Hinge {
    pub name: String,
    /// Bodies; 0 is the ground.
    pub first: usize,
    pub second: usize,
    pub place: Vector,
    /// Direction of the axis or of the slide; none of a connection of two points.
    pub axis: Option<Vector>,
    pub slides: bool,
    pub stiffness: f64,
    pub damping: f64,
    /// Value of the joint at which its spring is slack.
    pub free: f64,
    /// Least and largest value, from the position of the file.
    pub range: Option<[f64; 2]>,
    pub is_driven: bool,
}

/// A mechanism in space.
#[derive(Clone, Debug, Default)]
pub struct Space {
    pub name: String,
    /// The ground first.
    pub solids: Vec<Solid>,
    pub hinges: Vec<Hinge>,
    pub gravity: Vector,
    pub notes: Vec<String>,
}

/// Project to the plane of the motion.
///
/// # Errors
/// There is no joint; axes, slides and gravity are not those of one plane.
pub fn project(space: Space) -> Result<Linkage> {
    let [along, up, normal] = plane(&space)?;
    let flat = |v: Vector| [dot(v, along), dot(v, up)];
    let mut own = Linkage { name: identifier(&space.name, "Mechanism", &[]), ..Linkage::default() };
    own.notes = space.notes;
    // What is fixed to the ground is the ground.
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
    }
    let weight = dot(space.gravity, space.gravity).sqrt();
    if weight > 0.0 {
        if dot(space.gravity, normal).abs() > OFF * weight {
            own.notes.push("the component of gravity perpendicular to the plane of motion is left out".to_owned());
        }
        let [x, y] = flat(space.gravity);
        own.gravity = Some(x.hypot(y));
    }
    for hinge in &space.hinges {
        let ends = [hinge.first, hinge.second].map(|body| index_of[body]);
        add_hinge(&mut own, hinge, ends, normal, flat);
    }
    Ok(own)
}

/// Directions of x and y in the plane of the motion, y against the gravity, and the normal.
fn plane(space: &Space) -> Result<[Vector; 3]> {
    let turning = space.hinges.iter().filter(|hinge| !hinge.slides).find_map(|hinge| hinge.axis);
    let slides: Vec<Vector> = space.hinges.iter().filter(|hinge| hinge.slides).filter_map(|hinge| hinge.axis).collect();
    let across = || slides.iter().skip(1).find_map(|other| unit(cross(slides[0], *other)));
    let upward = unit(scaled(space.gravity, -1.0)).unwrap_or([0.0, 0.0, 1.0]);
    let beside = || slides.first().and_then(|slide| unit(cross(*slide, upward)));
    let Some(normal) = turning.or_else(across).or_else(beside) else {
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
    // y as far upward as it can be; where the plane lies flat, x and y are those of the file.
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

fn add_hinge(
    own: &mut Linkage,
    hinge: &Hinge,
    [first, second]: [usize; 2],
    normal: Vector,
    flat: impl Fn(Vector) -> [f64; 2],
) {
    let bodies = own.bodies.iter().map(|body| body.name.as_str());
    let taken: Vec<&str> = bodies.chain(own.joints.iter().map(|joint| joint.name.as_str())).collect();
    let name = identifier(&hinge.name, "joint", &taken);
    let place = flat(hinge.place);
    let axis = hinge.axis.filter(|_| hinge.slides).map(|axis| {
        let [x, y] = flat(axis);
        y.atan2(x)
    });
    // An axis against the normal counts the angle the other way round.
    let sign = match hinge.axis {
        Some(axis) if !hinge.slides && dot(axis, normal) < 0.0 => -1.0,
        _ => 1.0,
    };
    let index = own.joints.len();
    own.joints.push(Joint { name: name.clone(), first, second, place, axis });
    let all = |own: &Linkage| -> Vec<String> {
        let groups = [&own.springs, &own.stops].into_iter().flatten().map(|(name, _): &(String, Value)| name.clone());
        let named = own.bodies.iter().map(|body| body.name.clone()).chain(own.joints.iter().map(|j| j.name.clone()));
        named.chain(groups).chain(own.drives.iter().map(|(name, _)| name.clone())).collect()
    };
    let free_name = |own: &Linkage, wanted: String| {
        let taken = all(own);
        identifier(&wanted, "part", &taken.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let quantity = if hinge.slides { "length" } else { "angle" };
    if hinge.stiffness != 0.0 || hinge.damping != 0.0 {
        let mut spring = json!({ "joint": name, "stiffness": hinge.stiffness, "damping": hinge.damping });
        if hinge.stiffness != 0.0 {
            spring[format!("free_{quantity}")] = json!(sign * hinge.free);
        }
        let wanted = free_name(own, format!("{name}_spring"));
        own.springs.push((wanted, spring));
    }
    if let Some(range) = hinge.range {
        let mut ends = range.map(|value| sign * value);
        ends.sort_by(f64::total_cmp);
        let quantity = if hinge.slides { "position" } else { "angle" };
        for (limit, value) in ["lower", "upper"].into_iter().zip(ends).filter(|(_, value)| value.is_finite()) {
            let wanted = free_name(own, format!("{name}_{limit}"));
            own.stops.push((wanted, json!({ "joint": name, "limit": limit, quantity: value })));
        }
    }
    if hinge.is_driven {
        let wanted = free_name(own, format!("{name}_drive"));
        own.drives.push((wanted, index));
    }
}
