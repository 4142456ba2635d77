//! The stress suite: scenes at the ends of what can be asked for, each with a bound that is derived, and its verdict.
pub mod case;
pub mod hydraulic;
pub mod motion;
pub mod plan;
pub mod reference;
pub mod scene;
pub mod scenes;

pub use scene::{Outcome, Scene, Verdict};

/// One row of the suite.
pub trait Row: Sync {
    /// Heading under which it stands.
    fn group(&self) -> &str;
    /// The model.
    fn model(&self) -> &str;
    /// What is done to it.
    fn what(&self) -> &str;
    /// Relative tolerance.
    fn tolerance(&self) -> f64;
    /// Communication steps.
    fn steps(&self) -> u64;
    /// Run it and judge it.
    fn judge(&self) -> Outcome;
}

/// All rows, group by group.
pub fn all() -> Vec<Box<dyn Row>> {
    let mut all: Vec<Box<dyn Row>> = Vec::new();
    all.extend(scenes::all().into_iter().map(|scene| Box::new(scene) as Box<dyn Row>));
    all.extend(hydraulic::all());
    all
}

/// Judge scenes on `threads` threads; each outcome is told as it comes, with the scene's place, and all are returned in
/// the scenes' order.
pub fn judge(scenes: &[Box<dyn Row>], threads: usize, tell: &(dyn Fn(usize, &Outcome) + Sync)) -> Vec<Outcome> {
    let next = std::sync::atomic::AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let place = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            let Some(scene) = scenes.get(place) else { return done };
            let outcome = scene.judge();
            tell(place, &outcome);
            done.push((place, outcome));
        }
    };
    let mut all: Vec<(usize, Outcome)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    all.sort_by_key(|(place, _)| *place);
    all.into_iter().map(|(_, outcome)| outcome).collect()
}
