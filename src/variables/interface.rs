//! The interface of a mechanism: every variable with its start value and its true dependencies.
use super::{
    Causality, Kind, Output, Quantity, ReactionPart, Reference, Unit, Value, Variability, Variable, Variables,
};
use crate::definition::{DefinitionError, Mechanism, Parameter, Role};
use crate::linkage::{Freedom, GROUND, Linkage, Point};
use crate::loads::Load;
use crate::reduced::{input_names, loads, markers};

/// What a variable's value follows from; a set of causes.
#[derive(Clone, Copy, Default)]
struct Needs<'a> {
    /// The coordinates at the start: every joint.
    closure: bool,
    /// One joint only, which places the body that states the start.
    joint: Option<usize>,
    /// The stated start position.
    position: bool,
    /// The stated start speed.
    speed: bool,
    /// The kinetic energy of given rates.
    inertia: bool,
    /// Every body's mass and centre of mass, one by one.
    masses: bool,
    /// Sizes of these loads.
    inputs: &'a [usize],
    /// Geometry or constants of these loads.
    loads: &'a [usize],
    /// Place of this marker.
    marker: Option<usize>,
}

/// Depends on where every body is.
const PLACED: Needs<'static> = Needs {
    closure: true,
    joint: None,
    position: true,
    speed: false,
    inertia: false,
    masses: false,
    inputs: &[],
    loads: &[],
    marker: None,
};

/// What a parameter acts on, found by changing it and comparing the resolved linkage.
struct Effect {
    role: Role,
    joints: Vec<bool>,
    inertia: bool,
    masses: bool,
    loads: Vec<bool>,
    markers: Vec<bool>,
}

impl Effect {
    fn meets(&self, needs: &Needs) -> bool {
        match self.role {
            Role::StartPosition => needs.position,
            Role::StartSpeed => needs.speed,
            Role::Tolerance => false,
            Role::Geometry | Role::Inertia | Role::Load => {
                (needs.closure && self.joints.contains(&true))
                    || needs.joint.is_some_and(|j| self.joints[j])
                    || (needs.inertia && self.inertia)
                    || (needs.masses && self.masses)
                    || needs.loads.iter().any(|&l| self.loads[l])
                    || needs.marker.is_some_and(|m| self.markers[m])
            }
        }
    }
}

/// Collects the variables in order.
struct Builder<'a> {
    mechanism: &'a Mechanism,
    linkage: &'a Linkage,
    list: Vec<Variable>,
    quantities: Vec<Quantity>,
    effects: Vec<Effect>,
    parameters: Vec<(Parameter, f64)>,
    loads: Vec<Load>,
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
        let (loads, markers) = (loads(mechanism, &linkage)?, markers(mechanism, &linkage)?);
        let effects = effects(mechanism, &linkage, &parameters, &loads, &markers)?;
        let mut builder = Builder {
            mechanism,
            linkage: &linkage,
            list: Vec::new(),
            quantities: Vec::new(),
            effects,
            parameters,
            loads,
            markers,
        };
        builder.add_inputs();
        builder.add_motion();
        builder.add_reactions();
        builder.add_actuators();
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

/// Change every parameter a little and see what the resolved linkage does.
fn effects(
    mechanism: &Mechanism,
    linkage: &Linkage,
    parameters: &[(Parameter, f64)],
    all_loads: &[Load],
    all_markers: &[Point],
) -> Result<Vec<Effect>, DefinitionError> {
    let mut out = Vec::new();
    for (parameter, value) in parameters {
        let mut changed = mechanism.clone();
        changed.parameters(&mut |p, v| {
            if p.name == parameter.name {
                *v = value * 1.001 + 1e-4;
            }
        });
        let other = Linkage::new(&changed)?;
        // A prismatic joint's angle shows in its second body's.
        let joint = |l: &Linkage, j: usize| (l.joints[j].clone(), l.bodies[l.joints[j].second.body].offset);
        let masses = |l: &Linkage| l.bodies.iter().map(|b| (b.mass, b.center, b.inertia)).collect::<Vec<_>>();
        let kinetic = |l: &Linkage| (0..l.bodies.len()).map(|b| kinetic_constants(l, b)).collect::<Vec<_>>();
        let (other_loads, other_markers) = (loads(&changed, &other)?, markers(&changed, &other)?);
        let moved = masses(linkage) != masses(&other);
        let differs = |(a, b): (&Load, &Load)| a != b || (moved && matches!(a, Load::Gravity(_)));
        // Rounding of the same sum in other terms is no effect.
        let same = |(a, b): (&[f64; 4], &[f64; 4])| a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-12 * x.abs());
        out.push(Effect {
            role: parameter.role,
            joints: (0..linkage.joints.len()).map(|j| joint(linkage, j) != joint(&other, j)).collect(),
            inertia: !kinetic(linkage).iter().zip(&kinetic(&other)).all(same),
            masses: moved,
            loads: all_loads.iter().zip(&other_loads).map(differs).collect(),
            markers: all_markers.iter().zip(&other_markers).map(|(a, b)| a != b).collect(),
        });
    }
    Ok(out)
}

