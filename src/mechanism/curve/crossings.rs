//! Crossings: where other branches cross the curve, because the loop equations lose rank.
use super::Curve;
use super::panel::Panel;
use crate::mechanism::closure::{Workspace, dot};
use crate::numerics::chebyshev::NODES;

/// A minimum of the margin below this part of a panel's largest may be a crossing.
const LOW: f64 = 0.3;
/// It is one if the margin falls below this part.
const NONE: f64 = 1e-6;

impl Curve {
    /// Positions where the loop equations lose rank, in ascending order. The *margin* is the inverse of the amplification:
    /// like the smallest singular value it falls linearly to 0 on both sides of a crossing.
    pub(super) fn find_crossings(&self) -> Vec<f64> {
        let mut found: Vec<f64> = Vec::new();
        let mut work = Workspace::default();
        for panel in &self.panels {
            let margins: [f64; NODES] = std::array::from_fn(|j| 1.0 / panel.amplifications[j]);
            let most = margins.iter().fold(0.0, |a: f64, m| a.max(*m));
            // Between panels it is no minimum: those end away from crossings.
            for j in 1..NODES - 1 {
                if margins[j] <= margins[j - 1] && margins[j] < margins[j + 1] && margins[j] < LOW * most {
                    let nodes = &self.transform.nodes;
                    let x = self.least_margin(panel, [nodes[j - 1], nodes[j], nodes[j + 1]], &mut work);
                    let sigma = panel.sigma_at(x);
                    let apart = found.last().is_none_or(|last| sigma - last > 1e-6 * self.scale());
                    let inside = sigma > self.range.0 && sigma < self.range.1;
                    if inside && apart && self.margin(panel, x, &mut work) < NONE * most {
                        found.push(sigma);
                    }
                }
            }
        }
        found
    }

    /// 0 where the equations have no solution.
    fn margin(&self, panel: &Panel, x: f64, work: &mut Workspace) -> f64 {
        let regular = self.closure.linearise(&panel.series_at(x), work);
        let amplification = if regular { self.closure.amplification(&panel.normal, work) } else { f64::INFINITY };
        1.0 / if amplification.is_nan() { f64::INFINITY } else { amplification }
    }

    /// Where between the outer of three x the margin is least. Solutions have a pole at a crossing: the inverse of one,
    /// seen in the direction that it has at the middle x, changes sign there and is nearly linear.
    fn least_margin(&self, panel: &Panel, [below, middle, above]: [f64; 3], work: &mut Workspace) -> f64 {
        // Where the equations have no solution, the crossing is found.
        let solve = |x: f64, work: &mut Workspace| {
            let regular = self.closure.linearise(&panel.series_at(x), work);
            regular.then(|| self.closure.probe(&panel.normal, work))
        };
        let Some(direction) = solve(middle, work) else { return middle };
        let mut signed = |x: f64| solve(x, work).map_or(0.0, |solution| 1.0 / dot(&solution, &direction));
        let (mut a, mut b) = (below, above);
        let (mut fa, mut fb) = (signed(a), signed(b));
        if fa * fb > 0.0 || (fa * fb).is_nan() {
            return minimise(&mut |x| self.margin(panel, x, work), below, above);
        }
        // Regula falsi; an end that stays counts half (Illinois).
        for _ in 0..60 {
            let x = (a * fb - b * fa) / (fb - fa);
            let fx = signed(x);
            if fx == 0.0 || (x - b).abs() < 1e-13 {
                return x;
            }
            if fx * fb < 0.0 {
                (a, fa) = (b, fb);
            } else {
                fa *= 0.5;
            }
            (b, fb) = (x, fx);
        }
        b
    }
}

/// Golden-section search.
fn minimise(f: &mut dyn FnMut(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (mut c, mut d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    while b - a > 1e-9 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - GOLDEN * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + GOLDEN * (b - a);
            fd = f(d);
        }
    }
    0.5 * (a + b)
}
