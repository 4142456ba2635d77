//! Smooth monotone interpolation of a table of points.
//!
//! In: points of a function. Out: the function between and beyond them, its slope and its integral. It must not know
//! what the function means.
//!
//! Between two points the function is a quintic; its value, slope and curvature are continuous. It is monotone wherever
//! the points are: the slope of a quintic is a quartic whose Bernstein coefficients are
//!
//! ```text
//! b0 = y0', b1 = y0' + h y0'' / 4, b2 = 5 s - b0 - b1 - b3 - b4, b3 = y1' - h y1'' / 4, b4 = y1'
//! ```
//!
//! with the width h of the interval and its secant s, and a polynomial whose Bernstein coefficients have one sign has that
//! sign (Dougherty, Edelman, Hyman, Math. Comp. 52 (1989), 471). Beyond the first and the last point the function is
//! linear, with the slope and the curvature 0 that it has there.
use super::chebyshev::NODES;
use super::enclosure::{Interval, polynomial_bounds};

/// Largest slope at a point over the smaller secant beside it: with curvature 0 all five coefficients then have one sign.
const STEEPEST: f64 = 1.25;
/// Number of coefficients of a quintic.
const QUINTIC: usize = 6;

/// A twice continuously differentiable function through points, monotone wherever the points are.
#[derive(Clone, Debug, PartialEq)]
pub struct Monotone {
    /// Abscissae of the points, ascending.
    knots: Vec<f64>,
    pieces: Vec<Piece>,
    /// Values and slopes at the first and the last point.
    ends: [[f64; 2]; 2],
    /// Integral from the first point to the last.
    whole: f64,
}

/// The function between two points: a quintic in t = (x - start) / width.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    start: f64,
    width: f64,
    coefficients: [f64; QUINTIC],
    /// Integral from the first point to `start`.
    integral: f64,
}

impl Piece {
    /// Value, slope, curvature, and integral from the first point on, at x.
    fn at(&self, x: f64) -> [f64; 4] {
        let t = (x - self.start) / self.width;
        let (mut value, mut slope, mut half_curvature, mut integral) = (0.0, 0.0, 0.0, 0.0);
        for (k, c) in self.coefficients.iter().enumerate().rev() {
            half_curvature = half_curvature * t + slope;
            slope = slope * t + value;
            value = value * t + c;
            integral = integral * t + c / (k + 1) as f64;
        }
        let curvature = 2.0 * half_curvature / self.width.powi(2);
        [value, slope / self.width, curvature, self.integral + self.width * t * integral]
    }

    /// Bounds of the values and of the slopes between two x.
    fn bounds(&self, from: f64, to: f64) -> [Interval; 2] {
        let mut series = [0.0; NODES];
        series[..QUINTIC].copy_from_slice(&self.coefficients);
        let [low, high] = [from, to].map(|x| (x - self.start) / self.width);
        let [value, slope] = polynomial_bounds(&series, Interval { low, high });
        [value, slope * Interval::point(1.0 / self.width)]
    }

    /// Third derivative at x.
    fn third(&self, x: f64) -> f64 {
        let t = (x - self.start) / self.width;
        let [_, _, _, c3, c4, c5] = self.coefficients;
        (6.0 * c3 + t * (24.0 * c4 + t * 60.0 * c5)) / self.width.powi(3)
    }
}

