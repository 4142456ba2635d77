//! Variables of a model by reference: values, and what may be set.
//!
//! In: references, values from the host. Out: values; a refusal by name that changes nothing. It must not know how a
//! value is computed.
use super::{HostInputs, Kind, Model, Original, Parameters, Quantity};
use crate::definition::{ABOVE_VACUUM, is_pressure};
use crate::error::HydraulicsError;
use foundation::format::{About, DefinitionError, Experiment};
use foundation::variables::{Reference, Value, Variable, Variables};
use std::sync::Arc;

impl<K: Kind> Model<K> {
    /// Model of a checked definition.
    ///
    /// # Errors
    /// Two variables of one name.
    pub fn new(mut definition: K::Definition) -> Result<Self, HydraulicsError> {
        let (list, quantities) = K::variables(&definition);
        let start = |(quantity, variable): (&Quantity<K::Output>, &Variable)| match (quantity, &variable.start) {
            (Quantity::Input(_), Some(Value::Real(start))) => Some(*start),
            _ => None,
        };
        let starts: Vec<f64> = quantities.iter().zip(&list).filter_map(start).collect();
        let inputs = K::Inputs::constant(&starts);
        let variables = Variables::new(K::about(&definition).0, list, quantities)
            .map_err(|twice| DefinitionError::key(twice.0, "two variables have this name; rename an element"))?;
        let mut ranges = Vec::new();
        K::parameters(&mut definition, &mut |parameter, _| ranges.push((parameter.range, parameter.role)));
        let parameters = Arc::new(Parameters::new(definition));
        let cache = K::cache(&parameters.laws);
        let original =
            Arc::new(Original { parameters: Arc::clone(&parameters), variables, ranges, inputs: inputs.clone() });
        Ok(Self { original, parameters, inputs, state: None, cache, warnings: K::Warnings::default() })
    }

    /// Name of the model, the FMU's modelName and modelIdentifier.
    pub fn name(&self) -> &str {
        K::about(&self.original.parameters.definition).0
    }

    /// Author, copyright and licence.
    pub fn about(&self) -> &About {
        K::about(&self.original.parameters.definition).1
    }

    /// One-line description of the model.
    pub fn description(&self) -> &str {
        K::about(&self.original.parameters.definition).2
    }

    /// Default experiment.
    pub fn experiment(&self) -> Experiment {
        K::about(&self.original.parameters.definition).3
    }

    /// The variables that the host sees.
    pub fn variables(&self) -> &Variables<Quantity<K::Output>> {
        &self.original.variables
    }

