//! Integrations on their way through a step: instants and levels at which they stop, what they refuse.
//!
//! In: a system, its memory, the state. Out: the state at an instant of the step. It must not know the motion of the
//! actuator, nor what it moves.
use super::Setting;
use crate::circuit::{EVENTS, Equations, SPOOL, SUPPLY};
use crate::definition::Solver;
use crate::error::HydraulicsError;
use crate::events;
use crate::systems::{LENGTH, Watched};
use foundation::integrator::{Direction, IntegrationError, Integrator, Step, System};
use foundation::numerics::decimal::Decimal;
use foundation::numerics::order;

/// Most instants within a step at which its integration must stop.
const INSTANTS: usize = 24;
/// Part of the stroke below which a length is on the border of a cushion.
const ON_BORDER: f64 = 1e-9;

/// Instants within a step at which its integration stops, ascending.
#[derive(Debug)]
pub struct Instants {
    at: [f64; INSTANTS],
    count: usize,
}

impl Instants {
    pub fn none() -> Self {
        Self { at: [0.0; INSTANTS], count: 0 }
    }

    pub fn add(&mut self, t: f64) {
        if self.count < INSTANTS {
            self.at[self.count] = t;
            self.count += 1;
        }
    }

    pub fn sort(&mut self) {
        order::sort(&mut self.at[..self.count]);
    }

    /// The instants, then the end of the step.
    pub fn ends(&self, h: f64) -> impl Iterator<Item = f64> {
        self.at[..self.count].iter().copied().chain([h])
    }
}

/// Levels of components at which the laws are not smooth, so that a step should end there: of the length, where a
/// cushion begins; of the pressure of the supply, where the pump changes; of the spool, where an edge opens within a
/// hair's breadth, which a step could pass unseen.
pub struct Levels([Option<(usize, f64, f64)>; 6]);

impl Levels {
    /// Of a step with these laws; `moves`: whether the length is a component of the state.
    pub fn new(setting: &Setting<'_>, moves: bool) -> Self {
        let lengths = setting.laws.lengths();
        let [a, b] = setting.laws.borders().map(|border| {
            border.filter(|_| moves).map(|border| (LENGTH, border, ON_BORDER * (lengths[1] - lengths[0])))
        });
        let pressures = setting.laws.supply_unit().map(|unit| unit.borders().map(|p| (SUPPLY, p, ON_BORDER * p.abs())));
        let [c, d] = pressures.map_or([None; 2], |pressures| pressures.map(Some));
        let (edges, near) = setting.laws.edges();
        let [e, f] = edges.map(|edge| edge.map(|at| (SPOOL, at, near)));
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
pub struct March<'a> {
    laws: &'a Equations,
    tolerance: f64,
    /// Time since the beginning of the step [s].
    pub t: f64,
    /// Attempts at steps after which it is interrupted.
    most: u64,
    /// Whether it ends at the first event, and this event.
    watches: bool,
    event: Option<usize>,
}

impl<'a> March<'a> {
    pub fn new<const N: usize>(setting: &Setting<'a>, memory: &Integrator<N>) -> Self {
        let Solver { tolerance, max_steps } = *setting.solver;
        let most = memory.attempts().saturating_add(max_steps as u64);
        Self { laws: setting.laws, tolerance, t: 0.0, most, watches: setting.watches, event: None }
    }

