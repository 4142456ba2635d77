//! Slip speeds of friction joints, and where they leave the ranges of their regimes.
//!
//! In: an equation of motion, a step, its interpolant. Out: slip speeds with bounds, whether and where a regime
//! changes. It must not know which regime follows.
use super::REGIME_TOLERANCE;
use crate::integrator::{Dense, Step};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::MOTION;
use crate::mechanism::loads::friction_loop::Locked;
use crate::numerics::bracket::false_position;
use crate::numerics::enclosure::{Enclosure, Interval};
use crate::numerics::passage::{Bounded, first_rise_of_quartic};
use crate::numerics::table::{TablePosition, polynomial};
use std::cell::RefCell;

impl EquationOfMotion<'_> {
    /// Slip speed of a joint at the time of the equation [m/s].
    pub fn slip(&mut self, joint: usize, sigma: f64, sigma_dot: f64) -> f64 {
        // Needed at the ends of steps and between them, it leaves the present panel as it is.
        let x = if self.reduced.exact { Some(self.locate(sigma)) } else { None };
        let Some(state_loads) = self.state_loads else { return 0.0 };
        let component = state_loads.free() + joint;
        let influence = if let Some(x) = x {
            polynomial(self.scratch.panel_force.series(&state_loads.table, component), x)
        } else {
            self.component(component, sigma)
        };
        let friction_joint = &state_loads.friction_joints[joint];
        let surface = friction_joint.surface.map_or(0.0, |surface| self.applied.size(surface, self.time));
        influence * sigma_dot * friction_joint.radius - surface
    }

    /// Bounds of the slip speed of a joint [m/s] along a part of a step with these bounds of time, sigma and
    /// sigma_dot.
    fn slip_bounds(&self, joint: usize, [time, sigma, sigma_dot]: [Enclosure; 3]) -> Enclosure {
        let Some(state_loads) = self.state_loads else { return Enclosure::constant(0.0) };
        let influence = sigma.chain(self.component_bounds(state_loads.free() + joint, sigma.value, 0.0));
        let friction_joint = &state_loads.friction_joints[joint];
        let slip = influence * sigma_dot * friction_joint.radius;
        friction_joint.surface.map_or(slip, |surface| {
            let [speed, first, second] = self.applied.rates(surface).map(Enclosure::constant);
            slip + -(speed + time * (first + time * second * 0.5))
        })
    }

    /// sigma with its position in the table, for [`Self::slip_rate`], the same for all joints.
    fn slip_position(&self, sigma: f64) -> (f64, TablePosition) {
        let (reduced, state_loads) = self.stretch_at(sigma);
        let table = state_loads.map(|state_loads| (reduced, &*state_loads.table));
        let position = |table| self.scratch.panel_force.position(table, sigma);
        (sigma, table.map_or(TablePosition { panel: 0, x: 0.0 }, position))
    }

    /// Slip speed of a joint [m/s] and its rate [m/s2], at a position and these time, sigma_dot and sigma_ddot.
    fn slip_rate(&self, joint: usize, (at, [t, sigma_dot, sigma_ddot]): SlipEnd) -> [f64; 2] {
        let ((_, Some(state_loads)), at) = (self.stretch_at(at.0), at.1) else { return [0.0; 2] };
        let [influence, slope] = state_loads.table.value_and_slope(at, state_loads.free() + joint);
        let rate = slope * sigma_dot * sigma_dot + influence * sigma_ddot;
        let friction_joint = &state_loads.friction_joints[joint];
        let slip = [influence * sigma_dot, rate].map(|v| v * friction_joint.radius);
        friction_joint.surface.map_or(slip, |surface| {
            let [speed, first, second] = self.applied.rates(surface);
            [slip[0] - (speed + t * (first + 0.5 * t * second)), slip[1] - (first + t * second)]
        })
    }

    /// Least and largest slip speed of the regime in which a joint is [m/s].
    #[inline]
    fn slip_range(&self, joint: usize) -> (f64, f64) {
        let regime = self.regime(joint);
        self.state_loads.map_or((f64::NEG_INFINITY, f64::INFINITY), |s| s.friction_joints[joint].law.range(regime))
    }

    /// Time from this time, sigma_dot and sigma_ddot at a sigma until a slip speed leaves the range of its regime, were
    /// its rate constant [s]; infinite if none does.
    pub fn until_regime_changes(&self, sigma: f64, motion: [f64; 3]) -> f64 {
        let (joints, at) = (self.state_loads.map_or(0, |own| own.friction_joints.len()), self.slip_position(sigma));
        let until = |joint: usize| {
            let ((low, high), [v, rate]) = (self.slip_range(joint), self.slip_rate(joint, (at, motion)));
            (if rate > 0.0 { high - v } else { low - v }) / rate
        };
        (0..joints).map(until).filter(|until| *until > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// How far the slip speed of a joint is beyond the range of its regime at a time of the span [m/s].
    pub fn excess_of_slip(&mut self, joint: usize, [t, sigma, sigma_dot]: [f64; 3]) -> f64 {
        self.time = t;
        if self.is_held(joint) {
            let beyond = self.beyond_hold(joint, [sigma, sigma_dot]).unwrap_or([f64::NAN; 2]);
            return beyond[0].max(beyond[1]);
        }
        let ((low, high), v) = (self.slip_range(joint), self.slip(joint, sigma, sigma_dot));
        (low - v).max(v - high)
    }
}

/// sigma at an end of a step with its position in the table, and time, sigma_dot and sigma_ddot there.
type SlipEnd = ((f64, TablePosition), [f64; 3]);

/// What bounds the slip speeds of the friction joints within a step.
pub(super) enum SlipBounds {
    /// Both ends of a step of this size [s] with their rates.
    Cubic(f64, [SlipEnd; 2]),
    /// Bounds of time, sigma and sigma_dot in a step without rates, of Radau.
    Ranges([Enclosure; 3]),
}

impl SlipBounds {
    pub fn new<const N: usize>(dynamics: &EquationOfMotion<'_>, step: &Step<N>) -> Self {
        let end = |t: f64, y: &[f64; N], f: &[f64; N]| (dynamics.slip_position(y[0]), [t, y[1], f[1]]);
        if let Some([first, last]) = step.rates() {
            return Self::Cubic(step.h, [end(step.t, &step.start, first), end(step.t + step.h, &step.end, last)]);
        }
        let range = |value: Interval| Enclosure { value, slope: Interval::point(0.0) };
        let component = |n: usize| {
            let (ends, bulge) = (Interval::of([step.start[n], step.end[n]]), step.bulge(n));
            range(Interval { low: ends.low - bulge, high: ends.high + bulge })
        };
        Self::Ranges([range(Interval { low: step.t, high: step.t + step.h }), component(0), component(1)])
    }

    /// Whether the slip speed of a friction joint may leave the range of its regime within the step. Bounds are the
    /// Bezier points of Hermite's cubic for the slip speed, which enclose the cubic, widened by half of their distance
    /// from a straight line; without rates the bounds of the slip speed for all states of the step.
    pub fn may_leave(&self, dynamics: &EquationOfMotion<'_>, joint: usize) -> bool {
        const MARGIN: f64 = 0.5;
        if dynamics.is_held(joint) {
            return true;
        }
        let (low, high) = dynamics.slip_range(joint);
        let (h, ends) = match self {
            Self::Cubic(h, ends) => (h, *ends),
            Self::Ranges(ranges) => {
                let slip = dynamics.slip_bounds(joint, *ranges).value;
                return !(slip.low >= low && slip.high <= high);
            }
        };
        let [[a, rate_a], [b, rate_b]] = ends.map(|end| dynamics.slip_rate(joint, end));
        let third = h / 3.0;
        let (second, third) = (a + third * rate_a, b - third * rate_b);
        let third_of = (b - a) / 3.0;
        let margin = MARGIN * (second - (a + third_of)).abs().max((third - (b - third_of)).abs());
        // The start is within the range, but for rounding.
        [second, third, b].iter().any(|v| v - margin < low || v + margin > high)
    }
}

/// Part of a step after which the slip speed of a friction joint leaves the range of its regime.
pub(super) fn passage_of_slip<const N: usize>(
    dynamics: &mut EquationOfMotion<'_>,
    joint: usize,
    step: &Step<N>,
    dense: &Dense<N>,
) -> Option<f64> {
    const PARTS: usize = 8;
    if N == MOTION && dynamics.is_held(joint) {
        return end_of_hold(dynamics, joint, step, dense);
    }
    let (low, high) = dynamics.slip_range(joint);
    let dynamics = &RefCell::new(dynamics);
    let time = |s: f64| step.t + s * step.h;
    let f = |s: f64| {
        let mut dynamics = dynamics.borrow_mut();
        dynamics.time = time(s);
        let v = dynamics.slip(joint, dense.component(0, s), dense.component(1, s));
        (low - v).max(v - high)
    };
    let motion = dense.bounded([0, 1]);
    let bounds = |a: f64, b: f64| {
        let [sigma, sigma_dot] = motion.enclosures([a, b]);
        let t = Enclosure { value: Interval { low: time(a), high: time(b) }, slope: Interval::point(step.h) };
        let v = dynamics.borrow().slip_bounds(joint, [t, sigma, sigma_dot]);
        (-v + Enclosure::constant(low)).max(v + Enclosure::constant(-high))
    };
    let locate =
        |f: &mut dyn FnMut(f64) -> f64, a: (f64, f64), b: (f64, f64)| false_position(f, a, b, REGIME_TOLERANCE);
    // The start is within the range, but for rounding.
    Bounded { f, bounds, locate }.first_rise(f(0.0).min(0.0), PARTS)
}

/// Part of a step after which the friction that holds a body on its driven surface exceeds its limit: the first rise of
/// quartics through the friction, forward and backward, over parts of the step, located on the friction itself.
#[cold]
fn end_of_hold<const N: usize>(
    dynamics: &mut EquationOfMotion<'_>,
    joint: usize,
    step: &Step<N>,
    dense: &Dense<N>,
) -> Option<f64> {
    const PARTS: usize = 4;
    let border = |part: usize| part as f64 / PARTS as f64;
    (0..PARTS).find_map(|part| {
        let mut rise = |way: usize| {
            let beyond = |s: f64| {
                dynamics.time = step.t + s * step.h;
                let z = dense.at(s);
                dynamics.set_state(&z);
                Ok::<f64, Locked>(dynamics.beyond_hold(joint, [z[0], z[1]])?[way])
            };
            first_rise_of_quartic(beyond, [border(part), border(part + 1)], REGIME_TOLERANCE).unwrap_or(None)
        };
        [rise(0), rise(1)].into_iter().flatten().reduce(f64::min)
    })
}
