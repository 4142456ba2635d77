//! The schemas of definition files, one per kind of model, built from the tables of keys. Every FMU contains the schema
//! next to its definition.
//!
//! The schema serves users who edit numbers in an unpacked FMU. A relative path needs only its name.

mod generated;

use linkage_fmu::format::{Member, parse};

/// Name of the schema of a kind's definition file, in `modelDescription/` and in an FMU's `resources/`:
/// `mechanism.schema.json` for `mechanism.json`.
pub fn name(definition_file: &str) -> String {
    [definition_file.strip_suffix(".json").unwrap_or(definition_file), ".schema.json"].concat()
}

/// The schema of a kind's definition file.
pub fn text(definition_file: &str) -> Vec<u8> {
    generated::schema(definition_file).into_bytes()
}

/// The text of a definition without faults, with its `"$schema"` set to the schema `name` in the same folder. A text
/// without this key stays unchanged.
pub fn with_schema_path(definition: &str, name: &str) -> String {
    let root = parse("definition", definition).ok();
    let schema = root.as_ref().and_then(|root| root.member("$schema")).filter(|member| member.value.text().is_some());
    match schema {
        Some(Member { value, .. }) => {
            format!("{}\"{name}\"{}", &definition[..value.span.start], &definition[value.span.end..])
        }
        None => definition.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ssp::definition;
    use crate::workspace::Workspace;
    use linkage_fmu::component::Component;
    use std::fs;

    #[test]
    fn the_schema_key_becomes_the_path_to_the_schema() {
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
            assert_eq!(with_schema_path(text, "mechanism.schema.json"), expected);
        }
    }

    /// With LINKAGE_FMU_WRITE set, the committed schemas are rewritten.
    #[test]
    fn the_committed_schemas_are_those_of_the_tables() {
        let workspace = Workspace::locate();
        for file in Component::definition_files().into_iter().chain([definition::FILE]) {
            let (path, schema) = (workspace.descriptions().join(name(file)), generated::schema(file));
            let read: serde_json::Value = serde_json::from_str(&schema).unwrap();
            assert_eq!(read["additionalProperties"], false, "{file}");
            if std::env::var_os("LINKAGE_FMU_WRITE").is_some() {
                fs::write(&path, &schema).unwrap();
            }
            let same = fs::read_to_string(&path).unwrap() == schema;
            assert!(same, "{}: LINKAGE_FMU_WRITE=1 cargo test -p fmu-build --lib schema writes it", path.display());
        }
    }
}
