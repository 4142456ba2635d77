//! The model: one mechanism with its present parameters, inputs and state, and its outputs on demand.
//!
//! In: a definition's text, values set by the host, steps. Out: values by reference. It must not know FMI's life cycle.
mod error;
mod motion;
mod outputs;

pub use crate::integrator::Statistics;
pub use error::ModelError;

use crate::definition::{Experiment, Mechanism, Range, Role};
use crate::reduced::{Reduced, ReductionError};
use crate::variables::{Causality, Kind, Quantity, Reference, Value, Variables};
use motion::{Folded, Memory, Motion};
use outputs::Cache;
use std::sync::Arc;

/// One mechanism with its parameters, inputs and state.
#[derive(Clone, Debug)]
pub struct Model {
    /// As read: what reset returns to.
    original: Arc<Original>,
    /// With the present parameters.
    mechanism: Mechanism,
    parameters: Vec<f64>,
    inputs: Vec<f64>,
    /// For the present parameters; none after one of them has changed.
    reduced: Option<Arc<Reduced>>,
    state: Option<State>,
}

/// What a definition gives, before any value is set.
#[derive(Debug)]
struct Original {
    mechanism: Mechanism,
    variables: Variables,
    ranges: Vec<(Range, Role)>,
    parameters: Vec<f64>,
    inputs: Vec<f64>,
    reduced: Arc<Reduced>,
}

/// The state of motion, with the memory of the integration.
#[derive(Clone, Debug)]
struct State {
    /// Length along the curve; on a closed one within its first turn.
    sigma: f64,
    sigma_dot: f64,
    /// Whole turns of a closed curve made so far.
    turns: f64,
    /// Sizes of the loads in the last step: those that the integration and the energy balance know.
    applied: Vec<f64>,
    /// Energy at the start, plus the work of changing sizes, less the energy lost since.
    reference: f64,
    memory: Memory,
    /// Right-hand side for the applied sizes, for the integration.
    folded: Folded,
    cache: Cache,
}

impl Model {
    /// Read a mechanism from the text of its `mechanism.json`, assemble it and trace its motion.
    ///
    /// # Errors
    /// What is wrong with the definition, or why it gives no mechanism.
    pub fn from_json(text: &str) -> Result<Self, ModelError> {
        let mechanism = Mechanism::from_json(text)?;
        let variables = Variables::new(&mechanism)?;
        let (mut ranges, mut parameters) = (Vec::new(), Vec::new());
        mechanism.clone().parameters(&mut |p, value| {
            ranges.push((p.range, p.role));
            parameters.push(*value);
        });
        let starts = variables.list().iter().filter(|v| v.causality == Causality::Input);
        let inputs: Vec<f64> = starts.map(|v| if let Some(Value::Real(x)) = v.start { x } else { 0.0 }).collect();
        let reduced = Arc::new(Reduced::new(&mechanism)?);
        let original = Original {
            mechanism: mechanism.clone(),
            variables,
            ranges,
            parameters: parameters.clone(),
            inputs: inputs.clone(),
            reduced: Arc::clone(&reduced),
        };
        let mut model =
            Self { original: Arc::new(original), mechanism, parameters, inputs, reduced: Some(reduced), state: None };
        model.state()?;
        model.state = None;
        Ok(model)
    }

    /// Name of the mechanism, the FMU's modelName and modelIdentifier.
    pub fn name(&self) -> &str {
        &self.original.mechanism.name
    }

    /// One-line description of the mechanism.
    pub fn description(&self) -> &str {
        &self.original.mechanism.description
    }

    /// What the host can see.
    pub fn variables(&self) -> &Variables {
        &self.original.variables
    }

    /// Default experiment.
    pub fn experiment(&self) -> Experiment {
        self.original.mechanism.experiment
    }

    /// The reduced model for the present parameters.
    ///
    /// # Errors
    /// Why the present parameters give none.
    pub fn reduced(&mut self) -> Result<&Arc<Reduced>, ModelError> {
        if self.reduced.is_none() {
            self.reduced = Some(Arc::new(Reduced::new(&self.mechanism)?));
        }
        self.reduced.as_ref().ok_or(ModelError::NotInitialised)
    }

