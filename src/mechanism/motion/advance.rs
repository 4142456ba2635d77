//! The course of a motion over one communication step: integration from event to event.
//!
//! In: the motion, the travel, what holds. Out: the state at the exact end. Events - impacts on stops, bumpers touched and
//! left, reversals of drives with an efficiency, changes of friction's stretch - are found on the interpolant of a step; impacts are
//! polished on the integration itself. A step may go on beyond the communication step (`step_ahead.rs`).
use crate::integrator::{Dense, IntegrationError, Integrator, Step, System};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::motion::events::{
    AT_BORDER, Contact, Event, Found, Surroundings, bumper, first_event, outward, passage,
};
use crate::mechanism::motion::step_ahead::{Lookahead, StepAhead};

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

/// Flight between two impacts below which they are one contact [s].
const FLIGHT: f64 = 1e-10;
/// Height of a flight, in units of the last place of sigma, below which positions do not tell it from rest: four times
/// what the search for the impact takes for rounding.
const HEIGHT: f64 = 64.0 * f64::EPSILON;

/// What an advance goes by from one step to the next.
struct Way<'a> {
    around: &'a Surroundings,
    tolerance: f64,
    /// Energy lost in impacts [J].
    lost: f64,
    /// Whether the state has jumped: what is in touch and where pins are on their laws is to be looked at anew.
    stale: bool,
    /// A pin whose last change of stretch took no time: it goes along the border and stays where it is for one step.
    along: Option<usize>,
}

/// Advance z = (sigma, sigma_dot, energy lost if N = 3) by exactly `span`; returns the energy lost in impacts [J].
///
/// # Errors
/// [`Stopped`].
#[expect(clippy::too_many_arguments, reason = "what is integrated, by whom, from where to where")]
pub fn advance<'m, const N: usize>(
    integrator: &mut Integrator<N>,
    lookahead: &mut Lookahead<N>,
    motion: &mut EquationOfMotion<'m>,
    around: &Surroundings,
    contact: &mut Contact,
    z: &mut [f64; N],
    span: f64,
    tolerance: f64,
) -> Result<f64, Stopped>
where
    EquationOfMotion<'m>: System<N>,
{
    let mut way = Way { around, tolerance, lost: 0.0, stale: true, along: None };
    let mut t = 0.0;
    if let Some(ahead) = &mut lookahead.step_ahead {
        if span < ahead.rest() {
            *z = ahead.read(span);
            return Ok(0.0);
        }
        t = ahead.rest();
        *z = ahead.last();
        motion.time = t;
        let middle = ahead.middle();
        motion.set_regimes(middle[0], middle[1]);
        way.stale = false;
        let event = ahead.event;
        lookahead.step_ahead = None;
        if let Some(event) = event {
            happen((event, false), integrator, motion, contact, z, &mut way)?;
        }
    }
    let mut may_pass = lookahead.is_calm();
    while t < span {
        motion.time = t;
        if let Some(side) = contact.resting {
            if around.locked[side] {
                return Ok(way.lost);
            }
            if rests(motion, around, side, z[0])? {
                let off = |motion: &mut EquationOfMotion| Ok(-motion.settle(z[0], 0.0)? * outward(side));
                match release(motion, t, span, &off)? {
                    Some(at) if at < span => t = at,
                    _ => return Ok(way.lost),
                }
            }
            motion.time = t;
            contact.resting = None;
            integrator.restart();
            way.stale = true;
            // Between two stops at one place, what one lets go the other may hold.
            let other = 1 - side;
            if at(around, other, z[0]) && (around.locked[other] || rests(motion, around, other, z[0])?) {
                contact.resting = Some(other);
                continue;
            }
        }
        if let Some(side) = pushes_out(motion, around, z) {
            way.lost += strike(motion, around, contact, side, z, tolerance)?;
            integrator.restart();
            way.stale = true;
            continue;
        }
        if way.stale {
            meet_bumpers(motion, around, contact, z)?;
            let leaves = |side: usize| z[1] * outward(side) < 0.0 && at(around, side, z[0]);
            if let Some(side) = (0..2).find(|&side| leaves(side) && rigid(motion, around, side)) {
                way.lost += calm(motion, contact, side, z, tolerance)?;
                if contact.resting.is_some() {
                    continue;
                }
            }
        }
        motion.mode.touching = contact.touching;
        if std::mem::take(&mut way.stale) {
            motion.set_regimes(z[0], z[1]);
        }
        if motion.reverses() {
            motion.mode.direction = motion.direction(z[0], z[1])?;
            if motion.mode.direction == 0.0 {
                let off = |motion: &mut EquationOfMotion| {
                    let mut most = f64::NEG_INFINITY;
                    for direction in [1.0, -1.0] {
                        motion.mode.direction = direction;
                        most = most.max(motion.effect(z[0], 0.0)?.acceleration * direction);
                    }
                    Ok(most)
                };
                match release(motion, t, span, &off)? {
                    Some(at) if at < span => t = at,
                    _ => return Ok(way.lost),
                }
                integrator.restart();
                way.stale = true;
                continue;
            }
        }
        let beyond = may_pass && integrator.outlasts(span - t);
        let step = integrator.step(motion, t, z, if beyond { f64::INFINITY } else { span }, tolerance);
        let step = match &step {
            Ok(step) => step,
            Err(_) if beyond => {
                // What is beyond the span is of no concern yet.
                lookahead.failed();
                (may_pass, motion.locked) = (false, false);
                continue;
            }
            Err(error) => return Err(failure(motion, *error)),
        };
        let mut dense = None;
        let along = way.along.take();
        let found = first_event(integrator, motion, around, contact, step, along, &mut dense);
        let retaken = found.as_ref().and_then(|found| {
            let exact = dense.as_ref().is_some_and(|dense| is_exact(motion, step, dense, tolerance));
            land(integrator, motion, around, step, found, exact)
        });
        let (h, there) = match (&found, &retaken) {
            (_, Some(retaken)) => (retaken.h, retaken.end),
            (Some(found), None) => (found.part * step.h, found.state),
            (None, None) => (step.h, step.end),
        };
        if beyond && t + h > span {
            let kept = retaken.as_ref().unwrap_or(step);
            let dense = dense.filter(|_| retaken.is_none()).unwrap_or_else(|| integrator.dense(motion, kept));
            if !is_exact(motion, kept, &dense, tolerance) {
                // To be made again, to the end of the span.
                lookahead.failed();
                integrator.branch_off();
                (may_pass, way.along) = (false, along);
                continue;
            }
            let event = found.map(|found| found.event).filter(|event| *event != Event::Unknown);
            let mut ahead = StepAhead { dense, h: kept.h, end: h, there, event, now: 0.0, from: [0.0; N] };
            *z = ahead.read(span - t);
            lookahead.keep(ahead);
            break;
        }
        *z = there;
        t += h;
        motion.time = t;
        match found {
            Some(Found { event, part, .. }) => {
                happen((event, part <= AT_BORDER), integrator, motion, contact, z, &mut way)?;
            }
            None if step.reached => break,
            None => {}
        }
    }
    Ok(way.lost)
}

