//! What couplings exert.
//!
//! In: positions of the bodies. Out: force and moment of a coupling on its two bodies. It must not know definitions,
//! loads or time.
use super::coupling::{Coupling, Kind, Second};
use super::motion::Positions;
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
                let (follower, pivot) = (joint.second.body, p.point(joint.second));
                let touching = p.point(Point { body: follower, local: cam.contact });
                // Velocity of the follower where it touches, for u2_dot = 1.
                let velocity = match second {
                    Second::Position { joint, .. } => self.slid(joint, p)[0],
                    Second::Angle { .. } => perp(touching - pivot),
                };
                let Some(face) = cam.face else {
                    // The centre of a roller moves along the pitch curve, relative to the cam.
                    let normal = perp(slope * velocity - perp(touching - first)).normalize();
                    let transmitted = scale / normal.dot(&velocity);
                    return Contact { at: touching, force: transmitted * normal, transmitted, ..Contact::default() };
                };
                // A flat face touches where both velocities have one part along its normal. That may be far away, so
                // the moment about the cam's centre stands for the place.
                let normal = p.vector(follower, face);
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

    /// Unit vector from the centre of the first wheel to that of the second, and their distance [m].
    fn between_centers(&self, coupling: &Coupling, p: &Positions) -> (Vec2, f64) {
        let joint = &self.joints[coupling.joint];
        let between = p.point(joint.second) - p.point(joint.first);
        let distance = between.norm();
        (between / distance, distance)
    }
}
