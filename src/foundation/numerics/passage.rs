//! First sign change of a function from <= 0 to > 0, found with bounds of the function. Two sign changes close to each
//! other are not overlooked.
//!
//! In: a function, and its bounds on intervals, or the fact that the function is a polynomial of degree 4 at most. Out:
//! its first sign change from <= 0 to > 0. Must not know: what the function means.
use super::bracket::false_position;
use super::enclosure::Enclosure;

/// Number of bisections of a part of the grid after which only its end values are used.
const DEEPEST: u32 = 24;
/// Number of intervals after which only the end values of each remaining interval are used.
const MOST_INTERVALS: u32 = 1000;

/// A function with bounds, searched on [0, 1].
pub struct Bounded<F, B, L> {
    /// The function.
    pub f: F,
    /// Its bounds between two points.
    pub bounds: B,
    /// Its root between two points with their values, <= 0 at the first and > 0 at the second.
    pub locate: L,
}

/// A point with the value of the function.
type Sample = (f64, f64);

impl<F, B, L> Bounded<F, B, L>
where
    F: FnMut(f64) -> f64,
    B: FnMut(f64, f64) -> Enclosure,
    L: FnMut(&mut dyn FnMut(f64) -> f64, Sample, Sample) -> f64,
{
    /// The first point of (0, 1] where the function changes from <= 0 to > 0. `start`: its value at 0, without rounding
    /// error. Roots are located on intervals on which the bounds show that the function rises, otherwise on the `grid`
    /// equal parts of [0, 1].
    ///
    /// An interval is excluded if the bounds have one sign or the function falls. An interval is bisected if the bounds
    /// are not sufficient. A rise with the next fall is missed only if they are closer than 2^-24 of a part (like a
    /// touch), or after [`MOST_INTERVALS`] intervals.
    pub fn first_rise(&mut self, start: f64, grid: usize) -> Option<f64> {
        let last = (1.0, (self.f)(1.0));
        self.on_grid((0, grid, grid), (0.0, start), last, &mut { MOST_INTERVALS })
    }

    /// The first rise between two points i and j of the grid.
    fn on_grid(&mut self, (i, j, grid): (usize, usize, usize), a: Sample, b: Sample, left: &mut u32) -> Option<f64> {
        let bounds = self.look(a, b, left)?;
        if j - i > 1 {
            if bounds.slope.low >= 0.0 {
                return passes(a, b).then(|| (self.locate)(&mut self.f, a, b));
            }
            let middle = usize::midpoint(i, j);
            let at = middle as f64 / grid as f64;
            let m = (at, (self.f)(at));
            return self.on_grid((i, middle, grid), a, m, left).or_else(|| self.on_grid((middle, j, grid), m, b, left));
        }
        // The function may start at a root, fall first and rise later.
        if !passes(a, b) || a.1 == 0.0 {
            return self.between(a, b, DEEPEST, left);
        }
        let root = (self.locate)(&mut self.f, a, b);
        if bounds.slope.low >= 0.0 {
            return Some(root);
        }
        // There may be three roots, and the located root need not be the first.
        let at_root = (root, (self.f)(root));
        let first = self.between(a, at_root, DEEPEST, left);
        Some(first.filter(|first| *first < root - 1e-6 * (b.0 - a.0)).unwrap_or(root))
    }

    /// The first rise between two points, with at most `depth` bisections.
    fn between(&mut self, a: Sample, b: Sample, depth: u32, left: &mut u32) -> Option<f64> {
        let bounds = self.look(a, b, left)?;
        if bounds.slope.low >= 0.0 || depth == 0 || *left == 0 {
            return passes(a, b).then(|| (self.locate)(&mut self.f, a, b));
        }
        let at = 0.5 * (a.0 + b.0);
        let m = (at, (self.f)(at));
        self.between(a, m, depth - 1, left).or_else(|| self.between(m, b, depth - 1, left))
    }

    /// Bounds between two points, unless they exclude a rise.
    fn look(&mut self, a: Sample, b: Sample, left: &mut u32) -> Option<Enclosure> {
        *left = left.saturating_sub(1);
        let bounds = (self.bounds)(a.0, b.0);
        let is_excluded = bounds.value.high <= 0.0 || bounds.value.low > 0.0 || bounds.slope.high <= 0.0;
        (!is_excluded || passes(a, b)).then_some(bounds)
    }
}

/// Whether the function is <= 0 at the first and > 0 at the second of two points.
fn passes(a: Sample, b: Sample) -> bool {
    a.1 <= 0.0 && b.1 > 0.0
}

