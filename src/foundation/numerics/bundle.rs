//! Polynomials side by side, in rows of [`ROW`] functions that a processor evaluates at once.
//!
//! In: monomial coefficients. Out: rows of coefficients, their sums and values. Must not know: what the functions mean.
use super::chebyshev::{NODES, Series};
use super::dual::Number;
use super::processor::{self, Arithmetic, Task};
use super::table::Table;

/// Number of functions in a row.
pub const ROW: usize = 4;

/// Monomial coefficients of [`ROW`] functions, power by power, aligned to cache lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Row([[f64; ROW]; NODES]);

impl Row {
    /// Coefficients of [`ROW`] functions that are 0.
    pub const ZERO: Self = Self([[0.0; ROW]; NODES]);

    /// Replaces the coefficients by those of these functions.
    #[inline]
    pub fn set(&mut self, functions: [&Series; ROW]) {
        for (power, coefficients) in self.0.iter_mut().enumerate() {
            *coefficients = functions.map(|series| series[power]);
        }
    }

    /// Coefficients of these functions.
    #[inline]
    pub fn of(functions: [&Series; ROW]) -> Self {
        let mut row = Self::ZERO;
        row.set(functions);
        row
    }

    /// Adds `size` times other functions.
    #[inline]
    pub fn add(&mut self, size: f64, row: &Self) {
        for (sum, c) in self.0.as_flattened_mut().iter_mut().zip(row.0.as_flattened()) {
            *sum += size * c;
        }
    }
}

/// Functions of a table side by side, panel by panel. The last row of a panel is padded with zeros.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bundle {
    /// Number of rows of a panel.
    rows: usize,
    coefficients: Vec<Row>,
}

impl Bundle {
    /// The functions with these component indices of a table, side by side.
    pub fn new(table: &Table, components: impl Iterator<Item = usize> + Clone) -> Self {
        let mut coefficients = Vec::new();
        for panel in 0..table.panels() {
            side_by_side(components.clone().map(|component| table.series(panel, component)), &mut coefficients);
        }
        Self { rows: Self::rows(components.count()), coefficients }
    }

    /// Number of rows for a number of functions.
    pub fn rows(functions: usize) -> usize {
        functions.div_ceil(ROW)
    }

    /// Coefficients on one panel.
    #[inline]
    pub fn panel(&self, panel: usize) -> &[Row] {
        &self.coefficients[panel * self.rows..(panel + 1) * self.rows]
    }
}

/// Appends the coefficients of functions on one panel, side by side, to `out`.
pub fn side_by_side<'a>(functions: impl IntoIterator<Item = &'a Series>, out: &mut Vec<Row>) {
    for (i, series) in functions.into_iter().enumerate() {
        if i % ROW == 0 {
            out.push(Row::ZERO);
        }
        if let Some(row) = out.last_mut() {
            for (power, c) in row.0.iter_mut().zip(series) {
                power[i % ROW] = *c;
            }
        }
    }
}

/// Adds `size` times the functions in `rows` to `sums`, which is empty or has the same number of rows.
pub fn add_side_by_side(sums: &mut Vec<Row>, size: f64, rows: &[Row]) {
    if sums.is_empty() {
        sums.extend(rows.iter().map(|row| Row(row.0.map(|power| power.map(|c| size * c)))));
        return;
    }
    sums.iter_mut().zip(rows).for_each(|(sum, row)| sum.add(size, row));
}

/// Values of functions side by side at x. If x carries derivatives, the values do too.
#[inline(never)]
pub fn side_by_side_at<T: Number>(rows: &[Row], x: T, values: &mut [[T; ROW]]) {
    each_at(rows, [x; ROW], values);
}

/// [`side_by_side_at`] with a separate x for each function of a row.
#[inline]
pub fn each_at<T: Number>(rows: &[Row], x: [T; ROW], values: &mut [[T; ROW]]) {
    processor::run(Evaluation { rows, x, values });
}

/// Rows to evaluate, with the x of each function of a row.
struct Evaluation<'a, T> {
    rows: &'a [Row],
    x: [T; ROW],
    values: &'a mut [[T; ROW]],
}

impl<T: Number> Task for Evaluation<'_, T> {
    type Result = ();

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        // A closure in a function of an iterator might be compiled without the features of the processor.
        for (values, row) in self.values.iter_mut().zip(self.rows) {
            *values = row_at::<A, T>(row, &self.x);
        }
    }
}

