//! The definition of a hydraulic actuator: the content of `hydraulics.json`, with all checks.
//!
//! In: the text of the file. Out: a [`HydraulicActuator`] whose numbers are finite and in range; the list of its
//! parameters. It must not know the laws of the circuit, nor FMI. SI units; pressures are gauge, relative to the
//! ambient pressure.
use crate::format::{DefinitionError, Experiment, Owner, Parameter, Range, read};
use crate::numerics::decimal::Decimal;
use crate::variables::Unit;
use serde::{Deserialize, Serialize};

/// What a parameter changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The laws of the circuit.
    Law,
    /// The state at the start.
    Start,
    /// The tolerance of the integration.
    Tolerance,
}

/// Function that is called with each parameter and its value.
pub type Visit<'v, R> = dyn FnMut(Parameter<'_, R>, &mut f64) + 'v;

/// Sections of the circuit: each field with its documentation, its value where the file has none, unit, range, the text
/// of its variable, and the index of its role.
macro_rules! sections {
    ($($(#[$doc:meta])* $section:ident $name:literal {
        $($(#[$field_doc:meta])* $field:ident = $value:expr, $unit:ident, $range:ident, $role:literal, $words:literal;)*
    })*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
            #[serde(default, deny_unknown_fields)]
            pub struct $section {
                $($(#[$field_doc])* pub $field: f64,)*
            }

            impl Default for $section {
                fn default() -> Self {
                    Self { $($field: $value,)* }
                }
            }

            impl $section {
                fn parameters<R: Copy>(&mut self, roles: [R; 2], visit: &mut Visit<'_, R>) {
                    let mut list = Owner::new(None, $name, roles[0], visit);
                    $(
                        list.role = roles[$role];
                        list.add(stringify!($field).trim_start_matches("r#"), $words, Unit::$unit, Range::$range, &mut self.$field);
                    )*
                }
            }
        )*
    };
}

sections! {
    /// Oil with entrained air.
    Fluid "fluid" {
        /// Ambient pressure p_0, to which all pressures are relative [Pa], > 0.
        ambient_pressure = 101_325.0, Pascal, Positive, 0, "Ambient pressure";
        /// Bulk modulus of the oil without air [Pa], > 0.
        bulk_modulus = 1.4e9, Pascal, Positive, 0, "Bulk modulus of the oil without air";
        /// Volume of entrained air at ambient pressure per volume of oil [1], >= 0; 0: none.
        air_fraction = 0.005, One, NonNegative, 0, "Entrained air at ambient pressure per volume of oil";
        /// Polytropic exponent n of the entrained air [1], > 0.
        polytropic_exponent = 1.4, One, Positive, 0, "Polytropic exponent of the entrained air";
    }

    /// Differential cylinder.
    Cylinder "cylinder" {
        /// Diameter of the piston [m], > 0.
        bore = 0.045, Metre, Length, 0, "Diameter of the piston";
        /// Diameter of the rod [m], >= 0 and below the bore.
        rod = 0.025, Metre, NonNegative, 0, "Diameter of the rod";
        /// Travel of the piston [m], > 0.
        stroke = 0.330, Metre, Length, 0, "Travel of the piston";
        /// Length of the actuator where the piston rests at the bottom of chamber A [m], >= 0.
        closed_length = 0.412, Metre, NonNegative, 0, "Length of the actuator with the rod in";
        /// Bulk modulus E_cyl of the cylinder's walls, pressure over relative growth of the volume [Pa], >= 0; 0:
        /// rigid.
        wall_modulus = 0.0, Pascal, NonNegative, 0, "Pressure over relative growth of the cylinder, 0 for rigid";
    }

    /// Chamber A, on the side of the piston.
    ChamberA "chamber_a" {
        /// Volume with the rod in, lines included [m3], > 0.
        dead_volume = 6e-5, CubicMetre, Positive, 0, "Volume with the rod in, lines included";
        /// Pressure at the start [Pa], above -p_0.
        start_pressure = 6e6, Pascal, Finite, 1, "Pressure at the start";
    }

    /// Chamber B, on the side of the rod.
    ChamberB "chamber_b" {
        /// Volume with the rod out, lines included [m3], > 0.
        dead_volume = 6e-5, CubicMetre, Positive, 0, "Volume with the rod out, lines included";
        /// Pressure at the start [Pa], above -p_0.
        start_pressure = 11.15e6, Pascal, Finite, 1, "Pressure at the start";
    }

    /// Valve of four ports and three positions, with a spool of second order.
    Valve "valve" {
        /// Flow through one fully open edge at the rated pressure drop [m3/s], > 0.
        rated_flow = 1e-4, CubicMetrePerSecond, Positive, 0, "Flow through one open edge at the rated pressure drop";
        /// Pressure drop of an edge at all rated flows [Pa], > 0.
        rated_pressure_drop = 3.5e6, Pascal, Positive, 0, "Pressure drop of an edge at all rated flows";
        /// Pressure drop d_t between laminar and turbulent flow [Pa], > 0.
        transition_pressure = 1e5, Pascal, Positive, 0, "Pressure drop between laminar and turbulent flow";
        /// Opening by the clearance of the spool, which rounds the edges [1], > 0.
        clearance = 2e-3, One, Positive, 0, "Opening by the clearance of the spool";
        /// Spool position at which an edge opens [1]; negative: underlap.
        overlap = 0.0, One, Finite, 0, "Spool position at which an edge opens";
        /// Natural frequency of the spool [Hz], > 0.
        frequency = 60.0, Hertz, Positive, 0, "Natural frequency of the spool";
        /// Damping ratio of the spool [1], > 0.
        damping_ratio = 0.8, One, Positive, 0, "Damping ratio of the spool";
    }

    /// Restrictor in the line of chamber A, for flow out of it.
    RestrictorA "restrictor_a" {
        /// Flow at the valve's rated pressure drop [m3/s], >= 0; 0: no restrictor.
        rated_flow = 5e-5, CubicMetrePerSecond, NonNegative, 0, "Flow at the rated pressure drop, 0 for none";
    }

    /// Restrictor in the line of chamber B, for flow out of it.
    RestrictorB "restrictor_b" {
        /// Flow at the valve's rated pressure drop [m3/s], >= 0; 0: no restrictor.
        rated_flow = 0.0, CubicMetrePerSecond, NonNegative, 0, "Flow at the rated pressure drop, 0 for none";
    }

    /// Check valves beside restrictors and cushions.
    Check "check" {
        /// Pressure over which a check valve opens [Pa], > 0.
        pressure = 5e4, Pascal, Positive, 0, "Pressure over which a check valve opens";
    }

    /// Cushion at the bottom of chamber A.
    CushionA "cushion_a" {
        /// Travel over which it throttles the flow out of the chamber [m], >= 0; 0: no cushion.
        length = 0.030, Metre, NonNegative, 0, "Travel over which the cushion throttles, 0 for none";
        /// Flow at the valve's rated pressure drop at the end of the travel [m3/s], >= 0; 0: no cushion.
        rated_flow = 1.2e-5, CubicMetrePerSecond, NonNegative, 0, "Flow at the rated pressure drop, 0 for none";
    }

    /// Cushion at the end of chamber B.
    CushionB "cushion_b" {
        /// Travel over which it throttles the flow out of the chamber [m], >= 0; 0: no cushion.
        length = 0.030, Metre, NonNegative, 0, "Travel over which the cushion throttles, 0 for none";
        /// Flow at the valve's rated pressure drop at the end of the travel [m3/s], >= 0; 0: no cushion.
        rated_flow = 1.2e-5, CubicMetrePerSecond, NonNegative, 0, "Flow at the rated pressure drop, 0 for none";
    }

    /// Relief valves of both chambers, into the tank.
    Relief "relief" {
        /// Pressure at which they open [Pa], > 0.
        pressure = 28e6, Pascal, Positive, 0, "Pressure at which the relief valves open";
        /// Pressure over which relief and anti-cavitation valves open [Pa], > 0.
        width = 1e5, Pascal, Positive, 0, "Pressure over which relief and anti-cavitation valves open";
        /// Flow per pressure above the opening pressure [m3/(s Pa)], >= 0.
        conductance = 1e-10, CubicMetrePerSecondPascal, NonNegative, 0, "Conductance of the relief valves";
    }

    /// Anti-cavitation valves of both chambers, from the tank.
    Anticavitation "anticavitation" {
        /// Flow per pressure below that of the tank [m3/(s Pa)], >= 0.
        conductance = 1e-10, CubicMetrePerSecondPascal, NonNegative, 0, "Conductance of the anti-cavitation valves";
    }

    /// Leakages, laminar.
    Leakage "leakage" {
        /// From chamber A to chamber B [m3/(s Pa)], >= 0.
        internal = 2e-13, CubicMetrePerSecondPascal, NonNegative, 0, "Leakage from chamber A to chamber B";
        /// From chamber A to the surroundings [m3/(s Pa)], >= 0.
        external_a = 0.0, CubicMetrePerSecondPascal, NonNegative, 0, "Leakage of chamber A to the surroundings";
        /// From chamber B to the surroundings [m3/(s Pa)], >= 0.
        external_b = 5e-14, CubicMetrePerSecondPascal, NonNegative, 0, "Leakage of chamber B to the surroundings";
    }

    /// Friction of the seals.
    Seal "seal" {
        /// Kinetic friction [N], >= 0.
        coulomb = 250.0, Newton, NonNegative, 0, "Kinetic friction";
        /// Static friction [N], >= 0.
        r#static = 400.0, Newton, NonNegative, 0, "Static friction";
        /// Speed over which static friction falls to kinetic friction [m/s], > 0.
        stribeck_speed = 0.02, MetrePerSecond, Positive, 0, "Speed over which static falls to kinetic friction";
        /// Speed over which friction reverses [m/s], > 0.
        transition_speed = 0.005, MetrePerSecond, Positive, 0, "Speed over which friction reverses";
        /// Viscous friction [N s/m], >= 0.
        viscous = 500.0, NewtonSecondPerMetre, NonNegative, 0, "Viscous friction";
        /// Growth of the kinetic and static friction with the pressure in each chamber [m2], >= 0; 0: none.
        pressure_area = 0.0, SquareMetre, NonNegative, 0, "Growth of the friction with the pressure in each chamber";
    }

    /// Hoses of both chambers.
    Hose "hose" {
        /// Volume of the hose of chamber A, a part of its dead volume [m3], >= 0; 0: none.
        volume_a = 0.0, CubicMetre, NonNegative, 0, "Volume of the hose of chamber A, a part of its dead volume";
        /// Volume of the hose of chamber B, a part of its dead volume [m3], >= 0; 0: none.
        volume_b = 0.0, CubicMetre, NonNegative, 0, "Volume of the hose of chamber B, a part of its dead volume";
        /// Pressure over relative growth of the volume of a hose, E_hose [Pa], > 0.
        modulus = 5e8, Pascal, Positive, 0, "Pressure over relative growth of the volume of a hose";
    }

    /// Lock valve in the line of chamber A: oil leaves the chamber only while p_B > pilot ratio x p_A.
    LockValve "lock_valve" {
        /// Pilot ratio [1], >= 0; 0: no lock valve.
        pilot_ratio = 0.0, One, NonNegative, 0, "Pressure in chamber B over that in chamber A which opens, 0 for none";
        /// Pressure over which it opens [Pa], > 0.
        width = 5e4, Pascal, Positive, 0, "Pressure over which the lock valve opens";
    }

    /// Accumulator between pump and valve.
    Accumulator "accumulator" {
        /// Volume V_0 of the gas at the precharge pressure [m3], >= 0; 0: none, the supply has the pressure of the
        /// input.
        volume = 0.0, CubicMetre, NonNegative, 0, "Volume of the gas at the precharge pressure, 0 for no accumulator";
        /// Pressure of the gas without oil [Pa], above -p_0.
        precharge_pressure = 10e6, Pascal, Finite, 0, "Pressure of the gas without oil";
        /// Polytropic exponent n of the gas [1], > 0.
        polytropic_exponent = 1.4, One, Positive, 0, "Polytropic exponent of the gas";
    }

    /// Pressure-compensated pump that fills the accumulator.
    Pump "pump" {
        /// Flow up to the pressure `full_pressure` [m3/s], >= 0.
        max_flow = 1.5e-4, CubicMetrePerSecond, NonNegative, 0, "Flow at low pressure";
        /// Pressure up to which it gives all its flow [Pa].
        full_pressure = 20e6, Pascal, Finite, 0, "Pressure up to which the pump gives all its flow";
        /// Pressure from which it gives none [Pa], above `full_pressure`.
        max_pressure = 20.7e6, Pascal, Finite, 0, "Pressure from which the pump gives no flow";
    }

    /// Command of the valve as a function of time since the start, added to the input.
    Command "command" {
        /// Height of a ramp that begins at the start [1].
        ramp_amplitude = 0.0, One, Finite, 0, "Height of a ramp of the command from the start";
        /// Duration of the ramp [s], >= 0; 0: a step.
        ramp_time = 0.0, Second, NonNegative, 0, "Duration of the ramp, 0 for a step";
        /// Amplitude of a sine that begins at the start [1].
        sine_amplitude = 0.0, One, Finite, 0, "Amplitude of a sine of the command from the start";
        /// Frequency of the sine [Hz], >= 0.
        sine_frequency = 0.0, Hertz, NonNegative, 0, "Frequency of the sine";
    }
}

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

/// The first parameter out of its range; only that one is named, as names are put together.
struct Ranges(Result<(), DefinitionError>);

impl Default for Ranges {
    fn default() -> Self {
        Self(Ok(()))
    }
}

impl Ranges {
    fn check<R>(&mut self, parameter: &Parameter<'_, R>, value: f64) {
        if self.0.is_ok() && !parameter.range.contains(value) {
            self.0 = parameter.range.check(parameter.name.concat(), value);
        }
    }
}

/// Range of the pressures that are relative to the ambient pressure, in words.
pub const ABOVE_VACUUM: &str = "above -fluid.ambient_pressure, as pressures are relative to the surroundings";

impl Circuit {
    /// Call `visit` with every parameter and its value, in the order of the file. `roles`: role of the parameters of a
    /// law, and of those of the start.
    pub fn parameters<R: Copy>(&mut self, roles: [R; 2], visit: &mut Visit<'_, R>) {
        self.fluid.parameters(roles, visit);
        self.cylinder.parameters(roles, visit);
        self.chamber_a.parameters(roles, visit);
        self.chamber_b.parameters(roles, visit);
        self.valve.parameters(roles, visit);
        self.restrictor_a.parameters(roles, visit);
        self.restrictor_b.parameters(roles, visit);
        self.check.parameters(roles, visit);
        self.cushion_a.parameters(roles, visit);
        self.cushion_b.parameters(roles, visit);
        self.relief.parameters(roles, visit);
        self.anticavitation.parameters(roles, visit);
        self.leakage.parameters(roles, visit);
        self.seal.parameters(roles, visit);
        self.hose.parameters(roles, visit);
        self.lock_valve.parameters(roles, visit);
        self.command.parameters(roles, visit);
    }

    /// Check each number and what they must be to each other.
    ///
    /// # Errors
    /// The first number out of range, with its name, its value and what is allowed.
    pub fn check(&self) -> Result<(), DefinitionError> {
        let mut ranges = Ranges::default();
        self.clone().parameters([(); 2], &mut |parameter, value| ranges.check(&parameter, *value));
        ranges.0?;
        let (cylinder, vacuum) = (&self.cylinder, -self.fluid.ambient_pressure);
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
        ] {
            if !(pressure > vacuum && pressure.is_finite()) {
                let allowed = format!("{ABOVE_VACUUM}; that is {} Pa", Decimal(vacuum));
                return Err(DefinitionError::value(key, Decimal(pressure), allowed));
            }
        }
        Ok(())
    }
}

/// Motion of the actuator that the host gives where it gives none: start values of inputs.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Actuator {
    /// Start value of the input `actuator.length` [m].
    pub length: f64,
    /// Start value of the input `actuator.speed` [m/s].
    pub speed: f64,
}

impl Default for Actuator {
    fn default() -> Self {
        Self { length: 0.577, speed: 0.0 }
    }
}

/// What a step does with the foreseen motion.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// A step keeps the motion that it foresees: one pass.
    #[default]
    Preview,
    /// A step moves by the inputs: two passes, or none.
    Follow,
    /// One pass in a host that hands every value on one step late.
    Delayed,
}

