//! The laws of a hydraulic circuit: oil, valve, cylinder, seals, supply.
//!
//! In: the numbers of a circuit; pressures, spool, motion of the cylinder, pressures of the ports, command. Out: rates
//! of the state, flows, the force, powers. All laws are generic over
//! [`Number`](foundation::numerics::dual::Number), so that values and exact derivatives share one law, and all are
//! smooth: no law has a kink where a flow, the spool or the piston reverses. It must not know time, nor how the laws
//! are integrated.
//!
//! ```text
//! smooth -> oil, seal -> flows -> rates <- supply
//! ```
//!
//! Sources: Merritt, Hydraulic Control Systems (1967); Jelali, Kroll, Hydraulic Servo-systems (2003); regRoot of
//! Modelica.Fluid.Utilities.
mod displaced;
mod flows;
mod limits;
mod oil;
mod rates;
mod seal;
mod smooth;
mod supply;

#[cfg(test)]
mod tests;

use super::definition::{Circuit, OilVolume, Transition};
pub use limits::{EVENTS, SLACK, settling_acceleration, settling_reach};
pub use rates::{CIRCUIT, DYNAMIC, ENERGIES, ENERGY, FREE, Rates, SPOOL, SUPPLY};
pub use smooth::{gate, head, soft};
use std::f64::consts::{FRAC_PI_4, TAU};
pub use supply::SupplyUnit;

/// Part of the clearance within which the spool is at an edge.
const ON_EDGE: f64 = 1e-3;

/// State and surroundings of a circuit at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Point<T> {
    /// Pressures of the chambers A and B, gauge [Pa].
    pub pressures: [T; 2],
    /// Spool position y [1].
    pub spool: T,
    /// Spool speed [1/s].
    pub spool_speed: T,
    /// Length of the actuator s [m].
    pub length: T,
    /// Speed of the actuator v, the rate of the length [m/s].
    pub speed: T,
    /// Pressure of the supply, gauge [Pa].
    pub supply: T,
    /// Pressure of the tank, gauge [Pa].
    pub tank: T,
    /// Command of the valve u, from -1 to 1.
    pub command: T,
}

/// What the laws give at a [`Point`].
#[derive(Clone, Copy, Debug)]
pub struct Flows<T> {
    /// Rates of the pressures of the chambers A and B [Pa/s].
    pub pressure_rates: [T; 2],
    /// Acceleration of the spool [1/s2].
    pub spool_acceleration: T,
    /// Flows into the chambers A and B [m3/s].
    pub chambers: [T; 2],
    /// Flow from the supply [m3/s].
    pub supply: T,
    /// Flow into the tank [m3/s].
    pub tank: T,
    /// Sum over all flow paths of pressure drop times flow [W].
    pub throttling: T,
    /// Volumes of the chambers A and B [m3].
    pub volumes: [T; 2],
    /// Effective bulk moduli of the oil in the chambers A and B [Pa].
    pub bulk_moduli: [T; 2],
}

/// Powers of a circuit [W]; supply - returned - piston - seal friction - compression - throttling = 0.
#[derive(Clone, Copy, Debug)]
pub struct Powers<T> {
    /// p_S Q_P, from the supply.
    pub supply: T,
    /// p_T Q_T, into the tank.
    pub returned: T,
    /// F v, to what the actuator moves.
    pub piston: T,
    /// F_f v, lost in the seals.
    pub seal_friction: T,
    /// p_A (Q_A - A_A v) + p_B (Q_B + A_B v), into the oil's elasticity.
    pub compression: T,
    /// Lost in all flow paths.
    pub throttling: T,
    /// Force of the actuator F [N], of which the power of the piston is made.
    pub force: T,
}

