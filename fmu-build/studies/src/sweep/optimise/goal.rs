//! The goal of an optimisation: an objective and limits of responses.
//!
//! In: the responses of a run. Out: a cost to minimise, and the excess over each limit. The module must not know how
//! designs are chosen.

use crate::sweep::definition::{Definition, Objective};
use anyhow::{Result, bail};
use linkage_fmu::numerics::decimal::Decimal;
use serde_json::{Value, json};

/// A limit of a response.
#[derive(Clone, Debug, PartialEq)]
struct Limit {
    name: String,
    column: usize,
    /// 1: the limit is the largest value. -1: the limit is the smallest value.
    sign: f64,
    value: f64,
}

/// Objective and limits.
#[derive(Clone, Debug)]
pub struct Goal {
    name: String,
    column: usize,
    /// 1: the objective is minimised. -1: it is maximised.
    sign: f64,
    limits: Vec<Limit>,
}

/// Value of a run for the optimiser.
#[derive(Clone, Debug, PartialEq)]
pub struct Worth {
    /// Cost to minimise: the objective, with the opposite sign if it is maximised.
    pub cost: f64,
    /// For each limit the excess, which is > 0 if the limit is violated. It is relative to the limit, or absolute for
    /// the limit 0.
    pub excess: Vec<f64>,
}

impl Worth {
    /// Largest excess over a limit. 0 if all limits are satisfied.
    pub fn violation(&self) -> f64 {
        self.excess.iter().copied().fold(0.0, f64::max)
    }

    /// Whether this design is better: both satisfy all limits and its cost is smaller, or only it satisfies all limits.
    /// If both violate limits, the design with the smaller largest excess is better.
    pub fn is_better(&self, other: &Self) -> bool {
        let (own, others) = (self.violation(), other.violation());
        if own == 0.0 && others == 0.0 { self.cost < other.cost } else { own < others }
    }
}

impl Goal {
    /// The goal of a study for responses with these columns.
    ///
    /// # Errors
    /// There is no objective; a name is no column; a limit is missing, not finite, or beyond the other limit.
    pub fn new(study: &Definition, columns: &[String]) -> Result<Self> {
        let find = |key: &str, name: &str| match columns.iter().position(|column| column == name) {
            Some(column) => Ok(column),
            None => bail!("{key}: there is no response \"{name}\"; the responses are {}", columns.join(", ")),
        };
        let (sign, key, name) = match &study.objective {
            Some(Objective { minimise: Some(name), maximise: None }) => (1.0, "minimise", name),
            Some(Objective { minimise: None, maximise: Some(name) }) => (-1.0, "maximise", name),
            Some(_) => bail!("objective: give exactly one of the keys `minimise` and `maximise`"),
            None => bail!("objective: this key is missing; give the response to be minimised: {{ \"minimise\": ... }}"),
        };
        let column = find(&format!("objective.{key}"), name)?;
        let mut limits = Vec::new();
        for (name, stated) in study.constraints.iter() {
            let key = format!("constraints.{name}");
            let column = find(&key, name)?;
            if let [Some(least), Some(most)] = [stated.at_least, stated.at_most]
                && least > most
            {
                bail!("{key}: at_least = {least:?} is larger than at_most = {most:?}, so no value can satisfy both");
            }
            for (sign, what, value) in [(-1.0, "at_least", stated.at_least), (1.0, "at_most", stated.at_most)] {
                match value {
                    Some(value) if value.is_finite() => {
                        limits.push(Limit { name: name.to_owned(), column, sign, value });
                    }
                    Some(value) => bail!("{key}.{what} = {value}: must be finite"),
                    None => {}
                }
            }
            if stated.at_least.is_none() && stated.at_most.is_none() {
                bail!("{key}: the constraint has no limit; give the key `at_least`, the key `at_most`, or both");
            }
        }
        Ok(Self { name: name.clone(), column, sign, limits })
    }

    /// Number of limits.
    pub fn limits(&self) -> usize {
        self.limits.len()
    }

    /// Value of a run with these responses. None if the objective or a limited response has no value.
    pub fn worth(&self, responses: &[f64]) -> Option<Worth> {
        let cost = self.sign * responses[self.column];
        let excess = self.limits.iter().map(|limit| {
            let size = if limit.value == 0.0 { 1.0 } else { limit.value.abs() };
            limit.sign * (responses[limit.column] - limit.value) / size
        });
        let excess: Vec<f64> = excess.collect();
        let is_defined = cost.is_finite() && excess.iter().all(|excess| excess.is_finite());
        is_defined.then_some(Worth { cost, excess })
    }

    /// The objective of these responses as text.
    pub fn described(&self, responses: &[f64]) -> String {
        format!("{} = {}", self.name, Decimal(responses[self.column]))
    }

    /// The limits with the values of these responses.
    pub fn limits_with_values(&self, responses: &[f64]) -> Value {
        let described_limit = |limit: &Limit| {
            let what = if limit.sign > 0.0 { "at_most" } else { "at_least" };
            json!({ "response": limit.name, what: limit.value, "value": responses[limit.column] })
        };
        self.limits.iter().map(described_limit).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn goal(rest: &str) -> Result<Goal> {
        let text = format!(r#"{{ "mechanism": "m", "responses": {{ "r": {{ "final": "x" }} }}, {rest} }}"#);
        let study: Definition = linkage_fmu::format::read("study", &text)?;
        Goal::new(&study, &["r".to_owned(), "s".to_owned()])
    }

    #[test]
    fn a_design_within_its_limits_is_preferred() {
        let goal =
            goal(r#""objective": { "maximise": "r" }, "constraints": { "s": { "at_least": -1, "at_most": 4 } }"#)
                .unwrap();
        let worth = |r: f64, s: f64| goal.worth(&[r, s]).unwrap();
        assert_eq!(worth(7.0, 5.0), Worth { cost: -7.0, excess: vec![-6.0, 0.25] });
        assert_eq!([worth(7.0, 5.0).violation(), worth(7.0, 4.0).violation()], [0.25, 0.0]);
        assert!(worth(1.0, 4.0).is_better(&worth(7.0, 5.0)) && !worth(7.0, 5.0).is_better(&worth(1.0, 4.0)));
        assert!(worth(7.0, 0.0).is_better(&worth(6.0, 0.0)) && !worth(6.0, 0.0).is_better(&worth(6.0, 0.0)));
        assert!(worth(0.0, -1.5).is_better(&worth(9.0, -2.0)));
        assert_eq!([goal.worth(&[f64::NAN, 0.0]), goal.worth(&[0.0, f64::NAN])], [None, None]);
    }

    #[test]
    fn wrong_entries_are_errors_with_their_key() {
        for (rest, said) in [
            (r#""search": { "evaluations": 9 }"#, "objective: this key is missing"),
            (r#""objective": {}"#, "exactly one of"),
            (
                r#""objective": { "minimise": "q" }"#,
                "objective.minimise: there is no response \"q\"; the responses are r, s",
            ),
            (
                r#""objective": { "minimise": "r" }, "constraints": { "t": { "at_most": 1 } }"#,
                "constraints.t: there is no response",
            ),
            (
                r#""objective": { "minimise": "r" }, "constraints": { "s": {} }"#,
                "constraints.s: the constraint has no limit",
            ),
            (
                r#""objective": { "minimise": "r" }, "constraints": { "s": { "at_least": 2, "at_most": 1 } }"#,
                "no value can satisfy both",
            ),
        ] {
            let message = format!("{:#}", goal(rest).unwrap_err());
            assert!(message.contains(said), "{message}");
        }
    }
}
