//! Files on disk: only regular files are read, and a file is replaced as a whole or not at all.
//!
//! In: paths and contents. Out: contents, or one message that names the file. The module must not know what a file
//! contains.

use anyhow::{Context, Result, bail};
use linkage_fmu::codec::checksum::{fnv1a, xxh64};
use std::ffi::OsStr;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Number of bytes that are read at once for a checksum.
const BLOCK: u64 = 1 << 20;
/// End of the name of a file while it is written.
const PARTIAL: &str = ".partial";
/// Largest number of names that are tried for a file while it is written. On a file system without locks each killed
/// run with the same number occupies one name.
const ATTEMPTS: usize = 1000;
/// Number of the next file that this program writes, so that the names differ.
static NEXT: AtomicUsize = AtomicUsize::new(0);

/// A word for the object at a path that is neither file nor folder.
pub fn kind(metadata: &Metadata) -> &'static str {
    let of = metadata.file_type();
    if of.is_symlink() {
        return "a symbolic link";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if of.is_fifo() {
            return "a pipe";
        }
        if of.is_socket() {
            return "a socket";
        }
        if of.is_char_device() || of.is_block_device() {
            return "a device";
        }
    }
    if of.is_dir() { "a folder" } else { "not a regular file" }
}

/// A checksum of the content of a file of any size, as text. The memory use is constant.
///
/// # Errors
/// As for [`read`].
pub fn digest(path: &Path) -> Result<String> {
    let shown = path.display();
    let metadata = fs::metadata(path).with_context(|| format!("{shown}: cannot be read"))?;
    if !metadata.is_file() {
        bail!("{shown}: this is {}; give the path of a regular file", kind(&metadata));
    }
    let mut file = File::open(path).with_context(|| format!("{shown}: cannot be read"))?;
    let (mut block, mut sum, mut length) = (Vec::new(), 0_u64, 0);
    loop {
        block.clear();
        let read =
            (&mut file).take(BLOCK).read_to_end(&mut block).with_context(|| format!("{shown}: cannot be read"))?;
        if read == 0 {
            return Ok(format!("{sum:016x} {length}"));
        }
        sum = fnv1a([sum.to_le_bytes(), xxh64(&block).to_le_bytes()].as_flattened());
        length += read;
    }
}

/// Content of a file. Other objects are not opened: reading a pipe could wait without end, and reading a device could
/// continue without end.
///
/// # Errors
/// The file does not exist, is no regular file, has more than `largest` bytes, or cannot be read.
pub fn read(path: &Path, largest: u64) -> Result<Vec<u8>> {
    let shown = path.display();
    let metadata = fs::metadata(path).with_context(|| format!("{shown}: cannot be read"))?;
    if !metadata.is_file() {
        bail!("{shown}: this is {}; give the path of a regular file", kind(&metadata));
    }
    if metadata.len() > largest {
        bail!(
            "{shown}: the file has {} bytes, but at most {largest} are allowed; check that this is the right file",
            metadata.len()
        );
    }
    fs::read(path).with_context(|| format!("{shown}: cannot be read"))
}

/// Copy a file or a folder with its content, except for generated folders: `target` of Cargo, `__pycache__` of Python.
///
/// # Errors
/// Something cannot be read or written.
pub fn copy_all(from: &Path, to: &Path) -> Result<()> {
    let shown = from.display().to_string();
    if !from.is_dir() {
        fs::create_dir_all(to.parent().unwrap_or(Path::new("."))).with_context(|| shown.clone())?;
        return fs::copy(from, to).map(drop).with_context(|| format!("{shown}: the file cannot be copied"));
    }
    for entry in fs::read_dir(from).with_context(|| format!("{shown}: the content of the folder cannot be listed"))? {
        let name = entry?.file_name();
        if name != "target" && name != "__pycache__" {
            copy_all(&from.join(&name), &to.join(&name))?;
        }
    }
    Ok(())
}

