//! What a step tells its host without refusing it, once after the initialisation.
//!
//! In: the inputs and the state of a step. Out: one line of text. It must not change the state.
use super::{Formulation, Model};
use crate::hydraulics::inputs::clipping;
use crate::mechanism::dynamics::hydraulic::command;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::reduced::Reduced;

/// A command of the valve that is clipped, of which a host is told once.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clipped {
    /// Whether a step has met one.
    is_known: bool,
    /// The command, until it is told.
    pending: Option<f64>,
}

impl Clipped {
    /// The command that a step of size h [s] from this state is to clip, unless one was met before; None without a
    /// circuit.
    #[inline]
    pub fn look(&self, (reduced, state): (&Reduced, &Formulation), inputs: &Inputs, h: f64) -> Option<f64> {
        let drive = reduced.loading().hydraulics.as_ref().filter(|_| !self.is_known)?;
        command(drive, inputs, state.along_curve().memory.circuit()?.time.now).clipped(h)
    }

    /// A step has clipped this command.
    #[cold]
    pub fn raise(&mut self, command: f64) {
        *self = Self { is_known: true, pending: Some(command) };
    }
}

impl Model {
    /// A warning that came up since the last call; None if there is none.
    #[inline]
    pub fn take_warning(&mut self) -> Option<String> {
        self.clipped.pending.take().map(clipping)
    }
}
