//! Inspection of a hydraulic actuator: what its numbers amount to, and which look wrong.
//!
//! In: the text of a definition. Out: facts and findings. It must not know the laws
//! of the circuit: its outputs tell.
use super::definition::HydraulicActuator;
use super::model::Model;
use super::plausibility::circuit_warnings;
use foundation::format::Described;
use foundation::inspection::{Fact, Finding, Inspection};
use foundation::numerics::decimal::Decimal;
use foundation::variables::Unit;
use std::cell::RefCell;
use std::f64::consts::PI;

/// Path in the file of a key, where those of the circuit stand in its own section.
fn in_file(path: &str) -> String {
    let first = path.split('.').next().unwrap_or_default();
    match HydraulicActuator::TABLE.position(first) {
        Some(_) => path.to_owned(),
        None => format!("circuit.{path}"),
    }
}

impl Model {
    /// What the definition gives reason to warn of, for logs.
    pub fn warnings(&self) -> Vec<Finding> {
        let mut copy = self.clone();
        copy.reset();
        let copy = RefCell::new(copy);
        let value = |name: &str| {
            let reference = self.variables().find(name)?;
            copy.borrow_mut().real(reference).ok()
        };
        let mut all = circuit_warnings("circuit.", value);
        let coarse = self.experiment().coarse();
        all.extend(coarse.map(|(key, message, remedy)| Finding::warning(key, message, remedy)));
        if let [Some(length), Some(closed), Some(stroke)] =
            ["actuator.length", "cylinder.closed_length", "cylinder.stroke"].map(value)
            && !(closed..=closed + stroke).contains(&length)
        {
            let message = format!(
                "the start length is {} m, but the cylinder can only have lengths from {} m to {} m",
                Decimal(length),
                Decimal(closed),
                Decimal::rounded(closed + stroke)
            );
            let remedy = "state a length that the cylinder can have, or change cylinder.closed_length or \
                cylinder.stroke";
            all.push(Finding::warning("actuator.length", message, remedy));
        }
        all
    }
}

/// Inspect the text of a definition.
pub fn inspect(text: &str) -> Inspection {
    let mut out = Inspection::default();
    let (actuator, faults) = match HydraulicActuator::with_faults(text) {
        Ok(read) => read,
        Err(faults) => {
            out.findings.extend(faults.into_iter().map(|fault| Finding::fault(fault.path(), &fault)));
            return out;
        }
    };
    (out.is_readable, out.name) = (true, actuator.name.clone());
    let is_sound = faults.are_of_unknown_keys();
    out.findings.extend(faults.into_iter().map(|fault| match fault.place() {
        Some(_) => Finding::fault(fault.path(), &fault),
        None => Finding::fault(&in_file(fault.path()), &fault),
    }));
    let mut model = match Model::new(actuator) {
        Ok(model) if is_sound => model,
        Ok(_) => return out,
        Err(error) => {
            out.findings.push(Finding::error("", &error));
            return out;
        }
    };
    out.findings.extend(model.warnings());
    let mut value = |name: &str| {
        let reference = model.variables().find(name);
        reference.and_then(|reference| model.real(reference).ok()).unwrap_or(f64::NAN)
    };
    let [bore, rod, stroke, closed] =
        ["bore", "rod", "stroke", "closed_length"].map(|key| value(&format!("cylinder.{key}")));
    let [piston, ring] = [bore.powi(2), bore.powi(2) - rod.powi(2)].map(|square| 0.25 * PI * square);
    let [supply, tank] = ["supply", "tank"].map(|side| value(&format!("{side}.pressure")));
    let flow = value("valve.rated_flow");
    let facts = &mut out.facts;
    let fact = Fact::new("Cylinder", "area").with("piston", piston, Unit::SquareMetre);
    facts.push(fact.with("rod side", ring, Unit::SquareMetre).with("ratio", piston / ring, Unit::One));
    let fact = Fact::new("Cylinder", "length").with("least", closed, Unit::Metre);
    let fact = fact.with("most", closed + stroke, Unit::Metre).with("stroke", stroke, Unit::Metre);
    facts.push(fact.with("start", value("actuator.length"), Unit::Metre));
    let fact = Fact::new("Cylinder", "largest force").with("pushing", piston * supply - ring * tank, Unit::Newton);
    let text = "computed without seal friction; one chamber is at supply pressure, the other chamber at tank pressure";
    facts.push(fact.with("pulling", ring * supply - piston * tank, Unit::Newton).saying(text));
    let fact = Fact::new("Cylinder", "speed at the rated flow").with("out", flow / piston, Unit::MetrePerSecond);
    facts.push(fact.with("in", flow / ring, Unit::MetrePerSecond));
    for (chamber, of) in [("chamber_a", "chamber A"), ("chamber_b", "chamber B")] {
        let mut value = |key: &str| value(&format!("{chamber}.{key}"));
        let fact = Fact::new("Oil at the start", of).with("pressure", value("pressure"), Unit::Pascal);
        let fact = fact.with("volume", value("volume"), Unit::CubicMetre);
        facts.push(fact.with("bulk modulus", value("bulk_modulus"), Unit::Pascal));
    }
    let [stiffness, mass] = [value("actuator.stiffness"), value("actuator.reduced_mass")];
    let fact = Fact::new("Oil at the start", "spring").with("stiffness", stiffness, Unit::NewtonPerMetre);
    facts.push(match mass > 0.0 {
        true => fact.with("frequency", (stiffness / mass).sqrt() / (2.0 * PI), Unit::Hertz),
        false => fact.saying("no natural frequency without a reduced mass: the input actuator.reduced_mass is 0"),
    });
    let [force, load] = [value("actuator.force"), value("actuator.holding_force")];
    let fact = Fact::new("Equilibrium at the start", "").with("force", force, Unit::Newton);
    facts.push(fact.with("holding force of the load", load, Unit::Newton).saying(
        match (force - load).abs() <= 1e-3 * (force.abs() + load.abs()) {
            true => "at the start the actuator holds its load: the force equals the holding force to 0.1 %",
            false => "at the start the load moves the actuator (no equilibrium), with the inputs at their start values",
        },
    ));
    out
}
