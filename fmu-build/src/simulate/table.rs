//! The recorded variables: rows to a file as the run goes on, courses for a plot.
//!
//! In: a model at a time. Out: CSV with the column `time` first, Booleans as 1 and 0, NaN where a value does not exist;
//! every number in the fewest digits that give it back. A thread of its own writes it, block by block, so that memory
//! stays constant.

use anyhow::{Context, Result, anyhow};
use linkage_fmu::component::{Component, Refused};
use linkage_fmu::variables::{Kind, Reference, Unit, Variable};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;

/// Rows that are handed to the writing thread at once.
const BLOCK: usize = 1024;
/// Blocks that may wait for it.
const WAITING: usize = 8;
/// Most rows that are kept for a plot; of more, every second one is dropped.
const PLOTTED: usize = 1 << 14;

/// A variable to record.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    reference: Reference,
    /// Name of the variable.
    pub name: String,
    /// Its unit.
    pub unit: Option<Unit>,
    is_boolean: bool,
}

impl Column {
    /// The column of a Real or a Boolean.
    pub fn new(reference: Reference, variable: &Variable) -> Self {
        let is_boolean = variable.kind == Kind::Boolean;
        Self { reference, name: variable.name.clone(), unit: variable.unit, is_boolean }
    }

    fn read(&self, model: &mut Component) -> Result<f64, Refused> {
        match self.is_boolean {
            true => Ok(f64::from(u8::from(model.boolean(self.reference)?))),
            false => model.real(self.reference),
        }
    }
}

/// What a run has left.
pub struct Recorded {
    /// The recorded variables.
    pub columns: Vec<Column>,
    /// Number of rows.
    pub rows: u64,
    /// Values in the last row, without the time.
    pub last: Vec<f64>,
    /// Rows for a plot, each the time and the values.
    pub plotted: Vec<Vec<f64>>,
}

/// A table that grows.
pub struct Table {
    recorded: Recorded,
    /// Rows that the writing thread does not have yet.
    block: Vec<f64>,
    writer: Option<Writer>,
    /// Of how many rows one is kept for the plot; 0: none.
    stride: u64,
}

/// The thread that writes.
struct Writer {
    blocks: SyncSender<Vec<f64>>,
    /// Blocks that are written, to be filled again.
    empty: Receiver<Vec<f64>>,
    thread: JoinHandle<io::Result<()>>,
    shown: String,
}

impl Table {
    /// A table of these columns, written to a file if one is named; `is_plotted`: rows are kept for a plot.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn new(columns: Vec<Column>, path: Option<&Path>, is_plotted: bool) -> Result<Self> {
        let writer = path.map(|path| Writer::new(path, &columns)).transpose()?;
        let recorded = Recorded { columns, rows: 0, last: Vec::new(), plotted: Vec::new() };
        Ok(Self { recorded, block: Vec::new(), writer, stride: u64::from(is_plotted) })
    }

    /// Add the row of the model's present state.
    ///
    /// # Errors
    /// The model refuses to tell a value; the file cannot be written.
    pub fn record(&mut self, model: &mut Component, time: f64) -> Result<()> {
        let start = self.block.len();
        self.block.push(time);
        for column in &self.recorded.columns {
            let value = column.read(model).with_context(|| format!("{} at {time} s", column.name));
            match value {
                Ok(value) => self.block.push(value),
                Err(error) => {
                    self.block.truncate(start);
                    return Err(error);
                }
            }
        }
        self.recorded.rows += 1;
        if self.stride > 0 && (self.recorded.rows - 1).is_multiple_of(self.stride) {
            self.keep(start);
        }
        if self.block.len() >= BLOCK * (self.recorded.columns.len() + 1) {
            self.hand_over()?;
        }
        Ok(())
    }

    /// Keep the last row for the plot.
    fn keep(&mut self, start: usize) {
        self.recorded.plotted.push(self.block[start..].to_vec());
        if self.recorded.plotted.len() >= PLOTTED {
            let mut index = 0_usize;
            self.recorded.plotted.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.stride *= 2;
        }
    }

    /// Hand the block to the writing thread.
    fn hand_over(&mut self) -> Result<()> {
        let width = self.recorded.columns.len() + 1;
        if let Some(last) = self.block.chunks_exact(width).last() {
            self.recorded.last.clear();
            self.recorded.last.extend_from_slice(&last[1..]);
        }
        match &mut self.writer {
            None => self.block.clear(),
            Some(writer) => {
                let mut next = writer.empty.try_recv().unwrap_or_default();
                next.clear();
                if writer.blocks.send(std::mem::replace(&mut self.block, next)).is_err() {
                    return Err(self.failed());
                }
            }
        }
        Ok(())
    }

    /// Why the writing thread has ended.
    fn failed(&mut self) -> anyhow::Error {
        match self.writer.take() {
            Some(writer) => writer.end().err().unwrap_or_else(|| anyhow!("the output file was closed")),
            None => anyhow!("the output file was closed"),
        }
    }

    /// Write what is left.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self) -> Result<Recorded> {
        self.hand_over()?;
        if let Some(writer) = self.writer.take() {
            writer.end()?;
        }
        Ok(self.recorded)
    }
}

impl Writer {
    fn new(path: &Path, columns: &[Column]) -> Result<Self> {
        let shown = path.display().to_string();
        let mut file = File::create(path).map(BufWriter::new).with_context(|| format!("{shown}: cannot be made"))?;
        let names: Vec<&str> = std::iter::once("time").chain(columns.iter().map(|column| &*column.name)).collect();
        let (width, booleans) = (names.len(), columns.iter().map(|column| column.is_boolean).collect::<Vec<_>>());
        let mut header = csv::WriterBuilder::new().quote_style(csv::QuoteStyle::Always).from_writer(Vec::new());
        header.write_record(&names)?;
        file.write_all(&header.into_inner().unwrap_or_default()).with_context(|| shown.clone())?;
        let (blocks, waiting): (_, Receiver<Vec<f64>>) = sync_channel(WAITING);
        let (done, empty): (Sender<Vec<f64>>, _) = channel();
        let thread = std::thread::spawn(move || {
            for block in waiting {
                for row in block.chunks_exact(width) {
                    write_row(&mut file, row, &booleans)?;
                }
                file.flush()?;
                // The run may be over.
                let _ = done.send(block);
            }
            file.flush()
        });
        Ok(Self { blocks, empty, thread, shown })
    }

    /// Wait until all is written.
    fn end(self) -> Result<()> {
        drop(self.blocks);
        let written = self.thread.join().map_err(|_| anyhow!("{}: the writing thread panicked", self.shown))?;
        written.with_context(|| format!("{}: cannot be written", self.shown))
    }
}

/// One line of the file.
fn write_row(file: &mut impl Write, row: &[f64], booleans: &[bool]) -> io::Result<()> {
    let mut digits = zmij::Buffer::new();
    let mut number = |file: &mut dyn Write, value: f64| match value.is_finite() {
        true => file.write_all(digits.format_finite(value).as_bytes()),
        false => write!(
            file,
            "{}",
            if value.is_nan() {
                "nan"
            } else if value > 0.0 {
                "inf"
            } else {
                "-inf"
            }
        ),
    };
    number(file, row[0])?;
    for (value, is_boolean) in row[1..].iter().zip(booleans) {
        file.write_all(b",")?;
        match is_boolean {
            true => file.write_all(if *value == 0.0 { b"0" } else { b"1" })?,
            false => number(file, *value)?,
        }
    }
    file.write_all(b"\n")
}
