//! Near misses: positions where branches of motion almost cross.
//!
//! In: a curve, or the position at which its tracing gave up. Out: the places near it that its linkage almost lets
//! branches cross at. It must not know what is done about them.
//!
//! A branch that misses another one by the distance e turns round within a length of the order of the root of e: the
//! panels that resolve the turn are as short as that, and the amplification of rounding, the inverse of the smallest
//! singular value, peaks there.
use super::evaluate::{Curve, Ends};
use super::misses::Near;
use super::singular::{Place, Singular};
use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::Linkage;

/// Largest miss that is reported, in sizes of the linkage.
pub const REPORTED: f64 = 2e-3;
/// Largest miss that is rounding.
const ROUNDING: f64 = 1e-14;
/// Least amplification of a sharp turn.
const SHARP: f64 = 8.0;
/// Least fall of the amplification on both sides of a sharp turn, and the length for three coordinates within which it
/// falls so much.
const FALL: f64 = 2.0;
const WITHIN: f64 = 0.25;
/// Largest distance of a place from the curve, for three coordinates.
const BESIDE: f64 = 0.3;
/// Largest distance of two places that are one.
const SAME: f64 = 1e-2;

/// A position at which to look for a near miss.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// sigma on the curve; none where tracing gave up.
    pub sigma: Option<f64>,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Whether branches cross there, but for the accuracy of a bridge.
    crosses: bool,
}

impl Candidate {
    /// The position at which tracing gave up.
    pub fn stuck(q: &[f64]) -> Self {
        Self { sigma: None, q: q.to_vec(), crosses: false }
    }

    /// The place near it where the `drawn` linkage almost lets branches cross; `closure`: loop equations of the linkage
    /// on the curve. None if there is no such place, or if the branches do cross.
    pub fn place(&self, closure: &Closure, drawn: &Linkage) -> Option<Place> {
        let gaps = || drawn.gaps(&drawn.positions(&self.q));
        if self.crosses && gaps().iter().all(|gap| gap.abs() < ROUNDING * drawn.size) {
            return None;
        }
        let place = Singular::new(closure, drawn).near(&self.q)?;
        let beside = BESIDE * (self.q.len() as f64 / 3.0).sqrt();
        let is_near = place.distance(&self.q, &closure.weights, drawn.angles) < beside;
        (is_near && place.miss > ROUNDING).then_some(place)
    }

    /// Whether this is one of these places.
    pub fn is_among(&self, places: &[Place], closure: &Closure) -> bool {
        places.iter().any(|place| is_same(place, &self.q, closure))
    }
}

/// Whether a configuration is at a place.
pub fn is_same(place: &Place, q: &[f64], closure: &Closure) -> bool {
    place.distance(q, &closure.weights, closure.linkage.angles) < SAME
}

/// A node of a panel: the length of the curve up to it in the weighted norm, the amplification, the panel, x.
#[derive(Clone, Copy)]
struct Node {
    u: f64,
    amplification: f64,
    panel: usize,
    x: f64,
}

impl Curve {
    /// The linkage with the points of its joints as they were drawn.
    pub fn drawn(&self) -> &Linkage {
        self.near.drawn.as_deref().unwrap_or(&self.closure.linkage)
    }

    /// This curve, of which the start decides how much is traced.
    pub fn decided_by_start(self) -> Self {
        Self { by_start: true, ..self }
    }

    /// This curve with its near misses.
    pub fn with_near(self, near: Near) -> Self {
        Self { near, ..self }
    }

    /// Positions within the range where branches cross, or where the curve turns sharply.
    pub fn candidates(&self) -> Vec<Candidate> {
        let crossings = self.crossings.iter().map(|&sigma| (sigma, true));
        let all = crossings.chain(self.sharp_turns().into_iter().map(|sigma| (sigma, false)));
        let candidate = |(sigma, crosses)| Candidate { sigma: Some(sigma), q: self.coordinates_at(sigma), crosses };
        all.map(candidate).collect()
    }

    /// Coordinates at sigma by the polynomials.
    fn coordinates_at(&self, sigma: f64) -> Vec<f64> {
        let panel = &self.panels[self.panels.partition_point(|p| p.start <= sigma).max(1) - 1];
        panel.coordinates_at(panel.x_at(sigma))
    }

    /// Values of sigma at the peaks of the amplification.
    fn sharp_turns(&self) -> Vec<f64> {
        let most = |panel: &super::panel::Panel| panel.amplifications.iter().fold(0.0, |a: f64, b| a.max(*b));
        if self.panels.iter().all(|panel| panel.bridged || most(panel) < SHARP) {
            return Vec::new();
        }
        let (nodes, whole) = self.nodes();
        let within = WITHIN * (self.guess.len() as f64 / 3.0).sqrt();
        let count = nodes.len();
        // The next node in a direction, with the length to it.
        let around = matches!(self.ends, Ends::Closed(_));
        let next = |k: usize, forward: bool| match (k, forward) {
            (0, false) => around.then(|| (count - 1, nodes[0].u + whole - nodes[count - 1].u)),
            (k, true) if k + 1 == count => around.then(|| (0, nodes[0].u + whole - nodes[k].u)),
            (k, true) => Some((k + 1, nodes[k + 1].u - nodes[k].u)),
            (k, false) => Some((k - 1, nodes[k].u - nodes[k - 1].u)),
        };
        let falls = |k: usize, forward: bool| {
            let (mut at, mut length) = (k, 0.0);
            while let Some((other, apart)) = next(at, forward) {
                (at, length) = (other, length + apart);
                if nodes[at].amplification > nodes[k].amplification || length > within {
                    return false;
                }
                if nodes[at].amplification < nodes[k].amplification / FALL {
                    return true;
                }
            }
            false
        };
        let is_sharp = |amplification: f64| amplification > SHARP && amplification.is_finite();
        let is_peak = |k: &usize| is_sharp(nodes[*k].amplification) && falls(*k, true) && falls(*k, false);
        let sigma = |k: usize| self.panels[nodes[k].panel].sigma_at(nodes[k].x);
        let inside = |sigma: &f64| self.range.0 <= *sigma && *sigma <= self.range.1;
        (0..count).filter(is_peak).map(sigma).filter(inside).collect()
    }

    /// All nodes in order, and the length of the curve. A panel on a bridge, whose crossing is known, counts as one
    /// node of infinite amplification, which is no peak.
    fn nodes(&self) -> (Vec<Node>, f64) {
        let (mut nodes, mut u) = (Vec::new(), 0.0);
        for (index, panel) in self.panels.iter().enumerate() {
            if panel.bridged {
                nodes.push(Node { u: u + 0.5 * panel.width, amplification: f64::INFINITY, panel: index, x: 0.0 });
            } else {
                for (&x, &amplification) in self.transform.nodes.iter().zip(&panel.amplifications) {
                    nodes.push(Node { u: u + 0.5 * panel.width * (1.0 + x), amplification, panel: index, x });
                }
            }
            u += panel.width;
        }
        (nodes, u)
    }
}
