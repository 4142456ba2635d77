//! The laws of a hydraulic circuit: oil, valve, cylinder, seals.
//!
//! In: the numbers of a circuit; pressures, spool, motion of the cylinder, pressures of the ports, command. Out: rates
//! of the state, flows, the force, powers. All laws are generic over [`Number`], so that values and exact derivatives
//! share one law, and all are smooth: no law has a kink where a flow, the spool or the piston reverses. It must not
//! know time, nor how the laws are integrated.
//!
//! Sources: Merritt, Hydraulic Control Systems (1967); Jelali, Kroll, Hydraulic Servo-systems (2003); regRoot of
//! Modelica.Fluid.Utilities.
use super::definition::{Accumulator, Circuit, Pump};
use crate::numerics::dual::Number;
use std::f64::consts::{FRAC_PI_4, TAU};

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

/// max(0, x), rounded over the width w: (x + sqrt(x^2 + w^2)) / 2.
pub fn soft<T: Number>(x: T, w: f64) -> T {
    let root = (x.value() * x.value() + w * w).sqrt();
    // Where x < 0 the sum cancels; its product with the difference is w^2.
    let value = if x.value() > 0.0 { 0.5 * (x.value() + root) } else { 0.5 * w * w / (root - x.value()) };
    x.chain(value, value / root)
}

/// Step from 0 to 1, rounded over the width w: (1 + x / sqrt(x^2 + w^2)) / 2.
pub fn gate<T: Number>(x: T, w: f64) -> T {
    let square = x.value() * x.value() + w * w;
    let root = square.sqrt();
    x.chain(0.5 + 0.5 * x.value() / root, 0.5 * w * w / (square * root))
}

