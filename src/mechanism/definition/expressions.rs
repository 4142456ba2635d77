//! Parameters whose values are expressions of others.
//!
//! In: a mechanism as read, with placeholders where expressions stand. Out: the mechanism with all its numbers, and its
//! expressions in an order in which each finds the values that it reads. It must not know the laws of the mechanism.
mod order;
mod read_once;

use super::Mechanism;
use super::drawing::in_file;
use crate::format::{
    Aside, DefinitionError, Expression, Faults, Field, Kind, Node, Numbers, Own, Range, Slot, index_of,
    number_with_unit, quoted, read_with,
};
use crate::numerics::decimal::Decimal;
use crate::numerics::order::distinct;
use crate::variables::{Unit, nearest};
use order::ordered;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The expressions of a mechanism, each behind those that it reads.
#[derive(Clone, Debug, Default)]
pub struct Expressions(Option<Arc<List>>);

#[derive(Debug)]
struct List {
    ordered: Vec<Calculated>,
    /// Place in the list by the index of the parameter.
    places: HashMap<usize, usize>,
}

/// A parameter whose value is an expression.
#[derive(Clone, Debug)]
pub struct Calculated {
    /// Name of the parameter.
    pub name: String,
    /// Path of its key in the file.
    pub key: String,
    expression: Expression,
    range: Range,
    unit: Unit,
    /// Unit of numbers under this key in the file, where it is none of SI.
    file_unit: Option<&'static str>,
    /// Index among the parameters of the mechanism.
    pub index: usize,
    /// Indices of the parameters that the expression reads, by its names.
    arguments: Vec<usize>,
    /// Units of these.
    units: Vec<Unit>,
    /// Indices of the parameters that a host sets and that decide the value, ascending.
    pub bases: Vec<usize>,
}

/// A value that an expression must not have.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Name of the parameter.
    pub name: String,
    /// Its expression.
    pub text: String,
    /// Value of the expression.
    pub value: f64,
    /// What is allowed.
    pub allowed: String,
    /// What the expression read, in words.
    pub because: String,
}

/// An expression for a length or an angle that holds a number without a unit, in a file with other units than SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Unclear {
    /// Path of its key in the file.
    pub key: String,
    /// The expression as it was written.
    pub text: String,
    /// Value, in SI units.
    pub value: f64,
    /// Unit of numbers under this key.
    pub file_unit: &'static str,
}

impl PartialEq for Expressions {
    fn eq(&self, other: &Self) -> bool {
        self.iter().map(Calculated::signature).eq(other.iter().map(Calculated::signature))
    }
}

impl Field for Expressions {
    const KIND: Kind = Kind::Own("nothing");

    fn slot(&mut self) -> Slot<'_> {
        Slot::Own(self)
    }
}

impl Own for Expressions {
    fn take(&mut self, _: &Node, _: &str) -> Result<(), String> {
        Ok(())
    }

    /// Names and texts: what they say is no parameter.
    fn written(&self) -> String {
        let all: Vec<String> = self.iter().map(|one| format!("{}:{}", quoted(&one.name), quoted(one.text()))).collect();
        if all.is_empty() { String::new() } else { format!("{{{}}}", all.join(",")) }
    }
}

impl Calculated {
    fn signature(&self) -> (&str, &str) {
        (&self.name, self.expression.text())
    }

    /// The expression as it was written.
    pub fn text(&self) -> &str {
        self.expression.text()
    }

    /// Write the value among those of all parameters.
    pub fn compute(&self, values: &mut [f64]) {
        values[self.index] = self.value(values);
    }

    fn value(&self, values: &[f64]) -> f64 {
        self.expression.evaluate(|name| values[self.arguments[name]])
    }

    /// The values that the expression reads, in words.
    fn because(&self, values: &[f64]) -> String {
        let unit = |unit: Unit| if unit == Unit::One { String::new() } else { format!(" {}", unit.name()) };
        let read = self.expression.names().iter().zip(&self.arguments).zip(&self.units);
        let read = read.map(|((name, &i), &of)| format!("{name} = {}{}", Decimal(values[i]), unit(of)));
        let read: Vec<String> = read.collect();
        if read.is_empty() { String::new() } else { format!("; the expression uses {}", read.join(", ")) }
    }

