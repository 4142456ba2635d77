//! The interface of the gear: names, units, start values, and true dependencies.

use crate::support::{CURVES, GEAR, Run, reals, replaced, values};
use linkage_fmu::mechanism::Model;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::interface::initial_dependencies;
use linkage_fmu::variables::{Causality, Kind, Reference, Unit, Value, Variable};

#[test]
fn the_names_are_the_contract() {
    let model = Run::gear();
    let variable = |name: &str| -> &Variable { model.variables().get(model.0.reference(name).unwrap()).unwrap() };
    let with = |causality| -> Vec<&str> {
        model.variables().list().iter().filter(|v| v.causality == causality).map(|v| v.name.as_str()).collect()
    };
    let inputs = "actuator.force load_factor wheel.force_x wheel.force_y crank.torque follower.torque \
        actuator.demanded_acceleration airspeed uplock.engage downlock.engage";
    assert_eq!(with(Causality::Input).join(" "), inputs);
    let outputs = "crank.angle crank.speed crank.acceleration coupler.angle coupler.speed coupler.acceleration \
        follower.angle follower.speed follower.acceleration \
        joint1.force_x joint1.force_y joint1.force joint1.friction_torque joint1.slip_speed \
        joint2.force_x joint2.force_y joint2.force joint2.friction_torque joint2.slip_speed \
        joint3.force_x joint3.force_y joint3.force joint3.friction_torque joint3.slip_speed \
        joint4.force_x joint4.force_y joint4.force joint4.friction_torque joint4.slip_speed \
        actuator.length actuator.speed actuator.acceleration actuator.reduced_mass \
        actuator.reduced_mass_derivative actuator.static_load actuator.additional_force actuator.required_force \
        actuator.holding_force actuator.holding_force_derivative actuator.lower_limit actuator.upper_limit \
        actuator.breakaway_force_forward actuator.breakaway_force_backward actuator.self_locking \
        wheel.x wheel.y wheel.velocity_x wheel.velocity_y wheel.acceleration_x wheel.acceleration_y \
        leg.drag wheel.drag \
        retracted upstop.torque upstop.impact_count upstop.impact_time upstop.impact_impulse \
        extended downstop.torque downstop.impact_count downstop.impact_time downstop.impact_impulse \
        uplock.force downlock.force energy.kinetic energy.potential energy.drift";
    assert_eq!(with(Causality::Output).join(" "), outputs);
    let frames = ["crank", "coupler", "follower"]
        .map(|body| ["x", "y", "cos", "sin", "minus_sin"].map(|part| format!("{body}.frame.{part}")));
    let mut locals = frames.concat();
    locals.push("contact.mode".to_owned());
    let exchange = "along_curve.position along_curve.speed along_curve.acceleration along_curve.low_end \
        along_curve.high_end \
        upstop.indicator downstop.indicator uplock.indicator downlock.indicator along_curve.reversal";
    locals.extend(exchange.split_whitespace().map(str::to_owned));
    let slips = |joint: i32| ["static", "kinetic"].map(|border| format!("joint{joint}.{border}_indicator"));
    locals.extend((1..=4).flat_map(slips));
    assert_eq!(with(Causality::Local), locals);
    let parameters = with(Causality::Parameter);
    let some = "crank.length crank.start_angle crank.start_speed solver.tolerance solver.fem_step solver.method \
        crank.axial_stiffness coupler.axial_stiffness follower.axial_stiffness leg.mass wheel.mass";
    some.split(' ').for_each(|name| assert!(parameters.contains(&name), "{name}"));
    let starts =
        [("actuator.force", 30_000.0), ("load_factor", 3.0), ("solver.tolerance", 1e-9), ("crank.start_angle", 0.8)];
    for (name, start) in starts {
        assert_eq!(variable(name).start, Some(Value::Real(start)), "{name}");
    }
    let method = variable("solver.method");
    assert_eq!((method.kind, &method.start), (Kind::Enumeration, &Some(Value::Item("reduced".into()))));
    let plain = Model::from_json(&without_method()).unwrap();
    assert!(["solver.method", "solver.fem_step"].iter().all(|name| plain.variables().find(name).is_none()));
    assert_eq!(variable("joint1.force_x").unit, Some(Unit::Newton));
    assert_eq!(variable("crank.speed").unit, Some(Unit::RadianPerSecond));
}