/// The laws of one circuit, with what follows from its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equations {
    /// Areas A_A and A_B [m2].
    areas: [f64; 2],
    dead_volumes: [f64; 2],
    closed_length: f64,
    stroke: f64,
    ambient: f64,
    bulk: f64,
    air: f64,
    exponent: f64,
    /// K of the valve's edges [m3/(s sqrt(Pa))].
    edge: f64,
    transition: f64,
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
            closed_length: cylinder.closed_length,
            stroke: cylinder.stroke,
            ambient: fluid.ambient_pressure,
            bulk: fluid.bulk_modulus,
            air: fluid.air_fraction,
            exponent: fluid.polytropic_exponent,
            edge: valve.rated_flow / valve.rated_pressure_drop.sqrt(),
            transition: valve.transition_pressure,
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

    /// Whether the oil holds air, which keeps absolute pressures above 0.
    pub fn has_air(&self) -> bool {
        self.air > 0.0
    }

    /// Least and largest length of the actuator [m].
    pub fn lengths(&self) -> [f64; 2] {
        [self.closed_length, self.closed_length + self.stroke]
    }

    /// Lengths of the actuator at which a cushion begins or ends [m], where a step of the integration should end: the
    /// laws are twice continuously differentiable there, not more.
    pub fn borders(&self) -> [Option<f64>; 2] {
        let [a, b] = self.per_cushion_length.map(|inverse| (inverse > 0.0).then(|| 1.0 / inverse));
        [a.map(|length| self.closed_length + length), b.map(|length| self.closed_length + self.stroke - length)]
    }

    /// Volumes of the chambers [m3] at a length of the actuator [m].
    #[inline]
    pub fn volumes<T: Number>(&self, length: T) -> [T; 2] {
        let x = length - T::constant(self.closed_length);
        [
            T::constant(self.dead_volumes[0]) + x * self.areas[0],
            T::constant(self.dead_volumes[1]) + (T::constant(self.stroke) - x) * self.areas[1],
        ]
    }

    /// Effective bulk modulus of oil with entrained air [Pa] at a gauge pressure: with r = air (p_0/p_abs)^(1/n), E =
    /// bulk (1 + r) / (1 + r bulk/(n p_abs)); NaN at or below absolute zero if there is air.
    #[inline]
    pub fn bulk_modulus<T: Number>(&self, pressure: T) -> T {
        if self.air == 0.0 {
            return T::constant(self.bulk);
        }
        let (n, absolute) = (self.exponent, pressure.value() + self.ambient);
        let r = self.air * (self.ambient / absolute).powf(1.0 / n);
        let ratio = self.bulk / (n * absolute);
        let denominator = 1.0 / (1.0 + r * ratio);
        let value = self.bulk * (1.0 + r) * denominator;
        // r' = -r / (n p_abs), (r ratio)' = -r ratio (1/n + 1) / p_abs.
        let slope = self.bulk * denominator * (-r / (n * absolute))
            + value * denominator * r * ratio * (1.0 / n + 1.0) / absolute;
        pressure.chain(value, slope)
    }

    /// Bulk modulus of chamber `side` [Pa], of oil, hose and walls together: 1/E_eff = 1/E + (V_hose/V)/E_hose +
    /// (V_cyl/V)/E_cyl, V_cyl = V - V_hose.
    #[inline]
    pub fn chamber_modulus<T: Number>(&self, side: usize, pressure: T, volume: T) -> T {
        let oil = self.bulk_modulus(pressure);
        let hose = self.hoses[side];
        if hose == 0.0 && self.wall_compliance == 0.0 {
            return oil;
        }
        let part = T::constant(hose) / volume;
        let walls = (T::constant(1.0) - part) * self.wall_compliance + part * self.hose_compliance;
        oil / (T::constant(1.0) + oil * walls)
    }

    /// Resistance in series with the edges of chamber `side` for flow out of it [Pa s2/m6].
    #[inline]
    fn resistance<T: Number>(&self, side: usize, length: T) -> T {
        let restrictor = T::constant(self.restrictors[side]);
        let inverse = self.per_cushion_length[side];
        if inverse == 0.0 {
            return restrictor;
        }
        let x = length - T::constant(self.closed_length);
        let e = if side == 0 { x } else { T::constant(self.stroke) - x };
        let within = T::constant(1.0) - e * inverse;
        if within.value() <= 0.0 { restrictor } else { restrictor + within * within * within * self.cushions[side] }
    }

    /// Flow [m3/s] through an edge of flow coefficient `edge` under the pressure drop d, with a resistance for the flow
    /// out of the chamber: root(d) / sqrt(1/edge^2 + resistance gate(-d)), root(d) = d / (d^2 + d_t^2)^(1/4).
    #[inline]
    fn path<T: Number>(&self, d: T, edge: T, resistance: T) -> T {
        let root = (d * d + T::constant(self.transition * self.transition)).sqrt();
        let series = if resistance.value() == 0.0 {
            root
        } else {
            root * (T::constant(1.0) + edge * edge * resistance * gate(-d, self.check))
        };
        edge * d / series.sqrt()
    }

    /// Part of the flow under the pressure drop d into chamber A that the lock valve lets pass: all inflow; outflow
    /// while p_B > pilot ratio x p_A. Squares of gates leave a closed valve 1e-9 of the flow at 100 times its width.
    fn lock<T: Number>(&self, d: T, [p_a, p_b]: [T; 2]) -> T {
        let (inflow, outflow) = (gate(d, self.lock_width), gate(-d, self.lock_width));
        let pilot = gate(p_b - p_a * self.pilot_ratio, self.lock_width);
        inflow * inflow + outflow * (T::constant(1.0) + inflow) * pilot * pilot
    }

    /// Friction of the seals without the part of the pressures [N] at a speed v [m/s]: (coulomb + (static - coulomb)
    /// exp(-(v/stribeck)^2)) tanh(v / transition) + viscous v.
    #[inline]
    pub fn friction<T: Number>(&self, speed: T) -> T {
        let (value, slope, _) = self.friction_at(speed.value());
        speed.chain(value, slope)
    }

    /// Friction of the seals, its derivative and its second derivative with respect to the speed.
    #[inline]
    pub fn friction_at(&self, v: f64) -> (f64, f64, f64) {
        if self.coulomb == 0.0 && self.excess == 0.0 {
            return (self.viscous * v, self.viscous, 0.0);
        }
        let z = v / self.stribeck;
        let bell = self.excess * (-z * z).exp();
        let t = (v / self.transition_speed).tanh();
        let (steepness, level) = ((1.0 - t * t) / self.transition_speed, self.coulomb + bell);
        let bell_slope = -2.0 * z / self.stribeck * bell;
        let bell_curvature = (4.0 * z * z - 2.0) / (self.stribeck * self.stribeck) * bell;
        (
            level * t + self.viscous * v,
            bell_slope * t + level * steepness + self.viscous,
            bell_curvature * t + 2.0 * bell_slope * steepness - 2.0 * level * t * steepness / self.transition_speed,
        )
    }

    /// Growth of the friction level with the pressures [N]: area times the sum of both pressures, each rounded at 0.
    #[inline]
    fn pressed<T: Number>(&self, pressures: [T; 2]) -> T {
        (soft(pressures[0], self.transition) + soft(pressures[1], self.transition)) * self.pressure_area
    }

    /// Friction of the seals [N] under the pressures of the chambers: [`Self::friction`] plus area times the pressures
    /// times tanh(v / transition).
    #[inline]
    pub fn seal_friction<T: Number>(&self, pressures: [T; 2], speed: T) -> T {
        let dry = self.friction(speed);
        if self.pressure_area == 0.0 {
            return dry;
        }
        let t = (speed.value() / self.transition_speed).tanh();
        dry + self.pressed(pressures) * speed.chain(t, (1.0 - t * t) / self.transition_speed)
    }

    /// Damping of the seals [N s/m]: derivative of the friction with respect to the speed.
    pub fn damping<T: Number>(&self, pressures: [T; 2], speed: T) -> T {
        let (_, slope, curvature) = self.friction_at(speed.value());
        let dry = speed.chain(slope, curvature);
        if self.pressure_area == 0.0 {
            return dry;
        }
        let t = (speed.value() / self.transition_speed).tanh();
        let steepness = (1.0 - t * t) / self.transition_speed;
        dry + self.pressed(pressures) * speed.chain(steepness, -2.0 * t * steepness / self.transition_speed)
    }

    /// Force of the actuator [N], > 0 pushing its ends apart: A_A p_A - A_B p_B - F_f(v).
    #[inline]
    pub fn force<T: Number>(&self, pressures: [T; 2], speed: T) -> T {
        pressures[0] * self.areas[0] - pressures[1] * self.areas[1] - self.seal_friction(pressures, speed)
    }

    /// Stiffness of the oil [N/m]: k = E(p_A) A_A^2/V_A + E(p_B) A_B^2/V_B.
    pub fn stiffness<T: Number>(&self, pressures: [T; 2], length: T) -> T {
        let [a, b] = self.volumes(length);
        self.chamber_modulus(0, pressures[0], a) / a * (self.areas[0] * self.areas[0])
            + self.chamber_modulus(1, pressures[1], b) / b * (self.areas[1] * self.areas[1])
    }

    /// Flows, rates of the state, volumes and bulk moduli.
    #[inline]
    pub fn flows<T: Number>(&self, at: &Point<T>) -> Flows<T> {
        let zero = T::constant(0.0);
        let overlap = T::constant(self.overlap);
        let plus = soft(at.spool - overlap, self.clearance) * self.edge;
        let minus = soft(-at.spool - overlap, self.clearance) * self.edge;
        let (mut supply, mut tank, mut throttling) = (zero, zero, zero);
        let [p_a, p_b] = at.pressures;
        let across = p_a - p_b;
        let leak = across * self.internal;
        throttling = throttling + across * leak;
        let mut chambers = [-leak, leak];
        for (side, chamber) in chambers.iter_mut().enumerate() {
            let p = at.pressures[side];
            let [from_supply, from_tank] = if side == 0 { [plus, minus] } else { [minus, plus] };
            let resistance = self.resistance(side, at.length);
            let (fall, rise) = (at.supply - p, at.tank - p);
            let (mut q_p, mut q_t) = (self.path(fall, from_supply, resistance), self.path(rise, from_tank, resistance));
            if side == 0 && self.pilot_ratio > 0.0 {
                (q_p, q_t) = (q_p * self.lock(fall, at.pressures), q_t * self.lock(rise, at.pressures));
            }
            let relief = soft(p - T::constant(self.relief_pressure), self.relief_width) * self.relief;
            let suction = soft(rise, self.relief_width) * self.anticavitation;
            let external = p * self.external[side];
            *chamber = *chamber + q_p + q_t - relief + suction - external;
            supply = supply + q_p;
            tank = tank - q_t + relief - suction;
            throttling = throttling + fall * q_p + rise * (q_t + suction - relief) + p * external;
        }
        let volumes = self.volumes(at.length);
        let bulk_moduli = std::array::from_fn(|side| self.chamber_modulus(side, at.pressures[side], volumes[side]));
        let swept = [at.speed * -self.areas[0], at.speed * self.areas[1]];
        Flows {
            pressure_rates: std::array::from_fn(|i| bulk_moduli[i] / volumes[i] * (chambers[i] + swept[i])),
            spool_acceleration: self.spool_acceleration(at),
            chambers,
            supply,
            tank,
            throttling,
            volumes,
            bulk_moduli,
        }
    }

    /// Acceleration of the spool [1/s2]: w_n^2 (u - y) - 2 zeta w_n y'.
    #[inline]
    fn spool_acceleration<T: Number>(&self, at: &Point<T>) -> T {
        (at.command - at.spool) * (self.omega * self.omega) - at.spool_speed * (2.0 * self.damping_ratio * self.omega)
    }

    /// Powers, given the flows at the same point.
    #[inline]
    pub fn powers<T: Number>(&self, at: &Point<T>, flows: &Flows<T>) -> Powers<T> {
        let ([p_a, p_b], [q_a, q_b], v) = (at.pressures, flows.chambers, at.speed);
        let friction = self.seal_friction(at.pressures, v);
        let force = p_a * self.areas[0] - p_b * self.areas[1] - friction;
        Powers {
            supply: at.supply * flows.supply,
            returned: at.tank * flows.tank,
            piston: force * v,
            seal_friction: friction * v,
            compression: p_a * (q_a - v * self.areas[0]) + p_b * (q_b + v * self.areas[1]),
            throttling: flows.throttling,
            force,
        }
    }
}

