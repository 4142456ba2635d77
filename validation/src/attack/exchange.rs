//! Random calls of the C functions of model exchange, of FMI 2.0 and of FMI 3.0: each status is one that the phase
//! allows, a refusal has one line and changes no Real, no state is taken that is no number, no rate or indicator is
//! given that is none, and the instance goes on.
use super::answers::{May, changed, is_early, odd};
use super::probe::Probe;
use super::random::Random;
use linkage_fmu::fmi2::host::{Description, Host as Host2, Log, State, logger};
use linkage_fmu::fmi3::host::Host as Host3;
use linkage_fmu::variables::{Causality, Kind, Variability, Variable};
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Calls of a case.
const CALLS: usize = 400;
/// The output that has no value in model exchange.
const DRIFT: &str = "energy.drift";
/// Description folders of the models: stops, locks, friction, closed and open curves.
const MODELS: [&str; 7] =
    ["LandingGearRetraction", "FourBar", "SliderCrank", "CraneJib", "Jib", "StickSlip", "Tailgate"];
const OK: i32 = 0;
const WARNING: i32 = 1;

/// Phases of model exchange (FMI 2.0.5, 3.2.3; FMI 3.0.2, 3.2.1).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Instantiated,
    Initialization,
    Event,
    Continuous,
    Ended,
}

/// An instance of either version.
enum Host {
    Two(Host2),
    Three(Host3),
}

/// The same call of either version: its status as a number.
macro_rules! status {
    ($host:expr, $h:ident => $call:expr) => {
        match $host {
            Host::Two($h) => $call as i32,
            Host::Three($h) => $call as i32,
        }
    };
}

/// The same call of either version: its status as a number, and an answer.
macro_rules! answer {
    ($host:expr, $h:ident => $call:expr) => {
        match $host {
            Host::Two($h) => {
                let (status, answer) = $call;
                (status as i32, answer)
            }
            Host::Three($h) => {
                let (status, answer) = $call;
                (status as i32, answer)
            }
        }
    };
}

impl Host {
    fn log(&self) -> &Log {
        match self {
            Self::Two(host) => &host.log,
            Self::Three(host) => &host.log,
        }
    }

    fn real(&self, reference: u32, value: &mut f64) -> i32 {
        status!(self, h => h.reals(&[reference], std::slice::from_mut(value)))
    }

    /// From the instantiated phase, with the experiment of FMI 2.0 set up before.
    fn enter(&self, tolerance: Option<f64>, start: f64) -> i32 {
        match self {
            Self::Two(host) => match host.set_up(tolerance, start, None) as i32 {
                OK => host.enter() as i32,
                refused => refused,
            },
            Self::Three(host) => host.enter(tolerance, start, None) as i32,
        }
    }

    fn set_boolean(&self, reference: u32, variable: Option<&Variable>, value: bool) -> i32 {
        match self {
            Self::Two(host) => host.set_boolean(variable.map_or("none of this name", |v| &v.name), value) as i32,
            Self::Three(host) => host.set_boolean(reference, value.into()) as i32,
        }
    }

    fn derivative(&self, unknown: u32, known: u32, value: &mut f64) -> i32 {
        let value = std::slice::from_mut(value);
        match self {
            Self::Two(host) => host.derivatives(&[unknown], known, value) as i32,
            Self::Three(host) => host.derivative(false, &[unknown], &[known], &[1.0], value) as i32,
        }
    }

    /// The state in bytes and back.
    fn renew(&self, state: &mut State) -> i32 {
        match self {
            Self::Two(host) => {
                let Ok(bytes) = host.serialize(state) else { return -1 };
                host.free(state);
                host.deserialize(&bytes).map_or_else(
                    |refused| refused as i32,
                    |new| {
                        *state = new;
                        OK
                    },
                )
            }
            Self::Three(host) => host.renew(state) as i32,
        }
    }
}

fn descriptions() -> &'static [Arc<Description>] {
    static ALL: OnceLock<Vec<Arc<Description>>> = OnceLock::new();
    ALL.get_or_init(|| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../modelDescription");
        MODELS.iter().filter_map(|name| Description::read(&folder.join(name)).ok()).collect()
    })
}

