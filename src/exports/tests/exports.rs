//! Exports and dependencies of the shared library, which the loader of an importer reads.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used)]

use object::read::NameOrOrdinal;
use object::{Object, ObjectSection};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Prefix and number of the functions of FMI 2.0.5 (common, co-simulation, model exchange) and of FMI 3.0.2.
const FUNCTIONS: [(&str, usize); 2] = [("fmi2", 44), ("fmi3", 75)];
/// Libraries that every Linux with glibc has.
const NEEDED: [&str; 4] = ["libgcc_s.so.1", "libm.so.6", "libc.so.6", "ld-linux-x86-64.so.2"];
/// Version of glibc stated in docs/reference/fmi.md.
const GLIBC: (u32, u32) = (2, 35);

/// The library that cargo builds in the folder of this test, from the same sources as the packed library.
fn library() -> Vec<u8> {
    let folder = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let name = "liblinkage_fmu_exports.so";
    let path: PathBuf = [folder.join(name), folder.join("..").join(name)].into_iter().find(|p| p.exists()).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn nothing_but_the_functions_of_fmi_is_exported() {
    let content = library();
    let library = object::File::parse(&*content).unwrap();
    let names: BTreeSet<String> = library
        .exports()
        .unwrap()
        .filter_map(|export| match export.unwrap().name() {
            NameOrOrdinal::Name(name) => Some(String::from_utf8_lossy(name).into_owned()),
            NameOrOrdinal::Ordinal(_) => None,
        })
        .collect();
    let is_fmi = |name: &str| FUNCTIONS.iter().any(|(prefix, _)| name.starts_with(prefix));
    assert_eq!(names.iter().filter(|name| !is_fmi(name)).collect::<Vec<_>>(), [""; 0]);
    for (prefix, count) in FUNCTIONS {
        assert_eq!(names.iter().filter(|name| name.starts_with(prefix)).count(), count, "{names:?}");
    }
}

#[test]
fn only_libraries_that_every_linux_has_are_needed() {
    let content = library();
    let library = object::File::parse(&*content).unwrap();
    for needed in library.import_libraries().unwrap() {
        let needed = needed.unwrap();
        let name = String::from_utf8_lossy(needed.name());
        assert!(NEEDED.contains(&&*name), "{name}");
    }
}

#[test]
fn the_version_of_glibc_is_that_of_the_reference() {
    let content = library();
    let library = object::File::parse(&*content).unwrap();
    let strings = library.section_by_name(".dynstr").unwrap().data().unwrap();
    let newest = strings.split(|byte| *byte == 0).filter_map(|text| {
        let (major, minor) = std::str::from_utf8(text).ok()?.strip_prefix("GLIBC_")?.split_once('.')?;
        Some((major.parse::<u32>().ok()?, minor.split('.').next()?.parse::<u32>().ok()?))
    });
    let newest = newest.max().unwrap();
    assert!(newest <= GLIBC, "GLIBC_{}.{} is needed: say so in docs/reference/fmi.md and here", newest.0, newest.1);
    let page = include_str!("../../../docs/reference/fmi.md");
    assert!(page.contains(&format!("glibc {}.{}", GLIBC.0, GLIBC.1)), "docs/reference/fmi.md names another glibc");
}
