//! Expressions in the place of numbers: arithmetic of names, numbers and functions, by the crate exmex.
//!
//! In: the text of an expression, then values of its names. Out: its value. What is handed to exmex has variables `{0}`,
//! `{1}`, ... in the place of names and numbers and no signs, so that the usual precedence holds: -x^2 is -(x^2), of equal
//! operators the left one comes first. It must not know what the names mean.
use exmex::{BinOp, Express, FlatEx, MakeOperators, Operator};
use std::collections::HashMap;
use std::f64::consts::{E, PI};

/// Most bytes of an expression.
pub const LONGEST_EXPRESSION: usize = 1000;
/// Most parentheses that are open at one place of an expression.
const DEEPEST: usize = 30;
/// Constants by name.
const CONSTANTS: [(&str, f64); 2] = [("pi", PI), ("e", E)];
/// Sign of what follows, as an operator between 0 and it: below a power, above a product.
const SIGN: &str = "~";

/// An expression, read.
#[derive(Clone, Debug)]
pub struct Expression {
    text: String,
    program: FlatEx<f64, Functions>,
    /// Names that the expression reads, each once.
    names: Vec<String>,
    /// Of each variable of the program, in exmex's order: a number, or the index of a name.
    variables: Vec<Operand>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Operand {
    Number(f64),
    Name(usize),
}

/// Operators and functions of expressions.
#[derive(Clone, Debug)]
struct Functions;

/// A function of one argument with its name, and one of two.
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
/// Functions of two arguments. Of the smaller and the larger of two numbers neither hides one that is none.
const BINARY: [Binary; 4] = [
    ("atan2", f64::atan2),
    ("hypot", f64::hypot),
    ("min", |a, b| if a.is_nan() || a < b { a } else { b }),
    ("max", |a, b| if a.is_nan() || a > b { a } else { b }),
];

impl MakeOperators<f64> for Functions {
    fn make<'a>() -> Vec<Operator<'a, f64>> {
        // No operator is called commutative: terms are taken from left to right.
        let binary = |name, apply, prio| Operator::make_bin(name, BinOp { apply, prio, is_commutative: false });
        let operators: [(Binary, i64); 6] = [
            (("+", |a, b| a + b), 0),
            (("-", |a, b| a - b), 0),
            (("*", |a, b| a * b), 1),
            (("/", |a, b| a / b), 1),
            ((SIGN, |_, b| -b), 2),
            (("^", power), 3),
        ];
        let operators = operators.into_iter().map(|((name, apply), prio)| binary(name, apply, prio));
        let functions = BINARY.into_iter().map(|(name, apply)| binary(name, apply, 4));
        operators.chain(functions).chain(UNARY.map(|(name, apply)| Operator::make_unary(name, apply))).collect()
    }
}

/// A power; small whole ones by multiplication, as they would be written out.
fn power(base: f64, exponent: f64) -> f64 {
    match exponent {
        2.0 => base * base,
        3.0 => base * base * base,
        _ => base.powf(exponent),
    }
}

/// What stands in an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'t> {
    Number(f64),
    Name(&'t str),
    Symbol(char),
}

/// Whether a name means a constant or a function in every expression.
pub fn is_reserved(name: &str) -> bool {
    CONSTANTS.iter().any(|(constant, _)| *constant == name) || is_function(name)
}

fn is_function(name: &str) -> bool {
    UNARY.iter().any(|(function, _)| *function == name) || is_binary(name)
}

fn is_binary(name: &str) -> bool {
    BINARY.iter().any(|(function, _)| *function == name)
}

/// All functions, for messages.
fn functions() -> String {
    let names: Vec<&str> = UNARY.iter().map(|(name, _)| *name).chain(BINARY.iter().map(|(name, _)| *name)).collect();
    names.join(", ")
}

impl Expression {
    /// Read an expression.
    ///
    /// # Errors
    /// What is wrong with the text, and the remedy.
    pub fn new(text: &str) -> Result<Self, String> {
        if text.len() > LONGEST_EXPRESSION {
            return Err(format!(
                "it has {} bytes, and an expression at most {LONGEST_EXPRESSION}: split it by parameters of its own",
                text.len()
            ));
        }
        let tokens = tokens(text)?;
        check(&tokens)?;
        let mut operands: Vec<Operand> = Vec::new();
        let mut names: Vec<String> = Vec::new();
        let mut indices: HashMap<&str, usize> = HashMap::new();
        let mut written = String::new();
        let mut operand = |written: &mut String, operand| {
            written.push_str(&format!("{{{}}}", operands.len()));
            operands.push(operand);
        };
        // Of each open parenthesis the function of two arguments before it, which is written between these.
        let mut open: Vec<Option<&str>> = Vec::new();
        for (at, token) in tokens.iter().enumerate() {
            let before = at.checked_sub(1).map(|i| tokens[i]);
            match *token {
                Token::Number(number) => operand(&mut written, Operand::Number(number)),
                Token::Symbol(sign @ ('+' | '-')) if !ends_operand(before) => {
                    if sign == '-' {
                        operand(&mut written, Operand::Number(0.0));
                        written.push_str(SIGN);
                    }
                }
                Token::Symbol('(') => {
                    open.push(match before {
                        Some(Token::Name(name)) if is_binary(name) => Some(name),
                        _ => None,
                    });
                    written.push_str(if open.last().is_some_and(Option::is_some) { "((" } else { "(" });
                }
                Token::Symbol(',') => {
                    let function = open.last().copied().flatten().unwrap_or_default();
                    written.extend([") ", function, " ("]);
                }
                Token::Symbol(')') => written.push_str(if open.pop().flatten().is_some() { "))" } else { ")" }),
                Token::Symbol(symbol) => written.push(symbol),
                Token::Name(name) if is_binary(name) => {}
                Token::Name(name) if is_function(name) => written.push_str(name),
                Token::Name(name) => match CONSTANTS.iter().find(|(constant, _)| *constant == name) {
                    Some((_, value)) => operand(&mut written, Operand::Number(*value)),
                    None => {
                        let index = *indices.entry(name).or_insert_with(|| {
                            names.push(name.to_owned());
                            names.len() - 1
                        });
                        operand(&mut written, Operand::Name(index));
                    }
                },
            }
        }
        let unreadable = |error: exmex::ExError| format!("it cannot be read: {error}");
        let program = FlatEx::<f64, Functions>::parse(&written).map_err(unreadable)?;
        let own =
            |name: &String| name.trim_matches(['{', '}']).parse().ok().and_then(|i: usize| operands.get(i)).copied();
        let variables = program.var_names().iter().map(own).collect::<Option<Vec<_>>>();
        let variables = variables.ok_or_else(|| "it cannot be read".to_owned())?;
        Ok(Self { text: text.to_owned(), program, names, variables })
    }

