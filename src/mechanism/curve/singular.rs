//! Singular configurations: where the loop equations of a linkage lose rank, if its joints' points are moved a little.
//!
//! In: a linkage, a configuration near such a place. Out: the place, how far the linkage misses it, and the least moves
//! of the joints' points with which it misses none of several places. It must not know the curve.
//!
//! Branches cross at a configuration q where the loops are closed, g(q) = 0, and k combinations of the loop equations
//! do not change to first order: J(q)^T l = 0 for the columns l of an m x k matrix L. With lengths that miss the
//! crossing a little, g = L mu instead: the miss. For k = 1 this is Moore's system, a stationary point of |g|. The
//! moves p of the joints' points that make the branches cross are those of least norm with
//!
//! | equations | number |
//! |---|---|
//! | g(q, p) = 0 | m |
//! | J(q, p)^T L = 0 | n k |
//! | L_0^T L = 1 | k^2 |
//!
//! by Newton's method in q, L and p. g and J are linear in p. Where p does not enter, the equations have more rows than
//! unknowns: what is left of a step in p are conditions on p alone, of all places together.
use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::{Linkage, Point};
use crate::numerics::order::{ascending, sorted};
use crate::numerics::plane::Vec2;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Singular values below this part of the largest count as zero.
const RANK: f64 = 1e-7;
/// Difference of a coordinate for second derivatives [rad or sizes of the linkage].
const DIFFERENCE: f64 = 3e-6;
/// Largest change of a coordinate in one iteration.
const STRIDE: f64 = 0.3;
/// Size of the last correction.
const CONVERGED: f64 = 1e-11;
/// Largest residual of the equations that is rounding.
const ROUNDING: f64 = 1e-13;
const ITERATIONS: usize = 15;
/// Largest number of combinations that lose rank at one place.
const COMBINATIONS: usize = 4;
/// Largest number of unknowns of one place: the cost grows with its third power.
const UNKNOWNS: usize = 120;

/// A configuration near which branches almost cross.
#[derive(Clone, Debug)]
pub struct Place {
    /// Coordinates.
    pub q: Vec<f64>,
    /// Combinations of the loop equations that lose rank.
    combinations: DMatrix<f64>,
    /// Largest gap of these combinations with the points where they are, in sizes of the linkage.
    pub miss: f64,
}

impl Place {
    /// Distance from a configuration, whole turns aside; `weights` as in [`Closure`], of which the first `angles` are
    /// those of angles.
    pub fn distance(&self, q: &[f64], weights: &[f64], angles: usize) -> f64 {
        let both = self.q.iter().zip(q).zip(weights).enumerate();
        let apart = both.map(|(i, ((a, b), w))| {
            let change = a - b;
            w * if i < angles { change - TAU * (change / TAU).round() } else { change }
        });
        apart.fold(0.0, |most: f64, change| most.max(change.abs()))
    }
}

/// The linkage whose points may be moved.
pub struct Singular<'a> {
    closure: &'a Closure,
    drawn: &'a Linkage,
    /// Points of the joints.
    points: Vec<Point>,
}

/// Equations of one place, linearised.
struct Linear {
    residual: DVector<f64>,
    /// Derivatives with respect to coordinates and combinations, and to moves of points.
    own: DMatrix<f64>,
    moves: DMatrix<f64>,
}

impl<'a> Singular<'a> {
    /// Places of a linkage; `closure`: its loop equations, or those of the same linkage with moved points.
    pub fn new(closure: &'a Closure, drawn: &'a Linkage) -> Self {
        Self { closure, drawn, points: drawn.joint_points() }
    }

    /// The place near a configuration where the loops almost lose rank; none if there is no such place.
    pub fn near(&self, q: &[f64]) -> Option<Place> {
        let jacobian = self.jacobian(self.drawn, q);
        let rows = jacobian.nrows();
        if rows == 0 || q.len() + rows > UNKNOWNS {
            return None;
        }
        let svd = jacobian.transpose().svd(false, true);
        let values = &svd.singular_values;
        let rights = svd.v_t.as_ref()?;
        // Ascending order of the singular values.
        let order = ascending(values.as_slice());
        let value = |k: usize| order.get(k).map_or(1.0, |index| values[*index].max(1e-6));
        let ratio = |k: usize| value(k) / value(k - 1);
        let mut counts = sorted((1..=rows).collect(), |count| -ratio(*count));
        counts.truncate(2);
        if counts[0] > COMBINATIONS {
            return None;
        }
        counts.retain(|count| *count <= COMBINATIONS);
        counts.into_iter().find_map(|count| {
            let rows: Vec<_> = order[..count].iter().map(|index| rights.row(*index).transpose()).collect();
            let combinations = DMatrix::from_columns(&rows);
            let start = Place { q: q.to_vec(), combinations, miss: f64::INFINITY };
            let (_, places) = self.solve(vec![start])?;
            let mut place = places.into_iter().next()?;
            place.miss = self.miss(&place);
            Some(place)
        })
    }

