//! The state of a hydraulic actuator, its steps, and the motion that it foresees.
//!
//! In: laws, inputs, a step. Out: the state after the step; the motion with one element over the next step of the host.
//! A step of the integration ends where a cushion begins or ends and where the command has a kink. It must not know
//! variables, nor outputs.
mod delayed;
mod limits;
mod march;
mod preview;
mod reported;

use super::circuit::{CIRCUIT, DYNAMIC, Equations, SLACK};
use super::definition::{Circuit, Solver};
use super::error::HydraulicsError;
use super::inputs::{CommandSignal, Input, Inputs, Surroundings};
use super::systems::{Driven, ELEMENT, LENGTH, SPEED};
pub use delayed::Told;
use foundation::codec::record::{Damaged, Record};
use foundation::integrator::Integrator;
pub use march::interrupted;
use march::{Instants, Levels, March, finite};
pub use preview::{Blind, Foreseen};
pub use reported::Preview;

/// Difference of two steps that is rounding, as of t[n+1] - t[n], as a part of them.
pub const SAME_STEP: f64 = 1e-9;

/// Length beyond an end of the cylinder that a mechanism may have, besides the way of a step [m].
const OVERRUN: f64 = 1e-3;
/// Part of the longest step that counts in the next one.
const FADING: f64 = 0.95;

/// Where a hydraulic actuator is.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Time since the start [s], and what its sum has lost to rounding.
    time: [f64; 2],
    /// Pressures, spool, energies.
    pub circuit: [f64; CIRCUIT],
    /// Memory of the integration under a prescribed motion.
    pub driven: Integrator<CIRCUIT>,
    /// Memory of the integration with one element.
    pub coupled: Integrator<ELEMENT>,
    /// What the last step foresaw; none if it foresaw nothing.
    pub last: Option<Last>,
    /// Size of the last step [s], and the next one of a host that tells none; 0 before the first.
    pub step: f64,
    pub horizon: f64,
    /// Way that the piston owes the oil [m]: that of the mechanism less that of the motions kept.
    pub owed: f64,
    /// Length at the end of the last step, and the way of the step [m].
    pub arrival: Option<[f64; 2]>,
    /// What the mechanism has been told of the next step, in the mode delayed.
    pub told: Option<Told>,
}

/// The components of a circuit on which the rates depend.
pub fn dynamic(circuit: &[f64; CIRCUIT]) -> [f64; DYNAMIC] {
    let [a, b, spool, rate, supply, ..] = *circuit;
    [a, b, spool, rate, supply]
}

/// What one step leaves to the foresight of the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Last {
    /// Size of the step [s].
    pub step: f64,
    /// Length at its beginning [m].
    pub start_length: f64,
    /// Speed at its beginning [m/s].
    pub start_speed: f64,
    /// Whether a motion was foreseen from rest, or what the actuator moves was held without a limit.
    pub rests: bool,
    /// Whether the mechanism had the force that was foreseen for the step.
    pub is_known: bool,
    /// Whether the actuator has kept a motion that the mechanism did not make, as its force was for another step.
    pub owes: bool,
    /// Whether the piston was at an end of the cylinder.
    pub met_end: bool,
    /// Whether it rests there, where the length foreseen ends.
    pub rests_on_end: bool,
    /// Farthest way [m] from there that the mechanism may then have at the end of the next step, with its way by its
    /// speed.
    pub reach: f64,
    /// Time [s] in which it comes there.
    pub settling: f64,
    /// Length foreseen at its end [m].
    pub end_length: f64,
    /// Speed foreseen at its end [m/s].
    pub speed: f64,
    /// Correction r of the load [N].
    pub correction: f64,
    /// Holding force at its beginning [N].
    pub load: f64,
    /// Holding force that was expected at its end [N], in the mode delayed.
    pub expected_load: Option<f64>,
}

/// Laws, settings and inputs of one step.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    pub laws: &'a Equations,
    pub circuit: &'a Circuit,
    pub solver: &'a Solver,
    pub inputs: &'a Inputs,
    /// Whether integrations end at the first event.
    pub watches: bool,
}

