//! The course of a motion over one communication step: integration from event to event.
//!
//! In: the motion, the travel, what holds. Out: the state at the exact end. Events - impacts on stops, bumpers touched and
//! left, reversals of drives with an efficiency - are roots on the interpolant of a step, polished on the integration itself.
use super::motion::Motion;
use super::travel::{End, Travel};
use crate::friction::{Band, Locked};
use crate::integrator::{Dense, Direction, IntegrationError, Integrator, Step, System};

/// Why a course ended early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stopped {
    /// The integration stopped.
    Integration(IntegrationError),
    /// Friction and reactions have no common solution.
    Locked,
}

impl From<Locked> for Stopped {
    fn from(_: Locked) -> Self {
        Self::Locked
    }
}

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

/// Flight between two impacts below which they are one contact [s].
const FLIGHT: f64 = 1e-10;
/// Height of a flight, in units of the last place of sigma, below which positions do not tell it from rest: four times
/// what the search for the impact takes for rounding.
const HEIGHT: f64 = 64.0 * f64::EPSILON;
/// A change of stretch is met within this part of a step: a law followed so much too far errs by the square of it.
const AT_BORDER: f64 = 1e-11;

/// An event within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    /// The end of the travel on this side is passed.
    End(usize),
    /// The bumper on this side begins or ceases to push.
    Bumper(usize),
    /// sigma_dot changes its sign.
    Reversal,
    /// A pin comes to another stretch of its law.
    Band(usize),
    /// The interpolant tried a state in which friction locks: the step is taken again, shorter.
    Unknown,
}

/// Advance z = (sigma, sigma_dot, energy lost if N = 3) by exactly `span`; returns the energy lost in impacts [J].
///
/// # Errors
/// [`Stopped`].
pub fn advance<'m, const N: usize>(
    integrator: &mut Integrator<N>,
    motion: &mut Motion<'m>,
    around: &Surroundings,
    contact: &mut Contact,
    z: &mut [f64; N],
    span: f64,
    tolerance: f64,
) -> Result<f64, Stopped>
where
    Motion<'m>: System<N>,
{
    let mut lost = 0.0;
    let mut t = 0.0;
    let pins = motion.scene.map_or(&[][..], |s| &s.pins);
    let mut stale = true;
    // A pin whose last change of stretch took no time: it goes along the border and stays where it is for one step.
    let mut along = None;
    while t < span {
        motion.time = t;
        if let Some(side) = contact.resting {
            if around.locked[side] {
                return Ok(lost);
            }
            if rests(motion, around, side, z[0])? {
                let off = |motion: &mut Motion| Ok(-motion.settle(z[0], 0.0)? * outward(side));
                match release(motion, t, span, &off)? {
                    Some(at) if at < span => t = at,
                    _ => return Ok(lost),
                }
            }
            motion.time = t;
            contact.resting = None;
            integrator.restart();
            stale = true;
        }
        if let Some(side) = pushes_out(motion, around, z) {
            lost += strike(motion, around, contact, side, z, tolerance)?;
            integrator.restart();
            stale = true;
            continue;
        }
        if stale {
            meet_bumpers(motion, around, contact, z)?;
            let leaves = |side: usize| z[1] * outward(side) < 0.0 && at(around, side, z[0]);
            if let Some(side) = (0..2).find(|&side| leaves(side) && rigid(motion, around, side)) {
                lost += calm(motion, contact, side, z, tolerance)?;
                if contact.resting.is_some() {
                    continue;
                }
            }
        }
        motion.mode.touching = contact.touching;
        if std::mem::take(&mut stale) {
            motion.set_bands(z[0], z[1]);
        }
        if motion.reverses() {
            motion.mode.direction = motion.direction(z[0], z[1])?;
            if motion.mode.direction == 0.0 {
                let off = |motion: &mut Motion| {
                    let mut most = f64::NEG_INFINITY;
                    for direction in [1.0, -1.0] {
                        motion.mode.direction = direction;
                        most = most.max(motion.effect(z[0], 0.0)?.acceleration * direction);
                    }
                    Ok(most)
                };
                match release(motion, t, span, &off)? {
                    Some(at) if at < span => t = at,
                    _ => return Ok(lost),
                }
                integrator.restart();
                stale = true;
                continue;
            }
        }
        let step = integrator.step(motion, t, z, span, tolerance);
        let step = step.as_ref().map_err(|e| failure(motion, *e))?;
        let Some((s, event)) = first_event(integrator, motion, around, contact, step, along.take()) else {
            *z = step.end;
            t += step.h;
            if step.reached {
                break;
            }
            continue;
        };
        // Land on the event by a step that ends there.
        let mut h = s * step.h;
        let mut there = *z;
        for _ in 0..6 {
            there = integrator.retake(motion, step, h).end;
            let Event::End(side) = event else { break };
            let miss = around.travel[side].map_or(0.0, |e| e.position - there[0]);
            let correction = miss / there[1];
            let small =
                correction.abs() <= 1e-15 * span.max(step.h) || miss.abs() <= 4.0 * f64::EPSILON * there[0].abs();
            let next = h + correction;
            if small || !(next > 0.0 && next <= step.h && correction.abs() < 0.1 * step.h) {
                break;
            }
            h = next;
        }
        *z = there;
        t += h;
        motion.time = t;
        match event {
            Event::Band(_) | Event::Unknown => integrator.refresh(),
            _ => {
                integrator.restart();
                stale = true;
            }
        }
        match event {
            Event::End(side) => lost += strike(motion, around, contact, side, z, tolerance)?,
            Event::Bumper(side) => {
                contact.touching[side] =
                    if contact.touching[side].is_some() { None } else { bumper(motion, around, side) };
            }
            Event::Reversal => z[1] = 0.0,
            Event::Unknown => {}
            Event::Band(pin) => {
                let (law, band) = (pins[pin].law, motion.work.acting.bands[pin].unwrap_or(Band::Ramp));
                let next = law.next(band, motion.slip(pin, z[0], z[1]));
                motion.set_band(pin, Some(next));
                if s <= AT_BORDER {
                    along = Some(pin);
                }
            }
        }
    }
    Ok(lost)
}

