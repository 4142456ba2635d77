//! x
use linkage_fmu::mechanism::Model;
fn main() {
    for mass in [0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0, 100.0] {
        for up in [1.5707963267948966, 0.0, 1.0] {
            for speed in [0.0, 1.0, -1.0, 10.0] {
                for (vs, vd) in [(1e-3, 0.05), (1e-2, 1.0)] {
                    for mu in [[0.3, 0.1], [0.3, 0.3], [0.3, 0.2]] {
                        for g in [9.81] {
                            for tol in ["1e-9", "1e-6", "1e-12"] {
                                let text = format!(
                                    r#"{{ "name": "Block", "bodies": {{"ground": {{}}, "block": {{"mass": {mass}}}}},
      "joints": {{"slide": {{"type": "prismatic", "first": "ground.origin", "second": "block.origin"}}}},
      "gravity": {{"acceleration": {g}, "up_angle": {up}}},
      "friction": {{"enabled": true, "static_coefficient": {}, "kinetic_coefficient": {}, "static_speed": {vs}, "kinetic_speed": {vd}}},
      "actuators": {{"push": {{"joint": "slide", "force": -4000}}}},
      "start": {{"joint": "slide", "position": 0.0, "speed": {speed}}}, "guess": {{"slide": 0.0}}, "solver": {{"tolerance": {tol}}} }}"#,
                                    mu[0], mu[1]
                                );
                                let mut m = match Model::from_json(&text) {
                                    Ok(m) => m,
                                    Err(e) => {
                                        println!("{e}");
                                        return;
                                    }
                                };
                                let f = m.variables().find("push.force").unwrap();
                                m.initialize().unwrap();
                                for n in 0..60 {
                                    if n % 7 == 3 {
                                        let v = m.real(f).unwrap();
                                        m.set_real(f, -v).unwrap();
                                    }
                                    if n % 13 == 12 {
                                        m.set_real(f, 0.0).unwrap();
                                    }
                                    if n % 13 == 0 {
                                        m.set_real(f, -4000.0).unwrap();
                                    }
                                    if let Err(e) = m.step(7e-3) {
                                        println!("{mass} {up} {speed} {e}");
                                        break;
                                    }
                                    let mut bytes = Vec::new();
                                    m.snapshot().write(&mut bytes).unwrap();
                                    if let Some(e) = m.read_snapshot(&bytes).err() {
                                        println!("{mass} {up} {speed} {vs} {mu:?} {tol} step {n} {e}");
                                        break;
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}
