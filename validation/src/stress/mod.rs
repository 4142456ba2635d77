//! The stress suite: scenes with extreme parameters, each with a derived error bound, and its verdict.
mod case;
mod hydraulic;
mod motion;
mod plan;
mod reference;
mod scene;
mod scenes;

use linkage_fmu::integrator::Statistics;
use std::sync::atomic::{AtomicUsize, Ordering};

/// One row of the suite.
pub struct Row {
    /// Heading of its group.
    pub group: &'static str,
    /// The model.
    pub model: &'static str,
    /// What is changed in the model.
    pub what: String,
    /// Relative tolerance.
    pub tolerance: f64,
    /// Communication steps.
    pub steps: u64,
    /// Parts of the expected error message, if one is expected.
    refusal: Option<Vec<String>>,
    /// Run it, and compare the result with its bounds.
    run: Box<dyn Fn() -> Result<Outcome, String> + Sync>,
}

/// Whether a row passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within its bounds.
    Holds,
    /// Rejected with the expected message.
    Refused,
    /// Neither.
    Fails,
}

impl Verdict {
    /// Its name in the table.
    pub fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Refused => "rejected as expected",
            Self::Fails => "FAILS",
        }
    }
}

/// Result of a row.
pub struct Outcome {
    /// Error of the compared output, and its bound.
    pub error: Option<(f64, f64)>,
    /// Largest energy.drift and its bound [J].
    pub drift: Option<(f64, f64)>,
    /// Work of the integration.
    pub work: Statistics,
    /// Time of the steps on a processor [s].
    pub cpu: f64,
    /// Reason for the bounds, or the message.
    pub why: String,
    /// The verdict.
    pub verdict: Verdict,
}

impl Row {
    fn judge(&self) -> Outcome {
        let (why, verdict) = match ((self.run)(), &self.refusal) {
            (Ok(outcome), None) => return outcome,
            (Ok(_), Some(_)) => ("no call was refused".into(), Verdict::Fails),
            (Err(why), Some(words)) if words.iter().all(|word| why.contains(word.as_str())) => (why, Verdict::Refused),
            (Err(why), _) => (why, Verdict::Fails),
        };
        Outcome { error: None, drift: None, work: Statistics::default(), cpu: 0.0, why, verdict }
    }
}

/// All rows, group by group.
pub fn all() -> Vec<Row> {
    scenes::all().into_iter().chain(hydraulic::all()).collect()
}

/// Evaluate rows in `threads` threads; `report` gets each outcome with the row's index when it is complete. Returns all
/// outcomes in the order of the rows.
pub fn judge(rows: &[Row], threads: usize, report: &(dyn Fn(usize, &Outcome) + Sync)) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(row) = rows.get(place) else { return done };
            let outcome = row.judge();
            report(place, &outcome);
            done.push((place, outcome));
        }
    };
    let mut all: Vec<(usize, Outcome)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    all.sort_by_key(|(place, _)| *place);
    all.into_iter().map(|(_, outcome)| outcome).collect()
}
