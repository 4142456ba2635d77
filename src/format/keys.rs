//! Tables of keys: each key of a definition is declared once, and reading, writing, parameters, the schema and the
//! pages of reference follow from its row.
//!
//! In: the declarations of [`keys!`](super::keys!) and [`words!`](super::words!). Out: for each struct its table, and
//! its values by the rows of that table. It must not know what a key means to a model.
use super::json::Node;
use super::named::Named;
use super::parameter::{Range, Role};
use crate::variables::Unit;

/// What may stand under a key.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A number, or an expression where the definition takes them.
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
    /// What the model reads and says itself, in words.
    Own(&'static str),
}

/// What a text names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Names {
    /// Nothing.
    Nothing,
    /// Nothing, on one line.
    Line,
    /// An element of the definition.
    Element,
    /// A point, as `body.point`.
    Point,
}

/// The row of a key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Name in the file.
    pub name: &'static str,
    /// What may stand there.
    pub kind: Kind,
    /// Whether it must be given.
    pub is_required: bool,
    /// Whether it is left out of the written form where it has its default.
    pub is_brief: bool,
    /// Whether it stands in the written form alone: no file may have it.
    pub is_written_only: bool,
    /// Of a text: what it names.
    pub names: Names,
    /// Of a number: its unit along a line, and about a joint.
    pub units: [Unit; 2],
    /// Of pairs whose second number is another quantity than the first: its units.
    pub second: Option<[Unit; 2]>,
    /// Of a number: the values that it may have.
    pub range: Range,
    /// Of a parameter: what it changes.
    pub role: Option<Role>,
    /// Of a parameter: the text of its variable, without the owner's name.
    pub words: &'static str,
    /// The value where the key is absent, as JSON; empty where the struct's default says it, or where there is none.
    pub absent: &'static str,
}

impl Key {
    /// A key without anything to say but its name and kind, which the declaration gives.
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

    /// A key that must be given.
    pub const fn required(self) -> Self {
        Self { is_required: true, ..self }
    }

    /// A key that is left out of the written form where it has its default.
    pub const fn brief(self) -> Self {
        Self { is_brief: true, ..self }
    }

    /// A key with this value where it is absent, as JSON.
    pub const fn absent(self, json: &'static str) -> Self {
        Self { absent: json, ..self }
    }

    /// A parameter: what it changes, and the text of its variable.
    pub const fn parameter(self, role: Role, words: &'static str) -> Self {
        Self { role: Some(role), words, ..self }
    }

    /// Unit of the number, of a drive or load that turns or slides.
    pub const fn unit(&self, is_rotary: bool) -> Unit {
        self.units[is_rotary as usize]
    }
}

/// The row of a number with one unit and its range.
pub const fn number(unit: Unit, range: Range) -> Key {
    Key { units: [unit; 2], range, ..Key::PLAIN }
}

/// The row of a number whose unit along a line differs from that about a joint.
pub const fn either(units: [Unit; 2], range: Range) -> Key {
    Key { units, range, ..Key::PLAIN }
}

/// The row of the points of a curve: units of their first and of their second numbers, along a line and about a joint.
pub const fn curve(first: [Unit; 2], second: [Unit; 2], range: Range) -> Key {
    Key { units: first, second: Some(second), range, ..Key::PLAIN }
}

/// The row of a line of text.
pub const fn line() -> Key {
    Key { names: Names::Line, ..Key::PLAIN }
}

/// The row of a text that names an element.
pub const fn element() -> Key {
    Key { names: Names::Element, ..Key::PLAIN }
}

/// The row of a text that names a point.
pub const fn point() -> Key {
    Key { names: Names::Point, ..Key::PLAIN }
}

/// What may stand in the place of an object.
#[derive(Clone, Copy, Debug)]
pub enum Short {
    /// Nothing.
    None,
    /// The value of the first key.
    First,
    /// This word, which stands for true under the last key.
    Word(&'static str),
}

/// The keys of an object.
#[derive(Debug)]
pub struct Table {
    /// The rows, in the order of the written form.
    pub keys: &'static [Key],
    /// What may stand in the place of the object.
    pub short: Short,
}

impl Table {
    /// Index of the key of this name that a file may have.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.keys.iter().position(|key| key.name == name && !key.is_written_only)
    }

    /// Names of all keys that a file may have.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        self.keys.iter().filter(|key| !key.is_written_only).map(|key| key.name)
    }
}

impl PartialEq for Table {
    /// A table is itself only.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// The place of a value in a definition.
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
    /// What the model reads and says itself.
    Own(&'a mut dyn Own),
}

impl Slot<'_> {
    /// Whether a value is there that is not the empty one.
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

    /// The value under the key of this index.
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

/// Table and words of a struct, for schema and reference.
pub trait Described {
    /// The table.
    const TABLE: &'static Table;
    /// Words about the whole.
    const ABOUT: &'static str;
    /// Words about each key, in the order of the table.
    const DOCS: &'static [&'static str];
}

/// A struct of a definition for schema and reference.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// Its name there; empty for the whole definition.
    pub name: &'static str,
    /// Its keys.
    pub table: &'static Table,
    /// Words about it.
    pub about: &'static str,
    /// Words about each key.
    pub docs: &'static [&'static str],
    /// The element with all its defaults.
    pub make: fn() -> Box<dyn Keyed>,
}

impl Element {
    /// The element that is this type.
    pub const fn of<T: Described + Keyed + Default + 'static>(name: &'static str) -> Self {
        Self { name, table: T::TABLE, about: T::ABOUT, docs: T::DOCS, make: || Box::new(T::default()) }
    }

    /// The default of a key as JSON: that of its row or of the struct; None of a key that must be given, and of one
    /// without a value where it is absent.
    pub fn default_of(&self, index: usize) -> Option<String> {
        let (key, mut element) = (&self.table.keys[index], (self.make)());
        let is_value = !matches!(element.slot(index), Slot::Maybe(_) | Slot::Object(_) | Slot::Own(_));
        if !key.absent.is_empty() {
            Some(key.absent.to_owned())
        } else {
            (is_value && !key.is_required).then(|| super::read::written_value(element.slot(index), &key.kind))
        }
    }
}

/// One of some words.
pub trait Word {
    /// Its index among the words.
    fn index(&self) -> usize;
    /// Take the word with this index.
    fn choose(&mut self, index: usize);
}

/// Values by name.
pub trait Group {
    /// Place of the value of one more name; None if the name is there already.
    fn add(&mut self, name: &str) -> Option<Slot<'_>>;
    /// Name and value of this index.
    fn entry(&mut self, index: usize) -> Option<(&str, Slot<'_>)>;
}

/// Values in order.
pub trait List {
    /// Place of one more value.
    fn add(&mut self) -> Slot<'_>;
    /// The value of this index.
    fn element(&mut self, index: usize) -> Option<Slot<'_>>;
}

/// A value that may be absent.
pub trait Maybe {
    /// Place of the value, which is there from now on.
    fn make(&mut self) -> Slot<'_>;
    /// Place of the value, if it is there.
    fn get(&mut self) -> Option<Slot<'_>>;
}

/// A value that is read and written in its own way.
pub trait Own {
    /// Take a value.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    fn take(&mut self, node: &Node, text: &str) -> Result<(), String>;
    /// The value as JSON; empty where there is none.
    fn written(&self) -> String;
}

/// A type that may stand under a key.
pub trait Field: Default {
    /// What may stand there.
    const KIND: Kind;
    /// The place of the value.
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
