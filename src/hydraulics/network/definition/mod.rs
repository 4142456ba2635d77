//! The definition of a hydraulic system: the content of `network.json`, with all checks.
//!
//! In: the text of the file. Out: a [`HydraulicSystem`] whose numbers are in range and whose elements fit together; the
//! list of its parameters. It must not know the laws of the elements, nor FMI. SI units; pressures are gauge, relative
//! to the ambient pressure.
mod choices;
mod connections;
mod cylinders;
mod ports;
mod sections;
mod supply;
mod warnings;

use crate::definition::{Fluid, Leakage, Seal, Solver};
pub use choices::*;
pub use cylinders::*;
use foundation::format::{
    About, DefinitionError, Described, Element, Experiment, Faults, Key, Keyed, Named, Numbers, Owner, Slot, Visit,
    element, keys, read_with,
};
pub use ports::Ports;
pub use sections::*;

/// The elements of a definition for its schema and reference.
pub const ELEMENTS: [Element; 25] = [
    Element::of::<HydraulicSystem>(""),
    Element::of::<About>("about"),
    Element::of::<Fluid>("fluid"),
    Element::of::<Reservoir>("reservoir"),
    Element::of::<Line>("node"),
    Element::of::<Pump>("pump"),
    Element::of::<Accumulator>("accumulator"),
    Element::of::<Resistance>("resistance"),
    Element::of::<Check>("check"),
    Element::of::<Relief>("relief"),
    Element::of::<Priority>("priority"),
    Element::of::<Sequence>("sequence"),
    Element::of::<PilotCheck>("pilot_check"),
    Element::of::<Counterbalance>("counterbalance"),
    Element::of::<PositionValve>("position_valve"),
    Element::of::<Bypass>("bypass"),
    Element::of::<Valve>("valve"),
    Element::of::<Cylinder>("cylinder"),
    Element::of::<Chamber>("chamber"),
    Element::of::<Leakage>("leakage"),
    Element::of::<Seal>("seal"),
    Element::of::<PressureLock>("pressure_lock"),
    Element::of::<Coupling>("coupling"),
    Element::of::<Solver>("solver"),
    Element::of::<Experiment>("experiment"),
];

/// Most components of the state of a network.
pub const MOST_COMPONENTS: usize = 96;
/// Most components of the state of a network in a mechanism, with the volume at the start and the pressure locks.
pub const CAPACITY: usize = 37;
/// Most cylinders.
pub const MOST_CYLINDERS: usize = 12;
/// Most valves.
pub const MOST_VALVES: usize = 16;
/// Most flow paths: flow elements, pumps, and four for each valve.
pub const MOST_PATHS: usize = 96;
/// Integrals over the whole network: three volumes and six energies.
pub const TOTALS: usize = 9;

