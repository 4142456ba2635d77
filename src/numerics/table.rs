//! Tables: functions along the curve as polynomials on adaptive panels.
//!
//! In: an exact function of sigma. Out: the same function at the cost of one polynomial for each component. Built once,
//! read without allocation, lock or branch on the mechanism's size. It must not know what the functions mean.
mod row;

pub use crate::numerics::chebyshev::polynomial;
pub use row::{Bundle, ROW, Row, add_side_by_side, side_by_side, side_by_side_at};

use crate::numerics::chebyshev::{NODES, Series, Transform, monomials, slopes_of, tail};
use crate::numerics::dual::Number;
use std::fmt;
use std::ops::Range;

/// A table resolves its components to this part of their largest value.
pub const ACCURACY: f64 = 1e-13;

/// No panel, however short, resolves the function here.
#[derive(Clone, Debug, PartialEq)]
pub struct Unresolved {
    /// sigma in the middle of the smallest panel tried.
    pub sigma: f64,
    /// The component that is not resolved.
    pub component: usize,
}

impl fmt::Display for Unresolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "component {} is not smooth at sigma = {}", self.component, self.sigma)
    }
}

/// Where tables start.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// First sigma of each panel, then the last sigma of all.
    pub borders: Vec<f64>,
    /// What is in the middle of a panel and must stay in the middle of one: where the exact function amplifies rounding.
    pub centers: Vec<f64>,
}

impl Grid {
    /// With the borders of these tables, which started from it.
    pub fn refined<'a>(&self, tables: impl IntoIterator<Item = &'a Table>) -> Self {
        let mut borders = self.borders.clone();
        borders.extend(tables.into_iter().flat_map(|t| &t.borders));
        borders.sort_by(f64::total_cmp);
        borders.dedup();
        Self { borders, centers: self.centers.clone() }
    }
}

/// Functions of sigma on panels.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// First sigma of each panel, then the last sigma of all.
    borders: Vec<f64>,
    components: usize,
    /// Monomial coefficients, panel by panel, component by component.
    coefficients: Vec<Series>,
}

/// A place in a table: the panel, and where in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TablePosition {
    /// Panel.
    pub panel: usize,
    /// -1 at its first sigma, 1 at its last.
    pub x: f64,
}

/// A polynomial with monomial coefficients at x, with derivatives if x carries some.
#[inline]
pub fn polynomial_at<T: Number>(c: &Series, x: T) -> T {
    let slope = if T::CARRIES { polynomial(&slopes_of(c), x.value()) } else { 0.0 };
    x.chain(polynomial(c, x.value()), slope)
}

impl Table {
    /// A table of nothing.
    pub fn empty() -> Self {
        Self { borders: Vec::new(), components: 0, coefficients: Vec::new() }
    }

    /// Number of components.
    pub fn components(&self) -> usize {
        self.components
    }

