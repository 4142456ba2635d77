//! Events: where within a step a contact, a regime of friction or the direction of the drives changes.
//!
//! In: a step, the places of the stops and the contact there. Out: the earliest event in the step, a root on its
//! interpolant. Bounds rule out first what cannot be, as most steps have no event. Where they do not, roots are
//! isolated by bounds as well: of sigma and sigma_dot by Bernstein coefficients, of the push of a bumper and the slip
//! speed of a joint by interval bounds of the composed polynomials, so that an event is not missed because another one
//! undoes it soon. It must not know what follows from an event.
use crate::codec::record::{Damaged, Record};
use crate::integrator::{Dense, Direction, Integrator, Step};
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::motion::contact::{Contact, Ends, Place, outward};
use crate::mechanism::motion::dynamics::Dynamics;
use crate::mechanism::reduced::AT_KNOT;
use crate::numerics::bracket::false_position;
use crate::numerics::enclosure::{Enclosure, Interval};
use crate::numerics::passage::Bounded;
use crate::numerics::table::TablePosition;
pub use levels::{first_level, may_pass_level};
use pushes::{bumper_event, excess_of_bumper, press_event};
use std::cell::RefCell;
use switches::{may_switch, passage_of_switch};

/// Part of a step within which a change of regime is located: a law followed so much too far errs by the square of it.
pub const REGIME_TOLERANCE: f64 = 1e-11;

/// Part of a step by which a change of regime must come before a reversal to be an event of its own: where the motion
/// ends, all slip speeds pass 0.
const BEFORE_REVERSAL: f64 = 1e-9;

/// Part of a step by which a bumper that lets go must come before a lock at its place to be an event of its own.
const BEFORE_LOCK: f64 = 1e-9;

