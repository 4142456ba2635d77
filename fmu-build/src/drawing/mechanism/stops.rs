//! Stops in the drawing of a mechanism: dashed outlines of the bodies that reach them.

use super::{DOTTED, Draft, LEAST, frame, position};
use crate::drawing::geometry::hull;
use crate::drawing::{Form, Ink, Point, Shape, Weight};
use linkage_fmu::mechanism::inspection::{On, SweptStop};

impl Draft<'_> {
    /// Draw the bodies at the positions in which they reach a stop.
    pub fn stops(&mut self, stops: &[SweptStop]) {
        let scene = self.scene;
        for met in stops {
            let stop = &scene.stops[met.stop];
            let frames = |ends: [On; 2]| ends.map(|on| on.frame);
            let one = |frame: usize| [frame; 2];
            let of_points = stop.ends.map(frames).map(|[first, second]| one(if second == 0 { first } else { second }));
            let of_joint = || Some(one(scene.joints.get(stop.joint?)?.second.frame));
            let stated = stop.frame.map(one).or(stop.bodies.map(frames)).or(of_points);
            let Some(moved) = stated.or_else(of_joint) else { continue };
            let mut far: Option<(f64, Point)> = None;
            for body in scene.bodies.iter().filter(|body| frame(body) != 0 && moved.contains(&frame(body))) {
                let at = |on: On| self.pixel(position(&met.poses, on));
                let corners = hull(body.points.iter().map(|point| at(point.on)).collect(), LEAST);
                let origin = at(On { frame: frame(body), at: [0.0, 0.0] });
                for corner in &corners {
                    let distance = (corner[0] - origin[0]).hypot(corner[1] - origin[1]);
                    if far.is_none_or(|(most, _)| distance > most) {
                        far = Some((distance, *corner));
                    }
                }
                let form = match corners.as_slice() {
                    [center] => Form::Circle { center: *center, radius: 1.9 * self.half },
                    _ => Form::Lines { is_closed: corners.len() > 2, points: corners },
                };
                let stroke = Some((Ink::Muted, 1.1 * self.unit));
                self.shapes.push(Shape { form, fill: None, stroke, dashes: DOTTED, part: None });
            }
            if let Some((_, at)) = far {
                self.wish(at, 2.0 * self.half + 4.0, &stop.name, Weight::Plain, Ink::Muted);
            }
        }
    }
}
