//! Lengths as usual, or random ones about them.
use crate::attack::random::Random;

/// Where the lengths of a mechanism come from.
pub struct Vary {
    random: Option<Random>,
    spread: f64,
}

impl Vary {
    /// Usual lengths.
    pub fn none() -> Self {
        Self { random: None, spread: 0.0 }
    }

    /// Random lengths, each up to the part `spread` longer or shorter than usual.
    pub fn random(random: Random, spread: f64) -> Self {
        Self { random: Some(random), spread }
    }

    /// A length [m].
    pub fn length(&mut self, usual: f64) -> f64 {
        let spread = self.spread;
        self.random.as_mut().map_or(usual, |random| usual * (1.0 + spread * random.within(-1.0, 1.0)))
    }

    /// An angle, up to `most` more or less [rad].
    pub fn angle(&mut self, usual: f64, most: f64) -> f64 {
        self.random.as_mut().map_or(usual, |random| usual + most * random.within(-1.0, 1.0))
    }

    /// A number of equal parts.
    pub fn count(&mut self, usual: usize, least: usize, most: usize) -> usize {
        self.random.as_mut().map_or(usual, |random| least + random.below(most - least + 1))
    }
}
