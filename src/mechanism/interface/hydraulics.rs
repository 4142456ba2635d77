//! Variables of the hydraulic circuit of a drive: ports, pressures, flows, valve, powers, energies.
use super::builder::Builder;
use super::needs::{Needs, placed};
use crate::hydraulics::network::interface::{Quantity as OfNetwork, flow_inputs, outputs_in_mechanism};
use crate::hydraulics::network::layout::{Input, Part};
use crate::hydraulics::network::outputs as network;
use crate::mechanism::quantity::{Hydraulic, Output, Quantity};
use crate::variables::Unit::{
    self, CubicMetre, CubicMetrePerSecond, Joule, Metre, Newton, NewtonPerMetre, NewtonSecondPerMetre, One, Pascal,
    PerSecond, Watt,
};
use crate::variables::Value;
use std::sync::OnceLock;

/// Force of the drive of a circuit.
const FORCE: Output = Output::Hydraulic(Hydraulic::Force);

/// The force of the drive, in the place of the input that other drives have.
pub(super) fn add_force(b: &mut Builder, name: &str, cylinder: usize) {
    let of_network = b.source.loading.network.is_some();
    let output = if of_network { Output::Network(network::Output::Force(cylinder)) } else { FORCE };
    let text = ["Force of ", name, ", computed by the hydraulic circuit. A positive force pushes the two ends apart"];
    let needs = Needs { speed: true, circuit: true, ..placed() };
    b.output(name, "force", &text, Newton, output, &needs);
}

/// Adds the inputs and the outputs. A library that never allows hydraulics does not contain their code.
static ADD: OnceLock<[fn(&mut Builder); 2]> = OnceLock::new();

/// State that mechanisms may have hydraulics.
pub fn allow_hydraulics() {
    ADD.get_or_init(|| [add_inputs, add_outputs]);
}

/// The inputs (0) or the outputs (1).
pub(super) fn add(b: &mut Builder, which: usize) {
    ADD.get().into_iter().for_each(|add| add[which](b));
}

fn add_inputs(b: &mut Builder) {
    if let Some(system) = &b.source.mechanism.hydraulics {
        for input in flow_inputs(system) {
            let (Some(unit), Some(Value::Real(start))) = (input.unit, input.start) else { continue };
            b.input(input.name, &[&input.description], unit, start);
            if let Some(own) = b.list.last_mut() {
                own.details.bounds = input.details.bounds;
            }
        }
    }
    let Some((_, _, circuit)) = b.source.mechanism.hydraulic_drive() else { return };
    let text = ["Command of the valve, from -1 to 1; a positive command extends the cylinder"];
    b.input("valve.command".into(), &text, One, 0.0);
    if let Some(command) = b.list.last_mut() {
        command.details.bounds = [Some(-1.0), Some(1.0)];
    }
    let text = ["Pressure of the hydraulic supply, relative to the ambient pressure"];
    b.input("supply.pressure".into(), &text, Pascal, circuit.supply.pressure);
    let text = ["Pressure in the tank, relative to the ambient pressure"];
    b.input("tank.pressure".into(), &text, Pascal, circuit.tank.pressure);
}

