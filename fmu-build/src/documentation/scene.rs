//! The scene file `resources/<Name>_visual.xml`, which OpenModelica's viewers draw.
//!
//! In: the scene of a mechanism, its poses at the start and over the travel. Out: shapes in the frames of the bodies as
//! XML. The bytes depend only on the definition. The module must not know how a viewer draws.
//!
//! A number of the format is a constant or the name of a variable. With the axes of a frame as the rows of T, and its
//! origin r, a point p of the frame is at r + p T in the mechanism frame. A shape extends from there along `lengthDir`
//! T over its length.

use super::Picture;
use crate::drawing::{Ink, hull, position};
use crate::xml::common::{Xml, document, group, number};
use anyhow::Result;
use linkage_fmu::component::Component;
use linkage_fmu::mechanism::inspection::{DrawnBody, DrawnJoint, On, Pose, Scene};
use quick_xml::events::BytesText;
use std::io;

/// Half the width of a body relative to the size of the mechanism, as in the drawing.
const HALF: f64 = 0.022;
/// Distance below which two points coincide, relative to the size of the mechanism.
const LEAST: f64 = 1e-9;
/// Number of positions of the travel from which the range of a guide is found.
const POSITIONS: usize = 200;
/// Largest number of shapes. A viewer moves each shape in each frame.
const MOST_SHAPES: usize = 5000;
/// Part of the light that a surface reflects like a mirror.
const SPECULAR: f64 = 0.7;

const X: [f64; 3] = [1.0, 0.0, 0.0];
const DOWN: [f64; 3] = [0.0, -1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Path of the scene file in the FMU of this name.
pub fn path(name: &str) -> String {
    format!("resources/{name}_visual.xml")
}

/// A number of the format.
enum Value {
    Constant(f64),
    Variable(String),
}

/// A solid in the frame of a body of the linkage.
struct Solid {
    name: String,
    /// Word of the format.
    kind: &'static str,
    frame: usize,
    /// Point from which the solid extends along its direction [m].
    from: [f64; 3],
    along: [f64; 3],
    length: Value,
    /// Width and height [m]. The diameter of a round solid.
    sides: [f64; 2],
    ink: Ink,
}

/// The scene file. None for a model without a linkage, or with too many shapes for a viewer.
///
/// # Errors
/// XML cannot be written.
pub fn xml(component: &Component, picture: &Picture) -> Result<Option<String>> {
    let (Component::Mechanism(model), Picture::Mechanism { scene, start, .. }) = (component, picture) else {
        return Ok(None);
    };
    let has_guides = scene.joints.iter().any(|joint| joint.axis.is_some());
    let sweep = has_guides.then(|| model.clone().sweep(POSITIONS).ok()).flatten();
    let mut travel = sweep.map_or_else(Vec::new, |sweep| sweep.poses);
    travel.push(start.clone());
    let solids = Draft { scene, start, travel: &travel, half: HALF * scene.size, solids: Vec::new() }.solids();
    if solids.len() > MOST_SHAPES {
        return Ok(None);
    }
    let write = |xml: &mut Xml| solids.iter().try_for_each(|solid| solid.write(xml, scene));
    document("visualization", &[], write).map(Some)
}

struct Draft<'a> {
    scene: &'a Scene,
    start: &'a [Pose],
    travel: &'a [Vec<Pose>],
    /// Half the width of a body [m].
    half: f64,
    solids: Vec<Solid>,
}

