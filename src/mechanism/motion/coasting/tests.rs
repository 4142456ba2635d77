//! Long motions against closed forms: a pendulum swings and turns with periods that elliptic integrals give.
#![allow(clippy::unwrap_used)]
use super::*;
use crate::integrator::System;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::motion::contact::{EngagedLocks, RigidEnd, Travel};
use std::f64::consts::{PI, TAU};

/// theta'' = -sin theta: a pendulum of unit length in unit gravity.
struct Pendulum;

impl System<2> for Pendulum {
    const SECOND_ORDER: bool = true;

    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], -y[0].sin()]
    }

    fn scale(&mut self, y: &[f64; 2], _f: &[f64; 2]) -> [f64; 2] {
        [1.0, y[1].abs().max(1.0)]
    }
}

impl Dynamics<2> for Pendulum {
    fn set_time(&mut self, _t: f64) {}

    fn free_acceleration(&mut self, theta: f64, _theta_dot: f64) -> Result<f64, Locked> {
        Ok(-theta.sin())
    }

    fn length(&self) -> f64 {
        1.0
    }
}

/// Complete elliptic integral of the first kind K(k), by the arithmetic-geometric mean.
fn complete_elliptic(k: f64) -> f64 {
    let (mut a, mut g) = (1.0_f64, (1.0 - k * k).sqrt());
    for _ in 0..20 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    0.5 * PI / a
}

/// Period of the swing or of the turn through the lowest point at this speed.
fn period(speed: f64) -> f64 {
    let k = 0.5 * speed;
    if k < 1.0 { 4.0 * complete_elliptic(k) } else { 2.0 / k * complete_elliptic(1.0 / k) }
}

/// State after `span` from `start` at this tolerance, revolutions passed over, steps tried, whether the span's end was
/// reached. The pendulum moves between ends of its travel, or on a closed curve.
fn coast(
    start: [f64; 2],
    span: f64,
    tolerance: f64,
    travel: [Option<f64>; 2],
    most: u64,
) -> ([f64; 2], f64, u64, bool) {
    let (mut y, mut passed, mut integrator) = (start, 0.0, Integrator::default());
    let length = travel.iter().all(Option::is_none).then_some(TAU);
    let rigid = travel.map(|position| {
        position.map(|position| RigidEnd { position, restitution: 1.0, slope: 1.0, ..RigidEnd::default() })
    });
    let travel = Travel { rigid, ..Travel::default() };
    let mut coasting = Coasting {
        dynamics: &mut Pendulum,
        integrator: &mut integrator,
        lookahead: &mut Lookahead::default(),
        ends: &Ends::new(&travel, 0.0, EngagedLocks::default()),
        contact: &mut Contact::default(),
        witness: &mut Witness::default(),
        tolerance,
        passes: |_| false,
        path: || Path { length, does_work: false },
    };
    let whole = coasting.run(&mut y, span, most, &mut passed).is_ok();
    (y, passed, integrator.attempts(), whole)
}

#[test]
fn a_swing_and_a_turn_end_where_elliptic_integrals_say() {
    for speed in [0.1, 1.0, 1.9, 1.999, 2.001, 2.1, 3.0, 30.0] {
        let turns = speed > 2.0;
        // Relative change of the period for one of the speed.
        let sensitivity = (period(speed * (1.0 + 1e-6)) / period(speed) - 1.0).abs() * 1e6;
        for tolerance in [1e-9, 1e-13] {
            for count in [1e4, 1e6] {
                // From the lowest point to the lowest point.
                let span = count * period(speed);
                let (y, passed, steps, _) = coast([0.0, speed], span, tolerance, [None; 2], u64::MAX);
                let angle = y[0] + TAU * (passed - if turns { count } else { 0.0 });
                let phase = (angle / speed / period(speed)).abs();
                println!("{speed}, {tolerance:e}: {count:e} periods of {:.3} s: {phase:.1e}, {steps}", period(speed));
                // The steps before err by the tolerance, which changes the period; the period by a part in 1e12.
                let bound = count * (100.0 * tolerance * sensitivity + 1e-12) + 1e4 * tolerance;
                assert!(phase < bound, "{speed}, {tolerance:e}: {phase:e} of a period, above {bound:e}");
                assert!(steps < 4000, "{steps}");
                assert_eq!(passed != 0.0, turns);
            }
        }
    }
}

#[test]
fn ten_thousand_turns_end_where_the_period_says() {
    // From 0.3 rad at 2.5 rad/s over whole periods and 0.3 s: the same as 0.3 s alone, 1e4 revolutions on.
    let speed = (2.5_f64.powi(2) + 2.0 * (1.0 - 0.3_f64.cos())).sqrt();
    let (end, passed, ..) = coast([0.3, 2.5], 1e4 * period(speed) + 0.3, 1e-13, [None; 2], u64::MAX);
    let ([angle, rate], ..) = coast([0.3, 2.5], 0.3, 1e-13, [None; 2], u64::MAX);
    let error = [end[0] + TAU * (passed - 1e4) - angle, end[1] - rate];
    println!("{error:?}, {passed} revolutions passed over");
    assert!(error.iter().all(|e| e.abs() < 1e-8) && passed > 9_000.0, "{error:?} {passed}");
}

#[test]
fn what_may_touch_a_stop_is_integrated_step_by_step() {
    let span = 1000.0 * period(1.0);
    // An amplitude of 60 degrees between stops that it does not reach, and one that it does.
    let (free, _, steps, _) = coast([0.0, 1.0], span, 1e-9, [Some(-1.1), Some(1.1)], u64::MAX);
    assert!(steps < 3000 && (free[1] - 1.0).abs() < 1e-6, "{steps} {free:?}");
    let (.., steps, _) = coast([0.0, 1.0], span, 1e-9, [Some(-1.1), Some(1.0)], u64::MAX);
    assert!(steps > 10_000, "{steps}");
}

#[test]
fn the_bound_ends_a_motion_that_has_no_period() {
    let (y, _, steps, whole) = coast([0.0, 1.0], 1e6, 1e-9, [None, Some(0.5)], 5000);
    assert!(!whole && steps <= 5001, "{steps} {y:?}");
    // Work without a period: sigma grows without bound.
    let (mut y, mut passed, mut integrator) = ([0.0, 3.0], 0.0, Integrator::default());
    let travel = Travel::default();
    let mut coasting = Coasting {
        dynamics: &mut Pendulum,
        integrator: &mut integrator,
        lookahead: &mut Lookahead::default(),
        ends: &Ends::new(&travel, 0.0, EngagedLocks::default()),
        contact: &mut Contact::default(),
        witness: &mut Witness::default(),
        tolerance: 1e-9,
        passes: |_| false,
        path: || Path { length: Some(TAU), does_work: true },
    };
    let ended = coasting.run(&mut y, 1e6, 2000, &mut passed);
    assert!(matches!(ended, Err(Stopped::Budget(progress)) if progress.t < 1e3 && progress.t > 0.0));
    assert!(passed == 0.0 && integrator.attempts() <= 2000, "{passed} {}", integrator.attempts());
}
