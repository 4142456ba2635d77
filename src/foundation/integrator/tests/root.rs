//! First passages compared with dense sampling and with known roots.
use crate::integrator::Dense;
use crate::integrator::Direction::{self, Falling, Rising};
use crate::integrator::dense::TERMS;
use proptest::prelude::*;

/// The interpolant with these terms. Its end is its value at 1.
fn dense(start: f64, terms: [f64; TERMS]) -> Dense<1> {
    let open = Dense::new([start], [0.0], terms.map(|term| [term]), |_| 0.0);
    Dense::new([start], open.at(1.0), terms.map(|term| [term]), |_| 0.0)
}

/// The interpolant factor * product of (s - root) for up to 7 roots. Its terms follow by division by s and 1 - s.
fn with_roots(factor: f64, roots: &[f64]) -> Dense<1> {
    let mut power = [0.0; TERMS + 1];
    power[0] = factor;
    for (degree, root) in roots.iter().enumerate() {
        for k in (0..=degree + 1).rev() {
            power[k] = if k > 0 { power[k - 1] } else { 0.0 } - root * power[k];
        }
    }
    let (start, mut terms) = (power[0], [0.0; TERMS]);
    power.rotate_left(1);
    power[TERMS] = 0.0;
    for (i, term) in terms.iter_mut().enumerate() {
        // term = rest(x) at the root x of the next factor, then rest = (rest - term) / factor.
        if i % 2 == 0 {
            *term = power.iter().sum();
            power[0] -= *term;
            // Divide by 1 - s: q_k = sum of the coefficients up to k.
            let mut sum = 0.0;
            for p in &mut power {
                sum += *p;
                *p = sum;
            }
        } else {
            *term = power[0];
            power.rotate_left(1);
            power[TERMS] = 0.0;
        }
    }
    dense(start, terms)
}

#[test]
fn the_polynomial_with_given_roots_has_them() {
    let roots = [0.1, 0.35, 0.5, -0.7, 1.4, 0.9, 2.0];
    let dense = with_roots(3.0, &roots);
    for s in [0.0, 0.2, 0.6, 1.0] {
        let exact: f64 = 3.0 * roots.iter().map(|r| s - r).product::<f64>();
        assert!((dense.at(s)[0] - exact).abs() < 1e-13, "{s}");
    }
}

#[test]
fn simple_roots_are_found_in_their_order_and_direction() {
    let dense = with_roots(1.0, &[0.2, 0.5, 0.7]);
    assert!((dense.first_passage(0, 0.0, Rising, false).unwrap() - 0.2).abs() < 1e-14);
    assert!((dense.first_passage(0, 0.0, Falling, false).unwrap() - 0.5).abs() < 1e-14);
    assert_eq!(dense.first_passage(0, 1.0, Rising, false), None);
}

#[test]
fn a_touch_is_no_passage() {
    for touch in [0.5, 0.3, 1.0 / 3.0, 0.123_456_789] {
        // 1e-12 is above the rounding error of the coefficients, so the polynomial stays slightly below.
        let dense = with_roots(-1.0, &[touch, touch]);
        assert_eq!(dense.first_passage(0, 1e-12, Rising, false), None, "touch at {touch}");
        let through = dense.first_passage(0, -1e-6, Rising, false).unwrap();
        assert!((through - (touch - 1e-3)).abs() < 1e-9);
    }
    // Without rounding errors: dyadic numbers.
    assert_eq!(with_roots(-1.0, &[0.5, 0.5]).first_passage(0, 0.0, Rising, false), None);
    assert_eq!(with_roots(-1.0, &[0.25, 0.25]).first_passage(0, 0.0, Rising, false), None);
    // A touch before a passage.
    let passage = with_roots(1.0, &[0.25, 0.25, 0.75]).first_passage(0, 0.0, Rising, false).unwrap();
    assert!((passage - 0.75).abs() < 1e-14);
    // A triple root passes.
    let triple = with_roots(1.0, &[0.4, 0.4, 0.4]).first_passage(0, 0.0, Rising, false).unwrap();
    assert!((triple - 0.4).abs() < 1e-4, "{triple}");
}

