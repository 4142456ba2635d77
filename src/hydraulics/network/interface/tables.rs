//! Names, texts and units of the variables that every cylinder and every network has.
//!
//! In: nothing. Out: tables; `@` in a text is the name of the cylinder. It must not know a definition.
use crate::hydraulics::network::layout::{Part, Total};
use crate::hydraulics::network::outputs::{Ahead, Output};
use crate::variables::Unit;

/// Name, text and unit of each input of a cylinder, in the order of [`Part::ALL`].
pub const PARTS: [(&str, &str, Unit); Part::ALL.len()] = [
    ("length", "Length of @ at the start of a step; within the step, the integral of @.speed is added", Unit::Metre),
    ("speed", "Speed of @, positive when extending", Unit::MetrePerSecond),
    (
        "acceleration",
        "Acceleration of @, positive when extending; needed only for time derivatives of outputs; 0: not connected, \
         and the FMU calculates the acceleration from force, load and reduced mass",
        Unit::MetrePerSecondSquared,
    ),
    (
        "reduced_mass",
        "Mass of the mechanism that @ moves, reduced to @; 0: mass not known, and no motion is predicted",
        Unit::Kilogram,
    ),
    ("reduced_mass_derivative", "Derivative of @.reduced_mass with respect to @.length", Unit::KilogramPerMetre),
    ("holding_force", "Force of @ that would hold the moved mechanism at rest, positive if @ pushes", Unit::Newton),
    (
        "holding_force_derivative",
        "Derivative of @.holding_force with respect to @.length; 0: derivative not known",
        Unit::NewtonPerMetre,
    ),
    (
        "lower_limit",
        "Smallest length of @ that the stops of the mechanism allow; the present length while a stop or lock prevents \
         retraction",
        Unit::Metre,
    ),
    (
        "upper_limit",
        "Largest length of @ that the stops of the mechanism allow; the present length while a stop or lock prevents \
         extension; if both limits are 0, the limits are not known",
        Unit::Metre,
    ),
];

/// Name, text, unit and quantity of each output of the foreseen motion of a cylinder.
pub const PREVIEW: [(&str, &str, Unit, Ahead); 7] = [
    (
        "force",
        "Predicted force of @ at the start of the next step; the force over the step is approximated by a straight \
         line in time, whose slope is @.preview.force_rate",
        Unit::Newton,
        Ahead::Force,
    ),
    (
        "force_rate",
        "Slope of the straight line in time that approximates the predicted force of @ over the next step",
        Unit::NewtonPerSecond,
        Ahead::ForceRate,
    ),
    (
        "force_mean",
        "Predicted force of @, averaged over the next step; connect this output to a force input that is constant \
         within a step",
        Unit::Newton,
        Ahead::ForceMean,
    ),
    ("length", "Predicted length of @ at the end of the next step", Unit::Metre, Ahead::Length),
    ("speed", "Predicted speed of @ at the end of the next step", Unit::MetrePerSecond, Ahead::Speed),
    (
        "start_acceleration",
        "Predicted acceleration of @ at the start of the next step",
        Unit::MetrePerSecondSquared,
        Ahead::StartAcceleration,
    ),
    (
        "acceleration",
        "Predicted acceleration of @ at the end of the next step",
        Unit::MetrePerSecondSquared,
        Ahead::Acceleration,
    ),
];

/// Name, text, unit and quantity of each output of the whole network.
pub const TOTALS: [(&str, &str, Unit, Output); 11] = [
    (
        "volume.from_reservoirs",
        "Volume of oil that has left the reservoirs since the start of the run",
        Unit::CubicMetre,
        Output::Total(Total::Reservoirs),
    ),
    (
        "volume.leaked",
        "Volume of oil lost by external leakage since the start of the run",
        Unit::CubicMetre,
        Output::Total(Total::Leaked),
    ),
    (
        "volume.compressed",
        "Volume of oil stored by compression of oil and gas and stretch of hoses and walls since the start of the run",
        Unit::CubicMetre,
        Output::Total(Total::Compressed),
    ),
    (
        "volume.balance",
        "Oil from the reservoirs minus leaked oil, minus stored oil, minus growth of the chambers: 0 except for \
         rounding",
        Unit::CubicMetre,
        Output::VolumeBalance,
    ),
    ("energy.pumps", "Work of the pumps on the oil since the start", Unit::Joule, Output::Total(Total::PumpWork)),
    (
        "energy.reservoirs",
        "Energy from the reservoirs since the start of the run",
        Unit::Joule,
        Output::Total(Total::ReservoirWork),
    ),
    (
        "energy.piston",
        "Work of the cylinder forces on the moved mechanisms since the start of the run",
        Unit::Joule,
        Output::Total(Total::PistonWork),
    ),
    (
        "energy.seal_friction",
        "Energy lost in the seal friction since the start of the run",
        Unit::Joule,
        Output::Total(Total::SealFriction),
    ),
    (
        "energy.compression",
        "Energy stored by compression of oil and gas and stretch of hoses and walls since the start of the run",
        Unit::Joule,
        Output::Total(Total::Compression),
    ),
    (
        "energy.throttling",
        "Energy lost in the valves, restrictors, lines and leakages since the start of the run",
        Unit::Joule,
        Output::Total(Total::Throttling),
    ),
    (
        "energy.balance",
        "Energy from pumps and reservoirs minus all other energies of the network: 0 except for the error of the \
         integration",
        Unit::Joule,
        Output::EnergyBalance,
    ),
];
