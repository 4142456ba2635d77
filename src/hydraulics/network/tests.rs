//! Networks against reference values, balances, differences, and other ways through the same steps.
#![allow(clippy::unwrap_used)]
mod derivatives;
mod ends;
mod events;
mod limits;
mod supply;

use super::Model;
use crate::tests::H0;

/// The circuit of the hydraulic actuator as a network.
const ACTUATOR: &str = r#"{
  "name": "Actuator",
  "reservoirs": { "supply": { "pressure": 20.7e6 }, "tank": { "pressure": 0.35e6 } },
  "cylinders": { "ram": {
    "length": 0.5, "speed": 0.1,
    "chamber_a": { "start_pressure": 6e6, "restrictor_flow": 5e-5, "cushion_length": 0.03, "cushion_flow": 1.2e-5 },
    "chamber_b": { "start_pressure": 8e6, "cushion_length": 0.03, "cushion_flow": 1.2e-5 },
    "leakage": {}, "seal": {} } },
  "valves": { "valve": { "supply": "supply", "return": "tank", "a": "ram.a", "b": "ram.b", "frequency": 60 } },
  "reliefs": { "relief_a": { "from": "ram.a", "to": "tank" }, "relief_b": { "from": "ram.b", "to": "tank" } },
  "checks": { "suction_a": { "from": "tank", "to": "ram.a", "conductance": 1e-10, "width": 1e5 },
              "suction_b": { "from": "tank", "to": "ram.b", "conductance": 1e-10, "width": 1e5 } },
  "coupling": { "mode": "follow" }
}"#;

struct Host(Model);

impl Host {
    fn of(text: &str) -> Self {
        Self(Model::from_json(text).unwrap())
    }

    fn reference(&self, name: &str) -> u32 {
        self.0.variables().find(name).unwrap_or_else(|| panic!("{name}"))
    }

    fn set(&mut self, name: &str, value: f64) {
        self.0.set_real(self.reference(name), value).unwrap();
    }

    fn get(&mut self, name: &str) -> f64 {
        self.0.real(self.reference(name)).unwrap()
    }

    fn rate(&mut self, name: &str, order: i32, value: f64) {
        self.0.set_input_derivative(self.reference(name), order, value).unwrap();
    }

    /// All outputs that are numbers.
    fn outputs(&mut self) -> Vec<f64> {
        let list = self.0.variables().list();
        let is = |v: &foundation::variables::Variable| v.is_output() && v.kind == foundation::variables::Kind::Real;
        let outputs: Vec<u32> = (0..list.len()).filter(|i| is(&list[*i])).map(|i| i as u32).collect();
        outputs.into_iter().map(|output| self.0.real(output).unwrap()).collect()
    }
}

#[test]
fn the_circuit_of_the_actuator_meets_its_reference() {
    for step in [1e-3, 0.01] {
        let mut host = Host::of(ACTUATOR);
        host.set("solver.tolerance", 1e-12);
        host.set("valve.command", 0.4);
        host.0.initialize().unwrap();
        let mut time = 0.0;
        for [at, p_a, p_b, spool, force] in H0 {
            while time < at - 1e-9 {
                host.rate("ram.speed", 1, -0.15);
                host.0.step(step).unwrap();
                time += step;
            }
            for (name, expected, size) in [
                ("ram.chamber_a.pressure", p_a, p_a + 101_325.0),
                ("ram.chamber_b.pressure", p_b, p_b + 101_325.0),
                ("valve.position", spool, 0.4),
            ] {
                let value = host.get(name);
                assert!((value - expected).abs() < 1e-10 * size, "{step} {time} {name} {value} {expected}");
            }
            let value = host.get("ram.force");
            assert!((value - force).abs() < 1e-10 * 4.5e4, "{step} {time} force {value} {force}");
        }
        assert!(host.get("volume.balance").abs() < 1e-12 * 1e-3);
        assert!(host.get("energy.balance").abs() < 1e-10 * host.get("energy.throttling"));
    }
}

const SYSTEM: &str = include_str!("../../../modelDescription/HydraulicSystem/resources/network.json");