/// An event within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The place where a stop is first met is passed outward, or inward by a mechanism that a lock catches there.
    Stop(Place),
    /// This bumper begins or ceases to push.
    Bumper(usize),
    /// This bumper pushes harder than this force [N or N.m]: the lock that waits there engages.
    Engages(usize, f64),
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
        let (mut sigma, mut force) = (0.0, 0.0);
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
            Self::Engages(bumper, least) => {
                force = least;
                (8, bumper, Place::default())
            }
            Self::Undefined => return Err(Damaged("event: an undefined one is not kept".to_owned())),
        };
        record.choice("event", &mut kind, 9)?;
        match kind {
            0 => place.record(record)?,
            6 => record.finite("position of an event", &mut sigma)?,
            _ => record.place("index of an event", &mut index, usize::MAX)?,
        }
        if kind == 8 {
            record.finite("force of an event", &mut force)?;
        }
        *self = match kind {
            0 => Self::Stop(place),
            1 => Self::Bumper(index),
            2 => Self::Reversal,
            3 => Self::Regime(index),
            4 => Self::Border(index),
            6 => Self::Knot(sigma),
            7 => Self::Level(index),
            8 => Self::Engages(index, force),
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

/// The earliest event in a step; `dense` becomes the interpolant of the step if that was needed. The change of a regime
/// or a sign in `held` does not take place in the step.
pub fn earliest_event<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    integrator: &mut Integrator<N>,
    (ends, contact): (&Ends, &Contact),
    step: &Step<N>,
    (held, tolerance): (Option<Event>, f64),
    dense: &mut Option<Dense<N>>,
) -> Option<Found<N>> {
    let reverses = dynamics.has_reversals() && may_reverse(dynamics, step);
    let near = Near { start: step.start[0], end: step.end[0], bulge: step.bulge(0) };
    let is_near = near.any(ends) || contact.touching() != BumperSet::EMPTY;
    let joints = dynamics.friction_joints();
    let slips = (joints > 0).then(|| SlipBounds::new(dynamics, step));
    let may_change = |dynamics: &D, joint: usize| {
        held != Some(Event::Regime(joint)) && slips.as_ref().is_some_and(|slips| slips.may_leave(dynamics, joint))
    };
    let changing = (0..joints).find(|&joint| may_change(dynamics, joint));
    let borders = dynamics.borders();
    let both = [(step.t, &step.start), (step.t + step.h, &step.end)];
    let distant = if borders > 0 { dynamics.distant_borders(both) } else { 0..0 };
    let passed = |dynamics: &mut D, border: usize| {
        let [before, after] = both.map(|(t, z)| dynamics.beyond_border(border, t, z));
        before * after < 0.0
    };
    let is_passed = (0..borders).any(|border| !distant.contains(&border) && passed(dynamics, border));
    let is_held = |switch: usize| held == Some(Event::Switch(switch));
    let mut switching = 0_u64;
    for switch in (0..dynamics.switches().min(64)).filter(|&switch| !is_held(switch)) {
        switching |= u64::from(may_switch(dynamics, switch, step, tolerance)) << switch;
    }
    let knot = passed_knot(dynamics, step);
    let may_pass = may_pass_level(dynamics, step);
    if !(reverses || is_near || changing.is_some() || is_passed || knot.is_some() || switching != 0 || may_pass) {
        return None;
    }
    let dense = dense.get_or_insert_with(|| integrator.dense(dynamics, step));
    if !dense.at(0.5).iter().all(|y| y.is_finite()) {
        return Some(Found { part: 0.25, state: dense.at(0.25), event: Event::Undefined });
    }
    let mut earliest = None;
    // `part`: where in the step the event is, if it is there.
    let mut offer = |part: Option<f64>, event: Event| {
        if let Some(part) = part.filter(|part| earliest.is_none_or(|(other, _)| *part < other)) {
            earliest = Some((part, event));
        }
    };
    let reversal = if reverses { dense.first_passage(1, 0.0, towards(-dynamics.direction()), false) } else { None };
    offer(reversal, Event::Reversal);
    let is_own = |part: &f64| reversal.is_none_or(|reversal| *part < reversal - BEFORE_REVERSAL);
    for joint in changing.unwrap_or(joints)..joints {
        if changing == Some(joint) || may_change(dynamics, joint) {
            offer(regime_change(dynamics, (step, dense), joint).filter(is_own), Event::Regime(joint));
        }
    }
    for switch in (0..64).filter(|switch| switching >> switch & 1 == 1) {
        offer(passage_of_switch(dynamics, integrator, step, dense, switch), Event::Switch(switch));
    }
    if is_passed {
        for border in 0..borders {
            if passed(dynamics, border) {
                offer(Some(border_passage(dynamics, step, dense, border)), Event::Border(border));
            }
        }
    }
    if let Some((knot, direction)) = knot {
        offer(dense.first_passage(0, knot, towards(direction), false), Event::Knot(knot));
    }
    if let Some((part, level)) = may_pass.then(|| first_level(dynamics, dense)).flatten() {
        offer(Some(part), Event::Level(level));
    }
    for side in 0..2 {
        let Some(position) = ends.rigid(side).filter(|&position| near.place(position, side)) else { continue };
        let (place, leaving) = (Place::rigid(side), near.beyond(position, side) >= 0.0);
        offer(dense.first_passage(0, position, towards(outward(side)), leaving), Event::Stop(place));
        offer(back_to_lock(ends, dense, &near, place, position), Event::Stop(place));
    }
    for bumper in 0..ends.bumpers() {
        let touches = contact.touching().contains(bumper);
        let (mut may_push, mut back) = (touches, None::<f64>);
        for side in 0..2 {
            let Some(position) = ends.bumper(side, bumper).filter(|&p| near.place(p, side)) else { continue };
            let (place, leaving) = (Place::of_bumper(side, bumper), near.beyond(position, side) >= 0.0);
            // Coming from inside, the mechanism meets a bumper at its place, where a lock may catch it.
            if !touches {
                offer(dense.first_passage(0, position, towards(outward(side)), leaving), Event::Stop(place));
            }
            may_push |= leaving;
            let caught = back_to_lock(ends, dense, &near, place, position);
            offer(caught, Event::Stop(place));
            back = caught.or(back);
        }
        if may_push {
            let part = bumper_event(dynamics, dense, bumper, touches);
            // An undamped bumper lets go at the very place where the lock catches.
            let is_own = |part: &f64| !touches || back.is_none_or(|back| *part < back - BEFORE_LOCK);
            offer(part.filter(is_own), Event::Bumper(bumper));
        }
        let least = ends.engages_at(Place::of_bumper(0, bumper));
        if touches && least.is_finite() {
            offer(press_event(dynamics, dense, (bumper, least)), Event::Engages(bumper, least));
        }
    }
    let found = earliest.map(|(part, event)| Found { part, state: dense.at(part), event })?;
    if let Event::Border(_) = found.event
        && dynamics.derivative(step.t + found.part * step.h, &found.state)[1].is_nan()
    {
        // Friction locks somewhere before, where no stage of the step was.
        dynamics.take_locked();
        return Some(Found { part: 0.25, state: dense.at(0.25), event: Event::Undefined });
    }
    Some(found)
}

