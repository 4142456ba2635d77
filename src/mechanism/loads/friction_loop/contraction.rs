//! The loop of any number of joints whose friction changes the reactions by less than these change.
//!
//! In: arms, reactions as affine functions of the friction, magnitudes near the solution. Out: the solution, by
//! simplified Newton's method with few inverses within a step. It must not know the law of friction.
use super::{BLOCK, Balance, FrictionLoop, greater};
use crate::numerics::dual::Number;

/// The inverse of 1 - D B with D = d|R| / dz, for simplified Newton's method within a step.
#[derive(Clone, Debug)]
pub struct Kept {
    /// Its rows, one after the other, each with zeros up to a whole block.
    inverse: Vec<Block>,
    pub is_known: bool,
    /// Magnitudes s, and |R(B s)| - s, with zeros up to a whole block.
    size: Vec<Block>,
    rest: Vec<Block>,
}

/// Numbers that a processor multiplies at once. Loops over blocks have no remainder, of which every loop over numbers
/// has a copy.
type Block = [f64; BLOCK];

impl Kept {
    /// For so many joints.
    pub fn new(joints: usize) -> Self {
        let zeros = vec![[0.0; BLOCK]; joints.div_ceil(BLOCK)];
        let rows = |count: usize| vec![[0.0; BLOCK]; count * zeros.len()];
        Self { inverse: rows(joints), is_known: false, size: zeros.clone(), rest: zeros }
    }
}

impl<T: Number> FrictionLoop<T> {
    /// Simplified Newton's method for s = |R(z)|, z = B s, from the present magnitudes s, of a loop that contracts. The
    /// solution is unique, so that every start and every inverse lead to it. False if it does not converge.
    pub(super) fn contract(&mut self, balance: &Balance<T>) -> bool {
        /// Sum of the errors that are left, relative to the largest reaction.
        const EXACT: f64 = 2e-16;
        /// Sum of corrections that are rounding.
        const ROUNDING: f64 = 4e-15;
        /// Number of further corrections for which another inverse is worth its cost.
        const WORTH: i32 = 5;
        const MOST: u32 = 12;
        self.iterations = 0;
        let mut renews = !self.kept.is_known;
        self.kept.is_known = self.of_sizes.is_in_step();
        let sizes = self.kept.size.as_flattened_mut().iter_mut().zip(&self.size);
        sizes.for_each(|(own, size)| *own = size.value());
        let mut before = f64::INFINITY;
        for iteration in 1..=MOST {
            let scale = self.find_rest(balance);
            if renews {
                self.iterations += 1;
                self.renew(balance);
            }
            let Kept { inverse, size, rest, .. } = &mut self.kept;
            let mut change = 0.0;
            for (size, row) in size.as_flattened_mut().iter_mut().zip(inverse.chunks_exact(rest.len())) {
                let correction = inner(row, rest);
                *size += correction;
                change += correction.abs();
            }
            change /= scale;
            if !change.is_finite() {
                break;
            }
            // Of the first correction no ratio is known.
            let ratio = if iteration > 1 { change / before } else { 1.0 };
            if change <= ROUNDING || change * ratio <= EXACT {
                let own = size.as_flattened();
                self.size.iter_mut().zip(own).for_each(|(size, own)| *size = T::constant(*own));
                return true;
            }
            renews = iteration > 1 && change * ratio.powi(WORTH) > EXACT;
            before = change;
        }
        self.kept.is_known = false;
        false
    }

    /// |R(B s)| - s at the present magnitudes, with the slopes of each |R|. Returns the largest |R|.
    #[inline(always)]
    fn find_rest(&mut self, balance: &Balance<T>) -> f64 {
        let Kept { size, rest, .. } = &mut self.kept;
        let n = self.size.len();
        for (unknown, row) in self.unknown.iter_mut().zip(blocks(&self.effect).chunks_exact(size.len())) {
            *unknown = T::constant(inner(row, size));
        }
        let (size, rest) = (size.as_flattened(), rest.as_flattened_mut());
        let ([free_x, free_y], [along_x, along_y]) =
            (balance.free.map(|row| &row[..n]), balance.inertial.map(|row| &row[..n]));
        let (groups, seconds, signs) = (&balance.groups[..n], &balance.seconds[..n], &self.sign[..n]);
        let (direction, rest) = (&mut self.direction[..n], &mut rest[..n]);
        let u = self.unknown[0].value();
        let mut scale = f64::MIN_POSITIVE;
        for i in 0..n {
            let of = 1 + 2 * groups[i];
            let [first, second] = [self.unknown[of].value(), self.unknown[of + 1].value()];
            let ([on_x, on_y], along) = (seconds[i], [along_x[i].value(), along_y[i].value()]);
            let x = free_x[i].value() + along[0] * u + (first + second * on_x);
            let y = free_y[i].value() + along[1] * u + second * on_y;
            let (found, unit) = if signs[i] == 0.0 {
                let found = (x * x + y * y).sqrt();
                let inverse = 1.0 / greater(f64::MIN_POSITIVE, found);
                (found, [x * inverse, y * inverse])
            } else {
                (x * signs[i], [signs[i], 0.0])
            };
            direction[i] = [unit[0] * along[0] + unit[1] * along[1], unit[0], on_x * unit[0] + on_y * unit[1]];
            rest[i] = found - size[i];
            scale = greater(scale, found.abs());
        }
        scale
    }

    /// Compute the inverse at the present unknowns. In each row of 1 - D B the diagonal is greater than the sum of the
    /// other elements, so that Gauss and Jordan's elimination needs no pivoting.
    #[inline(always)]
    fn renew(&mut self, balance: &Balance<T>) {
        let Kept { inverse, size, .. } = &mut self.kept;
        let wide = size.len();
        let effect = blocks(&self.effect);
        for ((i, row), [u, x, y]) in inverse.chunks_exact_mut(wide).enumerate().zip(&self.direction) {
            let of = 1 + 2 * balance.groups[i];
            let [along, first, second] = [0, of, of + 1].map(|k| &effect[k * wide..][..wide]);
            for (((block, along), first), second) in row.iter_mut().zip(along).zip(first).zip(second) {
                for k in 0..BLOCK {
                    block[k] = -(u * along[k].value() + x * first[k].value() + y * second[k].value());
                }
            }
            row.as_flattened_mut()[i] += 1.0;
        }
        for k in 0..self.size.len() {
            let (above, rest) = inverse.split_at_mut(k * wide);
            let (row, below) = rest.split_at_mut(wide);
            let pivot = 1.0 / std::mem::replace(&mut row.as_flattened_mut()[k], 1.0);
            row.iter_mut().for_each(|block| *block = block.map(|element| element * pivot));
            for other in above.chunks_exact_mut(wide).chain(below.chunks_exact_mut(wide)) {
                let factor = std::mem::take(&mut other.as_flattened_mut()[k]);
                for (other, row) in other.iter_mut().zip(&*row) {
                    (0..BLOCK).for_each(|k| other[k] -= factor * row[k]);
                }
            }
        }
    }
}

/// Numbers of whole blocks as blocks.
#[inline(always)]
fn blocks<T>(numbers: &[T]) -> &[[T; BLOCK]] {
    numbers.as_chunks().0
}

/// Inner product of rows of blocks, as four independent sums, of which the processor holds neighbours together.
#[inline(always)]
fn inner<T: Number>(a: &[[T; BLOCK]], b: &[Block]) -> f64 {
    let mut sums = [0.0; BLOCK];
    for (a, b) in a.iter().zip(b) {
        for k in 0..BLOCK {
            sums[k] += a[k].value() * b[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}
