//! Expressions instead of numbers: arithmetic with names, numbers and functions.
//!
//! In: the text of an expression, then values of its names. Out: its value. Method: precedence climbing with the usual
//! precedence. -x^2 is -(x^2), and equal operators are applied from left to right. Must not know: what the names mean.
use std::f64::consts::{E, PI};

/// Largest length of an expression [bytes].
pub const LONGEST_EXPRESSION: usize = 1000;
/// Largest depth of nested parentheses.
const DEEPEST: usize = 30;
/// Constants by name.
const CONSTANTS: [(&str, f64); 2] = [("pi", PI), ("e", E)];
/// Precedence of the power, the highest of all operators. A sign has a lower precedence than a power and a higher
/// precedence than a product.
const POWER: u8 = 2;

/// A parsed expression.
#[derive(Clone, Debug)]
pub struct Expression {
    text: String,
    /// Names in the expression, each once.
    names: Vec<String>,
    /// Steps in postfix order: the operands of a step precede the step.
    steps: Vec<Step>,
}

/// A step of the evaluation, which replaces its operands by one value.
#[derive(Clone, Copy, Debug)]
enum Step {
    Number(f64),
    /// Value of the name with this index.
    Name(usize),
    Unary(fn(f64) -> f64),
    Binary(fn(f64, f64) -> f64),
}

/// Name and function of one argument, or of two.
type Unary = (&'static str, fn(f64) -> f64);
type Binary = (&'static str, fn(f64, f64) -> f64);

/// Functions of one argument.
const UNARY: [Unary; 15] = [
    ("sqrt", f64::sqrt),
    ("abs", f64::abs),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("floor", f64::floor),
    ("ceil", f64::ceil),
    ("deg", f64::to_degrees),
    ("rad", f64::to_radians),
];
/// Functions of two arguments. `min` and `max` return NaN if one argument is NaN.
const BINARY: [Binary; 4] = [
    ("atan2", f64::atan2),
    ("hypot", f64::hypot),
    ("min", |a, b| if a.is_nan() || a < b { a } else { b }),
    ("max", |a, b| if a.is_nan() || a > b { a } else { b }),
];

/// Precedence and function of a binary operator.
type Operator = (u8, fn(f64, f64) -> f64);

/// The operator of a token.
fn operator(token: Option<Token>) -> Option<Operator> {
    match token {
        Some(Token::Symbol('+')) => Some((0, |a, b| a + b)),
        Some(Token::Symbol('-')) => Some((0, |a, b| a - b)),
        Some(Token::Symbol('*')) => Some((1, |a, b| a * b)),
        Some(Token::Symbol('/')) => Some((1, |a, b| a / b)),
        Some(Token::Symbol('^')) => Some((POWER, power)),
        _ => None,
    }
}

/// A power. Squares and cubes are computed by multiplication, so that they are identical to the product.
fn power(base: f64, exponent: f64) -> f64 {
    match exponent {
        2.0 => base * base,
        3.0 => base * base * base,
        _ => base.powf(exponent),
    }
}

/// A token of an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'t> {
    Number(f64),
    Name(&'t str),
    Symbol(char),
}

/// Whether a name is a constant or a function in every expression.
pub fn is_reserved(name: &str) -> bool {
    CONSTANTS.iter().any(|(constant, _)| *constant == name) || function(name).is_some()
}

/// The function with this name, and the number of its arguments.
fn function(name: &str) -> Option<(Step, usize)> {
    let unary = UNARY.iter().find(|(function, _)| *function == name).map(|(_, apply)| (Step::Unary(*apply), 1));
    unary.or_else(|| BINARY.iter().find(|(function, _)| *function == name).map(|(_, apply)| (Step::Binary(*apply), 2)))
}

/// All functions, for messages.
fn functions() -> String {
    let names: Vec<&str> = UNARY.iter().map(|(name, _)| *name).chain(BINARY.iter().map(|(name, _)| *name)).collect();
    names.join(", ")
}

impl Expression {
    /// Parses an expression.
    ///
    /// # Errors
    /// The fault of the text, and the remedy.
    pub fn new(text: &str) -> Result<Self, String> {
        if text.len() > LONGEST_EXPRESSION {
            return Err(format!(
                "the expression has {} bytes, but at most {LONGEST_EXPRESSION} are allowed: move parts of the \
                    expression into named parameters",
                text.len()
            ));
        }
        let mut reader = Reader { tokens: tokens(text)?, at: 0, open: 0, names: Vec::new(), steps: Vec::new() };
        if reader.tokens.is_empty() {
            return Err("the text is empty: write a number, or an expression such as \"2 * crank.length\"".to_owned());
        }
        reader.terms(0)?;
        if reader.peek().is_some() {
            return Err(reader.misplaced());
        }
        Ok(Self { text: text.to_owned(), names: reader.names, steps: reader.steps })
    }

    /// The original text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Names in the expression, each once.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether the expression contains this name, constant or function.
    pub fn reads(&self, word: &str) -> bool {
        tokens(&self.text).is_ok_and(|tokens| tokens.contains(&Token::Name(word)))
    }

    /// Value of the expression. `value` returns the value of a name by its index. The result is NaN or infinite where
    /// the expression is undefined.
    pub fn evaluate(&self, value: impl Fn(usize) -> f64) -> f64 {
        let mut values = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let found = match *step {
                Step::Number(number) => Some(number),
                Step::Name(index) => Some(value(index)),
                Step::Unary(apply) => values.pop().map(apply),
                Step::Binary(apply) => values.pop().and_then(|b| values.pop().map(|a| apply(a, b))),
            };
            values.extend(found);
        }
        values.pop().unwrap_or(f64::NAN)
    }
}

/// Splits a number from a text that looks like a unit: `160 kg`.
pub fn number_with_unit(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let ends = (1..text.len()).rev().filter(|&end| text.is_char_boundary(end));
    let (number, unit) =
        ends.map(|end| text.split_at(end)).find(|(number, _)| number.trim_end().parse::<f64>().is_ok())?;
    let is_part = |c: char| c.is_alphanumeric() || "./^\u{b0}\u{b2}\u{b3}\u{b7}".contains(c);
    let unit = unit.trim_start();
    let is_unit =
        unit == "%" || unit.starts_with(|c: char| c.is_alphabetic() || c == '\u{b0}') && unit.chars().all(is_part);
    // Names of units are short. A name in the file may have any length.
    let is_short = unit.split(|c: char| !c.is_alphabetic()).all(|word| word.len() <= 4 || word.starts_with("deg"));
    (is_unit && is_short && CONSTANTS.iter().all(|(name, _)| *name != unit)).then(|| (number.trim_end(), unit))
}

/// Reads the tokens of an expression from left to right and writes its steps.
struct Reader<'t> {
    tokens: Vec<Token<'t>>,
    /// Index of the next token.
    at: usize,
    /// Number of open parentheses.
    open: usize,
    names: Vec<String>,
    steps: Vec<Step>,
}

