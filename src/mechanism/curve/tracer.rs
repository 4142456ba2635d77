//! The tracer: panel after panel in one direction, until the curve returns, leaves the permitted travel, or gets too
//! far.
//!
//! In: a closed position with its tangent, limits of travel. Out: panels, and why they end. It must not know loads, nor
//! whether the curve is closed.
mod bridging;
mod knots;

use super::base::Base;
use super::bridge::Bridge;
use super::error::CurveError;
use super::kinetic::twice_kinetic;
use super::panel::{Panel, Rejection, Scratch, near_crossing};
use super::travel::Travel;
use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::Positions;
use crate::numerics::chebyshev::Transform;
use crate::numerics::gapped::Gapped;
use std::f64::consts::TAU;

/// Width of the first panel in the weighted norm.
const FIRST: f64 = 0.25;
/// Largest width of a panel near the guess.
const LARGEST: f64 = 1.5;
/// Largest width of a panel relative to its distance from the guess.
const LARGEST_PART: f64 = 0.5;
/// Width of a panel below which tracing fails.
const SMALLEST: f64 = 1e-6;
/// Largest number of panels.
const PANELS: usize = 20_000;

/// Revolutions of an angle from which on its rounding, of 1e-9 rad, is why no panel leads on.
const UNWOUND: f64 = 1e6;

/// Distance at which following ends, relative to the one at which it should.
const OVERSHOOT: f64 = 1.01;

/// Amplification of rounding in a gap above which branches almost cross.
pub const NEAR_CROSSING: f64 = 300.0;

/// End of following the curve in one direction.
pub(super) enum Stop {
    /// The curve returned to its start; the coordinates have grown by these amounts.
    Returned(Vec<f64>),
    /// The permitted travel ends at this sigma.
    Left(f64),
    /// A prismatic joint, or an angle of a linkage with couplings, has gone far enough.
    Far,
}

/// Following of the curve in one direction and the other.
pub(super) struct Tracer<'a> {
    closure: &'a Closure,
    pub(super) transform: Transform,
    gapped: Gapped,
    /// The bridge over the next crossing, from when it is found until it is passed.
    bridge: Option<Bridge>,
    /// Least amplification of the panels so far.
    least: f64,
    /// Largest half width of the next bridge.
    half: f64,
    pub(super) travel: Option<Travel<'a>>,
    pub(super) scratch: Scratch,
    /// Coordinates of the guess.
    guess: &'a [f64],
    /// Distance of a prismatic joint's position from its guess at which following ends, in sizes of the linkage.
    farthest: f64,
    /// Width of the first panel.
    pub(super) first: f64,
    /// Largest width of a panel relative to the one before.
    pub(super) widening: f64,
    /// Largest width of a panel relative to its distance from the guess.
    pub(super) part: f64,
    /// Whether the curve may return to its start, which is then looked for.
    may_return: bool,
    /// Largest number of panels.
    pub(super) most: usize,
}

impl<'a> Tracer<'a> {
    /// A tracer without limits of travel.
    pub(super) fn new(closure: &'a Closure, guess: &'a [f64], farthest: f64) -> Self {
        let (transform, scratch) = (Transform::default(), Scratch::default());
        Self {
            closure,
            transform,
            gapped: Gapped::default(),
            bridge: None,
            least: f64::INFINITY,
            half: f64::INFINITY,
            travel: None,
            scratch,
            guess,
            farthest,
            first: FIRST,
            widening: 2.0,
            part: LARGEST_PART,
            may_return: true,
            most: PANELS,
        }
    }

    /// Distance of a position from the guess: the largest of a prismatic joint's position, in sizes of the linkage,
    /// and, if couplings let bodies turn on and on, of an angle in revolutions.
    fn distance(&self, q: &[f64]) -> f64 {
        self.distance_slid(q).max(self.revolutions(q))
    }

    /// Revolutions of the angle farthest from its guess, if couplings let bodies turn on and on.
    fn revolutions(&self, q: &[f64]) -> f64 {
        let turned = |most: f64, i: usize| most.max((q[i] - self.guess[i]).abs() / TAU);
        (0..self.turning()).fold(0.0, turned)
    }

