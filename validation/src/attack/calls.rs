//! Random calls of the C functions of FMI 2.0 and FMI 3.0, for co-simulation and model exchange. Each status is one
//! that the phase allows; an error has one message and changes no Real; an undefined value is reported; the instance
//! stays usable.
//!
//! In: models, random numbers. Out: the first result that is not allowed. The allowed results follow from the phases of
//! the standards alone.
use super::answers::May::{BeRefused, Either, Succeed};
use super::answers::odd;
use super::player::Phase::{Continuous, Ended, Event, Initialization, Step};
use super::player::{Answer, Phase, Player, RESET, Use};
use super::probe::Probe;
use super::random::Random;
use crate::host::{Host, WARNING, model};
use linkage_fmu::fmi2::host::State;
use linkage_fmu::fmi3::host::SPOILED;

/// Calls of a case.
const CALLS: usize = 400;
/// Texts that no message about a quantity of the hydraulic models may contain, as all of them have a unit.
const UNITS: [&str; 6] = ["NaN Pa", "NaN N", "NaN kg", "NaN J", "NaN m", "NaN rad"];

/// A kind of call: its frequency with FMI 2.0, with FMI 3.0, and in model exchange.
type Row = ([u32; 3], fn(&mut Player, &mut Random) -> Answer);

const ROWS: [Row; 27] = [
    ([4, 0, 4], Player::set_up),
    ([6, 7, 6], Player::enter),
    ([6, 7, 6], |p, _| {
        let (may, status) = (p.legal(&[Initialization], Either), p.host.exit());
        let next = if p.purpose == Use::CoSimulation { Step } else { Event };
        ("exit initialization mode", may, p.reach(status, next))
    }),
    ([1, 1, 1], |p, _| {
        let again = p.now.phase == Ended && p.purpose != Use::Exchange;
        let may = if again { Either } else { p.legal(&[Step, Event, Continuous], Succeed) };
        let status = p.host.terminate();
        ("terminate", may, p.reach(status, Ended))
    }),
    ([2, 2, 1], RESET),
    ([30, 20, 10], Player::set_real),
    ([6, 0, 0], Player::set_rates),
    ([0, 3, 3], Player::set_boolean),
    ([3, 1, 0], Player::set_number),
    ([10, 12, 6], Player::get_reals),
    ([0, 4, 0], Player::get_other),
    ([4, 4, 3], Player::derivative),
    ([0, 2, 0], Player::output_derivatives),
    ([0, 5, 0], |p, random| {
        let Host::Three(host) = &p.host else { return RESET(p, random) };
        let (name, status) = host.spoiled(random.below(SPOILED));
        (name, BeRefused, status as i32)
    }),
    ([0, 3, 2], |p, _| {
        let from = [Step, Step, Continuous][p.purpose as usize];
        let may = p.legal(&[from], Succeed).when(p.purpose != Use::CoSimulation);
        let status = p.host.enter_event_mode();
        ("enter event mode", may, p.reach(status, Event))
    }),
    ([0, 3, 4], Player::update_discrete_states),
    ([0, 4, 0], |p, random| {
        let Host::Three(host) = &p.host else { return RESET(p, random) };
        let may = p.legal(&[Event], Succeed).when(!p.now.awaits);
        let status = host.enter_step_mode() as i32;
        ("enter step mode", may, p.reach(status, Step))
    }),
    ([0, 1, 0], |p, random| {
        let Host::Three(host) = &p.host else { return RESET(p, random) };
        ("evaluate discrete states", p.legal(&[Initialization, Event], Succeed), host.evaluate() as i32)
    }),
    ([0, 0, 6], |p, _| {
        let (may, status) = (p.legal(&[Event], Succeed), p.host.enter_continuous_time_mode());
        ("enter continuous-time mode", may, p.reach(status, Continuous))
    }),
    ([0, 0, 8], |p, _| ("completed integrator step", p.legal(&[Continuous], Either), p.host.complete_step().0)),
    ([0, 0, 3], |p, random| {
        let time = if random.chance(0.2) { odd(random) } else { random.within(0.0, 10.0) };
        ("set time", p.legal(&[Event, Continuous], Succeed).when(time.is_finite()), p.host.set_time(time))
    }),
    ([0, 0, 14], Player::set_states),
    ([0, 0, 14], Player::solver_values),
    ([18, 13, 1], Player::step),
    ([4, 3, 4], |p, _| {
        p.saved = Some(p.now);
        ("get the FMU state", Succeed, p.host.save_into(&mut p.state))
    }),
    ([4, 3, 4], |p, _| match p.saved {
        None => ("set the FMU state", BeRefused, p.host.restore(&State::NONE)),
        Some(now) => {
            p.now = now;
            ("set the FMU state", Succeed, p.host.restore(&p.state))
        }
    }),
    ([2, 2, 4], |p, _| match p.saved {
        None => ("free the FMU state", Succeed, p.host.free(&mut p.state)),
        Some(_) => ("deserialize the FMU state", Succeed, p.host.renew(&mut p.state)),
    }),
];

