//! Rules of the standard for `modelDescription.xml` that its schema does not contain (FMI 2.0.5, 2.2; FMI 3.0.2, 2.4).
//!
//! In: the text of the file, of FMI 2.0 or 3.0 and of any program. Out: a line for each broken rule. The rules are
//! those of the formal VDM model of FMI 2.0 that need no library.

mod elements;

use crate::xml::common::is_c_identifier;
use elements::{Element, elements};
use std::collections::{BTreeMap, BTreeSet};

/// Types of variables whose start value is no number.
const NO_NUMBERS: [&str; 6] = ["String", "Binary", "Clock", "Boolean", "Enumeration", "Independent"];
/// Lists in which the values of an attribute must be unique.
const UNIQUE: [(&str, &str, &str); 4] = [
    ("LogCategories", "Category", "name"),
    ("UnitDefinitions", "Unit", "name"),
    ("TypeDefinitions", "", "name"),
    ("ModelVariables", "", "name"),
];

/// A variable with the attributes of its type.
struct Variable {
    name: String,
    kind: String,
    all: BTreeMap<String, String>,
}

impl Variable {
    fn get(&self, name: &str) -> &str {
        self.all.get(name).map_or("", String::as_str)
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.all.get(name)?.trim().parse().ok()
    }
}

/// The parts of a description that the rules use.
struct Rules {
    elements: Vec<Element>,
    variables: Vec<Variable>,
    is_3: bool,
    broken: Vec<String>,
}

/// The rules that this description breaks. None for a text that is no XML, which its reader reports.
pub fn broken(xml: &str) -> Vec<String> {
    let Some(elements) = elements(xml) else { return Vec::new() };
    let is_3 = elements.first().is_some_and(|root| root.get("fmiVersion").starts_with('3'));
    let mut variables: Vec<Variable> = Vec::new();
    for element in &elements {
        match &element.path[..] {
            [list] if list == "ModelVariables" => {
                let kind = if is_3 { element.name.clone() } else { String::new() };
                variables.push(Variable {
                    name: element.get("name").to_owned(),
                    kind,
                    all: element.attributes.clone(),
                });
            }
            [list, scalar]
                if list == "ModelVariables" && scalar == "ScalarVariable" && element.name != "Annotations" =>
            {
                if let Some(variable) = variables.last_mut() {
                    variable.kind.clone_from(&element.name);
                    variable.all.extend(element.attributes.clone());
                }
            }
            _ => {}
        }
    }
    let mut rules = Rules { elements, variables, is_3, broken: Vec::new() };
    rules.header();
    rules.unique();
    for index in 0..rules.variables.len() {
        rules.variable(index);
    }
    rules.aliases();
    rules.structure();
    rules.broken
}

impl Rules {
    fn in_list(&self, list: &str) -> impl Iterator<Item = &Element> {
        self.elements.iter().filter(move |element| element.path.len() == 1 && element.path[0] == list)
    }

    /// Root, kinds of simulation, default experiment.
    fn header(&mut self) {
        let token = if self.is_3 { "instantiationToken" } else { "guid" };
        let mut broken = Vec::new();
        for (index, element) in self.elements.iter().enumerate() {
            if index == 0 && element.get(token).is_empty() {
                broken.push(format!("{token} is empty"));
            }
            let identifier = element.get("modelIdentifier");
            if element.path.is_empty()
                && element.attributes.contains_key("modelIdentifier")
                && !is_c_identifier(identifier)
            {
                broken.push(format!("modelIdentifier \"{identifier}\" is not a C identifier"));
            }
            if element.name == "DefaultExperiment" {
                let [start, stop, tolerance, step] =
                    ["startTime", "stopTime", "tolerance", "stepSize"].map(|name| element.number(name));
                if let (Some(start), Some(stop)) = (start.or(Some(0.0)), stop)
                    && stop < start
                {
                    broken.push(format!("the default experiment stops at {stop}, before its start at {start}"));
                }
                for (name, value) in [("tolerance", tolerance), ("stepSize", step)] {
                    if value.is_some_and(|value| value <= 0.0) {
                        broken.push(format!("{name} of the default experiment is not above 0"));
                    }
                }
            }
        }
        self.broken.extend(broken);
    }

    fn unique(&mut self) {
        let mut broken = Vec::new();
        for (list, name, attribute) in UNIQUE {
            let mut seen = BTreeSet::new();
            let of_name = self.in_list(list).filter(|element| name.is_empty() || element.name == name);
            for element in of_name.filter(|element| !seen.insert(element.get(attribute))) {
                broken.push(format!("{list}: \"{}\" occurs twice", element.get(attribute)));
            }
        }
        self.broken.extend(broken);
    }

