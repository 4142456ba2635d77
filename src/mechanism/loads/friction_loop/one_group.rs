//! The loop of up to four joints of one group, unrolled: three unknowns.
//!
//! In: arms, reactions as affine functions of the friction. Out: the solution, if Newton's method finds it in a few
//! iterations. It must not know the law of friction.
use super::{Balance, CONVERGED, FEW, FrictionLoop, are_near, greater, length_bound, norm};
use crate::numerics::dual::Number;

impl<T: Number> FrictionLoop<T> {
    /// [`Self::solve`] for one group of N joints. False if it takes too many iterations or a determinant is not
    /// positive.
    #[inline]
    pub(super) fn solve_one<const N: usize>(&mut self, t: f64, balance: &Balance<T>) -> bool {
        let [Some(free_x), Some(free_y)] = balance.free.map(<[T]>::first_chunk::<N>) else { return false };
        let [Some(along_x), Some(along_y)] = balance.inertial.map(<[T]>::first_chunk::<N>) else { return false };
        let [Some(passed_x), Some(passed_y)] = balance.passed.map(<[T]>::first_chunk::<N>) else { return false };
        let (Some(influence), Some(arm)) = (balance.influence.first_chunk::<N>(), self.arm.first_chunk::<N>()) else {
            return false;
        };
        let effect = [influence, passed_x, passed_y].map(|row| std::array::from_fn::<T, N, _>(|j| -(row[j] * arm[j])));
        let contracts = is_contraction(&effect, along_x, along_y);
        let zero = T::constant(0.0);
        let (mut x, mut y, mut sizes) = (*free_x, *free_y, [zero; N]);
        let mut z = [zero; 3];
        for i in 0..N {
            sizes[i] = norm([x[i], y[i]]);
        }
        for k in 0..3 {
            z[k] = dot(&effect[k], &sizes);
        }
        let (free, without) = (sizes, z);
        // A solution that is not unique is found from the frictionless one.
        if contracts {
            let added = self.prediction.at(t);
            for k in 0..3 {
                z[k] = z[k] + T::constant(added[k]);
            }
        }
        for iteration in 1..=FEW {
            // Derivatives of each |R| with respect to the unknowns.
            let mut slopes = [[0.0; N]; 3];
            let mut inverse = [0.0; N];
            for i in 0..N {
                x[i] = free_x[i] + along_x[i] * z[0] + z[1];
                y[i] = free_y[i] + along_y[i] * z[0] + z[2];
                let square = x[i] * x[i] + y[i] * y[i];
                sizes[i] = square.sqrt();
                // This quotient does not depend on the square root, so both are computed at once.
                inverse[i] = sizes[i].value() * (1.0 / greater(f64::MIN_POSITIVE, square.value()));
                slopes[1][i] = x[i].value() * inverse[i];
                slopes[2][i] = y[i].value() * inverse[i];
                slopes[0][i] = slopes[1][i] * along_x[i].value() + slopes[2][i] * along_y[i].value();
            }
            // I - B d|R|/dz.
            let mut matrix = [[0.0; 3]; 3];
            let mut rest = [zero; 3];
            for k in 0..3 {
                rest[k] = dot(&effect[k], &sizes) - z[k];
                for l in 0..3 {
                    let mut sums = [0.0; 2];
                    for j in 0..N {
                        sums[j % 2] += effect[k][j].value() * slopes[l][j];
                    }
                    matrix[k][l] = f64::from(u8::from(k == l)) - (sums[0] + sums[1]);
                }
            }
            let (step, determinant) = solve_three(&matrix, &rest);
            if determinant.is_nan() || determinant <= 0.0 {
                return false;
            }
            // Error that is left, summed over all reactions.
            let errors: [f64; N] = std::array::from_fn(|i| {
                let dx = along_x[i].value() * step[0].value() + step[1].value();
                let dy = along_y[i].value() * step[0].value() + step[2].value();
                (dx * dx + dy * dy) * inverse[i]
            });
            let error = total_of(&errors) / greater(f64::MIN_POSITIVE, total_of(&sizes.map(T::value)));
            for k in 0..3 {
                z[k] = z[k] + step[k];
            }
            if error < CONVERGED {
                self.iterations = iteration;
                self.prediction.learn(t, std::array::from_fn(|k| (z[k] - without[k]).value()));
                for (i, size) in self.size.iter_mut().enumerate() {
                    *size = sizes[i];
                    for k in 0..3 {
                        *size = *size + step[k] * T::constant(slopes[k][i]);
                    }
                }
                return contracts || are_near(&self.size, free.iter().map(|size| size.value()));
            }
        }
        false
    }
}

/// Whether the friction of N joints of one group changes the reactions that cause it by less than these change: then
/// there is one solution, and it is connected with the frictionless one. `effect` is B, `along` are reactions to
/// sigma_ddot = 1; a reaction |R| changes by at most |along| for each unit of u, and as much as P_g.
#[inline(always)]
fn is_contraction<T: Number, const N: usize>(effect: &[[T; N]; 3], along_x: &[T; N], along_y: &[T; N]) -> bool {
    let [mut along, mut passed, mut largest] = [0.0; 3];
    for j in 0..N {
        along += effect[0][j].value().abs();
        passed += length_bound(effect[1][j], effect[2][j]);
        largest = greater(largest, length_bound(along_x[j], along_y[j]));
    }
    along * largest + passed < 1.0
}

/// Inner product of short vectors: two independent sums, over even and over odd indices.
#[inline]
fn dot<T: Number, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    let mut sums = [a[0] * b[0], if N > 1 { a[1] * b[1] } else { T::constant(0.0) }];
    for j in 2..N {
        sums[j % 2] = sums[j % 2] + a[j] * b[j];
    }
    sums[0] + sums[1]
}

/// Sum of a few numbers: two independent sums, over even and over odd indices.
#[inline]
fn total_of<const N: usize>(a: &[f64; N]) -> f64 {
    let mut sums = [0.0; 2];
    for j in 0..N {
        sums[j % 2] += a[j];
    }
    sums[0] + sums[1]
}

/// Solution of three linear equations by cofactors, and their determinant.
#[inline]
pub(super) fn solve_three<T: Number>(a: &[[f64; 3]; 3], b: &[T; 3]) -> ([T; 3], f64) {
    let minor = |i: usize, j: usize| {
        let ((r, s), (t, u)) = (((i + 1) % 3, (i + 2) % 3), ((j + 1) % 3, (j + 2) % 3));
        a[r][t] * a[s][u] - a[r][u] * a[s][t]
    };
    let first = [minor(0, 0), minor(0, 1), minor(0, 2)];
    let determinant = a[0][0] * first[0] + a[0][1] * first[1] + a[0][2] * first[2];
    let inverse = T::constant(1.0 / determinant);
    let mut solution = *b;
    for j in 0..3 {
        let sum = b[0] * T::constant(first[j]) + b[1] * T::constant(minor(1, j)) + b[2] * T::constant(minor(2, j));
        solution[j] = sum * inverse;
    }
    (solution, determinant)
}
