//! The state of motion and its steps.
//!
//! In: a start, inputs, a reduced model. Out: the state after each step, on an error the state before it. It must not
//! know outputs.
mod circuit;
mod start;

use crate::integrator::Statistics;
use crate::mechanism::definition::Solver;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::dynamics::state_loads::Mode;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::coasting::Coasting;
use crate::mechanism::motion::contact::{Contact, Ends, EngagedLocks, Place, Travel};
use crate::mechanism::motion::saved::{MOST_REVOLUTIONS, Memory, SavedState};
use crate::mechanism::motion::travel::AT_STOP;
use crate::mechanism::motion::work::Spent;
use crate::mechanism::reduced::{End, Reduced, ReductionError, StateLoads};
use crate::numerics::table::Unresolved;
pub use circuit::check_lengths;
use circuit::left_circuit;
use std::ops::{Deref, DerefMut};

/// The state of motion, with the memory of the integration.
#[derive(Clone, Debug)]
pub struct State {
    /// The part that decides how the state continues.
    pub saved: SavedState,
    /// Sizes before their last change, for a step that fails.
    before: Vec<f64>,
    /// Right-hand side for the applied sizes, for the integration.
    scratch: Scratch,
}

impl Deref for State {
    type Target = SavedState;

    fn deref(&self) -> &SavedState {
        &self.saved
    }
}

impl DerefMut for State {
    fn deref_mut(&mut self) -> &mut SavedState {
        &mut self.saved
    }
}

/// Largest size of an input whose loads are taken not to overflow. The loads of a larger one are tried before a step.
const LARGE: f64 = 1e100;

/// The end of a step.
struct Arrival {
    /// (sigma, sigma_dot), with sigma perhaps beyond the ends of a closed curve.
    y: [f64; 2],
    /// Energy lost in the step [J].
    lost: f64,
    contact: Contact,
    /// Revolutions that sigma does not count.
    passed: f64,
    /// How far an advance has come that met the bound on its work.
    interrupted: Option<Box<Progress>>,
}

/// Whether air of this speed [m/s] acts on the surfaces.
pub(super) fn blows(reduced: &Reduced, speed: f64) -> bool {
    reduced.loading().air.as_ref().is_some_and(|air| air.relative_wind || speed != 0.0)
}

/// Airspeed under these inputs [m/s]; 0 without air.
pub fn airspeed(reduced: &Reduced, inputs: &Inputs) -> f64 {
    reduced.loading().air.as_ref().and(inputs.reals.last().copied()).unwrap_or(0.0)
}

/// The loads that the state decides, under these inputs.
///
/// # Errors
/// [`Unresolved`]: a reaction that causes friction is not smooth.
pub fn state_loads_under<'a>(reduced: &'a Reduced, inputs: &Inputs) -> Result<Option<&'a StateLoads>, &'a Unresolved> {
    reduced.state_loads(blows_under(reduced, inputs))
}

/// Whether air acts on the surfaces at any time of a step under these inputs.
fn blows_under(reduced: &Reduced, inputs: &Inputs) -> bool {
    let changes = || inputs.change(reduced).is_some_and(|change| change.airspeed != [0.0; 2]);
    blows(reduced, airspeed(reduced, inputs)) || (reduced.loading().air.is_some() && changes())
}

/// Whether a load of these sizes or a spring does work over a whole revolution of a closed curve.
fn does_work(reduced: &Reduced, sizes: &[f64]) -> bool {
    let mut sizes = sizes.iter().enumerate();
    reduced.components().winding.is_some() || sizes.any(|(load, size)| *size != 0.0 && reduced.load_growth(load) != 0.0)
}

/// The loads that the state decides, in moving air or not, with an error located after so many revolutions.
pub(super) fn state_loads(reduced: &Reduced, air: bool, revolutions: f64) -> Result<Option<&StateLoads>, ModelError> {
    reduced.state_loads(air).map_err(|at| ModelError::table(reduced, "friction", at, revolutions))
}

