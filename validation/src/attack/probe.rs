//! Record of a running case: counts of events, duration of calls, size of errors; and a watchdog for calls that do not
//! end.
use super::prepared::Prepared;
use super::random::Random;
use cpu_time::ThreadTime;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// The largest of some values, its label, and the seed of its case.
#[derive(Clone, Debug, Default)]
pub struct Largest {
    /// The value; 0 for none.
    pub value: f64,
    /// Label of the value.
    pub what: &'static str,
    /// Seed of the case.
    pub seed: u64,
}

impl Largest {
    fn take(&mut self, other: &Self) {
        if other.value > self.value {
            *self = other.clone();
        }
    }
}

/// Results of the cases of a part.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Number of cases.
    pub cases: u64,
    /// Counts by label.
    pub counts: BTreeMap<&'static str, u64>,
    /// The longest call [s of the thread's time].
    pub longest: Largest,
    /// The largest ratio of a difference to its limit.
    pub ratio: Largest,
    /// Seed and message of each failed case.
    pub failures: Vec<(u64, String)>,
}

impl Tally {
    /// Add the results of other cases.
    pub fn add(&mut self, other: Self) {
        self.cases += other.cases;
        other.counts.into_iter().for_each(|(what, count)| *self.counts.entry(what).or_default() += count);
        self.longest.take(&other.longest);
        self.ratio.take(&other.ratio);
        self.failures.extend(other.failures);
    }
}

/// State of a thread for the watchdog: seed of the case, and start of the present call [ms, 0 for none].
#[derive(Debug, Default)]
pub struct Pulse {
    pub seed: AtomicU64,
    pub since: AtomicU64,
}

/// Milliseconds since `start`, never 0.
pub fn milliseconds(start: Instant) -> u64 {
    start.elapsed().as_millis() as u64 + 1
}

/// The recorder of one thread that runs cases.
#[derive(Debug)]
pub struct Probe<'a> {
    /// Seed of the present case.
    pub seed: u64,
    /// Its random numbers.
    pub random: Random,
    pub tally: Tally,
    /// The mechanism prepared last, and its seed.
    pub prepared: Option<(u64, Prepared)>,
    /// Whether the steps of a case are printed.
    pub verbose: bool,
    start: Instant,
    pulse: &'a Pulse,
}

impl<'a> Probe<'a> {
    pub fn new(start: Instant, pulse: &'a Pulse, verbose: bool) -> Self {
        let (random, tally) = (Random::new(0), Tally::default());
        Self { seed: 0, random, tally, prepared: None, verbose, start, pulse }
    }

    /// Begin a case.
    pub fn begin(&mut self, seed: u64) {
        (self.seed, self.random) = (seed, Random::new(seed));
        self.tally.cases += 1;
        self.pulse.seed.store(seed, Ordering::Relaxed);
        self.pulse.since.store(0, Ordering::Relaxed);
    }

    /// Count an event.
    pub fn count(&mut self, what: &'static str) {
        *self.tally.counts.entry(what).or_default() += 1;
    }

    /// Make a call visible to the watchdog, and record its thread time if it is the longest.
    pub fn timed<T>(&mut self, what: &'static str, call: impl FnOnce() -> T) -> T {
        self.pulse.since.store(milliseconds(self.start), Ordering::Relaxed);
        let began = ThreadTime::now();
        let given = call();
        let value = began.elapsed().as_secs_f64();
        self.pulse.since.store(0, Ordering::Relaxed);
        self.tally.longest.take(&Largest { value, what, seed: self.seed });
        given
    }

    /// Record a ratio of a difference to its limit if it is the largest.
    pub fn ratio(&mut self, value: f64, what: &'static str) {
        let seed = self.seed;
        self.tally.ratio.take(&Largest { value, what, seed });
    }
}
