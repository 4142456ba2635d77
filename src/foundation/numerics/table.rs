//! Tables: functions along the curve as polynomials on adaptive panels.
//!
//! In: an exact function of sigma. Out: polynomials for the function's components on panels of sigma. A table is built
//! once and read without allocation or lock. Must not know: what the functions mean.
mod reading;

pub use super::chebyshev::polynomial;

use super::chebyshev::{NODES, Series, Transform, monomials, slopes_of, tail};
use super::dual::Number;
use super::order;
use std::fmt;
use std::ops::Range;

/// Error of a component relative to its largest value along the curve.
pub const ACCURACY: f64 = 1e-13;

/// A component that is not resolved even on the shortest panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Unresolved {
    /// sigma in the middle of the smallest panel tried.
    pub sigma: f64,
    /// Index of the component.
    pub component: usize,
}

impl fmt::Display for Unresolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "component {} of a table is not smooth at sigma = {} along the motion", self.component, self.sigma)
    }
}

/// Initial panels of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// First sigma of each panel, then the last sigma of all.
    pub borders: Vec<f64>,
    /// Values of sigma at which the exact function amplifies rounding errors. Each stays in the middle of a panel.
    pub centers: Vec<f64>,
    /// Largest tail, relative to the component, that can be a rounding error of the exact function: [`NOISE`] or more.
    pub noise: f64,
}

/// Largest tail, relative to the component, that can be a rounding error of an exact function near the origin.
pub const NOISE: f64 = 1e-10;

impl Grid {
    /// This grid with the borders of tables that were built on it.
    pub fn refined<'a>(&self, tables: impl IntoIterator<Item = &'a Table>) -> Self {
        let mut borders = self.borders.clone();
        // Most tables have the borders of the previous table or of the grid.
        let mut last = &self.borders;
        for table in tables {
            if table.borders != *last {
                borders.extend(&table.borders);
            }
            last = &table.borders;
        }
        if borders.len() > self.borders.len() {
            order::sort(&mut borders);
        }
        borders.dedup();
        Self { borders, centers: self.centers.clone(), noise: self.noise }
    }
}

/// Functions of sigma on panels. The default has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// First sigma of each panel, then the last sigma of all.
    borders: Vec<f64>,
    components: usize,
    /// Monomial coefficients, panel by panel, component by component.
    coefficients: Vec<Series>,
    /// Panels on which some component is not resolved, ascending.
    gaps: Vec<usize>,
}

/// Position in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TablePosition {
    /// Index of the panel.
    pub panel: usize,
    /// Coordinate in the panel: -1 at its first sigma, 1 at its last.
    pub x: f64,
}

/// Value of a polynomial with monomial coefficients at x. If x carries derivatives, the value does too.
#[inline]
pub fn polynomial_at<T: Number>(c: &Series, x: T) -> T {
    let slope = if T::CARRIES { polynomial(&slopes_of(c), x.value()) } else { 0.0 };
    let second = if T::CARRIES_SECOND { polynomial(&slopes_of(&slopes_of(c)), x.value()) } else { 0.0 };
    x.compose([polynomial(c, x.value()), slope, second])
}

impl Table {
    /// Number of components.
    pub fn components(&self) -> usize {
        self.components
    }

    /// Tabulates several sets of functions that share their evaluations, on the panels of `grid`, divided where needed.
    /// `sizes`: natural size of each component of each set. `exact` fills the components of all sets, one set after the
    /// other, at a sigma. It returns the factor by which it amplifies rounding errors.
    ///
    /// A panel is divided until the last Chebyshev coefficients of every component are at most [`ACCURACY`] times its
    /// size. This is the larger of the component's natural size and its largest value on the grid. Larger rounding
    /// errors of `exact` (amplified twice in second derivatives) or of sigma are accepted. Otherwise the set is
    /// [`Unresolved`].
    pub fn build_all(
        grid: &Grid,
        sizes: &[Vec<f64>],
        exact: &mut dyn FnMut(f64, &mut [f64]) -> f64,
    ) -> Vec<Result<Self, Unresolved>> {
        Self::build(grid, sizes, false, exact)
    }

    /// Tabulates one set of functions that may have poles. A shortest panel on which a component is not resolved is a
    /// gap. In a gap, only smooth components are resolved. Where a function is large, its error is relative to its
    /// value.
    ///
    /// # Errors
    /// Never; the type is that of [`Self::build_all`].
    pub fn build_with_gaps(
        grid: &Grid,
        sizes: Vec<f64>,
        exact: &mut dyn FnMut(f64, &mut [f64]) -> f64,
    ) -> Result<Self, Unresolved> {
        Self::build(grid, &[sizes], true, exact).swap_remove(0)
    }