impl<'t> Reader<'t> {
    fn peek(&self) -> Option<Token<'t>> {
        self.tokens.get(self.at).copied()
    }

    fn is_next(&self, symbol: char) -> bool {
        self.peek() == Some(Token::Symbol(symbol))
    }

    /// Reads a value and the following operators of at least the precedence `least`, with their second operands.
    fn terms(&mut self, least: u8) -> Result<(), String> {
        self.value(least)?;
        while let Some((strength, apply)) = operator(self.peek()).filter(|(strength, _)| *strength >= least) {
            self.at += 1;
            self.terms(strength + 1)?;
            if strength == POWER && self.is_next('^') {
                return Err("two powers follow each other: put one of the two powers in parentheses".to_owned());
            }
            self.steps.push(Step::Binary(apply));
        }
        Ok(())
    }

    /// Reads a value after an operator. `least` is the lowest precedence of operators that belong to the value.
    fn value(&mut self, least: u8) -> Result<(), String> {
        let Some(token) = self.peek() else {
            return Err(if self.open > 0 {
                "`)` is missing"
            } else {
                "the expression ends with an operator: add the last value"
            }
            .to_owned());
        };
        self.at += 1;
        match token {
            Token::Number(number) => self.steps.push(Step::Number(number)),
            Token::Name(name) => return self.named(name),
            Token::Symbol('(') => return self.list("( )", 1),
            Token::Symbol(sign @ ('+' | '-')) if least > POWER => {
                return Err(format!("`{sign}` follows an operator: put the signed value in parentheses"));
            }
            Token::Symbol(sign @ ('+' | '-')) => {
                if let Some(Token::Symbol(second @ ('+' | '-'))) = self.peek() {
                    return Err(format!(
                        "`{second}` follows another sign: write one sign, or put the signed value in parentheses"
                    ));
                }
                self.terms(POWER)?;
                if sign == '-' {
                    self.steps.push(Step::Unary(|x| -x));
                }
            }
            Token::Symbol(symbol) => return Err(format!("a value is missing before `{symbol}`: add the value")),
        }
        Ok(())
    }

    /// Reads a constant, a function call, or a name.
    fn named(&mut self, name: &str) -> Result<(), String> {
        let is_called = self.is_next('(');
        if let Some((function, count)) = function(name) {
            if !is_called {
                return Err(format!("`{name}` is a function: write {name}(...)"));
            }
            self.at += 1;
            self.list(name, count)?;
            self.steps.push(function);
        } else if is_called {
            return Err(format!("`{name}` is not a function: use one of the functions {}", functions()));
        } else if let Some((_, value)) = CONSTANTS.iter().find(|(constant, _)| *constant == name) {
            self.steps.push(Step::Number(*value));
        } else {
            let known = self.names.iter().position(|known| known == name);
            self.steps.push(Step::Name(known.unwrap_or(self.names.len())));
            if known.is_none() {
                self.names.push(name.to_owned());
            }
        }
        Ok(())
    }

    /// Reads the `count` arguments of `of` and the closing parenthesis.
    fn list(&mut self, of: &str, count: usize) -> Result<(), String> {
        self.open += 1;
        if self.open > DEEPEST {
            return Err(format!(
                "more than {DEEPEST} parentheses are open: move parts of the expression into named parameters"
            ));
        }
        self.terms(0)?;
        let mut found = 1;
        while count > 1 && self.is_next(',') {
            self.at += 1;
            self.terms(0)?;
            found += 1;
        }
        if !self.is_next(')') {
            return Err(self.misplaced());
        }
        if found != count {
            return Err(format!("`{of}` needs {count} values: write the values in parentheses, separated by commas"));
        }
        self.at += 1;
        self.open -= 1;
        Ok(())
    }

    /// Message about the next token, which cannot follow a value.
    fn misplaced(&self) -> String {
        match self.peek() {
            None => "`)` is missing".to_owned(),
            Some(Token::Symbol(')')) => "`)` has no matching `(`: remove the parenthesis".to_owned(),
            Some(Token::Symbol(',')) => {
                "`,` separates two values of a function: write decimals with a point, such as 0.5".to_owned()
            }
            Some(token) => format!("an operator is missing before `{}`: add an operator, such as *", shown(token)),
        }
    }
}

