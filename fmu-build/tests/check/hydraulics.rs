//! Hydraulic actuators, alone and in a drive.

use crate::support::{found, number};
use fmu_build::check;
use linkage_fmu::inspection::Severity;

#[test]
fn a_hydraulic_actuator_has_separate_facts_and_warnings() {
    let text = include_str!("../../../modelDescription/HydraulicActuator/resources/hydraulics.json");
    let check = |text: &str| check::check("h.json".into(), "hydraulics.json", text.into()).unwrap();
    let all = check(text);
    assert_eq!(all.findings.len(), 0, "{}", check::findings(&all));
    let area = std::f64::consts::PI * 0.045_f64.powi(2) / 4.0;
    assert!((number(&all, "Cylinder", "area", "piston") - area).abs() < 1e-15);
    for (from, to, key) in [
        ("\"pressure\": 20.7e6", "\"pressure\": 207", "circuit.supply.pressure"),
        ("\"bore\": 0.045", "\"bore\": 45", "circuit.cylinder.bore"),
        ("\"rated_flow\": 1e-4", "\"rated_flow\": 6", "circuit.valve.rated_flow"),
        ("\"pressure\": 28e6", "\"pressure\": 20e6", "circuit.relief.pressure"),
    ] {
        assert!(text.contains(from), "{from}");
        let all = check(&text.replacen(from, to, 1));
        let own = all.findings.iter().find(|located| located.finding.path == key);
        assert!(own.is_some_and(|own| !own.span.is_empty()), "{key}: {}", check::findings(&all));
    }
    let all = check(&text.replacen("\"rod\": 0.025", "\"rod\": 0.05", 1));
    assert_eq!(all.findings[0].finding.path, "circuit.cylinder.rod", "{}", check::findings(&all));
}

#[test]
fn a_circuit_in_a_drive_is_checked_at_its_place() {
    let text = include_str!("../../../modelDescription/LandingGearRetractionHydraulic/resources/mechanism.json");
    for (from, to, key, severity) in [
        ("\"rod\": 0.025", "\"rod\": 0.05", "rod", Severity::Error),
        ("\"bore\": 0.045", "\"bore\": 4.5", "bore", Severity::Warning),
    ] {
        assert!(text.contains(from), "{from}");
        let found = found(&text.replacen(from, to, 1), severity);
        let path = format!("actuators.actuator.hydraulics.cylinder.{key}");
        let shown = to.split(": ").last().unwrap();
        assert!(found.iter().any(|(own, _, text)| *own == path && text == shown), "{found:#?}");
    }
}

#[test]
fn a_fault_of_a_network_is_reported_at_its_key() {
    let network = include_str!("../../../modelDescription/HydraulicSystem/resources/network.json");
    let arm = include_str!("../../../modelDescription/LiftArm/resources/mechanism.json");
    for (file, text, from, to, path) in [
        ("network.json", network, "\"bore\": 0.045", "\"bore\": -0.045", "cylinders.gear.bore"),
        ("network.json", network, "\"max_flow\": 1.5e-4", "\"max_flow\": -1", "pumps.engine_pump.max_flow"),
        ("mechanism.json", arm, "\"bore\": 0.05", "\"bore\": -0.05", "hydraulics.cylinders.lift.bore"),
        ("mechanism.json", arm, "\"rod\": 0.03", "\"rod\": 0.3", "hydraulics.cylinders.lift.rod"),
    ] {
        assert!(text.contains(from), "{from}");
        let text = text.replacen(from, to, 1);
        let all = check::check("x.json".into(), file, text.clone()).unwrap();
        let errors = all.findings.iter().filter(|located| located.finding.severity == Severity::Error);
        let places: Vec<_> = errors.map(|one| (one.finding.path.as_str(), &text[one.span.clone()])).collect();
        assert_eq!(places, [(path, to.split(": ").last().unwrap())], "{}", check::findings(&all));
    }
    // A fault of JSON is one error, in a file with any name.
    let text = network.replacen("\"HydraulicSystem\",", "\"HydraulicSystem\"", 1);
    let kind = linkage_fmu::component::Component::kind_of(&text).unwrap();
    let all = check::check("my.json".into(), kind, text).unwrap();
    assert_eq!(all.findings.len(), 1, "{}", check::findings(&all));
}
