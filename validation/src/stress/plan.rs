//! Division of a scene's time into communication steps, and the course of its input.

/// Division of the span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cut {
    /// This number of equal steps.
    Equal(u64),
    /// This number of steps with random lengths over six decades.
    Irregular(u64),
    /// This number of equal steps, each followed by a step of one unit in the last place of the time.
    Ulps(u64),
    /// This number of steps, alternating between 1 us and long.
    Turns(u64),
}

/// Course of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Force {
    /// Constant at its default.
    Stated,
    /// Its sign changes in every step.
    Switching,
    /// The default plus a random part of up to this factor times the default, different in every step.
    Noise(f64),
}

impl Force {
    /// Its name in the table.
    pub fn word(self) -> &'static str {
        match self {
            Self::Stated => "steady",
            Self::Switching => "switching",
            Self::Noise(_) => "with noise",
        }
    }
}

/// The steps and the input of a scene.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Its length [s].
    pub span: f64,
    /// Its steps.
    pub cut: Cut,
    /// Its input.
    pub force: Force,
    /// Sizes of irregular steps [s].
    sizes: Vec<f64>,
}

impl Plan {
    /// A span in steps, with an input.
    pub fn new(span: f64, cut: Cut, force: Force) -> Self {
        let sizes = match cut {
            Cut::Irregular(count) => {
                let weights: Vec<f64> = (0..count).map(|k| 10f64.powf(6.0 * random(k))).collect();
                let sum: f64 = weights.iter().sum();
                weights.iter().map(|w| span * w / sum).collect()
            }
            _ => Vec::new(),
        };
        Self { span, cut, force, sizes }
    }

    /// A span in equal steps with the input as stated.
    pub fn steady(span: f64, steps: u64) -> Self {
        Self::new(span, Cut::Equal(steps), Force::Stated)
    }

    /// Number of communication steps.
    pub fn steps(&self) -> u64 {
        match self.cut {
            Cut::Equal(n) | Cut::Irregular(n) => n,
            Cut::Ulps(n) | Cut::Turns(n) => 2 * n,
        }
    }

    /// Size of step `k` [s].
    pub fn size(&self, k: u64) -> f64 {
        match self.cut {
            Cut::Equal(n) => self.span / n as f64,
            Cut::Irregular(_) => self.sizes[k as usize],
            Cut::Ulps(n) => {
                let long = self.span / n as f64;
                if k.is_multiple_of(2) { long } else { f64::EPSILON * long * (k + 1) as f64 / 2.0 }
            }
            Cut::Turns(n) => {
                let short = 1e-6_f64.min(0.5 * self.span / n as f64);
                if k.is_multiple_of(2) { short } else { self.span / n as f64 - short }
            }
        }
    }

    /// The input in step `k`, with the default `stated`.
    pub fn input(&self, k: u64, stated: f64) -> f64 {
        match self.force {
            Force::Stated => stated,
            Force::Switching if k.is_multiple_of(2) => stated,
            Force::Switching => -stated,
            Force::Noise(part) => stated * (1.0 + part * (2.0 * random(k) - 1.0)),
        }
    }
}

/// Number `k` of a fixed pseudo-random sequence, from 0 to 1: splitmix64 (Steele, Lea, Flood 2014).
pub fn random(k: u64) -> f64 {
    let mut z = (k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}
