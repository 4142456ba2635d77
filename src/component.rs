//! What an FMI layer asks of any model, and the kinds of model there are.
//!
//! In: the text of a definition file, values by reference, steps. Out: what describes the model, values, saved states,
//! or the reason of a refusal. It must not know any law of a model, nor anything of FMI but value references.
//!
//! A further kind of model takes one variant of [`Component`] and of [`Snapshot`], one row in `KINDS`, and one arm in
//! each `match` of this file. Its model has methods of the same names, whose errors convert to [`Refused`].
// The same expression for the model of each kind.
macro_rules! each {
    ($component:expr, $model:ident => $answer:expr) => {
        match $component {
            Component::Mechanism($model) => $answer,
            Component::Hydraulic($model) => $answer,
        }
    };
}

mod derivative;
mod exchange;
mod linearise;
mod snapshot;
mod tables;
pub use linearise::{Linearisation, Linearised};

use crate::codec::sections::Sections;
use crate::format::{About, Experiment};
use crate::hydraulics::{self, HydraulicsError};
use crate::inspection::{Finding, Inspection};
use crate::integrator::Method;
use crate::mechanism::Line;
pub use crate::mechanism::Pauses;
use crate::mechanism::{self, ModelError, Reached};
use crate::variables::{Interface, Reference, Terminal, Vector};
pub use snapshot::Snapshot;
use std::fmt;
use std::sync::Arc;
pub use tables::TABLES;

/// Why a model refuses a call; the model is unchanged. The text names the quantity, the value, the limit and the
/// remedy.
#[derive(Clone, Debug, PartialEq)]
pub struct Refused(pub String);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refused {}

impl From<ModelError> for Refused {
    #[cold]
    fn from(error: ModelError) -> Self {
        Self(error.to_string())
    }
}

impl From<HydraulicsError> for Refused {
    #[cold]
    fn from(error: HydraulicsError) -> Self {
        Self(error.to_string())
    }
}

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

/// Why a question of a host's solver has no answer; the model is unchanged.
#[derive(Clone, Debug, PartialEq)]
pub enum NoValue {
    /// There is no value at this trial state: a shorter step of the solver avoids it.
    AtState(String),
    /// Whatever the state.
    Refused(Refused),
}

