//! Reading of definitions by their tables of keys.
//!
//! In: a text, a value with its table. Out: the value as stated in the text, and all faults in the order of the text.
//! Must not know: what a key means.
use super::fault::{DefinitionError, Fault, Faults, Place};
use super::json::{Json, Member, Node, parse};
use super::keys::{Keyed, Kind, Short, Slot};
use super::numbers::Numbers;
use std::fmt::Write;
use std::ops::Range;

/// Largest size of a definition [bytes]. A mechanism of 100 bodies has about 30 000 bytes.
pub const LARGEST_DEFINITION: u64 = 16 << 20;
/// Number of characters of a value in a message.
const SHOWN: usize = 40;
/// Largest number of faults of one text.
const MOST: usize = 100;

/// Reads a definition. `kind`: word for messages about the text as a whole. Faulty values do not change `into`.
pub fn read_with(kind: &str, text: &str, numbers: &Numbers, into: &mut dyn Keyed) -> Faults {
    let mut faults = Faults::default();
    if text.len() as u64 > LARGEST_DEFINITION {
        let size = text.len();
        let message = format!("the file has {size} bytes, but at most {LARGEST_DEFINITION} bytes are allowed");
        faults.refuse(format!("not a valid {kind}"), message);
        return faults;
    }
    match parse(kind, text) {
        Ok(node) => {
            let mut reader = Reader { kind, text, numbers, path: String::new(), faults: &mut faults };
            reader.object(&node, into);
        }
        Err(fault) => faults.push(fault),
    }
    faults
}

/// Reads a definition without expressions.
///
/// # Errors
/// The first fault.
pub fn read<T: Keyed + Default>(kind: &str, text: &str) -> Result<T, DefinitionError> {
    let mut read = T::default();
    read_with(kind, text, &Numbers::default(), &mut read).first()?;
    Ok(read)
}

struct Reader<'r> {
    kind: &'r str,
    text: &'r str,
    /// Treatment of texts that replace numbers.
    numbers: &'r Numbers,
    /// Path of the present value, such as `bodies.crank.points.tip[1]`. Empty at the top level.
    path: String,
    faults: &'r mut Faults,
}