#[test]
fn the_start_on_the_level_is_no_passage() {
    for roots in [&[0.0][..], &[0.0, 0.0], &[0.0, 0.0, 0.0]] {
        for factor in [1.0, -1.0] {
            for leaving in [true, false] {
                let dense = with_roots(factor, roots);
                assert_eq!(dense.first_passage(0, 0.0, Rising, leaving), None, "{roots:?} {factor} {leaving}");
                assert_eq!(dense.first_passage(0, 0.0, Falling, leaving), None, "{roots:?} {factor} {leaving}");
            }
        }
    }
    // Start and speed are 0 except for rounding errors of either sign.
    for (start, speed) in [(1e-17, -1e-17), (-1e-17, 1e-17), (1e-17, 1e-17), (-1e-17, -1e-17)] {
        for bend in [0.3, -0.3] {
            // start + speed s + bend s^2.
            let dense = dense(start, [speed + bend, -bend, 0.0, 0.0, 0.0, 0.0, 0.0]);
            assert_eq!(dense.first_passage(0, 0.0, Rising, true), None);
            assert_eq!(dense.first_passage(0, 0.0, Falling, true), None);
        }
    }
    // Away from the level, then back through it.
    let back = with_roots(1.0, &[0.0, 0.6]);
    assert!((back.first_passage(0, 0.0, Rising, true).unwrap() - 0.6).abs() < 1e-14);
    assert_eq!(back.first_passage(0, 0.0, Falling, true), None);
}

#[test]
fn an_end_on_the_level_is_a_passage() {
    assert_eq!(with_roots(1.0, &[1.0]).first_passage(0, 0.0, Rising, false), Some(1.0));
    assert_eq!(with_roots(1.0, &[1.0]).first_passage(0, 0.0, Falling, false), None);
    // The exact end counts, not that of the polynomial: just after or just before the level.
    let terms = [[1.0], [0.0], [0.0], [0.0], [0.0], [0.0], [0.0]];
    let end = |end: f64| Dense::new([-1.0], [end], terms, |_| 0.0).first_passage(0, 0.0, Rising, false);
    assert_eq!((end(1e-17), end(-1e-17)), (Some(1.0), None));
}

