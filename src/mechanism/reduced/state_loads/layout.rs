//! Where things stand in the tables and lists of the state loads: indices of switches, borders, loads and components.
//!
//! In: numbers of elements. Out: indices. It must not know laws.
use super::StateLoads;
use crate::mechanism::loads::resolved::FrictionKind;
use std::f64::consts::TAU;
use std::ops::Range;

impl StateLoads {
    /// Number of rows of effects: the motion, then the components of the reactions of the joints with friction.
    pub fn rows(&self) -> usize {
        1 + 2 * self.friction_joints.len()
    }

    /// Number of quantities whose signs select a law: the forces of the drives with an efficiency along the curve, then
    /// the normal forces of the prismatic joints with friction, then the distances of forces of controlled drives from
    /// their limits.
    #[inline]
    pub fn switches(&self) -> usize {
        self.limit_switch(self.limits.len())
    }

    /// Index among these of a limit by its index in `limits`.
    #[inline]
    pub fn limit_switch(&self, limit: usize) -> usize {
        self.efficient + self.prismatic.len() + limit
    }

    /// Number of ends of gaps of the table. A step ends there, so that none passes over a gap unseen, where friction
    /// may lock.
    pub fn gap_borders(&self) -> usize {
        2 * self.table.gaps().len()
    }

    /// Number of ends of gaps and of kinks, at which a step ends.
    #[inline]
    pub fn borders(&self) -> usize {
        self.gap_borders() + self.kinks.len()
    }

    /// How far sigma is beyond an end of a gap; on a closed curve with this period, beyond one that may be revolutions
    /// away.
    pub fn beyond_gap(&self, border: usize, sigma: f64, period: Option<f64>) -> f64 {
        let Some((a, b)) = self.table.gaps().nth(border / 2) else { return 0.0 };
        let beyond = sigma - if border.is_multiple_of(2) { a } else { b };
        // As a sine, without a jump; half a revolution away a step ends in vain.
        period.map_or(beyond, |period| (TAU * beyond / period).sin())
    }

    /// Index in `drives` of the first load of a law or speed of a surface.
    #[inline]
    pub fn first_law(&self) -> usize {
        self.laws.first().map_or(self.drives.len() - self.surfaces, |law| law.at)
    }

    /// Index in `loads` of the load of `bumpers[k]`.
    #[inline]
    pub fn bumper(&self, k: usize) -> usize {
        self.spring(0) - self.bumpers.len() + k
    }

    /// Index in `loads` of the load of `springs[k]`.
    #[inline]
    pub fn spring(&self, k: usize) -> usize {
        self.free() - self.springs.len() + k
    }

    /// Joints with constant friction, the last friction joints, by their indices there, each with its size.
    pub fn constant_friction(&self) -> impl Iterator<Item = (usize, f64)> {
        self.friction_joints.iter().enumerate().filter_map(|(k, joint)| match joint.kind {
            FrictionKind::Constant(size) => Some((k, size)),
            _ => None,
        })
    }

    /// Number of `loads` that are not friction.
    #[inline]
    pub fn free(&self) -> usize {
        self.loads.len() - self.friction_joints.len()
    }

    /// In the bundle: reactions to sigma_dot^2 = 1.
    #[inline]
    pub fn square(&self) -> Range<usize> {
        let (first, n) = (self.loads.len(), self.friction_joints.len());
        first..first + 2 * n
    }

    /// In the bundle: reactions to sigma_ddot = 1.
    #[inline]
    pub fn inertial(&self) -> Range<usize> {
        let (first, n) = (self.square().end, self.friction_joints.len());
        first..first + 2 * n
    }

    /// In the bundle: the two forces of each group for friction = 1 of each joint without motion: all first ones, then
    /// all second ones, group by group. They are the components x and y of the reactions of the group; of prismatic
    /// joints the normal force in the first one, and its change with the lever.
    #[inline]
    pub fn passed(&self) -> Range<usize> {
        let first = self.inertial().end;
        first..first + 2 * self.groups.count() * self.friction_joints.len()
    }

    /// In the bundle: reactions to one of the `loads` that are not friction and to the motion that the load causes.
    #[inline]
    pub fn caused(&self, load: usize) -> Range<usize> {
        let (first, n) = (self.passed().end, self.friction_joints.len());
        first + 2 * n * load..first + 2 * n * (load + 1)
    }

    /// In the bundle: first component of the direction of a surface in the mechanism frame; the second follows.
    #[inline]
    pub fn line(&self, surface: usize) -> usize {
        self.caused(self.free()).start + 2 * surface
    }

    /// In the bundle: the displacement of the load of `bumpers[k]`.
    #[inline]
    pub fn pressed(&self, k: usize) -> usize {
        // Each surface has three loads.
        self.line(self.bumper(0) / 3) + k
    }

    /// In the bundle: the displacement of the load of `springs[k]`.
    #[inline]
    pub fn stretched(&self, k: usize) -> usize {
        self.pressed(self.bumpers.len()) + k
    }

    /// In the bundle: the displacement of the drive `positioned[k]`.
    #[inline]
    pub fn driven(&self, k: usize) -> usize {
        self.stretched(self.springs.len()) + k
    }

    /// Number of components of the bundle.
    pub fn bundled(&self) -> usize {
        self.driven(self.positioned.len())
    }

    /// Component of the table: effect of the component `k` of [`super::Components`] in a row.
    #[inline]
    pub fn given(&self, row: usize, k: usize) -> usize {
        self.bundled() + row * self.given + k
    }
}
