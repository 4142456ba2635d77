//! Tracing: in both directions from the guess, until the curve is closed or ends on both sides.
//!
//! In: a closed position, limits of travel. Out: the curve. It must not know loads.
use super::base::Base;
use super::error::CurveError;
use super::evaluate::{Curve, Ends};
use super::misses::Near;
use super::panel::Panel;
use super::tracer::{Stop, Tracer};
use super::travel::Travel;
use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::Positions;

/// Distance of a prismatic joint's position from its guess to which the curve is traced at first, in sizes of the
/// linkage; of an angle of a linkage with couplings, in revolutions.
const FARTHEST: f64 = 100.0;

impl Curve {
    /// Trace the curve through the closed position `q`, where sigma is 0: the whole curve, or with a `margin` as far as
    /// travel is permitted, which is in each direction up to the first zero of `margin`, a continuous function of the
    /// positions that is >= 0 at `q` but for rounding. The range of sigma ends exactly at the zero; the panel with the
    /// zero is traced to its end. Without a zero the result is the whole curve: a closed one also if the motion away
    /// from a limit on one side returns with coordinates that have grown, as it may go on so for ever. Where a
    /// prismatic joint goes far from its guess, the curve is open and goes on in stretches: see [`Self::stretch`].
    ///
    /// # Errors
    /// [`CurveError`].
    pub fn trace(
        closure: Closure,
        q: &[f64],
        margin: Option<&mut dyn FnMut(&Positions) -> f64>,
    ) -> Result<Self, CurveError> {
        let tangent = closure.tangent(q);
        let travel = margin.map(|margin| Travel::new(&closure.linkage, margin));
        let farthest = FARTHEST.max(2.0 * closure.linkage.bodies.len() as f64);
        let mut tracer = Tracer::new(&closure, q, farthest);
        tracer.travel = travel;
        let start = |tangent: &[f64]| Base { sigma: 0.0, q: q.to_vec(), tangent: tangent.to_vec() };
        let mut panels = Vec::new();
        let stop = tracer.follow(start(&tangent), true, &mut panels)?;
        let end = |panels: &[Panel]| panels.last().map_or(0.0, Panel::end);
        let (mut first, mut last) = (0.0, end(&panels));
        let ends = match stop {
            Stop::Returned(growth) => Ends::Closed(growth),
            Stop::Left(_) | Stop::Far => {
                let high = matches!(stop, Stop::Left(_));
                if let Stop::Left(sigma) = stop {
                    last = sigma;
                }
                let back: Vec<f64> = tangent.iter().map(|t| -t).collect();
                let mut other = Vec::new();
                let stop = tracer.follow(start(&back), true, &mut other)?;
                let whole = end(&other);
                let growth = match &stop {
                    Stop::Returned(growth) if tracer.has_left(last, whole, &panels, growth) => {
                        Some(growth.iter().map(|growth| -growth).collect::<Vec<_>>())
                    }
                    _ => None,
                };
                if let Some(growth) = growth {
                    // The limit was left by a whole revolution, the next one leads on away from it.
                    (first, last) = (0.0, whole);
                    panels = mirrored(other, whole);
                    panels.iter_mut().for_each(|panel| panel.shift(&growth));
                    Ends::Closed(growth)
                } else {
                    let low = !matches!(stop, Stop::Far);
                    first = match stop {
                        Stop::Left(sigma) => -sigma,
                        Stop::Far => -whole,
                        // The margin touches 0 at the limit met forward and was missed in this direction.
                        Stop::Returned(_) => last - whole,
                    };
                    panels = mirrored(other, 0.0).into_iter().chain(panels).collect();
                    if low || high { Ends::Stopped { low, high } } else { Ends::Open }
                }
            }
        };
        if last <= first {
            return Err(CurveError::Outside(closure.describe(q)));
        }
        let (transform, closed) = (tracer.transform, tracer.scratch.evaluation.closed());
        let (guess, range) = (q.to_vec(), (first, last));
        let (crossings, near) = (Vec::new(), Near::default());
        let by_start = false;
        Self { closure, transform, panels, guess, farthest, range, ends, crossings, near, by_start, closed }.checked()
    }

    /// The nearest position on the curve through the closed position `q` at which `outside`, a continuous function of
    /// the positions that is > 0 at `q`, becomes 0; none within a few panels.
    pub fn entry(closure: &Closure, q: &[f64], outside: &mut dyn FnMut(&Positions) -> f64) -> Option<Vec<f64>> {
        /// Most panels that are followed in each direction: about 1 rad.
        const NEAREST: usize = 3;
        let ahead = closure.tangent(q);
        let back: Vec<f64> = ahead.iter().map(|t| -t).collect();
        let mut nearest: Option<(f64, Vec<f64>)> = None;
        for tangent in [ahead, back] {
            let travel = Some(Travel::new(&closure.linkage, &mut *outside));
            let mut tracer = Tracer::new(closure, q, FARTHEST);
            (tracer.travel, tracer.most) = (travel, NEAREST);
            let mut panels = Vec::new();
            let start = Base { sigma: 0.0, q: q.to_vec(), tangent };
            let Ok(Stop::Left(sigma)) = tracer.follow(start, false, &mut panels) else { continue };
            if let (Some(panel), true) = (panels.last(), nearest.as_ref().is_none_or(|(other, _)| sigma < *other)) {
                nearest = Some((sigma, panel.coordinates_at(panel.x_at(sigma))));
            }
        }
        nearest.map(|(_, q)| q)
    }

    /// This curve with its crossings.
    pub(super) fn checked(mut self) -> Result<Self, CurveError> {
        self.crossings = self.find_crossings();
        self.check_redundant()?;
        Ok(self)
    }

    /// Check that the dependent loop equations hold at all nodes.
    fn check_redundant(&self) -> Result<(), CurveError> {
        if !self.closure.redundant() {
            return Ok(());
        }
        let linkage = &*self.closure.linkage;
        let joints = linkage.row_joints();
        for panel in &self.panels {
            for x in self.transform.nodes {
                let q = panel.coordinates_at(x);
                for (row, gap) in linkage.gaps(&linkage.positions(&q)).iter().enumerate() {
                    if gap.abs() > 1e-9 * linkage.size * self.closure.rounding_at(&q) {
                        let joint = linkage.joints[joints[row]].name.clone();
                        let position = self.closure.describe(&q);
                        return Err(CurveError::Inconsistent { joint, gap: gap.abs(), position });
                    }
                }
            }
        }
        Ok(())
    }
}

/// The same panels in the opposite direction, so that the first one begins where the last one ended, `end` after their
/// start.
pub(super) fn mirrored(panels: Vec<Panel>, end: f64) -> Vec<Panel> {
    let mirrored = |panel: Panel| {
        let start = end - panel.end();
        panel.mirrored(start)
    };
    panels.into_iter().rev().map(mirrored).collect()
}
