//! One picture of a mechanism: bodies, wheels and cams, joints, drives, springs, paths of markers, the time.
//!
//! In: the scene and the poses of a film. Out: pixels.

use super::Still;
use super::canvas::{Canvas, Colour, Font, Point, Size, WHITE, between, distance};
use anyhow::Result;
use fmu_build::drawing::{BODIES, hull, position};
use linkage_fmu::mechanism::inspection::{Connection, DrawnBody, DrawnJoint, DrawnOutline, On, Pose, Scene, Surface};

/// Width of all pictures, and bounds of their height [px].
const WIDTH: u16 = 400;
const HEIGHTS: [f64; 2] = [180.0, 360.0];
/// Space above and below the mechanism for name, time and names of the bodies, and around it [px].
const HEAD: f64 = 40.0;
const FOOT: f64 = 24.0;
const MARGIN: f64 = 22.0;
/// Half the width of a body relative to the size of the mechanism, and its bounds [px].
const HALF: f64 = 0.02;
const HALVES: [f64; 2] = [2.6, 5.0];
/// Colours of lines, joints and text; of the ground and secondary text; of drives; of springs; of markers and their
/// paths.
const INK: Colour = [38, 50, 56];
const GROUND: Colour = [120, 130, 138];
const DRIVE: Colour = [84, 96, 106];
const SPRING: Colour = [70, 130, 90];
const MARKER: Colour = [200, 80, 60];
const TRACE: Colour = [228, 168, 158];

/// Common data of all pictures of a film.
pub struct Drawing<'a> {
    name: &'a str,
    pace: &'a str,
    scene: &'a Scene,
    size: Size,
    /// Pixels per metre, and position of the mechanism's origin [px].
    scale: f64,
    origin: Point,
    /// Half the width of a body [px].
    half: f64,
    /// Paths of the markers [px].
    paths: Vec<Vec<Point>>,
    /// Smallest and largest position of each prismatic joint [m].
    slides: Vec<[f64; 2]>,
    /// Smallest distance of the ends of each drive between two points [m].
    barrels: Vec<f64>,
    /// Number of digits of the time.
    digits: usize,
}

