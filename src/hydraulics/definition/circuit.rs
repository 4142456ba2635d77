//! A circuit as a file states it, with all checks.
//!
//! In: its sections. Out: a [`Circuit`] whose numbers are in range and fit each other; its parameters. It must not know
//! laws.
use super::sections::{
    Accumulator, Anticavitation, ChamberA, ChamberB, Check, Command, CushionA, CushionB, Cylinder, Fluid, Hose,
    Leakage, LockValve, Pump, Relief, RestrictorA, RestrictorB, Seal, Valve,
};
use super::{Ranges, Visit};
use crate::format::DefinitionError;
use crate::numerics::decimal::Decimal;
use serde::{Deserialize, Serialize};

/// A circuit: supply, tank, valve, cylinder and oil.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Circuit {
    /// Supply, whose pressure is an input.
    pub supply: Supply,
    /// Tank, whose pressure is an input.
    pub tank: Tank,
    /// Oil with entrained air.
    pub fluid: Fluid,
    /// Differential cylinder.
    pub cylinder: Cylinder,
    /// Chamber on the side of the piston.
    pub chamber_a: ChamberA,
    /// Chamber on the side of the rod.
    pub chamber_b: ChamberB,
    /// Valve.
    pub valve: Valve,
    /// Restrictor of chamber A.
    pub restrictor_a: RestrictorA,
    /// Restrictor of chamber B.
    pub restrictor_b: RestrictorB,
    /// Check valves.
    pub check: Check,
    /// Cushion of chamber A.
    pub cushion_a: CushionA,
    /// Cushion of chamber B.
    pub cushion_b: CushionB,
    /// Relief valves.
    pub relief: Relief,
    /// Anti-cavitation valves.
    pub anticavitation: Anticavitation,
    /// Leakages.
    pub leakage: Leakage,
    /// Friction of the seals.
    pub seal: Seal,
    /// Hoses.
    pub hose: Hose,
    /// Lock valve.
    pub lock_valve: LockValve,
    /// Command as a function of time.
    pub command: Command,
    /// Accumulator at the supply.
    pub accumulator: Accumulator,
    /// Pump of the accumulator.
    pub pump: Pump,
}

/// Supply.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Supply {
    /// Start value of the input `supply.pressure` [Pa], above -p_0.
    pub pressure: f64,
}

/// Tank.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Tank {
    /// Start value of the input `tank.pressure` [Pa], above -p_0.
    pub pressure: f64,
}

impl Default for Supply {
    fn default() -> Self {
        Self { pressure: 20.7e6 }
    }
}

impl Default for Tank {
    fn default() -> Self {
        Self { pressure: 0.35e6 }
    }
}

/// Range of the pressures that are relative to the ambient pressure, in words.
pub const ABOVE_VACUUM: &str =
    "above -fluid.ambient_pressure, as pressures are relative to the surroundings, and at most 1e12 Pa";
/// Largest pressure [Pa], beyond which a sum of flows and powers means nothing.
const MOST_PRESSURE: f64 = 1e12;
/// Least band of a pump over which its flow falls, as a part of its absolute pressure: less is not resolved by the
/// integration.
const LEAST_BAND: f64 = 1e-5;

/// Whether a gauge pressure [Pa] is one that a port may have under this ambient pressure.
pub fn is_pressure(pressure: f64, ambient: f64) -> bool {
    pressure > -ambient && pressure <= MOST_PRESSURE
}

/// Refuse a gauge pressure [Pa] that oil cannot have under this ambient pressure.
///
/// # Errors
/// The name, the value and what is allowed.
pub fn check_pressure(name: &str, pressure: f64, ambient: f64) -> Result<(), DefinitionError> {
    if is_pressure(pressure, ambient) {
        return Ok(());
    }
    Err(DefinitionError::value(
        name,
        Decimal(pressure),
        format!("{ABOVE_VACUUM}; the former is {} Pa", Decimal(-ambient)),
    ))
}

impl Circuit {
    /// Call `visit` with every parameter and its value, in the order of the file. `roles`: role of the parameters of a
    /// law, and of those of the start.
    pub fn parameters(&mut self, visit: &mut Visit) {
        self.fluid.parameters(visit);
        self.cylinder.parameters(visit);
        self.chamber_a.parameters(visit);
        self.chamber_b.parameters(visit);
        self.valve.parameters(visit);
        self.restrictor_a.parameters(visit);
        self.restrictor_b.parameters(visit);
        self.check.parameters(visit);
        self.cushion_a.parameters(visit);
        self.cushion_b.parameters(visit);
        self.relief.parameters(visit);
        self.anticavitation.parameters(visit);
        self.leakage.parameters(visit);
        self.seal.parameters(visit);
        self.hose.parameters(visit);
        self.lock_valve.parameters(visit);
        self.command.parameters(visit);
        self.accumulator.parameters(visit);
        self.pump.parameters(visit);
    }

    /// Check each number and what they must be to each other.
    ///
    /// # Errors
    /// The first number out of range, with its name, its value and what is allowed.
    pub fn check(&self) -> Result<(), DefinitionError> {
        let mut ranges = Ranges::default();
        self.clone().parameters(&mut |parameter, value| ranges.check(&parameter, *value));
        ranges.0?;
        let cylinder = &self.cylinder;
        if cylinder.rod >= cylinder.bore {
            let allowed = format!("below cylinder.bore = {} m, for chamber B to have an area", Decimal(cylinder.bore));
            return Err(DefinitionError::value("cylinder.rod", Decimal(cylinder.rod), allowed));
        }
        for (side, hose, dead) in [
            ("a", self.hose.volume_a, self.chamber_a.dead_volume),
            ("b", self.hose.volume_b, self.chamber_b.dead_volume),
        ] {
            if hose > dead {
                let allowed =
                    format!("at most chamber_{side}.dead_volume = {} m3, of which it is a part", Decimal(dead));
                return Err(DefinitionError::value(format!("hose.volume_{side}"), Decimal(hose), allowed));
            }
        }
        for (key, pressure) in [
            ("supply.pressure", self.supply.pressure),
            ("tank.pressure", self.tank.pressure),
            ("chamber_a.start_pressure", self.chamber_a.start_pressure),
            ("chamber_b.start_pressure", self.chamber_b.start_pressure),
            ("accumulator.precharge_pressure", self.accumulator.precharge_pressure),
        ] {
            check_pressure(key, pressure, self.fluid.ambient_pressure)?;
        }
        let pump = &self.pump;
        let band = LEAST_BAND * (pump.max_pressure.abs() + self.fluid.ambient_pressure);
        if pump.max_pressure - pump.full_pressure < band {
            let allowed = format!(
                "above pump.full_pressure = {} Pa by at least {} Pa, 1e-5 of it, for the integration to resolve the band \
                 over which the flow falls",
                Decimal(pump.full_pressure),
                Decimal::rounded(band)
            );
            return Err(DefinitionError::value("pump.max_pressure", Decimal(pump.max_pressure), allowed));
        }
        Ok(())
    }
}
