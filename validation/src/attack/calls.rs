//! Random calls of the C functions of the hydraulic FMUs: each status is one that the phase allows, a refusal has one
//! line and changes no Real, and the instance goes on.
use super::answers::{May, changed, odd};
use super::probe::Probe;
use super::random::Random;
use linkage_fmu::fmi2::host::{Description, Host, State, logger};
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::variables::{Causality, Kind, Variability};
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// What no message may say.
const UNITS: [&str; 6] = ["NaN Pa", "NaN N", "NaN kg", "NaN J", "NaN m", "NaN rad"];
/// Calls of a case.
const CALLS: usize = 400;

/// Phases of FMI 2.0.5, 4.2.4. After a step that did not come to its end an instance is read, restored or reset.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Instantiated,
    Initialization,
    Step,
    Ended,
}

fn descriptions() -> &'static [Arc<Description>] {
    static ALL: OnceLock<Vec<Arc<Description>>> = OnceLock::new();
    ALL.get_or_init(|| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../modelDescription");
        let names = ["HydraulicActuator", "LandingGearRetractionHydraulic"];
        names.iter().filter_map(|name| Description::read(&folder.join(name)).ok()).collect()
    })
}

/// An instance, and what is known of it.
struct Player<'a> {
    host: &'a Host,
    description: &'a Description,
    phase: Phase,
    time: f64,
    state: State,
    saved: Option<(Phase, f64)>,
}

impl Player<'_> {
    /// Bits of all Reals that can be read.
    fn bits(&self) -> Vec<(Status, u64)> {
        let reals = (0..).zip(self.description.interface().list()).filter(|(_, v)| v.kind == Kind::Real);
        let read = |(reference, _)| {
            let mut value = [0.0];
            let status = self.host.reals(&[reference], &mut value);
            (status, if status == Status::Ok { value[0].to_bits() } else { 0 })
        };
        let bits = reals.map(read).collect();
        self.host.log.take();
        bits
    }

    fn legal(&self, phases: &[Phase]) -> May {
        if phases.contains(&self.phase) { May::Succeed } else { May::BeRefused }
    }

    /// One random call: its name, what may be answered, and the answer.
    fn call(&mut self, random: &mut Random) -> (&'static str, May, Status) {
        use Phase::{Ended, Initialization, Instantiated, Step};
        let settable = [Instantiated, Initialization, Step];
        let after = [Initialization, Step, Ended];
        let early = matches!(self.phase, Instantiated | Initialization);
        let list = self.description.interface().list();
        let reference = random.below(list.len() + 1) as u32;
        let of = list.get(reference as usize);
        let is = |causality: Causality| of.is_some_and(|v| v.kind == Kind::Real && v.causality == causality);
        match random.below(100) {
            0..=3 => {
                let may = if self.phase == Instantiated { May::Either } else { May::BeRefused };
                let tolerance = random.pick(&[None, Some(1e-9), Some(1e-4), Some(f64::NAN)]);
                let start = random.pick(&[0.0, 1.5, f64::NAN]);
                let status = self.host.set_up(tolerance, start, None);
                if status == Status::Ok {
                    self.time = start;
                }
                ("fmi2SetupExperiment", may, status)
            }
            4..=9 => {
                let may = if self.phase == Instantiated { May::Either } else { May::BeRefused };
                let status = self.host.enter();
                if matches!(status, Status::Ok | Status::Warning) {
                    self.phase = Initialization;
                }
                ("fmi2EnterInitializationMode", may, status)
            }
            10..=15 => {
                let may = if self.phase == Initialization { May::Either } else { May::BeRefused };
                let status = self.host.exit();
                if matches!(status, Status::Ok | Status::Warning) {
                    self.phase = Step;
                }
                ("fmi2ExitInitializationMode", may, status)
            }
            16 => {
                let may = if self.phase == Ended { May::Either } else { self.legal(&[Step]) };
                let status = self.host.terminate();
                if status == Status::Ok {
                    self.phase = Ended;
                }
                ("fmi2Terminate", may, status)
            }
            17..=18 => {
                (self.phase, self.time) = (Instantiated, 0.0);
                ("fmi2Reset", May::Succeed, self.host.reset())
            }
            19..=48 => {
                let is_tunable = of.is_some_and(|v| v.variability == Variability::Tunable);
                let open = is(Causality::Input) || is(Causality::Parameter) && is_tunable;
                let fine = open && settable.contains(&self.phase) || is(Causality::Parameter) && early;
                let start = of.filter(|_| fine).map_or(1.0, |_| {
                    let mut value = [1.0];
                    self.host.reals(&[reference], &mut value);
                    value[0]
                });
                let value = changed(start, random);
                let may = if fine && value.is_finite() { May::Either } else { May::BeRefused };
                ("fmi2SetReal", may, self.host.set_reals(&[reference], &[value]))
            }
            49..=54 => {
                let rates: Vec<f64> = (0..=random.below(5))
                    .map(|_| if random.chance(0.1) { odd(random) } else { random.within(-1.0, 1.0) })
                    .collect();
                let fine = is(Causality::Input) && settable.contains(&self.phase);
                let fine = fine && rates.iter().all(|rate| rate.is_finite());
                let may = if fine { May::Either } else { May::BeRefused };
                ("fmi2SetRealInputDerivatives", may, self.host.set_rates(reference, &rates))
            }
            55..=57 => {
                let name = random.pick(&["coupling.mode", "solver.method", "crank.angle", "nothing"]);
                let value = random.pick(&["preview", "follow", "delayed", "", "x"]);
                ("fmi2SetInteger", if early { May::Either } else { May::BeRefused }, self.host.set_item(name, value))
            }
            58..=67 => {
                let may = match of.map(|v| (v.kind, v.causality)) {
                    Some((Kind::Real, Causality::Output | Causality::Local)) if self.phase == Instantiated => {
                        May::BeRefused
                    }
                    Some((Kind::Real, _)) => May::Either,
                    _ => May::BeRefused,
                };
                ("fmi2GetReal", may, self.host.reals(&[reference], &mut [0.0]))
            }
            68..=71 => {
                let known = random.below(list.len()) as u32;
                let may = if after.contains(&self.phase) { May::Either } else { May::BeRefused };
                ("fmi2GetDirectionalDerivative", may, self.host.derivatives(&[reference], known, &mut [0.0]))
            }
            72..=89 => {
                let h = if random.chance(0.05) {
                    random.pick(&[f64::NAN, f64::INFINITY, 0.0, -1e-3])
                } else {
                    random.decades(1e-6, 2e-2)
                };
                let point = if random.chance(0.05) { self.time + 10.0 * h } else { self.time };
                let fine = self.phase == Step && h > 0.0 && h.is_finite() && point == self.time;
                let may = if fine { May::Either } else { May::BeRefused };
                let status = self.host.step(point, h);
                match status {
                    Status::Ok | Status::Warning => self.time = point + h,
                    Status::Discard => self.phase = Ended,
                    // Refused before it began, or not: both end with a reset.
                    _ if may == May::Either => {
                        self.host.reset();
                        (self.phase, self.time) = (Instantiated, 0.0);
                    }
                    _ => {}
                }
                ("fmi2DoStep", may, status)
            }
            90..=93 => {
                let status = self.host.save_into(&mut self.state);
                self.saved = Some((self.phase, self.time));
                ("fmi2GetFMUstate", May::Succeed, status)
            }
            94..=97 => match self.saved {
                Some((phase, time)) => {
                    (self.phase, self.time) = (phase, time);
                    ("fmi2SetFMUstate", May::Succeed, self.host.restore(&self.state))
                }
                None => ("fmi2SetFMUstate", May::BeRefused, self.host.restore(&State::NONE)),
            },
            _ => {
                if self.saved.is_none() {
                    return ("fmi2FreeFMUstate", May::Succeed, self.host.free(&mut self.state));
                }
                let Ok(bytes) = self.host.serialize(&self.state) else {
                    return ("fmi2SerializeFMUstate", May::Succeed, Status::Error);
                };
                self.host.free(&mut self.state);
                match self.host.deserialize(&bytes) {
                    Ok(state) => self.state = state,
                    Err(status) => return ("fmi2DeSerializeFMUstate", May::Succeed, status),
                }
                ("fmi2DeSerializeFMUstate", May::Succeed, Status::Ok)
            }
        }
    }
}

