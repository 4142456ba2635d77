//! Bridging: how tracing gets onto a bridge over a crossing, and down from it.
//!
//! In: the tracer before a position where branches seem to cross. Out: the bridge on which it goes on, how far the next
//! panel may go; the panel at the end of a bridge. It must not know limits of travel.
use super::Tracer;
use crate::mechanism::curve::base::Base;
use crate::mechanism::curve::bridge::{Bridge, crossing_ahead};
use crate::mechanism::curve::error::CurveError;
use crate::mechanism::curve::panel::Panel;

/// Half width of a bridge over a crossing, for three coordinates: good one, least one.
const BRIDGES: [f64; 2] = [0.35, 0.01];
/// Largest distance of a crossing over which a bridge is built, in half widths of the bridge.
const FAR: f64 = 3.0;
/// Part of a bridge's half width that is not worth a panel.
const SLIVER: f64 = 0.1;
/// Largest of the last coefficients of a bridge's series that is rounding.
const RESOLVED: f64 = 2e-14;
/// Largest part of a panel's width at which a shorter panel is worth building.
const SHORTER: f64 = 0.95;

impl Tracer<'_> {
    /// Prepare to cross a position within about `width` ahead of `base` where branches seem to cross: find the bridge
    /// over it, or get near it first. The largest width of the next panel; None if there is nothing that a bridge
    /// crosses, or if a panel of `width` does not reach the bridge.
    pub(super) fn bridge_ahead(&mut self, base: &Base, width: f64) -> Option<f64> {
        /// Factor of the half width after a failure.
        const NARROWER: f64 = 0.8;
        let Self { closure, gapped, scratch, bridge, .. } = self;
        // The norm of a turn of all coordinates by the same angle grows with their number.
        let [good, least] = BRIDGES.map(|part| part * (base.q.len() as f64 / 3.0).sqrt());
        self.half = self.half.min(good);
        if self.half <= least {
            return None;
        }
        let distance = crossing_ahead(closure, base, 2.0 * width, &mut scratch.evaluation)?;
        let mut build = |half: f64| Bridge::new(closure, gapped, base, [distance, half], &mut scratch.evaluation);
        while self.half > least {
            let half = self.half;
            if distance > FAR * half {
                return Some(distance - half).filter(|shorter| *shorter < SHORTER * width);
            }
            self.half = NARROWER * half;
            if let Some(found) = build(half) {
                // A tail that a narrower bridge does not reduce is rounding, or a miss of the branches of that size.
                let tail = found.tail;
                if tail < RESOLVED || build(self.half).is_some_and(|narrower| narrower.tail > NARROWER * tail) {
                    self.half = f64::INFINITY;
                    let from = found.distance(&base.q);
                    let [approach, rest] = found.range.map(|end| end - from);
                    // Without a rest, what looks like a crossing ahead is one behind.
                    *bridge = Some(found).filter(|_| rest > SLIVER * half);
                    return (rest > SLIVER * half && approach < SHORTER * width).then_some(width);
                }
            }
        }
        None
    }

    /// The width of the next panel, at most `width`, with which it ends at an end of the bridge or well before; and the
    /// bridge's distance at `base` if the panel is on the bridge.
    pub(super) fn bounded(&mut self, base: &Base, width: f64) -> (f64, Option<f64>) {
        // A curve that turns sharply before the bridge may have passed its end.
        self.bridge.take_if(|bridge| bridge.distance(&base.q) >= bridge.range[1]);
        let Some(bridge) = &self.bridge else { return (width, None) };
        let from = bridge.distance(&base.q);
        let is_on = bridge.range[0] - from < SLIVER * bridge.half();
        let whole = bridge.range[usize::from(is_on)] - from;
        // No sliver is left at the end.
        (if width < whole { width.min(0.9 * whole) } else { whole }, is_on.then_some(from))
    }

    /// The width of the next panel with which it ends well before the crossing to which a panel of `width` gets too
    /// near.
    pub(super) fn farther(&self, base: &Base, width: f64) -> Option<f64> {
        let bridge = self.bridge.as_ref()?;
        // The amplification grows like a power of the inverse of the distance: two panels share its growth.
        let distance = bridge.crossing - bridge.distance(&base.q);
        Some(distance - (distance * (distance - width)).max(0.0).sqrt()).filter(|shorter| *shorter < SHORTER * width)
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
