//! Instructions of the calls of FMI 3.0 compared with those of FMI 2.0, counted by callgrind.
//!
//! In: the landing gear. Out: for each call of the table its count in each version. An instance of each version gets
//! the same calls.

use crate::callgrind::difference;
use crate::host::{Host, OK};
use crate::measure::{self, heading};
use crate::scene::SPAN;
use linkage_fmu::fmi2::host::{Description, State};
use linkage_fmu::fmi3::host::{Host as Host3, Wishes};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// Argument of this program for the repetition of one call in one version.
pub const CALLS: &str = "calls";
/// Tolerance of the integration.
const TOLERANCE: f64 = 1e-9;
/// Steps of 1 ms in a retraction, and calls in a repetition.
const STEPS: u32 = 130;
/// Repetitions of the two runs whose difference is used.
const REPETITIONS: [u32; 2] = [1, 51];

/// The outputs: the first alone, and all ten.
const OUTPUTS: [&str; 10] = [
    "crank.angle",
    "crank.speed",
    "crank.acceleration",
    "actuator.length",
    "actuator.speed",
    "actuator.acceleration",
    "joint1.force",
    "joint2.force",
    "joint3.force",
    "joint4.force",
];
/// The Real inputs; ten values set the first two twice.
const INPUTS: [&str; 10] = [
    "actuator.force",
    "load_factor",
    "wheel.force_x",
    "wheel.force_y",
    "crank.torque",
    "follower.torque",
    "actuator.demanded_acceleration",
    "airspeed",
    "actuator.force",
    "load_factor",
];

/// A call of the table.
#[derive(Clone, Copy)]
enum Call {
    Step,
    Get(usize),
    Set(usize),
}

/// The calls, each with its name for the command line and its title for the table.
const ROWS: [(&str, &str, Call); 5] = [
    ("step", "doStep of 1 ms", Call::Step),
    ("get1", "get, one value", Call::Get(1)),
    ("get10", "get, ten values", Call::Get(10)),
    ("set1", "set, one value", Call::Set(1)),
    ("set10", "set, ten values", Call::Set(10)),
];
/// The versions, with their names for the command line: FMI 2.0, FMI 3.0, and FMI 3.0 with event mode and early return.
const VERSIONS: [(&str, &str); 3] = [("2", "FMI 2.0"), ("3", "FMI 3.0"), ("3e", "FMI 3.0 with event mode")];

/// The table as Markdown, and its rows for the CSV.
pub fn table() -> Result<(String, String), String> {
    let mut page = format!("\n{}", measure::page("versions", &[]));
    page += &heading(&["call", VERSIONS[0].1, VERSIONS[1].1, "to FMI 2.0", VERSIONS[2].1, "to FMI 2.0"]);
    let mut csv = String::new();
    for (word, title, _) in ROWS {
        let _ = write!(page, "| {title} |");
        let mut second = 0.0;
        for (version, _) in VERSIONS {
            let [few, more] = REPETITIONS;
            let count =
                difference(|repetitions| vec![CALLS.into(), version.into(), word.into(), repetitions], few, more)?;
            let count = count / f64::from(STEPS);
            if version == VERSIONS[0].0 {
                second = count;
                let _ = write!(page, " {count:.0} |");
            } else {
                let _ = write!(page, " {count:.0} | {:.3} |", count / second);
            }
            let _ = writeln!(csv, "FMI {version},{word},1,{count:.1},{count:.1}");
        }
        page.push('\n');
    }
    Ok((page, csv))
}

/// Repeat one call: name of a version, name of a call, and number of repetitions of a retraction's worth of calls.
pub fn repeat(folder: &Path, words: [&str; 3]) -> Result<(), String> {
    let [version, call, repetitions] = words;
    let (.., call) = *ROWS.iter().find(|(word, ..)| *word == call).ok_or_else(|| format!("no call {call}"))?;
    let repetitions: u32 = repetitions.parse().map_err(|e| format!("{repetitions}: {e}"))?;
    let description = Description::read(folder)?;
    let (outputs, inputs) = (OUTPUTS.map(|n| description.reference(n)), INPUTS.map(|n| description.reference(n)));
    let host = start(&description, version)?;
    let mut values = [0.0; INPUTS.len()];
    done("get", host.reals(&inputs, &mut values))?;
    let mut start = State::NONE;
    done("get the FMU state", host.save_into(&mut start))?;
    let mut read = [0.0; OUTPUTS.len()];
    let h = SPAN / f64::from(STEPS);
    for _ in 0..repetitions {
        done("set the FMU state", host.restore(&start))?;
        for step in 0..STEPS {
            let status = match call {
                Call::Step => host.step(f64::from(step) * h, h).0,
                Call::Get(count) => host.reals(&outputs[..count], &mut read[..count]),
                Call::Set(count) => host.set_reals(&inputs[..count], &values[..count]),
            };
            done("a call", status)?;
        }
        std::hint::black_box(&read);
    }
    done("free the FMU state", host.free(&mut start))
}

/// `Ok`, or the name of the call with its status.
fn done(call: &str, status: i32) -> Result<(), String> {
    if status == OK { Ok(()) } else { Err(format!("{call}: status {status}")) }
}

/// An initialised instance of a version, at the first communication point.
fn start(description: &Arc<Description>, version: &str) -> Result<Host, String> {
    let events = version == VERSIONS[2].0;
    let host = if version == VERSIONS[0].0 {
        let host = description.instantiate(None, false)?;
        done("SetupExperiment", host.set_up(Some(TOLERANCE), 0.0, None) as i32)?;
        Host::Two(host)
    } else {
        let wishes = Wishes { event_mode: events, early_return: events, ..Wishes::default() };
        Host::Three(Host3::new(description, wishes)?)
    };
    done("EnterInitializationMode", host.enter(Some(TOLERANCE), 0.0, None))?;
    done("ExitInitializationMode", host.exit())?;
    if let (true, Host::Three(host)) = (events, &host) {
        done("UpdateDiscreteStates", host.update_discrete_states().0 as i32)?;
        done("EnterStepMode", host.enter_step_mode() as i32)?;
    }
    Ok(host)
}