    /// Largest distance of a prismatic joint's position from its guess, in sizes of the linkage.
    fn distance_slid(&self, q: &[f64]) -> f64 {
        let linkage = &*self.closure.linkage;
        let both = q.iter().zip(self.guess).skip(linkage.angles);
        both.fold(0.0, |most: f64, (s, guess)| most.max((s - guess).abs())) / linkage.size
    }

    /// Number of the first coordinates, all angles, that count as going far. Without couplings, angles that go on
    /// return.
    fn turning(&self) -> usize {
        let linkage = &*self.closure.linkage;
        if linkage.couplings.is_empty() { 0 } else { linkage.angles }
    }

    /// Largest width of a panel from here on: with it following does not go much too far.
    fn largest(&self, base: &Base) -> f64 {
        /// Least part of a panel's width that a prismatic joint is taken to move.
        const SLOWEST: f64 = 0.1;
        let both = base.tangent.iter().zip(&self.closure.weights).skip(self.closure.linkage.angles);
        let slides = both.fold(SLOWEST, |most: f64, (t, w)| most.max((t * w).abs()));
        let turns = base.tangent[..self.turning()].iter().fold(0.0, |most: f64, t| most.max(t.abs() / TAU));
        // While the curve may return, a panel has no two positions that are one whole revolution apart.
        let far = if self.may_return { self.distance_slid(&base.q) } else { self.distance(&base.q) };
        let left = OVERSHOOT * self.farthest - self.distance(&base.q);
        LARGEST.max((self.part * far).min(left / slides.max(turns)))
    }

    /// Whether a limit, met forward at `left`, is no longer one after a whole revolution backward of length `whole`, in
    /// which the coordinates have grown by `growth`.
    pub(super) fn has_left(&mut self, left: f64, whole: f64, panels: &[Panel], growth: &[f64]) -> bool {
        let (Some(travel), Some(panel)) = (&mut self.travel, panels.last()) else { return false };
        if growth.iter().all(|growth| *growth == 0.0) || left >= whole {
            return false;
        }
        let mut q = panel.coordinates_at(panel.x_at(left));
        q.iter_mut().zip(growth).for_each(|(q, growth)| *q += growth);
        travel.allows(&q)
    }

    /// Follow the curve from a position, panel by panel, until it returns there if it `may_return`.
    ///
    /// # Errors
    /// [`CurveError`]; the panels before are there.
    pub(super) fn follow(
        &mut self,
        start: Base,
        may_return: bool,
        panels: &mut Vec<Panel>,
    ) -> Result<Stop, CurveError> {
        /// Width of the next panel relative to the width that should resolve it.
        const CAUTION: f64 = 0.84;
        (self.bridge, self.may_return) = (None, may_return);
        let mut base = start.clone();
        let (mut width, mut widest_before) = (self.first.min(self.largest(&base)), None);
        if let Some(travel) = &mut self.travel {
            travel.start(&start.q);
        }
        loop {
            let (panel, ahead, wider) = self.next_panel(&base, &mut width)?;
            let returns =
                if may_return { self.returned(&start.q, &start.tangent, &panel, panels.is_empty()) } else { None };
            let left = self.travel.as_mut().and_then(|t| t.end(&panel, &self.transform.nodes));
            if let Some((growth, cut)) = returns {
                // The travel may end on the way back to the start.
                let end = cut.as_ref().map_or(panel.start, Panel::end);
                if left.is_none_or(|sigma| sigma >= end) {
                    panels.extend(cut);
                    return Ok(Stop::Returned(growth));
                }
            }
            base = Base { sigma: panel.end(), q: panel.tip.clone(), tangent: ahead };
            let distance = self.distance(&base.q);
            // Width that would just have been resolved, and its ratio from panel to panel. A panel that a crossing has
            // shortened does not shorten those beyond.
            let widest = (panel.width * wider).min(self.widening * width);
            let trend = widest_before.map_or(1.0, |before: f64| (widest / before).clamp(0.5, self.widening));
            width = (CAUTION * widest * trend).min(self.widening * width).min(self.largest(&base));
            widest_before = Some(widest);
            panels.push(panel);
            if let Some(sigma) = left {
                return Ok(Stop::Left(sigma));
            }
            if distance > self.farthest {
                return Ok(Stop::Far);
            }
            if panels.len() >= self.most {
                return Err(CurveError::TooLong { panels: self.most });
            }
        }
    }

