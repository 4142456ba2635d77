//! Names, texts and units of the variables that every cylinder and every network has.
//!
//! In: nothing. Out: tables; `@` in a text is the name of the cylinder. It must not know a definition.
use crate::network::layout::{Part, Total};
use crate::network::outputs::{Ahead, Output};
use foundation::variables::Unit;

/// Name, text and unit of each input of a cylinder, in the order of [`Part::ALL`].
pub const PARTS: [(&str, &str, Unit); Part::ALL.len()] = [
    (
        "length",
        "Length of @ at the start of a step; within the step, the FMU adds the integral of the input speed to \
        this length",
        Unit::Metre,
    ),
    ("speed", "Speed of @, positive when extending", Unit::MetrePerSecond),
    (
        "acceleration",
        "Acceleration of @, positive when extending; needed only for time derivatives of outputs; the value 0 means \
            that the input is not connected: the FMU then calculates the acceleration from force, load and reduced \
            mass",
        Unit::MetrePerSecondSquared,
    ),
    (
        "reduced_mass",
        "Mass of the mechanism that @ moves, reduced to @; the value 0 means that the mass is not known: the FMU then \
            predicts no motion",
        Unit::Kilogram,
    ),
    (
        "reduced_mass_derivative",
        "Derivative of the input reduced_mass with respect to the length of @",
        Unit::KilogramPerMetre,
    ),
    ("holding_force", "Force of @ that would hold the moved mechanism at rest, positive if @ pushes", Unit::Newton),
    (
        "holding_force_derivative",
        "Derivative of the input holding_force with respect to the length of @; the value 0 means that the derivative \
            is not known",
        Unit::NewtonPerMetre,
    ),
    (
        "lower_limit",
        "Smallest length of @ that the stops of the mechanism allow; while a stop or lock prevents retraction, the \
            limit is the present length",
        Unit::Metre,
    ),
    (
        "upper_limit",
        "Largest length of @ that the stops of the mechanism allow; while a stop or lock prevents extension, the limit \
            is the present length; if both limits are 0, the limits are not known",
        Unit::Metre,
    ),
];

/// Name, text, unit and quantity of each output of the foreseen motion of a cylinder.
pub const PREVIEW: [(&str, &str, Unit, Ahead); 7] = [
    (
        "force",
        "Predicted force of @ at the start of the next step; the predicted force changes linearly over the step, at \
            the rate preview.force_rate",
        Unit::Newton,
        Ahead::Force,
    ),
    (
        "force_rate",
        "Rate of change of the predicted force of @ over the next step",
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
        "Volume of oil that the network has stored since the start of the run, because oil and gas are compressed and \
            hoses and walls stretch",
        Unit::CubicMetre,
        Output::Total(Total::Compressed),
    ),
    (
        "volume.balance",
        "Volume balance of the network: oil from the reservoirs minus leaked oil, minus stored oil, minus growth of \
            the cylinder chambers, 0 except for rounding",
        Unit::CubicMetre,
        Output::VolumeBalance,
    ),
    (
        "energy.pumps",
        "Work of the pumps on the oil since the start of the run",
        Unit::Joule,
        Output::Total(Total::PumpWork),
    ),
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
        "Energy lost in the friction of the piston seals since the start of the run",
        Unit::Joule,
        Output::Total(Total::SealFriction),
    ),
    (
        "energy.compression",
        "Energy that the network has stored since the start of the run, because oil and gas are compressed and hoses \
            and walls stretch",
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
        "Energy balance of the network: energy from pumps and reservoirs minus all other energies, 0 except for the \
            error of the integration",
        Unit::Joule,
        Output::EnergyBalance,
    ),
];
