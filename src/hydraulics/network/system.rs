//! A network as a system of differential equations, and its way through a step.
//!
//! In: laws, inputs as functions of time, what moves the cylinders, a state. Out: the state at the end of a step. A
//! step of the integration ends where an input is clipped, a cushion begins or an edge of a valve opens. It must not
//! know variables, nor what the host does with the motion.
mod events;
mod tangent;

use super::definition::{MOST_COMPONENTS, MOST_CYLINDERS, TOTALS};
use super::inputs::{Inputs, limits};
use super::laws::{Cylinder, Drive, Laws, Rest};
use super::layout::Layout;
use crate::circuit::FREE;
use crate::error::HydraulicsError;
use crate::inputs::Polynomial;
use foundation::codec::record::{Damaged, Record};
use foundation::integrator::{Direction, IntegrationError, Integrator, Statistics, Step, System};
use foundation::numerics::dual::{Dual, Number};

/// Number of components of which a Jacobian takes the derivatives at once.
const AT_ONCE: usize = 8;
/// Capacity for small networks.
const SMALL: usize = 32;
/// Speed of a cylinder below which errors are absolute [m/s].
const SPEED_FLOOR: f64 = 0.01;
/// Part of the stroke below which a length is on the border of a cushion.
const ON_BORDER: f64 = 1e-9;
/// Most instants within a step at which its integration stops.
const INSTANTS: usize = 24;

/// Memory of the integration, with room for the components of the network.
#[derive(Clone, Debug, PartialEq)]
pub enum Memory {
    /// Up to [`SMALL`] components.
    Small(Box<Integrator<SMALL>>),
    /// Up to [`MOST_COMPONENTS`].
    Large(Box<Integrator<MOST_COMPONENTS>>),
}

/// The same expression for either capacity.
macro_rules! sized {
    ($memory:expr, $own:ident => $answer:expr) => {
        match $memory {
            Memory::Small($own) => $answer,
            Memory::Large($own) => $answer,
        }
    };
}

impl Memory {
    /// Before the first step of a network.
    pub fn new(layout: &Layout) -> Self {
        let ports = layout.volumes() + layout.reservoirs;
        match layout.components().max(layout.flow_inputs()).max(ports) <= SMALL {
            true => Self::Small(Box::new(Integrator::keeping())),
            false => Self::large(),
        }
    }

    /// The memory of any network.
    pub fn large() -> Self {
        Self::Large(Box::new(Integrator::keeping()))
    }

    /// Become the same as another one of the same network.
    pub fn copy_from(&mut self, other: &Self) {
        match (self, other) {
            (Self::Small(own), Self::Small(other)) => own.copy_from(other),
            (Self::Large(own), Self::Large(other)) => own.copy_from(other),
            (own, other) => own.clone_from(other),
        }
    }

    /// Go on from a state on another path.
    pub fn branch_off(&mut self) {
        sized!(self, own => own.branch_off());
    }

    /// Work done so far.
    pub fn statistics(&self) -> Statistics {
        sized!(self, own => own.statistics())
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        sized!(self, own => own.record(record))
    }
}

/// What moves a cylinder over a step.
#[derive(Clone, Copy, Debug)]
pub enum Motion {
    /// Length and speed as polynomials.
    Given([Polynomial; 2]),
    /// Its force moves what is along it, or a stop holds it.
    Own(Drive<f64>),
}

/// One step: its laws, its inputs, what moves the cylinders.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    pub laws: &'a Laws,
    pub inputs: &'a Inputs,
    pub motions: [Motion; MOST_CYLINDERS],
    /// Least and largest length that stops leave to each cylinder [m].
    pub limits: [[f64; 2]; MOST_CYLINDERS],
    /// Bit set of the cylinders whose piston has been at an end of the travel.
    pub met_ends: u16,
    pub tolerance: f64,
    /// Attempts at steps after which it is interrupted.
    pub max_steps: f64,
    /// Which locks are engaged, if the step ends at the first event.
    pub watched: Option<&'a [bool]>,
    /// This event.
    pub event: Option<usize>,
}

/// Flow inputs that act on a network at the time t [s].
#[inline]
fn flow_inputs<const N: usize>(laws: &Laws, inputs: &Inputs, t: f64) -> [f64; N] {
    let mut u = [0.0; N];
    for (index, u) in u.iter_mut().enumerate().take(laws.layout.flow_inputs()) {
        let value = if inputs.ahead { inputs.polynomial(index).quadratic_at(t) } else { inputs.values[index] };
        let [least, most] = limits(laws.layout.input(index));
        *u = value.clamp(least, most);
    }
    u
}