    /// Tabulate several sets of functions that come from the same evaluations on the panels of `grid`, cut where needed.
    /// `sizes` has each set's natural sizes of its components; `exact` fills the components of all sets, one after the
    /// other, at a sigma, and returns how much it amplifies rounding.
    ///
    /// Each panel is cut until the set's series have decayed to [`ACCURACY`], relative to the natural size of the component
    /// or to its largest value on the whole grid, or to the rounding in `exact`, as second derivatives amplify it twice, or in
    /// sigma.
    /// A set is [`Unresolved`] where cutting does not help.
    pub fn build_all(
        grid: &Grid,
        sizes: &[Vec<f64>],
        exact: &mut dyn FnMut(f64, &mut [f64]) -> f64,
    ) -> Vec<Result<Self, Unresolved>> {
        let mut sets: Vec<Set> = Vec::new();
        for size in sizes {
            let first = sets.last().map_or(0, |s| s.components.end);
            let table = Self { borders: vec![grid.borders[0]], components: size.len(), coefficients: Vec::new() };
            sets.push(Set { components: first..first + size.len(), whole: size.clone(), table, unresolved: None });
        }
        let components = sets.last().map_or(0, |s| s.components.end);
        let mut sampler = Sampler {
            transform: Transform::new(),
            values: vec![0.0; components],
            samples: vec![[0.0; NODES]; components],
            exact,
        };
        // What must still be placed, last panel first.
        let mut open = Vec::new();
        for pair in grid.borders.windows(2).rev() {
            let mut stretch = sampler.stretch(pair[0], pair[1]);
            stretch.before = vec![f64::INFINITY; sets.len()];
            open.push(stretch);
        }
        for stretch in &open {
            for set in &mut sets {
                for (whole, largest) in set.whole.iter_mut().zip(&stretch.largest[set.components.clone()]) {
                    *whole = whole.max(*largest);
                }
            }
        }
        while let Some(stretch) = open.pop() {
            let (a, b) = (stretch.a, stretch.b);
            let mut pieces = 1;
            // A set that has been placed here, or is given up, has nothing more to be seen to in the pieces.
            let mut before = vec![f64::NAN; sets.len()];
            for (k, set) in sets.iter_mut().enumerate() {
                if stretch.before[k].is_nan() || set.unresolved.is_some() {
                    continue;
                }
                match set.place(&stretch, stretch.before[k]) {
                    Placed::Resolved => {}
                    Placed::Cut(tail, into) => {
                        before[k] = tail;
                        pieces = pieces.max(into);
                    }
                    Placed::Unresolved(component) => {
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
                let part = stretch.part / pieces as f64;
                open.push(Stretch { part, before: before.clone(), ..sampler.stretch(border(k), border(k + 1)) });
            }
        }
        sets.into_iter().map(|set| set.unresolved.map_or(Ok(set.table), Err)).collect()
    }

    /// One set of functions tabulated, as by [`Self::build_all`].
    ///
    /// # Errors
    /// [`Unresolved`] where cutting does not help.
    pub fn build(
        grid: &Grid,
        sizes: &[f64],
        exact: &mut dyn FnMut(f64, &mut [f64]) -> f64,
    ) -> Result<Self, Unresolved> {
        let nothing = Err(Unresolved { sigma: grid.borders[0], component: 0 });
        Self::build_all(grid, &[sizes.to_vec()], exact).pop().unwrap_or(nothing)
    }

    /// Number of panels.
    pub fn panels(&self) -> usize {
        self.borders.len() - 1
    }

    /// First and last sigma of a panel.
    pub fn borders(&self, panel: usize) -> (f64, f64) {
        (self.borders[panel], self.borders[panel + 1])
    }

    /// The panel at sigma; the first or the last one outside.
    pub fn panel(&self, sigma: f64) -> usize {
        self.borders[1..self.borders.len() - 1].partition_point(|b| *b <= sigma)
    }

    /// [`Self::panel`], looked for first in this panel and beside it.
    #[inline]
    pub fn panel_near(&self, sigma: f64, panel: usize) -> usize {
        let holds = |p: usize| p + 1 < self.borders.len() && self.borders[p] <= sigma && sigma < self.borders[p + 1];
        if holds(panel) {
            panel
        } else if holds(panel + 1) {
            panel + 1
        } else if panel > 0 && holds(panel - 1) {
            panel - 1
        } else {
            self.panel(sigma)
        }
    }

    /// The place of sigma.
    pub fn spot(&self, sigma: f64) -> TablePosition {
        self.spot_in(sigma, self.panel(sigma))
    }

    /// [`Self::spot`], looked for first in this panel and beside it.
    #[inline]
    pub fn spot_near(&self, sigma: f64, panel: usize) -> TablePosition {
        self.spot_in(sigma, self.panel_near(sigma, panel))
    }

    fn spot_in(&self, sigma: f64, panel: usize) -> TablePosition {
        let (a, b) = self.borders(panel);
        TablePosition { panel, x: (2.0 * sigma - (a + b)) / (b - a) }
    }

    /// Monomial coefficients of one component on one panel.
    pub fn series(&self, panel: usize, component: usize) -> &Series {
        &self.coefficients[panel * self.components + component]
    }

    /// Value of a component at a place.
    pub fn value(&self, spot: TablePosition, component: usize) -> f64 {
        polynomial(self.series(spot.panel, component), spot.x)
    }
}

/// Functions that are tabulated together.
struct Set {
    /// Their places among all components.
    components: Range<usize>,
    /// Natural size of each component, or its largest value on the grid.
    whole: Vec<f64>,
    table: Table,
    unresolved: Option<Unresolved>,
}

/// What becomes of a set on a stretch.
enum Placed {
    Resolved,
    /// Its largest tail, and into how many pieces to cut.
    Cut(f64, usize),
    /// This component is not smooth.
    Unresolved(usize),
}

impl Set {
    fn place(&mut self, stretch: &Stretch, before: f64) -> Placed {
        /// No piece is shorter than this part of a panel of the grid.
        const SHORTEST: f64 = 1.0 / 20_000.0;
        /// Order of the coefficients that must be small.
        const ORDER: f64 = (NODES - 2) as f64;
        let series = &stretch.series[self.components.clone()];
        let (mut worst, mut component) = (0.0, 0);
        /// Rounding of sigma, as of a sum of lengths, in units of its last place.
        const STEP: f64 = 4.0 * f64::EPSILON;
        /// Rounding of this size is not accepted.
        const COARSEST: f64 = 1e-9;
        // On a stretch that is short against sigma no series can tell less than what that rounding makes.
        let step = STEP * stretch.a.abs().max(stretch.b.abs()) / (0.5 * (stretch.b - stretch.a));
        for (i, (s, whole)) in series.iter().zip(&self.whole).enumerate() {
            let t = if *whole > 0.0 { tail(s) / whole } else { 0.0 };
            let slope = || s.iter().enumerate().map(|(k, c)| k as f64 * c.abs()).sum::<f64>();
            if (t > worst && (t > COARSEST || t * whole > step * slope())) || t.is_nan() {
                (worst, component) = (t, i);
            }
        }
        let allowed = (0.5 * ACCURACY).max(stretch.rounding);
        // Cutting no longer helps: what is left of the tail is rounding in the exact evaluator.
        let stays = stretch.part < 1.0 && worst < 1e-10 && worst > 0.1 * before;
        if worst <= allowed || stays {
            self.table.borders.push(stretch.b);
            self.table.coefficients.extend(series.iter().map(|s| unless_zero(s, monomials)));
            return Placed::Resolved;
        }
        if stretch.part < SHORTEST || !worst.is_finite() {
            return Placed::Unresolved(component);
        }
        Placed::Cut(worst, if (worst / allowed).powf(1.0 / ORDER) > 1.9 { 3 } else { 2 })
    }
}

/// All components on a stretch of sigma.
struct Stretch {
    a: f64,
    b: f64,
    /// Its length as a part of its panel of the grid.
    part: f64,
    series: Vec<Series>,
    largest: Vec<f64>,
    /// Rounding in the values, relative to the largest.
    rounding: f64,
    /// For each set the worst tail on the stretch that this is a piece of; not a number if it is settled.
    before: Vec<f64>,
}

/// A linear map of a series; that of nothing, such as a revolute joint's moment, costs nothing.
fn unless_zero(values: &[f64; NODES], map: impl Fn(&[f64; NODES]) -> Series) -> Series {
    if values.iter().all(|v| *v == 0.0) { [0.0; NODES] } else { map(values) }
}

/// Samples functions at the nodes of a stretch.
struct Sampler<'a> {
    transform: Transform,
    values: Vec<f64>,
    samples: Vec<[f64; NODES]>,
    exact: &'a mut dyn FnMut(f64, &mut [f64]) -> f64,
}

impl Sampler<'_> {
    fn stretch(&mut self, a: f64, b: f64) -> Stretch {
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
        Stretch { a, b, part: 1.0, series, largest, rounding, before: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dual::Dual;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn values_and_slopes_are_those_of_horner(x in -1.0..1.0f64, c in proptest::array::uniform16(-1.0..1.0f64)) {
            let value = c.iter().rev().fold(0.0, |sum, c| sum * x + c);
            let slope = c.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c * x.powi(k as i32 - 1)).sum::<f64>();
            let dual = polynomial_at(&c, Dual::<1>::variable(x, 0));
            // Sixteen terms, the largest slope times 15.
            prop_assert!((polynomial_at(&c, x) - value).abs() < 1e-14);
            prop_assert!((dual.value - value).abs() < 1e-14 && (dual.slope[0] - slope).abs() < 2e-13);
            let mut rows = Vec::new();
            side_by_side([&[1.0; NODES], &c], &mut rows);
            let mut values = [[Dual::<1>::constant(1.0); ROW]];
            side_by_side_at(&rows, Dual::<1>::variable(x, 0), &mut values);
            prop_assert!((values[0][1].value - value).abs() < 1e-14 && (values[0][1].slope[0] - slope).abs() < 2e-13);
            prop_assert_eq!(values[0][2].value, 0.0);
        }
    }

