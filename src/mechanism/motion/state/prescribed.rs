//! Steps under a prescribed motion of a drive: the state follows from the motion, and the energy balance is integrated.
//!
//! With the displacement S(sigma) of the drive and its prescribed motion s(t):
//!
//! ```text
//! S(sigma) = s, sigma_dot = s_dot / S_sigma, sigma_ddot = (s_ddot - S_sigma_sigma sigma_dot^2) / S_sigma
//! ```
//!
//! The force of the drive follows by inverse dynamics; its work less all losses is integrated, so that the energy
//! balance shows what the loads, the friction and the drive do not agree in. As the motion is known in advance, the
//! integral is taken over a time that goes on beyond the step, and later steps within this time read their part of it.
//! In: a state, inputs. Out: the state after the step, or why the mechanism cannot make the motion. It must not know
//! outputs.
mod balance;
mod refusals;

use super::inputs::engaged_locks;
use super::{Arrival, Begin, Reached, State, shift};
use crate::mechanism::definition::Solver;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::prescribed::{Prescribed, end_of};
use crate::mechanism::error::{ModelError, unit_of};
use crate::mechanism::loads::resolved::MotionDrive;
use crate::mechanism::motion::advance::Progress;
use crate::mechanism::motion::contact::{Ends, EngagedLocks};
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::prescribed::{PrescribedState, Track};
use crate::mechanism::motion::saved::{Applied, SavedState};
use crate::mechanism::motion::step_ahead::Outdated;
use crate::mechanism::motion::witness::What;
use crate::mechanism::reduced::Reduced;
use crate::numerics::decimal::Decimal;
use balance::{Balance, Found};
use refusals::{Cause, Trouble};

/// Part of the size of the mechanism's motion of 1 rad by which the position at a switch may differ from that of the
/// drive.
const SWITCH: f64 = 1e-6;
/// Part of what lies between two kinks below which a part of a step is not halved any more.
const SHORTEST: f64 = 1e-6;
/// Relative error of the energy over a time that goes on beyond the step, as estimated: the energy in a part of this
/// time is then exact to 1e-12.
const AHEAD: f64 = 1e-11;
/// Least length of such a time, in rests of the step.
const LONG: f64 = 2.0;
/// Largest length of such a time without masses, in steps: no power bounds it, and far positions take long to find.
const FARTHEST: f64 = 64.0;
/// Part of a step by which its end may be missed by rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// sigma, sigma_dot and sigma_ddot under a prescribed motion, with S_sigma.
#[derive(Clone, Copy, Default)]
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
    fn place(&self, t: f64, near: f64) -> Result<Place, Trouble> {
        let [position, speed, acceleration, _] = self.motion.at(t);
        let trouble = |cause| Trouble { time: t, cause };
        if !(position.is_finite() && speed.is_finite() && acceleration.is_finite()) {
            return Err(trouble(Cause::Motion));
        }
        let located = self.track.locate(near, position);
        let (sigma, [slope, curvature]) = located.map_err(|missed| trouble(Cause::Missed(position, missed)))?;
        let sigma_dot = speed / slope;
        let sigma_ddot = (acceleration - curvature * sigma_dot * sigma_dot) / slope;
        Ok(Place { y: [sigma, sigma_dot, sigma_ddot], slope })
    }

    /// (sigma, sigma_dot) that the motion prescribes at a time t [s], on from those before by a time `h` [s] over which
    /// the power is known; none where it takes more than one evaluation.
    #[inline]
    fn place_ahead(&self, t: f64, [sigma, sigma_dot]: [f64; 2], h: f64) -> Option<[f64; 2]> {
        let [position, speed, ..] = self.motion.at(t);
        let (sigma, slope) = self.track.continued(sigma, h * sigma_dot, position)?;
        let sigma_dot = speed / slope;
        sigma_dot.is_finite().then_some([sigma, sigma_dot])
    }
}

