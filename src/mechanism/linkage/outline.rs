//! Outlines of couplings: pitch curves of wheels, racks, belts, profiles of cams, rollers and flat faces, for whoever
//! draws them.
//!
//! In: a coupling. Out: lines in the frames of the linkage's bodies. It must not know positions.
use super::coupling::{Coupling, Kind, Second};
use super::law::Law;
use super::slot::Slot;
use super::structure::{Freedom, Linkage, Point};
use crate::numerics::plane::{Vec2, perp, turned};
use std::f64::consts::TAU;

/// Number of points of an outline.
const POINTS: usize = 180;

/// A line fixed to a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Index of the body.
    pub body: usize,
    /// Its points in the body's frame [m].
    pub points: Vec<Vec2>,
    /// Whether the last point is joined to the first.
    pub is_closed: bool,
}

/// Points evenly around a revolution.
fn around(point: impl Fn(f64) -> Vec2) -> Vec<Vec2> {
    (0..POINTS).map(|k| point(TAU * k as f64 / POINTS as f64)).collect()
}

fn circle(center: Point, radius: f64) -> Outline {
    let points = around(|angle| center.local + turned(Vec2::new(radius, 0.0), angle));
    Outline { body: center.body, points, is_closed: true }
}

/// A circle with a spoke, so that its rotation is seen.
fn wheel(center: Point, radius: f64) -> Outline {
    let Outline { body, points: rim, is_closed } = circle(center, radius);
    let points = [center.local, rim[0]].into_iter().chain(rim[1..].iter().copied()).chain([rim[0]]).collect();
    Outline { body, points, is_closed }
}

impl Linkage {
    /// The pitch line of a rack, as long as six radii of its wheel, around the point of the rack in its prismatic
    /// joint.
    fn pitch_line(&self, coupling: &Coupling) -> Option<Outline> {
        /// Half the length of the line, in radii of the wheel.
        const HALF: f64 = 3.0;
        let Second::Position { joint, sign, .. } = coupling.second else { return None };
        let slide = &self.joints[joint];
        let Freedom::Prismatic(axis) = slide.freedom else { return None };
        let (on_carrier, on_rack) = if sign > 0.0 { (slide.first, slide.second) } else { (slide.second, slide.first) };
        // Bodies in a prismatic joint have one angle but for a constant.
        let offset = |body: usize| self.bodies[body].offset;
        let within = |body: usize| turned(axis, offset(slide.first.body) - offset(body));
        let [along, center] = [within(on_carrier.body), self.hinges(coupling.carrier, &self.joints[coupling.joint])[0]];
        let slope = coupling.law.at(0.0)[1];
        let aside = (center - on_carrier.local).dot(&perp(along)) - slope;
        let along = within(on_rack.body);
        let middle = on_rack.local + aside * perp(along);
        let points = [-HALF, HALF].map(|part| middle + part * slope.abs() * along).to_vec();
        Some(Outline { body: on_rack.body, points, is_closed: false })
    }

    /// The two spans of a belt, fixed to the body that carries the pulleys.
    fn spans(&self, coupling: &Coupling, [first, second]: [f64; 2], crossed: bool) -> [Outline; 2] {
        let [one, other] = self.hinges(coupling.carrier, &self.joints[coupling.joint]);
        let (between, sign) = (other - one, if crossed { -1.0 } else { 1.0 });
        let angle = ((first - sign * second) / between.norm()).acos();
        [angle, -angle].map(|angle| {
            let out = turned(between.normalize(), angle);
            let points = vec![one + first * out, other + sign * second * out];
            Outline { body: coupling.carrier, points, is_closed: false }
        })
    }

    /// The line along the middle of a slot.
    pub fn slot_outline(&self, slot: &Slot) -> Outline {
        let first = self.joints[slot.joint].first;
        let at = |k: usize| slot.local(slot.track.length() * k as f64 / POINTS as f64)[0];
        Outline { body: first.body, points: (0..=POINTS).map(|k| first.local + at(k)).collect(), is_closed: false }
    }

    /// Outlines of a coupling.
    pub fn outlines(&self, coupling: &Coupling) -> Vec<Outline> {
        let joint = &self.joints[coupling.joint];
        let (first, second) = (joint.first, joint.second);
        match (&coupling.kind, coupling.second) {
            (Kind::Rack, _) => {
                let wheel = wheel(first, coupling.law.at(0.0)[1].abs());
                [wheel].into_iter().chain(self.pitch_line(coupling)).collect()
            }
            (&Kind::Belt { radii, crossed }, _) => {
                let pulleys = [wheel(first, radii[0]), wheel(second, radii[1])];
                pulleys.into_iter().chain(self.spans(coupling, radii, crossed)).collect()
            }
            (Kind::Gears, Second::Angle { .. }) if matches!(coupling.law, Law::Constant { .. }) => {
                let slope = coupling.law.at(0.0)[1];
                let distance = self.hinge_distance(coupling.carrier, joint);
                let radius = |part: f64| distance * (part / (slope - 1.0)).abs();
                vec![wheel(first, radius(slope)), wheel(second, radius(1.0))]
            }
            (Kind::Cam(cam), _) => {
                // In the frame of the linkage's body the cam is turned by the shift.
                let profile = around(|u1| {
                    let [u2, slope, _] = coupling.law.at(u1);
                    first.local + cam.profile(u1 - coupling.shift, [u2, slope])
                });
                let contact = Point { body: second.body, local: cam.contact };
                let follower = match cam.face {
                    None => circle(contact, cam.roller),
                    Some(normal) => {
                        let half = 0.5 * self.size * Vec2::new(-normal.y, normal.x);
                        let points = [-0.5, 0.5].map(|part| contact.local + part * half).to_vec();
                        Outline { body: second.body, points, is_closed: false }
                    }
                };
                vec![Outline { body: first.body, points: profile, is_closed: true }, follower]
            }
            (Kind::Gears, Second::Position { .. }) => Vec::new(),
            (Kind::Gears, Second::Angle { shift }) => {
                let [one, other] = self.hinges(coupling.carrier, joint);
                let between = other - one;
                // The pitch point seen from each wheel, over as many revolutions of the first as the second turns by
                // one.
                let mut wheels = [Vec::new(), Vec::new()];
                let ratio = coupling.law.at(TAU)[0] - coupling.law.at(0.0)[0];
                for (wheel, whole) in [(0, TAU), (1, TAU * TAU / ratio.abs())] {
                    for k in 0..POINTS {
                        let u1 = whole * k as f64 / POINTS as f64;
                        let [u2, slope, _] = coupling.law.at(u1);
                        let part = slope / (slope - 1.0);
                        let (center, arm, angle) = match wheel {
                            0 => (first.local, part * between, u1 - coupling.shift),
                            _ => (second.local, (part - 1.0) * between, u2 - shift),
                        };
                        wheels[wheel].push(center + turned(arm, -angle));
                    }
                }
                let bodies = [first.body, second.body];
                bodies.into_iter().zip(wheels).map(|(body, points)| Outline { body, points, is_closed: true }).collect()
            }
        }
    }
}
