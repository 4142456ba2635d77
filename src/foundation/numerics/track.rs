//! Curves of the plane by the length along them: arcs, and smooth curves through points.
//!
//! In: an arc, or points. Out: position, unit tangent and curvature vector at a length s from the start; the length
//! nearest to a point. It must not know what moves along the curve.
//!
//! A curve through points is a quintic spline in each coordinate over the length u of the polygon through the points.
//! The length s(u) is the integral of |dc/du| by Gauss's quadrature on cells that are short enough for rounding, and
//! u(s) follows by Newton's method. With t the tangent,
//!
//! ```text
//! dc/ds = c' / |c'| = t,   d2c/ds2 = (c'' - t (t . c'')) / |c'|^2
//! ```
//!
//! Beyond the first and the last point the curve continues as a straight line; an arc continues as a circle.
use super::legendre;
use super::piecewise::Piecewise;
use super::plane::{Vec2, perp};
use super::spline::spline;
use std::f64::consts::TAU;

/// Nodes of the quadrature on a cell.
const NODES: usize = 10;
/// Difference of two quadratures of a cell that is rounding, relative to the length of the polygon.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Halvings of a piece into cells, at most.
const HALVINGS: usize = 12;
/// Least speed |dc/du| of a curve that does not double back.
const SLOWEST: f64 = 0.05;

/// A curve of the plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Track {
    /// An arc around the origin, anticlockwise for growing lengths.
    Arc {
        /// Radius [m].
        radius: f64,
        /// Direction from the centre to the start [rad].
        from: f64,
        /// Angle over which the arc extends [rad], > 0.
        angle: f64,
    },
    /// A smooth curve through points.
    Spline(Box<Path>),
}

/// A smooth curve through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    x: Piecewise,
    y: Piecewise,
    /// Nodes and weights of the quadrature on [0, 1].
    rule: Vec<[f64; 2]>,
    /// Borders of the cells: the length of the polygon there, and the length of the curve.
    cells: Vec<[f64; 2]>,
    /// Lengths of the curve at the points.
    knots: Vec<f64>,
}

impl Track {
    /// The curve through at least two points, each other than the one before; None for other points, and where the
    /// curve would double back.
    pub fn through(points: &[[f64; 2]]) -> Option<Self> {
        Path::through(points).map(|path| Self::Spline(Box::new(path)))
    }

    /// Length of the curve [m].
    pub fn length(&self) -> f64 {
        match self {
            Self::Arc { radius, angle, .. } => radius * angle,
            Self::Spline(path) => path.length(),
        }
    }

    /// Whether the end is the start, so that the curve has no ends.
    pub fn is_ring(&self) -> bool {
        matches!(self, Self::Arc { angle, .. } if *angle >= TAU)
    }

    /// Position [m], unit tangent and curvature vector [1/m] at a length from the start.
    pub fn at(&self, s: f64) -> [Vec2; 3] {
        match self {
            Self::Arc { radius, from, .. } => {
                let (sin, cos) = (from + s / radius).sin_cos();
                let out = Vec2::new(cos, sin);
                [*radius * out, perp(out), -out / *radius]
            }
            Self::Spline(path) => path.at(s),
        }
    }

    /// Lengths at which the curve is not analytic, ascending.
    pub fn knots(&self) -> &[f64] {
        match self {
            Self::Arc { .. } => &[],
            Self::Spline(path) => &path.knots,
        }
    }

    /// Distance from a length to the next knot beyond `close`, in the direction of growing lengths or against it;
    /// infinite if there is none.
    pub fn next_knot(&self, s: f64, ascending: bool, close: f64) -> f64 {
        let knots = self.knots();
        let next = match ascending {
            true => knots.get(knots.partition_point(|knot| *knot <= s + close)).map(|knot| knot - s),
            false => knots[..knots.partition_point(|knot| *knot < s - close)].last().map(|knot| s - knot),
        };
        next.unwrap_or(f64::INFINITY)
    }