    /// Integrate up to `end` [s] since the beginning of the step; a step that passes one of the levels ends there.
    /// Returns whether the end is reached: not where an event was looked for and found.
    #[inline]
    pub fn to<S: Watched<N>, const N: usize>(
        &mut self,
        end: f64,
        memory: &mut Integrator<N>,
        system: &mut S,
        y: &mut [f64; N],
        levels: &Levels,
    ) -> Result<bool, HydraulicsError> {
        while self.t < end {
            let Some(step) = self.once(end, memory, system, y, levels)? else { return Ok(false) };
            let step = self.cut_at_event(memory, system, step);
            self.take(&step, y, end);
            if self.event.is_some() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// One step towards `end`, which ends at the first level that it passes; none if no more attempts are left.
    #[inline]
    pub fn once<S: System<N>, const N: usize>(
        &self,
        end: f64,
        memory: &mut Integrator<N>,
        system: &mut S,
        y: &[f64; N],
        levels: &Levels,
    ) -> Result<Option<Step<N>>, HydraulicsError> {
        if memory.attempts() >= self.most {
            return Ok(None);
        }
        let step = memory.step(system, self.t, y, end, self.tolerance).map_err(|error| self.stuck(error, y))?;
        Ok(Some(match levels.passed(&step) {
            None => step,
            Some(level) => to_level(memory, system, step, level),
        }))
    }

    /// A step up to the first event in it, if events are looked for.
    #[inline]
    pub fn cut_at_event<S: Watched<N>, const N: usize>(
        &mut self,
        memory: &mut Integrator<N>,
        system: &mut S,
        step: Step<N>,
    ) -> Step<N> {
        if !self.watches {
            return step;
        }
        let (watched, tolerance) = (*system, self.tolerance);
        let guard = |event: usize, t: f64, y: &[f64; N]| watched.guard(event, t, y, tolerance);
        let Some((event, part)) = events::first(EVENTS.len(), &step, &guard, || memory.dense(system, &step)) else {
            return step;
        };
        self.event = Some(event);
        if part < 1.0 { memory.retake(system, &step, part * step.h) } else { step }
    }

    /// A step was cut before the event that was found in it.
    pub fn forget_event(&mut self) {
        self.event = None;
    }

    /// The piston has come from a length to an end of its travel, which is an event unless it was there.
    pub fn meet_end(&mut self, from: f64, end: f64) {
        let [least, most] = self.laws.lengths();
        if self.watches && (from - end).abs() > events::nearness(self.tolerance) * (most - least) {
            self.event = Some(EVENTS.len());
        }
    }

    /// The event at which it has ended, an index of [`EVENTS`], or their number for an end of the travel.
    pub fn event(&self) -> Option<usize> {
        self.event
    }

    /// Go on from the end of a step.
    #[inline]
    pub fn take<const N: usize>(&mut self, step: &Step<N>, y: &mut [f64; N], end: f64) {
        *y = step.end;
        self.t = if step.reached { end } else { self.t + step.h };
    }

    /// Why the integration comes no further from the state y; `length`: of the actuator there.
    #[cold]
    fn stuck(&self, IntegrationError::StepTooSmall { .. }: IntegrationError, y: &[f64]) -> HydraulicsError {
        let (laws, time) = (self.laws, self.t);
        let near = |chamber: &usize| laws.is_at_vacuum(y[*chamber]);
        if let Some(chamber) = (0..2).find(near) {
            return HydraulicsError::Vacuum { chamber: ["chamber_a", "chamber_b"][chamber], time };
        }
        HydraulicsError::Stuck { time, what: laws.describe_pressures([y[0], y[1]]) }
    }
}

/// Refuse a state, `time` [s] after the beginning of a step, in which something is beyond the largest number: the sizes
/// of steps are chosen by pressures, spool and motion, whatever the energies.
pub fn finite(y: &[f64], time: f64) -> Result<(), HydraulicsError> {
    // A sum of squares would overflow earlier; 0 x infinity is NaN.
    let all: f64 = y.iter().map(|component| 0.0 * component).sum();
    if all == 0.0 { Ok(()) } else { Err(HydraulicsError::Overflow { time }) }
}

/// What a step says that met `solver.max_steps` at the time [s] since its beginning.
#[cold]
pub fn interrupted(solver: &Solver, time: f64, h: f64) -> HydraulicsError {
    let why = format!(
        "solver.max_steps = {} was reached {} s after the start of a communication step of {} s; use shorter \
         communication steps, or increase solver.max_steps or solver.tolerance",
        Decimal(solver.max_steps),
        Decimal::rounded(time),
        Decimal::rounded(h)
    );
    HydraulicsError::Interrupted { time, why }
}
