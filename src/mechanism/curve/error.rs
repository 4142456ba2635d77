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
                "the reduced inertia vanishes at {position}: nothing or almost nothing with mass moves there; give a \
                 mass or an inertia to a body that does"
            ),
            Self::NearCrossing { position, miss: None, .. } => write!(
                f,
                "two branches of motion almost cross at {position}: the lengths miss a crossing by so little that \
                 rounding decides; \
                 change a length by a part in 1e5 or more, or make them cross to the last digit"
            ),
            Self::NearCrossing { position, miss: Some(miss), .. } => write!(
                f,
                "two branches of motion almost cross at {position}: the lengths miss a crossing by {miss:.1e} of the \
                 size of \
                 the mechanism, so little that rounding decides; give \"snap\": {:e} or more if the motion is to go \
                 straight \
                 on there, or change a length by a part in 1e5 or more",
                cure(*miss)
            ),
            Self::Stuck { position, .. } => {
                write!(
                    f,
                    "the linkage cannot be followed past {position}: its motion ends or has a cusp there; change the \
                     lengths"
                )
            }
            Self::Unwound { position, revolutions } => write!(
                f,
                "an angle has made {revolutions:.1e} revolutions at {position}, where the rounding of angles, {:.0e} \
                 rad, no \
                 longer keeps the wheels of the couplings in mesh: numbers of teeth whose angles all return within 100 \
                 revolutions have no such limit",
                revolutions * TAU * f64::EPSILON
            ),
            Self::Outside(position) => {
                write!(f, "no travel is permitted from {position}: state a position within the limits, or widen them")
            }
            Self::TooLong { panels } => {
                write!(f, "the motion does not return to its start within {panels} panels; simplify the linkage")
            }
            Self::Inconsistent { joint, gap, position } => write!(
                f,
                "the redundant joint {joint} opens by {gap:.3e} m at {position}: correct its points so that it fits \
                 everywhere, or remove it"
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