/// What a body's kinetic energy depends on: about its pivot alone if that is fixed, else mass, centre and inertia.
fn kinetic_constants(linkage: &Linkage, body: usize) -> [f64; 4] {
    let b = &linkage.bodies[body];
    let pivot = linkage.joints.iter().filter(|j| j.freedom == Freedom::Turn).find_map(|j| {
        let (first, second) = (j.first, j.second);
        match (first.body, second.body) {
            (GROUND, other) if other == body => Some(second.local),
            (other, GROUND) if other == body => Some(first.local),
            _ => None,
        }
    });
    match pivot {
        Some(pivot) => [b.inertia + b.mass * (b.center - pivot).norm_squared(), 0.0, 0.0, 0.0],
        None => [b.mass, b.center.x, b.center.y, b.inertia],
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
        for (name, a) in m.actuators.iter() {
            starts.push((a.force, Unit::Newton, format!("Force of {name}, positive when it pushes its ends apart")));
        }
        if let Some(g) = &m.gravity {
            starts.push((g.load_factor, Unit::One, "Load factor: gravity as a multiple of free fall".into()));
        }
        for (name, force) in m.forces.iter() {
            for (value, axis) in force.force.iter().zip(["x", "y"]) {
                starts.push((*value, Unit::Newton, format!("External force at {name}, {axis}, mechanism frame")));
            }
        }
        for (_, t) in m.torques.iter() {
            starts.push((t.torque, Unit::NewtonMetre, format!("External torque on {}, anticlockwise", t.on)));
        }
        for (i, (name, (start, unit, description))) in input_names(m).into_iter().zip(starts).enumerate() {
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
        let all: Vec<usize> = (0..self.loads.len()).collect();
        let linkage = self.linkage;
        for (i, body) in linkage.bodies.iter().enumerate().filter(|(_, b)| b.turn.is_some()) {
            let n = &body.name;
            let stated = self.mechanism.start.body.as_ref() == Some(n);
            let units = [Unit::Radian, Unit::RadianPerSecond, Unit::RadianPerSecondSquared];
            let words = ["Angle of the x axis of", "Angular speed of", "Angular acceleration of"];
            self.add_derivatives(n, ["angle", "speed", "acceleration"], words, units, stated, &all, |order| {
                Output::Turn { body: i, order }
            });
        }
        for (coordinate, n) in linkage.coordinates.iter().enumerate().skip(linkage.turns) {
            let stated = self.mechanism.start.joint.as_ref() == Some(n);
            let units = [Unit::Metre, Unit::MetrePerSecond, Unit::MetrePerSecondSquared];
            let words = ["Position along the axis of", "Speed along the axis of", "Acceleration along the axis of"];
            self.add_derivatives(n, ["position", "speed", "acceleration"], words, units, stated, &all, |order| {
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
        all: &[usize],
        output: impl Fn(usize) -> Output,
    ) {
        let needs = [
            Needs { position: true, closure: !stated, ..Needs::default() },
            Needs { position: !stated, closure: !stated, speed: true, ..Needs::default() },
            Needs { speed: true, inertia: true, inputs: all, loads: all, ..PLACED },
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
        let all: Vec<usize> = (0..self.loads.len()).collect();
        let needs = Needs { speed: true, inertia: true, masses: true, inputs: &all, loads: &all, ..PLACED };
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

    fn add_actuators(&mut self) {
        let all: Vec<usize> = (0..self.loads.len()).collect();
        let mechanism = self.mechanism;
        for (load, n) in mechanism.actuators.names().into_iter().enumerate() {
            let own = [load];
            let others: Vec<usize> = all.iter().copied().filter(|i| *i != load).collect();
            let Load::Pair { first, second } = self.loads[load] else { continue };
            let place = Needs { loads: &own, ..self.placing(&[first.body, second.body]) };
            let dynamic = Needs { loads: &own, ..PLACED };
            let needs = [
                place,
                Needs { speed: true, ..place },
                Needs { speed: true, inertia: true, inputs: &all, loads: &all, ..dynamic },
            ];
            let units = [Unit::Metre, Unit::MetrePerSecond, Unit::MetrePerSecondSquared];
            let suffixes = ["length", "speed", "acceleration"];
            let words = ["Length", "Speed of lengthening", "Acceleration of lengthening"];
            for order in 0..3 {
                let name = format!("{n}.{}", suffixes[order]);
                let text = format!("{} of {n}", words[order]);
                self.output(name, text, units[order], Output::Length { load, order }, needs[order]);
            }
            let text = format!("Mass of the mechanism reduced to the length of {n}");
            let output = Output::ReducedMass { load };
            self.output(format!("{n}.reduced_mass"), text, Unit::Kilogram, output, Needs { inertia: true, ..dynamic });
            let text = format!("Force of {n} that holds the mechanism still here under the present loads");
            let needs = Needs { inputs: &others, loads: &all, ..dynamic };
            self.output(format!("{n}.holding_force"), text, Unit::Newton, Output::HoldingForce { load }, needs);
        }
    }

    fn add_markers(&mut self) {
        let mechanism = self.mechanism;
        for (marker, n) in mechanism.markers.names().into_iter().enumerate() {
            let needs = Needs { marker: Some(marker), ..self.placing(&[self.markers[marker].body]) };
            for (axis, suffix) in ["x", "y"].into_iter().enumerate() {
                let text = format!("Position of {n}, {suffix}, mechanism frame");
                self.output(format!("{n}.{suffix}"), text, Unit::Metre, Output::Marker { marker, axis }, needs);
            }
        }
    }

    fn add_energies(&mut self) {
        let gravity: Vec<usize> = self.mechanism.gravity.iter().map(|_| self.mechanism.actuators.len()).collect();
        let moving = Needs { speed: true, inertia: true, ..PLACED };
        let potential = Needs { inputs: &gravity, loads: &gravity, ..PLACED };
        let joule = Unit::Joule;
        self.output("energy.kinetic".into(), "Kinetic energy".into(), joule, Output::Kinetic, moving);
        let text = "Potential energy under the present loads of gravity".into();
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
