//! The recorded variables: rows for a file during the run, and time series for a plot.
//!
//! In: a model at a time. Out: blocks of rows for the file's writer. Each row contains the time and the values, with
//! Booleans as 1 and 0, and NaN for a missing value. Also some of the rows for a plot, and the variables without a
//! value, with time and reason.

use super::column::Column;
use super::file::Writer;
use super::missing::Missing;
use super::thinned::Thinned;
use anyhow::{Context, Result};
use linkage_fmu::component::Component;

/// Number of rows that are passed to the writer at once.
const BLOCK: usize = 1024;
/// Largest number of rows that are kept for a plot.
const PLOTTED: usize = 1 << 14;

/// Recorded data of a run.
pub struct Recorded {
    /// The recorded variables.
    pub columns: Vec<Column>,
    /// Values at the end, without the time. Empty if the run did not reach its end.
    pub last: Vec<f64>,
    /// Rows for a plot, each the time and the values.
    pub plotted: Vec<Vec<f64>>,
    /// Variables without a value, with time and reason: a line for each reason.
    pub missing: Vec<String>,
}

/// A table during the run.
pub struct Table {
    columns: Vec<Column>,
    /// Rows that were not passed to the writer yet. Without a writer, the last row.
    block: Vec<f64>,
    writer: Option<Writer>,
    plotted: Option<Thinned<Vec<f64>>>,
    missing: Missing,
}

impl Table {
    /// A table with these columns, written to a file if there is a writer. `is_plotted`: rows are kept for a plot.
    pub fn new(columns: Vec<Column>, writer: Option<Writer>, is_plotted: bool) -> Self {
        let plotted = is_plotted.then(|| Thinned::new(PLOTTED));
        let missing = Missing::new(columns.len());
        Self { columns, block: Vec::new(), writer, plotted, missing }
    }

    /// Add the row of the present state. If neither file nor plot needs the row, nothing is read.
    ///
    /// # Errors
    /// The model rejects reading a value, or the file cannot be written.
    #[inline]
    pub fn record(&mut self, model: &mut Component, time: f64) -> Result<()> {
        let is_plotted = self.plotted.as_mut().is_some_and(Thinned::wants_next);
        if self.writer.is_some() || is_plotted {
            self.read(model, time)?;
        }
        if let Some(plotted) = self.plotted.as_mut().filter(|_| is_plotted) {
            plotted.keep(self.block[self.block.len() - self.columns.len() - 1..].to_vec());
        }
        match &mut self.writer {
            Some(writer) if self.block.len() >= BLOCK * (self.columns.len() + 1) => writer.write(&mut self.block),
            _ => Ok(()),
        }
    }

    /// Read the row of the present state into the block.
    #[inline]
    fn read(&mut self, model: &mut Component, time: f64) -> Result<()> {
        if self.writer.is_none() {
            self.block.clear();
        }
        let start = self.block.len();
        self.block.push(time);
        for column in &self.columns {
            match column.read(model) {
                Ok(value) => self.block.push(value),
                Err(refused) => {
                    self.block.truncate(start);
                    return Err(refused).with_context(|| format!("{} at {time} s", column.name));
                }
            }
        }
        self.missing.see(&self.block[start..], |index| model.undefined(self.columns[index].reference));
        Ok(())
    }

    /// Write the remaining rows. `last`: the model and its time, if the run has reached its end.
    ///
    /// # Errors
    /// The file cannot be written, or the model rejects reading a value.
    pub fn finish(mut self, last: Option<(&mut Component, f64)>) -> Result<Recorded> {
        if let Some(writer) = &mut self.writer {
            writer.write(&mut self.block)?;
            writer.end()?;
        }
        self.writer = None;
        let mut plotted = self.plotted.take().map_or_else(Vec::new, Thinned::into_items);
        let mut values = Vec::new();
        if let Some((model, time)) = last {
            self.read(model, time)?;
            values.extend_from_slice(&self.block[1..]);
            if plotted.last().is_some_and(|row| row[0] < time) {
                plotted.push(self.block);
            }
        }
        let names: Vec<_> = self.columns.iter().map(|column| &*column.name).collect();
        let missing = self.missing.lines(&names);
        Ok(Recorded { columns: self.columns, last: values, plotted, missing })
    }
}
