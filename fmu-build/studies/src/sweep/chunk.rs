//! A chunk of runs: the unit in which a study is made, stored and resumed.
//!
//! In: a design, a runner, the number of the chunk. Out: its bytes: for each run the values of factors and responses,
//! then the remarks, each with its run and whether it is the reason of a failure.

use super::by_energy::{ByEnergy, Found};
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Remark<'a> {
    /// Whether it is the reason of a failure.
    pub is_failure: bool,
    /// One line of text.
    pub text: &'a str,
}

/// Consecutive runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows<'a> {
    /// Their numbers.
    pub runs: Range<u64>,
    /// The values of all columns, run by run.
    pub values: Vec<f64>,
    /// The remarks, each with the number of its run, ascending. A run without one has an empty remark.
    pub remarks: Vec<(u64, Remark<'a>)>,
}

impl<'a> Rows<'a> {
    /// The remark of each run.
    pub fn remark_of_each(&self) -> impl Iterator<Item = Remark<'a>> {
        let mut next = self.remarks.iter().peekable();
        self.runs.clone().map(move |run| next.next_if(|(own, _)| *own == run).map(|own| own.1).unwrap_or_default())
    }
}

/// The bytes of a chunk in progress.
#[derive(Debug, Default)]
pub struct Writer {
    values: Vec<[u8; 8]>,
    remarks: Vec<u8>,
}

impl Writer {
    /// Add the run with this index in the chunk.
    pub fn add(&mut self, index: u32, values: [&[f64]; 2], remark: Remark) {
        for part in values {
            self.values.extend(part.iter().map(|value| value.to_le_bytes()));
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
        let mut bytes = self.values.into_flattened();
        bytes.append(&mut self.remarks);
        bytes
    }
}

/// Make the runs of a chunk. None if the user stops the study. Responses from `by_energy` need no run, and states from
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
    let (count, factors) = ((runs.end - runs.start) as usize, design.factors().len());
    let mut writer = Writer { values: Vec::with_capacity(count * (factors + columns)), remarks: Vec::new() };
    let mut values = vec![0.0; columns];
    let mut points = vec![0.0; count * factors];
    for (index, run) in runs.enumerate() {
        design.point(run, &mut points[index * factors..][..factors]);
    }
    let found = by_energy.map_or(Found::Nothing, |by_energy| by_energy.find(&points, count));
    for index in 0..count {
        if stop_wish.load(Ordering::Relaxed) {
            return None;
        }
        let point = &points[index * factors..][..factors];
        if found.responses(index, &mut values) {
            writer.add(index as u32, [point, &values], Remark::default());
        } else {
            let (is_failure, text) = run_one(runner, point, found.state(index), &mut values);
            writer.add(index as u32, [point, &values], Remark { is_failure, text: &text });
        }
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

/// Read the bytes of a chunk with these runs and this number of columns.
///
/// # Errors
/// The bytes are no such chunk.
pub fn read(bytes: &[u8], runs: Range<u64>, columns: usize) -> Result<Rows<'_>> {
    let length = (runs.end - runs.start) as usize * columns * 8;
    let Some((numbers, mut rest)) = bytes.split_at_checked(length) else {
        bail!(
            "the journal (file runs.journal) is damaged: a part has {} bytes, but the runs of this part need \
            {length} bytes",
            bytes.len()
        );
    };
    let values = numbers.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let (mut remarks, mut left) = (Vec::new(), runs.clone());
    while let Some((index, remark)) = next_remark(&mut rest)? {
        let run = runs.start + index;
        if !left.contains(&run) {
            bail!(
                "the journal (file runs.journal) is damaged: a part contains a message of a run that belongs to \
                another part"
            );
        }
        left.start = run + 1;
        remarks.push((run, remark));
    }
    Ok(Rows { runs, values, remarks })
}

/// The next remark and the index of its run.
fn next_remark<'a>(bytes: &mut &'a [u8]) -> Result<Option<(u64, Remark<'a>)>> {
    if bytes.is_empty() {
        return Ok(None);
    }
    let mut take = |count: usize| {
        let (own, rest) = bytes
            .split_at_checked(count)
            .context("the journal (file runs.journal) is damaged: a part is incomplete")?;
        *bytes = rest;
        Ok::<_, anyhow::Error>(own)
    };
    let number = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().unwrap_or_default());
    let index = number(take(4)?);
    let is_failure = take(1)? != [0];
    let length = number(take(4)?) as usize;
    let text = std::str::from_utf8(take(length)?).context(
        "the journal (file runs.journal) is damaged: a message of \
        a run is not UTF-8 text",
    )?;
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
        let own = read(&bytes, 7..10, 3).unwrap();
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!((&own.runs, own.remark_of_each().count()), (&(7..10), 3));
        for ((k, (point, expected, is_failure, text)), remark) in rows.iter().enumerate().zip(own.remark_of_each()) {
            assert_eq!(bits(&own.values[3 * k..][..3]), bits(&[&point[..], &expected[..]].concat()));
            assert_eq!(remark, Remark { is_failure: *is_failure, text });
        }
        for cut in 0..bytes.len() {
            // If the cut is at the end of a remark, only the next remark is missing.
            let whole = read(&bytes[..cut], 7..10, 3).is_ok();
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
