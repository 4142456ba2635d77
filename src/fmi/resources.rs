//! The resources of the FMU: their folder and the component that is defined in it. The host states the folder, or the
//! folder is found from the path of this library.
//!
//! In: the resource location and the GUID that the host passes. Out: a component. Hosts write a location as
//! `file:///p`, `file:/p`, `file://localhost/p` or as a plain path, with and without percent-encoding and a trailing
//! slash.
#![allow(unsafe_code)]

use super::refusal::Refusal;
use crate::component::{Component, ModelKind};
use std::ffi::CStr;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

pub use crate::format::LARGEST_DEFINITION;

/// Loads the component of a new instance, which is of one of the `kinds` in the library. The definition is read at each
/// instantiation, so that a user may edit its numbers. The tables of the packed definition are then computed again.
///
/// The folder is `location`. If `location` is NULL or empty, the folder is `resources` of the FMU that contains this
/// library. `guid` is the GUID that the host passes in the argument `guid_argument`.
///
/// # Errors
/// A missing or unreadable definition file, a faulty definition, or a GUID of a different interface.
pub fn load(
    kinds: &[ModelKind],
    guid_argument: &str,
    guid: Option<&CStr>,
    location: Option<&CStr>,
) -> Result<Loaded, Refusal> {
    let guid = guid.filter(|guid| !guid.is_empty()).ok_or_else(|| {
        Refusal::error(format!("{guid_argument} is NULL or empty; pass the value from modelDescription.xml"))
    })?;
    let folder = match location.filter(|location| !location.is_empty()) {
        Some(location) => from_uri(location.to_bytes())?,
        None => resources_folder()?,
    };
    let kind = kinds.iter().find(|kind| folder.join(kind.file()).exists()).unwrap_or(&kinds[0]);
    let file = folder.join(kind.file());
    let text = read(&file)?;
    let (component, remark) = Component::with_tables(kind, &text, &folder)
        .map_err(|refused| Refusal::error(format!("'{}': {}", file.display(), refused.0)))?;
    let own = component.interface().guid();
    if guid.to_bytes() != own.as_bytes() {
        return Err(Refusal::error(format!(
            "{guid_argument} is '{}', but the variables of the definition '{}' belong to the GUID '{own}'; import the \
             FMU again, or restore the original names of the elements in the definition",
            guid.to_bytes().escape_ascii(),
            file.display(),
        )));
    }
    Ok(Loaded { component, remark })
}

/// A component for a new instance, with the remark from loading it.
pub struct Loaded {
    pub component: Component,
    pub remark: Option<String>,
}

impl From<Component> for Loaded {
    fn from(component: Component) -> Self {
        Self { component, remark: None }
    }
}

/// Text of a file. Only a regular file is opened, because reading a pipe could block. A file above the size limit is
/// not read.
fn read(file: &Path) -> Result<String, Refusal> {
    let refused = |reason: String| Refusal::error(format!("cannot read '{}': {reason}", file.display()));
    let metadata = std::fs::metadata(file).map_err(|error| refused(error.to_string()))?;
    if !metadata.is_file() {
        return Err(refused("this is not a file; put the definition file of the model at this path".to_owned()));
    }
    let too_large = |size: u64| {
        refused(format!(
            "the file has {size} bytes, but a definition may have at most {LARGEST_DEFINITION} bytes; check that this \
             is the right file"
        ))
    };
    if metadata.len() > LARGEST_DEFINITION {
        return Err(too_large(metadata.len()));
    }
    let mut text = String::new();
    let read = File::open(file).and_then(|file| file.take(LARGEST_DEFINITION + 1).read_to_string(&mut text));
    match read {
        // The size in the metadata may be wrong.
        Ok(size) if size as u64 > LARGEST_DEFINITION => Err(too_large(size as u64)),
        Ok(_) => Ok(text),
        Err(error) => Err(refused(error.to_string())),
    }
}