impl Host {
    fn start(text: &str) -> Self {
        let mut host = Self::of(text);
        host.0.initialize().unwrap();
        host
    }

    fn run(&mut self, end: f64, step: f64) {
        (0..(end / step).round() as usize).for_each(|_| self.0.step(step).unwrap());
    }
}

/// The door opens before the gear moves; the lock releases at once; both stand at their limits at the end.
#[test]
fn the_system_opens_its_door_first() {
    let mut host = Host::start(SYSTEM);
    let lock = host.reference("uplock.engaged");
    assert!(host.0.boolean(lock).unwrap());
    let (mut open, mut moved, mut down, mut released) = (f64::NAN, f64::NAN, f64::NAN, f64::NAN);
    for step in 0..12_000 {
        host.0.step(1e-3).unwrap();
        let time = f64::from(step + 1) * 1e-3;
        let (door, gear) = (host.get("door.length"), host.get("gear.length"));
        let first = |at: &mut f64, is: bool| *at = if at.is_nan() && is { time } else { *at };
        first(&mut open, door > 0.495 - 1e-6);
        first(&mut moved, gear < 0.735 - 1e-4);
        first(&mut down, gear < 0.4185 + 1e-6);
        first(&mut released, !host.0.boolean(lock).unwrap());
    }
    assert!(released < 0.1 && open > released && moved > open && down > moved, "{released} {open} {moved} {down}");
    assert!(host.get("volume.balance").abs() < 1e-12 * 3e-4, "{}", host.get("volume.balance"));
    assert!(host.get("energy.balance").abs() < 1e-7 * host.get("energy.throttling"));
    assert_eq!(host.0.warnings(), []);
}

/// Steps that are split, restored, or continued from bytes give the same bits.
#[test]
fn states_go_on_to_the_bit() {
    for mode in ["preview", "follow"] {
        let mut host = Host::of(SYSTEM);
        host.0.set_text(host.reference("coupling.mode"), mode).unwrap();
        host.0.initialize().unwrap();
        host.run(0.3, 1e-3);
        let snapshot = host.0.snapshot();
        let mut bytes = Vec::new();
        snapshot.write(&mut bytes).unwrap();
        host.run(0.2, 1e-3);
        let expected = host.outputs();
        host.0.restore(&snapshot).unwrap();
        // Reading outputs on the way changes nothing.
        for _ in 0..200 {
            host.outputs();
            host.0.step(1e-3).unwrap();
        }
        assert_eq!(host.outputs(), expected, "{mode}");
        let mut other = Host::of(SYSTEM);
        let read = other.0.read_snapshot(&bytes).unwrap();
        other.0.restore(&read).unwrap();
        other.run(0.2, 1e-3);
        assert_eq!(other.outputs(), expected, "{mode}");
        for end in (0..bytes.len()).step_by(7) {
            assert!(other.0.read_snapshot(&bytes[..end]).is_err());
        }
        host.0.reset();
        host.0.set_text(host.reference("coupling.mode"), mode).unwrap();
        host.0.initialize().unwrap();
        host.run(0.5, 1e-3);
        assert_eq!(host.outputs(), expected, "{mode}");
    }
}

/// At rest implicit steps share a Jacobian. A state that is saved, written and read there continues with it.
#[test]
fn steps_at_rest_share_a_jacobian_and_a_saved_state_keeps_it() {
    let mut host = Host::start(SYSTEM);
    host.run(8.0, 1e-3);
    let (snapshot, before, mut bytes) = (host.0.snapshot(), host.0.statistics(), Vec::new());
    snapshot.write(&mut bytes).unwrap();
    host.run(0.2, 1e-3);
    let (after, expected) = (host.0.statistics(), host.outputs());
    assert!(after.by_method[4] >= before.by_method[4] + 200, "{:?}", after.by_method);
    assert!(after.jacobians <= before.jacobians + 5, "{} after {}", after.jacobians, before.jacobians);
    let read = host.0.read_snapshot(&bytes).unwrap();
    for start in [snapshot, read] {
        host.0.restore(&start).unwrap();
        host.run(0.2, 1e-3);
        assert_eq!(host.outputs(), expected);
    }
}

