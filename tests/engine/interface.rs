//! The gear's interface: names, units, start values, and dependencies that are true to the code.

use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind, Reference, Unit, Value};

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");

#[test]
fn the_names_are_the_contract() {
    let model = Model::from_json(GEAR).unwrap();
    let with = |causality| -> Vec<&str> {
        model.variables().list().iter().filter(|v| v.causality == causality).map(|v| v.name.as_str()).collect()
    };
    let inputs = "actuator.force load_factor wheel.force_x wheel.force_y crank.torque follower.torque \
        actuator.demanded_acceleration airspeed uplock.engage downlock.engage";
    assert_eq!(with(Causality::Input).join(" "), inputs);
    let outputs = "crank.angle crank.speed crank.acceleration coupler.angle coupler.speed coupler.acceleration \
        follower.angle follower.speed follower.acceleration \
        joint1.force_x joint1.force_y joint1.force joint1.friction_torque \
        joint2.force_x joint2.force_y joint2.force joint2.friction_torque \
        joint3.force_x joint3.force_y joint3.force joint3.friction_torque \
        joint4.force_x joint4.force_y joint4.force joint4.friction_torque \
        actuator.length actuator.speed actuator.acceleration actuator.reduced_mass \
        actuator.reduced_mass_derivative actuator.static_load actuator.additional_force actuator.required_force \
        actuator.holding_force actuator.breakaway_force_forward actuator.breakaway_force_backward \
        wheel.x wheel.y wheel.velocity_x wheel.velocity_y wheel.acceleration_x wheel.acceleration_y \
        leg.drag wheel.drag retracted upstop.torque extended downstop.torque uplock.force downlock.force energy.kinetic energy.potential energy.drift";
    assert_eq!(with(Causality::Output).join(" "), outputs);
    let parameters = with(Causality::Parameter);
    for name in [
        "crank.length",
        "crank.start_angle",
        "crank.start_speed",
        "solver.tolerance",
        "solver.fem_step",
        "solver.method",
        "crank.axial_stiffness",
        "coupler.axial_stiffness",
        "follower.axial_stiffness",
        "leg.mass",
        "wheel.mass",
    ] {
        assert!(parameters.contains(&name), "{name}");
    }
    let starts =
        [("actuator.force", 30_000.0), ("load_factor", 3.0), ("solver.tolerance", 1e-9), ("crank.start_angle", 0.8)];
    for (name, start) in starts {
        let variable = model.variables().get(model.variables().find(name).unwrap()).unwrap();
        assert_eq!(variable.start, Some(Value::Real(start)), "{name}");
    }
    let method = model.variables().get(model.variables().find("solver.method").unwrap()).unwrap();
    assert_eq!((method.kind, &method.start), (Kind::String, &Some(Value::String("reduced".into()))));
    let plain = Model::from_json(&without_method()).unwrap();
    assert!(["solver.method", "solver.fem_step"].iter().all(|name| plain.variables().find(name).is_none()));
    let unit = |name: &str| model.variables().get(model.variables().find(name).unwrap()).unwrap().unit;
    assert_eq!(unit("joint1.force_x"), Some(Unit::Newton));
    assert_eq!(unit("crank.speed"), Some(Unit::RadianPerSecond));
}

#[test]
fn the_guid_follows_the_interface_not_the_numbers() {
    let guid = |text: &str| Model::from_json(text).unwrap().variables().guid().to_string();
    assert_eq!(guid(GEAR), guid(&GEAR.replace("13.689", "14.0")));
    assert_ne!(guid(GEAR), guid(&GEAR.replace("\"wheel\": { \"at\"", "\"tyre\": { \"at\"")));
}