/// The tokens of the text.
fn tokens(text: &str) -> Result<Vec<Token<'_>>, String> {
    let bytes = text.as_bytes();
    let (mut tokens, mut at) = (Vec::new(), 0);
    let run = |from: usize, belongs: &dyn Fn(u8) -> bool| {
        bytes[from..].iter().position(|byte| !belongs(*byte)).map_or(bytes.len(), |length| from + length)
    };
    while let Some(&byte) = bytes.get(at) {
        let next = match byte {
            b' ' => at + 1,
            b'0'..=b'9' | b'.' => {
                let mut end = run(at, &|byte| byte.is_ascii_digit() || byte == b'.');
                if matches!(bytes.get(end), Some(b'e' | b'E')) {
                    let signed = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
                    if bytes.get(signed).is_some_and(u8::is_ascii_digit) {
                        end = run(signed, &|byte| byte.is_ascii_digit());
                    }
                }
                let number: Option<f64> = text[at..end].parse().ok();
                let number = number.filter(|number| number.is_finite());
                let number = number
                    .ok_or_else(|| format!("`{}` is not a finite number: correct this number", &text[at..end]))?;
                tokens.push(Token::Number(number));
                end
            }
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                let end = run(at, &|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'.');
                tokens.push(Token::Name(&text[at..end]));
                end
            }
            b'+' | b'-' | b'*' | b'/' | b'^' | b'(' | b')' | b',' => {
                tokens.push(Token::Symbol(char::from(byte)));
                at + 1
            }
            _ => {
                let letter = text[at..].chars().next().unwrap_or_default().escape_debug();
                return Err(format!(
                    "`{letter}` is not allowed in an expression: use names, numbers, + - * / ^ ( ) and the \
                     functions {}",
                    functions()
                ));
            }
        };
        at = next;
    }
    Ok(tokens)
}

fn shown(token: Token) -> String {
    match token {
        Token::Number(number) => number.to_string(),
        Token::Name(name) => name.to_owned(),
        Token::Symbol(symbol) => symbol.to_string(),
    }
}

#[cfg(test)]
mod tests;