/// Accumulator and pump at the supply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupplyUnit {
    /// V_0 [m3], precharge pressure [Pa, absolute], exponent n.
    volume: f64,
    precharge: f64,
    exponent: f64,
    ambient: f64,
    max_flow: f64,
    full: f64,
    most: f64,
}

impl SupplyUnit {
    /// The accumulator of a checked definition; None without volume.
    pub fn new(accumulator: &Accumulator, pump: &Pump, ambient: f64) -> Option<Self> {
        (accumulator.volume > 0.0).then_some(Self {
            volume: accumulator.volume,
            precharge: accumulator.precharge_pressure + ambient,
            exponent: accumulator.polytropic_exponent,
            ambient,
            max_flow: pump.max_flow,
            full: pump.full_pressure,
            most: pump.max_pressure,
        })
    }

    /// Pressures at which the flow of the pump has a kink [Pa], where a step of the integration should end.
    pub fn borders(&self) -> [f64; 2] {
        [self.full, self.most]
    }

    /// Rate of the supply's pressure [Pa/s] under the flow to the valve: p_S' = n p_abs/V_gas (Q_pump - Q_P), V_gas =
    /// V_0 (p_pre/p_abs)^(1/n), Q_pump = Q_max clip((p_max - p_S)/(p_max - p_full), 0, 1).
    pub fn rate<T: Number>(&self, pressure: T, flow: T) -> T {
        let (absolute, n) = (pressure.value() + self.ambient, self.exponent);
        // n p_abs/V_gas grows as p_abs^(1 + 1/n).
        let stiffness = n * absolute / (self.volume * (self.precharge / absolute).powf(1.0 / n));
        let stiffness = pressure.chain(stiffness, stiffness * (1.0 + 1.0 / n) / absolute);
        let span = self.most - self.full;
        let part = (self.most - pressure.value()) / span;
        let pump = match part {
            part if part >= 1.0 => T::constant(self.max_flow),
            part if part <= 0.0 => T::constant(0.0),
            part => pressure.chain(self.max_flow * part, -self.max_flow / span),
        };
        stiffness * (pump - flow)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dual::Dual;

    fn equations() -> Equations {
        Equations::new(&Circuit::default())
    }

    fn near(value: f64, expected: f64, tolerance: f64) {
        assert!((value / expected - 1.0).abs() <= tolerance, "{value} is not {expected}");
    }

    fn point(x: f64, pressures: [f64; 2], spool: f64) -> Point<f64> {
        let (length, speed, spool_speed) = (0.412 + x, 0.0, 0.0);
        Point { pressures, spool, spool_speed, length, speed, supply: 20.7e6, tank: 0.35e6, command: 0.0 }
    }

    /// Values of an implementation by other hands, to the digits that it states.
    #[test]
    fn laws_agree_with_the_reference() {
        let laws = equations();
        near(laws.areas[0], 0.001_590_431_280_879_832_6, 1e-15);
        near(laws.areas[1], 0.001_099_557_428_756_427_4, 1e-15);
        near(laws.edge, 5.345_224_838_248_488e-8, 1e-15);
        near(laws.bulk_modulus(5e6), 1_321_595_325.333_9, 1e-13);
        near(laws.bulk_modulus(0.35e6), 291_483_049.787_1, 1e-12);
        near(laws.friction(0.01), 358.624_710_158_78, 1e-13);
        for (x, pressures, spool, [q_a, q_b]) in [
            (0.1, [5e6, 8e6], 0.5, [1.065_393_971_030_2e-4, -7.489_738_586_845_6e-5]),
            (0.315, [12e6, 16e6], 0.65, [1.032_816_594_677_5e-4, -6.522_398_968_940_9e-5]),
            (0.01, [5e6, 8e6], -0.5, [-2.091_656_050_676_9e-5, 9.426_283_492_468_1e-5]),
        ] {
            let flows = laws.flows(&point(x, pressures, spool));
            near(flows.chambers[0], q_a, 1e-13);
            near(flows.chambers[1], q_b, 1e-13);
        }
    }

    #[test]
    fn power_is_balanced_at_every_point() {
        let laws = equations();
        for (x, pressures, spool, speed) in
            [(0.1, [5e6, 8e6], 0.5, 0.1), (0.32, [30e6, -9e4], -0.3, -0.2), (0.01, [1e5, 25e6], 0.0, 0.003)]
        {
            let at = Point { speed, ..point(x, pressures, spool) };
            let p = laws.powers(&at, &laws.flows(&at));
            let out = p.returned + p.piston + p.seal_friction + p.compression + p.throttling;
            assert!((p.supply - out).abs() < 1e-13 * p.throttling.abs(), "{p:?}");
            assert!(p.throttling > 0.0 && p.seal_friction > 0.0);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        let laws = equations();
        let size = [1e6, 1e6, 1e-2, 1.0, 1e-3, 1e-2, 1e6, 1e5, 1e-2];
        let set = |of: [f64; 9]| {
            let [p_a, p_b, spool, spool_speed, length, speed, supply, tank, command] = of;
            [p_a, p_b, spool, spool_speed, length, speed, supply, tank, command]
        };
        fn flows<T: Number>(laws: &Equations, z: [T; 9]) -> [T; 12] {
            let [p_a, p_b, spool, spool_speed, length, speed, supply, tank, command] = z;
            let at = Point { pressures: [p_a, p_b], spool, spool_speed, length, speed, supply, tank, command };
            let f = laws.flows(&at);
            let p = laws.powers(&at, &f);
            let [a, b] = f.pressure_rates;
            [
                a,
                b,
                f.spool_acceleration,
                f.chambers[0],
                f.chambers[1],
                f.supply,
                f.tank,
                p.throttling,
                p.piston,
                p.compression,
                laws.stiffness([p_a, p_b], length),
                p.seal_friction,
            ]
        }
        for z in [
            [5e6, 8e6, 0.4, 3.0, 0.43, 0.02, 20e6, 4e5, 0.5],
            [27.99e6, 0.3e6, -0.01, 3.0, 0.73, -0.004, 20e6, 4e5, 0.5],
            [-5e4, 20.01e6, 0.001, 0.0, 0.6, 0.0, 20e6, 4e5, 0.0],
        ] {
            for k in 0..9 {
                let mut dual = set(z).map(Dual::<1>::constant);
                dual[k].slope = [1.0];
                let exact = flows(&laws, dual);
                let step = 1e-6 * size[k];
                let at = |factor: f64| {
                    let mut beside = z;
                    beside[k] += factor * step;
                    flows(&laws, beside)
                };
                let (one, two) = ([at(-1.0), at(1.0)], [at(-2.0), at(2.0)]);
                let plain = flows(&laws, z);
                for i in 0..12 {
                    let difference = (8.0 * (one[1][i] - one[0][i]) - (two[1][i] - two[0][i])) / (12.0 * step);
                    let rounding = 1e-8 * (plain[i].abs() / size[k]).max(difference.abs());
                    assert_eq!(exact[i].value, plain[i]);
                    assert!((exact[i].slope[0] - difference).abs() <= rounding, "{k} {i} {exact:?} {difference}");
                }
            }
        }
    }

    #[test]
    fn a_cushion_joins_twice_differentiably_and_its_borders_are_told() {
        let laws = equations();
        let [a, b] = laws.borders().map(Option::unwrap);
        assert!((a - 0.442).abs() < 1e-15 && (b - 0.712).abs() < 1e-15);
        assert_eq!(laws.resistance(0, a + 1e-9), laws.restrictors[0]);
        assert!(laws.resistance(0, a - 1e-5) - laws.restrictors[0] <= 1.01e-9 / 27.0 * laws.cushions[0] * 1e3);
        let none = Circuit { cushion_a: Default::default(), ..Circuit::default() };
        let mut none = none;
        none.cushion_a.length = 0.0;
        none.cushion_b.rated_flow = 0.0;
        assert_eq!(Equations::new(&none).borders(), [None; 2]);
    }

    #[test]
    fn curvature_of_the_friction_is_that_of_its_slope() {
        let laws = equations();
        for v in [-0.03, -0.004, 0.0, 1e-3, 0.02] {
            let h = 1e-7;
            let difference = (laws.friction_at(v + h).1 - laws.friction_at(v - h).1) / (2.0 * h);
            // Size of the curvature: static friction over the square of the transition speed.
            assert!((laws.friction_at(v).2 - difference).abs() < 1e-6 * 400.0 / 0.005_f64.powi(2), "{v}");
        }
    }
}
