//! The exact evaluator: one configuration with its derivatives along the curve.
use super::{Curve, panel::twice_kinetic};
use crate::linkage::{Point, Positions, Rates};

/// Where rounding is amplified this many times as much as at best in a panel, its series are more accurate than its loop
/// equations.
const NEAR: f64 = 8.0;
/// Below this amplification the loop equations are accurate enough.
const HARMLESS: f64 = 30.0;

/// Where the linkage is at one sigma, and how it moves along the curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Length along the curve.
    pub sigma: f64,
    /// Coordinates q [rad, then m].
    pub q: Vec<f64>,
    /// dq / d sigma.
    pub q_sigma: Vec<f64>,
    /// d2q / d sigma2.
    pub q_second: Vec<f64>,
    /// Where the bodies are.
    pub positions: Positions,
    /// First derivatives along sigma.
    pub rates: Rates,
    /// Second derivatives along sigma.
    pub second: Rates,
    /// How much a rounding error in the loops is amplified in q_sigma; in q_second twice.
    pub amplification: f64,
}

impl Curve {
    /// The configuration at sigma, within the curve's range: loops closed by Newton's method, the tangent from the null
    /// vector of the loop Jacobian, the curvature from the second derivatives of the loop equations and from T = 1/2.
    pub fn configuration(&self, sigma: f64) -> Configuration {
        let (first, last) = self.range();
        let sigma = sigma.clamp(first, last);
        let place = self.panels.partition_point(|p| p.start <= sigma).max(1) - 1;
        let panel = &self.panels[place];
        let (closure, linkage) = (&self.closure, &*self.closure.linkage);
        let x = panel.x_at(sigma);
        let mut q = panel.series_at(x);
        let n = q.len();
        // Close the loops again and differentiate their equations, unless a crossing is so near that this would amplify
        // rounding: there the panel's series, whose nodes lie farther from it, are the better evaluator.
        let closed = closure.on_plane(&q, &panel.base, &panel.normal, panel.u_at(x));
        let closed =
            closed.filter(|(_, bordered, _)| bordered.amplification < HARMLESS.max(NEAR * panel.amplification));
        let at_crossing = closed.is_none();
        if let Some((closer, ..)) = closed {
            q = closer;
        }
        let positions = linkage.positions(&q);
        let bordered = if at_crossing { None } else { closure.bordered(&positions, &q, &panel.normal) };
        let solve = |gaps: &[f64], along: f64| bordered.as_ref().and_then(|b| b.solve(gaps, along));
        let mut q_sigma = solve(&vec![0.0; n - 1], 1.0).unwrap_or_else(|| panel.slopes_at(x));
        let speed = twice_kinetic(linkage, &positions, &linkage.rates(&positions, &q, &q_sigma)).sqrt();
        q_sigma.iter_mut().for_each(|v| *v /= speed);
        let rates = linkage.rates(&positions, &q, &q_sigma);
        // Second derivatives of the gaps must vanish: J q'' = -bias.
        let still = linkage.second_rates(&positions, &rates, &q, &q_sigma, &vec![0.0; n]);
        let bias: Vec<f64> =
            closure.pick(&linkage.gap_second_rates(&positions, &rates, &still)).iter().map(|b| -b).collect();
        let mut q_second =
            solve(&bias, 0.0).unwrap_or_else(|| panel.curvatures_at(x).iter().map(|c| c / (speed * speed)).collect());
        // T stays 1/2 along the curve: the part along the tangent follows from sum m v . a + I omega alpha = 0.
        let partial = linkage.second_rates(&positions, &rates, &q, &q_sigma, &q_second);
        let along = self.kinetic_product(&positions, &rates, &partial);
        for (second, first) in q_second.iter_mut().zip(&q_sigma) {
            *second -= along * first;
        }
        let second = linkage.second_rates(&positions, &rates, &q, &q_sigma, &q_second);
        let amplification = bordered.as_ref().map_or(f64::INFINITY, |b| b.amplification);
        Configuration { sigma, q, q_sigma, q_second, positions, rates, second, amplification }
    }

    /// sum of m v . a + I omega alpha.
    fn kinetic_product(&self, p: &Positions, r: &Rates, a: &Rates) -> f64 {
        let bodies = &self.closure.linkage.bodies;
        let mut sum = 0.0;
        for (i, body) in bodies.iter().enumerate().skip(1) {
            let point = Point { body: i, local: body.center };
            sum += body.mass * p.velocity(r, point).dot(&p.acceleration(r, a, point))
                + body.inertia * r.angle[i] * a.angle[i];
        }
        sum
    }
}
