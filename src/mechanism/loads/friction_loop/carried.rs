//! The loop of numbers that carry derivatives: the values are solved first, the derivatives follow from the equations.
//!
//! In: arms and reactions with derivatives. Out: the solution with its derivatives. It must not know the law of
//! friction.
use super::any::{eliminate, total};
use super::one_group::solve_three;
use super::{Balance, FrictionLoop, Locked, greater, norm};
use crate::numerics::dual::Number;

/// The loop of the values alone.
#[derive(Clone, Debug)]
pub struct Values {
    own: FrictionLoop<f64>,
    /// Rows of the balance, one after the other.
    rows: Vec<f64>,
}

impl Values {
    /// For n joints in a number of groups.
    pub fn new(n: usize, groups: usize) -> Self {
        Self { own: FrictionLoop::new(n, groups), rows: vec![0.0; (5 + 2 * groups) * n] }
    }
}

impl<T: Number> FrictionLoop<T> {
    /// [`Self::solve`] of numbers that carry derivatives. A correction at the solution gives the first derivatives,
    /// another one the second derivatives.
    pub(super) fn solve_carried(&mut self, balance: &Balance<T>) -> Result<(), Locked> {
        let (n, Some(Values { own, rows })) = (self.arm.len(), self.values.as_deref_mut()) else { return Ok(()) };
        if n == 0 {
            return Ok(());
        }
        let ([free_x, free_y], [along_x, along_y], [first, second]) = (balance.free, balance.inertial, balance.passed);
        let mut to = rows.iter_mut();
        for row in [free_x, free_y, along_x, along_y, balance.influence, first, second] {
            row.iter().zip(to.by_ref()).for_each(|(number, to)| *to = number.value());
        }
        let (rows, passed) = rows.split_at(5 * n);
        let row = |k: usize| &rows[k * n..(k + 1) * n];
        let values = Balance {
            free: [row(0), row(1)],
            inertial: [row(2), row(3)],
            influence: row(4),
            passed: passed.split_at(passed.len() / 2).into(),
            groups: balance.groups,
            seconds: balance.seconds,
        };
        own.arm.iter_mut().zip(&self.arm).for_each(|(own, arm)| *own = arm.value());
        own.sign.copy_from_slice(&self.sign);
        (own.constant, own.has_normal_forces) = (self.constant, self.has_normal_forces);
        own.solve(&values)?;
        self.size.iter_mut().zip(&own.size).for_each(|(size, value)| *size = T::constant(*value));
        self.iterations = own.iterations;
        if balance.passed[0].len() == n && !self.has_normal_forces {
            return self.correct_one_group(balance);
        }
        self.set_effects(balance);
        let wide = self.wide();
        for (unknown, row) in self.unknown.iter_mut().zip(self.effect.chunks_exact(wide)) {
            *unknown = total(row, &self.size);
        }
        for _ in 0..=u32::from(T::CARRIES_SECOND) {
            self.correct_unknowns(balance)?;
        }
        Ok(())
    }

    /// The same for joints of one group without held signs, of which there are three unknowns.
    fn correct_one_group(&mut self, balance: &Balance<T>) -> Result<(), Locked> {
        let n = self.arm.len();
        let slopes = &mut self.direction[..n];
        let (arm, sizes, [free_x, free_y]) = (&self.arm[..n], &mut self.size[..n], balance.free.map(|row| &row[..n]));
        let ([along_x, along_y], influence) = (balance.inertial.map(|row| &row[..n]), &balance.influence[..n]);
        let [passed_x, passed_y] = balance.passed.map(|row| &row[..n]);
        let effect = |j: usize| [influence[j], passed_x[j], passed_y[j]].map(|row| -(row * arm[j]));
        let mut z = [T::constant(0.0); 3];
        for (j, size) in sizes.iter().enumerate() {
            for (z, effect) in z.iter_mut().zip(effect(j)) {
                *z = *z + effect * size.value();
            }
        }
        for _ in 0..=u32::from(T::CARRIES_SECOND) {
            let (mut matrix, mut rest) = ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], z.map(|z| -z));
            for j in 0..n {
                let r = [free_x[j] + along_x[j] * z[0] + z[1], free_y[j] + along_y[j] * z[0] + z[2]];
                let inverse = 1.0 / greater(f64::MIN_POSITIVE, sizes[j].value());
                let [x, y] = r.map(|r| r.value() * inverse);
                sizes[j] = if T::CARRIES_SECOND { norm(r) } else { r[0] * x + r[1] * y };
                slopes[j] = [x * along_x[j].value() + y * along_y[j].value(), x, y];
                for ((effect, row), rest) in effect(j).into_iter().zip(&mut matrix).zip(&mut rest) {
                    *rest = *rest + effect * sizes[j];
                    row.iter_mut().zip(slopes[j]).for_each(|(element, slope)| *element -= effect.value() * slope);
                }
            }
            let (step, determinant) = solve_three(&matrix, &rest);
            if determinant.is_nan() || determinant <= 0.0 {
                return Err(Locked);
            }
            for k in 0..3 {
                z[k] = z[k] + step[k];
            }
            for (size, slopes) in sizes.iter_mut().zip(&*slopes) {
                *size = *size + step[0] * slopes[0] + step[1] * slopes[1] + step[2] * slopes[2];
            }
        }
        Ok(())
    }

    /// A correction of the unknowns z. With D = d|R| / dz it solves (1 - B D) dz = B |R(z)| - z.
    fn correct_unknowns(&mut self, balance: &Balance<T>) -> Result<(), Locked> {
        let (n, wide, unknowns) = (self.arm.len(), self.wide(), self.unknown.len());
        for i in 0..n {
            self.size[i] = self.find_size(i, balance);
        }
        for (k, row) in self.effect.chunks_exact(wide).enumerate() {
            self.rest[k] = total(row, &self.size) - self.unknown[k];
            let matrix = &mut self.matrix[k * unknowns..][..unknowns];
            matrix.fill(0.0);
            matrix[k] = 1.0;
            for ((effect, group), slopes) in row.iter().zip(balance.groups).zip(&self.direction) {
                for (slope, column) in slopes.iter().zip([0, 1 + 2 * group, 2 + 2 * group]) {
                    matrix[column] -= effect.value() * slope;
                }
            }
        }
        let determinant = eliminate(&mut self.matrix[..unknowns * unknowns], &mut self.rest[..unknowns]);
        if determinant.is_nan() || determinant <= 0.0 {
            return Err(Locked);
        }
        self.unknown.iter_mut().zip(&self.rest).for_each(|(unknown, step)| *unknown = *unknown + *step);
        for ((size, group), slopes) in self.size.iter_mut().zip(balance.groups).zip(&self.direction) {
            for (slope, row) in slopes.iter().zip([0, 1 + 2 * group, 2 + 2 * group]) {
                *size = *size + self.rest[row] * *slope;
            }
        }
        Ok(())
    }
}
