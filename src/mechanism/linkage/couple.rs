//! From the definition to the couplings of a linkage.
//!
//! In: a checked definition, a linkage with its joints and coordinates. Out: the same linkage with couplings, each with
//! a joint of its own behind those of the definition. It must not know how loops close.
use super::coupling::{Coupling, Kind, Second};
use super::law::Law;
use super::structure::{Freedom, Joint, Linkage, Point};
use crate::mechanism::definition::{self, CouplingKind, DefinitionError, Mechanism, Side};
use crate::numerics::decimal::Decimal;
use crate::numerics::plane::Vec2;
use std::ops::RangeInclusive;

/// Largest distance of two points that are one, in sizes of the linkage.
const SAME: f64 = 1e-9;
/// Ratios of teeth that a pair of gears may have.
const RATIOS: RangeInclusive<f64> = 1e-9..=1e9;

/// A coupling of the definition, with its name.
struct Named<'m> {
    mechanism: &'m Mechanism,
    name: &'m str,
    defined: &'m definition::Coupling,
}

impl Named<'_> {
    fn refused<T>(&self, key: &str, message: impl std::fmt::Display) -> Result<T, DefinitionError> {
        Err(DefinitionError::key(format_args!("couplings.{}.{key}", self.name), message))
    }
}

/// Two bodies that turn on a carrier.
struct Pivots {
    first: Point,
    second: Point,
    /// Index of the body that carries both, and the angle of the body of the definition in it [rad].
    carrier: usize,
    carrier_angle: f64,
    /// u1 and u2 less the angles of the two bodies relative to the carrier [rad].
    shifts: [f64; 2],
    /// From the first centre to the second, in the frame of the carrier [m].
    between: Vec2,
}

/// A body that turns on a carrier, and another one that slides on it.
struct Slide {
    first: Point,
    /// u1 less the angle of the first body relative to the carrier [rad].
    shift: f64,
    /// Point of the prismatic joint on the carrier.
    carrier: Point,
    /// Point of the prismatic joint on the second body.
    second: Point,
    /// Centre of the first body, in the frame of the carrier [m].
    center: Vec2,
    /// Motion of the second body.
    motion: Second,
}

impl Linkage {
    /// Add the couplings of the definition, in its order.
    ///
    /// # Errors
    /// A wheel that is not hinged on the carrier, wheels with one centre, pulleys that overlap.
    pub(super) fn add_couplings(&mut self, mechanism: &Mechanism) -> Result<(), DefinitionError> {
        let guess = self.guessed_positions(mechanism);
        for (name, defined) in mechanism.couplings.iter() {
            let named = Named { mechanism, name, defined };
            let (joint, mut coupling) = match defined.kind {
                CouplingKind::Rack => self.rack(&named)?,
                CouplingKind::Cam => self.cam(&named, guess.as_deref())?,
                _ => self.wheels(&named)?,
            };
            let index = self.couplings.len();
            self.joints.push(Joint { freedom: Freedom::Coupling(index), ..joint });
            let is_free = defined.phase.is_none() && defined.kind != CouplingKind::Cam;
            if let (true, Some(q)) = (is_free, &guess) {
                let [first, second] = self.coupled(&coupling, &self.positions(q));
                coupling.law.add_phase(second - coupling.law.at(first)[0]);
            }
            self.couplings.push(coupling);
        }
        Ok(())
    }

    /// Coordinates of the guess; None if one is missing, which is an error of the assembly.
    fn guessed_positions(&self, mechanism: &Mechanism) -> Option<Vec<f64>> {
        let mut q = vec![None; self.coordinates.len()];
        for (name, &value) in mechanism.guess.iter() {
            if let Some(body) = self.bodies.iter().find(|body| body.name == name) {
                q[body.angle_coordinate?] = Some(value - body.offset);
            } else if let Some(slide) = self.coordinates[self.angles..].iter().position(|other| other == name) {
                q[self.angles + slide] = Some(value);
            }
        }
        q.into_iter().collect()
    }

    /// A wheel's centre, and the angle of the body that the file names, in the body of the linkage that carries it.
    fn wheel(&self, named: &Named, key: &str, text: &str) -> Result<(Point, f64), DefinitionError> {
        let center = self.locate(named.mechanism, format_args!("couplings.{}.{key}", named.name), text)?;
        Ok((center, self.angle_of(named.mechanism, text)))
    }

