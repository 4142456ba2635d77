//! Systems of FMUs: the examples, a user's own system, invalid systems. The schema and the reader agree.
#![allow(clippy::unwrap_used)]

#[path = "../../tests/support/folder.rs"]
mod folder;

use fmu_build::ssp::{Packable, System};
use fmu_build::workspace::Workspace;
use fmu_build::xml::ssv;
use folder::Folder;
use linkage_fmu::component::Component;
use linkage_fmu::variables::Value as Start;
use roxmltree::{Document, Node};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

fn descriptions() -> PathBuf {
    Workspace::locate().descriptions()
}

/// Text of the structure of a system.
fn structure(path: &Path) -> anyhow::Result<String> {
    packable(path).map(|package| package.structure)
}

fn packable(path: &Path) -> anyhow::Result<Packable> {
    let (system, sources) = System::read(&Workspace::locate(), path)?;
    let models: Vec<Component> = sources
        .iter()
        .map(|source| Component::from_definition(source.kind(), &source.text().unwrap()).unwrap())
        .collect();
    system.packable(&models.iter().collect::<Vec<_>>())
}

/// All elements of this name.
fn all<'a>(document: &'a Document, name: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(move |node| node.tag_name().name() == name)
}

/// Connections as `part.output -> part.input`, sorted by name.
fn connections(document: &Document) -> Vec<String> {
    let end = |node: &Node, end: &str| {
        let of = |part: &str| node.attribute(format!("{end}{part}").as_str()).unwrap().to_owned();
        format!("{}.{}", of("Element"), of("Connector"))
    };
    let mut found: Vec<_> =
        all(document, "Connection").map(|node| format!("{} -> {}", end(&node, "start"), end(&node, "end"))).collect();
    found.sort();
    found
}

#[test]
fn terminals_connect_all_that_drive_and_actuator_have_in_common() {
    let text = structure(&descriptions().join("LandingGearRetractionWithHydraulics.json")).unwrap();
    let document = Document::parse(&text).unwrap();
    let mut expected: Vec<_> = [
        "acceleration",
        "holding_force",
        "holding_force_derivative",
        "length",
        "lower_limit",
        "reduced_mass",
        "reduced_mass_derivative",
        "speed",
        "upper_limit",
    ]
    .map(|name| format!("gear.actuator.{name} -> hydraulics.actuator.{name}"))
    .to_vec();
    expected.push("hydraulics.preview.force_mean -> gear.actuator.force".to_owned());
    assert_eq!(connections(&document), expected);
    let values: Vec<_> = all(&document, "Parameter")
        .map(|node| (node.attribute("name").unwrap(), node.first_element_child().unwrap().attribute("value").unwrap()))
        .collect();
    let ramp = [("command.ramp_amplitude", "0.65"), ("command.ramp_time", "0.1")];
    assert_eq!(values, [&[("downstop.enabled", "false")], &ramp[..]].concat());
    let experiment = all(&document, "DefaultExperiment").next().unwrap();
    assert_eq!(experiment.attribute("stopTime"), Some("4.5"));
}

#[test]
fn the_diagram_of_a_system_has_no_overlaps() {
    let text = structure(&descriptions().join("LandingGearSystem.json")).unwrap();
    let document = Document::parse(&text).unwrap();
    assert_eq!(connections(&document).len(), 3 + 2 * 10);
    let corners =
        |node: Node| ["x1", "y1", "x2", "y2"].map(|name| node.attribute(name).unwrap().parse::<f64>().unwrap());
    let whole = corners(all(&document, "SystemGeometry").next().unwrap());
    let areas: Vec<_> = all(&document, "ElementGeometry").map(corners).collect();
    assert_eq!(areas.len(), 3);
    for (index, a) in areas.iter().enumerate() {
        assert!(whole[0] < a[0] && whole[1] < a[1] && a[2] < whole[2] && a[3] < whole[3], "{a:?} in {whole:?}");
        for b in &areas[..index] {
            assert!(a[0] >= b[2] || b[0] >= a[2] || a[1] >= b[3] || b[1] >= a[3], "{a:?} and {b:?}");
        }
    }
    for connector in all(&document, "Connector") {
        let geometry = connector.children().find(|node| node.tag_name().name() == "ConnectorGeometry").unwrap();
        let x = geometry.attribute("x").unwrap();
        match connector.attribute("kind").unwrap() {
            "input" => assert_eq!(x, "0"),
            "output" => assert_eq!(x, "1"),
            other => panic!("{other}"),
        }
    }
}

