//! Results of a model for its present state and inputs.
//!
//! In: settings, a state. Out: flows and a foreseen motion, each found once. It must not know variables.
use crate::network::layout::Layout;
use crate::network::outputs::Present;
use crate::network::state::{Foreseen, Setting, State};

/// Results for the present state and inputs.
#[derive(Debug)]
pub struct Cache {
    pub(super) present: Option<Box<Present<f64>>>,
    pub(super) is_present: bool,
    /// Room for a foreseen motion, and whether it is one from here.
    pub(super) foreseen: Box<Foreseen>,
    pub(super) is_foreseen: bool,
    /// The event to which the last step has led, and its time since the beginning of the step [s].
    pub(super) event: Option<(f64, usize)>,
}

impl Clone for Cache {
    /// A copy computes its own results.
    fn clone(&self) -> Self {
        Self { present: None, is_present: false, foreseen: self.foreseen.clone(), is_foreseen: false, event: None }
    }
}

impl Cache {
    pub fn new(layout: &Layout) -> Self {
        Self {
            present: None,
            is_present: false,
            foreseen: Box::new(Foreseen::nothing(layout)),
            is_foreseen: false,
            event: None,
        }
    }

    /// Room for the largest network.
    #[cfg(test)]
    pub fn make_large(&mut self) {
        self.foreseen.make_large();
    }

    /// The state, the parameters or inputs have changed.
    pub fn clear(&mut self) {
        (self.is_present, self.is_foreseen) = (false, false);
    }

    /// The motion foreseen over a step of size h [s] from the present state and inputs.
    pub fn foresee(&mut self, setting: &Setting<'_>, state: &State, h: f64) -> &mut Foreseen {
        if !self.is_foreseen || self.foreseen.h.to_bits() != h.to_bits() {
            state.foresee(setting, h, &mut self.foreseen);
            self.is_foreseen = true;
        }
        &mut self.foreseen
    }
}
