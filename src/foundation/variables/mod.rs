//! The table of variables that a host can read and set.
//!
//! In: the names, quantities and start values of a definition. Out: one list. Reading, setting, `modelDescription.xml`,
//! its units and its ModelStructure follow from the list. The value reference of a variable is its index in the list.
//! Must not know: the FMI functions, mechanics. Causality, variability and initial have the meaning of the standard.

mod continuous;
mod terminal;
mod unit;
mod vector;

use crate::codec::checksum::fnv1a_128;
use crate::numerics::order::sorted;
use std::collections::HashSet;
use std::ops::Deref;

pub use continuous::ContinuousTime;
pub use terminal::{Member, Terminal};
pub use unit::{COMMON, Unit};
pub use vector::Vector;

/// Largest number of suggested names for an unknown name.
const SUGGESTIONS: usize = 3;

/// Index of a variable in the table; the FMI value reference.
pub type Reference = u32;

/// Type of a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 64-bit floating-point number.
    Real,
    /// One of several named items, by its number from 1 on.
    Enumeration,
    /// Truth value.
    Boolean,
}

impl Kind {
    /// Word in the GUID, which is the type of FMI 2.0.
    pub fn word(self) -> &'static str {
        match self {
            Self::Real => "Real",
            Self::Enumeration => "Enumeration",
            Self::Boolean => "Boolean",
        }
    }

    /// The type of FMI 3.0.
    pub fn word_of_fmi_3(self) -> &'static str {
        match self {
            Self::Real => "Float64",
            other => other.word(),
        }
    }
}

/// FMI 2.0.5, 2.2.7: who determines a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Causality {
    /// Set by the host before the simulation; `initial` is exact.
    Parameter,
    /// Computed by the model from parameters; `initial` is calculated.
    CalculatedParameter,
    /// Set by the host between steps; has no `initial`.
    Input,
    /// Computed by the model; `initial` is calculated.
    Output,
    /// Computed by the model, for display only and not for connections; `initial` is calculated.
    Local,
}

impl Causality {
    /// Word in the GUID and in messages.
    pub fn word(self) -> &'static str {
        match self {
            Self::Parameter => "Parameter",
            Self::CalculatedParameter => "CalculatedParameter",
            Self::Input => "Input",
            Self::Output => "Output",
            Self::Local => "Local",
        }
    }
}

/// FMI 2.0.5, 2.2.7: when a variable's value may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variability {
    /// Constant after the initialisation.
    Fixed,
    /// A parameter that the host can set between two steps.
    Tunable,
    /// Changes at communication points only.
    Discrete,
    /// Changes with time.
    Continuous,
}

impl Variability {
    /// Word in the GUID and in messages.
    pub fn word(self) -> &'static str {
        match self {
            Self::Fixed => "Fixed",
            Self::Tunable => "Tunable",
            Self::Discrete => "Discrete",
            Self::Continuous => "Continuous",
        }
    }
}

/// A start value, of the variable's kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Value of a Real.
    Real(f64),
    /// Value of a Boolean.
    Boolean(bool),
    /// Name of an item of an Enumeration.
    Item(String),
}

/// Properties of the values of a variable in addition to its kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Details {
    /// Of an Enumeration: the names of its items, in the order of their numbers. Otherwise empty.
    pub items: &'static [&'static str],
    /// Of a Real: lower and upper bound, if they exist.
    pub bounds: [Option<f64>; 2],
    /// Of a Real: typical size, if it is known.
    pub nominal: Option<f64>,
    /// Of a Real: the variable whose time derivative it is.
    pub derivative_of: Option<Reference>,
}

/// One variable of the interface.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Structured name, such as `crank.angle`.
    pub name: String,
    /// One line of text.
    pub description: String,
    /// Type of the value.
    pub kind: Kind,
    /// Origin of the value.
    pub causality: Causality,
    /// When the value may change.
    pub variability: Variability,
    /// Unit, only of a Real.
    pub unit: Option<Unit>,
    /// Start value of a parameter or input. None for computed variables.
    pub start: Option<Value>,
    /// Of an output: the inputs on which its present value depends, ascending. Of a calculated parameter: the
    /// parameters in its expression, ascending. Otherwise empty.
    pub dependencies: Vec<Reference>,
    /// Further properties of the values.
    pub details: Details,
}

impl Variable {
    /// Number of an item of an Enumeration by its name, from 1 on.
    pub fn number_of(&self, item: &str) -> Option<usize> {
        self.details.items.iter().position(|name| *name == item).map(|index| index + 1)
    }

    /// Last part of the name: `force` of `actuator.force`.
    pub fn quantity(&self) -> &str {
        self.name.rsplit_once('.').map_or(self.name.as_str(), |(_, quantity)| quantity)
    }

    /// Whether the variable is computed and can be connected.
    pub fn is_output(&self) -> bool {
        self.causality == Causality::Output
    }
}

