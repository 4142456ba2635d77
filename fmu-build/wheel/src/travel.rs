//! A mechanism along its travel, without time.
//!
//! In: a model with its start values, names of outputs. Out: values and rates at each position; linear models as
//! dictionaries.

use crate::errors::{input, refused};
use fmu_build::start_values::find;
use linkage_fmu::component::{Component, Linearised, NoValue};
use linkage_fmu::variables::{Causality, Kind, Reference};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Number of positions along a travel between two checks for Ctrl-C.
const POSITIONS_PER_LOOK: usize = 1 << 12;

/// Name of the rate of a position.
fn rate_of(position: &str) -> Option<String> {
    let (owner, suffix) = position.rsplit_once('.')?;
    let rate = match suffix {
        "angle" | "position" | "length" => "speed",
        "x" => "velocity_x",
        "y" => "velocity_y",
        _ => return None,
    };
    Some(format!("{owner}.{rate}"))
}

/// Values of variables along the travel without time, then their rates, then the second rates of positions.
pub fn along(model: &mut Component, count: usize, names: &[String]) -> PyResult<Vec<f64>> {
    let found = names.iter().map(|name| find(model.interface(), name)).collect::<Result<Vec<_>, _>>();
    let references: Vec<Reference> = found.map_err(input)?;
    for (&reference, name) in references.iter().zip(names) {
        let variable = &model.interface().list()[reference as usize];
        if variable.causality != Causality::Output || variable.kind != Kind::Real {
            return Err(input(format!("{name} is not an output with a number; kinematics returns outputs only")));
        }
    }
    let rates: Vec<Option<Reference>> = names.iter().map(|name| model.interface().find(&rate_of(name)?)).collect();
    let Component::Mechanism(own) = model else {
        return Err(input("a hydraulic actuator without a mechanism has no travel"));
    };
    let travel = own.sweep(count).map_err(refused)?.sigma;
    own.serve_travel().map_err(refused)?;
    model.initialize().map_err(refused)?;
    let mut rows = Vec::with_capacity(travel.len() * (1 + 3 * names.len()));
    let no_value = |error: NoValue| match error {
        NoValue::AtState(why) => refused(why),
        NoValue::Refused(why) => refused(why),
    };
    for (position, &sigma) in travel.iter().enumerate() {
        if position % POSITIONS_PER_LOOK == POSITIONS_PER_LOOK - 1 {
            Python::attach(|py| py.check_signals())?;
        }
        rows.push(sigma);
        model.set_continuous_states(&[sigma, 0.0]).map_err(no_value)?;
        model.reals(&references, |value| rows.push(value)).map_err(refused)?;
        // With this speed, rates in time are rates along the travel.
        model.set_continuous_states(&[sigma, 1.0]).map_err(no_value)?;
        for &reference in &references {
            rows.push(model.output_derivative(reference, 1).unwrap_or(f64::NAN));
        }
        for &rate in &rates {
            rows.push(rate.and_then(|rate| model.output_derivative(rate, 1).ok()).unwrap_or(f64::NAN));
        }
    }
    Ok(rows)
}

/// A linearisation as a Python dictionary. A matrix is a list of rows.
pub fn dictionary<'py>(py: Python<'py>, at: &Linearised) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("position", at.coordinate)?;
    dict.set_item("acceleration", at.acceleration)?;
    dict.set_item("holding", at.holding)?;
    dict.set_item("eigenfrequency", at.eigenfrequency())?;
    dict.set_item("damping_ratio", at.damping_ratio)?;
    dict.set_item("eigenvalues", at.eigenvalues.clone())?;
    dict.set_item("a", at.a.clone())?;
    let row = |row: usize| at.b.iter().map(|column| column[row]).collect::<Vec<_>>();
    dict.set_item("b", (0..at.a.len()).map(row).collect::<Vec<_>>())?;
    dict.set_item("c", at.c.clone())?;
    dict.set_item("d", at.d.clone())?;
    Ok(dict)
}
