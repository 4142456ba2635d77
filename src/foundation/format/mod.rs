//! Parts that every kind of definition file needs: tables of keys, JSON with places, ordered names, faults with paths,
//! parameters, and the default experiment.
//!
//! In: the text of a file. Out: a value of the definition's type, or all faults for the author of the file. Must not
//! know: the meaning of any definition.
mod about;
mod aside;
mod declare;
mod experiment;
mod expression;
mod fault;
mod json;
mod keys;
mod named;
mod numbers;
mod parameter;
mod range;
mod read;
mod role;
mod visit;
mod write;

pub use about::About;
pub use aside::Aside;
pub use declare::{keys, words};
pub use experiment::Experiment;
pub use expression::{Expression, LONGEST_EXPRESSION, is_reserved, number_with_unit};
pub use fault::{DefinitionError, Fault, Faults, Place, on_one_line};
pub use json::{Json, Member, Node, parse};
pub use keys::{
    Described, Element, Field, Group, Key, Keyed, Kind, List, Maybe, Names, Own, Short, Slot, Table, Word, curve,
    either, element, line, number, point,
};
pub use named::Named;
pub use numbers::{Numbers, index_of};
pub use parameter::{AXES, Flag, Owner, Parameter, Visit};
pub use range::Range;
pub use read::{LARGEST_DEFINITION, read, read_with};
pub use role::Role;
pub use visit::{Number, numbers};
pub use write::{quoted, written};
