//! The landing gear with a hydraulic circuit on its actuator, as one system. Reference values are those of an independent
//! Taylor-series integration of gear and circuit together, whose runs in double and in 80 bit agree to 2e-13.

use crate::support::{HYDRAULIC_GEAR, Run, assert_says, changed, read_all};
use serde_json::json;

/// Time [s]; angle [rad] and speed [rad/s] of the crank; pressures of the chambers [Pa]; force [N]; length [m] and speed
/// [m/s] of the actuator.
type Row = [f64; 8];

/// Retraction from rest at 0.8 rad, with air in the oil, cushions and friction of the seals.
const RETRACTION: [Row; 10] = [
    [
        0.05,
        0.793138133418578,
        -0.30656593282579,
        6478303.0431435,
        10242897.040518,
        -1232.161703436,
        0.419368208289008,
        0.03931911701544,
    ],
    [
        0.1,
        0.769550975553854,
        -0.62936026011088,
        5314686.2927837,
        8882913.3390496,
        -1605.896803131,
        0.422427798448481,
        0.08253354851197,
    ],
    [
        0.2,
        0.703967315179619,
        -0.63957809999443,
        4528002.6282655,
        8108837.6838444,
        -2008.847879986,
        0.431266906578840,
        0.08838437107865,
    ],
    [
        0.5,
        0.523620580328936,
        -0.57112729970867,
        4992624.9595796,
        7792790.9883118,
        -921.6257163131,
        0.457543749407357,
        0.08686280564332,
    ],
    [
        1.0,
        0.253250298772210,
        -0.51714629239523,
        5650165.2371706,
        7478162.7666305,
        471.0857748807,
        0.500463040756372,
        0.08488866941389,
    ],
    [
        2.0,
        -0.242429680769236,
        -0.48958400813701,
        6710031.2547232,
        6976165.2514557,
        2710.350675763,
        0.583686458596709,
        0.08159718420969,
    ],
    [
        3.0,
        -0.759970553164200,
        -0.56384947054374,
        7925280.8916266,
        6394619.7477901,
        5284.562808813,
        0.663409516325448,
        0.07760027956620,
    ],
    [
        3.5,
        -1.05718309261089,
        -0.61663470775208,
        8499458.3878426,
        6153891.6257826,
        6463.272957934,
        0.701696028722270,
        0.07594839563223,
    ],
    [
        3.8,
        -1.22821155571711,
        -0.42282793782688,
        10448976.118609,
        10069665.023005,
        5265.166473185,
        0.723809771775691,
        0.06205425498973,
    ],
    [
        4.0,
        -1.28835660508442,
        -0.2011150324088,
        16102738.794319,
        19701448.784114,
        3674.566628157,
        0.734039211753613,
        0.04227773657469,
    ],
];
/// State at the time at which the gear is up.
const RETRACTED: Row = [
    4.065842490726519,
    -1.3,
    -0.15426735502447,
    17169593.192164,
    21756413.637998,
    3111.606916986,
    0.736680967661896,
    0.03812432397111,
];
/// Energies at that time [J].
const RETRACTED_ENERGIES: [(&str, f64); 6] = [
    ("energy.supplied", 10553.184673943),
    ("energy.returned", 121.85059253553),
    ("energy.piston", 792.0166110596),
    ("energy.seal_friction", 92.320992189462),
    ("energy.compression", 51.226522536153),
    ("energy.throttling", 9495.7699556221),
];
/// Vibration about 0 rad under a sinusoidal command, without air, cushions and friction.
const VIBRATION: [Row; 6] = [
    [
        0.05,
        -0.00484058453060504,
        -0.18964739813228,
        7694446.0343801,
        9181394.9806646,
        2142.016604783,
        0.543627270657388,
        0.03209148619912,
    ],
    [
        0.1,
        -0.0194469102739466,
        -0.36680255596499,
        6834536.0027661,
        8010099.4782638,
        2062.295462696,
        0.546099430456955,
        0.06209389623443,
    ],
    [
        0.25,
        -0.0609683061521160,
        -0.02591728495605,
        5965047.2227448,
        7359758.2546644,
        1394.520832211,
        0.553129984017170,
        0.004388445703471,
    ],
    [
        0.5,
        -0.0162693739682587,
        0.01301409192789,
        12574129.767437,
        16200006.250218,
        2185.452093646,
        0.545561542968947,
        -0.002202919358068,
    ],
    [
        0.75,
        -0.0777416580266453,
        -0.02263019283161,
        6117506.9857873,
        7520596.8855059,
        1460.146297057,
        0.555969774812941,
        0.003830747751046,
    ],
    [
        1.0,
        -0.0328997584464874,
        0.01323211495211,
        12609944.246502,
        16192507.707920,
        2250.657639348,
        0.548377068274000,
        -0.002240492606440,
    ],
];
/// Energies at 1 s [J].
const VIBRATION_ENERGIES: [(&str, f64); 5] = [
    ("energy.supplied", 1073.1215403971),
    ("energy.returned", 16.250674971876),
    ("energy.piston", 9.522155866394),
    ("energy.compression", 24.869964377357),
    ("energy.throttling", 1022.4787451814),
];
const NAMES: [&str; 7] = [
    "crank.angle",
    "crank.speed",
    "chamber_a.pressure",
    "chamber_b.pressure",
    "actuator.force",
    "actuator.length",
    "actuator.speed",
];
/// Largest value of each of these in both scenes, to which 11 digits apply where a value passes through 0.
const SIZES: [f64; 7] = [1.0, 0.5, 1e7, 1e7, 5e3, 0.5, 0.08];

