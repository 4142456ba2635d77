//! The largest eigenvalue.
use crate::integrator::control::stiffness::largest_eigenvalue;

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
