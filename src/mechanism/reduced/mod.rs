//! The reduced model: the linkage as one element that moves along sigma, in tables.
//!
//! In: a definition. Out: the influence of every load, and on request the coordinates, displacements, markers and
//! reactions as tables of sigma. A table is built when something first asks for it; all are immutable and shared.
//! It must not know the present state, the inputs or FMI.
mod components;
mod error;
mod resolved;
mod start;
mod state_loads;

pub use components::Components;
pub use error::ReductionError;
pub use state_loads::StateLoads;

use crate::mechanism::curve::{Configuration, Curve, CurveError, Ends, NEAR_CROSSING, Workspace};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::linkage::{Linkage, Point, Vec2};
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::reactions::{Columns, Reaction, columns};
use crate::numerics::table::{ACCURACY, Grid, Table, Unresolved};
use components::Natural;
use resolved::Resolved;
use std::sync::{Arc, OnceLock};

/// Tables that come from the same evaluations, built when one of them is first asked for.
type Lazy = OnceLock<Vec<Result<Table, Unresolved>>>;

/// A linkage reduced to one element on its curve, where the reduced inertia is 1.
#[derive(Debug)]
pub struct Reduced {
    curve: Arc<Curve>,
    loading: Loading,
    components: Components,
    markers: Vec<Point>,
    grid: Grid,
    /// Where tables of what given loads do start.
    fine: Grid,
    natural: Natural,
    tables: Arc<Tables>,
    /// Whether the motion is to be evaluated without them.
    exact: bool,
    /// Without and with air that moves.
    scenes: [OnceLock<Result<Option<StateLoads>, Unresolved>>; 2],
}

/// Tables that follow from the curve, the markers, the loads of unit size and the laws of the springs.
#[derive(Debug)]
struct Tables {
    influence: Table,
    coordinates: Result<Table, Unresolved>,
    displacements: Vec<OnceLock<Result<Table, Unresolved>>>,
    markers: Lazy,
    reactions: Lazy,
    state_reactions: Lazy,
}

/// Which tables have been built so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Built {
    /// Displacements of loads, by their number.
    pub displacements: usize,
    /// Points that are markers.
    pub markers: bool,
    /// Reactions of the joints to given loads.
    pub reactions: bool,
    /// Reactions of the joints to loads that a state sizes.
    pub state_reactions: bool,
    /// What friction, drag, bumpers and losses need, without and with moving air.
    pub scenes: [bool; 2],
}

impl Reduced {
    /// Assemble, trace and reduce.
    ///
    /// # Errors
    /// [`ReductionError`].
    pub fn new(mechanism: &Mechanism) -> Result<Self, ReductionError> {
        let resolved = Resolved::new(mechanism)?;
        let curve = Arc::new(resolved.trace(mechanism)?);
        Self::on(curve, resolved.loading, resolved.markers, !mechanism.solver.tables)
    }

