//! Progress of a study: part, rate, remaining time.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Called with the number of completed runs and of all runs, on the thread that started the study.
pub type Watch<'a> = &'a dyn Fn(u64, u64);

/// The progress bar. Nothing is shown if the error output is no terminal.
pub struct Bar<'a>(ProgressBar, Option<Watch<'a>>);

impl<'a> Bar<'a> {
    /// A bar for this number of runs, of which some are completed. With `watch` no bar is shown.
    pub fn new(runs: u64, done: u64, watch: Option<Watch<'a>>) -> Self {
        if watch.is_some() || !std::io::stderr().is_terminal() {
            return Self(
                ProgressBar::with_draw_target(Some(runs), ProgressDrawTarget::hidden()).with_position(done),
                watch,
            );
        }
        let style =
            ProgressStyle::with_template("{bar:40} {human_pos} of {human_len} runs, {per_sec}, {eta} left{msg}");
        let bar = ProgressBar::new(runs);
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_position(done);
        // The rate is measured from here on.
        bar.reset_eta();
        Self(bar, None)
    }

    /// Show this text after the bar.
    pub fn show(&self, text: String) {
        self.0.set_message(text);
    }

    /// Add completed runs.
    pub fn add(&self, runs: u64) {
        self.0.inc(runs);
        if let Some(watch) = self.1 {
            watch(self.0.position(), self.0.length().unwrap_or_default());
        }
    }
}

impl Drop for Bar<'_> {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
