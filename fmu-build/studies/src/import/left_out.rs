//! What MJCF and URDF state and a definition has no place for: limits of drives, contact.
//!
//! In: the elements of a file. Out: notes. It must not know what is taken.

use super::elements::at;
use roxmltree::Node;

/// Drives of MJCF, which may have defaults.
const DRIVES: [&str; 10] =
    ["general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion", "dcmotor"];
/// Attributes of a drive of MJCF that bound it.
const BOUNDS: [&str; 4] = ["ctrlrange", "forcerange", "actrange", "lengthrange"];

/// Attributes of MJCF that a definition has no place for, by the elements that state them.
const ATTRIBUTES: [(&str, &[&str]); 6] = [
    ("option", &["density", "viscosity", "wind"]),
    ("body", &["gravcomp"]),
    ("geom", &["fluidshape"]),
    ("joint", &["margin", "solreflimit", "solimplimit"]),
    ("connect", &["solref", "solimp"]),
    ("weld", &["solref", "solimp"]),
];
/// Elements of joints of URDF that a definition has no place for.
const OF_JOINTS: [&str; 2] = ["safety_controller", "calibration"];

/// The attributes of MJCF that are left out: medium, softness of limits and connections, compensation of gravity.
pub fn of_attributes<'a>(root: Node<'a, 'a>) -> impl Iterator<Item = String> {
    root.descendants().filter_map(|node| {
        let (_, keys) = ATTRIBUTES.iter().find(|(tag, _)| node.has_tag_name(*tag))?;
        let stated: Vec<_> = keys.iter().copied().filter(|key| node.has_attribute(*key)).collect();
        (!stated.is_empty()).then(|| format!("{}: these attributes are left out: {}", at(node), stated.join(", ")))
    })
}

/// What is left out of a drive of MJCF, or of the defaults of drives.
pub fn of_drive(node: Node) -> Option<String> {
    let mut parts = Vec::new();
    // The first number is that of a joint with one coordinate; 1 changes nothing.
    let gear = node.attribute("gear").and_then(|gear| gear.split_whitespace().next());
    if let Some(gear) = gear.filter(|gear| gear.parse() != Ok(1.0)) {
        parts.push(format!(
            "gear {} (the input of the imported drive is the force or torque on the joint)",
            gear.escape_debug()
        ));
    }
    for key in BOUNDS {
        parts.extend(node.attribute(key).map(|value| format!("{key} {}", value.escape_debug())));
    }
    (!parts.is_empty()).then(|| format!("{}: these attributes are left out: {}", at(node), parts.join(", ")))
}

/// What is left out of the defaults of drives.
pub fn of_defaults<'a>(root: Node<'a, 'a>) -> impl Iterator<Item = String> {
    let sections = root.children().filter(|node| node.has_tag_name("default"));
    let drives =
        sections.flat_map(|section| section.descendants()).filter(|node| DRIVES.contains(&node.tag_name().name()));
    drives.filter_map(of_drive)
}

/// The contact between geoms of MJCF, where those of two bodies may touch.
pub fn contact(root: Node) -> Option<String> {
    let touches = |geom: &Node| ["contype", "conaffinity"].iter().any(|key| geom.attribute(*key) != Some("0"));
    let worlds = root.children().filter(|node| node.has_tag_name("worldbody"));
    let geoms = worlds.flat_map(|world| world.descendants()).filter(|node| node.has_tag_name("geom"));
    let mut touching = geoms.filter(touches);
    let first = touching.next()?;
    let other = touching.find(|geom| geom.parent() != first.parent())?;
    Some(format!(
        "contact between geoms, such as {} and {}, is left out: bodies of the imported mechanism can pass through each \
         other; add stops that end the travel",
        at(first),
        at(other)
    ))
}

/// The limits `effort` and `velocity` of the joints of URDF, and the shapes for collisions.
pub fn of_urdf(root: Node) -> Vec<String> {
    let named = |tag: &str, has: &dyn Fn(Node) -> bool| {
        let all = root.children().filter(|node| node.has_tag_name(tag) && has(*node));
        all.map(|node| node.attribute("name").unwrap_or_default().escape_debug().to_string()).collect::<Vec<_>>()
    };
    let mut notes = Vec::new();
    for (key, what) in [("effort", "force or torque"), ("velocity", "speed")] {
        let is_limited =
            |node: Node| node.children().any(|limit| limit.has_tag_name("limit") && limit.has_attribute(key));
        let joints = named("joint", &is_limited);
        if !joints.is_empty() {
            notes.push(format!("the limit {key} of {} is left out: the {what} is not limited", joints.join(", ")));
        }
    }
    for tag in OF_JOINTS {
        let joints = named("joint", &|node: Node| node.children().any(|inner| inner.has_tag_name(tag)));
        if !joints.is_empty() {
            notes.push(format!("<{tag}> of {} is left out", joints.join(", ")));
        }
    }
    let collides = |node: Node| node.children().any(|inner| inner.has_tag_name("collision"));
    let links = named("link", &collides);
    if links.len() > 1 {
        notes.push(format!("<collision> of {} is left out: these links can pass through each other", links.join(", ")));
    }
    notes
}
