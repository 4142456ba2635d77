//! The curve of closed positions, traced once and parametrised by its length in the kinetic metric.
//!
//! In: an assembled linkage. Out: for every sigma the configuration with its first and second derivatives. It must not
//! know loads, inputs or time.
//!
//! sigma [kg^(1/2) m] is the arc length for which the kinetic energy is T = sigma_dot^2 / 2: the reduced inertia of
//! [CK16] is 1 everywhere, its derivative 0, and a motion without loads is sigma = sigma_0 + sigma_dot t exactly. A toggle
//! is an ordinary point of it. Where branches cross, the curve goes straight on.
mod configuration;
mod crossings;
mod grid;
mod known;
mod panel;
mod trace;
mod travel;

pub use configuration::{Configuration, Workspace};
pub use panel::Panel;
pub use trace::NEAR_CROSSING;

use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::Linkage;
use crate::numerics::chebyshev::Transform;
use std::fmt;

/// Why the curve could not be traced.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveError {
    /// The kinetic energy of a motion through this position vanishes.
    Massless {
        /// Coordinates by name.
        position: String,
    },
    /// Two branches of motion come so near to each other here that rounding decides which one is followed.
    NearCrossing {
        /// Coordinates by name.
        position: String,
    },
    /// No panel, however short, leads on from this position.
    Stuck {
        /// Coordinates by name.
        position: String,
    },
    /// No travel is permitted from this position.
    Outside {
        /// Coordinates by name.
        position: String,
    },
    /// The curve is longer than can be traced.
    TooLong {
        /// Number of panels after which tracing stopped.
        panels: usize,
    },
    /// Redundant joints that do not fit together here.
    Inconsistent {
        /// The joint that opens.
        joint: String,
        /// Its gap [m].
        gap: f64,
        /// Coordinates by name.
        position: String,
    },
}

impl fmt::Display for CurveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Massless { position } => write!(
                f,
                "the reduced inertia vanishes at {position}: nothing or almost nothing with mass moves there; give a mass or an inertia to a body that does"
            ),
            Self::NearCrossing { position } => write!(
                f,
                "two branches of motion almost cross at {position}: the lengths miss a crossing by so little that rounding tells; \
                 change a length by a part in 1e5 or more, or make them cross to the last digit"
            ),
            Self::Stuck { position } => {
                write!(
                    f,
                    "the linkage cannot be followed past {position}: its motion ends or has a cusp there; change the lengths"
                )
            }
            Self::Outside { position } => {
                write!(f, "no travel is permitted from {position}: state a position within the limits, or widen them")
            }
            Self::TooLong { panels } => {
                write!(f, "the motion does not return to its start within {panels} panels; simplify the linkage")
            }
            Self::Inconsistent { joint, gap, position } => write!(
                f,
                "the redundant joint {joint} opens by {gap:.3e} m at {position}: correct its points so that it fits everywhere, or remove it"
            ),
        }
    }
}

impl std::error::Error for CurveError {}

/// How a curve ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Ends {
    /// It returns to its start; the coordinates have then grown by these amounts (multiples of 2 pi, or 0).
    Closed(Vec<f64>),
    /// It was traced as far as the prismatic joints reasonably go.
    Open,
    /// It leaves the permitted travel at the low end of sigma, the high end, or both; where not, it is open.
    Stopped {
        /// At the first sigma.
        low: bool,
        /// At the last sigma.
        high: bool,
    },
}

/// The curve of closed positions of a linkage.
#[derive(Clone, Debug)]
pub struct Curve {
    closure: Closure,
    transform: Transform,
    panels: Vec<Panel>,
    /// First and last sigma; the panels reach on where travel stops.
    range: (f64, f64),
    ends: Ends,
    /// Values of sigma where branches cross, ascending.
    crossings: Vec<f64>,
    /// Positions closed in tracing it.
    closed: usize,
}

impl Curve {
    /// First and last sigma.
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// First and last sigma of the panels: where travel stops, they reach on.
    fn traced(&self) -> (f64, f64) {
        match (self.panels.first(), self.panels.last()) {
            (Some(first), Some(last)) => (first.start, last.end()),
            _ => (0.0, 0.0),
        }
    }

    /// How it ends.
    pub fn ends(&self) -> &Ends {
        &self.ends
    }

    /// Mean length along the curve for a motion of the size of one radian (of all coordinates together).
    pub fn scale(&self) -> f64 {
        let (first, last) = self.traced();
        (last - first) / self.panels.iter().map(|p| p.width).sum::<f64>()
    }

    /// Values of sigma where branches cross.
    pub fn crossings(&self) -> &[f64] {
        &self.crossings
    }

    /// Number of positions that were closed in tracing it, those of panels tried in vain among them: the cost.
    pub fn closed(&self) -> usize {
        self.closed
    }

    /// Whether loop equations are redundant.
    pub fn redundant(&self) -> bool {
        self.closure.redundant()
    }

    /// The linkage.
    pub fn linkage(&self) -> &Linkage {
        &self.closure.linkage
    }

    /// How much a rounding error in the loops is amplified at sigma; infinite where branches cross to the last digit.
    pub fn amplification(&self, sigma: f64) -> f64 {
        let c = self.configuration(sigma);
        let (mut tangent, mut work) = (c.q_sigma, crate::mechanism::closure::Workspace::default());
        self.closure.normalise(&mut tangent);
        if self.closure.linearise(&c.q, &mut work) {
            self.closure.amplification(&self.closure.normal(&tangent), &mut work)
        } else {
            f64::INFINITY
        }
    }

    /// The coordinates at sigma, after so many turns of a closed curve, by name and in words.
    pub fn describe(&self, sigma: f64, revolutions: f64) -> String {
        let mut q = self.configuration(sigma).q;
        if let Ends::Closed(growth) = &self.ends {
            q.iter_mut().zip(growth).for_each(|(q, growth)| *q += revolutions * growth);
        }
        trace::describe(&self.closure, &q)
    }

    /// The loop equations.
    pub(crate) fn closure(&self) -> &Closure {
        &self.closure
    }
}

#[cfg(test)]
mod tests;
