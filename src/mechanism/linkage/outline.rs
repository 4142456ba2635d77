//! Outlines of couplings: pitch curves of wheels, profiles of cams, rollers and flat faces, for whoever draws them.
//!
//! In: a coupling. Out: lines in the frames of the linkage's bodies. It must not know positions.
use super::coupling::{Coupling, Kind, Second};
use super::structure::{Linkage, Point};
use crate::numerics::plane::{Vec2, turned};
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

impl Linkage {
    /// Outlines of a coupling.
    pub fn outlines(&self, coupling: &Coupling) -> Vec<Outline> {
        let joint = &self.joints[coupling.joint];
        let (first, second) = (joint.first, joint.second);
        match (&coupling.kind, coupling.second) {
            (Kind::Rack, _) => vec![circle(first, coupling.law.at(0.0)[1].abs())],
            (Kind::Belt { radii, .. }, _) => vec![circle(first, radii[0]), circle(second, radii[1])],
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
                // The pitch point seen from each wheel, over as many revolutions of the first as the second turns by one.
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
