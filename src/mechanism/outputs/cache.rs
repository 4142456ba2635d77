//! What several outputs of one state share, computed when an output first needs it.
use crate::mechanism::dynamics::equation::Scratch;
use crate::mechanism::dynamics::inputs::Change;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::dual::Number;
use crate::numerics::table::TablePosition;

/// Intermediate results of outputs in the present state under the present inputs, in numbers N.
#[derive(Clone, Debug)]
pub struct OutputCache<N> {
    /// Direction of the derivatives that N carries.
    pub direction: Direction<N>,
    /// Forces and acceleration, once evaluated in this state.
    pub forces: Option<Forces<N>>,
    /// Position in the table of the coordinates, once found in this state.
    pub position: Option<TablePosition>,
    /// Panel of the table of the coordinates in which sigma was last.
    pub panel: usize,
    /// Reaction of each joint, once evaluated in this state.
    pub reactions: Vec<Option<[N; 3]>>,
    /// Whether a reaction has been evaluated in this state.
    pub has_reactions: bool,
    /// Evaluations since the start.
    pub computed: Computed,
    /// Scratch of the equation of motion.
    pub scratch: Scratch<N>,
}

/// Accelerations of a state under the present inputs, and what was decided to find them.
#[derive(Clone, Copy, Debug)]
pub struct Forces<N> {
    /// sigma_ddot of the motion.
    pub acceleration: N,
    /// sigma_ddot if nothing held the mechanism at an end of its travel.
    pub free: N,
    /// Direction in which the drives with an efficiency work; 0 if they hold the mechanism.
    pub direction: f64,
    /// End at which the mechanism is held.
    pub held: Option<usize>,
    /// Whether the stop at this end holds the mechanism; else a lock.
    pub by_stop: bool,
}

/// How often outputs have made something be computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Computed {
    /// Evaluations of the acceleration with friction, drag and the forces of stops.
    pub effects: u64,
    /// Reactions of a joint.
    pub reactions: u64,
}

impl<N: Number> OutputCache<N> {
    pub fn new(reduced: &Reduced, state_loads: Option<&StateLoads>, direction: Direction<N>) -> Self {
        Self {
            direction,
            forces: None,
            position: None,
            panel: 0,
            reactions: vec![None; reduced.linkage().joints.len()],
            has_reactions: false,
            computed: Computed::default(),
            scratch: Scratch::new(state_loads),
        }
    }

    /// The state, an input or the direction has changed.
    #[inline]
    pub fn invalidate(&mut self) {
        (self.forces, self.position) = (None, None);
        if self.has_reactions {
            self.reactions.fill(None);
            self.has_reactions = false;
        }
    }
}

/// A direction: state and inputs as functions of one parameter s, at s = 0.
#[derive(Clone, Debug)]
pub struct Direction<N> {
    /// s itself, with the derivative 1 if N carries derivatives.
    pub s: N,
    /// d sigma / d s and d sigma_dot / d s.
    pub along: [f64; 2],
    /// du / d s of the Real inputs; none where nothing changes.
    pub rates: Vec<f64>,
    /// As many zeros: the second derivatives of the inputs along s.
    zeros: Vec<f64>,
}

impl<N: Number> Direction<N> {
    /// A direction along s in which nothing changes yet.
    pub fn new(s: N, inputs: usize) -> Self {
        Self { s, along: [0.0; 2], rates: vec![0.0; inputs], zeros: vec![0.0; inputs] }
    }

    /// A Real input, from its value.
    #[inline]
    pub fn input(&self, input: usize, value: f64) -> N {
        self.s.chain(value, self.rates.get(input).copied().unwrap_or(0.0))
    }

    /// Change of the inputs that size loads and of the airspeed; the airspeed is the last input.
    pub fn change(&self, loading: &Loading) -> Option<Change<'_>> {
        let loads = loading.inputs.len();
        let air = self.rates.last().filter(|_| loading.air.is_some()).copied().unwrap_or(0.0);
        N::CARRIES.then(|| Change { first: &self.rates[..loads], second: &self.zeros[..loads], airspeed: [air, 0.0] })
    }
}
