//! The state of motion, and how it goes on.
use crate::integrator::{Integrator, Statistics};
use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::dynamics::state_loads::Mode;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::motion::advance::{Stopped, advance};
use crate::mechanism::motion::events::{Contact, Surroundings};
use crate::mechanism::motion::step_ahead::{Conditions, Lookahead};
use crate::mechanism::motion::travel::{Travel, beyond_stop, can_hold, travel};
use crate::mechanism::outputs::Cache;
use crate::mechanism::reduced::{Reduced, ReductionError, StateLoads};
use crate::mechanism::{ModelError, dynamics::inputs::Inputs};
use crate::numerics::table::Unresolved;

/// The state of motion, with the memory of the integration.
#[derive(Clone, Debug)]
pub struct State {
    /// Length along the curve; on a closed one within its first turn.
    pub sigma: f64,
    pub sigma_dot: f64,
    /// Whole turns of a closed curve made so far.
    pub revolutions: f64,
    /// What the ends of the travel do.
    pub contact: Contact,
    /// Ends of the travel.
    pub travel: Travel,
    /// Sizes of the loads in the last step: those that the integration and the energy balance know.
    pub applied: Vec<f64>,
    /// Sizes before the last change of them: what a step that fails returns to.
    pub(super) before: Vec<f64>,
    /// Speed of the air in the last step [m/s].
    pub(super) airspeed: f64,
    /// Energy at the start, plus the work of changing sizes, less the energy lost since.
    pub reference: f64,
    pub(super) memory: Memory,
    /// Right-hand side for the applied sizes, for the integration.
    pub(super) scratch: Scratch,
    pub cache: Cache,
}

/// Memory of the integration.
#[expect(clippy::large_enum_variant, reason = "a step allocates nothing, so there is no box")]
#[derive(Clone, Copy, Debug)]
pub(super) enum Memory {
    /// No power is lost: the state is (sigma, sigma_dot).
    Conservative(Integrator<2>),
    /// The energy lost is integrated too, and steps may go on beyond the present.
    WithDissipation(Integrator<3>, Lookahead<3>),
}

impl Memory {
    pub(super) fn new(with_dissipation: bool) -> Self {
        if with_dissipation {
            Self::WithDissipation(Integrator::default(), Lookahead::default())
        } else {
            Self::Conservative(Integrator::default())
        }
    }

    /// Take up or leave off the energy lost; it is counted in steps with a scene, and in those with inputs that change.
    pub(super) fn suit(&mut self, with_dissipation: bool) {
        match self {
            Self::Conservative(i) if with_dissipation => {
                *self = Self::WithDissipation(i.with_components(), Lookahead::default())
            }
            Self::WithDissipation(i, _) if !with_dissipation => *self = Self::Conservative(i.with_components()),
            _ => {}
        }
    }

    pub(super) fn statistics(&self) -> Statistics {
        match self {
            Self::Conservative(i) => i.statistics(),
            Self::WithDissipation(i, _) => i.statistics(),
        }
    }

    /// Become the same as another one; copies no more than that one is.
    pub(super) fn copy_from(&mut self, other: &Self) {
        match (self, other) {
            (Self::Conservative(own), Self::Conservative(other)) => own.copy_from(other),
            (Self::WithDissipation(own, own_ahead), Self::WithDissipation(other, other_ahead)) => {
                own.copy_from(other);
                own_ahead.copy_from(other_ahead);
            }
            (own, other) => *own = *other,
        }
    }

    /// Forget all but the statistics.
    pub(super) fn restart(&mut self) {
        match self {
            Self::Conservative(i) => i.restart(),
            Self::WithDissipation(i, ahead) => {
                i.restart();
                ahead.forget();
            }
        }
    }

    /// sigma is counted anew.
    pub(super) fn recount(&mut self) {
        if let Self::WithDissipation(i, ahead) = self
            && ahead.step_ahead.take().is_some()
        {
            i.branch_off();
        }
    }

    /// The right-hand side has changed.
    pub(super) fn refresh(&mut self) {
        match self {
            Self::Conservative(i) => i.refresh(),
            Self::WithDissipation(i, ahead) => {
                if ahead.forget() {
                    i.branch_off();
                }
                i.refresh();
            }
        }
    }
}

