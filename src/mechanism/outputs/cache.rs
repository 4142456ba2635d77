//! What several outputs of one state share, computed when an output first needs it.
use crate::hydraulics::network::definition::CAPACITY;
use crate::hydraulics::network::outputs::Present;
use crate::mechanism::definition::MOST_STATES;
use crate::mechanism::dynamics::equation::Scratch;

use crate::mechanism::dynamics::inputs::Change;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::motion::contact::Place;
use crate::mechanism::outputs::evaluator::OutputError;
use crate::mechanism::reduced::{ExactReactions, PanelTable, Reduced, StateLoads};
use crate::numerics::bundle::{ROW, Row};
use crate::numerics::dual::{Differentiable, Number};

/// Intermediate results of outputs in the present state under the present inputs, in numbers N.
#[derive(Clone, Debug)]
pub struct OutputCache<N: Differentiable> {
    /// Direction of the derivatives that N carries.
    pub direction: Direction<N>,
    /// Forces and acceleration, if they are known in this state.
    pub forces: Forces<N>,
    pub knows_forces: bool,
    /// Number of the state and the inputs: each change of them has another one.
    pub version: u64,
    /// The functions of sigma whose tables have their first two derivatives, with these derivatives: coordinates, then
    /// x and y of each marker.
    pub functions: Vec<Found<[N; 3]>>,
    /// Panel in which sigma was last, in the table of the influences.
    pub panel: usize,
    /// What terms of the drive asked for last share, once evaluated in this state.
    pub drive: Option<DriveTerms<N>>,
    /// The drive asked for last at the rigid stop at each end of the travel.
    pub ends: [Option<DriveEnd>; 2],
    /// Displacement of each load.
    pub displacements: Vec<Found<f64>>,
    /// Reaction of each joint, with the version for which it was evaluated.
    pub reactions: Vec<(u64, [N; 3])>,
    /// Force that each mesh of teeth transmits along the motion, with the version for which it was evaluated.
    pub transmitted: Vec<(u64, N)>,
    /// What the reactions of the joints of each group are without what holds the mechanism.
    pub groups: Vec<GroupValues<N>>,
    /// What reactions are sums of, once one has been evaluated in this state.
    pub shares: Shares<N>,
    /// Reactions that have no table.
    pub exact: ExactReactions,
    /// Flows of the network, with room for them where there is one, and the version for which they were evaluated.
    pub network: Option<(Box<Present<N>>, u64)>,
    /// Evaluations since the start.
    pub computed: Computed,
    /// Scratch of the equation of motion.
    pub scratch: Scratch<N>,
}

/// What a table has at sigma.
#[derive(Clone, Copy, Debug)]
pub struct Found<T> {
    /// [`OutputCache::version`] of the state in which the values were found; 0 where none were.
    pub version: u64,
    /// Panel in which sigma was last.
    pub panel: usize,
    pub values: T,
}

impl<T> Found<T> {
    /// Not found yet.
    fn blank(values: T) -> Self {
        Self { version: 0, panel: 0, values }
    }
}

/// What terms of one drive share, with S its displacement.
#[derive(Clone, Copy, Debug)]
pub struct DriveTerms<N> {
    /// The drive.
    pub drive: usize,
    /// S_sigma and S_sigma_sigma, from the table of the displacement.
    pub slopes: [N; 2],
    /// S_sigma, from the table of the influences, once it has been needed.
    pub influence: Option<N>,
}

/// A drive at a rigid stop at an end of the travel, whatever the state.
#[derive(Clone, Copy, Debug)]
pub struct DriveEnd {
    /// The drive.
    pub drive: usize,
    /// sigma of the stop, on this stretch of the curve.
    pub position: f64,
    pub stretch: i32,
    /// Displacement S of the drive and S_sigma.
    pub values: [f64; 2],
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
    /// Regime of the friction on a driven surface at a slip speed of 0.
    pub surface: Option<Regime>,
    /// Whether the rigid stop there holds the mechanism; else a lock.
    pub by_stop: bool,
}

impl<N: Number> Forces<N> {
    /// Not known yet.
    fn unknown() -> Self {
        let zero = N::constant(0.0);
        Self { acceleration: zero, free: zero, direction: 0.0, held: None, surface: None, by_stop: false }
    }
}

/// How often outputs have made something be computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Computed {
    /// Evaluations of the acceleration with friction, drag and the forces of stops.
    pub effects: u64,
    /// Sums of the reactions of a group of joints.
    pub reactions: u64,
}

impl<N: Differentiable> OutputCache<N> {
    pub fn new(reduced: &Reduced, state_loads: Option<&StateLoads>, direction: Direction<N>) -> Self {
        Self {
            direction,
            forces: Forces::unknown(),
            knows_forces: false,
            version: 1,
            functions: vec![Found::blank([N::constant(0.0); 3]); reduced.functions()],
            panel: 0,
            drive: None,
            ends: [None; 2],
            displacements: vec![Found::blank(0.0); reduced.loading().loads.len()],
            reactions: vec![(0, [N::constant(0.0); PARTS]); reduced.linkage().joints.len()],
            groups: vec![GroupValues::unknown(); reduced.linkage().joints.len().div_ceil(ROW)],
            transmitted: vec![(0, N::constant(0.0)); reduced.loading().meshes.len()],
            shares: Shares { given: Vec::new(), state: Vec::new(), acts: false, version: 0 },
            exact: ExactReactions::default(),
            network: reduced.loading().network.as_ref().map(|_| (Box::new(Present::nothing()), 0)),
            computed: Computed::default(),
            scratch: Scratch::new(state_loads),
        }
    }