    /// What is unclear about the unit of this expression. `parameters`: units and values of all parameters.
    pub fn unclear(&self, parameters: &[(Unit, f64)]) -> Option<Unclear> {
        let (file_unit, value) = (self.file_unit?, parameters[self.index].1);
        let is_clear = is_clear(&self.expression, self.unit, value, |name| parameters[self.arguments[name]]);
        (!is_clear).then(|| Unclear { key: self.key.clone(), text: self.text().to_owned(), value, file_unit })
    }

    fn fault(&self, values: &[f64]) -> Option<Fault> {
        let value = values[self.index];
        let because = || self.because(values);
        (!self.range.contains(value)).then(|| Fault {
            name: self.name.clone(),
            text: self.text().to_owned(),
            value,
            allowed: self.range.text(),
            because: because(),
        })
    }
}

/// Whether no number in an expression may be meant in another unit of length or angle: its value is a sum of products
/// of quantities with units alone. `parameter`: unit and value of each parameter that it reads, by its names.
fn is_clear(expression: &Expression, of: Unit, value: f64, parameter: impl Fn(usize) -> (Unit, f64)) -> bool {
    const SCALE: f64 = 2.0;
    let of_base = |unit: Unit| {
        let [_, (_, metres), _, (_, radians)] = unit.base();
        if of == Unit::Radian { radians } else { metres }
    };
    // The same expression where the unit of length, or of angle, is half of the SI unit.
    let scaled = expression.evaluate(|name| {
        let (unit, value) = parameter(name);
        value * SCALE.powi(of_base(unit).into())
    });
    let is_alike = (scaled - SCALE * value).abs() <= 1e-9 * value.abs();
    match of {
        Unit::Radian if expression.reads("deg") => false,
        Unit::Radian => is_alike || ["pi", "rad", "asin", "acos", "atan", "atan2"].iter().any(|w| expression.reads(w)),
        _ => is_alike,
    }
}

impl Expressions {
    fn new(ordered: Vec<Calculated>) -> Self {
        let places = ordered.iter().enumerate().map(|(place, one)| (one.index, place)).collect();
        Self((!ordered.is_empty()).then(|| Arc::new(List { ordered, places })))
    }

    /// All, each behind those that it reads.
    pub fn iter(&self) -> impl Iterator<Item = &Calculated> {
        self.0.iter().flat_map(|list| &list.ordered)
    }

    /// Whether there is none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.0.is_none()
    }

    /// The expression of the parameter with this index.
    pub fn of(&self, parameter: usize) -> Option<&Calculated> {
        let list = self.0.as_ref()?;
        list.places.get(&parameter).map(|&place| &list.ordered[place])
    }

    /// Write the value of each expression among the values of all parameters.
    pub fn compute(&self, values: &mut [f64]) {
        self.iter().for_each(|one| one.compute(values));
    }

    /// The first value that an expression must not have, of values that [`Self::compute`] has completed.
    pub fn fault(&self, values: &[f64]) -> Option<Fault> {
        self.iter().find_map(|one| one.fault(values))
    }

    /// Without those of parameters that have none of these names. Returns the key of one that is left and uses such a
    /// parameter, and this parameter.
    fn left(&self, names: &HashMap<String, usize>) -> (Self, Option<(String, String)>) {
        let left: Vec<Calculated> = self.iter().filter(|one| names.contains_key(&one.name)).cloned().collect();
        let gone = |one: &Calculated| one.expression.names().iter().find(|name| !names.contains_key(*name)).cloned();
        let at_fault = left.iter().find_map(|one| Some((one.key.clone(), gone(one)?)));
        (Self::new(left), at_fault)
    }

    /// The same expressions among the parameters of a mechanism, whose indices they take.
    fn indexed(&self, names: &HashMap<String, usize>) -> Self {
        let Some(list) = &self.0 else { return Self::default() };
        let mut ordered = list.ordered.clone();
        let of = |name: &String| names.get(name).copied().unwrap_or_default();
        let mut bases: HashMap<usize, Vec<usize>> = HashMap::new();
        for one in &mut ordered {
            one.index = of(&one.name);
            one.arguments = one.expression.names().iter().map(of).collect();
            let all = one.arguments.iter().flat_map(|i| bases.get(i).cloned().unwrap_or_else(|| vec![*i]));
            one.bases = distinct(all.collect());
            bases.insert(one.index, one.bases.clone());
        }
        Self::new(ordered)
    }
}

