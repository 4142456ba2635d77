//! Twice continuously differentiable functions made of quintics.
//!
//! In: points with slopes and curvatures. Out: the function between and beyond them, its derivatives, its integral and
//! bounds. Must not know: what the function means, how slopes and curvatures are chosen (`numerics/monotone.rs`,
//! `numerics/spline.rs`).
//!
//! Beyond the first and the last point the function is linear, with the slope at this point.
use super::chebyshev::NODES;
use super::enclosure::{Interval, polynomial_bounds};

/// Number of coefficients of a quintic.
const QUINTIC: usize = 6;

/// A function through points, with one quintic between neighbouring points. Value, slope and curvature are continuous
/// if the curvature at both ends is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise {
    /// Abscissae of the points, ascending.
    knots: Vec<f64>,
    pieces: Vec<Piece>,
    /// Values and slopes at the first and the last point.
    ends: [[f64; 2]; 2],
    /// Integral from the first point to the last.
    whole: f64,
}

/// Widths and secants between the points [x, y] of a function. None for fewer than two points, for x that are not
/// ascending and for numbers that are not finite.
pub fn secants(points: &[[f64; 2]]) -> Option<[Vec<f64>; 2]> {
    let is_ascending = points.windows(2).all(|p| p[0][0] < p[1][0]);
    let widths: Vec<f64> = points.windows(2).map(|p| p[1][0] - p[0][0]).collect();
    let secants: Vec<f64> = points.windows(2).map(|p| (p[1][1] - p[0][1]) / (p[1][0] - p[0][0])).collect();
    (!secants.is_empty() && is_ascending && secants.iter().all(|s| s.is_finite())).then_some([widths, secants])
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
    /// At x: value, slope, curvature, and the integral from the first point.
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

impl Piecewise {
    /// The function through at least two points [x, y] with ascending x. `hermite`: slope and curvature at each point.
    pub fn new(points: &[[f64; 2]], hermite: &[[f64; 2]]) -> Self {
        let mut integral = 0.0;
        let mut pieces = Vec::with_capacity(points.len());
        for (pair, data) in points.windows(2).zip(hermite.windows(2)) {
            let (width, change) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
            let [[s0, c0], [s1, c1]] = [0, 1].map(|k| [data[k][0] * width, data[k][1] * width * width]);
            let coefficients = [
                pair[0][1],
                s0,
                0.5 * c0,
                10.0 * change - 6.0 * s0 - 4.0 * s1 - 1.5 * c0 + 0.5 * c1,
                -15.0 * change + 8.0 * s0 + 7.0 * s1 + 1.5 * c0 - c1,
                6.0 * change - 3.0 * (s0 + s1) + 0.5 * (c1 - c0),
            ];
            let piece = Piece { start: pair[0][0], width, coefficients, integral };
            integral = piece.at(pair[1][0])[3];
            pieces.push(piece);
        }
        let last = points.len() - 1;
        let ends = [0, last].map(|k| [points[k][1], hermite[k][0]]);
        Self { knots: points.iter().map(|p| p[0]).collect(), pieces, ends, whole: integral }
    }

    /// At x: value, slope, curvature, and the integral from the first point.
    fn parts(&self, x: f64) -> [f64; 4] {
        let beyond = |[value, slope]: [f64; 2], distance: f64, integral: f64| {
            [value + slope * distance, slope, 0.0, integral + distance * (value + 0.5 * slope * distance)]
        };
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        if x < first {
            return beyond(self.ends[0], x - first, 0.0);
        }
        if x >= last {
            return beyond(self.ends[1], x - last, self.whole);
        }
        self.piece(x).at(x)
    }

    /// The piece that contains x. For NaN the first piece, whose value is then NaN.
    fn piece(&self, x: f64) -> &Piece {
        &self.pieces[self.knots.partition_point(|knot| *knot <= x).saturating_sub(1)]
    }

    /// Value, slope and curvature at x.
    pub fn at(&self, x: f64) -> [f64; 3] {
        let [value, slope, curvature, _] = self.parts(x);
        [value, slope, curvature]
    }

    /// Third derivative at x. At a knot, the right-hand limit.
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
        // Between two knots the function is one polynomial. The first and the last part are the lines beyond the ends.
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

    /// Knots at which the function stops to rise or to fall, and their neighbours.
    pub fn turning_knots(&self) -> Vec<f64> {
        let values: Vec<f64> = self.pieces.iter().map(|piece| piece.coefficients[0]).chain([self.ends[1][0]]).collect();
        let ways: Vec<f64> =
            values.windows(2).map(|pair| (pair[1] - pair[0]).signum() * f64::from(pair[1] != pair[0])).collect();
        let turns = |k: usize| k > 0 && k < ways.len() && ways[k - 1] != ways[k];
        let is_near = |k: usize| turns(k) || turns(k + 1) || k.checked_sub(1).is_some_and(turns);
        (0..self.knots.len()).filter(|&k| is_near(k)).map(|k| self.knots[k]).collect()
    }

    /// Largest magnitude of the values at the points.
    pub fn largest(&self) -> f64 {
        let values = self.pieces.iter().map(|piece| piece.coefficients[0]);
        values.chain([self.ends[1][0]]).fold(0.0, |most, value| most.max(value.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_has_the_given_slopes_and_curvatures(
            steps in prop::collection::vec([0.1..2.0, -5.0..5.0, -5.0..5.0, -9.0..9.0], 2..9),
        ) {
            let mut x = 0.3;
            let points: Vec<_> = steps.iter().map(|step| { x += step[0]; [x, step[1]] }).collect();
            let hermite: Vec<_> = steps.iter().map(|step| [step[2], step[3]]).collect();
            let f = Piecewise::new(&points, &hermite);
            for (k, piece) in f.pieces.iter().enumerate() {
                for end in [k, k + 1] {
                    let at = piece.at(points[end][0]);
                    let wanted = [points[end][1], hermite[end][0], hermite[end][1]];
                    for (at, wanted) in at.iter().zip(wanted) {
                        prop_assert!((at - wanted).abs() < 1e-9 * (1.0 + piece.width.powi(-2)), "{at} {wanted}");
                    }
                }
            }
        }
    }
}
