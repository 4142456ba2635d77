//! Events: where within a step a contact, a regime of friction or the direction of the drives changes.
//!
//! A motion has a list of guards. Each guard is an event that may come, with these functions:
//!
//! | function | of | states |
//! |---|---|---|
//! | [`Along::may_come`] | the ends of a step | whether the event may come within the step, by bounds |
//! | [`Along::passage`] | the interpolant of a step | where the event comes first |
//! | [`excess`] | one state | a value that is 0 at the event and negative before |
//! | `Advance::apply_event` | the state at the event | the transition |
//!
//! In: a step, the places of the stops and the contact there. Out: the earliest event in the step, a root on its
//! interpolant. Bounds rule out first what cannot be, as most steps have no event. Where they do not, roots are
//! isolated by bounds as well: of sigma and sigma_dot by Bernstein coefficients, of the push of a bumper and the slip
//! speed of a joint by interval bounds of the composed polynomials, so that an event is not missed because another one
//! undoes it soon. It must not know what follows from an event.
use crate::codec::record::{Damaged, Record};
use crate::integrator::{Dense, Direction, Integrator, Step, System};
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::MOTION;
use crate::mechanism::motion::contact::{Contact, Ends, Place};
use crate::mechanism::reduced::{AT_KNOT, StateLoads};
use borders::{passage_of_border, passes_border};
use bumpers::{passage_of_bumper, passage_of_push};
pub use levels::{may_pass_level, passage_of_level};
use places::Near;
use regimes::{SlipBounds, passage_of_slip};
use std::ops::Range;
use switches::{may_switch, passage_of_switch};

/// Part of a step within which a change of regime is located: a law followed so much too far errs by the square of it.
pub const REGIME_TOLERANCE: f64 = 1e-11;

/// Part of a step by which a change of regime must come before a reversal to count: where the motion ends, all slip
/// speeds pass 0.
const BEFORE_REVERSAL: f64 = 1e-9;

/// Part of a step by which a bumper that lets go must come before a lock at its place to count.
const BEFORE_LOCK: f64 = 1e-9;

/// An event within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The place where a stop is first met is passed outward, or inward by a mechanism that a lock catches there.
    Stop(Place),
    /// This bumper begins or ceases to push.
    Bumper(usize),
    /// This bumper pushes so hard that the lock that waits there engages.
    Engages(usize),
    /// sigma_dot changes its sign.
    Reversal,
    /// The slip speed of a friction joint leaves the range of its regime.
    Regime(usize),
    /// A switching quantity of this index passes 0: another law follows.
    Switch(usize),
    /// A border in the space of states is passed at which the right-hand side is less smooth.
    Border(usize),
    /// This sigma is passed, at which the right-hand side is less smooth.
    Knot(f64),
    /// The level of this index is passed: a lock changes.
    Level(usize),
    /// The interpolant has no finite value, or leads over positions in which friction locks: the step is taken again,
    /// shorter.
    Undefined,
}

impl Event {
    /// Written or read; [`Self::Undefined`] is not one to keep.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let mut sigma = 0.0;
        let (mut kind, mut index, mut place) = match *self {
            Self::Stop(place) => (0, 0, place),
            Self::Bumper(bumper) => (1, bumper, Place::default()),
            Self::Reversal => (2, 0, Place::default()),
            Self::Regime(joint) => (3, joint, Place::default()),
            Self::Border(border) => (4, border, Place::default()),
            Self::Switch(switch) => (5, switch, Place::default()),
            Self::Knot(knot) => {
                sigma = knot;
                (6, 0, Place::default())
            }
            Self::Level(level) => (7, level, Place::default()),
            Self::Engages(bumper) => (8, bumper, Place::default()),
            Self::Undefined => return Err(Damaged::new("event: an undefined one is not kept")),
        };
        record.choice("event", &mut kind, 9)?;
        match kind {
            0 => place.record(record)?,
            6 => record.finite("position of an event", &mut sigma)?,
            _ => record.place("index of an event", &mut index, usize::MAX)?,
        }
        *self = match kind {
            0 => Self::Stop(place),
            1 => Self::Bumper(index),
            2 => Self::Reversal,
            3 => Self::Regime(index),
            4 => Self::Border(index),
            6 => Self::Knot(sigma),
            7 => Self::Level(index),
            8 => Self::Engages(index),
            _ => Self::Switch(index),
        };
        Ok(())
    }
}

/// An event on the interpolant of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found<const N: usize> {
    /// Part of the step before the event.
    pub part: f64,
    /// State there, on the interpolant.
    pub state: [f64; N],
    pub event: Event,
}

