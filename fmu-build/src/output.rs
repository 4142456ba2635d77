//! The output of the commands, through `print!` and similar macros, which replace those of std.
//!
//! In: texts. Out: standard output and standard error. A closed pipe is no error: the text is discarded, and the task
//! is completed. A full disk is an error at the end of the command. Control characters, which could move the cursor of
//! a terminal, are printed as escapes.

use anyhow::{Result, bail};
use std::cell::RefCell;
use std::fmt::{Arguments, Write as _};
use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

/// Reason of the first failure to write to standard output.
static FAILED: OnceLock<String> = OnceLock::new();

/// Like std's `print!`, without a panic.
#[macro_export]
macro_rules! print {
    ($($text:tt)*) => { $crate::output::out(format_args!($($text)*)) };
}

/// Like std's `println!`, without a panic.
#[macro_export]
macro_rules! println {
    ($($text:tt)*) => { $crate::output::out(format_args!("{}\n", format_args!($($text)*))) };
}

/// Like std's `eprint!`, without a panic.
#[macro_export]
macro_rules! eprint {
    ($($text:tt)*) => { $crate::output::error(format_args!($($text)*)) };
}

/// Like std's `eprintln!`, without a panic.
#[macro_export]
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::output::error(format_args!("{}\n", format_args!($($text)*))) };
}

thread_local! {
    /// The output of this thread, while it is collected.
    static COLLECTED: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// The result of a function, and the text that it would have printed on this thread.
pub fn collected<T>(body: impl FnOnce() -> T) -> (T, String) {
    COLLECTED.set(Some(String::new()));
    let answer = body();
    (answer, COLLECTED.take().unwrap_or_default())
}

/// Keep a text if this thread collects its output. Returns whether it does.
fn collect(text: &str) -> bool {
    COLLECTED.with_borrow_mut(|all| all.as_mut().map(|all| all.push_str(text)).is_some())
}

/// Print to standard output.
pub fn out(text: Arguments) {
    let text = plain(text);
    if !collect(&text) {
        note(io::stdout().write_all(text.as_bytes()));
    }
}

/// Print to standard error. Errors are ignored, because there is no other place to report them.
pub fn error(text: Arguments) {
    let text = plain(text);
    if !collect(&text) {
        let _ = io::stderr().write_all(text.as_bytes());
    }
}

/// Check that all printed text was written.
///
/// # Errors
/// Standard output could not be written, except for a pipe that its reader has closed.
pub fn finish() -> Result<()> {
    note(io::stdout().flush());
    match FAILED.get() {
        Some(why) => bail!("standard output cannot be written: {why}; free disk space, or redirect the output"),
        None => Ok(()),
    }
}

fn note(written: io::Result<()>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        let _ = FAILED.set(error.to_string());
    }
}

/// The text with its control characters as escapes, except line ends and tabs.
fn plain(text: Arguments) -> String {
    let text = text.to_string();
    let is_hidden = |c: char| c.is_control() && c != '\n' && c != '\t';
    if !text.contains(is_hidden) {
        return text;
    }
    text.chars().fold(String::new(), |mut shown, c| {
        let _ = if is_hidden(c) { write!(shown, "{}", c.escape_debug()) } else { shown.write_char(c) };
        shown
    })
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn control_characters_are_escapes() {
        assert_eq!(plain(format_args!("a\u{1b}[31m\t{}\n", "b\r\u{9b}\u{7f}")), "a\\u{1b}[31m\tb\\r\\u{9b}\\u{7f}\n");
    }
}