/// Whether states may be taken from the interpolant of a step.
fn is_exact<'m, const N: usize>(
    motion: &mut EquationOfMotion<'m>,
    step: &Step<N>,
    dense: &Dense<N>,
    tolerance: f64,
) -> bool
where
    EquationOfMotion<'m>: System<N>,
{
    let Some([first, _]) = step.rates() else { return false };
    let scale = motion.scale(&step.start, first);
    step.interpolates() && dense.is_within(tolerance, &scale)
}

/// Land on an event: on the interpolant if that is exact, or by a step that ends there, which is returned; on an end of the
/// travel to the last digit.
fn land<'m, const N: usize>(
    integrator: &mut Integrator<N>,
    motion: &mut EquationOfMotion<'m>,
    around: &Surroundings,
    step: &Step<N>,
    found: &Found<N>,
    exact: bool,
) -> Option<Step<N>>
where
    EquationOfMotion<'m>: System<N>,
{
    let smooth = matches!(found.event, Event::Regime(_) | Event::Bumper(_) | Event::Reversal);
    if smooth && exact {
        integrator.branch_off();
        return None;
    }
    let mut retaken = integrator.retake(motion, step, found.part * step.h);
    if let Event::End(side) = found.event {
        for _ in 1..6 {
            let miss = around.travel[side].map_or(0.0, |e| e.position - retaken.end[0]);
            let correction = miss / retaken.end[1];
            let small = correction.abs() <= 1e-15 * (step.t + step.h)
                || miss.abs() <= 4.0 * f64::EPSILON * retaken.end[0].abs();
            let next = retaken.h + correction;
            if small || !(next > 0.0 && next <= step.h && correction.abs() < 0.1 * step.h) {
                break;
            }
            retaken = integrator.retake(motion, step, next);
        }
    }
    Some(retaken)
}

