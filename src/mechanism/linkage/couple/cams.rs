//! From the definition to cams.
//!
//! In: a checked definition of a cam, a linkage with its joints. Out: its coupling, with the follower on the base
//! circle where there is no lift. It must not know how loops close.
use super::{Named, Pivots, Slide};
use crate::mechanism::definition::{DefinitionError, Follower};
use crate::mechanism::linkage::cam::{Cam, Guide};
use crate::mechanism::linkage::coupling::{Coupling, Kind, Second};
use crate::mechanism::linkage::law::Law;
use crate::mechanism::linkage::structure::{Freedom, Joint, Linkage, Point};
use crate::numerics::decimal::Decimal;
use crate::numerics::plane::{Vec2, cross, perp, turned};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Least part of a motion that moves a follower away from the cam, where it touches without lift.
const LEAST: f64 = 1e-6;

/// Where a follower touches the base circle.
#[derive(Clone, Copy)]
struct Start {
    u2: f64,
    /// Sign of the normal of a flat face that points out of the cam.
    outward: f64,
    /// Growth of the distance from the cam's centre for u2_dot = 1, relative to the motion of the follower there.
    away: f64,
}

impl Linkage {
    /// A cam and its follower. `guess`: the coordinates of the guess, which say on which side of the cam the follower
    /// is.
    pub(super) fn cam(&self, named: &Named, guess: Option<&[f64]>) -> Result<(Joint, Coupling), DefinitionError> {
        let Named { mechanism, name, defined } = *named;
        let lift = defined.lift(&format!("couplings.{name}"))?;
        let text = defined.contact.as_deref().unwrap_or_default();
        let contact = self.locate(mechanism, format_args!("couplings.{name}.contact"), text)?;
        let is_flat = defined.follower == Some(Follower::Flat);
        // Direction of a flat face in the follower's body of the linkage.
        let face = |angle: f64| turned(Vec2::x(), angle + self.angle_of(mechanism, text));
        let (first, second, carrier, shift, motion, guide, face) = if defined.joint.is_some() {
            let Slide { first, shift, carrier, second, center, motion } = self.slide(named)?;
            self.check_on_follower(named, contact, second)?;
            // Bodies in a prismatic joint have one angle but for a constant.
            let turn = self.bodies[second.body].offset - self.bodies[carrier.body].offset;
            let along = match motion {
                Second::Position { joint, sign, .. } => match self.joints[joint].freedom {
                    Freedom::Prismatic(axis) => turned(axis, if sign > 0.0 { 0.0 } else { turn }),
                    _ => Vec2::zeros(),
                },
                Second::Angle { .. } => Vec2::zeros(),
            };
            let normal = defined.face_angle.map_or(along, |angle| turned(perp(face(angle)), turn));
            if is_flat && normal.dot(&along).abs() < LEAST {
                return named.refused(
                    "face_angle",
                    "the face is parallel to the axis of the joint, so the cam cannot move the follower; change \
                     `face_angle`",
                );
            }
            let start = carrier.local + turned(contact.local - second.local, turn) - center;
            let face = turned(normal, -turn);
            (first, second, carrier.body, shift, motion, Guide::Line { start, along, normal }, face)
        } else {
            let Pivots { first, second, carrier, shifts, between, .. } = self.pivots(named)?;
            self.check_on_follower(named, contact, second)?;
            let face = perp(face(defined.face_angle.unwrap_or(0.0)));
            let [arm, normal] = [contact.local - second.local, face].map(|v| turned(v, -shifts[1]));
            let motion = Second::Angle { shift: shifts[1] };
            (first, second, carrier, shifts[0], motion, Guide::Pivot { at: between, arm, normal }, face)
        };
        let roller = defined.roller_radius.unwrap_or(0.0);
        let radius = defined.base_radius.unwrap_or(1.0) + roller;
        let scale = if let Guide::Pivot { at, .. } = guide { at.norm() } else { 1.0 };
        let law = Law::Constant { ratio: 0.0, phase: 0.0 };
        let cam = Cam { contact: contact.local, face: None, roller, guide, sign: 1.0 };
        let kind = Kind::Cam(cam.clone());
        let mut coupling = Coupling { joint: self.joints.len(), carrier, shift, second: motion, law, scale, kind };
        let joint = Joint { name: name.into(), freedom: Freedom::Revolute, first, second };
        let is_near = guess.map_or(0.0, |q| self.motions(&coupling, &joint, &self.positions(q))[1]);
        let start = self.touching(named, guide, is_flat, radius, is_near)?;
        let sign = start.away.signum();
        let face = is_flat.then_some(start.outward * face);
        let guide = match guide {
            Guide::Line { start: at, along, normal } => {
                Guide::Line { start: at, along, normal: start.outward * normal }
            }
            Guide::Pivot { at, arm, normal } => Guide::Pivot { at, arm, normal: start.outward * normal },
        };
        coupling.law =
            Law::Lift { lift: Arc::new(lift), start: defined.start_angle.unwrap_or(0.0), sign, phase: start.u2 };
        coupling.kind = Kind::Cam(Cam { face, guide, sign, ..cam });
        Ok((joint, coupling))
    }