    /// The length within the curve that is nearest to a point, roughly, and its distance from the point [m].
    pub fn nearest(&self, point: Vec2) -> [f64; 2] {
        /// Number of lengths that are tried, and steps of Newton's method from the best one.
        const TRIED: usize = 200;
        const STEPS: usize = 8;
        let length = self.length();
        if let Self::Arc { radius, from, angle } = *self {
            let turn = (point.y.atan2(point.x) - from).rem_euclid(TAU);
            // Beyond the end, the nearer one of the two ends.
            let turn = if turn <= angle {
                turn
            } else if turn - angle < TAU - turn {
                angle
            } else {
                0.0
            };
            let s = radius * turn;
            return [s, (self.at(s)[0] - point).norm()];
        }
        let away = |s: f64| (self.at(s)[0] - point).norm();
        let tried = (0..=TRIED).map(|k| length * k as f64 / TRIED as f64);
        let mut best = tried.fold([0.0, f64::INFINITY], |best, s| {
            let distance = away(s);
            if distance < best[1] { [s, distance] } else { best }
        });
        for _ in 0..STEPS {
            let [at, tangent, bend] = self.at(best[0]);
            let gap = point - at;
            let s = (best[0] + tangent.dot(&gap) / (1.0 - bend.dot(&gap)).max(0.1)).clamp(0.0, length);
            let distance = away(s);
            if distance.is_nan() || distance >= best[1] {
                break;
            }
            best = [s, distance];
        }
        best
    }
}

impl Path {
    fn through(points: &[[f64; 2]]) -> Option<Self> {
        let mut u = 0.0;
        let mut along = vec![0.0];
        for pair in points.windows(2) {
            let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            u += step;
            if step.is_nan() || step <= 0.0 {
                return None;
            }
            along.push(u);
        }
        let of = |axis: usize| {
            let all: Vec<[f64; 2]> = along.iter().zip(points).map(|(u, point)| [*u, point[axis]]).collect();
            spline(&all)
        };
        let rule = legendre::rule(NODES).into_iter().map(|[x, weight]| [0.5 * (1.0 + x), 0.5 * weight]).collect();
        let mut path = Self { x: of(0)?, y: of(1)?, rule, cells: vec![[0.0; 2]], knots: vec![0.0] };
        for pair in along.windows(2) {
            path.add_cells(pair[0], pair[1], u, HALVINGS)?;
            path.knots.push(path.length());
        }
        Some(path)
    }

    /// Add the cells from one length of the polygon to another one.
    fn add_cells(&mut self, from: f64, to: f64, whole: f64, halvings: usize) -> Option<()> {
        let middle = 0.5 * (from + to);
        let halves = self.measure(from, middle) + self.measure(middle, to);
        let is_fine = (halves - self.measure(from, to)).abs() <= ROUNDING * whole;
        if !is_fine && halvings > 0 {
            self.add_cells(from, middle, whole, halvings - 1)?;
            return self.add_cells(middle, to, whole, halvings - 1);
        }
        let slowest = self.rule.iter().map(|[x, _]| self.speed(from + x * (to - from))).fold(f64::INFINITY, f64::min);
        if slowest.is_nan() || slowest < SLOWEST {
            return None;
        }
        self.cells.push([to, self.length() + halves]);
        Some(())
    }

    fn length(&self) -> f64 {
        self.cells[self.cells.len() - 1][1]
    }

    /// c, c' and c'' at a length of the polygon.
    fn parts(&self, u: f64) -> [Vec2; 3] {
        let (x, y) = (self.x.at(u), self.y.at(u));
        [0, 1, 2].map(|order| Vec2::new(x[order], y[order]))
    }

    fn speed(&self, u: f64) -> f64 {
        self.parts(u)[1].norm()
    }

    /// Length of the curve between two lengths of the polygon, by one quadrature.
    fn measure(&self, from: f64, to: f64) -> f64 {
        let width = to - from;
        width * self.rule.iter().map(|[x, weight]| weight * self.speed(from + x * width)).sum::<f64>()
    }

    /// Length of the polygon at a length of the curve.
    fn parameter(&self, s: f64) -> f64 {
        const STEPS: usize = 30;
        let last = self.cells.len() - 1;
        // Beyond an end the curve is a straight line with the speed at the end.
        let [cell, next] = match self.cells.partition_point(|cell| cell[1] <= s) {
            0 => return s / self.speed(0.0),
            k if k > last => return self.cells[last][0] + (s - self.cells[last][1]) / self.speed(self.cells[last][0]),
            k => [self.cells[k - 1], self.cells[k]],
        };
        let mut u = cell[0] + (next[0] - cell[0]) * (s - cell[1]) / (next[1] - cell[1]);
        for _ in 0..STEPS {
            let step = (s - cell[1] - self.measure(cell[0], u)) / self.speed(u);
            u += step;
            if step.is_nan() || step.abs() <= 2.0 * f64::EPSILON * next[0] {
                break;
            }
        }
        u
    }

