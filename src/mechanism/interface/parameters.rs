//! Parameters of a definition as variables: numbers, flags, then the formulation if it is stated.
//!
//! In: a definition. Out: their variables, each with its quantity. It must not know what a parameter acts on.
use super::builder::Builder;
use crate::format::Range;
use crate::mechanism::definition::{Expressions, Mechanism, Method, Role};
use crate::mechanism::quantity::Quantity;
use crate::variables::Causality::Parameter;
use crate::variables::{Reference, Unit, Value, Variability};

/// The parameters of a definition, as a visit lists them; the definition lends itself to the other variables after it.
pub(super) struct Known {
    numbers: Vec<Number>,
    /// Name, description and value of each flag.
    flags: Vec<(String, String, bool)>,
}

/// A numeric parameter.
struct Number {
    name: String,
    text: String,
    unit: Unit,
    range: Range,
    role: Role,
    value: f64,
}

impl Known {
    /// Those of a definition, which the visit leaves as it is; `describes`: with descriptions.
    pub fn new(mechanism: &mut Mechanism, describes: bool) -> Self {
        let (mut numbers, mut flags) = (Vec::new(), Vec::new());
        mechanism.parameters(&mut |p, value| {
            let text = if describes { p.description.concat() } else { String::new() };
            let (name, unit, range, role) = (p.name.concat(), p.unit, p.range, p.role);
            numbers.push(Number { name, text, unit, range, role, value: *value });
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
        let tunable = self.tunable(&mechanism.expressions);
        for (index, number) in self.numbers.into_iter().enumerate() {
            let Number { name, text, unit, range, value, .. } = number;
            let quantity = Quantity::Parameter(index);
            match mechanism.expressions.of(index) {
                Some(calculated) => {
                    let text = b.text(|| [&text, ": ", calculated.text()].concat());
                    let bases = calculated.bases.iter().map(|base| (first + base) as Reference).collect();
                    b.calculated(name, text, unit, quantity, bases);
                }
                None => b.known(name, text, Parameter, (Some(unit), Value::Real(value)), quantity),
            }
            if let Some(variable) = b.list.last_mut() {
                variable.details.bounds = range.bounds();
                if tunable[index] {
                    variable.variability = Variability::Tunable;
                }
            }
        }
        for (index, (name, text, value)) in self.flags.into_iter().enumerate() {
            b.known(name, text, Parameter, (None, Value::Boolean(value)), Quantity::Flag(index));
        }
        if let Some(method) = mechanism.solver.method {
            let text = b.text(|| {
                let methods = Method::ALL.map(Method::word).join(" or ");
                ["Model of the mechanism: ", &methods, ". reduced: rigid bodies; rigid_fem: elastic rods"].concat()
            });
            let start = (None, Value::Item(method.word().into()));
            b.known("solver.method".into(), text, Parameter, start, Quantity::Method);
        }
    }
    /// Which numbers may change between two steps: those of laws and of the integration, unless one that may not
    /// follows from them; a named parameter, if all that follow from it may; one that follows from others, if all these
    /// may.
    fn tunable(&self, expressions: &Expressions) -> Vec<bool> {
        let role = |index: usize| self.numbers[index].role;
        let mut tunable: Vec<bool> = self.numbers.iter().map(|number| number.role.is_tunable()).collect();
        if expressions.is_empty() {
            return tunable;
        }
        for index in (0..tunable.len()).filter(|index| expressions.of(*index).is_none()) {
            let followers = expressions.iter().filter(|calculated| calculated.bases.contains(&index));
            let followers: Vec<Role> = followers.map(|calculated| role(calculated.index)).collect();
            let is_named = role(index) == Role::Named && followers.iter().any(|role| role.is_tunable());
            tunable[index] =
                (tunable[index] || is_named) && followers.iter().all(|role| role.is_tunable() || *role == Role::Named);
        }
        for calculated in expressions.iter() {
            tunable[calculated.index] =
                !calculated.bases.is_empty() && calculated.bases.iter().all(|&base| tunable[base]);
        }
        tunable
    }
}
