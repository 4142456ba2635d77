//! Directional derivatives and derivatives of outputs, against differences and closed forms.

use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind, Reference};

macro_rules! mechanism {
    ($name:literal) => {
        include_str!(concat!("../../modelDescription/", $name, "/resources/mechanism.json"))
    };
}

const ALL: [(&str, &str); 7] = [
    ("LandingGearRetraction", mechanism!("LandingGearRetraction")),
    ("AndrewsSqueezer", mechanism!("AndrewsSqueezer")),
    ("SliderCrank", mechanism!("SliderCrank")),
    ("CraneJib", mechanism!("CraneJib")),
    ("FourBar", mechanism!("FourBar")),
    ("Jib", mechanism!("Jib")),
    ("SlCrank", mechanism!("SlCrank")),
];

fn reference(model: &Model, name: &str) -> Reference {
    model.variables().find(name).unwrap_or_else(|| panic!("no {name}"))
}

fn set(model: &mut Model, name: &str, value: f64) {
    let r = reference(model, name);
    model.set_real(r, value).unwrap();
}

fn flag(model: &mut Model, name: &str, value: bool) {
    let r = reference(model, name);
    model.set_boolean(r, value).unwrap();
}

fn get(model: &mut Model, name: &str) -> f64 {
    let r = reference(model, name);
    model.real(r).unwrap()
}

fn of(model: &Model, causality: Causality) -> Vec<Reference> {
    let list = model.variables().list().iter().enumerate();
    list.filter(|(_, v)| v.causality == causality && v.kind == Kind::Real).map(|(i, _)| i as Reference).collect()
}

fn directional(model: &mut Model, unknowns: &[Reference], knowns: &[Reference], seeds: &[f64]) -> Vec<f64> {
    let mut values = vec![f64::NAN; unknowns.len()];
    model.directional_derivative(unknowns, knowns, seeds, &mut |i, value| values[i] = value).unwrap();
    values
}

/// A servo and, on the same slider-crank, a ram that loses half of its power.
fn two_drives() -> String {
    serde_json::json!({
        "name": "TwoDrives",
        "gravity": { "acceleration": 9.81, "up_angle": std::f64::consts::FRAC_PI_2 },
        "bodies": {
            "ground": {},
            "crank": { "length": 0.1, "mass": 1.2, "shape": "uniform_rod" },
            "rod": { "length": 0.3, "mass": 0.9, "shape": "uniform_rod" },
            "slider": { "mass": 0.5 }
        },
        "joints": {
            "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin", "pin_radius": 0.01 },
            "pin": { "type": "revolute", "first": "crank.end", "second": "rod.origin" },
            "wrist": { "type": "revolute", "first": "rod.end", "second": "slider.origin" },
            "guide": { "type": "prismatic", "first": "ground.origin", "second": "slider.origin" }
        },
        "actuators": {
            "servo": { "joint": "bearing", "torque": 3 },
            "ram": { "joint": "guide", "force": 50, "efficiency": 0.5 }
        },
        "friction": { "static_coefficient": 0.1, "kinetic_coefficient": 0.08 },
        "start": { "body": "crank", "angle": 0.9, "speed": 0 },
        "guess": { "crank": 0.9, "rod": -0.26, "guide": 0.35 }
    })
    .to_string()
}

