//! Springs and drives in the drawing of a mechanism.
use super::{Draft, MOST_NAMES};
use crate::drawing::{Along, Ink, Part, Point, Shape, Weight};
use linkage_fmu::mechanism::inspection::Connection;

impl Draft<'_> {
    /// Springs and drives.
    pub(super) fn connections(&mut self) {
        let scene = self.scene;
        let of_kind =
            |all: &'_ [Connection], part: Part| all.iter().map(move |c| (part, c.clone())).collect::<Vec<_>>();
        let both = [of_kind(&scene.springs, Part::Spring), of_kind(&scene.actuators, Part::Drive)].concat();
        let is_named = both.len() <= MOST_NAMES;
        for (part, connection) in both {
            let joint = connection.joint.and_then(|joint| scene.joints.get(joint));
            let ends = connection.ends.or(joint.filter(|j| j.axis.is_some()).map(|j| [j.first, j.second]));
            let name = &connection.name;
            let (at, away) = match (ends, joint) {
                (Some([a, b]), _) => {
                    let (a, b) = (self.at(a), self.at(b));
                    match part {
                        Part::Spring => self.spring(a, b, name),
                        _ => self.cylinder(a, b, name),
                    }
                    ([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])], 9.0)
                }
                (None, Some(joint)) => {
                    let center = self.at(joint.second);
                    self.ring(center, part, name);
                    (center, self.half + 9.0)
                }
                (None, None) => {
                    // One ring at each of the two bodies of a torque.
                    let bodies = connection.bodies.into_iter().flatten().filter(|on| on.frame != 0);
                    let centers: Vec<Point> = bodies.map(|on| self.at(on)).collect();
                    centers.iter().for_each(|center| self.ring(*center, part, name));
                    let Some(last) = centers.last() else { continue };
                    (*last, self.half + 9.0)
                }
            };
            if is_named {
                self.wish(at, away, name, Weight::Plain, Ink::Muted);
            }
        }
    }

    fn spring(&mut self, a: Point, b: Point, name: &str) {
        let (along, length) = Along::between(a, b);
        let coils = ((length / (8.0 * self.unit)).round() as usize).clamp(8, 32);
        let width = 6.0 * self.unit;
        let mut points = vec![a, along.at(0.14 * length, 0.0)];
        points.extend((0..coils).map(|k| {
            let s = 0.14 + 0.72 * (k as f64 + 0.5) / coils as f64;
            along.at(s * length, if k % 2 == 0 { -width } else { width })
        }));
        points.extend([along.at(0.86 * length, 0.0), b]);
        self.shapes.push(Shape::line(points, Ink::Steel, 1.6 * self.unit).of(Part::Spring, name));
    }

    fn cylinder(&mut self, a: Point, b: Point, name: &str) {
        let (along, length) = Along::between(a, b);
        let (u, h) = (self.unit, (0.95 * self.half).clamp(4.5 * self.unit, 8.0 * self.unit));
        self.shapes.push(Shape::line(vec![a, b], Ink::Steel, 3.6 * u).of(Part::Drive, name));
        let barrel = along.rectangle([0.05 * length, 0.62 * length], [-h, h]);
        self.shapes.push(Shape::area(barrel, Ink::Metal, (Ink::Steel, 1.3 * u)).of(Part::Drive, name));
        let piston = along.rectangle([0.36 * length, 0.36 * length + 3.0 * u], [-h, h]);
        self.shapes.push(Shape::area(piston, Ink::Steel, (Ink::Steel, u)));
        for end in [a, b] {
            self.shapes.push(Shape::circle(end, 3.4 * u, Ink::Paper, (Ink::Steel, 1.6 * u)));
        }
    }

    /// A drive or a spring in a revolute joint: an arrow around it, or a spiral.
    fn ring(&mut self, [x, y]: Point, part: Part, name: &str) {
        let u = self.unit;
        let on = |radius: f64, angle: f64| [x + radius * angle.cos(), y - radius * angle.sin()];
        let points: Vec<Point> = match part {
            Part::Spring => (0..=60).map(|k| f64::from(k) / 60.0).map(|t| on((3.0 + 10.0 * t) * u, 14.0 * t)).collect(),
            _ => (0..=48).map(|k| on(self.half + 7.0 * u, 4.7 * f64::from(k) / 48.0)).collect(),
        };
        let last = points[points.len() - 1];
        self.shapes.push(Shape::line(points, Ink::Steel, 2.0 * u).of(part, name));
        if part == Part::Drive {
            // Anticlockwise, like a positive torque.
            let tip = [last[0] + 7.0 * u, last[1] - 0.5 * u];
            let head = vec![tip, [last[0] - u, last[1] - 5.0 * u], [last[0] - u, last[1] + 5.0 * u]];
            self.shapes.push(Shape::area(head, Ink::Steel, (Ink::Steel, u)));
        }
    }
}
