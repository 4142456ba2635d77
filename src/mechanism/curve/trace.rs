//! Tracing: panel after panel, until the curve returns, leaves the permitted travel, or gets too long.
//!
//! In: a closed position, limits of travel. Out: the curve. It must not know loads.
use super::across::crossing_ahead;
use super::error::CurveError;
use super::evaluate::{Curve, Ends, describe};
use super::kinetic::twice_kinetic;
use super::panel::{Base, Panel, Rejection, Scratch};
use super::travel::Travel;
use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::Positions;
use crate::numerics::chebyshev::Transform;
use crate::numerics::gapped::Gapped;
use std::f64::consts::TAU;

/// Width of the first panel in the weighted norm.
const FIRST: f64 = 0.25;
/// Largest width of a panel.
const LARGEST: f64 = 1.5;
/// Largest half width of a panel across a crossing.
const WIDEST_HALF: f64 = 0.75;
/// Width of a panel below which tracing fails.
const SMALLEST: f64 = 1e-6;
/// Largest number of panels.
const PANELS: usize = 20_000;
/// Largest traced position of a prismatic joint, in sizes of the linkage.
const FARTHEST: f64 = 100.0;

/// Amplification of rounding in a gap above which branches almost cross.
pub const NEAR_CROSSING: f64 = 300.0;

/// End of following the curve in one direction.
enum Stop {
    /// The curve returned to its start; the coordinates have grown by these amounts.
    Returned(Vec<f64>),
    /// The permitted travel ends at this sigma.
    Left(f64),
    /// A prismatic joint has gone far enough.
    Far,
}

impl Curve {
    /// Trace the curve through the closed position `q`, where sigma is 0: the whole curve, or with a `margin` as far as
    /// travel is permitted, which is in each direction up to the first zero of `margin`, a continuous function of the
    /// positions that is >= 0 at `q` but for rounding. The range of sigma ends exactly at the zero; the panel with the
    /// zero is traced to its end. Without a zero the result is the whole curve.
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
        let mut tracer =
            Tracer {
            closure: &closure,
            transform: Transform::default(),
            gapped: Gapped::default(),
            half: WIDEST_HALF,
            travel,
            scratch: Scratch::default(),
        };
        let (mut panels, stop) = tracer.follow(q, &tangent)?;
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
                let (other, stop) = tracer.follow(q, &back)?;
                let low = !matches!(stop, Stop::Far);
                first = match stop {
                    Stop::Left(sigma) => -sigma,
                    Stop::Far => -end(&other),
                    // The margin touches 0 at the limit met forward and was missed in this direction.
                    Stop::Returned(_) => last - end(&other),
                };
                let mirrored = |p: Panel| {
                    let start = -p.end();
                    p.mirrored(start)
                };
                panels = other.into_iter().rev().map(mirrored).chain(panels).collect();
                if low || high { Ends::Stopped { low, high } } else { Ends::Open }
            }
        };
        if last <= first {
            return Err(CurveError::Outside(describe(&closure, q)));
        }
        let (transform, closed) = (tracer.transform, tracer.scratch.closed);
        let mut curve = Self { closure, transform, panels, range: (first, last), ends, crossings: Vec::new(), closed };
        curve.crossings = curve.find_crossings();
        curve.check_redundant()?;
        Ok(curve)
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
                    if gap.abs() > 1e-9 * linkage.size {
                        let joint = linkage.joints[joints[row]].name.clone();
                        let position = describe(&self.closure, &q);
                        return Err(CurveError::Inconsistent { joint, gap: gap.abs(), position });
                    }
                }
            }
        }
        Ok(())
    }
}

/// What lies ahead.
enum Ahead {
    /// A panel across a crossing, and the tangent at its tip.
    Crossed(Panel, Vec<f64>),
    /// A crossing too far for one panel: first a panel of this width.
    Approach(f64),
    /// Nothing that a panel crosses.
    Unclear,
}

