//! The reduced model: curve, loads and tables.
//!
//! In: a definition. Out: the reduced model, with the tables that every start needs. It must not know states or inputs.
use super::characteristics;
use super::error::ReductionError;
use super::knots::knots;
use super::meetings::{self, MEET};
use super::reactions::ReactionTables;
use super::resolved::{Resolved, limits};
use super::snap::trace;
use super::source::{Components, Source};
use super::state_loads::StateLoads;
use super::stored::{START, Stored};
use super::stretches::Beyond;
use super::weight::Weight;
use crate::mechanism::curve::{Configuration, Curve, CurveError, Ends, NEAR_CROSSING, NearMiss};
use crate::mechanism::definition::{Mechanism, Solver};
use crate::mechanism::linkage::{Linkage, Point};
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::table::{Grid, NOISE, Table, Unresolved};
use std::sync::{Arc, OnceLock};

/// Tables that share their evaluations, built at the first use of one of them.
pub(super) type Lazy = OnceLock<Vec<Result<Table, Unresolved>>>;

/// A linkage reduced to one element on its curve, where the reduced inertia is 1.
#[derive(Debug)]
pub struct Reduced {
    pub(super) source: Source,
    /// Points of the markers.
    pub(crate) markers: Vec<Point>,
    /// Grid of tables of displacements.
    pub(super) grid: Grid,
    /// Grid of tables of reactions to applied loads, refined where displacements needed it.
    pub(super) fine: Grid,
    pub(super) tables: Arc<Tables>,
    /// Whether the motion is evaluated without tables.
    pub(crate) exact: bool,
    /// Least speed to which errors are relative, as a part of that gained over the length of 1 rad.
    pub(crate) speed_floor: f64,
    /// State loads without and with moving air.
    pub(super) state_loads: [OnceLock<Result<Option<StateLoads>, Unresolved>>; 2],
    /// Those of a model with the same curve, loads and springs, if they are there.
    known_state_loads: [Option<StateLoads>; 2],
    /// Knots of the motion on this stretch, if the law of a coupling has some.
    pub(super) knots: Option<Box<[f64]>>,
    /// What is beyond the open ends of the curve, if it has one.
    pub(super) beyond: Option<Box<Beyond>>,
    /// Why the motion ends at the low and at the high end of the curve, where two ends of a load coincide there.
    pub(super) ends_meet: [Option<ReductionError>; 2],
    /// Number of the stretch: 0 for the one with the guess, negative on its low side.
    pub(crate) stretch: i32,
}

/// Tables that depend on the curve, the markers, the loads of unit size and the laws of the springs.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) influence: Table,
    pub(super) coordinates: Result<Table, Unresolved>,
    pub(super) displacements: Vec<OnceLock<Result<Table, Unresolved>>>,
    /// Displacements under gravity of 1 m/s2 along x, then along y, if there is gravity: that under any other gravity is
    /// their sum. The influences of both are the last two components of `influence`.
    pub(super) weights: Option<Result<Table, Unresolved>>,
    /// Those that no table resolves everywhere, with gaps.
    pub(super) gapped: Vec<OnceLock<Result<Table, Unresolved>>>,
    pub(super) markers: Lazy,
    /// Origins of the bodies.
    pub(super) origins: Lazy,
    /// Reactions to applied loads and springs.
    pub(super) reactions: ReactionTables,
    /// Reactions to loads sized by a state.
    pub(super) state_reactions: ReactionTables,
}

/// Tables built so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Built {
    /// Number of tables of a load's displacement.
    pub displacements: usize,
    /// Markers.
    pub markers: bool,
    /// Origins of the bodies.
    pub origins: bool,
    /// Reactions of the joints to applied loads and springs.
    pub reactions: bool,
    /// Reactions of the joints to loads sized by a state.
    pub state_reactions: bool,
    /// State loads, without and with moving air.
    pub state_loads: [bool; 2],
}

