//! Rest within an advance: how long a stop, a lock, the drives or friction hold the mechanism.
//!
//! In: a mechanism at rest, inputs that may change with time. Out: the time at which it sets off. It must not know what
//! moves.
use super::transitions::Instant;
use super::{Advance, Stopped};
use crate::integrator::{Dense, Step, System};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::MOTION;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::resolved::DriveLaw;
use crate::mechanism::motion::contact::Place;
use crate::mechanism::motion::events::{Event, Found, may_pass_level, passage_of_level};
use crate::mechanism::motion::witness::What;
use crate::mechanism::reduced::StateLoads;
use crate::numerics::bracket::bisect;
use crate::numerics::passage::first_rise_of_quartic;
use std::mem::take;

impl EquationOfMotion<'_> {
    /// Inputs whose signs decide a law at rest: values and two time derivatives at the start of the span. Between the
    /// zeros of these, an acceleration at rest is a polynomial of degree 4 in time at most, without friction.
    fn switching_inputs(&self) -> impl Iterator<Item = [f64; 3]> {
        let drives = &self.reduced.loading().drives;
        self.applied.change.iter().flat_map(move |change| {
            let of = |load: usize| self.applied.rates(load);
            let at_rest = move |state_loads: &StateLoads, drive: usize| {
                let law = state_loads.laws.iter().position(|law| law.drive == drive);
                match (law, &drives[drive].law) {
                    (Some(k), Some(law)) => law.at_rest(of(drive), of, self.scratch.evaluator.position_of_law(k)),
                    _ => of(drive),
                }
            };
            let deciding = self.state_loads.into_iter();
            let surfaces = deciding.clone().flat_map(|own| own.friction_joints.iter());
            let beyond_borders =
                surfaces.filter_map(|own| Some((own.law, own.surface?))).flat_map(move |(law, surface)| {
                    let [speed, first, second] = of(surface);
                    let borders = [-law.kinetic_speed, -law.static_speed, 0.0, law.static_speed, law.kinetic_speed];
                    borders.map(|border| [speed - border, first, second])
                });
            let efficient = deciding.clone().flat_map(|own| own.drives[..own.efficient].iter().map(move |k| (own, *k)));
            let limits = deciding.flat_map(|own| own.limits.iter().map(move |limit| (own, *limit)));
            let beyond_limits = limits.map(move |(own, (law, side))| {
                let drive = own.laws[law].drive;
                let [force, first, second] = at_rest(own, drive);
                let limit = drives[drive].law.as_ref().and_then(DriveLaw::control).and_then(|own| own.limits[side]);
                [limit.unwrap_or(0.0) - force, -first, -second]
            });
            let [first, second] = change.airspeed;
            let air = self.scratch.air.then_some([self.applied.airspeed, first, second]);
            efficient.map(move |(own, drive)| at_rest(own, drive)).chain(beyond_limits).chain(air).chain(beyond_borders)
        })
    }
}

