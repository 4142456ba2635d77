//! The parts of a model's description that all versions of FMI share.
//!
//! In: the component. Out: its names, variables and default experiment, and the elements that are equal in all
//! versions. The module must not know kinds of model.

use super::common::{Attributes, Xml, element, empty, group, is_c_identifier, number, write_units};
use super::sizes::Sizes;
use anyhow::{Result, bail};
use fmu_cli::Naming;
use linkage_fmu::component::{Component, MOST_STATES};
use linkage_fmu::fmi::logger::LOG_CATEGORIES;
use linkage_fmu::format::Experiment;
use linkage_fmu::variables::{Causality, ContinuousTime, Reference, Value, Variability, Variable, Vector};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io;

/// Version of this repository, for `version` and `generationTool`.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Parameter whose start value is the tolerance of the default experiment.
const TOLERANCE: &str = "solver.tolerance";

/// All data of the description of one model.
pub struct Interface<'a> {
    /// Name of the model, a C identifier.
    pub name: &'a str,
    /// Description of the model in one line.
    pub description: &'a str,
    /// Attributes for author, copyright and licence.
    pub about: Attributes<'static>,
    /// Naming convention of the variables.
    pub naming: Naming,
    /// Its outputs along x and y as vectors.
    pub vectors: Vec<Vector>,
    /// Identifier of the interface.
    pub guid: &'a str,
    /// Its variables; the index of each is its value reference.
    pub variables: &'a [Variable],
    /// For each variable. None if the model is too large to compute them. Without the attribute each output depends on
    /// all knowns (FMI 2.0.5, 2.2.8).
    pub initial_dependencies: Option<Vec<Vec<Reference>>>,
    /// Default experiment.
    pub experiment: Experiment,
    /// Relative tolerance of the default experiment.
    pub tolerance: f64,
    /// Largest orders of the derivatives in time of inputs and outputs.
    pub orders: [i32; 2],
    /// Whether a step may reach an event.
    pub has_events: bool,
    /// Whether a step reports its internal steps.
    pub has_internal_steps: bool,
    /// Data for the solver of a host. None if the model is for co-simulation only.
    pub continuous_time: Option<ContinuousTime>,
    /// Nominal values of the states.
    pub state_nominals: Option<[f64; MOST_STATES]>,
    /// Nominal values of inputs and outputs.
    pub sizes: Sizes,
}

impl<'a> Interface<'a> {
    /// The interface of a model as read from its file.
    ///
    /// # Errors
    /// The name is no C identifier, the tolerance is missing, or a parameter cannot change.
    pub fn of(component: &'a Component, naming: Naming) -> Result<Self> {
        let (name, interface) = (component.name(), component.interface());
        if !is_c_identifier(name) {
            bail!(
                "name: \"{name}\" is not a C identifier; use letters, digits and _ only, and do not start with a digit"
            );
        }
        let parameter = interface.list().iter().find(|variable| variable.name == TOLERANCE);
        let Some(&Value::Real(tolerance)) = parameter.and_then(|parameter| parameter.start.as_ref()) else {
            bail!("{TOLERANCE}: this parameter is missing; the model must declare it");
        };
        Ok(Self {
            name,
            description: component.description(),
            about: component.about().attributes(),
            naming,
            guid: interface.guid(),
            variables: interface.list(),
            vectors: component.vectors(),
            initial_dependencies: component.initial_dependencies()?,
            experiment: component.experiment(),
            tolerance,
            orders: [component.input_order(), component.output_order()],
            has_events: component.has_events(),
            has_internal_steps: component.has_internal_steps(),
            continuous_time: component.continuous_time(),
            state_nominals: component.continuous_time().and_then(|_| component.clone().nominals().ok()),
            sizes: Sizes::new(interface.list(), component.experiment().stop_time),
        })
    }

