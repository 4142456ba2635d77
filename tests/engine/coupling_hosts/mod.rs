//! The landing gear and its hydraulic actuator as two models in hosts of several kinds, against both as a single
//! system: rest at stops and locks, release, changing steps, jumps of command and load.
use crate::hydraulic_pair::{ACTUATOR, Actuator, Gear as Mechanism, hermite};
use crate::support::{GEAR, HYDRAULIC_GEAR};
use linkage_fmu::hydraulics;
use linkage_fmu::mechanism;

mod ends;
mod load_jump;

/// Relative tolerance of the integrations.
const TOLERANCE: f64 = 1e-11;
/// Inputs of the actuator that are outputs of the gear with the same name.
const SHARED: &str = "length speed reduced_mass reduced_mass_derivative holding_force holding_force_derivative \
    lower_limit upper_limit";

/// How a host exchanges values.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Host {
    /// The mean force, held over the step. The actuator keeps its predicted motion.
    Held,
    /// The force as a linear function of time.
    Line,
    /// The linear force. The actuator then repeats the step with the motion of the gear.
    TwoPasses,
    /// The mean force, held. All values arrive one step late (coupling mode `delayed`).
    Late,
    /// As `Late`, but the host reads the outputs of the gear after it has set its inputs.
    LateFed,
}

