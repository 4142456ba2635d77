//! Millions of random calls on one instance: every answer as the standard says, and memory that does not grow.
//!
//! LINKAGE_FMU_CALLS sets the number of calls: `LINKAGE_FMU_CALLS=10000000 cargo test --test endurance -- --nocapture`.
#![allow(unsafe_code, clippy::unwrap_used)]

#[path = "../support/counting.rs"]
mod counting;
#[path = "../fmi2/host.rs"]
mod host;
#[allow(dead_code)]
#[path = "../fmi2/hostile"]
mod hostile {
    pub mod calls;
    pub mod play;
    pub mod standard;
}

use counting::live;
use host::Gear;
use hostile::play::{LONGEST, Op, Player, op};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Instances of one definition share memory, also those of two tests. So one test at a time has instances.
static ALONE: Mutex<()> = Mutex::new(());

/// Calls if nothing else is asked for.
const CALLS: u64 = 300_000;
/// Calls between two looks at the memory.
const ROUND: u64 = 50_000;
/// Growth of the resident memory that the system's allocator may make from the second round on [bytes].
const RESIDENT: usize = 2 << 20;

/// Scratch that an instance keeps over a reset once it has needed it, such as that of reactions without a table: live
/// memory may differ by it from round to round, and grows no further [bytes].
const SCRATCH: isize = 8 << 10;

/// Resident memory [bytes], where the system reports it.
fn resident() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?.split(' ').nth(1)?.parse::<usize>().ok()?;
    Some(pages * 4096)
}

#[test]
fn memory_is_constant_over_random_calls() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let calls = std::env::var("LINKAGE_FMU_CALLS").map_or(CALLS, |text| text.parse().unwrap());
    let mut player = Player::new();
    let ops = op(player.others());
    let mut runner = TestRunner::new_with_rng(Config::default(), TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let start = Instant::now();
    let rounds = calls.div_ceil(ROUND);
    let (mut accepted, mut seen) = (0_u64, Vec::with_capacity(rounds as usize));
    for _ in 0..rounds {
        for call in 0..ROUND as usize {
            if call % LONGEST == 0 {
                player.renew();
            }
            accepted += u64::from(player.play(&ops.new_tree(&mut runner).unwrap().current()));
        }
        // Every table that an instance can have is there from here on, and nothing else.
        player.renew();
        player.play(&Op::Enter);
        player.gear.all_bits();
        player.renew();
        seen.push((live(), resident()));
    }
    let (first, last) = (seen[0], seen[seen.len() - 1]);
    println!(
        "{calls} calls, {accepted} accepted, in {:.1} s; live memory {} bytes after the first round, {} after the \
         last; \
         resident {:?} and {:?} bytes",
        start.elapsed().as_secs_f64(),
        first.0,
        last.0,
        first.1,
        last.1
    );
    assert!(seen.iter().all(|(live, _)| (*live - first.0).abs() <= SCRATCH), "{seen:?}");
    if let (Some(first), Some(last)) = (first.1, last.1) {
        assert!(last <= first + RESIDENT, "{seen:?}");
    }
}

/// What an instance takes is given back.
#[test]
fn instances_give_back_their_memory() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let life = || {
        let gear = Gear::stepping(0.0, None);
        for n in 0..10 {
            gear.step(f64::from(n) * 1e-3, 1e-3);
        }
        gear.get("joint2.force").unwrap();
    };
    // The host's description is of the same definition, so the tables that the first life reads stay.
    life();
    let before = live();
    (0..20).for_each(|_| life());
    assert_eq!(live(), before);
}