impl<'e, const N: usize> Advance<'_, 'e, N>
where
    EquationOfMotion<'e>: System<N>,
{
    /// Whether parts of the state go on while the mechanism is held at rest.
    const EVOLVES_AT_REST: bool = N > MOTION;

    /// At rest at a place: held by a lock, or by a rigid stop until the loads no longer press the mechanism against it,
    /// or exceed what a lock holds.
    #[inline(always)]
    pub(super) fn rest(&mut self, place: Place, z: &mut [f64; N], span: f64) -> Result<Instant, Stopped> {
        let sigma = z[0];
        self.state_rates();
        if self.contact.is_latched() {
            if Self::EVOLVES_AT_REST {
                self.go_on_at_rest(z, span, &[])?;
            }
            return Ok(Instant::Held);
        }
        let grip = self.grip();
        if self.is_held(place, sigma)? {
            let (inward, least) = (-place.outward(), self.ends.engages_at(place));
            let engages = least.is_finite() && self.press(place, sigma)? > least;
            if !engages && !self.wait_until(z, span, [[inward, grip], [-inward, least]])? {
                return Ok(Instant::Held);
            }
            if least.is_finite() && self.press(place, sigma)? > 0.0 {
                self.engage(place);
                return if self.pauses() { Err(Stopped::Event(self.progress)) } else { Ok(Instant::Changed) };
            }
            if self.pauses() {
                return Err(Stopped::Event(self.progress));
            }
        }
        self.contact.released();
        if let Some((stop, _)) = self.ends.travel.stop(place).filter(|_| grip > 0.0) {
            self.tell(What::LetGo { stop });
        }
        self.jumped();
        // Of two stops at one place, what one lets go the other may hold.
        for other in self.ends.at(sigma).filter(|other| *other != place) {
            if self.ends.is_fast(other) || self.is_held(other, sigma)? {
                self.rests(other, self.ends.is_locked(other));
                break;
            }
        }
        Ok(Instant::Changed)
    }

    /// Whether a mechanism that has come to rest is held by its friction, which is told.
    #[cold]
    pub(super) fn comes_to_stick(&mut self, z: &[f64; N]) -> Result<bool, Locked> {
        self.dynamics.time = self.progress.t;
        self.dynamics.set_state(z);
        let sticks = self.dynamics.find_direction(z[0], z[1])? == 0.0;
        if sticks {
            self.tell(What::Sticks);
        }
        Ok(sticks)
    }

    /// Held at rest by drives with an efficiency or by friction, until the loads overcome them in one direction.
    #[inline(always)]
    pub(super) fn wait_at_rest(&mut self, z: &mut [f64; N], span: f64) -> Result<Instant, Stopped> {
        // The speed of a driven surface may pass the borders of its regime.
        self.dynamics.clear_regimes();
        if !self.wait_until(z, span, [[1.0, 0.0], [-1.0, 0.0]])? {
            return Ok(Instant::Held);
        }
        self.jumped();
        if self.dynamics.sticks() {
            self.tell(What::BreaksAway);
            if self.pauses() {
                return Err(Stopped::Event(self.progress));
            }
        }
        Ok(Instant::Changed)
    }

    /// Go on in time, at rest, to where the mechanism sets off in one of two directions under inputs that change with
    /// time, or would do so by more than a generalised force, the second number; false if it does not before the end of
    /// the span.
    ///
    /// At rest without friction the acceleration is a parabola in time for either direction of the drives, or a quartic
    /// in air of changing speed, as long as no drive's force and no airspeed changes its sign. So it is searched piece
    /// by piece, and none is too short to be found. Friction at rest, static or on a driven surface, follows the
    /// magnitudes of reactions: with it the quartic is that through five values of each of some pieces, and what it
    /// finds is located on the acceleration itself.
    #[inline(never)]
    fn wait_until(&mut self, z: &mut [f64; N], span: f64, ways: [[f64; 2]; 2]) -> Result<bool, Stopped> {
        const CLOSE: f64 = 1e-15;
        /// Least number of pieces of a span with friction at rest.
        const PIECES: f64 = 8.0;
        /// Part of a piece at its ends, where friction on a driven surface may jump, that is taken as what is within.
        const NEAR: f64 = 1e-9;
        let sigma = z[0];
        let ways = if ways[1][1].is_finite() { &ways[..] } else { &ways[..1] };
        if Self::EVOLVES_AT_REST {
            return self.go_on_at_rest(z, span, ways);
        }
        // The inputs of a motion of two components do not change with time.
        if N < MOTION || self.dynamics.applied.change.is_none() {
            return Ok(false);
        }
        let from = self.progress.t;
        let rubs = self.dynamics.sticks() || self.dynamics.state_loads.is_some_and(|own| own.surfaces > 0);
        let turns = self.clinging().is_some();
        let longest = if rubs || turns { (span - from) / PIECES } else { f64::INFINITY };
        let mut a = from;
        while a < span {
            let b = self.next_switch(a, span).min(a + longest);
            let mut first = None;
            for [direction, least] in ways {
                let dynamics = &mut *self.dynamics;
                let near = if turns { NEAR * (b - a) } else { 0.0 };
                let excess = |t: f64| {
                    dynamics.time = t.clamp(a + near, b - near);
                    Ok::<f64, Locked>(dynamics.setting_off(sigma, *direction)? * direction - least)
                };
                let rise = first_rise_of_quartic(excess, [a, b], CLOSE * (span - from))?;
                first = [first, rise].into_iter().flatten().reduce(f64::min);
            }
            if let Some(t) = first {
                self.progress.t = t;
                self.dynamics.time = t;
                return Ok(t < span);
            }
            a = b;
        }
        Ok(false)
    }

    /// Integrate what continues at rest, to where the mechanism sets off in one of these ways; false if it does not
    /// before the end of the span.
    #[cold]
    fn go_on_at_rest(&mut self, z: &mut [f64; N], span: f64, ways: &[[f64; 2]]) -> Result<bool, Stopped> {
        self.dynamics.set_held::<N>(true);
        let went = self.hold(z, span, ways);
        self.dynamics.set_held::<N>(false);
        if matches!(went, Err(Stopped::Integration(_))) && take(&mut self.dynamics.locked) {
            return Err(Stopped::Locked);
        }
        went
    }

    /// [`Self::go_on_at_rest`] with the mechanism held.
    fn hold(&mut self, z: &mut [f64; N], span: f64, ways: &[[f64; 2]]) -> Result<bool, Stopped> {
        // The linear equations of an implicit step would leave the speed its rounding.
        let rest = [z[0], z[1]];
        while self.progress.t < span {
            if self.progress.work.is_spent(self.integrator.attempts()) {
                return Err(Stopped::Budget(self.progress));
            }
            let t = self.progress.t;
            let kink = self.dynamics.next_kink::<N>(t);
            let is_cut = kink < span;
            let end = if is_cut { kink } else { span };
            let step = self.integrator.step(self.dynamics, t, z, end, self.tolerance).map_err(Stopped::Integration)?;
            let sets_off = self.sets_off(t + step.h, &step.end, ways)?;
            let levels = 0..self.dynamics.levels::<N>();
            let may_pass = levels.clone().any(|level| may_pass_level(self.dynamics, level, &step));
            let dense = if sets_off || may_pass { Some(self.integrator.dense(self.dynamics, &step)) } else { None };
            let level = dense.as_ref().filter(|_| may_pass).and_then(|dense| {
                let passages = levels.filter_map(|level| Some((passage_of_level(self.dynamics, level, dense)?, level)));
                passages.min_by(|one, other| one.0.total_cmp(&other.0))
            });
            let mut end = 1.0;
            if let (Some(dense), Some((part, level))) = (&dense, level) {
                if !self.sets_off(t + part * step.h, &dense.at(part), ways)? {
                    let found = Found { part, state: dense.at(part), event: Event::Level(level) };
                    let shorter = self.locate(&step, &found, Some(dense)).unwrap_or(step);
                    *z = shorter.end;
                    z[..2].copy_from_slice(&rest);
                    self.progress.t += shorter.h;
                    return self.apply_event(found.event, false, z, &found.state).map(|()| false);
                }
                end = part;
            }
            let Some(dense) = dense.filter(|_| sets_off || end < 1.0) else {
                *z = step.end;
                z[..2].copy_from_slice(&rest);
                self.progress.t += step.h;
                if step.reached && !is_cut {
                    return Ok(false);
                }
                continue;
            };
            let mut locked = false;
            let [_, part] = bisect(
                |part| {
                    let off = self.sets_off(t + part * step.h, &dense.at(part), ways);
                    locked |= off.is_err();
                    off != Ok(false)
                },
                0.0,
                end,
            );
            if locked {
                return Err(Stopped::Locked);
            }
            let end = self.step_to_set_off(&step, &dense, part, span, ways)?;
            *z = end.end;
            z[..2].copy_from_slice(&rest);
            self.progress.t += end.h;
            self.dynamics.time = self.progress.t;
            return Ok(self.progress.t < span);
        }
        Ok(false)
    }

    /// The step up to where the mechanism sets off, which its interpolant has at this part of it: by the secant's
    /// method on the size of the step, as the interpolant is less exact than the step; then on by little until it does.
    fn step_to_set_off(
        &mut self,
        step: &Step<N>,
        dense: &Dense<N>,
        part: f64,
        span: f64,
        ways: &[[f64; 2]],
    ) -> Result<Step<N>, Locked> {
        /// Part of the time to the instant over which the first slope is taken.
        const DIFFERENCE: f64 = 1e-3;
        /// Part of the span up to which the instant is found, and by which a step is longer that is not there yet.
        const CLOSE: f64 = 1e-14;
        /// Growth of what a step that is not there yet is lengthened by.
        const GROWTH: f64 = 8.0;
        let close = CLOSE * span;
        let mut h = part * step.h;
        let mut before = part * (1.0 - DIFFERENCE);
        let mut miss_before = self.excess_from_rest(step.t + before * step.h, &dense.at(before), ways)?;
        before *= step.h;
        for _ in 0..8 {
            if !(h > close && h < step.h) {
                break;
            }
            let end = self.integrator.retake(self.dynamics, step, h);
            self.progress.work.extra += 1;
            let miss = self.excess_from_rest(step.t + h, &end.end, ways)?;
            let next = h - miss * (h - before) / (miss - miss_before);
            let is_within = next > 0.0 && next < step.h && (next - h).abs() < 0.1 * step.h;
            if !is_within || (next - h).abs() <= close {
                break;
            }
            (before, miss_before, h) = (h, miss, next);
        }
        let mut longer = close;
        loop {
            self.progress.work.extra += 1;
            let end = if h < step.h { self.integrator.retake(self.dynamics, step, h) } else { *step };
            if h >= step.h || self.sets_off(step.t + h, &end.end, ways)? {
                return Ok(end);
            }
            h += longer;
            longer *= GROWTH;
        }
    }

    /// Whether a mechanism at rest sets off in one of these ways.
    fn sets_off(&mut self, t: f64, z: &[f64; N], ways: &[[f64; 2]]) -> Result<bool, Locked> {
        Ok(self.excess_from_rest(t, z, ways)? > 0.0)
    }

    /// The largest acceleration with which a mechanism at rest would set off in one of these directions, less the
    /// generalised force of the way; below 0: none.
    fn excess_from_rest(&mut self, t: f64, z: &[f64; N], ways: &[[f64; 2]]) -> Result<f64, Locked> {
        self.dynamics.time = t;
        self.dynamics.set_state(z);
        let mut most = f64::NEG_INFINITY;
        for &[direction, least] in ways {
            most = most.max(self.dynamics.setting_off(z[0], direction)? * direction - least);
        }
        Ok(most)
    }

    /// Generalised force with which the loads press a mechanism at rest against the rigid stop of a place.
    fn press(&mut self, place: Place, sigma: f64) -> Result<f64, Locked> {
        Ok(self.dynamics.setting_off(sigma, place.outward())? * place.outward())
    }

    /// The first time after `t`, at most `span`, at which an input passes 0 whose sign decides a law at rest.
    #[inline(always)]
    fn next_switch(&self, t: f64, span: f64) -> f64 {
        // Rounding of a root must not bring it back.
        let is_later = |root: &f64| *root > t + 1e-12 * span;
        self.dynamics.switching_inputs().flat_map(roots_of_input).filter(is_later).fold(span, f64::min)
    }

    /// Generalised force up to which a lock with a release force holds the mechanism at rest; 0 where none does.
    fn grip(&self) -> f64 {
        self.contact.at_rest().map_or(0.0, |place| self.ends.grip(place))
    }

    /// Whether the loads press a mechanism at rest at a place against a rigid stop, or a lock there holds it.
    #[inline(always)]
    fn is_held(&mut self, place: Place, sigma: f64) -> Result<bool, Locked> {
        let inward = -place.outward();
        self.dynamics.clear_regimes();
        // As in `wait_until`: friction that sticks is static.
        Ok(place.bumper().is_none() && self.dynamics.setting_off(sigma, inward)? * inward <= self.ends.grip(place))
    }
}

/// Times at which an input u_0 + u_1 t + u_2 t^2 / 2 is 0; NaN where it is not. The one of larger size first, the other
/// from their product, so that neither loses digits.
fn roots_of_input([u0, u1, u2]: [f64; 3]) -> [f64; 2] {
    let sum = u1 + u1.signum() * (u1 * u1 - 2.0 * u0 * u2).sqrt();
    [-sum / u2, -2.0 * u0 / sum]
}
