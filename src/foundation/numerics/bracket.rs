//! Search for the point at which a function of one number crosses 0, between two points on either side.
//!
//! In: a function, a bracket or a sampled interval. Out: the root within rounding errors or a given distance. Must not
//! know: what the function means.

/// Number of bisections after which a bracket of width 1 is below the rounding error.
const HALVINGS: usize = 60;

/// Bisection of a predicate that is false at `a` and true at `b`. Returns the last point where the predicate is false
/// and the first point where it is true: neighbouring numbers, or 2^-60 of the width apart.
pub fn bisect(mut is_beyond: impl FnMut(f64) -> bool, mut a: f64, mut b: f64) -> [f64; 2] {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (a + b);
        if is_beyond(middle) { b = middle } else { a = middle }
    }
    [a, b]
}

/// The point where f changes from <= 0 at a to > 0 at b. At the returned point f is > 0, and the root is at most
/// `close` away. `a` and `b` are points with the values of f.
///
/// Method: false position after Anderson and Bjoerck (BIT 13 (1973), 253). Trial points have a distance of at least
/// `close` / 2 from both ends, so that both sides of the root are found. Slow false position is replaced by bisection.
#[inline]
pub fn false_position(
    mut f: impl FnMut(f64) -> f64,
    (mut a, mut f_a): (f64, f64),
    (mut b, mut f_b): (f64, f64),
    close: f64,
) -> f64 {
    let weight = |ratio: f64| if ratio < 1.0 { 1.0 - ratio } else { 0.5 };
    let mut last_sign = 0.0;
    for k in 0..100 {
        if b - a <= close {
            break;
        }
        let secant = (b - f_b * (b - a) / (f_b - f_a)).min(b - 0.5 * close).max(a + 0.5 * close);
        let halve = if k < 16 { k % 8 == 7 } else { k % 2 == 0 };
        let c = if halve || !(a < secant && secant < b) { 0.5 * (a + b) } else { secant };
        let f_c = f(c);
        if f_c > 0.0 {
            // The value at an end that stays a second time is reduced, so that the secant also moves this end.
            f_a *= if last_sign > 0.0 { weight(f_c / f_b) } else { 1.0 };
            (b, f_b) = (c, f_c);
        } else {
            f_b *= if last_sign < 0.0 { weight(f_c / f_a) } else { 1.0 };
            (a, f_a) = (c, f_c);
        }
        last_sign = if f_c > 0.0 { 1.0 } else { -1.0 };
    }
    b
}

/// The first point of (0, 1] where f changes from <= 0 to > 0, at most `close` after its root. f is evaluated at the
/// ends of `samples` equal parts. Two sign changes between neighbouring samples are not found. A value > 0 at 0 counts
/// as a rounding error.
///
/// # Errors
/// f has no value at a sample. Between two samples, a point without a value counts as <= 0.
pub fn first_rise<E>(mut f: impl FnMut(f64) -> Result<f64, E>, samples: usize, close: f64) -> Result<Option<f64>, E> {
    let (mut a, mut f_a) = (0.0, f(0.0)?.min(0.0));
    for i in 1..=samples {
        let b = i as f64 / samples as f64;
        let f_b = f(b)?;
        if f_b > 0.0 {
            return Ok(Some(false_position(|s| f(s).unwrap_or(-1.0), (a, f_a), (b, f_b), close)));
        }
        (a, f_a) = (b, f_b);
    }
    Ok(None)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn false_position_ends_on_the_far_side_in_few_calls() {
        let functions: [(&dyn Fn(f64) -> f64, f64); 4] = [
            (&|x| x.exp() - 2.0, 2.0_f64.ln()),
            (&|x| (x - 0.3).powi(3), 0.3),
            (&|x| if x > 0.7 { 1.0 } else { -1e-9 }, 0.7),
            (&|x| 1e-3 - (x - 1.0).powi(2), 1.0 - 1e-3_f64.sqrt()),
        ];
        for (n, (f, exact)) in functions.iter().enumerate() {
            let mut calls = 0;
            let mut counted = |x: f64| {
                calls += 1;
                f(x)
            };
            let at = false_position(&mut counted, (0.0, f(0.0)), (1.0, f(1.0)), 1e-11);
            assert!(f(at) > 0.0 && at - exact <= 1.1e-11, "{n}: {at}");
            assert!(calls <= [9, 90, 90, 14][n], "{n}: {calls}");
        }
    }

    #[test]
    fn bisection_ends_at_two_neighbouring_numbers() {
        for root in [0.1, 0.5_f64.sqrt(), 1.0 - f64::EPSILON] {
            let [a, b] = bisect(|x| x > root, 0.0, 1.0);
            assert_eq!((a, b), (root, root.next_up()));
        }
        let [below, above] = bisect(|x| x <= -0.2, 3.0, -1.0);
        assert_eq!((below, above), (-0.2_f64.next_down(), -0.2));
    }

    #[test]
    fn the_first_of_several_rises_is_found() {
        let sine = |s: f64| Ok::<_, ()>((20.0 * s + 2.0 * std::f64::consts::FRAC_PI_2).sin());
        let first = first_rise(sine, 64, 1e-14).unwrap().unwrap();
        assert!((first - std::f64::consts::PI / 20.0).abs() < 1e-14, "{first}");
        assert_eq!(first_rise(|s| Ok::<_, ()>(-s), 8, 1e-14), Ok(None));
        assert_eq!(first_rise(|s| if s < 0.5 { Ok(-1.0) } else { Err("no value") }, 8, 1e-14), Err("no value"));
    }
}
