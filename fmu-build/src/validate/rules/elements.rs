//! The elements of an XML file as a list, without deeply nested elements.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::collections::BTreeMap;

/// Largest number of parent elements without the root.
const DEEPEST: usize = 3;

/// An element.
pub struct Element {
    pub name: String,
    /// Names of the parent elements, without the root.
    pub path: Vec<String>,
    /// Attribute `name` of the parent element.
    pub of: String,
    pub attributes: BTreeMap<String, String>,
}

impl Element {
    /// Value of an attribute. Empty if it is missing.
    pub fn get(&self, name: &str) -> &str {
        self.attributes.get(name).map_or("", String::as_str)
    }

    /// Value of a numeric attribute.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.attributes.get(name)?.trim().parse().ok()
    }
}

/// The elements in their order. The first one is the root. None if the text is no XML.
pub fn elements(xml: &str) -> Option<Vec<Element>> {
    let mut reader = Reader::from_str(xml.trim_start_matches('\u{feff}'));
    let mut all = Vec::new();
    // Name and attribute `name` of the open elements.
    let mut open: Vec<(String, String)> = Vec::new();
    loop {
        match reader.read_event().ok()? {
            Event::Start(start) => {
                let element = read(&open, &start)?;
                open.push((element.name.clone(), element.get("name").to_owned()));
                all.extend((open.len() <= DEEPEST + 2).then_some(element));
            }
            Event::Empty(start) => {
                let element = read(&open, &start)?;
                all.extend((open.len() <= DEEPEST + 1).then_some(element));
            }
            Event::End(_) => drop(open.pop()),
            Event::Eof => return Some(all),
            _ => {}
        }
    }
}

fn read(open: &[(String, String)], start: &BytesStart) -> Option<Element> {
    let mut attributes = BTreeMap::new();
    if open.len() <= DEEPEST + 1 {
        for attribute in start.attributes().with_checks(false) {
            let attribute = attribute.ok()?;
            let value = attribute.normalized_value(XmlVersion::Implicit1_0).ok()?.into_owned();
            attributes.insert(attribute.key.as_ref().to_owned(), value);
        }
    }
    let path = open.iter().skip(1).take(DEEPEST + 1).map(|(name, _)| name.clone()).collect();
    let of = open.last().map(|(_, name)| name.clone()).unwrap_or_default();
    Some(Element { name: start.name().as_ref().to_owned(), path, of, attributes })
}
