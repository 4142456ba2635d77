//! Assembly: coordinates that close every loop, and the tangent of the curve of closed positions.
//!
//! In: a linkage and a guess. Out: closed coordinates, the independent loop equations, and Newton's method on a plane
//! across the curve of closed positions. It must not know loads or time.
mod assembly;
mod error;
mod factors;

pub use assembly::{guessed, straight};
pub use error::AssemblyError;
pub use factors::{Factors, dot};

use crate::mechanism::linkage::{Linkage, Positions};
use crate::numerics::decimal::Decimal;
use crate::numerics::twofold::Twofold;
use assembly::{FLAT, RANK, close, independent_rows, rank, scaled_jacobian};
use std::sync::Arc;

/// Position of a prismatic joint, in sizes of the linkage, up to which its rounding is no more than that of Newton's
/// method.
const NEAR: f64 = 100.0;
/// Singular values below this part of the largest count as zero a little way off a crossing.
const OFF_CROSSING: f64 = 1e-5;

/// The loop equations of a linkage with one degree of freedom.
#[derive(Clone, Debug)]
pub struct Closure {
    /// Linkage.
    pub linkage: Arc<Linkage>,
    /// Indices of the independent loop equations, one fewer than coordinates.
    rows: Vec<usize>,
    /// Two gaps of each independent loop equation that probe the amplification [m].
    probes: Vec<[f64; 2]>,
    /// Weights that make coordinates comparable: 1 for an angle, 1/size for a length [1/m].
    pub weights: Vec<f64>,
}

/// Scratch for the loop equations at one position after another.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// Positions of the bodies at the coordinates of the last linearisation.
    pub positions: Positions,
    /// Factors of the independent loop equations, linearised at these coordinates.
    pub factors: Factors,
    /// Number of positions that were to be closed on a plane.
    pub closed: usize,
    /// Residuals of all loop equations [m].
    gaps: Vec<f64>,
    /// Changes of coordinates: Newton's correction and two probes of the amplification.
    steps: Vec<[f64; 3]>,
    /// Rows of one loop.
    partials: [Vec<f64>; 2],
}

/// Convergence of Newton's method to a closed position on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// Amplification of rounding in a gap: largest entry of a rough inverse of the loop equations.
    pub amplification: f64,
    /// Weighted size of the first correction.
    pub first: f64,
}

/// Weights that make coordinates comparable.
fn weights(linkage: &Linkage) -> Vec<f64> {
    (0..linkage.coordinates.len()).map(|i| if i < linkage.angles { 1.0 } else { 1.0 / linkage.size }).collect()
}

/// Rounding of the loop equations far from the origin, relative to that near it: positions of prismatic joints are sums
/// in the bodies' positions.
fn rounding_at(q: &[f64], angles: usize, w: &[f64]) -> f64 {
    q.iter().zip(w).skip(angles).fold(1.0, |most: f64, (s, w)| most.max((s * w).abs() / NEAR))
}

/// Two sizes for the independent loop equation with index `i`, of either sign. The signs tell two loops apart; beyond,
/// sizes follow no pattern, as the gaps that are amplified may: the same ones in two loops with opposite signs, say.
fn probes(i: usize) -> [f64; 2] {
    let size = if i < 4 { 1.0 } else { 1.25 + 0.25 * (1.0 + 3.7 * i as f64).sin() };
    [0, 1].map(|k| if (i >> k).is_multiple_of(2) { size } else { -size })
}