impl Job<'_> {
    /// What moves each cylinder at the time t [s].
    #[inline]
    fn drives<T: Number>(&self, t: f64) -> [Drive<T>; MOST_CYLINDERS] {
        let mut drives = [Drive::Held(T::constant(0.0)); MOST_CYLINDERS];
        for (drive, motion) in drives.iter_mut().zip(&self.motions[..self.laws.layout.cylinders]) {
            *drive = match motion {
                Motion::Given(motion) => Drive::Given(motion.map(|one| T::constant(one.at(t)))),
                Motion::Own(drive) => drive.constant(),
            };
        }
        drives
    }
}

impl<T: Number> Drive<T> {
    /// With values that nothing changes.
    fn constant<U: Number>(&self) -> Drive<U> {
        let of = |value: T| U::constant(value.value());
        match self {
            Self::Given(motion) => Drive::Given(motion.map(of)),
            Self::Held(length) => Drive::Held(of(*length)),
            Self::Element(element) => Drive::Element(element.constant()),
            Self::End(rest) => {
                Drive::End(Rest { element: rest.element.constant(), end: rest.end, settling: rest.settling })
            }
        }
    }
}

impl<const N: usize> System<N> for Job<'_> {
    const CAN_BE_STIFF: bool = true;

    #[inline]
    fn leading_components(&self) -> usize {
        self.laws.layout.leading()
    }

    #[inline]
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N] {
        let count = self.laws.layout.cylinders;
        self.laws.rates(&self.drives(t)[..count], &flow_inputs::<N>(self.laws, self.inputs, t), t, y)
    }

    /// The norm of an error is over the leading components of the network, whatever the capacity.
    #[inline]
    fn scale(&mut self, y: &[f64; N], _f: &[f64; N]) -> [f64; N] {
        let (laws, layout) = (self.laws, &self.laws.layout);
        let share = (layout.leading() as f64 / N as f64).sqrt();
        let mut scale = [FREE; N];
        laws.sizes(y, share, &mut scale);
        for (index, cylinder) in laws.cylinders.iter().enumerate() {
            let (own, [least, most]) = (layout.motion(index), cylinder.laws.lengths());
            (scale[own], scale[own + 1]) = (share * (most - least), share * y[own + 1].abs().max(SPEED_FLOOR));
        }
        scale
    }

    #[inline]
    fn admits(&mut self, y: &[f64; N]) -> bool {
        let has_room = |(index, cylinder): (usize, &Cylinder)| {
            !matches!(self.motions[index], Motion::Own(Drive::Element(_)))
                || cylinder.laws.has_room(y[self.laws.layout.motion(index)])
        };
        self.laws.has_pressures(y) && self.laws.cylinders.iter().enumerate().all(has_room)
    }

    fn jacobian(&mut self, t: f64, y: &[f64; N]) -> [[f64; N]; N] {
        let (leading, cylinders) = (self.laws.layout.leading(), self.laws.layout.cylinders);
        let (drives, u) = (self.drives(t), flow_inputs::<N>(self.laws, self.inputs, t).map(Dual::constant));
        let mut rows = [[0.0; N]; N];
        for first in (0..leading).step_by(AT_ONCE) {
            let mut duals: [Dual<AT_ONCE>; N] = y.map(Dual::constant);
            for k in 0..AT_ONCE.min(leading - first) {
                duals[first + k] = Dual::variable(y[first + k], k);
            }
            let rates = self.laws.rates(&drives[..cylinders], &u, Dual::constant(t), &duals);
            let count = AT_ONCE.min(leading - first);
            for (row, rate) in rows.iter_mut().zip(rates) {
                row[first..first + count].copy_from_slice(&rate.slope[..count]);
            }
        }
        rows
    }
}

/// A level of a component at which a step of the integration ends: of a spool at which an edge opens, of a length at
/// which a cushion begins. The last number: a distance within which the component is there.
type Level = (usize, f64, f64);