impl Monotone {
    /// The function through at least two points [x, y] whose x ascend; None for other points.
    pub fn new(points: &[[f64; 2]]) -> Option<Self> {
        let secants: Vec<f64> = points.windows(2).map(|p| (p[1][1] - p[0][1]) / (p[1][0] - p[0][0])).collect();
        let is_ascending = points.windows(2).all(|p| p[0][0] < p[1][0]);
        if secants.is_empty() || !is_ascending || secants.iter().any(|s| !s.is_finite()) {
            return None;
        }
        let widths: Vec<f64> = points.windows(2).map(|p| p[1][0] - p[0][0]).collect();
        let slopes: Vec<f64> = (0..points.len()).map(|k| slope(&widths, &secants, k)).collect();
        let curvatures: Vec<f64> = (0..points.len()).map(|k| curvature(&widths, &secants, &slopes, k)).collect();
        let mut integral = 0.0;
        let mut pieces = Vec::with_capacity(secants.len());
        for (k, &width) in widths.iter().enumerate() {
            let change = points[k + 1][1] - points[k][1];
            let [s0, s1] = [slopes[k] * width, slopes[k + 1] * width];
            let [c0, c1] = [curvatures[k], curvatures[k + 1]].map(|c| c * width * width);
            let coefficients = [
                points[k][1],
                s0,
                0.5 * c0,
                10.0 * change - 6.0 * s0 - 4.0 * s1 - 1.5 * c0 + 0.5 * c1,
                -15.0 * change + 8.0 * s0 + 7.0 * s1 + 1.5 * c0 - c1,
                6.0 * change - 3.0 * (s0 + s1) + 0.5 * (c1 - c0),
            ];
            let piece = Piece { start: points[k][0], width, coefficients, integral };
            integral = piece.at(points[k + 1][0])[3];
            pieces.push(piece);
        }
        let last = points.len() - 1;
        let ends = [[points[0][1], slopes[0]], [points[last][1], slopes[last]]];
        Some(Self { knots: points.iter().map(|p| p[0]).collect(), pieces, ends, whole: integral })
    }

    /// Value, slope, curvature, and integral from the first point on, at x.
    fn parts(&self, x: f64) -> [f64; 4] {
        let beyond = |[value, slope]: [f64; 2], distance: f64, integral: f64| {
            [value + slope * distance, slope, 0.0, integral + distance * (value + 0.5 * slope * distance)]
        };
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        if x <= first {
            return beyond(self.ends[0], x - first, 0.0);
        }
        if x >= last {
            return beyond(self.ends[1], x - last, self.whole);
        }
        self.piece(x).at(x)
    }

    /// The piece that holds x; of NaN the first one, which gives NaN.
    fn piece(&self, x: f64) -> &Piece {
        &self.pieces[self.knots.partition_point(|knot| *knot <= x).saturating_sub(1)]
    }

    /// Value, slope and curvature at x.
    pub fn at(&self, x: f64) -> [f64; 3] {
        let [value, slope, curvature, _] = self.parts(x);
        [value, slope, curvature]
    }

    /// Third derivative at x; at a point that beyond it.
    pub fn third(&self, x: f64) -> f64 {
        if x < self.knots[0] || x >= self.knots[self.knots.len() - 1] {
            return 0.0;
        }
        self.piece(x).third(x)
    }

    /// Integral from the first point to x.
    pub fn integral(&self, x: f64) -> f64 {
        self.parts(x)[3]
    }

    /// Bounds of the values and of the slopes on an interval of x.
    pub fn bounds(&self, x: Interval) -> [Interval; 2] {
        let last = self.knots.len() - 1;
        // Between two abscissae the function is one polynomial; the first and the last one are the lines beyond the ends.
        let first = self.knots.partition_point(|knot| *knot <= x.low);
        let mut all: Option<[Interval; 2]> = None;
        for part in first..=last + 1 {
            let from = if part == 0 { x.low } else { x.low.max(self.knots[part - 1]) };
            let to = if part > last { x.high } else { x.high.min(self.knots[part]) };
            let here = match part.checked_sub(1).and_then(|piece| self.pieces.get(piece)) {
                Some(piece) => piece.bounds(from, to),
                None => {
                    let ends = [from, to].map(|x| self.at(x));
                    [0, 1].map(|order| Interval::of(ends.map(|end| end[order])))
                }
            };
            all = Some(all.map_or(here, |all| [0, 1].map(|order| all[order].hull(here[order]))));
            if part > last || x.high <= self.knots[part] {
                break;
            }
        }
        all.unwrap_or([Interval::around(0.0, f64::MAX); 2])
    }

    /// Values and slopes at the first and the last point.
    pub fn ends(&self) -> [[f64; 2]; 2] {
        self.ends
    }