/// States at which derivatives are asked for.
fn states() -> Vec<(String, Model)> {
    let mut all = Vec::new();
    for (name, json) in ALL {
        let mut model = Model::from_json(json).unwrap();
        model.initialize().unwrap();
        all.push((format!("{name} at its start"), model.clone()));
        // Well within its travel.
        model.step(0.013).unwrap();
        all.push((format!("{name} in motion"), model));
    }
    let json = ALL[0].1;
    for (name, friction, wind, airspeed) in
        [("friction", true, false, 0.0), ("wind", false, true, 40.0), ("friction and wind", true, true, -30.0)]
    {
        let mut model = Model::from_json(json).unwrap();
        flag(&mut model, "friction.enabled", friction);
        flag(&mut model, "air.relative_wind", wind);
        set(&mut model, "airspeed", airspeed);
        model.initialize().unwrap();
        for (what, h) in [("start", 1e-6), ("middle", 0.05), ("fast", 0.05)] {
            model.step(h).unwrap();
            all.push((format!("gear, {name}, {what}"), model.clone()));
        }
    }
    // Drives with an efficiency, in motion, driven back, and holding the gear at rest; a bumper in contact.
    let lossy = json.replace("\"force\": 30000", "\"force\": 30000, \"efficiency\": 0.6");
    for (what, force, factor, h) in
        [("driving", 30_000.0, 3.0, 0.05), ("driven back", -500.0, 3.0, 0.05), ("holding", -2_500.0, 3.0, 0.01)]
    {
        let mut model = Model::from_json(&lossy).unwrap();
        set(&mut model, "crank.start_angle", 0.5);
        set(&mut model, "load_factor", factor);
        set(&mut model, "actuator.force", force);
        model.initialize().unwrap();
        model.step(h).unwrap();
        all.push((format!("gear with an efficiency, {what}"), model));
    }
    // A lossy drive beside another: held by its losses, in motion, with friction.
    let two = two_drives();
    for (what, torque, demand, friction, speed) in [
        ("held", 4.0, 20.0, false, 0.0),
        ("held, with a pull", 6.0, -20.0, true, 0.0),
        ("in motion", 5.0, 20.0, false, 3.0),
        ("in motion with friction", 5.0, 20.0, true, -3.0),
    ] {
        let mut model = Model::from_json(&two).unwrap();
        set(&mut model, "servo.torque", torque);
        set(&mut model, "crank.start_speed", speed);
        set(&mut model, "servo.demanded_acceleration", demand);
        set(&mut model, "ram.demanded_acceleration", demand);
        flag(&mut model, "friction.enabled", friction);
        model.initialize().unwrap();
        all.push((format!("two drives, {what}"), model));
    }
    let mut model = Model::from_json(json).unwrap();
    flag(&mut model, "downstop.rigid", false);
    set(&mut model, "downstop.stiffness", 1e5);
    set(&mut model, "actuator.force", -30_000.0);
    model.initialize().unwrap();
    model.step(0.005).unwrap();
    assert!(get(&mut model, "downstop.torque") < -1.0);
    all.push(("gear on its bumper".into(), model));
    // Held by the down stop, by the lock there, and by up stop and lock.
    for (lock, force, h) in [("uplock", -3_000.0, 0.01), ("downlock", 30_000.0, 0.01), ("uplock", 30_000.0, 0.3)] {
        let mut model = Model::from_json(json).unwrap();
        set(&mut model, "actuator.force", force);
        flag(&mut model, &format!("{lock}.engage"), true);
        model.initialize().unwrap();
        model.step(h).unwrap();
        assert_eq!(get(&mut model, "crank.speed"), 0.0);
        all.push((format!("gear, held by {lock}, {force} N"), model));
    }
    all
}

#[test]
fn directional_derivatives_are_those_of_central_differences() {
    let mut compared = 0;
    for (name, model) in states() {
        let (outputs, inputs) = (of(&model, Causality::Output), of(&model, Causality::Input));
        for &input in &inputs {
            let mut model = model.clone();
            let value = model.real(input).unwrap();
            let slopes = directional(&mut model, &outputs, &[input], &[1.0]);
            // A width at which rounding and the third derivative are both small.
            let width = 1e-4 * value.abs().max(1.0);
            // Drag goes by v |v|, whose second derivative jumps at 0.
            let still = model.variables().list()[input as usize].name == "airspeed" && value == 0.0;
            let width = if still { 1e-4 * width } else { width };
            for (&output, slope) in outputs.iter().zip(slopes) {
                let v = model.variables().list()[output as usize].clone();
                let text = format!("{name}: d {} / d {}", v.name, model.variables().list()[input as usize].name);
                let mut at = |value: f64| {
                    model.set_real(input, value).unwrap();
                    model.real(output).unwrap()
                };
                let (low, high) = (at(value - width), at(value + width));
                if !v.dependencies.contains(&input) {
                    assert_eq!(slope, 0.0, "{text}");
                    assert!((high - low).abs() <= 1e-10 * (1.0 + high.abs()), "{text}: {low} {high}");
                    at(value);
                    continue;
                }
                let here = at(value);
                // A size that is 0 but for rounding has the direction of the rounding.
                if v.name.ends_with(".force") && here.abs() < 1e-12 {
                    continue;
                }
                let difference = (high - low) / (2.0 * width);
                let one_sided = [(high - here) / width, (here - low) / width];
                let near =
                    |d: f64| (slope - d).abs() <= 1e-6 * d.abs().max(slope.abs()) + 1e-11 * (1.0 + here.abs()) / width;
                assert!(
                    near(difference) || (one_sided.iter().any(|d| near(*d)) && !near(one_sided[0] * 2.0)),
                    "{text} = {slope}, differences {difference} {one_sided:?}, value {here}"
                );
                compared += usize::from(slope != 0.0);
            }
        }
    }
    assert!(compared > 500, "{compared}");
}

