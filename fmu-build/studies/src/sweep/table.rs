//! A table of results: the types of columns, and the functions of a file format.

use super::chunk::Rows;
use anyhow::Result;
use std::fs::File;

/// Type of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Numbers.
    Number,
    /// Booleans, with 1 for true.
    Truth,
    /// Texts, each given by its index.
    Text(Vec<String>),
}

/// A column of numbers, Booleans or texts.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its type.
    pub content: Content,
    /// Its unit. Empty for a column without unit.
    pub unit: String,
}

/// A format of tables. A row contains the number of the run, the values of the columns, whether it failed, and a
/// remark.
pub trait Format: Sized {
    /// Start the file. `seed` is that of the samples.
    ///
    /// # Errors
    /// The file cannot be written.
    fn begin(file: File, columns: &[Column], seed: Option<u64>) -> Result<Self>;
    /// Add rows.
    ///
    /// # Errors
    /// The file cannot be written.
    fn add(&mut self, rows: &Rows) -> Result<()>;
    /// End the file.
    ///
    /// # Errors
    /// The file cannot be written.
    fn end(self) -> Result<()>;
}

/// Names of the columns of every table: number of the run, whether it failed, remark.
pub const OWN: [&str; 3] = ["run", "failed", "message"];
