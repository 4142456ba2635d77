//! CSV files of users: inputs over time, points of a study.
//!
//! In: a path. Out: the names of the columns and the lines, without surrounding blanks and without a byte order mark.
//! The module must not know what a column means.

use anyhow::{Context, Result, bail};
use std::fs::File;
use std::path::Path;

/// Characters that separate columns in the files of other programs.
const SEPARATORS: &str = ";\t|";

/// The reader after the header, and the names in it.
///
/// # Errors
/// The file cannot be read, or its columns are not separated by commas.
pub fn open(path: &Path) -> Result<(csv::Reader<File>, Vec<String>)> {
    let shown = path.display();
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_path(path)
        .with_context(|| format!("{shown}: the file cannot be read"))?;
    let header = reader.headers().with_context(|| format!("{shown}"))?;
    let name = |name: &str| name.trim_start_matches('\u{feff}').trim_matches('"').to_owned();
    let names: Vec<String> = header.iter().map(name).collect();
    if let Some(separator) = names.first().and_then(|first| first.chars().find(|c| SEPARATORS.contains(*c))) {
        bail!("{shown}: the columns are separated by {separator:?}; use commas between columns, and decimal points");
    }
    Ok((reader, names))
}
