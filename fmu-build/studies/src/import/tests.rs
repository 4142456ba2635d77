//! The tables of formats compared with the importers, with MuJoCo's schema, and with the reference pages.
#![allow(clippy::unwrap_used)]

use super::masses::Shape;
use super::xml::{Element, Fate, Row, row};
use super::{mjcf, sdf, urdf};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

const CASES: &str = include_str!("../../tests/import/files/mujoco.json");

/// Elements that do not occur in the cases for MuJoCo's accelerations.
const OTHERS: [&str; 2] = [
    r#"<mujoco><worldbody><body name="a"><joint name="j" axis="0 1 0"/><geom size=".1" contype="0"/><camera/></body>
       <frame><site name="s"/></frame></worldbody><equality><weld body1="a" relpose="0 0 0 1 0 0 0"/>
       <joint joint1="j" polycoef="0"/></equality><actuator><intvelocity joint="j"/><damper joint="j"/>
       <cylinder joint="j" bias="0 0 -1"/><adhesion body="a"/></actuator></mujoco>"#,
    r#"<mujoco><worldbody><body name="a"><joint axis="0 1 0"/><inertial pos="0 0 0" mass="1"/><geom size=".1"/></body>
       </worldbody></mujoco>"#,
];

/// Attributes that are read according to a table, as `parent/tag name`, with `*` for any tag.
fn stated(table: &'static [Row]) -> BTreeSet<String> {
    let rows = table.iter().filter(|row| row.2 == Fate::Read);
    let named = |element: &'static str, names: &'static str| {
        names.split_whitespace().map(move |name| format!("{element} {name}"))
    };
    rows.flat_map(|(elements, names, ..)| elements.split_whitespace().flat_map(move |one| named(one, names))).collect()
}

/// Compare the attributes that were read with a table.
fn compare(read: &BTreeSet<String>, table: &'static [Row]) {
    let is_element = |key: &str, name: &str| {
        let tag = key.split('/').nth(1).unwrap_or_default();
        row(table, &format!("{tag}/{name}"), "").is_some_and(|row| row.2 == Fate::Read)
    };
    for own in read {
        let (key, name) = own.split_once(' ').unwrap();
        // Classes are read for every element.
        if matches!(name, "class" | "childclass") {
            continue;
        }
        let is_stated = row(table, key, name).is_some_and(|row| row.2 == Fate::Read);
        assert!(is_stated || is_element(key, name), "the table does not say that {own} is read");
    }
    for own in stated(table) {
        let (key, name) = own.split_once(' ').unwrap();
        let group = key.strip_suffix('*');
        let is_read = |other: &String| {
            let (other, read) = other.split_once(' ').unwrap();
            name == read && group.map_or(other == key, |group| other.starts_with(group))
        };
        assert!(read.iter().any(is_read), "{own} is not read, but the table says so");
    }
}

fn cases() -> Vec<Value> {
    serde_json::from_str(CASES).unwrap()
}

#[test]
fn mjcf_is_read_as_in_its_table() {
    let mut read = BTreeSet::new();
    for case in cases() {
        let include = |file: &str| Ok(case["files"][file].as_str().unwrap().to_owned());
        let root = mjcf::document(case["mjcf"].as_str().unwrap(), &include).unwrap();
        mjcf::read("case", &root).unwrap();
        root.read(&mjcf::group, &mut read);
    }
    for text in OTHERS {
        let root = mjcf::document(text, &|_| unreachable!()).unwrap();
        mjcf::read("case", &root).unwrap();
        root.read(&mjcf::group, &mut read);
    }
    // Included files are part of the document when it is read.
    read.insert("mujoco/include file".to_owned());
    compare(&read, &mjcf::TABLE);
}

#[test]
fn urdf_and_sdf_are_read_as_in_their_tables() {
    let mut read = [BTreeSet::new(), BTreeSet::new()];
    let root = Element::parse(include_str!("../../tests/import/files/boom.urdf"), "").unwrap();
    urdf::read("case", &root).unwrap();
    root.read(&str::to_owned, &mut read[0]);
    for case in cases() {
        if let Some(text) = case["urdf"].as_str() {
            let root = Element::parse(text, "").unwrap();
            urdf::read("case", &root).unwrap();
            root.read(&str::to_owned, &mut read[0]);
        }
        if let Some(text) = case["sdf"].as_str() {
            let root = Element::parse(text, "").unwrap();
            sdf::read("case", &root).unwrap();
            root.read(&str::to_owned, &mut read[1]);
        }
    }
    compare(&read[0], &urdf::TABLE);
    compare(&read[1], &sdf::TABLE);
}

