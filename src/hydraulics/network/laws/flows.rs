//! Flows between the ports of a network.
//!
//! In: a point. Out: the net flow into each port, the flow of each path and pump, powers. It must not know elasticity.
use super::{Accumulator, Law, Laws, Path, Pilot};
use crate::circuit::{gate, head, soft};
use crate::network::definition::{MOST_CYLINDERS, MOST_VALVES};
use foundation::numerics::dual::Number;

/// Part of the band of a compensated pump over which its kinks are rounded.
const PUMP_ROUNDING: f64 = 0.02;

/// State and surroundings of a network at one instant.
#[derive(Debug)]
pub struct Point<'a, T> {
    /// Components of the state, of which the pressures and the spools count.
    pub y: &'a [T],
    /// Inputs that act on flows.
    pub u: &'a [T],
    /// Length and speed of each cylinder.
    pub motion: &'a [[T; 2]],
}

/// Powers and external leakage of a network.
#[derive(Clone, Copy, Debug)]
pub struct Powers<T> {
    /// Work of the pumps [W].
    pub pumps: T,
    /// Lost in flow paths and leakages [W].
    pub throttling: T,
    /// Flow of external leakage [m3/s].
    pub leaked: T,
}

impl<T: Number> Point<'_, T> {
    /// Pressure of a port [Pa].
    #[inline]
    fn pressure(&self, port: usize, volumes: usize) -> T {
        if port < volumes { self.y[port] } else { self.u[port - volumes] }
    }
}

/// Flow through a path of flow coefficient k under the pressure drop d, whose [`head`] is `root`, with a laminar
/// resistance R in series: d = R Q
/// + Q sqrt(d^2 + d_t^2)^(1/2) / k^2 of which Q = 2 d k / (R k + sqrt((R k)^2 + 4 sqrt(d^2 + d_t^2))).
#[inline]
fn path<T: Number>(d: T, k: T, laminar: f64, root: T) -> T {
    if laminar == 0.0 {
        return k * d / root.sqrt();
    }
    let series = k * laminar;
    k * d * 2.0 / (series + (series * series + root * 4.0).sqrt())
}

impl Accumulator {
    /// Volume of the gas [m3] at a gauge pressure: V_0 (p_pre/p_abs)^(1/n).
    pub fn gas<T: Number>(&self, pressure: T, ambient: f64) -> T {
        let absolute = pressure.value() + ambient;
        let volume = self.volume * (self.precharge / absolute).powf(1.0 / self.exponent);
        pressure.chain(volume, -volume / (self.exponent * absolute))
    }

    /// Its compliance [m3/Pa]: V_gas/(n p_abs).
    pub(super) fn compliance<T: Number>(&self, pressure: T, ambient: f64) -> T {
        let (absolute, n) = (pressure.value() + ambient, self.exponent);
        let value = self.volume * (self.precharge / absolute).powf(1.0 / n) / (n * absolute);
        pressure.chain(value, -value * (1.0 + 1.0 / n) / absolute)
    }
}

impl Path {
    /// Flow from -> to. `outlets`: resistances of the chambers at the ends for flow out of them, if there are such.
    #[inline]
    fn flow<T: Number>(
        &self,
        at: &Point<'_, T>,
        [p_from, p_to]: [T; 2],
        openings: &[[T; 2]],
        outlets: Option<[T; 2]>,
        volumes: usize,
    ) -> T {
        let d = p_from - p_to;
        let (k, laminar) = match self.law {
            Law::Relief { conductance, pressure, width } => {
                return soft(p_from - T::constant(pressure), width) * conductance;
            }
            Law::Linear { conductance, cracking, width } => {
                return soft(d - T::constant(cracking), width) * conductance;
            }
            Law::Open { k, laminar } => (T::constant(k), laminar),
            Law::Edge { k, valve, side } => (openings[valve][side] * k, 0.0),
            Law::Bypass { k, input } => (at.u[input] * k, 0.0),
            Law::Gated { roots: [forward, back], cracking, check_width, pilot, laminar } => {
                let one = T::constant(1.0);
                let [g, h] = match pilot {
                    Pilot::None => [one, one],
                    Pilot::Above { port, pressure, width } => {
                        [gate(at.pressure(port, volumes) - T::constant(pressure), width), one]
                    }
                    Pilot::Position { cylinder, sign, length, width } => {
                        [gate((at.motion[cylinder][0] - T::constant(length)) * sign, width), one]
                    }
                    Pilot::Ratio { port, ratio, width } => {
                        [one, gate(at.pressure(port, volumes) - p_to * ratio, width)]
                    }
                    Pilot::Sum { port, ratio, pressure, width } => {
                        let sum = p_to + at.pressure(port, volumes) * ratio;
                        [one, gate(sum - T::constant(pressure), width)]
                    }
                };
                let mut root = gate(d - T::constant(cracking), check_width) * g * forward;
                if back > 0.0 {
                    root = root + gate(-d, check_width) * h * back;
                }
                (root * root, laminar)
            }
        };
        let k = match outlets {
            None => k,
            Some([from, to]) => {
                let resistance = from * gate(d, super::build::CHECK_WIDTH) + to * gate(-d, super::build::CHECK_WIDTH);
                k / (T::constant(1.0) + k * k * resistance).sqrt()
            }
        };
        path(d, k, laminar, head(d, self.transition, self.switches))
    }
}

