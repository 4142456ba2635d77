//! The state of a hydraulic actuator, its steps, and the motion that it foresees.
//!
//! In: laws, inputs, a step. Out: the state after the step; the motion with one element over the next step of the host.
//! A step of the integration ends where a cushion begins or ends and where the command has a kink. It must not know
//! variables, nor outputs.
mod delayed;

use super::circuit::{Equations, SupplyUnit};
use super::definition::{Circuit, Solver};
use super::error::HydraulicsError;
use super::inputs::{CommandSignal, Input, Inputs};
use super::systems::{
    CIRCUIT, Coupled, Driven, ELEMENT, Element, IMPULSE, LENGTH, MOMENT, SPEED, SPOOL, SUPPLY, Surroundings,
};
use super::systems::{TANGENT, Tangent};
use crate::codec::record::{Damaged, Record};
use crate::integrator::{Direction, IntegrationError, Integrator, Step, System};
use crate::numerics::dual::{Dual, Number};
pub use delayed::Told;

/// Most instants within a step at which its integration must stop.
const INSTANTS: usize = 24;
/// Part of the stroke below which a length is on the border of a cushion.
const ON_BORDER: f64 = 1e-9;
/// Part of the clearance within which the spool is at an edge.
const ON_EDGE: f64 = 1e-3;
/// Length beyond the ends of the cylinder's travel that rounding of the host explains [m].
const SLACK: f64 = 1e-9;
/// Change of the mass over one step, as a part of the mass, from which one element does not foresee the motion.
const MASS_CHANGE: f64 = 0.5;

/// Where a hydraulic actuator is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Time since the start [s], and what its sum has lost to rounding.
    time: [f64; 2],
    /// Pressures, spool, energies.
    pub circuit: [f64; CIRCUIT],
    /// Memory of the integration under a prescribed motion.
    pub driven: Integrator<CIRCUIT>,
    /// Memory of the integration with one element.
    pub coupled: Integrator<ELEMENT>,
    /// What the last step foresaw; none if it foresaw nothing.
    pub last: Option<Last>,
    /// Length at the end of the last step, and the way of the step [m].
    pub arrival: Option<[f64; 2]>,
    /// What the mechanism has been told of the next step, in the mode delayed.
    pub told: Option<Told>,
}

/// What one step leaves to the foresight of the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Last {
    /// Size of the step [s].
    pub step: f64,
    /// Speed at its beginning [m/s].
    pub start_speed: f64,
    /// Speed foreseen at its end [m/s].
    pub speed: f64,
    /// Correction r of the load [N].
    pub correction: f64,
    /// Holding force at its beginning [N].
    pub load: f64,
}

/// The motion foreseen with one element over a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foreseen {
    /// Size of the step [s].
    pub h: f64,
    /// State at its end, and the memory of the integration there.
    pub end: [f64; ELEMENT],
    pub memory: Integrator<ELEMENT>,
    /// The element.
    pub element: Element<f64>,
    /// Correction r of the load [N].
    pub correction: f64,
    /// Time reached [s]: the step, or less where `solver.max_steps` was met.
    pub reached: f64,
}

/// Why no motion is foreseen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blind {
    /// The mass of what the actuator moves is unknown.
    NoMass,
    /// The mass changes too much within the step: the mechanism is near a toggle of the actuator.
    Toggle,
    /// The integration found no motion.
    Failed,
}

/// Laws, settings and inputs of one step.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    pub laws: &'a Equations,
    /// Accumulator and pump; none where the pressure of the supply is an input.
    pub unit: &'a Option<SupplyUnit>,
    pub circuit: &'a Circuit,
    pub solver: &'a Solver,
    pub inputs: &'a Inputs,
}

