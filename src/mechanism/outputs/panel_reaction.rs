//! A joint's reaction to the loads of given sizes, on the panel used last.
//!
//! In: the table of the reaction to each load, the sizes. Out: one polynomial for each part of the reaction, as in the
//! right-hand side. It must not know the state.
use crate::numerics::chebyshev::{NODES, Series};
use crate::numerics::dual::Number;
use crate::numerics::table::Table;

/// The sized loads under the present inputs.
#[derive(Clone, Debug)]
pub struct PresentLoads {
    /// Sizes of the loads.
    pub sizes: Vec<f64>,
    /// Reactions of the joints to the loads of these sizes.
    pub reactions: Vec<PanelReaction>,
}

impl PresentLoads {
    pub fn new(sizes: Vec<f64>, joints: usize) -> Self {
        Self { sizes, reactions: vec![PanelReaction::new(); joints] }
    }
}

/// Polynomials of a joint's reaction to all applied loads on one panel of its table.
#[derive(Clone, Debug)]
pub struct PanelReaction {
    /// First sigma for which the polynomials hold, and the first for which they no longer do.
    low: f64,
    high: f64,
    center: f64,
    /// 2 / width of the panel.
    inverse: f64,
    /// Panel of the table.
    pub panel: usize,
    /// Force x, force y, moment.
    pub applied: [Series; 3],
}

impl PanelReaction {
    /// Holds nowhere.
    pub fn new() -> Self {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { low, high, center: 0.0, inverse: 0.0, panel: 0, applied: [[0.0; NODES]; 3] }
    }

    /// The sizes have changed: hold nowhere.
    pub fn invalidate(&mut self) {
        (self.low, self.high) = (f64::INFINITY, f64::NEG_INFINITY);
    }

    /// Whether the polynomials hold at sigma.
    #[inline]
    pub fn holds(&self, sigma: f64) -> bool {
        self.low <= sigma && sigma < self.high
    }

    /// x on the panel at sigma.
    #[inline]
    pub fn x<N: Number>(&self, sigma: N) -> N {
        sigma.chain((sigma.value() - self.center) * self.inverse, self.inverse)
    }

    /// Enter the panel at sigma. `sizes` are those of the applied loads; of the `columns` of each part, they belong to those
    /// from the column 2 on.
    #[cold]
    pub fn enter(
        &mut self,
        table: &Table,
        sigma: f64,
        (parts, columns): (usize, usize),
        sizes: impl Iterator<Item = f64> + Clone,
    ) {
        self.panel = table.panel_near(sigma, self.panel);
        let (a, b) = table.borders(self.panel);
        (self.low, self.high, self.center, self.inverse) = (a, b, 0.5 * (a + b), 2.0 / (b - a));
        // Outside the table its first and its last panel continue.
        if self.panel == 0 {
            self.low = f64::NEG_INFINITY;
        }
        if self.panel + 1 == table.panels() {
            self.high = f64::INFINITY;
        }
        for (part, sum) in self.applied.iter_mut().enumerate().take(parts) {
            *sum = [0.0; NODES];
            for (load, size) in sizes.clone().enumerate().filter(|(_, size)| *size != 0.0) {
                let series = table.series(self.panel, part * columns + 2 + load);
                sum.iter_mut().zip(series).for_each(|(sum, c)| *sum += size * c);
            }
        }
    }
}
