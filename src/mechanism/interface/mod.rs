//! The interface of a mechanism: every variable with its start value and its true dependencies.
mod drives;
mod needs;

use crate::mechanism::definition::{DefinitionError, Mechanism, Method};
use crate::mechanism::linkage::{Freedom, GROUND, Linkage, Point};
use crate::mechanism::loads::resolved::{Loading, markers};
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::quantity::{Output, Quantity, ReactionPart};
use crate::variables::{Causality, Kind, Reference, Unit, Value, Variability, Variable, Variables};
use needs::{Needs, PLACED, ParameterEffect, effects};

/// Collects the variables in order.
struct Builder<'a> {
    mechanism: &'a Mechanism,
    linkage: &'a Linkage,
    list: Vec<Variable>,
    quantities: Vec<Quantity>,
    /// What each parameter acts on, where somebody asks for the dependencies of initial values.
    effects: Option<Vec<ParameterEffect>>,
    /// Then of each variable: the inputs and the places among the parameters on which its initial value depends.
    initial: Vec<[Vec<Reference>; 2]>,
    loading: Loading,
    markers: Vec<Point>,
}

/// The variables of a mechanism: inputs, outputs, then parameters.
///
/// # Errors
/// Two variables of one name; a definition that does not resolve.
pub fn variables(mechanism: &Mechanism) -> Result<Variables<Quantity>, DefinitionError> {
    let linkage = Linkage::new(mechanism)?;
    let mut builder = Builder::new(mechanism, &linkage)?;
    builder.add_all();
    Variables::new(&mechanism.name, builder.list, builder.quantities).map_err(|twice| {
        let message = "two elements give a variable of this name: rename one".into();
        DefinitionError::Key { key: twice.0, message }
    })
}

/// For each variable of the mechanism, if it is an output: the inputs and parameters on which its initial value
/// depends, ascending. Found by changing every parameter: only who writes a description needs to know.
///
/// # Errors
/// As [`variables`]; a parameter that may not change a little.
pub fn initial_dependencies(mechanism: &Mechanism) -> Result<Vec<Vec<Reference>>, DefinitionError> {
    let linkage = Linkage::new(mechanism)?;
    let mut builder = Builder::new(mechanism, &linkage)?;
    builder.effects = Some(effects(mechanism, &linkage, &builder.loading, &builder.markers)?);
    builder.add_all();
    let parameter = |q: &Quantity| matches!(q, Quantity::Parameter(_) | Quantity::Flag(_) | Quantity::Method);
    let first = builder.quantities.iter().take_while(|q| !parameter(q)).count() as Reference;
    let joined = |[inputs, places]: [Vec<Reference>; 2]| {
        inputs.into_iter().chain(places.into_iter().map(|place| first + place)).collect()
    };
    Ok(builder.initial.into_iter().map(joined).collect())
}

impl<'a> Builder<'a> {
    fn new(mechanism: &'a Mechanism, linkage: &'a Linkage) -> Result<Self, DefinitionError> {
        Ok(Self {
            mechanism,
            linkage,
            list: Vec::new(),
            quantities: Vec::new(),
            effects: None,
            initial: Vec::new(),
            loading: Loading::new(mechanism, linkage)?,
            markers: markers(mechanism, linkage)?,
        })
    }

    fn add_all(&mut self) {
        self.add_inputs();
        self.add_motion();
        self.add_reactions();
        self.add_drives();
        self.add_springs();
        self.add_markers();
        self.add_surfaces();
        self.add_stops();
        self.add_energies();
        self.add_parameters();
    }

