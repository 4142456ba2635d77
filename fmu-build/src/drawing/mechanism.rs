//! The drawing of a mechanism in one position.
//!
//! In: the scene and the poses of the linkage's bodies. Out: ground, bodies, springs, drives, joints, markers; for a
//! page also names, axes, a scale and the direction of gravity.

mod connections;
mod stops;

use super::geometry::{hull, mean, round_below, union, with_prefix};
use super::labels::{Wish, place};
use super::{Along, Drawing, Form, Format, Ink, Part, Point, Shape, Weight, arrow};
use linkage_fmu::mechanism::inspection::{DrawnBody, DrawnJoint, On, Pose, Scene, SweptStop};

/// Largest ratio of height to width of a page.
const HIGHEST: f64 = 0.64;
/// Smallest height of a page [px].
const LOWEST: f64 = 300.0;
/// Margins of a page [px], and of an icon relative to its shorter side.
const MARGINS: [f64; 2] = [78.0, 0.13];
/// Largest number of drawn names of parts of one kind. More names would not be readable.
const MOST_NAMES: usize = 60;
/// Smallest width of a page with names of joints [px].
const WIDE: f64 = 600.0;
/// Distance below which two points coincide [px].
const LEAST: f64 = 1e-6;
const DASHED: &[f64] = &[9.0, 3.0, 2.0, 3.0];
const DOTTED: &[f64] = &[4.0, 3.0];

/// A mechanism in a position, with a drawing in progress.
struct Draft<'a> {
    scene: &'a Scene,
    poses: &'a [Pose],
    format: Format,
    size: [f64; 2],
    /// Pixels per metre.
    scale: f64,
    /// The mechanism frame's origin [px].
    origin: Point,
    /// Half the width of a body [px].
    half: f64,
    /// Factor of the sizes of symbols.
    unit: f64,
    shapes: Vec<Shape>,
    wishes: Vec<Wish>,
}

/// The drawing of a mechanism of this name, with dashed outlines of bodies at their stops.
pub fn mechanism(name: &str, scene: &Scene, poses: &[Pose], stops: &[SweptStop], format: Format) -> Drawing {
    let extents = stops.iter().map(|met| extents(scene, &met.poses)).fold(extents(scene, poses), union);
    within(name, scene, (poses, stops), format, extents)
}

/// The drawings of two designs of a mechanism on the same scale next to each other, each with its title.
pub fn designs(name: &str, all: [(&str, &Scene, &[Pose]); 2], format: Format) -> Drawing {
    let [a, b] = all.map(|(_, scene, poses)| extents(scene, poses));
    let [left, right] = all.map(|(title, scene, poses)| {
        let mut drawing = within(name, scene, (poses, &[]), format, union(a, b));
        let middle = [0.5 * drawing.size[0], 22.0];
        let (text, weight, ink) = (title.to_owned(), Weight::Strong, Ink::Line);
        drawing.labels.push(super::Label { middle, text, weight, ink });
        drawing.title = format!("{name}, {title}");
        drawing
    });
    left.next_to(right)
}

/// The drawing with these smallest and largest x and y [m].
fn within(
    name: &str,
    scene: &Scene,
    (poses, stops): (&[Pose], &[SweptStop]),
    format: Format,
    [left, low, right, high]: [f64; 4],
) -> Drawing {
    let least = 0.1 * scene.size;
    let (wide, tall) = ((right - left).max(least), (high - low).max(least));
    let (size, margin) = match format {
        Format::Icon { side } => ([side; 2], MARGINS[1] * side),
        Format::Page { width } => {
            let margin = MARGINS[0].min(MARGINS[1] * width);
            let (scale, most) = ((width - 2.0 * margin) / wide, (HIGHEST * width).max(1.4 * LOWEST));
            ([width, (scale * tall + 2.0 * margin).clamp(LOWEST, most)], margin)
        }
    };
    let scale = ((size[0] - 2.0 * margin) / wide).min((size[1] - 2.0 * margin) / tall);
    let unit = format.symbols();
    let mut draft = Draft {
        scene,
        poses,
        format,
        size,
        scale,
        origin: [0.5 * (size[0] - scale * (left + right)), 0.5 * (size[1] + scale * (low + high))],
        half: (0.022 * scene.size * scale).clamp(3.5 * unit, 9.0 * unit),
        unit,
        shapes: Vec::new(),
        wishes: Vec::new(),
    };
    draft.ground();
    draft.stops(stops);
    draft.bodies();
    draft.outlines();
    draft.connections();
    draft.joints();
    draft.markers();
    let mut drawing = Drawing {
        size,
        title: format!("{name} at its start"),
        description: description(scene),
        labels: Vec::new(),
        shapes: Vec::new(),
    };
    if format.is_page() {
        draft.frame(&mut drawing);
        let wishes = std::mem::take(&mut draft.wishes);
        drawing.labels = place(wishes, std::mem::take(&mut drawing.labels), &draft.shapes, size);
    }
    drawing.shapes = draft.shapes;
    drawing
}