/// The first knot that a step passes, or may pass before it turns back, and the direction in which it does.
#[inline(always)]
fn passed_knot<D: Dynamics<N>, const N: usize>(dynamics: &D, step: &Step<N>) -> Option<(f64, f64)> {
    if !dynamics.has_knots() {
        return None;
    }
    let way = if step.start[1] == 0.0 { step.end[0] - step.start[0] } else { step.start[1] };
    let (direction, turns) = (way.signum(), step.end[1] * way < 0.0);
    let knot = dynamics.next_knot(step.start[0], direction)?;
    let bulge = if turns { step.bulge(0) } else { 0.0 };
    ((step.end[0] - knot) * direction + bulge > AT_KNOT * dynamics.length()).then_some((knot, direction))
}

/// Whether sigma_dot may change its sign within a step. Where friction sticks, it may do so and come back: there it
/// rests.
fn may_reverse<D: Dynamics<N>, const N: usize>(dynamics: &D, step: &Step<N>) -> bool {
    let [start, end] = [step.start[1], step.end[1]].map(|speed| speed * dynamics.direction());
    end < 0.0 || (dynamics.sticks() && start.min(end) < step.bulge(1))
}

/// sigma over a step, as far as it decides whether a place may be passed.
struct Near {
    start: f64,
    end: f64,
    bulge: f64,
}

impl Near {
    /// How far the start of the step is beyond a position.
    #[inline]
    fn beyond(&self, position: f64, side: usize) -> f64 {
        (self.start - position) * outward(side)
    }

    /// Whether a position may be passed or is behind the mechanism.
    #[inline]
    fn place(&self, position: f64, side: usize) -> bool {
        let (start, end) = (self.beyond(position, side), (self.end - position) * outward(side));
        end >= 0.0 || start.max(end) + self.bulge > 0.0
    }

    /// Whether that holds for any place.
    #[inline]
    fn any(&self, ends: &Ends) -> bool {
        let is_near = |position: Option<f64>, side: usize| position.is_some_and(|p| self.place(p, side));
        self.place(ends.limits[0], 0)
            || self.place(ends.limits[1], 1)
            || (0..ends.bumpers()).any(|k| is_near(ends.bumper(0, k), 0) || is_near(ends.bumper(1, k), 1))
    }
}

/// Part of a step after which a mechanism that comes back from beyond a place is there, if a lock is engaged.
fn back_to_lock<const N: usize>(
    ends: &Ends,
    dense: &Dense<N>,
    near: &Near,
    place: Place,
    position: f64,
) -> Option<f64> {
    let comes_back = ends.is_locked(place) && near.beyond(position, place.side) > 0.0;
    comes_back.then(|| dense.first_passage(0, position, towards(-place.outward()), false))?
}

/// How far a state at the time t of the span [s] is past an event, in the unit of what decides: the speed, a push, the
/// slip speed of a joint or a switching quantity. 0 at the event, negative before. Places of stops are told by sigma
/// alone.
pub fn excess<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    contact: &Contact,
    event: Event,
    t: f64,
    z: &[f64; N],
) -> f64 {
    match event {
        Event::Reversal => -dynamics.direction() * z[1],
        Event::Bumper(bumper) => excess_of_bumper(dynamics, bumper, contact.touching().contains(bumper), [z[0], z[1]]),
        Event::Regime(joint) => {
            dynamics.set_time(t);
            excess_of_slip(dynamics, joint, [z[0], z[1]])
        }
        Event::Engages(bumper, least) => dynamics.bumper_push(bumper, z[0], z[1]).1 - least,
        Event::Border(border) => dynamics.beyond_border(border, t, z),
        Event::Knot(sigma) => z[0] - sigma,
        Event::Level(level) => dynamics.level(level, z).map_or(0.0, |level| level.excess(z)),
        Event::Switch(switch) => -dynamics.switch_value(switch, t, z).unwrap_or(f64::NAN),
        Event::Stop(_) | Event::Undefined => 0.0,
    }
}

fn excess_of_slip<D: Dynamics<N>, const N: usize>(dynamics: &mut D, joint: usize, [sigma, sigma_dot]: [f64; 2]) -> f64 {
    let ((low, high), v) = (dynamics.slip_range(joint), dynamics.slip(joint, sigma, sigma_dot));
    (low - v).max(v - high)
}

