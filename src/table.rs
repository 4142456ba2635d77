//! Tables: functions along the curve as polynomials on adaptive panels.
//!
//! In: an exact function of sigma. Out: the same function at the cost of one polynomial for each component. Built once,
//! read without allocation, lock or branch on the mechanism's size. It must not know what the functions mean.
use crate::chebyshev::{NODES, Series, Transform, monomials, tail};
use std::fmt;

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
pub struct Spot {
    /// Panel.
    pub panel: usize,
    /// -1 at its first sigma, 1 at its last.
    pub x: f64,
}

/// Value of a polynomial with monomial coefficients: four interleaved Horner schemes, so that they overlap.
#[inline]
pub fn polynomial(c: &Series, x: f64) -> f64 {
    let x2 = x * x;
    let x4 = x2 * x2;
    let mut sums = [c[12], c[13], c[14], c[15]];
    for block in [8, 4, 0] {
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = *sum * x4 + c[block + k];
        }
    }
    (sums[0] + x * sums[1]) + x2 * (sums[2] + x * sums[3])
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

    /// Tabulate `exact`, which fills the components at a sigma, on the panels of `grid`, cut in three where needed. Each
    /// component has its natural size in `sizes`; `exact` returns how much it amplifies rounding.
    ///
    /// Each panel is cut until its series has decayed to [`ACCURACY`], relative to the natural size of the component or to
    /// its largest value on the whole grid, or to the rounding in `exact`: second derivatives amplify it twice. Panels
    /// are cut in three, so that what is in the middle of one stays in the middle of one.
    ///
    /// # Errors
    /// [`Unresolved`] where cutting does not help.
    pub fn build(
        grid: &[f64],
        sizes: &[f64],
        exact: &mut dyn FnMut(f64, &mut [f64]) -> f64,
    ) -> Result<Self, Unresolved> {
        const DEEPEST: usize = 9;
        let components = sizes.len();
        let mut whole = sizes.to_vec();
        let transform = Transform::new();
        let mut values = vec![0.0; components];
        let mut fit = |a: f64, b: f64| -> (Vec<Series>, Vec<f64>, f64) {
            let mut samples = vec![[0.0; NODES]; components];
            let mut rounding: f64 = 1.0;
            for (j, x) in transform.nodes.iter().enumerate() {
                rounding = rounding.max(exact(a + 0.5 * (b - a) * (1.0 + x), &mut values));
                for (sample, value) in samples.iter_mut().zip(&values) {
                    sample[j] = *value;
                }
            }
            let largest = samples.iter().map(|s| s.iter().fold(0.0, |a: f64, v| a.max(v.abs()))).collect();
            (
                samples.iter().map(|s| transform.fit(s)).collect(),
                largest,
                (f64::EPSILON * rounding * rounding).min(10.0 * ACCURACY),
            )
        };
        let mut first = Vec::new();
        for pair in grid.windows(2) {
            let (series, largest, rounding) = fit(pair[0], pair[1]);
            for (w, l) in whole.iter_mut().zip(&largest) {
                *w = w.max(*l);
            }
            first.push((pair[0], pair[1], series, rounding));
        }
        // What must still be placed, last panel first; each with its depth and its parent's worst tail.
        let mut open: Vec<_> = first.into_iter().rev().map(|(a, b, s, r)| (a, b, s, r, 0, f64::INFINITY)).collect();
        let mut table = Self { borders: vec![grid[0]], components, coefficients: Vec::new() };
        while let Some((a, b, series, rounding, depth, before)) = open.pop() {
            let (mut worst, mut component) = (0.0, 0);
            for (i, s) in series.iter().enumerate() {
                let t = if whole[i] > 0.0 { tail(s) / whole[i] } else { 0.0 };
                if t > worst || t.is_nan() {
                    (worst, component) = (t, i);
                }
            }
            // Cutting no longer helps: what is left of the tail is rounding in the exact evaluator.
            let stays = depth > 0 && worst < 1e-10 && worst > 0.1 * before;
            if worst <= (0.5 * ACCURACY).max(rounding) || stays {
                table.borders.push(b);
                table.coefficients.extend(series.iter().map(monomials));
                continue;
            }
            if depth == DEEPEST || !worst.is_finite() {
                return Err(Unresolved { sigma: 0.5 * (a + b), component });
            }
            let cuts = [a, a + (b - a) / 3.0, b - (b - a) / 3.0, b];
            for k in [2, 1, 0] {
                let (series, _, rounding) = fit(cuts[k], cuts[k + 1]);
                open.push((cuts[k], cuts[k + 1], series, rounding, depth + 1, worst));
            }
        }
        Ok(table)
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

    /// The place of sigma.
    pub fn spot(&self, sigma: f64) -> Spot {
        let panel = self.panel(sigma);
        let (a, b) = self.borders(panel);
        Spot { panel, x: (2.0 * sigma - (a + b)) / (b - a) }
    }

    /// Monomial coefficients of one component on one panel.
    pub fn series(&self, panel: usize, component: usize) -> &Series {
        &self.coefficients[panel * self.components + component]
    }

    /// Monomial coefficients of some components on one panel.
    pub fn block(&self, panel: usize, components: std::ops::Range<usize>) -> &[Series] {
        let first = panel * self.components;
        &self.coefficients[first + components.start..first + components.end]
    }

    /// Value of a component at a place.
    pub fn value(&self, spot: Spot, component: usize) -> f64 {
        polynomial(self.series(spot.panel, component), spot.x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolves_a_peak_to_the_stated_accuracy() {
        let f = |s: f64| 1.0 / (1e-3 + s * s);
        let table = Table::build(&[-1.0, 0.3, 2.0], &[1.0, 1.0], &mut |s, v| {
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
        let error = Table::build(&[0.0, 1.0], &[1.0], &mut |s, v| {
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
            Table::build(&[0.0, 1.0], &[1.0], &mut |s, v| {
                v[0] = size * s.cos() + level * noise();
                1.0
            })
        };
        assert!(build(1.0, 1e-12).is_ok());
        assert!(build(0.0, 1e-15).is_ok(), "nothing but rounding, of the natural size");
        assert!(build(1.0, 1e-6).is_err());
    }
}
