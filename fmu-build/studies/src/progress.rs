//! Progress of a long run, and the user's request to end it.

use fmu_build::run::Watch;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Duration of a run before its bar is shown.
const SILENT: Duration = Duration::from_millis(500);
/// Number of steps of the bar.
const TICKS: f64 = 1e4;

/// Whether the study must end early.
static WISH: AtomicBool = AtomicBool::new(false);
static HANDLED: Once = Once::new();

/// Set when the user presses Ctrl-C. All runs of the program share it, because the program can have only one handler.
pub fn stop_wish() -> &'static AtomicBool {
    // Without a handler Ctrl-C ends the program at once. Only rows are lost.
    HANDLED.call_once(|| drop(ctrlc::set_handler(|| WISH.store(true, Ordering::Relaxed))));
    &WISH
}

/// The flag of [`stop_wish`], for a host that handles Ctrl-C itself and sets the flag.
pub fn stop_wish_of_host() -> &'static AtomicBool {
    HANDLED.call_once(|| {});
    &WISH
}

/// Progress bar of a long run.
pub struct Bar {
    bar: ProgressBar,
    started: std::time::Instant,
    is_shown: bool,
    stop_wish: &'static AtomicBool,
}

impl Bar {
    /// A bar, which is shown after half a second if `is_shown`.
    pub fn new(is_shown: bool) -> Self {
        Self { bar: ProgressBar::hidden(), started: std::time::Instant::now(), is_shown, stop_wish: stop_wish() }
    }

    /// Remove the bar.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

impl Watch for Bar {
    fn look(&mut self, part: f64) -> bool {
        if self.is_shown && self.bar.is_hidden() && self.started.elapsed() > SILENT {
            let style = ProgressStyle::with_template("{bar:40} {percent} %, {eta} left");
            self.bar = ProgressBar::new(TICKS as u64);
            self.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        }
        self.bar.set_position((part * TICKS) as u64);
        self.stop_wish.load(Ordering::Relaxed)
    }

    fn warn(&mut self, line: &str) {
        self.bar.suspend(|| eprintln!("{line}"));
    }
}
