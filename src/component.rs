//! What an FMI layer asks of any model, and the kinds of model there are.
//!
//! In: the text of a definition file, values by reference, steps. Out: what describes the model, values, saved states,
//! or the reason of a refusal. It must not know any law of a model, nor anything of FMI but value references.
//!
//! A further kind of hydraulic model takes one row in [`KINDS`] and `INSPECTORS` and the trait
//! [`AnyModel`]; any other kind also one variant of [`Component`] and of [`Snapshot`], and one arm in each `match` of
//! this module. Its model has methods of the same names, whose errors convert to [`Refused`].
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
mod outermost;
mod refusal;
mod snapshot;
mod step;
mod tables;
mod values;
pub use linearise::{Linearisation, Linearised};
use outermost::outermost_keys;

use crate::codec::sections::Sections;
use crate::format::{About, Described, Experiment, Table};
use crate::hydraulics::any::AnyModel;
use crate::hydraulics::{self, network};
use crate::inspection::{Finding, Inspection};
use crate::integrator::Method;
use crate::mechanism;
pub use crate::mechanism::{FastForward, Pauses, Waypoint};
use crate::variables::{Interface, Reference, Terminal, Vector};
pub use refusal::{NoValue, Refused};
pub use snapshot::Snapshot;
use std::sync::Arc;
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

type Constructor = fn(&str, Option<Arc<Sections>>) -> Result<Component, Refused>;
type Inspector = fn(&str) -> Inspection;

/// A kind of model.
#[derive(Debug)]
pub struct ModelKind {
    /// Name of its definition file.
    file: &'static str,
    /// How a component is made from the definition's text and what was kept of its tables.
    construct: Constructor,
}

impl ModelKind {
    /// Name of its definition file.
    pub fn file(&self) -> &'static str {
        self.file
    }
}

/// A planar linkage with one degree of freedom, with or without a hydraulic circuit or network.
pub const MECHANISM: ModelKind = ModelKind {
    file: "mechanism.json",
    construct: |text, tables| {
        mechanism::allow_hydraulics();
        (PLAIN_MECHANISM.construct)(text, tables)
    },
};
/// A planar linkage with one degree of freedom and no hydraulics.
pub const PLAIN_MECHANISM: ModelKind = ModelKind {
    file: MECHANISM.file,
    construct: |text, tables| Ok(Component::Mechanism(mechanism::Model::shared(text, tables)?)),
};
/// A hydraulic actuator alone.
pub const HYDRAULIC_ACTUATOR: ModelKind = ModelKind {
    file: hydraulics::FILE,
    construct: |text, _| Ok(Component::Hydraulic(Box::new(hydraulics::Model::from_json(text)?))),
};
/// A supply network with cylinders.
pub const HYDRAULIC_SYSTEM: ModelKind = ModelKind {
    file: network::FILE,
    construct: |text, _| Ok(Component::Hydraulic(Box::new(network::Model::from_json(text)?))),
};
/// All kinds of models. A library that is given a part of them is without the code of the others.
pub const KINDS: [ModelKind; 3] = [MECHANISM, HYDRAULIC_ACTUATOR, HYDRAULIC_SYSTEM];
/// How the text of each kind is inspected. A table apart, so that a library that inspects nothing is without the code.
const INSPECTORS: [Inspector; KINDS.len()] =
    [mechanism::inspection::inspect, hydraulics::inspection::inspect, network::inspection::inspect];

