//! The motion in time: the state, its steps, the events in them.
pub mod advance;
mod coasting;
pub mod contact;
pub mod dynamics;
pub mod events;
mod saved;
pub mod state;
pub mod step_ahead;
pub mod travel;
mod work;

pub use saved::{CircuitState, MOST_REVOLUTIONS, SavedState};
