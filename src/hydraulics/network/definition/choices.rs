//! Choices of an element of a network by word.
//!
//! In: words of a file. Out: enumerations. It must not know laws.
use foundation::format::words;

words! {
    /// Motion of the cylinders within a step.
    pub enum Mode {
        /// The cylinders make the motion that the FMU predicts.
        Preview = "preview",
        /// The inputs `<name>.length` and `<name>.speed` prescribe the motion of the cylinders.
        Follow = "follow",
    }

    /// Lengths of a cylinder at which a valve is open.
    pub enum Opens {
        /// The valve is open while the cylinder is longer than the key `length`.
        Above = "above",
        /// The valve is open while the cylinder is shorter than the key `length`.
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