/// Every element and attribute of MuJoCo has a row, or is in an element that is not read.
#[test]
fn mjcf_has_a_row_for_all_that_mujoco_has() {
    let mut missing = Vec::new();
    for line in include_str!("../../tests/import/files/mujoco_schema.txt").lines() {
        let (path, names) = line.split_once(':').unwrap();
        let tags: Vec<&str> = path.split('/').collect();
        let keys: Vec<String> = tags.windows(2).map(|two| format!("{}/{}", mjcf::group(two[0]), two[1])).collect();
        let ends = keys.iter().any(|key| row(&mjcf::TABLE, key, "").is_some_and(|row| row.2 != Fate::Read));
        if let (false, Some(key)) = (ends, keys.last()) {
            let known = |name: &&str| row(&mjcf::TABLE, key, name).is_none();
            missing.extend(
                [""].into_iter().chain(names.split_whitespace()).filter(known).map(|name| format!("{path} {name}")),
            );
        }
    }
    assert!(missing.is_empty(), "no rows for:\n{}", missing.join("\n"));
}

/// The table of a format as Markdown.
fn written(table: &[Row]) -> String {
    let mut text = "| element | attributes | treatment by `import` |\n|---|---|---|\n".to_owned();
    for (elements, names, fate, why) in table {
        let code = |all: &str| all.split_whitespace().map(|one| format!("`{one}`")).collect::<Vec<_>>().join(", ");
        let (list, kind) = if names.is_empty() { (elements, "element") } else { (names, "attribute") };
        let all = match list.split_whitespace().count() {
            1 => format!("this {kind}"),
            _ => format!("these {kind}s"),
        };
        let fate = match fate {
            Fate::Read => (*why).to_owned(),
            Fate::NoEffect => format!("`import` ignores {all}: {why}"),
            Fate::LeftOut => format!("`import` leaves {all} out, with a note: {why}"),
            Fate::Rejected("") => format!("`import` rejects {all}: {why}"),
            Fate::Rejected(unless) => format!("`import` rejects {all}, except for the value `{unless}`: {why}"),
        };
        writeln!(text, "| {} | {} | {fate} |", code(elements), code(names)).unwrap();
    }
    text
}

/// The page contains these tables. With LINKAGE_FMU_WRITE set, they are rewritten.
#[test]
fn the_page_has_the_tables() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/imported-formats.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let mut own = page.clone();
    for (name, table) in [("MJCF", &mjcf::TABLE), ("URDF", &urdf::TABLE), ("SDF", &sdf::TABLE)] {
        let (before, rest) = own.split_once(&format!("<!-- table: {name} -->\n")).unwrap();
        let (_, after) = rest.split_once("<!-- end of table -->").unwrap();
        own = format!("{before}<!-- table: {name} -->\n{}<!-- end of table -->{after}", written(table));
    }
    let writes = std::env::var_os("LINKAGE_FMU_WRITE").is_some();
    if writes {
        std::fs::write(&path, &own).unwrap();
    }
    assert!(
        writes || page == own,
        "LINKAGE_FMU_WRITE=1 cargo test -p fmu-studies --lib the_page writes {}",
        path.display()
    );
}

/// The solids of revolution as thin discs.
#[test]
fn solids_of_revolution_have_the_inertia_of_their_discs() {
    let (r, length) = (0.3, 0.5_f64);
    let ball = |z: f64| (r * r - z * z).max(0.0);
    let round = |z: f64| ball((z.abs() - 0.5 * length).max(0.0));
    let solids: [(Shape, &dyn Fn(f64) -> f64); 3] = [
        (Shape::Sphere(r), &ball),
        (Shape::Capsule(r, length), &round),
        (Shape::Cylinder(r, length), &|z| if z.abs() < 0.5 * length { r * r } else { 0.0 }),
    ];
    for (shape, square) in solids {
        let count = 200_000;
        let thickness = 1.2 / f64::from(count);
        let (mut volume, mut along, mut across) = (0.0, 0.0, 0.0);
        for disc in 0..count {
            let z = (f64::from(disc) + 0.5) * thickness - 0.6;
            let part = std::f64::consts::PI * square(z) * thickness;
            volume += part;
            along += part * square(z) / 2.0;
            across += part * (square(z) / 4.0 + z * z);
        }
        let (own, inertia) = shape.solid();
        let expected = [across / volume, across / volume, along / volume];
        assert!((own / volume - 1.0).abs() < 1e-5, "{shape:?}: {own} m3 instead of {volume} m3");
        let all_near = inertia.iter().zip(&expected).all(|(own, other)| (own / other - 1.0).abs() < 1e-5);
        assert!(all_near, "{shape:?}: {inertia:?} instead of {expected:?}");
    }
}
