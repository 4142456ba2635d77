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
    [0.01, 472_875.119_061, 10_911_388.8511, 0.392_357_384_677, -11_544.873_288],
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
