//! The reference of a definition's keys as Markdown, from its tables: a section for each element, a line for each key.
//!
//! In: the elements of a definition. Out: the text of its page. It must not know laws.

use linkage_fmu::format::{Element, Key, Kind, Names, Range, Short, Table};
use linkage_fmu::hydraulics::definition as hydraulics;
use linkage_fmu::mechanism::definition as mechanism;
use std::fmt::Write;

/// The page of this definition file.
pub fn page(definition_file: &str) -> String {
    let own: &[Element] =
        if definition_file == "mechanism.json" { &mechanism::ELEMENTS } else { &hydraulics::ELEMENTS };
    let elements = [own, &hydraulics::CIRCUIT].concat();
    let mut out = format!(
        "# Keys of {definition_file}\n\nEach table lists the keys of one object. *fixed*: a parameter of the FMU, \
         which a host sets before the run. *tunable*: a parameter that a host can also set between two steps. \
         Where two units are given, the second one applies to a joint that turns.\n"
    );
    for element in &elements {
        let title = if element.name.is_empty() { definition_file } else { element.name };
        let place = place(&elements, element.table);
        let place = if place.is_empty() { String::new() } else { format!("Location: `{place}`. ") };
        let _ = write!(out, "\n## {title}\n\n{place}{}\n\n", element.about.trim());
        out.push_str(
            "| key | value | unit | limits | default | parameter | meaning |\n|---|---|---|---|---|---|---|\n",
        );
        for (index, key) in element.table.keys.iter().enumerate().filter(|(_, key)| !key.is_written_only) {
            let default = match (key.is_required, element.default_of(index)) {
                (true, _) => "required".to_owned(),
                (false, Some(default)) => format!("`{default}`"),
                (false, None) => String::new(),
            };
            let parameter = key.role.map_or("", |role| if role.is_tunable() { "tunable" } else { "fixed" });
            let (value, [unit, limits]) = (value(&elements, &key.kind, key), number(key));
            let meaning = element.docs[index].trim();
            let _ =
                writeln!(out, "| `{}` | {value} | {unit} | {limits} | {default} | {parameter} | {meaning} |", key.name);
        }
    }
    out
}

/// Path of the first place where an object with these keys stands; empty for the whole.
fn place(elements: &[Element], table: &'static Table) -> String {
    let found = elements.iter().find_map(|element| {
        let key = element.table.keys.iter().find_map(|key| Some((key, inside(&key.kind, table)?)))?;
        Some((element.table, key))
    });
    let Some((outer, (key, part))) = found else { return String::new() };
    let outer = place(elements, outer);
    let dot = if outer.is_empty() { "" } else { "." };
    format!("{outer}{dot}{}{part}", key.name)
}

/// How an object with these keys stands under a key of this kind, if it does.
fn inside(kind: &Kind, table: &'static Table) -> Option<&'static str> {
    match kind {
        Kind::Object(one) => (*one == table).then_some(""),
        Kind::Group(of) => inside(of, table).map(|_| ".<name>"),
        Kind::List(of) => inside(of, table).map(|_| "[i]"),
        _ => None,
    }
}

/// What may stand under a key, in words.
fn value(elements: &[Element], kind: &Kind, key: &Key) -> String {
    match kind {
        Kind::Number if key.range == Range::Count => "whole number".into(),
        Kind::Number => "number".into(),
        Kind::Whole => "whole number".into(),
        Kind::Flag => "true or false".into(),
        Kind::Text => match key.names {
            Names::Nothing => "text".into(),
            Names::Line => "line of text".into(),
            Names::Element => "name".into(),
            Names::Point => "`body.point`".into(),
        },
        Kind::Pair => "two numbers".into(),
        Kind::Word(words) => words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "),
        Kind::Object(table) => {
            let name = elements.iter().find(|element| element.table == *table).map_or("", |element| element.name);
            match table.short {
                Short::None => format!("[{name}](#{name})"),
                Short::First => {
                    format!("{}, or [{name}](#{name})", value(elements, &table.keys[0].kind, &table.keys[0]))
                }
                Short::Word(word) => format!("`{word}`, or [{name}](#{name})"),
            }
        }
        Kind::Group(of) => format!("by name: {}", value(elements, of, key)),
        Kind::List(of) => format!("list: {}", value(elements, of, key)),
        Kind::Own(words) => (*words).into(),
    }
}

/// Unit and limits of a number, empty for any other value.
fn number(key: &Key) -> [String; 2] {
    let mut kind = &key.kind;
    while let Kind::Group(of) | Kind::List(of) = kind {
        kind = of;
    }
    if !matches!(kind, Kind::Number | Kind::Pair) {
        return [String::new(), String::new()];
    }
    let names = |units: [_; 2]| {
        let [line, joint] = units.map(linkage_fmu::variables::Unit::name);
        if line == joint { line.to_owned() } else { format!("{line} or {joint}") }
    };
    let second = key.second.map_or(String::new(), |second| format!(", {}", names(second)));
    let limits = if key.range == Range::Finite { String::new() } else { key.range.text() };
    [names(key.units) + &second, limits]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::workspace::Workspace;
    use linkage_fmu::component::Component;
    use std::fs;

    #[test]
    fn each_key_has_its_line() {
        let page = page("mechanism.json");
        for line in [
            "## spring\n\nLocation: `springs.<name>`. A spring with a damper.",
            "Location: `springs.<name>.gas`.",
            "Location: `couplings.<name>.segments[i]`.",
            "Location: `actuators.<name>.hydraulics.fluid`.",
            "| `stiffness` | number | N/m or N.m/rad | a finite number >= 0 | `0.0` | fixed | Stiffness [N/m or \
             N.m/rad], >= 0. |",
            "| `restitution` | number | 1 | a number from 0 to 1 | `0.0` | tunable |",
            "| `type` | `revolute`, `prismatic` |  |  | required |  | Kind of joint.",
            "| `start` | `equilibrium`, or [start](#start) |",
        ] {
            assert!(page.contains(line), "{line}");
        }
        assert!(!page.contains("expressions |"));
    }

    /// With LINKAGE_FMU_WRITE set, the committed ones are written anew.
    #[test]
    fn the_committed_pages_are_those_of_the_tables() {
        let folder = Workspace::locate().descriptions().join("../docs/reference");
        for file in Component::definition_files() {
            let (path, page) = (folder.join(format!("keys-of-{}.md", file.trim_end_matches(".json"))), page(file));
            if std::env::var_os("LINKAGE_FMU_WRITE").is_some() {
                fs::create_dir_all(&folder).unwrap();
                fs::write(&path, &page).unwrap();
            }
            let same = fs::read_to_string(&path).unwrap() == page;
            assert!(same, "{}: LINKAGE_FMU_WRITE=1 cargo test -p fmu-build --lib reference writes it", path.display());
        }
    }
}