/// The retraction, at a tolerance.
fn retraction(tolerance: f64) -> Run {
    let mut gear = Run::shared(HYDRAULIC_GEAR);
    gear.set("downstop.enabled", false);
    let command = [("command.ramp_amplitude", 0.65), ("command.ramp_time", 0.1)];
    gear.with(&[("solver.tolerance", tolerance)]).with(&command).started()
}

/// The vibration, at a tolerance.
fn vibration(tolerance: f64) -> Run {
    let mut gear = Run::shared(HYDRAULIC_GEAR);
    gear.set_all(&[("downstop.enabled", false), ("upstop.enabled", false)]);
    gear.set_all(&[
        ("fluid.air_fraction", 0.0),
        ("seal.coulomb", 0.0),
        ("seal.static", 0.0),
        ("seal.viscous", 0.0),
        ("cushion_a.length", 0.0),
        ("cushion_b.length", 0.0),
        ("crank.start_angle", 0.0),
        ("chamber_a.start_pressure", 8e6),
        ("chamber_b.start_pressure", 10.08e6),
        ("command.ramp_amplitude", 0.0),
        ("command.sine_amplitude", 0.5),
        ("command.sine_frequency", 2.0),
        ("solver.tolerance", tolerance),
    ]);
    gear.started()
}

#[track_caller]
fn meets(gear: &mut Run, row: &Row, digits: f64) {
    for ((name, expected), size) in NAMES.iter().zip(&row[1..]).zip(SIZES) {
        let value = gear.get(name);
        let error = (value - expected).abs() / size.max(expected.abs());
        assert!(error <= digits, "{} s {name} = {value}: {expected}, off by {error:e}", row[0]);
    }
}

/// Step to these times, in communication steps of `h`.
fn follow(gear: &mut Run, rows: &[Row], h: f64, digits: f64) {
    let mut steps = 0;
    for row in rows {
        let end = (row[0] / h).round() as u64;
        while steps < end {
            gear.step((steps + 1) as f64 * h - steps as f64 * h);
            steps += 1;
        }
        meets(gear, row, digits);
    }
}

#[test]
fn the_retraction_follows_the_reference() {
    let mut gear = retraction(1e-12);
    follow(&mut gear, &RETRACTION, 0.05, 1e-11);
    assert!((gear.get("valve.position") - 0.65).abs() < 1e-11);
    let mut gear = retraction(1e-12);
    follow(&mut gear, &RETRACTION[..1], 0.05, 1e-11);
    assert!((gear.get("valve.position") - 0.29741314344).abs() < 1e-10);
}

#[test]
fn the_gear_is_up_at_the_reference_time_with_the_reference_energies() {
    let mut gear = retraction(1e-12);
    gear.set("upstop.enabled", false);
    gear.initialize();
    gear.step(RETRACTED[0]);
    let time = (gear.get("crank.angle") + 1.3) / -gear.get("crank.speed");
    assert!(time.abs() < 1e-10, "{time:e}");
    for (name, expected) in RETRACTED_ENERGIES {
        let error = gear.get(name) / expected - 1.0;
        assert!(error.abs() < 1e-10, "{name}: off by {error:e}");
    }
}

