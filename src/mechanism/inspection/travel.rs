//! The travel from end to end: samples of functions of the configuration, with their extremes and zeros.
//!
//! In: a reduced model, the travel between its stops. Out: samples, extremes, places where a function stands still. It
//! must not know what the functions mean.
use crate::mechanism::curve::{Configuration, Scratch};
use crate::mechanism::motion::samples::positions;
use crate::mechanism::reduced::Reduced;
use crate::numerics::bracket::false_position;

/// Part of the distance between two samples to which a stationary place is located.
const CLOSE: f64 = 1e-13;
/// Part of its largest slope that the least slope of a function has that stands still nowhere.
const STEADY: f64 = 1e-6;
/// Golden sections of two intervals between samples, and their ratio.
const SECTIONS: usize = 60;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A travel between two values of sigma, counted on over whole revolutions, with the functions to be watched.
pub struct Walk<'a, F> {
    reduced: &'a Reduced,
    /// Both ends.
    pub ends: [f64; 2],
    /// Values of sigma, ascending.
    pub positions: Vec<f64>,
    /// Value and derivative along sigma of each function at each position.
    values: Vec<Vec<[f64; 2]>>,
    functions: F,
    scratch: Scratch,
    c: Configuration,
}

/// Extremes of a function over the travel.
#[derive(Clone, Debug, PartialEq)]
pub struct Extremes {
    /// Least and largest value.
    pub range: [f64; 2],
    /// Values of sigma within the travel where the function is stationary.
    pub stationary: Vec<f64>,
}

impl<'a, F: Fn(&Configuration, f64, &mut Vec<[f64; 2]>)> Walk<'a, F> {
    /// Sample functions over the travel: `functions` writes the value and derivative of each at a configuration after
    /// so many whole revolutions.
    pub fn new(reduced: &'a Reduced, ends: [f64; 2], functions: F) -> Self {
        let (scratch, c) = (Scratch::default(), Configuration::default());
        let values = Vec::new();
        let positions = positions(reduced, ends);
        let mut walk = Self { reduced, ends, positions: Vec::new(), values, functions, scratch, c };
        for &sigma in &positions {
            let values = walk.at(sigma);
            walk.values.push(values);
        }
        walk.positions = positions;
        walk
    }

    /// Value and derivative of each function at sigma.
    pub fn at(&mut self, sigma: f64) -> Vec<[f64; 2]> {
        let (on_curve, revolutions) = self.reduced.unwound(sigma);
        self.reduced.at(on_curve).curve().configure(on_curve, &mut self.scratch, &mut self.c);
        let mut values = Vec::new();
        (self.functions)(&self.c, revolutions, &mut values);
        values
    }

    /// Extremes of a function by its index, and of this natural size: one that changes by less than 1e-9 of that and of
    /// its value is stationary by rounding only.
    pub fn extremes(&mut self, function: usize, natural: f64) -> Extremes {
        let values: Vec<[f64; 2]> = self.values.iter().map(|values| values[function]).collect();
        let (mut range, mut stationary) = ([f64::INFINITY, f64::NEG_INFINITY], Vec::new());
        let mut widen = |value: f64| range = [range[0].min(value), range[1].max(value)];
        values.iter().for_each(|value| widen(value[0]));
        let largest = values.iter().fold(0.0, |most: f64, value| most.max(value[1].abs()));
        if range[1] - range[0] <= 1e-9 * (natural + range[1].abs()) {
            return Extremes { range, stationary };
        }
        let mut widen = |value: f64| range = [range[0].min(value), range[1].max(value)];
        for k in 1..values.len() {
            let [one, other] = [values[k - 1][1], values[k][1]];
            if one * other < 0.0 && one.abs().max(other.abs()) > 1e-9 * largest {
                let (sign, from, to) = (other.signum(), self.positions[k - 1], self.positions[k]);
                let slope = |sigma: f64| self.at(sigma)[function][1] * sign;
                let sigma = false_position(slope, (from, one * sign), (to, other * sign), CLOSE * (to - from));
                widen(self.at(sigma)[function][0]);
                stationary.push(sigma);
            }
        }
        Extremes { range, stationary }
    }

    /// The largest value of a function of sigma, and where it is: within the travel its peak.
    pub fn most(&self, function: impl Fn(f64) -> f64) -> (f64, f64) {
        let values = self.positions.iter().map(|&sigma| (function(sigma), sigma)).enumerate();
        let (k, most) = values
            .fold((0, (f64::NEG_INFINITY, self.ends[0])), |most, next| if next.1.0 > most.1.0 { next } else { most });
        if k == 0 || k + 1 >= self.positions.len() {
            return most;
        }
        // Golden sections.
        let [mut low, mut high] = [self.positions[k - 1], self.positions[k + 1]];
        for _ in 0..SECTIONS {
            let [a, b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
            if function(a) > function(b) { high = b } else { low = a }
        }
        let sigma = 0.5 * (low + high);
        (function(sigma).max(most.0), sigma)
    }

    /// The first of the first functions, so many, that stands still nowhere: its value names a position.
    pub fn steady(&self, functions: usize) -> Option<usize> {
        (0..functions).find(|&function| {
            let slopes = || self.values.iter().map(|values| values[function][1]);
            let [least, most] = slopes().map(f64::abs).fold([f64::INFINITY, 0.0], |[a, b], s| [s.min(a), s.max(b)]);
            least > STEADY * most && (slopes().all(|slope| slope > 0.0) || slopes().all(|slope| slope < 0.0))
        })
    }
}
