//! A study as its file states it.
//!
//! In: the text of `study.json`. Out: its sections, each key with a value of its type. It must not know the model:
//! names of variables are only texts here.

use anyhow::{Context, Result};
use fmu_build::files;
use linkage_fmu::format::{
    self, DefinitionError, Field, Json, Key, Kind, LARGEST_DEFINITION, Named, Node, Own, Slot, keys, words,
};
use std::path::Path;

keys! {
    /// A study.
    pub struct Definition {
        /// Where an editor finds the schema; not read.
        schema as "$schema": Option<String>;
        /// One line of text; not read.
        description: Option<String>;
        /// Path of the mechanism, from the folder of the study.
        mechanism: String => Key::PLAIN.required();
        /// Values that all runs share, by the name of the variable.
        start_values: Named<Setting>;
        /// What differs from run to run, by the name of the variable.
        factors: Named<Factor>;
        /// Path of a CSV file of points, from the folder of the study: a column for each factor, a line for each point.
        points: Option<String>;
        /// How the factors with a distribution are sampled.
        sampling: Option<Sampling>;
        /// What happens in each run.
        scenario: Scenario;
        /// What is reported of each run, by the name of its column.
        responses: Named<Response> => Key::PLAIN.required();
        /// What an optimisation makes small or large.
        objective: Option<Objective>;
        /// Limits of responses, by the name of the column, in an optimisation.
        constraints: Named<Limits>;
        /// How an optimisation searches.
        search: Option<Search>;
    }

    /// What an optimisation makes small or large: exactly one of its keys names a column of the responses.
    pub struct Objective {
        /// Column whose value is to be small.
        minimise: Option<String>;
        /// Column whose value is to be large.
        maximise: Option<String>;
    }

    /// Limits of a response; at least one.
    pub struct Limits: Copy {
        /// Least value that is allowed.
        at_least: Option<f64>;
        /// Largest value that is allowed.
        at_most: Option<f64>;
    }

    /// How an optimisation searches.
    pub struct Search: Copy {
        /// Most runs.
        evaluations: u64 => Key::PLAIN.required();
        /// Another seed takes another way.
        seed: u64;
    }

    /// A factor: a list, a range, a distribution, or the bounds of an optimisation.
    pub struct Factor {
        /// Values one by one.
        values: Option<Vec<Setting>>;
        /// First and last of equally spaced values.
        range: Option<[f64; 2]>;
        /// Number of values of the range.
        steps: Option<u64>;
        /// Ends of a uniform distribution.
        uniform: Option<[f64; 2]>;
        /// Normal distribution.
        normal: Option<Normal>;
        /// Least and largest value in an optimisation.
        bounds: Option<[f64; 2]>;
    }

    /// Normal distribution.
    pub struct Normal: Copy {
        /// Mean.
        mean: f64 => Key::PLAIN.required();
        /// Standard deviation, > 0.
        standard_deviation: f64 => Key::PLAIN.required();
    }

    /// How the factors with a distribution are sampled.
    pub struct Sampling: Copy {
        /// Kind of the samples.
        method: Method => Key::PLAIN.required();
        /// Number of samples, at least 1.
        count: u64 => Key::PLAIN.required();
        /// Another seed gives other samples.
        seed: u64;
    }

    /// What happens in each run.
    pub struct Scenario {
        /// Time at which the run ends [s]; none: that of the mechanism's experiment.
        stop_time: Option<f64>;
        /// The run ends when this comes true, if that is before the stop time.
        stop_at: Option<String>;
        /// Time from one communication instant to the next [s]; none: the run is one step.
        output_interval: Option<f64>;
        /// Inputs over time, by name.
        inputs: Named<Input>;
        /// Path of a CSV file of inputs over time, from the folder of the study.
        input_file: Option<String>;
    }

    /// A response: exactly one of its keys, but for `times`, names a variable.
    pub struct Response {
        /// Time at which a flag of a stop comes true.
        event: Option<String>;
        /// Value at the end of the run.
        last as "final": Option<String>;
        /// Largest value at the communication instants, and its time.
        maximum: Option<String>;
        /// Least value at the communication instants, and its time.
        minimum: Option<String>;
        /// Integral over time, by the trapezoidal rule.
        integral: Option<String>;
        /// Square root of the mean of the square over time, by the trapezoidal rule.
        root_mean_square: Option<String>;
        /// Values at the instants `times`.
        course: Option<String>;
        /// Instants of `course` [s].
        times: Option<Vec<f64>>;
    }
}

words! {
    /// Kind of samples.
    pub enum Method {
        /// Independent pseudo-random samples.
        Random = "random",
        /// One sample in each of `count` equally probable parts of every factor.
        LatinHypercube = "latin_hypercube",
        /// Sobol's sequence with a random digital shift.
        Sobol = "sobol",
        /// Saltelli's design for Sobol's indices, made of Sobol's sequence: `count` points and as many again, and for
        /// each factor the first ones with its values from the second.
        Saltelli = "saltelli",
    }
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

impl Setting {
    fn of(node: &Node) -> Option<Self> {
        match &node.json {
            Json::Number(number) => Some(Self::Real(*number)).filter(|_| number.is_finite()),
            Json::Flag(value) => Some(Self::Boolean(*value)),
            Json::Text(text) => Some(Self::Text(text.clone())),
            Json::Null | Json::List(_) | Json::Object(_) => None,
        }
    }
}

/// An input over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// The same value all the time.
    Constant(Setting),
    /// From point to point, each a time [s] and a value.
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

/// A value of several types, and what it is, in words.
macro_rules! own {
    ($type:ident, $default:expr, $words:literal, $fault:literal) => {
        impl Default for $type {
            fn default() -> Self {
                $default
            }
        }

        impl Field for $type {
            const KIND: Kind = Kind::Own($words);

            fn slot(&mut self) -> Slot<'_> {
                Slot::Own(self)
            }
        }

        impl Own for $type {
            fn take(&mut self, node: &Node, text: &str) -> Result<(), String> {
                *self = Self::of(node).ok_or_else(|| format!($fault, &text[node.span.clone()]))?;
                Ok(())
            }

            fn written(&self) -> String {
                unreachable!("a study is read only")
            }
        }
    };
}

own! { Setting, Self::Real(0.0), "a value", "{} is not a value; write a number, true, false or a text" }
own! {
    Input, Self::Constant(Setting::default()), "an input over time",
    "{} is not an input over time; write a value, or a list of points [time, value]"
}

impl Definition {
    /// Read a file; its text as well.
    ///
    /// # Errors
    /// The file cannot be read; the key at fault, with its value and what is allowed.
    pub fn read(path: &Path) -> Result<(Self, String)> {
        let shown = path.display();
        let bytes = files::read(path, LARGEST_DEFINITION)?;
        let text = String::from_utf8(bytes)
            .ok()
            .with_context(|| format!("{shown}: is not UTF-8 text; save the file as UTF-8"))?;
        let study = Self::from_json(&text).with_context(|| format!("{shown}"))?;
        Ok((study, text))
    }

    fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let study: Self = format::read("study", text)?;
        if study.responses.is_empty() {
            return Err(DefinitionError::key("responses", "is empty; add at least one response of the runs"));
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
