//! Elements of MJCF, URDF and SDF: their attributes, their places, and the attributes that an importer has read.
//!
//! In: XML. Out: elements, and notes about unread parts. The module must not know mechanisms.

use anyhow::{Context, Result, anyhow, bail};
use roxmltree::{Document, Error, Node};
use serde::Deserialize;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Attributes that are never negative: masses, moments of inertia about an axis, densities and sizes.
const SIZES: [&str; 7] = ["mass", "diaginertia", "density", "size", "ixx", "iyy", "izz"];
/// Largest depth of nested elements.
const DEEPEST: usize = 250;

/// An element with its own attributes, and those of its default class.
#[derive(Clone, Debug, Default)]
pub struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    /// Text between the tags, without surrounding spaces.
    pub text: String,
    pub children: Vec<Element>,
    /// Line number, with the name of an included file.
    pub place: String,
    /// Names of the attributes and children that were read, including missing ones.
    asked: RefCell<BTreeSet<&'static str>>,
}

/// Treatment of an attribute, or of an element with its contents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Fate {
    /// The importer reads it.
    Read,
    /// It does not change a planar motion of rigid bodies.
    NoEffect,
    /// It is omitted with a note.
    LeftOut,
    /// The import ends with an error, unless the attribute has the value given here.
    Rejected(&'static str),
}