/// A step with what decides on the guards along it.
struct Along<'s, 'e, const N: usize> {
    dynamics: &'s mut EquationOfMotion<'e>,
    integrator: &'s mut Integrator<N>,
    /// Places of the stops, and the contact there.
    around: (&'s Ends<'s>, &'s Contact),
    step: &'s Step<N>,
    tolerance: f64,
    near: Near,
    slips: Option<SlipBounds>,
    /// Borders that are not passed.
    distant: Range<usize>,
}

/// The guards of a motion, in the order in which events count that come at the same time: the first one does.
struct Guards {
    /// Index after the last guard of each kind: reversal, regimes, switches, borders, knot, levels, rigid stops.
    ends: [usize; 7],
    knot: f64,
    bumpers: usize,
}

impl Guards {
    #[inline(always)]
    fn new<const N: usize>(dynamics: &EquationOfMotion<'_>, ends: &Ends, step: &Step<N>) -> Self {
        let state_loads = dynamics.deciding::<N>();
        let knot = knot_ahead(dynamics, step);
        let reversals = state_loads.map_or(0, |own| usize::from(own.reverses));
        let regimes = reversals + state_loads.map_or(0, |own| own.friction_joints.len());
        let switches = regimes + state_loads.map_or(0, StateLoads::switches);
        let borders = switches + dynamics.borders::<N>();
        let knots = borders + usize::from(knot.is_some());
        let levels = knots + dynamics.levels::<N>();
        let bumpers = state_loads.map_or(0, |_| ends.bumpers());
        let ends = [reversals, regimes, switches, borders, knots, levels, levels + 2];
        Self { ends, knot: knot.unwrap_or(0.0), bumpers }
    }

    /// Whether stops are the only guards.
    #[inline(always)]
    fn are_stops(&self) -> bool {
        self.ends[5] == 0
    }

    /// Their indices.
    #[inline(always)]
    fn indices(&self) -> Range<usize> {
        0..self.ends[6] + 4 * self.bumpers
    }

    /// A guard by its index: of each bumper its place at the low and at the high side, its push, then the
    /// lock that waits there.
    #[inline(always)]
    fn get(&self, index: usize) -> Event {
        let [reversals, regimes, switches, borders, knots, levels, rigid] = self.ends;
        match index {
            _ if index < reversals => Event::Reversal,
            _ if index < regimes => Event::Regime(index - reversals),
            _ if index < switches => Event::Switch(index - regimes),
            _ if index < borders => Event::Border(index - switches),
            _ if index < knots => Event::Knot(self.knot),
            _ if index < levels => Event::Level(index - knots),
            _ if index < rigid => Event::Stop(Place::rigid(index - levels)),
            _ => match ((index - rigid) / 4, (index - rigid) % 4) {
                (bumper, 2) => Event::Bumper(bumper),
                (bumper, 3) => Event::Engages(bumper),
                (bumper, side) => Event::Stop(Place::of_bumper(side, bumper)),
            },
        }
    }
}

/// The earliest event in a step; `dense` becomes the interpolant of the step if that was needed. The change of a regime
/// or a sign in `held` does not take place in the step.
pub fn earliest_event<'e, const N: usize>(
    dynamics: &mut EquationOfMotion<'e>,
    integrator: &mut Integrator<N>,
    around: (&Ends, &Contact),
    step: &Step<N>,
    (held, tolerance): (Option<Event>, f64),
    dense: &mut Option<Dense<N>>,
) -> Option<Found<N>>
where
    EquationOfMotion<'e>: System<N>,
{
    let guards = Guards::new(dynamics, around.0, step);
    let mut along = Along::new(dynamics, integrator, around, step, tolerance);
    // Most steps come near no stop, and most motions have no other guards.
    if guards.are_stops() && !along.near.any(around.0, guards.bumpers) && around.1.touching() == BumperSet::EMPTY {
        return None;
    }
    // All guards are asked before the interpolant, whose evaluations add samples of the switching quantities. The last
    // mark is that of all further guards.
    let mut marks = 0_u128;
    for index in guards.indices() {
        let guard = guards.get(index);
        if along.may_come(guard) && held != Some(guard) {
            marks |= 1 << index.min(127);
        }
    }
    if marks == 0 {
        return None;
    }
    let dense = dense.get_or_insert_with(|| along.integrator.dense(along.dynamics, step));
    let undefined = |dense: &Dense<N>| Found { part: 0.25, state: dense.at(0.25), event: Event::Undefined };
    if !dense.at(0.5).iter().all(|y| y.is_finite()) {
        return Some(undefined(dense));
    }
    let mut earliest: Option<(f64, Event)> = None;
    for index in guards.indices().filter(|index| marks >> index.min(&127) & 1 == 1) {
        let guard = guards.get(index);
        if held == Some(guard) {
            continue;
        }
        let is_earlier = |part: f64| match (guard, earliest) {
            (Event::Regime(_), Some((reversal, Event::Reversal))) => part < reversal - BEFORE_REVERSAL,
            (_, Some((other, _))) => part < other,
            (_, None) => true,
        };
        if let Some(part) = along.passage(guard, dense).filter(|part| is_earlier(*part)) {
            earliest = Some((part, guard));
        }
    }
    let found = earliest.map(|(part, event)| Found { part, state: dense.at(part), event })?;
    if let Event::Border(_) = found.event
        && dynamics.derivative(step.t + found.part * step.h, &found.state)[1].is_nan()
    {
        // Friction locks somewhere before, where no stage of the step was.
        dynamics.locked = false;
        return Some(undefined(dense));
    }
    Some(found)
}

