//! With `solver.prepare` the initialisation builds all tables: from the first one on, no step and no get function
//! allocates memory or reads a file.
use super::counting::allocations;
use linkage_fmu::component::{Component, MECHANISM, Stepped, TABLES};
use linkage_fmu::variables::{Kind, Reference};
use std::fs;
use std::path::{Path, PathBuf};

/// Length of a step [s], number of steps after which all outputs are read, and number of steps. The environment
/// variable LINKAGE_FMU_STEPS changes the last number.
const STEP: f64 = 1e-3;
const READ: usize = 1500;
const STEPS: usize = 10_000;
/// After 16 s the motion of this example leaves the prepared part of its curve, so it never makes more steps.
const OPEN: &str = "GearTrain/";
/// Examples with reactions that have no table near a crossing. There the exact evaluator may allocate this often in all
/// steps and readings together.
const WITHOUT_TABLES: [&str; 2] = ["FourBarChain/", "MainGear/"];
const MOST: usize = 200;

/// The folders of the examples that are mechanisms.
fn examples() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription");
    let all = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path().join("resources"));
    all.filter(|folder| folder.join(MECHANISM.file()).is_file()).collect()
}

fn outputs(component: &Component) -> Vec<Reference> {
    let list = (0..).zip(component.interface().list());
    list.filter(|(_, v)| v.kind == Kind::Real && v.is_output()).map(|(reference, _)| reference).collect()
}

fn prepare(component: &mut Component) {
    let reference = component.interface().find("solver.prepare").unwrap();
    component.set_boolean(reference, true).unwrap();
    component.initialize().unwrap();
}

#[test]
fn a_prepared_mechanism_allocates_nothing_from_the_first_step_on() {
    let examples = examples();
    assert!(examples.len() > 10);
    for folder in examples {
        let text = fs::read_to_string(folder.join(MECHANISM.file())).unwrap();
        let mut plain = Component::from_definition(MECHANISM.file(), &text).unwrap();
        let kept = std::env::temp_dir().join(format!("linkage prepared {}", std::process::id()));
        fs::create_dir_all(&kept).unwrap();
        fs::write(kept.join(TABLES), plain.tables(&text).unwrap_or_default()).unwrap();
        let (mut prepared, _) = Component::with_tables(&MECHANISM, &text, &kept).unwrap();
        prepare(&mut prepared);
        fs::remove_dir_all(&kept).unwrap();
        plain.initialize().unwrap();
        assert_equal_runs(&folder, &mut prepared, &mut plain);
    }
}

/// Both runs have equal values, and the prepared one allocates no memory.
fn assert_equal_runs(folder: &Path, prepared: &mut Component, plain: &mut Component) {
    let outputs = outputs(plain);
    let [mut values, mut expected] = [(); 2].map(|()| Vec::with_capacity(outputs.len()));
    let is_tabled = !WITHOUT_TABLES.iter().any(|name| folder.to_string_lossy().contains(name));
    let mut exceptions = if is_tabled { 0 } else { MOST };
    let stated = std::env::var("LINKAGE_FMU_STEPS").ok().filter(|_| !folder.to_string_lossy().contains(OPEN));
    for step in 0..stated.map_or(STEPS, |steps| steps.parse().unwrap()) {
        let before = allocations();
        let stepped = prepared.step(STEP);
        if !matches!(stepped, Ok(Stepped::Whole)) {
            assert!(step > 0, "{}: {stepped:?}", folder.display());
            return;
        }
        if step < READ {
            values.clear();
            prepared.reals(&outputs, |value| values.push(value.to_bits())).unwrap();
        }
        let made = allocations() - before;
        assert!(made <= exceptions, "{}, step {step}: {made}", folder.display());
        exceptions -= made;
        if step < READ {
            plain.step(STEP).unwrap();
            expected.clear();
            plain.reals(&outputs, |value| expected.push(value.to_bits())).unwrap();
            assert_eq!(values, expected, "{}, step {step}", folder.display());
        }
    }
}
