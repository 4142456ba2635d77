//! Tables of keys. Each key of a definition is declared once. Reading, writing, parameters, the schema and the
//! reference pages follow from its row.
//!
//! In: the declarations of [`keys!`](super::keys!) and [`words!`](super::words!). Out: for each struct its table, and
//! its values by the rows of the table. Must not know: what a key means to a model.
use super::json::Node;
use super::named::Named;
use super::range::Range;
use super::role::Role;
use crate::variables::Unit;

/// Kind of the value of a key.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A number, or an expression if the definition allows expressions.
    Number,
    /// A number without a fraction.
    Whole,
    /// true or false.
    Flag,
    /// A text.
    Text,
    /// Two numbers.
    Pair,
    /// One of these words.
    Word(&'static [&'static str]),
    /// An object with the keys of this table.
    Object(&'static Table),
    /// An object of values by name.
    Group(&'static Kind),
    /// A list of values.
    List(&'static Kind),
    /// A value that the model reads and writes itself. The text describes the value.
    Own(&'static str),
}

/// Meaning of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Names {
    /// Free text.
    Nothing,
    /// Free text on one line.
    Line,
    /// Name of an element of the definition.
    Element,
    /// Name of a point, as `body.point`.
    Point,
}

/// The row of a key in the table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Name in the file.
    pub name: &'static str,
    /// Kind of the value.
    pub kind: Kind,
    /// Whether the key is required.
    pub is_required: bool,
    /// Whether the written form omits the key if it has its default.
    pub is_brief: bool,
    /// Whether the key exists only in the written form, and not in a file.
    pub is_written_only: bool,
    /// For a text: its meaning.
    pub names: Names,
    /// For a number: its units for linear and for rotary elements.
    pub units: [Unit; 2],
    /// For pairs whose second number is a different quantity: the units of the second number.
    pub second: Option<[Unit; 2]>,
    /// For a number: the allowed values.
    pub range: Range,
    /// For a parameter: the part of the model that it changes.
    pub role: Option<Role>,
    /// For a parameter: the description of its variable, without the owner's name.
    pub words: &'static str,
    /// The value of an absent key, as JSON. Empty if the struct's default states the value, or if there is none.
    pub absent: &'static str,
}

impl Key {
    /// A key with only a name and a kind, which the declaration states.
    pub const PLAIN: Self = Self {
        name: "",
        kind: Kind::Flag,
        is_required: false,
        is_brief: false,
        is_written_only: false,
        names: Names::Nothing,
        units: [Unit::One; 2],
        second: None,
        range: Range::Finite,
        role: None,
        words: "",
        absent: "",
    };

    /// A required key.
    pub const fn required(self) -> Self {
        Self { is_required: true, ..self }
    }

    /// A key that the written form omits if it has its default.
    pub const fn brief(self) -> Self {
        Self { is_brief: true, ..self }
    }

    /// A key with this value, as JSON, if it is absent.
    pub const fn absent(self, json: &'static str) -> Self {
        Self { absent: json, ..self }
    }

    /// A parameter, with the part of the model that it changes and the description of its variable.
    pub const fn parameter(self, role: Role, words: &'static str) -> Self {
        Self { role: Some(role), words, ..self }
    }

    /// Unit of the number, for a rotary or linear drive or load.
    pub const fn unit(&self, is_rotary: bool) -> Unit {
        self.units[is_rotary as usize]
    }
}

/// The row of a number with one unit and a range.
pub const fn number(unit: Unit, range: Range) -> Key {
    Key { units: [unit; 2], range, ..Key::PLAIN }
}

/// The row of a number with different units for linear and rotary elements.
pub const fn either(units: [Unit; 2], range: Range) -> Key {
    Key { units, range, ..Key::PLAIN }
}

/// The row of the points of a curve. `first`, `second`: units of the first and second numbers, each for linear and
/// rotary elements.
pub const fn curve(first: [Unit; 2], second: [Unit; 2], range: Range) -> Key {
    Key { units: first, second: Some(second), range, ..Key::PLAIN }
}

/// The row of a line of text.
pub const fn line() -> Key {
    Key { names: Names::Line, ..Key::PLAIN }
}

/// The row of a text with the name of an element.
pub const fn element() -> Key {
    Key { names: Names::Element, ..Key::PLAIN }
}

/// The row of a text with the name of a point.
pub const fn point() -> Key {
    Key { names: Names::Point, ..Key::PLAIN }
}

/// Short form that may replace an object.
#[derive(Clone, Copy, Debug)]
pub enum Short {
    /// No short form.
    None,
    /// The value of the first key alone.
    First,
    /// This word, which means that the last key is true.
    Word(&'static str),
}

/// The keys of an object.
#[derive(Debug)]
pub struct Table {
    /// The rows, in the order of the written form.
    pub keys: &'static [Key],
    /// Short form that may replace the object.
    pub short: Short,
}

impl Table {
    /// Index of the key with this name, if a file may contain the key.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.keys.iter().position(|key| key.name == name && !key.is_written_only)
    }

    /// Names of all keys that a file may contain.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        self.keys.iter().filter(|key| !key.is_written_only).map(|key| key.name)
    }
}

