//! File names that every system can unpack, including Windows.
//!
//! In: paths in a zip. Out: the first path that some system rejects, with a remedy.

use anyhow::{Result, bail};
use std::collections::HashMap;

/// Longest path in a zip, in UTF-16 units. Windows allows 260 units for the path of a file including the folder into
/// which the zip is unpacked and an end mark.
pub const LONGEST: usize = 240;
/// Longest name of one file or folder in bytes, the limit of Linux. Windows and macOS limit the number of UTF-16 units,
/// which is smaller.
const LONGEST_NAME: usize = 255;
/// Characters that Windows does not allow in names, besides control characters.
const FORBIDDEN: &str = "<>:\"\\|?*";
/// Names of devices of Windows, in any case and with any extension. COM and LPT are followed by a digit.
const DEVICES: [&str; 6] = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"];
const NUMBERED_DEVICES: [&str; 2] = ["COM", "LPT"];

/// Check one path in a zip, with `/` between its parts.
///
/// # Errors
/// The path leads out of its folder, is too long, or contains a name that Windows does not allow.
pub fn check(path: &str) -> Result<()> {
    if path.starts_with('/') || path.split('/').any(|name| name == "..") {
        bail!(
            "{}: the path leads out of the folder of the unpacked FMU and could overwrite other files; remove this \
             entry",
            path.escape_debug()
        );
    }
    let length = path.encode_utf16().count();
    if length > LONGEST {
        bail!(
            "{path}: the path in the FMU has {length} characters, but Windows can unpack at most {LONGEST}; shorten \
             the names"
        );
    }
    path.split('/').try_for_each(|name| match fault(name) {
        Some(fault) => bail!("{}: {fault}, so Windows cannot unpack this file; rename this file", path.escape_debug()),
        None => Ok(()),
    })
}

/// The fault of a name.
fn fault(name: &str) -> Option<String> {
    if name.is_empty() || name == "." {
        return Some(format!("the path contains the folder or file name \"{name}\""));
    }
    if name.len() > LONGEST_NAME {
        return Some(format!("a name has {} bytes, but at most {LONGEST_NAME} are allowed", name.len()));
    }
    if let Some(c) = name.chars().find(|&c| c.is_control() || FORBIDDEN.contains(c)) {
        return Some(format!("the name contains the character {c:?}"));
    }
    if name.ends_with(['.', ' ']) {
        return Some("the name ends in a dot or a space".to_owned());
    }
    let stem = name.split('.').next().unwrap_or_default().trim_end_matches(' ').to_ascii_uppercase();
    let is_numbered = NUMBERED_DEVICES.iter().filter_map(|device| stem.strip_prefix(device)).any(|rest| {
        let mut digits = rest.chars();
        matches!((digits.next(), digits.next()), (Some('0'..='9' | '¹' | '²' | '³'), None))
    });
    if is_numbered || DEVICES.contains(&stem.as_str()) {
        return Some(format!("{stem} is the name of a device of Windows"));
    }
    None
}

/// Check that no two of these paths, or of their folders, differ only by case: on Windows and macOS one would replace
/// the other.
///
/// # Errors
/// The first such pair.
pub fn check_case<'a>(paths: impl Iterator<Item = &'a str>) -> Result<()> {
    let mut known: HashMap<String, &str> = HashMap::new();
    for path in paths {
        let ends = path.match_indices('/').map(|(end, _)| end).chain([path.len()]);
        for part in ends.map(|end| &path[..end]) {
            let other = *known.entry(part.to_lowercase()).or_insert(part);
            if other != part {
                bail!(
                    "{other} and {part}: the names differ by case only, so on Windows one file replaces the other; \
                     rename one of the two"
                );
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_out_of_the_folder_are_rejected() {
        for path in ["extra/../a", "../../a", "/etc/a", ".."] {
            let message = check(path).unwrap_err().to_string();
            assert!(message.contains("leads out of the folder") && !message.contains("Windows"), "{message}");
        }
    }

    #[test]
    fn names_that_windows_does_not_allow_are_rejected() {
        for (path, words) in [
            ("documentation/CON", "CON is the name of a device"),
            ("documentation/nul.txt", "NUL is the name of a device"),
            ("extra/aux /page.html", "ends in a dot or a space"),
            ("extra/aux .html", "AUX is the name of a device"),
            ("extra/com1.tar.gz", "COM1 is the name of a device"),
            ("extra/LPT².x", "LPT² is the name of a device"),
            ("extra/conin$", "CONIN$ is the name of a device"),
            ("extra/a<b", "the character '<'"),
            ("extra/a>b", "the character '>'"),
            ("extra/a:b", "the character ':'"),
            ("extra/a\"b", "the character '\"'"),
            ("extra/a|b", "the character '|'"),
            ("extra/a?b", "the character '?'"),
            ("extra/a*b", "the character '*'"),
            ("extra/a\\b", "the character '\\\\'"),
            ("extra/a\nb", "the character '\\n'"),
            ("extra/a\u{7f}b", "the character '\\u{7f}'"),
            ("extra/a.", "ends in a dot or a space"),
            ("extra/a ", "ends in a dot or a space"),
            ("extra//a", "the path contains the folder or file name \"\""),
        ] {
            let message = check(path).unwrap_err().to_string();
            assert!(message.contains(words) && message.ends_with("this file") && !message.contains('\n'), "{message}");
        }
        for path in ["documentation/index.html", "extra/com10", "extra/CONSOLE.txt", "extra/COM", "extra/ä ö.txt"] {
            check(path).unwrap();
        }
    }

    #[test]
    fn long_paths_are_rejected() {
        let path = |n: usize| format!("extra/{}", "abcdefghi/".repeat(30))[..n].replace("i/a", "iba");
        check(&path(LONGEST)).unwrap();
        let message = check(&path(LONGEST + 1)).unwrap_err().to_string();
        assert!(message.contains("has 241 characters, but Windows can unpack at most 240"), "{message}");
        // 86 characters of three bytes each.
        let message = check(&"\u{4e00}".repeat(86)).unwrap_err().to_string();
        assert!(message.contains("a name has 258 bytes, but at most 255"), "{message}");
    }

    #[test]
    fn names_that_differ_by_case_are_rejected() {
        for paths in [["extra/a", "extra/A"], ["extra/Ä", "extra/ä"], ["extra/x/1", "extra/X/2"]] {
            let message = check_case(paths.into_iter()).unwrap_err().to_string();
            assert!(message.contains("differ by case only"), "{message}");
        }
        check_case(["extra/a", "documentation/A", "extra/b/A", "extra/c/a"].into_iter()).unwrap();
    }
}
