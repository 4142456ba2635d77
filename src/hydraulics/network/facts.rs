//! Facts about a network: what its numbers amount to.
//!
//! In: a definition, values of outputs at the start by name. Out: facts. It must not know laws: the outputs tell.
use super::definition::{HydraulicSystem, PumpType};
use foundation::inspection::Fact;
use foundation::variables::Unit;
use std::f64::consts::FRAC_PI_4;

/// All facts. `value`: of an output at the start, by its name.
pub fn facts(system: &HydraulicSystem, value: &mut dyn FnMut(&str) -> f64) -> Vec<Fact> {
    let mut facts = Vec::new();
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
    facts
}
