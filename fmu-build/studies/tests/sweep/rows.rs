//! Contents of a row: bits of `cargo fmu simulate`, times of events, failures.

use crate::support::{Folder, simulated, simulated_of};
use fmu_build::output;
use fmu_build::workspace::Workspace;
use fmu_studies::simulate::Outcome;
use fmu_studies::sweep::{self, Arguments};
use serde_json::json;

/// Inputs and parameters that vary irregularly between runs, so that each run follows a different one.
#[test]
fn rows_are_bit_identical_to_those_of_simulate() {
    let folder = Folder::new("bits");
    let names = ["actuator.force", "load_factor", "crank.mass", "crank.start_angle", "friction.enabled"];
    let points = [
        (30e3, 3.0, 13.689, 0.8, false),
        (29e3, 1.0, 13.689, 0.8, true),
        (29e3, 1.0, 20.0, 0.7, false),
        (31e3, 2.0, 20.0, 0.7, true),
        (30e3, 3.0, 13.689, 0.8, false),
    ];
    let lines =
        points.map(|(force, load, mass, angle, friction)| format!("{force},{load},{mass},{angle},{friction}\n"));
    folder.write("points.csv", names.join(",") + "\n" + &lines.concat());
    folder.write("air.csv", "time,airspeed\n0,0\n0.05,80\n0.14,60\n");
    let rows = folder.rows(json!({
        "points": "points.csv",
        "start_values": { "uplock.engage": true },
        "scenario": { "stop_time": 0.14, "output_interval": 0.01, "input_file": "air.csv" },
        "responses": {
            "angle": { "final": "crank.angle" }, "drift": { "final": "energy.drift" }, "up": { "final": "retracted" },
            "peak": { "maximum": "joint1.force" }, "least": { "minimum": "joint2.force_x" },
            "work": { "integral": "actuator.required_force" }, "rms": { "root_mean_square": "joint3.force" },
            "course": { "course": "wheel.y", "times": [0, 0.05, 0.14] }, "met": { "event": "retracted" },
        },
    }));
    assert_eq!(rows.rows.len(), points.len());
    for (row, (force, load, mass, angle, friction)) in points.iter().enumerate() {
        let values = [
            format!("actuator.force={force}"),
            format!("load_factor={load}"),
            format!("crank.mass={mass}"),
            format!("crank.start_angle={angle}"),
            format!("friction.enabled={friction}"),
            "uplock.engage=true".to_owned(),
        ];
        let run = simulated(&folder, &values, 0.14, 0.01, Some(folder.0.join("air.csv")));
        let (last, times) = (run.rows.len() - 1, run.column("time"));
        let same = |name: &str, expected: f64| {
            let own = rows.number(row, name);
            assert!(own.to_bits() == expected.to_bits(), "run {row}, {name}: {own:?}, simulated {expected:?}");
        };
        assert_eq!(rows.number(row, "actuator.force"), *force);
        assert_eq!((rows.text(row, "failed"), rows.text(row, "message")), ("0", ""));
        same("angle", run.number(last, "crank.angle"));
        same("drift", run.number(last, "energy.drift"));
        same("up", run.number(last, "retracted"));
        let force = run.column("joint1.force");
        let peak = (0..=last).rev().max_by(|a, b| force[*a].total_cmp(&force[*b])).unwrap();
        same("peak", force[peak]);
        same("peak.time", times[peak]);
        same("least", run.column("joint2.force_x").into_iter().fold(f64::INFINITY, f64::min));
        let trapezoids =
            |y: &[f64]| (0..last).fold(0.0, |sum, k| sum + 0.5 * (y[k] + y[k + 1]) * (times[k + 1] - times[k]));
        same("work", trapezoids(&run.column("actuator.required_force")));
        let squares: Vec<f64> = run.column("joint3.force").iter().map(|force| force * force).collect();
        same("rms", (trapezoids(&squares) / times[last]).sqrt());
        for (name, k) in [("course@0", 0), ("course@0.05", 5), ("course@0.14", last)] {
            same(name, run.number(k, "wheel.y"));
        }
        let met = run.number(last, "upstop.impact_time");
        same("met", if met < 0.0 { f64::NAN } else { met });
    }
    assert!(rows.column("met").iter().any(|time| !time.is_nan()));
}

