//! The factors of a study: parameters or inputs of the model, and their values as numbers.

use super::definition::Setting;
use anyhow::{Context, Result, bail};
use fmu_build::setting::words;
use fmu_build::start_values::{self, find};
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Causality, Kind, Reference, Unit, nearest};

/// Source of the values of a factor.
#[derive(Clone, Debug)]
pub enum Source {
    /// A list.
    List(Vec<f64>),
    /// Equally spaced values: first, last, number.
    Range(f64, f64, u64),
    /// A uniform distribution between two ends, sampled along this dimension.
    Uniform([f64; 2], usize),
    /// A normal distribution, sampled along this dimension.
    Normal(statrs::distribution::Normal, usize),
    /// A column of the file of points, by its index.
    Column(usize),
}

/// A variable that differs between runs.
#[derive(Clone, Debug)]
pub struct Factor {
    /// Its name.
    pub name: String,
    /// Its reference.
    pub reference: Reference,
    /// Its type: Real, Boolean or String.
    pub kind: Kind,
    /// Its unit.
    pub unit: Option<Unit>,
    /// The texts of a String. A value is the index of its text.
    pub texts: Vec<String>,
    /// Source of its values.
    pub source: Source,
}

/// A factor without values yet.
///
/// # Errors
/// No parameter or input has this name.
pub fn variable(key: &str, name: &str, model: &Component) -> Result<Factor> {
    let reference = settable(key, name, "a factor must be a parameter or an input", model)?;
    let variable = &model.interface().list()[reference as usize];
    let (kind, unit, source) = (variable.kind, variable.unit, Source::List(Vec::new()));
    Ok(Factor { name: name.to_owned(), reference, kind, unit, texts: Vec::new(), source })
}

/// The parameter or input of this name.
///
/// # Errors
/// No variable has the name; with `remedy` for variables that cannot be set. For a calculated parameter the message
/// names the parameters in its expression.
pub fn settable(key: &str, name: &str, remedy: &str, model: &Component) -> Result<Reference> {
    let reference = find(model.interface(), name).with_context(|| key.to_owned())?;
    let causality = model.interface().list()[reference as usize].causality;
    match causality {
        Causality::Parameter | Causality::Input => Ok(reference),
        Causality::CalculatedParameter => {
            model.check_real(reference, 0.0).with_context(|| key.to_owned())?;
            bail!("{key}: {name} is calculated from other parameters; {remedy}")
        }
        _ => {
            let settable = model.interface().list().iter();
            let settable = settable.filter(|v| matches!(v.causality, Causality::Parameter | Causality::Input));
            let nearest = nearest(settable.map(|variable| variable.name.as_str()), name).join(", ");
            bail!("{key}: {name} is an output; {remedy}; similar parameters and inputs are {nearest}")
        }
    }
}

/// A value as a number. A new text is added to the texts of the factor.
///
/// # Errors
/// The value has another type than the variable.
pub fn coded(value: &Setting, factor: &mut Factor) -> Result<f64> {
    match (factor.kind, value) {
        (Kind::Real, Setting::Real(value)) => Ok(*value),
        (Kind::Boolean, Setting::Boolean(value)) => Ok(f64::from(u8::from(*value))),
        (Kind::Enumeration, Setting::Text(text)) => {
            let known = factor.texts.iter().position(|known| known == text);
            Ok(known.unwrap_or_else(|| {
                factor.texts.push(text.clone());
                factor.texts.len() - 1
            }) as f64)
        }
        (Kind::Real, Setting::Text(text)) => start_values::number(&factor.name, factor.unit, text),
        (kind, value) => bail!("{} must be {}, not {value}", factor.name, words(kind)),
    }
}
