//! Choices of an element of a network by word.
//!
//! In: words of a file. Out: enumerations. It must not know laws.
use crate::format::words;

words! {
    /// Motion of the cylinders within a step.
    pub enum Mode {
        /// The cylinders move as predicted.
        Preview = "preview",
        /// The cylinders move as the inputs state.
        Follow = "follow",
    }

    /// Lengths of a cylinder at which a valve is open.
    pub enum Opens {
        /// Lengths above `length`.
        Above = "above",
        /// Lengths below `length`.
        Below = "below",
    }

    /// Law of the flow of a pump.
    pub enum PumpType {
        /// Pressure-compensated: the flow falls to 0 between `full_pressure` and `max_pressure`.
        Compensated = "compensated",
        /// Fixed displacement: the flow does not depend on pressures.
        Fixed = "fixed",
    }
}
