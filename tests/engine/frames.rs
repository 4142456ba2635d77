//! The frames of the bodies as local variables: origin, and rotation matrix of the angle.

use crate::support::{ANDREWS, CRANE, FOUR_BAR, GEAR, JIB, Run, SLIDER_CRANK, Vec2, assert_says, changed, reals};
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::linkage::{Freedom, Point};
use linkage_fmu::mechanism::loads::resolved::markers;
use linkage_fmu::variables::{Causality, Variable};
use serde_json::json;

/// A slider on a rotating rocker.
const INVERTED: &str = include_str!("../fixtures/inverted_slider_crank.json");
/// Difference between a body's point by its frame and the same point by the table of markers, or by the other body of a
/// joint. The difference is relative to the size of the mechanism and has the accuracy of the tables.
const TABLES: f64 = 1e-12;
/// Rounding of a sum of two squares.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Position of a point of the linkage, computed from the frame of its body.
fn position(run: &mut Run, point: Point) -> Vec2 {
    if point.body == 0 {
        return point.local;
    }
    let name = run.reduced().unwrap().linkage().bodies[point.body].name.clone();
    let [x, y, cos, sin, minus_sin] =
        ["x", "y", "cos", "sin", "minus_sin"].map(|part| run.get(&format!("{name}.frame.{part}")));
    assert!((cos * cos + sin * sin - 1.0).abs() <= ROUNDING, "{name}: {cos}, {sin}");
    assert_eq!(minus_sin.to_bits(), (-sin).to_bits(), "{name}");
    if run.0.reference(&format!("{name}.angle")).is_ok() {
        let angle = run.get(&format!("{name}.angle"));
        assert_eq!([cos, sin], [angle.cos(), angle.sin()], "{name}");
    }
    Vec2::new(x + cos * point.local.x + minus_sin * point.local.y, y + sin * point.local.x + cos * point.local.y)
}

/// The two points of each revolute joint coincide, those of a prismatic joint are on its axis, and each marker is at
/// the position of its outputs.
fn check(run: &mut Run, (what, text): (&str, &str)) {
    let reduced = run.reduced().unwrap().clone();
    let linkage = reduced.linkage();
    let least = TABLES * linkage.size;
    for joint in &linkage.joints {
        let [a, b] = [joint.first, joint.second].map(|point| position(run, point));
        let gap = match joint.freedom {
            Freedom::Revolute => (b - a).norm(),
            Freedom::Prismatic(axis) => {
                let tip = Point { local: joint.first.local + axis, ..joint.first };
                let (axis, apart) = (position(run, tip) - a, b - a);
                (axis.x * apart.y - axis.y * apart.x).abs()
            }
            Freedom::Slot(_) | Freedom::Coupling(_) => continue,
        };
        assert!(gap <= least, "{what}: {} is open by {gap:e}", joint.name);
    }
    let names: Vec<String> =
        run.variables().list().iter().filter_map(|v| v.name.strip_suffix(".velocity_x")).map(str::to_owned).collect();
    for (name, marker) in names.iter().zip(markers(&Mechanism::from_json(text).unwrap(), linkage).unwrap()) {
        let origin = Vec2::new(run.get(&format!("{name}.x")), run.get(&format!("{name}.y")));
        let gap = (position(run, marker) - origin).norm();
        assert!(gap <= least, "{what}: marker {name} is {gap:e} off");
    }
}

#[test]
fn frames_close_the_joints_and_carry_the_markers() {
    let all = [("andrews", ANDREWS), ("crane", CRANE), ("four-bar", FOUR_BAR), ("gear", GEAR), ("jib", JIB)];
    for (what, text) in all.into_iter().chain([("slider-crank", SLIDER_CRANK), ("inverted", INVERTED)]) {
        let mut run = Run::new(text).started();
        let step = run.experiment().stop_time / 40.0;
        for _ in 0..10 {
            check(&mut run, (what, text));
            run.step(step);
        }
    }
}

/// A body that does not rotate has the angle that its prismatic joint determines.
#[test]
fn a_body_that_does_not_turn_keeps_its_direction() {
    let tilted = changed(SLIDER_CRANK, |m| m["joints"]["cylinder"]["angle"] = json!(0.3));
    let mut run = Run::new(&tilted).started();
    run.step(1e-3);
    check(&mut run, ("tilted", &tilted));
    assert_eq!([run.get("piston.frame.cos"), run.get("piston.frame.sin")], [0.3f64.cos(), 0.3f64.sin()]);
}

/// Rods as stiff as those of the gear change their length by less than 0.1 mm.
#[test]
fn the_finite_elements_have_frames_too() {
    let [mut rigid, mut elastic] = [GEAR, GEAR].map(Run::new);
    elastic.set("solver.method", "rigid_fem");
    let [rigid, elastic] = [&mut rigid, &mut elastic].map(|run| {
        run.0.initialize().unwrap();
        run.step(0.02);
        run
    });
    for body in ["crank", "coupler", "follower"] {
        for part in ["x", "y", "cos", "sin", "minus_sin"] {
            let name = format!("{body}.frame.{part}");
            let (a, b) = (rigid.get(&name), elastic.get(&name));
            assert!((a - b).abs() < 1e-4, "{name}: {a} and {b}");
        }
        let angle = elastic.get(&format!("{body}.angle"));
        assert_eq!(elastic.get(&format!("{body}.frame.sin")), angle.sin());
    }
}

/// FMI 2.0.5, sections 2.1.9 and 4.2.1: directional derivatives exist only for outputs.
#[test]
fn a_local_variable_is_read_only_and_has_no_derivatives() {
    let mut run = Run::gear().started();
    let locals = reals(&run, Causality::Local);
    let is_frame = |r: &u32| run.variables().get(*r).is_some_and(|v| v.name.contains(".frame."));
    let locals: Vec<u32> = locals.into_iter().filter(is_frame).collect();
    let list: Vec<Variable> = locals.iter().map(|r| run.variables().get(*r).unwrap().clone()).collect();
    assert_eq!(list.len(), 5 * 3);
    assert!(list.iter().all(|v| v.dependencies.is_empty() && v.start.is_none() && v.name.contains(".frame.")));
    let input = run.0.reference("actuator.force").unwrap();
    let refused = run.directional_derivative(&[locals[0]], &[input], &[1.0], &mut |_, _| {}).unwrap_err();
    assert_says(refused, &["crank.frame.x", "an unknown (the variable to differentiate) must be a continuous output"]);
    let refused = run.output_derivative(locals[0], 1).unwrap_err();
    assert_says(refused, &["crank.frame.x", "derivatives are available for continuous outputs only"]);
    assert!(run.set_real(locals[0], 1.0).is_err());
}
