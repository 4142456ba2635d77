//! Comparison of outputs with closed forms.

/// Rounding of the compared expressions and of the tables (1e-13 of each table's largest value), for products and
/// quotients of up to three tables.
pub const ACCURACY: f64 = 1e-12;

/// Numbers between -1 and 1 that differ from state to state.
pub fn wave(k: i32, rate: f64) -> f64 {
    (rate * f64::from(k) + 0.3).sin()
}

/// Largest difference seen, relative to the size of the compared quantity.
#[derive(Default)]
pub struct Worst(Vec<(&'static str, f64)>);

impl Worst {
    /// `size`: the largest term of the quantity, if its terms may cancel.
    pub fn compare(&mut self, what: &'static str, actual: f64, expected: f64, size: f64) {
        let error = (actual - expected).abs() / size.abs().max(expected.abs());
        let error = if actual == expected { 0.0 } else { error };
        match self.0.iter_mut().find(|(name, _)| *name == what) {
            Some((_, worst)) => *worst = if error.is_nan() { f64::NAN } else { worst.max(error) },
            None => self.0.push((what, error)),
        }
    }

    pub fn assert_within(&self, allowed: f64) {
        for (what, worst) in &self.0 {
            assert!(*worst <= allowed, "{what}: relative difference {worst:e}, allowed {allowed:e}");
        }
    }
}
