//! What the models of an actuator and of a network share: parameters, variables by reference, derivatives, snapshots.
//!
//! In: a kind of model. Out: the answers of a model of this kind to a host. It must not know any law, nor how a step is
//! made.
mod derivatives;
mod host_inputs;
mod snapshot;
mod values;

use super::error::HydraulicsError;
pub use derivatives::{Differentiable, INPUT_ORDER, OUTPUT_ORDER};
use foundation::codec::record::{Damaged, Record};
use foundation::format::{About, DefinitionError, Experiment, Range, Role, Visit};
use foundation::variables::{Reference, Variable, Variables};
pub use host_inputs::{HostInputs, SPEED_ORDER};
pub use snapshot::Snapshot;
use std::fmt::Debug;
use std::sync::Arc;

/// Quantity of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity<O> {
    /// A Real that the host sets between steps, by its index.
    Input(usize),
    /// A number of the definition, by its index among the parameters.
    Parameter(usize),
    /// What a step does with the foreseen motion: `coupling.mode`.
    Mode,
    /// Computed from the state.
    Output(O),
    /// Whether a lock is engaged.
    Lock(usize),
}

/// A kind of hydraulic model.
pub trait Kind: Clone + Debug + PartialEq + Send + Sync + 'static {
    /// Name of the kind in the hashes of snapshots.
    const NAME: &'static str;
    /// Version of the record of a snapshot.
    const VERSION: u32;
    /// Words of `coupling.mode`.
    const MODES: &'static [&'static str];
    /// A definition file.
    type Definition: Clone + Debug + PartialEq + Send + Sync;
    /// The laws that follow from a definition.
    type Laws: Clone + Debug + PartialEq + Send + Sync;
    /// Values and derivatives of the inputs.
    type Inputs: HostInputs;
    /// What an output is.
    type Output: Copy + Debug + PartialEq + Send + Sync;
    /// Where a model is.
    type State: Clone + Debug + Send + Sync;
    /// Results for the present state and inputs.
    type Cache: Clone + Debug + Send + Sync;
    /// Warnings of steps.
    type Warnings: Copy + Debug + Default + Send + Sync;

    /// Name, author and licence, description, default experiment.
    fn about(definition: &Self::Definition) -> (&str, &About, &str, Experiment);
    /// Call `visit` with each numeric parameter and its value, in the order of the file.
    fn parameters(definition: &mut Self::Definition, visit: &mut Visit);
    /// `coupling.mode`, by its index in [`Self::MODES`].
    fn mode(definition: &Self::Definition) -> usize;
    /// Choose it.
    fn set_mode(definition: &mut Self::Definition, mode: usize);
    /// The laws of a definition.
    fn laws(definition: &Self::Definition) -> Self::Laws;
    /// The variables of a definition with their quantities.
    fn variables(definition: &Self::Definition) -> (Vec<Variable>, Vec<Quantity<Self::Output>>);
    /// No results yet.
    fn cache(laws: &Self::Laws) -> Self::Cache;
    /// Forget all results: the state, the parameters or all inputs have changed.
    fn clear(cache: &mut Self::Cache);

    /// Check a definition with the present parameters.
    ///
    /// # Errors
    /// The first number out of range, with its name, its value and what is allowed.
    fn check(definition: &Self::Definition) -> Result<(), DefinitionError>;
    /// Check the pressures of the ports, which are relative to the ambient pressure, a parameter.
    ///
    /// # Errors
    /// As [`Self::check`].
    fn check_ports(model: &Model<Self>) -> Result<(), HydraulicsError>;
    /// The start under these parameters and inputs.
    fn start(parameters: &Parameters<Self>, inputs: &Self::Inputs) -> Self::State;
    /// Range of an input; none of a pressure, which is above absolute zero.
    fn range(laws: &Self::Laws, input: usize) -> Option<Range>;
    /// Ambient pressure [Pa].
    fn ambient(laws: &Self::Laws) -> f64;
    /// The value of an input has changed.
    fn input_changed(model: &mut Model<Self>, input: usize);
    /// Value of an output of a model that has a state; not finite where it has none.
    fn output(model: &mut Model<Self>, output: Self::Output) -> Result<f64, HydraulicsError>;
    /// Whether a lock is engaged.
    fn lock(_state: &Self::State, _lock: usize) -> bool {
        false
    }
    /// The warnings of steps that were not yet returned; none if there is none.
    fn take_warning(model: &mut Model<Self>) -> Option<String>;
    /// Index of the input with the next step of the host.
    fn horizon(laws: &Self::Laws) -> usize;

    /// Become the same as another state of this model, without allocation.
    fn copy_state(state: &mut Self::State, other: &Self::State);
    /// All fields of a state, written or read.
    fn record_state(laws: &Self::Laws, state: &mut Self::State, record: &mut Record) -> Result<(), Damaged>;
    /// What the steps have raised, written or read.
    fn record_warnings(warnings: &mut Self::Warnings, record: &mut Record) -> Result<(), Damaged>;
}

