//! Knots: positions at which the law of a coupling or the curve of a slot is not analytic, such as borders of the
//! segments of a cam.
//!
//! In: the tracer before such a position, or a traced curve. Out: the width of a panel that ends there; the knots of
//! the curve. It must not know what the laws are.
//!
//! Panels and tables end at knots, so that polynomials resolve what is analytic on either side.
use super::Tracer;
use crate::mechanism::curve::base::Base;
use crate::mechanism::curve::evaluate::Curve;
use crate::mechanism::curve::panel::Panel;
use crate::mechanism::linkage::Knotted;

/// Distance from a knot at which a position counts as at it [rad]: second derivatives there differ by this times the
/// third derivatives at most.
const CLOSE: f64 = 1e-9;

impl Tracer<'_> {
    /// The width of the next panel, at most `width`, with which it ends at the next knot or well before.
    pub(super) fn up_to_knot(&mut self, base: &Base, width: f64) -> f64 {
        let linkage = &*self.closure.linkage;
        let mut wide = width;
        for of in linkage.knotted() {
            let [argument, rate] = linkage.argument(of, &base.q, &base.tangent);
            let ahead = linkage.next_knot(of, argument, rate > 0.0, CLOSE);
            if !ahead.is_finite() || rate == 0.0 {
                continue;
            }
            // The estimate by the rate at the base is good for a panel that is short enough.
            if let Some(distance) = self.distance_to_knot(base, of, [ahead, rate], 2.0 * wide) {
                wide = match distance {
                    d if d <= wide * (1.0 + 1e-6) => d,
                    // No sliver is left before the knot.
                    d if d < 1.5 * wide => 0.6 * d,
                    _ => wide,
                };
            }
        }
        wide
    }

    /// Distance u of the plane across the curve at which the argument has changed by `ahead` in the direction of its
    /// rate, by the secant method; None beyond about `most`.
    fn distance_to_knot(&mut self, base: &Base, of: Knotted, [ahead, rate]: [f64; 2], most: f64) -> Option<f64> {
        const ITERATIONS: usize = 30;
        let Self { closure, scratch, .. } = self;
        let linkage = &*closure.linkage;
        let normal = closure.normal(&base.tangent);
        let [from, _] = linkage.argument(of, &base.q, &base.tangent);
        let goal = ahead * rate.signum();
        // Each a distance, and the argument there less the goal.
        let (mut before, mut u) = ([0.0, -goal], [goal / rate, 0.0]);
        let mut q = base.q.clone();
        for _ in 0..ITERATIONS {
            if !(u[0] > 0.0 && u[0] < most) {
                return None;
            }
            q.iter_mut().zip(&base.q).zip(&base.tangent).for_each(|((q, base), t)| *q = base + u[0] * t);
            closure.on_plane(&mut scratch.evaluation.loops, &mut q, &base.q, &normal, u[0])?;
            u[1] = linkage.argument(of, &q, &base.tangent)[0] - from - goal;
            let step = -u[1] * (u[0] - before[0]) / (u[1] - before[1]);
            if u[1].abs() <= 4.0 * f64::EPSILON * (from.abs() + goal.abs()).max(1.0) || !step.is_finite() {
                return Some(u[0]);
            }
            (before, u) = (u, [u[0] + step, 0.0]);
        }
        None
    }
}

impl Curve {
    /// Values of sigma within the range at which a law or a curve is not analytic, ascending.
    pub fn law_knots(&self) -> Vec<f64> {
        self.starts_at_knots(|start| self.range.0 < start)
    }

    /// [`Self::law_knots`], and the start of the range if a law or a curve is not analytic there.
    pub fn law_knots_from_start(&self) -> Vec<f64> {
        self.starts_at_knots(|start| self.range.0 <= start)
    }

    /// Starts of panels before the end of the range at which a law or a curve is not analytic.
    fn starts_at_knots(&self, is_within: impl Fn(f64) -> bool) -> Vec<f64> {
        let linkage = self.linkage();
        let is_knot = |q: &[f64]| {
            linkage.knotted().any(|of| {
                let [argument, _] = linkage.argument(of, q, q);
                // From a little before a knot it is near.
                linkage.next_knot(of, argument - 10.0 * CLOSE, true, 0.0) < 20.0 * CLOSE
            })
        };
        let inside = |panel: &&Panel| is_within(panel.start) && panel.start < self.range.1;
        self.panels.iter().filter(inside).filter(|panel| is_knot(&panel.base)).map(|panel| panel.start).collect()
    }
}
