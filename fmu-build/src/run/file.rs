//! The file of the recorded rows. A separate thread writes it block by block, so that the memory use is constant.
//!
//! In: a path, a format, and blocks of rows. Out: the complete file, which replaces an old file at the end. The module
//! must not know what the values mean.

use super::column::Column;
use crate::files::{Replacement, unwritten};
use anyhow::{Context, Result, anyhow};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;

/// Number of blocks that may wait for the writing thread.
const WAITING: usize = 8;

/// A format of tables. A row consists of the time and the values of the columns.
pub trait Format: Send + Sized + 'static {
    /// Start the file.
    fn begin(file: File, columns: &[Column]) -> Result<Self>;
    /// Add rows.
    fn write(&mut self, rows: &[f64]) -> Result<()>;
    /// End the file.
    fn end(self) -> Result<()>;
}

/// The thread that writes.
pub struct Writer {
    blocks: Option<SyncSender<Vec<f64>>>,
    /// Written blocks, to be filled again.
    empty: Receiver<Vec<f64>>,
    thread: Option<JoinHandle<Result<()>>>,
    path: PathBuf,
}

impl Writer {
    /// Start the file.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn begin<F: Format>(path: &Path, columns: &[Column]) -> Result<Self> {
        Self::start::<F>(path, columns).with_context(|| unwritten(path))
    }

    fn start<F: Format>(path: &Path, columns: &[Column]) -> Result<Self> {
        let replacement = Replacement::begin(path)?;
        let mut format = F::begin(replacement.file()?, columns)?;
        let (blocks, waiting): (_, Receiver<Vec<f64>>) = sync_channel(WAITING);
        let (done, empty): (Sender<Vec<f64>>, _) = channel();
        let thread = std::thread::spawn(move || {
            let mut has_rows = false;
            for block in waiting {
                has_rows |= !block.is_empty();
                format.write(&block)?;
                // The run may have ended.
                let _ = done.send(block);
            }
            format.end()?;
            // If the run has not started, no file remains, and an old file is not replaced.
            if has_rows { Ok(replacement.finish()?) } else { Ok(()) }
        });
        Ok(Self { blocks: Some(blocks), empty, thread: Some(thread), path: path.to_path_buf() })
    }

    /// Pass a block of rows to the thread. `block` becomes an empty block. After an error nothing is done.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, block: &mut Vec<f64>) -> Result<()> {
        let mut next = self.empty.try_recv().unwrap_or_default();
        next.clear();
        let full = std::mem::replace(block, next);
        match &self.blocks {
            // The thread ends early only because of an error.
            Some(blocks) if blocks.send(full).is_err() => self.end(),
            _ => Ok(()),
        }
    }

    /// Wait until all rows are written.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn end(&mut self) -> Result<()> {
        self.blocks = None;
        let Some(thread) = self.thread.take() else { return Ok(()) };
        let written = thread.join().unwrap_or_else(|_| Err(anyhow!("the writing thread panicked")));
        // The intermediate causes contain no information: Parquet's error repeats that of the disk.
        written.map_err(|error| anyhow!("{}", error.root_cause()).context(unwritten(&self.path)))
    }
}
