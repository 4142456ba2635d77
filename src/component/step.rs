//! Steps of a component, and the events in them.
//!
//! In: the length of a step, the host's time. Out: how far the component has come, and what happened on the way. It
//! must not know how a model makes a step.
use super::{Component, Refused};
use crate::hydraulics::HydraulicsError;
use crate::mechanism::{Line, ModelError, Pauses, Reached, Waypoint};
use crate::numerics::decimal::Decimal;

/// How far a step has come.
#[derive(Clone, Debug, PartialEq)]
pub enum Stepped {
    /// To its end.
    Whole,
    /// To a state before its end, in which the model is now.
    Part(Interrupted),
    /// Nowhere: the step could not be computed, and the model is in the state before it.
    Failed(Refused),
}

/// Where a step has ended that may pause.
#[derive(Clone, Debug, PartialEq)]
pub enum Paused {
    /// At its end.
    AtEnd,
    /// At an event, so long after its beginning [s], that [`Component::handle_event`] handles.
    AtEvent(f64),
    /// At the end of an internal step, so long after its beginning [s].
    AtStep(f64),
    /// At a state before its end, as the step met a bound.
    Part(Interrupted),
    /// Nowhere, as [`Stepped::Failed`].
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

/// A step that met `solver.max_steps`.
#[derive(Clone, Debug, PartialEq)]
pub struct Interrupted {
    /// Time from the beginning of the step to the state reached [s], less than the step.
    pub time: f64,
    /// What took so many steps, how far they came, and the remedy.
    pub why: String,
}

/// How far a step of a mechanism has come that did not come to its end.
///
/// # Errors
/// The step was refused before it began.
#[cold]
fn stepped(error: ModelError) -> Result<Stepped, Refused> {
    match error {
        ModelError::Interrupted { time, why } => Ok(Stepped::Part(Interrupted { time, why })),
        error if error.ends_step() => Ok(Stepped::Failed(error.into())),
        error => Err(error.into()),
    }
}

/// How far a step of a hydraulic model has come that did not come to its end.
///
/// # Errors
/// The step was refused before it began.
#[cold]
fn stepped_hydraulic(error: HydraulicsError) -> Result<Stepped, Refused> {
    match error {
        HydraulicsError::Interrupted { time, why } => Ok(Stepped::Part(Interrupted { time, why })),
        error if error.ends_step() => Ok(Stepped::Failed(error.into())),
        error => Err(error.into()),
    }
}

impl Component {
    /// [`Self::step_from`] at the model's own time since the start.
    ///
    /// # Errors
    /// As [`Self::step_from`].
    pub fn step(&mut self, h: f64) -> Result<Stepped, Refused> {
        self.step_from(None, h)
    }

    /// Advance from the host's time `point` [s], if it has one, by exactly `h` [s], > 0, or as far as
    /// `solver.max_steps` allows.
    ///
    /// # Errors
    /// Refused before the step began, without any change: not initialised, `h` out of range, inputs whose loads
    /// overflow.
    #[inline]
    pub fn step_from(&mut self, point: Option<f64>, h: f64) -> Result<Stepped, Refused> {
        match self {
            Self::Mechanism(model) => model.step_from(point, h).map_or_else(stepped, |()| Ok(Stepped::Whole)),
            Self::Hydraulic(model) => model.step(h).map_or_else(stepped_hydraulic, |()| Ok(Stepped::Whole)),
        }
    }

    /// [`Self::step_from`] the start, by way of a state that [`Self::fast_forward`] has found for the present inputs and
    /// for a time up to `h` [s], if it has found one.
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

    /// Whether a step may come to an event, as where a stop is met or lets go, or a valve opens.
    pub fn has_events(&self) -> bool {
        match self {
            Self::Mechanism(model) => model.has_events(),
            Self::Hydraulic(model) => model.has_events(),
        }
    }

    /// Whether a step tells its internal steps.
    pub fn has_internal_steps(&self) -> bool {
        matches!(self, Self::Mechanism(_))
    }

    /// [`Self::step_from`], but only to where it pauses first. At an event the state is that before the event.
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

    /// Handle the event to which a step has led, at the time `point` [s] of the host: the state is then that after it.
    /// Returns whether the state has jumped. Without an event nothing changes.
    ///
    /// # Errors
    /// The state after the event cannot be computed; nothing has changed.
    pub fn handle_event(&mut self, point: f64) -> Result<bool, Refused> {
        match self {
            Self::Mechanism(model) => Ok(model.handle_event(Some(point))?),
            Self::Hydraulic(model) => {
                model.handle_event();
                Ok(false)
            }
        }
    }

    /// Keep events in steps, or details, for [`Self::take_occurrences`], or do not.
    #[inline]
    pub fn listen(&mut self, events: bool, details: bool) {
        if let Self::Mechanism(model) = self {
            model.listen(events, details);
        }
    }

    /// What happened in the last step, which began at the time `point` [s], in words; nothing mostly.
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

    /// That the model has grown with its motion, told once; None mostly.
    #[inline]
    pub fn take_growth(&mut self) -> Option<String> {
        match self {
            Self::Mechanism(model) => model.take_growth(),
            Self::Hydraulic(_) => None,
        }
    }
}
