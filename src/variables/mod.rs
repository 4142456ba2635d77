//! The table of variables: what a host can read and set.
//!
//! In: the names, quantities and start values of a definition. Out: one list that drives get and set, the generated
//! `modelDescription.xml`, its units and its ModelStructure. A variable's value reference is its index in the list.
//! It must not know the FMI functions, nor any mechanics; causality, variability and initial are the standard's words.

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
pub use unit::Unit;
pub use vector::Vector;

/// Names suggested for one that no variable has.
const SUGGESTIONS: usize = 3;

/// Index of a variable in the table; the FMI value reference.
pub type Reference = u32;

/// Type of a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 64-bit floating-point number.
    Real,
    /// One of some items with names, by its number from 1 on.
    Enumeration,
    /// Truth value.
    Boolean,
}

impl Kind {
    /// Word in the GUID; the type of FMI 2.0.
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
    /// Fixed by the host before the simulation; `initial` is exact.
    Parameter,
    /// Computed here from parameters; `initial` is calculated.
    CalculatedParameter,
    /// Set by the host between steps; carries no `initial`.
    Input,
    /// Computed here; `initial` is calculated.
    Output,
    /// Computed here, to be looked at and not to be connected; `initial` is calculated.
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
    /// Constant once initialised.
    Fixed,
    /// Of a parameter: changes when the host sets it between two steps.
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

/// What is known of the values of a variable besides its kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Details {
    /// Of an Enumeration: the names of its items, in the order of their numbers; else empty.
    pub items: &'static [&'static str],
    /// Of a Real: least and largest value, where there are such.
    pub bounds: [Option<f64>; 2],
    /// Of a Real: usual size, where it is known.
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
    /// Who determines the value.
    pub causality: Causality,
    /// When the value may change.
    pub variability: Variability,
    /// Unit; only a Real has one.
    pub unit: Option<Unit>,
    /// Start value: of every parameter and input, of nothing that is computed.
    pub start: Option<Value>,
    /// Of an output: the inputs on which its present value depends, ascending. Of a calculated parameter: the
    /// parameters that decide it, ascending. Else empty.
    pub dependencies: Vec<Reference>,
    /// What is known of its values.
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

/// The variables of a model: what a host can read and set.
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

    /// Names spelled most like this one, the nearest first, for messages. Of a path in a definition, such as
    /// `bodies.crank.length` or `start.angle`, the variable of this key is the nearest.
    pub fn nearest(&self, name: &str) -> Vec<&str> {
        let names = || self.list.iter().map(|variable| variable.name.as_str());
        let mut all = nearest(names(), name);
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

/// Those of some names that are spelled most like this one, the nearest first.
pub fn nearest<'a>(names: impl Iterator<Item = &'a str>, name: &str) -> Vec<&'a str> {
    let mut names = sorted(names.collect(), |other| edits(name, other) as f64);
    names.truncate(SUGGESTIONS);
    names
}

/// Levenshtein's distance: the least number of letters inserted, removed or replaced to make one name of the other.
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

/// An interface with the quantity Q that the model looks up or computes for each variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variables<Q> {
    interface: Interface,
    quantities: Vec<Q>,
}

/// Name that two variables have.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedTwice(pub String);

impl<Q: Copy> Variables<Q> {
    /// The variables of a model of this name, each with its quantity.
    ///
    /// # Errors
    /// Two variables of one name.
    pub fn new(name: &str, list: Vec<Variable>, quantities: Vec<Q>) -> Result<Self, NamedTwice> {
        let mut names = HashSet::with_capacity(list.len());
        if let Some(twice) = list.iter().find(|v| !names.insert(v.name.as_str())) {
            return Err(NamedTwice(twice.name.clone()));
        }
        let guid = guid(name, &list);
        Ok(Self { interface: Interface { list, guid }, quantities })
    }

    /// The variables of a model of which the GUID is known, so that no two have one name.
    pub fn with_guid(guid: String, list: Vec<Variable>, quantities: Vec<Q>) -> Self {
        Self { interface: Interface { list, guid }, quantities }
    }

    /// [`Self::quantity`], in its place.
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
}

impl<Q> Deref for Variables<Q> {
    type Target = Interface;

    #[inline]
    fn deref(&self) -> &Interface {
        &self.interface
    }
}

/// Hash of the model's name and of each variable's name, kind, causality, variability and unit, in the form of a GUID.
/// Start values and descriptions do not enter it.
fn guid(name: &str, list: &[Variable]) -> String {
    let fields = list.iter().flat_map(|v| {
        let unit = v.unit.map_or("", Unit::name);
        [&v.name, "\0", v.kind.word(), " ", v.causality.word(), " ", v.variability.word(), " ", unit, "\0"]
    });
    let hex = format!("{:032x}", fnv1a_128([name, "\0"].into_iter().chain(fields)));
    format!("{{{}-{}-{}-{}-{}}}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..])
}