    /// What points of these bodies are placed by: the stated start alone if one joint holds the stated body to the ground
    /// and no other body is asked for, else everything.
    fn placing(&self, bodies: &[usize]) -> Needs<'static> {
        let start = &self.mechanism.start;
        let named = |name: &String| self.linkage.carrier(self.mechanism, name).map(|(body, _)| body);
        let joint = self.linkage.joints.iter().position(|j| {
            let ends = [j.first.body, j.second.body];
            let stated = match (&start.body, &start.joint) {
                (Some(name), _) => named(name).filter(|b| j.freedom == Freedom::Revolute && ends.contains(b)),
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
        self.add_output(name, description, Some(unit), Quantity::Output(output), needs);
    }

    fn add_output(&mut self, name: String, description: String, unit: Option<Unit>, quantity: Quantity, needs: Needs) {
        let dependencies: Vec<Reference> = needs.inputs.iter().map(|&i| i as Reference).collect();
        let real = unit.is_some();
        self.list.push(Variable {
            name,
            description,
            kind: if real { Kind::Real } else { Kind::Boolean },
            causality: Causality::Output,
            variability: if real { Variability::Continuous } else { Variability::Discrete },
            unit,
            start: None,
            dependencies,
        });
        self.quantities.push(quantity);
        if let Some(effects) = &self.effects {
            let initial = self.initial_of(quantity, &needs, effects);
            self.initial.push(initial);
        }
    }

    /// Inputs and places among the parameters on which an output's initial value depends.
    fn initial_of(&self, quantity: Quantity, needs: &Needs, effects: &[ParameterEffect]) -> [Vec<Reference>; 2] {
        let stretched = self.stretched(quantity);
        let loads: Vec<usize> = (0..self.loading.base()).collect();
        let all = Needs { speed: true, inertia: true, masses: true, loads: &loads, elasticity: true, ..PLACED };
        let meets = |i: &usize| effects[*i].meets(needs) || (stretched && effects[*i].meets(&all));
        let places = (0..effects.len()).filter(meets).map(|i| i as Reference).collect();
        let mut inputs: Vec<Reference> = needs.inputs.iter().map(|&i| i as Reference).collect();
        if stretched {
            inputs.extend(0..self.loading.inputs.len() as Reference);
            inputs.sort_unstable();
            inputs.dedup();
        }
        [inputs, places]
    }

    /// Whether the rods' stretch at the start, which follows from all that acts there, changes an output. One-element terms
    /// are those of the rigid linkage.
    fn stretched(&self, quantity: Quantity) -> bool {
        self.mechanism.solver.method.is_some()
            && matches!(
                quantity,
                Quantity::Output(
                    Output::Angle { .. }
                        | Output::JointPosition { .. }
                        | Output::Reaction { .. }
                        | Output::Displacement { .. }
                        | Output::SpringForce { .. }
                        | Output::Marker { .. }
                        | Output::Kinetic
                        | Output::Potential
                )
            )
    }

    fn add_inputs(&mut self) {
        let m = self.mechanism;
        let mut starts: Vec<(f64, Unit, String)> = Vec::new();
        for ((name, a), drive) in m.actuators.iter().zip(&self.loading.drives) {
            starts.push(match (drive.is_rotary, &a.joint) {
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
            let unit = if drive.is_rotary { Unit::RadianPerSecondSquared } else { Unit::MetrePerSecondSquared };
            names.push(format!("{}.demanded_acceleration", drive.name));
            starts.push((0.0, unit, format!("Acceleration of {} for which the required drive is told", drive.name)));
        }
        if let Some(air) = &m.air {
            names.push("airspeed".into());
            let text = "Speed at which the air flows past the mechanism's frame".into();
            starts.push((air.airspeed, Unit::MetrePerSecond, text));
        }
        for (i, (name, (start, unit, description))) in names.into_iter().zip(starts).enumerate() {
            let start = (Value::Real(start), Some(unit));
            self.known(name, description, Causality::Input, Variability::Continuous, start, Quantity::Input(i));
        }
        for (i, (name, lock)) in m.locks.iter().enumerate() {
            let description = format!("Whether {name} holds the mechanism when it is at {}", lock.stop);
            let (name, start) = (format!("{name}.engage"), (Value::Boolean(lock.engage), None));
            self.known(name, description, Causality::Input, Variability::Discrete, start, Quantity::Lock(i));
        }
    }

    /// An input or a parameter.
    fn known(
        &mut self,
        name: String,
        description: String,
        causality: Causality,
        variability: Variability,
        (start, unit): (Value, Option<Unit>),
        quantity: Quantity,
    ) {
        self.list.push(Variable {
            name,
            description,
            kind: match start {
                Value::Real(_) => Kind::Real,
                Value::Integer(_) => Kind::Integer,
                Value::Boolean(_) => Kind::Boolean,
                Value::String(_) => Kind::String,
            },
            causality,
            variability,
            unit,
            start: Some(start),
            dependencies: Vec::new(),
        });
        self.quantities.push(quantity);
        if self.effects.is_some() {
            self.initial.push(Default::default());
        }
    }

    /// Positions, speeds and accelerations of the coordinates.
    fn add_motion(&mut self) {
        let (inputs, loads) = self.everything();
        let all = (&inputs[..], &loads[..]);
        let linkage = self.linkage;
        for (i, body) in linkage.bodies.iter().enumerate().filter(|(_, b)| b.angle_coordinate.is_some()) {
            let n = &body.name;
            let stated = self.mechanism.start.body.as_ref() == Some(n);
            let units = [Unit::Radian, Unit::RadianPerSecond, Unit::RadianPerSecondSquared];
            let words = ["Angle of the x axis of", "Angular speed of", "Angular acceleration of"];
            self.add_derivatives(n, ["angle", "speed", "acceleration"], words, units, stated, all, |order| {
                Output::Angle { body: i, order }
            });
        }
        for (coordinate, n) in linkage.coordinates.iter().enumerate().skip(linkage.angles) {
            let stated = self.mechanism.start.joint.as_ref() == Some(n);
            let units = [Unit::Metre, Unit::MetrePerSecond, Unit::MetrePerSecondSquared];
            let words = ["Position along the axis of", "Speed along the axis of", "Acceleration along the axis of"];
            self.add_derivatives(n, ["position", "speed", "acceleration"], words, units, stated, all, |order| {
                Output::JointPosition { coordinate, order }
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
                [name, ".", suffixes[order]].concat(),
                [words[order], " ", name].concat(),
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
            let body = |place: usize| linkage.bodies[place].name.as_str();
            let (n, first, second) = (j.name.as_str(), body(j.first.body), body(j.second.body));
            let parts = [
                ("force_x", ReactionPart::X, "Force, x,", Unit::Newton),
                ("force_y", ReactionPart::Y, "Force, y,", Unit::Newton),
                ("force", ReactionPart::Magnitude, "Magnitude of the force", Unit::Newton),
                ("torque", ReactionPart::Moment, "Moment about the second point", Unit::NewtonMetre),
            ];
            let count = if j.freedom == Freedom::Revolute { 3 } else { 4 };
            for (suffix, part, text, unit) in parts.into_iter().take(count) {
                let description = [text, " that ", first, " exerts on ", second, " in ", n].concat();
                self.output([n, ".", suffix].concat(), description, unit, Output::Reaction { joint, part }, needs);
            }
            let friction_joints = self.loading.friction.as_ref().map_or(&[][..], |f| &f.friction_joints);
            if let Some(friction_joint) = friction_joints.iter().position(|p| p.joint == joint) {
                let (suffix, word, unit) = if j.freedom == Freedom::Revolute {
                    ("friction_torque", "Friction torque", Unit::NewtonMetre)
                } else {
                    ("friction_force", "Friction force along the axis", Unit::Newton)
                };
                let text = [word, " that ", first, " exerts on ", second, " in ", n].concat();
                self.output([n, ".", suffix].concat(), text, unit, Output::Friction { friction_joint }, needs);
            }
        }
    }

    /// Inputs that act on the motion, and all loads.
    fn everything(&self) -> (Vec<usize>, Vec<usize>) {
        let mut inputs: Vec<usize> = (0..self.loading.inputs.len()).collect();
        inputs.extend(self.airspeed());
        inputs.extend(self.locks());
        (inputs, (0..self.loading.loads.len()).collect())
    }

    /// Place of the speed of the air among the inputs.
    fn airspeed(&self) -> Option<usize> {
        self.loading.air.as_ref().map(|_| self.loading.inputs.len() + self.loading.drives.len())
    }

    /// Places of the locks' inputs.
    fn locks(&self) -> std::ops::Range<usize> {
        let first = self.loading.inputs.len() + self.loading.drives.len() + usize::from(self.airspeed().is_some());
        first..first + self.loading.locks.len()
    }

    /// Whether joints have friction, if it is enabled.
    fn rubs(&self) -> bool {
        self.loading.friction.as_ref().is_some_and(|f| !f.friction_joints.is_empty())
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
            self.output(format!("{n}.{pull}"), text, pull_unit, Output::SpringForce { spring: place }, needs);
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
                    let text = [word, " of ", n, ", ", suffix, ", mechanism frame"].concat();
                    let output = Output::Marker { marker, axis, order };
                    self.output([n, ".", prefix, suffix].concat(), text, unit, output, needs);
                }
            }
        }
    }

    fn add_surfaces(&mut self) {
        let Some(air) = self.loading.air.clone() else { return };
        let inputs: Vec<usize> = self.airspeed().into_iter().collect();
        for (place, surface) in air.surfaces.iter().enumerate() {
            let own = [surface.load, surface.load + 1, surface.load + 2];
            let needs = Needs { speed: true, inputs: &inputs, loads: &own, ..self.placing(&[surface.start.body]) };
            let text = format!("Drag on the surface {}, along the flow", surface.name);
            let output = Output::Drag { surface: place };
            self.output(format!("{}.drag", surface.name), text, Unit::Newton, output, needs);
        }
    }

    fn add_stops(&mut self) {
        let (inputs, loads) = self.everything();
        let all = Needs { speed: true, inertia: true, inputs: &inputs, loads: &loads, ..PLACED };
        for (place, stop) in self.loading.stops.clone().into_iter().enumerate() {
            let n = &stop.name;
            let (own, defined) = ([stop.load], self.mechanism.stops.get(n));
            let flag = defined.and_then(|s| s.flag.clone()).unwrap_or_else(|| format!("{n}.reached"));
            let at = match self.loading.loads[stop.load] {
                Load::Torque { body } => Needs { loads: &own, ..self.placing(&[body]) },
                _ => Needs { loads: &own, ..self.placing_load(stop.load) },
            };
            let text = format!("Whether the mechanism is at {n}");
            self.add_output(flag, text, None, Quantity::AtStop(place), at);
            let (suffix, unit) =
                if stop.quantity == "angle" { ("torque", Unit::NewtonMetre) } else { ("force", Unit::Newton) };
            let text = format!("Push of {n} against the mechanism");
            self.output(format!("{n}.{suffix}"), text, unit, Output::Stop { stop: place }, all);
        }
        for (place, lock) in self.loading.locks.clone().into_iter().enumerate() {
            let stop = &self.loading.stops[lock.stop].name;
            let text = format!("Force with which {} holds, positive towards {stop}", lock.name);
            let output = Output::Lock { lock: place };
            self.output(format!("{}.force", lock.name), text, Unit::Newton, output, all);
        }
    }

    fn add_energies(&mut self) {
        let gravity: Vec<usize> = self.loading.gravity.into_iter().collect();
        let stored: Vec<usize> = gravity.iter().copied().chain(self.loading.sized()..self.loading.base()).collect();
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
        let (mut stated, mut places) = (self.mechanism.clone(), 0..);
        let fixed = (Causality::Parameter, Variability::Fixed);
        stated.parameters(&mut |p, value| {
            let (start, place) = ((Value::Real(*value), Some(p.unit)), places.next().unwrap_or_default());
            self.known(p.name(), p.description(), fixed.0, fixed.1, start, Quantity::Parameter(place));
        });
        places = 0..;
        stated.flags(&mut |flag, value| {
            let (start, place) = ((Value::Boolean(*value), None), places.next().unwrap_or_default());
            self.known(flag.name(), flag.description(), fixed.0, fixed.1, start, Quantity::Flag(place));
        });
        if let Some(method) = self.mechanism.solver.method {
            let words = Method::ALL.map(Method::word).join(" or ");
            let text = format!("Formulation of the motion: {words}");
            let start = (Value::String(method.word().into()), None);
            self.known("solver.method".into(), text, fixed.0, fixed.1, start, Quantity::Method);
        }
    }
}
