//! A finding with its place in a text.
//!
//! In: a finding and its range of bytes. Out: the finding with line and column. It must not know how faults are found.

use linkage_fmu::format::{Node, Place};
use linkage_fmu::inspection::Finding;
use std::ops::Range;

/// Key of the file of shared parameters, and the path that replaces the key by the contents of the file.
const SHARED: &str = "parameters_from";
const SHARED_CONTENTS: &str = "parameters_from.contents";

/// Largest number of reported faults.
pub const MOST: usize = 100;

/// A finding with its place in the text.
#[derive(Clone, Debug)]
pub struct Located {
    /// The finding.
    pub finding: Finding,
    /// Range of bytes that is underlined; empty for the whole file.
    pub span: Range<usize>,
    /// Line and column of the start of the range, from 1.
    pub position: [usize; 2],
}

/// Convert a finding about a shared parameter: it refers to the key that names the file, and its text contains the path
/// in this file.
fn of_shared(root: &Node, finding: &mut Finding, span: &mut Range<usize>) -> Option<()> {
    let path = shared_path(&finding.path)?;
    let shared = root.member(SHARED)?;
    let file = shared.value.member("file")?.value.text()?;
    let rest = finding.message.strip_prefix(finding.path.as_str()).unwrap_or(&finding.message);
    let rest = rest.strip_suffix(&format!(" (in {file})")).unwrap_or(rest);
    finding.message = format!("{SHARED}: {file}: {path}{rest}");
    (finding.path, *span) = (SHARED.to_owned(), shared.span.clone());
    Some(())
}

/// A finding about this range of the text.
pub fn at(text: &str, root: Option<&Node>, mut finding: Finding, mut span: Range<usize>) -> Located {
    root.and_then(|root| of_shared(root, &mut finding, &mut span));
    Located { position: Place::new(text, span.clone()).position, finding, span }
}

/// Path of a shared parameter in its own file. None for any other key.
fn shared_path(path: &str) -> Option<&str> {
    path.strip_prefix(SHARED_CONTENTS)?.strip_prefix('.')
}
