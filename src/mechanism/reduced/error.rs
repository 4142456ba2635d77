//! Why a definition gives no reduced model.
use crate::mechanism::closure::AssemblyError;
use crate::mechanism::curve::CurveError;
use crate::mechanism::definition::DefinitionError;
use crate::numerics::decimal::Decimal;
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
        /// Least and largest value within the stops on the curve.
        range: (f64, f64),
        /// The value that is whole turns away and within them, where there is one.
        turned: Option<f64>,
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
            Self::Start { name, value, range: (low, high), turned } => {
                let (low, high) = (Decimal::rounded(*low), Decimal::rounded(*high));
                write!(f, "{name} = {} cannot be reached: the linkage moves from {low} to {high}", Decimal(*value))?;
                match turned {
                    Some(same) => write!(f, ", where {} is the same position: state that", Decimal::rounded(*same)),
                    None => Ok(()),
                }
            }
            Self::StartSpeed { name, value } => write!(
                f,
                "{name} = {} cannot be had: at this position it stands still whatever the speed (a toggle); \
                 state the start by another body",
                Decimal(*value)
            ),
        }
    }
}

impl std::error::Error for ReductionError {}

impl ReductionError {
    /// The same of a start that is stated by a quantity which has this value where the coordinate has its.
    pub fn as_stated(mut self, stated: f64) -> Self {
        if let Self::Start { value, range, turned, .. } = &mut self {
            let offset = stated - *value;
            *value = stated;
            *range = (range.0 + offset, range.1 + offset);
            *turned = turned.map(|turned| turned + offset);
        }
        self
    }
}
