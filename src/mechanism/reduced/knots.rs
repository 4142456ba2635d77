//! Knots of the motion: positions at which the law of a coupling is only twice continuously differentiable, such as the
//! borders of the segments of a cam. A step that passes one ends there.
//!
//! In: the reduced model, a sigma, a direction. Out: the next knot. It must not know states or inputs.
use super::model::Reduced;
use crate::mechanism::curve::Curve;

/// Distance from a knot up to which a position is at it, relative to the scale of sigma: the acceleration has a kink of
/// its second derivative there, of which the square of this part is left.
pub const AT_KNOT: f64 = 1e-9;

/// Values of sigma at which the law of a coupling is not analytic; none for a curve whose couplings have none.
pub(super) fn knots(curve: &Curve) -> Option<Box<[f64]>> {
    let has_knots = curve.linkage().couplings.iter().any(|coupling| coupling.law.has_knots());
    has_knots.then(|| curve.law_knots_from_start().into())
}

impl Reduced {
    /// Whether the law of a coupling has knots.
    #[inline(always)]
    pub fn has_knots(&self) -> bool {
        self.knots.is_some()
    }

    /// The next knot from a sigma on, in the direction of growing sigma (1) or against it (-1); None if there is none. A
    /// knot at which the sigma is already is not the next. The open end of a stretch of the curve counts as a knot.
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
