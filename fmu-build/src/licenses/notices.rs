//! Writes and checks the notices of the linked crates: authors and licences.
//!
//! In: the packages that Cargo links into the library of an FMU and into the program of the wheel, with the licence
//! files in their sources. Out: `library.txt` and `fmu-build/wheel/THIRD-PARTY.txt`, one section per licence text. The
//! command `LINKAGE_FMU_WRITE=1 cargo test --package fmu-build --lib notices` writes them, after `cargo fetch`.

use crate::workspace::Workspace;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Machines for which libraries and wheels are built.
const TARGETS: [&str; 5] = [
    "x86_64-unknown-linux-gnu",
    "aarch64-unknown-linux-gnu",
    "x86_64-pc-windows-gnu",
    "x86_64-apple-darwin",
    "aarch64-apple-darwin",
];
/// Package of Cargo with its product, the file of its notices, and the number of items of [`EMBEDDED`] in it.
const LINKED: [(&str, &str, &str, usize); 2] = [
    ("linkage-fmu-exports", "the library and the animation of an FMU", "fmu-build/src/licenses/library.txt", 1),
    ("linkage-fmu-wheel", "the program of the Python wheel", "fmu-build/wheel/THIRD-PARTY.txt", 4),
];
/// If a package offers several licences, the first of these applies.
const CHOICE: [&str; 4] = ["MIT", "Apache-2.0", "Zlib", "BSD"];
/// Files of other authors in pages and programs, each with its licence.
const EMBEDDED: [(&str, &str); 4] = [
    ("uPlot, in the pages with plots (MIT)", "fmu-build/src/view/page/uplot/LICENSE"),
    ("samples by Sobol's sequence (BSD-3-Clause)", "fmu-build/studies/src/sweep/joe_kuo/LICENSE"),
    ("CodeMirror, in the live page (MIT)", "fmu-build/studies/src/live/page/editor/LICENSE"),
    ("Ubuntu Light, in films (Ubuntu-font-1.0)", "fmu-build/studies/src/simulate/film/font/LICENSE"),
];
const RUST: &str = include_str!("rust.txt");
const MIT: &str = include_str!("../../../LICENSE-MIT");
const RULE: &str = "================================================================================";

struct Package {
    title: String,
    license: String,
    authors: String,
    folder: PathBuf,
}

