//! Several drives, some with losses: the required force of each drive follows from the state and the other inputs, and
//! gives the demanded acceleration.

use crate::support::{Run, TWO_DRIVES, assert_says, reals, values};
use linkage_fmu::variables::Causality;
use proptest::prelude::*;
use serde_json::{Value, json};

/// Rounding of the tables (1e-13 of their largest values) and of sums in which drive forces cancel.
const ACCURACY: f64 = 1e-10;
/// Coefficient of friction in every joint, the same at rest and in motion.
const MU: f64 = 0.05;
/// V_S [m/s]: so small that all pins slip faster at almost any speed.
const STATIC_SPEED: f64 = 1e-15;
/// Start speed at which every pin slips faster than V_S, but terms in the square of the speed are below rounding.
const SLOW: f64 = 1e-6;

/// A drive: its name, and whether it is rotary.
type Drive = (&'static str, bool);

/// A slider-crank with two drives, a quick return with three, two loops with a drive in a joint between moving bodies.
const MECHANISMS: [(&str, &[Drive]); 3] = [
    (TWO_DRIVES, &[("servo", true), ("ram", false)]),
    (include_str!("../fixtures/three_drives.json"), &[("servo", true), ("cylinder", false), ("linear", false)]),
    (include_str!("../fixtures/six_bar.json"), &[("cylinder", false), ("servo", true), ("motor", true)]),
];

fn definition(mechanism: usize) -> Value {
    let mut definition: Value = serde_json::from_str(MECHANISMS[mechanism].0).unwrap();
    if mechanism == 0 {
        definition["joints"]["pin"]["pin_radius"] = json!(0.01);
        definition["joints"]["wrist"]["pin_radius"] = json!(0.008);
    }
    definition
}

/// Angle and speed of the crank, forces of the drives, efficiency of each drive that has one, demanded acceleration.
#[derive(Clone, Debug)]
struct Case {
    mechanism: usize,
    friction: bool,
    angle: f64,
    speed: f64,
    forces: [f64; 3],
    efficiencies: [Option<f64>; 3],
    demand: f64,
}

fn cases() -> impl Strategy<Value = Case> {
    let speeds = prop_oneof![Just(0.0), -5.0..5.0f64, -0.01..0.01f64];
    let demands = prop_oneof![Just(0.0), -30.0..30.0f64, -1e-3..1e-3f64];
    let efficiency = || prop_oneof![1 => Just(None), 2 => (0.3..1.0f64).prop_map(Some)];
    let forces = [-20.0..20.0f64, -20.0..20.0f64, -20.0..20.0f64];
    let efficiencies = [efficiency(), efficiency(), efficiency()];
    let all = (0..3usize, any::<bool>(), 0.1..2.4f64, speeds, forces, efficiencies, demands);
    all.prop_map(|numbers| {
        let (mechanism, friction, angle, speed, forces, efficiencies, demand) = numbers;
        Case { mechanism, friction, angle, speed, forces, efficiencies, demand }
    })
}

/// A case's mechanism at its start, with its drives.
fn started(case: &Case) -> (Run, &'static [Drive]) {
    let (mut definition, drives) = (definition(case.mechanism), MECHANISMS[case.mechanism].1);
    for ((name, _), efficiency) in drives.iter().zip(case.efficiencies) {
        if let Some(efficiency) = efficiency {
            definition["actuators"][name]["efficiency"] = json!(efficiency);
        }
    }
    definition["friction"] = json!({
        "enabled": case.friction, "static_coefficient": MU, "kinetic_coefficient": MU, "static_speed": STATIC_SPEED,
    });
    definition["start"]["angle"] = json!(case.angle);
    definition["start"]["speed"] = json!(case.speed);
    let mut run = Run::new(definition.to_string());
    drives.iter().zip(case.forces).for_each(|(drive, force)| run.set(&of(*drive, "force"), force));
    (run.started(), drives)
}

/// Value of an output. A case in which friction locks the mechanism, near a dead centre, is discarded.
fn find(run: &mut Run, name: &str) -> Result<f64, TestCaseError> {
    let value = run.0.get(name).unwrap();
    if value.is_nan() {
        assert_says(run.undefined(name), &["friction locks"]);
        return Err(TestCaseError::reject("friction locks"));
    }
    Ok(value)
}

/// Size of all forces, converted to this drive without losses, for relative errors.
fn size(run: &mut Run, drives: &[Drive], drive: Drive, case: &Case) -> f64 {
    let worst = case.efficiencies.iter().flatten().fold(1.0, |a: f64, b| a.min(*b));
    let scale = |run: &mut Run, drive: Drive| (worst * run.get(&of(drive, "reduced_mass"))).sqrt().recip();
    let own = scale(run, drive);
    let forces: f64 = drives.iter().zip(case.forces).map(|(other, force)| force.abs() * scale(run, *other)).sum();
    let holding = run.get(&of(drive, "holding_force")).abs();
    10.0 * (forces / own + holding + (case.demand.abs() + 10.0 * case.speed.abs().powi(2)) / (own * own))
}

/// Name of a variable of a drive. `quantity` is its name for a linear drive.
fn of((name, is_rotary): Drive, quantity: &str) -> String {
    let quantity =
        if is_rotary { quantity.replace("force", "torque").replace("mass", "inertia") } else { quantity.into() };
    format!("{name}.{quantity}")
}

/// The one-element outputs of the servo, with a second drive (ram) of efficiency 0.5, at rest at 0.9 rad. S is the
/// force of the ram, theta the angle of the crank and phi that of the rod.
#[test]
fn two_drives_one_with_losses_follow_the_closed_form() {
    let (forces, efficiencies) = ([3.0, 50.0, 0.0], [None, Some(0.5), None]);
    let case = Case { mechanism: 0, friction: false, angle: 0.9, speed: 0.0, forces, efficiencies, demand: 0.0 };
    let (mut run, _) = started(&case);
    let (sin, cos) = 0.9_f64.sin_cos();
    let phi = (-sin / 3.0).asin();
    let rod = -0.1 * cos / (0.3 * phi.cos());
    let slide = -0.1 * sin - 0.3 * phi.sin() * rod;
    // Work of gravity per rad at the centres of mass of crank and rod.
    let weight = -9.81 * (1.2 * 0.05 * cos + 0.9 * (0.1 * cos + 0.15 * phi.cos() * rod));
    let holds = |part: f64| -(weight + 50.0 * part * slide);
    // The ram pushes against a crank that turns forward. The ram is then driven back.
    let (all, forward, backward) = (holds(1.0), holds(2.0), holds(0.5));
    for torque in [-5.0, 0.0, 1.5, 3.0, 4.0, 5.0, 6.0, 10.0, 20.0] {
        run.set("servo.torque", torque);
        let near = |reported: f64, expected: f64, what: &str| {
            assert!((reported - expected).abs() < 1e-12 * forward, "{what} at {torque}: {reported}, not {expected}");
        };
        near(run.get("servo.holding_torque"), all, "holding");
        near(run.get("servo.breakaway_torque_forward"), forward, "forward");
        near(run.get("servo.breakaway_torque_backward"), backward, "backward");
        let inertia = run.get("servo.reduced_inertia");
        for (demand, border) in [(20.0, forward), (-20.0, backward), (0.0, all)] {
            run.set("servo.demanded_acceleration", demand);
            let reported = run.get("servo.required_force");
            near(reported, border + inertia * demand, "required");
            run.set("servo.torque", reported);
            assert!((run.get("servo.acceleration") - demand).abs() < 1e-10, "{demand} at {torque}");
            run.set("servo.torque", torque);
        }
        // The static load of the servo depends on its own torque: within the range in which it holds, the ram balances
        // the torque.
        let load = run.get("servo.static_load");
        near(load, torque.clamp(backward, forward), "load");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, failure_persistence: None, ..ProptestConfig::default() })]

    /// Inverse dynamics, then forward dynamics, at rest and in motion.
    #[test]
    fn the_required_force_gives_the_demanded_acceleration(case in cases(), other in -20.0..20.0f64) {
        let (mut run, drives) = started(&case);
        for (&drive, own) in drives.iter().zip(case.forces) {
            let size = size(&mut run, drives, drive, &case);
            let (name, mass) = (drive.0, run.get(&of(drive, "reduced_mass")));
            prop_assume!(mass < 1e3);
            run.set(&format!("{name}.demanded_acceleration"), case.demand);
            let reported = find(&mut run, &format!("{name}.required_force"))?;
            run.set(&of(drive, "force"), other);
            let again = find(&mut run, &format!("{name}.required_force"))?;
            let slack = ACCURACY * (size + own.abs() + other.abs());
            prop_assert!((reported - again).abs() < slack, "{name} with {own}: {reported}, with {other}: {again}");
            run.set(&of(drive, "force"), reported);
            let given = find(&mut run, &of(drive, "acceleration"))?;
            prop_assert!((given - case.demand).abs() * mass < slack, "{name}: {given}, not {}", case.demand);
            run.set(&of(drive, "force"), own);
        }
    }

    #[test]
    fn the_holding_force_lies_between_the_breakaway_forces(case in cases(), other in -20.0..20.0f64) {
        let case = Case { speed: 0.0, ..case };
        let (mut run, drives) = started(&case);
        for (&drive, own) in drives.iter().zip(case.forces) {
            let slack = ACCURACY * (size(&mut run, drives, drive, &case) + own.abs() + other.abs());
            let names = ["breakaway_force_backward", "holding_force", "breakaway_force_forward"];
            let names = names.map(|name| of(drive, name));
            let reported = names.iter().map(|name| find(&mut run, name)).collect::<Result<Vec<_>, _>>()?;
            run.set(&of(drive, "force"), other);
            let again = names.clone().map(|name| run.get(&name));
            for k in 0..3 {
                prop_assert!((reported[k] - again[k]).abs() < slack, "{} {} {}", names[k], reported[k], again[k]);
            }
            prop_assert!(reported[0] < reported[1] + slack && reported[1] < reported[2] + slack, "{} {reported:?}",
                drive.0);
            run.set(&of(drive, "force"), reported[1]);
            let given = run.get(&of(drive, "acceleration"));
            let mass = run.get(&of(drive, "reduced_mass"));
            prop_assert!(given.abs() * mass < slack, "{}: {given}", drive.0);
            run.set(&of(drive, "force"), own);
        }
    }

    /// When every pin slips, a force slightly above the breakaway force accelerates the motion, a smaller force
    /// decelerates it.
    #[test]
    fn the_breakaway_force_overcomes_friction_and_losses(case in cases(), forward in any::<bool>()) {
        let case = Case { speed: 0.0, ..case };
        let (mut rest, drives) = started(&case);
        for &drive in drives {
            let (way, sign) = if forward { ("forward", 1.0) } else { ("backward", -1.0) };
            let reported = find(&mut rest, &of(drive, &format!("breakaway_force_{way}")))?;
            let size = size(&mut rest, drives, drive, &case);
            let mass = rest.get(&of(drive, "reduced_mass"));
            prop_assume!(mass < 1e3);
            for (more, sets_off) in [(1e-6, true), (-1e-6, false)] {
                let mut run = rest.clone();
                run.set(&of(drive, "force"), reported + more * sign * size);
                if !case.friction {
                    let given = run.get(&of(drive, "acceleration")) * sign;
                    prop_assert!((given > 0.0) == sets_off, "at rest: {} {reported}, {more} beyond: {given}", drive.0);
                }
                let mut run = run.with(&[("crank.start_speed", SLOW)]).started();
                if run.get(&format!("{}.speed", drive.0)) * sign < 0.0 {
                    run = run.with(&[("crank.start_speed", -SLOW)]).started();
                }
                let given = find(&mut run, &of(drive, "acceleration"))?;
                prop_assert!((given * sign > 0.0) == sets_off, "{} {reported}, {more} beyond: {given}", drive.0);
            }
        }
    }
}

