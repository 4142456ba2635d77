//! The state of motion and its steps.
//!
//! In: a start, inputs, a reduced model. Out: the state after each step, on an error the state before it. It must not
//! know outputs.
use crate::integrator::Statistics;
use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::dynamics::state_loads::Mode;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::contact::Contact;
use crate::mechanism::motion::ends::{Ends, Travel, outward};
use crate::mechanism::motion::memory::Memory;
use crate::mechanism::motion::step_ahead::{Conditions, Lookahead};
use crate::mechanism::motion::travel::{beyond_stop, can_hold, travel};
use crate::mechanism::reduced::{Reduced, ReductionError, StateLoads};
use crate::numerics::table::Unresolved;

/// The state of motion, with the memory of the integration.
#[derive(Clone, Debug)]
pub struct State {
    /// Length along the curve; on a closed curve within its first revolution.
    pub sigma: f64,
    /// Its rate.
    pub sigma_dot: f64,
    /// Whole revolutions of a closed curve made so far.
    pub revolutions: f64,
    /// Contact at the ends of the travel.
    pub contact: Contact,
    /// Ends of the travel.
    pub travel: Travel,
    /// Sizes of the loads in the last step, which the integration and the energy balance refer to.
    pub applied: Vec<f64>,
    /// Sizes before their last change, for a step that fails.
    pub(super) before: Vec<f64>,
    /// Airspeed in the last step [m/s].
    pub(super) airspeed: f64,
    /// Energy at the start, plus the work of changing sizes, less the energy lost since.
    pub reference: f64,
    pub(super) memory: Memory,
    /// Right-hand side for the applied sizes, for the integration.
    pub(super) scratch: Scratch,
}

/// The state at the end of a step.
struct Arrival {
    /// sigma, perhaps beyond the ends of a closed curve, and sigma_dot.
    y: [f64; 2],
    /// Energy lost in the step [J].
    lost: f64,
    contact: Contact,
}

/// Why a step failed.
enum Failure {
    Stopped(Stopped),
    /// The step would end beyond an open end of the curve.
    Travel {
        sigma: f64,
    },
}

impl From<Stopped> for Failure {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped)
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
    let changes = || inputs.change(reduced).is_some_and(|change| change.airspeed != [0.0; 2]);
    reduced.state_loads(blows(reduced, airspeed(reduced, inputs)) || (reduced.loading().air.is_some() && changes()))
}

/// [`state_loads_under`], with the error located after so many revolutions.
pub(super) fn state_loads<'a>(
    reduced: &'a Reduced,
    inputs: &Inputs,
    revolutions: f64,
) -> Result<Option<&'a StateLoads>, ModelError> {
    state_loads_under(reduced, inputs).map_err(|at| friction_error(reduced, at, revolutions))
}

/// The loads that the state decides, in air of this speed [m/s].
///
/// # Errors
/// As [`state_loads`].
pub(super) fn state_loads_in_air(
    reduced: &Reduced,
    speed: f64,
    revolutions: f64,
) -> Result<Option<&StateLoads>, ModelError> {
    reduced.state_loads(blows(reduced, speed)).map_err(|at| friction_error(reduced, at, revolutions))
}

fn friction_error(reduced: &Reduced, at: &Unresolved, revolutions: f64) -> ModelError {
    ModelError::Table { name: "friction".into(), position: reduced.curve().describe(at.sigma, revolutions) }
}

