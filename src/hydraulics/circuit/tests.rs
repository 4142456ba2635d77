//! Laws of a circuit against values of other implementations, differences, and the balance of powers.
#![allow(clippy::unwrap_used)]
use super::*;
use foundation::numerics::dual::{Dual, Number};

fn equations() -> Equations {
    Equations::new(&Circuit::default())
}

fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value / expected - 1.0).abs() <= tolerance, "{value} is not {expected}");
}

fn point(x: f64, pressures: [f64; 2], spool: f64) -> Point<f64> {
    let (length, speed, spool_speed) = (0.412 + x, 0.0, 0.0);
    Point { pressures, spool, spool_speed, length, speed, supply: 20.7e6, tank: 0.35e6, command: 0.0 }
}

/// Values of an implementation by other hands, to the digits that it states.
#[test]
fn laws_agree_with_the_reference() {
    let laws = equations();
    near(laws.areas[0], 0.001_590_431_280_879_832_6, 1e-15);
    near(laws.areas[1], 0.001_099_557_428_756_427_4, 1e-15);
    near(laws.edge, 5.345_224_838_248_488e-8, 1e-15);
    near(laws.bulk_modulus(5e6), 1_321_595_325.333_9, 1e-13);
    near(laws.bulk_modulus(0.35e6), 291_483_049.787_1, 1e-12);
    near(laws.friction(0.01), 358.624_710_158_78, 1e-13);
    for (x, pressures, spool, [q_a, q_b]) in [
        (0.1, [5e6, 8e6], 0.5, [1.065_393_971_030_2e-4, -7.489_738_586_845_6e-5]),
        (0.315, [12e6, 16e6], 0.65, [1.032_816_594_677_5e-4, -6.522_398_968_940_9e-5]),
        (0.01, [5e6, 8e6], -0.5, [-2.091_656_050_676_9e-5, 9.426_283_492_468_1e-5]),
    ] {
        let flows = laws.flows(&point(x, pressures, spool));
        near(flows.chambers[0], q_a, 1e-13);
        near(flows.chambers[1], q_b, 1e-13);
    }
}

#[test]
fn power_is_balanced_at_every_point() {
    let laws = equations();
    for (x, pressures, spool, speed) in
        [(0.1, [5e6, 8e6], 0.5, 0.1), (0.32, [30e6, -9e4], -0.3, -0.2), (0.01, [1e5, 25e6], 0.0, 0.003)]
    {
        let at = Point { speed, ..point(x, pressures, spool) };
        let p = laws.powers(&at, &laws.flows(&at));
        let out = p.returned + p.piston + p.seal_friction + p.compression + p.throttling;
        assert!((p.supply - out).abs() < 1e-13 * p.throttling.abs(), "{p:?}");
        assert!(p.throttling > 0.0 && p.seal_friction > 0.0);
    }
}

