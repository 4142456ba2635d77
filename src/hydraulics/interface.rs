//! The variables of a hydraulic actuator: inputs, outputs, parameters, with units and dependencies.
//!
//! In: a definition. Out: the table of variables with the quantity of each. It must not know the state.
mod dependencies;

use super::common;
use super::definition::{HydraulicActuator, Mode, Role};
use super::inputs::Input::{self, Acceleration, Command, Horizon, Load, LoadDerivative, Mass, MassDerivative};
use super::inputs::Input::{Length, LowerLimit, Speed, Supply, Tank, UpperLimit};
use super::outputs::Output;
use foundation::variables::{
    Causality, Details, Kind, Member, Reference, Terminal, Unit, Value, Variability, Variable, Variables,
};

pub use dependencies::initial_dependencies;

/// Quantity of a variable.
pub type Quantity = common::Quantity<Output>;

/// Beginning of the names of the inputs that tell the motion of the actuator and what it moves; a mechanism's outputs
/// have the same names.
pub const ACTUATOR: &str = "actuator.";

/// Name, text and unit of each input, in the order of [`Input::ALL`].
const INPUT_WORDS: [(&str, &str, Unit); Input::ALL.len()] = [
    (
        "actuator.length",
        "Length of the actuator at the start of a step; within the step, the FMU adds the integral of actuator.speed \
            to this length",
        Unit::Metre,
    ),
    ("actuator.speed", "Speed of the actuator, positive when extending", Unit::MetrePerSecond),
    (
        "actuator.acceleration",
        "Acceleration of the actuator, positive when extending; needed only for time derivatives of outputs; the value \
            0 means that the input is not connected: the FMU then calculates the acceleration from force, load and \
            reduced mass",
        Unit::MetrePerSecondSquared,
    ),
    ("valve.command", "Command of the valve from -1 to 1; a positive command extends the actuator", Unit::One),
    ("supply.pressure", "Pressure of the hydraulic supply, relative to the ambient pressure", Unit::Pascal),
    ("tank.pressure", "Pressure in the tank, relative to the ambient pressure", Unit::Pascal),
    (
        "actuator.reduced_mass",
        "Mass of the moved mechanism, reduced to the actuator; the value 0 means that the mass is not known: the FMU \
            then predicts no motion",
        Unit::Kilogram,
    ),
    (
        "actuator.reduced_mass_derivative",
        "Derivative of actuator.reduced_mass with respect to actuator.length",
        Unit::KilogramPerMetre,
    ),
    (
        "actuator.holding_force",
        "Actuator force that would hold the moved mechanism at rest, positive if the actuator pushes",
        Unit::Newton,
    ),
    (
        "actuator.holding_force_derivative",
        "Derivative of actuator.holding_force with respect to actuator.length; the value 0 means that the derivative \
            is not known",
        Unit::NewtonPerMetre,
    ),
    (
        "preview.horizon",
        "Size of the next communication step; with the value 0, the FMU assumes the size of the last steps",
        Unit::Second,
    ),
    (
        "actuator.lower_limit",
        "Smallest actuator length that the stops of the mechanism allow; while a stop or lock prevents retraction, the \
            limit is the present length",
        Unit::Metre,
    ),
    (
        "actuator.upper_limit",
        "Largest actuator length that the stops of the mechanism allow; while a stop or lock prevents extension, the \
            limit is the present length; the value 0 means that the limit is not known",
        Unit::Metre,
    ),
];

/// Inputs that the acceleration at the beginning of the foreseen motion depends on: it is that of the element under the
/// present force; without a mass, that of the input.
const START_ACCELERATION: &[Input] = &[Length, Speed, Acceleration, Mass, MassDerivative, Load, LowerLimit, UpperLimit];
/// Inputs that the acceleration at its end depends on: where no motion is foreseen, it is that of the input.
const FORESEEN_ACCELERATION: &[Input] = &Input::ALL;
/// Inputs that all other outputs of the foreseen motion depend on. The acceleration is none of them, as the mechanism's
/// depends on the force: a host that orders by these lists would find an algebraic loop.
const FORESEEN: &[Input] = &[
    Length,
    Speed,
    Command,
    Supply,
    Tank,
    Mass,
    MassDerivative,
    Load,
    LoadDerivative,
    Horizon,
    LowerLimit,
    UpperLimit,
];
/// Inputs that flows depend on.
const FLOW: &[Input] = &[Length, Supply, Tank];

