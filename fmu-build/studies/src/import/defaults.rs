//! Default classes of MJCF: attributes that elements have unless they state them.
//!
//! In: the text of a file. Out: the same text, line by line, with these attributes in the elements themselves.

use anyhow::{Result, bail};
use roxmltree::{Document, Node};

/// Elements whose defaults count for a mechanism.
const ELEMENTS: [&str; 2] = ["joint", "geom"];

/// A class by its name, with the elements that state its defaults, those of its parents last.
struct Class<'a> {
    name: &'a str,
    parts: Vec<Node<'a, 'a>>,
}

/// The text of a file with the attributes of its default classes written into the elements.
///
/// # Errors
/// An element names a class that there is not.
pub fn written_out(text: &str, document: &Document) -> Result<String> {
    let root = document.root_element();
    let mut classes = Vec::new();
    for top in root.children().filter(|node| node.has_tag_name("default")) {
        collect(top, &[], &mut classes);
    }
    let mut insertions: Vec<(usize, String)> = Vec::new();
    let worlds = root.children().filter(|node| node.has_tag_name("worldbody"));
    for node in worlds.flat_map(|world| world.descendants()) {
        if !ELEMENTS.contains(&node.tag_name().name()) {
            continue;
        }
        // A class of the element's own, else that of the nearest body around it, else the main one.
        let around = || node.ancestors().skip(1).find_map(|body| body.attribute("childclass"));
        let class = match node.attribute("class").or_else(around) {
            Some(name) => match classes.iter().find(|class| class.name == name) {
                Some(class) => Some(class),
                None => {
                    let line = document.text_pos_at(node.range().start).row;
                    bail!(
                        "line {line}: there is no default class \"{}\"; define this class, or correct its name",
                        name.escape_debug()
                    )
                }
            },
            None => classes.first(),
        };
        let mut written = String::new();
        let mut known: Vec<&str> = node.attributes().map(|attribute| attribute.name()).collect();
        let parts = class.iter().flat_map(|class| &class.parts);
        for part in parts.filter(|part| part.tag_name() == node.tag_name()) {
            for attribute in part.attributes().filter(|attribute| attribute.name() != "class") {
                if !known.contains(&attribute.name()) {
                    known.push(attribute.name());
                    // As it stands in the file, with its quotation marks and escapes.
                    written.push(' ');
                    written.push_str(&text[attribute.range()]);
                }
            }
        }
        if !written.is_empty() {
            insertions.push((node.range().start + 1 + node.tag_name().name().len(), written));
        }
    }
    insertions.sort_by_key(|(at, _)| *at);
    let (mut out, mut from) = (String::with_capacity(text.len()), 0);
    for (at, written) in insertions {
        out.push_str(&text[from..at]);
        out.push_str(&written);
        from = at;
    }
    out.push_str(&text[from..]);
    Ok(out)
}

/// The classes in a `<default>`, itself first.
fn collect<'a>(node: Node<'a, 'a>, parents: &[Node<'a, 'a>], classes: &mut Vec<Class<'a>>) {
    let own = node.children().filter(|child| ELEMENTS.contains(&child.tag_name().name()));
    let parts: Vec<Node> = own.chain(parents.iter().copied()).collect();
    let name = node.attribute("class").unwrap_or("main");
    match classes.iter_mut().find(|class| class.name == name) {
        // A class may be stated in several sections; what comes later counts first.
        Some(class) => class.parts.splice(0..0, parts.iter().copied()).for_each(drop),
        None => classes.push(Class { name, parts: parts.clone() }),
    }
    for inner in node.children().filter(|child| child.has_tag_name("default")) {
        collect(inner, &parts, classes);
    }
}