/// Sum over terms of up to P rows each: the values of each term times its size. Each function of a row has its x.
#[inline(never)]
pub fn sum_at<T: Number, const P: usize>(terms: (&[Row], usize), sizes: &[T], x: [T; ROW]) -> [[T; ROW]; P] {
    processor::run(Terms { terms, sizes, x })
}

/// Terms to sum: their rows with the number of rows of each, their sizes.
struct Terms<'a, T, const P: usize> {
    terms: (&'a [Row], usize),
    sizes: &'a [T],
    x: [T; ROW],
}

impl<T: Number, const P: usize> Task for Terms<'_, T, P> {
    type Result = [[T; ROW]; P];

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> Self::Result {
        let mut sums = [[T::constant(0.0); ROW]; P];
        let (rows, parts) = self.terms;
        for (term, &size) in rows.chunks_exact(parts.max(1)).zip(self.sizes) {
            for (sum, row) in sums.iter_mut().zip(term) {
                let values = row_at::<A, T>(row, &self.x);
                *sum = std::array::from_fn(|k| sum[k] + size * values[k]);
            }
        }
        sums
    }
}

/// Values of the functions of a row, each at its x.
#[inline(always)]
fn row_at<A: Arithmetic, T: Number>(row: &Row, x: &[T; ROW]) -> [T; ROW] {
    let at = &x.map(T::value);
    let changes = T::CARRIES && !x.iter().all(|x| x.is_constant());
    let values = polynomials::<A>(row, at);
    let first = if changes { slopes::<A>(row, at) } else { [0.0; ROW] };
    let second = if T::CARRIES_SECOND && changes { curvatures::<A>(row, at) } else { [0.0; ROW] };
    std::array::from_fn(|i| x[i].compose([values[i], first[i], second[i]]))
}

/// a x + b, element by element.
#[inline(always)]
fn multiply_add<A: Arithmetic>(a: &[f64; ROW], x: &[f64; ROW], b: &[f64; ROW]) -> [f64; ROW] {
    std::array::from_fn(|i| A::multiply_add(a[i], x[i], b[i]))
}

/// Values at x: four independent Horner schemes in x^4, one for each residue of the power modulo 4.
#[inline(always)]
fn polynomials<A: Arithmetic>(row: &Row, x: &[f64; ROW]) -> [f64; ROW] {
    let x2 = &x.map(|x| x * x);
    let x4 = &x2.map(|x| x * x);
    let powers = &row.0;
    let mut sums = [powers[NODES - 4], powers[NODES - 3], powers[NODES - 2], powers[NODES - 1]];
    for four in powers[..NODES - 4].rchunks_exact(4) {
        for (sum, c) in sums.iter_mut().zip(four) {
            *sum = multiply_add::<A>(sum, x4, c);
        }
    }
    let even = multiply_add::<A>(&sums[2], x2, &sums[0]);
    let odd = multiply_add::<A>(&sums[3], x2, &sums[1]);
    multiply_add::<A>(&odd, x, &even)
}

/// Derivatives at x, by Horner's scheme.
#[inline(always)]
fn slopes<A: Arithmetic>(row: &Row, x: &[f64; ROW]) -> [f64; ROW] {
    derivatives::<A>(row, x, 1, |k| k as f64)
}

/// Second derivatives at x, by Horner's scheme.
#[inline(always)]
fn curvatures<A: Arithmetic>(row: &Row, x: &[f64; ROW]) -> [f64; ROW] {
    derivatives::<A>(row, x, 2, |k| (k * (k - 1)) as f64)
}