/// What an event does that has come, at the state z.
///
/// # Errors
/// [`Locked`].
fn happen<'m, const N: usize>(
    (event, at_once): (Event, bool),
    integrator: &mut Integrator<N>,
    motion: &mut EquationOfMotion<'m>,
    contact: &mut Contact,
    z: &mut [f64; N],
    way: &mut Way,
) -> Result<(), Locked>
where
    EquationOfMotion<'m>: System<N>,
{
    match event {
        Event::Regime(_) | Event::Unknown => integrator.refresh(),
        _ => {
            integrator.restart();
            way.stale = true;
        }
    }
    match event {
        Event::End(side) => way.lost += strike(motion, way.around, contact, side, z, way.tolerance)?,
        Event::Bumper(side) => {
            contact.touching[side] =
                if contact.touching[side].is_some() { None } else { bumper(motion, way.around, side) };
        }
        Event::Reversal => z[1] = 0.0,
        Event::Unknown => {}
        Event::Regime(friction_joint) => {
            let Some(state_loads) = motion.state_loads else { return Ok(()) };
            let (law, regime) = (
                state_loads.friction_joints[friction_joint].law,
                motion.scratch.evaluator.regime(friction_joint).unwrap_or(Regime::Viscous),
            );
            let next = law.next(regime, motion.slip(friction_joint, z[0], z[1]));
            motion.set_regime(friction_joint, Some(next));
            if at_once {
                way.along = Some(friction_joint);
            }
        }
    }
    Ok(())
}

/// When what holds the mechanism at rest lets it go, under inputs that change with time: where `off`, <= 0 at t = `from`
/// while it is held, becomes positive before `end`. At rest it is a parabola in time for every direction of the drives and
/// without air; a passage there and back within a 64th of the time is not seen.
///
/// # Errors
/// [`Locked`].
fn release(
    motion: &mut EquationOfMotion,
    from: f64,
    end: f64,
    off: &dyn Fn(&mut EquationOfMotion) -> Result<f64, Locked>,
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

fn failure(motion: &EquationOfMotion, error: IntegrationError) -> Stopped {
    if motion.locked { Stopped::Locked } else { Stopped::Integration(error) }
}

fn rigid(motion: &EquationOfMotion, around: &Surroundings, side: usize) -> bool {
    around.travel[side].is_some_and(|e| motion.reduced.loading().stops[e.stop].rigid)
}

/// Whether a mechanism at rest at an end stays there: the loads press it against a rigid stop.
pub fn rests(motion: &mut EquationOfMotion, around: &Surroundings, side: usize, sigma: f64) -> Result<bool, Locked> {
    Ok(rigid(motion, around, side) && motion.settle(sigma, 0.0)? * outward(side) >= 0.0)
}

/// Whether the mechanism is exactly at an end.
fn at(around: &Surroundings, side: usize, sigma: f64) -> bool {
    around.travel[side].is_some_and(|e| sigma == e.position)
}

/// A mechanism that sets out from the place of a bumper, outward, presses it from the start on.
fn meet_bumpers<const N: usize>(
    motion: &mut EquationOfMotion,
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
fn pushes_out<const N: usize>(motion: &EquationOfMotion, around: &Surroundings, z: &[f64; N]) -> Option<usize> {
    (0..2).find(|&side| {
        let moves = z[1] * outward(side) > 0.0;
        let at = around.travel[side].is_some_and(|e| (z[0] - e.position) * outward(side) >= 0.0);
        moves && at && rigid(motion, around, side)
    })
}

/// The mechanism comes to an end of its travel: it is caught, bounces, comes to rest or meets a bumper. Returns the energy
/// lost [J].
fn strike<const N: usize>(
    motion: &mut EquationOfMotion,
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
    if at(around, 1 - side, end.position) && rigid(motion, around, 1 - side) {
        // No room between two stops: there is no motion.
        z[1] = 0.0;
        contact.resting = Some(side);
        return Ok(before);
    }
    // Newton's law of impact.
    z[1] *= -motion.reduced.loading().stops[end.stop].restitution;
    let after = 0.5 * z[1] * z[1];
    Ok(before - after + calm(motion, contact, side, z, tolerance)?)
}

/// A mechanism that leaves a rigid end against the loads comes to rest there if its flight is too short or too low.
/// Returns the energy lost [J].
fn calm<const N: usize>(
    motion: &mut EquationOfMotion,
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
