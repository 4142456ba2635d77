//! The reduced model: the linkage as one element that moves along sigma, in tables.
//!
//! In: a definition. Out: the influence of every load, and on request the coordinates, displacements, markers and
//! reactions as tables of sigma. A table is built when something first asks for it; all are immutable and shared.
//! It must not know the present state, the inputs or FMI.
mod components;
mod error;
mod scene;
mod start;

pub use components::Components;
pub use error::ReductionError;
pub use scene::{Row, Scene};

use crate::closure::{Closure, guessed};
use crate::curve::{Configuration, Curve, Ends};
use crate::definition::Mechanism;
use crate::linkage::{Linkage, Point, Vec2};
use crate::loading::{Loading, markers};
use crate::loads::Load;
use crate::reactions::{Reaction, columns};
use crate::table::{Table, Unresolved};
use components::Natural;
use std::sync::{Arc, OnceLock};

type Lazy = OnceLock<Result<Table, Unresolved>>;

/// A linkage reduced to one element on its curve, where the reduced inertia is 1.
#[derive(Debug)]
pub struct Reduced {
    curve: Curve,
    loading: Loading,
    components: Components,
    markers: Vec<Point>,
    grid: Vec<f64>,
    natural: Natural,
    influence: Table,
    coordinate_table: Lazy,
    displacement_tables: Vec<Lazy>,
    marker_tables: Vec<Lazy>,
    reaction_tables: Vec<Lazy>,
    state_reaction_tables: Vec<Lazy>,
    /// Without and with air that moves.
    scenes: [OnceLock<Result<Option<Scene>, Unresolved>>; 2],
}

fn lazies(count: usize) -> Vec<Lazy> {
    (0..count).map(|_| OnceLock::new()).collect()
}

impl Reduced {
    /// Assemble, trace and reduce.
    ///
    /// # Errors
    /// [`ReductionError`].
    pub fn new(mechanism: &Mechanism) -> Result<Self, ReductionError> {
        let linkage = Linkage::new(mechanism).map_err(ReductionError::Definition)?;
        let loading = Loading::new(mechanism, &linkage).map_err(ReductionError::Definition)?;
        let markers = markers(mechanism, &linkage).map_err(ReductionError::Definition)?;
        let guess = guessed(&linkage, &mechanism.guess).map_err(ReductionError::Assembly)?;
        let (closure, q) = Closure::assemble(Arc::new(linkage), &guess).map_err(ReductionError::Assembly)?;
        let curve = Curve::trace(closure, &q).map_err(ReductionError::Curve)?;
        let grid = curve.grid();
        let components = Components::new(&loading, &curve);
        let natural = Natural::new(&curve);
        let influence = Table::build(&grid, &components.sizes(&loading, &curve, &natural), &mut |sigma, values| {
            let c = curve.configuration(sigma);
            components.fill(&loading, &curve, &c, values);
            c.amplification
        });
        let influence = influence.map_err(|e| Self::unresolved(&loading, &curve, &e))?;
        Ok(Self {
            coordinate_table: OnceLock::new(),
            displacement_tables: lazies(loading.loads.len()),
            marker_tables: lazies(markers.len()),
            reaction_tables: lazies(curve.linkage().joints.len()),
            state_reaction_tables: lazies(curve.linkage().joints.len()),
            scenes: [OnceLock::new(), OnceLock::new()],
            natural,
            curve,
            loading,
            components,
            markers,
            grid,
            influence,
        })
    }

    /// The linkage.
    pub fn linkage(&self) -> &Linkage {
        self.curve.linkage()
    }

    /// The curve: the exact evaluator behind the tables.
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// The loads, with what makes them as large as they are.
    pub fn loading(&self) -> &Loading {
        &self.loading
    }

    /// Sizes of the sized loads under these inputs; inputs that size no load come after those that do.
    pub fn sizes(&self, inputs: &[f64]) -> Vec<f64> {
        let loads = self.loading.inputs.len();
        inputs[..loads].iter().chain(&self.loading.constants).copied().collect()
    }

    /// What the components of [`Self::influence`] are.
    pub fn components(&self) -> Components {
        self.components
    }