impl Setting<'_> {
    fn surroundings(&self, time: f64) -> Surroundings {
        Surroundings {
            unit: *self.unit,
            supply: self.inputs.polynomial(Input::Supply),
            tank: self.inputs.polynomial(Input::Tank),
            command: self.command(time),
        }
    }

    /// The command from the time [s] since the start on.
    pub fn command(&self, time: f64) -> CommandSignal {
        CommandSignal::new(self.inputs.polynomial(Input::Command), &self.circuit.command, time)
    }

    /// Refuse a length that the cylinder does not have.
    pub fn check_length(&self, length: f64) -> Result<(), HydraulicsError> {
        let lengths = self.laws.lengths();
        let within = length >= lengths[0] - SLACK && length <= lengths[1] + SLACK;
        if within { Ok(()) } else { Err(HydraulicsError::Travel { length, lengths }) }
    }
}

/// Instants within a step at which its integration stops, ascending.
#[derive(Debug)]
struct Instants {
    at: [f64; INSTANTS],
    count: usize,
}

impl Instants {
    fn none() -> Self {
        Self { at: [0.0; INSTANTS], count: 0 }
    }

    fn add(&mut self, t: f64) {
        if self.count < INSTANTS {
            self.at[self.count] = t;
            self.count += 1;
        }
    }

    fn sort(&mut self) {
        self.at[..self.count].sort_unstable_by(f64::total_cmp);
    }

    /// The instants, then the end of the step.
    fn ends(&self, h: f64) -> impl Iterator<Item = f64> {
        self.at[..self.count].iter().copied().chain([h])
    }
}

impl State {
    /// The start: pressures of the definition, the spool at rest at 0; `supply`: pressure of an accumulator.
    pub fn at_start(circuit: &Circuit, supply: Option<f64>) -> Self {
        let mut state = Self {
            time: [0.0; 2],
            circuit: [0.0; CIRCUIT],
            driven: Integrator::default(),
            coupled: Integrator::default(),
            last: None,
            arrival: None,
            told: None,
        };
        state.circuit[..2].copy_from_slice(&[circuit.chamber_a.start_pressure, circuit.chamber_b.start_pressure]);
        state.circuit[SUPPLY] = supply.unwrap_or(0.0);
        state
    }

    /// Time since the start [s].
    pub fn time(&self) -> f64 {
        self.time[0]
    }

    /// Pressures of the chambers [Pa].
    pub fn pressures(&self) -> [f64; 2] {
        [self.circuit[0], self.circuit[1]]
    }

    /// A step of size h [s] under the motion of the inputs. Returns the time reached: h, or less where
    /// `solver.max_steps` was met.
    ///
    /// # Errors
    /// No motion of the circuit was found; the state is undefined.
    pub fn follow(&mut self, setting: &Setting<'_>, h: f64) -> Result<f64, HydraulicsError> {
        let (length, speed) = (setting.inputs.length(), setting.inputs.polynomial(Input::Speed));
        let surroundings = setting.surroundings(self.time());
        let mut instants = Instants::none();
        surroundings.command.kinks(h, &mut |t| instants.add(t));
        for border in setting.laws.borders().into_iter().flatten() {
            length.passages(border, h, &mut |t| instants.add(t));
        }
        instants.sort();
        let mut system = Driven { laws: setting.laws, surroundings, length, speed };
        // The inputs may have changed.
        self.driven.refresh();
        let mut march = March::new(setting, &self.driven);
        let levels = Levels::new(setting, false);
        for end in instants.ends(h) {
            let memory = &mut self.driven;
            let whole = march.to(end, memory, &mut system, &mut self.circuit, &levels)?;
            if !whole {
                break;
            }
        }
        Ok(march.t)
    }

    /// The load's correction r, and whether the last step met a contact: m (v - v_foreseen)/h is what the element did
    /// not know. A contact stops or reverses the motion, or its impulse is more than that of force and load together;
    /// then r is 0, as the next step knows nothing of it.
    fn correction(&self, setting: &Setting<'_>) -> (f64, bool) {
        let Some(last) = self.last else { return (0.0, false) };
        let get = |input| setting.inputs.get(input);
        let (v, m) = (get(Input::Speed), get(Input::Mass));
        let missed = v - last.speed;
        let force = setting.laws.force(self.pressures(), last.speed);
        let most = force.abs() + get(Input::Load).abs() + last.load.abs();
        let reversed = v * last.speed <= 0.0 && missed.abs() > 0.5 * last.start_speed.abs().max(last.speed.abs());
        let contact = (m * missed).abs() > most * last.step || reversed;
        (if contact { 0.0 } else { last.correction - m * missed / last.step }, contact)
    }

