//! Inspection of a network: what its numbers amount to, and which look wrong.
//!
//! In: the text of a definition. Out: facts and findings. It must not know laws: the outputs tell.
use super::definition::{HydraulicSystem, PumpType};
use super::model::Model;
use crate::inspection::{Fact, Finding, Inspection};
use crate::variables::Unit;
use std::f64::consts::FRAC_PI_4;

/// Inspect the text of a definition.
pub fn inspect(text: &str) -> Inspection {
    let mut out = Inspection::default();
    let (system, faults) = match HydraulicSystem::with_faults(text) {
        Ok(read) => read,
        Err(faults) => {
            out.findings.extend(faults.into_iter().map(|fault| Finding::fault(fault.path(), &fault)));
            return out;
        }
    };
    (out.is_readable, out.name) = (true, system.name.clone());
    let is_sound = faults.are_of_unknown_keys();
    out.findings.extend(faults.into_iter().map(|fault| Finding::fault(fault.path(), &fault)));
    if !is_sound {
        return out;
    }
    let mut model = match Model::new(system.clone()) {
        Ok(model) => model,
        Err(error) => {
            out.findings.push(Finding::error("", &error));
            return out;
        }
    };
    out.findings.extend(model.warnings());
    let facts = &mut out.facts;
    let count = |count: usize| count as f64;
    facts.push(
        Fact::new("Network", "elements")
            .with("nodes", count(system.nodes.len()), Unit::One)
            .with("flow paths", count(system.path_count() + system.pumps.len()), Unit::One)
            .with("cylinders", count(system.cylinders.len()), Unit::One),
    );
    let oil = system.nodes.iter().fold(0.0, |sum, (_, node)| sum + node.volume);
    let gas = system.accumulators.iter().fold(0.0, |sum, (_, one)| sum + one.volume);
    let fact = Fact::new("Network", "volume").with("oil in nodes", oil, Unit::CubicMetre);
    facts.push(fact.with("gas of accumulators", gas, Unit::CubicMetre));
    let mut value = |name: &str| {
        let reference = model.variables().find(name);
        reference.and_then(|reference| model.real(reference).ok()).unwrap_or(f64::NAN)
    };
    for (name, pump) in system.pumps.iter() {
        let fact = Fact::new("Pump", name).with("largest flow", pump.max_flow, Unit::CubicMetrePerSecond);
        facts.push(match pump.r#type {
            PumpType::Compensated => fact.with("largest pressure", pump.max_pressure, Unit::Pascal),
            PumpType::Fixed => fact.saying("only relief valves limit the pressure at the outlet of this pump"),
        });
    }
    for (name, one) in system.accumulators.iter() {
        let fact = Fact::new("Accumulator", name).with(
            "oil at the start",
            value(&format!("{name}.oil_volume")),
            Unit::CubicMetre,
        );
        facts.push(fact.with("gas volume", one.volume, Unit::CubicMetre));
    }
    for (name, one) in system.cylinders.iter() {
        let [bore, rod] = [one.bore, one.rod].map(|d| FRAC_PI_4 * d * d);
        let fact = Fact::new("Cylinder", name).with("area of the piston", bore, Unit::SquareMetre);
        let fact = fact.with("area of the rod side", bore - rod, Unit::SquareMetre);
        facts.push(fact.with("oil swept by the stroke", bore * one.stroke, Unit::CubicMetre));
        let fact =
            Fact::new("Cylinder", name).with("force at the start", value(&format!("{name}.force")), Unit::Newton);
        facts.push(fact.with("stiffness of the oil", value(&format!("{name}.stiffness")), Unit::NewtonPerMetre));
    }
    out
}