impl<'s, 'e, const N: usize> Along<'s, 'e, N>
where
    EquationOfMotion<'e>: System<N>,
{
    #[inline(always)]
    fn new(
        dynamics: &'s mut EquationOfMotion<'e>,
        integrator: &'s mut Integrator<N>,
        around: (&'s Ends<'s>, &'s Contact),
        step: &'s Step<N>,
        tolerance: f64,
    ) -> Self {
        let has_friction = dynamics.deciding::<N>().is_some_and(|own| !own.friction_joints.is_empty());
        let slips = has_friction.then(|| SlipBounds::new(dynamics, step));
        let both = [(step.t, &step.start), (step.t + step.h, &step.end)];
        let distant = if dynamics.borders::<N>() > 0 { dynamics.distant_borders(both) } else { 0..0 };
        Self { dynamics, integrator, around, step, tolerance, near: Near::new(step), slips, distant }
    }

    /// Whether the event of a guard may come within the step, by bounds that need no interpolant.
    #[inline(always)]
    fn may_come(&mut self, guard: Event) -> bool {
        let (dynamics, step, (ends, contact)) = (&mut *self.dynamics, self.step, self.around);
        match guard {
            Event::Stop(place) => self.near.may_pass_place(ends, place),
            Event::Knot(knot) => may_pass_knot(dynamics, knot, step),
            // A motion of two components has no other guards.
            _ if N < MOTION => false,
            Event::Reversal => may_reverse(dynamics, step),
            Event::Regime(joint) => self.slips.as_ref().is_some_and(|slips| slips.may_leave(dynamics, joint)),
            Event::Switch(switch) => may_switch(dynamics, switch, step, self.tolerance),
            Event::Border(border) => !self.distant.contains(&border) && passes_border(dynamics, border, step),
            Event::Level(level) => may_pass_level(dynamics, level, step),
            Event::Bumper(bumper) => contact.touching().contains(bumper) || self.near.is_behind(ends, bumper),
            Event::Engages(bumper) => engaging_push((ends, contact), bumper).is_some(),
            Event::Undefined => false,
        }
    }

    /// Part of the step after which the event of a guard comes.
    fn passage(&mut self, guard: Event, dense: &Dense<N>) -> Option<f64> {
        let (dynamics, step, (ends, contact)) = (&mut *self.dynamics, self.step, self.around);
        match guard {
            Event::Stop(place) => self.near.passage((ends, contact), place, dense),
            Event::Knot(knot) => dense.first_passage(0, knot, towards(knot - step.start[0]), false),
            _ if N < MOTION => None,
            Event::Reversal => dense.first_passage(1, 0.0, towards(-dynamics.mode.direction), false),
            Event::Regime(joint) => passage_of_slip(dynamics, joint, step, dense),
            Event::Switch(switch) => passage_of_switch(dynamics, switch, self.integrator, step, dense),
            Event::Border(border) => passage_of_border(dynamics, border, step, dense),
            Event::Level(level) => passage_of_level(dynamics, level, dense),
            Event::Bumper(bumper) => {
                let touches = contact.touching().contains(bumper);
                if !(touches || self.near.is_behind(ends, bumper)) {
                    return None;
                }
                let part = passage_of_bumper(dynamics, bumper, touches, dense)?;
                let caught = |side: usize| self.near.caught(ends, Place::of_bumper(side, bumper), dense);
                let back = if touches { caught(1).or_else(|| caught(0)) } else { None };
                // An undamped bumper lets go at the very place where the lock catches.
                back.is_none_or(|back| part < back - BEFORE_LOCK).then_some(part)
            }
            Event::Engages(bumper) => {
                engaging_push((ends, contact), bumper).and_then(|push| passage_of_push(dynamics, bumper, push, dense))
            }
            Event::Undefined => None,
        }
    }
}

/// Push at which the lock that waits at a bumper engages [N or N.m]; none unless the bumper touches and a lock waits.
fn engaging_push((ends, contact): (&Ends, &Contact), bumper: usize) -> Option<f64> {
    let push = ends.engages_at(Place::of_bumper(0, bumper));
    (contact.touching().contains(bumper) && push.is_finite()).then_some(push)
}

/// How far a state at the time t of the span [s] is past an event, in the unit of what decides: the speed, a push, the
/// slip speed of a joint or a switching quantity. 0 at the event, negative before. Places of stops are told by sigma
/// alone.
pub fn excess<'e, const N: usize>(
    dynamics: &mut EquationOfMotion<'e>,
    (ends, contact): (&Ends, &Contact),
    event: Event,
    t: f64,
    z: &[f64; N],
) -> f64
where
    EquationOfMotion<'e>: System<N>,
{
    match event {
        Event::Knot(sigma) => z[0] - sigma,
        Event::Stop(_) | Event::Undefined => 0.0,
        _ if N < MOTION => 0.0,
        Event::Reversal => -dynamics.mode.direction * z[1],
        Event::Bumper(bumper) => dynamics.excess_of_bumper(bumper, contact.touching().contains(bumper), [z[0], z[1]]),
        Event::Engages(bumper) => {
            dynamics.bumper_push(bumper, z[0], z[1]).1 - ends.engages_at(Place::of_bumper(0, bumper))
        }
        Event::Regime(joint) => {
            dynamics.set_state(z);
            dynamics.excess_of_slip(joint, [t, z[0], z[1]])
        }
        Event::Border(border) => dynamics.beyond_border(border, t, z),
        Event::Level(level) => dynamics.level_of_network(level, z).map_or(0.0, |level| level.excess(z)),
        Event::Switch(switch) => -dynamics.switch_value(switch, t, z).unwrap_or(f64::NAN),
    }
}