impl Mode {
    /// All modes.
    pub const ALL: [Self; 3] = [Self::Preview, Self::Follow, Self::Delayed];

    /// Word of the mode in the file and in the variable `coupling.mode`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Preview => "preview",
            Self::Follow => "follow",
            Self::Delayed => "delayed",
        }
    }

    /// The mode with this word.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.word() == word)
    }
}

/// Coupling with what the actuator moves.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Coupling {
    /// What a step does with the foreseen motion.
    pub mode: Mode,
}

/// Integration settings.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Solver {
    /// Relative tolerance of the integration [1].
    pub tolerance: f64,
    /// Most steps of the integration in one communication step [1].
    pub max_steps: f64,
}

impl Default for Solver {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_steps: 5e4 }
    }
}

impl Solver {
    fn parameters<R: Copy>(&mut self, role: R, visit: &mut Visit<'_, R>) {
        let mut list = Owner::new(None, "solver", role, visit);
        let words = "Relative tolerance of the integration";
        list.add("tolerance", words, Unit::One, Range::Tolerance, &mut self.tolerance);
        let words = "Most steps of the integration in one communication step";
        list.add("max_steps", words, Unit::One, Range::Count, &mut self.max_steps);
    }
}

/// A hydraulic actuator as the file states it.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct HydraulicActuator {
    /// Location of the schema, for editors; not read here.
    #[serde(rename = "$schema")]
    pub schema: Option<String>,
    /// Name of the model, a C identifier.
    pub name: String,
    /// One line of text.
    #[serde(default)]
    pub description: String,
    /// Supply, valve, cylinder and oil.
    #[serde(default)]
    pub circuit: Circuit,
    /// Accumulator at the supply.
    #[serde(default)]
    pub accumulator: Accumulator,
    /// Pump of the accumulator.
    #[serde(default)]
    pub pump: Pump,
    /// Start values of the motion.
    #[serde(default)]
    pub actuator: Actuator,
    /// Coupling with what the actuator moves.
    #[serde(default)]
    pub coupling: Coupling,
    /// Integration settings.
    #[serde(default)]
    pub solver: Solver,
    /// Default experiment.
    #[serde(default)]
    pub experiment: Experiment,
}

