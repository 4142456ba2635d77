//! Quintic splines: curves with four continuous derivatives through points.
//!
//! In: points of a function, of one period or between two ends. Out: slope and curvature at each point. Must not know:
//! what the function means.
//!
//! Of all functions through the points, the spline has the smallest integral of y'''^2, and therefore the smoothest
//! second derivative. For a smooth function, the error of the second derivative is of fourth order in the spacing.
//! Between two points the spline is a quintic. With width h, secant d, slopes s and curvatures c of an interval:
//!
//! ```text
//! y'''  = (60 d - 36 s0 - 24 s1) / h^2 + (3 c1 - 9 c0) / h at the first end,
//!         (60 d - 24 s0 - 36 s1) / h^2 + (9 c1 - 3 c0) / h at the second end
//! y'''' = (192 s0 + 168 s1 - 360 d) / h^3 + (36 c0 - 24 c1) / h^2 at the first end,
//!         (360 d - 168 s0 - 192 s1) / h^3 + (36 c1 - 24 c0) / h^2 at the second end
//! ```
//!
//! Both are continuous at each point: two equations for slope and curvature, together a symmetric positive definite
//! block tridiagonal system (Schoenberg 1946; de Boor, A Practical Guide to Splines). Three or more consecutive points
//! with one value are a dwell, with slope 0 and curvature 0. At an end the curvature and the fourth derivative are 0,
//! or the function dwells if the last two points have one value.
use super::piecewise::{Piecewise, secants};
use nalgebra::{Matrix2, Vector2};

/// Slope and curvature at a point. With the values, they are the data of Hermite interpolation.
type Hermite = Vector2<f64>;

/// Known data of a point before the system is solved.
#[derive(Clone, Copy, PartialEq)]
enum Point {
    /// Nothing.
    Free,
    /// The curvature, which is 0.
    Straight,
    /// Slope and curvature.
    Known(Hermite),
}

/// The quintic spline through at least two points [x, y] with ascending x. None for other points.
pub fn spline(points: &[[f64; 2]]) -> Option<Piecewise> {
    let [widths, secants] = secants(points)?;
    let last = secants.len() - 1;
    let rests = |k: usize| {
        let neighbours = |other: Option<usize>| other.is_none_or(|other| secants.get(other).is_none_or(|s| *s == 0.0));
        secants[k] == 0.0 && (neighbours(k.checked_sub(1)) || neighbours(Some(k + 1)))
    };
    let known: Vec<_> = (0..=last + 1)
        .map(|k| match k {
            _ if (k > 0 && rests(k - 1)) || (k <= last && rests(k)) => Point::Known(Hermite::zeros()),
            _ if k == 0 || k > last => Point::Straight,
            _ => Point::Free,
        })
        .collect();
    Some(Piecewise::new(points, &hermite(&widths, &secants, &known)))
}

/// The quintic spline through at least two points [x, y] of one period, x ascending. The last point is the first one
/// a period later. None for other points.
pub fn periodic_spline(points: &[[f64; 2]]) -> Option<Piecewise> {
    let [widths, secants] = secants(points)?;
    let count = secants.len();
    let rests = |k: usize| {
        let neighbours = [k + 1, k + count - 1].map(|other| secants[other % count]);
        count > 1 && secants[k] == 0.0 && neighbours.contains(&0.0)
    };
    let known = |k: usize| match rests(k % count) || rests((k + count - 1) % count) {
        true => Point::Known(Hermite::zeros()),
        false => Point::Free,
    };
    // The spline is linear in slope and curvature at its first point, which is also its last.
    let from = |secants: &[f64], seam: Hermite| {
        let ends = [0, count].map(|k| (k, Point::Known(seam)));
        let at = |k: usize| ends.iter().find(|end| end.0 == k).map_or_else(|| known(k), |end| end.1);
        hermite(&widths, secants, &(0..=count).map(at).collect::<Vec<_>>())
    };
    let rest = from(&secants, Hermite::zeros());
    if known(0) != Point::Free {
        return Some(Piecewise::new(points, &rest));
    }
    let none = vec![0.0; count];
    // Jumps of the fourth and the third derivative at the first point.
    let jump = |secants: &[f64], hermite: &[[f64; 2]]| {
        let parts = [(count - 1, true), (0, false)].map(|(k, left)| {
            let [first, second] = [k, k + 1].map(|k| Hermite::from(hermite[k]));
            let (own, other) = if left { (second, first) } else { (first, second) };
            own_part(widths[k], left) * own + other_part(widths[k], left) * other
                - right_side(widths[k], secants[k], left)
        });
        parts[0] + parts[1]
    };
    let jumps = Matrix2::from_columns(&[Hermite::x(), Hermite::y()].map(|seam| jump(&none, &from(&none, seam))));
    let seam = -(jumps.try_inverse()? * jump(&secants, &rest));
    Some(Piecewise::new(points, &from(&secants, seam)))
}

