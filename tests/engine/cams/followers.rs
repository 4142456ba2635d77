//! Cams and their followers: lift, balance of each body, loss of contact, derivatives.
use super::{ROLLER, oscillating, parsed, translating};
use crate::support::{Run, Vec2, assert_near, assert_says, changed, turned};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// Lift and its first two derivatives according to VDI 2143.
pub fn lift(law: &str, rise: f64, u: f64) -> [f64; 3] {
    let u = u.rem_euclid(TAU);
    let unit = |x: f64| match law {
        "cycloidal" => [x - (TAU * x).sin() / TAU, 1.0 - (TAU * x).cos(), TAU * (TAU * x).sin()],
        "polynomial_345" => [
            x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x),
            30.0 * x * x * (1.0 - x).powi(2),
            60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
        ],
        _ => [
            x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3)),
            140.0 * (x * (1.0 - x)).powi(3),
            420.0 * (x * (1.0 - x)).powi(2) * (1.0 - 2.0 * x),
        ],
    };
    let scaled = |x: f64, length: f64, sign: f64, base: f64| {
        let [s, v, a] = unit(x / length);
        [base + sign * rise * s, sign * rise * v / length, sign * rise * a / length / length]
    };
    match u {
        u if u < 1.6 => scaled(u, 1.6, 1.0, 0.0),
        u if u < 2.3 => [rise, 0.0, 0.0],
        u if u < 4.5 => scaled(u - 2.3, 2.2, -1.0, rise),
        _ => [0.0; 3],
    }
}

#[test]
fn a_translating_follower_balances_with_its_cam() {
    let mut lifted = [false; 2];
    for law in ["cycloidal", "polynomial_345", "polynomial_4567"] {
        for is_flat in [false, true] {
            let follower = if is_flat { json!({ "follower": "flat" }) } else { parsed(ROLLER) };
            let mut run = Run::new(translating(law, follower)).started();
            // Position of the origin of the stem at zero lift. The tip of the stem is 0.08 m below its origin.
            let offset = if is_flat { 0.0 } else { 0.012 };
            let radius = if is_flat { 0.04 } else { 0.05 };
            let height = f64::sqrt(radius * radius - offset * offset);
            for step in 0..150 {
                run.step(0.01);
                let what = format!("{law} {is_flat} step {step}");
                let [theta, omega, alpha] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("disc.{o}")));
                let [s, s1, s2] = lift(law, 0.02, theta - 0.5);
                let position = -0.02 - 0.2 + 0.08 + height + s;
                assert_near(run.get("guide.position"), position, 1e-14, &what);
                assert_near(run.get("guide.speed"), s1 * omega, 1e-13 * omega.abs(), &what);
                let up = s1 * alpha + s2 * omega * omega;
                let sizes = [0.6 * up, 1000.0 * 0.06, 20.0, 0.005 * 1.2 * omega * omega];
                let size = sizes.iter().fold(1.0_f64, |most, size| most.max(size.abs()));
                assert_near(run.get("guide.acceleration"), up, 1e-12 * size / 0.6, &what);
                // Follower: contact, spring, weight.
                let contact = run.get("cam.contact_force");
                let spring = 1000.0 * (position + 0.12);
                let vertical = 0.6 * (up + 9.81) + spring;
                let (angle, at) = if is_flat {
                    // The flat face touches the cam at the distance s' from the axis of the cam.
                    (0.0, Vec2::new(s1, height + s))
                } else {
                    (f64::atan2(s1 - offset, height + s), Vec2::new(0.012, height + s))
                };
                assert_near(run.get("cam.pressure_angle"), angle, 1e-13, &what);
                assert_near(contact * angle.cos(), vertical, 1e-11 * size, &what);
                let normal = Vec2::new(-angle.sin(), angle.cos());
                let mesh = run.force("cam");
                assert!((mesh - contact * normal).norm() < 1e-11 * size, "{what}: {mesh} {contact} {angle}");
                // Cam: bearing, weight, contact; moments about its axis.
                let arm = turned(Vec2::new(0.005, 0.002), theta);
                let moved = alpha * turned(arm, PI / 2.0) - omega * omega * arm;
                let bearing = run.force("bearing");
                let weight = Vec2::new(0.0, -1.2 * 9.81);
                assert!((bearing + weight - mesh - 1.2 * moved).norm() < 1e-11 * size, "{what}");
                let inertia = 0.004 + 1.2 * arm.norm_squared();
                let moment = 0.5 + arm.perp(&weight) - at.perp(&mesh);
                assert_near(inertia * alpha, moment, 1e-11 * size * 0.1, &what);
                // Guide: the side force, and its moment about the stem's origin.
                let guide = run.force("guide");
                assert_near(guide.x, -mesh.x, 1e-11 * size, &what);
                let from_origin = Vec2::new(0.05 + at.x - 0.062, -0.02 + at.y - 0.2 - position);
                let torque = run.get("guide.torque");
                assert_near(torque + from_origin.perp(&mesh), 0.0, 1e-11 * size * 0.1, &what);
                lifted[usize::from(contact < 0.0)] = true;
                let drift = run.get("energy.drift");
                assert!(drift.abs() < 1e-10 * run.get("energy.kinetic").max(1.0), "{what}: {drift}");
            }
            assert!(run.get("disc.angle").abs() > TAU);
        }
    }
    assert_eq!(lifted, [true; 2], "the cam presses and holds back");
}

