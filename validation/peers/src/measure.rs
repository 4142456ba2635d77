//! One point of a curve: error, run time, evaluations, and its line in the file.
use crate::four_bar::THETA2;
use std::fmt::Debug;
use std::time::{Duration, Instant};

/// Result of one setting of one method.
pub struct Point {
    pub scene: &'static str,
    pub tool: &'static str,
    pub method: String,
    pub setting: String,
    /// Error of theta2 at the end [rad].
    pub error: f64,
    /// The fastest run, and the set-up before the first run [s].
    pub run: f64,
    pub set_up: f64,
    /// Evaluations of the right-hand side, if the tool counts them.
    pub evaluations: Option<usize>,
}

/// First line of the file.
pub const HEADER: &str = "scene,tool,method,setting,error_rad,run_s,setup_s,evaluations\n";

impl Point {
    /// Keep the lesser of both times, from another measurement of the same setting.
    pub fn keep_faster(&mut self, again: &Self) {
        if (self.scene, self.tool, &self.method, &self.setting)
            == (again.scene, again.tool, &again.method, &again.setting)
        {
            self.run = self.run.min(again.run);
            self.set_up = self.set_up.min(again.set_up);
        }
    }

    /// The line of the point in the file.
    pub fn line(&self) -> String {
        let Self { scene, tool, method, setting, error, run, set_up, .. } = self;
        let evaluations = self.evaluations.map_or(String::new(), |n| n.to_string());
        format!("{scene},{tool},{method},{setting},{error:.6e},{run:.6e},{set_up:.6e},{evaluations}\n")
    }
}

/// A point of scene S1. A run returns theta2 at the end and its evaluations; a failed run is printed and omitted.
pub fn point<E: Debug>(
    tool: &'static str,
    method: &str,
    setting: String,
    set_up: f64,
    run: impl FnMut() -> Result<(f64, usize), E>,
) -> Option<Point> {
    match fastest(run) {
        Ok(((theta2, evaluations), run)) => {
            let (method, error, evaluations) = (method.into(), (theta2 - THETA2).abs(), Some(evaluations));
            Some(Point { scene: "S1", tool, method, setting, error, run, set_up, evaluations })
        }
        Err(reason) => {
            println!("{tool} {method} {setting}: {reason:?}");
            None
        }
    }
}

/// Relative and absolute tolerances from 1e-2 to 10^(-last/2).
pub fn tolerances(last: i32) -> impl Iterator<Item = [f64; 2]> {
    (4..=last).flat_map(|half| {
        let rtol = 10f64.powf(-f64::from(half) / 2.0);
        [1.0, 1e-2].map(|ratio| [rtol, ratio * rtol])
    })
}

/// Result and time [s] of the fastest of at least five runs. Runs repeat for 50 ms, or until one takes that long.
pub fn fastest<T, E>(mut run: impl FnMut() -> Result<T, E>) -> Result<(T, f64), E> {
    const LONG: Duration = Duration::from_millis(50);
    const LEAST: usize = 5;
    let (mut count, mut best) = (0, Duration::MAX);
    let began = Instant::now();
    loop {
        let start = Instant::now();
        let value = run()?;
        best = best.min(start.elapsed());
        count += 1;
        if began.elapsed() > LONG && (count >= LEAST || best > LONG) {
            return Ok((value, best.as_secs_f64()));
        }
    }
}