    /// Causality, variability, initial, start, bounds, unit, type and derivative of one variable.
    fn variable(&mut self, index: usize) {
        let v = &self.variables[index];
        let [causality, variability, initial] = ["causality", "variability", "initial"].map(|name| v.get(name));
        let mut broken: Vec<String> = Vec::new();
        let is_real = v.kind == "Real" || v.kind.starts_with("Float");
        if variability == "continuous" && !is_real && causality != "independent" {
            broken.push(format!("a variable of type {} cannot have the variability continuous", v.kind));
        }
        let legal: &[&str] = match causality {
            "parameter" | "calculatedParameter" | "structuralParameter" => &["fixed", "tunable"],
            "input" => &["discrete", "continuous"],
            "output" => &["constant", "discrete", "continuous"],
            "independent" => &["continuous"],
            _ => &["constant", "fixed", "tunable", "discrete", "continuous"],
        };
        if !variability.is_empty() && !legal.contains(&variability) {
            broken.push(format!(
                "the combination of causality {causality} with variability {variability} is not allowed"
            ));
        }
        let legal: &[&str] = match (causality, variability) {
            ("input", _) if !self.is_3 => &[],
            ("input", _) => &["exact", "approx", "calculated"],
            ("independent", _) => &[],
            ("parameter" | "structuralParameter", _) | (_, "constant") => &["exact"],
            ("calculatedParameter", _) | (_, "fixed" | "tunable") => &["approx", "calculated"],
            _ => &["exact", "approx", "calculated"],
        };
        if !initial.is_empty() && !legal.contains(&initial) {
            broken.push(format!(
                "the combination of causality {causality} and variability {variability} with initial {initial} is not \
                 allowed"
            ));
        }
        let needs_start = matches!(initial, "exact" | "approx")
            || matches!(causality, "parameter" | "structuralParameter" | "input")
            || variability == "constant";
        let has_start = v.all.contains_key("start");
        // A String has its start value in an element. In FMI 3.0 an input may be calculated.
        let may_lack =
            matches!(v.kind.as_str(), "String" | "Binary" | "Clock") || (self.is_3 && initial == "calculated");
        if needs_start && !has_start && !may_lack {
            broken.push("the variable has no start value".to_owned());
        }
        if has_start && (initial == "calculated" || causality == "independent") {
            broken.push(format!(
                "the variable has a start value, but {} does not allow a start value",
                if initial.is_empty() { causality } else { initial }
            ));
        }
        let [least, most, nominal] = ["min", "max", "nominal"].map(|name| v.number(name));
        if let (Some(least), Some(most)) = (least, most)
            && most < least
        {
            broken.push(format!("the attribute max = {most} is below the attribute min = {least}"));
        }
        if nominal.is_some_and(|nominal| nominal <= 0.0) {
            broken.push("the nominal value is not above 0".to_owned());
        }
        if !NO_NUMBERS.contains(&v.kind.as_str()) {
            let outside =
                |start: &f64| least.is_some_and(|least| *start < least) || most.is_some_and(|most| *start > most);
            let starts = v.get("start").split_whitespace().filter_map(|text| text.parse().ok());
            broken.extend(
                starts
                    .filter(outside)
                    .map(|start: f64| format!("the start value {start} is not between the attributes min and max")),
            );
        }
        let [unit, display, declared] = ["unit", "displayUnit", "declaredType"].map(|name| v.get(name));
        if !unit.is_empty() && !self.in_list("UnitDefinitions").any(|element| element.get("name") == unit) {
            broken.push(format!("the unit {unit} has no definition"));
        }
        let of_unit = |element: &Element| element.name == "DisplayUnit" && element.of == unit;
        let has_display = self.elements.iter().any(|element| of_unit(element) && element.get("name") == display);
        if !display.is_empty() && declared.is_empty() && !has_display {
            broken.push(format!("the unit {unit} has no display unit {display}"));
        }
        if !declared.is_empty() && !self.in_list("TypeDefinitions").any(|element| element.get("name") == declared) {
            broken.push(format!("the type {declared} has no definition"));
        }
        if let Some(of) = v.all.get("derivative") {
            let is_continuous = |other: &Variable| matches!(other.get("variability"), "" | "continuous");
            match self.named(of) {
                Some(other) if is_continuous(&self.variables[other]) => {}
                _ => broken.push(format!("the attribute derivative = {of} does not refer to a continuous variable")),
            }
        }
        let name = v.name.clone();
        self.broken.extend(broken.into_iter().map(|message| format!("{name}: {message}")));
    }

    /// Index of the variable with this index (FMI 2.0) or value reference (FMI 3.0).
    fn named(&self, text: &str) -> Option<usize> {
        if self.is_3 {
            return self.variables.iter().position(|variable| variable.get("valueReference") == text);
        }
        text.parse::<usize>().ok()?.checked_sub(1).filter(|index| *index < self.variables.len())
    }