/// The laws of one circuit, with what follows from its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equations {
    /// Areas A_A and A_B [m2].
    areas: [f64; 2],
    dead_volumes: [f64; 2],
    /// Whether the oil that makes a chamber elastic is that of the dead volume.
    keeps_volume: bool,
    closed_length: f64,
    stroke: f64,
    /// Restitution at the ends of the travel [1].
    restitution: f64,
    ambient: f64,
    bulk: f64,
    air: f64,
    exponent: f64,
    /// K of the valve's edges [m3/(s sqrt(Pa))].
    edge: f64,
    transition: f64,
    switches: bool,
    clearance: f64,
    overlap: f64,
    /// Natural frequency of the spool [rad/s] and its damping ratio.
    omega: f64,
    damping_ratio: f64,
    /// Resistances of the restrictors [Pa s2/m6].
    restrictors: [f64; 2],
    /// Resistances of the cushions at the end of the travel [Pa s2/m6].
    cushions: [f64; 2],
    /// Reciprocal lengths of the cushions [1/m]; 0: none.
    per_cushion_length: [f64; 2],
    check: f64,
    relief_pressure: f64,
    relief_width: f64,
    relief: f64,
    anticavitation: f64,
    internal: f64,
    external: [f64; 2],
    coulomb: f64,
    /// Static less kinetic friction [N].
    excess: f64,
    stribeck: f64,
    transition_speed: f64,
    viscous: f64,
    /// Growth of the friction with the pressure in each chamber [m2].
    pressure_area: f64,
    /// Volumes of the hoses [m3], and the reciprocals of the moduli of hoses and walls [1/Pa].
    hoses: [f64; 2],
    hose_compliance: f64,
    wall_compliance: f64,
    /// Pilot ratio of the lock valve, 0 for none, and the pressure over which it opens [Pa].
    pilot_ratio: f64,
    lock_width: f64,
    /// Accumulator and pump; none where the pressure of the supply is an input.
    unit: Option<SupplyUnit>,
}
impl Equations {
    /// The laws of a checked circuit.
    pub fn new(circuit: &Circuit) -> Self {
        let Circuit { fluid, cylinder, valve, relief, leakage, seal, .. } = circuit;
        let piston = FRAC_PI_4 * cylinder.bore * cylinder.bore;
        let resistance = |flow: f64| if flow > 0.0 { valve.rated_pressure_drop / (flow * flow) } else { 0.0 };
        let cushion = |length: f64, flow: f64| if length > 0.0 { resistance(flow) } else { 0.0 };
        let (a, b) = (&circuit.cushion_a, &circuit.cushion_b);
        let cushions = [cushion(a.length, a.rated_flow), cushion(b.length, b.rated_flow)];
        let inverse = |length: f64, cushion: f64| if cushion > 0.0 { 1.0 / length } else { 0.0 };
        Self {
            areas: [piston, piston - FRAC_PI_4 * cylinder.rod * cylinder.rod],
            dead_volumes: [circuit.chamber_a.dead_volume, circuit.chamber_b.dead_volume],
            keeps_volume: cylinder.oil_volume == OilVolume::Constant,
            closed_length: cylinder.closed_length,
            stroke: cylinder.stroke,
            restitution: cylinder.restitution,
            ambient: fluid.ambient_pressure,
            bulk: fluid.bulk_modulus,
            air: fluid.air_fraction,
            exponent: fluid.polytropic_exponent,
            edge: valve.rated_flow / valve.rated_pressure_drop.sqrt(),
            transition: valve.transition_pressure,
            switches: valve.transition == Transition::Switch,
            clearance: valve.clearance,
            overlap: valve.overlap,
            omega: TAU * valve.frequency,
            damping_ratio: valve.damping_ratio,
            restrictors: [resistance(circuit.restrictor_a.rated_flow), resistance(circuit.restrictor_b.rated_flow)],
            cushions,
            per_cushion_length: [inverse(a.length, cushions[0]), inverse(b.length, cushions[1])],
            check: circuit.check.pressure,
            relief_pressure: relief.pressure,
            relief_width: relief.width,
            relief: relief.conductance,
            anticavitation: circuit.anticavitation.conductance,
            internal: leakage.internal,
            external: [leakage.external_a, leakage.external_b],
            coulomb: seal.coulomb,
            excess: seal.r#static - seal.coulomb,
            stribeck: seal.stribeck_speed,
            transition_speed: seal.transition_speed,
            viscous: seal.viscous,
            pressure_area: seal.pressure_area,
            hoses: [circuit.hose.volume_a, circuit.hose.volume_b],
            hose_compliance: 1.0 / circuit.hose.modulus,
            wall_compliance: if cylinder.wall_modulus > 0.0 { 1.0 / cylinder.wall_modulus } else { 0.0 },
            pilot_ratio: circuit.lock_valve.pilot_ratio,
            lock_width: circuit.lock_valve.width,
            unit: SupplyUnit::new(&circuit.accumulator, &circuit.pump, fluid.ambient_pressure),
        }
    }

    /// Areas of the piston in the chambers A and B [m2].
    pub fn areas(&self) -> [f64; 2] {
        self.areas
    }

    /// Ambient pressure p_0 [Pa].
    pub fn ambient(&self) -> f64 {
        self.ambient
    }

    /// Natural frequency of the spool [rad/s].
    pub fn spool_frequency(&self) -> f64 {
        self.omega
    }

    /// Least and largest length of the actuator [m].
    pub fn lengths(&self) -> [f64; 2] {
        [self.closed_length, self.closed_length + self.stroke]
    }

    /// Speed of the piston after an impact on an end of its travel over the speed before [1].
    pub fn restitution(&self) -> f64 {
        self.restitution
    }

    /// Accumulator and pump; none where the pressure of the supply is an input.
    pub fn supply_unit(&self) -> Option<&SupplyUnit> {
        self.unit.as_ref()
    }

    /// Positions of the spool at which an edge opens, each if it is another one than the first, and the distance from
    /// one within which the spool is at it. Over less than the clearance the flow grows from almost nothing there: a
    /// step of the integration should end there, as it could pass that unseen.
    pub fn edges(&self) -> ([Option<f64>; 2], f64) {
        ([Some(self.overlap), Some(-self.overlap).filter(|edge| *edge != self.overlap)], ON_EDGE * self.clearance)
    }

    /// Lengths of the actuator at which a cushion begins or ends [m], where a step of the integration should end: the
    /// laws are twice continuously differentiable there, not more.
    #[inline]
    pub fn borders(&self) -> [Option<f64>; 2] {
        let [a, b] = self.per_cushion_length.map(|inverse| (inverse > 0.0).then(|| 1.0 / inverse));
        [a.map(|length| self.closed_length + length), b.map(|length| self.closed_length + self.stroke - length)]
    }
}
