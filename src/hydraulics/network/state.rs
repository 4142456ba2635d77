//! The state of a network, its steps, and the motion that it foresees.
//!
//! In: laws, inputs, a step. Out: the state after the step; the motion with one element at each cylinder over the next
//! step of the host. It must not know variables, nor outputs.
mod ends;
mod foreseen;
mod setting;

use super::definition::{HydraulicSystem, MOST_CYLINDERS};
use super::inputs::Inputs;
use super::laws::{Drive, Element, Laws, Rest};
use super::layout::Part;
use super::system::{Job, Memory, Motion};
use crate::error::HydraulicsError;
use foundation::codec::record::{Damaged, Record};
use foundation::integrator::Statistics;
use foundation::numerics::dual::{Dual, Number};

use ends::Rested;
pub use foreseen::{Foreseen, Predicted};
pub use setting::Setting;

/// Change of the mass over one step, as a part of the mass, from which one element does not foresee the motion.
const MASS_CHANGE: f64 = 0.5;
/// Acceleration of an element that no mass and load have [m/s2].
const MOST_ACCELERATION: f64 = 1e30;
/// Distance from a limit of the length within which a cylinder is at it [m].
const AT_LIMIT: f64 = 1e-9;

/// Where a network is.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Time since the start [s], and what its sum has lost to rounding.
    time: [f64; 2],
    /// Components as [`Layout`] orders them.
    pub y: Vec<f64>,
    memory: Memory,
    /// Volume of all chambers [m3] from which that of the oil is balanced: at the start, and what lengths have jumped.
    pub start_volume: f64,
    /// Size of the last step [s]; 0 before the first.
    pub last_step: f64,
    /// What the last step foresaw of each cylinder.
    last: Vec<Last>,
    /// Whether each lock is engaged.
    pub locks: Vec<bool>,
}

/// What one step leaves to the foresight of the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Last {
    /// Whether the step foresaw the motion of the cylinder.
    is_known: bool,
    /// Speed at its beginning [m/s].
    start_speed: f64,
    /// Speed foreseen at its end [m/s].
    speed: f64,
    /// Correction r of the load [N].
    correction: f64,
    /// Holding force at its beginning [N].
    load: f64,
    /// Way of the cylinder in it [m].
    way: f64,
    /// How the piston has come to rest at an end of the cylinder.
    rested: Option<Rested>,
}

/// Why a cylinder moves by its inputs although the mass that it moves is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Toggle(pub usize);

impl State {
    /// The start of a network.
    pub fn at_start(laws: &Laws, system: &HydraulicSystem, inputs: &Inputs) -> Self {
        let layout = &laws.layout;
        let mut y = vec![0.0; layout.components()];
        laws.fill_start(system, &mut y);
        let locks = laws.locks.iter().map(|lock| y[lock.at] < lock.release).collect();
        let mut state = Self {
            time: [0.0; 2],
            memory: Memory::new(layout),
            start_volume: 0.0,
            last_step: 0.0,
            last: vec![Last::default(); layout.cylinders],
            locks,
            y,
        };
        state.take_motion(laws, inputs);
        state.start_volume = laws.chamber_volume(&state.y);
        state
    }

    /// Work done since the start.
    pub fn statistics(&self) -> Statistics {
        self.memory.statistics()
    }

    /// Room for the largest network.
    #[cfg(test)]
    pub fn make_large(&mut self) {
        self.memory = Memory::large();
    }

    /// Become the same as another state of the same network, without allocation.
    pub fn copy_from(&mut self, other: &Self) {
        self.y.copy_from_slice(&other.y);
        self.last.copy_from_slice(&other.last);
        self.locks.copy_from_slice(&other.locks);
        self.memory.copy_from(&other.memory);
        (self.time, self.start_volume, self.last_step) = (other.time, other.start_volume, other.last_step);
    }

    /// Lengths and speeds are those of the inputs; a jump of a length moves no oil.
    fn take_motion(&mut self, laws: &Laws, inputs: &Inputs) {
        let before = laws.chamber_volume(&self.y);
        for cylinder in 0..laws.layout.cylinders {
            let (own, length) = (laws.layout.motion(cylinder), laws.layout.of_cylinder(cylinder, Part::Length));
            self.y[own..own + 2].copy_from_slice(&inputs.values[length..length + 2]);
        }
        self.start_volume += laws.chamber_volume(&self.y) - before;
    }

    /// Force of a cylinder [N] at a speed.
    fn force(&self, laws: &Laws, cylinder: usize, speed: f64) -> f64 {
        let chamber = laws.layout.chamber(cylinder);
        laws.cylinders[cylinder].laws.force([self.y[chamber], self.y[chamber + 1]], speed)
    }

