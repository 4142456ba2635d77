//! ROS's URDF as a mechanism in space.
//!
//! In: XML. Out: bodies and joints in space. They form a tree, without loops except by `mimic`.

use super::couple::Ratio;
use super::masses::{Part, in_space, symmetric};
use super::spatial::{Acting, Drive, Hinge, Rotation, SAME, Solid, Space, Spring, Vector};
use super::spatial::{about, add, after, turned, unit};
use super::xml::{Element, Row, table, unread};
use anyhow::{Context, Result, bail, ensure};
use std::sync::LazyLock;

/// A position and a rotation in space.
pub type Frame = (Vector, Rotation);

/// Treatment of each element and attribute.
pub static TABLE: LazyLock<Vec<Row>> = LazyLock::new(|| table(include_str!("urdf.json")));

/// A mechanism in URDF.
///
/// # Errors
/// The text is no URDF, or contains xacro elements; a joint is not planar.
pub fn of_urdf(name: &str, text: &str) -> Result<Space> {
    read(name, &Element::parse(text, "")?)
}

/// The mechanism of a document.
///
/// # Errors
/// As for a text.
pub fn read(name: &str, root: &Element) -> Result<Space> {
    ensure!(root.tag == "robot", "{}: the first element of a URDF file must be <robot>", root.at());
    if let Some(macro_) = xacro(root) {
        bail!(
            "{}: this is a file of xacro, not yet URDF: write the URDF with `xacro FILE > robot.urdf` (`pip install \
             xacro`), and import that file",
            macro_.at()
        );
    }
    let mut space = Space { name: root.get("name").unwrap_or(name).to_owned(), ..Space::default() };
    space.gravity = [0.0, 0.0, -9.81];
    space.notes.push("URDF has no gravity: 9.81 m/s2 along -z is added".to_owned());
    let joints: Vec<&Element> = root.all("joint").collect();
    let of = |node: &Element, key: &'static str| -> Result<String> {
        let name = node.child(key).and_then(|child| child.get("link"));
        Ok(name.with_context(|| format!("{}: the element <{key}> is missing: add this element", node.at()))?.to_owned())
    };
    let ends: Vec<(String, String)> =
        joints.iter().map(|joint| Ok((of(joint, "parent")?, of(joint, "child")?))).collect::<Result<_>>()?;
    let links: Vec<&Element> = root.all("link").collect();
    let is_base = |link: &&&Element| ends.iter().all(|(_, child)| link.get("name") != Some(child));
    let base = links.iter().find(is_base).context(
        "every link is moved by a joint, so there is no ground link: add a \
        link that no joint moves",
    )?;
    space.notes.push(format!("the link {} becomes the body ground", base.get("name").unwrap_or_default()));
    space.solids.push(Solid::default());
    // The mass of the ground has no effect, but is checked.
    mass(base, ([0.0; 3], SAME))?;
    let mut known = vec![(base.get("name").unwrap_or_default().to_owned(), ([0.0; 3], SAME))];
    let mut left: Vec<usize> = (0..joints.len()).collect();
    let mut followers = Vec::new();
    while let Some(next) = left.iter().position(|&joint| known.iter().any(|(name, _)| *name == ends[joint].0)) {
        let index = left.remove(next);
        let (joint, (parent, child_name)) = (joints[index], &ends[index]);
        let first = known.iter().position(|(name, _)| name == parent).unwrap_or_default();
        let frame = origin(joint, known[first].1)?;
        let kind = joint.get("type").unwrap_or_default();
        let is_fixed = kind == "fixed";
        let link = links.iter().find(|link| link.get("name") == Some(child_name));
        let link = link.with_context(|| format!("{}: there is no link {child_name}; correct the name", joint.at()))?;
        let mut solid = Solid { name: child_name.clone(), place: frame.0, ..Solid::default() };
        solid.fixed_to = is_fixed.then_some(first);
        (solid.mass, solid.center, solid.inertia) = mass(link, frame)?;
        space.solids.push(solid);
        known.push((child_name.clone(), frame));
        if !is_fixed {
            if let Some(mimic) = joint.child("mimic") {
                followers.push((space.hinges.len(), mimic));
            }
            space.hinges.push(hinge(joint, kind, (first, known.len() - 1), frame)?);
        } else {
            // In many files a fixed joint has a name, an axis and limits, without effect.
            joint.get("name");
            for (tag, key) in [("axis", "xyz"), ("limit", "lower"), ("limit", "upper"), ("dynamics", "damping")] {
                joint.child(tag).and_then(|child| child.get(key));
            }
        }
    }
    if let Some(&lost) = left.first() {
        bail!(
            "{}: the parent link of this joint is not connected to the other links: connect the parent link by a \
            joint",
            joints[lost].at()
        );
    }
    for (first, mimic) in followers {
        let name = mimic.get("joint").unwrap_or_default();
        let found = space.hinges.iter().position(|hinge| hinge.name == name);
        let second =
            found.with_context(|| format!("{}: there is no moving joint {name}; correct the name", mimic.at()))?;
        let ratio = mimic.one("multiplier")?.unwrap_or(1.0);
        let offset = mimic.one("offset")?.unwrap_or(0.0);
        space.ratios.push(Ratio { first, second, ratio, offset });
        space.hinges[first].acting.drives.clear();
    }
    space.notes.extend(unread(root, &TABLE, &str::to_owned)?);
    Ok(space)
}

