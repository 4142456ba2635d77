//! Consumers that nothing feeds.
use super::{Model, SYSTEM};

const LONELY: (&str, &str) = (r#""down_line": {"#, r#""lonely": { "volume": 1e-4 }, "down_line": {"#);
const SUPPLY: (&str, &str) = (r#""supply": "supply", "return""#, r#""supply": "lonely", "return""#);

fn warned(text: &str) -> Vec<String> {
    Model::from_json(text).unwrap().warnings().iter().map(ToString::to_string).collect()
}

/// Changes of the network, and the starts of all warnings about it.
#[test]
fn what_has_no_supply_is_warned_of() {
    let element = |name: &str| {
        let start = SYSTEM.find(&format!("\"{name}\": {{ ")).unwrap();
        &SYSTEM[start..=start + SYSTEM[start..].find('}').unwrap()]
    };
    let (no_pump, no_bottle) = ((element("engine_pump"), ""), (element("accumulator"), ""));
    let feed = (r#""reservoir": { "#, r#""feed": { "pressure": 2e7 }, "reservoir": { "#);
    let line = (r#""resistances": {"#, r#""resistances": { "line": { "from": "feed", "to": "supply" },"#);
    let safety = (r#""reliefs": {"#, r#""reliefs": { "safety": { "from": "lonely", "to": "reservoir" },"#);
    let suction = (r#""checks": {"#, r#""checks": { "suction": { "from": "reservoir", "to": "lonely" },"#);
    let sequence = (r#""from": "down_line", "to": "gear.b""#, r#""from": "lonely", "to": "gear.b""#);
    let lock = (r#""at": "down_line""#, r#""at": "lonely""#);
    for (changes, expected) in [
        (&[][..], None),
        (&[no_pump], None),
        (&[no_bottle], None),
        (&[no_pump, no_bottle], Some("pumps: nothing raises the pressure")),
        // The host feeds a second reservoir.
        (&[no_pump, no_bottle, feed, line], None),
        (&[LONELY, SUPPLY], Some("valves.selector.supply: no pump")),
        // Oil from a relief valve or from the tank has no pressure.
        (&[LONELY, SUPPLY, safety, suction], Some("valves.selector.supply: no pump")),
        (&[LONELY, sequence], Some("sequences.gear_sequence.from: no pump")),
        (&[LONELY, lock], Some("pressure_locks.uplock.at: no pump")),
    ] {
        let text = changes.iter().fold(SYSTEM.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        let found = warned(&text);
        assert_eq!(found.len(), usize::from(expected.is_some()), "{changes:?} {found:?}");
        assert!(found.iter().all(|one| one.contains(expected.unwrap_or_default())), "{found:?}");
    }
}

/// The networks of the project have nothing to warn of.
#[test]
fn shipped_networks_have_no_warnings() {
    for text in [
        include_str!("../../../../modelDescription/LandingGearSystemHydraulics/resources/network.json"),
        include_str!("../../../../examples/crane/network.json"),
        include_str!("../../../../examples/lift_boom/network.json"),
    ] {
        assert_eq!(warned(text), Vec::<String>::new());
    }
}
