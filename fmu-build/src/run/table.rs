//! The recorded variables: rows to a file as the run goes on, courses for a plot.
//!
//! In: a model at a time. Out: blocks of rows for the file's writer, each row the time and the values, Booleans as 1
//! and 0, NaN where a value does not exist; some of the rows, for a plot; which variables had no value, since when and
//! why.

use super::column::Column;
use super::file::Writer;
use super::missing::Missing;
use super::thinned::Thinned;
use anyhow::{Context, Result};
use linkage_fmu::component::Component;

/// Rows that are handed to the writer at once.
const BLOCK: usize = 1024;
/// Most rows that are kept for a plot.
const PLOTTED: usize = 1 << 14;

/// What a run has left.
pub struct Recorded {
    /// The recorded variables.
    pub columns: Vec<Column>,
    /// Values at the end, without the time; none of a run that came to none.
    pub last: Vec<f64>,
    /// Rows for a plot, each the time and the values.
    pub plotted: Vec<Vec<f64>>,
    /// Which variables had no value, since when and why: a line for each reason.
    pub missing: Vec<String>,
}

/// A table that grows.
pub struct Table {
    columns: Vec<Column>,
    /// Rows that the writer does not have yet; without a writer the last one read.
    block: Vec<f64>,
    writer: Option<Writer>,
    plotted: Option<Thinned<Vec<f64>>>,
    missing: Missing,
}

impl Table {
    /// A table of these columns, written to a file if there is a writer; `is_plotted`: rows are kept for a plot.
    pub fn new(columns: Vec<Column>, writer: Option<Writer>, is_plotted: bool) -> Self {
        let plotted = is_plotted.then(|| Thinned::new(PLOTTED));
        let missing = Missing::new(columns.len());
        Self { columns, block: Vec::new(), writer, plotted, missing }
    }

    /// Add the row of the model's present state. Nothing is read where neither file nor plot wants the row.
    ///
    /// # Errors
    /// The model refuses to tell a value; the file cannot be written.
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

    /// Write what is left; `last`: the model and its time, if the run came to an end.
    ///
    /// # Errors
    /// The file cannot be written; the model refuses to tell a value.
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