    /// Present value of a Real: output, input or parameter. Computed when first read in a state.
    ///
    /// # Errors
    /// No Real has this reference, or the present parameters give no mechanism.
    pub fn real(&mut self, reference: Reference) -> Result<f64, ModelError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(i)) => Ok(self.parameters[i]),
            Some(Quantity::Input(i)) => Ok(self.inputs[i]),
            Some(Quantity::Output(output)) => {
                self.state()?;
                let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) else {
                    return Err(ModelError::NotInitialised);
                };
                let name = || self.original.variables.list()[reference as usize].name.clone();
                match state.output(reduced, &self.inputs, output) {
                    Ok(value) if value.is_finite() => Ok(value),
                    Ok(_) => Err(ModelError::Overflow { name: name() }),
                    Err(at) => Err(ModelError::Table { name: name(), position: reduced.curve().describe(at.sigma) }),
                }
            }
            None => Err(self.no_such(reference, "Real")),
        }
    }

    /// Whether [`Self::set_real`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Real has this reference, it is an output, or the value is out of range.
    pub fn check_real(&self, reference: Reference, value: f64) -> Result<(), ModelError> {
        let name = || self.original.variables.list()[reference as usize].name.clone();
        let range = match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(i)) => self.original.ranges[i].0,
            Some(Quantity::Input(_)) => Range::Finite,
            Some(Quantity::Output(_)) => return Err(ModelError::Output { name: name() }),
            None => return Err(self.no_such(reference, "Real")),
        };
        if range.contains(value) {
            return Ok(());
        }
        Err(ModelError::Value { name: name(), value, allowed: range.text() })
    }

    /// Set an input or a parameter. After a step, a parameter takes effect with the next initialisation only.
    ///
    /// # Errors
    /// As [`Self::check_real`].
    pub fn set_real(&mut self, reference: Reference, value: f64) -> Result<(), ModelError> {
        self.check_real(reference, value)?;
        match self.original.variables.quantity(reference) {
            Some(Quantity::Input(i)) if self.inputs[i].to_bits() != value.to_bits() => {
                self.inputs[i] = value;
                if let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) {
                    state.cache.set(i, reduced.loading().inputs.len(), value);
                }
            }
            Some(Quantity::Parameter(i)) if self.parameters[i].to_bits() != value.to_bits() => {
                self.parameters[i] = value;
                let mut place = 0;
                self.mechanism.parameters(&mut |_, v| {
                    if place == i {
                        *v = value;
                    }
                    place += 1;
                });
                self.state = None;
                if matches!(self.original.ranges[i].1, Role::Geometry | Role::Inertia | Role::Load) {
                    self.reduced = None;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Present value of a Boolean.
    ///
    /// # Errors
    /// No Boolean has this reference.
    pub fn boolean(&mut self, reference: Reference) -> Result<bool, ModelError> {
        Err(self.no_such(reference, "Boolean"))
    }

    /// Whether [`Self::set_boolean`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Boolean has this reference.
    pub fn check_boolean(&self, reference: Reference, _value: bool) -> Result<(), ModelError> {
        Err(self.no_such(reference, "Boolean"))
    }

    /// Set a Boolean input or parameter.
    ///
    /// # Errors
    /// As [`Self::check_boolean`].
    pub fn set_boolean(&mut self, reference: Reference, value: bool) -> Result<(), ModelError> {
        self.check_boolean(reference, value)
    }

    /// Override the relative tolerance of the integration; the same as setting solver.tolerance.
    ///
    /// # Errors
    /// The tolerance is out of range.
    pub fn set_tolerance(&mut self, tolerance: f64) -> Result<(), ModelError> {
        match self.original.variables.find("solver.tolerance") {
            Some(reference) => self.set_real(reference, tolerance),
            None => Ok(()),
        }
    }

    /// Put the mechanism at its start under the present parameters and inputs.
    ///
    /// # Errors
    /// The present parameters give no mechanism, or the start cannot be reached.
    pub fn initialize(&mut self) -> Result<(), ModelError> {
        self.state = None;
        self.state().map(|_| ())
    }

    /// Advance by exactly `h` [s], > 0, under the present inputs. On an error the state is what it was.
    ///
    /// # Errors
    /// Not initialised, h out of range, the integration stopped, or the travel ended.
    pub fn step(&mut self, h: f64) -> Result<(), ModelError> {
        if !(h.is_finite() && h > 0.0) {
            return Err(ModelError::StepSize { h });
        }
        let tolerance = self.mechanism.solver.tolerance;
        let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised);
        };
        state.apply(reduced, &self.inputs);
        let mut y = [state.sigma, state.sigma_dot];
        let mut memory = state.memory;
        let mut motion = Motion { reduced, sizes: &state.applied, turns: state.turns, folded: &mut state.folded };
        let lost = memory.advance(&mut motion, &mut y, h, tolerance).map_err(ModelError::Integration)?;
        let (first, last) = reduced.curve().range();
        match reduced.period() {
            Some(period) if !(first..last).contains(&y[0]) => {
                let around = ((y[0] - first) / period).floor();
                y[0] -= around * period;
                state.turns += around;
                // The panel in memory is counted on over whole turns; sigma no longer is.
                state.folded = Folded::default();
                state.cache.recount();
            }
            None if !(first..=last).contains(&y[0]) => {
                let position = reduced.curve().describe(y[0]);
                return Err(ModelError::Travel { position });
            }
            _ => {}
        }
        [state.sigma, state.sigma_dot] = y;
        state.memory = memory;
        state.reference -= lost;
        state.cache.forget();
        Ok(())
    }

    /// Back to what [`Self::from_json`] gave.
    pub fn reset(&mut self) {
        self.mechanism = self.original.mechanism.clone();
        self.parameters.clone_from(&self.original.parameters);
        self.inputs.clone_from(&self.original.inputs);
        self.reduced = Some(Arc::clone(&self.original.reduced));
        self.state = None;
    }

    /// Right-hand-side evaluations and accepted and rejected integration steps since initialisation.
    pub fn statistics(&self) -> Statistics {
        self.state.as_ref().map_or_else(Statistics::default, |s| s.memory.statistics())
    }

    /// The state, put at the start if there is none yet.
    fn state(&mut self) -> Result<&mut State, ModelError> {
        if self.state.is_none() {
            let reduced = Arc::clone(self.reduced()?);
            self.state = Some(State::at_start(&reduced, &self.mechanism, &self.inputs)?);
        }
        self.state.as_mut().ok_or(ModelError::NotInitialised)
    }

    fn no_such(&self, reference: Reference, kind: &'static str) -> ModelError {
        debug_assert!(self.original.variables.get(reference).is_none_or(|v| v.kind == Kind::Real));
        ModelError::Reference { reference, kind, count: self.original.variables.list().len() }
    }
}

