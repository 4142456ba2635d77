//! Assembly: coordinates that close every loop, and the one direction in which they can move.
//!
//! In: a linkage and a guess. Out: closed coordinates, the independent loop equations, and Newton's method on a plane
//! across the curve of closed positions. It must not know loads or time.
mod error;
mod factors;

pub use error::AssemblyError;
pub use factors::{Factors, dot};

use crate::mechanism::linkage::{Freedom, Linkage, Positions};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// A gap below this part of the linkage's size is closed; Newton's method gets there from rounding alone.
const CLOSED: f64 = 1e-14;
/// A singular value below this part of the largest counts as zero.
const RANK: f64 = 1e-9;

/// The loop equations of a linkage with one degree of freedom.
#[derive(Clone, Debug)]
pub struct Closure {
    /// The linkage.
    pub linkage: Arc<Linkage>,
    /// Independent loop equations, one fewer than coordinates.
    rows: Vec<usize>,
    /// What makes coordinates comparable: 1 for an angle, 1/size for a length [1/m].
    pub weights: Vec<f64>,
}

/// Room for the loop equations at one position after another: values and the linearised equations.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    /// Where the bodies are at the coordinates last linearised at.
    pub positions: Positions,
    /// The independent loop equations, linearised there.
    pub factors: Factors,
    /// Values of all loop equations.
    gaps: Vec<f64>,
    /// Changes of coordinates: that to a closed position, and those that tell the amplification.
    steps: Vec<[f64; 3]>,
    /// Rows of one loop.
    partials: [Vec<f64>; 2],
}

/// How Newton's method came to a position on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Largest entry of a rough inverse of the equations there: how much rounding in a gap is amplified.
    pub amplification: f64,
    /// Size of the first correction (weighted).
    pub first: f64,
    /// Whether the equations are linearised there to the last bit; else a correction away that is smaller than that.
    exact: bool,
}

/// Weights that make coordinates comparable.
fn weights(linkage: &Linkage) -> Vec<f64> {
    (0..linkage.coordinates.len()).map(|i| if i < linkage.angles { 1.0 } else { 1.0 / linkage.size }).collect()
}

/// Jacobian in comparable units: gaps in sizes, coordinates weighted.
fn scaled_jacobian(linkage: &Linkage, p: &Positions, q: &[f64], w: &[f64]) -> DMatrix<f64> {
    let mut j = linkage.jacobian(p, q) / linkage.size;
    for (mut column, weight) in j.column_iter_mut().zip(w) {
        column /= *weight;
    }
    j
}

fn rank(matrix: &DMatrix<f64>) -> usize {
    if matrix.is_empty() {
        return 0;
    }
    let values = matrix.singular_values();
    values.iter().filter(|s| **s > RANK * values.max().max(1e-3)).count()
}

/// Close the loops from a guess, changing it as little as Newton's method needs.
fn close(linkage: &Linkage, guess: &[f64], w: &[f64]) -> Result<Vec<f64>, AssemblyError> {
    const ITERATIONS: usize = 200;
    const STRIDE: f64 = 0.5;
    let mut q = guess.to_vec();
    let mut best = f64::INFINITY;
    let mut stale = 0;
    for _ in 0..ITERATIONS {
        let p = linkage.positions(&q);
        let gaps = linkage.gaps(&p);
        let worst = gaps.iter().fold(0.0, |a: f64, g| a.max(g.abs())) / linkage.size;
        // Closed, or as close as rounding and a singular position allow.
        stale = if worst < 0.5 * best { 0 } else { stale + 1 };
        best = best.min(worst);
        if worst < CLOSED || (stale > 3 && worst < 100.0 * CLOSED) {
            return Ok(q);
        }
        let j = scaled_jacobian(linkage, &p, &q, w);
        if !(worst.is_finite() && j.iter().all(|x| x.is_finite())) {
            break;
        }
        let right = DVector::from_iterator(gaps.len(), gaps.iter().map(|g| -g / linkage.size));
        let svd = j.svd(true, true);
        let cut = 1e-10 * svd.singular_values.max();
        let Ok(step) = svd.solve(&right, cut) else { break };
        let shorten = (STRIDE / step.norm()).min(1.0);
        for (i, s) in step.iter().enumerate() {
            q[i] += shorten * s / w[i];
        }
    }
    let gaps = linkage.gaps(&linkage.positions(&q));
    let (row, gap) = gaps.iter().enumerate().fold((0, 0.0), |a, (i, g)| if g.abs() >= a.1 { (i, g.abs()) } else { a });
    Err(AssemblyError::Open { joint: linkage.joints[linkage.row_joints()[row]].name.clone(), gap })
}