    /// The element that stands for what the actuator moves, and the correction of its load.
    pub(super) fn element(&self, setting: &Setting<'_>, h: f64) -> Result<(Element<f64>, f64), Blind> {
        let get = |input| setting.inputs.get(input);
        let (mass, speed) = (get(Input::Mass), get(Input::Speed));
        if mass == 0.0 {
            return Err(Blind::NoMass);
        }
        let (correction, contact) = self.correction(setting);
        let element = element_of(self.last.as_ref(), contact, &ELEMENT_INPUTS.map(get));
        let force = setting.laws.force(self.pressures(), speed);
        let acceleration = element.acceleration(force, element.length, speed, 0.0);
        let way = (speed.abs() + 0.5 * acceleration.abs() * h) * h;
        // Not a comparison the other way round: NaN is no mass that changes little.
        if (element.mass_derivative * way).abs() <= MASS_CHANGE * mass {
            Ok((element, correction))
        } else {
            Err(Blind::Toggle)
        }
    }

    /// The motion with one element over a step of size h [s] from here: of the inputs, or, where the mechanism has been
    /// told of the step already, from the motion foreseen then. Nothing changes.
    ///
    /// # Errors
    /// Why none is foreseen.
    pub fn foresee(&self, setting: &Setting<'_>, h: f64) -> Result<Foreseen, (Blind, Option<HydraulicsError>)> {
        if let Some(Told { start, element, correction, .. }) = self.told {
            return self.foresee_from(setting, start, (element, correction), h);
        }
        let element = self.element(setting, h).map_err(|blind| (blind, None))?;
        self.foresee_from(setting, [Input::Length, Input::Speed].map(|input| setting.inputs.get(input)), element, h)
    }

    /// The motion of an element with this correction of its load, from a length and a speed.
    pub(super) fn foresee_from(
        &self,
        setting: &Setting<'_>,
        [length, speed]: [f64; 2],
        (element, correction): (Element<f64>, f64),
        h: f64,
    ) -> Result<Foreseen, (Blind, Option<HydraulicsError>)> {
        let surroundings = setting.surroundings(self.time());
        let mut instants = Instants::none();
        surroundings.command.kinks(h, &mut |t| instants.add(t));
        instants.sort();
        let lengths = setting.laws.lengths();
        let mut system = Coupled { laws: setting.laws, surroundings, element, stroke: lengths[1] - lengths[0] };
        let mut end = [0.0; ELEMENT];
        end[..CIRCUIT].copy_from_slice(&self.circuit);
        (end[LENGTH], end[SPEED]) = (length, speed);
        let mut memory = self.coupled;
        memory.branch_off();
        let mut march = March::new(setting, &memory);
        let levels = Levels::new(setting, true);
        for instant in instants.ends(h) {
            let whole = march
                .to(instant, &mut memory, &mut system, &mut end, &levels)
                .map_err(|error| (Blind::Failed, Some(error)))?;
            if !whole {
                break;
            }
        }
        Ok(Foreseen { h, end, memory, element, correction, reached: march.t })
    }

