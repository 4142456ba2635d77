//! Outputs without a value in a valid state are NaN with a reason. All other outputs have values, and the motion
//! continues. Self-locking of an excavator bucket against statics with friction circles.

use crate::random_linkages::generate::linkages;
use crate::support::definition::{With, four_bar};
use crate::support::{BUCKET, GEAR, Run, Vec2, assert_says, changed, read_all, reals, runner, without_stops};
use linkage_fmu::simulation::Simulation;
use linkage_fmu::variables::Causality;
use proptest::prelude::*;
use serde_json::json;
use std::cell::Cell;

/// Geometry of `excavator_bucket.json` [m].
const ROCKER_EYE: Vec2 = Vec2::new(-0.45, 0.05);
const CYLINDER_EYE: Vec2 = Vec2::new(-2.2, 0.5);
const ROCKER: f64 = 0.62;
const LINK: f64 = 0.55;
const BUCKET_LENGTH: f64 = 0.48;
/// Coefficient of friction x pin radius [m].
const ARM: f64 = 0.19 * 0.02;

fn direction(angle: f64) -> Vec2 {
    Vec2::new(angle.cos(), angle.sin())
}

fn cross(a: Vec2, b: Vec2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Pins D of the bucket and C of the rocker at this angle of the bucket.
fn pins(angle: f64) -> [Vec2; 2] {
    let d = BUCKET_LENGTH * direction(angle);
    let to = ROCKER_EYE - d;
    let along = (LINK * LINK - ROCKER * ROCKER + to.norm_squared()) / (2.0 * to.norm());
    let (e, up) = (to.normalize(), (LINK * LINK - along * along).sqrt());
    [d, d + along * e - up * Vec2::new(-e.y, e.x)]
}

/// Cylinder force at which the bucket starts to turn in a sense (1 or -1) against a torque on it, without gravity.
/// Statics: the link transmits one force f between its pins, each with the friction torque mu r |R|. u is the direction
/// of the force on the bucket without friction. f ((D - B) x u - s_D mu r - s_B mu r) = -T must give f > 0. None if no
/// force moves the bucket.
fn breakaway(angle: f64, sense: f64, torque: f64) -> Option<f64> {
    let [d, c] = pins(angle);
    // Rates: D moves about the origin, C about the rocker's eye. Both are ends of the link.
    let d_dot = sense * Vec2::new(-d.y, d.x);
    let (r, l) = (c - ROCKER_EYE, d - c);
    let rocker_rate = l.dot(&d_dot) / l.dot(&Vec2::new(-r.y, r.x));
    let c_dot = rocker_rate * Vec2::new(-r.y, r.x);
    let link_rate = cross(l, d_dot - c_dot) / l.norm_squared();
    let [s_a, s_b, s_c, s_d] = [rocker_rate, sense, link_rate - rocker_rate, sense - link_rate].map(f64::signum);
    // About D: friction turns the link's force on the bucket out of the line of the pins by the angle of friction.
    let along = l.y.atan2(l.x);
    let lean = (ARM * (s_c - s_d) / LINK).asin();
    let without = direction(along);
    let pushes = -torque / cross(d, without) > 0.0;
    let u = if pushes { direction(along - lean) } else { direction(along + std::f64::consts::PI + lean) };
    let f = -torque / (cross(d, u) - ARM * (s_d + s_b));
    if f < 0.0 {
        return None;
    }
    // About the rocker's eye.
    let e = (c - CYLINDER_EYE).normalize();
    let mut force = 0.0;
    for _ in 0..200 {
        let reaction = (force * e - f * u).norm();
        force = (cross(r, f * u) - s_c * ARM * f + s_a * ARM * reaction) / cross(r, e);
    }
    Some(force)
}

fn bucket(angle: f64, torque: f64) -> Run {
    Run::shared(BUCKET).with(&[("bucket.start_angle", angle), ("digging.torque", torque)]).started()
}

/// Angle of the bucket at which it is in line with its link [rad].
const IN_LINE: f64 = 2.698;

/// On both sides of the position in line the forces agree with statics. Where statics has no force, the outputs are
/// NaN, and only there `self_locking` is true.
#[test]
fn the_bucket_locks_where_statics_has_no_force() {
    let (mut locked, mut found) = (0, 0);
    for torque in [-20_000.0, 15_000.0] {
        for k in -60..=60 {
            let angle = IN_LINE + 2e-3 * f64::from(k);
            let mut run = bucket(angle, torque);
            // Sign of the cylinder's speed when the bucket turns forward.
            let growth = {
                let cylinder = |angle: f64| (pins(angle)[1] - CYLINDER_EYE).norm();
                (cylinder(angle + 1e-6) - cylinder(angle - 1e-6)).signum()
            };
            let mut lacks = false;
            for (name, sense) in
                [("cylinder.breakaway_force_forward", growth), ("cylinder.breakaway_force_backward", -growth)]
            {
                match breakaway(angle, sense, torque) {
                    Some(force) => {
                        let read = run.get(name);
                        // Near the border of locking, the sensitivity of the force to the tables is proportional to the
                        // force.
                        let bound = 1e-10 * force.abs().max(1e5) * (force.abs() / 1e5).max(1.0);
                        assert!((read - force).abs() < bound, "{name} at {angle}: {read} {force}");
                        found += 1;
                    }
                    None => {
                        let reason = run.undefined(name);
                        assert_says(
                            reason,
                            &[
                                "the mechanism against the drive cylinder near",
                                "however large the force of this drive is",
                            ],
                        );
                        lacks = true;
                        locked += 1;
                    }
                }
            }
            assert_eq!(run.is("cylinder.self_locking"), lacks, "{angle}");
            assert_eq!(read_all(&mut run).is_empty(), !lacks, "{angle}");
        }
    }
    println!("{found} forces, {locked} times none");
    assert!(found > 400 && locked > 10);
}

/// The border of the locked positions agrees with statics.
#[test]
fn the_border_of_locking_is_that_of_statics() {
    const TORQUE: f64 = -20_000.0;
    let border = |locks: &mut dyn FnMut(f64) -> bool| {
        let (mut free, mut locked) = (IN_LINE - 0.1, IN_LINE - 1e-3);
        assert!(!locks(free) && locks(locked));
        for _ in 0..40 {
            let middle = 0.5 * (free + locked);
            if locks(middle) { locked = middle } else { free = middle }
        }
        locked
    };
    let statics = border(&mut |angle| [1.0, -1.0].iter().any(|sense| breakaway(angle, *sense, TORQUE).is_none()));
    let limit = border(&mut |angle| bucket(angle, TORQUE).is("cylinder.self_locking"));
    println!("{statics} {limit}");
    // Both angles have the rounding error of the force, which is unbounded at the border.
    assert!((statics - limit).abs() < 1e-10, "{statics} {limit}");
}

/// The bucket swings through the locked positions. Every output is read after every step. Other outputs stay finite.
#[test]
fn the_bucket_swings_through_the_locked_positions() {
    let mut run = Run::new(BUCKET).with(&[("bucket.start_angle", 2.55), ("bucket.start_speed", 1.5)]);
    run.set_all(&[("cylinder.force", 2e4), ("digging.torque", -100.0)]);
    run.initialize();
    let (mut seen, mut between) = (0, 0);
    for _ in 0..60 {
        run.step(4e-3);
        let undefined = read_all(&mut run);
        let inverse = |name: &String| name.starts_with("cylinder.required") || name.starts_with("cylinder.breakaway");
        assert!(undefined.iter().all(inverse), "{undefined:?}");
        assert_eq!(undefined.is_empty(), !run.is("cylinder.self_locking"));
        seen += usize::from(!undefined.is_empty());
        between += usize::from(undefined.is_empty());
    }
    assert!(
        run.get("bucket.angle") > IN_LINE && seen > 2 && between > 10,
        "{} {seen} {between}",
        run.get("bucket.angle")
    );
    assert!(run.get("energy.drift").abs() < 1e-5);
    // A recorded time series continues across outputs without a value.
    let mut run = Run::new(BUCKET).with(&[("bucket.start_angle", 2.55), ("bucket.start_speed", 1.5)]).started();
    run.set_all(&[("cylinder.force", 2e4), ("digging.torque", -100.0)]);
    let trace = run.0.run(0.24, 4e-3, &["cylinder.required_force", "cylinder.self_locking", "bucket.speed"]).unwrap();
    let column = |name| trace.column(name).unwrap().to_vec();
    assert!(column("bucket.speed").iter().all(|v| v.is_finite()));
    let locked = column("cylinder.self_locking");
    assert!(column("cylinder.required_force").iter().zip(&locked).all(|(f, l)| f.is_finite() || *l == 1.0));
    assert!(locked.contains(&1.0));
}

/// Friction has no solution under the present inputs: positions, speeds and the rates of positions have values, outputs
/// that need the acceleration are NaN. Without friction all outputs have values again.
#[test]
fn under_loads_that_lock_only_what_needs_the_acceleration_is_undefined() {
    let text = changed(without_stops(), |m| {
        m["friction"]["enabled"] = json!(true);
        for joint in ["joint1", "joint2", "joint3", "joint4"] {
            m["joints"][joint]["pin_radius"] = json!(0.2);
            m["joints"][joint]["static_coefficient"] = json!(0.6);
            m["joints"][joint]["kinetic_coefficient"] = json!(0.6);
        }
    });
    let mut run = Run::new(&text).with(&[("crank.start_angle", 0.3), ("crank.start_speed", -3.0)]).started();
    let undefined = read_all(&mut run);
    let has = |name: &str| undefined.iter().any(|u| u == name);
    for name in [
        "crank.angle",
        "crank.speed",
        "wheel.velocity_x",
        "actuator.length",
        "energy.kinetic",
        "energy.drift",
        "joint1.slip_speed",
        "actuator.reduced_mass",
        "actuator.holding_force",
    ] {
        assert!(!has(name), "{name}");
        run.get(name);
    }
    for lacking in
        ["crank.acceleration", "wheel.acceleration_y", "joint2.force", "joint3.friction_torque", "actuator.static_load"]
    {
        assert!(has(lacking), "{lacking}");
        assert_says(run.undefined(lacking), &["friction locks the mechanism near", "present inputs"]);
    }
    let (rate, speed) = (run.derivative("crank.angle"), run.get("crank.speed"));
    assert!((rate - speed).abs() < 1e-12 * speed.abs());
    assert!(run.0.derivative("crank.speed").unwrap().is_nan());
    let reference = run.0.reference("crank.speed").unwrap();
    assert_says(run.undefined_derivative(reference).unwrap(), &["friction locks the mechanism near"]);
    // With respect to inputs: the speed depends on no input, the acceleration has no derivative.
    let inputs = [run.0.reference("actuator.force").unwrap()];
    let unknowns = ["crank.speed", "crank.acceleration"].map(|name| run.0.reference(name).unwrap());
    let mut found = [1.0; 2];
    run.directional_derivative(&unknowns, &inputs, &[1.0], &mut |i, d| found[i] = d).unwrap();
    assert!(found[0] == 0.0 && found[1].is_nan(), "{found:?}");
    assert_says(run.undefined_derivative(unknowns[1]).unwrap(), &["friction locks the mechanism near"]);
    assert_eq!(run.undefined_derivative(unknowns[0]), None);
    assert!(run.0.step(1e-3).is_err());
    run.set("friction.enabled", false);
    run.initialize();
    assert!(read_all(&mut run).is_empty());
}

/// A parallelogram that starts in the flat position, where branches cross and reactions are unbounded: every output is
/// finite or NaN with a reason. Motion and energies have values. Each rate is finite or NaN with a reason.
#[test]
fn at_a_crossing_every_output_has_a_value_or_a_reason() {
    let definition = four_bar([0.4, 0.1, 0.4, 0.1], [0.5, 0.0, 0.5]).with(json!({
        "bodies": { "crank": { "mass": 1 }, "coupler": { "mass": 2 }, "rocker": { "mass": 1 } },
        "actuators": { "servo": { "joint": "a", "torque": 1.0 } },
        "forces": { "push": { "at": "coupler.end", "force": [3.0, -2.0] } },
        "start": { "angle": 0, "speed": 5 },
    }));
    let mut run = Run::new(definition.to_string()).started();
    let outputs = reals(&run, Causality::Output);
    for k in 0..40 {
        let undefined = read_all(&mut run);
        assert!(
            undefined.iter().all(|name| ["a.", "b.", "c.", "d."].iter().any(|j| name.starts_with(j))),
            "{undefined:?}"
        );
        for &output in &outputs {
            let rate = run.output_derivative(output, 1).unwrap();
            assert!(rate.is_finite() || rate.is_nan() && run.undefined_derivative(output).is_some(), "{output} {rate}");
        }
        // To the next flat position, half a turn away, and past it.
        let angle = run.get("crank.angle");
        let h = if k % 4 == 3 {
            (std::f64::consts::PI - angle.rem_euclid(std::f64::consts::PI)) / run.get("crank.speed")
        } else {
            0.02
        };
        run.step(h);
    }
}

/// A reference with a wrong type is rejected with the variable's name.
#[test]
fn a_reference_of_another_type_is_rejected_with_its_name() {
    let mut run = Run::new(GEAR);
    let [angle, flag] = ["crank.angle", "friction.enabled"].map(|name| run.0.reference(name).unwrap());
    let refusals = [
        run.boolean(angle).unwrap_err().to_string(),
        run.item(angle).unwrap_err().to_string(),
        run.set_boolean(angle, true).unwrap_err().to_string(),
    ];
    refusals.iter().for_each(|refusal| assert_says(refusal, &["crank.angle", "is a Real variable, not a"]));
    assert_says(run.real(flag).unwrap_err(), &["friction.enabled", "is a Boolean variable, not a Real"]);
    assert_says(run.real(u32::MAX).unwrap_err(), &["4294967295", "references run from 0"]);
}

/// Random linkages with pins of any size, including pins that lock: every output is read after every step.
#[test]
fn every_output_of_random_linkages_with_friction_can_be_read() {
    let radii = prop::collection::vec(0.0..1.0f64, 7);
    let forces = prop::collection::vec(-50.0..50.0f64, 8);
    let scenes = (linkages(), radii, -3.0..-0.7f64, 0.0..0.5f64, forces);
    let (locked, inverse, free) = (Cell::new(0), Cell::new(0), Cell::new(0));
    let mut runner = runner(60);
    let result = runner.run(&scenes, |(linkage, radii, size, mu, forces)| {
        let text = changed(linkage.json(), |m| {
            let joints = m["joints"].as_object_mut().unwrap().values_mut();
            for (joint, radius) in joints.zip(&radii).filter(|(joint, _)| joint["type"] == "revolute") {
                joint["pin_radius"] = json!(radius * 10_f64.powf(size));
            }
            m["friction"] = json!({ "enabled": true, "static_coefficient": mu, "kinetic_coefficient": 0.7 * mu });
            m["solver"]["tolerance"] = json!(1e-8);
        });
        let Ok(mut simulation) = Simulation::open(&text) else { return Ok(()) };
        prop_assume!(simulation.initialize().is_ok());
        for force in forces {
            simulation.set("push.force", force).unwrap();
            simulation.set("push.demanded_acceleration", 0.1 * force).unwrap();
            let undefined = read_all(simulation.model_mut());
            let count = match undefined.iter().any(|name| name.ends_with(".acceleration")) {
                true => &locked,
                false if undefined.is_empty() => &free,
                false => &inverse,
            };
            count.set(count.get() + 1);
            if simulation.step(0.02).is_err() {
                // Usually friction has locked the mechanism. The outputs can still be read.
                read_all(simulation.model_mut());
                break;
            }
        }
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    println!("{} states locked, {} locked against the drive, {} free", locked.get(), inverse.get(), free.get());
    assert!(inverse.get() > 0 && free.get() > 0);
}