impl Closure {
    /// Close the loops from a guess and find the independent loop equations.
    ///
    /// # Errors
    /// [`AssemblyError`]: the loops stay open, there is not one degree of freedom, or two branches cross here.
    pub fn assemble(linkage: Arc<Linkage>, guess: &[f64]) -> Result<(Self, Vec<f64>), AssemblyError> {
        let w = weights(&linkage);
        let n = w.len();
        if n == 0 {
            return Err(AssemblyError::Freedom { count: 0 });
        }
        let q = close(&linkage, guess, &w)?;
        let j = scaled_jacobian(&linkage, &linkage.positions(&q), &q, &w);
        let freedom = n - rank(&j);
        if freedom != 1 {
            // More freedom here than elsewhere nearby: branches cross here. Look a little way off, in a fixed direction.
            let off: Vec<f64> = (0..n).map(|i| q[i] + 0.02 * (1.0 + 3.7 * i as f64).sin() / w[i]).collect();
            if freedom > 1
                && let Ok(near) = close(&linkage, &off, &w)
            {
                let j = scaled_jacobian(&linkage, &linkage.positions(&near), &near, &w);
                if n - rank(&j) == 1 {
                    return Err(AssemblyError::Crossing);
                }
            }
            return Err(AssemblyError::Freedom { count: freedom });
        }
        Ok((Self { linkage, rows: independent_rows(&j, n - 1), weights: w }, q))
    }

    /// Whether some loop equations follow from others.
    pub fn redundant(&self) -> bool {
        self.rows.len() < self.linkage.rows()
    }

    /// The independent ones of all gap values.
    pub fn pick(&self, gaps: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|&r| gaps[r]).collect()
    }

    /// The independent loop equations, by their places.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// The loop equations linearised at `q`; false where they lose rank to the last bit.
    pub fn linearise(&self, q: &[f64], work: &mut Workspace) -> bool {
        let linkage = &*self.linkage;
        linkage.place(q, &mut work.positions);
        work.factors.clear(q.len());
        let (mut row, mut kept) = (0, self.rows.iter().peekable());
        for (place, &joint) in linkage.cuts.iter().enumerate() {
            linkage.partials(&work.positions, q, place, &mut work.partials);
            let count = if linkage.joints[joint].freedom == Freedom::Revolute { 2 } else { 1 };
            for partials in &work.partials[..count] {
                if kept.next_if(|r| **r == row).is_some() {
                    let columns = linkage.loops[place].columns.iter().copied();
                    if !work.factors.push(columns.zip(partials.iter().copied()), &self.weights) {
                        return false;
                    }
                }
                row += 1;
            }
        }
        work.factors.finish()
    }

    /// How much rounding in a gap is amplified in solutions on planes with this normal: the largest entry of two of them.
    pub fn amplification(&self, normal: &[f64], work: &mut Workspace) -> f64 {
        work.steps.resize(normal.len(), [0.0; 3]);
        let rows = (0..self.rows.len()).map(|i| self.probes(i, 0.0));
        work.factors.solve(rows, normal, [0.0; 3], &mut work.steps);
        let [_, a, b] = self.sizes(&work.steps);
        a.max(b)
    }

    /// Change of the independent loop equation number `i` that is asked for, and those that tell the amplification.
    fn probes(&self, i: usize, change: f64) -> [f64; 3] {
        let size = self.linkage.size;
        let signed = |k: usize| if (i >> k).is_multiple_of(2) { size } else { -size };
        [change, signed(0), signed(1)]
    }

    /// A solution on a plane with this normal, for gaps that favour no combination of loops.
    pub fn probe(&self, normal: &[f64], work: &Workspace) -> Vec<f64> {
        let mut out = vec![0.0; normal.len()];
        let rows = (0..self.rows.len()).map(|i| [self.linkage.size * (1.0 + 3.7 * i as f64).sin()]);
        work.factors.solve(rows, normal, [0.0], out.as_chunks_mut().0);
        out
    }

    /// Largest of the changes of coordinates, weighted, of each of several; infinite if one is not a number.
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

    /// Unit tangent of the curve, in the weighted norm; its sign is arbitrary.
    pub fn tangent(&self, q: &[f64]) -> Vec<f64> {
        let mut work = Workspace::default();
        if !self.linearise(q, &mut work) {
            return vec![0.0; q.len()];
        }
        let mut tangent = work.factors.null;
        self.normalise(&mut tangent);
        tangent
    }

    /// Normal of the planes across the curve where it has this tangent: normal . tangent is its weighted norm squared.
    pub fn normal(&self, tangent: &[f64]) -> Vec<f64> {
        tangent.iter().zip(&self.weights).map(|(t, w)| t * w * w).collect()
    }

    /// Give a change of coordinates the weighted norm 1.
    pub fn normalise(&self, tangent: &mut [f64]) {
        let norm = tangent.iter().zip(&self.weights).map(|(t, w)| (t * w).powi(2)).sum::<f64>().sqrt();
        tangent.iter_mut().for_each(|t| *t /= norm);
    }

    /// Positions of the bodies at `q`, where Newton's method has landed.
    pub fn place(&self, landing: Landing, q: &[f64], work: &mut Workspace, positions: &mut Positions) {
        if landing.exact {
            std::mem::swap(positions, &mut work.positions);
        } else {
            self.linkage.place(q, positions);
        }
    }

    /// Newton's method from `q` to the closed position on the plane normal . (q - base) = along, which is put in its place.
    /// The equations are left linearised there.
    pub fn on_plane(
        &self,
        work: &mut Workspace,
        q: &mut [f64],
        base: &[f64],
        normal: &[f64],
        along: f64,
    ) -> Option<Landing> {
        const ITERATIONS: usize = 12;
        /// Larger corrections that still shrink are not of the size of rounding.
        const COARSE: f64 = 1e-12;
        /// Smaller corrections leave the linearised equations what they are but for rounding.
        const UNMOVED: f64 = 4.0 * f64::EPSILON;
        let (mut first, mut last) = (None, f64::INFINITY);
        for _ in 0..ITERATIONS {
            if !self.linearise(q, work) {
                return None;
            }
            self.linkage.measure(&work.positions, &mut work.gaps);
            let off: f64 = (0..q.len()).map(|i| normal[i] * (q[i] - base[i])).sum();
            work.steps.resize(q.len(), [0.0; 3]);
            let rows = self.rows.iter().enumerate().map(|(i, &r)| self.probes(i, -work.gaps[r]));
            work.factors.solve(rows, normal, [along - off, 0.0, 0.0], &mut work.steps);
            let [size, a, b] = self.sizes(&work.steps);
            if size > 1.0 {
                return None;
            }
            for (x, [step, ..]) in q.iter_mut().zip(&work.steps) {
                *x += step;
            }
            let first = *first.get_or_insert(size);
            if size < COARSE || size >= 0.5 * last {
                let amplification = a.max(b);
                if !amplification.is_finite() {
                    return None;
                }
                let rounding = 1e-15 * (1.0 + amplification);
                // Converged: the last correction was of the size of rounding, or corrections no longer shrink.
                if size < rounding || (size >= 0.5 * last && size < 1e3 * rounding) {
                    // A solution changes by up to the amplification times a change of position.
                    if size > UNMOVED && !self.linearise(q, work) {
                        return None;
                    }
                    return Some(Landing { amplification, first, exact: size > UNMOVED });
                }
            }
            last = size;
        }
        None
    }
}

