//! Randomised tests: random histories, corrupted states, malformed definitions, scenes against an independent
//! integration, threads. Each case is generated from a seed, which its failure reports.
//!
//! In: the command line. Out: failures with their seeds, counts, the longest call, a page. Must not depend on how a
//! mechanism is solved.
mod actuator;
mod answers;
mod calls;
mod coupled;
mod definitions;
mod histories;
mod kinds;
mod mechanism;
mod metamorphic;
mod network;
mod page;
mod player;
mod prepared;
mod probe;
pub mod random;
mod relation;
mod rewritten;
mod scenes;
mod states;
mod threads;

pub use probe::{Largest, Tally};

use crate::measure;
use probe::{Probe, Pulse, milliseconds};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time limit of a call [s of its thread's time].
pub const LONGEST: f64 = 5.0;
/// Time after which a call is aborted [ms]: longer, as calls take longer on a busy machine or in a debug build.
const PATIENCE: u64 = 120_000;
/// Number of failures after which a part ends.
const ENOUGH: usize = 20;

/// A case of a part; the error describes the failure.
type Case = fn(&mut Probe) -> Result<(), String>;

/// One kind of randomised test.
pub struct Part {
    /// Name for `--only`.
    pub name: &'static str,
    case: Case,
    /// Number of cases if neither their number nor a time is given.
    count: u64,
    /// Share of the given time.
    share: f64,
    /// Consecutive cases of one thread, which share a mechanism.
    block: u64,
}

impl Part {
    const fn new(name: &'static str, case: Case, count: u64, share: f64, block: u64) -> Self {
        Self { name, case, count, share, block }
    }

    /// What the cases of this part check.
    pub fn claim(&self) -> String {
        measure::page(if self.name == "scenes" { "motions" } else { self.name }, &[]).trim().to_owned()
    }
}

/// All kinds of randomised tests.
pub const PARTS: [Part; 12] = [
    Part::new("histories", histories::attack, 12_000, 0.3, histories::SHARED),
    Part::new("coupled", coupled::attack, 1_000, 0.1, 1),
    Part::new("calls", calls::second, 1_000, 0.05, 1),
    Part::new("calls3", calls::third, 42_000, 0.1, 1),
    Part::new("exchange", calls::exchange, 5_000, 0.05, 1),
    Part::new("states", states::attack, 6_000, 0.08, histories::SHARED),
    Part::new("definitions", definitions::attack, 100_000, 0.12, 1),
    Part::new("scenes", scenes::attack, 1_000, 0.28, 1),
    Part::new("kinds", kinds::attack, 300, 0.1, 1),
    Part::new("metamorphic", metamorphic::attack, 10_000, 0.1, 1),
    Part::new("package", metamorphic::package, 2_000, 0.02, 1),
    Part::new("threads", threads::attack, 200, 0.07, 1),
];

/// Arguments of the command line.
#[derive(Clone, Debug)]
pub struct Asked {
    /// Time for all parts together [min]; if None, a fixed number of cases.
    pub minutes: Option<f64>,
    /// Seed of the first case of each part.
    pub seed: u64,
    /// Names of the parts; empty for all.
    pub only: Vec<String>,
    /// Number of cases of each part.
    pub count: Option<u64>,
    /// Whether the page is written: `attack.md`, or `attack_PART.md` for a single part.
    pub write: bool,
    /// Number of threads.
    pub threads: usize,
    /// Whether a case prints what it does.
    pub verbose: bool,
}

impl Default for Asked {
    fn default() -> Self {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Self { minutes: None, seed: 1, only: Vec::new(), count: None, write: false, threads, verbose: false }
    }
}

impl Asked {
    /// Read the arguments after `attack`.
    ///
    /// # Errors
    /// An unknown argument, a missing or invalid value, `--write` with some of the parts.
    pub fn read(words: &[&str]) -> Result<Self, String> {
        fn value<T: std::str::FromStr>(option: &str, word: Option<&&str>) -> Result<T, String> {
            let word = word.ok_or_else(|| format!("{option}: a value is missing"))?;
            word.parse().map_err(|_| format!("{option} {word}: not a value for this option"))
        }
        let (mut asked, mut words) = (Self::default(), words.iter());
        while let Some(option) = words.next() {
            match *option {
                "--minutes" => asked.minutes = Some(value(option, words.next())?),
                "--seed" => asked.seed = value(option, words.next())?,
                "--count" => asked.count = Some(value(option, words.next())?),
                "--threads" => asked.threads = value::<usize>(option, words.next())?.clamp(1, 256),
                "--only" => asked.only.push(value(option, words.next())?),
                "--write" => asked.write = true,
                "--verbose" => asked.verbose = true,
                other => {
                    let options = "--minutes N, --seed S, --only PART, --count N, --threads N, --verbose, --write";
                    return Err(format!("attack: {other}: the options are {options}"));
                }
            }
        }
        if let Some(name) = asked.only.iter().find(|name| PARTS.iter().all(|part| part.name != **name)) {
            let names = PARTS.map(|part| part.name).join(", ");
            return Err(format!("--only {name}: the parts are {names}"));
        }
        if asked.minutes.is_some_and(|minutes| !(minutes.is_finite() && minutes > 0.0)) {
            return Err("--minutes: must be a finite number > 0".into());
        }
        if asked.write && asked.only.len() > 1 {
            return Err("--write needs all parts, or one: leave --only out, or name one".into());
        }
        Ok(asked)
    }
}

/// Result of a part.
pub struct Outcome {
    /// The part.
    pub part: &'static Part,
    /// Results of its cases.
    pub tally: Tally,
    /// Elapsed time [s].
    pub seconds: f64,
}

/// `attack`: run, print, and write the page if requested.
///
/// # Errors
/// Invalid arguments, a failed case, or a page that cannot be written.
pub fn run(results: &Path, words: &[&str]) -> Result<(), String> {
    let asked = Asked::read(words)?;
    let outcomes = all(&asked);
    let page = page::page(&asked, &outcomes);
    println!("\n{page}");
    if asked.write {
        let name = asked.only.first().map_or("attack.md".to_owned(), |part| format!("attack_{part}.md"));
        let target = results.join(name);
        std::fs::write(&target, page).map_err(|e| format!("{}: {e}", target.display()))?;
        println!("written to {}", target.display());
    }
    match outcomes.iter().map(|outcome| outcome.tally.failures.len()).sum() {
        0 => Ok(()),
        failed => Err(format!("{failed} cases fail")),
    }
}

/// Run all selected parts, one after the other.
pub fn all(asked: &Asked) -> Vec<Outcome> {
    let those = || PARTS.iter().filter(|part| asked.only.is_empty() || asked.only.iter().any(|name| name == part.name));
    let shares: f64 = those().map(|part| part.share).sum();
    those()
        .map(|part| {
            let began = Instant::now();
            let time = asked.minutes.map(|minutes| Duration::from_secs_f64(60.0 * minutes * part.share / shares));
            let tally = cases(part, asked, time);
            let outcome = Outcome { part, tally, seconds: began.elapsed().as_secs_f64() };
            println!("{}", page::line(&outcome));
            outcome
        })
        .collect()
}

/// Run the cases of one part in several threads. A call that does not end ends the process after its seed is printed.
fn cases(part: &'static Part, asked: &Asked, time: Option<Duration>) -> Tally {
    let start = Instant::now();
    let count = asked.count.unwrap_or(if time.is_some() { u64::MAX } else { part.count });
    let (next, failed, done) = (AtomicU64::new(0), AtomicU64::new(0), AtomicBool::new(false));
    let pulses: Vec<Pulse> = (0..asked.threads).map(|_| Pulse::default()).collect();
    let work = |pulse| {
        let mut probe = Probe::new(start, pulse, asked.verbose);
        loop {
            let first = next.fetch_add(part.block, Ordering::Relaxed);
            for case in first..first.saturating_add(part.block) {
                let late = time.is_some_and(|time| start.elapsed() >= time);
                if case >= count || late || failed.load(Ordering::Relaxed) >= ENOUGH as u64 {
                    return probe.tally;
                }
                failed.fetch_add(u64::from(!judge(part, &mut probe, asked.seed.wrapping_add(case))), Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = pulses.iter().map(|pulse| scope.spawn(|| work(pulse))).collect();
        let watch = scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                std::thread::park_timeout(Duration::from_millis(500));
                pulses.iter().for_each(|pulse| watch(part, pulse, start));
            }
        });
        let mut tally = Tally::default();
        threads.into_iter().for_each(|thread| tally.add(thread.join().unwrap_or_default()));
        done.store(true, Ordering::Relaxed);
        watch.thread().unpark();
        tally
    })
}

