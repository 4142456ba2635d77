//! Steps under a prescribed motion of a drive: the state follows from the motion, and the energy balance is integrated.
//!
//! With the displacement S(sigma) of the drive and its prescribed motion s(t):
//!
//! ```text
//! S(sigma) = s, sigma_dot = s_dot / S_sigma, sigma_ddot = (s_ddot - S_sigma_sigma sigma_dot^2) / S_sigma
//! ```
//!
//! The force of the drive follows by inverse dynamics; its work less all losses is integrated over the step, so that
//! the energy balance shows what the loads, the friction and the drive do not agree in. In: a state, inputs. Out: the
//! state after the step, or why the mechanism cannot make the motion. It must not know outputs.
mod refusals;

use super::inputs::engaged_locks;
use super::{Arrival, Begin, Reached, State, shift};
use crate::mechanism::definition::Solver;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::{Change, Inputs};
use crate::mechanism::dynamics::inverse::{Demand, toward, with_efficiency};
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::dynamics::prescribed::{Prescribed, end_of};
use crate::mechanism::dynamics::state_loads::Mode;
use crate::mechanism::error::{ModelError, unit_of};
use crate::mechanism::loads::resolved::MotionDrive;
use crate::mechanism::motion::advance::Progress;
use crate::mechanism::motion::contact::{Contact, Ends, EngagedLocks};
use crate::mechanism::motion::dynamics::Dynamics;
use crate::mechanism::motion::prescribed::{PrescribedState, Track};
use crate::mechanism::motion::saved::SavedState;
use crate::mechanism::motion::witness::What;
use crate::mechanism::reduced::Reduced;
use crate::numerics::decimal::Decimal;
use crate::numerics::kronrod::{NODES, means, relative_error};

/// Part of the size of the mechanism's motion of 1 rad by which the position at a switch may differ from that of the
/// drive.
const SWITCH: f64 = 1e-6;
/// Part of what lies between two kinks below which a part of a step is not halved any more.
const SHORTEST: f64 = 1e-6;
/// Part of the work of the drive's force over the size of the mechanism's motion: what is exchanged in a part of a step
/// is judged in relation to no less, as the rounding of position and speed is not smooth.
const LEAST_WORK: f64 = 1e-6;

/// sigma, sigma_dot and sigma_ddot under a prescribed motion, with S_sigma.
#[derive(Clone, Copy)]
struct Place {
    y: [f64; 3],
    slope: f64,
}

/// A step under a prescribed motion.
struct Step<'a> {
    track: Track<'a>,
    motion: Prescribed<'a>,
    inputs: &'a Inputs,
    drive: &'a MotionDrive,
}

impl Step<'_> {
    /// The state that the motion prescribes at a time t [s], near a sigma.
    fn place(&self, t: f64, near: f64) -> Result<Place, ModelError> {
        let [position, speed, acceleration, _] = self.motion.at(t);
        if !(position.is_finite() && speed.is_finite() && acceleration.is_finite()) {
            return Err(ModelError::Overflow { name: format!("prescribed {}", self.name()) });
        }
        let (sigma, [slope, curvature]) =
            self.track.locate(near, position).map_err(|missed| self.refusal(t, position, missed))?;
        let sigma_dot = speed / slope;
        let sigma_ddot = (acceleration - curvature * sigma_dot * sigma_dot) / slope;
        Ok(Place { y: [sigma, sigma_dot, sigma_ddot], slope })
    }
}

impl State {
    /// Whether the inputs prescribe the motion of a drive.
    #[inline(always)]
    pub(super) fn is_prescribed(&self, inputs: &Inputs) -> bool {
        self.saved.prescribed.is_some() && inputs.prescribes()
    }

