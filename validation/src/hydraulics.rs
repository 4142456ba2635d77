//! Cost of a doStep through the C functions: of the hydraulic actuator, with and without preview, and of its set-up; of
//! a network with two cylinders.

use crate::callgrind::difference;
use crate::instructions::REPEAT;
use crate::measure::{self, Asked, Pages, digits, heading, timed};
use linkage_fmu::fmi2::host::{Description, Host};
use linkage_fmu::fmi2::types::Status;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Length of a step [s], and number of steps of a run: a retraction of 4 s.
const H: f64 = 1e-3;
const STEPS: u32 = 4000;
/// Number of runs; each part of [`PART`] steps counts with its fastest run.
const RUNS: u32 = 20;
const PART: u32 = 100;
/// Number of instantiations; the fastest counts.
const SETUPS: u32 = 300;

/// One use of the actuator.
struct Use {
    title: &'static str,
    mode: &'static str,
    /// Reduced mass [kg]; 0: no preview.
    mass: f64,
    /// Outputs that are read before each step.
    reads: &'static [&'static str],
    /// Limit of the time of a step [us].
    most: f64,
}

const USES: [Use; 3] = [
    Use { title: "follow, speed with its rate", mode: "follow", mass: 0.0, reads: &[], most: 2.0 },
    Use { title: "one pass", mode: "preview", mass: 700.0, reads: &["preview.force", "preview.force_rate"], most: 4.0 },
    Use {
        title: "two passes",
        mode: "follow",
        mass: 700.0,
        reads: &["preview.force", "preview.force_rate", "preview.start_acceleration", "preview.acceleration"],
        most: 4.0,
    },
];

/// Argument of this program for repeated runs of the network.
pub const NETWORK: &str = "network";
/// Limit of the time of a step of the network [us].
const MOST_OF_NETWORK: f64 = 6.0;
/// Outputs of each cylinder of the network that a host reads before a step, and after it for the next one.
const FORESEEN: [&str; 3] = ["preview.force_mean", "preview.length", "preview.speed"];
/// Cylinders of the network.
const CYLINDERS: [&str; 2] = ["gear", "door"];

fn ok(status: Status, what: &str, host: &Host) -> Result<(), String> {
    match status {
        Status::Ok | Status::Warning => Ok(()),
        _ => Err(format!("{what}: {status:?} {:?}", host.log.take())),
    }
}

/// The table as Markdown and CSV.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let description = Description::read(&descriptions.join("HydraulicActuator"))?;
    let (mut rows, mut csv, mut figures) = (heading(&["use", "step [us]"]), String::from("use,step_us\n"), Vec::new());
    for scene in &USES {
        let mut least = vec![f64::INFINITY; (STEPS / PART) as usize];
        for _ in 0..RUNS {
            let host = description.instantiate(None, false)?;
            run(&host, scene, &mut least)?;
        }
        let micros = least.iter().sum::<f64>() * 1e6 / f64::from(STEPS);
        let _ = writeln!(rows, "| {} | {} |", scene.title, digits(micros));
        let _ = writeln!(csv, "{},{micros:.3}", scene.mode);
        figures.push(Asked::at_most(format!("step of 1 ms at 1e-9, {}", scene.title), micros, scene.most, " us"));
    }
    let network = Description::read(&descriptions.join("HydraulicSystem"))?;
    let mut least = vec![f64::INFINITY; (STEPS / PART) as usize];
    for _ in 0..RUNS {
        run_network(&network.instantiate(None, false)?, &mut least)?;
    }
    let micros = least.iter().sum::<f64>() * 1e6 / f64::from(STEPS);
    let title = "network with two cylinders, one pass";
    let _ = writeln!(rows, "| {title} | {} |", digits(micros));
    let _ = writeln!(csv, "{NETWORK},{micros:.3}");
    figures.push(Asked::at_most(format!("step of 1 ms at 1e-9, {title}"), micros, MOST_OF_NETWORK, " us"));
    let counted = difference(|runs| [REPEAT, NETWORK].map(str::to_owned).into_iter().chain([runs]).collect(), 1, 3);
    let count = counted.map_or("not counted".to_owned(), |all| format!("{:.0}", all / f64::from(STEPS)));
    let _ = writeln!(rows, "\nInstructions of a step of the network (callgrind): {count}.");
    let mut setup = f64::INFINITY;
    for _ in 0..SETUPS {
        timed(&mut setup, || description.instantiate(None, false).map(|host| host.initialize()))?;
    }
    figures.push(Asked::at_most("instantiate, initialise, free", setup * 1e6, 50.0, " us"));
    let page = measure::page("hydraulics", &[]) + &measure::asked(&figures) + &rows;
    Ok(Pages { page, csv })
}