impl State {
    /// The state that the definition states.
    pub fn at_start(reduced: &Reduced, mechanism: &Mechanism, inputs: &Inputs) -> Result<Self, ModelError> {
        let start = &mechanism.start;
        let linkage = reduced.linkage();
        let (coordinate, value, name, quantity) = match (&start.body, &start.joint) {
            (Some(body), _) => {
                let (carrier, angle) = linkage.carrier(mechanism, body).unwrap_or((0, 0.0));
                let coordinate = linkage.bodies[carrier].angle_coordinate;
                let value = start.angle.unwrap_or(0.0) - angle - linkage.bodies[carrier].offset;
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
            ModelError::Definition(DefinitionError::Unknown {
                key: "start".into(),
                name: name.clone(),
                allowed: format!("state one of the coordinates {}", linkage.coordinates.join(", ")),
            })
        })?;
        if let (Some(body), Some(angle)) = (&start.body, start.angle) {
            not_beyond_stop(reduced, mechanism, body, angle)?;
        }
        let stated = start.angle.or(start.position).unwrap_or(0.0);
        let (sigma, revolutions) = reduced.find(coordinate, value, &variable).map_err(|e| e.as_stated(stated))?;
        let mut sigma_dot = 0.0;
        if start.speed != 0.0 {
            // The table is exact where branches cross, too. Within some 1e-13 rad of a toggle, where the slope is below
            // 1e-6, the slope is rounding.
            let table = reduced.coordinates();
            let table = table.map_err(|at| ModelError::Table {
                name: variable.clone(),
                position: reduced.curve().describe(at.sigma, revolutions),
            })?;
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
        let state_loads = state_loads(reduced, inputs, revolutions)?;
        let sizes = reduced.sizes(&inputs.reals);
        let mut state = Self {
            sigma,
            sigma_dot,
            revolutions,
            contact: Contact::at_start(resting),
            travel,
            before: sizes.clone(),
            applied: sizes,
            airspeed: airspeed(reduced, inputs),
            reference: 0.0,
            memory: Memory::new(state_loads.is_some()),
            scratch: Scratch::new(state_loads),
        };
        state.reference = state.kinetic() + state.load_potential(reduced);
        Ok(state)
    }

    /// Advance by exactly `h` [s] under these inputs. On an error the state is what it was.
    ///
    /// # Errors
    /// The integration stopped, friction locks, the travel of an open curve without stops ended.
    pub fn step(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64, tolerance: f64) -> Result<(), ModelError> {
        let (airspeed, reference) = (self.airspeed, self.reference);
        let (state_loads, changed) = self.apply(reduced, inputs)?;
        let advanced = self.advance((reduced, state_loads), inputs, h, tolerance);
        if inputs.signal.ahead {
            self.right_hand_side_changed();
        }
        let arrived = advanced.and_then(|arrival| self.arrive(reduced, arrival));
        arrived.map_err(|failure| {
            self.undo(reduced, changed, airspeed, reference);
            match failure {
                Failure::Stopped(Stopped::Integration(error)) => ModelError::Integration(error),
                Failure::Stopped(Stopped::Locked) => ModelError::Locked { position: self.describe(reduced) },
                Failure::Travel { sigma } => {
                    ModelError::Travel { position: reduced.curve().describe(sigma, self.revolutions) }
                }
            }
        })
    }

    /// The state at the end of a step of `h` [s], with the loads and the airspeed applied.
    #[inline]
    fn advance(
        &mut self,
        (reduced, state_loads): (&Reduced, Option<&StateLoads>),
        inputs: &Inputs,
        h: f64,
        tolerance: f64,
    ) -> Result<Arrival, Failure> {
        let ends = &self.ends(reduced, &inputs.locks);
        let mut contact = self.contact;
        contact.locks_set(ends.locked);
        let change = inputs.change(reduced);
        let applied =
            AppliedLoads { sizes: &self.applied, airspeed: self.airspeed, revolutions: self.revolutions, change };
        let (scratch, mode) = (&mut self.scratch, Mode::default());
        let dynamics = &mut EquationOfMotion { reduced, state_loads, applied, time: 0.0, mode, scratch, locked: false };
        let progress = Progress::default();
        let (y, lost) = match &mut self.memory {
            Memory::Conservative(integrator) => {
                let mut y = [self.sigma, self.sigma_dot];
                let lost = if ends.travel.iter().all(Option::is_none) {
                    integrator.advance(dynamics, &mut y, h, tolerance).map(|()| 0.0).map_err(Stopped::Integration)
                } else {
                    let (lookahead, contact) = (&mut Lookahead::default(), &mut contact);
                    Advance { dynamics, integrator, lookahead, ends, contact, tolerance, progress }.run(&mut y, h)
                };
                (y, lost?)
            }
            Memory::WithDissipation(integrator, lookahead) => {
                if lookahead.begin(Conditions { tolerance, locked: ends.locked }) {
                    integrator.branch_off();
                }
                let mut z = [self.sigma, self.sigma_dot, 0.0];
                let (ahead, contact) = (&mut *lookahead, &mut contact);
                let advance = Advance { dynamics, integrator, lookahead: ahead, ends, contact, tolerance, progress };
                let lost = advance.run(&mut z, h);
                lookahead.end();
                ([z[0], z[1]], lost? + z[2])
            }
        };
        Ok(Arrival { y, lost, contact })
    }

    /// Take over the state at the end of a step, with sigma within the curve.
    #[inline]
    fn arrive(&mut self, reduced: &Reduced, Arrival { mut y, lost, contact }: Arrival) -> Result<(), Failure> {
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
            None if !(first..=last).contains(&y[0]) => return Err(Failure::Travel { sigma: y[0] }),
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

    /// Counts of the integration's work since the start.
    pub fn statistics(&self) -> Statistics {
        self.memory.statistics()
    }

    /// Whole revolutions of a closed curve made so far.
    pub fn revolutions(&self) -> f64 {
        self.revolutions
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
        let state_loads = state_loads(reduced, inputs, self.revolutions)?;
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
        if state_loads.is_some_and(|s| s.air) != self.scratch.air {
            self.scratch = Scratch::new(state_loads);
            self.memory.restart();
        }
        self.memory.set_dissipation(state_loads.is_some() || inputs.signal.ahead);
        if airspeed.to_bits() != self.airspeed.to_bits() {
            self.airspeed = airspeed;
            changed = true;
        }
        if changed {
            self.reference += work;
            self.before.copy_from_slice(&self.applied);
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
        self.applied.copy_from_slice(&self.before);
        self.reference = reference;
        self.airspeed = airspeed;
        // These state loads exist: they were in use before this step.
        let state_loads = state_loads_in_air(reduced, airspeed, self.revolutions).unwrap_or_default();
        if state_loads.is_some_and(|s| s.air) != self.scratch.air {
            self.scratch = Scratch::new(state_loads);
        }
        self.memory.set_dissipation(state_loads.is_some());
        self.scratch.panel_force.invalidate();
    }
}

/// Refuse a start beyond a stop of the body whose angle states the start; before the search for the start, as the curve
/// may end at that stop.
fn not_beyond_stop(reduced: &Reduced, mechanism: &Mechanism, body: &str, angle: f64) -> Result<(), ModelError> {
    let Some((carrier, own)) = reduced.linkage().carrier(mechanism, body) else { return Ok(()) };
    let loading = reduced.loading();
    let own_stops =
        loading.stops.iter().filter(|s| s.enabled && loading.loads[s.load] == Load::Torque { body: carrier });
    for stop in own_stops {
        beyond_stop(stop, angle - own)?;
    }
    Ok(())
}
