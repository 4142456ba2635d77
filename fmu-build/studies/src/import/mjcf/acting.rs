//! Equalities, tendons and actuators of MJCF.
//!
//! In: elements that name bodies, joints and sites. Out: connections, couplings, struts, springs and drives.

use super::super::couple::Ratio;
use super::super::spatial::{Acting, Control, Drive, Hinge, Spring, Strut, add, after, dot, scaled, turned};
use super::super::xml::Element;
use super::Mjcf;
use super::frames::{Frame, of_quaternion};
use anyhow::{Context, Result, bail, ensure};

/// Largest difference of poses that counts as rounding of the file.
const OFF: f64 = 1e-6;

/// Force of an actuator at the control 0: bias b0 + b1 length + b2 speed, and its gain.
struct Law {
    bias: [f64; 3],
    gain: f64,
}

impl Mjcf {
    pub(super) fn acting(&mut self, root: &Element) -> Result<()> {
        let sections = |tag: &'static str| root.all(tag).flat_map(|section| &section.children);
        for node in sections("equality") {
            let is_active = node.get("active") != Some("false");
            if is_active && self.enabled.equality {
                self.equality(node)?;
            } else {
                self.space.notes.push(format!("{}: this equality is not active and is left out", node.at()));
            }
        }
        for node in sections("tendon").filter(|node| node.tag == "spatial") {
            self.spatial(node)?;
        }
        for node in sections("actuator") {
            self.drive(node)?;
        }
        Ok(())
    }

    fn equality(&mut self, node: &Element) -> Result<()> {
        match node.tag.as_str() {
            "connect" => self.connect(node),
            "weld" => self.weld(node),
            "joint" => self.coupling(node),
            // The table rejects all other elements.
            _ => Ok(()),
        }
    }

    fn body_named(&self, node: &Element, key: &'static str) -> Result<usize> {
        let Some(name) = node.get(key) else { return Ok(0) };
        let found = self.space.solids.iter().skip(1).position(|solid| solid.name == name);
        match found {
            Some(index) => Ok(index + 1),
            None if name == "world" => Ok(0),
            None => {
                bail!("{}: {key} = \"{}\": there is no such body; correct the name", node.at(), name.escape_debug())
            }
        }
    }

    fn site_named(&self, node: &Element, name: &str) -> Result<(usize, Frame)> {
        let found = self.sites.iter().find(|(own, ..)| own == name);
        let (_, body, frame) = found
            .with_context(|| format!("{}: there is no site {}; correct the name", node.at(), name.escape_debug()))?;
        Ok((*body, *frame))
    }

    fn hinge_named(&self, node: &Element, key: &'static str) -> Result<Option<usize>> {
        let Some(name) = node.get(key) else { return Ok(None) };
        let found = self.space.hinges.iter().position(|hinge| hinge.name == name);
        let no = || format!("{}: there is no joint {}; correct the name", node.at(), name.escape_debug());
        found.with_context(no).map(Some)
    }

    /// Bodies that an equality connects, and the frames of its sites.
    fn ends(&self, node: &Element) -> Result<([usize; 2], Option<[Frame; 2]>)> {
        match (node.get("site1"), node.get("site2")) {
            (Some(one), Some(other)) => {
                let ((first, a), (second, b)) = (self.site_named(node, one)?, self.site_named(node, other)?);
                Ok(([first, second], Some([a, b])))
            }
            (None, None) => Ok(([self.body_named(node, "body1")?, self.body_named(node, "body2")?], None)),
            _ => bail!("{}: the attribute site1 or site2 is missing: add the attribute", node.at()),
        }
    }

    fn connect(&mut self, node: &Element) -> Result<()> {
        let ([first, second], sites) = self.ends(node)?;
        let (place, other) = match sites {
            Some([a, b]) => (a.0, Some(b.0)),
            None => {
                let anchor = node.fixed("anchor")?;
                let anchor = anchor
                    .with_context(|| format!("{}: the attribute anchor is missing: add the attribute", node.at()))?;
                let frame = self.frames[first];
                (add(frame.0, turned(&frame.1, anchor)), None)
            }
        };
        let count = self.space.hinges.len();
        let name = node.get("name").map_or_else(|| format!("connect_{count}"), str::to_owned);
        self.refs.push(0.0);
        self.space.hinges.push(Hinge { name, first, second, place, other, ..Hinge::default() });
        Ok(())
    }

