//! Motions and reactions against the Newton-Euler equations of each body, from the definition, positions,
//! accelerations, joint forces and the sizes of the loads. Friction torques and drag act on the bodies too.
use crate::support::oracle::Motion;
use crate::support::oracle::linkage::{Coordinate, Freedom, Linkage};
use crate::support::{CRANE, FOUR_BAR, GEAR, JIB, Run, SLIDER_CRANK, Vec2, changed, turned, without_stops};
use proptest::prelude::*;
use serde_json::{Value, json};

/// The linkage of a definition under the present loads of its run.
fn loaded(definition: &Value, run: &mut Run) -> Linkage {
    let mut linkage = Linkage::read(definition);
    let of = |group: &str| definition[group].as_object().cloned().unwrap_or_default();
    linkage.loads.gravity.2 = run.get("load_factor");
    for (name, drive) in of("actuators") {
        if let Some(first) = drive["first"].as_str() {
            let [a, b] = [first, drive["second"].as_str().unwrap()].map(|at| linkage.point(at));
            linkage.loads.pushes.push((a, b, run.get(&format!("{name}.force"))));
        } else {
            let joint = linkage.joints.iter().find(|joint| drive["joint"] == *joint.name).unwrap();
            let (first, second, torque) = (joint.first.body, joint.second.body, run.get(&format!("{name}.torque")));
            linkage.loads.torques.extend([(second, torque), (first, -torque)]);
        }
    }
    for (name, force) in of("forces") {
        linkage.loads.forces.push((linkage.point(force["at"].as_str().unwrap()), run.force(&name)));
    }
    for (name, torque) in of("torques") {
        linkage.loads.torques.push((linkage.body(torque["on"].as_str().unwrap()), run.get(&format!("{name}.torque"))));
    }
    for joint in linkage.joints.clone() {
        if let Ok(torque) = run.0.get(&format!("{}.friction_torque", joint.name)) {
            linkage.loads.torques.extend([(joint.second.body, torque), (joint.first.body, -torque)]);
        }
    }
    linkage
}

/// Largest violation of a body's balance in the present state of a run.
fn imbalance(linkage: &Linkage, run: &mut Run) -> f64 {
    let coordinates = linkage.coordinates().into_iter().map(|coordinate| {
        let value = if matches!(coordinate, Coordinate::Angle(_)) { "angle" } else { "position" };
        [value, "speed", "acceleration"].map(|of| run.get(&format!("{}.{of}", linkage.name(coordinate))))
    });
    let state: Vec<_> = coordinates.collect();
    let reactions = linkage.joints.iter().map(|joint| {
        let is_pin = matches!(joint.freedom, Freedom::Revolute);
        (run.force(&joint.name), if is_pin { 0.0 } else { run.get(&format!("{}.torque", joint.name)) })
    });
    let reactions: Vec<_> = reactions.collect();
    Motion::of(linkage, &state).imbalance(&reactions)
}

/// Of more than eight acting loads the reactions are summed up before they are read, of fewer afterwards.
#[test]
fn every_body_is_in_balance_under_many_and_few_loads_that_change() {
    let names: Vec<String> = (0..6).flat_map(|k| ["x", "y"].map(|axis| format!("f{k}.force_{axis}"))).collect();
    let text = changed(without_stops(), |m| {
        for k in 0..6 {
            let at = ["coupler.end", "wheel.origin", "crank.end"][k % 3];
            m["forces"][format!("f{k}")] = json!({ "at": at });
        }
    });
    let definition = serde_json::from_str(&text).unwrap();
    let mut gear = Run::new(&text);
    gear.place(("crank.start_angle", 0.2), ("crank.start_speed", 3.0));
    for (change, acting) in [12, 12, 11, 3, 3, 0, 7, 12].into_iter().enumerate() {
        for (k, name) in names.iter().enumerate() {
            gear.set(name, if k < acting { 900.0 * (k as f64 - 4.5) + 100.0 * change as f64 } else { 0.0 });
        }
        let worst = imbalance(&loaded(&definition, &mut gear), &mut gear);
        assert!(worst < 1e-10, "imbalance {worst:e} under {acting} loads");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn every_body_is_in_balance_without_and_with_friction_and_drag(
        start in -1.3..1.3f64,
        speed in -60.0..60.0f64,
        loads in [-4e4..4e4f64, -6.0..6.0f64, -5e3..5e3f64, -5e3..5e3f64, -4e3..4e3f64, -4e3..4e3f64],
        airspeed in -90.0..90.0f64,
    ) {
        let names =
            ["actuator.force", "load_factor", "wheel.force_x", "wheel.force_y", "crank.torque", "follower.torque"];
        for (friction, airspeed) in [(false, 0.0), (true, airspeed)] {
            let text = changed(without_stops(), |m| {
                m["friction"]["enabled"] = json!(friction);
                m["bodies"]["leg"]["points"] = json!({ "middle": [0.5 * 0.759, 0] });
            });
            let mut gear = Run::shared(&text).with(&[("airspeed", airspeed)]);
            names.iter().zip(loads).for_each(|(name, value)| gear.set(name, value));
            gear.place(("crank.start_angle", start), ("crank.start_speed", speed));
            gear.step(2e-4);
            let mut linkage = loaded(&serde_json::from_str(&text).unwrap(), &mut gear);
            for (name, at) in [("leg.drag", "leg.middle"), ("wheel.drag", "wheel.origin")] {
                let drag = turned(Vec2::new(gear.get(name), 0.0), 1.13 - std::f64::consts::FRAC_PI_2);
                linkage.loads.forces.push((linkage.point(at), drag));
            }
            let worst = imbalance(&linkage, &mut gear);
            prop_assert!(worst < 1e-10, "imbalance {worst:e}");
        }
    }
}

/// Each mechanism under its own loads, from the start on.
#[test]
fn every_body_of_other_mechanisms_is_in_balance() {
    for (name, text) in
        [("crane", CRANE), ("four-bar", FOUR_BAR), ("gear", GEAR), ("jib", JIB), ("slider-crank", SLIDER_CRANK)]
    {
        let definition: Value = serde_json::from_str(text).unwrap();
        let mut run = Run::new(text).started();
        for step in 0..10 {
            let linkage = loaded(&definition, &mut run);
            let worst = imbalance(&linkage, &mut run);
            assert!(worst < 1e-10, "{name} at step {step}: imbalance {worst:e}");
            run.step(1e-3);
        }
    }
}