impl Job<'_> {
    /// Calls `visit` with all levels.
    fn levels(&self, visit: &mut impl FnMut(Level)) {
        let layout = &self.laws.layout;
        for valve in self.laws.valves() {
            if let Some((_, _, spool)) = valve.dynamics {
                let (edges, near) = valve.edges();
                edges.into_iter().for_each(|edge| visit((layout.spool(spool), edge, near)));
            }
        }
        for (index, cylinder) in self.laws.cylinders.iter().enumerate() {
            if let Motion::Own(Drive::Element(_)) = self.motions[index] {
                let [least, most] = cylinder.laws.lengths();
                for border in cylinder.laws.borders().into_iter().flatten() {
                    visit((layout.motion(index), border, ON_BORDER * (most - least)));
                }
            }
        }
    }

    /// Instants within a step of size h at which an input is clipped or a given length passes the border of a cushion,
    /// ascending, then the end.
    fn instants(&self, h: f64) -> ([f64; INSTANTS + 1], usize) {
        let (mut all, mut count) = ([h; INSTANTS + 1], 0);
        let mut add = |t: f64| {
            if count < INSTANTS {
                (all[count], count) = (t, count + 1);
            }
        };
        let layout = &self.laws.layout;
        if self.inputs.ahead {
            for input in (0..layout.flow_inputs()).filter(|input| self.inputs.changes(*input)) {
                for limit in limits(layout.input(input)).into_iter().filter(|limit| limit.is_finite()) {
                    self.inputs.polynomial(input).passages(limit, h, &mut add);
                }
            }
        }
        for (cylinder, motion) in self.laws.cylinders.iter().zip(&self.motions) {
            if let Motion::Given([length, _]) = motion {
                for border in cylinder.laws.borders().into_iter().flatten() {
                    length.passages(border, h, &mut add);
                }
            }
        }
        all[..count].sort_unstable_by(f64::total_cmp);
        all[count] = h;
        (all, count + 1)
    }

    /// Integrate the state over a step of size h [s], with as many steps as `max_steps` allows. Returns the time
    /// reached; lengths and speeds that are given are those of the inputs there. A cylinder that moves an element stops
    /// at its limit, and stays there for the rest of the step; at an end of its travel it may rebound.
    ///
    /// # Errors
    /// No motion was found, or a component is beyond the largest number; state and memory are then undefined.
    pub fn advance(&mut self, memory: &mut Memory, y: &mut [f64], h: f64) -> Result<f64, HydraulicsError> {
        let reached = sized!(memory, own => self.advance_in(own, y, h))?;
        for (index, motion) in self.motions.iter().enumerate().take(self.laws.layout.cylinders) {
            let own = self.laws.layout.motion(index);
            match motion {
                Motion::Given(motion) => y[own..own + 2].copy_from_slice(&motion.map(|one| one.at(reached))),
                Motion::Own(Drive::Held(length) | Drive::End(Rest { end: length, .. })) => {
                    y[own..own + 2].copy_from_slice(&[*length, 0.0]);
                }
                Motion::Own(_) => {}
            }
        }
        let all: f64 = y.iter().map(|component| 0.0 * component).sum();
        if all == 0.0 { Ok(reached) } else { Err(HydraulicsError::Overflow { time: reached }) }
    }

    #[inline(never)]
    fn advance_in<const N: usize>(
        &mut self,
        memory: &mut Integrator<N>,
        state: &mut [f64],
        h: f64,
    ) -> Result<f64, HydraulicsError> {
        let (mut system, mut t) = (*self, 0.0);
        let mut y = [0.0; N];
        y[..state.len()].copy_from_slice(state);
        memory.refresh();
        let most = memory.attempts().saturating_add(self.max_steps as u64);
        let (instants, count) = self.instants(h);
        'step: for &end in &instants[..count] {
            while t < end {
                if memory.attempts() >= most {
                    break 'step;
                }
                let step =
                    memory.step(&mut system, t, &y, end, self.tolerance).map_err(|error| self.stuck(error, t, &y))?;
                let mut step = match system.passed(&step) {
                    None => step,
                    Some((level, direction)) => to_level(memory, &mut system, step, level, direction),
                };
                let mut met = None;
                while let Some((cylinder, limit)) = system.met(&step)
                    && met != Some((cylinder, limit))
                {
                    met = Some((cylinder, limit));
                    step = to_limit(memory, &mut system, step, cylinder, limit);
                }
                if system.watched.is_some() {
                    step = system.cut_at_event(memory, step, &mut met);
                }
                y = step.end;
                t = if step.reached { end } else { t + step.h };
                if let Some((cylinder, limit)) = met {
                    system.arrive(&mut y, t, cylinder, limit);
                    memory.restart();
                }
                if system.event.is_some() {
                    break 'step;
                }
            }
        }
        (self.motions, self.met_ends, self.event) = (system.motions, system.met_ends, system.event);
        state.copy_from_slice(&y[..state.len()]);
        Ok(t)
    }

    /// The first level that a step has passed.
    #[inline]
    fn passed<const N: usize>(&self, step: &Step<N>) -> Option<(Level, Direction)> {
        let mut found = None;
        self.levels(&mut |(component, level, near)| {
            let (start, end) = (step.start[component], step.end[component]);
            if found.is_none() && (start - level) * (end - level) < 0.0 && (start - level).abs() > near {
                let direction = if end > start { Direction::Rising } else { Direction::Falling };
                found = Some(((component, level, near), direction));
            }
        });
        found
    }

    /// The first cylinder whose element a step has moved beyond its limit, and this limit.
    #[inline]
    fn met<const N: usize>(&self, step: &Step<N>) -> Option<(usize, f64)> {
        (0..self.laws.layout.cylinders).find_map(|cylinder| {
            let Motion::Own(Drive::Element(_)) = self.motions[cylinder] else { return None };
            let own = self.laws.layout.motion(cylinder);
            let ([lower, upper], [least, most]) = (self.limits[cylinder], self.laws.cylinders[cylinder].laws.lengths());
            let (lower, upper) = (lower.max(least), upper.min(most));
            let (start, end) = (step.start[own], step.end[own]);
            let limit = if end > upper && end > start { upper } else { lower };
            (end > upper && end > start || end < lower && end < start).then_some((cylinder, limit))
        })
    }

    /// A cylinder whose element has come to a limit, t [s] after the beginning: a stop holds it there; an end of the
    /// cylinder gives it an impulse by the force of the cylinder, and holds it if it does not rebound.
    fn arrive(&mut self, y: &mut [f64], t: f64, cylinder: usize, limit: f64) {
        let (layout, laws) = (&self.laws.layout, &self.laws.cylinders[cylinder].laws);
        let (own, impulse, chamber) = (layout.motion(cylinder), layout.impulse(cylinder), layout.chamber(cylinder));
        y[own] = limit;
        let Motion::Own(Drive::Element(element)) = self.motions[cylinder] else { return };
        if self.limits[cylinder].contains(&limit) {
            y[own + 1] = 0.0;
            self.motions[cylinder] = Motion::Own(Drive::Held(limit));
            return;
        }
        let (_, outward) = laws.nearer_end(limit);
        let (mass, net) =
            (element.mass_at(limit), laws.force([y[chamber], y[chamber + 1]], 0.0) - element.load_at(limit, t));
        let after = laws.after_impact(mass, y[own + 1], net * outward);
        let change = mass * (after - y[own + 1]);
        y[own + 1] = after;
        (y[impulse], y[impulse + 1]) = (y[impulse] + change, y[impulse + 1] + change * t);
        self.met_ends |= 1 << cylinder;
        if after == 0.0 && net * outward >= 0.0 {
            self.motions[cylinder] = Motion::Own(Drive::End(Rest { element, end: limit, settling: 0.0 }));
        }
    }

    /// Why the integration comes no further from the state y.
    #[cold]
    fn stuck(&self, IntegrationError::StepTooSmall { .. }: IntegrationError, t: f64, y: &[f64]) -> HydraulicsError {
        HydraulicsError::Stuck { time: t, what: self.laws.lowest_pressure(y) }
    }
}