#[test]
fn several_knowns_give_the_sum_of_single_ones() {
    for (name, mut model) in states() {
        let (outputs, inputs) = (of(&model, Causality::Output), of(&model, Causality::Input));
        let seeds: Vec<f64> = (0..inputs.len()).map(|i| 0.7 - 0.9 * i as f64).collect();
        let all = directional(&mut model, &outputs, &inputs, &seeds);
        let mut sum = vec![0.0; outputs.len()];
        let mut size = vec![0.0; outputs.len()];
        for (input, seed) in inputs.iter().zip(&seeds) {
            for (i, one) in directional(&mut model, &outputs, &[*input], &[*seed]).into_iter().enumerate() {
                sum[i] += one;
                size[i] += one.abs();
            }
        }
        for i in 0..outputs.len() {
            let v = &model.variables().list()[outputs[i] as usize].name;
            assert!((all[i] - sum[i]).abs() <= 1e-10 * size[i] + 1e-12, "{name}: {v} {} {}", all[i], sum[i]);
        }
    }
}

#[test]
fn rates_of_outputs_are_those_of_central_differences_in_time() {
    let mut compared = 0;
    for (name, model) in states() {
        for moving in [false, true] {
            let mut start = model.clone();
            let inputs = of(&start, Causality::Input);
            let h = 2e-6;
            let rates: Vec<f64> =
                inputs.iter().map(|i| if moving { 40.0 * start.real(*i).unwrap() } else { 0.0 }).collect();
            let drive = |model: &mut Model| {
                for (input, rate) in inputs.iter().zip(&rates) {
                    model.set_input_derivative(*input, 1, *rate).unwrap();
                }
            };
            let outputs = of(&start, Causality::Output);
            // Values at five points, the rate at the third.
            let mut slopes = Vec::new();
            let mut values = Vec::new();
            for point in 0..5 {
                drive(&mut start);
                if point == 2 {
                    slopes = outputs.iter().map(|o| start.output_derivative(*o, 1).unwrap()).collect::<Vec<f64>>();
                }
                values.push(outputs.iter().map(|o| start.real(*o).unwrap()).collect::<Vec<f64>>());
                start.step(h).unwrap();
            }
            for i in 0..outputs.len() {
                let text = format!("{name}, {moving}: {}", start.variables().list()[outputs[i] as usize].name);
                let at = |point: usize| values[point][i];
                let difference = (8.0 * (at(3) - at(1)) - (at(4) - at(0))) / (12.0 * h);
                let scale = values.iter().fold(0.0, |m: f64, v| m.max(v[i].abs()));
                // Rounding; kinks where a drive or a stop acts.
                let tolerance = 1e-6 * difference.abs().max(slopes[i].abs()) + 2e-10 * (1.0 + scale) / h;
                let kink = (at(3) - 2.0 * at(2) + at(1)).abs() > 0.5 * (at(3) - at(1)).abs();
                assert!((slopes[i] - difference).abs() <= tolerance || kink, "{text}: {} {difference}", slopes[i]);
                compared += usize::from(slopes[i] != 0.0);
            }
        }
    }
    assert!(compared > 500, "{compared}");
}

