//! One configuration with its derivatives along the curve.
//!
//! In: closed coordinates, linearised loop equations. Out: two derivatives along sigma. It must not know panels.
use super::kinetic::{kinetic_product, twice_kinetic};
use crate::mechanism::closure::{self, Closure, Factors};
use crate::mechanism::linkage::{Linkage, Positions, Rates};

/// Positions of the linkage at one sigma, with their derivatives along the curve.
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
    /// Positions of the bodies.
    pub positions: Positions,
    /// First derivatives of the positions along sigma.
    pub rates: Rates,
    /// Second derivatives of the positions along sigma.
    pub second: Rates,
    /// Factor by which a rounding error in the loop equations is amplified in `q_sigma`, and twice in `q_second`.
    pub amplification: f64,
    /// Factors of the independent loop equations; valid if `regular`.
    pub(super) factors: Factors,
    /// Whether the independent loop equations have full rank to the last bit.
    pub(super) regular: bool,
}

/// Scratch for one configuration after another.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// Scratch for the loop equations.
    pub(super) loops: closure::Scratch,
    /// Second derivatives of all loop equations.
    gaps: Vec<f64>,
    /// Part of the second derivatives of the positions that is linear in those of the coordinates.
    linear: Rates,
}

impl Scratch {
    /// Number of positions closed so far.
    pub fn closed(&self) -> usize {
        self.loops.closed
    }
}

impl Configuration {
    /// Factors of the independent loop equations; None where these lose rank to the last bit.
    pub fn factors(&self) -> Option<&Factors> {
        self.regular.then_some(&self.factors)
    }

    /// First derivatives for a direction `q_sigma` along the curve, scaled to T = 1/2. Returns the speed before
    /// scaling.
    pub(super) fn scale_rates(&mut self, linkage: &Linkage) -> f64 {
        linkage.rates_into(&self.positions, &self.q, &self.q_sigma, &mut self.rates);
        let speed = twice_kinetic(linkage, &self.positions, &self.rates).sqrt();
        self.q_sigma.iter_mut().chain(&mut self.rates.angle).for_each(|v| *v /= speed);
        self.rates.origin.iter_mut().for_each(|v| *v /= speed);
        speed
    }

    /// Second derivatives for a `q_second` without the right component along the curve. T = 1/2 all along the curve, so
    /// sum m v . a + I omega alpha = 0 determines this component.
    pub(super) fn project_curvature(&mut self, linkage: &Linkage) {
        let derivatives = [&self.q[..], &self.q_sigma, &self.q_second];
        linkage.second_rates_into(&self.positions, &self.rates, derivatives, &mut self.second);
        self.project(linkage);
    }

    /// [`Self::project_curvature`] with the second derivatives of the positions for this `q_second`.
    fn project(&mut self, linkage: &Linkage) {
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

    /// Derivatives along the curve at the coordinates `q`, with the loop equations linearised in `scratch`. sigma grows
    /// along `normal`. Returns the speed d sigma / d u of motion across the planes with this normal.
    pub(super) fn derive(&mut self, closure: &Closure, normal: &[f64], scratch: &mut Scratch) -> f64 {
        let linkage = &*closure.linkage;
        let factors = &scratch.loops.factors;
        factors.tangent(normal, 1.0, &mut self.q_sigma);
        let speed = self.scale_rates(linkage);
        // The second derivatives of the gaps vanish: J q'' = -(their value at q'' = 0).
        self.q_second.clear();
        self.q_second.resize(self.q.len(), 0.0);
        let derivatives = [&self.q[..], &self.q_sigma, &self.q_second];
        linkage.second_rates_into(&self.positions, &self.rates, derivatives, &mut self.second);
        let (rates, of_coordinates) = ((&self.rates, &self.second), [&self.q_sigma[..], &self.q_second]);
        linkage.gap_second_rates(&self.positions, rates, of_coordinates, &mut scratch.gaps);
        let rows = closure.rows().iter().map(|&r| [-scratch.gaps[r]]);
        factors.solve(rows, normal, [0.0], self.q_second.as_chunks_mut().0);
        // The second derivatives of the positions are affine functions of q''.
        linkage.rates_into(&self.positions, &self.q, &self.q_second, &mut scratch.linear);
        self.second.add(&scratch.linear);
        self.project(linkage);
        speed
    }
}