#[test]
fn the_vibration_follows_the_reference() {
    let mut gear = vibration(1e-12);
    follow(&mut gear, &VIBRATION, 0.05, 1e-11);
    for (name, expected) in VIBRATION_ENERGIES {
        let error = gear.get(name) / expected - 1.0;
        assert!(error.abs() < 1e-10, "{name}: off by {error:e}");
    }
}

/// Energy of the mechanism now less that at the start less the work of the piston and of the stops' losses is the drift;
/// the circuit's energies balance.
#[track_caller]
fn balances(gear: &mut Run, allowed: f64) {
    let supplied = gear.get("energy.supplied").abs().max(gear.get("energy.throttling").abs());
    let (balance, drift) = (gear.get("energy.balance"), gear.get("energy.drift"));
    assert!(balance.abs() <= allowed * supplied, "balance {balance:e} J of {supplied:e} J");
    let worked = gear.get("energy.piston").abs().max(100.0);
    assert!(drift.abs() <= 10.0 * allowed * worked, "drift {drift:e} J of {worked:e} J");
}

#[test]
fn energies_balance_at_a_common_tolerance_whatever_the_steps() {
    for (h, steps) in [(1e-3, 4000), (0.02, 200), (1.0, 4)] {
        let mut gear = retraction(1e-9);
        for _ in 0..steps {
            gear.step(h);
        }
        balances(&mut gear, 1e-8);
        let error = gear.get("crank.angle") - RETRACTION[9][1];
        assert!(error.abs() < 1e-8, "{h} s: {error:e}");
    }
}

#[test]
fn what_the_piston_does_is_what_the_gear_gains() {
    let mut gear = retraction(1e-12);
    let before = gear.get("energy.kinetic") + gear.get("energy.potential");
    gear.steps(40, 4.0);
    let gained = gear.get("energy.kinetic") + gear.get("energy.potential") - before;
    let error = gained / gear.get("energy.piston") - 1.0;
    assert!(error.abs() < 1e-12, "{error:e}");
}

/// At the stop the mechanism rests while the pressures go on; the opposite command takes it away from there.
#[test]
fn the_circuit_goes_on_while_a_stop_holds_the_gear() {
    for restitution in [0.0, 0.4] {
        let mut gear = retraction(1e-10);
        gear.set("upstop.restitution", restitution);
        gear.initialize();
        gear.steps(41, 4.1);
        let impact = gear.get("chamber_a.pressure");
        gear.steps(900, 0.9);
        assert!(gear.is("retracted"));
        assert_eq!(gear.get("crank.speed"), 0.0);
        // Chamber A fills to the supply, chamber B empties to the tank; leakages apart.
        assert!(gear.get("chamber_a.pressure") > impact.max(20.0e6) && gear.get("chamber_a.pressure") < 20.7e6);
        assert!(gear.get("chamber_b.pressure") < 1e6 && gear.get("chamber_b.pressure") > 0.35e6);
        let force = gear.get("actuator.force");
        let [area_a, area_b] =
            [0.045_f64.powi(2), 0.045_f64.powi(2) - 0.025_f64.powi(2)].map(|d| d * 0.25 * std::f64::consts::PI);
        let expected = gear.get("chamber_a.pressure") * area_a - gear.get("chamber_b.pressure") * area_b;
        assert!((force / expected - 1.0).abs() < 1e-12, "{force} {expected}");
        assert!(gear.get("upstop.torque").abs() > 100.0);
        balances(&mut gear, 1e-7);
        // The supply does no work while nothing moves, but for leakage.
        assert!(gear.get("power.supply") < 100.0);
        gear.set("valve.command", -1.3);
        gear.steps(1000, 1.0);
        assert!(!gear.is("retracted"));
        assert!(gear.get("crank.angle") > -1.29 && gear.get("crank.speed") > 0.01, "{}", gear.get("crank.angle"));
        balances(&mut gear, 1e-7);
    }
}

