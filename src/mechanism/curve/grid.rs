//! The grid: panels of sigma on which tables of functions along the curve start.
use super::Curve;

/// Panels are this much narrower than what the second derivatives of the coordinates are expected to need.
const CAUTION: f64 = 1.5;
/// The panels of the curve are joined to no more than this many at once, or cut into no more.
const JOINED: f64 = 1.5;
const PIECES: f64 = 9.0;
/// Widths that change by no more than this part are taken for constant.
const LEVEL: f64 = 1e-9;
/// Order of the coefficients that must be small.
const ORDER: f64 = 14.0;

/// How wide a panel of the grid may be at one sigma; in between linear, as the distance from a singularity is.
#[derive(Clone, Copy)]
struct Knot {
    sigma: f64,
    width: f64,
}

/// Number of panels from one knot up to sigma: the integral of 1 / width.
fn between(a: Knot, b: Knot, sigma: f64) -> f64 {
    let slope = (b.width - a.width) / (b.sigma - a.sigma);
    let change = slope * (sigma - a.sigma) / a.width;
    if change.abs() < LEVEL { (sigma - a.sigma) / a.width } else { change.ln_1p() / slope }
}

/// sigma this number of panels on from the first of two knots.
fn reached(a: Knot, b: Knot, count: f64) -> f64 {
    let slope = (b.width - a.width) / (b.sigma - a.sigma);
    let growth = slope * count;
    a.sigma + a.width * if growth.abs() < LEVEL { count } else { growth.exp_m1() / slope }
}

impl Curve {
    /// Borders of panels on which second derivatives along the curve are expected to be resolved to a part `accuracy` of
    /// their largest values; every crossing is in the middle of one.
    pub fn grid(&self, accuracy: f64) -> Vec<f64> {
        let (first, last) = self.range;
        let knots = self.knots(accuracy);
        // Number of table panels up to each knot, then up to the first sigma and in all.
        let mut count = vec![0.0];
        for pair in knots.windows(2) {
            count.push(count[count.len() - 1] + between(pair[0], pair[1], pair[1].sigma));
        }
        let at = |sigma: f64| {
            let k = knots[1..knots.len() - 1].partition_point(|k| k.sigma <= sigma);
            count[k] + between(knots[k], knots[k + 1], sigma)
        };
        let low = at(first);
        let total = at(last) - low;
        let pieces = total.ceil().max(1.0);
        let mut grid = vec![first];
        for k in 1..pieces as usize {
            let wanted = low + total * k as f64 / pieces;
            let k = count[1..count.len() - 1].partition_point(|c| *c <= wanted);
            grid.push(reached(knots[k], knots[k + 1], wanted - count[k]));
        }
        grid.push(last);
        self.center_crossings(&mut grid);
        grid
    }

    /// How wide a panel may be in the middle of each panel of the curve, and at the curve's ends.
    fn knots(&self, accuracy: f64) -> Vec<Knot> {
        let largest = self.largest_bends();
        let knot = |panel: &super::Panel| {
            let most = panel.amplifications.iter().fold(1.0, |a: f64, b| a.max(*b));
            // What is left of a tail that is rounding is not cut any smaller.
            let allowed = (0.5 * accuracy).max(8.0 * f64::EPSILON * most * most);
            let worst = panel.bends.iter().zip(&largest).fold(0.0, |a: f64, ([tail, _], all)| a.max(tail / all));
            let need = CAUTION * (worst / allowed).powf(1.0 / ORDER);
            let (start, end) = (panel.start, panel.end());
            Knot { sigma: 0.5 * (start + end), width: (end - start) / need.clamp(1.0 / JOINED, PIECES) }
        };
        let mut knots: Vec<Knot> = self.panels.iter().map(knot).collect();
        let (first, last) = self.traced();
        if let (Some(&low), Some(&high)) = (knots.first(), knots.last()) {
            knots.insert(0, Knot { sigma: first, ..low });
            knots.push(Knot { sigma: last, ..high });
        }
        knots
    }

    /// Largest second derivative of each coordinate within the range, or its natural size. On a panel that reaches beyond
    /// the range it is looked for at the ends of what is within.
    fn largest_bends(&self) -> Vec<f64> {
        let (first, last) = self.range;
        let scale = self.scale();
        let mut largest: Vec<f64> = self.closure.weights.iter().map(|w| 1.0 / (w * scale * scale)).collect();
        let mut meet = |place: usize, bend: f64| largest[place] = largest[place].max(bend);
        for panel in &self.panels {
            let (low, high) = (first.max(panel.start), last.min(panel.end()));
            if (low, high) == (panel.start, panel.end()) {
                panel.bends.iter().enumerate().for_each(|(i, [_, bend])| meet(i, *bend));
            } else if low < high {
                let ends = [low, high].map(|sigma| self.configuration(sigma).q_second);
                ends.iter().for_each(|bends| bends.iter().enumerate().for_each(|(i, bend)| meet(i, bend.abs())));
            }
        }
        largest
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
