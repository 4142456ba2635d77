//! Outputs on demand: each from its table, at the present state, under the present inputs.
mod reaction;
mod slopes;

use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::dynamics::state_loads::Mode;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::motion::advance::rests;
use crate::mechanism::motion::state::{State, airspeed, state_loads_under};
use crate::mechanism::outputs::reaction::JointReaction;
use crate::mechanism::outputs::slopes::Slopes;
use crate::mechanism::quantity::{OneElement, Output, ReactionPart};
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::mechanism::rigid_fem::RigidFemError;
use crate::numerics::bits::same_bits;
use crate::numerics::table::{Table, TablePosition, Unresolved};

/// Why an output cannot be told.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputError {
    /// Its table cannot be built.
    Table(Unresolved),
    /// Friction and reactions have no common solution.
    Locked,
    /// The finite elements' forces are not finite.
    RigidFem(RigidFemError),
}

impl From<RigidFemError> for OutputError {
    fn from(e: RigidFemError) -> Self {
        Self::RigidFem(e)
    }
}

impl From<Unresolved> for OutputError {
    fn from(at: Unresolved) -> Self {
        Self::Table(at)
    }
}

impl From<Locked> for OutputError {
    fn from(_: Locked) -> Self {
        Self::Locked
    }
}

/// What several outputs of one state share.
#[derive(Clone, Debug)]
pub struct Cache {
    /// What acts and follows, once evaluated.
    pub(super) effect: Option<Forces>,
    /// Place in the table of the coordinates, once found in this state.
    spot: Option<TablePosition>,
    /// Panel in which it was last.
    panel: usize,
    /// What each joint transmits.
    pub(super) reactions: Vec<JointReaction>,
    /// Whether a reaction has been computed in this state.
    pub(super) used: bool,
    /// What has been computed since the start.
    pub(super) computed: Computed,
    /// Sizes of the sized loads under the present inputs.
    pub(super) sizes: Vec<f64>,
    /// Right-hand side for these sizes.
    pub(super) scratch: Scratch,
    /// Room for derivatives, once asked for.
    pub(super) slopes: Option<Box<Slopes>>,
}

/// How often outputs have made something be computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Computed {
    /// What acts in a state: the acceleration, and what friction, drag and stops do.
    pub effects: u64,
    /// Reactions of a joint.
    pub reactions: u64,
}

/// What acts in a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forces {
    /// sigma_ddot of the motion.
    pub acceleration: f64,
    /// sigma_ddot if nothing held the mechanism at an end of its travel.
    free: f64,
    /// Direction in which the drives with an efficiency work; 0 if they hold the mechanism.
    pub direction: f64,
    /// End at which it is held.
    pub held: Option<usize>,
    /// Whether the stop there holds it; else a lock.
    pub by_stop: bool,
}

impl Cache {
    pub fn new(reduced: &Reduced, state_loads: Option<&StateLoads>, inputs: &[f64]) -> Self {
        Self {
            effect: None,
            spot: None,
            panel: 0,
            reactions: vec![JointReaction::new(); reduced.linkage().joints.len()],
            used: false,
            computed: Computed::default(),
            sizes: reduced.sizes(inputs),
            scratch: Scratch::new(state_loads),
            slopes: None,
        }
    }

    /// The state has changed.
    pub fn forget(&mut self) {
        (self.effect, self.spot) = (None, None);
        if self.used {
            self.reactions.iter_mut().for_each(|t| t.value = None);
            self.used = false;
        }
    }

    /// An input has changed; those beyond the sized loads size nothing.
    pub fn set(&mut self, input: usize, loads: usize, value: f64) {
        if input < loads {
            self.sizes[input] = value;
            self.refold();
        }
        self.forget();
    }

    /// State and inputs are others; these size loads.
    pub fn renew(&mut self, sizes: &[f64]) {
        if !same_bits(sizes, &self.sizes[..sizes.len()]) {
            self.sizes[..sizes.len()].copy_from_slice(sizes);
            self.refold();
        }
        self.forget();
    }

    fn refold(&mut self) {
        self.scratch.panel_force.forget();
        self.reactions.iter_mut().for_each(JointReaction::forget);
    }

