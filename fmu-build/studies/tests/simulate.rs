//! `cargo fmu simulate`: the memory use is constant for any number of steps; the cost of a run in addition to its
//! steps.
#![allow(clippy::unwrap_used)]

#[path = "../../../tests/support/folder.rs"]
mod folder;
#[path = "../../../tests/support/memory.rs"]
mod memory;

use fmu_build::workspace::Workspace;
use fmu_studies::simulate::{self, Arguments, Outcome};
use folder::Folder;
use linkage_fmu::component::{Component, Stepped};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{fs, process};

/// Communication step [s].
const STEP: f64 = 1e-3;
/// A four-bar that moves under gravity without a drive.
const START_VALUES: [&str; 1] = ["drive.torque=0"];

fn four_bar() -> PathBuf {
    Workspace::locate().descriptions().join("FourBar")
}

/// Largest memory of a run with this number of steps that writes a file with this ending, or none [kB].
#[cfg(target_os = "linux")]
fn memory(folder: &Path, steps: u32, ending: &str) -> u64 {
    use std::process::{Command, Stdio};
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
    command.args(["simulate", "--output-interval", "1e-3", "--stop-time", &(f64::from(steps) * STEP).to_string()]);
    command.arg("--start-values").args(START_VALUES).args(["--output-variables", "crank.angle", "crank.speed"]);
    let option = match ending {
        "" => None,
        "gif" => Some("--gif"),
        "png" => Some("--plot"),
        _ => Some("--output-file"),
    };
    if let Some(option) = option {
        command.arg(option).arg(folder.join(format!("run.{ending}")));
    }
    memory::largest(command.arg("--").arg(four_bar()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap())
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_steps() {
    let folder = Folder::new("memory");
    let grows = |ending: &str| {
        // The first row group of a Parquet file has 349 525 rows with a time and two variables.
        let [few, many] = if ending == "parquet" { [400_000, 800_000] } else { [50_000, 450_000] };
        let [short, long] = [few, many].map(|steps| memory(&folder.0, steps, ending));
        println!("{ending:>8}: {short} kB for {few} steps, {long} kB for {many}");
        // Rows of 400 000 steps need 9.6 MB. The number of blocks that wait for the writer varies slightly.
        assert!(long < short + 4_000, "{ending}: {short} kB for {few} steps, {long} kB for {many}");
        assert!(short > 1_000);
    };
    std::thread::scope(|scope| {
        scope.spawn(|| ["parquet", "png"].into_iter().for_each(grows));
        ["", "csv", "gif"].into_iter().for_each(grows);
    });
}

/// Time of the fastest of some runs [s].
fn fastest(mut run: impl FnMut()) -> f64 {
    let time = |run: &mut dyn FnMut()| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..5).map(|_| time(&mut run)).fold(f64::INFINITY, f64::min)
}

/// The same steps by the engine only.
fn engine(text: &str, steps: u32) {
    let mut model = Component::from_definition("mechanism.json", text).unwrap();
    let torque = model.interface().find("drive.torque").unwrap();
    model.set_real(torque, 0.0).unwrap();
    model.initialize().unwrap();
    for k in 0..steps {
        let time = f64::from(k) * STEP;
        let next = f64::from(k + 1) * STEP;
        assert_eq!(model.step_from(Some(time), next - time).unwrap(), Stepped::Whole);
    }
}

#[test]
#[ignore = "measures run time: cargo test --release -p fmu-studies --test simulate -- --ignored --nocapture"]
fn a_run_costs_what_its_steps_cost() {
    let (folder, workspace, steps) = (Folder::new("cost"), Workspace::locate(), 1_000_000);
    let text = fs::read_to_string(four_bar().join("resources/mechanism.json")).unwrap();
    let alone = fastest(|| engine(&text, steps));
    let run = |file: Option<&str>, variables: &[&str]| {
        let arguments = Arguments {
            path: four_bar(),
            stop_time: Some(f64::from(steps) * STEP),
            output_interval: Some(STEP),
            start_values: START_VALUES.map(String::from).to_vec(),
            output_file: file.map(|name| folder.0.join(name)),
            output_variables: variables.iter().map(|&name| name.to_owned()).collect(),
            ..Default::default()
        };
        fastest(|| assert_eq!(simulate::run(&workspace, &arguments).unwrap(), Outcome::Complete))
    };
    let bare = run(None, &[]);
    let motion = ["crank.angle", "crank.speed", "coupler.angle"];
    let cases = [
        ("no file", bare),
        ("CSV, 3 variables", run(Some("run.csv"), &motion)),
        ("CSV, all outputs", run(Some("run.csv"), &[])),
        ("Parquet, 3 variables", run(Some("run.parquet"), &motion)),
        ("Parquet, all outputs", run(Some("run.parquet"), &[])),
    ];
    let each = |seconds: f64| 1e9 * seconds / f64::from(steps);
    println!("the engine alone: {:.0} ns a step", each(alone));
    for (what, seconds) in cases {
        println!("{what}: {:.0} ns a step, {:.2} times the engine", each(seconds), seconds / alone);
    }
    assert!(bare < 1.2 * alone, "{bare} s, the engine alone {alone} s");
}

/// A pendulum under gravity that starts half a radian above the horizontal, where small motions are no oscillation.
const PENDULUM: &str = r#"{
  "name": "Pendulum", "gravity": { "acceleration": 9.81, "up_angle": 1.5707963267948966 },
  "bodies": { "ground": {}, "rod": { "mass": 1, "inertia": 0.1, "center": [0.5, 0] } },
  "joints": { "pin": { "type": "revolute", "first": "ground.origin", "second": "rod.origin" } },
  "start": { "body": "rod", "angle": 0.5, "speed": 0 }, "guess": { "rod": 0.5 },
  "solver": { "tolerance": 1e-9 }, "experiment": { "stop_time": 1, "step_size": 0.01 }, "linearisation": true
}"#;

