//! Messages to the host, by categories.
//!
//! In: lines of text with a verdict. Out: calls of the version's sink, which calls the host's logger.
//! `modelDescription.xml` declares the same list of categories.
//!
//! FMI 2.0.5, 2.1.3: the logger is called for every call that does not return OK. `loggingOn` switches debug logging.
//! Calls that do not return OK are therefore reported even with `loggingOn` = false, at instantiation and in
//! `SetDebugLogging`. If the host names categories, exactly these categories are reported.

use super::refusal::{Refusal, Verdict};
use crate::format::on_one_line;
use std::ffi::{CStr, CString};

/// The log categories of the FMU, name and description, in the order of the XML. A verdict is the index of its
/// category. `logAll` means all categories.
pub const LOG_CATEGORIES: [(&CStr, &str); 7] = [
    (
        c"logEvents",
        "Messages about the start and the end of the run, about impacts, contacts and locks with their times, and \
            about the number of integration steps",
    ),
    (c"logStatusWarning", "Warnings from calls that succeeded, and messages about outputs that have no value"),
    (c"logStatusDiscard", "Messages about requests that the FMU does not support, and about steps that ended early"),
    (c"logStatusError", "Messages about calls that returned an error, with the reason"),
    (
        c"logStatusFatal",
        "Messages about faults inside the FMU, after which the simulation tool can only free the instance",
    ),
    (c"logDebug", "Messages about changes between static and kinetic friction in each joint"),
    (c"logAll", "All messages"),
];

const fn bit(verdict: Verdict) -> u8 {
    1 << verdict as u8
}

/// Index of the category of details.
const DETAILS: usize = LOG_CATEGORIES.len() - 2;
/// Bit of warnings that are the verdict of a call. Warnings of calls that return OK have the bit of the category.
const WARNING_ANSWER: u8 = 1 << (LOG_CATEGORIES.len() - 1);
const ALL: u8 = 2 * WARNING_ANSWER - 1;
/// All verdicts except OK.
const ANSWERS: u8 = WARNING_ANSWER | bit(Verdict::Discard) | bit(Verdict::Error) | bit(Verdict::Fatal);

/// Largest length of a message [bytes], because hosts write messages into buffers of a fixed size.
pub const LONGEST: usize = 1000;

/// Calls the host's logger with a verdict, its category and a message on one line.
pub(crate) type Sink = Box<dyn Fn(Verdict, &CStr, &CStr)>;

/// The sink for messages, and the categories that are on.
pub(crate) struct Logger {
    /// None if the host has no logger.
    sink: Option<Sink>,
    enabled: u8,
}

impl Logger {
    /// Logger of a new instance.
    pub fn new(sink: Option<Sink>, logging_on: bool) -> Self {
        Logger { sink, enabled: unnamed(logging_on) }
    }

    /// Reports the reason of a verdict.
    pub fn log(&self, verdict: Verdict, message: &str) {
        if self.is_on(verdict) {
            self.write(verdict, verdict as usize, message);
        }
    }

    /// Reports something unusual about a call that returns OK.
    pub fn remark(&self, message: &str) {
        if self.enabled & bit(Verdict::Warning) != 0 {
            self.write(Verdict::Warning, Verdict::Warning as usize, message);
        }
    }

    /// Whether events are reported.
    pub fn has_events(&self) -> bool {
        self.sink.is_some() && self.is_on(Verdict::Ok)
    }

    /// Whether details of events are reported.
    pub fn has_details(&self) -> bool {
        self.sink.is_some() && self.enabled & 1 << DETAILS != 0
    }

    /// Reports a detail of an event.
    pub fn detail(&self, message: &str) {
        if self.has_details() {
            self.write(Verdict::Ok, DETAILS, message);
        }
    }

    /// Reports an event. The text is formed only if the category is on.
    pub fn event(&self, message: impl FnOnce() -> String) {
        if self.has_events() {
            self.write(Verdict::Ok, Verdict::Ok as usize, &message());
        }
    }

    /// Passes a message to the sink with this category, as one line of at most [`LONGEST`] bytes. Control characters in
    /// the text, for example in a path, are escaped.
    fn write(&self, verdict: Verdict, category: usize, message: &str) {
        let Some(sink) = &self.sink else { return };
        if let Ok(message) = CString::new(shortened(on_one_line(message))) {
            let category = LOG_CATEGORIES[category].0;
            sink(verdict, category, &message);
        }
    }

    /// Switches categories. `on` = true: exactly the given categories are on. `on` = false: the given categories are
    /// off, the others do not change. Without a category, the categories are those after instantiation with `loggingOn`
    /// = `on`.
    ///
    /// # Errors
    /// A name that is not in [`LOG_CATEGORIES`]; nothing is changed then.
    pub fn set_debug_logging<'a>(
        &mut self,
        on: bool,
        categories: impl ExactSizeIterator<Item = Option<&'a CStr>>,
    ) -> Result<(), Refusal> {
        if categories.len() == 0 {
            self.enabled = unnamed(on);
            return Ok(());
        }
        let mut chosen = 0;
        for category in categories {
            let category = category.ok_or_else(|| Refusal::error("a category is NULL"))?;
            chosen |= bits(category)?;
        }
        self.enabled = if on { chosen } else { self.enabled & !chosen };
        Ok(())
    }

    fn is_on(&self, verdict: Verdict) -> bool {
        let bits = if verdict == Verdict::Warning { WARNING_ANSWER } else { bit(verdict) };
        self.enabled & bits != 0
    }
}