/// Position of a point in the mechanism frame [m].
pub fn position(poses: &[Pose], on: On) -> [f64; 2] {
    let [angle, x, y] = poses[on.frame];
    let ((sin, cos), [u, v]) = (angle.sin_cos(), on.at);
    [x + cos * u - sin * v, y + sin * u + cos * v]
}

/// Smallest and largest x and y of all drawn parts [m].
fn extents(scene: &Scene, poses: &[Pose]) -> [f64; 4] {
    let bodies = scene.bodies.iter().filter(|body| frame(body) != 0);
    let of_bodies = bodies.flat_map(|body| body.points.iter().map(|point| point.on));
    let ends = scene.actuators.iter().chain(&scene.springs).flat_map(|c| c.ends.into_iter().flatten());
    let of_joints = scene.joints.iter().flat_map(|joint| [joint.first, joint.second]);
    let of_outlines =
        scene.outlines.iter().flat_map(|outline| outline.points.iter().map(|&at| On { frame: outline.frame, at }));
    let all = of_bodies.chain(ends).chain(of_joints).chain(of_outlines).map(|on| position(poses, on));
    let none = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    let found = all.fold(none, |[l, b, r, t], [x, y]| [l.min(x), b.min(y), r.max(x), t.max(y)]);
    if found[0] > found[2] { [0.0, 0.0, 1.0, 1.0] } else { found }
}

/// Width and height of all drawn parts [m].
pub fn sides(scene: &Scene, poses: &[Pose]) -> [f64; 2] {
    let [left, low, right, high] = extents(scene, poses);
    [right - left, high - low]
}

/// Frame of a body.
fn frame(body: &DrawnBody) -> usize {
    body.center.frame
}

/// Largest distance of a point of a body from its first point [m].
fn reach(body: &DrawnBody) -> f64 {
    let [x, y] = body.points[0].on.at;
    body.points.iter().map(|point| (point.on.at[0] - x).hypot(point.on.at[1] - y)).fold(0.0, f64::max)
}

/// Description of the drawing in words.
fn description(scene: &Scene) -> String {
    let listed = |names: Vec<&str>| names.join(", ");
    let bodies = listed(scene.bodies.iter().filter(|body| frame(body) != 0).map(|body| &*body.name).collect());
    let name = |frame: usize| scene.frames.get(frame).map_or("", String::as_str);
    let joints = scene.joints.iter().map(|joint| {
        let is_slot = scene.outlines.iter().any(|outline| outline.name == joint.name);
        let kind = if is_slot { "slot" } else { ["revolute", "prismatic"][usize::from(joint.axis.is_some())] };
        format!("{} ({kind}) between {} and {}", joint.name, name(joint.first.frame), name(joint.second.frame))
    });
    let mut text = format!("Bodies: {bodies}. Joints: {}.", joints.collect::<Vec<_>>().join("; "));
    for (kind, all) in [("Drives", &scene.actuators), ("Springs and dampers", &scene.springs)] {
        if !all.is_empty() {
            text += &format!(" {kind}: {}.", listed(all.iter().map(|connection| &*connection.name).collect()));
        }
    }
    text
}