impl Setting<'_> {
    #[inline]
    fn surroundings(&self, time: f64) -> Surroundings {
        Surroundings {
            supply: self.inputs.polynomial(Input::Supply),
            tank: self.inputs.polynomial(Input::Tank),
            command: self.command(time),
        }
    }

    /// Least and largest length to which what the actuator moves can be pushed [m]; no largest one where
    /// none is told.
    pub fn limits(&self) -> [f64; 2] {
        let [lower, upper] = [Input::LowerLimit, Input::UpperLimit].map(|input| self.inputs.get(input));
        [lower, if upper == 0.0 { f64::INFINITY } else { upper }]
    }

    /// The command from the time [s] since the start on.
    #[inline]
    pub fn command(&self, time: f64) -> CommandSignal {
        CommandSignal::new(self.inputs.polynomial(Input::Command), &self.circuit.command, time)
    }

    /// Refuse a length that is farther beyond the ends of the cylinder than `beyond` [m].
    pub fn check_length(&self, length: f64, beyond: f64) -> Result<(), HydraulicsError> {
        let lengths @ [least, most] = self.laws.lengths();
        if length >= least - beyond && length <= most + beyond {
            return Ok(());
        }
        Err(HydraulicsError::Travel { length, lengths })
    }

    /// Refuse a motion of the inputs that leads within a step of size h to a length that is farther beyond the ends of
    /// the cylinder than `beyond` [m].
    pub fn check_way(&self, h: f64, beyond: f64) -> Result<(), HydraulicsError> {
        let (path, lengths) = (self.inputs.length(), self.laws.lengths());
        let begin = self.inputs.get(Input::Length);
        let spread = path.spread(h);
        if begin - spread >= lengths[0] && begin + spread <= lengths[1] {
            return Ok(());
        }
        // The farthest length is at the end, or where the speed is 0.
        let mut farthest = path.at(h);
        let excess = |length: f64| (lengths[0] - length).max(length - lengths[1]);
        self.inputs.polynomial(Input::Speed).passages(0.0, h, &mut |t| {
            let length = path.at(t);
            farthest = if excess(length) > excess(farthest) { length } else { farthest };
        });
        if excess(farthest) <= beyond {
            return Ok(());
        }
        Err(HydraulicsError::Overrun { speed: self.inputs.get(Input::Speed), length: farthest, lengths })
    }
}

impl State {
    /// The start; `supply`: pressure of the supply port [Pa].
    pub fn at_start(laws: &Equations, circuit: &Circuit, supply: f64) -> Self {
        Self {
            time: [0.0; 2],
            circuit: laws.start(circuit, supply),
            driven: Integrator::default(),
            coupled: Integrator::default(),
            last: None,
            step: 0.0,
            horizon: 0.0,
            owed: 0.0,
            arrival: None,
            told: None,
        }
    }

    /// How far beyond the ends of the cylinder a mechanism may be [m] that the actuator stops there by its force: up to
    /// the way of the last step, of the piston or at the speed that the mechanism had. Without the mass of what it
    /// moves the actuator stops nothing.
    pub fn overrun(&self, setting: &Setting<'_>) -> f64 {
        let at_speed = self.last.map_or(0.0, |last| (last.start_speed * last.step).abs());
        let way = self.arrival.map_or(0.0, |[_, way]| way).max(at_speed);
        if setting.inputs.get(Input::Mass) > 0.0 { OVERRUN + way } else { SLACK }
    }

    /// Time since the start [s].
    pub fn time(&self) -> f64 {
        self.time[0]
    }

    /// The next step [s] of a host that tells none: as the last one, at first this one. Where steps change from one to
    /// the next, the longest of the last ones: a force for a step that is too short makes the oil swing.
    pub fn next_step(&self, first: f64) -> f64 {
        if self.horizon > 0.0 { self.horizon } else { first }
    }

    /// Pressures of the chambers [Pa].
    pub fn pressures(&self) -> [f64; 2] {
        [self.circuit[0], self.circuit[1]]
    }

    /// A step of size h [s] under the motion of the inputs. `rates`: those of the circuit at its beginning, if somebody
    /// has evaluated them. Returns the time reached: h, or less where `solver.max_steps` was met; or, if events are
    /// looked for, at the first one, and this event.
    ///
    /// # Errors
    /// No motion of the circuit was found, or an energy overflows; pressures, spool, energies and the memory of this
    /// integration are then undefined.
    pub fn follow(
        &mut self,
        setting: &Setting<'_>,
        h: f64,
        rates: Option<&[f64; CIRCUIT]>,
    ) -> Result<(f64, Option<usize>), HydraulicsError> {
        let (length, speed) = (setting.inputs.length(), setting.inputs.polynomial(Input::Speed));
        let surroundings = setting.surroundings(self.time());
        let mut instants = Instants::none();
        surroundings.command.kinks(h, &mut |t| instants.add(t));
        for border in setting.laws.borders().into_iter().flatten() {
            length.passages(border, h, &mut |t| instants.add(t));
        }
        instants.sort();
        let mut system = Driven { laws: setting.laws, surroundings, length, speed };
        // The inputs may have changed.
        match rates {
            Some(rates) => self.driven.begin_with(*rates),
            None => self.driven.refresh(),
        }
        let mut march = March::new(setting, &self.driven);
        let levels = Levels::new(setting, false);
        for end in instants.ends(h) {
            let memory = &mut self.driven;
            let whole = march.to(end, memory, &mut system, &mut self.circuit, &levels)?;
            if !whole {
                break;
            }
        }
        finite(&self.circuit, march.t)?;
        Ok((march.t, march.event()))
    }

