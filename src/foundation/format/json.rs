//! JSON as a tree whose nodes have their places in the text.
//!
//! In: a text. Out: its values in the order of the text, each with its range of bytes, or the place of the first fault
//! of JSON. Must not know: what keys mean.
use super::fault::{DefinitionError, Fault, Place};
use std::ops::Range;

/// Largest depth of nested brackets.
const DEEPEST: usize = 128;

/// A value with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Range of bytes in the text.
    pub span: Range<usize>,
    /// The value.
    pub json: Json,
}

/// A value of JSON.
#[derive(Clone, Debug, PartialEq)]
pub enum Json {
    /// null.
    Null,
    /// true or false.
    Flag(bool),
    /// A number. Infinite if the number in the text is too large for a double.
    Number(f64),
    /// A text.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// An object: its members in the order of the text, including members with equal names.
    Object(Vec<Member>),
}

/// A member of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// The key.
    pub key: String,
    /// Range of bytes of the key with its quotes.
    pub span: Range<usize>,
    /// The value.
    pub value: Node,
}

impl Node {
    /// The member of an object with this key. Of several members, the last one.
    pub fn member(&self, key: &str) -> Option<&Member> {
        match &self.json {
            Json::Object(members) => members.iter().rev().find(|member| member.key == key),
            _ => None,
        }
    }

    /// The text, if the value is a text.
    pub fn text(&self) -> Option<&str> {
        if let Json::Text(text) = &self.json { Some(text) } else { None }
    }
}

/// Parses a text. A byte order mark at the start is skipped. `kind`: word for the message if the fault is not in a key.
///
/// # Errors
/// The text is not valid JSON: path of the key with the fault, place and remedy.
pub fn parse(kind: &str, text: &str) -> Result<Node, DefinitionError> {
    let start = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let mut parser = Parser { text, at: start, depth: 0 };
    parser.skip_blanks();
    let read = parser.value().and_then(|node| match parser.peek() {
        None => Ok(node),
        Some(_) => Err(parser.fault(
            "the definition ends before this place: remove the text after the end, or a surplus closing bracket \
             before this place",
        )),
    });
    read.map_err(|Stop { at, message, path }| {
        let end = at + text.get(at..).and_then(|rest| rest.chars().next()).map_or(0, char::len_utf8);
        let path = path.strip_prefix('.').map_or(path.clone(), str::to_owned);
        // The end of a text that is too short belongs to no key.
        let path = if path.is_empty() || at == text.len() { format!("not a valid {kind}") } else { path };
        DefinitionError::new(path, Fault::Syntax(message)).at(Place::new(text, at..end))
    })
}

/// Reason and place of a fault of JSON.
struct Stop {
    at: usize,
    message: String,
    /// Path of the value. Each part has its dot or brackets.
    path: String,
}

impl Stop {
    /// Adds a part of a list or an object to the path of the fault.
    fn inside(mut self, part: std::fmt::Arguments) -> Self {
        self.path = format!("{part}{}", self.path);
        self
    }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
}