    fn build(
        grid: &Grid,
        sizes: &[Vec<f64>],
        with_gaps: bool,
        exact: &mut dyn FnMut(f64, &mut [f64]) -> f64,
    ) -> Vec<Result<Self, Unresolved>> {
        let mut sets: Vec<Set> = Vec::new();
        for size in sizes {
            let first = sets.last().map_or(0, |s| s.components.end);
            let mut table = Self { components: size.len(), ..Self::default() };
            // Few panels are divided.
            table.borders.reserve(grid.borders.len());
            table.borders.push(grid.borders[0]);
            table.coefficients.reserve((grid.borders.len() - 1) * size.len());
            let (components, largest) = (first..first + size.len(), size.clone());
            sets.push(Set { components, largest, table, with_gaps, unresolved: None });
        }
        let components = sets.last().map_or(0, |s| s.components.end);
        let mut sampler = Sampler {
            transform: Transform::default(),
            values: vec![0.0; components],
            samples: vec![[0.0; NODES]; components],
            exact,
        };
        // Intervals that are not yet covered by panels, the last interval first.
        let mut open = Vec::new();
        for pair in grid.borders.windows(2).rev() {
            let mut interval = sampler.interval(pair[0], pair[1]);
            interval.parent_tails = vec![f64::INFINITY; sets.len()];
            open.push(interval);
        }
        for interval in &open {
            for set in &mut sets {
                for (all, here) in set.largest.iter_mut().zip(&interval.largest[set.components.clone()]) {
                    *all = all.max(*here);
                }
            }
        }
        while let Some(interval) = open.pop() {
            let (a, b) = (interval.a, interval.b);
            let mut pieces = 1;
            // NaN for a set that needs no further pieces: it is resolved or unresolved.
            let mut tails = vec![f64::NAN; sets.len()];
            for (k, set) in sets.iter_mut().enumerate() {
                if interval.parent_tails[k].is_nan() || set.unresolved.is_some() {
                    continue;
                }
                match set.judge(&interval, interval.parent_tails[k], grid.noise) {
                    Verdict::Resolved => {}
                    Verdict::Divide { tail, into } => {
                        tails[k] = tail;
                        pieces = pieces.max(into);
                    }
                    Verdict::Unresolved(component) => {
                        set.unresolved = Some(Unresolved { sigma: 0.5 * (a + b), component });
                    }
                }
            }
            if pieces == 1 {
                continue;
            }
            if grid.centers.iter().any(|c| a < *c && *c < b) {
                pieces = 3;
            }
            let border = |k: usize| match k {
                0 => a,
                k if k == pieces => b,
                k => a + (b - a) * k as f64 / pieces as f64,
            };
            for k in (0..pieces).rev() {
                let part = interval.part / pieces as f64;
                let parent_tails = tails.clone();
                open.push(Interval { part, parent_tails, ..sampler.interval(border(k), border(k + 1)) });
            }
        }
        sets.into_iter().map(|set| set.unresolved.map_or(Ok(set.table), Err)).collect()
    }

    /// Sets a component to the sum of two others, each times a factor.
    pub fn set_sum(&mut self, component: usize, of: [usize; 2], factors: [f64; 2]) {
        for panel in self.coefficients.chunks_exact_mut(self.components) {
            panel[component] = sum([&panel[of[0]], &panel[of[1]]], factors);
        }
    }

    /// A table of `count` components: component k times the first factor plus component `count` + k times the second.
    pub fn sums(&self, count: usize, factors: [f64; 2]) -> Self {
        let panels = self.coefficients.chunks_exact(self.components);
        let of =
            |panel: &[Series]| (0..count).map(|k| sum([&panel[k], &panel[count + k]], factors)).collect::<Vec<_>>();
        let (borders, gaps) = (self.borders.clone(), self.gaps.clone());
        Self { borders, components: count, coefficients: panels.flat_map(of).collect(), gaps }
    }

    /// Borders, coefficients and gaps, from which [`Self::of_parts`] restores the table.
    pub fn parts(&self) -> (&[f64], &[Series], &[usize]) {
        (&self.borders, &self.coefficients, &self.gaps)
    }

    /// The table with these borders, components, coefficients and gaps. None if the data are inconsistent.
    pub fn of_parts(borders: Vec<f64>, components: usize, coefficients: Vec<Series>, gaps: Vec<usize>) -> Option<Self> {
        let panels = borders.len().checked_sub(1).filter(|panels| *panels > 0)?;
        let ascending = borders.windows(2).all(|pair| pair[0] < pair[1]);
        let placed = gaps.windows(2).all(|pair| pair[0] < pair[1]) && gaps.last().is_none_or(|last| *last < panels);
        let whole = panels.checked_mul(components) == Some(coefficients.len());
        (ascending && placed && whole).then_some(Self { borders, components, coefficients, gaps })
    }
}

/// Sum of two series, each times a factor.
fn sum([a, b]: [&Series; 2], factors: [f64; 2]) -> Series {
    std::array::from_fn(|k| factors[0] * a[k] + factors[1] * b[k])
}

/// Functions of one table under construction.
struct Set {
    /// Indices of its components among those of all sets.
    components: Range<usize>,
    /// The larger of each component's natural size and its largest value on the grid.
    largest: Vec<f64>,
    table: Table,
    /// Whether an unresolved panel is a gap. Otherwise it is an error.
    with_gaps: bool,
    unresolved: Option<Unresolved>,
}