    /// The outputs, with their value references.
    pub fn outputs(&self) -> impl Iterator<Item = (Reference, &'a Variable)> {
        (0..).zip(self.variables).filter(|(_, variable)| variable.causality == Causality::Output)
    }

    /// The calculated parameters, with their value references.
    pub fn calculated(&self) -> impl Iterator<Item = (Reference, &'a Variable)> {
        (0..).zip(self.variables).filter(|(_, variable)| variable.causality == Causality::CalculatedParameter)
    }

    /// The continuous states, each with the reference of its derivative.
    pub fn states(&self) -> impl Iterator<Item = (Reference, Reference)> {
        let pairs =
            |all: &ContinuousTime| all.states.iter().copied().zip(all.derivatives.iter().copied()).collect::<Vec<_>>();
        self.continuous_time.as_ref().map(pairs).unwrap_or_default().into_iter()
    }

    /// The continuous states and their derivatives that are not outputs, without duplicates.
    pub fn initial_states(&self) -> Vec<Reference> {
        let mut all: Vec<Reference> = self.states().flat_map(|(state, derivative)| [state, derivative]).collect();
        all.dedup();
        all.retain(|reference| !self.variables[*reference as usize].is_output());
        all
    }

    /// Nominal value of a variable. For an output that is a continuous state, this is the value that the model returns
    /// to its host.
    pub fn nominal(&self, reference: Reference, variable: &Variable) -> Option<f64> {
        let state = self.states().position(|(state, _)| state == reference).filter(|_| variable.is_output());
        let of_state = state.and_then(|index| Some(self.state_nominals?[index]));
        of_state.or_else(|| self.sizes.nominal(variable))
    }

    /// The event indicators.
    pub fn indicators(&self) -> &[Reference] {
        self.continuous_time.as_ref().map_or(&[], |all| &all.indicators)
    }

