//! What couplings exert.
//!
//! In: positions of the bodies. Out: force and moment of a coupling on its two bodies. It must not know definitions,
//! loads or time.
use super::cam::Cam;
use super::coupling::{Coupling, Kind, Second};
use super::motion::{Positions, Rates};
use super::structure::{Linkage, Point};
use crate::numerics::plane::{Vec2, perp};

/// What a coupling exerts on its second body for lambda = 1 N; the opposite acts on the first body, at the same point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Point of the force, in the mechanism frame [m].
    pub at: Vec2,
    /// Force [1].
    pub force: Vec2,
    /// Moment about this point [m].
    pub moment: f64,
    /// Force transmitted along the motion [1]: force of gears across the line between their centres, of racks along the
    /// rack, difference of the tensions of a belt; it is positive if it drives the second body towards larger u2. Of a
    /// cam the force along the normal of its profile, positive if it presses the follower away.
    pub transmitted: f64,
    /// Unit vector of the force on the second body that does no work: away from the first wheel for the teeth of gears
    /// outside one another and of racks, and for belts; towards it for a pinion in a ring.
    pub apart: Vec2,
    /// Force of gears along `apart` over the force across the line between their centres, without pressure angle, for
    /// lambda > 0: 0 for circular gears, whose pitch curves touch across this line.
    pub inclination: f64,
}

impl Contact {
    /// The force on the second body that does no work, for a force |F_t| tan(alpha) of 1 N. `lean`: tan(alpha) with the
    /// sign of the transmitted force.
    ///
    /// The flank that bears is inclined by the pressure angle alpha to the common tangent of the pitch curves, this
    /// tangent by atan(q) to circular ones: the force has the part F_t (q + tan alpha) / (1 - q tan alpha) apart, of
    /// which F_t q is that of the coupling without pressure angle.
    pub fn separation(&self, lean: f64) -> Vec2 {
        let q = self.inclination;
        (1.0 + q * q) / (1.0 - lean * q) * self.apart
    }
}

impl Linkage {
    /// What a coupling exerts on its second body.
    pub fn contact(&self, coupling: &Coupling, p: &Positions) -> Contact {
        let joint = &self.joints[coupling.joint];
        let scale = coupling.scale;
        let [_, slope, curvature] = coupling.law.at(self.coupled(coupling, p)[0]);
        let first = p.point(joint.first);
        match (&coupling.kind, coupling.second) {
            (Kind::Rack, Second::Position { joint, .. }) => {
                let axis = self.slid(joint, p)[0];
                // Towards the pitch line: the wheel's velocity there is slope u1_dot along the axis.
                let apart = -slope.signum() * perp(axis);
                let at = first + slope.abs() * apart;
                Contact { at, force: scale * axis, transmitted: scale, apart, ..Contact::default() }
            }
            (Kind::Belt { radii, crossed }, _) => {
                let (across, distance) = self.between_centers(coupling, p);
                let sign = if *crossed { -1.0 } else { 1.0 };
                // Cosine of the angle between the line of the centres and the radii to where the belt leaves.
                let cosine = (radii[0] - sign * radii[1]) / distance;
                let force = (sign * cosine * scale / radii[1]) * perp(across);
                let at = p.point(joint.second);
                let (moment, transmitted) = (scale, scale / radii[1]);
                Contact { at, force, moment, transmitted, apart: across, inclination: 0.0 }
            }
            (Kind::Cam(cam), second) => {
                let (pivot, [touching, velocity, tangent]) = (p.point(joint.second), self.profile(coupling, cam, p));
                let normal = perp(tangent);
                if cam.face.is_none() {
                    let transmitted = scale / normal.dot(&velocity);
                    return Contact { at: touching, force: transmitted * normal, transmitted, ..Contact::default() };
                }
                // A flat face touches where both velocities have one part along its normal. That may be far away, so
                // the moment about the cam's centre stands for the place.
                let transmitted = match second {
                    Second::Position { .. } => scale / normal.dot(&velocity),
                    Second::Angle { .. } => scale * (slope - 1.0) / normal.dot(&perp(pivot - first)),
                };
                let (force, moment) = (transmitted * normal, scale * slope);
                Contact { at: first, force, moment, transmitted, ..Contact::default() }
            }
            _ => {
                let (across, distance) = self.between_centers(coupling, p);
                // The pitch point: both wheels have one velocity there, relative to the carrier.
                let at = first + (distance * slope / (slope - 1.0)) * across;
                let tangential = scale * (slope - 1.0) / distance;
                let apart = if slope < 0.0 { across } else { -across };
                // The tangent of the first pitch curve, whose radius is distance slope / (slope - 1).
                let leaning = curvature / (slope * (slope - 1.0));
                let force = tangential * (perp(across) + leaning * across);
                let inclination = tangential.signum() * apart.dot(&across) * leaning;
                Contact { at, force, moment: 0.0, transmitted: tangential.abs(), apart, inclination }
            }
        }
    }

