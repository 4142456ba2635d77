//! Stretches: the continuation of an open curve where a prismatic joint moves far from its guess.
//!
//! In: a curve that is open at an end. Out: the stretch of it beyond that end. It must not know who needs it.
//!
//! Each stretch goes [`RATIO`] times as far from the guess as the one before. Far away a linkage moves along its
//! asymptotes, so that panels there may be as long as their distance from the guess: some [`STRETCHES`] times a few
//! panels reach as far as numbers tell positions apart. A stretch depends on the one before and on nothing else, so the
//! panels are the same in whatever order they were needed.
use super::base::Base;
use super::error::CurveError;
use super::evaluate::{Curve, Ends};
use super::misses::Near;
use super::trace::mirrored;
use super::tracer::{Stop, Tracer};
use super::travel::Travel;
use crate::mechanism::closure::Scratch;
use crate::mechanism::linkage::Positions;

/// Distance from the guess of the far end of a stretch relative to that of the one before.
const RATIO: f64 = 8.0;
/// Largest width of a panel relative to its distance from the guess: positions near its base are as exact as those near
/// its tip.
const PART: f64 = 1.0;
/// Number of stretches beyond an open end: 1e11 sizes of the linkage from the guess, where positions differ by 1e-5 of
/// a size at least.
pub const STRETCHES: usize = 10;

impl Curve {
    /// The stretch of the curve beyond its low end (side 0) or its high end (side 1), which [`Self::is_open`]. Its
    /// other end is closed off; the far end is open, unless travel is permitted only up to there. `margin`: as in
    /// [`Self::trace`]. If tracing fails, the stretch ends there, and the next one has the error.
    ///
    /// # Errors
    /// [`CurveError`].
    pub fn stretch(&self, side: usize, margin: Option<&mut dyn FnMut(&Positions) -> f64>) -> Result<Self, CurveError> {
        let closure = self.closure.clone();
        let is_low = side == 0;
        let Some(panel) = (if is_low { self.panels.first() } else { self.panels.last() }) else {
            return Err(CurveError::Outside(closure.describe(&self.guess)));
        };
        let mut scratch = Scratch::default();
        let mut tangent = Vec::new();
        let (q, sigma, outward) =
            if is_low { (&panel.base, -self.range.0, -1.0) } else { (&panel.tip, self.range.1, 1.0) };
        if !closure.linearise(q, &mut scratch) {
            return Err(CurveError::Stuck { position: closure.describe(q), at: q.clone() });
        }
        scratch.factors.tangent(&panel.normal, outward, &mut tangent);
        closure.normalise(&mut tangent);
        let farthest = RATIO * self.farthest;
        let travel = margin.map(|margin| Travel::new(&closure.linkage, margin));
        let mut tracer = Tracer::new(&closure, &self.guess, farthest);
        (tracer.travel, tracer.first, tracer.widening, tracer.part) = (travel, f64::INFINITY, RATIO, PART);
        let mut panels = Vec::new();
        let followed = tracer.follow(Base { sigma, q: q.clone(), tangent }, false, &mut panels);
        let (mut end, left) = match (followed, panels.last()) {
            (Ok(Stop::Left(end)), _) => (end, true),
            (_, Some(last)) => (last.end(), false),
            (Err(error), None) => return Err(error),
            (Ok(_), None) => (sigma, false),
        };
        let mut range = (sigma, end);
        if is_low {
            end = -end;
            range = (end, self.range.0);
            panels = mirrored(panels, 0.0);
        }
        let ends = Ends::Stopped { low: !is_low || left, high: is_low || left };
        let (transform, closed, guess) = (tracer.transform, tracer.scratch.evaluation.closed(), self.guess.clone());
        let (crossings, near) = (Vec::new(), Near::default());
        let by_start = self.by_start;
        let stretch =
            Self { closure, transform, panels, guess, farthest, range, ends, crossings, near, by_start, closed };
        stretch.checked()
    }
}
