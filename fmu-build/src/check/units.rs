//! Messages in the units of the file.
//!
//! In: messages of the engine in SI units. Out: the messages with lengths and angles in the units of the file.

use linkage_fmu::format::Node;
use linkage_fmu::inspection::Finding;
use linkage_fmu::mechanism::definition::{AngleUnit, LengthUnit};
use linkage_fmu::numerics::decimal::Decimal;

/// A unit of the engine, the unit of the file, and the factor from the first to the second.
#[derive(Clone)]
struct Unit {
    si: &'static str,
    own: &'static str,
    factor: f64,
}

/// The units in which a file states lengths and angles, where these are not SI units.
#[derive(Clone, Default)]
pub struct FileUnits(Vec<Unit>);

impl FileUnits {
    /// The units that the definition states.
    pub fn stated(definition: Option<&Node>) -> Self {
        let units = definition.and_then(|definition| definition.member("units"));
        let states = |key: &str, unit: &str| {
            units.and_then(|units| units.value.member(key)).is_some_and(|stated| stated.value.text() == Some(unit))
        };
        let length = states("length", LengthUnit::Mm.word()).then_some(Unit { si: "m", own: "mm", factor: 1e3 });
        let degree = 180.0 / std::f64::consts::PI;
        let angle = states("angle", AngleUnit::Deg.word()).then_some(Unit { si: "rad", own: "deg", factor: degree });
        Self(length.into_iter().chain(angle).collect())
    }

    /// A finding in the units of the file. Findings about a circuit stay in SI units.
    pub fn converted(&self, mut finding: Finding) -> Finding {
        if !finding.path.contains(".hydraulics") {
            finding.message = self.message(&finding.message);
            finding.remedy = self.message(&finding.remedy);
        }
        finding
    }

    /// The unit in which the file states a quantity, and its factor. None if this is the SI unit.
    pub fn of(&self, si: &str) -> Option<(&'static str, f64)> {
        self.0.iter().find(|unit| unit.si == si).map(|unit| (unit.own, unit.factor))
    }

    /// A number with its unit, to five digits. An angle in a file in radians is written in degrees too.
    pub fn quantity(&self, value: f64, unit: &str) -> String {
        if let Some(own) = self.0.iter().find(|own| own.si == unit) {
            return format!("{} {}", number(value * own.factor), own.own);
        }
        match unit {
            "1" => number(value),
            "rad" => format!("{} rad ({} deg)", number(value), number(value.to_degrees())),
            _ => format!("{} {unit}", number(value)),
        }
    }

    /// The text of a fact, with each angle and each length as in [`Self::quantity`].
    pub fn text(&self, text: &str) -> String {
        let mut out: Vec<String> = Vec::new();
        for word in text.split(' ') {
            let unit = word.trim_end_matches([',', ';', ':']);
            let value = out.last().filter(|_| ["rad", "m"].contains(&unit)).and_then(|last| last.parse().ok());
            match value {
                Some(value) => {
                    out.pop();
                    out.push(self.quantity(value, unit) + &word[unit.len()..]);
                }
                None => out.push(word.to_owned()),
            }
        }
        out.join(" ")
    }

