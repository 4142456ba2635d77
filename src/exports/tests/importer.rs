//! The library loaded by an importer: results identical to those of the linked functions, resources found from the path
//! of the library, and errors for files that are not FMUs.
#![allow(clippy::unwrap_used)]

use linkage_fmu::fmi2::host::{Description, logger};
use linkage_fmu::fmi2::importer::{Library, State};
use linkage_fmu::fmi2::types::Status;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription/LandingGearRetraction");
const HYDRAULIC: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription/LandingGearRetractionHydraulic");

/// The library that Cargo builds before the tests.
fn library_file() -> PathBuf {
    std::env::current_exe().unwrap().with_file_name(format!("{DLL_PREFIX}linkage_fmu_exports{DLL_SUFFIX}"))
}

fn gear() -> Arc<Description> {
    Description::read(Path::new(FOLDER)).unwrap()
}

#[test]
fn a_loaded_library_gives_the_results_of_the_linked_functions() {
    let resources = format!("file://{FOLDER}/resources");
    let gear = gear();
    let library = Library::open(library_file().as_os_str(), gear.interface().guid(), &resources).unwrap();
    let loaded = library.instantiate("gear", Some(logger())).unwrap();
    loaded.set_up(0.0, None).unwrap();
    let linked = gear.instantiate(Some(logger()), true).unwrap();
    assert_eq!(linked.set_up(None, 0.0, None), Status::Ok);
    let [force, angle, acceleration] =
        ["actuator.force", "crank.angle", "actuator.acceleration"].map(|name| gear.reference(name));
    loaded.set_reals(&[force], &[2e4]).unwrap();
    assert_eq!(linked.set("actuator.force", 2e4), Status::Ok);
    loaded.initialize().unwrap();
    assert_eq!(linked.initialize(), Status::Ok);
    let mut state = State::NONE;
    loaded.save(&mut state).unwrap();
    for k in 0..20 {
        let t = 1e-3 * f64::from(k);
        loaded.step(t, 1e-3).unwrap();
        assert_eq!(linked.step(t, 1e-3), Status::Ok);
    }
    let [seen, a] = loaded.reals(&[angle, acceleration]).unwrap();
    assert_eq!(seen.to_bits(), linked.get("crank.angle").unwrap().to_bits());
    // The derivative of the acceleration by the force is 1/m, with the reduced mass m. The same holds for their rates.
    let mobility = loaded.derivative(acceleration, force).unwrap();
    assert!((mobility * linked.get("actuator.reduced_mass").unwrap() - 1.0).abs() < 1e-12);
    let rate = loaded.rate(acceleration).unwrap();
    loaded.set_derivatives(force, &[1e3, 0.0]).unwrap();
    assert!((loaded.rate(acceleration).unwrap() - rate - 1e3 * mobility).abs() < 1e-9 * rate.abs());
    assert!(a.is_finite());
    // Restored to the start, the same steps give the same values.
    loaded.restore(&state).unwrap();
    (0..20).for_each(|k| loaded.step(1e-3 * f64::from(k), 1e-3).unwrap());
    assert_eq!(loaded.reals(&[angle]).unwrap()[0].to_bits(), seen.to_bits());
    loaded.free(&mut state).unwrap();
    let refused = loaded.step(-1.0, 1e-3).unwrap_err();
    assert!(refused.contains("fmi2DoStep: fmi2Status 3") && refused.contains("-1"), "{refused}");
}

#[test]
#[cfg(target_os = "linux")]
fn resources_are_found_next_to_the_library() {
    let folder = std::env::temp_dir().join(format!("linkage-fmu unpacked {}", std::process::id()));
    let (binaries, resources) = (folder.join("binaries/linux64"), folder.join("resources"));
    fs::create_dir_all(&binaries).unwrap();
    fs::create_dir_all(&resources).unwrap();
    let file = binaries.join("Gear").with_extension(library_file().extension().unwrap());
    fs::copy(library_file(), &file).unwrap();
    fs::copy(Path::new(FOLDER).join("resources/mechanism.json"), resources.join("mechanism.json")).unwrap();
    let library = Library::open(file.as_os_str(), gear().interface().guid(), "").unwrap();
    library.instantiate("gear", Some(logger())).unwrap();
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_mechanism_with_hydraulics_is_rejected_with_the_remedy() {
    let described = Description::read(Path::new(HYDRAULIC)).unwrap();
    let resources = format!("file://{HYDRAULIC}/resources");
    let library = Library::open(library_file().as_os_str(), described.interface().guid(), &resources).unwrap();
    let refused = library.instantiate("gear", Some(logger())).unwrap_err();
    assert!(refused.contains("without the keys `hydraulics`") && refused.contains("cargo fmu package"), "{refused}");
}

#[test]
fn a_file_that_is_not_an_fmu_gives_an_error_with_its_name() {
    let refusal = |path: &OsStr, guid: &str| Library::open(path, guid, "").unwrap_err();
    assert!(refusal(OsStr::new("/nowhere/x.so"), "").contains("/nowhere/x.so: "));
    if cfg!(target_os = "linux") {
        assert!(refusal(OsStr::new("libm.so.6"), "").contains("libm.so.6: the library does not export fmi2"));
    }
    let library =
        Library::open(library_file().as_os_str(), "{another}", &format!("file://{FOLDER}/resources")).unwrap();
    let refused = library.instantiate("gear", Some(logger())).unwrap_err();
    assert!(refused.contains("fmi2Instantiate: refused") && refused.contains("{another}"), "{refused}");
}
