//! The motion from the start as a function of inputs: times at a stop, states on the way.
//!
//! In: the flag of a stop, inputs that size loads. Out: functions, where the energy integral gives them. It must not
//! know the integral.
use super::{Formulation, Model, ModelError};
use crate::mechanism::motion::acting::state_loads_under;
use crate::mechanism::motion::fast_forward::{FastForward, Waypoint};
use crate::mechanism::motion::state::State;
use crate::mechanism::motion::travel_time::TravelTime;
use crate::mechanism::quantity::Quantity;
use crate::mechanism::reduced::Reduced;
use crate::variables::Reference;

/// A start at rest from which the energy integral gives the motion.
struct FreeStart<'a> {
    reduced: &'a Reduced,
    state: &'a State,
    /// Length of the whole revolutions before sigma = 0.
    shift: f64,
    /// Sizes of all components of the influences.
    sizes: Vec<f64>,
    /// Those that the inputs size.
    varied: Vec<usize>,
}

impl Model {
    /// The start, if the energy integral gives the motion from there under constant values of these inputs.
    fn free_start(&self, inputs: &[Reference]) -> Option<FreeStart<'_>> {
        let variables = &self.original.variables;
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&self.state, &self.reduced) else { return None };
        let (state, loading) = (&motion.state, reduced.loading());
        let varied = inputs.iter().map(|input| match variables.quantity(*input) {
            Some(Quantity::Input(load)) if load < loading.inputs.len() => Some(load),
            _ => None,
        });
        let varied = varied.collect::<Option<Vec<_>>>()?;
        let is_driven = loading.hydraulics.is_some() || loading.network.is_some() || loading.motion.is_some();
        let state_loads = state_loads_under(reduced, &self.inputs);
        let is_conservative = matches!(state_loads, Ok(None)) && reduced.components().winding.is_none();
        let starts_at_equilibrium = self.parameter_values.mechanism().start.equilibrium;
        let ends = state.ends(reduced, &self.inputs.locks);
        let is_held = state.contact.at_rest().is_some() && ends.at(state.sigma).any(|place| ends.is_locked(place));
        if is_driven
            || !is_conservative
            || starts_at_equilibrium
            || is_held
            || reduced.is_open()
            || state.sigma_dot != 0.0
            || self.inputs.signal.ahead
        {
            return None;
        }
        let mut sizes = reduced.sizes(&self.inputs.reals);
        sizes.resize(reduced.influence().components(), 0.0);
        if let Some(springs) = reduced.components().springs {
            sizes[springs] = 1.0;
        }
        let shift = state.revolutions * reduced.period().unwrap_or(0.0);
        Some(FreeStart { reduced, state, shift, sizes, varied })
    }

    /// The time of the first impact on the stop with this flag as a function of these inputs, which are constant in a
    /// run, all else as it is after the initialisation. `samples`: some sets of their values, one set after the other,
    /// by which positions are selected. None where the energy integral does not give the time: there are losses or
    /// other loads that the state decides, a start in motion, at an equilibrium or held by a lock, an open curve, a
    /// prescribed motion, hydraulics; the stop is no rigid one that ends the travel; an input is none that sizes a
    /// load; no sample moves the mechanism to the stop.
    pub fn travel_time(&self, flag: Reference, inputs: &[Reference], samples: &[f64]) -> Option<TravelTime> {
        let Some(Quantity::AtStop(stop)) = self.original.variables.quantity(flag) else { return None };
        let FreeStart { reduced, state, shift, sizes, varied } = self.free_start(inputs)?;
        let end = state.travel.rigid.iter().flatten().find(|end| end.stop == stop)?;
        TravelTime::new(reduced, [state.sigma, end.position - shift], (&sizes, &varied), samples)
    }

    /// States on the way from the start as functions of these inputs, which are constant in a run, all else as it is
    /// after the initialisation: up to a rigid stop, or over a revolution of a closed curve. None where the energy
    /// integral does not give them, as for [`Self::travel_time`], or an input is named twice.
    pub fn fast_forward(&self, inputs: &[Reference]) -> Option<FastForward> {
        let FreeStart { reduced, state, shift, sizes, varied } = self.free_start(inputs)?;
        let tolerance = self.parameter_values.mechanism().solver.tolerance;
        let ends = [-1.0, 1.0].map(|direction| {
            let side = usize::from(direction > 0.0);
            let stop = state.travel.rigid[side].map(|end| (end.position - shift, true));
            let Some(period) = reduced.period() else { return stop };
            let turned = state.travel.ends_meet[side].is_none().then_some((state.sigma + direction * period, false));
            stop.or(turned).filter(|(last, _)| (last - state.sigma).abs() <= period)
        });
        let is_unique = (1..varied.len()).all(|k| !varied[..k].contains(&varied[k]));
        FastForward::new(reduced, state.sigma, ends, (&sizes, &varied), tolerance).filter(|_| is_unique)
    }

    /// From the start to a state that [`Self::fast_forward`] has found for the present inputs, in the host's time from
    /// `point` [s] on. The next step makes the impact on a stop that is there.
    ///
    /// # Errors
    /// The model is not at its start; the state overflows.
    pub fn go_to(&mut self, point: f64, waypoint: &Waypoint) -> Result<(), ModelError> {
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised);
        };
        motion.go_to(point, reduced, waypoint)
    }
}
