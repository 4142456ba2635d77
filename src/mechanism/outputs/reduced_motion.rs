//! The reduced model's motion with its outputs: the state, and beside it what outputs of this state share.
//!
//! In: steps, changed inputs, saved states, directions. Out: the state with a cache that belongs to it, outputs and
//! their derivatives. It must not know any law.
mod driven;
mod together;

use crate::hydraulics::network::definition::CAPACITY;
use crate::mechanism::definition::{MOST_STATES, Mechanism, Solver};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::SavedState;
use crate::mechanism::motion::acting::state_loads_under;
use crate::mechanism::motion::fast_forward::Waypoint;
use crate::mechanism::motion::state::{Reached, Start, State};
use crate::mechanism::motion::step_ahead::Outdated;
use crate::mechanism::outputs::cache::{Computed, Direction, OutputCache, PARTS, PresentLoads, of_state};
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError, evaluate};
use crate::mechanism::outputs::view::View;
use crate::mechanism::quantity::Output;
use crate::mechanism::reduced::Reduced;
use crate::numerics::dual::Dual;
use driven::Driven;
use together::value_of;
pub use together::{Outputs, Together};

/// The state of motion along the curve, and what its outputs share.
#[derive(Clone, Debug)]
pub struct ReducedMotion {
    pub state: State,
    /// Versions of the inputs and of the state to which the caches below belong.
    seen: (u64, u64),
    pub(super) loads: PresentLoads,
    /// Cache of the values.
    pub(super) cache: OutputCache<f64>,
    /// Cache of the values with derivatives, once one has been asked for.
    sensitivity: Option<Box<OutputCache<Dual<1>>>>,
    /// What outputs show of a prescribed motion; none where no drive has a motion.
    pub(super) driven: Option<Box<Driven>>,
}

impl ReducedMotion {
    /// The state at a start.
    ///
    /// # Errors
    /// As [`State::from_start`].
    pub fn at_start(
        start: &Start,
        reduced: &Reduced,
        mechanism: &Mechanism,
        inputs: &Inputs,
    ) -> Result<Self, ModelError> {
        let mut motion = Self::new(State::from_start(start, reduced, mechanism, inputs)?, reduced, inputs);
        motion.follow_at_start(reduced, mechanism, inputs)?;
        Ok(motion)
    }

    /// [`Self::at_start`] in place, from a state of the same reduced model; without allocation unless air has begun or
    /// ceased to act. On an error the state is of no use.
    ///
    /// # Errors
    /// As [`State::put_at_start`].
    pub fn put_at_start(
        &mut self,
        start: &Start,
        reduced: &Reduced,
        mechanism: &Mechanism,
        inputs: &Inputs,
    ) -> Result<(), ModelError> {
        self.state.put_at_start(start, reduced, mechanism, inputs)?;
        self.cache.computed = Computed::default();
        self.follow_at_start(reduced, mechanism, inputs)
    }

    /// At the start, forces that follow those of controllers and are not stated are equal to them.
    fn follow_at_start(&mut self, reduced: &Reduced, mechanism: &Mechanism, inputs: &Inputs) -> Result<(), ModelError> {
        if !mechanism.has_forces_by_inputs() {
            return Ok(());
        }
        let is_stated =
            |index| mechanism.control_states().nth(index).is_some_and(|(_, own, _)| own.start_force.is_some());
        self.follow(reduced, inputs, |index| !is_stated(index))
    }

    /// A state that continues from the saved one, under these inputs.
    ///
    /// # Errors
    /// As [`State::from_saved`].
    pub fn from_saved(saved: &SavedState, reduced: &Reduced, inputs: &Inputs) -> Result<Self, ModelError> {
        Ok(Self::new(State::from_saved(saved, reduced, inputs)?, reduced, inputs))
    }

    /// The same motion under another reduced model of the same curve and inputs, as [`State::retuned`].
    ///
    /// # Errors
    /// As [`State::retuned`].
    pub fn retuned(&self, reduced: &Reduced, inputs: &Inputs, reference: f64) -> Result<Self, ModelError> {
        Ok(Self::new(self.state.retuned(reduced, inputs, reference)?, reduced, inputs))
    }