    /// The state, an input or the direction has changed.
    #[inline]
    pub fn invalidate(&mut self) {
        (self.knows_forces, self.drive) = (false, None);
        self.version += 1;
    }
}

/// Sizes of what causes reactions: a joint's reaction is the sum of these times its reactions to each of size 1.
#[derive(Clone, Debug)]
pub struct Shares<N> {
    /// sigma_ddot, sigma_dot^2, delivered forces that the state decides, forces of springs, then the applied loads that
    /// act, or 1 for the sum of many.
    pub given: Vec<N>,
    /// Loads that the state sizes.
    pub state: Vec<N>,
    /// Whether one of these is or becomes other than 0.
    pub acts: bool,
    /// The version for which they were evaluated.
    pub version: u64,
}

/// A direction: state and inputs as functions of one parameter s, at s = 0.
#[derive(Clone, Debug)]
pub struct Direction<N> {
    /// s itself, with the derivative 1 if N carries derivatives.
    pub s: N,
    /// d sigma / d s and d sigma_dot / d s.
    pub along: [f64; 2],
    /// Derivatives along s of the components of a circuit or network.
    pub circuit: [f64; CAPACITY],
    /// Derivative along s of the acceleration of a driven surface [m/s2].
    pub surface: f64,
    /// du / d s of the Real inputs; none where nothing changes.
    pub rates: Vec<f64>,
    /// As many zeros: the second derivatives of the inputs along s.
    zeros: Vec<f64>,
}

impl<N: Number> Direction<N> {
    /// A direction along s in which nothing changes yet.
    pub fn new(s: N, inputs: usize) -> Self {
        let (rates, zeros) = (vec![0.0; inputs], vec![0.0; inputs]);
        Self { s, along: [0.0; 2], circuit: [0.0; CAPACITY], surface: 0.0, rates, zeros }
    }

    /// A Real input, from its value.
    #[inline]
    pub fn input(&self, input: usize, value: f64) -> N {
        self.s.chain(value, self.rates.get(input).copied().unwrap_or(0.0))
    }

    /// Change of the inputs that size loads and of the airspeed; the airspeed is the last input.
    #[inline]
    pub fn change(&self, loading: &Loading) -> Option<Change<'_>> {
        let loads = loading.inputs.len();
        let air = self.rates.last().filter(|_| loading.air.is_some()).copied().unwrap_or(0.0);
        N::CARRIES.then(|| Change { first: &self.rates[..loads], second: &self.zeros[..loads], airspeed: [air, 0.0] })
    }
}

/// The direction in which one state changes: sigma (0), sigma_dot (1) or a state of a controller.
pub fn of_state(state: usize, change: f64) -> [f64; MOST_STATES] {
    let mut along = [0.0; MOST_STATES];
    along[state] = change;
    along
}

/// Parts of a reaction: force x, force y, moment.
pub const PARTS: usize = 3;
/// Most applied loads that have a term each. The sum of more is one term, which is new when one of them changes.
pub const MOST_TERMS: usize = 8;

/// Borders of a panel that holds no sigma.
const NOWHERE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// The sized loads under the present inputs.
#[derive(Clone, Debug)]
pub struct PresentLoads {
    /// Sizes of the loads.
    pub sizes: Vec<f64>,
    /// The loads that act under these sizes and whose delivered force the state does not decide.
    pub acting: Vec<usize>,
    /// Whether these are known.
    pub knows_acting: bool,
    /// Reactions of the joints, group by group, to the loads of these sizes and to all else.
    pub reactions: Vec<GroupReactions>,
    /// Why no force of its drive makes the prescribed motion; none if there is one, or no motion is prescribed.
    pub undriven: Option<OutputError>,
}

impl PresentLoads {
    pub fn new(sizes: Vec<f64>, joints: usize) -> Self {
        let (acting, reactions) =
            (Vec::with_capacity(sizes.len()), vec![GroupReactions::default(); joints.div_ceil(ROW)]);
        Self { sizes, acting, knows_acting: false, reactions, undriven: None }
    }

    /// Whether there is a force of its drive for a prescribed motion.
    ///
    /// # Errors
    /// There is none, with the reason.
    #[inline(always)]
    pub fn check_driven(&self) -> Result<(), OutputError> {
        self.undriven.as_ref().map_or(Ok(()), |error| Err(error.clone()))
    }

    /// The first loads have these sizes.
    #[inline]
    pub fn set_first(&mut self, sizes: &[f64]) {
        let mut others_act = false;
        for (own, size) in self.sizes.iter_mut().zip(sizes) {
            others_act |= (*own != 0.0) != (*size != 0.0);
            *own = *size;
        }
        self.have_changed(others_act);
    }