/// Times of events alone need no steps, and outputs at the stop need none. A response at an instant in between needs
/// steps. Both ways have the same times and outputs, and the same texts for runs that do not reach the stop, also for
/// a grid and for inputs that are no load.
#[test]
fn times_by_energy_are_those_of_the_steps() {
    let folder = Folder::new("energy");
    let force = json!({ "uniform": [20000, 40000] });
    let factors = [
        json!({
            "actuator.force": force, "load_factor": { "uniform": [0.5, 3] },
            "wheel.force_x": { "values": [0, 500] }
        }),
        json!({ "actuator.force": force, "airspeed": { "values": [0, 50] } }),
        json!({
            "actuator.force": force, "load_factor": { "uniform": [0.5, 3] },
            "crank.mass": { "values": [12, 14] }
        }),
    ];
    for factors in factors {
        let last = json!({ "blow": { "final": "upstop.impact_impulse" }, "angle": { "final": "crank.angle" } });
        let mut course = last.clone();
        course["course"] = json!({ "course": "crank.angle", "times": [0.01] });
        let [alone, state, both] = [json!({}), last, course].map(|mut responses| {
            responses["met"] = json!({ "event": "retracted" });
            responses["down"] = json!({ "event": "extended" });
            folder.rows(json!({
                "factors": factors, "responses": responses, "start_values": { "solver.tolerance": 1e-12 },
                "sampling": { "method": "random", "count": 200, "seed": 1 },
                "scenario": { "stop_time": 0.155, "stop_at": "retracted" },
            }))
        });
        assert_eq!(alone.rows.len(), 400);
        let mut missed = 0;
        for row in 0..alone.rows.len() {
            let (met, by_steps) = (alone.number(row, "met"), both.number(row, "met"));
            assert_eq!((met.is_nan(), alone.text(row, "message")), (by_steps.is_nan(), both.text(row, "message")));
            assert!(met.is_nan() || (met - by_steps).abs() < 5e-12, "{row}: {met} {by_steps}");
            assert!([&alone, &state, &both].iter().all(|rows| rows.number(row, "down").is_nan()), "{row}");
            assert_eq!(state.text(row, "message"), both.text(row, "message"));
            for (name, allowed) in [("met", 5e-12), ("blow", 1e-7), ("angle", 1e-9)] {
                let [state, both] = [&state, &both].map(|rows| rows.number(row, name));
                let is_near = (state - both).abs() < allowed;
                assert!(is_near || state.is_nan() && both.is_nan(), "{row}, {name}: {state} {both}");
            }
            missed += usize::from(met.is_nan());
        }
        assert!(missed > 0 && missed < 300, "{missed}");
    }
}

#[test]
fn a_run_ends_at_its_event() {
    let folder = Folder::new("event");
    let rows = folder.rows(json!({
        "factors": { "upstop.restitution": { "values": [0, 0.5, 0.9] }, "actuator.force": { "values": [-20000, 30000,
            34000] } },
        "scenario": { "stop_time": 0.5, "stop_at": "retracted" },
        "responses": {
            "met": { "event": "retracted" }, "down": { "event": "extended" }, "count": {
                "final": "upstop.impact_count" },
            "angle": { "final": "crank.angle" }, "up": { "final": "retracted" }, "blow": {
                "final": "upstop.impact_impulse" },
        },
    }));
    for row in 0..9 {
        let force = rows.number(row, "actuator.force");
        if force < 25e3 {
            // The actuator force is too small.
            assert_eq!(
                rows.text(row, "message"),
                "the output retracted (scenario.stop_at) did not become true within 0.5 s"
            );
            assert!(rows.number(row, "met").is_nan() && rows.number(row, "up") == 0.0);
            continue;
        }
        // The first impact, found by steps with at most one impact.
        let values = [
            format!("actuator.force={force}"),
            format!("upstop.restitution={}", rows.number(row, "upstop.restitution")),
        ];
        let run = simulated(&folder, &values, 0.5, 1e-4, None);
        let first = run.column("upstop.impact_count").iter().position(|count| *count > 0.0).unwrap();
        let expected = run.number(first, "upstop.impact_time");
        let met = rows.number(row, "met");
        assert!((met - expected).abs() < 1e-9, "{row}: {met} {expected}");
        assert_eq!(rows.number(row, "count"), 1.0);
        // A stop with restitution is left at once. Within the rounding of the impact time either value is right.
        assert!(rows.number(row, "upstop.restitution") > 0.0 || rows.number(row, "up") == 1.0);
        assert!((rows.number(row, "angle") + 1.3).abs() < 1e-12 && rows.number(row, "blow") > 0.0);
        assert!(rows.number(row, "down").is_nan());
        assert_eq!((rows.text(row, "failed"), rows.text(row, "message")), ("0", ""));
    }
}

