//! Events within steps, as messages in the log of the FMU.

use crate::host::Folder;
use linkage_fmu::fmi2::fmi2SetDebugLogging;
use linkage_fmu::fmi2::host::{Host, logger};
use linkage_fmu::fmi2::types::Status;
use std::ffi::CStr;

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");
const HIT: f64 = 0.132_059_852_744_259_7;

/// An instance of the gear with pieces of its file replaced, at its start at this time.
fn gear(name: &str, changes: &[(&str, &str)], logging_on: bool, start: f64) -> Host {
    let folder = Folder::new(name);
    let definition = changes.iter().fold(GEAR.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    let host = folder.described(&definition).instantiate(Some(logger()), logging_on).unwrap();
    assert_eq!(host.set_up(None, start, None), Status::Ok);
    assert_eq!(host.initialize(), Status::Ok);
    host.log.take();
    host
}

/// Category and text of the messages since the last call.
fn messages_of(host: &Host) -> Vec<(String, String)> {
    host.log.take().into_iter().map(|message| (message.category, message.text)).collect()
}

fn texts(host: &Host) -> Vec<String> {
    messages_of(host).into_iter().map(|(_, text)| text).collect()
}

/// Request messages of this category only.
fn ask_for(host: &Host, category: &CStr) {
    // SAFETY: the component is valid, and the category is a C string.
    assert_eq!(unsafe { fmi2SetDebugLogging(host.c, 1, 1, [category.as_ptr()].as_ptr()) }, Status::Ok);
}

#[test]
fn an_impact_is_logged_with_time_speed_and_impulse() {
    let host = gear("impact", &[], true, 5.0);
    assert_eq!(host.step(5.0, 0.1), Status::Ok);
    assert_eq!(texts(&host), [""; 0]);
    assert_eq!(host.step(5.1, 0.1), Status::Ok);
    let said = messages_of(&host);
    let (impulse, time) = (host.get("upstop.impact_impulse").unwrap(), host.get("upstop.impact_time").unwrap());
    assert!((time - 5.0 - HIT).abs() < 1e-9, "{time}");
    assert!(said.iter().all(|(category, _)| category == "logEvents"), "{said:?}");
    let first = &said[0].1;
    assert!(first.starts_with("at t = 5.13205985") && first.contains("the stop upstop at -30.2577"), "{first}");
    assert!(first.contains(&format!("impulse {impulse:.4}")[..12]) && first.ends_with("kg.m2/s"), "{first} {impulse}");
    assert!(said[1].1.ends_with("the mechanism stops at the stop upstop"), "{said:?}");
    assert_eq!(said.len(), 2, "{said:?}");
}

#[test]
fn bounces_are_logged_as_one_series() {
    let elastic = [("\"flag\": \"retracted\"", "\"restitution\": 0.9, \"flag\": \"retracted\"")];
    let host = gear("series", &elastic, true, 0.0);
    assert_eq!(host.step(0.0, 3.0), Status::Ok);
    let said = texts(&host);
    let count = host.get("upstop.impact_count").unwrap();
    assert!(count > 50.0, "{count}");
    assert!(said.len() == 6 && said[..5].iter().all(|line| line.contains("impact on the stop upstop")), "{said:?}");
    assert!(
        said[4].ends_with("; slower impacts that follow are counted and reported at the end of the series"),
        "{said:?}"
    );
    assert!(said[5].ends_with(&format!("stops at the stop upstop after {count} impacts")), "{said:?}");
    // The same series of bounces over many steps.
    let host = gear("series cut", &elastic, true, 0.0);
    (0..300).for_each(|k| assert_eq!(host.step(0.01 * f64::from(k), 0.01), Status::Ok));
    assert_eq!(texts(&host).len(), 6);
}

/// Impacts with a restitution of 1 are no series: each impact is reported.
#[test]
fn each_impact_without_losses_is_logged() {
    let elastic = [("\"flag\": \"retracted\"", "\"restitution\": 1, \"flag\": \"retracted\"")];
    let host = gear("lossless", &elastic, true, 0.0);
    assert_eq!(host.step(0.0, 2.0), Status::Ok);
    let count = host.get("upstop.impact_count").unwrap();
    let logged = texts(&host).iter().filter(|line| line.contains("impact on the stop upstop")).count();
    assert!(count > 5.0 && logged as f64 == count, "{logged} of {count}");
}

#[test]
fn locks_are_logged() {
    let host = gear("locks", &[], true, 0.0);
    host.set_boolean("uplock.engage", true);
    assert_eq!(host.step(0.0, 0.2), Status::Ok);
    let said = texts(&host);
    assert!(said.len() == 2 && said[1].ends_with("a lock holds the mechanism at the stop upstop"), "{said:?}");
    host.set_boolean("uplock.engage", false);
    assert_eq!(host.set("actuator.force", -3e4), Status::Ok);
    assert_eq!(host.step(0.2, 0.01), Status::Ok);
    let said = texts(&host);
    assert!(said[0].starts_with("at t = 0.2 s the lock at the stop upstop releases the mechanism"), "{said:?}");
    assert_eq!(said.len(), 1, "{said:?}");
}

#[test]
fn regimes_of_friction_are_logged_for_debugging() {
    let host = gear("regimes", &[("\"enabled\": false, ", "\"enabled\": true, ")], true, 0.0);
    ask_for(&host, c"logDebug");
    assert_eq!(host.step(0.0, 0.1), Status::Ok);
    let said = messages_of(&host);
    assert!(
        said.iter().any(|(category, text)| category == "logDebug" && text.contains("friction in the joint joint")),
        "{said:?}"
    );
    assert!(said.iter().any(|(_, text)| text.ends_with("becomes viscous")), "{said:?}");
    // A host that does not request these messages gets none.
    let host = gear("no regimes", &[("\"enabled\": false, ", "\"enabled\": true, ")], true, 0.0);
    assert_eq!(host.step(0.0, 0.1), Status::Ok);
    assert_eq!(messages_of(&host), []);
    assert_eq!(host.step(0.1, 0.1), Status::Ok);
    assert!(texts(&host)[0].contains("impact on the stop upstop"));
}

#[test]
fn neither_disabled_logging_nor_a_rejected_step_logs_events() {
    let host = gear("silent", &[], false, 0.0);
    assert_eq!(host.step(0.0, 0.2), Status::Ok);
    assert_eq!(texts(&host), [""; 0]);
    let host = gear("refused", &[], true, 0.0);
    assert_ne!(host.step(0.0, -1.0), Status::Ok);
    assert!(texts(&host).iter().all(|line| !line.contains("impact")));
    assert_eq!(host.get("upstop.impact_count"), Ok(0.0));
}
