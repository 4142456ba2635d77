//! Steps of a component, and the events in them.
//!
//! In: the size of a step, the host's time. Out: the part of the step that was made, and the occurrences in it. Must
//! not know: how a model makes a step.
use super::{Component, Refused};
use crate::hydraulics::HydraulicsError;
use crate::mechanism::{Line, ModelError, Pauses, Reached, Waypoint};
use crate::numerics::decimal::Decimal;

/// Result of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Stepped {
    /// The whole step was made.
    Whole,
    /// A part of the step was made. The model is in the state at the time reached.
    Part(Interrupted),
    /// The step could not be computed. The model is in the state before the step.
    Failed(Refused),
}

/// Result of a step that may pause.
#[derive(Clone, Debug, PartialEq)]
pub enum Paused {
    /// The whole step was made.
    AtEnd,
    /// The step ended at an event for [`Component::handle_event`]. Value: time since the start of the step [s].
    AtEvent(f64),
    /// The step paused at the end of an internal step. Value: time since the start of the step [s].
    AtStep(f64),
    /// A part of the step was made, because the step reached `solver.max_steps`.
    Part(Interrupted),
    /// The step could not be computed, as in [`Stepped::Failed`].
    Failed(Refused),
}

impl From<Stepped> for Paused {
    fn from(stepped: Stepped) -> Self {
        match stepped {
            Stepped::Whole => Self::AtEnd,
            Stepped::Part(interrupted) => Self::Part(interrupted),
            Stepped::Failed(refused) => Self::Failed(refused),
        }
    }
}

/// A step that reached `solver.max_steps`.
#[derive(Clone, Debug, PartialEq)]
pub struct Interrupted {
    /// Time from the start of the step to the state reached [s], less than the size of the step.
    pub time: f64,
    /// Reason for the number of steps, the time reached, and the remedy.
    pub why: String,
}

/// Result of a step of a mechanism that ended with an error.
///
/// # Errors
/// The step was rejected before it started.
#[cold]
fn stepped(error: ModelError) -> Result<Stepped, Refused> {
    match error {
        ModelError::Interrupted { time, why } => Ok(Stepped::Part(Interrupted { time, why })),
        error if error.ends_step() => Ok(Stepped::Failed(error.into())),
        error => Err(error.into()),
    }
}

/// Result of a step of a hydraulic model that ended with an error.
///
/// # Errors
/// The step was rejected before it started.
#[cold]
fn stepped_hydraulic(error: HydraulicsError) -> Result<Stepped, Refused> {
    match error {
        HydraulicsError::Interrupted { time, why } => Ok(Stepped::Part(Interrupted { time, why })),
        error if error.ends_step() => Ok(Stepped::Failed(error.into())),
        error => Err(error.into()),
    }
}

impl Component {
    /// [`Self::step_from`] with the model's time since the start.
    ///
    /// # Errors
    /// As [`Self::step_from`].
    pub fn step(&mut self, h: f64) -> Result<Stepped, Refused> {
        self.step_from(None, h)
    }

    /// Advances from the host's time `point` [s], if it has one, by exactly `h` [s], > 0, or as far as
    /// `solver.max_steps` allows.
    ///
    /// # Errors
    /// The step was rejected before it started, without any change: not initialised, `h` out of range, or inputs whose
    /// loads overflow.
    #[inline]
    pub fn step_from(&mut self, point: Option<f64>, h: f64) -> Result<Stepped, Refused> {
        match self {
            Self::Mechanism(model) => model.step_from(point, h).map_or_else(stepped, |()| Ok(Stepped::Whole)),
            Self::Hydraulic(model) => model.step(h).map_or_else(stepped_hydraulic, |()| Ok(Stepped::Whole)),
        }
    }

    /// Make the first step of a run. If [`Self::fast_forward`] has found a state for the present inputs and for a time
    /// up to `h` [s], the step continues from this state.
    ///
    /// # Errors
    /// As [`Self::step_from`]; the state overflows.
    #[inline]
    pub fn step_by(&mut self, waypoint: Option<&Waypoint>, point: f64, h: f64) -> Result<Stepped, Refused> {
        let (Self::Mechanism(model), Some(waypoint)) = (&mut *self, waypoint) else {
            return self.step_from(Some(point), h);
        };
        model.go_to(point, waypoint)?;
        if waypoint.time < h {
            self.step_from(Some(point + waypoint.time), h - waypoint.time)
        } else {
            Ok(Stepped::Whole)
        }
    }

    /// Whether an event may occur in a step, for example contact with a stop, its release, or the opening of a valve.
    pub fn has_events(&self) -> bool {
        match self {
            Self::Mechanism(model) => model.has_events(),
            Self::Hydraulic(model) => model.has_events(),
        }
    }

    /// Whether a step can pause after its internal steps.
    pub fn has_internal_steps(&self) -> bool {
        matches!(self, Self::Mechanism(_))
    }

    /// [`Self::step_from`] up to the first pause. At an event the state is that before the event.
    ///
    /// # Errors
    /// As [`Self::step_from`].
    #[inline]
    pub fn step_to_pause(&mut self, point: f64, h: f64, pauses: Pauses) -> Result<Paused, Refused> {
        match self {
            Self::Mechanism(model) => match model.step_to_pause(Some(point), h, pauses) {
                Ok(Reached::End) => Ok(Paused::AtEnd),
                Ok(Reached::Event(time)) => Ok(Paused::AtEvent(time)),
                Ok(Reached::Pause(time)) => Ok(Paused::AtStep(time)),
                Err(error) => stepped(error).map(Paused::from),
            },
            Self::Hydraulic(model) if pauses.at_events => match model.step_to_event(h) {
                Ok(event) => Ok(event.map_or(Paused::AtEnd, Paused::AtEvent)),
                Err(error) => stepped_hydraulic(error).map(Paused::from),
            },
            Self::Hydraulic(_) => self.step_from(Some(point), h).map(Paused::from),
        }
    }

    /// Handles the event at which a step ended, at the host's time `point` [s]. The state is then that after the event.
    /// Returns whether the state jumped. Without an event nothing changes.
    ///
    /// # Errors
    /// The state after the event cannot be computed. Nothing has changed.
    pub fn handle_event(&mut self, point: f64) -> Result<bool, Refused> {
        match self {
            Self::Mechanism(model) => Ok(model.handle_event(Some(point))?),
            Self::Hydraulic(model) => {
                model.handle_event();
                Ok(false)
            }
        }
    }

    /// Switches the recording of events and of details in steps for [`Self::take_occurrences`].
    #[inline]
    pub fn listen(&mut self, events: bool, details: bool) {
        if let Self::Mechanism(model) = self {
            model.listen(events, details);
        }
    }

    /// Texts about the occurrences in the last step, which started at the time `point` [s]. Usually empty.
    #[inline]
    pub fn take_occurrences(&mut self, point: f64) -> Vec<Line> {
        match self {
            Self::Mechanism(model) => model.take_occurrences(point),
            Self::Hydraulic(model) => {
                let line = |(time, text)| {
                    let text = format!("at t = {} s {text}", Decimal::rounded(point + time));
                    Line { is_detail: false, text }
                };
                model.take_event().map(line).into_iter().collect()
            }
        }
    }

    /// Text that the model has grown with its motion, returned once. Usually None.
    #[inline]
    pub fn take_growth(&mut self) -> Option<String> {
        match self {
            Self::Mechanism(model) => model.take_growth(),
            Self::Hydraulic(_) => None,
        }
    }
}
