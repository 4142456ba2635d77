//! MuJoCo's MJCF as a mechanism in space: settings, bodies, joints.
//!
//! In: XML. Out: bodies and joints in space, with notes. Parts that a planar mechanism of rigid bodies cannot represent
//! are rejected or noted according to the table of this format.

mod acting;
mod defaults;
mod frames;
mod table;

use super::masses::{Part, Shape, bounded, in_space, symmetric, together};
use super::spatial::{Acting, Hinge, SAME, Solid, Space, Spring, add, scaled, turned, unit};
use super::xml::{Element, rejected, unread};
use anyhow::{Context, Result, bail, ensure};
use frames::{Frame, along};
pub use table::{TABLE, group};

/// Default density of MuJoCo's geoms [kg/m3].
const DENSITY: f64 = 1000.0;

/// Parts of MuJoCo's computation that `<flag>` can disable.
#[derive(Clone, Copy)]
struct Enabled {
    spring: bool,
    damper: bool,
    limit: bool,
    equality: bool,
    friction: bool,
    actuation: bool,
}

/// Bodies whose masses are computed from geoms.
#[derive(Clone, Copy, PartialEq)]
enum FromGeoms {
    Never,
    Always,
    Where,
}

struct Mjcf {
    space: Space,
    in_degrees: bool,
    sequence: String,
    autolimits: bool,
    from_geoms: FromGeoms,
    groups: [f64; 2],
    /// Whether the mass of the present body is computed from its geoms.
    needs_geoms: bool,
    least: [f64; 2],
    enabled: Enabled,
    /// Frame of each body, and value of each hinge, at the position of the file.
    frames: Vec<Frame>,
    refs: Vec<f64>,
    /// Sites by name: body, frame.
    sites: Vec<(String, usize, Frame)>,
}

/// A mechanism in MJCF. `include` returns the text of an included file.
///
/// # Errors
/// The text is no MJCF, or no planar mechanism of hinges and slides.
pub fn of_mjcf(name: &str, text: &str, include: &dyn Fn(&str) -> Result<String>) -> Result<Space> {
    read(name, &document(text, include)?)
}

/// The document with its included files and the attributes of its classes.
///
/// # Errors
/// The text is no MJCF, or a file or a class is missing.
pub fn document(text: &str, include: &dyn Fn(&str) -> Result<String>) -> Result<Element> {
    let mut root = Element::parse(text, "")?;
    ensure!(root.tag == "mujoco", "{}: MJCF starts with <mujoco>", root.at());
    defaults::included(&mut root, include, &mut Vec::new())?;
    rejected(&root, &TABLE, &group)?;
    defaults::written_out(&mut root)?;
    Ok(root)
}

/// The mechanism of a document.
///
/// # Errors
/// The document is no planar mechanism of hinges and slides.
pub fn read(name: &str, root: &Element) -> Result<Space> {
    let all = Enabled { spring: true, damper: true, limit: true, equality: true, friction: true, actuation: true };
    let mut reader = Mjcf {
        space: Space { name: root.get("model").unwrap_or(name).to_owned(), ..Space::default() },
        in_degrees: true,
        sequence: "xyz".to_owned(),
        autolimits: true,
        from_geoms: FromGeoms::Where,
        groups: [0.0, 5.0],
        needs_geoms: false,
        least: [0.0; 2],
        enabled: all,
        frames: vec![([0.0; 3], SAME)],
        refs: Vec::new(),
        sites: Vec::new(),
    };
    reader.space.gravity = [0.0, 0.0, -9.81];
    let total = reader.settings(root)?;
    reader.space.solids.push(Solid { name: "world".to_owned(), ..Solid::default() });
    for world in root.all("worldbody") {
        reader.body(world, 0, ([0.0; 3], SAME), None)?;
    }
    ensure!(
        reader.space.solids.len() > 1,
        "<worldbody> contains no <body>, so there is no mechanism: add the bodies \
        of the mechanism"
    );
    if let Some(total) = total {
        let sum: f64 = reader.space.solids.iter().map(|solid| solid.mass).sum();
        for solid in &mut reader.space.solids {
            solid.mass *= total / sum;
            solid.inertia = solid.inertia.map(|column| scaled(column, total / sum));
        }
    }
    // Connections, tendons and drives may name bodies, sites and joints at any place of the file.
    reader.acting(root)?;
    let world = |site: &&(String, usize, Frame)| site.1 > 0;
    let sites = reader.sites.iter().filter(world).map(|(name, body, frame)| (name.clone(), *body, frame.0));
    reader.space.sites = sites.collect();
    reader.space.notes.extend(unread(root, &TABLE, &group)?);
    reader.space.notes.extend(table::contact(root));
    Ok(reader.space)
}

