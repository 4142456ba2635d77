//! Drives with a hydraulic circuit or with a cylinder of a hydraulic network.
//!
//! In: a definition. Out: the laws of its hydraulics, the loads of its cylinders, their rigid ends. It must not know
//! the state.
use super::Loading;
use crate::hydraulics::circuit::Equations;
use crate::hydraulics::definition::Command;
use crate::hydraulics::network::definition::HydraulicSystem;
use crate::hydraulics::network::interface::flow_inputs;
use crate::hydraulics::network::laws::Laws;
use crate::mechanism::definition::{DefinitionError, Limit, Mechanism};
use crate::mechanism::loads::laws::stop::Stop;
use std::sync::OnceLock;

/// A drive with a hydraulic circuit. Its place among the inputs that size loads stays 0.
#[derive(Clone, Debug, PartialEq)]
pub struct HydraulicDrive {
    /// Index of the drive and of its load.
    pub load: usize,
    /// Laws of the circuit.
    pub laws: Equations,
    /// Command of the valve as a function of time, which is added to the input.
    pub command: Command,
    /// Index of the input `valve.command`; the pressures of supply and tank follow.
    pub first_input: usize,
}

/// Drives with the cylinders of a hydraulic network. Their places among the inputs that size loads stay 0.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkDrives {
    /// Indices of the drives and of their loads, in the order of the cylinders.
    pub loads: Vec<usize>,
    /// Laws of the network.
    pub laws: Laws,
    /// Index of the first input of the network; the others follow.
    pub first_input: usize,
    /// Names of these inputs.
    pub inputs: Vec<String>,
    /// Names of the pressure locks.
    pub pressure_locks: Vec<String>,
    /// For each lock of the mechanism the pressure lock of the same name, which operates it.
    pub locks: Vec<Option<usize>>,
}

/// The drive with a circuit and the drives with cylinders of a network, if there are any.
type Drives = (Option<HydraulicDrive>, Option<NetworkDrives>);
/// Resolves them.
type Resolve = fn(&Mechanism, usize) -> Result<Drives, DefinitionError>;
/// A library that never allows hydraulics does not contain their laws.
static RESOLVE: OnceLock<Resolve> = OnceLock::new();

/// The words for hydraulics or states of controllers in a library without their code.
pub const NO_HYDRAULICS: &str = concat!(
    "the library of this FMU is for mechanisms without the keys `hydraulics`, `integral_gain` and \
     `force_time_constant`, but the ",
    "definition contains a hydraulic circuit, a network or one of these keys: build the FMU again from the changed ",
    "definition, with cargo fmu package"
);

/// State that mechanisms may have hydraulics.
pub fn allow_hydraulics() {
    RESOLVE.get_or_init(|| resolve);
}

/// The hydraulic drives of a mechanism, whose inputs begin with this index.
pub(super) fn hydraulic_drives(mechanism: &Mechanism, first_input: usize) -> Result<Drives, DefinitionError> {
    match RESOLVE.get() {
        Some(resolve) => resolve(mechanism, first_input),
        None if mechanism.has_hydraulics() => Err(DefinitionError::key("hydraulics", NO_HYDRAULICS)),
        None => Ok((None, None)),
    }
}

fn resolve(mechanism: &Mechanism, first_input: usize) -> Result<Drives, DefinitionError> {
    let drive = mechanism.hydraulic_drive().map(|(load, _, circuit)| {
        circuit.check()?;
        Ok(HydraulicDrive { load, laws: Equations::new(circuit), command: circuit.command, first_input })
    });
    let network = mechanism.hydraulics.as_ref().map(|network| NetworkDrives::new(network, mechanism, first_input));
    Ok((drive.transpose()?, network))
}

impl NetworkDrives {
    /// The drives that have the names of the cylinders.
    fn new(network: &HydraulicSystem, mechanism: &Mechanism, first_input: usize) -> Self {
        let drive = |name: &str| mechanism.actuators.position(name).unwrap_or(0);
        let pressure_lock = |name: &str| network.pressure_locks.names().into_iter().position(|known| known == name);
        Self {
            loads: network.cylinders.names().into_iter().map(drive).collect(),
            laws: Laws::carried(network),
            first_input,
            inputs: flow_inputs(network).into_iter().map(|input| input.name).collect(),
            pressure_locks: network.pressure_locks.names().into_iter().map(str::to_owned).collect(),
            locks: mechanism.locks.names().into_iter().map(pressure_lock).collect(),
        }
    }
}

/// Number of inputs of a hydraulic circuit: command of the valve, pressures of supply and tank.
pub const PORTS: usize = 3;

impl Loading {
    /// The ends of the cylinders of the hydraulic drives: rigid stops of the lengths of the drives, behind all stops of
    /// the definition.
    pub(super) fn add_ends_of_cylinders(&mut self) {
        for cylinder in 0..self.hydraulic_loads().len() {
            let (Some(laws), load) = (self.cylinder(cylinder), self.hydraulic_loads()[cylinder]) else { continue };
            let (restitution, lengths) = (laws.restitution(), laws.lengths());
            let owner = if self.network.is_some() { self.drives[load].name.as_str() } else { "cylinder" };
            let ends = [("retracted", Limit::Lower), ("extended", Limit::Upper)].into_iter().zip(lengths);
            let stops = ends.map(|((end, limit), value)| Stop {
                name: [owner, ".", end].concat(),
                load,
                limit,
                value,
                quantity: "length",
                enabled: true,
                rigid: true,
                restitution,
                stiffness: 0.0,
                damping: 0.0,
                curve: None,
                of_cylinder: true,
            });
            let stops: Vec<Stop> = stops.collect();
            self.stops.extend(stops);
        }
    }

    /// Loads of the drives with a hydraulic circuit or with a cylinder of a network, in the order of the cylinders.
    pub fn hydraulic_loads(&self) -> &[usize] {
        match (&self.hydraulics, &self.network) {
            (Some(drive), _) => std::slice::from_ref(&drive.load),
            (None, Some(network)) => &network.loads,
            (None, None) => &[],
        }
    }

    /// Laws of a hydraulic cylinder by its index in [`Self::hydraulic_loads`].
    #[inline]
    pub fn cylinder(&self, index: usize) -> Option<&Equations> {
        match (&self.hydraulics, &self.network) {
            (Some(drive), _) => Some(&drive.laws),
            (None, Some(network)) => network.laws.cylinders.get(index).map(|cylinder| &cylinder.laws),
            (None, None) => None,
        }
    }

    /// Index of the first input of the hydraulic circuit or network; None without one.
    pub fn first_port(&self) -> Option<usize> {
        let of_network = || self.network.as_ref().map(|network| network.first_input);
        self.hydraulics.as_ref().map(|drive| drive.first_input).or_else(of_network)
    }
}