    /// Point of a body to which revolute joints, one or several at one place, hold the point of another body.
    fn hinge_on(&self, body: usize, center: Point) -> Option<Vec2> {
        let mut reached = vec![center];
        let mut next = 0;
        let is_same = |a: Point, b: Point| a.body == b.body && (a.local - b.local).norm() <= SAME * self.size;
        while let Some(&at) = reached.get(next) {
            if at.body == body {
                return Some(at.local);
            }
            for joint in self.joints.iter().filter(|joint| joint.freedom == Freedom::Revolute) {
                for (own, other) in [(joint.first, joint.second), (joint.second, joint.first)] {
                    if is_same(own, at) && !reached.iter().any(|point| is_same(*point, other)) {
                        reached.push(other);
                    }
                }
            }
            next += 1;
        }
        None
    }

    /// Distance of the two points of a coupling's joint on the body that carries it [m].
    pub fn hinge_distance(&self, carrier: usize, joint: &Joint) -> f64 {
        let [first, second] = self.hinges(carrier, joint);
        (second - first).norm()
    }

    /// The two points of a coupling's joint on the body that carries it, in its frame [m].
    pub(super) fn hinges(&self, carrier: usize, joint: &Joint) -> [Vec2; 2] {
        [joint.first, joint.second].map(|center| self.hinge_on(carrier, center).unwrap_or_default())
    }

    fn not_hinged<T>(&self, named: &Named, key: &str, center: &str, carrier: usize) -> Result<T, DefinitionError> {
        let message = format!(
            "{center} has no revolute joint on {}, the carrier of this coupling: add a revolute joint at this point, \
             or name the body that has the joint in the key `carrier`",
            self.bodies[carrier].name
        );
        named.refused(key, message)
    }

    /// The two bodies that turn, and what carries them.
    fn pivots(&self, named: &Named) -> Result<Pivots, DefinitionError> {
        let Named { mechanism, defined, .. } = *named;
        let second_text = defined.second.as_deref().unwrap_or_default();
        let (first, first_angle) = self.wheel(named, "first", &defined.first)?;
        let (second, second_angle) = self.wheel(named, "second", second_text)?;
        let (carrier, carrier_angle) =
            self.carrier(mechanism, defined.carrier.as_deref().unwrap_or(definition::GROUND)).unwrap_or((0, 0.0));
        for (key, wheel) in [("first", first), ("second", second)] {
            if wheel.body == carrier {
                let message = format!(
                    "this point is on {}, the carrier of this coupling: give a wheel that turns on the carrier",
                    self.bodies[carrier].name
                );
                return named.refused(key, message);
            }
        }
        if first.body == second.body {
            return named.refused(
                "second",
                format_args!(
                    "this point and the point in the key `first` are on the same body {}, so nothing is coupled: \
                     give a point of another body",
                    self.bodies[first.body].name
                ),
            );
        }
        let Some(one) = self.hinge_on(carrier, first) else {
            return self.not_hinged(named, "first", &defined.first, carrier);
        };
        let Some(other) = self.hinge_on(carrier, second) else {
            return self.not_hinged(named, "second", second_text, carrier);
        };
        let between = other - one;
        if between.norm() <= SAME * self.size {
            let what = if defined.kind == CouplingKind::Cam { "cam and follower" } else { "wheels" };
            let message = format!(
                "{} and {second_text} are at the same place: {what} need a distance between their centres",
                defined.first
            );
            return named.refused("second", message);
        }
        let shifts = [first_angle - carrier_angle, second_angle - carrier_angle];
        Ok(Pivots { first, second, carrier, carrier_angle, shifts, between })
    }