impl Mjcf {
    /// Settings in any order. Returns the total mass.
    fn settings(&mut self, root: &Element) -> Result<Option<f64>> {
        let mut total = None;
        for node in root.all("compiler") {
            if let Some(unit) = node.get("angle") {
                self.in_degrees = unit != "radian";
            }
            if let Some(sequence) = node.get("eulerseq") {
                let is_axis = |letter: char| "xyzXYZ".contains(letter);
                let right = sequence.len() == 3 && sequence.chars().all(is_axis);
                ensure!(right, "{}: eulerseq must be three letters of xyzXYZ, such as xyz", node.at());
                sequence.clone_into(&mut self.sequence);
            }
            if let Some(word) = node.get("autolimits") {
                self.autolimits = word == "true";
            }
            match node.get("inertiafromgeom") {
                Some("true") => self.from_geoms = FromGeoms::Always,
                Some("false") => self.from_geoms = FromGeoms::Never,
                Some(_) => self.from_geoms = FromGeoms::Where,
                None => {}
            }
            self.groups = node.fixed("inertiagrouprange")?.unwrap_or(self.groups);
            let [mass, inertia] = [node.one("boundmass")?, node.one("boundinertia")?];
            self.least = [mass.unwrap_or(self.least[0]), inertia.unwrap_or(self.least[1])];
            total = node.one("settotalmass")?.or(total);
        }
        let mut falls = true;
        for node in root.all("option") {
            self.space.gravity = node.fixed("gravity")?.unwrap_or(self.space.gravity);
            for flag in node.all("flag") {
                let on = |key: &'static str, was: bool| flag.get(key).map_or(was, |word| word != "disable");
                let own = &mut self.enabled;
                let constrained = on("constraint", true);
                own.spring = on("spring", own.spring);
                own.damper = on("damper", own.damper);
                own.limit = on("limit", own.limit) && constrained;
                own.equality = on("equality", own.equality) && constrained;
                own.friction = on("frictionloss", own.friction) && constrained;
                own.actuation = on("actuation", own.actuation);
                falls = on("gravity", falls);
            }
        }
        if !falls {
            self.space.gravity = [0.0; 3];
        }
        Ok(total.filter(|total| *total > 0.0))
    }

    fn angle(&self, value: f64) -> f64 {
        if self.in_degrees { value.to_radians() } else { value }
    }

    /// Read the contents of the body with the index `own`, or of a frame in it, which adds to the mass properties of
    /// its body.
    fn body(&mut self, node: &Element, own: usize, frame: Frame, parts: Option<&mut Vec<Part>>) -> Result<()> {
        let is_body = parts.is_none();
        if is_body {
            let is_free = self.from_geoms == FromGeoms::Always || own > 0 && node.child("inertial").is_none();
            self.needs_geoms = own > 0 && is_free && self.from_geoms != FromGeoms::Never;
        }
        let needs_geoms = self.needs_geoms;
        let mut of_body = Vec::new();
        let parts = parts.unwrap_or(&mut of_body);
        for inner in &node.children {
            match inner.tag.as_str() {
                "geom" => parts.extend(self.geom(inner, frame)?),
                "freejoint" => bail!("{}: a free body is not part of a mechanism: remove this element", inner.at()),
                "site" => {
                    let at = match inner.fixed("fromto")? {
                        Some(ends) => along(inner, ends, frame)?.0,
                        None => self.frame(inner, frame)?,
                    };
                    let count = self.sites.len() + 1;
                    let name = inner.get("name").map_or_else(|| format!("site_{count}"), str::to_owned);
                    self.sites.push((name, own, at));
                }
                "frame" => self.body(inner, own, self.frame(inner, frame)?, Some(&mut *parts))?,
                "body" => {
                    self.inner_body(inner, own, frame)?;
                    self.needs_geoms = needs_geoms;
                }
                _ => {}
            }
        }
        if is_body && own > 0 {
            let inertial = node.child("inertial").filter(|_| self.from_geoms != FromGeoms::Always);
            let part = match inertial {
                Some(inertial) => self.inertial(inertial, frame)?,
                None => together(parts),
            };
            let [mass, inertia] = self.least;
            let part = bounded(part, mass, inertia).with_context(|| node.at())?;
            let solid = &mut self.space.solids[own];
            (solid.mass, solid.center, solid.inertia) = part;
        }
        Ok(())
    }