#[test]
fn the_guid_follows_the_interface_not_the_numbers() {
    let guid = |text: &str| Model::from_json(text).unwrap().variables().guid().to_string();
    assert_eq!(guid(GEAR), guid(&GEAR.replace("13.689", "14.0")));
    assert_ne!(guid(GEAR), guid(&GEAR.replace("\"wheel\": { \"at\"", "\"tyre\": { \"at\"")));
}

/// An importer compares the GUID. A saved state is compared with the second number, a hash of the structure of the
/// definition as JSON. If the GUID changes, FMUs of the same `mechanism.json` are not exchangeable any more. If the
/// number changes, as after a new key of the format, states saved by earlier versions are rejected. Both may only
/// change on purpose.
#[test]
fn the_identity_of_the_gear_is_pinned() {
    let gear = Model::from_json(GEAR).unwrap();
    assert_eq!(gear.variables().guid(), "{9aa3b748-7e2b-5e3f-92e1-57c893ee1630}");
    assert_eq!(gear.identity(), [0x6384_0A38_BDB9_9731, 0x2819_ECF5_8EBF_1F15]);
}

/// The gear in the reduced formulation only.
fn without_method() -> String {
    replaced(GEAR, &[(r#", "method": "reduced", "fem_step": 1e-5"#, "")])
}

/// A state without special values, in which a true dependency might vanish by accident.
fn general(text: &str, reduced: bool) -> Run {
    let mut run = Run::new(text).with(&[("friction.enabled", reduced), ("air.relative_wind", reduced)]).with(&[
        ("wheel.force_x", 210.0),
        ("wheel.force_y", -130.0),
        ("crank.torque", 70.0),
        ("follower.torque", -40.0),
        ("crank.start_angle", 0.31),
        ("crank.start_speed", -7.0),
        ("airspeed", if reduced { 60.0 } else { 0.0 }),
    ]);
    if !reduced {
        run.set("solver.method", "rigid_fem");
    }
    run
}

#[test]
fn dependencies_are_true() {
    check_dependencies(&general(&without_method(), true), true);
}

/// Dependencies in a mechanism whose drives, dampers, torsional spring and bumper have curves.
#[test]
fn dependencies_of_curves_are_true() {
    let start = [("crank.start_speed", -14.0), ("crank.start_angle", 0.9), ("motor.command", 0.7)];
    check_dependencies(&Run::new(CURVES).with(&start).with(&[("friction.enabled", true)]), false);
}

/// A force with a delay follows from the inputs of its controller at the start, and from no input at once afterwards.
#[test]
fn dependencies_of_a_delayed_force_are_true() {
    let mut gear: serde_json::Value = serde_json::from_str(&without_method()).unwrap();
    gear["actuators"]["actuator"]["control"] =
        serde_json::json!({ "position_gain": 1e4, "speed_gain": 300, "command": 0.4, "force_time_constant": 0.01 });
    check_dependencies(&general(&gear.to_string(), true), false);
}

/// If the formulation can be chosen, the stated dependencies cover both formulations.
#[test]
fn dependencies_hold_for_both_formulations() {
    for reduced in [true, false] {
        check_dependencies(&general(GEAR, reduced), false);
    }
}

/// Change a Real by 1 %: upwards, or downwards if the larger value is out of range. A 0 becomes 0.05.
fn alter(run: &mut Run, reference: Reference) {
    let value = run.real(reference).unwrap();
    let up = run.set_real(reference, value * 1.01 + if value == 0.0 { 0.05 } else { 0.0 });
    up.or_else(|_| run.set_real(reference, value * 0.99)).unwrap();
}

/// `exactly`: every stated dependency must also be observed.
fn check_dependencies(base: &Run, exactly: bool) {
    let list = base.variables().list().to_vec();
    let initial_dependencies = base.initial_dependencies().unwrap().unwrap();
    // Separate tests cover stops and locks. The limits of a drive follow the present position only if a stop or lock
    // holds.
    let apart = |r: &Reference| {
        let name = &list[*r as usize].name;
        ["upstop", "downstop", "uplock", "downlock"].iter().any(|n| name.starts_with(n)) || name.ends_with("_limit")
    };
    let compare = |when: &str, cause: Reference, effect: Reference, listed: bool, seen: bool| {
        let (from, to) = (&list[cause as usize].name, &list[effect as usize].name);
        assert!(seen == listed || (listed && !exactly), "{when} {to} on {from}: listed {listed}, seen {seen}");
    };
    let refs = |c: Causality| -> Vec<Reference> { reals(base, c).into_iter().filter(|r| !apart(r)).collect() };
    let all = refs(Causality::Output);
    let drift = base.0.reference("energy.drift").unwrap();
    let mut initial = base.clone().started();
    let before = values(&mut initial, &all);
    let known: Vec<Reference> = refs(Causality::Input).into_iter().chain(refs(Causality::Parameter)).collect();
    for &cause in &known {
        let mut changed = base.clone();
        alter(&mut changed, cause);
        match changed.0.initialize() {
            // The finite elements do not support the air.
            Err(refused) if !exactly => {
                assert!(refused.to_string().starts_with("airspeed"), "{refused}");
                continue;
            }
            initialized => initialized.unwrap(),
        }
        let after = values(&mut changed, &all);
        for (k, &effect) in all.iter().enumerate().filter(|(_, e)| **e != drift) {
            let listed = initial_dependencies[effect as usize].contains(&cause);
            // The effect of a change of 1 % is far above the rounding of the tables.
            let seen = (after[k] - before[k]).abs() > 1e-9 * before[k].abs().max(1e-3);
            compare("at the start", cause, effect, listed, seen);
        }
    }
    // Between two steps only inputs may change. They act at once.
    for &cause in &refs(Causality::Input) {
        let mut changed = initial.clone();
        changed.step(1e-3);
        let before = values(&mut changed, &all);
        alter(&mut changed, cause);
        let after = values(&mut changed, &all);
        for (k, &effect) in all.iter().enumerate() {
            let listed = list[effect as usize].dependencies.contains(&cause);
            let seen = (after[k] - before[k]).abs() > 1e-12 * before[k].abs();
            compare("between steps", cause, effect, listed, seen);
        }
    }
}

/// Every mechanism that runs can be packed: a number that two keys must agree on cannot be changed alone, but has
/// dependencies.
#[test]
fn every_mechanism_has_dependencies_of_initial_values() {
    let gears = r#"{ "name": "Gears", "bodies": { "ground": { "points": { "far": [0.3, 0] } },
            "one": { "mass": 1, "inertia": 0.1 }, "two": { "mass": 1, "inertia": 0.1 } },
        "joints": { "a": { "type": "revolute", "first": "ground.origin", "second": "one.origin", "pin_radius": 0.01 },
            "b": { "type": "revolute", "first": "ground.far", "second": "two.origin", "pin_radius": 0.01 } },
        "couplings": { "mesh": { "type": "gears", "first": "one.origin", "second": "two.origin",
            "first_teeth": 20, "second_teeth": 20, "pressure_angle": 0 } },
        "friction": { "enabled": true, "static_coefficient": 0.2, "kinetic_coefficient": 0.1 },
        "start": { "body": "one", "angle": 0 }, "guess": { "one": 0, "two": 0 } }"#;
    let rails = r#"{ "name": "Rails", "bodies": { "ground": { "points": { "upper": [0, 0.2] } },
            "carriage": { "mass": 2, "points": { "upper": [0, 0.2] } } },
        "joints": { "lower": { "type": "prismatic", "first": "ground.origin", "second": "carriage.origin", "angle": 0 },
            "upper": { "type": "prismatic", "first": "ground.upper", "second": "carriage.upper", "angle": 0 } },
        "start": { "joint": "lower", "position": 0 }, "guess": { "lower": 0 } }"#;
    assert!(initial_dependencies(&Mechanism::from_json(gears).unwrap()).unwrap().is_some());
    let model = Run::new(rails).started();
    let [parameter, output] = ["lower.angle", "upper.force_y"].map(|name| model.0.reference(name).unwrap());
    let dependencies = initial_dependencies(&Mechanism::from_json(rails).unwrap()).unwrap().unwrap();
    assert!(dependencies[output as usize].contains(&parameter));
}
