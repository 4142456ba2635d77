//! The variables of a model as tables.
//!
//! In: the interface. Out: rows of texts with the attributes of `modelDescription.xml`.

use crate::check::FileUnits;
use crate::xml::common::number;
use crate::xml::fmi2::kind_attributes;
use linkage_fmu::variables::{Causality, Interface, Kind, Reference, Value, Variability, Variable};
use serde::Serialize;

/// Largest number of variables of a table. `modelDescription.xml` contains the others.
const MOST_ROWS: usize = 5000;
/// Largest number of inputs that are named in one row.
const MOST_NAMES: usize = 24;

/// The variables of one causality.
#[derive(Debug, Serialize)]
pub struct Table {
    id: &'static str,
    title: &'static str,
    /// Remark about all variables of the table.
    remark: &'static str,
    has_starts: bool,
    has_ranges: bool,
    has_dependencies: bool,
    rows: Vec<Row>,
    /// Number of variables without a row.
    left_out: usize,
}

/// A variable.
#[derive(Debug, Serialize)]
struct Row {
    name: String,
    description: String,
    /// Unit, or the type of a variable without unit.
    unit: String,
    start: String,
    range: String,
    dependencies: String,
}

/// Inputs, outputs, parameters and local variables, if there are any.
pub fn tables(interface: &Interface, units: &FileUnits) -> Vec<Table> {
    let kinds = [
        ("inputs", "Inputs", "A simulation tool can set these variables between two steps.", Causality::Input),
        (
            "outputs",
            "Outputs",
            "A simulation tool can read these variables at every communication point. An output that has no value in \
             the present state is NaN, and the FMU reports a warning. The last column lists the inputs that act on an \
             output without delay. Every output can also depend on the state.",
            Causality::Output,
        ),
        (
            "parameters",
            "Parameters",
            "A simulation tool can set these variables before the start of the run. A value that a simulation tool \
             sets replaces the value of the definition.",
            Causality::Parameter,
        ),
        (
            "calculated",
            "Calculated parameters",
            "Each of these parameters is calculated from the parameters in the last column. The expression is at the \
             end of the description.",
            Causality::CalculatedParameter,
        ),
        (
            "locals",
            "Local variables",
            "These variables state the position and rotation of each body, for animations: the coordinates of the \
                origin of the body in the mechanism frame, and the rotation matrix.",
            Causality::Local,
        ),
    ];
    let inputs: Vec<Reference> = (0..)
        .zip(interface.list())
        .filter(|(_, variable)| variable.causality == Causality::Input)
        .map(|(reference, _)| reference)
        .collect();
    let tables = kinds.into_iter().map(|(id, title, remark, causality)| {
        let of_kind = || interface.list().iter().filter(|variable| variable.causality == causality);
        let rows: Vec<Row> =
            of_kind().take(MOST_ROWS).map(|variable| row(variable, interface, &inputs, units)).collect();
        let left_out = of_kind().count() - rows.len();
        let has_starts = matches!(causality, Causality::Input | Causality::Parameter);
        let has_dependencies = matches!(causality, Causality::Output | Causality::CalculatedParameter);
        let has_ranges = rows.iter().any(|row| !row.range.is_empty());
        Table { id, title, remark, has_starts, has_ranges, has_dependencies, rows, left_out }
    });
    tables.filter(|table| !table.rows.is_empty()).collect()
}

