//! Tracing: panel after panel, until the curve returns, leaves the permitted travel, or gets too long.
//!
//! In: a closed position, limits of travel. Out: the curve. It must not know loads.
use super::bridge::{Bridge, crossing_ahead};
use super::error::CurveError;
use super::evaluate::{Curve, Ends, describe};
use super::kinetic::twice_kinetic;
use super::panel::{Base, Panel, Rejection, Scratch, near_crossing};
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
/// Half width of a bridge over a crossing, for three coordinates: largest one, good one, least one.
const BRIDGES: [f64; 3] = [0.5, 0.35, 0.01];
/// Largest of the last coefficients of a bridge's series that is rounding.
const RESOLVED: f64 = 2e-14;
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
        let mut tracer = Tracer {
            closure: &closure,
            transform: Transform::default(),
            gapped: Gapped::default(),
            bridge: None,
            least: f64::INFINITY,
            half: f64::INFINITY,
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

/// Following of the curve in one direction and the other.
struct Tracer<'a> {
    closure: &'a Closure,
    transform: Transform,
    gapped: Gapped,
    /// The bridge on which the next panel begins, and its distance there.
    bridge: Option<(Bridge, f64)>,
    /// Least amplification of the panels so far.
    least: f64,
    /// Largest half width of the next bridge.
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
        self.bridge = None;
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
            let Self { closure, transform, travel, scratch, bridge, .. } = self;
            let mut visit = |node: usize, positions: &Positions| {
                if let Some(travel) = &mut *travel {
                    travel.visit(node, positions);
                }
            };
            let built = match bridge {
                Some((on, from)) => {
                    let rest = on.range[1] - *from;
                    // No sliver is left at the end.
                    *width = if *width < rest { width.min(0.9 * rest) } else { rest };
                    Panel::on_bridge(closure, transform, on, base, (*from, *width), scratch, &mut visit)
                }
                None => Panel::build(closure, transform, base, *width, scratch, &mut visit),
            };
            match built {
                Ok((panel, tangent, wider)) => {
                    let Some((on, from)) = bridge else {
                        let [first, .., last] = panel.amplifications;
                        self.least = self.least.min(panel.amplification);
                        if !near_crossing(last, self.least) {
                            // What could not be bridged lies behind.
                            self.half = f64::INFINITY;
                        } else if last > first
                            && let Some(wide) = self.bridge_ahead(base, *width)
                        {
                            *width = wide;
                            continue;
                        }
                        return Ok((panel, tangent, wider));
                    };
                    *from += *width;
                    if *from < on.range[1] * (1.0 - 1e-9) {
                        return Ok((panel, tangent, wider));
                    }
                    *bridge = None;
                    return self.land(panel).map(|(panel, tangent)| (panel, tangent, wider));
                }
                Err(rejection) => {
                    if rejection == Rejection::NearCrossing
                        && let Some(wide) = self.bridge_ahead(base, *width)
                    {
                        *width = wide;
                        continue;
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

    /// Prepare to cross the position ahead of `base` where branches seem to cross, within about `width`. The width of
    /// the next panel, which is on a bridge or leads to one; None if there is nothing that a bridge crosses.
    fn bridge_ahead(&mut self, base: &Base, width: f64) -> Option<f64> {
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
    fn land(&mut self, mut panel: Panel) -> Result<(Panel, Vec<f64>), CurveError> {
        let Self { closure, scratch, .. } = self;
        let loops = &mut scratch.evaluation.loops;
        if closure.on_plane(loops, &mut panel.tip, &panel.base, &panel.normal, panel.width).is_none() {
            return Err(CurveError::Stuck(describe(closure, &panel.tip)));
        }
        let mut tangent = Vec::new();
        loops.factors.tangent(&panel.normal, 1.0, &mut tangent);
        closure.normalise(&mut tangent);
        Ok((panel, tangent))
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