    fn at(&self, s: f64) -> [Vec2; 3] {
        let [at, rate, second] = self.parts(self.parameter(s));
        let square = rate.norm_squared();
        let tangent = rate / square.sqrt();
        [at, tangent, (second - tangent.dot(&second) * tangent) / square]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::plane::turned;

    /// Points of a circle of radius 2.
    fn circle(count: usize, angle: f64) -> Vec<[f64; 2]> {
        let point = |k: usize| turned(Vec2::new(2.0, 0.0), angle * k as f64 / (count - 1) as f64);
        (0..count).map(|k| point(k).into()).collect()
    }

    #[test]
    fn tangent_and_curvature_are_the_derivatives_along_the_length() {
        let points = [[0.0, 0.0], [0.1, 0.7], [0.6, 1.1], [1.4, 1.0], [2.0, 1.6]];
        let spline = Track::through(&points).unwrap();
        let arc = Track::Arc { radius: 0.7, from: 0.4, angle: 2.0 };
        let h = 1e-4;
        for track in [&spline, &arc] {
            for k in -5..45 {
                let s = track.length() * f64::from(k) / 40.0 + 0.003;
                let [before, after] = [-h, h].map(|h| track.at(s + h));
                let [at, tangent, bend] = track.at(s);
                assert!((tangent.norm() - 1.0).abs() < 1e-14 && tangent.dot(&bend).abs() < 1e-12, "{s}");
                assert!(((after[0] - before[0]) / (2.0 * h) - tangent).norm() < 1e-6, "{s}");
                assert!(((after[1] - before[1]) / (2.0 * h) - bend).norm() < 1e-5, "{s}");
                // The chord falls short of the length by bend^2 h^3 / 3.
                let short = 2.0 * h - (after[0] - before[0]).norm();
                assert!((short - bend.norm_squared() * h.powi(3) / 3.0).abs() < 1e-14, "{s}: {short:e}");
                let [nearest, distance] = track.nearest(at);
                if (0.0..=track.length()).contains(&s) {
                    assert!((nearest - s).abs() < 1e-6 && distance < 1e-6, "{s} {nearest} {distance}");
                }
            }
        }
        // It holds its points, which are its knots.
        for (knot, point) in spline.knots().iter().zip(points) {
            assert!((spline.at(*knot)[0] - Vec2::from(point)).norm() < 1e-14, "{knot}");
        }
        assert_eq!((spline.knots()[0], *spline.knots().last().unwrap()), (0.0, spline.length()));
        assert_eq!(spline.next_knot(0.0, true, 1e-9), spline.knots()[1]);
        assert!((spline.next_knot(spline.length() + 1.0, false, 1e-9) - 1.0).abs() < 1e-14);
        assert_eq!(arc.next_knot(0.0, true, 1e-9), f64::INFINITY);
    }

    #[test]
    fn a_spline_through_a_circle_tends_to_it() {
        let mut last: f64 = 1e-3;
        for count in [9, 17, 33] {
            let track = Track::through(&circle(count, 1.5)).unwrap();
            // Away from the ends, where the spline is straight.
            let [at, _, bend] = track.at(0.47 * track.length());
            let error = (at.norm() - 2.0).abs();
            assert!(error < last / 8.0 && (bend.norm() - 0.5).abs() < 10.0 * last, "{count}: {error:e}");
            last = error;
        }
        // A straight line, by two points and by more.
        for count in [2, 5] {
            let points: Vec<[f64; 2]> = (0..count).map(|k| [3.0 * k as f64, 4.0 * k as f64]).collect();
            let line = Track::through(&points).unwrap();
            assert!((line.length() - 5.0 * (count - 1) as f64).abs() < 1e-13);
            let [at, tangent, bend] = line.at(2.5);
            assert!((at - Vec2::new(1.5, 2.0)).norm() < 1e-14 && (tangent - Vec2::new(0.6, 0.8)).norm() < 1e-15);
            assert!(bend.norm() < 1e-13);
        }
        assert!(Track::through(&[[0.0, 0.0]]).is_none() && Track::through(&[[1.0, 0.0], [1.0, 0.0]]).is_none());
        assert!(Track::through(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]).is_none());
    }
}
