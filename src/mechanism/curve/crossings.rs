//! Crossings: values of sigma where other branches cross the curve and the loop equations lose rank.
//!
//! In: the panels of a curve. Out: crossings. It must not know loads.
use super::course::Course;
use super::evaluate::Curve;
use crate::mechanism::closure::Scratch;
use crate::numerics::chebyshev::NODES;

/// Margin at a node, relative to the largest of the panel, below which a minimum may be a crossing.
const LOW: f64 = 0.3;
/// Relative margin at a crossing.
const NONE: f64 = 1e-6;

impl Curve {
    /// Values of sigma where the loop equations lose rank, ascending. The *margin*, the inverse of the amplification,
    /// falls linearly to 0 on both sides of a crossing, as does the smallest singular value.
    pub(super) fn find_crossings(&self) -> Vec<f64> {
        let mut found: Vec<f64> = Vec::new();
        let mut scratch = Scratch::default();
        for panel in &self.panels {
            if panel.bridged {
                found.extend(
                    panel.crossing.map(|x| panel.sigma_at(x)).filter(|s| *s > self.range.0 && *s < self.range.1),
                );
                continue;
            }
            let coordinates = |x: f64| panel.coordinates_at(x);
            let course = Course { closure: &self.closure, normal: &panel.normal, coordinates: &coordinates };
            let margins: [f64; NODES] = std::array::from_fn(|j| 1.0 / panel.amplifications[j]);
            let most = margins.iter().fold(0.0, |a: f64, m| a.max(*m));
            // Panels end away from crossings: no minimum is at a border.
            for j in 1..NODES - 1 {
                if margins[j] <= margins[j - 1] && margins[j] < margins[j + 1] && margins[j] < LOW * most {
                    let nodes = &self.transform.nodes;
                    let x = course.least_margin([nodes[j - 1], nodes[j], nodes[j + 1]], &mut scratch);
                    let sigma = panel.sigma_at(x);
                    let apart = found.last().is_none_or(|last| sigma - last > 1e-6 * self.scale());
                    let inside = sigma > self.range.0 && sigma < self.range.1;
                    if inside && apart && course.margin(x, &mut scratch) < NONE * most {
                        found.push(sigma);
                    }
                }
            }
        }
        found
    }

    /// Whether other branches cross the curve at one of its [`Self::crossings`]. Where joints are redundant, the
    /// independent loop equations may be singular at a position where all of them together are not.
    pub fn branches_cross(&self, sigma: f64) -> bool {
        !self.closure.redundant() || self.closure.loses_rank(&self.configuration(sigma).q)
    }
}
