//! The examples of the reference: JSON blocks of the pages about the elements of a mechanism.
#![allow(dead_code, clippy::unwrap_used)]

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// Groups of named entries.
const GROUPS: &str = "bodies joints couplings actuators forces torques springs markers surfaces stops locks guess";

/// An example.
pub struct Example {
    /// File name of its page.
    pub page: String,
    /// Number of the examples above it on the page.
    pub index: usize,
    /// The example itself: a complete file, or a part of one.
    pub part: Value,
    /// The complete file: the last one above the example on the page, or the file in `files` that the page names, with
    /// the example added.
    pub whole: Value,
}

/// The folder of the pages.
pub fn folder() -> PathBuf {
    let mut folders =
        Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().map(|root| root.join("docs/reference/mechanism"));
    folders.find(|folder| folder.is_dir()).unwrap()
}

/// All examples, page by page.
pub fn examples() -> Vec<Example> {
    let mut pages: Vec<_> = fs::read_dir(folder()).unwrap().map(|page| page.unwrap().path()).collect();
    pages.sort();
    let mut all = Vec::new();
    for path in pages {
        let (page, text) = (path.file_name().unwrap().to_string_lossy(), fs::read_to_string(&path).unwrap());
        let read = |text: &str| serde_json::from_str(text).unwrap_or_else(|e| panic!("{page}: {e} in\n{text}"));
        let base = text.split_once("](../files/").and_then(|(_, rest)| rest.split_once(')'));
        let file = |name: &str| fs::read_to_string(folder().join("../files").join(name)).unwrap();
        let mut above: Value = base.map_or(Value::Null, |(name, _)| read(&file(name)));
        for (index, block) in text.split("```json\n").skip(1).enumerate() {
            let part: Value = read(block.split_once("```").unwrap().0);
            if part.get("name").is_some() {
                above = part.clone();
            }
            let mut whole = above.clone();
            add(&mut whole, &part);
            all.push(Example { page: page.to_string(), index, part, whole });
        }
    }
    all
}

/// Add a part of a file to a complete file: entries of groups one by one, other keys unchanged.
fn add(whole: &mut Value, part: &Value) {
    for (key, value) in part.as_object().unwrap() {
        if GROUPS.split(' ').any(|group| group == key) {
            let group = whole.as_object_mut().unwrap().entry(key).or_insert_with(|| json!({}));
            value.as_object().unwrap().iter().for_each(|(name, entry)| group[name] = entry.clone());
        } else {
            whole[key] = value.clone();
        }
    }
}
