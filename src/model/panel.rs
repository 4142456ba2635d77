//! The right-hand side on the panel that was used last: the sizes of loads folded into its polynomials.
use crate::chebyshev::{NODES, Series};
use crate::number::Number;
use crate::reduced::{Reduced, Scene};
use crate::table::Table;

/// Rounding of a panel's border that is counted on over whole turns, relative to the numbers that are added up.
const BORDER: f64 = 8.0 * f64::EPSILON;

/// Sizes of everything that the state does not decide.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    /// Sizes of the sized loads.
    pub sizes: &'a [f64],
    /// Speed of the air [m/s].
    pub airspeed: f64,
    /// Whole turns before sigma = 0.
    pub turns: f64,
}

/// Forces of the sized loads and springs as polynomials on one panel: that along the curve, and where joints have friction,
/// their reactions.
#[derive(Clone, Debug)]
pub struct Folded {
    /// First sigma for which it holds, and the first for which it no longer does; counted on over whole turns.
    low: f64,
    high: f64,
    center: f64,
    /// 2 / width of the panel; 0 beyond an open end, where all stays what it is at the end.
    inverse: f64,
    /// x at the center.
    offset: f64,
    /// Place of the panel.
    pub panel: usize,
    /// Whole turns before this panel.
    pub turns: f64,
    /// Force along the curve.
    pub force: Series,
    /// Reactions of the scene's further rows.
    pub reactions: Vec<Series>,
}

impl Folded {
    /// Holds nowhere; with room for a scene.
    pub fn new(scene: Option<&Scene>) -> Self {
        let rows = scene.map_or(0, |s| s.rows.len() - 1);
        Self {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
            center: 0.0,
            inverse: 0.0,
            offset: 0.0,
            panel: 0,
            turns: 0.0,
            force: [0.0; NODES],
            reactions: vec![[0.0; NODES]; rows],
        }
    }

    /// Hold nowhere.
    pub fn forget(&mut self) {
        (self.low, self.high) = (f64::INFINITY, f64::NEG_INFINITY);
    }

    /// x on the panel at sigma, which is entered if it is another one.
    #[inline(always)]
    pub fn place(&mut self, reduced: &Reduced, scene: Option<&Scene>, given: &Given, sigma: f64) -> f64 {
        if !(self.low <= sigma && sigma < self.high) {
            self.enter(reduced, scene, given, sigma);
        }
        self.x(sigma)
    }

    /// x on the present panel at sigma, with derivatives if sigma has some.
    #[inline(always)]
    pub fn x<T: Number>(&self, sigma: T) -> T {
        sigma.chain(self.offset + (sigma.value() - self.center) * self.inverse, self.inverse)
    }

    #[cold]
    fn enter(&mut self, reduced: &Reduced, scene: Option<&Scene>, given: &Given, sigma: f64) {
        let table = scene.map_or(reduced.influence(), |s| &s.table);
        let (first, last) = reduced.curve().range();
        let (around, period) = match reduced.period() {
            Some(period) => (((sigma - first) / period).floor(), period),
            None => (0.0, 0.0),
        };
        let shift = around * period;
        self.panel = table.panel(sigma - shift);
        self.turns = given.turns + around;
        let (a, b) = table.borders(self.panel);
        (self.low, self.high, self.center, self.inverse) = (a + shift, b + shift, 0.5 * (a + b) + shift, 2.0 / (b - a));
        if reduced.period().is_some() {
            // Within rounding of its borders, which panel it is depends on how whole turns are counted: there it is asked
            // anew, so that the answer never depends on the panel before.
            let margin = BORDER * (first.abs().max(last.abs()) + shift.abs() + period);
            (self.low, self.high) = (self.low + margin, self.high - margin);
        }
        self.offset = 0.0;
        if reduced.period().is_none() && !(first..last).contains(&sigma) {
            // Beyond an open end; a step that ends there is refused.
            (self.inverse, self.offset) = (0.0, if sigma < first { -1.0 } else { 1.0 });
            (self.low, self.high) = if sigma < first { (f64::NEG_INFINITY, first) } else { (last, f64::INFINITY) };
        }
        match scene {
            None => self.force = self.fold(reduced, None, table, given, 0),
            Some(scene) => {
                self.force = self.fold(reduced, Some(scene), table, given, 0);
                for row in 1..scene.rows.len() {
                    self.reactions[row - 1] = self.fold(reduced, Some(scene), table, given, row);
                }
            }
        }
    }

    fn fold(&self, reduced: &Reduced, scene: Option<&Scene>, table: &Table, given: &Given, row: usize) -> Series {
        let components = reduced.components();
        let at = |k: usize| scene.map_or(k, |s| s.given(row, k));
        let mut sum = [0.0; NODES];
        let mut add = |k: usize, size: f64| {
            for (sum, c) in sum.iter_mut().zip(table.series(self.panel, at(k))) {
                *sum += size * c;
            }
        };
        for (load, size) in given.sizes.iter().enumerate() {
            if *size != 0.0 && !scene.is_some_and(|s| s.lossy.contains(&load)) {
                add(load, *size);
            }
        }
        components.springs.into_iter().for_each(|k| add(k, 1.0));
        components.winding.into_iter().for_each(|k| add(k, self.turns));
        sum
    }
}