    /// Two wheels that turn: gears or a belt.
    fn wheels(&self, named: &Named) -> Result<(Joint, Coupling), DefinitionError> {
        let Named { name, defined, .. } = *named;
        let Pivots { first, second, carrier, carrier_angle, shifts, between } = self.pivots(named)?;
        let distance = between.norm();
        let phase = defined.phase.unwrap_or(0.0);
        let (law, scale, kind) = match defined.kind {
            CouplingKind::Belt => {
                let radii = [defined.first_radius, defined.second_radius].map(|radius| radius.unwrap_or(1.0));
                let crossed = defined.crossed.unwrap_or(false);
                let sign = if crossed { -1.0 } else { 1.0 };
                let least = (radii[0] - sign * radii[1]).abs();
                if distance <= least {
                    let between = if crossed { "sum" } else { "difference" };
                    let message = format!(
                        "the centres are {} m apart, but the distance must be larger than the {between} of the \
                         radii, {} m: change a radius or move a centre",
                        Decimal::rounded(distance),
                        Decimal::rounded(least)
                    );
                    return named.refused("second_radius", message);
                }
                let ratio = sign * radii[0] / radii[1];
                (Law::Constant { ratio, phase }, radii[1], Kind::Belt { radii, crossed })
            }
            CouplingKind::EllipticGears => {
                // theta is 0 where the vertex lies on the line of the centres, on the side of the second wheel.
                let line = between.y.atan2(between.x) - carrier_angle;
                let (vertex, lobes) = (defined.vertex_angle.unwrap_or(0.0) - line, defined.lobes.unwrap_or(1.0));
                let eccentricity = defined.eccentricity.unwrap_or(0.0);
                (Law::Elliptic { eccentricity, lobes, vertex, phase }, 0.5 * distance, Kind::Gears)
            }
            _ => {
                let teeth = [defined.first_teeth, defined.second_teeth].map(|teeth| teeth.unwrap_or(1.0));
                let sign = if defined.internal == Some(true) { 1.0 } else { -1.0 };
                let ratio = sign * teeth[0] / teeth[1];
                if !RATIOS.contains(&ratio.abs()) {
                    let message = format!(
                        "with `first_teeth` = {} the ratio would be {}, but must be from {} to {}: change one of the \
                         numbers of teeth",
                        Decimal(teeth[0]),
                        Decimal::rounded(ratio.abs()),
                        Decimal(*RATIOS.start()),
                        Decimal(*RATIOS.end())
                    );
                    return named.refused("second_teeth", message);
                }
                (Law::Constant { ratio, phase }, distance / (ratio - 1.0).abs(), Kind::Gears)
            }
        };
        let coupling = Coupling {
            joint: self.joints.len(),
            carrier,
            shift: shifts[0],
            second: Second::Angle { shift: shifts[1] },
            law,
            scale,
            kind,
        };
        Ok((Joint { name: name.into(), freedom: Freedom::Revolute, first, second }, coupling))
    }

    /// The wheel or cam that turns, and the prismatic joint in which the second body slides.
    fn slide(&self, named: &Named) -> Result<Slide, DefinitionError> {
        let Named { mechanism, defined, .. } = *named;
        let (first, first_angle) = self.wheel(named, "first", &defined.first)?;
        let joint = mechanism.joints.position(defined.joint.as_deref().unwrap_or_default()).unwrap_or(0);
        let slide = &self.joints[joint];
        let ends = [(slide.first, slide.second, 1.0), (slide.second, slide.first, -1.0)];
        if let Some((on, ..)) = ends.iter().find(|(on, ..)| on.body == first.body) {
            let message = format!(
                "this point is on {}, which slides in {}: give the centre of a wheel that turns",
                self.bodies[on.body].name, slide.name
            );
            return named.refused("first", message);
        }
        let hinged = ends.into_iter().find_map(|(carrier, second, sign)| {
            self.hinge_on(carrier.body, first).map(|center| (carrier, second, sign, center))
        });
        let Some((carrier, second, sign, center)) = hinged else {
            let bodies = ends.map(|(body, ..)| self.bodies[body.body].name.as_str()).join(" nor on ");
            let message = format!(
                "{} has no revolute joint on {bodies}, the bodies of {}: add a revolute joint on one of these bodies",
                defined.first, slide.name
            );
            return named.refused("first", message);
        };
        let Some(coordinate) = self.tree.iter().find(|branch| branch.joint == joint).and_then(|branch| branch.slide)
        else {
            let message = format!(
                "the position of {} follows from other prismatic joints, which connect the same two bodies directly or \
                 through other bodies: name one of these other joints",
                slide.name
            );
            return named.refused("joint", message);
        };
        let text = mechanism
            .joints
            .iter()
            .nth(joint)
            .map(|(_, j)| if sign > 0.0 { j.first.as_str() } else { j.second.as_str() });
        let carrier_angle = text.map_or(0.0, |text| self.angle_of(mechanism, text));
        let motion = Second::Position { joint, coordinate, sign };
        Ok(Slide { first, shift: first_angle - carrier_angle, carrier, second, center, motion })
    }

    /// A wheel and a rack.
    fn rack(&self, named: &Named) -> Result<(Joint, Coupling), DefinitionError> {
        let Named { name, defined, .. } = *named;
        let Slide { first, shift, carrier, second, motion, .. } = self.slide(named)?;
        let radius = defined.radius.unwrap_or(1.0);
        let ratio = if defined.side == Some(Side::Left) { -radius } else { radius };
        let coupling = Coupling {
            joint: self.joints.len(),
            carrier: carrier.body,
            shift,
            second: motion,
            law: Law::Constant { ratio, phase: defined.phase.unwrap_or(0.0) },
            scale: 1.0,
            kind: Kind::Rack,
        };
        Ok((Joint { name: name.into(), freedom: Freedom::Revolute, first, second }, coupling))
    }
}

mod cams;
