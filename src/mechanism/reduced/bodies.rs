//! The motion of each body, and the part of the work of each load that each body receives, in one table.
//!
//! In: the curve, the loads of unit size. Out: a table of functions of sigma, built at its first use. It must not know
//! sizes of loads or drives.
use super::Reduced;
use crate::mechanism::curve::Configuration;
use crate::mechanism::linkage::{GROUND, Point};
use crate::mechanism::loads::unit_load::{Load, Wrench};
use crate::numerics::plane::Vec2;
use crate::numerics::table::{Table, TablePosition, Unresolved};

/// Components of each body at the start of the table: x and y of the centre of mass and the angle, each as its
/// derivative along sigma.
const MOTION: usize = 3;

/// The mechanism body by body.
#[derive(Clone, Debug)]
pub struct Bodies {
    /// [`MOTION`] components for each body but the ground, then one for each of [`Self::pairs`]: the virtual work of
    /// the unit load on the body for each d sigma.
    table: Result<Table, Unresolved>,
    /// Load and body, ascending by load, for each body on which a load acts. Gravity acts on all and is not listed.
    pub pairs: Vec<[usize; 2]>,
    /// Number of bodies, with the ground.
    count: usize,
}

impl Bodies {
    /// Components of the table with the motion of a body.
    pub fn motion(&self, body: usize) -> [usize; MOTION] {
        std::array::from_fn(|k| MOTION * (body - 1) + k)
    }

    /// Component of the table with the work of `pairs[index]`.
    pub fn work(&self, index: usize) -> usize {
        MOTION * (self.count - 1) + index
    }

    /// The table and the position of sigma in it. The search starts at a panel and its neighbours.
    ///
    /// # Errors
    /// [`Unresolved`]: the two ends of a load almost coincide at sigma.
    pub fn table(&self, sigma: f64, panel: usize) -> Result<(&Table, TablePosition), Unresolved> {
        let table = self.table.as_ref().map_err(Clone::clone)?;
        let position = table.position_near(sigma, panel);
        if table.is_gap(position.panel) { Err(Unresolved { sigma, component: 0 }) } else { Ok((table, position)) }
    }
}

impl Reduced {
    /// The mechanism body by body.
    pub fn bodies(&self) -> &Bodies {
        self.tables.bodies.get_or_init(|| {
            let (linkage, loads) = (self.linkage(), &self.loading().loads);
            let count = linkage.bodies.len();
            let exerted = |c: &Configuration, act: &mut dyn FnMut(usize, Wrench)| {
                for (index, load) in loads.iter().enumerate().filter(|(_, load)| !matches!(load, Load::Gravity(_))) {
                    load.exert(linkage, &c.positions, &mut |wrench| {
                        if wrench.body != GROUND {
                            act(index, wrench);
                        }
                    });
                }
            };
            let mut pairs = Vec::new();
            exerted(&self.curve().configuration(self.curve().range.0), &mut |load, wrench| {
                pairs.push([load, wrench.body]);
            });
            let of = |size: f64| size / self.source.length;
            let mut sizes = [of(linkage.size), of(linkage.size), of(1.0)].repeat(count - 1);
            sizes.extend(pairs.iter().map(|[load, _]| of(self.source.displacement_size(*load))));
            let table = self.source.tabulate_with_gaps(&self.grid, sizes, &mut |c, values| {
                let velocity = |body, local: Vec2| c.positions.velocity(&c.rates, Point { body, local });
                let (motions, works) = values.split_at_mut(MOTION * (count - 1));
                for (body, motion) in (1..count).zip(motions.chunks_exact_mut(MOTION)) {
                    let center = velocity(body, linkage.bodies[body].center);
                    motion.copy_from_slice(&[center.x, center.y, c.rates.angle[body]]);
                }
                let mut works = works.iter_mut();
                exerted(c, &mut |_, Wrench { body, force, moment }| {
                    if let Some(work) = works.next() {
                        *work = force.dot(&velocity(body, Vec2::zeros())) + moment * c.rates.angle[body];
                    }
                });
            });
            Bodies { table, pairs, count }
        })
    }
}
