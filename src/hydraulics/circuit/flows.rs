//! Flows through valve, restrictors, cushions, relief and anti-cavitation valves and leakages, and powers.
//!
//! In: a point. Out: flows into the chambers and through the ports, rates of the pressures and the spool, powers. It
//! must not know the supply behind its port.
use super::smooth::{gate, head, soft};
use super::{Equations, Flows, Point, Powers};
use foundation::numerics::dual::Number;

impl Equations {
    /// Resistance in series with the edges of chamber `side` for flow out of it [Pa s2/m6].
    #[inline]
    pub fn resistance<T: Number>(&self, side: usize, length: T) -> T {
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
    /// out of the chamber: root(d) / sqrt(1/edge^2 + resistance gate(-d)), root(d) = d / (d^2 + d_t^2)^(1/4), or with
    /// [`head`] in place of sqrt(d^2 + d_t^2).
    #[inline]
    fn path<T: Number>(&self, d: T, edge: T, resistance: T) -> T {
        let root = head(d, self.transition, self.switches);
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
        let oil = self.oil_volumes(volumes);
        let bulk_moduli = std::array::from_fn(|side| self.chamber_modulus(side, at.pressures[side], oil[side]));
        let swept = [at.speed * -self.areas[0], at.speed * self.areas[1]];
        Flows {
            pressure_rates: std::array::from_fn(|i| bulk_moduli[i] / oil[i] * (chambers[i] + swept[i])),
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
