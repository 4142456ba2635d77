//! Millions of random calls on one instance: every call is answered as in the standard, and the memory does not grow.
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

/// Instances of one definition share memory, also across tests. Therefore only one test at a time has instances.
static ALONE: Mutex<()> = Mutex::new(());

/// Number of calls by default.
const CALLS: u64 = 300_000;
/// Number of calls between two measurements of the memory.
const ROUND: u64 = 50_000;
/// Growth of the resident memory that the system's allocator may cause from the second round on [bytes].
const RESIDENT: usize = 2 << 20;

/// Scratch memory that an instance keeps over a reset once it has needed it, such as that of reactions without a table.
/// The live memory may differ by this amount between rounds, without growing further [bytes].
const SCRATCH: isize = 8 << 10;

/// Resident memory [bytes], if the system reports it.
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
        // After these calls the instance has every table that it can have, and no other memory.
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

/// A freed instance returns all its memory.
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
    // The host's description has the same definition, so it keeps the tables of the first instance.
    life();
    let before = live();
    (0..20).for_each(|_| life());
    assert_eq!(live(), before);
}