impl State {
    /// The state that the definition states.
    fn at_start(reduced: &Reduced, mechanism: &Mechanism, inputs: &[f64]) -> Result<Self, ModelError> {
        let start = &mechanism.start;
        let linkage = reduced.linkage();
        let (coordinate, value, name, quantity) = match (&start.body, &start.joint) {
            (Some(body), _) => {
                let (carrier, angle) = linkage.carrier(mechanism, body).unwrap_or((0, 0.0));
                let turn = linkage.bodies[carrier].turn;
                let value = start.angle.unwrap_or(0.0) - angle - linkage.bodies[carrier].offset;
                (turn, value, body, "angle")
            }
            (None, Some(joint)) => {
                let place = linkage.coordinates[linkage.turns..].iter().position(|c| c == joint);
                (place.map(|i| i + linkage.turns), start.position.unwrap_or(0.0), joint, "position")
            }
            (None, None) => (None, 0.0, &mechanism.name, "angle"),
        };
        let variable = format!("{name}.start_{quantity}");
        let coordinate = coordinate.ok_or_else(|| {
            ModelError::Definition(crate::definition::DefinitionError::Unknown {
                key: "start".into(),
                name: name.clone(),
                allowed: format!("state one of the coordinates {}", linkage.coordinates.join(", ")),
            })
        })?;
        let (sigma, turns) = reduced.find(coordinate, value, &variable)?;
        let mut sigma_dot = 0.0;
        if start.speed != 0.0 {
            // From the table, which is as good where branches cross. Nearer to a toggle than some 1e-13 rad, where the
            // slope is below 1e-6, rounding decides what it is.
            let table = reduced.coordinates();
            let table = table.map_err(|at| ModelError::Table {
                name: variable.clone(),
                position: reduced.curve().describe(at.sigma),
            })?;
            let slope = table.value(table.spot(sigma), 3 * coordinate + 1);
            if slope.abs() * reduced.scale() < 1e-6 {
                let name = format!("{name}.start_speed");
                return Err(ReductionError::StartSpeed { name, value: start.speed }.into());
            }
            sigma_dot = start.speed / slope;
        }
        let mut state = Self {
            sigma,
            sigma_dot,
            turns,
            applied: reduced.sizes(inputs),
            reference: 0.0,
            memory: Memory::new(reduced),
            folded: Folded::default(),
            cache: Cache::new(reduced, inputs),
        };
        state.reference = state.kinetic() + state.load_potential(reduced);
        Ok(state)
    }

    /// Take up inputs that have changed since the last step: the change of the loads' potential is work from outside.
    fn apply(&mut self, reduced: &Reduced, inputs: &[f64]) {
        let loads = reduced.loading().inputs.len();
        let mut work = 0.0;
        let mut changed = false;
        for (load, input) in inputs[..loads].iter().enumerate() {
            if self.applied[load].to_bits() != input.to_bits() {
                work -= (input - self.applied[load]) * self.displacement(reduced, load);
                changed = true;
            }
        }
        if changed {
            self.reference += work;
            self.applied[..loads].copy_from_slice(&inputs[..loads]);
            self.memory.refresh();
            self.folded = Folded::default();
        }
    }
}
