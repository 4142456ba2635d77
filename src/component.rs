//! The functions that an FMI layer needs from any model, and the list of the kinds of models.
//!
//! In: the text of a definition file, values by reference, steps. Out: description of the model, values, saved states,
//! or the reason of a refusal. Must not know: laws of a model, and FMI except for value references.
//!
//! Another kind of hydraulic model needs one row in [`KINDS`] and `INSPECTORS` of the module `kinds`, and the trait
//! [`AnyModel`]. Any other kind also needs one variant of [`Component`] and of [`Snapshot`], and one arm in each
//! `match` of this module. Its model has methods of the same names, whose errors convert to [`Refused`].
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
mod kinds;
mod linearise;
mod outermost;
mod refusal;
mod snapshot;
mod step;
mod tables;
mod values;
pub use crate::mechanism::MOST_STATES;
pub use kinds::{HYDRAULIC_ACTUATOR, HYDRAULIC_SYSTEM, KINDS, MECHANISM, ModelKind, PLAIN_MECHANISM};
pub use linearise::{Linearisation, Linearised};

use crate::format::{About, Experiment};
use crate::hydraulics;
use crate::hydraulics::any::AnyModel;
use crate::inspection::Finding;
use crate::integrator::Method;
use crate::mechanism;
pub use crate::mechanism::{FastForward, Pauses, Waypoint};
use crate::variables::{Interface, Reference, Terminal, Vector};
pub use refusal::{NoValue, Refused};
pub use snapshot::Snapshot;
pub use step::{Interrupted, Paused, Stepped};
pub use tables::TABLES;

/// A model of any kind.
#[expect(clippy::large_enum_variant, reason = "the calls of a mechanism pay for no indirection")]
#[derive(Clone, Debug)]
pub enum Component {
    /// A planar linkage with one degree of freedom.
    Mechanism(mechanism::Model),
    /// A hydraulic actuator, or a hydraulic system: a supply network with cylinders.
    Hydraulic(Box<dyn AnyModel>),
}