#[test]
fn derivatives_are_those_of_the_values() {
    let laws = equations();
    let size = [1e6, 1e6, 1e-2, 1.0, 1e-3, 1e-2, 1e6, 1e5, 1e-2];
    let set = |of: [f64; 9]| {
        let [p_a, p_b, spool, spool_speed, length, speed, supply, tank, command] = of;
        [p_a, p_b, spool, spool_speed, length, speed, supply, tank, command]
    };
    fn flows<T: Number>(laws: &Equations, z: [T; 9]) -> [T; 12] {
        let [p_a, p_b, spool, spool_speed, length, speed, supply, tank, command] = z;
        let at = Point { pressures: [p_a, p_b], spool, spool_speed, length, speed, supply, tank, command };
        let f = laws.flows(&at);
        let p = laws.powers(&at, &f);
        let [a, b] = f.pressure_rates;
        [
            a,
            b,
            f.spool_acceleration,
            f.chambers[0],
            f.chambers[1],
            f.supply,
            f.tank,
            p.throttling,
            p.piston,
            p.compression,
            laws.stiffness([p_a, p_b], length),
            p.seal_friction,
        ]
    }
    for z in [
        [5e6, 8e6, 0.4, 3.0, 0.43, 0.02, 20e6, 4e5, 0.5],
        [27.99e6, 0.3e6, -0.01, 3.0, 0.73, -0.004, 20e6, 4e5, 0.5],
        [-5e4, 20.01e6, 0.001, 0.0, 0.6, 0.0, 20e6, 4e5, 0.0],
    ] {
        for k in 0..9 {
            let mut dual = set(z).map(Dual::<1>::constant);
            dual[k].slope = [1.0];
            let exact = flows(&laws, dual);
            let step = 1e-6 * size[k];
            let at = |factor: f64| {
                let mut beside = z;
                beside[k] += factor * step;
                flows(&laws, beside)
            };
            let (one, two) = ([at(-1.0), at(1.0)], [at(-2.0), at(2.0)]);
            let plain = flows(&laws, z);
            for i in 0..12 {
                let difference = (8.0 * (one[1][i] - one[0][i]) - (two[1][i] - two[0][i])) / (12.0 * step);
                let rounding = 1e-8 * (plain[i].abs() / size[k]).max(difference.abs());
                assert_eq!(exact[i].value, plain[i]);
                assert!((exact[i].slope[0] - difference).abs() <= rounding, "{k} {i} {exact:?} {difference}");
            }
        }
    }
}

#[test]
fn a_cushion_joins_twice_differentiably_and_its_borders_are_told() {
    let laws = equations();
    let [a, b] = laws.borders().map(Option::unwrap);
    assert!((a - 0.442).abs() < 1e-15 && (b - 0.712).abs() < 1e-15);
    assert_eq!(laws.resistance(0, a + 1e-9), laws.restrictors[0]);
    assert!(laws.resistance(0, a - 1e-5) - laws.restrictors[0] <= 1.01e-9 / 27.0 * laws.cushions[0] * 1e3);
    let none = Circuit { cushion_a: Default::default(), ..Circuit::default() };
    let mut none = none;
    none.cushion_a.length = 0.0;
    none.cushion_b.rated_flow = 0.0;
    assert_eq!(Equations::new(&none).borders(), [None; 2]);
}

#[test]
fn curvature_of_the_friction_is_that_of_its_slope() {
    let laws = equations();
    for v in [-0.03, -0.004, 0.0, 1e-3, 0.02] {
        let h = 1e-7;
        let difference = (laws.friction_at(v + h).1 - laws.friction_at(v - h).1) / (2.0 * h);
        // Size of the curvature: static friction over the square of the transition speed.
        assert!((laws.friction_at(v).2 - difference).abs() < 1e-6 * 400.0 / 0.005_f64.powi(2), "{v}");
    }
}

/// Oil that is shut in: with a constant bulk modulus p changes by E ln(V_0/V), and all work is compression.
#[test]
fn oil_that_is_shut_in_is_compressed_by_the_piston() {
    let mut circuit = Circuit::default();
    circuit.fluid.air_fraction = 0.0;
    let (laws, mut state) = (Equations::new(&circuit), [0.0; CIRCUIT]);
    (state[0], state[1]) = (8e6, 10e6);
    let (length, way) = (0.58, -5e-4);
    let moved = laws.displaced(&state, length, way);
    let [before, after] = [laws.volumes(length - way), laws.volumes(length)];
    for side in [0, 1] {
        near(moved[side], state[side] + circuit.fluid.bulk_modulus * (before[side] / after[side]).ln(), 1e-11);
    }
    let back = laws.displaced(&moved, length - way, -way);
    assert!((0..CIRCUIT).all(|k| (back[k] - state[k]).abs() <= 1e-6 * (1.0 + state[k].abs())), "{back:?}");
    assert!(moved[ENERGY + 2] == -moved[ENERGY + 4] && moved[ENERGY + 2] != 0.0);
}
