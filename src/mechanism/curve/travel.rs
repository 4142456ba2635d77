//! Travel: the end of the permitted positions on a panel.
//!
//! In: panels in the order of tracing. Out: the first sigma outside the travel. It must not know what limits the
//! travel.
use super::panel::Panel;
use crate::mechanism::linkage::{Linkage, Positions};
use crate::numerics::bracket::bisect;
use crate::numerics::chebyshev::NODES;

/// The permitted travel, followed panel by panel.
pub(super) struct Travel<'a> {
    linkage: &'a Linkage,
    /// Margin: positive in the permitted travel, negative outside.
    margin: &'a mut dyn FnMut(&Positions) -> f64,
    q: Vec<f64>,
    positions: Positions,
    /// Margin at the end of the last panel.
    before: f64,
    /// Margins at the nodes of the current panel.
    at_nodes: [f64; NODES],
}

impl<'a> Travel<'a> {
    pub(super) fn new(linkage: &'a Linkage, margin: &'a mut dyn FnMut(&Positions) -> f64) -> Self {
        Self { linkage, margin, q: Vec::new(), positions: Positions::default(), before: 0.0, at_nodes: [0.0; NODES] }
    }

    fn at(&mut self, q: &[f64]) -> f64 {
        self.linkage.update_positions(q, &mut self.positions);
        (self.margin)(&self.positions)
    }

    fn on(&mut self, panel: &Panel, x: f64) -> f64 {
        let mut q = std::mem::take(&mut self.q);
        panel.coordinates_into(x, &mut q);
        let value = self.at(&q);
        self.q = q;
        value
    }

    /// Whether a position is permitted, and not just by rounding.
    pub(super) fn allows(&mut self, q: &[f64]) -> bool {
        /// Margin that rounding does not explain, in the unit of margins.
        const CLEAR: f64 = 1e-6;
        self.at(q) > CLEAR
    }

    /// Start at a permitted position; a negative margin there is rounding.
    pub(super) fn start(&mut self, q: &[f64]) {
        self.before = self.at(q).max(0.0);
    }

    /// Evaluate the margin at a node of the current panel.
    pub(super) fn visit(&mut self, node: usize, positions: &Positions) {
        self.at_nodes[node] = (self.margin)(positions);
    }

    /// First sigma of the current panel at which the travel ends: between nodes with margins of opposite sign, or where
    /// the margin is negative between nodes with positive ones.
    pub(super) fn end(&mut self, panel: &Panel, nodes: &[f64]) -> Option<f64> {
        let mut x: Vec<f64> = vec![-1.0];
        x.extend(nodes);
        x.push(1.0);
        let mut values = vec![self.before];
        values.extend(self.at_nodes);
        values.push(self.at(&panel.tip));
        self.before = values[values.len() - 1];
        for k in 1..x.len() {
            if values[k] < 0.0 {
                let end = if values[k - 1] > 0.0 { self.root(panel, x[k - 1], x[k]) } else { x[k - 1] };
                return Some(if end == -1.0 { panel.start } else { panel.sigma_at(end) });
            }
            // Between three nodes with positive margins a minimum may be negative.
            if k + 1 < x.len() && values[k] < values[k - 1] && values[k] <= values[k + 1] {
                let (lowest, at) = self.lowest(panel, [x[k - 1], x[k], x[k + 1]], values[k]);
                if lowest < 0.0 {
                    return Some(panel.sigma_at(self.root(panel, x[k - 1], at)));
                }
            }
        }
        None
    }

    /// Last x inside the travel between an x inside and an x outside.
    fn root(&mut self, panel: &Panel, inside: f64, outside: f64) -> f64 {
        bisect(|x| self.on(panel, x) < 0.0, inside, outside)[0]
    }

    /// Least margin between the outer two of three x, and its x, by golden-section search. `least`: margin at the
    /// middle x. The search ends at the first negative margin.
    fn lowest(&mut self, panel: &Panel, [mut a, mut best, mut b]: [f64; 3], mut least: f64) -> (f64, f64) {
        const PART: f64 = 0.381_966_011_250_105;
        while b - a > 1e-8 && least >= 0.0 {
            let right = b - best > best - a;
            let x = if right { best + PART * (b - best) } else { best - PART * (best - a) };
            let value = self.on(panel, x);
            match (value < least, right) {
                (true, true) => (a, best, least) = (best, x, value),
                (true, false) => (b, best, least) = (best, x, value),
                (false, true) => b = x,
                (false, false) => a = x,
            }
        }
        (least, best)
    }
}