fn cargo(arguments: &[&str]) -> String {
    let mut cargo = Command::new(env!("CARGO"));
    let output = cargo.args(arguments).args(["--offline", "--locked"]).current_dir(Workspace::locate().root());
    let output = output.output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Name and version of each package of a registry that is linked into `package` for this machine.
fn linked(package: &str, target: &str) -> BTreeSet<String> {
    let format = ["--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}"];
    let text = cargo(&[&["tree", "--package", package, "--target", target][..], &format].concat());
    let own = Workspace::locate().root().display().to_string();
    let lines = text.lines().filter(|line| !line.is_empty() && !line.contains(&own));
    lines.map(|line| line.split(' ').take(2).collect::<Vec<_>>().join(" ").replace(" v", " ")).collect()
}

/// The packages with their sources, by name and version: those for one machine, or all.
fn packages(target: Option<&str>) -> BTreeMap<String, Package> {
    let only = target.map_or_else(Vec::new, |target| vec!["--filter-platform", target]);
    let text = cargo(&[&["metadata", "--format-version", "1"], &only[..]].concat());
    let all: Value = serde_json::from_str(&text).unwrap();
    let package = |package: &Value| {
        let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        let title = format!("{} {}", text("name"), text("version"));
        let authors: Vec<&str> = package["authors"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
        let folder = Path::new(&text("manifest_path")).parent().unwrap().to_path_buf();
        (title.clone(), Package { title, license: text("license"), authors: authors.join(", "), folder })
    };
    all["packages"].as_array().unwrap().iter().map(package).collect()
}

impl Package {
    /// The licence that applies here.
    fn choice(&self) -> &str {
        let options: Vec<&str> = self.license.split(" OR ").flat_map(|part| part.split('/')).map(str::trim).collect();
        let of_all = self.license.contains(" AND ");
        let chosen = CHOICE.iter().find_map(|word| options.iter().find(|option| option.starts_with(word)));
        if of_all { &self.license } else { chosen.unwrap_or(&options[0]) }
    }

    /// Texts of the applicable licence, and of notices.
    fn texts(&self) -> Vec<String> {
        let names = self.folder.read_dir().unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let names: BTreeSet<String> = names.collect();
        let begins = |name: &&String, words: &[&str]| words.iter().any(|word| name.to_lowercase().starts_with(word));
        let licences: Vec<&String> = names.iter().filter(|name| begins(name, &["license", "licence"])).collect();
        let word = self.choice().split(['-', ' ']).next().unwrap().to_lowercase();
        let mut files: Vec<&String> =
            licences.iter().filter(|name| name.to_lowercase().contains(&word)).copied().collect();
        if files.is_empty() {
            files = licences;
        }
        files.extend(names.iter().filter(|name| begins(name, &["notice", "copyright"])));
        let mut texts: Vec<String> = files.into_iter().map(|name| self.read(name)).collect();
        if !texts.iter().any(|text| text.len() > 500) || self.license.contains(" AND ") {
            // The package contains no licence text.
            assert!(self.license.contains("MIT"), "{}: no text of {}; add it to EMBEDDED", self.title, self.license);
            let rest = MIT.split_once("\n\n").and_then(|(_, rest)| rest.split_once("\n\n")).unwrap().1;
            texts.insert(0, format!("Copyright (c) {}\n\n{rest}", self.authors));
        }
        texts
    }

    fn read(&self, name: &str) -> String {
        let text = fs::read(self.folder.join(name)).unwrap();
        String::from_utf8_lossy(&text).replace("\r\n", "\n").trim_start_matches('\u{feff}').to_owned()
    }
}

/// The copyright lines of a licence, and the rest of the text.
fn divided(text: &str) -> (Vec<String>, String) {
    let names = |line: &str| {
        let line = line.trim().trim_start_matches('*').trim();
        let is_notice = line.contains("(c)") || line.contains("(C)") || line.contains(|c: char| c.is_ascii_digit());
        line.starts_with("Copyright") && is_notice && !line.contains("[yyyy]")
    };
    let (owners, rest): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| names(line));
    let rest: Vec<&str> = rest.into_iter().map(str::trim_end).collect();
    (owners.into_iter().map(|line| line.trim().to_owned()).collect(), rest.join("\n").trim_matches('\n').to_owned())
}

/// The letters of a text. Texts with different layout have the same letters.
fn letters(text: &str) -> String {
    text.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

fn notices(what: &str, packages: &[&Package], embedded: &[(&str, &str)]) -> String {
    // Sections by the letters of their text: the text, and the packages with their copyright holders.
    let mut sections: BTreeMap<String, (String, Vec<String>)> = BTreeMap::new();
    let of_packages = packages.iter().flat_map(|package| {
        let title = format!("{} ({})", package.title, package.choice());
        package.texts().into_iter().map(move |text| (title.clone(), text))
    });
    let embedded = embedded.iter().map(|(title, path)| ((*title).to_owned(), fs::read_to_string(file(path)).unwrap()));
    for (title, text) in of_packages.chain(embedded) {
        let (owners, rest) = divided(&text);
        let lines = [vec![title], owners].concat().join("\n    ");
        sections.entry(letters(&rest)).or_insert_with(|| (rest, Vec::new())).1.push(lines);
    }
    let mut text = format!("Notices of third parties in {what}\n\n{RUST}");
    for (licence, titles) in sections.values() {
        text += &format!("{RULE}\n{}\n\n{licence}\n\n", titles.join("\n"));
    }
    text
}

/// Whether a licence is in the notices, with its copyright holders.
fn holds(notices: &str, licence: &str) -> bool {
    let (owners, rest) = divided(licence);
    letters(notices).contains(&letters(&rest)) && owners.iter().all(|owner| notices.contains(owner))
}

/// This machine, as Rust names it.
fn host() -> String {
    let rustc = Command::new("rustc").arg("-vV").output().unwrap();
    let text = String::from_utf8(rustc.stdout).unwrap();
    text.lines().find_map(|line| line.strip_prefix("host: ")).unwrap().to_owned()
}

fn file(path: &str) -> PathBuf {
    Workspace::locate().root().join(path)
}

/// Each package that is linked on this machine has a notice with its present licence.
#[test]
fn each_linked_package_has_its_notice() {
    for (package, what, path, embedded) in LINKED {
        if std::env::var_os("LINKAGE_FMU_WRITE").is_some() {
            let sources = packages(None);
            let titles: BTreeSet<String> = TARGETS.iter().flat_map(|target| linked(package, target)).collect();
            let chosen: Vec<&Package> = titles.iter().map(|title| &sources[title]).collect();
            let text = notices(what, &chosen, &EMBEDDED[..embedded]);
            fs::write(file(path), text).unwrap();
        }
        let text = fs::read_to_string(file(path)).unwrap();
        let host = host();
        let (sources, titles) = (packages(Some(&host)), linked(package, &host));
        assert!(titles.iter().any(|title| title.starts_with("nalgebra ")), "{titles:?}");
        let remedy = "run `LINKAGE_FMU_WRITE=1 cargo test --package fmu-build --lib notices` after `cargo fetch`";
        for package in titles.iter().map(|title| &sources[title]) {
            assert!(text.contains(&format!("\n{} (", package.title)), "{}: {remedy}", package.title);
            assert!(package.texts().iter().all(|part| holds(&text, part)), "{}: {remedy}", package.title);
        }
        // Packages for other machines have the version of the lock file too.
        let lock = fs::read_to_string(file("Cargo.lock")).unwrap();
        for line in text.lines().filter(|line| !line.starts_with(' ') && line.ends_with(')')) {
            if let [name, version, _, ..] = line.split(' ').collect::<Vec<_>>()[..]
                && version.starts_with(|c: char| c.is_ascii_digit())
            {
                let entry = format!("name = \"{name}\"\nversion = \"{version}\"\n");
                assert!(lock.contains(&entry), "{path}: {name} {version} is not in Cargo.lock; {remedy}");
            }
        }
    }
}

/// Each embedded file of other authors has its licence next to it and in the notices.
#[test]
fn each_embedded_file_of_others_has_its_notice() {
    let text = fs::read_to_string(file(LINKED[1].2)).unwrap();
    let mut folders = vec![file("fmu-build/src"), file("fmu-build/studies/src"), file("fmu-build/python")];
    let mut found = 0;
    while let Some(folder) = folders.pop() {
        for path in folder.read_dir().unwrap().map(|entry| entry.unwrap().path()) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                folders.push(path);
            } else if name == "LICENSE" {
                let licence = fs::read_to_string(&path).unwrap();
                assert!(holds(&text, &licence), "{}: its licence is not among the notices", path.display());
                found += 1;
            } else if name.contains(".min.") || name.ends_with(".ttf") || name.ends_with(".woff2") {
                assert!(path.with_file_name("LICENSE").is_file(), "{}: has no LICENSE next to it", path.display());
            }
        }
    }
    assert_eq!(found, EMBEDDED.len());
}