impl PartialEq for Table {
    /// A table is equal only to itself.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// Mutable access to a value of a definition.
pub enum Slot<'a> {
    /// A number.
    Number(&'a mut f64),
    /// A number without a fraction.
    Whole(&'a mut u64),
    /// true or false.
    Flag(&'a mut bool),
    /// A text.
    Text(&'a mut String),
    /// Two numbers.
    Pair(&'a mut [f64; 2]),
    /// One of some words.
    Word(&'a mut dyn Word),
    /// An object.
    Object(&'a mut dyn Keyed),
    /// Values by name.
    Group(&'a mut dyn Group),
    /// Values in order.
    List(&'a mut dyn List),
    /// A value that may be absent.
    Maybe(&'a mut dyn Maybe),
    /// A value that the model reads and writes itself.
    Own(&'a mut dyn Own),
}

impl Slot<'_> {
    /// Whether the value exists and is not empty.
    pub fn is_given(self) -> bool {
        match self {
            Self::Number(_) | Self::Whole(_) | Self::Pair(_) => true,
            Self::Flag(flag) => *flag,
            Self::Text(text) => !text.is_empty(),
            Self::Word(word) => word.index() != 0,
            Self::Object(object) => object.gives_any(),
            Self::Group(group) => group.entry(0).is_some(),
            Self::List(list) => list.element(0).is_some(),
            Self::Maybe(maybe) => maybe.get().is_some(),
            Self::Own(own) => !own.written().is_empty(),
        }
    }
}

/// A struct with a table of keys.
pub trait Keyed {
    /// The table.
    fn table(&self) -> &'static Table;

    /// The value of the key with this index.
    fn slot(&mut self, index: usize) -> Slot<'_>;
}

impl dyn Keyed + '_ {
    /// Whether a key is given.
    pub fn gives(&mut self, name: &str) -> bool {
        self.table().position(name).is_some_and(|index| self.slot(index).is_given())
    }

    /// Whether any key is given.
    fn gives_any(&mut self) -> bool {
        (0..self.table().keys.len()).any(|index| self.slot(index).is_given())
    }
}

/// Table and descriptions of a struct, for schema and reference.
pub trait Described {
    /// The table.
    const TABLE: &'static Table;
    /// Description of the struct.
    const ABOUT: &'static str;
    /// Description of each key, in the order of the table.
    const DOCS: &'static [&'static str];
}

/// A struct of a definition, for schema and reference.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// Name in the schema and reference. Empty for the whole definition.
    pub name: &'static str,
    /// Table of keys.
    pub table: &'static Table,
    /// Description of the struct.
    pub about: &'static str,
    /// Description of each key.
    pub docs: &'static [&'static str],
    /// The element with all its defaults.
    pub make: fn() -> Box<dyn Keyed>,
}

impl Element {
    /// The element of this type.
    pub const fn of<T: Described + Keyed + Default + 'static>(name: &'static str) -> Self {
        Self { name, table: T::TABLE, about: T::ABOUT, docs: T::DOCS, make: || Box::new(T::default()) }
    }
}

/// One of some words.
pub trait Word {
    /// Index of the present word.
    fn index(&self) -> usize;
    /// Sets the word by its index.
    fn choose(&mut self, index: usize);
}

/// Values by name.
pub trait Group {
    /// Adds a value with this name. None if the name exists already.
    fn add(&mut self, name: &str) -> Option<Slot<'_>>;
    /// Name and value with this index.
    fn entry(&mut self, index: usize) -> Option<(&str, Slot<'_>)>;
}

/// Values in order.
pub trait List {
    /// Adds a value.
    fn add(&mut self) -> Slot<'_>;
    /// The value with this index.
    fn element(&mut self, index: usize) -> Option<Slot<'_>>;
}

/// A value that may be absent.
pub trait Maybe {
    /// Creates the value.
    fn make(&mut self) -> Slot<'_>;
    /// The value, if it exists.
    fn get(&mut self) -> Option<Slot<'_>>;
}

/// A value with separate functions for reading and writing.
pub trait Own {
    /// Sets the value.
    ///
    /// # Errors
    /// The fault, as text.
    fn take(&mut self, node: &Node, text: &str) -> Result<(), String>;
    /// The value as JSON. Empty if there is no value.
    fn written(&self) -> String;
}

/// A type of values of keys.
pub trait Field: Default {
    /// Kind of the value.
    const KIND: Kind;
    /// Access to the value.
    fn slot(&mut self) -> Slot<'_>;
}

macro_rules! fields {
    ($($type:ty => $variant:ident)*) => {$(
        impl Field for $type {
            const KIND: Kind = Kind::$variant;

            fn slot(&mut self) -> Slot<'_> {
                Slot::$variant(self)
            }
        }
    )*};
}

fields! { f64 => Number u64 => Whole bool => Flag String => Text [f64; 2] => Pair }

impl<T: Field> Field for Option<T> {
    const KIND: Kind = T::KIND;

    fn slot(&mut self) -> Slot<'_> {
        Slot::Maybe(self)
    }
}

impl<T: Field> Maybe for Option<T> {
    fn make(&mut self) -> Slot<'_> {
        self.insert(T::default()).slot()
    }

    fn get(&mut self) -> Option<Slot<'_>> {
        self.as_mut().map(T::slot)
    }
}

impl<T: Field> Field for Named<T> {
    const KIND: Kind = Kind::Group(&T::KIND);

    fn slot(&mut self) -> Slot<'_> {
        Slot::Group(self)
    }
}

impl<T: Field> Group for Named<T> {
    fn add(&mut self, name: &str) -> Option<Slot<'_>> {
        self.push(name, T::default()).map(T::slot)
    }

