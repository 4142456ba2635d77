//! Shorter steps from the same start, and the integration from their ends.
use super::radau_iia::VanDerPol;
use super::{damped, miss, oscillator, pendulum};
use crate::integrator::{Integrator, Method};

#[test]
fn an_explicit_step_cut_short_is_the_step_of_that_size() {
    let (mut integrator, mut y, mut t) = (Integrator::default(), [1.0, 0.0], 0.0);
    for _ in 0..5 {
        let step = integrator.step(&mut oscillator, t, &y, 100.0, 1e-12).unwrap();
        let short = integrator.retake(&mut oscillator, &step, 0.37 * step.h);
        assert_eq!((short.t, short.start, short.h, short.reached), (step.t, step.start, 0.37 * step.h, false));
        (t, y) = (t + short.h, short.end);
        assert!(miss(&y, t) < 1e-11);
        integrator.refresh();
    }
    // Repeating the whole step gives identical results, including the compensation.
    let step = integrator.step(&mut oscillator, t, &y, 100.0, 1e-12).unwrap();
    let mut memory = integrator.clone();
    assert_eq!(integrator.retake(&mut oscillator, &step, step.h).end, step.end);
    let next = integrator.step(&mut oscillator, t + step.h, &step.end, 100.0, 1e-12).unwrap();
    assert_eq!(next, memory.step(&mut oscillator, t + step.h, &step.end, 100.0, 1e-12).unwrap());
}

#[test]
fn an_implicit_step_cut_short_stays_on_the_solution() {
    let tolerance = 1e-10;
    let mut reference = Integrator::default();
    let mut stiff = VanDerPol(1e-5);
    let (mut integrator, mut y, mut t) = (Integrator::default(), [2.0, -0.66], 0.0);
    let mut cut = 0;
    while t < 0.5 {
        let step = integrator.step(&mut stiff, t, &y, 0.5, tolerance).unwrap();
        if step.method() != Method::Radau {
            (t, y) = (t + step.h, step.end);
            continue;
        }
        let part = 0.2 + 0.7 * f64::from(cut % 10) / 10.0;
        let short = integrator.retake(&mut stiff, &step, part * step.h);
        let dense = step.dense(&mut stiff).at(part);
        assert!((short.end[0] - dense[0]).abs() < 10.0 * tolerance);
        assert!((short.end[1] - dense[1]).abs() < 100.0 * tolerance * step.end[1].abs().max(1.0));
        (t, y) = (t + short.h, short.end);
        cut += 1;
        if cut % 3 == 0 {
            integrator.refresh();
        }
        if cut % 50 == 0 {
            integrator.restart();
        }
    }
    assert!(cut > 100, "{cut}");
    let mut z = [2.0, -0.66];
    reference.advance(&mut stiff, &mut z, t, 1e-11).unwrap();
    assert!((y[0] - z[0]).abs() < 100.0 * tolerance && (y[1] - z[1]).abs() < 100.0 * tolerance, "{y:?} {z:?}");
}

#[test]
fn a_short_step_retaken_whole_gives_the_same_bits() {
    type System = fn(f64, &[f64; 2]) -> [f64; 2];
    let cases: [(System, _, _, _); 2] = [(pendulum, 1e-4, Method::Rk4, 1e-15), (damped, 1e-2, Method::Dopri5, 1e-11)];
    for (mut system, h, method, close) in cases {
        let (mut y, mut integrator) = ([1.0, 0.0], Integrator::default());
        integrator.advance(&mut system, &mut y, h, 1e-10).unwrap();
        let step = integrator.step(&mut system, 0.0, &y, h, 1e-10).unwrap();
        assert_eq!(step.method(), method);
        assert_eq!(integrator.retake(&mut system, &step, step.h).end, step.end);
        let half = integrator.retake(&mut system, &step, 0.5 * step.h);
        let dense = step.dense(&mut system).at(0.5);
        assert!((half.end[0] - dense[0]).abs() < close && (half.end[1] - dense[1]).abs() < close);
    }
}
