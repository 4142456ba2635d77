//! Random calls of the C functions of FMI 3.0, on mechanisms and on the hydraulic actuator, with event mode, early
//! return and intermediate updates or without: each status is one that the phase allows, a refusal has one line and
//! changes no Float64, a value that does not exist is told, and the instance goes on.
use super::answers::{May, changed, is_early, odd};
use super::probe::Probe;
use super::random::Random;
use linkage_fmu::fmi2::host::{Description, State};
use linkage_fmu::fmi3::host::{Calls, Host, SPOILED, Wishes};
use linkage_fmu::fmi3::types::Status;
use linkage_fmu::variables::{Causality, Kind, Variability};
use std::cell::{Cell, RefCell};
use std::path::Path;
use std::rc::Rc;
use std::sync::{Arc, OnceLock};

/// Calls of a case.
const CALLS: usize = 400;
/// Description folders of the models.
const MODELS: [&str; 6] = [
    "LandingGearRetraction",
    "LandingGearRetractionHydraulic",
    "HydraulicActuator",
    "FourBar",
    "SliderCrank",
    "CraneJib",
];

/// Phases of FMI 3.0.2, 4.2.1. After a step that did not come to its end an instance is read, restored or reset.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Instantiated,
    Initialization,
    Event,
    Step,
    Ended,
}

/// What decides which calls are legal; a saved state restores it.
#[derive(Clone, Copy, Debug)]
struct Now {
    phase: Phase,
    time: f64,
    /// Whether a step has led to an event that was not handled yet.
    awaits: bool,
}

const FRESH: Now = Now { phase: Phase::Instantiated, time: 0.0, awaits: false };

/// An instance, and what is known of it.
struct Player<'a> {
    host: &'a Host,
    description: &'a Description,
    event_mode: bool,
    now: Now,
    state: State,
    saved: Option<Now>,
    /// What is wrong with an answer beyond its status.
    fault: Option<String>,
}

fn descriptions() -> &'static [Arc<Description>] {
    static ALL: OnceLock<Vec<Arc<Description>>> = OnceLock::new();
    ALL.get_or_init(|| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../modelDescription");
        MODELS.iter().filter_map(|name| Description::read(&folder.join(name)).ok()).collect()
    })
}

/// Number of vectors; found once for each model.
fn vectors_of(description: &Description) -> usize {
    static ALL: OnceLock<Vec<usize>> = OnceLock::new();
    let all = ALL.get_or_init(|| descriptions().iter().map(|description| description.vectors().len()).collect());
    let same = |other: &Arc<Description>| std::ptr::eq(Arc::as_ptr(other), description);
    descriptions().iter().position(same).map_or(0, |index| all[index])
}

/// Number of value references: scalars, time, vectors.
fn count(description: &Description) -> usize {
    description.interface().list().len() + 1 + vectors_of(description)
}

/// Number of values of a Float64 variable; none of what is no Float64.
fn size(description: &Description, reference: u32) -> Option<usize> {
    let list = description.interface().list();
    match list.get(reference as usize) {
        Some(variable) => (variable.kind == Kind::Real).then_some(1),
        None if reference as usize == list.len() => Some(1),
        None => ((reference as usize) < count(description)).then_some(2),
    }
}

/// Whether the variable has a value before initialization mode.
fn is_known_early(description: &Description, reference: u32) -> bool {
    let list = description.interface().list();
    list.get(reference as usize).map_or(reference as usize == list.len(), is_early)
}

/// What is wrong with values that are told without a warning.
fn silent(status: Status, values: &[f64]) -> Option<String> {
    let is_silent = status == Status::Ok && values.iter().any(|value| !value.is_finite());
    is_silent.then(|| format!("values that do not exist without a warning: {values:?}"))
}

/// What a host does in an intermediate update, given the time [s]: the time at which it asks for the end of the step,
/// if so.
type Update = Box<dyn Fn(&Calls, f64) -> Option<f64>>;

/// What the host does in an intermediate update: reads one variable, sets one, and asks for the end now and then.
fn update(description: Arc<Description>, random: Random, fault: Rc<RefCell<Option<String>>>) -> Update {
    let random = RefCell::new(random);
    let told = Cell::new(0_usize);
    Box::new(move |calls, time| {
        let mut random = random.borrow_mut();
        told.set(told.get() + 1);
        if told.get() % 8 != 1 {
            return None;
        }
        let reference = random.below(count(&description)) as u32;
        calls.log.take();
        if let Some(size) = size(&description, reference) {
            let mut values = vec![0.0; size];
            let status = calls.reals(&[reference], &mut values);
            let is_fine = matches!(status, Status::Ok | Status::Warning);
            let wrong = silent(status, &values).or_else(|| (!is_fine).then(|| format!("update: {status:?}")));
            if let Some(wrong) = wrong {
                fault.replace(Some(wrong));
            }
        }
        calls.log.take();
        let refused = [calls.set_reals(&[0], &[1.0]), calls.step(time, 1e-3).0, calls.reset()];
        if refused != [Status::Error; 3] || calls.log.take().len() != 3 {
            fault.replace(Some(format!("calls within an update: {refused:?}")));
        }
        random.chance(0.1).then(|| time + random.pick(&[0.0, 1e-4, -1.0, f64::NAN, f64::INFINITY]))
    })
}

