//! A start at the guess is at the origin of the curve: between two panels, and on a closed curve at its seam.

use crate::support::{JIB, SLIDER_CRANK};
use linkage_fmu::simulation::Simulation;

#[test]
fn the_guess_is_a_start() {
    let mut refused = Vec::new();
    for k in 0..100 {
        let angle = -3.0 + 0.0651 * f64::from(k);
        let jib = JIB.replace("-0.299", &format!("{angle}"));
        let crank = SLIDER_CRANK
            .replace("\"angle\": -1.5707963267948966", &format!("\"angle\": {angle}"))
            .replace("\"crank\": -1.5", &format!("\"crank\": {angle}"));
        for (name, text) in [("jib", jib), ("crank", crank)] {
            match Simulation::open(&text) {
                Ok(mut run) => {
                    let error = run.get(&format!("{name}.angle")).unwrap() - angle;
                    assert!(error.abs() < 1e-13 * angle.abs().max(1.0));
                }
                Err(e) => refused.push(format!("{name} {angle}: {e}")),
            }
        }
    }
    assert!(refused.is_empty(), "{} of 200 refused: {}", refused.len(), refused[0]);
}