keys! {
    /// A hydraulic system consists of a pressure supply, lines, valves and cylinders. All numbers in the file are in SI
    /// units. Pressures are relative to the ambient pressure. A port is a point to which elements are connected: a
    /// reservoir, a node, or a chamber of a cylinder (`<cylinder>.a` or `<cylinder>.b`).
    pub struct HydraulicSystem {
        /// Path of the JSON schema. A text editor uses the JSON schema to complete and check the keys. The FMU does not
        /// use the key `$schema`.
        schema as "$schema": Option<String>;
        /// Name of the FMU. The name consists of letters, digits and underscores, and must not start with a digit.
        name: String => element().required();
        /// Description of the model, one line of text.
        description: String;
        /// Author, copyright and licence of the model. The program writes the texts of `about` into the model
        /// description of the FMU.
        about: About => Key::PLAIN.brief();
        /// Oil with entrained air.
        fluid: Fluid;
        /// Reservoirs by name. The pressure of each reservoir is an input of the FMU.
        reservoirs: Named<Reservoir>;
        /// Nodes by name: each node is a line or a gallery with a volume of oil.
        nodes: Named<Line>;
        /// Pumps by name: each pump delivers oil from a port into a node.
        pumps: Named<Pump>;
        /// Gas accumulators by name: each accumulator is connected to a node.
        accumulators: Named<Accumulator>;
        /// Flow resistances by name: each resistance is a restrictor, an orifice or a line.
        resistances: Named<Resistance>;
        /// Check valves by name: each check valve lets oil flow in one direction only.
        checks: Named<Check>;
        /// Relief valves by name: each relief valve limits the pressure at a port.
        reliefs: Named<Relief>;
        /// Priority valves by name: each priority valve opens when its upstream pressure exceeds a stated value.
        priorities: Named<Priority>;
        /// Sequence valves by name: a pilot pressure opens each sequence valve.
        sequences: Named<Sequence>;
        /// Pilot-operated check valves (lock valves) by name.
        pilot_checks: Named<PilotCheck>;
        /// Counterbalance valves by name: each counterbalance valve holds a load until the load pressure and the pilot
        /// pressure open the valve.
        counterbalances: Named<Counterbalance>;
        /// Position valves by name: the position of a cylinder opens each position valve.
        position_valves: Named<PositionValve>;
        /// By-passes (dump valves) by name: each by-pass connects two ports. The opening of a by-pass is an input of
        /// the FMU.
        bypasses: Named<Bypass>;
        /// Directional valves by name, with four ports and three positions.
        valves: Named<Valve>;
        /// Differential cylinders by name: each cylinder moves a mechanism.
        cylinders: Named<Cylinder>;
        /// Locks by name, such as uplocks: oil pressure releases each lock.
        pressure_locks: Named<PressureLock>;
        /// Settings of the coupling between the hydraulic FMU and the mechanisms that its cylinders drive.
        coupling: Coupling;
        /// Settings of the time integration.
        solver: Solver;
        /// Default experiment of the FMU: stop time and step size.
        experiment: Experiment;
    }
}

