//! A packed FMU as an archive.
//!
//! In: its path. Out: the names and contents of its entries, and its definition. The module must not know XML.

use crate::{files, headers};
use anyhow::{Context, Result, bail};
use linkage_fmu::component::Component;
use linkage_fmu::fmi::LARGEST_DEFINITION;
use std::io::{Cursor, Read};
use std::path::Path;
use zip::ZipArchive;

/// Largest FMU and largest unpacked entry that are read [bytes].
const LARGEST_FMU: u64 = 1 << 30;
/// Folder of the definition, in a model's folder and in an FMU.
pub const RESOURCES: &str = "resources";

/// An opened FMU.
pub struct Fmu {
    shown: String,
    names: Vec<String>,
    /// Faults in the headers of the archive.
    faults: Vec<String>,
    archive: ZipArchive<Cursor<Vec<u8>>>,
}

/// The text of a definition from any source.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Path of the definition in messages.
    pub shown: String,
    /// Name of the definition file of its kind of model.
    pub kind: &'static str,
    /// Its text.
    pub text: String,
}

/// Whether a path names an FMU.
pub fn is_fmu(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("fmu")) && path.is_file()
}

impl Fmu {
    /// Open the archive.
    ///
    /// # Errors
    /// The file cannot be read, or is no zip archive.
    pub fn open(path: &Path) -> Result<Self> {
        let shown = path.display().to_string();
        let bytes = files::read(path, LARGEST_FMU)?;
        let faults = headers::faults(&bytes);
        let archive =
            ZipArchive::new(Cursor::new(bytes)).with_context(|| format!("{shown}: the file is not an FMU"))?;
        let names = archive.file_names().filter(|name| !name.as_ref().is_ok_and(|name| name.ends_with('/')));
        let names = names.map(|name| Ok(name?.into_owned())).collect::<Result<_>>();
        let names = names.with_context(|| format!("{shown}: the names of the files in this FMU cannot be read"))?;
        Ok(Self { shown, names, faults, archive })
    }

    /// Path of the FMU in messages.
    pub fn shown(&self) -> &str {
        &self.shown
    }

    /// Names of all entries that are files.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Faults in the headers of the archive, one per line.
    pub fn faults(&self) -> &[String] {
        &self.faults
    }

    /// Content of an entry. None if no entry has this name.
    ///
    /// # Errors
    /// The entry is damaged, or larger than `largest`.
    pub fn read(&mut self, name: &str) -> Result<Option<Vec<u8>>> {
        self.read_up_to(name, LARGEST_FMU)
    }

    fn read_up_to(&mut self, name: &str, largest: u64) -> Result<Option<Vec<u8>>> {
        let shown = &self.shown;
        let Ok(entry) = self.archive.by_name(name) else { return Ok(None) };
        let mut bytes = Vec::new();
        entry
            .take(largest + 1)
            .read_to_end(&mut bytes)
            .with_context(|| format!("{shown}: {name} cannot be unpacked"))?;
        if bytes.len() as u64 > largest {
            bail!("{shown}: {name} has more than {largest} bytes; check that this is the right file");
        }
        Ok(Some(bytes))
    }

    /// Text of an entry. None if no entry has this name.
    ///
    /// # Errors
    /// As for [`Self::read`], or the entry is not UTF-8.
    pub fn text(&mut self, name: &str) -> Result<Option<String>> {
        let bytes = self.read_up_to(name, LARGEST_FMU)?;
        bytes.map(|bytes| self.utf8(name, bytes)).transpose()
    }

    fn utf8(&self, name: &str, bytes: Vec<u8>) -> Result<String> {
        String::from_utf8(bytes).ok().with_context(|| format!("{}: {name} is not UTF-8 text", self.shown))
    }

    /// The definition in the FMU. None in an FMU of another program.
    ///
    /// # Errors
    /// The definition cannot be read.
    pub fn find_definition(&mut self) -> Result<Option<Definition>> {
        for kind in Component::definition_files() {
            let name = format!("{RESOURCES}/{kind}");
            if let Some(bytes) = self.read_up_to(&name, LARGEST_DEFINITION)? {
                let text = self.utf8(&name, bytes)?;
                return Ok(Some(Definition { shown: format!("{}/{name}", self.shown), kind, text }));
            }
        }
        Ok(None)
    }

    /// The definition in the FMU.
    ///
    /// # Errors
    /// The FMU has no definition, as an FMU of another program, or the definition cannot be read.
    pub fn definition(&mut self) -> Result<Definition> {
        if let Some(definition) = self.find_definition()? {
            return Ok(definition);
        }
        let files = Component::definition_files().join(" or ");
        bail!("{}: the FMU contains no {RESOURCES}/{files}; check that this FMU was built by linkage-fmu", self.shown)
    }
}
