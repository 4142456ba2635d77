//! Couplings of variable ratio against closed forms and Newton and Euler: elliptic gears, and cams with followers that
//! slide or turn, with rollers or flat faces.

use crate::support::{Run, Vec2, assert_says, changed, turned};
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::reduced::Reduced;
use linkage_fmu::simulation::Simulation;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

fn force(run: &mut Run, joint: &str) -> Vec2 {
    Vec2::new(run.get(&format!("{joint}.force_x")), run.get(&format!("{joint}.force_y")))
}

fn cross(a: Vec2, b: Vec2) -> f64 {
    a.x * b.y - a.y * b.x
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((value - expected).abs() <= tolerance, "{what}: {value} instead of {expected}");
}

/// Two elliptic gears 0.3 m apart along the direction 0.4 rad; inertias 0.02 and 0.05 kg.m2, masses 2 and 3 kg.
pub fn elliptic(keys: Value) -> String {
    let mut coupling = json!({ "type": "elliptic_gears", "first": "one.origin", "second": "two.origin" });
    keys.as_object().unwrap().iter().for_each(|(key, value)| coupling[key] = value.clone());
    json!({ "name": "Elliptic",
        "bodies": { "ground": { "points": { "far": [0.3 * 0.4_f64.cos(), 0.3 * 0.4_f64.sin()] } },
            "one": { "mass": 2, "inertia": 0.02 }, "two": { "mass": 3, "inertia": 0.05 } },
        "joints": { "a": { "type": "revolute", "first": "ground.origin", "second": "one.origin" },
            "b": { "type": "revolute", "first": "ground.far", "second": "two.origin" } },
        "couplings": { "mesh": coupling },
        "torques": { "motor": { "on": "one", "torque": 0.8 }, "load": { "on": "two", "torque": -0.3 } },
        "solver": { "tolerance": 1e-12 },
        "start": { "body": "one", "angle": 0.4, "speed": 5 }, "guess": { "one": 0.4, "two": 2.0 } })
    .to_string()
}

#[test]
fn elliptic_gears_obey_their_closed_form() {
    for (e, lobes, alpha, vertex) in [(0.4, 1.0, 0.35, 0.0), (0.6, 1.0, 0.0, 0.7), (0.2, 2.0, 0.35, -1.0)] {
        let keys = json!({ "eccentricity": e, "lobes": lobes, "pressure_angle": alpha, "vertex_angle": vertex });
        let mut run = Run::new(&elliptic(keys)).started();
        // Angle of the first wheel at which its nearest vertex is on the line of the centres, and that of the second then.
        let theta0 = 0.4 - vertex;
        let gap = |theta: f64, psi: f64| {
            let (a, b) = (0.5 * lobes * theta, 0.5 * lobes * psi);
            b.sin() * a.cos() - (1.0 - e) / (1.0 + e) * a.sin() * b.cos()
        };
        let mated = |theta: f64| 2.0 / lobes * ((1.0 - e) / (1.0 + e) * (0.5 * lobes * theta).tan()).atan();
        let second0 = 2.0 + mated(0.4 - theta0);
        let (mut both, across) = ([false; 2], Vec2::new(0.4_f64.cos(), 0.4_f64.sin()));
        for step in 0..120 {
            run.step(0.05);
            let [theta, psi] = [run.get("one.angle") - theta0, second0 - run.get("two.angle")];
            assert!(gap(theta, psi).abs() < 1e-13 * theta.abs().max(1.0), "{e} {lobes} {theta} {psi}");
            // Speed ratio by the pitch radii: r1 = d (1 - e^2) / (2 (1 + e cos)).
            let (sin, cos) = (lobes * theta).sin_cos();
            let r1 = 0.15 * (1.0 - e * e) / (1.0 + e * cos);
            let ratio = -r1 / (0.3 - r1);
            let (omega, speed) = (run.get("one.speed"), run.get("two.speed"));
            assert_near(speed, ratio * omega, 1e-13 * omega.abs().max(1.0) / (1.0 - e).powi(2), "speed");
            // Wheels by Euler; lever arms are the pitch radii.
            let [first, second] = ["one", "two"].map(|body| run.get(&format!("{body}.acceleration")));
            let t = run.get("mesh.transmitted_force");
            let size = 50.0 + t.abs() + 0.05 * second.abs() / r1;
            assert_near(0.02 * first, 0.8 + t * r1, 1e-12 * size, "first wheel");
            assert_near(0.05 * second, -0.3 + t * (0.3 - r1), 1e-12 * size, "second wheel");
            // The tangent of the ellipse at the pitch point, and the normal of the flank that bears. The pitch point is
            // before the second wheel, so that a force along the tangent turns it clockwise.
            let slope = -lobes * e * sin / (1.0 + e * cos);
            let tangent = (turned(across, PI / 2.0) + slope * across).normalize();
            let driven = -t;
            let normal = turned(tangent * driven.signum(), -driven.signum() * alpha);
            let expected = normal * (driven / normal.dot(&turned(across, PI / 2.0)));
            let mesh = force(&mut run, "mesh");
            assert!((mesh - expected).norm() < 1e-11 * size, "step {step}: {mesh} {expected}");
            assert!((force(&mut run, "a") - mesh).norm() < 1e-11 * size);
            assert!((force(&mut run, "b") + mesh).norm() < 1e-11 * size);
            both[usize::from(t > 0.0)] = true;
            let kinetic = run.get("energy.kinetic");
            assert!(run.get("energy.drift").abs() < 1e-10 * kinetic.max(1.0), "{}", run.get("energy.drift"));
        }
        assert_eq!(both, [true; 2], "both flanks bear");
        assert!(run.get("one.angle").abs() > 3.0 * TAU, "several revolutions");
    }
}

