//! Errors of tracing.
use std::f64::consts::TAU;
use std::fmt;

/// Error of tracing a curve, with the position: coordinates by name and in words.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveError {
    /// The kinetic energy of a motion through this position vanishes.
    Massless(String),
    /// Two branches of motion almost cross here: rounding decides which one is followed.
    NearCrossing {
        /// Coordinates by name and in words.
        position: String,
        /// Coordinates.
        at: Vec<f64>,
        /// How much the loops lack of crossing, in sizes of the linkage; none if that is not known.
        miss: Option<f64>,
    },
    /// No panel, however short, leads on from this position.
    Stuck {
        /// Coordinates by name and in words.
        position: String,
        /// Coordinates.
        at: Vec<f64>,
    },
    /// Angles have so many revolutions that their rounding no longer keeps wheels in mesh.
    Unwound {
        /// Coordinates by name and in words.
        position: String,
        /// Revolutions of the angle that has gone farthest from its guess.
        revolutions: f64,
    },
    /// No travel is permitted from this position.
    Outside(String),
    /// The curve has too many panels.
    TooLong {
        /// Number of panels after which tracing stopped.
        panels: usize,
    },
    /// Redundant joints contradict each other here.
    Inconsistent {
        /// Name of the joint that opens.
        joint: String,
        /// Its gap [m].
        gap: f64,
        /// Coordinates.
        position: String,
    },
}

impl fmt::Display for CurveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Massless(position) => write!(
                f,
                "the reduced inertia is zero or almost zero at {position}, because no mass, or almost no mass moves \
                    there; add a mass or an inertia to a body that moves at this position"
            ),
            Self::NearCrossing { position, miss: None, .. } => write!(
                f,
                "two branches of motion almost cross at {position}, so rounding would decide how the motion continues; \
                 change a length by at least 1e-5 of its value, or write the lengths with all digits so that the \
                 branches cross"
            ),
            Self::NearCrossing { position, miss: Some(miss), .. } => write!(
                f,
                "two branches of motion almost cross at {position}: the lengths miss a crossing by {miss:.1e} of the \
                 size of the mechanism, so rounding would decide how the motion continues; for a motion straight \
                 through the crossing, write \"snap\": {:e} or more; otherwise change a length by at least 1e-5 of its \
                 value",
                cure(*miss)
            ),
            Self::Stuck { position, .. } => {
                write!(
                    f,
                    "the motion cannot be computed beyond {position}: the path of the mechanism ends or has a cusp at \
                        this position; change the lengths"
                )
            }
            Self::Unwound { position, revolutions } => write!(
                f,
                "an angle has made {revolutions:.1e} revolutions at {position}: the rounding of the angle, {:.0e} rad, \
                 is too large to keep the wheels of the couplings in mesh; use numbers of teeth with which all wheels \
                 return to their start within 100 revolutions; with these numbers of teeth the revolutions are not \
                 limited",
                revolutions * TAU * f64::EPSILON
            ),
            Self::Outside(position) => {
                write!(
                    f,
                    "the stops allow no motion from {position}: start at a position between the stops, or move the \
                     stops"
                )
            }
            Self::TooLong { panels } => {
                write!(
                    f,
                    "the motion is too long to be computed: after {panels} sections of the motion the mechanism has \
                        not returned to its start; simplify the linkage"
                )
            }
            Self::Inconsistent { joint, gap, position } => write!(
                f,
                "the two points of the redundant joint {joint} are {gap:.3e} m apart at {position}: correct these \
                    points so that they coincide in every position, or remove this joint"
            ),
        }
    }
}

impl std::error::Error for CurveError {}

/// The value of `snap` that puts a miss right: the next larger number of one digit.
pub fn cure(miss: f64) -> f64 {
    let text = format!("{miss:.0e}");
    let rounded: f64 = text.parse().unwrap_or(miss);
    if rounded >= miss {
        return rounded;
    }
    let unit = 10f64.powf(miss.log10().floor());
    format!("{:.0e}", rounded + unit).parse().unwrap_or(rounded + unit)
}
