//! The motion along the curve: the right-hand side of the reduced model under constant inputs.
//!
//! sigma_ddot = sum of sizes times influences, because the reduced inertia is 1 and its derivative 0. On one panel this
//! is one polynomial: the sizes are folded into its coefficients when the panel is entered. Dampers add a second one,
//! drives with an efficiency one each; a mechanism without them does not pay for them.
use crate::chebyshev::{NODES, Series};
use crate::integrator::{Dense, IntegrationError, Integrator, Statistics, System};
use crate::reduced::Reduced;
use crate::table::polynomial;

/// The right-hand side on the panel that was used last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Folded {
    /// First and last sigma for which it holds; counted on over whole turns.
    low: f64,
    high: f64,
    center: f64,
    /// 2 / width of the panel.
    inverse: f64,
    /// Place of the panel.
    panel: usize,
    /// Force of all sized loads and springs.
    force: Series,
    /// Force of the dampers for each unit of sigma_dot.
    damping: Series,
}

impl Default for Folded {
    /// Holds nowhere.
    fn default() -> Self {
        let none = [0.0; NODES];
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { low, high, center: 0.0, inverse: 0.0, panel: 0, force: none, damping: none }
    }
}

impl Folded {
    /// Fold the sizes into the panel at sigma; `turns` have been made before.
    #[cold]
    fn enter(&mut self, reduced: &Reduced, sizes: &[f64], turns: f64, sigma: f64) {
        let table = reduced.influence();
        let components = reduced.components();
        let (first, last) = reduced.curve().range();
        let (around, period) = match reduced.period() {
            Some(period) => (((sigma - first) / period).floor(), period),
            None => (0.0, 0.0),
        };
        let shift = around * period;
        let panel = table.panel(sigma - shift);
        let (a, b) = table.borders(panel);
        let mut force = [0.0; NODES];
        let mut add = |component: usize, size: f64| {
            for (sum, c) in force.iter_mut().zip(table.series(panel, component)) {
                *sum += size * c;
            }
        };
        sizes.iter().enumerate().for_each(|(load, size)| add(load, *size));
        components.springs.into_iter().for_each(|k| add(k, 1.0));
        components.winding.into_iter().for_each(|k| add(k, turns + around));
        let damping = components.damping.map_or([0.0; NODES], |k| *table.series(panel, k));
        let center = 0.5 * (a + b) + shift;
        *self = Self { low: a + shift, high: b + shift, center, inverse: 2.0 / (b - a), panel, force, damping };
        // Beyond an open end the forces stay what they are at the end; a step that ends there is refused.
        if reduced.period().is_none() && !(first..=last).contains(&sigma) {
            let end = if sigma < first { first } else { last };
            let x = (end - center) * self.inverse;
            for series in [&mut self.force, &mut self.damping] {
                let constant = polynomial(series, x);
                *series = [0.0; NODES];
                series[0] = constant;
            }
            (self.low, self.high) = if sigma < first { (f64::NEG_INFINITY, first) } else { (last, f64::INFINITY) };
        }
    }
}

/// The motion for one span of constant inputs.
pub struct Motion<'a> {
    /// Tables.
    pub reduced: &'a Reduced,
    /// Sizes of the sized loads.
    pub sizes: &'a [f64],
    /// Whole turns before sigma = 0.
    pub turns: f64,
    /// Right-hand side where it was used last.
    pub folded: &'a mut Folded,
}

impl Motion<'_> {
    /// x on the panel at sigma.
    fn place(&mut self, sigma: f64) -> f64 {
        if !(self.folded.low <= sigma && sigma <= self.folded.high) {
            self.folded.enter(self.reduced, self.sizes, self.turns, sigma);
        }
        (sigma - self.folded.center) * self.folded.inverse
    }

    /// sigma to its length; sigma_dot to itself, or to the speed that the present force gives over that length.
    fn scales(&self, sigma_dot: f64, acceleration: f64) -> (f64, f64) {
        let length = self.reduced.scale();
        let fallen = (acceleration.abs() * length).sqrt();
        (length, sigma_dot.abs().max(fallen).max(1e-12 * length))
    }

    /// sigma_ddot, and the power that dampers and drives lose, for a motion in this direction.
    fn lossy(&mut self, sigma: f64, sigma_dot: f64, direction: f64) -> (f64, f64) {
        let x = self.place(sigma);
        let drag = polynomial(&self.folded.damping, x) * sigma_dot;
        let (mut force, mut lost) = (polynomial(&self.folded.force, x) - drag, drag * sigma_dot);
        let table = self.reduced.influence();
        for (load, drive) in self.reduced.loading().drives.iter().enumerate() {
            if let Some(efficiency) = drive.efficiency {
                let influence = polynomial(table.series(self.folded.panel, load), x);
                let full = self.sizes[load] * influence;
                let less = full - effective(full, direction, efficiency);
                force -= less;
                lost += less * sigma_dot;
            }
        }
        (force, lost)
    }

    /// Direction in which a mechanism at rest sets off: 0 if its drives hold it ([CK16] 2.3: driven forward they give
    /// less, driven back they hold more).
    fn direction_from_rest(&mut self, sigma: f64) -> f64 {
        if self.lossy(sigma, 0.0, 1.0).0 > 0.0 {
            1.0
        } else if self.lossy(sigma, 0.0, -1.0).0 < 0.0 {
            -1.0
        } else {
            0.0
        }
    }

    /// 1 in forward motion, 0 in backward motion. Where the drives hold the mechanism at rest, each lets arrive something
    /// between its forward and its backward value: the common share at which all is in balance.
    pub fn forward_share(&mut self, sigma: f64, sigma_dot: f64) -> f64 {
        let direction = if sigma_dot == 0.0 { self.direction_from_rest(sigma) } else { sigma_dot };
        if direction != 0.0 {
            return if direction > 0.0 { 1.0 } else { 0.0 };
        }
        let (forward, back) = (self.lossy(sigma, 0.0, 1.0).0, self.lossy(sigma, 0.0, -1.0).0);
        if back > forward { back / (back - forward) } else { 1.0 }
    }

    /// sigma_ddot at any state.
    pub fn acceleration(&mut self, sigma: f64, sigma_dot: f64) -> f64 {
        if !self.reduced.loses_power() {
            let x = self.place(sigma);
            return polynomial(&self.folded.force, x);
        }
        let direction = if sigma_dot == 0.0 { self.direction_from_rest(sigma) } else { sigma_dot.signum() };
        if direction == 0.0 { 0.0 } else { self.lossy(sigma, sigma_dot, direction).0 }
    }
}