    fn entry(&mut self, index: usize) -> Option<(&str, Slot<'_>)> {
        self.at_mut(index).map(|(name, value)| (name, value.slot()))
    }
}

impl<T: Field> Field for Vec<T> {
    const KIND: Kind = Kind::List(&T::KIND);

    fn slot(&mut self) -> Slot<'_> {
        Slot::List(self)
    }
}

impl<T: Field> List for Vec<T> {
    fn add(&mut self) -> Slot<'_> {
        let index = self.len();
        self.push(T::default());
        self[index].slot()
    }

    fn element(&mut self, index: usize) -> Option<Slot<'_>> {
        self.get_mut(index).map(T::slot)
    }
}

impl Unit {
    /// Names of all units, in the order of [`Self::ALL`].
    const NAMES: [&'static str; Self::ALL.len()] = {
        let mut names = [""; Self::ALL.len()];
        let mut index = 0;
        while index < names.len() {
            names[index] = Self::ALL[index].name();
            index += 1;
        }
        names
    };
}

impl Word for Unit {
    fn index(&self) -> usize {
        *self as usize
    }

    fn choose(&mut self, index: usize) {
        *self = Self::ALL[index];
    }
}

impl Field for Unit {
    const KIND: Kind = Kind::Word(&Self::NAMES);

    fn slot(&mut self) -> Slot<'_> {
        Slot::Word(self)
    }
}
