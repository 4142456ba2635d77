//! Events of a network: steps end where a lock releases and where valves open, at the times of closed forms.
use super::Host;

/// A pump of constant flow raises the pressure of a volume of oil of constant stiffness: p = E Q t / V.
const RISING: &str = r#"{
  "name": "Rising",
  "fluid": { "air_fraction": 0, "bulk_modulus": 1.4e9 },
  "reservoirs": { "tank": {} },
  "pumps": { "pump": { "from": "tank", "to": "line", "type": "fixed", "max_flow": 1e-5 } },
  "nodes": { "line": { "volume": 1e-3 }, "next": { "volume": 1e-3 } },
  "sequences": { "sequence": { "from": "next", "to": "tank", "pilot": "line", "pressure": 9e6 } },
  "pressure_locks": { "uplock": { "at": "line", "release_pressure": 5e6, "hysteresis": 0 },
                      "downlock": { "at": "line", "release_pressure": 7e6 } }
}"#;

#[test]
fn locks_release_in_event_mode_at_the_time_of_their_pressure() {
    for h in [1e-3, 0.05, 1.0] {
        let mut host = Host::of(RISING);
        host.set("solver.tolerance", 1e-12);
        host.set("pump.speed", 1.0);
        host.0.initialize().unwrap();
        let engaged = |host: &mut Host, name: &str| host.0.boolean(host.reference(name)).unwrap();
        let (mut time, mut events) = (0.0, Vec::new());
        while time < 1.0 - 1e-9 {
            let step = f64::min(h, 1.0 - time);
            let before = ["uplock.engaged", "downlock.engaged"].map(|name| engaged(&mut host, name));
            let event = host.0.step_to_event(step).unwrap();
            time += event.unwrap_or(step);
            assert_eq!(before, ["uplock.engaged", "downlock.engaged"].map(|name| engaged(&mut host, name)));
            if event.is_some() {
                events.push((time, host.0.take_event().unwrap().1));
                host.0.handle_event();
            }
        }
        let rate = 1.4e9 * 1e-5 / 1e-3;
        let expected = [
            (5e6 / rate, "lock uplock releases or engages"),
            (7e6 / rate, "lock downlock releases or engages"),
            (9e6 / rate, "sequence opens or closes"),
        ];
        assert_eq!(events.len(), expected.len(), "{h}: {events:?}");
        for ((time, words), (reference, text)) in events.iter().zip(expected) {
            assert!((time - reference).abs() < 1e-10 && words == text, "{h}: {time} {reference} {words}");
        }
        assert_eq!(["uplock.engaged", "downlock.engaged"].map(|name| engaged(&mut host, name)), [false; 2]);
    }
}
