//! Outputs of the key `by_body`: the values of all bodies add up to those of the mechanism. The reduced mass of each
//! body agrees with its kinetic energy from finite differences of its positions.
use super::worst::{Worst, wave};
use crate::support::{FOUR_BAR, GEAR, Run, TWO_DRIVES, changed};
use serde_json::{Value, json};

/// A definition in which every drive has the key `by_body`.
fn by_body(definition: &str, change: impl FnOnce(&mut Value)) -> String {
    changed(definition, |m| {
        change(m);
        m["actuators"].as_object_mut().unwrap().values_mut().for_each(|drive| drive["by_body"] = json!(true));
    })
}

/// In this state the reduced mass and the static load of each drive are the sums over the bodies.
fn add_up(worst: &mut Worst, run: &mut Run, drives: &[(&str, &str)], bodies: &[&str]) {
    for (drive, mass) in drives {
        for (what, suffix) in [("reduced mass", *mass), ("static load", "static_load")] {
            let parts: Vec<f64> = bodies.iter().map(|body| run.get(&format!("{drive}.{body}.{suffix}"))).collect();
            let size = parts.iter().fold(0.0, |size: f64, part| size.max(part.abs()));
            worst.compare(what, parts.iter().sum(), run.get(&format!("{drive}.{suffix}")), size);
        }
    }
}

#[test]
fn the_bodies_of_the_gear_add_up_under_loads_of_every_kind() {
    let text = by_body(GEAR, |m| {
        m["actuators"]["actuator"]["efficiency"] = json!(0.9);
        m["actuators"]["jack"] =
            json!({ "first": "ground.end", "second": "leg.end", "points": [[-9, 800], [0, 500], [9, 100]] });
        m["springs"] = json!({
            "strut": { "first": "ground.end", "second": "wheel.origin", "stiffness": 4e3, "damping": 60 },
            "hinge": { "joint": "joint2", "stiffness": 30, "damping_points": [[-9, -40], [0, 0], [9, 60]] },
        });
        m["torques"]["constant"] = json!({ "on": "coupler", "torque": 35, "constant": true });
        m["stops"]["upstop"] = json!({ "body": "crank", "limit": "lower", "angle": -0.4, "rigid": false,
            "stiffness": 3e4, "damping": 80 });
        m["stops"].as_object_mut().unwrap().remove("downstop");
        m.as_object_mut().unwrap().remove("locks");
        m["air"]["relative_wind"] = json!(true);
        m["friction"]["enabled"] = json!(true);
    });
    let (mut run, mut worst) = (Run::new(text), Worst::default());
    for k in 0..100 {
        let angle = 0.8 - 0.0209 * f64::from(k);
        run.place(("crank.start_angle", angle), ("crank.start_speed", 8.0 * wave(k, 0.7)));
        run.set_all(&[("airspeed", 70.0 * wave(k, 1.1)), ("load_factor", 3.0 * wave(k, 1.3)), ("jack.force", 2e3)]);
        run.set_all(&[("actuator.force", 3e4 * wave(k, 1.7)), ("jack.command", wave(k, 1.9))]);
        run.set_all(&[("wheel.force_x", 4e3 * wave(k, 2.1)), ("wheel.force_y", 900.0), ("follower.torque", 250.0)]);
        let drives = [("actuator", "reduced_mass"), ("jack", "reduced_mass")];
        add_up(&mut worst, &mut run, &drives, &["crank", "coupler", "follower"]);
    }
    // With friction the load of each body is a sum of larger terms.
    worst.assert_within(1e-10);
}

#[test]
fn the_bodies_add_up_for_drives_in_joints() {
    let (mut run, mut worst) = (Run::new(by_body(TWO_DRIVES, |_| ())), Worst::default());
    for k in 0..100 {
        run.place(("crank.start_angle", 0.2 + 0.027 * f64::from(k)), ("crank.start_speed", 20.0 * wave(k, 0.7)));
        run.set_all(&[("servo.torque", 5.0 * wave(k, 1.1)), ("ram.force", 90.0 * wave(k, 1.3))]);
        run.set("friction.enabled", k % 2 == 0);
        let drives = [("servo", "reduced_inertia"), ("ram", "reduced_mass")];
        add_up(&mut worst, &mut run, &drives, &["crank", "rod", "slider"]);
    }
    worst.assert_within(1e-11);
}