    fn inertial(&self, node: &Element, frame: Frame) -> Result<Part> {
        let (center, rotation) = self.frame(node, frame)?;
        let mass =
            node.one("mass")?.with_context(|| format!("{}: the attribute mass is missing: add the mass", node.at()))?;
        let own = match (node.fixed::<3>("diaginertia")?, node.fixed("fullinertia")?) {
            (_, Some(full)) => symmetric(full),
            (Some([x, y, z]), None) => symmetric([x, y, z, 0.0, 0.0, 0.0]),
            (None, None) => [[0.0; 3]; 3],
        };
        Ok((mass, center, in_space(&rotation, &own)))
    }

    fn inner_body(&mut self, inner: &Element, own: usize, frame: Frame) -> Result<()> {
        let frame = self.frame(inner, frame)?;
        let unnamed = format!("body_{}", self.space.solids.len());
        let name = inner.get("name").map_or(unnamed, str::to_owned);
        let mut base = own;
        let mut joints = Vec::new();
        self.joints_of(inner, frame, &mut joints)?;
        let is_fixed = joints.is_empty();
        let count = joints.len();
        let mut hinges = Vec::new();
        for (joint, left) in joints.into_iter().zip((0..count).rev()) {
            // Several joints of one body act in series, with bodies without mass between them.
            let name = if left == 0 { name.clone() } else { format!("{name}_{}", self.space.solids.len()) };
            let index = self.space.solids.len();
            self.space.solids.push(Solid { name, place: frame.0, ..Solid::default() });
            self.frames.push(frame);
            hinges.push((joint, (base, index)));
            base = index;
        }
        if is_fixed {
            base = self.space.solids.len();
            self.space.solids.push(Solid { name, place: frame.0, fixed_to: Some(own), ..Solid::default() });
            self.frames.push(frame);
        }
        let lift = inner.one("gravcomp")?.unwrap_or(0.0);
        self.space.solids[base].lift = if self.enabled.spring || self.enabled.damper { lift } else { 0.0 };
        for ((joint, at), ends) in hinges {
            self.joint(joint, ends, at)?;
        }
        self.body(inner, base, frame, None)
    }

