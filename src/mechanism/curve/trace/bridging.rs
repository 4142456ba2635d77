//! Bridging: how tracing gets onto a bridge over a crossing, and down from it.
//!
//! In: the tracer before a position where branches seem to cross. Out: the bridge on which it goes on; the panel at the
//! end of a bridge. It must not know limits of travel.
use super::Tracer;
use crate::mechanism::curve::bridge::{Bridge, crossing_ahead};
use crate::mechanism::curve::error::CurveError;
use crate::mechanism::curve::panel::{Base, Panel};

/// Half width of a bridge over a crossing, for three coordinates: largest one, good one, least one.
const BRIDGES: [f64; 3] = [0.5, 0.35, 0.01];
/// Largest of the last coefficients of a bridge's series that is rounding.
const RESOLVED: f64 = 2e-14;

impl Tracer<'_> {
    /// Prepare to cross the position ahead of `base` where branches seem to cross, within about `width`. The width of
    /// the next panel, which is on a bridge or leads to one; None if there is nothing that a bridge crosses.
    pub(super) fn bridge_ahead(&mut self, base: &Base, width: f64) -> Option<f64> {
        /// Factor of the half width after a failure.
        const NARROWER: f64 = 0.8;
        let Self { closure, gapped, scratch, bridge, .. } = self;
        // The norm of a turn of all coordinates by the same angle grows with their number.
        let [widest, good, least] = BRIDGES.map(|part| part * (base.q.len() as f64 / 3.0).sqrt());
        self.half = self.half.min(widest);
        if self.half <= least {
            return None;
        }
        let distance = crossing_ahead(closure, base, 2.0 * width, &mut scratch.evaluation)?;
        let mut build = |half: f64| Bridge::new(closure, gapped, base, [distance, half], &mut scratch.evaluation);
        while self.half > least {
            let half = self.half.min(good.max(distance));
            if distance > 1.1 * half {
                return Some(distance - half).filter(|shorter| *shorter < 0.95 * width);
            }
            let half = half.max(distance);
            self.half = NARROWER * half;
            if let Some(found) = build(half) {
                let tail = found.0.tail;
                // A tail that a narrower bridge does not reduce is rounding, or a miss of the branches of that size.
                if tail < RESOLVED || build(self.half).is_some_and(|(narrower, _)| narrower.tail > NARROWER * tail) {
                    self.half = f64::INFINITY;
                    let approach = found.0.range[0] - found.1;
                    if approach > 0.1 * half {
                        return Some(approach).filter(|shorter| *shorter < 0.95 * width);
                    }
                    if found.1 > found.0.range[1] - 0.1 * half {
                        // What looks like a crossing ahead is one behind.
                        return None;
                    }
                    *bridge = Some(found);
                    return Some(width);
                }
            }
        }
        None
    }

    /// The panel at the end of a bridge, with its tip on the loop equations again, and the unit tangent there.
    pub(super) fn land(&mut self, mut panel: Panel) -> Result<(Panel, Vec<f64>), CurveError> {
        let Self { closure, scratch, .. } = self;
        let loops = &mut scratch.evaluation.loops;
        if closure.on_plane(loops, &mut panel.tip, &panel.base, &panel.normal, panel.width).is_none() {
            return Err(CurveError::Stuck { position: closure.describe(&panel.tip), at: panel.tip });
        }
        let mut tangent = Vec::new();
        loops.factors.tangent(&panel.normal, 1.0, &mut tangent);
        closure.normalise(&mut tangent);
        Ok((panel, tangent))
    }
}
