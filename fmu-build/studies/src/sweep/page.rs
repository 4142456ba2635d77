//! The pictures of a study: a page for the browser and PNG files, drawn by a Python program from the results.
//!
//! In: the results, and the meaning of their columns. Out: files in the folder of the results. The module must not know
//! how a run is made.

use super::definition::{Definition, Method};
use super::table::{Column, Content};
use anyhow::Result;
use fmu_build::command;
use fmu_build::workspace::Workspace;
use serde_json::json;
use std::path::Path;
use std::process::Command;

/// The Python program.
const PROGRAM: &str = "study_page";
const REQUIREMENTS: &str = "study.txt";
/// File of the page in the folder of the results.
pub const PAGE: &str = "page.html";

/// Draw the pictures of a study with this name into the folder of the table. The first columns are the factors.
///
/// # Errors
/// The Python environment cannot be created, or the program fails.
pub fn draw(
    workspace: &Workspace,
    (name, definition): (&str, &Definition),
    (columns, factors): (&[Column], usize),
    (folder, table): (&Path, &str),
) -> Result<()> {
    let names = |columns: &[Column]| columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>();
    let is_number = |column: &Column| column.content == Content::Number;
    let sampled = definition.factors.iter().filter(|(_, factor)| factor.uniform.is_some() || factor.normal.is_some());
    let limits = definition.constraints.iter().map(|(name, limits)| json!([name, limits.at_least, limits.at_most]));
    let objective = definition.objective.as_ref();
    let plan = json!({
        "name": name,
        "factors": names(&columns[..factors]),
        "numbers": columns[..factors].iter().map(is_number).collect::<Vec<_>>(),
        "responses": names(&columns[factors..]),
        "sampled": sampled.map(|(name, _)| name).collect::<Vec<_>>(),
        "saltelli": definition.sampling.is_some_and(|sampling| sampling.method == Method::Saltelli),
        "minimise": objective.and_then(|objective| objective.minimise.as_ref()),
        "maximise": objective.and_then(|objective| objective.maximise.as_ref()),
        "limits": limits.collect::<Vec<_>>(),
    });
    let scripts = workspace.python_scripts();
    let python = command::environment(&workspace.target("venv-study"), &scripts.join(REQUIREMENTS))?;
    let mut program = Command::new(python);
    program.arg(scripts.join(PROGRAM)).arg(folder.join(table)).arg(plan.to_string()).arg("--out").arg(folder);
    command::run(&mut program, PROGRAM)
}
