//! The recorded rows as Apache Parquet: the column `time` and Reals as DOUBLE, Booleans as BOOLEAN.

use crate::parquet_file::{Table, VALUES, Values};
use anyhow::Result;
use fmu_build::run::column::Column;
use fmu_build::run::file::Format;
use std::fs::File;

/// The file.
pub struct Parquet {
    table: Table,
    /// Number of rows of the present row group.
    rows: usize,
}

impl Format for Parquet {
    fn begin(file: File, columns: &[Column]) -> Result<Self> {
        let capacity = VALUES / (1 + columns.len());
        let values = |column: &Column| match column.is_boolean {
            true => Values::Truths(Vec::with_capacity(capacity)),
            false => Values::Numbers(Vec::with_capacity(capacity)),
        };
        let time = ("time", Values::Numbers(Vec::with_capacity(capacity)));
        let all = std::iter::once(time).chain(columns.iter().map(|column| (&*column.name, values(column))));
        let unit = |column: &Column| Some((column.name.clone(), column.unit?.name().into()));
        let units = std::iter::once(("time".to_owned(), "s".into())).chain(columns.iter().filter_map(unit)).collect();
        Ok(Self { table: Table::begin(file, all, units, None)?, rows: 0 })
    }

    fn write(&mut self, rows: &[f64]) -> Result<()> {
        let width = self.table.columns.len();
        for row in rows.chunks_exact(width) {
            for (column, value) in self.table.columns.iter_mut().zip(row) {
                match column {
                    Values::Numbers(numbers) => numbers.push(*value),
                    Values::Truths(truths) => truths.push(*value != 0.0),
                    // A run records none of these types.
                    Values::Whole(_) | Values::Texts(_) => {}
                }
            }
            self.rows += 1;
        }
        if width * self.rows >= VALUES { self.write_group() } else { Ok(()) }
    }

    fn end(mut self) -> Result<()> {
        if self.rows > 0 {
            self.write_group()?;
        }
        self.table.end()
    }
}

impl Parquet {
    fn write_group(&mut self) -> Result<()> {
        self.rows = 0;
        self.table.write_group()
    }
}