    fn weld(&mut self, node: &Element) -> Result<()> {
        let ([first, second], sites) = self.ends(node)?;
        ensure!(
            node.one("torquescale")? != Some(0.0),
            "{}: a weld with torquescale = 0 does not hold the angle, so it is a connection: write <connect>",
            node.at()
        );
        let [one, mut other] = [self.frames[first], self.frames[second]];
        let mut wanted = other;
        let pose = node.fixed::<7>("relpose")?.filter(|pose| pose[3..] != [0.0; 4]);
        if let Some([a, b]) = sites {
            (other, wanted) = (b, a);
        } else if let Some([x, y, z, q @ ..]) = pose {
            let rotation = after(&one.1, &of_quaternion(q));
            // The pose is that of the anchor in the frame of the second body.
            let anchor = node.fixed("anchor")?.unwrap_or([0.0; 3]);
            let place = add(one.0, turned(&one.1, [x, y, z]));
            wanted = (add(place, scaled(turned(&rotation, anchor), -1.0)), rotation);
        } else {
            // The equality holds at the position of the file, for any anchor.
            node.get("anchor");
        }
        let apart = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let off = (0..3).map(|k| apart(other.1[k], wanted.1[k])).fold(apart(other.0, wanted.0), f64::max);
        ensure!(
            off <= OFF,
            "{}: the position of the two bodies in the file differs from the welded position by {off:.2e}: write the \
                bodies in the welded position",
            node.at()
        );
        self.space.weld(first, second);
        Ok(())
    }

    fn coupling(&mut self, node: &Element) -> Result<()> {
        let first = self.hinge_named(node, "joint1")?;
        let first =
            first.with_context(|| format!("{}: the attribute joint1 is missing: add the attribute", node.at()))?;
        let stated = node.numbers("polycoef")?.unwrap_or_else(|| vec![0.0, 1.0]);
        let part = |k: usize| stated.get(k).copied().unwrap_or(if k == 1 { 1.0 } else { 0.0 });
        let Some(second) = self.hinge_named(node, "joint2")? else {
            ensure!(
                part(0) == 0.0,
                "{}: polycoef keeps the joint at {}, measured from its position in the file: write the body in the \
                    position that polycoef states",
                node.at(),
                part(0)
            );
            let Hinge { first, second, .. } = self.space.hinges[first];
            self.space.weld(first, second);
            return Ok(());
        };
        ensure!(
            (2..5).all(|k| part(k) == 0.0),
            "{}: polycoef: a coupling whose ratio varies is not supported: set the last three numbers to 0, or add a \
                cam to the definition",
            node.at()
        );
        self.space.ratios.push(Ratio { first, second, ratio: part(1), offset: part(0) });
        Ok(())
    }

    /// A tendon between two sites.
    fn spatial(&mut self, node: &Element) -> Result<()> {
        let path: Vec<&str> = node.children.iter().map(|part| part.tag.as_str()).collect();
        ensure!(
            path == ["site"; 2],
            "{}: only tendons between two sites are supported, without geoms, pulleys or other sites",
            node.at()
        );
        let mut ends = Vec::new();
        for site in node.all("site") {
            let name = site.get("site").with_context(|| format!("{}: the name of the site is missing", site.at()))?;
            let (body, frame) = self.site_named(site, name)?;
            ends.push((body, frame.0));
        }
        let [first, second] = [ends[0], ends[1]];
        let between = add(first.1, scaled(second.1, -1.0));
        let mut acting = self.passive(node)?;
        let rest = node.numbers("springlength")?.unwrap_or_default();
        ensure!(
            rest.len() < 2 || rest[0] == rest[1],
            "{}: springlength: `import` does not support a range without force: write one length",
            node.at()
        );
        if let Some(spring) = acting.springs.first_mut() {
            let moved =
                self.space.hinges.iter().any(|hinge| {
                    hinge.acting.springs.iter().any(|spring| spring.suffix == "spring" && spring.free != 0.0)
                });
            let by_reference = rest.first().is_none_or(|length| *length < 0.0);
            ensure!(
                !(by_reference && moved && spring.stiffness != 0.0),
                "{}: springlength is missing, and joints have springref: write the length at rest",
                node.at()
            );
            spring.free = if by_reference { dot(between, between).sqrt() } else { rest[0] };
        }
        ensure!(
            acting.friction == 0.0,
            "{}: frictionloss: constant friction is supported in a joint only: set frictionloss to 0",
            node.at()
        );
        acting.range = self.range(node)?;
        let count = self.space.struts.len() + 1;
        let name = node.get("name").map_or_else(|| format!("tendon_{count}"), str::to_owned);
        self.space.struts.push(Strut { name, ends: [first, second], acting });
        Ok(())
    }

