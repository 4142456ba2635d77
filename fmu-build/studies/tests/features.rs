//! The common crates of both programs and of the Python module are built once: all three need the same features.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::env;
use std::process::Command;

/// Features of each crate of a program, by name and version.
fn features(package: &str) -> BTreeMap<String, String> {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap());
    cargo.args([
        "tree",
        "--offline",
        "--edges",
        "normal",
        "--prefix",
        "none",
        "--format",
        "{p}|{f}",
        "--package",
        package,
    ]);
    let output = cargo.output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let crates = text.lines().filter_map(|line| line.split_once('|'));
    crates.map(|(name, features)| (name.to_owned(), features.trim_end_matches(" (*)").to_owned())).collect()
}

#[test]
fn no_crate_is_built_twice_for_the_programs_and_the_python_module() {
    let (packer, studies) = (features("fmu-build"), features("fmu-studies"));
    assert!(packer.len() > 20 && studies.len() > packer.len());
    let module = features("linkage-fmu-wheel");
    let crates = packer.iter().map(|crate_| (crate_, &studies)).chain(studies.iter().map(|crate_| (crate_, &module)));
    for ((name, features), other) in crates {
        assert_eq!(&other[name], features, "{name}: name these features in fmu-build/Cargo.toml or leave them out");
    }
}
