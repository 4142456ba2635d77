//! `cargo fmu view`: a page with the moving mechanism.
//!
//! In: a definition file, a folder that contains one, or an FMU. Out: one HTML file without other files. If the
//! definition gives no motion, the page shows how far the definition can be drawn, and the reason.

mod data;
mod page;
mod series;

use crate::check::{self, Checked};
use crate::command;
use crate::files;
use crate::fmu::Definition;
use crate::workspace::{MECHANISM, Workspace};
use anyhow::{Result, bail};
pub use data::{Data, Status, Wanted};
pub use fmu_cli::View as Arguments;
use linkage_fmu::inspection::Severity;
pub use page::{Live, as_script, html, live};
use std::path::{Path, is_separator};

/// Write the page. Returns whether it shows the whole requested motion.
///
/// # Errors
/// A path contains no mechanism, a start value is invalid, or the page cannot be written.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<bool> {
    let checked = checked_at(workspace, &arguments.path)?;
    let wanted = Wanted::new(arguments.stop_time, &arguments.start_values)?;
    let mut data = Data::collect(&checked, &wanted)?;
    if arguments.compare.is_some() || !arguments.compare_set.is_empty() {
        let wanted = wanted.compared(&arguments.compare_set);
        let other = match &arguments.compare {
            Some(path) => Data::collect(&checked_at(workspace, path)?, &wanted)?,
            None => Data::collect(&checked, &wanted)?,
        };
        if let Some(error) = &other.error {
            eprintln!("note: in the run that is compared: {error}");
        }
        data.compare_with(other, &arguments.compare_set);
    }
    let html = html(&data)?;
    let named = |folder: &Path| folder.join(format!("{}.html", data.file_name()));
    let path = match &arguments.out {
        Some(out) if out.is_dir() || out.as_os_str().to_string_lossy().ends_with(is_separator) => named(out),
        Some(out) => out.clone(),
        None => named(&workspace.output("view")),
    };
    files::replace_named(&path, "--out", html.as_bytes())?;
    let written = format!("{} ({} kB, {})", path.display(), html.len().div_ceil(1000), data.summary());
    match path.is_file() {
        true => println!("{written}"),
        // The page itself may be on the standard output.
        false => eprintln!("{written}"),
    }
    if arguments.open {
        command::show(&path)?;
    }
    if let Some(error) = &data.error {
        match checked.count(Severity::Error) {
            0 => eprintln!("error: {error}"),
            _ => eprint!("{}", check::findings(&checked)),
        }
    }
    Ok(data.error.is_none())
}

/// The checked definition of a mechanism at a path.
fn checked_at(workspace: &Workspace, path: &Path) -> Result<Checked> {
    let Definition { shown, kind, text } = Definition::read(workspace, path)?;
    if kind != MECHANISM {
        bail!(
            "{shown}: a {kind} has no mechanism that can be drawn; give the path of a {MECHANISM}, or of the FMU of a \
             mechanism"
        );
    }
    check::check(shown, kind, text)
}

impl Checked {
    /// Name of the model, if its definition could be read.
    fn name(&self) -> Option<&str> {
        Some(self.inspection.name.as_str()).filter(|name| !name.is_empty())
    }
}
