//! Crossings: values of sigma where other branches cross the curve and the loop equations lose rank.
//!
//! In: the panels of a curve. Out: crossings. It must not know loads.
use super::evaluate::Curve;
use super::panel::Panel;
use crate::mechanism::closure::{Scratch, dot};
use crate::numerics::chebyshev::NODES;
use crate::numerics::gapped::GAP;

/// Margin at a node, relative to the largest of the panel, below which a minimum may be a crossing.
const LOW: f64 = 0.3;
/// Relative margin at a crossing.
const NONE: f64 = 1e-6;

impl Curve {
    /// Values of sigma where the loop equations lose rank, ascending. The *margin*, the inverse of the amplification,
    /// falls linearly to 0 on both sides of a crossing, as does the smallest singular value.
    pub(super) fn find_crossings(&self) -> Vec<f64> {
        let mut found: Vec<f64> = Vec::new();
        let mut scratch = Scratch::default();
        for panel in &self.panels {
            if let Some(x) = panel.crossing {
                // The crossing is in the gap between the nodes.
                if x.abs() <= 1.0 {
                    let (below, above) = ((x - GAP).max(-1.0), (x + GAP).min(1.0));
                    let x = self.least_margin(panel, [below, 0.5 * (below + above), above], &mut scratch);
                    found.push(panel.sigma_at(x));
                }
                continue;
            }
            let margins: [f64; NODES] = std::array::from_fn(|j| 1.0 / panel.amplifications[j]);
            let most = margins.iter().fold(0.0, |a: f64, m| a.max(*m));
            // Panels end away from crossings: no minimum is at a border.
            for j in 1..NODES - 1 {
                if margins[j] <= margins[j - 1] && margins[j] < margins[j + 1] && margins[j] < LOW * most {
                    let nodes = &self.transform.nodes;
                    let x = self.least_margin(panel, [nodes[j - 1], nodes[j], nodes[j + 1]], &mut scratch);
                    let sigma = panel.sigma_at(x);
                    let apart = found.last().is_none_or(|last| sigma - last > 1e-6 * self.scale());
                    let inside = sigma > self.range.0 && sigma < self.range.1;
                    if inside && apart && self.margin(panel, x, &mut scratch) < NONE * most {
                        found.push(sigma);
                    }
                }
            }
        }
        found
    }

    /// Margin at x; 0 where the loop equations are singular to the last bit.
    fn margin(&self, panel: &Panel, x: f64, scratch: &mut Scratch) -> f64 {
        let regular = self.closure.linearise(&panel.coordinates_at(x), scratch);
        let amplification = if regular { self.closure.amplification(&panel.normal, scratch) } else { f64::INFINITY };
        1.0 / if amplification.is_nan() { f64::INFINITY } else { amplification }
    }

    /// x with the least margin between the outer two of three x. A solution of the loop equations has a pole at a
    /// crossing: the inverse of its component in a fixed direction, that of the solution at the middle x, changes sign
    /// there and is nearly linear.
    fn least_margin(&self, panel: &Panel, [below, middle, above]: [f64; 3], scratch: &mut Scratch) -> f64 {
        // None at the crossing itself.
        let solve = |x: f64, scratch: &mut Scratch| {
            let regular = self.closure.linearise(&panel.coordinates_at(x), scratch);
            regular.then(|| self.closure.probe(&panel.normal, scratch))
        };
        let Some(direction) = solve(middle, scratch) else { return middle };
        let mut signed = |x: f64| solve(x, scratch).map_or(0.0, |solution| 1.0 / dot(&solution, &direction));
        let (mut a, mut b) = (below, above);
        let (mut fa, mut fb) = (signed(a), signed(b));
        if fa * fb > 0.0 || (fa * fb).is_nan() {
            return minimise(&mut |x| self.margin(panel, x, scratch), below, above);
        }
        // Regula falsi with the Illinois modification.
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

/// Minimum of a function in [a, b] by golden-section search.
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
