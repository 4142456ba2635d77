//! The state of motion and its steps.
//!
//! In: a start, inputs, a reduced model. Out: the state after each step, on an error the state before it. It must not
//! know outputs.
mod arrival;
mod circuit;
mod energy;
mod inputs;
mod jump;
mod ports;
mod prescribed;
mod start;

use crate::mechanism::definition::Solver;
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::acting::{blows_under, state_loads};
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::coasting::{Coasting, Path};
use crate::mechanism::motion::contact::{Contact, Ends, EngagedLocks};
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::hydraulic_motion::Driven;
use crate::mechanism::motion::memory::Memory;
use crate::mechanism::motion::saved::{Applied, SavedState};
use crate::mechanism::motion::step_ahead::Outdated;
use crate::mechanism::motion::travel::AT_STOP;
use crate::mechanism::motion::witness::{What, Witness};
use crate::mechanism::reduced::{End, Reduced, StateLoads};
use arrival::{Arrival, Begin};
pub use circuit::{allow_hydraulics, check_length};
use circuit::{at_vacuum, rough_length};
pub use inputs::engages;
use inputs::{Before, engaged_locks};
pub use start::Start;
use std::ops::{Deref, DerefMut};

/// The state of motion, with the memory of the integration.
#[derive(Clone, Debug)]
pub struct State {
    /// The part that decides how the state continues.
    saved: Counted,
    /// What the last inputs have replaced, for a step that fails.
    before: Before,
    /// Right-hand side for the applied sizes, for the integration.
    scratch: Scratch,
    /// What happens within a step.
    pub witness: Witness,
    /// Scratch of a step under a prescribed motion; empty where no drive has a motion.
    rates: Vec<f64>,
    /// Whether laws are others than those of the last step.
    pub is_retuned: bool,
}

impl Deref for State {
    type Target = SavedState;

    #[inline(always)]
    fn deref(&self) -> &SavedState {
        &self.saved
    }
}

impl DerefMut for State {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut SavedState {
        &mut self.saved
    }
}

/// A saved state, with the number of accesses to change it.
#[derive(Clone, Debug, Default)]
struct Counted {
    saved: SavedState,
    accesses: u64,
}

impl Deref for Counted {
    type Target = SavedState;

    #[inline(always)]
    fn deref(&self) -> &SavedState {
        &self.saved
    }
}

impl DerefMut for Counted {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut SavedState {
        self.accesses += 1;
        &mut self.saved
    }
}

/// Where a step has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached {
    /// At its end.
    End,
    /// At an event, which is to be handled, so long after its beginning [s].
    Event(f64),
    /// After an internal step, so long after its beginning [s].
    Pause(f64),
}

impl Reached {
    /// Time from the beginning of a step of `h` [s] to where it has ended [s].
    pub fn time(self, h: f64) -> f64 {
        match self {
            Self::End => h,
            Self::Event(time) | Self::Pause(time) => time,
        }
    }
}

/// Locks are engaged or not as the ends tell, from a time t of the step [s] on; where the mechanism rests, a lock
/// catches it or lets it go.
#[inline(always)]
fn set_locks(contact: &mut Contact, ends: &Ends, t: f64, witness: &mut Witness) {
    let was_latched = contact.is_latched();
    contact.locks_set(ends);
    if contact.is_latched() != was_latched
        && let Some((stop, _)) = contact.at_rest().and_then(|place| ends.travel.stop(place))
    {
        witness.tell(t, if was_latched { What::LetGo { stop } } else { What::Caught { stop } });
    }
}

/// Whether a load of these sizes or a spring does work over a whole revolution of a closed curve.
fn does_work(reduced: &Reduced, sizes: &[f64]) -> bool {
    let mut sizes = sizes.iter().enumerate();
    reduced.components().winding.is_some() || sizes.any(|(load, size)| *size != 0.0 && reduced.load_growth(load) != 0.0)
}

/// The error of a motion that has come to a position where two ends of a load coincide.
#[cold]
fn ends_meet(reduced: &Reduced, side: usize) -> ModelError {
    let (first, last) = reduced.curve().range;
    let (sigma, end) = (if side == 0 { first } else { last }, reduced.next(reduced, side));
    ModelError::travel((reduced, end.err().unwrap_or(End::OfTravel)), sigma)
}