/// Name, text, unit and quantity of each output, and the inputs on which its present value depends.
const OUTPUTS: &[(&str, &str, Unit, Output, &[Input])] = &[
    (
        "actuator.force",
        "Force of the actuator, positive in the direction of extension",
        Unit::Newton,
        Output::Force,
        &[Speed],
    ),
    (
        "actuator.stiffness",
        "Stiffness of the compressed oil in the cylinder, as a spring along the actuator",
        Unit::NewtonPerMetre,
        Output::Stiffness,
        &[Length],
    ),
    (
        "actuator.damping",
        "Derivative of the friction force of the piston seals with respect to actuator.speed",
        Unit::NewtonSecondPerMetre,
        Output::Damping,
        &[Speed],
    ),
    (
        "preview.force",
        "Predicted actuator force at the start of the next step; the predicted force changes linearly over the step, \
            at the rate preview.force_rate",
        Unit::Newton,
        Output::PreviewForce,
        FORESEEN,
    ),
    (
        "preview.force_rate",
        "Rate of change of the predicted actuator force over the next step",
        Unit::NewtonPerSecond,
        Output::PreviewForceRate,
        FORESEEN,
    ),
    (
        "preview.force_mean",
        "Predicted force of the actuator, averaged over the next step; connect this output to a force input that is \
         constant within a step",
        Unit::Newton,
        Output::PreviewForceMean,
        FORESEEN,
    ),
    (
        "preview.length",
        "Predicted length of the actuator at the end of the next step",
        Unit::Metre,
        Output::PreviewLength,
        FORESEEN,
    ),
    (
        "preview.speed",
        "Predicted speed of the actuator at the end of the next step",
        Unit::MetrePerSecond,
        Output::PreviewSpeed,
        FORESEEN,
    ),
    (
        "preview.start_acceleration",
        "Predicted acceleration of the actuator at the start of the next step",
        Unit::MetrePerSecondSquared,
        Output::PreviewStartAcceleration,
        START_ACCELERATION,
    ),
    (
        "preview.acceleration",
        "Predicted acceleration of the actuator at the end of the next step",
        Unit::MetrePerSecondSquared,
        Output::PreviewAcceleration,
        FORESEEN_ACCELERATION,
    ),
    (
        "chamber_a.pressure",
        "Pressure in chamber A of the cylinder, relative to the ambient pressure",
        Unit::Pascal,
        Output::Pressure(0),
        &[],
    ),
    ("chamber_a.flow", "Oil flow into chamber A of the cylinder", Unit::CubicMetrePerSecond, Output::Flow(0), FLOW),
    ("chamber_a.volume", "Oil volume in chamber A of the cylinder", Unit::CubicMetre, Output::Volume(0), &[Length]),
    (
        "chamber_a.bulk_modulus",
        "Effective bulk modulus of chamber A of the cylinder: oil with air, hose and walls",
        Unit::Pascal,
        Output::BulkModulus(0),
        &[Length],
    ),
    (
        "chamber_b.pressure",
        "Pressure in chamber B of the cylinder, relative to the ambient pressure",
        Unit::Pascal,
        Output::Pressure(1),
        &[],
    ),
    ("chamber_b.flow", "Oil flow into chamber B of the cylinder", Unit::CubicMetrePerSecond, Output::Flow(1), FLOW),
    ("chamber_b.volume", "Oil volume in chamber B of the cylinder", Unit::CubicMetre, Output::Volume(1), &[Length]),
    (
        "chamber_b.bulk_modulus",
        "Effective bulk modulus of chamber B of the cylinder: oil with air, hose and walls",
        Unit::Pascal,
        Output::BulkModulus(1),
        &[Length],
    ),
    (
        "valve.position",
        "Position of the valve spool: 1 is fully open for extension, and -1 is fully open for retraction",
        Unit::One,
        Output::SpoolPosition,
        &[],
    ),
    (
        "valve.speed",
        "Speed of the valve spool: time derivative of valve.position",
        Unit::PerSecond,
        Output::SpoolSpeed,
        &[],
    ),
    (
        "accumulator.pressure",
        "Pressure at the supply side of the valve: pressure of the accumulator, or supply.pressure if there is no \
         accumulator",
        Unit::Pascal,
        Output::SupplyPressure,
        &[Supply],
    ),
    (
        "supply.flow",
        "Oil flow out of the hydraulic supply",
        Unit::CubicMetrePerSecond,
        Output::SupplyFlow,
        &[Length, Supply],
    ),
    (
        "tank.flow",
        "Oil flow from the valve and the chambers into the tank",
        Unit::CubicMetrePerSecond,
        Output::TankFlow,
        &[Length, Tank],
    ),
    (
        "cylinder.stroke_position",
        "Position of the piston in the cylinder: 0 is the fully retracted position",
        Unit::Metre,
        Output::StrokePosition,
        &[Length],
    ),
    (
        "cylinder.end_force",
        "Force of an end of the cylinder on the piston, positive in the direction of extension",
        Unit::Newton,
        Output::EndForce,
        &[Length, Speed, Mass, Load, LowerLimit, UpperLimit],
    ),
    ("power.supply", "Hydraulic power that the supply delivers", Unit::Watt, Output::Power(0), &[Length, Supply]),
    ("power.return", "Hydraulic power of the oil flow into the tank", Unit::Watt, Output::Power(1), &[Length, Tank]),
    (
        "power.piston",
        "Mechanical power of the actuator force on the moved mechanism",
        Unit::Watt,
        Output::Power(2),
        &[Speed],
    ),
    ("power.seal_friction", "Power lost in the friction of the piston seals", Unit::Watt, Output::Power(3), &[Speed]),
    (
        "power.compression",
        "Power that is stored in the compression of the oil in the circuit",
        Unit::Watt,
        Output::Power(4),
        &[Length, Speed, Supply, Tank],
    ),
    (
        "power.throttling",
        "Power lost in the valve, restrictors, cushions, relief valves and leakages",
        Unit::Watt,
        Output::Power(5),
        FLOW,
    ),
    (
        "energy.supplied",
        "Energy that the supply has delivered since the start of the run",
        Unit::Joule,
        Output::Energy(0),
        &[],
    ),
    (
        "energy.returned",
        "Energy of the oil that has flowed into the tank since the start of the run",
        Unit::Joule,
        Output::Energy(1),
        &[],
    ),
    (
        "energy.piston",
        "Work of the actuator force on the moved mechanism since the start of the run",
        Unit::Joule,
        Output::Energy(2),
        &[],
    ),
    ("energy.seal_friction", "Energy lost in the seal friction since the start", Unit::Joule, Output::Energy(3), &[]),
    (
        "energy.compression",
        "Energy stored in the compression of the oil in the circuit since the start of the run",
        Unit::Joule,
        Output::Energy(4),
        &[],
    ),
    (
        "energy.throttling",
        "Energy lost in the valve, restrictors, cushions, relief valves and leakages since the start of the run",
        Unit::Joule,
        Output::Energy(5),
        &[],
    ),
    (
        "energy.balance",
        "Energy balance of the circuit: supplied energy minus all other energies, 0 except for rounding errors",
        Unit::Joule,
        Output::Balance,
        &[],
    ),
    (
        "coupling.stable_step",
        "Longest communication step at which the coupling with the mechanism is stable if the outputs preview.* are \
            not connected; the value 0 means that no step is stable, or that no reduced mass is connected",
        Unit::Second,
        Output::StableStep,
        &[Length, Speed, Supply, Tank, Mass],
    ),
];

