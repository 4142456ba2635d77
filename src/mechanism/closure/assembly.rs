//! Assembly: coordinates that close every loop, near a guess.
//!
//! In: a linkage and a guess. Out: closed coordinates, the independent ones of its loop equations. It must not know the
//! curve of closed positions.
use super::{AssemblyError, rounding_at};
use crate::format::on_one_line;
use crate::mechanism::definition::Named;
use crate::mechanism::linkage::{Freedom, Linkage, Positions, Side};
use crate::numerics::order;
use nalgebra::{DMatrix, DVector, Dyn, SVD};

/// Largest gap of a closed loop, relative to the linkage's size: rounding of Newton's method.
const CLOSED: f64 = 1e-14;
/// Largest gap of redundant loops, relative to the linkage's size, that is blamed on their lengths and not on the
/// guess.
const CONTRADICTION: f64 = 1e-2;
/// Part of the length of a loop that is stretched flat by which its longest side is shorter by rounding.
pub(super) const FLAT: f64 = 1e-9;
/// Singular values below this part of the largest count as zero.
pub(super) const RANK: f64 = 1e-9;

/// Dimensionless Jacobian: gaps relative to the linkage's size, coordinates weighted.
pub(super) fn scaled_jacobian(linkage: &Linkage, p: &Positions, q: &[f64], w: &[f64]) -> DMatrix<f64> {
    let mut j = linkage.jacobian(p, q) / linkage.size;
    for (mut column, weight) in j.column_iter_mut().zip(w) {
        column /= *weight;
    }
    j
}

/// Number of singular values above `least`, a part of the largest.
pub(super) fn rank(matrix: &DMatrix<f64>, least: f64) -> usize {
    if matrix.is_empty() {
        return 0;
    }
    let values = matrix.singular_values();
    values.iter().filter(|s| **s > least * values.max().max(1e-3)).count()
}

/// Closed coordinates near a guess, by Newton's method with least-norm corrections.
///
/// Redundant loop equations contradict each other until they are closed: the singular value that is 0 for closed loops
/// is then a small one, along which a correction would lead far away. There corrections are those of Levenberg and
/// Marquardt, (J^T J + g I) step = -J^T gap, with g the norm of the gaps, which converge quadratically whatever the
/// rank (Fan and Yuan 2005).
pub(super) fn close(linkage: &Linkage, guess: &[f64], w: &[f64]) -> Result<Vec<f64>, AssemblyError> {
    const ITERATIONS: usize = 200;
    const STRIDE: f64 = 0.5;
    let mut q = guess.to_vec();
    let mut best = f64::INFINITY;
    let mut unimproved = 0;
    // Of independent equations there are one fewer than coordinates.
    let is_redundant = linkage.row_joints().len() >= q.len();
    for _ in 0..ITERATIONS {
        let p = linkage.positions(&q);
        let gaps = linkage.gaps(&p);
        let worst = gaps.iter().fold(0.0, |a: f64, g| a.max(g.abs())) / linkage.size;
        // Closed, or as near to it as rounding allows at a singular position.
        unimproved = if worst < 0.5 * best { 0 } else { unimproved + 1 };
        best = best.min(worst);
        if worst < CLOSED || (unimproved > 3 && worst < 100.0 * CLOSED * rounding_at(&q, linkage.angles, w)) {
            return Ok(q);
        }
        let j = scaled_jacobian(linkage, &p, &q, w);
        if !(worst.is_finite() && j.iter().all(|x| x.is_finite())) {
            break;
        }
        let right = DVector::from_iterator(gaps.len(), gaps.iter().map(|g| -g / linkage.size));
        let svd = j.svd(true, true);
        let step = if is_redundant {
            damped(&svd, &right)
        } else {
            let cut = 1e-10 * svd.singular_values.max();
            let Ok(step) = svd.solve(&right, cut) else { break };
            step
        };
        let shorten = (STRIDE / step.norm()).min(1.0);
        for (i, s) in step.iter().enumerate() {
            q[i] += shorten * s / w[i];
        }
    }
    if let Some(error) = straight(linkage, FLAT) {
        return Err(error);
    }
    let gaps = linkage.gaps(&linkage.positions(&q));
    let (row, gap) = gaps.iter().enumerate().fold((0, 0.0), |a, (i, g)| if g.abs() >= a.1 { (i, g.abs()) } else { a });
    let joint = linkage.joints[linkage.row_joints()[row]].name.clone();
    Err(AssemblyError::Open { joint, gap, contradicts: is_redundant && gap < CONTRADICTION * linkage.size })
}

