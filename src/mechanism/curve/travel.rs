//! Travel: where along a panel the permitted positions end.
use super::panel::Panel;
use crate::mechanism::linkage::{Linkage, Positions};
use crate::numerics::chebyshev::NODES;

/// The permitted travel, as it is followed from the start.
pub(super) struct Travel<'a> {
    linkage: &'a Linkage,
    /// Positive in the permitted travel, negative outside.
    inside: &'a mut dyn FnMut(&Positions) -> f64,
    q: Vec<f64>,
    positions: Positions,
    /// The value at the end of the last panel.
    before: f64,
    /// Values at the nodes of the panel that is being built.
    at_nodes: [f64; NODES],
}

impl<'a> Travel<'a> {
    pub(super) fn new(linkage: &'a Linkage, inside: &'a mut dyn FnMut(&Positions) -> f64) -> Self {
        Self { linkage, inside, q: Vec::new(), positions: Positions::default(), before: 0.0, at_nodes: [0.0; NODES] }
    }

    fn at(&mut self, q: &[f64]) -> f64 {
        self.linkage.place(q, &mut self.positions);
        (self.inside)(&self.positions)
    }

    fn on(&mut self, panel: &Panel, x: f64) -> f64 {
        let mut q = std::mem::take(&mut self.q);
        panel.place(x, &mut q);
        let value = self.at(&q);
        self.q = q;
        value
    }

    /// Set out from a permitted position: where it is on the limit, rounding may not put it outside.
    pub(super) fn start(&mut self, q: &[f64]) {
        self.before = self.at(q).max(0.0);
    }

    /// Take note of the bodies' positions at a node of a panel.
    pub(super) fn pass(&mut self, node: usize, positions: &Positions) {
        self.at_nodes[node] = (self.inside)(positions);
    }

    /// The first sigma of the panel at which travel ends: between two nodes that differ in sign, or where it dips below 0
    /// between them; its nodes are those last passed.
    pub(super) fn left(&mut self, panel: &Panel, nodes: &[f64]) -> Option<f64> {
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
            // The parabola through three values that are not negative may be so between them.
            if k + 1 < x.len() && values[k] < values[k - 1] && values[k] <= values[k + 1] {
                let (lowest, at) = self.lowest(panel, [x[k - 1], x[k], x[k + 1]], values[k]);
                if lowest < 0.0 {
                    return Some(panel.sigma_at(self.root(panel, x[k - 1], at)));
                }
            }
        }
        None
    }

    /// Where it turns negative between an x inside and one outside, to the last bit.
    fn root(&mut self, panel: &Panel, mut inside: f64, mut outside: f64) -> f64 {
        loop {
            let middle = 0.5 * (inside + outside);
            if middle == inside || middle == outside {
                return inside;
            }
            let negative = self.on(panel, middle) < 0.0;
            *(if negative { &mut outside } else { &mut inside }) = middle;
        }
    }

    /// The least value between the outer of three x, the middle one having the least of theirs; golden-section search.
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