    /// The way in which sigma is counted has changed.
    pub fn recount(&mut self) {
        self.scratch.panel_force.forget();
    }
}

impl State {
    /// Value of an output under these inputs.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn output(&mut self, reduced: &Reduced, inputs: &Inputs, output: Output) -> Result<f64, OutputError> {
        match output {
            Output::Angle { body, order } => {
                let body = &reduced.linkage().bodies[body];
                let Some(turn) = body.angle_coordinate else { return Ok(0.0) };
                let value = self.coordinate(reduced, inputs, turn, order)?;
                Ok(if order == 0 { value + body.offset } else { value })
            }
            Output::JointPosition { coordinate, order } => self.coordinate(reduced, inputs, coordinate, order),
            Output::Reaction { joint, part } => {
                let [x, y, moment] = self.reaction(reduced, inputs, joint)?;
                Ok(match part {
                    ReactionPart::X => x,
                    ReactionPart::Y => y,
                    ReactionPart::Magnitude => magnitude(x, y),
                    ReactionPart::Moment => moment,
                })
            }
            Output::Displacement { load, order: 0 } => Ok(self.displacement(reduced, load)),
            Output::Displacement { load, order } => {
                let table = checked(reduced.displacement(load))?;
                let spot = table.position(self.sigma);
                self.derivative((table, spot), 0, reduced, inputs, order)
            }
            Output::OneElement { drive, term } => self.one_element(reduced, inputs, drive, term),
            Output::SpringForce { spring } => self.spring_force(reduced, spring),
            Output::Marker { marker, axis, order } => {
                let table = checked(reduced.marker(marker))?;
                let spot = table.position(self.sigma);
                self.derivative((table, spot), 3 * axis, reduced, inputs, order)
            }
            Output::Friction { friction_joint } => {
                self.effect(reduced, inputs)?;
                let load = reduced.loading().friction.as_ref().map(|f| f.friction_joints[friction_joint].load);
                Ok(load.map_or(0.0, |load| self.of_state(reduced, load)))
            }
            Output::Drag { surface } => {
                self.effect(reduced, inputs)?;
                let Some(air) = &reduced.loading().air else { return Ok(0.0) };
                let load = air.surfaces[surface].load;
                Ok(air.flow.x * self.of_state(reduced, load) + air.flow.y * self.of_state(reduced, load + 1))
            }
            Output::Stop { stop } => {
                self.effect(reduced, inputs)?;
                let load = reduced.loading().stops[stop].load;
                Ok(self.of_state(reduced, load) + self.of_stop(reduced, stop))
            }
            Output::Lock { lock } => {
                self.effect(reduced, inputs)?;
                Ok(self.of_lock(reduced, inputs, lock))
            }
            Output::Kinetic => Ok(self.kinetic()),
            Output::Potential => {
                let gravity = match reduced.loading().gravity {
                    Some(load) => -inputs.reals[load] * self.displacement(reduced, load),
                    None => 0.0,
                };
                Ok(gravity + self.spring_energy(reduced))
            }
            Output::Drift => Ok(self.kinetic() + self.load_potential(reduced) - self.reference),
        }
    }

    /// T = sigma_dot^2 / 2 [J]: sigma is the length in the kinetic metric.
    pub fn kinetic(&self) -> f64 {
        0.5 * self.sigma_dot * self.sigma_dot
    }

    /// Potential of all loads at the applied sizes: less the sum of size times displacement, and the springs' energy [J].
    pub fn load_potential(&self, reduced: &Reduced) -> f64 {
        let mut sum = self.spring_energy(reduced);
        for (load, size) in self.applied.iter().enumerate() {
            if *size != 0.0 {
                sum -= size * self.displacement(reduced, load);
            }
        }
        sum
    }

    fn spring_energy(&self, reduced: &Reduced) -> f64 {
        let mut sum = 0.0;
        for spring in &reduced.loading().springs {
            sum += spring.energy(self.displacement(reduced, spring.load));
        }
        sum
    }

    /// Displacement of a load, counted on over whole turns.
    pub fn displacement(&self, reduced: &Reduced, load: usize) -> f64 {
        let growth = if self.revolutions == 0.0 { 0.0 } else { self.revolutions * reduced.load_growth(load) };
        reduced.displacement_at(load, self.sigma) + growth
    }

    pub(super) fn spring_force(&self, reduced: &Reduced, spring: usize) -> Result<f64, OutputError> {
        let spring = &reduced.loading().springs[spring];
        let spring_force = spring.force(self.displacement(reduced, spring.load));
        if spring.damping == 0.0 {
            return Ok(spring_force);
        }
        let table = checked(reduced.displacement(spring.load))?;
        Ok(spring_force + spring.damping * table.value(table.position(self.sigma), 1) * self.sigma_dot)
    }

    fn influence(&self, reduced: &Reduced, load: usize) -> f64 {
        let table = reduced.influence();
        table.value(table.position(self.sigma), load)
    }

    /// Call `with` with the motion under the present inputs and the scene it is in.
    pub(super) fn moving<R>(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        with: impl FnOnce(&mut EquationOfMotion, Option<&StateLoads>) -> R,
    ) -> Result<R, OutputError> {
        let state_loads = state_loads_under(reduced, inputs).map_err(Clone::clone)?;
        let cache = &mut self.cache;
        if state_loads.is_some_and(|s| s.air) != cache.scratch.air {
            cache.scratch = Scratch::new(state_loads);
        }
        let airspeed = airspeed(reduced, inputs);
        let given = AppliedLoads { sizes: &cache.sizes, airspeed, revolutions: self.revolutions, change: None };
        let mode = Mode { touching: self.contact.touching, ..Mode::default() };
        let mut motion = EquationOfMotion {
            reduced,
            state_loads,
            given,
            time: 0.0,
            mode,
            scratch: &mut cache.scratch,
            locked: false,
        };
        Ok(with(&mut motion, state_loads))
    }

    /// What acts under the present inputs; evaluated once for a state.
    pub(super) fn effect(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<Forces, OutputError> {
        if let Some(effect) = self.cache.effect {
            return Ok(effect);
        }
        let (sigma, sigma_dot, resting) = (self.sigma, self.sigma_dot, self.contact.resting);
        let around = resting.map(|side| (side, self.surroundings(reduced, &inputs.locks)));
        let effect = self.moving(reduced, inputs, |motion, _| {
            let free = motion.settle(sigma, sigma_dot)?;
            let direction = motion.mode.direction;
            let mut effect = Forces { acceleration: free, free, direction, held: None, by_stop: false };
            if let Some((side, around)) = around {
                let pressed = rests(motion, &around, side, sigma)?;
                if pressed || around.locked[side] {
                    effect = Forces { acceleration: 0.0, held: Some(side), by_stop: pressed, ..effect };
                }
            }
            Ok::<_, Locked>(effect)
        })??;
        self.cache.effect = Some(effect);
        self.cache.computed.effects += 1;
        Ok(effect)
    }

    /// Size of a load that the state decides, as last evaluated.
    fn of_state(&self, reduced: &Reduced, load: usize) -> f64 {
        let state_loads = reduced.state_loads(self.cache.scratch.air).ok().flatten();
        let place = state_loads.and_then(|s| s.loads.iter().position(|l| *l == load));
        place.map_or(0.0, |k| self.cache.scratch.evaluator.loads[k])
    }

    /// Force or torque with which a rigid stop holds the mechanism.
    pub(super) fn of_stop(&self, reduced: &Reduced, stop: usize) -> f64 {
        match self.cache.effect {
            Some(Forces { held: Some(side), by_stop: true, free, .. })
                if self.travel[side].is_some_and(|e| e.stop == stop) =>
            {
                let load = reduced.loading().stops[stop].load;
                let slope = reduced.displacement(load).map_or(f64::NAN, |t| t.value(t.position(self.sigma), 1));
                finite(-free / slope)
            }
            _ => 0.0,
        }
    }

    /// Force with which a lock holds the mechanism, along the path of its point; positive towards the stop.
    pub(super) fn of_lock(&self, reduced: &Reduced, inputs: &Inputs, lock: usize) -> f64 {
        let loading = reduced.loading();
        match self.cache.effect {
            Some(Forces { held: Some(side), by_stop: false, free, .. })
                if self.travel[side].is_some_and(|e| e.stop == loading.locks[lock].stop) && inputs.locks[lock] =>
            {
                let outward = if side == 0 { -1.0 } else { 1.0 };
                // Several locks at one stop share the load evenly along the curve.
                let stop = loading.locks[lock].stop;
                let engaged = loading.locks.iter().zip(&inputs.locks).filter(|(l, on)| **on && l.stop == stop).count();
                let path = reduced.lock_path(lock, self.sigma);
                finite(-free * outward / (path.norm() * engaged as f64))
            }
            _ => 0.0,
        }
    }

    /// A coordinate (order 0) or its time derivative.
    #[inline]
    fn coordinate(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        coordinate: usize,
        order: usize,
    ) -> Result<f64, OutputError> {
        let table = checked(reduced.coordinates())?;
        let spot = match self.cache.spot {
            Some(spot) => spot,
            None => {
                let spot = table.position_near(self.sigma, self.cache.panel);
                (self.cache.spot, self.cache.panel) = (Some(spot), spot.panel);
                spot
            }
        };
        let value = self.derivative((table, spot), 3 * coordinate, reduced, inputs, order)?;
        Ok(if order == 0 { value + self.revolutions * reduced.growth(coordinate) } else { value })
    }

    /// Time derivative of a function whose table has it and its two derivatives along sigma from component `first` on.
    #[inline]
    fn derivative(
        &mut self,
        (table, spot): (&Table, TablePosition),
        first: usize,
        reduced: &Reduced,
        inputs: &Inputs,
        order: usize,
    ) -> Result<f64, OutputError> {
        Ok(match order {
            0 => table.value(spot, first),
            1 => table.value(spot, first + 1) * self.sigma_dot,
            _ => {
                let acceleration = self.effect(reduced, inputs)?.acceleration;
                let bend = table.value(spot, first + 2);
                table.value(spot, first + 1) * acceleration + bend * self.sigma_dot * self.sigma_dot
            }
        })
    }

    /// What arrives of a sized load, after the loss of its drive if it has one; as last evaluated.
    pub(super) fn delivered(&self, reduced: &Reduced, load: usize) -> f64 {
        let state_loads = reduced.state_loads(self.cache.scratch.air).ok().flatten();
        let place = state_loads.and_then(|s| s.drives_with_efficiency.iter().position(|l| *l == load));
        place.map_or(self.cache.sizes[load], |k| self.cache.scratch.evaluator.delivered[k])
    }

    /// Force along sigma of everything but one drive: in the present motion, or at rest without friction and losses.
    fn others(&mut self, reduced: &Reduced, inputs: &Inputs, drive: usize, moving: bool) -> Result<f64, OutputError> {
        let influence = self.influence(reduced, drive);
        if moving {
            let free = self.effect(reduced, inputs)?.free;
            return Ok(free - self.delivered(reduced, drive) * influence);
        }
        let sigma = self.sigma;
        let at_rest = self.moving(reduced, inputs, |motion, _| motion.heading(0.0, sigma, 0.0))??;
        let force = at_rest - self.delivered(reduced, drive) * influence;
        // The evaluation at rest has taken the place of that in motion.
        self.cache.effect = None;
        Ok(force)
    }

    /// Force along sigma that a drive must give, where friction depends on it: for an acceleration along the curve, or to
    /// begin to move in a direction. The other drives lose by [`toward`], so that what this one gives at present has no part.
    fn inverse(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        drive: usize,
        acceleration: f64,
        breakaway: Option<f64>,
    ) -> Result<f64, OutputError> {
        let (sigma, sigma_dot) = (self.sigma, if breakaway.is_some() { 0.0 } else { self.sigma_dot });
        let direction = breakaway.unwrap_or(toward(sigma_dot, acceleration));
        let influence = self.influence(reduced, drive);
        self.cache.effect = None;
        self.moving(reduced, inputs, |motion, state_loads| {
            let free = motion.heading(direction, sigma, sigma_dot)?;
            let Some(state_loads) = state_loads else {
                let size = motion.given.sizes[drive];
                return Ok(acceleration - (free - size * influence));
            };
            let with_efficiency = state_loads.drives_with_efficiency.iter().position(|l| *l == drive);
            let scratch = &mut *motion.scratch;
            let size = with_efficiency.map_or(motion.given.sizes[drive], |k| scratch.evaluator.delivered[k]);
            scratch.evaluator.required(state_loads, &scratch.panel_force, sigma, (drive, size), acceleration, breakaway)
        })?
        .map_err(OutputError::from)
    }

    /// A term of the mechanism reduced to a drive. With S the drive's displacement, m_zS = 1 / S_sigma^2, because the
    /// reduced inertia along sigma is 1.
    fn one_element(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        drive: usize,
        term: OneElement,
    ) -> Result<f64, OutputError> {
        let table = checked(reduced.displacement(drive))?;
        let spot = table.position(self.sigma);
        let (slope, bend) = (table.value(spot, 1), table.value(spot, 2));
        let speed = slope * self.sigma_dot;
        let efficiency = reduced.loading().drives[drive].efficiency;
        // [CK16] 2.3: eta divides where power flows in and multiplies where it flows back; at rest it divides.
        let with_efficiency = |power: f64, value: f64| match efficiency {
            Some(eta) if power < 0.0 => value * eta,
            Some(eta) => value / eta,
            None => value,
        };
        let present = self.cache.sizes[drive] * speed;
        let value = match term {
            OneElement::ReducedMass => with_efficiency(present, 1.0 / (slope * slope)),
            OneElement::ReducedMassDerivative => with_efficiency(present, -2.0 * bend / slope.powi(4)),
            OneElement::StaticLoad => with_efficiency(present, -self.others(reduced, inputs, drive, true)? / slope),
            OneElement::AdditionalForce => with_efficiency(present, bend * (self.sigma_dot / slope).powi(2)),
            OneElement::RequiredForce => {
                let demand = inputs.reals.get(reduced.loading().inputs.len() + drive).copied().unwrap_or(0.0);
                let acceleration = (demand - bend * self.sigma_dot * self.sigma_dot) / slope;
                let force = self.inverse(reduced, inputs, drive, acceleration, None)? / slope;
                let moving = if speed == 0.0 { demand } else { speed };
                with_efficiency(force * moving, force)
            }
            OneElement::HoldingForce => {
                let others = self.others(reduced, inputs, drive, false)?;
                if others == 0.0 { 0.0 } else { -others / slope }
            }
            OneElement::BreakawayForward | OneElement::BreakawayBackward => {
                let forward = if term == OneElement::BreakawayForward { 1.0 } else { -1.0 };
                let force = self.inverse(reduced, inputs, drive, 0.0, Some(forward * slope.signum()))? / slope;
                with_efficiency(force * forward, force)
            }
        };
        Ok(finite(value))
    }
}

pub(super) fn checked<'a>(table: Result<&'a Table, &Unresolved>) -> Result<&'a Table, Unresolved> {
    table.map_err(Clone::clone)
}

/// Direction in which the mechanism moves, or sets off from rest: that of sigma_ddot; 0 if it stays at rest.
pub(super) fn toward(sigma_dot: f64, acceleration: f64) -> f64 {
    match if sigma_dot == 0.0 { acceleration } else { sigma_dot } {
        0.0 => 0.0,
        rate => rate.signum(),
    }
}

/// Length of a vector; where the squares leave the range of numbers, by the slower way.
fn magnitude(x: f64, y: f64) -> f64 {
    let square = x * x + y * y;
    if square.is_normal() { square.sqrt() } else { x.hypot(y) }
}

/// At a dead centre of a drive no finite force or mass has the effect, and at some flat positions no finite reaction: the
/// largest finite number stands for it.
#[inline]
pub(super) fn finite(value: f64) -> f64 {
    if value.is_nan() { f64::MAX } else { value.clamp(-f64::MAX, f64::MAX) }
}
