//! The time from the start to a stop as a function of inputs.
//!
//! In: the flag of a stop, inputs that size loads. Out: the function, where the energy integral gives it. It must not
//! know the integral.
use super::{Formulation, Model};
use crate::mechanism::motion::acting::state_loads_under;
use crate::mechanism::motion::travel_time::TravelTime;
use crate::mechanism::quantity::Quantity;
use crate::variables::Reference;

impl Model {
    /// The time of the first impact on the stop with this flag as a function of these inputs, which are constant in a
    /// run, all else as it is after the initialisation. `samples`: some sets of their values, one set after the other,
    /// by which positions are selected. None where the energy integral does not give the time: there are losses or
    /// other loads that the state decides, a start in motion, at an equilibrium or held by a lock, an open curve, a
    /// prescribed motion, hydraulics; the stop is no rigid one that ends the travel; an input is none that sizes a
    /// load; no sample moves the mechanism to the stop.
    pub fn travel_time(&self, flag: Reference, inputs: &[Reference], samples: &[f64]) -> Option<TravelTime> {
        let variables = &self.original.variables;
        let Some(Quantity::AtStop(stop)) = variables.quantity(flag) else { return None };
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
        let is_held = self.inputs.locks.contains(&true) && state.contact.at_rest().is_some();
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
        let end = state.travel.rigid.iter().flatten().find(|end| end.stop == stop)?;
        let mut sizes = reduced.sizes(&self.inputs.reals);
        sizes.resize(reduced.influence().components(), 0.0);
        if let Some(springs) = reduced.components().springs {
            sizes[springs] = 1.0;
        }
        let shift = state.revolutions * reduced.period().unwrap_or(0.0);
        TravelTime::new(reduced, [state.sigma, end.position - shift], (&sizes, &varied), samples)
    }
}