/// An instance, and what is known of it.
struct Player<'a> {
    host: &'a Host,
    description: &'a Description,
    phase: Phase,
    state: State,
    saved: Option<Phase>,
    /// What is wrong with an answer beyond its status.
    fault: Option<String>,
}

impl Player<'_> {
    /// Statuses and bits of the states and of all Reals.
    fn bits(&self) -> Vec<(i32, u64)> {
        let mut states = [0.0; 2];
        let status = status!(self.host, h => h.states(&mut states));
        let mut bits: Vec<_> = states.map(|state| (status, state.to_bits())).into();
        let is_read = |v: &Variable| v.kind == Kind::Real && v.name != DRIFT;
        let reals = (0..).zip(self.description.interface().list()).filter(|(_, v)| is_read(v));
        bits.extend(reals.map(|(reference, _)| {
            let mut value = 0.0;
            let status = self.host.real(reference, &mut value);
            (status, if status == OK { value.to_bits() } else { 0 })
        }));
        self.host.log().take();
        bits
    }

    fn legal(&self, phases: &[Phase], may: May) -> May {
        if phases.contains(&self.phase) { may } else { May::BeRefused }
    }

    /// Take a call into another phase that was answered with OK.
    fn reach(&mut self, status: i32, phase: Phase) -> i32 {
        if matches!(status, OK | WARNING) {
            self.phase = phase;
        }
        status
    }

    /// Tell numbers that came with OK and are none.
    fn check(&mut self, status: i32, values: &[f64]) -> i32 {
        if status == OK && values.iter().any(|value| !value.is_finite()) {
            self.fault = Some(format!("no numbers, and no warning: {values:?}"));
        }
        status
    }

    /// One random call: its name, what may be answered, and the answer.
    fn call(&mut self, random: &mut Random) -> (&'static str, May, i32) {
        use May::{BeRefused, Either, Succeed};
        use Phase::{Continuous, Ended, Event, Initialization, Instantiated};
        const SOLVABLE: [Phase; 4] = [Initialization, Event, Continuous, Ended];
        let host = self.host;
        let early = matches!(self.phase, Instantiated | Initialization);
        let list = self.description.interface().list();
        let reference = random.below(list.len() + 1) as u32;
        let of = list.get(reference as usize);
        // What a variable of a kind allows to set now.
        let settable = |kind: Kind| {
            of.is_some_and(|v| {
                let is_discrete = v.variability == Variability::Discrete;
                let is_open = self.phase != Ended && !(is_discrete && self.phase == Continuous);
                let is_tuned = v.variability == Variability::Tunable && self.phase == Event;
                v.kind == kind
                    && (v.causality == Causality::Input && is_open
                        || v.causality == Causality::Parameter && (early || is_tuned))
            })
        };
        // Mostly as many numbers as there are.
        let length = |own: usize, random: &mut Random| if random.chance(0.05) { random.below(own + 3) } else { own };
        match random.below(100) {
            0..=5 => {
                let tolerance = random.pick(&[None, Some(1e-9), Some(1e-4), Some(f64::NAN)]);
                let start = random.pick(&[0.0, 1.5, -3.0, f64::NAN]);
                let (may, status) = (self.legal(&[Instantiated], Either), host.enter(tolerance, start));
                ("enter initialization mode", may, self.reach(status, Initialization))
            }
            6..=11 => {
                let (may, status) = (self.legal(&[Initialization], Either), status!(host, h => h.exit()));
                ("exit initialization mode", may, self.reach(status, Event))
            }
            12..=17 => {
                let (may, status) = (self.legal(&[Event], Succeed), status!(host, h => h.enter_continuous_time_mode()));
                ("enter continuous-time mode", may, self.reach(status, Continuous))
            }
            18..=19 => {
                let (may, status) = (self.legal(&[Continuous], Succeed), status!(host, h => h.enter_event_mode()));
                ("enter event mode", may, self.reach(status, Event))
            }
            20..=23 => {
                let (status, _) = answer!(host, h => h.update_discrete_states());
                ("update discrete states", self.legal(&[Event], Either), status)
            }
            24..=31 => {
                let (status, _) = answer!(host, h => h.complete_step());
                ("completed integrator step", self.legal(&[Continuous], Either), status)
            }
            32..=34 => {
                let time = if random.chance(0.2) { odd(random) } else { random.within(0.0, 10.0) };
                let may = if time.is_finite() { self.legal(&[Event, Continuous], Succeed) } else { BeRefused };
                ("set time", may, status!(host, h => h.set_time(time)))
            }
            35..=48 => self.set_states(random),
            49..=53 => {
                let mut values = vec![0.0; length(2, random)];
                let may = if values.len() == 2 { self.legal(&SOLVABLE, Either) } else { BeRefused };
                let status = status!(host, h => h.rates(&mut values));
                ("get derivatives", may, self.check(status, &values))
            }
            54..=58 => {
                let own = self.description.indicator_count();
                let mut values = vec![0.0; length(own, random)];
                let may = if values.len() == own { self.legal(&SOLVABLE, Either) } else { BeRefused };
                let status = status!(host, h => h.indicators(&mut values));
                ("get event indicators", may, self.check(status, &values))
            }
            59..=61 => {
                let mut values = vec![0.0; length(2, random)];
                let may = if values.len() == 2 { self.legal(&SOLVABLE, Either) } else { BeRefused };
                let status = status!(host, h => h.states(&mut values));
                ("get continuous states", may, self.check(status, &values))
            }
            62 => {
                let mut values = vec![0.0; length(2, random)];
                let is_known = self.phase == Instantiated || SOLVABLE.contains(&self.phase);
                let may = if values.len() == 2 && is_known { Either } else { BeRefused };
                let status = status!(host, h => h.nominals(&mut values));
                ("get nominals", may, self.check(status, &values))
            }
            63..=72 => {
                let fine = settable(Kind::Real);
                let mut value = 1.0;
                if fine {
                    host.real(reference, &mut value);
                }
                let value = changed(value, random);
                let may = if fine && value.is_finite() { Either } else { BeRefused };
                ("set a Real", may, status!(host, h => h.set_reals(&[reference], &[value])))
            }
            73..=75 => {
                let may = if settable(Kind::Boolean) { Either } else { BeRefused };
                ("set a Boolean", may, host.set_boolean(reference, of, random.chance(0.5)))
            }
            76..=81 => {
                let has_value = self.phase != Instantiated || of.is_some_and(is_early);
                // Behind the last variable FMI 3.0 has the time.
                let is_time = of.is_none() && matches!(host, Host::Three(_));
                let is_real = of.is_some_and(|v| v.kind == Kind::Real) && has_value;
                let may = if is_real || is_time { Either } else { BeRefused };
                let mut value = 0.0;
                let status = host.real(reference, &mut value);
                // Reported once, then NaN with OK.
                let lacks = of.is_some_and(|v| v.name == DRIFT);
                ("get a Real", may, if lacks { status } else { self.check(status, &[value]) })
            }
            82..=84 => {
                let (known, mut value) = (random.below(list.len()) as u32, 0.0);
                let status = host.derivative(reference, known, &mut value);
                ("get a directional derivative", self.legal(&SOLVABLE, Either), self.check(status, &[value]))
            }
            85 => {
                let status = match host {
                    Host::Two(host) => host.step(0.0, 1e-3) as i32,
                    Host::Three(host) if random.chance(0.5) => host.enter_step_mode() as i32,
                    Host::Three(host) => host.step(0.0, 1e-3).0 as i32,
                };
                ("a step of co-simulation", BeRefused, status)
            }
            86 => {
                let (may, status) = (self.legal(&[Event, Continuous], Succeed), status!(host, h => h.terminate()));
                ("terminate", may, self.reach(status, Ended))
            }
            87 => {
                self.phase = Instantiated;
                ("reset", Succeed, status!(host, h => h.reset()))
            }
            88..=91 => {
                let status = status!(host, h => h.save_into(&mut self.state));
                self.saved = Some(self.phase);
                ("get the FMU state", Succeed, status)
            }
            92..=95 => match self.saved {
                Some(phase) => {
                    self.phase = phase;
                    ("set the FMU state", Succeed, status!(host, h => h.restore(&self.state)))
                }
                None => ("set the FMU state", BeRefused, status!(host, h => h.restore(&State::NONE))),
            },
            _ if self.saved.is_none() => ("free the FMU state", Succeed, status!(host, h => h.free(&mut self.state))),
            _ => ("deserialize the FMU state", Succeed, host.renew(&mut self.state)),
        }
    }

    /// States as a solver tries them: along the derivatives, beside them, far away, or none.
    fn set_states(&mut self, random: &mut Random) -> (&'static str, May, i32) {
        let (mut y, mut f) = ([0.0; 2], [0.0; 2]);
        status!(self.host, h => h.states(&mut y));
        status!(self.host, h => h.rates(&mut f));
        self.host.log().take();
        let h = random.decades(1e-6, 0.1);
        let mut tried: Vec<f64> = y.iter().zip(f).map(|(y, f)| y + h * f).collect();
        match random.below(8) {
            0 => tried[random.below(2)] = odd(random),
            1 => tried[random.below(2)] += random.within(-1.0, 1.0),
            2 if random.chance(0.3) => tried.truncate(random.below(2)),
            _ => {}
        }
        let may = if tried.len() == 2 { self.legal(&[Phase::Continuous], May::Either) } else { May::BeRefused };
        let status = status!(self.host, h => h.set_states(&tried));
        if status == OK {
            let mut taken = [f64::NAN; 2];
            status!(self.host, h => h.states(&mut taken));
            if taken[..] != tried[..] {
                self.fault = Some(format!("the states {tried:?} are taken and are {taken:?}"));
            }
        } else if status > WARNING && self.phase == Phase::Continuous {
            let mut kept = [f64::NAN; 2];
            status!(self.host, h => h.states(&mut kept));
            if kept.map(f64::to_bits) != y.map(f64::to_bits) {
                self.fault = Some(format!("the states {tried:?} are not taken, and {y:?} have become {kept:?}"));
            }
        }
        ("set continuous states", may, status)
    }
}

