//! Drag against closed forms and against sums over many small elements.
use super::*;
use crate::numerics::dual::Dual;
use proptest::prelude::*;

fn strip(length: f64, breadth: f64, directed: bool) -> Drag {
    Drag { directed, length, breadth, coefficient: 0.5 }
}

#[test]
fn a_leg_across_the_flow_has_the_drag_of_the_paper() {
    // [HF08] (1) for the leg: 1.225 / 2 * 70^2 * 0.759 * 0.10 * 0.5.
    let flow = RelativeFlow { wind: [70.0, 0.0], omega: 0.0, line: [0.0, -1.0] };
    let [fx, fy, moment] = strip(0.759, 0.10, true).force(1.225, &flow);
    let expected = 0.5 * 1.225 * 4900.0 * 0.0759 * 0.5;
    assert!((fx - expected).abs() < 1e-12 * expected && fy.abs() < 1e-12);
    // Acts at the middle; the arm points along -y.
    assert!((moment - 0.5 * 0.759 * expected).abs() < 1e-12 * expected);
    // Turned by 60 degrees out of the flow, the leg faces it with half its area.
    let turned = RelativeFlow { line: [0.75f64.sqrt(), -0.5], ..flow };
    let [fx, ..] = strip(0.759, 0.10, true).force(1.225, &turned);
    assert!((fx - 0.5 * expected).abs() < 1e-12 * expected);
}

#[test]
fn an_area_without_direction_has_the_same_drag_from_all_sides() {
    for angle in [0.0f64, 1.0, 2.0, 3.0] {
        let flow = RelativeFlow { wind: [70.0 * angle.cos(), 70.0 * angle.sin()], omega: 0.0, line: [1.0, 0.0] };
        let [fx, fy, moment] = strip(0.0, 0.09, false).force(1.225, &flow);
        assert!((fx.hypot(fy) - 0.5 * 1.225 * 4900.0 * 0.09 * 0.5).abs() < 1e-10);
        assert_eq!(moment, 0.0);
    }
}

proptest! {
    #[test]
    fn a_moving_strip_is_the_sum_of_its_elements(
        wx in -80.0..80.0f64, wy in -80.0..80.0f64, omega in -90.0..90.0f64, angle in -4.0..4.0f64,
    ) {
        let (sin, cos) = angle.sin_cos();
        let surface = strip(0.8, 0.1, true);
        let total = surface.force(1.2, &RelativeFlow { wind: [wx, wy], omega, line: [cos, sin] });
        let mut sum = [0.0; 3];
        const PARTS: usize = 4000;
        for k in 0..PARTS {
            let s = 0.8 * (k as f64 + 0.5) / PARTS as f64;
            let u = [wx + omega * s * sin, wy - omega * s * cos];
            let facing = (u[1] * cos - u[0] * sin).abs();
            let size = 0.5 * 1.2 * 0.5 * 0.1 * facing * 0.8 / PARTS as f64;
            sum[0] += size * u[0];
            sum[1] += size * u[1];
            sum[2] += size * s * (cos * u[1] - sin * u[0]);
        }
        // The middle rule's error over elements of 0.2 mm, and one element at the change of sign.
        for (a, b) in total.iter().zip(&sum) {
            prop_assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
    }

    #[test]
    fn derivatives_are_those_of_differences(wx in 1.0..80.0f64, wy in -80.0..80.0f64, omega in -90.0..90.0f64) {
        let surface = strip(0.8, 0.1, true);
        let at = |wx: Dual<1>| surface.force(1.2, &RelativeFlow {
            wind: [wx, Dual::constant(wy)], omega: Dual::constant(omega), line: [Dual::constant(0.6),
                Dual::constant(0.8)],
        });
        let h = 1e-5;
        let (here, up, down) = (at(Dual::variable(wx, 0)), at(Dual::constant(wx + h)), at(Dual::constant(wx - h)));
        for k in 0..3 {
            let difference = (up[k].value - down[k].value) / (2.0 * h);
            prop_assert!((here[k].slope[0] - difference).abs() < 1e-5, "{} {difference}", here[k].slope[0]);
        }
    }
}
