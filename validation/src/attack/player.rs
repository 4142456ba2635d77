//! An instance for random calls, and the longer kinds of calls.
//!
//! In: models, random numbers. Out: for each call the results that the phase allows, and the result. The allowed
//! results follow from the standards alone.
use super::answers::{Fault, May, changed, count, odd, silent, size, update};
use super::random::Random;
use crate::host::{DISCARD, Host, Model, OK, WARNING, model};
use May::Either;
use linkage_fmu::fmi2::host::{State, logger};
use linkage_fmu::fmi3::host::{Host as Host3, Wishes};
use linkage_fmu::variables::{Causality, Kind, Variability, Variable};
use std::rc::Rc;
use {Phase::Continuous, Phase::Ended, Phase::Event, Phase::Initialization, Phase::Instantiated, Phase::Step};

/// The output without a value in model exchange: reported once, then NaN with OK.
const DRIFT: &str = "energy.drift";
const TOLERANCES: [Option<f64>; 4] = [None, Some(1e-9), Some(1e-4), Some(f64::NAN)];

/// Phases of FMI 2.0.5 (3.2.3, 4.2.4) and FMI 3.0.2 (3.2.1, 4.2.1). After an incomplete step an instance can be read,
/// restored or reset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    Instantiated,
    Initialization,
    Event,
    Continuous,
    Step,
    Ended,
}

/// Type of the instance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Use {
    CoSimulation,
    CoSimulationWithEvents,
    Exchange,
}

/// The properties that decide which calls are legal; a saved state restores them.
#[derive(Clone, Copy, Debug)]
pub struct Now {
    pub phase: Phase,
    pub time: f64,
    /// Whether a step has led to an event that is not handled yet.
    pub awaits: bool,
}

pub const FRESH: Now = Now { phase: Instantiated, time: 0.0, awaits: false };

/// Replacement for calls that the version does not have: a reset of the instance.
pub const RESET: fn(&mut Player, &mut Random) -> Answer = |p, _| {
    p.now = FRESH;
    ("reset", May::Succeed, p.host.reset())
};

/// An instance, and its expected condition.
pub struct Player {
    pub host: Host,
    model: &'static Model,
    pub purpose: Use,
    pub now: Now,
    pub state: State,
    pub saved: Option<Now>,
    /// Fault of a result beyond its status.
    pub fault: Fault,
}

