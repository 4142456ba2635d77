//! The journal of a study: the completed chunks, in the order of their completion.
//!
//! In: chunks with their bytes. Out: the completed chunks and their bytes. A record has a checksum. An incomplete
//! record at the end of an ended run is truncated, so that a chunk exists as a whole or not at all. The module must not
//! know the content of a chunk.

use anyhow::{Context, Result, bail};
use linkage_fmu::codec::checksum::xxh64;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// First bytes of a journal: its name and the version of its format.
const MAGIC: &[u8; 8] = b"LFSWEEP2";
/// Number of bytes before the first record.
const HEAD: u64 = 8 + 16;
/// Number of bytes before those of a chunk: its number, their number, their checksum.
const RECORD: u64 = 24;

/// The journal of one study.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
    /// Offset and number of bytes of each completed chunk.
    done: Records,
    end: u64,
}

impl Journal {
    /// Open the journal of the study with this identity: a new one, or with `resumes` an existing one.
    ///
    /// # Errors
    /// The file cannot be created or read; a journal exists without `resumes`, belongs to another study, or is in use.
    pub fn open(path: &Path, identity: u128, resumes: bool) -> Result<Self> {
        let shown = path.display();
        let stands = path.exists();
        if stands && !resumes {
            bail!(
                "{shown}: the file contains results of a study that was stopped; to continue the study, use --resume; \
                 to start the study again, remove this file"
            );
        }
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .with_context(|| format!("{shown}: the file cannot be opened"))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            bail!(
                "{shown}: another process of the program is writing this file; wait until the other process ends, or \
                    give another folder with --out"
            );
        }
        let journal = |file: &mut File| -> std::io::Result<Option<(Records, u64)>> {
            if file.metadata()?.len() < HEAD {
                file.set_len(0)?;
                file.write_all(MAGIC)?;
                file.write_all(&identity.to_le_bytes())?;
                return Ok(Some((BTreeMap::new(), HEAD)));
            }
            read(file, identity)
        };
        let known = journal(&mut file).with_context(|| format!("{shown}: cannot be read"))?;
        let Some((done, end)) = known else {
            bail!(
                "{shown}: this file belongs to another study, or the study or the mechanism has changed since the \
                    file was written; give another folder with --out"
            );
        };
        file.set_len(end).with_context(|| format!("{shown}: the file cannot be written"))?;
        Ok(Self { file, path: path.to_path_buf(), done, end })
    }

    /// Whether a chunk is completed.
    pub fn has(&self, chunk: u64) -> bool {
        self.done.contains_key(&chunk)
    }

    /// Number of completed chunks.
    pub fn len(&self) -> u64 {
        self.done.len() as u64
    }

    /// Add a completed chunk. An existing chunk stays unchanged.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, chunk: u64, bytes: &[u8]) -> Result<()> {
        if self.has(chunk) {
            return Ok(());
        }
        let mut record = Vec::with_capacity(RECORD as usize + bytes.len());
        for number in [chunk, bytes.len() as u64, xxh64(bytes)] {
            record.extend(number.to_le_bytes());
        }
        record.extend(bytes);
        let remedy = "free disk space; then continue with --resume";
        let placed = self.file.seek(SeekFrom::Start(self.end));
        placed
            .and_then(|_| self.file.write_all(&record))
            .with_context(|| format!("{}: the file cannot be written; {remedy}", self.path.display()))?;
        self.done.insert(chunk, (self.end + RECORD, bytes.len() as u64));
        self.end += record.len() as u64;
        Ok(())
    }

    /// Read the bytes of all completed chunks in the order of their numbers.
    ///
    /// # Errors
    /// The file cannot be read; an error of `take`.
    pub fn replay(&mut self, mut take: impl FnMut(u64, &[u8]) -> Result<()>) -> Result<()> {
        let mut bytes = Vec::new();
        for (chunk, (place, length)) in &self.done {
            bytes.resize(*length as usize, 0);
            let read = self.file.seek(SeekFrom::Start(*place)).and_then(|_| self.file.read_exact(&mut bytes));
            read.with_context(|| format!("{}: cannot be read", self.path.display()))?;
            take(*chunk, &bytes)?;
        }
        Ok(())
    }

    /// Remove the journal after its chunks are in the results.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove(self) -> Result<()> {
        fs::remove_file(&self.path).with_context(|| format!("{}: cannot be removed", self.path.display()))
    }
}

/// Offset and length of the record of each chunk.
type Records = BTreeMap<u64, (u64, u64)>;

/// The complete records of a journal, and the offset of their end. None if the journal belongs to another study.
fn read(file: &mut File, identity: u128) -> std::io::Result<Option<(Records, u64)>> {
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(0))?;
    let mut file = BufReader::new(file);
    let mut head = [0; HEAD as usize];
    file.read_exact(&mut head)?;
    if head[..8] != *MAGIC || head[8..] != identity.to_le_bytes() {
        return Ok(None);
    }
    let (mut done, mut end, mut bytes) = (BTreeMap::new(), HEAD, Vec::new());
    while length - end >= RECORD {
        let mut numbers = [[0; 8]; 3];
        for number in &mut numbers {
            file.read_exact(number)?;
        }
        let [chunk, count, sum] = numbers.map(u64::from_le_bytes);
        if count > length - end - RECORD {
            break;
        }
        bytes.resize(count as usize, 0);
        file.read_exact(&mut bytes)?;
        if xxh64(&bytes) != sum {
            break;
        }
        done.entry(chunk).or_insert((end + RECORD, count));
        end += RECORD + count;
    }
    Ok(Some((done, end)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_record_that_was_cut_off_is_forgotten_and_the_others_stay() {
        let path = std::env::temp_dir().join(format!("fmu-build-journal-{}", std::process::id()));
        let _ = fs::remove_file(&path);
        let mut journal = Journal::open(&path, 7, false).unwrap();
        journal.add(4, b"four").unwrap();
        journal.add(1, b"one").unwrap();
        journal.add(4, b"again").unwrap();
        assert!(
            Journal::open(&path, 7, true)
                .unwrap_err()
                .to_string()
                .contains("another process of the program is writing this file")
        );
        drop(journal);
        let whole = fs::read(&path).unwrap();
        assert!(
            Journal::open(&path, 7, false).unwrap_err().to_string().contains("to continue the study, use --resume")
        );
        assert!(Journal::open(&path, 8, true).unwrap_err().to_string().contains("belongs to another study"));
        for cut in HEAD as usize..=whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            let mut journal = Journal::open(&path, 7, true).unwrap();
            let first = cut >= (HEAD + RECORD) as usize + 4;
            assert_eq!([journal.has(4), journal.has(1), journal.has(0)], [first, cut == whole.len(), false], "{cut}");
            journal.add(1, b"one").unwrap();
            let mut chunks = Vec::new();
            let mut take = |chunk: u64, bytes: &[u8]| {
                chunks.push((chunk, bytes.to_vec()));
                Ok(())
            };
            journal.replay(&mut take).unwrap();
            let expected = [(1, b"one".to_vec()), (4, b"four".to_vec())];
            assert_eq!(chunks, expected[..1 + usize::from(first)]);
        }
        // One flipped bit.
        let mut wrong = whole.clone();
        wrong[(HEAD + RECORD) as usize] ^= 1;
        fs::write(&path, &wrong).unwrap();
        assert_eq!(Journal::open(&path, 7, true).unwrap().len(), 0);
        fs::remove_file(&path).unwrap();
    }
}
