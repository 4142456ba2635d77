//! Preparation: every table that a step or an output can need, made at once.
//!
//! In: the reduced model. Out: its tables, and those of the stretches of an open curve near the guess. It must not know
//! states or inputs.
use super::Reduced;
use std::f64::consts::TAU;

/// Distance from the guess up to which an open curve is prepared, in radians of the mechanism's motion: 100 turns, or
/// 200 pi sizes of the linkage where nothing turns.
const FARTHEST: f64 = 100.0 * TAU;

impl Reduced {
    /// Make all tables: of the whole travel, or on an open curve of the stretches up to 100 turns from the guess. What
    /// cannot be tabulated is reported where it is needed.
    pub fn prepare(&self) {
        self.prepare_stretch();
        let farthest = FARTHEST * self.scale();
        for side in 0..2 {
            let mut stretch = self;
            while let Ok(next) = self.next(stretch, side) {
                next.prepare_stretch();
                let (first, last) = next.curve().range;
                let reached = if side == 0 { -first } else { last };
                if reached >= farthest {
                    break;
                }
                stretch = next;
            }
        }
    }

    fn prepare_stretch(&self) {
        let loading = self.loading();
        for air in [false, true].into_iter().take(1 + usize::from(loading.air.is_some())) {
            _ = self.state_loads(air);
        }
        self.reaction_tables();
        let sigma = self.curve().range.0;
        for load in 0..loading.loads.len() {
            _ = self.displacement_around(load, sigma);
        }
        if !self.markers.is_empty() {
            _ = self.marker(0);
        }
        _ = self.origin(0);
    }
}