/// Name of a call, allowed results, and actual result.
pub type Answer = (&'static str, May, i32);

impl Player {
    pub fn new(
        name: &'static str,
        is_three: bool,
        purpose: Use,
        logging: bool,
        early_return: bool,
        update_by: Option<Random>,
    ) -> Result<Self, String> {
        let (model, fault) = (model(name)?, Fault::default());
        let description = &model.description;
        let event_mode = purpose == Use::CoSimulationWithEvents;
        let host = match (is_three, purpose) {
            (false, Use::Exchange) => Host::Two(description.exchange(Some(logger()), logging)?),
            (false, _) => Host::Two(description.instantiate(Some(logger()), logging)?),
            (true, Use::Exchange) => Host::Three(Host3::exchange(description, logging)?),
            (true, _) => {
                let update = update_by.map(|random| update(model, random, Rc::clone(&fault)));
                Host::Three(Host3::new(description, Wishes { event_mode, early_return, logging, update })?)
            }
        };
        host.log().take();
        Ok(Self { host, model, purpose, now: FRESH, state: State::NONE, saved: None, fault })
    }

    pub fn is_two(&self) -> bool {
        matches!(self.host, Host::Two(_))
    }

    fn list(&self) -> &'static [Variable] {
        self.model.description.interface().list()
    }

    /// Number of value references.
    fn count(&self) -> usize {
        if self.is_two() { self.list().len() } else { count(self.model) }
    }

    /// A reference, mostly of a variable, and that variable.
    fn any(&self, random: &mut Random) -> (u32, Option<&'static Variable>) {
        let reference = random.below(self.count() + 1) as u32;
        (reference, self.list().get(reference as usize))
    }

    /// Number of values of a Real; None for other types.
    fn size(&self, reference: u32) -> Option<usize> {
        size(self.model, reference).filter(|_| (reference as usize) < self.count())
    }

    /// Several references, one in FMI 2.0, and the number of their values if all are Reals.
    fn references(&self, random: &mut Random) -> (Vec<u32>, Option<usize>) {
        let number = if self.is_two() { 1 } else { 1 + random.below(3) };
        let references: Vec<u32> = (0..number).map(|_| self.any(random).0).collect();
        let sizes = references.iter().map(|&reference| self.size(reference)).sum();
        (references, sizes)
    }

    /// A number of values, mostly the correct one; always in FMI 2.0.
    fn number(&self, own: Option<usize>, random: &mut Random) -> usize {
        let others = !self.is_two() && random.chance(0.1);
        if others { random.below(8) } else { own.unwrap_or(1) }
    }

    fn is_early(&self) -> bool {
        matches!(self.now.phase, Instantiated | Initialization)
    }

    /// Whether the variable has a value in this phase.
    fn is_known(&self, reference: u32) -> bool {
        let early = |v: &Variable| matches!(v.causality, Causality::Input | Causality::Parameter);
        let variable = self.list().get(reference as usize);
        self.now.phase != Instantiated || variable.map_or(reference as usize == self.list().len(), early)
    }

    /// Whether a variable of this type may be set in this phase.
    fn is_settable(&self, variable: Option<&Variable>, kind: Kind) -> bool {
        let phase = self.now.phase;
        variable.is_some_and(|v| {
            let is_open = phase != Ended && !(v.variability == Variability::Discrete && phase == Continuous);
            let is_tuned = v.variability == Variability::Tunable && matches!(phase, Event | Step);
            let is_parameter = v.causality == Causality::Parameter && (self.is_early() || is_tuned);
            v.kind == kind && (v.causality == Causality::Input && is_open || is_parameter)
        })
    }

    pub fn legal(&self, phases: &[Phase], may: May) -> May {
        may.when(phases.contains(&self.now.phase))
    }

    /// Enter a phase if the call returned OK.
    pub fn reach(&mut self, status: i32, phase: Phase) -> i32 {
        if matches!(status, OK | WARNING) {
            self.now.phase = phase;
        }
        status
    }

    /// Whether one of these variables has no value in this instance.
    fn lacks(&self, references: &[u32]) -> bool {
        let is_drift = |&r: &u32| self.list().get(r as usize).is_some_and(|v| v.name == DRIFT);
        self.purpose == Use::Exchange && references.iter().any(is_drift)
    }

    /// Note undefined numbers returned with OK.
    fn check(&mut self, status: i32, values: &[f64]) -> i32 {
        if let Some(wrong) = silent(status, values) {
            self.fault.replace(Some(wrong));
        }
        status
    }

    /// Statuses and bits of all readable Reals, and of the continuous states.
    pub fn bits(&self) -> Vec<(i32, [u64; 2])> {
        let read =
            |status: i32, values: [f64; 2]| (status, if status == OK { values.map(f64::to_bits) } else { [0; 2] });
        let mut bits = Vec::new();
        let mut values = [0.0; 2];
        if self.purpose == Use::Exchange {
            bits.push(read(self.host.states(&mut values), values));
        }
        for reference in 0..self.count() as u32 {
            let is_compared = self.list().get(reference as usize).is_none_or(|v| v.name != DRIFT);
            if let Some(size) = size(self.model, reference).filter(|_| is_compared || self.purpose != Use::Exchange) {
                let mut values = [0.0; 2];
                bits.push(read(self.host.reals(&[reference], &mut values[..size]), values));
            }
        }
        self.host.log().take();
        bits
    }

    pub fn set_up(&mut self, random: &mut Random) -> Answer {
        let (tolerance, start) = (random.pick(&TOLERANCES), random.pick(&[0.0, 1.5, -3.0, f64::NAN]));
        let Host::Two(host) = &self.host else { return self.enter(random) };
        let status = host.set_up(tolerance, start, None) as i32;
        let may = self.legal(&[Instantiated], Either);
        if status == OK {
            self.now.time = start;
        }
        ("set up the experiment", may, status)
    }

    pub fn enter(&mut self, random: &mut Random) -> Answer {
        let (tolerance, start) = (random.pick(&TOLERANCES), random.pick(&[0.0, 1.5, -3.0, f64::NAN]));
        let stop = random.pick(&[None, None, Some(1e3), Some(-1e3)]);
        let (may, status) = (self.legal(&[Instantiated], Either), self.host.enter(tolerance, start, stop));
        if status == OK && !self.is_two() {
            self.now.time = start;
        }
        ("enter initialization mode", may, self.reach(status, Initialization))
    }

    pub fn set_real(&mut self, random: &mut Random) -> Answer {
        let (reference, variable) = self.any(random);
        let fine = self.is_settable(variable, Kind::Real);
        let mut value = [1.0];
        if fine {
            self.host.reals(&[reference], &mut value);
        }
        let value = changed(value[0], random);
        let wrong = !self.is_two() && random.chance(0.05);
        let number = if wrong { random.below(4) } else { 1 };
        let may = Either.when(fine && value.is_finite() && number == 1);
        ("set a Real", may, self.host.set_reals(&[reference], &[value; 4][..number]))
    }

    pub fn set_rates(&mut self, random: &mut Random) -> Answer {
        let (reference, variable) = self.any(random);
        let rate = |_| if random.chance(0.1) { odd(random) } else { random.within(-1.0, 1.0) };
        let rates: Vec<f64> = (0..=4).map(rate).collect();
        let rates = &rates[..=random.below(5)];
        let is_input = variable.is_some_and(|v| v.kind == Kind::Real && v.causality == Causality::Input);
        let fine = is_input && self.now.phase != Ended && rates.iter().all(|rate| rate.is_finite());
        let Host::Two(host) = &self.host else { return RESET(self, random) };
        ("set input derivatives", Either.when(fine), host.set_rates(reference, rates) as i32)
    }

    pub fn set_boolean(&mut self, random: &mut Random) -> Answer {
        let (reference, variable) = self.any(random);
        let value = random.pick(&[0, 1, 2, 255]);
        let status = match &self.host {
            Host::Two(host) => host.set_boolean(variable.map_or("none of this name", |v| &v.name), value > 0) as i32,
            Host::Three(host) => host.set_boolean(reference, value) as i32,
        };
        ("set a Boolean", Either.when(self.is_settable(variable, Kind::Boolean)), status)
    }

    /// Sets an Enumeration in half of the cases.
    pub fn set_number(&mut self, random: &mut Random) -> Answer {
        let enumerations = (0..).zip(self.list()).filter(|(_, v)| v.kind == Kind::Enumeration);
        let enumerations: Vec<u32> = enumerations.map(|(reference, _)| reference).collect();
        let known = !enumerations.is_empty() && random.chance(0.5);
        let reference = if known { random.pick(&enumerations) } else { self.any(random).0 };
        let variable = self.list().get(reference as usize);
        let number = random.pick(&[1, 2, 3, 0, -1, i64::MAX]);
        let status = match &self.host {
            Host::Two(host) => host.set_number(variable.map_or("none of this name", |v| &v.name), number as i32) as i32,
            Host::Three(host) => host.set_number(reference, number) as i32,
        };
        let is_enumeration = variable.is_some_and(|v| v.kind == Kind::Enumeration);
        ("set an Enumeration", Either.when(self.is_early() && is_enumeration), status)
    }

    pub fn get_reals(&mut self, random: &mut Random) -> Answer {
        let (references, sizes) = self.references(random);
        let number = self.number(sizes, random);
        let have = references.iter().all(|&reference| self.is_known(reference));
        let mut values = vec![0.0; number];
        let status = self.host.reals(&references, &mut values);
        let known_values = if self.lacks(&references) { &[] } else { &values[..] };
        let status = self.check(status, known_values);
        ("get Reals", Either.when(sizes == Some(number) && have), status)
    }

    /// Reads a Boolean, an Enumeration, or the dependencies of a variable.
    pub fn get_other(&mut self, random: &mut Random) -> Answer {
        let (reference, variable) = self.any(random);
        let Host::Three(host) = &self.host else { return RESET(self, random) };
        let is = |kind: Kind| variable.is_some_and(|v| v.kind == kind);
        match random.below(4) {
            0 => ("get an Enumeration", Either.when(is(Kind::Enumeration)), host.number(reference) as i32),
            1 => {
                let is_vector = (self.list().len() + 1..count(self.model)).contains(&(reference as usize));
                let may = Either.when(variable.map_or(is_vector, |v| v.is_output()));
                ("get dependencies", may, host.dependencies(reference) as i32)
            }
            _ => {
                let mut value = 7;
                let status = host.boolean(reference, &mut value) as i32;
                if status == OK && value > 1 {
                    self.fault.replace(Some(format!("a Boolean is {value}")));
                }
                ("get a Boolean", Either.when(is(Kind::Boolean) && self.is_known(reference)), status)
            }
        }
    }

    /// Directional or adjoint derivative with respect to one variable.
    pub fn derivative(&mut self, random: &mut Random) -> Answer {
        let (unknowns, _) = self.references(random);
        // Outputs other than Reals have a derivative of 0.
        let jumps = |&r: &u32| self.list().get(r as usize).is_some_and(|v| v.kind != Kind::Real && v.is_output());
        let sizes: Option<usize> = unknowns.iter().map(|r| self.size(*r).or(jumps(r).then_some(1))).sum();
        let known = random.below(self.list().len()) as u32;
        let number = self.number(sizes, random);
        let fits = self.legal(&[Initialization, Event, Continuous, Step, Ended], Either);
        let seed = if random.chance(0.05) { odd(random) } else { 1.0 };
        let (mut values, seeds, mut back) = (vec![0.0; number], [seed; 8], [0.0]);
        let is_adjoint = random.chance(0.5);
        let status = match &self.host {
            Host::Two(host) => host.derivatives(&unknowns, known, &mut values) as i32,
            Host::Three(host) if is_adjoint => {
                host.derivative(true, &unknowns, &[known], &seeds[..number.min(8)], &mut back) as i32
            }
            Host::Three(host) => host.derivative(false, &unknowns, &[known], &seeds[..1], &mut values) as i32,
        };
        let known_values = if is_adjoint && !self.is_two() { &back[..] } else { &values };
        let known_values = if self.lacks(&unknowns) { &[] } else { known_values };
        let may = fits.when(sizes == Some(number));
        ("get a derivative", may, self.check(status, known_values))
    }

    pub fn output_derivatives(&mut self, random: &mut Random) -> Answer {
        let (references, sizes) = self.references(random);
        let orders: Vec<i32> = references.iter().map(|_| random.pick(&[1, 1, 1, 0, 2, -1])).collect();
        let Host::Three(host) = &self.host else { return RESET(self, random) };
        let mut values = vec![0.0; sizes.unwrap_or(1)];
        let status = host.output_derivatives(&references, &orders, &mut values) as i32;
        let may = self.legal(&[Initialization, Step, Ended], Either).when(sizes.is_some());
        ("get output derivatives", may, self.check(status, &values))
    }

    pub fn update_discrete_states(&mut self, _: &mut Random) -> Answer {
        let may = self.legal(&[Event], Either);
        let (status, has_jumped) = self.host.update_discrete_states();
        if status == OK {
            if has_jumped && !self.now.awaits && self.purpose != Use::Exchange {
                self.fault.replace(Some("the state jumps without an event".into()));
            }
            self.now.awaits = false;
        }
        ("update discrete states", may, status)
    }

    /// Derivatives, event indicators, states or nominal values; mostly the correct number of them.
    pub fn solver_values(&mut self, random: &mut Random) -> Answer {
        type Get = fn(&Host, &mut [f64]) -> i32;
        let rows: [(&str, usize, Get); 4] = [
            ("get derivatives", 2, Host::rates),
            ("get event indicators", self.model.description.indicator_count(), Host::indicators),
            ("get continuous states", 2, Host::states),
            ("get nominals", 2, Host::nominals),
        ];
        let (name, own, get) = rows[random.pick(&[0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 3])];
        let mut values = vec![0.0; if random.chance(0.05) { random.below(own + 3) } else { own }];
        let is_known = self.now.phase != Instantiated || name == "get nominals";
        let status = get(&self.host, &mut values);
        (name, Either.when(values.len() == own && is_known), self.check(status, &values))
    }

    /// States as a solver sets them: along the derivatives, next to them, far away, or undefined.
    pub fn set_states(&mut self, random: &mut Random) -> Answer {
        let (mut y, mut f) = ([0.0; 2], [0.0; 2]);
        self.host.states(&mut y);
        self.host.rates(&mut f);
        self.host.log().take();
        let h = random.decades(1e-6, 0.1);
        let mut tried: Vec<f64> = y.iter().zip(f).map(|(y, f)| y + h * f).collect();
        match random.below(8) {
            0 => tried[random.below(2)] = odd(random),
            1 => tried[random.below(2)] += random.within(-1.0, 1.0),
            2 if random.chance(0.3) => tried.truncate(random.below(2)),
            _ => {}
        }
        let may = self.legal(&[Continuous], Either).when(tried.len() == 2);
        let status = self.host.set_states(&tried);
        let mut now = [f64::NAN; 2];
        if status == OK || self.now.phase == Continuous {
            self.host.states(&mut now);
            let same = if status == OK { now[..] == tried[..] } else { now.map(f64::to_bits) == y.map(f64::to_bits) };
            if !same {
                self.fault.replace(Some(format!("the states {tried:?}, status {status}: {y:?} have become {now:?}")));
            }
        }
        ("set continuous states", may, status)
    }

    pub fn step(&mut self, random: &mut Random) -> Answer {
        let odd = random.pick(&[f64::NAN, f64::INFINITY, 0.0, -1e-3]);
        let h = if random.chance(0.05) { odd } else { random.decades(1e-6, 2e-2) };
        let Now { phase, time, awaits } = self.now;
        let point = if random.chance(0.05) { time + 10.0 * h } else { time };
        let may = Either.when(phase == Step && !awaits && h > 0.0 && h.is_finite() && point == time);
        let (status, stepped) = self.host.step(point, h);
        match status {
            OK | WARNING => {
                let whole = stepped.last == point + h;
                let within = stepped.last >= point && stepped.last <= point + h;
                let event = stepped.event && self.purpose != Use::CoSimulationWithEvents;
                if !within || !whole && !stepped.early || stepped.terminate || event {
                    self.fault.replace(Some(format!("{stepped:?} of a step from {point} by {h}")));
                }
                (self.now.time, self.now.awaits) = (stepped.last, stepped.event);
            }
            DISCARD => {
                self.now.phase = Ended;
                if !self.is_two() {
                    self.now.time = stepped.last;
                }
            }
            // The step returned an error, before or after it changed the instance. Both cases end with a reset.
            _ if may == Either => {
                self.host.reset();
                self.now = FRESH;
            }
            _ => {}
        }
        ("step", may, status)
    }
}
