//! The variables that a run records: the columns of its table.

use crate::start_values::find;
use anyhow::{Context, Result, bail};
use linkage_fmu::component::{Component, Refused};
use linkage_fmu::variables::{Causality, Interface, Kind, Reference, Unit, Variable};

/// A variable to record.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub(super) reference: Reference,
    /// Name of the variable.
    pub name: String,
    /// Its unit.
    pub unit: Option<Unit>,
    /// Whether it is a Boolean, recorded as 1 or 0.
    pub is_boolean: bool,
}

impl Column {
    /// The column of a Real or a Boolean.
    pub fn new(reference: Reference, variable: &Variable) -> Self {
        let is_boolean = variable.kind == Kind::Boolean;
        Self { reference, name: variable.name.clone(), unit: variable.unit, is_boolean }
    }

    #[inline]
    pub(super) fn read(&self, model: &mut Component) -> Result<f64, Refused> {
        match self.is_boolean {
            true => Ok(f64::from(u8::from(model.boolean(self.reference)?))),
            false => model.real(self.reference),
        }
    }
}

/// The variables to record: the named ones, or every numeric output, Reals before Booleans.
///
/// # Errors
/// A name is unknown or duplicate, or its variable is an Enumeration.
pub fn columns(interface: &Interface, names: &[String]) -> Result<Vec<Column>> {
    if !names.is_empty() {
        return names
            .iter()
            .enumerate()
            .map(|(k, name)| {
                if names[..k].contains(name) {
                    bail!("--output-variables: {name} occurs twice; remove one of the two");
                }
                let reference = find(interface, name).context("--output-variables")?;
                let variable = &interface.list()[reference as usize];
                if variable.kind == Kind::Enumeration {
                    bail!("--output-variables: {name} is an Enumeration; a table can contain Reals and Booleans");
                }
                Ok(Column::new(reference, variable))
            })
            .collect();
    }
    let of_kind = |kind: Kind| {
        let is_recorded = move |variable: &Variable| variable.causality == Causality::Output && variable.kind == kind;
        (0..).zip(interface.list()).filter(move |(_, variable)| is_recorded(variable))
    };
    let all = of_kind(Kind::Real).chain(of_kind(Kind::Boolean));
    Ok(all.map(|(reference, variable): (Reference, _)| Column::new(reference, variable)).collect())
}
