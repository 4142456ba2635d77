//! Events: where within a step a contact, a regime of friction or the direction of the drives changes.
//!
//! In: a step, the ends of the travel and the contact there. Out: the earliest event in the step, a root on its
//! interpolant. Bounds rule out first what cannot be, as most steps have no event. It must not know what follows from
//! an event.
use crate::codec::record::{Damaged, Record};
use crate::integrator::{Dense, Direction, Integrator, Step};
use crate::mechanism::motion::contact::{Contact, Ends, outward};
use crate::mechanism::motion::dynamics::Dynamics;
use crate::numerics::bracket::{bisect, first_rise};
use std::convert::Infallible;

/// Part of a step within which a change of regime is located: a law followed so much too far errs by the square of it.
pub const REGIME_TOLERANCE: f64 = 1e-11;

/// An event within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The end of the travel on this side is passed.
    End(usize),
    /// The bumper on this side begins or ceases to push.
    Bumper(usize),
    /// sigma_dot changes its sign.
    Reversal,
    /// The slip speed of a friction joint leaves the range of its regime.
    Regime(usize),
    /// The interpolant has no finite value, as friction locks in a state that it tried: the step is taken again,
    /// shorter.
    Undefined,
}

impl Event {
    /// Written or read; [`Self::Undefined`] is not one to keep.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let (mut kind, mut index) = match *self {
            Self::End(side) => (0, side),
            Self::Bumper(side) => (1, side),
            Self::Reversal => (2, 0),
            Self::Regime(joint) => (3, joint),
            Self::Undefined => return Err(Damaged("event: an undefined one is not kept".to_owned())),
        };
        record.choice("event", &mut kind, 4)?;
        record.place("index of an event", &mut index, if kind < 3 { 2 } else { usize::MAX })?;
        *self = match kind {
            0 => Self::End(index),
            1 => Self::Bumper(index),
            2 => Self::Reversal,
            _ => Self::Regime(index),
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

/// The earliest event in a step; `dense` becomes the interpolant of the step if that was needed. The friction joint
/// `held_regime` keeps its regime over the step.
pub fn earliest_event<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    integrator: &mut Integrator<N>,
    (ends, contact): (&Ends, &Contact),
    step: &Step<N>,
    held_regime: Option<usize>,
    dense: &mut Option<Dense<N>>,
) -> Option<Found<N>> {
    let reverses = dynamics.has_reversals() && step.end[1] * dynamics.direction() < 0.0;
    let bulge = step.bulge(0);
    let is_near = [0, 1].map(|side| {
        ends.travel[side].is_some_and(|end| {
            let beyond = |z: &[f64; N]| (z[0] - end.position) * outward(side);
            let (start, end) = (beyond(&step.start), beyond(&step.end));
            end >= 0.0 || start.max(end) + bulge > 0.0
        })
    });
    let joints = dynamics.friction_joints();
    let changing = (0..joints).find(|&joint| held_regime != Some(joint) && may_change_regime(dynamics, joint, step));
    if !(reverses || is_near[0] || is_near[1] || changing.is_some()) {
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
    if reverses {
        let passage = dense.first_passage(1, 0.0, towards(-dynamics.direction()), false);
        offer(passage, Event::Reversal);
    }
    for joint in (changing.unwrap_or(joints)..joints).filter(|joint| held_regime != Some(*joint)) {
        if changing == Some(joint) || may_change_regime(dynamics, joint, step) {
            offer(regime_change(dynamics, dense, joint), Event::Regime(joint));
        }
    }
    for side in (0..2).filter(|&side| is_near[side]) {
        let Some(end) = ends.travel[side] else { continue };
        let beyond = (step.start[0] - end.position) * outward(side);
        let leaving = beyond >= 0.0;
        let touches = contact.touching()[side].is_some();
        if !touches {
            let passage = dense.first_passage(0, end.position, towards(outward(side)), leaving);
            offer(passage, Event::End(side));
        }
        let Some(bumper) = ends.bumper(side) else { continue };
        // Coming from inside, the mechanism meets a bumper at the end of the travel, where a lock may catch it.
        if touches || leaving {
            offer(bumper_event(dynamics, dense, bumper, touches), Event::Bumper(side));
        }
        // A lock catches a mechanism that comes back from beyond the end, too.
        if ends.locked[side] && beyond > 0.0 {
            let passage = dense.first_passage(0, end.position, towards(-outward(side)), false);
            offer(passage, Event::End(side));
        }
    }
    earliest.map(|(part, event)| Found { part, state: dense.at(part), event })
}

fn towards(sign: f64) -> Direction {
    if sign > 0.0 { Direction::Rising } else { Direction::Falling }
}

/// Part of a step after which a bumper that touches would pull, so that it lets go; or one that does not touch, but is
/// pressed, would push, so that it begins to.
fn bumper_event<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    dense: &Dense<N>,
    bumper: usize,
    touches: bool,
) -> Option<f64> {
    const SAMPLES: usize = 12;
    let mut is_past = |s: f64| {
        let (beyond, push) = dynamics.bumper_push(bumper, dense.component(0, s), dense.component(1, s));
        if touches { push < 0.0 } else { beyond > 0.0 && push > 0.0 }
    };
    // At the start, just after an event, it may be so by rounding.
    let at = |i: usize| i as f64 / SAMPLES as f64;
    let mut now = is_past(0.0);
    let end = (1..=SAMPLES).find(|&i| !std::mem::replace(&mut now, is_past(at(i))) && now)?;
    Some(bisect(is_past, at(end - 1), at(end))[1])
}

/// Whether the slip speed of a friction joint may leave the range of its regime within a step. Bounds are the Bezier
/// points of Hermite's cubic for the slip speed, which enclose the cubic, widened by half of their distance from a
/// straight line.
fn may_change_regime<D: Dynamics<N>, const N: usize>(dynamics: &mut D, joint: usize, step: &Step<N>) -> bool {
    const MARGIN: f64 = 0.5;
    let Some([first, last]) = step.rates() else { return true };
    let (low, high) = dynamics.slip_range(joint);
    let [a, rate_a] = dynamics.slip_rate(joint, [step.start[0], step.start[1], first[1]]);
    let [b, rate_b] = dynamics.slip_rate(joint, [step.end[0], step.end[1], last[1]]);
    let (second, third) = (a + step.h / 3.0 * rate_a, b - step.h / 3.0 * rate_b);
    let third_of = (b - a) / 3.0;
    let margin = MARGIN * (second - (a + third_of)).abs().max((third - (b - third_of)).abs());
    // The start is within the range, but for rounding.
    second.min(third).min(b) - margin < low || second.max(third).max(b) + margin > high
}

/// Part of a step after which the slip speed of a friction joint leaves the range of its regime.
fn regime_change<D: Dynamics<N>, const N: usize>(dynamics: &mut D, dense: &Dense<N>, joint: usize) -> Option<f64> {
    const SAMPLES: usize = 8;
    let (low, high) = dynamics.slip_range(joint);
    let beyond = |s: f64| {
        let v = dynamics.slip(joint, dense.component(0, s), dense.component(1, s));
        Ok::<_, Infallible>((low - v).max(v - high))
    };
    let Ok(part) = first_rise(beyond, SAMPLES, REGIME_TOLERANCE);
    part
}
