//! Couplings in a linkage: a rack, a planetary gear, trains, a geared five-bar.
use super::{FIVE_BAR, GEARS, assert_near, shafts};
use crate::support::{Run, Vec2, assert_says, changed};
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::reduced::Reduced;
use linkage_fmu::simulation::Simulation;
use serde_json::json;
use std::f64::consts::{PI, TAU};

/// A wheel of 0.2 m on a cart. It rolls on a rack of the ground with this slope, to the right of the wheel's axis.
fn rolling(slope: f64, second_is_rack: bool) -> String {
    let (first, second) =
        if second_is_rack { ("cart.origin", "ground.origin") } else { ("ground.origin", "cart.origin") };
    format!(
        r#"{{ "name": "Rolling", "gravity": {{ "acceleration": 9.81, "up_angle": 1.5707963267948966 }},
          "bodies": {{ "ground": {{}}, "cart": {{ "mass": 0.4 }}, "wheel": {{ "mass": 2, "inertia": 0.03 }} }},
          "joints": {{ "path": {{ "type": "prismatic", "first": "{first}", "second": "{second}",
              "axis_angle": {slope} }},
            "axle": {{ "type": "revolute", "first": "cart.origin", "second": "wheel.origin" }} }},
          "couplings": {{ "rack": {{ "type": "rack", "first": "wheel.origin", "joint": "path", "radius": 0.2,
              "side": "right" }} }},
          "start": {{ "joint": "path", "position": 0.1, "speed": 0 }}, "guess": {{ "path": 0, "wheel": 0.3 }} }}"#
    )
}

#[test]
fn a_wheel_rolls_down_a_slope() {
    let slope: f64 = -0.3;
    // m a = m g sin - F, J a / r = F r.
    let effective = 2.4 + 0.03 / 0.04;
    let acceleration = 2.4 * 9.81 * (-slope).sin() / effective;
    for second_is_rack in [false, true] {
        let sign = if second_is_rack { -1.0 } else { 1.0 };
        let mut run = Run::new(rolling(slope, second_is_rack)).started();
        run.steps(40, 4.0);
        let travelled = 0.5 * acceleration * 16.0;
        assert!((run.get("path.position") - 0.1 - sign * travelled).abs() < 1e-8 * travelled);
        assert_near(run.get("path.acceleration"), sign * acceleration, acceleration, "acceleration");
        // The wheel turns clockwise as it rolls to the right on the rack. The start is 0.1 m from the guess.
        let rolled = sign * run.get("path.position");
        assert_near(run.get("wheel.angle"), 0.3 - rolled / 0.2, rolled / 0.2, "angle");
        let along = Vec2::new(slope.cos(), slope.sin());
        let normal = Vec2::new(-slope.sin(), slope.cos());
        let tangential = 0.03 * acceleration / 0.04;
        // Forces on the rack: along the motion from the traction of the wheel, and downwards.
        let rack = run.force("rack");
        let expected = tangential * along - tangential * 20f64.to_radians().tan() * normal;
        assert!((rack - expected).norm() < 1e-12 * tangential, "{rack} {expected}");
        assert!(run.get("energy.drift").abs() < 1e-9 * run.get("energy.kinetic"));
    }
}

/// Planetary gear: sun of 24 teeth, ring of 72 teeth on the ground, planets of 24 teeth on an arm, with masses.
fn planetary(planets: usize) -> String {
    let mut bodies =
        json!({ "ground": {}, "sun": { "inertia": 0.01, "mass": 1 }, "arm": { "inertia": 0.2, "mass": 1 } });
    let mut joints = json!({
        "s": { "type": "revolute", "first": "ground.origin", "second": "sun.origin" },
        "c": { "type": "revolute", "first": "ground.origin", "second": "arm.origin" } });
    let (mut couplings, mut guess) = (json!({}), json!({ "sun": 0.2, "arm": 0.5 }));
    let mut points = json!({});
    for k in 0..planets {
        let angle = TAU * k as f64 / planets as f64;
        points[format!("p{k}")] = json!([0.1 * angle.cos(), 0.1 * angle.sin()]);
        bodies[format!("planet{k}")] = json!({ "mass": 0.7, "inertia": 0.003 });
        joints[format!("j{k}")] =
            json!({ "type": "revolute", "first": format!("arm.p{k}"), "second": format!("planet{k}.origin") });
        couplings[format!("inner{k}")] = json!({ "type": "gears", "first": "sun.origin",
            "second": format!("planet{k}.origin"),
            "carrier": "arm", "first_teeth": 24, "second_teeth": 24 });
        couplings[format!("outer{k}")] = json!({ "type": "gears", "first": "ground.origin", "internal": true,
            "second": format!("planet{k}.origin"), "carrier": "arm", "first_teeth": 72, "second_teeth": 24 });
        guess[format!("planet{k}")] = json!(0.7);
    }
    bodies["arm"]["points"] = points;
    json!({ "name": "Planetary", "bodies": bodies, "joints": joints, "couplings": couplings,
        "torques": { "motor": { "on": "sun", "torque": 5 }, "brake": { "on": "arm", "torque": -12 } },
        "start": { "body": "sun", "angle": 0.2, "speed": 0 }, "guess": guess })
    .to_string()
}

