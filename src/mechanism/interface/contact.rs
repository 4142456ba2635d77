//! Variables of stops and locks.
use super::builder::Builder;
use super::needs::Needs;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::quantity::{Output, Quantity};
use crate::variables::Unit::{Newton, NewtonMetre};
use crate::variables::{Causality, Value};

pub(super) fn add_inputs(b: &mut Builder) {
    for (i, (name, lock)) in b.source.mechanism.locks.iter().enumerate() {
        let text = ["Whether ", name, " holds the mechanism when it is at ", &lock.stop].concat();
        let start = (None, Value::Boolean(lock.engage));
        b.known([name, ".engage"].concat(), text, Causality::Input, start, Quantity::Lock(i));
    }
}

pub(super) fn add_stops(b: &mut Builder) {
    let s = b.source;
    for (i, stop) in s.loading.stops.iter().enumerate() {
        let n = stop.name.as_str();
        let stated = s.mechanism.stops.get(n).and_then(|stop| stop.flag.clone());
        let position = match s.loading.loads[stop.load] {
            Load::Torque { body } => s.position(&[body]),
            _ => s.displacement(stop.load),
        };
        let needs = Needs { loads: &[stop.load], ..position };
        let text = ["Whether the mechanism is at ", n].concat();
        b.any_output(stated.unwrap_or_else(|| [n, ".reached"].concat()), text, None, Quantity::AtStop(i), needs);
        let (suffix, unit) = if stop.quantity == "angle" { ("torque", NewtonMetre) } else { ("force", Newton) };
        let text = ["Push of ", n, " against the mechanism"];
        b.output(n, suffix, &text, unit, Output::Stop { stop: i }, s.acceleration());
    }
}

pub(super) fn add_locks(b: &mut Builder) {
    let s = b.source;
    for (i, lock) in s.loading.locks.iter().enumerate() {
        let text = ["Force with which ", &lock.name, " holds, positive towards ", &s.loading.stops[lock.stop].name];
        b.output(&lock.name, "force", &text, Newton, Output::Lock { lock: i }, s.acceleration());
    }
}
