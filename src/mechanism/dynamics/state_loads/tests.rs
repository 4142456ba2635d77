//! The gear's friction loop at random states: how far it converges, and how fast.
#![allow(clippy::unwrap_used)]
use crate::mechanism::GEAR;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::reduced::Reduced;
use proptest::prelude::*;
use std::sync::OnceLock;

fn gear() -> &'static Reduced {
    static GEAR_REDUCED: OnceLock<Reduced> = OnceLock::new();
    GEAR_REDUCED.get_or_init(|| {
        let mut mechanism = Mechanism::from_json(GEAR).unwrap();
        mechanism.flags(&mut |flag, value| *value |= flag.name.concat() == "friction.enabled");
        Reduced::new(&mechanism).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_loop_converges_to_rounding_in_a_few_iterations(
        part in 0.0..1.0f64,
        sigma_dot in -150.0..150.0f64,
        force in -40_000.0..40_000.0f64,
        factor in -3.0..6.0f64,
    ) {
        let reduced = gear();
        let state_loads = reduced.state_loads(false).unwrap().unwrap();
        let (first, last) = reduced.curve().range;
        // Off the last 0.02 rad beyond the stops.
        let sigma = first + (0.05 + 0.9 * part) * (last - first);
        let mut sizes = vec![0.0; reduced.components().sized];
        (sizes[0], sizes[1]) = (force, factor);
        let mut scratch = Scratch::new(Some(state_loads));
        let applied = AppliedLoads { version: 0, sizes: &sizes, airspeed: 0.0, revolutions: 0.0, change: None };
        let mut motion = EquationOfMotion::new(reduced, (reduced, Some(state_loads)), applied, &mut scratch);
        motion.effect(sigma, sigma_dot).unwrap();
        let evaluator = &motion.scratch.evaluator;
        let (friction, n) = (&evaluator.friction, state_loads.friction_joints.len());
        prop_assert!(friction.iterations <= 8, "{} iterations", friction.iterations);
        let (effects, reactions) = (evaluator.effects.as_flattened(), evaluator.reactions.as_flattened());
        let balance = super::balance(state_loads, [effects, reactions, &effects[state_loads.inertial()]]);
        let largest = friction.size.iter().fold(0.0, |a: f64, s| a.max(*s));
        for i in 0..n {
            let r = [0, 1].map(|axis| {
                (0..n).fold(balance.free[axis][i], |sum, j| {
                    let passed = balance.passed[axis][balance.groups[i] * n + j];
                    sum + (passed + balance.inertial[axis][i] * balance.influence[j]) * friction.friction(j)
                })
            });
            prop_assert!((r[0].hypot(r[1]) - friction.size[i]).abs() <= 1e-13 * largest, "joint {i}");
        }
    }
}
