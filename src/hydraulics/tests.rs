//! Steps of a hydraulic actuator against reference values and closed forms.
#![allow(clippy::unwrap_used)]
use super::Model;

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
const H0: [[f64; 5]; 7] = [
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
fn directional_derivatives_are_those_of_differences() {
    let start = || {
        let mut actuator = model(ACTUATOR);
        for (name, value) in [
            ("solver.tolerance", 1e-13),
            ("actuator.length", 0.7105),
            ("actuator.speed", 0.004),
            ("actuator.acceleration", 0.3),
            ("valve.command", 0.5),
            ("actuator.reduced_mass", 700.0),
            ("actuator.reduced_mass_derivative", -800.0),
            ("actuator.holding_force", 1500.0),
            ("actuator.holding_force_derivative", 1e4),
            ("preview.horizon", 2e-3),
        ] {
            set(&mut actuator, name, value);
        }
        actuator.initialize().unwrap();
        // A first step gives the load a correction.
        actuator.step(2e-3).unwrap();
        for (name, value) in [("actuator.length", 0.711), ("actuator.speed", 0.0041), ("actuator.acceleration", 0.3)] {
            set(&mut actuator, name, value);
        }
        actuator
    };
    let mut actuator = start();
    let list = actuator.variables().list().to_vec();
    let outputs: Vec<u32> = (0..list.len() as u32)
        .filter(|i| {
            let v = &list[*i as usize];
            v.causality == crate::variables::Causality::Output
                && v.variability == crate::variables::Variability::Continuous
        })
        .collect();
    let sizes = [1e-4, 1e-3, 0.1, 0.1, 1e6, 1e5, 10.0, 100.0, 100.0, 1e3, 1e-4];
    for (input, size) in (0..11_u32).zip(sizes) {
        let mut exact = vec![f64::NAN; outputs.len()];
        actuator.directional_derivative(&outputs, &[input], &[2.0], &mut |i, value| exact[i] = value).unwrap();
        let value = actuator.real(input).unwrap();
        let mut at = |by: f64| -> Vec<f64> {
            actuator.set_real(input, value + by).unwrap();
            let all = outputs.iter().map(|output| actuator.real(*output).unwrap()).collect();
            actuator.set_real(input, value).unwrap();
            all
        };
        let e = 1e-3 * size;
        let (low, high, low2, high2) = (at(-e), at(e), at(-2.0 * e), at(2.0 * e));
        for (k, output) in outputs.iter().enumerate() {
            let difference = 2.0 * (8.0 * (high[k] - low[k]) - (high2[k] - low2[k])) / (12.0 * e);
            let rounding = 1e-5 * difference.abs() + 1e-11 * high[k].abs() / e;
            let name = &list[*output as usize].name;
            assert!(
                (exact[k] - difference).abs() <= rounding,
                "d {name} / d {}: {} is not {difference}",
                list[input as usize].name,
                exact[k]
            );
            let depends = list[*output as usize].dependencies.contains(&input);
            assert!(depends || exact[k] == 0.0, "{name} depends on {}", list[input as usize].name);
        }
    }
}

#[test]
fn output_derivatives_are_rates_of_the_outputs() {
    let start = |t: f64| {
        let mut actuator = model(ACTUATOR);
        for (name, value) in [
            ("solver.tolerance", 1e-13),
            ("actuator.length", 0.43),
            ("actuator.speed", 0.05),
            ("valve.command", 0.5),
            ("command.sine_amplitude", 0.2),
            ("command.sine_frequency", 5.0),
        ] {
            set(&mut actuator, name, value);
        }
        actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
        actuator.initialize().unwrap();
        rate(&mut actuator, "actuator.speed", 1, 0.4);
        rate(&mut actuator, "supply.pressure", 1, -1e6);
        actuator.step(t).unwrap();
        set(&mut actuator, "actuator.acceleration", 0.4);
        actuator
    };
    let t = 0.02;
    let mut actuator = start(t);
    let list = actuator.variables().list().to_vec();
    for (index, variable) in (0..).zip(&list) {
        let continuous = variable.variability == crate::variables::Variability::Continuous;
        let output = variable.causality == crate::variables::Causality::Output;
        if !(output && continuous) || variable.name.starts_with("preview.") {
            continue;
        }
        let exact = actuator.output_derivative(index, 1).unwrap();
        let e = 1e-5;
        let at = |by: f64| start(t + by).real(index).unwrap();
        let difference = (8.0 * (at(e) - at(-e)) - (at(2.0 * e) - at(-2.0 * e))) / (12.0 * e);
        // The balance is a difference of energies.
        let size = if variable.name == "energy.balance" { 100.0 } else { at(0.0).abs() };
        let rounding = 1e-6 * difference.abs() + 1e-10 * size / e;
        assert!((exact - difference).abs() <= rounding, "{}: {exact} is not {difference}", variable.name);
    }
    assert!(actuator.output_derivative(reference(&actuator, "coupling.stable_step"), 1).is_err());
    assert!(actuator.output_derivative(reference(&actuator, "actuator.force"), 2).is_err());
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

/// The line of the warnings of one step after these values are set.
fn warning(values: &[(&str, f64)], mode: &str, h: f64) -> Option<String> {
    let mut actuator = model(ACTUATOR);
    actuator.set_text(reference(&actuator, "coupling.mode"), mode).unwrap();
    actuator.initialize().unwrap();
    actuator.step(h).unwrap();
    actuator.take_warning();
    values.iter().for_each(|(name, value)| set(&mut actuator, name, *value));
    actuator.step(h).unwrap();
    let warning = actuator.take_warning();
    actuator.step(h).unwrap();
    assert_eq!(actuator.take_warning(), None, "a warning comes once");
    warning
}

#[test]
fn what_a_host_should_know_is_told_once() {
    assert_eq!(warning(&[("valve.command", 1.0)], "follow", 1e-3), None);
    let clipped = warning(&[("valve.command", 1.2)], "follow", 1e-3).unwrap();
    assert!(clipped.contains("valve.command") && clipped.contains("1.2"), "{clipped}");
    let drift = warning(&[("actuator.length", 0.6)], "follow", 1e-3).unwrap();
    assert!(drift.contains("actuator.length = 0.6 m") && drift.contains("0.577 m"), "{drift}");
    let horizon = warning(&[("actuator.reduced_mass", 700.0), ("preview.horizon", 2e-3)], "preview", 1e-3).unwrap();
    assert!(horizon.contains("preview.horizon = 0.002 s"), "{horizon}");
    let unstable = warning(&[("actuator.reduced_mass", 700.0), ("preview.horizon", 5e-3)], "follow", 5e-3).unwrap();
    assert!(unstable.contains("coupling.stable_step"), "{unstable}");
    let toggle = [("actuator.reduced_mass", 1e6), ("actuator.reduced_mass_derivative", 1e9), ("actuator.speed", 1.0)];
    let toggle = warning(&toggle, "preview", 1e-3).unwrap();
    assert!(toggle.contains("toggle"), "{toggle}");
}

#[test]
fn what_cannot_be_is_refused_by_name_and_changes_nothing() {
    let mut actuator = model(ACTUATOR);
    assert!(actuator.step(1e-3).unwrap_err().to_string().contains("initialise"));
    set(&mut actuator, "actuator.length", 0.75);
    let error = actuator.initialize().unwrap_err().to_string();
    assert!(error.contains("0.75") && error.contains("0.412 m") && error.contains("0.742 m"), "{error}");
    set(&mut actuator, "actuator.length", 0.741);
    actuator.initialize().unwrap();
    set(&mut actuator, "actuator.speed", 1.0);
    let error = actuator.step(0.1).unwrap_err();
    assert!(!error.ends_step() && error.to_string().contains("0.841"), "{error}");
    assert_eq!(get(&mut actuator, "actuator.length"), 0.741);
    for (name, value, text) in [
        ("valve.command", f64::NAN, "valve.command = NaN"),
        ("supply.pressure", -2e5, "-101325"),
        ("actuator.reduced_mass", -1.0, ">= 0"),
        ("preview.horizon", 0.0, "> 0"),
        ("chamber_a.dead_volume", 0.0, "> 0"),
        ("actuator.force", 1.0, "output"),
    ] {
        let error = actuator.set_real(reference(&actuator, name), value).unwrap_err().to_string();
        assert!(error.contains(text) && error.contains(name), "{error}");
    }
    set(&mut actuator, "cylinder.rod", 0.1);
    let error = actuator.initialize().unwrap_err().to_string();
    assert!(error.contains("cylinder.rod = 0.1") && error.contains("cylinder.bore = 0.045"), "{error}");
    assert!(actuator.step(-1.0).is_err() && actuator.step(f64::NAN).is_err());
}

#[test]
fn oil_without_air_that_cavitates_is_named() {
    let mut actuator = model(ACTUATOR);
    actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
    set(&mut actuator, "fluid.air_fraction", 0.0);
    set(&mut actuator, "anticavitation.conductance", 0.0);
    actuator.initialize().unwrap();
    set(&mut actuator, "actuator.speed", 0.5);
    let before = get(&mut actuator, "chamber_a.pressure");
    let error = actuator.step(0.1).unwrap_err();
    assert!(error.ends_step());
    let error = error.to_string();
    assert!(error.contains("chamber_a") && error.contains("fluid.air_fraction"), "{error}");
    assert_eq!(get(&mut actuator, "chamber_a.pressure"), before);
}

#[test]
fn the_work_of_a_step_is_bounded() {
    let mut actuator = model(ACTUATOR);
    set(&mut actuator, "solver.max_steps", 3.0);
    set(&mut actuator, "actuator.length", 0.55);
    actuator.initialize().unwrap();
    set(&mut actuator, "valve.command", 1.0);
    let error = actuator.step(1.0).unwrap_err();
    let super::HydraulicsError::Interrupted { time, why } = error else { panic!("{error}") };
    assert!(time > 0.0 && time < 1.0 && why.contains("solver.max_steps = 3"), "{why}");
    assert!(get(&mut actuator, "valve.position") > 0.0);
    actuator.step(1e-3).unwrap();
}

/// Parameters far from the usual: each run ends, with finite values or an error that names its reason.
#[test]
fn extreme_parameters_end_in_values_or_named_errors() {
    let list = model(ACTUATOR).variables().list().to_vec();
    let parameters = list.iter().filter(|v| v.causality == crate::variables::Causality::Parameter);
    let real = parameters.filter_map(|v| match v.start {
        Some(crate::variables::Value::Real(start)) if !v.name.starts_with("solver.") => Some((v.name.clone(), start)),
        _ => None,
    });
    let (mut good, mut refused) = (0, 0);
    for (name, start) in real {
        for factor in [1e-3, 0.1, 10.0, 1e3] {
            for mode in ["follow", "preview"] {
                let mut actuator = model(ACTUATOR);
                actuator.set_text(reference(&actuator, "coupling.mode"), mode).unwrap();
                if actuator.set_real(reference(&actuator, &name), start * factor).is_err() {
                    continue;
                }
                if mode == "preview" {
                    set(&mut actuator, "actuator.reduced_mass", 700.0);
                }
                let began = std::time::Instant::now();
                if let Err(error) = actuator.initialize() {
                    assert!(error.to_string().contains(" = "), "{error}");
                    refused += 1;
                    continue;
                }
                for step in 0..100 {
                    set(&mut actuator, "valve.command", if step % 40 < 20 { 1.0 } else { -1.0 });
                    set(&mut actuator, "actuator.length", 0.577);
                    set(&mut actuator, "actuator.speed", 0.0);
                    if let Err(error) = actuator.step(1e-3) {
                        assert!(error.to_string().contains("solver."), "{name} x {factor}: {error}");
                        refused += 1;
                        break;
                    }
                    for output in ["actuator.force", "chamber_a.pressure", "energy.balance", "preview.force"] {
                        assert!(get(&mut actuator, output).is_finite(), "{name} x {factor}: {output}");
                    }
                    good += 1;
                }
                let took = began.elapsed().as_secs_f64();
                if took > 0.05 {
                    println!("{name} x {factor} {mode}: {took} s, {:?}", actuator.statistics());
                }
            }
        }
    }
    println!("{good} steps, {refused} refusals");
    assert!(good > 30_000 && refused < 40, "{good} {refused}");
}

/// A pump of constant flow fills an accumulator behind a closed valve: the gas has V_0 (p_pre/p_abs)^(1/n) at the start
/// and loses the oil pumped, so p_abs = p_pre (V_0/V_gas)^n.
#[test]
fn an_accumulator_is_filled_as_its_gas_is_compressed() {
    for h in [1e-3_f64, 0.05] {
        let mut actuator = model(ACTUATOR);
        actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
        for (name, value) in [
            ("solver.tolerance", 1e-12),
            ("accumulator.volume", 1e-3),
            ("accumulator.precharge_pressure", 8e6),
            ("supply.pressure", 12e6),
            ("pump.max_flow", 2e-4),
            ("pump.full_pressure", 50e6),
            ("pump.max_pressure", 60e6),
            // A valve that passes next to nothing.
            ("valve.rated_flow", 1e-19),
        ] {
            set(&mut actuator, name, value);
        }
        actuator.initialize().unwrap();
        let (ambient, n) = (101_325.0, 1.4_f64);
        let gas = 1e-3 * ((8e6_f64 + ambient) / (12e6 + ambient)).powf(1.0 / n);
        for step in 1..=(1.0 / h).round() as u32 {
            actuator.step(h).unwrap();
            let left = gas - 2e-4 * f64::from(step) * h;
            let expected = (8e6 + ambient) * (1e-3 / left).powf(n) - ambient;
            let found = get(&mut actuator, "accumulator.pressure");
            assert!((found / expected - 1.0).abs() < 1e-9, "{step}: {found} is not {expected}");
        }
    }
}

/// The pump fills the accumulator until it gives what leaks through the valve; without the pump, the gas does the work
/// of the oil supplied.
#[test]
fn a_compensated_pump_holds_its_pressure_and_an_accumulator_is_emptied_by_the_valve() {
    let mut actuator = model(ACTUATOR);
    actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
    for (name, value) in [("accumulator.volume", 2e-4), ("supply.pressure", 18e6), ("actuator.length", 0.5)] {
        set(&mut actuator, name, value);
    }
    actuator.initialize().unwrap();
    (0..300).for_each(|_| actuator.step(1e-2).unwrap());
    let held = get(&mut actuator, "accumulator.pressure");
    // The clearance of the valve leaks; the pump gives as much, but for what the gas still takes.
    let (flow, leak) = (1.5e-4 * (20.7e6 - held) / 0.7e6, get(&mut actuator, "supply.flow"));
    let rate = actuator.output_derivative(reference(&actuator, "accumulator.pressure"), 1).unwrap();
    let gas = 2e-4 * (10_101_325.0 / (held + 101_325.0)).powf(1.0 / 1.4);
    let taken = rate * gas / (1.4 * (held + 101_325.0));
    assert!((flow / leak - 1.0).abs() < 1e-3, "{flow} {leak}");
    assert!((flow - leak - taken).abs() < 1e-9 * leak, "{flow} {leak} {taken}");
    set(&mut actuator, "pump.max_flow", 0.0);
    actuator.initialize().unwrap();
    let start = get(&mut actuator, "accumulator.pressure");
    assert_eq!(start, 18e6);
    set(&mut actuator, "valve.command", 0.5);
    let mut before = start;
    for _ in 0..20 {
        actuator.step(1e-2).unwrap();
        let now = get(&mut actuator, "accumulator.pressure");
        assert!(now < before);
        before = now;
    }
    // Supplied oil is the growth of the gas, and its energy the work of the gas: int p_S dV.
    let (ambient, n) = (101_325.0_f64, 1.4_f64);
    let gas = |p: f64| 2e-4 * ((10e6 + ambient) / (p + ambient)).powf(1.0 / n);
    let (v, w) = (gas(18e6), gas(before));
    let work = (18e6 + ambient) * v.powf(n) * (v.powf(1.0 - n) - w.powf(1.0 - n)) / (n - 1.0) - ambient * (w - v);
    let supplied = get(&mut actuator, "energy.supplied");
    assert!((supplied / work - 1.0).abs() < 1e-7, "{supplied} {work}");
    assert!(get(&mut actuator, "energy.balance").abs() < 1e-8 * supplied);
}

#[test]
fn a_lock_valve_holds_until_its_pilot_opens() {
    use super::circuit::{Equations, Point};
    use super::definition::Circuit;
    let mut circuit = Circuit::default();
    (circuit.relief.conductance, circuit.anticavitation.conductance) = (0.0, 0.0);
    let free = Equations::new(&circuit);
    circuit.lock_valve.pilot_ratio = 0.3;
    let locked = Equations::new(&circuit);
    let at = |pressures| Point {
        pressures,
        spool: -0.5,
        spool_speed: 0.0,
        length: 0.6,
        speed: 0.0,
        // Of the pressure in the chamber, so that nothing leaks into it.
        supply: 12e6,
        tank: 0.35e6,
        command: 0.0,
    };
    // Leakages do not pass the valve.
    let leaks = |p: [f64; 2]| -2e-13 * (p[0] - p[1]);
    let out = |laws: &Equations, p| laws.flows(&at(p)).chambers[0] - leaks(p);
    let (closed, open) = ([12e6, 0.0], [12e6, 9e6]);
    assert!(out(&free, closed) < -1e-5);
    assert!(out(&locked, closed).abs() < 1e-7 * out(&free, closed).abs(), "{}", out(&locked, closed));
    assert!((out(&locked, open) / out(&free, open) - 1.0).abs() < 1e-3);
    // Inflow passes whatever the pilot says, but for the tail of the gate, (w/2d)^2 at the pressure drop d.
    let inflow = |laws: &Equations| laws.flows(&Point { spool: 0.5, ..at([5e6, 0.0]) }).chambers[0];
    assert!((inflow(&locked) / inflow(&free) - 1.0).abs() < 1e-4);
    let powers = locked.powers(&at(closed), &locked.flows(&at(closed)));
    let out = powers.returned + powers.piston + powers.seal_friction + powers.compression + powers.throttling;
    assert!((powers.supply - out).abs() < 1e-12 * powers.throttling.abs().max(1.0));
}

#[test]
fn hoses_and_walls_soften_the_oil_as_springs_in_series() {
    use super::circuit::Equations;
    use super::definition::Circuit;
    let mut circuit = Circuit::default();
    circuit.hose.volume_a = 4e-5;
    circuit.hose.modulus = 3e8;
    circuit.cylinder.wall_modulus = 2e10;
    let laws = Equations::new(&circuit);
    let (p, v) = (5e6, 3e-4);
    let oil = laws.bulk_modulus(p);
    let expected = 1.0 / (1.0 / oil + (4e-5 / v) / 3e8 + ((v - 4e-5) / v) / 2e10);
    assert!((laws.chamber_modulus(0, p, v) / expected - 1.0).abs() < 1e-14);
    // A hose holds its part whatever the stroke: growth of each volume under a pressure adds up.
    let growth = v / laws.chamber_modulus(0, p, v);
    assert!((growth - (v / oil + 4e-5 / 3e8 + (v - 4e-5) / 2e10)).abs() < 1e-14 * growth);
    circuit.hose.volume_a = 7e-5;
    let error = circuit.check().unwrap_err().to_string();
    assert!(error.contains("hose.volume_a = 0.00007") && error.contains("chamber_a.dead_volume"), "{error}");
    let stiff = Equations::new(&Circuit::default());
    assert_eq!(stiff.chamber_modulus(0, p, v), stiff.bulk_modulus(p));
}

#[test]
fn pressed_seals_rub_by_the_sum_of_the_pressures() {
    use super::circuit::Equations;
    use super::definition::Circuit;
    let mut circuit = Circuit::default();
    circuit.seal.pressure_area = 2e-5;
    let (dry, pressed) = (Equations::new(&Circuit::default()), Equations::new(&circuit));
    let (pressures, v) = ([10e6, 6e6], 0.05);
    let more = pressed.seal_friction(pressures, v) - dry.seal_friction(pressures, v);
    // 2e-5 m2 x 16 MPa, tanh(10) and the rounding of the pressures at 0 apart: w^2/(4 p) each.
    let expected = 2e-5 * (16e6 + 0.25e10 / 10e6 + 0.25e10 / 6e6) * 10.0_f64.tanh();
    assert!((more / expected - 1.0).abs() < 1e-8, "{more} {expected}");
    for v in [-0.01, 0.0, 0.004] {
        let h = 1e-7;
        let slope = (pressed.seal_friction(pressures, v + h) - pressed.seal_friction(pressures, v - h)) / (2.0 * h);
        assert!((pressed.damping(pressures, v) / slope - 1.0).abs() < 1e-6);
    }
    assert!((pressed.force(pressures, v) - dry.force(pressures, v) + more).abs() < 1e-9);
}

/// Derivatives of inputs lead out of their ranges within a step: no state may hold a negative mass.
#[test]
fn an_input_that_leaves_its_range_within_a_step_is_refused_by_name() {
    for (mode, name, value, first) in [
        ("preview", "actuator.reduced_mass", 700.0, -1e6),
        ("follow", "actuator.reduced_mass", 700.0, -1e6),
        ("delayed", "preview.horizon", 1e-3, -2.0),
        ("preview", "supply.pressure", 1e6, -1e10),
    ] {
        let mut actuator = model(&format!(r#"{{ "name": "A", "coupling": {{ "mode": "{mode}" }} }}"#));
        set(&mut actuator, "actuator.reduced_mass", 700.0);
        actuator.initialize().unwrap();
        set(&mut actuator, name, value);
        rate(&mut actuator, name, 1, first);
        let error = actuator.step(1e-3).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("at the end of the step"), "{mode}: {error}");
        rate(&mut actuator, name, 1, 0.0);
        actuator.step(1e-3).unwrap();
        let mut bytes = Vec::new();
        actuator.snapshot().write(&mut bytes).unwrap();
        actuator.read_snapshot(&bytes).unwrap();
    }
}

/// A foresight over one step that fails, as oil without air cavitates, says nothing of a shorter one.
#[test]
fn a_foresight_that_fails_belongs_to_its_step() {
    let mut actuator = model(
        r#"{ "name": "A", "circuit": { "fluid": { "air_fraction": 0 }, "anticavitation": { "conductance": 0 } } }"#,
    );
    set(&mut actuator, "chamber_a.start_pressure", 1e5);
    set(&mut actuator, "chamber_b.start_pressure", 1e5);
    set(&mut actuator, "actuator.reduced_mass", 700.0);
    set(&mut actuator, "actuator.holding_force", -2e5);
    set(&mut actuator, "preview.horizon", 1e-5);
    actuator.initialize().unwrap();
    let mut twin = actuator.clone();
    assert!(actuator.step(0.05).unwrap_err().to_string().contains("absolute pressure"));
    assert_eq!(get(&mut actuator, "preview.force").to_bits(), get(&mut twin, "preview.force").to_bits());
}

/// In the mode delayed the outputs of the next step are told with the last one, whatever is set after it, and a state
/// holds them.
#[test]
fn what_was_told_in_the_mode_delayed_stays() {
    let mut actuator = model(r#"{ "name": "A", "coupling": { "mode": "delayed" } }"#);
    set(&mut actuator, "actuator.reduced_mass", 700.0);
    set(&mut actuator, "actuator.holding_force", 800.0);
    set(&mut actuator, "valve.command", 0.5);
    actuator.initialize().unwrap();
    actuator.step(1e-3).unwrap();
    let names = ["preview.force", "preview.force_rate", "preview.force_mean", "preview.length", "preview.speed"];
    let told = names.map(|name| get(&mut actuator, name).to_bits());
    set(&mut actuator, "actuator.holding_force", -500.0);
    set(&mut actuator, "actuator.speed", 0.1);
    set(&mut actuator, "valve.command", -0.5);
    assert_eq!(names.map(|name| get(&mut actuator, name).to_bits()), told);
    let mut other = model(r#"{ "name": "A", "coupling": { "mode": "delayed" } }"#);
    let mut bytes = Vec::new();
    actuator.snapshot().write(&mut bytes).unwrap();
    let snapshot = other.read_snapshot(&bytes).unwrap();
    other.restore(&snapshot).unwrap();
    assert_eq!(names.map(|name| get(&mut other, name).to_bits()), told);
    for model in [&mut actuator, &mut other] {
        model.step(1e-3).unwrap();
    }
    let ends = [&mut actuator, &mut other].map(|model| names.map(|name| get(model, name).to_bits()));
    assert_eq!(ends[0], ends[1]);
    assert_ne!(ends[0], told);
}
