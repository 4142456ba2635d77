//! The definition of a hydraulic actuator: the content of `hydraulics.json`, with all checks.
//!
//! In: the text of the file. Out: a [`HydraulicActuator`] whose numbers are finite and in range; the list of its
//! parameters. It must not know the laws of the circuit, nor FMI. SI units; pressures are gauge, relative to the
//! ambient pressure.
mod circuit;
mod sections;

use crate::format::{About, DefinitionError, Experiment, Owner, Parameter, Range, read};
use crate::variables::Unit;
pub use circuit::{ABOVE_VACUUM, Circuit, Supply, Tank, check_pressure, is_pressure};
pub use sections::*;
use serde::{Deserialize, Serialize};

/// What a parameter changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The laws of the circuit.
    Law,
    /// The state at the start.
    Start,
    /// The tolerance of the integration.
    Tolerance,
}

/// Function that is called with each parameter and its value.
pub type Visit<'v> = dyn FnMut(Parameter<'_, Role>, &mut f64) + 'v;

/// The first parameter out of its range; only that one is named, as names are put together.
struct Ranges(Result<(), DefinitionError>);

impl Default for Ranges {
    fn default() -> Self {
        Self(Ok(()))
    }
}

impl Ranges {
    fn check(&mut self, parameter: &Parameter<'_, Role>, value: f64) {
        if self.0.is_ok() && !parameter.range.contains(value) {
            self.0 = parameter.range.check(parameter.name.concat(), value);
        }
    }
}

/// Motion of the actuator that the host gives where it gives none: start values of inputs.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Actuator {
    /// Start value of the input `actuator.length` [m].
    pub length: f64,
    /// Start value of the input `actuator.speed` [m/s].
    pub speed: f64,
}

impl Default for Actuator {
    fn default() -> Self {
        Self { length: 0.577, speed: 0.0 }
    }
}

/// What a step does with the foreseen motion.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// A step keeps the motion that it foresees: one pass.
    #[default]
    Preview,
    /// A step moves by the inputs: two passes, or none.
    Follow,
    /// One pass in a host that hands every value on one step late.
    Delayed,
}

impl Mode {
    /// All modes.
    pub const ALL: [Self; 3] = [Self::Preview, Self::Follow, Self::Delayed];
    /// Their words, in the same order.
    pub const WORDS: [&'static str; 3] = ["preview", "follow", "delayed"];

    /// Word of the mode in the file and in the variable `coupling.mode`.
    pub fn word(self) -> &'static str {
        Self::WORDS[self as usize]
    }

    /// The mode with this word.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.word() == word)
    }
}

/// Coupling with what the actuator moves.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Coupling {
    /// What a step does with the foreseen motion.
    pub mode: Mode,
}

/// Integration settings.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Solver {
    /// Relative tolerance of the integration [1].
    pub tolerance: f64,
    /// Most steps of the integration in one communication step [1].
    pub max_steps: f64,
}

impl Default for Solver {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_steps: 5e4 }
    }
}

impl Solver {
    fn parameters(&mut self, visit: &mut Visit) {
        let mut list = Owner::new(None, "solver", Role::Tolerance, visit);
        let words = "Relative tolerance of the integration";
        list.add("tolerance", words, Unit::One, Range::Tolerance, &mut self.tolerance);
        let words = "Most steps of the integration in one communication step";
        list.add("max_steps", words, Unit::One, Range::Count, &mut self.max_steps);
    }
}

/// A hydraulic actuator as the file states it.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct HydraulicActuator {
    /// Location of the schema, for editors; not read here.
    #[serde(rename = "$schema")]
    pub schema: Option<String>,
    /// Name of the model, a C identifier.
    pub name: String,
    /// One line of text.
    #[serde(default)]
    pub description: String,
    /// Author, copyright and licence.
    #[serde(default, skip_serializing_if = "About::is_default")]
    pub about: About,
    /// Supply, valve, cylinder and oil.
    #[serde(default)]
    pub circuit: Circuit,
    /// Start values of the motion.
    #[serde(default)]
    pub actuator: Actuator,
    /// Coupling with what the actuator moves.
    #[serde(default)]
    pub coupling: Coupling,
    /// Integration settings.
    #[serde(default)]
    pub solver: Solver,
    /// Default experiment.
    #[serde(default)]
    pub experiment: Experiment,
}

