//! One instance: a component, its phase, its clock and its logger.
//!
//! In: plain numbers. Out: the instance in its next phase, or a refusal that leaves it unchanged. Must not know:
//! pointers to instances, names and C types of a version.

use super::clock::Clock;
use super::logger::Logger;
use super::phase::Phase;
use super::refusal::Refusal;
use super::saved::Saved;
use super::usage::{Usage, no_such_phase};
use super::version::Version;
use crate::component::{Component, Paused, Pauses};
use crate::numerics::decimal::Decimal;
use crate::variables::{Reference, Vector};
use std::rc::Rc;

/// Callback after an internal step. Argument: the time reached [s]. Result: the time [s] at which the host wants the
/// step to end, if the host requests an early end.
pub type IntermediateUpdate = dyn Fn(f64) -> Option<f64>;

/// The pauses of a step.
pub struct Parts {
    /// Number of pauses after internal steps that remain.
    pub pauses_left: u64,
    /// Time at which the step would have ended without a pause or an event [s]; none if it has had neither.
    pub goal: Option<f64>,
}

impl Parts {
    /// A step that may pause this often after internal steps.
    pub fn at_most(pauses_left: u64) -> Self {
        Parts { pauses_left, goal: None }
    }
}

/// One instance of the FMU.
pub struct Instance {
    /// Present phase, which `handle` checks before each call.
    pub phase: Phase,
    /// FMI version of the host.
    pub version: Version,
    /// Logger for messages to the host.
    pub logger: Logger,
    /// Features that the host uses.
    pub usage: Usage,
    /// Whether the last step ended at an event that has not been handled yet.
    pub awaits_event: bool,
    /// Whether the experiment was set up.
    pub set_up: bool,
    /// Tolerance of the experiment, if it has one. It takes precedence over solver.tolerance.
    tolerance: Option<f64>,
    pub clock: Clock,
    pub component: Component,
    /// The host's callback after internal steps, if the host uses it.
    pub update: Option<Rc<IntermediateUpdate>>,
    /// Vectors of the version, which exist in addition to the component's variables.
    pub(super) vectors: Vec<Vector>,
    /// Memory for the bytes of the next serialised state.
    pub(super) spare: Vec<u8>,
    /// Memory for the scalars of a call.
    pub(super) scalars: Vec<Reference>,
    /// Memory for the orders of derivatives of a call.
    pub(super) orders: Vec<i32>,
    /// For each variable of the component, the knowns on which its initial value depends, after the first request. The
    /// inner value is None for a model that is too large to find them.
    pub(super) initial_dependencies: Option<Option<Vec<Vec<Reference>>>>,
}

impl Instance {
    /// New instance of a component.
    pub fn new(version: Version, logger: Logger, component: Component, usage: Usage) -> Self {
        Instance {
            phase: Phase::Instantiated,
            version,
            logger,
            usage,
            awaits_event: false,
            set_up: false,
            tolerance: None,
            clock: Clock::default(),
            vectors: if version.has_vectors() { component.vectors() } else { Vec::new() },
            component,
            update: None,
            spare: Vec::new(),
            scalars: Vec::new(),
            orders: Vec::new(),
            initial_dependencies: None,
        }
    }

