//! Stored tables: an instance that reads them is bit-identical to an instance that computes them, and no file of tables
//! can do harm.
use crate::support::{CURVES, GEAR, changed};
use linkage_fmu::codec::sections::{self, Sections};
use linkage_fmu::component::{Component, MECHANISM};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind};
use serde_json::json;
use std::fs;
use std::path::Path;
use std::sync::Arc;

const FILE: &str = "mechanism.json";

/// Texts of the committed mechanisms.
pub fn committed() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("modelDescription");
    let folders = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path().join("resources").join(FILE));
    folders.filter_map(|file| fs::read_to_string(file).ok()).collect()
}

/// Bits of every Real after the start and after each of three steps, after one Boolean parameter has changed.
fn history(mut model: Component, switched: Option<u32>) -> Vec<Option<u64>> {
    let list = model.interface().list().to_vec();
    if let Some(flag) = switched {
        let value = !model.boolean(flag).unwrap();
        model.set_boolean(flag, value).unwrap();
    }
    if model.initialize().is_err() {
        return Vec::new();
    }
    let mut bits = Vec::new();
    for step in 0..4 {
        if step > 0 && model.step(0.01).is_err() {
            break;
        }
        let reals = (0..list.len() as u32).filter(|i| list[*i as usize].kind == Kind::Real);
        bits.extend(reals.map(|reference| model.real(reference).ok().map(f64::to_bits)));
    }
    bits
}

#[test]
fn kept_tables_change_no_bit() {
    let mut kept = 0;
    let detent = changed(CURVES, |m| {
        m["springs"]["detent"] = json!({ "joint": "guide", "points": [[0.2, -4], [0.28, 0], [0.33, 3], [0.36, 0]] });
    });
    for text in committed().into_iter().chain([detent]) {
        let made = Component::from_definition(FILE, &text).unwrap();
        let Some(bytes) = made.tables(&text) else { continue };
        assert_eq!(Some(&bytes), made.tables(&text).as_ref(), "the same bytes each time");
        let taken = Component::with_table_bytes(&MECHANISM, &text, bytes.clone()).unwrap();
        assert_eq!(taken.tables(&text), Some(bytes), "{}", made.name());
        let list = made.interface().list().iter().zip(0..);
        let flags = list.filter(|(v, _)| v.kind == Kind::Boolean && v.causality == Causality::Parameter);
        for flag in [None].into_iter().chain(flags.map(|(_, reference)| Some(reference))) {
            let [a, b] = [&made, &taken].map(|model| history(model.clone(), flag));
            assert!(a == b, "{} with {flag:?}", made.name());
        }
        kept += 1;
    }
    assert!(kept >= 6, "{kept} mechanisms with tables");
}

/// An instance with stored tables traces no curve and computes no table.
#[test]
fn an_instance_with_stored_tables_uses_them() {
    let made = Model::from_json(GEAR).unwrap();
    let mut all = made.sections();
    // The stored table is modified. If the instance computed the table again, the modification would disappear.
    let reactions = all.iter().position(|(name, _)| name == "reactions 2").unwrap();
    // The lowest byte of a coefficient of the first table, after the number of tables and a flag.
    all[reactions].1[8 * 100 + 1] ^= 1;
    let bytes = sections::encode(0, &all);
    let sections = Sections::of_bytes(bytes.into(), 0).unwrap();
    let taken = Model::with_tables(GEAR, Some(Arc::new(sections))).unwrap();
    assert_eq!(taken.sections(), all);
}

#[test]
fn tables_of_another_text_are_rejected() {
    let made = Component::from_definition(FILE, GEAR).unwrap();
    let edited = GEAR.replacen("0.", "0.0", 1);
    assert_ne!(edited, GEAR);
    let refusal = Component::with_table_bytes(&MECHANISM, &edited, made.tables(GEAR).unwrap()).unwrap_err();
    assert!(refusal.0.contains("tables.bin belongs to another definition"), "{refusal}");
}

/// For any content of a section with a valid check sum, the model is created and the calls return.
#[test]
fn no_section_can_harm() {
    let whole = Model::from_json(GEAR).unwrap().sections();
    let mut seed = 1_u64;
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    for case in 0..300 {
        let mut all = whole.clone();
        let (_, bytes) = &mut all[case % 4];
        match case % 3 {
            0 => bytes.truncate(random(bytes.len())),
            1 => (0..1 + random(4)).for_each(|_| {
                // Most lengths and flags are near the start.
                let at = random(bytes.len()).min(random(bytes.len()));
                bytes[at] ^= 1 << random(8);
            }),
            _ => {
                let at = random(bytes.len().min(400));
                bytes[at] = 255;
            }
        }
        let sections = Sections::of_bytes(sections::encode(0, &all).into(), 0).unwrap();
        if let Ok(mut model) = Model::with_tables(GEAR, Some(Arc::new(sections))) {
            let force = model.variables().find("joint1.force").unwrap();
            let _ = model.initialize().and_then(|()| model.step(1e-3)).and_then(|()| model.real(force));
        }
    }
}