/// What a reduced model is of.
#[derive(Clone, Copy)]
pub(super) enum Origin<'a> {
    /// The curve through the guess.
    Guess(&'a Solver),
    /// The curve through the guess, with kept tables.
    Stored(&'a Solver, &'a Stored),
    /// A further stretch of the curve of a reduced model, with its number.
    Whole(&'a Reduced, i32),
}

impl Reduced {
    /// Assemble, trace and reduce.
    ///
    /// # Errors
    /// [`ReductionError`].
    pub fn new(mechanism: &Mechanism) -> Result<Self, ReductionError> {
        Self::traced(Resolved::new(mechanism)?, mechanism)
    }

    /// On the curve that is traced: between the stops, or the whole curve if the guess is beyond a stop and the start is not
    /// on the part of the travel that is nearest to it.
    fn traced(resolved: Resolved, mechanism: &Mechanism) -> Result<Self, ReductionError> {
        let curve = trace(&resolved, mechanism, false)?;
        if curve.by_start {
            let (loading, markers) = (resolved.loading.clone(), resolved.markers.clone());
            match Self::on(Arc::new(curve), loading, markers, mechanism) {
                Ok(reduced) if reduced.has_start(mechanism) => return Ok(reduced),
                _ => {}
            }
            let curve = trace(&resolved, mechanism, true)?.decided_by_start();
            return Self::on(Arc::new(curve), resolved.loading, resolved.markers, mechanism);
        }
        Self::on(Arc::new(curve), resolved.loading, resolved.markers, mechanism)
    }

    /// The curve alone.
    ///
    /// # Errors
    /// [`Self::new`]'s.
    pub fn trace(mechanism: &Mechanism) -> Result<Curve, ReductionError> {
        trace(&Resolved::new(mechanism)?, mechanism, false)
    }

    /// The reduced model of a mechanism of which others with other parameters are known, equal to [`Self::new`] to the
    /// bit. The curve and the tables of one of these are kept unless something on which they depend has changed.
    ///
    /// # Errors
    /// [`Self::new`]'s.
    pub fn renewed(known: &[&Self], mechanism: &Mechanism) -> Result<Self, ReductionError> {
        let Resolved { linkage, loading, markers } = Resolved::new(mechanism)?;
        let moves_so = |known: &&&Self| !known.is_part() && known.moves_as(&linkage, &loading);
        let has_tables = |known: &&&Self, gravity: Option<usize>| {
            let own = known.loading();
            let mut loads = loading.loads.iter().zip(&own.loads).enumerate();
            loading.loads.len() == own.loads.len()
                && loads.all(|(load, (one, other))| one == other || gravity == Some(load))
                && (&loading.springs, &markers) == (&own.springs, &known.markers)
        };
        let like = || known.iter().filter(moves_so);
        let weighed = || like().find(|known| has_tables(known, loading.gravity));
        match (like().find(|known| has_tables(known, None)), weighed(), like().next()) {
            (None, Some(like), _) => {
                let mut tables = like.tables.without_gravity();
                tables.weigh(&loading, like.source.components.count);
                let source = Source { loading: Arc::new(loading), stored: None, ..like.source.clone() };
                let (grid, fine, of) = (like.grid.clone(), like.fine.clone(), Origin::Guess(&mechanism.solver));
                Ok(Self::assembled(source, markers, [grid, fine], Arc::new(tables), of))
            }
            (Some(like), ..) => {
                let source = Source { loading: Arc::new(loading), ..like.source.clone() };
                let (grid, fine, tables) = (like.grid.clone(), like.fine.clone(), Arc::clone(&like.tables));
                let own = Self::assembled(source, markers, [grid, fine], tables, Origin::Guess(&mechanism.solver));
                Ok(Self { known_state_loads: like.latest_state_loads(), ..own })
            }
            (None, None, Some(like)) => Self::on(Arc::clone(&like.source.curve), loading, markers, mechanism),
            (None, None, None) => Self::traced(Resolved { linkage, loading, markers }, mechanism),
        }
    }

    /// The state loads without and with moving air, as far as they are known.
    fn latest_state_loads(&self) -> [Option<StateLoads>; 2] {
        std::array::from_fn(|air| match self.state_loads[air].get() {
            Some(Ok(Some(own))) => Some(own.clone()),
            _ => self.known_state_loads[air].clone(),
        })
    }

    /// Whether this linkage moves along the same curve between the same stops.
    fn moves_as(&self, linkage: &Linkage, loading: &Loading) -> bool {
        *linkage == *self.curve().drawn() && limits(loading).eq(limits(self.loading()))
    }

    /// The reduced model on a given curve. Where two ends of a load coincide somewhere on it: on the arc between such
    /// positions that has the start, or else the guess.
    fn on(
        curve: Arc<Curve>,
        loading: Loading,
        markers: Vec<Point>,
        mechanism: &Mechanism,
    ) -> Result<Self, ReductionError> {
        let (loading, of) = (Arc::new(loading), Origin::Guess(&mechanism.solver));
        let whole = Self::tabulated(Arc::clone(&curve), Arc::clone(&loading), markers.clone(), of);
        let Err(ReductionError::EndsMeet { .. }) = whole else { return whole };
        let mut first = None;
        for arc in meetings::arcs(&curve, &loading) {
            let part = Arc::new(curve.between(arc.range));
            let reduced = Self::tabulated(part, Arc::clone(&loading), markers.clone(), of);
            let reduced = reduced.map(|reduced| Self { ends_meet: arc.ends, ..reduced });
            if reduced.as_ref().is_ok_and(|reduced| reduced.has_start(mechanism)) {
                return reduced;
            }
            first = first.or(Some(reduced));
        }
        first.unwrap_or(whole)
    }

    /// The reduced model on a stretch of this one's curve, as far as no two ends of a load coincide.
    pub(super) fn on_stretch(&self, curve: Curve, stretch: i32) -> Result<Self, ReductionError> {
        let (loading, of) = (&self.source.loading, Origin::Whole(self, stretch));
        let on = |curve: Arc<Curve>| Self::tabulated(curve, Arc::clone(loading), self.markers.clone(), of);
        let curve = Arc::new(curve);
        let whole = on(Arc::clone(&curve));
        let Err(ReductionError::EndsMeet { .. }) = whole else { return whole };
        let (first, last) = curve.range;
        // Its inner end is that next to the guess.
        let is_inner = |arc: &meetings::Arc| if stretch < 0 { arc.range.1 == last } else { arc.range.0 == first };
        match meetings::arcs(&curve, loading).into_iter().find(is_inner) {
            Some(arc) => Ok(Self { ends_meet: arc.ends, ..on(Arc::new(curve.between(arc.range)))? }),
            None => whole,
        }
    }

    fn assembled(
        source: Source,
        markers: Vec<Point>,
        [grid, fine]: [Grid; 2],
        tables: Arc<Tables>,
        of: Origin,
    ) -> Self {
        let (exact, speed_floor, stretch) = match of {
            Origin::Guess(solver) | Origin::Stored(solver, _) => (!solver.tables, solver.speed_floor, 0),
            Origin::Whole(whole, stretch) => (whole.exact, whole.speed_floor, stretch),
        };
        let beyond = if stretch == 0 { Beyond::of(&source.curve) } else { None };
        let knots = knots(&source.curve, &source.loading, &grid.borders);
        Self {
            source,
            markers,
            grid,
            fine,
            tables,
            exact,
            speed_floor,
            state_loads: Default::default(),
            known_state_loads: [None, None],
            knots,
            beyond,
            ends_meet: [None, None],
            stretch,
        }
    }

    /// The reduced model with the tables that every start needs.
    pub(super) fn tabulated(
        curve: Arc<Curve>,
        loading: Arc<Loading>,
        markers: Vec<Point>,
        of: Origin,
    ) -> Result<Self, ReductionError> {
        let noise = NOISE.max(16.0 * f64::EPSILON * curve.farthest);
        let (length, stored) = match of {
            Origin::Guess(_) => (None, None),
            Origin::Stored(_, stored) => (None, Some(stored)),
            Origin::Whole(whole, _) => (Some(whole.scale()), None),
        };
        let borders = match stored {
            Some(stored) => stored.borders.to_vec(),
            None => characteristics::grid(&curve, &loading),
        };
        let grid = Grid { borders, centers: curve.crossings.to_vec(), noise };
        let source = Source { stored: stored.cloned(), ..Source::new(curve, loading, length) };
        let Source { curve, loading, components, .. } = &source;
        let linkage = curve.linkage();
        // All share their evaluations.
        let needed = needed(loading);
        let weight = loading.gravity.map(|load| Weight::new(load, components.count));
        let mut sizes = vec![source.influence_sizes(), source.coordinate_sizes()];
        sizes.extend(needed.iter().map(|&l| source.derivative_sizes(source.displacement_size(l)).to_vec()));
        if let Some(weight) = &weight {
            let unit = source.derivative_sizes(source.size_of(&weight.units[0]));
            sizes[0][weight.load] = 0.0;
            sizes[0].extend([unit[1]; 2]);
            sizes.push(unit.repeat(2));
        }
        let mut springs = Vec::new();
        let fill = &mut |c: &Configuration, values: &mut [f64]| {
            let (influences, rest) = values.split_at_mut(components.count + 2 * usize::from(weight.is_some()));
            let (coordinates, rest) = rest.split_at_mut(3 * c.q.len());
            let (displacements, units) = rest.split_at_mut(3 * needed.len());
            for (&load, v) in needed.iter().zip(displacements.chunks_exact_mut(3)) {
                v.copy_from_slice(&loading.loads[load].displacement(linkage, c));
            }
            let (influences, of_units) = influences.split_at_mut(components.count);
            if let Some(weight) = &weight {
                for (k, unit) in weight.units.iter().enumerate() {
                    let displacement = unit.displacement(linkage, c);
                    of_units[k] = displacement[1];
                    units[3 * k..3 * k + 3].copy_from_slice(&displacement);
                }
            }
            // The needed loads begin with all loads that have an influence, but for gravity, whose influence is a sum.
            source.spring_loads(c, &mut springs);
            let slope = |load: usize| match loading.gravity {
                Some(gravity) if load == gravity => 0.0,
                Some(gravity) if load > gravity => displacements[3 * load - 2],
                _ => displacements[3 * load + 1],
            };
            components.fill(&springs, slope, influences);
            for (i, derivatives) in coordinates.chunks_exact_mut(3).enumerate() {
                derivatives.copy_from_slice(&[c.q[i], c.q_sigma[i], c.q_second[i]]);
            }
        };
        let mut tables = source.tabulate(Some(START), &grid, &sizes, fill);
        let fine = grid.refined(tables.iter().flatten());
        let [displacements, gapped] =
            [(); 2].map(|()| loading.loads.iter().map(|_| OnceLock::new()).collect::<Vec<_>>());
        let weights = weight.map(|weight| (weight, tables.pop()));
        for (load, table) in needed.into_iter().zip(tables.drain(2..)) {
            // Two stops of one load have the same table.
            let _ = displacements[load].set(table);
        }
        characteristics::check_volumes(curve, loading, |load| displacements[load].get()?.as_ref().ok())?;
        let coordinates = tables.swap_remove(1);
        // Other displacements need the panels that the coordinates' second derivatives need.
        let grid = grid.refined(&coordinates);
        let influence = tables.swap_remove(0).map_err(|e| unresolved_influence(loading, curve, &e))?;
        let mut tables = Tables {
            influence,
            coordinates,
            displacements,
            weights: weights.and_then(|(_, table)| table),
            gapped,
            markers: OnceLock::new(),
            origins: OnceLock::new(),
            reactions: ReactionTables::on(&fine),
            state_reactions: ReactionTables::on(&grid),
        };
        tables.weigh(loading, components.count);
        Ok(Self::assembled(source, markers, [grid, fine], Arc::new(tables), of))
    }

    /// Loads of which every start needs the displacement.
    pub(super) fn needed(&self) -> Vec<usize> {
        needed(self.loading())
    }

    /// The linkage.
    pub fn linkage(&self) -> &Linkage {
        self.source.linkage()
    }

    /// The curve, the exact evaluator behind the tables.
    pub fn curve(&self) -> &Curve {
        &self.source.curve
    }

    /// The loads with their laws.
    pub fn loading(&self) -> &Loading {
        &self.source.loading
    }

    /// Sizes of the applied loads under these inputs. Inputs that size no load come after those that do.
    pub fn sizes(&self, inputs: &[f64]) -> Vec<f64> {
        let mut sizes = Vec::new();
        self.sizes_into(inputs, &mut sizes);
        sizes
    }

    /// [`Self::sizes`] into a list.
    pub fn sizes_into(&self, inputs: &[f64], sizes: &mut Vec<f64>) {
        let (loads, constants) = (self.loading().inputs.len(), &self.loading().constants);
        sizes.clear();
        sizes.reserve_exact(loads + constants.len());
        sizes.extend_from_slice(&inputs[..loads]);
        sizes.extend_from_slice(constants);
    }

    /// Components of [`Self::influence`].
    pub fn components(&self) -> Components {
        self.source.components
    }

    /// Growth of a load's displacement over one revolution of a closed curve; 0 for another curve.
    pub fn load_growth(&self, load: usize) -> f64 {
        self.loading().loads[load].growth(self.curve())
    }

    /// S_sigma of every applied load, then the other [`Components`]. Their sum, each times its size, is sigma_ddot.
    pub fn influence(&self) -> &Table {
        &self.tables.influence
    }

    /// Length of a closed curve.
    pub fn period(&self) -> Option<f64> {
        let (first, last) = self.curve().range;
        matches!(self.curve().ends, Ends::Closed(_)).then_some(last - first)
    }

    /// Length along the curve for a motion of 1 rad.
    pub fn scale(&self) -> f64 {
        self.source.length
    }

    /// Loads sized by a state, if any: dampers, drives with an efficiency, bumpers, friction, and drag if `air` moves.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn state_loads(&self, air: bool) -> Result<Option<&StateLoads>, &Unresolved> {
        let build =
            || StateLoads::build(&self.source, &self.fine, air, self.known_state_loads[usize::from(air)].as_ref());
        self.state_loads[usize::from(air)].get_or_init(build).as_ref().map(Option::as_ref)
    }

    /// Tables built so far, besides those of the influences and coordinates.
    pub fn built(&self) -> Built {
        let tables = &self.tables;
        Built {
            displacements: tables.displacements.iter().filter(|t| t.get().is_some()).count(),
            markers: tables.markers.get().is_some(),
            origins: tables.origins.get().is_some(),
            reactions: tables.reactions.any(),
            state_reactions: tables.state_reactions.any(),
            state_loads: [0, 1].map(|air| matches!(self.state_loads[air].get(), Some(Ok(Some(_))))),
        }
    }

    /// Values at sigma of the functions that the equation of motion reads, from the exact evaluator: those in the table
    /// of the state loads, or without state loads those of [`Self::influence`].
    ///
    /// Where branches cross to the last digit, reactions are the mean of those on both sides: their limit if they have
    /// one.
    pub fn exact_motion(&self, state_loads: Option<&StateLoads>, sigma: f64) -> Vec<f64> {
        /// Distance of both sides, relative to the scale: the error of the mean is as large as its rounding.
        const ASIDE: f64 = 1e-4;
        let c = self.curve().configuration(sigma);
        if c.factors().is_none() {
            let h = ASIDE * self.scale();
            let [before, after] =
                [-h, h].map(|h| self.exact_values(state_loads, &self.curve().configuration(sigma + h)));
            return before.iter().zip(&after).map(|(a, b)| 0.5 * (a + b)).collect();
        }
        self.exact_values(state_loads, &c)
    }

    /// [`Self::exact_motion`] at a configuration.
    fn exact_values(&self, state_loads: Option<&StateLoads>, c: &Configuration) -> Vec<f64> {
        let Source { loading, components, .. } = &self.source;
        let mut values = vec![0.0; state_loads.map_or(components.count, |s| s.table.components())];
        if let Some(state_loads) = state_loads {
            state_loads.fill(&self.source, c, &mut state_loads.scratch(loading), &mut values);
        } else {
            let mut springs = Vec::new();
            self.source.spring_loads(c, &mut springs);
            components.fill(&springs, |load| loading.loads[load].influence(self.linkage(), c), &mut values);
        }
        values
    }
}