/// With ramps the slopes are set: the result does not depend on the communication instants.
#[test]
fn a_ramp_is_followed_within_a_step() {
    let folder = Folder::new("ramp");
    let study = |interval: Option<f64>| {
        let mut scenario = json!({
            "stop_time": 0.5, "stop_at": "retracted", "inputs": { "actuator.force": [[0, 0], [0.05, 30000]],
                "load_factor": 1 }
        });
        if let Some(interval) = interval {
            scenario["output_interval"] = json!(interval);
        }
        json!({ "scenario": scenario, "responses": { "met": { "event": "retracted" } } })
    };
    let [few, many] = [None, Some(1e-3)].map(|interval| folder.rows(study(interval)).number(0, "met"));
    assert!((few - many).abs() < 1e-8 && few > 0.05, "{few} {many}");
}

#[test]
fn a_failed_run_is_a_row() {
    let folder = Folder::new("failures");
    let rows = folder.rows(json!({
        "factors": {
            "crank.length": { "values": [0.1755, -1, 0.9, 0.1755] }, "solver.max_steps": { "values": [100_000, 3] },
            "solver.method": { "values": ["reduced", "rigid"] },
        },
        "scenario": { "stop_time": 0.1 },
        "responses": { "angle": { "final": "crank.angle" }, "met": { "event": "retracted" } },
    }));
    let expected = ["", "solver.method = \"rigid\"", "step at 0 s: ", "solver.method = \"rigid\""];
    let unreachable = ["initialisation at 0 s", expected[1], "initialisation at 0 s", expected[1]];
    let expected = expected.into_iter().chain(["crank.length"; 4]).chain(unreachable).chain(expected);
    for (row, said) in expected.enumerate() {
        let (message, failed) = (rows.text(row, "message"), rows.text(row, "failed"));
        println!("{message}");
        let is_whole = failed == "0" && message.is_empty() && rows.number(row, "angle") < 0.8;
        let is_failed = failed == "1" && message.contains(said) && rows.number(row, "angle").is_nan();
        assert!(if said.is_empty() { is_whole } else { is_failed }, "{row}: {failed} {message}");
    }
    // A run after failed runs equals a single run.
    assert_eq!(rows.text(0, "angle"), rows.text(12, "angle"));
    // A study without any result has failed, also when it is resumed.
    let study = folder.study(
        "none.json",
        json!({
            "factors": { "crank.length": { "values": [-1, -2] } }, "responses": { "angle": { "final": "crank.angle" } },
        }),
    );
    for resume in [false, true] {
        let (study, out) = (study.clone(), Some(folder.0.join("none")));
        let arguments = Arguments { study, out, resume, ..Default::default() };
        let (outcome, printed) = output::collected(|| sweep::run(&Workspace::locate(), &arguments, None));
        assert_eq!(outcome.unwrap(), Outcome::Failed);
        let is_reported = printed.contains("the first failed run: ") && printed.contains("crank.length = -1");
        assert!(resume || is_reported, "{printed}");
    }
}

