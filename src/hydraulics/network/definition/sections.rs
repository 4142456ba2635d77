//! Elements of a network that store oil or let it flow: reservoirs, nodes, pumps, accumulators, restrictors, valves.
//!
//! In: JSON objects. Out: one struct of numbers and names for each element, with its keys. It must not know what the
//! elements must be to each other.
use super::choices::{Opens, PumpType};
use crate::definition::Transition;
use foundation::format::{
    Range::{Finite, NonNegative, Positive, Unit as UnitRange},
    Role::{Circuit, CircuitStart},
    keys, line, number,
};
use foundation::variables::Unit::{
    CubicMetre, CubicMetrePerSecond, CubicMetrePerSecondPascal, Hertz, Metre, One, Pascal,
};

keys! {
    /// A reservoir is a port whose pressure is the input `<name>.pressure`.
    pub struct Reservoir: Copy {
        /// Start value of the input `<name>.pressure`, which is the pressure of the reservoir [Pa]. The absolute
        /// pressure, which is the stated pressure plus `fluid.ambient_pressure`, must be above 0.
        pressure: f64 => number(Pascal, Finite);
    }

    /// A node is a line or a gallery with a volume of oil at one pressure.
    pub struct Line: Copy {
        /// Volume of the oil at the node [m3], > 0. A node with the volume 0 is an error.
        volume: f64 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the oil in @").required();
        /// Pressure at the start of the run [Pa]. The absolute pressure, which is the stated pressure plus
        /// `fluid.ambient_pressure`, must be above 0.
        start_pressure: f64 => number(Pascal, Finite).parameter(CircuitStart, "Pressure in @ at the start, relative to \
            the ambient pressure");
        /// Volume of the hoses at the node [m3], >= 0. The hose volume is a part of the oil volume in the key `volume`.
        /// The default 0 means: no hose.
        hose_volume: f64 => number(CubicMetre, NonNegative).parameter(Circuit, "Volume of the hoses in @, part of the \
            oil volume");
        /// Modulus E_hose of the hoses: pressure divided by the relative growth of the hose volume [Pa], > 0.
        hose_modulus: f64 = 5e8 => number(Pascal, Positive).parameter(Circuit, "Modulus of the hoses of @: pressure \
            divided by the relative growth of the hose volume");
    }

    /// A pump delivers oil from the port `from` to the node `to`. The input `<name>.speed` is the relative speed of the
    /// pump: 1 is the full speed, and 0 is off. The start value of `<name>.speed` is 1.
    pub struct Pump {
        /// Reservoir or node from which the pump takes oil.
        from: String => line().required();
        /// Node into which the pump delivers oil.
        to: String => line().required();
        /// Type of the pump. `compensated`: the pump flow falls from the full flow to 0 between the pressures
        /// `full_pressure` and `max_pressure`. `fixed`: the pump flow does not depend on the pressure.
        r#type as "type": PumpType;
        /// Full flow [m3/s], >= 0: flow of the pump at the relative speed 1. A compensated pump delivers the full flow
        /// at pressures up to `full_pressure`.
        max_flow: f64 = 1.5e-4 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow of @ at the \
            relative speed 1 and low pressure");
        /// Pressure up to which a compensated pump delivers its full flow [Pa].
        full_pressure: f64 = 20e6 => number(Pascal, Finite).parameter(Circuit, "Pressure up to which @ delivers its \
            full flow");
        /// Pressure at and above which a compensated pump delivers 1 % of its full flow or less [Pa]. The key
        /// `max_pressure` must be greater than `full_pressure`.
        max_pressure: f64 = 20.7e6 => number(Pascal, Finite).parameter(Circuit, "Pressure at and above which @ \
            delivers 1 % of its full flow or less");
    }

    /// A gas accumulator stores oil under gas pressure. Each gas accumulator is connected to a node.
    pub struct Accumulator {
        /// Node to which the accumulator is connected.
        at: String => line().required();
        /// Gas volume V_0 of the accumulator at the precharge pressure [m3], > 0.
        volume: f64 = 1e-3 => number(CubicMetre, Positive).parameter(Circuit, "Gas volume of @ at the precharge \
            pressure");
        /// Precharge pressure [Pa]: gas pressure in the accumulator without oil. The absolute pressure, which is the
        /// stated pressure plus `fluid.ambient_pressure`, must be above 0.
        precharge_pressure: f64 = 10e6 => number(Pascal, Finite).parameter(Circuit, "Precharge pressure of @: gas \
            pressure in the accumulator without oil");
        /// Polytropic exponent n of the gas in the accumulator [1], > 0.
        polytropic_exponent: f64 = 1.4 => number(One, Positive).parameter(Circuit, "Polytropic exponent of the gas in \
            @");
    }

    /// A hydraulic resistance is a restrictor, an orifice or a line with flow resistance between two ports.
    pub struct Resistance {
        /// Port at which a positive flow enters the resistance.
        from: String => line().required();
        /// Port at which a positive flow leaves the resistance.
        to: String => line().required();
        /// Turbulent flow from port `from` to port `to` at the rated pressure drop [m3/s], >= 0. With the value 0, no
        /// oil flows from `from` to `to`.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow through @ at the \
            rated pressure drop");
        /// Turbulent flow from port `to` to port `from` at the rated pressure drop [m3/s], >= 0. With the value 0, no
        /// oil flows from `to` to `from`. The default is the value of `rated_flow`.
        reverse_flow: Option<f64> => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow through @ in \
            the reverse direction (from port `to` to port `from`), at the rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the rated flows of the element refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
        /// Conductance of a laminar resistance in series with the orifice: flow divided by pressure drop [m3/(s.Pa)],
        /// >= 0. The value 0 means that there is no laminar resistance.
        laminar_conductance: f64 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of \
            the laminar resistance in @; the value 0 means no laminar pressure drop");
    }

    /// A check valve lets oil flow only from port `from` to port `to`.
    pub struct Check {
        /// Inlet port of the check valve.
        from: String => line().required();
        /// Outlet port of the check valve.
        to: String => line().required();
        /// Pressure drop from port `from` to port `to` at which the check valve opens [Pa], >= 0.
        cracking_pressure: f64 => number(Pascal, NonNegative).parameter(Circuit, "Pressure drop at which @ opens");
        /// Width of the pressure range over which the valve opens smoothly [Pa], > 0.
        width: f64 = 5e4 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range over which @ \
            opens smoothly");
        /// Flow through the fully open valve at the pressure drop in the key `rated_pressure_drop` [m3/s], > 0. If
        /// `conductance` is greater than 0, the key `rated_flow` has no effect.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through @ at the \
            rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the key `rated_flow` refers [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
        /// Conductance of a check valve with linear flow [m3/(s.Pa)], >= 0: flow divided by the pressure drop above the
        /// cracking pressure. With the default 0, the flow through the open valve is turbulent, and the key
        /// `rated_flow` states the flow.
        conductance: f64 => number(CubicMetrePerSecondPascal, NonNegative).parameter(Circuit, "Conductance of @: flow \
            divided by the pressure drop above the cracking pressure; the value 0 means a turbulent flow according to \
            the rated flow");
    }

    /// A relief valve lets oil flow from port `from` to port `to` while the pressure at `from` is above the key
    /// `pressure`.
    pub struct Relief {
        /// Port that the relief valve protects from high pressure.
        from: String => line().required();
        /// Port to which the relief valve discharges oil, usually a reservoir.
        to: String => line().required();
        /// Pressure at the port `from` at which the relief valve starts to open [Pa], > 0.
        pressure: f64 = 28e6 => number(Pascal, Positive).parameter(Circuit, "Pressure at the port `from` at which @ \
            starts to open");
        /// Width of the pressure range over which the relief valve starts to open smoothly [Pa], > 0.
        width: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range over which @ \
            opens smoothly");
        /// Conductance of the relief valve: flow divided by the excess of the pressure at the port `from` over the key
        /// `pressure` [m3/(s.Pa)], > 0.
        conductance: f64 = 1e-10 => number(CubicMetrePerSecondPascal, Positive).parameter(Circuit, "Conductance of @: \
            flow divided by the excess of the upstream pressure over the opening pressure");
    }

    /// A priority valve is open while the pressure at the upstream port `from` is above the key `pressure`.
    pub struct Priority {
        /// Upstream port of the priority valve. The pressure at the upstream port opens the valve.
        from: String => line().required();
        /// Downstream port of the valve, on the side of the consumer.
        to: String => line().required();
        /// Pressure at the port `from` at which the valve is half open [Pa], > 0.
        pressure: f64 = 10e6 => number(Pascal, Positive).parameter(Circuit, "Pressure at the upstream port at which \
            @ is half open");
        /// Width of the pressure range over which the valve opens smoothly [Pa], > 0.
        width: f64 = 2e5 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range over which @ \
            opens smoothly");
        /// Flow through the fully open valve at the pressure drop in the key `rated_pressure_drop` [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through @ at the \
            rated pressure drop");
        /// Reverse flow, from port `to` to port `from`, through a parallel check valve at the rated pressure drop
        /// [m3/s], >= 0. With the default 0, the valve has no parallel check valve.
        reverse_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow through @ in the \
            reverse direction (from port `to` to port `from`), at the rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the rated flows of the element refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
    }

    /// A sequence valve is open while the pressure at the port `pilot` is above the key `pressure`.
    pub struct Sequence {
        /// Upstream port of the valve, on the side of the pressure source.
        from: String => line().required();
        /// Downstream port of the valve, on the side of the consumer.
        to: String => line().required();
        /// Pilot port: the pressure at the pilot port opens the valve.
        pilot: String => line().required();
        /// Pressure at the port `pilot` at which the valve is half open [Pa], > 0.
        pressure: f64 = 10e6 => number(Pascal, Positive).parameter(Circuit, "Pilot pressure at which @ is half open");
        /// Width of the pressure range over which the valve opens smoothly [Pa], > 0.
        width: f64 = 2e5 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range over which @ \
            opens smoothly");
        /// Flow through the fully open valve at the pressure drop in the key `rated_pressure_drop` [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through @ at the \
            rated pressure drop");
        /// Reverse flow, from port `to` to port `from`, through a parallel check valve at the rated pressure drop
        /// [m3/s], >= 0. With the default 0, the valve has no parallel check valve.
        reverse_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow through @ in the \
            reverse direction (from port `to` to port `from`), at the rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the rated flows of the element refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
    }

    /// A pilot-operated check valve (lock valve) lets oil flow freely from port `from` to port `to`. Reverse flow is
    /// possible only while the pressure at the port `pilot` exceeds `ratio` times the pressure at the port `to`.
    pub struct PilotCheck {
        /// Port from which oil flows freely to the port `to`.
        from: String => line().required();
        /// Locked port: oil leaves the port `to` through the valve only while the pilot pressure opens the valve.
        to: String => line().required();
        /// Pilot port: the pressure at the pilot port opens the valve for reverse flow.
        pilot: String => line().required();
        /// Pressure ratio at which the pilot opens the valve [1], > 0: reverse flow is possible while the pressure at
        /// the port `pilot` exceeds `ratio` times the pressure at the port `to`. Data sheets usually state the
        /// reciprocal of the pressure ratio: the area of the pilot piston divided by the area of the valve seat.
        ratio: f64 = 0.3 => number(One, Positive).parameter(Circuit, "Ratio of pilot pressure to load pressure above \
            which @ opens for the reverse flow");
        /// Width of the pressure range over which the valve opens smoothly [Pa], > 0.
        width: f64 = 5e4 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range over which @ \
            opens smoothly");
        /// Flow through the fully open valve at the pressure drop in the key `rated_pressure_drop` [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through @ at the \
            rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the key `rated_flow` refers [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
    }

    /// A counterbalance valve lets oil flow freely from port `from` to port `to`. Reverse flow is possible while the
    /// pressure at the port `to` plus `ratio` times the pressure at the port `pilot` is above the key `pressure`.
    pub struct Counterbalance {
        /// Port from which oil flows freely to the port `to`.
        from: String => line().required();
        /// Port of the valve on the side of the load. Reverse flow enters the counterbalance valve at the port `to`.
        to: String => line().required();
        /// Pilot port: the pressure at the pilot port helps to open the valve.
        pilot: String => line().required();
        /// Pilot ratio [1], > 0: factor by which the pilot pressure is multiplied. The valve is half open when the
        /// pressure at the port `to` plus `ratio` times the pressure at the port `pilot` is equal to the key
        /// `pressure`.
        ratio: f64 = 3.0 => number(One, Positive).parameter(Circuit, "Pilot ratio of @: the valve is half open when \
            the load pressure plus this ratio times the pilot pressure is equal to the opening pressure");
        /// Opening pressure of the valve [Pa], > 0. The valve is half open when the pressure at the port `to` plus
        /// `ratio` times the pressure at the port `pilot` is equal to the key `pressure`.
        pressure: f64 = 25e6 => number(Pascal, Positive).parameter(Circuit, "Opening pressure of @: the valve is \
            half open when the load pressure plus the pilot ratio times the pilot pressure is equal to this pressure");
        /// Width of the pressure range over which the valve opens smoothly [Pa], > 0.
        width: f64 = 1e6 => number(Pascal, Positive).parameter(Circuit, "Width of the pressure range over which @ \
            opens smoothly");
        /// Flow through the fully open valve at the pressure drop in the key `rated_pressure_drop` [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through @ at the \
            rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the key `rated_flow` refers [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
    }

    /// A position valve is a sequence valve that the position of a cylinder opens. The key `opens` states whether the
    /// valve is open while the cylinder is longer or shorter than the key `length`.
    pub struct PositionValve {
        /// Upstream port of the valve, on the side of the pressure source.
        from: String => line().required();
        /// Downstream port of the valve, on the side of the consumer.
        to: String => line().required();
        /// Cylinder whose position opens the valve.
        cylinder: String => line().required();
        /// Length of the cylinder `cylinder` at which the position valve is half open [m]. The key `length` must be
        /// within the travel of the cylinder.
        length: f64 => number(Metre, NonNegative).parameter(Circuit, "Length of the cylinder at which @ is half \
            open").required();
        /// Cylinder lengths at which the valve is open. `above`: lengths above the key `length`. `below`: lengths below
        /// the key `length`.
        opens: Opens;
        /// Width of the range of cylinder lengths over which the valve opens smoothly [m], > 0.
        width: f64 = 5e-5 => number(Metre, Positive).parameter(Circuit, "Width of the range of cylinder lengths over \
            which @ opens smoothly");
        /// Flow through the fully open valve at the pressure drop in the key `rated_pressure_drop` [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through @ at the \
            rated pressure drop");
        /// Reverse flow, from port `to` to port `from`, through a parallel check valve at the rated pressure drop
        /// [m3/s], >= 0. With the default 0, the valve has no parallel check valve.
        reverse_flow: f64 => number(CubicMetrePerSecond, NonNegative).parameter(Circuit, "Flow through @ in the \
            reverse direction (from port `to` to port `from`), at the rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the rated flows of the element refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
    }

    /// A by-pass (dump valve) connects two ports. The input `<name>.open` is the opening of the by-pass: 0 is closed,
    /// and 1 is fully open.
    pub struct Bypass {
        /// First port of the by-pass. Flow from the port `from` to the port `to` is positive.
        from: String => line().required();
        /// Second port of the by-pass.
        to: String => line().required();
        /// Start value of the input `<name>.open` [1], from 0 (closed) to 1 (open).
        open: f64 => number(One, UnitRange);
        /// Flow through the fully open valve at the pressure drop in the key `rated_pressure_drop` [m3/s], > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through @ at the \
            rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the key `rated_flow` refers [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
    }

    /// A directional valve has four ports and three positions. The input `<name>.command` is the command of the valve.
    /// A positive command of the valve connects the supply to port a, and port b to the return.
    pub struct Valve {
        /// Port that supplies the directional valve with oil.
        supply: String => line().required();
        /// Port to which the directional valve returns oil, usually a reservoir.
        r#return as "return": String => line().required();
        /// Reservoir, node or chamber to which the working port a of the valve is connected.
        a: String => line().required();
        /// Reservoir, node or chamber to which the working port b of the valve is connected.
        b: String => line().required();
        /// Start value of the input `<name>.command`, the command of the valve [1], from -1 to 1.
        command: f64 => number(One, Finite);
        /// Flow through one fully open metering edge at the pressure drop in the key `rated_pressure_drop` [m3/s],
        /// > 0.
        rated_flow: f64 = 1e-4 => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through one fully \
            open metering edge of @ at the rated pressure drop");
        /// Flow through one fully open metering edge at port b, at the rated pressure drop [m3/s], > 0. The default is
        /// the value of `rated_flow`.
        rated_flow_b: Option<f64> => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through one fully \
            open metering edge at port b of @, at the rated pressure drop");
        /// Flow through the fully open metering edge from port b to the return, at the rated pressure drop [m3/s], > 0.
        /// The default is the value of `rated_flow_b`.
        rated_flow_b_return: Option<f64> => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through the \
            fully open metering edge from port b of @ to the return, at the rated pressure drop");
        /// Flow through the fully open metering edge from port a to the return, at the rated pressure drop [m3/s], > 0.
        /// The default is the value of `rated_flow`.
        rated_flow_a_return: Option<f64> => number(CubicMetrePerSecond, Positive).parameter(Circuit, "Flow through the \
            fully open metering edge from port a of @ to the return, at the rated pressure drop");
        /// Rated pressure drop: the pressure drop to which the rated flows of the element refer [Pa], > 0.
        rated_pressure_drop: f64 = 3.5e6 => number(Pascal, Positive).parameter(Circuit, "Pressure drop to which the \
            rated flows of @ refer");
        /// Transition pressure d_t [Pa], > 0: pressure drop at which the flow changes from laminar to turbulent.
        transition_pressure: f64 = 1e5 => number(Pascal, Positive).parameter(Circuit, "Pressure drop at which the flow \
            through @ changes from laminar to turbulent");
        /// Law for the change from laminar to turbulent flow at the pressure drop `transition_pressure`. `smooth`: the
        /// flow changes smoothly. `switch`: the flow is proportional to the pressure drop below `transition_pressure`,
        /// and to the square root of the pressure drop above.
        transition: Transition;
        /// Clearance of the valve spool, relative to the full opening of a metering edge [1], > 0. At the spool
        /// position `overlap`, a metering edge is open by half of the clearance.
        clearance: f64 = 2e-3 => number(One, Positive).parameter(Circuit, "Clearance of the spool of @, relative to \
            the full opening of a metering edge; at the spool position of the parameter overlap, a metering edge is \
            open by half of the clearance");
        /// Overlap of the valve [1]: spool position, from -1 to 1, at which a metering edge starts to open. A negative
        /// overlap is an underlap.
        overlap: f64 => number(One, Finite).parameter(Circuit, "Overlap of @: spool position at which a metering edge \
            starts to open");
        /// Natural frequency of the valve spool [Hz], > 0. Without the key `frequency`, the spool position is equal to
        /// the command at every instant.
        frequency: Option<f64> => number(Hertz, Positive).parameter(Circuit, "Natural frequency of the spool of @");
        /// Damping ratio of the motion of the valve spool [1], > 0.
        damping_ratio: f64 = 0.8 => number(One, Positive).parameter(Circuit, "Damping ratio of the motion of the spool \
            of @");
    }
}
