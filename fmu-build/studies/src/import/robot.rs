//! MuJoCo's MJCF and ROS's URDF as mechanisms in space.
//!
//! In: XML. Out: bodies and joints in space. What a planar mechanism of rigid bodies cannot have is refused or told.

use super::elements::{ascending, at, child, elements, fixed, numbers, one, parse};
use super::spatial::{Hinge, Rotation, SAME, Solid, Space, Vector, about, add, after, scaled, turned, unit};
use super::{defaults, left_out};
use anyhow::{Context, Result, bail};
use roxmltree::Node;
use std::f64::consts::PI;

/// Density of MuJoCo's geoms where none is stated [kg/m3].
const DENSITY: f64 = 1000.0;
/// Most bodies of which each hangs on the one before.
const DEEPEST: usize = 1000;

/// A mechanism in MJCF.
///
/// # Errors
/// It is no MJCF; what is no planar mechanism of hinges and slides; files included.
pub fn of_mjcf(name: &str, text: &str) -> Result<Space> {
    let text = defaults::written_out(text, &parse(text)?)?;
    let document = parse(&text)?;
    let root = document.root_element();
    if !root.has_tag_name("mujoco") {
        bail!("{}: MJCF starts with <mujoco>", at(root));
    }
    let mut reader = Mjcf { space: Space::default(), in_degrees: true, sites: false };
    reader.space.name = root.attribute("model").unwrap_or(name).to_owned();
    reader.space.gravity = [0.0, 0.0, -9.81];
    for section in elements(root) {
        reader.section(section)?;
    }
    if reader.space.solids.len() < 2 {
        bail!("<worldbody> contains no <body>, so there is no mechanism");
    }
    // Connections and drives name bodies and joints that stand anywhere.
    for section in elements(root) {
        match section.tag_name().name() {
            "equality" => elements(section).try_for_each(|node| reader.connection(node))?,
            "actuator" => elements(section).try_for_each(|node| reader.drive(node))?,
            _ => {}
        }
    }
    reader
        .space
        .notes
        .extend(left_out::of_defaults(root).chain(left_out::contact(root)).chain(left_out::of_attributes(root)));
    if reader.sites {
        reader.space.notes.push("sites, cameras and lights are left out".to_owned());
    }
    Ok(reader.space)
}

struct Mjcf {
    space: Space,
    in_degrees: bool,
    sites: bool,
}

impl Mjcf {
    fn section(&mut self, node: Node) -> Result<()> {
        match node.tag_name().name() {
            "compiler" => {
                self.in_degrees = node.attribute("angle") != Some("radian");
                for wrong in ["eulerseq", "coordinate", "meshdir"].into_iter().filter(|key| node.has_attribute(*key)) {
                    self.space.notes.push(format!("{}: the attribute {wrong} is ignored", at(node)));
                }
                if node.attribute("eulerseq").is_some_and(|order| order != "xyz") {
                    bail!("{}: only eulerseq = \"xyz\" is supported: convert the angles, or use quat", at(node));
                }
            }
            "option" => {
                if let Some(gravity) = fixed(node, "gravity")? {
                    self.space.gravity = gravity;
                }
            }
            "include" => bail!("{}: included files are not read: replace this element by the file", at(node)),
            "worldbody" => {
                self.space.solids.push(Solid::default());
                self.body(node, 0, ([0.0; 3], SAME))?;
            }
            "equality" | "actuator" | "default" | "visual" | "asset" | "statistic" | "size" => {}
            other => self.space.notes.push(format!("{}: <{other}> is left out", at(node))),
        }
        Ok(())
    }

    fn angle(&self, value: f64) -> f64 {
        if self.in_degrees { value.to_radians() } else { value }
    }

