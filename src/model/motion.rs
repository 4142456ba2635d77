//! The motion along the curve: the right-hand side of the reduced model under constant inputs.
//!
//! sigma_ddot = sum of inputs times influences, because the reduced inertia is 1 and its derivative 0. On one panel this
//! is one polynomial: the inputs are folded into its coefficients when the panel is entered.
use crate::chebyshev::{NODES, Series};
use crate::integrator::System;
use crate::reduced::Reduced;
use crate::table::polynomial;

/// The right-hand side on the panel that was used last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// First and last sigma for which it holds; counted on over whole turns.
    low: f64,
    high: f64,
    center: f64,
    /// 2 / width of the panel.
    inverse: f64,
    series: Series,
}

impl Default for Drive {
    /// Holds nowhere.
    fn default() -> Self {
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY, center: 0.0, inverse: 0.0, series: [0.0; NODES] }
    }
}

impl Drive {
    /// Fold the inputs into the panel at sigma.
    #[cold]
    fn enter(&mut self, reduced: &Reduced, inputs: &[f64], sigma: f64) {
        let table = reduced.influence();
        let (first, last) = reduced.curve().range();
        let (mut low_end, mut high_end) = (None, None);
        let (shift, at) = match reduced.period() {
            Some(period) => {
                let shift = ((sigma - first) / period).floor() * period;
                (shift, sigma - shift)
            }
            None => {
                // Beyond an open end the force stays what it is at the end; the step is refused when it ends there.
                low_end = (sigma < first).then_some(first);
                high_end = (sigma > last).then_some(last);
                (0.0, sigma.clamp(first, last))
            }
        };
        let panel = table.panel(at);
        let (a, b) = table.borders(panel);
        let mut series = [0.0; NODES];
        for (load, size) in inputs.iter().enumerate() {
            for (sum, c) in series.iter_mut().zip(table.series(panel, load)) {
                *sum += size * c;
            }
        }
        *self = Self { low: a + shift, high: b + shift, center: 0.5 * (a + b) + shift, inverse: 2.0 / (b - a), series };
        for end in [low_end, high_end].into_iter().flatten() {
            let constant = polynomial(&self.series, (end - self.center) * self.inverse);
            self.series = [0.0; NODES];
            self.series[0] = constant;
            (self.low, self.high) = if low_end.is_some() { (f64::NEG_INFINITY, first) } else { (last, f64::INFINITY) };
        }
    }
}

/// The system (sigma, sigma_dot) for one span of constant inputs.
pub struct Motion<'a> {
    /// Tables.
    pub reduced: &'a Reduced,
    /// Sizes of the loads.
    pub inputs: &'a [f64],
    /// Right-hand side where it was used last.
    pub drive: &'a mut Drive,
    /// Length along the curve that the relative tolerance refers to.
    pub length: f64,
}

impl System<2> for Motion<'_> {
    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        let [sigma, sigma_dot] = *y;
        if !(self.drive.low <= sigma && sigma <= self.drive.high) {
            self.drive.enter(self.reduced, self.inputs, sigma);
        }
        [sigma_dot, polynomial(&self.drive.series, (sigma - self.drive.center) * self.drive.inverse)]
    }

    /// sigma to its length; sigma_dot to itself, or to the speed that the present force gives over that length.
    fn scale(&self, y: &[f64; 2], f: &[f64; 2]) -> [f64; 2] {
        let fallen = (f[1].abs() * self.length).sqrt();
        [self.length, y[1].abs().max(fallen).max(1e-12 * self.length)]
    }
}
