//! How far a study is: part, rate, time left.

use indicatif::{ProgressBar, ProgressStyle};

/// The bar; nothing where the error output is no terminal.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar of so many runs, of which some are done.
    pub fn new(runs: u64, done: u64, is_shown: bool) -> Self {
        if !is_shown {
            return Self(ProgressBar::hidden());
        }
        let style =
            ProgressStyle::with_template("{bar:40} {human_pos} of {human_len} runs, {per_sec}, {eta} left{msg}");
        let bar = ProgressBar::new(runs);
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_position(done);
        // The rate counts from here.
        bar.reset_eta();
        Self(bar)
    }

    /// Show this behind the bar.
    pub fn tell(&self, text: String) {
        self.0.set_message(text);
    }

    /// So many more runs are done.
    pub fn add(&self, runs: u64) {
        self.0.inc(runs);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
