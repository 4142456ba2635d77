//! Forward and inverse use of eqs. (16), (17), (37), (38) agree, for any state and loads of every mechanism.
use super::worst::{ACCURACY, Worst};
use crate::support::{CRANE, FOUR_BAR, GEAR, JIB, Run, SLIDER_CRANK, changed};
use proptest::prelude::*;
use serde_json::json;

/// A mechanism, its drive, whether the drive is rotary, the range of the stated start, the largest start speed, and the
/// inputs.
struct Case {
    json: &'static str,
    drive: &'static str,
    is_rotary: bool,
    start: (&'static str, f64, f64),
    speed: (&'static str, f64),
    /// Names of inputs, each with its largest value.
    inputs: &'static str,
}

/// The ranges exclude the dead centres of the drives, where no finite force has an effect.
const CASES: [Case; 5] = [
    Case {
        json: GEAR,
        drive: "actuator",
        is_rotary: false,
        start: ("crank.start_angle", -1.3, 0.8),
        speed: ("crank.start_speed", 40.0),
        inputs: "actuator.force 4e4, load_factor 6, wheel.force_x 5e3, wheel.force_y 5e3, crank.torque 4e3, \
            follower.torque 4e3",
    },
    Case {
        json: SLIDER_CRANK,
        drive: "drive",
        is_rotary: true,
        start: ("crank.start_angle", -4.0, 4.0),
        speed: ("crank.start_speed", 300.0),
        inputs: "drive.torque 50, load_factor 3, piston.force_x 1e3, piston.force_y 3e3",
    },
    Case {
        json: FOUR_BAR,
        drive: "drive",
        is_rotary: true,
        start: ("crank.start_angle", -4.0, 4.0),
        speed: ("crank.start_speed", 40.0),
        inputs: "drive.torque 20, load_factor 3, C.force_x 300, C.force_y 300, coupler.torque 20",
    },
    Case {
        json: CRANE,
        drive: "cylinder",
        is_rotary: false,
        start: ("jib.start_angle", 1.0, 1.5),
        speed: ("jib.start_speed", 0.4),
        inputs: "cylinder.force 2e5, load_factor 2, hook.force_x 1e4, hook.force_y 3e4, C.force_x 1e4, C.force_y 1e4, \
            beak.torque 5e4",
    },
    Case {
        json: JIB,
        drive: "cylinder",
        is_rotary: false,
        start: ("jib.start_angle", -0.299, 0.706),
        speed: ("jib.start_speed", 0.5),
        inputs: "cylinder.force 6e4, load_factor 2, tip.force_x 4e3, tip.force_y 4e3",
    },
];

fn check(index: usize, part: f64, speed: f64, sizes: &[f64], efficiency: f64) {
    let case = &CASES[index];
    // With the given efficiency. A drive without an efficiency has 1.
    let mut run = Run::shared(&case.json.replace("\"efficiency\": 1", &format!("\"efficiency\": {efficiency}")));
    for (input, size) in case.inputs.split(", ").zip(sizes) {
        let (name, largest) = input.split_once(' ').unwrap();
        run.set(name, largest.parse::<f64>().unwrap() * size);
    }
    let (name, low, high) = case.start;
    let start = (name, low + (high - low) * part);
    run.place(start, (case.speed.0, case.speed.1 * speed));
    let (force, mass) = if case.is_rotary { ("torque", "inertia") } else { ("force", "mass") };
    let name = |suffix: &str| format!("{}.{suffix}", case.drive);
    let present = run.get(&name(force));
    let acceleration = run.get(&name("acceleration"));
    run.set(&name("demanded_acceleration"), acceleration);
    let reduced = run.get(&name(&format!("reduced_{mass}")));
    let (load, additional) = (run.get(&name("static_load")), run.get(&name(&format!("additional_{force}"))));
    let v = run.get(&name("speed"));
    let size = [present, reduced * acceleration, load, additional].into_iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    let mut worst = Worst::default();
    worst.compare("inverse undoes forward", run.get(&name("required_force")), present, size);
    worst.compare("(16), (37)", load + reduced * acceleration - additional, present, size);
    if efficiency == 1.0 {
        worst.compare("T", 0.5 * reduced * v * v, run.get("energy.kinetic"), 0.0);
        // At rest the holding force gives the acceleration 0.
        run.place(start, (case.speed.0, 0.0));
        let holding = run.get(&name(&format!("holding_{force}")));
        run.set(&name(force), holding);
        worst.compare("held", reduced * run.get(&name("acceleration")), 0.0, size.max(holding.abs()));
    }
    worst.assert_within(ACCURACY);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn the_required_drive_for_the_present_acceleration_is_the_present_drive(
        case in 0..CASES.len(),
        part in 0.0..1.0f64,
        speed in -1.0..1.0f64,
        sizes in prop::array::uniform7(-1.0..1.0f64),
    ) {
        check(case, part, speed, &sizes, 1.0);
        check(case, part, speed, &sizes, 0.7);
    }
}

/// dW/ds of every drive against central differences of W along the drive, over the range of the start, under loads of
/// every kind.
#[test]
fn the_derivative_of_the_holding_force_is_its_slope_along_the_drive() {
    for case in &CASES {
        let (force, position) = if case.is_rotary { ("torque", "angle") } else { ("force", "length") };
        let names = [position, &format!("holding_{force}"), &format!("holding_{force}_derivative")]
            .map(|suffix| format!("{}.{suffix}", case.drive));
        let mut run = Run::shared(case.json);
        for (k, input) in case.inputs.split(", ").enumerate() {
            let (name, largest) = input.split_once(' ').unwrap();
            run.set(name, largest.parse::<f64>().unwrap() * (0.3 - 0.17 * k as f64));
        }
        let (start, low, high) = case.start;
        let width = 1e-4 * (high - low);
        for k in 0..=40 {
            let middle = low + 2.0 * width + (high - low - 4.0 * width) * f64::from(k) / 40.0;
            let mut at = |offset: f64| {
                run.place((start, middle + offset * width), (case.speed.0, 0.0));
                [run.get(&names[0]), run.get(&names[1]), run.get(&names[2])]
            };
            let sides = [-2.0, -1.0, 1.0, 2.0].map(&mut at);
            let here = at(0.0);
            let rise = |k: usize| (8.0 * (sides[2][k] - sides[1][k]) - (sides[3][k] - sides[0][k])) / 12.0;
            let slope = rise(1) / rise(0);
            // Rounding of W divided by the width of the difference. Near a dead centre both grow without bound.
            let rounding = 1e-12 * sides.iter().fold(here[1].abs(), |a, w| a.max(w[1].abs())) / rise(0).abs();
            let difference = (slope - here[2]).abs();
            assert!(difference <= 1e-6 * slope.abs() + rounding, "{} at {middle}: {slope} {}", case.drive, here[2]);
        }
    }
}

/// At rest bumpers, springs and still air count, friction does not. Each is compared with the difference of W.
#[test]
fn springs_bumpers_and_wind_count_in_the_derivative_of_the_holding_force() {
    let sprung = changed(GEAR, |gear| {
        gear["springs"] = json!({ "assist": { "joint": "joint1", "stiffness": 900, "free_angle": 0.1 } });
    });
    for (airspeed, friction) in [(0.0, false), (70.0, false), (-50.0, true)] {
        let mut run = Run::shared(&sprung).with(&[("airspeed", airspeed)]).with(&[("friction.enabled", friction)]);
        for angle in [-1.2, -0.7, 0.0, 0.4, 0.75] {
            let mut at = |offset: f64| {
                run.place(("crank.start_angle", angle + offset), ("crank.start_speed", 0.0));
                ["length", "holding_force", "holding_force_derivative"].map(|n| run.get(&format!("actuator.{n}")))
            };
            let h = 2e-4;
            let [a, b, c, d] = [-2.0 * h, -h, h, 2.0 * h].map(&mut at);
            let rise = |k: usize| (8.0 * (c[k] - b[k]) - (d[k] - a[k])) / 12.0;
            let (slope, here) = (rise(1) / rise(0), at(0.0)[2]);
            assert!((slope - here).abs() < 2e-7 * slope.abs() + 1e-3, "{airspeed} {angle}: {slope} {here}");
        }
    }
}
