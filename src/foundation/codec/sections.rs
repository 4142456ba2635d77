//! A file of named sections of bytes. Each section is read when it is requested.
//!
//! In: names and bytes, and a key of the source data. Out: the bytes of a file; or the sections of such a file, each
//! with its check sum. Must not know: what the sections mean.
//!
//! Little-endian layout: magic (8 bytes), key (16), number of sections (8), check sum of all these and of the directory
//! (8); the directory, for each section the hash of its name, its offset, its length, its check sum (8 each); sections.
use super::checksum::{fnv1a, xxh64};
use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// First bytes of a file. The last byte is the version of the layout.
const MAGIC: [u8; 8] = *b"section2";
/// Bytes before the directory.
const HEAD: usize = 40;
/// Bytes of one entry of the directory.
const ENTRY: usize = 32;
/// Most sections in a file.
const MOST: usize = 4096;
/// Largest section that is read [bytes].
const LARGEST: u64 = 1 << 28;
/// Number of bytes of the first read: the head and the directory of about a hundred sections.
const FIRST: u64 = 4096;

/// Sections of one file.
#[derive(Clone, Debug)]
pub struct Sections {
    origin: Origin,
    directory: Vec<Entry>,
}

/// Location of the bytes.
#[derive(Clone, Debug)]
enum Origin {
    File(PathBuf),
    Memory(Arc<[u8]>),
}

/// A section in the directory.
#[derive(Clone, Copy, Debug)]
struct Entry {
    name: u64,
    offset: u64,
    length: u64,
    sum: u64,
}

impl Entry {
    fn words(self) -> [u64; 4] {
        [self.name, self.offset, self.length, self.sum]
    }
}

/// The bytes of a file with these sections. `key` identifies the source data.
///
/// # Panics
/// Two names with the same hash, or more than [`MOST`] sections: a fault of the caller.
pub fn encode(key: u128, sections: &[(String, Vec<u8>)]) -> Vec<u8> {
    assert!(sections.len() <= MOST, "{} sections", sections.len());
    let mut offset = (HEAD + ENTRY * sections.len()) as u64;
    let mut directory: Vec<Entry> = Vec::new();
    for (name, bytes) in sections {
        let entry = Entry { name: fnv1a(name.as_bytes()), offset, length: bytes.len() as u64, sum: xxh64(bytes) };
        assert!(directory.iter().all(|other| other.name != entry.name), "{name} has the hash of another section");
        directory.push(entry);
        offset += entry.length;
    }
    let directory: Vec<u8> = directory.into_iter().flat_map(Entry::words).flat_map(u64::to_le_bytes).collect();
    let mut out = head(key, sections.len() as u64);
    let sum = sum_of(&out, &directory);
    out.extend(sum.to_le_bytes());
    out.extend(directory);
    sections.iter().for_each(|(_, bytes)| out.extend(bytes));
    out
}

/// Magic, key and number of sections.
fn head(key: u128, count: u64) -> Vec<u8> {
    [&MAGIC[..], &key.to_le_bytes(), &count.to_le_bytes()].concat()
}

fn sum_of(head: &[u8], directory: &[u8]) -> u64 {
    xxh64(directory) ^ xxh64(head).rotate_left(1)
}