    /// Sets up the experiment. Without this call, the start time is 0 and there is no stop time. A tolerance of 0
    /// counts as no tolerance, with a warning: some importers pass 0 if the user states no tolerance.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<(), Refusal> {
        let clock = Clock::new(start, stop)?;
        let is_zero = tolerance == Some(0.0);
        let tolerance = tolerance.filter(|_| !is_zero);
        if let Some(tolerance) = tolerance {
            if !(tolerance > 0.0 && tolerance.is_finite()) {
                let tolerance = Decimal(tolerance);
                return Err(Refusal::error(format!(
                    "tolerance is {tolerance}, but the tolerance must be finite and greater than 0"
                )));
            }
            self.component.set_tolerance(tolerance)?;
        }
        self.tolerance = tolerance;
        self.clock = clock;
        self.set_up = true;
        if is_zero {
            self.logger
                .remark("the argument tolerance is 0, which counts as no tolerance: the FMU uses solver.tolerance");
        }
        Ok(())
    }

    /// Ends initialization mode. After an error the instance stays in this mode, so that parameters can be corrected.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Refusal> {
        if let Some(tolerance) = self.tolerance {
            self.component.set_tolerance(tolerance)?;
        }
        self.component.initialize()?;
        self.component.set_time(self.clock.time);
        self.phase = if self.usage.event_mode { Phase::Event } else { Phase::Step };
        if let Some(warning) = self.component.start_warning() {
            self.logger.remark(&warning);
        }
        self.logger.event(|| format!("initialized at t = {} s", self.clock.time));
        Ok(())
    }

    /// Ends the simulation.
    pub fn terminate(&mut self) {
        self.phase = Phase::Terminated;
        self.logger.event(|| format!("terminated at t = {} s after {}", self.clock.time, self.component.cost()));
    }

    /// Returns to the state after instantiation. The log categories stay as the host chose them.
    pub fn reset(&mut self) {
        self.component.reset();
        self.clock = Clock::default();
        (self.set_up, self.awaits_event) = (false, false);
        self.tolerance = None;
        self.phase = Phase::Instantiated;
    }

    /// Returns all data that determine how the simulation continues. The log categories are not included.
    pub fn save(&self) -> Saved {
        let Self { phase, awaits_event, set_up, tolerance, clock, .. } = *self;
        Saved { phase, awaits_event, set_up, tolerance, clock, component: self.component.snapshot() }
    }

    /// [`Self::save`] into an existing state of this identity, without allocation if both states are of the same kind.
    pub fn save_into(&self, saved: &mut Saved) {
        (saved.phase, saved.awaits_event, saved.set_up) = (self.phase, self.awaits_event, self.set_up);
        (saved.tolerance, saved.clock) = (self.tolerance, self.clock);
        self.component.snapshot_into(&mut saved.component);
    }

    /// Restores a saved state, with its phase.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), Refusal> {
        if !self.usage.has(saved.phase) || saved.awaits_event && !self.usage.event_mode {
            return Err(no_such_phase(saved));
        }
        self.component.restore(&saved.component)?;
        (self.phase, self.awaits_event, self.set_up) = (saved.phase, saved.awaits_event, saved.set_up);
        (self.tolerance, self.clock) = (saved.tolerance, saved.clock);
        Ok(())
    }

    /// Logs the occurrences of a step that started at the time `point` [s].
    #[cold]
    pub(super) fn log_occurrences(&mut self, point: f64) {
        for line in self.component.take_occurrences(point) {
            if line.is_detail { self.logger.detail(&line.text) } else { self.logger.event(|| line.text) }
        }
    }

    /// Advances by exactly `h` [s] from the present communication point.
    ///
    /// The time after the step is the host's `point` plus `h`. Rounding errors of the host's sums are therefore no
    /// errors of the host. A rejected step changes nothing. After a step that cannot be computed, the state is that of
    /// the last communication point. After a step that reached `solver.max_steps`, the state is that at the time
    /// reached. A warning means that the step was made.
    ///
    /// With [`Usage::intermediate_update`], the step pauses in the phase `Intermediate` after an internal step. The
    /// next call with the rest of the step continues the step.
    pub fn do_step(&mut self, point: f64, h: f64, parts: &mut Parts) -> Result<(), Refusal> {
        let end = self.clock.end_of_step(point, h)?;
        let (events, details) = (self.logger.has_events(), self.logger.has_details());
        self.component.listen(events, details);
        let Usage { event_mode, early_return, intermediate_update, .. } = self.usage;
        let pauses =
            Pauses { at_events: event_mode && early_return, at_steps: intermediate_update && parts.pauses_left > 0 };
        if self.awaits_event {
            return Err(self.event_first("a step"));
        }
        let stepped = self.component.step_to_pause(point, h, pauses)?;
        self.phase = Phase::Step;
        if events || details {
            self.log_occurrences(point);
        }
        if !matches!(stepped, Paused::AtEnd) {
            return self.pause(stepped, [point, h, end], parts);
        }
        self.clock.time = end;
        if events && let Some(growth) = self.component.take_growth() {
            self.logger.event(|| format!("at t = {end} s {growth}"));
        }
        self.warning()
    }

    /// A step from `point` by `h` to `end` [s] has not reached its end.
    #[cold]
    fn pause(&mut self, stepped: Paused, [point, h, end]: [f64; 3], parts: &mut Parts) -> Result<(), Refusal> {
        let reached = |time| if time < h { point + time } else { end };
        match stepped {
            Paused::AtEnd => Ok(()),
            Paused::AtEvent(time) => {
                (self.clock.time, parts.goal) = (reached(time), Some(end));
                self.awaits_event = true;
                self.warning()
            }
            Paused::AtStep(time) => {
                (self.clock.time, parts.goal) = (reached(time), Some(end));
                parts.pauses_left -= 1;
                self.phase = Phase::Intermediate;
                Ok(())
            }
            Paused::Part(interrupted) => {
                (self.clock.time, self.phase) = (point + interrupted.time, Phase::Interrupted);
                Err(Refusal::discard(interrupted.why))
            }
            Paused::Failed(refused) => {
                self.phase = Phase::Failed;
                Err(refused.into())
            }
        }
    }

    /// The warning of the component after a step, if there is one.
    #[inline]
    pub fn warning(&mut self) -> Result<(), Refusal> {
        self.component.take_warning().map_or(Ok(()), |warning| Err(Refusal::warning(warning)))
    }
}
