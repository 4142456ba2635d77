//! The imports in `src` agree with the table of modules in ARCHITECTURE.md, and no files import each other in a circle.
//!
//! A module imports only from rows above its own, and nothing that its row forbids. So no layer imports upwards. The
//! tests resolve paths with `crate::`, `super::`, brackets and re-exports. Tests in the sources are excluded.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A row of the table: path of the module, such as `mechanism::curve`, and the modules that it must not know.
struct Row {
    module: String,
    forbidden: Vec<String>,
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Texts in backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// `src/mechanism/curve` as a path of modules.
fn module_of(path: &str) -> String {
    let path = path.trim_start_matches("src/").trim_end_matches(".rs").trim_end_matches('/');
    path.replace('/', "::")
}

fn table() -> Vec<Row> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| `src/"));
    let row = |line: &str| {
        let columns: Vec<&str> = line.split('|').collect();
        let forbidden = quoted(columns[3]).map(module_of).collect();
        (module_of(quoted(columns[1]).next().unwrap()), forbidden)
    };
    rows.map(row).map(|(module, forbidden)| Row { module, forbidden }).collect()
}

/// Source files below a folder, without those of tests.
fn files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = entry.file_name().unwrap().to_str().unwrap();
        if entry.is_dir() && name != "tests" {
            files(&entry, out);
        } else if name.ends_with(".rs") && name != "tests.rs" {
            out.push(entry);
        }
    }
}

/// Crates in folders of `src`. Their paths start with the name of the crate here, as if all were one crate.
const CRATES: [&str; 2] = ["foundation", "hydraulics"];
/// Modules of the crate `foundation`, which the engine exports again.
const FOUNDATION: [&str; 6] = ["numerics", "codec", "variables", "format", "inspection", "integrator"];

/// Code of a file without comments and tests.
fn code(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    let own = text.split("\nmod tests").next().unwrap();
    let lines: Vec<_> = own.lines().map(|line| line.split("//").next().unwrap()).collect();
    let code = lines.join("\n");
    let shown = file.strip_prefix(root()).unwrap();
    if let Some(own) = CRATES.iter().find(|name| shown.starts_with(Path::new("src").join(name))) {
        let code = code.replace("foundation::", "linkage_fmu::foundation::");
        return code.replace("crate::", &format!("crate::{own}::")).replace("linkage_fmu::", "crate::");
    }
    let engine = code.replace("linkage_fmu::", "crate::");
    let to_foundation =
        |code: String, name: &&str| code.replace(&format!("crate::{name}"), &format!("crate::foundation::{name}"));
    FOUNDATION.iter().fold(engine, to_foundation)
}

/// Paths of a tree of imports such as `a::{b, c::{d, e}}`.
fn expand(prefix: &str, tree: &str, out: &mut BTreeSet<String>) {
    let tree = tree.trim();
    let Some((head, rest)) = tree.split_once('{') else {
        out.insert(format!("{prefix}{tree}"));
        return;
    };
    let inner = rest.strip_suffix('}').unwrap_or(rest);
    let (mut depth, mut from) = (0, 0);
    for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !inner[from..at].trim().is_empty() {
                    expand(&format!("{prefix}{head}"), &inner[from..at], out);
                }
                from = at + 1;
            }
            _ => {}
        }
    }
}

/// Absolute paths that the code of a module imports.
fn imports(module: &str, code: &str) -> BTreeSet<String> {
    let mut out = BTreeSet::new();
    for start in ["crate::", "super::"] {
        for (at, _) in code.match_indices(start) {
            if code[..at].ends_with("super::") || code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
                continue;
            }
            let mut depth = 0;
            let end = code[at..].find(|c: char| {
                depth += i32::from(c == '{') - i32::from(c == '}');
                depth < 0 || depth == 0 && !(c.is_alphanumeric() || "_:{}".contains(c))
            });
            let mut tree = &code[at..end.map_or(code.len(), |end| at + end)];
            let mut base: Vec<&str> = module.split("::").collect();
            while let Some(rest) = tree.strip_prefix("super::") {
                (tree, _) = (rest, base.pop());
            }
            let base = if start == "crate::" { String::new() } else { format!("{}::", base.join("::")) };
            expand(&base, tree.strip_prefix("crate::").unwrap_or(tree), &mut out);
        }
    }
    out.into_iter().map(|path| path.trim_start_matches("::").to_owned()).collect()
}

fn is_within(path: &str, module: &str) -> bool {
    path == module || path.strip_prefix(module).is_some_and(|rest| rest.starts_with("::"))
}

#[test]
fn no_module_imports_upwards() {
    let (rows, mut sources, mut wrong) = (table(), Vec::new(), Vec::new());
    assert!(rows.len() > 15, "ARCHITECTURE.md has a table of modules");
    files(&root().join("src"), &mut sources);
    let row_of = |path: &str| {
        let rows = rows.iter().enumerate().filter(|(_, row)| is_within(path, &row.module));
        rows.max_by_key(|(_, row)| row.module.len()).map(|(index, _)| index)
    };
    for file in &sources {
        let shown = file.strip_prefix(root()).unwrap().display().to_string();
        let module = module_of(shown.trim_end_matches("/mod.rs").trim_end_matches("/lib.rs"));
        let Some(own) = row_of(&module) else {
            // A file that only declares modules has no row: it imports nothing.
            let declares = shown.ends_with("/mod.rs") || shown.ends_with("/lib.rs") || shown == "src/lib.rs";
            assert!(declares, "{shown}: no row of ARCHITECTURE.md has it");
            continue;
        };
        for path in imports(&module, &code(file)) {
            let Some(other) = row_of(&path) else {
                if !is_within(&module, &path) {
                    wrong.push(format!("{shown}: {path} is in no row: import from the module that has it"));
                }
                continue;
            };
            if other > own || rows[own].forbidden.iter().any(|forbidden| is_within(&path, forbidden)) {
                wrong.push(format!("{shown} ({}): must not import {path}", rows[own].module));
            }
        }
    }
    assert!(wrong.is_empty(), "{} imports:\n{}", wrong.len(), wrong.join("\n"));
}

/// Names that a module re-exports, with the paths that they stand for.
fn re_exports(module: &str, code: &str) -> BTreeMap<String, String> {
    let is_public = |before: &str| before.ends_with("pub ") || before.ends_with(") ");
    let statements = code.match_indices("use ").filter(|(at, _)| is_public(&code[..*at]));
    let trees = statements.filter_map(|(at, _)| code[at + 4..].split(';').next());
    let mut out = BTreeSet::new();
    for tree in trees {
        if tree.starts_with("crate::") || tree.starts_with("super::") {
            out.extend(imports(module, tree));
        } else {
            expand(&format!("{module}::"), tree, &mut out);
        }
    }
    out.into_iter().map(|path| (path.rsplit("::").next().unwrap().to_owned(), path)).collect()
}

/// The file that defines what an absolute path names, through at most four re-exports.
fn definer<'m>(path: &str, files: &'m BTreeMap<String, (String, BTreeMap<String, String>)>) -> Option<&'m str> {
    let mut path = path.to_owned();
    for _ in 0..4 {
        let parts: Vec<&str> = path.split("::").collect();
        let length = (1..=parts.len()).rev().find(|length| files.contains_key(&parts[..*length].join("::")))?;
        let (module, (_, renamed)) = files.get_key_value(&parts[..length].join("::"))?;
        match parts.get(length).and_then(|name| renamed.get(*name)) {
            Some(other) => path = other.clone(),
            None => return Some(module),
        }
    }
    None
}

/// The imports of each file from files that are neither its parents nor its children, as far as they are in a circle.
fn circles(files: &BTreeMap<String, (String, BTreeMap<String, String>)>) -> Vec<String> {
    let of = |(module, (code, _)): (&String, &(String, _))| {
        let paths = imports(module, code);
        let others = paths.iter().filter_map(|path| definer(path, files));
        let others = others.filter(|other| !is_within(other, module) && !is_within(module, other));
        (module.clone(), others.map(str::to_owned).collect::<BTreeSet<_>>())
    };
    let mut graph: BTreeMap<String, BTreeSet<String>> = files.iter().map(of).collect();
    // A file that imports nothing is in no circle, and nor is a file that no other file imports from.
    loop {
        let imported: BTreeSet<String> = graph.values().flatten().cloned().collect();
        let is_end = |(module, others): &(&String, &BTreeSet<_>)| others.is_empty() || !imported.contains(*module);
        let Some(end) = graph.iter().find(is_end).map(|(module, _)| module.clone()) else { break };
        graph.remove(&end);
        graph.values_mut().for_each(|others| _ = others.remove(&end));
    }
    graph.iter().map(|(module, others)| format!("{module} imports from {others:?}")).collect()
}

/// A file may import from its parent module and from its children. Without these imports there are no circles, so that
/// every file can be understood after the files that it imports from.
#[test]
fn no_files_import_each_other_in_a_circle() {
    for folder in ["src", "fmu-build/src", "fmu-build/studies/src", "fmu-build/cli/src", "validation/src"] {
        let (folder, mut sources) = (root().join(folder), Vec::new());
        files(&folder, &mut sources);
        let of = |file: &PathBuf| {
            let module = module_of(file.strip_prefix(&folder).unwrap().to_str().unwrap().trim_end_matches("/mod.rs"));
            let code = code(file);
            (module.clone(), (code.clone(), re_exports(&module, &code)))
        };
        let found = circles(&sources.iter().map(of).collect());
        assert!(found.is_empty(), "{}: files in circles:\n{}", folder.display(), found.join("\n"));
    }
}

#[test]
fn a_circle_through_a_re_export_is_found() {
    let file = |module: &str, code: &str| (module.to_owned(), (code.to_owned(), re_exports(module, code)));
    let a = ("a", "pub use b::B;\npub use c::C;");
    let (b, c) = (("a::b", "use super::C;"), ("a::c", "use crate::a::B;"));
    let found = circles(&[a, b, c].map(|(module, code)| file(module, code)).into());
    assert_eq!(found.len(), 2, "{found:?}");
    let (b, c) = (("a::b", "use super::A;"), ("a::c", "use super::b::B;"));
    assert_eq!(circles(&[a, b, c].map(|(module, code)| file(module, code)).into()), [""; 0]);
}

#[test]
fn trees_of_imports_are_expanded() {
    let code = "use crate::a::{B, c::{d, E}};\nuse super::super::f::G;\nfn h() { crate::i::j() }";
    let all: Vec<_> = imports("x::y::z", code).into_iter().collect();
    assert_eq!(all, ["a::B", "a::c::E", "a::c::d", "i::j", "x::f::G"]);
}

/// Lines of Rust code have at most 120 columns. rustfmt does not wrap comments, texts and macros.
#[test]
fn lines_have_at_most_120_columns() {
    let mut found = Vec::new();
    for folder in ["src", "fmu-build", "tests", "validation", "examples"] {
        let mut folders = vec![root().join(folder)];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                if entry.is_dir() {
                    folders.push(entry);
                } else if entry.extension().is_some_and(|ending| ending == "rs") {
                    let text = fs::read_to_string(&entry).unwrap();
                    let wide = text.lines().zip(1..).filter(|(line, _)| line.chars().count() > 120);
                    found.extend(wide.map(|(_, number)| format!("{}:{number}", entry.display())));
                }
            }
        }
    }
    assert!(found.is_empty(), "lines over 120 columns:\n{}", found.join("\n"));
}