    /// Abscissae of the points, ascending.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Largest size of the values at the points.
    pub fn largest(&self) -> f64 {
        let values = self.pieces.iter().map(|piece| piece.coefficients[0]);
        values.chain([self.ends[1][0]]).fold(0.0, |most, value| most.max(value.abs()))
    }
}

/// Slope at point k: that of the parabola through the point and its neighbours, or 0 at an extreme, and never steeper
/// than [`STEEPEST`] allows.
fn slope(widths: &[f64], secants: &[f64], k: usize) -> f64 {
    let last = secants.len();
    let (estimate, beside) = match k {
        _ if last == 1 => (secants[0], [secants[0]; 2]),
        0 => (end_slope([widths[0], widths[1]], [secants[0], secants[1]]), [secants[0]; 2]),
        _ if k == last => {
            let of = |all: &[f64]| [all[last - 1], all[last - 2]];
            (end_slope(of(widths), of(secants)), [secants[last - 1]; 2])
        }
        _ => {
            let ([h0, h1], s) = ([widths[k - 1], widths[k]], [secants[k - 1], secants[k]]);
            ((s[0] * h1 + s[1] * h0) / (h0 + h1), s)
        }
    };
    let sign = beside[0].signum();
    if beside[0] * beside[1] <= 0.0 || estimate * sign <= 0.0 {
        return 0.0;
    }
    sign * (estimate * sign).min(STEEPEST * beside[0].abs().min(beside[1].abs()))
}

/// Slope at an end: that of the parabola through the three points nearest to it. Nearest widths and secants first.
fn end_slope([h0, h1]: [f64; 2], [s0, s1]: [f64; 2]) -> f64 {
    s0 + (s0 - s1) * h0 / (h0 + h1)
}

