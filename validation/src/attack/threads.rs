//! Instances of one mechanism that step in parallel threads while their shared tables are built give results
//! bit-identical to those of separate runs.
use super::histories::{length, outputs, set, written};
use super::mechanism::definition;
use super::prepared::Prepared;
use super::probe::Probe;
use super::random::Random;

/// Number of instances of a case.
const INSTANCES: u64 = 4;
/// Number of steps of each instance.
const STEPS: usize = 12;

/// The case of this part: one mechanism.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let (alone, _) = Prepared::random(&mut random, definition);
    probe.count("instances alone and in threads");
    // A separate model whose tables are not built yet.
    let shared = Prepared::new(alone.definition.clone())?;
    let seed = random.word();
    let runs: Vec<_> = (0..INSTANCES).map(|k| run(&alone, seed.wrapping_add(k))).collect();
    let together: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..INSTANCES)
            .map(|k| {
                let shared = &shared;
                scope.spawn(move || run(shared, seed.wrapping_add(k)))
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Err("a panic in a thread".into()))).collect()
    });
    for (k, (alone, together)) in runs.into_iter().zip(together).enumerate() {
        let (alone, together) = (alone?, together?);
        if let Some(n) = (0..alone.len()).find(|&n| alone[n] != together[n]) {
            return Err(format!("instance {k} differs after step {n} in a thread"));
        }
    }
    Ok(())
}

/// State and outputs after a step.
type After = (Vec<u8>, Vec<u64>);

/// State and outputs after each step.
fn run(prepared: &Prepared, seed: u64) -> Result<Vec<After>, String> {
    let (mut random, mut model) = (Random::new(seed), prepared.start.clone());
    let mut all = Vec::with_capacity(STEPS);
    for _ in 0..STEPS {
        let h = length(&mut random, prepared);
        set(&mut random, prepared, h, [&mut model], false);
        let _ = model.step(h);
        all.push((written(&model)?, outputs(&mut model, prepared)?));
    }
    Ok(all)
}
