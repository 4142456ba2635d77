//! Linear systems and eigenvalues of three rows.
use crate::integrator::linear::{Complex, Factors, largest_eigenvalue};
use proptest::prelude::*;

proptest! {
    #[test]
    fn solutions_satisfy_their_systems(
        a in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
        im in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
        x in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        if let Some(factors) = Factors::new(a) {
            let b: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| a[i][j] * x[j]).sum());
            let y = factors.solve(b);
            // Backward stable: the residual is small whatever the condition.
            let size = y.iter().fold(1.0_f64, |m, y| m.max(y.abs()));
            for i in 0..3 {
                let residual = b[i] - (0..3).map(|j| a[i][j] * y[j]).sum::<f64>();
                prop_assert!(residual.abs() < 1e-14 * size, "{residual}");
            }
        }
        let c: [[Complex; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| Complex { re: a[i][j], im: im[i][j] }));
        if let Some(factors) = Factors::new(c) {
            let z = x.map(|x| Complex { re: x, im: 1.0 - x });
            let b: [Complex; 3] = std::array::from_fn(|i| {
                (0..3).fold(Complex { re: 0.0, im: 0.0 }, |sum, j| sum + c[i][j] * z[j])
            });
            let y = factors.solve(b);
            let size = y.iter().fold(1.0_f64, |m, y| m.max(y.re.abs() + y.im.abs()));
            for i in 0..3 {
                let residual = (0..3).fold(b[i], |sum, j| sum - c[i][j] * y[j]);
                prop_assert!(residual.re.abs() + residual.im.abs() < 1e-13 * size, "{residual:?}");
            }
        }
    }
}

#[test]
fn a_singular_system_has_no_factors() {
    assert!(Factors::new([[1.0, 2.0], [2.0, 4.0]]).is_none());
    assert!(Factors::new([[f64::NAN, 2.0], [2.0, 4.0]]).is_none());
}

#[test]
fn the_largest_eigenvalue_depends_on_no_units() {
    // (sigma, sigma_dot, energy): eigenvalues of [[0, 1], [-k, -d]] and 0; the energy's unit changes its row only.
    for (k, d, unit) in [(4.0, 1e7, 1.0), (1e6, 3e4, 1e9), (1.0, 1e3, 1e-12)] {
        let a = [[0.0, 1.0, 0.0], [-k, -d, 0.0], [0.3 * unit, 2.0 * d * unit, 0.0]];
        let exact = 0.5 * d + f64::sqrt(0.25 * d * d - k);
        let found = largest_eigenvalue(&a);
        assert!(found >= 0.999 * exact && found <= 1.15 * exact, "{found} against {exact}");
    }
}