/// Methods that call the method of the same name of the model.
macro_rules! methods {
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
    /// Name of the definition file of this kind of model.
    pub fn definition_file(&self) -> &'static str {
        match self {
            Self::Mechanism(_) => MECHANISM.file,
            Self::Hydraulic(model) => model.definition_file(),
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

    /// Warnings about the definition, for logs.
    pub fn warnings(&self) -> Vec<Finding> {
        match self {
            Self::Mechanism(model) => model.warnings().to_vec(),
            Self::Hydraulic(model) => model.warnings(),
        }
    }

    /// Changes that the program made to the definition, for logs.
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

    /// Vectors that consist of outputs along x and y.
    pub fn vectors(&self) -> Vec<Vector> {
        match self {
            Self::Mechanism(model) => model.vectors(),
            Self::Hydraulic(_) => Vec::new(),
        }
    }

    /// Outputs of a stop: number of impacts and time of the last impact [s]. `flag` is the Boolean output that is true
    /// at the stop. None for any other variable.
    pub fn impacts_of(&self, flag: Reference) -> Option<[Reference; 2]> {
        match self {
            Self::Mechanism(model) => model.impacts_of(flag),
            Self::Hydraulic(_) => None,
        }
    }

    /// The time of the first impact on the stop with this flag, as a function of these inputs: see
    /// [`mechanism::Model::travel_time`]. None if the energy integral does not determine the time, and for a model
    /// without stops.
    pub fn travel_time(&self, flag: Reference, inputs: &[Reference], samples: &[f64]) -> Option<mechanism::TravelTime> {
        match self {
            Self::Mechanism(model) => model.travel_time(flag, inputs, samples),
            Self::Hydraulic(_) => None,
        }
    }

    /// States on the way from the start as functions of these inputs, where the energy integral gives them: see
    /// [`mechanism::Model::fast_forward`]. None for a model that is no mechanism.
    pub fn fast_forward(&self, inputs: &[Reference]) -> Option<FastForward> {
        match self {
            Self::Mechanism(model) => model.fast_forward(inputs),
            Self::Hydraulic(_) => None,
        }
    }

    /// Whether the model has a hydraulic circuit or network.
    pub fn has_hydraulics(&self) -> bool {
        match self {
            Self::Mechanism(model) => model.has_hydraulics(),
            Self::Hydraulic(_) => true,
        }
    }

    /// Whether the model has other states than position and speed: with hydraulics or states of controllers.
    pub fn has_more_states(&self) -> bool {
        match self {
            Self::Mechanism(model) => model.has_hydraulics() || model.state_count() > 2,
            Self::Hydraulic(_) => true,
        }
    }

    /// Largest order of the time derivatives of inputs that can be set. 0: none.
    pub fn input_order(&self) -> i32 {
        match self {
            Self::Mechanism(_) => mechanism::INPUT_ORDER,
            Self::Hydraulic(_) => hydraulics::INPUT_ORDER,
        }
    }

    /// Largest order of the time derivatives of outputs that can be read. 0: none.
    pub fn output_order(&self) -> i32 {
        match self {
            Self::Mechanism(_) => mechanism::OUTPUT_ORDER,
            Self::Hydraulic(_) => hydraulics::OUTPUT_ORDER,
        }
    }

    /// The variables that a host can read and set.
    #[inline]
    pub fn interface(&self) -> &Interface {
        match self {
            Self::Mechanism(model) => model.variables(),
            Self::Hydraulic(model) => model.interface(),
        }
    }

    /// Two hashes: of the interface, and of the definition without parameter values, inputs and texts. A snapshot can
    /// be restored in components with the same identity.
    #[inline]
    pub fn identity(&self) -> [u64; 2] {
        each!(self, model => model.identity())
    }

    methods! {
        /// For each variable, if it is an output: the inputs and parameters on which its initial value depends,
        /// ascending. Error: a parameter for which no small change is possible.
        fn initial_dependencies(self: &Self) -> Option<Vec<Vec<Reference>>>;

        /// Present value of a Real. NaN for an output that has no value in this state; [`Self::undefined`] returns the
        /// reason. Errors: not a Real, or the present parameters allow no start.
        fn real(self: &mut Self, reference: Reference) -> f64;
        /// Present value of a Boolean. Errors: not a Boolean, or the present parameters allow no start.
        fn boolean(self: &mut Self, reference: Reference) -> bool;
        /// Index of the present item of an Enumeration, from 0 on. Errors: not an Enumeration, or the present
        /// parameters allow no start.
        fn item(self: &mut Self, reference: Reference) -> usize;

        /// Returns the error that [`Self::set_real`] would return for this value.
        fn check_real(self: &Self, reference: Reference, value: f64) -> ();
        /// Sets a Real input or parameter. After a step, a parameter takes effect only at the next initialisation.
        /// Errors: not a Real, an output, or a value out of range.
        fn set_real(self: &mut Self, reference: Reference, value: f64) -> ();
        /// [`Self::set_real`] for one of several values that [`Self::check_together`] has accepted.
        fn take_real(self: &mut Self, reference: Reference, value: f64) -> ();
        /// Returns an error if several Reals cannot be set together. Precondition: [`Self::check_real`] accepts each of
        /// them. Error: a calculated parameter would be out of range.
        fn check_together(self: &Self, references: &[Reference], values: &[f64]) -> ();
        /// Returns the error that [`Self::set_boolean`] would return for this value.
        fn check_boolean(self: &Self, reference: Reference, value: bool) -> ();
        /// Sets a Boolean, like [`Self::set_real`].
        fn set_boolean(self: &mut Self, reference: Reference, value: bool) -> ();
        /// Returns the error that [`Self::set_text`] would return for this value.
        fn check_text(self: &Self, reference: Reference, value: &str) -> ();
        /// Sets an Enumeration by the name of an item, like [`Self::set_real`]. Further error: no item has this name.
        fn set_text(self: &mut Self, reference: Reference, value: &str) -> ();
        /// Sets tunable parameters between two steps and ignores other variables. Precondition: [`Self::check_real`]
        /// accepts each value, [`Self::check_together`] accepts all. Error: no law exists for the values.
        fn tune(self: &mut Self, references: &[Reference], values: &[f64]) -> ();

        /// Time derivative of this order of a continuous output. NaN if it does not exist in this state. Errors: not a
        /// continuous output, or the order is too high.
        fn output_derivative(self: &mut Self, reference: Reference, order: i32) -> f64;
        /// Returns the error that [`Self::set_input_derivative`] would return for this value.
        fn check_input_derivative(self: &Self, reference: Reference, order: i32, value: f64) -> ();
        /// Sets the derivative of a continuous input at the start of the next step, valid for that step. Errors: not a
        /// continuous input, the order is too high, or the value is not finite.
        fn set_input_derivative(self: &mut Self, reference: Reference, order: i32, value: f64) -> ();

        /// Overrides the relative tolerance of the integration. Error: out of range.
        fn set_tolerance(self: &mut Self, tolerance: f64) -> ();
        /// Computes the start state for the present parameters and inputs. Errors: the parameters allow no model, or
        /// the start position cannot be reached.
        fn initialize(self: &mut Self) -> ();
    }

    /// Passes the present values of several Reals to `give`, in their order, for references that [`Self::reread`] does
    /// not know. Each value is that of [`Self::real`].
    ///
    /// # Errors
    /// As [`Self::real`]. The values before the error have been passed.
    #[inline]
    pub fn reals(&mut self, references: &[Reference], mut give: impl FnMut(f64)) -> Result<(), Refused> {
        if let Self::Mechanism(model) = self {
            return Ok(model.other_reals(references, give)?);
        }
        references.iter().try_for_each(|&reference| self.real(reference).map(&mut give))
    }

    /// Writes the present values of the Real outputs that were read together last to `values`, and returns whether each
    /// of them has a value. None if these are not their references.
    #[inline]
    pub fn reread<'v>(&mut self, references: &[Reference], values: impl FnOnce() -> &'v mut [f64]) -> Option<bool> {
        if let Self::Mechanism(model) = self { model.reread(references, values) } else { None }
    }

    /// Warning about the steps and values since the last call. Usually None.
    #[inline]
    pub fn take_warning(&mut self) -> Option<String> {
        each!(self, model => model.take_warning())
    }

    /// Warning about the state after initialisation with the present inputs. Usually None.
    #[cold]
    pub fn start_warning(&mut self) -> Option<String> {
        match self {
            Self::Mechanism(model) => model.start_warning(),
            Self::Hydraulic(_) => None,
        }
    }

    /// Reason why a Real output has no value in the present state. None if it has one.
    #[cold]
    pub fn undefined(&mut self, reference: Reference) -> Option<String> {
        each!(self, model => model.undefined(reference))
    }

    /// Reason why a Real output has no derivative in the direction of the last [`Self::directional_derivative`] or
    /// [`Self::output_derivative`]. None if it has one.
    #[cold]
    pub fn undefined_derivative(&mut self, reference: Reference) -> Option<String> {
        each!(self, model => model.undefined_derivative(reference))
    }

    /// Resets parameters and inputs to the definition. The component is then not initialised.
    pub fn reset(&mut self) {
        each!(self, model => model.reset());
    }

    /// Work of the integration since initialisation, for the log.
    pub fn cost(&self) -> String {
        let cost = each!(self, model => model.statistics());
        let methods = Method::ALL.map(|method| format!("{} by {}", cost.accepted_by(method), method.name()));
        format!(
            "{} evaluations of derivatives in {} accepted steps ({}) and {} rejected steps",
            cost.evaluations,
            cost.accepted,
            methods.join(", "),
            cost.rejected
        )
    }
}
