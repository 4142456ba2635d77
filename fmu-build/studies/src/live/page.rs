//! The live page: the page of `view`, with the definition next to the drawing.

use super::engine::{Asked, Engine};
use super::file::Text;
use anyhow::Result;
use fmu_build::workspace::MECHANISM;
use fmu_build::{schema, view};
use serde_json::json;

const BODY: &str = include_str!("page/live.html");
const STYLE: &str = include_str!("page/live.css");
/// CodeMirror 6 with its packages in one file, which starts with their licences.
const EDITOR: &str = include_str!("page/editor/editor.min.js");
/// Parts of the script, in order.
const SCRIPTS: [&str; 7] = [
    include_str!("page/text.js"),
    include_str!("page/schema.js"),
    include_str!("page/editor.js"),
    include_str!("page/knobs.js"),
    include_str!("page/handles.js"),
    include_str!("page/wrong.js"),
    include_str!("page/live.js"),
];

/// The page of a version of the file.
///
/// # Errors
/// The template is invalid.
pub fn html(engine: &Engine, version: u64, text: Text) -> Result<String> {
    let (text, error) = text.map_or_else(|error| (String::new(), Some(error)), |text| (text, None));
    let outcome = engine.run(&Asked { text: text.clone(), values: Vec::new() })?;
    let first =
        json!({ "shown": engine.shown(), "version": version, "text": text, "error": error, "notes": outcome.notes });
    let schema = String::from_utf8(schema::text(MECHANISM))?;
    let live = view::Live {
        style: STYLE,
        body: BODY,
        library: EDITOR,
        script: &["(() => {\n", &SCRIPTS.concat(), "})();\n"].concat(),
        data: &[("live-first", &first.to_string()), ("live-schema", &schema)],
    };
    view::live(&outcome.data, &live)
}