/// A row of the table of a format: elements `parent/tag` (or `parent/*`), attributes (empty: the elements themselves),
/// their treatment, and a description.
pub type Row = (&'static str, &'static str, Fate, &'static str);

/// The table of a format from its file. The page of the reference is written from the tables.
pub fn table(file: &'static str) -> Vec<Row> {
    serde_json::from_str(file).expect("a table of the program is JSON")
}

impl Element {
    /// Parse a text. `file` is empty or the name of an included file.
    ///
    /// # Errors
    /// The text is no XML, or is nested too deeply.
    pub fn parse(text: &str, file: &str) -> Result<Self> {
        let of = if file.is_empty() { "the file".to_owned() } else { file.to_owned() };
        let mut text = std::borrow::Cow::Borrowed(text);
        let document = loop {
            match Document::parse(&text) {
                // Programs write namespace prefixes without a declaration.
                Err(Error::UnknownNamespace(prefix, _)) if !text.contains(&format!("xmlns:{prefix}=")) => {
                    text = declared(&text, &prefix).into();
                }
                _ => break Document::parse(&text).map_err(|error| anyhow!("{of} is not XML: {error}"))?,
            }
        };
        let prefix = if file.is_empty() { String::new() } else { format!("{file} ") };
        let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        Self::of(document.root_element(), &prefix, &ends, 0)
    }

    /// `ends` are the ends of the lines.
    fn of(node: Node, prefix: &str, ends: &[usize], depth: usize) -> Result<Self> {
        let tag = match node.tag_name().namespace() {
            Some(space) if space.contains("xacro") => format!("xacro:{}", node.tag_name().name()),
            _ => node.tag_name().name().to_owned(),
        };
        let line = ends.partition_point(|end| *end < node.range().start) + 1;
        let place = format!("{prefix}line {line}");
        if depth > DEEPEST {
            bail!("{place}: <{tag}> is nested too deeply: at most {DEEPEST} are supported");
        }
        let children = node.children().filter(Node::is_element);
        Ok(Self {
            tag,
            attributes: node.attributes().map(|one| (one.name().to_owned(), one.value().to_owned())).collect(),
            text: node.text().unwrap_or_default().trim().to_owned(),
            children: children.map(|child| Self::of(child, prefix, ends, depth + 1)).collect::<Result<_>>()?,
            place,
            asked: RefCell::default(),
        })
    }

    /// The value of an attribute, which is then marked as read.
    pub fn get(&self, name: &'static str) -> Option<&str> {
        self.asked.borrow_mut().insert(name);
        self.attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str())
    }

    /// Whether an attribute has this value.
    pub fn is(&self, name: &'static str, value: &str) -> bool {
        self.get(name) == Some(value)
    }

    /// Place of the element in messages.
    pub fn at(&self) -> String {
        let named = self.attributes.iter().find(|(own, _)| own == "name");
        let name = named.map(|(_, name)| format!(" \"{}\"", name.escape_debug())).unwrap_or_default();
        format!("{}: <{}{name}>", self.place, self.tag)
    }

    pub fn all<'a>(&'a self, tag: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.tag == tag)
    }

    pub fn child(&self, tag: &'static str) -> Option<&Element> {
        self.asked.borrow_mut().insert(tag);
        self.children.iter().find(|child| child.tag == tag)
    }

    /// Numbers of an attribute.
    pub fn numbers(&self, name: &'static str) -> Result<Option<Vec<f64>>> {
        let Some(text) = self.get(name) else { return Ok(None) };
        self.parsed(name, text).map(Some)
    }

    fn parsed(&self, name: &str, text: &str) -> Result<Vec<f64>> {
        let parse = |word: &str| word.parse::<f64>().ok().filter(|value| value.is_finite());
        let all: Option<Vec<f64>> = text.split_whitespace().map(parse).collect();
        let stated = || format!("{}: {name} = \"{}\"", self.at(), text.escape_debug());
        let all = all.with_context(|| format!("{} contains text that is not a number", stated()))?;
        let is_size = SIZES.contains(&name) || self.tag == "mass";
        if is_size && all.iter().any(|value| *value < 0.0) {
            bail!("{}: the value must not be negative", stated());
        }
        Ok(all)
    }

    pub fn fixed<const N: usize>(&self, name: &'static str) -> Result<Option<[f64; N]>> {
        self.numbers(name)?.map(|all| self.exactly(name, all)).transpose()
    }

    fn exactly<const N: usize>(&self, name: &str, all: Vec<f64>) -> Result<[f64; N]> {
        let count = all.len();
        <[f64; N]>::try_from(all).map_err(|_| anyhow!("{}: {name} has {count} numbers, but needs {N}", self.at()))
    }

    pub fn one(&self, name: &'static str) -> Result<Option<f64>> {
        Ok(self.fixed::<1>(name)?.map(|[value]| value))
    }

    /// Numbers between the tags of a child.
    pub fn inner<const N: usize>(&self, tag: &'static str) -> Result<Option<[f64; N]>> {
        let Some(child) = self.child(tag).filter(|child| !child.text.is_empty()) else { return Ok(None) };
        child.exactly(tag, child.parsed(tag, &child.text)?).map(Some)
    }

    /// The ends of a range, the lower one first.
    pub fn ascending(&self, name: &str, [lower, upper]: [f64; 2]) -> Result<[f64; 2]> {
        if lower > upper {
            bail!(
                "{}: {name}: the lower limit {lower:?} is larger than the upper limit {upper:?}; exchange the two \
                    limits",
                self.at()
            );
        }
        Ok([lower, upper])
    }

    /// The attributes and children that were read in the elements below this one, as `parent/tag name`.
    #[cfg(test)]
    pub fn read(&self, group: &dyn Fn(&str) -> String, into: &mut BTreeSet<String>) {
        for child in &self.children {
            let key = format!("{}/{}", group(&self.tag), child.tag);
            into.extend(child.asked.borrow().iter().map(|name| format!("{key} {name}")));
            child.read(group, into);
        }
    }
}

/// The text with a declaration of the prefix in its root.
fn declared(text: &str, prefix: &str) -> String {
    let is_root = |at: &usize| text[at + 1..].starts_with(|letter: char| letter.is_alphabetic());
    let root = text.match_indices('<').map(|(at, _)| at).find(is_root).unwrap_or_default();
    let end = text[root..].find([' ', '>', '/', '\n', '\r', '\t']).map_or(root, |at| root + at);
    format!("{} xmlns:{prefix}=\"{prefix}\"{}", &text[..end], &text[end..])
}

