//! Joint friction: the paper's gear, its loop, its energy, its stiffness.
#![allow(clippy::unwrap_used)]

use linkage_fmu::model::Model;

const GEAR: &str = include_str!("../modelDescription/LandingGearRetraction/resources/mechanism.json");

fn set(model: &mut Model, values: &[(&str, f64)]) {
    for (name, value) in values {
        let reference = model.variables().find(name).unwrap();
        model.set_real(reference, *value).unwrap();
    }
}

fn get(model: &mut Model, name: &str) -> f64 {
    let reference = model.variables().find(name).unwrap();
    model.real(reference).unwrap()
}

fn gear(values: &[(&str, f64)]) -> Model {
    let mut model = Model::from_json(GEAR).unwrap();
    let reference = model.variables().find("friction.enabled").unwrap();
    model.set_boolean(reference, true).unwrap();
    set(&mut model, values);
    model.initialize().unwrap();
    model
}

/// Time at which the crank reaches this angle, found by one step to it and Newton's method on fresh runs.
fn time_at(angle: f64, first: f64, values: &[(&str, f64)]) -> f64 {
    let mut t = first;
    for _ in 0..20 {
        let mut model = gear(values);
        model.step(t).unwrap();
        let miss = angle - get(&mut model, "crank.angle");
        let step = miss / get(&mut model, "crank.speed");
        t += step;
        if step.abs() < 1e-13 {
            break;
        }
    }
    t
}

#[test]
fn the_gear_takes_as_long_as_the_reference() {
    // PHYSICS: mu 0.19 and 0.026, V_S 0.01, V_d 1.0 m/s, pins of 35 and 30 mm: 0.134488353 s.
    let stops = [("upstop.angle", -1.31), ("solver.tolerance", 1e-11)];
    let t = time_at(-1.3, 0.1344, &stops);
    println!("{t}");
    assert!((t - 0.134488353).abs() < 1e-8, "{t}");
}

#[test]
fn sweep() {
    for vs in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
        let run = |tol: f64| {
            let mut m =
                gear(&[("friction.static_speed", vs), ("friction.kinetic_speed", 2.0), ("solver.tolerance", tol)]);
            let clock = std::time::Instant::now();
            m.step(0.13).unwrap();
            (get(&mut m, "crank.angle"), get(&mut m, "energy.drift"), m.statistics(), clock.elapsed())
        };
        let tight = run(1e-13);
        println!("V_S {vs}: {} {:?}", tight.0, tight.2);
        for tol in [1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12] {
            let r = run(tol);
            println!(
                "  {tol:e}: error {:.1e} = {:.1} tol, drift {:.1e}, {:?} {:?}",
                (r.0 - tight.0).abs(),
                (r.0 - tight.0).abs() / tol,
                r.1,
                r.2,
                r.3
            );
        }
    }
}
