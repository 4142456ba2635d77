//! The first kind of model: a planar linkage with one degree of freedom.
pub mod closure;
pub mod curve;
pub mod definition;
mod designs;
mod dynamics;
mod error;
mod fem_motion;
pub mod inspection;
pub mod interface;
pub mod linkage;
pub mod loads;
mod model;
mod motion;
mod outputs;
mod parameters;
pub mod quantity;
pub mod reactions;
pub mod reduced;
pub mod rigid_fem;
mod snapshot;
mod warnings;
mod with_hydraulics;

pub use crate::integrator::Statistics;
pub use definition::MOST_STATES;
pub use error::ModelError;
pub use model::{INPUT_ORDER, Line, Linearisation, Linearised, Model, NoValue, OUTPUT_ORDER};
pub use motion::fast_forward::{FastForward, Waypoint};
pub use motion::state::Reached;
pub use motion::travel_time::TravelTime;
pub use motion::witness::Pauses;
pub use outputs::Computed;
pub use snapshot::Snapshot;
pub use with_hydraulics::allow_hydraulics;

/// The default mechanism, for tests.
#[cfg(test)]
pub(crate) const GEAR: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/modelDescription/LandingGearRetraction/resources/mechanism.json"
));
