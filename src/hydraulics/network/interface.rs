//! The variables of a network: inputs, outputs, parameters, with units and dependencies.
//!
//! In: a definition. Out: the table of variables with the quantity of each. It must not know the state.
mod tables;

use super::definition::{HydraulicSystem, Mode, kind_of};
use super::layout::{Input, Layout, Part};
use super::outputs::{Ahead, Output};
use foundation::format::Role;
use foundation::variables::{
    Causality, Details, Kind, Member, Reference, Terminal, Unit, Value, Variability, Variable, Variables,
};
use tables::{PARTS, PREVIEW, TOTALS};

/// Quantity of a variable.
pub type Quantity = crate::common::Quantity<Output>;

/// The variables as they come up.
struct Builder<'a> {
    system: &'a HydraulicSystem,
    layout: Layout,
    list: Vec<Variable>,
    quantities: Vec<Quantity>,
    /// Inputs on which flows depend.
    flow: Vec<Reference>,
    /// Inputs on which the foreseen motion depends, but for accelerations. Accelerations are none of them, as a
    /// mechanism's depend on the forces: a host that orders by these lists would find an algebraic loop.
    foreseen: Vec<Reference>,
}

impl Builder<'_> {
    fn push(&mut self, name: String, description: String, quantity: Quantity, row: Row) {
        self.list.push(Variable {
            name,
            description,
            kind: row.kind,
            causality: row.causality,
            variability: row.variability,
            unit: row.unit,
            start: row.start,
            dependencies: row.dependencies,
            details: row.details,
        });
        self.quantities.push(quantity);
    }

    fn input(&mut self, name: String, description: String, unit: Unit, start: f64) {
        let bounds = match name.rsplit_once('.') {
            Some((_, "command")) => [Some(-1.0), Some(1.0)],
            Some((_, "open")) => [Some(0.0), Some(1.0)],
            _ => [None, None],
        };
        let details = Details { bounds, nominal: (start != 0.0).then_some(start.abs()), ..Details::default() };
        let index = self.list.len();
        let row = Row { start: Some(Value::Real(start)), details, ..Row::real(Causality::Input, unit) };
        self.push(name, description, Quantity::Input(index), row);
    }

    fn output(&mut self, name: String, description: String, unit: Unit, output: Output, dependencies: &[Reference]) {
        let row = Row { dependencies: dependencies.to_vec(), ..Row::real(Causality::Output, unit) };
        self.push(name, description, Quantity::Output(output), row);
    }

    fn inputs(&mut self) {
        let system = self.system;
        for (name, one) in system.reservoirs.iter() {
            let text = format!("Pressure of the reservoir {name}, relative to the ambient pressure");
            self.input(format!("{name}.pressure"), text, Unit::Pascal, one.pressure);
        }
        for (name, _) in system.pumps.iter() {
            self.input(
                format!("{name}.speed"),
                format!("Relative speed of the pump {name}: 1 is the full speed, and 0 is off"),
                Unit::One,
                1.0,
            );
        }
        for (name, one) in system.valves.iter() {
            let text =
                format!("Command of the valve {name}, from -1 to 1; a positive command connects the supply to port a");
            self.input(format!("{name}.command"), text, Unit::One, one.command);
        }
        for (name, one) in system.bypasses.iter() {
            self.input(
                format!("{name}.open"),
                format!("Opening of the by-pass {name}, from 0 (closed) to 1 (open)"),
                Unit::One,
                one.open,
            );
        }
        for (name, one) in system.cylinders.iter() {
            let [least, most] = one.lengths();
            for (part, (key, text, unit)) in Part::ALL.into_iter().zip(PARTS) {
                let start = match part {
                    Part::Length => one.length.unwrap_or(0.5 * (least + most)),
                    Part::Speed => one.speed,
                    Part::Mass => one.reduced_mass,
                    Part::Load => one.holding_force,
                    Part::LowerLimit => one.lower_limit,
                    Part::UpperLimit => one.upper_limit,
                    _ => 0.0,
                };
                self.input(format!("{name}.{key}"), text.replace('@', &format!("the cylinder {name}")), unit, start);
            }
        }
        let text = "Size of the next communication step; with the value 0, the FMU assumes the size of the last step"
            .to_owned();
        self.input("preview.horizon".to_owned(), text, Unit::Second, 0.0);
    }

    fn outputs(&mut self) {
        let (system, layout, flow) = (self.system, self.layout, self.flow.clone());
        for (index, (name, _)) in system.nodes.iter().enumerate() {
            let text = format!("Pressure at the node {name}, relative to the ambient pressure");
            self.output(format!("{name}.pressure"), text, Unit::Pascal, Output::Pressure(index), &[]);
        }
        for (index, (name, _)) in system.reservoirs.iter().enumerate() {
            let output = Output::ReservoirFlow(index);
            self.output(
                format!("{name}.flow"),
                format!("Oil flow into the reservoir {name}"),
                Unit::CubicMetrePerSecond,
                output,
                &flow,
            );
        }
        let mut paths = Vec::new();
        system.elements(&mut |group, name| {
            if !matches!(
                group,
                "reservoirs" | "nodes" | "pumps" | "accumulators" | "valves" | "cylinders" | "pressure_locks"
            ) {
                paths.push((kind_of(group), name.to_owned()));
            }
        });
        let valves = 4 * layout.valves;
        let pumps = system.pumps.names().into_iter().map(str::to_owned).enumerate();
        let pumps = pumps.map(|(index, name)| (paths.len() + valves + index, ("the pump ", name))).collect::<Vec<_>>();
        for (index, (kind, name)) in paths.into_iter().enumerate().chain(pumps) {
            let text = format!("Oil flow through {kind}{name}, positive from port `from` to port `to`");
            self.output(format!("{name}.flow"), text, Unit::CubicMetrePerSecond, Output::Flow(index), &flow);
        }
        for (index, (name, valve)) in system.valves.iter().enumerate() {
            let command = [layout.command(index) as Reference];
            let dependencies: &[Reference] = if valve.frequency.is_some() { &[] } else { &command };
            let text = format!("Position of the spool of the valve {name}, from -1 to 1");
            self.output(format!("{name}.position"), text, Unit::One, Output::Spool(index), dependencies);
            for (port, (key, text)) in [
                ("supply_flow", "Oil flow from the supply into the valve"),
                ("return_flow", "Oil flow into the return line from the valve"),
                ("flow_a", "Oil flow out of port a of the valve"),
                ("flow_b", "Oil flow out of port b of the valve"),
            ]
            .into_iter()
            .enumerate()
            {
                let output = Output::ValveFlow(index, port);
                self.output(
                    format!("{name}.{key}"),
                    format!("{text} {name}"),
                    Unit::CubicMetrePerSecond,
                    output,
                    &flow,
                );
            }
        }
        for (index, (name, _)) in system.accumulators.iter().enumerate() {
            let output = Output::OilVolume(index);
            self.output(
                format!("{name}.oil_volume"),
                format!("Oil volume in the accumulator {name}"),
                Unit::CubicMetre,
                output,
                &[],
            );
        }
        for index in 0..layout.cylinders {
            self.cylinder(index);
        }
        for (name, text, unit, output) in TOTALS {
            self.output(name.to_owned(), text.to_owned(), unit, output, &[]);
        }
        for (index, (name, _)) in system.pressure_locks.iter().enumerate() {
            let row = Row {
                kind: Kind::Boolean,
                variability: Variability::Discrete,
                unit: None,
                ..Row::real(Causality::Output, Unit::One)
            };
            let text = format!("True while the lock {name} is engaged; oil pressure releases the lock");
            self.push(format!("{name}.engaged"), text, Quantity::Lock(index), row);
        }
    }

    fn cylinder(&mut self, index: usize) {
        let (system, layout, flow) = (self.system, self.layout, self.flow.clone());
        let Some((name, _)) = system.cylinders.iter().nth(index) else { return };
        let of = |part| layout.of_cylinder(index, part) as Reference;
        let (length, speed) = ([of(Part::Length)], [of(Part::Speed)]);
        let named = |key: &str| format!("{name}.{key}");
        let text = format!("Force of the cylinder {name}, positive in the direction of extension");
        self.output(named("force"), text, Unit::Newton, Output::Force(index), &speed);
        let text = format!("Stiffness of the compressed oil in the cylinder {name}, as a spring along the cylinder");
        self.output(named("stiffness"), text, Unit::NewtonPerMetre, Output::Stiffness(index), &length);
        let text = format!(
            "Derivative of the friction force of the piston seals with respect to the speed of the cylinder {name}"
        );
        self.output(named("damping"), text, Unit::NewtonSecondPerMetre, Output::Damping(index), &speed);
        if layout.is_carried {
            let text =
                format!("Force of an end of the cylinder {name} on the piston, positive in the direction of extension");
            self.output(named("end_force"), text, Unit::Newton, Output::EndForce(index), &[]);
        }
        let text = format!("Position of the piston in the cylinder {name}: 0 is the fully retracted position");
        self.output(named("stroke_position"), text, Unit::Metre, Output::Position(index), &length);
        for (side, letter) in ["a", "b"].into_iter().enumerate() {
            let text = format!("Pressure in chamber {letter} of the cylinder {name}, relative to the ambient pressure");
            let output = Output::Pressure(layout.chamber(index) + side);
            self.output(named(&format!("chamber_{letter}.pressure")), text, Unit::Pascal, output, &[]);
            let text = format!("Oil flow into chamber {letter} of the cylinder {name}");
            let output = Output::ChamberFlow(index, side);
            self.output(named(&format!("chamber_{letter}.flow")), text, Unit::CubicMetrePerSecond, output, &flow);
        }
        let foreseen = self.foreseen.clone();
        let accelerations =
            (0..layout.cylinders).map(|index| layout.of_cylinder(index, Part::Acceleration) as Reference);
        let mut all: Vec<Reference> = foreseen.iter().copied().chain(accelerations).collect();
        all.sort_unstable();
        for (key, text, unit, ahead) in PREVIEW {
            let is_acceleration = matches!(ahead, Ahead::StartAcceleration | Ahead::Acceleration);
            let dependencies = if is_acceleration { &all } else { &foreseen };
            let output = Output::Preview(index, ahead);
            self.output(
                named(&format!("preview.{key}")),
                text.replace('@', &format!("the cylinder {name}")),
                unit,
                output,
                dependencies,
            );
        }
    }

    fn parameters(&mut self) {
        let mut index = 0;
        self.system.clone().parameters(&mut |parameter, value| {
            let tunable = parameter.role == Role::Tolerance;
            let row = Row {
                variability: if tunable { Variability::Tunable } else { Variability::Fixed },
                start: Some(Value::Real(*value)),
                details: Details { bounds: parameter.range.bounds(), ..Details::default() },
                ..Row::real(Causality::Parameter, parameter.unit)
            };
            self.push(parameter.name.concat(), parameter.description.concat(), Quantity::Parameter(index), row);
            index += 1;
        });
        let words = Mode::ALL.map(|mode| format!("\"{}\"", mode.word())).join(" or ");
        let row = Row {
            kind: Kind::Enumeration,
            variability: Variability::Fixed,
            unit: None,
            start: Some(Value::Item(self.system.coupling.mode.word().to_owned())),
            details: Details { items: &Mode::WORDS, ..Details::default() },
            ..Row::real(Causality::Parameter, Unit::One)
        };
        let text = format!(
            "Motion of the cylinders that the FMU uses within a step: {words}; preview: the predicted motion; follow: \
             the motion that the inputs prescribe"
        );
        self.push("coupling.mode".to_owned(), text, Quantity::Mode, row);
    }
}

