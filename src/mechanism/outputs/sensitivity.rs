//! Exact derivatives of outputs along a direction in which the state and the inputs change.
//!
//! In: a direction. Out: dy / d s of an output, by dual numbers through the same laws, state loads and tables as the value.
//! The directional derivative of FMI 2.0.5, 2.1.9 is one direction, the rate in time of 4.2.1 another. It must not know any
//! law.
//!
//! Where an output has no derivative, one is chosen: of the size of a reaction that is 0, and of a value at a dead centre
//! that stands for an infinite one, 0; at the border between two regimes of the law of friction that of the inner regime;
//! of a drive with an efficiency that in the present direction. What is held at a stop or by a lock stays held.
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::motion::state::state_loads_under;
use crate::mechanism::outputs::cache::{Direction, OutputCache};
use crate::mechanism::outputs::error::OutputError;
use crate::mechanism::outputs::evaluator::evaluate;
use crate::mechanism::outputs::reduced_motion::ReducedMotion;
use crate::mechanism::outputs::view::View;
use crate::mechanism::quantity::Output;
use crate::mechanism::reduced::Reduced;
use crate::numerics::dual::Dual;

impl ReducedMotion {
    /// Head in a direction in which the state stays and the inputs change by `seeds`.
    pub fn head_for_inputs(&mut self, reduced: &Reduced, inputs: &Inputs, seeds: &dyn Fn(usize) -> f64) {
        let direction = self.direction(reduced, inputs);
        direction.along = [0.0; 2];
        direction.rates.iter_mut().enumerate().for_each(|(i, rate)| *rate = seeds(i));
    }

    /// Head in the direction of time.
    ///
    /// # Errors
    /// The acceleration cannot be found.
    pub fn head_for_time(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<(), OutputError> {
        let along = [self.state.sigma_dot, self.view(reduced, inputs).forces()?.acceleration];
        let direction = self.direction(reduced, inputs);
        direction.along = along;
        direction.rates.copy_from_slice(&inputs.signal.first);
        Ok(())
    }

    /// The direction, to be changed.
    fn direction(&mut self, reduced: &Reduced, inputs: &Inputs) -> &mut Direction<Dual<1>> {
        let sensitivity = self.sensitivity.get_or_insert_with(|| {
            let state_loads = state_loads_under(reduced, inputs).ok().flatten();
            let direction = Direction::new(Dual::variable(0.0, 0), inputs.reals.len());
            Box::new(OutputCache::new(reduced, state_loads, direction))
        });
        sensitivity.invalidate();
        sensitivity.scratch.panel_force.invalidate();
        &mut sensitivity.direction
    }

    /// Derivative of an output in the direction last stated.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn derivative(&mut self, reduced: &Reduced, inputs: &Inputs, output: Output) -> Result<f64, OutputError> {
        let Self { state, loads, cache: values, sensitivity } = self;
        let Some(cache) = sensitivity else { return Ok(0.0) };
        let mut view = View { reduced, inputs, state, loads, cache, values };
        Ok(evaluate(&mut view, reduced.loading(), output)?.slope[0])
    }
}