/// Scratch of a step under a prescribed motion.
fn rates(reduced: &Reduced) -> Vec<f64> {
    let loads = reduced.loading().motion.as_ref().map_or(0, |_| reduced.loading().inputs.len());
    vec![0.0; 2 * loads]
}

/// Length of so many whole revolutions.
#[inline(always)]
fn shift(reduced: &Reduced, revolutions: f64) -> f64 {
    revolutions * reduced.period().unwrap_or(0.0)
}

impl State {
    /// A state that continues as the saved one did, under these inputs.
    ///
    /// # Errors
    /// [`ModelError::Table`]: a reaction that causes friction is not smooth.
    pub fn from_saved(saved: &SavedState, reduced: &Reduced, inputs: &Inputs) -> Result<Self, ModelError> {
        let reduced = reduced.at(saved.sigma);
        state_loads(reduced, blows_under(reduced, inputs), saved.revolutions)?;
        let scratch = Scratch::new(saved.state_loads(reduced)?);
        let before = Before { applied: saved.applied.clone(), ..Before::default() };
        let (witness, saved) = (Witness::new(saved.impacts.len()), Counted { saved: saved.clone(), accesses: 0 });
        Ok(Self { saved, before, scratch, witness, rates: rates(reduced), is_retuned: false })
    }

    /// Number of this state: each change gives another one.
    #[inline(always)]
    pub fn version(&self) -> u64 {
        self.saved.accesses
    }

    /// [`Self::from_saved`] in place, with the same reduced model; without allocation unless air has begun or ceased to
    /// act.
    ///
    /// # Errors
    /// As [`Self::from_saved`]; nothing has changed.
    #[inline]
    pub fn restore(&mut self, saved: &SavedState, reduced: &Reduced) -> Result<(), ModelError> {
        if saved.applied.air != self.scratch.air {
            self.renew_scratch(saved.state_loads(reduced)?);
        }
        self.saved.copy_from(saved);
        Ok(())
    }

    /// New scratch for these state loads, if air has begun or ceased to act; returns whether it has.
    #[inline]
    fn renew_scratch(&mut self, state_loads: Option<&StateLoads>) -> bool {
        let is_other = state_loads.is_some_and(|s| s.air) != self.scratch.air;
        if is_other {
            self.scratch = Scratch::new(state_loads);
        }
        is_other
    }

    /// Advance by exactly `h` [s] under these inputs, or to the first event if the witness pauses there. On an error
    /// the state is what it was, but for [`ModelError::Interrupted`], on which it is that at the time reached. `known`:
    /// what outputs have evaluated last under these inputs.
    ///
    /// # Errors
    /// The loads overflow, the integration stopped, friction locks, the travel of an open curve without stops ended, or
    /// the work of the step met its bound.
    pub fn step(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        (h, solver): (f64, &Solver),
        known: &Scratch,
    ) -> Result<Reached, ModelError> {
        if self.is_prescribed(inputs) {
            return self.step_prescribed(reduced, inputs, h, solver);
        }
        let ahead = inputs.signal.ahead;
        let is_new = !self.applied.are_in_force(inputs);
        if !is_new && let Some((y, lost)) = self.read_ahead(h, solver.tolerance) {
            return match self.arrive_at(reduced, y, lost, 0.0) {
                Ok(()) => Ok(Reached::End),
                Err(error) => {
                    self.undo(reduced, false);
                    Err(error)
                }
            };
        }
        if is_new {
            self.apply(reduced, inputs, h)?;
        }
        let (locked, state_loads) = (self.applied.locked, self.present_state_loads(reduced)?);
        let begin = Begin { revolutions: self.revolutions, tried: self.memory.tried() };
        let SavedState { sigma, sigma_dot, contact, .. } = *self.saved;
        let mut arrival = Arrival { y: [sigma, sigma_dot], lost: 0.0, contact, passed: 0.0 };
        let advanced = self.advance((reduced, state_loads), (inputs, locked), (h, solver, known), &mut arrival);
        self.scratch.evaluator.end_step();
        if ahead {
            self.memory.drop_outdated(Outdated::Law);
        }
        if arrival.contact.engaged() != contact.engaged() {
            self.saved.applied.version = 0;
        }
        let error = match advanced {
            Ok(()) => match self.arrive(reduced, &arrival) {
                Ok(()) => return Ok(Reached::End),
                Err(error) => error,
            },
            Err(stopped @ (Stopped::Event(progress) | Stopped::Pause(progress))) => {
                arrival.lost += progress.lost;
                let is_event = matches!(stopped, Stopped::Event(_));
                match self.arrive(reduced, &arrival) {
                    Ok(()) if is_event => return Ok(Reached::Event(progress.t)),
                    Ok(()) => return Ok(Reached::Pause(progress.t)),
                    Err(error) => error,
                }
            }
            Err(Stopped::Budget(progress)) => {
                arrival.lost += progress.lost;
                match self.arrive(reduced, &arrival) {
                    Ok(()) => return Err(self.interrupted(&begin, &progress, h, solver)),
                    Err(error) => error,
                }
            }
            Err(Stopped::Integration(error)) => ModelError::Integration(error),
            Err(Stopped::Vacuum(chamber)) => at_vacuum(chamber),
            Err(Stopped::Stuck(error, circuit)) => ModelError::Stuck { error, circuit },
            Err(Stopped::EndsMeet(side)) => ends_meet(reduced, side),
            Err(Stopped::Length) => rough_length(reduced),
            Err(Stopped::Locked) => {
                let joint = reduced.locking_joint(self.sigma).to_owned();
                ModelError::Locked { position: self.describe(reduced), joint }
            }
        };
        self.undo(reduced, is_new);
        Err(error)
    }

