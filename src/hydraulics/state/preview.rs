//! Prediction of the motion over the next communication step, with one element for the mechanism.
//!
//! In: the state, inputs that describe the element, a step. Out: the predicted motion, its derivative along a direction
//! of the inputs, the predicted force. It must not change the state.
use super::limits::{Course, holds};
use super::march::{Instants, Levels, March, finite};
use super::{Last, Setting, State};
use crate::circuit::{CIRCUIT, settling_reach};
use crate::error::HydraulicsError;
use crate::inputs::Input;
use crate::systems::{
    Coupled, ELEMENT, Element, Hold, IMPULSE, LENGTH, MOMENT, SPEED, TANGENT, Tangent, with_element, without_element,
};
use foundation::integrator::{Integrator, System};
use foundation::numerics::decimal::Decimal;
use foundation::numerics::dual::{Dual, Number};

/// Change of the mass over one step, as a part of the mass, from which one element does not foresee the motion.
const MASS_CHANGE: f64 = 0.5;
/// Change of the load, as a part of it, from which it has jumped.
const JUMP: f64 = 0.001;
/// Part of what a speed has missed that a jump of the load leaves unexplained.
const EXPLAINED: f64 = 0.1;
/// Acceleration of an element that no mass and load have [m/s2].
const MOST_ACCELERATION: f64 = 1e30;

/// The motion foreseen with one element over a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Foreseen {
    /// Size of the step [s].
    pub h: f64,
    /// Length [m] and speed [m/s] of the mechanism at its beginning.
    pub start: [f64; 2],
    /// State at its end, and the memory of the integration there.
    pub end: [f64; ELEMENT],
    pub memory: Integrator<ELEMENT>,
    /// The element.
    pub element: Element<f64>,
    /// Correction r of the load [N].
    pub correction: f64,
    /// Force at the beginning [N].
    pub start_force: f64,
    /// Rates of the circuit there, which are those of the motion of the inputs too.
    pub start_rates: [f64; CIRCUIT],
    /// Time reached [s]: the step, or less where `solver.max_steps` was met.
    pub reached: f64,
    /// What stops and locks did to the element.
    pub course: Course,
    /// The event at which it ends, if events are looked for: an index of
    /// [`EVENTS`](crate::circuit::EVENTS) or their number.
    pub event: Option<usize>,
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

impl Foreseen {
    /// Whether the motion goes on to the end of the step.
    pub fn is_whole(&self) -> bool {
        self.reached == self.h
    }

    /// Farthest way [m] from an end of the cylinder, at which the motion has come to rest, that a mechanism has after
    /// the step, with its way by its speed while it settles: a mean force that is held leaves at most this.
    pub fn reach(&self) -> f64 {
        settling_reach(self.start, self.end[LENGTH], self.course.settling)
    }
}

impl State {
    /// The load's correction r, and whether the last step met a contact: m (v - v_foreseen)/h is what the element did
    /// not know. A contact stops or reverses the motion, or its impulse is more than that of force and load together;
    /// then r is 0, as the next step knows nothing of it.
    fn correction(&self, setting: &Setting<'_>) -> (f64, bool) {
        let Some(last) = self.last else { return (0.0, false) };
        let get = |input| setting.inputs.get(input);
        let (v, m) = (get(Input::Speed), get(Input::Mass));
        let ([lower, upper], length) = (self.limits(setting), get(Input::Length));
        if v == 0.0 && (length <= lower || length >= upper) {
            return (0.0, true);
        }
        if last.met_end {
            // The force that brings the mechanism to the end of the cylinder is none of the load.
            return (0.0, true);
        }
        if !last.is_known {
            return (last.correction, false);
        }
        let missed = v - last.speed;
        let loads = get(Input::Load).abs() + last.load.abs();
        let exceeds = |most: f64| (m * missed).abs() > most * last.step;
        let force = || setting.laws.force(self.pressures(), last.speed).abs();
        let reversed = v * last.speed <= 0.0 && missed.abs() > 0.5 * last.start_speed.abs().max(last.speed.abs());
        // The force is asked for only where the loads alone do not explain the difference.
        let contact = reversed || exceeds(loads) && exceeds(force() + loads);
        let (jumped, _) = jump(&last, get(Input::Load), m, v);
        (if contact { 0.0 } else { last.correction - m * missed / last.step + jumped }, contact)
    }

