//! Model exchange of laws that switch: detents, points of a slot, friction in joints that turn back, integral parts.
use super::{assert_same, both, changes, check_slopes, indicators, integrate, present, rates, started, states};
use linkage_fmu::fmi3::types::Status;
use linkage_fmu::simulation::Simulation;
use std::f64::consts::PI;

/// A block that a drive with an integral part moves against static friction.
const INTEGRATING: &str = include_str!("../../fixtures/integrating_drive.json");
/// A slider-crank that turns against constant friction in its slide and at the wrist, with friction that reactions
/// cause if it is enabled.
const TURNING: &str = include_str!("../../fixtures/turning_friction.json");
/// Gears with a pressure angle on pins with friction, with a spring.
const TEETH: &str = include_str!("../../fixtures/rubbing_teeth.json");
/// A crank whose coupler runs in a curved track, held by a detent, with a drive with losses between two bodies.
const TRACK: &str = include_str!("../../fixtures/track_with_detent.json");

/// A detent releases at an event, when the load exceeds its force. Then the pin runs along its track, whose points are
/// events.
#[test]
fn a_detent_releases_and_points_of_a_slot_are_passed_at_events() {
    let fmu = started(TRACK);
    let names = fmu.vrs(["c.position", "crank.angle", "c.force", "detent.force", "motor.torque"]);
    // The torque about the crank that the detent holds is 0.15 * 12 = 1.8 N.m, less the other loads.
    let held = 0.15 * (fmu.read(&names)[3] - 12.0);
    let limit = fmu.read(&names)[4] - held;
    let at_rest = indicators(&fmu);
    for (torque, releases) in [(limit - 1e-6, false), (limit + 1e-6, true)] {
        assert_eq!(fmu.set_reals(&names[4..], &[torque]), Status::Ok);
        let crosses = indicators(&fmu).iter().zip(&at_rest).any(|(z, before)| z * before < 0.0);
        assert_eq!(crosses, releases, "{torque}");
        assert_eq!(rates(&fmu, states(&fmu))[1] == 0.0, !releases);
    }
    assert_eq!(fmu.enter_event_mode(), Status::Ok);
    changes(&fmu);
    assert_eq!(fmu.enter_continuous_time_mode(), Status::Ok);
    assert!(indicators(&fmu).iter().all(|z| z.is_finite()));
    let mut run = Simulation::open(TRACK).unwrap();
    run.set("motor.torque", limit + 1e-6).unwrap();
    run.initialize().unwrap();
    let points = run.model_mut().reduced().unwrap().linkage().slots[0].track.knots().to_vec();
    let mut passed = 0;
    for k in 1..=12 {
        let before = fmu.read(&names)[0];
        let count = integrate(&fmu, 0.02, 2e-5).len();
        run.step(0.02).unwrap();
        let after = fmu.read(&names);
        for (n, name) in ["c.position", "crank.angle", "c.force"].into_iter().enumerate() {
            let expected = run.get(name).unwrap();
            assert!((after[n] - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{k} {name}: {} {expected}", after[n]);
        }
        let met = points.iter().filter(|s| (before - *s) * (after[0] - *s) < 0.0).count();
        assert!(count >= met, "{k}: {count} events, {met} points");
        passed += met;
    }
    assert!(passed >= 2, "{passed}");
    check_slopes(&fmu, "motor.torque");
}

/// The slide turns back at the dead centres of the crank, the rod turns back where the crank is upright: there the
/// friction of these joints changes its direction, which is an event. The motion is that of co-simulation.
#[test]
fn friction_changes_its_direction_at_an_event() {
    for enabled in [false, true] {
        let text = TURNING.replace("\"enabled\": false", &format!("\"enabled\": {enabled}"));
        let (fmu, mut run) = both(&text);
        for k in 1..=60 {
            let before = fmu.get(["crank.angle"])[0];
            let count = integrate(&fmu, 0.02, if enabled { 1e-4 } else { 1e-3 }).len();
            run.step(0.02).unwrap();
            let [angle, speed] = fmu.get(["crank.angle", "crank.speed"]);
            let exact = ["crank.angle", "crank.speed"].map(|name| run.get(name).unwrap());
            // Where friction changes the reactions that cause it, the acceleration jumps within a step of this method.
            let allowed = if enabled { 1e-4 } else { 1e-9 };
            let error = (angle - exact[0]).abs().max(0.1 * (speed - exact[1]).abs());
            assert!(error < allowed, "{k}: {angle} {speed} {exact:?}");
            let quarters = |angle: f64| (angle / (0.5 * PI)).floor();
            let expected = (quarters(angle) - quarters(before)) as usize;
            // Where friction depends on the slip speed, an end of its regimes is an event too.
            let is_found = if enabled { count >= expected } else { count == expected };
            assert!(is_found, "{k}: {count} events from {before} to {angle}");
        }
        assert!(fmu.get(["crank.angle"])[0] > 10.0);
    }
}

/// The teeth of gears press shafts onto pins with friction. The other flanks bear where the force between the teeth
/// passes 0, which is an event.
#[test]
fn teeth_change_flanks_at_an_event() {
    let (fmu, mut run) = both(TEETH);
    let mut changed = 0;
    for k in 1..=8 {
        let before = fmu.get(["mesh.transmitted_force"])[0];
        let count = integrate(&fmu, 0.01, 1e-4).len();
        run.step(0.01).unwrap();
        let names = ["one.angle", "one.speed", "mesh.transmitted_force", "b.friction_torque"];
        let values = assert_same(&fmu, &mut run, names, 1e-8);
        let changes = before * values[2] < 0.0;
        assert!(!changes || count > 0, "{k}: {count} events");
        changed += u32::from(changes);
    }
    assert!(changed > 0);
}

/// A block on which static friction acts, with a controller that has an integral part and a limit of its force: the
/// integral part is a state, the block breaks away and sticks at events, and the motion is that of co-simulation.
#[test]
fn an_integral_part_is_exchanged() {
    let (fmu, mut run) = both(INTEGRATING);
    let names = ["slide.position", "slide.speed", "motor.integral_force", "motor.integral_force_rate"];
    let (mut stuck, mut slipped, mut reversed) = (0, 0, false);
    for k in 1..=42 {
        let count = integrate(&fmu, 0.05, 1e-4).len();
        run.step(0.05).unwrap();
        // At the reversal friction jumps by 6 m/s2 within one step of this method.
        reversed |= slipped > 0 && run.get("slide.speed").unwrap() >= 0.0;
        let values = assert_same(&fmu, &mut run, names, if reversed { 1e-2 } else { 1e-8 });
        assert_eq!(present(&fmu)[2], values[2]);
        // Where it breaks away again, after a time of which the solver knows nothing.
        assert!(k != 19 || count == 1, "{count} events");
        stuck += u32::from(values[1] == 0.0);
        slipped += u32::from(values[1] != 0.0);
    }
    assert!(stuck > 5 && slipped > 5, "{stuck} {slipped}");
    // Derivatives along the integral part, in motion.
    let fmu = started(INTEGRATING);
    while fmu.get(["slide.speed"])[0] == 0.0 || fmu.get(["motor.acting_force"])[0].abs() == 9.0 {
        integrate(&fmu, 0.05, 1e-3);
    }
    let [a, integral, rate, force] = fmu.vrs([
        "along_curve.acceleration",
        "motor.integral_force",
        "motor.integral_force_rate",
        "motor.acting_force",
    ]);
    let mut slopes = [f64::NAN; 3];
    assert_eq!(fmu.derivative(false, &[a, rate, force], &[integral], &[1.0], &mut slopes), Status::Ok);
    // A block of 2 kg.
    for (slope, exact) in slopes.into_iter().zip([0.5_f64.sqrt(), 0.0, 1.0]) {
        assert!((slope - exact).abs() < 1e-12, "{slope} {exact}");
    }
    let mut nominals = [f64::NAN; 3];
    assert_eq!((fmu.nominals(&mut nominals), nominals[2] > 0.0), (Status::Ok, true));
    let mut y = present(&fmu);
    y[2] = f64::NAN;
    assert_eq!((fmu.set_states(&y), fmu.set_states(&y[..2])), (Status::Discard, Status::Error));
}

/// The same block, whose force follows that of the controller at a limited rate: the force is a state and an output.
/// The block breaks away at an event, and the rate leaves its limit and comes to the other one at events.
#[test]
fn a_delayed_force_is_exchanged() {
    let delay = "\"integral_gain\": 400, \"force_time_constant\": 0.02, \"max_force_rate\": 70, \"start_force\": 0,";
    let text = INTEGRATING.replace("\"integral_gain\": 400,", delay).replace("-0.1", "0.3");
    let (fmu, mut run) = both(&text);
    let names =
        ["slide.position", "slide.speed", "motor.integral_force", "motor.acting_force", "motor.acting_force_rate"];
    let (mut limited, mut stuck, mut events, mut slopes) = ([0; 2], 0, 0, 0);
    for _ in 0..15 {
        events += integrate(&fmu, 0.05, 5e-5).len();
        run.step(0.05).unwrap();
        let values = assert_same(&fmu, &mut run, names, 1e-6);
        assert_eq!(present(&fmu)[2..], values[2..4]);
        stuck += usize::from(values[1] == 0.0);
        let is_limited = values[4].abs() == 70.0;
        limited[usize::from(values[4] > 0.0)] += usize::from(is_limited);
        if values[1] != 0.0 && !is_limited {
            slopes += 1;
            let all = fmu.vrs(["along_curve.acceleration", "motor.acting_force_rate", "motor.acting_force"]);
            let mut found = [f64::NAN; 3];
            assert_eq!(fmu.derivative(false, &all, &all[2..], &[1.0], &mut found), Status::Ok);
            for (slope, exact) in found.into_iter().zip([0.5_f64.sqrt(), -50.0, 1.0]) {
                assert!((slope - exact).abs() < 1e-10, "{slope} {exact}");
            }
        }
    }
    assert!(limited.into_iter().all(|count| count > 0) && stuck > 0 && slopes > 0, "{limited:?} {stuck} {slopes}");
    assert!(events > 2, "{events} events");
}

/// A block of 3 kg on a slide along x, with these keys of the slide and these elements.
fn block(slide: &str, elements: &str) -> String {
    format!(
        r#"{{ "name": "Block", "bodies": {{ "ground": {{}}, "block": {{ "mass": 3 }} }}, "guess": {{ "slide": 0 }},
        "joints": {{ "slide": {{ "type": "prismatic", "first": "ground.origin", "second": "block.origin"{slide} }} }},
        "solver": {{ "tolerance": 1e-12 }}, {elements} }}"#
    )
}