/// The time at which a gear that rests sets off is that of the balance of forces, whatever the communication steps.
#[test]
fn the_gear_sets_off_when_the_pressures_say_so() {
    let angle = |steps: u32| {
        let mut gear = retraction(1e-11);
        gear.steps(5, 5.0);
        gear.set("valve.command", -1.3);
        gear.steps(steps, 0.4);
        (gear.get("crank.angle"), gear.get("crank.speed"), gear.get("chamber_b.pressure"))
    };
    let (one, many) = (angle(1), angle(400));
    assert!(one.0 > -1.299 && one.1 > 0.0, "{one:?}");
    assert!((one.0 - many.0).abs() < 1e-10 && (one.2 - many.2).abs() < 1e-3, "{one:?} {many:?}");
    let mut held = retraction(1e-11);
    held.steps(5, 5.0);
    held.set("uplock.engage", true);
    held.set("valve.command", -1.3);
    held.steps(4, 0.4);
    assert_eq!(held.get("crank.angle"), -1.3);
    assert!(held.get("chamber_b.pressure") > 20e6 && held.get("chamber_a.pressure") < 1e6);
    assert!(held.get("uplock.force").abs() > 1000.0);
    balances(&mut held, 1e-7);
}

#[test]
fn energies_balance_with_friction_bumpers_and_air() {
    let mut gear = retraction(1e-10);
    gear.set("friction.enabled", true);
    gear.set("airspeed", 70.0);
    gear.initialize();
    gear.steps(430, 4.3);
    assert!(gear.get("joint1.friction_torque").is_finite());
    balances(&mut gear, 1e-8);
    let bumper = changed(HYDRAULIC_GEAR, |gear| {
        gear["stops"]["upstop"] = json!({
            "body": "crank", "limit": "lower", "angle": -1.2, "rigid": false, "stiffness": 1e5, "damping": 1e3, "flag": "retracted"
        });
        gear["stops"]["downstop"]["enabled"] = json!(false);
        let command = &mut gear["actuators"]["actuator"]["hydraulics"]["command"];
        *command = json!({ "ramp_amplitude": 0.65, "ramp_time": 0.1 });
        gear["solver"]["tolerance"] = json!(1e-10);
    });
    let mut gear = Run::new(&bumper).started();
    gear.steps(430, 4.3);
    assert!(gear.get("upstop.torque") > 100.0, "{}", gear.get("upstop.torque"));
    balances(&mut gear, 1e-8);
}

#[test]
fn a_ramp_may_be_an_input_derivative_and_is_clipped_at_one() {
    let mut gear = retraction(1e-12);
    let mut by_input = retraction(1e-12);
    by_input.set("command.ramp_amplitude", 0.0);
    by_input.initialize();
    for k in 0..4 {
        if k < 2 {
            by_input.set_derivative("valve.command", 1, 6.5);
        }
        gear.step(0.05);
        by_input.step(0.05);
        assert!((gear.get("crank.angle") - by_input.get("crank.angle")).abs() < 1e-12);
    }
    assert_eq!(by_input.get("valve.command"), 0.65);
    // A ramp to 3 in 0.3 s is at 1 from 0.1 s on, wherever the communication points are.
    let clipped = |steps: u32, ramp: [f64; 2]| {
        let mut gear = retraction(1e-12);
        gear.set_all(&[("command.ramp_amplitude", ramp[0]), ("command.ramp_time", ramp[1])]);
        gear.initialize();
        gear.steps(steps, 0.5);
        (gear.get("crank.angle"), gear.get("valve.position"))
    };
    let expected = clipped(1, [1.0, 0.1]);
    for steps in [1, 7, 500] {
        let found = clipped(steps, [3.0, 0.3]);
        assert!((found.0 - expected.0).abs() < 1e-11 && (found.1 - 1.0).abs() < 1e-9, "{found:?} {expected:?}");
    }
}

