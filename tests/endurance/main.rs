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
use hostile::play::{Logging, Op, Player};
use std::time::Instant;

/// Calls if nothing else is asked for.
const CALLS: u64 = 300_000;
/// Calls between two looks at the memory.
const ROUND: u64 = 50_000;
/// Growth of the resident memory that the system's allocator may make from the second round on [bytes].
const RESIDENT: usize = 2 << 20;

/// Resident memory [bytes], where the system reports it.
fn resident() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?.split(' ').nth(1)?.parse::<usize>().ok()?;
    Some(pages * 4096)
}

/// Numbers that look random (splitmix64).
struct Dice(u64);

impl Dice {
    fn number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.number() % limit as u64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.number() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn odd(&mut self) -> f64 {
        [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1e-3][self.below(5)]
    }

    fn op(&mut self, others: usize) -> Op {
        match self.below(1000) {
            0..20 => Op::Setup(
                [None, Some(1e-9), Some(1e-7), Some(f64::NAN)][self.below(4)],
                self.between(-1.0, 1.0),
                [None, Some(0.2), Some(-1.0), Some(f64::INFINITY)][self.below(4)],
            ),
            20..50 => Op::Enter,
            50..80 => Op::Exit,
            80..84 => Op::Terminate,
            84..90 => Op::Reset,
            90..200 => Op::SetForce(self.between(-40_000.0, 40_000.0)),
            200..201 => Op::SetForce(1e300),
            201..220 => Op::SetForce([f64::NAN, f64::INFINITY, f64::NEG_INFINITY][self.below(3)]),
            220..240 => Op::SetStartAngle(self.between(0.3, 0.8)),
            240..260 => Op::SetCrankLength(self.odd()),
            260..320 => Op::ReadAngle,
            320..360 => Op::ReadSome,
            360..600 => Op::Step(self.between(1e-5, 5e-3)),
            600..640 => Op::Step(self.odd()),
            640..680 => Op::StepFromElsewhere(self.between(1e-5, 1e-3), self.between(0.01, 3.0)),
            680..685 => {
                Op::Logging([Logging::AllOn, Logging::AllOff, Logging::ErrorsOnly, Logging::DiscardsOff][self.below(4)])
            }
            _ => Op::Other(self.below(others)),
        }
    }
}

#[test]
fn memory_is_constant_over_random_calls() {
    let calls = std::env::var("LINKAGE_FMU_CALLS").map_or(CALLS, |text| text.parse().unwrap());
    let mut player = Player::new();
    let others = player.others();
    let mut dice = Dice(1);
    let start = Instant::now();
    let rounds = calls.div_ceil(ROUND);
    let (mut accepted, mut seen) = (0_u64, Vec::with_capacity(rounds as usize));
    for _ in 0..rounds {
        for _ in 0..ROUND {
            accepted += u64::from(player.play(&dice.op(others)));
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
    assert!(seen.iter().all(|(live, _)| *live == first.0), "{seen:?}");
    if let (Some(first), Some(last)) = (first.1, last.1) {
        assert!(last <= first + RESIDENT, "{seen:?}");
    }
}

/// What an instance takes is given back.
#[test]
fn instances_give_back_their_memory() {
    drop(Gear::stepping(0.0, None));
    let before = live();
    for _ in 0..20 {
        let gear = Gear::stepping(0.0, None);
        for n in 0..10 {
            gear.step(f64::from(n) * 1e-3, 1e-3);
        }
        gear.get("joint2.force").unwrap();
    }
    assert_eq!(live(), before);
}