/// A latch at a bumper engages at an event, when the bumper pushes hard enough. The block is caught where it leaves the
/// bumper, until the input releases it.
#[test]
fn a_latch_engages_at_an_event() {
    let text = block(
        "",
        r#""stops": { "end": { "joint": "slide", "limit": "lower", "position": 0, "rigid": false, "stiffness": 4000 } },
        "locks": { "latch": { "stop": "end", "at": "block.origin", "engage": true, "engage_force": 60 } },
        "start": { "joint": "slide", "position": 0.4, "speed": -0.8 }"#,
    );
    let omega = f64::sqrt(4000.0 / 3.0);
    let engaged = |fmu: &super::Fmu| {
        let mut value = 0;
        assert_eq!(fmu.boolean(fmu.vr("latch.engaged"), &mut value), Status::Ok);
        value == 1
    };
    let fmu = started(&text);
    assert!(!engaged(&fmu));
    let mut events = integrate(&fmu, 0.65, 1e-3);
    // An undamped bumper lets go at the very place where the latch catches: several events at one instant.
    events.dedup_by(|later, event| *later - *event < 1e-9);
    let expected = [0.5, 0.5 + (60.0 / (0.8 * f64::sqrt(4000.0 * 3.0))).asin() / omega, 0.5 + PI / omega];
    assert_eq!(events.len(), 3, "{events:?}");
    events.iter().zip(expected).for_each(|(event, expected)| assert!((event - expected).abs() < 1e-7, "{events:?}"));
    assert!(engaged(&fmu));
    let [x, v] = fmu.get(["slide.position", "slide.speed"]);
    assert!(x.abs() < 1e-12 && v == 0.0, "{x} {v}");
    assert!(indicators(&fmu).iter().all(|z| *z > 0.0));
}