/// Least and largest value of an input that has a range.
fn range(input: &str) -> [Option<f64>; 2] {
    if input.ends_with(".command") { [Some(-1.0), Some(1.0)] } else { [None, None] }
}

/// The variables of an actuator, with the range of each parameter. Inputs come first: the reference of an input is its
/// index.
pub fn variables(actuator: &HydraulicActuator) -> (Vec<Variable>, Vec<Quantity>) {
    let (mut list, mut quantities) = (Vec::new(), Vec::new());
    for ((name, words, unit), (index, start)) in INPUT_WORDS.into_iter().zip(starts(actuator).into_iter().enumerate()) {
        list.push(Variable {
            name: name.to_owned(),
            description: words.to_owned(),
            kind: Kind::Real,
            causality: Causality::Input,
            variability: Variability::Continuous,
            unit: Some(unit),
            start: Some(Value::Real(start)),
            dependencies: Vec::new(),
            details: Details {
                bounds: range(name),
                nominal: (start != 0.0).then_some(start.abs()),
                ..Details::default()
            },
        });
        quantities.push(Quantity::Input(index));
    }
    for &(name, words, unit, output, inputs) in OUTPUTS {
        let mut inputs: Vec<usize> = inputs.iter().map(|input| *input as usize).collect();
        inputs.sort_unstable();
        let dependencies = inputs.into_iter().map(|input| input as Reference).collect();
        list.push(Variable {
            name: name.to_owned(),
            description: words.to_owned(),
            kind: Kind::Real,
            causality: Causality::Output,
            variability: if output == Output::StableStep { Variability::Discrete } else { Variability::Continuous },
            unit: Some(unit),
            start: None,
            dependencies,
            details: Details::default(),
        });
        quantities.push(Quantity::Output(output));
    }
    let mut index = 0;
    actuator.clone().parameters(&mut |parameter, value| {
        list.push(Variable {
            name: parameter.name.concat(),
            description: parameter.description.concat(),
            kind: Kind::Real,
            causality: Causality::Parameter,
            variability: if parameter.role == Role::Tolerance { Variability::Tunable } else { Variability::Fixed },
            unit: Some(parameter.unit),
            start: Some(Value::Real(*value)),
            dependencies: Vec::new(),
            details: Details { bounds: parameter.range.bounds(), ..Details::default() },
        });
        quantities.push(Quantity::Parameter(index));
        index += 1;
    });
    let words = Mode::ALL.map(|mode| format!("\"{}\"", mode.word())).join(" or ");
    list.push(Variable {
        name: "coupling.mode".to_owned(),
        description: format!(
            "Motion of the actuator that the FMU uses within a step: {words}; follow: the motion that the inputs \
             prescribe; preview: the predicted motion; delayed: the predicted motion, for simulation tools that pass \
             values one step late"
        ),
        kind: Kind::Enumeration,
        causality: Causality::Parameter,
        variability: Variability::Fixed,
        unit: None,
        start: Some(Value::Item(actuator.coupling.mode.word().to_owned())),
        dependencies: Vec::new(),
        details: Details { items: &Mode::WORDS, ..Details::default() },
    });
    quantities.push(Quantity::Mode);
    (list, quantities)
}

