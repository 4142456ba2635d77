//! The definition of a study.
//!
//! In: the text of `study.json`. Out: its sections, in which each key has a value of its type. The module must not know
//! the model: names of variables are only texts.

use anyhow::{Context, Result};
use fmu_build::files;
pub use fmu_build::setting::Setting;
use fmu_build::source::check_content;
use linkage_fmu::format::{
    self, DefinitionError, Field, Json, Key, Kind, LARGEST_DEFINITION, Named, Node, Own, Slot, keys, words,
};
use std::path::Path;

keys! {
    /// A study: many runs of one mechanism.
    pub struct Definition {
        /// Path of the JSON schema, for a text editor. The program does not use the key `$schema`.
        schema as "$schema": Option<String>;
        /// Description of the study, one line. The program ignores the key `description`.
        description: Option<String>;
        /// Path of the mechanism, relative to the folder of the study.
        mechanism: String => Key::PLAIN.required();
        /// Path of a parameter set of SSP (SSV file), relative to the folder of the study. The values of the parameter
        /// set apply to all runs. Values in other keys of the study replace values of the parameter set.
        parameters_file: Option<String>;
        /// Start values that are equal in all runs, by the name of the variable.
        start_values: Named<Setting>;
        /// Parameters and inputs that differ between the runs, by the name of the variable.
        factors: Named<Factor>;
        /// Path of a CSV file with combinations of values of factors, relative to the folder of the study. Each column
        /// of the CSV file is a factor, and each line is one combination of values.
        points: Option<String>;
        /// Number and kind of the random samples of factors with a distribution.
        sampling: Option<Sampling>;
        /// Duration, inputs and communication steps of each run.
        scenario: Scenario;
        /// Results that are recorded for each run, by the name of the column of the results.
        responses: Named<Response> => Key::PLAIN.required();
        /// Response that an optimisation minimises or maximises.
        objective: Option<Objective>;
        /// Limits of responses in an optimisation, by the name of the column of the results.
        constraints: Named<Limits>;
        /// Largest number of runs of an optimisation, and seed of its random numbers.
        search: Option<Search>;
    }

    /// Aim of an optimisation: exactly one of the keys `minimise` and `maximise`. The value of `minimise` or `maximise`
    /// is the name of a column of the responses.
    pub struct Objective {
        /// Column of the responses whose value the optimisation minimises.
        minimise: Option<String>;
        /// Column of the responses whose value the optimisation maximises.
        maximise: Option<String>;
    }

    /// Limits of a response: at least one of the keys `at_least` and `at_most`.
    pub struct Limits: Copy {
        /// Smallest allowed value of the response.
        at_least: Option<f64>;
        /// Largest allowed value of the response.
        at_most: Option<f64>;
    }

    /// Largest number of runs of an optimisation, and seed of its random numbers.
    pub struct Search: Copy {
        /// Largest number of runs of the optimisation.
        evaluations: u64 => Key::PLAIN.required();
        /// Start value of the random number generator (seed). A different seed results in a different search for the
        /// best design.
        seed: u64;
    }

    /// A factor: a list of values, a range, a distribution, or the bounds of an optimisation.
    pub struct Factor {
        /// List of all values of the factor.
        values: Option<Vec<Setting>>;
        /// First and last value of an equally spaced series of values of the factor. The key `steps` states the number
        /// of equally spaced values.
        range: Option<[f64; 2]>;
        /// Number of equally spaced values of the factor, from the first to the last value in the key `range`.
        steps: Option<u64>;
        /// Uniform distribution of the factor: smallest and largest value.
        uniform: Option<[f64; 2]>;
        /// Normal distribution of the factor: mean and standard deviation.
        normal: Option<Normal>;
        /// Smallest and largest value of the factor that an optimisation may choose.
        bounds: Option<[f64; 2]>;
    }

    /// Normal distribution.
    pub struct Normal: Copy {
        /// Mean of the normal distribution.
        mean: f64 => Key::PLAIN.required();
        /// Standard deviation of the normal distribution, > 0.
        standard_deviation: f64 => Key::PLAIN.required();
    }

    /// Number and kind of the random samples of factors with a distribution.
    pub struct Sampling: Copy {
        /// Method of sampling.
        method: Method => Key::PLAIN.required();
        /// Number of samples, at least 1.
        count: u64 => Key::PLAIN.required();
        /// Start value of the random number generator (seed). A different seed results in different samples.
        seed: u64;
    }

    /// Duration, inputs and communication steps of each run.
    pub struct Scenario {
        /// Time at which each run ends [s]. Default: stop time of the default experiment of the mechanism.
        stop_time: Option<f64>;
        /// Name of the Boolean output of a stop (its key `flag`). A run ends when the output that `stop_at` names
        /// becomes true, and at the latest at the stop time.
        stop_at: Option<String>;
        /// Time between two communication points [s]. Default: each run has only one communication step.
        output_interval: Option<f64>;
        /// Inputs over time, by the name of the input.
        inputs: Named<Input>;
        /// Path of a CSV file of inputs over time, relative to the folder of the study.
        input_file: Option<String>;
    }

    /// A response: exactly one key with the name of a variable. The key `times` belongs to the key `course`.
    pub struct Response {
        /// Name of the Boolean output of a stop (key `flag` of the stop). The response is the time of the first impact
        /// on the stop [s].
        event: Option<String>;
        /// Value of the variable at the end of the run.
        last as "final": Option<String>;
        /// Largest value of the variable at the communication points, and the first time at which this value occurs.
        maximum: Option<String>;
        /// Smallest value of the variable at the communication points, and the first time at which this value occurs.
        minimum: Option<String>;
        /// Integral of the variable over time, by the trapezoidal rule.
        integral: Option<String>;
        /// Root mean square of the variable over time, by the trapezoidal rule.
        root_mean_square: Option<String>;
        /// Values of the variable at the instants in the key `times`.
        course: Option<String>;
        /// Instants at which the values of the key `course` are recorded [s].
        times: Option<Vec<f64>>;
    }
}

