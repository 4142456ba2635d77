//! The exact evaluator: one configuration with its derivatives along the curve.
use super::{Curve, panel::twice_kinetic};
use crate::mechanism::closure::{self, Closure, Factors};
use crate::mechanism::linkage::{Linkage, Point, Positions, Rates};
use crate::numerics::chebyshev::polynomial;

/// Where rounding is amplified this many times as much as at best in a panel, its series are more accurate than its loop
/// equations.
const NEAR: f64 = 8.0;
/// Below this amplification the loop equations are accurate enough.
const HARMLESS: f64 = 30.0;

/// Where the linkage is at one sigma, and how it moves along the curve.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// The independent loop equations linearised, and whether they have full rank to the last bit.
    factors: Factors,
    regular: bool,
}

/// Room for one configuration after another.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    /// The loop equations.
    pub(super) loops: closure::Workspace,
    /// Values of all loop equations.
    gaps: Vec<f64>,
}

impl Configuration {
    /// The independent loop equations linearised; none where they lose rank to the last bit.
    pub fn factors(&self) -> Option<&Factors> {
        self.regular.then_some(&self.factors)
    }

    /// The first derivatives, from a direction along the curve in `q_sigma`, to unit speed.
    fn set_out(&mut self, linkage: &Linkage) -> f64 {
        linkage.move_at(&self.positions, &self.q, &self.q_sigma, &mut self.rates);
        let speed = twice_kinetic(linkage, &self.positions, &self.rates).sqrt();
        self.q_sigma.iter_mut().chain(&mut self.rates.angle).for_each(|v| *v /= speed);
        self.rates.origin.iter_mut().for_each(|v| *v /= speed);
        speed
    }

    /// The second derivatives, of which `q_second` holds all but the part along the curve: T stays 1/2 along it, and that
    /// part follows from sum m v . a + I omega alpha = 0.
    fn bend(&mut self, linkage: &Linkage) {
        linkage.accelerate(&self.positions, &self.rates, [&self.q, &self.q_sigma, &self.q_second], &mut self.second);
        let along = kinetic_product(linkage, &self.positions, &self.rates, &self.second);
        for (second, first) in self.q_second.iter_mut().zip(&self.q_sigma) {
            *second -= along * first;
        }
        for (second, first) in self.second.angle.iter_mut().zip(&self.rates.angle) {
            *second -= along * first;
        }
        for (second, first) in self.second.origin.iter_mut().zip(&self.rates.origin) {
            *second -= along * first;
        }
    }

    /// Derivatives along the curve at the coordinates `q` and their positions, where the loop equations have been
    /// linearised; the curve leads along `normal`. Returns the speed d sigma / d u of motion across its planes.
    pub(super) fn derive(&mut self, closure: &Closure, normal: &[f64], work: &mut Workspace) -> f64 {
        let linkage = &*closure.linkage;
        let factors = &work.loops.factors;
        factors.tangent(normal, 1.0, &mut self.q_sigma);
        let speed = self.set_out(linkage);
        // Second derivatives of the gaps must vanish: J q'' = -bias.
        self.q_second.clear();
        self.q_second.resize(self.q.len(), 0.0);
        linkage.accelerate(&self.positions, &self.rates, [&self.q, &self.q_sigma, &self.q_second], &mut self.second);
        linkage.gap_second_rates(&self.positions, &self.rates, &self.second, &mut work.gaps);
        let rows = closure.rows().iter().map(|&r| [-work.gaps[r]]);
        factors.solve(rows, normal, [0.0], self.q_second.as_chunks_mut().0);
        self.bend(linkage);
        speed
    }
}

impl Curve {
    /// The configuration at sigma, within the curve's range: loops closed by Newton's method, the tangent from the null
    /// vector of the loop Jacobian, the curvature from the second derivatives of the loop equations and from T = 1/2.
    pub fn configuration(&self, sigma: f64) -> Configuration {
        let mut c = Configuration::default();
        self.configure(sigma, &mut Workspace::default(), &mut c);
        c
    }

    /// As [`Self::configuration`], in place.
    pub fn configure(&self, sigma: f64, work: &mut Workspace, c: &mut Configuration) {
        let (first, last) = self.traced();
        c.sigma = sigma.clamp(first, last);
        let place = self.panels.partition_point(|p| p.start <= c.sigma).max(1) - 1;
        let panel = &self.panels[place];
        let (closure, linkage) = (&self.closure, &*self.closure.linkage);
        let x = panel.x_at(c.sigma);
        panel.place(x, &mut c.q);
        // Close the loops again and differentiate their equations, unless a crossing is so near that this would amplify
        // rounding: there the panel's series, whose nodes lie farther from it, are the better evaluator.
        let landing = closure.on_plane(&mut work.loops, &mut c.q, &panel.base, &panel.normal, panel.u_at(x));
        let most = HARMLESS.max(NEAR * panel.amplification);
        if let Some(landing) = landing.filter(|l| l.amplification < most) {
            closure.place(landing, &c.q, &mut work.loops, &mut c.positions);
            c.derive(closure, &panel.normal, work);
            c.amplification = landing.amplification;
            c.regular = true;
            std::mem::swap(&mut c.factors, &mut work.loops.factors);
            return;
        }
        panel.place(x, &mut c.q);
        linkage.place(&c.q, &mut c.positions);
        if panel.derivatives.is_empty() {
            c.q_sigma = panel.slopes_at(x);
            let speed = c.set_out(linkage);
            c.q_second = panel.curvatures_at(x);
            c.q_second.iter_mut().for_each(|v| *v /= speed * speed);
        } else {
            // Along sigma already, but for rounding.
            (c.q_sigma, c.q_second) =
                panel.derivatives.iter().map(|[f, s]| (polynomial(f, x), polynomial(s, x))).unzip();
            c.set_out(linkage);
        }
        c.bend(linkage);
        c.amplification = f64::INFINITY;
        c.regular = closure.linearise(&c.q, &mut work.loops);
        std::mem::swap(&mut c.factors, &mut work.loops.factors);
    }
}

/// sum of m v . a + I omega alpha.
fn kinetic_product(linkage: &Linkage, p: &Positions, r: &Rates, a: &Rates) -> f64 {
    let mut sum = 0.0;
    for (i, body) in linkage.bodies.iter().enumerate().skip(1) {
        let point = Point { body: i, local: body.center };
        let [_, v, acceleration] = p.motion(r, a, point);
        sum += body.mass * v.dot(&acceleration) + body.inertia * r.angle[i] * a.angle[i];
    }
    sum
}