    /// The linkage with the least moves of its joints' points with which branches cross at all these places, and each
    /// move [m] with its point; none if there is none.
    pub fn snapped(&self, places: &[Place]) -> Option<(Linkage, Vec<(Point, Vec2)>)> {
        let (moves, _) = self.solve(places.to_vec())?;
        let linkage = self.drawn.with_moved_points(&self.points, &moves);
        Some((linkage, self.points.iter().copied().zip(moves).collect()))
    }

    /// Largest gap of the combinations that lose rank, with the points where they are.
    fn miss(&self, place: &Place) -> f64 {
        let orthonormal = place.combinations.clone().qr().q();
        (orthonormal.transpose() * self.gaps(self.drawn, &place.q)).amax()
    }

    /// Moves of least norm, and the places where branches then cross.
    fn solve(&self, mut places: Vec<Place>) -> Option<(Vec<Vec2>, Vec<Place>)> {
        let size = self.drawn.size;
        let normal: Vec<DMatrix<f64>> = places.iter().map(|place| place.combinations.transpose()).collect();
        let mut moves = DVector::zeros(2 * self.points.len());
        let (mut last, mut is_last) = (f64::INFINITY, false);
        for _ in 0..ITERATIONS {
            let vectors: Vec<Vec2> =
                moves.as_slice().as_chunks().0.iter().map(|[x, y]| Vec2::new(*x, *y) * size).collect();
            let linkage = self.drawn.with_moved_points(&self.points, &vectors);
            let linear: Vec<Linear> =
                places.iter().zip(&normal).map(|(place, normal)| self.linearise(&linkage, place, normal)).collect();
            if is_last {
                let worst = linear.iter().map(|linear| linear.residual.amax()).fold(0.0, f64::max);
                return (worst < ROUNDING).then_some((vectors, places));
            }
            let (next, steps) = step(&linear, &moves)?;
            let mut largest = (&next - &moves).amax();
            for (place, step) in places.iter_mut().zip(&steps) {
                let n = place.q.len();
                let stride = step.rows(0, n).amax();
                let shorten = (STRIDE / stride).min(1.0);
                largest = largest.max(step.amax());
                for (i, q) in place.q.iter_mut().enumerate() {
                    *q += shorten * step[i] / self.closure.weights[i];
                }
                for (l, change) in place.combinations.iter_mut().zip(step.iter().skip(n)) {
                    *l += shorten * change;
                }
            }
            moves = next;
            if !largest.is_finite() {
                return None;
            }
            // One step more after convergence, or where corrections are rounding.
            is_last = largest < CONVERGED || (largest < 1e-8 && largest > 0.5 * last);
            last = largest;
        }
        None
    }

    fn linearise(&self, linkage: &Linkage, place: &Place, normal: &DMatrix<f64>) -> Linear {
        let (q, l) = (&place.q, &place.combinations);
        let jacobian = self.jacobian(linkage, q);
        let (m, n, k) = (jacobian.nrows(), q.len(), l.ncols());
        let rows = m + n * k + k * k;
        let (gaps, transposed) = (self.gaps(linkage, q), product(&jacobian, l));
        let mut residual = DMatrix::zeros(rows, 1);
        put(&mut residual, (0, 0), m, gaps.as_slice());
        put(&mut residual, (m, 0), n * k, transposed.as_slice());
        let unit = product(&normal.transpose(), l) - DMatrix::identity(k, k);
        put(&mut residual, (m + n * k, 0), k * k, unit.as_slice());
        let mut own = DMatrix::zeros(rows, n + m * k);
        put(&mut own, (0, 0), m, jacobian.as_slice());
        for column in 0..n {
            let at = |sign: f64| {
                let mut q = q.clone();
                q[column] += sign * DIFFERENCE / self.closure.weights[column];
                self.jacobian(linkage, &q)
            };
            let change = (at(1.0) - at(-1.0)) / (2.0 * DIFFERENCE);
            put(&mut own, (m, column), n * k, product(&change, l).as_slice());
        }
        let transpose = jacobian.transpose();
        for c in 0..k {
            put(&mut own, (m + c * n, n + c * m), n, transpose.as_slice());
            put(&mut own, (m + n * k + c * k, n + c * m), k, normal.as_slice());
        }
        let mut moves = DMatrix::zeros(rows, 2 * self.points.len());
        let mut unit = vec![Vec2::zeros(); self.points.len()];
        // Points of the present linkage, in the same order.
        let points = self.points.iter().map(|point| self.moved(linkage, *point)).collect::<Vec<_>>();
        for column in 0..2 * points.len() {
            unit[column / 2][column % 2] = self.drawn.size;
            let other = linkage.with_moved_points(&points, &unit);
            unit[column / 2][column % 2] = 0.0;
            put(&mut moves, (0, column), m, (self.gaps(&other, q) - &gaps).as_slice());
            let change = product(&self.jacobian(&other, q), l) - &transposed;
            put(&mut moves, (m, column), n * k, change.as_slice());
        }
        Linear { residual: residual.column(0).into_owned(), own, moves }
    }