    /// The joints of a body, including those in its frames.
    fn joints_of<'a>(&self, node: &'a Element, frame: Frame, found: &mut Vec<(&'a Element, Frame)>) -> Result<()> {
        for inner in &node.children {
            match inner.tag.as_str() {
                "joint" => found.push((inner, frame)),
                "frame" => self.joints_of(inner, self.frame(inner, frame)?, found)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn joint(&mut self, node: &Element, (first, second): (usize, usize), body: Frame) -> Result<()> {
        let slides = match node.get("type").unwrap_or("hinge") {
            "hinge" => false,
            "slide" => true,
            other => bail!(
                "{}: a joint of the type {other} is not planar; hinge and slide are supported: write hinge or slide",
                node.at()
            ),
        };
        let value = |value: f64| if slides { value } else { self.angle(value) };
        let axis = unit(node.fixed("axis")?.unwrap_or([0.0, 0.0, 1.0]));
        let axis = axis.with_context(|| {
            format!("{}: the vector of the axis is zero: write the direction of the axis", node.at())
        })?;
        let origin = value(node.one("ref")?.unwrap_or(0.0));
        let mut acting = self.passive(node)?;
        if let Some([spring]) = acting.springs.first_chunk_mut::<1>() {
            spring.free = value(node.one("springref")?.unwrap_or(0.0)) - origin;
        }
        acting.range = self.range(node)?.map(|range| range.map(|end| value(end) - origin));
        self.refs.push(origin);
        self.space.hinges.push(Hinge {
            name: node.get("name").map_or_else(|| format!("joint_{second}"), str::to_owned),
            first,
            second,
            place: add(body.0, turned(&body.1, node.fixed("pos")?.unwrap_or([0.0; 3]))),
            axis: Some(turned(&body.1, axis)),
            slides,
            acting,
            ..Hinge::default()
        });
        Ok(())
    }

    /// Spring, damper and rotor of a joint or a tendon. The free value of the spring is still 0.
    fn passive(&self, node: &Element) -> Result<Acting> {
        let linear = |key: &'static str, is_on: bool| -> Result<f64> {
            let all = node.numbers(key)?.unwrap_or_default();
            let rest = all.iter().skip(1).any(|value| *value != 0.0);
            ensure!(
                !rest,
                "{}: {key}: only the first, linear coefficient is supported: set the others to 0",
                node.at()
            );
            let value = all.first().copied().unwrap_or(0.0);
            ensure!(value >= 0.0, "{}: {key} = {value}: must not be negative: correct the sign", node.at());
            Ok(if is_on { value } else { 0.0 })
        };
        let friction = node.one("frictionloss")?.filter(|_| self.enabled.friction).unwrap_or(0.0);
        ensure!(
            friction >= 0.0,
            "{}: frictionloss = {friction}: must not be negative: write the friction as a positive number",
            node.at()
        );
        let stiffness = linear("stiffness", self.enabled.spring)?;
        let damping = linear("damping", self.enabled.damper)?;
        let spring = Spring { suffix: "spring", stiffness, damping, ..Spring::default() };
        let armature = node.one("armature")?.unwrap_or(0.0);
        Ok(Acting { springs: vec![spring], armature, friction, ..Acting::default() })
    }

    /// The limits of a joint or a tendon, in the unit of the file.
    fn range(&self, node: &Element) -> Result<Option<[f64; 2]>> {
        let stated = node.fixed::<2>("range")?;
        let is_limit = match node.get("limited") {
            Some("true") => true,
            Some("false") => false,
            _ => self.autolimits,
        };
        let limited = node.is("limited", "true");
        // A range without width is no limit, unless the file states that it is one.
        let stated = stated.filter(|[lower, upper]| is_limit && self.enabled.limit && (lower != upper || limited));
        stated.map(|range| node.ascending("range", range)).transpose()
    }

    /// Mass, centre and inertia of a geom.
    fn geom(&self, node: &Element, frame: Frame) -> Result<Option<Part>> {
        let group = node.one("group")?.unwrap_or(0.0);
        let [mass, density] = [node.one("mass")?, node.one("density")?];
        let kind = node.get("type").unwrap_or(if node.get("mesh").is_some() { "mesh" } else { "sphere" });
        let size = node.numbers("size")?.unwrap_or_default();
        let has_mass = self.needs_geoms && (self.groups[0]..=self.groups[1]).contains(&group);
        let mut at = self.frame(node, frame)?;
        let part = |k: usize| {
            size.get(k).copied().with_context(|| {
                format!(
                    "{}: the attribute size has too few \
            numbers: add the missing numbers",
                    node.at()
                )
            })
        };
        let mut length = None;
        if let Some(ends) = node.fixed("fromto")? {
            let (placed, between) = along(node, ends, frame)?;
            at = placed;
            length = Some(between);
        }
        let across = usize::from(length.is_none());
        let long = |k: usize| length.map_or_else(|| part(k).map(|half| 2.0 * half), Ok);
        if !has_mass || mass.or(density) == Some(0.0) {
            return Ok(None);
        }
        let shape = match kind {
            "sphere" => Shape::Sphere(part(0)?),
            "cylinder" => Shape::Cylinder(part(0)?, long(1)?),
            "capsule" => Shape::Capsule(part(0)?, long(1)?),
            // For a shape between two ends, the first size is that of both transverse directions.
            "box" => Shape::Cuboid([2.0 * part(0)?, 2.0 * part(across)?, long(2)?]),
            "ellipsoid" => Shape::Ellipsoid([part(0)?, part(across)?, 0.5 * long(2)?]),
            "plane" | "hfield" => return Ok(None),
            other => bail!("{}: the mass of a {other} is unknown: give the body an <inertial>", node.at()),
        };
        let is_shell = node.is("shellinertia", "true");
        ensure!(!is_shell, "{}: shellinertia is not supported: give the body an <inertial>", node.at());
        Ok(Some(shape.part(mass, density.unwrap_or(DENSITY), at.0, &at.1)))
    }
}
