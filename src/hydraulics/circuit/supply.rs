//! Accumulator and pump at the supply.
//!
//! In: the pressure of the accumulator, the flow to the valve. Out: the rate of the pressure. It must not know the
//! valve.
use crate::definition::{Accumulator, Pump};
use foundation::numerics::dual::Number;

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