    /// The text as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Names that the expression reads, each once.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether this name, constant or function stands in the expression.
    pub fn reads(&self, word: &str) -> bool {
        tokens(&self.text).is_ok_and(|tokens| tokens.contains(&Token::Name(word)))
    }

    /// Value of the expression with `value` of each name, by its index; NaN or infinite where it has none.
    pub fn evaluate(&self, value: impl Fn(usize) -> f64) -> f64 {
        let operands = self.variables.iter().map(|operand| match operand {
            Operand::Number(number) => *number,
            Operand::Name(index) => value(*index),
        });
        self.program.eval_vec(operands.collect()).unwrap_or(f64::NAN)
    }
}

/// A number and what follows it, if that looks like a unit: `160 kg`.
pub fn number_with_unit(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let ends = (1..text.len()).rev().filter(|&end| text.is_char_boundary(end));
    let (number, unit) =
        ends.map(|end| text.split_at(end)).find(|(number, _)| number.trim_end().parse::<f64>().is_ok())?;
    let is_part = |c: char| c.is_alphanumeric() || "./^\u{b0}\u{b2}\u{b3}\u{b7}".contains(c);
    let unit = unit.trim_start();
    let is_unit = unit.starts_with(|c: char| c.is_alphabetic() || c == '\u{b0}') && unit.chars().all(is_part);
    // Names of units are short; a name of the file may be of any length.
    let is_short = unit.split(|c: char| !c.is_alphabetic()).all(|word| word.len() <= 4 || word.starts_with("deg"));
    (is_unit && is_short && CONSTANTS.iter().all(|(name, _)| *name != unit)).then(|| (number.trim_end(), unit))
}

/// Whether an operand ends with this token, so that what follows stands behind it.
fn ends_operand(token: Option<Token>) -> bool {
    matches!(token, Some(Token::Number(_) | Token::Name(_) | Token::Symbol(')')))
}

/// The text in pieces.
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
                let number = number.ok_or_else(|| format!("`{}` is no finite number", &text[at..end]))?;
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
                    "`{letter}` has no meaning in it: it is made of names, numbers, + - * / ^ ( ) and the functions {}",
                    functions()
                ));
            }
        };
        at = next;
    }
    Ok(tokens)
}

