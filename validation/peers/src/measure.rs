//! One point of a curve: the error, what it cost, and how it is written down.
use crate::four_bar::THETA2;
use std::fmt::Debug;
use std::time::{Duration, Instant};

/// What one setting of one method gives.
pub struct Point {
    pub scene: &'static str,
    pub tool: &'static str,
    pub method: String,
    pub setting: String,
    /// Of theta2 at the end [rad].
    pub error: f64,
    /// The fastest run, and what comes once before the first [s].
    pub run: f64,
    pub set_up: f64,
    /// Of the right-hand side, where the tool tells.
    pub evaluations: Option<usize>,
}

/// First line of the file.
pub const HEADER: &str = "scene,tool,method,setting,error_rad,run_s,setup_s,evaluations\n";

impl Point {
    /// Take the times of the same setting, measured again, where they are less.
    pub fn keep_faster(&mut self, again: &Self) {
        if (self.scene, self.tool, &self.method, &self.setting)
            == (again.scene, again.tool, &again.method, &again.setting)
        {
            self.run = self.run.min(again.run);
            self.set_up = self.set_up.min(again.set_up);
        }
    }

    /// Its line in the file.
    pub fn line(&self) -> String {
        let Self { scene, tool, method, setting, error, run, set_up, .. } = self;
        let evaluations = self.evaluations.map_or(String::new(), |n| n.to_string());
        format!("{scene},{tool},{method},{setting},{error:.6e},{run:.6e},{set_up:.6e},{evaluations}\n")
    }
}

/// A point of scene S1: a run gives theta2 at the end and its evaluations. One that fails is told and left out.
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

/// Relative and absolute tolerances from 1e-2 on, down to 10^(-last/2).
pub fn tolerances(last: i32) -> impl Iterator<Item = [f64; 2]> {
    (4..=last).flat_map(|half| {
        let rtol = 10f64.powf(-f64::from(half) / 2.0);
        [1.0, 1e-2].map(|ratio| [rtol, ratio * rtol])
    })
}

/// Result and time [s] of the fastest of many runs: for 50 ms and at least five, or until one takes that long itself.
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