    /// Least and largest length to which stops and locks let the element go [m]. Where the last step has foreseen a
    /// motion and what the actuator moves has stayed at rest, as under static friction, it stays there.
    fn limits(&self, setting: &Setting<'_>) -> [f64; 2] {
        let [length, speed] = [Input::Length, Input::Speed].map(|input| setting.inputs.get(input));
        let stays = |last: &Last| last.rests && last.start_length.to_bits() == length.to_bits();
        if speed == 0.0 && self.last.as_ref().is_some_and(stays) { [length; 2] } else { setting.limits() }
    }

    /// What holds the element at the beginning of a step.
    fn hold(&self, setting: &Setting<'_>) -> Hold {
        let get = |input| setting.inputs.get(input);
        let (length, speed) = (get(Input::Length), get(Input::Speed));
        let net = || setting.laws.force(self.pressures(), 0.0) - get(Input::Load);
        if speed == 0.0 && holds(self.limits(setting), length, net()) {
            return Hold::Stop;
        }
        let ends = setting.laws.lengths();
        let (end, outward) = setting.laws.nearer_end(length);
        let is_there = speed == 0.0 && (length - end) * outward >= 0.0;
        let rests = is_there || self.rests_on_end([length, speed]);
        if rests && holds(ends, end, net()) { Hold::End } else { Hold::Free }
    }

    /// Whether the piston has come to rest at an end of the cylinder and has not left it since: the mechanism, with
    /// this length and speed, is no farther from there than the force leaves it that brings it there in two steps.
    fn rests_on_end(&self, [length, speed]: [f64; 2]) -> bool {
        let near = |last: &Last| speed.abs() * last.settling + (length - last.end_length).abs() <= last.reach;
        self.last.as_ref().is_some_and(|last| last.rests_on_end && near(last))
    }

    /// Time [s] in which a mean force over steps of size h [s] brings a mechanism with this motion to the end at which
    /// the piston rests: the longest step since then, as the force for a way of long steps would be too large in a
    /// short one.
    fn settling(&self, motion: [f64; 2], h: f64) -> f64 {
        let last = self.last.as_ref().filter(|_| self.rests_on_end(motion));
        last.map_or(h, |last| last.settling.max(h))
    }

    /// Force of an end of the cylinder on the piston [N], under this load and force of the oil at rest.
    pub fn end_force<T: Number>(&self, setting: &Setting<'_>, load: T, force: T) -> T {
        let is_known = setting.inputs.get(Input::Mass) > 0.0;
        if is_known && self.hold(setting) == Hold::End { load - force } else { T::constant(0.0) }
    }

    /// For how many steps, with the next one, the load of the inputs acts or a lock has let go before a force reacts.
    pub(super) fn unanswered(&self, setting: &Setting<'_>, let_go: bool) -> usize {
        let get = |input| setting.inputs.get(input);
        match self.last {
            _ if let_go => 1 + usize::from(get(Input::Speed) != 0.0),
            Some(last) => jump(&last, get(Input::Load), get(Input::Mass), get(Input::Speed)).1,
            None => 0,
        }
    }

    /// The element that stands for what the actuator moves, and the correction of its load.
    #[inline]
    fn element(&self, setting: &Setting<'_>) -> Result<(Element<f64>, f64), Blind> {
        let get = |input| setting.inputs.get(input);
        if get(Input::Mass) == 0.0 {
            return Err(Blind::NoMass);
        }
        let (correction, contact) = self.correction(setting);
        let limits = self.limits(setting);
        Ok((element_of(self.last.as_ref(), (contact, limits), &ELEMENT_INPUTS.map(get)), correction))
    }