/// Just below the breakaway torque the mechanism creeps, with some pin slower than V_S. Just above it every pin slips
/// faster than V_S.
#[test]
fn below_the_breakaway_torque_the_mechanism_creeps() {
    const STATIC: f64 = 1e-5;
    let rest = |torque: f64| {
        let mut definition = definition(0);
        definition["actuators"]["ram"]["efficiency"] = json!(0.5);
        definition["friction"] = json!({
            "enabled": true, "static_coefficient": 0.1, "kinetic_coefficient": 0.08, "static_speed": STATIC,
                "kinetic_speed": 0.1,
        });
        Run::new(definition.to_string()).with(&[("servo.torque", torque)]).started()
    };
    let reported = [4.5, 10.0, 12.0].map(|torque| rest(torque).get("servo.breakaway_torque_forward"));
    assert!(reported.iter().all(|t| (t - reported[0]).abs() < 1e-12 * reported[0]), "{reported:?}");
    for (part, goes) in [(0.9, false), (0.999, false), (1.001, true), (1.1, true)] {
        let mut run = rest(part * reported[0]);
        run.step(0.1);
        let (crank, rod, guide) = (run.get("crank.speed"), run.get("rod.speed"), run.get("guide.speed"));
        let slips = [0.01 * crank, 0.01 * (rod - crank), 0.008 * rod, guide].map(f64::abs);
        assert_eq!(slips.iter().all(|v| *v > STATIC), goes, "{part} of {}: {slips:?} m/s", reported[0]);
    }
}