/// Curvature at point k: the second divided difference, as far as both quintics beside the point stay monotone; 0 at the
/// ends.
fn curvature(widths: &[f64], secants: &[f64], slopes: &[f64], k: usize) -> f64 {
    if k == 0 || k == secants.len() {
        return 0.0;
    }
    let [h0, h1] = [widths[k - 1], widths[k]];
    let sign = slopes[k].signum();
    let steepness = slopes[k].abs();
    // Part of b2 that is left for the curvatures at the two ends of an interval, half for each.
    let left = |interval: usize| {
        let both = slopes[interval].abs() + slopes[interval + 1].abs();
        (0.5 * (5.0 * secants[interval].abs() - 2.0 * both)).max(0.0)
    };
    let low = (-4.0 * steepness / h1).max(-4.0 * left(k - 1) / h0);
    let high = (4.0 * steepness / h0).min(4.0 * left(k) / h1);
    let wanted = 2.0 * (secants[k] - secants[k - 1]) / (h0 + h1);
    sign * (wanted * sign).clamp(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ascending(steps: &[(f64, f64)]) -> Vec<[f64; 2]> {
        let mut at = [0.3, -1.0];
        steps
            .iter()
            .map(|(dx, dy)| {
                at = [at[0] + dx, at[1] + dy];
                at
            })
            .collect()
    }

    #[test]
    fn a_line_stays_a_line_between_and_beyond_the_points() {
        let line = Monotone::new(&[[0.0, 1.0], [0.5, 2.0], [2.0, 5.0]]).unwrap();
        for x in [-3.0, 0.1, 0.5, 1.7, 2.0, 9.0] {
            assert!((line.at(x)[0] - (1.0 + 2.0 * x)).abs() < 1e-13, "{x}");
            assert!((line.at(x)[1] - 2.0).abs() < 1e-13, "{x}");
            assert!((line.integral(x) - (x + x * x)).abs() < 1e-12, "{x}");
        }
    }

    #[test]
    fn points_that_no_function_has_are_refused() {
        for points in
            [&[[0.0, 1.0]][..], &[[0.0, 1.0], [0.0, 2.0]], &[[1.0, 0.0], [0.0, 1.0]], &[[0.0, f64::NAN], [1.0, 0.0]]]
        {
            assert_eq!(Monotone::new(points), None);
        }
    }

    #[test]
    fn a_smooth_function_is_met_to_the_third_order() {
        let error = |count: i32| {
            let points: Vec<_> = (0..=count).map(|k| f64::from(k) / f64::from(count)).map(|x| [x, x.exp()]).collect();
            let f = Monotone::new(&points).unwrap();
            // The quintics at the ends have curvature 0 there.
            (0..1000).map(|k| 0.2 + 0.6e-3 * f64::from(k)).fold(0.0_f64, |e, x| e.max((f.at(x)[0] - x.exp()).abs()))
        };
        let [coarse, fine] = [error(20), error(40)];
        assert!(fine < 1e-6 && coarse / fine > 7.0, "{coarse:e} {fine:e}");
    }

    proptest! {
        #[test]
        fn it_is_monotone_smooth_and_has_its_integral(
            steps in prop::collection::vec((0.01..2.0, prop_oneof![Just(0.0), 1e-3..5.0]), 2..9),
            falls: bool,
        ) {
            let mut points = ascending(&steps);
            if falls {
                points.iter_mut().for_each(|p| p[1] = -p[1]);
            }
            let sign = if falls { -1.0 } else { 1.0 };
            let f = Monotone::new(&points).unwrap();
            let (first, last) = (points[0][0] - 0.5, points[points.len() - 1][0] + 0.5);
            let size = f.largest().max(1.0);
            for [x, y] in &points {
                prop_assert!((f.at(*x)[0] - y).abs() <= 1e-13 * size);
                let around = [x - 1e-9, x + 1e-9];
                let slopes = around.map(|x| f.at(x)[1]);
                prop_assert!((slopes[1] - slopes[0]).abs() <= 1e-4 * slopes[0].abs().max(1.0), "{slopes:?}");
            }
            let mut sum = 0.0;
            let count = 4000;
            let h = (last - first) / f64::from(count);
            for k in 0..count {
                let x = first + (f64::from(k) + 0.5) * h;
                let [value, slope, _] = f.at(x);
                prop_assert!(slope * sign >= -1e-11 * size, "slope {slope} at {x}");
                sum += h * value;
            }
            let integral = f.integral(last) - f.integral(first);
            prop_assert!((integral - sum).abs() < 2e-4 * size * (last - first), "{integral} {sum}");
        }

        #[test]
        fn nothing_is_beyond_the_bounds_and_they_close_in(
            steps in prop::collection::vec((0.1..2.0, -5.0..5.0), 2..9),
            low in -2.0..12.0f64,
            width in 0.0..6.0f64,
            part in 0.0..=1.0f64,
        ) {
            let f = Monotone::new(&ascending(&steps)).unwrap();
            let size = f.largest().max(1.0);
            for width in [width, 1e-6 * width] {
                let bounds = f.bounds(Interval { low, high: low + width });
                let at = f.at(low + part * width);
                for (bounds, value) in bounds.iter().zip(at) {
                    prop_assert!(bounds.low - 1e-9 * size <= value && value <= bounds.high + 1e-9 * size, "{bounds:?} {at:?}");
                }
                if width < 1e-5 {
                    prop_assert!(bounds[1].high - bounds[1].low < 1e-2 * size, "{bounds:?}");
                }
            }
        }

        #[test]
        fn curvature_is_continuous(steps in prop::collection::vec((0.1..2.0, -5.0..5.0), 3..9)) {
            let points = ascending(&steps);
            let f = Monotone::new(&points).unwrap();
            for pair in f.pieces.windows(2) {
                let border = pair[1].start;
                let [before, after] = [0, 1].map(|side: usize| pair[side].at(border));
                for order in 0..3 {
                    let size = before[order].abs().max(1e3);
                    prop_assert!((before[order] - after[order]).abs() < 1e-9 * size, "{before:?} {after:?}");
                }
                let h = 1e-5 * pair[0].width;
                let by_slopes = (f.at(border + h)[1] - f.at(border - h)[1]) / (2.0 * h);
                prop_assert!((by_slopes - after[2]).abs() < 1e-2 * after[2].abs().max(1e2), "{by_slopes} {after:?}");
            }
        }
    }
}
