//! Derivatives of outputs by inputs and in time against differences.
use super::{Host, SYSTEM};

/// Directional derivatives of all outputs by each input, and rates in time, against differences.
#[test]
fn derivatives_are_those_of_the_values() {
    let text = SYSTEM.replace("1e-9", "1e-13").replace(r#""command": 1,"#, r#""command": 0.5,"#);
    let mut host = Host::start(&text);
    host.run(0.06, 1e-3);
    for name in ["gear", "door"] {
        let (length, lower, upper) = if name == "gear" { (0.6, 0.4185, 0.735) } else { (0.4, 0.305, 0.495) };
        host.set(&format!("{name}.length"), length);
        host.set(&format!("{name}.speed"), 0.02);
        host.set(&format!("{name}.lower_limit"), lower);
        host.set(&format!("{name}.upper_limit"), upper);
        host.set(&format!("{name}.reduced_mass_derivative"), 30.0);
        host.set(&format!("{name}.holding_force_derivative"), 2e3);
        host.set(&format!("{name}.acceleration"), 0.1);
    }
    host.set("gear_dump.open", 0.3);
    host.set("preview.horizon", 2e-3);
    let list = host.0.variables().list().to_vec();
    let is = |v: &foundation::variables::Variable| v.is_output() && v.kind == foundation::variables::Kind::Real;
    let outputs: Vec<u32> = (0..list.len()).filter(|i| is(&list[*i])).map(|i| i as u32).collect();
    let inputs: Vec<usize> =
        (0..list.len()).filter(|i| list[*i].causality == foundation::variables::Causality::Input).collect();
    // Two points: before and after a step, so that the element has a past.
    for _ in 0..2 {
        let mut checked = 0;
        for &input in &inputs {
            let value = host.0.real(input as u32).unwrap();
            let step = match list[input].unit.unwrap().name() {
                "Pa" => 3e2,
                "kg" => 1e-2,
                "N" => 1.0,
                "N/m" => 10.0,
                "kg/m" => 0.1,
                "s" => 1e-6,
                "m" => 1e-7,
                "m/s" => 1e-5,
                _ => 1e-4,
            };
            if value == 0.0 && list[input].name.ends_with("open") || list[input].name.ends_with("limit") {
                continue;
            }
            let mut exact = vec![0.0; outputs.len()];
            host.0.directional_derivative(&outputs, &[input as u32], &[1.0], &mut |i, d| exact[i] = d).unwrap();
            let mut at = |factor: f64| {
                host.0.set_real(input as u32, value + factor * step).unwrap();
                outputs.iter().map(|output| host.0.real(*output).unwrap()).collect::<Vec<f64>>()
            };
            let [minus, plus] = [at(-1.0), at(1.0)];
            let [minus2, plus2] = [at(-2.0), at(2.0)];
            let here = at(0.0);
            for (i, output) in outputs.iter().enumerate() {
                let difference = (8.0 * (plus[i] - minus[i]) - (plus2[i] - minus2[i])) / (12.0 * step);
                // Rounding of the values, and of a motion at tolerance 1e-13, over the step.
                let size = here[i].abs().max(plus2[i].abs()).max(1e-9);
                let allowed = 2e-6 * difference.abs().max(exact[i].abs()) + 1e-10 * size / step;
                let (name, by) = (&list[*output as usize].name, &list[input].name);
                assert!((exact[i] - difference).abs() <= allowed, "{name} by {by}: {} {difference}", exact[i]);
                let depends = list[*output as usize].dependencies.contains(&(input as u32));
                assert!(depends || exact[i] == 0.0, "{name} depends on {by}");
                checked += usize::from(exact[i] != 0.0);
            }
        }
        assert!(checked > 200, "{checked}");
        host.0.step(2e-3).unwrap();
    }
}

/// Rates of outputs in time, against differences over steps under the motion of the inputs.
#[test]
fn rates_are_those_of_the_outputs() {
    let text = SYSTEM.replace("1e-9", "1e-13").replace("\"reduced_mass\": 700", "\"reduced_mass\": 0");
    let mut host = Host::of(&text.replace("\"reduced_mass\": 60", "\"reduced_mass\": 0"));
    host.set("gear.length", 0.6);
    host.0.initialize().unwrap();
    host.run(0.06, 1e-3);
    let list = host.0.variables().list().to_vec();
    let is = |v: &foundation::variables::Variable| v.is_output() && v.kind == foundation::variables::Kind::Real;
    let outputs: Vec<u32> =
        (0..list.len()).filter(|i| is(&list[*i]) && !list[*i].name.contains("preview")).map(|i| i as u32).collect();
    let snapshot = host.0.snapshot();
    let h = 1e-5;
    let mut at = |time: f64| {
        host.0.restore(&snapshot).unwrap();
        host.set("gear.speed", 0.03);
        host.rate("gear.speed", 1, 0.5);
        host.set("gear.acceleration", 0.5);
        if time > 0.0 {
            host.0.step(time).unwrap();
        }
        let rates: Vec<f64> = outputs.iter().map(|o| host.0.output_derivative(*o, 1).unwrap()).collect();
        let values: Vec<f64> = outputs.iter().map(|o| host.0.real(*o).unwrap()).collect();
        (rates, values)
    };
    let (_, v0) = at(0.0);
    let (_, v1) = at(h);
    let (rates, v2) = at(2.0 * h);
    let (_, v3) = at(3.0 * h);
    let (_, v4) = at(4.0 * h);
    for i in 0..outputs.len() {
        let difference = (8.0 * (v3[i] - v1[i]) - (v4[i] - v0[i])) / (12.0 * h);
        let allowed = 1e-4 * difference.abs().max(rates[i].abs()) + 1e-10 * v2[i].abs().max(1e-9) / h + 1e-12;
        let name = &list[outputs[i] as usize].name;
        assert!((rates[i] - difference).abs() <= allowed, "{name}: {} {difference}", rates[i]);
    }
}