impl HydraulicSystem {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message with the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let (system, faults) = Self::with_faults(text).unwrap_or_else(|faults| (Self::default(), faults));
        faults.first()?;
        Ok(system)
    }

    /// Read a definition, with all its faults, keys that nobody knows among them.
    ///
    /// # Errors
    /// All faults for which the text cannot be read as a hydraulic system.
    pub fn with_faults(text: &str) -> Result<(Self, Faults), Faults> {
        let mut system = Self::default();
        let mut faults = read_with("hydraulic system", text, &Numbers::default(), &mut system);
        if !faults.are_of_unknown_keys() {
            return Err(faults);
        }
        system.find_faults(&mut faults);
        Ok((system, faults))
    }

    /// Check each number and what the elements must be to each other.
    ///
    /// # Errors
    /// The first fault, with its key, its value and what is allowed.
    pub fn check(&self) -> Result<(), DefinitionError> {
        let mut faults = Faults::default();
        self.find_faults(&mut faults);
        faults.first()
    }

    /// Call `visit` with every numeric parameter of a separate FMU and its value, in the order of the file.
    pub fn parameters(&mut self, visit: &mut Visit) {
        self.visit(&|_| true, &|key| (key.name != "restitution").then_some(key), visit);
    }

    /// Call `visit` with every numeric parameter of the oil and of the elements in a mechanism, and its value, in the
    /// order of the file.
    pub fn element_parameters(&mut self, visit: &mut Visit) {
        self.visit(&|section| section != "solver", &Some, visit);
    }

    fn visit(&mut self, counts: &dyn Fn(&str) -> bool, refine: &dyn Fn(Key) -> Option<Key>, visit: &mut Visit) {
        for (index, key) in Self::TABLE.keys.iter().enumerate().filter(|(_, key)| counts(key.name)) {
            match self.slot(index) {
                Slot::Object(section) => {
                    Owner { group: None, kind: "", name: key.name, is_rotary: false }
                        .parameters(section, refine, visit);
                }
                Slot::Group(group) => {
                    let mut at = 0;
                    while let Some((name, Slot::Object(element))) = group.entry(at) {
                        let kind = kind_of(key.name);
                        Owner { group: Some(key.name), kind, name, is_rotary: false }
                            .parameters(element, refine, visit);
                        at += 1;
                    }
                }
                _ => {}
            }
        }
    }

    /// Faults of each number, of the names, and of the connections.
    fn find_faults(&self, faults: &mut Faults) {
        let mut letters = self.name.chars();
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if !letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_') || !letters.all(is_word) {
            let allowed = "a C identifier: ASCII letters, digits and underscores, not starting with a digit";
            faults.push(DefinitionError::value("name", format!("\"{}\"", self.name), allowed));
        }
        faults.keep(self.about.check());
        faults.keep(self.experiment.check());
        check_ranges(faults, |visit| self.clone().visit(&|section| section == "solver", &Some, visit));
        self.find_element_faults(faults);
    }

    /// Faults of each number and of the connections.
    pub fn find_element_faults(&self, faults: &mut Faults) {
        let before = faults.len();
        check_ranges(faults, |visit| self.clone().element_parameters(visit));
        // Numbers in range are compared.
        if faults.len() == before {
            self.find_connection_faults(faults);
        }
    }

    /// Faults of the connections, if each number is in range.
    pub fn find_connection_faults_in_mechanism(&self, faults: &mut Faults) {
        let mut ranges = Faults::default();
        check_ranges(&mut ranges, |visit| self.clone().element_parameters(visit));
        if ranges.is_empty() {
            self.find_connection_faults(faults);
        }
    }

    /// Check each number and the connections.
    ///
    /// # Errors
    /// The first fault, with its key, its value and what is allowed.
    pub fn check_elements(&self) -> Result<(), DefinitionError> {
        let mut faults = Faults::default();
        self.find_element_faults(&mut faults);
        faults.first()
    }

    /// Start values of inputs become 0, and texts and what has no effect in a mechanism their defaults: the rest is the
    /// structure of the network.
    pub fn clear_in_mechanism(&mut self) {
        let default = Self::default();
        (self.schema, self.description, self.about) = (None, String::new(), About::default());
        (self.coupling, self.solver, self.experiment) = (default.coupling, default.solver, default.experiment);
        self.reservoirs.iter_mut().for_each(|(_, reservoir)| reservoir.pressure = 0.0);
        self.valves.iter_mut().for_each(|(_, valve)| valve.command = 0.0);
        self.bypasses.iter_mut().for_each(|(_, bypass)| bypass.open = 0.0);
        for (_, cylinder) in self.cylinders.iter_mut() {
            cylinder.length = None;
            (cylinder.speed, cylinder.reduced_mass, cylinder.holding_force) = (0.0, 0.0, 0.0);
            (cylinder.lower_limit, cylinder.upper_limit) = (0.0, 0.0);
        }
    }

    /// Calls `visit` with the group and the name of every element, in the order of the file.
    pub fn elements(&self, visit: &mut dyn FnMut(&'static str, &str)) {
        let mut copy = self.clone();
        for (index, key) in Self::TABLE.keys.iter().enumerate() {
            if let Slot::Group(group) = copy.slot(index) {
                let mut at = 0;
                while let Some((name, _)) = group.entry(at) {
                    visit(key.name, name);
                    at += 1;
                }
            }
        }
    }
}

/// What an element of a group is, with article and blank, for descriptions.
pub fn kind_of(group: &str) -> &'static str {
    match group {
        "reservoirs" => "the reservoir ",
        "nodes" => "the node ",
        "pumps" => "the pump ",
        "accumulators" => "the accumulator ",
        "resistances" => "the resistance ",
        "checks" => "the check valve ",
        "reliefs" => "the relief valve ",
        "priorities" => "the priority valve ",
        "sequences" => "the sequence valve ",
        "pilot_checks" => "the pilot-operated check valve ",
        "counterbalances" => "the counterbalance valve ",
        "position_valves" => "the position valve ",
        "bypasses" => "the by-pass ",
        "cylinders" => "the cylinder ",
        "pressure_locks" => "the lock ",
        _ => "the valve ",
    }
}

/// Faults of the numbers that are out of range, each under its key.
fn check_ranges(faults: &mut Faults, parameters: impl FnOnce(&mut Visit)) {
    parameters(&mut |parameter, value| {
        if !parameter.range.contains(*value) {
            faults.keep(parameter.range.check(parameter.key.concat(), *value));
        }
    });
}
