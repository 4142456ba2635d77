//! The reduced model: curve, loads and tables.
//!
//! In: a curve, the loads on it, tables of both. Out: what the equation of motion reads, and what has been built so
//! far. It must not know states or inputs.
use super::bodies::Bodies;
use super::error::ReductionError;
use super::reactions::ReactionTables;
use super::source::{Components, Source};
use super::state_loads::StateLoads;
use super::stretches::Beyond;
use crate::mechanism::curve::{Curve, Ends};
use crate::mechanism::linkage::{Linkage, Point};
use crate::mechanism::loads::resolved::Loading;
use crate::numerics::table::{Grid, Table, Unresolved};
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
    pub(super) known_state_loads: [Option<StateLoads>; 2],
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
    /// Displacements under gravity of 1 m/s2 along x, then along y, if there is gravity: that under any other gravity
    /// is their sum. The influences of both are the last two components of `influence`.
    pub(super) weights: Option<Result<Table, Unresolved>>,
    /// Those that no table resolves everywhere, with gaps.
    pub(super) gapped: Vec<OnceLock<Result<Table, Unresolved>>>,
    pub(super) markers: Lazy,
    /// Origins of the bodies.
    pub(super) origins: Lazy,
    /// The mechanism body by body.
    pub(super) bodies: OnceLock<Bodies>,
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

impl Reduced {
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

    /// Whether the motion can be prescribed. Without masses nothing else moves the mechanism, also where no drive has a
    /// motion.
    pub fn can_prescribe(&self) -> bool {
        self.loading().motion.is_some() || self.linkage().is_massless
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
    #[inline]
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
    #[inline]
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
}
