//! How far a long run is, and the user's wish to end it.

use fmu_build::run::Watch;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time for which a run goes on before its bar is shown.
const SILENT: Duration = Duration::from_millis(500);
/// Steps of the bar.
const TICKS: f64 = 1e4;

/// Whether the study is to end early.
static WISH: AtomicBool = AtomicBool::new(false);
static HANDLED: Once = Once::new();

/// Set when the user types Ctrl-C; one for all runs of the program, which can have one handler only.
pub fn stop_wish() -> &'static AtomicBool {
    // Without a handler Ctrl-C ends the program at once, which loses rows only.
    HANDLED.call_once(|| drop(ctrlc::set_handler(|| WISH.store(true, Ordering::Relaxed))));
    &WISH
}

/// What [`stop_wish`] gives, for a host that handles Ctrl-C itself and sets it.
pub fn stop_wish_of_host() -> &'static AtomicBool {
    HANDLED.call_once(|| {});
    &WISH
}

/// How far a long run is.
pub struct Bar {
    bar: ProgressBar,
    started: std::time::Instant,
    is_shown: bool,
    stop_wish: &'static AtomicBool,
}

impl Bar {
    /// A bar, shown once the run has lasted half a second, if it is to be shown at all.
    pub fn new(is_shown: bool) -> Self {
        Self { bar: ProgressBar::hidden(), started: std::time::Instant::now(), is_shown, stop_wish: stop_wish() }
    }

    /// Take the bar away.
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
