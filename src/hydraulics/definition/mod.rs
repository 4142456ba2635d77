//! The definition of a hydraulic actuator: the content of `hydraulics.json`, with all checks.
//!
//! In: the text of the file. Out: a [`HydraulicActuator`] whose numbers are finite and in range; the list of its
//! parameters. It must not know the laws of the circuit, nor FMI. SI units; pressures are gauge, relative to the
//! ambient pressure.
mod circuit;
mod sections;

pub use circuit::{ABOVE_VACUUM, Circuit, Supply, Tank, check_pressure, is_pressure};
use foundation::format::{
    About, DefinitionError, Element, Experiment, Faults, Key, Numbers, Owner, Range, element, keys, number, read_with,
    words,
};
pub use foundation::format::{Role, Visit};
use foundation::variables::Unit;
pub use sections::*;

/// Name of the definition file of a hydraulic actuator.
pub const FILE: &str = "hydraulics.json";

/// The elements of a definition for its schema and reference, next to those of the circuit: the whole first.
pub const ELEMENTS: [Element; 6] = [
    Element::of::<HydraulicActuator>(""),
    Element::of::<About>("about"),
    Element::of::<Actuator>("actuator"),
    Element::of::<Coupling>("coupling"),
    Element::of::<Solver>("solver"),
    Element::of::<Experiment>("experiment"),
];

/// The circuit and its sections, for schema and reference.
pub const CIRCUIT: [Element; 22] = [
    Element::of::<Circuit>("circuit"),
    Element::of::<Supply>("supply"),
    Element::of::<Tank>("tank"),
    Element::of::<Fluid>("fluid"),
    Element::of::<Cylinder>("cylinder"),
    Element::of::<ChamberA>("chamber_a"),
    Element::of::<ChamberB>("chamber_b"),
    Element::of::<Valve>("valve"),
    Element::of::<RestrictorA>("restrictor_a"),
    Element::of::<RestrictorB>("restrictor_b"),
    Element::of::<Check>("check"),
    Element::of::<CushionA>("cushion_a"),
    Element::of::<CushionB>("cushion_b"),
    Element::of::<Relief>("relief"),
    Element::of::<Anticavitation>("anticavitation"),
    Element::of::<Leakage>("leakage"),
    Element::of::<Seal>("seal"),
    Element::of::<Hose>("hose"),
    Element::of::<LockValve>("lock_valve"),
    Element::of::<Command>("command"),
    Element::of::<Accumulator>("accumulator"),
    Element::of::<Pump>("pump"),
];

keys! {
    /// The object `actuator` contains start values of the inputs for the motion of the actuator.
    pub struct Actuator: Copy {
        /// Start value of the input `actuator.length`, the distance between the two attachment points of the actuator
        /// [m], >= 0.
        length: f64 = 0.577 => number(Unit::Metre, Range::NonNegative);
        /// Start value of the input `actuator.speed`, positive if the actuator extends [m/s].
        speed: f64 => number(Unit::MetrePerSecond, Range::Finite);
    }

    /// Settings of the coupling between the actuator FMU and the mechanism FMU.
    pub struct Coupling: Copy {
        /// Start value of the parameter `coupling.mode`. The parameter `coupling.mode` selects the motion of the
        /// actuator within a communication step. `preview`: the FMU predicts the motion. `follow`: the inputs
        /// `actuator.length` and `actuator.speed` prescribe the motion. `delayed`: the FMU predicts the motion, for a
        /// simulation tool that passes every value one step late.
        mode: Mode => Key::PLAIN.parameter(Role::Circuit, "");
    }

    /// Settings of the time integration.
    pub struct Solver: Copy {
        /// Relative tolerance of the time integration of the mechanism [1], 1e-14 to 0.1.
        tolerance: f64 = 1e-9 =>
            number(Unit::One, Range::Tolerance).parameter(Role::Tolerance, "Relative tolerance of the integration");
        /// Largest number of integration steps in one communication step [1]. The value of `max_steps` must be a whole
        /// number.
        max_steps: f64 = 5e4 => number(Unit::One, Range::Count)
            .parameter(Role::Tolerance, "Largest number of integration steps in one communication step");
    }

    /// The file hydraulics.json defines a differential cylinder with servo valve, oil and lines. All numbers in the
    /// file are in SI units. Pressures are relative to the ambient pressure.
    pub struct HydraulicActuator {
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
        /// Hydraulic circuit: supply, valve, cylinder and oil.
        circuit: Circuit;
        /// Start values of the inputs `actuator.length` and `actuator.speed`.
        actuator: Actuator;
        /// Settings of the coupling between the actuator FMU and the mechanism FMU.
        coupling: Coupling;
        /// Settings of the time integration.
        solver: Solver;
        /// Default experiment of the FMU: stop time and step size.
        experiment: Experiment;
    }
}

