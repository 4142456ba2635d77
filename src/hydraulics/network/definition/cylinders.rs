//! Cylinders of a network, with their chambers, the locks that pressure releases, and the coupling with mechanisms.
//!
//! In: JSON objects. Out: one struct of numbers and names for each element, with its keys. It must not know what the
//! elements must be to each other.
use super::choices::Mode;
use crate::definition::{Leakage, OilVolume, Seal};
use foundation::format::{
    Key,
    Range::{Finite, Length, NonNegative, Positive, Unit as UnitRange},
    Role::{Circuit, CircuitStart},
    keys, line, number,
};
use foundation::variables::Unit::{
    CubicMetre, CubicMetrePerSecond, Kilogram, Metre, MetrePerSecond, Newton, One, Pascal,
};

keys! {
    /// A cylinder has two chambers, A (piston side) and B (rod side).
    pub struct Chamber: Copy {
        /// Smallest oil volume of the chamber, including the oil in the lines [m3], > 0. The volume of chamber A is
        /// smallest when the cylinder is fully retracted, and the volume of chamber B when the cylinder is fully
        /// extended.
        dead_volume: f64 = 6e-5 => number(CubicMetre, Positive).parameter(Circuit, "Smallest oil volume of the chamber \
            @, including the oil in the lines");
        /// Pressure at the start of the run [Pa]. The absolute pressure, which is the stated pressure plus
        /// `fluid.ambient_pressure`, must be above 0.
        start_pressure: f64 => number(Pascal, Finite).parameter(CircuitStart, "Pressure in the chamber @ at the start, \
            relative to the ambient pressure");
        /// Volume of the hose that is connected to the chamber [m3], >= 0. The hose volume is a part of the oil volume
        /// in the key `dead_volume`. The default 0 means: no hose.
        hose_volume: f64 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the hose of the chamber @, \
            part of the dead volume; the value 0 means no hose");
        /// Flow out of the chamber through its restrictor at the rated pressure drop [m3/s], >= 0. The value 0 means:
        /// no restrictor.
        restrictor_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow out of the chamber @ \
            through the restrictor at the rated pressure drop; the value 0 means no restrictor");
        /// Length of the last part of the travel in which the cushion throttles the flow out of the chamber [m], >= 0.
        /// The value 0 means: no cushion.
        cushion_length: f64 => number(Metre, NonNegative).parameter(Circuit, "Length of the last part of the travel in \
            which the cushion throttles the flow out of the chamber @; the value 0 means no cushion");
        /// Flow out of the chamber through the cushion at the end of the travel, at the rated pressure drop [m3/s], >=
        /// 0. The value 0 means: no cushion.
        cushion_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow out of the chamber @ \
            through the cushion at the end of the travel, at the rated pressure drop; the value 0 means no cushion");
    }

    /// A differential cylinder has two ports: the chamber `<name>.a` on the piston side, and the chamber `<name>.b` on
    /// the rod side.
    pub struct Cylinder {
        /// Diameter of the piston [m], > 0.
        bore: f64 = 0.045 => number(Metre, Length).parameter(Circuit, "Diameter of the piston");
        /// Diameter of the piston rod [m], >= 0. The rod diameter must be smaller than the key `bore`.
        rod: f64 = 0.025 => number(Metre, NonNegative).parameter(Circuit, "Diameter of the rod");
        /// Travel of the piston between the fully retracted and the fully extended position [m], > 0.
        stroke: f64 = 0.330 => number(Metre, Length).parameter(Circuit, "Travel of the piston");
        /// Distance between the attachment points of the fully retracted cylinder [m], >= 0.
        closed_length: f64 = 0.412 => number(Metre, NonNegative).parameter(Circuit, "Distance between the attachment \
            points of @ when fully retracted");
        /// Coefficient of restitution at the rigid ends of the travel [1], from 0 to 1: piston speed after an impact,
        /// divided by the piston speed before the impact. With the value 0, the piston does not rebound.
        restitution: f64 => number(One, UnitRange).brief().parameter(Circuit, "Coefficient of restitution at the \
            rigid ends of the travel of @");
        /// Start value of the input `<name>.length`, the distance between the two attachment points of the cylinder
        /// [m], >= 0. Without the key `length`, the cylinder starts in the middle of the travel.
        length: Option<f64> => number(Metre, NonNegative);
        /// Start value of the input `<name>.speed`, positive if the cylinder extends [m/s].
        speed: f64 => number(MetrePerSecond, Finite);
        /// Start value of the input `<name>.reduced_mass` [kg], >= 0: the mass that the cylinder moves if no mechanism
        /// is connected. With the value 0, the inputs `<name>.length` and `<name>.speed` prescribe the motion of the
        /// cylinder.
        reduced_mass: f64 => number(Kilogram, NonNegative);
        /// Start value of the input `<name>.holding_force` [N]: the load on the mass `reduced_mass`, positive if the
        /// cylinder must push against the load.
        holding_force: f64 => number(Newton, Finite);
        /// Start value of the input `<name>.lower_limit` [m], >= 0: smallest cylinder length that the stops of the
        /// mechanism allow.
        lower_limit: f64 => number(Metre, NonNegative);
        /// Start value of the input `<name>.upper_limit` [m], >= 0: largest cylinder length that the stops of the
        /// mechanism allow. If `lower_limit` and `upper_limit` are both 0, no stop limits the cylinder length.
        upper_limit: f64 => number(Metre, NonNegative);
        /// Rated pressure drop: the pressure drop to which the rated flows of restrictors and cushions of the cylinder
        /// refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Bulk modulus E_cyl of the cylinder walls: pressure divided by the relative growth of the cylinder volume
        /// [Pa], >= 0. With the value 0, the cylinder walls are rigid.
        wall_modulus: f64 => number(Pascal, NonNegative).parameter(Circuit, "Bulk modulus of the cylinder walls of @; \
            the value 0 means rigid walls");
        /// Modulus E_hose of the hoses: pressure divided by the relative growth of the hose volume [Pa], > 0.
        hose_modulus: f64 = 5e8 => number(Pascal, Positive).parameter(Circuit, "Modulus of the hoses of @: pressure \
            divided by the relative growth of the hose volume");
        /// Oil volume from which the FMU calculates the elasticity of the oil in a chamber. `changes`: the present
        /// volume of the chamber, which changes with the cylinder length. `constant`: the constant volume in the key
        /// `dead_volume`.
        oil_volume: OilVolume;
        /// Chamber A of the cylinder, on the piston side.
        chamber_a: Chamber;
        /// Chamber B of the cylinder, on the rod side.
        chamber_b: Chamber;
        /// Laminar leakage of the chambers. Without the key `leakage`, the cylinder has no leakage.
        leakage: Option<Leakage>;
        /// Friction of the piston seals. Without the key `seal`, the cylinder has no seal friction.
        seal: Option<Seal>;
    }

    /// A pressure lock is a lock that oil pressure releases, such as an uplock. The output `<name>.engaged` is true
    /// while the lock is engaged.
    pub struct PressureLock {
        /// Node or chamber whose pressure releases the lock.
        at: String => line().required();
        /// Pressure at the port `at` at which the lock is released [Pa], > 0.
        release_pressure: f64 = 5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure at which @ is released");
        /// Hysteresis [Pa], >= 0: the lock engages again when the pressure at the port `at` falls below
        /// `release_pressure` - `hysteresis`.
        hysteresis: f64 = 1e6 => number(Pascal, NonNegative).parameter(Circuit, "Hysteresis of @: release pressure \
            minus the pressure at which the lock engages again");
    }
}

keys! {
    /// Settings of the coupling between the hydraulic FMU and the mechanisms that its cylinders drive.
    pub struct Coupling: Copy {
        /// Start value of the parameter `coupling.mode`. The parameter `coupling.mode` selects the motion of the
        /// cylinders within a communication step. `preview`: the FMU predicts the motion. `follow`: the inputs
        /// `<name>.length` and `<name>.speed` prescribe the motion.
        mode: Mode => Key::PLAIN.parameter(Circuit, "");
    }
}
