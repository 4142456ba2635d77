//! The stress suite: scenes at the ends of what can be asked for, each with a bound that is derived, and its verdict.
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
    /// Heading under which it stands.
    pub group: &'static str,
    /// The model.
    pub model: &'static str,
    /// What is done to it.
    pub what: String,
    /// Relative tolerance.
    pub tolerance: f64,
    /// Communication steps.
    pub steps: u64,
    /// Words of the refusal that must come, if one must.
    refusal: Option<Vec<String>>,
    /// Run it, and hold the result against its bounds.
    run: Box<dyn Fn() -> Result<Outcome, String> + Sync>,
}

/// Whether a row is as it must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within its bounds.
    Holds,
    /// Refused with the message that it must be refused with.
    Refused,
    /// Neither.
    Fails,
}

impl Verdict {
    /// As it is written.
    pub fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Refused => "refused as expected",
            Self::Fails => "FAILS",
        }
    }
}

/// What came out.
pub struct Outcome {
    /// Error of what is read, and its bound.
    pub error: Option<(f64, f64)>,
    /// Largest energy.drift and its bound [J].
    pub drift: Option<(f64, f64)>,
    /// Work of the integration.
    pub work: Statistics,
    /// Time of the steps on a processor [s].
    pub cpu: f64,
    /// Why the bounds are what they are, or the message.
    pub why: String,
    /// Whether it is as it must be.
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

/// Judge rows on `threads` threads; each outcome is told as it comes, with the row's place, and all are returned in
/// the rows' order.
pub fn judge(rows: &[Row], threads: usize, tell: &(dyn Fn(usize, &Outcome) + Sync)) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(row) = rows.get(place) else { return done };
            let outcome = row.judge();
            tell(place, &outcome);
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