#[test]
fn an_oscillating_follower_balances_with_its_cam() {
    let pivot = Vec2::new(0.14, 0.03);
    for law in ["cycloidal", "polynomial_345", "polynomial_4567"] {
        for is_flat in [false, true] {
            let follower = if is_flat { json!({ "follower": "flat" }) } else { parsed(ROLLER) };
            let mut run = Run::new(oscillating(law, follower)).started();
            let mut start = None;
            for step in 0..150 {
                run.step(0.01);
                let what = format!("{law} {is_flat} step {step}");
                let [theta, omega, alpha] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("disc.{o}")));
                let [phi, second, psi] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("lever.{o}")));
                let [s, s1, s2] = lift(law, 0.25, theta + 0.3);
                // A lift turns the lever clockwise, away from the cam below the end of the lever.
                let zero = *start.get_or_insert(phi + s);
                assert_near(phi, zero - s, 1e-13 * theta.abs().max(1.0), &what);
                assert_near(second, -s1 * omega, 1e-12 * omega.abs(), &what);
                let size = (0.3 * 0.02 * s2.abs() * omega * omega + 5.0) / 0.05;
                assert_near(psi, -s1 * alpha - s2 * omega * omega, 1e-11 * size, &what);
                let arm = turned(Vec2::new(0.16, 0.0), phi);
                let along = arm / 0.16;
                // On the base circle.
                let zeroed = turned(Vec2::new(1.0, 0.0), zero);
                let distance = if is_flat { pivot.perp(&zeroed).abs() } else { (pivot + 0.16 * zeroed).norm() };
                assert_near(distance, if is_flat { 0.04 } else { 0.05 }, 1e-14, &what);
                // At the contact point both velocities have the same normal component: cam omega x r, lever second x (r
                // - pivot).
                let (at, normal) = if is_flat {
                    let normal = turned(along, -PI / 2.0);
                    let normal = if along.perp(&-pivot) > 0.0 { normal } else { -normal };
                    // n . perp(r) = -s1 n . perp(r - pivot) on the line pivot + t along.
                    let rate = |r: Vec2, ratio: f64| ratio * normal.dot(&turned(r, PI / 2.0));
                    let t = -rate(pivot, 1.0) / (rate(along, 1.0) + rate(along, s1));
                    (pivot + t * along, normal)
                } else {
                    let center = pivot + arm;
                    let relative = -s1 * turned(arm, PI / 2.0) - turned(center, PI / 2.0);
                    (center, turned(relative, PI / 2.0).normalize())
                };
                let contact = run.get("cam.contact_force");
                let mesh = run.force("cam");
                assert!((mesh - contact * normal).norm() < 1e-11 * size, "{what}: {mesh} {contact} {normal}");
                // A lift turns the lever clockwise.
                let lifts = turned(at - pivot, -PI / 2.0);
                let angle = lifts.perp(&normal).atan2(lifts.dot(&normal));
                assert_near(run.get("cam.pressure_angle"), angle, 1e-12, &what);
                assert!(angle.abs() < 1.2, "{what}: {angle}");
                // Euler's equations of cam and lever. The centre of mass of the lever is at half its length.
                assert_near(0.004 * alpha, -0.5 - at.perp(&mesh), 1e-12 * size, &what);
                let inertia = 0.3 * 0.16 * 0.16 / 3.0;
                assert_near(inertia * psi, 1.5 + (at - pivot).perp(&mesh), 1e-11 * size, &what);
                let center = 0.5 * (psi * turned(arm, PI / 2.0) - second * second * arm);
                let (pin, bearing) = (run.force("pin"), run.force("bearing"));
                assert!((pin + mesh - 0.3 * center).norm() < 1e-11 * size, "{what}");
                assert!((bearing - mesh).norm() < 1e-11 * size, "{what}");
                let drift = run.get("energy.drift");
                assert!(drift.abs() < 1e-10 * run.get("energy.kinetic").max(1.0), "{what}: {drift}");
            }
            assert!(run.get("disc.angle").abs() > TAU);
        }
    }
}