/// The same network with room for small and for large ones.
#[test]
fn the_capacity_does_not_matter() {
    let mut host = Host::start(SYSTEM);
    let mut large = Host::start(SYSTEM);
    large.0.state.as_mut().unwrap().make_large();
    large.0.cache.make_large();
    for host in [&mut host, &mut large] {
        host.set("solver.tolerance", 1e-9);
        host.run(0.5, 5e-3);
    }
    for name in
        ["supply", "down_line", "up_line", "gear.chamber_a", "gear.chamber_b", "door.chamber_a", "door.chamber_b"]
    {
        let [one, two] = [&mut host, &mut large].map(|host| host.get(&format!("{name}.pressure")));
        // Each errs by the tolerance, and by some of the steps before.
        assert!((one - two).abs() <= 1e-8 * (one + 101_325.0), "{name} {one} {two}");
    }
    assert!((host.get("door.length") - large.get("door.length")).abs() < 1e-9);
}

/// Largest error of a network over the values of an integration by SciPy, in steps of a size, and its balances.
fn error(host: &mut Host, expected: &str, step: f64) -> f64 {
    let (mut steps, mut largest) = (0, 0.0_f64);
    for line in expected.lines() {
        let [time, name, value] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
        let [time, value] = [time, value].map(|number| number.parse::<f64>().unwrap());
        while f64::from(steps) * step < time - 1e-9 {
            host.0.step(step).unwrap();
            steps += 1;
        }
        let (owner, part) = name.rsplit_once('.').unwrap_or((name, ""));
        let (variable, size) = match part {
            "a" | "b" => (format!("{owner}.chamber_{part}.pressure"), value + 101_325.0),
            "" => (format!("{name}.pressure"), value + 101_325.0),
            "length" => (name.to_owned(), value),
            "speed" => (name.to_owned(), 0.1),
            "position" => (name.to_owned(), 0.6),
            _ => continue,
        };
        largest = largest.max((host.get(&variable) - value).abs() / size);
    }
    let moved = host.get("volume.from_reservoirs").abs().max(1e-4);
    assert!(host.get("volume.balance").abs() < 1e-12 * moved, "{}", host.get("volume.balance"));
    assert!(host.get("energy.balance").abs() < 1e-10 * host.get("energy.throttling"));
    largest
}

/// A network with every kind of element and two cylinders that move a mass each, against an integration by SciPy of the
/// equations of the documentation (tests/networks/integrate.py, DOP853 at 1e-12).
#[test]
fn two_cylinders_meet_an_independent_integration() {
    let text = include_str!("../../../tests/networks/two_cylinders.json");
    let expected = include_str!("../../../tests/networks/two_cylinders.txt");
    for step in [2e-3, 1e-2] {
        let largest = error(&mut Host::start(text), expected, step);
        assert!(largest < 1e-9, "{step} {largest:e}");
    }
}

/// Valves without dynamics, with unequal edges, underlap and a switched law, and a chamber of constant volume
/// (tests/networks/integrate.py, Radau at 1e-12).
#[test]
fn options_of_valves_meet_an_independent_integration() {
    let text = include_str!("../../../tests/networks/valve_options.json");
    let expected = include_str!("../../../tests/networks/valve_options.txt");
    for step in [2e-3, 1e-2] {
        let largest = error(&mut Host::start(text), expected, step);
        assert!(largest < 1e-9, "{step} {largest:e}");
    }
    // A spool without dynamics is no component of the state.
    let host = Host::start(text);
    assert_eq!(host.0.parameters.laws.layout.spools, 0);
}

/// The cylinder of a published crane with the mass and the load of its boom, its valve open
/// (tests/networks/integrate.py with valve=1, Radau at 1e-12).
#[test]
fn the_lift_cylinder_meets_an_independent_integration() {
    let text = include_str!("../../../examples/lift_boom/network.json");
    let expected = include_str!("../../../tests/networks/lift_boom.txt");
    for step in [1e-3, 1e-2] {
        let mut host = Host::start(text);
        host.set("solver.tolerance", 1e-12);
        host.set("valve.command", 1.0);
        host.0.initialize().unwrap();
        let largest = error(&mut host, expected, step);
        assert!(largest < 1e-9, "{step} {largest:e}");
    }
}