impl Draft<'_> {
    fn solids(mut self) -> Vec<Solid> {
        let scene = self.scene;
        self.ground();
        scene.bodies.iter().filter(|body| body.center.frame != 0).for_each(|body| self.body(body));
        scene.joints.iter().for_each(|joint| self.joint(joint));
        self.solids
    }

    /// Supports below the points of the ground with a pin or with the end of a drive or spring.
    fn ground(&mut self) {
        let scene = self.scene;
        let pins = scene.joints.iter().filter(|joint| joint.axis.is_none()).flat_map(|j| [j.first, j.second]);
        let ends = scene.actuators.iter().chain(&scene.springs).flat_map(|c| c.ends.into_iter().flatten());
        let mut supports: Vec<[f64; 2]> = Vec::new();
        for On { at, .. } in pins.chain(ends).filter(|on| on.frame == 0) {
            if !supports.contains(&at) {
                supports.push(at);
            }
        }
        for (k, [x, y]) in supports.into_iter().enumerate() {
            let length = Value::Constant(2.0 * self.half);
            self.solids.push(Solid {
                name: format!("ground.support{}", k + 1),
                kind: "box",
                frame: 0,
                from: [x, y, 0.0],
                along: DOWN,
                length,
                sides: [2.4 * self.half; 2],
                ink: Ink::Metal,
            });
        }
    }

    /// The edges of a body's hull as rods. A single point is a ball, unless the block of a prismatic joint is there.
    fn body(&mut self, body: &DrawnBody) {
        let frame = body.center.frame;
        let ink = Ink::Body(frame - 1);
        let corners = hull(body.points.iter().map(|point| point.on.at).collect(), LEAST * self.scene.size);
        let edges = match corners.len() {
            0 | 1 => 0,
            2 => 1,
            count => count,
        };
        if let (0, Some(&center)) = (edges, corners.first())
            && !self.is_slider(frame)
        {
            self.ball(format!("body.{}", body.name), On { frame, at: center }, 3.8 * self.half, ink);
        }
        for k in 0..edges {
            let name = match edges {
                1 => format!("body.{}", body.name),
                _ => format!("body.{}.side{}", body.name, k + 1),
            };
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            self.rod(name, frame, [a, b], 2.0 * self.half, ink);
            if edges > 1 {
                // A ball rounds the corner.
                self.ball(format!("body.{}.corner{}", body.name, k + 1), On { frame, at: a }, 2.0 * self.half, ink);
            }
        }
    }

    fn is_slider(&self, frame: usize) -> bool {
        let mut joints = self.scene.joints.iter().filter(|joint| joint.axis.is_some());
        joints.any(|joint| [joint.first.frame, joint.second.frame].contains(&frame))
    }

    fn rod(&mut self, name: String, frame: usize, [a, b]: [[f64; 2]; 2], diameter: f64, ink: Ink) {
        let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        self.solids.push(Solid {
            name,
            kind: "cylinder",
            frame,
            from: [a[0], a[1], 0.0],
            along: [dx, dy, 0.0],
            length: Value::Constant(dx.hypot(dy)),
            sides: [diameter; 2],
            ink,
        });
    }

    fn ball(&mut self, name: String, On { frame, at: [x, y] }: On, diameter: f64, ink: Ink) {
        let length = Value::Constant(diameter);
        let from = [x, y, -0.5 * diameter];
        self.solids.push(Solid { name, kind: "sphere", frame, from, along: Z, length, sides: [diameter; 2], ink });
    }

    /// A pin, or a block on its guide.
    fn joint(&mut self, joint: &DrawnJoint) {
        let (half, second) = (self.half, joint.second);
        let Some(axis) = joint.axis else {
            let On { frame, at: [x, y] } = joint.first;
            let length = 3.2 * half;
            self.solids.push(Solid {
                name: format!("joint.{}", joint.name),
                kind: "cylinder",
                frame,
                from: [x, y, -0.5 * length],
                along: Z,
                length: Value::Constant(length),
                sides: [1.24 * half; 2],
                ink: Ink::Line,
            });
            return;
        };
        let slides: Vec<f64> = self.travel.iter().map(|poses| slide(joint, axis, poses)[0]).collect();
        let low = slides.iter().copied().fold(f64::INFINITY, f64::min);
        let high = slides.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [x, y] = joint.first.at;
        let at = |s: f64| [x + s * axis[0], y + s * axis[1]];
        let ends = [at(low.min(0.0) - 2.9 * half), at(high.max(0.0) + 2.9 * half)];
        self.rod(format!("guide.{}", joint.name), joint.first.frame, ends, 0.5 * half, Ink::Muted);
        self.drive(joint, axis, low);
        // The block is on the axis, also if the second point is not. Its position in its body and its angle to the axis
        // are constant.
        let [_, aside] = slide(joint, axis, self.start);
        let (sin, cos) = (self.start[joint.first.frame][0] - self.start[second.frame][0]).sin_cos();
        let along = [cos * axis[0] - sin * axis[1], sin * axis[0] + cos * axis[1]];
        let [u, v] = [second.at[0] + aside * along[1], second.at[1] - aside * along[0]];
        let length = 3.8 * half;
        self.solids.push(Solid {
            name: format!("joint.{}", joint.name),
            kind: "box",
            frame: second.frame,
            from: [u - 0.5 * length * along[0], v - 0.5 * length * along[1], 0.0],
            along: [along[0], along[1], 0.0],
            length: Value::Constant(length),
            sides: [2.3 * half; 2],
            ink: Ink::Body(second.frame.max(joint.first.frame).saturating_sub(1)),
        });
    }

    /// A drive along the guide: its direction is that of the axis, its length is its own variable. A drive whose
    /// position changes its sign is skipped, as its cylinder would have a negative length.
    fn drive(&mut self, joint: &DrawnJoint, axis: [f64; 2], low: f64) {
        let drives = self.scene.actuators.iter().filter(|drive| drive.ends.is_none());
        let of_joint = |index: usize| self.scene.joints.get(index).is_some_and(|other| other.name == joint.name);
        let Some(drive) = drives.into_iter().find(|drive| drive.joint.is_some_and(of_joint)) else { return };
        if low > 0.0 {
            self.solids.push(Solid {
                name: format!("drive.{}", drive.name),
                kind: "cylinder",
                frame: joint.first.frame,
                from: [joint.first.at[0], joint.first.at[1], 0.0],
                along: [axis[0], axis[1], 0.0],
                length: Value::Variable(format!("{}.position", drive.name)),
                sides: [1.2 * self.half; 2],
                ink: Ink::Metal,
            });
        }
    }
}