#[test]
fn a_planetary_gear_obeys_willis() {
    for planets in [1, 3] {
        let mut run = Run::new(planetary(planets)).started();
        // Willis: (omega_sun - omega_arm) / (0 - omega_arm) = -72 / 24. The planet turns -24/24 times the relative turn
        // of the sun.
        let (arm, planet) = (0.25, 0.25 - 0.75);
        let count = planets as f64;
        let inertia = 0.01 + arm * arm * (0.2 + count * 0.7 * 0.01) + count * 0.003 * planet * planet;
        let acceleration = (5.0 - 12.0 * arm) / inertia;
        run.steps(20, 2.0);
        let speed = run.get("sun.speed");
        assert!((speed - 2.0 * acceleration).abs() < 1e-8 * speed);
        assert_near(run.get("sun.acceleration"), acceleration, acceleration, "acceleration");
        assert_near(run.get("arm.speed") / speed, arm, 1.0, "arm");
        assert_near(run.get("planet0.speed") / speed, planet, 1.0, "planet");
        let turned = run.get("sun.angle") - 0.2;
        assert!((turned - 2.0 * acceleration).abs() < 1e-8 * turned);
        assert_near(run.get("arm.angle") - 0.5, arm * turned, turned, "angle of the arm");
        // Sun: J alpha = 5 - planets x force x radius 0.05. All planets carry equal loads.
        let expected = (0.01 * acceleration - 5.0) / (0.05 * count);
        for k in 0..planets {
            assert_near(run.get(&format!("inner{k}.transmitted_force")), expected, 100.0, "inner mesh");
        }
        // Planet: J alpha = (inner + outer) x radius, with the tangential forces.
        let (inner, outer) = (run.get("inner0.transmitted_force"), run.get("outer0.transmitted_force"));
        assert_near((inner + outer) * 0.05, 0.003 * planet * acceleration, 5.0, "planet");
        if planets == 3 {
            assert!(
                run.get("s.force") < 1e-10 && run.get("c.force") < 1e-10,
                "evenly loaded planets leave the hinges alone"
            );
        }
    }
}

#[test]
fn a_train_passes_on_the_product_of_its_ratios() {
    // one -> two by gears 17 : 43, two -> three by a belt 50 : 80, crossed.
    let text = changed(shafts(GEARS), |m| {
        m["bodies"]["three"] = json!({ "mass": 1, "inertia": 0.3 });
        m["bodies"]["ground"]["points"]["last"] = json!([0.7, 0.1]);
        m["joints"]["c"] = json!({ "type": "revolute", "first": "ground.last", "second": "three.origin" });
        m["couplings"]["belt"] = json!({ "type": "belt", "first": "two.origin", "second": "three.origin",
            "crossed": true,
            "first_radius": 0.05, "second_radius": 0.08 });
        m["guess"]["three"] = json!(0.0);
    });
    let mut run = Run::new(&text).started();
    let (i2, i3) = (-17.0 / 43.0, 17.0 / 43.0 * 5.0 / 8.0);
    let acceleration = (3.0 - i2) / (0.02 + i2 * i2 * 0.5 + i3 * i3 * 0.3);
    run.steps(10, 10.0);
    assert_near(run.get("one.acceleration"), acceleration, acceleration, "acceleration");
    let turned = run.get("one.angle") - 0.4;
    assert!((turned - 50.0 * acceleration).abs() < 1e-8 * turned);
    assert!(turned > 100.0 * TAU);
    assert!((run.get("three.angle") - i3 * turned).abs() < 1e-13 * turned);
}

#[test]
fn a_train_with_an_irrational_ratio_turns_without_end() {
    // Ratio 1 : sqrt(2): no number of revolutions returns both wheels to their start angles.
    let irrational = GEARS.replace("17", "1").replace("43", &2f64.sqrt().to_string());
    let definition = shafts(&irrational);
    let reduced = Reduced::new(&Mechanism::from_json(&definition).unwrap()).unwrap();
    assert!(reduced.period().is_none());
    assert!(reduced.curve().closed < 20_000, "{}", reduced.curve().closed);
    let mut run = Run::new(&definition).started();
    let ratio = -1.0 / 2f64.sqrt();
    let acceleration = (3.0 - ratio) / (0.02 + 0.5 * ratio * ratio);
    run.steps(100, 100.0);
    let turned = run.get("one.angle") - 0.4;
    assert!((turned - 0.5 * acceleration * 1e4).abs() < 1e-7 * turned);
    assert!((run.get("two.angle") - 1.1 - ratio * turned).abs() < 1e-13 * turned, "after {} revolutions", turned / TAU);
    // With integer numbers of teeth the curve is closed.
    let reduced = Reduced::new(&Mechanism::from_json(&shafts(GEARS)).unwrap()).unwrap();
    assert!(reduced.period().is_some());
}

