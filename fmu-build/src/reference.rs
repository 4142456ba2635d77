//! The reference of the keys of a definition as Markdown: tables of keys within the pages of the elements.
//!
//! In: the elements of a definition, and pages with lines `<!-- keys: spring -->` and `<!-- end of keys -->` around the
//! keys of an element. Out: the pages with these keys, and an index of all keys. The module must not know laws.

use crate::ssp::definition as system;
use linkage_fmu::format::{Element, Key, Kind, Names, Range, Short, Table};
use linkage_fmu::hydraulics::definition as hydraulics;
use linkage_fmu::hydraulics::network::definition as network;
use linkage_fmu::mechanism::definition as mechanism;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Text before the name of an element in a page.
const START: &str = "<!-- keys: ";
/// The end of the keys of an element in a page.
const END: &str = "<!-- end of keys -->";
/// The limits of every number, which the page of the whole file states.
const ANY: &str = "from -1e100 to 1e100";
/// Element whose parts are listed in its own table, key by key.
const CIRCUIT: &str = "circuit";

/// The elements of the definition files and of a system file. The elements of a circuit are in two files.
fn files() -> [(&'static str, Vec<Element>); 4] {
    [
        ("mechanism.json", [&mechanism::ELEMENTS[..], &hydraulics::CIRCUIT].concat()),
        ("hydraulics.json", [&hydraulics::ELEMENTS[..], &hydraulics::CIRCUIT].concat()),
        ("network.json", network::ELEMENTS.to_vec()),
        (system::FILE, system::ELEMENTS.to_vec()),
    ]
}

/// The elements of this definition file. The first element is the whole file.
pub fn elements(definition_file: &str) -> Vec<Element> {
    let own = files().into_iter().find(|(file, _)| *file == definition_file);
    own.map_or_else(Vec::new, |(_, elements)| elements)
}

/// Name of an element in a page. An element that is not in mechanism.json has the name of the first file with this
/// element as a prefix.
fn mark(file: &str, element: &Element) -> String {
    let has = |elements: &[Element]| elements.iter().any(|other| other.table == element.table);
    let first = files().into_iter().find(|(_, elements)| has(elements)).map_or("", |(first, _)| first);
    match (element.name, first) {
        ("", _) => file.to_owned(),
        (name, "mechanism.json") => name.to_owned(),
        (name, first) => format!("{first} {name}"),
    }
}

/// The pages with the keys of their elements, and an index of the keys of each file, by path in the folder of the
/// pages.
///
/// # Errors
/// A page names no element, or has a start without an end; an element is on no page, or on two pages.
pub fn filled(pages: &BTreeMap<String, String>) -> Result<BTreeMap<String, String>, String> {
    let mut places = BTreeMap::new();
    for (path, text) in pages {
        for part in text.split(START).skip(1) {
            let name = part.split_once(" -->").ok_or_else(|| format!("{path}: a start of keys has no end"))?.0;
            if places.insert(name.to_owned(), path.clone()).is_some() {
                return Err(format!("{path}: the keys of {name} occur twice"));
            }
        }
    }
    let mut left = places.clone();
    let mut sections = BTreeMap::new();
    let mut out = BTreeMap::new();
    for (file, elements) in files() {
        let mut index = format!(
            "# Index of keys: {file}\n\nThis table lists every object of {file} with its keys and its place in the \
             file. Each link opens the page with the value, unit, limits and default of each key.\n\n| object | keys | \
             place in the file |\n|---|---|---|\n"
        );
        for element in &elements {
            let name = mark(file, element);
            let is_part = hydraulics::CIRCUIT[1..].iter().any(|part| part.table == element.table);
            let on = if is_part { CIRCUIT } else { &name };
            let page = places.get(on).ok_or_else(|| format!("no page has the keys of {name}"))?;
            left.remove(on);
            if !is_part {
                sections.entry(name.clone()).or_insert_with(|| section(file, &elements, element, page, &places));
            }
            let keys: Vec<_> = listed(element).map(|(_, key)| format!("`{}`", key.name)).collect();
            let (title, place) = (title(file, element), place(&elements, element.table));
            let place = if place.is_empty() { "the whole file".into() } else { format!("`{place}`") };
            let _ = writeln!(index, "| [{title}]({page}#{}) | {} | {place} |", anchor(on), keys.join(", "));
        }
        out.insert(format!("keys-of-{}.md", file.trim_end_matches(".json")), index);
    }
    if let Some((name, path)) = left.first_key_value() {
        return Err(format!("{path}: there is no element {name}"));
    }
    for (path, text) in pages {
        let mut parts = text.split(START);
        let mut page = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let (name, rest) = part.split_once(" -->").unwrap_or((part, ""));
            let rest = rest
                .split_once(END)
                .ok_or_else(|| format!("{path}: the list of the keys of {name} has no end mark"))?
                .1;
            let keys = sections.get(name).map_or("", String::as_str);
            let _ = write!(page, "{START}{name} -->\n{keys}{END}{rest}");
        }
        out.insert(path.clone(), page);
    }
    Ok(out)
}

