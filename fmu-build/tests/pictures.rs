//! The pictures of the reference pages of a mechanism's elements: each shows the first example of its page.
#![allow(clippy::unwrap_used)]

use fmu_build::documentation::Picture;
use fmu_build::drawing::{Colours, to_svg};
use linkage_fmu::component::Component;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/mechanism")
}

/// Merge a part into a whole, entry by entry.
fn merge(whole: &mut Value, part: Value) {
    match (whole, part) {
        (Value::Object(whole), Value::Object(part)) => {
            part.into_iter().for_each(|(key, value)| merge(whole.entry(key).or_insert(Value::Null), value));
        }
        (whole, part) => *whole = part,
    }
}

/// The first example of a page, in the file that the page names above it.
fn example(page: &str) -> String {
    let (before, rest) = page.split_once("```json\n").unwrap();
    let part: Value = serde_json::from_str(rest.split_once("```").unwrap().0).unwrap();
    let file = before.rsplit_once("](../files/").map(|(_, rest)| rest.split_once(')').unwrap().0);
    let whole = file.map(|name| fs::read_to_string(folder().join("../files").join(name)).unwrap());
    let mut whole = whole.map_or(Value::Null, |text| serde_json::from_str(&text).unwrap());
    merge(&mut whole, part);
    whole.to_string()
}

/// With LINKAGE_FMU_WRITE set, the committed pictures are rewritten.
#[test]
fn the_committed_pictures_are_those_of_the_examples() {
    let mut count = 0;
    for path in fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()) {
        let Some(page) = fs::read_to_string(&path).ok().filter(|page| page.contains("](../pictures/")) else {
            continue;
        };
        let text = example(&page);
        let component = Component::from_definition("mechanism.json", &text).unwrap();
        let picture = Picture::new(&component, &text).unwrap();
        let svg = to_svg(&picture.of_the_page()[0], Colours::Own, "drawing").unwrap();
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(page.contains(&format!("](../pictures/{name}.svg)")), "{name}.md shows the picture of another page");
        let path = folder().join("../pictures").join(name).with_extension("svg");
        if std::env::var_os("LINKAGE_FMU_WRITE").is_some() {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, &svg).unwrap();
        }
        let same = fs::read_to_string(&path).is_ok_and(|committed| committed == svg);
        assert!(same, "{}: LINKAGE_FMU_WRITE=1 cargo test -p fmu-build --test pictures writes it", path.display());
        count += 1;
    }
    assert!(count > 5, "{count} pictures");
}