    fn new(state: State, reduced: &Reduced, inputs: &Inputs) -> Self {
        // Tables that can't be built are reported by the state before, or by the outputs that need them.
        let state_loads = state_loads_under(reduced, inputs).ok().flatten();
        let driven = reduced.loading().motion.as_ref().map(|_| Box::new(Driven::new(&state)));
        Self {
            state,
            seen: (0, 0),
            loads: PresentLoads::new(reduced.sizes(&inputs.reals), reduced.linkage().joints.len()),
            cache: OutputCache::new(reduced, state_loads, Direction::new(0.0, 0)),
            sensitivity: None,
            driven,
        }
    }

    /// [`State::step`] from the time `point` [s] of the host on, if it tells one.
    ///
    /// # Errors
    /// As [`State::step`].
    #[inline(always)]
    pub fn step_from(
        &mut self,
        point: Option<f64>,
        reduced: &Reduced,
        inputs: &Inputs,
        h: f64,
        solver: &Solver,
    ) -> Result<Reached, ModelError> {
        let stepped = self.state.step(reduced, inputs, (h, solver), &self.cache.scratch);
        match &stepped {
            Ok(reached) => self.state.pass(point, reached.time(h)),
            Err(ModelError::Interrupted { time, .. }) => self.state.pass(point, *time),
            Err(_) => {}
        }
        stepped
    }

    /// [`Self::from_saved`] in place, with the same reduced model.
    ///
    /// # Errors
    /// As [`State::restore`]; nothing has changed.
    #[inline]
    pub fn restore(&mut self, saved: &SavedState, reduced: &Reduced) -> Result<(), ModelError> {
        self.state.restore(saved, reduced)
    }

    /// From the start to a state on the way, in the host's time from `point` [s] on.
    ///
    /// # Errors
    /// As [`State::go_to`].
    pub fn go_to(&mut self, point: f64, reduced: &Reduced, waypoint: &Waypoint) -> Result<(), ModelError> {
        self.state.go_to(reduced, waypoint)?;
        self.state.pass(Some(point), waypoint.time);
        Ok(())
    }

    /// Put the mechanism at another place on the curve.
    pub fn move_to(&mut self, sigma: f64, sigma_dot: f64, revolutions: f64) {
        let before = self.state.revolutions;
        (self.state.sigma, self.state.sigma_dot, self.state.revolutions) = (sigma, sigma_dot, revolutions);
        if revolutions != before {
            self.state.memory.drop_outdated(Outdated::Count);
        }
    }

    /// The caches become those of the present state and inputs.
    #[inline(always)]
    pub(super) fn sync(&mut self, reduced: &Reduced, inputs: &Inputs) {
        let present = (inputs.version(), self.state.version());
        if self.seen == present {
            return;
        }
        if self.seen.0 != present.0 {
            self.loads.set_first(&inputs.reals[..reduced.loading().inputs.len()]);
        }
        self.seen = present;
        self.cache.invalidate();
        if self.driven.is_some() {
            self.settle(reduced, inputs);
        }
    }

    /// What `read` finds in the present state under these inputs.
    pub fn read<R>(&mut self, reduced: &Reduced, inputs: &Inputs, read: impl FnOnce(&mut View<f64>) -> R) -> R {
        read(&mut self.view(reduced, inputs))
    }

    /// Value of an output under these inputs.
    ///
    /// # Errors
    /// [`OutputError`].
    #[inline]
    pub fn output(&mut self, reduced: &Reduced, inputs: &Inputs, output: Output) -> Result<f64, OutputError> {
        let mut view = self.view(reduced, inputs);
        if view.loads.undriven.is_some() {
            view.check_placed()?;
        }
        value_of(&mut view, reduced.loading(), &output)
    }