    /// The curve alone.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn trace(mechanism: &Mechanism) -> Result<Curve, ReductionError> {
        Resolved::new(mechanism)?.trace(mechanism)
    }

    /// The reduced model of the same mechanism with other parameters, equal to [`Self::new`] to the bit: the curve and the
    /// tables are kept where nothing that they follow from has changed.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn renewed(&self, mechanism: &Mechanism) -> Result<Self, ReductionError> {
        let (resolved, exact) = (Resolved::new(mechanism)?, !mechanism.solver.tables);
        if !resolved.moves_as(self.linkage(), &self.loading) {
            let curve = Arc::new(resolved.trace(mechanism)?);
            return Self::on(curve, resolved.loading, resolved.markers, exact);
        }
        let (curve, Resolved { loading, markers, .. }) = (Arc::clone(&self.curve), resolved);
        if (&loading.loads, &loading.springs, &markers) != (&self.loading.loads, &self.loading.springs, &self.markers) {
            return Self::on(curve, loading, markers, exact);
        }
        let (grid, fine, tables) = (self.grid.clone(), self.fine.clone(), Arc::clone(&self.tables));
        let (components, natural, scenes) = (self.components, self.natural, Default::default());
        Ok(Self { curve, loading, components, markers, grid, fine, natural, tables, exact, scenes })
    }

    /// On a curve that is known, with the tables that every start needs.
    fn on(curve: Arc<Curve>, loading: Loading, markers: Vec<Point>, exact: bool) -> Result<Self, ReductionError> {
        let grid = Grid { borders: curve.grid(ACCURACY), centers: curve.crossings().to_vec() };
        let components = Components::new(&loading, &curve);
        let natural = Natural::new(&curve);
        // The start needs the coordinates, the energies of the given loads and the places of the stops in any case: all
        // from the same evaluations.
        let needed: Vec<usize> = (0..loading.base()).chain(loading.stops.iter().map(|s| s.load)).collect();
        let size = |&l: &usize| natural.derivatives(natural.displacement(&loading.loads[l], curve.linkage())).to_vec();
        let mut sizes = vec![components.sizes(&loading, &curve, &natural), natural.coordinates(curve.linkage())];
        sizes.extend(needed.iter().map(size));
        let mut pulls = Vec::new();
        let fill = &mut |c: &Configuration, values: &mut [f64]| {
            let (influences, rest) = values.split_at_mut(components.count);
            let (coordinates, displacements) = rest.split_at_mut(3 * c.q.len());
            for (&load, v) in needed.iter().zip(displacements.chunks_exact_mut(3)) {
                v.copy_from_slice(&loading.loads[load].displacement(curve.linkage(), c));
            }
            // The needed loads begin with those that the influences are of.
            components.pulls(&loading, &curve, c, &mut pulls);
            components.fill_effects(&pulls, |load| displacements[3 * load + 1], influences);
            for (i, derivatives) in coordinates.chunks_exact_mut(3).enumerate() {
                derivatives.copy_from_slice(&[c.q[i], c.q_sigma[i], c.q_second[i]]);
            }
        };
        let mut tables = tabulate(&curve, &grid, &sizes, fill);
        let fine = grid.refined(tables.iter().flatten());
        let displacements: Vec<_> = loading.loads.iter().map(|_| OnceLock::new()).collect();
        for (load, table) in needed.into_iter().zip(tables.drain(2..)) {
            // Two stops of one load have the same table.
            let _ = displacements[load].set(table);
        }
        let coordinates = tables.swap_remove(1);
        // Whatever moves has to be cut where the coordinates' second derivatives have.
        let grid = grid.refined(&coordinates);
        let influence = tables.swap_remove(0).map_err(|e| Self::unresolved(&loading, &curve, &e))?;
        let tables = Arc::new(Tables {
            influence,
            coordinates,
            displacements,
            markers: OnceLock::new(),
            reactions: OnceLock::new(),
            state_reactions: OnceLock::new(),
        });
        Ok(Self { curve, loading, components, markers, grid, fine, natural, tables, exact, scenes: Default::default() })
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
        &self.tables.influence
    }

    /// Growth of a coordinate over one turn of a closed curve; 0 for an open one.
    pub fn growth(&self, coordinate: usize) -> f64 {
        match self.curve.ends() {
            Ends::Closed(growth) => growth[coordinate],
            Ends::Open | Ends::Stopped { .. } => 0.0,
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
        self.tables.coordinates.as_ref()
    }

    /// A load's displacement and its two derivatives along sigma.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn displacement(&self, load: usize) -> Result<&Table, &Unresolved> {
        let table = || {
            let (linkage, load) = (self.linkage(), &self.loading.loads[load]);
            let size = self.natural.derivatives(self.natural.displacement(load, linkage)).to_vec();
            let mut fill = |c: &Configuration, v: &mut [f64]| v.copy_from_slice(&load.displacement(linkage, c));
            self.tabulate(&self.grid, &[size], &mut fill).swap_remove(0)
        };
        self.tables.displacements[load].get_or_init(table).as_ref()
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
        let tables = self.tables.markers.get_or_init(|| {
            let size = self.natural.derivatives(self.linkage().size).repeat(2);
            self.tabulate(&self.grid, &vec![size; self.markers.len()], &mut |c, values| {
                for (&point, v) in self.markers.iter().zip(values.chunks_exact_mut(6)) {
                    let [x, first, second] = c.positions.motion(&c.rates, &c.second, point);
                    v.copy_from_slice(&[x.x, first.x, second.x, x.y, first.y, second.y]);
                }
            })
        });
        tables[i].as_ref()
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
        self.tables.reactions.get_or_init(|| self.reactions(&self.fine, sizes(), loads, 0))[joint].as_ref()
    }

    /// A joint's reaction to the loads that a state sizes: force x, force y, moment; each for each of these loads = 1.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn state_reaction(&self, joint: usize) -> Result<&Table, &Unresolved> {
        let loads = &self.loading.loads[self.loading.base()..];
        let sizes = || reaction_sizes(Vec::new(), loads, &self.natural, self.linkage());
        self.tables.state_reactions.get_or_init(|| self.reactions(&self.grid, sizes(), loads, 2))[joint].as_ref()
    }

    /// Tables of the reactions of all joints for these loads, without the first `skipped` of their columns: for each joint
    /// force x, force y, moment; each for all columns.
    fn reactions(
        &self,
        grid: &Grid,
        sizes: Vec<f64>,
        loads: &[Load],
        skipped: usize,
    ) -> Vec<Result<Table, Unresolved>> {
        let joints = self.linkage().joints.len();
        let terms = 2 + loads.len() - skipped;
        let mut columns = Columns::default();
        self.tabulate(grid, &vec![sizes; joints], &mut |c, values| {
            let reactions = columns.fill(self.curve.closure(), c, loads, skipped);
            for (joint, v) in values.chunks_exact_mut((3 * terms).max(1)).enumerate() {
                for k in 0..terms {
                    let Reaction { force, moment } = reactions[k * joints + joint];
                    (v[k], v[terms + k], v[2 * terms + k]) = (force.x, force.y, moment);
                }
            }
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
    pub fn state_loads(&self, air: bool) -> Result<Option<&StateLoads>, &Unresolved> {
        self.scenes[usize::from(air)].get_or_init(|| StateLoads::build(self, air)).as_ref().map(Option::as_ref)
    }

    /// Which tables have been built so far, besides those of the influences and coordinates.
    pub fn built(&self) -> Built {
        let tables = &self.tables;
        Built {
            displacements: tables.displacements.iter().filter(|t| t.get().is_some()).count(),
            markers: tables.markers.get().is_some(),
            reactions: tables.reactions.get().is_some(),
            state_reactions: tables.state_reactions.get().is_some(),
            scenes: [0, 1].map(|air| matches!(self.scenes[air].get(), Some(Ok(Some(_))))),
        }
    }

    /// Whether the motion is evaluated without tables.
    pub fn is_exact(&self) -> bool {
        self.exact
    }

    /// What the table of the motion holds, that of the scene or else [`Self::influence`], at sigma from the exact evaluator.
    pub fn exact_motion(&self, state_loads: Option<&StateLoads>, sigma: f64) -> Vec<f64> {
        let c = self.curve.configuration(sigma);
        match state_loads {
            None => {
                let mut values = vec![0.0; self.components.count];
                let influence = |load: usize| self.loading.loads[load].influence(self.linkage(), &c);
                let mut pulls = Vec::new();
                self.components.pulls(&self.loading, &self.curve, &c, &mut pulls);
                self.components.fill_effects(&pulls, influence, &mut values);
                values
            }
            Some(state_loads) => {
                let mut values = vec![0.0; state_loads.table.components()];
                state_loads.fill(self, &c, &mut state_loads.room(self), &mut values);
                values
            }
        }
    }

    /// Why the influences are not smooth: two ends meet, or what [`rough`] says.
    fn unresolved(loading: &Loading, curve: &Curve, at: &Unresolved) -> ReductionError {
        let position = curve.describe(at.sigma, 0.0);
        let c = curve.configuration(at.sigma);
        let meets = loading.loads.iter().position(|load| {
            matches!(load, Load::Pair { .. }) && load.displacement(curve.linkage(), &c)[0] < 1e-3 * curve.linkage().size
        });
        match meets {
            Some(load) => ReductionError::EndsMeet { name: loading.name(load), position },
            None => rough(curve, loading.name(at.component.min(loading.loads.len() - 1)), at),
        }
    }

    fn tabulate(
        &self,
        grid: &Grid,
        sizes: &[Vec<f64>],
        exact: &mut dyn FnMut(&Configuration, &mut [f64]),
    ) -> Vec<Result<Table, Unresolved>> {
        tabulate(&self.curve, grid, sizes, exact)
    }
}

/// Why something is not smooth along the curve: branches almost cross, or nothing with mass moves.
fn rough(curve: &Curve, what: String, at: &Unresolved) -> ReductionError {
    let position = curve.describe(at.sigma, 0.0);
    let crosses = curve.crossings().iter().any(|sigma| (sigma - at.sigma).abs() < curve.scale());
    if !crosses && curve.amplification(at.sigma) > NEAR_CROSSING {
        ReductionError::Curve(CurveError::NearCrossing { position })
    } else {
        ReductionError::Table { what, position }
    }
}

/// Tables of functions of the configuration.
fn tabulate(
    curve: &Curve,
    grid: &Grid,
    sizes: &[Vec<f64>],
    exact: &mut dyn FnMut(&Configuration, &mut [f64]),
) -> Vec<Result<Table, Unresolved>> {
    let (mut work, mut c) = (Workspace::default(), Configuration::default());
    Table::build_all(grid, sizes, &mut |sigma, values| {
        curve.configure(sigma, &mut work, &mut c);
        exact(&c, values);
        c.amplification
    })
}

/// Natural sizes of reactions: of these terms, then of loads; for both forces and the moment.
fn reaction_sizes(terms: Vec<f64>, loads: &[Load], natural: &Natural, linkage: &Linkage) -> Vec<f64> {
    let mut forces = terms;
    forces.extend(loads.iter().map(|l| natural.displacement(l, linkage) / linkage.size));
    let moments: Vec<f64> = forces.iter().map(|f| f * linkage.size).collect();
    [&forces[..], &forces[..], &moments[..]].concat()
}
