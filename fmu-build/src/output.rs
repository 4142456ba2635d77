//! What the commands print, through `print!` and its like, which stand here in the place of those of std.
//!
//! In: texts. Out: standard output and standard error. A closed pipe takes no more text and is no fault, so that a task
//! is done whole whoever reads of it; a full disk fails the command at its end. Control characters, which could move
//! the cursor of a terminal, are printed as escapes.

use anyhow::{Result, bail};
use std::cell::RefCell;
use std::fmt::{Arguments, Write as _};
use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

/// Why standard output could not be written, the first time.
static FAILED: OnceLock<String> = OnceLock::new();

/// As std's `print!`, without a panic.
#[macro_export]
macro_rules! print {
    ($($text:tt)*) => { $crate::output::out(format_args!($($text)*)) };
}

/// As std's `println!`, without a panic.
#[macro_export]
macro_rules! println {
    ($($text:tt)*) => { $crate::output::out(format_args!("{}\n", format_args!($($text)*))) };
}

/// As std's `eprint!`, without a panic.
#[macro_export]
macro_rules! eprint {
    ($($text:tt)*) => { $crate::output::error(format_args!($($text)*)) };
}

/// As std's `eprintln!`, without a panic.
#[macro_export]
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::output::error(format_args!("{}\n", format_args!($($text)*))) };
}

thread_local! {
    /// What this thread prints, while it is collected.
    static COLLECTED: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// The answer of a function, and all that it prints on this thread instead of printing it.
pub fn collected<T>(body: impl FnOnce() -> T) -> (T, String) {
    COLLECTED.set(Some(String::new()));
    let answer = body();
    (answer, COLLECTED.take().unwrap_or_default())
}

/// Keep a text, if this thread collects what it prints.
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

/// Print to standard error; where that cannot be written, there is nobody to report it to.
pub fn error(text: Arguments) {
    let text = plain(text);
    if !collect(&text) {
        let _ = io::stderr().write_all(text.as_bytes());
    }
}

/// Whether all that was printed is written.
///
/// # Errors
/// Standard output could not be written, for another reason than a pipe that its reader has closed.
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

/// The text with its control characters as escapes, but for ends of lines and tabs.
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
