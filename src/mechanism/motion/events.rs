//! Events: where within a step something begins or ceases.
//!
//! In: a step, what is at the ends of the travel. Out: the first event in it, a root on the interpolant. What cannot be is
//! ruled out by bounds first, as most steps have none. It must not know what follows from an event.
use crate::codec::record::{Damaged, Record};
use crate::integrator::{Dense, Direction, Integrator, Step, System};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::motion::travel::{End, Travel};

/// What is at the ends of the travel during a step; positions in the frame of sigma.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Ends.
    pub travel: Travel,
    /// Whether a lock is engaged there.
    pub locked: [bool; 2],
}

/// Where the motion is besides its sigma and sigma_dot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// End at which the mechanism rests.
    pub resting: Option<usize>,
    /// Bumper, by its place in the scene, in contact at each end.
    pub touching: [Option<usize>; 2],
}

/// A change of stretch is met within this part of a step: a law followed so much too far errs by the square of it.
pub const AT_BORDER: f64 = 1e-11;

/// An event within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The end of the travel on this side is passed.
    End(usize),
    /// The bumper on this side begins or ceases to push.
    Bumper(usize),
    /// sigma_dot changes its sign.
    Reversal,
    /// A pin comes to another stretch of its law.
    Regime(usize),
    /// The interpolant tried a state in which friction locks: the step is taken again, shorter.
    Unknown,
}

impl Event {
    /// Written or read, if it is known.
    ///
    /// # Errors
    /// There is no such event.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let (mut kind, mut place) = match *self {
            Self::End(side) => (0, side),
            Self::Bumper(side) => (1, side),
            Self::Reversal => (2, 0),
            Self::Regime(friction_joint) => (3, friction_joint),
            Self::Unknown => return Err(Damaged("event: none that is known".to_owned())),
        };
        record.choice("event", &mut kind, 4)?;
        record.place("place of an event", &mut place, if kind < 3 { 2 } else { usize::MAX })?;
        *self = match kind {
            0 => Self::End(place),
            1 => Self::Bumper(place),
            2 => Self::Reversal,
            _ => Self::Regime(place),
        };
        Ok(())
    }
}

/// The first event in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found<const N: usize> {
    /// Part of the step before it.
    pub part: f64,
    /// The interpolant there.
    pub state: [f64; N],
    /// What begins or ceases.
    pub event: Event,
}

pub fn outward(side: usize) -> f64 {
    if side == 0 { -1.0 } else { 1.0 }
}

/// The scene's bumper at an end.
pub fn bumper(motion: &EquationOfMotion, around: &Surroundings, side: usize) -> Option<usize> {
    let end = around.travel[side]?;
    motion.state_loads.and_then(|s| s.bumpers.iter().position(|&b| b == end.stop))
}