/// When what holds the mechanism at rest lets it go, under inputs that change with time: where `off`, <= 0 at t = `from`
/// while it is held, becomes positive before `end`. At rest it is a parabola in time for every direction of the drives and
/// without air; a passage there and back within a 64th of the time is not seen.
///
/// # Errors
/// [`Locked`].
fn release(
    motion: &mut Motion,
    from: f64,
    end: f64,
    off: &dyn Fn(&mut Motion) -> Result<f64, Locked>,
) -> Result<Option<f64>, Locked> {
    const SAMPLES: usize = 64;
    const CLOSE: f64 = 1e-15;
    if motion.given.change.is_none() {
        return Ok(None);
    }
    let time = |s: f64| from + (end - from) * s;
    let (mut a, mut at_a) = (0.0, off(motion)?.min(0.0));
    for i in 1..=SAMPLES {
        let b = i as f64 / SAMPLES as f64;
        motion.time = time(b);
        let at_b = off(motion)?;
        if at_b > 0.0 {
            let mut beyond = |s: f64| {
                motion.time = time(s);
                off(motion).unwrap_or(-1.0)
            };
            return Ok(Some(time(passage(&mut beyond, (a, at_a), (b, at_b), CLOSE))));
        }
        (a, at_a) = (b, at_b);
    }
    Ok(None)
}

fn failure(motion: &Motion, error: IntegrationError) -> Stopped {
    if motion.locked { Stopped::Locked } else { Stopped::Integration(error) }
}

fn towards(sign: f64) -> Direction {
    if sign > 0.0 { Direction::Rising } else { Direction::Falling }
}

fn outward(side: usize) -> f64 {
    if side == 0 { -1.0 } else { 1.0 }
}

/// The scene's bumper at an end.
fn bumper(motion: &Motion, around: &Surroundings, side: usize) -> Option<usize> {
    let end = around.travel[side]?;
    motion.scene.and_then(|s| s.bumpers.iter().position(|&b| b == end.stop))
}