impl Sections {
    /// The sections of a file, if its source data have this key. None if there is no file.
    ///
    /// # Errors
    /// The fault of the file, as text that follows its name.
    pub fn open(path: &Path, key: u128) -> Result<Option<Self>, String> {
        let mut start = Vec::new();
        let read = File::open(path).and_then(|file| {
            let is_file = file.metadata()?.is_file();
            if is_file {
                file.take(FIRST).read_to_end(&mut start).map(|_| ())
            } else {
                Err(ErrorKind::IsADirectory.into())
            }
        });
        match read {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|error| format!("cannot be read: {error}"))?,
        }
        let origin = Origin::File(path.to_owned());
        Self::with_start(origin, start, key).map(Some)
    }

    /// The sections in these bytes, if their source data have this key.
    ///
    /// # Errors
    /// As for [`Self::open`].
    pub fn of_bytes(bytes: Arc<[u8]>, key: u128) -> Result<Self, String> {
        let start = bytes[..bytes.len().min(FIRST as usize)].to_vec();
        Self::with_start(Origin::Memory(bytes), start, key)
    }

    fn with_start(origin: Origin, mut start: Vec<u8>, key: u128) -> Result<Self, String> {
        let damaged = || "is damaged".to_owned();
        if start.len() < HEAD || start[..8] != MAGIC {
            return Err("is not a table file that this version of the program can read".to_owned());
        }
        if start[8..24] != key.to_le_bytes() {
            return Err("belongs to another definition or another version of the program".to_owned());
        }
        let word = |bytes: &[u8], at: usize| bytes[at..].first_chunk().map_or(0, |word| u64::from_le_bytes(*word));
        let count = word(&start, 24) as usize;
        if count > MOST {
            return Err(damaged());
        }
        let end = HEAD + ENTRY * count;
        if start.len() < end {
            start = origin.read(0, end as u64).ok_or_else(damaged)?;
        }
        let directory = &start[HEAD..end];
        if sum_of(&start[..32], directory) != word(&start, 32) {
            return Err(damaged());
        }
        let entry = |bytes: &[u8]| {
            let [name, offset, length, sum] = [0, 8, 16, 24].map(|at| word(bytes, at));
            Entry { name, offset, length, sum }
        };
        let directory = directory.chunks_exact(ENTRY).map(entry).collect();
        Ok(Self { origin, directory })
    }

    /// The bytes of a section. None if no section has this name, or if the section cannot be read or is damaged.
    pub fn read(&self, name: &str) -> Option<Vec<u8>> {
        let name = fnv1a(name.as_bytes());
        let entry = self.directory.iter().find(|entry| entry.name == name)?;
        let bytes = self.origin.read(entry.offset, entry.length)?;
        (xxh64(&bytes) == entry.sum).then_some(bytes)
    }
}

impl Origin {
    fn read(&self, offset: u64, length: u64) -> Option<Vec<u8>> {
        if length > LARGEST {
            return None;
        }
        match self {
            Self::Memory(bytes) => {
                let first = usize::try_from(offset).ok()?;
                bytes.get(first..first.checked_add(length as usize)?).map(<[u8]>::to_vec)
            }
            Self::File(path) => {
                let mut file = File::open(path).ok()?;
                file.seek(SeekFrom::Start(offset)).ok()?;
                let mut bytes = Vec::with_capacity(length as usize);
                file.take(length).read_to_end(&mut bytes).ok()?;
                (bytes.len() as u64 == length).then_some(bytes)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sections(count: usize) -> Vec<(String, Vec<u8>)> {
        (0..count).map(|i| (format!("part {i}"), vec![i as u8; 3 * i])).collect()
    }

    #[test]
    fn sections_are_read_by_their_names() {
        for count in [0, 3, 300] {
            let bytes: Arc<[u8]> = encode(7, &sections(count)).into();
            let read = Sections::of_bytes(Arc::clone(&bytes), 7).unwrap();
            for (name, content) in sections(count) {
                assert_eq!(read.read(&name).as_ref(), Some(&content), "{name}");
            }
            assert_eq!(read.read("other"), None);
            assert!(Sections::of_bytes(bytes, 8).unwrap_err().contains("another definition"));
        }
    }

    /// For every changed byte and every shortened file, a section is either complete or missing.
    #[test]
    fn a_damaged_file_gives_no_wrong_byte() {
        let whole = encode(7, &sections(4));
        let is_right = |bytes: Vec<u8>| {
            let Ok(read) = Sections::of_bytes(bytes.into(), 7) else { return true };
            sections(4).iter().all(|(name, content)| read.read(name).is_none_or(|bytes| bytes == *content))
        };
        for at in 0..whole.len() {
            let mut changed = whole.clone();
            changed[at] ^= 0x10;
            assert!(is_right(changed), "byte {at}");
            assert!(is_right(whole[..at].to_vec()), "{at} bytes");
        }
    }

    #[test]
    fn a_file_is_read_when_a_section_is_requested() {
        let folder = std::env::temp_dir().join(format!("linkage sections {}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("tables.bin");
        assert!(matches!(Sections::open(&path, 7), Ok(None)));
        assert!(Sections::open(&folder, 7).unwrap_err().contains("cannot be read"));
        std::fs::write(&path, encode(7, &sections(200))).unwrap();
        let read = Sections::open(&path, 7).unwrap().unwrap();
        assert_eq!(read.read("part 150"), Some(vec![150; 450]));
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(read.read("part 150"), None);
    }
}
