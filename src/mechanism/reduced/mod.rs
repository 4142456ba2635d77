//! The reduced model: the linkage as one element that moves along sigma, in tables.
//!
//! In: a definition. Out: the influence of every load, and on request the coordinates, displacements, markers and
//! reactions as tables of sigma. A table is built at its first use; all are immutable and shared. It must not know
//! states or inputs.
mod bodies;
mod build;
mod characteristics;
mod error;
mod exact;
mod knots;
mod meetings;
mod model;
mod prepare;
mod reactions;
mod resolved;
mod snap;
mod source;
mod start;
mod state_loads;
mod stored;
mod stretches;
mod tables;
mod weight;

pub use bodies::Bodies;
pub use error::{ReductionError, if_degrees};
pub use exact::{ExactMotion, ExactReactions};
pub use knots::AT_KNOT;
pub use model::{Built, Reduced};
pub use reactions::PanelTable;
pub use source::Components;
pub use start::Stated;
pub use state_loads::{Argument, Kink, StateLoads};
pub use stretches::End;