impl Laws {
    /// Net flows into all ports, added to `net`, powers, and the force of nothing. `seen` is called with the flow of
    /// each path and of each pump, by its index.
    #[inline]
    pub fn flows<T: Number>(&self, at: &Point<'_, T>, net: &mut [T], mut seen: impl FnMut(usize, T)) -> Powers<T> {
        let zero = T::constant(0.0);
        let volumes = self.layout.volumes();
        let mut openings = [[zero; 2]; MOST_VALVES];
        for (index, valve) in self.valves.iter().enumerate() {
            let (spool, overlap) = (self.spool(index, at.y, at.u), T::constant(valve.overlap));
            openings[index] = [soft(spool - overlap, valve.clearance), soft(-spool - overlap, valve.clearance)];
        }
        let mut resistances = [zero; 2 * MOST_CYLINDERS];
        let mut powers = Powers { pumps: zero, throttling: zero, leaked: zero };
        for (index, cylinder) in self.cylinders.iter().enumerate() {
            let chamber = self.layout.chamber(index);
            for side in 0..2 {
                if cylinder.throttles[side] {
                    resistances[2 * index + side] = cylinder.laws.resistance(side, at.motion[index][0]);
                }
                let (p, external) = (at.y[chamber + side], cylinder.external[side]);
                if external > 0.0 {
                    let leak = p * external;
                    net[chamber + side] = net[chamber + side] - leak;
                    powers.leaked = powers.leaked + leak;
                    powers.throttling = powers.throttling + p * leak;
                }
            }
            if cylinder.internal > 0.0 {
                let across = at.y[chamber] - at.y[chamber + 1];
                let leak = across * cylinder.internal;
                (net[chamber], net[chamber + 1]) = (net[chamber] - leak, net[chamber + 1] + leak);
                powers.throttling = powers.throttling + across * leak;
            }
        }
        for (index, path) in self.paths.iter().enumerate() {
            let outlets = match path.outlets {
                [None, None] => None,
                outlets => Some(outlets.map(|chamber| chamber.map_or(zero, |chamber| resistances[chamber]))),
            };
            let ends = [path.from, path.to].map(|port| at.pressure(port, volumes));
            let flow = path.flow(at, ends, &openings, outlets, volumes);
            (net[path.from], net[path.to]) = (net[path.from] - flow, net[path.to] + flow);
            powers.throttling = powers.throttling + (ends[0] - ends[1]) * flow;
            seen(index, flow);
        }
        for (index, pump) in self.pumps.iter().enumerate() {
            let [from, to] = [pump.from, pump.to].map(|port| at.pressure(port, volumes));
            let mut flow = at.u[pump.speed] * pump.max_flow;
            if let Some([full, most]) = pump.band {
                let part = (T::constant(most) - to) * (1.0 / (most - full));
                flow = flow * (soft(part, PUMP_ROUNDING) - soft(part - T::constant(1.0), PUMP_ROUNDING));
            }
            (net[pump.from], net[pump.to]) = (net[pump.from] - flow, net[pump.to] + flow);
            powers.pumps = powers.pumps + (to - from) * flow;
            seen(self.paths.len() + index, flow);
        }
        powers
    }
}
