//! `cargo fmu linearise`: the table contains the numbers of the engine, and the picture is drawn.
#![allow(clippy::unwrap_used)]

#[path = "../../../tests/support/folder.rs"]
mod folder;

use fmu_build::workspace::Workspace;
use fmu_studies::linearise::{self, Arguments};
use folder::Folder;
use linkage_fmu::component::{Component, Linearisation};
use std::fs;

/// A pendulum of 2 kg at 0.5 m with a motor and a damper in its pivot.
const PENDULUM: &str = r#"{
  "name": "Pendulum",
  "gravity": { "acceleration": 9.81, "up_angle": 1.5707963267948966 },
  "bodies": { "ground": {}, "rod": { "length": 0.5, "mass": 2, "center": [0.5, 0] } },
  "joints": { "pivot": { "type": "revolute", "first": "ground.origin", "second": "rod.origin" } },
  "actuators": { "motor": { "joint": "pivot", "torque": 0 } },
  "springs": { "damper": { "joint": "pivot", "damping": 0.1 } },
  "start": "equilibrium",
  "guess": { "rod": -1.2 }
}"#;

#[test]
fn the_table_has_the_numbers_of_the_engine() {
    let folder = Folder::new("linearise");
    let path = folder.write("mechanism.json", PENDULUM);
    let (table, picture) = (folder.join("modes.csv"), folder.join("modes.svg"));
    let mut arguments = Arguments {
        path,
        coordinate: Some("rod.angle".to_owned()),
        held_by: Some("motor.torque".to_owned()),
        outputs: vec!["rod.acceleration".to_owned()],
        count: 12,
        output_file: Some(table.clone()),
        plot: Some(picture.clone()),
        ..Arguments::default()
    };
    linearise::run(&Workspace::locate(), &arguments).unwrap();

    let mut model = Component::from_definition("mechanism.json", PENDULUM).unwrap();
    let find = |name: &str| model.interface().find(name).unwrap();
    let what = Linearisation {
        coordinate: find("rod.angle"),
        inputs: vec![find("motor.torque"), find("load_factor")],
        outputs: vec![find("rod.acceleration")],
        held_by: Some(find("motor.torque")),
    };
    let all = model.linearise(&what, 12).unwrap();
    let mut rows = csv::Reader::from_path(&table).unwrap();
    let names: Vec<String> = rows.headers().unwrap().iter().map(str::to_owned).collect();
    let column = |name: &str| names.iter().position(|other| other == name).unwrap();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 13);
    for (row, at) in rows.iter().zip(&all) {
        let value = |name: &str| row[column(name)].parse::<f64>().unwrap().to_bits();
        let expected = [
            ("rod.angle", at.coordinate),
            ("acceleration", at.acceleration),
            ("motor.torque", at.holding.unwrap()),
            ("eigenfrequency", at.eigenfrequency()),
            ("damping_ratio", at.damping_ratio),
            ("eigenvalue2.im", at.eigenvalues[1][1]),
            ("A21", at.a[1][0]),
            ("B2(load_factor)", at.b[1][1]),
            ("C1(rod.acceleration)", at.c[0][0]),
            ("D(rod.acceleration; motor.torque)", at.d[0][0]),
        ];
        for (name, expected) in expected {
            assert!(value(name) == expected.to_bits() || expected.is_nan(), "{name}");
        }
    }
    assert!(all.iter().any(|at| at.omega > 1.0) && all.iter().any(|at| at.omega.is_nan()));
    let drawn = fs::read_to_string(&picture).unwrap();
    for word in ["eigenfrequency", "damping ratio", "rod.angle [deg]", "[Hz]", "eigenvalue 2, imaginary"] {
        assert!(drawn.contains(word), "{word}");
    }

    arguments.held_by = Some("load_factor".to_owned());
    let refused = format!("{:#}", linearise::run(&Workspace::locate(), &arguments).unwrap_err());
    assert!(refused.contains("load_factor") && refused.contains("force or torque of a drive"), "{refused}");
    arguments.held_by = None;
    arguments.coordinate = Some("rod.speed".to_owned());
    let refused = format!("{:#}", linearise::run(&Workspace::locate(), &arguments).unwrap_err());
    assert!(refused.contains("rod.speed") && refused.contains("angle of a body"), "{refused}");
    arguments.path = Workspace::locate().descriptions().join("HydraulicActuator");
    arguments.coordinate = None;
    let refused = format!("{:#}", linearise::run(&Workspace::locate(), &arguments).unwrap_err());
    assert!(refused.contains("no travel"), "{refused}");
}