    /// The outputs of this state under these inputs, to be read one after the other.
    #[inline]
    pub fn outputs<'a>(&'a mut self, reduced: &'a Reduced, inputs: &'a Inputs) -> Outputs<'a> {
        let view = self.view(reduced, inputs);
        view.cache.panel = view.reduced.influence().panel_near(view.state.sigma, view.cache.panel);
        Outputs::new(view, reduced.loading())
    }

    /// Allocate what steps, these outputs and their derivatives would otherwise allocate when they are first computed.
    pub fn prepare(&mut self, reduced: &Reduced, inputs: &Inputs, outputs: impl Iterator<Item = Output>) {
        /// Positions on a panel on which a joint has no table.
        const SAMPLES: i32 = 64;
        self.state.prepare(reduced);
        let (here, air) = (reduced.at(self.state.sigma), self.cache.scratch.air);
        if let Ok(state_loads) = here.state_loads(air) {
            self.cache.scratch.panel_force.prepare(here, state_loads);
            // Loads that the state sizes need not act at the start.
            let rows = PARTS * state_loads.map_or(0, |state_loads| state_loads.loads.len());
            self.loads.reactions.iter_mut().for_each(|group| group.state.rows.reserve(rows));
        }
        // At many positions, as the memory that the exact evaluator needs depends on the order of its equations there.
        let sample = |k: i32, [first, last]: [f64; 2]| first + (last - first) * f64::from(k) / f64::from(SAMPLES);
        for panel in here.untabled() {
            for k in 0..=SAMPLES {
                here.exact_reactions(sample(k, panel), &mut self.cache.exact);
            }
        }
        self.head_for(reduced, inputs, of_state(0, 1.0), &|_| 1.0);
        for output in outputs {
            _ = self.output(reduced, inputs, output);
            _ = self.derivative(reduced, inputs, output);
        }
        self.cache.computed = Computed::default();
    }

    /// Stiffness and damping of small motions, as [`Kinematics::small_motion`].
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn small_motion(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<[f64; 2], OutputError> {
        self.view(reduced, inputs).small_motion()
    }

    #[inline]
    pub(super) fn view<'a>(&'a mut self, reduced: &'a Reduced, inputs: &'a Inputs) -> View<'a, f64> {
        self.sync(reduced, inputs);
        self.plain_view(reduced, inputs)
    }

    /// [`Self::view`] without a look at the versions.
    #[inline]
    pub(super) fn plain_view<'a>(&'a mut self, reduced: &'a Reduced, inputs: &'a Inputs) -> View<'a, f64> {
        let Self { state, loads, cache, driven, .. } = self;
        let state = driven.as_deref().and_then(Driven::shown).unwrap_or(state);
        View { reduced: reduced.at(state.sigma), inputs, state, loads, cache, values: () }
    }

    /// Whether friction locks the mechanism against a drive in this state under these inputs.
    pub fn self_locking(&mut self, reduced: &Reduced, inputs: &Inputs, drive: usize) -> bool {
        self.view(reduced, inputs).self_locking(drive)
    }

    /// Whether friction holds the mechanism at rest in this state under these inputs.
    pub fn sticking(&mut self, reduced: &Reduced, inputs: &Inputs) -> bool {
        self.view(reduced, inputs).sticking()
    }

    /// What reading outputs has made be computed since the start.
    pub fn computed(&self) -> Computed {
        self.cache.computed
    }
}

/// Exact derivatives dy / d s of outputs along a direction s in which the state and the inputs change, by dual numbers
/// through the same laws, state loads and tables as the values. The directional derivative of FMI 2.0.5, 2.1.9 is one
/// direction, the rate in time of 4.2.1 another.
///
/// Where an output has no derivative, one is chosen: of the size of a reaction that is 0, and of a value at a dead
/// centre that stands for an infinite one, 0; at the border between two regimes of the law of friction that of the
/// inner regime; of a drive with an efficiency that in the present direction. What is held at a stop or by a lock stays
/// held.
impl ReducedMotion {
    /// Head in a direction in which sigma, sigma_dot and the states of controllers change by `along` and the inputs by
    /// `seeds`.
    #[inline]
    pub fn head_for(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        along: [f64; MOST_STATES],
        seeds: &dyn Fn(usize) -> f64,
    ) {
        let direction = self.direction(reduced, inputs);
        (direction.along, direction.circuit, direction.surface) = ([along[0], along[1]], [0.0; CAPACITY], 0.0);
        direction.circuit[..MOST_STATES - 2].copy_from_slice(&along[2..]);
        direction.rates.iter_mut().enumerate().for_each(|(i, rate)| *rate = seeds(i));
        if self.driven.is_some() {
            self.drive_along(reduced, inputs, false);
        }
    }