/// The stated dependencies of a drive's outputs are those inputs that change the outputs, over states at rest and in
/// motion, with drives that hold and drives that do not.
#[test]
fn dependencies_of_drives_are_true() {
    let efficiencies = [None, Some(0.5), Some(0.8)];
    for mechanism in 0..3 {
        let case =
            |speed, forces| Case { mechanism, friction: false, angle: 0.9, speed, forces, efficiencies, demand: 0.0 };
        let cases = [
            case(0.0, [3.0, 50.0, -4.0]),
            case(0.0, [0.5, 1.0, 0.7]),
            case(0.0, [3.0, -9.0, 4.0]),
            case(0.7, [3.0, 50.0, -4.0]),
            case(-0.7, [-3.0, 50.0, 4.0]),
        ];
        let (model, _) = started(&cases[0]);
        let list = model.variables().list();
        let outputs = reals(&model, Causality::Output);
        for input in reals(&model, Causality::Input) {
            let mut seen = vec![false; outputs.len()];
            for mut run in cases.iter().map(|case| started(case).0) {
                let value = run.real(input).unwrap();
                let mut all = |value: f64| -> Vec<f64> {
                    run.set_real(input, value).unwrap();
                    values(&mut run, &outputs)
                };
                let before = all(value);
                for other in [-value, value + 1.0, value - 2.0, 3.0 * value, 30.0, -30.0] {
                    let after = all(other);
                    for (seen, (a, b)) in seen.iter_mut().zip(before.iter().zip(&after)) {
                        *seen |= (a - b).abs() > 1e-9 * (1.0 + a.abs() + b.abs());
                    }
                }
            }
            for (&output, seen) in outputs.iter().zip(seen) {
                let output = &list[output as usize];
                let listed = output.dependencies.contains(&input);
                let terms = ["static_load", "required_force", ".holding_", ".breakaway_"];
                let exactly = terms.iter().any(|term| output.name.contains(term));
                let name = &list[input as usize].name;
                assert!(seen == listed || (listed && !exactly), "{} on {name}: listed {listed}", output.name);
            }
        }
    }
}