/// T = m_i v_S^2 / 2 of a body, with its velocity and angular speed as central differences of its frame over 2 h, whose
/// error is of the order h^2.
#[test]
fn the_reduced_mass_of_a_body_has_its_kinetic_energy() {
    const H: f64 = 1e-5;
    let mut run = Run::new(by_body(GEAR, |_| ())).started();
    // Masses, centres of mass (along and across the crank: rod, leg, wheel) and moments of inertia.
    let leg = |part: f64| [part * (-2.4f64).cos(), part * (-2.4f64).sin()];
    let rod = |mass: f64, length: f64| vec![(mass, [0.5 * length, 0.0], mass * length * length / 12.0)];
    let mut crank = rod(13.689, 0.1755);
    crank.extend([(36.8, leg(0.5 * 0.759), 36.8 * 0.759 * 0.759 / 12.0), (19.5, leg(0.759), 0.0)]);
    let bodies = [("crank", crank), ("coupler", rod(0.72037056, 0.217)), ("follower", rod(3.850704, 0.34))];
    let frames = |run: &mut Run| {
        bodies.each_ref().map(|(name, _)| ["x", "y", "cos", "sin"].map(|part| run.get(&format!("{name}.frame.{part}"))))
    };
    for _ in 0..10 {
        run.step(0.012);
        let before = frames(&mut run);
        run.step(H);
        let speed = run.get("actuator.speed");
        let parts = bodies.each_ref().map(|(name, _)| run.get(&format!("actuator.{name}.reduced_mass")));
        run.step(H);
        let after = frames(&mut run);
        for (k, (name, masses)) in bodies.iter().enumerate() {
            let [[x0, y0, c0, s0], [x1, y1, c1, s1]] = [before[k], after[k]];
            let turned = (s1 * c0 - c1 * s0).asin() / (2.0 * H);
            let energy: f64 = masses
                .iter()
                .map(|(mass, [x, y], inertia)| {
                    let u = (x1 - x0 + (c1 - c0) * x - (s1 - s0) * y) / (2.0 * H);
                    let v = (y1 - y0 + (s1 - s0) * x + (c1 - c0) * y) / (2.0 * H);
                    0.5 * mass * (u * u + v * v) + 0.5 * inertia * turned * turned
                })
                .sum();
            let ours = 0.5 * parts[k] * speed * speed;
            assert!((ours - energy).abs() < 1e-5 * energy, "{name}: {ours} J instead of {energy} J");
        }
    }
}

#[test]
fn only_the_key_adds_the_outputs() {
    let names = |text: &str| {
        let run = Run::new(text);
        run.variables().list().iter().map(|variable| variable.name.clone()).collect::<Vec<_>>()
    };
    let (plain, more) = (names(FOUR_BAR), names(&by_body(FOUR_BAR, |_| ())));
    let own: Vec<_> = more.iter().filter(|name| !plain.contains(name)).collect();
    let expected = ["coupler", "crank", "rocker"].map(|body| {
        ["reduced_inertia", "static_load", "effective_radius", "ratio"].map(|suffix| format!("drive.{body}.{suffix}"))
    });
    assert!(own.into_iter().eq(expected.iter().flatten()));
}

/// Central differences over 2 h have an error of the order h^2, and rounding of 1e-16 / h.
#[test]
fn the_rates_of_the_outputs_are_exact() {
    const H: f64 = 1e-5;
    let text = by_body(GEAR, |m| {
        m["springs"] = json!({ "strut": { "first": "ground.end", "second": "wheel.origin", "damping": 60 } });
        m["friction"]["enabled"] = json!(true);
        m["start"]["speed"] = json!(-3);
    });
    let mut run = Run::new(text).with(&[("airspeed", 70.0)]).started();
    let suffixes = ["reduced_mass", "static_load", "ratio", "effective_radius"];
    let names = ["crank", "coupler", "follower"].map(|body| suffixes.map(|s| format!("actuator.{body}.{s}")));
    for _ in 0..5 {
        run.step(0.015);
        let before = names.each_ref().map(|body| body.each_ref().map(|name| run.get(name)));
        run.step(H);
        let now = names.each_ref().map(|body| body.each_ref().map(|name| run.get(name)));
        let rates = names.each_ref().map(|body| body.each_ref().map(|name| run.derivative(name)));
        run.step(H);
        for (k, name) in names.iter().flatten().enumerate() {
            let (first, middle, rate, last) =
                (before[k / 4][k % 4], now[k / 4][k % 4], rates[k / 4][k % 4], run.get(name));
            // The ratio has a pole where a body does not rotate. Its inverse is smooth.
            let (first, rate, last) =
                if k % 4 < 2 { (first, rate, last) } else { (1.0 / first, -rate / (middle * middle), 1.0 / last) };
            let difference = (last - first) / (2.0 * H);
            assert!((rate - difference).abs() < 1e-5 * (rate.abs() + first.abs()), "{name}: {rate} and {difference}");
        }
    }
}