/// Unit of a number, and its unit in the file, where it is none of SI.
type Stated = (Unit, Option<&'static str>);

/// A parameter of a mechanism as read.
struct Place {
    name: String,
    key: String,
    unit: Unit,
    range: Range,
    value: f64,
    /// Unit of the number in the file, where it is none of SI.
    file_unit: Option<&'static str>,
    /// Index of the expression that stands there.
    expression: Option<usize>,
}

/// All parameters, in order.
fn places(mechanism: &mut Mechanism) -> Vec<Place> {
    let mut places = Vec::new();
    let units = mechanism.units.unwrap_or_default();
    mechanism.parameters(&mut |p, value| {
        let expression = index_of(*value);
        let (name, key, file_unit) = (p.name.concat(), p.key.concat(), units.of_parameter(p.unit, p.role));
        places.push(Place { name, key, unit: p.unit, range: p.range, value: *value, file_unit, expression });
    });
    places
}

fn indices(places: &[Place]) -> HashMap<String, usize> {
    places.iter().enumerate().map(|(index, place)| (place.name.clone(), index)).collect()
}

impl Mechanism {
    /// Read a mechanism, with the values of its expressions in SI units, and what is at fault in its form; without any
    /// other check.
    pub(super) fn read(text: &str) -> (Self, Faults) {
        let numbers = Numbers::with_expressions();
        let mut mechanism = Self::default();
        let mut faults = read_with("mechanism", text, &numbers, &mut mechanism);
        if faults.are_of_unknown_keys() {
            faults.keep(mechanism.shared.as_ref().map_or(Ok(()), |shared| shared.check()));
        }
        let texts = numbers.into_texts();
        if !texts.is_empty() && faults.are_of_unknown_keys() {
            mechanism.read_expressions(text, &texts, &mut faults);
        }
        (mechanism, faults)
    }

    /// The values of these expressions in the places of numbers; apart from [`Self::read`], whose stack stays small so.
    #[inline(never)]
    fn read_expressions(&mut self, text: &str, texts: &[String], faults: &mut Faults) {
        let mut places = places(self);
        let names = indices(&places);
        let calculated = self.calculated(&places, &names, texts, faults);
        let read = self.fixed_expressions(&places, &names, texts, faults);
        let Some(ordered) = faults.keep(ordered(calculated, &names)) else { return };
        if !faults.are_of_unknown_keys() {
            return;
        }
        let units = self.units.unwrap_or_default();
        self.convert_units();
        let mut values = Vec::new();
        self.parameters(&mut |_, value| values.push(*value));
        let expressions = Expressions::new(ordered).indexed(&names);
        let mut at_fault = HashSet::new();
        for one in expressions.iter() {
            one.compute(&mut values);
            let Some(fault) = one.fault(&values) else { continue };
            // A value that follows from one at fault has no fault of its own.
            if at_fault.insert(one.index) && !one.arguments.iter().any(|argument| at_fault.contains(argument)) {
                let unit = if one.unit == Unit::One { String::new() } else { format!(" {}", one.unit.name()) };
                let value = format_args!("\"{}\" = {}{unit}", fault.text, Decimal(fault.value));
                let allowed = format_args!("{}{}{}", fault.allowed, fault.because, self.origin(&one.key));
                faults.push(DefinitionError::value(&one.key, value, allowed));
            }
        }
        if !read.is_empty() {
            // Numbers that are no parameters have the values that their expressions have now.
            places.iter_mut().zip(&values).for_each(|(place, value)| place.value = *value);
            let (mut known, mut unclear) = (vec![None; texts.len()], Vec::new());
            for fixed in &read {
                let value = fixed.value(&names, &places);
                unclear.extend(fixed.unclear(&value, units, (&names, &places)));
                let unit = fixed.stated.as_ref().and_then(|(_, unit)| *unit).unwrap_or(Unit::One);
                known[fixed.index] = Some(value.map(|value| units.stated(unit, value)));
            }
            let numbers = Numbers::with_values(known);
            *self = Self::default();
            faults.join(read_with("mechanism", text, &numbers, self));
            self.convert_units();
            self.unclear = Aside(unclear);
        }
        let mut all = values.iter();
        self.parameters(&mut |_, value| *value = all.next().copied().unwrap_or(*value));
        self.expressions = expressions;
    }

    /// Forget the expressions of parameters that have been left out. Returns the key of an expression that uses one of
    /// these, and its name.
    pub(super) fn forget_expressions(&mut self) -> Option<(String, String)> {
        if self.expressions.is_empty() {
            return None;
        }
        let names = indices(&places(self));
        let (left, at_fault) = self.expressions.left(&names);
        self.expressions = left;
        at_fault
    }

    /// Give the expressions the indices of the parameters that there are now: a drawing may have added some.
    pub(super) fn index_expressions(&mut self) {
        if !self.expressions.is_empty() {
            let names = indices(&places(self));
            self.expressions = self.expressions.indexed(&names);
        }
    }

    /// Where a shared parameter stands, for messages.
    fn origin(&self, key: &str) -> String {
        match &self.shared {
            Some(shared) if key.starts_with("parameters_from") => format!(" (in {})", shared.file),
            _ => String::new(),
        }
    }

    /// The parameters with an expression that can be read.
    #[inline(never)]
    fn calculated(
        &self,
        places: &[Place],
        names: &HashMap<String, usize>,
        texts: &[String],
        faults: &mut Faults,
    ) -> Vec<Calculated> {
        let mut calculated = Vec::new();
        for (index, place) in places.iter().enumerate() {
            let Some(text) = place.expression.and_then(|expression| texts.get(expression)) else { continue };
            let read = match Expression::new(text) {
                _ if place.name == "solver.tolerance" => Err("this number becomes a parameter of the FMU, which \
                    simulation tools can change: write a number, not an expression"
                    .to_owned()),
                Ok(expression) => match expression.names().iter().find(|name| !names.contains_key(*name)) {
                    Some(unknown) => Err(unknown_name(unknown, places)),
                    None => Ok(expression),
                },
                Err(why) => {
                    let is_plain = place.key.starts_with("parameters") && place.unit == Unit::One;
                    let named = is_plain.then(|| with_unit(text, names)).flatten();
                    Err(named.or_else(|| without_unit(text, (place.unit, place.file_unit), names)).unwrap_or(why))
                }
            };
            let fault =
                |why| DefinitionError::key(&place.key, format_args!("\"{text}\": {why}{}", self.origin(&place.key)));
            let Some(expression) = faults.keep(read.map_err(fault)) else { continue };
            let (name, key, range, unit) = (place.name.clone(), place.key.clone(), place.range, place.unit);
            let (file_unit, arguments, bases) = (place.file_unit, Vec::new(), Vec::new());
            let units = expression.names().iter().map(|name| places[names[name]].unit).collect();
            calculated.push(Calculated {
                name,
                key,
                expression,
                range,
                unit,
                file_unit,
                index,
                arguments,
                units,
                bases,
            });
        }
        calculated
    }
}

/// The number and the unit in a text such as `160 kg`, if the unit is no name of a parameter.
fn number_and_unit<'t>(text: &'t str, names: &HashMap<String, usize>) -> Option<(f64, &'t str)> {
    let (number, unit) = number_with_unit(text).filter(|(_, unit)| !names.contains_key(*unit))?;
    Some((number.parse().ok()?, unit))
}