/// Refuse what cannot be read, or what could be read in two ways.
fn check(tokens: &[Token]) -> Result<(), String> {
    // Of each open parenthesis the function before it, its number of commas, and whether the last operator is a power.
    let mut open: Vec<(Option<&str>, usize, bool)> = vec![(None, 0, false)];
    let mut before: Option<Token> = None;
    for &token in tokens {
        let is_after = ends_operand(before);
        let function = match before {
            Some(Token::Name(name)) if is_function(name) => Some(name),
            _ => None,
        };
        if let (Some(name), false) = (function, token == Token::Symbol('(')) {
            return Err(format!("`{name}` is a function: write {name}(...)"));
        }
        let deepest = open.len() - 1;
        let (of, commas, is_power) = &mut open[deepest];
        match token {
            Token::Number(_) | Token::Name(_) if is_after => {
                return Err(format!("an operator is missing before `{}`", shown(token)));
            }
            Token::Number(_) | Token::Name(_) => {}
            Token::Symbol('(') => {
                if is_after && function.is_none() {
                    return Err(match before {
                        Some(Token::Name(name)) => format!("`{name}` is no function: there are {}", functions()),
                        _ => "an operator is missing before `(`".to_owned(),
                    });
                }
                open.push((function, 0, false));
                if open.len() > DEEPEST + 1 {
                    return Err(format!(
                        "more than {DEEPEST} parentheses are open at one place: split it by parameters of its own"
                    ));
                }
            }
            Token::Symbol(symbol @ (')' | ',')) if !is_after => {
                return Err(format!("a value is missing before `{symbol}`"));
            }
            Token::Symbol(')') => {
                let (of, commas) = (*of, *commas);
                if deepest == 0 {
                    return Err("`)` closes nothing: remove it".to_owned());
                }
                let wanted = usize::from(of.is_some_and(is_binary));
                if commas != wanted {
                    let name = of.unwrap_or("( )");
                    return Err(format!("`{name}` takes {} value{}", wanted + 1, if wanted == 0 { "" } else { "s" }));
                }
                open.pop();
            }
            Token::Symbol(',') => {
                if !of.is_some_and(is_binary) {
                    return Err("decimals are written with a point, such as 0.5: `,` separates two values".to_owned());
                }
                (*commas, *is_power) = (*commas + 1, false);
            }
            Token::Symbol('^') if is_after && *is_power => {
                return Err("a power of a power: put one of the two in parentheses".to_owned());
            }
            Token::Symbol(sign @ ('+' | '-')) if !is_after => {
                match before {
                    Some(Token::Symbol('^')) => {
                        return Err(format!("`{sign}` after an operator: put what it changes in parentheses"));
                    }
                    Some(Token::Symbol('~')) => {
                        return Err(format!(
                            "`{sign}` after a sign: write one sign for the two, or put what the first one changes in parentheses"
                        ));
                    }
                    _ => {}
                }
                before = Some(Token::Symbol('~'));
                *is_power = false;
                continue;
            }
            Token::Symbol(symbol) if !is_after => return Err(format!("a value is missing before `{symbol}`")),
            Token::Symbol(symbol) => *is_power = symbol == '^',
        }
        before = Some(token);
    }
    if open.len() > 1 {
        return Err("`)` is missing".to_owned());
    }
    match before {
        None => Err("it is empty: write a number, or an expression such as \"2 * crank.length\"".to_owned()),
        Some(Token::Name(name)) if is_function(name) => Err(format!("`{name}` is a function: write {name}(...)")),
        last if !ends_operand(last) => Err("it ends before its last value".to_owned()),
        _ => Ok(()),
    }
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
