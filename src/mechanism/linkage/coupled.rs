//! Couplings: gears, racks, belts and cams, each one equation between the motions of two bodies relative to a carrier.
//!
//! In: positions and rates of the bodies. Out: the residual of a coupling with its derivatives. It must not know
//! definitions, loads or time.
//!
//! The first wheel turns by u1 relative to the carrier. The second body turns by u2, or it slides by u2 along a
//! prismatic joint of the carrier. The coupling holds u2 = F(u1), and its residual is scale (u2 - F(u1)) [m]. With the
//! multiplier lambda [N] of this equation, the power that the coupling gives to the second body is lambda scale u2_dot,
//! and it takes as much from the first.
use super::coupling::{Coupling, Second};
use super::motion::{Positions, Rates};
use super::structure::{Freedom, Joint, Linkage};
use crate::numerics::order;
use crate::numerics::plane::Vec2;
use crate::numerics::twofold::Twofold;

impl Linkage {
    /// u1 and u2 of a coupling at these positions.
    pub fn coupled(&self, coupling: &Coupling, p: &Positions) -> [f64; 2] {
        self.motions(coupling, &self.joints[coupling.joint], p)
    }

    /// u1 and u2 of a coupling with this joint.
    pub(super) fn motions(&self, coupling: &Coupling, joint: &Joint, p: &Positions) -> [f64; 2] {
        let angle = |body: usize| p.angle[body] - p.angle[coupling.carrier];
        let second = match coupling.second {
            Second::Angle { shift } => angle(joint.second.body) + shift,
            Second::Position { joint, sign, .. } => sign * self.slid(joint, p)[0].dot(&self.slid(joint, p)[1]),
        };
        [angle(joint.first.body) + coupling.shift, second]
    }

    /// u1 of a coupling at these coordinates, and its change for a change of them.
    pub fn first_motion(&self, coupling: &Coupling, q: &[f64], change: &[f64]) -> [f64; 2] {
        let of = |body: usize| {
            let body = &self.bodies[body];
            body.angle_coordinate.map_or([body.offset, 0.0], |i| [q[i] + body.offset, change[i]])
        };
        let ([angle, rate], carrier) = (of(self.joints[coupling.joint].first.body), of(coupling.carrier));
        [angle - carrier[0] + coupling.shift, rate - carrier[1]]
    }

    /// Axis of a prismatic joint and the vector from its first point to its second, in the mechanism frame.
    pub(super) fn slid(&self, joint: usize, p: &Positions) -> [Vec2; 2] {
        let joint = &self.joints[joint];
        let axis = match joint.freedom {
            Freedom::Prismatic(e) => p.vector(joint.first.body, e),
            _ => Vec2::zeros(),
        };
        [axis, p.point(joint.second) - p.point(joint.first)]
    }

    /// Coordinates on which a coupling's residual depends, ascending.
    pub(super) fn coupled_coordinates(&self, coupling: &Coupling) -> Vec<usize> {
        let joint = &self.joints[coupling.joint];
        let angle = |body: usize| self.bodies[body].angle_coordinate;
        let second = match coupling.second {
            Second::Angle { .. } => angle(joint.second.body),
            Second::Position { coordinate, .. } => Some(coordinate),
        };
        let all = [angle(joint.first.body), angle(coupling.carrier), second];
        order::distinct(all.into_iter().flatten().collect())
    }

    /// Residual of a coupling [m].
    pub(super) fn coupling_gap(&self, coupling: &Coupling, p: &Positions) -> f64 {
        let [first, second] = self.coupled(coupling, p);
        coupling.scale * (second - coupling.law.at(first)[0])
    }

    /// Residual of a coupling at coordinates of twice the precision [m].
    pub(super) fn precise_coupling_gap(&self, coupling: &Coupling, q: &[Twofold]) -> f64 {
        let joint = &self.joints[coupling.joint];
        let angle = |body: usize| {
            let body = &self.bodies[body];
            body.angle_coordinate.map_or(Twofold::default(), |t| q[t]) + Twofold::from(body.offset)
        };
        let relative = |body: usize, shift: f64| angle(body) - angle(coupling.carrier) + Twofold::from(shift);
        let second = match coupling.second {
            Second::Angle { shift } => relative(joint.second.body, shift),
            Second::Position { coordinate, sign, .. } => Twofold::from(sign) * q[coordinate],
        };
        let first = relative(joint.first.body, coupling.shift);
        (Twofold::from(coupling.scale) * (second - coupling.law.precise(first))).rounded()
    }

    /// Second derivative of the residual of a coupling, given the rates and second rates.
    pub(super) fn coupling_second_rate(&self, coupling: &Coupling, p: &Positions, r: &Rates, a: &Rates) -> f64 {
        let joint = &self.joints[coupling.joint];
        let relative = |angle: &[f64], body: usize| angle[body] - angle[coupling.carrier];
        let (rate, first) = (relative(&r.angle, joint.first.body), relative(&a.angle, joint.first.body));
        let second = match coupling.second {
            Second::Angle { .. } => relative(&a.angle, joint.second.body),
            Second::Position { joint, sign, .. } => {
                // The gap is s e, with e fixed in the first body: gap'' = (s'' - s omega^2) e + (...) e_normal.
                let [axis, gap] = self.slid(joint, p);
                let joint = &self.joints[joint];
                let second = p.acceleration(r, a, joint.second) - p.acceleration(r, a, joint.first);
                sign * (axis.dot(&second) + axis.dot(&gap) * r.angle[joint.first.body].powi(2))
            }
        };
        let [_, slope, curvature] = coupling.law.at(self.coupled(coupling, p)[0]);
        coupling.scale * (second - slope * first - curvature * rate * rate)
    }

    /// Coordinates on which a coupling's residual depends, each with its derivative.
    pub(super) fn coupling_partials(
        &self,
        coupling: &Coupling,
        p: &Positions,
        add: &mut impl FnMut(Option<usize>, f64),
    ) {
        let joint = &self.joints[coupling.joint];
        let angle = |body: usize| self.bodies[body].angle_coordinate;
        let slope = coupling.law.at(self.coupled(coupling, p)[0])[1];
        add(angle(joint.first.body), -coupling.scale * slope);
        match coupling.second {
            Second::Angle { .. } => {
                add(angle(joint.second.body), coupling.scale);
                add(angle(coupling.carrier), coupling.scale * (slope - 1.0));
            }
            Second::Position { coordinate, sign, .. } => {
                add(Some(coordinate), coupling.scale * sign);
                add(angle(coupling.carrier), coupling.scale * slope);
            }
        }
    }
}
