//! The examples of the pages of the elements, each in its complete file.

use crate::reference::{Example, examples};
use crate::support::validator;
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::Kind;

#[test]
fn every_example_runs() {
    let validator = validator();
    let (mut wholes, mut parts) = (0, 0);
    for Example { page, part, whole, .. } in examples() {
        let text = format!("{page}:\n{part:#}");
        *(if part == whole { &mut wholes } else { &mut parts }) += 1;
        let errors: Vec<String> =
            validator.iter_errors(&whole).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{errors:?} in\n{text}");
        let mut model = Model::from_json(&whole.to_string()).unwrap_or_else(|e| panic!("{e} in\n{text}"));
        model.initialize().unwrap_or_else(|e| panic!("{e} in\n{text}"));
        let drift = model.variables().find("energy.drift").unwrap();
        for _ in 0..10 {
            model.step(1e-3).unwrap_or_else(|e| panic!("{e} in\n{text}"));
        }
        let crosses = whole["name"] == "Parallelogram";
        for (reference, variable) in (0..).zip(model.variables().list().to_vec()) {
            if variable.kind == Kind::Boolean {
                model.boolean(reference).unwrap_or_else(|e| panic!("{e} in\n{text}"));
                continue;
            }
            if variable.kind == Kind::Enumeration {
                model.item(reference).unwrap_or_else(|e| panic!("{e} in\n{text}"));
                continue;
            }
            let value = model.real(reference).unwrap_or_else(|e| panic!("{e} in\n{text}"));
            // The page describes this for reactions at crossings.
            let is_of_exchange = whole["solver"]["method"] == "rigid_fem" && variable.name.starts_with("along_curve.");
            let may_be_undefined = crosses && variable.name.contains(".force") || is_of_exchange;
            let reason = model.undefined(reference);
            assert!(value.is_finite() || may_be_undefined, "{} = {value}, {reason:?} in\n{text}", variable.name);
        }
        let lost = model.real(drift).unwrap();
        assert!(lost.abs() < 1e-6, "energy.drift {lost} J in\n{text}");
    }
    assert!(wholes >= 5 && parts >= 25, "{wholes} whole mechanisms and {parts} parts found");
}
