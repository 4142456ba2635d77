//! Quantities whose signs select a law: the normal force of a prismatic joint with friction, whose magnitude counts,
//! and the force along the curve of a drive with an efficiency, which gains or loses by it.
//!
//! At a change of sign the right-hand side has a kink. Within a step the sign is held, so that the laws are smooth; the
//! samples that a step has taken tell whether the quantity may pass 0 in it. In: values, times. Out: signs that count,
//! samples. It must not know what the quantities are.

/// Samples that are kept: more than any method takes in one step.
const KEPT: usize = 24;

/// Some quantities with their held signs.
#[derive(Clone, Debug, Default)]
pub struct Switches {
    /// Held signs; 0 where the sign of the present value counts.
    signs: Vec<f64>,
    /// Values in the present evaluation.
    values: Vec<f64>,
    /// Times [s] of the last evaluations, the oldest one overwritten first.
    times: Vec<f64>,
    /// Values at these times, sample by sample.
    samples: Vec<f64>,
    /// Number of samples taken since the last [`Self::restart`].
    taken: usize,
}

impl Switches {
    /// So many quantities without held signs.
    pub fn new(count: usize) -> Self {
        let kept = if count == 0 { 0 } else { KEPT };
        Self {
            signs: vec![0.0; count],
            values: vec![0.0; count],
            times: vec![0.0; kept],
            samples: vec![0.0; kept * count],
            taken: 0,
        }
    }

    /// Held sign of a quantity; 0 if there is none.
    pub fn sign(&self, switch: usize) -> f64 {
        self.signs[switch]
    }

    /// A quantity has this value; returns a number with the sign that counts.
    #[inline]
    pub fn see(&mut self, switch: usize, value: f64) -> f64 {
        self.values[switch] = value;
        let sign = self.signs[switch];
        if sign == 0.0 { value } else { sign }
    }

    /// Value of a quantity in the last evaluation.
    pub fn seen(&self, switch: usize) -> f64 {
        self.values[switch]
    }

    /// Value of a quantity in the last evaluation, positive where it has its held sign.
    pub fn value(&self, switch: usize) -> f64 {
        self.values[switch] * self.signs[switch]
    }

    /// Hold the signs of the last evaluation; that of 0 is positive.
    pub fn hold(&mut self) {
        for (sign, value) in self.signs.iter_mut().zip(&self.values) {
            *sign = if *value < 0.0 { -1.0 } else { 1.0 };
        }
    }

    /// Hold the same signs as others.
    pub fn hold_as(&mut self, other: &Self) {
        self.signs.copy_from_slice(&other.signs);
    }

    /// Hold no signs.
    pub fn clear(&mut self) {
        self.signs.fill(0.0);
    }

    /// Turn a held sign round.
    pub fn flip(&mut self, switch: usize) {
        self.signs[switch] = -self.signs[switch];
    }

    /// Forget all samples.
    #[inline]
    pub fn restart(&mut self) {
        self.taken = 0;
    }

    /// Keep the values of the last evaluation, which was at the time t [s].
    #[inline]
    pub fn record(&mut self, t: f64) {
        let count = self.signs.len();
        if count > 0 {
            let at = self.taken % KEPT;
            self.times[at] = t;
            self.samples[at * count..(at + 1) * count].copy_from_slice(&self.values);
            self.taken += 1;
        }
    }

    /// A sample by its index: its time [s], and the value, positive with the held sign.
    pub fn sample(&self, index: usize, switch: usize) -> Option<[f64; 2]> {
        let count = self.signs.len();
        let exists = index < self.taken.min(KEPT);
        exists.then(|| [self.times[index], self.samples[index * count + switch] * self.signs[switch]])
    }
}