/// The step again, up to the level of a component.
#[cold]
fn to_level<S: System<N>, const N: usize>(
    memory: &mut Integrator<N>,
    system: &mut S,
    step: Step<N>,
    (component, level, _): Level,
    direction: Direction,
) -> Step<N> {
    let dense = memory.dense(system, &step);
    match dense.first_passage(component, level, direction, false) {
        Some(part) if part > 0.0 && part < 1.0 => memory.retake(system, &step, part * step.h),
        _ => step,
    }
}

/// The step again, up to where a cylinder passes its limit.
#[cold]
fn to_limit<const N: usize>(
    memory: &mut Integrator<N>,
    system: &mut Job<'_>,
    step: Step<N>,
    cylinder: usize,
    limit: f64,
) -> Step<N> {
    let own = system.laws.layout.motion(cylinder);
    let rises = step.end[own] > step.start[own];
    let (direction, starts_there) = match rises {
        true => (Direction::Rising, step.start[own] >= limit),
        false => (Direction::Falling, step.start[own] <= limit),
    };
    match memory.dense(system, &step).first_passage(own, limit, direction, starts_there) {
        Some(part) if part > 0.0 && part < 1.0 => memory.retake(system, &step, part * step.h),
        _ => step,
    }
}

const _: () = assert!(TOTALS < SMALL);
