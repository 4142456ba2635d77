//! The shown file: it is watched, and written as a whole.
//!
//! In: its path. Out: its text with a version that counts the changes. The module must not know what the text means.

use anyhow::Result;
use fmu_build::{files, shared};
use linkage_fmu::fmi::LARGEST_DEFINITION;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

/// Time between two checks of the file. A check only reads size and time of the file. This finds changes on every file
/// system, also without events of the system, and replaced files.
const LOOK: Duration = Duration::from_millis(20);
/// Time after a change in which every check reads the file. The file may be written in parts, or twice within one tick
/// of the file system's clock.
const UNSETTLED: Duration = Duration::from_millis(500);

/// A text, or the reason why the file cannot be read.
pub type Text = Result<String, String>;

/// The watched file.
pub struct File {
    path: PathBuf,
    state: Mutex<State>,
    changed: Condvar,
}

/// The newest version.
struct State {
    version: u64,
    text: Text,
    /// Content of the file of shared parameters that the text names.
    shared: Option<Vec<u8>>,
}

/// Result of saving a text.
pub enum Saved {
    /// The text is this version of the file.
    As(u64),
    /// The file has a newer version than the one from which the text was edited.
    Not(u64, Text),
}

impl File {
    /// Watch a file as long as the program runs.
    pub fn watch(path: PathBuf) -> Arc<Self> {
        let (text, shared) = read(&path);
        let state = Mutex::new(State { version: 1, text, shared });
        let file = Arc::new(Self { path, state, changed: Condvar::new() });
        let watched = Arc::clone(&file);
        thread::spawn(move || watched.poll());
        file
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn poll(&self) {
        let (mut seen, mut since) = (None, Instant::now());
        let (mut version, mut parameters) = (0, None);
        loop {
            let state = self.state();
            if state.version != version {
                version = state.version;
                parameters = state.text.as_ref().ok().and_then(|text| shared::file(&self.path, text));
            }
            drop(state);
            let stamps = Some([Some(&self.path), parameters.as_ref()].map(|path| path.and_then(|path| stamp(path))));
            if stamps != seen {
                (seen, since) = (stamps, Instant::now());
            }
            if since.elapsed() < UNSETTLED {
                self.look();
            }
            thread::sleep(LOOK);
        }
    }

    /// Read the file. If it differs, there is a new version.
    fn look(&self) {
        // While the page writes the file, it is not read.
        let mut state = self.state();
        let (text, shared) = read(&self.path);
        if (&text, &shared) != (&state.text, &state.shared) {
            *state = State { version: state.version + 1, text, shared };
            self.changed.notify_all();
        }
    }

    /// The present version.
    pub fn now(&self) -> (u64, Text) {
        let state = self.state();
        (state.version, state.text.clone())
    }

    /// The first version that differs from the known one, if it occurs within this time.
    pub fn after(&self, known: u64, patience: Duration) -> Option<(u64, Text)> {
        let waited = self.changed.wait_timeout_while(self.state(), patience, |state| state.version == known);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        (state.version != known).then(|| (state.version, state.text.clone()))
    }

    /// Write a text that was edited from this version.
    ///
    /// # Errors
    /// The file cannot be written and remains unchanged.
    pub fn save(&self, version: u64, text: &str) -> Result<Saved> {
        self.look();
        let mut state = self.state();
        if state.version != version {
            return Ok(Saved::Not(state.version, state.text.clone()));
        }
        files::replace(&self.path, text.as_bytes())?;
        let (text, shared) = read(&self.path);
        *state = State { version: version + 1, text, shared };
        self.changed.notify_all();
        Ok(Saved::As(version + 1))
    }
}

/// Time and size of a file, which change with it. None if the file does not exist.
fn stamp(path: &Path) -> Option<(Option<SystemTime>, u64)> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.modified().ok(), metadata.len()))
}

/// Text of a file, and content of the file of shared parameters that it names.
fn read(path: &Path) -> (Text, Option<Vec<u8>>) {
    let bytes = files::read(path, LARGEST_DEFINITION).map_err(|error| format!("{error:#}"));
    let not_text = |_| format!("{}: the file is not UTF-8 text; save the file as UTF-8", path.display());
    let text = bytes.and_then(|bytes| String::from_utf8(bytes).map_err(not_text));
    let named = text.as_ref().ok().and_then(|text| shared::file(path, text));
    let shared = named.and_then(|path| files::read(&path, LARGEST_DEFINITION).ok());
    (text, shared)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Duration = Duration::from_secs(10);

    /// The file is written in place, replaced by rename (as by some editors), removed and restored. Its parameters
    /// change.
    #[test]
    fn each_way_to_change_a_file_is_a_new_version() {
        let folder = std::env::temp_dir().join(format!("linkage-fmu-watched-{} é", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("a.json");
        fs::write(&path, "one").unwrap();
        let file = File::watch(path.clone());
        let (mut version, text) = file.now();
        assert_eq!(text.unwrap(), "one");
        let mut next = || {
            let (next, text) = file.after(version, PATIENCE).unwrap();
            version = next;
            text
        };
        fs::write(&path, "two").unwrap();
        assert_eq!(next().unwrap(), "two");
        fs::write(folder.join("b"), "six").unwrap();
        fs::rename(folder.join("b"), &path).unwrap();
        assert_eq!(next().unwrap(), "six");
        fs::remove_file(&path).unwrap();
        assert!(next().unwrap_err().contains("a.json"));
        let naming = r#"{ "parameters_from": "p.json" }"#;
        fs::write(&path, naming).unwrap();
        assert_eq!(next().unwrap(), naming);
        fs::write(folder.join("p.json"), "{}").unwrap();
        assert_eq!(next().unwrap(), naming);
        let (last, _) = file.now();
        assert!(matches!(file.save(last - 1, "lost"), Ok(Saved::Not(newest, _)) if newest == last));
        assert!(matches!(file.save(last, "saved"), Ok(Saved::As(newest)) if newest == last + 1));
        assert_eq!(fs::read_to_string(&path).unwrap(), "saved");
        thread::sleep(5 * LOOK);
        assert_eq!(file.now(), (last + 1, Ok("saved".into())), "what the page has written is no news");
        fs::remove_dir_all(folder).unwrap();
    }
}