/// More ports and inputs than components of the state.
#[test]
fn many_reservoirs_need_no_state() {
    let reservoirs: Vec<String> = (0..60).map(|k| format!("\"r{k}\": {{}}")).collect();
    let text = format!(
        r#"{{ "name": "Many", "nodes": {{ "n": {{ "volume": 1e-3 }} }}, "reservoirs": {{ {} }},
            "resistances": {{ "in": {{ "from": "r59", "to": "n" }} }} }}"#,
        reservoirs.join(", ")
    );
    let mut host = Host::start(&text);
    host.set("r59.pressure", 1e6);
    host.0.step(1.0).unwrap();
    assert!((host.get("n.pressure") - 1e6).abs() < 1.0, "{}", host.get("n.pressure"));
}

/// Faults of a definition by their texts.
#[test]
fn faults_of_a_network_are_named_with_a_remedy() {
    let refused = |from: &str, to: &str| {
        assert!(SYSTEM.contains(from), "{from}");
        Model::from_json(&SYSTEM.replace(from, to)).unwrap_err().to_string()
    };
    for (from, to, words) in [
        ("\"door_line\":", "\"selector\":", &["valves.selector", "resistances.selector already has this name"][..]),
        (
            "\"to\": \"door.a\", \"rated",
            "\"to\": \"door.c\", \"rated",
            &["resistances.door_line.to", "door.c", "no element has this name"],
        ),
        ("\"b\": \"up_line\"", "\"b\": \"down_line\"", &["valves.selector.b", "is also connected to port a"]),
        (
            "\"volume\": 4e-4,",
            "\"volume\": 0,",
            &["nodes.supply.volume", "cannot be integrated", "volume of the lines"],
        ),
        ("\"to\": \"supply\", \"max", "\"to\": \"reservoir\", \"max", &["pumps.engine_pump.to", "a node"]),
        ("\"max_pressure\": 20.7e6", "\"max_pressure\": 19e6", &["pumps.engine_pump.max_pressure", "full_pressure"]),
        ("\"length\": 0.735", "\"length\": 0.9", &["cylinders.gear.length", "closed_length"]),
        ("\"rod\": 0.025", "\"rod\": 0.05", &["cylinders.gear.rod", "chamber B"]),
        ("\"hysteresis\": 2e6", "\"hysteresis\": 7e6", &["pressure_locks.uplock.hysteresis", "release_pressure"]),
        ("\"command\": 1", "\"command\": 2", &["valves.selector.command", "-1 to 1"]),
        (
            "\"bypasses\": {",
            r#""position_valves": { "trip": {
                "from": "up_line", "to": "door.a", "cylinder": "gate", "length": 0.5 } }, "bypasses": {"#,
            &["position_valves.trip.cylinder", "gate", "gear"],
        ),
        (
            "\"bypasses\": {",
            r#""position_valves": { "trip": {
                "from": "up_line", "to": "door.a", "cylinder": "gear", "length": 0.8 } }, "bypasses": {"#,
            &["position_valves.trip.length", "within the travel"],
        ),
        (
            "\"reservoir\": { \"pressure\": 0.35e6 }",
            "\"reservoir\": { \"pressure\": -2e5 }",
            &["reservoirs.reservoir.pressure"],
        ),
    ] {
        let text = refused(from, to);
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    }
    let two = r#""valves": {
        "one": { "supply": "supply", "return": "reservoir", "a": "gear.a", "b": "gear.b" },
        "two": { "supply": "supply", "return": "reservoir", "a": "door.a", "b": "gear.b" },"#;
    let text = refused("\"valves\": {", two);
    assert!(text.contains("valves.two.b") && text.contains("valves.one.b"), "{text}");
}

