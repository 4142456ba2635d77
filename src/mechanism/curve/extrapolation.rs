//! Extrapolation of the curve: a guess of the next node of a panel.

/// The last points of the curve with their slopes, through which Hermite's polynomial is extrapolated.
#[derive(Debug, Default)]
pub(super) struct Extrapolation {
    u: [f64; Self::MOST],
    q: [Vec<f64>; Self::MOST],
    slope: [Vec<f64>; Self::MOST],
    count: usize,
}

impl Extrapolation {
    /// Largest number of points.
    const MOST: usize = 4;

    /// Begin with one point, at u = 0.
    pub(super) fn start(&mut self, q: &[f64], slope: &[f64]) {
        self.count = 0;
        self.add(0.0, q, slope, 1.0);
    }

    /// Add a point at u with the slope `speed` times `direction`. With [`Self::MOST`] points it replaces the oldest.
    /// The third point replaces the one at u = 0, which is so near the first node that rounding would be amplified.
    pub(super) fn add(&mut self, u: f64, q: &[f64], direction: &[f64], speed: f64) {
        let at = match self.count {
            2 if self.u[0] == 0.0 => 0,
            Self::MOST => (0..Self::MOST).fold(0, |a, b| if self.u[b] < self.u[a] { b } else { a }),
            count => count,
        };
        self.u[at] = u;
        self.q[at].clear();
        self.q[at].extend_from_slice(q);
        self.slope[at].clear();
        self.slope[at].extend(direction.iter().map(|d| speed * d));
        self.count = self.count.max(at + 1);
    }

    /// Value at u of Hermite's polynomial through the points with their slopes.
    pub(super) fn extrapolate(&self, u: f64, q: &mut Vec<f64>) {
        q.clear();
        q.resize(self.q[0].len(), 0.0);
        for i in 0..self.count {
            let (mut basis, mut slope) = (1.0, 0.0);
            for k in (0..self.count).filter(|k| *k != i) {
                let apart = self.u[i] - self.u[k];
                basis *= (u - self.u[k]) / apart;
                slope += 1.0 / apart;
            }
            let away = u - self.u[i];
            let (of_value, of_slope) = ((1.0 - 2.0 * away * slope) * basis * basis, away * basis * basis);
            for (sum, (value, slope)) in q.iter_mut().zip(self.q[i].iter().zip(&self.slope[i])) {
                *sum += of_value * value + of_slope * slope;
            }
        }
    }
}
