//! `cargo fmu docs`: the documentation site, from `docs/` and `mkdocs.yml`, by MkDocs in its own environment.

use crate::command;
use crate::workspace::Workspace;
use anyhow::Result;
pub use fmu_cli::Docs as Arguments;
use std::process::Command;

/// Environment variable that suppresses a notice of the theme about other programs.
const NOTICE: &str = "NO_MKDOCS_2_WARNING";

/// Build the site into `target/docs`, and open it if asked.
///
/// # Errors
/// The environment cannot be created; a page has a broken link or is not in the navigation; no browser opens the site.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let root = workspace.root();
    let python = command::Python::Docs.interpreter(workspace)?;
    let site = workspace.target("docs");
    let mut mkdocs = Command::new(python);
    mkdocs.args(["-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir"]).arg(&site);
    command::run(mkdocs.current_dir(root).env(NOTICE, "1"), "mkdocs build")?;
    let page = site.join("index.html");
    println!("{}", page.display());
    if arguments.open {
        command::show(&page)?;
    }
    Ok(())
}