/// Factor by which the next time may be longer, for an estimated error in relation to what is allowed: the estimate
/// grows with the ninth power of the time.
fn growth(error: f64) -> f64 {
    [4.0_f64, 2.0, 1.25].into_iter().find(|factor| error * factor.powi(9) < 0.5).unwrap_or(1.0)
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
        self.saved.prescribed = reduced.can_prescribe().then(PrescribedState::default);
        if !self.is_prescribed(inputs) {
            return Ok(());
        }
        // The force of the input does not act.
        if let Some(drive) = &reduced.loading().motion {
            self.saved.applied.sizes[drive.load] = 0.0;
        }
        self.follow(reduced, inputs, EngagedLocks::default(), true)
    }

    /// The host states the time since the motion is prescribed [s].
    pub fn set_time(&mut self, since: f64) {
        if let Some(prescribed) = &mut self.saved.prescribed {
            (prescribed.has_host_time, prescribed.time) = (true, Elapsed::at(since));
            self.saved.applied.version = 0;
        }
    }

    /// Take over what the inputs prescribe: for outputs that show it, and for a solver of the host.
    ///
    /// # Errors
    /// [`ModelError::Prescribed`]; nothing has changed.
    pub fn preview(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<(), ModelError> {
        let locks = (&*inputs.locks, self.saved.contact.engaged());
        let locked = engaged_locks(&self.saved.travel, reduced, locks, self.saved.memory.network_values());
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
        let is_placed = match drive.profile {
            Some(_) => !before.has_host_time,
            None => given.map(f64::to_bits) == before.given.map(f64::to_bits),
        };
        if before.is_active && is_placed {
            return Ok(());
        }
        let here = self.displacement(reduced, drive.load);
        let after = match before.is_active {
            true => PrescribedState { given, ahead: None, ..before },
            false => {
                let has_host_time = before.has_host_time;
                PrescribedState { is_active: true, has_host_time, origin: here, given, ..PrescribedState::default() }
            }
        };
        let Some(motion) = Prescribed::new(drive, inputs, after.origin, after.time.parts()) else { return Ok(()) };
        let Self { saved, scratch, rates, .. } = &mut *self;
        let (Applied { sizes, airspeed, air, .. }, revolutions) = (&saved.applied, saved.revolutions);
        let (airspeed, air, touching) = (*airspeed, *air, BumperSet::EMPTY);
        let ends = &Ends::new(&saved.travel, shift(reduced, revolutions), locked);
        let track = Track { whole: reduced, load: drive.load, revolutions, ends, panel: scratch.panel_force.panel() };
        let step = Step { track, motion, inputs, drive };
        let found = step.place(0.0, saved.sigma).map_err(|trouble| step.error(trouble))?;
        let is_begun = !before.is_active && !at_start;
        let miss = motion.at(0.0)[0] - here;
        if is_begun && miss.abs() > SWITCH * found.slope.abs() * reduced.scale() {
            let why = format!(
                "the drive is at {} {} when its prescribed motion is switched on; before that, set \
                 {}.motion.position to this value",
                Decimal::rounded(here),
                unit_of(&step.name()),
                reduced.loading().drives[drive.load].name
            );
            return Err(ModelError::Prescribed { name: step.name(), value: here + miss, time: 0.0, why });
        }
        step.check_locks(0.0, saved.sigma, found.y[0])?;
        let [sigma, sigma_dot, _] = found.y;
        let mut contact = saved.contact.freed();
        if ends.bumpers() > 0 {
            let mut balance =
                Balance { step: &step, sizes, airspeed, air, revolutions, scratch, rates, touching, largest: 0.0 };
            balance.begin();
            balance.touch([sigma, sigma_dot]);
            contact.set_touching(balance.touching);
        }
        let (energy, before) =
            (self.kinetic() + self.load_potential(reduced, |load| self.displacement(reduced, load)), self.sigma_dot);
        let arrival = Arrival { y: [sigma, sigma_dot], lost: 0.0, contact, passed: 0.0 };
        self.arrive(reduced, &arrival)?;
        self.saved.prescribed = Some(after);
        // The jump is work of the drive.
        let work = self.kinetic() + self.load_potential(reduced, |load| self.displacement(reduced, load)) - energy;
        self.saved.reference += work;
        if is_begun && sigma_dot != before {
            let change = found.slope * (sigma_dot - before);
            self.witness.tell(0.0, What::Gripped { change, impulse: (sigma_dot - before) / found.slope });
        }
        self.memory.drop_outdated(Outdated::Law);
        Ok(())
    }

    /// The motion is no longer prescribed: the state goes on as under forces.
    pub fn release(&mut self, reduced: &Reduced, inputs: &Inputs) {
        let locks = (&*inputs.locks, self.saved.contact.engaged());
        let locked = engaged_locks(&self.saved.travel, reduced, locks, self.saved.memory.network_values());
        self.release_prescribed(reduced, locked);
    }

    /// [`Self::release`] with these locks engaged.
    pub(super) fn release_prescribed(&mut self, reduced: &Reduced, locked: EngagedLocks) {
        let Some(prescribed) = self.saved.prescribed.filter(|prescribed| prescribed.is_active) else { return };
        self.saved.prescribed = Some(PrescribedState { is_active: false, ahead: None, ..prescribed });
        self.memory.drop_outdated(Outdated::State);
        let ends = Ends::new(&self.saved.travel, shift(reduced, self.revolutions), locked);
        let resting = ends.at(self.sigma).next().filter(|_| self.sigma_dot == 0.0);
        if let Some(place) = resting {
            let is_locked = ends.is_fast(place);
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
        if self.step_within(reduced, inputs, h) {
            return Ok(Reached::End);
        }
        if reduced.loading().motion.is_none() {
            return Err(ModelError::massless(reduced.linkage()));
        }
        let SavedState { sigma, sigma_dot, revolutions, contact, reference, prescribed, .. } = *self.saved;
        let is_new = !self.applied.are_in_force(inputs);
        if is_new {
            self.apply(reduced, inputs, h)?;
        }
        let locked = self.applied.locked;
        self.saved.contact.forget_released(locked);
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
            self.undo(reduced, is_new);
            let saved = &mut self.saved;
            (saved.sigma, saved.sigma_dot, saved.revolutions) = (sigma, sigma_dot, revolutions);
            (saved.contact, saved.reference, saved.prescribed) = (contact, reference, prescribed);
        }
        made
    }

    /// A step that ends within the time over which the power is known: all that is to be found is where the mechanism
    /// then is. Returns whether it has been made; if not, nothing has changed. The result is that of
    /// [`Self::advance_prescribed`].
    #[inline]
    fn step_within(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64) -> bool {
        let Some(drive) = reduced.loading().motion.as_ref().filter(|_| self.applied.are_in_force(inputs)) else {
            return false;
        };
        let locked = self.applied.locked;
        let Some(PrescribedState { origin, time, ahead: Some(power), .. }) = &self.saved.prescribed else {
            return false;
        };
        let Some(motion) = Prescribed::new(drive, inputs, *origin, time.parts()) else { return false };
        let ends = &Ends::new(&self.saved.travel, shift(reduced, self.revolutions), locked);
        if h >= power.rest() || power.is_at_rest || locked != EngagedLocks::default() || ends.bumpers() > 0 {
            return false;
        }
        let panel = self.scratch.panel_force.panel();
        let track = Track { whole: reduced, load: drive.load, revolutions: self.revolutions, ends, panel };
        let step = Step { track, motion, inputs, drive };
        let Some(y) = step.place_ahead(h, [self.sigma, self.sigma_dot], h) else { return false };
        let [now, lost] = power.after(h);
        if self.arrive_at(reduced, y, lost, 0.0).is_err() {
            return false;
        }
        if let Some(PrescribedState { time, given: placed, ahead: Some(power), .. }) = &mut self.saved.prescribed {
            time.pass(h);
            power.now = now;
            if let Some(given) = inputs.given(drive) {
                *placed = end_of(given, h);
            }
        }
        true
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
        let saved = &mut **saved;
        let ends = &Ends::new(&saved.travel, shift(reduced, saved.revolutions), locked);
        let panel = scratch.panel_force.panel();
        let track = Track { whole: reduced, load: drive.load, revolutions: saved.revolutions, ends, panel };
        let step = Step { track, motion, inputs, drive };
        let (Applied { sizes, airspeed, air, .. }, revolutions) = (&saved.applied, saved.revolutions);
        let (airspeed, air, touching) = (*airspeed, *air, arrival.contact.touching());
        let mut balance =
            Balance { step: &step, sizes, airspeed, air, revolutions, scratch, rates, touching, largest: 0.0 };
        let mut ahead = prescribed.ahead;
        // Length of a part of the step, and of a time beyond it.
        let (mut width, mut reach) = (h, ahead.map_or(0.0, |power| power.next));
        let mut sigma = arrival.y[0];
        // Where the present piece between two kinks begins, and where it ends within the step.
        let (mut begun, mut kink) = (0.0, 0.0);
        let mut is_spent = false;
        while progress.t < h {
            let t = progress.t;
            let (mut power, near) = match ahead.filter(|power| power.rest() > 0.0) {
                Some(power) => (power, None),
                None => {
                    is_spent = progress.work.is_spent(attempts);
                    if is_spent {
                        break;
                    }
                    progress.work.extra += 1;
                    let end = motion.next_kink(t, h);
                    if t >= kink {
                        begun = t;
                    }
                    kink = end;
                    let may_pass = end == h && !inputs.signal.ahead && reach >= LONG * (h - t);
                    let to = match t + width {
                        _ if may_pass => motion.next_kink(t, t + reach),
                        to if to < end => to,
                        _ => end,
                    };
                    let found = match balance.power([t, to], h, sigma) {
                        Ok(found) => found,
                        // What cannot be made beyond the step need not be made.
                        Err(_) if may_pass => {
                            reach = 0.0;
                            continue;
                        }
                        Err(trouble) => return Err(step.error(trouble)),
                    };
                    let Found { mut power, error, near } = found;
                    let allowed = AHEAD.min(solver.tolerance);
                    if may_pass && error > allowed {
                        reach = 0.5 * (to - t);
                        continue;
                    }
                    if !may_pass {
                        if error > solver.tolerance && to - t > SHORTEST * (end - begun) {
                            width = 0.5 * (to - t);
                            continue;
                        }
                        width = 2.0 * (to - t).max(width);
                    }
                    if error <= allowed {
                        reach = reach.max((to - t) * growth(error / allowed));
                        if reduced.linkage().is_massless {
                            reach = reach.min(FARTHEST * h);
                        }
                    }
                    power.next = reach;
                    (power, Some(near))
                }
            };
            let to = t + power.rest();
            let to = if h - to > ROUNDING * h { to } else { h };
            let known = near.is_none().then(|| step.place_ahead(to, arrival.y, to - t)).flatten();
            let last = match known {
                Some(y) => y,
                None => {
                    let place = step.place(to, near.unwrap_or(sigma)).map_err(|trouble| step.error(trouble))?;
                    [place.y[0], place.y[1]]
                }
            };
            step.check_locks(to, sigma, last[0])?;
            arrival.lost += power.read(to - t);
            ahead = Some(power);
            // A table that begins at a speed: the drive gives it at once, which is work.
            if last[1] != 0.0 && power.is_at_rest {
                arrival.lost -= 0.5 * last[1] * last[1];
                ahead = None;
            }
            arrival.y = last;
            (sigma, progress.t) = (last[0], to);
            if ends.bumpers() > 0 {
                balance.begin();
                balance.touch(last);
                arrival.contact.set_touching(balance.touching);
            }
            if pauses && to < h {
                break;
            }
        }
        if let Some(prescribed) = &mut saved.prescribed {
            prescribed.ahead = ahead;
        }
        Ok((progress, is_spent))
    }
}