/// A direction of a body's frame in the mechanism frame.
fn direct(pose: &Pose, [x, y]: Point) -> Point {
    let (sin, cos) = pose[0].sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// Position of a prismatic joint with this axis [m].
fn slide(poses: &[Pose], joint: &DrawnJoint, axis: Point) -> f64 {
    let (a, b) = (position(poses, joint.first), position(poses, joint.second));
    let [x, y] = direct(&poses[joint.first.frame], axis);
    (b[0] - a[0]) * x + (b[1] - a[1]) * y
}

impl<'a> Drawing<'a> {
    /// The drawing of a film with these stills, at least one.
    pub fn new(name: &'a str, pace: &'a str, scene: &'a Scene, stills: &[Still]) -> Self {
        let ends = scene.actuators.iter().chain(&scene.springs).flat_map(|connection| connection.ends.iter().flatten());
        let of_bodies = scene.bodies.iter().flat_map(|body| &body.points).map(|point| &point.on);
        let of_joints = scene.joints.iter().flat_map(|joint| [&joint.first, &joint.second]);
        let markers = scene.markers.iter().map(|marker| &marker.on);
        let edges = scene.surfaces.iter().filter_map(edges).flatten();
        // Points of the ground are drawn if something is attached to them.
        let moving = of_bodies.chain(markers).filter(|on| on.frame > 0);
        let outlines = scene.outlines.iter().flat_map(points_of);
        let points: Vec<On> = moving.chain(of_joints).chain(ends).copied().chain(edges).chain(outlines).collect();
        let mut least = [f64::INFINITY; 2];
        let mut most = [f64::NEG_INFINITY; 2];
        for still in stills {
            for point in points.iter().map(|on| position(&still.poses, *on)) {
                for i in 0..2 {
                    (least[i], most[i]) = (least[i].min(point[i]), most[i].max(point[i]));
                }
            }
        }
        let extent = [0, 1].map(|i| (most[i] - least[i]).max(0.1 * scene.size));
        let room = f64::from(WIDTH) - 2.0 * MARGIN;
        let height = (extent[1] * room / extent[0] + 2.0 * MARGIN + HEAD + FOOT).clamp(HEIGHTS[0], HEIGHTS[1]).round();
        let scale = (room / extent[0]).min((height - 2.0 * MARGIN - HEAD - FOOT) / extent[1]);
        let middle = [f64::from(WIDTH) / 2.0, HEAD + (height - HEAD - FOOT) / 2.0];
        let origin = [middle[0] - scale * (least[0] + most[0]) / 2.0, middle[1] + scale * (least[1] + most[1]) / 2.0];
        let duration = stills[stills.len() - 1].time - stills[0].time;
        let mut drawing = Self {
            name,
            pace,
            scene,
            size: Size { width: WIDTH, height: height as u16 },
            scale,
            origin,
            half: (HALF * scene.size * scale).clamp(HALVES[0], HALVES[1]),
            paths: Vec::new(),
            slides: Vec::new(),
            barrels: Vec::new(),
            digits: (3.0 - duration.log10().floor()).clamp(0.0, 9.0) as usize,
        };
        let path = |on: On| stills.iter().map(|still| drawing.at(position(&still.poses, on))).collect();
        drawing.paths = scene.markers.iter().map(|marker| path(marker.on)).collect();
        let range = |joint: &DrawnJoint| {
            let positions = stills.iter().map(|still| slide(&still.poses, joint, joint.axis.unwrap_or_default()));
            positions.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], s| [a.min(s), b.max(s)])
        };
        drawing.slides = scene.joints.iter().map(range).collect();
        let least = |drive: &Connection| {
            let lengths = stills.iter().filter_map(|still| {
                drive
                    .ends
                    .map(|[first, second]| distance(position(&still.poses, first), position(&still.poses, second)))
            });
            lengths.fold(f64::INFINITY, f64::min)
        };
        drawing.barrels = scene.actuators.iter().map(least).collect();
        drawing
    }

    /// Size of the pictures.
    pub fn size(&self) -> Size {
        self.size
    }

    /// Colours of the drawing, without white.
    pub fn colours(&self) -> Vec<Colour> {
        let bodies = self.scene.bodies.iter().filter(|body| frame(body) > 0).map(|body| colour(frame(body)));
        let mut colours: Vec<Colour> = Vec::new();
        for own in [INK, GROUND, DRIVE, SPRING, MARKER].into_iter().chain(bodies) {
            if !colours.contains(&own) {
                colours.push(own);
            }
        }
        colours
    }

    /// A point of the mechanism frame in pixels.
    fn at(&self, [x, y]: Point) -> Point {
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }

    /// The pixels of one still, line by line.
    ///
    /// # Errors
    /// The picture has no size.
    pub fn picture(&self, still: &Still, font: &Font) -> Result<Vec<Colour>> {
        let mut picture = Picture { drawing: self, canvas: Canvas::new(self.size, font)?, poses: &still.poses };
        picture.draw(still.time);
        Ok(picture.canvas.pixels())
    }
}

/// Ends of a surface with a direction.
fn edges(surface: &Surface) -> Option<[On; 2]> {
    let ([x, y], On { frame, at: [u, v] }) = (surface.half?, surface.middle);
    Some([On { frame, at: [u - x, v - y] }, On { frame, at: [u + x, v + y] }])
}

/// Points of an outline.
fn points_of(outline: &DrawnOutline) -> impl Iterator<Item = On> + '_ {
    outline.points.iter().map(|&at| On { frame: outline.frame, at })
}

/// Frame of a body of the definition.
fn frame(body: &DrawnBody) -> usize {
    body.center.frame
}

fn colour(frame: usize) -> Colour {
    BODIES[frame.saturating_sub(1) % BODIES.len()]
}

/// A picture in progress.
struct Picture<'a> {
    drawing: &'a Drawing<'a>,
    canvas: Canvas<'a>,
    poses: &'a [Pose],
}

