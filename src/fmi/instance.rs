//! One instance: a component, its phase, its clock and its logger.
//!
//! In: plain numbers. Out: the instance in its next phase, or a refusal that leaves it unchanged. It must not know
//! pointers to instances, nor the names and C types of a version.

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

/// What is called with the time reached [s] after an internal step; returns the time at which the host wants the step
/// to end, if it asks for that [s].
pub type IntermediateUpdate = dyn Fn(f64) -> Option<f64>;

/// One instance of the FMU.
pub struct Instance {
    /// Present phase; `handle` checks it before each call.
    pub phase: Phase,
    /// The version of FMI that the host speaks.
    pub version: Version,
    /// Where messages go.
    pub logger: Logger,
    /// What the host makes use of.
    pub usage: Usage,
    /// Whether the last step has led to an event that the host has not had handled yet.
    pub awaits_event: bool,
    /// Whether the experiment was set up.
    pub set_up: bool,
    /// Tolerance of the experiment, if it has one. It takes precedence over solver.tolerance.
    tolerance: Option<f64>,
    pub clock: Clock,
    pub component: Component,
    /// The host's callback after internal steps, if the host makes use of it.
    pub update: Option<Rc<IntermediateUpdate>>,
    /// Vectors that the version has beside the component's variables.
    pub(super) vectors: Vec<Vector>,
    /// Memory for the bytes of the next state that is serialised.
    pub(super) spare: Vec<u8>,
    /// Memory for the scalars of a call.
    pub(super) scalars: Vec<Reference>,
    /// Memory for the orders of its derivatives.
    pub(super) orders: Vec<i32>,
    /// For each variable of the component the knowns on which its initial value depends, once they were asked for; None
    /// inside of a model too large to find them.
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

    /// Set up the experiment. Without it, the start time is 0 and there is no stop time. A tolerance of 0 is none, as
    /// importers pass it whose user has stated none; a warning tells it.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<(), Refusal> {
        let clock = Clock::new(start, stop)?;
        let is_zero = tolerance == Some(0.0);
        let tolerance = tolerance.filter(|_| !is_zero);
        if let Some(tolerance) = tolerance {
            if !(tolerance > 0.0 && tolerance.is_finite()) {
                let tolerance = Decimal(tolerance);
                return Err(Refusal::error(format!("tolerance is {tolerance}; it must be finite and greater than 0")));
            }
            self.component.set_tolerance(tolerance)?;
        }
        self.tolerance = tolerance;
        self.clock = clock;
        self.set_up = true;
        if is_zero {
            self.logger.remark("tolerance is 0, which counts as no tolerance: solver.tolerance is used");
        }
        Ok(())
    }

    /// End initialization mode. After a refusal the mode goes on: parameters can be corrected.
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

    /// End of the simulation.
    pub fn terminate(&mut self) {
        self.phase = Phase::Terminated;
        self.logger.event(|| format!("terminated at t = {} s after {}", self.clock.time, self.component.cost()));
    }

    /// As after instantiation, but for the log categories, which stay as the host chose them.
    pub fn reset(&mut self) {
        self.component.reset();
        self.clock = Clock::default();
        (self.set_up, self.awaits_event) = (false, false);
        self.tolerance = None;
        self.phase = Phase::Instantiated;
    }

    /// All that decides how the instance goes on; the log categories are no part of it.
    pub fn save(&self) -> Saved {
        let Self { phase, awaits_event, set_up, tolerance, clock, .. } = *self;
        Saved { phase, awaits_event, set_up, tolerance, clock, component: self.component.snapshot() }
    }

    /// [`Self::save`] into an existing state of this identity, without allocation if both are of the same kind.
    pub fn save_into(&self, saved: &mut Saved) {
        (saved.phase, saved.awaits_event, saved.set_up) = (self.phase, self.awaits_event, self.set_up);
        (saved.tolerance, saved.clock) = (self.tolerance, self.clock);
        self.component.snapshot_into(&mut saved.component);
    }

    /// Go on as the instance that was saved, in its phase.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), Refusal> {
        if !self.usage.has(saved.phase) || saved.awaits_event && !self.usage.event_mode {
            return Err(no_such_phase(saved));
        }
        self.component.restore(&saved.component)?;
        (self.phase, self.awaits_event, self.set_up) = (saved.phase, saved.awaits_event, saved.set_up);
        (self.tolerance, self.clock) = (saved.tolerance, saved.clock);
        Ok(())
    }

    /// Log what happened in a step that began at the time `point` [s].
    #[cold]
    pub(super) fn tell(&mut self, point: f64) {
        for line in self.component.take_occurrences(point) {
            if line.is_detail { self.logger.detail(&line.text) } else { self.logger.event(|| line.text) }
        }
    }

    /// Advance by exactly `h` [s] from the present communication point.
    ///
    /// The time after the step is the host's `point` plus `h`, so that the rounding of the host's sums is never counted
    /// as its error. A step that is refused before it begins changes nothing. After a step that cannot be computed, the
    /// state is that of the last communication point; after one that met the bound on its work, that at the time
    /// reached. A warning comes after a step that is done.
    ///
    /// With [`Usage::intermediate_update`], `pauses_left` counts the internal steps after which the step pauses, with
    /// its phase `Intermediate`: it goes on when this is called again with the rest of the step.
    pub fn do_step(&mut self, point: f64, h: f64, pauses_left: &mut u64) -> Result<(), Refusal> {
        let end = self.clock.end_of_step(point, h)?;
        let (events, details) = (self.logger.has_events(), self.logger.has_details());
        self.component.listen(events, details);
        let Usage { event_mode, early_return, intermediate_update, .. } = self.usage;
        let pauses =
            Pauses { at_events: event_mode && early_return, at_steps: intermediate_update && *pauses_left > 0 };
        if self.awaits_event {
            return Err(self.event_first("a step"));
        }
        let stepped = self.component.step_to_pause(point, h, pauses)?;
        self.phase = Phase::Step;
        if events || details {
            self.tell(point);
        }
        match stepped {
            Paused::AtEnd => {
                self.clock.time = end;
                if events && let Some(growth) = self.component.take_growth() {
                    self.logger.event(|| format!("at t = {end} s {growth}"));
                }
                self.warning()
            }
            Paused::AtEvent(time) => {
                self.clock.time = if time < h { point + time } else { end };
                self.awaits_event = true;
                self.warning()
            }
            Paused::AtStep(time) => {
                self.clock.time = if time < h { point + time } else { end };
                self.phase = Phase::Intermediate;
                *pauses_left -= 1;
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

    /// What the component warns of after a step, if anything.
    #[inline]
    pub fn warning(&mut self) -> Result<(), Refusal> {
        self.component.take_warning().map_or(Ok(()), |warning| Err(Refusal::warning(warning)))
    }
}