    /// Derivative of the foreseen motion along one direction: of the state at the end of a step of size h, and of the
    /// element; None if none is foreseen. `inputs`: change of each input.
    pub fn foresee_change(
        &self,
        setting: &Setting<'_>,
        h: f64,
        circuit: &[f64; CIRCUIT],
        inputs: &dyn Fn(Input) -> f64,
    ) -> Option<([Dual<1>; ELEMENT], Element<Dual<1>>)> {
        self.element(setting, h).ok()?;
        let dual = |input| Dual { value: setting.inputs.get(input), slope: [inputs(input)] };
        let (_, contact) = self.correction(setting);
        let element = element_of(self.last.as_ref(), contact, &ELEMENT_INPUTS.map(dual));
        let value = |dual: Dual<1>| dual.value;
        let plain = Element {
            mass: value(element.mass),
            mass_derivative: value(element.mass_derivative),
            load: value(element.load),
            load_derivative: value(element.load_derivative),
            load_rate: value(element.load_rate),
            length: value(element.length),
        };
        let surroundings = setting.surroundings(self.time());
        let lengths = setting.laws.lengths();
        let coupled = Coupled { laws: setting.laws, surroundings, element: plain, stroke: lengths[1] - lengths[0] };
        let clipped = surroundings.command.wanted(0.0).abs() > 1.0;
        let command = if clipped { 0.0 } else { inputs(Input::Command) };
        let mut system = Tangent { coupled, element, ports: [inputs(Input::Supply), inputs(Input::Tank), command] };
        let mut y = [0.0; TANGENT];
        y[..CIRCUIT].copy_from_slice(&self.circuit);
        y[ELEMENT..ELEMENT + CIRCUIT].copy_from_slice(circuit);
        for (component, input) in [(LENGTH, Input::Length), (SPEED, Input::Speed)] {
            (y[component], y[ELEMENT + component]) = (setting.inputs.get(input), inputs(input));
        }
        let mut memory = Integrator::default();
        let mut t = 0.0;
        let most = setting.solver.max_steps as u64;
        let whole = memory.advance_from(&mut system, &mut t, &mut y, h, setting.solver.tolerance, most);
        if whole != Ok(true) {
            return None;
        }
        // A longer step ends later along the motion.
        let later = inputs(Input::Horizon);
        let f = system.derivative(h, &y);
        let end = std::array::from_fn(|k| Dual { value: y[k], slope: [y[ELEMENT + k] + later * f[k]] });
        Some((end, element))
    }

    /// Keep the foreseen motion as a step's.
    pub fn keep(&mut self, foreseen: &Foreseen) {
        self.circuit.copy_from_slice(&foreseen.end[..CIRCUIT]);
    }

    /// The step of size h is done: what it leaves to the next. `end`: length at its end.
    pub fn arrive(&mut self, setting: &Setting<'_>, h: f64, end: f64, foreseen: Option<&Foreseen>) {
        self.told = None;
        let get = |input| setting.inputs.get(input);
        self.last = foreseen.filter(|foreseen| foreseen.reached == h).map(|foreseen| Last {
            step: h,
            start_speed: get(Input::Speed),
            speed: foreseen.end[SPEED],
            correction: foreseen.correction,
            load: get(Input::Load),
        });
        if let Some(foreseen) = foreseen {
            self.coupled = foreseen.memory;
        }
        self.arrival = Some([end, (end - get(Input::Length)).abs()]);
        // Two-sum, so that many short steps do not lose the time.
        let [time, lost] = self.time;
        let delta = h + lost;
        let sum = time + delta;
        self.time = [sum, delta - (sum - time)];
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.all_finite("time", &mut self.time)?;
        record.all_finite("state of the circuit", &mut self.circuit)?;
        self.driven.record(record)?;
        self.coupled.record(record)?;
        let blank = || Last { step: 0.0, start_speed: 0.0, speed: 0.0, correction: 0.0, load: 0.0 };
        record.option("last step", &mut self.last, blank, |record, last| {
            record.positive("size of the last step", &mut last.step)?;
            record.finite("speed before", &mut last.start_speed)?;
            record.finite("foreseen speed", &mut last.speed)?;
            record.finite("correction of the load", &mut last.correction)?;
            record.finite("load before", &mut last.load)
        })?;
        record.option(
            "arrival",
            &mut self.arrival,
            || [0.0; 2],
            |record, arrival| record.all_finite("arrival", arrival),
        )?;
        record.option("step told", &mut self.told, Told::blank, |record, told| told.record(record))
    }
}

/// Inputs that make the element, in the order in which [`element_of`] takes them.
const ELEMENT_INPUTS: [Input; 6] =
    [Input::Length, Input::Speed, Input::Mass, Input::MassDerivative, Input::Load, Input::LoadDerivative];