impl Picture<'_> {
    fn draw(&mut self, time: f64) {
        let scene = self.drawing.scene;
        self.ground();
        for path in &self.drawing.paths {
            self.canvas.polyline(path, 1.2, TRACE);
        }
        for body in scene.bodies.iter().filter(|body| frame(body) > 0) {
            self.body(body);
        }
        for outline in &scene.outlines {
            let colour = if outline.frame == 0 { GROUND } else { colour(outline.frame) };
            let first = points_of(outline).take(usize::from(outline.is_closed));
            let points: Vec<Point> = points_of(outline).chain(first).map(|on| self.at(on)).collect();
            self.canvas.polyline(&points, 1.6, colour);
        }
        for surface in &scene.surfaces {
            if let Some([a, b]) = edges(surface) {
                self.canvas.line(self.at(a), self.at(b), 2.0, GROUND);
            }
        }
        for spring in &scene.springs {
            self.spring(spring);
        }
        for (drive, barrel) in scene.actuators.iter().zip(&self.drawing.barrels) {
            self.drive(drive, *barrel);
        }
        for joint in &scene.joints {
            self.joint(joint);
        }
        for marker in &scene.markers {
            self.canvas.dot(self.at(marker.on), 3.0, MARKER);
        }
        self.words(time);
    }

    /// A point of a body in pixels.
    fn at(&self, on: On) -> Point {
        self.drawing.at(position(self.poses, on))
    }

    /// A direction of a body's frame in pixels, of length 1.
    fn direction(&self, frame: usize, along: Point) -> Point {
        let [x, y] = direct(&self.poses[frame], along);
        [x, -y]
    }

    /// Supports of the joints, drives and springs on the ground.
    fn ground(&mut self) {
        let scene = self.drawing.scene;
        let joints = scene.joints.iter().filter(|joint| joint.axis.is_none());
        let joints = joints.flat_map(|joint| [joint.first, joint.second]);
        let ends = scene.actuators.iter().chain(&scene.springs).flat_map(|c| c.ends.into_iter().flatten());
        let (drawing, poses) = (self.drawing, self.poses);
        for [x, y] in joints.chain(ends).filter(|on| on.frame == 0).map(|on| drawing.at(position(poses, on))) {
            let corners = [[x, y], [x - 9.0, y + 14.0], [x + 9.0, y + 14.0]];
            self.canvas.polygon(&corners, [214, 219, 222]);
            self.canvas.polyline(&[corners[0], corners[1], corners[2], corners[0]], 1.2, GROUND);
            self.canvas.hatch([x - 14.0, y + 14.0], [x + 14.0, y + 14.0], GROUND);
        }
        for (joint, [least, most]) in scene.joints.iter().zip(&self.drawing.slides) {
            let Some(axis) = joint.axis else { continue };
            let start = self.at(joint.first);
            let [x, y] = self.direction(joint.first.frame, axis);
            let ends = [least * self.drawing.scale - 20.0, most * self.drawing.scale + 20.0];
            let [a, b] = ends.map(|s| [start[0] + s * x, start[1] + s * y]);
            if joint.first.frame > 0 {
                self.canvas.line(a, b, 1.6, GROUND);
                continue;
            }
            // The rail next to the block, on the right-hand side of the axis.
            let offset = |[u, v]: Point| [u - 10.0 * y, v + 10.0 * x];
            self.canvas.hatch(offset(a), offset(b), GROUND);
        }
    }

    fn body(&mut self, body: &DrawnBody) {
        let (half, colour) = (self.drawing.half, colour(frame(body)));
        let corners = hull(body.points.iter().map(|point| self.at(point.on)).collect(), 0.01);
        let is_joined = |joint: &DrawnJoint| {
            joint.axis.is_some() && [joint.first, joint.second].iter().any(|on| on.frame == frame(body))
        };
        match corners[..] {
            [] => {}
            // The block of a prismatic joint represents the body.
            [_] if self.drawing.scene.joints.iter().any(is_joined) => {}
            [center] => {
                self.canvas.dot(center, 1.9 * half + 1.2, WHITE);
                self.canvas.dot(center, 1.9 * half, colour);
            }
            _ => {
                for (wide, colour) in [(half + 1.2, WHITE), (half, colour)] {
                    self.canvas.polygon(&corners, colour);
                    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                        self.canvas.line(*a, *b, 2.0 * wide, colour);
                        self.canvas.dot(*a, wide, colour);
                    }
                }
            }
        }
    }

    fn joint(&mut self, joint: &DrawnJoint) {
        let radius = (0.62 * self.drawing.half).max(2.6);
        if let Some(axis) = joint.axis {
            let of = if joint.second.frame > 0 { joint.second.frame } else { joint.first.frame };
            let center = self.at(joint.second);
            let [x, y] = self.direction(joint.first.frame, axis);
            let corner = |[u, v]: Point| [center[0] + u * x - v * y, center[1] + u * y + v * x];
            let corners = |u: f64, v: f64| [[-u, -v], [u, -v], [u, v], [-u, v]].map(corner);
            self.canvas.polygon(&corners(15.2, 10.2), WHITE);
            self.canvas.polygon(&corners(14.0, 9.0), colour(of));
            return self.canvas.dot(center, 2.0, WHITE);
        }
        let center = self.at(joint.first);
        self.canvas.dot(center, radius + 1.4, INK);
        self.canvas.dot(center, radius, WHITE);
    }

    /// A cylinder between two points, or an arrow around a joint or around each of two bodies.
    fn drive(&mut self, drive: &Connection, least: f64) {
        if let Some([first, second]) = drive.ends {
            let (a, b) = (self.at(first), self.at(second));
            let length = distance(a, b);
            if length > 0.0 {
                let end = between(a, b, (0.8 * least * self.drawing.scale / length).min(1.0));
                self.canvas.line(a, b, 2.4, DRIVE);
                self.canvas.line(a, end, 10.0, DRIVE);
                self.canvas.line(between(a, end, 1.5 / length), between(a, end, 0.97), 7.0, [222, 227, 231]);
            }
            return [a, b].into_iter().for_each(|end| self.canvas.dot(end, 3.4, DRIVE));
        }
        if let Some(bodies) = drive.bodies {
            return bodies.into_iter().filter(|on| on.frame != 0).for_each(|on| self.motor(on));
        }
        let Some(joint) = drive.joint.and_then(|index| self.drawing.scene.joints.get(index)) else { return };
        if joint.axis.is_none() {
            self.motor(joint.first);
        }
    }

    /// An arrow around a point.
    fn motor(&mut self, on: On) {
        let [x, y] = self.at(on);
        let radius = 2.2 * self.drawing.half + 6.0;
        let point = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [x + radius * cos, y - radius * sin]
        };
        let arc: Vec<Point> = (0..=22).map(|k| point(-20.0 + 10.0 * f64::from(k))).collect();
        self.canvas.polyline(&arc, 2.0, DRIVE);
        let (tip, [u, v]) = (point(212.0), point(200.0));
        let [dx, dy] = [u - x, v - y].map(|part| 5.0 * part / radius);
        self.canvas.polygon(&[tip, [u + dx, v + dy], [u - dx, v - dy]], DRIVE);
    }

    /// A zigzag between two points.
    fn spring(&mut self, spring: &Connection) {
        const TEETH: u32 = 10;
        let Some([first, second]) = spring.ends else { return };
        let (a, b) = (self.at(first), self.at(second));
        let length = distance(a, b);
        let [x, y] = if length > 0.0 { [(b[0] - a[0]) / length, (b[1] - a[1]) / length] } else { [1.0, 0.0] };
        let tooth = |k: u32| {
            let side = if k == 0 || k == TEETH { 0.0 } else { 6.0 - 12.0 * f64::from(k % 2) };
            let [u, v] = between(a, b, 0.1 + 0.8 * f64::from(k) / f64::from(TEETH));
            [u - side * y, v + side * x]
        };
        let mut points = vec![a];
        points.extend((0..=TEETH).map(tooth));
        points.push(b);
        self.canvas.polyline(&points, 1.6, SPRING);
        [a, b].into_iter().for_each(|end| self.canvas.dot(end, 2.6, SPRING));
    }

    /// Name, time and speed above the mechanism, names of the bodies below.
    fn words(&mut self, time: f64) {
        let Size { width, height } = self.drawing.size;
        let right = f64::from(width) - 10.0;
        self.canvas.text(self.drawing.name, [10.0, 8.0], 16.0, INK, false);
        let digits = self.drawing.digits;
        self.canvas.text(&format!("t = {time:.digits$} s"), [right, 8.0], 16.0, INK, true);
        self.canvas.text(self.drawing.pace, [right, 26.0], 12.0, GROUND, true);
        let mut left = 10.0;
        for (frame, name) in self.drawing.scene.frames.iter().enumerate().skip(1) {
            let wide = self.canvas.width(name, 12.0);
            if left + 13.0 + wide > right {
                break;
            }
            let [x, y] = [left, f64::from(height) - 18.0];
            self.canvas.polygon(&[[x, y], [x + 9.0, y], [x + 9.0, y + 9.0], [x, y + 9.0]], colour(frame));
            self.canvas.text(name, [x + 13.0, y - 2.0], 12.0, INK, false);
            left += 13.0 + wide + 12.0;
        }
    }
}
