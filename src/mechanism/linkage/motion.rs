//! Positions, rates and accelerations of the bodies, outward along the tree.
//!
//! In: coordinates and their derivatives. Out: the same of angles, origins and points. It must not know loops.
use super::slot::{Along, Slot};
use super::structure::{Freedom, Joint, Linkage, Point};
use crate::numerics::plane::{Vec2, perp, rotated};

/// Positions of all bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Positions {
    /// Angle of each body [rad].
    pub angle: Vec<f64>,
    /// Cosine and sine of the angle of each body.
    rotation: Vec<(f64, f64)>,
    /// Origin of each body's frame [m].
    pub origin: Vec<Vec2>,
    /// Arms of each branch of the tree.
    pub arms: Vec<Arms>,
    /// Each slot.
    pub slots: Vec<Along>,
}

/// Vectors of a branch of the tree, in the mechanism frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Arms {
    /// From the parent's origin to the joint's point on the parent, in a slot to the pin [m].
    pub from: Vec2,
    /// From the child's origin to the joint's point on the child, in a slot to the pin [m].
    pub to: Vec2,
    /// Direction of the child's motion for a growing position of the joint; 0 for a revolute joint.
    pub axis: Vec2,
}

/// First or second derivatives of angles and origins with respect to a parameter of the motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rates {
    /// Derivative of the angle of each body [rad per unit].
    pub angle: Vec<f64>,
    /// Derivative of the origin of each body's frame [m per unit].
    pub origin: Vec<Vec2>,
}

impl Positions {
    /// Components in the mechanism frame of a vector fixed in a body.
    pub fn vector(&self, body: usize, local: Vec2) -> Vec2 {
        rotated(self.rotation[body], local)
    }

    /// Position of a point [m].
    pub fn point(&self, point: Point) -> Vec2 {
        self.origin[point.body] + self.vector(point.body, point.local)
    }

    /// Position, velocity and acceleration of a point for these rates and second rates.
    #[inline]
    pub fn motion(&self, rates: &Rates, second: &Rates, point: Point) -> [Vec2; 3] {
        let arm = self.vector(point.body, point.local);
        let (omega, alpha) = (rates.angle[point.body], second.angle[point.body]);
        let velocity = rates.origin[point.body] + omega * perp(arm);
        let acceleration = second.origin[point.body] + alpha * perp(arm) - omega * omega * arm;
        [self.origin[point.body] + arm, velocity, acceleration]
    }

    /// Velocity of a point for these rates.
    pub fn velocity(&self, rates: &Rates, point: Point) -> Vec2 {
        let arm = self.vector(point.body, point.local);
        rates.origin[point.body] + rates.angle[point.body] * perp(arm)
    }

    /// Acceleration of a point for these rates and second rates.
    pub fn acceleration(&self, rates: &Rates, second: &Rates, point: Point) -> Vec2 {
        self.motion(rates, second, point)[2]
    }
}

impl Rates {
    /// Largest rate of an angle, or of an origin in sizes of the linkage [rad per unit].
    pub fn largest(&self, size: f64) -> f64 {
        let origins = self.origin.iter().map(|rate| rate.norm() / size);
        self.angle.iter().map(|rate| rate.abs()).chain(origins).fold(0.0, f64::max)
    }

    /// Add other derivatives.
    pub fn add(&mut self, other: &Self) {
        self.angle.iter_mut().zip(&other.angle).for_each(|(own, other)| *own += other);
        self.origin.iter_mut().zip(&other.origin).for_each(|(own, other)| *own += other);
    }

    /// Set the rates of the angles from the rates of the coordinates. The rate of the ground's origin stays 0.
    fn set_angles(&mut self, linkage: &Linkage, of_coordinates: &[f64]) {
        self.angle.resize(linkage.bodies.len(), 0.0);
        for (rate, body) in self.angle.iter_mut().zip(&linkage.bodies) {
            *rate = body.angle_coordinate.map_or(0.0, |t| of_coordinates[t]);
        }
        self.origin.resize(linkage.bodies.len(), Vec2::zeros());
    }
}

impl Linkage {
    /// Positions of all bodies at the coordinates q.
    pub fn positions(&self, q: &[f64]) -> Positions {
        let mut p = Positions::default();
        self.update_positions(q, &mut p);
        p
    }

    /// [`Self::positions`], in place.
    pub fn update_positions(&self, q: &[f64], p: &mut Positions) {
        // The ground's position stays 0.
        p.angle.resize(self.bodies.len(), 0.0);
        p.rotation.resize(self.bodies.len(), (1.0, 0.0));
        p.origin.resize(self.bodies.len(), Vec2::zeros());
        p.arms.resize(self.tree.len(), Arms::default());
        p.slots.resize(self.slots.len(), Along::default());
        for ((body, angle), rotation) in self.bodies.iter().zip(&mut p.angle).zip(&mut p.rotation) {
            *angle = body.angle_coordinate.map_or(0.0, |t| q[t]) + body.offset;
            // No trigonometry for bodies at angle 0, such as the ground.
            *rotation = if *angle == 0.0 { (1.0, 0.0) } else { (angle.cos(), angle.sin()) };
        }
        self.place(q, p);
    }