/// The element that stands for what the actuator moves, from the inputs: its load is the holding force plus the
/// correction; where no derivative of the holding force is told, the load has the rate of the last step.
fn element_of<T: Number>(last: Option<&Last>, contact: bool, inputs: &[T; 6]) -> Element<T> {
    let [length, speed, mass, mass_derivative, load, load_derivative] = *inputs;
    let zero = T::constant(0.0);
    let (mut corrected, mut load_rate) = (load, zero);
    if let Some(last) = last {
        let per_step = 1.0 / last.step;
        if !contact {
            let missed = mass * (speed - T::constant(last.speed)) * per_step;
            corrected = corrected + T::constant(last.correction) - missed;
        }
        if load_derivative.value() == 0.0 {
            load_rate = (load - T::constant(last.load)) * per_step;
        }
    }
    Element { mass, mass_derivative, load: corrected, load_derivative, load_rate, length }
}

/// What the foreseen motion tells of a step of size h, in the words of the interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preview<T> {
    /// Value and rate of the line with the impulse and the first moment of the force [N], [N/s].
    pub force: T,
    pub force_rate: T,
    /// Mean force [N].
    pub force_mean: T,
    /// Length and speed at the end [m], [m/s].
    pub length: T,
    pub speed: T,
    /// Accelerations under the force at the beginning and at the end [m/s2].
    pub start_acceleration: T,
    pub acceleration: T,
}

impl<T: Number> Preview<T> {
    /// From the element, pressures and speed at the beginning, the state at the end, and the step.
    pub fn new(
        laws: &Equations,
        element: &Element<T>,
        (pressures, speed): ([T; 2], T),
        end: &[T; ELEMENT],
        h: T,
    ) -> Self {
        let (mean, moment) = (end[IMPULSE] / h, end[MOMENT] / (h * h));
        let rate = (moment * 2.0 - mean) * 6.0 / h;
        let last = laws.force([end[0], end[1]], end[SPEED]);
        let first = laws.force(pressures, speed);
        Self {
            force: mean - rate * h * 0.5,
            force_rate: rate,
            force_mean: mean,
            length: end[LENGTH],
            speed: end[SPEED],
            start_acceleration: element.acceleration(first, element.length, speed, T::constant(0.0)),
            acceleration: element.acceleration(last, end[LENGTH], end[SPEED], h),
        }
    }

    /// With values that nothing changes.
    pub fn constant<U: Number>(&self) -> Preview<U> {
        let [force, force_rate, force_mean, length, speed, start_acceleration, acceleration] =
            self.values().map(|value| U::constant(value.value()));
        Preview { force, force_rate, force_mean, length, speed, start_acceleration, acceleration }
    }

    /// All values.
    pub fn values(&self) -> [T; 7] {
        let Self { force, force_rate, force_mean, length, speed, start_acceleration, acceleration } = *self;
        [force, force_rate, force_mean, length, speed, start_acceleration, acceleration]
    }

    /// Where none is foreseen: the present force, and the motion of the inputs.
    pub fn blind(force: T, [length, speed, acceleration]: [T; 3], h: T) -> Self {
        Self {
            force,
            force_rate: T::constant(0.0),
            force_mean: force,
            length: length + speed * h,
            speed,
            start_acceleration: acceleration,
            acceleration,
        }
    }
}

/// Levels of components at which the laws are not smooth, so that a step should end there: of the length, where a
/// cushion begins; of the pressure of the supply, where the pump changes; of the spool, where an edge opens within a
/// hair's breadth, which a step could pass unseen.
struct Levels([Option<(usize, f64, f64)>; 6]);

impl Levels {
    /// Of a step with these laws; `moves`: whether the length is a component of the state.
    fn new(setting: &Setting<'_>, moves: bool) -> Self {
        let lengths = setting.laws.lengths();
        let [a, b] = setting.laws.borders().map(|border| {
            border.filter(|_| moves).map(|border| (LENGTH, border, ON_BORDER * (lengths[1] - lengths[0])))
        });
        let pressures = setting.unit.map(|unit| unit.borders().map(|p| (SUPPLY, p, ON_BORDER * p.abs())));
        let [c, d] = pressures.map_or([None; 2], |pressures| pressures.map(Some));
        let overlap = setting.circuit.valve.overlap;
        let edge = |at: f64| Some((SPOOL, at, ON_EDGE * setting.circuit.valve.clearance));
        let [e, f] = [edge(overlap), edge(-overlap).filter(|_| overlap != 0.0)];
        Self([a, b, c, d, e, f])
    }