/// End the process if a thread's call takes too long.
fn watch(part: &Part, pulse: &Pulse, start: Instant) {
    let since = pulse.since.load(Ordering::Relaxed);
    if since > 0 && milliseconds(start).saturating_sub(since) > PATIENCE {
        let seed = pulse.seed.load(Ordering::Relaxed);
        eprintln!("a call has not ended within {} s\n  {}", PATIENCE / 1000, again(part, seed));
        std::process::exit(1);
    }
}

/// The command that runs one case alone.
fn again(part: &Part, seed: u64) -> String {
    format!("cargo fmu bench attack --seed {seed} --only {} --count 1 --verbose", part.name)
}

/// Run a case; returns whether it passed.
fn judge(part: &Part, probe: &mut Probe, seed: u64) -> bool {
    probe.begin(seed);
    let longest = std::mem::take(&mut probe.tally.longest);
    let result = catch_unwind(AssertUnwindSafe(|| (part.case)(probe)));
    let own = std::mem::replace(&mut probe.tally.longest, longest);
    let result = match result {
        Err(payload) => {
            probe.prepared = None;
            let words = payload.downcast_ref::<String>().map(String::as_str);
            Err(format!("panic: {}", words.or(payload.downcast_ref::<&str>().copied()).unwrap_or_default()))
        }
        Ok(Ok(())) if own.value > LONGEST => Err(format!("{} took {:.1} s", own.what, own.value)),
        Ok(result) => result,
    };
    probe.tally.add(Tally { longest: own, ..Tally::default() });
    match result {
        Ok(()) => true,
        Err(why) => {
            println!("{}, seed {seed}: {why}\n  {}", part.name, again(part, seed));
            probe.tally.failures.push((seed, why));
            false
        }
    }
}