/// A part's case: one instance.
///
/// # Errors
/// An answer that the phase does not allow, a refusal without a line, or one that changes a Real; states that are taken
/// and are others; numbers that are none and are told without a warning.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let description = &descriptions()[random.below(descriptions().len())];
    let (is_three, logging) = (random.chance(0.5), random.chance(0.8));
    let host = probe.timed("instantiate", || match is_three {
        true => Host3::exchange(description, logging).map(Host::Three),
        false => description.exchange(Some(logger()), logging).map(Host::Two),
    })?;
    let (phase, state) = (Phase::Instantiated, State::NONE);
    let mut player = Player { host: &host, description, phase, state, saved: None, fault: None };
    host.log().take();
    let mut result = Ok(());
    for n in 0..CALLS {
        let watched = random.chance(0.03).then(|| (player.phase, player.bits()));
        let (name, may, status) = probe.timed("call", || player.call(&mut random));
        probe.count(if is_three { "calls of FMI 3.0" } else { "calls of FMI 2.0" });
        let log = host.log().take();
        let fine = may.allows(status, &log, probe);
        if probe.verbose {
            println!("{n} {name}: {may:?}, {status} {log:?}");
        }
        let changed = |(phase, before): (Phase, Vec<_>)| player.phase != phase || player.bits() != before;
        let fault = if !fine {
            Some(format!("status {status}, may {may:?}: {log:?}"))
        } else if player.fault.is_some() {
            player.fault.take()
        } else if status > WARNING && may == May::BeRefused && watched.is_some_and(changed) {
            Some("refused, and something has changed".into())
        } else {
            None
        };
        if let Some(fault) = fault {
            result = Err(format!("call {n}, {name} in {:?}: {fault}", player.phase));
            break;
        }
    }
    status!(&host, h => h.free(&mut player.state));
    result
}
