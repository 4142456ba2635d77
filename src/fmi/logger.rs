//! Messages to the host, by categories.
//!
//! In: lines of text with a verdict. Out: calls of the version's sink, which knows the host's logger. The list of
//! categories is also what `modelDescription.xml` declares.
//!
//! FMI 2.0.5, 2.1.3, has the logger called for every failed call, while `loggingOn` switches debug logging. So failed
//! calls are reported even with `loggingOn` = false, at instantiation and in `SetDebugLogging`. Only a host that names
//! categories gets exactly these.

use super::refusal::{Refusal, Verdict};
use crate::format::on_one_line;
use std::ffi::{CStr, CString};

/// The log categories of the FMU, name and description, in the order of the XML. The category of a verdict is at its
/// index; `logAll` stands for all others.
pub const LOG_CATEGORIES: [(&CStr, &str); 6] = [
    (c"logEvents", "Changes of mode, where the mechanism was read, and what the integration cost"),
    (c"logStatusWarning", "Calls that were accepted although something about them is unusual"),
    (c"logStatusDiscard", "Questions of the host that have no answer, and steps made in part"),
    (c"logStatusError", "Calls that were refused or failed, and why"),
    (c"logStatusFatal", "Faults inside the FMU; the instance is lost"),
    (c"logAll", "All messages"),
];

const fn bit(verdict: Verdict) -> u8 {
    1 << verdict as u8
}

const ALL: u8 = (1 << (LOG_CATEGORIES.len() - 1)) - 1;
const FAILURES: u8 = bit(Verdict::Discard) | bit(Verdict::Error) | bit(Verdict::Fatal);

/// Calls the host's logger with a verdict, its category and a message on one line.
pub(crate) type Sink = Box<dyn Fn(Verdict, &CStr, &CStr)>;

/// Where messages go, and the categories that are on.
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

    /// Report a message under the category of the verdict, on one line: a control character inside the text, as a path
    /// may hold it, is made visible.
    pub fn log(&self, verdict: Verdict, message: &str) {
        let (Some(sink), true) = (&self.sink, self.is_on(verdict)) else { return };
        if let Ok(message) = CString::new(on_one_line(message)) {
            sink(verdict, LOG_CATEGORIES[verdict as usize].0, &message);
        }
    }

    /// Report an event; the text is only made if the category is on.
    pub fn event(&self, message: impl FnOnce() -> String) {
        if self.sink.is_some() && self.is_on(Verdict::Ok) {
            self.log(Verdict::Ok, &message());
        }
    }

    /// Switch the given categories: `on` leaves exactly these on; off leaves the others as they were. Without a
    /// category, everything is on, or only failures, as after instantiation.
    ///
    /// # Errors
    /// A name that [`LOG_CATEGORIES`] does not hold; nothing is changed then.
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
        self.enabled & bit(verdict) != 0
    }
}

/// Categories that are on if the host names none.
fn unnamed(logging_on: bool) -> u8 {
    if logging_on { ALL } else { FAILURES }
}

fn bits(category: &CStr) -> Result<u8, Refusal> {
    match LOG_CATEGORIES.iter().position(|(name, _)| *name == category) {
        Some(index) if index == LOG_CATEGORIES.len() - 1 => Ok(ALL),
        Some(index) => Ok(1 << index),
        None => Err(Refusal::error(format!(
            "unknown log category '{}'; known are {}",
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
        assert!(!logger.is_on(Verdict::Ok) && !logger.is_on(Verdict::Warning));
    }

    #[test]
    fn categories_are_switched_as_asked() {
        let mut logger = logger(true);
        set(&mut logger, true, &[c"logEvents", c"logStatusWarning"]).unwrap();
        assert_eq!(logger.enabled, bit(Verdict::Ok) | bit(Verdict::Warning));
        set(&mut logger, false, &[c"logEvents"]).unwrap();
        assert_eq!(logger.enabled, bit(Verdict::Warning));
        set(&mut logger, true, &[c"logAll"]).unwrap();
        assert_eq!(logger.enabled, ALL);
        set(&mut logger, false, &[c"logAll"]).unwrap();
        assert_eq!(logger.enabled, 0);
        set(&mut logger, false, &[]).unwrap();
        assert_eq!(logger.enabled, self::logger(false).enabled);
        set(&mut logger, true, &[]).unwrap();
        assert_eq!(logger.enabled, ALL);
    }

    #[test]
    fn an_unknown_or_missing_category_changes_nothing() {
        let mut logger = logger(false);
        let refusal = set(&mut logger, true, &[c"logEvents", c"logEverything"]).unwrap_err();
        assert!(refusal.message.contains("logEverything"));
        assert!(logger.set_debug_logging(true, [None].into_iter()).is_err());
        assert_eq!(logger.enabled, FAILURES);
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
