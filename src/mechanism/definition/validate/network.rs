//! Checks of the hydraulic network of a mechanism: each cylinder moves an actuator of the same name.
//!
//! In: a definition. Out: faults of its network. It must not know laws.
use super::drives::CURVED;
use super::names::entry;
use crate::format::{Described, Faults};
use crate::hydraulics::network::definition::HydraulicSystem;
use crate::inspection::Finding;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::definition::loads::Actuator;
use std::sync::OnceLock;

/// Checks and warnings of hydraulics.
type Checks = (fn(&Mechanism, &mut Faults), fn(&Mechanism, &mut Vec<Finding>));
/// A library that never allows hydraulics does not contain their code.
static CHECKS: OnceLock<Checks> = OnceLock::new();

/// State that definitions may have hydraulics.
pub fn allow_hydraulics() {
    CHECKS.get_or_init(|| (Mechanism::check_network, Mechanism::warn_of_circuit));
}

impl Mechanism {
    /// Faults of the hydraulics.
    pub(super) fn check_hydraulics(&self, faults: &mut Faults) {
        CHECKS.get().into_iter().for_each(|(check, _)| check(self, faults));
    }

    /// Warnings about the hydraulics.
    pub(in crate::mechanism::definition) fn warn_of_hydraulics(&self, all: &mut Vec<Finding>) {
        CHECKS.get().into_iter().for_each(|(_, warn)| warn(self, all));
    }

    /// Path in the file of a fault's key, where those of a network or of a circuit stand in its section.
    pub(in crate::mechanism::definition) fn path_in_file(&self, path: &str) -> String {
        let first = path.split('.').next().unwrap_or_default();
        let is_own = || Self::TABLE.position(first).is_some();
        let is_of_network = || HydraulicSystem::TABLE.position(first).is_some();
        match self.hydraulic_drive() {
            None if self.hydraulics.is_some() && is_of_network() && !is_own() => format!("hydraulics.{path}"),
            Some((_, drive, _)) if !is_own() => format!("actuators.{drive}.hydraulics.{path}"),
            _ => path.to_owned(),
        }
    }

    fn check_network(&self, faults: &mut Faults) {
        let Some(network) = &self.hydraulics else { return };
        if let Some((_, drive, _)) = self.hydraulic_drive() {
            let message = format_args!(
                "actuators.{drive} already has a hydraulic circuit, but a mechanism has a circuit or a network: remove \
                 one of the two"
            );
            faults.refuse("hydraulics", message);
        }
        network.find_connection_faults_in_mechanism(faults);
        faults.keep(network.check_size_in_mechanism());
        for (name, _) in network.cylinders.iter() {
            let key = format!("hydraulics.cylinders.{name}");
            if let Some(actuator) = faults.keep(entry(&key, "actuators", &self.actuators, name)) {
                self.check_cylinder(name, actuator, faults);
            }
        }
        if network.cylinders.is_empty() {
            let message = "the network has no cylinder, so the network moves nothing: add a cylinder with the name of \
                    an actuator";
            faults.refuse("hydraulics.cylinders", message);
        }
    }

    /// Faults of an actuator that a cylinder of the network moves.
    fn check_cylinder(&self, name: &str, actuator: &Actuator, faults: &mut Faults) {
        let mut refuse = |key: &str, message: &str| faults.refuse(format_args!("actuators.{name}{key}"), message);
        if self.turns(actuator) {
            refuse(
                "",
                "a cylinder of the network has this name, and a cylinder moves along a line, so this drive must be \
                 linear: give the keys `first` and `second`, or name a prismatic joint in the key `joint`",
            );
        }
        if self.is_in_slot(actuator) {
            refuse(".joint", &format!("a cylinder of the network has this name, and a cylinder {CURVED}"));
        }
        for (key, is_given) in [
            (".screw", actuator.screw.is_some()),
            (".force", actuator.force.is_some()),
            (".efficiency", actuator.efficiency.is_some()),
            (".backward_efficiency", actuator.backward_efficiency.is_some()),
            (".points", actuator.points.is_some()),
            (".control", actuator.control.is_some()),
        ] {
            if is_given {
                refuse(key, "a cylinder of the network drives this actuator: remove this key");
            }
        }
    }
}

/// Keys of a network that have no effect in a mechanism, as paths.
pub fn idle_keys(network: &HydraulicSystem) -> Vec<String> {
    let default = HydraulicSystem::default();
    let mut all = Vec::new();
    let mut add = |is_given: bool, path: String| all.extend(is_given.then_some(path));
    add(network.solver != default.solver, "solver".into());
    add(network.coupling != default.coupling, "coupling".into());
    for (name, cylinder) in network.cylinders.iter() {
        for (key, is_given) in [
            ("length", cylinder.length.is_some()),
            ("speed", cylinder.speed != 0.0),
            ("reduced_mass", cylinder.reduced_mass != 0.0),
            ("holding_force", cylinder.holding_force != 0.0),
            ("lower_limit", cylinder.lower_limit != 0.0),
            ("upper_limit", cylinder.upper_limit != 0.0),
        ] {
            add(is_given, format!("cylinders.{name}.{key}"));
        }
    }
    all
}
