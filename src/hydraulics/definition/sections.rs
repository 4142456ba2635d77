//! Sections of a circuit: what a file may say of oil, cylinder, valves, leakages, seals, hoses, supply and command.
//!
//! In: JSON objects. Out: one struct of numbers for each section, with its keys. It must not know what the numbers must
//! be to each other.
use super::{OilVolume, Transition};
use foundation::format::keys;
use foundation::format::{
    Range::{Finite, Length, NonNegative, Positive, Unit},
    Role::{Circuit, CircuitStart},
    number,
};
use foundation::variables::Unit::{
    CubicMetre, CubicMetrePerSecond, CubicMetrePerSecondPascal, Hertz, Metre, MetrePerSecond, Newton,
    NewtonSecondPerMetre, One, Pascal, Second, SquareMetre,
};

keys! {
    /// Oil with entrained air.
    pub struct Fluid: Copy {
        /// Ambient pressure p_0 [Pa], > 0. All other pressures are relative to the ambient pressure.
        ambient_pressure: f64 = 101_325.0 => number(Pascal, Positive).parameter(Circuit, "Ambient pressure, to which \
            all other pressures of the hydraulics are relative");
        /// Bulk modulus of the oil without air [Pa], > 0.
        bulk_modulus: f64 = 1.4e9 => number(Pascal, Positive).parameter(Circuit, "Bulk modulus of the oil without air");
        /// Volume of the entrained air at ambient pressure, divided by the volume of the oil [1], >= 0. The value 0
        /// means: no air in the oil.
        air_fraction: f64 = 0.005 => number(One, NonNegative).parameter(Circuit, "Volume of the entrained air at \
            ambient pressure, divided by the volume of the oil");
        /// Polytropic exponent n of the entrained air [1], > 0.
        polytropic_exponent: f64 = 1.4 => number(One, Positive).parameter(Circuit, "Polytropic exponent of the \
            entrained air");
    }

    /// Differential cylinder.
    pub struct Cylinder: Copy {
        /// Diameter of the piston [m], > 0.
        bore: f64 = 0.045 => number(Metre, Length).parameter(Circuit, "Diameter of the piston of the cylinder");
        /// Diameter of the piston rod [m], >= 0. The rod diameter must be smaller than the key `bore`.
        rod: f64 = 0.025 => number(Metre, NonNegative).parameter(Circuit, "Diameter of the piston rod of the cylinder");
        /// Travel of the piston between the fully retracted and the fully extended position [m], > 0.
        stroke: f64 = 0.330 => number(Metre, Length).parameter(Circuit, "Travel of the piston in the cylinder");
        /// Distance between the attachment points of the fully retracted actuator [m], >= 0.
        closed_length: f64 = 0.412 => number(Metre, NonNegative).parameter(Circuit, "Distance between the attachment \
            points of the fully retracted actuator");
        /// Bulk modulus E_cyl of the cylinder walls: pressure divided by the relative growth of the cylinder volume
        /// [Pa], >= 0. With the value 0, the cylinder walls are rigid.
        wall_modulus: f64 = 0.0 => number(Pascal, NonNegative).parameter(Circuit, "Bulk modulus of the cylinder walls: \
            pressure divided by the relative growth of the cylinder volume; the value 0 means rigid walls");
        /// Restitution at the rigid ends of the travel: speed of the piston after an impact on an end, divided by the
        /// speed before the impact [1], from 0 to 1.
        restitution: f64 = 0.0 => number(One, Unit).parameter(Circuit, "Coefficient of restitution at the rigid ends \
            of the travel");
        /// Oil volume from which the FMU calculates the elasticity of the oil in a chamber. `changes`: the present
        /// volume of the chamber, which changes with the cylinder length. `constant`: the constant volume in the key
        /// `dead_volume`.
        oil_volume: OilVolume;
    }

    /// Chamber A of the cylinder, on the piston side.
    pub struct ChamberA: Copy {
        /// Oil volume of chamber A when the cylinder is fully retracted, including the oil in the lines [m3], > 0.
        dead_volume: f64 = 6e-5 => number(CubicMetre, Positive).parameter(Circuit, "Oil volume of chamber A when the \
            cylinder is fully retracted, including the oil in the lines");
        /// Pressure in chamber A at the start [Pa]. The absolute pressure, which is the stated pressure plus
        /// `fluid.ambient_pressure`, must be above 0.
        start_pressure: f64 = 6e6 => number(Pascal, Finite).parameter(CircuitStart, "Pressure in chamber A at the \
            start, relative to the ambient pressure");
    }

    /// Chamber B of the cylinder, on the rod side.
    pub struct ChamberB: Copy {
        /// Oil volume of chamber B when the cylinder is fully extended, including the oil in the lines [m3], > 0.
        dead_volume: f64 = 6e-5 => number(CubicMetre, Positive).parameter(Circuit, "Oil volume of chamber B when the \
            cylinder is fully extended, including the oil in the lines");
        /// Pressure in chamber B at the start [Pa]. The absolute pressure, which is the stated pressure plus
        /// `fluid.ambient_pressure`, must be above 0.
        start_pressure: f64 = 11.15e6 => number(Pascal, Finite).parameter(CircuitStart, "Pressure in chamber B at the \
            start, relative to the ambient pressure");
    }

    /// Servo valve (4/3 way). The spool is a second-order system whose input is the command.
    pub struct Valve: Copy {
        /// Flow through one fully open metering edge at the pressure drop `valve.rated_pressure_drop` [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through one fully \
            open metering edge at the rated pressure drop");
        /// Rated pressure drop: the pressure drop to which all keys `rated_flow` of the circuit refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which all \
            rated flows of the circuit refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through the valve changes from laminar to turbulent");
        /// Law for the change from laminar to turbulent flow at the pressure drop `transition_pressure`. `smooth`: the
        /// flow changes smoothly. `switch`: the flow is proportional to the pressure drop below `transition_pressure`,
        /// and to the square root of the pressure drop above.
        transition: Transition;
        /// Clearance of the valve spool, relative to the full opening of a metering edge [1], > 0. The clearance
        /// smooths the opening of a metering edge. At the spool position `valve.overlap`, a metering edge is open by
        /// half of the clearance.
        clearance: f64 = 2e-3 => number(One, Positive).parameter(Circuit, "Clearance of the valve spool, relative to \
            the full opening of a metering edge; at the spool position of the parameter overlap, a metering edge is \
            open by half of the clearance");
        /// Overlap of the valve [1]: spool position, from -1 to 1, at which a metering edge starts to open. A negative
        /// overlap is an underlap.
        overlap: f64 = 0.0 => number(One, Finite).parameter(Circuit, "Overlap of the valve: spool position at which a \
            metering edge starts to open");
        /// Natural frequency of the valve spool [Hz], > 0.
        frequency: f64 = 60.0 => number(Hertz, Positive).parameter(Circuit, "Natural frequency of the valve spool");
        /// Damping ratio of the motion of the valve spool [1], > 0.
        damping_ratio: f64 = 0.8 => number(One, Positive).parameter(Circuit, "Damping ratio of the motion of the valve \
            spool");
    }

    /// Restrictor in the line of chamber A, for flow out of the chamber.
    pub struct RestrictorA: Copy {
        /// Flow out of chamber A through the restrictor, at the rated pressure drop of the valve [m3/s], >= 0. The
        /// value 0 means: no restrictor.
        rated_flow: f64 = 5e-5 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow out of chamber A \
            through its restrictor at the rated pressure drop; the value 0 means no restrictor");
    }

    /// Restrictor in the line of chamber B, for flow out of the chamber.
    pub struct RestrictorB: Copy {
        /// Flow out of chamber B through the restrictor, at the rated pressure drop of the valve [m3/s], >= 0. The
        /// value 0 means: no restrictor.
        rated_flow: f64 = 0.0 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow out of chamber B \
            through its restrictor at the rated pressure drop; the value 0 means no restrictor");
    }

    /// Check valves parallel to restrictors and cushions.
    pub struct Check: Copy {
        /// Width of the pressure range in which the check valves change smoothly from closed to open [Pa], > 0. The
        /// check valves are in parallel with the restrictors and cushions.
        pressure: f64 = 5e4 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range in which the \
            check valves at restrictors and cushions open");
    }

    /// Cushion of chamber A, at the retracted end of the travel.
    pub struct CushionA: Copy {
        /// Length of the last part of the travel, before the retracted end, in which the cushion throttles the flow out
        /// of chamber A [m], >= 0. The value 0 means: no cushion.
        length: f64 = 0.030 => number(Metre, NonNegative).parameter(Circuit, "Length of the last part of the travel in \
            which the cushion throttles the flow out of chamber A; the value 0 means no cushion");
        /// Flow out of chamber A through the cushion at the retracted end of the travel, at the rated pressure drop of
        /// the valve [m3/s], >= 0. The value 0 means: no cushion.
        rated_flow: f64 = 1.2e-5 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow out of chamber A \
            through the cushion at the end of the travel, at the rated pressure drop; the value 0 means no cushion");
    }

    /// Cushion of chamber B, at the extended end of the travel.
    pub struct CushionB: Copy {
        /// Length of the last part of the travel, before the extended end, in which the cushion throttles the flow out
        /// of chamber B [m], >= 0. The value 0 means: no cushion.
        length: f64 = 0.030 => number(Metre, NonNegative).parameter(Circuit, "Length of the last part of the travel in \
            which the cushion throttles the flow out of chamber B; the value 0 means no cushion");
        /// Flow out of chamber B through the cushion at the extended end of the travel, at the rated pressure drop of
        /// the valve [m3/s], >= 0. The value 0 means: no cushion.
        rated_flow: f64 = 1.2e-5 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow out of chamber B \
            through the cushion at the end of the travel, at the rated pressure drop; the value 0 means no cushion");
    }

    /// Relief valves from both chambers into the tank.
    pub struct Relief: Copy {
        /// Chamber pressure at which the relief valves start to open [Pa], > 0.
        pressure: f64 = 28e6 => number(Pascal, Positive).parameter(Circuit, "Chamber pressure at which the relief \
            valves start to open");
        /// Width of the pressure range in which relief and anti-cavitation valves start to open smoothly [Pa], > 0.
        width: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range over which the \
            relief and anti-cavitation valves start to open");
        /// Conductance of the relief valves: flow divided by the excess of the chamber pressure over `relief.pressure`
        /// [m3/(s.Pa)], >= 0.
        conductance: f64 = 1e-10 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of \
            the relief valves: flow divided by the excess of the chamber pressure over relief.pressure");
    }

    /// Anti-cavitation valves from the tank into both chambers.
    pub struct Anticavitation: Copy {
        /// Conductance of the anti-cavitation valves: flow divided by the difference between tank pressure and chamber
        /// pressure [m3/(s.Pa)], >= 0.
        conductance: f64 = 1e-10 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of \
            the anti-cavitation valves: flow divided by the difference between tank pressure and chamber pressure");
    }

    /// Laminar leakage of the cylinder. Each conductance is the leakage flow divided by the pressure difference.
    pub struct Leakage: Copy {
        /// Conductance of the leakage from chamber A to chamber B: flow divided by pressure drop [m3/(s.Pa)], >= 0.
        internal: f64 = 2e-13 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of the \
            leakage from chamber A to chamber B");
        /// Conductance of the leakage from chamber A to the surroundings: flow divided by the chamber pressure
        /// [m3/(s.Pa)], >= 0.
        external_a: f64 = 0.0 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of the \
            leakage from chamber A to the surroundings");
        /// Conductance of the leakage from chamber B to the surroundings: flow divided by the chamber pressure
        /// [m3/(s.Pa)], >= 0.
        external_b: f64 = 5e-14 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of \
            the leakage from chamber B to the surroundings");
    }

    /// Friction of the piston seals.
    pub struct Seal: Copy {
        /// Kinetic friction force of the seals [N], >= 0.
        coulomb: f64 = 250.0 => number(Newton, NonNegative).parameter(Circuit, "Kinetic friction force of the seals");
        /// Static friction force of the seals [N], >= 0.
        r#static as "static": f64 = 400.0 => number(Newton, NonNegative).parameter(Circuit, "Static friction force of \
            the seals");
        /// Stribeck speed: characteristic speed at which the seal friction decreases from static to kinetic friction
        /// [m/s], > 0.
        stribeck_speed: f64 = 0.02 => number(MetrePerSecond, Positive).parameter(Circuit, "Stribeck speed \
            (characteristic speed of the change from static to kinetic friction) of the seals");
        /// Characteristic speed of the smooth reversal of the seal friction force [m/s], > 0. Static and kinetic
        /// friction are multiplied by tanh(v / `transition_speed`), so that the friction force does not jump at the
        /// piston speed v = 0.
        transition_speed: f64 = 0.005 => number(MetrePerSecond, Positive).parameter(Circuit, "Characteristic speed of \
            the smooth reversal of the friction force of the seals");
        /// Viscous friction coefficient of the seals: force divided by speed [N.s/m], >= 0.
        viscous: f64 = 500.0 => number(NewtonSecondPerMetre, NonNegative).parameter(Circuit, "Viscous friction \
            coefficient of the seals");
        /// Increase of the seal friction force due to pressure, divided by the sum of both chamber pressures [m2], >=
        /// 0. With the value 0, the seal friction does not depend on pressure.
        pressure_area: f64 = 0.0 => number(SquareMetre, NonNegative).parameter(Circuit, "Increase of the seal \
            friction force due to pressure, divided by the sum of both chamber pressures");
    }

    /// Hoses of both chambers.
    pub struct Hose: Copy {
        /// Volume of the hose of chamber A [m3], >= 0. The hose volume is a part of `chamber_a.dead_volume`. The
        /// default 0 means: no hose.
        volume_a: f64 = 0.0 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the hose of chamber A, \
            part of the dead volume of chamber A; the value 0 means no hose");
        /// Volume of the hose of chamber B [m3], >= 0. The hose volume is a part of `chamber_b.dead_volume`. The
        /// default 0 means: no hose.
        volume_b: f64 = 0.0 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the hose of chamber B, \
            part of the dead volume of chamber B; the value 0 means no hose");
        /// Modulus E_hose of the hoses: pressure divided by the relative growth of the hose volume [Pa], > 0.
        modulus: f64 = 5e8 => number(Pascal, Positive).parameter(Circuit, "Modulus of the hoses: pressure divided by \
            the relative growth of the hose volume");
    }

    /// Lock valve in the line of chamber A. Oil leaves chamber A only while the pressure in chamber B exceeds
    /// `pilot_ratio` times the pressure in chamber A.
    pub struct LockValve: Copy {
        /// Pressure ratio at which the pilot opens the lock valve [1], >= 0: oil leaves chamber A only while the
        /// pressure in chamber B exceeds `pilot_ratio` times the pressure in chamber A. Data sheets usually state the
        /// reciprocal of the pressure ratio: the area of the pilot piston divided by the area of the valve seat. The
        /// value 0 means: no lock valve.
        pilot_ratio: f64 = 0.0 => number(One, NonNegative).parameter(Circuit, "Pilot pressure ratio of the lock valve: \
            the lock valve opens when the pressure in chamber B exceeds the pilot pressure ratio times the pressure in \
            chamber A; the value 0 means no lock valve");
        /// Width of the pressure range in which the lock valve changes smoothly from closed to open [Pa], > 0.
        width: f64 = 5e4 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range in which the lock \
            valve changes smoothly from closed to open");
    }

    /// Accumulator between pump and valve.
    pub struct Accumulator: Copy {
        /// Gas volume V_0 of the accumulator at the precharge pressure [m3], >= 0. The value 0 means: no accumulator;
        /// the input `supply.pressure` is the pressure at the supply port of the valve.
        volume: f64 = 0.0 => number(CubicMetre, NonNegative).parameter(Circuit, "Gas volume of the accumulator at the \
            precharge pressure; the value 0 means no accumulator");
        /// Precharge pressure [Pa]: gas pressure in the accumulator without oil. The absolute pressure, which is the
        /// stated pressure plus `fluid.ambient_pressure`, must be above 0.
        precharge_pressure: f64 = 10e6 => number(Pascal, Finite).parameter(Circuit, "Precharge pressure: gas pressure \
            in the accumulator without oil");
        /// Polytropic exponent n of the gas in the accumulator [1], > 0.
        polytropic_exponent: f64 = 1.4 => number(One, Positive).parameter(Circuit, "Polytropic exponent of the gas in \
            the accumulator");
    }

    /// Pressure-compensated pump that fills the accumulator.
    pub struct Pump: Copy {
        /// Flow of the pump at pressures up to `pump.full_pressure` [m3/s], >= 0.
        max_flow: f64 = 1.5e-4 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow of the pump at \
            pressures up to pump.full_pressure");
        /// Pressure up to which the pump delivers the flow `pump.max_flow` [Pa].
        full_pressure: f64 = 20e6 => number(Pascal, Finite).parameter(Circuit, "Pressure up to which the pump \
            delivers its full flow");
        /// Pressure at and above which the pump delivers no flow [Pa]. `pump.max_pressure` must be greater than
        /// `pump.full_pressure`.
        max_pressure: f64 = 20.7e6 => number(Pascal, Finite).parameter(Circuit, "Pressure at and above which the pump \
            delivers no flow");
    }

    /// Ramp and sine that are added to the input `valve.command`, as functions of the time since the start.
    pub struct Command: Copy {
        /// Final value of a ramp that is added to the input `valve.command` [1]. The ramp starts at the start of the
        /// run.
        ramp_amplitude: f64 = 0.0 => number(One, Finite).parameter(Circuit, "Final value of the ramp that is added to \
            valve.command from the start of the run");
        /// Duration of the ramp that is added to the input `valve.command` [s], >= 0. With the value 0, the ramp is a
        /// step at the start of the run.
        ramp_time: f64 = 0.0 => number(Second, NonNegative).parameter(Circuit, "Duration of the ramp that is added to \
            valve.command; the value 0 means a jump at the start of the run");
        /// Amplitude of a sine that is added to the input `valve.command`, from the start of the run [1].
        sine_amplitude: f64 = 0.0 => number(One, Finite).parameter(Circuit, "Amplitude of the sine that is added to \
            valve.command from the start of the run");
        /// Frequency of the sine that is added to the input `valve.command` [Hz], >= 0.
        sine_frequency: f64 = 0.0 => number(Hertz, NonNegative).parameter(Circuit, "Frequency of the sine that is \
            added to valve.command");
    }
}
