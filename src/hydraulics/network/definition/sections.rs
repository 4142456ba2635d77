//! Elements of a network: what a file may say of each, by name.
//!
//! In: JSON objects. Out: one struct of numbers and names for each element, with its keys. It must not know what the
//! elements must be to each other.
use crate::format::{
    Key,
    Range::{Finite, Length, NonNegative, Positive, Unit as UnitRange},
    Role::{Circuit, CircuitStart},
    keys, line, number, words,
};
use crate::hydraulics::definition::{Leakage, Seal};
use crate::variables::Unit::{
    CubicMetre, CubicMetrePerSecond, CubicMetrePerSecondPascal, Hertz, Kilogram, Metre, MetrePerSecond, Newton, One,
    Pascal,
};

keys! {
    /// Reservoir, or another port with a given pressure. Its pressure is the input `<name>.pressure`.
    pub struct Reservoir: Copy {
        /// Start value of the input `<name>.pressure` [Pa], above the negative ambient pressure.
        pressure: f64 => number(Pascal, Finite);
    }

    /// Node: a line or a gallery with a volume of oil at one pressure.
    pub struct Line: Copy {
        /// Volume of the oil [m3], > 0.
        volume: f64 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the oil").required();
        /// Pressure at the start [Pa], above the negative ambient pressure.
        start_pressure: f64 => number(Pascal, Finite).parameter(CircuitStart, "Pressure at the start");
        /// Volume of the hoses, included in the volume [m3], >= 0. 0: no hose.
        hose_volume: f64 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the hoses");
        /// Modulus E_hose of the hoses: pressure divided by the relative growth of the volume [Pa], > 0.
        hose_modulus: f64 = 5e8 => number(Pascal, Positive).parameter(Circuit, "Pressure over relative growth of the \
            hoses");
    }

    /// Pump. Its relative speed is the input `<name>.speed`, which starts at 1; 0 is off.
    pub struct Pump {
        /// Reservoir or node from which it takes oil.
        from: String => line().required();
        /// Node into which it delivers.
        to: String => line().required();
        /// Law of the flow.
        r#type as "type": PumpType;
        /// Flow at the relative speed 1, of a compensated pump at pressures up to `full_pressure` [m3/s], >= 0.
        max_flow: f64 = 1.5e-4 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow at low pressure");
        /// Pressure up to which a compensated pump delivers its full flow [Pa].
        full_pressure: f64 = 20e6 => number(Pascal, Finite).parameter(Circuit, "Pressure up to which it gives all its \
            flow");
        /// Pressure from which a compensated pump delivers no flow [Pa], above `full_pressure`.
        max_pressure: f64 = 20.7e6 => number(Pascal, Finite).parameter(Circuit, "Pressure from which it gives no flow");
    }

    /// Gas accumulator at a node.
    pub struct Accumulator {
        /// Node to which it is connected.
        at: String => line().required();
        /// Gas volume V_0 at the precharge pressure [m3], > 0.
        volume: f64 = 1e-3 => number(CubicMetre, Positive).parameter(Circuit, "Volume of the gas at the precharge \
            pressure");
        /// Precharge pressure: gas pressure without oil [Pa], above the negative ambient pressure.
        precharge_pressure: f64 = 10e6 => number(Pascal, Finite).parameter(Circuit, "Pressure of the gas without oil");
        /// Polytropic exponent n of the gas [1], > 0.
        polytropic_exponent: f64 = 1.4 => number(One, Positive).parameter(Circuit, "Polytropic exponent of the gas");
    }

    /// Restrictor, orifice or line with resistance.
    pub struct Resistance {
        /// Port at which flow in the positive direction enters.
        from: String => line().required();
        /// Port at which it leaves.
        to: String => line().required();
        /// Turbulent flow from -> to at the rated pressure drop [m3/s], >= 0. 0: closed in this direction.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow at the rated \
            pressure drop");
        /// Turbulent flow to -> from at the rated pressure drop [m3/s], >= 0. 0: closed in this direction. Without this
        /// key it is `rated_flow`.
        reverse_flow: Option<f64> => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow back at the \
            rated pressure drop");
        /// Pressure drop to which the rated flows refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop between laminar \
            and turbulent flow");
        /// Laminar flow divided by its pressure drop, in series with the turbulent one [m3/(s.Pa)], >= 0. 0: no laminar
        /// pressure drop.
        laminar_conductance: f64 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Laminar \
            conductance in series");
    }

    /// Check valve.
    pub struct Check {
        /// Port from which oil flows.
        from: String => line().required();
        /// Port to which oil flows.
        to: String => line().required();
        /// Pressure drop at which it opens [Pa], >= 0.
        cracking_pressure: f64 => number(Pascal, NonNegative).parameter(Circuit, "Pressure drop at which it opens");
        /// Width of the pressure range over which it opens smoothly [Pa], > 0.
        width: f64 = 5e4 => number(Pascal, Positive).parameter(Circuit, "Pressure over which it opens");
        /// Flow of the open valve at the rated pressure drop [m3/s], > 0. Not used where `conductance` is given.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow at the rated pressure \
            drop");
        /// Pressure drop to which the rated flow refers [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop between laminar \
            and turbulent flow");
        /// Flow divided by the pressure drop above the cracking pressure [m3/(s.Pa)], >= 0: a valve with a linear law.
        /// 0: the law of the rated flow.
        conductance: f64 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of a linear \
            valve");
    }

    /// Relief valve.
    pub struct Relief {
        /// Port that it protects.
        from: String => line().required();
        /// Port to which oil flows, mostly a reservoir.
        to: String => line().required();
        /// Pressure at `from` at which it starts to open [Pa], > 0.
        pressure: f64 = 28e6 => number(Pascal, Positive).parameter(Circuit, "Pressure at which it opens");
        /// Width of the pressure range over which it starts to open smoothly [Pa], > 0.
        width: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure over which it opens");
        /// Flow divided by the pressure above the opening pressure [m3/(s.Pa)], > 0.
        conductance: f64 = 1e-10 => number(CubicMetrePerSecondPascal, Positive).parameter(Circuit, "Flow per pressure \
            above the opening pressure");
    }

    /// Priority valve: opens while the pressure upstream is above a limit.
    pub struct Priority {
        /// Port upstream, whose pressure opens the valve.
        from: String => line().required();
        /// Port downstream.
        to: String => line().required();
        /// Pressure at `from` at which it is half open [Pa], > 0.
        pressure: f64 = 10e6 => number(Pascal, Positive).parameter(Circuit, "Pressure upstream at which it opens");
        /// Width of the pressure range over which it opens smoothly [Pa], > 0.
        width: f64 = 2e5 => number(Pascal, Positive).parameter(Circuit, "Pressure over which it opens");
        /// Flow of the open valve at the rated pressure drop [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow at the rated pressure \
            drop");
        /// Free flow back at the rated pressure drop, through a check valve in parallel [m3/s], >= 0. 0: none.
        reverse_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow back at the rated \
            pressure drop");
        /// Pressure drop to which the rated flows refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop between laminar \
            and turbulent flow");
    }

    /// Sequence valve: opens while the pressure at its pilot is above a limit.
    pub struct Sequence {
        /// Port upstream.
        from: String => line().required();
        /// Port downstream.
        to: String => line().required();
        /// Port whose pressure opens the valve.
        pilot: String => line().required();
        /// Pressure at the pilot at which it is half open [Pa], > 0.
        pressure: f64 = 10e6 => number(Pascal, Positive).parameter(Circuit, "Pressure at the pilot at which it opens");
        /// Width of the pressure range over which it opens smoothly [Pa], > 0.
        width: f64 = 2e5 => number(Pascal, Positive).parameter(Circuit, "Pressure over which it opens");
        /// Flow of the open valve at the rated pressure drop [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow at the rated pressure \
            drop");
        /// Free flow back at the rated pressure drop, through a check valve in parallel [m3/s], >= 0. 0: none.
        reverse_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow back at the rated \
            pressure drop");
        /// Pressure drop to which the rated flows refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop between laminar \
            and turbulent flow");
    }

    /// Pilot operated check valve (lock valve): oil flows back only while p_pilot > ratio * p_to.
    pub struct PilotCheck {
        /// Port from which oil flows freely.
        from: String => line().required();
        /// Port that is locked.
        to: String => line().required();
        /// Port whose pressure opens the valve for the flow back.
        pilot: String => line().required();
        /// Pressure at the pilot over the pressure at `to` that opens it [1], > 0.
        ratio: f64 = 0.3 => number(One, Positive).parameter(Circuit, "Pressure at the pilot over that at the locked \
            port that opens it");
        /// Width of the pressure range over which it opens smoothly [Pa], > 0.
        width: f64 = 5e4 => number(Pascal, Positive).parameter(Circuit, "Pressure over which it opens");
        /// Flow of the open valve at the rated pressure drop [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow at the rated pressure \
            drop");
        /// Pressure drop to which the rated flow refers [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop between laminar \
            and turbulent flow");
    }

    /// Counterbalance valve: oil flows back while p_to + ratio * p_pilot is above a limit.
    pub struct Counterbalance {
        /// Port from which oil flows freely.
        from: String => line().required();
        /// Port that carries the load.
        to: String => line().required();
        /// Port whose pressure helps to open the valve.
        pilot: String => line().required();
        /// Pilot ratio [1], > 0.
        ratio: f64 = 3.0 => number(One, Positive).parameter(Circuit, "Pilot ratio");
        /// Sum p_to + ratio * p_pilot at which the valve is half open [Pa], > 0.
        pressure: f64 = 25e6 => number(Pascal, Positive).parameter(Circuit, "Pressure at which it is half open");
        /// Width of the pressure range over which it opens smoothly [Pa], > 0.
        width: f64 = 1e6 => number(Pascal, Positive).parameter(Circuit, "Pressure over which it opens");
        /// Flow of the open valve at the rated pressure drop [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow at the rated pressure \
            drop");
        /// Pressure drop to which the rated flow refers [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop between laminar \
            and turbulent flow");
    }

    /// By-pass (dump valve). Its opening is the input `<name>.open`, from 0 to 1.
    pub struct Bypass {
        /// Port at one side.
        from: String => line().required();
        /// Port at the other side.
        to: String => line().required();
        /// Start value of the input `<name>.open` [1], 0 to 1.
        open: f64 => number(One, UnitRange);
        /// Flow of the open valve at the rated pressure drop [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow at the rated pressure \
            drop");
        /// Pressure drop to which the rated flow refers [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop between laminar \
            and turbulent flow");
    }

    /// Valve with four ports and three positions. Its command is the input `<name>.command`: positive values connect
    /// supply -> a and b -> return.
    pub struct Valve {
        /// Port from which it is supplied.
        supply: String => line().required();
        /// Port to which oil returns.
        r#return as "return": String => line().required();
        /// Working port a.
        a: String => line().required();
        /// Working port b.
        b: String => line().required();
        /// Start value of the input `<name>.command` [1], -1 to 1.
        command: f64 => number(One, Finite);
        /// Flow through one fully open metering edge at the rated pressure drop [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through one open edge \
            at the rated pressure drop");
        /// The same of the edges of port b [m3/s], > 0. Without this key it is `rated_flow`.
        rated_flow_b: Option<f64> => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through one open \
            edge of port b");
        /// The same of the edge b -> return [m3/s], > 0. Without this key it is that of the edges of port b.
        rated_flow_b_return: Option<f64> => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through the \
            open edge from b to return");
        /// The same of the edge a -> return [m3/s], > 0. Without this key it is `rated_flow`.
        rated_flow_a_return: Option<f64> => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through the \
            open edge from a to return");
        /// Pressure drop to which the rated flows refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Pressure drop d_t at which the flow changes from laminar to turbulent [Pa], > 0.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop between laminar \
            and turbulent flow");
        /// Opening at the closed edge due to the clearance of the spool, relative to the full opening [1], > 0.
        clearance: f64 = 2e-3 => number(One, Positive).parameter(Circuit, "Opening by the clearance of the spool");
        /// Overlap: spool position at which an edge opens [1]. Negative values are an underlap.
        overlap: f64 => number(One, Finite).parameter(Circuit, "Spool position at which an edge opens");
        /// Natural frequency of the spool [Hz], > 0. Without this key the spool position is the command.
        frequency: Option<f64> => number(Hertz, Positive).parameter(Circuit, "Natural frequency of the spool");
        /// Damping ratio of the spool [1], > 0.
        damping_ratio: f64 = 0.8 => number(One, Positive).parameter(Circuit, "Damping ratio of the spool");
    }

    /// Chamber of a cylinder.
    pub struct Chamber: Copy {
        /// Oil volume where the chamber is smallest, including its lines [m3], > 0.
        dead_volume: f64 = 6e-5 => number(CubicMetre, Positive).parameter(Circuit, "Least volume, lines included");
        /// Pressure at the start [Pa], above the negative ambient pressure.
        start_pressure: f64 => number(Pascal, Finite).parameter(CircuitStart, "Pressure at the start");
        /// Volume of the hose, included in the dead volume [m3], >= 0. 0: no hose.
        hose_volume: f64 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the hose");
        /// Flow out of the chamber through its restrictor at the rated pressure drop [m3/s], >= 0. 0: no restrictor.
        restrictor_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow out through the \
            restrictor");
        /// Travel over which the cushion throttles the flow out of the chamber [m], >= 0. 0: no cushion.
        cushion_length: f64 => number(Metre, NonNegative).parameter(Circuit, "Travel over which the cushion throttles");
        /// Flow out of the chamber at the end of the travel, at the rated pressure drop [m3/s], >= 0. 0: no cushion.
        cushion_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow out at the end of the \
            travel");
    }

    /// Differential cylinder. Its chambers are the ports `<name>.a`, on the piston side, and `<name>.b`, on the rod
    /// side.
    pub struct Cylinder {
        /// Diameter of the piston [m], > 0.
        bore: f64 = 0.045 => number(Metre, Length).parameter(Circuit, "Diameter of the piston");
        /// Diameter of the rod [m], >= 0 and smaller than the bore.
        rod: f64 = 0.025 => number(Metre, NonNegative).parameter(Circuit, "Diameter of the rod");
        /// Travel of the piston [m], > 0.
        stroke: f64 = 0.330 => number(Metre, Length).parameter(Circuit, "Travel of the piston");
        /// Length of the cylinder between its end points when fully retracted [m], >= 0.
        closed_length: f64 = 0.412 => number(Metre, NonNegative).parameter(Circuit, "Length with the rod in");
        /// Start value of the input `<name>.length` [m], >= 0. Without this key the cylinder starts in the middle of
        /// its travel.
        length: Option<f64> => number(Metre, NonNegative);
        /// Start value of the input `<name>.speed` [m/s].
        speed: f64 => number(MetrePerSecond, Finite);
        /// Start value of the input `<name>.reduced_mass` [kg], >= 0: what the cylinder moves where no mechanism is
        /// connected. 0: the cylinder moves by its inputs.
        reduced_mass: f64 => number(Kilogram, NonNegative);
        /// Start value of the input `<name>.holding_force` [N]: the load of that mass.
        holding_force: f64 => number(Newton, Finite);
        /// Start value of the input `<name>.lower_limit` [m], >= 0.
        lower_limit: f64 => number(Metre, NonNegative);
        /// Start value of the input `<name>.upper_limit` [m], >= 0. 0, as the lower limit: no limits.
        upper_limit: f64 => number(Metre, NonNegative);
        /// Pressure drop to which the flows of restrictors and cushions refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Rated pressure drop");
        /// Bulk modulus E_cyl of the cylinder walls: pressure divided by the relative growth of the volume [Pa], >= 0.
        /// 0: rigid walls.
        wall_modulus: f64 => number(Pascal, NonNegative).parameter(Circuit, "Pressure over relative growth, 0 for \
            rigid");
        /// Modulus E_hose of the hoses: pressure divided by the relative growth of the volume [Pa], > 0.
        hose_modulus: f64 = 5e8 => number(Pascal, Positive).parameter(Circuit, "Pressure over relative growth of the \
            hoses");
        /// Chamber A, on the piston side.
        chamber_a: Chamber;
        /// Chamber B, on the rod side.
        chamber_b: Chamber;
        /// Laminar leakage. Without this key there is none.
        leakage: Option<Leakage>;
        /// Friction of the seals. Without this key there is none.
        seal: Option<Seal>;
    }

    /// Lock that pressure releases. The output `<name>.engaged` is true while the pressure is below the release
    /// pressure.
    pub struct PressureLock {
        /// Node or chamber whose pressure releases the lock.
        at: String => line().required();
        /// Pressure at which the lock releases [Pa], > 0.
        release_pressure: f64 = 5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure at which it releases");
        /// Difference between the pressures of release and engagement [Pa], >= 0: it engages below release_pressure -
        /// hysteresis.
        hysteresis: f64 = 1e6 => number(Pascal, NonNegative).parameter(Circuit, "Pressure between release and \
            engagement");
    }
}

keys! {
    /// Coupling with the mechanisms that the cylinders drive.
    pub struct Coupling: Copy {
        /// How a step uses the predicted motion; start value of the variable `coupling.mode`.
        mode: Mode => Key::PLAIN.parameter(Circuit, "");
    }
}

words! {
    /// How a step uses the predicted motion.
    pub enum Mode {
        /// The step uses the predicted motion; the host makes each step once.
        Preview = "preview",
        /// The step uses the motion at the inputs; the host makes each step twice, or does not iterate.
        Follow = "follow",
    }

    /// Law of the flow of a pump.
    pub enum PumpType {
        /// Pressure-compensated: the flow falls to 0 between `full_pressure` and `max_pressure`.
        Compensated = "compensated",
        /// Fixed displacement: the flow does not depend on pressures.
        Fixed = "fixed",
    }
}