    /// Acceleration [m/s2] of the element under this force; none if no mass is told, or none that moves.
    pub fn start_acceleration<T: Number>(
        &self,
        setting: &Setting<'_>,
        inputs: impl Fn(Input) -> T,
        force: T,
    ) -> Option<T> {
        if setting.inputs.get(Input::Mass) == 0.0 {
            return None;
        }
        if self.hold(setting).is_held() {
            return Some(T::constant(0.0));
        }
        let (_, contact) = self.correction(setting);
        let limits = self.limits(setting);
        let element = element_of(self.last.as_ref(), (contact, limits), &ELEMENT_INPUTS.map(&inputs));
        let acceleration = element.acceleration(force, element.length, inputs(Input::Speed), T::constant(0.0));
        acceleration.value().is_finite().then_some(acceleration)
    }

    /// [`Self::element`], if it stands for what the actuator moves over a step of size h [s].
    pub(super) fn checked_element(&self, setting: &Setting<'_>, h: f64) -> Result<(Element<f64>, f64), Blind> {
        let (element, correction) = self.element(setting)?;
        let speed = setting.inputs.get(Input::Speed);
        let force = setting.laws.force(self.pressures(), speed);
        let acceleration = element.acceleration(force, element.length, speed, 0.0);
        let stiffness = || setting.laws.stiffness(self.pressures(), element.length);
        let is_held = self.hold(setting).is_held();
        check_element(&element, if is_held { 0.0 } else { acceleration }, (speed, h), stiffness)?;
        Ok((element, correction))
    }

    /// The motion with one element over a step of size h [s] from here: of the inputs, or, where the mechanism has been
    /// told of the step already, from the motion foreseen then. Nothing changes.
    ///
    /// # Errors
    /// Why none is foreseen.
    pub fn foresee(&self, setting: &Setting<'_>, h: f64) -> Result<Foreseen, (Blind, Option<HydraulicsError>)> {
        if let Some(told) = &self.told {
            return self.foresee_from(setting, (&self.circuit, told.start), (told.element, told.correction), h);
        }
        let element = self.element(setting).map_err(|blind| (blind, None))?;
        let motion = [Input::Length, Input::Speed].map(|input| setting.inputs.get(input));
        self.foresee_from(setting, (&self.at_beginning(setting, h), motion), element, h)
    }

    /// The motion of an element with this correction of its load, from a state of the circuit, a length and a speed.
    pub(super) fn foresee_from(
        &self,
        setting: &Setting<'_>,
        (circuit, motion): (&[f64; CIRCUIT], [f64; 2]),
        (element, correction): (Element<f64>, f64),
        h: f64,
    ) -> Result<Foreseen, (Blind, Option<HydraulicsError>)> {
        let surroundings = setting.surroundings(self.time());
        let mut instants = Instants::none();
        surroundings.command.kinks(h, &mut |t| instants.add(t));
        instants.sort();
        let lengths = setting.laws.lengths();
        let stroke = lengths[1] - lengths[0];
        let mut system = Coupled { laws: setting.laws, surroundings, element, stroke, hold: Hold::Free };
        let mut end = with_element(circuit, motion);
        let mut course = system.begin(&mut end, self.rests_on_end(motion));
        course.settling = self.settling(motion, h);
        let first = system.derivative(0.0, &end);
        let stiffness = || setting.laws.stiffness([circuit[0], circuit[1]], motion[0]);
        check_element(&element, first[SPEED], (motion[1], h), stiffness).map_err(|blind| {
            let pressures = || setting.laws.describe_pressures([circuit[0], circuit[1]]);
            (blind, (blind == Blind::Failed).then(|| stuck_with(setting, 0.0, &pressures())))
        })?;
        let mut memory = self.coupled.clone();
        memory.branch_off();
        memory.begin_with(first);
        memory.count_evaluations(1);
        let mut march = March::new(setting, &memory);
        let levels = Levels::new(setting, true);
        for instant in instants.ends(h) {
            let whole = march
                .within_limits(instant, &mut memory, &mut system, (&mut end, &mut course), &levels)
                .map_err(|error| match error {
                    HydraulicsError::Stuck { time, what } => stuck_with(setting, time, &what),
                    other => other,
                })
                .map_err(|error| (Blind::Failed, Some(error)))?;
            if !whole {
                break;
            }
        }
        finite(&end, march.t).map_err(|error| (Blind::Failed, Some(error)))?;
        let (start, start_force, start_rates) = (motion, first[IMPULSE], without_element(&first));
        let (reached, event) = (march.t, march.event());
        Ok(Foreseen { h, start, end, memory, element, correction, start_force, start_rates, reached, course, event })
    }

