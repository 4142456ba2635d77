//! The pictures of the reference pages of a mechanism's elements: each shows the first example of its page.
#![allow(clippy::unwrap_used)]

#[path = "../../tests/support/examples.rs"]
mod reference;

use fmu_build::documentation::Picture;
use fmu_build::drawing::{Colours, to_svg};
use linkage_fmu::component::Component;
use reference::{examples, folder};
use std::fs;

/// With LINKAGE_FMU_WRITE set, the committed pictures are rewritten.
#[test]
fn the_committed_pictures_are_those_of_the_examples() {
    let mut count = 0;
    for example in examples().into_iter().filter(|example| example.index == 0) {
        let page = fs::read_to_string(folder().join(&example.page)).unwrap();
        if !page.contains("](../pictures/") {
            continue;
        }
        let text = example.whole.to_string();
        let component = Component::from_definition("mechanism.json", &text).unwrap();
        let picture = Picture::new(&component, &text).unwrap();
        let svg = to_svg(&picture.of_the_page()[0], Colours::Own, "drawing").unwrap();
        let name = example.page.strip_suffix(".md").unwrap();
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
