//! The interface of a mechanism: every variable with its start value and its true dependencies.
use super::needs::{Effect, Needs, PLACED, effects};
use super::{
    Causality, Kind, OneElement, Output, Quantity, ReactionPart, Reference, Unit, Value, Variability, Variable,
    Variables,
};
use crate::definition::{DefinitionError, Mechanism, Parameter};
use crate::linkage::{Freedom, GROUND, Linkage, Point};
use crate::loading::{Drive, Loading, markers};
use crate::loads::Load;

/// Collects the variables in order.
struct Builder<'a> {
    mechanism: &'a Mechanism,
    linkage: &'a Linkage,
    list: Vec<Variable>,
    quantities: Vec<Quantity>,
    effects: Vec<Effect>,
    parameters: Vec<(Parameter, f64)>,
    loading: Loading,
    markers: Vec<Point>,
}

impl Variables {
    /// The variables of a mechanism: inputs, outputs, then parameters.
    ///
    /// # Errors
    /// Two variables of one name; a definition that does not resolve.
    pub fn new(mechanism: &Mechanism) -> Result<Self, DefinitionError> {
        let linkage = Linkage::new(mechanism)?;
        let mut parameters = Vec::new();
        mechanism.clone().parameters(&mut |p, value| parameters.push((p, *value)));
        let (loading, markers) = (Loading::new(mechanism, &linkage)?, markers(mechanism, &linkage)?);
        let effects = effects(mechanism, &linkage, &parameters, &loading, &markers)?;
        let mut builder = Builder {
            mechanism,
            linkage: &linkage,
            list: Vec::new(),
            quantities: Vec::new(),
            effects,
            parameters,
            loading,
            markers,
        };
        builder.add_inputs();
        builder.add_motion();
        builder.add_reactions();
        builder.add_drives();
        builder.add_springs();
        builder.add_markers();
        builder.add_energies();
        builder.add_parameters();
        for (i, v) in builder.list.iter().enumerate() {
            if builder.list[..i].iter().any(|other| other.name == v.name) {
                let message = "two elements give a variable of this name: rename one".into();
                return Err(DefinitionError::Key { key: v.name.clone(), message });
            }
        }
        let guid = guid(&mechanism.name, &builder.list);
        Ok(Self { list: builder.list, quantities: builder.quantities, guid })
    }
}

