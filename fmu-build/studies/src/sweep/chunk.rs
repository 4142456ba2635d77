//! A chunk of runs: the unit in which a study is made, stored and resumed.
//!
//! In: a design, a runner, the number of the chunk. Out: its bytes: for each run the values of factors and responses,
//! then the remarks, each with its run and whether it is the reason of a failure.

use super::by_energy::ByEnergy;
use super::design::Design;
use super::run::Runner;
use anyhow::{Context, Result, bail};
use linkage_fmu::component::Waypoint;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

/// Largest number of runs of a chunk.
const MOST: u64 = 1024;
/// Smallest number of chunks of a study, if it has as many runs.
const FEWEST: u64 = 256;

/// Division of the runs of a study into chunks.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    runs: u64,
    each: u64,
}

impl Cut {
    /// Chunks for this number of runs: small chunks if there are few runs, so that all threads have some.
    pub fn new(runs: u64) -> Self {
        Self { runs, each: (runs / FEWEST).clamp(1, MOST) }
    }

    /// Number of chunks.
    pub fn chunks(&self) -> u64 {
        self.runs.div_ceil(self.each)
    }

    /// The runs of a chunk.
    pub fn runs_of(&self, chunk: u64) -> Range<u64> {
        chunk * self.each..((chunk + 1) * self.each).min(self.runs)
    }
}

/// A remark about a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Remark<'a> {
    /// Whether it is the reason of a failure.
    pub is_failure: bool,
    /// One line of text.
    pub text: &'a str,
}

/// The bytes of a chunk in progress.
#[derive(Debug, Default)]
pub struct Writer {
    values: Vec<u8>,
    remarks: Vec<u8>,
}

impl Writer {
    /// Add the run with this index in the chunk.
    pub fn add(&mut self, index: u32, values: [&[f64]; 2], remark: Remark) {
        for value in values.into_iter().flatten() {
            self.values.extend_from_slice(&value.to_le_bytes());
        }
        if remark.is_failure || !remark.text.is_empty() {
            self.remarks.extend(index.to_le_bytes());
            self.remarks.push(u8::from(remark.is_failure));
            self.remarks.extend((remark.text.len() as u32).to_le_bytes());
            self.remarks.extend(remark.text.as_bytes());
        }
    }

    /// All bytes of the chunk.
    pub fn finish(mut self) -> Vec<u8> {
        self.values.append(&mut self.remarks);
        self.values
    }
}

/// Make the runs of a chunk. None if the user stops the study. Times from `by_energy` need no run, and states from
/// `by_energy` need no steps.
pub fn make(
    cut: &Cut,
    chunk: u64,
    (design, by_energy): (&mut Design, Option<&ByEnergy>),
    runner: &mut Runner,
    columns: usize,
    stop_wish: &AtomicBool,
) -> Option<Vec<u8>> {
    let runs = cut.runs_of(chunk);
    let (mut writer, mut point, mut values) = (Writer::default(), Vec::new(), vec![0.0; columns]);
    let count = (runs.end - runs.start) as usize;
    let (mut points, mut times, mut states) = (Vec::new(), vec![f64::NAN; count], vec![None; count]);
    for run in runs {
        design.point(run, &mut point);
        points.extend_from_slice(&point);
    }
    if let Some(by_energy) = by_energy {
        by_energy.find(&points, &mut times, &mut states);
    }
    for (index, (time, state)) in times.iter().zip(states).enumerate() {
        if stop_wish.load(Ordering::Relaxed) {
            return None;
        }
        let point = &points[index * point.len()..][..point.len()];
        let (is_failure, text) = if time.is_nan() {
            run_one(runner, point, state, &mut values)
        } else {
            values.fill(*time);
            (false, String::new())
        };
        writer.add(index as u32, [point, &values], Remark { is_failure, text: &text });
    }
    Some(writer.finish())
}