    /// Variables with a common value reference: not allowed in FMI 3.0. In FMI 2.0 they have one type and unit, and the
    /// host sets at most one of them.
    fn aliases(&mut self) {
        let mut broken = Vec::new();
        let mut groups: BTreeMap<(String, String), Vec<&Variable>> = BTreeMap::new();
        for variable in &self.variables {
            let kind = if self.is_3 { String::new() } else { variable.kind.clone() };
            groups.entry((kind, variable.get("valueReference").to_owned())).or_default().push(variable);
        }
        for ((_, reference), group) in groups.iter().filter(|(_, group)| group.len() > 1) {
            let names: Vec<&str> = group.iter().map(|variable| variable.name.as_str()).collect();
            let units: BTreeSet<&str> = group.iter().map(|variable| variable.get("unit")).collect();
            let set = group.iter().filter(|v| matches!(v.get("causality"), "parameter" | "input")).count();
            let fault = match (self.is_3, units.len(), set) {
                (true, ..) => "have the same value reference",
                (_, 2.., _) => "have different units, but the same value reference",
                (.., 2..) => "can be set by a simulation tool, but have the same value reference",
                _ => continue,
            };
            broken.push(format!("{} {fault} {reference}", names.join(", ")));
        }
        self.broken.extend(broken);
    }

    /// The lists of `ModelStructure`: complete, without duplicates, with existing dependencies.
    fn structure(&mut self) {
        let mut broken = Vec::new();
        let mut lists: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for element in &self.elements {
            let list = match &element.path[..] {
                [structure, list] if structure == "ModelStructure" && !self.is_3 => list.as_str(),
                [structure] if structure == "ModelStructure" && self.is_3 => element.name.as_str(),
                _ => continue,
            };
            let named = element.get(if self.is_3 { "valueReference" } else { "index" });
            let Some(index) = self.named(named) else {
                broken.push(format!("{list}: the entry {named} does not refer to a variable"));
                continue;
            };
            let name = &self.variables[index].name;
            let listed = lists.entry(list).or_default();
            if listed.contains(&index) {
                broken.push(format!("{list}: {name} occurs twice"));
            }
            listed.push(index);
            let dependencies: Vec<&str> = element.get("dependencies").split_whitespace().collect();
            if let Some(unknown) = dependencies.iter().find(|text| self.named(text).is_none()) {
                broken.push(format!("{list}: {name} depends on {unknown}, which does not refer to a variable"));
            }
            let kinds = element.get("dependenciesKind").split_whitespace().count();
            if element.attributes.contains_key("dependenciesKind") && kinds != dependencies.len() {
                broken.push(format!(
                    "{list}: {name} has {kinds} entries in dependenciesKind, but {} in dependencies",
                    dependencies.len()
                ));
            }
        }
        let of = |name: &str| lists.get(name).cloned().unwrap_or_default();
        let [outputs, derivatives, initial] = if self.is_3 {
            ["Output", "ContinuousStateDerivative", "InitialUnknown"].map(of)
        } else {
            ["Outputs", "Derivatives", "InitialUnknowns"].map(of)
        };
        let is_output = |v: &Variable| v.get("causality") == "output" && (!self.is_3 || v.kind != "Clock");
        for (index, variable) in self.variables.iter().enumerate() {
            let name = &variable.name;
            if is_output(variable) != outputs.contains(&index) {
                let fault = if is_output(variable) { "is missing" } else { "is not an output" };
                broken.push(format!("the outputs in ModelStructure: {name} {fault}"));
            }
            let is_computed = matches!(variable.get("initial"), "approx" | "calculated");
            let is_unknown = is_computed && (is_output(variable) || variable.get("causality") == "calculatedParameter");
            if is_unknown && !initial.contains(&index) {
                broken.push(format!("the initial unknowns in ModelStructure: {name} is missing"));
            }
            if variable.get("reinit") == "true" {
                let is_state = derivatives
                    .iter()
                    .any(|d| self.named(self.variables[*d].get("derivative")).is_some_and(|state| state == index));
                if !is_state {
                    broken
                        .push(format!("{name}: the variable has the attribute reinit, but is not a continuous state"));
                }
            }
        }
        for index in derivatives.iter().filter(|index| self.variables[**index].get("derivative").is_empty()) {
            broken.push(format!(
                "the derivatives in ModelStructure: {} is not the derivative of a variable",
                self.variables[*index].name
            ));
        }
        if !self.is_3 && !initial.is_sorted() {
            broken.push("the initial unknowns in ModelStructure are not in ascending order".to_owned());
        }
        self.broken.extend(broken);
    }
}

#[cfg(test)]
mod tests;