    /// The next panel, of the proposed width or the widest below it that is accepted, with the tangent at its tip and
    /// the factor by which it might have been wider. `width` becomes what the curve allows, which a crossing ahead may
    /// have shortened for this panel only.
    fn next_panel(&mut self, base: &Base, width: &mut f64) -> Result<(Panel, Vec<f64>, f64), CurveError> {
        let (mut massless, mut limit) = (false, f64::INFINITY);
        while width.min(limit) > SMALLEST {
            let (mut wide, from) = self.bounded(base, width.min(limit));
            if from.is_none() && !self.closure.linkage.couplings.is_empty() {
                wide = self.up_to_knot(base, wide);
            }
            let Self { closure, transform, travel, scratch, bridge, .. } = self;
            let mut visit = |node: usize, positions: &Positions| {
                if let Some(travel) = &mut *travel {
                    travel.visit(node, positions);
                }
            };
            let built = match (&*bridge, from) {
                (Some(on), Some(from)) => {
                    Panel::on_bridge(closure, transform, on, base, (from, wide), scratch, &mut visit)
                }
                _ => Panel::build(closure, transform, base, wide, scratch, &mut visit),
            };
            match built {
                Ok((panel, tangent, wider)) => {
                    if let Some(from) = from {
                        if bridge.as_ref().is_some_and(|on| from + wide < on.range[1] * (1.0 - 1e-9)) {
                            return Ok((panel, tangent, wider));
                        }
                        *bridge = None;
                        return self.land(panel).map(|(panel, tangent)| (panel, tangent, wider));
                    }
                    let [first, .., last] = panel.amplifications;
                    self.least = self.least.min(panel.amplification);
                    if !near_crossing(last, self.least) {
                        // What could not be bridged lies behind.
                        self.half = f64::INFINITY;
                    } else if last > first
                        && self.bridge.is_none()
                        && let Some(wide) = self.bridge_ahead(base, wide)
                    {
                        limit = wide;
                        continue;
                    }
                    return Ok((panel, tangent, wider));
                }
                Err(rejection) => {
                    massless = rejection == Rejection::Massless;
                    if rejection == Rejection::NearCrossing {
                        let shorter = if bridge.is_none() { self.bridge_ahead(base, wide) } else { None };
                        if let Some(shorter) = shorter.or_else(|| self.farther(base, wide)) {
                            limit = shorter;
                            continue;
                        }
                    }
                    *width = wide
                        * match rejection {
                            Rejection::TooWide(shorter) => shorter,
                            Rejection::NearCrossing => 0.93,
                            Rejection::Massless => 0.7,
                        };
                }
            }
        }
        let revolutions = self.revolutions(&base.q);
        let Self { closure, scratch, .. } = self;
        let position = closure.describe(&base.q);
        // Panels stop short of a position where nothing with mass moves.
        massless |= twice_kinetic_part(closure, &base.q, &base.tangent) < 1e-6;
        Err(if massless {
            CurveError::Massless(position)
        } else if closure.linearise(&base.q, &mut scratch.evaluation.loops)
            && closure.amplification(&closure.normal(&base.tangent), &mut scratch.evaluation.loops) > NEAR_CROSSING
        {
            CurveError::NearCrossing { position, at: base.q.clone(), miss: None }
        } else if revolutions > UNWOUND {
            CurveError::Unwound { position, revolutions }
        } else {
            CurveError::Stuck { position, at: base.q.clone() }
        })
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
    let whole = whole + linkage.rotors.iter().map(|rotor| rotor.inertia(linkage.size)).sum::<f64>();
    if whole > 0.0 { twice_kinetic(linkage, &p, &linkage.rates(&p, q, tangent)) / whole } else { 0.0 }
}
