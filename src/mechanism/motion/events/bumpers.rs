//! Pushes of bumpers, and where they start, end or exceed a force.
//!
//! In: an equation of motion, the interpolant of a step. Out: pushes with bounds, where a bumper starts or ceases to
//! push. It must not know the places of stops.
use super::REGIME_TOLERANCE;
use crate::integrator::Dense;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::numerics::bracket::{bisect, false_position};
use crate::numerics::enclosure::Enclosure;
use crate::numerics::passage::Bounded;
use crate::numerics::table::polynomial;
use std::cell::RefCell;

impl EquationOfMotion<'_> {
    /// How far the load of a bumper is beyond its stop, and the push of the bumper if it is in contact.
    pub fn bumper_push(&mut self, bumper: usize, sigma: f64, sigma_dot: f64) -> (f64, f64) {
        let x = self.locate(sigma);
        let Some(state_loads) = self.state_loads else { return (0.0, 0.0) };
        let (panel_force, loading) = (&self.scratch.panel_force, self.reduced.loading());
        let at = |component: usize| polynomial(panel_force.series(&state_loads.table, component), x);
        let stop = &loading.stops[state_loads.bumpers[bumper]];
        let s = at(state_loads.pressed(bumper)) + panel_force.revolutions * self.reduced.load_growth(stop.load);
        let rate = at(state_loads.bumper(bumper)) * sigma_dot;
        let beyond = stop.beyond(s);
        let outward = if stop.sign() > 0.0 { rate } else { -rate };
        (beyond, stop.push(beyond, outward))
    }

    /// Bounds of both numbers of [`Self::bumper_push`] along a part of a step with these bounds of sigma and sigma_dot.
    fn bumper_bounds(&self, bumper: usize, [sigma, sigma_dot]: [Enclosure; 2]) -> [Enclosure; 2] {
        let Some(state_loads) = self.state_loads else { return [Enclosure::constant(0.0); 2] };
        let loading = self.reduced.loading();
        let stop = &loading.stops[state_loads.bumpers[bumper]];
        let growth = self.reduced.load_growth(stop.load);
        let of = |component: usize, growth: f64| sigma.chain(self.component_bounds(component, sigma.value, growth));
        let s = of(state_loads.pressed(bumper), growth)
            + Enclosure::constant(self.applied.revolutions * growth - stop.value);
        let rate = of(state_loads.bumper(bumper), 0.0) * sigma_dot;
        let (beyond, outward) = if stop.sign() > 0.0 { (s, rate) } else { (-s, -rate) };
        [beyond, stop.push_bounds(beyond, outward)]
    }

    /// How far a bumper that touches would pull; or how far one that does not is pressed and would push.
    pub(super) fn excess_of_bumper(&mut self, bumper: usize, touches: bool, [sigma, sigma_dot]: [f64; 2]) -> f64 {
        let (beyond, push) = self.bumper_push(bumper, sigma, sigma_dot);
        if touches { -push } else { beyond.min(push) }
    }
}

/// Part of a step after which a bumper that touches would pull, so that it lets go; or one that does not touch, but is
/// pressed, would push, so that it starts to.
pub(super) fn passage_of_bumper<const N: usize>(
    dynamics: &mut EquationOfMotion<'_>,
    bumper: usize,
    touches: bool,
    dense: &Dense<N>,
) -> Option<f64> {
    const PARTS: usize = 12;
    let dynamics = &RefCell::new(dynamics);
    let f = |s: f64| dynamics.borrow_mut().excess_of_bumper(bumper, touches, [0, 1].map(|n| dense.component(n, s)));
    let motion = dense.bounded([0, 1]);
    let bounds = |a: f64, b: f64| {
        let [beyond, push] = dynamics.borrow().bumper_bounds(bumper, motion.enclosures([a, b]));
        if touches { -push } else { beyond.min(push) }
    };
    let locate =
        |f: &mut dyn FnMut(f64) -> f64, (a, _): (f64, f64), (b, _): (f64, f64)| bisect(|s| f(s) > 0.0, a, b)[1];
    let start = f(0.0);
    if start > 0.0 {
        // Rounding, unless it grows.
        let (first, slope) = (1.0 / PARTS as f64, bounds(0.0, 1.0 / PARTS as f64).slope);
        if slope.low > 0.0 || (slope.high > 0.0 && f(first) > start) {
            return Some(REGIME_TOLERANCE);
        }
    }
    Bounded { f, bounds, locate }.first_rise(start, PARTS)
}

/// Part of a step after which a bumper pushes harder than a force.
#[cold]
pub(super) fn passage_of_push<const N: usize>(
    dynamics: &mut EquationOfMotion<'_>,
    bumper: usize,
    least: f64,
    dense: &Dense<N>,
) -> Option<f64> {
    const PARTS: usize = 12;
    let dynamics = &RefCell::new(dynamics);
    let push = |s: f64| dynamics.borrow_mut().bumper_push(bumper, dense.component(0, s), dense.component(1, s)).1;
    let f = |s: f64| push(s) - least;
    let motion = dense.bounded([0, 1]);
    let bounds = |a: f64, b: f64| {
        dynamics.borrow().bumper_bounds(bumper, motion.enclosures([a, b]))[1] + Enclosure::constant(-least)
    };
    let locate =
        |f: &mut dyn FnMut(f64) -> f64, a: (f64, f64), b: (f64, f64)| false_position(f, a, b, REGIME_TOLERANCE);
    // At the start the bumper does not push so hard, but for rounding.
    Bounded { f, bounds, locate }.first_rise(f(0.0).min(0.0), PARTS)
}
