//! Parameters that change between two steps: against runs that start with the new values. A rejected value leaves no
//! trace.
use crate::support::{GEAR, Run};
use linkage_fmu::variables::Variability;

const STEP: f64 = 1e-3;

/// A gear with friction in moving air, at rest at its start, integrated to 1e-12.
fn gear(settings: &[(&str, f64)]) -> Run {
    let gear = Run::gear().with(&[("friction.enabled", true)]);
    gear.with(&[("solver.tolerance", 1e-12), ("airspeed", 60.0)]).with(settings).started()
}

fn run(gear: &mut Run, steps: usize) {
    (0..steps).for_each(|_| gear.step(STEP));
}

fn difference(a: &mut Run, b: &mut Run, name: &str) -> f64 {
    (a.get(name) - b.get(name)).abs()
}

#[test]
fn the_tunable_parameters_are_those_of_laws_and_of_the_integration() {
    let gear = Run::gear();
    let list = gear.variables().list();
    let tunable = list.iter().filter(|variable| variable.variability == Variability::Tunable);
    let names: Vec<&str> = tunable.map(|variable| variable.name.as_str()).collect();
    for name in
        ["solver.tolerance", "friction.static_coefficient", "air.density", "upstop.restitution", "upstop.stiffness"]
    {
        assert!(names.contains(&name), "{name} is not in {names:?}");
    }
    for name in
        ["crank.length", "crank.mass", "upstop.angle", "gravity.acceleration", "crank.start_angle", "solver.fem_step"]
    {
        assert!(list.iter().any(|variable| variable.name == name) && !names.contains(&name), "{name} is in {names:?}");
    }
}

/// Values set before the first step act like start values.
#[test]
fn values_set_before_the_first_step_are_those_of_the_start() {
    let values = [("friction.static_coefficient", 0.3), ("friction.kinetic_coefficient", 0.25), ("air.density", 0.7)];
    let (mut tuned, mut stated) = (gear(&[]), gear(&values));
    tuned.set_all(&values);
    for _ in 0..12 {
        run(&mut tuned, 10);
        run(&mut stated, 10);
        for name in ["crank.angle", "joint2.force"] {
            let size = 1.0 + stated.get(name).abs();
            assert!(difference(&mut tuned, &mut stated, name) <= 1e-13 * size, "{name}");
        }
    }
}

/// A run with a change continues like a run that starts at the change with the new values.
#[test]
fn a_change_within_a_run_leaves_the_motion_and_changes_the_laws() {
    let values = [("friction.kinetic_coefficient", 0.4), ("friction.static_coefficient", 0.5), ("air.density", 2.5)];
    let (mut tuned, mut plain) = (gear(&[]), gear(&[]));
    run(&mut tuned, 60);
    run(&mut plain, 60);
    let before = [tuned.get("crank.angle"), tuned.get("crank.speed")];
    tuned.set_all(&values);
    assert_eq!([tuned.get("crank.angle"), tuned.get("crank.speed")], before);
    let start = [("crank.start_angle", before[0]), ("crank.start_speed", before[1])];
    let mut begun = gear(&[&values[..], &start[..]].concat());
    for _ in 0..6 {
        [&mut tuned, &mut begun, &mut plain].into_iter().for_each(|gear| run(gear, 10));
        // The rounding of the start is 1e-16, the tolerance of both runs 1e-12.
        assert!(difference(&mut tuned, &mut begun, "crank.angle") < 1e-10);
        assert!(tuned.get("energy.drift").abs() < 1e-6);
    }
    assert!(difference(&mut tuned, &mut plain, "crank.angle") > 1e-3);
}

/// If the stiffness of a compressed bumper increases, the additional stored energy counts as external work.
#[test]
fn the_balance_of_energy_continues_when_a_compressed_bumper_changes() {
    let mut gear = Run::gear();
    gear.set("downstop.rigid", false);
    gear.set_all(&[("downstop.stiffness", 1e5), ("actuator.force", -30_000.0), ("solver.tolerance", 1e-12)]);
    gear.initialize();
    run(&mut gear, 5);
    assert!(gear.get("downstop.torque") < -1.0);
    assert_eq!(gear.0.text("contact.mode"), Ok("pushed"));
    let torque = gear.get("downstop.torque");
    gear.set("downstop.stiffness", 2e5);
    let ratio = gear.get("downstop.torque") / torque;
    assert!((ratio - 2.0).abs() < 1e-12, "{ratio}");
    for _ in 0..20 {
        run(&mut gear, 1);
        assert!(gear.get("energy.drift").abs() < 1e-6, "{:?}", gear.get("energy.drift"));
    }
}

/// An impact uses the restitution that is set before the impact.
#[test]
fn a_restitution_acts_at_the_next_impact() {
    let impact = |stated: f64, tuned: Option<f64>| {
        let mut gear = gear(&[("upstop.restitution", stated)]);
        run(&mut gear, 60);
        if let Some(tuned) = tuned {
            gear.set("upstop.restitution", tuned);
        }
        run(&mut gear, 90);
        assert!(gear.get("upstop.impact_count") >= 1.0);
        gear.get("upstop.impact_impulse")
    };
    let [plain, stated, tuned] = [impact(0.0, None), impact(0.5, None), impact(0.0, Some(0.5))];
    assert!((stated - tuned).abs() <= 1e-11 * stated, "{stated} {tuned}");
    // First impact of each run: the impulse is the momentum before plus the momentum after the impact.
    assert!((stated - 1.5 * plain).abs() <= 1e-9 * plain, "{stated} {plain}");
}

/// Values out of range and values that contradict each other change nothing: the results stay bit-identical.
#[test]
fn a_rejected_change_has_no_effect() {
    let stick = GEAR.replacen("\"friction\": {", "\"friction\": { \"law\": \"stick\",", 1);
    assert_ne!(stick, GEAR);
    let mut both = [&stick, &stick].map(|text| {
        let mut gear = Run::new(text);
        gear.set("friction.enabled", true);
        gear.initialize();
        run(&mut gear, 40);
        gear
    });
    // Static friction below kinetic friction, and NaN.
    for (name, value) in
        [("friction.static_coefficient", 1e-6), ("air.density", -1.0), ("upstop.restitution", f64::NAN)]
    {
        assert!(both[0].0.set(name, value).is_err(), "{name}");
    }
    for _ in 0..8 {
        both.iter_mut().for_each(|gear| run(gear, 10));
        let [a, b] = both.each_mut().map(|gear| gear.bits(["crank.angle", "joint1.force", "energy.drift"]));
        assert_eq!(a, b);
    }
}

/// A state saved after a change continues with the changed laws, also in a new model.
#[test]
fn a_saved_state_contains_the_values() {
    let mut tuned = gear(&[]);
    run(&mut tuned, 50);
    for (name, value) in [("friction.kinetic_coefficient", 0.02), ("solver.tolerance", 1e-10)] {
        tuned.set(name, value);
    }
    run(&mut tuned, 3);
    let kept = tuned.saved();
    let continued = |gear: &mut Run| {
        run(gear, 40);
        gear.bits(["crank.angle", "joint2.force", "energy.drift"])
    };
    let first = continued(&mut tuned);
    let fresh = &mut Run::gear().started();
    for gear in [&mut tuned, &mut *fresh] {
        gear.take(&kept);
        assert_eq!(continued(gear), first);
    }
    assert_eq!(fresh.get("friction.kinetic_coefficient"), 0.02);
}