/// Rows of full rank, chosen greedily by the largest part that earlier rows do not span.
fn independent_rows(j: &DMatrix<f64>, count: usize) -> Vec<usize> {
    let mut rest: Vec<DVector<f64>> = j.row_iter().map(|r| r.transpose()).collect();
    if rest.len() == count {
        return (0..count).collect();
    }
    let mut rows = Vec::new();
    for _ in 0..count {
        let best = (0..rest.len()).fold(0, |b, i| if rest[i].norm() > rest[b].norm() { i } else { b });
        let unit = rest[best].normalize();
        for v in &mut rest {
            let part = v.dot(&unit);
            v.axpy(-part, &unit, 1.0);
        }
        rows.push(best);
    }
    rows.sort_unstable();
    rows
}

/// Coordinates from the guess of a definition: body names give angles, prismatic joints give positions.
///
/// # Errors
/// [`AssemblyError::Guess`] for a missing or a superfluous name.
pub fn guessed(linkage: &Linkage, guess: &crate::mechanism::definition::Named<f64>) -> Result<Vec<f64>, AssemblyError> {
    let mut q = vec![None; linkage.coordinates.len()];
    for (name, &value) in guess.iter() {
        let body = linkage.bodies.iter().find(|b| b.name == name);
        let found = match body {
            Some(b) => b.angle_coordinate.map(|t| (t, value - b.offset)),
            None => linkage.coordinates[linkage.angles..]
                .iter()
                .position(|c| c == name)
                .map(|i| (linkage.angles + i, value)),
        };
        match found {
            Some((i, v)) => q[i] = Some(v),
            None => {
                let message = format!("gives no coordinate; those are {}", linkage.coordinates.join(", "));
                return Err(AssemblyError::Guess { name: name.into(), message });
            }
        }
    }
    let missing = |i: usize| AssemblyError::Guess {
        name: linkage.coordinates[i].clone(),
        message: format!(
            "is missing: give its rough {}",
            if i < linkage.angles { "angle [rad]" } else { "position [m]" }
        ),
    };
    q.into_iter().enumerate().map(|(i, v)| v.ok_or_else(|| missing(i))).collect()
}
