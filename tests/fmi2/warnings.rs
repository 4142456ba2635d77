//! Warnings about a definition, in the log of the FMU.

use crate::host::Folder;
use linkage_fmu::fmi2::host::{Host, logger};
use linkage_fmu::fmi2::types::Status;

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");

fn instance(name: &str, definition: &str, logging_on: bool) -> Host {
    let folder = Folder::new(name);
    folder.described(definition).instantiate(Some(logger()), logging_on).unwrap()
}

fn warnings(host: &Host) -> Vec<String> {
    let all = host.log.take().into_iter().filter(|message| message.category == "logStatusWarning");
    all.map(|message| message.text).collect()
}

#[test]
fn warnings_of_a_definition_are_logged_at_instantiation() {
    assert_eq!(warnings(&instance("no-warnings", GEAR, true)), [""; 0]);
    let odd = GEAR.replacen("\"up_angle\": 1.13", "\"up_angle\": 65", 1).replacen("\"enabled\": false, ", "", 1);
    assert_ne!(odd, GEAR);
    let said = warnings(&instance("warnings", &odd, true));
    assert!(said.len() == 2, "{said:?}");
    assert!(said[0].starts_with("friction: the key `enabled` is missing"), "{said:?}");
    assert!(said[1].starts_with("gravity.up_angle: 65 rad") && said[1].contains("if you mean 65 degrees"), "{said:?}");
    assert_eq!(warnings(&instance("silent", &odd, false)), [""; 0]);
}

#[test]
fn friction_that_locks_the_start_is_reported_at_initialisation() {
    let host = instance("locked", GEAR, true);
    host.set_boolean("friction.enabled", true);
    for (name, value) in [("friction.kinetic_coefficient", 0.19), ("crank.start_speed", -10.0)] {
        assert_eq!(host.set(name, value), Status::Ok);
    }
    for joint in 1..=4 {
        assert_eq!(host.set(&format!("joint{joint}.pin_radius"), 1.5), Status::Ok);
    }
    assert_eq!(host.set_up(None, 0.0, None), Status::Ok);
    assert_eq!(warnings(&host), [""; 0]);
    assert_eq!(host.initialize(), Status::Ok);
    let said = warnings(&host);
    let fragments = ["at the start, friction locks the mechanism near crank = 0.8", "mainly in joint", "add a stop"];
    assert!(said.len() == 1 && fragments.iter().all(|fragment| said[0].contains(fragment)), "{said:?}");
}