/// Position of the second point of a prismatic joint along the axis through the first point, and to the left of the
/// axis [m].
fn slide(joint: &DrawnJoint, axis: [f64; 2], poses: &[Pose]) -> [f64; 2] {
    let (a, b) = (position(poses, joint.first), position(poses, joint.second));
    let (sin, cos) = poses[joint.first.frame][0].sin_cos();
    let [x, y] = [cos * axis[0] - sin * axis[1], sin * axis[0] + cos * axis[1]];
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    [dx * x + dy * y, x * dy - y * dx]
}

impl Solid {
    fn write(&self, xml: &mut Xml, scene: &Scene) -> io::Result<()> {
        let of_frame = |suffix: &str, at_rest: f64| match self.frame {
            0 => Value::Constant(at_rest),
            frame => Value::Variable(format!("{}.frame.{suffix}", scene.frames[frame])),
        };
        let [zero, one] = [0.0, 1.0].map(|value| move || Value::Constant(value));
        let rotation = [
            of_frame("cos", 1.0),
            of_frame("sin", 0.0),
            zero(),
            of_frame("minus_sin", 0.0),
            of_frame("cos", 1.0),
            zero(),
            zero(),
            zero(),
            one(),
        ];
        let [width, height] = self.sides.map(Value::Constant);
        // Transverse direction: z, or x for a solid along z.
        let across = if self.along == Z { X } else { Z };
        group(xml, "shape", |xml| {
            text(xml, "ident", &self.name)?;
            text(xml, "type", self.kind)?;
            values(xml, "T", &rotation)?;
            values(xml, "r", &[of_frame("x", 0.0), of_frame("y", 0.0), zero()])?;
            values(xml, "r_shape", &self.from.map(Value::Constant))?;
            values(xml, "lengthDir", &self.along.map(Value::Constant))?;
            values(xml, "widthDir", &across.map(Value::Constant))?;
            values(xml, "length", std::slice::from_ref(&self.length))?;
            values(xml, "width", &[width])?;
            values(xml, "height", &[height])?;
            values(xml, "extra", &[zero()])?;
            values(xml, "color", &self.ink.light().map(|part| Value::Constant(f64::from(part))))?;
            values(xml, "specCoeff", &[Value::Constant(SPECULAR)])
        })
    }
}

fn text(xml: &mut Xml, name: &str, content: &str) -> io::Result<()> {
    xml.create_element(name).write_text_content(BytesText::new(content)).map(drop)
}

fn values(xml: &mut Xml, name: &str, all: &[Value]) -> io::Result<()> {
    group(xml, name, |xml| {
        all.iter().try_for_each(|value| match value {
            // Adding 0 removes the sign of a negative zero.
            Value::Constant(value) => text(xml, "exp", &number(value + 0.0)),
            Value::Variable(name) => text(xml, "cref", name),
        })
    })
}
