//! Expressions of numbers that are no parameters: they have a value when the file is read, and keep it.
//!
//! In: a mechanism as read, with placeholders where expressions stand, and the values of all parameters. Out: the values
//! of these expressions. It must not know the order of parameters.
use super::{Place, Unclear, is_clear, unknown_name, without_unit};
use crate::format::{DefinitionError, Expression, index_of};
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
    ) -> Result<Vec<Fixed>, DefinitionError> {
        let mut is_parameter = vec![false; texts.len()];
        for index in places.iter().filter_map(|place| place.expression) {
            is_parameter[index] = true;
        }
        let others = (0..texts.len()).filter(|index| !is_parameter[*index]);
        let read = |index: usize| {
            let text = &texts[index];
            Expression::new(text).map_err(|why| without_unit(text, None, names).unwrap_or(why))
        };
        let mut others: Vec<_> = others.map(|index| Fixed { index, expression: read(index), stated: None }).collect();
        for (key, value, unit) in self.numbers_read_once() {
            let index = index_of(value);
            let Some(fixed) = others.iter_mut().find(|fixed| Some(fixed.index) == index) else { continue };
            let name = fixed.expression.as_ref().ok().and_then(|expression| expression.names().first());
            if let (Some(name), false) = (name, key.starts_with("guess.")) {
                let why = format!(
                    "{name} may change after this number was read, which is no parameter: write numbers and functions \
                     alone, or for a drawing the body's length and points in its own frame"
                );
                return Err(DefinitionError::key(key, format_args!("\"{}\": {why}", texts[fixed.index])));
            }
            fixed.stated = Some((key, unit));
        }
        Ok(others)
    }

    /// Numbers that are no parameters and shape the mechanism, or the guess, with their keys; the unit of a length or
    /// an angle.
    fn numbers_read_once(&self) -> Vec<(String, f64, Option<Unit>)> {
        let (mut all, length, angle) = (Vec::new(), Some(Unit::Metre), Some(Unit::Radian));
        for (name, body) in self.bodies.iter() {
            let Some(drawn) = &body.drawn else { continue };
            let key = |part: &str| format!("bodies.{name}.drawn.{part}");
            let mut pair = |part: &str, [x, y]: [f64; 2]| {
                all.extend([(key(&format!("{part}[0]")), x, length), (key(&format!("{part}[1]")), y, length)]);
            };
            pair("origin", drawn.origin);
            drawn.end.into_iter().for_each(|end| pair("end", end));
            drawn.center.into_iter().for_each(|center| pair("center", center));
            drawn.points.iter().for_each(|(point, place)| pair(&format!("points.{point}"), *place));
            all.extend(drawn.angle.map(|value| (key("angle"), value, angle)));
        }
        let way = |is_rotary: bool| if is_rotary { angle } else { length };
        let mut points = |key: String, points: &Option<Vec<[f64; 2]>>, units: [Option<Unit>; 2]| {
            for (i, point) in points.iter().flatten().enumerate() {
                all.extend((0..2).map(|part| (format!("{key}[{i}][{part}]"), point[part], units[part])));
            }
        };
        for (name, spring) in self.springs.iter() {
            points(format!("springs.{name}.points"), &spring.points, [way(self.is_rotary(&spring.joint)), None]);
            points(format!("springs.{name}.damping_points"), &spring.damping_points, [None; 2]);
        }
        for (name, stop) in self.stops.iter() {
            points(format!("stops.{name}.points"), &stop.points, [way(stop.angle.is_some()), None]);
        }
        for (name, actuator) in self.actuators.iter() {
            points(format!("actuators.{name}.points"), &actuator.points, [None; 2]);
            let table = actuator.motion.as_ref().map_or(&None, |motion| &motion.points);
            points(format!("actuators.{name}.motion.points"), table, [None, way(self.turns(actuator))]);
        }
        for (name, coupling) in self.couplings.iter() {
            let mut units = Vec::new();
            coupling.clone().lift_numbers(&mut |is_angle, _| units.push(way(is_angle)));
            let numbers = coupling.stated_lift(&format!("couplings.{name}")).into_iter();
            all.extend(numbers.zip(units).map(|((key, value), unit)| (key, value, unit)));
        }
        let of_guess = |name: &str| way(self.bodies.get(name).is_some());
        all.extend(self.guess.iter().map(|(name, value)| (format!("guess.{name}"), *value, of_guess(name))));
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
            false => Err(said(format!("its value is {}: must be a finite number", Decimal(value)))),
        }
    }
}
