//! Why a definition gives no reduced model.
use crate::closure::AssemblyError;
use crate::curve::CurveError;
use crate::definition::DefinitionError;
use std::fmt;

/// Why a definition gives no reduced model.
#[derive(Clone, Debug, PartialEq)]
pub enum ReductionError {
    /// The definition contradicts itself.
    Definition(DefinitionError),
    /// The loops do not close, or there is not one degree of freedom.
    Assembly(AssemblyError),
    /// The curve cannot be traced.
    Curve(CurveError),
    /// The two ends of an actuator or a spring coincide somewhere, so that its force has no direction.
    EndsMeet {
        /// Its name.
        name: String,
        /// Where the linkage then is.
        position: String,
    },
    /// A function along the curve is not smooth.
    Table {
        /// What is tabulated.
        what: String,
        /// Where the linkage then is.
        position: String,
    },
    /// The stated start is not on the curve.
    Start {
        /// Variable that states it.
        name: String,
        /// Its value.
        value: f64,
        /// Least and largest value on the curve.
        range: (f64, f64),
    },
    /// The start speed cannot be had: the stated coordinate stands still at this position.
    StartSpeed {
        /// Variable that states it.
        name: String,
        /// Its value.
        value: f64,
    },
}

impl fmt::Display for ReductionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Definition(e) => e.fmt(f),
            Self::Assembly(e) => e.fmt(f),
            Self::Curve(e) => e.fmt(f),
            Self::EndsMeet { name, position } => write!(
                f,
                "{name}: its two ends coincide near {position}, where its force has no direction; move one of its attachments"
            ),
            Self::Table { what, position } => write!(
                f,
                "{what} is not smooth near {position}: almost nothing with mass moves there; give a mass or an inertia to a body that does"
            ),
            Self::Start { name, value, range: (low, high) } => {
                write!(f, "{name} = {value} cannot be reached: the linkage moves from {low} to {high}")
            }
            Self::StartSpeed { name, value } => write!(
                f,
                "{name} = {value} cannot be had: at this position it stands still whatever the speed (a toggle); \
                 state the start by another body"
            ),
        }
    }
}

impl std::error::Error for ReductionError {}
