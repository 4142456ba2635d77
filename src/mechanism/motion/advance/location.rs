//! Location of an event found in a step: on the interpolant where that is exact, else by a step that ends at the event.
//!
//! In: a step, an event on its interpolant. Out: the step that ends at the event. It must not know what moves.
use super::{Advance, BEYOND_KNOT};
use crate::integrator::{Dense, Step, System};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::MOTION;
use crate::mechanism::motion::events::{Event, Found, REGIME_TOLERANCE, excess};
use crate::mechanism::reduced::AT_KNOT;

/// Part of the motion in a step that the error of its interpolant may be, where events are looked for.
const RESOLVED: f64 = 0.01;
/// Part of the tolerance below which an error shows nothing.
const NEGLIGIBLE: f64 = 1e-6;
/// Part of the scales below which an error is rounding, of Newton's method and of friction among others.
const ROUNDING: f64 = 1e-12;
/// Part of a step before which no knot may be passed.
const FARTHEST_KNOT: f64 = 0.8;
/// Steps in a row that may be taken again because they are too coarse.
const MOST_REFINEMENTS: u32 = 20;

impl<'e, const N: usize> Advance<'_, 'e, N>
where
    EquationOfMotion<'e>: System<N>,
{
    /// Whether states may be taken from the interpolant of a step.
    #[inline(always)]
    pub(super) fn is_exact(&mut self, step: &Step<N>, dense: &Dense<N>) -> bool {
        if !step.interpolates() || !(is_resolved(step, dense) || self.coarseness(step, dense) <= 1.0) {
            return false;
        }
        let scale = self.dynamics.scale(&step.start, &step.first());
        dense.is_within(self.tolerance, &scale)
    }

    /// Time at which a step is to end that is too long to show its events [s]: the error of its interpolant is no small
    /// part of the motion in it, as where the motion is damped that is much faster than the step. An event on it may
    /// not happen, and another be overlooked, though its end is as exact as the tolerance asks.
    #[inline(always)]
    pub(super) fn too_coarse(&mut self, step: &Step<N>, dense: Option<&Dense<N>>) -> Option<f64> {
        let dense = dense.filter(|dense| !is_resolved(step, dense))?;
        let coarseness = self.coarseness(step, dense);
        let is_coarse = coarseness > 1.0 && self.progress.refinements < MOST_REFINEMENTS;
        is_coarse.then(|| step.t + step.h * coarseness.powf(-0.25).clamp(0.1, 0.5))
    }

    /// Error of the interpolant over the error up to which a step is trusted.
    #[cold]
    fn coarseness(&mut self, step: &Step<N>, dense: &Dense<N>) -> f64 {
        let scale = self.dynamics.scale(&step.start, &step.first());
        let least = (NEGLIGIBLE * self.tolerance).max(ROUNDING);
        let sizes = sizes(step);
        let ratio = |n: usize| dense.off(n) / (RESOLVED * sizes[n]).max(least * scale[n]);
        ratio(0).max(ratio(1))
    }

    /// Time at which a step is to end that has gone far beyond a knot or a point of a curve [s]: none of its stages may
    /// lie where the force differs, so that neither the step nor its error estimate shows the difference.
    #[inline(always)]
    pub(super) fn too_far(&self, step: &Step<N>, found: &Found<N>) -> Option<f64> {
        let is_knot = match found.event {
            Event::Knot(_) => true,
            Event::Border(border) => self.dynamics.is_kink(border),
            _ => false,
        };
        (is_knot && found.part < FARTHEST_KNOT).then_some(step.t + BEYOND_KNOT * found.part * step.h)
    }

    /// Locate an event: on the interpolant if that is exact, or by a step that ends there, which is returned: at the
    /// place of a stop to the last digit, near a knot, whose kink the interpolant has within it.
    #[inline(always)]
    pub(super) fn locate(&mut self, step: &Step<N>, found: &Found<N>, dense: Option<&Dense<N>>) -> Option<Step<N>> {
        // At a level, the lock is to change at the same time in communication steps of any size.
        let is_level = matches!(found.event, Event::Level(_));
        let is_smooth =
            N >= MOTION && !(is_level || matches!(found.event, Event::Stop(_) | Event::Knot(_) | Event::Undefined));
        // The interpolant has the kink within it.
        let has_kink = matches!(found.event, Event::Border(border) if self.dynamics.is_kink(border));
        if is_smooth
            && !has_kink
            && dense.is_some_and(|dense| self.is_exact(step, dense))
            && self.dynamics.admits(&found.state)
        {
            self.integrator.branch_off();
            return None;
        }
        let mut shorter = self.integrator.retake(self.dynamics, step, found.part * step.h);
        self.progress.work.extra += 1;
        let place = match found.event {
            Event::Stop(place) => Some((self.ends.position(place), 0.0)),
            // Of a kink the square of the distance matters.
            Event::Knot(sigma) => Some((Some(sigma), 0.5 * AT_KNOT * self.dynamics.reduced.scale())),
            _ => None,
        };
        if let Some((position, near)) = place {
            for _ in 1..6 {
                let miss = position.map_or(0.0, |position| position - shorter.end[0]);
                let correction = miss / shorter.end[1];
                let is_small = correction.abs() <= 1e-15 * (step.t + step.h)
                    || miss.abs() <= near.max(4.0 * f64::EPSILON * shorter.end[0].abs());
                let next = shorter.h + correction;
                if is_small || !(next > 0.0 && next <= step.h && correction.abs() < 0.1 * step.h) {
                    break;
                }
                shorter = self.integrator.retake(self.dynamics, step, next);
                self.progress.work.extra += 1;
            }
        } else if let (true, Some(dense)) = (N >= MOTION && found.event != Event::Undefined, dense) {
            self.polish(step, found, dense, &mut shorter);
        }
        Some(shorter)
    }

    /// Let a step end where the event is and not where an interpolant that is not exact has it: Newton's method on the
    /// size of the step, with the slope of the interpolant and then of the secant.
    #[cold]
    fn polish(&mut self, step: &Step<N>, found: &Found<N>, dense: &Dense<N>, shorter: &mut Step<N>) {
        /// Part of the time to the event over which the first slope is taken.
        const DIFFERENCE: f64 = 1e-3;
        let Self { dynamics, integrator, ends, contact, .. } = self;
        let around = (&*ends, &**contact);
        let width = DIFFERENCE * found.part;
        let [before, at] = [found.part - width, found.part]
            .map(|part| excess(dynamics, around, found.event, step.t + part * step.h, &dense.at(part)));
        let mut slope = (at - before) / (width * step.h);
        let mut miss = excess(dynamics, around, found.event, step.t + shorter.h, &shorter.end);
        for _ in 0..8 {
            let correction = -miss / slope;
            let next = shorter.h + correction;
            let is_within = next > 0.0 && next <= step.h && correction.abs() < 0.1 * step.h;
            if !is_within || correction.abs() <= REGIME_TOLERANCE * step.h {
                break;
            }
            let end = integrator.retake(*dynamics, step, next);
            self.progress.work.extra += 1;
            let after = excess(dynamics, around, found.event, step.t + end.h, &end.end);
            let secant = (after - miss) / (end.h - shorter.h);
            if secant.is_finite() && secant != 0.0 {
                slope = secant;
            }
            (*shorter, miss) = (end, after);
        }
    }
}

/// Way and speed of the motion in a step.
#[inline(always)]
fn sizes<const N: usize>(step: &Step<N>) -> [f64; 2] {
    let speed = step.start[1].abs().max(step.end[1].abs());
    [step.h * speed, speed]
}

/// Whether the error of the interpolant is a small part of the motion in a step.
#[inline(always)]
fn is_resolved<const N: usize>(step: &Step<N>, dense: &Dense<N>) -> bool {
    let sizes = sizes(step);
    dense.off(0) <= RESOLVED * sizes[0] && dense.off(1) <= RESOLVED * sizes[1]
}
