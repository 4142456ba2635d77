//! A file of macOS that contains the libraries for several processors: a list, then the libraries, each from the start
//! of a page on (`mach-o/fat.h`).
//!
//! In: libraries for one processor each, or the file. Out: the file, or one library. The module must not know FMI.

use anyhow::{Context, Result};
use object::Architecture;
use object::read::macho::{FatArch, MachOFatFile32};

/// First bytes of the file, and of a library of macOS for one 64-bit processor.
const FILE: u32 = 0xcafe_babe;
const LIBRARY: u32 = 0xfeed_facf;
/// Logarithm to the base 2 of the page size, for the processor with the larger pages.
const PAGE: u32 = 14;

/// Build the file.
///
/// # Errors
/// A part is no library of macOS for one processor, or the parts are too large.
pub fn file(parts: &[&[u8]]) -> Result<Vec<u8>> {
    let page = 1_usize << PAGE;
    let mut list = [FILE, u32::try_from(parts.len())?].map(u32::to_be_bytes).concat();
    let mut content = Vec::new();
    for part in parts {
        let word = |index: usize| Some(u32::from_le_bytes(part.get(4 * index..4 * index + 4)?.try_into().ok()?));
        let [processor, kind] = match (word(0), word(1), word(2)) {
            (Some(LIBRARY), Some(processor), Some(kind)) => Some([processor, kind]),
            _ => None,
        }
        .context("the file is not a library of macOS for one processor")?;
        // The list fits into the first page.
        let (place, size) = (u32::try_from(page + content.len())?, u32::try_from(part.len())?);
        list.extend([processor, kind, place, size, PAGE].map(u32::to_be_bytes).concat());
        content.extend_from_slice(part);
        content.resize(content.len().next_multiple_of(page), 0);
    }
    list.resize(page, 0);
    list.extend(content);
    Ok(list)
}

/// The library for a processor in a file. A file with a single library is returned unchanged.
pub fn part(file: &[u8], processor: Architecture) -> &[u8] {
    let parsed = MachOFatFile32::parse(file).ok();
    let found = parsed.and_then(|fat| fat.arches().iter().find(|arch| arch.architecture() == processor));
    found.and_then(|arch| arch.data(file).ok()).unwrap_or(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use object::FileKind;

    /// The first words of a library for a processor.
    fn library(processor: u32, kind: u32, size: usize) -> Vec<u8> {
        let mut content = [LIBRARY, processor, kind].map(u32::to_le_bytes).concat();
        content.resize(size, 7);
        content
    }

    #[test]
    fn each_part_is_found_again() {
        let (first, second) = (library(0x0100_0007, 3, 20_000), library(0x0100_000c, 0, 40_000));
        let parts = [&first[..], &second];
        let file = file(&parts).unwrap();
        assert_eq!(FileKind::parse(&*file).unwrap(), FileKind::MachOFat32);
        let fat = MachOFatFile32::parse(&*file).unwrap();
        let found: Vec<_> = fat.arches().iter().map(|arch| (arch.architecture(), arch.data(&*file).unwrap())).collect();
        assert_eq!(found, [(Architecture::X86_64, parts[0]), (Architecture::Aarch64, parts[1])]);
        assert!(fat.arches().iter().all(|arch| arch.file_range().0 % (1 << 14) == 0));
        assert_eq!([Architecture::X86_64, Architecture::Aarch64].map(|of| part(&file, of)), parts);
        assert_eq!(part(parts[0], Architecture::X86_64), parts[0]);
    }

    #[test]
    fn a_file_that_is_no_library_is_rejected() {
        for part in [&b""[..], b"\x7fELF and more", &[0xcf, 0xfa, 0xed]] {
            assert!(super::file(&[part]).is_err());
        }
    }
}
