//! A study as its file states it.
//!
//! In: the text of `study.json`. Out: its sections, each key with a value of its type. It must not know the model: names of
//! variables are only texts here.

use anyhow::{Context, Result};
use fmu_build::files;
use linkage_fmu::format::{self, DefinitionError, LARGEST_DEFINITION, Named};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::path::Path;

/// A study.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// Where an editor finds the schema; not read.
    #[serde(rename = "$schema", default)]
    _schema: Option<String>,
    /// One line of text; not read.
    #[serde(rename = "description", default)]
    _description: Option<String>,
    /// Path of the mechanism, from the folder of the study.
    pub mechanism: String,
    /// Values that all runs share, by the name of the variable.
    #[serde(default)]
    pub start_values: Named<Setting>,
    /// What differs from run to run, by the name of the variable.
    #[serde(default)]
    pub factors: Named<Factor>,
    /// Path of a CSV file of points, from the folder of the study: a column for each factor, a line for each point.
    pub points: Option<String>,
    /// How the factors with a distribution are sampled.
    pub sampling: Option<Sampling>,
    /// What happens in each run.
    #[serde(default)]
    pub scenario: Scenario,
    /// What is told of each run, by the name of its column.
    pub responses: Named<Response>,
    /// What an optimisation makes small or large.
    pub objective: Option<Objective>,
    /// Limits of responses, by the name of the column, in an optimisation.
    #[serde(default)]
    pub constraints: Named<Limits>,
    /// How an optimisation searches.
    pub search: Option<Search>,
}

/// What an optimisation makes small or large: exactly one of its keys names a column of the responses.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Objective {
    /// Column whose value is to be small.
    pub minimise: Option<String>,
    /// Column whose value is to be large.
    pub maximise: Option<String>,
}

/// Limits of a response; at least one.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Least value that is allowed.
    pub at_least: Option<f64>,
    /// Largest value that is allowed.
    pub at_most: Option<f64>,
}

/// How an optimisation searches.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Search {
    /// Most runs.
    pub evaluations: u64,
    /// Another seed takes another way.
    #[serde(default)]
    pub seed: u64,
}

/// Value of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// Of a Real.
    Real(f64),
    /// Of a Boolean.
    Boolean(bool),
    /// Of a String.
    Text(String),
}

impl<'de> Deserialize<'de> for Setting {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Value::deserialize(deserializer)? {
            Value::Number(number) => number.as_f64().map(Self::Real).ok_or_else(|| D::Error::custom("too large")),
            Value::Bool(value) => Ok(Self::Boolean(value)),
            Value::String(text) => Ok(Self::Text(text)),
            other => Err(D::Error::custom(format!("{other} is no value; write a number, true, false or a text"))),
        }
    }
}

/// A factor: a list, a range, a distribution, or the bounds of an optimisation.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Factor {
    /// Values one by one.
    pub values: Option<Vec<Setting>>,
    /// First and last of equally spaced values.
    pub range: Option<[f64; 2]>,
    /// Number of values of the range.
    pub steps: Option<u64>,
    /// Ends of a uniform distribution.
    pub uniform: Option<[f64; 2]>,
    /// Normal distribution.
    pub normal: Option<Normal>,
    /// Least and largest value in an optimisation.
    pub bounds: Option<[f64; 2]>,
}

/// Normal distribution.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Normal {
    /// Mean.
    pub mean: f64,
    /// Standard deviation, > 0.
    pub standard_deviation: f64,
}

/// How the factors with a distribution are sampled.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Kind of the samples.
    pub method: Method,
    /// Number of samples, at least 1.
    pub count: u64,
    /// Another seed gives other samples.
    #[serde(default)]
    pub seed: u64,
}

/// Kind of samples.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Independent pseudo-random samples.
    Random,
    /// One sample in each of `count` equally probable parts of every factor.
    LatinHypercube,
    /// Sobol's sequence with a random digital shift.
    Sobol,
    /// Saltelli's design for Sobol's indices, made of Sobol's sequence: `count` points and as many again, and for each factor
    /// the first ones with its values from the second.
    Saltelli,
}

