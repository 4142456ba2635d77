//! A definition, or one of its values, as canonical JSON.
use super::keys::{Element, Keyed, Kind, Slot};
use std::fmt::Write;

impl Element {
    /// The default of a key as JSON, from its row or from the struct. None for a required key and for a key without a
    /// default.
    pub fn default_of(&self, index: usize) -> Option<String> {
        let (key, mut element) = (&self.table.keys[index], (self.make)());
        let is_value = !matches!(element.slot(index), Slot::Maybe(_) | Slot::Object(_) | Slot::Own(_));
        if !key.absent.is_empty() {
            Some(key.absent.to_owned())
        } else {
            (is_value && !key.is_required).then(|| written_value(element.slot(index), &key.kind))
        }
    }
}

/// A definition as canonical JSON: compact, with all keys in the order of their tables and names in the order of the
/// file. A missing value is null, unless the row of the key omits it.
pub fn written(definition: &mut dyn Keyed) -> String {
    let mut out = String::new();
    write_object(definition, &mut out);
    out
}

/// A value of a definition as canonical JSON.
fn written_value(slot: Slot, kind: &Kind) -> String {
    let mut out = String::new();
    write_value(slot, kind, &mut out);
    out
}

fn write_object(object: &mut dyn Keyed, out: &mut String) {
    let mut separator = '{';
    for (index, key) in object.table().keys.iter().enumerate() {
        if !key.is_brief || object.slot(index).is_given() {
            out.push(separator);
            separator = ',';
            let _ = write!(out, "\"{}\":", key.name);
            write_value(object.slot(index), &key.kind, out);
        }
    }
    out.push_str(if separator == '{' { "{}" } else { "}" });
}

fn write_value(slot: Slot, kind: &Kind, out: &mut String) {
    match (slot, kind) {
        (Slot::Number(number), _) => write_number(*number, out),
        (Slot::Whole(whole), _) => out.push_str(&whole.to_string()),
        (Slot::Flag(flag), _) => out.push_str(if *flag { "true" } else { "false" }),
        (Slot::Text(text), _) => out.push_str(&quoted(text)),
        (Slot::Pair([x, y]), _) => {
            out.push('[');
            write_number(*x, out);
            out.push(',');
            write_number(*y, out);
            out.push(']');
        }
        (Slot::Word(word), Kind::Word(words)) => out.push_str(&quoted(words[word.index()])),
        (Slot::Object(object), _) => write_object(object, out),
        (Slot::Maybe(maybe), _) => match maybe.get() {
            Some(slot) => write_value(slot, kind, out),
            None => out.push_str("null"),
        },
        (Slot::Group(group), Kind::Group(of)) => {
            out.push('{');
            let mut index = 0;
            while let Some((name, slot)) = group.entry(index) {
                out.push_str(if index == 0 { "" } else { "," });
                out.push_str(&quoted(name));
                out.push(':');
                write_value(slot, of, out);
                index += 1;
            }
            out.push('}');
        }
        (Slot::List(list), Kind::List(of)) => {
            out.push('[');
            let mut index = 0;
            while let Some(slot) = list.element(index) {
                out.push_str(if index == 0 { "" } else { "," });
                write_value(slot, of, out);
                index += 1;
            }
            out.push(']');
        }
        (Slot::Own(own), _) => out.push_str(&own.written()),
        _ => unreachable!("a slot has the kind of its row"),
    }
}

/// Writes a number with the fewest digits that give the same double, or null for a number that is not finite.
fn write_number(number: f64, out: &mut String) {
    out.push_str(&serde_json::to_string(&number).unwrap_or_default());
}

/// A text in quotes, with the escape sequences of JSON.
pub fn quoted(text: &str) -> String {
    serde_json::to_string(text).unwrap_or_default()
}