/// Contribution of slope and curvature of a point to the jumps of the fourth and the third derivative there, for the
/// left or right interval.
fn own_part(h: f64, left: bool) -> Matrix2<f64> {
    let cross = if left { -36.0 } else { 36.0 } / (h * h);
    Matrix2::new(192.0 / (h * h * h), cross, cross, 9.0 / h)
}

/// Contribution of slope and curvature of the neighbour at the other end of this interval to the same jumps.
fn other_part(h: f64, left: bool) -> Matrix2<f64> {
    let cross = if left { 24.0 } else { -24.0 } / (h * h);
    Matrix2::new(168.0 / (h * h * h), cross, -cross, -3.0 / h)
}

/// Contribution of the secant of this interval to the same jumps, with the opposite sign.
fn right_side(h: f64, secant: f64, left: bool) -> Hermite {
    let third = if left { -60.0 } else { 60.0 };
    Hermite::new(360.0 / h, third) * (secant / (h * h))
}

/// Slope and curvature at each point. Where they are not known, the jumps of the fourth and the third derivative are 0.
/// Method: block elimination from the first point to the last, and back substitution.
fn hermite(widths: &[f64], secants: &[f64], known: &[Point]) -> Vec<[f64; 2]> {
    let last = known.len() - 1;
    // Inverse of the reduced diagonal block, coupling to the next point, right side.
    let mut rows: Vec<(Matrix2<f64>, Matrix2<f64>, Hermite)> = Vec::with_capacity(known.len());
    for (k, point) in known.iter().enumerate() {
        let (mut own, mut before, mut next) = (Matrix2::zeros(), Matrix2::zeros(), Matrix2::zeros());
        let mut right = Hermite::zeros();
        if k > 0 {
            own += own_part(widths[k - 1], true);
            before = other_part(widths[k - 1], true);
            right += right_side(widths[k - 1], secants[k - 1], true);
        }
        if k < last {
            own += own_part(widths[k], false);
            next = other_part(widths[k], false);
            right += right_side(widths[k], secants[k], false);
        }
        match *point {
            Point::Free => {}
            Point::Straight => {
                own.set_row(1, &Hermite::y().transpose());
                for part in [&mut before, &mut next] {
                    part.set_row(1, &Hermite::zeros().transpose());
                }
                right.y = 0.0;
            }
            Point::Known(data) => {
                (own, before, next, right) = (Matrix2::identity(), Matrix2::zeros(), Matrix2::zeros(), data);
            }
        }
        if let Some((inverse, coupling, already)) = rows.last() {
            own -= before * inverse * coupling;
            right -= before * inverse * already;
        }
        // The system is positive definite. Overflow gives NaN.
        rows.push((own.try_inverse().unwrap_or(Matrix2::repeat(f64::NAN)), next, right));
    }
    let mut all = vec![[0.0; 2]; known.len()];
    let mut after = Hermite::zeros();
    for (k, (inverse, coupling, right)) in rows.iter().enumerate().rev() {
        after = inverse * (right - coupling * after);
        all[k] = after.into();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Jumps of the third and fourth derivative at x, from values at the distance h on both sides.
    fn jumps(f: &Piecewise, x: f64, h: f64) -> [f64; 2] {
        let third = |x: f64| f.third(x);
        let fourth = |x: f64| (third(x + 0.1 * h) - third(x - 0.1 * h)) / (0.2 * h);
        let [before, after] = [x - h, x + h];
        // Corrected to the first order in h.
        [third(after) - third(before) - h * (fourth(after) + fourth(before)), fourth(after) - fourth(before)]
    }

    #[test]
    fn four_derivatives_are_continuous_at_uneven_points() {
        let points = [[0.0, 0.0], [0.4, 0.3], [1.0, -0.2], [1.3, 0.5], [2.2, 0.1], [2.6, 0.4]];
        let closed = [&points[..], &[[3.1, 0.0]]].concat();
        let (open, closed) = (spline(&points).unwrap(), periodic_spline(&closed).unwrap());
        for f in [&open, &closed] {
            for x in &f.knots()[1..f.knots().len() - 1] {
                let [third, fourth] = jumps(f, *x, 1e-4);
                assert!(third.abs() < 1e-3 && fourth.abs() < 1.0, "{x}: {third:e} {fourth:e}");
            }
        }
        for order in 0..3 {
            let [first, last] = [0.0, 3.1 - 1e-12].map(|x| closed.at(x)[order]);
            assert!((first - last).abs() < 1e-8, "{order}: {first} {last}");
        }
        assert!((closed.third(0.0) - closed.third(3.1 - 1e-12)).abs() < 1e-6);
        // The curvature at the ends is 0.
        for (x, f) in [(0.0, &open), (2.6 - 1e-12, &open)] {
            assert!(f.at(x)[2].abs() < 1e-7, "{}", f.at(x)[2]);
        }
    }

    #[test]
    fn the_error_of_the_second_derivative_is_of_fourth_order() {
        let law = |x: f64| [x.sin() + 0.3 * (2.0 * x).cos(), -x.sin() - 1.2 * (2.0 * x).cos()];
        let errors = [24, 48, 96].map(|count: usize| {
            let points: Vec<_> = (0..=count).map(|k| TAU * k as f64 / count as f64).map(|x| [x, law(x)[0]]).collect();
            let f = periodic_spline(&points).unwrap();
            (0..1000).map(|k| 6e-3 * f64::from(k)).fold(0.0_f64, |most, x| most.max((f.at(x)[2] - law(x)[1]).abs()))
        });
        assert!(errors[2] < 2e-6, "{errors:?}");
        for pair in errors.windows(2) {
            assert!(pair[0] / pair[1] > 14.0, "{errors:?}");
        }
    }

    #[test]
    fn a_line_stays_a_line_and_a_dwell_a_dwell() {
        let line = spline(&[[0.0, 1.0], [0.5, 2.0], [2.0, 5.0], [2.1, 5.2]]).unwrap();
        for x in [-3.0, 0.1, 0.5, 1.7, 2.05, 9.0] {
            let [value, slope, curvature] = line.at(x);
            assert!((value - (1.0 + 2.0 * x)).abs() < 1e-12 && (slope - 2.0).abs() < 1e-12 && curvature.abs() < 1e-11);
        }
        // Dwells at both ends with two points each, and in the middle with three.
        let points = [[0.0, 0.0], [0.1, 0.0], [0.5, 1.0], [0.6, 1.0], [0.8, 1.0], [1.0, 0.4], [1.3, 0.2], [1.5, 0.2]];
        let f = spline(&points).unwrap();
        for (from, to, value) in [(-1.0, 0.1, 0.0), (0.5, 0.8, 1.0), (1.3, 9.0, 0.2)] {
            for k in 0..=10 {
                let x: f64 = from + (to - from) * 0.1 * f64::from(k);
                let [at, slope, curvature] = f.at(x);
                assert!((at - value).abs() < 1e-15 && slope.abs() < 1e-14 && curvature.abs() < 1e-12, "{x}");
            }
        }
        assert!(f.at(0.2)[1] > 0.5);
    }

    #[test]
    fn two_equal_points_at_an_extremum_are_not_a_dwell() {
        let points: Vec<_> = (0..=20).map(|k| TAU * (f64::from(k) + 0.5) / 20.0).map(|x| [x, x.cos()]).collect();
        let mut points = points;
        points[20][1] = points[0][1];
        points[19][1] = points[0][1];
        points[10][1] = points[9][1];
        let f = periodic_spline(&points).unwrap();
        for k in 0..100 {
            let x = points[0][0] + 0.06 * f64::from(k);
            assert!((f.at(x)[2] + x.cos()).abs() < 1e-3, "{x}: {} {}", f.at(x)[2], -x.cos());
        }
    }

    #[test]
    fn a_dwell_may_extend_across_the_end_of_a_period() {
        let points = [[0.0, 0.0], [0.3, 0.0], [1.0, 0.6], [2.0, 1.0], [3.0, 0.5], [5.0, 0.0], [TAU, 0.0]];
        let f = periodic_spline(&points).unwrap();
        for x in [0.0, 0.1, 0.3, 5.0, 5.5, 6.2] {
            assert!(f.at(x).iter().all(|part| part.abs() < 1e-14), "{x}: {:?}", f.at(x));
        }
        assert!(f.at(2.1)[2] < 0.0);
    }

    #[test]
    fn invalid_points_are_rejected() {
        for points in [&[[0.0, 1.0]][..], &[[0.0, 1.0], [0.0, 2.0]], &[[1.0, 0.0], [0.0, 1.0]]] {
            assert_eq!(spline(points), None);
            assert_eq!(periodic_spline(points), None);
        }
    }
}
