//! All numbers of a definition with their rows.
//!
//! In: a value with its table. Out: each of its numbers with its path. Must not know: what a number means.
use super::keys::{Key, Keyed, Slot};
use super::named::Named;
use crate::variables::Unit;

/// A number of a definition.
pub struct Number<'n> {
    /// Path in the file, such as `bodies.crank.points.tip[1]`.
    pub path: &'n str,
    /// Row of its key.
    pub key: &'n Key,
    /// Units for linear and for rotary elements.
    pub units: [Unit; 2],
    /// The value.
    pub value: &'n mut f64,
}

impl Number<'_> {
    /// The unit of the number. `rotary` contains the paths of the rotary elements, which use the second unit.
    pub fn unit(&self, rotary: &Named<()>) -> Unit {
        let end = self.path.match_indices('.').nth(1).map_or(self.path.len(), |(at, _)| at);
        self.units[usize::from(rotary.get(&self.path[..end]).is_some())]
    }
}

/// Calls `visit` with each number, in the order of the tables.
pub fn numbers(definition: &mut dyn Keyed, visit: &mut dyn FnMut(Number)) {
    object("", definition, visit);
}

fn object(path: &str, object: &mut dyn Keyed, visit: &mut dyn FnMut(Number)) {
    let dot = if path.is_empty() { "" } else { "." };
    for (index, key) in object.table().keys.iter().enumerate() {
        value(&format!("{path}{dot}{}", key.name), key, object.slot(index), visit);
    }
}

fn value(path: &str, key: &Key, slot: Slot, visit: &mut dyn FnMut(Number)) {
    match slot {
        Slot::Number(value) => visit(Number { path, key, units: key.units, value }),
        Slot::Pair([x, y]) => {
            visit(Number { path: &format!("{path}[0]"), key, units: key.units, value: x });
            let units = key.second.unwrap_or(key.units);
            visit(Number { path: &format!("{path}[1]"), key, units, value: y });
        }
        Slot::Object(inner) => object(path, inner, visit),
        Slot::Maybe(maybe) => maybe.get().into_iter().for_each(|slot| value(path, key, slot, visit)),
        Slot::Group(group) => {
            for index in 0.. {
                let Some((name, slot)) = group.entry(index) else { break };
                value(&format!("{path}.{name}"), key, slot, visit);
            }
        }
        Slot::List(list) => {
            for index in 0.. {
                let Some(slot) = list.element(index) else { break };
                value(&format!("{path}[{index}]"), key, slot, visit);
            }
        }
        Slot::Whole(_) | Slot::Flag(_) | Slot::Text(_) | Slot::Word(_) | Slot::Own(_) => {}
    }
}