/// Segments: rise, dwell, return, dwell.
fn segments(law: &str, rise: f64) -> Value {
    json!([{ "law": law, "angle": 1.6, "rise": rise }, { "law": "dwell", "angle": 0.7 }, { "law": law, "angle": 2.2, "rise": -rise },
        { "law": "dwell" }])
}

/// Lift and its first two derivatives, as VDI 2143 has them.
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

/// A cam of 1.2 kg and 0.004 kg.m2 at (0.05, -0.02), with its centre of mass beside its axis, and a follower of 0.6 kg
/// that slides upward, 0.012 m beside the axis, with a spring.
pub fn translating(law: &str, follower: Value) -> String {
    let mut coupling = json!({ "type": "cam", "first": "disc.origin", "joint": "guide", "contact": "stem.tip",
        "base_radius": 0.04, "start_angle": 0.5, "segments": segments(law, 0.02) });
    follower.as_object().unwrap().iter().for_each(|(key, value)| coupling[key] = value.clone());
    json!({ "name": "Translating", "gravity": { "acceleration": 9.81, "up_angle": PI / 2.0 },
        "bodies": { "ground": { "points": { "axis": [0.05, -0.02], "guide": [0.062, 0.2] } },
            "disc": { "mass": 1.2, "inertia": 0.004, "center": [0.005, 0.002] },
            "stem": { "mass": 0.6, "points": { "tip": [0.0, -0.08] } } },
        "joints": { "bearing": { "type": "revolute", "first": "ground.axis", "second": "disc.origin" },
            "guide": { "type": "prismatic", "first": "ground.guide", "second": "stem.origin", "axis_angle": PI / 2.0 } },
        "couplings": { "cam": coupling },
        "springs": { "spring": { "joint": "guide", "stiffness": 1000, "free_length": -0.12 } },
        "torques": { "motor": { "on": "disc", "torque": 0.5 } },
        "solver": { "tolerance": 1e-14 },
        "start": { "body": "disc", "angle": 0.1, "speed": 40 }, "guess": { "disc": 0.1, "guide": -0.1 } })
    .to_string()
}

pub const ROLLER: &str = r#"{ "follower": "roller", "roller_radius": 0.01 }"#;

