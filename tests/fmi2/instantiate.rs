//! `fmi2Instantiate`, the resource location and the logger.

use crate::host::{Arguments, Folder, Gear, RESOURCES, c, interface, mechanism};
use linkage_fmu::component::{Component as Model, TABLES};
use linkage_fmu::fmi2::host::{Description, logger};
use linkage_fmu::fmi2::types::{Status, Text};
use linkage_fmu::fmi2::*;
use std::ffi::{CStr, c_int};
use std::ptr::null;

#[test]
fn a_bad_argument_is_logged_and_answered_with_null() {
    assert_eq!(Arguments::new().refused(), None);
    assert_eq!(Arguments { fmu_type: 0, ..Arguments::new() }.refused(), None);
    let wrong = [
        (Arguments { name: null(), ..Arguments::new() }, "instanceName"),
        (Arguments { name: c"".as_ptr(), ..Arguments::new() }, "instanceName"),
        (Arguments { fmu_type: 2, ..Arguments::new() }, "0 (fmi2ModelExchange)"),
        (Arguments { fmu_type: 7, ..Arguments::new() }, "fmuType is 7"),
        (Arguments { guid: None, ..Arguments::new() }, "fmuGUID"),
        (Arguments { guid: Some(c("")), ..Arguments::new() }, "fmuGUID"),
        (Arguments { guid: Some(c("{another}")), ..Arguments::new() }, "{another}"),
        (Arguments::at("file:///no/such/folder"), "/no/such/folder/mechanism.json"),
        (Arguments::at("http://host/resources"), "http"),
    ];
    for (arguments, expected) in wrong {
        let message = arguments.refused().unwrap();
        assert!(message.starts_with("fmi2Instantiate: ") && message.contains(expected), "{message}");
    }
}

#[test]
fn null_callbacks_give_null_and_null_members_are_fine() {
    let (guid, location) = (c(interface().guid()), c(RESOURCES));
    // SAFETY: all pointers are NULL or live during the call.
    let component = unsafe { fmi2Instantiate(c"x".as_ptr(), 1, guid.as_ptr(), location.as_ptr(), null(), 0, 1) };
    assert!(component.is_null());
    let silent = Gear::with_logger(None, true);
    assert_eq!(silent.step(0.0, 1e-3), Status::Error);
    assert_eq!(silent.set("actuator.force", 1.0), Status::Ok);
}

/// Tables of the definition are used without a message. Tables of another definition and damaged tables are computed
/// again, with a warning.
#[test]
fn stored_tables_in_the_folder_of_a_definition() {
    let folder = Folder::new("tables beside");
    let resources = folder.0.join("resources");
    std::fs::create_dir_all(&resources).unwrap();
    let (definition, tables) = (resources.join("mechanism.json"), resources.join(TABLES));
    std::fs::write(&definition, mechanism()).unwrap();
    let bytes = Model::from_definition("mechanism.json", &mechanism()).unwrap().tables(&mechanism()).unwrap();
    let retraction = || {
        let host = Description::read(&folder.0).unwrap().instantiate(Some(logger()), true).unwrap();
        assert_eq!((host.set_up(None, 0.0, None), host.initialize()), (Status::Ok, Status::Ok));
        assert_eq!(host.step(0.0, 0.1), Status::Ok);
        let warnings = host.log.take().into_iter().filter(|message| message.category == "logStatusWarning");
        let said: Vec<String> = warnings.map(|message| message.text).collect();
        (host.get("crank.angle").map(f64::to_bits), host.get("joint3.force").map(f64::to_bits), said)
    };
    let without = retraction();
    assert_eq!(without.2, [""; 0]);
    std::fs::write(&tables, &bytes).unwrap();
    assert_eq!(retraction(), without);
    let damaged = [&bytes[..30], &bytes[..bytes.len() / 2], b"no tables"].map(<[u8]>::to_vec);
    for (bytes, warns) in damaged.into_iter().zip([true, false, true]) {
        std::fs::write(&tables, bytes).unwrap();
        let (angle, force, said) = retraction();
        assert_eq!((angle, force, said.len()), (without.0, without.1, usize::from(warns)), "{said:?}");
    }
    std::fs::write(&tables, &bytes).unwrap();
    std::fs::write(&definition, mechanism() + "\n").unwrap();
    let (angle, force, said) = retraction();
    assert_eq!((angle, force), (without.0, without.1));
    let fragments = [
        "tables.bin' belongs to another definition",
        "computes the content of the file itself",
        "package the model again",
    ];
    assert!(said.len() == 1 && fragments.iter().all(|fragment| said[0].contains(fragment)), "{said:?}");
}