words! {
    /// Method of sampling.
    pub enum Method {
        /// Independent pseudo-random samples.
        Random = "random",
        /// The range of every factor is divided into `count` equally probable parts. Each part contains one sample.
        LatinHypercube = "latin_hypercube",
        /// Sobol's sequence with a random digital shift.
        Sobol = "sobol",
        /// Saltelli's sampling plan, for the calculation of Sobol's sensitivity indices. The plan contains two sets of
        /// `count` points. For each factor, the plan contains one more set: the points of the first set, with the
        /// values of this factor from the second set.
        Saltelli = "saltelli",
    }
}

/// An input over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A constant value.
    Constant(Setting),
    /// Linear between points of a time [s] and a value.
    Points(Vec<[f64; 2]>),
}

impl Input {
    fn of(node: &Node) -> Option<Self> {
        let Json::List(points) = &node.json else { return Setting::of(node).map(Self::Constant) };
        let number = |node: &Node| match node.json {
            Json::Flag(value) => Some(f64::from(u8::from(value))),
            Json::Number(number) => Some(number).filter(|number| number.is_finite()),
            _ => None,
        };
        let point = |point: &Node| match &point.json {
            Json::List(pair) => match pair.as_slice() {
                [time, value] if matches!(time.json, Json::Number(_)) => Some([number(time)?, number(value)?]),
                _ => None,
            },
            _ => None,
        };
        let points = points.iter().map(point).collect::<Option<Vec<_>>>();
        points.filter(|points| !points.is_empty()).map(Self::Points)
    }
}

impl Default for Input {
    fn default() -> Self {
        Self::Constant(Setting::default())
    }
}

impl Field for Input {
    const KIND: Kind = Kind::Own("an input over time");

    fn slot(&mut self) -> Slot<'_> {
        Slot::Own(self)
    }
}

impl Own for Input {
    fn take(&mut self, node: &Node, text: &str) -> Result<(), String> {
        let stated = &text[node.span.clone()];
        *self = Self::of(node).ok_or_else(|| {
            format!("{stated} is not an input over time; write a value, or a list of points [time, value]")
        })?;
        Ok(())
    }

    fn written(&self) -> String {
        unreachable!("a study is read only")
    }
}

impl Definition {
    /// Read a file. Also returns its text.
    ///
    /// # Errors
    /// The file cannot be read; the faulty key, with its value and the allowed values.
    pub fn read(path: &Path) -> Result<(Self, String)> {
        let shown = path.display();
        let bytes = files::read(path, LARGEST_DEFINITION)?;
        let text = String::from_utf8(bytes)
            .ok()
            .with_context(|| format!("{shown}: is not UTF-8 text; save the file as UTF-8"))?;
        check_content("study", &text).with_context(|| format!("{shown}"))?;
        let study = Self::from_json(&text).with_context(|| format!("{shown}"))?;
        Ok((study, text))
    }

    fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let study: Self = format::read("study", text)?;
        if study.responses.is_empty() {
            return Err(DefinitionError::key(
                "responses",
                "the object is empty; add at least one result that is recorded for each run",
            ));
        }
        Ok(study)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn wrong_entries_are_errors_with_their_key() {
        for (text, said) in [
            (r#"{ "mechanism": "a", "responses": {} }"#, "responses: the object is empty"),
            (r#"{ "mechanism": "a" }"#, "the key `responses` is missing"),
            (r#"{ "mechanism": "a", "factor": {} }"#, "factor: there is no key `factor` here; did you mean `factors`?"),
            (r#"{ "mechanism": "a", "start_values": { "b": [1] } }"#, "start_values.b: [1] is not a value"),
            (
                r#"{ "mechanism": "a", "factors": { "b": { "steps": 1.5 } } }"#,
                "factors.b.steps: must be a whole number, not 1.5",
            ),
            (
                r#"{ "sampling": { "method": "grid", "count": 1 } }"#,
                "sampling.method: must be `random`, `latin_hypercube`, `sobol` or `saltelli`, not `grid`",
            ),
            (r#"{ "scenario": { "inputs": { "f": [[0, 1], 2] } } }"#, "scenario.inputs.f: [[0, 1], 2] is not an input"),
        ] {
            let message = Definition::from_json(text).unwrap_err().to_string();
            assert!(message.contains(said), "{message}");
        }
    }

    #[test]
    fn inputs_are_constants_or_points() {
        let text = r#"{ "mechanism": "a", "responses": { "r": { "final": "x" } },
            "scenario": { "inputs": { "f": 2, "lock": [[0, false], [0.5, true]] } } }"#;
        let inputs = Definition::from_json(text).unwrap().scenario.inputs;
        assert_eq!(inputs.get("f"), Some(&Input::Constant(Setting::Real(2.0))));
        assert_eq!(inputs.get("lock"), Some(&Input::Points(vec![[0.0, 0.0], [0.5, 1.0]])));
    }
}