    /// Growth of a load's displacement over one turn of a closed curve; 0 for an open one.
    pub fn load_growth(&self, load: usize) -> f64 {
        self.loading.loads[load].growth(self.linkage(), &|turn| self.growth(turn))
    }

    /// Whether a drive has an efficiency.
    pub fn has_efficiency(&self) -> bool {
        self.loading.drives.iter().any(|d| d.efficiency.is_some())
    }

    /// S_sigma of every sized load, then what [`Components`] tells: the right-hand side is their sum, each times its size.
    pub fn influence(&self) -> &Table {
        &self.influence
    }

    /// Growth of a coordinate over one turn of a closed curve; 0 for an open one.
    pub fn growth(&self, coordinate: usize) -> f64 {
        match self.curve.ends() {
            Ends::Closed(growth) => growth[coordinate],
            Ends::Open => 0.0,
        }
    }

    /// Length of a closed curve.
    pub fn period(&self) -> Option<f64> {
        let (first, last) = self.curve.range();
        matches!(self.curve.ends(), Ends::Closed(_)).then_some(last - first)
    }

    /// Length along the curve that goes with a motion of the size of one radian.
    pub fn scale(&self) -> f64 {
        self.natural.scale
    }

    /// Every coordinate with its two derivatives along sigma: three components each.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn coordinates(&self) -> Result<&Table, &Unresolved> {
        let sizes = || {
            let linkage = self.linkage();
            let size = |i: usize| if i < linkage.turns { 1.0 } else { linkage.size };
            (0..linkage.coordinates.len()).flat_map(|i| self.natural.derivatives(size(i))).collect()
        };
        self.table(&self.coordinate_table, &sizes, &|c, v| {
            for (i, derivatives) in v.chunks_exact_mut(3).enumerate() {
                derivatives.copy_from_slice(&[c.q[i], c.q_sigma[i], c.q_second[i]]);
            }
        })
    }

    /// A load's displacement and its two derivatives along sigma.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn displacement(&self, load: usize) -> Result<&Table, &Unresolved> {
        let load_size = || self.natural.displacement(&self.loading.loads[load], self.linkage());
        let sizes = || self.natural.derivatives(load_size()).to_vec();
        self.table(&self.displacement_tables[load], &sizes, &|c, v| {
            v.copy_from_slice(&self.loading.loads[load].displacement(self.linkage(), c));
        })
    }

    /// A load's displacement at sigma: from its table, or from the exact evaluator where the ends of an actuator come so
    /// close that no table holds its second derivative.
    pub fn displacement_at(&self, load: usize, sigma: f64) -> f64 {
        match self.displacement(load) {
            Ok(table) => table.value(table.spot(sigma), 0),
            Err(_) => self.loading.loads[load].displacement(self.linkage(), &self.curve.configuration(sigma))[0],
        }
    }

    /// A marker's x with its two derivatives along sigma, then y.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn marker(&self, i: usize) -> Result<&Table, &Unresolved> {
        let sizes = || self.natural.derivatives(self.linkage().size).repeat(2);
        self.table(&self.marker_tables[i], &sizes, &|c, v| {
            let (p, point) = (&c.positions, self.markers[i]);
            let (x, first) = (p.point(point), p.velocity(&c.rates, point));
            let second = p.acceleration(&c.rates, &c.second, point);
            v.copy_from_slice(&[x.x, first.x, second.x, x.y, first.y, second.y]);
        })
    }

    /// The point that a marker is.
    pub fn marker_point(&self, i: usize) -> Point {
        self.markers[i]
    }

    /// A joint's reaction: force x, force y, moment; each for sigma_ddot = 1, sigma_dot^2 = 1, then each load = 1 but those
    /// that a state sizes.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn reaction(&self, joint: usize) -> Result<&Table, &Unresolved> {
        let loads = &self.loading.loads[..self.loading.base()];
        let sizes = || {
            let size = self.linkage().size;
            reaction_sizes(vec![self.natural.scale / size, 1.0 / size], loads, &self.natural, self.linkage())
        };
        self.table(&self.reaction_tables[joint], &sizes, &|c, v| {
            spread(&columns(self.curve.closure(), c, loads), joint, v);
        })
    }

    /// A joint's reaction to the loads that a state sizes: force x, force y, moment; each for each of these loads = 1.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn state_reaction(&self, joint: usize) -> Result<&Table, &Unresolved> {
        let loads = &self.loading.loads[self.loading.base()..];
        let sizes = || reaction_sizes(Vec::new(), loads, &self.natural, self.linkage());
        self.table(&self.state_reaction_tables[joint], &sizes, &|c, v| {
            spread(&columns(self.curve.closure(), c, loads)[2..], joint, v);
        })
    }

    /// What a joint transmits at sigma from the exact evaluator, for a joint whose reaction grows without bound somewhere,
    /// so that no table holds it: a column for sigma_ddot = 1, for sigma_dot^2 = 1, then for each load = 1.
    pub fn exact_reaction(&self, joint: usize, sigma: f64) -> Vec<Reaction> {
        let all = columns(self.curve.closure(), &self.curve.configuration(sigma), &self.loading.loads);
        all.iter().map(|column| column[joint]).collect()
    }

    /// How the point of a lock moves along sigma: dr / d sigma, from the exact evaluator.
    pub fn lock_path(&self, lock: usize, sigma: f64) -> Vec2 {
        let c = self.curve.configuration(sigma);
        c.positions.velocity(&c.rates, self.loading.locks[lock].at)
    }

    /// What a joint transmits if a lock pushes its point with 1 N forward along its path at sigma; from the exact evaluator.
    pub fn lock_reaction(&self, lock: usize, sigma: f64, joint: usize) -> Reaction {
        let c = self.curve.configuration(sigma);
        let at = self.loading.locks[lock].at;
        let direction = c.positions.velocity(&c.rates, at).normalize();
        columns(self.curve.closure(), &c, &[Load::Force { at, direction }])[2][joint]
    }

    /// What acts besides loads of a given size, where anything does: dampers, drives with an efficiency, bumpers, friction,
    /// and if `air` moves, its drag.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn scene(&self, air: bool) -> Result<Option<&Scene>, &Unresolved> {
        self.scenes[usize::from(air)].get_or_init(|| Scene::build(self, air)).as_ref().map(Option::as_ref)
    }

    /// Why the influences are not smooth: two ends meet, or nothing with mass moves.
    fn unresolved(loading: &Loading, curve: &Curve, at: &Unresolved) -> ReductionError {
        let position = curve.describe(at.sigma);
        let c = curve.configuration(at.sigma);
        let meets = loading.loads.iter().position(|load| {
            matches!(load, Load::Pair { .. }) && load.displacement(curve.linkage(), &c)[0] < 1e-3 * curve.linkage().size
        });
        match meets {
            Some(load) => ReductionError::EndsMeet { name: loading.name(load), position },
            None => ReductionError::Table { what: loading.name(at.component.min(loading.loads.len() - 1)), position },
        }
    }

    fn table<'a>(
        &self,
        lazy: &'a Lazy,
        sizes: &dyn Fn() -> Vec<f64>,
        exact: &dyn Fn(&Configuration, &mut [f64]),
    ) -> Result<&'a Table, &'a Unresolved> {
        let build = || {
            Table::build(&self.grid, &sizes(), &mut |sigma, values| {
                let c = self.curve.configuration(sigma);
                exact(&c, values);
                c.amplification
            })
        };
        lazy.get_or_init(build).as_ref()
    }
}

/// Natural sizes of reactions: of these terms, then of loads; for both forces and the moment.
fn reaction_sizes(terms: Vec<f64>, loads: &[Load], natural: &Natural, linkage: &Linkage) -> Vec<f64> {
    let mut forces = terms;
    forces.extend(loads.iter().map(|l| natural.displacement(l, linkage) / linkage.size));
    let moments: Vec<f64> = forces.iter().map(|f| f * linkage.size).collect();
    [&forces[..], &forces[..], &moments[..]].concat()
}

/// A joint's part of these columns: force x, force y, moment; each for all columns.
fn spread(columns: &[Vec<Reaction>], joint: usize, v: &mut [f64]) {
    let terms = columns.len();
    for (k, column) in columns.iter().enumerate() {
        let Reaction { force, moment } = column[joint];
        (v[k], v[terms + k], v[2 * terms + k]) = (force.x, force.y, moment);
    }
}