/// A run; keeps the time of each part [s] in `least` if it is less.
fn run(host: &Host, scene: &Use, least: &mut [f64]) -> Result<(), String> {
    ok(host.set_item("coupling.mode", scene.mode), "coupling.mode", host)?;
    for (name, value) in [
        ("command.ramp_amplitude", 0.65),
        ("command.ramp_time", 0.1),
        ("actuator.length", 0.4285),
        ("actuator.reduced_mass", scene.mass),
        ("actuator.holding_force", 500.0),
        ("preview.horizon", H),
    ] {
        ok(host.set(name, value), name, host)?;
    }
    ok(host.initialize(), "initialise", host)?;
    let motion = [host.reference("actuator.length"), host.reference("actuator.speed")];
    let reads: Vec<u32> = scene.reads.iter().map(|name| host.reference(name)).collect();
    let mut values = vec![0.0; reads.len()];
    let omega = std::f64::consts::TAU / (f64::from(STEPS) * H);
    for (part, least) in (0..).zip(least) {
        let began = Instant::now();
        for step in part * PART..(part + 1) * PART {
            let t = f64::from(step) * H;
            let (sine, cosine) = (omega * t).sin_cos();
            let now = [0.5785 - 0.15 * cosine, 0.15 * omega * sine];
            ok(host.set_reals(&motion, &now), "motion", host)?;
            ok(host.reals(&reads, &mut values), "preview", host)?;
            let rates = [0.15 * omega * omega * cosine, -0.15 * omega.powi(3) * sine];
            let status = host.set_rates(motion[1], &rates);
            ok(status, "derivatives", host)?;
            ok(host.step(t, H), "doStep", host)?;
        }
        *least = least.min(began.elapsed().as_secs_f64());
    }
    Ok(())
}

/// Run the network some times: for callgrind.
pub fn repeat(descriptions: &Path, runs: &str) -> Result<(), String> {
    let network = Description::read(&descriptions.join("HydraulicSystem"))?;
    let runs: u32 = runs.parse().map_err(|e| format!("{runs}: {e}"))?;
    (0..runs).try_for_each(|_| {
        run_network(&network.instantiate(None, false)?, &mut [f64::INFINITY; (STEPS / PART) as usize])
    })
}

/// A run of the network, whose cylinders move as foreseen; keeps the time of each part [s] in `least` if it is less.
fn run_network(host: &Host, least: &mut [f64]) -> Result<(), String> {
    ok(host.set("preview.horizon", H), "preview.horizon", host)?;
    ok(host.initialize(), "initialise", host)?;
    let names = |quantities: &[&str]| -> Vec<u32> {
        let all = quantities.iter().flat_map(|quantity| CYLINDERS.map(|name| format!("{name}.{quantity}")));
        all.map(|name| host.reference(&name)).collect()
    };
    let (reads, motion, mut values) = (names(&FORESEEN), names(&["length", "speed"]), [0.0; 6]);
    for (part, least) in (0..).zip(least) {
        let began = Instant::now();
        for step in part * PART..(part + 1) * PART {
            ok(host.reals(&reads, &mut values), "preview", host)?;
            ok(host.step(f64::from(step) * H, H), "doStep", host)?;
            ok(host.set_reals(&motion, &values[2..]), "motion", host)?;
        }
        *least = least.min(began.elapsed().as_secs_f64());
    }
    Ok(())
}