    /// The load's correction r of a cylinder, and whether the last step met a contact: m (v - v_foreseen)/h is what the
    /// element did not know. A contact stops or reverses the motion, or its impulse is more than that of force and load
    /// together; then r is 0, as the next step knows nothing of it.
    fn correction(&self, setting: &Setting<'_>, cylinder: usize) -> (f64, bool) {
        let last = &self.last[cylinder];
        if !last.is_known {
            return (0.0, false);
        }
        let get = |part| setting.get(cylinder, part);
        let (v, m) = (get(Part::Speed), get(Part::Mass));
        let missed = v - last.speed;
        let loads = get(Part::Load).abs() + last.load.abs();
        let exceeds = |most: f64| (m * missed).abs() > most * self.last_step;
        let force = || self.force(setting.laws, cylinder, last.speed).abs();
        let reversed = v * last.speed <= 0.0 && missed.abs() > 0.5 * last.start_speed.abs().max(last.speed.abs());
        let contact = reversed || exceeds(loads) && exceeds(force() + loads);
        (if contact { 0.0 } else { last.correction - m * missed / self.last_step }, contact)
    }

    /// The element along a cylinder, of inputs with or without their change: its load is the holding force plus the
    /// correction; where no derivative of the holding force is told, the load has the rate of the last step.
    pub fn element<T: Number>(&self, setting: &Setting<'_>, cylinder: usize, of: impl Fn(Part) -> T) -> Element<T> {
        let last = &self.last[cylinder];
        let (mass, load, load_derivative) = (of(Part::Mass), of(Part::Load), of(Part::LoadDerivative));
        let (mut corrected, mut load_rate) = (load, T::constant(0.0));
        if last.is_known {
            let per_step = 1.0 / self.last_step;
            if !self.correction(setting, cylinder).1 {
                let missed = mass * (of(Part::Speed) - T::constant(last.speed)) * per_step;
                corrected = corrected + T::constant(last.correction) - missed;
            }
            if load_derivative.value() == 0.0 {
                load_rate = (load - T::constant(last.load)) * per_step;
            }
        }
        let (mass_derivative, length) = (of(Part::MassDerivative), of(Part::Length));
        Element { mass, mass_derivative, load: corrected, load_derivative, load_rate, length }
    }

    /// What moves a cylinder over the next step of size h.
    fn motion(&self, setting: &Setting<'_>, cylinder: usize, h: f64) -> Result<Motion, Toggle> {
        let get = |part| setting.get(cylinder, part);
        let ([length, speed], [lower, upper]) = ([Part::Length, Part::Speed].map(get), setting.limits(cylinder));
        if get(Part::Mass) == 0.0 {
            return Ok(Motion::Given(setting.inputs.motion(&setting.laws.layout, cylinder)));
        }
        let (at_lower, at_upper) = (length <= lower + AT_LIMIT, length >= upper - AT_LIMIT);
        let push = self.force(setting.laws, cylinder, 0.0) - get(Part::Load);
        let is_stopped = |speed: f64, push: f64| speed > 0.0 || speed == 0.0 && push >= 0.0;
        let is_pushed = at_lower && is_stopped(-speed, -push) || at_upper && is_stopped(speed, push);
        if at_lower && at_upper || is_pushed {
            return Ok(Motion::Own(Drive::Held(length)));
        }
        let element = self.element(setting, cylinder, get);
        if let Some(at_end) = self.at_end(setting, cylinder, &element)
            && at_end.rests
        {
            return Ok(Motion::Own(Drive::End(Rest { element, end: at_end.end, settling: at_end.settling.max(h) })));
        }
        let force = self.force(setting.laws, cylinder, speed);
        let acceleration = element.acceleration(force, [length, speed], 0.0);
        let way = (speed.abs() + 0.5 * acceleration.abs() * h) * h;
        // Not comparisons the other way round: NaN is no motion.
        let is_fit = (element.mass_derivative * way).abs() <= MASS_CHANGE * element.mass
            && acceleration.abs() <= MOST_ACCELERATION;
        if is_fit { Ok(Motion::Own(Drive::Element(element))) } else { Err(Toggle(cylinder)) }
    }

