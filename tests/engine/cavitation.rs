//! A chamber whose pressure falls to absolute zero.
use crate::support::{HYDRAULIC_GEAR, Run};

/// If the motion expands a chamber down to absolute zero, each step ends, with finite absolute pressures above 0.
#[test]
fn a_pressure_is_a_number_above_absolute_zero() {
    let mut lowest = 0.0_f64;
    for tolerance in [1e-1, 1e-2, 1e-3, 1e-5, 1e-9] {
        for h in [1e-4, 1e-3, 1e-2] {
            for (torque, air) in [(1e4, 0.005), (-1e4, 0.005), (1e5, 0.05), (-1e5, 1e-6), (1e6, 0.005), (-1e6, 0.005)] {
                let mut gear = Run::shared(HYDRAULIC_GEAR);
                gear.set_all(&[
                    ("fluid.air_fraction", air),
                    ("solver.tolerance", tolerance),
                    ("command.ramp_amplitude", 0.0),
                ]);
                gear.set_all(&[("anticavitation.conductance", 0.0), ("check.pressure", 1e9)]);
                gear.initialize();
                gear.set("crank.torque", torque);
                for _ in 0..200 {
                    gear.step(h);
                    for chamber in ["chamber_a.pressure", "chamber_b.pressure"] {
                        let pressure = gear.get(chamber);
                        lowest = lowest.min(pressure);
                        assert!(
                            pressure.is_finite() && pressure > -101325.0,
                            "{chamber} = {pressure} at {tolerance}, {torque}, {air}, {h} s"
                        );
                    }
                }
            }
        }
    }
    assert!(lowest < -100_000.0, "no chamber was drawn near absolute zero: {lowest} Pa");
}