/// Title of an element above its keys.
fn title<'a>(file: &'a str, element: &Element) -> &'a str {
    if element.name.is_empty() { file } else { element.name }
}

/// The anchor of the heading above the keys of an element.
fn anchor(name: &str) -> String {
    let name = name.rsplit(' ').next().unwrap_or(name);
    format!("keys-of-{}", name.replace('.', ""))
}

/// The keys that users write.
fn listed(element: &Element) -> impl Iterator<Item = (usize, &'static Key)> {
    element.table.keys.iter().enumerate().filter(|(_, key)| !key.is_written_only)
}

/// Heading, place and table of the keys of an element.
fn section(
    file: &str,
    elements: &[Element],
    element: &Element,
    page: &str,
    places: &BTreeMap<String, String>,
) -> String {
    let place = place(elements, element.table);
    let place = if place.is_empty() { String::new() } else { format!("Location: `{place}`. ") };
    let mut lines = Vec::new();
    let mut add = |element: &Element, before: &str| {
        for (index, key) in listed(element) {
            let default = match (key.is_required, element.default_of(index)) {
                (true, _) => "required".to_owned(),
                (false, Some(default)) => format!("`{default}`"),
                (false, None) => String::new(),
            };
            let parameter = key.role.map_or("", |role| if role.is_tunable() { "tunable" } else { "fixed" });
            let value = value(&|table| link(table, page, places), &key.kind, key);
            let [unit, limits] = number(key);
            // The meaning does not repeat the text of the column `value`.
            let mut meaning = element.docs[index].trim().to_owned();
            for (open, text, end) in [(" [", &unit, "]"), (", ", &limits, "")] {
                if !text.is_empty() {
                    meaning = meaning.replacen(&[open, text, end].concat(), "", 1);
                }
            }
            let unit = if unit.is_empty() || unit == "1" { String::new() } else { format!(" [{unit}]") };
            let limits = if limits.is_empty() { limits } else { format!(", {limits}") };
            let name = format!("`{before}{}`", key.name);
            lines.push([name, meaning, value + &unit + &limits, default, parameter.into()]);
        }
    };
    if element.name == CIRCUIT {
        for part in &hydraulics::CIRCUIT[1..] {
            add(part, &format!("{}.", part.name));
        }
    } else {
        add(element, "");
    }
    let heads = ["key", "meaning", "value", "default", "parameter"];
    let is_used = |column: usize| lines.iter().any(|line| !line[column].is_empty());
    let used: Vec<usize> = (0..heads.len()).filter(|column| is_used(*column)).collect();
    let title = title(file, element);
    let mut out = format!("## Keys of `{title}`\n\n{place}{}\n\n", element.about.trim());
    let row = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    out += &row(&used.iter().map(|column| heads[*column].to_owned()).collect::<Vec<_>>());
    out += &format!("|{}\n", "---|".repeat(used.len()));
    for line in &lines {
        out += &row(&used.iter().map(|column| line[*column].clone()).collect::<Vec<_>>());
    }
    out
}

/// The link from a page to the keys of the element with this table.
fn link(table: &'static Table, from: &str, places: &BTreeMap<String, String>) -> String {
    let found = files().into_iter().find_map(|(file, elements)| {
        let element = elements.into_iter().find(|element| element.table == table)?;
        Some((element.name, mark(file, &element)))
    });
    let (name, mark) = found.unwrap_or_default();
    let name = if name.is_empty() { mark.clone() } else { name.to_owned() };
    let folder = |path: &str| path.rsplit_once('/').map_or(String::new(), |(folder, _)| folder.to_owned());
    // The parts of a circuit are in the table of the circuit.
    let mark = if hydraulics::CIRCUIT.iter().any(|part| part.table == table) { CIRCUIT.to_owned() } else { mark };
    let page = places.get(&mark).map_or("", String::as_str);
    let path = match page {
        _ if page == from => String::new(),
        _ if folder(page) == folder(from) => page.rsplit('/').next().unwrap_or_default().to_owned(),
        _ => format!("{}{page}", "../".repeat(from.matches('/').count())),
    };
    format!("[{name}]({path}#{})", anchor(&mark))
}

/// Path of the first place of an object with these keys. Empty for the whole file.
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

