//! The words of the command line, prepared for clap, which takes values with a sign for options.
//!
//! In: words. Out: the same words, with each negative number joined to the preceding option or name of a start value:
//! `--start-time -1e-3` becomes `--start-time=-1e-3`, `crank.start_angle -45deg` becomes `crank.start_angle=-45deg`.
//! The module must not know any option except `--start-values`. clap accepts neither signed exponents nor units, and an
//! option that accepts any word with a hyphen would accept the next option.

use std::ffi::{OsStr, OsString};

/// The option that takes pairs of a name and a value.
const START_VALUES: &str = "--start-values";
/// The task whose words are passed unchanged.
const BENCH: &str = "bench";

/// The words with which this program was called. The first word is its name.
pub fn given() -> Vec<OsString> {
    joined(std::env::args_os())
}

/// These words with each negative number joined to its option or name. The first word is the name of the program.
pub fn joined(words: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let (mut are_start_values, mut wants_value) = (false, false);
    for word in words {
        if wants_value && is_negative(&word) && joined.get(1).is_none_or(|task| task != BENCH) {
            if let Some(name) = joined.last_mut() {
                name.push("=");
                name.push(word);
            }
            wants_value = false;
            continue;
        }
        let text = word.to_string_lossy();
        if text.starts_with('-') {
            are_start_values = text == START_VALUES;
            wants_value = !are_start_values && text.len() > 2 && text.starts_with("--") && !text.contains('=');
        } else {
            wants_value = are_start_values && !wants_value && !text.contains('=');
        }
        joined.push(word);
    }
    joined
}

/// Whether a word is a negative number, with or without a unit. No option starts with a digit or a point.
fn is_negative(word: &OsStr) -> bool {
    let digits = word.as_encoded_bytes().strip_prefix(b"-");
    digits.is_some_and(|rest| rest.strip_prefix(b".").unwrap_or(rest).first().is_some_and(u8::is_ascii_digit))
}