/// Start values of the inputs.
pub fn starts(actuator: &HydraulicActuator) -> [f64; Input::ALL.len()] {
    Input::ALL.map(|input| match input {
        Length => actuator.actuator.length,
        Speed => actuator.actuator.speed,
        Supply => actuator.circuit.supply.pressure,
        Tank => actuator.circuit.tank.pressure,
        Acceleration | Command | Mass | MassDerivative | Load | LoadDerivative | Horizon | LowerLimit | UpperLimit => {
            0.0
        }
    })
}

/// The variables that make up the connection with what the actuator moves: force and motion as a drive of a mechanism
/// names them, then the terms of the one element. The force is the mean over the next step, which suits a host that
/// holds it as an input of the mechanism.
pub fn terminals<Q: Copy>(variables: &Variables<Q>) -> Vec<Terminal> {
    let list = variables.list();
    let force = variables.find("preview.force_mean").map(|variable| Member { name: "force".to_owned(), variable });
    let inputs = list.iter().enumerate().filter(|(_, variable)| variable.causality == Causality::Input);
    let inputs = inputs.filter(|(_, variable)| variable.name.starts_with(ACTUATOR));
    let inputs = inputs.map(|(index, variable)| Member::of(index as Reference, variable));
    let members = force.into_iter().chain(inputs).collect();
    let description = "Force and motion of the actuator".to_owned();
    vec![Terminal { name: "actuator".to_owned(), kind: "length".to_owned(), description, members }]
}
