//! The stress suite in short: a sample of its scenes.

use validation::stress::{self, Verdict};

/// One scene in this number is evaluated here; coprime to the table's patterns, so that every kind occurs.
const ONE_IN: usize = 11;
/// Scenes with more communication steps are left to the whole suite.
const MOST_STEPS: u64 = 20_000;

#[test]
fn a_sample_of_the_scenes_holds() {
    let mut scenes = stress::all();
    let mut place = 0;
    scenes.retain(|scene| {
        place += 1;
        place % ONE_IN == 0 && scene.steps <= MOST_STEPS
    });
    let outcomes = stress::judge(&scenes, 2, &|_, _| {});
    assert_eq!(outcomes.len(), scenes.len());
    for (scene, outcome) in scenes.iter().zip(&outcomes) {
        let of = format!("{}, {}, {}", scene.group, scene.model, scene.what);
        assert_ne!(outcome.verdict, Verdict::Fails, "{of}: {:?} {:?} {}", outcome.error, outcome.drift, outcome.why);
    }
    println!("{} scenes", scenes.len());
}