/// The first element of xacro.
fn xacro(node: &Element) -> Option<&Element> {
    node.children.iter().find_map(|child| if child.tag.starts_with("xacro:") { Some(child) } else { xacro(child) })
}

/// Frame of an `<origin>` by xyz and rpy.
fn origin(node: &Element, (place, rotation): Frame) -> Result<Frame> {
    let Some(origin) = node.child("origin") else { return Ok((place, rotation)) };
    let own = origin.fixed("xyz")?.unwrap_or([0.0; 3]);
    let angles = origin.fixed("rpy")?.unwrap_or([0.0; 3]);
    Ok((add(place, turned(&rotation, own)), after(&rotation, &of_angles(angles))))
}

/// Rotation by roll, pitch and yaw about fixed axes.
pub fn of_angles([roll, pitch, yaw]: [f64; 3]) -> Rotation {
    after(&about(SAME[2], yaw), &after(&about(SAME[1], pitch), &about(SAME[0], roll)))
}

fn mass(link: &Element, frame: Frame) -> Result<Part> {
    let Some(inertial) = link.child("inertial") else { return Ok((0.0, [0.0; 3], [[0.0; 3]; 3])) };
    let (center, rotation) = origin(inertial, frame)?;
    let mass = inertial.child("mass").map(|mass| mass.one("value")).transpose()?.flatten().unwrap_or(0.0);
    let Some(inertia) = inertial.child("inertia") else { return Ok((mass, center, [[0.0; 3]; 3])) };
    let mut all = [0.0; 6];
    for (own, key) in all.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
        *own = inertia.one(key)?.unwrap_or(0.0);
    }
    Ok((mass, center, in_space(&rotation, &symmetric(all))))
}

fn hinge(node: &Element, kind: &str, (first, second): (usize, usize), frame: Frame) -> Result<Hinge> {
    let slides = match kind {
        "revolute" | "continuous" => false,
        "prismatic" => true,
        other => bail!("{}: a joint of the type {other} is not supported; use revolute or prismatic", node.at()),
    };
    let axis = node.child("axis").map(|axis| axis.fixed("xyz")).transpose()?.flatten().unwrap_or([1.0, 0.0, 0.0]);
    let axis = unit(axis)
        .with_context(|| format!("{}: the vector of the axis is zero: write the direction of the axis", node.at()))?;
    let dynamics = |key: &'static str| -> Result<f64> {
        Ok(node.child("dynamics").map(|dynamics| dynamics.one(key)).transpose()?.flatten().unwrap_or(0.0))
    };
    let (damping, friction) = (dynamics("damping")?, dynamics("friction")?);
    let range = match node.child("limit") {
        Some(limit) => {
            let range = [limit.one("lower")?.unwrap_or(0.0), limit.one("upper")?.unwrap_or(0.0)];
            if kind == "continuous" { None } else { Some(node.ascending("<limit>", range)?) }
        }
        None => None,
    };
    let springs = vec![Spring { suffix: "spring", damping, ..Spring::default() }];
    Ok(Hinge {
        name: node.get("name").map_or_else(|| format!("joint_{second}"), str::to_owned),
        first,
        second,
        place: frame.0,
        axis: Some(turned(&frame.1, axis)),
        slides,
        acting: Acting { springs, range, drives: vec![Drive::default()], friction, ..Acting::default() },
        ..Hinge::default()
    })
}
