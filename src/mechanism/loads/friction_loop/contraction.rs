//! The loop of any number of joints whose friction changes the reactions by less than these change.
//!
//! In: arms, reactions as affine functions of the friction, magnitudes near the solution. Out: the solution, by
//! simplified Newton's method with few inverses within a step. It must not know the law of friction.
use super::{BLOCK, Balance, FrictionLoop, greater};
use crate::numerics::dual::Number;
use crate::numerics::processor::{self, Arithmetic, Task};

/// The inverse of 1 - D B with D = d|R| / dz, for simplified Newton's method within a step. Joints, and numbers of
/// joints, have zeros up to a whole block.
#[derive(Clone, Debug)]
pub struct Kept {
    /// Its columns, one after the other.
    inverse: Vec<Block>,
    pub is_known: bool,
    /// Magnitudes s, and |R(B s)| - s.
    size: Vec<Block>,
    rest: Vec<Block>,
    /// What the iterations need of each joint, side by side.
    joints: Vec<Joints>,
}

/// A block of joints.
#[derive(Clone, Copy, Debug, Default)]
struct Joints {
    /// Reactions without friction, and to sigma_ddot = 1.
    free: [Block; 2],
    along: [Block; 2],
    /// Held signs of normal forces.
    sign: Block,
    /// Index of the unknown P_g,x, before that of P_g,y.
    passed: [usize; BLOCK],
    /// Effect of P_g,x on x: 1, but 0 beyond the last joint. Effect of P_g,y on x and on y.
    first: Block,
    second: [Block; 2],
    /// Derivatives of |R| with respect to x and y.
    unit: [Block; 2],
}

/// Numbers that a processor multiplies at once. Loops over blocks have no remainder, of which every loop over numbers
/// has a copy.
type Block = [f64; BLOCK];

impl Kept {
    /// For so many joints.
    pub fn new(joints: usize) -> Self {
        let blocks = joints.div_ceil(BLOCK);
        Self {
            inverse: vec![[0.0; BLOCK]; joints * blocks],
            is_known: false,
            size: vec![[0.0; BLOCK]; blocks],
            rest: vec![[0.0; BLOCK]; blocks],
            joints: vec![Joints::default(); blocks],
        }
    }
}

/// [`FrictionLoop::contract`].
struct Contraction<'a, T>(&'a mut FrictionLoop<T>, &'a Balance<'a, T>);

impl<T: Number> Task for Contraction<'_, T> {
    type Result = bool;

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> bool {
        self.0.correct_until_exact::<A>(self.1)
    }
}

// Closures might be compiled without the features of the processor, so the loops have none.
impl<T: Number> FrictionLoop<T> {
    /// Simplified Newton's method for s = |R(z)|, z = B s, from the present magnitudes s, of a loop that contracts. The
    /// solution is unique, so that every start and every inverse lead to it. False if it does not converge.
    pub(super) fn contract(&mut self, balance: &Balance<T>) -> bool {
        processor::run(Contraction(self, balance))
    }

    /// [`Self::contract`] in one arithmetic.
    #[inline(always)]
    pub(super) fn correct_until_exact<A: Arithmetic>(&mut self, balance: &Balance<T>) -> bool {
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
        self.gather(balance);
        let mut before = f64::INFINITY;
        for iteration in 1..=MOST {
            let scale = self.find_rest::<A>();
            if renews {
                self.iterations += 1;
                self.renew::<A>();
            }
            let Kept { inverse, size: own, rest, joints, .. } = &mut self.kept;
            let (rest, wide, mut changes) = (rest.as_flattened(), own.len(), [0.0; BLOCK]);
            for (b, size) in own.iter_mut().enumerate() {
                let mut correction = [0.0; BLOCK];
                for (columns, rest) in inverse.chunks_exact(wide).zip(rest) {
                    correction = A::multiply_add_each(&columns[b], &[*rest; BLOCK], &correction);
                }
                for k in 0..BLOCK {
                    size[k] += correction[k];
                    changes[k] += correction[k].abs();
                }
            }
            let change = total(&changes) / scale;
            if !change.is_finite() {
                break;
            }
            // Of the first correction no ratio is known.
            let ratio = if iteration > 1 { change / before } else { 1.0 };
            if change <= ROUNDING || change * ratio <= EXACT {
                for (i, (size, direction)) in self.size.iter_mut().zip(&mut self.direction).enumerate() {
                    let (block, k) = (i / BLOCK, i % BLOCK);
                    *size = T::constant(own[block][k]);
                    direction[1] = joints[block].unit[0][k];
                }
                return true;
            }
            renews = iteration > 1 && change * ratio.powi(WORTH) > EXACT;
            before = change;
        }
        self.kept.is_known = false;
        false
    }

    /// Gather what the iterations need of each joint.
    #[inline(always)]
    fn gather(&mut self, balance: &Balance<T>) {
        let n = self.size.len();
        let ([free_x, free_y], [along_x, along_y]) =
            (balance.free.map(|row| &row[..n]), balance.inertial.map(|row| &row[..n]));
        let (groups, seconds) = (&balance.groups[..n], &balance.seconds[..n]);
        // Beyond the last joint: a correction that is not finite leaves no zeros.
        self.kept.size.fill([0.0; BLOCK]);
        for (i, (size, sign)) in self.size.iter().zip(&self.sign).enumerate() {
            self.kept.size.as_flattened_mut()[i] = size.value();
            let (joints, k) = (&mut self.kept.joints[i / BLOCK], i % BLOCK);
            joints.sign[k] = *sign;
            [joints.free[0][k], joints.free[1][k]] = [free_x[i].value(), free_y[i].value()];
            [joints.along[0][k], joints.along[1][k]] = [along_x[i].value(), along_y[i].value()];
            (joints.passed[k], joints.first[k]) = (1 + 2 * groups[i], 1.0);
            [joints.second[0][k], joints.second[1][k]] = seconds[i];
        }
    }