/// Form of an object with these keys below a key of this kind, if it is possible.
fn inside(kind: &Kind, table: &'static Table) -> Option<&'static str> {
    match kind {
        Kind::Object(one) => (*one == table).then_some(""),
        Kind::Group(of) => inside(of, table).map(|_| ".<name>"),
        Kind::List(of) => inside(of, table).map(|_| "[i]"),
        _ => None,
    }
}

/// Description of the allowed values of a key.
fn value(link: &dyn Fn(&'static Table) -> String, kind: &Kind, key: &Key) -> String {
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
        Kind::Object(table) => match table.short {
            Short::None => link(table),
            Short::First => format!("{}, or {}", value(link, &table.keys[0].kind, &table.keys[0]), link(table)),
            Short::Word(word) => format!("`{word}`, or {}", link(table)),
        },
        Kind::Group(of) if key.names == Names::Line => format!("for each variable: {}", value(link, of, key)),
        Kind::Group(of) => format!("for each name: {}", value(link, of, key)),
        Kind::List(Kind::Pair) => "list of pairs of numbers".into(),
        Kind::List(of) => format!("list: {}", value(link, of, key)),
        Kind::Own(words) => (*words).into(),
    }
}

/// Unit and limits of a number. Empty for any other value.
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
    let text = key.range.text();
    let words = ["a finite number ", "a number ", "a whole number ", "a length ", "an angle "];
    let limits = words.iter().find_map(|words| text.strip_prefix(words)).unwrap_or(&text);
    let limits = if limits.starts_with("> 0, from 1e-100") { "> 0" } else { limits };
    let is_plain = key.range == Range::Finite || limits == ANY;
    [names(key.units) + &second, if is_plain { String::new() } else { limits.to_owned() }]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::workspace::Workspace;
    use std::fs;
    use std::path::PathBuf;

    fn folder() -> PathBuf {
        Workspace::locate().descriptions().join("../docs/reference")
    }

    /// The committed pages of elements.
    fn committed() -> BTreeMap<String, String> {
        let folders = ["mechanism", "hydraulics", "network", "system"]
            .map(|name| (name, fs::read_dir(folder().join(name)).unwrap()));
        let pages = folders.into_iter().flat_map(|(name, files)| {
            // Pictures are in folders next to the pages.
            files.map(|file| file.unwrap().path()).filter(|path| path.is_file()).map(move |path| {
                (format!("{name}/{}", path.file_name().unwrap().to_str().unwrap()), fs::read_to_string(path).unwrap())
            })
        });
        pages.collect()
    }

    #[test]
    fn each_key_has_its_line() {
        let pages = filled(&committed()).unwrap();
        for (page, line) in [
            ("mechanism/springs.md", "## Keys of `spring`\n\nLocation: `springs.<name>`. A spring "),
            ("mechanism/springs.md", "Location: `springs.<name>.gas`."),
            ("mechanism/cams.md", "Location: `couplings.<name>.segments[i]`."),
            ("mechanism/actuators.md", "[circuit](../hydraulics/circuit.md#keys-of-circuit)"),
            (
                "mechanism/springs.md",
                "| `stiffness` | Stiffness of the linear spring. | number [N/m or N.m/rad], >= 0 | `0.0` | fixed |",
            ),
            ("mechanism/stops.md", "| number, from 0 to 1 | `0.0` | tunable |"),
            ("mechanism/joints.md", "| `revolute`, `prismatic`, `slot` | required |"),
            ("mechanism/index.md", "| `equilibrium`, or [start](start.md#keys-of-start) | required |"),
            ("hydraulics/circuit.md", "| number [m3/s], > 0 |"),
            ("keys-of-mechanism.md", "| [gas](mechanism/springs.md#keys-of-gas) | `pressure`, "),
            ("keys-of-hydraulics.md", "`damping_ratio` | `circuit.valve` |"),
        ] {
            assert!(pages[page].contains(line), "{page}: {line}");
        }
        assert!(pages.values().all(|page| !page.contains("`expressions` |")));
    }

    #[test]
    fn a_page_without_an_element_is_an_error() {
        let faults = [("mechanism/joints.md", "<!-- keys: joint -->"), ("hydraulics/index.md", " coupling -->")];
        for (page, removed) in faults {
            let mut pages = committed();
            let text = pages[page].replacen(removed, "<!-- keys: nothing -->", 1);
            pages.insert(page.to_owned(), text);
            assert!(filled(&pages).is_err(), "{page}");
        }
    }

    /// With LINKAGE_FMU_WRITE set, the committed pages are rewritten.
    #[test]
    fn the_committed_pages_are_those_of_the_tables() {
        for (name, page) in filled(&committed()).unwrap() {
            let path = folder().join(name);
            if std::env::var_os("LINKAGE_FMU_WRITE").is_some() {
                fs::write(&path, &page).unwrap();
            }
            let same = fs::read_to_string(&path).unwrap() == page;
            assert!(same, "{}: LINKAGE_FMU_WRITE=1 cargo test -p fmu-build --lib reference writes it", path.display());
        }
    }
}