#[test]
fn columns_without_a_value_are_reported_with_the_reason() {
    let folder = Folder::new("missing");
    let (definition, table) = (folder.0.join("pendulum.json"), folder.0.join("run.csv"));
    fs::write(&definition, PENDULUM).unwrap();
    let run = |arguments: &[&str]| {
        let mut command = process::Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
        let output = command.arg("simulate").arg(&definition).args(arguments).output().unwrap();
        assert!(output.status.success());
        let errors = String::from_utf8(output.stderr).unwrap();
        errors.lines().filter(|line| line.starts_with("warning: no value of")).map(str::to_owned).collect::<Vec<_>>()
    };
    // Below the horizontal the loads drive it back, so only the first rows have no value.
    let warnings = run(&["--output-file", table.to_str().unwrap()]);
    let text = fs::read_to_string(&table).unwrap();
    let names: Vec<_> = text.lines().next().unwrap().split(',').map(|name| name.trim_matches('"')).collect();
    let without = |index: usize| text.lines().skip(1).filter(|row| row.split(',').nth(index) == Some("nan")).count();
    let column = names.iter().position(|name| *name == "linearisation.eigenfrequency").unwrap();
    let count = without(column);
    assert!((5..95).contains(&count), "{count}");
    let line = warnings.iter().find(|line| line.contains("linearisation.eigenfrequency")).unwrap();
    assert!(line.contains(&format!("in {count} of 101 rows (first at 0.0 s): the loads do not return")), "{line}");
    // Each column is named once, and no column with all values is named.
    for (index, name) in names.iter().enumerate() {
        let lines = warnings.iter().filter(|line| line.contains(name)).count();
        assert_eq!(lines, usize::from(without(index) > 0), "{name}: {warnings:?}");
    }
    // All rows; and for a run without a file only the last row, which is the only one that is read.
    let short = ["--stop-time", "0.05", "--output-file", table.to_str().unwrap()];
    for (arguments, said) in [(&short[..], "from 0.0 s on (nan in 6 of 6 rows): "), (&short[..2], "at 0.05 s: ")] {
        let (warnings, said) = (run(arguments), format!("{said}the loads do not return the mechanism"));
        let is_named = |line: &String| line.contains("linearisation.eigenfrequency") && line.contains(&said);
        assert!(warnings.iter().any(is_named), "{said}: {warnings:?}");
    }
}

#[test]
fn start_values_may_have_a_sign() {
    let folder = Folder::new("sign");
    let definition = folder.0.join("pendulum.json");
    fs::write(&definition, PENDULUM).unwrap();
    for (value, angle) in [("-45deg", -std::f64::consts::FRAC_PI_4), ("-.5", -0.5), ("-1e-3", -1e-3)] {
        let mut command = process::Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
        let times = ["--start-time", "-2.5e-1", "--stop-time", "-2.4e-1", "--output-interval", "1e-2"];
        command.arg("simulate").arg(&definition).args(times).args(["--start-values", "rod.start_angle", value]);
        let output = command.args(["rod.start_speed", "-2", "--output-variables", "rod.angle"]).output().unwrap();
        let table = String::from_utf8_lossy(&output.stdout);
        let reached: f64 = table.split('\t').nth(1).unwrap_or_else(|| panic!("{value}: {output:?}")).parse().unwrap();
        // One step of 0.01 s at -2 rad/s. Gravity adds less than 9.81 * 0.5 / 0.35 rad/s2 * (0.01 s)^2 / 2.
        assert!((reached - (angle - 0.02)).abs() < 7.1e-4, "{value}: {reached}");
    }
}