/// Write a file with this content to `path`, and create its folder. An existing file is replaced as a whole or not at
/// all. Several programs may write at the same time: each writes a file with a separate name, and the last program that
/// renames its file wins.
///
/// # Errors
/// The folder or the file cannot be written. The old file at `path` remains unchanged, without any additional file.
pub fn replace(path: &Path, content: &[u8]) -> Result<()> {
    replace_with(path, |file| file.write_all(content))
}

/// Create the folder that this option of a command names, unless it exists.
///
/// # Errors
/// The folder cannot be created.
pub fn make_folder(folder: &Path, option: &str) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| {
        format!("{}: the folder cannot be created; give another folder with {option}", folder.display())
    })
}

/// [`replace`] the file that this option of a command names.
///
/// # Errors
/// As for [`replace`].
pub fn replace_named(path: &Path, option: &str, content: &[u8]) -> Result<()> {
    make_folder(folder_of(path), option)?;
    replace(path, content)
}

/// Folder of a file. For a file name without folder, the present folder.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn replace_with(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> Result<()> {
    let folder = folder_of(path);
    fs::create_dir_all(folder)
        .with_context(|| format!("{}: the folder cannot be created; give another folder", folder.display()))?;
    let written = Replacement::begin(path).and_then(|mut own| {
        write(&mut own.file)?;
        own.finish()
    });
    written.with_context(|| unwritten(path))
}

/// Message for a file that cannot be written.
pub fn unwritten(path: &Path) -> String {
    format!("{}: the file cannot be written; free disk space, or give another folder", path.display())
}

/// A file that is being written. At the end it replaces the file at its path. If it is dropped before, the old file
/// remains. A pipe or a device is written directly.
#[derive(Debug)]
pub struct Replacement {
    file: File,
    /// Path during writing, and final path. None for a pipe or a device.
    paths: Option<(PathBuf, PathBuf)>,
}

impl Replacement {
    /// Start the file for this path, whose folder exists.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn begin(path: &Path) -> io::Result<Self> {
        // A link to a pipe, such as /dev/stdout, does not resolve to the path of a file.
        let is_other = fs::metadata(path).is_ok_and(|found| !found.is_file());
        // A link to a file remains, and then points to the new file.
        let path = if path.is_symlink() && !is_other { path.canonicalize()? } else { path.to_path_buf() };
        let Some(name) = path.file_name().filter(|_| !is_other) else {
            return Ok(Self { file: OpenOptions::new().write(true).open(&path)?, paths: None });
        };
        let folder = folder_of(&path);
        clear(folder, name);
        let (partial, file) = begin(folder, name)?;
        Ok(Self { file, paths: Some((partial, path)) })
    }

    /// The file to write to.
    ///
    /// # Errors
    /// The system has no free handle.
    pub fn file(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Move the complete file to its path.
    ///
    /// # Errors
    /// The old file cannot be replaced.
    pub fn finish(mut self) -> io::Result<()> {
        if let Some((partial, path)) = &self.paths {
            fs::rename(partial, path)?;
            self.paths = None;
        }
        Ok(())
    }
}

impl Drop for Replacement {
    fn drop(&mut self) {
        if let Some((partial, _)) = &self.paths {
            // The reported error is the one that ended the writing.
            let _ = fs::remove_file(partial);
        }
    }
}

/// A new file for the later file `name`. It is locked while it is open, so that no program takes it for a leftover.
fn begin(folder: &Path, name: &OsStr) -> io::Result<(PathBuf, File)> {
    for _ in 0..ATTEMPTS {
        let mut own = name.to_owned();
        own.push(format!(".{}-{}{PARTIAL}", process::id(), NEXT.fetch_add(1, Ordering::Relaxed)));
        let path = folder.join(own);
        let file = match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Err(error) => return Err(error),
        };
        // Without locks leftovers remain, with no other effect.
        let _ = file.lock();
        // Before the lock, another run may have removed the file as a leftover.
        if path.exists() {
            return Ok((path, file));
        }
    }
    Err(io::Error::new(
        io::ErrorKind::AlreadyExists,
        format!("there are already {ATTEMPTS} unfinished files of this name"),
    ))
}

