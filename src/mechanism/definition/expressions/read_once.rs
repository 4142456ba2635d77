//! Expressions of numbers that are no parameters: they have a value when the file is read, and keep it.
//!
//! In: a mechanism as read, with placeholders where expressions stand, and the values of all parameters. Out: the
//! values of these expressions. It must not know the order of parameters.
use super::{Place, Stated, Unclear, is_clear, unknown_name, without_unit};
use crate::format::{Expression, Faults, Number, index_of, numbers};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::definition::drawing::Units;
use crate::numerics::decimal::Decimal;
use crate::variables::Unit;
use std::collections::HashMap;

/// An expression of a number that is no parameter.
pub(super) struct Fixed {
    pub(super) index: usize,
    /// The expression; why it cannot be read.
    expression: Result<Expression, String>,
    /// Its key, and the unit of the number where it is a length or an angle.
    pub(super) stated: Option<(String, Option<Unit>)>,
}

impl Mechanism {
    /// Expressions of numbers that are no parameters, by their index; those that cannot be read are refused as they
    /// are reached.
    #[inline(never)]
    pub(super) fn fixed_expressions(
        &self,
        places: &[Place],
        names: &HashMap<String, usize>,
        texts: &[String],
        faults: &mut Faults,
    ) -> Vec<Fixed> {
        let mut is_parameter = vec![false; texts.len()];
        for index in places.iter().filter_map(|place| place.expression) {
            is_parameter[index] = true;
        }
        let others = (0..texts.len()).filter(|index| !is_parameter[*index]);
        let stated = self.stated_units(texts.len());
        let read = |index: usize| {
            let text = &texts[index];
            Expression::new(text).map_err(|why| without_unit(text, stated[index], names).unwrap_or(why))
        };
        let mut others: Vec<_> = others.map(|index| Fixed { index, expression: read(index), stated: None }).collect();
        for (key, value, unit) in self.numbers_read_once() {
            let index = index_of(value);
            let Some(fixed) = others.iter_mut().find(|fixed| Some(fixed.index) == index) else { continue };
            let name = fixed.expression.as_ref().ok().and_then(|expression| expression.names().first());
            if let (Some(name), false) = (name, key.starts_with("guess.")) {
                let why = format!(
                    "a simulation tool can change {name}, but this number is fixed when the file is read: write an \
                     expression without parameters, or replace the key `drawn` by the key `length` and by `points` \
                     in the frame of the body"
                );
                faults.refuse(&key, format_args!("\"{}\": {why}", texts[fixed.index]));
            }
            fixed.stated = Some((key, unit));
        }
        others
    }

    /// Unit of the number in whose place each of the `count` texts stands.
    fn stated_units(&self, count: usize) -> Vec<Stated> {
        let (mut all, units, rotary) = (vec![(Unit::One, None); count], self.units.unwrap_or_default(), self.rotary());
        numbers(&mut self.clone(), &mut |number: Number| {
            if let Some(stated) = index_of(*number.value).and_then(|index| all.get_mut(index)) {
                let unit = number.unit(&rotary);
                *stated = (unit, units.of_path(number.path, unit));
            }
        });
        all
    }

    /// Numbers that are no parameters and shape the mechanism, or the guess, with their keys; the unit of a length or
    /// an angle.
    fn numbers_read_once(&self) -> Vec<(String, f64, Option<Unit>)> {
        let (mut all, rotary) = (Vec::new(), self.rotary());
        numbers(&mut self.clone(), &mut |number: Number| {
            let Number { path, key, value, .. } = &number;
            let shapes = key.second.is_some() || path.starts_with("guess.");
            if shapes || [".drawn.", ".segments["].iter().any(|part| path.contains(part)) {
                let unit = Some(number.unit(&rotary)).filter(|unit| matches!(unit, Unit::Metre | Unit::Radian));
                all.push(((*path).to_owned(), **value, unit));
            }
        });
        all
    }
}

impl Fixed {
    /// What is unclear about the unit of this expression of this value, in a file with these units. `known`: all
    /// parameters, by name.
    pub(super) fn unclear(
        &self,
        value: &Result<f64, String>,
        units: Units,
        (names, places): (&HashMap<String, usize>, &[Place]),
    ) -> Option<Unclear> {
        let (Ok(value), Ok(expression), Some((key, Some(unit)))) = (value, &self.expression, &self.stated) else {
            return None;
        };
        let file_unit = units.of_number(*unit)?;
        let of = |name: usize| names.get(&expression.names()[name]).map(|&index| &places[index]);
        let parameter = |name: usize| of(name).map_or((Unit::One, 0.0), |place| (place.unit, place.value));
        let is_clear = is_clear(expression, *unit, *value, parameter);
        let text = expression.text().to_owned();
        (!is_clear).then(|| Unclear { key: key.clone(), text, value: *value, file_unit })
    }

    /// Value of the expression; why it has none.
    pub(super) fn value(&self, names: &HashMap<String, usize>, places: &[Place]) -> Result<f64, String> {
        let expression = self.expression.as_ref().map_err(String::clone)?;
        let said = |why: String| format!("\"{}\": {why}", expression.text());
        if let Some(unknown) = expression.names().iter().find(|name| !names.contains_key(*name)) {
            return Err(said(unknown_name(unknown, places)));
        }
        let value = expression.evaluate(|name| places[names[&expression.names()[name]]].value);
        match value.is_finite() {
            true => Ok(value),
            false => Err(said(format!("the value is {}, but must be a finite number", Decimal(value)))),
        }
    }
}
