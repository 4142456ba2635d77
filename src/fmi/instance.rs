//! One instance: a component, its phase, its clock and its logger.
//!
//! In: checked slices and plain numbers. Out: values, or a refusal that leaves the instance unchanged. It must not know
//! pointers to instances, nor the names and C types of a version.

use super::clock::Clock;
use super::event_mode::{Usage, no_such_phase};
use super::logger::Logger;
use super::phase::{Phase, Way, may_get, may_set, of_kind};
use super::refusal::Refusal;
use super::saved::Saved;
use super::undefined::Undefined;
use super::vectors;
use super::version::Version;
use crate::component::{Component, Paused, Pauses, Refused};
use crate::numerics::decimal::Decimal;
use crate::variables::{Kind, Reference, Vector};
use std::mem::MaybeUninit;
use std::rc::Rc;

/// Name of the item of an Enumeration with this number.
fn item(component: &Component, reference: Reference, number: i64) -> Result<&'static str, Refused> {
    let Some(variable) = component.interface().get(reference) else { return Ok("") };
    let items = variable.details.items;
    let item = usize::try_from(number).ok().and_then(|number| items.get(number.checked_sub(1)?));
    item.copied().ok_or_else(|| {
        let allowed: Vec<_> = items.iter().enumerate().map(|(index, name)| format!("{} ({name})", index + 1)).collect();
        Refused(format!("{} = {number}: must be {}", variable.name, allowed.join(" or ")))
    })
}

