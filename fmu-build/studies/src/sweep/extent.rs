//! Disk space and time of a large study, reported before its start.
//!
//! In: the number of runs and of columns, a measured run. Out: one line of text for a large study.

use super::chunk::Cut;
use super::design::Design;
use super::run::{Runner, Task};
use anyhow::{Result, bail};
use linkage_fmu::component::Component;
use std::time::Instant;

/// Number of runs above which a study is large.
const MANY: u64 = 1_000_000_000;
/// Largest number of runs: the list of the parts to make then needs 1 GB.
const MOST: u64 = 100_000_000_000;
/// Number of measured runs, after one run that builds the tables.
const MEASURED: u64 = 3;

/// The warning about a study before its start. None if it is not large. A few of its runs are made.
///
/// # Errors
/// As for `model`, or the model rejects common values of all runs, or there are more than [`MOST`] runs.
pub fn warning(
    task: &Task,
    design: &Design,
    cut: &Cut,
    model: impl FnOnce() -> Result<Component>,
) -> Result<Option<String>> {
    if design.runs() <= MANY {
        return Ok(None);
    }
    if design.runs() > MOST {
        bail!(
            "{} runs, but at most {MOST} are allowed; use fewer values for the factors, or samples (sampling) \
             instead of a full grid",
            design.runs()
        );
    }
    let (mut runner, mut design) = (Runner::new(task, model()?)?, design.clone());
    let (mut point, mut values) = (vec![0.0; task.factors.len()], vec![f64::NAN; task.responses.columns.len()]);
    let mut began = Instant::now();
    for run in 0..=MEASURED {
        if run == 1 {
            began = Instant::now();
        }
        design.point(run, &mut point);
        if runner.run(&point, None, &mut values).is_err() {
            runner.renew();
        }
    }
    let seconds = began.elapsed().as_secs_f64() / MEASURED as f64;
    // In addition to the columns, a row contains its number.
    let bytes = 8.0 * (task.factors.len() + values.len() + 1) as f64;
    Ok(Some(announcement(design.runs(), cut.chunks(), bytes, seconds)))
}

/// The line for this number of runs, with the size of a row in bytes and the time of a run [s].
fn announcement(runs: u64, chunks: u64, bytes: f64, seconds: f64) -> String {
    let all = runs as f64;
    format!(
        "{runs} runs: the results will need about {} on the disk. Until all runs are complete, the study needs the \
         same space a second time. If each run needs {}, as the first runs did, the study will need about {} on one \
         core. You can stop the study: --resume continues after the last complete part of its {chunks} parts. For a \
         smaller study, use fewer values for the factors, or samples (sampling) instead of a full grid",
        amount(all * bytes, &BYTES),
        amount(seconds, &TIMES),
        amount(all * seconds, &TIMES)
    )
}

const BYTES: [(f64, &str); 5] = [(1.0, "B"), (1e6, "MB"), (1e9, "GB"), (1e12, "TB"), (1e15, "PB")];
const TIMES: [(f64, &str); 6] =
    [(1e-6, "us"), (1e-3, "ms"), (1.0, "s"), (3600.0, "hours"), (86_400.0, "days"), (31_557_600.0, "years")];

/// A quantity with two digits in the largest unit in which it is at least 1.
fn amount(value: f64, units: &[(f64, &str)]) -> String {
    let (unit, name) = units.iter().rev().find(|(unit, _)| value >= *unit).unwrap_or(&units[0]);
    let value = value / unit;
    let digits = usize::from(value < 10.0);
    format!("{value:.digits$} {name}")
}

#[cfg(test)]
mod tests {
    use super::{BYTES, TIMES, amount, announcement};

    #[test]
    fn amounts_have_the_largest_unit() {
        for (value, shown) in
            [(2e-8, "0.0 us"), (2.34e-5, "23 us"), (0.01, "10 ms"), (7.16, "7.2 s"), (3e4, "8.3 hours")]
        {
            assert_eq!(amount(value, &TIMES), shown);
        }
        assert_eq!(amount(1e10, &TIMES), "317 years");
        assert_eq!(amount(9.6e10, &BYTES), "96 GB");
    }

    #[test]
    fn a_large_study_is_announced_with_its_size_and_its_time() {
        let line = announcement(10_000_000_000, 9_765_625, 40.0, 2e-5);
        assert!(line.starts_with("10000000000 runs: the results will need about 400 GB on the disk"), "{line}");
        assert!(line.contains("If each run needs 20 us") && line.contains("about 2.3 days on one core"), "{line}");
    }
}