fn rigid(motion: &Motion, around: &Surroundings, side: usize) -> bool {
    around.travel[side].is_some_and(|e| motion.reduced.loading().stops[e.stop].rigid)
}

/// Whether a mechanism at rest at an end stays there: the loads press it against a rigid stop.
pub fn rests(motion: &mut Motion, around: &Surroundings, side: usize, sigma: f64) -> Result<bool, Locked> {
    Ok(rigid(motion, around, side) && motion.settle(sigma, 0.0)? * outward(side) >= 0.0)
}

/// Whether the mechanism is exactly at an end.
fn at(around: &Surroundings, side: usize, sigma: f64) -> bool {
    around.travel[side].is_some_and(|e| sigma == e.position)
}

/// A mechanism that sets out from the place of a bumper, outward, presses it from the start on.
fn meet_bumpers<const N: usize>(
    motion: &mut Motion,
    around: &Surroundings,
    contact: &mut Contact,
    z: &[f64; N],
) -> Result<(), Locked> {
    for side in 0..2 {
        if let (true, None, Some(k)) = (at(around, side, z[0]), contact.touching[side], bumper(motion, around, side)) {
            let outward = outward(side);
            if z[1] * outward > 0.0 || (z[1] == 0.0 && motion.settle(z[0], 0.0)? * outward > 0.0) {
                contact.touching[side] = Some(k);
            }
        }
    }
    Ok(())
}

/// Side on which the mechanism is at a rigid end, or at a lock that is engaged, and moves outward.
fn pushes_out<const N: usize>(motion: &Motion, around: &Surroundings, z: &[f64; N]) -> Option<usize> {
    (0..2).find(|&side| {
        let moves = z[1] * outward(side) > 0.0;
        let at = around.travel[side].is_some_and(|e| (z[0] - e.position) * outward(side) >= 0.0);
        moves && at && rigid(motion, around, side)
    })
}

/// The mechanism comes to an end of its travel: it is caught, bounces, comes to rest or meets a bumper. Returns the energy
/// lost [J].
fn strike<const N: usize>(
    motion: &mut Motion,
    around: &Surroundings,
    contact: &mut Contact,
    side: usize,
    z: &mut [f64; N],
    tolerance: f64,
) -> Result<f64, Locked> {
    let Some(end) = around.travel[side] else { return Ok(0.0) };
    let before = 0.5 * z[1] * z[1];
    z[0] = end.position;
    if around.locked[side] {
        z[1] = 0.0;
        contact.resting = Some(side);
        return Ok(before);
    }
    if !rigid(motion, around, side) {
        if z[1] * outward(side) > 0.0 {
            contact.touching[side] = bumper(motion, around, side);
        }
        return Ok(0.0);
    }
    // Newton's law of impact.
    z[1] *= -motion.reduced.loading().stops[end.stop].restitution;
    let after = 0.5 * z[1] * z[1];
    Ok(before - after + calm(motion, contact, side, z, tolerance)?)
}

/// A mechanism that leaves a rigid end against the loads comes to rest there if its flight is too short or too low.
/// Returns the energy lost [J].
fn calm<const N: usize>(
    motion: &mut Motion,
    contact: &mut Contact,
    side: usize,
    z: &mut [f64; N],
    tolerance: f64,
) -> Result<f64, Locked> {
    let speed = -z[1] * outward(side);
    if speed < 0.0 {
        return Ok(0.0);
    }
    let rests = speed == 0.0 || {
        let press = motion.settle(z[0], 0.0)? * outward(side);
        let shortest = FLIGHT.max(0.1 * tolerance * (motion.reduced.scale() / press.abs()).sqrt());
        let (duration, height) = (2.0 * speed / press, 0.5 * speed * speed / press);
        press > 0.0 && (duration < shortest || height < HEIGHT * z[0].abs())
    };
    if !rests {
        return Ok(0.0);
    }
    z[1] = 0.0;
    contact.resting = Some(side);
    Ok(0.5 * speed * speed)
}

