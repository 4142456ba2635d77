//! Steps of a hydraulic actuator against reference values and closed forms.
#![allow(clippy::unwrap_used)]
use super::{HydraulicsError, Model};

mod derivatives;
mod ends;
mod events;
mod foresight;
mod options;
mod refusals;

/// The actuator of the reference scenes.
const ACTUATOR: &str = r#"{ "name": "Actuator" }"#;

fn model(json: &str) -> Model {
    Model::from_json(json).unwrap()
}

fn reference(model: &Model, name: &str) -> u32 {
    model.variables().find(name).unwrap_or_else(|| panic!("{name}"))
}

fn set(model: &mut Model, name: &str, value: f64) {
    model.set_real(reference(model, name), value).unwrap();
}

fn rate(model: &mut Model, name: &str, order: i32, value: f64) {
    model.set_input_derivative(reference(model, name), order, value).unwrap();
}

fn get(model: &mut Model, name: &str) -> f64 {
    model.real(reference(model, name)).unwrap()
}

/// Times, p_A, p_B, y and F of the hydraulics alone under the length 0.50 + 0.10 t - 0.075 t^2: two methods of others
/// agree on them to 5e-12.
pub(super) const H0: [[f64; 5]; 7] = [
    [0.01, 472_875.119_061, 10_911_388.851_1, 0.392_357_384_677, -11_544.873_288],
    [0.05, -13_523.705_699, 15_140_206.366_84, 0.400_000_108_367, -16_965.284_908_2],
    [0.1, -25_100.951_360, 16_924_908.076_86, 0.4, -18_942.329_747_3],
    [0.3, 1_077_695.348_164, 10_525_627.852_58, 0.4, -10_137.109_840_7],
    [0.6, 19_288_133.033_38, 1_180_703.038_019, 0.4, 29_019.574_619_3],
    [0.7, 20_758_479.107_34, 407_524.025_005, 0.4, 32_867.054_710_5],
    [1.0, 28_266_440.307_96, 40_292.352_995, 0.4, 45_186.816_675_9],
];

/// The scene H0 in steps of size `h`, at a tolerance: calls `check` at each time of the table that is a communication
/// point.
fn h0(h: f64, tolerance: f64, mut check: impl FnMut(&mut Model, &[f64; 5])) {
    let mut actuator = model(ACTUATOR);
    set(&mut actuator, "chamber_b.start_pressure", 8e6);
    set(&mut actuator, "solver.tolerance", tolerance);
    set(&mut actuator, "actuator.length", 0.5);
    set(&mut actuator, "valve.command", 0.4);
    actuator.initialize().unwrap();
    let (speed, length) = (reference(&actuator, "actuator.speed"), reference(&actuator, "actuator.length"));
    for step in 0..(1.0 / h).round() as u64 {
        let t = step as f64 * h;
        actuator.set_real(length, 0.5 + 0.1 * t - 0.075 * t * t).unwrap();
        actuator.set_real(speed, 0.1 - 0.15 * t).unwrap();
        actuator.set_input_derivative(speed, 1, -0.15).unwrap();
        actuator.step(h).unwrap();
        let end = (step + 1) as f64 * h;
        if let Some(row) = H0.iter().find(|row| (row[0] - end).abs() < 1e-9) {
            actuator.set_real(speed, 0.1 - 0.15 * end).unwrap();
            check(&mut actuator, row);
        }
    }
    assert_eq!(actuator.take_warning(), None);
}

/// Largest error of pressures over p + p_0, of the spool, and of the force over 1 kN.
fn error(actuator: &mut Model, row: &[f64; 5]) -> f64 {
    let pressure = |name: &str, expected: f64, actuator: &mut Model| {
        ((get(actuator, name) - expected) / (expected + 101_325.0)).abs()
    };
    let errors = [
        pressure("chamber_a.pressure", row[1], actuator),
        pressure("chamber_b.pressure", row[2], actuator),
        (get(actuator, "valve.position") - row[3]).abs(),
        ((get(actuator, "actuator.force") - row[4]) / 1e3).abs() * 0.1,
    ];
    errors.into_iter().fold(0.0, f64::max)
}

#[test]
fn hydraulics_alone_meet_the_reference_at_any_step() {
    for h in [1e-5, 1e-3, 0.05, 0.1] {
        let mut rows = 0;
        h0(h, 1e-12, |actuator, row| {
            let error = error(actuator, row);
            println!("h = {h} t = {}: {error:e}", row[0]);
            assert!(error < 1e-10, "h = {h}, t = {}: {error:e}", row[0]);
            rows += 1;
        });
        assert!(rows >= 5);
    }
}

