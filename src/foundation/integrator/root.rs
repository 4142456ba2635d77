//! First passage of a level by the interpolant of a step.
//!
//! On [0, 1] a polynomial is within the range of its Bernstein coefficients. The number of its roots inside is at most
//! the number of sign changes of the coefficients, and equal to it for one change. The interval is bisected (de
//! Casteljau) until each part has one change at most, which finds every root. The parts are searched from left to
//! right.
//! Source: Farouki, The Bernstein polynomial basis: a centennial retrospective, Comput. Aided Geom. Des. 29 (2012),
//! 379.
use super::Dense;
use super::dense::TERMS;
use crate::numerics::enclosure::{Enclosure, Interval};

/// Direction in which a level is passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From below to above.
    Rising,
    /// From above to below.
    Falling,
}

/// Bernstein coefficients of a polynomial of degree 7 on an interval.
type Coefficients = [f64; TERMS + 1];
/// Coefficients of several polynomials side by side.
type SideBySide<const L: usize> = [[f64; L]; TERMS + 1];

/// Index of a coefficient as a floating-point number.
const NUMBER: [f64; TERMS + 1] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// Number of bisections of the step after which a part is a point.
const DEEPEST: u32 = 50;
/// Rounding error of the coefficients, relative to the largest number from which they are computed.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

impl<const N: usize> Dense<N> {
    /// The first s in (0, 1] at which this component passes the level in this direction. None without a passage. A
    /// touch is not a passage. An end exactly on the level is a passage, because the polynomial does not determine how
    /// the motion continues.
    ///
    /// With `leaving` the step starts on the level, up to rounding errors, or beyond the level. The start is then not a
    /// passage, neither with a speed away from the level nor with the speed 0 and an acceleration. Without `leaving`,
    /// the signs at both ends are those of the exact states, so no passage between two steps is lost.
    pub fn first_passage(&self, component: usize, level: f64, direction: Direction, leaving: bool) -> Option<f64> {
        let sign = match direction {
            Direction::Rising => 1.0,
            Direction::Falling => -1.0,
        };
        let mut b: Coefficients = self.bernstein([component]).map(|[b]| sign * (b - level));
        b[0] = sign * (self.start[component] - level);
        b[TERMS] = sign * (self.end[component] - level);
        let largest = b.iter().fold(level.abs().max(self.start[component].abs()), |m, b| m.max(b.abs()));
        let mut search = Search { noise: ROUNDING * largest, below: b[0] < 0.0 };
        if leaving {
            search.below = false;
            if b[0] <= search.noise {
                b[0] = 0.0;
                if b[1].abs() <= search.noise {
                    b[1] = 0.0;
                }
            }
        }
        if b.iter().all(|b| *b < 0.0) {
            return None;
        }
        search.part(&b, 0.0, 1.0, 0).or_else(|| (search.below && b[TERMS] >= 0.0).then_some(1.0))
    }

    /// Bernstein coefficients of these components, for bounds on parts of the step.
    pub fn bounded<const L: usize>(&self, components: [usize; L]) -> BoundedComponents<L> {
        BoundedComponents(self.bernstein(components))
    }

    /// Bernstein coefficients by Horner's rule for the nested form. Each factor s or 1 - s raises the degree by one.
    fn bernstein<const L: usize>(&self, components: [usize; L]) -> SideBySide<L> {
        let mut b = [[0.0; L]; TERMS + 1];
        for count in 1..TERMS + 1 {
            // The first `count` are the coefficients of the inner polynomial.
            let (i, raised) = (TERMS - count, NUMBER[count]);
            let term = components.map(|component| self.terms[i][component]);
            if i % 2 == 0 {
                for k in (0..count).rev() {
                    b[k + 1] = std::array::from_fn(|l| (b[k][l] + term[l]) * NUMBER[k + 1] / raised);
                }
                b[0] = [0.0; L];
            } else {
                for k in 0..count {
                    let factor = NUMBER[count - k] / raised;
                    b[k] = std::array::from_fn(|l| (b[k][l] + term[l]) * factor);
                }
            }
        }
        let start = components.map(|component| self.start[component]);
        b.map(|b| std::array::from_fn(|l| b[l] + start[l]))
    }
}

/// Components of an interpolant, as Bernstein coefficients on the whole step.
#[derive(Clone, Copy, Debug)]
pub struct BoundedComponents<const L: usize>(SideBySide<L>);

impl<const L: usize> BoundedComponents<L> {
    /// Bounds of the components and of their derivatives by s, on the interval a < b of the step.
    pub fn enclosures(&self, [a, b]: [f64; 2]) -> [Enclosure; L] {
        let mut c = self.0;
        if b < 1.0 {
            (c, _) = divided(&c, b);
        }
        if a > 0.0 {
            (_, c) = divided(&c, a / b);
        }
        let rate = NUMBER[TERMS] / (b - a);
        let slopes: [[f64; L]; TERMS] =
            std::array::from_fn(|k| std::array::from_fn(|l| rate * (c[k + 1][l] - c[k][l])));
        let (values, slopes) = (ranges(&c), ranges(&slopes));
        std::array::from_fn(|l| Enclosure { value: values[l], slope: slopes[l] })
    }
}