/// Warnings about networks that run, but are probably not those that are meant.
#[test]
fn implausible_networks_are_warned_of() {
    let warned = |from: &str, to: &str| {
        assert!(SYSTEM.contains(from), "{from}");
        let model = Model::from_json(&SYSTEM.replace(from, to)).unwrap();
        model.warnings().iter().map(|one| one.to_string()).collect::<Vec<_>>().join("\n")
    };
    for (from, to, words) in [
        ("\"max_flow\": 1.5e-4,", "\"max_flow\": 1e-3, \"type\": \"fixed\",", ["pumps.engine_pump.max_flow", "relief"]),
        ("\"precharge_pressure\": 10e6", "\"precharge_pressure\": 30e6", ["precharge_pressure", "never takes oil"]),
        ("\"release_pressure\": 6e6", "\"release_pressure\": 30e6", ["uplock.release_pressure", "never releases"]),
        (
            "\"precharge_pressure\": 10e6",
            "\"precharge_pressure\": 5e4",
            ["precharge_pressure: the precharge pressure is 50000 Pa", "reservoir"],
        ),
        ("\"volume\": 5e-4", "\"volume\": 1e-7", ["accumulators.accumulator.volume", "1 l = 1e-3 m3"]),
        ("\"start_pressure\": 20.5e6", "\"start_pressure\": 205", ["nodes.supply.start_pressure", "1 bar = 1e5 Pa"]),
        (
            "\"overlap\": 0.05",
            "\"overlap\": 1.5",
            ["valves.selector.overlap: the value is 1.5, but usual values", "from -1 to 1"],
        ),
        ("\"air_fraction\": 0.005", "\"bulk_modulus\": 1", ["fluid.bulk_modulus", "usual values"]),
        ("\"pressure\": 24e6", "\"pressure\": 18e6", ["pumps.engine_pump.full_pressure", "supply_relief"]),
    ] {
        let text = warned(from, to);
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    }
}

/// A refused call leaves the state as it was; calls out of order are refused by name.
#[test]
fn refused_calls_change_nothing() {
    let mut host = Host::of(SYSTEM);
    assert!(host.0.step(1e-3).is_err());
    host.0.initialize().unwrap();
    host.run(0.01, 1e-3);
    let before = host.outputs();
    for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(host.0.step(h).is_err());
    }
    for (name, value) in [
        ("gear_dump.open", 1.1),
        ("engine_pump.speed", -1.0),
        ("gear.reduced_mass", -1.0),
        ("reservoir.pressure", -2e5),
        ("gear.length", f64::NAN),
        ("supply.pressure", 1.0),
    ] {
        assert!(host.0.set_real(host.reference(name), value).is_err(), "{name}");
    }
    assert!(host.0.set_boolean(host.reference("uplock.engaged"), true).is_err());
    assert_eq!(host.outputs(), before);
    host.set("gear.length", 0.2);
    let error = host.0.step(1e-3).unwrap_err().to_string();
    assert!(error.contains("gear.length") && error.contains("closed_length"), "{error}");
    host.set("gear.length", 0.735);
    assert_eq!(host.outputs(), before);
    host.set("selector.command", 3.0);
    host.run(0.01, 1e-3);
    assert!(host.0.take_warning().unwrap().contains("selector.command is 3"));
}

/// Cost of a step of 1 ms of the system with its two cylinders, printed for the report.
#[test]
#[ignore = "measures time"]
fn cost_of_a_step() {
    for (what, open, steps) in [("moving", 0.4, 400), ("gear moving", 2.0, 400), ("from start to end", 0.0, 9000)] {
        let mut host = Host::start(SYSTEM);
        host.run(open, 1e-3);
        let forces = ["gear.preview.force_mean", "door.preview.force_mean"].map(|name| host.reference(name));
        let before = host.0.statistics();
        let start = std::time::Instant::now();
        for _ in 0..steps {
            for force in forces {
                host.0.real(force).unwrap();
            }
            host.0.step(1e-3).unwrap();
        }
        let each = start.elapsed().as_secs_f64() / f64::from(steps);
        let after = host.0.statistics();
        println!(
            "{what}: {:.2} us a step, {} evaluations each, {:?}",
            each * 1e6,
            (after.evaluations - before.evaluations) as f64 / f64::from(steps),
            after.by_method
        );
    }
}