    /// The motion with one element at each cylinder whose mass is known over a step of size h [s] from here. Nothing
    /// changes but `into`.
    pub fn foresee(&self, setting: &Setting<'_>, h: f64, into: &mut Foreseen) {
        (into.h, into.toggle, into.error, into.reached) = (h, None, None, 0.0);
        into.motions = setting.given();
        for cylinder in 0..setting.laws.layout.cylinders {
            match self.motion(setting, cylinder, h) {
                Ok(motion) => into.motions[cylinder] = motion,
                Err(toggle) => into.toggle = Some(toggle),
            }
            into.corrections[cylinder] = self.correction(setting, cylinder).0;
        }
        into.end.copy_from_slice(&self.y);
        begin(setting, &mut into.end);
        let met_ends = self.begin_at_ends(setting, &into.motions, &mut into.end);
        into.memory.copy_from(&self.memory);
        into.memory.branch_off();
        let mut job = Job { met_ends, ..setting.job(into.motions) };
        match job.advance(&mut into.memory, &mut into.end, h) {
            Ok(reached) => into.reached = reached,
            Err(error) => into.error = Some(error),
        }
        (into.end_motions, into.met_ends) = (job.motions, job.met_ends);
    }

    /// The first event within a step of size h, and its time [s], by the foreseen motion or, if the step `follows`, by
    /// those of the inputs, in `work`; none if the motion of the step is not found.
    #[cold]
    pub fn first_event(
        &self,
        setting: &Setting<'_>,
        (h, follows): (f64, bool),
        work: &mut Foreseen,
    ) -> Option<(f64, usize)> {
        work.motions = setting.given();
        if !follows {
            for cylinder in 0..setting.laws.layout.cylinders {
                if let Ok(motion) = self.motion(setting, cylinder, h) {
                    work.motions[cylinder] = motion;
                }
            }
        }
        self.check_lengths(setting, h, &work.motions).ok()?;
        work.h = f64::NAN;
        work.end.copy_from_slice(&self.y);
        begin(setting, &mut work.end);
        self.begin_at_ends(setting, &work.motions, &mut work.end);
        work.memory.copy_from(&self.memory);
        work.memory.branch_off();
        let mut job = setting.job(work.motions);
        job.watched = Some(&self.locks);
        let reached = job.advance(&mut work.memory, &mut work.end, h).ok()?;
        job.event.map(|event| (reached, event))
    }

    /// Derivative of the foreseen motion along a direction: of the state at the end of a step of size h. `change`: of
    /// the present state; `inputs`: of each input. None if no motion is foreseen.
    pub fn foresee_change(
        &self,
        setting: &Setting<'_>,
        foreseen: &Foreseen,
        change: &[f64],
        inputs: &[f64],
    ) -> Option<(Vec<Dual<1>>, [Drive<Dual<1>>; MOST_CYLINDERS])> {
        let layout = &setting.laws.layout;
        let mut drives = [Drive::Held(Dual::constant(0.0)); MOST_CYLINDERS];
        let (mut start, mut change) = (self.y.clone(), change.to_vec());
        begin(setting, &mut start);
        for (cylinder, drive) in drives.iter_mut().enumerate().take(layout.cylinders) {
            let of = |part| {
                let slope = inputs[layout.of_cylinder(cylinder, part)];
                Dual { value: setting.get(cylinder, part), slope: [slope] }
            };
            *drive = match foreseen.motions[cylinder] {
                Motion::Given(_) => Drive::Given([of(Part::Length), of(Part::Speed)]),
                Motion::Own(Drive::Element(_)) => Drive::Element(self.element(setting, cylinder, of)),
                Motion::Own(Drive::End(rest)) => {
                    let element = self.element(setting, cylinder, of);
                    Drive::End(Rest { element, end: rest.end, settling: rest.settling })
                }
                Motion::Own(_) => Drive::Held(of(Part::Length)),
            };
            let own = layout.motion(cylinder);
            (change[own], change[own + 1]) = (of(Part::Length).slope[0], of(Part::Speed).slope[0]);
            if let Some(at_end) = self.moved_at_end(setting, cylinder, foreseen.motions[cylinder]) {
                let begun = at_end.begin(of(Part::Mass), [of(Part::Length), of(Part::Speed)]);
                for (at, begun) in
                    [own, own + 1, layout.impulse(cylinder), layout.impulse(cylinder) + 1].into_iter().zip(begun)
                {
                    (start[at], change[at]) = (begun.value, begun.slope[0]);
                }
            }
        }
        let ports = &inputs[..layout.flow_inputs()];
        let end = setting.job(foreseen.motions).advance_change(&start, (&change, ports), drives, foreseen.h)?;
        Some((end, drives))
    }

