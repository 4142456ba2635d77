//! What a case of an attack reports while it runs: how often something happened, how long a call took, how far a result
//! is off; and the watch over a call that does not end.
use super::mechanism::Prepared;
use super::random::Random;
use cpu_time::ThreadTime;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// The largest of some values, what it belongs to, and the seed of its case.
#[derive(Clone, Debug, Default)]
pub struct Largest {
    /// The value; 0 for none.
    pub value: f64,
    /// What it belongs to.
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

/// What the cases of a part gave.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Cases that were run.
    pub cases: u64,
    /// How often what happened.
    pub counts: BTreeMap<&'static str, u64>,
    /// The longest call [s of the thread's time].
    pub longest: Largest,
    /// The largest ratio of a difference to what it may be.
    pub ratio: Largest,
    /// Seed and words of each case that failed.
    pub failures: Vec<(u64, String)>,
}

impl Tally {
    /// Add what other cases gave.
    pub fn add(&mut self, other: Self) {
        self.cases += other.cases;
        other.counts.into_iter().for_each(|(what, count)| *self.counts.entry(what).or_default() += count);
        self.longest.take(&other.longest);
        self.ratio.take(&other.ratio);
        self.failures.extend(other.failures);
    }
}

/// What a thread is doing, for a watch outside of it: seed of the case, and since when a call runs [ms, 0 for none].
#[derive(Debug, Default)]
pub struct Pulse {
    pub seed: AtomicU64,
    pub since: AtomicU64,
}

/// Milliseconds since `start`, never 0.
pub fn milliseconds(start: Instant) -> u64 {
    start.elapsed().as_millis() as u64 + 1
}

/// The hand of one thread that runs cases.
#[derive(Debug)]
pub struct Probe<'a> {
    /// Seed of the present case.
    pub seed: u64,
    /// Its random numbers.
    pub random: Random,
    pub tally: Tally,
    /// The mechanism that was prepared last, and its own seed.
    pub prepared: Option<(u64, Prepared)>,
    /// Whether the steps of a case tell what they do.
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

    /// Count that something happened.
    pub fn count(&mut self, what: &'static str) {
        *self.tally.counts.entry(what).or_default() += 1;
    }

    /// Call, keep the thread's time that it took if it is the longest, and let the watch see it.
    pub fn timed<T>(&mut self, what: &'static str, call: impl FnOnce() -> T) -> T {
        self.pulse.since.store(milliseconds(self.start), Ordering::Relaxed);
        let began = ThreadTime::now();
        let given = call();
        let value = began.elapsed().as_secs_f64();
        self.pulse.since.store(0, Ordering::Relaxed);
        self.tally.longest.take(&Largest { value, what, seed: self.seed });
        given
    }

    /// Keep a ratio of a difference to what it may be if it is the largest.
    pub fn ratio(&mut self, value: f64, what: &'static str) {
        let seed = self.seed;
        self.tally.ratio.take(&Largest { value, what, seed });
    }
}