/// Result of resolving a set on an interval.
enum Verdict {
    Resolved,
    /// Largest tail of the set's series, relative to the component; number of pieces.
    Divide {
        tail: f64,
        into: usize,
    },
    /// Index of a component that is not smooth.
    Unresolved(usize),
}

impl Set {
    /// Adds the interval as a panel if the set is resolved on it. `parent_tail`: largest tail on the undivided
    /// interval.
    fn judge(&mut self, interval: &Interval, parent_tail: f64, noise: f64) -> Verdict {
        /// Length of the shortest piece, relative to a panel of the grid.
        const SHORTEST: f64 = 1.0 / 20_000.0;
        /// Order of the coefficients that must be small.
        const ORDER: f64 = (NODES - 2) as f64;
        /// Relative rounding error of sigma, which is a sum of lengths.
        const SIGMA_ROUNDING: f64 = 4.0 * f64::EPSILON;
        /// Number of gaps after which every unresolved panel is a gap at once. It limits the work for a table.
        const MOST_GAPS: usize = 64;
        /// Largest relative tail that may be due to the rounding error of sigma.
        const COARSEST: f64 = 1e-9;
        let series = &interval.series[self.components.clone()];
        let (mut worst, mut component) = (0.0, 0);
        // Rounding error of sigma in units of x. It limits the resolution if an interval is short compared with sigma.
        let step = SIGMA_ROUNDING * interval.a.abs().max(interval.b.abs()) / (0.5 * (interval.b - interval.a));
        for (i, (s, largest)) in series.iter().zip(&self.largest).enumerate() {
            let largest =
                &if self.with_gaps { largest.max(interval.largest[self.components.start + i]) } else { *largest };
            let t = if *largest > 0.0 { tail(s) / largest } else { 0.0 };
            let slope = || s.iter().enumerate().map(|(k, c)| k as f64 * c.abs()).sum::<f64>();
            if (t > worst && (t > COARSEST || t * largest > step * slope())) || t.is_nan() {
                (worst, component) = (t, i);
            }
        }
        let allowed = (0.5 * ACCURACY).max(interval.rounding);
        // A small tail that division has not reduced is a rounding error of the exact function.
        let is_rounding = interval.part < 1.0 && worst < noise && worst > 0.1 * parent_tail;
        if worst <= allowed || is_rounding {
            self.add_panel(interval);
            return Verdict::Resolved;
        }
        if self.with_gaps {
            if interval.part < SHORTEST || self.table.gaps.len() >= MOST_GAPS {
                self.table.gaps.push(self.table.borders.len() - 1);
                self.add_panel(interval);
                return Verdict::Resolved;
            }
        } else if interval.part < SHORTEST || !worst.is_finite() {
            return Verdict::Unresolved(component);
        }
        Verdict::Divide { tail: worst, into: if (worst / allowed).powf(1.0 / ORDER) > 1.9 { 3 } else { 2 } }
    }

    /// Adds the interval as a panel. A component without finite values there is set to 0.
    fn add_panel(&mut self, interval: &Interval) {
        let series = &interval.series[self.components.clone()];
        let finite = |s: Series| if s.iter().all(|c| c.is_finite()) { s } else { [0.0; NODES] };
        self.table.borders.push(interval.b);
        self.table.coefficients.extend(series.iter().map(|s| finite(unless_zero(s, monomials))));
    }
}

/// All components on an interval of sigma.
struct Interval {
    a: f64,
    b: f64,
    /// Length relative to a panel of the grid.
    part: f64,
    series: Vec<Series>,
    largest: Vec<f64>,
    /// Rounding error of the values, relative to the largest value.
    rounding: f64,
    /// Largest tail of each set on the parent interval. NaN for a set that is resolved there.
    parent_tails: Vec<f64>,
}

/// A linear map of a series, skipped for a series of zeros.
fn unless_zero(values: &[f64; NODES], map: impl Fn(&[f64; NODES]) -> Series) -> Series {
    if values.iter().all(|v| *v == 0.0) { [0.0; NODES] } else { map(values) }
}

/// Samples of all functions at the nodes of an interval.
struct Sampler<'a> {
    transform: Transform,
    values: Vec<f64>,
    samples: Vec<[f64; NODES]>,
    exact: &'a mut dyn FnMut(f64, &mut [f64]) -> f64,
}

impl Sampler<'_> {
    fn interval(&mut self, a: f64, b: f64) -> Interval {
        let mut rounding: f64 = 1.0;
        for (j, x) in self.transform.nodes.iter().enumerate() {
            rounding = rounding.max((self.exact)(a + 0.5 * (b - a) * (1.0 + x), &mut self.values));
            for (sample, value) in self.samples.iter_mut().zip(&self.values) {
                sample[j] = *value;
            }
        }
        let largest = self.samples.iter().map(|s| s.iter().fold(0.0, |a: f64, v| a.max(v.abs()))).collect();
        let series = self.samples.iter().map(|s| unless_zero(s, |s| self.transform.fit(s))).collect();
        let rounding = (f64::EPSILON * rounding * rounding).min(10.0 * ACCURACY);
        Interval { a, b, part: 1.0, series, largest, rounding, parent_tails: Vec::new() }
    }
}

#[cfg(test)]
mod tests;