/// The first event in a step, with its interpolant if that was needed.
pub fn first_event<'m, const N: usize>(
    integrator: &mut Integrator<N>,
    motion: &mut EquationOfMotion<'m>,
    around: &Surroundings,
    contact: &Contact,
    step: &Step<N>,
    along: Option<usize>,
    dense: &mut Option<Dense<N>>,
) -> Option<Found<N>>
where
    EquationOfMotion<'m>: System<N>,
{
    let reverses = motion.reverses() && step.end[1] * motion.mode.direction < 0.0;
    let bulge = step.bulge(0);
    let near = |side: usize| {
        let beyond = |e: End, z: &[f64; N]| (z[0] - e.position) * outward(side);
        around.travel[side].is_some_and(|e| {
            let (start, end) = (beyond(e, &step.start), beyond(e, &step.end));
            end >= 0.0 || start.max(end) + bulge > 0.0
        })
    };
    let sides = [near(0), near(1)];
    let friction_joints = motion.state_loads.map_or(0, |s| s.friction_joints.len());
    let changing = (0..friction_joints)
        .find(|&friction_joint| along != Some(friction_joint) && may_change(motion, friction_joint, step));
    if !(reverses || sides[0] || sides[1] || changing.is_some()) {
        return None;
    }
    let dense = dense.get_or_insert_with(|| integrator.dense(motion, step));
    if !dense.at(0.5).iter().all(|y| y.is_finite()) {
        return Some(Found { part: 0.25, state: dense.at(0.25), event: Event::Unknown });
    }
    let mut first: Option<(f64, Event)> = None;
    let mut offer = |s: Option<f64>, event: Event| {
        if let Some(s) = s
            && first.is_none_or(|(other, _)| s < other)
        {
            first = Some((s, event));
        }
    };
    if reverses {
        offer(dense.first_passage(1, 0.0, towards(-motion.mode.direction), false), Event::Reversal);
    }
    for friction_joint in (changing.unwrap_or(friction_joints)..friction_joints).filter(|p| along != Some(*p)) {
        if changing == Some(friction_joint) || may_change(motion, friction_joint, step) {
            offer(change_of_regime(motion, dense, friction_joint), Event::Regime(friction_joint));
        }
    }
    for side in (0..2).filter(|&side| sides[side]) {
        let Some(end) = around.travel[side] else { continue };
        let leaving = (step.start[0] - end.position) * outward(side) >= 0.0;
        if contact.touching[side].is_none() {
            offer(dense.first_passage(0, end.position, towards(outward(side)), leaving), Event::End(side));
        }
        if let Some(k) = bumper(motion, around, side) {
            let touches = contact.touching[side].is_some();
            // Coming from inside it is met at its end of the travel, where a lock may catch the mechanism.
            if touches || leaving {
                offer(bumper_event(motion, dense, k, touches), Event::Bumper(side));
            }
            if around.locked[side] {
                // Coming back from beyond.
                let beyond = (step.start[0] - end.position) * outward(side) > 0.0;
                if beyond {
                    offer(dense.first_passage(0, end.position, towards(-outward(side)), false), Event::End(side));
                }
            }
        }
    }
    first.map(|(part, event)| Found { part, state: dense.at(part), event })
}

fn towards(sign: f64) -> Direction {
    if sign > 0.0 { Direction::Rising } else { Direction::Falling }
}

/// Part of a step after which a bumper that touches lets go, or one that is pressed while it does not push begins to.
fn bumper_event<const N: usize>(
    motion: &mut EquationOfMotion,
    dense: &Dense<N>,
    k: usize,
    touches: bool,
) -> Option<f64> {
    const SAMPLES: usize = 12;
    let mut passed = |s: f64| {
        let (beyond, push) = motion.pressure(k, dense.component(0, s), dense.component(1, s));
        // A bumper that touches lets go when it would pull; one that does not begins when it would push, if it is pressed.
        if touches { push < 0.0 } else { beyond > 0.0 && push > 0.0 }
    };
    // At the start, just after an event, it may be so by rounding.
    let mut before = passed(0.0);
    for i in 1..=SAMPLES {
        let (mut a, mut b) = ((i - 1) as f64 / SAMPLES as f64, i as f64 / SAMPLES as f64);
        let now = passed(b);
        if now && !before {
            for _ in 0..60 {
                let middle = 0.5 * (a + b);
                if passed(middle) { b = middle } else { a = middle }
            }
            return Some(b);
        }
        before = now;
    }
    None
}

/// Whether a pin may come to another stretch of its law within a step, judged by Bezier's points of Hermite's cubic for its slip
/// speed, which are around the cubic, and half as much room as they are off a straight line.
fn may_change<const N: usize>(motion: &mut EquationOfMotion, friction_joint: usize, step: &Step<N>) -> bool {
    const ROOM: f64 = 0.5;
    let (Some(state_loads), Some([first, last])) = (motion.state_loads, step.rates()) else { return true };
    let law = state_loads.friction_joints[friction_joint].law;
    let (low, high) = law.range(motion.scratch.evaluator.regime(friction_joint).unwrap_or(Regime::Viscous));
    let [a, rate_a] = motion.slip_rate(friction_joint, [step.start[0], step.start[1], first[1]]);
    let [b, rate_b] = motion.slip_rate(friction_joint, [step.end[0], step.end[1], last[1]]);
    let (second, third) = (a + step.h / 3.0 * rate_a, b - step.h / 3.0 * rate_b);
    let third_of = (b - a) / 3.0;
    let room = ROOM * (second - (a + third_of)).abs().max((third - (b - third_of)).abs());
    // The start is within the stretch, but for rounding.
    second.min(third).min(b) - room < low || second.max(third).max(b) + room > high
}

