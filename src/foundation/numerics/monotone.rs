//! Smooth monotone interpolation of a table of points.
//!
//! In: points of a function. Out: the function between and beyond them. Must not know: what the function means.
//!
//! The function is monotone where the points are. The slope of a quintic is a quartic with the Bernstein coefficients
//!
//! ```text
//! b0 = y0', b1 = y0' + h y0'' / 4, b2 = 5 s - b0 - b1 - b3 - b4, b3 = y1' - h y1'' / 4, b4 = y1'
//! ```
//!
//! with the width h of the interval and its secant s. A polynomial has the common sign of its Bernstein coefficients
//! (Dougherty, Edelman, Hyman, Math. Comp. 52 (1989), 471).
use super::piecewise::{Piecewise, secants};

/// Largest ratio of the slope at a point to the smaller neighbouring secant. With curvature 0, all five coefficients
/// then have the same sign.
const STEEPEST: f64 = 1.25;

/// The function through at least two points [x, y] with ascending x, monotone where the points are. None for other
/// points.
pub fn monotone(points: &[[f64; 2]]) -> Option<Piecewise> {
    let [widths, secants] = secants(points)?;
    let slopes: Vec<f64> = (0..points.len()).map(|k| slope(&widths, &secants, k)).collect();
    let hermite: Vec<_> = (0..points.len()).map(|k| [slopes[k], curvature(&widths, &secants, &slopes, k)]).collect();
    Some(Piecewise::new(points, &hermite))
}

/// Slope at point k: that of the parabola through the point and its neighbours, limited by [`STEEPEST`]. 0 at an
/// extremum.
fn slope(widths: &[f64], secants: &[f64], k: usize) -> f64 {
    let last = secants.len();
    let (estimate, neighbours) = match k {
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
    let sign = neighbours[0].signum();
    if neighbours[0] * neighbours[1] <= 0.0 || estimate * sign <= 0.0 {
        return 0.0;
    }
    sign * (estimate * sign).min(STEEPEST * neighbours[0].abs().min(neighbours[1].abs()))
}

/// Slope at an end, from the parabola through the three points nearest to the end. The nearest widths and secants are
/// the first.
fn end_slope([h0, h1]: [f64; 2], [s0, s1]: [f64; 2]) -> f64 {
    s0 + (s0 - s1) * h0 / (h0 + h1)
}

/// Curvature at point k: the second divided difference, limited so that the quintics on both sides of the point stay
/// monotone. 0 at the ends.
fn curvature(widths: &[f64], secants: &[f64], slopes: &[f64], k: usize) -> f64 {
    if k == 0 || k == secants.len() {
        return 0.0;
    }
    let [h0, h1] = [widths[k - 1], widths[k]];
    let sign = slopes[k].signum();
    let steepness = slopes[k].abs();
    // Part of b2 that is available for the curvatures at the two ends of an interval, half for each.
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
    use crate::numerics::enclosure::Interval;
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
        let line = monotone(&[[0.0, 1.0], [0.5, 2.0], [2.0, 5.0]]).unwrap();
        for x in [-3.0, 0.1, 0.5, 1.7, 2.0, 9.0] {
            assert!((line.at(x)[0] - (1.0 + 2.0 * x)).abs() < 1e-13, "{x}");
            assert!((line.at(x)[1] - 2.0).abs() < 1e-13, "{x}");
            assert!((line.integral(x) - (x + x * x)).abs() < 1e-12, "{x}");
        }
    }

    #[test]
    fn invalid_points_are_rejected() {
        for points in
            [&[[0.0, 1.0]][..], &[[0.0, 1.0], [0.0, 2.0]], &[[1.0, 0.0], [0.0, 1.0]], &[[0.0, f64::NAN], [1.0, 0.0]]]
        {
            assert_eq!(monotone(points), None);
        }
    }

    #[test]
    fn the_error_for_a_smooth_function_is_of_third_order() {
        let error = |count: i32| {
            let points: Vec<_> = (0..=count).map(|k| f64::from(k) / f64::from(count)).map(|x| [x, x.exp()]).collect();
            let f = monotone(&points).unwrap();
            // The quintics at the ends have curvature 0 there, so only the inner part is compared.
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
            let f = monotone(&points).unwrap();
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
        fn all_values_are_within_bounds_that_converge(
            steps in prop::collection::vec((0.1..2.0, -5.0..5.0), 2..9),
            low in -2.0..12.0f64,
            width in 0.0..6.0f64,
            part in 0.0..=1.0f64,
        ) {
            let f = monotone(&ascending(&steps)).unwrap();
            let size = f.largest().max(1.0);
            for width in [width, 1e-6 * width] {
                let bounds = f.bounds(Interval { low, high: low + width });
                let at = f.at(low + part * width);
                for (bounds, value) in bounds.iter().zip(at) {
                    prop_assert!(bounds.low - 1e-9 * size <= value && value <= bounds.high + 1e-9 * size, "{bounds:?} \
                        {at:?}");
                }
                if width < 1e-5 {
                    prop_assert!(bounds[1].high - bounds[1].low < 1e-2 * size, "{bounds:?}");
                }
            }
        }
    }
}