/// Folder that the host states as a URI or a plain path.
///
/// # Errors
/// A scheme other than `file`, another machine, or a path that this platform cannot express.
fn from_uri(uri: &[u8]) -> Result<PathBuf, Refusal> {
    local_path(uri, if cfg!(windows) { System::Windows } else { System::Unix })
        .map_err(|why| Refusal::error(format!("the resource location '{}' {why}", uri.escape_ascii())))
        .and_then(path)
}

/// Operating systems with different paths.
#[derive(Clone, Copy, PartialEq)]
enum System {
    Unix,
    Windows,
}

/// Path of a URI or of a plain path.
///
/// A URI is percent-decoded. An invalid escape (`%zz`) and a plain path are not changed. On Windows a path starts with
/// a drive (`file:///C:/p`, also `file://C:/p` and `file:///C|/p`), or names a share of another machine. Windows opens
/// the share by its UNC path: `file://server/share/p` and `file:////server/share/p` are `//server/share/p`.
///
/// # Errors
/// A scheme other than `file`, or, on Unix, another machine.
fn local_path(uri: &[u8], system: System) -> Result<Vec<u8>, String> {
    let Some(rest) = strip_prefix_ignoring_case(uri, b"file:") else {
        let Some(scheme) = scheme(uri) else { return Ok(uri.to_vec()) };
        let scheme = scheme.escape_ascii();
        return Err(format!("has the scheme '{scheme}'; only 'file:' URIs and plain paths can be read"));
    };
    let decoded = percent_decoded(rest);
    let Some(after) = decoded.strip_prefix(b"//") else { return Ok(without_slash_before_drive(&decoded, system)) };
    if after.starts_with(b"/") {
        return Ok(without_slash_before_drive(after, system));
    }
    match strip_prefix_ignoring_case(after, b"localhost") {
        Some(path) if path.starts_with(b"/") => Ok(without_slash_before_drive(path, system)),
        _ if system == System::Windows && drive(after).is_some() => Ok(without_slash_before_drive(after, system)),
        _ if system == System::Windows && after.contains(&b'/') => Ok(decoded),
        _ => Err("names another computer; write 'file:///' and an absolute path".to_owned()),
    }
}

/// Drive letter at the start of a Windows path, followed by `:` or `|`.
fn drive(path: &[u8]) -> Option<u8> {
    match *path {
        [letter, b':' | b'|'] | [letter, b':' | b'|', b'/' | b'\\', ..] if letter.is_ascii_alphabetic() => Some(letter),
        _ => None,
    }
}

/// The path of a URI on this system. On Windows `/C:/p` and `/C|/p` become `C:/p`, and at most two slashes stay before
/// the name of a server.
fn without_slash_before_drive(path: &[u8], system: System) -> Vec<u8> {
    if system == System::Unix {
        return path.to_vec();
    }
    let bare = &path[path.iter().take_while(|&&byte| byte == b'/').count()..];
    if let Some(letter) = drive(bare) {
        return [&[letter, b':'], &bare[2..]].concat();
    }
    if bare.starts_with(b"\\\\") {
        return bare.to_vec();
    }
    let slashes = (path.len() - bare.len()).min(2);
    [&b"//"[..slashes], bare].concat()
}

/// Folder `resources` of the FMU from which this library was loaded: `binaries/<platform>/../../resources`.
///
/// # Errors
/// The system does not return the path of the library.
fn resources_folder() -> Result<PathBuf, Refusal> {
    let library = library_path().ok_or_else(|| {
        Refusal::error(
            "the resource location is empty, and the FMU cannot find the folder of its library; pass the path of the \
             resources folder of the FMU",
        )
    })?;
    Ok(resources_of(&library))
}

/// On Unix the path of the library may be relative and may have too few folders for `ancestors`.
#[cfg(unix)]
fn resources_of(library: &Path) -> PathBuf {
    let folder = library.parent().map(PathBuf::from).unwrap_or_default();
    folder.join("..").join("..").join("resources")
}

/// On Windows the path of the library is absolute. In a path that starts with `\\?\`, `..` would be a name.
#[cfg(not(unix))]
fn resources_of(library: &Path) -> PathBuf {
    library.ancestors().nth(3).unwrap_or(Path::new("")).join("resources")
}