    fn drive(&mut self, node: &Element) -> Result<()> {
        if !self.enabled.actuation {
            self.space.notes.push(format!("{}: actuation is disabled: this actuator is left out", node.at()));
            return Ok(());
        }
        let (Law { bias, gain }, autolimits) = (law(node)?, self.autolimits);
        let joint = match self.hinge_named(node, "joint")? {
            None => self.hinge_named(node, "jointinparent")?,
            joint => joint,
        };
        let gear = node.numbers("gear")?.and_then(|gear| gear.first().copied()).unwrap_or(1.0);
        let strut = match node.get("tendon") {
            Some(name) => {
                let found = self.space.struts.iter().position(|strut| strut.name == name);
                Some(found.with_context(|| {
                    format!(
                        "{}: there is no tendon {} between two sites; correct the name",
                        node.at(),
                        name.escape_debug()
                    )
                })?)
            }
            None => None,
        };
        let friction = node.numbers("damping")?.unwrap_or_default();
        ensure!(
            friction.iter().skip(1).all(|value| *value == 0.0),
            "{}: damping: only the first, linear coefficient is supported: set the others to 0",
            node.at()
        );
        let damping = if self.enabled.damper { friction.first().copied().unwrap_or(0.0) } else { 0.0 };
        let armature = node.one("armature")?.unwrap_or(0.0);
        let (acting, name, origin): (&mut Acting, &str, f64) = match (joint, strut) {
            (Some(at), _) => {
                let hinge = &mut self.space.hinges[at];
                (&mut hinge.acting, hinge.name.as_str(), self.refs[at])
            }
            (None, Some(at)) => {
                let strut = &mut self.space.struts[at];
                // A negative force of a tendon pulls its ends together.
                (&mut strut.acting, strut.name.as_str(), 0.0)
            }
            (None, None) => {
                ensure!(
                    bias == [0.0; 3],
                    "{}: an actuator that controls a site or a slider-crank is not supported: let it act on a joint \
                        or a tendon",
                    node.at()
                );
                self.space.notes.push(format!("{}: this actuator acts on no joint and is left out", node.at()));
                return Ok(());
            }
        };
        let [b0, b1, b2] = bias.map(|part| gear * part);
        let gains = [-b1 * gear, -b2 * gear];
        ensure!(
            gains.iter().all(|gain| *gain >= 0.0),
            "{}: the control law would push the joint away from the commanded position or accelerate its motion, \
                which a controller of a drive cannot do: correct the signs of the bias",
            node.at()
        );
        let [position_gain, speed_gain] = gains.map(|gain| Some(gain).filter(|gain| *gain != 0.0));
        let drive = match acting.drives.len() {
            0 => format!("{name}_drive"),
            count => format!("{name}_drive_{}", count + 1),
        };
        let given = match (position_gain, speed_gain) {
            (None, None) => gain * gear,
            (Some(controlled), _) | (None, Some(controlled)) => gain * gear / controlled,
        };
        let word = match (position_gain, speed_gain) {
            (None, None) => "the force or torque itself",
            (Some(_), _) => "the commanded position",
            (None, Some(_)) => "the commanded speed",
        };
        let control = if position_gain.or(speed_gain).is_some() {
            let limits = force_limits(node, autolimits)?.map(|limits| limits.map(|limit| gear * limit));
            Some(Control { position_gain, speed_gain, command: -origin, limits })
        } else {
            None
        };
        acting.drives.push(Drive { force: b0, control });
        acting.springs.push(Spring { suffix: "motor", damping: damping * gear * gear, ..Spring::default() });
        acting.armature += armature * gear * gear;
        let counted = if position_gain.is_some() && origin != 0.0 {
            format!(", measured from the reference {origin} of the joint")
        } else {
            String::new()
        };
        if given != 1.0 || !counted.is_empty() {
            self.space.notes.push(format!(
                "{}: the input of the drive {drive} is {word}, {given} times the control signal of MuJoCo{counted}",
                node.at()
            ));
        }
        Ok(())
    }
}

