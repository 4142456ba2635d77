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

/// Writes a number with the fewest digits that give the same double, or null for a number that is not finite. The text
/// is that of `serde_json`, whose own code for numbers would add 19 kB to the library. Only where two decimals are
/// equally near, as for 92943323875808.125, may the last digit differ.
fn write_number(number: f64, out: &mut String) {
    let size = number.abs();
    let _ = if !size.is_finite() {
        write!(out, "null")
    } else if size == 0.0 || (1e-4..1e16).contains(&size) {
        write!(out, "{number:?}")
    } else if (1e-5..1e-4).contains(&size) {
        write!(out, "{number}")
    } else {
        let text = format!("{number:e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, ""));
        write!(out, "{digits}e{:+}", exponent.parse().unwrap_or(0))
    };
}

/// A text in quotes, with the escape sequences of JSON.
pub fn quoted(text: &str) -> String {
    serde_json::to_string(text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Identities of models depend on this text. Large numbers may be halfway between two decimals.
        #[test]
        fn a_number_is_written_as_by_serde_json(any in any::<f64>(), digits in -99_999_i64..99_999, power in -30..30) {
            for number in [any, digits as f64 * 10_f64.powi(power), digits as f64, 0.0, -0.0, 1e16, 1e-5, 9.999e-6] {
                let mut out = String::new();
                write_number(number, &mut out);
                let known = serde_json::to_string(&number).unwrap();
                let is_halfway = number.abs() > 1e13 && out.len() == known.len() && out.parse() == Ok(number);
                prop_assert!(out == known || is_halfway, "{out} {known}");
            }
        }
    }
}
