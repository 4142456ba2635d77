//! The loop against closed forms.
use super::*;
use crate::numerics::dual::Dual;
use crate::numerics::processor::Separate;
use proptest::prelude::*;

/// One joint whose friction acts on its own reaction without the motion.
fn joint<'a>(free: &'a [f64; 2], effect: &'a [f64; 2]) -> Balance<'a, f64> {
    let [x, y] = [0, 1].map(|axis| (&free[axis..=axis], &effect[axis..=axis]));
    Balance {
        free: [x.0, y.0],
        inertial: [&[0.0]; 2],
        influence: &[0.0],
        passed: [x.1, y.1],
        groups: &[0],
        seconds: &[[0.0, 1.0]],
    }
}

proptest! {
    /// One joint: |free - effect m N| = N is a quadratic equation.
    #[test]
    fn one_joint_solves_its_quadratic(fx in -1e4..1e4f64, fy in -1e4..1e4f64, ex in -8.0..8.0f64, ey in -8.0..8.0f64,
        m in -0.02..0.02f64) {
        prop_assume!(fx.hypot(fy) > 1.0);
        let mut one = FrictionLoop::new(1, 1);
        one.arm[0] = m;
        one.solve(&joint(&[fx, fy], &[ex, ey])).unwrap();
        // (1 - m2 e.e) N2 + 2 m f.e N - f.f = 0, the positive root.
        let (a, b, c) = (1.0 - m * m * (ex * ex + ey * ey), m * (fx * ex + fy * ey), -(fx * fx + fy * fy));
        let root = (-b + (b * b - a * c).sqrt()) / a;
        prop_assert!((one.size[0] - root).abs() <= 1e-13 * root, "{} {root}", one.size[0]);
        prop_assert!(one.iterations <= 8);
    }

    /// The same at any coefficient. With m from 0 on, N = f.f / (b + sqrt(b2 - a c)) as long as neither the root nor
    /// the sum vanishes: friction may take away nearly all of the reaction, but not add to it without bound.
    #[test]
    fn one_joint_locks_where_its_solution_ends(angle in 0.0..std::f64::consts::TAU, f in 1.0..1e4f64,
        k in -5.0..5.0f64) {
        let mut one = FrictionLoop::new(1, 1);
        one.arm[0] = k;
        let solved = one.solve(&joint(&[f, 0.0], &[angle.cos(), angle.sin()]));
        // Relative to f: a, b and the root.
        let (a, b, root) = (1.0 - k * k, k * angle.cos(), 1.0 - (k * angle.sin()).powi(2));
        let ends = root <= 0.0 || a <= 0.0 && b <= 0.0;
        prop_assume!(root.abs() > 1e-3 && a.abs() > 1e-3);
        prop_assert_eq!(solved.is_err(), ends);
        if !ends {
            let size = f / (b + root.sqrt());
            prop_assert!((one.size[0] - size).abs() <= 1e-11 * size, "{} {size}", one.size[0]);
        }
    }

    /// Derivatives through the loop by the implicit function theorem, against differences of the solution.
    #[test]
    fn derivatives_pass_through_the_loop(fx in 1.0..9.0f64, fy in -9.0..9.0f64, gx in -9.0..9.0f64, m in 0.0..0.03f64,
        groups in 1usize..3) {
        let build = |x: f64, d: bool| {
            let mut two = FrictionLoop::<Dual<1>>::new(2, groups);
            let v = Dual { value: x, slope: [f64::from(u8::from(d))] };
            let c = |value: f64| Dual::<1>::constant(value);
            two.arm = vec![c(m) * v, c(-m)];
            let balance = Balance {
                free: [&[v, c(gx) + v * v], &[c(fy), c(3.0)]],
                inertial: [&[c(0.3), v], &[c(-0.2), c(0.7)]],
                influence: &[v * c(0.1), c(0.2)],
                passed: [&[c(1.0), c(4.0), v, c(-1.0)][..2 * groups], &[c(-2.0), c(0.5), c(3.0), c(2.0)][..2 * groups]],
                groups: &[0, groups - 1],
                seconds: &[[0.0, 1.0]; 2],
            };
            two.solve(&balance).unwrap();
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

proptest! {
    /// One group of four joints: the reactions fit the friction that they cause, also as the general method finds it.
    #[test]
    fn both_methods_find_what_fits(numbers in proptest::collection::vec(-1.0..1.0f64, 32)) {
        let four = |k: usize| &numbers[4 * k..4 * k + 4];
        let arms: Vec<f64> = four(7).iter().map(|m| 0.02 * m).collect();
        let balance = Balance {
            free: [four(0), four(1)],
            inertial: [four(2), four(3)],
            influence: four(4),
            passed: [four(5), four(6)],
            groups: &[0; 4],
            seconds: &[[0.0, 1.0]; 4],
        };
        let (mut one, mut any) = (FrictionLoop::new(4, 1), FrictionLoop::new(4, 1));
        (one.arm, any.arm) = (arms.clone(), arms);
        prop_assert!(one.solve_one::<4>(0.0, &balance));
        any.solve_any(0.0, &balance).unwrap();
        prop_assert!(one.iterations <= 8 && any.iterations <= 8);
        let largest = one.size.iter().fold(0.0, |a: f64, s| a.max(*s));
        for i in 0..4 {
            let r = [0, 1].map(|axis| {
                (0..4).fold(balance.free[axis][i], |sum, j| {
                    let effect = balance.passed[axis][j] + balance.inertial[axis][i] * balance.influence[j];
                    sum + effect * one.friction(j)
                })
            });
            prop_assert!((r[0].hypot(r[1]) - one.size[i]).abs() <= 1e-14 * largest, "joint {i}");
            prop_assert!((any.size[i] - one.size[i]).abs() <= 1e-14 * largest, "joint {i}");
        }
    }
}

proptest! {
    /// Within a step the last solutions foresee the next one of many joints: it is found with fewer matrices, and
    /// differs by rounding from the one that is found without them.
    #[test]
    fn a_prediction_changes_many_joints_by_rounding(numbers in proptest::collection::vec(-1.0..1.0f64, 72)) {
        let six = |k: usize| &numbers[6 * k..6 * k + 6];
        let rates = [six(8), six(9)];
        let at = |t: f64| [0, 1].map(|axis| -> Vec<f64> {
            six(axis).iter().zip(rates[axis]).map(|(free, rate)| free + t * rate).collect()
        });
        let mut within = FrictionLoop::new(6, 1);
        within.arm = six(7).iter().map(|m| 0.02 * m).collect();
        let arm = within.arm.clone();
        within.begin_step();
        for t in [0.0, 1e-3, 2e-3] {
            let free = at(t);
            let balance = Balance {
                free: free.each_ref().map(|free| &free[..]),
                inertial: [six(2), six(3)],
                influence: six(4),
                passed: [six(5), six(6)],
                groups: &[0; 6],
                seconds: &[[0.0, 1.0]; 6],
            };
            let mut alone = FrictionLoop::new(6, 1);
            alone.arm.clone_from(&arm);
            alone.solve(&balance).unwrap();
            within.solve_at(t, &balance).unwrap();
            let largest = alone.size.iter().fold(0.0, |a: f64, s| a.max(*s));
            let alike = alone.size.iter().zip(&within.size).all(|(a, b)| (a - b).abs() <= 1e-13 * largest);
            prop_assert!(alike, "t = {t}: {:?} {:?}", alone.size, within.size);
            prop_assert!(within.iterations <= alone.iterations);
            // The arithmetic of other processors, from zero.
            let mut separate = alone.clone();
            separate.size.fill(0.0);
            prop_assert!(separate.correct_until_exact::<Separate>(&balance));
            let alike = alone.size.iter().zip(&separate.size).all(|(a, b)| (a - b).abs() <= 1e-13 * largest);
            prop_assert!(alike, "t = {t}: {:?} {:?}", alone.size, separate.size);
        }
    }
}

/// Reactions that are not finite have no solution, and leave no trace in the next one.
#[test]
fn what_is_not_finite_is_forgotten() {
    let at = |free: f64, loops: &mut FrictionLoop<f64>| {
        let balance = Balance {
            free: [&[free, 2.0, -3.0, 1.0, 4.0], &[1.0; 5]],
            inertial: [&[0.5; 5], &[-0.2; 5]],
            influence: &[1.0, -0.5, 2.0, 0.1, 0.3],
            passed: [&[1.0; 5], &[-2.0; 5]],
            groups: &[0; 5],
            seconds: &[[0.0, 1.0]; 5],
        };
        loops.arm.fill(0.02);
        loops.solve(&balance)
    };
    let (mut fresh, mut used) = (FrictionLoop::new(5, 1), FrictionLoop::new(5, 1));
    assert_eq!(at(f64::INFINITY, &mut used), Err(Locked));
    assert_eq!((at(1.0, &mut fresh), at(1.0, &mut used)), (Ok(()), Ok(())));
    assert_eq!((fresh.size, fresh.iterations), (used.size, used.iterations));
}

#[test]
fn friction_that_feeds_itself_is_an_error() {
    // |f - e m N| = N with e m = -1: N grows with itself, N = f + N.
    let mut one = FrictionLoop::new(1, 1);
    let balance = joint(&[1.0, 0.0], &[-50.0, 0.0]);
    one.arm[0] = 0.02;
    assert_eq!(one.solve(&balance), Err(Locked));
    // Beyond it there is a solution of the wrong sign only.
    one.arm[0] = 0.04;
    assert_eq!(one.solve(&balance), Err(Locked));
}
