//! Points of the joints, and the same linkage with these points moved.
//!
//! In: a linkage, a move of each point. Out: a linkage with other joint points and the same bodies. It must not know
//! why points are moved.
use super::structure::{Branch, Linkage, Point};
use crate::numerics::plane::Vec2;

impl Linkage {
    /// Points of the joints: each once, if joints share it.
    pub fn joint_points(&self) -> Vec<Point> {
        let mut all: Vec<Point> = Vec::new();
        for joint in &self.joints {
            for point in [joint.first, joint.second] {
                if !all.contains(&point) {
                    all.push(point);
                }
            }
        }
        all
    }

    /// This linkage with each of the `points`, of [`Self::joint_points`], moved within its body [m]. Masses, and points
    /// that belong to no joint, stay where they are.
    pub fn with_moved_points(&self, points: &[Point], moves: &[Vec2]) -> Self {
        let mut moved = self.clone();
        let place = |point: &mut Point| {
            if let Some(index) = points.iter().position(|other| other == point) {
                point.local += moves[index];
            }
        };
        for joint in &mut moved.joints {
            place(&mut joint.first);
            place(&mut joint.second);
        }
        let Self { tree, joints, .. } = &mut moved;
        for Branch { joint, reversed, from, to, .. } in tree {
            let joint = &joints[*joint];
            (*from, *to) = (joint.first.local, joint.second.local);
            if *reversed {
                std::mem::swap(from, to);
            }
        }
        moved
    }
}
