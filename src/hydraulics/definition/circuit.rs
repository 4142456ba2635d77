//! A circuit as a file states it, with all checks.
//!
//! In: its sections. Out: a [`Circuit`] whose numbers are in range and fit each other; its parameters. It must not know
//! laws.
use super::sections::{
    Accumulator, Anticavitation, ChamberA, ChamberB, Check, Command, CushionA, CushionB, Cylinder, Fluid, Hose,
    Leakage, LockValve, Pump, Relief, RestrictorA, RestrictorB, Seal, Valve,
};
use foundation::format::{DefinitionError, Described, Faults, Keyed, Owner, Range, Slot, Visit, keys, number};
use foundation::numerics::decimal::Decimal;
use foundation::variables::Unit;

keys! {
    /// A hydraulic circuit consists of a supply, a tank, a servo valve, a cylinder and oil.
    pub struct Circuit {
        /// Supply. The input `supply.pressure` is the pressure of the supply.
        supply: Supply;
        /// Tank. The input `tank.pressure` is the pressure of the tank.
        tank: Tank;
        /// Oil with entrained air.
        fluid: Fluid;
        /// Differential cylinder.
        cylinder: Cylinder;
        /// Chamber A of the cylinder, on the piston side.
        chamber_a: ChamberA;
        /// Chamber B of the cylinder, on the rod side.
        chamber_b: ChamberB;
        /// Servo valve.
        valve: Valve;
        /// Restrictor in the line of chamber A.
        restrictor_a: RestrictorA;
        /// Restrictor in the line of chamber B.
        restrictor_b: RestrictorB;
        /// Check valves in parallel with restrictors and cushions.
        check: Check;
        /// Cushion of chamber A.
        cushion_a: CushionA;
        /// Cushion of chamber B.
        cushion_b: CushionB;
        /// Relief valves of both chambers.
        relief: Relief;
        /// Anti-cavitation valves of both chambers.
        anticavitation: Anticavitation;
        /// Internal and external leakage of the cylinder.
        leakage: Leakage;
        /// Friction of the piston seals.
        seal: Seal;
        /// Hoses of both chambers.
        hose: Hose;
        /// Lock valve in the line of chamber A.
        lock_valve: LockValve;
        /// Ramp and sine that are added to the input `valve.command`.
        command: Command;
        /// Accumulator at the supply.
        accumulator: Accumulator;
        /// Pump that fills the accumulator.
        pump: Pump;
    }

    /// Hydraulic supply.
    pub struct Supply: Copy {
        /// Start value of the input `supply.pressure`, the pressure of the hydraulic supply [Pa]. The absolute
        /// pressure, which is the stated pressure plus `fluid.ambient_pressure`, must be above 0.
        pressure: f64 = 20.7e6 => number(Unit::Pascal, Range::Finite);
    }

    /// Hydraulic tank (return).
    pub struct Tank: Copy {
        /// Start value of the input `tank.pressure`, the pressure in the tank to which the valve returns oil [Pa]. The
        /// absolute pressure, which is the stated pressure plus `fluid.ambient_pressure`, must be above 0.
        pressure: f64 = 0.35e6 => number(Unit::Pascal, Range::Finite);
    }
}

/// Range of the pressures that are relative to the ambient pressure, in words.
pub const ABOVE_VACUUM: &str =
    "at most 1e12 Pa, and the absolute pressure, which is this value plus fluid.ambient_pressure, must be above 0";
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
        format!("{ABOVE_VACUUM}; fluid.ambient_pressure is {} Pa", Decimal(ambient)),
    ))
}

impl Circuit {
    /// Call `visit` with every parameter and its value, in the order of the file.
    pub fn parameters(&mut self, visit: &mut Visit) {
        for (index, key) in Self::TABLE.keys.iter().enumerate() {
            if let Slot::Object(section) = self.slot(index) {
                Owner { group: None, kind: "", name: key.name, is_rotary: false }.parameters(section, &Some, visit);
            }
        }
    }

    /// Check each number and what they must be to each other.
    ///
    /// # Errors
    /// The first number out of range, with its name, its value and what is allowed.
    pub fn check(&self) -> Result<(), DefinitionError> {
        let mut faults = Faults::default();
        self.find_faults(&mut faults);
        faults.first()
    }

    /// Faults of each number, and of what they must be to each other.
    pub fn find_faults(&self, faults: &mut Faults) {
        let before = faults.len();
        self.clone().parameters(&mut |parameter, value| parameter.check(*value, faults));
        // Numbers in range are compared.
        if faults.len() > before {
            return;
        }
        let cylinder = &self.cylinder;
        if cylinder.rod >= cylinder.bore {
            let allowed =
                format_args!("below cylinder.bore = {} m; otherwise chamber B has no area", Decimal(cylinder.bore));
            faults.push(DefinitionError::value("cylinder.rod", Decimal(cylinder.rod), allowed));
        }
        for (side, hose, dead) in [
            ("a", self.hose.volume_a, self.chamber_a.dead_volume),
            ("b", self.hose.volume_b, self.chamber_b.dead_volume),
        ] {
            if hose > dead {
                let allowed = format_args!(
                    "at most chamber_{side}.dead_volume = {} m3, because the hose volume is part of the dead volume",
                    Decimal(dead)
                );
                faults.push(DefinitionError::value(format!("hose.volume_{side}"), Decimal(hose), allowed));
            }
        }
        for (key, pressure) in [
            ("supply.pressure", self.supply.pressure),
            ("tank.pressure", self.tank.pressure),
            ("chamber_a.start_pressure", self.chamber_a.start_pressure),
            ("chamber_b.start_pressure", self.chamber_b.start_pressure),
            ("accumulator.precharge_pressure", self.accumulator.precharge_pressure),
        ] {
            faults.keep(check_pressure(key, pressure, self.fluid.ambient_pressure));
        }
        let pump = &self.pump;
        let band = LEAST_BAND * (pump.max_pressure.abs() + self.fluid.ambient_pressure);
        if pump.max_pressure - pump.full_pressure < band {
            let allowed = format_args!(
                "larger than pump.full_pressure = {} Pa by at least {} Pa (1e-5 of the absolute pressure), so that \
                 the integration can resolve the fall of the flow",
                Decimal(pump.full_pressure),
                Decimal::rounded(band)
            );
            faults.push(DefinitionError::value("pump.max_pressure", Decimal(pump.max_pressure), allowed));
        }
    }
}