    /// Derivative of the foreseen motion along one direction: of the state at the end of a step of size h, and of the
    /// element; None if none is foreseen. `inputs`: change of each input.
    pub fn foresee_change(
        &self,
        setting: &Setting<'_>,
        h: f64,
        circuit: &[f64; CIRCUIT],
        inputs: &dyn Fn(Input) -> f64,
    ) -> Option<([Dual<1>; ELEMENT], Element<Dual<1>>, Course)> {
        self.checked_element(setting, h).ok()?;
        let dual = |input| Dual { value: setting.inputs.get(input), slope: [inputs(input)] };
        let (_, contact) = self.correction(setting);
        let limits = self.limits(setting);
        let element = element_of(self.last.as_ref(), (contact, limits), &ELEMENT_INPUTS.map(dual));
        let value = |dual: Dual<1>| dual.value;
        let plain = Element {
            mass: value(element.mass),
            mass_derivative: value(element.mass_derivative),
            load: value(element.load),
            load_derivative: value(element.load_derivative),
            load_rate: value(element.load_rate),
            length: value(element.length),
            limits,
        };
        let surroundings = setting.surroundings(self.time());
        let lengths = setting.laws.lengths();
        let (stroke, hold) = (lengths[1] - lengths[0], self.hold(setting));
        let coupled = Coupled { laws: setting.laws, surroundings, element: plain, stroke, hold };
        let clipped = surroundings.command.wanted(0.0).abs() > 1.0;
        let command = if clipped { 0.0 } else { inputs(Input::Command) };
        let mut system = Tangent { coupled, element, ports: [inputs(Input::Supply), inputs(Input::Tank), command] };
        let motion = [Input::Length, Input::Speed].map(dual);
        let circuit = std::array::from_fn(|k| Dual { value: self.circuit[k], slope: [circuit[k]] });
        let mut start = with_element(&circuit, motion);
        if hold == Hold::End {
            let (end, _) = setting.laws.nearer_end(motion[0].value);
            (start[LENGTH], start[SPEED]) = (Dual::constant(end), Dual::constant(0.0));
            start[IMPULSE] = element.mass * motion[1] * -1.0;
            start[MOMENT] = element.mass * (motion[0] - Dual::constant(end));
        }
        let part = |k: usize| if k < ELEMENT { start[k].value } else { start[k - ELEMENT].slope[0] };
        let mut y: [f64; TANGENT] = std::array::from_fn(part);
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
        // Held or not, as at the beginning: a contact within the step has no derivative.
        let (is_held, on_end) = (hold.is_held(), hold == Hold::End);
        let course = Course {
            held_at_start: is_held,
            held_at_end: is_held,
            released: false,
            met_end: on_end,
            rests_on_end: on_end,
            settling: self.settling(motion.map(|dual| dual.value), h),
        };
        Some((end, element, course))
    }