    fn grid(borders: &[f64]) -> Grid {
        Grid { borders: borders.to_vec(), centers: Vec::new() }
    }

    #[test]
    fn resolves_a_peak_to_the_stated_accuracy() {
        let f = |s: f64| 1.0 / (1e-3 + s * s);
        let table = Table::build(&grid(&[-1.0, 0.3, 2.0]), &[1.0, 1.0], &mut |s, v| {
            v.copy_from_slice(&[f(s), s.sin()]);
            1.0
        })
        .unwrap();
        for i in 0..=3000 {
            let s = -1.0 + f64::from(i) / 1000.0;
            let spot = table.spot(s);
            assert!((table.value(spot, 0) - f(s)).abs() < ACCURACY * 1e3, "{s}");
            assert!((table.value(spot, 1) - s.sin()).abs() < ACCURACY, "{s}");
        }
        assert!(table.panels() > 4);
    }

    #[test]
    fn a_jump_is_refused_and_placed() {
        let error = Table::build(&grid(&[0.0, 1.0]), &[1.0], &mut |s, v| {
            v[0] = (s - 0.7).signum();
            1.0
        })
        .unwrap_err();
        assert!((error.sigma - 0.7).abs() < 1e-3, "{error}");
    }

    #[test]
    fn noise_of_rounding_is_accepted() {
        let mut seed = 1u64;
        let mut noise = move || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut build = |size: f64, level: f64| {
            Table::build(&grid(&[0.0, 1.0]), &[1.0], &mut |s, v| {
                v[0] = size * s.cos() + level * noise();
                1.0
            })
        };
        assert!(build(1.0, 1e-12).is_ok());
        assert!(build(0.0, 1e-15).is_ok(), "nothing but rounding, of the natural size");
        assert!(build(1.0, 1e-6).is_err());
    }
}