    /// A step by the foreseen motion, whose memory is then of no use. Returns the time reached.
    pub fn keep(&mut self, setting: &Setting<'_>, foreseen: &mut Foreseen) -> f64 {
        self.take_motion(setting.laws, setting.inputs);
        if foreseen.met_ends != 0 {
            self.jump_to_ends(setting, &foreseen.motions);
        }
        self.y.copy_from_slice(&foreseen.end);
        std::mem::swap(&mut self.memory, &mut foreseen.memory);
        foreseen.reached
    }

    /// A step of size h [s] under the motions of the inputs, in `work`; nothing else changes on an error. Returns the
    /// time reached.
    ///
    /// # Errors
    /// No motion was found, or a cylinder does not have a length on the way.
    pub fn follow(&mut self, setting: &Setting<'_>, h: f64, work: &mut Foreseen) -> Result<f64, HydraulicsError> {
        work.h = f64::NAN;
        let motions = setting.given();
        self.check_lengths(setting, h, &motions)?;
        work.end.copy_from_slice(&self.y);
        begin(setting, &mut work.end);
        work.memory.copy_from(&self.memory);
        let reached = setting.job(motions).advance(&mut work.memory, &mut work.end, h)?;
        self.take_motion(setting.laws, setting.inputs);
        self.y.copy_from_slice(&work.end);
        std::mem::swap(&mut self.memory, &mut work.memory);
        Ok(reached)
    }

    /// A step of size h is done: locks, time, and what the step leaves to the next. `speeds`: of all cylinders at the
    /// end of the motion that was foreseen, if it was. `switches`: whether locks release and engage; else that is an
    /// event of the host.
    pub fn arrive(&mut self, setting: &Setting<'_>, h: f64, foreseen: Option<&Predicted>, switches: bool) {
        for (cylinder, last) in self.last.iter_mut().enumerate() {
            let (known, get) = (foreseen.and_then(|one| one.of[cylinder]), |part| setting.get(cylinder, part));
            let (speed, correction) = known.unwrap_or_default();
            *last = Last {
                is_known: known.is_some(),
                start_speed: get(Part::Speed),
                speed,
                correction,
                load: get(Part::Load),
                way: (self.y[setting.laws.layout.motion(cylinder)] - get(Part::Length))
                    .abs()
                    .max((get(Part::Speed) * h).abs()),
                rested: foreseen.and_then(|one| one.rested[cylinder]),
            };
        }
        if switches {
            self.switch_locks(setting.laws, 0.0);
        }
        self.last_step = h;
        // Two-sum, so that many short steps do not lose the time.
        let [time, lost] = self.time;
        let delta = h + lost;
        let sum = time + delta;
        self.time = [sum, delta - (sum - time)];
    }

    /// Locks release and engage by their pressures. `near`: distance from the pressure of the change at which a lock
    /// changes too, as a part of this pressure.
    pub fn switch_locks(&mut self, laws: &Laws, near: f64) {
        for (lock, engaged) in laws.locks.iter().zip(&mut self.locks) {
            let (p, near) = (self.y[lock.at], near * lock.release);
            *engaged = lock.holds(*engaged, if *engaged { p + near } else { p - near });
        }
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.all_finite("time", &mut self.time)?;
        record.length("components of the state", self.y.len())?;
        record.all_finite("state of the network", &mut self.y)?;
        self.memory.record(record)?;
        record.finite("volume at the start", &mut self.start_volume)?;
        record.number("size of the last step", &mut self.last_step, |h| h >= 0.0 && h.is_finite(), "a number >= 0")?;
        for last in &mut self.last {
            record.flag("last step", &mut last.is_known)?;
            record.finite("speed at the start of the last step", &mut last.start_speed)?;
            record.finite("predicted speed", &mut last.speed)?;
            record.finite("correction of the load", &mut last.correction)?;
            record.finite("load at the start of the last step", &mut last.load)?;
            last.record_end(record)?;
        }
        if self.last_step == 0.0 && self.last.iter().any(|last| last.is_known) {
            return Err(Damaged("a motion is predicted before the first step".to_owned()));
        }
        self.locks.iter_mut().try_for_each(|lock| record.flag("lock", lock))
    }
}

/// The state at the beginning of a step: lengths and speeds of the inputs, impulses and moments from 0.
fn begin(setting: &Setting<'_>, y: &mut [f64]) {
    let layout = &setting.laws.layout;
    for cylinder in 0..layout.cylinders {
        let (own, impulse) = (layout.motion(cylinder), layout.impulse(cylinder));
        let length = layout.of_cylinder(cylinder, Part::Length);
        y[own..own + 2].copy_from_slice(&setting.inputs.values[length..length + 2]);
        y[impulse..impulse + 2].fill(0.0);
    }
}