/// Attributes of a variable.
struct Row {
    kind: Kind,
    causality: Causality,
    variability: Variability,
    unit: Option<Unit>,
    start: Option<Value>,
    dependencies: Vec<Reference>,
    details: Details,
}

impl Row {
    /// Of a continuous Real.
    fn real(causality: Causality, unit: Unit) -> Self {
        Self {
            kind: Kind::Real,
            causality,
            variability: Variability::Continuous,
            unit: Some(unit),
            start: None,
            dependencies: Vec::new(),
            details: Details::default(),
        }
    }
}

/// The variables of a network. Inputs come first: the reference of an input is its index.
pub fn variables(system: &HydraulicSystem) -> (Vec<Variable>, Vec<Quantity>) {
    let mut builder = builder(system, Layout::new(system));
    builder.inputs();
    builder.outputs();
    builder.parameters();
    (builder.list, builder.quantities)
}

/// The inputs that act on the flows of a network, in the order of their indices.
pub fn flow_inputs(system: &HydraulicSystem) -> Vec<Variable> {
    let layout = Layout::new(system);
    let mut builder = builder(system, layout);
    builder.inputs();
    builder.list.truncate(layout.flow_inputs());
    builder.list
}

/// The outputs of a network whose cylinders a mechanism moves, each with its quantity. A dependency is the index of an
/// input as in [`variables`].
pub fn outputs_in_mechanism(system: &HydraulicSystem) -> impl Iterator<Item = (Variable, Quantity)> {
    let mut builder = builder(system, Layout { is_carried: true, ..Layout::new(system) });
    builder.outputs();
    let all = builder.list.into_iter().zip(builder.quantities);
    all.filter(|(_, quantity)| !matches!(quantity, Quantity::Output(Output::Preview(..))))
}