/// What is wrong with a number that contains commas, and what to write. The number may have a unit. None if the text is
/// no such number.
pub fn comma(text: &str) -> Option<String> {
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.,".contains(c))).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let (whole, rest) = number.split_once(',')?;
    let first = whole.trim_start_matches(['+', '-']);
    let is_decimal = digits(rest) && digits(first);
    let groups = rest.split('.').next().unwrap_or_default();
    let is_grouped = digits(first)
        && first.len() <= 3
        && !first.starts_with('0')
        && groups.split(',').all(|group| digits(group) && group.len() == 3)
        && rest.matches('.').count() <= 1;
    let joined = number.replace(',', "");
    match (is_grouped, is_decimal) {
        (true, true) => {
            let point = format!("{whole}.{rest}");
            let point = point.trim_end_matches('0').trim_end_matches('.');
            Some(format!("is ambiguous; write {joined}{unit}, or {point}{unit} if the comma is a decimal comma"))
        }
        (true, false) => Some(format!("has commas between the digits; write {joined}{unit}")),
        (false, true) => Some(format!("has a decimal comma; write a point: {whole}.{rest}{unit}")),
        (false, false) => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::{comma, joined};
    use crate::{Cli, Task};
    use clap::Parser;
    use std::ffi::OsString;

    fn parsed(line: &str) -> Result<Task, clap::Error> {
        Cli::try_parse_from(joined(line.split(' ').map(OsString::from))).map(|cli| cli.task)
    }

    #[test]
    fn a_comma_has_every_reading_that_it_may_have() {
        for (text, said) in [
            ("0,5", Some("has a decimal comma; write a point: 0.5")),
            ("-12,5 deg", Some("has a decimal comma; write a point: -12.5 deg")),
            ("0,500", Some("has a decimal comma; write a point: 0.500")),
            ("1,5e3", Some("has a decimal comma; write a point: 1.5e3")),
            ("40,000", Some("is ambiguous; write 40000, or 40 if the comma is a decimal comma")),
            ("-1,250 kN", Some("is ambiguous; write -1250 kN, or -1.25 kN if the comma is a decimal comma")),
            ("1,234,567.8", Some("has commas between the digits; write 1234567.8")),
            ("40", None),
            ("a,b", None),
            ("1,", None),
            ("1,2,3", None),
        ] {
            assert_eq!(comma(text).as_deref(), said, "{text}");
        }
    }

    #[test]
    fn start_values_with_a_sign_are_values() {
        let values = "a -45deg b -.5 c -1e-3 d 2 e=-3 f -4.5e1deg g -7";
        let expected = ["a=-45deg", "b=-.5", "c=-1e-3", "d", "2", "e=-3", "f=-4.5e1deg", "g=-7"];
        for task in ["simulate", "view", "linearise"] {
            for line in
                [format!("fmu {task} p --start-values {values}"), format!("fmu {task} --start-values {values} -- p")]
            {
                let (path, start_values) = match parsed(&line) {
                    Ok(Task::Simulate(simulate)) => (simulate.path, simulate.start_values),
                    Ok(Task::View(view)) => (view.path, view.start_values),
                    Ok(Task::Linearise(linearise)) => (linearise.path, linearise.start_values),
                    Ok(_) => panic!("{line}"),
                    Err(error) => panic!("{line}: {error}"),
                };
                assert_eq!((path.to_str(), &start_values[..]), (Some("p"), &expected.map(String::from)[..]), "{line}");
            }
        }
    }

    #[test]
    fn options_after_start_values_are_options() {
        let Ok(Task::Simulate(simulate)) = parsed("fmu simulate p --start-values a -45deg --stop-time 3 --plot 2.png")
        else {
            panic!("refused");
        };
        assert_eq!((&*simulate.start_values, simulate.stop_time), (&["a=-45deg".to_owned()][..], Some(3.0)));
        // A name is no value, and an option is no name.
        assert!(parsed("fmu simulate p --start-values a -x").is_err());
        assert!(parsed("fmu simulate p --start-values --stop-time 3").is_err());
        // Other words stay unchanged.
        let line = "fmu bench attack --seed -5 name -6";
        assert_eq!(joined(line.split(' ').map(OsString::from)).join(" ".as_ref()), line);
    }

    #[test]
    fn times_with_a_sign_are_values() {
        let Ok(Task::Simulate(simulate)) = parsed(
            "fmu simulate p --start-time -1e-3 --stop-time -.5e-3 --output-interval -1e-4 --relative-tolerance -1e-6",
        ) else {
            panic!("refused");
        };
        assert_eq!((simulate.start_time, simulate.stop_time), (-1e-3, Some(-0.5e-3)));
        assert_eq!((simulate.output_interval, simulate.relative_tolerance), (Some(-1e-4), Some(-1e-6)));
        let Ok(Task::View(view)) = parsed("fmu view p --stop-time -1e-3") else { panic!("refused") };
        assert_eq!(view.stop_time, Some(-1e-3));
        // Times have no unit.
        for (text, remedy) in
            [("2s", "write 2 (seconds)"), ("-1.5min", "write -90 (seconds)"), ("2,5", "write a point: 2.5")]
        {
            let error = parsed(&format!("fmu simulate p --stop-time {text}")).err().unwrap().to_string();
            assert!(error.contains(remedy), "{error}");
        }
        assert!(parsed("fmu view p --stop-time soon").err().unwrap().to_string().contains("a number of seconds"));
        for (text, remedy) in [
            ("1%", "write 0.01 (a fraction"),
            ("1e-4 %", "write 0.000001"),
            ("0,01", "write a point: 0.01"),
            ("x", "1e-6"),
        ] {
            let line = ["fmu", "simulate", "p", "--relative-tolerance", text].map(OsString::from);
            let error = Cli::try_parse_from(line).err().unwrap().to_string();
            assert!(error.contains(remedy), "{error}");
        }
        // An option is no value.
        let error = parsed("fmu simulate p --start-time --stop-time 3").err().unwrap().to_string();
        assert!(error.contains("a value is required for '--start-time <S>'"), "{error}");
    }
}
