//! Twice continuously differentiable functions of the period 2 pi: the motion laws of cams.
//!
//! In: consecutive rises, or points of one period. Out: the function with two derivatives, and the knots between which
//! it is analytic. Must not know: what the function means.
use super::monotone::monotone;
use super::piecewise::Piecewise;
use super::rise::Rise;
use super::spline::periodic_spline;
use std::f64::consts::TAU;

/// Number of points on each side of one period on which the monotone curve in the period depends. Curvatures depend on
/// the slopes at both neighbours, and these on their neighbours.
const BEYOND: usize = 3;

/// A part of the period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Length [rad], > 0.
    pub length: f64,
    /// Increase of the function.
    pub distance: f64,
    /// Law of the increase. None for a constant part (dwell).
    pub law: Option<Rise>,
}

/// A function of the period 2 pi.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic {
    /// Borders of its analytic parts, ascending, from 0 on and below 2 pi after the first border.
    knots: Vec<f64>,
    parts: Parts,
}

#[derive(Clone, Debug, PartialEq)]
enum Parts {
    /// Segments, each with the value at its start, one for each knot.
    Segments(Vec<(f64, Segment)>),
    /// A curve through the points of one period, at least from its first point to the first point of the next period.
    Points(Piecewise),
}

impl Periodic {
    /// Function of segments whose lengths have the sum 2 pi and whose distances have the sum 0, except for rounding
    /// errors. The function is 0 at 0. None without segments.
    pub fn of_segments(segments: &[Segment]) -> Option<Self> {
        let (mut start, mut value) = (0.0, 0.0);
        let (mut knots, mut parts) = (Vec::new(), Vec::new());
        for segment in segments {
            knots.push(start);
            parts.push((value, *segment));
            start += segment.length;
            value += if segment.law.is_some() { segment.distance } else { 0.0 };
        }
        (!parts.is_empty()).then_some(Self { knots, parts: Parts::Segments(parts) })
    }

    /// The quintic spline through at least two points [u, value] of one period, with u ascending over less than 2 pi.
    /// None for other points.
    pub fn spline(points: &[[f64; 2]]) -> Option<Self> {
        Self::of_curve(points, 0, periodic_spline)
    }

    /// A curve through such points that is monotone where the points are. None for other points.
    pub fn monotone(points: &[[f64; 2]]) -> Option<Self> {
        Self::of_curve(points, BEYOND, monotone)
    }

    /// The curve `through` one period, from a point to the same point of the next period, with `beyond` further points
    /// on each side.
    fn of_curve(
        points: &[[f64; 2]],
        beyond: usize,
        through: impl Fn(&[[f64; 2]]) -> Option<Piecewise>,
    ) -> Option<Self> {
        let (first, last) = (points.first()?, points.last()?);
        if points.len() < 2 || last[0] - first[0] >= TAU {
            return None;
        }
        let (count, beyond) = (points.len() as isize, beyond as isize);
        let around = (-beyond..=count + beyond).map(|k| {
            let [u, value] = points[k.rem_euclid(count) as usize];
            [u + TAU * k.div_euclid(count) as f64, value]
        });
        let curve = through(&around.collect::<Vec<_>>())?;
        Some(Self { knots: points.iter().map(|point| point[0]).collect(), parts: Parts::Points(curve) })
    }

    /// Value with its first and second derivative at u.
    pub fn at(&self, u: f64) -> [f64; 3] {
        let first = self.knots[0];
        let u = first + (u - first).rem_euclid(TAU);
        match &self.parts {
            Parts::Points(curve) => curve.at(u),
            Parts::Segments(parts) => {
                let k = self.knots.partition_point(|knot| *knot <= u).max(1) - 1;
                let (value, Segment { length, distance, law }) = parts[k];
                let [s, slope, curvature, _] = law.map_or([0.0; 4], |law| law.at(u - self.knots[k], distance, length));
                [value + s, slope, curvature]
            }
        }
    }

    /// Distance from u to the next knot farther than `close`, in ascending or descending direction.
    pub fn next_knot(&self, u: f64, ascending: bool, close: f64) -> f64 {
        let sign = if ascending { 1.0 } else { -1.0 };
        let away = |knot: &f64| {
            let distance = (sign * (knot - u)).rem_euclid(TAU);
            if distance > close { distance } else { distance + TAU }
        };
        self.knots.iter().map(away).fold(TAU, f64::min)
    }

    /// Borders of the analytic parts, ascending.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<Periodic> {
        let rise = |length, distance, law| Segment { length, distance, law: Some(law) };
        let dwell = |length| Segment { length, distance: 0.0, law: None };
        let segments = [
            dwell(0.7),
            rise(1.2, 0.03, Rise::Cycloidal),
            dwell(0.5),
            rise(1.0, -0.01, Rise::Polynomial345),
            rise(TAU - 3.4, -0.02, Rise::Polynomial4567),
        ];
        let points = [[0.3, 0.0], [1.0, 0.01], [2.0, 0.04], [3.0, 0.04], [5.0, 0.02]];
        [Periodic::of_segments(&segments), Periodic::spline(&points), Periodic::monotone(&points)]
            .map(Option::unwrap)
            .into()
    }

    #[test]
    fn it_is_periodic_and_smooth_everywhere() {
        let h = 1e-5;
        for f in all() {
            for k in 0..700 {
                let u = -3.0 + 0.02003 * f64::from(k);
                let [now, later, before, after] = [u, u + TAU, u - h, u + h].map(|u| f.at(u));
                for order in 0..3 {
                    assert!((now[order] - later[order]).abs() < 1e-13, "{u} {now:?} {later:?}");
                }
                for order in 0..2 {
                    let slope = (after[order] - before[order]) / (2.0 * h);
                    assert!((slope - now[order + 1]).abs() < 1e-5, "{u}: {slope} {now:?}");
                }
            }
            for knot in f.knots() {
                let [before, after] = [-1e-9, 1e-9].map(|h| f.at(knot + h));
                assert!((before[2] - after[2]).abs() < 1e-7, "{knot}: {before:?} {after:?}");
            }
        }
    }

    #[test]
    fn the_next_knot_is_ahead_in_either_direction() {
        for f in all() {
            for k in 0..200 {
                let u = -9.0 + 0.1 * f64::from(k);
                for (ascending, sign) in [(true, 1.0), (false, -1.0)] {
                    let ahead = f.next_knot(u, ascending, 1e-9);
                    let at = u + sign * ahead;
                    let nearest = f.knots().iter().map(|knot| ((knot - at) / TAU).round() * TAU + at - knot);
                    assert!(nearest.fold(f64::INFINITY, |least, d| least.min(d.abs())) < 1e-12);
                    let between = f.knots().iter().filter(|knot| {
                        let distance = (sign * (*knot - u)).rem_euclid(TAU);
                        1e-9 < distance && distance < ahead - 1e-9
                    });
                    assert_eq!(between.count(), 0);
                }
            }
            let knot = f.knots()[1];
            assert!(f.next_knot(knot, true, 1e-9) > 1e-3, "the knot at hand is not the next one");
        }
    }

    #[test]
    fn points_of_more_than_a_period_are_rejected() {
        for points in [&[[0.0, 1.0]][..], &[[0.0, 1.0], [TAU, 1.0]], &[[1.0, 0.0], [0.5, 1.0]]] {
            assert_eq!(Periodic::spline(points), None);
            assert_eq!(Periodic::monotone(points), None);
        }
    }
}