    /// Dependencies of the present value of a variable: inputs, and the continuous states unless the variable changes
    /// only at events.
    pub fn dependencies_of(&self, reference: Reference) -> Cow<'_, [Reference]> {
        let variable = &self.variables[reference as usize];
        let inputs: &[Reference] = &variable.dependencies;
        let states = self.continuous_time.as_ref().map_or(&[][..], |all| &all.states);
        let stays = variable.variability == Variability::Discrete && variable.unit.is_some();
        if stays || states.is_empty() { Cow::Borrowed(inputs) } else { Cow::Owned([inputs, states].concat()) }
    }

    /// Attributes of the type element of a variable for model exchange: the variable of which it is the derivative, by
    /// a reference that counts from `first`, and the attributes of a state.
    pub fn state_attributes(&self, reference: Reference, first: Reference) -> Attributes<'static> {
        let mut attributes = Vec::new();
        let of = self.variables[reference as usize].details.derivative_of;
        if let Some(of) = self.states().find(|(_, derivative)| *derivative == reference).map(|(state, _)| state).or(of)
        {
            attributes.push(("derivative", (of + first).to_string()));
        }
        if let Some(index) = self.states().position(|(state, _)| state == reference) {
            let nominals = self.state_nominals.filter(|_| !self.variables[reference as usize].is_output());
            attributes.extend(nominals.map(|nominals| ("nominal", number(nominals[index]))));
            attributes.push(("reinit", "true".to_owned()));
        }
        attributes
    }

    /// Dependencies of the initial value of an output, if they are known.
    pub fn initial_dependencies_of(&self, reference: Reference) -> Option<&[Reference]> {
        self.initial_dependencies.as_ref().map(|all| &*all[reference as usize])
    }

    /// The vectors with their value references. These follow the reference of the time, which follows the variables.
    pub fn numbered_vectors(&self) -> impl Iterator<Item = (Reference, &Vector)> {
        (self.variables.len() as Reference + 1..).zip(&self.vectors)
    }

    /// Dependencies of a vector, the union over its elements, or those of its initial value, if they are known.
    pub fn dependencies_of_vector(&self, vector: &Vector, is_initial: bool) -> Option<Vec<Reference>> {
        let of = |element: Reference| match is_initial {
            true => self.initial_dependencies_of(element).map(Cow::Borrowed),
            false => Some(self.dependencies_of(element)),
        };
        let [first, second] = vector.elements.map(of);
        Some(first?.iter().chain(&*second?).copied().collect::<BTreeSet<_>>().into_iter().collect())
    }

    /// Attributes of the root element that all versions have. `token` is the name of the attribute with the GUID.
    pub fn header(&self, version: &str, token: &'static str) -> Attributes<'static> {
        let mut attributes = vec![
            ("fmiVersion", version.to_owned()),
            ("modelName", self.name.to_owned()),
            (token, self.guid.to_owned()),
            ("description", self.description.to_owned()),
            ("version", VERSION.to_owned()),
            ("generationTool", format!("linkage-fmu {VERSION}")),
            ("variableNamingConvention", self.naming.word().to_owned()),
        ];
        attributes.extend(self.about.iter().cloned());
        attributes
    }

    /// The common elements of all versions between interface type and variables: units, types, log categories, default
    /// experiment. The type of an Enumeration is an element with the first name, which contains an element with the
    /// second name, unless that is empty.
    pub fn write_common(&self, xml: &mut Xml, [outer, inner]: [&str; 2]) -> io::Result<()> {
        write_units(xml, self.variables)?;
        let mut enumerations = self.variables.iter().filter(|variable| !variable.details.items.is_empty()).peekable();
        if enumerations.peek().is_some() {
            group(xml, "TypeDefinitions", |xml| {
                enumerations.try_for_each(|variable| {
                    let name = [("name", type_name(variable))];
                    element(xml, outer, &name, |xml| match inner {
                        "" => write_items(xml, "Item", variable),
                        inner => group(xml, inner, |xml| write_items(xml, "Item", variable)),
                    })
                })
            })?;
        }
        group(xml, "LogCategories", |xml| {
            LOG_CATEGORIES.iter().try_for_each(|&(name, description)| {
                let name = name.to_string_lossy().into_owned();
                empty(xml, "Category", &[("name", name), ("description", description.to_owned())])
            })
        })?;
        let experiment = [
            ("startTime", number(0.0)),
            ("stopTime", number(self.experiment.stop_time)),
            ("tolerance", number(self.tolerance)),
            ("stepSize", number(self.experiment.step_size)),
        ];
        empty(xml, "DefaultExperiment", &experiment)
    }
}

/// Name of the type of an Enumeration. It must differ from the names of all variables.
pub fn type_name(variable: &Variable) -> String {
    [&variable.name, ".item"].concat()
}

/// The items of an Enumeration with their numbers, in elements with this name.
pub fn write_items(xml: &mut Xml, tag: &str, variable: &Variable) -> io::Result<()> {
    (1..).zip(variable.details.items).try_for_each(|(number, name): (usize, _)| {
        empty(xml, tag, &[("name", (*name).to_owned()), ("value", number.to_string())])
    })
}

/// Attributes of a variable that all versions have, in this order.
pub fn variable_attributes(reference: Reference, variable: &Variable) -> Attributes<'static> {
    let mut attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", reference.to_string()),
        ("description", variable.description.clone()),
    ];
    // FMI 2.0.5, 2.2.7: an input has no `initial`, and only variables with an exact value have a start value here.
    let (causality, initial) = match variable.causality {
        Causality::Parameter => ("parameter", Some("exact")),
        Causality::CalculatedParameter => ("calculatedParameter", Some("calculated")),
        Causality::Input => ("input", None),
        Causality::Output => ("output", Some("calculated")),
        Causality::Local => ("local", Some("calculated")),
    };
    let variability = match variable.variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    };
    attributes.extend([("causality", causality.to_owned()), ("variability", variability.to_owned())]);
    attributes.extend(initial.map(|initial| ("initial", initial.to_owned())));
    attributes
}
