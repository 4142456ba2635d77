//! Random sequences of calls. Each status agrees with the model, and the final instance equals a twin that received
//! only the accepted calls.

use super::play::{LONGEST, Op, Player, op};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::cell::RefCell;

const SEQUENCES: u32 = 3000;

#[test]
fn random_sequences_have_the_statuses_of_the_standard() {
    // Two instances for all sequences. Both are reset after each sequence, which must leave no trace.
    let pair = RefCell::new((Player::new(), Player::new()));
    let others = pair.borrow().0.others();
    let config = Config { cases: SEQUENCES, failure_persistence: None, ..Config::default() };
    let result = TestRunner::new(config).run(&prop::collection::vec(op(others), 1..LONGEST), |ops| {
        let (player, twin) = &mut *pair.borrow_mut();
        player.renew();
        twin.renew();
        for op in &ops {
            // The twin receives the accepted calls, and a failed step, because it changes the phase.
            if player.play(op) || player.has_failed() != twin.has_failed() {
                twin.play(op);
            }
        }
        prop_assert_eq!(player.gear.all_bits(), twin.gear.all_bits());
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
}

/// A step that cannot be computed leaves every output unchanged.
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
