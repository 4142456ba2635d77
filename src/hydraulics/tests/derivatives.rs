//! Derivatives of outputs by inputs and in time against differences.
use super::*;

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