/// A step beyond the span may reach farther than the motion. To trace the next part of the curve takes 0.5 ms.
#[test]
fn the_next_part_of_an_open_curve_is_traced_only_where_the_motion_needs_it() {
    let winch = include_str!("../../../modelDescription/GearTrain/resources/mechanism.json");
    let mut run = Run::new(winch).started();
    let stretches = |run: &mut Run| run.reduced().unwrap().stretches().count();
    run.steps(2000, 2.0);
    assert_eq!(stretches(&mut run), 0, "up to {} rad", run.get("pinion.angle"));
    run.steps(5000, 5.0);
    assert!(run.get("pinion.angle") > 700.0);
    assert_eq!(stretches(&mut run), 1);
}

#[test]
fn an_open_train_ends_where_angles_have_too_few_digits() {
    let irrational = GEARS.replace("17", "1").replace("43", &2f64.sqrt().to_string());
    let text = changed(shafts(&irrational), |m| {
        m["gravity"]["acceleration"] = json!(0);
        m["torques"] = json!({});
        m["start"]["speed"] = json!(1e6);
    });
    let mut run = Simulation::open(&text).unwrap();
    run.initialize().unwrap();
    let error = loop {
        if let Err(error) = run.step(10.0) {
            break error;
        }
    };
    let revolutions = 1e6 * run.time() / TAU;
    assert!((1e7..1e9).contains(&revolutions), "{revolutions}");
    let pieces =
        ["one = ", "revolutions", "rounding of the angle", "in mesh", "numbers of teeth", "reduce the loads", "stop"];
    assert_says(error, &pieces);
}

#[test]
fn a_geared_five_bar_balances_each_body() {
    let mut run = Run::new(FIVE_BAR).started();
    run.set("motor.torque", 4.0);
    run.set("push.force_x", 30.0);
    for step in 0..60 {
        run.step(0.05);
        let theta = ["one", "two", "rod", "bar"].map(|body| run.get(&format!("{body}.angle")));
        let omega = ["one", "two", "rod", "bar"].map(|body| run.get(&format!("{body}.speed")));
        let alpha = ["one", "two", "rod", "bar"].map(|body| run.get(&format!("{body}.acceleration")));
        let (lengths, masses) = ([0.1, 0.12, 0.35, 0.4], [1.5, 2.0, 0.8, 0.9]);
        assert!((theta[1] - 2.0 + 0.5 * (theta[0] - 0.6)).abs() < 1e-12 * theta[0].abs().max(1.0));
        let arm = |i: usize| lengths[i] * Vec2::new(theta[i].cos(), theta[i].sin());
        let turned = |v: Vec2| Vec2::new(-v.y, v.x);
        // Acceleration of the outer end of a body's rod relative to its inner end.
        let end = |i: usize| alpha[i] * turned(arm(i)) - omega[i] * omega[i] * arm(i);
        let bases = [Vec2::zeros(), Vec2::new(0.3, 0.0)];
        let origins = [bases[0], bases[1], bases[0] + arm(0), bases[1] + arm(1)];
        let tip = origins[2] + arm(2);
        assert!((tip - origins[3] - arm(3)).norm() < 1e-12);
        let base = [Vec2::zeros(), Vec2::zeros(), end(0), end(1)];
        let [a, b, c, d, e, mesh] = ["a", "b", "c", "d", "e", "mesh"].map(|joint| run.force(joint));
        let pitch = Vec2::new(0.3 / 3.0, 0.0);
        let (push, weight) = (Vec2::new(30.0, 0.0), Vec2::new(0.0, -9.81));
        let forces: [Vec<(Vec2, Vec2)>; 4] = [
            vec![(origins[0], a), (origins[2], -c), (pitch, -mesh)],
            vec![(origins[1], b), (origins[3], -d), (pitch, mesh)],
            vec![(origins[2], c), (tip, -e)],
            vec![(origins[3], d), (tip, e + push)],
        ];
        for i in 0..4 {
            let center = origins[i] + 0.5 * arm(i);
            let need = masses[i] * (base[i] + 0.5 * end(i) - weight);
            let mut sum = -need;
            let mut moment = if i == 0 { 4.0 } else { 0.0 } - masses[i] * lengths[i].powi(2) / 12.0 * alpha[i];
            let mut size: f64 = need.norm();
            for (at, force) in &forces[i] {
                sum += force;
                moment += (at - center).perp(force);
                size = size.max(force.norm());
            }
            assert!(
                sum.norm() < 1e-11 * size && moment.abs() < 1e-11 * size,
                "body {i} at step {step}: {sum} {moment} {size}"
            );
        }
        // The error is relative to the work of the motor.
        let work = 4.0 * (theta[0] - 0.6).abs();
        assert!(run.get("energy.drift").abs() < 1e-10 * work.max(1.0), "{}", run.get("energy.drift"));
    }
    assert!(run.get("one.angle").abs() > 4.0 * PI, "several turns");
}