    /// The first of them that a step has passed: component, level, direction.
    #[inline]
    fn passed<const N: usize>(&self, step: &Step<N>) -> Option<(usize, f64, Direction)> {
        self.0.iter().flatten().find_map(|&(component, level, near)| {
            let (start, end) = (step.start[component], step.end[component]);
            let passed = (start - level) * (end - level) < 0.0 && (start - level).abs() > near;
            passed.then_some((component, level, if end > start { Direction::Rising } else { Direction::Falling }))
        })
    }
}

/// The step again, up to the level of a component.
#[cold]
fn to_level<S: System<N>, const N: usize>(
    memory: &mut Integrator<N>,
    system: &mut S,
    step: Step<N>,
    (component, level, direction): (usize, f64, Direction),
) -> Step<N> {
    let dense = memory.dense(system, &step);
    match dense.first_passage(component, level, direction, false) {
        Some(part) if part > 0.0 && part < 1.0 => memory.retake(system, &step, part * step.h),
        _ => step,
    }
}

/// An integration on its way through a step.
struct March<'a> {
    laws: &'a Equations,
    tolerance: f64,
    /// Time since the beginning of the step [s].
    t: f64,
    /// Attempts at steps after which it is interrupted.
    most: u64,
}

impl<'a> March<'a> {
    fn new<const N: usize>(setting: &Setting<'a>, memory: &Integrator<N>) -> Self {
        let Solver { tolerance, max_steps } = *setting.solver;
        let most = memory.attempts().saturating_add(max_steps as u64);
        Self { laws: setting.laws, tolerance, t: 0.0, most }
    }

    /// Integrate up to `end` [s] since the beginning of the step; a step that passes one of the levels ends there.
    /// Returns whether the end is reached.
    #[inline]
    fn to<S: System<N>, const N: usize>(
        &mut self,
        end: f64,
        memory: &mut Integrator<N>,
        system: &mut S,
        y: &mut [f64; N],
        levels: &Levels,
    ) -> Result<bool, HydraulicsError> {
        while self.t < end {
            if memory.attempts() >= self.most {
                return Ok(false);
            }
            let step = memory.step(system, self.t, y, end, self.tolerance).map_err(|error| self.stuck(error, y))?;
            let step = match levels.passed(&step) {
                None => step,
                Some(level) => to_level(memory, system, step, level),
            };
            *y = step.end;
            self.t = if step.reached { end } else { self.t + step.h };
            if !self.laws.has_air() {
                self.check_vacuum(y)?;
            }
        }
        Ok(true)
    }

    /// Refuse absolute pressures that oil without air does not have.
    fn check_vacuum(&self, y: &[f64]) -> Result<(), HydraulicsError> {
        for (chamber, p) in ["chamber_a", "chamber_b"].into_iter().zip(y) {
            let pressure = p + self.laws.ambient();
            if pressure <= 0.0 {
                return Err(HydraulicsError::Vacuum { chamber, pressure, time: self.t });
            }
        }
        Ok(())
    }

    #[cold]
    fn stuck(&self, IntegrationError::StepTooSmall { .. }: IntegrationError, y: &[f64]) -> HydraulicsError {
        HydraulicsError::Stuck { time: self.t, pressures: [y[0], y[1]] }
    }
}

/// What a step says that met `solver.max_steps` at the time [s] since its beginning.
#[cold]
pub fn interrupted(solver: &Solver, time: f64, h: f64) -> HydraulicsError {
    use crate::numerics::decimal::Decimal;
    let why = format!(
        "solver.max_steps = {}: reached {} s of the {} s of this step; take shorter steps, or raise solver.max_steps or \
         solver.tolerance",
        Decimal(solver.max_steps),
        Decimal::rounded(time),
        Decimal::rounded(h)
    );
    HydraulicsError::Interrupted { time, why }
}
