//! The reduced model's motion with its outputs: the state, and beside it what outputs of this state share.
//!
//! In: steps, changed inputs, saved states. Out: the state with a cache that belongs to it. It must not know any law.
use super::cache::{Computed, OutputCache};
use crate::mechanism::ModelError;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::motion::SavedState;
use crate::mechanism::motion::state::{State, state_loads_under};
use crate::mechanism::reduced::Reduced;

/// The state of motion along the curve and the cache of its outputs.
#[derive(Clone, Debug)]
pub struct ReducedMotion {
    /// Changed by the methods below only, which keep the cache up to date.
    pub state: State,
    pub(super) cache: OutputCache,
}

impl ReducedMotion {
    /// The state that the definition states.
    ///
    /// # Errors
    /// As [`State::at_start`].
    pub fn at_start(reduced: &Reduced, mechanism: &Mechanism, inputs: &Inputs) -> Result<Self, ModelError> {
        Ok(Self::new(State::at_start(reduced, mechanism, inputs)?, reduced, inputs))
    }

    /// A state that continues from the saved one, under these inputs.
    ///
    /// # Errors
    /// As [`State::from_saved`].
    pub fn from_saved(saved: &SavedState, reduced: &Reduced, inputs: &Inputs) -> Result<Self, ModelError> {
        Ok(Self::new(State::from_saved(saved, reduced, inputs)?, reduced, inputs))
    }

    fn new(state: State, reduced: &Reduced, inputs: &Inputs) -> Self {
        // Tables that can't be built are reported by the state before, or by the outputs that need them.
        let state_loads = state_loads_under(reduced, inputs).ok().flatten();
        let cache = OutputCache::new(reduced, state_loads, &inputs.reals);
        Self { state, cache }
    }

    /// [`State::step`].
    ///
    /// # Errors
    /// As [`State::step`].
    #[inline]
    pub fn step(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64, tolerance: f64) -> Result<(), ModelError> {
        let revolutions = self.state.revolutions;
        self.state.step(reduced, inputs, h, tolerance)?;
        self.cache.invalidate_revolutions(revolutions, self.state.revolutions);
        self.cache.invalidate();
        Ok(())
    }

    /// [`Self::from_saved`] in place, with the same reduced model; `inputs` if they are not the present ones.
    ///
    /// # Errors
    /// As [`State::restore`]; nothing has changed.
    #[inline]
    pub fn restore(&mut self, saved: &SavedState, reduced: &Reduced, inputs: Option<&[f64]>) -> Result<(), ModelError> {
        let revolutions = self.state.revolutions;
        self.state.restore(saved, reduced)?;
        self.cache.invalidate_revolutions(revolutions, self.state.revolutions);
        match inputs {
            Some(inputs) => self.cache.set_inputs(&inputs[..reduced.loading().inputs.len()]),
            None => self.cache.invalidate(),
        }
        Ok(())
    }

    /// Put the mechanism at another place on the curve.
    pub fn move_to(&mut self, sigma: f64, sigma_dot: f64, revolutions: f64) {
        self.cache.invalidate_revolutions(self.state.revolutions, revolutions);
        (self.state.sigma, self.state.sigma_dot, self.state.revolutions) = (sigma, sigma_dot, revolutions);
        self.cache.invalidate();
    }

    /// A Real input has changed. `loads` is the number of inputs that size loads; they come first.
    pub fn set_input(&mut self, input: usize, loads: usize, value: f64) {
        self.cache.set_input(input, loads, value);
    }

    /// A Boolean input has changed.
    pub fn set_lock(&mut self) {
        self.cache.invalidate();
    }

    /// What reading outputs has made be computed since the start.
    pub fn computed(&self) -> Computed {
        self.cache.computed
    }
}
