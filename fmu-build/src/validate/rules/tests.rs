use super::*;
use crate::workspace::Workspace;
use crate::xml::fmi3;
use fmu_cli::Naming;
use linkage_fmu::component::Component;

const SECOND: &str = include_str!("second.xml");
const THIRD: &str = include_str!("third.xml");

#[test]
fn each_rule_is_checked() {
    assert_eq!(broken(SECOND), Vec::<String>::new());
    for (old, new, said) in [
        ("guid=\"{1}\"", "guid=\"\"", "guid is empty"),
        ("modelIdentifier=\"ab\"", "modelIdentifier=\"a b\"", "\"a b\" is not a C identifier"),
        ("stopTime=\"1\"", "stopTime=\"-1\"", "before its start"),
        ("stepSize=\"0.1\"", "stepSize=\"0\"", "stepSize of the default experiment is not above 0"),
        ("name=\"u\"", "name=\"p\"", "\"p\" occurs twice"),
        ("<Category name=\"logAll\"/>", "<Category name=\"a\"/><Category name=\"a\"/>", "\"a\" occurs twice"),
        (
            "initial=\"exact\"",
            "initial=\"calculated\"",
            "p: the combination of causality parameter and variability fixed with initial",
        ),
        (
            "variability=\"fixed\"",
            "variability=\"continuous\"",
            "p: the combination of causality parameter with variability continuous",
        ),
        (
            "variability=\"discrete\"",
            "variability=\"continuous\"",
            "b: a variable of type Enumeration cannot have the variability continuous",
        ),
        (" start=\"1\"", "", "p: the variable has no start value"),
        ("<Real derivative=\"2\"/>", "<Real derivative=\"2\" start=\"1\"/>", "y: the variable has a start value"),
        ("max=\"2\"", "max=\"-2\"", "p: the attribute max = -2 is below the attribute min = 0"),
        ("start=\"1\"", "start=\"3\"", "p: the start value 3 is not between the attributes min and max"),
        ("nominal=\"1\"", "nominal=\"0\"", "u: the nominal value is not above 0"),
        ("unit=\"rad\"", "unit=\"m\"", "u: the unit m has no definition"),
        ("displayUnit=\"deg\"", "displayUnit=\"grad\"", "u: the unit rad has no display unit grad"),
        ("declaredType=\"t\"", "declaredType=\"s\"", "b: the type s has no definition"),
        (
            "derivative=\"2\"",
            "derivative=\"4\"",
            "y: the attribute derivative = 4 does not refer to a continuous variable",
        ),
        ("valueReference=\"1\"", "valueReference=\"0\"", "p, u have different units, but the same value reference 0"),
        ("<Outputs><Unknown index=\"3\"", "<Outputs><Unknown index=\"2\"", "y is missing"),
        (
            "<Outputs><Unknown index=\"3\"",
            "<Outputs><Unknown index=\"9\"",
            "Outputs: the entry 9 does not refer to a variable",
        ),
        ("dependencies=\"2\"", "dependencies=\"7\"", "y depends on 7, which does not refer to a variable"),
        (
            "dependenciesKind=\"dependent\"",
            "dependenciesKind=\"\"",
            "y has 0 entries in dependenciesKind, but 1 in dependencies",
        ),
        ("<Unknown index=\"3\" dependencies=\"1 2\"/>", "", "the initial unknowns in ModelStructure: y is missing"),
        (
            "start=\"0\"/></Sc",
            "start=\"0\" reinit=\"true\"/></Sc",
            "u: the variable has the attribute reinit, but is not a continuous state",
        ),
    ] {
        assert!(SECOND.contains(old), "{old}");
        let found = broken(&SECOND.replacen(old, new, 1));
        assert!(found.iter().any(|line| line.contains(said)), "{said}: {found:?}");
    }
}

/// The packed descriptions of FMI 2.0, and one description of FMI 3.0 for each kind of model, break no rule.
#[test]
fn every_description_fulfils_the_rules() {
    let workspace = Workspace::locate();
    for folder in workspace.description_folders().unwrap() {
        let text = std::fs::read_to_string(folder.join("modelDescription.xml")).unwrap();
        assert_eq!(broken(&text), Vec::<String>::new(), "{}", folder.display());
    }
    let names = ["FourBar", "HydraulicActuator", "HydraulicSystem"];
    for (name, file) in names.into_iter().zip(Component::definition_files()) {
        let path = workspace.descriptions().join(name).join("resources").join(file);
        let component = Component::from_definition(file, &std::fs::read_to_string(path).unwrap()).unwrap();
        assert_eq!(broken(&fmi3::to_xml(&component, Naming::default()).unwrap()), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn rules_hold_for_both_versions() {
    assert_eq!(broken(THIRD), Vec::<String>::new());
    for (old, new, said) in [
        ("instantiationToken=\"{1}\"", "instantiationToken=\"\"", "instantiationToken is empty"),
        ("valueReference=\"0\"", "valueReference=\"1\"", "u, y have the same value reference 1"),
        ("<Output valueReference=\"1\"", "<Output valueReference=\"0\"", "y is missing"),
        (" start=\"0\"", "", "u: the variable has no start value"),
    ] {
        let found = broken(&THIRD.replacen(old, new, 1));
        assert!(found.iter().any(|line| line.contains(said)), "{said}: {found:?}");
    }
    assert_eq!(broken("no XML <"), Vec::<String>::new());
}
