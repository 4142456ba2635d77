//! The reduced model: the linkage as one element that moves along sigma, in tables.
//!
//! In: a definition. Out: the influence of every load, and on request the coordinates, displacements, markers and
//! reactions as tables of sigma. A table is built at its first use; all are immutable and shared. It must not know
//! states or inputs.
mod bodies;
mod build;
mod characteristics;
mod error;
mod exact;
mod knots;
mod meetings;
mod prepare;
mod reactions;
mod resolved;
mod snap;
mod source;
mod start;
mod state_loads;
mod stored;
mod stretches;
mod tables;
mod weight;

pub use bodies::Bodies;
pub use error::{ReductionError, if_degrees};
pub use exact::{ExactMotion, ExactReactions};
pub use knots::AT_KNOT;
pub use reactions::PanelTable;
pub use source::Components;
pub use start::Stated;
pub use state_loads::{Argument, Kink, StateLoads};
pub use stretches::End;

use crate::mechanism::curve::{Curve, Ends};
use crate::mechanism::linkage::{Linkage, Point};
use crate::mechanism::loads::resolved::Loading;
use crate::numerics::table::{Grid, Table, Unresolved};
use reactions::ReactionTables;
use source::Source;
use std::sync::{Arc, OnceLock};
use stretches::Beyond;

/// Tables that share their evaluations, built at the first use of one of them.
type Lazy = OnceLock<Vec<Result<Table, Unresolved>>>;

/// A linkage reduced to one element on its curve, where the reduced inertia is 1.
#[derive(Debug)]
pub struct Reduced {
    source: Source,
    /// Points of the markers.
    pub(crate) markers: Vec<Point>,
    /// Grid of tables of displacements.
    grid: Grid,
    /// Grid of tables of reactions to applied loads, refined where displacements needed it.
    fine: Grid,
    tables: Arc<Tables>,
    /// Whether the motion is evaluated without tables.
    pub(crate) exact: bool,
    /// Least speed to which errors are relative, as a part of that gained over the length of 1 rad.
    pub(crate) speed_floor: f64,
    /// State loads without and with moving air.
    state_loads: [OnceLock<Result<Option<StateLoads>, Unresolved>>; 2],
    /// Those of a model with the same curve, loads and springs, if they are there.
    known_state_loads: [Option<StateLoads>; 2],
    /// Knots of the motion on this stretch, if the law of a coupling has some.
    knots: Option<Box<[f64]>>,
    /// What is beyond the open ends of the curve, if it has one.
    beyond: Option<Box<Beyond>>,
    /// Why the motion ends at the low and at the high end of the curve, where two ends of a load coincide there.
    ends_meet: [Option<ReductionError>; 2],
    /// Number of the stretch: 0 for the one with the guess, negative on its low side.
    pub(crate) stretch: i32,
}

/// Tables that depend on the curve, the markers, the loads of unit size and the laws of the springs.
#[derive(Debug)]
struct Tables {
    influence: Table,
    coordinates: Result<Table, Unresolved>,
    displacements: Vec<OnceLock<Result<Table, Unresolved>>>,
    /// Displacements under gravity of 1 m/s2 along x, then along y, if there is gravity: that under any other gravity
    /// is their sum. The influences of both are the last two components of `influence`.
    weights: Option<Result<Table, Unresolved>>,
    /// Those that no table resolves everywhere, with gaps.
    gapped: Vec<OnceLock<Result<Table, Unresolved>>>,
    markers: Lazy,
    /// Origins of the bodies.
    origins: Lazy,
    /// The mechanism body by body.
    bodies: OnceLock<Bodies>,
    /// Reactions to applied loads and springs.
    reactions: ReactionTables,
    /// Reactions to loads sized by a state.
    state_reactions: ReactionTables,
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
