//! Many instances in many threads: each instance gives the same bits as a single instance.

use crate::host::Gear;
use linkage_fmu::fmi2::types::Status;

/// Number of kinds of runs, which differ in their inputs.
const KINDS: usize = 8;
/// Number of threads, each with one instance of every kind.
const THREADS: usize = 8;
const STEPS: i32 = 130;
const H: f64 = 1e-3;
/// Compared outputs: motion and energy of every kind. The first kind also has reactions, which need separate tables.
const COMPARED: [&str; 7] =
    ["crank.angle", "crank.speed", "actuator.length", "energy.drift", "joint2.force", "joint3.force_x", "wheel.y"];

/// Bits of the compared variables after a run with one instance of each kind, whose steps alternate.
fn run(kinds: &[usize]) -> Vec<Vec<u64>> {
    let gears: Vec<_> = kinds.iter().map(|kind| (*kind, Gear::stepping(0.0, None))).collect();
    for n in 0..STEPS {
        for (kind, gear) in &gears {
            let force = 30_000.0 + 10.0 * *kind as f64 + f64::from(n);
            assert_eq!(gear.set("actuator.force", force), Status::Ok);
            assert_eq!(gear.step(f64::from(n) * H, H), Status::Ok);
        }
    }
    let count = |kind: usize| if kind == 0 { COMPARED.len() } else { 4 };
    let read = |(kind, gear): &(usize, Gear)| {
        COMPARED[..count(*kind)].iter().map(|name| gear.get(name).unwrap().to_bits()).collect()
    };
    gears.iter().map(read).collect()
}

#[test]
fn sixty_four_instances_in_eight_threads_are_as_one_alone() {
    let kinds: Vec<_> = (0..KINDS).collect();
    let alone: Vec<_> = kinds.iter().map(|kind| run(&[*kind]).remove(0)).collect();
    assert_ne!(alone[1], alone[2]);
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|_| scope.spawn(|| run(&kinds))).collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), alone);
        }
    });
}