impl Player<'_> {
    /// Bits of all Float64 variables that can be read.
    fn bits(&self) -> Vec<(Status, [u64; 2])> {
        let all = (0..count(self.description) as u32).filter_map(|r| Some((r, size(self.description, r)?)));
        let read = |(reference, size): (u32, usize)| {
            let mut values = [0.0; 2];
            let status = self.host.reals(&[reference], &mut values[..size]);
            (status, if status == Status::Ok { values.map(f64::to_bits) } else { [0; 2] })
        };
        let bits = all.map(read).collect();
        self.host.log.take();
        bits
    }

    fn legal(&self, phases: &[Phase], may: May) -> May {
        if phases.contains(&self.now.phase) { may } else { May::BeRefused }
    }

    /// Some references, and whether all are of Float64 variables.
    fn references(&self, random: &mut Random) -> (Vec<u32>, Option<usize>) {
        let number = 1 + random.below(3);
        let references: Vec<u32> = (0..number).map(|_| random.below(count(self.description) + 1) as u32).collect();
        let sizes = references.iter().map(|reference| size(self.description, *reference)).sum();
        (references, sizes)
    }

    /// One random call: its name, what may be answered, and the answer.
    fn call(&mut self, random: &mut Random) -> (&'static str, May, Status) {
        use May::{BeRefused, Either, Succeed};
        use Phase::{Ended, Event, Initialization, Instantiated, Step};
        let settable = [Instantiated, Initialization, Event, Step];
        let early = matches!(self.now.phase, Instantiated | Initialization);
        let list = self.description.interface().list();
        let reference = random.below(count(self.description) + 1) as u32;
        let of = list.get(reference as usize);
        let is = |causality: Causality| of.is_some_and(|v| v.kind == Kind::Real && v.causality == causality);
        match random.below(100) {
            0..=6 => {
                let tolerance = random.pick(&[None, Some(1e-9), Some(1e-4), Some(f64::NAN)]);
                let start = random.pick(&[0.0, 1.5, -3.0, f64::NAN]);
                let stop = random.pick(&[None, None, Some(1e3), Some(-1e3)]);
                let (may, status) = (self.legal(&[Instantiated], Either), self.host.enter(tolerance, start, stop));
                if status == Status::Ok {
                    self.now = Now { phase: Initialization, time: start, awaits: false };
                }
                ("fmi3EnterInitializationMode", may, status)
            }
            7..=13 => {
                let (may, status) = (self.legal(&[Initialization], Either), self.host.exit());
                if status == Status::Ok {
                    self.now.phase = if self.event_mode { Event } else { Step };
                }
                ("fmi3ExitInitializationMode", may, status)
            }
            14 => {
                let may = if self.now.phase == Ended { Either } else { self.legal(&[Step, Event], Succeed) };
                let status = self.host.terminate();
                if status == Status::Ok {
                    self.now.phase = Ended;
                }
                ("fmi3Terminate", may, status)
            }
            15..=16 => {
                self.now = FRESH;
                ("fmi3Reset", Succeed, self.host.reset())
            }
            17..=36 => {
                let fine = is(Causality::Input) && settable.contains(&self.now.phase);
                let is_tunable = of.is_some_and(|v| v.variability == Variability::Tunable);
                let is_tuned = is_tunable && matches!(self.now.phase, Step | Event);
                let fine = fine || is(Causality::Parameter) && (early || is_tuned);
                let mut value = [1.0];
                if fine {
                    self.host.reals(&[reference], &mut value);
                }
                let value = changed(value[0], random);
                let number = if random.chance(0.05) { random.below(4) } else { 1 };
                let may = if fine && value.is_finite() && number == 1 { Either } else { BeRefused };
                ("fmi3SetFloat64", may, self.host.set_reals(&[reference], &[value; 4][..number]))
            }
            37..=39 => {
                let fine = of.is_some_and(|v| {
                    let is_open = v.causality == Causality::Input && settable.contains(&self.now.phase);
                    v.kind == Kind::Boolean && (is_open || v.causality == Causality::Parameter && early)
                });
                let may = if fine { Either } else { BeRefused };
                ("fmi3SetBoolean", may, self.host.set_boolean(reference, random.pick(&[0, 1, 2, 255])))
            }
            40 => {
                let may = if early && of.is_some_and(|v| v.kind == Kind::Enumeration) { Either } else { BeRefused };
                let number = random.pick(&[1, 2, 3, 0, -1, i64::MAX]);
                ("fmi3SetInt64", may, self.host.set_number(reference, number))
            }
            41..=42 => {
                let is_boolean = of.is_some_and(|v| v.kind == Kind::Boolean);
                let has_value = self.now.phase != Instantiated || is_known_early(self.description, reference);
                let may = if is_boolean && has_value { Either } else { BeRefused };
                let mut value = 7;
                let status = self.host.boolean(reference, &mut value);
                if status == Status::Ok && value > 1 {
                    self.fault = Some(format!("a Boolean is {value}"));
                }
                ("fmi3GetBoolean", may, status)
            }
            43 => {
                let may = if of.is_some_and(|v| v.kind == Kind::Enumeration) { Either } else { BeRefused };
                ("fmi3GetInt64", may, self.host.number(reference))
            }
            44..=55 => {
                let (references, sizes) = self.references(random);
                let number = if random.chance(0.1) { random.below(8) } else { sizes.unwrap_or(1) };
                let early = |reference: &u32| is_known_early(self.description, *reference);
                let have = self.now.phase != Instantiated || references.iter().all(early);
                let may = if sizes == Some(number) && have { Either } else { BeRefused };
                let mut values = vec![0.0; number];
                let status = self.host.reals(&references, &mut values);
                self.fault = silent(status, &values);
                ("fmi3GetFloat64", may, status)
            }
            56..=59 => {
                let is_adjoint = random.chance(0.5);
                let (unknowns, sizes) = self.references(random);
                let known = random.below(list.len()) as u32;
                let number = if random.chance(0.1) { random.below(8) } else { sizes.unwrap_or(1) };
                let fits = self.legal(&[Initialization, Event, Step, Ended], Either);
                let may = if sizes == Some(number) { fits } else { BeRefused };
                let seed = if random.chance(0.05) { odd(random) } else { 1.0 };
                let (mut values, one) = (vec![0.0; number], [seed; 8]);
                let (seeds, mut back) = (&one[..number.min(8)], [0.0]);
                let status = match is_adjoint {
                    true => self.host.derivative(true, &unknowns, &[known], seeds, &mut back),
                    false => self.host.derivative(false, &unknowns, &[known], &one[..1], &mut values),
                };
                self.fault = silent(status, if is_adjoint { &back } else { &values });
                ("a derivative", may, status)
            }
            60..=61 => {
                let (references, sizes) = self.references(random);
                let orders: Vec<i32> = references.iter().map(|_| random.pick(&[1, 1, 1, 0, 2, -1])).collect();
                let number = sizes.unwrap_or(1);
                let may = if sizes.is_some() { self.legal(&[Initialization, Step, Ended], Either) } else { BeRefused };
                let mut values = vec![0.0; number];
                let status = self.host.output_derivatives(&references, &orders, &mut values);
                self.fault = silent(status, &values);
                ("fmi3GetOutputDerivatives", may, status)
            }
            62 => {
                let is_vector = (list.len() + 1..count(self.description)).contains(&(reference as usize));
                let may = if of.map_or(is_vector, |v| v.is_output()) { Either } else { BeRefused };
                ("fmi3GetVariableDependencies", may, self.host.dependencies(reference))
            }
            63..=67 => {
                let (name, status) = self.host.spoiled(random.below(SPOILED));
                (name, BeRefused, status)
            }
            68..=70 => {
                let may = if self.event_mode { self.legal(&[Step], Succeed) } else { BeRefused };
                let status = self.host.enter_event_mode();
                if status == Status::Ok {
                    self.now.phase = Event;
                }
                ("fmi3EnterEventMode", may, status)
            }
            71..=73 => {
                let (status, has_jumped) = self.host.update_discrete_states();
                let may = self.legal(&[Event], Either);
                if status == Status::Ok {
                    if has_jumped && !self.now.awaits {
                        self.fault = Some("the state jumps without an event".into());
                    }
                    self.now.awaits = false;
                }
                ("fmi3UpdateDiscreteStates", may, status)
            }
            74..=77 => {
                let may = if self.now.awaits { BeRefused } else { self.legal(&[Event], Succeed) };
                let status = self.host.enter_step_mode();
                if status == Status::Ok {
                    self.now.phase = Step;
                }
                ("fmi3EnterStepMode", may, status)
            }
            78 => ("fmi3EvaluateDiscreteStates", self.legal(&[Initialization, Event], Succeed), self.host.evaluate()),
            79..=91 => self.step(random),
            92..=94 => {
                let status = self.host.save_into(&mut self.state);
                self.saved = Some(self.now);
                ("fmi3GetFMUState", Succeed, status)
            }
            95..=97 => match self.saved {
                Some(now) => {
                    self.now = now;
                    ("fmi3SetFMUState", Succeed, self.host.restore(&self.state))
                }
                None => ("fmi3SetFMUState", BeRefused, self.host.restore(&State::NONE)),
            },
            _ if self.saved.is_none() => ("fmi3FreeFMUState", Succeed, self.host.free(&mut self.state)),
            _ => ("fmi3DeserializeFMUState", Succeed, self.host.renew(&mut self.state)),
        }
    }

    fn step(&mut self, random: &mut Random) -> (&'static str, May, Status) {
        let h = if random.chance(0.05) {
            random.pick(&[f64::NAN, f64::INFINITY, 0.0, -1e-3])
        } else {
            random.decades(1e-6, 2e-2)
        };
        let Now { phase, time, awaits } = self.now;
        let point = if random.chance(0.05) { time + 10.0 * h } else { time };
        let fine = phase == Phase::Step && !awaits && h > 0.0 && h.is_finite() && point == time;
        let may = if fine { May::Either } else { May::BeRefused };
        let (status, stepped) = self.host.step(point, h);
        match status {
            Status::Ok | Status::Warning => {
                let whole = stepped.last == point + h;
                let within = stepped.last >= point && stepped.last <= point + h;
                if !within || !whole && !stepped.early || stepped.terminate || stepped.event && !self.event_mode {
                    self.fault = Some(format!("{stepped:?} of a step from {point} by {h}"));
                }
                (self.now.time, self.now.awaits) = (stepped.last, stepped.event);
            }
            Status::Discard => (self.now.phase, self.now.time) = (Phase::Ended, stepped.last),
            // Refused before it began, or not: both end with a reset.
            _ if may == May::Either => {
                self.host.reset();
                self.now = FRESH;
            }
            _ => {}
        }
        ("fmi3DoStep", may, status)
    }
}