/// Degree of a polynomial in [`first_rise_of_quartic`].
const DEGREE: usize = 4;
/// Rounding error of Bernstein coefficients, relative to the largest value.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The first point of [a, b] where a polynomial f of degree 4 at most changes from <= 0 to > 0, at most `close` after
/// its root. A value > 0 at `a` counts as 0.
///
/// Method: Bernstein coefficients from five values. An interval is excluded if all coefficients are <= 0 or descend. It
/// contains one root if they ascend and the signs at its ends differ. Otherwise the interval is divided where the
/// control polygon of the derivative crosses 0. For a parabola this is the vertex, so that the roots follow in closed
/// form, up to the refinement by false position on f itself. A rise is missed only if the values > 0 are rounding
/// errors.
///
/// # Errors
/// f has no value at one of the first five points. Elsewhere, a point without a value counts as <= 0.
pub fn first_rise_of_quartic<E>(
    mut f: impl FnMut(f64) -> Result<f64, E>,
    [a, b]: [f64; 2],
    close: f64,
) -> Result<Option<f64>, E> {
    let mut values = [0.0; DEGREE + 1];
    for (k, value) in values.iter_mut().enumerate() {
        *value = f(a + (b - a) * (k as f64 / DEGREE as f64))?;
    }
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    if values.iter().any(|v| !v.is_finite()) || largest > f64::MAX / 1e3 {
        // Such values cannot be represented by a polynomial.
        return Ok(None);
    }
    let [f0, f1, f2, f3, f4] = values;
    let second = |[f0, f1, f2, f3, f4]: [f64; 5]| (-13.0 * f0 + 48.0 * f1 - 36.0 * f2 + 16.0 * f3 - 3.0 * f4) / 12.0;
    let middle = (13.0 * (f0 + f4) - 64.0 * (f1 + f3) + 120.0 * f2) / 18.0;
    let coefficients = [f0, second(values), middle, second([f4, f3, f2, f1, f0]), f4];
    let mut quartic = Quartic { f: |t| f(t).unwrap_or(-1.0), noise: ROUNDING * largest, close, left: MOST_INTERVALS };
    Ok(quartic.part(&coefficients, (a, f0.min(0.0)), (b, f4), 0))
}

/// A polynomial of degree 4 at most.
struct Quartic<F> {
    f: F,
    /// Limit below which differences of coefficients are rounding errors.
    noise: f64,
    close: f64,
    /// Number of intervals that may still be searched.
    left: u32,
}

impl<F: FnMut(f64) -> f64> Quartic<F> {
    /// Number of divisions after which an interval is a point.
    const DEEPEST: u32 = 64;

    /// The first rise between two points with these Bernstein coefficients.
    fn part(&mut self, c: &[f64; DEGREE + 1], a: Sample, b: Sample, depth: u32) -> Option<f64> {
        let differences: [f64; DEGREE] = std::array::from_fn(|k| c[k + 1] - c[k]);
        if !passes(a, b) && c.iter().all(|c| *c <= 0.0) || differences.iter().all(|d| *d <= self.noise) && b.1 <= 0.0 {
            return None;
        }
        self.left = self.left.saturating_sub(1);
        let rises = differences.iter().all(|d| *d >= -self.noise);
        if rises || self.left == 0 || depth == Self::DEEPEST || b.0 - a.0 <= self.close {
            return passes(a, b).then(|| false_position(&mut self.f, a, b, self.close));
        }
        // Every other division is in the middle, so that the interval is halved for any polynomial.
        let part = if depth.is_multiple_of(2) { turning_point(&differences) } else { 0.5 };
        let at = a.0 + part * (b.0 - a.0);
        if !(a.0 < at && at < b.0) {
            return passes(a, b).then(|| false_position(&mut self.f, a, b, self.close));
        }
        let (left, right) = divided(c, part);
        let m = (at, (self.f)(at));
        self.part(&left, a, m, depth + 1).or_else(|| self.part(&right, m, b, depth + 1))
    }
}

/// First zero of the control polygon with these values, as a part of its interval. 1/2 without a zero.
fn turning_point(differences: &[f64; DEGREE]) -> f64 {
    let pairs = differences.windows(2).enumerate();
    let mut passing = pairs.filter(|(_, d)| d[0] * d[1] < 0.0);
    passing.next().map_or(0.5, |(k, d)| (k as f64 + d[0] / (d[0] - d[1])) / (DEGREE - 1) as f64)
}

/// Coefficients before and after a part of the interval, by de Casteljau's algorithm.
fn divided(c: &[f64; DEGREE + 1], part: f64) -> ([f64; DEGREE + 1], [f64; DEGREE + 1]) {
    let (mut left, mut right) = (*c, *c);
    for (level, left) in left.iter_mut().enumerate().skip(1) {
        for k in 0..=DEGREE - level {
            right[k] += part * (right[k + 1] - right[k]);
        }
        *left = right[0];
    }
    (left, right)
}

#[cfg(test)]
mod tests;