/// A hydraulic model with its parameters, inputs and state.
#[derive(Clone, Debug)]
pub struct Model<K: Kind> {
    /// As read; [`Self::reset`] returns to it.
    pub(super) original: Arc<Original<K>>,
    /// The present parameters; shared with the snapshots that were taken under them.
    pub(super) parameters: Arc<Parameters<K>>,
    pub(super) inputs: K::Inputs,
    pub(super) state: Option<K::State>,
    /// What the present state and inputs give, while they are the present ones.
    pub(super) cache: K::Cache,
    pub(super) warnings: K::Warnings,
}

/// A definition as read, before any value is set.
#[derive(Debug)]
pub struct Original<K: Kind> {
    pub(super) parameters: Arc<Parameters<K>>,
    pub(super) variables: Variables<Quantity<K::Output>>,
    pub(super) ranges: Vec<(Range, Role)>,
    pub(super) inputs: K::Inputs,
}

/// A definition with the values of its parameters, and the laws that follow from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters<K: Kind> {
    pub(super) definition: K::Definition,
    /// Numeric parameters, in the order of [`Kind::parameters`].
    pub(super) values: Vec<f64>,
    pub(super) laws: K::Laws,
}

impl<K: Kind> Parameters<K> {
    fn new(mut definition: K::Definition) -> Self {
        let mut values = Vec::new();
        K::parameters(&mut definition, &mut |_, value| values.push(*value));
        Self { laws: K::laws(&definition), definition, values }
    }

    /// Write the values into the definition.
    fn update(&mut self) {
        let mut values = self.values.iter();
        K::parameters(&mut self.definition, &mut |_, value| *value = values.next().copied().unwrap_or(*value));
        self.laws = K::laws(&self.definition);
    }
}

impl<K: Kind> Model<K> {
    /// Name of a variable; empty if there is none.
    pub(super) fn name_of(&self, reference: Reference) -> String {
        self.original.variables.get(reference).map_or_else(String::new, |v| v.name.clone())
    }

    fn no_such(&self, reference: Reference, kind: &'static str) -> HydraulicsError {
        let list = self.original.variables.list();
        let own = list.get(reference as usize).map(|variable| (variable.name.clone(), variable.kind.word()));
        HydraulicsError::Reference { reference, own, kind, count: list.len() }
    }

    /// Put the model at its start if it has no state yet.
    #[inline]
    pub(super) fn started(&mut self) -> Result<(), HydraulicsError> {
        if self.state.is_none() {
            K::check(&self.parameters.definition)?;
            K::check_ports(self)?;
            self.state = Some(K::start(&self.parameters, &self.inputs));
        }
        Ok(())
    }

    /// Value of an output; not finite where it has none.
    pub(super) fn output(&mut self, output: K::Output) -> Result<f64, HydraulicsError> {
        self.started()?;
        K::output(self, output)
    }

    /// No state, no results, no warnings.
    pub(super) fn clear_motion(&mut self) {
        self.state = None;
        K::clear(&mut self.cache);
        self.warnings = K::Warnings::default();
    }
}