    /// |R(B s)| - s at the present magnitudes, with the derivatives of each |R|. Returns the largest |R|.
    #[inline(always)]
    fn find_rest<A: Arithmetic>(&mut self) -> f64 {
        let Kept { joints, size, rest, .. } = &mut self.kept;
        for (unknown, row) in self.unknown.iter_mut().zip(blocks(&self.effect).chunks_exact(size.len())) {
            let mut sums = [0.0; BLOCK];
            for (row, size) in row.iter().zip(&*size) {
                sums = A::multiply_add_each(&values(row), size, &sums);
            }
            *unknown = T::constant(total(&sums));
        }
        let (unknown, u) = (&self.unknown[..], [self.unknown[0].value(); BLOCK]);
        let mut largest = [f64::MIN_POSITIVE; BLOCK];
        for ((joints, size), rest) in joints.iter_mut().zip(&*size).zip(rest) {
            let Joints { free, along, sign, passed, first, second, unit } = joints;
            let [a, b, c, d] = *passed;
            let x = values(&[unknown[a], unknown[b], unknown[c], unknown[d]]);
            let y = values(&[unknown[a + 1], unknown[b + 1], unknown[c + 1], unknown[d + 1]]);
            let mut r = [A::multiply_add_each(first, &x, &free[0]), free[1]];
            for axis in 0..2 {
                r[axis] = A::multiply_add_each(&second[axis], &y, &r[axis]);
                r[axis] = A::multiply_add_each(&along[axis], &u, &r[axis]);
            }
            let mut found = [0.0; BLOCK];
            for k in 0..BLOCK {
                found[k] = (r[0][k] * r[0][k] + r[1][k] * r[1][k]).sqrt();
                let inverse = 1.0 / greater(f64::MIN_POSITIVE, found[k]);
                (unit[0][k], unit[1][k]) = (r[0][k] * inverse, r[1][k] * inverse);
            }
            if self.has_normal_forces {
                for k in 0..BLOCK {
                    if sign[k] != 0.0 {
                        (found[k], unit[0][k], unit[1][k]) = (r[0][k] * sign[k], sign[k], 0.0);
                    }
                }
            }
            for k in 0..BLOCK {
                rest[k] = found[k] - size[k];
                largest[k] = greater(largest[k], found[k].abs());
            }
        }
        greater(greater(largest[0], largest[1]), greater(largest[2], largest[3]))
    }

    /// Compute the inverse at the present unknowns. In each row of 1 - D B the diagonal is greater than the sum of the
    /// other elements, so that Gauss and Jordan's elimination needs no pivoting.
    #[inline(always)]
    fn renew<A: Arithmetic>(&mut self) {
        let Kept { inverse, joints, .. } = &mut self.kept;
        let (n, wide) = (self.size.len(), joints.len());
        let effect = blocks(&self.effect);
        for (i, row) in inverse.chunks_exact_mut(wide).enumerate() {
            let (Joints { along, passed, second, unit, .. }, k) = (&joints[i / BLOCK], i % BLOCK);
            let ([x, y], of) = ([unit[0][k], unit[1][k]], passed[k]);
            let slopes = [x * along[0][k] + y * along[1][k], x, x * second[0][k] + y * second[1][k]];
            row.fill([0.0; BLOCK]);
            for (slope, from) in slopes.into_iter().zip([0, of, of + 1]) {
                for (block, effect) in row.iter_mut().zip(&effect[from * wide..]) {
                    *block = A::multiply_add_each(&[-slope; BLOCK], &values(effect), block);
                }
            }
            row[i / BLOCK][k] += 1.0;
        }
        for i in 0..n {
            let (above, rest) = inverse.split_at_mut(i * wide);
            let (row, below) = rest.split_at_mut(wide);
            let pivot = 1.0 / std::mem::replace(&mut row[i / BLOCK][i % BLOCK], 1.0);
            for element in row.as_flattened_mut() {
                *element *= pivot;
            }
            for other in above.chunks_exact_mut(wide).chain(below.chunks_exact_mut(wide)) {
                let factor = [-std::mem::take(&mut other[i / BLOCK][i % BLOCK]); BLOCK];
                for (other, row) in other.iter_mut().zip(&*row) {
                    *other = A::multiply_add_each(&factor, row, other);
                }
            }
        }
        // Its rows become its columns.
        let (elements, wide) = (inverse.as_flattened_mut(), wide * BLOCK);
        for i in 0..n {
            for j in 0..i {
                elements.swap(i * wide + j, j * wide + i);
            }
        }
    }
}

/// Numbers of whole blocks as blocks.
#[inline(always)]
fn blocks<T>(numbers: &[T]) -> &[[T; BLOCK]] {
    numbers.as_chunks().0
}

/// Values of numbers.
#[inline(always)]
fn values<T: Number>(numbers: &[T; BLOCK]) -> Block {
    [numbers[0].value(), numbers[1].value(), numbers[2].value(), numbers[3].value()]
}

/// Sum of a block, of which the processor holds neighbours together.
#[inline(always)]
fn total(sums: &Block) -> f64 {
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}
