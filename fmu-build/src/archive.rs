//! The zip file of an FMU. Its bytes depend only on the content.
//!
//! In: names and contents. Out: entries in a fixed order with `modelDescription.xml` first, deflated or stored, with
//! fixed times and permissions, without entries for folders (FMI 2.0.5, 2.3).

use crate::{files, names};
use anyhow::{Context, Result, bail};
use linkage_fmu::component::TABLES;
use std::io::{Cursor, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Name of the description file of the FMU.
pub const MODEL_DESCRIPTION: &str = "modelDescription.xml";
/// Folder of the libraries.
pub const BINARIES: &str = "binaries";
/// Read and write for the owner, read for all.
const PERMISSIONS: u32 = 0o644;

/// Whether an entry is stored without compression: unpacking megabytes would take an importer longer than a run.
fn is_stored(name: &str) -> bool {
    (name.starts_with(BINARIES) && !name.ends_with(".a")) || name.ends_with(TABLES)
}

/// One file of an FMU.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Path in the zip, with `/`.
    pub name: String,
    /// Content of the file.
    pub content: Vec<u8>,
}

/// Write the FMU to `path`. An existing file is either replaced as a whole, or not at all. Several programs may write
/// at the same time.
///
/// # Errors
/// Two entries have equal names or names that differ only by case; a name is invalid on some system; the folder or the
/// file cannot be written.
pub fn write(path: &Path, entries: Vec<Entry>) -> Result<()> {
    // The zip is completed in memory. If writing fails, there is one error, and no attempt to complete the zip.
    let zip = zipped(entries).with_context(|| format!("{}: cannot be packed", path.display()))?;
    files::replace(path, &zip)
}

/// The bytes of the zip.
fn zipped(mut entries: Vec<Entry>) -> Result<Vec<u8>> {
    entries.sort_by(|a, b| (a.name != MODEL_DESCRIPTION, &a.name).cmp(&(b.name != MODEL_DESCRIPTION, &b.name)));
    if let Some(pair) = entries.windows(2).find(|pair| pair[0].name == pair[1].name) {
        bail!("{} would be packed twice; remove one of the two files", pair[0].name);
    }
    entries.iter().try_for_each(|entry| names::check(&entry.name))?;
    names::check_case(entries.iter().map(|entry| entry.name.as_str()))?;
    let options = SimpleFileOptions::default().last_modified_time(DateTime::DEFAULT).unix_permissions(PERMISSIONS);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for entry in &entries {
        let options = match is_stored(&entry.name) {
            true => options.compression_method(CompressionMethod::Stored),
            false => options.compression_method(CompressionMethod::Deflated).compression_level(Some(9)),
        };
        zip.start_file(entry.name.as_str(), options)?;
        zip.write_all(&entry.content)?;
    }
    Ok(zip.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use zip::ZipArchive;

    fn entry(name: &str, content: &str) -> Entry {
        Entry { name: name.to_owned(), content: content.as_bytes().to_vec() }
    }

    fn entries() -> Vec<Entry> {
        vec![
            entry("resources/mechanism.json", "{}"),
            entry("binaries/linux64/Gear.so", &"machine code ".repeat(1000)),
            entry("documentation/index.html", "<p>"),
            entry(MODEL_DESCRIPTION, "<xml/>"),
        ]
    }

    fn bytes(entries: Vec<Entry>) -> Vec<u8> {
        zipped(entries).unwrap()
    }

    #[test]
    fn same_content_gives_the_same_bytes_whatever_the_order() {
        let mut shuffled = entries();
        shuffled.reverse();
        assert_eq!(bytes(entries()), bytes(shuffled));
    }

    #[test]
    fn entries_have_fixed_order_time_permissions_and_method() {
        let mut zip = ZipArchive::new(Cursor::new(bytes(entries()))).unwrap();
        let names: Vec<_> = (0..zip.len()).map(|i| zip.by_index(i).unwrap().name().unwrap().into_owned()).collect();
        assert_eq!(
            names,
            [MODEL_DESCRIPTION, "binaries/linux64/Gear.so", "documentation/index.html", "resources/mechanism.json"]
        );
        for i in 0..zip.len() {
            let file = zip.by_index(i).unwrap();
            let is_library = file.name().unwrap().starts_with("binaries/");
            let method = if is_library { CompressionMethod::Stored } else { CompressionMethod::Deflated };
            assert_eq!(file.compression(), method);
            assert_eq!(file.unix_mode().map(|mode| mode & 0o777), Some(PERMISSIONS));
            let time = file.last_modified().unwrap();
            assert_eq!((time.year(), time.month(), time.day(), time.hour()), (1980, 1, 1, 0));
        }
    }

    #[test]
    fn extracted_content_is_the_packed_content() {
        let mut zip = ZipArchive::new(Cursor::new(bytes(entries()))).unwrap();
        for expected in entries() {
            let mut content = Vec::new();
            zip.by_name(&expected.name).unwrap().read_to_end(&mut content).unwrap();
            assert_eq!(content, expected.content);
        }
    }

    #[test]
    fn a_duplicate_name_is_rejected() {
        let error = zipped(vec![entry("a", "1"), entry("a", "2")]).unwrap_err();
        assert!(error.to_string().starts_with("a would be packed twice"), "{error}");
    }
}