#[test]
fn derivatives_are_those_of_the_values() {
    let mut gear = retraction(1e-13);
    gear.set("friction.enabled", true);
    gear.initialize();
    gear.set("valve.command", 0.05);
    gear.steps(16, 0.0793);
    let names = [
        "actuator.force",
        "actuator.stiffness",
        "actuator.damping",
        "chamber_a.pressure",
        "chamber_b.flow",
        "chamber_a.volume",
        "chamber_b.bulk_modulus",
        "valve.position",
        "valve.speed",
        "supply.flow",
        "tank.flow",
        "cylinder.stroke_position",
        "power.supply",
        "power.return",
        "power.piston",
        "power.seal_friction",
        "power.compression",
        "power.throttling",
        "energy.supplied",
        "energy.throttling",
        "crank.acceleration",
        "actuator.acceleration",
        "joint1.force_x",
        "joint2.force",
        "actuator.holding_force",
        "actuator.static_load",
    ];
    let h = 1e-5;
    let after = |factor: i32| {
        let mut later = gear.clone();
        (0..factor).for_each(|_| later.step(h));
        names.map(|name| later.get(name))
    };
    let values: Vec<[f64; 26]> = (0..5).map(after).collect();
    for (k, name) in names.iter().enumerate() {
        let v = |i: usize| values[i][k];
        let difference = (-25.0 * v(0) + 48.0 * v(1) - 36.0 * v(2) + 16.0 * v(3) - 3.0 * v(4)) / (12.0 * h);
        let exact = gear.derivative(name);
        let error = (exact - difference).abs() / (difference.abs() + 1e-6 * v(0).abs() / h + 1e-12);
        assert!(error < 1e-4, "{name}: {exact} {difference}");
    }
    // Of the ports.
    let reference = |name: &str| gear.0.reference(name).unwrap();
    let (unknowns, known) =
        (["supply.flow", "tank.flow", "power.supply", "chamber_a.flow", "actuator.force"], "supply.pressure");
    let (references, known_reference) = (unknowns.map(reference), reference(known));
    let mut exact = [0.0; 5];
    gear.directional_derivative(&references, &[known_reference], &[1.0], &mut |k, d| exact[k] = d).unwrap();
    let at = |dp: f64| {
        let mut beside = gear.clone();
        let p = beside.get(known);
        beside.set(known, p + dp);
        unknowns.map(|name| beside.get(name))
    };
    let (low, high) = (at(-1e3), at(1e3));
    for k in 0..5 {
        let difference = (high[k] - low[k]) / 2e3;
        assert!((exact[k] - difference).abs() <= 1e-7 * difference.abs(), "{}: {} {difference}", unknowns[k], exact[k]);
    }
    assert!(exact[0] > 0.0 && exact[4] == 0.0);
    assert!(read_all(&mut gear).is_empty());
}

/// A twin that is saved, written, read and restored at any time has the bits of one that is not.
#[test]
fn a_restored_twin_has_the_same_bits() {
    let mut gear = retraction(1e-9);
    let mut twin = gear.clone();
    for step in 0..600 {
        if step % 7 == 3 {
            let snapshot = twin.snapshot();
            twin.step(0.013);
            twin.restore(&snapshot).unwrap();
        }
        if step % 11 == 5 {
            let mut bytes = Vec::new();
            twin.snapshot().write(&mut bytes).unwrap();
            let mut fresh = Run::shared(HYDRAULIC_GEAR).started();
            let snapshot = fresh.read_snapshot(&bytes).unwrap();
            fresh.restore(&snapshot).unwrap();
            twin = fresh;
        }
        if step == 500 {
            gear.set("valve.command", -1.2);
            twin.set("valve.command", -1.2);
        }
        gear.step(0.01);
        twin.step(0.01);
        for name in NAMES.iter().chain(&["energy.supplied", "energy.drift", "valve.speed", "supply.flow"]) {
            assert_eq!(gear.get(name).to_bits(), twin.get(name).to_bits(), "{name} in step {step}");
        }
    }
}

#[test]
fn a_failed_step_changes_nothing() {
    let definition = changed(HYDRAULIC_GEAR, |gear| {
        gear["stops"]["upstop"]["enabled"] = json!(false);
        gear["stops"]["downstop"]["enabled"] = json!(false);
        gear["actuators"]["actuator"]["hydraulics"]["command"] = json!({ "ramp_amplitude": 0.65, "ramp_time": 0.1 });
    });
    let mut gear = Run::new(&definition).started();
    gear.steps(4, 4.0);
    let before = NAMES.map(|name| gear.get(name));
    let message = gear.0.step(4.0).unwrap_err().to_string();
    assert_says(message, &["actuator.length", "0.742 m", "0.412 m", "stroke"]);
    assert_eq!(before, NAMES.map(|name| gear.get(name)));
    gear.step(0.05);
}