#[test]
fn a_follower_that_lifts_off_gives_one_warning() {
    let run = |change: &dyn Fn(&mut Value)| {
        let text = changed(translating("polynomial_345", parsed(ROLLER)), |m| {
            m["solver"]["tolerance"] = json!(1e-9);
            change(m);
        });
        let mut run = Run::new(&text).started();
        let (mut warnings, mut first) = (Vec::new(), None);
        for k in 0..150 {
            let point = 3.0 + 0.01 * f64::from(k);
            let before = run.snapshot();
            run.0.model_mut().step_from(Some(point), 0.01).unwrap();
            if let Some(warning) = run.0.model_mut().take_warning() {
                // After a rollback the repeated step gives the same warning.
                run.restore(&before).unwrap();
                run.0.model_mut().step_from(Some(point), 0.01).unwrap();
                assert_eq!(run.0.model_mut().take_warning().as_ref(), Some(&warning));
                warnings.push(warning);
            }
            let force = run.get("cam.contact_force");
            if force < 0.0 {
                first = first.or(Some((point + 0.01, force)));
            }
        }
        (warnings, first)
    };
    let (warnings, first) = run(&|_| {});
    let (time, force) = first.unwrap();
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    let (time, force) = (format!("at t = {time} s"), format!("{force:.3}"));
    assert_says(
        warning,
        &["cam.contact_force", "lift off", &time[..10], &force[..5], "spring", "couplings.cam", "grooved"],
    );
    // With a stronger spring, or with a groove, there is no warning.
    let (warnings, first) = run(&|m| m["springs"]["spring"]["preload"] = json!(900));
    assert!(warnings.is_empty() && first.is_none(), "{warnings:?} {first:?}");
    let (warnings, first) = run(&|m| m["couplings"]["cam"]["grooved"] = json!(true));
    assert!(warnings.is_empty() && first.is_some(), "{warnings:?}");
    // Without loads and motion the contact force is 0, which is not a loss of contact.
    let (warnings, first) = run(&|m| {
        m["gravity"]["acceleration"] = json!(0);
        m["torques"]["motor"]["torque"] = json!(0);
        m["start"]["speed"] = json!(0);
        m["springs"]["spring"]["stiffness"] = json!(0);
    });
    assert!(warnings.is_empty(), "{warnings:?} {first:?}");
}
