//! Parameters that several definitions share: the contents of the file that a definition names replace its path.
//!
//! In: the text of a definition and its path. Out: a text that needs no other file, and in which the rest keeps its
//! line numbers. The module must not know what the parameters mean.

use crate::files;
use anyhow::{Context, Result, bail};
use jsonc_parser::ast::Value;
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};
use linkage_fmu::fmi::LARGEST_DEFINITION;
use linkage_fmu::mechanism::definition::SharedContents;
use std::path::{Path, PathBuf};

/// Key of the path.
const KEY: &str = "parameters_from";

/// The text of a definition with the contents of the file that it names, if it names one.
///
/// # Errors
/// The file cannot be read, or is no file of parameters.
pub fn completed(definition: &Path, text: String) -> Result<String> {
    // The later reader of the text reports invalid JSON.
    let Some((range, name)) = named(&text) else { return Ok(text) };
    if name.is_empty() {
        bail!("{}: {KEY}: \"\" is not a file name; give a file of parameters, or remove the key", definition.display());
    }
    let path = definition.parent().unwrap_or(Path::new("")).join(&name);
    let shown = format!("{}: {KEY}: {}", definition.display(), path.display());
    let contents =
        files::read(&path, LARGEST_DEFINITION).with_context(|| format!("{}: {KEY}", definition.display()))?;
    let contents = String::from_utf8(contents)
        .ok()
        .with_context(|| format!("{shown}: the file is not UTF-8 text; save the file as UTF-8"))?;
    SharedContents::check(&contents).with_context(|| shown)?;
    // A text in JSON cannot contain a line break, so spaces may replace all line breaks.
    let contents = contents.trim_start_matches('\u{feff}').replace(['\r', '\n'], " ");
    let object = format!("{{ \"file\": {}, \"contents\": {} }}", serde_json::to_string(&name)?, contents.trim());
    Ok([&text[..range.0], &object, &text[range.1..]].concat())
}

/// Path of the file of shared parameters that the definition at a path names, if its text names one.
pub fn file(definition: &Path, text: &str) -> Option<PathBuf> {
    named(text).map(|(_, name)| definition.parent().unwrap_or(Path::new("")).join(name))
}

/// Range of bytes of the path in the text, and the path. None if the definition names no file.
fn named(text: &str) -> Option<((usize, usize), String)> {
    if !text.contains(KEY) {
        return None;
    }
    let parsed = parse_to_ast(text, &CollectOptions::default(), &ParseOptions::default()).ok()?.value?;
    let Value::Object(object) = parsed else { return None };
    let property = object.properties.iter().find(|property| property.name.as_str() == KEY)?;
    let Value::StringLit(path) = &property.value else { return None };
    let range = path.range();
    Some(((range.start, range.end), path.value.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use linkage_fmu::component::Component;
    use std::fs;

    const BLOCK: &str = r#"{
  "name": "Block",
  "parameters_from": "../common.json",
  "bodies": { "ground": {}, "block": { "mass": "2 * load" } },
  "joints": { "rail": { "type": "prismatic", "first": "ground.origin", "second": "block.origin" } },
  "start": { "joint": "rail", "position": 0 },
  "guess": { "rail": 0 }
}"#;

    fn folder(name: &str, common: &str) -> std::path::PathBuf {
        let folder = std::env::temp_dir().join(format!("linkage-fmu-shared-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("block")).unwrap();
        fs::write(folder.join("common.json"), common).unwrap();
        folder
    }

    #[test]
    fn the_contents_replace_the_path() {
        let folder =
            folder("whole", "{\n  \"parameters\": {\n    \"load\": { \"value\": 1.5, \"unit\": \"kg\" } }\n}\n");
        let text = completed(&folder.join("block/mechanism.json"), BLOCK.to_owned()).unwrap();
        assert_eq!(text.lines().count(), BLOCK.lines().count());
        let mut block = Component::from_definition("mechanism.json", &text).unwrap();
        let [load, mass] = ["load", "block.mass"].map(|name| block.interface().find(name).unwrap());
        assert_eq!((block.real(load), block.real(mass)), (Ok(1.5), Ok(3.0)));
        block.set_real(load, 4.0).unwrap();
        assert_eq!(block.real(mass), Ok(8.0));
        let again = completed(&folder.join("block/mechanism.json"), text.clone()).unwrap();
        assert_eq!(again, text, "a text that has the contents stays");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_faulty_file_is_named() {
        for (name, common, said) in [
            ("key", r#"{ "parameter": {} }"#, "no key `parameter` here; did you mean `parameters`?"),
            ("comma", r#"{ "parameters": { "a": 1,5 } }"#, "common.json"),
            (
                "unit",
                r#"{ "parameters": { "a": { "value": 1, "unit": "ft" } } }"#,
                "`ft` is not allowed here; similar words are",
            ),
        ] {
            let folder = folder(name, common);
            let error = completed(&folder.join("block/mechanism.json"), BLOCK.to_owned()).unwrap_err();
            let error = format!("{error:#}");
            assert!(error.contains("common.json") && error.contains(said), "{error}");
            fs::remove_dir_all(folder).unwrap();
        }
        let error = completed(Path::new("nowhere/mechanism.json"), BLOCK.to_owned()).unwrap_err();
        assert!(format!("{error:#}").contains("common.json"), "{error:#}");
        let unnamed = BLOCK.replace("../common.json", "");
        let error = completed(Path::new("nowhere/mechanism.json"), unnamed).unwrap_err().to_string();
        assert_eq!(
            error,
            "nowhere/mechanism.json: parameters_from: \"\" is not a file name; give a file of parameters, or remove \
             the key"
        );
        let error = Component::from_definition("mechanism.json", BLOCK).unwrap_err().0;
        assert!(error.contains("parameters_from") && error.contains("cargo fmu"), "{error}");
        let folder = folder("value", r#"{ "parameters": { "load": "0 / 0" } }"#);
        let text = completed(&folder.join("block/mechanism.json"), BLOCK.to_owned()).unwrap();
        let error = Component::from_definition("mechanism.json", &text).unwrap_err().0;
        assert!(error.contains("load") && error.contains("0 / 0") && error.contains("in ../common.json"), "{error}");
        fs::remove_dir_all(folder).unwrap();
    }
}