#[test]
fn faulty_circuits_are_refused_by_name() {
    let error = |change: &dyn Fn(&mut serde_json::Value)| {
        let text = changed(HYDRAULIC_GEAR, |gear| change(gear));
        linkage_fmu::mechanism::Model::from_json(&text).unwrap_err().to_string()
    };
    let drive =
        |gear: &mut serde_json::Value, key: &str, value: serde_json::Value| gear["actuators"]["actuator"][key] = value;
    assert_says(error(&|gear| drive(gear, "force", json!(3))), &["actuators.actuator.hydraulics", "remove force"]);
    assert_says(error(&|gear| drive(gear, "efficiency", json!(0.9))), &["actuators.actuator.hydraulics", "efficiency"]);
    assert_says(
        error(&|gear| gear["actuators"]["other"] = gear["actuators"]["actuator"].clone()),
        &["actuators.other.hydraulics", "actuator has a circuit already"],
    );
    assert_says(
        error(&|gear| gear["actuators"]["motor"] = json!({ "joint": "joint1", "hydraulics": {} })),
        &["actuators.motor.hydraulics", "prismatic"],
    );
    let circuit = |gear: &mut serde_json::Value, section: &str, key: &str, value: f64| {
        gear["actuators"]["actuator"]["hydraulics"][section][key] = json!(value)
    };
    assert_says(error(&|gear| circuit(gear, "cylinder", "rod", 0.05)), &["cylinder.rod", "cylinder.bore"]);
    assert_says(error(&|gear| circuit(gear, "chamber_a", "dead_volume", 0.0)), &["chamber_a.dead_volume"]);
    assert_says(error(&|gear| circuit(gear, "supply", "pressure", -2e5)), &["supply.pressure"]);
    assert_says(
        error(&|gear| circuit(gear, "cylinder", "colour", 1.0)),
        &["actuators.actuator.hydraulics.cylinder", "colour"],
    );
    assert_says(
        error(&|gear| circuit(gear, "cylinder", "stroke", 0.2)),
        &["actuator.length", "0.736", "0.612", "upstop"],
    );
    let mut gear = Run::shared(HYDRAULIC_GEAR).with(&[("cylinder.rod", 0.06)]);
    assert_says(gear.refusal(), &["cylinder.rod"]);
    let mut gear = Run::shared(HYDRAULIC_GEAR);
    gear.set("solver.method", "rigid_fem");
    assert_says(gear.refusal(), &["hydraulics", "rigid_fem", "reduced"]);
    let mut gear = retraction(1e-9);
    gear.set("tank.pressure", -2e5);
    assert_says(gear.0.step(1e-3).unwrap_err(), &["tank.pressure", "fluid.ambient_pressure"]);
    gear.set("tank.pressure", 0.35e6);
    gear.step(1e-3);
    assert!(gear.0.set("actuator.force", 1.0).is_err());
    assert!(gear.0.set_derivative("actuator.force", 1, 1.0).is_err());
}

/// Oil without air in chambers from which the gear's weight draws: no valve lets oil in.
#[test]
fn oil_without_air_has_no_pressure_below_absolute_zero() {
    let mut gear = retraction(1e-9);
    gear.set_all(&[("fluid.air_fraction", 0.0), ("anticavitation.conductance", 0.0), ("command.ramp_amplitude", 0.0)]);
    gear.set_all(&[
        ("chamber_a.start_pressure", 0.4e6),
        ("chamber_b.start_pressure", 0.4e6),
        ("tank.pressure", 0.35e6),
    ]);
    gear.set("load_factor", 60.0);
    gear.initialize();
    let error = (0..500).find_map(|_| gear.0.step(1e-3).err()).unwrap().to_string();
    assert_says(error, &["chamber_", "absolute", "fluid.air_fraction"]);
}

/// An input that changes takes effect at once, though steps may have gone on beyond the communication point.
#[test]
fn a_change_of_a_port_takes_effect_at_once() {
    for (name, value) in [("valve.command", -0.3), ("supply.pressure", 15e6), ("tank.pressure", 1e6)] {
        let end = |steps: u32| {
            let mut gear = retraction(1e-11);
            gear.steps(steps, 0.5);
            gear.set(name, value);
            gear.steps(steps, 0.05);
            (gear.get("crank.angle"), gear.get("chamber_a.pressure"), gear.get("energy.supplied"))
        };
        let (whole, many) = (end(1), end(500));
        assert!((whole.0 - many.0).abs() < 1e-9, "{name}: {whole:?} {many:?}");
        assert!((whole.1 / many.1 - 1.0).abs() < 1e-8 && (whole.2 / many.2 - 1.0).abs() < 1e-9, "{name}");
    }
}