    /// A load has this size; returns whether it had another one.
    pub fn set(&mut self, load: usize, size: f64) -> bool {
        let before = std::mem::replace(&mut self.sizes[load], size);
        let is_other = before.to_bits() != size.to_bits();
        if is_other {
            self.have_changed((before != 0.0) != (size != 0.0));
        }
        is_other
    }

    /// Sizes have changed. Terms of the reactions are others only if a load starts or ceases to act, or if they include
    /// the sum of many loads.
    #[inline]
    fn have_changed(&mut self, others_act: bool) {
        if others_act || self.acting.len() > MOST_TERMS {
            self.knows_acting = false;
            self.reactions.iter_mut().for_each(|reaction| reaction.has_applied = false);
        }
    }
}

/// Polynomials of the reactions of up to [`ROW`] joints on the panels where sigma was last: joints 0 to [`ROW`] - 1 are
/// a group, and so on.
#[derive(Clone, Debug, Default)]
pub struct GroupReactions {
    /// Number of parts - force x, force y, moment - of the joint with the most.
    pub parts: usize,
    /// The reactions to what [`Shares::given`] multiplies.
    pub given: GroupRows,
    /// Whether the terms of the applied loads are those of the present sizes.
    pub has_applied: bool,
    /// The applied loads that have terms; none where so many act that their sum is one term.
    pub kept: Vec<usize>,
    /// The reactions to the loads that the state sizes, which [`Shares::state`] multiplies.
    pub state: GroupRows,
    /// Whether the loads that the state sizes include those of moving air.
    pub air: bool,
}

/// Parts of the reactions of a group of joints, without those to what holds the mechanism.
#[derive(Clone, Copy, Debug)]
pub struct GroupValues<N> {
    /// The version for which they were evaluated.
    pub version: u64,
    /// Sums over [`GroupReactions::given`], part by part, joint by joint.
    pub given: [[N; ROW]; PARTS],
    /// Sums over [`GroupReactions::state`]; 0 where none of these loads acts.
    pub state: [[N; ROW]; PARTS],
}

impl<N: Number> GroupValues<N> {
    /// Not known yet.
    fn unknown() -> Self {
        let zero = [[N::constant(0.0); ROW]; PARTS];
        Self { version: 0, given: zero, state: zero }
    }
}

/// Polynomials of a group of joints: term by term and part by part a row, with a function for each joint. Each joint
/// has a table of its own, whose panels differ from those of the others where one needs shorter ones.
#[derive(Clone, Debug)]
pub struct GroupRows {
    /// First sigma for which the polynomials of all joints hold, and the first for which one no longer does.
    low: f64,
    high: f64,
    center: [f64; ROW],
    /// 2 / width of the panel of each joint.
    inverse: [f64; ROW],
    /// Panel of each joint's table.
    pub panels: [usize; ROW],
    /// Whether each joint has a table here.
    pub is_resolved: [bool; ROW],
    /// The polynomials.
    pub rows: Vec<Row>,
}

impl Default for GroupRows {
    /// Holds nowhere.
    fn default() -> Self {
        let (low, high) = NOWHERE;
        let (center, inverse, panels, is_resolved) = ([0.0; ROW], [0.0; ROW], [0; ROW], [false; ROW]);
        Self { low, high, center, inverse, panels, is_resolved, rows: Vec::new() }
    }
}

impl GroupRows {
    /// Whether the polynomials hold at sigma.
    #[inline]
    pub fn holds(&self, sigma: f64) -> bool {
        self.low <= sigma && sigma < self.high
    }

    /// x at sigma on the panel of each joint.
    #[inline]
    pub fn x<N: Number>(&self, sigma: N) -> [N; ROW] {
        let x = |joint: usize| (sigma.value() - self.center[joint]) * self.inverse[joint];
        std::array::from_fn(|joint| sigma.chain(x(joint), self.inverse[joint]))
    }

    /// Enter the panels at sigma of the joints' tables, without polynomials. Where a joint has no table the others hold
    /// at sigma alone, so that it is asked for again elsewhere.
    pub fn enter(&mut self, tables: &[Option<PanelTable>], sigma: f64) {
        (self.low, self.high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (joint, piece) in tables.iter().enumerate() {
            self.is_resolved[joint] = piece.is_some();
            let Some(PanelTable { table, continues }) = piece else {
                (self.low, self.high, self.inverse[joint]) = (sigma, sigma.next_up(), 0.0);
                continue;
            };
            let panel = table.panel_near(sigma, self.panels[joint]);
            let (a, b) = table.borders(panel);
            (self.panels[joint], self.center[joint], self.inverse[joint]) = (panel, 0.5 * (a + b), 2.0 / (b - a));
            if !(panel == 0 && continues[0]) {
                self.low = self.low.max(a);
            }
            if !(panel + 1 == table.panels() && continues[1]) {
                self.high = self.high.min(b);
            }
        }
    }
}
