//! The state of motion and its steps.
//!
//! In: a start, inputs, a reduced model. Out: the state after each step, on an error the state before it. It must not
//! know outputs.
use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::dynamics::state_loads::Mode;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::contact::{Contact, Ends, outward};
use crate::mechanism::motion::saved::{Memory, SavedState};
use crate::mechanism::motion::step_ahead::Lookahead;
use crate::mechanism::motion::travel::{beyond_stop, can_hold, travel};
use crate::mechanism::reduced::{Reduced, ReductionError, StateLoads};
use crate::numerics::table::Unresolved;
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

/// The loads that the state decides, in moving air or not, with an error located after so many revolutions.
pub(super) fn state_loads(reduced: &Reduced, air: bool, revolutions: f64) -> Result<Option<&StateLoads>, ModelError> {
    reduced.state_loads(air).map_err(|at| ModelError::table(reduced, "friction", at, revolutions))
}

impl State {
    /// The state that the definition states.
    pub fn at_start(reduced: &Reduced, mechanism: &Mechanism, inputs: &Inputs) -> Result<Self, ModelError> {
        let start = &mechanism.start;
        let linkage = reduced.linkage();
        let carrier = start.body.as_ref().and_then(|body| linkage.carrier(mechanism, body));
        let (coordinate, value, name, quantity) = match (&start.body, &start.joint) {
            (Some(body), _) => {
                let (carrier, own) = carrier.unwrap_or((0, 0.0));
                let coordinate = linkage.bodies[carrier].angle_coordinate;
                let value = start.angle.unwrap_or(0.0) - own - linkage.bodies[carrier].offset;
                (coordinate, value, body, "angle")
            }
            (None, Some(joint)) => {
                let index = linkage.coordinates[linkage.angles..].iter().position(|c| c == joint);
                (index.map(|i| i + linkage.angles), start.position.unwrap_or(0.0), joint, "position")
            }
            (None, None) => (None, 0.0, &mechanism.name, "angle"),
        };
        let variable = format!("{name}.start_{quantity}");
        let coordinate = coordinate.ok_or_else(|| {
            let allowed = format!("state one of the coordinates {}", linkage.coordinates.join(", "));
            ModelError::Definition(DefinitionError::unknown("start", name, allowed))
        })?;
        if let (Some((body, own)), Some(angle)) = (carrier, start.angle) {
            // Before the search for the start, as the curve may end at a stop of the body whose angle states the start.
            let loading = reduced.loading();
            let is_own = |stop: &&Stop| stop.enabled && loading.loads[stop.load] == Load::Torque { body };
            loading.stops.iter().filter(is_own).try_for_each(|stop| beyond_stop(stop, angle - own))?;
        }
        let stated = start.angle.or(start.position).unwrap_or(0.0);
        let (sigma, revolutions) = reduced.find(coordinate, value, &variable).map_err(|e| e.as_stated(stated))?;
        let mut sigma_dot = 0.0;
        if start.speed != 0.0 {
            // The table is exact where branches cross, too. Within some 1e-13 rad of a toggle, where the slope is below
            // 1e-6, the slope is rounding.
            let table = reduced.coordinates().map_err(|at| ModelError::table(reduced, &variable, at, revolutions))?;
            let slope = table.value(table.position(sigma), 3 * coordinate + 1);
            if slope.abs() * reduced.scale() < 1e-6 {
                let name = format!("{name}.start_speed");
                return Err(ReductionError::StartSpeed { name, value: start.speed }.into());
            }
            sigma_dot = start.speed / slope;
        }
        let travel = travel(reduced, sigma, revolutions)?;
        let here = sigma + revolutions * reduced.period().unwrap_or(0.0);
        let resting = (0..2).find(|&side| sigma_dot == 0.0 && travel[side].is_some_and(|e| e.position == here));
        can_hold(reduced, &travel)?;
        let state_loads = state_loads(reduced, blows_under(reduced, inputs), revolutions)?;
        let applied = reduced.sizes(&inputs.reals);
        let mut state = Self {
            before: applied.clone(),
            saved: SavedState {
                sigma,
                sigma_dot,
                revolutions,
                contact: Contact::at_start(resting),
                travel,
                applied,
                airspeed: airspeed(reduced, inputs),
                ..SavedState::default()
            },
            scratch: Scratch::new(state_loads),
        };
        state.memory.set_dissipation(state_loads.is_some());
        state.reference = state.kinetic() + state.load_potential(reduced);
        Ok(state)
    }