/// The first passage among 20,000 samples, as the interval between two samples.
fn sampled(dense: &Dense<1>, level: f64, direction: Direction, leaving: bool) -> Option<(f64, f64)> {
    const SAMPLES: u32 = 20_000;
    let sign = if direction == Rising { 1.0 } else { -1.0 };
    let mut below = if leaving { None } else { (dense.start[0] != level).then_some(0.0) };
    below = below.filter(|_| sign * (dense.start[0] - level) < 0.0);
    for i in 1..=SAMPLES {
        let s = f64::from(i) / f64::from(SAMPLES);
        let value = sign * (dense.at(s)[0] - level);
        if value < 0.0 {
            below = Some(s);
        } else if value > 0.0
            && let Some(low) = below
        {
            return Some((low, s));
        }
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn no_passage_is_missed_and_none_invented(
        start in -1.0..1.0, terms in prop::array::uniform7(-1.0..1.0), amplify in 0..3, level in -1.0..1.0,
        rising: bool, leaving: bool,
    ) {
        let terms = std::array::from_fn(|i| terms[i] * 8f64.powi(amplify * (i as i32) / 2));
        let dense = dense(if leaving { level } else { start }, terms);
        let direction = if rising { Rising } else { Falling };
        let (found, sampled) = (dense.first_passage(0, level, direction, leaving), sampled(&dense, level, direction,
            leaving));
        let size = terms.iter().fold(1.0, |m: f64, t| m.max(t.abs()));
        if let Some((low, high)) = sampled {
            let s = found.expect("a passage was missed");
            // Two roots between two samples may come before.
            prop_assert!(s <= high + 1e-12);
            if s < low - 1e-12 {
                let worst = (dense.at(s)[0] - level).abs();
                prop_assert!(worst < 1e-12 * size, "not a root: {s} {worst}");
            }
        }
        if let Some(s) = found {
            prop_assert!(s > 0.0 && s <= 1.0);
            prop_assert!((dense.at(s)[0] - level).abs() < 1e-13 * size, "{}", dense.at(s)[0] - level);
            if sampled.is_none() {
                // Two roots between neighbouring samples: the polynomial nearly touches the level.
                let near = [-1e-4, 1e-4].map(|d| (dense.at((s + d).clamp(0.0, 1.0))[0] - level).abs());
                prop_assert!(near[0].min(near[1]) < 1e-3 * size);
            }
        }
    }

    #[test]
    fn roots_are_the_given_ones(
        roots in prop::collection::vec(-0.3..1.3_f64, 1..=7), double in -0.2..1.2_f64, with_double: bool, up: bool,
    ) {
        let mut all = roots.clone();
        if with_double {
            all.truncate(5);
            all.extend([double, double]);
        }
        let simple = if with_double { &all[..all.len() - 2] } else { &all[..] };
        let mut sorted = all.clone();
        sorted.sort_by(f64::total_cmp);
        // The roots are so far from each other and from the ends that rounding errors do not reorder them.
        let apart = sorted.windows(2).all(|w| w[0] == w[1] || w[1] - w[0] > 0.02);
        if !(apart && all.iter().all(|r| r.abs() > 0.02 && (r - 1.0).abs() > 0.02)) {
            return Ok(());
        }
        let dense = with_roots(if up { 1.0 } else { -1.0 }, &all);
        for direction in [Rising, Falling] {
            let sign = if direction == Rising { 1.0 } else { -1.0 };
            let passes = |r: &f64| {
                let slope: f64 = all.iter().filter(|q| *q != r).map(|q| r - q).product();
                (slope * sign > 0.0) == up
            };
            let expected = simple.iter().copied().filter(|r| (0.0..=1.0).contains(r) && passes(r)).reduce(f64::min);
            let found = dense.first_passage(0, 0.0, direction, false);
            // Rounding errors can split the double root into two, apart by the square root of the rounding error.
            let curvature: f64 = simple.iter().map(|r| (double - r).abs()).product();
            let other = with_double && found.is_some_and(|s| (s - double).abs() < (1e-13 / curvature).sqrt());
            if other { continue }
            match (expected, found) {
                (None, None) => {}
                (Some(r), Some(s)) => {
                    prop_assert!((r - s).abs() < 1e-4, "{r} {s}");
                    let value: f64 = all.iter().map(|r| s - r).product();
                    prop_assert!(value.abs() < 1e-13, "{s}: {value}");
                }
                _ => prop_assert!(false, "{expected:?} {found:?} {all:?}"),
            }
        }
    }
}

/// A step that starts beyond the level, approaches the level, turns and moves away again does not pass the level.
#[test]
fn a_turn_beyond_the_level_is_no_passage() {
    for (start, speed) in [(0.05, 0.577), (0.5, 8.0), (1e-6, 1e-3)] {
        // start - speed s + curvature s^2, whose minimum is a tenth of the start.
        let curvature = speed * speed / (3.6 * start);
        let turn = [(curvature - speed), -curvature, 0.0, 0.0, 0.0, 0.0, 0.0];
        let dense = dense(start, turn);
        assert!((dense.at(0.5)[0] - (start - 0.5 * speed + 0.25 * curvature)).abs() < 1e-13 * curvature);
        assert_eq!(dense.first_passage(0, 0.0, Rising, true), None);
        // A lower level is passed, there and back.
        let through = dense.first_passage(0, 0.5 * start, Rising, true).unwrap();
        let exact = (speed + (speed * speed - 2.0 * curvature * start).sqrt()) / (2.0 * curvature);
        assert!((through - exact).abs() < 1e-12, "{through} {exact}");
    }
}

proptest! {
    /// Values and slopes on a part of the step are within their bounds, and so are the ends of the whole step. The
    /// bounds of a component do not depend on other components.
    #[test]
    fn bounds_hold_on_every_part(
        terms in proptest::array::uniform7(-1.0..1.0f64),
        [a, b] in [0.0..0.9f64, 0.01..0.1f64].prop_map(|[a, width]| [a, a + width]),
        part in 0.0..=1.0f64,
    ) {
        let one = dense(0.3, terms);
        let two = Dense::new([-1.0, 0.3], [0.0, one.at(1.0)[0]], terms.map(|term| [term * term, term]), |_| 0.0);
        let [bounds] = one.bounded([0]).enclosures([a, b]);
        prop_assert_eq!(two.bounded([1, 0]).enclosures([a, b])[0], bounds);
        let (s, step) = (a + part * (b - a), 1e-6);
        let [value, before, after] = [s, s - step, s + step].map(|s| one.component(0, s));
        prop_assert!(bounds.value.low - 1e-13 < value && value < bounds.value.high + 1e-13, "{bounds:?} {value}");
        let slope = (after - before) / (2.0 * step);
        prop_assert!(bounds.slope.low - 1e-7 < slope && slope < bounds.slope.high + 1e-7, "{bounds:?} {slope}");
        let [whole] = one.bounded([0]).enclosures([0.0, 1.0]);
        prop_assert!(whole.value.low <= one.at(0.0)[0] && one.at(1.0)[0] <= whole.value.high + 1e-14);
    }
}
