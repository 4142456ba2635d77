//! The schemas of definition files, one for each kind of model, which go into every FMU beside its definition.
//!
//! There a schema serves whoever edits the numbers in an unpacked FMU, and a relative path needs no more than its name.

use crate::workspace::Workspace;
use anyhow::{Context, Result};
use std::fs;

/// Name of the schema of a kind's definition file, in `modelDescription/` and in an FMU's `resources/`:
/// `mechanism.schema.json` for `mechanism.json`.
pub fn name(definition_file: &str) -> String {
    [definition_file.strip_suffix(".json").unwrap_or(definition_file), ".schema.json"].concat()
}

/// The schema of a kind's definition file.
///
/// # Errors
/// The file cannot be read.
pub fn text(workspace: &Workspace, definition_file: &str) -> Result<Vec<u8>> {
    let path = workspace.descriptions().join(name(definition_file));
    fs::read(&path).with_context(|| format!("{}: cannot be read; restore it from the repository", path.display()))
}

/// The text of a definition that was read without fault, with its `"$schema"` leading to the schema `name` beside it; a
/// text without that key stays as it is.
pub fn led_here(definition: &str, name: &str) -> String {
    const KEY: &str = "\"$schema\"";
    // Only the top level has this key, names being letters, and no string can be followed by a colon unless it is a
    // key.
    for (at, _) in definition.match_indices(KEY) {
        let Some(value) = definition[at + KEY.len()..].trim_start().strip_prefix(':') else { continue };
        let value = value.trim_start();
        let mut strings = serde_json::Deserializer::from_str(value).into_iter::<serde_json::Value>();
        if let Some(Ok(serde_json::Value::String(_))) = strings.next() {
            let (start, end) = (definition.len() - value.len(), strings.byte_offset());
            return format!("{}\"{name}\"{}", &definition[..start], &value[end..]);
        }
    }
    definition.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use linkage_fmu::component::Component;

    #[test]
    fn the_key_leads_to_the_schema_beside_it() {
        for (text, expected) in [
            (r#"{ "$schema": "C:\\a \"b\"/x.json", "n": 1 }"#, r#"{ "$schema": "mechanism.schema.json", "n": 1 }"#),
            ("{\n\"$schema\"\n:\t\"é\"}", "{\n\"$schema\"\n:\t\"mechanism.schema.json\"}"),
            (r#"{"description": "$schema", "a": 1}"#, r#"{"description": "$schema", "a": 1}"#),
            (
                r#"{"description": "say \"$schema\": \"x\"", "$schema": ""}"#,
                r#"{"description": "say \"$schema\": \"x\"", "$schema": "mechanism.schema.json"}"#,
            ),
            (r#"{"$schema": null}"#, r#"{"$schema": null}"#),
        ] {
            assert_eq!(led_here(text, "mechanism.schema.json"), expected);
        }
    }

    #[test]
    fn each_kind_of_model_has_a_schema() {
        let workspace = Workspace::locate();
        for file in Component::definition_files() {
            let schema: serde_json::Value = serde_json::from_slice(&text(&workspace, file).unwrap()).unwrap();
            assert_eq!(schema["additionalProperties"], false, "{file}");
        }
        let message = text(&workspace, "other.json").unwrap_err().to_string();
        assert!(message.contains("other.schema.json"), "{message}");
    }
}