#[test]
fn energies_balance_within_the_tolerance() {
    h0(1e-3, 1e-9, |actuator, _| {
        let supplied = get(actuator, "energy.supplied");
        assert!(get(actuator, "energy.balance").abs() < 1e-8 * supplied);
    });
}

#[test]
#[ignore = "a measurement"]
fn cost() {
    for (mode, mass) in [("follow", 0.0), ("preview", 700.0)] {
        let mut actuator = model(ACTUATOR);
        actuator.set_text(reference(&actuator, "coupling.mode"), mode).unwrap();
        set(&mut actuator, "actuator.length", 0.5);
        set(&mut actuator, "valve.command", 0.4);
        actuator.initialize().unwrap();
        let (speed, length) = (reference(&actuator, "actuator.speed"), reference(&actuator, "actuator.length"));
        set(&mut actuator, "actuator.reduced_mass", mass);
        set(&mut actuator, "actuator.holding_force", 500.0);
        let mut best = f64::INFINITY;
        for round in 0..40 {
            let began = std::time::Instant::now();
            for step in 0..100 {
                let t = (step + 100 * (round % 10)) as f64 * 1e-3;
                if mass == 0.0 {
                    actuator.set_real(length, 0.5 + 0.1 * t - 0.075 * t * t).unwrap();
                    actuator.set_real(speed, 0.1 - 0.15 * t).unwrap();
                    actuator.set_input_derivative(speed, 1, -0.15).unwrap();
                } else {
                    actuator.set_real(length, 0.5 + 0.01 * (t + 0.01 * step as f64).sin()).unwrap();
                }
                actuator.step(1e-3).unwrap();
            }
            best = best.min(began.elapsed().as_secs_f64() / 100.0);
        }
        println!("{mode}: {:.0} ns a step, {:?}", best * 1e9, actuator.statistics());
    }
    let began = std::time::Instant::now();
    (0..1000).for_each(|_| drop(model(ACTUATOR)));
    println!("set-up {:.1} us", began.elapsed().as_secs_f64() * 1e3);
}

/// Length, speed and pressures of the actuator with a constant mass on a linear spring, in steps of size h by the mode
/// preview: the element is that mass exactly.
fn spring_mass(h: f64, end: f64) -> [f64; 4] {
    let mut actuator = model(ACTUATOR);
    for (name, value) in [
        ("solver.tolerance", 1e-12),
        ("actuator.length", 0.55),
        ("actuator.reduced_mass", 700.0),
        ("actuator.holding_force_derivative", 2e4),
        ("preview.horizon", h),
        ("command.sine_amplitude", 0.4),
        ("command.sine_frequency", 3.0),
    ] {
        set(&mut actuator, name, value);
    }
    actuator.initialize().unwrap();
    for _ in 0..(end / h).round() as u32 {
        let load = 500.0 + 2e4 * (get(&mut actuator, "actuator.length") - 0.55);
        set(&mut actuator, "actuator.holding_force", load);
        actuator.step(h).unwrap();
    }
    ["actuator.length", "actuator.speed", "chamber_a.pressure", "chamber_b.pressure"]
        .map(|name| get(&mut actuator, name))
}

