//! The log line of a call that reads variables without a value.
//!
//! In: the variables of the call, with the reason why each has no value. Out: a warning that names the first variables
//! with their reasons. Must not know: how a value is found.
use super::refusal::Refusal;
use std::fmt::Write;

/// Largest number of variables named for one reason.
const NAMES: usize = 8;
/// Largest number of reasons in the warning.
const REASONS: usize = 3;

/// Variables without a value, by reason.
#[derive(Debug)]
pub struct Undefined {
    /// The kind of number that was read: `value` or `derivative`.
    what: &'static str,
    /// Each reason, with the first names and the number of all its variables.
    reasons: Vec<(String, Vec<String>, usize)>,
    /// Variables with further reasons.
    others: usize,
}

impl Undefined {
    /// An empty list for numbers of the kind `what`.
    pub fn new(what: &'static str) -> Self {
        Self { what, reasons: Vec::new(), others: 0 }
    }

    /// Adds a variable without a value.
    pub fn add(&mut self, name: &str, reason: String) {
        if let Some((_, names, count)) = self.reasons.iter_mut().find(|(other, ..)| *other == reason) {
            *count += 1;
            if names.len() < NAMES {
                names.push(name.to_owned());
            }
        } else if self.reasons.len() < REASONS {
            self.reasons.push((reason, vec![name.to_owned()], 1));
        } else {
            self.others += 1;
        }
    }

    /// The warning. None if all variables have a value.
    pub fn warning(self) -> Option<Refusal> {
        let Self { what, reasons, others } = self;
        let mut line = format!("no {what} exists in this state (NaN is returned) for ");
        for (index, (reason, names, count)) in reasons.iter().enumerate() {
            line.push_str(if index > 0 { "; for " } else { "" });
            line.push_str(&names.join(", "));
            if *count > names.len() {
                let _ = write!(line, " and {} more", count - names.len());
            }
            let _ = write!(line, ": {reason}");
        }
        if others > 0 {
            let _ = write!(line, "; for {others} more variables");
        }
        (!reasons.is_empty()).then(|| Refusal::warning(line))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi::refusal::Verdict;

    #[test]
    fn a_line_names_the_first_variables_of_the_first_reasons() {
        let line = |count: usize, reasons: usize| {
            let mut undefined = Undefined::new("value");
            (0..count).for_each(|i| undefined.add(&format!("x{i}"), format!("reason {}", i % reasons)));
            undefined.warning()
        };
        assert_eq!(line(0, 1), None);
        let one = line(2, 1).unwrap();
        assert_eq!(one.verdict, Verdict::Warning);
        assert_eq!(one.message, "no value exists in this state (NaN is returned) for x0, x1: reason 0");
        assert!(line(11, 1).unwrap().message.ends_with("x6, x7 and 3 more: reason 0"));
        let many = line(5, 5).unwrap().message;
        assert!(many.ends_with("for x0: reason 0; for x1: reason 1; for x2: reason 2; for 2 more variables"), "{many}");
    }
}