impl Player {
    /// A random call of those of a column of [`ROWS`].
    fn call(&mut self, column: usize, random: &mut Random) -> Answer {
        let all: u32 = ROWS.iter().map(|(often, _)| often[column]).sum();
        let mut left = random.below(all as usize) as u32;
        for (often, call) in ROWS {
            if left < often[column] {
                return call(self, random);
            }
            left -= often[column];
        }
        RESET(self, random)
    }

    /// Make one call and check its result.
    fn judged(&mut self, column: usize, probe: &mut Probe, random: &mut Random, n: usize) -> Result<(), String> {
        let watched = random.chance(0.03).then(|| (self.now.phase, self.bits()));
        let (name, may, status) = probe.timed("call", || self.call(column, random));
        let log = self.host.log().take();
        if probe.verbose {
            println!("{n} {name}: {may:?}, {status} {log:?}");
        }
        let words = |text: &str| match &self.host {
            Host::Two(_) => column == 0 && UNITS.iter().any(|unit| text.contains(unit)),
            Host::Three(_) => text.contains("fmi2") || text.contains(" Real"),
        };
        let wording = log.iter().find(|message| words(&message.text)).map(|message| format!("words: {message:?}"));
        let fault = self.fault.take().or(wording);
        let fault = if !may.allows(status, &log, probe) {
            Some(format!("status {status}, may {may:?}: {log:?}"))
        } else if fault.is_none() && status > WARNING && may == BeRefused {
            watched.and_then(|before| self.changed(&before))
        } else {
            fault
        };
        fault.map_or(Ok(()), |fault| Err(format!("call {n}, {name} in {:?}: {fault}", self.now)))
    }

    /// What has changed although the call returned an error.
    fn changed(&self, (phase, before): &(Phase, Vec<(i32, [u64; 2])>)) -> Option<String> {
        let after = self.bits();
        let other = before.iter().zip(&after).position(|(before, after)| before != after);
        let value = other.map(|i| format!("refused, and value {i}: {:x?} was {:x?}", after[i], before[i]));
        let now = self.now.phase;
        value.or_else(|| (now != *phase).then(|| format!("refused, and phase {now:?} was {phase:?}")))
    }

    /// Execute a whole case.
    fn play(mut self, column: usize, probe: &mut Probe, random: &mut Random) -> Result<(), String> {
        let result = (0..CALLS).try_for_each(|n| {
            probe.count(match self.host {
                Host::Two(_) => "calls of FMI 2.0",
                Host::Three(_) => "calls of FMI 3.0",
            });
            self.judged(column, probe, random, n)
        });
        self.host.free(&mut self.state);
        result
    }
}

/// The case of this part: one instance of FMI 2.0 of a hydraulic model.
///
/// # Errors
/// A result that the phase does not allow, an error without a message, one that changes a Real, or an undefined value
/// without a warning.
pub fn second(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let name = random.pick(&["HydraulicActuator", "LandingGearRetractionHydraulic", "HydraulicSystem"]);
    let player = probe.timed("fmi2Instantiate", || Player::new(name, false, Use::CoSimulation, true, false, None))?;
    player.play(0, probe, &mut random)
}

/// The case of this part: one instance of FMI 3.0, with or without event mode, early return and intermediate updates.
pub fn third(probe: &mut Probe) -> Result<(), String> {
    const MODELS: [&str; 7] = [
        "LandingGearRetraction",
        "LandingGearRetractionHydraulic",
        "HydraulicActuator",
        "HydraulicSystem",
        "FourBar",
        "SliderCrank",
        "CraneJib",
    ];
    let mut random = probe.random.clone();
    let name = random.pick(&MODELS);
    let purpose = if random.chance(0.6) { Use::CoSimulationWithEvents } else { Use::CoSimulation };
    let (early_return, logging) = (random.chance(0.7), random.chance(0.8));
    let update_by = random.chance(0.3).then(|| random.clone());
    let make = || Player::new(name, true, purpose, logging, early_return, update_by);
    match probe.timed("fmi3InstantiateCoSimulation", make) {
        Err(_) if purpose == Use::CoSimulationWithEvents && !model(name)?.description.has_events() => {
            probe.count("instances refused, for event mode without events");
            Ok(())
        }
        player => player?.play(1, probe, &mut random),
    }
}

/// The case of this part: one instance for model exchange, of either version: models with stops, locks, friction,
/// closed and open curves.
pub fn exchange(probe: &mut Probe) -> Result<(), String> {
    const MODELS: [&str; 7] =
        ["LandingGearRetraction", "FourBar", "SliderCrank", "CraneJib", "Jib", "StickSlip", "Tailgate"];
    let mut random = probe.random.clone();
    let name = random.pick(&MODELS);
    let (is_three, logging) = (random.chance(0.5), random.chance(0.8));
    let make = || Player::new(name, is_three, Use::Exchange, logging, false, None);
    probe.timed("instantiate", make)?.play(2, probe, &mut random)
}