/// The holding force is without losses and depends on no efficiency. The breakaway forces depend on the efficiencies.
#[test]
fn the_holding_force_depends_on_no_efficiency() {
    let (forces, efficiencies) = ([3.0, 20.0, -5.0], [Some(0.9), Some(0.5), None]);
    let case = Case { mechanism: 1, friction: true, angle: 0.9, speed: 0.0, forces, efficiencies, demand: 0.0 };
    let (mut run, _) = started(&case);
    let initial = run.initial_dependencies().unwrap().unwrap();
    let parameters = ["servo.efficiency", "cylinder.efficiency"];
    for (output, on) in [
        ("servo.holding_torque", [false, false]),
        ("linear.holding_force", [false, false]),
        ("servo.breakaway_torque_forward", [true, true]),
        ("linear.breakaway_force_backward", [true, true]),
        ("linear.required_force", [true, true]),
    ] {
        let reference = |name| run.0.reference(name).unwrap();
        let listed = parameters.map(|p| initial[reference(output) as usize].contains(&reference(p)));
        assert_eq!(listed, on, "{output}");
        let before = run.get(output);
        let (mut changed, _) = started(&Case { efficiencies: [Some(0.8), Some(0.4), None], ..case.clone() });
        assert_eq!((changed.get(output) - before).abs() > 1e-9, on[0] && output != "linear.required_force", "{output}");
    }
}