/// [CK16] eqs. (5), (29): what arrives of a drive's force `full` (times its influence) when the motion has this
/// direction: the part eta where power flows in, 1/eta where it flows back.
pub fn effective(full: f64, direction: f64, efficiency: f64) -> f64 {
    if full * direction > 0.0 { full * efficiency } else { full / efficiency }
}

impl System<2> for Motion<'_> {
    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        let x = self.place(y[0]);
        [y[1], polynomial(&self.folded.force, x)]
    }

    fn scale(&self, y: &[f64; 2], f: &[f64; 2]) -> [f64; 2] {
        let (length, speed) = self.scales(y[1], f[1]);
        [length, speed]
    }
}

/// A motion that loses power: (sigma, sigma_dot, energy lost).
struct Lossy<'a, 'b> {
    motion: &'a mut Motion<'b>,
    /// Sign of sigma_dot; it holds until sigma_dot passes through 0.
    direction: f64,
}

impl System<3> for Lossy<'_, '_> {
    fn derivative(&mut self, _t: f64, y: &[f64; 3]) -> [f64; 3] {
        let (force, lost) = self.motion.lossy(y[0], y[1], self.direction);
        [y[1], force, lost]
    }

    fn scale(&self, y: &[f64; 3], f: &[f64; 3]) -> [f64; 3] {
        let (length, speed) = self.motion.scales(y[1], f[1]);
        [length, speed, speed * speed]
    }
}

/// Memory of the integration.
#[derive(Clone, Copy, Debug)]
pub enum Memory {
    /// No power is lost: the state is (sigma, sigma_dot).
    Conservative(Integrator<2>),
    /// The energy lost is integrated too.
    Lossy(Integrator<3>),
}

impl Memory {
    /// For a mechanism.
    pub fn new(reduced: &Reduced) -> Self {
        if reduced.loses_power() {
            Self::Lossy(Integrator::default())
        } else {
            Self::Conservative(Integrator::default())
        }
    }

    /// The right-hand side has changed.
    pub fn refresh(&mut self) {
        match self {
            Self::Conservative(i) => i.refresh(),
            Self::Lossy(i) => i.refresh(),
        }
    }

    /// Work done so far.
    pub fn statistics(&self) -> Statistics {
        match self {
            Self::Conservative(i) => i.statistics(),
            Self::Lossy(i) => i.statistics(),
        }
    }

    /// Advance (sigma, sigma_dot) by exactly `span`; the energy lost on the way.
    ///
    /// # Errors
    /// [`IntegrationError`].
    pub fn advance(
        &mut self,
        motion: &mut Motion,
        y: &mut [f64; 2],
        span: f64,
        tolerance: f64,
    ) -> Result<f64, IntegrationError> {
        match self {
            Self::Conservative(integrator) => integrator.advance(motion, y, span, tolerance).map(|()| 0.0),
            Self::Lossy(integrator) => {
                let mut z = [y[0], y[1], 0.0];
                if motion.reduced.has_efficiency() {
                    with_reversals(integrator, motion, &mut z, span, tolerance)?;
                } else {
                    integrator.advance(&mut Lossy { motion, direction: 1.0 }, &mut z, span, tolerance)?;
                }
                *y = [z[0], z[1]];
                Ok(z[2])
            }
        }
    }
}

/// Drives with an efficiency: the right-hand side jumps where sigma_dot changes its sign, so steps end there.
fn with_reversals(
    integrator: &mut Integrator<3>,
    motion: &mut Motion,
    z: &mut [f64; 3],
    span: f64,
    tolerance: f64,
) -> Result<(), IntegrationError> {
    let mut t = 0.0;
    while t < span {
        let direction = if z[1] == 0.0 { motion.direction_from_rest(z[0]) } else { z[1].signum() };
        if direction == 0.0 {
            return Ok(());
        }
        let mut system = Lossy { motion, direction };
        let step = integrator.step(&mut system, t, z, span, tolerance)?;
        if step.end[1] * direction < 0.0 {
            let dense = step.dense(&mut system);
            let s = reversal(&dense, direction);
            *z = dense.at(s);
            z[1] = 0.0;
            t += s * step.h;
            integrator.restart();
            continue;
        }
        *z = step.end;
        t += step.h;
        if step.reached {
            break;
        }
    }
    Ok(())
}

/// Part of the step after which sigma_dot has changed its sign: bisection.
fn reversal(dense: &Dense<3>, direction: f64) -> f64 {
    let (mut a, mut b) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if dense.at(middle)[1] * direction > 0.0 { a = middle } else { b = middle }
    }
    b
}