fn builder(system: &HydraulicSystem, layout: Layout) -> Builder<'_> {
    let is_ahead = |input: &usize| !matches!(layout.input(*input), Input::Cylinder(_, Part::Acceleration));
    let lengths = (0..layout.cylinders).map(|index| layout.of_cylinder(index, Part::Length));
    Builder {
        system,
        layout,
        list: Vec::new(),
        quantities: Vec::new(),
        flow: (0..layout.flow_inputs()).chain(lengths).map(|index| index as Reference).collect(),
        foreseen: (0..layout.inputs()).filter(is_ahead).map(|index| index as Reference).collect(),
    }
}

/// The connection of each cylinder with what it moves: force and motion as a drive of a mechanism names them, then the
/// terms of the one element. The force is the mean over the next step, which suits a host that holds it as an input.
pub fn terminals<Q: Copy>(system: &HydraulicSystem, variables: &Variables<Q>) -> Vec<Terminal> {
    let of = |(name, _): (&str, &super::definition::Cylinder)| {
        let find = |key: &str| variables.find(&format!("{name}.{key}"));
        let force = find("preview.force_mean").map(|variable| Member { name: "force".to_owned(), variable });
        let inputs =
            PARTS.iter().filter_map(|(key, ..)| Some(Member { name: (*key).to_owned(), variable: find(key)? }));
        let members = force.into_iter().chain(inputs).collect();
        let description = format!("Force and motion of the cylinder {name}");
        Terminal { name: name.to_owned(), kind: "length".to_owned(), description, members }
    };
    system.cylinders.iter().map(of).collect()
}
