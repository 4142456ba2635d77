//! Gazebo's SDF as a mechanism in space, with its closed loops.
//!
//! In: XML of one model, alone or in a world. Out: bodies and joints in space.

use super::couple::Ratio;
use super::masses::{Part, in_space, symmetric};
use super::spatial::{Acting, Drive, Hinge, SAME, Solid, Space, Spring, add, after, turned, unit};
use super::urdf::{Frame, of_angles};
use super::xml::{Element, Row, rejected, table, unread};
use anyhow::{Context, Result, bail, ensure};
use std::sync::LazyLock;

/// Limits of at least this size are no limits.
const ENDLESS: f64 = 1e16;
/// Largest number of frames that are stated relative to one another.
const DEEPEST: usize = 100;

/// Treatment of each element and attribute.
pub static TABLE: LazyLock<Vec<Row>> = LazyLock::new(|| table(include_str!("sdf.json")));

struct Model<'a> {
    root: &'a Element,
    frame: Frame,
}

/// A mechanism in SDF.
///
/// # Errors
/// The text is no SDF with one moving model, or a joint is not planar.
pub fn of_sdf(name: &str, text: &str) -> Result<Space> {
    read(name, &Element::parse(text, "")?)
}

/// The mechanism of a document.
///
/// # Errors
/// As for a text.
pub fn read(name: &str, root: &Element) -> Result<Space> {
    ensure!(root.tag == "sdf", "{}: SDF starts with <sdf>", root.at());
    rejected(root, &TABLE, &str::to_owned)?;
    let world = root.child("world");
    let models: Vec<&Element> = root.all("model").chain(world.iter().flat_map(|world| world.all("model"))).collect();
    let is_static =
        |model: &&&Element| model.child("static").is_some_and(|own| matches!(own.text.as_str(), "true" | "1"));
    let mut moving = models.iter().filter(|model| !is_static(model));
    let model = moving.next().context(
        "there is no <model> that moves, so there is no mechanism: add a model that is \
        not static",
    )?;
    if let Some(other) = moving.next() {
        bail!("{}: this is a second model that moves: keep one model in the file", other.at());
    }
    let own = Model { root: model, frame: pose(model)?.unwrap_or(([0.0; 3], SAME)) };
    let mut space = Space { name: model.get("name").unwrap_or(name).to_owned(), ..Space::default() };
    let gravity = world.map(|world| world.inner("gravity")).transpose()?.flatten();
    space.gravity = gravity.unwrap_or([0.0, 0.0, -9.81]);
    if gravity.is_none() {
        space.notes.push("the file states no gravity: 9.81 m/s2 along -z is added".to_owned());
    }
    let joints: Vec<&Element> = model.all("joint").collect();
    let mut links: Vec<&Element> = model.all("link").collect();
    let of = |node: &Element, key: &'static str| -> Result<String> {
        let text = node.child(key).map(|child| child.text.clone());
        text.with_context(|| format!("{}: the element <{key}> is missing: add this element", node.at()))
    };
    let link = |node: &Element, key: &'static str| own.link_of(&of(node, key)?, 0).with_context(|| node.at());
    let ends = |node: &Element| -> Result<[String; 2]> { Ok([link(node, "parent")?, link(node, "child")?]) };
    let named: Vec<[String; 2]> = joints.iter().map(|joint| ends(joint)).collect::<Result<_>>()?;
    let mut names = vec!["world".to_owned()];
    let canonical = model.get("canonical_link");
    if !named.iter().flatten().any(|name| name == "world") {
        let at = links.iter().position(|link| canonical.is_none() || link.get("name") == canonical);
        let ground = links.remove(at.context("the model has no link: add the links of the mechanism")?);
        names = vec![ground.get("name").unwrap_or_default().to_owned()];
        space.notes.push(format!("no joint is on the world: the link {} becomes the body ground", names[0]));
        mass(ground, own.pose_of(&names[0], 0)?)?;
    }
    space.solids.push(Solid::default());
    for link in links {
        let name = link.get("name").unwrap_or_default().to_owned();
        let frame = own.pose_of(&name, 0)?;
        let (mass, center, inertia) = mass(link, frame)?;
        let floats = link.child("gravity").is_some_and(|own| matches!(own.text.as_str(), "false" | "0"));
        let lift = if floats { 1.0 } else { 0.0 };
        space.solids.push(Solid { name: name.clone(), fixed_to: None, place: frame.0, mass, center, inertia, lift });
        names.push(name);
    }
    let mut followers = Vec::new();
    for (joint, ends) in joints.iter().zip(&named) {
        let index = |name: &String| {
            let found = names.iter().position(|own| own == name);
            found.with_context(|| format!("{}: there is no link {name}; correct the name", joint.at()))
        };
        let [first, second] = [index(&ends[0])?, index(&ends[1])?];
        if joint.is("type", "fixed") {
            space.weld(first, second);
            continue;
        }
        if let Some(mimic) = joint.child("axis").and_then(|axis| axis.child("mimic")) {
            followers.push((space.hinges.len(), mimic));
        }
        space.hinges.push(own.hinge(joint, [first, second])?);
    }
    for (first, mimic) in &followers {
        let name = mimic.get("joint").unwrap_or_default();
        mimic.get("axis");
        let found = space.hinges.iter().position(|hinge| hinge.name == name);
        let second =
            found.with_context(|| format!("{}: there is no moving joint {name}; correct the name", mimic.at()))?;
        let part = |key: &'static str, absent: f64| -> Result<f64> {
            Ok(mimic.inner::<1>(key)?.map_or(absent, |[value]| value))
        };
        let (ratio, reference) = (part("multiplier", 1.0)?, part("reference", 0.0)?);
        let offset = part("offset", 0.0)? - ratio * reference;
        space.ratios.push(Ratio { first: *first, second, ratio, offset });
    }
    let is_follower = |at: usize| followers.iter().any(|(follower, _)| *follower == at);
    let on_ground = |at: &usize| space.hinges[*at].first.min(space.hinges[*at].second) == 0;
    let driven = (0..space.hinges.len()).filter(on_ground).find(|at| !is_follower(*at));
    if let Some(hinge) = driven.map(|at| &mut space.hinges[at]) {
        hinge.acting.drives.push(Drive::default());
        space.notes.push(format!("the file names no drive: the import adds a drive in the joint {}", hinge.name));
    }
    space.notes.extend(unread(root, &TABLE, &str::to_owned)?);
    Ok(space)
}