/// Loads of which every start needs the displacement: applied loads but gravity, springs and stops.
fn needed(loading: &Loading) -> Vec<usize> {
    let applied = (0..loading.base()).filter(|load| loading.gravity != Some(*load));
    applied.chain(loading.stops.iter().map(|stop| stop.load)).collect()
}

/// Error for influences that are not smooth: two ends meet, or [`not_smooth`].
fn unresolved_influence(loading: &Loading, curve: &Curve, at: &Unresolved) -> ReductionError {
    let position = curve.describe(at.sigma, 0.0);
    let c = curve.configuration(at.sigma);
    let meets = loading.loads.iter().position(|load| {
        let load = load.along();
        matches!(load, Load::Pair { .. }) && load.displacement(curve.linkage(), &c)[0] < MEET * curve.linkage().size
    });
    match meets {
        Some(load) => ReductionError::EndsMeet { name: loading.name(load), position },
        None => not_smooth(curve, loading.name(at.component.min(loading.loads.len() - 1)), at),
    }
}

/// Error for a function that is not smooth along the curve: branches almost cross, or nothing with mass moves.
pub(super) fn not_smooth(curve: &Curve, what: String, at: &Unresolved) -> ReductionError {
    let position = curve.describe(at.sigma, 0.0);
    let crosses = curve.crossings.iter().any(|sigma| (sigma - at.sigma).abs() < curve.scale());
    if !crosses && curve.amplification(at.sigma) > NEAR_CROSSING {
        let (misses, near) =
            (curve.near.misses.iter(), |miss: &NearMiss| (miss.sigma - at.sigma).abs() < curve.scale());
        let miss = misses.filter(|miss| near(miss)).map(|miss| miss.miss).reduce(f64::min);
        ReductionError::Curve(CurveError::NearCrossing { position, at: curve.configuration(at.sigma).q, miss })
    } else {
        ReductionError::Table { what, position }
    }
}