impl Reader<'_> {
    fn fault(&mut self, fault: Fault, span: &Range<usize>) {
        if self.faults.len() == MOST {
            return;
        }
        let path = if self.path.is_empty() { format!("not a valid {}", self.kind) } else { self.path.clone() };
        self.faults.push(DefinitionError::new(path, fault).at(Place::new(self.text, span.clone())));
    }

    /// Calls `read` with an additional part of the path.
    fn inside(&mut self, part: std::fmt::Arguments, read: impl FnOnce(&mut Self)) {
        let length = self.path.len();
        // Writing to a string never fails.
        let _ = self.path.write_fmt(part);
        if length == 0 && self.path.starts_with('.') {
            self.path.remove(0);
        }
        read(self);
        self.path.truncate(length);
    }

    /// Adds the fault of a value with the wrong type.
    #[cold]
    fn type_fault(&mut self, node: &Node, kind: &Kind) {
        let found = match &node.json {
            Json::Null => "null".to_owned(),
            Json::Flag(flag) => flag.to_string(),
            Json::Number(_) => shortened(&self.text[node.span.clone()]),
            Json::Text(text) => format!("\"{}\"", shortened(text)),
            Json::List(nodes) if matches!(kind, Kind::Pair) => format!("a list of {}", nodes.len()),
            Json::List(_) => "a list [ ]".to_owned(),
            Json::Object(_) => "an object { }".to_owned(),
        };
        let remedy = match (&node.json, kind) {
            (Json::Null, _) => "; leave the key out if it has no value",
            (_, Kind::Object(_)) if self.path.is_empty() => "; write a definition as one object { \"name\": ... }",
            (Json::List(_), Kind::Object(_) | Kind::Group(_)) => "; write { \"name\": value } instead of [ value ]",
            (Json::List(nodes), Kind::Pair) if nodes.len() > 2 => "; write decimals with a point, such as 0.5",
            (Json::Text(text), Kind::Number | Kind::Whole) if text.parse::<f64>().is_ok() => "; remove the quotes",
            _ => "",
        };
        let expected = expected(kind, self.numbers.allows_texts());
        self.fault(Fault::Type { expected, found, remedy }, &node.span);
    }

    /// Reads the keys of an object, or its short form.
    fn object(&mut self, node: &Node, into: &mut dyn Keyed) {
        let table = into.table();
        let members = match (&node.json, table.short) {
            (Json::Object(members), _) => members,
            (Json::Text(_) | Json::Number(_), Short::First) => {
                return self.value(node, &table.keys[0].kind, into.slot(0));
            }
            (Json::Text(text), Short::Word(word)) if text == word => {
                if let Slot::Flag(flag) = into.slot(table.keys.len() - 1) {
                    *flag = true;
                }
                return;
            }
            _ => return self.type_fault(node, &Kind::Object(table)),
        };
        let mut is_given = vec![false; table.keys.len()];
        for Member { key, span, value } in members {
            self.inside(format_args!(".{key}"), |reader| match table.position(key) {
                Some(index) if is_given[index] => reader.fault(Fault::Twice(key.clone()), span),
                Some(index) => {
                    is_given[index] = true;
                    reader.value(value, &table.keys[index].kind, into.slot(index));
                }
                None => reader.fault(Fault::UnknownKey(key.clone(), table.names().collect()), span),
            });
        }
        for (key, _) in table.keys.iter().zip(is_given).filter(|(key, is_given)| key.is_required && !is_given) {
            self.fault(Fault::Missing(key.name), &node.span);
        }
    }

    fn value(&mut self, node: &Node, kind: &Kind, into: Slot) {
        match (into, &node.json, kind) {
            (Slot::Object(object), ..) => self.object(node, object),
            (Slot::Maybe(maybe), ..) => self.value(node, kind, maybe.make()),
            (Slot::Own(own), ..) => {
                if let Err(message) = own.take(node, self.text) {
                    self.fault(Fault::Other(message), &node.span);
                }
            }
            (Slot::Number(number), ..) => *number = self.number(node).unwrap_or(*number),
            (Slot::Whole(whole), Json::Number(number), _) if number.fract() == 0.0 && (0.0..1e19).contains(number) => {
                *whole = *number as u64;
            }
            (Slot::Flag(flag), Json::Flag(value), _) => *flag = *value,
            (Slot::Text(text), Json::Text(value), _) => text.clone_from(value),
            (Slot::Word(word), Json::Text(text), Kind::Word(words)) => match words.iter().position(|one| one == text) {
                Some(index) => word.choose(index),
                None => self.fault(Fault::Word(text.clone(), words), &node.span),
            },
            (Slot::Pair(pair), Json::List(nodes), _) if nodes.len() == pair.len() => {
                for (index, (node, number)) in nodes.iter().zip(pair).enumerate() {
                    self.inside(format_args!("[{index}]"), |reader| *number = reader.number(node).unwrap_or(*number));
                }
            }
            (Slot::Group(group), Json::Object(members), Kind::Group(of)) => {
                for Member { key, span, value } in members {
                    self.inside(format_args!(".{key}"), |reader| match group.add(key) {
                        Some(slot) => reader.value(value, of, slot),
                        None => reader.fault(Fault::Twice(key.clone()), span),
                    });
                }
            }
            (Slot::List(list), Json::List(nodes), Kind::List(of)) => {
                for (index, node) in nodes.iter().enumerate() {
                    self.inside(format_args!("[{index}]"), |reader| reader.value(node, of, list.add()));
                }
            }
            _ => self.type_fault(node, kind),
        }
    }

    /// A number, or the placeholder of an expression.
    fn number(&mut self, node: &Node) -> Option<f64> {
        match &node.json {
            Json::Number(number) if number.is_finite() => return Some(*number),
            Json::Number(_) => {
                let (value, allowed) =
                    (shortened(&self.text[node.span.clone()]), "larger than the largest number, 1.8e308");
                self.fault(Fault::Value(value, allowed.to_owned()), &node.span);
            }
            Json::Text(text) if self.numbers.allows_texts() => match self.numbers.take(text) {
                Ok(number) => return Some(number),
                Err(message) => self.fault(Fault::Other(message), &node.span),
            },
            _ => self.type_fault(node, &Kind::Number),
        }
        None
    }
}

/// A text, or its start with three dots.
fn shortened(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// The expected kind of value, as text.
fn expected(kind: &Kind, allows_texts: bool) -> String {
    match kind {
        Kind::Number if allows_texts => "a number, or an expression in quotes".to_owned(),
        Kind::Number => "a number".to_owned(),
        Kind::Whole => "a whole number".to_owned(),
        Kind::Flag => "true or false".to_owned(),
        Kind::Text => "a text in quotes".to_owned(),
        Kind::Pair => "a list of 2 numbers".to_owned(),
        Kind::Word(words) => format!("a word in quotes: {}", words.join(", ")),
        Kind::List(_) => "a list [ ]".to_owned(),
        Kind::Group(_) => "an object { } of named entries".to_owned(),
        Kind::Object(table) => match table.short {
            Short::None => "an object { }".to_owned(),
            Short::First => format!("{}, or an object {{ }}", expected(&table.keys[0].kind, allows_texts)),
            Short::Word(word) => format!("an object {{ }}, or the word \"{word}\""),
        },
        Kind::Own(words) => (*words).to_owned(),
    }
}
