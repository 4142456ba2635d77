//! Messages to the host, by categories.
//!
//! In: finished lines of text. Out: calls of the host's printf-style logger. The list of categories is also what
//! `modelDescription.xml` declares.
//!
//! What is on: FMI 2.0.5, 2.1.3, has the logger called for every failed call, and `loggingOn` switch debug logging. So a
//! failed call is reported with `loggingOn` = `fmi2False` too, here and in `fmi2SetDebugLogging`; only a host that names
//! categories gets exactly what it named.

use super::refusal::Refusal;
use super::types::{CallbackFunctions, Environment, LoggerCallback, Status};
use std::ffi::{CStr, CString};

/// Kind of a message; its place in [`LOG_CATEGORIES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// Changes of mode and what they found.
    Events,
    /// Accepted, but noteworthy.
    Warning,
    /// A question without an answer.
    Discard,
    /// A refused or failed call.
    Error,
    /// A fault inside this library.
    Fatal,
}

const NAMES: [&CStr; 6] =
    [c"logEvents", c"logStatusWarning", c"logStatusDiscard", c"logStatusError", c"logStatusFatal", c"logAll"];

/// The log categories of the FMU, name and description, in the order of the XML. `logAll` stands for all others.
pub const LOG_CATEGORIES: [(&str, &str); 6] = [
    (text(NAMES[0]), "Changes of mode, where the mechanism was read, and what the integration cost"),
    (text(NAMES[1]), "Calls that were accepted although something about them is unusual"),
    (text(NAMES[2]), "Questions of the host that have no answer"),
    (text(NAMES[3]), "Calls that were refused or failed, and why"),
    (text(NAMES[4]), "Faults inside the FMU; the instance is lost"),
    (text(NAMES[5]), "All messages"),
];

const fn text(name: &'static CStr) -> &'static str {
    match name.to_str() {
        Ok(text) => text,
        Err(_) => panic!("a category is ASCII"),
    }
}

impl Category {
    const fn bit(self) -> u8 {
        1 << self as u8
    }

    fn of(status: Status) -> Self {
        match status {
            Status::Ok | Status::Pending => Category::Events,
            Status::Warning => Category::Warning,
            Status::Discard => Category::Discard,
            Status::Error => Category::Error,
            Status::Fatal => Category::Fatal,
        }
    }
}

const ALL: u8 = (1 << (NAMES.len() - 1)) - 1;
const FAILURES: u8 = Category::Discard.bit() | Category::Error.bit() | Category::Fatal.bit();

/// The host's logger, the instance's name and the categories that are on.
#[derive(Debug)]
pub struct Logger {
    callback: Option<LoggerCallback>,
    environment: Environment,
    instance_name: CString,
    enabled: u8,
}

impl Logger {
    /// Logger of a new instance. The callbacks are copied, as the host's struct may live on its stack.
    pub fn new(functions: &CallbackFunctions, instance_name: &CStr, logging_on: bool) -> Self {
        Logger {
            callback: functions.logger,
            environment: functions.environment,
            instance_name: instance_name.to_owned(),
            enabled: unnamed(logging_on),
        }
    }

    /// Report something under the category that belongs to the status, on one line: a control character inside the text,
    /// as a path may hold it, is made visible.
    pub fn log(&self, status: Status, message: &str) {
        let category = Category::of(status);
        let (Some(callback), true) = (self.callback, self.is_on(category)) else { return };
        let Ok(message) = CString::new(on_one_line(message)) else { return };
        // SAFETY: FMI 2.0.5, 2.1.5: the host's logger may be called from within any FMI function, with its own
        // environment and printf-style arguments; "%s" takes one string. All strings outlive the call.
        unsafe {
            callback(
                self.environment,
                self.instance_name.as_ptr(),
                status,
                NAMES[category as usize].as_ptr(),
                c"%s".as_ptr(),
                message.as_ptr(),
            );
        }
    }

    /// Report an event; the text is only made if somebody listens.
    pub fn event(&self, message: impl FnOnce() -> String) {
        if self.callback.is_some() && self.is_on(Category::Events) {
            self.log(Status::Ok, &message());
        }
    }

    /// Switch the given categories: on leaves exactly these on, off leaves the others as they were. If none is given,
    /// everything is on, or all but failures off, as after `fmi2Instantiate`.
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

    fn is_on(&self, category: Category) -> bool {
        self.enabled & category.bit() != 0
    }
}

/// What is on if the host names no category.
fn unnamed(logging_on: bool) -> u8 {
    if logging_on { ALL } else { FAILURES }
}

fn on_one_line(message: &str) -> String {
    let mut line = String::with_capacity(message.len());
    for c in message.chars() {
        match c.is_control() {
            true => line.extend(c.escape_default()),
            false => line.push(c),
        }
    }
    line
}

fn bits(category: &CStr) -> Result<u8, Refusal> {
    match NAMES.iter().position(|name| *name == category) {
        Some(place) if place == NAMES.len() - 1 => Ok(ALL),
        Some(place) => Ok(1 << place),
        None => Err(Refusal::error(format!(
            "unknown log category '{}'; known are {}",
            category.to_bytes().escape_ascii(),
            LOG_CATEGORIES.map(|(name, _)| name).join(", ")
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn logger(logging_on: bool) -> Logger {
        let functions = CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: std::ptr::null_mut(),
        };
        Logger::new(&functions, c"test", logging_on)
    }

    fn set(logger: &mut Logger, on: bool, categories: &[&'static CStr]) -> Result<(), Refusal> {
        logger.set_debug_logging(on, categories.iter().map(|c| Some(*c)))
    }

    #[test]
    fn failures_are_on_from_the_start() {
        let logger = logger(false);
        assert!(logger.is_on(Category::Error) && logger.is_on(Category::Fatal) && logger.is_on(Category::Discard));
        assert!(!logger.is_on(Category::Events) && !logger.is_on(Category::Warning));
    }

    #[test]
    fn categories_are_switched_as_asked() {
        let mut logger = logger(true);
        set(&mut logger, true, &[c"logEvents", c"logStatusWarning"]).unwrap();
        assert_eq!(logger.enabled, Category::Events.bit() | Category::Warning.bit());
        set(&mut logger, false, &[c"logEvents"]).unwrap();
        assert_eq!(logger.enabled, Category::Warning.bit());
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
    fn a_message_is_one_line() {
        assert_eq!(on_one_line("räder\0 a\r\nb\u{7f} 'c'"), "räder\\u{0} a\\r\\nb\\u{7f} 'c'");
    }

    #[test]
    fn each_category_has_its_name() {
        for (category, name) in [
            (Category::Events, "logEvents"),
            (Category::Warning, "logStatusWarning"),
            (Category::Discard, "logStatusDiscard"),
            (Category::Error, "logStatusError"),
            (Category::Fatal, "logStatusFatal"),
        ] {
            assert_eq!(LOG_CATEGORIES[category as usize].0, name);
        }
    }
}
