//! The FMU's resources: the folder that the host names or that lies beside this library, and the component defined
//! there.
//!
//! In: the resource location and the GUID, as the host passes them. Out: a component. Hosts write a location as
//! `file:///p`, `file:/p`, `file://localhost/p` or as a plain path, with and without percent-encoding and a trailing
//! slash.
#![allow(unsafe_code)]

use super::refusal::Refusal;
use crate::component::Component;
use std::ffi::CStr;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

pub use crate::format::LARGEST_DEFINITION;

/// Component of a new instance. Its definition is read at each instantiation, so that a user may edit the numbers in
/// it; tables of the definition as it was packed are then made anew.
///
/// The folder is that of `location`; where that is NULL or empty, the folder `resources` of the FMU in which this
/// library lies. `guid` is the host's, in its argument of the name `guid_argument`.
///
/// # Errors
/// No or an unreadable definition file, a faulty definition, another interface than that of the GUID.
pub fn load(guid_argument: &str, guid: Option<&CStr>, location: Option<&CStr>) -> Result<Loaded, Refusal> {
    let guid = guid.filter(|guid| !guid.is_empty()).ok_or_else(|| {
        Refusal::error(format!("{guid_argument} is NULL or empty; pass the one of modelDescription.xml"))
    })?;
    let folder = match location.filter(|location| !location.is_empty()) {
        Some(location) => from_uri(location.to_bytes())?,
        None => beside_library()?,
    };
    let names = Component::definition_files();
    let name = names.into_iter().find(|name| folder.join(name).exists()).unwrap_or(names[0]);
    let file = folder.join(name);
    let text = read(&file)?;
    let (component, remark) = Component::with_tables(name, &text, &folder)
        .map_err(|refused| Refusal::error(format!("'{}': {}", file.display(), refused.0)))?;
    let own = component.interface().guid();
    if guid.to_bytes() != own.as_bytes() {
        return Err(Refusal::error(format!(
            "{guid_argument} is '{}', but '{}' has the interface '{own}'; \
             import the FMU again, or restore the names in the file",
            guid.to_bytes().escape_ascii(),
            file.display(),
        )));
    }
    Ok(Loaded { component, remark })
}

/// A component for a new instance, and what was remarked while it was loaded.
pub struct Loaded {
    pub component: Component,
    pub remark: Option<String>,
}

impl From<Component> for Loaded {
    fn from(component: Component) -> Self {
        Self { component, remark: None }
    }
}

/// Text of a file. Only a regular file is opened, as reading a pipe could wait for ever; a file that is too large is
/// not read.
fn read(file: &Path) -> Result<String, Refusal> {
    let refused = |reason: String| Refusal::error(format!("cannot read '{}': {reason}", file.display()));
    let metadata = std::fs::metadata(file).map_err(|error| refused(error.to_string()))?;
    if !metadata.is_file() {
        return Err(refused("it is no file; put the model's definition there".to_owned()));
    }
    let too_large = |size: u64| {
        refused(format!("it has {size} bytes, and a definition at most {LARGEST_DEFINITION}; is it the right file?"))
    };
    if metadata.len() > LARGEST_DEFINITION {
        return Err(too_large(metadata.len()));
    }
    let mut text = String::new();
    let read = File::open(file).and_then(|file| file.take(LARGEST_DEFINITION + 1).read_to_string(&mut text));
    match read {
        // The size in the metadata need not be the true one.
        Ok(size) if size as u64 > LARGEST_DEFINITION => Err(too_large(size as u64)),
        Ok(_) => Ok(text),
        Err(error) => Err(refused(error.to_string())),
    }
}

/// Folder that the host names by a URI or a plain path.
///
/// A URI is percent-decoded; an invalid escape (`%zz`) is kept as it is. So is a plain path.
///
/// # Errors
/// A scheme other than `file`, another machine, or a path that this platform cannot express.
fn from_uri(uri: &[u8]) -> Result<PathBuf, Refusal> {
    let refused = |why: String| Err(Refusal::error(format!("the resource location '{}' {why}", uri.escape_ascii())));
    let Some(rest) = strip_prefix_ignoring_case(uri, b"file:") else {
        let Some(scheme) = scheme(uri) else { return path(uri.to_vec()) };
        let scheme = scheme.escape_ascii();
        return refused(format!("has the scheme '{scheme}'; only 'file:' URIs and plain paths can be read"));
    };
    let local = match rest.strip_prefix(b"//") {
        None => rest,
        Some(after) if after.starts_with(b"/") => after,
        Some(after) => match strip_prefix_ignoring_case(after, b"localhost") {
            Some(path) if path.starts_with(b"/") => path,
            _ => return refused("names another machine; write 'file:///' and an absolute path".to_owned()),
        },
    };
    path(without_slash_before_drive(percent_decoded(local)))
}

/// Folder `resources` of the FMU from which this library was loaded: `binaries/<platform>/../../resources`.
///
/// # Errors
/// The system does not know where the library is.
fn beside_library() -> Result<PathBuf, Refusal> {
    let library = library_path().ok_or_else(|| {
        Refusal::error(
            "the resource location is empty and the library's own place is unknown; pass the resources folder",
        )
    })?;
    let folder = library.parent().map(PathBuf::from).unwrap_or_default();
    Ok(folder.join("..").join("..").join("resources"))
}

#[cfg(unix)]
fn library_path() -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    let mut info = std::mem::MaybeUninit::<libc::Dl_info>::zeroed();
    let address = library_path as *const std::ffi::c_void;
    // SAFETY: dladdr(3) takes any address and fills `info` if it returns non-zero; `dli_fname` is then NULL or a string
    // that lives as long as the library, which is longer than this call.
    unsafe {
        if libc::dladdr(address, info.as_mut_ptr()) == 0 {
            return None;
        }
        let name = info.assume_init().dli_fname;
        let name = (!name.is_null()).then(|| CStr::from_ptr(name))?;
        Some(PathBuf::from(std::ffi::OsStr::from_bytes(name.to_bytes())))
    }
}

#[cfg(not(unix))]
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

/// Scheme of a URI: two letters or more, as one letter is a drive.
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

/// `/C:/p` of `file:///C:/p` is `C:/p` on Windows.
fn without_slash_before_drive(mut path: Vec<u8>) -> Vec<u8> {
    if cfg!(windows) && path.first() == Some(&b'/') && path.get(2) == Some(&b':') {
        path.remove(0);
    }
    path
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
    fn other_schemes_and_machines_are_refused() {
        for uri in ["http://host/p", "file://server/share", "file://", "file://localhostile/p", "zip:/p"] {
            let refusal = from_uri(uri.as_bytes()).unwrap_err();
            assert!(refusal.message.contains(uri), "{}", refusal.message);
        }
    }

    #[test]
    fn the_library_knows_its_place() {
        assert!(beside_library().unwrap().ends_with("../../resources"));
    }
}