words! {
    /// Law of a flow between laminar and turbulent flow.
    pub enum Transition {
        /// The flow changes smoothly from laminar to turbulent about `transition_pressure`.
        Smooth = "smooth",
        /// The flow is proportional to the pressure drop below `transition_pressure`, and to its square root above.
        Switch = "switch",
    }

    /// Volume of the oil that makes a chamber elastic.
    pub enum OilVolume {
        /// The volume of the chamber, which changes with the length of the cylinder.
        Changes = "changes",
        /// The dead volume, whatever the length.
        Constant = "constant",
    }

    /// Motion of the actuator within a step.
    pub enum Mode {
        /// The actuator makes the motion that the actuator FMU predicts.
        Preview = "preview",
        /// The inputs `actuator.length` and `actuator.speed` prescribe the motion.
        Follow = "follow",
        /// The actuator makes the predicted motion. The simulation program passes every value one step late.
        Delayed = "delayed",
    }
}

impl Solver {
    fn parameters(&mut self, visit: &mut Visit) {
        Owner { group: None, kind: "", name: "solver", is_rotary: false }.parameters(self, &Some, visit);
    }
}

impl HydraulicActuator {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message with the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let (actuator, faults) = Self::with_faults(text).unwrap_or_else(|faults| (Self::default(), faults));
        faults.first()?;
        Ok(actuator)
    }

    /// Read a definition, with all its faults, keys that nobody knows among them.
    ///
    /// # Errors
    /// All faults for which the text cannot be read as a hydraulic actuator.
    pub fn with_faults(text: &str) -> Result<(Self, Faults), Faults> {
        let mut actuator = Self::default();
        let mut faults = read_with("hydraulic actuator", text, &Numbers::default(), &mut actuator);
        if !faults.are_of_unknown_keys() {
            return Err(faults);
        }
        let mut letters = actuator.name.chars();
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if !letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_') || !letters.all(is_word) {
            let allowed = "a C identifier: ASCII letters, digits and underscores, not starting with a digit";
            faults.push(DefinitionError::value("name", format!("\"{}\"", actuator.name), allowed));
        }
        actuator.find_faults(&mut faults);
        Ok((actuator, faults))
    }

    /// Faults of each number, and of what they must be to each other.
    fn find_faults(&self, faults: &mut Faults) {
        self.circuit.find_faults(faults);
        let mut solver = self.solver;
        solver.parameters(&mut |parameter, value| parameter.check(*value, faults));
        faults.keep(Range::NonNegative.check("actuator.length", self.actuator.length));
        faults.keep(self.about.check());
        faults.keep(self.experiment.check());
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

    /// Call `visit` with every numeric parameter and its value, in the order of the file.
    pub fn parameters(&mut self, visit: &mut Visit) {
        self.circuit.parameters(visit);
        self.solver.parameters(visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foundation::format::written;

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
        let text = written(&mut actuator.clone());
        assert!(text.contains(r#""static":400.0"#), "{text}");
        assert_eq!(read(&text.replace("\"$schema\":null,", "")), Ok(actuator));
    }

    #[test]
    fn an_impossible_circuit_is_refused_with_name_value_and_limit() {
        for (circuit, texts) in [
            (r#""cylinder": { "rod": 0.05 }"#, &["cylinder.rod = 0.05", "cylinder.bore = 0.045"][..]),
            (r#""chamber_a": { "dead_volume": 0 }"#, &["chamber_a.dead_volume = 0", "> 0"]),
            (r#""tank": { "pressure": -2e5 }"#, &["tank.pressure = -200000", "fluid.ambient_pressure is 101325 Pa"]),
            (r#""chamber_b": { "start_pressure": -101325 }"#, &["chamber_b.start_pressure"]),
            (r#""valve": { "clearance": 0 }"#, &["valve.clearance = 0", "> 0"]),
            (r#""valve": { "clearence": 1 }"#, &["circuit.valve.clearence", "no key `clearence`", "`clearance`"]),
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
