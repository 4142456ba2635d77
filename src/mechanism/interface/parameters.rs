//! Parameters of a definition as variables: numbers, flags, then the formulation if it is stated.
//!
//! In: a definition. Out: their variables, each with its quantity. It must not know what a parameter acts on.
use super::builder::Builder;
use crate::mechanism::definition::{Mechanism, Method};
use crate::mechanism::quantity::Quantity;
use crate::variables::Causality::Parameter;
use crate::variables::{Reference, Unit, Value};

/// The parameters of a definition, as a visit lists them; the definition lends itself to the other variables after it.
pub(super) struct Known {
    /// Name, description, unit and value of each number.
    numbers: Vec<(String, String, Unit, f64)>,
    /// Name, description and value of each flag.
    flags: Vec<(String, String, bool)>,
}

impl Known {
    /// Those of a definition, which the visit leaves as it is; `describes`: with descriptions.
    pub fn new(mechanism: &mut Mechanism, describes: bool) -> Self {
        let (mut numbers, mut flags) = (Vec::new(), Vec::new());
        mechanism.parameters(&mut |p, value| {
            let text = if describes { p.description.concat() } else { String::new() };
            numbers.push((p.name.concat(), text, p.unit, *value));
        });
        mechanism.flags(&mut |flag, value| {
            let text = if describes { flag.description.concat() } else { String::new() };
            flags.push((flag.name.concat(), text, *value));
        });
        Self { numbers, flags }
    }

    /// Add their variables.
    pub fn add(self, b: &mut Builder) {
        let (mechanism, first) = (b.source.mechanism, b.list.len());
        for (index, (name, text, unit, value)) in self.numbers.into_iter().enumerate() {
            let quantity = Quantity::Parameter(index);
            match mechanism.expressions.of(index) {
                Some(calculated) => {
                    let text = b.text(|| [&text, ": ", calculated.text()].concat());
                    let bases = calculated.bases.iter().map(|base| (first + base) as Reference).collect();
                    b.calculated(name, text, unit, quantity, bases);
                }
                None => b.known(name, text, Parameter, (Some(unit), Value::Real(value)), quantity),
            }
        }
        for (index, (name, text, value)) in self.flags.into_iter().enumerate() {
            b.known(name, text, Parameter, (None, Value::Boolean(value)), Quantity::Flag(index));
        }
        if let Some(method) = mechanism.solver.method {
            let text = b.text(|| ["Formulation of the motion: ", &Method::ALL.map(Method::word).join(" or ")].concat());
            let start = (None, Value::String(method.word().into()));
            b.known("solver.method".into(), text, Parameter, start, Quantity::Method);
        }
    }
}
