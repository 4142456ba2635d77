//! The law against its definition.
use super::*;
use crate::numerics::dual::Dual;
use proptest::prelude::*;

const LAW: Law =
    Law { sticks: false, static_coefficient: 0.19, kinetic_coefficient: 0.026, static_speed: 0.01, kinetic_speed: 1.0 };

fn mu(v: f64) -> f64 {
    LAW.cubic(LAW.regime(v)).at(v)
}

#[test]
fn law_passes_through_its_points() {
    assert_eq!(mu(0.0), 0.0);
    assert!((mu(0.005) - 0.095).abs() < 1e-16);
    assert!((mu(0.01) - 0.19).abs() < 1e-16);
    // Half way, the cubic step is half way.
    assert!((mu(0.505) - 0.5 * (0.19 + 0.026)).abs() < 1e-15);
    assert!((mu(1.0) - 0.026).abs() < 1e-16);
    assert_eq!(mu(7.0), 0.026);
}

proptest! {
    #[test]
    fn law_is_odd_and_its_derivative_is_that_of_differences(v in -2.0..2.0f64) {
        prop_assert_eq!(mu(-v), -mu(v));
        let kink = [0.0, LAW.static_speed, LAW.kinetic_speed].iter().any(|k| (v.abs() - k).abs() < 1e-6);
        if !kink {
            let h = 1e-7;
            let slope = LAW.cubic(LAW.regime(v)).at(Dual::<1>::variable(v, 0)).slope[0];
            let difference = (mu(v + h) - mu(v - h)) / (2.0 * h);
            // Third derivative of the cubic step, and rounding of the quotient.
            let (low, high) = LAW.range(LAW.regime(v));
            prop_assert!(low <= v && v <= high);
            prop_assert!((slope - difference).abs() < 1e-8 * (1.0 + slope.abs()));
        }
    }
}

#[test]
fn regimes_follow_one_another() {
    for (v, beyond) in [(0.005, 0.02), (0.02, 0.005), (0.5, 1.5), (1.5, 0.5)] {
        for sign in [1.0, -1.0] {
            assert_eq!(LAW.next(LAW.regime(sign * v), sign * beyond), LAW.regime(sign * beyond), "{v} to {beyond}");
        }
    }
}

/// A law that sticks is the other one from V_S on, and mu_S with the sign of the slip below; its regimes follow one
/// another through 0, also where V_S or both speeds are 0.
#[test]
fn a_law_that_sticks_differs_below_static_speed_only() {
    let sticks = Law { sticks: true, ..LAW };
    let at = |v: f64| sticks.cubic(sticks.regime(v)).at(v);
    for v in [0.01001, 0.3, 1.0, 2.0] {
        assert_eq!((at(v), at(-v)), (mu(v), -mu(v)));
    }
    assert_eq!([1e-9, -1e-9].map(at), [0.19, -0.19]);
    assert_eq!([2.0, -0.1, 0.0].map(|towards| sticks.at_breakaway(towards).at(0.0)), [0.19, -0.19, 0.0]);
    let jump = Law { static_speed: 0.0, kinetic_speed: 0.0, ..sticks };
    let curve = Law { static_speed: 0.0, ..sticks };
    for (law, first) in [(sticks, Regime::Static(1.0)), (curve, Regime::Transition(1.0)), (jump, Regime::Kinetic(1.0))]
    {
        let opposite = law.regime_towards(0.0, -1.0);
        assert_eq!(law.regime_towards(0.0, 1.0), first);
        assert_eq!((law.next(first, -1e-6), law.next(opposite, 1e-6)), (opposite, first));
        for v in [-2.0, -0.5, -0.005, 0.005, 0.5, 2.0] {
            let (low, high) = law.range(law.regime(v));
            assert!(low <= v && v <= high, "{v}: {law:?}");
        }
        assert_eq!(law.regime(2.0), Regime::Kinetic(1.0));
    }
}
