//! The curve and its exact evaluator.
//!
//! In: the panels of a traced curve. Out: the configuration at a sigma. It must not know how the panels were found.
use super::configuration::{Configuration, Scratch};
use super::misses::Near;
use super::panel::Panel;
use crate::mechanism::closure::{self, Closure};
use crate::mechanism::linkage::Linkage;
use crate::numerics::chebyshev::{Transform, polynomial};

/// Amplification, relative to the least of a panel, above which the series are more accurate than the loop equations.
const NEAR: f64 = 8.0;
/// Amplification below which the loop equations are accurate enough.
const HARMLESS: f64 = 30.0;

/// Ends of a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Ends {
    /// The curve returns to its start. The coordinates have then grown by these amounts, multiples of 2 pi or 0.
    Closed(Vec<f64>),
    /// The curve goes on at both ends, as far as prismatic joints may go.
    Open,
    /// The curve leaves the permitted travel at the low end of sigma, the high end, or both, or another stretch of it
    /// ends there; the other end is open.
    Stopped {
        /// At the first sigma.
        low: bool,
        /// At the last sigma.
        high: bool,
    },
}

/// The curve of closed positions of a linkage.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Loop equations.
    pub closure: Closure,
    pub(super) transform: Transform,
    pub(super) panels: Vec<Panel>,
    /// Coordinates of the guess, at sigma = 0.
    pub guess: Vec<f64>,
    /// Distance of a prismatic joint's position from its guess to which an open curve goes, in sizes of the linkage.
    pub farthest: f64,
    /// First and last sigma. Where travel stops, the panels extend beyond.
    pub range: (f64, f64),
    /// Ends of the curve.
    pub ends: Ends,
    /// Values of sigma where branches cross, ascending.
    pub crossings: Vec<f64>,
    /// Positions where branches almost cross, as far as they were looked for.
    pub near: Near,
    /// Whether the start decides how much of the curve is traced, as the guess is beyond a stop: sigma = 0 is then
    /// where the curve gets to the travel, unless the start is not on that part of the travel.
    pub by_start: bool,
    /// Number of positions closed in tracing, those of bridges and rejected panels included: the cost.
    pub closed: usize,
}

impl Curve {
    /// First and last sigma of the panels, which extend beyond the range where travel stops.
    pub(super) fn traced(&self) -> (f64, f64) {
        match (self.panels.first(), self.panels.last()) {
            (Some(first), Some(last)) => (first.start, last.end()),
            _ => (0.0, 0.0),
        }
    }

    /// Growth of a coordinate over one revolution of a closed curve; 0 for another curve.
    pub fn growth(&self, coordinate: usize) -> f64 {
        if let Ends::Closed(growth) = &self.ends { growth[coordinate] } else { 0.0 }
    }

    /// Mean length along the curve for a change of all coordinates of weighted norm 1 (1 rad).
    pub fn scale(&self) -> f64 {
        let (first, last) = self.traced();
        (last - first) / self.panels.iter().map(|p| p.width).sum::<f64>()
    }

    /// Whether the curve goes on beyond its low end (side 0) or its high end (side 1).
    pub fn is_open(&self, side: usize) -> bool {
        match self.ends {
            Ends::Closed(_) => false,
            Ends::Open => true,
            Ends::Stopped { low, high } => ![low, high][side],
        }
    }

    /// Whether loop equations are redundant.
    pub fn redundant(&self) -> bool {
        self.closure.redundant()
    }

    /// Linkage.
    pub fn linkage(&self) -> &Linkage {
        &self.closure.linkage
    }

    /// Amplification of rounding in the loop equations at sigma; infinite where branches cross to the last digit.
    pub fn amplification(&self, sigma: f64) -> f64 {
        let c = self.configuration(sigma);
        let (mut tangent, mut scratch) = (c.q_sigma, closure::Scratch::default());
        self.closure.normalise(&mut tangent);
        if self.closure.linearise(&c.q, &mut scratch) {
            self.closure.amplification(&self.closure.normal(&tangent), &mut scratch)
        } else {
            f64::INFINITY
        }
    }

    /// The coordinates at sigma after a number of revolutions of a closed curve, by name and in words.
    pub fn describe(&self, sigma: f64, revolutions: f64) -> String {
        self.closure.describe(&self.coordinates(sigma, revolutions))
    }

    /// Coordinates at sigma after so many revolutions.
    pub fn coordinates(&self, sigma: f64, revolutions: f64) -> Vec<f64> {
        let mut q = self.configuration(sigma).q;
        if let Ends::Closed(growth) = &self.ends {
            q.iter_mut().zip(growth).for_each(|(q, growth)| *q += revolutions * growth);
        }
        q
    }

    /// The configuration at sigma, within the curve's range: loops closed by Newton's method, the tangent from the null
    /// vector of the loop Jacobian, the curvature from the second derivatives of the loop equations and from T = 1/2.
    pub fn configuration(&self, sigma: f64) -> Configuration {
        let mut c = Configuration::default();
        self.configure(sigma, &mut Scratch::default(), &mut c);
        c
    }

    /// [`Self::configuration`], in place.
    pub fn configure(&self, sigma: f64, scratch: &mut Scratch, c: &mut Configuration) {
        let (first, last) = self.traced();
        c.sigma = sigma.clamp(first, last);
        let panel = &self.panels[self.panels.partition_point(|p| p.start <= c.sigma).max(1) - 1];
        let (closure, linkage) = (&self.closure, &*self.closure.linkage);
        let x = panel.x_at(c.sigma);
        panel.coordinates_into(x, &mut c.q);
        // Near a crossing the loop equations amplify rounding: the panel's series, from farther nodes, are more
        // accurate.
        let u = 0.5 * panel.width * (1.0 + x);
        let most = HARMLESS.max(NEAR * panel.amplification);
        let mut close = || closure.on_plane(&mut scratch.loops, &mut c.q, &panel.base, &panel.normal, u);
        let converged = if panel.bridged { None } else { close() };
        if let Some(converged) = converged.filter(|l| l.amplification < most) {
            std::mem::swap(&mut c.positions, &mut scratch.loops.positions);
            c.derive(closure, &panel.normal, scratch);
            c.amplification = converged.amplification;
            c.regular = true;
            std::mem::swap(&mut c.factors, &mut scratch.loops.factors);
            return;
        }
        panel.coordinates_into(x, &mut c.q);
        linkage.update_positions(&c.q, &mut c.positions);
        if panel.derivatives.is_empty() {
            (c.q_sigma, c.q_second) = panel.derivatives_at(x);
            let speed = c.scale_rates(linkage);
            c.q_second.iter_mut().for_each(|v| *v /= speed * speed);
        } else {
            // These are derivatives along sigma already, but for rounding.
            (c.q_sigma, c.q_second) =
                panel.derivatives.iter().map(|[f, s]| (polynomial(f, x), polynomial(s, x))).unzip();
            c.scale_rates(linkage);
        }
        c.project_curvature(linkage);
        c.amplification = f64::INFINITY;
        c.regular = closure.linearise(&c.q, &mut scratch.loops);
        std::mem::swap(&mut c.factors, &mut scratch.loops.factors);
    }
}
