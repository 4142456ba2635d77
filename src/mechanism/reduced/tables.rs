//! Tables of the reduced model that are built at their first use.
//!
//! In: the reduced model. Out: coordinates, displacements, markers, origins of bodies. It must not know states or
//! inputs.
use super::Reduced;
use super::stored;
use crate::mechanism::curve::Configuration;
use crate::mechanism::linkage::Point;
use crate::mechanism::loads::resolved::{FrictionJoint, FrictionKind};
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::reactions::{Reaction, columns};
use crate::numerics::plane::Vec2;
use crate::numerics::table::{Table, TablePosition, Unresolved};

impl Reduced {
    /// Every coordinate with its two derivatives along sigma: three components each.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn coordinates(&self) -> Result<&Table, &Unresolved> {
        self.tables.coordinates.as_ref()
    }

    /// A load's displacement and its two derivatives along sigma.
    ///
    /// # Errors
    /// [`Unresolved`].
    #[inline(always)]
    pub fn displacement(&self, index: usize) -> Result<&Table, &Unresolved> {
        match self.tables.displacements[index].get() {
            Some(table) => table.as_ref(),
            None => self.tabulate_displacement(index),
        }
    }

    #[cold]
    fn tabulate_displacement(&self, index: usize) -> Result<&Table, &Unresolved> {
        let table = || {
            let size = self.source.derivative_sizes(self.source.displacement_size(index)).to_vec();
            let (linkage, load) = (self.linkage(), &self.loading().loads[index]);
            let mut fill = |c: &Configuration, v: &mut [f64]| v.copy_from_slice(&load.displacement(linkage, c));
            self.source.tabulate(Some(&stored::displacement(index)), &self.grid, &[size], &mut fill).swap_remove(0)
        };
        self.tables.displacements[index].get_or_init(table).as_ref()
    }

    /// A table of a load's displacement and its two derivatives, and the position of sigma in it. Where the ends of an
    /// actuator almost coincide somewhere the table has a gap there.
    ///
    /// # Errors
    /// [`Unresolved`] in a gap.
    #[inline]
    pub fn displacement_around(&self, load: usize, sigma: f64) -> Result<(&Table, TablePosition), Unresolved> {
        self.displacement_near(load, sigma, 0)
    }

    /// [`Self::displacement_around`], with the search starting at a panel and its neighbours.
    ///
    /// # Errors
    /// As [`Self::displacement_around`].
    #[inline(always)]
    pub fn displacement_near(
        &self,
        load: usize,
        sigma: f64,
        panel: usize,
    ) -> Result<(&Table, TablePosition), Unresolved> {
        match self.displacement(load) {
            Ok(table) => Ok((table, table.position_near(sigma, panel))),
            Err(_) => self.gapped_around(load, sigma),
        }
    }

    #[cold]
    fn gapped_around(&self, load: usize, sigma: f64) -> Result<(&Table, TablePosition), Unresolved> {
        let table = self.tables.gapped[load].get_or_init(|| {
            let size = self.source.derivative_sizes(self.source.displacement_size(load)).to_vec();
            let (linkage, load) = (self.linkage(), &self.loading().loads[load]);
            let mut fill = |c: &Configuration, v: &mut [f64]| v.copy_from_slice(&load.displacement(linkage, c));
            self.source.tabulate_with_gaps(&self.grid, size, &mut fill)
        });
        let table = table.as_ref().map_err(Clone::clone)?;
        let position = table.position(sigma);
        if table.is_gap(position.panel) { Err(Unresolved { sigma, component: 0 }) } else { Ok((table, position)) }
    }

    /// A load's displacement at sigma: from its table, or from the exact evaluator if the ends of an actuator come so
    /// close that no table resolves the second derivative. The search starts at a panel and its neighbours.
    #[inline]
    pub fn displacement_at(&self, load: usize, sigma: f64, mut panel: usize) -> f64 {
        self.displacement_from(load, sigma, &mut panel)
    }

    /// [`Self::displacement_at`]; the panel becomes the one that holds sigma.
    #[inline]
    pub fn displacement_from(&self, load: usize, sigma: f64, panel: &mut usize) -> f64 {
        let stretch = self.at(sigma);
        match stretch.displacement(load) {
            Ok(table) => {
                let position = table.position_near(sigma, *panel);
                *panel = position.panel;
                table.value(position, 0)
            }
            Err(_) => self.loading().loads[load].displacement(self.linkage(), &stretch.curve().configuration(sigma))[0],
        }
    }

    /// A marker's x with its two derivatives along sigma, then y.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn marker(&self, i: usize) -> Result<&Table, &Unresolved> {
        self.tables.markers.get_or_init(|| self.paths(stored::MARKERS, &self.markers))[i].as_ref()
    }

    /// Number of coordinates, and of x and y of the markers: functions whose tables have their two derivatives.
    pub fn functions(&self) -> usize {
        self.linkage().coordinates.len() + 2 * self.markers.len()
    }

    /// Index among these functions of x (axis 0) or y (axis 1) of a marker.
    #[inline(always)]
    pub fn marker_function(&self, marker: usize, axis: usize) -> usize {
        self.linkage().coordinates.len() + 2 * marker + axis
    }

    /// x of the origin of a body of the linkage with its two derivatives along sigma, then y.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn origin(&self, body: usize) -> Result<&Table, &Unresolved> {
        let origin = |body: usize| Point { body, local: Vec2::zeros() };
        let origins = || (0..self.linkage().bodies.len()).map(origin).collect::<Vec<_>>();
        self.tables.origins.get_or_init(|| self.paths(stored::ORIGINS, &origins()))[body].as_ref()
    }

    /// Tables of the x of these points with its two derivatives along sigma, then y.
    fn paths(&self, name: &str, points: &[Point]) -> Vec<Result<Table, Unresolved>> {
        let size = self.source.derivative_sizes(self.linkage().size).repeat(2);
        self.source.tabulate(Some(name), &self.grid, &vec![size; points.len()], &mut |c, values| {
            for (&point, v) in points.iter().zip(values.chunks_exact_mut(6)) {
                let [x, first, second] = c.positions.motion(&c.rates, &c.second, point);
                v.copy_from_slice(&[x.x, first.x, second.x, x.y, first.y, second.y]);
            }
        })
    }

    /// Name of the joint in which most of the friction is that an acceleration causes: the largest product of the
    /// static friction's arm, the slip for each d sigma and the reaction to sigma_ddot = 1. For messages.
    pub fn locking_joint(&self, sigma: f64) -> &str {
        let c = self.curve().configuration(sigma);
        let columns = columns(&self.curve().closure, &c, &[]);
        let joints = self.loading().friction.iter().flat_map(|friction| &friction.friction_joints);
        let is_constant = |joint: &FrictionJoint| matches!(joint.kind, FrictionKind::Constant(_));
        let joints = joints.filter(|own| own.joint < self.linkage().joints.len() && !is_constant(own));
        let weight = |joint: &FrictionJoint| {
            let slip = self.loading().loads[joint.load].influence(self.linkage(), &c).abs();
            joint.law.static_coefficient * joint.radius * slip * columns[0][joint.joint].force.norm()
        };
        let most = joints.max_by(|a, b| weight(a).total_cmp(&weight(b)));
        most.map_or("no joint", |joint| &self.linkage().joints[joint.joint].name)
    }

    /// Derivative dr / d sigma of the position of a lock's point, from the exact evaluator.
    pub fn lock_path(&self, lock: usize, sigma: f64) -> Vec2 {
        let c = self.at(sigma).curve().configuration(sigma);
        c.positions.velocity(&c.rates, self.loading().locks[lock].at)
    }

    /// A joint's reaction to 1 N at a lock's point, along the point's path at sigma; from the exact evaluator.
    pub fn lock_reaction(&self, lock: usize, sigma: f64, joint: usize) -> Reaction {
        let c = self.curve().configuration(sigma);
        let at = self.loading().locks[lock].at;
        let direction = c.positions.velocity(&c.rates, at).normalize();
        columns(&self.curve().closure, &c, &[Load::Force { at, direction }])[2][joint]
    }
}
