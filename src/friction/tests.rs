//! The law against its definition, the loop against closed forms.
use super::*;
use crate::number::Dual;
use proptest::prelude::*;

const LAW: Law = Law { static_coefficient: 0.19, kinetic_coefficient: 0.026, static_speed: 0.01, kinetic_speed: 1.0 };

#[test]
fn law_passes_through_its_points() {
    assert_eq!(LAW.signed(0.0), 0.0);
    assert!((LAW.signed(0.005) - 0.095).abs() < 1e-16);
    assert!((LAW.signed(0.01) - 0.19).abs() < 1e-16);
    // Half way, the cubic step is half way.
    assert!((LAW.signed(0.505) - 0.5 * (0.19 + 0.026)).abs() < 1e-15);
    assert!((LAW.signed(1.0) - 0.026).abs() < 1e-16);
    assert_eq!(LAW.signed(7.0), 0.026);
}

proptest! {
    #[test]
    fn law_is_odd_and_its_derivative_is_that_of_differences(v in -2.0..2.0f64) {
        prop_assert_eq!(LAW.signed(-v), -LAW.signed(v));
        let kink = [0.0, LAW.static_speed, LAW.kinetic_speed].iter().any(|k| (v.abs() - k).abs() < 1e-6);
        if !kink {
            let h = 1e-7;
            let slope = LAW.signed(Dual::<1>::variable(v, 0)).slope[0];
            let difference = (LAW.signed(v + h) - LAW.signed(v - h)) / (2.0 * h);
            // Third derivative of the cubic step, and rounding of the quotient.
            prop_assert!((slope - difference).abs() < 1e-8 * (1.0 + slope.abs()));
        }
    }

    /// One joint: |free - effect m N| = N is a quadratic equation.
    #[test]
    fn one_joint_solves_its_quadratic(fx in -1e4..1e4f64, fy in -1e4..1e4f64, ex in -8.0..8.0f64, ey in -8.0..8.0f64, m in -0.02..0.02f64) {
        prop_assume!(fx.hypot(fy) > 1.0);
        let mut one = Loop::new(1);
        (one.free[0], one.effect[0], one.arm[0]) = ([fx, fy], [ex, ey], m);
        one.solve().unwrap();
        // (1 - m2 e.e) N2 + 2 m f.e N - f.f = 0, the positive root.
        let (a, b, c) = (1.0 - m * m * (ex * ex + ey * ey), m * (fx * ex + fy * ey), -(fx * fx + fy * fy));
        let root = (-b + (b * b - a * c).sqrt()) / a;
        prop_assert!((one.size[0] - root).abs() <= 1e-13 * root, "{} {root}", one.size[0]);
        prop_assert!(one.iterations <= 8);
    }

    /// Derivatives through the loop by the implicit function theorem, against differences of the solution.
    #[test]
    fn derivatives_pass_through_the_loop(fx in 1.0..9.0f64, fy in -9.0..9.0f64, gx in -9.0..9.0f64, m in 0.0..0.03f64) {
        let build = |x: f64, d: bool| {
            let mut two = Loop::<Dual<1>>::new(2);
            let v = Dual { value: x, slope: [f64::from(u8::from(d))] };
            let c = |value: f64| Dual::<1>::constant(value);
            two.free = vec![[v, c(fy)], [c(gx) + v * v, c(3.0)]];
            two.effect = vec![[c(1.0), c(-2.0)], [c(4.0), c(0.5)], [v, c(3.0)], [c(-1.0), c(2.0)]];
            two.arm = vec![c(m) * v, c(-m)];
            two.solve().unwrap();
            two
        };
        let h = 1e-6;
        let (at, up, down) = (build(fx, true), build(fx + h, false), build(fx - h, false));
        for i in 0..2 {
            let difference = (up.size[i].value - down.size[i].value) / (2.0 * h);
            prop_assert!((at.size[i].slope[0] - difference).abs() < 1e-7 * (1.0 + difference.abs()));
        }
    }
}

#[test]
fn friction_that_feeds_itself_is_an_error() {
    // |f - e m N| = N with e m = -1: N grows with itself, N = f + N.
    let mut one = Loop::new(1);
    (one.free[0], one.effect[0], one.arm[0]) = ([1.0, 0.0], [-50.0, 0.0], 0.02);
    assert_eq!(one.solve(), Err(Locked));
    // Beyond it there is a solution of the wrong sign only.
    one.arm[0] = 0.04;
    assert_eq!(one.solve(), Err(Locked));
}