/// The gear in one formulation only.
fn without_method() -> String {
    let text = GEAR.replace(r#", "method": "reduced", "fem_step": 1e-5"#, "");
    assert_ne!(text, GEAR);
    text
}

/// Away from the special values of the defaults, where a true dependency may vanish by accident.
fn general(text: &str, reduced: bool) -> Model {
    let mut model = Model::from_json(text).unwrap();
    for (name, value) in [
        ("wheel.force_x", 210.0),
        ("wheel.force_y", -130.0),
        ("crank.torque", 70.0),
        ("follower.torque", -40.0),
        ("crank.start_angle", 0.31),
        ("crank.start_speed", -7.0),
        ("airspeed", if reduced { 60.0 } else { 0.0 }),
    ] {
        let reference = model.variables().find(name).unwrap();
        model.set_real(reference, value).unwrap();
    }
    for name in ["friction.enabled", "air.relative_wind"] {
        let reference = model.variables().find(name).unwrap();
        model.set_boolean(reference, reduced).unwrap();
    }
    if !reduced {
        let method = model.variables().find("solver.method").unwrap();
        model.set_text(method, "rigid_fem").unwrap();
    }
    model
}

fn outputs(model: &mut Model, references: &[Reference]) -> Vec<f64> {
    references.iter().map(|&r| model.real(r).unwrap()).collect()
}

#[test]
fn dependencies_are_true() {
    check_dependencies(&general(&without_method(), true), true);
}

/// Where the formulation can be chosen, the dependencies told are those of both.
#[test]
fn dependencies_hold_for_both_formulations() {
    for reduced in [true, false] {
        check_dependencies(&general(GEAR, reduced), false);
    }
}

/// `exactly`: what is told is seen too.
fn check_dependencies(base: &Model, exactly: bool) {
    let list = base.variables().list().to_vec();
    let initial_dependencies = base.initial_dependencies().unwrap();
    let refs = |c: Causality| -> Vec<Reference> {
        (0..list.len() as Reference).filter(|&r| list[r as usize].causality == c).collect()
    };
    // Booleans, stops and locks have a test of their own.
    let apart = |r: Reference| {
        let v = &list[r as usize];
        v.kind != Kind::Real || ["upstop", "downstop", "uplock", "downlock"].iter().any(|n| v.name.starts_with(n))
    };
    let refs = |c: Causality| -> Vec<Reference> { refs(c).into_iter().filter(|r| !apart(*r)).collect() };
    let all = refs(Causality::Output);
    let drift = base.variables().find("energy.drift").unwrap();
    let mut initial = base.clone();
    initial.initialize().unwrap();
    let before = outputs(&mut initial, &all);
    let known: Vec<Reference> = refs(Causality::Input).into_iter().chain(refs(Causality::Parameter)).collect();
    for &cause in &known {
        let mut changed = base.clone();
        let value = changed.real(cause).unwrap();
        changed.set_real(cause, value * 1.01 + if value == 0.0 { 0.05 } else { 0.0 }).unwrap();
        match changed.initialize() {
            // The air, which one formulation has not.
            Err(refused) if !exactly => {
                assert!(refused.to_string().starts_with("airspeed"), "{refused}");
                continue;
            }
            initialized => initialized.unwrap(),
        }
        let after = outputs(&mut changed, &all);
        for (k, &effect) in all.iter().enumerate().filter(|(_, e)| **e != drift) {
            let told = initial_dependencies[effect as usize].contains(&cause);
            // A change of a hundredth shows far above the rounding of the tables.
            let seen = (after[k] - before[k]).abs() > 1e-9 * before[k].abs().max(1e-3);
            let (from, to) = (&list[cause as usize].name, &list[effect as usize].name);
            assert!(seen == told || (told && !exactly), "at the start {to} on {from}: {} to {}", before[k], after[k]);
        }
    }
    // Between steps: only inputs act, at once.
    for &cause in &refs(Causality::Input) {
        let mut changed = initial.clone();
        changed.step(1e-3).unwrap();
        let before = outputs(&mut changed, &all);
        let value = changed.real(cause).unwrap();
        changed.set_real(cause, value * 1.01 + if value == 0.0 { 0.05 } else { 0.0 }).unwrap();
        let after = outputs(&mut changed, &all);
        for (k, &effect) in all.iter().enumerate() {
            let told = list[effect as usize].dependencies.contains(&cause);
            let seen = (after[k] - before[k]).abs() > 1e-12 * before[k].abs();
            let (from, to) = (&list[cause as usize].name, &list[effect as usize].name);
            assert!(seen == told || (told && !exactly), "between steps {to} on {from}: {} to {}", before[k], after[k]);
        }
    }
}