/// A value that a host sets: of the gear, of a Boolean input of the gear, or of the circuit.
#[derive(Clone, Copy, Debug)]
enum Set {
    Gear(&'static str, f64),
    Switch(&'static str, bool),
    Circuit(&'static str, f64),
}

/// Inputs of a run from its start to its end, and the interval at which its values are recorded.
struct Scene {
    gear: String,
    one: String,
    start: Vec<Set>,
    later: Vec<(f64, Set)>,
    end: f64,
    sample: f64,
}

/// Time, crank angle, actuator force, torque of the up stop, force of the cylinder ends.
type Row = [f64; 5];

/// The retraction of scene H1.
fn retraction() -> Scene {
    let ramp = [Set::Circuit("command.ramp_amplitude", 0.65), Set::Circuit("command.ramp_time", 0.1)];
    let start = [Set::Switch("downstop.enabled", false)].into_iter().chain(ramp).collect();
    Scene { gear: GEAR.into(), one: HYDRAULIC_GEAR.into(), start, later: Vec::new(), end: 3.8, sample: 0.1 }
}

/// The down lock holds the gear against the pressure.
fn locked() -> Scene {
    let mut scene = retraction();
    scene.start[0] = Set::Switch("downlock.engage", true);
    Scene { end: 1.0, ..scene }
}

/// Apply the changes up to this time.
fn at(later: &[(f64, Set)], done: &mut usize, time: f64, mut set: impl FnMut(Set)) {
    while later.get(*done).is_some_and(|(when, _)| *when <= time + 1e-9) {
        set(later[*done].1);
        *done += 1;
    }
}

/// Set a value of the single system.
fn set_in_one(whole: &mut Mechanism, set: Set) {
    match set {
        Set::Gear(name, value) => whole.set(name, value),
        Set::Switch(name, on) => whole.flag(name, on),
        Set::Circuit(name, value) => {
            let known = whole.0.variables().find(name).is_some();
            whole.set(&if known { name.to_owned() } else { format!("actuator.{name}") }, value);
        }
    }
}

/// Gear and hydraulics as a single system, at the start of a scene.
fn one_at_start(scene: &Scene) -> Mechanism {
    let mut whole = Mechanism(mechanism::Model::from_json(&scene.one).unwrap());
    whole.set("solver.tolerance", TOLERANCE);
    scene.start.iter().for_each(|set| set_in_one(&mut whole, *set));
    whole.0.initialize().unwrap();
    whole
}

/// A run of the single system.
fn one_system(scene: &Scene) -> Vec<Row> {
    let mut whole = one_at_start(scene);
    let (mut rows, mut done) = (Vec::new(), 0);
    for k in 0..(scene.end / scene.sample).round() as u32 {
        at(&scene.later, &mut done, f64::from(k) * scene.sample, |set| set_in_one(&mut whole, set));
        whole.0.step(scene.sample).unwrap();
        let time = f64::from(k + 1) * scene.sample;
        let outputs = ["crank.angle", "actuator.force", "upstop.torque", "cylinder.end_force"];
        let [angle, force, torque, end] = outputs.map(|name| whole.get(name));
        rows.push([time, angle, force, torque, end]);
    }
    rows
}

/// Gear and actuator in a host that makes these steps. If `announces`, the host sets `preview.horizon` to each step
/// size, else to 0.
fn pair(scene: &Scene, host: Host, steps: &dyn Fn(usize) -> f64, announces: bool) -> Vec<Row> {
    let mut gear = Mechanism(mechanism::Model::from_json(&scene.gear).unwrap());
    let mut oil = Actuator(hydraulics::Model::from_json(ACTUATOR).unwrap());
    let apply = |gear: &mut Mechanism, oil: &mut Actuator, set: Set| match set {
        Set::Gear(name, value) => gear.set(name, value),
        Set::Switch(name, on) => gear.flag(name, on),
        Set::Circuit(name, value) => oil.set(name, value),
    };
    let exchange = |gear: &mut Mechanism, oil: &mut Actuator| {
        for name in SHARED.split(' ').map(|name| format!("actuator.{name}")) {
            oil.set(&name, gear.get(&name));
        }
    };
    let mode = match host {
        Host::Held | Host::Line => "preview",
        Host::TwoPasses => "follow",
        Host::Late | Host::LateFed => "delayed",
    };
    oil.0.set_text(oil.reference("coupling.mode"), mode).unwrap();
    gear.set("solver.tolerance", TOLERANCE);
    oil.set("solver.tolerance", TOLERANCE);
    gear.set("actuator.force", 0.0);
    scene.start.iter().for_each(|set| apply(&mut gear, &mut oil, *set));
    gear.0.initialize().unwrap();
    exchange(&mut gear, &mut oil);
    oil.0.initialize().unwrap();
    let name = if matches!(host, Host::Line | Host::TwoPasses) { "preview.force" } else { "preview.force_mean" };
    let (mut rows, mut done, mut time, mut late_force) = (Vec::new(), 0, 0.0, None);
    for k in 0.. {
        if time >= scene.end - 1e-9 {
            break;
        }
        let h = steps(k).min(scene.end - time);
        if announces {
            oil.set("preview.horizon", h);
        }
        if mode == "delayed" {
            if host == Host::LateFed {
                at(&scene.later, &mut done, time, |set| apply(&mut gear, &mut oil, set));
            }
            exchange(&mut gear, &mut oil);
            gear.set("actuator.force", late_force.unwrap_or_else(|| oil.get(name)));
            at(&scene.later, &mut done, time, |set| apply(&mut gear, &mut oil, set));
            gear.0.step(h).unwrap();
        } else {
            at(&scene.later, &mut done, time, |set| apply(&mut gear, &mut oil, set));
            exchange(&mut gear, &mut oil);
            gear.set("actuator.force", oil.get(name));
            if host != Host::Held {
                let rate = oil.get("preview.force_rate");
                gear.rate("actuator.force", 1, rate);
            }
            let accelerations = ["preview.start_acceleration", "preview.acceleration"].map(|name| oil.get(name));
            let [length, speed] = ["actuator.length", "actuator.speed"].map(|name| gear.get(name));
            gear.0.step(h).unwrap();
            if host == Host::TwoPasses {
                let way = gear.get("actuator.length") - length;
                let rates = hermite([speed, gear.get("actuator.speed")], accelerations, way, h);
                let reference = oil.reference("actuator.speed");
                (1..).zip(rates).for_each(|(order, rate)| {
                    oil.0.set_input_derivative(reference, order, rate).unwrap();
                });
            }
        }
        oil.0.step(h).unwrap();
        late_force = Some(oil.get(name));
        time += h;
        if time >= (rows.len() + 1) as f64 * scene.sample - 1e-9 {
            exchange(&mut gear, &mut oil);
            let [angle, torque] = ["crank.angle", "upstop.torque"].map(|name| gear.get(name));
            let [force, end] = ["actuator.force", "cylinder.end_force"].map(|name| oil.get(name));
            rows.push([time, angle, force, torque, end]);
        }
    }
    rows
}

/// Largest differences of angle and force.
fn differences(rows: &[Row], of_one: &[Row]) -> [f64; 2] {
    let same = rows.iter().zip(of_one).filter(|(row, one)| (row[0] - one[0]).abs() < 1e-7);
    let largest = same.fold([0.0_f64; 2], |[angle, force], (row, one)| {
        [angle.max((row[1] - one[1]).abs()), force.max((row[2] - one[2]).abs())]
    });
    assert!(rows.len() == of_one.len() && largest.iter().all(|x| x.is_finite()));
    largest
}

/// In these hosts with these steps the angle differs from that of the single system by less than these limits [rad].
fn assert_near_one(what: &str, scene: &Scene, hosts: &[(Host, &[(f64, f64)])]) {
    let of_one = one_system(scene);
    for (host, h, most) in hosts.iter().flat_map(|(host, rows)| rows.iter().map(move |(h, most)| (*host, *h, *most))) {
        let [angle, _] = differences(&pair(scene, host, &|_| h, true), &of_one);
        println!("{what} {host:?} {h}: {angle:.1e} rad");
        assert!(angle < most, "{what}, {host:?} {h}: {angle:e} rad");
    }
}

const HOSTS: [Host; 4] = [Host::Held, Host::Line, Host::TwoPasses, Host::Late];

/// At rest at the up stop under pressure: force and torque of the stop agree with the single system for every step
/// size.
#[test]
fn a_load_at_rest_on_a_stop_is_that_of_one_system() {
    let scene = Scene { end: 6.0, sample: 6.0, ..retraction() };
    let [[_, _, force, torque, _]] = one_system(&scene)[..] else { panic!("one row") };
    assert!(force > 3e4 && torque.abs() > 7e3, "{force} {torque}");
    for (host, h) in HOSTS.into_iter().flat_map(|host| [1e-3, 5e-3, 1e-2, 5e-2].map(|h| (host, h))) {
        let [[_, _, own_force, own_torque, _]] = pair(&scene, host, &|_| h, true)[..] else { panic!("one row") };
        assert!((own_force / force - 1.0).abs() < 1e-9, "{host:?} {h}: {own_force} N is not {force} N");
        assert!((own_torque / torque - 1.0).abs() < 1e-9, "{host:?} {h}: {own_torque} N.m is not {torque} N.m");
    }
}

/// While a lock holds the gear and the pressure rises, the force agrees with the single system at all times.
#[test]
fn a_load_on_a_lock_is_that_of_one_system() {
    let scene = locked();
    let of_one = one_system(&scene);
    for (host, h) in HOSTS.into_iter().flat_map(|host| [1e-4, 1e-3, 1e-2, 5e-2].map(|h| (host, h))) {
        let [angle, force] = differences(&pair(&scene, host, &|_| h, true), &of_one);
        assert!(angle == 0.0 && force < 1e-9 * 4e4, "{host:?} {h}: {angle:e} rad, {force:e} N");
    }
}

/// The command reverses and moves the gear off the up stop within a step. The error is as small as in a free motion.
#[test]
fn the_error_after_a_release_from_a_stop_is_that_of_a_free_motion() {
    let later = vec![(5.0, Set::Circuit("valve.command", -1.3))];
    let scene = Scene { later, end: 5.6, sample: 0.2, ..retraction() };
    assert_near_one(
        "release",
        &scene,
        &[
            (Host::Held, &[(1e-3, 1e-5), (1e-2, 1e-3)]),
            (Host::Line, &[(1e-3, 1e-7), (1e-2, 3e-5)]),
            (Host::TwoPasses, &[(1e-3, 1e-8), (1e-2, 1e-5)]),
            (Host::Late, &[(1e-3, 1e-5), (1e-2, 1e-3)]),
        ],
    );
}

/// The down lock releases the gear under full pressure. The error is as small as in a free motion.
#[test]
fn the_error_after_a_release_from_a_lock_is_that_of_a_free_motion() {
    let scene = Scene { later: vec![(0.4, Set::Switch("downlock.engage", false))], sample: 0.2, ..locked() };
    assert_near_one(
        "lock lets go",
        &scene,
        &[
            (Host::Held, &[(1e-3, 5e-5), (1e-2, 5e-3)]),
            (Host::Line, &[(1e-3, 1e-7), (1e-2, 1e-5)]),
            (Host::TwoPasses, &[(1e-3, 2e-8), (1e-2, 2e-5)]),
            (Host::Late, &[(1e-3, 5e-5), (1e-2, 5e-3)]),
            (Host::LateFed, &[(1e-3, 5e-5), (1e-2, 5e-3)]),
        ],
    );
}

/// Random steps from 0.25 to 20 ms, with and without an announced horizon.
#[test]
fn steps_may_change_whether_announced_or_not() {
    let scene = retraction();
    let of_one = one_system(&scene);
    let mut state = 12_345_u64;
    let steps: Vec<f64> = (0..20_000)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            0.25e-3 * 80_f64.powf((state >> 11) as f64 / (1_u64 << 53) as f64)
        })
        .collect();
    let last = of_one[of_one.len() - 1];
    for (host, announces, most) in [
        (Host::Held, true, 3e-3),
        (Host::Held, false, 3e-3),
        (Host::Line, true, 5e-5),
        (Host::Line, false, 3e-3),
        (Host::TwoPasses, true, 1e-5),
        (Host::TwoPasses, false, 3e-3),
        (Host::Late, false, 3e-3),
    ] {
        let rows = pair(&scene, host, &|k| steps[k], announces);
        let row = rows[rows.len() - 1];
        let angle = (row[1] - last[1]).abs();
        println!("random steps {host:?} announced {announces}: {angle:.1e} rad");
        assert!((row[0] - last[0]).abs() < 1e-9 && angle < most, "{host:?} {announces}: {angle:e} rad");
    }
}

/// With equal steps, the horizon 0 gives the same results as the step size as the horizon.
#[test]
fn a_horizon_of_0_is_the_last_step() {
    let scene = Scene { end: 0.5, ..retraction() };
    for host in HOSTS {
        let [announced, own] = [true, false].map(|announces| pair(&scene, host, &|_| 1e-3, announces));
        // The computed size of a step differs in the last bit.
        let [angle, force] = differences(&announced, &own);
        assert!(angle < 1e-13 && force < 1e-8, "{host:?}: {angle:e} rad, {force:e} N");
    }
    let of_one = one_system(&scene);
    let [angle, _] = differences(&pair(&scene, Host::Held, &|_| 5e-3, false), &of_one);
    assert!(angle < 3e-4, "{angle:e} rad");
}

/// In a host with delay a jump of the command acts one step late. Afterwards the error decays.
#[test]
fn a_jump_of_the_command_in_a_late_host_is_caught_up() {
    let scene =
        Scene { later: vec![(1.0, Set::Circuit("valve.command", -0.3))], end: 1.5, sample: 0.02, ..retraction() };
    let of_one = one_system(&scene);
    for (h, most_angle, most_force) in [(1e-3, 5e-6, 0.5), (5e-3, 2e-4, 10.0), (1e-2, 1e-3, 300.0)] {
        let [angle, force] = differences(&pair(&scene, Host::Late, &|_| h, true), &of_one);
        println!("jump of the command, late {h}: {angle:.1e} rad, {force:.1e} N");
        assert!(angle < most_angle && force < most_force, "{h}: {angle:e} rad, {force:e} N");
    }
}

/// Some hosts, such as FMPy's `simulate_ssp`, set every connected input to 0 before the first step.
#[test]
fn a_host_that_starts_with_zeros_is_followed() {
    let mut oil = Actuator(hydraulics::Model::from_json(ACTUATOR).unwrap());
    oil.0.initialize().unwrap();
    let start = oil.get("actuator.length");
    SHARED.split(' ').for_each(|name| oil.set(&format!("actuator.{name}"), 0.0));
    oil.set("preview.horizon", 0.0);
    oil.0.step(1e-3).unwrap();
    assert_eq!(oil.get("actuator.length"), start);
}

/// A bumper of 3e5 N.m/rad and 1000 N.m.s/rad in steps of up to 20 ms.
#[test]
fn a_bumper_is_reached_in_long_steps() {
    let bumper = r#""angle": -1.28, "rigid": false, "stiffness": 3e5, "damping": 1000, "flag""#;
    let [gear, one] = [GEAR, HYDRAULIC_GEAR].map(|text| text.replace(r#""angle": -1.3, "flag""#, bumper));
    let scene = Scene { gear, one, end: 5.0, ..retraction() };
    assert_near_one(
        "bumper",
        &scene,
        &[
            (Host::TwoPasses, &[(1e-2, 5e-5), (2e-2, 2e-3)]),
            (Host::Held, &[(2e-2, 3e-3)]),
            (Host::Late, &[(1e-3, 5e-5), (5e-3, 1e-3)]),
        ],
    );
}

/// The limit outputs of the gear's actuator are its lengths at the stops, or the present length while a stop or lock
/// holds.
#[test]
fn limits_are_the_lengths_at_the_stops_or_the_present_one() {
    let mut gear = Mechanism(mechanism::Model::from_json(GEAR).unwrap());
    gear.set("actuator.force", -3e4);
    gear.0.initialize().unwrap();
    let limits =
        |gear: &mut Mechanism| ["lower_limit", "length", "upper_limit"].map(|n| gear.get(&format!("actuator.{n}")));
    let [lower, length, upper] = limits(&mut gear);
    assert!(lower == length && (upper - 0.736_680_967_661_896).abs() < 1e-12, "{lower} {length} {upper}");
    gear.flag("downlock.engage", true);
    assert_eq!(limits(&mut gear), [length; 3]);
    gear.flag("downlock.engage", false);
    gear.set("actuator.force", 3e4);
    gear.0.step(0.05).unwrap();
    let [lower, now, upper_now] = limits(&mut gear);
    assert!(lower == length && now > length && upper_now == upper, "{lower} {now} {upper_now}");
    gear.0.step(0.2).unwrap();
    let [lower, now, upper_now] = limits(&mut gear);
    assert!(lower == length && now == upper && upper_now == upper, "{lower} {now} {upper_now}");
}
