//! The laws of a checked definition.
//!
//! In: a definition. Out: its laws, with ports by index. It must not know values of the state.
use super::{Accumulator, Cylinder, Law, Laws, Lock, Node, Path, Pilot, Pump, Valve};
use crate::circuit::Equations;
use crate::definition::{Circuit, Leakage, Seal, Transition};
use crate::network::definition::{self, HydraulicSystem, Opens, Ports, PumpType};
use crate::network::layout::Layout;
use std::f64::consts::TAU;

/// Pressure over which the direction of a flow opens and closes check valves [Pa]; that of `check.pressure`.
pub(super) const CHECK_WIDTH: f64 = 5e4;

impl Laws {
    /// The laws of a checked definition; ports that it does not have are those of index 0.
    pub fn new(system: &HydraulicSystem) -> Self {
        let (ports, layout) = (Ports::new(system), Layout::new(system));
        let cylinders: Vec<Cylinder> =
            system.cylinders.iter().map(|(_, cylinder)| Cylinder::new(system, cylinder)).collect();
        let at = |name: &str| ports.find(name).unwrap_or(0);
        let outlet = |port: usize| {
            let chamber = port.checked_sub(layout.nodes).filter(|chamber| *chamber < 2 * layout.cylinders)?;
            cylinders[chamber / 2].throttles[chamber % 2].then_some(chamber)
        };
        let ends = |from: &str, to: &str, law: Law, transition: f64| {
            let (from, to) = (at(from), at(to));
            Path { from, to, law, transition, switches: false, outlets: [outlet(from), outlet(to)] }
        };
        let k = |flow: f64, drop: f64| flow / drop.sqrt();
        let gated = |[forward, back]: [f64; 2], drop: f64, pilot: Pilot| Law::Gated {
            roots: [k(forward, drop).sqrt(), k(back, drop).sqrt()],
            cracking: 0.0,
            check_width: CHECK_WIDTH,
            pilot,
            laminar: 0.0,
        };
        let mut paths = Vec::new();
        for (_, one) in system.resistances.iter() {
            let laminar = if one.laminar_conductance > 0.0 { 1.0 / one.laminar_conductance } else { 0.0 };
            let back = one.reverse_flow.unwrap_or(one.rated_flow);
            let law = match gated([one.rated_flow, back], one.rated_pressure_drop, Pilot::None) {
                _ if back == one.rated_flow => Law::Open { k: k(back, one.rated_pressure_drop), laminar },
                Law::Gated { roots, cracking, check_width, pilot, .. } => {
                    Law::Gated { roots, cracking, check_width, pilot, laminar }
                }
                law => law,
            };
            paths.push(ends(&one.from, &one.to, law, one.transition_pressure));
        }
        for (_, one) in system.checks.iter() {
            let (cracking, width) = (one.cracking_pressure, one.width);
            let law = if one.conductance > 0.0 {
                Law::Linear { conductance: one.conductance, cracking, width }
            } else {
                let root = k(one.rated_flow, one.rated_pressure_drop).sqrt();
                Law::Gated { roots: [root, 0.0], cracking, check_width: width, pilot: Pilot::None, laminar: 0.0 }
            };
            paths.push(ends(&one.from, &one.to, law, one.transition_pressure));
        }
        for (_, one) in system.reliefs.iter() {
            let law = Law::Relief { conductance: one.conductance, pressure: one.pressure, width: one.width };
            paths.push(ends(&one.from, &one.to, law, 0.0));
        }
        for (_, one) in system.priorities.iter() {
            let pilot = Pilot::Above { port: at(&one.from), pressure: one.pressure, width: one.width };
            let law = gated([one.rated_flow, one.reverse_flow], one.rated_pressure_drop, pilot);
            paths.push(ends(&one.from, &one.to, law, one.transition_pressure));
        }
        for (_, one) in system.sequences.iter() {
            let pilot = Pilot::Above { port: at(&one.pilot), pressure: one.pressure, width: one.width };
            let law = gated([one.rated_flow, one.reverse_flow], one.rated_pressure_drop, pilot);
            paths.push(ends(&one.from, &one.to, law, one.transition_pressure));
        }
        for (_, one) in system.pilot_checks.iter() {
            let pilot = Pilot::Ratio { port: at(&one.pilot), ratio: one.ratio, width: one.width };
            let law = gated([one.rated_flow; 2], one.rated_pressure_drop, pilot);
            paths.push(ends(&one.from, &one.to, law, one.transition_pressure));
        }
        for (_, one) in system.counterbalances.iter() {
            let (port, ratio, pressure, width) = (at(&one.pilot), one.ratio, one.pressure, one.width);
            let law = gated([one.rated_flow; 2], one.rated_pressure_drop, Pilot::Sum { port, ratio, pressure, width });
            paths.push(ends(&one.from, &one.to, law, one.transition_pressure));
        }
        for (_, one) in system.position_valves.iter() {
            let cylinder = system.cylinders.names().iter().position(|name| *name == one.cylinder).unwrap_or(0);
            let sign = if one.opens == Opens::Above { 1.0 } else { -1.0 };
            let pilot = Pilot::Position { cylinder, sign, length: one.length, width: one.width };
            let law = gated([one.rated_flow, one.reverse_flow], one.rated_pressure_drop, pilot);
            paths.push(ends(&one.from, &one.to, law, one.transition_pressure));
        }
        for (index, (_, one)) in system.bypasses.iter().enumerate() {
            let law = Law::Bypass { k: k(one.rated_flow, one.rated_pressure_drop), input: layout.open(index) };
            paths.push(ends(&one.from, &one.to, law, one.transition_pressure));
        }
        for (valve, (_, one)) in system.valves.iter().enumerate() {
            let b = one.rated_flow_b.unwrap_or(one.rated_flow);
            let a_return = one.rated_flow_a_return.unwrap_or(one.rated_flow);
            let b_return = one.rated_flow_b_return.unwrap_or(b);
            for (from, to, flow, side) in [
                (&one.supply, &one.a, one.rated_flow, 0),
                (&one.supply, &one.b, b, 1),
                (&one.a, &one.r#return, a_return, 1),
                (&one.b, &one.r#return, b_return, 0),
            ] {
                let law = Law::Edge { k: k(flow, one.rated_pressure_drop), valve, side };
                let switches = one.transition == Transition::Switch;
                paths.push(Path { switches, ..ends(from, to, law, one.transition_pressure) });
            }
        }
        let mut spools = 0..;
        let valves = system.valves.iter().map(|(_, one)| Valve {
            clearance: one.clearance,
            overlap: one.overlap,
            dynamics: one.frequency.and_then(|f| Some((TAU * f, one.damping_ratio, spools.next()?))),
        });
        let pumps = system.pumps.iter().enumerate().map(|(index, (_, one))| Pump {
            from: at(&one.from),
            to: at(&one.to),
            speed: layout.reservoirs + index,
            max_flow: one.max_flow,
            band: (one.r#type == PumpType::Compensated).then_some([one.full_pressure, one.max_pressure]),
        });
        let ambient = system.fluid.ambient_pressure;
        Self {
            layout,
            names: pressures(system),
            ambient,
            oil: Equations::new(&Circuit { fluid: system.fluid, ..Circuit::default() }),
            nodes: system
                .nodes
                .iter()
                .map(|(_, one)| Node { volume: one.volume, hoses: one.hose_volume / one.hose_modulus })
                .collect(),
            valves: valves.collect(),
            pumps: pumps.collect(),
            accumulators: system
                .accumulators
                .iter()
                .map(|(_, one)| Accumulator {
                    at: at(&one.at),
                    volume: one.volume,
                    precharge: one.precharge_pressure + ambient,
                    exponent: one.polytropic_exponent,
                })
                .collect(),
            locks: system
                .pressure_locks
                .iter()
                .map(|(_, one)| Lock {
                    at: at(&one.at),
                    release: one.release_pressure,
                    engage: one.release_pressure - one.hysteresis,
                })
                .collect(),
            paths,
            cylinders,
        }
    }
}

/// Names of the pressures that are states, as those of their outputs.
pub fn pressures(system: &HydraulicSystem) -> Vec<String> {
    let nodes = system.nodes.iter().map(|(name, _)| format!("{name}.pressure"));
    let sides = ["a", "b"];
    let chambers =
        system.cylinders.iter().flat_map(|(name, _)| sides.map(|side| format!("{name}.chamber_{side}.pressure")));
    nodes.chain(chambers).collect()
}

impl Cylinder {
    /// The laws of a cylinder as a circuit of which only oil, seals, cushions and walls are used.
    fn new(system: &HydraulicSystem, one: &definition::Cylinder) -> Self {
        let none = Seal { coulomb: 0.0, r#static: 0.0, viscous: 0.0, pressure_area: 0.0, ..Seal::default() };
        let mut circuit = Circuit { fluid: system.fluid, seal: one.seal.unwrap_or(none), ..Circuit::default() };
        let cylinder = &mut circuit.cylinder;
        (cylinder.bore, cylinder.rod, cylinder.stroke) = (one.bore, one.rod, one.stroke);
        (cylinder.closed_length, cylinder.wall_modulus) = (one.closed_length, one.wall_modulus);
        cylinder.restitution = one.restitution;
        cylinder.oil_volume = one.oil_volume;
        circuit.valve.rated_pressure_drop = one.rated_pressure_drop;
        let (a, b) = (&one.chamber_a, &one.chamber_b);
        (circuit.chamber_a.dead_volume, circuit.chamber_b.dead_volume) = (a.dead_volume, b.dead_volume);
        (circuit.hose.volume_a, circuit.hose.volume_b) = (a.hose_volume, b.hose_volume);
        circuit.hose.modulus = one.hose_modulus;
        (circuit.restrictor_a.rated_flow, circuit.restrictor_b.rated_flow) = (a.restrictor_flow, b.restrictor_flow);
        (circuit.cushion_a.length, circuit.cushion_b.length) = (a.cushion_length, b.cushion_length);
        (circuit.cushion_a.rated_flow, circuit.cushion_b.rated_flow) = (a.cushion_flow, b.cushion_flow);
        let none = Leakage { internal: 0.0, external_a: 0.0, external_b: 0.0 };
        let leakage = one.leakage.unwrap_or(none);
        let throttles =
            [a, b].map(|one| one.restrictor_flow > 0.0 || one.cushion_length > 0.0 && one.cushion_flow > 0.0);
        Self {
            laws: Equations::new(&circuit),
            internal: leakage.internal,
            external: [leakage.external_a, leakage.external_b],
            throttles,
        }
    }
}
