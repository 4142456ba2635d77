//! Sections of a circuit: what a file may say of oil, cylinder, valves, leakages, seals, hoses, supply and command.
//!
//! In: JSON objects. Out: one struct of numbers for each section, with its keys. It must not know what the numbers must
//! be to each other.
use crate::format::keys;
use crate::format::{
    Range::{Finite, Length, NonNegative, Positive},
    Role::{Circuit, CircuitStart},
    number,
};
use crate::variables::Unit::{
    CubicMetre, CubicMetrePerSecond, CubicMetrePerSecondPascal, Hertz, Metre, MetrePerSecond, Newton,
    NewtonSecondPerMetre, One, Pascal, Second, SquareMetre,
};

keys! {
    /// Oil with entrained air.
    pub struct Fluid: Copy {
        /// Ambient pressure p_0, to which all pressures are relative [Pa], > 0.
        ambient_pressure: f64 = 101_325.0 => number(Pascal, Positive).parameter(Circuit, "Ambient pressure");
        /// Bulk modulus of the oil without air [Pa], > 0.
        bulk_modulus: f64 = 1.4e9 => number(Pascal, Positive).parameter(Circuit, "Bulk modulus of the oil without air");
        /// Entrained air: its volume at ambient pressure divided by the volume of oil [1], >= 0. 0: no air.
        air_fraction: f64 = 0.005 => number(One, NonNegative).parameter(Circuit, "Volume of entrained air at \
            ambient pressure, relative to the oil volume");
        /// Polytropic exponent n of the entrained air [1], > 0.
        polytropic_exponent: f64 = 1.4 => number(One, Positive).parameter(Circuit, "Polytropic exponent of the \
            entrained air");
    }

    /// Differential cylinder.
    pub struct Cylinder: Copy {
        /// Diameter of the piston [m], > 0.
        bore: f64 = 0.045 => number(Metre, Length).parameter(Circuit, "Diameter of the piston");
        /// Diameter of the rod [m], >= 0 and smaller than the bore.
        rod: f64 = 0.025 => number(Metre, NonNegative).parameter(Circuit, "Diameter of the rod");
        /// Travel of the piston [m], > 0.
        stroke: f64 = 0.330 => number(Metre, Length).parameter(Circuit, "Travel of the piston");
        /// Length of the actuator between its end points when fully retracted [m], >= 0.
        closed_length: f64 = 0.412 => number(Metre, NonNegative).parameter(Circuit, "Length of the actuator with the \
            rod in");
        /// Bulk modulus E_cyl of the cylinder walls: pressure divided by the relative growth of the volume [Pa], >= 0.
        /// 0: rigid walls.
        wall_modulus: f64 = 0.0 => number(Pascal, NonNegative).parameter(Circuit, "Pressure per relative volume \
            growth of the cylinder, 0 for a rigid cylinder");
    }

    /// Chamber A, on the piston side.
    pub struct ChamberA: Copy {
        /// Oil volume when fully retracted, including the lines [m3], > 0.
        dead_volume: f64 = 6e-5 => number(CubicMetre, Positive).parameter(Circuit, "Volume with the rod retracted, \
            lines included");
        /// Pressure at the start [Pa], above the negative ambient pressure.
        start_pressure: f64 = 6e6 => number(Pascal, Finite).parameter(CircuitStart, "Pressure at the start");
    }

    /// Chamber B, on the rod side.
    pub struct ChamberB: Copy {
        /// Oil volume when fully extended, including the lines [m3], > 0.
        dead_volume: f64 = 6e-5 => number(CubicMetre, Positive).parameter(Circuit, "Volume with the rod extended, \
            lines included");
        /// Pressure at the start [Pa], above the negative ambient pressure.
        start_pressure: f64 = 11.15e6 => number(Pascal, Finite).parameter(CircuitStart, "Pressure at the start");
    }

    /// Servo valve (4/3 way). Its spool follows the command as a second-order system.
    pub struct Valve: Copy {
        /// Flow through one fully open metering edge at the rated pressure drop [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through one fully \
            open edge at the rated pressure drop");
        /// Pressure drop to which all rated flows refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop of one edge \
            at all rated flows");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the \
            flow changes from laminar to turbulent");
        /// Opening at the closed edge due to the clearance of the spool, relative to the full opening [1], > 0. It
        /// smooths the opening curve.
        clearance: f64 = 2e-3 => number(One, Positive).parameter(Circuit, "Opening due to the clearance of the spool, \
            which rounds the edges");
        /// Overlap: spool position at which an edge opens [1]. Negative values are an underlap.
        overlap: f64 = 0.0 => number(One, Finite).parameter(Circuit, "Spool position at which an edge starts to open");
        /// Natural frequency of the spool [Hz], > 0.
        frequency: f64 = 60.0 => number(Hertz, Positive).parameter(Circuit, "Natural frequency of the spool");
        /// Damping ratio of the spool [1], > 0.
        damping_ratio: f64 = 0.8 => number(One, Positive).parameter(Circuit, "Damping ratio of the spool");
    }

    /// Restrictor in the line of chamber A, for flow out of the chamber.
    pub struct RestrictorA: Copy {
        /// Flow at the rated pressure drop of the valve [m3/s], >= 0. 0: no restrictor.
        rated_flow: f64 = 5e-5 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow at the rated \
            pressure drop, 0 for no restrictor");
    }

    /// Restrictor in the line of chamber B, for flow out of the chamber.
    pub struct RestrictorB: Copy {
        /// Flow at the rated pressure drop of the valve [m3/s], >= 0. 0: no restrictor.
        rated_flow: f64 = 0.0 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow at the rated \
            pressure drop, 0 for no restrictor");
    }

    /// Check valves parallel to restrictors and cushions.
    pub struct Check: Copy {
        /// Width of the pressure range in which a check valve changes smoothly from closed to open [Pa], > 0.
        pressure: f64 = 5e4 => number(Pascal, Positive).parameter(Circuit, "Pressure range over which a check valve \
            opens");
    }

    /// Cushion of chamber A, at the retracted end of the travel.
    pub struct CushionA: Copy {
        /// Travel over which the cushion throttles the flow out of the chamber [m], >= 0. 0: no cushion.
        length: f64 = 0.030 => number(Metre, NonNegative).parameter(Circuit, "Travel over which the cushion \
            throttles, 0 for no cushion");
        /// Flow at the end of the travel, at the rated pressure drop of the valve [m3/s], >= 0. 0: no cushion.
        rated_flow: f64 = 1.2e-5 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow at the rated \
            pressure drop, 0 for no cushion");
    }

    /// Cushion of chamber B, at the extended end of the travel.
    pub struct CushionB: Copy {
        /// Travel over which the cushion throttles the flow out of the chamber [m], >= 0. 0: no cushion.
        length: f64 = 0.030 => number(Metre, NonNegative).parameter(Circuit, "Travel over which the cushion \
            throttles, 0 for no cushion");
        /// Flow at the end of the travel, at the rated pressure drop of the valve [m3/s], >= 0. 0: no cushion.
        rated_flow: f64 = 1.2e-5 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow at the rated \
            pressure drop, 0 for no cushion");
    }

    /// Relief valves from both chambers into the tank.
    pub struct Relief: Copy {
        /// Pressure at which the relief valves start to open [Pa], > 0.
        pressure: f64 = 28e6 => number(Pascal, Positive).parameter(Circuit, "Pressure at which the relief valves open");
        /// Width of the pressure range in which relief and anti-cavitation valves start to open smoothly [Pa], > 0.
        width: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure range over which the relief and \
            anti-cavitation valves open");
        /// Flow divided by the pressure above the opening pressure [m3/(s.Pa)], >= 0.
        conductance: f64 = 1e-10 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of \
            the relief valves");
    }

    /// Anti-cavitation valves from the tank into both chambers.
    pub struct Anticavitation: Copy {
        /// Flow divided by the pressure below the tank pressure [m3/(s.Pa)], >= 0.
        conductance: f64 = 1e-10 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of \
            the anti-cavitation valves");
    }

    /// Laminar leakage: flow divided by pressure difference.
    pub struct Leakage: Copy {
        /// Leakage from chamber A to chamber B [m3/(s.Pa)], >= 0.
        internal: f64 = 2e-13 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Leakage from \
            chamber A to chamber B");
        /// Leakage from chamber A to the surroundings [m3/(s.Pa)], >= 0.
        external_a: f64 = 0.0 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Leakage of chamber \
            A to the surroundings");
        /// Leakage from chamber B to the surroundings [m3/(s.Pa)], >= 0.
        external_b: f64 = 5e-14 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Leakage of \
            chamber B to the surroundings");
    }

    /// Friction of the seals.
    pub struct Seal: Copy {
        /// Kinetic friction force [N], >= 0.
        coulomb: f64 = 250.0 => number(Newton, NonNegative).parameter(Circuit, "Kinetic friction");
        /// Static friction force [N], >= 0.
        r#static as "static": f64 = 400.0 => number(Newton, NonNegative).parameter(Circuit, "Static friction");
        /// Stribeck speed: characteristic speed at which friction falls from static to kinetic [m/s], > 0.
        stribeck_speed: f64 = 0.02 => number(MetrePerSecond, Positive).parameter(Circuit, "Speed over which static \
            friction falls to kinetic friction");
        /// Speed up to which friction rises smoothly through rest [m/s], > 0.
        transition_speed: f64 = 0.005 => number(MetrePerSecond, Positive).parameter(Circuit, "Speed over which the \
            friction reverses its direction");
        /// Viscous friction coefficient [N.s/m], >= 0.
        viscous: f64 = 500.0 => number(NewtonSecondPerMetre, NonNegative).parameter(Circuit, "Viscous friction");
        /// Increase of kinetic and static friction with the pressure in each chamber [m2], >= 0. 0: friction
        /// does not depend on pressure.
        pressure_area: f64 = 0.0 => number(SquareMetre, NonNegative).parameter(Circuit, "Increase of the friction \
            per chamber pressure");
    }

    /// Hoses of both chambers.
    pub struct Hose: Copy {
        /// Volume of the hose of chamber A, included in its dead volume [m3], >= 0. 0: no hose.
        volume_a: f64 = 0.0 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the hose of chamber A, \
            part of its dead volume");
        /// Volume of the hose of chamber B, included in its dead volume [m3], >= 0. 0: no hose.
        volume_b: f64 = 0.0 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the hose of chamber B, \
            part of its dead volume");
        /// Modulus E_hose of the hoses: pressure divided by the relative growth of the volume [Pa], > 0.
        modulus: f64 = 5e8 => number(Pascal, Positive).parameter(Circuit, "Pressure per relative growth of the hose \
            volume");
    }

    /// Lock valve in the line of chamber A. Oil leaves the chamber only while p_B > pilot_ratio * p_A.
    pub struct LockValve: Copy {
        /// Pilot ratio [1], >= 0. 0: no lock valve.
        pilot_ratio: f64 = 0.0 => number(One, NonNegative).parameter(Circuit, "Pressure in chamber B, relative to \
            that in chamber A, that opens the lock valve; 0 for no lock valve");
        /// Width of the pressure range in which the lock valve changes smoothly from closed to open [Pa], > 0.
        width: f64 = 5e4 => number(Pascal, Positive).parameter(Circuit, "Pressure range over which the lock valve \
            opens");
    }

    /// Accumulator between pump and valve.
    pub struct Accumulator: Copy {
        /// Gas volume V_0 at the precharge pressure [m3], >= 0. 0: no accumulator; the supply pressure is then the
        /// input.
        volume: f64 = 0.0 => number(CubicMetre, NonNegative).parameter(Circuit, "Gas volume at the precharge \
            pressure, 0 for no accumulator");
        /// Precharge pressure: gas pressure without oil [Pa], above the negative ambient pressure.
        precharge_pressure: f64 = 10e6 => number(Pascal, Finite).parameter(Circuit, "Gas pressure without oil in \
            the accumulator");
        /// Polytropic exponent n of the gas [1], > 0.
        polytropic_exponent: f64 = 1.4 => number(One, Positive).parameter(Circuit, "Polytropic exponent of the gas");
    }

    /// Pressure-compensated pump that fills the accumulator.
    pub struct Pump: Copy {
        /// Flow at pressures up to `full_pressure` [m3/s], >= 0.
        max_flow: f64 = 1.5e-4 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow at low pressure");
        /// Pressure up to which the pump delivers its full flow [Pa].
        full_pressure: f64 = 20e6 => number(Pascal, Finite).parameter(Circuit, "Pressure up to which the pump \
            delivers its full flow");
        /// Pressure from which the pump delivers no flow [Pa], above `full_pressure`.
        max_pressure: f64 = 20.7e6 => number(Pascal, Finite).parameter(Circuit, "Pressure above which the pump \
            delivers no flow");
    }

    /// Command of the valve as a function of time since the start, added to the input.
    pub struct Command: Copy {
        /// Height of a ramp from the start [1].
        ramp_amplitude: f64 = 0.0 => number(One, Finite).parameter(Circuit, "Height of the ramp that is added to \
            the command from the start");
        /// Duration of the ramp [s], >= 0; 0: a step.
        ramp_time: f64 = 0.0 => number(Second, NonNegative).parameter(Circuit, "Duration of the ramp, 0 for a step");
        /// Amplitude of a sine from the start [1].
        sine_amplitude: f64 = 0.0 => number(One, Finite).parameter(Circuit, "Amplitude of the sine that is added to \
            the command from the start");
        /// Frequency of the sine [Hz], >= 0.
        sine_frequency: f64 = 0.0 => number(Hertz, NonNegative).parameter(Circuit, "Frequency of the sine");
    }
}
