//! A start that is the guess itself lies where the trace begins: between two panels, on a closed curve at its seam.

use linkage_fmu::mechanism::Model;

const JIB: &str = include_str!("../../modelDescription/Jib/resources/mechanism.json");
const CRANK: &str = include_str!("../../modelDescription/SliderCrank/resources/mechanism.json");

#[test]
fn the_guess_is_a_start() {
    let mut refused = Vec::new();
    for k in 0..100 {
        let angle = -3.0 + 0.0651 * f64::from(k);
        let jib = JIB.replace("-0.299", &format!("{angle}"));
        let crank = CRANK
            .replace("\"angle\": -1.5707963267948966", &format!("\"angle\": {angle}"))
            .replace("\"crank\": -1.5", &format!("\"crank\": {angle}"));
        for (name, text) in [("jib", jib), ("crank", crank)] {
            match Model::from_json(&text) {
                Ok(mut model) => {
                    let reference = model.variables().find(&format!("{name}.angle")).unwrap();
                    assert!((model.real(reference).unwrap() - angle).abs() < 1e-13 * angle.abs().max(1.0));
                }
                Err(e) => refused.push(format!("{name} {angle}: {e}")),
            }
        }
    }
    assert!(refused.is_empty(), "{} of 200 refused: {}", refused.len(), refused[0]);
}
