#![allow(clippy::unwrap_used)]
use linkage_fmu::model::Model;
const GEAR: &str = include_str!("../modelDescription/LandingGearRetraction/resources/mechanism.json");
fn set(m: &mut Model, v: &[(&str, f64)]) {
    for (n, x) in v {
        let r = m.variables().find(n).unwrap();
        m.set_real(r, *x).unwrap();
    }
}
fn flag(m: &mut Model, n: &str, b: bool) {
    let r = m.variables().find(n).unwrap();
    m.set_boolean(r, b).unwrap();
}
fn get(m: &mut Model, n: &str) -> f64 {
    let r = m.variables().find(n).unwrap();
    m.real(r).unwrap()
}
#[test]
fn drop() {
    let mut m = Model::from_json(GEAR).unwrap();
    set(&mut m, &[("crank.start_angle", 0.5), ("actuator.force", -20_000.0), ("downstop.restitution", 0.5)]);
    m.initialize().unwrap();
    for i in 0..400 {
        m.step(1e-3).unwrap();
        let a = get(&mut m, "crank.angle");
        let w = get(&mut m, "crank.speed");
        if a > 0.8 || i % 40 == 0 {
            println!("{i} {a} {:e} {w} {:?}", a - 0.8, m.statistics());
        }
        if a > 0.8 + 1e-13 {
            break;
        }
    }
}
#[test]
fn bumper() {
    let mut m = Model::from_json(GEAR).unwrap();
    flag(&mut m, "upstop.rigid", false);
    set(&mut m, &[("upstop.angle", -1.2), ("upstop.stiffness", 2e5), ("upstop.damping", 2e3)]);
    m.initialize().unwrap();
    for i in 0..300 {
        m.step(1e-3).unwrap();
        let a = get(&mut m, "crank.angle");
        let w = get(&mut m, "crank.speed");
        if i % 5 == 0 {
            println!(
                "{i} {a} {w} {} drift {:e} {:?}",
                get(&mut m, "upstop.torque"),
                get(&mut m, "energy.drift"),
                m.statistics()
            );
        }
    }
}
#[test]
fn locked() {
    let mut m = Model::from_json(GEAR).unwrap();
    flag(&mut m, "friction.enabled", true);
    set(
        &mut m,
        &[
            ("crank.start_angle", -1.1398962970485083),
            ("crank.start_speed", -12.631764519219846),
            ("actuator.force", 0.0),
            ("load_factor", 0.0),
            ("upstop.restitution", 0.7342944442626272),
            ("downstop.restitution", 0.7342944442626272),
        ],
    );
    m.initialize().unwrap();
    println!("{:?}", m.step(0.06417552940853882));
    println!("{:?}", m.real(m.variables().find("crank.acceleration").unwrap()));
    flag(&mut m, "friction.enabled", false);
    m.initialize().unwrap();
    for j in 1..5 {
        println!("{} {}", get(&mut m, &format!("joint{j}.force_x")), get(&mut m, &format!("joint{j}.force_y")));
    }
}
