//! Knots of the motion: positions at which the law of a coupling or the curve of a slot is only a few times
//! continuously differentiable, such as the borders of the segments of a cam, and those at which the curve of a spring
//! turns, as in a detent, which a step could pass over unseen. A step that passes a knot ends there.
//!
//! In: the reduced model, a sigma, a direction. Out: the next knot. It must not know states or inputs.
use super::Reduced;
use crate::mechanism::curve::{Configuration, Curve, Scratch};
use crate::mechanism::loads::laws::spring::Spring;
use crate::mechanism::loads::resolved::Loading;
use crate::numerics::order;

/// Distance from a knot up to which a position is at it, relative to the scale of sigma: the acceleration has a kink of
/// its second derivative there, of which the square of this part is left.
pub const AT_KNOT: f64 = 1e-9;

/// Distance up to which a border of the tables is at a point of a spring's curve, in parts of the change of its
/// displacement over the panel beside it.
const AT_POINT: f64 = 1e-9;

/// Values of sigma at which the law of a coupling or the curve of a slot is not analytic, and those of `borders` at
/// which the curve of a spring turns, ascending; none for a mechanism that has neither.
pub(super) fn knots(curve: &Curve, loading: &Loading, borders: &[f64]) -> Option<Box<[f64]>> {
    let has_knots = curve.linkage().has_knots();
    let mut all = if has_knots { curve.law_knots_from_start() } else { Vec::new() };
    let mut turns = false;
    for spring in &loading.springs {
        let points = spring.turning_knots();
        if !points.is_empty() && loading.loads[spring.load].growth(curve) == 0.0 {
            turns = true;
            turning(curve, loading, spring, (&points, borders), &mut all);
        }
    }
    if turns {
        order::sort(&mut all);
        all.dedup();
    }
    (has_knots || turns).then(|| all.into())
}

/// Those of `borders` at which the displacement of a spring is one of these.
fn turning(curve: &Curve, loading: &Loading, spring: &Spring, (points, borders): (&[f64], &[f64]), out: &mut Vec<f64>) {
    let (mut scratch, mut c) = (Scratch::default(), Configuration::default());
    let load = &loading.loads[spring.load];
    for (k, &border) in borders.iter().enumerate().filter(|(_, border)| **border < curve.range.1) {
        curve.configure(border, &mut scratch, &mut c);
        let [s, slope, _] = load.displacement(curve.linkage(), &c);
        let near = AT_POINT * slope.abs() * (borders[k + 1] - border);
        if points.iter().any(|point| (s - point).abs() <= near) {
            out.push(border);
        }
    }
}

impl Reduced {
    /// Whether the motion has knots.
    #[inline(always)]
    pub fn has_knots(&self) -> bool {
        self.knots.is_some()
    }

    /// The next knot from a sigma on, in the direction of growing sigma (1) or against it (-1); None if there is none.
    /// A knot at which the sigma is already is not the next. The open end of a stretch of the curve counts as a knot.
    #[cold]
    #[inline(never)]
    pub fn next_knot(&self, sigma: f64, direction: f64) -> Option<f64> {
        let from = sigma + direction * AT_KNOT * self.scale();
        let (stretch, period) = (self.at(from), self.period());
        let knots = stretch.knots.as_deref()?;
        let (within, revolutions) = stretch.unwound(from);
        let next = if direction > 0.0 {
            knots.get(knots.partition_point(|knot| *knot <= within))
        } else {
            knots[..knots.partition_point(|knot| *knot < within)].last()
        };
        match (next, period) {
            (Some(knot), _) => Some(knot + revolutions * period.unwrap_or(0.0)),
            (None, Some(period)) => {
                let first = if direction > 0.0 { knots.first() } else { knots.last() };
                first.map(|knot| knot + (revolutions + direction) * period)
            }
            (None, None) => {
                let side = usize::from(direction > 0.0);
                let (first, last) = stretch.curve().range;
                let end = if side == 0 { first } else { last };
                (stretch.curve().is_open(side) && (end - from) * direction > 0.0).then_some(end)
            }
        }
    }
}