impl Closure {
    /// Close the loops from a guess and choose the independent loop equations. Returns the closed coordinates too.
    ///
    /// # Errors
    /// [`AssemblyError`]: the loops stay open, the number of degrees of freedom is not one, or two branches cross here.
    pub fn assemble(linkage: Arc<Linkage>, guess: &[f64]) -> Result<(Self, Vec<f64>), AssemblyError> {
        let w = weights(&linkage);
        let n = w.len();
        if n == 0 {
            return Err(AssemblyError::Freedom { count: 0 });
        }
        let q = close(&linkage, guess, &w)?;
        let j = scaled_jacobian(&linkage, &linkage.positions(&q), &q, &w);
        let freedom = n - rank(&j, RANK);
        if freedom != 1 {
            if let Some(error) = straight(&linkage, FLAT) {
                return Err(error);
            }
            // Branches cross here if there is one degree of freedom a little way off, in an arbitrary fixed direction.
            let off: Vec<f64> = (0..n).map(|i| q[i] + 0.02 * (1.0 + 3.7 * i as f64).sin() / w[i]).collect();
            if freedom > 1
                && let Ok(near) = close(&linkage, &off, &w)
            {
                let j = scaled_jacobian(&linkage, &linkage.positions(&near), &near, &w);
                // Off a crossing the loops are far from losing rank; elsewhere this is the rounding of a second motion.
                if n - rank(&j, OFF_CROSSING) == 1 {
                    return Err(AssemblyError::Crossing);
                }
            }
            return Err(AssemblyError::Freedom { count: freedom });
        }
        Ok((Self::of_independent(linkage, independent_rows(&j, n - 1), w), q))
    }

    /// The loop equations of which those with these indices are independent, as [`Self::assemble`] has found them; None
    /// if they are none of this linkage.
    pub fn of_rows(linkage: Arc<Linkage>, rows: Vec<usize>) -> Option<Self> {
        let w = weights(&linkage);
        let ascending = rows.windows(2).all(|pair| pair[0] < pair[1]);
        let are_own = ascending && rows.len() + 1 == w.len() && rows.last().is_none_or(|last| *last < linkage.rows());
        are_own.then(|| Self::of_independent(linkage, rows, w))
    }

    fn of_independent(linkage: Arc<Linkage>, rows: Vec<usize>, weights: Vec<f64>) -> Self {
        let probes = (0..rows.len()).map(|i| probes(i).map(|gap| gap * linkage.size)).collect();
        Self { linkage, rows, probes, weights }
    }

    /// Whether some loop equations depend on others.
    pub fn redundant(&self) -> bool {
        self.rows.len() < self.linkage.rows()
    }

    /// Whether all loop equations together leave more than one degree of freedom at `q`, which is accurate to 1e-6 of
    /// it.
    pub fn loses_rank(&self, q: &[f64]) -> bool {
        const ACCURACY: f64 = 1e-6;
        let j = scaled_jacobian(&self.linkage, &self.linkage.positions(q), q, &self.weights);
        rank(&j, ACCURACY) + 1 < q.len()
    }

    /// Indices of the independent loop equations.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Linearise the independent loop equations at `q`. False where they lose rank to the last bit.
    pub fn linearise(&self, q: &[f64], scratch: &mut Scratch) -> bool {
        self.linkage.update_positions(q, &mut scratch.positions);
        self.factorise(q, scratch)
    }

    /// [`Self::linearise`] with the positions at `q`.
    fn factorise(&self, q: &[f64], scratch: &mut Scratch) -> bool {
        let linkage = &*self.linkage;
        scratch.factors.clear(q.len());
        let (mut row, mut kept) = (0, self.rows.iter().peekable());
        for (index, &joint) in linkage.cuts.iter().enumerate() {
            linkage.partials(&scratch.positions, q, index, &mut scratch.partials);
            for partials in &scratch.partials[..linkage.joints[joint].freedom.rows()] {
                if kept.next_if(|r| **r == row).is_some() {
                    let columns = &linkage.loops[index].columns;
                    let is_independent = if columns.len() == q.len() {
                        scratch.factors.push_whole(partials, &self.weights)
                    } else {
                        scratch.factors.push(columns.iter().copied().zip(partials.iter().copied()), &self.weights)
                    };
                    if !is_independent {
                        return false;
                    }
                }
                row += 1;
            }
        }
        scratch.factors.finish()
    }