    /// State and energy lost at the end of a step of `h` [s] under the inputs in force, if it ends within a step of the
    /// integration that goes on beyond the present: what [`Advance::run`] finds without anything around it.
    #[inline(always)]
    fn read_ahead(&mut self, h: f64, tolerance: f64) -> Option<([f64; 2], f64)> {
        // The step that follows counts as the access.
        let SavedState { memory, contact, .. } = &mut self.saved.saved;
        if contact.at_rest().is_some() || contact.arrival().is_some() {
            return None;
        }
        match memory {
            Memory::Conservative(_, lookahead) => Some((lookahead.read_within(h, tolerance)?, 0.0)),
            Memory::WithDissipation(_, lookahead) => {
                let [sigma, sigma_dot, lost] = lookahead.read_within(h, tolerance)?;
                Some(([sigma, sigma_dot], lost))
            }
            Memory::WithHydraulics(_) => None,
        }
    }

    /// The loads that the state decides, under the applied inputs.
    ///
    /// # Errors
    /// None in a step: these loads were found when the inputs were applied.
    #[inline(always)]
    fn present_state_loads<'a>(&self, reduced: &'a Reduced) -> Result<Option<&'a StateLoads>, ModelError> {
        match self.memory {
            Memory::Conservative(..) => Ok(None),
            _ => self.state_loads(reduced),
        }
    }

    /// Advance by `h` [s] with the inputs applied, or as far as the motion comes, which `arrival` tells.
    #[inline(always)]
    fn advance(
        &mut self,
        (whole, state_loads): (&Reduced, Option<&StateLoads>),
        (inputs, locked): (&Inputs, EngagedLocks),
        (h, solver, known): (f64, &Solver, &Scratch),
        Arrival { y, lost, contact, passed }: &mut Arrival,
    ) -> Result<(), Stopped> {
        let reduced = whole.at(self.sigma);
        let Self { saved, scratch, witness, .. } = self;
        let SavedState { sigma, applied, memory, travel, revolutions, prescribed, .. } = &mut **saved;
        let ends = &Ends::new(travel, shift(reduced, *revolutions), locked);
        set_locks(contact, ends, 0.0, witness);
        let Applied { version, ref sizes, airspeed, .. } = *applied;
        let loads =
            AppliedLoads { version, sizes, airspeed, revolutions: *revolutions, change: inputs.change(reduced) };
        let known = Some(known).filter(|known| prescribed.is_none() && known.air == scratch.air);
        let dynamics = &mut EquationOfMotion::new(whole, (reduced, state_loads), loads, scratch);
        dynamics.scratch.panel_force.share(known.map(|known| &known.panel_force), *sigma);
        let (tolerance, max_steps) = (solver.tolerance, solver.most_steps());
        match memory {
            Memory::Conservative(integrator, lookahead) => {
                if lookahead.begin(tolerance, locked) {
                    integrator.branch_off();
                }
                let most = integrator.attempts() + max_steps;
                let passes = |sigma: f64| whole.reach(sigma).is_err();
                let path = || Path { length: reduced.period(), does_work: does_work(reduced, sizes) };
                let ahead = &mut *lookahead;
                let mut coasting = Coasting {
                    dynamics,
                    integrator,
                    lookahead: ahead,
                    ends,
                    contact,
                    witness,
                    tolerance,
                    passes,
                    path,
                };
                let impacts = coasting.run(y, h, most, passed);
                lookahead.end();
                *lost = impacts?;
                Ok(())
            }
            Memory::WithDissipation(integrator, lookahead) => {
                if lookahead.begin(tolerance, locked) {
                    integrator.branch_off();
                }
                let mut z = [y[0], y[1], 0.0];
                let progress = Progress::within(integrator.attempts() + max_steps);
                let ahead = &mut *lookahead;
                let ends = *ends;
                let advance =
                    Advance { dynamics, integrator, lookahead: ahead, ends, contact, witness, tolerance, progress };
                let impacts = advance.run(&mut z, h);
                lookahead.end();
                (*y, *lost) = ([z[0], z[1]], z[2]);
                *lost += impacts?;
                Ok(())
            }
            Memory::WithHydraulics(motion) => {
                let driven = Driven { dynamics, ends, contact, witness, tolerance, inputs };
                let (impacts, z, now_locked) = motion.run(driven, *y, h, max_steps);
                (*y, *lost) = ([z[0], z[1]], z[2]);
                applied.locked = now_locked;
                *lost += impacts?;
                Ok(())
            }
        }
    }

    /// A step of `h` [s] is done, from `point` [s] on in the host's time if it has told one: what stops have met
    /// counts.
    #[inline(always)]
    pub fn pass(&mut self, point: Option<f64>, h: f64) {
        if self.travel.is_empty() {
            return;
        }
        // The step before has counted as the access.
        let Self { saved: Counted { saved, .. }, witness, .. } = self;
        if let Some(point) = point {
            saved.time = Elapsed::at(point);
        }
        witness.settle(&mut saved.impacts, saved.time.now);
        saved.time.pass(h);
    }

    /// Allocate what a step may need later than the first one.
    pub fn prepare(&mut self, reduced: &Reduced) {
        let state_loads = self.state_loads(reduced).ok().flatten();
        self.scratch.panel_force.prepare(reduced.at(self.sigma), state_loads);
    }

    /// The places of the stops in the frame of sigma, and where locks are engaged.
    pub fn ends(&self, reduced: &Reduced, locks: &[bool]) -> Ends<'_> {
        let travel = &*self.travel;
        Ends::new(
            travel,
            shift(reduced, self.revolutions),
            engaged_locks(travel, reduced, (locks, self.contact.engaged()), self.memory.network_values()),
        )
    }

    /// Whether the mechanism is at a stop or beyond: past the place where the stop is first met, and not back within
    /// the stop behind a dead centre.
    pub fn at_stop(&self, reduced: &Reduced, stop: usize) -> bool {
        let shift = shift(reduced, self.revolutions);
        let travel = &*self.travel;
        travel.places().filter(|(place, _)| travel.holds(*place, stop)).any(|(place, position)| {
            let past = (self.sigma - (position - shift)) * place.outward();
            past == 0.0 || past > 0.0 && (place.bumper().is_none() || self.is_beyond(reduced, stop))
        })
    }

    /// Whether a lock has engaged by the force of its stop; true for one that needs no such force.
    pub fn has_engaged(&self, reduced: &Reduced, lock: usize) -> bool {
        let lock = &reduced.loading().locks[lock];
        let (travel, engaged) = (&self.travel, self.contact.engaged());
        let mut own = travel.places().filter(|(place, _)| travel.holds(*place, lock.stop));
        lock.engage.is_none() || own.any(|(place, _)| engaged.contains(place))
    }

    /// Whether the quantity of a stop is at its value or beyond.
    fn is_beyond(&self, reduced: &Reduced, stop: usize) -> bool {
        let stop = &reduced.loading().stops[stop];
        stop.beyond(self.displacement(reduced, stop.load)) >= -AT_STOP * (1.0 + stop.value.abs())
    }

    /// Description of the present position, for messages.
    pub fn describe(&self, reduced: &Reduced) -> String {
        reduced.describe(self.sigma, self.revolutions)
    }
}