/// Owner, suffix, text, unit and quantity of an output, and what it follows from besides pressures and spool: the
/// length, the speed, the ports.
type Row = (&'static str, &'static str, &'static str, Unit, Hydraulic, [bool; 3]);

/// All outputs of a circuit.
const OUTPUTS: &[Row] = &[
    (
        "chamber_a",
        "pressure",
        "Pressure in chamber A of the cylinder, relative to the ambient pressure",
        Pascal,
        Hydraulic::Pressure(0),
        [false; 3],
    ),
    (
        "chamber_a",
        "flow",
        "Oil flow into chamber A of the cylinder",
        CubicMetrePerSecond,
        Hydraulic::Flow(0),
        [true, false, true],
    ),
    (
        "chamber_a",
        "volume",
        "Oil volume in chamber A of the cylinder",
        CubicMetre,
        Hydraulic::Volume(0),
        [true, false, false],
    ),
    (
        "chamber_a",
        "bulk_modulus",
        "Effective bulk modulus of the oil in chamber A of the cylinder",
        Pascal,
        Hydraulic::BulkModulus(0),
        [true, false, false],
    ),
    (
        "chamber_b",
        "pressure",
        "Pressure in chamber B of the cylinder, relative to the ambient pressure",
        Pascal,
        Hydraulic::Pressure(1),
        [false; 3],
    ),
    (
        "chamber_b",
        "flow",
        "Oil flow into chamber B of the cylinder",
        CubicMetrePerSecond,
        Hydraulic::Flow(1),
        [true, false, true],
    ),
    (
        "chamber_b",
        "volume",
        "Oil volume in chamber B of the cylinder",
        CubicMetre,
        Hydraulic::Volume(1),
        [true, false, false],
    ),
    (
        "chamber_b",
        "bulk_modulus",
        "Effective bulk modulus of the oil in chamber B of the cylinder",
        Pascal,
        Hydraulic::BulkModulus(1),
        [true, false, false],
    ),
    (
        "valve",
        "position",
        "Position of the valve spool, from -1 to 1 (fully open); a positive position extends the cylinder",
        One,
        Hydraulic::SpoolPosition,
        [false; 3],
    ),
    ("valve", "speed", "Speed of the valve spool", PerSecond, Hydraulic::SpoolSpeed, [false; 3]),
    (
        "accumulator",
        "pressure",
        "Pressure at the supply side of the valve: pressure of the accumulator, or supply.pressure if there is no \
         accumulator",
        Pascal,
        Hydraulic::SupplyPressure,
        [false, false, true],
    ),
    (
        "supply",
        "flow",
        "Oil flow out of the hydraulic supply",
        CubicMetrePerSecond,
        Hydraulic::SupplyFlow,
        [true, false, true],
    ),
    (
        "tank",
        "flow",
        "Oil flow from the valve and the chambers into the tank",
        CubicMetrePerSecond,
        Hydraulic::TankFlow,
        [true, false, true],
    ),
    (
        "cylinder",
        "stroke_position",
        "Position of the piston in the cylinder: 0 is the fully retracted position",
        Metre,
        Hydraulic::StrokePosition,
        [true, false, false],
    ),
    (
        "cylinder",
        "end_force",
        "Force of an end of the cylinder on the piston, positive in the direction of extension",
        Newton,
        Hydraulic::EndForce,
        [true, true, true],
    ),
    ("power", "supply", "Hydraulic power that the supply delivers", Watt, Hydraulic::Power(0), [true, false, true]),
    (
        "power",
        "return",
        "Hydraulic power of the oil flow into the tank",
        Watt,
        Hydraulic::Power(1),
        [true, false, true],
    ),
    (
        "power",
        "piston",
        "Mechanical power of the drive force on the mechanism",
        Watt,
        Hydraulic::Power(2),
        [true, true, false],
    ),
    (
        "power",
        "seal_friction",
        "Power lost in the friction of the piston seals",
        Watt,
        Hydraulic::Power(3),
        [true, true, false],
    ),
    (
        "power",
        "compression",
        "Power that is stored in the compression of the oil in the circuit",
        Watt,
        Hydraulic::Power(4),
        [true, true, true],
    ),
    (
        "power",
        "throttling",
        "Power lost in the valve, restrictors, cushions, relief valves and leakages",
        Watt,
        Hydraulic::Power(5),
        [true, false, true],
    ),
    (
        "energy",
        "supplied",
        "Energy that the supply has delivered since the start of the run",
        Joule,
        Hydraulic::Energy(0),
        [false; 3],
    ),
    (
        "energy",
        "returned",
        "Energy of the oil that has flowed into the tank since the start of the run",
        Joule,
        Hydraulic::Energy(1),
        [false; 3],
    ),
    (
        "energy",
        "piston",
        "Work of the drive force on the mechanism since the start of the run",
        Joule,
        Hydraulic::Energy(2),
        [false; 3],
    ),
    (
        "energy",
        "seal_friction",
        "Energy lost in the friction of the piston seals since the start of the run",
        Joule,
        Hydraulic::Energy(3),
        [false; 3],
    ),
    (
        "energy",
        "compression",
        "Energy stored in the compression of the oil in the circuit since the start of the run",
        Joule,
        Hydraulic::Energy(4),
        [false; 3],
    ),
    (
        "energy",
        "throttling",
        "Energy lost in the valve, restrictors, cushions, relief valves and leakages since the start of the run",
        Joule,
        Hydraulic::Energy(5),
        [false; 3],
    ),
    (
        "energy",
        "balance",
        "Energy balance of the circuit: supplied energy minus all other energies, 0 except for rounding errors",
        Joule,
        Hydraulic::Balance,
        [false; 3],
    ),
];

/// The outputs of a network. Their dependencies on lengths and speeds are what these follow from.
fn add_network(b: &mut Builder) {
    let s = b.source;
    let (Some(system), Some(drives)) = (&s.mechanism.hydraulics, &s.loading.network) else { return };
    let layout = &drives.laws.layout;
    for (variable, quantity) in outputs_in_mechanism(system) {
        let (mut inputs, mut loads) = (Vec::new(), Vec::new());
        let mut needs = Needs::default();
        for &dependency in &variable.dependencies {
            match layout.input(dependency as usize) {
                Input::Cylinder(cylinder, part) => {
                    let load = drives.loads[cylinder];
                    let of = s.displacement(load);
                    needs.closure |= of.closure || part == Part::Speed;
                    needs.position |= of.position;
                    needs.joint = needs.joint.or(of.joint);
                    needs.speed |= part == Part::Speed;
                    loads.push(load);
                }
                _ => inputs.push(drives.first_input + dependency as usize),
            }
        }
        loads.sort_unstable();
        let total = |output| {
            use network::Output::{EnergyBalance, Total, VolumeBalance};
            matches!(output, Total(_) | VolumeBalance | EnergyBalance)
        };
        let needs = Needs { inputs: &inputs, loads: &loads, circuit: true, ..needs };
        let text = b.text(|| variable.description);
        let (output, needs) = match quantity {
            // The force stands in the place of an input.
            OfNetwork::Output(network::Output::Force(_)) => continue,
            OfNetwork::Output(output @ network::Output::EndForce(_)) => (output, s.acceleration()),
            OfNetwork::Output(output) => (output, Needs { circuit: !total(output), ..needs }),
            OfNetwork::Lock(lock) => {
                b.any_output(variable.name, text, None, Quantity::PressureLock(lock), &needs);
                continue;
            }
            _ => continue,
        };
        b.any_output(variable.name, text, variable.unit, Quantity::Output(Output::Network(output)), &needs);
    }
}

fn add_outputs(b: &mut Builder) {
    add_network(b);
    let s = b.source;
    let (Some(drive), Some((_, name, _))) = (&s.loading.hydraulics, s.mechanism.hydraulic_drive()) else { return };
    let ports = [drive.first_input + 1, drive.first_input + 2];
    let position = Needs { loads: &[drive.load], ..s.displacement(drive.load) };
    let stiffness = Needs { circuit: true, ..position };
    let text = ["Stiffness of the compressed oil in the cylinder of the drive ", name];
    b.output(name, "stiffness", &text, NewtonPerMetre, Output::Hydraulic(Hydraulic::Stiffness), &stiffness);
    let damping = Needs { speed: true, ..stiffness };
    let text = ["Derivative of the friction force of the piston seals with respect to the speed of the drive ", name];
    b.output(name, "damping", &text, NewtonSecondPerMetre, Output::Hydraulic(Hydraulic::Damping), &damping);
    for &(owner, suffix, text, unit, output, [length, speed, flows]) in OUTPUTS {
        let is_sum = matches!(output, Hydraulic::Energy(_) | Hydraulic::Balance);
        let placed = if length { position } else { Needs::default() };
        let inputs = match output {
            Hydraulic::SupplyPressure | Hydraulic::SupplyFlow | Hydraulic::Power(0) => &ports[..1],
            Hydraulic::TankFlow | Hydraulic::Power(1) => &ports[1..],
            _ if flows => &ports[..],
            _ => &[],
        };
        let needs = match output {
            Hydraulic::EndForce => s.acceleration(),
            _ => Needs { speed: speed || placed.speed, inputs, circuit: !is_sum, ..placed },
        };
        b.output(owner, suffix, &[text], unit, Output::Hydraulic(output), &needs);
    }
}
