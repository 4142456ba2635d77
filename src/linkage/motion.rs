//! Positions, rates and accelerations of the bodies, outward along the tree.
use super::{Branch, Freedom, Linkage, Point, Vec2, quarter};

/// Where every body is.
#[derive(Clone, Debug, PartialEq)]
pub struct Positions {
    /// Angle of each body [rad].
    pub angle: Vec<f64>,
    /// Cosine and sine of it.
    turn: Vec<(f64, f64)>,
    /// Origin of each body's frame [m].
    pub origin: Vec<Vec2>,
}

/// First or second derivatives of angles and origins with respect to a parameter of the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Rates {
    /// Of the angle of each body [rad per unit].
    pub angle: Vec<f64>,
    /// Of the origin of each body's frame [m per unit].
    pub origin: Vec<Vec2>,
}

impl Positions {
    /// A vector fixed in a body, in the mechanism frame.
    pub fn vector(&self, body: usize, local: Vec2) -> Vec2 {
        let (cos, sin) = self.turn[body];
        Vec2::new(cos * local.x - sin * local.y, sin * local.x + cos * local.y)
    }

    /// Position of a point [m].
    pub fn point(&self, point: Point) -> Vec2 {
        self.origin[point.body] + self.vector(point.body, point.local)
    }

    /// Velocity of a point, given the rates.
    pub fn velocity(&self, rates: &Rates, point: Point) -> Vec2 {
        let arm = self.vector(point.body, point.local);
        rates.origin[point.body] + rates.angle[point.body] * quarter(arm)
    }

    /// Acceleration of a point, given the rates and second rates.
    pub fn acceleration(&self, rates: &Rates, second: &Rates, point: Point) -> Vec2 {
        let arm = self.vector(point.body, point.local);
        let (omega, alpha) = (rates.angle[point.body], second.angle[point.body]);
        second.origin[point.body] + alpha * quarter(arm) - omega * omega * arm
    }
}

impl Linkage {
    /// Positions of all bodies at the coordinates q.
    pub fn positions(&self, q: &[f64]) -> Positions {
        let angle: Vec<f64> = self.bodies.iter().map(|b| b.turn.map_or(0.0, |t| q[t]) + b.offset).collect();
        let turn = angle.iter().map(|a| (a.cos(), a.sin())).collect();
        let mut p = Positions { angle, turn, origin: vec![Vec2::zeros(); self.bodies.len()] };
        for branch in &self.tree {
            let (from, to, axis) = self.arms(&p, branch);
            let slide = branch.slide.map_or(Vec2::zeros(), |s| q[s] * axis);
            p.origin[branch.child] = p.origin[branch.parent] + from - to + slide;
        }
        p
    }

    /// First derivatives, when the coordinates change at the rate `q_rate`.
    pub fn rates(&self, p: &Positions, q: &[f64], q_rate: &[f64]) -> Rates {
        let n = self.bodies.len();
        let angle: Vec<f64> = self.bodies.iter().map(|b| b.turn.map_or(0.0, |t| q_rate[t])).collect();
        let mut r = Rates { angle, origin: vec![Vec2::zeros(); n] };
        for branch in &self.tree {
            let (from, to, axis) = self.arms(p, branch);
            let mut v =
                r.origin[branch.parent] + r.angle[branch.parent] * quarter(from) - r.angle[branch.child] * quarter(to);
            if let Some(s) = branch.slide {
                v += q_rate[s] * axis + q[s] * r.angle[branch.child] * quarter(axis);
            }
            r.origin[branch.child] = v;
        }
        r
    }

    /// Second derivatives, when the coordinates change at the rate `q_rate`, itself at the rate `q_second`.
    pub fn second_rates(&self, p: &Positions, r: &Rates, q: &[f64], q_rate: &[f64], q_second: &[f64]) -> Rates {
        let n = self.bodies.len();
        let angle: Vec<f64> = self.bodies.iter().map(|b| b.turn.map_or(0.0, |t| q_second[t])).collect();
        let mut a = Rates { angle, origin: vec![Vec2::zeros(); n] };
        for branch in &self.tree {
            let (from, to, axis) = self.arms(p, branch);
            let (parent, child) = (branch.parent, branch.child);
            let mut v = a.origin[parent] + a.angle[parent] * quarter(from)
                - r.angle[parent].powi(2) * from
                - a.angle[child] * quarter(to)
                + r.angle[child].powi(2) * to;
            if let Some(s) = branch.slide {
                let (omega, alpha) = (r.angle[child], a.angle[child]);
                v += q_second[s] * axis
                    + 2.0 * q_rate[s] * omega * quarter(axis)
                    + q[s] * (alpha * quarter(axis) - omega * omega * axis);
            }
            a.origin[child] = v;
        }
        a
    }

    /// Of a branch, in the mechanism frame: arm of the joint on the parent, arm on the child, and the direction in which
    /// the child moves as the joint's position grows.
    pub fn arms(&self, p: &Positions, branch: &Branch) -> (Vec2, Vec2, Vec2) {
        let joint = &self.joints[branch.joint];
        let (on_parent, on_child) =
            if branch.reversed { (joint.second, joint.first) } else { (joint.first, joint.second) };
        let axis = match joint.freedom {
            Freedom::Turn => Vec2::zeros(),
            Freedom::Slide(e) => p.vector(joint.first.body, e) * if branch.reversed { -1.0 } else { 1.0 },
        };
        (p.vector(on_parent.body, on_parent.local), p.vector(on_child.body, on_child.local), axis)
    }
}