/// Whether air that flows at this speed acts on the surfaces.
pub(super) fn blows(reduced: &Reduced, speed: f64) -> bool {
    reduced.loading().air.as_ref().is_some_and(|air| air.relative_wind || speed != 0.0)
}

/// Speed of the air under these inputs.
pub fn airspeed(reduced: &Reduced, inputs: &Inputs) -> f64 {
    reduced.loading().air.as_ref().and(inputs.reals.last().copied()).unwrap_or(0.0)
}

/// What acts under these inputs besides loads of given sizes.
///
/// # Errors
/// [`Unresolved`]: a reaction that causes friction is not smooth.
pub fn state_loads_under<'a>(reduced: &'a Reduced, inputs: &Inputs) -> Result<Option<&'a StateLoads>, &'a Unresolved> {
    let changes = || inputs.change(reduced).is_some_and(|change| change.airspeed != [0.0; 2]);
    reduced.state_loads(blows(reduced, airspeed(reduced, inputs)) || (reduced.loading().air.is_some() && changes()))
}

/// [`evaluator`], with the error told after so many turns.
pub(super) fn state_loads<'a>(
    reduced: &'a Reduced,
    inputs: &Inputs,
    revolutions: f64,
) -> Result<Option<&'a StateLoads>, ModelError> {
    state_loads_under(reduced, inputs).map_err(|at| told(reduced, at, revolutions))
}

/// What acts in air of this speed.
///
/// # Errors
/// As [`state_loads`].
pub(super) fn state_loads_in_air(
    reduced: &Reduced,
    speed: f64,
    revolutions: f64,
) -> Result<Option<&StateLoads>, ModelError> {
    reduced.state_loads(blows(reduced, speed)).map_err(|at| told(reduced, at, revolutions))
}

