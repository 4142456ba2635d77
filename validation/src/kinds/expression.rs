//! Closed forms as text: sums, products, pairs and functions of named values, all of them points in the plane.
//!
//! In: text, the names defined before it. Out: a term that gives a value with its derivatives. Must not depend on the
//! meaning of the names.
use super::dyads::{arm, circles, corner, line, on, towards};
use super::jet::{Jet, Vector};
use super::sketch::Miss;
use std::f64::consts::PI;

type Function = fn(&[Vector]) -> Result<Vector, Miss>;

/// Greatest number of arguments of a function.
const MOST: usize = 5;

/// Functions, with the numbers of their arguments.
const FUNCTIONS: [(&str, usize, Function); 18] = [
    ("arm", 3, |a| Ok(arm(a[0], a[1].x.value(), a[2].x))),
    ("circles", 5, |a| circles(a[0], a[1].x, a[2], a[3].x, a[4].x.value())),
    ("line", 5, |a| line(a[0], a[1].x, a[2], a[3].x, a[4].x.value())),
    ("on", 4, |a| Ok(on(a[0], a[1], a[2].x.value(), a[3]))),
    ("towards", 3, |a| Ok(towards(a[0], a[1], a[2].x))),
    ("corner", 3, |a| Ok(Vector::fixed(corner(a[0].x.value(), a[1].x.value(), a[2].x.value())))),
    ("unit", 1, |a| Ok(Vector::unit(a[0].x))),
    ("left", 1, |a| Ok(a[0].left())),
    ("norm", 1, |a| Ok(a[0].norm().into())),
    ("angle", 1, |a| Ok(a[0].angle().into())),
    ("re", 1, |a| Ok(a[0].x.into())),
    ("im", 1, |a| Ok(a[0].y.into())),
    ("sqrt", 1, |a| Ok(a[0].x.sqrt().into())),
    ("squared", 1, |a| Ok(a[0].x.squared().into())),
    ("sin", 1, |a| Ok(a[0].x.sin().into())),
    ("cos", 1, |a| Ok(a[0].x.cos().into())),
    ("tan", 1, |a| Ok(a[0].x.tan().into())),
    ("atan2", 2, |a| Ok(a[0].x.atan2(a[1].x).into())),
];
const SUM: Function = |a| Ok(a[0] + a[1]);
const DIFFERENCE: Function = |a| Ok(a[0] - a[1]);
const PRODUCT: Function = |a| Ok(a[0] * a[1]);
const QUOTIENT: Function = |a| Ok(Vector { x: a[0].x / a[1].x, y: a[0].y / a[1].x });
const NEGATIVE: Function = |a| Ok(-a[0]);
const PAIR: Function = |a| Ok(Vector { x: a[0].x, y: a[1].x });

/// A term that has a value.
#[derive(Debug)]
pub enum Term {
    Constant(Vector),
    /// A value by its index among the names.
    Named(usize),
    Call(Function, Vec<Term>),
}

impl Term {
    /// Parse a term; of duplicate names the last one counts.
    ///
    /// # Errors
    /// The text is no term, or contains an unknown name.
    pub fn read(text: &str, names: &[String]) -> Result<Self, String> {
        let mut reader = Reader { rest: text, names };
        let term = reader.sum().map_err(|why| format!("{text}: {why}"))?;
        if reader.rest.trim().is_empty() { Ok(term) } else { Err(format!("{text}: {} is too much", reader.rest)) }
    }

    /// Its value for these values of the names.
    pub fn value(&self, named: &[Vector]) -> Result<Vector, Miss> {
        match self {
            Self::Constant(value) => Ok(*value),
            Self::Named(place) => Ok(named[*place]),
            Self::Call(function, terms) => {
                let mut values = [Vector::default(); MOST];
                for (value, term) in values.iter_mut().zip(terms) {
                    *value = term.value(named)?;
                }
                function(&values[..terms.len()])
            }
        }
    }
}

struct Reader<'a> {
    rest: &'a str,
    names: &'a [String],
}

impl Reader<'_> {
    /// Skip a character if it is the next one.
    fn passes(&mut self, character: char) -> bool {
        self.rest = self.rest.trim_start();
        let rest = self.rest.strip_prefix(character);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn expect(&mut self, character: char) -> Result<(), String> {
        if self.passes(character) { Ok(()) } else { Err(format!("no {character} before {}", self.rest)) }
    }

    /// Operands separated by these operators, from left to right.
    fn chain(
        &mut self,
        operators: [(char, Function); 2],
        operand: fn(&mut Self) -> Result<Term, String>,
    ) -> Result<Term, String> {
        let mut left = operand(self)?;
        while let Some((_, function)) = operators.into_iter().find(|(sign, _)| self.passes(*sign)) {
            left = Term::Call(function, vec![left, operand(self)?]);
        }
        Ok(left)
    }

    fn sum(&mut self) -> Result<Term, String> {
        self.chain([('+', SUM), ('-', DIFFERENCE)], Self::product)
    }

    fn product(&mut self) -> Result<Term, String> {
        self.chain([('*', PRODUCT), ('/', QUOTIENT)], Self::factor)
    }

    fn factor(&mut self) -> Result<Term, String> {
        if self.passes('-') {
            return Ok(Term::Call(NEGATIVE, vec![self.factor()?]));
        }
        if self.passes('(') {
            let first = self.sum()?;
            let term = if self.passes(',') { Term::Call(PAIR, vec![first, self.sum()?]) } else { first };
            return self.expect(')').map(|()| term);
        }
        let is_end = |c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.');
        let (word, rest) = self.rest.split_at(self.rest.find(is_end).unwrap_or(self.rest.len()));
        self.rest = rest;
        if let Ok(number) = word.parse::<f64>() {
            return Ok(Term::Constant(Vector::from(Jet::from(number))));
        }
        if self.passes('(') {
            return self.call(word);
        }
        match self.names.iter().rposition(|name| name == word) {
            Some(place) => Ok(Term::Named(place)),
            None if word == "pi" => Ok(Term::Constant(Vector::from(Jet::from(PI)))),
            None => Err(format!("there is no {word}")),
        }
    }

    fn call(&mut self, word: &str) -> Result<Term, String> {
        let function = FUNCTIONS.iter().find(|(name, ..)| *name == word);
        let (_, count, function) = function.ok_or_else(|| format!("there is no function {word}"))?;
        let mut terms = vec![self.sum()?];
        while self.passes(',') {
            terms.push(self.sum()?);
        }
        self.expect(')')?;
        if terms.len() == *count { Ok(Term::Call(*function, terms)) } else { Err(format!("{word} has {count} values")) }
    }
}
