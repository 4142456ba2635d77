//! Orders: conditions for the coefficients of RK4 and DOPRI5, observed orders of all methods and their interpolants.
use super::{SecondOrder, explicitly, implicitly, miss, oscillator};
use crate::integrator::Step;
use crate::integrator::methods::{dop853::Dop853, dopri5, dopri5::Dopri5, rk4, rk4::Rk4, rkn86::Rkn86};
use std::array::from_fn;
use std::ops::Range;

/// The vector v and gamma of the condition sum b_i v_i = 1 / gamma for each rooted tree, order by order: Solving ODEs I
/// (1993), II.2, table 2.2.
fn trees<const N: usize>(a: &[[f64; N]; N], c: [f64; N]) -> [Vec<([f64; N], f64)>; 5] {
    let inner = |v: &[f64; N]| -> [f64; N] { from_fn(|i| a[i].iter().zip(v).map(|(a, v)| a * v).sum()) };
    let product = |a: &[f64; N], b: &[f64; N]| -> [f64; N] { from_fn(|i| a[i] * b[i]) };
    let c2 = product(&c, &c);
    let (c3, c4) = (product(&c2, &c), product(&c2, &c2));
    let (ac, ac2, ac3) = (inner(&c), inner(&c2), inner(&c3));
    let aac = inner(&ac);
    [
        vec![([1.0; N], 1.0)],
        vec![(c, 2.0)],
        vec![(c2, 3.0), (ac, 6.0)],
        vec![(c3, 4.0), (product(&c, &ac), 8.0), (ac2, 12.0), (aac, 24.0)],
        vec![
            (c4, 5.0),
            (product(&c2, &ac), 10.0),
            (product(&ac, &ac), 20.0),
            (product(&c, &ac2), 15.0),
            (ac3, 20.0),
            (product(&c, &aac), 30.0),
            (inner(&product(&c, &ac)), 40.0),
            (inner(&ac2), 60.0),
            (inner(&aac), 120.0),
        ],
    ]
}

/// Checks that the last stage is a step of this order, and that the embedded method (step minus `e`) has one order
/// less.
fn conditions<const N: usize>(a: [[f64; N]; N], c: [f64; N], e: [f64; N], order: usize, rounding: f64, shown: f64) {
    for (row, c) in a.iter().zip(c) {
        assert!((row.iter().sum::<f64>() - c).abs() < rounding);
    }
    let (step, embedded) = (a[N - 1], from_fn(|i| a[N - 1][i] - e[i]));
    let off = |b: &[f64; N], (v, gamma): &([f64; N], f64)| {
        (b.iter().zip(v).map(|(b, v)| b * v).sum::<f64>() - 1.0 / gamma).abs()
    };
    let trees = trees(&a, c);
    for (k, trees) in (1..=order).zip(&trees) {
        for tree in trees {
            assert!(off(&step, tree) < rounding, "order {k}: {}", off(&step, tree));
            assert!(k == order || off(&embedded, tree) < rounding, "embedded, {k}: {}", off(&embedded, tree));
        }
    }
    assert!(trees[order - 1].iter().any(|tree| off(&embedded, tree) > shown), "the embedded method has less order");
}

#[test]
fn order_conditions_hold() {
    let (c, b) = (rk4::C, rk4::B);
    let row = |i: usize| {
        from_fn(|j| {
            if i == 4 {
                [b[0], b[1], b[2], b[3], 0.0][j]
            } else if j + 1 == i {
                c[i]
            } else {
                0.0
            }
        })
    };
    conditions(from_fn(row), c, [0.0, 0.0, 0.0, rk4::E, -rk4::E], 4, 1e-15, 1e-3);
    let a = dopri5::A.map(|row| from_fn(|j| row.get(j).copied().unwrap_or(0.0)));
    conditions(a, dopri5::C, dopri5::E, 5, 1e-14, 1e-4);
}

/// Checks the observed order over 6 s, from `steps` steps and twice as many. Checks the local order of components of
/// the interpolant, from steps of size h and h / 2 from `start`.
fn observed(
    attempt: impl Fn(&[f64; 2], f64) -> Step<2>,
    (steps, order): (u32, Range<f64>),
    (start, h): ([f64; 2], f64),
    local: &[Range<f64>],
) {
    let error = |steps: u32| miss(&(0..steps).fold([1.0, 0.0], |y, _| attempt(&y, 6.0 / f64::from(steps)).end), 6.0);
    let slope = (error(steps) / error(2 * steps)).log2();
    assert!(order.contains(&slope), "slope {slope}");
    let worst = |h: f64, n: usize| {
        let step = attempt(&start, h);
        let dense = step.dense(&mut oscillator);
        assert_eq!(dense.at(0.0), start);
        assert!((dense.at(1.0)[n] - step.end[n]).abs() < 1e-15);
        let exact = |s: f64| [(h * s - start[0].acos()).cos(), -(h * s - start[0].acos()).sin()];
        (1..20).map(|i| f64::from(i) / 20.0).map(|s| (dense.at(s)[n] - exact(s)[n]).abs()).fold(0.0, f64::max)
    };
    for (n, order) in local.iter().enumerate() {
        let slope = (worst(h, n) / worst(0.5 * h, n)).log2();
        assert!(order.contains(&slope), "local order of component {n} of the interpolant: {slope}");
    }
}

#[test]
fn observed_orders_are_those_of_the_methods() {
    let rk4 = |y: &[f64; 2], h: f64| explicitly::<Rk4<2>, _, 2>(&mut oscillator, 0.0, y, h);
    observed(rk4, (100, 3.9..4.1), ([1.0, 0.0], 0.1), &[3.8..4.6]);
    let dopri5 = |y: &[f64; 2], h: f64| explicitly::<Dopri5<2>, _, 2>(&mut oscillator, 0.0, y, h);
    observed(dopri5, (100, 4.9..5.1), ([1.0, 0.0], 0.2), &[4.7..6.3]);
    let dop853 = |y: &[f64; 2], h: f64| explicitly::<Dop853<2>, _, 2>(&mut oscillator, 0.0, y, h);
    observed(dop853, (10, 7.7..8.8), ([1.0, 0.0], 0.8), &[7.5..9.5]);
    let rkn86 = |y: &[f64; 2], h: f64| explicitly::<Rkn86, _, 2>(&mut SecondOrder(oscillator), 0.0, y, h);
    observed(rkn86, (10, 7.7..8.8), ([0.8, 0.6], 0.4), &[7.5..9.5, 7.5..9.5]);
    let radau = |y: &[f64; 2], h: f64| implicitly(&mut oscillator, 0.0, y, h);
    observed(radau, (40, 4.9..5.2), ([1.0, 0.0], 0.1), &[3.8..4.6]);
}