fn row(variable: &Variable, interface: &Interface, inputs: &[Reference], units: &FileUnits) -> Row {
    let attributes = kind_attributes(variable, None);
    let attribute = |name: &str| attributes.iter().find(|(key, _)| *key == name).map(|(_, value)| value.as_str());
    // The largest numbers represent no limit.
    let is_limit = |text: &&str| text.parse::<f64>().map_or(true, |value| value.abs() < 1e99);
    let kind = match (variable.kind, variable.variability) {
        (Kind::Boolean, _) => "true or false",
        (Kind::Enumeration, _) => "one of a list",
        (Kind::Real, Variability::Discrete) => "number, discrete",
        (Kind::Real, _) => "number",
    };
    Row {
        name: variable.name.clone(),
        description: variable.description.clone(),
        unit: attribute("unit").unwrap_or(kind).to_owned(),
        start: start(variable, units),
        range: match (attribute("min").filter(is_limit), attribute("max").filter(is_limit)) {
            (None, None) => String::new(),
            (Some(least), None) => format!("at least {}", short(least)),
            (None, Some(most)) => format!("at most {}", short(most)),
            (Some(least), Some(most)) => format!("{} to {}", short(least), short(most)),
        },
        dependencies: dependencies(variable, interface, inputs),
    }
}

/// The start value, also in the display unit.
fn start(variable: &Variable, units: &FileUnits) -> String {
    match &variable.start {
        None => String::new(),
        Some(Value::Boolean(value)) => value.to_string(),
        Some(Value::Item(text)) => text.clone(),
        Some(Value::Real(value)) => {
            let display = variable.unit.and_then(|unit| unit.display().or_else(|| units.of(unit.name())));
            match display.filter(|_| *value != 0.0) {
                Some((name, factor)) => format!("{} ({} {name})", rounded(*value), rounded(value * factor)),
                None => rounded(*value),
            }
        }
    }
}

/// Round to six digits.
pub fn rounded(value: f64) -> String {
    number(format!("{value:.5e}").parse().unwrap_or(value))
}

/// Round a written number to six digits.
fn short(text: &str) -> String {
    text.parse().map_or_else(|_| text.to_owned(), rounded)
}

/// The inputs on which an output depends directly, as a short text.
fn dependencies(variable: &Variable, interface: &Interface, inputs: &[Reference]) -> String {
    let own = &variable.dependencies;
    let named = |references: &mut dyn Iterator<Item = Reference>, count: usize| {
        let names = references.take(MOST_NAMES).filter_map(|reference| interface.get(reference));
        let names: Vec<&str> = names.map(|input| input.name.as_str()).collect();
        match count.saturating_sub(MOST_NAMES) {
            0 => names.join(", "),
            more => format!("{} and {more} more", names.join(", ")),
        }
    };
    if variable.causality == Causality::CalculatedParameter {
        return named(&mut own.iter().copied(), own.len());
    }
    let others = inputs.len() - own.len().min(inputs.len());
    match (own.len(), others) {
        (0, _) => "no input".to_owned(),
        (_, 0) => "every input".to_owned(),
        (count, left) if left < count => {
            // Dependencies ascend.
            let mut left_out = inputs.iter().copied().filter(|input| own.binary_search(input).is_err());
            format!("every input except {}", named(&mut left_out, left))
        }
        (count, _) => named(&mut own.iter().copied(), count),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::{MECHANISM, Workspace};
    use linkage_fmu::component::Component;

    #[test]
    fn dependencies_are_those_of_the_description() {
        let path = Workspace::locate().descriptions().join("FourBar/resources").join(MECHANISM);
        let component = Component::from_definition(MECHANISM, &std::fs::read_to_string(path).unwrap()).unwrap();
        let interface = component.interface();
        let tables = tables(interface, &FileUnits::default());
        assert_eq!(
            tables.iter().map(|table| table.id).collect::<Vec<_>>(),
            ["inputs", "outputs", "parameters", "locals"]
        );
        assert_eq!(tables.iter().map(|table| table.rows.len()).sum::<usize>(), interface.list().len());
        let row = |name: &str| tables.iter().flat_map(|table| &table.rows).find(|row| row.name == name).unwrap();
        assert_eq!(row("crank.angle").dependencies, "no input");
        let demanded = "drive.demanded_acceleration";
        assert!(row("drive.required_force").dependencies.contains("every input"), "{:?}", row("drive.required_force"));
        assert_eq!(row("crank.acceleration").dependencies, format!("every input except {demanded}"));
        assert_eq!((row("drive.torque").start.as_str(), row("drive.torque").unit.as_str()), ("0.5", "N.m"));
    }
}
