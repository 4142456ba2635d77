//! The results of a study: a row for each run, in order, as Parquet and CSV.
//!
//! In: the completed chunks. Out: complete files, or none. The memory use is constant.

use super::chunk::{self, Cut, Remark, Rows};
use super::csv::Csv;
use super::journal::Journal;
use super::parquet::Parquet;
use super::run::Task;
use super::table::{Column, Content, Format, OWN};
use anyhow::{Context, Result, bail};
use linkage_fmu::variables::Kind;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// The columns between the number of the run and the flag of failure: factors and responses.
///
/// # Errors
/// Two columns have the same name.
pub fn columns(task: &Task) -> Result<Vec<Column>> {
    let factors = task.factors.iter().map(|factor| {
        let content = match factor.kind {
            Kind::Real => Content::Number,
            Kind::Boolean => Content::Truth,
            Kind::Enumeration => Content::Text(factor.texts.clone()),
        };
        let unit = factor.unit.map_or(String::new(), |unit| unit.name().to_owned());
        Column { name: factor.name.clone(), content, unit }
    });
    let responses = task.responses.columns.iter().cloned().zip(task.responses.units.iter().cloned());
    let responses = responses.map(|(name, unit)| Column { name, content: Content::Number, unit });
    let all: Vec<Column> = factors.chain(responses).collect();
    for (index, column) in all.iter().enumerate() {
        if all[..index].iter().any(|other| other.name == column.name) || OWN.contains(&&*column.name) {
            bail!("responses: two columns of the results would have the name \"{}\"; rename the response", column.name);
        }
    }
    Ok(all)
}

/// Number of failed runs and of remarks in a study.
#[derive(Debug, Default)]
pub struct Unusual {
    /// Runs that failed.
    pub failed: u64,
    /// Reason of the first failure.
    pub reason: String,
    /// Failed runs with another reason.
    pub others: u64,
    /// Number of other runs with a remark, such as an event that did not happen.
    pub remarked: u64,
    /// The first such remark.
    pub first: String,
}

impl Unusual {
    /// Count a run with this remark.
    fn count(&mut self, remark: &Remark) {
        if remark.is_failure {
            self.failed += 1;
            if self.failed == 1 {
                self.reason = remark.text.to_owned();
            }
            self.others += u64::from(self.reason != remark.text);
        }
        if !remark.is_failure && !remark.text.is_empty() {
            self.remarked += 1;
            if self.remarked == 1 {
                self.first = remark.text.to_owned();
            }
        }
    }
}

/// Write the results of all chunks. Returns the number of failed runs and remarks.
///
/// # Errors
/// A chunk is missing or damaged, or a file cannot be written. An old file then remains.
pub fn write(
    journal: &mut Journal,
    cut: &Cut,
    (columns, seed): (&[Column], Option<u64>),
    parquet: &Path,
    csv: Option<&Path>,
) -> Result<Unusual> {
    let mut parquet = Partial::<Parquet>::begin(parquet, columns, seed)?;
    let mut csv = csv.map(|path| Partial::<Csv>::begin(path, columns, seed)).transpose()?;
    let (mut next, mut unusual) = (0, Unusual::default());
    journal.replay(|chunk, bytes| {
        let runs = cut.runs_of(chunk);
        if runs.start != next {
            bail!(
                "run {next} is missing in the journal (file runs.journal); to start the study again, remove this file"
            );
        }
        next = runs.end;
        let rows = chunk::read(bytes, runs, columns.len())?;
        rows.remarks.iter().for_each(|(_, remark)| unusual.count(remark));
        parquet.add(&rows)?;
        csv.as_mut().map_or(Ok(()), |csv| csv.add(&rows))
    })?;
    if next != cut.runs_of(cut.chunks() - 1).end {
        bail!("run {next} is missing in the journal (file runs.journal); to start the study again, remove this file");
    }
    parquet.end()?;
    csv.map_or(Ok(()), Partial::end)?;
    Ok(unusual)
}

/// A file that gets its name when it is complete. Otherwise it is removed.
pub struct Partial<F> {
    /// Closed before the file is removed.
    format: F,
    path: PathBuf,
    partial: Unfinished,
}

/// A file that is removed when this value is dropped, unless it was renamed.
struct Unfinished(PathBuf);

impl Drop for Unfinished {
    fn drop(&mut self) {
        // The space on a full disk is released. After a rename nothing is removed.
        let _ = fs::remove_file(&self.0);
    }
}

impl<F: Format> Partial<F> {
    /// Start the file for this path.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(path: &Path, columns: &[Column], seed: Option<u64>) -> Result<Self> {
        let mut partial = path.as_os_str().to_owned();
        partial.push(".partial");
        let partial = Unfinished(PathBuf::from(partial));
        let shown = || partial.0.display();
        let file = File::create(&partial.0).with_context(|| format!("{}: cannot be created", shown()))?;
        let format = F::begin(file, columns, seed).with_context(|| format!("{}: cannot be written", shown()))?;
        Ok(Self { format, path: path.to_path_buf(), partial })
    }

    /// Add rows.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, rows: &Rows) -> Result<()> {
        self.format.add(rows).with_context(|| format!("{}: cannot be written", self.partial.0.display()))
    }

    /// Give the file its final name.
    ///
    /// # Errors
    /// The file cannot be renamed.
    pub fn end(self) -> Result<()> {
        let shown = || format!("{}: cannot be written", self.path.display());
        self.format.end().with_context(shown)?;
        fs::rename(&self.partial.0, &self.path).with_context(shown)
    }
}
