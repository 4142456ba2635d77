//! The schema of `mechanism.json`, which goes into every FMU beside the mechanism.
//!
//! There it serves whoever edits the numbers in an unpacked FMU, and a relative path needs no more than its name.

/// Name of the schema's file, in `modelDescription/` and in an FMU's `resources/`.
pub const NAME: &str = "mechanism.schema.json";
/// The schema.
pub const TEXT: &str = include_str!("../../modelDescription/mechanism.schema.json");

/// The text of a mechanism that was read without fault, with its `"$schema"` leading to the schema beside it; a text
/// without that key stays as it is.
pub fn led_here(mechanism: &str) -> String {
    const KEY: &str = "\"$schema\"";
    // Only the top level has this key, names being letters, and no string can be followed by a colon unless it is a
    // key.
    for (at, _) in mechanism.match_indices(KEY) {
        let Some(value) = mechanism[at + KEY.len()..].trim_start().strip_prefix(':') else { continue };
        let value = value.trim_start();
        let mut strings = serde_json::Deserializer::from_str(value).into_iter::<serde_json::Value>();
        if let Some(Ok(serde_json::Value::String(_))) = strings.next() {
            let (start, end) = (mechanism.len() - value.len(), strings.byte_offset());
            return format!("{}\"{NAME}\"{}", &mechanism[..start], &value[end..]);
        }
    }
    mechanism.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert_eq!(led_here(text), expected);
        }
    }
}
