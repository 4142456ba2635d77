//! Evaluations of designs: runs whose factors an optimiser chooses.
//!
//! In: points. Out: the responses of each point, in the order of the points, for any number of threads. Each thread has
//! a separate model. The module must not know the objective.

use crate::sweep::chunk::run_one;
use crate::sweep::run::{Runner, Task};
use anyhow::Result;
use linkage_fmu::component::Component;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

/// A completed run.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Values of the factors.
    pub point: Vec<f64>,
    /// The responses; NaN if the run failed.
    pub responses: Vec<f64>,
    /// Whether the run failed.
    pub is_failure: bool,
    /// A remark about the run, or the reason of its failure. Usually empty.
    pub message: String,
}

/// Models for the runs, one per thread.
pub struct Evaluator<'a> {
    runners: Vec<Runner<'a>>,
    columns: usize,
}

impl<'a> Evaluator<'a> {
    /// Models for this number of threads.
    ///
    /// # Errors
    /// The model rejects a common value of all runs.
    pub fn new(task: &'a Task, model: &Component, threads: usize) -> Result<Self> {
        let runners = (0..threads.max(1)).map(|_| Runner::new(task, model.clone())).collect::<Result<_>>()?;
        Ok(Self { runners, columns: task.responses.columns.len() })
    }

    /// Make these runs. None if the user stops the search.
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

/// The next point for a thread. None when the user stops the search.
fn next_of<'p>(points: &'p [Vec<f64>], next: &AtomicUsize, stop_wish: &AtomicBool) -> Option<(usize, &'p Vec<f64>)> {
    if stop_wish.load(Ordering::Relaxed) {
        return None;
    }
    let index = next.fetch_add(1, Ordering::Relaxed);
    Some((index, points.get(index)?))
}
