//! Places of the keys of a definition in its text.
//!
//! In: the text of a definition as a tree of JSON. Out: the ranges of bytes of keys and values by their paths. The
//! module must not know what the keys mean.

use linkage_fmu::format::{Json, Member, Node};
use std::ops::Range;

/// A part of the text: a member of an object, an element of a list, or the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Range that a finding underlines: the value if it is on one line, else the key.
    pub shown: Range<usize>,
    /// Path of the part. It may be shorter than the requested path.
    pub path: String,
}

/// The place of a path such as `bodies.crank.points.tip[1]` in a text, or of its longest existing part. Of two members
/// with one name the last one counts.
pub fn find(text: &str, root: &Node, path: &str) -> Place {
    let start = root.span.start;
    let first = start..start + text[start..].chars().next().map_or(0, char::len_utf8);
    let mut place = Place { shown: first, path: String::new() };
    let (mut node, mut rest) = (root, path);
    while !rest.is_empty() {
        let step = rest.trim_start_matches('.');
        match &node.json {
            Json::Object(members) => {
                // A key may contain a dot: the longest matching key counts.
                let fits = |member: &&Member| {
                    let after = step.strip_prefix(member.key.as_str());
                    after.is_some_and(|after| after.is_empty() || after.starts_with(['.', '[']))
                };
                let Some(found) = members.iter().filter(fits).max_by_key(|member| member.key.len()) else { break };
                let joint = if place.path.is_empty() { "" } else { "." };
                let is_on_one_line = text[found.value.span.clone()].lines().count() <= 1;
                let shown = if is_on_one_line { &found.value.span } else { &found.span };
                place = Place { shown: shown.clone(), path: format!("{}{joint}{}", place.path, found.key) };
                (node, rest) = (&found.value, &step[found.key.len()..]);
            }
            Json::List(elements) => {
                let Some((index, after)) = step.strip_prefix('[').and_then(|step| step.split_once(']')) else { break };
                let Some(element) = index.parse().ok().and_then(|index: usize| elements.get(index)) else { break };
                place = Place { shown: element.span.clone(), path: format!("{}[{index}]", place.path) };
                (node, rest) = (element, after);
            }
            _ => break,
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use linkage_fmu::format::parse;

    const TEXT: &str = "{\n  \"a\": { \"b\": [1, 22], \"x.y\": 3 },\n  \"a\": { \"b\": [1, 33] }\n}";

    fn shown(path: &str) -> (&'static str, String) {
        let place = find(TEXT, &parse("test", TEXT).unwrap(), path);
        (&TEXT[place.shown], place.path)
    }

    #[test]
    fn a_path_leads_to_its_value_or_as_far_as_there_is_one() {
        assert_eq!(shown("a.b[1]"), ("33", "a.b[1]".into()));
        assert_eq!(shown("a.b[7]"), ("[1, 33]", "a.b".into()));
        assert_eq!(shown("a.c.d"), ("{ \"b\": [1, 33] }", "a".into()));
        assert_eq!(shown("none"), ("{", String::new()));
        let dotted = "{\"a\": {\"x.y\": 3}}";
        assert_eq!(find(dotted, &parse("test", dotted).unwrap(), "a.x.y").path, "a.x.y");
    }
}
