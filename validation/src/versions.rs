//! Instructions of the calls of FMI 3.0 beside those of FMI 2.0, counted by callgrind.
//!
//! In: the landing gear. Out: for each call of the table its count in each version. An instance of each version is
//! driven through the same calls.

use crate::instructions::difference;
use crate::measure::heading;
use crate::scene::SPAN;
use linkage_fmu::fmi2::host::{self as host2, Description, State};
use linkage_fmu::fmi2::types::{Status, ValueReference};
use linkage_fmu::fmi3::host as host3;
use linkage_fmu::fmi3::types::Status as Status3;
use std::fmt::Write;
use std::path::Path;

/// Argument of this program that asks for one call in one version, repeated.
pub const CALLS: &str = "calls";
/// Tolerance of the integration.
const TOLERANCE: f64 = 1e-9;
/// Steps of 1 ms in a retraction; calls in a repetition.
const STEPS: u32 = 130;
/// Repetitions of the two runs whose difference counts.
const REPETITIONS: [u32; 2] = [1, 51];

/// The outputs that are read: the first alone, and all ten.
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
/// The Real inputs; for ten values the first two are set twice.
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

/// The calls, each with its word for the command line and its words for the table.
const ROWS: [(&str, &str, Call); 5] = [
    ("step", "doStep of 1 ms", Call::Step),
    ("get1", "get, one value", Call::Get(1)),
    ("get10", "get, ten values", Call::Get(10)),
    ("set1", "set, one value", Call::Set(1)),
    ("set10", "set, ten values", Call::Set(10)),
];
/// The versions, with their words for the command line: FMI 2.0, FMI 3.0, and FMI 3.0 with event mode and early return.
const VERSIONS: [(&str, &str); 3] = [("2", "FMI 2.0"), ("3", "FMI 3.0"), ("3e", "FMI 3.0 with event mode")];

/// An instance of one version.
enum Host {
    Second(host2::Host),
    Third(host3::Host),
}

/// The table in Markdown, and its rows for the CSV.
///
/// # Errors
/// A run fails, or valgrind reports no count.
pub fn table() -> Result<(String, String), String> {
    let mut page = String::from("\n## FMI 3.0 beside FMI 2.0\n\n");
    page += "Each call by itself, repeated; the state is put back to the start before each retraction. Values are read \
        again in one \
             state, and the eight inputs set to the values they have, two of them twice. Asked: a get and a set cost \
             in FMI 3.0 \
             what they cost in FMI 2.0, a doStep 5 % more at most.\n\n";
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

/// Repeat one call: the word of a version, that of a call, and how many times a retraction's worth of them.
///
/// # Errors
/// A word names nothing; a call is refused.
pub fn repeat(folder: &Path, words: [&str; 3]) -> Result<(), String> {
    let [version, call, repetitions] = words;
    let (.., call) = *ROWS.iter().find(|(word, ..)| *word == call).ok_or_else(|| format!("no call {call}"))?;
    let repetitions: u32 = repetitions.parse().map_err(|e| format!("{repetitions}: {e}"))?;
    let description = Description::read(folder)?;
    let (outputs, inputs) = (OUTPUTS.map(|n| description.reference(n)), INPUTS.map(|n| description.reference(n)));
    let host = Host::new(&description, version)?;
    let mut values = [0.0; INPUTS.len()];
    host.get(&inputs, &mut values)?;
    let mut start = State::NONE;
    host.save(&mut start)?;
    let mut read = [0.0; OUTPUTS.len()];
    let h = SPAN / f64::from(STEPS);
    for _ in 0..repetitions {
        host.restore(&start)?;
        for step in 0..STEPS {
            match call {
                Call::Step => host.step(f64::from(step) * h, h)?,
                Call::Get(count) => host.get(&outputs[..count], &mut read[..count])?,
                Call::Set(count) => host.set(&inputs[..count], &values[..count])?,
            }
        }
        std::hint::black_box(&read);
    }
    host.free(&mut start)
}

/// `Ok`, or the name of the call with its status.
fn second(call: &str, status: Status) -> Result<(), String> {
    if status == Status::Ok { Ok(()) } else { Err(format!("fmi2{call}: {status:?}")) }
}

fn third(call: &str, status: Status3) -> Result<(), String> {
    if status == Status3::Ok { Ok(()) } else { Err(format!("fmi3{call}: {status:?}")) }
}

impl Host {
    /// An initialised instance, at the first communication point.
    fn new(description: &std::sync::Arc<Description>, version: &str) -> Result<Self, String> {
        let events = version == VERSIONS[2].0;
        if version == VERSIONS[0].0 {
            let host = description.instantiate(None, false)?;
            second("SetupExperiment", host.set_up(Some(TOLERANCE), 0.0, None))?;
            second("initialization", host.initialize())?;
            return Ok(Self::Second(host));
        }
        let wishes = host3::Wishes { event_mode: events, early_return: events, ..host3::Wishes::default() };
        let host = host3::Host::new(description, wishes)?;
        third("EnterInitializationMode", host.enter(Some(TOLERANCE), 0.0, None))?;
        third("ExitInitializationMode", host.exit())?;
        if events {
            third("UpdateDiscreteStates", host.update_discrete_states().0)?;
            third("EnterStepMode", host.enter_step_mode())?;
        }
        Ok(Self::Third(host))
    }

    #[inline]
    fn step(&self, point: f64, h: f64) -> Result<(), String> {
        match self {
            Self::Second(host) => second("DoStep", host.step(point, h)),
            Self::Third(host) => third("DoStep", host.step(point, h).0),
        }
    }

    #[inline]
    fn get(&self, references: &[ValueReference], values: &mut [f64]) -> Result<(), String> {
        match self {
            Self::Second(host) => second("GetReal", host.reals(references, values)),
            Self::Third(host) => third("GetFloat64", host.reals(references, values)),
        }
    }

    #[inline]
    fn set(&self, references: &[ValueReference], values: &[f64]) -> Result<(), String> {
        match self {
            Self::Second(host) => second("SetReal", host.set_reals(references, values)),
            Self::Third(host) => third("SetFloat64", host.set_reals(references, values)),
        }
    }

    fn save(&self, state: &mut State) -> Result<(), String> {
        match self {
            Self::Second(host) => second("GetFMUstate", host.save_into(state)),
            Self::Third(host) => third("GetFMUState", host.save_into(state)),
        }
    }

    fn restore(&self, state: &State) -> Result<(), String> {
        match self {
            Self::Second(host) => second("SetFMUstate", host.restore(state)),
            Self::Third(host) => third("SetFMUState", host.restore(state)),
        }
    }

    fn free(&self, state: &mut State) -> Result<(), String> {
        match self {
            Self::Second(host) => second("FreeFMUstate", host.free(state)),
            Self::Third(host) => third("FreeFMUState", host.free(state)),
        }
    }
}