    /// Begin a run under the motion that the inputs prescribe, if they do: at the position that they state.
    ///
    /// # Errors
    /// [`ModelError::Prescribed`].
    pub(super) fn begin_prescribed(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<(), ModelError> {
        self.saved.prescribed = reduced.loading().motion.as_ref().map(|_| PrescribedState::default());
        if !self.is_prescribed(inputs) {
            return Ok(());
        }
        // The force of the input does not act.
        if let Some(drive) = &reduced.loading().motion {
            self.saved.applied[drive.load] = 0.0;
        }
        self.follow(reduced, inputs, EngagedLocks::default(), true)
    }

    /// Take over what the inputs prescribe, for outputs that show it.
    ///
    /// # Errors
    /// [`ModelError::Prescribed`]; nothing has changed.
    pub fn preview(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<(), ModelError> {
        let locked = engaged_locks(&self.saved.travel, reduced, &inputs.locks);
        self.follow(reduced, inputs, locked, false)
    }

    /// Take over what the inputs prescribe at the communication point: the state jumps to it.
    ///
    /// # Errors
    /// [`ModelError::Prescribed`]; nothing has changed.
    fn follow(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        locked: EngagedLocks,
        at_start: bool,
    ) -> Result<(), ModelError> {
        let (Some(drive), Some(before)) = (&reduced.loading().motion, self.saved.prescribed) else { return Ok(()) };
        let given = inputs.given(drive).unwrap_or_default();
        if before.is_active && (drive.profile.is_some() || given.map(f64::to_bits) == before.given.map(f64::to_bits)) {
            return Ok(());
        }
        let here = self.displacement(reduced, drive.load);
        let after = match before.is_active {
            true => PrescribedState { given, ..before },
            false => PrescribedState { is_active: true, origin: here, given, ..PrescribedState::default() },
        };
        let Some(motion) = Prescribed::new(drive, inputs, after.origin, after.time.parts()) else { return Ok(()) };
        let ends = &Ends::new(&self.saved.travel, shift(reduced, self.revolutions), locked);
        let track = Track { whole: reduced, load: drive.load, revolutions: self.revolutions, ends };
        let step = Step { track, motion, inputs, drive };
        let found = step.place(0.0, self.sigma)?;
        let is_begun = !before.is_active && !at_start;
        let miss = motion.at(0.0)[0] - here;
        if is_begun && miss.abs() > SWITCH * found.slope.abs() * reduced.scale() {
            let why = format!(
                "the drive is at {} {} when its prescribed motion is switched on; set {}.motion.position to this \
                 value before",
                Decimal::rounded(here),
                unit_of(&step.name()),
                reduced.loading().drives[drive.load].name
            );
            return Err(ModelError::Prescribed { name: step.name(), value: here + miss, time: 0.0, why });
        }
        step.check_locks(0.0, self.sigma, found.y[0])?;
        let mut contact = Contact::default();
        contact.set_touching(if at_start { BumperSet::EMPTY } else { self.contact.touching() });
        let (energy, before) = (self.kinetic() + self.load_potential(reduced), self.sigma_dot);
        let [sigma, sigma_dot, _] = found.y;
        let arrival = Arrival { y: [sigma, sigma_dot], lost: 0.0, contact, passed: 0.0 };
        self.arrive(reduced, &arrival)?;
        self.saved.prescribed = Some(after);
        // The jump is work of the drive.
        let work = self.kinetic() + self.load_potential(reduced) - energy;
        self.saved.reference += work;
        if is_begun && sigma_dot != before {
            let change = found.slope * (sigma_dot - before);
            self.witness.tell(0.0, What::Gripped { change, impulse: (sigma_dot - before) / found.slope });
        }
        self.right_hand_side_changed();
        Ok(())
    }

    /// The motion is no longer prescribed: the state goes on as under forces.
    pub(super) fn release_prescribed(&mut self, reduced: &Reduced, locked: EngagedLocks) {
        let Some(prescribed) = self.saved.prescribed.filter(|prescribed| prescribed.is_active) else { return };
        self.saved.prescribed = Some(PrescribedState { is_active: false, ..prescribed });
        self.memory.restart();
        let ends = Ends::new(&self.saved.travel, shift(reduced, self.revolutions), locked);
        let resting = ends.at(self.sigma).next().filter(|_| self.sigma_dot == 0.0);
        if let Some(place) = resting {
            let is_locked = ends.is_locked(place);
            self.saved.contact.rests(place, is_locked);
        }
    }

    /// [`State::step`] under a prescribed motion.
    ///
    /// # Errors
    /// [`ModelError::Prescribed`], or as [`State::step`]; the state is what it was.
    #[cold]
    #[inline(never)]
    pub(super) fn step_prescribed(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        h: f64,
        solver: &Solver,
    ) -> Result<Reached, ModelError> {
        let SavedState { sigma, sigma_dot, revolutions, contact, reference, prescribed, .. } = self.saved;
        let in_force = self.in_force.filter(|_| !inputs.signal.ahead);
        let locked = match in_force {
            Some(locked) => locked,
            None => self.apply(reduced, inputs, h)?,
        };
        let begin = Begin { revolutions: self.revolutions, tried: self.memory.tried() };
        let made = self.follow(reduced, inputs, locked, false).and_then(|()| {
            let mut arrival =
                Arrival { y: [self.sigma, self.sigma_dot], lost: 0.0, contact: self.contact, passed: 0.0 };
            let (progress, is_spent) = self.advance_prescribed(reduced, (inputs, locked), h, solver, &mut arrival)?;
            self.arrive(reduced, &arrival)?;
            let time = progress.t;
            if let Some(prescribed) = &mut self.saved.prescribed {
                prescribed.time.pass(time);
                if let Some(drive) = &reduced.loading().motion
                    && let Some(given) = inputs.given(drive)
                {
                    prescribed.given = end_of(given, time);
                }
            }
            match is_spent {
                true => Err(self.interrupted(&begin, &progress, h, solver)),
                false if time < h => Ok(Reached::Pause(time)),
                false => Ok(Reached::End),
            }
        });
        if let Err(error) = &made
            && !matches!(error, ModelError::Interrupted { .. })
        {
            self.undo(reduced, in_force.is_none());
            let saved = &mut self.saved;
            (saved.sigma, saved.sigma_dot, saved.revolutions) = (sigma, sigma_dot, revolutions);
            (saved.contact, saved.reference, saved.prescribed) = (contact, reference, prescribed);
        }
        made
    }
    /// Advance by `h` [s], or as far as the bound on the work or a pause allows, which the progress tells. Returns
    /// whether the bound was met.
    fn advance_prescribed(
        &mut self,
        reduced: &Reduced,
        (inputs, locked): (&Inputs, EngagedLocks),
        h: f64,
        solver: &Solver,
        arrival: &mut Arrival,
    ) -> Result<(Progress, bool), ModelError> {
        let attempts = self.memory.tried().iter().sum::<u64>();
        let mut progress = Progress::within(attempts + solver.most_steps());
        let (Some(drive), Some(prescribed)) = (&reduced.loading().motion, self.saved.prescribed) else {
            return Ok((progress, false));
        };
        let Some(motion) = Prescribed::new(drive, inputs, prescribed.origin, prescribed.time.parts()) else {
            return Ok((progress, false));
        };
        let pauses = self.witness.pauses.at_steps;
        let Self { saved, scratch, rates, .. } = self;
        let ends = &Ends::new(&saved.travel, shift(reduced, saved.revolutions), locked);
        let track = Track { whole: reduced, load: drive.load, revolutions: saved.revolutions, ends };
        let step = Step { track, motion, inputs, drive };
        let SavedState { applied: sizes, airspeed, air, revolutions, .. } = &*saved;
        let (airspeed, air, revolutions, touching) = (*airspeed, *air, *revolutions, arrival.contact.touching());
        let mut balance =
            Balance { step: &step, sizes, airspeed, air, revolutions, scratch, rates, touching, largest: 0.0 };
        balance.begin();
        let (mut width, mut sigma) = (h, arrival.y[0]);
        // Where the present piece between two kinks begins, and where it ends.
        let (mut begun, mut kink) = (0.0, 0.0);
        while progress.t < h {
            if progress.work.is_spent(attempts) {
                balance.scratch.panel_force.invalidate();
                return Ok((progress, true));
            }
            progress.work.extra += 1;
            let t = progress.t;
            let end = motion.next_kink(t, h);
            if t >= kink {
                begun = t;
            }
            kink = end;
            let to = if t + width < end { t + width } else { end };
            let mut near = sigma;
            let mut places = [None; NODES.len()];
            for (place, u) in places.iter_mut().zip(NODES) {
                let found = step.place(t + u * (to - t), near)?;
                near = found.y[0];
                *place = Some(found);
            }
            let last = step.place(to, near)?;
            step.check_locks(to, sigma, last.y[0])?;
            let mut values = [0.0; NODES.len()];
            for ((value, place), u) in values.iter_mut().zip(places.into_iter().flatten()).zip(NODES) {
                *value = balance.lost(t + u * (to - t), &place)?;
            }
            let means = means(&values);
            let energy = (0.5 * last.y[1] * last.y[1]).max(LEAST_WORK * balance.largest * reduced.scale());
            let is_rough = relative_error(means, energy / (to - t)) > solver.tolerance;
            if is_rough && to - t > SHORTEST * (end - begun) {
                width = 0.5 * (to - t);
                continue;
            }
            arrival.lost += means[0] * (to - t);
            // A table that begins at a speed: the drive gives it at once, which is work.
            if last.y[1] != 0.0 && places.iter().flatten().all(|place| place.y[1] == 0.0) {
                arrival.lost -= 0.5 * last.y[1] * last.y[1];
            }
            arrival.y = [last.y[0], last.y[1]];
            (sigma, width, progress.t) = (last.y[0], 2.0 * (to - t).max(width), to);
            balance.touch(&last);
            arrival.contact.set_touching(balance.touching);
            if pauses && to < h {
                break;
            }
        }
        balance.scratch.panel_force.invalidate();
        Ok((progress, false))
    }
}

/// The energy balance of a step under a prescribed motion.
struct Balance<'a, 's> {
    step: &'a Step<'a>,
    sizes: &'a [f64],
    airspeed: f64,
    air: bool,
    revolutions: f64,
    scratch: &'s mut Scratch,
    /// Excess of the sizes of the loads over those at the beginning of the step, then as many zeros.
    rates: &'s mut Vec<f64>,
    touching: BumperSet,
    /// Largest generalised force of the drive in the step.
    largest: f64,
}

impl Balance<'_, '_> {
    /// Begin a step: the drive is the only load that changes, unless others have input derivatives.
    fn begin(&mut self) {
        self.scratch.panel_force.invalidate();
        self.rates.fill(0.0);
        self.rates[self.step.drive.load] = 1.0;
    }

    /// The equation of motion at a sigma and the time t [s], with a size of the drive's force.
    fn equation(&mut self, sigma: f64, t: f64, force: f64) -> EquationOfMotion<'_> {
        let Self { step, sizes, airspeed, air, revolutions, .. } = *self;
        let (whole, inputs, load) = (step.track.whole, step.inputs, step.drive.load);
        let loads = whole.loading().inputs.len();
        let mut time = force;
        let mut air_excess = 0.0;
        if let Some(change) = inputs.change(whole) {
            let excess = |[first, second]: [f64; 2]| t * (first + 0.5 * t * second);
            for (rate, (&first, &second)) in self.rates.iter_mut().zip(change.first.iter().zip(change.second)) {
                *rate = excess([first, second]);
            }
            (self.rates[load], time, air_excess) = (force, 1.0, excess(change.airspeed));
            self.scratch.panel_force.invalidate();
        }
        let (within, _) = whole.unwound(sigma);
        let (reduced, state_loads) = whole.with_state_loads(within, air);
        self.scratch.panel_force.on_stretch(reduced.stretch);
        let (first, second) = self.rates.split_at(loads);
        let change = Some(Change { first, second, airspeed: [air_excess, 0.0] });
        let applied = AppliedLoads { sizes, airspeed, revolutions, change };
        let mode = Mode { touching: self.touching, ..Mode::default() };
        let (scratch, locked, ports) = (&mut *self.scratch, false, None);
        EquationOfMotion { whole, reduced, state_loads, applied, time, mode, scratch, locked, ports }
    }

    /// The bumpers that push.
    fn touch(&mut self, place: &Place) {
        let [sigma, sigma_dot, _] = place.y;
        let count = self.step.track.ends.bumpers();
        if count == 0 {
            return;
        }
        let mut equation = self.equation(sigma, 0.0, 0.0);
        self.touching = BumperSet::of(count, |bumper| {
            let (beyond, push) = Dynamics::<3>::bumper_push(&mut equation, bumper, sigma, sigma_dot);
            beyond > 0.0 && push > 0.0
        });
    }

    /// Power that leaves the mechanism at a time t [s] of the step, less that of the drive [W].
    fn lost(&mut self, t: f64, place: &Place) -> Result<f64, ModelError> {
        let [sigma, sigma_dot, acceleration] = place.y;
        if sigma_dot == 0.0 {
            return Ok(0.0);
        }
        self.touch(place);
        let (step, slope) = (self.step, place.slope);
        let direction = toward(sigma_dot, acceleration);
        let demand = Demand { drive: (step.drive.load, slope), acceleration, direction, breakaway: None };
        let force = self.equation(sigma, t, 0.0).required(sigma, sigma_dot, &demand);
        let generalised = force.map_err(|_| self.locked(t, sigma))?;
        self.largest = self.largest.max(generalised.abs());
        let force = generalised / slope;
        let efficiency = step.track.whole.loading().drives[step.drive.load].efficiency;
        let force = with_efficiency(efficiency, force * sigma_dot * slope, force);
        let mut equation = self.equation(sigma, t, force);
        equation.clear_regimes();
        equation.mode.direction = direction;
        let lost = equation.effect(sigma, sigma_dot).map(|evaluation| evaluation.lost);
        match lost {
            Ok(lost) if lost.is_finite() => Ok(lost),
            Ok(_) => Err(ModelError::Overflow { name: "the power of the prescribed motion".into() }),
            Err(_) => Err(self.locked(t, sigma)),
        }
    }

    /// The error of a motion that friction locks.
    #[cold]
    fn locked(&self, time: f64, sigma: f64) -> ModelError {
        let whole = self.step.track.whole;
        let (within, _) = whole.unwound(sigma);
        let why = format!(
            "friction locks the mechanism against the drive there, mainly in {}; reduce the coefficients or pin \
             radii, or end the motion before this position",
            whole.locking_joint(within)
        );
        let [value, ..] = self.step.motion.at(time);
        ModelError::Prescribed { name: self.step.name(), value, time, why }
    }
}
