//! Elements of MJCF and URDF and their attributes.

use anyhow::{Context, Result, anyhow, bail};
use roxmltree::{Document, Node};

/// Attributes that are never below 0: of masses, moments of inertia about an axis, densities and sizes.
const SIZES: [&str; 7] = ["mass", "diaginertia", "density", "size", "ixx", "iyy", "izz"];

/// Numbers of an attribute.
pub fn numbers(node: Node, name: &str) -> Result<Option<Vec<f64>>> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let parse = |word: &str| word.parse::<f64>().ok().filter(|value| value.is_finite());
    let all: Option<Vec<f64>> = text.split_whitespace().map(parse).collect();
    let told = || format!("{}: {name} = \"{}\"", at(node), text.escape_debug());
    let all = all.with_context(|| format!("{} contains text that is not a number", told()))?;
    let is_size = SIZES.contains(&name) || name == "value" && node.has_tag_name("mass");
    if is_size && all.iter().any(|value| *value < 0.0) {
        bail!("{}: must not be negative", told());
    }
    Ok(Some(all))
}

pub fn fixed<const N: usize>(node: Node, name: &str) -> Result<Option<[f64; N]>> {
    let Some(all) = numbers(node, name)? else { return Ok(None) };
    let count = all.len();
    let array = <[f64; N]>::try_from(all);
    array.map(Some).map_err(|_| anyhow!("{}: {name} has {count} numbers, but needs {N}", at(node)))
}

pub fn one(node: Node, name: &str) -> Result<Option<f64>> {
    Ok(fixed::<1>(node, name)?.map(|[value]| value))
}

/// The ends of a range, the lower one first.
pub fn ascending(node: Node, name: &str, range: [f64; 2]) -> Result<[f64; 2]> {
    let [lower, upper] = range;
    if lower > upper {
        bail!(
            "{}: {name}: the lower limit {lower:?} is larger than the upper limit {upper:?}; exchange them",
            at(node)
        );
    }
    Ok(range)
}

/// Where an element stands, for messages.
pub fn at(node: Node) -> String {
    let name = node.attribute("name").map(|name| format!(" \"{}\"", name.escape_debug())).unwrap_or_default();
    let line = node.document().text_pos_at(node.range().start).row;
    format!("line {line}: <{}{name}>", node.tag_name().name())
}

pub fn elements<'a>(node: Node<'a, 'a>) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(Node::is_element)
}

pub fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    elements(node).find(|child| child.has_tag_name(name))
}

pub fn parse(text: &str) -> Result<Document<'_>> {
    Document::parse(text).map_err(|error| anyhow!("the file is not XML: {error}"))
}
