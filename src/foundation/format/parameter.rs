//! One parameter of a definition and its texts. The texts are joined only when they are read.
use super::fault::{DefinitionError, Fault, Faults};
use super::keys::{Key, Keyed, Kind, Slot};
use super::range::Range;
use super::role::Role;
use crate::variables::Unit;

/// A text in pieces, so that a visit of all parameters allocates no memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Text<'a>([&'a str; 7]);

impl Text<'_> {
    /// The whole text.
    pub fn concat(&self) -> String {
        self.0.concat()
    }
}

impl<'a, const N: usize> From<[&'a str; N]> for Text<'a> {
    fn from(pieces: [&'a str; N]) -> Self {
        const { assert!(N <= 7) };
        let mut all = [""; 7];
        all[..N].copy_from_slice(&pieces);
        Self(all)
    }
}

/// Function that is called with each parameter and its value.
pub type Visit<'v> = dyn FnMut(Parameter<'_>, &mut f64) + 'v;

/// Name of a coordinate in variables, and its index in the file.
pub const AXES: [(&str, &str); 2] = [("x", "[0]"), ("y", "[1]")];

/// A numeric parameter without its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter<'a> {
    /// Variable name, such as `crank.length`.
    pub name: Text<'a>,
    /// Path of the key in the file, such as `bodies.crank.length`.
    pub key: Text<'a>,
    /// One line of text.
    pub description: Text<'a>,
    /// Unit.
    pub unit: Unit,
    /// Allowed values.
    pub range: Range,
    /// The part of the model that the parameter changes.
    pub role: Role,
}

impl<'a> Parameter<'a> {
    /// Parameter with this variable name, path of the key in the file, and description.
    pub fn new<const N: usize, const K: usize, const D: usize>(
        name: [&'a str; N],
        key: [&'a str; K],
        description: [&'a str; D],
        (unit, range, role): (Unit, Range, Role),
    ) -> Self {
        Self { name: name.into(), key: key.into(), description: description.into(), unit, range, role }
    }

    /// Adds a fault with the parameter's name if the value is out of range.
    pub fn check(&self, value: f64, faults: &mut Faults) {
        // Names are joined only for a message.
        if !self.range.contains(value) {
            faults.push(DefinitionError::new(self.name.concat(), Fault::Range(value, Unit::One, self.range)));
        }
    }
}

/// A Boolean parameter without its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flag<'a> {
    /// Variable name, such as `friction.enabled`.
    pub name: Text<'a>,
    /// One line of text.
    pub description: Text<'a>,
}

/// Owner of parameters: a section that occurs once, or a named element of a group.
pub struct Owner<'a> {
    /// Group of a named element.
    pub group: Option<&'static str>,
    /// What the element is, with article and blank, such as `the body `.
    pub kind: &'static str,
    /// Name of the owner.
    pub name: &'a str,
    /// Whether the element is rotary, which determines some units.
    pub is_rotary: bool,
}

impl Owner<'_> {
    /// Visits the parameters among the keys of an object. `refine` may change or omit a key.
    pub fn parameters(&self, object: &mut dyn Keyed, refine: &dyn Fn(Key) -> Option<Key>, visit: &mut Visit) {
        self.inside("", object, refine, visit);
    }

    /// Visits the Boolean parameters among the keys of an object. Absent values are set to their defaults. In the
    /// description, @ stands for the owner's kind and name.
    pub fn flags(&self, object: &mut dyn Keyed, visit: &mut dyn FnMut(Flag, &mut bool)) {
        for (index, key) in object.table().keys.iter().enumerate().filter(|(_, key)| key.role.is_some()) {
            let mut slot = object.slot(index);
            if let (Kind::Flag, Slot::Maybe(maybe)) = (key.kind, &mut slot)
                && maybe.get().is_none()
                && let Slot::Flag(value) = maybe.make()
            {
                *value = key.absent == "true";
            }
            let value = match slot {
                Slot::Maybe(maybe) => maybe.get(),
                slot => Some(slot),
            };
            if let Some(Slot::Flag(value)) = value {
                let (before, after) = key.words.split_once('@').unwrap_or((key.words, ""));
                let [kind, named] = if after.is_empty() { ["", ""] } else { [self.kind, self.name] };
                let name = [self.name, ".", key.name].into();
                visit(Flag { name, description: [before, kind, named, after].into() }, value);
            }
        }
    }

    fn inside(&self, of: &str, object: &mut dyn Keyed, refine: &dyn Fn(Key) -> Option<Key>, visit: &mut Visit) {
        for (index, key) in object.table().keys.iter().enumerate() {
            if let Some(key) = refine(*key) {
                self.visit(of, &key, object.slot(index), refine, visit);
            }
        }
    }

    /// Visits the value of a key of the owner, or of the object `of` in the owner.
    fn visit(&self, of: &str, key: &Key, slot: Slot, refine: &dyn Fn(Key) -> Option<Key>, visit: &mut Visit) {
        match (slot, key.role) {
            (Slot::Maybe(maybe), _) => {
                if let Some(slot) = maybe.get() {
                    self.visit(of, key, slot, refine, visit);
                }
            }
            (Slot::Object(object), _) => self.inside(key.name, object, refine, visit),
            (Slot::Number(value), Some(role)) => {
                let (unit, dot) = (key.unit(self.is_rotary), if of.is_empty() { "" } else { "." });
                let (name, attributes) = ([self.name, ".", of, dot, key.name], (unit, key.range, role));
                visit(
                    match self.group {
                        Some(group) => {
                            let path = [group, ".", self.name, ".", of, dot, key.name];
                            // In the description, @ stands for the element with its kind, or for the object in it.
                            let kind = if of.is_empty() { self.kind } else { "" };
                            let words = match key.words.split_once('@') {
                                Some((before, after)) => [before, kind, self.name, dot, of, after],
                                None => [key.words, " of ", self.kind, self.name, "", ""],
                            };
                            Parameter::new(name, path, words, attributes)
                        }
                        None => Parameter::new(name, name, [key.words], attributes),
                    },
                    value,
                );
            }
            (Slot::Pair(pair), Some(role)) => {
                for ((axis, index), value) in AXES.into_iter().zip(pair) {
                    let path = [self.group.unwrap_or_default(), ".", self.name, ".", key.name, index];
                    let end = " coordinate in the body frame";
                    let description = [key.words, " of ", self.kind, self.name, ": ", axis, end];
                    let kind = (key.unit(self.is_rotary), key.range, role);
                    visit(Parameter::new([self.name, ".", key.name, "_", axis], path, description, kind), value);
                }
            }
            _ => {}
        }
    }
}