/// The places of the stops in the frame of sigma after so many revolutions, and where these locks are engaged.
#[inline(always)]
fn ends<'a>(travel: &'a Travel, reduced: &Reduced, revolutions: f64, locks: &[bool]) -> Ends<'a> {
    let mut locked = EngagedLocks::default();
    let engaged = reduced.loading().locks.iter().zip(locks).filter(|(_, engaged)| **engaged);
    for (lock, _) in engaged {
        for (side, locked) in locked.rigid.iter_mut().enumerate() {
            *locked |= travel.holds(Place::rigid(side), lock.stop);
        }
        let bumpers = BumperSet::of(travel.bumpers.len(), |k| travel.bumpers[k].stop == lock.stop);
        locked.bumpers = locked.bumpers.union(bumpers);
    }
    Ends { travel, shift: revolutions * reduced.period().unwrap_or(0.0), locked }
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
        Ok(Self { saved: saved.clone(), before: saved.applied.clone(), scratch })
    }

    /// [`Self::from_saved`] in place, with the same reduced model; without allocation unless air has begun or ceased to
    /// act.
    ///
    /// # Errors
    /// As [`Self::from_saved`]; nothing has changed.
    #[inline]
    pub fn restore(&mut self, saved: &SavedState, reduced: &Reduced) -> Result<(), ModelError> {
        if saved.air != self.scratch.air {
            self.renew_scratch(saved.state_loads(reduced)?);
        }
        if self.saved.copy_from(saved) {
            self.scratch.panel_force.invalidate();
        }
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

    /// Advance by exactly `h` [s] under these inputs. On an error the state is what it was, but for
    /// [`ModelError::Interrupted`], on which it is that at the time reached.
    ///
    /// # Errors
    /// The loads overflow, the integration stopped, friction locks, the travel of an open curve without stops ended, or
    /// the work of the step met its bound.
    pub fn step(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64, solver: &Solver) -> Result<(), ModelError> {
        let (airspeed, reference, air) = (self.airspeed, self.reference, self.air);
        let (state_loads, changed) = self.apply(reduced, inputs, h)?;
        let before = (self.revolutions, self.memory.statistics());
        let mut advanced = self.advance(reduced, state_loads, inputs, h, solver).map_err(|stopped| match stopped {
            Stopped::Integration(error) => ModelError::Integration(error),
            Stopped::Circuit(left) => left_circuit(reduced, left),
            _ => ModelError::Locked { position: self.describe(reduced) },
        });
        if inputs.signal.ahead {
            self.right_hand_side_changed();
        }
        let interrupted = advanced.as_mut().ok().and_then(|arrival| arrival.interrupted.take());
        let arrived = advanced.and_then(|arrival| self.arrive(reduced, arrival));
        if arrived.is_err() {
            (self.airspeed, self.reference, self.air) = (airspeed, reference, air);
            self.undo(reduced, changed);
            return arrived;
        }
        match interrupted {
            Some(progress) => Err(self.interrupted(before, &progress, h, solver)),
            None => Ok(()),
        }
    }

    /// The end of a step of `h` [s], with the loads and the airspeed applied.
    #[inline]
    fn advance(
        &mut self,
        whole: &Reduced,
        state_loads: Option<&StateLoads>,
        inputs: &Inputs,
        h: f64,
        solver: &Solver,
    ) -> Result<Arrival, Stopped> {
        let reduced = whole.at(self.sigma);
        let Self { saved, scratch, .. } = self;
        let (mut y, mut contact) = ([saved.sigma, saved.sigma_dot], saved.contact);
        let SavedState { airspeed, revolutions, .. } = *saved;
        let ends = &ends(&saved.travel, reduced, revolutions, &inputs.locks);
        contact.locks_set(ends);
        let sizes = &saved.applied;
        let applied = AppliedLoads { sizes, airspeed, revolutions, change: inputs.change(reduced) };
        let mode = Mode::default();
        scratch.panel_force.on_stretch(reduced.stretch);
        let dynamics = &mut EquationOfMotion {
            whole,
            reduced,
            state_loads,
            applied,
            time: 0.0,
            mode,
            scratch,
            locked: false,
            ports: None,
        };
        let (tolerance, max_steps) = (solver.tolerance, solver.max_steps as u64);
        let mut passed = 0.0;
        let (advanced, lost) = match &mut saved.memory {
            Memory::Conservative(integrator) => {
                let most = integrator.attempts() + max_steps;
                let passes = |sigma: f64| whole.reach(sigma).is_err();
                let (length, does_work) = (reduced.period(), || does_work(reduced, sizes));
                let contact = &mut contact;
                let mut coasting =
                    Coasting { dynamics, integrator, ends, contact, tolerance, passes, length, does_work };
                (coasting.run(&mut y, h, most, &mut passed), 0.0)
            }
            Memory::WithDissipation(integrator, lookahead) => {
                if lookahead.begin(tolerance, ends.locked) {
                    integrator.branch_off();
                }
                let mut z = [y[0], y[1], 0.0];
                let progress = Progress::within(integrator.attempts() + max_steps);
                let (ahead, contact_then) = (&mut *lookahead, &mut contact);
                let advance = Advance {
                    dynamics,
                    integrator,
                    lookahead: ahead,
                    ends,
                    contact: contact_then,
                    tolerance,
                    progress,
                };
                let advanced = advance.run(&mut z, h);
                lookahead.end();
                y = [z[0], z[1]];
                (advanced, z[2])
            }
            Memory::WithCircuit(memory) => {
                let driven = circuit::Driven { dynamics, memory, ends, contact: &mut contact, tolerance, inputs };
                let (advanced, z) = driven.run(y, h, max_steps);
                y = [z[0], z[1]];
                (advanced, z[2])
            }
        };
        match advanced {
            Ok(impacts) => Ok(Arrival { y, lost: impacts + lost, contact, passed, interrupted: None }),
            Err(Stopped::Budget(progress)) => {
                Ok(Arrival { y, lost: progress.lost + lost, contact, passed, interrupted: Some(Box::new(progress)) })
            }
            Err(stopped) => Err(stopped),
        }
    }

    /// Take over the end of a step, with sigma within the curve.
    #[inline]
    fn arrive(
        &mut self,
        reduced: &Reduced,
        Arrival { mut y, lost, contact, passed, .. }: Arrival,
    ) -> Result<(), ModelError> {
        if !(y[1] + lost).is_finite() || !(self.reference - lost).is_finite() {
            return Err(ModelError::Overflow { name: "the motion at the end of the step".into() });
        }
        let (first, last) = reduced.curve().range;
        match reduced.period() {
            Some(period) if passed != 0.0 || !(first..last).contains(&y[0]) => {
                let revolutions = ((y[0] - first) / period).floor();
                let all = self.revolutions + revolutions + passed;
                if all.is_nan() || all.abs() > MOST_REVOLUTIONS {
                    return Err(ModelError::Overflow { name: "the number of revolutions".into() });
                }
                let shift = self.revolutions * period;
                let place = self.travel.places().find(|(_, position)| position - shift == y[0]);
                y[0] = match place {
                    // At a stop before, at the stop after: what is at a place is known by equal numbers.
                    Some((_, position)) => position - all * period,
                    // Over many revolutions the difference may be beyond the ends by rounding.
                    None => (y[0] - revolutions * period).clamp(first, last),
                };
                self.revolutions = all;
                // The panel in use and a step ahead are counted on over whole revolutions, but sigma is not any more.
                self.memory.recount();
                self.scratch.panel_force.invalidate();
            }
            None if !(first..last).contains(&y[0]) => self.arrive_beyond(reduced, y[0])?,
            _ => {}
        }
        [self.sigma, self.sigma_dot] = y;
        self.contact = contact;
        self.reference -= lost;
        Ok(())
    }

    /// Refuse a state beyond an end of the curve, or on a stretch of it with state loads that are not smooth.
    #[cold]
    fn arrive_beyond(&self, reduced: &Reduced, sigma: f64) -> Result<(), ModelError> {
        let stretch = reduced.reach(sigma).map_err(|end| ModelError::travel(end, sigma))?;
        let failed = |at: &Unresolved| {
            let (position, what) = (stretch.curve().describe(at.sigma, 0.0), "friction".into());
            ModelError::travel((stretch, End::Failed(&ReductionError::Table { what, position })), sigma)
        };
        stretch.state_loads(self.air).map_err(failed).map(|_| ())
    }

    /// Why a step has come no further.
    #[cold]
    fn interrupted(
        &self,
        (revolutions, statistics): (f64, Statistics),
        &Progress { t: time, work, .. }: &Progress,
        h: f64,
        solver: &Solver,
    ) -> ModelError {
        let (statistics, revolutions) = ([statistics, self.memory.statistics()], self.revolutions - revolutions);
        let why = Spent { statistics, work, revolutions, time, h, max_steps: solver.max_steps }.describe();
        ModelError::Interrupted { time, why }
    }

    /// Sizes or rates of loads are others than those of the last evaluation.
    fn right_hand_side_changed(&mut self) {
        self.memory.refresh();
        self.scratch.panel_force.invalidate();
    }

    /// The places of the stops in the frame of sigma, and where locks are engaged.
    pub fn ends(&self, reduced: &Reduced, locks: &[bool]) -> Ends<'_> {
        ends(&self.travel, reduced, self.revolutions, locks)
    }

    /// Whether the mechanism is at a stop or beyond: past the place where the stop is first met, and not back within
    /// the stop behind a dead centre.
    pub fn at_stop(&self, reduced: &Reduced, stop: usize) -> bool {
        let shift = self.revolutions * reduced.period().unwrap_or(0.0);
        let travel = &*self.travel;
        travel.places().filter(|(place, _)| travel.holds(*place, stop)).any(|(place, position)| {
            let past = (self.sigma - (position - shift)) * place.outward();
            past == 0.0 || past > 0.0 && (place.bumper.is_none() || self.is_beyond(reduced, stop))
        })
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

    /// Apply inputs that have changed since the last step, for a step of `h` [s], and return whether any has. The
    /// change of the loads' potential is work from outside.
    ///
    /// # Errors
    /// [`ModelError::Table`], [`ModelError::LoadOverflow`]; nothing has changed.
    fn apply<'a>(
        &mut self,
        reduced: &'a Reduced,
        inputs: &Inputs,
        h: f64,
    ) -> Result<(Option<&'a StateLoads>, bool), ModelError> {
        let air = blows_under(reduced, inputs);
        let state_loads = state_loads(reduced.at(self.sigma), air, self.revolutions)?;
        circuit::check_ports(reduced, inputs)?;
        let loads = reduced.loading().inputs.len();
        let (mut work, mut largest) = (0.0, 0.0_f64);
        let mut changed = false;
        for (load, input) in inputs.reals[..loads].iter().enumerate() {
            if self.applied[load].to_bits() != input.to_bits() {
                work -= (input - self.applied[load]) * self.displacement(reduced, load);
                largest = largest.max(input.abs());
                changed = true;
            }
        }
        let airspeed = airspeed(reduced, inputs);
        if airspeed.to_bits() != self.airspeed.to_bits() {
            largest = largest.max(airspeed.abs());
            changed = true;
        }
        if inputs.signal.ahead {
            largest = inputs.largest_at(h).max(largest);
        }
        if largest > LARGE {
            self.try_loads((reduced, state_loads), inputs, h, work)?;
        }
        if self.renew_scratch(state_loads) {
            self.memory.restart();
        }
        self.memory.set_dissipation(state_loads.is_some() || inputs.signal.ahead);
        (self.airspeed, self.air) = (airspeed, air);
        if changed {
            self.reference += work;
            self.before.copy_from_slice(&self.saved.applied);
            self.applied[..loads].copy_from_slice(&inputs.reals[..loads]);
        }
        if changed || inputs.signal.ahead {
            self.right_hand_side_changed();
        }
        Ok((state_loads, changed))
    }

    /// Refuse inputs so large that their work or their loads overflow at the start or at the end of a step of `h` [s],
    /// at the present position. `work`: that of their change [J].
    #[cold]
    fn try_loads(
        &self,
        (reduced, state_loads): (&Reduced, Option<&StateLoads>),
        inputs: &Inputs,
        h: f64,
        work: f64,
    ) -> Result<(), ModelError> {
        let loads = reduced.loading().inputs.len();
        let mut sizes = self.applied.clone();
        sizes[..loads].copy_from_slice(&inputs.reals[..loads]);
        let (airspeed, revolutions) = (airspeed(reduced, inputs), self.revolutions);
        let applied = AppliedLoads { sizes: &sizes, airspeed, revolutions, change: inputs.change(reduced) };
        let (mode, scratch) = (Mode::default(), &mut Scratch::new(state_loads));
        let (whole, reduced, time, locked, ports) = (reduced, reduced.at(self.sigma), 0.0, false, None);
        let mut equation =
            EquationOfMotion { whole, reduced, state_loads, applied, time, mode, scratch, locked, ports };
        let mut overflows = !(self.reference + work).is_finite();
        for time in [0.0, h] {
            equation.time = time;
            let force = equation.effect(self.sigma, self.sigma_dot);
            overflows |= force.is_ok_and(|force| !(force.acceleration.is_finite() && force.lost.is_finite()));
        }
        if !overflows {
            return Ok(());
        }
        let sizes = (0..inputs.reals.len()).map(|input| (input, inputs.size_at(input, h)));
        let acting = sizes.filter(|(input, _)| *input < loads || reduced.loading().air.is_some());
        let (input, value) = acting.max_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or_default();
        let name = reduced.loading().inputs.get(input).map_or("airspeed", String::as_str);
        Err(ModelError::LoadOverflow { name: name.into(), value })
    }

    /// After a step that failed, with the airspeed and the energy as before it: reverse the rest of [`Self::apply`].
    /// The integration starts anew.
    #[cold]
    fn undo(&mut self, reduced: &Reduced, changed: bool) {
        self.memory.restart();
        self.memory.undo_circuit();
        if changed {
            self.saved.applied.copy_from_slice(&self.before);
        }
        // These state loads exist: they were in use before this step.
        let state_loads = self.state_loads(reduced).unwrap_or_default();
        self.renew_scratch(state_loads);
        self.memory.set_dissipation(state_loads.is_some());
        self.scratch.panel_force.invalidate();
    }

    /// Kinetic energy T = sigma_dot^2 / 2 [J]: sigma is the length in the kinetic metric.
    pub fn kinetic(&self) -> f64 {
        0.5 * self.sigma_dot * self.sigma_dot
    }

    /// Potential of all loads at the applied sizes: the springs' energy, less the sum of size times displacement [J].
    pub fn load_potential(&self, reduced: &Reduced) -> f64 {
        let springs = reduced.loading().springs.iter();
        let mut sum = springs.fold(0.0, |sum, spring| sum + spring.energy(self.displacement(reduced, spring.load)));
        for (load, size) in self.applied.iter().enumerate().filter(|(_, size)| **size != 0.0) {
            sum -= size * self.displacement(reduced, load);
        }
        sum
    }

    /// Displacement of a load, counted on over whole revolutions.
    pub fn displacement(&self, reduced: &Reduced, load: usize) -> f64 {
        let growth = if self.revolutions == 0.0 { 0.0 } else { self.revolutions * reduced.load_growth(load) };
        reduced.displacement_at(load, self.sigma) + growth
    }
}