impl Draft<'_> {
    /// A point of the mechanism frame in pixels.
    fn pixel(&self, [x, y]: [f64; 2]) -> Point {
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }

    fn at(&self, on: On) -> Point {
        self.pixel(position(self.poses, on))
    }

    fn wish(&mut self, at: Point, away: f64, text: &str, weight: Weight, ink: Ink) {
        self.wishes.push(Wish { at, away, text: text.to_owned(), weight, ink });
    }

    /// A line with hatching on its right, seen along it.
    fn hatch(&mut self, line: Along, [from, to]: [f64; 2], aside: f64) {
        let u = self.unit;
        self.shapes.push(Shape::line(vec![line.at(from, aside), line.at(to, aside)], Ink::Steel, 1.5 * u));
        let count = ((to - from) / (6.0 * u)).round().max(1.0) as usize;
        for k in 0..=count {
            let s = from + (to - from) * k as f64 / count as f64;
            let stroke = vec![line.at(s, aside), line.at(s - 5.0 * u, aside + 7.0 * u)];
            self.shapes.push(Shape::line(stroke, Ink::Steel, u.max(0.6)));
        }
    }

    /// Supports of the ground's pins, and the rails of prismatic joints.
    fn ground(&mut self) {
        let scene = self.scene;
        let pins =
            scene.joints.iter().filter(|joint| joint.axis.is_none()).flat_map(|joint| [joint.first, joint.second]);
        let ends = scene.actuators.iter().chain(&scene.springs).flat_map(|c| c.ends.into_iter().flatten());
        let mut supports: Vec<Point> = Vec::new();
        for on in pins.chain(ends).filter(|on| on.frame == 0) {
            let at = self.at(on);
            if !supports.contains(&at) {
                supports.push(at);
            }
        }
        let u = self.unit;
        for [x, y] in supports {
            let bracket = vec![[x, y], [x - 11.0 * u, y + 18.0 * u], [x + 11.0 * u, y + 18.0 * u]];
            self.shapes.push(Shape::area(bracket, Ink::Metal, (Ink::Steel, 1.3 * u)));
            self.hatch(Along { origin: [x, y], unit: [1.0, 0.0] }, [-18.0 * u, 18.0 * u], 18.0 * u);
        }
        for joint in scene.joints.iter().filter(|joint| joint.first.frame == 0) {
            if let Some((axis, slide)) = self.rail(joint) {
                let ends = [slide.min(0.0) - 26.0 * u, slide.max(0.0) + 26.0 * u];
                self.hatch(axis, ends, 11.0 * u);
                let line = vec![axis.at(ends[0], 0.0), axis.at(ends[1], 0.0)];
                self.shapes.push(Shape::line(line, Ink::Muted, u.max(0.6)).dashed(DASHED));
            }
        }
    }

    /// The axis of a prismatic joint through its first point, and the position of the second on it [px].
    fn rail(&self, joint: &DrawnJoint) -> Option<(Along, f64)> {
        let [x, y] = joint.axis?;
        let (sin, cos) = self.poses[joint.first.frame][0].sin_cos();
        let (first, second) = (self.at(joint.first), self.at(joint.second));
        let unit = [cos * x - sin * y, -(sin * x + cos * y)];
        let slide = (second[0] - first[0]) * unit[0] + (second[1] - first[1]) * unit[1];
        Some((Along { origin: first, unit }, slide))
    }

    fn bodies(&mut self) {
        let scene = self.scene;
        let mut bodies: Vec<&DrawnBody> = scene.bodies.iter().filter(|body| frame(body) != 0).collect();
        // A long body would hide a short body on the same line.
        bodies.sort_by(|a, b| reach(b).total_cmp(&reach(a)));
        let is_named = bodies.len() <= MOST_NAMES;
        for body in bodies {
            let number = frame(body) - 1;
            let corners = hull(body.points.iter().map(|point| self.at(point.on)).collect(), LEAST);
            let middle = mean(&corners);
            // A line leads to a centre of mass outside of the points. The body covers the rest of the line.
            if body.mass > 0.0 && self.format.is_page() {
                let center = self.at(body.center);
                self.shapes.push(Shape::line(vec![middle, center], Ink::Edge(number), 1.2).dashed(DOTTED));
                self.shapes.push(Shape::circle(center, 3.0, Ink::Edge(number), (Ink::Paper, 1.0)));
            }
            let (half, part) = (self.half, |shape: Shape| shape.of(Part::Body, &body.name));
            match corners.as_slice() {
                [center] if !self.is_slider(body) => {
                    let edge = (Ink::Edge(number), 1.3 * self.unit);
                    self.shapes.push(part(Shape::circle(*center, 1.9 * half, Ink::Body(number), edge)));
                }
                [_] | [] => {}
                _ => {
                    let is_closed = corners.len() > 2;
                    let form = Form::Lines { points: corners.clone(), is_closed };
                    let stroked = |ink: Ink, width: f64, fill: Option<Ink>| Shape {
                        form: form.clone(),
                        fill,
                        stroke: Some((ink, width)),
                        dashes: &[],
                        part: None,
                    };
                    self.shapes.push(stroked(Ink::Edge(number), 2.0 * half + 2.4 * self.unit, None));
                    let fill = is_closed.then_some(Ink::Body(number));
                    self.shapes.push(part(stroked(Ink::Body(number), 2.0 * half, fill)));
                }
            }
            let away = if corners.len() == 1 { 2.0 * half + 6.0 } else { half + 2.0 };
            if is_named {
                self.wish(middle, away, &body.name, Weight::Strong, Ink::Edge(number));
            }
        }
    }

    /// Pitch curves of wheels and profiles of cams.
    fn outlines(&mut self) {
        let scene = self.scene;
        for outline in &scene.outlines {
            let ink = if outline.frame == 0 { Ink::Muted } else { Ink::Edge(outline.frame - 1) };
            let points = outline.points.iter().map(|&at| self.at(On { frame: outline.frame, at })).collect();
            let form = Form::Lines { points, is_closed: outline.is_closed };
            let stroke = Some((ink, 1.6 * self.unit));
            self.shapes.push(Shape { form, fill: None, stroke, dashes: &[], part: None });
        }
    }

    /// Whether a body is drawn as the block of its prismatic joint.
    fn is_slider(&self, body: &DrawnBody) -> bool {
        let mut joints = self.scene.joints.iter().filter(|joint| joint.axis.is_some());
        joints.any(|joint| [joint.first.frame, joint.second.frame].contains(&frame(body)))
    }

    fn joints(&mut self) {
        let (scene, u) = (self.scene, self.unit);
        let is_named = scene.joints.len() <= MOST_NAMES && self.size[0] >= WIDE;
        for joint in &scene.joints {
            let at = self.at(joint.second);
            if let Some((axis, slide)) = self.rail(joint) {
                let number = joint.second.frame.max(joint.first.frame).saturating_sub(1);
                let block = axis.rectangle([slide - 17.0 * u, slide + 17.0 * u], [-10.5 * u, 10.5 * u]);
                // The block is on the axis, also if the second point is not.
                self.shapes.push(Shape::area(block, Ink::Body(number), (Ink::Edge(number), 1.3 * u)));
                let dot = Shape::circle(at, 2.2 * u, Ink::Line, (Ink::Line, 0.5 * u));
                self.shapes.push(dot.of(Part::Joint, &joint.name));
            } else {
                let radius = (0.62 * self.half).max(3.4 * u);
                let pin = Shape::circle(self.at(joint.first), radius, Ink::Paper, (Ink::Line, 1.7 * u));
                self.shapes.push(pin.of(Part::Joint, &joint.name));
            }
            if is_named {
                let away = if joint.axis.is_some() { 12.0 } else { 0.62 * self.half + 2.0 };
                self.wish(at, away, &joint.name, Weight::Plain, Ink::Line);
            }
        }
    }

    fn markers(&mut self) {
        let (scene, r) = (self.scene, 5.0 * self.unit);
        let is_named = scene.markers.len() <= MOST_NAMES;
        for marker in &scene.markers {
            let [x, y] = self.at(marker.on);
            let diamond = vec![[x, y - r], [x + r, y], [x, y + r], [x - r, y]];
            let shape = Shape::area(diamond, Ink::Accent, (Ink::Paper, self.unit));
            self.shapes.push(shape.of(Part::Marker, &marker.name));
            // Most markers have the name of their part.
            if is_named && !self.wishes.iter().any(|wish| wish.text == marker.name) {
                self.wish([x, y], r, &marker.name, Weight::Plain, Ink::Accent);
            }
        }
    }

    /// Axes of the mechanism frame, a scale of lengths, the direction of gravity.
    fn frame(&mut self, drawing: &mut Drawing) {
        let [width, height] = self.size;
        let inside = |[x, y]: Point| x > 10.0 && y > 60.0 && x < width - 60.0 && y < height - 10.0;
        let origin = Some(self.pixel([0.0, 0.0])).filter(|at| inside(*at)).unwrap_or([24.0, height - 44.0]);
        let mut fixed = |middle: Point, text: &str| {
            let (text, weight, ink) = (text.to_owned(), Weight::Plain, Ink::Muted);
            drawing.labels.push(super::Label { middle, text, weight, ink });
        };
        for (name, [x, y]) in [("x", [1.0, 0.0]), ("y", [0.0, -1.0])] {
            let to = |r: f64| [origin[0] + r * x, origin[1] + r * y];
            self.shapes.extend(arrow(origin, to(48.0), 7.0, Ink::Muted, 1.4));
            fixed(to(57.0), name);
        }
        let length = round_below(0.24 * width / self.scale);
        let (pixels, [x, y]) = (length * self.scale, [18.0, height - 14.0]);
        let ruler = vec![[x, y - 5.0], [x, y], [x + pixels, y], [x + pixels, y - 5.0]];
        self.shapes.push(Shape::line(ruler, Ink::Muted, 1.3));
        fixed([x + 0.5 * pixels, y - 10.0], &with_prefix(length));
        let weight = self.scene.weights.iter().map(|weight| weight.force).find(|[x, y]| x.hypot(*y) > 0.0);
        if let Some([gx, gy]) = weight {
            let size = gx.hypot(gy);
            let [ux, uy] = [gx / size, -gy / size];
            let middle = [width - 36.0, 38.0];
            let end = |r: f64| [middle[0] + r * ux, middle[1] + r * uy];
            self.shapes.extend(arrow(end(-16.0), end(20.0), 8.0, Ink::Muted, 1.6));
            fixed([middle[0] - 14.0 * uy.abs().max(0.3), middle[1] - 14.0 * ux.abs()], "g");
        }
    }
}