impl Builder<'_> {
    /// What points of these bodies are placed by: the stated start alone if one joint holds the stated body to the ground
    /// and no other body is asked for, else everything.
    fn placing(&self, bodies: &[usize]) -> Needs<'static> {
        let start = &self.mechanism.start;
        let named = |name: &String| self.linkage.carrier(self.mechanism, name).map(|(body, _)| body);
        let joint = self.linkage.joints.iter().position(|j| {
            let ends = [j.first.body, j.second.body];
            let stated = match (&start.body, &start.joint) {
                (Some(name), _) => named(name).filter(|b| j.freedom == Freedom::Turn && ends.contains(b)),
                (None, Some(name)) => ends.into_iter().find(|b| *b != GROUND).filter(|_| j.name == *name),
                (None, None) => None,
            };
            ends.contains(&GROUND) && stated.is_some_and(|s| bodies.iter().all(|b| *b == s || *b == GROUND))
        });
        match joint {
            Some(_) => Needs { joint, position: true, ..Needs::default() },
            None => PLACED,
        }
    }

    fn output(&mut self, name: String, description: String, unit: Unit, output: Output, needs: Needs) {
        let dependencies: Vec<Reference> = needs.inputs.iter().map(|&i| i as Reference).collect();
        self.list.push(Variable {
            name,
            description,
            kind: Kind::Real,
            causality: Causality::Output,
            variability: Variability::Continuous,
            unit: Some(unit),
            start: None,
            initial_dependencies: dependencies.clone(),
            dependencies,
        });
        // References of the parameters are known once all outputs are placed; until then, places among the parameters.
        let places = (0..self.effects.len()).filter(|&i| self.effects[i].meets(&needs));
        let marks: Vec<Reference> = places.map(|i| i as Reference).collect();
        let last = self.list.len() - 1;
        self.list[last].initial_dependencies.extend(marks);
        self.quantities.push(Quantity::Output(output));
    }

    fn add_inputs(&mut self) {
        let m = self.mechanism;
        let mut starts: Vec<(f64, Unit, String)> = Vec::new();
        for ((name, a), drive) in m.actuators.iter().zip(&self.loading.drives) {
            starts.push(match (drive.turns, &a.joint) {
                (true, _) => {
                    let text = format!("Torque of {name}, positive when it turns the second body anticlockwise");
                    (a.torque.unwrap_or(0.0), Unit::NewtonMetre, text)
                }
                (false, Some(joint)) => {
                    let text = format!("Force of {name}, positive along the axis of {joint}");
                    (a.force.unwrap_or(0.0), Unit::Newton, text)
                }
                (false, None) => {
                    let text = format!("Force of {name}, positive when it pushes its ends apart");
                    (a.force.unwrap_or(0.0), Unit::Newton, text)
                }
            });
        }
        if let Some(g) = &m.gravity {
            starts.push((g.load_factor, Unit::One, "Load factor: gravity as a multiple of free fall".into()));
        }
        for (name, force) in m.forces.iter().filter(|(_, f)| !f.constant) {
            for (value, axis) in force.force.iter().zip(["x", "y"]) {
                starts.push((*value, Unit::Newton, format!("External force at {name}, {axis}, mechanism frame")));
            }
        }
        for (_, t) in m.torques.iter().filter(|(_, t)| !t.constant) {
            starts.push((t.torque, Unit::NewtonMetre, format!("External torque on {}, anticlockwise", t.on)));
        }
        let mut names = self.loading.inputs.clone();
        for drive in &self.loading.drives {
            let unit = if drive.turns { Unit::RadianPerSecondSquared } else { Unit::MetrePerSecondSquared };
            names.push(format!("{}.demanded_acceleration", drive.name));
            starts.push((0.0, unit, format!("Acceleration of {} for which the required drive is told", drive.name)));
        }
        for (i, (name, (start, unit, description))) in names.into_iter().zip(starts).enumerate() {
            self.list.push(Variable {
                name,
                description,
                kind: Kind::Real,
                causality: Causality::Input,
                variability: Variability::Continuous,
                unit: Some(unit),
                start: Some(Value::Real(start)),
                dependencies: Vec::new(),
                initial_dependencies: Vec::new(),
            });
            self.quantities.push(Quantity::Input(i));
        }
    }

    /// Positions, speeds and accelerations of the coordinates.
    fn add_motion(&mut self) {
        let (inputs, loads) = self.everything();
        let all = (&inputs[..], &loads[..]);
        let linkage = self.linkage;
        for (i, body) in linkage.bodies.iter().enumerate().filter(|(_, b)| b.turn.is_some()) {
            let n = &body.name;
            let stated = self.mechanism.start.body.as_ref() == Some(n);
            let units = [Unit::Radian, Unit::RadianPerSecond, Unit::RadianPerSecondSquared];
            let words = ["Angle of the x axis of", "Angular speed of", "Angular acceleration of"];
            self.add_derivatives(n, ["angle", "speed", "acceleration"], words, units, stated, all, |order| {
                Output::Turn { body: i, order }
            });
        }
        for (coordinate, n) in linkage.coordinates.iter().enumerate().skip(linkage.turns) {
            let stated = self.mechanism.start.joint.as_ref() == Some(n);
            let units = [Unit::Metre, Unit::MetrePerSecond, Unit::MetrePerSecondSquared];
            let words = ["Position along the axis of", "Speed along the axis of", "Acceleration along the axis of"];
            self.add_derivatives(n, ["position", "speed", "acceleration"], words, units, stated, all, |order| {
                Output::Slide { coordinate, order }
            });
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn add_derivatives(
        &mut self,
        name: &str,
        suffixes: [&str; 3],
        words: [&str; 3],
        units: [Unit; 3],
        stated: bool,
        (inputs, loads): (&[usize], &[usize]),
        output: impl Fn(usize) -> Output,
    ) {
        let needs = [
            Needs { position: true, closure: !stated, ..Needs::default() },
            Needs { position: !stated, closure: !stated, speed: true, ..Needs::default() },
            Needs { speed: true, inertia: true, inputs, loads, ..PLACED },
        ];
        for order in 0..3 {
            self.output(
                format!("{name}.{}", suffixes[order]),
                format!("{} {name}", words[order]),
                units[order],
                output(order),
                needs[order],
            );
        }
    }

    fn add_reactions(&mut self) {
        let (inputs, loads) = self.everything();
        let needs = Needs { speed: true, inertia: true, masses: true, inputs: &inputs, loads: &loads, ..PLACED };
        let linkage = self.linkage;
        for (joint, j) in linkage.joints.iter().enumerate() {
            let (n, first, second) = (&j.name, &linkage.bodies[j.first.body].name, &linkage.bodies[j.second.body].name);
            let parts = [
                ("force_x", ReactionPart::X, "Force, x,", Unit::Newton),
                ("force_y", ReactionPart::Y, "Force, y,", Unit::Newton),
                ("force", ReactionPart::Magnitude, "Magnitude of the force", Unit::Newton),
                ("torque", ReactionPart::Moment, "Moment about the second point", Unit::NewtonMetre),
            ];
            let count = if j.freedom == Freedom::Turn { 3 } else { 4 };
            for (suffix, part, text, unit) in parts.into_iter().take(count) {
                let description = format!("{text} that {first} exerts on {second} in {n}");
                self.output(format!("{n}.{suffix}"), description, unit, Output::Reaction { joint, part }, needs);
            }
        }
    }

    /// Inputs that size loads, and all loads.
    fn everything(&self) -> (Vec<usize>, Vec<usize>) {
        ((0..self.loading.inputs.len()).collect(), (0..self.loading.loads.len()).collect())
    }

    /// What a load's displacement is placed by.
    fn placing_load(&self, load: usize) -> Needs<'static> {
        let joint = |j: usize| [self.linkage.joints[j].first.body, self.linkage.joints[j].second.body];
        match self.loading.loads[load] {
            Load::Pair { first, second } => self.placing(&[first.body, second.body]),
            Load::Couple { first, second } => self.placing(&[first, second]),
            Load::Slide { joint: j } => self.placing(&joint(j)),
            _ => PLACED,
        }
    }

    fn add_drives(&mut self) {
        let (inputs, loads) = self.everything();
        for (place, drive) in self.loading.drives.clone().into_iter().enumerate() {
            let Drive { name: n, turns, efficiency } = drive;
            let slides = !turns && matches!(self.loading.loads[place], Load::Slide { .. });
            let (units, what) = if turns {
                ([Unit::Radian, Unit::RadianPerSecond, Unit::RadianPerSecondSquared], "angle")
            } else {
                (
                    [Unit::Metre, Unit::MetrePerSecond, Unit::MetrePerSecondSquared],
                    if slides { "position" } else { "length" },
                )
            };
            let own = [place];
            let at = Needs { loads: &own, ..self.placing_load(place) };
            let all = Needs { speed: true, inertia: true, inputs: &inputs, loads: &loads, ..PLACED };
            let needs = [at, Needs { speed: true, ..at }, all];
            let words = ["Present", "First derivative of the", "Second derivative of the"];
            for (order, suffix) in [what, "speed", "acceleration"].into_iter().enumerate() {
                let text = format!("{} {what} of {n}", words[order]);
                let output = Output::Displacement { load: place, order };
                self.output(format!("{n}.{suffix}"), text, units[order], output, needs[order]);
            }
            self.add_one_element(&n, place, turns, efficiency.is_some());
        }
    }

    /// The terms of the mechanism reduced to a drive.
    fn add_one_element(&mut self, n: &str, drive: usize, turns: bool, lossy: bool) {
        let (inputs, loads) = self.everything();
        let own = [drive];
        let others: Vec<usize> = inputs.iter().copied().filter(|i| *i != drive).collect();
        let demanded: Vec<usize> = others.iter().copied().chain([self.loading.inputs.len() + drive]).collect();
        // With an efficiency the sign of the drive's power counts: its own force and the speed.
        let sign = |inputs: &[usize]| -> Vec<usize> {
            let mut all: Vec<usize> = inputs.iter().copied().chain(lossy.then_some(drive)).collect();
            all.sort_unstable();
            all
        };
        let (none, others_too) = (sign(&[]), sign(&others));
        let mass = Needs { inertia: true, speed: lossy, inputs: &none, loads: &own, ..PLACED };
        let load = Needs { speed: lossy || self.damped(), inputs: &others_too, loads: &loads, ..PLACED };
        let additional = Needs { speed: true, inertia: true, inputs: &none, loads: &own, ..PLACED };
        let required = Needs { speed: true, inertia: true, inputs: &demanded, loads: &loads, ..PLACED };
        let holding = Needs { inputs: &others, loads: &loads, ..PLACED };
        let (mass_unit, change_unit, unit) = if turns {
            (Unit::KilogramSquareMetre, Unit::KilogramSquareMetrePerRadian, Unit::NewtonMetre)
        } else {
            (Unit::Kilogram, Unit::KilogramPerMetre, Unit::Newton)
        };
        let (inertia, force) = if turns { ("inertia", "torque") } else { ("mass", "force") };
        use OneElement::{
            AdditionalForce, HoldingForce, ReducedMass, ReducedMassDerivative, RequiredForce, StaticLoad,
        };
        for (suffix, text, unit, term, needs) in [
            (format!("reduced_{inertia}"), "Reduced inertia: of the mechanism, at", mass_unit, ReducedMass, mass),
            (
                format!("reduced_{inertia}_derivative"),
                "Derivative of the reduced inertia along",
                change_unit,
                ReducedMassDerivative,
                mass,
            ),
            ("static_load".into(), "Present loads reduced to", unit, StaticLoad, load),
            (
                format!("additional_{force}"),
                "-1/2 speed^2 times the derivative of the reduced inertia of",
                unit,
                AdditionalForce,
                additional,
            ),
            (
                "required_force".into(),
                "Force or torque that the demanded acceleration takes of",
                unit,
                RequiredForce,
                required,
            ),
            (
                format!("holding_{force}"),
                "What holds the mechanism still here, under the present loads, of",
                unit,
                HoldingForce,
                holding,
            ),
        ] {
            let output = Output::OneElement { drive, term };
            self.output(format!("{n}.{suffix}"), format!("{text} {n}"), unit, output, needs);
        }
    }

    fn damped(&self) -> bool {
        self.mechanism.springs.iter().any(|(_, s)| s.damping.is_some())
    }

    fn add_springs(&mut self) {
        for (place, spring) in self.loading.springs.clone().into_iter().enumerate() {
            let own = [spring.load];
            let n = &spring.name;
            let (what, unit, pull, pull_unit) = match self.loading.loads[spring.load] {
                Load::Couple { .. } => ("angle", Unit::Radian, "torque", Unit::NewtonMetre),
                Load::Slide { .. } => ("position", Unit::Metre, "force", Unit::Newton),
                _ => ("length", Unit::Metre, "force", Unit::Newton),
            };
            let at = Needs { loads: &own, ..self.placing_load(spring.load) };
            let output = Output::Displacement { load: spring.load, order: 0 };
            self.output(format!("{n}.{what}"), format!("Present {what} of {n}"), unit, output, at);
            let damped = self.mechanism.springs.get(n).is_some_and(|s| s.damping.is_some());
            let needs = Needs { speed: damped, ..at };
            let text = format!("Pull of {n}: preload, spring and damper");
            self.output(format!("{n}.{pull}"), text, pull_unit, Output::Pull { spring: place }, needs);
        }
    }

    fn add_markers(&mut self) {
        let mechanism = self.mechanism;
        let (inputs, loads) = self.everything();
        for (marker, n) in mechanism.markers.names().into_iter().enumerate() {
            let at = Needs { marker: Some(marker), ..self.placing(&[self.markers[marker].body]) };
            let moving = Needs { speed: true, ..at };
            let all =
                Needs { speed: true, inertia: true, inputs: &inputs, loads: &loads, marker: Some(marker), ..PLACED };
            let orders = [
                ("", "Position", Unit::Metre, at),
                ("velocity_", "Velocity", Unit::MetrePerSecond, moving),
                ("acceleration_", "Acceleration", Unit::MetrePerSecondSquared, all),
            ];
            for (order, (prefix, word, unit, needs)) in orders.into_iter().enumerate() {
                for (axis, suffix) in ["x", "y"].into_iter().enumerate() {
                    let text = format!("{word} of {n}, {suffix}, mechanism frame");
                    let output = Output::Marker { marker, axis, order };
                    self.output(format!("{n}.{prefix}{suffix}"), text, unit, output, needs);
                }
            }
        }
    }

    fn add_energies(&mut self) {
        let gravity: Vec<usize> = self.loading.gravity.into_iter().collect();
        let stored: Vec<usize> =
            gravity.iter().copied().chain(self.loading.sized()..self.loading.loads.len()).collect();
        let moving = Needs { speed: true, inertia: true, ..PLACED };
        let potential = Needs { inputs: &gravity, loads: &stored, ..PLACED };
        let joule = Unit::Joule;
        self.output("energy.kinetic".into(), "Kinetic energy".into(), joule, Output::Kinetic, moving);
        let text = "Potential energy of gravity at the present load factor, and of springs".into();
        self.output("energy.potential".into(), text, joule, Output::Potential, potential);
        let text = "Energy now less energy at the start less work done: the error of the integration".into();
        self.output("energy.drift".into(), text, joule, Output::Drift, Needs::default());
    }

    fn add_parameters(&mut self) {
        let first = self.list.len() as Reference;
        for v in &mut self.list {
            let direct = v.dependencies.len();
            for mark in &mut v.initial_dependencies[direct..] {
                *mark += first;
            }
        }
        for (i, (parameter, value)) in std::mem::take(&mut self.parameters).into_iter().enumerate() {
            self.list.push(Variable {
                name: parameter.name,
                description: parameter.description,
                kind: Kind::Real,
                causality: Causality::Parameter,
                variability: Variability::Fixed,
                unit: Some(parameter.unit),
                start: Some(Value::Real(value)),
                dependencies: Vec::new(),
                initial_dependencies: Vec::new(),
            });
            self.quantities.push(Quantity::Parameter(i));
        }
    }
}

/// FNV-1a with 128 bits over everything that a host can see but start values, in the form of a GUID.
fn guid(name: &str, list: &[Variable]) -> String {
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013B;
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let mut feed = |text: &str| {
        for byte in text.bytes().chain([0]) {
            hash = (hash ^ u128::from(byte)).wrapping_mul(PRIME);
        }
    };
    feed(name);
    for v in list {
        feed(&v.name);
        feed(&format!("{:?} {:?} {:?} {}", v.kind, v.causality, v.variability, v.unit.map_or("", Unit::name)));
    }
    let hex = format!("{hash:032x}");
    format!("{{{}-{}-{}-{}-{}}}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..])
}
