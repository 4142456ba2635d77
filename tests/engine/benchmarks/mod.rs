//! Published benchmark mechanisms against values that two independent formulations gave in 32 and more digits.

mod andrews;
mod chain;
mod slcrank;

use crate::support::Run;

/// A mechanism at its start, to be integrated with this tolerance.
fn run(text: &str, tolerance: f64) -> Run {
    Run::new(text).with(&[("solver.tolerance", tolerance)]).started()
}

/// Check a variable, to an absolute allowance.
fn check(run: &mut Run, name: &str, exact: f64, allowed: f64) {
    close(name, run.get(name), exact, allowed);
}

fn close(what: &str, value: f64, exact: f64, allowed: f64) {
    let error = (value - exact).abs();
    assert!(error <= allowed, "{what} = {value:e}, not {exact:e}: error {error:.2e}, allowed {allowed:.2e}");
}