pub fn parsed(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_translating_follower_balances_with_its_cam() {
    let mut lifted = [false; 2];
    for law in ["cycloidal", "polynomial_345", "polynomial_4567"] {
        for is_flat in [false, true] {
            let follower = if is_flat { json!({ "follower": "flat" }) } else { parsed(ROLLER) };
            let mut run = Run::new(&translating(law, follower)).started();
            // Position of the stem's origin without lift: its tip is 0.08 m below.
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
                    // The face touches at the distance s' from the axis.
                    (0.0, Vec2::new(s1, height + s))
                } else {
                    (f64::atan2(s1 - offset, height + s), Vec2::new(0.012, height + s))
                };
                assert_near(run.get("cam.pressure_angle"), angle, 1e-13, &what);
                assert_near(contact * angle.cos(), vertical, 1e-11 * size, &what);
                let normal = Vec2::new(-angle.sin(), angle.cos());
                let mesh = force(&mut run, "cam");
                assert!((mesh - contact * normal).norm() < 1e-11 * size, "{what}: {mesh} {contact} {angle}");
                // Cam: bearing, weight, contact; moments about its axis.
                let arm = turned(Vec2::new(0.005, 0.002), theta);
                let moved = alpha * turned(arm, PI / 2.0) - omega * omega * arm;
                let bearing = force(&mut run, "bearing");
                let weight = Vec2::new(0.0, -1.2 * 9.81);
                assert!((bearing + weight - mesh - 1.2 * moved).norm() < 1e-11 * size, "{what}");
                let inertia = 0.004 + 1.2 * arm.norm_squared();
                let moment = 0.5 + cross(arm, weight) - cross(at, mesh);
                assert_near(inertia * alpha, moment, 1e-11 * size * 0.1, &what);
                // Guide: the side force, and its moment about the stem's origin.
                let guide = force(&mut run, "guide");
                assert_near(guide.x, -mesh.x, 1e-11 * size, &what);
                let from_origin = Vec2::new(0.05 + at.x - 0.062, -0.02 + at.y - 0.2 - position);
                let torque = run.get("guide.torque");
                assert_near(torque + cross(from_origin, mesh), 0.0, 1e-11 * size * 0.1, &what);
                lifted[usize::from(contact < 0.0)] = true;
                let drift = run.get("energy.drift");
                assert!(drift.abs() < 1e-10 * run.get("energy.kinetic").max(1.0), "{what}: {drift}");
            }
            assert!(run.get("disc.angle").abs() > TAU);
        }
    }
    assert_eq!(lifted, [true; 2], "the cam presses and holds back");
}

/// A cam of 0.004 kg.m2 at the origin and a lever of 0.16 m with its pivot at (0.14, 0.03).
pub fn oscillating(law: &str, follower: Value) -> String {
    let mut coupling = json!({ "type": "cam", "first": "disc.origin", "second": "lever.origin", "contact": "lever.end",
        "base_radius": 0.04, "start_angle": -0.3, "segments": segments(law, 0.25) });
    follower.as_object().unwrap().iter().for_each(|(key, value)| coupling[key] = value.clone());
    json!({ "name": "Oscillating",
        "bodies": { "ground": { "points": { "pivot": [0.14, 0.03] } },
            "disc": { "mass": 1.2, "inertia": 0.004 },
            "lever": { "length": 0.16, "mass": 0.3, "shape": "uniform_rod" } },
        "joints": { "bearing": { "type": "revolute", "first": "ground.origin", "second": "disc.origin" },
            "pin": { "type": "revolute", "first": "ground.pivot", "second": "lever.origin" } },
        "couplings": { "cam": coupling },
        "torques": { "motor": { "on": "disc", "torque": -0.5 }, "load": { "on": "lever", "torque": 1.5 } },
        "solver": { "tolerance": 1e-12 },
        "start": { "body": "disc", "angle": 0.1, "speed": -15 }, "guess": { "disc": 0.1, "lever": 2.8 } })
    .to_string()
}

