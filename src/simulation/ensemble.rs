//! Runs of one model from many start values, on several threads.
//!
//! In: a model, rows of start values, a stop time. Out: the outputs of each run at its stop time. Runs share no
//! mutable data, so the values of a run depend neither on the other runs nor on the number of threads. Where the
//! energy integral gives the motion, a run needs no steps up to its stop time or up to a stop.

use super::{Simulation, SimulationError};
use crate::component::{Component, FastForward, Refused, Stepped, Waypoint};
use crate::variables::{Kind, Reference, Value};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Number of runs in one work item of a thread.
const CHUNK: usize = 64;
/// Longest time between two calls of `watch`.
const LOOK: Duration = Duration::from_millis(50);

/// A model, the variables that differ between the runs, and the variables that are read at the end of each run.
#[derive(Clone, Copy, Debug)]
pub struct Ensemble<'a> {
    /// The model with the values that all runs share, not initialised.
    pub model: &'a Component,
    /// Real inputs and parameters that differ between the runs.
    pub varied: &'a [Reference],
    /// Variables that are read at the stop time.
    pub outputs: &'a [Reference],
    /// End of each run [s]; 0 reads the outputs at the start.
    pub stop_time: f64,
}

/// Values of many runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Runs {
    /// For each run, the value of each output at the stop time in SI units. Booleans are 0 or 1, Enumerations the
    /// number of the item from 1 on. NaN if the run failed or the output has no value.
    pub values: Vec<f64>,
    /// For each run with a NaN, ascending: number of the run from 0 on, and the reason.
    pub remarks: Vec<(usize, String)>,
}

impl Ensemble<'_> {
    /// Makes the runs on `threads` threads. `rows`: start values, `varied.len()` numbers for each run. `watch` is
    /// called with the number of finished runs at least every 50 ms. If `watch` returns true, the remaining runs are
    /// omitted, and their values are NaN without a remark.
    ///
    /// # Errors
    /// A variable of `varied` is an output or not a Real.
    pub fn run(&self, rows: &[f64], threads: usize, mut watch: impl FnMut(usize) -> bool) -> Result<Runs, Refused> {
        for &reference in self.varied {
            let start = self.model.interface().get(reference).and_then(|variable| variable.start.as_ref());
            self.model.check_real(reference, if let Some(Value::Real(start)) = start { *start } else { 0.0 })?;
        }
        let (width, read) = (self.varied.len().max(1), self.outputs.len());
        let mut values = vec![f64::NAN; rows.len() / width * read];
        let work = rows.chunks(CHUNK * width).zip(values.chunks_mut((CHUNK * read).max(1))).enumerate();
        let (work, is_stopped, (sender, done)) = (Mutex::new(work), AtomicBool::new(false), channel());
        let forward = self.fast_forward();
        let mut remarks = thread::scope(|scope| {
            let (work, is_stopped, forward) = (&work, &is_stopped, forward.as_ref());
            let threads: Vec<_> = (0..threads.max(1))
                .map(|_| {
                    let sender = sender.clone();
                    scope.spawn(move || {
                        let (mut runner, mut remarks) = (Runner::new(self), Vec::new());
                        while !is_stopped.load(Ordering::Relaxed) {
                            let next = work.lock().ok().and_then(|mut work| work.next());
                            let Some((chunk, (rows, values))) = next else { break };
                            let mut states = [None; CHUNK];
                            if let Some(forward) = forward {
                                forward.states(rows, self.stop_time, &mut states[..rows.len() / width]);
                            }
                            for ((k, row), state) in rows.chunks_exact(width).enumerate().zip(&states) {
                                let remark = runner.run(row, state.as_ref(), &mut values[k * read..][..read]);
                                remarks.extend(remark.map(|remark| (chunk * CHUNK + k, remark)));
                            }
                            // The receiver exists as long as this scope.
                            let _ = sender.send(rows.len() / width);
                        }
                        remarks
                    })
                })
                .collect();
            drop(sender);
            let mut finished = 0;
            loop {
                match done.recv_timeout(LOOK) {
                    Ok(count) => finished += count,
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => break,
                }
                if watch(finished) {
                    is_stopped.store(true, Ordering::Relaxed);
                }
            }
            let all = threads.into_iter().map(|thread| thread.join().unwrap_or_else(resume));
            all.collect::<Vec<_>>().concat()
        });
        remarks.sort_unstable();
        Ok(Runs { values, remarks })
    }

    /// States on the way as functions of what is varied, where the energy integral gives them.
    fn fast_forward(&self) -> Option<FastForward> {
        if self.stop_time == 0.0 {
            return None;
        }
        let mut model = self.model.clone();
        model.initialize().ok()?;
        model.fast_forward(self.varied)
    }
}

/// Resumes a panic of a thread in the thread of the caller.
fn resume(panic: Box<dyn std::any::Any + Send>) -> Vec<(usize, String)> {
    std::panic::resume_unwind(panic)
}

