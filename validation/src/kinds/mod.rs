//! Kinds of mechanisms usual in engineering, each with its closed form: a reference for positions, rates, reactions and
//! motion that is independent of the engine.
//!
//! In: usual or random lengths. Out: definitions, and the engine's errors. Must not depend on how the engine closes
//! loops or integrates.
mod check;
mod closed;
mod definition;
mod dyads;
mod expression;
pub(crate) mod jet;
mod lagrange;
mod serial;
pub(crate) mod sketch;
mod wild;

pub use check::{Off, open, run};
pub use closed::Kind;
pub use sketch::Sketch;
pub use wild::{Draw, Vary, wild};

use crate::attack::random::Random;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// All kinds.
pub fn all() -> &'static [Kind] {
    static ALL: OnceLock<Vec<Kind>> = OnceLock::new();
    ALL.get_or_init(|| {
        closed::read().unwrap_or_else(|why| {
            eprintln!("scenes/kinds.json: {why}");
            Vec::new()
        })
    })
}

/// Change of the parameter over a whole travel: a turn [rad, m].
const ROUND: f64 = TAU;

/// A kind with usual lengths under gravity, with a speed at the start; with stops if its travel is not a whole turn.
pub fn usual(place: usize, kind: &'static Kind) -> Sketch {
    let mut sketch = kind.sketch(&mut Vary::none());
    let mut random = Random::new(place as u64);
    sketch.weigh(&mut random, [0.2, 5.0]);
    sketch.start[1] = 2.0 * sketch.own_motion();
    let reach = wild::reach(&sketch, ROUND);
    if reach.iter().any(|end| (end - sketch.start[0]).abs() < ROUND) {
        sketch.stops = wild::stops(&sketch, reach, [0.8, 0.8], 0.5);
    }
    sketch.loads.gravity = [9.81, PI / 2.0];
    sketch.tolerance = 1e-10;
    sketch
}

/// The difference of two angles without whole turns [rad].
pub fn angle_apart(a: f64, b: f64) -> f64 {
    let apart = (a - b).rem_euclid(TAU);
    if apart > PI { apart - TAU } else { apart }
}