/// What is called with the time reached [s] after an internal step; returns the time at which the host wants the step to
/// end, if it asks for that [s].
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
            vectors: vectors::of(&component, version.has_vectors()),
            component,
            update: None,
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
            self.logger.remark("tolerance is 0, which is taken as none: solver.tolerance holds");
        }
        Ok(())
    }

    /// End initialization mode. After a refusal the mode goes on: parameters can be corrected.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Refusal> {
        if let Some(tolerance) = self.tolerance {
            self.component.set_tolerance(tolerance)?;
        }
        self.component.initialize()?;
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

    /// Read Reals. On an error the array may be filled in part. An output that has no value in this state is NaN; all
    /// others are told, and a warning says why.
    pub fn get_real(&mut self, references: &[Reference], values: &mut [MaybeUninit<f64>]) -> Result<(), Refusal> {
        self.get_each_real(references, references.iter().zip(values))
    }

    /// [`Self::get_real`] of some of the references of a call.
    #[inline]
    pub(super) fn get_each_real<'a>(
        &mut self,
        references: &[Reference],
        values: impl Iterator<Item = (&'a Reference, &'a mut MaybeUninit<f64>)>,
    ) -> Result<(), Refusal> {
        let mut undefined = false;
        for (&reference, value) in values {
            may_get(self, reference, Kind::Real)?;
            let number = self.component.real(reference)?;
            undefined |= number.is_nan();
            value.write(number);
        }
        if undefined { self.warn(references, "value", Component::undefined) } else { Ok(()) }
    }

    /// The warning that names those variables of a call of which `why` tells that they have no value.
    #[cold]
    fn warn(
        &mut self,
        references: &[Reference],
        what: &'static str,
        why: impl Fn(&mut Component, Reference) -> Option<String>,
    ) -> Result<(), Refusal> {
        let mut undefined = Undefined::new(what);
        for &reference in references {
            if let Some(reason) = why(&mut self.component, reference) {
                let name = self.component.interface().get(reference).map_or("", |variable| &variable.name);
                undefined.add(name, reason);
            }
        }
        undefined.warning().map_or(Ok(()), Err)
    }

    /// Read Booleans, as 0 and 1 of the type `B`. On an error the array may be filled in part.
    pub fn get_boolean<B: From<bool>>(
        &mut self,
        references: &[Reference],
        values: &mut [MaybeUninit<B>],
    ) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values) {
            may_get(self, reference, Kind::Boolean)?;
            value.write(self.component.boolean(reference)?.into());
        }
        Ok(())
    }

    /// Read Enumerations, as numbers of the type `N` from 1 on. On an error the array may be filled in part.
    pub fn get_enumeration<N: From<i32>>(
        &mut self,
        references: &[Reference],
        values: &mut [MaybeUninit<N>],
    ) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values) {
            may_get(self, reference, Kind::Enumeration)?;
            value.write((self.component.item(reference)? as i32 + 1).into());
        }
        Ok(())
    }

    /// Set Reals, all or none.
    pub fn set_real(&mut self, references: &[Reference], values: &[f64]) -> Result<(), Refusal> {
        let mut tunes = false;
        for (&reference, &value) in references.iter().zip(values) {
            tunes |= may_set(self, reference, Kind::Real)? == Way::Tuned;
            self.component.check_real(reference, value)?;
        }
        self.component.check_together(references, values)?;
        if tunes {
            self.component.tune(references, values)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.component.take_real(reference, value)?;
        }
        Ok(())
    }

    /// Set Booleans, all or none.
    pub fn set_boolean(
        &mut self,
        references: &[Reference],
        values: impl Iterator<Item = bool> + Clone,
    ) -> Result<(), Refusal> {
        self.set(references, values, Kind::Boolean, Component::check_boolean, Component::set_boolean)
    }

    /// Set Enumerations by the numbers of their items, all or none.
    pub fn set_enumeration(
        &mut self,
        references: &[Reference],
        values: impl Iterator<Item = i64> + Clone,
    ) -> Result<(), Refusal> {
        let check = |component: &Component, reference, number| {
            component.check_text(reference, item(component, reference, number)?)
        };
        let set = |component: &mut Component, reference, number| {
            component.set_text(reference, item(component, reference, number)?)
        };
        self.set(references, values, Kind::Enumeration, check, set)
    }

    /// Check all values, then set all.
    #[inline]
    fn set<V>(
        &mut self,
        references: &[Reference],
        values: impl Iterator<Item = V> + Clone,
        kind: Kind,
        check: impl Fn(&Component, Reference, V) -> Result<(), Refused>,
        set: impl Fn(&mut Component, Reference, V) -> Result<(), Refused>,
    ) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values.clone()) {
            may_set(self, reference, kind)?;
            check(&self.component, reference, value)?;
        }
        for (&reference, value) in references.iter().zip(values) {
            set(&mut self.component, reference, value)?;
        }
        Ok(())
    }

    /// Refuse references that lead to no variable, in the words of the version; of a variable that has no derivatives the
    /// component tells why.
    fn must_exist<'a>(&self, mut references: impl Iterator<Item = &'a Reference>) -> Result<(), Refusal> {
        let interface = self.component.interface();
        let missing = references.find(|&&reference| interface.get(reference).is_none());
        missing.map_or(Ok(()), |&reference| of_kind(self, reference, Kind::Real).map(drop))
    }

    /// For each unknown the sum over the knowns of the partial derivative times the seed; NaN, with a warning, where it
    /// has none in this state.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        values: &mut [MaybeUninit<f64>],
    ) -> Result<(), Refusal> {
        self.must_exist(unknowns.iter().chain(knowns))?;
        let mut undefined = Vec::new();
        let mut report = |index: usize, value: f64| {
            values[index].write(value);
            if value.is_nan() {
                undefined.push(unknowns[index]);
            }
        };
        let is_initial = self.phase == Phase::Initialization;
        self.component.directional_derivative(is_initial, unknowns, knowns, seeds, &mut report)?;
        match undefined[..] {
            [] => Ok(()),
            _ => self.warn(&undefined, "derivative", Component::undefined_derivative),
        }
    }

    /// For each known the sum over the unknowns of the seed times the partial derivative; NaN, with a warning, where one
    /// of these has none in this state, or where the sum is beyond the largest number. A seed must be finite.
    pub fn adjoint_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        values: &mut [MaybeUninit<f64>],
    ) -> Result<(), Refusal> {
        self.must_exist(unknowns.iter().chain(knowns))?;
        if let Some((seed, unknown)) = seeds.iter().zip(unknowns).find(|(seed, _)| !seed.is_finite()) {
            let name = self.described(*unknown).map_or("", |(name, _)| name);
            return Err(Refusal::error(format!("seed of {name} = {}: must be finite", Decimal(*seed))));
        }
        let (mut undefined, mut overflow) = (Vec::new(), None);
        for (known, value) in knowns.iter().zip(values) {
            let mut sum = 0.0_f64;
            let mut add = |index: usize, derivative: f64| {
                sum += seeds[index] * derivative;
                if derivative.is_nan() && !undefined.contains(&unknowns[index]) {
                    undefined.push(unknowns[index]);
                }
            };
            let (is_initial, known_alone) = (self.phase == Phase::Initialization, std::slice::from_ref(known));
            self.component.directional_derivative(is_initial, unknowns, known_alone, &[1.0], &mut add)?;
            overflow = overflow.or_else(|| (!sum.is_finite()).then_some(*known));
            value.write(if sum.is_finite() { sum } else { f64::NAN });
        }
        match undefined[..] {
            [] => overflow.map_or(Ok(()), |known| {
                let name = self.described(known).map_or("", |(name, _)| name);
                Err(Refusal::warning(format!(
                    "the adjoint derivative along {name} is beyond the largest number, so NaN; take smaller seeds"
                )))
            }),
            _ => self.warn(&undefined, "derivative", Component::undefined_derivative),
        }
    }

    /// Time derivatives of outputs, each of its order. On an error the array may be filled in part. NaN, with a warning,
    /// where an output has none in this state.
    pub fn output_derivatives(
        &mut self,
        references: &[Reference],
        orders: &[i32],
        values: &mut [MaybeUninit<f64>],
    ) -> Result<(), Refusal> {
        self.must_exist(references.iter())?;
        let mut undefined = false;
        for ((&reference, &order), value) in references.iter().zip(orders).zip(values) {
            let rate = self.component.output_derivative(reference, order)?;
            undefined |= rate.is_nan();
            value.write(rate);
        }
        if undefined { self.warn(references, "derivative", Component::undefined_derivative) } else { Ok(()) }
    }

    /// Set time derivatives of inputs, each of its order, all or none.
    pub fn set_input_derivatives(
        &mut self,
        references: &[Reference],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), Refusal> {
        self.must_exist(references.iter())?;
        if self.usage.model_exchange {
            return Err(Refusal::error(
                "derivatives of inputs are for the steps of co-simulation; set values at each time",
            ));
        }
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            self.component.check_input_derivative(reference, order, value)?;
        }
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            self.component.set_input_derivative(reference, order, value)?;
        }
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
    /// With [`Usage::intermediate_update`], `pauses_left` counts the internal steps after which the step pauses, with its
    /// phase `Intermediate`: it goes on when this is called again with the rest of the step.
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
    pub fn warning(&mut self) -> Result<(), Refusal> {
        self.component.take_warning().map_or(Ok(()), |warning| Err(Refusal::warning(warning)))
    }
}
