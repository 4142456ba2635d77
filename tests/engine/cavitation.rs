//! A chamber that is drawn to absolute zero.
use crate::support::{HYDRAULIC_GEAR, Run, assert_says};
use linkage_fmu::mechanism::Model;

/// However a chamber is drawn to absolute zero, a step ends with finite pressures above it or is refused. In some of these
/// histories the interpolant of a step has no number there, which is refused by the name of the chamber.
#[test]
fn a_pressure_that_is_no_number_ends_the_step() {
    let mut refused = 0;
    for tolerance in [1e-1, 1e-2, 1e-3, 1e-5, 1e-9] {
        for h in [1e-4, 1e-3, 1e-2] {
            for (torque, air) in [(1e4, 0.005), (-1e4, 0.005), (1e5, 0.05), (-1e5, 1e-6), (1e6, 0.005), (-1e6, 0.005)] {
                let mut gear = Run::shared(HYDRAULIC_GEAR);
                gear.set_all(&[("fluid.air_fraction", air), ("solver.tolerance", tolerance)]);
                gear.set_all(&[("anticavitation.conductance", 0.0), ("check.pressure", 1e9)]);
                gear.initialize();
                gear.set("crank.torque", torque);
                for _ in 0..200 {
                    if let Err(error) = Model::step(&mut gear, h) {
                        let text = error.to_string();
                        if text.contains("NaN") {
                            assert_says(&text, &["chamber_", "is not above absolute zero", "solver.tolerance"]);
                            refused += 1;
                        }
                        break;
                    }
                    for chamber in ["chamber_a.pressure", "chamber_b.pressure"] {
                        let pressure = gear.get(chamber);
                        assert!(pressure > -101325.0, "{chamber} = {pressure} at {tolerance}, {torque}, {air}, {h} s");
                    }
                }
            }
        }
    }
    assert!(refused > 0, "no history came to a pressure that is no number");
}
