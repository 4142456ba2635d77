//! Random sequences of calls. Each status is that of the model, and the instance ends like a twin that got only the
//! accepted calls.

use super::play::{Logging, Op, Player};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::cell::RefCell;
use std::ffi::c_int;

const SEQUENCES: u32 = 3000;
const LONGEST: usize = 80;

fn force() -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => -40_000.0..40_000.0,
        1 => Just(1e300),
        1 => prop::sample::select(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY][..]),
    ]
}

/// Order and value of a derivative of the force; order 3 is refused.
fn rate() -> impl Strategy<Value = (c_int, f64)> {
    let value = prop_oneof![8 => -1e7..1e7, 1 => Just(0.0), 1 => odd()];
    (prop_oneof![6 => Just(1), 4 => Just(2), 1 => Just(3), 1 => Just(0)], value)
}

fn odd() -> impl Strategy<Value = f64> {
    prop::sample::select(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, -1e-3, -f64::MIN_POSITIVE][..])
}

fn op(others: usize) -> impl Strategy<Value = Op> {
    let tolerance = prop_oneof![2 => Just(None), 2 => (1e-12..1e-6).prop_map(Some), 1 => odd().prop_map(Some)];
    let start = prop_oneof![2 => Just(0.0), 2 => -10.0..10.0, 1 => Just(f64::NAN)];
    let length = prop_oneof![2 => Just(None), 2 => (1e-3..0.2).prop_map(Some), 1 => odd().prop_map(Some)];
    prop_oneof![
        3 => (tolerance, start, length).prop_map(|(tolerance, start, length)| Op::Setup(tolerance, start, length)),
        4 => Just(Op::Enter),
        4 => Just(Op::Exit),
        1 => Just(Op::Terminate),
        1 => Just(Op::Reset),
        6 => force().prop_map(Op::SetForce),
        4 => rate().prop_map(|(order, value)| Op::SetForceRate(order, value)),
        3 => prop_oneof![4 => 0.3..0.8, 1 => Just(f64::NAN)].prop_map(Op::SetStartAngle),
        1 => odd().prop_map(Op::SetCrankLength),
        3 => Just(Op::ReadAngle),
        2 => Just(Op::ReadSome),
        12 => prop_oneof![6 => 1e-5..5e-3, 1 => odd()].prop_map(Op::Step),
        2 => (1e-5..1e-3, prop_oneof![0.01..3.0, -3.0..-0.01]).prop_map(|(h, off)| Op::StepFromElsewhere(h, off)),
        1 => prop::sample::select(&Logging::ALL[..]).prop_map(Op::Logging),
        3 => Just(Op::Save),
        4 => Just(Op::Restore),
        1 => Just(Op::Serialize),
        1 => Just(Op::Free),
        20 => (0..others).prop_map(Op::Other),
    ]
}

#[test]
fn random_sequences_are_answered_as_the_standard_says() {
    // Two instances for all sequences: after each, both are reset, which must leave no trace.
    let pair = RefCell::new((Player::new(), Player::new()));
    let others = pair.borrow().0.others();
    let config = Config { cases: SEQUENCES, failure_persistence: None, ..Config::default() };
    let result = TestRunner::new(config).run(&prop::collection::vec(op(others), 1..LONGEST), |ops| {
        let (player, twin) = &mut *pair.borrow_mut();
        player.renew();
        twin.renew();
        for op in &ops {
            // The twin gets the accepted calls, and a failed step, which changes the phase.
            if player.play(op) || player.has_failed() != twin.has_failed() {
                twin.play(op);
            }
        }
        prop_assert_eq!(player.gear.all_bits(), twin.gear.all_bits());
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
}

/// A step that cannot be computed leaves every output as it was under the same inputs.
#[test]
fn a_failed_step_leaves_the_energy_balance() {
    let mut player = Player::new();
    for op in [Op::Enter, Op::Exit, Op::Step(1e-3), Op::SetForce(1e300)] {
        assert!(player.play(&op));
    }
    let before = player.gear.all_bits();
    assert!(!player.play(&Op::Step(1e-3)));
    assert_eq!(player.gear.all_bits(), before);
}
