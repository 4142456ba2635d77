//! Model exchange of an instance: time, states and derivatives for the host's own solver.
//!
//! In: checked slices and plain numbers, in their phases. Out: values, or a refusal that leaves the instance unchanged.
//! Must not know: what a state is.

use super::instance::Instance;
use super::phase::Phase;
use super::refusal::Refusal;
use super::resources::Loaded;
use super::usage::Usage;
use crate::component::MOST_STATES;
use crate::numerics::decimal::Decimal;
use std::mem::MaybeUninit;

impl Usage {
    /// Usage by a host that integrates the states itself.
    pub const MODEL_EXCHANGE: Self =
        Self { event_mode: true, early_return: false, intermediate_update: false, model_exchange: true };
}

/// Prepares a loaded component for model exchange.
pub fn served(mut loaded: Loaded) -> Result<Loaded, Refusal> {
    loaded.component.serve_exchange()?;
    Ok(loaded)
}

/// Rejects a list whose length is not `own`.
fn same_length(what: &str, count: usize, own: usize) -> Result<(), Refusal> {
    if count == own {
        return Ok(());
    }
    Err(Refusal::error(format!("{count} {what} were passed, but this FMU has {own}; pass an array of {own} elements")))
}

impl Instance {
    /// Returns an error if the instance was created for co-simulation.
    fn exchanges(&self) -> Result<(), Refusal> {
        if self.usage.model_exchange {
            return Ok(());
        }
        Err(Refusal::error(
            "this function belongs to model exchange, but this instance was created for co-simulation; call doStep \
             instead",
        ))
    }

    /// Sets the time [s] for derivatives and outputs.
    pub fn set_time(&mut self, time: f64) -> Result<(), Refusal> {
        self.exchanges()?;
        if !time.is_finite() {
            return Err(Refusal::error(format!("time is {} s, but the time must be finite", Decimal(time))));
        }
        self.clock.time = time;
        self.component.set_time(time);
        Ok(())
    }

    /// Changes from event mode to continuous-time mode.
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), Refusal> {
        self.exchanges()?;
        self.phase = Phase::Continuous;
        Ok(())
    }

    /// Number of continuous states.
    pub fn state_count(&self) -> Result<usize, Refusal> {
        self.exchanges()?;
        Ok(self.component.state_count())
    }

    /// Number of event indicators.
    pub fn indicator_count(&self) -> Result<usize, Refusal> {
        self.exchanges()?;
        Ok(self.indicators().len())
    }

    /// References of the event indicators, which are the last variables of the component.
    fn indicators(&self) -> std::ops::Range<u32> {
        self.component.indicators()
    }

    /// Sets trial states of the host's solver. The verdict is discard if the mechanism has no such position.
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Result<(), Refusal> {
        self.exchanges()?;
        same_length("states", states.len(), self.component.state_count())?;
        Ok(self.component.set_continuous_states(states)?)
    }

    /// Returns the continuous states.
    pub fn continuous_states(&mut self, states: &mut [MaybeUninit<f64>]) -> Result<(), Refusal> {
        self.exchanges()?;
        same_length("states", states.len(), self.component.state_count())?;
        fill(states, self.component.continuous_states()?);
        Ok(())
    }

    /// Nominal values of the continuous states.
    pub fn nominals(&mut self, nominals: &mut [MaybeUninit<f64>]) -> Result<(), Refusal> {
        self.exchanges()?;
        same_length("nominal values", nominals.len(), self.component.state_count())?;
        fill(nominals, self.component.nominals()?);
        Ok(())
    }

    /// Time derivatives of the continuous states. The verdict is discard if they do not exist.
    pub fn derivatives(&mut self, derivatives: &mut [MaybeUninit<f64>]) -> Result<(), Refusal> {
        self.exchanges()?;
        same_length("derivatives", derivatives.len(), self.component.state_count())?;
        fill(derivatives, self.component.derivatives()?);
        Ok(())
    }

    /// Event indicators. The verdict is discard if one of them has no value.
    pub fn event_indicators(&mut self, values: &mut [MaybeUninit<f64>]) -> Result<(), Refusal> {
        self.exchanges()?;
        let references = self.indicators();
        same_length("event indicators", values.len(), references.len())?;
        for (reference, value) in references.zip(values) {
            let number = self.component.real(reference)?;
            if number.is_nan() {
                let name = self.component.interface().get(reference).map_or("", |variable| &variable.name);
                return Err(Refusal::discard(format!("{name} has no value in this state; use a shorter step")));
            }
            value.write(number);
        }
        Ok(())
    }

    /// Ends a step of the host's solver. Returns whether the host must enter event mode.
    pub fn completed_integrator_step(&mut self) -> Result<bool, Refusal> {
        self.exchanges()?;
        Ok(self.component.completed_step()?)
    }
}

fn fill(values: &mut [MaybeUninit<f64>], numbers: [f64; MOST_STATES]) {
    values.iter_mut().zip(numbers).for_each(|(value, number)| _ = value.write(number));
}