/// Smallest and largest force of an actuator.
fn force_limits(node: &Element, autolimits: bool) -> Result<Option<[f64; 2]>> {
    let stated = node.fixed::<2>("forcerange")?;
    let is_limit = match node.get("forcelimited") {
        Some("true") => true,
        Some("false") => false,
        _ => autolimits,
    };
    stated.filter(|_| is_limit).map(|range| node.ascending("forcerange", range)).transpose()
}

/// The law of an actuator.
fn law(node: &Element) -> Result<Law> {
    let number = |key: &'static str, absent: f64| -> Result<f64> { Ok(node.one(key)?.unwrap_or(absent)) };
    let first = |key: &'static str, absent: f64| -> Result<f64> {
        Ok(node.numbers(key)?.and_then(|all| all.first().copied()).unwrap_or(absent))
    };
    let affine = |key: &'static str| -> Result<[f64; 3]> {
        let all = node.numbers(key)?.unwrap_or_default();
        Ok(std::array::from_fn(|k| all.get(k).copied().unwrap_or(0.0)))
    };
    let damped = |kp: f64| -> Result<Law> {
        ensure!(
            number("dampratio", 0.0)? == 0.0,
            "{}: `import` does not support `dampratio`, which depends on the inertia at one position: write `kv` \
             instead",
            node.at()
        );
        Ok(Law { bias: [0.0, -kp, -number("kv", 0.0)?], gain: kp })
    };
    Ok(match node.tag.as_str() {
        "motor" | "adhesion" => Law { bias: [0.0; 3], gain: 1.0 },
        "damper" => {
            number("kv", 1.0)?;
            Law { bias: [0.0; 3], gain: 1.0 }
        }
        "general" => {
            let bias = match node.get("biastype").unwrap_or("none") {
                "none" => [0.0; 3],
                "affine" => affine("biasprm")?,
                other => bail!("{}: biastype = {other} is not supported: write none or affine", node.at()),
            };
            let gain = match node.get("gaintype").unwrap_or("fixed") {
                "fixed" => first("gainprm", 1.0)?,
                "affine" => {
                    let [fixed, by_length, by_speed] = affine("gainprm")?;
                    ensure!(
                        by_length == 0.0 && by_speed == 0.0,
                        "{}: gainprm: a gain that depends on position or speed is not supported: set the second and \
                         the third number to 0",
                        node.at()
                    );
                    fixed
                }
                other => bail!("{}: gaintype = {other} is not supported: write fixed or affine", node.at()),
            };
            Law { bias, gain }
        }
        "position" => damped(number("kp", first("gainprm", 1.0)?)?)?,
        "intvelocity" => damped(number("kp", 1.0)?)?,
        "velocity" => {
            let kv = number("kv", first("gainprm", 1.0)?)?;
            Law { bias: [0.0, 0.0, -kv], gain: kv }
        }
        "cylinder" => {
            let area = match node.one("diameter")? {
                Some(diameter) => 0.25 * std::f64::consts::PI * diameter * diameter,
                None => number("area", 1.0)?,
            };
            Law { bias: affine("bias")?, gain: area }
        }
        other => bail!(
            "{}: the control law of <{other}> is not supported: write <motor>, and let the simulation tool compute its \
             force",
            node.at()
        ),
    })
}
