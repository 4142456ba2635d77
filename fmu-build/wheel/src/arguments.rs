//! Arguments of calls from Python.
//!
//! In: Python objects. Out: numbers, names, values of variables, or an exception with the argument, the given value and
//! the expected value. All calls share one rule for values of variables, and for duplicate names in a list.

use crate::errors::{InputError, InputTypeError, input};
use fmu_build::start_values::{self, find};
use linkage_fmu::variables::{Interface, Kind, Reference, Value, Variable};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyMapping, PyString};
use std::collections::HashSet;

/// Longest text of a value in a message.
const SHOWN: usize = 60;

/// An argument of a wrong type.
#[cold]
pub fn wrong(argument: &str, given: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    InputTypeError::new_err(format!("{argument} = {}: must be {expected}", shown(given)))
}

/// A value in the form of a message.
fn shown(given: &Bound<'_, PyAny>) -> String {
    let text = given.repr().map_or_else(|_| "this object".to_owned(), |text| text.to_string());
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

/// A number.
///
/// # Errors
/// The value has another type, or is too large for a double.
pub fn number(argument: &str, given: &Bound<'_, PyAny>) -> PyResult<f64> {
    given.extract::<f64>().map_err(|error| {
        if error.is_instance_of::<pyo3::exceptions::PyOverflowError>(given.py()) {
            return InputError::new_err(format!("{argument} = {}: is too large for a number", shown(given)));
        }
        wrong(argument, given, "a number")
    })
}

/// A number, or None.
///
/// # Errors
/// As for [`number`].
pub fn optional(argument: &str, given: Option<&Bound<'_, PyAny>>) -> PyResult<Option<f64>> {
    given.map(|given| number(argument, given)).transpose()
}

/// An integer in a range.
///
/// # Errors
/// The value has another type, or is out of range.
pub fn whole<const LEAST: i64, const MOST: i64>(argument: &str, given: &Bound<'_, PyAny>) -> PyResult<i64> {
    let expected = || format!("a whole number from {LEAST} to {MOST}");
    if given.is_instance_of::<PyBool>() {
        return Err(wrong(argument, given, &expected()));
    }
    match given.extract::<i64>() {
        Ok(number) if (LEAST..=MOST).contains(&number) => Ok(number),
        Err(error) if error.is_instance_of::<pyo3::exceptions::PyTypeError>(given.py()) => {
            Err(wrong(argument, given, &expected()))
        }
        _ => Err(InputError::new_err(format!("{argument} = {}: must be {}", shown(given), expected()))),
    }
}

/// A Boolean.
///
/// # Errors
/// The value has another type.
pub fn truth(argument: &str, given: &Bound<'_, PyAny>) -> PyResult<bool> {
    given.extract().map_err(|_| wrong(argument, given, "True or False"))
}

/// A text.
///
/// # Errors
/// The value has another type.
pub fn text(argument: &str, given: &Bound<'_, PyAny>) -> PyResult<String> {
    given.extract().map_err(|_| wrong(argument, given, "a text"))
}

/// Names in a list, a tuple or similar, without duplicates.
///
/// # Errors
/// The argument is a text or no list; an entry is no text; a name is duplicate.
pub fn names(argument: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    if given.is_instance_of::<PyString>() {
        let expected = format!("a list of names; write {argument}=[{}]", shown(given));
        return Err(wrong(argument, given, &expected));
    }
    let entries = given.try_iter().map_err(|_| wrong(argument, given, "a list of names"))?;
    let mut names: Vec<String> = Vec::new();
    for entry in entries {
        let entry = entry?;
        names.push(entry.extract().map_err(|_| wrong(argument, &entry, "a list of names, each a text"))?);
    }
    let mut seen = HashSet::new();
    match names.iter().find(|name| !seen.insert(name.as_str())) {
        Some(name) => Err(InputError::new_err(format!("{argument}: {name} occurs twice; remove one of the two"))),
        None => Ok(names),
    }
}

/// The value for a variable: a number in SI units, a Boolean, the name of an item, or a text as on the command line,
/// such as "45 deg" or "true". A Boolean may be 1 or 0, an Enumeration the number of the item from 1 on, as in arrays
/// of values.
///
/// # Errors
/// The value has the wrong type, or a wrong unit.
pub fn value(variable: &Variable, given: &Bound<'_, PyAny>) -> PyResult<Value> {
    let name = &variable.name;
    if given.is_instance_of::<PyString>() {
        return start_values::value(variable, &text(name, given)?).map_err(input);
    }
    let is_truth = given.is_instance_of::<PyBool>();
    let plain = || given.extract::<f64>().ok();
    match variable.kind {
        Kind::Real if is_truth => Err(wrong(name, given, "a number, or a text with a unit")),
        Kind::Real => match given.extract::<f64>() {
            Ok(number) => Ok(Value::Real(number)),
            Err(_) if given.is_none() => Err(wrong(name, given, "a number, or a text with a unit")),
            Err(_) => number(name, given).map(Value::Real),
        },
        Kind::Boolean => match plain() {
            Some(1.0) => Ok(Value::Boolean(true)),
            Some(0.0) => Ok(Value::Boolean(false)),
            _ => Err(wrong(name, given, "True or False")),
        },
        Kind::Enumeration => {
            let items = variable.details.items;
            let item = plain().filter(|_| !is_truth).and_then(|number| {
                items.iter().zip(1_u32..).find(|(_, place)| f64::from(*place) == number).map(|(item, _)| item)
            });
            match item {
                Some(item) => Ok(Value::Item((*item).to_owned())),
                None => Err(wrong(name, given, &format!("the name of an item: {}", items.join(", ")))),
            }
        }
    }
}

/// The values for several variables, in an array, a list or similar.
///
/// # Errors
/// The argument is no list of values; it has another number of values or more dimensions; errors of [`value`].
pub fn values<'a>(
    variables: impl ExactSizeIterator<Item = &'a Variable>,
    given: &Bound<'_, PyAny>,
) -> PyResult<Vec<Value>> {
    let expected = format!("an array or a list with one value for each of the {} names", variables.len());
    let is_one = given.is_instance_of::<PyString>() || given.is_instance_of::<PyMapping>();
    let Some(entries) = given.try_iter().ok().filter(|_| !is_one) else {
        return Err(wrong("values", given, &expected));
    };
    let entries = entries.collect::<PyResult<Vec<_>>>()?;
    let dimensions = given.getattr("ndim").and_then(|number| number.extract::<usize>()).unwrap_or(1);
    if dimensions != 1 || entries.len() != variables.len() {
        let found = match dimensions {
            1 => format!("{} values", entries.len()),
            _ => format!("{dimensions} dimensions"),
        };
        let count = variables.len();
        return Err(InputError::new_err(format!(
            "values has {found}, but there are {count} names; give one value for each name"
        )));
    }
    variables.zip(&entries).map(|(variable, given)| value(variable, given)).collect()
}