    /// A point of the drawn linkage in another one with moved points.
    fn moved(&self, linkage: &Linkage, point: Point) -> Point {
        let both = self.drawn.joints.iter().zip(&linkage.joints);
        let mut pairs = both.flat_map(|(a, b)| [(a.first, b.first), (a.second, b.second)]);
        pairs.find(|(drawn, _)| *drawn == point).map_or(point, |(_, moved)| moved)
    }

    /// Gaps of the independent loop equations, in sizes of the linkage.
    fn gaps(&self, linkage: &Linkage, q: &[f64]) -> DVector<f64> {
        let all = linkage.gaps(&linkage.positions(q));
        let rows = self.closure.rows();
        DVector::from_iterator(rows.len(), rows.iter().map(|&row| all[row] / linkage.size))
    }

    /// Dimensionless Jacobian of the independent loop equations.
    fn jacobian(&self, linkage: &Linkage, q: &[f64]) -> DMatrix<f64> {
        let all = linkage.jacobian(&linkage.positions(q), q);
        let (rows, weights) = (self.closure.rows(), &self.closure.weights);
        DMatrix::from_fn(rows.len(), q.len(), |row, column| all[(rows[row], column)] / (linkage.size * weights[column]))
    }
}

/// A^T B. Its loops are compiled once, here and below.
#[inline(never)]
fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    a.tr_mul(b)
}

/// Write the columns of a matrix with this number of rows into a larger matrix, from this row and column on.
#[inline(never)]
fn put(into: &mut DMatrix<f64>, (row, column): (usize, usize), rows: usize, part: &[f64]) {
    for (mut into, part) in into.column_iter_mut().skip(column).zip(part.chunks_exact(rows)) {
        into.as_mut_slice()[row..row + rows].copy_from_slice(part);
    }
}

/// Moves of least norm that solve the linearised equations of all places, and the step of each place.
fn step(linear: &[Linear], moves: &DVector<f64>) -> Option<(DVector<f64>, Vec<DVector<f64>>)> {
    let mut conditions: Vec<(DMatrix<f64>, DVector<f64>)> = Vec::new();
    for Linear { residual, own, moves: by_moves } in linear {
        let rows = own.nrows();
        // Square, so that the decomposition has the left null vectors.
        let square = own.clone().resize_horizontally(rows, 0.0);
        let svd = square.svd(true, false);
        let lefts = svd.u?;
        let cut = RANK * svd.singular_values.max();
        let null: Vec<_> = (0..rows).filter(|&i| svd.singular_values[i] <= cut).map(|i| lefts.column(i)).collect();
        if null.is_empty() {
            return None;
        }
        let null = DMatrix::from_columns(&null);
        conditions.push((product(&null, by_moves), null.tr_mul(&(by_moves * moves - residual))));
    }
    let count = conditions.iter().map(|(left, _)| left.nrows()).sum();
    let (mut left, mut right) = (DMatrix::zeros(count, moves.len()), Vec::with_capacity(count));
    for (part, value) in conditions {
        put(&mut left, (right.len(), 0), value.len(), part.as_slice());
        right.extend_from_slice(value.as_slice());
    }
    let right = DVector::from_vec(right);
    let svd = left.svd(true, true);
    let cut = RANK * svd.singular_values.max();
    let next = svd.solve(&right, cut).ok()?;
    let mut steps = Vec::new();
    for Linear { residual, own, moves: by_moves } in linear {
        let right = -(residual + by_moves * (&next - moves));
        let svd = own.clone().svd(true, true);
        let cut = RANK * svd.singular_values.max();
        steps.push(svd.solve(&right, cut).ok()?);
    }
    Some((next, steps))
}