fn told(reduced: &Reduced, at: &Unresolved, revolutions: f64) -> ModelError {
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
                let turn = linkage.bodies[carrier].angle_coordinate;
                let value = start.angle.unwrap_or(0.0) - angle - linkage.bodies[carrier].offset;
                (turn, value, body, "angle")
            }
            (None, Some(joint)) => {
                let place = linkage.coordinates[linkage.angles..].iter().position(|c| c == joint);
                (place.map(|i| i + linkage.angles), start.position.unwrap_or(0.0), joint, "position")
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
            // From the table, which is as good where branches cross. Nearer to a toggle than some 1e-13 rad, where the
            // slope is below 1e-6, rounding decides what it is.
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
            contact: Contact { resting, touching: [None; 2] },
            travel,
            before: sizes.clone(),
            applied: sizes,
            airspeed: airspeed(reduced, inputs),
            reference: 0.0,
            memory: Memory::new(state_loads.is_some()),
            scratch: Scratch::new(state_loads),
            cache: Cache::new(reduced, state_loads, &inputs.reals),
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
        let around = self.surroundings(reduced, &inputs.locks);
        let mut contact = self.contact;
        let change = inputs.change(reduced);
        let given =
            AppliedLoads { sizes: &self.applied, airspeed: self.airspeed, revolutions: self.revolutions, change };
        let (scratch, mode) = (&mut self.scratch, Mode::default());
        let mut motion = EquationOfMotion { reduced, state_loads, given, time: 0.0, mode, scratch, locked: false };
        let (y, lost) = match &mut self.memory {
            Memory::Conservative(integrator) => {
                let mut y = [self.sigma, self.sigma_dot];
                let lost = if around.travel == [None; 2] {
                    integrator.advance(&mut motion, &mut y, h, tolerance).map(|()| 0.0).map_err(Stopped::Integration)
                } else {
                    let never = &mut Lookahead::default();
                    advance(integrator, never, &mut motion, &around, &mut contact, &mut y, h, tolerance)
                };
                (y, lost)
            }
            Memory::WithDissipation(integrator, lookahead) => {
                if lookahead.begin(Conditions { tolerance, locked: around.locked }) {
                    integrator.branch_off();
                }
                let mut z = [self.sigma, self.sigma_dot, 0.0];
                let lost = advance(integrator, lookahead, &mut motion, &around, &mut contact, &mut z, h, tolerance);
                lookahead.end();
                ([z[0], z[1]], lost.map(|lost| lost + z[2]))
            }
        };
        if change.is_some() {
            self.memory.refresh();
            self.scratch.panel_force.forget();
        }
        let lost = match lost {
            Ok(lost) => lost,
            Err(stopped) => {
                self.undo(reduced, changed, airspeed, reference);
                return Err(match stopped {
                    Stopped::Integration(error) => ModelError::Integration(error),
                    Stopped::Locked => ModelError::Locked { position: self.describe(reduced) },
                });
            }
        };
        let mut y = y;
        let (first, last) = reduced.curve().range();
        match reduced.period() {
            Some(period) if !(first..last).contains(&y[0]) => {
                let around = ((y[0] - first) / period).floor();
                y[0] -= around * period;
                self.revolutions += around;
                // The panel in memory is counted on over whole turns, as is a step ahead; sigma no longer is.
                self.memory.recount();
                self.scratch.panel_force.forget();
                self.cache.recount();
            }
            None if !(first..=last).contains(&y[0]) => {
                let position = reduced.curve().describe(y[0], self.revolutions);
                self.undo(reduced, changed, airspeed, reference);
                return Err(ModelError::Travel { position });
            }
            _ => {}
        }
        [self.sigma, self.sigma_dot] = y;
        self.contact = contact;
        self.reference -= lost;
        self.cache.forget();
        Ok(())
    }

    /// The ends of the travel in the frame of sigma, and whether a lock is engaged at each.
    pub fn surroundings(&self, reduced: &Reduced, locks: &[bool]) -> Surroundings {
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
        Surroundings { travel, locked }
    }

    /// Whether the mechanism is at a stop: in contact with it, or held there.
    pub fn at_stop(&self, reduced: &Reduced, stop: usize) -> bool {
        let here = self.sigma + self.revolutions * reduced.period().unwrap_or(0.0);
        (0..2).any(|side| {
            let outward = if side == 0 { -1.0 } else { 1.0 };
            self.travel[side].is_some_and(|e| e.stop == stop && (here - e.position) * outward >= 0.0)
        })
    }

    /// Work done so far.
    pub fn statistics(&self) -> Statistics {
        self.memory.statistics()
    }

    /// Turns of the curve so far, from its beginning.
    pub fn revolutions(&self) -> f64 {
        self.revolutions
    }

    /// Where the linkage is.
    pub fn describe(&self, reduced: &Reduced) -> String {
        reduced.curve().describe(self.sigma, self.revolutions)
    }

    /// Take up inputs that have changed since the last step: the change of the loads' potential is work from outside. Tells
    /// whether any has.
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
        self.memory.suit(state_loads.is_some() || inputs.signal.ahead);
        if airspeed.to_bits() != self.airspeed.to_bits() {
            self.airspeed = airspeed;
            changed = true;
        }
        if inputs.signal.ahead {
            self.memory.refresh();
            self.scratch.panel_force.forget();
        }
        if changed {
            self.reference += work;
            self.before.copy_from_slice(&self.applied);
            self.applied[..loads].copy_from_slice(&inputs.reals[..loads]);
            self.memory.refresh();
            self.scratch.panel_force.forget();
        }
        Ok((state_loads, changed))
    }

    /// After a step that failed: what [`Self::apply`] has changed is as it was; the integration begins anew.
    #[cold]
    fn undo(&mut self, reduced: &Reduced, changed: bool, airspeed: f64, reference: f64) {
        self.memory.restart();
        if !changed {
            return;
        }
        self.applied.copy_from_slice(&self.before);
        self.reference = reference;
        self.airspeed = airspeed;
        // It is at hand: it was in use before this step.
        let state_loads = state_loads_in_air(reduced, airspeed, self.revolutions).unwrap_or_default();
        if state_loads.is_some_and(|s| s.air) != self.scratch.air {
            self.scratch = Scratch::new(state_loads);
        }
        self.memory.suit(state_loads.is_some());
        self.scratch.panel_force.forget();
    }
}

/// A stop for the body that states the start is told of before the start is looked for: the curve may end there.
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