/// Reject elements that the table rejects, before missing parts in them are reported.
///
/// # Errors
/// The document has such an element.
pub fn rejected(root: &Element, table: &[Row], group: &dyn Fn(&str) -> String) -> Result<()> {
    let parent = group(&root.tag);
    root.children.iter().try_for_each(|child| match row(table, &format!("{parent}/{}", child.tag), "") {
        Some((.., Fate::Rejected(_), why)) => bail!("{}: {why}", child.at()),
        Some((.., Fate::Read, _)) => rejected(child, table, group),
        _ => Ok(()),
    })
}

/// Notes about the unread parts of a document, each with all its places.
///
/// # Errors
/// The table rejects an element or an attribute.
pub fn unread(root: &Element, table: &[Row], group: &dyn Fn(&str) -> String) -> Result<Vec<String>> {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for child in &root.children {
        walk(child, &group(&root.tag), table, group, &mut found)?;
    }
    let listed = |places: &[String]| match places.len() {
        0..=4 => places.join(", "),
        count => format!("{} and {} more", places[..3].join(", "), count - 3),
    };
    Ok(found.into_iter().map(|(what, places)| format!("{what} ({})", listed(&places))).collect())
}

/// The row of an attribute, or of an element if the attribute is empty.
pub fn row<'a>(table: &'a [Row], key: &str, attribute: &str) -> Option<&'a Row> {
    let any = format!("{}/*", key.split('/').next().unwrap_or_default());
    let holds = |row: &&Row, key: &str| {
        let is_named = row.1.split_whitespace().any(|name| name == attribute);
        row.0.split_whitespace().any(|own| own == key) && (is_named || row.1.is_empty() && attribute.is_empty())
    };
    table.iter().find(|row| holds(row, key)).or_else(|| table.iter().find(|row| holds(row, &any)))
}

fn walk(
    element: &Element,
    parent: &str,
    table: &[Row],
    group: &dyn Fn(&str) -> String,
    found: &mut BTreeMap<String, Vec<String>>,
) -> Result<()> {
    let key = format!("{parent}/{}", element.tag);
    let mut note = |what: String| {
        let places = found.entry(what).or_default();
        if !places.contains(&element.place) {
            places.push(element.place.clone());
        }
    };
    match row(table, &key, "") {
        Some((.., Fate::NoEffect, _)) => return Ok(()),
        // An attribute that is off or 0 has no effect.
        Some((.., Fate::LeftOut, _)) if matches!(element.text.as_str(), "0" | "0.0" | "false") => return Ok(()),
        Some((.., Fate::LeftOut, why)) => {
            note(format!("<{}> is left out: {why}", element.tag));
            return Ok(());
        }
        Some((.., Fate::Read | Fate::Rejected(_), _)) => {}
        None => {
            note(format!("<{}> is unknown to the import and is left out", element.tag));
            return Ok(());
        }
    }
    for (name, value) in &element.attributes {
        if element.asked.borrow().contains(name.as_str()) {
            continue;
        }
        let same = |other: &str| match (value.trim().parse::<f64>(), other.parse::<f64>()) {
            (Ok(own), Ok(other)) => own == other,
            _ => value.trim() == other,
        };
        match row(table, &key, name) {
            Some((.., Fate::NoEffect, _)) => {}
            Some((.., Fate::Rejected(harmless), _)) if same(harmless) => {}
            Some((.., Fate::Rejected(_), why)) => {
                bail!("{}: {name} = \"{}\": {why}", element.at(), value.escape_debug())
            }
            Some((.., Fate::LeftOut, why)) => note(format!("<{}> {name} is left out: {why}", element.tag)),
            Some((.., Fate::Read, _)) => note(format!("<{}> {name} has no effect here and is left out", element.tag)),
            None => note(format!("<{}> {name} is unknown to the import and is left out", element.tag)),
        }
    }
    element.children.iter().try_for_each(|child| walk(child, &group(&element.tag), table, group, found))
}
