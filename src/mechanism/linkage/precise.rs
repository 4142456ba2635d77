//! Gaps of the loops in twice the precision.
//!
//! In: coordinates of twice the precision. Out: gaps [m], with an error of some 1e-30 of the linkage's size. Close to a
//! singular position the coordinates amplify a gap's rounding; these gaps have none. It must not know Newton's method.
use super::slot::Slot;
use super::structure::{Freedom, Linkage, Point};
use crate::numerics::plane::Vec2;
use crate::numerics::twofold::Twofold;

/// A vector of twice the precision.
type Vector = [Twofold; 2];

fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

fn rotated((cos, sin): (Twofold, Twofold), local: Vec2) -> Vector {
    let [x, y] = [local.x, local.y].map(Twofold::from);
    [cos * x - sin * y, sin * x + cos * y]
}

impl Linkage {
    /// From the first point of a slot's joint to the point of its curve: with the rounding of the curve at the rounded
    /// position, and from there along the tangent.
    fn precise_slot(&self, slot: &Slot, q: &[Twofold], rotations: &[(Twofold, Twofold)]) -> Vector {
        let s = q[slot.coordinate];
        let [at, tangent, _] = slot.local(s.rounded());
        let rest = s - Twofold::from(s.rounded());
        let rotation = rotations[self.joints[slot.joint].first.body];
        plus(rotated(rotation, at), rotated(rotation, tangent).map(|t| t * rest))
    }

    /// [`Linkage::gaps`] at coordinates of twice the precision: the same law.
    pub fn precise_gaps(&self, q: &[Twofold]) -> Vec<f64> {
        let rotations: Vec<_> = self
            .bodies
            .iter()
            .map(|b| (b.angle_coordinate.map_or(Twofold::default(), |t| q[t]) + Twofold::from(b.offset)).cos_sin())
            .collect();
        let mut origins = vec![Vector::default(); self.bodies.len()];
        let outs: Vec<Vector> = self.slots.iter().map(|slot| self.precise_slot(slot, q, &rotations)).collect();
        for branch in &self.tree {
            let arms =
                minus(rotated(rotations[branch.parent], branch.from), rotated(rotations[branch.child], branch.to));
            let mut child = plus(origins[branch.parent], arms);
            if let Freedom::Slot(index) = self.joints[branch.joint].freedom {
                child = if branch.reversed { minus(child, outs[index]) } else { plus(child, outs[index]) };
            }
            if let (Some(s), Freedom::Prismatic(e)) = (branch.slide, self.joints[branch.joint].freedom) {
                let axis =
                    rotated(rotations[self.joints[branch.joint].first.body], if branch.reversed { -e } else { e });
                child = plus(child, axis.map(|a| q[s] * a));
            }
            origins[branch.child] = child;
        }
        let point = |p: Point| plus(origins[p.body], rotated(rotations[p.body], p.local));
        let mut out = Vec::with_capacity(self.rows());
        for &j in &self.cuts {
            let joint = &self.joints[j];
            let [x, y] = minus(point(joint.second), point(joint.first));
            match joint.freedom {
                Freedom::Revolute => out.extend([x.rounded(), y.rounded()]),
                Freedom::Prismatic(e) => {
                    let axis = rotated(rotations[joint.first.body], e);
                    out.push((axis[0] * y - axis[1] * x).rounded());
                }
                Freedom::Slot(index) => {
                    let [x, y] = minus([x, y], outs[index]);
                    out.extend([x.rounded(), y.rounded()]);
                }
                Freedom::Coupling(index) => out.push(self.precise_coupling_gap(&self.couplings[index], q)),
            }
        }
        out
    }
}
