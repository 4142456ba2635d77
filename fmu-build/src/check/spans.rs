//! Where the keys of a definition stand in its text.
//!
//! In: JSON text, read leniently. Out: the ranges of bytes of keys and values by their paths. It must not know what the
//! keys mean.

use jsonc_parser::ast::{ObjectProp, Value};
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};
use std::ops::Range;

/// A part of the text: a member of an object, an element of a list, or the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Key and value of a member; the value else.
    pub whole: Range<usize>,
    /// The key of a member; the value else.
    pub key: Range<usize>,
    /// What a finding underlines: the value if it is on few lines, else the key.
    pub shown: Range<usize>,
    /// Path of the part, which may end before the one that was asked for.
    pub path: String,
}

/// The text as a tree.
pub struct Tree<'a> {
    text: &'a str,
    value: Option<Value<'a>>,
}

impl<'a> Tree<'a> {
    /// Read a text; a text that is no JSON has no places.
    pub fn new(text: &'a str) -> Self {
        let parsed = parse_to_ast(text, &CollectOptions::default(), &ParseOptions::default());
        Self { text, value: parsed.ok().and_then(|parsed| parsed.value) }
    }

    /// The place of a path such as `bodies.crank.points.tip[1]`, or of its longest part that is there; None for a text
    /// that is no JSON. The last of two members of one name is meant.
    pub fn find(&self, path: &str) -> Option<Place> {
        let mut value = self.value.as_ref()?;
        let range = value.range();
        let first = first_character(self.text, range.start);
        let whole = range.start..range.end;
        let mut place = Place { whole, key: first.clone(), shown: first, path: String::new() };
        let mut rest = path;
        while !rest.is_empty() {
            let step = rest.trim_start_matches('.');
            match value {
                Value::Object(object) => {
                    // A key may hold a dot: the longest that fits is meant.
                    let fits = |p: &&ObjectProp| {
                        let name = p.name.as_str();
                        step.strip_prefix(name).is_some_and(|after| after.is_empty() || after.starts_with(['.', '[']))
                    };
                    let Some(found) = object.properties.iter().filter(fits).max_by_key(|p| p.name.as_str().len())
                    else {
                        break;
                    };
                    let name = found.name.as_str();
                    let joint = if place.path.is_empty() { "" } else { "." };
                    place = self.member(found, format!("{}{joint}{name}", place.path));
                    (value, rest) = (&found.value, &step[name.len()..]);
                }
                Value::Array(array) => {
                    let index = step.strip_prefix('[').and_then(|s| s.split_once(']'));
                    let Some((index, after)) = index else { break };
                    let Some(element) = index.parse().ok().and_then(|index: usize| array.elements.get(index)) else {
                        break;
                    };
                    let range = element.range();
                    let path = format!("{}[{index}]", place.path);
                    let whole = range.start..range.end;
                    place = Place { key: whole.clone(), shown: whole.clone(), whole, path };
                    (value, rest) = (element, after);
                }
                _ => break,
            }
        }
        Some(place)
    }

    fn member(&self, found: &ObjectProp, path: String) -> Place {
        let (key, value) = (found.name.range(), found.value.range());
        let on_few_lines = self.text[value.start..value.end].lines().count() <= 1;
        let shown = if on_few_lines { value } else { key };
        Place { whole: key.start..value.end, key: key.start..key.end, shown: shown.start..shown.end, path }
    }

    /// The range of bytes that takes a place out of the text together with a comma that goes with it.
    pub fn removal(&self, place: &Place) -> Range<usize> {
        let Range { start, end } = place.whole;
        let after = &self.text[end..];
        let comma = after.len() - after.trim_start().len();
        if after[comma..].starts_with(',') {
            return start..end + comma + 1;
        }
        let before = self.text[..start].trim_end();
        if before.ends_with(',') { before.len() - 1..end } else { start..end }
    }
}

/// The first character from here on, which opens an object mostly.
fn first_character(text: &str, start: usize) -> Range<usize> {
    let length = text[start..].chars().next().map_or(0, char::len_utf8);
    start..start + length
}

/// Line and column of a byte, both from 1; columns count characters.
pub fn line_and_column(text: &str, at: usize) -> [usize; 2] {
    let before = text.get(..at).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |end| end + 1);
    [before.matches('\n').count() + 1, before[line_start..].chars().count() + 1]
}

/// The byte at a line and a column of bytes, both from 1; the nearest there is.
pub fn byte_of(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let at = (start + column.saturating_sub(1)).min(text.len());
    (0..=at).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "{\n  \"a\": { \"b\": [1, 22], \"x.y\": 3 },\n  \"a\": { \"b\": [1, 33] }\n}";

    fn shown(path: &str) -> (&'static str, String) {
        let place = Tree::new(TEXT).find(path).unwrap();
        (&TEXT[place.shown], place.path)
    }

    #[test]
    fn a_path_leads_to_its_value_or_as_far_as_there_is_one() {
        assert_eq!(shown("a.b[1]"), ("33", "a.b[1]".into()));
        assert_eq!(shown("a.b[7]"), ("[1, 33]", "a.b".into()));
        assert_eq!(shown("a.c.d"), ("{ \"b\": [1, 33] }", "a".into()));
        assert_eq!(shown("none"), ("{", String::new()));
        assert!(Tree::new("{").find("a").is_none());
        let dotted = Tree::new("{\"a\": {\"x.y\": 3}}");
        assert_eq!(dotted.find("a.x.y").unwrap().path, "a.x.y");
    }

    #[test]
    fn a_member_is_taken_out_with_its_comma() {
        for (text, path, left) in [
            ("{\"a\": 1, \"b\": 2}", "a", "{ \"b\": 2}"),
            ("{\"a\": 1 , \"b\": 2}", "b", "{\"a\": 1 }"),
            ("{\"a\": 1}", "a", "{}"),
        ] {
            let tree = Tree::new(text);
            let range = tree.removal(&tree.find(path).unwrap());
            assert_eq!([&text[..range.start], &text[range.end..]].concat(), left);
        }
    }

    #[test]
    fn columns_count_characters() {
        assert_eq!(line_and_column("é\nöx", 6), [2, 3]);
        assert_eq!(line_and_column("", 0), [1, 1]);
    }
}