impl Parser<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn skip_blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    /// Skips this character and the following blanks. Returns whether the character was found.
    fn accept(&mut self, character: u8) -> bool {
        let is_there = self.peek() == Some(character);
        if is_there {
            self.at += 1;
            self.skip_blanks();
        }
        is_there
    }

    /// The fault at the present place. The message depends on the text at this place.
    #[cold]
    fn fault(&self, message: &str) -> Stop {
        let (at, bytes) = (self.at, self.text.as_bytes());
        let rest = &bytes[at.min(bytes.len())..];
        let starts = |word: &str| rest.get(..word.len()).is_some_and(|part| part.eq_ignore_ascii_case(word.as_bytes()));
        let is_digit = |at: Option<usize>| at.and_then(|at| bytes.get(at)).is_some_and(u8::is_ascii_digit);
        let comma =
            bytes[..at].iter().rposition(|byte| !byte.is_ascii_whitespace()).filter(|last| bytes[*last] == b',');
        let message = if self.text.trim_start_matches('\u{feff}').trim().is_empty() {
            "the file is empty; write a definition as one object { \"name\": ... }"
        } else if rest.is_empty() {
            "the text ends before its last closing bracket: check that the file is complete"
        } else if ["//", "/*", "#"].into_iter().any(starts) {
            "JSON has no comments: remove the comment"
        } else if ["nan", "inf", "-inf"].into_iter().any(starts) {
            "JSON has no NaN and no infinity: write a finite number, or leave the key out"
        } else if is_digit(Some(at)) && comma == at.checked_sub(1) && is_digit(at.checked_sub(2)) {
            "write decimals with a point, such as 0.5"
        } else if comma.is_some() && matches!(rest[0], b'}' | b']') {
            "a comma stands before the closing bracket: remove the comma"
        } else {
            message
        };
        Stop { at, message: message.to_owned(), path: String::new() }
    }

    /// Reads a value and the following blanks.
    fn value(&mut self) -> Result<Node, Stop> {
        let start = self.at;
        let json = match self.peek() {
            Some(b'{') => self.nested(Self::object)?,
            Some(b'[') => self.nested(Self::list)?,
            Some(b'"') => Json::Text(self.text()?),
            Some(b'-' | b'0'..=b'9') => Json::Number(self.number()?),
            _ => {
                let words = [("true", Json::Flag(true)), ("false", Json::Flag(false)), ("null", Json::Null)];
                let found = words.into_iter().find(|(word, _)| self.text[start..].starts_with(word));
                let (word, json) = found.ok_or_else(|| self.fault("a value is missing here: add the value"))?;
                self.at += word.len();
                json
            }
        };
        let span = start..self.at;
        self.skip_blanks();
        Ok(Node { span, json })
    }

    fn nested(&mut self, read: fn(&mut Self) -> Result<Json, Stop>) -> Result<Json, Stop> {
        if self.depth == DEEPEST {
            return Err(self.fault(
                "more than 128 brackets are nested, but a definition needs only a few levels: \
                remove brackets",
            ));
        }
        self.at += 1;
        self.depth += 1;
        self.skip_blanks();
        let json = read(self)?;
        self.depth -= 1;
        Ok(json)
    }

    /// Reads an object from the place after its opening bracket.
    fn object(&mut self) -> Result<Json, Stop> {
        let mut members = Vec::new();
        while self.peek() != Some(b'}') || !members.is_empty() {
            let start = self.at;
            if self.peek() != Some(b'"') {
                return Err(self.fault("a key in double quotes is missing here: add the key"));
            }
            let key = self.text()?;
            let span = start..self.at;
            self.skip_blanks();
            if !self.accept(b':') {
                return Err(self.fault("a colon is missing before this place: add :").inside(format_args!(".{key}")));
            }
            let value = self.value().map_err(|stop| stop.inside(format_args!(".{key}")))?;
            members.push(Member { key, span, value });
            if self.peek() == Some(b'}') {
                break;
            }
            if !self.accept(b',') {
                return Err(self.fault("a comma is missing before this place: add a comma"));
            }
        }
        self.at += 1;
        Ok(Json::Object(members))
    }

    /// Reads a list from the place after its opening bracket.
    fn list(&mut self) -> Result<Json, Stop> {
        let mut nodes = Vec::new();
        while self.peek() != Some(b']') || !nodes.is_empty() {
            let index = nodes.len();
            nodes.push(self.value().map_err(|stop| stop.inside(format_args!("[{index}]")))?);
            if self.peek() == Some(b']') {
                break;
            }
            if !self.accept(b',') {
                return Err(self.fault("a comma is missing before this place: add a comma"));
            }
        }
        self.at += 1;
        Ok(Json::List(nodes))
    }

    /// Reads a text from its opening quote to its closing quote.
    fn text(&mut self) -> Result<String, Stop> {
        let mut text = String::new();
        self.at += 1;
        loop {
            let rest = &self.text[self.at..];
            let length = rest.find(|c: char| c < ' ' || c == '"' || c == '\\').unwrap_or(rest.len());
            text.push_str(&rest[..length]);
            self.at += length;
            match self.peek() {
                Some(b'"') => {
                    self.at += 1;
                    return Ok(text);
                }
                Some(b'\\') => text.push(self.escaped()?),
                _ => {
                    return Err(self.fault("a text has no closing quote: add a quote \" at the end of the text"));
                }
            }
        }
    }

    /// Reads an escape sequence from its backslash.
    fn escaped(&mut self) -> Result<char, Stop> {
        const NONE: &str = "JSON has no such escape sequence: write \\\\ for a backslash";
        let letter = self.text.as_bytes().get(self.at + 1).copied();
        let character = match letter {
            Some(b'u') => {
                let first = self.unit(NONE)?;
                let code = match first {
                    // Surrogate pair of a character above U+FFFF.
                    0xd800..0xdc00 if self.text[self.at..].starts_with("\\u") => match self.unit(NONE)? {
                        second @ 0xdc00..0xe000 => 0x1_0000 + ((first - 0xd800) << 10) + (second - 0xdc00),
                        _ => first,
                    },
                    _ => first,
                };
                return char::from_u32(code).ok_or_else(|| self.fault(NONE));
            }
            Some(b'b') => '\u{8}',
            Some(b'f') => '\u{c}',
            Some(b'n') => '\n',
            Some(b'r') => '\r',
            Some(b't') => '\t',
            Some(letter @ (b'"' | b'\\' | b'/')) => char::from(letter),
            _ => return Err(self.fault(NONE)),
        };
        self.at += 2;
        Ok(character)
    }

    /// Reads four hexadecimal digits after `\u`.
    fn unit(&mut self, message: &str) -> Result<u32, Stop> {
        let digits = self.text.get(self.at + 2..self.at + 6).filter(|text| text.bytes().all(|c| c.is_ascii_hexdigit()));
        let unit = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok()).ok_or_else(|| self.fault(message))?;
        self.at += 6;
        Ok(unit)
    }

    /// Reads a number.
    fn number(&mut self) -> Result<f64, Stop> {
        let start = self.at;
        self.at += usize::from(self.peek() == Some(b'-'));
        let has_leading_zero = self.peek() == Some(b'0');
        let whole = self.digits()?;
        if has_leading_zero && whole > 1 {
            self.at = start;
            return Err(self.fault("a number starts with a zero that is followed by a digit: remove the zero"));
        }
        if self.peek() == Some(b'.') {
            self.at += 1;
            self.digits()?;
        }
        if let Some(b'e' | b'E') = self.peek() {
            self.at += 1;
            self.at += usize::from(matches!(self.peek(), Some(b'+' | b'-')));
            self.digits()?;
        }
        // Rust accepts every number of JSON.
        self.text[start..self.at].parse().map_err(|_| self.fault("a number is missing here: add the number"))
    }

    /// Skips one or more digits and returns their number.
    fn digits(&mut self) -> Result<usize, Stop> {
        let start = self.at;
        while matches!(self.peek(), Some(b'0'..=b'9')) {
            self.at += 1;
        }
        if self.at == start { Err(self.fault("a digit is missing here: add the digit")) } else { Ok(self.at - start) }
    }
}

#[cfg(test)]
mod tests;