#[cfg(unix)]
fn library_path() -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    let mut info = std::mem::MaybeUninit::<libc::Dl_info>::zeroed();
    let address = library_path as *const std::ffi::c_void;
    // SAFETY: dladdr(3) accepts any address and fills `info` if it returns non-zero. `dli_fname` is then NULL or a
    // string that is valid while the library is loaded, which is longer than this call.
    unsafe {
        if libc::dladdr(address, info.as_mut_ptr()) == 0 {
            return None;
        }
        let name = info.assume_init().dli_fname;
        let name = (!name.is_null()).then(|| CStr::from_ptr(name))?;
        Some(PathBuf::from(std::ffi::OsStr::from_bytes(name.to_bytes())))
    }
}

#[cfg(windows)]
fn library_path() -> Option<PathBuf> {
    use std::ffi::{OsString, c_void};
    use std::os::windows::ffi::OsStringExt;

    /// Flags: the address is within the module, and the reference count of the module does not change.
    const OF_ADDRESS: u32 = 4 | 2;
    /// Largest number of characters of a Windows path.
    const LONGEST: usize = 32_768;

    #[link(name = "kernel32")]
    unsafe extern "system" {
        fn GetModuleHandleExW(flags: u32, address: *const c_void, module: *mut *mut c_void) -> i32;
        fn GetModuleFileNameW(module: *mut c_void, name: *mut u16, size: u32) -> u32;
    }

    let mut module = std::ptr::null_mut();
    let mut name = vec![0_u16; LONGEST];
    // SAFETY: with these flags any address is allowed. `module` is set if the call returns non-zero, and stays loaded
    // during this call, because its code runs. At most `LONGEST` characters are written to `name`.
    let length = unsafe {
        if GetModuleHandleExW(OF_ADDRESS, library_path as *const c_void, &raw mut module) == 0 {
            return None;
        }
        GetModuleFileNameW(module, name.as_mut_ptr(), LONGEST as u32) as usize
    };
    // 0: failed. `LONGEST`: the path was cut off.
    (0 < length && length < LONGEST).then(|| PathBuf::from(OsString::from_wide(&name[..length])))
}

#[cfg(not(any(unix, windows)))]
fn library_path() -> Option<PathBuf> {
    None
}

#[cfg(unix)]
fn path(bytes: Vec<u8>) -> Result<PathBuf, Refusal> {
    use std::os::unix::ffi::OsStringExt;
    Ok(PathBuf::from(std::ffi::OsString::from_vec(bytes)))
}

#[cfg(not(unix))]
fn path(bytes: Vec<u8>) -> Result<PathBuf, Refusal> {
    String::from_utf8(bytes).map(PathBuf::from).map_err(|_| Refusal::error("the resource location is not UTF-8"))
}

/// Scheme of a URI, of at least two letters: one letter is a drive.
fn scheme(uri: &[u8]) -> Option<&[u8]> {
    let end = uri.iter().position(|&byte| byte == b':')?;
    let is_scheme = end > 1 && uri[..end].iter().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(b));
    is_scheme.then_some(&uri[..end])
}

fn strip_prefix_ignoring_case<'a>(text: &'a [u8], prefix: &[u8]) -> Option<&'a [u8]> {
    let (head, rest) = text.split_at_checked(prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then_some(rest)
}

