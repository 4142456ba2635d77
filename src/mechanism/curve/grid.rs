//! The initial grid of tables of functions along the curve.
//!
//! In: a curve with its crossings, an accuracy. Out: borders of panels. It must not know the functions.
use super::evaluate::Curve;
use super::panel::Panel;

/// Factor by which panels are narrower than the second derivatives of the coordinates require by extrapolation.
const CAUTION: f64 = 1.5;
/// Largest width of a panel in panels of the curve.
const JOINED: f64 = 1.5;
/// Largest number of panels in a panel of the curve.
const PIECES: f64 = 9.0;
/// Relative change of width below which the width counts as constant.
const LEVEL: f64 = 1e-9;
/// Order of the coefficients that must be small.
const ORDER: f64 = 14.0;

/// Width of a panel of the grid at one sigma. The width is linear between knots, as is the distance from a singularity.
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

/// sigma at this number of panels from the first of two knots.
fn sigma_at(a: Knot, b: Knot, count: f64) -> f64 {
    let slope = (b.width - a.width) / (b.sigma - a.sigma);
    let growth = slope * count;
    a.sigma + a.width * if growth.abs() < LEVEL { count } else { growth.exp_m1() / slope }
}

impl Curve {
    /// Borders of panels on which second derivatives along the curve should be resolved to `accuracy`, relative to
    /// their largest values. Every crossing is in the middle of a panel, every knot of a law at a border.
    pub fn grid(&self, accuracy: f64) -> Vec<f64> {
        let (first, last) = self.range;
        let knots = self.knots(accuracy);
        // Number of panels up to each knot.
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
            grid.push(sigma_at(knots[k], knots[k + 1], wanted - count[k]));
        }
        grid.push(last);
        self.center_crossings(&mut grid);
        self.insert_knots(&mut grid);
        grid
    }

    /// Width of a panel of the grid in the middle of each panel of the curve, and at the curve's ends.
    fn knots(&self, accuracy: f64) -> Vec<Knot> {
        let largest = self.largest_curvatures();
        let knot = |panel: &Panel| {
            let most = panel.amplifications.iter().fold(1.0, |a: f64, b| a.max(*b));
            // Narrower panels do not reduce a tail that is rounding.
            let allowed = (0.5 * accuracy).max(8.0 * f64::EPSILON * most * most);
            let worst = panel.curvatures.iter().zip(&largest).fold(0.0, |a: f64, ([tail, _], all)| a.max(tail / all));
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

    /// Largest second derivative of each coordinate within the range, or the derivative's natural size if that is
    /// larger. On a panel that extends beyond the range the derivative is sampled at the ends of the part within.
    fn largest_curvatures(&self) -> Vec<f64> {
        let (first, last) = self.range;
        let scale = self.scale();
        let mut largest: Vec<f64> = self.closure.weights.iter().map(|w| 1.0 / (w * scale * scale)).collect();
        let mut include = |i: usize, curvature: f64| largest[i] = largest[i].max(curvature);
        for panel in &self.panels {
            let (low, high) = (first.max(panel.start), last.min(panel.end()));
            if (low, high) == (panel.start, panel.end()) {
                panel.curvatures.iter().enumerate().for_each(|(i, [_, value])| include(i, *value));
            } else if low < high {
                let ends = [low, high].map(|sigma| self.configuration(sigma).q_second);
                ends.iter().for_each(|q| q.iter().enumerate().for_each(|(i, value)| include(i, value.abs())));
            }
        }
        largest
    }

    /// Make every knot of the law of a coupling a border, in place of borders close to it.
    fn insert_knots(&self, grid: &mut Vec<f64>) {
        /// Least width of a panel beside a knot, as a part of the panel that the knot divides.
        const LEAST: f64 = 0.3;
        let knots = if self.linkage().couplings.is_empty() { Vec::new() } else { self.law_knots() };
        for &at in &knots {
            let next = grid.partition_point(|s| *s < at);
            let radius = LEAST * (grid[next.min(grid.len() - 1)] - grid[next.max(1) - 1]);
            let (first, last) = (grid[0], grid[grid.len() - 1]);
            grid.retain(|s| (s - at).abs() > radius || *s == first || *s == last || knots.contains(s));
            if !grid.contains(&at) {
                grid.insert(grid.partition_point(|s| *s < at), at);
            }
        }
    }

    /// Move the borders so that every crossing is in the middle of a panel.
    fn center_crossings(&self, grid: &mut Vec<f64>) {
        for &at in &self.crossings {
            let next = grid.partition_point(|s| *s < at);
            let (below, above) = (grid[next.max(1) - 1], grid[next.min(grid.len() - 1)]);
            // New borders at this distance replace those nearer to the crossing.
            let radius = 0.45 * (above - below);
            let (first, last) = (grid[0], grid[grid.len() - 1]);
            let radius = radius.min(at - first).min(last - at);
            grid.retain(|s| (s - at).abs() > radius || *s == first || *s == last);
            for border in [at - radius, at + radius] {
                if border > first && border < last {
                    grid.insert(grid.partition_point(|s| *s < border), border);
                }
            }
        }
    }
}
