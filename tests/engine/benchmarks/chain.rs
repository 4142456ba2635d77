//! Chains of N four-bars, IFToMM benchmark A02: every loop is singular twice per turn. The motion stays on its branch.
use super::{check, close};
use crate::support::{CHAIN, Run};
use std::f64::consts::{FRAC_PI_2, TAU};

const PERIOD: f64 = 1.942_514_922_607_084;

/// All links translate, so the chain is a pendulum. These are the coefficients of its kinetic energy, and of its
/// potential energy for 1 - sin(angle) = 1.
fn kinetic(count: u32, speed: f64) -> f64 {
    let n = f64::from(count);
    0.5 * ((n + 1.0) / 3.0 + n) * speed * speed
}

fn potential(count: u32, angle: f64) -> f64 {
    let n = f64::from(count);
    9.81 * ((n + 1.0) / 2.0 + n) * angle.sin()
}

fn energy_error(run: &mut Run, count: u32) -> f64 {
    let (angle, speed) = (run.get("bar0.angle"), run.get("bar0.speed"));
    kinetic(count, speed) + potential(count, angle) - kinetic(count, 1.0) - potential(count, FRAC_PI_2)
}

#[test]
fn two_four_bars_follow_the_reference() {
    for steps in [10_000, 1000, 1] {
        let mut run = super::run(CHAIN, 1e-13);
        for _ in 0..steps {
            run.step(10.0 / f64::from(steps));
            let error = energy_error(&mut run, 2);
            assert!(error.abs() < 1e-9, "{error:e}");
            assert!(run.get("energy.drift").abs() < 1e-9);
        }
        check(&mut run, "tip.x", 0.328_458_111_540_815, 1e-9);
        check(&mut run, "tip.y", 0.944_518_538_178_601, 1e-9);
        check(&mut run, "tip.velocity_x", 1.423_051_470_206_94, 1e-9);
        check(&mut run, "tip.velocity_y", -0.494_868_845_487_043, 1e-9);
    }
}

#[test]
fn two_four_bars_are_upright_again_after_each_period() {
    let mut run = super::run(CHAIN, 1e-13);
    for turn in 1..=5 {
        run.step(PERIOD);
        check(&mut run, "bar0.angle", FRAC_PI_2 - TAU * f64::from(turn), 1e-11);
        check(&mut run, "bar0.speed", -1.0, 1e-10);
    }
}

#[test]
fn forty_four_bars_go_straight_on_through_every_flat_position() {
    /// The definition file is the output of `cargo fmu chain 40`.
    const COUNT: u32 = 40;
    // Angle of bar 0 [rad] after 10 s and 20 s: 2 am(t / 2 | -4 k) from upright, k = greatest potential over inertia.
    const ANGLES: [(u32, f64); 2] = [(10_000, -30.026_637_417_190_84), (20_000, -61.684_499_041_396_03)];
    let mut run = super::run(include_str!("../../fixtures/four_bar_chain_40.json"), 1e-13);
    let bars = (0..=COUNT).map(|k| (true, format!("bar{k}.angle")));
    let all = bars.chain((1..=COUNT).map(|k| (false, format!("link{k}.angle"))));
    let angles: Vec<_> = all.map(|(upright, name)| (upright, run.0.reference(&name).unwrap())).collect();
    let mut next = 0;
    for millisecond in 1..=20_000 {
        run.step(1e-3);
        let bar = run.get("bar0.angle");
        for &(upright, reference) in &angles {
            let lean = run.real(reference).unwrap() - if upright { bar } else { 0.0 };
            assert!(lean.abs() < 1e-9, "{millisecond} ms: variable {reference} leans by {lean:e} rad");
        }
        let speed = run.get("bar0.speed");
        let error = energy_error(&mut run, COUNT) / kinetic(COUNT, speed);
        assert!(error.abs() < 1e-8, "{millisecond} ms: {error:e}");
        if millisecond == ANGLES[next].0 {
            close("bar0.angle", bar, ANGLES[next].1, 1e-9);
            next = (next + 1) % 2;
        }
    }
}
