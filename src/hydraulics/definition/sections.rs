//! Sections of a circuit: what a file may say of oil, cylinder, valves, leakages, seals, hoses, supply and command.
//!
//! In: JSON objects. Out: one struct of numbers for each section, and its parameters. It must not know what the numbers
//! must be to each other.
use super::{Role, Visit};
use crate::format::{Owner, Range};
use crate::variables::Unit;
use serde::{Deserialize, Serialize};

/// Sections of the circuit: each field with its documentation, its value where the file has none, unit, range, the text
/// of its variable, and its role.
macro_rules! sections {
    ($($(#[$doc:meta])* $section:ident $name:literal {
        $($(#[$field_doc:meta])* $field:ident = $value:expr, $unit:ident, $range:ident, $role:ident, $words:literal;)*
    })*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
            #[serde(default, deny_unknown_fields)]
            pub struct $section {
                $($(#[$field_doc])* pub $field: f64,)*
            }

            impl Default for $section {
                fn default() -> Self {
                    Self { $($field: $value,)* }
                }
            }

            impl $section {
                pub(super) fn parameters(&mut self, visit: &mut Visit) {
                    let mut list = Owner::new(None, $name, Role::Law, visit);
                    $(
                        list.role = Role::$role;
                        list.add(stringify!($field).trim_start_matches("r#"), $words, Unit::$unit, Range::$range, &mut self.$field);
                    )*
                }
            }
        )*
    };
}

sections! {
    /// Oil with entrained air.
    Fluid "fluid" {
        /// Ambient pressure p_0, to which all pressures are relative [Pa], > 0.
        ambient_pressure = 101_325.0, Pascal, Positive, Law, "Ambient pressure";
        /// Bulk modulus of the oil without air [Pa], > 0.
        bulk_modulus = 1.4e9, Pascal, Positive, Law, "Bulk modulus of the oil without air";
        /// Volume of entrained air at ambient pressure per volume of oil [1], >= 0; 0: none.
        air_fraction = 0.005, One, NonNegative, Law, "Entrained air at ambient pressure per volume of oil";
        /// Polytropic exponent n of the entrained air [1], > 0.
        polytropic_exponent = 1.4, One, Positive, Law, "Polytropic exponent of the entrained air";
    }

    /// Differential cylinder.
    Cylinder "cylinder" {
        /// Diameter of the piston [m], > 0.
        bore = 0.045, Metre, Length, Law, "Diameter of the piston";
        /// Diameter of the rod [m], >= 0 and below the bore.
        rod = 0.025, Metre, NonNegative, Law, "Diameter of the rod";
        /// Travel of the piston [m], > 0.
        stroke = 0.330, Metre, Length, Law, "Travel of the piston";
        /// Length of the actuator where the piston rests at the bottom of chamber A [m], >= 0.
        closed_length = 0.412, Metre, NonNegative, Law, "Length of the actuator with the rod in";
        /// Bulk modulus E_cyl of the cylinder's walls, pressure over relative growth of the volume [Pa], >= 0; 0:
        /// rigid.
        wall_modulus = 0.0, Pascal, NonNegative, Law, "Pressure over relative growth of the cylinder, 0 for rigid";
    }

    /// Chamber A, on the side of the piston.
    ChamberA "chamber_a" {
        /// Volume with the rod in, lines included [m3], > 0.
        dead_volume = 6e-5, CubicMetre, Positive, Law, "Volume with the rod in, lines included";
        /// Pressure at the start [Pa], above -p_0.
        start_pressure = 6e6, Pascal, Finite, Start, "Pressure at the start";
    }

    /// Chamber B, on the side of the rod.
    ChamberB "chamber_b" {
        /// Volume with the rod out, lines included [m3], > 0.
        dead_volume = 6e-5, CubicMetre, Positive, Law, "Volume with the rod out, lines included";
        /// Pressure at the start [Pa], above -p_0.
        start_pressure = 11.15e6, Pascal, Finite, Start, "Pressure at the start";
    }

    /// Valve of four ports and three positions, with a spool of second order.
    Valve "valve" {
        /// Flow through one fully open edge at the rated pressure drop [m3/s], > 0.
        rated_flow = 1e-4, CubicMetrePerSecond, Positive, Law, "Flow through one open edge at the rated pressure drop";
        /// Pressure drop of an edge at all rated flows [Pa], > 0.
        rated_pressure_drop = 3.5e6, Pascal, Positive, Law, "Pressure drop of an edge at all rated flows";
        /// Pressure drop d_t between laminar and turbulent flow [Pa], > 0.
        transition_pressure = 1e5, Pascal, Positive, Law, "Pressure drop between laminar and turbulent flow";
        /// Opening by the clearance of the spool, which rounds the edges [1], > 0.
        clearance = 2e-3, One, Positive, Law, "Opening by the clearance of the spool";
        /// Spool position at which an edge opens [1]; negative: underlap.
        overlap = 0.0, One, Finite, Law, "Spool position at which an edge opens";
        /// Natural frequency of the spool [Hz], > 0.
        frequency = 60.0, Hertz, Positive, Law, "Natural frequency of the spool";
        /// Damping ratio of the spool [1], > 0.
        damping_ratio = 0.8, One, Positive, Law, "Damping ratio of the spool";
    }

    /// Restrictor in the line of chamber A, for flow out of it.
    RestrictorA "restrictor_a" {
        /// Flow at the valve's rated pressure drop [m3/s], >= 0; 0: no restrictor.
        rated_flow = 5e-5, CubicMetrePerSecond, NonNegative, Law, "Flow at the rated pressure drop, 0 for none";
    }

    /// Restrictor in the line of chamber B, for flow out of it.
    RestrictorB "restrictor_b" {
        /// Flow at the valve's rated pressure drop [m3/s], >= 0; 0: no restrictor.
        rated_flow = 0.0, CubicMetrePerSecond, NonNegative, Law, "Flow at the rated pressure drop, 0 for none";
    }

    /// Check valves beside restrictors and cushions.
    Check "check" {
        /// Pressure over which a check valve opens [Pa], > 0.
        pressure = 5e4, Pascal, Positive, Law, "Pressure over which a check valve opens";
    }

    /// Cushion at the bottom of chamber A.
    CushionA "cushion_a" {
        /// Travel over which it throttles the flow out of the chamber [m], >= 0; 0: no cushion.
        length = 0.030, Metre, NonNegative, Law, "Travel over which the cushion throttles, 0 for none";
        /// Flow at the valve's rated pressure drop at the end of the travel [m3/s], >= 0; 0: no cushion.
        rated_flow = 1.2e-5, CubicMetrePerSecond, NonNegative, Law, "Flow at the rated pressure drop, 0 for none";
    }

    /// Cushion at the end of chamber B.
    CushionB "cushion_b" {
        /// Travel over which it throttles the flow out of the chamber [m], >= 0; 0: no cushion.
        length = 0.030, Metre, NonNegative, Law, "Travel over which the cushion throttles, 0 for none";
        /// Flow at the valve's rated pressure drop at the end of the travel [m3/s], >= 0; 0: no cushion.
        rated_flow = 1.2e-5, CubicMetrePerSecond, NonNegative, Law, "Flow at the rated pressure drop, 0 for none";
    }

    /// Relief valves of both chambers, into the tank.
    Relief "relief" {
        /// Pressure at which they open [Pa], > 0.
        pressure = 28e6, Pascal, Positive, Law, "Pressure at which the relief valves open";
        /// Pressure over which relief and anti-cavitation valves open [Pa], > 0.
        width = 1e5, Pascal, Positive, Law, "Pressure over which relief and anti-cavitation valves open";
        /// Flow per pressure above the opening pressure [m3/(s Pa)], >= 0.
        conductance = 1e-10, CubicMetrePerSecondPascal, NonNegative, Law, "Conductance of the relief valves";
    }

    /// Anti-cavitation valves of both chambers, from the tank.
    Anticavitation "anticavitation" {
        /// Flow per pressure below that of the tank [m3/(s Pa)], >= 0.
        conductance = 1e-10, CubicMetrePerSecondPascal, NonNegative, Law, "Conductance of the anti-cavitation valves";
    }

    /// Leakages, laminar.
    Leakage "leakage" {
        /// From chamber A to chamber B [m3/(s Pa)], >= 0.
        internal = 2e-13, CubicMetrePerSecondPascal, NonNegative, Law, "Leakage from chamber A to chamber B";
        /// From chamber A to the surroundings [m3/(s Pa)], >= 0.
        external_a = 0.0, CubicMetrePerSecondPascal, NonNegative, Law, "Leakage of chamber A to the surroundings";
        /// From chamber B to the surroundings [m3/(s Pa)], >= 0.
        external_b = 5e-14, CubicMetrePerSecondPascal, NonNegative, Law, "Leakage of chamber B to the surroundings";
    }

    /// Friction of the seals.
    Seal "seal" {
        /// Kinetic friction [N], >= 0.
        coulomb = 250.0, Newton, NonNegative, Law, "Kinetic friction";
        /// Static friction [N], >= 0.
        r#static = 400.0, Newton, NonNegative, Law, "Static friction";
        /// Speed over which static friction falls to kinetic friction [m/s], > 0.
        stribeck_speed = 0.02, MetrePerSecond, Positive, Law, "Speed over which static falls to kinetic friction";
        /// Speed over which friction reverses [m/s], > 0.
        transition_speed = 0.005, MetrePerSecond, Positive, Law, "Speed over which friction reverses";
        /// Viscous friction [N s/m], >= 0.
        viscous = 500.0, NewtonSecondPerMetre, NonNegative, Law, "Viscous friction";
        /// Growth of the kinetic and static friction with the pressure in each chamber [m2], >= 0; 0: none.
        pressure_area = 0.0, SquareMetre, NonNegative, Law, "Growth of the friction with the pressure in each chamber";
    }

    /// Hoses of both chambers.
    Hose "hose" {
        /// Volume of the hose of chamber A, a part of its dead volume [m3], >= 0; 0: none.
        volume_a = 0.0, CubicMetre, NonNegative, Law, "Volume of the hose of chamber A, a part of its dead volume";
        /// Volume of the hose of chamber B, a part of its dead volume [m3], >= 0; 0: none.
        volume_b = 0.0, CubicMetre, NonNegative, Law, "Volume of the hose of chamber B, a part of its dead volume";
        /// Pressure over relative growth of the volume of a hose, E_hose [Pa], > 0.
        modulus = 5e8, Pascal, Positive, Law, "Pressure over relative growth of the volume of a hose";
    }

    /// Lock valve in the line of chamber A: oil leaves the chamber only while p_B > pilot ratio x p_A.
    LockValve "lock_valve" {
        /// Pilot ratio [1], >= 0; 0: no lock valve.
        pilot_ratio = 0.0, One, NonNegative, Law, "Pressure in chamber B over that in chamber A which opens, 0 for none";
        /// Pressure over which it opens [Pa], > 0.
        width = 5e4, Pascal, Positive, Law, "Pressure over which the lock valve opens";
    }

    /// Accumulator between pump and valve.
    Accumulator "accumulator" {
        /// Volume V_0 of the gas at the precharge pressure [m3], >= 0; 0: none, the supply has the pressure of the
        /// input.
        volume = 0.0, CubicMetre, NonNegative, Law, "Volume of the gas at the precharge pressure, 0 for no accumulator";
        /// Pressure of the gas without oil [Pa], above -p_0.
        precharge_pressure = 10e6, Pascal, Finite, Law, "Pressure of the gas without oil";
        /// Polytropic exponent n of the gas [1], > 0.
        polytropic_exponent = 1.4, One, Positive, Law, "Polytropic exponent of the gas";
    }

    /// Pressure-compensated pump that fills the accumulator.
    Pump "pump" {
        /// Flow up to the pressure `full_pressure` [m3/s], >= 0.
        max_flow = 1.5e-4, CubicMetrePerSecond, NonNegative, Law, "Flow at low pressure";
        /// Pressure up to which it gives all its flow [Pa].
        full_pressure = 20e6, Pascal, Finite, Law, "Pressure up to which the pump gives all its flow";
        /// Pressure from which it gives none [Pa], above `full_pressure`.
        max_pressure = 20.7e6, Pascal, Finite, Law, "Pressure from which the pump gives no flow";
    }

    /// Command of the valve as a function of time since the start, added to the input.
    Command "command" {
        /// Height of a ramp that begins at the start [1].
        ramp_amplitude = 0.0, One, Finite, Law, "Height of a ramp of the command from the start";
        /// Duration of the ramp [s], >= 0; 0: a step.
        ramp_time = 0.0, Second, NonNegative, Law, "Duration of the ramp, 0 for a step";
        /// Amplitude of a sine that begins at the start [1].
        sine_amplitude = 0.0, One, Finite, Law, "Amplitude of a sine of the command from the start";
        /// Frequency of the sine [Hz], >= 0.
        sine_frequency = 0.0, Hertz, NonNegative, Law, "Frequency of the sine";
    }
}
