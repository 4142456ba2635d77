//! What several outputs of one state share, computed when an output first needs it.
use crate::hydraulics::circuit::CIRCUIT;
use crate::mechanism::dynamics::equation::Scratch;

use crate::mechanism::dynamics::inputs::Change;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::motion::contact::Place;
use crate::mechanism::outputs::evaluator::OutputError;
use crate::mechanism::reduced::{PanelTable, Reduced, StateLoads};
use crate::numerics::bundle::{ROW, Row};
use crate::numerics::dual::{Differentiable, Number};
use crate::numerics::table::TablePosition;

/// Intermediate results of outputs in the present state under the present inputs, in numbers N.
#[derive(Clone, Debug)]
pub struct OutputCache<N: Differentiable> {
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
    /// Force that each mesh of teeth transmits along the motion, once evaluated in this state.
    pub transmitted: Vec<Option<N>>,
    /// Whether a reaction has been evaluated in this state.
    pub has_reactions: bool,
    /// What reactions are sums of, once one has been evaluated in this state.
    pub shares: Shares<N>,
    /// Values of the polynomials of a reaction.
    pub values: Vec<[N; ROW]>,
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
    /// Place at which the mechanism is held.
    pub held: Option<Place>,
    /// Whether the rigid stop there holds the mechanism; else a lock.
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

impl<N: Differentiable> OutputCache<N> {
    pub fn new(reduced: &Reduced, state_loads: Option<&StateLoads>, direction: Direction<N>) -> Self {
        Self {
            direction,
            forces: None,
            position: None,
            panel: 0,
            reactions: vec![None; reduced.linkage().joints.len()],
            transmitted: vec![None; reduced.loading().meshes.len()],
            has_reactions: false,
            shares: Shares { given: Vec::new(), state: Vec::new(), are_known: false },
            values: Vec::new(),
            computed: Computed::default(),
            scratch: Scratch::new(state_loads),
        }
    }

    /// The state is at the start.
    pub fn begin(&mut self) {
        self.computed = Computed::default();
        self.scratch.panel_force.invalidate();
        self.invalidate();
    }

    /// The state, an input or the direction has changed.
    #[inline]
    pub fn invalidate(&mut self) {
        (self.forces, self.position) = (None, None);
        if self.has_reactions {
            self.reactions.fill(None);
            self.transmitted.fill(None);
            self.has_reactions = false;
        }
        self.shares.are_known = false;
    }
}

/// Sizes of what causes reactions besides the applied loads as they are: a joint's reaction is the sum of these times
/// its reactions to each of size 1.
#[derive(Clone, Debug)]
pub struct Shares<N> {
    /// sigma_ddot, sigma_dot^2, delivered forces that the state decides, forces of springs.
    pub given: Vec<N>,
    /// Loads that the state sizes.
    pub state: Vec<N>,
    /// Whether they are those of this state.
    pub are_known: bool,
}

/// A direction: state and inputs as functions of one parameter s, at s = 0.
#[derive(Clone, Debug)]
pub struct Direction<N> {
    /// s itself, with the derivative 1 if N carries derivatives.
    pub s: N,
    /// d sigma / d s and d sigma_dot / d s.
    pub along: [f64; 2],
    /// Derivatives along s of the pressures, of position and speed of the spool, and of the energies of a circuit.
    pub circuit: [f64; CIRCUIT],
    /// du / d s of the Real inputs; none where nothing changes.
    pub rates: Vec<f64>,
    /// As many zeros: the second derivatives of the inputs along s.
    zeros: Vec<f64>,
}

impl<N: Number> Direction<N> {
    /// A direction along s in which nothing changes yet.
    pub fn new(s: N, inputs: usize) -> Self {
        Self { s, along: [0.0; 2], circuit: [0.0; CIRCUIT], rates: vec![0.0; inputs], zeros: vec![0.0; inputs] }
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

/// Borders of a panel that holds no sigma.
const NOWHERE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// The sized loads under the present inputs.
#[derive(Clone, Debug)]
pub struct PresentLoads {
    /// Sizes of the loads.
    pub sizes: Vec<f64>,
    /// Reaction of each joint to the loads of these sizes and to all else.
    pub reactions: Vec<PanelReaction>,
    /// Why no force of its drive makes the prescribed motion; none if there is one, or no motion is prescribed.
    pub undriven: Option<OutputError>,
}

impl PresentLoads {
    pub fn new(sizes: Vec<f64>, joints: usize) -> Self {
        Self { sizes, reactions: vec![PanelReaction::default(); joints], undriven: None }
    }

    /// Whether there is a force of its drive for a prescribed motion.
    ///
    /// # Errors
    /// There is none, with the reason.
    #[inline(always)]
    pub fn check_driven(&self) -> Result<(), OutputError> {
        self.undriven.as_ref().map_or(Ok(()), |error| Err(error.clone()))
    }

    /// The sizes have changed: the reactions to the applied loads are no longer known.
    pub fn invalidate(&mut self) {
        self.reactions.iter_mut().for_each(|reaction| reaction.has_applied = false);
    }
}

/// Polynomials of a joint's reaction on the panels where sigma was last.
#[derive(Clone, Debug, Default)]
pub struct PanelReaction {
    /// For each part - force x, force y, moment - the reaction to all applied loads as they are, then to what
    /// [`Shares::given`] multiplies.
    pub given: PanelRows,
    /// Whether the first polynomial of each part is that of the present sizes.
    pub has_applied: bool,
    /// For each part the reaction to the loads that the state sizes, which [`Shares::state`] multiplies.
    pub state: PanelRows,
    /// Whether the loads that the state sizes include those of moving air.
    pub air: bool,
}

/// Polynomials side by side on one panel of a table.
#[derive(Clone, Debug)]
pub struct PanelRows {
    /// First sigma for which the polynomials hold, and the first for which they no longer do.
    low: f64,
    high: f64,
    center: f64,
    /// 2 / width of the panel.
    inverse: f64,
    /// Panel of the table.
    pub panel: usize,
    /// The polynomials.
    pub rows: Vec<Row>,
}

impl Default for PanelRows {
    /// Holds nowhere.
    fn default() -> Self {
        let (low, high) = NOWHERE;
        Self { low, high, center: 0.0, inverse: 0.0, panel: 0, rows: Vec::new() }
    }
}

impl PanelRows {
    /// Whether the polynomials hold at sigma.
    #[inline]
    pub fn holds(&self, sigma: f64) -> bool {
        self.low <= sigma && sigma < self.high
    }

    /// x on the panel at sigma.
    #[inline]
    pub fn x<N: Number>(&self, sigma: N) -> N {
        sigma.chain((sigma.value() - self.center) * self.inverse, self.inverse)
    }

    /// Enter the panel at sigma; `fill` appends the polynomials of a panel.
    #[cold]
    pub fn enter(&mut self, piece: PanelTable, sigma: f64, fill: impl FnOnce(usize, &mut Vec<Row>)) {
        let PanelTable { table, continues } = piece;
        self.panel = table.panel_near(sigma, self.panel);
        let (a, b) = table.borders(self.panel);
        (self.low, self.high, self.center, self.inverse) = (a, b, 0.5 * (a + b), 2.0 / (b - a));
        if self.panel == 0 && continues[0] {
            self.low = f64::NEG_INFINITY;
        }
        if self.panel + 1 == table.panels() && continues[1] {
            self.high = f64::INFINITY;
        }
        self.rows.clear();
        fill(self.panel, &mut self.rows);
    }
}
