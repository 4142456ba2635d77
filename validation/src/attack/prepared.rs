//! A definition and its model at the start, with the sizes of the values that a history sets.
//!
//! In: the text of a definition. Out: the model with its variables. Must not know how a definition is drawn at random.
use super::random::Random;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Causality, Kind, Reference};

/// A definition, and the sizes of its loads.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Name of the definition's file: a mechanism's or a hydraulic actuator's.
    pub file: &'static str,
    /// The text.
    pub text: String,
    /// A force [N] and a torque [N.m] that move the mechanism noticeably within `h`.
    pub force: f64,
    pub torque: f64,
    /// A communication step in which the motion changes noticeably [s].
    pub h: f64,
}

/// A model at its start, with its variables.
#[derive(Clone, Debug)]
pub struct Prepared {
    pub definition: Definition,
    pub start: Component,
    pub inputs: Vec<Reference>,
    pub locks: Vec<Reference>,
    pub outputs: Vec<Reference>,
    pub flags: Vec<Reference>,
    /// Middle and size of each input's values.
    pub sizes: Vec<[f64; 2]>,
}

impl Prepared {
    /// The model of a definition, at its start.
    pub fn new(definition: Definition) -> Result<Self, String> {
        let mut start = Component::from_definition(definition.file, &definition.text).map_err(|e| e.to_string())?;
        start.initialize().map_err(|e| e.to_string())?;
        Ok(Self::of(definition, start))
    }

    /// The model of a definition, with its variables.
    pub fn of(definition: Definition, start: Component) -> Self {
        let list = start.interface().list();
        let those = |causality: Causality, kind: Kind| -> Vec<Reference> {
            let found = list.iter().zip(0..).filter(|(v, _)| v.causality == causality && v.kind == kind);
            found.map(|(_, reference)| reference).collect()
        };
        let [inputs, outputs] = [Causality::Input, Causality::Output].map(|causality| those(causality, Kind::Real));
        let [locks, flags] = [Causality::Input, Causality::Output].map(|causality| those(causality, Kind::Boolean));
        let sizes = inputs.iter().map(|&input| definition.size(&list[input as usize].name)).collect();
        Self { definition, inputs, locks, outputs, flags, sizes, start }
    }

    /// Whether a circuit drives the mechanism.
    pub fn has_circuit(&self) -> bool {
        self.start.interface().find("chamber_a.pressure").is_some()
    }

    /// The first model from these random numbers that is not rejected, and the number of rejected ones.
    pub fn random(random: &mut Random, definition: fn(&mut Random) -> Definition) -> (Self, u64) {
        let mut refused = 0;
        loop {
            match Self::new(definition(random)) {
                Ok(prepared) => return (prepared, refused),
                Err(_) => refused += 1,
            }
        }
    }
}

impl Definition {
    /// Middle and size of an input's values.
    fn size(&self, name: &str) -> [f64; 2] {
        let hydraulic = size_in_network(self, name).or_else(|| size_in_circuit(self, name));
        if let Some(size) = hydraulic {
            return size;
        }
        let size = match name {
            "airspeed" => 60.0,
            "load_factor" => 5.0,
            name if name.ends_with("demanded_acceleration") => 50.0,
            name if name.contains("torque") => self.torque,
            _ => self.force,
        };
        [0.0, size]
    }
}

/// Middle and size of the values of an input of a circuit or of an actuator; None if it has no such input.
fn size_in_circuit(definition: &Definition, name: &str) -> Option<[f64; 2]> {
    let own = definition.file == "hydraulics.json";
    Some(match name {
        "valve.command" => [0.0, 1.2],
        "supply.pressure" => [1.5e7, 1.4e7],
        "tank.pressure" => [3e5, 5e5],
        "actuator.length" if own => [0.577, 0.2],
        "actuator.speed" if own => [0.0, 0.3],
        "actuator.acceleration" if own => [0.0, 10.0],
        "actuator.reduced_mass" if own => [500.0, 500.0],
        "actuator.reduced_mass_derivative" if own => [0.0, 3000.0],
        "actuator.holding_force" if own => [0.0, definition.force],
        "actuator.holding_force_derivative" if own => [0.0, 3e4],
        "actuator.lower_limit" if own => [0.45, 0.1],
        "actuator.upper_limit" if own => [0.7, 0.1],
        "preview.horizon" if own => [definition.h, 0.5 * definition.h],
        _ => return None,
    })
}

/// Middle and size of the values of an input of a network; None for other kinds of definitions.
fn size_in_network(definition: &Definition, name: &str) -> Option<[f64; 2]> {
    if definition.file != "network.json" {
        return None;
    }
    let part = name.rsplit('.').next().unwrap_or_default();
    Some(match part {
        "pressure" => [2e6, 2e6],
        "command" => [0.0, 1.1],
        "open" => [0.5, 0.5],
        "horizon" => [0.0, 0.02],
        "length" => [0.55, 0.15],
        "speed" if name.contains("pump") || name == "engine.speed" || name == "electric.speed" => [0.5, 0.6],
        "speed" => [0.0, 0.2],
        "acceleration" => [0.0, 5.0],
        "reduced_mass" => [300.0, 300.0],
        "reduced_mass_derivative" => [0.0, 1000.0],
        "lower_limit" => [0.3, 0.2],
        "upper_limit" => [0.6, 0.2],
        _ => [0.0, definition.force],
    })
}
