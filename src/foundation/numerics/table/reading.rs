//! Panels, positions and values of a table.
//!
//! In: a table, sigma. Out: positions and values, without allocation or lock. Must not know: how a table is built.
use super::{Table, TablePosition, polynomial};
use crate::numerics::chebyshev::{NODES, Series, polynomial_and_others, polynomial_and_slope, polynomials};
use crate::numerics::processor::Arithmetic;

impl Table {
    /// Number of panels.
    pub fn panels(&self) -> usize {
        self.borders.len() - 1
    }

    /// Whether a panel is a gap, on which some component is not resolved.
    #[inline]
    pub fn is_gap(&self, panel: usize) -> bool {
        self.gaps.binary_search(&panel).is_ok()
    }

    /// First and last sigma of each gap.
    pub fn gaps(&self) -> impl ExactSizeIterator<Item = (f64, f64)> {
        self.gaps.iter().map(|&panel| self.borders(panel))
    }

    /// First and last sigma of a panel.
    #[inline]
    pub fn borders(&self, panel: usize) -> (f64, f64) {
        (self.borders[panel], self.borders[panel + 1])
    }

    /// The panel that contains sigma. Outside the table, the first or the last panel.
    #[inline]
    pub fn panel(&self, sigma: f64) -> usize {
        self.borders[1..self.borders.len() - 1].partition_point(|b| *b <= sigma)
    }

    /// [`Self::panel`], with a search that starts at a panel and its neighbours.
    #[inline(always)]
    pub fn panel_near(&self, sigma: f64, panel: usize) -> usize {
        if self.contains(panel, sigma) { panel } else { self.neighbouring_panel(sigma, panel) }
    }

    #[inline(never)]
    fn neighbouring_panel(&self, sigma: f64, panel: usize) -> usize {
        let is_before = self.borders.get(panel).is_some_and(|first| sigma < *first);
        let neighbour = if is_before { panel.wrapping_sub(1) } else { panel + 1 };
        if self.contains(neighbour, sigma) { neighbour } else { self.panel(sigma) }
    }

    /// Whether the panel exists and contains sigma.
    #[inline(always)]
    fn contains(&self, panel: usize, sigma: f64) -> bool {
        panel < self.borders.len().saturating_sub(1) && self.borders[panel] <= sigma && sigma < self.borders[panel + 1]
    }

    /// Position of sigma.
    #[inline]
    pub fn position(&self, sigma: f64) -> TablePosition {
        self.position_in(sigma, self.panel(sigma))
    }

    /// [`Self::position`], with a search that starts at a panel and its neighbours.
    #[inline]
    pub fn position_near(&self, sigma: f64, panel: usize) -> TablePosition {
        self.position_in(sigma, self.panel_near(sigma, panel))
    }

    #[inline]
    fn position_in(&self, sigma: f64, panel: usize) -> TablePosition {
        let (a, b) = self.borders(panel);
        TablePosition { panel, x: (2.0 * sigma - (a + b)) / (b - a) }
    }

    /// Monomial coefficients of one component on one panel.
    #[inline]
    pub fn series(&self, panel: usize, component: usize) -> &Series {
        &self.coefficients[panel * self.components + component]
    }

    /// Value of a component at a position.
    #[inline]
    pub fn value(&self, at: TablePosition, component: usize) -> f64 {
        polynomial(self.series(at.panel, component), at.x)
    }

    /// Values of successive components at a position, by the fastest code for this processor: results on different
    /// processors differ by rounding errors.
    #[inline(always)]
    pub fn values<const K: usize>(&self, at: TablePosition, first: usize) -> [f64; K] {
        polynomials(self.successive(at.panel, first), at.x)
    }

    /// Value of a component at a position, as [`Self::value`], and values of the next components, as [`Self::values`].
    #[inline(always)]
    pub fn value_and_next<A: Arithmetic, const K: usize>(&self, at: TablePosition, first: usize) -> [f64; K] {
        polynomial_and_others::<A, K>(self.successive(at.panel, first), at.x)
    }

    /// Monomial coefficients of successive components on one panel.
    #[inline(always)]
    fn successive<const K: usize>(&self, panel: usize, first: usize) -> &[Series; K] {
        let series = self.coefficients[panel * self.components + first..].first_chunk();
        series.unwrap_or(const { &[[f64::NAN; NODES]; K] })
    }

    /// Value of a component at a position, and its derivative along sigma.
    pub fn value_and_slope(&self, at: TablePosition, component: usize) -> [f64; 2] {
        let [value, slope] = polynomial_and_slope(self.series(at.panel, component), at.x);
        let (a, b) = self.borders(at.panel);
        [value, slope * (2.0 / (b - a))]
    }
}
