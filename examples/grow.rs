use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::reduced::Reduced;
fn main() {
    let text = r#"{ "name": "Carriage",
          "bodies": { "ground": {}, "carriage": { "length": 0.02, "mass": 3, "inertia": 0.01 } },
          "joints": { "rail": { "type": "prismatic", "first": "ground.origin", "second": "carriage.origin" } },
          "actuators": { "push": { "joint": "rail" } },
          "start": { "joint": "rail", "position": 0.5, "speed": 0 }, "guess": { "rail": 0 } }"#;
    let reduced = Reduced::new(&Mechanism::from_json(text).unwrap()).unwrap();
    println!("{:?} closed {} panels {}", reduced.curve().range, reduced.curve().closed, reduced.influence().panels());
    let mut s = &reduced;
    loop {
        match reduced.next(s, 1) {
            Ok(n) => { s = n; println!("{} {:?} closed {} panels {}", s.curve().farthest, s.curve().range, s.curve().closed, s.influence().panels()); }
            Err(e) => { println!("{e:?}"); break }
        }
    }
}