/// A gear with its circuit, with parameters of both and the valve over time. Each row is that of a separate run.
#[test]
fn a_hydraulic_mechanism_is_swept() {
    let folder = Folder::new("hydraulic");
    let gear = Workspace::locate().descriptions().join("LandingGearRetractionHydraulic");
    // With the ramp of the definition the valve opens fully.
    folder.write("valve.csv", "time,valve.command\n0,0\n0.02,0.35\n0.3,0.35\n");
    let rows = folder.rows(json!({
        "mechanism": gear,
        "factors": {
            "supply.pressure": { "values": [1.5e7, 2e7] }, "crank.mass": { "values": [13.689, 20] },
            "tank.pressure": { "values": [2e5, -2e5] },
        },
        "scenario": { "stop_time": 0.1, "output_interval": 0.01, "input_file": "valve.csv" },
        "responses": {
            "angle": { "final": "crank.angle" }, "force": { "maximum": "actuator.force" },
            "work": { "integral": "power.supply" },
        },
    }));
    assert_eq!(rows.rows.len(), 8);
    for row in 0..8 {
        let [supply, mass, tank] =
            ["supply.pressure", "crank.mass", "tank.pressure"].map(|name| rows.number(row, name));
        if tank < 0.0 {
            assert_eq!(rows.text(row, "failed"), "1");
            assert!(rows.text(row, "message").contains("tank.pressure"), "{}", rows.text(row, "message"));
            continue;
        }
        assert_eq!((rows.text(row, "failed"), rows.text(row, "message")), ("0", ""));
        let values =
            [format!("supply.pressure={supply}"), format!("crank.mass={mass}"), format!("tank.pressure={tank}")];
        let run = simulated_of(&folder, &gear, &values, (0.1, 0.01), Some(folder.0.join("valve.csv")));
        let same = |name: &str, expected: f64| {
            let own = rows.number(row, name);
            assert!(own.to_bits() == expected.to_bits(), "run {row}, {name}: {own}, simulated {expected}");
        };
        same("angle", *run.column("crank.angle").last().unwrap());
        same("force", run.column("actuator.force").into_iter().fold(f64::NEG_INFINITY, f64::max));
    }
    let angle = |row: usize| rows.number(row, "angle");
    assert!(angle(0) != angle(2) && angle(0) != angle(4) && angle(0) < 0.8, "{:?}", rows.column("angle"));
}

/// Values of a parameter set apply to all runs, unless a factor, a start value or the scenario states another value.
#[test]
fn a_parameter_set_of_a_study_yields_to_its_other_keys() {
    let folder = Folder::new("parameters");
    let parameter = |(name, value): (&str, &str)| format!("<Parameter name=\"{name}\"><{value}/></Parameter>");
    let parameters = [
        ("crank.mass", "Real value=\"15000\" unit=\"g\""),
        ("load_factor", "Integer value=\"2\""),
        ("actuator.force", "Real value=\"1\""),
        ("airspeed", "Real value=\"2\""),
        ("leg.length", "Real value=\"80\" unit=\"cm\""),
        ("friction.enabled", "Boolean value=\"true\""),
    ];
    let text = parameters.map(parameter).concat();
    let text = format!("<ParameterSet version=\"1.0\" name=\"a\"><Parameters>{text}</Parameters></ParameterSet>");
    folder.write("set of values.ssv", text);
    let rows = folder.rows(json!({
        "parameters_file": "set of values.ssv",
        "factors": { "actuator.force": { "values": [29e3, 31e3] } },
        "start_values": { "crank.mass": "14 kg" },
        "scenario": { "stop_time": 0.1, "output_interval": 0.01, "inputs": { "airspeed": [[0, 70], [0.1, 80]] } },
        "responses": { "angle": { "final": "crank.angle" } },
    }));
    folder.write("air.csv", "time,airspeed\n0,70\n0.1,80\n");
    for (row, force) in ["29e3", "31e3"].iter().enumerate() {
        let values = ["crank.mass=14", "load_factor=2", "leg.length=0.8", "friction.enabled=true"].map(String::from);
        let values = [&values[..], &[format!("actuator.force={force}")]].concat();
        let run = simulated(&folder, &values, 0.1, 0.01, Some(folder.0.join("air.csv")));
        let expected = run.number(run.rows.len() - 1, "crank.angle");
        assert_eq!(rows.number(row, "angle").to_bits(), expected.to_bits(), "{force}");
    }
}