/// Following of the curve in one direction and the other.
struct Tracer<'a> {
    closure: &'a Closure,
    transform: Transform,
    gapped: Gapped,
    /// Largest half width of the next panel across a crossing.
    half: f64,
    travel: Option<Travel<'a>>,
    scratch: Scratch,
}

impl Tracer<'_> {
    /// Follow the curve from `q` along `tangent`.
    fn follow(&mut self, q: &[f64], tangent: &[f64]) -> Result<(Vec<Panel>, Stop), CurveError> {
        /// Width of the next panel relative to the width that should resolve it.
        const CAUTION: f64 = 0.84;
        /// Largest width of a panel relative to the one before.
        const GROWTH: f64 = 2.0;
        let linkage = &*self.closure.linkage;
        let mut panels: Vec<Panel> = Vec::new();
        let mut base = Base { sigma: 0.0, q: q.to_vec(), tangent: tangent.to_vec() };
        let (mut width, mut widest_before) = (FIRST, None);
        if let Some(travel) = &mut self.travel {
            travel.start(q);
        }
        loop {
            let (panel, ahead, wider) = self.next_panel(&base, &mut width)?;
            let returns = self.returned(q, tangent, &panel, panels.is_empty());
            let left = self.travel.as_mut().and_then(|t| t.end(&panel, &self.transform.nodes));
            if let Some((growth, cut)) = returns {
                // The travel may end on the way back to the start.
                let end = cut.as_ref().map_or(panel.start, Panel::end);
                if left.is_none_or(|sigma| sigma >= end) {
                    panels.extend(cut);
                    return Ok((panels, Stop::Returned(growth)));
                }
            }
            base = Base { sigma: panel.end(), q: panel.tip.clone(), tangent: ahead };
            let far = base.q[linkage.angles..].iter().any(|s| s.abs() > FARTHEST * linkage.size);
            // Width that would just have been resolved, and its ratio from panel to panel.
            let widest = panel.width * wider.min(GROWTH);
            let trend = widest_before.map_or(1.0, |before: f64| (widest / before).clamp(0.5, GROWTH));
            width = (CAUTION * widest * trend).min(GROWTH * panel.width).min(LARGEST);
            widest_before = Some(widest);
            panels.push(panel);
            if let Some(sigma) = left {
                return Ok((panels, Stop::Left(sigma)));
            }
            if far {
                return Ok((panels, Stop::Far));
            }
            if panels.len() >= PANELS {
                return Err(CurveError::TooLong { panels: PANELS });
            }
        }
    }

    /// The next panel, of the proposed width or the widest below it that is accepted, with the tangent at its tip and
    /// the factor by which it might have been wider.
    fn next_panel(&mut self, base: &Base, width: &mut f64) -> Result<(Panel, Vec<f64>, f64), CurveError> {
        let mut massless = false;
        while *width > SMALLEST {
            let Self { closure, transform, travel, scratch, .. } = self;
            let mut visit = |node: usize, positions: &Positions| {
                if let Some(travel) = &mut *travel {
                    travel.visit(node, positions);
                }
            };
            match Panel::build(closure, transform, base, *width, scratch, &mut visit) {
                Ok(built) => return Ok(built),
                Err(rejection) => {
                    if rejection == Rejection::NearCrossing {
                        match self.cross(base, *width) {
                            Ahead::Crossed(panel, tangent) => return Ok((panel, tangent, f64::INFINITY)),
                            Ahead::Approach(shorter) => {
                                *width = shorter;
                                continue;
                            }
                            Ahead::Unclear => {}
                        }
                    }
                    massless = rejection == Rejection::Massless;
                    *width *= match rejection {
                        Rejection::TooWide(shorter) => shorter,
                        Rejection::NearCrossing => 0.93,
                        Rejection::Massless => 0.7,
                    };
                }
            }
        }
        let Self { closure, scratch, .. } = self;
        let position = describe(closure, &base.q);
        // Panels stop short of a position where nothing with mass moves.
        massless |= twice_kinetic_part(closure, &base.q, &base.tangent) < 1e-6;
        Err(if massless {
            CurveError::Massless(position)
        } else if closure.linearise(&base.q, &mut scratch.evaluation.loops)
            && closure.amplification(&closure.normal(&base.tangent), &mut scratch.evaluation.loops) > NEAR_CROSSING
        {
            CurveError::NearCrossing(position)
        } else {
            CurveError::Stuck(position)
        })
    }

    /// Cross the position ahead of `base` where branches seem to cross, within about `width`.
    fn cross(&mut self, base: &Base, width: f64) -> Ahead {
        /// Half width that leaves little rounding in the gap, and least half width.
        const GOOD: f64 = 0.35;
        const LEAST: f64 = 0.02;
        /// Factor of the half width after a failure.
        const NARROWER: f64 = 0.7;
        let Self { closure, gapped, scratch, .. } = self;
        let Some(distance) = crossing_ahead(closure, base, width, &mut scratch.evaluation) else {
            return Ahead::Unclear;
        };
        while self.half > LEAST {
            if distance > self.half {
                let shorter = distance - self.half;
                return if shorter < 0.95 * width { Ahead::Approach(shorter) } else { Ahead::Unclear };
            }
            let half = self.half.min(GOOD.max(distance));
            match Panel::across(closure, gapped, base, distance, half, scratch) {
                Ok((panel, tangent)) => {
                    self.half = WIDEST_HALF;
                    return Ahead::Crossed(panel, tangent);
                }
                Err(_) => self.half = NARROWER * half,
            }
        }
        Ahead::Unclear
    }

    /// For a panel through the start: the growth of the coordinates, and the part of the panel up to the start.
    fn returned(
        &self,
        start: &[f64],
        tangent: &[f64],
        panel: &Panel,
        first: bool,
    ) -> Option<(Vec<f64>, Option<Panel>)> {
        let closure = self.closure;
        let (n, w) = (start.len(), &closure.weights);
        // The start with whole revolutions added.
        let target: Vec<f64> = (0..n)
            .map(|i| {
                let middle = 0.5 * (panel.base[i] + panel.tip[i]);
                if i < closure.linkage.angles { start[i] + TAU * ((middle - start[i]) / TAU).round() } else { start[i] }
            })
            .collect();
        let u: f64 = (0..n).map(|i| panel.normal[i] * (target[i] - panel.base[i])).sum();
        let slack = 1e-9;
        if first && u < slack || u < -slack || u > panel.width + slack {
            return None;
        }
        let q = panel.coordinates_at(2.0 * u.clamp(0.0, panel.width) / panel.width - 1.0);
        let off = (0..n).fold(0.0, |a: f64, i| a.max(((q[i] - target[i]) * w[i]).abs()));
        let along: f64 = (0..n).map(|i| panel.normal[i] * tangent[i]).sum();
        if off > 1e-7 || along <= 0.0 {
            return None;
        }
        let growth = (0..n).map(|i| target[i] - start[i]).collect();
        if u < slack {
            return Some((growth, None));
        }
        let cut = panel.clone().part(-1.0, 2.0 * u / panel.width - 1.0);
        Some((growth, Some(cut)))
    }
}

/// Twice the kinetic energy of a motion along the tangent, relative to the sum of m size^2 + I.
fn twice_kinetic_part(closure: &Closure, q: &[f64], tangent: &[f64]) -> f64 {
    let linkage = &*closure.linkage;
    let p = linkage.positions(q);
    let whole: f64 = linkage.bodies.iter().map(|b| b.mass * linkage.size.powi(2) + b.inertia).sum();
    if whole > 0.0 { twice_kinetic(linkage, &p, &linkage.rates(&p, q, tangent)) / whole } else { 0.0 }
}