/// The same by the classical method of order 4 in steps of 5 us, on the laws alone.
fn spring_mass_alone(end: f64) -> [f64; 4] {
    use super::circuit::{Equations, Point};
    let laws = Equations::new(&super::definition::Circuit::default());
    let f = |t: f64, [length, speed, a, b, spool, spool_speed]: [f64; 6]| {
        let command = 0.4 * (std::f64::consts::TAU * 3.0 * t).sin();
        let pressures = [a, b];
        let at = Point { pressures, spool, spool_speed, length, speed, supply: 20.7e6, tank: 0.35e6, command };
        let flows = laws.flows(&at);
        let acceleration = (laws.force(pressures, speed) - 500.0 - 2e4 * (length - 0.55)) / 700.0;
        let [a, b] = flows.pressure_rates;
        [speed, acceleration, a, b, spool_speed, flows.spool_acceleration]
    };
    let add = |y: [f64; 6], h: f64, k: [f64; 6]| -> [f64; 6] { std::array::from_fn(|i| y[i] + h * k[i]) };
    let (h, mut y) = (5e-6, [0.55, 0.0, 6e6, 11.15e6, 0.0, 0.0]);
    for step in 0..(end / h).round() as u32 {
        let t = f64::from(step) * h;
        let k1 = f(t, y);
        let k2 = f(t + 0.5 * h, add(y, 0.5 * h, k1));
        let k3 = f(t + 0.5 * h, add(y, 0.5 * h, k2));
        let k4 = f(t + h, add(y, h, k3));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    [y[0], y[1], y[2], y[3]]
}

#[test]
fn a_constant_mass_arrives_exactly_at_any_step() {
    let expected = spring_mass_alone(0.4);
    for h in [1e-3, 2e-2, 0.1] {
        let found = spring_mass(h, 0.4);
        for (found, (expected, size)) in found.iter().zip(expected.iter().zip([1.0, 0.1, 1e7, 1e7])) {
            assert!((found - expected).abs() < 1e-9 * size, "h = {h}: {found} is not {expected}");
        }
    }
}

#[test]
fn the_line_has_the_impulse_and_the_moment_of_the_force() {
    // One step of 10 ms; the force of 2000 steps of 5 us of the same element.
    let start = |horizon: f64| {
        let mut actuator = model(ACTUATOR);
        for (name, value) in [
            ("solver.tolerance", 1e-12),
            ("actuator.length", 0.55),
            ("actuator.reduced_mass", 700.0),
            ("actuator.holding_force", -2e3),
            ("valve.command", 0.5),
            ("preview.horizon", horizon),
        ] {
            set(&mut actuator, name, value);
        }
        actuator.initialize().unwrap();
        actuator
    };
    let mut whole = start(1e-2);
    let [line, rate, mean] =
        ["preview.force", "preview.force_rate", "preview.force_mean"].map(|name| get(&mut whole, name));
    let (mut fine, h) = (start(5e-6), 5e-6);
    let (mut impulse, mut moment) = (0.0, 0.0);
    for step in 0..2000 {
        let before = get(&mut fine, "actuator.force");
        fine.step(h).unwrap();
        let after = get(&mut fine, "actuator.force");
        let t = f64::from(step) * h;
        impulse += 0.5 * h * (before + after);
        moment += 0.5 * h * (before * t + after * (t + h));
    }
    let span: f64 = 1e-2;
    assert!((impulse / (mean * span) - 1.0).abs() < 1e-6, "{impulse} {}", mean * span);
    let of_line = line * span + 0.5 * rate * span * span;
    assert!((impulse / of_line - 1.0).abs() < 1e-6);
    let of_line = line * span * span / 2.0 + rate * span.powi(3) / 3.0;
    assert!((moment / of_line - 1.0).abs() < 1e-6, "{moment} {of_line}");
}

#[test]
fn a_snapshot_goes_on_to_the_bit_and_through_bytes() {
    let mut actuator = model(ACTUATOR);
    set(&mut actuator, "actuator.length", 0.43);
    set(&mut actuator, "actuator.reduced_mass", 700.0);
    set(&mut actuator, "valve.command", 0.6);
    actuator.initialize().unwrap();
    (0..30).for_each(|_| actuator.step(1e-3).unwrap());
    rate(&mut actuator, "valve.command", 1, -3.0);
    let snapshot = actuator.snapshot();
    let mut bytes = Vec::new();
    snapshot.write(&mut bytes).unwrap();
    let run = |actuator: &mut Model| -> Vec<u64> {
        let mut bits = Vec::new();
        for step in 0..40 {
            if step % 3 == 0 {
                // Reading the foreseen motion must not change what follows.
                let _ = get(actuator, "preview.force");
            }
            actuator.step(1e-3).unwrap();
            bits.extend(
                (0..actuator.variables().list().len() as u32).filter_map(|i| actuator.real(i).ok()).map(f64::to_bits),
            );
        }
        bits
    };
    let first = run(&mut actuator);
    actuator.restore(&snapshot).unwrap();
    assert!(run(&mut actuator) == first);
    let mut other = model(ACTUATOR);
    let read = other.read_snapshot(&bytes).unwrap();
    other.restore(&read).unwrap();
    assert!(run(&mut other) == first);
    actuator.restore(&snapshot).unwrap();
    let mut unread = Vec::new();
    for _ in 0..40 {
        actuator.step(1e-3).unwrap();
        let all = 0..actuator.variables().list().len() as u32;
        unread.extend(all.filter_map(|i| actuator.real(i).ok()).map(f64::to_bits));
    }
    assert!(unread == first);
    for end in 0..bytes.len() {
        assert!(other.read_snapshot(&bytes[..end]).is_err());
    }
    bytes[0] = 9;
    assert!(other.read_snapshot(&bytes).unwrap_err().to_string().contains("version 9"));
    actuator.reset();
    assert_eq!(get(&mut actuator, "valve.command"), 0.0);
}