#[test]
fn an_oscillating_follower_balances_with_its_cam() {
    let pivot = Vec2::new(0.14, 0.03);
    for law in ["cycloidal", "polynomial_345", "polynomial_4567"] {
        for is_flat in [false, true] {
            let follower = if is_flat { json!({ "follower": "flat" }) } else { parsed(ROLLER) };
            let mut run = Run::new(&oscillating(law, follower)).started();
            let mut start = None;
            for step in 0..150 {
                run.step(0.01);
                let what = format!("{law} {is_flat} step {step}");
                let [theta, omega, alpha] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("disc.{o}")));
                let [phi, second, psi] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("lever.{o}")));
                let [s, s1, s2] = lift(law, 0.25, theta + 0.3);
                // The lift turns the lever clockwise, away from the cam below its end.
                let zero = *start.get_or_insert(phi + s);
                assert_near(phi, zero - s, 1e-13 * theta.abs().max(1.0), &what);
                assert_near(second, -s1 * omega, 1e-12 * omega.abs(), &what);
                let size = (0.3 * 0.02 * s2.abs() * omega * omega + 5.0) / 0.05;
                assert_near(psi, -s1 * alpha - s2 * omega * omega, 1e-11 * size, &what);
                let arm = turned(Vec2::new(0.16, 0.0), phi);
                let along = arm / 0.16;
                // On the base circle.
                let zeroed = turned(Vec2::new(1.0, 0.0), zero);
                let distance = if is_flat { cross(pivot, zeroed).abs() } else { (pivot + 0.16 * zeroed).norm() };
                assert_near(distance, if is_flat { 0.04 } else { 0.05 }, 1e-14, &what);
                // Where the velocities have one part along the normal: cam omega x r, lever second x (r - pivot).
                let (at, normal) = if is_flat {
                    let normal = turned(along, -PI / 2.0);
                    let normal = if cross(along, -pivot) > 0.0 { normal } else { -normal };
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
                let mesh = force(&mut run, "cam");
                assert!((mesh - contact * normal).norm() < 1e-11 * size, "{what}: {mesh} {contact} {normal}");
                // A lift moves the lever clockwise.
                let lifts = turned(at - pivot, -PI / 2.0);
                let angle = cross(lifts, normal).atan2(lifts.dot(&normal));
                assert_near(run.get("cam.pressure_angle"), angle, 1e-12, &what);
                assert!(angle.abs() < 1.2, "{what}: {angle}");
                // Cam and lever by Euler, the lever's mass at half its length.
                assert_near(0.004 * alpha, -0.5 - cross(at, mesh), 1e-12 * size, &what);
                let inertia = 0.3 * 0.16 * 0.16 / 3.0;
                assert_near(inertia * psi, 1.5 + cross(at - pivot, mesh), 1e-11 * size, &what);
                let center = 0.5 * (psi * turned(arm, PI / 2.0) - second * second * arm);
                let (pin, bearing) = (force(&mut run, "pin"), force(&mut run, "bearing"));
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
fn panels_of_a_cam_end_at_its_segments() {
    let text = translating("polynomial_345", parsed(ROLLER));
    let reduced = Reduced::new(&Mechanism::from_json(&text).unwrap()).unwrap();
    let knots = reduced.curve().law_knots();
    assert_eq!(knots.len(), 4, "one for each border of a segment: {knots:?}");
    let coordinate = reduced.linkage().coordinates.iter().position(|name| name == "disc").unwrap();
    for (sigma, border) in knots.iter().zip([0.0, 1.6, 2.3, 4.5]) {
        let angle = reduced.curve().configuration(*sigma).q[coordinate] - 0.5;
        assert!((angle - border).abs() < 1e-12, "{angle} {border}");
    }
    assert!(reduced.curve().closed < 3000, "{} positions", reduced.curve().closed);
}

#[test]
fn energy_drifts_by_the_tolerance_across_the_borders_of_segments() {
    // Steps end at the borders, where the jerk jumps, so that no error estimate has a jump within its step.
    for law in ["cycloidal", "polynomial_345", "polynomial_4567"] {
        for (tolerance, most) in [(1e-8, 1e-6), (1e-11, 1e-9), (1e-14, 1e-11)] {
            let text = changed(&translating(law, parsed(ROLLER)), |m| m["solver"]["tolerance"] = json!(tolerance));
            let mut run = Run::new(&text).started();
            for _ in 0..150 {
                run.step(0.01);
                let drift = run.get("energy.drift");
                assert!(drift.abs() < most, "{law} {tolerance}: {drift}");
            }
        }
    }
}

#[test]
fn borders_end_the_steps_of_a_motion_that_turns_back_or_coasts() {
    // Without a motor the disc's weight swings it to and fro over the borders, and without gravity it turns for ever.
    for (gravity, speed) in [(9.81, 3.0), (0.0, 40.0)] {
        let text = changed(&translating("polynomial_345", parsed(ROLLER)), |m| {
            m["gravity"]["acceleration"] = json!(gravity);
            m["torques"]["motor"]["torque"] = json!(0);
            m["start"]["speed"] = json!(speed);
            m["bodies"]["disc"]["center"] = json!([0.05, 0.0]);
            m["solver"]["tolerance"] = json!(1e-10);
        });
        let mut run = Run::new(&text).started();
        let (mut turned_back, mut other) = (false, run.clone());
        for _ in 0..100 {
            run.step(0.05);
            turned_back |= run.get("disc.speed") < 0.0;
            let drift = run.get("energy.drift");
            assert!(drift.abs() < 1e-8, "{gravity}: {drift}");
        }
        assert_eq!(turned_back, gravity > 0.0);
        // One long step passes over whole periods, and comes to the same place.
        other.step(5.0);
        for name in ["disc.angle", "disc.speed"] {
            let (one, two) = (run.get(name), other.get(name));
            assert!((one - two).abs() < 1e-6 * one.abs().max(1.0), "{gravity} {name}: {one} {two}");
        }
    }
}

#[test]
fn a_follower_that_lifts_off_is_told_once() {
    let run = |change: &dyn Fn(&mut Value)| {
        let text = changed(&translating("polynomial_345", parsed(ROLLER)), |m| {
            m["solver"]["tolerance"] = json!(1e-9);
            change(m);
        });
        let mut run = Run::new(&text).started();
        let (mut told, mut first) = (Vec::new(), None);
        for k in 0..150 {
            let point = 3.0 + 0.01 * f64::from(k);
            run.0.model_mut().step_from(Some(point), 0.01).unwrap();
            let force = run.get("cam.contact_force");
            if force < 0.0 {
                first = first.or(Some((point + 0.01, force)));
            }
            told.extend(run.0.model_mut().take_warning());
        }
        (told, first)
    };
    let (told, first) = run(&|_| {});
    let (time, force) = first.unwrap();
    let [warning] = &told[..] else { panic!("{told:?}") };
    let (time, force) = (format!("at t = {time} s"), format!("{force:.3}"));
    assert_says(
        warning,
        &["cam.contact_force", "lift off", &time[..10], &force[..5], "spring", "couplings.cam", "grooved"],
    );
    // A spring that presses harder than the follower is thrown, or a groove.
    let (told, first) = run(&|m| m["springs"]["spring"]["preload"] = json!(900));
    assert!(told.is_empty() && first.is_none(), "{told:?} {first:?}");
    let (told, first) = run(&|m| m["couplings"]["cam"]["grooved"] = json!(true));
    assert!(told.is_empty() && first.is_some(), "{told:?}");
    // Without any load and without motion the contact force is 0, which is no lifting off.
    let (told, first) = run(&|m| {
        m["gravity"]["acceleration"] = json!(0);
        m["torques"]["motor"]["torque"] = json!(0);
        m["start"]["speed"] = json!(0);
        m["springs"]["spring"]["stiffness"] = json!(0);
    });
    assert!(told.is_empty(), "{told:?} {first:?}");
}

#[test]
fn a_table_lifts_through_its_points_and_comes_back() {
    let points = json!([[0.0, 0.0], [0.8, 0.004], [1.6, 0.015], [2.4, 0.02], [3.2, 0.02], [4.0, 0.008], [5.0, 0.001]]);
    let text = changed(&translating("cycloidal", parsed(ROLLER)), |m| {
        let cam = m["couplings"]["cam"].as_object_mut().unwrap();
        cam.remove("segments");
        cam.insert("points".into(), points.clone());
    });
    let height = f64::sqrt(0.05 * 0.05 - 0.012 * 0.012);
    for point in points.as_array().unwrap() {
        let [angle, lift] = [0, 1].map(|k| point[k].as_f64().unwrap());
        let mut run = Run::new(&changed(&text, |m| m["start"]["angle"] = json!(angle + 0.5 + TAU))).started();
        assert_near(run.get("guide.position"), -0.14 + height + lift, 1e-14, "position");
    }
    let mut run = Run::new(&text).started();
    for _ in 0..100 {
        run.step(0.01);
        let drift = run.get("energy.drift");
        assert!(drift.abs() < 1e-10 * run.get("energy.kinetic").max(1.0), "{drift}");
    }
}

#[test]
fn derivatives_of_the_contact_are_differences() {
    for text in
        [oscillating("polynomial_4567", parsed(ROLLER)), oscillating("cycloidal", json!({ "follower": "flat" }))]
    {
        let mut run = Run::new(&text).started();
        for _ in 0..8 {
            run.step(0.013);
            for name in ["cam.pressure_angle", "cam.contact_force", "cam.force_x", "pin.force", "lever.acceleration"] {
                let rate = run.derivative(name);
                let h = 1e-6;
                let value = run.get(name);
                let mut later = run.clone();
                later.step(h);
                let difference = (later.get(name) - value) / h;
                let size = 100.0 * value.abs().max(1e-3);
                assert!((rate - difference).abs() < 1e-3 * rate.abs().max(size), "{name}: {rate} {difference}");
            }
        }
    }
}

#[test]
fn parameters_of_a_cam_change_it() {
    let mut run = Run::new(&translating("polynomial_345", parsed(ROLLER)));
    run.set("cam.base_radius", 0.06);
    run.set("cam.roller_radius", 0.02);
    run.set("cam.start_angle", 0.1);
    let mut run = run.started();
    let height = f64::sqrt(0.08 * 0.08 - 0.012 * 0.012);
    assert_near(run.get("guide.position"), -0.14 + height, 1e-14, "position");
}

#[test]
fn what_is_no_cam_is_refused() {
    let refused = |base: &str, key: &str, value: Value, pieces: &[&str]| {
        let text = changed(base, |m| match value {
            Value::Null => drop(m["couplings"]["cam"].as_object_mut().unwrap().remove(key)),
            value => m["couplings"]["cam"][key] = value,
        });
        let error = Simulation::open(&text).and_then(|mut s| s.initialize()).unwrap_err();
        assert_says(error, pieces);
    };
    let slides = &translating("cycloidal", parsed(ROLLER));
    let turns = &oscillating("cycloidal", parsed(ROLLER));
    refused(slides, "segments", Value::Null, &["couplings.cam", "no lift", "segments"]);
    refused(slides, "segments", json!([]), &["couplings.cam.segments"]);
    let dwell = json!([{ "law": "dwell", "angle": 1.0, "rise": 0.1 }, { "law": "dwell" }]);
    refused(slides, "segments", dwell, &["segments[0].rise", "dwell"]);
    let short = json!([{ "law": "dwell", "angle": 1.0 }, { "law": "dwell", "angle": 2.0 }]);
    refused(slides, "segments", short, &["couplings.cam.segments", "add up to 3 rad", "2 pi"]);
    let open = json!([{ "law": "cycloidal", "angle": 1.0, "rise": 0.02 }, { "law": "dwell" }]);
    refused(slides, "segments", open, &["couplings.cam.segments", "0.02", "return"]);
    let none = json!([{ "law": "cycloidal", "angle": 1.0 }, { "law": "dwell" }]);
    refused(slides, "segments", none, &["segments[0].rise", "missing"]);
    refused(
        slides,
        "points",
        json!([[0.0, 0.0], [1.0, 0.1], [2.0, 0.0]]),
        &["couplings.cam.points", "segments already"],
    );
    refused(slides, "second", json!("disc.origin"), &["couplings.cam.second", "joint"]);
    refused(slides, "joint", Value::Null, &["couplings.cam", "no motion", "second"]);
    refused(slides, "joint", json!("bearing"), &["couplings.cam.joint", "prismatic", "follower"]);
    refused(slides, "roller_radius", Value::Null, &["couplings.cam.roller_radius", "missing"]);
    refused(slides, "face_angle", json!(0.0), &["couplings.cam.face_angle", "roller"]);
    refused(slides, "phase", json!(0.0), &["couplings.cam.phase", "base circle"]);
    refused(slides, "teeth", json!(3), &["teeth"]);
    refused(slides, "first_teeth", json!(3), &["couplings.cam.first_teeth", "base_radius"]);
    refused(slides, "contact", json!("disc.origin"), &["couplings.cam.contact", "on disc", "stem"]);
    refused(slides, "base_radius", json!(0.001), &["couplings.cam.base_radius", "0.012", "0.011"]);
    refused(turns, "base_radius", json!(0.5), &["couplings.cam.base_radius", "0.51", "0.0168"]);
    refused(turns, "carrier", json!("lever"), &["couplings.cam.second", "on lever"]);
    let steep = elliptic(json!({ "eccentricity": 0.9, "pressure_angle": 0.6 }));
    let error = Simulation::open(&steep).and_then(|mut s| s.initialize()).unwrap_err();
    assert_says(error, &["couplings.mesh.pressure_angle", "1.1197", "eccentricity"]);
    let beyond = elliptic(json!({ "eccentricity": 0.95 }));
    let error = Simulation::open(&beyond).and_then(|mut s| s.initialize()).unwrap_err();
    assert_says(error, &["couplings.mesh.eccentricity", "0.95", "0.9"]);
}
