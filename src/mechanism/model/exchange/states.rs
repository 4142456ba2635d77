//! The continuous states of model exchange: which variables they are, how many, how large.
//!
//! In: a model. Out: references, sizes, indices of states. It must not know how states are set.
use crate::mechanism::definition::MOST_STATES;
use crate::mechanism::loads::resolved::DriveLaw;
use crate::mechanism::model::{Model, ModelError};
use crate::mechanism::quantity::{Output, Quantity};
use crate::numerics::order::sorted_by_pair;
use crate::variables::{ContinuousTime, Reference};

/// States or their rates: those of the motion, then those of controllers.
pub(super) fn joined(motion: [f64; 2], controllers: &[f64]) -> [f64; MOST_STATES] {
    let mut all = [0.0; MOST_STATES];
    all[..2].copy_from_slice(&motion);
    all[2..2 + controllers.len()].copy_from_slice(controllers);
    all
}

impl Model {
    /// The variables that a host's solver integrates; none where the state has more than the motion: with a hydraulic
    /// circuit.
    pub fn continuous_time(&self) -> Option<ContinuousTime> {
        let mut all = ContinuousTime::default();
        let mut controllers = [Vec::new(), Vec::new()];
        for reference in 0..self.original.variables.list().len() as Reference {
            match self.original.variables.quantity(reference) {
                Some(Quantity::State(order)) => {
                    all.states.extend((order < 2).then_some(reference));
                    all.derivatives.extend((order > 0).then_some(reference));
                }
                Some(Quantity::Indicator(_)) => all.indicators.push(reference),
                Some(Quantity::Output(Output::Controller { drive, state, order })) => {
                    let law = self.original.reduced.loading().drives[drive].law.as_ref();
                    controllers[order].push((law.and_then(|law| law.states[state as usize]), reference));
                }
                _ => {}
            }
        }
        // In the order of the states, not of the outputs.
        let [values, rates] = controllers.map(|all| {
            let all = sorted_by_pair(all, |(state, _)| (state.map_or(0, |state| state + 1), 0));
            all.into_iter().map(|(_, reference)| reference)
        });
        all.states.extend(values);
        all.derivatives.extend(rates);
        (!all.states.is_empty()).then_some(all)
    }

    /// Number of the continuous states; 0 if a host's solver integrates none.
    pub fn state_count(&self) -> usize {
        let loading = self.original.reduced.loading();
        let has_none = loading.first_port().is_some() || self.original.reduced.linkage().is_massless;
        if has_none { 0 } else { 2 + loading.control_states().count() }
    }

    /// References of the event indicators: the last variables.
    pub fn indicators(&self) -> std::ops::Range<Reference> {
        let all = self.original.variables.list().len() as Reference;
        let is = |reference: &Reference| {
            matches!(self.original.variables.quantity(*reference), Some(Quantity::Indicator(_)))
        };
        let count = (0..all).rev().take_while(is).count() as Reference;
        all - count..all
    }

    /// Scales of the continuous states.
    ///
    /// # Errors
    /// As [`Self::continuous_states`].
    pub fn nominals(&mut self) -> Result<[f64; MOST_STATES], ModelError> {
        let reduced = self.reduced()?;
        let mut controllers = [0.0; MOST_STATES - 2];
        for (nominal, (drive, _)) in controllers.iter_mut().zip(reduced.loading().control_states()) {
            let drive = &reduced.loading().drives[drive];
            let Some(control) = drive.law.as_ref().and_then(DriveLaw::control) else { continue };
            let size = if drive.is_rotary { 1.0 } else { reduced.linkage().size };
            let force = control.position_gain.or(control.speed_gain).unwrap_or(0.0) * size;
            *nominal = if force > 0.0 { force } else { 1.0 };
        }
        Ok(joined([reduced.scale(); 2], &controllers))
    }

    /// Which of the states has this reference, if a host's solver integrates them.
    #[inline]
    pub(in crate::mechanism::model) fn known_state(&self, reference: Reference) -> Option<usize> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::State(order @ 0..=1)) if self.exchange.is_some() => Some(order),
            Some(Quantity::Output(Output::Controller { drive, state, order: 0 })) if self.exchange.is_some() => {
                let law = self.original.reduced.loading().drives[drive].law.as_ref();
                law.and_then(|law| law.states[state as usize]).map(|index| 2 + index)
            }
            _ => None,
        }
    }

    /// Which of the derivatives has this reference.
    #[inline]
    pub(in crate::mechanism::model) fn unknown_rate(&self, reference: Reference) -> Option<usize> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::State(order @ 1..=2)) => Some(order - 1),
            _ => None,
        }
    }
}