    /// Place and rotation that an element states in the frame of its parent.
    fn frame(&self, node: Node, (place, rotation): (Vector, Rotation)) -> Result<(Vector, Rotation)> {
        let own = fixed(node, "pos")?.unwrap_or([0.0; 3]);
        let mut inner = SAME;
        if let Some([w, x, y, z]) = fixed(node, "quat")? {
            let half = (x * x + y * y + z * z).sqrt();
            inner = unit([x, y, z]).map_or(SAME, |axis| about(axis, 2.0 * half.atan2(w)));
        } else if let Some([x, y, z, angle]) = fixed(node, "axisangle")? {
            let axis = unit([x, y, z]).with_context(|| {
                format!("{}: the vector of axisangle is zero: write a vector whose length is not zero", at(node))
            })?;
            inner = about(axis, self.angle(angle));
        } else if let Some(angles) = fixed::<3>(node, "euler")? {
            for (axis, angle) in SAME.into_iter().zip(angles) {
                inner = after(&inner, &about(axis, self.angle(angle)));
            }
        } else if let Some(other) = ["xyaxes", "zaxis"].into_iter().find(|key| node.has_attribute(*key)) {
            bail!("{}: {other} is not supported: write euler or quat", at(node));
        }
        Ok((add(place, turned(&rotation, own)), after(&rotation, &inner)))
    }

