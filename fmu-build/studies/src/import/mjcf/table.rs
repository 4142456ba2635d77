//! Treatment of each element and attribute of MJCF.
//!
//! `table.json` contains a row for each element and attribute. The page of the reference is written from this table. A
//! test compares it with the importer, and with the elements
//! and attributes of MuJoCo.

use super::super::xml::{Element, Row, table};
use std::sync::LazyLock;

/// Actuators, whose defaults share attributes.
pub const ACTUATORS: &str = "general motor position velocity intvelocity orientation pid damper cylinder \
    muscle adhesion dcmotor";
/// Attributes that the defaults of all actuators share.
pub const SHARED: &str = "gear damping armature ctrllimited ctrlrange forcelimited forcerange \
    cranklength delay nsample interp group user";

/// Elements in bodies and in frames of bodies have one group.
pub fn group(tag: &str) -> String {
    if matches!(tag, "worldbody" | "frame") { "body".to_owned() } else { tag.to_owned() }
}

/// Treatment of each element and attribute.
pub static TABLE: LazyLock<Vec<Row>> = LazyLock::new(|| table(include_str!("table.json")));

/// Message about contact between geoms of two bodies, unless one body carries the other.
pub fn contact(root: &Element) -> Option<String> {
    let is_off = |flag: &Element| flag.is("contact", "disable") || flag.is("constraint", "disable");
    if root.all("option").flat_map(|option| option.all("flag")).filter(|flag| is_off(flag)).count() > 0 {
        return None;
    }
    let mut geoms: Vec<(usize, usize, &Element)> = Vec::new();
    let mut count = 0;
    root.all("worldbody").for_each(|world| collect(world, (0, 0), &mut count, &mut geoms));
    let pairs = geoms.iter().enumerate().flat_map(|(at, one)| geoms[at + 1..].iter().map(move |other| (one, other)));
    let mut apart = pairs
        .filter(|((a, of_a, _), (b, of_b, _))| a != b && (*of_a != *b || *of_a == 0) && (*of_b != *a || *of_b == 0));
    let ((.., first), (.., other)) = apart.next()?;
    Some(format!(
        "contact between geoms, such as {} and {}, is left out: bodies of the imported mechanism can pass through each \
         other; add stops that end the travel",
        first.at(),
        other.at()
    ))
}

/// Geoms that may contact others, with their body and its parent.
fn collect<'a>(
    node: &'a Element,
    (own, parent): (usize, usize),
    count: &mut usize,
    geoms: &mut Vec<(usize, usize, &'a Element)>,
) {
    for inner in &node.children {
        match inner.tag.as_str() {
            "geom" if ["contype", "conaffinity"].iter().any(|key| inner.get(key) != Some("0")) => {
                geoms.push((own, parent, inner));
            }
            "frame" => collect(inner, (own, parent), count, geoms),
            "body" => {
                *count += 1;
                collect(inner, (*count, own), count, geoms);
            }
            _ => {}
        }
    }
}
