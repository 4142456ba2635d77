//! A table as CSV in the format of FMPy.
//!
//! In: rows. Out: lines with the column `time` first. Every number has the fewest digits from which it can be read
//! back.

use super::column::Column;
use super::file::Format;
use anyhow::Result;
use std::fs::File;
use std::io::{self, BufWriter, Write};

/// The file.
pub struct Csv {
    file: BufWriter<File>,
    /// For each column, whether it is a Boolean.
    booleans: Vec<bool>,
}

impl Format for Csv {
    fn begin(file: File, columns: &[Column]) -> Result<Self> {
        let names = std::iter::once("time").chain(columns.iter().map(|column| &*column.name));
        let mut header = csv::WriterBuilder::new().quote_style(csv::QuoteStyle::Always).from_writer(Vec::new());
        header.write_record(names)?;
        let mut file = BufWriter::new(file);
        file.write_all(&header.into_inner().unwrap_or_default())?;
        Ok(Self { file, booleans: columns.iter().map(|column| column.is_boolean).collect() })
    }

    #[inline]
    fn write(&mut self, rows: &[f64]) -> Result<()> {
        for row in rows.chunks_exact(self.booleans.len() + 1) {
            self.write_row(row)?;
        }
        Ok(self.file.flush()?)
    }

    fn end(mut self) -> Result<()> {
        Ok(self.file.flush()?)
    }
}

impl Csv {
    /// One line of the file.
    #[inline]
    fn write_row(&mut self, row: &[f64]) -> io::Result<()> {
        let mut digits = zmij::Buffer::new();
        self.file.write_all(decimal(&mut digits, row[0]))?;
        for (value, is_boolean) in row[1..].iter().zip(&self.booleans) {
            self.file.write_all(b",")?;
            match is_boolean {
                true => self.file.write_all(if *value == 0.0 { b"0" } else { b"1" })?,
                false => self.file.write_all(decimal(&mut digits, *value))?,
            }
        }
        self.file.write_all(b"\n")
    }
}

/// The fewest digits from which a number can be read back. NaN and infinity are words that CSV readers know.
#[inline]
pub fn decimal(digits: &mut zmij::Buffer, value: f64) -> &[u8] {
    if value.is_finite() {
        digits.format_finite(value).as_bytes()
    } else if value.is_nan() {
        b"nan"
    } else if value > 0.0 {
        b"inf"
    } else {
        b"-inf"
    }
}
