//! The motion in time: the state, its steps, the events in them.
pub mod acting;
pub mod advance;
mod coasting;
pub mod contact;
pub mod dynamics;
mod elapsed;
pub mod equilibrium;
pub mod events;
pub mod fast_forward;
mod hydraulic_motion;
pub mod impacts;
mod memory;
mod path_effects;
mod power_ahead;
pub mod prescribed;
pub mod samples;
mod saved;
pub mod state;
pub mod step_ahead;
pub mod travel;
pub mod travel_time;
pub mod witness;
mod work;

pub use memory::CircuitState;
pub use saved::{MOST_REVOLUTIONS, SavedState};

/// State that mechanisms may have hydraulics or integral parts of controllers.
pub fn allow_hydraulics() {
    memory::allow_hydraulics();
    state::allow_hydraulics();
}