#[cold]
fn no_kind(file: &str) -> Refused {
    let files = Component::definition_files().join(" or ");
    Refused(format!("'{file}' is not the name of a definition file; use {files}"))
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
        KINDS.map(|kind| kind.file)
    }

    /// The component that the definition file of this name and text describes.
    ///
    /// # Errors
    /// No kind of model has such a file; what is wrong with the text.
    pub fn from_definition(file: &str, text: &str) -> Result<Self, Refused> {
        match KINDS.iter().find(|kind| kind.file == file) {
            Some(kind) => (kind.construct)(text, None),
            None => Err(no_kind(file)),
        }
    }

    /// All that is wrong with the text of the definition file of this name, and facts about the model that it gives.
    ///
    /// # Errors
    /// No kind of model has such a file.
    pub fn inspect(file: &str, text: &str) -> Result<Inspection, Refused> {
        match KINDS.iter().zip(INSPECTORS).find(|(kind, _)| kind.file == file) {
            Some((_, inspect)) => Ok(inspect(text)),
            None => Err(no_kind(file)),
        }
    }

    /// Name of the definition file of the kind of model that a text describes: the one of which it has the most keys
    /// that no other kind has, even where the text is not quite JSON. None if no key tells.
    pub fn kind_of(text: &str) -> Option<&'static str> {
        let keys = outermost_keys(text);
        let tables: [&Table; KINDS.len()] = [
            mechanism::definition::Mechanism::TABLE,
            hydraulics::definition::HydraulicActuator::TABLE,
            network::definition::HydraulicSystem::TABLE,
        ];
        let has = |kind: usize, key: &str| tables[kind].position(key).is_some();
        let is_own =
            |kind: usize, key: &str| has(kind, key) && (0..tables.len()).all(|other| other == kind || !has(other, key));
        let own = |kind: usize| keys.iter().filter(|key| is_own(kind, key)).count();
        let counts: [usize; KINDS.len()] = std::array::from_fn(own);
        let most = counts.iter().copied().max().filter(|most| *most > 0)?;
        let mut kinds = (0..KINDS.len()).filter(|kind| counts[*kind] == most);
        kinds.next().filter(|_| kinds.next().is_none()).map(|kind| KINDS[kind].file)
    }

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

    /// Of a Boolean output that tells whether the mechanism is at a stop: the outputs that tell the number of impacts
    /// on this stop and the time of the last one [s]. None for any other variable.
    pub fn impacts_of(&self, flag: Reference) -> Option<[Reference; 2]> {
        match self {
            Self::Mechanism(model) => model.impacts_of(flag),
            Self::Hydraulic(_) => None,
        }
    }

    /// The time of the first impact on the stop with this flag as a function of these inputs, where the energy integral
    /// gives it: see [`mechanism::Model::travel_time`]. None for a model without stops.
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
        match self {
            Self::Mechanism(model) => model.variables(),
            Self::Hydraulic(model) => model.interface(),
        }
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
        /// Give tunable parameters new values between two steps; each is one that [`Self::check_real`] accepts, all
        /// that [`Self::check_together`] accepts, and other variables are passed over. Refused: the values give no law.
        fn tune(self: &mut Self, references: &[Reference], values: &[f64]) -> ();

        /// Time derivative of this order of a continuous output; NaN where there is none in this state. Refused: no
        /// such output, or the order is too high.
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

    /// Present values of several Reals in their order, each as [`Self::real`].
    ///
    /// # Errors
    /// As [`Self::real`]; the values before are given.
    #[inline]
    pub fn reals(&mut self, references: &[Reference], mut give: impl FnMut(f64)) -> Result<(), Refused> {
        if let Self::Mechanism(model) = self {
            return Ok(model.reals(references, give)?);
        }
        references.iter().try_for_each(|&reference| self.real(reference).map(&mut give))
    }

    /// Whether these are references of Real outputs that were read together before.
    #[inline]
    pub fn has_read(&self, references: &[Reference]) -> bool {
        matches!(self, Self::Mechanism(model) if model.has_read(references))
    }

    /// What the steps and values since the last call give reason to warn of; None mostly.
    #[inline]
    pub fn take_warning(&mut self) -> Option<String> {
        each!(self, model => model.take_warning())
    }

    /// What the state after initialisation gives reason to warn of under the present inputs; None mostly.
    #[cold]
    pub fn start_warning(&mut self) -> Option<String> {
        match self {
            Self::Mechanism(model) => model.start_warning(),
            Self::Hydraulic(_) => None,
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
            "{} evaluations of derivatives in {} accepted steps ({}) and {} rejected steps",
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
        let system = r#"{ "name": "System", "nodes": { "line": { "volume": 1e-3 } } }"#;
        assert_eq!(Component::from_definition("network.json", system).unwrap().definition_file(), "network.json");
        assert_eq!(Component::kind_of(system), Some("network.json"));
        let ram = r#"{ "name": "Ram", "circuit": { "cylinder": { "bore": 0.03, "rod": 0.018 } } }"#;
        assert_eq!(Component::kind_of(ram), Some("hydraulics.json"));
        assert_eq!(Component::kind_of(mechanism::GEAR), Some("mechanism.json"));
        assert_eq!(Component::kind_of(r#"{ "name": "Ram" }"#), None);
        // Faults of JSON do not hide the kind.
        for (from, to) in [
            ("1e-3 } }", "1e-3 } "),
            ("\"System\",", "\"System\""),
            ("1e-3", "1e-3,"),
            ("{ \"name\"", "// a\n{ \"name\""),
        ] {
            assert!(system.contains(from), "{from}");
            assert_eq!(Component::kind_of(&system.replacen(from, to, 1)), Some("network.json"), "{to}");
        }
        assert_eq!(Component::kind_of(&ram.replace("}", "")), Some("hydraulics.json"));
        assert!(Component::from_definition("other.json", mechanism::GEAR).unwrap_err().0.contains("other.json"));
    }
}