/// Part of a step after which a pin's slip speed leaves its stretch.
fn change_of_regime<const N: usize>(
    motion: &mut EquationOfMotion,
    dense: &Dense<N>,
    friction_joint: usize,
) -> Option<f64> {
    const SAMPLES: usize = 8;
    let law = motion.state_loads?.friction_joints[friction_joint].law;
    let (low, high) = law.range(motion.scratch.evaluator.regime(friction_joint)?);
    // How far beyond the stretch; negative within.
    let mut beyond = |s: f64| {
        let v = motion.slip(friction_joint, dense.component(0, s), dense.component(1, s));
        (low - v).max(v - high)
    };
    let (mut a, mut at_a) = (0.0, beyond(0.0).min(0.0));
    for i in 1..=SAMPLES {
        let b = i as f64 / SAMPLES as f64;
        let at_b = beyond(b);
        if at_b > 0.0 {
            return Some(passage(&mut beyond, (a, at_a), (b, at_b), AT_BORDER));
        }
        (a, at_a) = (b, at_b);
    }
    None
}

/// Where a function passes from <= 0 at a to > 0 at b, on the far side, within `close`: false position after Anderson and Bjoerck
/// (BIT 13 (1973), 253), at least half of `close` off either end, so that the other side is met too; with halving where it is slow.
pub fn passage(
    f: &mut dyn FnMut(f64) -> f64,
    (mut a, mut at_a): (f64, f64),
    (mut b, mut at_b): (f64, f64),
    close: f64,
) -> f64 {
    let less = |part: f64| if part < 1.0 { 1.0 - part } else { 0.5 };
    let mut last = 0.0;
    for k in 0..100 {
        if b - a <= close {
            break;
        }
        let line = (b - at_b * (b - a) / (at_b - at_a)).min(b - 0.5 * close).max(a + 0.5 * close);
        let halve = if k < 16 { k % 8 == 7 } else { k % 2 == 0 };
        let c = if halve || !(a < line && line < b) { 0.5 * (a + b) } else { line };
        let at_c = f(c);
        if at_c > 0.0 {
            // An end that stays for the second time counts for less.
            at_a *= if last > 0.0 { less(at_c / at_b) } else { 1.0 };
            (b, at_b) = (c, at_c);
        } else {
            at_b *= if last < 0.0 { less(at_c / at_a) } else { 1.0 };
            (a, at_a) = (c, at_c);
        }
        last = if at_c > 0.0 { 1.0 } else { -1.0 };
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_passage_is_met_on_the_far_side_in_few_calls() {
        let functions: [(&dyn Fn(f64) -> f64, f64); 4] = [
            (&|x| x.exp() - 2.0, 2.0_f64.ln()),
            (&|x| (x - 0.3).powi(3), 0.3),
            (&|x| if x > 0.7 { 1.0 } else { -1e-9 }, 0.7),
            (&|x| 1e-3 - (x - 1.0).powi(2), 1.0 - 1e-3_f64.sqrt()),
        ];
        for (n, (f, exact)) in functions.iter().enumerate() {
            let mut calls = 0;
            let mut counted = |x: f64| {
                calls += 1;
                f(x)
            };
            let at = passage(&mut counted, (0.0, f(0.0)), (1.0, f(1.0)), 1e-11);
            println!("{n}: {calls}");
            assert!(f(at) > 0.0 && at - exact <= 1.1e-11, "{n}: {at}");
            assert!(calls <= [9, 90, 90, 14][n], "{n}: {calls}");
        }
    }
}