/// Make one run. Returns whether it failed, and a remark or the reason. A panic counts as a failure.
pub fn run_one(runner: &mut Runner, point: &[f64], state: Option<Waypoint>, values: &mut [f64]) -> (bool, String) {
    match catch_unwind(AssertUnwindSafe(|| runner.run(point, state, values))) {
        Ok(Ok(remark)) => (false, remark),
        Ok(Err(error)) => (true, format!("{error:#}")),
        Err(_) => {
            runner.renew();
            values.fill(f64::NAN);
            (true, "an internal fault stopped the run; please report it".to_owned())
        }
    }
}

/// Read the bytes of a chunk. `take` is called for each run with its index, its values, and its remark.
///
/// # Errors
/// The bytes are no chunk with this number of runs and columns; an error of `take`.
pub fn read(
    bytes: &[u8],
    runs: u64,
    columns: usize,
    mut take: impl FnMut(u64, &[f64], Remark) -> Result<()>,
) -> Result<()> {
    let length = runs as usize * columns * 8;
    let Some((numbers, mut remarks)) = bytes.split_at_checked(length) else {
        bail!("a part of the journal has {} bytes, but the runs of this part need {length} bytes", bytes.len());
    };
    let mut next = next_remark(&mut remarks)?;
    let mut values = vec![0.0; columns];
    for run in 0..runs {
        let own = &numbers[run as usize * columns * 8..];
        for (value, bytes) in values.iter_mut().zip(own.chunks_exact(8)) {
            *value = f64::from_le_bytes(bytes.try_into().unwrap_or_default());
        }
        let remark = match next {
            Some((index, remark)) if index == run => {
                next = next_remark(&mut remarks)?;
                remark
            }
            _ => Remark { is_failure: false, text: "" },
        };
        take(run, &values, remark)?;
    }
    if next.is_some() {
        bail!("a part of the journal contains a message of a run that belongs to another part");
    }
    Ok(())
}

/// The next remark and the index of its run.
fn next_remark<'a>(bytes: &mut &'a [u8]) -> Result<Option<(u64, Remark<'a>)>> {
    if bytes.is_empty() {
        return Ok(None);
    }
    let mut take = |count: usize| {
        let (own, rest) = bytes.split_at_checked(count).context("a part of the journal is incomplete")?;
        *bytes = rest;
        Ok::<_, anyhow::Error>(own)
    };
    let number = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().unwrap_or_default());
    let index = number(take(4)?);
    let is_failure = take(1)? != [0];
    let length = number(take(4)?) as usize;
    let text = std::str::from_utf8(take(length)?).context("a message of a run in the journal is not UTF-8 text")?;
    Ok(Some((u64::from(index), Remark { is_failure, text })))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_is_read_as_it_was_written() {
        let rows =
            [([1.0], [2.0, f64::NAN], false, ""), ([3.0], [-0.0, 5.0], true, "why"), ([6.0], [7.0, 8.0], false, "ä")];
        let mut writer = Writer::default();
        for ((point, values, is_failure, text), index) in rows.iter().zip(0..) {
            writer.add(index, [point, values], Remark { is_failure: *is_failure, text });
        }
        let bytes = writer.finish();
        let mut count = 0;
        read(&bytes, 3, 3, |run, values, remark| {
            let (point, expected, is_failure, text) = &rows[run as usize];
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(values), bits(&[&point[..], &expected[..]].concat()));
            assert_eq!(remark, Remark { is_failure: *is_failure, text });
            count += 1;
            Ok(())
        })
        .unwrap();
        assert_eq!(count, 3);
        for cut in 0..bytes.len() {
            // If the cut is at the end of a remark, only the next remark is missing.
            let whole = read(&bytes[..cut], 3, 3, |_, _, _| Ok(())).is_ok();
            assert!(!whole || [72, 84].contains(&cut), "{cut}");
        }
    }

    #[test]
    fn chunks_cover_all_runs_once() {
        for runs in [1, 2, 255, 256, 257, 1000, 300_000] {
            let cut = Cut::new(runs);
            let mut next = 0;
            for chunk in 0..cut.chunks() {
                let own = cut.runs_of(chunk);
                assert!(own.start == next && own.end > next && own.end - own.start <= MOST);
                next = own.end;
            }
            assert_eq!(next, runs);
        }
    }
}
