//! Published benchmark mechanisms against reference values of two independent formulations with at least 32 digits.

mod andrews;
mod chain;
mod slcrank;

use crate::support::Run;

/// A mechanism at its start, with this tolerance of the integration.
fn run(text: &str, tolerance: f64) -> Run {
    Run::new(text).with(&[("solver.tolerance", tolerance)]).started()
}

/// Check that a variable has its exact value, with this absolute tolerance.
fn check(run: &mut Run, name: &str, exact: f64, allowed: f64) {
    close(name, run.get(name), exact, allowed);
}

fn close(what: &str, value: f64, exact: f64, allowed: f64) {
    let error = (value - exact).abs();
    assert!(error <= allowed, "{what} = {value:e}, not {exact:e}: error {error:.2e}, allowed {allowed:.2e}");
}