/// Two copies of one mechanism, with the values of an SSV file and of the system file.
#[test]
fn values_of_a_system_are_in_the_units_of_the_variables_and_read_back() {
    let folder = Folder::new("values");
    folder.write(
        "heavy gear.ssv",
        r#"<ssv:ParameterSet version="1.0" name="heavy"
            xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
            xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
            <ssv:Parameters>
              <ssv:Parameter name="wheel.mass"><ssv:Real value="43" unit="lb"/></ssv:Parameter>
              <ssv:Parameter name="crank.mass"><ssv:Real value="15"/></ssv:Parameter>
            </ssv:Parameters>
            <ssv:Units><ssc:Unit name="lb"><ssc:BaseUnit kg="1" factor="0.45359237"/></ssc:Unit></ssv:Units>
            </ssv:ParameterSet>"#,
    );
    let gear = descriptions().join("LandingGearRetraction");
    let system = json!({
        "name": "Two",
        "fmus": {
            "left": {
                "definition": gear, "parameters": "heavy gear.ssv",
                "values": { "crank.mass": "14500 g", "actuator.force": "31 kN", "solver.method": "rigid_fem" },
            },
            "right": gear,
        },
        "connectors": ["left.crank.angle"],
    });
    let text = structure(&folder.write("system.json", system.to_string())).unwrap();
    let document = Document::parse(&text).unwrap();
    assert!(connections(&document).is_empty() && all(&document, "Connections").next().is_none(), "{text}");
    let sources: Vec<_> = all(&document, "Component").map(|node| node.attribute("source").unwrap()).collect();
    assert_eq!(sources, ["resources/LandingGearRetraction.fmu"; 2]);
    // The stop time is the longest stop time of the FMUs.
    assert_eq!(all(&document, "DefaultExperiment").next().unwrap().attribute("stopTime"), Some("0.15"));
    // The program can read the parameter set in the package.
    let set = all(&document, "ParameterSet").next().unwrap();
    let set = text[set.range()].replacen(
        "<ssv:ParameterSet",
        "<ssv:ParameterSet xmlns:ssv=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\" \
         xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\"",
        1,
    );
    let definition = fs::read_to_string(gear.join("resources/mechanism.json")).unwrap();
    let model = Component::from_definition("mechanism.json", &definition).unwrap();
    let read = ssv::read(&folder.write("read back.ssv", &set), model.interface()).unwrap();
    let read: Vec<_> = read.iter().map(|(r, value)| (&*model.interface().list()[*r as usize].name, value)).collect();
    let value = |name: &str| read.iter().find(|(own, _)| *own == name).unwrap().1.clone();
    assert_eq!(read.len(), 4, "{read:?}");
    assert_eq!(value("wheel.mass"), Start::Real(43.0 * 0.453_592_37));
    assert_eq!(value("crank.mass"), Start::Real(14.5));
    assert_eq!(value("actuator.force"), Start::Real(31e3));
    assert_eq!(value("solver.method"), Start::Item("rigid_fem".into()));
    let enumeration = all(&document, "Enumeration").find(|node| node.attribute("name").is_some()).unwrap();
    assert_eq!(enumeration.attribute("name"), Some("solver.method.item"));
}