/// Derivatives of this order at x. `factor`: coefficient of this derivative of x^k.
#[inline(always)]
fn derivatives<A: Arithmetic>(row: &Row, x: &[f64; ROW], order: usize, factor: impl Fn(usize) -> f64) -> [f64; ROW] {
    let mut sums = [0.0; ROW];
    for (k, power) in row.0.iter().enumerate().skip(order).rev() {
        sums = multiply_add::<A>(&sums, x, &power.map(|c| factor(k) * c));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dual::{Dual, Nested};
    use crate::numerics::processor::{Fused, Separate};
    use crate::numerics::table::polynomial_at;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn values_and_slopes_are_those_of_horner(x in -1.0..1.0f64, c in proptest::array::uniform16(-1.0..1.0f64)) {
            let value = c.iter().rev().fold(0.0, |sum, c| sum * x + c);
            let slope = c.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c * x.powi(k as i32 - 1)).sum::<f64>();
            let dual = polynomial_at(&c, Dual::<1>::variable(x, 0));
            // Sixteen terms, the largest slope times 15.
            prop_assert!((polynomial_at(&c, x) - value).abs() < 1e-14);
            prop_assert!((dual.value - value).abs() < 1e-14 && (dual.slope[0] - slope).abs() < 2e-13);
            let mut rows = Vec::new();
            side_by_side([&[1.0; NODES], &c], &mut rows);
            let mut values = [[Dual::<1>::constant(1.0); ROW]];
            side_by_side_at(&rows, Dual::<1>::variable(x, 0), &mut values);
            prop_assert!((values[0][1].value - value).abs() < 1e-14 && (values[0][1].slope[0] - slope).abs() < 2e-13);
            prop_assert_eq!(values[0][2].value, 0.0);
        }
    }

    proptest! {
        /// A function of a row that is evaluated at its own x has the same bits as in an evaluation at one common x.
        #[test]
        fn each_function_has_its_own_x(x in proptest::array::uniform4(-1.0..1.0f64),
            c in proptest::array::uniform16(-1.0..1.0f64)) {
            let rows = [Row::of([&c, &c.map(|c| -c), &[1.0; NODES], &c])];
            let x: [Dual<1>; ROW] = std::array::from_fn(|k| Dual::variable(x[k], 0));
            let zero = [[Dual::<1>::constant(0.0); ROW]];
            let (mut each, mut one) = (zero, zero);
            each_at(&rows, x, &mut each);
            for (k, &x) in x.iter().enumerate() {
                side_by_side_at(&rows, x, &mut one);
                prop_assert_eq!(each[0][k], one[0][k]);
            }
        }
    }

    proptest! {
        /// The sum of terms is the sum of sizes times values by Horner's scheme, row by row of a term.
        #[test]
        fn terms_have_the_sums_of_values(sizes in proptest::array::uniform2(-9.0..9.0f64),
            c in proptest::array::uniform16(-1.0..1.0f64), x in -1.0..1.0f64) {
            let functions = [c, c.map(|c| 1.0 - c), [0.5; NODES], c.map(|c| -c)];
            let rows = functions.each_ref().map(|function| Row::of([function; ROW]));
            let sums: [[f64; ROW]; 3] = sum_at((&rows, 2), &sizes, [x; ROW]);
            let horner = |k: usize| functions[k].iter().rev().fold(0.0, |sum, c| sum * x + c);
            for (part, sum) in sums[..2].iter().enumerate() {
                let expected = sizes[0] * horner(part) + sizes[1] * horner(2 + part);
                // Two terms of 16 powers, each at most 18 in size.
                prop_assert!((sum[0] - expected).abs() < 32.0 * 18.0 * f64::EPSILON);
            }
            prop_assert_eq!(sums[2], [0.0; ROW]);
        }
    }

    proptest! {
        /// Both arithmetics agree to rounding errors in values and derivatives, and this processor gives exactly one of
        /// them.
        #[test]
        fn fused_and_separate_differ_by_rounding(x in -1.0..1.0f64, c in proptest::array::uniform16(-1.0..1.0f64)) {
            let mut rows = Vec::new();
            side_by_side([&c, &c.map(|c| -c), &[1.0; NODES], &c, &c], &mut rows);
            let at = Nested { value: Dual::variable(x, 0), slope: Dual::constant(1.0) };
            let [mut fused, mut separate, mut here] = [[[Nested::constant(0.0); ROW]; 2]; 3];
            Evaluation { rows: &rows, x: [at; ROW], values: &mut fused }.run::<Fused>();
            Evaluation { rows: &rows, x: [at; ROW], values: &mut separate }.run::<Separate>();
            side_by_side_at(&rows, at, &mut here);
            for (a, b) in fused.as_flattened().iter().zip(separate.as_flattened()) {
                prop_assert!((a.value.value - b.value.value).abs() < 1e-14);
                // 15 and 15 * 14 times as large as values.
                prop_assert!((a.slope.value - b.slope.value).abs() < 1.5e-13);
                prop_assert!((a.slope.slope[0] - b.slope.slope[0]).abs() < 2.1e-12);
            }
            prop_assert!(here == fused || here == separate);
        }
    }
}