/// The borders of viscous friction on a conveyor are events, also where the speed of the belt decides on them.
#[test]
fn a_conveyor_is_exchanged() {
    let text = block(
        r#", "surface_speed": 1.5"#,
        r#""gravity": { "acceleration": 9.81, "up_angle": 1.5707963267948966 }, "friction": { "enabled": true,
        "static_coefficient": 0.4, "kinetic_coefficient": 0.2, "static_speed": 0.1, "kinetic_speed": 0.6 },
        "start": { "joint": "slide", "position": 0 }"#,
    );
    let (fmu, mut run) = both(&text);
    let mut count = 0;
    for _ in 0..10 {
        count += integrate(&fmu, 0.1, 5e-4).len();
        run.step(0.1).unwrap();
        let names = ["slide.position", "slide.speed", "slide.slip_speed", "slide.surface_power"];
        assert_same(&fmu, &mut run, names, 1e-8);
    }
    assert_eq!(count, 2);
}

/// A parcel on a spring sticks to its conveyor and slips, each at an event, in steps of 0.2 s that end between events.
/// A belt that is set to another speed lets the parcel slip, until it has that speed.
#[test]
fn a_conveyor_that_holds_its_parcel_is_exchanged() {
    let text = block(
        r#", "surface_speed": 0.5"#,
        r#""gravity": { "acceleration": 9.81, "up_angle": 1.5707963267948966 }, "friction": { "enabled": true,
        "law": "stick", "static_coefficient": 0.4, "kinetic_coefficient": 0.25, "static_speed": 0, "kinetic_speed": 0 },
        "springs": { "spring": { "joint": "slide", "stiffness": 50 } }, "forces": { "pull": { "at": "block.origin" } },
        "start": { "joint": "slide", "position": 0 }"#,
    );
    let (fmu, mut run) = both(&text);
    run.model_mut().listen(true, false);
    let (mut count, mut reported) = (0, 0);
    let all = ["slide.position", "slide.speed", "slide.slip_speed", "slide.friction_force", "slide.surface_power"];
    for k in 0..20 {
        if k == 10 {
            assert!(run.get("slide.slip_speed").unwrap().abs() < 1e-12);
            let [input, force, rate] = fmu.vrs(["pull.force_x", "slide.friction_force", "along_curve.acceleration"]);
            let mut slopes = [f64::NAN; 2];
            assert_eq!(fmu.derivative(false, &[force, rate], &[input], &[1.0], &mut slopes), Status::Ok);
            assert!((slopes[0] + 1.0).abs() < 1e-14 && slopes[1].abs() < 1e-14, "{slopes:?}");
            assert_eq!(fmu.enter_event_mode(), Status::Ok);
            assert_eq!(fmu.set_reals(&fmu.vrs(["slide.surface_speed"]), &[0.3]), Status::Ok);
            changes(&fmu);
            assert_eq!(fmu.enter_continuous_time_mode(), Status::Ok);
            run.set("slide.surface_speed", 0.3).unwrap();
        }
        count += integrate(&fmu, 0.2, 5e-4).len();
        run.step(0.2).unwrap();
        reported += run.model_mut().take_occurrences(0.0).len();
        assert_same(&fmu, &mut run, all, 1e-7);
    }
    assert_eq!((count, reported), (7, 7));
}
