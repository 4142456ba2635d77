//! The grid: panels of sigma on which tables of functions along the curve start.
use super::Curve;

/// Panels are this much narrower than what the second derivatives of the coordinates are expected to need.
const CAUTION: f64 = 1.1;
/// The panels of the curve are joined to no more than this many at once, or cut into no more.
const JOINED: f64 = 1.5;
const PIECES: f64 = 9.0;
/// Order of the coefficients that must be small.
const ORDER: f64 = 14.0;

impl Curve {
    /// Borders of panels on which second derivatives along the curve are expected to be resolved to a part `accuracy` of
    /// their largest values; every crossing is in the middle of one.
    pub fn grid(&self, accuracy: f64) -> Vec<f64> {
        let (first, last) = self.range;
        // Number of table panels up to the start of each panel of the curve.
        let mut count = vec![0.0];
        for need in self.needs(accuracy) {
            count.push(count[count.len() - 1] + need);
        }
        let sigma: Vec<f64> = self.panels.iter().map(|p| p.start).chain(self.panels.last().map(|p| p.end())).collect();
        let between = |of: &[f64], value: &[f64], at: f64| {
            let k = of[1..of.len() - 1].partition_point(|o| *o <= at);
            value[k] + (value[k + 1] - value[k]) * (at - of[k]) / (of[k + 1] - of[k])
        };
        let (low, high) = (between(&sigma, &count, first), between(&sigma, &count, last));
        let pieces = (high - low).ceil().max(1.0);
        let mut grid = vec![first];
        for k in 1..pieces as usize {
            grid.push(between(&count, &sigma, low + (high - low) * k as f64 / pieces));
        }
        grid.push(last);
        self.center_crossings(&mut grid);
        grid
    }

    /// Into how many pieces each panel must be cut; less than 1 if it is narrower than it must be.
    fn needs(&self, accuracy: f64) -> Vec<f64> {
        let scale = self.scale();
        let mut largest: Vec<f64> = self.closure.weights.iter().map(|w| 1.0 / (w * scale * scale)).collect();
        for panel in &self.panels {
            for (all, [_, here]) in largest.iter_mut().zip(&panel.bends) {
                *all = all.max(*here);
            }
        }
        let need = |panel: &super::Panel| {
            let most = panel.amplifications.iter().fold(1.0, |a: f64, b| a.max(*b));
            // What is left of a tail that is rounding is not cut any smaller.
            let allowed = (0.5 * accuracy).max(8.0 * f64::EPSILON * most * most);
            let worst = panel.bends.iter().zip(&largest).fold(0.0, |a: f64, ([tail, _], all)| a.max(tail / all));
            CAUTION * (worst / allowed).powf(1.0 / ORDER).clamp(1.0 / (CAUTION * JOINED), PIECES)
        };
        self.panels.iter().map(need).collect()
    }

    /// Move the borders so that every crossing is in the middle of a panel.
    fn center_crossings(&self, grid: &mut Vec<f64>) {
        for &at in &self.crossings {
            let place = grid.partition_point(|s| *s < at);
            let (below, above) = (grid[place.max(1) - 1], grid[place.min(grid.len() - 1)]);
            // Far enough from the borders next to it, or take these borders away.
            let radius = 0.45 * (above - below);
            let (first, last) = (grid[0], grid[grid.len() - 1]);
            let radius = radius.min(at - first).min(last - at);
            grid.retain(|s| (s - at).abs() > radius || *s == first || *s == last);
            for border in [at - radius, at + radius] {
                if border > first && border < last {
                    let place = grid.partition_point(|s| *s < border);
                    grid.insert(place, border);
                }
            }
        }
    }
}
