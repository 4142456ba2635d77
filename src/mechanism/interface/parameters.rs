//! Variables that are parameters of the definition: numbers, flags, then the formulation if stated.
use super::builder::Builder;
use crate::mechanism::definition::Method;
use crate::mechanism::quantity::Quantity;
use crate::variables::{Causality::Parameter, Value};

pub(super) fn add(b: &mut Builder) {
    let (mut stated, mut indices) = (b.source.mechanism.clone(), 0..);
    let mut index = || indices.next().unwrap_or_default();
    stated.parameters(&mut |p, value| {
        let start = (Some(p.unit), Value::Real(*value));
        b.known(p.name.concat(), p.description.concat(), Parameter, start, Quantity::Parameter(index()));
    });
    let mut indices = 0..;
    let mut index = || indices.next().unwrap_or_default();
    stated.flags(&mut |flag, value| {
        let start = (None, Value::Boolean(*value));
        b.known(flag.name.concat(), flag.description.concat(), Parameter, start, Quantity::Flag(index()));
    });
    if let Some(method) = stated.solver.method {
        let text = ["Formulation of the motion: ", &Method::ALL.map(Method::word).join(" or ")].concat();
        let start = (None, Value::String(method.word().into()));
        b.known("solver.method".into(), text, Parameter, start, Quantity::Method);
    }
}