    /// [`Self::update_positions`] after a change of the coordinates to q by steps whose squares are rounding.
    pub fn shift_positions(&self, q: &[f64], step: impl Fn(usize) -> f64, p: &mut Positions) {
        for ((body, angle), rotation) in self.bodies.iter().zip(&mut p.angle).zip(&mut p.rotation) {
            if let Some(t) = body.angle_coordinate {
                *angle = q[t] + body.offset;
                let ((cos, sin), step) = (*rotation, step(t));
                *rotation = (cos - step * sin, sin + step * cos);
            }
        }
        self.place(q, p);
    }

    /// Arms and origins from rotations, outward along the tree.
    fn place(&self, q: &[f64], p: &mut Positions) {
        let (rotations, origin) = (&p.rotation[..], &mut p.origin[..]);
        for (slot, along) in self.slots.iter().zip(&mut p.slots) {
            *along = slot.along(q[slot.coordinate], rotations[self.joints[slot.joint].first.body]);
        }
        for (branch, arms) in self.tree.iter().zip(&mut p.arms) {
            arms.from = rotated(rotations[branch.parent], branch.from);
            arms.to = rotated(rotations[branch.child], branch.to);
            let joint = &self.joints[branch.joint];
            if let (Some(_), Freedom::Slot(index)) = (branch.slide, joint.freedom) {
                // The pin is fixed in one body; in the other one it is where the curve is.
                let Along { out, axis, .. } = p.slots[index];
                let (curved, sign) = if branch.reversed { (&mut arms.to, -1.0) } else { (&mut arms.from, 1.0) };
                *curved += out;
                arms.axis = sign * axis;
            }
            let mut child = origin[branch.parent] + arms.from - arms.to;
            if let (Some(s), Joint { freedom: Freedom::Prismatic(e), first, .. }) = (branch.slide, joint) {
                arms.axis = rotated(rotations[first.body], *e) * if branch.reversed { -1.0 } else { 1.0 };
                child += q[s] * arms.axis;
            }
            origin[branch.child] = child;
        }
    }

    /// First derivatives of angles and origins when the coordinates change at the rate `q_rate`.
    pub fn rates(&self, p: &Positions, q: &[f64], q_rate: &[f64]) -> Rates {
        let mut r = Rates::default();
        self.rates_into(p, q, q_rate, &mut r);
        r
    }

    /// [`Self::rates`], in place.
    pub fn rates_into(&self, p: &Positions, q: &[f64], q_rate: &[f64], r: &mut Rates) {
        r.set_angles(self, q_rate);
        for (branch, &Arms { from, to, axis }) in self.tree.iter().zip(&p.arms) {
            let mut v =
                r.origin[branch.parent] + r.angle[branch.parent] * perp(from) - r.angle[branch.child] * perp(to);
            if let Some(s) = branch.slide {
                v += match self.joints[branch.joint].freedom {
                    Freedom::Slot(_) => q_rate[s] * axis,
                    _ => q_rate[s] * axis + q[s] * r.angle[branch.child] * perp(axis),
                };
            }
            r.origin[branch.child] = v;
        }
    }

    /// Second derivatives of angles and origins for the coordinates and their two derivatives.
    pub fn second_rates_into(&self, p: &Positions, r: &Rates, [q, q_rate, q_second]: [&[f64]; 3], a: &mut Rates) {
        a.set_angles(self, q_second);
        for (branch, &Arms { from, to, axis }) in self.tree.iter().zip(&p.arms) {
            let (parent, child) = (branch.parent, branch.child);
            let mut v = a.origin[parent] + a.angle[parent] * perp(from)
                - r.angle[parent].powi(2) * from
                - a.angle[child] * perp(to)
                + r.angle[child].powi(2) * to;
            if let (Some(s), Joint { freedom: Freedom::Slot(index), first, .. }) =
                (branch.slide, &self.joints[branch.joint])
            {
                let bend = if branch.reversed { -p.slots[*index].bend } else { p.slots[*index].bend };
                let rate = q_rate[s];
                v += q_second[s] * axis + rate * rate * bend + 2.0 * rate * r.angle[first.body] * perp(axis);
            } else if let Some(s) = branch.slide {
                let (omega, alpha) = (r.angle[child], a.angle[child]);
                v += q_second[s] * axis
                    + 2.0 * q_rate[s] * omega * perp(axis)
                    + q[s] * (alpha * perp(axis) - omega * omega * axis);
            }
            a.origin[child] = v;
        }
    }
}

impl Linkage {
    /// Second derivative of the vector from the first point of a slot's joint to the point of the curve, for rates and
    /// second rates of the bodies and of the coordinates.
    pub(super) fn slot_second_rate(
        &self,
        slot: usize,
        p: &Positions,
        (r, a): (&Rates, &Rates),
        [q_rate, q_second]: [&[f64]; 2],
    ) -> Vec2 {
        let Slot { joint, coordinate, .. } = self.slots[slot];
        let (Along { out, axis, bend, .. }, body) = (p.slots[slot], self.joints[joint].first.body);
        let (omega, alpha) = (r.angle[body], a.angle[body]);
        let rate = q_rate[coordinate];
        q_second[coordinate] * axis + rate * rate * bend + 2.0 * omega * rate * perp(axis) + alpha * perp(out)
            - omega * omega * out
    }
}
