//! Exact derivatives of outputs: along a direction in which the state and the inputs change.
//!
//! In: the state, d sigma / d s and d sigma_dot / d s, and du / d s of every Real input. Out: dy / d s of an output, by dual
//! numbers through the same scene, loop of friction and tables as the value. The directional derivative of FMI 2.0.5, 2.1.9
//! is one direction, the rate in time of 4.2.1 another.
//!
//! Where an output has no derivative, one is chosen: of the size of a reaction that is 0, and of a value at a dead centre
//! that stands for an infinite one, 0; at the border between two stretches of the law of friction that of the inner stretch;
//! of a drive with an efficiency that in the present direction. What is held at a stop or by a lock stays held.
use crate::mechanism::dynamics::input_polynomial::Change;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::{AppliedLoads, PanelForce};
use crate::mechanism::dynamics::state_loads::{Mode, StateLoadEvaluator};
use crate::mechanism::linkage::Freedom;
use crate::mechanism::motion::state::{State, airspeed, state_loads_under};
use crate::mechanism::outputs::reaction::part_of;
use crate::mechanism::outputs::{OutputError, checked, toward};
use crate::mechanism::quantity::{OneElement, Output, ReactionPart};
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::dual::{Dual, Number};
use crate::numerics::table::{Table, polynomial_at};

type D = Dual<1>;

const ZERO: D = Dual { value: 0.0, slope: [0.0] };

/// Room for derivatives, with the direction.
#[derive(Clone, Debug)]
pub struct Slopes {
    /// d sigma / d s and d sigma_dot / d s.
    along: [f64; 2],
    /// du / d s of the Real inputs.
    inputs: Vec<f64>,
    /// As many zeros: the inputs' second derivatives along s.
    none: Vec<f64>,
    panel_force: PanelForce,
    evaluator: StateLoadEvaluator<D>,
    /// Whether the room is for a scene with moving air.
    air: bool,
    effect: Option<Forces>,
    reactions: Vec<Option<[D; 3]>>,
}

/// What acts.
#[derive(Clone, Copy, Debug)]
struct Forces {
    acceleration: D,
    free: D,
    held: Option<usize>,
    by_stop: bool,
}

impl Slopes {
    fn new(reduced: &Reduced, state_loads: Option<&StateLoads>, inputs: usize) -> Self {
        Self {
            along: [0.0; 2],
            inputs: vec![0.0; inputs],
            none: vec![0.0; inputs],
            panel_force: PanelForce::new(state_loads),
            evaluator: StateLoadEvaluator::new(state_loads),
            air: state_loads.is_some_and(|s| s.air),
            effect: None,
            reactions: vec![None; reduced.linkage().joints.len()],
        }
    }
}

impl State {
    /// Go in a direction in which the state stays and the inputs change by `seeds`.
    pub fn head_for_inputs(&mut self, reduced: &Reduced, inputs: &Inputs, seeds: &dyn Fn(usize) -> f64) {
        let state_loads = state_loads_under(reduced, inputs).ok().flatten();
        let slopes = self.room(reduced, inputs, state_loads);
        slopes.along = [0.0; 2];
        slopes.inputs.iter_mut().enumerate().for_each(|(i, slope)| *slope = seeds(i));
    }

    /// Go in the direction of time.
    pub fn head_for_time(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<(), OutputError> {
        let along = [self.sigma_dot, self.effect(reduced, inputs)?.acceleration];
        let state_loads = state_loads_under(reduced, inputs).ok().flatten();
        let slopes = self.room(reduced, inputs, state_loads);
        slopes.along = along;
        slopes.inputs.copy_from_slice(&inputs.signal.first);
        Ok(())
    }

    /// Room in which nothing is known.
    fn room(&mut self, reduced: &Reduced, inputs: &Inputs, state_loads: Option<&StateLoads>) -> &mut Slopes {
        let air = state_loads.is_some_and(|s| s.air);
        let room = self.cache.slopes.take().filter(|s| s.air == air);
        let room = room.unwrap_or_else(|| Box::new(Slopes::new(reduced, state_loads, inputs.reals.len())));
        let slopes = self.cache.slopes.insert(room);
        slopes.panel_force.forget();
        slopes.effect = None;
        slopes.reactions.fill(None);
        slopes
    }

    /// Derivative of an output in the direction last stated.
    pub fn slope(&mut self, reduced: &Reduced, inputs: &Inputs, output: Output) -> Result<f64, OutputError> {
        let Some(mut slopes) = self.cache.slopes.take() else { return Ok(0.0) };
        let mut view = View { state: self, slopes: &mut slopes, reduced, inputs };
        let value = view.output(output);
        self.cache.slopes = Some(slopes);
        Ok(value?.slope[0])
    }
}

/// A state seen along a direction.
struct View<'a> {
    state: &'a mut State,
    slopes: &'a mut Slopes,
    reduced: &'a Reduced,
    inputs: &'a Inputs,
}

