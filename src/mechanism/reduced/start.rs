//! The start on the curve: where a coordinate has a stated value.
use super::{Reduced, ReductionError, rough};
use crate::mechanism::loads::resolved::Stop;
use crate::numerics::bracket::bisect;
use crate::numerics::table::{Table, polynomial};
use std::f64::consts::TAU;

impl Reduced {
    /// sigma where a coordinate has this value, and the number of turns of the curve before it: of several the one
    /// nearest to the guess, where sigma is 0.
    ///
    /// # Errors
    /// [`ReductionError::Start`] with the range of the coordinate.
    pub fn find(&self, coordinate: usize, value: f64, name: &str) -> Result<(f64, f64), ReductionError> {
        let table = self.coordinates().map_err(|e| rough(&self.curve, name.into(), e))?;
        let growth = self.growth(coordinate);
        let x: [f64; SAMPLES + 1] = std::array::from_fn(|k| OVERLAP * (-1.0 + 2.0 * k as f64 / SAMPLES as f64));
        let sampled =
            |panel: usize, order: usize| x.map(|x| polynomial(table.series(panel, 3 * coordinate + order), x));
        let samples: Vec<_> = (0..table.panels()).map(|panel| [0, 1].map(|order| sampled(panel, order))).collect();
        // On a curve that turns fully round the value may lie some turns away.
        let revolutions = if growth == 0.0 {
            vec![0.0]
        } else {
            let all = || samples.iter().flat_map(|[values, _]| values.iter().copied());
            let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
            let around = ((value - 0.5 * (low + high)) / growth).round();
            (-2..=2).map(|k| around + f64::from(k)).collect()
        };
        let mut best: Option<(f64, f64)> = None;
        let distance = |sigma: f64| match self.period() {
            Some(period) => sigma.abs().min((period - sigma).abs()),
            None => sigma.abs(),
        };
        for turn in revolutions {
            let wanted = value - turn * growth;
            for (panel, [values, slopes]) in samples.iter().enumerate() {
                let (a, b) = table.borders(panel);
                let mut offer = |x: f64| {
                    let (sigma, turn) = self.within_a_turn(0.5 * (a + b) + 0.5 * (b - a) * x, turn);
                    if best.is_none_or(|(s, _)| distance(sigma) < distance(s)) {
                        best = Some((sigma, turn));
                    }
                };
                let miss = |x: f64| polynomial(table.series(panel, 3 * coordinate), x) - wanted;
                let slope = |x: f64| polynomial(table.series(panel, 3 * coordinate + 1), x);
                // At the border of panels rounding may hide the change of sign.
                for x in [-1.0, 1.0] {
                    if miss(x).abs() <= 8.0 * f64::EPSILON * (1.0 + value.abs()) {
                        offer(x);
                    }
                }
                for k in 0..SAMPLES {
                    let (x0, x1) = (x[k], x[k + 1]);
                    if (values[k] - wanted) * (values[k + 1] - wanted) <= 0.0 {
                        offer(root(&miss, x0, x1));
                    } else if slopes[k] * slopes[k + 1] <= 0.0 {
                        // The coordinate turns back here: a start exactly at the toggle.
                        let x = root(&slope, x0, x1);
                        if miss(x) * miss(x0) <= 0.0 {
                            offer(root(&miss, x0, x));
                            offer(root(&miss, x, x1));
                        } else if miss(x).abs() < TOGGLE {
                            offer(x);
                        }
                    }
                }
            }
        }
        let (sigma, turn) = best.ok_or_else(|| {
            let (low, high) = self.reach(table, coordinate);
            let same = value + TAU * ((0.5 * (low + high) - value) / TAU).round();
            let turned = (coordinate < self.linkage().angles && (low..=high).contains(&same)).then_some(same);
            ReductionError::Start { name: name.into(), value, range: (low, high), turned }
        })?;
        if growth != 0.0 {
            return Ok((sigma, turn));
        }
        // Just behind the guess is the last turn's end: the other coordinates are then near their guesses, not a turn on.
        let behind = self.period().is_some_and(|period| period - sigma < sigma);
        Ok((sigma, if behind { -1.0 } else { 0.0 }))
    }

    /// Least and largest value of a coordinate along the curve, within the stops.
    fn reach(&self, table: &Table, coordinate: usize) -> (f64, f64) {
        // A stop whose quantity grows from turn to turn ends the travel in one of them only.
        let ends = |s: &&Stop| s.enabled && self.load_growth(s.load) == 0.0;
        let stops: Vec<(&Stop, &Table)> =
            self.loading.stops.iter().filter(ends).filter_map(|s| Some((s, self.displacement(s.load).ok()?))).collect();
        let beyond = |sigma: f64| {
            let all = stops.iter().map(|(stop, s)| stop.beyond(s.value(s.spot(sigma), 0)));
            all.fold(f64::NEG_INFINITY, f64::max)
        };
        let q = |sigma: f64, order: usize| table.value(table.spot(sigma), 3 * coordinate + order);
        let (first, last) = self.curve.range();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for panel in 0..table.panels() {
            let (a, b) = table.borders(panel);
            let sigma = |k: usize| (a + (b - a) * k as f64 / SAMPLES as f64).clamp(first, last);
            for k in 0..SAMPLES {
                let (mut s0, mut s1) = (sigma(k), sigma(k + 1));
                match (beyond(s0) > 0.0, beyond(s1) > 0.0) {
                    (true, true) => continue,
                    (true, false) => s0 = root(&beyond, s0, s1),
                    (false, true) => s1 = root(&beyond, s0, s1),
                    (false, false) => {}
                }
                let turns_back = (q(s0, 1) * q(s1, 1) < 0.0).then(|| root(&|s| q(s, 1), s0, s1));
                for s in [s0, s1].into_iter().chain(turns_back) {
                    (low, high) = (low.min(q(s, 0)), high.max(q(s, 0)));
                }
            }
        }
        (low, high)
    }

    /// sigma within the curve, and the number of turns before it, for a sigma counted on over whole turns.
    pub fn unwound(&self, sigma: f64) -> (f64, f64) {
        let revolutions = self.period().map_or(0.0, |period| ((sigma - self.curve.range().0) / period).floor());
        (sigma - revolutions * self.period().unwrap_or(0.0), revolutions)
    }

    /// sigma within the curve, and the number of turns before it, for a sigma just outside.
    fn within_a_turn(&self, sigma: f64, revolutions: f64) -> (f64, f64) {
        let (first, last) = self.curve.range();
        match self.period() {
            Some(period) if sigma < first => (sigma + period, revolutions - 1.0),
            Some(period) if sigma >= last => (sigma - period, revolutions + 1.0),
            Some(_) => (sigma, revolutions),
            None => (sigma.clamp(first, last), revolutions),
        }
    }
}

/// Parts of a panel in which a coordinate turns back once at most.
const SAMPLES: usize = 16;
/// Panels are searched for the start this much beyond their ends: at a border rounding must not hide it from both.
const OVERLAP: f64 = 1.0 + 1e-9;
/// A stated start this close beyond a toggle is at the toggle [rad or m].
const TOGGLE: f64 = 1e-9;

/// Root of a function that changes sign, within rounding.
fn root(f: &dyn Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let rising = f(b) > 0.0 || f(a) < 0.0;
    let [a, b] = bisect(|x| (f(x) > 0.0) == rising, a, b);
    0.5 * (a + b)
}