/// Numbers in an array, a list or similar, as many as the names in another argument.
///
/// # Errors
/// The argument has no numbers, or a wrong number of them.
pub fn numbers(argument: &str, given: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f64>> {
    let expected = format!("an array or a list with {count} numbers, one for each name");
    let entries = given.try_iter().map_err(|_| wrong(argument, given, &expected))?;
    let all = entries.map(|entry| number(argument, &entry?)).collect::<PyResult<Vec<_>>>()?;
    if all.len() != count {
        return Err(InputError::new_err(format!("{argument} has {} numbers: must be {expected}", all.len())));
    }
    Ok(all)
}

/// Start values by name, in the order of the variables. None stands for no values.
///
/// # Errors
/// The argument is no dict; a name is unknown; errors of [`value`].
pub fn start_values(interface: &Interface, given: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<(Reference, Value)>> {
    const ARGUMENT: &str = "start_values";
    let Some(given) = given else { return Ok(Vec::new()) };
    let Ok(pairs) = given.cast::<PyMapping>() else {
        return Err(wrong(ARGUMENT, given, "a dict of names and values"));
    };
    let mut values = Vec::new();
    for pair in pairs.items()? {
        let (name, given) = pair.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>()?;
        let name: String = name.extract().map_err(|_| wrong(ARGUMENT, &name, "a dict whose keys are names"))?;
        let reference = find(interface, &name).map_err(|error| input(format!("{ARGUMENT}: {error:#}")))?;
        values.push((reference, value(&interface.list()[reference as usize], &given)?));
    }
    // Values are set in the order of the variables, like in a host, because the check of a value may depend on previous
    // ones.
    values.sort_by_key(|(reference, _)| *reference);
    Ok(values)
}
