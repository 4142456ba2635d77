//! Included files and default classes of MJCF.
//!
//! In: elements. Out: these elements with the contents of included files, and with the attributes of their classes.

use super::super::xml::Element;
use super::table::{ACTUATORS, SHARED};
use anyhow::{Context, Result, bail, ensure};

/// Replace each `<include>` by the contents of its file.
///
/// # Errors
/// A file cannot be read, is empty, or is included twice.
pub fn included(root: &mut Element, include: &dyn Fn(&str) -> Result<String>, known: &mut Vec<String>) -> Result<()> {
    let mut children = Vec::with_capacity(root.children.len());
    for mut child in std::mem::take(&mut root.children) {
        if child.tag != "include" {
            included(&mut child, include, known)?;
            children.push(child);
            continue;
        }
        let file = child.get("file").with_context(|| format!("{}: the attribute file is missing", child.at()))?;
        ensure!(!known.iter().any(|name| name == file), "{}: {file} is included twice: remove one", child.at());
        known.push(file.to_owned());
        let mut inner = include(file).and_then(|text| Element::parse(&text, file)).with_context(|| child.at())?;
        included(&mut inner, include, known)?;
        children.extend(inner.children);
    }
    root.children = children;
    Ok(())
}

/// A class by its name, with the elements of its defaults. Those of its parents are last.
struct Class {
    name: String,
    parts: Vec<Element>,
}

/// Write the attributes of default classes into the elements.
///
/// # Errors
/// An element names a class that does not exist.
pub fn written_out(root: &mut Element) -> Result<()> {
    let mut classes = Vec::new();
    for top in root.all("default") {
        collect(top, &[], &mut classes);
    }
    for section in &mut root.children {
        if section.tag != "default" {
            let (group, around) = (section.tag.clone(), section.get("childclass").map(str::to_owned));
            let mut children = section.children.iter_mut();
            children.try_for_each(|child| complete(child, &group, around.as_deref(), &classes))?;
        }
    }
    Ok(())
}

fn complete(element: &mut Element, group: &str, around: Option<&str>, classes: &[Class]) -> Result<()> {
    let kind = match group {
        "equality" => "equality",
        "tendon" => "tendon",
        _ => element.tag.as_str(),
    };
    // The class of the element, else that of the nearest body around it, else the main class.
    let class = match element.get("class").or(around) {
        Some(name) => match classes.iter().find(|class| class.name == name) {
            None if !matches!(group, "worldbody" | "equality" | "tendon" | "actuator") => None,
            None => bail!(
                "{}: there is no default class \"{}\"; define this class, or correct its name",
                element.at(),
                name.escape_debug()
            ),
            found => found,
        },
        None => classes.first(),
    };
    let is_drive = group == "actuator";
    for part in class.iter().flat_map(|class| &class.parts) {
        // Actuators of all kinds share the defaults of their transmission and limits.
        let shared = is_drive && part.tag != kind;
        if part.tag != kind && !(shared && ACTUATORS.split(' ').any(|tag| tag == part.tag)) {
            continue;
        }
        for (name, value) in &part.attributes {
            let is_gain = name == "gainprm" && part.tag == "general" && matches!(kind, "position" | "velocity");
            let applies = !shared || is_gain || SHARED.split(' ').any(|shared| shared == name);
            if applies && name != "class" && element.attributes.iter().all(|(own, _)| own != name) {
                element.attributes.push((name.clone(), value.clone()));
            }
        }
    }
    if group != "worldbody" {
        return Ok(());
    }
    let around = element.get("childclass").or(around).map(str::to_owned);
    element.children.iter_mut().try_for_each(|child| complete(child, group, around.as_deref(), classes))
}

/// The classes in a `<default>`, starting with the element itself.
fn collect(node: &Element, parents: &[Element], classes: &mut Vec<Class>) {
    let own = node.children.iter().filter(|child| child.tag != "default");
    let parts: Vec<Element> = own.chain(parents).cloned().collect();
    let name = node.get("class").unwrap_or("main");
    match classes.iter_mut().find(|class| class.name == name) {
        // A class may have several sections. Later sections take precedence.
        Some(class) => class.parts.splice(0..0, parts.iter().cloned()).for_each(drop),
        None => classes.push(Class { name: name.to_owned(), parts: parts.clone() }),
    }
    node.all("default").for_each(|inner| collect(inner, &parts, classes));
}
