//! Quantity and nominal value of a variable: `quantity` and `nominal`.
//!
//! In: the variables with their start values, the duration of the default experiment. Out: a word for each unit, and a
//! nominal value for each input and output. The module must not know kinds of model.
//!
//! The rule, also in docs/reference/fmi.md: five sizes follow from the definition, each the largest of its kind.
//!     length L    parameters and inputs in m
//!     time T      the duration of the default experiment
//!     mass M      sum of the masses
//!     force F     inputs in N; inputs in N.m over L; weight M g; inertia M L / T^2; work of the oil p Q T / L
//!     flow Q      parameters in m3/s; pressure p: parameters and inputs of this name
//! A unit kg^a m^b s^c then has the size F^a L^(b-a) T^(c+2a), or M^a L^b without a time. A size that does not follow
//! from the definition is 1 in the unit of its kind.

use linkage_fmu::variables::{Causality, Kind, Unit, Value, Variability, Variable};

/// Weight of a mass [m/s2].
const GRAVITY: f64 = 9.81;

/// Sizes of one model, SI.
#[derive(Clone, Debug)]
pub struct Sizes {
    length: f64,
    time: f64,
    mass: f64,
    force: f64,
    flow: f64,
    /// Largest pressure and largest modulus.
    stresses: [(&'static str, f64); 2],
}

impl Sizes {
    /// Sizes of a model whose default experiment lasts `duration` [s].
    pub fn new(variables: &[Variable], duration: f64) -> Self {
        let given = || {
            variables.iter().filter_map(|variable| match variable.start {
                Some(Value::Real(start)) if start.is_finite() => Some((variable, start.abs())),
                _ => None,
            })
        };
        let largest = |of: &dyn Fn(&Variable) -> bool| {
            let sizes = given().filter(|(variable, _)| of(variable)).map(|(_, size)| size);
            sizes.fold(0.0, f64::max)
        };
        let or_one = |size: f64| if size > 0.0 { size } else { 1.0 };
        let input = |unit: Unit| largest(&|v| v.causality == Causality::Input && v.unit == Some(unit));
        let time = or_one(duration);
        let length = or_one(largest(&|v| v.unit == Some(Unit::Metre)));
        let flow = largest(&|v| v.unit == Some(Unit::CubicMetrePerSecond));
        let mass: f64 = given().filter(|(v, _)| v.unit == Some(Unit::Kilogram)).map(|(_, size)| size).sum();
        let stresses = ["pressure", "modulus"]
            .map(|word| (word, or_one(largest(&|v| v.unit == Some(Unit::Pascal) && v.name.ends_with(word)))));
        let forces = [
            input(Unit::Newton),
            input(Unit::NewtonMetre) / length,
            mass * GRAVITY,
            mass * length / (time * time),
            stresses[0].1 * flow * time / length,
        ];
        let force = or_one(forces.into_iter().fold(0.0, f64::max));
        let mass = if mass > 0.0 { mass } else { force * time * time / length };
        Self { length, time, mass, force, flow, stresses }
    }

    /// Nominal value of an input or output that changes in time, with one digit. None for any other variable.
    pub fn nominal(&self, variable: &Variable) -> Option<f64> {
        let connected = matches!(variable.causality, Causality::Input | Causality::Output);
        if !connected || variable.kind != Kind::Real || variable.variability != Variability::Continuous {
            return None;
        }
        let size = variable.unit.map(|unit| one_digit(self.of(unit, &variable.name)));
        variable.details.nominal.or(size)
    }

    fn of(&self, unit: Unit, name: &str) -> f64 {
        let &Self { length, time, mass, force, flow, stresses } = self;
        let [a, b, c, _] = unit.base().map(|(_, exponent)| i32::from(exponent));
        match unit {
            Unit::Pascal => stresses.iter().find(|(word, _)| name.ends_with(word)).map_or(stresses[0].1, |(_, p)| *p),
            Unit::CubicMetrePerSecond if flow > 0.0 => flow,
            Unit::CubicMetre if flow > 0.0 => flow * time,
            _ if c == 0 => mass.powi(a) * length.powi(b),
            _ => force.powi(a) * length.powi(b - a) * time.powi(c + 2 * a),
        }
    }
}

/// The number rounded to one digit, which has a short text: 0.0432 becomes 0.04.
fn one_digit(size: f64) -> f64 {
    format!("{size:.0e}").parse().unwrap_or(size)
}

/// The quantity of a unit, named as in Modelica's library. None if there is no usual name.
pub fn quantity(unit: Unit) -> Option<&'static str> {
    Some(match unit {
        Unit::Radian => "Angle",
        Unit::RadianPerSecond => "AngularVelocity",
        Unit::RadianPerSecondSquared => "AngularAcceleration",
        Unit::Second => "Time",
        Unit::Metre => "Length",
        Unit::SquareMetre => "Area",
        Unit::MetrePerSecond => "Velocity",
        Unit::MetrePerSecondSquared => "Acceleration",
        Unit::Kilogram => "Mass",
        Unit::KilogramSquareMetre => "MomentOfInertia",
        Unit::KilogramPerCubicMetre => "Density",
        Unit::Newton => "Force",
        Unit::NewtonMetre => "Torque",
        Unit::Joule => "Energy",
        Unit::NewtonPerMetre => "TranslationalSpringConstant",
        Unit::NewtonSecondPerMetre => "TranslationalDampingConstant",
        Unit::NewtonMetrePerRadian => "RotationalSpringConstant",
        Unit::NewtonMetreSecondPerRadian => "RotationalDampingConstant",
        Unit::Hertz => "Frequency",
        Unit::Pascal => "Pressure",
        Unit::CubicMetre => "Volume",
        Unit::CubicMetrePerSecond => "VolumeFlowRate",
        Unit::Watt => "Power",
        Unit::NewtonSecond => "Impulse",
        Unit::KilogramSquareMetrePerSecond => "AngularImpulse",
        Unit::One
        | Unit::PerSecond
        | Unit::KilogramPerMetre
        | Unit::KilogramSquareMetrePerRadian
        | Unit::CubicMetrePerSecondPascal
        | Unit::NewtonPerSecond
        | Unit::NewtonMetrePerSecond
        | Unit::NewtonPerMetreSecond
        | Unit::NewtonMetrePerRadianSecond => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::Workspace;
    use linkage_fmu::component::Component;
    use std::fs;

    fn sizes(name: &str, file: &str) -> (Sizes, Component) {
        let path = Workspace::locate().descriptions().join(name).join("resources").join(file);
        let component = Component::from_definition(file, &fs::read_to_string(path).unwrap()).unwrap();
        (Sizes::new(component.interface().list(), component.experiment().stop_time), component)
    }

    /// The gear: 0.759 m, 0.15 s, masses of 74.56 kg, an actuator of 30 kN, whose force is larger than weight and
    /// inertia.
    #[test]
    fn sizes_of_the_gear_are_those_of_its_definition() {
        let (sizes, gear) = sizes("LandingGearRetraction", "mechanism.json");
        let of = |name: &str| {
            let interface = gear.interface();
            sizes.nominal(interface.get(interface.find(name).unwrap()).unwrap())
        };
        for (name, size) in [
            ("actuator.force", Some(30_000.0)),
            ("wheel.force_x", Some(30_000.0)),
            ("crank.torque", Some(20_000.0)),
            ("crank.angle", Some(1.0)),
            ("crank.speed", Some(7.0)),
            ("crank.acceleration", Some(40.0)),
            ("actuator.length", Some(0.8)),
            ("actuator.speed", Some(5.0)),
            ("actuator.reduced_mass", Some(70.0)),
            ("actuator.reduced_mass_derivative", Some(100.0)),
            ("energy.kinetic", Some(20_000.0)),
            ("crank.mass", None),
            ("upstop.impact_time", None),
        ] {
            assert_eq!(of(name), size, "{name}");
        }
    }

    /// The actuator: 0.412 m, 5 s, flows of 0.15 l/s, a relief pressure of 28 MPa, a bulk modulus of 1.4 GPa.
    #[test]
    fn sizes_of_an_actuator_are_those_of_its_oil() {
        let (sizes, actuator) = sizes("HydraulicActuator", "hydraulics.json");
        let list = actuator.interface().list();
        let of = |name: &str| sizes.nominal(list.iter().find(|variable| variable.name == name).unwrap());
        for (name, size) in [
            ("chamber_a.pressure", 3e7),
            ("chamber_a.bulk_modulus", 1e9),
            ("chamber_b.volume", 7e-4),
            ("actuator.force", 5e4),
            ("power.piston", 4e3),
        ] {
            assert_eq!(of(name), Some(size), "{name}");
        }
    }

    /// Every input and output of every model that changes in time has a nominal value that a host can use.
    #[test]
    fn every_continuous_input_and_output_has_a_size() {
        for folder in Workspace::locate().description_folders().unwrap() {
            let text = fs::read_to_string(folder.join("modelDescription.xml")).unwrap();
            for element in text.split("<ScalarVariable ").skip(1) {
                let (head, rest) = element.split_once('>').unwrap();
                let is_connected =
                    ["causality=\"input\"", "causality=\"output\""].iter().any(|word| head.contains(word));
                if is_connected && head.contains("continuous") {
                    let nominal = rest.split_once("nominal=\"").and_then(|(_, rest)| rest.split_once('"'));
                    let size: f64 = nominal.unwrap_or_else(|| panic!("{head} {rest}")).0.parse().unwrap();
                    assert!(size > 0.0 && size.is_finite(), "{head}");
                }
            }
        }
    }
}