/// The error for a loop that cannot close, or that fits only when it is stretched flat; `slack`: part of its length by
/// which its longest side may be too short for that.
pub fn straight(linkage: &Linkage, slack: f64) -> Option<AssemblyError> {
    let found = linkage.straight_loop(slack)?;
    let name = |body: usize| linkage.bodies[body].name.clone();
    let (side, is_slide) = match found.side {
        Side::Body(body) => (name(body), false),
        Side::Slide(joint) => (linkage.joints[joint].name.clone(), true),
    };
    let others = found.others.iter().map(|(body, length)| (name(*body), *length)).collect();
    let joint = linkage.joints[found.joint].name.clone();
    Some(AssemblyError::TooLong { joint, side, is_slide, length: found.length, others })
}

/// The correction of Levenberg and Marquardt for J = U S V^T and this right side, damped by its norm.
fn damped(svd: &SVD<f64, Dyn, Dyn>, right: &DVector<f64>) -> DVector<f64> {
    let (Some(u), Some(v_t)) = (&svd.u, &svd.v_t) else { return DVector::zeros(svd.singular_values.len()) };
    let mut parts = u.tr_mul(right);
    for (part, s) in parts.iter_mut().zip(&svd.singular_values) {
        *part *= s / (s * s + right.norm()).max(f64::MIN_POSITIVE);
    }
    v_t.tr_mul(&parts)
}

/// Rows of full rank, each chosen for the largest part that the rows before do not span.
pub(super) fn independent_rows(j: &DMatrix<f64>, count: usize) -> Vec<usize> {
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
    order::distinct(rows)
}

/// Coordinates from the guess of a definition: a body's name gives an angle, a prismatic joint's name a position.
///
/// # Errors
/// [`AssemblyError::Guess`] for a missing or a superfluous name.
pub fn guessed(linkage: &Linkage, guess: &Named<f64>) -> Result<Vec<f64>, AssemblyError> {
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
                let all = linkage.coordinates.join(", ");
                let message = match (body, linkage.joints.iter().find(|joint| joint.name == name)) {
                    (Some(_), _) => {
                        format!(
                            "this body is fixed to the ground and does not turn: remove this key; a guess is possible \
                             for {all}"
                        )
                    }
                    (None, Some(joint)) if matches!(joint.freedom, Freedom::Coupling(_)) => {
                        format!(
                            "this element is a coupling, which has no guess: guess the angles of the coupled bodies \
                             instead; a guess is possible for {all}"
                        )
                    }
                    (None, Some(joint)) if joint.freedom == Freedom::Revolute => {
                        format!(
                            "this element is a revolute joint, which has no guess: guess the angles of bodies instead; \
                             a guess is possible for {all}"
                        )
                    }
                    (None, Some(_)) => format!(
                        "the position of this joint follows from other prismatic joints, which connect the same two \
                         bodies directly or through other bodies: remove this key; a guess is possible for {all}"
                    ),
                    (None, None) => {
                        format!("there is no body or prismatic joint with this name; a guess is possible for {all}")
                    }
                };
                return Err(AssemblyError::Guess { name: on_one_line(name), message });
            }
        }
    }
    let mut missing = (0..q.len()).filter(|&i| q[i].is_none());
    let what = |i: usize| if i < linkage.angles { "angle [rad]" } else { "position [m]" };
    if let Some(first) = missing.next() {
        let others: Vec<String> = missing.map(|i| format!("{} of {}", what(i), linkage.coordinates[i])).collect();
        let others = if others.is_empty() { String::new() } else { format!("; also missing: {}", others.join(", ")) };
        let message = format!("the guess of this element is missing: add a rough {}{others}", what(first));
        return Err(AssemblyError::Guess { name: linkage.coordinates[first].clone(), message });
    }
    Ok(q.into_iter().flatten().collect())
}
