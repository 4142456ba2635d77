//! Hydraulic actuators, alone and in a drive.

use crate::support::{found, number};
use fmu_build::check;
use linkage_fmu::inspection::Severity;

#[test]
fn a_hydraulic_actuator_has_facts_and_warnings_of_its_own() {
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
