//! What several outputs of one state share, computed when an output first needs it.
use super::Forces;
use super::reaction::JointReaction;
use super::slopes::Slopes;
use crate::mechanism::dynamics::equation::Scratch;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::dual::same_bits;
use crate::numerics::table::TablePosition;

/// Intermediate results of outputs in the present state under the present inputs.
#[derive(Clone, Debug)]
pub struct OutputCache {
    /// Forces and acceleration, once evaluated in this state.
    pub(super) effect: Option<Forces>,
    /// Position in the table of the coordinates, once found in this state.
    pub(super) spot: Option<TablePosition>,
    /// Panel of the table of the coordinates in which sigma was last.
    pub(super) panel: usize,
    /// Reactions of the joints.
    pub(super) reactions: Vec<JointReaction>,
    /// Whether a reaction has been computed in this state.
    pub(super) used: bool,
    /// Evaluations since the start.
    pub(super) computed: Computed,
    /// Sizes of the sized loads under the present inputs.
    pub(super) sizes: Vec<f64>,
    /// Right-hand side for these sizes.
    pub(super) scratch: Scratch,
    /// Scratch of derivatives, once one has been asked for.
    pub(super) slopes: Option<Box<Slopes>>,
}

/// How often outputs have made something be computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Computed {
    /// Evaluations of the acceleration with friction, drag and the forces of stops.
    pub effects: u64,
    /// Reactions of a joint.
    pub reactions: u64,
}

impl OutputCache {
    pub fn new(reduced: &Reduced, state_loads: Option<&StateLoads>, inputs: &[f64]) -> Self {
        Self {
            effect: None,
            spot: None,
            panel: 0,
            reactions: vec![JointReaction::new(); reduced.linkage().joints.len()],
            used: false,
            computed: Computed::default(),
            sizes: reduced.sizes(inputs),
            scratch: Scratch::new(state_loads),
            slopes: None,
        }
    }

    /// The state has changed.
    pub fn invalidate(&mut self) {
        (self.effect, self.spot) = (None, None);
        if self.used {
            self.reactions.iter_mut().for_each(|t| t.value = None);
            self.used = false;
        }
    }

    /// An input has changed. `loads` is the number of inputs that size loads; they come first.
    pub fn set_input(&mut self, input: usize, loads: usize, value: f64) {
        if input < loads {
            self.sizes[input] = value;
            self.invalidate_sizes();
        }
        self.invalidate();
    }

    /// The state and the inputs that size loads have changed.
    pub fn set_inputs(&mut self, sizes: &[f64]) {
        if !same_bits(sizes, &self.sizes[..sizes.len()]) {
            self.sizes[..sizes.len()].copy_from_slice(sizes);
            self.invalidate_sizes();
        }
        self.invalidate();
    }

    fn invalidate_sizes(&mut self) {
        self.scratch.panel_force.invalidate();
        self.reactions.iter_mut().for_each(JointReaction::forget);
    }

    /// The state has changed from one after so many revolutions to one after another number of them.
    #[inline]
    pub fn invalidate_revolutions(&mut self, before: f64, now: f64) {
        if before != now {
            self.scratch.panel_force.invalidate();
        }
    }
}
