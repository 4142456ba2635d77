//! The headers of a zip. A zip contains a list of entries at its end, and a second header in front of each entry.
//! Readers that unpack a stream use the second headers, all others use the list.
//!
//! In: the bytes of a zip. Out: duplicate entries, and entries whose two headers differ.

use std::collections::HashSet;

/// First bytes of the end of the list, of an entry in the list, and of an entry's own header.
const END: &[u8] = b"PK\x05\x06";
const LISTED: &[u8] = b"PK\x01\x02";
const OWN: &[u8] = b"PK\x03\x04";
/// Lengths of the two headers without the name.
const LISTED_LENGTH: usize = 46;
const OWN_LENGTH: usize = 30;
/// Flag of an entry whose sizes and check sum follow its content.
const SIZES_FOLLOW: usize = 1 << 3;
/// Marks a size that is stored elsewhere.
const ELSEWHERE: usize = 0xffff_ffff;
/// Fields of both headers: name, offset in the list, offset in the own header, number of bytes.
const FIELDS: [(&str, usize, usize, usize); 4] =
    [("method", 10, 8, 2), ("check sum", 16, 14, 4), ("packed size", 20, 18, 4), ("size", 24, 22, 4)];

/// Faults in the headers, one per line.
pub fn faults(zip: &[u8]) -> Vec<String> {
    let mut faults = Vec::new();
    if read(zip, &mut faults).is_none() {
        faults.push("the table of contents of the FMU (a ZIP file) is incomplete; pack the FMU again".to_owned());
    }
    faults
}

/// A number with this number of bytes, the lowest first.
fn number(bytes: &[u8], at: usize, count: usize) -> Option<usize> {
    Some(bytes.get(at..at + count)?.iter().rev().fold(0, |value, byte| value << 8 | usize::from(*byte)))
}

/// Compare the headers of all entries. None if the list is truncated.
fn read(zip: &[u8], faults: &mut Vec<String>) -> Option<()> {
    let end = zip.windows(END.len()).rposition(|bytes| bytes == END)?;
    let (count, mut at) = (number(zip, end + 10, 2)?, number(zip, end + 16, 4)?);
    let mut names = HashSet::new();
    for _ in 0..count {
        let listed = zip.get(at..).filter(|rest| rest.starts_with(LISTED))?;
        let name = listed.get(LISTED_LENGTH..LISTED_LENGTH + number(listed, 28, 2)?)?;
        let shown = String::from_utf8_lossy(name);
        if !names.insert(name) {
            faults.push(format!(
                "{shown} occurs twice in the FMU (a ZIP file), and a simulation tool can read either of the two \
                 files; remove one file"
            ));
        }
        let own = number(listed, 42, 4).and_then(|place| zip.get(place..)).filter(|rest| rest.starts_with(OWN));
        if let Some(what) = own.map_or(Some("place"), |own| difference(listed, own, name)) {
            faults.push(format!(
                "{shown}: the {what} in the table of contents of the FMU (a ZIP file) differs from the {what} stored \
                 with this file, so two simulation tools can read different files; pack the FMU again"
            ));
        }
        at += LISTED_LENGTH + name.len() + number(listed, 30, 2)? + number(listed, 32, 2)?;
    }
    Some(())
}

/// The first field in which an entry's own header differs from the list.
fn difference(listed: &[u8], own: &[u8], name: &[u8]) -> Option<&'static str> {
    let own_name = number(own, 26, 2).and_then(|length| own.get(OWN_LENGTH..OWN_LENGTH + length));
    if own_name != Some(name) {
        return Some("name");
    }
    let is_stated = number(own, 6, 2).is_some_and(|flags| flags & SIZES_FOLLOW == 0);
    let differs = |&&(what, in_list, in_own, count): &&(&str, usize, usize, usize)| {
        let (expected, found) = (number(listed, in_list, count), number(own, in_own, count));
        (is_stated || what == "method") && found != Some(ELSEWHERE) && expected != Some(ELSEWHERE) && expected != found
    };
    FIELDS.iter().find(differs).map(|(what, ..)| *what)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Write};
    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    fn zip() -> Vec<u8> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for name in ["entry1", "entry2"] {
            zip.start_file(name, SimpleFileOptions::default()).unwrap();
            zip.write_all(b"some words, some words").unwrap();
        }
        zip.finish().unwrap().into_inner()
    }

    /// Offsets of these bytes.
    fn places(zip: &[u8], bytes: &[u8]) -> Vec<usize> {
        (0..zip.len()).filter(|at| zip[*at..].starts_with(bytes)).collect()
    }

    #[test]
    fn different_headers_and_duplicate_names_are_found() {
        assert_eq!(faults(&zip()), Vec::<String>::new());
        let [own, listed] = places(&zip(), b"entry2")[..] else { panic!("two headers") };
        for (at, what) in
            [(own, "entry2: the name"), (own - 30 + 8, "entry2: the method"), (own - 30 + 14, "check sum")]
        {
            let mut zip = zip();
            zip[at] ^= 1;
            let faults = faults(&zip);
            assert!(faults.len() == 1 && faults[0].contains(what), "{what}: {faults:?}");
        }
        let mut twice = zip();
        (twice[own + 5], twice[listed + 5]) = (b'1', b'1');
        assert_eq!(
            faults(&twice),
            ["entry1 occurs twice in the FMU (a ZIP file), and a simulation tool can read either of the two files; \
              remove one file"]
        );
        let whole = zip();
        assert!(faults(&whole[..whole.len() - 30])[0].contains("incomplete"));
    }
}