#[test]
fn every_form_of_the_resource_location() {
    let folder = Folder::new("räder 100%");
    let path = folder.location();
    std::fs::write(folder.0.join("mechanism.json"), mechanism()).unwrap();
    let encoded = path.replace('%', "%25").replace(' ', "%20").replace('ä', "%C3%A4");
    for location in [
        path.to_owned(),
        format!("{path}/"),
        format!("file://{encoded}"),
        format!("file://{encoded}/"),
        format!("file:{encoded}"),
        format!("file://localhost{encoded}"),
        format!("file://{}", encoded.replace("%20", " ")),
    ] {
        assert_eq!(Arguments::at(&location).refused(), None, "{location}");
    }
}

#[test]
fn the_mechanism_is_read_at_every_instantiation() {
    let folder = Folder::new("edited");
    let file = folder.0.join("mechanism.json");
    std::fs::write(&file, mechanism()).unwrap();
    let arguments = Arguments::at(folder.location());
    assert_eq!(arguments.refused(), None);
    std::fs::write(&file, "{ broken").unwrap();
    assert!(arguments.refused().unwrap().contains("mechanism.json"));
}

#[test]
fn without_a_location_the_place_of_the_library_counts() {
    for location in [None, Some(c(""))] {
        let message = Arguments { location, ..Arguments::new() }.refused().unwrap();
        assert!(message.contains("resources/mechanism.json"), "{message}");
    }
}

#[test]
fn categories_filter_the_messages() {
    let gear = Gear::with_logger(Some(logger()), false);
    let debug = |on: c_int, names: &[&CStr]| {
        let names: Vec<Text> = names.iter().map(|name| name.as_ptr()).collect();
        // SAFETY: `names` contains the stated number of strings.
        unsafe { fmi2SetDebugLogging(gear.c, on, names.len(), names.as_ptr()) }
    };
    let refused = || {
        assert_eq!(gear.step(0.0, 1e-3), Status::Error);
        gear.log.take().len()
    };
    assert_eq!(refused(), 1, "failures are reported even without loggingOn");
    assert_eq!(debug(1, &[c"logEvents"]), Status::Ok);
    assert_eq!(refused(), 0);
    assert_eq!(debug(1, &[c"logEvents", c"logStatusError"]), Status::Ok);
    assert_eq!(refused(), 1);
    assert_eq!(debug(0, &[c"logAll"]), Status::Ok);
    assert_eq!(refused(), 0);
    assert_eq!(debug(0, &[]), Status::Ok);
    assert_eq!(refused(), 1, "as instantiated without loggingOn");
    assert_eq!(debug(1, &[]), Status::Ok);
    assert_eq!(debug(1, &[c"logNonsense"]), Status::Error);
    assert!(gear.refusal().contains("logNonsense"));
    // SAFETY: the library checks for a NULL array and a NULL name, which this test passes.
    unsafe {
        assert_eq!(fmi2SetDebugLogging(gear.c, 1, 1, null()), Status::Error);
        assert_eq!(fmi2SetDebugLogging(gear.c, 1, 1, [null()].as_ptr()), Status::Error);
    }
    assert_eq!(gear.log.take().len(), 2);
}

#[test]
fn messages_reach_the_environment_of_their_instance() {
    let (one, other) = (Gear::new(), Gear::new());
    one.log.take();
    assert_eq!(one.step(0.0, 1e-3), Status::Error);
    assert!(other.log.take().is_empty());
    assert!(one.refusal().starts_with("fmi2DoStep: this call is not allowed in the phase 'instantiated'"));
}

#[test]
fn an_experiment_that_was_not_set_up_is_worth_a_warning() {
    for (logging_on, expected) in [(false, 0), (true, 1)] {
        let gear = Gear::with_logger(Some(logger()), logging_on);
        assert_eq!(gear.enter(), Status::Ok);
        let messages = gear.log.take();
        assert_eq!(messages.iter().filter(|message| message.category == "logStatusWarning").count(), expected);
    }
}

/// A carriage that leaves the first stretch of its curve: the log reports this once.
#[test]
fn growth_gives_one_warning() {
    let folder = Folder::new("growth");
    let text = r#"{ "name": "Carriage", "bodies": { "ground": {}, "carriage": { "length": 0.02, "mass": 3 } },
      "joints": { "rail": { "type": "prismatic", "first": "ground.origin", "second": "carriage.origin" } },
      "start": { "joint": "rail", "position": 0, "speed": 100 }, "guess": { "rail": 0 } }"#;
    let description = folder.described(text);
    for (logging_on, expected) in [(true, 1), (false, 0)] {
        let host = description.instantiate(Some(logger()), logging_on).unwrap();
        assert_eq!(host.initialize(), Status::Ok);
        host.log.take();
        for k in 0..100 {
            assert_eq!(host.step(f64::from(k), 1.0), Status::Ok);
        }
        let messages = host.log.take();
        let messages = messages
            .iter()
            .filter(|m| m.category == "logEvents" && m.text.contains("computes the next part during the run"));
        assert_eq!(messages.count(), expected);
    }
}
