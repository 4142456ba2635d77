//! What describes a model before it runs: names, variables, terminals, default experiment.
use super::{GUID, Model};
use crate::format::{About, Experiment};
use crate::inspection::Finding;
use crate::mechanism::error::ModelError;
use crate::mechanism::interface;
use crate::mechanism::quantity::{ImpactPart, Output, Quantity};
use crate::mechanism::reduced::Reduced;
use crate::mechanism::warnings::remarks;
use crate::variables::{Reference, Terminal, Variables, Vector};

impl Model {
    /// Name of the mechanism, the FMU's modelName and modelIdentifier.
    pub fn name(&self) -> &str {
        &self.original.parameter_values.mechanism().name
    }

    /// Author, copyright and licence.
    pub fn about(&self) -> &About {
        &self.original.parameter_values.mechanism().about
    }

    /// One-line description of the mechanism.
    pub fn description(&self) -> &str {
        &self.original.parameter_values.mechanism().description
    }

    /// Whether a circuit or a network drives the mechanism.
    pub fn has_hydraulics(&self) -> bool {
        self.original.reduced.loading().first_port().is_some()
    }

    /// The variables that the host sees.
    pub fn variables(&self) -> &Variables<Quantity> {
        &self.original.variables
    }

    /// For each variable, if it is an output: the inputs and parameters on which its initial value depends, ascending.
    /// None for a definition so large that finding them would take minutes. They are found once.
    ///
    /// # Errors
    /// A parameter that may not change a little.
    pub fn initial_dependencies(&self) -> Result<Option<Vec<Vec<Reference>>>, ModelError> {
        if let Some(known) = self.original.dependencies.get() {
            return Ok(known.clone());
        }
        let found = interface::initial_dependencies(self.original.parameter_values.mechanism())?;
        Ok(self.original.dependencies.get_or_init(|| found).clone())
    }

    /// The variables of each drive, as one connection.
    pub fn terminals(&self) -> Vec<Terminal> {
        interface::terminals(self.variables())
    }

    /// Reactions, and positions, velocities and accelerations of markers, as vectors.
    pub fn vectors(&self) -> Vec<Vector> {
        interface::vectors(self.variables())
    }

    /// Of a Boolean output that tells whether the mechanism is at a stop: the outputs that tell the number of impacts
    /// on this stop and the time of the last one. None for any other variable.
    pub fn impacts_of(&self, flag: Reference) -> Option<[Reference; 2]> {
        let variables = self.variables();
        let Some(Quantity::AtStop(stop)) = variables.quantity(flag) else { return None };
        let of = |part| {
            let is = |reference: &Reference| {
                variables.quantity(*reference) == Some(Quantity::Output(Output::Impact { stop, part }))
            };
            (0..variables.list().len() as Reference).find(is)
        };
        Some([of(ImpactPart::Count)?, of(ImpactPart::Time)?])
    }

    /// What the definition gives reason to warn of, for logs.
    pub fn warnings(&self) -> &[Finding] {
        &self.original.warnings
    }

    /// What was done to the definition so that it gives the mechanism that is meant, for logs.
    pub fn remarks(&self) -> Vec<String> {
        remarks(&self.original.reduced, self.original.parameter_values.mechanism().snap())
    }

    /// The tables of the definition, as sections for [`Model::with_tables`]; with those that friction needs when it is
    /// switched. None where the curve cannot be kept.
    pub fn sections(&self) -> Vec<(String, Vec<u8>)> {
        let reduced = &self.original.reduced;
        let mut all = reduced.sections();
        let mut switched = self.original.parameter_values.mechanism().clone();
        if let (Some(friction), false) = (&mut switched.friction, all.is_empty()) {
            friction.enabled = Some(!friction.enabled.unwrap_or(false));
            let loads = Reduced::renewed(&[reduced], &switched).map(|other| other.state_load_sections());
            all.extend(loads.unwrap_or_default());
        }
        if !all.is_empty() {
            all.push((GUID.to_owned(), self.variables().guid().as_bytes().to_vec()));
        }
        all
    }

    /// Default experiment.
    pub fn experiment(&self) -> Experiment {
        self.original.parameter_values.mechanism().experiment
    }

    /// Whether a run can move the mechanism: without masses only if a drive has a motion.
    pub fn can_move(&self) -> bool {
        !self.original.reduced.linkage().is_massless || self.original.reduced.loading().motion.is_some()
    }
}