#[test]
fn rates_of_positions_and_speeds_are_speeds_and_accelerations() {
    let (_, json) = ALL[0];
    let mut model = Model::from_json(json).unwrap();
    model.initialize().unwrap();
    model.step(0.05).unwrap();
    for (output, rate) in [
        ("crank.angle", "crank.speed"),
        ("crank.speed", "crank.acceleration"),
        ("actuator.length", "actuator.speed"),
        ("actuator.speed", "actuator.acceleration"),
        ("wheel.x", "wheel.velocity_x"),
        ("wheel.velocity_y", "wheel.acceleration_y"),
    ] {
        let (r, expected) = (reference(&model, output), get(&mut model, rate));
        let told = model.output_derivative(r, 1).unwrap();
        assert!((told - expected).abs() <= 1e-12 * expected.abs(), "{output}: {told} {expected}");
    }
    // Power: the rate of the kinetic energy.
    let r = reference(&model, "energy.kinetic");
    let power = model.output_derivative(r, 1).unwrap();
    let potential = reference(&model, "energy.potential");
    let of_actuator = get(&mut model, "actuator.force") * get(&mut model, "actuator.speed");
    let lost = power + model.output_derivative(potential, 1).unwrap() - of_actuator;
    assert!(lost.abs() < 1e-9 * of_actuator.abs(), "{lost}");
}

#[test]
fn what_has_no_derivative_is_refused_by_name() {
    let mut model = Model::from_json(ALL[0].1).unwrap();
    model.initialize().unwrap();
    let find = |name: &str| reference(&model, name);
    let (force, length, angle) = (find("actuator.force"), find("crank.length"), find("crank.angle"));
    let flag =
        model.variables().list().iter().position(|v| v.causality == Causality::Output && v.kind == Kind::Boolean);
    let flag = flag.unwrap() as Reference;
    let mut none = |_: usize, _: f64| {};
    let mut refused = |unknown: Reference, known: Reference, seed: f64, name: &str| {
        let error = model.directional_derivative(&[unknown], &[known], &[seed], &mut none).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    };
    refused(force, force, 1.0, "actuator.force");
    refused(flag, force, 1.0, "retracted");
    refused(angle, length, 1.0, "crank.length");
    refused(angle, angle, 1.0, "crank.angle");
    refused(angle, force, f64::NAN, "actuator.force");
    refused(9999, force, 1.0, "9999");
    for order in [0, 2, -1] {
        assert!(model.output_derivative(angle, order).unwrap_err().to_string().contains("crank.angle"));
    }
    assert!(model.output_derivative(flag, 1).is_err() && model.output_derivative(force, 1).is_err());
    let method = reference(&model, "solver.method");
    model.set_text(method, "rigid_fem").unwrap();
    let error = model.directional_derivative(&[angle], &[force], &[1.0], &mut |_, _| {}).unwrap_err();
    assert!(error.to_string().contains("rigid_fem"), "{error}");
    assert!(model.output_derivative(angle, 1).unwrap_err().to_string().contains("rigid_fem"));
}

/// Bare cost; run with --release -- --ignored --nocapture.
#[test]
#[ignore = "a timing"]
fn four_by_three_costs_less_than_five_evaluations() {
    for friction in [false, true] {
        let mut model = Model::from_json(ALL[0].1).unwrap();
        self::flag(&mut model, "friction.enabled", friction);
        model.initialize().unwrap();
        model.step(0.05).unwrap();
        let outputs = ["crank.acceleration", "joint2.force", "actuator.static_load", "wheel.acceleration_x"];
        let outputs = outputs.map(|n| reference(&model, n));
        let inputs = ["actuator.force", "load_factor", "airspeed"].map(|n| reference(&model, n));
        let mut value = 30_000.0;
        let mut evaluate = |model: &mut Model| {
            value += 1.0;
            model.set_real(inputs[0], value).unwrap();
            outputs.iter().map(|o| model.real(*o).unwrap()).sum::<f64>()
        };
        evaluate(&mut model);
        let clock = std::time::Instant::now();
        (0..100_000).for_each(|_| {
            std::hint::black_box(evaluate(&mut model));
        });
        let values = clock.elapsed();
        let mut both = |model: &mut Model| {
            evaluate(model);
            let mut sum = 0.0;
            model.directional_derivative(&outputs, &inputs, &[1.0, 0.1, 0.2], &mut |_, v| sum += v).unwrap();
            sum
        };
        both(&mut model);
        let clock = std::time::Instant::now();
        (0..100_000).for_each(|_| {
            std::hint::black_box(both(&mut model));
        });
        let both = clock.elapsed();
        let ratio = both.as_secs_f64() / values.as_secs_f64() - 1.0;
        println!("friction {friction}: outputs {values:?}, with derivatives {both:?}, ratio {ratio:.2}");
        assert!(ratio < 5.0, "{ratio}");
    }
}