    /// Head in the direction of time. Where the acceleration has no value, only derivatives without it have one.
    pub fn head_for_time(&mut self, reduced: &Reduced, inputs: &Inputs) {
        let acceleration = self.view(reduced, inputs).forces().map_or(f64::NAN, |forces| forces.acceleration);
        let along = [self.state.sigma_dot, acceleration];
        let circuit = self.view(reduced, inputs).circuit_rates().unwrap_or([f64::NAN; CAPACITY]);
        let direction = self.direction(reduced, inputs);
        (direction.along, direction.circuit) = (along, circuit);
        direction.rates.copy_from_slice(&inputs.signal.first);
        direction.surface = reduced.loading().surface_that_holds().map_or(0.0, |own| inputs.signal.second[own]);
        if self.driven.is_some() {
            self.drive_along(reduced, inputs, true);
        }
    }

    /// The direction, to be changed.
    pub(super) fn direction(&mut self, reduced: &Reduced, inputs: &Inputs) -> &mut Direction<Dual<1>> {
        self.sync(reduced, inputs);
        let sensitivity = self.sensitivity.get_or_insert_with(|| {
            let state_loads = state_loads_under(reduced, inputs).ok().flatten();
            let direction = Direction::new(Dual::variable(0.0, 0), inputs.reals.len());
            Box::new(OutputCache::new(reduced, state_loads, direction))
        });
        sensitivity.invalidate();
        &mut sensitivity.direction
    }

    /// Derivative of an output in the direction last stated.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn derivative(&mut self, reduced: &Reduced, inputs: &Inputs, output: Output) -> Result<f64, OutputError> {
        let Some(mut view) = self.sensitive_view(reduced, inputs) else { return Ok(0.0) };
        if view.loads.undriven.is_some() {
            view.check_placed()?;
        }
        let derivative = evaluate(&mut view, reduced.loading(), &output)?.slope[0];
        if derivative.is_nan() {
            // Of the acceleration, along which the direction leads.
            view.forces()?;
        }
        Ok(derivative)
    }

    /// Derivatives of sigma_dot and sigma_ddot in the direction last stated; 0 where the mechanism is held.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn derivatives_of_motion(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<[f64; 2], OutputError> {
        let Some(mut view) = self.sensitive_view(reduced, inputs) else { return Ok([0.0; 2]) };
        let forces = *view.forces()?;
        let speed = if forces.held.is_some() { 0.0 } else { view.sigma_dot().slope[0] };
        Ok([speed, forces.acceleration.slope[0]])
    }

    /// Derivative of sigma_ddot in the direction last stated, as if nothing held the mechanism.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn slope_of_small_motion(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<f64, OutputError> {
        let direction = self.view(reduced, inputs).forces()?.direction;
        let Some(mut view) = self.sensitive_view(reduced, inputs) else { return Ok(0.0) };
        let (sigma, sigma_dot) = (view.sigma(), view.sigma_dot());
        Ok(view.equation()?.heading(direction, sigma, sigma_dot)?.slope[0])
    }

    #[inline]
    pub(super) fn sensitive_view<'a>(
        &'a mut self,
        reduced: &'a Reduced,
        inputs: &'a Inputs,
    ) -> Option<View<'a, Dual<1>>> {
        let Self { state, loads, cache: values, sensitivity, driven, .. } = self;
        let state = driven.as_deref().and_then(Driven::shown).unwrap_or(state);
        let cache = sensitivity.as_deref_mut()?;
        Some(View { reduced: reduced.at(state.sigma), inputs, state, loads, cache, values })
    }
}