/// A cart of 2 kg on a rail.
const CART: &str = r#"{
  "name": "Cart", "bodies": { "ground": {}, "cart": { "mass": 2 } },
  "joints": { "rail": { "type": "prismatic", "first": "ground.origin", "second": "cart.origin" } },
  "actuators": { "push": { "joint": "rail", "force": 0 } },
  "start": { "joint": "rail", "position": 0, "speed": 0 }, "guess": { "rail": 0 }, "experiment": { "stop_time": 2,
      "step_size": 0.01 }
}"#;

/// A force that increases to 10 N in 1 s and decreases to 0 in another second moves 2 kg by F T^2 / m = 5 m, for any
/// interval of the rows.
#[test]
fn a_signal_with_its_slopes_acts_as_it_is_drawn() {
    let folder = Folder::new("slopes");
    let (definition, signal) = (folder.0.join("cart.json"), folder.0.join("push.csv"));
    fs::write(&definition, CART).unwrap();
    fs::write(&signal, "time,push.force\n0,0\n1,10\n2,0\n").unwrap();
    for interval in ["2", "1", "0.5", "0.3", "0.01"] {
        let mut command = process::Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
        command
            .args(["simulate", "--set-input-derivatives", "--output-interval", interval, "--input-file"])
            .arg(&signal);
        let output =
            command.arg(&definition).args(["--output-variables", "rail.position", "push.force"]).output().unwrap();
        let printed = String::from_utf8_lossy(&output.stdout);
        let values: Vec<f64> = printed.lines().map(|line| line.split('\t').nth(1).unwrap().parse().unwrap()).collect();
        // The positions are cubic polynomials, so only rounding remains.
        assert!((values[0] - 5.0).abs() < 1e-12 && values[1].abs() < 1e-12, "every {interval} s: {values:?}");
    }
}

/// The folder of a table is created, as that of a page. An input with two values is reported.
#[test]
fn folders_are_created_and_double_inputs_reported() {
    let folder = Folder::new("both");
    let [definition, signal, table] = ["cart.json", "push.csv", "new/run.csv"].map(|name| folder.0.join(name));
    fs::write(&definition, CART).unwrap();
    fs::write(&signal, "time,push.force\n0,0\n1,10\n").unwrap();
    let mut command = process::Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
    command.arg("simulate").arg(&definition).arg("--input-file").arg(&signal).arg("--output-file").arg(&table);
    let output = command.args(["--start-values", "push.force", "3"]).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("--input-file replaces the value of push.force in --start-values"), "{errors}");
    assert!(output.status.success() && table.is_file(), "{errors}");
}

#[test]
fn a_run_without_a_length_has_the_values_at_the_start() {
    let folder = Folder::new("start");
    let [definition, table, film] = ["pendulum.json", "run.csv", "run.gif"].map(|name| folder.0.join(name));
    fs::write(&definition, PENDULUM).unwrap();
    let mut command = process::Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
    command
        .arg("simulate")
        .arg(&definition)
        .args(["--start-time", "3", "--stop-time", "3", "--output-file"])
        .arg(&table);
    let output = command.args(["--output-variables", "rod.angle", "--gif"]).arg(&film).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let rows = fs::read_to_string(&table).unwrap();
    let angle: f64 = rows.strip_prefix("\"time\",\"rod.angle\"\n3.0,").unwrap().trim_end().parse().unwrap();
    assert!((angle - 0.5).abs() < 1e-14, "{rows}");
    assert!(fs::read(&film).unwrap().starts_with(b"GIF89a"));
}