/// Search for a passage of 0 from below, from left to right.
struct Search {
    /// Limit below which coefficients are rounding errors.
    noise: f64,
    /// Whether the polynomial was < 0 where it was last different from 0.
    below: bool,
}

impl Search {
    /// The first passage in the interval [a, a + width] with coefficients b.
    fn part(&mut self, b: &Coefficients, a: f64, width: f64, depth: u32) -> Option<f64> {
        let (mut least, mut most, mut changes) = (0.0_f64, 0.0_f64, 0);
        let (mut first, mut last) = (0.0, 0.0);
        for &b in b {
            (least, most) = (least.min(b), most.max(b));
            if b != 0.0 {
                changes += u32::from(last * b < 0.0);
                if first == 0.0 {
                    first = b;
                }
                last = b;
            }
        }
        if most <= 0.0 {
            self.below |= least < 0.0;
            return None;
        }
        if least >= 0.0 {
            let passed = self.below && a > 0.0;
            self.below = false;
            return passed.then_some(a);
        }
        if most.max(-least) <= self.noise {
            return None;
        }
        if self.below && first > 0.0 {
            // The passage is between two parts, within the rounding error.
            self.below = false;
            return Some(a);
        }
        if changes == 1 || depth == DEEPEST {
            self.below = last < 0.0;
            return (first < 0.0 && last > 0.0).then(|| (a + width * root(b)).min(1.0));
        }
        let (left, right) = halves(b);
        let half = 0.5 * width;
        self.part(&left, a, half, depth + 1).or_else(|| self.part(&right, a + half, half, depth + 1))
    }
}

/// Coefficients before and after a part of the interval, by de Casteljau's algorithm.
#[inline]
fn divided<const L: usize>(b: &SideBySide<L>, part: f64) -> (SideBySide<L>, SideBySide<L>) {
    let (mut left, mut right) = (*b, *b);
    for count in (1..TERMS + 1).rev() {
        for k in 0..count {
            right[k] = std::array::from_fn(|l| right[k][l] + part * (right[k + 1][l] - right[k][l]));
        }
        left[TERMS + 1 - count] = right[0];
    }
    (left, right)
}

/// The smallest interval that contains the numbers of each polynomial.
#[inline]
fn ranges<const L: usize>(numbers: &[[f64; L]]) -> [Interval; L] {
    let (mut low, mut high) = ([f64::INFINITY; L], [f64::NEG_INFINITY; L]);
    for x in numbers {
        low = std::array::from_fn(|l| if x[l] < low[l] { x[l] } else { low[l] });
        high = std::array::from_fn(|l| if x[l] > high[l] { x[l] } else { high[l] });
    }
    std::array::from_fn(|l| Interval { low: low[l], high: high[l] })
}

/// Coefficients on the two halves of the interval, by de Casteljau's algorithm.
fn halves(b: &Coefficients) -> (Coefficients, Coefficients) {
    let (mut left, mut right) = (*b, *b);
    for count in (1..TERMS + 1).rev() {
        for k in 0..count {
            right[k] = 0.5 * (right[k] + right[k + 1]);
        }
        left[TERMS + 1 - count] = right[0];
    }
    (left, right)
}

/// The root in (0, 1] of a polynomial whose coefficients change sign once, from below: Illinois method within bounds.
fn root(b: &Coefficients) -> f64 {
    let at = |s: f64| {
        let mut b = *b;
        for count in (1..TERMS + 1).rev() {
            for k in 0..count {
                b[k] += s * (b[k + 1] - b[k]);
            }
        }
        b[0]
    };
    let (mut low, mut high) = (0.0, 1.0);
    let (mut below, mut above) = (b[0], b[TERMS]);
    // Number of consecutive replacements of the same bound: > 0 for the lower, < 0 for the upper bound.
    let mut run = 0;
    for i in 0..100 {
        let secant = low - below * (high - low) / (above - below);
        // Every third point is in the middle, so that the interval is halved for any polynomial.
        let s = if i % 3 != 2 && secant > low && secant < high { secant } else { 0.5 * (low + high) };
        if s <= low || s >= high || high - low <= f64::EPSILON * high {
            break;
        }
        let value = at(s);
        if value < 0.0 {
            (low, below, run) = (s, value, run.max(0) + 1);
        } else if value > 0.0 {
            (high, above, run) = (s, value, run.min(0) - 1);
        } else {
            return s;
        }
        // The value at the bound that stays is halved, so that the secant also moves this bound.
        if run > 1 {
            above *= 0.5;
        } else if run < -1 {
            below *= 0.5;
        }
    }
    high
}