/// The demanded acceleration of the second cart is the acceleration of the first, and the force on the first cart is
/// the required force of the second.
#[test]
fn algebraic_loops_and_unconnected_fmus_give_warnings() {
    let folder = Folder::new("warnings");
    let cart = folder.write(
        "cart.json",
        r#"{ "name": "Cart", "bodies": { "ground": {}, "cart": { "mass": 2 } },
        "joints": { "rail": { "type": "prismatic", "first": "ground.origin", "second": "cart.origin" } },
        "actuators": { "push": { "joint": "rail", "force": 0 } },
        "start": { "joint": "rail", "position": 0, "speed": 0 }, "guess": { "rail": 0 } }"#,
    );
    let back = ["second.push.required_force", "first.push.force"];
    for (connections, lonely, has_loop) in [
        (json!([["first.push.acceleration", "second.push.demanded_acceleration"], back]), &["third"][..], true),
        (json!([back]), &["third"], false),
        (json!([]), &["first", "second", "third"], false),
    ] {
        let fmus = json!({ "first": cart, "second": cart, "third": cart });
        let system = json!({ "name": "Carts", "fmus": fmus, "connections": connections });
        let path = folder.write("carts.json", system.to_string());
        let warnings = packable(&path).unwrap().warnings;
        let about = |words: &str| warnings.iter().filter(|line| line.contains(words)).count();
        let looped = "connections: first.push.acceleration, second.push.required_force depend on each other";
        assert_eq!((about(looped), about("algebraic loop")), (usize::from(has_loop), usize::from(has_loop)));
        assert!(lonely.iter().all(|name| about(&format!("fmus.{name}: this FMU has no connection")) == 1));
        assert_eq!(warnings.len(), lonely.len() + usize::from(has_loop), "{warnings:?}");
    }
}

#[test]
fn all_faults_are_named_with_place_and_remedy() {
    let folder = Folder::new("faults");
    folder.write("wrong.ssv", "<ssv:ParameterSet");
    let [gear, oil, bar] =
        ["LandingGearRetraction", "HydraulicActuator", "FourBar"].map(|name| descriptions().join(name));
    let fmus = json!({
        "gear": { "definition": gear, "parameters": "wrong.ssv", "values": { "crank.mass": -1, "crank.lenght": 1 } },
        "oil": { "definition": oil, "values": { "command.ramp_time": "2 m", "coupling.mode": "magic" } },
        "bar": bar,
    });
    let with = |key: &str, value: Value| {
        let fmus = json!({ "gear": gear, "oil": oil, "bar": bar });
        let mut system = json!({ "name": "System", "fmus": fmus });
        system[key] = value;
        system
    };
    for (system, said) in [
        (
            json!({ "name": "System", "fmus": fmus }),
            &[
                "fmus.gear.parameters: ",
                "wrong.ssv",
                "the text is not XML",
                "fmus.gear.values.crank.lenght: there is no variable \"crank.lenght\": the most similar names are",
                "fmus.gear.values: ",
                "crank.mass",
                "(line 1, column ",
                "fmus.oil.values.command.ramp_time: the unit of command.ramp_time is s or ms or min, not \"m\"",
                "coupling.mode must be one of preview, follow, delayed, not \"magic\"",
            ][..],
        ),
        (json!({ "name": "System" }), &["the key `fmus` is missing"]),
        (json!({ "name": "My System", "fmus": {}, "fmu": {} }), &["there is no key `fmu` here; did you mean `fmus`?"]),
        (
            json!({ "name": "My System", "fmus": {} }),
            &["name = \"My System\": must be a name", "fmus: the object is empty"],
        ),
        (json!({ "name": "A", "stop_time": 0, "fmus": { "a.b": gear } }), &["stop_time = 0", "fmus.a.b = \"a.b\""]),
        (
            json!({ "name": "A", "fmus": { "a": "nowhere" } }),
            &["fmus.a.definition: ", "there is no such file or folder"],
        ),
        (
            with(
                "connections",
                json!([
                    ["gear.crank.angle", "oil.valve.command"],
                    ["gear.crank.angel", "oil.valve.command"],
                    ["wheel.a", "oil.valve.command"],
                    ["gear", "oil.valve.command"],
                    ["gear.crank.angle"],
                    ["gear.actuator.force", "oil.preview.force_mean"],
                    ["gear.crank.mass", "oil.actuator.length"],
                    ["gear.actuator.length", "oil.actuator.length"],
                    ["gear.actuator.length", "oil.actuator.length"],
                ]),
            ),
            &[
                "connections[0]: gear.crank.angle has the unit rad, but oil.valve.command has the unit 1; connect",
                "connections[1]: gear: there is no variable \"crank.angel\": the most similar names are crank.angle",
                "connections[2]: the system has no FMU \"wheel\": the most similar names are gear",
                "connections[3]: \"gear\" names no FMU",
                "connections[4]: the entry has 1 names; write two names",
                "connections[5]: gear.actuator.force is an input and oil.preview.force_mean is an output; exchange",
                "connections[6]: gear.crank.mass is a variable of causality parameter",
                "connections[8]: oil.actuator.length already has a connection with gear.actuator.length; remove one",
            ],
        ),
        (
            with(
                "terminals",
                json!([
                    ["gear.actuator", "bar.drive"],
                    ["gear.wheel", "oil.actuator"],
                    ["gear.actuator", "gear.actuator"],
                    ["oil.actuator", "gear.actuator"],
                    ["gear.actuator", "oil.actuator"],
                ]),
            ),
            &[
                "terminals[0]: gear.actuator is a drive along the quantity length, but bar.drive along the quantity",
                "terminals[1]: gear has no terminal \"wheel\": its terminals are actuator",
                "terminals[2]: gear.actuator.force and gear.actuator.force are both inputs; connect the drive of a",
                "terminals[4]: gear.actuator.force already has a connection with oil.preview.force_mean",
            ],
        ),
        (with("connectors", json!(["gear.crank.angl"])), &["connectors[0]: gear: there is no variable \"crank.angl\""]),
    ] {
        let message = format!("{:#}", structure(&folder.write("wrong.json", system.to_string())).unwrap_err());
        for words in said {
            assert!(message.contains(words), "{words} is not in\n{message}");
        }
        assert!(!message.contains("terminals[3]") && !message.contains("connections[7]"), "{message}");
    }
}