fn towards(sign: f64) -> Direction {
    if sign > 0.0 { Direction::Rising } else { Direction::Falling }
}

/// Part of a step after which a border is passed that is between its ends: where a state is at it, or else located as a
/// change of regime.
#[cold]
fn border_passage<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    step: &Step<N>,
    dense: &Dense<N>,
    border: usize,
) -> f64 {
    let mut beyond = |part: f64| dynamics.beyond_border(border, step.t + part * step.h, &dense.at(part));
    let [before, after] = [0.0, 1.0].map(&mut beyond);
    let mut there = None;
    let excess = |part: f64| {
        if there.is_none() {
            match beyond(part) * after.signum() {
                0.0 => there = Some(part),
                excess => return excess,
            }
        }
        1.0
    };
    let passed = false_position(excess, (0.0, before * after.signum()), (1.0, after.abs()), REGIME_TOLERANCE);
    there.unwrap_or(passed)
}

/// sigma at an end of a step with its position in the table, and time, sigma_dot and sigma_ddot there.
type SlipEnd = ((f64, TablePosition), [f64; 3]);

/// Both ends of a step, as far as they bound the slip speeds of the friction joints within it.
struct SlipBounds {
    h: f64,
    /// Position, time, sigma_dot and sigma_ddot at the start and at the end; none where the step does not have its
    /// rates.
    ends: Option<[SlipEnd; 2]>,
}

impl SlipBounds {
    fn new<D: Dynamics<N>, const N: usize>(dynamics: &D, step: &Step<N>) -> Self {
        let end = |t: f64, y: &[f64; N], f: &[f64; N]| (dynamics.slip_position(y[0]), [t, y[1], f[1]]);
        let ends =
            |[first, last]: [&[f64; N]; 2]| [end(step.t, &step.start, first), end(step.t + step.h, &step.end, last)];
        Self { h: step.h, ends: step.rates().map(ends) }
    }

    /// Whether the slip speed of a friction joint may leave the range of its regime within the step. Bounds are the
    /// Bezier points of Hermite's cubic for the slip speed, which enclose the cubic, widened by half of their distance
    /// from a straight line.
    fn may_leave<D: Dynamics<N>, const N: usize>(&self, dynamics: &D, joint: usize) -> bool {
        const MARGIN: f64 = 0.5;
        let Some([start, end]) = self.ends else { return true };
        let (low, high) = dynamics.slip_range(joint);
        let [a, rate_a] = dynamics.slip_rate(joint, start.0, start.1);
        let [b, rate_b] = dynamics.slip_rate(joint, end.0, end.1);
        let third = self.h / 3.0;
        let (second, third) = (a + third * rate_a, b - third * rate_b);
        let third_of = (b - a) / 3.0;
        let margin = MARGIN * (second - (a + third_of)).abs().max((third - (b - third_of)).abs());
        // The start is within the range, but for rounding.
        [second, third, b].iter().any(|v| v - margin < low || v + margin > high)
    }
}

/// Part of a step after which the slip speed of a friction joint leaves the range of its regime.
fn regime_change<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    (step, dense): (&Step<N>, &Dense<N>),
    joint: usize,
) -> Option<f64> {
    const PARTS: usize = 8;
    let (low, high) = dynamics.slip_range(joint);
    let dynamics = &RefCell::new(dynamics);
    let time = |s: f64| step.t + s * step.h;
    let f = |s: f64| {
        let mut dynamics = dynamics.borrow_mut();
        dynamics.set_time(time(s));
        let v = dynamics.slip(joint, dense.component(0, s), dense.component(1, s));
        (low - v).max(v - high)
    };
    let motion = dense.bounded([0, 1]);
    let bounds = |a: f64, b: f64| {
        let [sigma, sigma_dot] = motion.enclosures([a, b]);
        let t = Enclosure { value: Interval { low: time(a), high: time(b) }, slope: Interval::point(step.h) };
        let v = dynamics.borrow_mut().slip_bounds(joint, [t, sigma, sigma_dot]);
        (-v + Enclosure::constant(low)).max(v + Enclosure::constant(-high))
    };
    let locate =
        |f: &mut dyn FnMut(f64) -> f64, a: (f64, f64), b: (f64, f64)| false_position(f, a, b, REGIME_TOLERANCE);
    // The start is within the range, but for rounding.
    Bounded { f, bounds, locate }.first_rise(f(0.0).min(0.0), PARTS)
}

mod levels;
mod pushes;
mod switches;