/// A part's case: one instance.
///
/// # Errors
/// An answer that the phase does not allow, a refusal without a line, or one that changes a Real.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let description = &descriptions()[random.below(descriptions().len())];
    let host = probe.timed("fmi2Instantiate", || description.instantiate(Some(logger()), true))?;
    let (phase, time, state, saved) = (Phase::Instantiated, 0.0, State::NONE, None);
    let mut player = Player { host: &host, description, phase, time, state, saved };
    host.log.take();
    let mut result = Ok(());
    for n in 0..CALLS {
        let watched = random.chance(0.03).then(|| (player.phase, player.bits()));
        let (name, may, status) = probe.timed("call", || player.call(&mut random));
        probe.count("calls");
        let log = host.log.take();
        let fine = may.allows(status as i32, &log, probe);
        if probe.verbose {
            println!("{n} {name}: {may:?}, {status:?} {log:?}");
        }
        if !fine {
            result = Err(format!("call {n}, {name} in {:?}: {status:?}, may {may:?}: {log:?}", player.phase));
            break;
        }
        // A quantity of the model, none that the host has handed over.
        let undefined = |text: &str| UNITS.iter().any(|unit| text.contains(unit));
        if let Some(message) = log.iter().find(|message| undefined(&message.text)) {
            result = Err(format!("call {n}, {name}: a message with NaN: {message:?}"));
            break;
        }
        if let Some((phase, before)) = watched.filter(|_| status == Status::Error && may == May::BeRefused)
            && (player.phase != phase || player.bits() != before)
        {
            result = Err(format!("call {n}, {name}: refused, and something has changed"));
            break;
        }
    }
    host.free(&mut player.state);
    result
}