/// The first event in a step, and the part of the step before it.
fn first_event<'m, const N: usize>(
    integrator: &mut Integrator<N>,
    motion: &mut Motion<'m>,
    around: &Surroundings,
    contact: &Contact,
    step: &Step<N>,
    along: Option<usize>,
) -> Option<(f64, Event)>
where
    Motion<'m>: System<N>,
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
    let pins = motion.scene.map_or(0, |s| s.pins.len());
    let changing = (0..pins).find(|&pin| along != Some(pin) && may_change(motion, pin, step));
    if !(reverses || sides[0] || sides[1] || changing.is_some()) {
        return None;
    }
    let dense = integrator.dense(motion, step);
    if !dense.at(0.5).iter().all(|y| y.is_finite()) {
        return Some((0.25, Event::Unknown));
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
    for pin in (changing.unwrap_or(pins)..pins).filter(|p| along != Some(*p)) {
        if changing == Some(pin) || may_change(motion, pin, step) {
            offer(change_of_band(motion, &dense, pin), Event::Band(pin));
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
            offer(bumper_event(motion, &dense, k, touches), Event::Bumper(side));
            if around.locked[side] {
                // Coming back from beyond.
                let beyond = (step.start[0] - end.position) * outward(side) > 0.0;
                if beyond {
                    offer(dense.first_passage(0, end.position, towards(-outward(side)), false), Event::End(side));
                }
            }
        }
    }
    first
}

/// Part of a step after which a bumper that touches lets go, or one that is pressed while it does not push begins to.
fn bumper_event<const N: usize>(motion: &mut Motion, dense: &Dense<N>, k: usize, touches: bool) -> Option<f64> {
    const SAMPLES: usize = 12;
    let mut passed = |s: f64| {
        let y = dense.at(s);
        let (beyond, push) = motion.pressure(k, y[0], y[1]);
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
fn may_change<const N: usize>(motion: &mut Motion, pin: usize, step: &Step<N>) -> bool {
    const ROOM: f64 = 0.5;
    let (Some(scene), Some([first, last])) = (motion.scene, step.rates()) else { return true };
    let law = scene.pins[pin].law;
    let (low, high) = law.range(motion.work.acting.bands[pin].unwrap_or(Band::Ramp));
    let [a, rate_a] = motion.slip_rate(pin, [step.start[0], step.start[1], first[1]]);
    let [b, rate_b] = motion.slip_rate(pin, [step.end[0], step.end[1], last[1]]);
    let (second, third) = (a + step.h / 3.0 * rate_a, b - step.h / 3.0 * rate_b);
    let third_of = (b - a) / 3.0;
    let room = ROOM * (second - (a + third_of)).abs().max((third - (b - third_of)).abs());
    // The start is within the stretch, but for rounding.
    second.min(third).min(b) - room < low || second.max(third).max(b) + room > high
}

/// Part of a step after which a pin's slip speed leaves its stretch.
fn change_of_band<const N: usize>(motion: &mut Motion, dense: &Dense<N>, pin: usize) -> Option<f64> {
    const SAMPLES: usize = 8;
    let law = motion.scene?.pins[pin].law;
    let (low, high) = law.range(motion.work.acting.bands[pin]?);
    // How far beyond the stretch; negative within.
    let mut beyond = |s: f64| {
        let y = dense.at(s);
        let v = motion.slip(pin, y[0], y[1]);
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

/// Where a function passes from <= 0 at a to > 0 at b, on the far side, within `close`: false position after Illinois (Dowell and Jarratt,
/// BIT 11 (1971), 168), with halving where it is slow.
fn passage(
    f: &mut dyn FnMut(f64) -> f64,
    (mut a, mut at_a): (f64, f64),
    (mut b, mut at_b): (f64, f64),
    close: f64,
) -> f64 {
    for k in 0..100 {
        if b - a <= close {
            break;
        }
        let line = b - at_b * (b - a) / (at_b - at_a);
        let c = if k % 8 == 7 || !(a < line && line < b) { 0.5 * (a + b) } else { line };
        let at_c = f(c);
        if at_c > 0.0 {
            (b, at_b) = (c, at_c);
            at_a *= 0.5;
        } else {
            (a, at_a) = (c, at_c);
            at_b *= 0.5;
        }
    }
    b
}
