//! Events of bumpers: where one begins or ceases to push, or pushes harder than a force.
//!
//! In: a step on its interpolant, a bumper. Out: the part of the step before the event. It must not know what follows.
use super::REGIME_TOLERANCE;
use crate::integrator::Dense;
use crate::mechanism::motion::dynamics::Dynamics;
use crate::numerics::bracket::{bisect, false_position};
use crate::numerics::enclosure::Enclosure;
use crate::numerics::passage::Bounded;
use std::cell::RefCell;

/// How far a state is past the event at which a bumper that touches lets go, or one that does not begins to push.
pub fn excess_of_bumper<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    bumper: usize,
    touches: bool,
    [sigma, sigma_dot]: [f64; 2],
) -> f64 {
    let (beyond, push) = dynamics.bumper_push(bumper, sigma, sigma_dot);
    if touches { -push } else { beyond.min(push) }
}

/// Part of a step after which a bumper that touches would pull, so that it lets go; or one that does not touch, but is
/// pressed, would push, so that it begins to.
pub fn bumper_event<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    dense: &Dense<N>,
    bumper: usize,
    touches: bool,
) -> Option<f64> {
    const PARTS: usize = 12;
    let dynamics = &RefCell::new(dynamics);
    let f = |s: f64| excess_of_bumper(*dynamics.borrow_mut(), bumper, touches, [0, 1].map(|n| dense.component(n, s)));
    let motion = dense.bounded([0, 1]);
    let bounds = |a: f64, b: f64| {
        let [sigma, sigma_dot] = motion.enclosures([a, b]);
        let [beyond, push] = dynamics.borrow_mut().bumper_bounds(bumper, sigma, sigma_dot);
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
pub fn press_event<D: Dynamics<N>, const N: usize>(
    dynamics: &mut D,
    dense: &Dense<N>,
    (bumper, least): (usize, f64),
) -> Option<f64> {
    const PARTS: usize = 12;
    let dynamics = &RefCell::new(dynamics);
    let push = |s: f64| dynamics.borrow_mut().bumper_push(bumper, dense.component(0, s), dense.component(1, s)).1;
    let f = |s: f64| push(s) - least;
    let motion = dense.bounded([0, 1]);
    let bounds = |a: f64, b: f64| {
        let [sigma, sigma_dot] = motion.enclosures([a, b]);
        dynamics.borrow_mut().bumper_bounds(bumper, sigma, sigma_dot)[1] + Enclosure::constant(-least)
    };
    let locate =
        |f: &mut dyn FnMut(f64) -> f64, a: (f64, f64), b: (f64, f64)| false_position(f, a, b, REGIME_TOLERANCE);
    // At the start the bumper does not push so hard, but for rounding.
    Bounded { f, bounds, locate }.first_rise(f(0.0).min(0.0), PARTS)
}
