//! A part of the curve near a crossing of branches, as coordinates over x, and the x of least margin.
//!
//! The *margin* is the inverse of the amplification of rounding in the loop equations.
use crate::mechanism::closure::{Closure, Scratch, dot};

/// A part of the curve as coordinates over x, with the normal of the planes that it crosses.
pub(super) struct Course<'a> {
    pub closure: &'a Closure,
    pub normal: &'a [f64],
    pub coordinates: &'a dyn Fn(f64) -> Vec<f64>,
}

impl Course<'_> {
    /// Margin at x; 0 where the loop equations are singular to the last bit.
    pub(super) fn margin(&self, x: f64, scratch: &mut Scratch) -> f64 {
        let regular = self.closure.linearise(&(self.coordinates)(x), scratch);
        let amplification = if regular { self.closure.amplification(self.normal, scratch) } else { f64::INFINITY };
        1.0 / if amplification.is_nan() { f64::INFINITY } else { amplification }
    }

    /// x with the least margin between the outer two of three x. A solution of the loop equations has a pole at a
    /// crossing: the inverse of its component in a fixed direction, that of the solution at the middle x, changes sign
    /// there and is nearly linear.
    pub(super) fn least_margin(&self, [below, middle, above]: [f64; 3], scratch: &mut Scratch) -> f64 {
        // None at the crossing itself.
        let solve = |x: f64, scratch: &mut Scratch| {
            let regular = self.closure.linearise(&(self.coordinates)(x), scratch);
            regular.then(|| self.closure.probe(self.normal, scratch))
        };
        let Some(direction) = solve(middle, scratch) else { return middle };
        let mut signed = |x: f64| solve(x, scratch).map_or(0.0, |solution| 1.0 / dot(&solution, &direction));
        let (mut a, mut b) = (below, above);
        let (mut fa, mut fb) = (signed(a), signed(b));
        if fa * fb > 0.0 || (fa * fb).is_nan() {
            return minimise(&mut |x| self.margin(x, scratch), below, above);
        }
        // Regula falsi with the Illinois modification.
        for _ in 0..60 {
            let x = (a * fb - b * fa) / (fb - fa);
            let fx = signed(x);
            if fx == 0.0 || (x - b).abs() < 1e-13 {
                return x;
            }
            if fx * fb < 0.0 {
                (a, fa) = (b, fb);
            } else {
                fa *= 0.5;
            }
            (b, fb) = (x, fx);
        }
        b
    }
}

/// Minimum of a function in [a, b] by golden-section search.
fn minimise(f: &mut dyn FnMut(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (mut c, mut d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    while b - a > 1e-9 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - GOLDEN * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + GOLDEN * (b - a);
            fd = f(d);
        }
    }
    0.5 * (a + b)
}