#[test]
fn the_schema_agrees_with_the_reader() {
    let folder = Folder::new("schema");
    let schema = fs::read_to_string(descriptions().join("system.schema.json")).unwrap();
    let validator = jsonschema::draft202012::new(&serde_json::from_str(&schema).unwrap()).unwrap();
    for name in ["LandingGearRetractionWithHydraulics.json", "LandingGearSystem.json"] {
        let text = fs::read_to_string(descriptions().join(name)).unwrap();
        assert!(validator.is_valid(&serde_json::from_str(&text).unwrap()), "{name}");
    }
    let gear = descriptions().join("LandingGearRetraction");
    for (system, is_right) in [
        (json!({ "name": "A", "fmus": { "a": gear } }), true),
        (json!({ "name": "A b", "fmus": { "a": gear } }), false),
        (json!({ "name": "A", "fmus": { "a.b": gear } }), false),
        (json!({ "name": "A", "fmus": { "a": {} } }), false),
        (json!({ "name": "A", "fmus": { "a": { "definition": gear, "values": { "crank.mass": [1] } } } }), false),
        (json!({ "name": "A", "fmus": { "a": { "definition": gear, "values": { "crank.mass": 12 } } } }), true),
        (json!({ "name": "A", "fmus": { "a": gear }, "stop_time": 0 }), false),
        (json!({ "name": "A", "fmus": { "a": gear }, "connections": ["a.crank.angle"] }), false),
        (json!({ "name": "A", "fmus": { "a": gear }, "connectors": ["a.crank.angle"] }), true),
        (json!({ "name": "A", "fmus": { "a": gear }, "connector": [] }), false),
    ] {
        let read = structure(&folder.write("system.json", system.to_string()));
        assert_eq!(validator.is_valid(&system), is_right, "the schema: {system}");
        assert_eq!(read.is_ok(), is_right, "the reader: {system}: {read:?}");
    }
}