/// The state just after the state z at a part of a step, on the interpolant: later by what locates changes of regimes.
pub fn just_after<const N: usize>(z: &[f64; N], dense: &Dense<N>, part: f64) -> [f64; N] {
    let [at, after] = [part, part + 2.0 * REGIME_TOLERANCE].map(|part| dense.at(part));
    std::array::from_fn(|n| z[n] + (after[n] - at[n]))
}

/// The knot that the motion comes to first from the start of a step.
#[inline(always)]
fn knot_ahead<const N: usize>(dynamics: &EquationOfMotion<'_>, step: &Step<N>) -> Option<f64> {
    let reduced = dynamics.whole;
    if reduced.has_knots() { reduced.next_knot(step.start[0], way(step).signum()) } else { None }
}

/// Whether a step passes a knot, or may pass it before it turns back.
fn may_pass_knot<const N: usize>(dynamics: &EquationOfMotion<'_>, knot: f64, step: &Step<N>) -> bool {
    let way = way(step);
    let bulge = if step.end[1] * way < 0.0 { step.bulge(0) } else { 0.0 };
    (step.end[0] - knot) * way.signum() + bulge > AT_KNOT * dynamics.reduced.scale()
}

/// A number with the sign of the direction in which a step starts.
#[inline(always)]
fn way<const N: usize>(step: &Step<N>) -> f64 {
    if step.start[1] == 0.0 { step.end[0] - step.start[0] } else { step.start[1] }
}

/// Whether sigma_dot may change its sign within a step. Where friction sticks, it may do so and come back: there it
/// rests.
fn may_reverse<const N: usize>(dynamics: &EquationOfMotion<'_>, step: &Step<N>) -> bool {
    let [start, end] = [step.start[1], step.end[1]].map(|speed| speed * dynamics.mode.direction);
    end < 0.0 || (dynamics.sticks() && start.min(end) < step.bulge(1))
}

fn towards(sign: f64) -> Direction {
    if sign > 0.0 { Direction::Rising } else { Direction::Falling }
}

mod borders;
mod bumpers;
mod levels;
mod places;
mod regimes;
mod switches;