    /// Present value of a Real. Computed when first read in a state. NaN for an output beyond the range of numbers.
    ///
    /// # Errors
    /// No Real has this reference, or the present parameters give no start.
    #[inline]
    pub fn real(&mut self, reference: Reference) -> Result<f64, HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(index)) => Ok(self.parameters.values[index]),
            Some(Quantity::Input(index)) => Ok(self.inputs.values()[index]),
            Some(Quantity::Output(output)) => {
                let value = self.output(output)?;
                Ok(if value.is_finite() { value } else { f64::NAN })
            }
            _ => Err(self.no_such(reference, "Real")),
        }
    }

    /// Whether [`Self::set_real`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Real has this reference, it is an output, or the value is out of range.
    pub fn check_real(&self, reference: Reference, value: f64) -> Result<(), HydraulicsError> {
        let range = match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(index)) => Some(self.original.ranges[index].0),
            Some(Quantity::Input(index)) => K::range(&self.parameters.laws, index),
            Some(Quantity::Output(_)) => return Err(HydraulicsError::Output { name: self.name_of(reference) }),
            _ => return Err(self.no_such(reference, "Real")),
        };
        let ambient = K::ambient(&self.parameters.laws);
        if range.map_or_else(|| is_pressure(value, ambient), |range| range.contains(value)) {
            return Ok(());
        }
        let allowed = range
            .map_or_else(|| format!("{ABOVE_VACUUM}; fluid.ambient_pressure is {ambient} Pa"), |range| range.text());
        Err(HydraulicsError::Value { name: self.name_of(reference), value, allowed })
    }

    /// Set an input or a parameter. After a step, a parameter takes effect with the next initialisation only.
    ///
    /// # Errors
    /// As [`Self::check_real`].
    pub fn set_real(&mut self, reference: Reference, value: f64) -> Result<(), HydraulicsError> {
        self.check_real(reference, value)?;
        match self.original.variables.quantity(reference) {
            Some(Quantity::Input(index)) => {
                let same = self.inputs.values()[index].to_bits() == value.to_bits();
                self.inputs.set(index, value);
                if !same {
                    K::input_changed(self, index);
                }
            }
            Some(Quantity::Parameter(index)) if self.set_parameter(index, value) => self.state = None,
            _ => {}
        }
        Ok(())
    }

    /// Set a parameter; returns whether it had another value.
    fn set_parameter(&mut self, index: usize, value: f64) -> bool {
        let is_other = self.parameters.values[index].to_bits() != value.to_bits();
        if is_other {
            let parameters = Arc::make_mut(&mut self.parameters);
            parameters.values[index] = value;
            parameters.update();
            K::clear(&mut self.cache);
        }
        is_other
    }

    /// Whether a lock is engaged.
    ///
    /// # Errors
    /// No Boolean has this reference, or the present parameters give no start.
    pub fn boolean(&mut self, reference: Reference) -> Result<bool, HydraulicsError> {
        let Some(Quantity::Lock(index)) = self.original.variables.quantity(reference) else {
            return Err(self.no_such(reference, "Boolean"));
        };
        self.started()?;
        self.state.as_ref().map(|state| K::lock(state, index)).ok_or(HydraulicsError::NotInitialised)
    }

    /// Whether several Reals may be set together: always, if each may be set.
    ///
    /// # Errors
    /// None.
    pub fn check_together(&self, _references: &[Reference], _values: &[f64]) -> Result<(), HydraulicsError> {
        Ok(())
    }

    /// [`Self::set_real`] of one of several values.
    ///
    /// # Errors
    /// As [`Self::set_real`].
    pub fn take_real(&mut self, reference: Reference, value: f64) -> Result<(), HydraulicsError> {
        self.set_real(reference, value)
    }

    /// Whether [`Self::set_boolean`] would accept this value.
    ///
    /// # Errors
    /// No Boolean can be set.
    pub fn check_boolean(&self, reference: Reference, _value: bool) -> Result<(), HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Lock(_)) => Err(HydraulicsError::Output { name: self.name_of(reference) }),
            _ => Err(self.no_such(reference, "Boolean")),
        }
    }

    /// Set a Boolean.
    ///
    /// # Errors
    /// No Boolean can be set.
    pub fn set_boolean(&mut self, reference: Reference, value: bool) -> Result<(), HydraulicsError> {
        self.check_boolean(reference, value)
    }

    /// Present item of an Enumeration, by its index from 0 on.
    ///
    /// # Errors
    /// No Enumeration has this reference.
    pub fn item(&mut self, reference: Reference) -> Result<usize, HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Mode) => Ok(K::mode(&self.parameters.definition)),
            _ => Err(self.no_such(reference, "Enumeration")),
        }
    }

    /// Give tunable parameters these values, which [`Self::check_real`] accepts, and leave the motion as it is. Only
    /// numbers of the integration are tunable.
    ///
    /// # Errors
    /// None.
    pub fn tune(&mut self, references: &[Reference], values: &[f64]) -> Result<(), HydraulicsError> {
        for (&reference, &value) in references.iter().zip(values) {
            if let Some(Quantity::Parameter(index)) = self.original.variables.quantity(reference) {
                self.set_parameter(index, value);
            }
        }
        Ok(())
    }

    /// Whether [`Self::set_text`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Enumeration has this reference, or the text is none of its words.
    pub fn check_text(&self, reference: Reference, value: &str) -> Result<(), HydraulicsError> {
        self.mode_of(reference, value).map(|_| ())
    }

    /// Set an Enumeration by the name of an item. After a step, it takes effect with the next initialisation only.
    ///
    /// # Errors
    /// As [`Self::check_text`].
    pub fn set_text(&mut self, reference: Reference, value: &str) -> Result<(), HydraulicsError> {
        let mode = self.mode_of(reference, value)?;
        if K::mode(&self.parameters.definition) != mode {
            K::set_mode(&mut Arc::make_mut(&mut self.parameters).definition, mode);
            self.state = None;
            K::clear(&mut self.cache);
        }
        Ok(())
    }

    fn mode_of(&self, reference: Reference, value: &str) -> Result<usize, HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Mode) => K::MODES.iter().position(|word| *word == value).ok_or_else(|| {
                let words: Vec<String> = K::MODES.iter().map(|word| format!("\"{word}\"")).collect();
                let name = self.name_of(reference);
                HydraulicsError::Text { name, value: value.into(), allowed: words.join(" or ") }
            }),
            _ => Err(self.no_such(reference, "Enumeration")),
        }
    }

    /// Override the relative tolerance of the integration; the same as setting solver.tolerance.
    ///
    /// # Errors
    /// The tolerance is out of range.
    pub fn set_tolerance(&mut self, tolerance: f64) -> Result<(), HydraulicsError> {
        match self.original.variables.find("solver.tolerance") {
            Some(reference) => self.set_real(reference, tolerance),
            None => Ok(()),
        }
    }

    /// A warning that came up since the last call; None if there is none.
    #[inline]
    pub fn take_warning(&mut self) -> Option<String> {
        K::take_warning(self)
    }

    /// Back to the parameters and inputs of the definition, not initialised.
    pub fn reset(&mut self) {
        self.parameters = Arc::clone(&self.original.parameters);
        self.inputs.copy_from(&self.original.inputs);
        self.clear_motion();
    }

    /// Why an output has no value in the present state; None if it has one.
    #[cold]
    pub fn undefined(&mut self, reference: Reference) -> Option<String> {
        let Some(Quantity::Output(output)) = self.original.variables.quantity(reference) else { return None };
        let value = self.output(output).ok()?;
        let text = "the value exceeds the largest number, 1.8e308; check the values of inputs and parameters";
        (!value.is_finite()).then(|| text.to_owned())
    }
}