    /// A state that continues as the saved one did, under these inputs.
    ///
    /// # Errors
    /// [`ModelError::Table`]: a reaction that causes friction is not smooth.
    pub fn from_saved(saved: &SavedState, reduced: &Reduced, inputs: &Inputs) -> Result<Self, ModelError> {
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
        if blows(reduced, saved.airspeed) != self.scratch.air {
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

    /// Advance by exactly `h` [s] under these inputs. On an error the state is what it was.
    ///
    /// # Errors
    /// The integration stopped, friction locks, the travel of an open curve without stops ended.
    pub fn step(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64, tolerance: f64) -> Result<(), ModelError> {
        let (airspeed, reference) = (self.airspeed, self.reference);
        let (state_loads, changed) = self.apply(reduced, inputs)?;
        let advanced = self.advance((reduced, state_loads), inputs, h, tolerance).map_err(|stopped| match stopped {
            Stopped::Integration(error) => ModelError::Integration(error),
            Stopped::Locked => ModelError::Locked { position: self.describe(reduced) },
        });
        if inputs.signal.ahead {
            self.right_hand_side_changed();
        }
        let arrived = advanced.and_then(|arrival| self.arrive(reduced, arrival));
        if arrived.is_err() {
            self.undo(reduced, changed, airspeed, reference);
        }
        arrived
    }

    /// The end of a step of `h` [s], with the loads and the airspeed applied: (sigma, sigma_dot), with sigma perhaps
    /// beyond the ends of a closed curve; energy lost in the step [J]; contact.
    #[inline]
    fn advance(
        &mut self,
        (reduced, state_loads): (&Reduced, Option<&StateLoads>),
        inputs: &Inputs,
        h: f64,
        tolerance: f64,
    ) -> Result<([f64; 2], f64, Contact), Stopped> {
        let ends = &self.ends(reduced, &inputs.locks);
        let Self { saved, scratch, .. } = self;
        let (mut y, mut contact) = ([saved.sigma, saved.sigma_dot], saved.contact);
        contact.locks_set(ends.locked);
        let SavedState { airspeed, revolutions, .. } = *saved;
        let applied = AppliedLoads { sizes: &saved.applied, airspeed, revolutions, change: inputs.change(reduced) };
        let mode = Mode::default();
        let dynamics = &mut EquationOfMotion { reduced, state_loads, applied, time: 0.0, mode, scratch, locked: false };
        let progress = Progress::default();
        match &mut saved.memory {
            Memory::Conservative(integrator) => {
                let lost = if ends.travel.iter().all(Option::is_none) {
                    integrator.advance(dynamics, &mut y, h, tolerance).map(|()| 0.0).map_err(Stopped::Integration)
                } else {
                    let (lookahead, contact) = (&mut Lookahead::default(), &mut contact);
                    Advance { dynamics, integrator, lookahead, ends, contact, tolerance, progress }.run(&mut y, h)
                };
                Ok((y, lost?, contact))
            }
            Memory::WithDissipation(integrator, lookahead) => {
                if lookahead.begin(tolerance, ends.locked) {
                    integrator.branch_off();
                }
                let mut z = [y[0], y[1], 0.0];
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
                let lost = advance.run(&mut z, h);
                lookahead.end();
                Ok(([z[0], z[1]], lost? + z[2], contact))
            }
        }
    }

    /// Take over the end of a step, with sigma within the curve.
    #[inline]
    fn arrive(
        &mut self,
        reduced: &Reduced,
        (mut y, lost, contact): ([f64; 2], f64, Contact),
    ) -> Result<(), ModelError> {
        let (first, last) = reduced.curve().range;
        match reduced.period() {
            Some(period) if !(first..last).contains(&y[0]) => {
                let revolutions = ((y[0] - first) / period).floor();
                y[0] -= revolutions * period;
                self.revolutions += revolutions;
                // The panel in use and a step ahead are counted on over whole revolutions, but sigma is not any more.
                self.memory.recount();
                self.scratch.panel_force.invalidate();
            }
            None if !(first..=last).contains(&y[0]) => {
                return Err(ModelError::Travel { position: reduced.curve().describe(y[0], self.revolutions) });
            }
            _ => {}
        }
        [self.sigma, self.sigma_dot] = y;
        self.contact = contact;
        self.reference -= lost;
        Ok(())
    }

    /// Sizes or rates of loads are others than those of the last evaluation.
    fn right_hand_side_changed(&mut self) {
        self.memory.refresh();
        self.scratch.panel_force.invalidate();
    }

    /// The ends of the travel in the frame of sigma, and whether a lock is engaged at each.
    pub fn ends(&self, reduced: &Reduced, locks: &[bool]) -> Ends {
        let shift = self.revolutions * reduced.period().unwrap_or(0.0);
        let mut travel = self.travel;
        let mut locked = [false; 2];
        for (end, locked) in travel.iter_mut().zip(&mut locked) {
            if let Some(end) = end {
                end.position -= shift;
                let mut all = reduced.loading().locks.iter().zip(locks);
                *locked = all.any(|(lock, engaged)| *engaged && lock.stop == end.stop);
            }
        }
        Ends { travel, locked }
    }

    /// Whether the mechanism is at a stop: in contact with it, or held there.
    pub fn at_stop(&self, reduced: &Reduced, stop: usize) -> bool {
        let here = self.sigma + self.revolutions * reduced.period().unwrap_or(0.0);
        (0..2)
            .any(|side| self.travel[side].is_some_and(|e| e.stop == stop && (here - e.position) * outward(side) >= 0.0))
    }

    /// Description of the present position, for messages.
    pub fn describe(&self, reduced: &Reduced) -> String {
        reduced.curve().describe(self.sigma, self.revolutions)
    }

    /// Apply inputs that have changed since the last step, and return whether any has. The change of the loads'
    /// potential is work from outside.
    fn apply<'a>(
        &mut self,
        reduced: &'a Reduced,
        inputs: &Inputs,
    ) -> Result<(Option<&'a StateLoads>, bool), ModelError> {
        let state_loads = state_loads(reduced, blows_under(reduced, inputs), self.revolutions)?;
        let loads = reduced.loading().inputs.len();
        let mut work = 0.0;
        let mut changed = false;
        for (load, input) in inputs.reals[..loads].iter().enumerate() {
            if self.applied[load].to_bits() != input.to_bits() {
                work -= (input - self.applied[load]) * self.displacement(reduced, load);
                changed = true;
            }
        }
        let airspeed = airspeed(reduced, inputs);
        if self.renew_scratch(state_loads) {
            self.memory.restart();
        }
        self.memory.set_dissipation(state_loads.is_some() || inputs.signal.ahead);
        if airspeed.to_bits() != self.airspeed.to_bits() {
            self.airspeed = airspeed;
            changed = true;
        }
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

    /// After a step that failed: reverse [`Self::apply`]; the integration starts anew.
    #[cold]
    fn undo(&mut self, reduced: &Reduced, changed: bool, airspeed: f64, reference: f64) {
        self.memory.restart();
        if !changed {
            return;
        }
        self.saved.applied.copy_from_slice(&self.before);
        (self.reference, self.airspeed) = (reference, airspeed);
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