/// The pose of an element, relative to its reference frame.
fn pose(node: &Element) -> Result<Option<Frame>> {
    let Some(child) = node.child("pose") else { return Ok(None) };
    if child.is("rotation_format", "quat_xyzw") {
        return Ok(node.inner("pose")?.map(|[x, y, z, a, b, c, w]| {
            let half = (a * a + b * b + c * c).sqrt();
            let turn = unit([a, b, c]).map_or(SAME, |axis| super::spatial::about(axis, 2.0 * half.atan2(w)));
            ([x, y, z], turn)
        }));
    }
    let unit = if child.is("degrees", "true") { f64::to_radians } else { |angle: f64| angle };
    let stated = node.inner("pose")?;
    Ok(stated.map(|[x, y, z, roll, pitch, yaw]| ([x, y, z], of_angles([roll, pitch, yaw].map(unit)))))
}

fn placed(outer: Frame, inner: Frame) -> Frame {
    (add(outer.0, turned(&outer.1, inner.0)), after(&outer.1, &inner.1))
}

impl Model<'_> {
    /// Frame in space of a link, joint or frame of the model by its name.
    fn pose_of(&self, name: &str, depth: usize) -> Result<Frame> {
        ensure!(
            depth < DEEPEST,
            "the poses of the frame {name} refer to each other in a circle: correct \
            `relative_to`"
        );
        match name {
            "world" => return Ok(([0.0; 3], SAME)),
            "" | "__model__" => return Ok(self.frame),
            _ => {}
        }
        let is_frame = |node: &&Element| matches!(node.tag.as_str(), "link" | "joint" | "frame");
        let found = self.root.children.iter().filter(is_frame).find(|node| node.get("name") == Some(name));
        let node = found.with_context(|| format!("there is no link, joint or frame {name}; correct the name"))?;
        // A joint is in the frame of its child, a frame in that to which it is attached.
        let absent = match node.tag.as_str() {
            "joint" => node.child("child").map_or("", |child| child.text.as_str()),
            "frame" => node.get("attached_to").unwrap_or(""),
            _ => "",
        };
        let stated = node.child("pose").and_then(|pose| pose.get("relative_to")).filter(|name| !name.is_empty());
        let outer = self.pose_of(stated.unwrap_or(absent), depth + 1).with_context(|| node.at())?;
        Ok(placed(outer, pose(node)?.unwrap_or(([0.0; 3], SAME))))
    }

    /// The link to which a link, frame or model frame is fixed, or the world.
    fn link_of(&self, name: &str, depth: usize) -> Result<String> {
        ensure!(depth < DEEPEST, "the frame {name} is attached to itself: correct `attached_to`");
        let canonical = || {
            let first = self.root.child("link").and_then(|link| link.get("name"));
            self.root.get("canonical_link").filter(|name| !name.is_empty()).or(first).unwrap_or_default()
        };
        match self.root.all("frame").find(|frame| frame.get("name") == Some(name)) {
            Some(frame) => self.link_of(frame.get("attached_to").unwrap_or(""), depth + 1),
            None if matches!(name, "" | "__model__") => Ok(canonical().to_owned()),
            None => Ok(name.to_owned()),
        }
    }

    fn hinge(&self, node: &Element, [first, second]: [usize; 2]) -> Result<Hinge> {
        let kind = node.get("type").unwrap_or_default();
        let slides = match kind {
            "revolute" | "continuous" => false,
            "prismatic" => true,
            other => bail!("{}: a joint of the type {other} is not supported; use revolute or prismatic", node.at()),
        };
        let name = node.get("name").unwrap_or_default();
        let frame = self.pose_of(name, 0)?;
        let axis = node
            .child("axis")
            .with_context(|| format!("{}: the element <axis> is missing: add this element", node.at()))?;
        let direction = axis.inner("xyz")?.unwrap_or([0.0, 0.0, 1.0]);
        let direction = unit(direction).with_context(|| {
            format!("{}: the vector of the axis is zero: write the direction of the axis", node.at())
        })?;
        let in_model =
            axis.child("use_parent_model_frame").is_some_and(|own| matches!(own.text.as_str(), "true" | "1"));
        let expressed = axis.child("xyz").and_then(|xyz| xyz.get("expressed_in")).filter(|name| !name.is_empty());
        let of = match (expressed, in_model) {
            (Some(name), _) => self.pose_of(name, 0)?,
            (None, true) => self.frame,
            (None, false) => frame,
        };
        let part = |of: &'static str, key: &'static str| -> Result<Option<f64>> {
            Ok(axis.child(of).map(|inner| inner.inner::<1>(key)).transpose()?.flatten().map(|[value]| value))
        };
        let ends = [part("limit", "lower")?.unwrap_or(-ENDLESS), part("limit", "upper")?.unwrap_or(ENDLESS)];
        let ends = axis.ascending("<limit>", ends)?;
        let endless = |value: f64| if value.abs() >= ENDLESS { f64::INFINITY.copysign(value) } else { value };
        let spring = Spring {
            suffix: "spring",
            stiffness: part("dynamics", "spring_stiffness")?.unwrap_or(0.0),
            damping: part("dynamics", "damping")?.unwrap_or(0.0),
            free: part("dynamics", "spring_reference")?.unwrap_or(0.0),
            preload: 0.0,
        };
        let range = (kind != "continuous").then(|| ends.map(endless));
        Ok(Hinge {
            name: name.to_owned(),
            first,
            second,
            place: frame.0,
            axis: Some(turned(&of.1, direction)),
            slides,
            acting: Acting {
                springs: vec![spring],
                range,
                friction: part("dynamics", "friction")?.unwrap_or(0.0),
                ..Acting::default()
            },
            ..Hinge::default()
        })
    }
}

fn mass(link: &Element, frame: Frame) -> Result<Part> {
    let Some(inertial) = link.child("inertial") else { return Ok((0.0, [0.0; 3], [[0.0; 3]; 3])) };
    let (center, rotation) = placed(frame, pose(inertial)?.unwrap_or(([0.0; 3], SAME)));
    let mass = inertial.inner::<1>("mass")?.map_or(0.0, |[mass]| mass);
    let Some(inertia) = inertial.child("inertia") else { return Ok((mass, center, [[0.0; 3]; 3])) };
    let mut all = [0.0; 6];
    for (own, key) in all.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
        *own = inertia.inner::<1>(key)?.map_or(0.0, |[value]| value);
    }
    Ok((mass, center, in_space(&rotation, &symmetric(all))))
}
