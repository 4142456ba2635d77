//! The parameters on which the values at the start of outputs depend.
//!
//! In: the table of variables. Out: the inputs and parameters of each output. It must not know the state.
use super::Quantity;
use crate::outputs::Output;
use foundation::variables::{Causality, Kind, Reference, Variables};

/// Beginnings of the names of the parameters on which the flows through the edges of both chambers depend.
const EDGES: &[&str] = &[
    "chamber_a.start",
    "chamber_b.start",
    "cylinder.closed_length",
    "cylinder.stroke",
    "valve.rated",
    "valve.transition",
    "valve.clearance",
    "valve.overlap",
    "restrictor_",
    "check.",
    "cushion_",
    "lock_valve.",
];

/// Beginnings of the names of the parameters on which the value at the start of an output depends, in parts.
fn sections(output: Output) -> [&'static [&'static str]; 3] {
    const STARTS: &[&str] = &["chamber_a.start", "chamber_b.start"];
    const VALVES: &[&str] = &["relief.", "anticavitation."];
    const SEALS: &[&str] = &["seal.", "valve.transition"];
    const SEALS_AND_STARTS: &[&str] = &["seal.", "valve.transition", "chamber_a.start", "chamber_b.start"];
    const AREAS: &[&str] = &["cylinder.bore", "cylinder.rod"];
    const CYLINDER: &[&str] = &["cylinder.bore", "cylinder.rod", "cylinder.closed_length", "cylinder.stroke"];
    // Of one chamber: the edges, the valves and the leakages that it has.
    const EDGES_A: &[&str] = &[
        "cylinder.closed_length",
        "valve.rated",
        "valve.transition",
        "valve.clearance",
        "valve.overlap",
        "restrictor_a",
        "check.",
        "cushion_a",
        "lock_valve.",
        "relief.",
        "anticavitation.",
        "leakage.internal",
        "leakage.external_a",
    ];
    const EDGES_B: &[&str] = &[
        "cylinder.closed_length",
        "cylinder.stroke",
        "valve.rated",
        "valve.transition",
        "valve.clearance",
        "valve.overlap",
        "restrictor_b",
        "check.",
        "cushion_b",
        "relief.",
        "anticavitation.",
        "leakage.internal",
        "leakage.external_b",
    ];
    const WALLS: &[&str] = &["fluid.", "cylinder.closed_length", "cylinder.wall", "hose.modulus"];
    match output {
        Output::PreviewStartAcceleration => [&["cylinder.restitution"], CYLINDER, SEALS_AND_STARTS],
        Output::EndForce => [CYLINDER, STARTS, &[]],
        output if output.is_foreseen() => [&[""], &[], &[]],
        Output::Force | Output::Power(2) => [AREAS, SEALS, STARTS],
        Output::Damping | Output::Power(3) => [SEALS, STARTS, &[]],
        Output::Stiffness => [CYLINDER, &["fluid.", "cylinder.wall", "chamber_", "hose."], &[]],
        Output::Pressure(0) => [&["chamber_a.start"], &[], &[]],
        Output::Pressure(_) => [&["chamber_b.start"], &[], &[]],
        Output::Volume(0) => [&["cylinder.bore", "cylinder.closed_length", "chamber_a.dead"], &[], &[]],
        Output::Volume(_) => [AREAS, &["cylinder.stroke", "cylinder.closed_length", "chamber_b.dead"], &[]],
        Output::BulkModulus(0) => [WALLS, &["cylinder.bore", "chamber_a.", "hose.volume_a"], &[]],
        Output::BulkModulus(_) => [WALLS, AREAS, &["cylinder.stroke", "chamber_b.", "hose.volume_b"]],
        Output::StrokePosition => [&["cylinder.closed_length"], &[], &[]],
        Output::Flow(0) => [EDGES_A, STARTS, &[]],
        Output::Flow(_) => [EDGES_B, STARTS, &[]],
        Output::SupplyFlow | Output::Power(0) => [EDGES, &[], &[]],
        Output::TankFlow | Output::Power(1) => [EDGES, VALVES, &[]],
        Output::Power(4) => [EDGES, VALVES, &["leakage.", "cylinder.bore", "cylinder.rod"]],
        Output::Power(_) => [EDGES, VALVES, &["leakage."]],
        Output::StableStep => [
            EDGES,
            VALVES,
            &["leakage.", "fluid.", "cylinder.bore", "cylinder.rod", "cylinder.wall", "chamber_", "hose.", "seal."],
        ],
        _ => [&[], &[], &[]],
    }
}

/// For each variable, if it is an output: the inputs and parameters on which its initial value depends, ascending.
pub fn initial_dependencies(variables: &Variables<Quantity>) -> Vec<Vec<Reference>> {
    let list = variables.list();
    let of = |index: usize| match variables.quantity(index as Reference) {
        Some(Quantity::Output(output)) => {
            let mut all = list[index].dependencies.clone();
            let parameters = list.iter().enumerate().filter(|(_, v)| v.causality == Causality::Parameter);
            let numbers = parameters.filter(|(_, v)| v.kind == Kind::Real && !v.name.starts_with("solver.max"));
            let sections = sections(output);
            let is_in = |name: &str| sections.iter().copied().flatten().any(|section| name.starts_with(section));
            let named = numbers.filter(|(_, v)| is_in(&v.name));
            all.extend(named.map(|(index, _)| index as Reference));
            all
        }
        _ => Vec::new(),
    };
    (0..list.len()).map(of).collect()
}