/// The variables of a model that a host can read and set.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    list: Vec<Variable>,
    guid: String,
}

impl Interface {
    /// All variables; the index is the value reference.
    pub fn list(&self) -> &[Variable] {
        &self.list
    }

    /// The variable with this reference, if there is one.
    #[inline]
    pub fn get(&self, reference: Reference) -> Option<&Variable> {
        self.list.get(reference as usize)
    }

    /// Reference of the variable with this name.
    pub fn find(&self, name: &str) -> Option<Reference> {
        self.list.iter().position(|v| v.name == name).map(|i| i as Reference)
    }

    /// Names most similar to `name`, the most similar first, for messages. For a path in a definition, such as
    /// `bodies.crank.length` or `start.angle`, the variable of this key is the first.
    pub fn nearest(&self, name: &str) -> Vec<&str> {
        let names = || self.list.iter().map(|variable| variable.name.as_str());
        let inside = |other: &&str| other.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
        let mut all = nearest(names().filter(inside), name);
        if all.is_empty() {
            all = nearest(names(), name);
        }
        let of_key = name.split_once('.').and_then(|(group, rest)| {
            names().find(|other| match other.rsplit_once(".start_") {
                Some((_, quantity)) if group == "start" => quantity == rest,
                _ => *other == rest,
            })
        });
        if let Some(of_key) = of_key {
            all.retain(|other| *other != of_key);
            all.insert(0, of_key);
            all.truncate(SUGGESTIONS);
        }
        all
    }

    /// GUID of the interface: a hash of names, kinds, causalities, variabilities and units, not of start values.
    pub fn guid(&self) -> &str {
        &self.guid
    }
}

/// The names that are most similar to `name`, the most similar first.
pub fn nearest<'a>(names: impl Iterator<Item = &'a str>, name: &str) -> Vec<&'a str> {
    let mut names = sorted(names.collect(), |other| edits(name, other) as f64);
    names.truncate(SUGGESTIONS);
    names
}

/// Levenshtein distance: the least number of letters inserted, removed or replaced that makes one name into the other.
pub fn edits(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.bytes().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.bytes().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

/// An interface with a quantity Q for each variable. Q states which value the model looks up or computes.
#[derive(Clone, Debug, PartialEq)]
pub struct Variables<Q> {
    interface: Interface,
    quantities: Vec<Q>,
}

/// Name of two variables.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedTwice(pub String);

impl<Q: Copy> Variables<Q> {
    /// The variables of a model with this name, each with its quantity.
    ///
    /// # Errors
    /// Two variables have the same name.
    pub fn new(name: &str, list: Vec<Variable>, quantities: Vec<Q>) -> Result<Self, NamedTwice> {
        let mut names = HashSet::with_capacity(list.len());
        if let Some(twice) = list.iter().find(|v| !names.insert(v.name.as_str())) {
            return Err(NamedTwice(twice.name.clone()));
        }
        let guid = guid(name, &list);
        Ok(Self { interface: Interface { list, guid }, quantities })
    }

    /// The variables of a model whose GUID is known, so that all names are different.
    pub fn with_guid(guid: String, list: Vec<Variable>, quantities: Vec<Q>) -> Self {
        Self { interface: Interface { list, guid }, quantities }
    }

    /// Reference to [`Self::quantity`].
    #[inline]
    pub fn quantity_of(&self, reference: Reference) -> Option<&Q> {
        self.quantities.get(reference as usize)
    }

    /// Quantities of the variables, by value reference.
    pub fn quantities(&self) -> &[Q] {
        &self.quantities
    }

    /// Quantity of the variable with this reference.
    #[inline]
    pub fn quantity(&self, reference: Reference) -> Option<Q> {
        self.quantities.get(reference as usize).copied()
    }

    /// Name of the variable that represents a quantity; empty without such a variable.
    pub fn name_of(&self, quantity: Q) -> &str
    where
        Q: PartialEq,
    {
        let index = self.quantities.iter().position(|own| *own == quantity);
        index.map_or("", |index| self.interface.list[index].name.as_str())
    }
}

impl<Q> Deref for Variables<Q> {
    type Target = Interface;

    #[inline]
    fn deref(&self) -> &Interface {
        &self.interface
    }
}

/// Hash of the model's name and of each variable's name, kind, causality, variability and unit, in the form of a GUID.
/// Start values and descriptions do not change the hash.
fn guid(name: &str, list: &[Variable]) -> String {
    let fields = list.iter().flat_map(|v| {
        let unit = v.unit.map_or("", Unit::name);
        [&v.name, "\0", v.kind.word(), " ", v.causality.word(), " ", v.variability.word(), " ", unit, "\0"]
    });
    let hex = format!("{:032x}", fnv1a_128([name, "\0"].into_iter().chain(fields)));
    format!("{{{}-{}-{}-{}-{}}}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..])
}