/// What happens in each run.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Time at which the run ends [s]; none: that of the mechanism's experiment.
    pub stop_time: Option<f64>,
    /// The run ends when this comes true, if that is before the stop time.
    pub stop_at: Option<String>,
    /// Time from one communication instant to the next [s]; none: the run is one step.
    pub output_interval: Option<f64>,
    /// Inputs over time, by name.
    #[serde(default)]
    pub inputs: Named<Input>,
    /// Path of a CSV file of inputs over time, from the folder of the study.
    pub input_file: Option<String>,
}

/// An input over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// The same value all the time.
    Constant(Setting),
    /// From point to point, each a time [s] and a value.
    Points(Vec<[f64; 2]>),
}

impl<'de> Deserialize<'de> for Input {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(deserializer)?;
        let said = format!("{value} is no input over time; write a value, or a list of points [time, value]");
        if value.is_array() {
            let number = |value: &Value| match value {
                Value::Bool(value) => Some(f64::from(u8::from(*value))),
                value => value.as_f64(),
            };
            let point = |point: &Value| match point.as_array()?.as_slice() {
                [time, value] => Some([time.as_f64()?, number(value)?]),
                _ => None,
            };
            let points = value.as_array().into_iter().flatten().map(point).collect::<Option<Vec<_>>>();
            return points.filter(|points| !points.is_empty()).map(Self::Points).ok_or_else(|| D::Error::custom(said));
        }
        Setting::deserialize(value).map(Self::Constant).map_err(|_| D::Error::custom(said))
    }
}

/// A response: exactly one of its keys, but for `times`, names a variable.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Response {
    /// Time at which a flag of a stop comes true.
    pub event: Option<String>,
    /// Value at the end of the run.
    #[serde(rename = "final")]
    pub last: Option<String>,
    /// Largest value at the communication instants, and its time.
    pub maximum: Option<String>,
    /// Least value at the communication instants, and its time.
    pub minimum: Option<String>,
    /// Integral over time, by the trapezoidal rule.
    pub integral: Option<String>,
    /// Square root of the mean of the square over time, by the trapezoidal rule.
    pub root_mean_square: Option<String>,
    /// Values at the instants `times`.
    pub course: Option<String>,
    /// Instants of `course` [s].
    pub times: Option<Vec<f64>>,
}

impl Definition {
    /// Read a file; its text as well.
    ///
    /// # Errors
    /// The file cannot be read; the key at fault, with its value and what is allowed.
    pub fn read(path: &Path) -> Result<(Self, String)> {
        let shown = path.display();
        let bytes = files::read(path, LARGEST_DEFINITION)?;
        let text =
            String::from_utf8(bytes).ok().with_context(|| format!("{shown}: is not UTF-8 text; save it as UTF-8"))?;
        let study = Self::from_json(&text).with_context(|| format!("{shown}"))?;
        Ok((study, text))
    }

    fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let study: Self = format::read("study", text)?;
        if study.responses.is_empty() {
            return Err(DefinitionError::key("responses", "is empty; name at least one response of the runs"));
        }
        Ok(study)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_named() {
        for (text, said) in [
            (r#"{ "mechanism": "a", "responses": {} }"#, "responses: is empty"),
            (r#"{ "mechanism": "a" }"#, "missing field `responses`"),
            (r#"{ "mechanism": "a", "factor": {} }"#, "factor: unknown field `factor`"),
            (r#"{ "mechanism": "a", "start_values": { "b": [1] } }"#, "start_values.b: [1] is no value"),
            (r#"{ "mechanism": "a", "factors": { "b": { "steps": 1.5 } } }"#, "factors.b.steps: invalid type"),
            (r#"{ "sampling": { "method": "grid", "count": 1 } }"#, "sampling.method: unknown variant `grid`"),
            (r#"{ "scenario": { "inputs": { "f": [[0, 1], 2] } } }"#, "scenario.inputs.f: [[0,1],2] is no input"),
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