impl HydraulicActuator {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message with the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let actuator: Self = read("hydraulic actuator", text)?;
        let mut letters = actuator.name.chars();
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if !letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_') || !letters.all(is_word) {
            let allowed = "a C identifier: ASCII letters, digits and underscores, not beginning with a digit";
            return Err(DefinitionError::value("name", format!("\"{}\"", actuator.name), allowed));
        }
        actuator.check()?;
        Ok(actuator)
    }

    /// Check each number and what they must be to each other.
    ///
    /// # Errors
    /// The first number out of range, with its name, its value and what is allowed.
    pub fn check(&self) -> Result<(), DefinitionError> {
        self.circuit.check()?;
        let mut ranges = Ranges::default();
        let (mut accumulator, mut pump, mut solver) = (self.accumulator, self.pump, self.solver);
        let check: &mut Visit<'_, ()> = &mut |parameter, value| ranges.check(&parameter, *value);
        accumulator.parameters([(); 2], check);
        pump.parameters([(); 2], check);
        solver.parameters((), check);
        ranges.0?;
        let (pump, vacuum) = (&self.pump, -self.circuit.fluid.ambient_pressure);
        if self.accumulator.precharge_pressure <= vacuum {
            let allowed = format!("{ABOVE_VACUUM}; that is {} Pa", Decimal(vacuum));
            let value = Decimal(self.accumulator.precharge_pressure);
            return Err(DefinitionError::value("accumulator.precharge_pressure", value, allowed));
        }
        if pump.max_pressure <= pump.full_pressure {
            let allowed = format!("above pump.full_pressure = {} Pa", Decimal(pump.full_pressure));
            return Err(DefinitionError::value("pump.max_pressure", Decimal(pump.max_pressure), allowed));
        }
        Range::NonNegative.check("actuator.length", self.actuator.length)?;
        Range::Finite.check("actuator.speed", self.actuator.speed)?;
        self.experiment.check()
    }

    /// Call `visit` with every numeric parameter and its value, in the order of the file.
    pub fn parameters(&mut self, visit: &mut Visit<'_, Role>) {
        self.circuit.parameters([Role::Law, Role::Start], visit);
        self.accumulator.parameters([Role::Law, Role::Start], visit);
        self.pump.parameters([Role::Law, Role::Start], visit);
        self.solver.parameters(Role::Tolerance, visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(json: &str) -> Result<HydraulicActuator, String> {
        HydraulicActuator::from_json(json).map_err(|error| error.to_string())
    }

    #[test]
    fn what_a_file_leaves_out_has_its_default() {
        let actuator = read(r#"{ "name": "A", "circuit": { "chamber_b": { "dead_volume": 1e-5 } } }"#).unwrap();
        let circuit =
            Circuit { chamber_b: ChamberB { dead_volume: 1e-5, start_pressure: 11.15e6 }, ..Circuit::default() };
        assert_eq!(actuator.circuit, circuit);
        let mut names = Vec::new();
        actuator.clone().parameters(&mut |parameter, _| names.push(parameter.name.concat()));
        assert!(names.contains(&"seal.static".to_owned()) && names.contains(&"valve.rated_flow".to_owned()));
        let again: HydraulicActuator = serde_json::from_str(
            &serde_json::to_string(&actuator.circuit)
                .map(|circuit| format!(r#"{{"name": "A", "circuit": {circuit}}}"#))
                .unwrap(),
        )
        .unwrap();
        assert_eq!(again.circuit, actuator.circuit);
    }

    #[test]
    fn an_impossible_circuit_is_refused_with_name_value_and_limit() {
        for (circuit, texts) in [
            (r#""cylinder": { "rod": 0.05 }"#, &["cylinder.rod = 0.05", "cylinder.bore = 0.045"][..]),
            (r#""chamber_a": { "dead_volume": 0 }"#, &["chamber_a.dead_volume = 0", "> 0"]),
            (r#""tank": { "pressure": -2e5 }"#, &["tank.pressure = -200000", "-fluid.ambient_pressure", "-101325 Pa"]),
            (r#""chamber_b": { "start_pressure": -101325 }"#, &["chamber_b.start_pressure"]),
            (r#""valve": { "clearance": 0 }"#, &["valve.clearance = 0", "> 0"]),
            (r#""valve": { "clearence": 1 }"#, &["circuit.valve.clearence", "unknown field"]),
            (r#""fluid": { "air_fraction": -1e-3 }"#, &["fluid.air_fraction = -0.001", ">= 0"]),
        ] {
            let error = read(&format!(r#"{{ "name": "A", "circuit": {{ {circuit} }} }}"#)).unwrap_err();
            assert!(texts.iter().all(|text| error.contains(text)), "{error}");
        }
        assert!(read(r#"{ "name": "1A" }"#).unwrap_err().contains("C identifier"));
        assert!(read(r#"{ "name": "A", "solver": { "tolerance": 0 } }"#).unwrap_err().contains("solver.tolerance"));
        assert!(read(r#"{ "name": "A", "coupling": { "mode": "x" } }"#).unwrap_err().contains("coupling.mode"));
    }
}