impl HydraulicActuator {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message with the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let actuator: Self = read("hydraulic actuator", text)?;
        let mut letters = actuator.name.chars();
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if !letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_') || !letters.all(is_word) {
            let allowed = "a C identifier: ASCII letters, digits and underscores, not beginning with a digit";
            return Err(DefinitionError::value("name", format!("\"{}\"", actuator.name), allowed));
        }
        actuator.check()?;
        Ok(actuator)
    }

    /// Check each number and what they must be to each other.
    ///
    /// # Errors
    /// The first number out of range, with its name, its value and what is allowed.
    pub fn check(&self) -> Result<(), DefinitionError> {
        self.circuit.check()?;
        let mut ranges = Ranges::default();
        let mut solver = self.solver;
        solver.parameters(&mut |parameter, value| ranges.check(&parameter, *value));
        ranges.0?;
        Range::NonNegative.check("actuator.length", self.actuator.length)?;
        Range::Finite.check("actuator.speed", self.actuator.speed)?;
        self.about.check()?;
        self.experiment.check()
    }

    /// Call `visit` with every numeric parameter and its value, in the order of the file.
    pub fn parameters(&mut self, visit: &mut Visit) {
        self.circuit.parameters(visit);
        self.solver.parameters(visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(json: &str) -> Result<HydraulicActuator, String> {
        HydraulicActuator::from_json(json).map_err(|error| error.to_string())
    }

    #[test]
    fn what_a_file_leaves_out_has_its_default() {
        let actuator = read(r#"{ "name": "A", "circuit": { "chamber_b": { "dead_volume": 1e-5 } } }"#).unwrap();
        let circuit =
            Circuit { chamber_b: ChamberB { dead_volume: 1e-5, start_pressure: 11.15e6 }, ..Circuit::default() };
        assert_eq!(actuator.circuit, circuit);
        let mut names = Vec::new();
        actuator.clone().parameters(&mut |parameter, _| names.push(parameter.name.concat()));
        assert!(names.contains(&"seal.static".to_owned()) && names.contains(&"valve.rated_flow".to_owned()));
        let again: HydraulicActuator = serde_json::from_str(
            &serde_json::to_string(&actuator.circuit)
                .map(|circuit| format!(r#"{{"name": "A", "circuit": {circuit}}}"#))
                .unwrap(),
        )
        .unwrap();
        assert_eq!(again.circuit, actuator.circuit);
    }

    #[test]
    fn an_impossible_circuit_is_refused_with_name_value_and_limit() {
        for (circuit, texts) in [
            (r#""cylinder": { "rod": 0.05 }"#, &["cylinder.rod = 0.05", "cylinder.bore = 0.045"][..]),
            (r#""chamber_a": { "dead_volume": 0 }"#, &["chamber_a.dead_volume = 0", "> 0"]),
            (r#""tank": { "pressure": -2e5 }"#, &["tank.pressure = -200000", "-fluid.ambient_pressure", "-101325 Pa"]),
            (r#""chamber_b": { "start_pressure": -101325 }"#, &["chamber_b.start_pressure"]),
            (r#""valve": { "clearance": 0 }"#, &["valve.clearance = 0", "> 0"]),
            (r#""valve": { "clearence": 1 }"#, &["circuit.valve.clearence", "unknown field"]),
            (r#""fluid": { "air_fraction": -1e-3 }"#, &["fluid.air_fraction = -0.001", ">= 0"]),
        ] {
            let error = read(&format!(r#"{{ "name": "A", "circuit": {{ {circuit} }} }}"#)).unwrap_err();
            assert!(texts.iter().all(|text| error.contains(text)), "{error}");
        }
        assert!(read(r#"{ "name": "1A" }"#).unwrap_err().contains("C identifier"));
        assert!(read(r#"{ "name": "A", "solver": { "tolerance": 0 } }"#).unwrap_err().contains("solver.tolerance"));
        assert!(read(r#"{ "name": "A", "coupling": { "mode": "x" } }"#).unwrap_err().contains("coupling.mode"));
    }
}
