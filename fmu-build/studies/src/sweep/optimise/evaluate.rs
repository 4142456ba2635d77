//! Evaluations of designs: runs whose factors an optimiser chooses.
//!
//! In: points. Out: the responses of each, in the order of the points, whatever the threads. Each thread has a model of
//! its own. It must not know what a design is worth.

use crate::sweep::chunk::run_one;
use crate::sweep::run::{Runner, Task};
use anyhow::Result;
use linkage_fmu::component::Component;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

/// A run that was made.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Values of the factors.
    pub point: Vec<f64>,
    /// The responses; NaN if the run failed.
    pub responses: Vec<f64>,
    /// Whether the run failed.
    pub is_failure: bool,
    /// What is unusual about the run, or why it failed; empty mostly.
    pub message: String,
}

/// Models that make runs, one for each thread.
pub struct Evaluator<'a> {
    runners: Vec<Runner<'a>>,
    columns: usize,
}

impl<'a> Evaluator<'a> {
    /// Models for so many threads.
    ///
    /// # Errors
    /// The model refuses a value that all runs share.
    pub fn new(task: &'a Task, model: &Component, threads: usize) -> Result<Self> {
        let runners = (0..threads.max(1)).map(|_| Runner::new(task, model.clone())).collect::<Result<_>>()?;
        Ok(Self { runners, columns: task.responses.columns.len() })
    }

    /// Make these runs; none if the user wishes to stop before their end.
    pub fn evaluate(&mut self, points: &[Vec<f64>], stop_wish: &AtomicBool) -> Option<Vec<Evaluation>> {
        let (next, columns) = (AtomicUsize::new(0), self.columns);
        let done = Mutex::new(vec![None; points.len()]);
        let work = |runner: &mut Runner| {
            while let Some((index, point)) = next_of(points, &next, stop_wish) {
                let mut responses = vec![0.0; columns];
                let (is_failure, message) = run_one(runner, point, None, &mut responses);
                let made = Evaluation { point: point.clone(), responses, is_failure, message };
                if let Ok(mut done) = done.lock() {
                    done[index] = Some(made);
                }
            }
        };
        let count = self.runners.len().min(points.len());
        match &mut self.runners[..count] {
            [runner] => work(runner),
            runners => thread::scope(|scope| {
                for runner in runners {
                    scope.spawn(|| work(runner));
                }
            }),
        }
        done.into_inner().ok()?.into_iter().collect()
    }
}

/// The next point that no thread has taken yet; none once the user wishes to stop.
fn next_of<'p>(points: &'p [Vec<f64>], next: &AtomicUsize, stop_wish: &AtomicBool) -> Option<(usize, &'p Vec<f64>)> {
    if stop_wish.load(Ordering::Relaxed) {
        return None;
    }
    let index = next.fetch_add(1, Ordering::Relaxed);
    Some((index, points.get(index)?))
}