/// Remove the leftovers of runs that were killed while they wrote `name`: unfinished files without a lock. Errors are
/// ignored.
fn clear(folder: &Path, name: &OsStr) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if is_partial(&entry.file_name(), name)
            && entry.file_type().is_ok_and(|of| of.is_file())
            && let Ok(file) = OpenOptions::new().write(true).open(&path)
            // The lock is held until the file is removed. A program that has just created the file waits, and then
            // notices this.
            && file.try_lock().is_ok()
            && fs::remove_file(&path).is_ok()
        {
            println!("{} (removed: unfinished file of a run that was stopped)", path.display());
        }
    }
}

/// Whether `file` is a name that [`begin`] uses for the later file `name`.
fn is_partial(file: &OsStr, name: &OsStr) -> bool {
    let (Some(file), Some(name)) = (file.to_str(), name.to_str()) else { return false };
    let middle = file.strip_prefix(name).and_then(|rest| rest.strip_prefix('.')?.strip_suffix(PARTIAL));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    middle.and_then(|middle| middle.split_once('-')).is_some_and(|(run, attempt)| is_number(run) && is_number(attempt))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::env;

    /// A new folder of this test.
    fn folder(test: &str) -> PathBuf {
        let path = env::temp_dir().join(format!("fmu-build-files-{}-{test}", process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        path
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// On a full disk the old file remains, no additional file is left, and one message reports the error.
    #[test]
    fn a_disk_that_fills_up_changes_nothing() {
        let folder = folder("full");
        let path = folder.join("A.fmu");
        replace(&path, b"before").unwrap();
        let error = replace_with(&path, |file| {
            file.write_all(b"the first half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        let message = format!("{error:#}");
        assert!(message.starts_with(&path.display().to_string()), "{message}");
        assert_eq!(message.matches("cannot be written; free disk space").count(), 1, "{message}");
        assert!(!message.contains('\n') && !message.contains(PARTIAL), "{message}");
        assert_eq!(fs::read(&path).unwrap(), b"before");
        assert_eq!(names(&folder), ["A.fmu"]);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn leftovers_of_killed_runs_are_removed_and_those_of_others_stay() {
        let folder = folder("leftovers");
        for name in ["A.fmu.123-0.partial", "B.fmu.123-0.partial", "A.fmu.partial.txt", "A.fmu.x-0.partial"] {
            fs::write(folder.join(name), "left").unwrap();
        }
        // An active run keeps its lock.
        let (alive, file) = begin(&folder, OsStr::new("A.fmu")).unwrap();
        replace(&folder.join("A.fmu"), b"new").unwrap();
        assert!(alive.exists());
        drop(file);
        let own = alive.file_name().unwrap().to_str().unwrap();
        let mut expected = ["A.fmu", own, "A.fmu.partial.txt", "A.fmu.x-0.partial", "B.fmu.123-0.partial"];
        expected.sort_unstable();
        assert_eq!(names(&folder), expected);
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_not_read() {
        let message = read(Path::new("/dev/zero"), 10).unwrap_err().to_string();
        assert_eq!(message, "/dev/zero: this is a device; give the path of a regular file");
    }

    #[test]
    fn a_file_that_is_too_large_is_not_read() {
        let folder = folder("large");
        let path = folder.join("a");
        fs::write(&path, [0; 11]).unwrap();
        assert!(read(&path, 11).is_ok());
        assert!(
            read(&path, 10)
                .unwrap_err()
                .to_string()
                .ends_with("has 11 bytes, but at most 10 are allowed; check that this is the right file")
        );
        fs::remove_dir_all(folder).unwrap();
    }
}