    /// The step of size h is done: what it leaves to the next. `end`: length at its end.
    pub fn arrive(
        &mut self,
        setting: &Setting<'_>,
        (h, is_known, keeps): (f64, bool, bool),
        end: f64,
        foreseen: Option<&Foreseen>,
    ) {
        self.told = None;
        let is_steady = self.step == 0.0 || (self.step - h).abs() <= SAME_STEP * h;
        (self.horizon, self.step) = (if is_steady { h } else { h.max(FADING * self.horizon) }, h);
        if keeps {
            self.owed = self.owed(setting) - self.repaid(setting, h);
        }
        let get = |input| setting.inputs.get(input);
        let [length, speed] = [Input::Length, Input::Speed].map(get);
        let is_locked = setting.limits() == [length; 2];
        self.last = foreseen.filter(|foreseen| foreseen.is_whole()).map(|foreseen| Last {
            step: h,
            start_length: length,
            start_speed: speed,
            rests: speed == 0.0
                && !is_locked
                && !foreseen.course.met_end
                && (foreseen.end[LENGTH] != length || foreseen.element.limits == [length; 2]),
            is_known,
            owes: keeps && !is_known && !foreseen.course.met_end,
            met_end: foreseen.course.met_end,
            rests_on_end: foreseen.course.rests_on_end,
            reach: foreseen.reach(),
            settling: foreseen.course.settling,
            end_length: foreseen.end[LENGTH],
            speed: foreseen.end[SPEED],
            correction: foreseen.correction,
            load: get(Input::Load),
            expected_load: None,
        });
        if let Some(foreseen) = foreseen {
            self.coupled.copy_from(&foreseen.memory);
        }
        self.arrival = Some([end, (end - get(Input::Length)).abs()]);
        // Two-sum, so that many short steps do not lose the time.
        let [time, lost] = self.time;
        let delta = h + lost;
        let sum = time + delta;
        self.time = [sum, delta - (sum - time)];
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.all_finite("time", &mut self.time)?;
        record.all_finite("state of the circuit", &mut self.circuit)?;
        self.driven.record(record)?;
        self.coupled.record(record)?;
        let blank = || Last {
            step: 0.0,
            start_length: 0.0,
            start_speed: 0.0,
            rests: false,
            is_known: false,
            owes: false,
            met_end: false,
            rests_on_end: false,
            reach: 0.0,
            settling: 0.0,
            end_length: 0.0,
            speed: 0.0,
            correction: 0.0,
            load: 0.0,
            expected_load: None,
        };
        record.option("last step", &mut self.last, blank, |record, last| {
            record.positive("size of the last step", &mut last.step)?;
            record.finite("length at the start of the last step", &mut last.start_length)?;
            record.flag("rest at the start of the last step", &mut last.rests)?;
            record.flag("predicted force passed", &mut last.is_known)?;
            record.flag("piston position ahead", &mut last.owes)?;
            record.flag("end of the cylinder reached", &mut last.met_end)?;
            record.flag("rests on the end of the cylinder", &mut last.rests_on_end)?;
            for value in [&mut last.reach, &mut last.settling] {
                record.number("distance to the end", value, |value| value.is_finite() && value >= 0.0, ">= 0")?;
            }
            record.finite("predicted length", &mut last.end_length)?;
            record.finite("speed at the start of the last step", &mut last.start_speed)?;
            record.finite("predicted speed", &mut last.speed)?;
            record.finite("correction of the load", &mut last.correction)?;
            record.finite("load at the start of the last step", &mut last.load)?;
            record.option("predicted load", &mut last.expected_load, || 0.0, |record, load| record.finite("load", load))
        })?;
        record.number("size of the last step", &mut self.step, |step| step.is_finite() && step >= 0.0, ">= 0")?;
        record.number("size of the next step", &mut self.horizon, |step| step.is_finite() && step >= 0.0, ">= 0")?;
        record.finite("position difference of the piston", &mut self.owed)?;
        record.option(
            "arrival",
            &mut self.arrival,
            || [0.0; 2],
            |record, arrival| record.all_finite("arrival", arrival),
        )?;
        record.option("prediction of the next step", &mut self.told, Told::blank, |record, told| told.record(record))
    }
}
