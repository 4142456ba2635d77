//! Values of variables, read and set by reference.
//!
//! In: references, values from the host. Out: values, or the reason of a refusal. It must not know how a step is made.
use super::{Formulation, Model, ModelError};
use crate::mechanism::definition::{Method, Range};
use crate::mechanism::designs::decides_reduced;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::network::is_engaged;
use crate::mechanism::quantity::{Output, Quantity};
use crate::variables::Reference;
use std::sync::Arc;

impl Model {
    /// Present value of a Real: output, input or parameter. Computed when first read in a state. NaN for an output that
    /// has no value in this state, of which [`Self::undefined`] tells why.
    ///
    /// # Errors
    /// No Real has this reference, or the present parameters give no mechanism.
    #[inline]
    pub fn real(&mut self, reference: Reference) -> Result<f64, ModelError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(i)) => Ok(self.parameter_values.parameters[i]),
            Some(Quantity::Input(i)) => Ok(self.inputs.reals[i]),
            Some(Quantity::Output(Output::Drift)) if self.exchange.is_some() => Ok(f64::NAN),
            Some(Quantity::Output(output)) => {
                if self.state.is_none() {
                    self.state()?;
                }
                let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) else {
                    return Err(ModelError::NotInitialised);
                };
                let value = match state {
                    Formulation::Reduced(motion) => motion.output(reduced, &self.inputs, output),
                    Formulation::RigidFem(motion) => motion.output(reduced, &self.inputs, output),
                };
                Ok(value.ok().filter(|value| value.is_finite()).unwrap_or(f64::NAN))
            }
            Some(Quantity::State(order)) => self.state_of_motion(order),
            Some(Quantity::Indicator(indicator)) => self.indicator(indicator),
            _ => Err(self.no_such(reference, "Real")),
        }
    }

    /// Present values of the outputs that were read together last, each as [`Self::real`]; whether each of them has a
    /// value. None if these are not their references, or the motion is not that of the reduced model.
    #[inline]
    pub fn reread<'v>(&mut self, references: &[Reference], values: impl FnOnce() -> &'v mut [f64]) -> Option<bool> {
        match (&mut self.state, &self.reduced, self.exchange) {
            (Some(Formulation::Reduced(motion)), Some(reduced), None) => {
                let together = self.plan.of(references)?;
                Some(motion.outputs(reduced, &self.inputs).fill(together, values()))
            }
            _ => None,
        }
    }

    /// Present values of several Reals in their order, each as [`Self::real`]: outputs share one view of the state.
    ///
    /// # Errors
    /// As [`Self::real`]; the values before are given.
    #[inline]
    pub fn reals(&mut self, references: &[Reference], give: impl FnMut(f64)) -> Result<(), ModelError> {
        if let (Some(Formulation::Reduced(motion)), Some(reduced), None) =
            (&mut self.state, &self.reduced, self.exchange)
            && let Some(together) = self.plan.of(references)
        {
            motion.outputs(reduced, &self.inputs).values(&together.outputs, give);
            return Ok(());
        }
        self.other_reals(references, give)
    }

    /// [`Self::reals`] that were not read together before: the next time they may be.
    ///
    /// # Errors
    /// As [`Self::reals`].
    #[inline]
    pub fn other_reals(&mut self, references: &[Reference], mut give: impl FnMut(f64)) -> Result<(), ModelError> {
        let variables = &self.original.variables;
        let mut done = 0;
        if let (Some(Formulation::Reduced(motion)), Some(reduced), None) =
            (&mut self.state, &self.reduced, self.exchange)
            && references.iter().any(|r| matches!(variables.quantity_of(*r), Some(Quantity::Output(_))))
        {
            let (mut outputs, inputs) = (motion.outputs(reduced, &self.inputs), &self.inputs.reals);
            self.plan.learn(references, variables, reduced);
            for &reference in references {
                give(match variables.quantity_of(reference) {
                    Some(Quantity::Output(output)) => outputs.value(output),
                    Some(&Quantity::Input(i)) => inputs[i],
                    Some(&Quantity::Parameter(i)) => self.parameter_values.parameters[i],
                    _ => break,
                });
                done += 1;
            }
        }
        for &reference in &references[done..] {
            give(self.real(reference)?);
        }
        Ok(())
    }

    /// Whether [`Self::set_real`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Real has this reference, it is an output, or the value is out of range.
    pub fn check_real(&self, reference: Reference, value: f64) -> Result<(), ModelError> {
        let name = || self.name_of(reference);
        let range = match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(i)) => match self.parameter_values.expressions().of(i) {
                Some(calculated) => {
                    let names = calculated.bases.iter().map(|&base| self.parameter_name(base)).collect();
                    return Err(ModelError::Calculated { name: name(), text: calculated.text().to_owned(), names });
                }
                None => self.original.ranges[i].0,
            },
            Some(Quantity::Input(_)) => Range::Finite,
            Some(Quantity::Output(_) | Quantity::State(_) | Quantity::Indicator(_)) => {
                return Err(ModelError::Output { name: name() });
            }
            _ => return Err(self.no_such(reference, "Real")),
        };
        if range.contains(value) {
            return Ok(());
        }
        Err(ModelError::Value { name: name(), value, allowed: range.text() })
    }

    /// Whether the expressions have values with all of these set, each of which [`Self::check_real`] accepts; changes
    /// nothing.
    ///
    /// # Errors
    /// A parameter that follows from these is out of range.
    pub fn check_together(&self, references: &[Reference], values: &[f64]) -> Result<(), ModelError> {
        let expressions = self.parameter_values.expressions();
        if expressions.is_empty() {
            return Ok(());
        }
        let mut parameters: Option<Vec<f64>> = None;
        let mut set = Vec::new();
        for (&reference, &value) in references.iter().zip(values) {
            if let Some(Quantity::Parameter(i)) = self.original.variables.quantity(reference) {
                parameters.get_or_insert_with(|| self.parameter_values.parameters.clone())[i] = value;
                set.push((self.name_of(reference), value));
            }
        }
        let Some(mut parameters) = parameters else { return Ok(()) };
        expressions.compute(&mut parameters);
        expressions.fault(&parameters).map_or(Ok(()), |fault| Err(ModelError::Follows { set, fault: Box::new(fault) }))
    }

    /// Set an input or a parameter. After a step, a parameter takes effect with the next initialisation only.
    ///
    /// # Errors
    /// As [`Self::check_real`] and [`Self::check_together`].
    pub fn set_real(&mut self, reference: Reference, value: f64) -> Result<(), ModelError> {
        self.check_real(reference, value)?;
        self.check_together(&[reference], &[value])?;
        self.take_real(reference, value)
    }

    /// [`Self::set_real`] of one of several values that were checked together.
    ///
    /// # Errors
    /// As [`Self::check_real`].
    pub fn take_real(&mut self, reference: Reference, value: f64) -> Result<(), ModelError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Input(i)) if self.inputs.set(i, value) => {
                self.forget_start();
                if let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) {
                    motion.state.fill_accumulator(reduced, i, value);
                }
            }
            Some(Quantity::Parameter(i)) if self.parameter_values.parameters[i].to_bits() != value.to_bits() => {
                let is_part = self.reduced.as_ref().is_some_and(|reduced| reduced.is_part());
                let (ranges, mut decides) = (&self.original.ranges, false);
                let changed = |i: usize| decides |= decides_reduced(ranges[i].1, is_part);
                Arc::make_mut(&mut self.parameter_values).set(i, value, changed);
                self.state = None;
                if decides {
                    self.reduced = None;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Give a start speed the value 0 whatever decides it, for facts about the mechanism at rest.
    pub(crate) fn start_at_rest(&mut self, speed: Reference) {
        if let Some(Quantity::Parameter(i)) = self.original.variables.quantity(speed) {
            let values = Arc::make_mut(&mut self.parameter_values);
            values.parameters[i] = 0.0;
            values.changed();
            self.state = None;
        }
    }

    /// Present value of a Boolean.
    ///
    /// # Errors
    /// No Boolean has this reference, or the present parameters give no mechanism.
    pub fn boolean(&mut self, reference: Reference) -> Result<bool, ModelError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Flag(i)) => Ok(self.parameter_values.flags[i]),
            Some(Quantity::Lock(i)) => Ok(self.inputs.locks[i]),
            Some(Quantity::Prescribed) => Ok(self.inputs.prescribes()),
            Some(Quantity::PressureLock(lock)) => {
                let reduced = Arc::clone(self.reduced()?);
                let state = self.state()?.along_curve();
                let (network, memory) = (reduced.loading().network.as_ref(), state.memory.network_values());
                Ok(network.zip(memory).is_some_and(|(network, memory)| is_engaged(&network.laws, memory, lock)))
            }
            Some(Quantity::Engaged(lock)) => {
                let is_on = self.inputs.locks[lock];
                let (state, reduced) = self.shown()?;
                Ok(is_on && state.has_engaged(reduced, lock))
            }
            Some(Quantity::AtStop(stop)) => {
                let (state, reduced) = self.shown()?;
                Ok(state.at_stop(reduced, stop))
            }
            Some(quantity @ (Quantity::SelfLocking(_) | Quantity::Sticking)) => {
                self.state()?;
                let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) else {
                    return Err(ModelError::NotInitialised);
                };
                let motion = match state {
                    Formulation::Reduced(motion) => &mut **motion,
                    Formulation::RigidFem(motion) => &mut motion.rigid,
                };
                Ok(match quantity {
                    Quantity::SelfLocking(drive) => motion.self_locking(reduced, &self.inputs, drive),
                    _ => motion.sticking(reduced, &self.inputs),
                })
            }
            _ => Err(self.no_such(reference, "Boolean")),
        }
    }

    /// Whether [`Self::set_boolean`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Boolean has this reference, or it is an output.
    pub fn check_boolean(&self, reference: Reference, _value: bool) -> Result<(), ModelError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Flag(_) | Quantity::Lock(_) | Quantity::Prescribed) => Ok(()),
            Some(Quantity::AtStop(_) | Quantity::Engaged(_) | Quantity::SelfLocking(_) | Quantity::Sticking) => {
                Err(ModelError::Output { name: self.name_of(reference) })
            }
            _ => Err(self.no_such(reference, "Boolean")),
        }
    }

    /// Set a Boolean input or parameter. After a step, a parameter takes effect with the next initialisation only.
    ///
    /// # Errors
    /// As [`Self::check_boolean`].
    pub fn set_boolean(&mut self, reference: Reference, value: bool) -> Result<(), ModelError> {
        self.check_boolean(reference, value)?;
        let quantity = self.original.variables.quantity(reference);
        if quantity == Some(Quantity::Prescribed) {
            self.adopt_prescribed();
        }
        let lock = match quantity {
            Some(Quantity::Lock(i)) => Some(i),
            Some(Quantity::Prescribed) => self.inputs.locks.len().checked_sub(1),
            _ => None,
        };
        match quantity {
            _ if lock.is_some_and(|lock| self.inputs.locks[lock] != value) => {
                lock.into_iter().for_each(|lock| self.inputs.locks[lock] = value);
                self.forget_start();
            }
            Some(Quantity::Flag(i)) if self.parameter_values.flags[i] != value => {
                let values = Arc::make_mut(&mut self.parameter_values);
                values.flags[i] = value;
                values.changed();
                (self.state, self.reduced) = (None, None);
            }
            _ => {}
        }
        Ok(())
    }

    /// Whether inputs decide where the mechanism starts.
    pub fn starts_by_inputs(&self) -> bool {
        self.parameter_values.starts_by_inputs()
    }

    /// Before the initialisation, an input may be what places the mechanism.
    fn forget_start(&mut self) {
        if !self.is_placed && self.parameter_values.starts_by_inputs() {
            self.state = None;
        }
    }

    /// Present item of an Enumeration, by its index from 0 on.
    ///
    /// # Errors
    /// No Enumeration has this reference, or the present parameters give no mechanism.
    pub fn item(&mut self, reference: Reference) -> Result<usize, ModelError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Method) => Ok(self.parameter_values.method() as usize),
            Some(Quantity::Contact) => {
                let contact = self.shown()?.0.contact;
                Ok(match (contact.arrival(), contact.at_rest(), contact.touching() == BumperSet::EMPTY) {
                    (Some(_), ..) => 4,
                    (None, Some(_), _) if contact.is_latched() => 3,
                    (None, Some(_), _) => 2,
                    (None, None, false) => 1,
                    (None, None, true) => 0,
                })
            }
            _ => Err(self.no_such(reference, "Enumeration")),
        }
    }

    /// Whether [`Self::set_text`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Enumeration has this reference, it is computed, or the text is none of its words.
    pub fn check_text(&self, reference: Reference, value: &str) -> Result<(), ModelError> {
        self.method_of(reference, value).map(|_| ())
    }

    /// Set an Enumeration by the name of an item. After a step, it takes effect with the next initialisation only.
    ///
    /// # Errors
    /// As [`Self::check_text`].
    pub fn set_text(&mut self, reference: Reference, value: &str) -> Result<(), ModelError> {
        let method = self.method_of(reference, value)?;
        if self.parameter_values.method() != method {
            Arc::make_mut(&mut self.parameter_values).set_method(method);
            self.state = None;
            self.inputs.signal.clear();
        }
        Ok(())
    }

    fn method_of(&self, reference: Reference, value: &str) -> Result<Method, ModelError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Method) => Method::of_word(value).ok_or_else(|| {
                let words = Method::ALL.map(|method| format!("\"{}\"", method.word()));
                ModelError::Text { name: self.name_of(reference), value: value.into(), allowed: words.join(" or ") }
            }),
            Some(Quantity::Contact) => Err(ModelError::Output { name: self.name_of(reference) }),
            _ => Err(self.no_such(reference, "Enumeration")),
        }
    }

    /// Name of a variable; empty if there is none.
    pub(super) fn name_of(&self, reference: Reference) -> String {
        self.original.variables.get(reference).map_or_else(String::new, |v| v.name.clone())
    }

    pub(super) fn no_such(&self, reference: Reference, kind: &'static str) -> ModelError {
        let list = self.original.variables.list();
        let own = list.get(reference as usize).map(|variable| (variable.name.clone(), variable.kind.word()));
        ModelError::Reference { reference, own, kind, count: list.len() }
    }
}