    /// Amplification of rounding in a gap in solutions on planes with this normal: the largest entry of two solutions.
    pub fn amplification(&self, normal: &[f64], scratch: &mut Scratch) -> f64 {
        scratch.steps.resize(normal.len(), [0.0; 3]);
        let rows = self.probes.iter().map(|[a, b]| [0.0, *a, *b]);
        scratch.factors.solve(rows, normal, [0.0; 3], &mut scratch.steps);
        let [_, a, b] = self.sizes(&scratch.steps);
        a.max(b)
    }

    /// A solution on a plane with this normal, for gaps that are no special combination of loops.
    pub fn probe(&self, normal: &[f64], scratch: &Scratch) -> Vec<f64> {
        let mut out = vec![0.0; normal.len()];
        let rows = self.probes.iter().map(|[gap, _]| [*gap]);
        scratch.factors.solve(rows, normal, [0.0], out.as_chunks_mut().0);
        out
    }

    /// Largest weighted entry of each of N changes of coordinates; infinite if an entry is NaN.
    fn sizes<const N: usize>(&self, steps: &[[f64; N]]) -> [f64; N] {
        let mut largest = [0.0; N];
        for (step, w) in steps.iter().zip(&self.weights) {
            for (largest, s) in largest.iter_mut().zip(step) {
                let size = (s * w).abs();
                *largest = if size.is_nan() { f64::INFINITY } else { size.max(*largest) };
            }
        }
        largest
    }

    /// Rounding of the loop equations at these coordinates, relative to that near the origin.
    pub fn rounding_at(&self, q: &[f64]) -> f64 {
        rounding_at(q, self.linkage.angles, &self.weights)
    }

    /// Coordinates by name and in words, the first six at most.
    pub fn describe(&self, q: &[f64]) -> String {
        let names = &self.linkage.coordinates;
        let unit = |i: usize| if i < self.linkage.angles { "rad" } else { "m" };
        // Zeros without a sign, and no endless row of digits.
        let number = |value: f64| match value.abs() < 1e15 {
            true => format!("{:.6}", (value * 1e6).round() / 1e6 + 0.0),
            false => Decimal(value).to_string(),
        };
        let parts: Vec<String> =
            (0..q.len().min(6)).map(|i| format!("{} = {} {}", names[i], number(q[i]), unit(i))).collect();
        parts.join(", ")
    }

    /// Unit tangent of the curve in the weighted norm, of arbitrary sign.
    pub fn tangent(&self, q: &[f64]) -> Vec<f64> {
        let mut scratch = Scratch::default();
        if !self.linearise(q, &mut scratch) {
            return vec![0.0; q.len()];
        }
        let mut tangent = scratch.factors.null;
        self.normalise(&mut tangent);
        tangent
    }

    /// Normal of the planes across the curve at this tangent: normal . tangent is the tangent's weighted norm squared.
    pub fn normal(&self, tangent: &[f64]) -> Vec<f64> {
        tangent.iter().zip(&self.weights).map(|(t, w)| t * w * w).collect()
    }

    /// Scale a change of coordinates to the weighted norm 1.
    pub fn normalise(&self, tangent: &mut [f64]) {
        let norm = tangent.iter().zip(&self.weights).map(|(t, w)| (t * w).powi(2)).sum::<f64>().sqrt();
        tangent.iter_mut().for_each(|t| *t /= norm);
    }

