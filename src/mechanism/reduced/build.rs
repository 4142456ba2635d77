//! Building the reduced model: assembled, traced, tabulated; of another one as much as still holds.
//!
//! In: a definition, or a further stretch of a curve; reduced models of other parameters. Out: the reduced model with
//! the tables that every start needs, or why there is none. It must not know states or inputs.

use super::characteristics;
use super::error::ReductionError;
use super::knots::knots;
use super::meetings::{self, MEET};
use super::reactions::ReactionTables;
use super::resolved::{Resolved, limits};
use super::snap::{not_smooth, trace};
use super::source::Source;
use super::state_loads::StateLoads;
use super::stored::{Origin, START};
use super::stretches::Beyond;
use super::weight::Weight;
use super::{Reduced, Tables};
use crate::mechanism::curve::{Configuration, Curve};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::linkage::{Linkage, Point};
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::table::{Grid, NOISE, Unresolved};
use std::sync::{Arc, OnceLock};

impl Reduced {
    /// Assemble, trace and reduce.
    ///
    /// # Errors
    /// [`ReductionError`].
    pub fn new(mechanism: &Mechanism) -> Result<Self, ReductionError> {
        Self::traced(Resolved::new(mechanism)?, mechanism)
    }

    /// On the curve that is traced: between the stops, or the whole curve if the guess is beyond a stop and the start
    /// is not on the part of the travel that is nearest to it.
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
        let (loading, length, stored) = match of {
            Origin::Guess(_) => (meetings::with_idle(&curve, loading), None, None),
            Origin::Stored(_, stored) => (meetings::with_idle(&curve, loading), None, Some(stored)),
            Origin::Whole(whole, _) => (loading, Some(whole.scale()), None),
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
            bodies: OnceLock::new(),
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