/// The rows of a killed run, or of a run on a full disk, do not replace the rows of a previous run.
#[cfg(target_os = "linux")]
#[test]
fn a_failed_write_keeps_the_previous_results() {
    let folder = Folder::new("whole");
    let (definition, table) = (folder.0.join("pendulum.json"), folder.0.join("run.csv"));
    fs::write(&definition, PENDULUM).unwrap();
    fs::write(&table, "before").unwrap();
    let simulate = |file: &Path| {
        let mut command = process::Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
        command.arg("simulate").arg(&definition).args(["--stop-time", "1e9", "--output-interval", "1e-3"]);
        command.args(["--output-variables", "rod.angle", "--output-file"]).arg(file).stderr(process::Stdio::piped());
        command.spawn().unwrap()
    };
    let unfinished =
        || fs::read_dir(&folder.0).unwrap().find(|file| file.as_ref().unwrap().metadata().unwrap().len() > 99_999);
    let mut killed = simulate(&table);
    let start = Instant::now();
    while unfinished().is_none() {
        assert!(start.elapsed() < Duration::from_secs(60) && killed.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(5));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(fs::read(&table).unwrap(), b"before");
    // A device is written directly. This device is always full.
    let full = simulate(Path::new("/dev/full")).wait_with_output().unwrap();
    let said = String::from_utf8(full.stderr).unwrap();
    let line = "error: /dev/full: the file cannot be written; free disk space, or give another folder: No space left \
        on device";
    assert!(full.status.code() == Some(1) && said.contains(line), "{said}");
}

/// The warning about a slack belt contains its time once. A warning without a time gets the time of the step.
#[test]
fn the_time_of_a_warning_is_printed_once() {
    let folder = Folder::new("slack");
    let path = folder.0.join("belt.json");
    let text = r#"{ "name": "Shafts",
        "bodies": { "ground": { "points": { "far": [0.3, 0] } }, "one": { "inertia": 0.02 },
            "two": { "inertia": 0.5 } },
        "joints": { "a": { "type": "revolute", "first": "ground.origin", "second": "one.origin" },
            "b": { "type": "revolute", "first": "ground.far", "second": "two.origin" } },
        "couplings": { "loop": { "type": "belt", "first": "one.origin", "second": "two.origin",
            "first_radius": 0.05, "second_radius": 0.08 } },
        "torques": { "motor": { "on": "one", "torque": 3 } },
        "start": { "body": "one", "angle": 0.4 }, "guess": { "one": 0.4, "two": 1.1 } }"#;
    fs::write(&path, text).unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
    let output = command.arg("simulate").arg(&path).args(["--stop-time", "0.1"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let found: Vec<&str> = said.lines().filter(|line| line.contains("slack")).collect();
    let [line] = found[..] else { panic!("{said}") };
    assert!(line.starts_with("warning: loop transmits ") && line.matches(" s").count() >= 1, "{line}");
    assert_eq!(line.matches("at t = ").count() + line.matches("warning: at ").count(), 1, "{line}");
}

#[test]
fn signals_are_separated_by_commas() {
    let folder = Folder::new("separator");
    let path = folder.0.join("in.csv");
    fs::write(&path, "time;load\n0;1\n").unwrap();
    let arguments = Arguments { path: four_bar(), input_file: Some(path), ..Arguments::default() };
    let error = simulate::run(&Workspace::locate(), &arguments).unwrap_err();
    assert!(format!("{error:#}").contains("separated by ';'"), "{error:#}");
}

/// A constant force F moves the cart of mass m by F t^2 / (2 m). The parameter set states F in kgf and m in g.
#[test]
fn a_parameter_set_has_units_and_start_values_replace_its_values() {
    let folder = Folder::new("parameters");
    let [definition, set] = ["cart.json", "heavy cart.ssv"].map(|name| folder.0.join(name));
    fs::write(&definition, CART).unwrap();
    let text = |name: &str| {
        format!(
            r#"<ssv:ParameterSet version="1.0" name="heavy"
            xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
            xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"><ssv:Parameters>
            <ssv:Parameter name="push.force"><ssv:Real value="3" unit="kgf"/></ssv:Parameter>
            <ssv:Parameter name="{name}"><ssv:Real value="2500" unit="g"/></ssv:Parameter></ssv:Parameters><ssv:Units>
            <ssc:Unit name="kgf"><ssc:BaseUnit kg="1" m="1" s="-2" factor="9.80665"/></ssc:Unit>
            <ssc:Unit name="g"><ssc:BaseUnit kg="1" factor="0.001"/></ssc:Unit></ssv:Units></ssv:ParameterSet>"#
        )
    };
    let run = |start_values: &[&str]| {
        let mut command = process::Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
        command.arg("simulate").arg(&definition).arg("--parameters").arg(&set).args(start_values);
        command.args(["--output-variables", "rail.position"]).output().unwrap()
    };
    fs::write(&set, text("cart.mass")).unwrap();
    for (start_values, force, mass) in
        [(&[][..], 3.0 * 9.806_65, 2.5), (&["--start-values", "cart.mass=4"], 3.0 * 9.806_65, 4.0)]
    {
        let output = run(start_values);
        let printed = String::from_utf8_lossy(&output.stdout);
        let position: f64 = printed.split('\t').nth(1).unwrap_or_else(|| panic!("{output:?}")).parse().unwrap();
        let expected = force / mass * 2.0 * 2.0 / 2.0;
        assert!((position - expected).abs() < 1e-12 * expected, "{position} and {expected}");
    }
    fs::write(&set, text("cart.weight")).unwrap();
    let output = run(&[]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && said.lines().count() == 1, "{output:?}");
    let words = "heavy cart.ssv: there is no variable \"cart.weight\": the most similar names are ";
    assert!(said.starts_with("error: --parameters: ") && said.contains(words) && said.contains("cart.mass"), "{said}");
}