impl From<mechanism::NoValue> for NoValue {
    #[cold]
    fn from(no_value: mechanism::NoValue) -> Self {
        match no_value {
            mechanism::NoValue::AtState(why) => Self::AtState(why),
            mechanism::NoValue::Refused(error) => Self::Refused(error.into()),
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

/// How far a step of a hydraulic actuator has come that did not come to its end.
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

/// A model of any kind.
#[expect(clippy::large_enum_variant, reason = "the calls of a mechanism pay for no indirection")]
#[derive(Clone, Debug)]
pub enum Component {
    /// A planar linkage with one degree of freedom.
    Mechanism(mechanism::Model),
    /// A hydraulic actuator.
    Hydraulic(Box<hydraulics::Model>),
}

type Constructor = fn(&str, Option<Arc<Sections>>) -> Result<Component, Refused>;
type Inspector = fn(&str) -> Inspection;

/// Definition file of each kind of model, how a component is made from its text and what was kept of its tables, and how
/// the text is inspected.
const KINDS: [(&str, Constructor, Inspector); 2] = [
    (
        "mechanism.json",
        |text, tables| Ok(Component::Mechanism(mechanism::Model::with_tables(text, tables)?)),
        mechanism::inspection::inspect,
    ),
    (
        "hydraulics.json",
        |text, _| Ok(Component::Hydraulic(Box::new(hydraulics::Model::from_json(text)?))),
        hydraulics::inspection::inspect,
    ),
];

#[cold]
fn no_kind(file: &str) -> Refused {
    Refused(format!("'{file}' is the definition file of no kind of model"))
}

/// Questions that the model of each kind answers by its method of the same name.
macro_rules! questions {
    ($($(#[$doc:meta])* fn $name:ident($this:ident: $receiver:ty $(, $argument:ident: $type:ty)*) -> $answer:ty;)*) => {
        $(
            $(#[$doc])*
            #[inline]
            pub fn $name($this: $receiver $(, $argument: $type)*) -> Result<$answer, Refused> {
                each!($this, model => Ok(model.$name($($argument),*)?))
            }
        )*
    };
}

impl Component {
    /// Names of the definition files, one for each kind of model.
    pub fn definition_files() -> [&'static str; KINDS.len()] {
        KINDS.map(|(file, ..)| file)
    }

    /// The component that the definition file of this name and text describes.
    ///
    /// # Errors
    /// No kind of model has such a file; what is wrong with the text.
    pub fn from_definition(file: &str, text: &str) -> Result<Self, Refused> {
        Self::construct(file, text, None)
    }

    fn construct(file: &str, text: &str, tables: Option<Arc<Sections>>) -> Result<Self, Refused> {
        match KINDS.iter().find(|(name, ..)| *name == file) {
            Some((_, construct, _)) => construct(text, tables),
            None => Err(no_kind(file)),
        }
    }

    /// All that is wrong with the text of the definition file of this name, and facts about the model that it gives.
    ///
    /// # Errors
    /// No kind of model has such a file.
    pub fn inspect(file: &str, text: &str) -> Result<Inspection, Refused> {
        match KINDS.iter().find(|(name, ..)| *name == file) {
            Some((.., inspect)) => Ok(inspect(text)),
            None => Err(no_kind(file)),
        }
    }

    /// Name of the definition file of this kind of model.
    pub fn definition_file(&self) -> &'static str {
        match self {
            Self::Mechanism(_) => KINDS[0].0,
            Self::Hydraulic(_) => KINDS[1].0,
        }
    }

    /// Name of the model, the FMU's modelName and modelIdentifier.
    pub fn name(&self) -> &str {
        each!(self, model => model.name())
    }

    /// Author, copyright and licence of the model.
    pub fn about(&self) -> &About {
        each!(self, model => model.about())
    }

    /// One-line description of the model.
    pub fn description(&self) -> &str {
        each!(self, model => model.description())
    }

    /// What the definition gives reason to warn of, for logs.
    pub fn warnings(&self) -> Vec<Finding> {
        match self {
            Self::Mechanism(model) => model.warnings().to_vec(),
            Self::Hydraulic(model) => model.warnings(),
        }
    }

    /// What was done to the definition so that it gives the model that is meant, for logs.
    pub fn remarks(&self) -> Vec<String> {
        match self {
            Self::Mechanism(model) => model.remarks(),
            Self::Hydraulic(_) => Vec::new(),
        }
    }

    /// Default experiment.
    pub fn experiment(&self) -> Experiment {
        each!(self, model => model.experiment())
    }

    /// Variables that a user connects together.
    pub fn terminals(&self) -> Vec<Terminal> {
        each!(self, model => model.terminals())
    }

    /// Outputs along x and y that make up vectors.
    pub fn vectors(&self) -> Vec<Vector> {
        match self {
            Self::Mechanism(model) => model.vectors(),
            Self::Hydraulic(_) => Vec::new(),
        }
    }

    /// Of a Boolean output that tells whether the mechanism is at a stop: the outputs that tell the number of impacts on
    /// this stop and the time of the last one [s]. None for any other variable.
    pub fn impacts_of(&self, flag: Reference) -> Option<[Reference; 2]> {
        match self {
            Self::Mechanism(model) => model.impacts_of(flag),
            Self::Hydraulic(_) => None,
        }
    }

    /// Largest order of the derivatives in time that are taken of inputs; 0: none.
    pub fn input_order(&self) -> i32 {
        match self {
            Self::Mechanism(_) => mechanism::INPUT_ORDER,
            Self::Hydraulic(_) => hydraulics::INPUT_ORDER,
        }
    }

    /// Largest order of the derivatives in time that are told of outputs; 0: none.
    pub fn output_order(&self) -> i32 {
        match self {
            Self::Mechanism(_) => mechanism::OUTPUT_ORDER,
            Self::Hydraulic(_) => hydraulics::OUTPUT_ORDER,
        }
    }

    /// What a host can read and set.
    #[inline]
    pub fn interface(&self) -> &Interface {
        each!(self, model => model.variables())
    }

    /// Hashes of the interface, and of what no parameter, input or text of the definition changes. A snapshot is for
    /// components of the same identity.
    #[inline]
    pub fn identity(&self) -> [u64; 2] {
        each!(self, model => model.identity())
    }

    questions! {
        /// For each variable, if it is an output: the inputs and parameters on which its initial value depends,
        /// ascending. Refused: a parameter that may not change a little.
        fn initial_dependencies(self: &Self) -> Option<Vec<Vec<Reference>>>;

        /// Present value of a Real; NaN for an output that has no value in this state, of which [`Self::undefined`]
        /// tells why. Refused: no such Real, or the present parameters give no start.
        fn real(self: &mut Self, reference: Reference) -> f64;
        /// Present value of a Boolean. Refused: no such Boolean, or the present parameters give no start.
        fn boolean(self: &mut Self, reference: Reference) -> bool;
        /// Present item of an Enumeration, by its index from 0 on. Refused: no such Enumeration, or the present
        /// parameters give no start.
        fn item(self: &mut Self, reference: Reference) -> usize;

        /// Whether [`Self::set_real`] would accept this value; changes nothing.
        fn check_real(self: &Self, reference: Reference, value: f64) -> ();
        /// Set a Real input or parameter. After a step, a parameter takes effect with the next initialisation only.
        /// Refused: no such Real, an output, a value out of range.
        fn set_real(self: &mut Self, reference: Reference, value: f64) -> ();
        /// [`Self::set_real`] of one of several values that [`Self::check_together`] has accepted.
        fn take_real(self: &mut Self, reference: Reference, value: f64) -> ();
        /// Whether several Reals, each of which [`Self::check_real`] accepts, may be set together; changes nothing.
        /// Refused: a calculated parameter would be out of range.
        fn check_together(self: &Self, references: &[Reference], values: &[f64]) -> ();
        /// Whether [`Self::set_boolean`] would accept this value; changes nothing.
        fn check_boolean(self: &Self, reference: Reference, value: bool) -> ();
        /// Set a Boolean, as [`Self::set_real`] does.
        fn set_boolean(self: &mut Self, reference: Reference, value: bool) -> ();
        /// Whether [`Self::set_text`] would accept this value; changes nothing.
        fn check_text(self: &Self, reference: Reference, value: &str) -> ();
        /// Set an Enumeration by the name of an item, as [`Self::set_real`] does. Refused also: none of the names.
        fn set_text(self: &mut Self, reference: Reference, value: &str) -> ();
        /// Give tunable parameters new values between two steps; each is one that [`Self::check_real`] accepts, all that
        /// [`Self::check_together`] accepts, and other variables are passed over. Refused: the values give no law.
        fn tune(self: &mut Self, references: &[Reference], values: &[f64]) -> ();

        /// Time derivative of this order of a continuous output; NaN where there is none in this state. Refused: no such
        /// output, or the order is too high.
        fn output_derivative(self: &mut Self, reference: Reference, order: i32) -> f64;
        /// Whether [`Self::set_input_derivative`] would accept this value; changes nothing.
        fn check_input_derivative(self: &Self, reference: Reference, order: i32, value: f64) -> ();
        /// Set the derivative of a continuous input at the beginning of the next step, for that step. Refused: no such
        /// input, the order is too high, or the value is not finite.
        fn set_input_derivative(self: &mut Self, reference: Reference, order: i32, value: f64) -> ();

        /// Override the relative tolerance of the integration. Refused: out of range.
        fn set_tolerance(self: &mut Self, tolerance: f64) -> ();
        /// Take the start state under the present parameters and inputs. Refused: the parameters give no model, or the
        /// start cannot be reached.
        fn initialize(self: &mut Self) -> ();
    }

    /// [`Self::step_from`] at the model's own time since the start.
    ///
    /// # Errors
    /// As [`Self::step_from`].
    pub fn step(&mut self, h: f64) -> Result<Stepped, Refused> {
        self.step_from(None, h)
    }

    /// Advance from the host's time `point` [s], if it has one, by exactly `h` [s], > 0, or as far as `solver.max_steps` allows.
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

    /// Whether a step may come to an event: a stop is met or lets go.
    pub fn has_events(&self) -> bool {
        match self {
            Self::Mechanism(model) => model.has_events(),
            Self::Hydraulic(_) => false,
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
            Self::Hydraulic(_) => Ok(false),
        }
    }

    /// What the steps and values since the last call give reason to warn of; None mostly.
    #[inline]
    pub fn take_warning(&mut self) -> Option<String> {
        match self {
            Self::Mechanism(model) => model.take_warning(),
            Self::Hydraulic(model) => model.take_warning(),
        }
    }

    /// What the state after initialisation gives reason to warn of under the present inputs; None mostly.
    #[cold]
    pub fn start_warning(&mut self) -> Option<String> {
        match self {
            Self::Mechanism(model) => model.start_warning(),
            Self::Hydraulic(_) => None,
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
            Self::Hydraulic(_) => Vec::new(),
        }
    }

    /// Why a Real output has no value in the present state; None if it has one.
    #[cold]
    pub fn undefined(&mut self, reference: Reference) -> Option<String> {
        each!(self, model => model.undefined(reference))
    }

    /// Why a Real output has no derivative in the direction of the last [`Self::directional_derivative`] or
    /// [`Self::output_derivative`]; None if it has one.
    #[cold]
    pub fn undefined_derivative(&mut self, reference: Reference) -> Option<String> {
        each!(self, model => model.undefined_derivative(reference))
    }

    /// Back to the parameters and inputs of the definition, not initialised.
    pub fn reset(&mut self) {
        each!(self, model => model.reset());
    }

    /// What the integration has cost since initialisation, for the log.
    pub fn cost(&self) -> String {
        let cost = each!(self, model => model.statistics());
        let methods = Method::ALL.map(|method| format!("{} by {}", cost.accepted_by(method), method.name()));
        format!(
            "{} evaluations in {} accepted steps ({}) and {} rejected",
            cost.evaluations,
            cost.accepted,
            methods.join(", "),
            cost.rejected
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_has_a_definition_file_of_its_own() {
        let gear = Component::from_definition("mechanism.json", mechanism::GEAR).unwrap();
        assert_eq!(gear.definition_file(), "mechanism.json");
        assert!(Component::from_definition("mechanism.json", "{}").is_err());
        let actuator = Component::from_definition("hydraulics.json", r#"{ "name": "Actuator" }"#).unwrap();
        assert_eq!(actuator.definition_file(), "hydraulics.json");
        assert!(Component::from_definition("other.json", mechanism::GEAR).unwrap_err().0.contains("other.json"));
    }
}