    /// What stands in a body that has the index `own`.
    fn body(&mut self, node: Node, own: usize, frame: (Vector, Rotation)) -> Result<()> {
        let mut masses: Vec<(f64, Vector, [Vector; 3])> = Vec::new();
        let stated = child(node, "inertial");
        if let Some(inertial) = stated {
            let (center, rotation) = self.frame(inertial, frame)?;
            let mass =
                one(inertial, "mass")?.with_context(|| format!("{}: mass is missing: add the mass", at(inertial)))?;
            let own = match (fixed::<3>(inertial, "diaginertia")?, fixed::<6>(inertial, "fullinertia")?) {
                (Some(d), _) => [[d[0], 0.0, 0.0], [0.0, d[1], 0.0], [0.0, 0.0, d[2]]],
                (None, Some([xx, yy, zz, xy, xz, yz])) => [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
                (None, None) => [[0.0; 3]; 3],
            };
            masses.push((mass, center, in_space(&rotation, &own)));
        }
        let mut joints = 0;
        for inner in elements(node) {
            match inner.tag_name().name() {
                "geom" if stated.is_none() && own > 0 => masses.extend(self.geom(inner, frame)?),
                "joint" => {
                    joints += 1;
                    if joints > 1 {
                        bail!(
                            "{}: this joint is the second joint of one body; put a body without mass between the two \
                             joints",
                            at(inner)
                        );
                    }
                }
                "freejoint" => bail!("{}: a free body is not part of a mechanism: remove this element", at(inner)),
                "site" | "camera" | "light" => self.sites = true,
                _ => {}
            }
        }
        let solid = &mut self.space.solids[own];
        (solid.mass, solid.center, solid.inertia) = together(&masses);
        if node.ancestors().nth(DEEPEST).is_some() {
            bail!("{}: this body is nested too deeply: at most {DEEPEST} are supported", at(node));
        }
        for inner in elements(node).filter(|inner| inner.has_tag_name("body")) {
            let index = self.space.solids.len();
            let name = inner.attribute("name").map_or_else(|| format!("body_{index}"), str::to_owned);
            let frame = self.frame(inner, frame)?;
            let joint = child(inner, "joint");
            let fixed_to = joint.is_none().then_some(own);
            self.space.solids.push(Solid { name, place: frame.0, fixed_to, ..Solid::default() });
            if let Some(joint) = joint {
                self.joint(joint, (own, index), frame)?;
            }
            self.body(inner, index, frame)?;
        }
        Ok(())
    }

    fn joint(&mut self, node: Node, (first, second): (usize, usize), frame: (Vector, Rotation)) -> Result<()> {
        let slides = match node.attribute("type").unwrap_or("hinge") {
            "hinge" => false,
            "slide" => true,
            other => bail!("{}: a joint of the type {other} is not planar; hinge and slide are supported", at(node)),
        };
        for key in
            ["frictionloss", "armature", "ref", "actuatorfrcrange"].into_iter().filter(|key| node.has_attribute(*key))
        {
            self.space.notes.push(format!("{}: {key} is left out", at(node)));
        }
        let value = |value: f64| if slides { value } else { self.angle(value) };
        let axis = unit(fixed(node, "axis")?.unwrap_or([0.0, 0.0, 1.0]));
        let axis = axis.with_context(|| {
            format!("{}: the vector of the axis is zero: write a vector whose length is not zero", at(node))
        })?;
        let stated = fixed::<2>(node, "range")?.filter(|_| node.attribute("limited") != Some("false"));
        // MuJoCo takes a range without width for none, unless it is said to be a limit.
        let stated = stated.filter(|[lower, upper]| lower != upper || node.attribute("limited") == Some("true"));
        let range = stated.map(|range| ascending(node, "range", range)).transpose()?.map(|range| range.map(value));
        let name = node.attribute("name").map_or_else(|| format!("joint_{second}"), str::to_owned);
        let hinge = Hinge {
            name,
            first,
            second,
            place: add(frame.0, turned(&frame.1, fixed(node, "pos")?.unwrap_or([0.0; 3]))),
            axis: Some(turned(&frame.1, axis)),
            slides,
            stiffness: one(node, "stiffness")?.unwrap_or(0.0),
            damping: one(node, "damping")?.unwrap_or(0.0),
            free: value(one(node, "springref")?.unwrap_or(0.0)),
            range,
            is_driven: false,
        };
        self.space.hinges.push(hinge);
        Ok(())
    }

    /// Mass, centre and inertia of a geom.
    fn geom(&mut self, node: Node, frame: (Vector, Rotation)) -> Result<Option<(f64, Vector, [Vector; 3])>> {
        let (mut place, mut rotation) = self.frame(node, frame)?;
        let kind = node.attribute("type").unwrap_or("sphere");
        let size = numbers(node, "size")?.unwrap_or_default();
        let part = |k: usize| size.get(k).copied().with_context(|| format!("{}: size has too few numbers", at(node)));
        let mut half = size.get(1).copied();
        if let Some([ax, ay, az, bx, by, bz]) = fixed(node, "fromto")? {
            let (a, b) = ([ax, ay, az], [bx, by, bz]);
            let along = add(b, scaled(a, -1.0));
            place = add(frame.0, turned(&frame.1, scaled(add(a, b), 0.5)));
            let direction = unit(along)
                .with_context(|| format!("{}: the two ends in fromto are at the same place: move one end", at(node)))?;
            half = Some(0.5 * super::spatial::dot(along, along).sqrt());
            if matches!(kind, "box" | "ellipsoid") {
                bail!("{}: fromto is not supported for a {kind}: write pos, euler and size", at(node));
            }
            // Any two axes across the direction serve a body of revolution.
            let aside = if direction[0].abs() < 0.9 { SAME[0] } else { SAME[1] };
            let across = unit(super::spatial::cross(direction, aside)).unwrap_or(SAME[0]);
            let local = [across, super::spatial::cross(direction, across), direction];
            rotation = after(&frame.1, &local);
        }
        let half = || half.with_context(|| format!("{}: size has no half length: add a second number", at(node)));
        // Volume, and moments of inertia for a mass of 1 about the centre, across and along the axis of revolution.
        let (volume, across, along) = match kind {
            "sphere" => {
                let r = part(0)?;
                (4.0 / 3.0 * PI * r.powi(3), [0.4 * r * r; 2], 0.4 * r * r)
            }
            "cylinder" => {
                let (r, h) = (part(0)?, 2.0 * half()?);
                (PI * r * r * h, [(3.0 * r * r + h * h) / 12.0; 2], 0.5 * r * r)
            }
            "capsule" => {
                let (r, h) = (part(0)?, 2.0 * half()?);
                let (cylinder, balls) = (PI * r * r * h, 4.0 / 3.0 * PI * r.powi(3));
                let volume = cylinder + balls;
                let (c, b) = (cylinder / volume, balls / volume);
                let across = c * (h * h / 12.0 + r * r / 4.0) + b * (0.4 * r * r + 0.25 * h * h + 0.375 * h * r);
                (volume, [across; 2], c * 0.5 * r * r + b * 0.4 * r * r)
            }
            "box" => {
                let [x, y, z] = [2.0 * part(0)?, 2.0 * part(1)?, 2.0 * part(2)?];
                (x * y * z, [(y * y + z * z) / 12.0, (x * x + z * z) / 12.0], (x * x + y * y) / 12.0)
            }
            "plane" => return Ok(None),
            other if one(node, "mass")? != Some(0.0) => {
                bail!("{}: the mass of a {other} is unknown: give the body an <inertial>", at(node))
            }
            _ => return Ok(None),
        };
        let mass = match one(node, "mass")? {
            Some(mass) => mass,
            None => volume * one(node, "density")?.unwrap_or(DENSITY),
        };
        let own = [[mass * across[0], 0.0, 0.0], [0.0, mass * across[1], 0.0], [0.0, 0.0, mass * along]];
        Ok(Some((mass, place, in_space(&rotation, &own))))
    }

    fn body_named(&self, node: Node, key: &str) -> Result<usize> {
        let Some(name) = node.attribute(key) else { return Ok(0) };
        let found = self.space.solids.iter().skip(1).position(|solid| solid.name == name);
        match found {
            Some(index) => Ok(index + 1),
            None if name == "world" => Ok(0),
            None => bail!("{}: {key} = \"{}\": there is no such body; correct the name", at(node), name.escape_debug()),
        }
    }

    /// A connection that closes a loop.
    fn connection(&mut self, node: Node) -> Result<()> {
        if !node.has_tag_name("connect") || node.has_attribute("site1") {
            bail!("{}: only <connect> with body1, body2 and anchor is supported among the equalities", at(node));
        }
        if node.attribute("active") == Some("false") {
            self.space.notes.push(format!("{}: this connection is not active and is left out", at(node)));
            return Ok(());
        }
        let (first, second) = (self.body_named(node, "body1")?, self.body_named(node, "body2")?);
        let anchor =
            fixed(node, "anchor")?.with_context(|| format!("{}: anchor is missing: add the anchor", at(node)))?;
        let frame = self.frame_of(node.document().root_element(), first)?;
        let count = self.space.hinges.len();
        self.space.hinges.push(Hinge {
            name: node.attribute("name").map_or_else(|| format!("connect_{count}"), str::to_owned),
            first,
            second,
            place: add(frame.0, turned(&frame.1, anchor)),
            axis: None,
            slides: false,
            stiffness: 0.0,
            damping: 0.0,
            free: 0.0,
            range: None,
            is_driven: false,
        });
        Ok(())
    }

    /// Frame of a body by its index, in the order of the file.
    fn frame_of(&self, root: Node, index: usize) -> Result<(Vector, Rotation)> {
        let bodies = root.descendants().filter(|node| node.has_tag_name("body"));
        let Some(body) = bodies.into_iter().nth(index.wrapping_sub(1)) else { return Ok(([0.0; 3], SAME)) };
        let mut chain: Vec<Node> = body.ancestors().filter(|node| node.has_tag_name("body")).collect();
        chain.reverse();
        chain.into_iter().try_fold(([0.0; 3], SAME), |frame, node| self.frame(node, frame))
    }

    fn drive(&mut self, node: Node) -> Result<()> {
        let Some(name) = node.attribute("joint") else {
            self.space.notes.push(format!("{}: this actuator acts on no joint and is left out", at(node)));
            return Ok(());
        };
        let found = self.space.hinges.iter_mut().find(|hinge| hinge.name == name);
        let hinge = found.with_context(|| format!("{}: there is no joint {}", at(node), name.escape_debug()))?;
        let is_second = std::mem::replace(&mut hinge.is_driven, true);
        if is_second {
            let text = format!(
                "{}: this actuator acts on the joint {}, on which another actuator acts too: the import combines both \
                 actuators into one drive",
                at(node),
                name.escape_debug()
            );
            self.space.notes.push(text);
        }
        self.space.notes.extend(left_out::of_drive(node));
        if !node.has_tag_name("motor") {
            self.space
                .notes
                .push(format!("{}: the control law is left out; the force of the drive is an input", at(node)));
        }
        Ok(())
    }
}

/// A tensor in the frame of space.
fn in_space(rotation: &Rotation, own: &[Vector; 3]) -> [Vector; 3] {
    let back: Rotation = std::array::from_fn(|k| [rotation[0][k], rotation[1][k], rotation[2][k]]);
    after(rotation, &after(own, &back))
}

/// Mass, centre and inertia of several parts.
fn together(parts: &[(f64, Vector, [Vector; 3])]) -> (f64, Vector, [Vector; 3]) {
    let mass: f64 = parts.iter().map(|(mass, ..)| mass).sum();
    if mass <= 0.0 {
        return (0.0, [0.0; 3], [[0.0; 3]; 3]);
    }
    let weighted = parts.iter().fold([0.0; 3], |sum, (own, center, _)| add(sum, scaled(*center, *own)));
    let center = scaled(weighted, 1.0 / mass);
    let mut inertia = [[0.0; 3]; 3];
    for (own, place, tensor) in parts {
        let d = add(*place, scaled(center, -1.0));
        let square = super::spatial::dot(d, d);
        for (k, column) in inertia.iter_mut().enumerate() {
            for (j, entry) in column.iter_mut().enumerate() {
                *entry += tensor[k][j] + own * (if j == k { square } else { 0.0 } - d[j] * d[k]);
            }
        }
    }
    (mass, center, inertia)
}

/// A mechanism in URDF: a tree, so that it has no loop.
///
/// # Errors
/// It is no URDF; a joint that is not planar, or that copies another.
pub fn of_urdf(name: &str, text: &str) -> Result<Space> {
    let document = parse(text)?;
    let root = document.root_element();
    if !root.has_tag_name("robot") {
        bail!("{}: URDF starts with <robot>", at(root));
    }
    let mut space = Space { name: root.attribute("name").unwrap_or(name).to_owned(), ..Space::default() };
    space.gravity = [0.0, 0.0, -9.81];
    space.notes.push("URDF has no gravity: 9.81 m/s2 along -z is added".to_owned());
    let joints: Vec<Node> = elements(root).filter(|node| node.has_tag_name("joint")).collect();
    let of = |node: Node, key: &str| -> Result<String> {
        let name = child(node, key).and_then(|child| child.attribute("link"));
        Ok(name.with_context(|| format!("{}: the element <{key}> is missing: add this element", at(node)))?.to_owned())
    };
    let ends: Vec<(String, String)> =
        joints.iter().map(|joint| Ok((of(*joint, "parent")?, of(*joint, "child")?))).collect::<Result<_>>()?;
    let links: Vec<Node> = elements(root).filter(|node| node.has_tag_name("link")).collect();
    let is_base = |link: &&Node| ends.iter().all(|(_, child)| link.attribute("name") != Some(child));
    let base = links.iter().find(is_base).context("every link is moved by a joint, so there is no ground link")?;
    space.notes.push(format!("the link {} becomes the body ground", base.attribute("name").unwrap_or_default()));
    space.solids.push(Solid::default());
    let mut known = vec![(base.attribute("name").unwrap_or_default().to_owned(), ([0.0; 3], SAME))];
    let mut left: Vec<usize> = (0..joints.len()).collect();
    while let Some(next) = left.iter().position(|&joint| known.iter().any(|(name, _)| *name == ends[joint].0)) {
        let index = left.remove(next);
        let (joint, (parent, child_name)) = (joints[index], &ends[index]);
        let first = known.iter().position(|(name, _)| name == parent).unwrap_or_default();
        let frame = origin(joint, known[first].1)?;
        let kind = joint.attribute("type").unwrap_or_default();
        let is_fixed = kind == "fixed";
        let link = links.iter().find(|link| link.attribute("name") == Some(child_name));
        let link = link.with_context(|| format!("{}: there is no link {child_name}; correct the name", at(joint)))?;
        let mut solid = Solid { name: child_name.clone(), place: frame.0, ..Solid::default() };
        solid.fixed_to = is_fixed.then_some(first);
        (solid.mass, solid.center, solid.inertia) = urdf_mass(*link, frame)?;
        space.solids.push(solid);
        known.push((child_name.clone(), frame));
        if !is_fixed {
            let hinge = urdf_joint(joint, kind, (first, known.len() - 1), frame, &mut space.notes)?;
            space.hinges.push(hinge);
        }
    }
    if let Some(&lost) = left.first() {
        bail!("{}: the parent link of this joint is not connected to the other links", at(joints[lost]));
    }
    space.notes.extend(left_out::of_urdf(root));
    for node in elements(root) {
        if let other @ ("transmission" | "gazebo") = node.tag_name().name() {
            space.notes.push(format!("{}: <{other}> is left out", at(node)));
        }
    }
    Ok(space)
}

/// Frame of an `<origin>` by xyz and rpy.
fn origin(node: Node, (place, rotation): (Vector, Rotation)) -> Result<(Vector, Rotation)> {
    let Some(origin) = child(node, "origin") else { return Ok((place, rotation)) };
    let own = fixed(origin, "xyz")?.unwrap_or([0.0; 3]);
    let [roll, pitch, yaw] = fixed(origin, "rpy")?.unwrap_or([0.0; 3]);
    let inner = after(&about(SAME[2], yaw), &after(&about(SAME[1], pitch), &about(SAME[0], roll)));
    Ok((add(place, turned(&rotation, own)), after(&rotation, &inner)))
}

fn urdf_mass(link: Node, frame: (Vector, Rotation)) -> Result<(f64, Vector, [Vector; 3])> {
    let Some(inertial) = child(link, "inertial") else { return Ok((0.0, [0.0; 3], [[0.0; 3]; 3])) };
    let (center, rotation) = origin(inertial, frame)?;
    let mass = child(inertial, "mass").map(|mass| one(mass, "value")).transpose()?.flatten().unwrap_or(0.0);
    let Some(inertia) = child(inertial, "inertia") else { return Ok((mass, center, [[0.0; 3]; 3])) };
    let part = |key: &str| -> Result<f64> { Ok(one(inertia, key)?.unwrap_or(0.0)) };
    let [xx, yy, zz, xy, xz, yz] = [part("ixx")?, part("iyy")?, part("izz")?, part("ixy")?, part("ixz")?, part("iyz")?];
    Ok((mass, center, in_space(&rotation, &[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])))
}

fn urdf_joint(
    node: Node,
    kind: &str,
    (first, second): (usize, usize),
    frame: (Vector, Rotation),
    notes: &mut Vec<String>,
) -> Result<Hinge> {
    let slides = match kind {
        "revolute" | "continuous" => false,
        "prismatic" => true,
        other => bail!("{}: a joint of the type {other} is not supported; use revolute or prismatic", at(node)),
    };
    if child(node, "mimic").is_some() {
        bail!("{}: <mimic> is not supported, because a linkage has no joint that copies another", at(node));
    }
    let axis = child(node, "axis").map(|axis| fixed(axis, "xyz")).transpose()?.flatten().unwrap_or([1.0, 0.0, 0.0]);
    let axis = unit(axis).with_context(|| {
        format!("{}: the vector of the axis is zero: write a vector whose length is not zero", at(node))
    })?;
    let mut damping = 0.0;
    if let Some(dynamics) = child(node, "dynamics") {
        damping = one(dynamics, "damping")?.unwrap_or(0.0);
        if one(dynamics, "friction")?.is_some_and(|friction| friction != 0.0) {
            notes.push(format!("{}: the joint friction is left out: add the key friction to the definition", at(node)));
        }
    }
    let limit = child(node, "limit").filter(|_| kind != "continuous");
    let range = match limit {
        Some(limit) => {
            let range = [one(limit, "lower")?.unwrap_or(0.0), one(limit, "upper")?.unwrap_or(0.0)];
            Some(ascending(node, "<limit>", range)?)
        }
        None => None,
    };
    Ok(Hinge {
        name: node.attribute("name").map_or_else(|| format!("joint_{second}"), str::to_owned),
        first,
        second,
        place: frame.0,
        axis: Some(turned(&frame.1, axis)),
        slides,
        stiffness: 0.0,
        damping,
        free: 0.0,
        range,
        is_driven: true,
    })
}