/// A part's case: one instance.
///
/// # Errors
/// An answer that the phase does not allow, a refusal without a line, or one that changes a Float64; a value that does
/// not exist, told without a warning.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let description = &descriptions()[random.below(descriptions().len())];
    let (event_mode, early_return) = (random.chance(0.6), random.chance(0.7));
    let fault = Rc::new(RefCell::new(None));
    let update = random.chance(0.3).then(|| update(Arc::clone(description), random.clone(), Rc::clone(&fault)));
    let wishes = Wishes { event_mode, early_return, logging: random.chance(0.8), update };
    let host = probe.timed("fmi3InstantiateCoSimulation", || Host::new(description, wishes));
    let has_events = description.has_events();
    let host = match host {
        Err(_) if event_mode && !has_events => {
            probe.count("instances refused, for event mode without events");
            return Ok(());
        }
        host => host?,
    };
    let state = State::NONE;
    let mut player = Player { host: &host, description, event_mode, now: FRESH, state, saved: None, fault: None };
    host.log.take();
    let mut result = Ok(());
    for n in 0..CALLS {
        let watched = random.chance(0.03).then(|| (player.now.phase, player.bits()));
        let (name, may, status) = probe.timed("call", || player.call(&mut random));
        probe.count("calls");
        let log = host.log.take();
        let fine = may.allows(status as i32, &log, probe);
        if probe.verbose {
            println!("{n} {name}: {may:?}, {status:?} {log:?}");
        }
        let words = |text: &str| text.contains("fmi2") || text.contains(" Real");
        let fault = player.fault.take().or_else(|| fault.borrow_mut().take());
        let fault = fault.or_else(|| log.iter().find(|m| words(&m.text)).map(|m| format!("words of FMI 2.0: {m:?}")));
        let changed = |(phase, before): (Phase, Vec<_>)| {
            let after = player.bits();
            let other = before.iter().zip(&after).position(|(before, after)| before != after);
            let value = other.map(|i| format!("value {i}: {:x?} was {:x?}", after[i], before[i]));
            value.or((player.now.phase != phase).then(|| format!("phase {:?} was {phase:?}", player.now.phase)))
        };
        let fault = if !fine {
            Some(format!("{status:?}, may {may:?}: {log:?}"))
        } else if fault.is_none() && status == Status::Error && may == May::BeRefused {
            watched.and_then(changed).map(|what| format!("refused, and something has changed: {what}"))
        } else {
            fault
        };
        if let Some(fault) = fault {
            result = Err(format!("call {n}, {name} in {:?}: {fault}", player.now));
            break;
        }
    }
    host.free(&mut player.state);
    result
}