    /// Newton's method from `q` to the closed position on the plane normal . (q - base) = along, which replaces `q`.
    /// `scratch` then holds the positions of the bodies and the loop equations linearised there. None if the method
    /// does not converge.
    pub fn on_plane(
        &self,
        scratch: &mut Scratch,
        q: &mut [f64],
        base: &[f64],
        normal: &[f64],
        along: f64,
    ) -> Option<Convergence> {
        const ITERATIONS: usize = 12;
        /// Corrections above this size, while they shrink, are not rounding.
        const COARSE: f64 = 1e-12;
        /// Corrections below this size change the linearised equations by rounding only.
        const UNMOVED: f64 = 4.0 * f64::EPSILON;
        /// Corrections below this size have squares that are rounding.
        const SMALL: f64 = 1e-8;
        let (mut first, mut last) = (None, f64::INFINITY);
        scratch.closed += 1;
        for _ in 0..ITERATIONS {
            if !self.linearise(q, scratch) {
                return None;
            }
            self.linkage.gaps_into(&scratch.positions, &mut scratch.gaps);
            let off: f64 = (0..q.len()).map(|i| normal[i] * (q[i] - base[i])).sum();
            scratch.steps.resize(q.len(), [0.0; 3]);
            let rows = self.rows.iter().zip(&self.probes).map(|(&r, [a, b])| [-scratch.gaps[r], *a, *b]);
            scratch.factors.solve(rows, normal, [along - off, 0.0, 0.0], &mut scratch.steps);
            let [size, a, b] = self.sizes(&scratch.steps);
            if size > 1.0 {
                return None;
            }
            for (x, [step, ..]) in q.iter_mut().zip(&scratch.steps) {
                *x += step;
            }
            let first = *first.get_or_insert(size);
            let amplification = a.max(b);
            // The next correction is what the curvature of the loop equations makes of this one.
            let mut converged = q.len() as f64 * amplification * size * size < f64::EPSILON;
            if size < COARSE || size >= 0.5 * last {
                if !amplification.is_finite() {
                    return None;
                }
                let rounding = 1e-15 * (1.0 + amplification);
                // This correction was of the size of rounding, or corrections no longer shrink.
                let is_rounding = |rounding: f64| size < rounding || (size >= 0.5 * last && size < 1e3 * rounding);
                converged |= is_rounding(rounding) || is_rounding(rounding * self.rounding_at(q));
            }
            if converged {
                let Scratch { positions, steps, .. } = scratch;
                if size < SMALL {
                    self.linkage.shift_positions(q, |i| steps[i][0], positions);
                } else {
                    self.linkage.update_positions(q, positions);
                }
                // The amplification multiplies the effect of a change of position.
                let is_linearised = size <= UNMOVED || self.factorise(q, scratch);
                return is_linearised.then_some(Convergence { amplification, first });
            }
            last = size;
        }
        None
    }
}

impl Closure {
    /// The closed position on the plane of the position `q`, to which [`Self::on_plane`] has converged with this
    /// amplification and of which `scratch` holds the linearised loop equations, in twice the precision. None if
    /// corrections do not shrink.
    pub fn refine(&self, scratch: &mut Scratch, q: &[f64], normal: &[f64], amplification: f64) -> Option<Vec<Twofold>> {
        const ITERATIONS: usize = 12;
        const FINE: f64 = 1e-19;
        /// Rounding of the linearised loop equations, generously.
        const ROUNDING: f64 = 1e-14;
        let mut q: Vec<Twofold> = q.iter().map(|q| Twofold::from(*q)).collect();
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let gaps = self.linkage.precise_gaps(&q);
            scratch.steps.resize(q.len(), [0.0; 3]);
            let rows = self.rows.iter().map(|&r| [-gaps[r], 0.0, 0.0]);
            scratch.factors.solve(rows, normal, [0.0; 3], &mut scratch.steps);
            let [size, ..] = self.sizes(&scratch.steps);
            if size.is_nan() || size > 0.9 * last {
                return None;
            }
            for (q, [step, ..]) in q.iter_mut().zip(&scratch.steps) {
                *q = *q + Twofold::from(*step);
            }
            // The next correction: what the rounding and the curvature of the loop equations make of this one.
            if size < FINE || size * 10.0 * amplification * (ROUNDING + size) < FINE {
                return Some(q);
            }
            last = size;
        }
        None
    }
}