/// What to write in the place of a number with its unit. `unit`: unit of the number that stands there, and the file's
/// unit of this number, where it is none of SI.
fn without_unit(text: &str, (unit, file_unit): Stated, names: &HashMap<String, usize>) -> Option<String> {
    let (number, stated) = number_and_unit(text, names)?;
    let own = file_unit.unwrap_or(unit.name());
    let si = unit.convert(number, stated);
    let write = if own == stated { Some(number) } else { si.map(|si| in_file(file_unit, si)) };
    Some(match write.map(Decimal::rounded) {
        Some(write) if own == "1" => format!("write {write} without a unit: this number has no unit"),
        Some(write) => format!("write {write} without a unit: this number is in {own}"),
        None if own == "1" => "this number has no unit: write a number without a unit".to_owned(),
        None => format!("write the number in {own}, without a unit"),
    })
}

/// What to write as a named parameter, whose unit is a key, in the place of a number with its unit.
fn with_unit(text: &str, names: &HashMap<String, usize>) -> Option<String> {
    let (number, stated) = number_and_unit(text, names)?;
    let (unit, si) = Unit::of_quantity(number, stated).filter(|(unit, _)| *unit != Unit::One)?;
    Some(format!("write {{ \"value\": {}, \"unit\": \"{}\" }}", Decimal::rounded(si), unit.name()))
}

fn unknown_name(name: &str, places: &[Place]) -> String {
    let nearest = nearest(places.iter().map(|place| place.name.as_str()), name).join(", ");
    format!("there is no parameter {name}; similar names are {nearest}; define named numbers in \"parameters\"")
}
