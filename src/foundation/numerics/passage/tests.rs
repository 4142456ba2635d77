//! Rises of known functions, especially short ones.
#![allow(clippy::unwrap_used)]
use super::*;
use crate::numerics::bracket::{bisect, false_position};
use crate::numerics::enclosure::Interval;
use proptest::prelude::*;
use std::convert::Infallible;

fn quartic(f: impl Fn(f64) -> f64, [a, b]: [f64; 2]) -> Option<f64> {
    first_rise_of_quartic(|t| Ok::<_, Infallible>(f(t)), [a, b], 1e-15 * (b - a)).unwrap()
}

/// First rise of sin - level, with Lipschitz bounds: |slope| <= frequency.
fn rise_of_sine(frequency: f64, phase: f64, level: f64, grid: usize) -> Option<f64> {
    let f = move |s: f64| (frequency * s + phase).sin() - level;
    let slope = move |s: f64| frequency * (frequency * s + phase).cos();
    let bounds = move |a: f64, b: f64| {
        let (m, r) = (0.5 * (a + b), 0.5 * (b - a));
        let curvature = frequency * frequency * r;
        Enclosure { value: Interval::around(f(m), frequency * r), slope: Interval::around(slope(m), curvature) }
    };
    let locate = |f: &mut dyn FnMut(f64) -> f64, a: Sample, b: Sample| bisect(|s| f(s) > 0.0, a.0, b.0)[1];
    Bounded { f, bounds, locate }.first_rise(f(0.0), grid)
}

#[test]
fn a_fall_and_a_level_function_do_not_rise() {
    assert_eq!(quartic(|t| 1.0 - 3.0 * t, [0.0, 1.0]), None);
    assert_eq!(quartic(|_| -0.0, [0.0, 1.0]), None);
    assert_eq!(quartic(|_| -1e-300, [0.0, 1.0]), None);
    assert_eq!(quartic(|t| -(t - 0.3) * (t - 0.3), [0.0, 1.0]), None, "a touch");
    assert_eq!(first_rise_of_quartic(|_| Err::<f64, _>("no value"), [0.0, 1.0], 1e-15), Err("no value"));
}

/// The parabola is > 0 during 5 ms of 0.52 s.
#[test]
fn a_short_parabola_is_found() {
    let at = quartic(|t| 1e4 - 1.6e9 * (t - 0.5078) * (t - 0.5078), [0.0, 0.52]).unwrap();
    assert!((at - (0.5078 - 2.5e-3)).abs() < 1e-14, "{at}");
}

proptest! {
    /// A short interval with values > 0 anywhere in a long step, down to the length at which its height is a rounding
    /// error. The parabola is stated like an input, by a value and two derivatives.
    #[test]
    fn a_short_interval_of_a_parabola_is_found(
        span in 1e-3..1e3f64,
        center in 0.0..=1.0f64,
        decades in -6.5..-0.5f64,
        scale in -6.0..9.0f64,
    ) {
        let (center, half) = (center * span, 10f64.powf(decades) * span);
        let bend = 10f64.powf(scale) / (span * span);
        let [u0, u1, u2] = [bend * (half * half - center * center), 2.0 * bend * center, -2.0 * bend];
        let f = |t: f64| u0 + t * (u1 + 0.5 * u2 * t);
        let found = quartic(f, [0.0, span]);
        if half < center {
            let at = found.unwrap();
            // Rounding error of the value where the slope is 2 bend half.
            let rounding = 16.0 * f64::EPSILON * (bend * center * center) / (2.0 * bend * half) + 1e-14 * span;
            prop_assert!((at - (center - half)).abs() < rounding, "{at} {}", center - half);
            prop_assert!(f(at) > 0.0);
        }
    }

    /// A joint that enters the range of a friction regime at the start and soon leaves it at the other end. The
    /// function falls from a root at the start, and rises within the first part of the grid.
    #[test]
    fn a_rise_after_a_root_at_the_start_is_found(half in 1e-5..0.06f64, rounding in 0.0..1e-16f64) {
        let f = move |s: f64| (s - half).abs() - half + rounding;
        let bounds = move |a: f64, b: f64| {
            let slope = Interval { low: if a < half { -1.0 } else { 1.0 }, high: if b > half { 1.0 } else { -1.0 } };
            let low = if a < half && b > half { rounding - half } else { f(a).min(f(b)) };
            Enclosure { value: Interval { low, high: f(a).max(f(b)) }, slope }
        };
        let locate = |f: &mut dyn FnMut(f64) -> f64, a: Sample, b: Sample| false_position(f, a, b, 1e-15);
        let found = Bounded { f, bounds, locate }.first_rise(f(0.0).min(0.0), 8);
        let found = found.unwrap();
        prop_assert!((found - 2.0 * half).abs() < 1e-14, "{found} instead of {}", 2.0 * half);
    }

    /// Quartics with known roots: the first rise is found, however close the next fall is.
    #[test]
    fn the_first_rise_of_a_quartic_is_found(
        roots in proptest::array::uniform2(0.0..1.0f64),
        gaps in proptest::array::uniform2(-5.0..-0.5f64),
        turned in any::<bool>(),
    ) {
        let mut all = [roots[0], roots[0] + 10f64.powf(gaps[0]), roots[1], roots[1] + 10f64.powf(gaps[1])];
        all.sort_by(f64::total_cmp);
        // Below 0 at the start.
        all[0] -= if turned { 0.0 } else { 2.0 };
        let sign = if turned { -1.0 } else { 1.0 };
        let f = |t: f64| sign * all.iter().map(|r| t - r).product::<f64>();
        let rises = if turned { [all[0], all[2]] } else { [all[1], all[3]] };
        let expected = rises.into_iter().find(|r| *r > 0.0 && *r < 1.0);
        // Roots closer than this distance are affected by rounding errors of the coefficients.
        let apart = all.windows(2).map(|w| w[1] - w[0]).fold(1.0, f64::min);
        // The same applies to a crest that is not higher than the rounding error of the largest value.
        let (last, rounding) = ([all[1], all[3]], 256.0 * f64::EPSILON * f(0.0).abs().max(f(1.0).abs()));
        let crests = rises.into_iter().zip(last).filter(|(rise, fall)| fall > rise);
        let low = crests.map(|(rise, fall)| f(0.5 * (rise + fall))).fold(f64::INFINITY, f64::min);
        prop_assume!(apart > 5e-6 && low > rounding && rises.iter().all(|r| (r - 1.0).abs() > 1e-9 && r.abs() > 1e-9));
        match (quartic(f, [0.0, 1.0]), expected) {
            (Some(at), Some(expected)) => prop_assert!((at - expected).abs() < 1e-9, "{at} {expected}"),
            (found, expected) => prop_assert_eq!(found, expected),
        }
    }

    /// The crest of a wave is > 0 for an arbitrarily short time, on grids without a point in it.
    #[test]
    fn a_short_crest_is_found(
        frequency in 1.0..60.0f64,
        phase in -6.0..6.0f64,
        below in -9.0..-0.01f64,
        grid in 1..13usize,
    ) {
        let level = 1.0 - 10f64.powf(below);
        let tau = std::f64::consts::TAU;
        // The first s > 0 with sin = level where sin rises.
        let at = (level.asin() - phase).rem_euclid(tau) / frequency;
        let found = rise_of_sine(frequency, phase, level, grid);
        if at < 1.0 - 1e-9 && at > 1e-9 {
            let found = found.unwrap();
            prop_assert!((found - at).abs() < 1e-7, "{found} {at}");
        } else if at > 1.0 + 1e-9 {
            prop_assert_eq!(found, None);
        }
    }
}