impl View<'_> {
    /// An output; [`State::output`] has the laws.
    fn output(&mut self, output: Output) -> Result<D, OutputError> {
        let reduced = self.reduced;
        let loading = reduced.loading();
        match output {
            Output::Angle { body, order } => match reduced.linkage().bodies[body].angle_coordinate {
                Some(turn) => self.derivative(checked(reduced.coordinates())?, 3 * turn, order),
                None => Ok(ZERO),
            },
            Output::JointPosition { coordinate, order } => {
                self.derivative(checked(reduced.coordinates())?, 3 * coordinate, order)
            }
            Output::Reaction { joint, part } => {
                let [x, y, moment] = self.reaction(joint)?;
                Ok(match part {
                    ReactionPart::X => x,
                    ReactionPart::Y => y,
                    ReactionPart::Magnitude => {
                        let size = x.value.hypot(y.value);
                        let inverse = if size > 0.0 { 1.0 / size } else { 0.0 };
                        let slope = (x.value * inverse) * x.slope[0] + (y.value * inverse) * y.slope[0];
                        Dual { value: size, slope: [slope] }
                    }
                    ReactionPart::Moment => moment,
                })
            }
            Output::Displacement { load, order: 0 } => Ok(self.displacement(load)),
            Output::Displacement { load, order } => self.derivative(checked(reduced.displacement(load))?, 0, order),
            Output::OneElement { drive, term } => self.one_element(drive, term),
            Output::SpringForce { spring } => self.spring_force(spring),
            Output::Marker { marker, axis, order } => {
                self.derivative(checked(reduced.marker(marker))?, 3 * axis, order)
            }
            Output::Friction { friction_joint } => {
                self.effect()?;
                Ok(loading.friction.as_ref().map_or(ZERO, |f| self.of_state(f.friction_joints[friction_joint].load)))
            }
            Output::Drag { surface } => {
                self.effect()?;
                let Some(air) = &loading.air else { return Ok(ZERO) };
                let load = air.surfaces[surface].load;
                Ok(scaled(self.of_state(load), air.flow.x) + scaled(self.of_state(load + 1), air.flow.y))
            }
            Output::Stop { stop } => {
                let effect = self.effect()?;
                Ok(self.of_state(loading.stops[stop].load) + self.of_stop(&effect, stop))
            }
            Output::Lock { lock } => {
                let effect = self.effect()?;
                Ok(self.of_lock(&effect, lock))
            }
            Output::Kinetic => Ok(scaled(self.speed() * self.speed(), 0.5)),
            Output::Potential => {
                let mut sum = loading.gravity.map_or(ZERO, |load| -(self.size(load) * self.displacement(load)));
                for spring in &loading.springs {
                    let s = self.displacement(spring.load);
                    sum = sum + s.chain(spring.energy(s.value), spring.force(s.value));
                }
                Ok(sum)
            }
            // The exact motion has none.
            Output::Drift => Ok(ZERO),
        }
    }

    fn sigma(&self) -> D {
        Dual { value: self.state.sigma, slope: [self.slopes.along[0]] }
    }

    /// sigma_dot.
    fn speed(&self) -> D {
        Dual { value: self.state.sigma_dot, slope: [self.slopes.along[1]] }
    }

    /// Size of a sized load.
    fn size(&self, load: usize) -> D {
        let inputs = self.reduced.loading().inputs.len();
        let slope = if load < inputs { self.slopes.inputs[load] } else { 0.0 };
        Dual { value: self.state.cache.sizes[load], slope: [slope] }
    }

    /// A component of a table.
    fn look(&self, table: &Table, component: usize) -> D {
        let spot = table.position(self.state.sigma);
        if self.slopes.along[0] == 0.0 {
            return D::constant(table.value(spot, component));
        }
        let (a, b) = table.borders(spot.panel);
        polynomial_at(table.series(spot.panel, component), self.sigma().chain(spot.x, 2.0 / (b - a)))
    }

    /// A component whose derivative along sigma is the next one.
    fn known(&self, table: &Table, component: usize) -> D {
        let spot = table.position(self.state.sigma);
        self.sigma().chain(table.value(spot, component), table.value(spot, component + 1))
    }

    fn displacement(&self, load: usize) -> D {
        let (reduced, sigma) = (self.reduced, self.state.sigma);
        let slope = match reduced.displacement(load) {
            Ok(table) => table.value(table.position(sigma), 1),
            Err(_) => {
                let c = reduced.curve().configuration(sigma);
                reduced.loading().loads[load].displacement(reduced.linkage(), &c)[1]
            }
        };
        self.sigma().chain(self.state.displacement(reduced, load), slope)
    }

    fn influence(&self, load: usize) -> D {
        self.look(self.reduced.influence(), load)
    }

    /// Time derivative of a function with its two derivatives along sigma from component `first` on.
    fn derivative(&mut self, table: &Table, first: usize, order: usize) -> Result<D, OutputError> {
        Ok(match order {
            0 => self.known(table, first),
            1 => self.known(table, first + 1) * self.speed(),
            _ => {
                let acceleration = self.effect()?.acceleration;
                let bend = self.look(table, first + 2);
                self.known(table, first + 1) * acceleration + bend * self.speed() * self.speed()
            }
        })
    }

    fn spring_force(&self, spring: usize) -> Result<D, OutputError> {
        let spring = &self.reduced.loading().springs[spring];
        let s = self.displacement(spring.load);
        let spring_force = s.chain(spring.force(s.value), spring.stiffness);
        if spring.damping == 0.0 {
            return Ok(spring_force);
        }
        let table = checked(self.reduced.displacement(spring.load))?;
        Ok(spring_force + scaled(self.known(table, 1) * self.speed(), spring.damping))
    }

    /// sigma_ddot with this sigma_dot, with drives in this direction.
    fn evaluate(&mut self, sigma_dot: D, direction: f64) -> Result<D, OutputError> {
        let (reduced, inputs) = (self.reduced, self.inputs);
        let state_loads = state_loads_under(reduced, inputs).map_err(Clone::clone)?;
        let (loads, sigma) = (reduced.loading().inputs.len(), self.sigma());
        let Slopes { inputs: rates, none, panel_force, evaluator, .. } = &mut *self.slopes;
        let air = rates.last().copied().filter(|_| reduced.loading().air.is_some()).unwrap_or(0.0);
        let change = Change { first: &rates[..loads], second: &none[..loads], airspeed: [air, 0.0] };
        let state = &*self.state;
        let (sizes, airspeed) = (&state.cache.sizes[..], airspeed(reduced, inputs));
        let given = AppliedLoads { sizes, airspeed, revolutions: state.revolutions, change: Some(change) };
        let mode = Mode { direction, touching: state.contact.touching };
        panel_force.place(reduced, state_loads, &given, sigma.value);
        // s itself: the inputs are u + s du/ds, at s = 0.
        let s = D::variable(0.0, 0);
        match state_loads {
            None => Ok(panel_force.at(panel_force.x(sigma), s)),
            Some(state_loads) => {
                let effect =
                    evaluator.evaluate((reduced, state_loads), &given, panel_force, &mode, [s, sigma, sigma_dot])?;
                Ok(effect.acceleration)
            }
        }
    }

    /// As [`EquationOfMotion::settle`], in the direction that it has found.
    fn settle(&mut self, sigma_dot: D, direction: f64) -> Result<D, OutputError> {
        let with_efficiency = self.slopes.evaluator.delivered.len();
        if with_efficiency == 0 || direction != 0.0 {
            return self.evaluate(sigma_dot, direction);
        }
        let back = self.evaluate(sigma_dot, -1.0)?;
        self.slopes.evaluator.keep();
        let forward = self.evaluate(sigma_dot, 1.0)?;
        let share = if back.value > forward.value { back * inverse(back - forward) } else { D::constant(1.0) };
        self.slopes.evaluator.mix(share);
        Ok(ZERO)
    }

    /// What acts; evaluated once.
    fn effect(&mut self) -> Result<Forces, OutputError> {
        if let Some(effect) = self.slopes.effect {
            return Ok(effect);
        }
        let found = self.state.effect(self.reduced, self.inputs)?;
        let free = self.settle(self.speed(), found.direction)?;
        let acceleration = if found.held.is_some() { ZERO } else { free };
        let effect = Forces { acceleration, free, held: found.held, by_stop: found.by_stop };
        self.slopes.effect = Some(effect);
        Ok(effect)
    }

    /// Size of a load that the state decides, as last evaluated.
    fn of_state(&self, load: usize) -> D {
        let state_loads = self.reduced.state_loads(self.slopes.air).ok().flatten();
        let place = state_loads.and_then(|s| s.loads.iter().position(|l| *l == load));
        place.map_or(ZERO, |k| self.slopes.evaluator.loads[k])
    }

    /// What arrives of a sized load, as last evaluated.
    fn delivered(&self, load: usize) -> D {
        let state_loads = self.reduced.state_loads(self.slopes.air).ok().flatten();
        let place = state_loads.and_then(|s| s.drives_with_efficiency.iter().position(|l| *l == load));
        place.map_or_else(|| self.size(load), |k| self.slopes.evaluator.delivered[k])
    }

    fn of_stop(&self, effect: &Forces, stop: usize) -> D {
        let holds = |side: usize| self.state.travel[side].is_some_and(|e| e.stop == stop);
        if !(effect.by_stop && effect.held.is_some_and(holds)) {
            return ZERO;
        }
        match self.reduced.displacement(self.reduced.loading().stops[stop].load) {
            Ok(table) => finite(-(effect.free * inverse(self.known(table, 1)))),
            Err(_) => ZERO,
        }
    }

    fn of_lock(&self, effect: &Forces, lock: usize) -> D {
        let (loading, locks) = (self.reduced.loading(), &self.inputs.locks);
        let stop = loading.locks[lock].stop;
        let holds = |side: &usize| self.state.travel[*side].is_some_and(|e| e.stop == stop);
        let Some(side) = effect.held.filter(holds).filter(|_| !effect.by_stop && locks[lock]) else { return ZERO };
        let outward = if side == 0 { -1.0 } else { 1.0 };
        let engaged = loading.locks.iter().zip(locks).filter(|(l, on)| **on && l.stop == stop).count();
        let path = self.reduced.lock_path(lock, self.state.sigma);
        finite(scaled(effect.free, -outward / (path.norm() * engaged as f64)))
    }

    fn others(&mut self, drive: usize, moving: bool) -> Result<D, OutputError> {
        let influence = self.influence(drive);
        let force = if moving {
            self.effect()?.free
        } else {
            self.slopes.effect = None;
            self.evaluate(ZERO, 0.0)?
        };
        Ok(force - self.delivered(drive) * influence)
    }

    fn inverse(&mut self, drive: usize, acceleration: D, breakaway: Option<f64>) -> Result<D, OutputError> {
        let sigma_dot = if breakaway.is_some() { ZERO } else { self.speed() };
        let direction = breakaway.unwrap_or(toward(sigma_dot.value, acceleration.value));
        self.slopes.effect = None;
        let free = self.evaluate(sigma_dot, direction)?;
        let (sigma, size) = (self.sigma(), self.delivered(drive));
        match self.reduced.state_loads(self.slopes.air).ok().flatten() {
            None => Ok(acceleration - (free - size * self.influence(drive))),
            Some(state_loads) => {
                let Slopes { evaluator, panel_force, .. } = &mut *self.slopes;
                Ok(evaluator.required(state_loads, panel_force, sigma, (drive, size), acceleration, breakaway)?)
            }
        }
    }

    fn one_element(&mut self, drive: usize, term: OneElement) -> Result<D, OutputError> {
        let table = checked(self.reduced.displacement(drive))?;
        let (slope, bend) = (self.known(table, 1), self.look(table, 2));
        let per = inverse(slope);
        let speed = slope * self.speed();
        let efficiency = self.reduced.loading().drives[drive].efficiency;
        let with_efficiency = |power: f64, value: D| match efficiency {
            Some(eta) if power < 0.0 => scaled(value, eta),
            Some(eta) => scaled(value, 1.0 / eta),
            None => value,
        };
        let present = self.size(drive).value * speed.value;
        let value = match term {
            OneElement::ReducedMass => with_efficiency(present, per * per),
            OneElement::ReducedMassDerivative => with_efficiency(present, scaled(bend * per * per * per * per, -2.0)),
            OneElement::StaticLoad => with_efficiency(present, -(self.others(drive, true)? * per)),
            OneElement::AdditionalForce => with_efficiency(present, bend * self.speed() * per * self.speed() * per),
            OneElement::RequiredForce => {
                let input = self.reduced.loading().inputs.len() + drive;
                let demand = Dual { value: self.inputs.reals[input], slope: [self.slopes.inputs[input]] };
                let acceleration = (demand - bend * self.speed() * self.speed()) * per;
                let force = self.inverse(drive, acceleration, None)? * per;
                let moving = if speed.value == 0.0 { demand.value } else { speed.value };
                with_efficiency(force.value * moving, force)
            }
            OneElement::HoldingForce => -(self.others(drive, false)? * per),
            OneElement::BreakawayForward | OneElement::BreakawayBackward => {
                let forward = if term == OneElement::BreakawayForward { 1.0 } else { -1.0 };
                let force = self.inverse(drive, ZERO, Some(forward * slope.value.signum()))? * per;
                with_efficiency(force.value * forward, force)
            }
        };
        Ok(finite(value))
    }

    fn reaction(&mut self, joint: usize) -> Result<[D; 3], OutputError> {
        if let Some(value) = self.slopes.reactions[joint] {
            return Ok(value);
        }
        let effect = self.effect()?;
        let reduced = self.reduced;
        let loading = reduced.loading();
        let terms = 2 + loading.base();
        let parts = if reduced.linkage().joints[joint].freedom == Freedom::Revolute { 2 } else { 3 };
        let table = reduced.reaction(joint);
        // The exact evaluator tells no derivative along sigma.
        let exact = match &table {
            Err(at) if self.slopes.along[0] != 0.0 => return Err(OutputError::Table((*at).clone())),
            Err(_) => reduced.exact_reaction(joint, self.state.sigma),
            Ok(_) => Vec::new(),
        };
        let mut value = [ZERO; 3];
        let mut add = |view: &Self, term: usize, size: D| {
            if size == ZERO {
                return;
            }
            for (part, sum) in value.iter_mut().enumerate().take(parts) {
                let unit = match &table {
                    Ok(table) => view.look(table, part * terms + term),
                    Err(_) => D::constant(part_of(&exact[term], part)),
                };
                *sum = *sum + size * unit;
            }
        };
        add(self, 0, effect.acceleration);
        add(self, 1, self.speed() * self.speed());
        for load in 0..reduced.components().sized {
            add(self, 2 + load, self.delivered(load));
        }
        for (place, spring) in loading.springs.iter().enumerate() {
            add(self, 2 + spring.load, -self.spring_force(place)?);
        }
        let states = loading.loads.len() - loading.base();
        let mut add_state = |view: &Self, load: usize, size: D| -> Result<(), OutputError> {
            if size == ZERO {
                return Ok(());
            }
            let table = reduced.state_reaction(joint);
            for (part, sum) in value.iter_mut().enumerate().take(parts) {
                let unit = match (&table, exact.get(2 + load)) {
                    (Ok(table), _) => view.look(table, part * states + load - loading.base()),
                    (Err(_), Some(exact)) => D::constant(part_of(exact, part)),
                    (Err(at), None) => return Err(OutputError::Table((*at).clone())),
                };
                *sum = *sum + size * unit;
            }
            Ok(())
        };
        let state_loads = reduced.state_loads(self.slopes.air).ok().flatten();
        for (k, &load) in state_loads.map_or(&[][..], |s| &s.loads).iter().enumerate() {
            add_state(self, load, self.slopes.evaluator.loads[k])?;
        }
        if let Some(side) = effect.held {
            if let Some(end) = self.state.travel[side].filter(|_| effect.by_stop) {
                add_state(self, loading.stops[end.stop].load, self.of_stop(&effect, end.stop))?;
            }
            for lock in 0..loading.locks.len() {
                let force = self.of_lock(&effect, lock);
                if force != ZERO {
                    let outward = if side == 0 { -1.0 } else { 1.0 };
                    let held = reduced.lock_reaction(lock, self.state.sigma, joint);
                    for (part, sum) in value.iter_mut().enumerate().take(parts) {
                        *sum = *sum + scaled(force, outward * part_of(&held, part));
                    }
                }
            }
        }
        let value = value.map(finite);
        self.slopes.reactions[joint] = Some(value);
        Ok(value)
    }
}

fn scaled(value: D, factor: f64) -> D {
    value.chain(value.value * factor, factor)
}

fn inverse(value: D) -> D {
    let inverse = 1.0 / value.value;
    value.chain(inverse, -inverse * inverse)
}

/// Where the largest number stands for the value, it stays.
fn finite(value: D) -> D {
    if value.value.is_finite() { value } else { D::constant(f64::MAX) }
}