/// A line of at most [`LONGEST`] bytes. In a longer line, the number of omitted bytes replaces the middle.
fn shortened(line: String) -> String {
    /// Bytes kept at the end of the line, which may state the remedy.
    const END: usize = 200;
    /// Largest length of the text that replaces the middle [bytes].
    const MARK: usize = 60;
    if line.len() <= LONGEST {
        return line;
    }
    let boundary = |from: usize| (0..=from).rev().find(|index| line.is_char_boundary(*index)).unwrap_or(0);
    let (first, last) = (boundary(LONGEST - END - MARK), boundary(line.len() - END));
    format!("{} ... ({} bytes omitted) ... {}", &line[..first], last - first, &line[last..])
}

/// Categories that are on if the host names none. Details are off.
fn unnamed(logging_on: bool) -> u8 {
    if logging_on { ALL & !(1 << DETAILS) } else { ANSWERS }
}

fn bits(category: &CStr) -> Result<u8, Refusal> {
    match LOG_CATEGORIES.iter().position(|(name, _)| *name == category) {
        Some(index) if index == LOG_CATEGORIES.len() - 1 => Ok(ALL),
        Some(index) if index == Verdict::Warning as usize => Ok(bit(Verdict::Warning) | WARNING_ANSWER),
        Some(index) => Ok(1 << index),
        None => Err(Refusal::error(format!(
            "there is no log category '{}'; the categories are {}",
            category.to_bytes().escape_ascii(),
            LOG_CATEGORIES.map(|(name, _)| name.to_string_lossy()).join(", ")
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn logger(logging_on: bool) -> Logger {
        Logger::new(None, logging_on)
    }

    fn set(logger: &mut Logger, on: bool, categories: &[&'static CStr]) -> Result<(), Refusal> {
        logger.set_debug_logging(on, categories.iter().map(|c| Some(*c)))
    }

    #[test]
    fn failures_are_on_from_the_start() {
        let logger = logger(false);
        assert!(logger.is_on(Verdict::Error) && logger.is_on(Verdict::Fatal) && logger.is_on(Verdict::Discard));
        assert!(!logger.is_on(Verdict::Ok) && logger.is_on(Verdict::Warning));
        assert_eq!(logger.enabled & bit(Verdict::Warning), 0, "a remark beside OK is debug logging");
    }

    #[test]
    fn categories_are_switched_as_requested() {
        let mut logger = logger(true);
        set(&mut logger, true, &[c"logEvents", c"logStatusWarning"]).unwrap();
        assert_eq!(logger.enabled, bit(Verdict::Ok) | bit(Verdict::Warning) | WARNING_ANSWER);
        set(&mut logger, false, &[c"logEvents"]).unwrap();
        assert_eq!(logger.enabled, bit(Verdict::Warning) | WARNING_ANSWER);
        set(&mut logger, true, &[c"logAll"]).unwrap();
        assert_eq!(logger.enabled, ALL);
        set(&mut logger, false, &[c"logAll"]).unwrap();
        assert_eq!(logger.enabled, 0);
        set(&mut logger, false, &[]).unwrap();
        assert_eq!(logger.enabled, self::logger(false).enabled);
        set(&mut logger, true, &[]).unwrap();
        assert_eq!(logger.enabled, ALL & !(1 << DETAILS));
    }

    #[test]
    fn an_unknown_or_missing_category_changes_nothing() {
        let mut logger = logger(false);
        let refusal = set(&mut logger, true, &[c"logEvents", c"logEverything"]).unwrap_err();
        assert!(refusal.message.contains("logEverything"));
        assert!(logger.set_debug_logging(true, [None].into_iter()).is_err());
        assert_eq!(logger.enabled, ANSWERS);
    }

    #[test]
    fn a_message_has_a_bounded_length() {
        for length in [0, LONGEST - 1, LONGEST, LONGEST + 1, 3 * LONGEST, 1_000_000] {
            let text = format!("{}x", "\u{e4}".repeat(length / 2));
            let line = shortened(text.clone());
            assert!(line.len() <= LONGEST && line.ends_with('x'), "{}", line.len());
            assert!(line == text || (line.len() > LONGEST - 60 && line.contains(" bytes omitted) ")));
        }
    }

    #[test]
    fn each_verdict_has_its_category() {
        for (verdict, name) in [
            (Verdict::Ok, c"logEvents"),
            (Verdict::Warning, c"logStatusWarning"),
            (Verdict::Discard, c"logStatusDiscard"),
            (Verdict::Error, c"logStatusError"),
            (Verdict::Fatal, c"logStatusFatal"),
        ] {
            assert_eq!(LOG_CATEGORIES[verdict as usize].0, name);
        }
    }
}
