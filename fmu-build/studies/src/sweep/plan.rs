//! The data of a study for the workers of a cluster, as JSON.
//!
//! In: the common data of all runs. Out: variables by reference, steps, responses, and texts of messages, so that
//! messages are equal.

use super::responses::{Measure, Responses};
use super::run::Task;
use super::scenario::{Event, Set, Step};
use fmu_build::run::signals::Setting;
use linkage_fmu::numerics::decimal::Decimal;
use linkage_fmu::variables::{Interface, Kind, Reference};
use serde_json::{Value, json};

/// The plan of a study for a model with this interface.
pub fn plan(task: &Task, interface: &Interface) -> Value {
    let Task { factors, calls, scenario, responses } = task;
    let name = |reference: Reference| interface.list()[reference as usize].name.as_str();
    let calls = calls.iter().map(|call| {
        let references: Vec<_> = call.factors.iter().map(|index| factors[*index].reference).collect();
        let texts: Vec<_> = call.factors.iter().map(|index| &factors[*index].texts).collect();
        let names: Vec<_> = call.factors.iter().map(|index| &factors[*index].name).collect();
        json!([word(call.kind), call.factors, references, names, texts])
    });
    let (reals, others) = &scenario.start;
    let reals = reals.iter().map(|(references, values)| json!(["real", references, values]));
    let others = others.iter().map(|(reference, set)| {
        let (kind, value) = match set {
            Set::Input(setting) => kind_and_value(*setting),
            Set::Text(text) => ("text", json!(text)),
        };
        json!([kind, [reference], [value]])
    });
    let event = |event: &Event| json!({ "name": name(event.flag), "count": event.count, "time": event.time });
    json!({
        "factors": factors.len(),
        "calls": calls.collect::<Vec<_>>(),
        "start": reals.chain(others).collect::<Vec<_>>(),
        "steps": scenario.steps.iter().map(step).collect::<Vec<_>>(),
        "stop_at": scenario.stop_at.as_ref().map(event),
        "stop_label": Decimal(scenario.stop()).to_string(),
        "events": responses.events.iter().map(event).collect::<Vec<_>>(),
        "responses": described(responses, name),
        "columns": responses.columns.len(),
    })
}

/// Name of a type of variables in the plan.
fn word(kind: Kind) -> &'static str {
    match kind {
        Kind::Real => "real",
        Kind::Boolean => "boolean",
        Kind::Enumeration => "text",
    }
}

fn step(step: &Step) -> Value {
    let settings = step.settings.iter().map(|(reference, setting)| {
        let (kind, value) = kind_and_value(*setting);
        json!([kind, [reference], [value]])
    });
    json!({
        "start": step.start, "end": step.end,
        "label": Decimal(step.start).to_string(), "end_label": Decimal(step.end).to_string(),
        "settings": settings.collect::<Vec<_>>(),
    })
}

fn kind_and_value(setting: Setting) -> (&'static str, Value) {
    match setting {
        Setting::Real(value) => ("real", json!(value)),
        Setting::Slope(slope) => ("slope", json!(slope)),
        Setting::Boolean(value) => ("boolean", json!(value)),
    }
}

fn described<'a>(responses: &Responses, name: impl Fn(Reference) -> &'a str) -> Vec<Value> {
    let one = |response: &super::responses::Response| {
        let mut value = json!({
            "reference": response.observed.reference, "is_boolean": response.observed.is_boolean,
            "name": name(response.observed.reference), "column": response.column,
        });
        let (measure, key, more) = match &response.measure {
            Measure::Event(index) => ("event", "event", json!(index)),
            Measure::Final => ("final", "", Value::Null),
            Measure::Extreme(sign) => ("extreme", "sign", json!(sign)),
            Measure::Integral => ("integral", "", Value::Null),
            Measure::RootMeanSquare => ("root_mean_square", "", Value::Null),
            Measure::Course(times) => ("course", "times", json!(times)),
        };
        value["measure"] = json!(measure);
        if !key.is_empty() {
            value[key] = more;
        }
        value
    };
    responses.list.iter().map(one).collect()
}