/// The model of one thread.
struct Runner<'a> {
    ensemble: &'a Ensemble<'a>,
    model: Component,
    /// Indices of the Reals among the outputs, and their references.
    reals: Vec<(usize, Reference)>,
    references: Vec<Reference>,
    /// Indices, references and kinds of the other outputs.
    others: Vec<(usize, Reference, Kind)>,
}

impl<'a> Runner<'a> {
    fn new(ensemble: &'a Ensemble<'a>) -> Self {
        let model = ensemble.model.clone();
        let (mut reals, mut others) = (Vec::new(), Vec::new());
        for (place, &reference) in ensemble.outputs.iter().enumerate() {
            match model.interface().get(reference).map(|variable| variable.kind) {
                Some(kind @ (Kind::Boolean | Kind::Enumeration)) => others.push((place, reference, kind)),
                _ => reals.push((place, reference)),
            }
        }
        Self { ensemble, model, references: reals.iter().map(|(_, own)| *own).collect(), reals, others }
    }

    /// Makes a run, from a known state on the way if there is one. Returns the reason if a value is NaN.
    fn run(&mut self, row: &[f64], state: Option<&Waypoint>, values: &mut [f64]) -> Option<String> {
        let remark = self.make(row, state, values);
        // The next run must start from a known state.
        if remark.is_err() || matches!(self.model, Component::Hydraulic(_)) {
            self.model = self.ensemble.model.clone();
        }
        match remark {
            Ok(remark) => remark,
            Err(why) => {
                values.fill(f64::NAN);
                Some(why)
            }
        }
    }

    fn make(&mut self, row: &[f64], state: Option<&Waypoint>, values: &mut [f64]) -> Result<Option<String>, String> {
        let Self { ensemble, model, .. } = self;
        let refused = |refused: Refused| refused.0;
        let most = model.most_together();
        for (references, values) in ensemble.varied.chunks(most).zip(row.chunks(most)) {
            model.set_reals(references, values).map_err(refused)?;
        }
        model.initialize().map_err(refused)?;
        if ensemble.stop_time > 0.0 {
            match model.step_by(state, 0.0, ensemble.stop_time).map_err(refused)? {
                Stepped::Whole => {}
                Stepped::Part(part) => return Err(format!("the run ends at {:?} s: {}", part.time, part.why)),
                Stepped::Failed(refused) => return Err(refused.0),
            }
        }
        let mut places = self.reals.iter();
        let give = |value| {
            if let Some((place, _)) = places.next() {
                values[*place] = value;
            }
        };
        model.reals(&self.references, give).map_err(refused)?;
        for &(place, reference, kind) in &self.others {
            values[place] = match kind {
                Kind::Boolean => f64::from(u8::from(model.boolean(reference).map_err(refused)?)),
                _ => (model.item(reference).map_err(refused)? + 1) as f64,
            };
        }
        let undefined = self.reals.iter().find(|(place, _)| values[*place].is_nan());
        Ok(undefined.map(|(_, reference)| {
            let name = model.interface().get(*reference).map_or("an output", |variable| &variable.name).to_owned();
            let why = model.undefined(*reference).unwrap_or_else(|| "the output has no value in this state".to_owned());
            format!("{name}: {why}")
        }))
    }
}

impl Simulation {
    /// Outputs of many runs at `stop_time` [s], computed on several threads. `rows` contains the values of the named
    /// inputs and parameters, run by run. All other values are the present values of this simulation, which does not
    /// change. The values of a run have the same bits as those of a separate simulation after one step from 0 s to
    /// `stop_time`. If the energy integral gives the motion ([`Model::fast_forward`]), they agree within
    /// `solver.tolerance`. The bits of a run never depend on the other runs, their order or the number of threads.
    ///
    /// # Errors
    /// No variable has one of the names, or an input is an output or not a Real. `stop_time` is not finite or < 0, or
    /// `rows` is not a whole number of rows. A failed run is not an error: its values are NaN, and [`Runs::remarks`]
    /// states the reason.
    pub fn run_many(
        &self,
        inputs: &[&str],
        rows: &[f64],
        stop_time: f64,
        outputs: &[&str],
        threads: usize,
    ) -> Result<Runs, SimulationError> {
        let references = |names: &[&str]| names.iter().map(|name| self.reference(name)).collect::<Result<Vec<_>, _>>();
        let (varied, outputs) = (references(inputs)?, references(outputs)?);
        if !(stop_time >= 0.0 && stop_time.is_finite()) {
            return Err(SimulationError::Span { span: stop_time, step: stop_time });
        }
        if !rows.len().is_multiple_of(inputs.len().max(1)) {
            return Err(SimulationError::Rows { values: rows.len(), inputs: inputs.len() });
        }
        let model = Component::Mechanism(self.model.clone());
        let ensemble = Ensemble { model: &model, varied: &varied, outputs: &outputs, stop_time };
        ensemble.run(rows, threads, |_| false).map_err(|Refused(why)| SimulationError::Refused(why))
    }
}