    /// Keep the foreseen motion as a step's.
    pub fn keep(&mut self, foreseen: &Foreseen) {
        self.circuit = without_element(&foreseen.end);
    }
}

/// Whether an element with this acceleration [m/s2] and speed [m/s] stands for what the actuator moves over a step of
/// size h [s]. The oil, of this stiffness [N/m], turns an acceleration back within a way of twice the force over it.
fn check_element(
    element: &Element<f64>,
    acceleration: f64,
    (speed, h): (f64, f64),
    stiffness: impl Fn() -> f64,
) -> Result<(), Blind> {
    if acceleration.is_nan() || acceleration.abs() > MOST_ACCELERATION {
        return Err(Blind::Failed);
    }
    // Not a comparison the other way round: NaN is no mass that changes little.
    let suits = |way: f64| (element.mass_derivative * way).abs() <= MASS_CHANGE * element.mass;
    let (along, pushed) = (speed.abs() * h, 0.5 * acceleration.abs() * h * h);
    let turned = || pushed.min(2.0 * element.mass * acceleration.abs() / stiffness());
    if suits(along + pushed) || suits(along + turned()) { Ok(()) } else { Err(Blind::Toggle) }
}

/// No motion is found with the element of the inputs.
#[cold]
fn stuck_with(setting: &Setting<'_>, time: f64, what: &str) -> HydraulicsError {
    let [mass, load] = [Input::Mass, Input::Load].map(|input| Decimal(setting.inputs.get(input)));
    let what = format!("{what}; with actuator.reduced_mass = {mass} kg and actuator.holding_force = {load} N");
    HydraulicsError::Stuck { time, what }
}

/// Part of the load's correction that the holding force set explains [N], for a mass and a speed set, and for how many
/// steps no force has reacted to it. In a late host a load that jumps acts for a step before the host sets it here: its
/// difference from the one expected is then what the speed has missed. A host that reads outputs after it has set the
/// load sets it here at once: the speed has missed nothing.
fn jump(last: &Last, load: f64, mass: f64, speed: f64) -> (f64, usize) {
    let Some(expected) = last.expected_load else { return (0.0, 0) };
    let (missed, jump) = (-mass * (speed - last.speed) / last.step, load - expected);
    if jump.abs() <= JUMP * (load.abs() + expected.abs()) {
        (0.0, 0)
    } else if (missed - jump).abs() < EXPLAINED * missed.abs() {
        (-jump, 2)
    } else {
        (0.0, usize::from(missed.abs() < EXPLAINED * jump.abs()))
    }
}

/// Inputs that make the element, in the order in which [`element_of`] takes them.
const ELEMENT_INPUTS: [Input; 6] =
    [Input::Length, Input::Speed, Input::Mass, Input::MassDerivative, Input::Load, Input::LoadDerivative];

/// The element that stands for what the actuator moves, from the inputs: its load is the holding force plus the
/// correction; where no derivative of the holding force is told, the load has the rate of the last step.
fn element_of<T: Number>(last: Option<&Last>, (contact, limits): (bool, [f64; 2]), inputs: &[T; 6]) -> Element<T> {
    let [length, speed, mass, mass_derivative, load, load_derivative] = *inputs;
    let zero = T::constant(0.0);
    let (mut corrected, mut load_rate) = (load, zero);
    if let Some(last) = last {
        let per_step = 1.0 / last.step;
        if !contact {
            corrected = corrected + T::constant(last.correction);
        }
        if !contact && last.is_known {
            corrected = corrected - mass * (speed - T::constant(last.speed)) * per_step;
            corrected = corrected + T::constant(jump(last, load.value(), mass.value(), speed.value()).0);
        }
        if load_derivative.value() == 0.0 {
            load_rate = (load - T::constant(last.load)) * per_step;
        }
    }
    Element { mass, mass_derivative, load: corrected, load_derivative, load_rate, length, limits }
}
