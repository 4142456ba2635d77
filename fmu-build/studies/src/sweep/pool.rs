//! The threads that make the chunks of a study on this machine.
//!
//! In: the chunks to make. Out: their bytes, in the order in which they are completed. Each thread has a separate
//! model, so that threads share no mutable data.

use super::by_energy::ByEnergy;
use super::chunk::{self, Cut};
use super::design::Design;
use super::run::{Runner, Task};
use anyhow::{Context, Result};
use linkage_fmu::component::Component;
use rayon::ThreadPoolBuilder;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;

/// Number of chunks per thread that may wait to be stored.
const WAITING: usize = 4;

/// Make these chunks on this number of threads. `keep` is called on this thread with each completed chunk. With
/// `stop_wish`, active chunks are abandoned.
///
/// # Errors
/// The threads or a model cannot be created; an error of `keep`.
pub fn run(
    threads: usize,
    (task, design, cut): (&Task, &Design, &Cut),
    by_energy: Option<&ByEnergy>,
    make_model: &(impl Fn() -> Result<Component> + Sync),
    chunks: impl Iterator<Item = u64> + Send,
    stop_wish: &AtomicBool,
    mut keep: impl FnMut(u64, Vec<u8>) -> Result<()>,
) -> Result<()> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().context("--threads")?;
    let (sender, done) = sync_channel(WAITING * threads);
    let chunks = Mutex::new(chunks);
    // Set when no more chunks can be stored.
    let has_failed = AtomicBool::new(false);
    let columns = task.responses.columns.len();
    let (chunks, has_failed) = (&chunks, &has_failed);
    pool.in_place_scope(|scope| {
        scope.spawn_broadcast(move |_, _| {
            let work = || -> Result<()> {
                let mut runner = Runner::new(task, make_model()?)?;
                let mut design = design.clone();
                while !has_failed.load(Ordering::Relaxed) {
                    let next = chunks.lock().ok().and_then(|mut chunks| chunks.next());
                    let Some(chunk) = next else { break };
                    let made = chunk::make(cut, chunk, (&mut design, by_energy), &mut runner, columns, stop_wish);
                    let Some(bytes) = made else { break };
                    if sender.send(Ok((chunk, bytes))).is_err() {
                        break;
                    }
                }
                Ok(())
            };
            if let Err(error) = work() {
                // The receiver may have ended.
                let _ = sender.send(Err(error));
            }
        });
        let result = done.iter().try_for_each(|made| made.and_then(|(chunk, bytes)| keep(chunk, bytes)));
        has_failed.store(result.is_err(), Ordering::Relaxed);
        // Threads that wait to pass a chunk continue.
        drop(done);
        result
    })
}