    /// Where the follower of a cam touches: the centre of its roller or a point of its face, the velocity of this point
    /// for u2_dot = 1, and the unit tangent of the profile, clockwise about the cam, so that its perp points out of it.
    fn profile(&self, coupling: &Coupling, cam: &Cam, p: &Positions) -> [Vec2; 3] {
        let joint = &self.joints[coupling.joint];
        let touching = p.point(Point { body: joint.second.body, local: cam.contact });
        let velocity = match coupling.second {
            Second::Position { joint, .. } => self.slid(joint, p)[0],
            Second::Angle { .. } => perp(touching - p.point(joint.second)),
        };
        let tangent = match cam.face {
            Some(face) => -perp(p.vector(joint.second.body, face)),
            // The centre of a roller moves along the pitch curve, relative to the cam.
            None => {
                let slope = coupling.law.at(self.coupled(coupling, p)[0])[1];
                (slope * velocity - perp(touching - p.point(joint.first))).normalize()
            }
        };
        [touching, velocity, tangent]
    }

    /// A point of the line along which cam and follower rub, and its unit direction, clockwise about the cam.
    pub fn rubbing(&self, coupling: &Coupling, p: &Positions) -> [Vec2; 2] {
        let Kind::Cam(cam) = &coupling.kind else { return [Vec2::zeros(); 2] };
        let [touching, _, tangent] = self.profile(coupling, cam, p);
        [touching - cam.roller * perp(tangent), tangent]
    }

    /// Velocity of the follower relative to the cam along this line, and its derivative, for these rates.
    pub fn rubbing_speed(&self, coupling: &Coupling, p: &Positions, (r, a): (&Rates, &Rates)) -> [f64; 2] {
        let Kind::Cam(cam) = &coupling.kind else { return [0.0; 2] };
        let joint = &self.joints[coupling.joint];
        let (disc, follower) = (joint.first.body, joint.second.body);
        let [touching, center] =
            [Point { body: follower, local: cam.contact }, joint.first].map(|at| p.motion(r, a, at));
        let [x, v, second] = [0, 1, 2].map(|order| touching[order] - center[order]);
        // Of the point of the follower relative to the cam.
        let speed = v - r.angle[disc] * perp(x);
        let change = second - a.angle[disc] * perp(x) - r.angle[disc] * perp(v);
        let tangent = self.profile(coupling, cam, p)[2];
        let [turn, turn_change] = [r, a].map(|of| cam.roller * (of.angle[follower] - of.angle[disc]));
        // The tangent of a face turns with it; a roller's centre has no speed along the normal.
        let leaning = r.angle[follower] * perp(tangent).dot(&speed);
        [tangent.dot(&speed) + turn, tangent.dot(&change) + leaning + turn_change]
    }

    /// Unit vector from the centre of the first wheel to that of the second, and their distance [m].
    fn between_centers(&self, coupling: &Coupling, p: &Positions) -> (Vec2, f64) {
        let joint = &self.joints[coupling.joint];
        let between = p.point(joint.second) - p.point(joint.first);
        let distance = between.norm();
        (between / distance, distance)
    }
}
