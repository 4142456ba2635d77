//! Derivatives of outputs by inputs and in time against differences.
use super::*;
use foundation::variables::{Causality, Kind};

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
            v.causality == foundation::variables::Causality::Output
                && v.variability == foundation::variables::Variability::Continuous
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
        let continuous = variable.variability == foundation::variables::Variability::Continuous;
        let output = variable.causality == foundation::variables::Causality::Output;
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

/// Values of the inputs and parameters at which every option acts.
const ALL_ON: &[(&str, f64)] = &[
    ("actuator.speed", 0.02),
    ("actuator.acceleration", 0.1),
    ("actuator.reduced_mass", 700.0),
    ("actuator.reduced_mass_derivative", 30.0),
    ("actuator.holding_force", 500.0),
    ("actuator.holding_force_derivative", 1e3),
    ("valve.command", 0.3),
    ("preview.horizon", 2e-3),
    ("cylinder.wall_modulus", 1e10),
    ("hose.volume_a", 1e-5),
    ("hose.volume_b", 2e-5),
    ("lock_valve.pilot_ratio", 0.3),
    ("seal.pressure_area", 1e-5),
    ("restrictor_b.rated_flow", 5e-5),
    ("leakage.external_a", 1e-14),
    ("command.ramp_amplitude", 0.2),
    ("command.ramp_time", 0.1),
    ("command.sine_amplitude", 0.1),
    ("command.sine_frequency", 3.0),
];

/// The value at the start of an output changes with each input and parameter of its list, at one place at least, and
/// with no other.
#[test]
fn initial_dependencies_are_exact() {
    let near_a =
        [("actuator.length", 0.43), ("chamber_a.start_pressure", 27.99e6), ("chamber_b.start_pressure", 0.1e6)];
    let near_b =
        [("actuator.length", 0.73), ("chamber_a.start_pressure", 0.1e6), ("chamber_b.start_pressure", 27.99e6)];
    // In the band of the pump, and half-way up the ramp.
    // With open edges and lock valve, so that oil leaves chamber A through its cushion.
    let open = [
        ("actuator.length", 0.43),
        ("chamber_a.start_pressure", 25e6),
        ("chamber_b.start_pressure", 24e6),
        ("valve.overlap", -0.5),
    ];
    let filled = [("accumulator.volume", 1e-4), ("supply.pressure", 20.3e6), ("preview.horizon", 0.02)];
    let alone = [("actuator.reduced_mass", 0.0)];
    let long = [("preview.horizon", 0.11), ("actuator.length", 0.6), ("actuator.speed", 0.0)];
    // At rest on a stop, on either side.
    let pushed = [
        ("actuator.length", 0.6),
        ("actuator.speed", 0.0),
        ("actuator.upper_limit", 0.6),
        ("chamber_a.start_pressure", 25e6),
    ];
    let pulled = [
        ("actuator.length", 0.6),
        ("actuator.speed", 0.0),
        ("actuator.lower_limit", 0.6),
        ("chamber_b.start_pressure", 25e6),
    ];
    // At an end of the cylinder, at rest and with a speed.
    let out = [
        ("actuator.length", 0.742),
        ("actuator.speed", 0.0),
        ("chamber_a.start_pressure", 25e6),
        ("chamber_b.start_pressure", 1e6),
    ];
    let home = [
        ("actuator.length", 0.412),
        ("actuator.speed", 0.0),
        ("actuator.lower_limit", 0.412),
        ("chamber_a.start_pressure", 1e6),
        ("chamber_b.start_pressure", 25e6),
    ];
    let met = [("actuator.speed", 0.05), ("cylinder.restitution", 0.5), ("preview.horizon", 2e-4)];
    let places: [&[&[(&str, f64)]]; 14] = [
        &[&open],
        &[&near_a],
        &[&near_b],
        &[&near_a, &filled],
        &[&near_b, &filled],
        &[&near_a, &alone],
        &[&near_b, &long],
        &[&long],
        &[&pushed],
        &[&pulled],
        &[&out],
        &[&out, &alone],
        &[&out, &met],
        &[&home],
    ];
    let list = model(ACTUATOR).variables().list().to_vec();
    let mut found = vec![std::collections::BTreeSet::new(); list.len()];
    for place in places {
        let mut base = model(ACTUATOR);
        for (name, value) in ALL_ON.iter().chain(place.iter().copied().flatten()) {
            set(&mut base, name, *value);
        }
        let outputs = |actuator: &mut Model| -> Vec<u64> {
            let of = |k: usize| actuator.real(k as u32).map_or(0, f64::to_bits);
            (0..list.len()).map(of).collect()
        };
        let before = outputs(&mut base.clone());
        for (known, variable) in list.iter().enumerate().filter(|(_, v)| v.causality != Causality::Output) {
            if variable.kind != Kind::Real {
                continue;
            }
            let value = base.clone().real(known as u32).unwrap();
            for other in [value * 1.01, value * 0.99, 0.5 * value, 1e-3] {
                let mut beside = base.clone();
                if beside.set_real(known as u32, other).is_err() || beside.initialize().is_err() {
                    continue;
                }
                let after = outputs(&mut beside);
                let outputs = (0..list.len()).filter(|k| list[*k].causality == Causality::Output);
                outputs.filter(|k| after[*k] != before[*k]).for_each(|k| {
                    found[k].insert(known as u32);
                });
            }
        }
    }
    let declared = model(ACTUATOR).initial_dependencies().unwrap().unwrap();
    let name = |reference: &u32| list[*reference as usize].name.clone();
    let mut wrong = Vec::new();
    for (k, variable) in list.iter().enumerate().filter(|(_, v)| v.causality == Causality::Output) {
        let declared: std::collections::BTreeSet<u32> = declared[k].iter().copied().collect();
        let missing: Vec<String> = found[k].difference(&declared).map(name).collect();
        let superfluous: Vec<String> = declared.difference(&found[k]).map(name).collect();
        if !(missing.is_empty() && superfluous.is_empty()) {
            wrong.push(format!("{}: missing {missing:?}, superfluous {superfluous:?}", variable.name));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A host may tell the element and connect no acceleration: the force's rate is then that under the element's own.
#[test]
fn without_an_acceleration_the_force_has_the_rate_of_the_element() {
    let start = |mass: f64, acceleration: f64| {
        let mut actuator = model(ACTUATOR);
        for (name, value) in [
            ("actuator.length", 0.5),
            ("actuator.speed", 0.05),
            ("actuator.acceleration", acceleration),
            ("actuator.reduced_mass", mass),
            ("actuator.holding_force", 500.0),
        ] {
            set(&mut actuator, name, value);
        }
        actuator.initialize().unwrap();
        actuator
    };
    let rate = |mut actuator: Model| {
        let force = reference(&actuator, "actuator.force");
        actuator.output_derivative(force, 1).unwrap()
    };
    let mut told = start(700.0, 0.0);
    let own = get(&mut told, "preview.start_acceleration");
    let expected = (get(&mut told, "actuator.force") - 500.0) / 700.0;
    assert!((own - expected).abs() < 1e-12 * expected.abs() && own != 0.0, "{own} {expected}");
    let (without, with) = (rate(told), rate(start(0.0, own)));
    assert_eq!(without.to_bits(), with.to_bits());
    // Without a mass an acceleration of 0 is what it says.
    assert_ne!(rate(start(0.0, 0.0)), with);
    // A connected acceleration is taken as it is.
    assert_eq!(rate(start(700.0, 2.0 * own)).to_bits(), rate(start(0.0, 2.0 * own)).to_bits());
}