    /// The message with every number and its unit converted to the units of the file.
    pub fn message(&self, message: &str) -> String {
        let mut out = String::with_capacity(message.len());
        let has_degrees = self.0.iter().any(|unit| unit.own == "deg");
        // A user who states degrees does not mean radians.
        let asks =
            message.rfind("; if you mean ").filter(|at| has_degrees && message[*at..].contains(" degrees, write"));
        let kept = asks.map(|at| {
            let end = message[at + 1..].find("; ").map_or(message.len(), |length| at + 1 + length);
            [&message[..at], &message[end..]].concat()
        });
        let mut words = kept.as_deref().unwrap_or(message).split(' ').peekable();
        while let Some(word) = words.next() {
            let unit = words.peek().and_then(|next| self.of_word(next).map(|unit| (unit, *next)));
            let digits = word.trim_start_matches('(');
            match unit.zip(digits.parse::<f64>().ok()) {
                Some(((unit, next), value)) => {
                    let rest = &next[unit.si.len()..];
                    out.push_str(&word[..word.len() - digits.len()]);
                    // One digit less than in the engine's message, because the factor may have changed the last digit.
                    let value = value * unit.factor;
                    let own = Decimal(format!("{value:.8e}").parse().unwrap_or(value));
                    out.push_str(&format!("{own} {}{rest}", unit.own));
                    words.next();
                    // The engine's message also contains degrees after radians.
                    let mut following = words.clone();
                    let again = following.next().is_some_and(|word| unit.own == "deg" && word.starts_with('('));
                    if let Some(rest) = following.next().filter(|_| again).and_then(|word| word.strip_prefix("deg)")) {
                        out.push_str(rest);
                        words = following;
                    }
                }
                None => out.push_str(&self.bracketed(word)),
            }
            if words.peek().is_some() {
                out.push(' ');
            }
        }
        out
    }

    /// The unit in this word, ignoring the signs that follow it.
    fn of_word(&self, word: &str) -> Option<&Unit> {
        let ends = |unit: &&Unit| {
            word.strip_prefix(unit.si)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with([',', ';', ':', ')', ']']) || rest == ".")
        };
        self.0.iter().find(ends)
    }

    /// Convert a unit in brackets, which a message requests.
    fn bracketed(&self, word: &str) -> String {
        let unit = word.strip_prefix('[').and_then(|inner| self.of_word(inner).filter(|_| inner.contains(']')));
        unit.map_or_else(|| word.to_owned(), |unit| word.replacen(unit.si, unit.own, 1))
    }
}

/// Round to five digits.
pub fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        size if (1e-4..1e7).contains(&size) => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use linkage_fmu::format::parse;

    #[test]
    fn facts_are_in_the_units_of_the_file() {
        let [own, si] = [r#"{ "units": { "length": "mm", "angle": "deg" } }"#, "{}"]
            .map(|text| FileUnits::stated(parse("test", text).ok().as_ref()));
        let text = "up at leg = 0.500000 rad, rod = 0.123456 m: held";
        assert_eq!(own.text(text), "up at leg = 28.648 deg, rod = 123.46 mm: held");
        assert_eq!(si.text(text), "up at leg = 0.5 rad (28.648 deg), rod = 0.12346 m: held");
        assert_eq!(own.quantity(2.0, "kg"), "2 kg");
        assert_eq!(si.quantity(0.25, "1"), "0.25");
    }

    #[test]
    fn lengths_and_angles_are_in_the_units_of_the_file() {
        let [text, none] = [r#"{ "units": { "length": "mm", "angle": "deg" } }"#, "{}"]
            .map(|text| FileUnits::stated(parse("test", text).ok().as_ref()));
        for (message, expected) in [
            ("a = 0.5 m: from -0.2 m to 0.4 m, 1.5 m/s", "a = 500 mm: from -200 mm to 400 mm, 1.5 m/s"),
            ("(3.141592653589793 rad; 2 N.m)", "(180 deg; 2 N.m)"),
            ("give its rough angle [rad]", "give its rough angle [deg]"),
            ("1e4 N/m and m alone", "1e4 N/m and m alone"),
            ("at 2 rad (114.591559 deg), 1 m on", "at 114.591559 deg, 1000 mm on"),
            ("at 15.70796327 rad; if you mean 15 degrees, write 0.2 rad", "at 900 deg"),
            (
                "at 2 rad; if you mean 2 degrees, write 0 rad; 0.5 rad is the same",
                "at 114.591559 deg; 28.6478898 deg is the same",
            ),
        ] {
            assert_eq!(text.message(message), expected);
            assert_eq!(none.message(message), message);
        }
    }
}