    fn check_on_follower(&self, named: &Named, contact: Point, second: Point) -> Result<(), DefinitionError> {
        if contact.body == second.body {
            return Ok(());
        }
        let [on, follower] = [contact, second].map(|point| self.bodies[point.body].name.as_str());
        named.refused(
            "contact",
            format_args!("this point is on {on}, but the follower is {follower}: give a point of the follower"),
        )
    }

    /// Where the follower touches the base circle, nearest to a u2. `radius`: that of the base circle, with a roller
    /// that of its centre's.
    fn touching(
        &self,
        named: &Named,
        guide: Guide,
        is_flat: bool,
        radius: f64,
        near: f64,
    ) -> Result<Start, DefinitionError> {
        let told = Decimal::rounded;
        let angle = |v: Vec2| v.y.atan2(v.x);
        let what = if is_flat { "base_radius" } else { "base_radius + roller_radius" };
        let mut all = Vec::new();
        match guide {
            Guide::Line { start, along, normal } if is_flat => {
                let rate = normal.dot(&along);
                all.extend([1.0, -1.0].map(|outward| {
                    let u2 = (outward * radius - normal.dot(&start)) / rate;
                    Start { u2, outward, away: outward * rate }
                }));
            }
            Guide::Line { start, along, .. } => {
                let (middle, offset) = (-start.dot(&along), cross(along, start).abs());
                let half = ((radius - offset) * (radius + offset)).max(0.0).sqrt();
                if half <= LEAST * radius {
                    let message = format!(
                        "the centre of the roller stays at least {} m away from the centre of the cam, but {what} is \
                         only {} m: make `base_radius` larger",
                        told(offset),
                        told(radius)
                    );
                    return named.refused("base_radius", message);
                }
                all.extend([1.0, -1.0].map(|side| Start {
                    u2: middle + side * half,
                    outward: 1.0,
                    away: side * half / radius,
                }));
            }
            Guide::Pivot { at, arm, normal } if is_flat => {
                let (distance, off) = (at.norm(), arm.dot(&normal));
                for outward in [1.0, -1.0] {
                    let cos = (outward * radius - off) / distance;
                    all.extend([1.0, -1.0].into_iter().filter(|_| cos.abs() < 1.0).map(|side| {
                        let u2 = angle(at) - angle(normal) + side * cos.acos();
                        Start { u2, outward, away: outward * perp(turned(normal, u2)).dot(&at) / distance }
                    }));
                }
                if all.is_empty() {
                    let message = format!(
                        "the face cannot touch the base circle: {what} is {} m, and the line of the face is {} m \
                         away from the pivot of the follower; the difference of these two lengths must be smaller \
                         than the {} m between the pivot and the centre of the cam: change `base_radius` or the \
                         follower",
                        told(radius),
                        told(off.abs()),
                        told(distance)
                    );
                    return named.refused("base_radius", message);
                }
            }
            Guide::Pivot { at, arm, .. } => {
                let (distance, length) = (at.norm(), arm.norm());
                let cos = (radius * radius - distance * distance - length * length) / (2.0 * distance * length);
                if cos.is_nan() || cos.abs() >= 1.0 {
                    let message = format!(
                        "{what} is {} m, but the centre of the roller can only be from {} m to {} m from the centre \
                         of the cam: change `base_radius` or the follower",
                        told(radius),
                        told((distance - length).abs()),
                        told(distance + length)
                    );
                    return named.refused("base_radius", message);
                }
                all.extend([1.0, -1.0].map(|side| {
                    let u2 = angle(at) - angle(arm) + side * cos.acos();
                    Start { u2, outward: 1.0, away: perp(turned(arm, u2)).dot(&at) / (length * radius) }
                }));
            }
        }
        if let Guide::Pivot { .. } = guide {
            all.iter_mut().for_each(|start| start.u2 += TAU * ((near - start.u2) / TAU).round());
        }
        let nearest = all.into_iter().min_by(|a, b| (a.u2 - near).abs().total_cmp(&(b.u2 - near).abs()));
        match nearest.filter(|start| start.away.abs() > LEAST) {
            Some(start) => Ok(start),
            None => named.refused(
                "base_radius",
                "at the contact the follower moves along the base circle, so no lift can move the follower: change \
                 the base circle or the follower",
            ),
        }
    }
}
