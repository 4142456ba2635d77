//! A table of results: what a column holds, what a format of files must do.

use super::chunk::Remark;
use anyhow::Result;
use std::fs::File;

/// What a column holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Numbers.
    Number,
    /// Truth values, 1 for true.
    Truth,
    /// Texts, each told by its index.
    Text(Vec<String>),
}

/// A column of numbers, truth values or texts.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub content: Content,
    /// Its unit; empty where it has none.
    pub unit: String,
}

/// A format of tables. A row has the number of the run, the values of the columns, whether it failed, and a remark.
pub trait Format: Sized {
    /// Begin the file; `seed`: of the samples.
    ///
    /// # Errors
    /// It cannot be written.
    fn begin(file: File, columns: &[Column], seed: Option<u64>) -> Result<Self>;
    /// Add a row.
    ///
    /// # Errors
    /// The file cannot be written.
    fn add(&mut self, run: u64, values: &[f64], remark: Remark) -> Result<()>;
    /// End the file.
    ///
    /// # Errors
    /// The file cannot be written.
    fn end(self) -> Result<()>;
}

/// Names of the columns that every table has: number of the run, whether it failed, remark.
pub const OWN: [&str; 3] = ["run", "failed", "message"];