fn percent_decoded(text: &[u8]) -> Vec<u8> {
    let digit = |at: usize| text.get(at).and_then(|&byte| char::from(byte).to_digit(16));
    let mut decoded = Vec::with_capacity(text.len());
    let mut at = 0;
    while at < text.len() {
        match (text[at], digit(at + 1), digit(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                decoded.push((16 * high + low) as u8);
                at += 3;
            }
            (byte, ..) => {
                decoded.push(byte);
                at += 1;
            }
        }
    }
    decoded
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn accepts(uri: &str, expected: &str) {
        assert_eq!(from_uri(uri.as_bytes()).as_deref(), Ok(Path::new(expected)), "{uri}");
    }

    #[test]
    fn the_forms_that_hosts_pass() {
        accepts("file:///tmp/fmu/resources", "/tmp/fmu/resources");
        accepts("file:/tmp/fmu/resources", "/tmp/fmu/resources");
        accepts("file://localhost/tmp/fmu/resources", "/tmp/fmu/resources");
        accepts("FILE://LocalHost/tmp/fmu/resources", "/tmp/fmu/resources");
        accepts("file:///tmp/fmu/resources/", "/tmp/fmu/resources");
        // ECOS puts `file:///` before an absolute path.
        accepts("file:////tmp/fmu/resources", "/tmp/fmu/resources");
        accepts("/tmp/fmu/resources", "/tmp/fmu/resources");
        accepts("fmu/resources", "fmu/resources");
    }

    #[test]
    fn percent_encoding_and_utf8() {
        accepts("file:///tmp/a%20b/r%C3%A4der", "/tmp/a b/räder");
        accepts("file:///tmp/a b/räder", "/tmp/a b/räder");
        accepts("file:///tmp/100%25/%zz/%4", "/tmp/100%/%zz/%4");
        accepts("/tmp/a%20b", "/tmp/a%20b");
    }

    #[test]
    fn the_forms_that_hosts_pass_on_windows() {
        for (uri, expected) in [
            ("file:///C:/fmu/resources", "C:/fmu/resources"),
            ("file:/C:/fmu/resources", "C:/fmu/resources"),
            ("file:C:/fmu/resources", "C:/fmu/resources"),
            ("file://C:/fmu/resources", "C:/fmu/resources"),
            ("file://localhost/c:/fmu/resources", "c:/fmu/resources"),
            ("file:////C:/fmu/resources", "C:/fmu/resources"),
            ("file:///C%3A/fmu/resources", "C:/fmu/resources"),
            ("file:///C|/fmu/resources", "C:/fmu/resources"),
            ("file:///C:\\fmu\\resources", "C:\\fmu\\resources"),
            ("file:///C:", "C:"),
            ("file:///C:/Program%20Files/R%C3%A4der/", "C:/Program Files/Räder/"),
            ("file://server/share/fmu%20a", "//server/share/fmu a"),
            ("file:////server/share/fmu", "//server/share/fmu"),
            ("file://///server/share/fmu", "//server/share/fmu"),
            ("file:///\\\\server\\share", "\\\\server\\share"),
            ("C:\\a b\\100%25", "C:\\a b\\100%25"),
            ("C:/fmu/resources", "C:/fmu/resources"),
            ("\\\\server\\share\\Räder", "\\\\server\\share\\Räder"),
            ("\\\\?\\C:\\fmu", "\\\\?\\C:\\fmu"),
            ("fmu/resources", "fmu/resources"),
        ] {
            assert_eq!(local_path(uri.as_bytes(), System::Windows).as_deref(), Ok(expected.as_bytes()), "{uri}");
        }
        for uri in ["http://host/p", "file://", "file://server", "zip:/p"] {
            assert!(local_path(uri.as_bytes(), System::Windows).is_err(), "{uri}");
        }
    }

    /// A drive's letter means nothing on Unix.
    #[test]
    fn drives_on_unix_are_names() {
        accepts("file:///C:/fmu", "/C:/fmu");
        accepts("file:////server/share", "/server/share");
        assert!(from_uri(b"file://C:/fmu").is_err());
    }

    #[test]
    fn other_schemes_and_machines_are_rejected() {
        for uri in ["http://host/p", "file://server/share", "file://", "file://localhostile/p", "zip:/p"] {
            let refusal = from_uri(uri.as_bytes()).unwrap_err();
            assert!(refusal.message.contains(uri), "{}", refusal.message);
        }
    }

    #[test]
    fn the_resources_folder_is_found_from_the_library() {
        assert!(resources_folder().unwrap().ends_with("../../resources"));
    }
}
