//! Mechanisms in which several loops become singular in one position: scissor lifts, inversors.

use crate::support::definition::{pin, rod, slide, weight};
use crate::support::numeric::pseudo_random;
use crate::support::{Run, Vec2, turned};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn mechanism(bodies: &Value, joints: &Value, drive: &str, start: &Value, guess: &Value) -> String {
    json!({
        "name": "Singular", "gravity": weight(),
        "bodies": bodies, "joints": joints, "torques": { "drive": { "on": drive } },
        "start": start, "guess": guess, "solver": { "tolerance": 1e-12 }
    })
    .to_string()
}

/// Angle of the line between two points.
fn angle(from: Vec2, to: Vec2) -> f64 {
    (to.y - from.y).atan2(to.x - from.x)
}

/// Length of the bars of the scissor lift [m].
const BAR: f64 = 1.2;

/// A scissor lift. In each stage the bars a at the angle phi and b at pi - phi have a pin in their middle.
fn scissor_lift(stages: usize, phi: f64, speed: f64, [mass, carriage]: [f64; 2]) -> String {
    let mut bodies = json!({ "ground": { "length": 1.0 }, "carriage": { "mass": carriage, "inertia": 0.01 } });
    let rail = slide("ground.origin", "carriage.origin", 0.0);
    let mut joints = json!({ "rail": rail });
    let mut guess = json!({ "rail": BAR * phi.cos() });
    for k in 1..=stages {
        let mut bar = rod(BAR, mass);
        bar["points"] = json!({ "mid": [0.5 * BAR, 0.0] });
        (bodies[format!("a{k}")], bodies[format!("b{k}")]) = (bar.clone(), bar);
        (guess[format!("a{k}")], guess[format!("b{k}")]) = (json!(phi), json!(PI - phi));
        joints[format!("mid{k}")] = pin(&format!("a{k}.mid"), &format!("b{k}.mid"));
        let [left, right] = if k == 1 {
            ["ground.origin".into(), "carriage.origin".into()]
        } else {
            ["b", "a"].map(|bar| format!("{bar}{}.end", k - 1))
        };
        joints[format!("left{k}")] = pin(&left, &format!("a{k}.origin"));
        joints[format!("right{k}")] = pin(&right, &format!("b{k}.origin"));
    }
    mechanism(&bodies, &joints, "a1", &json!({ "body": "a1", "angle": phi, "speed": speed }), &guess)
}

/// Kinetic and potential energy of the lift in closed form. The middle of stage k = 1 .. n is at (l cos(phi) / 2, (k -
/// 1/2) l sin(phi)), the carriage at (l cos(phi), 0).
fn scissor_energy(stages: usize, phi: f64, speed: f64, [mass, carriage]: [f64; 2]) -> f64 {
    let (sin, cos) = phi.sin_cos();
    let mut energy = 0.5 * carriage * (BAR * sin * speed).powi(2);
    for k in 0..stages {
        let up = (k as f64 + 0.5) * BAR;
        let motion = (0.5 * BAR * sin).powi(2) + (up * cos).powi(2) + BAR * BAR / 12.0;
        energy += 2.0 * mass * (0.5 * motion * speed * speed + 9.81 * up * sin);
    }
    energy
}

/// The tables have errors of 1e-13 of the largest speed of a bar. For the same energy this speed is up to some 20 n
/// times larger in the position with all bars in one line than elsewhere.
fn a_lift_passes_its_singular_positions(stages: usize, masses: [f64; 2], turns: f64) {
    let allowed = 1e-9_f64.max(1e-10 * stages as f64);
    // Fast enough for full turns, through the flat position and the position with all bars in one line.
    let mut rise = 40.0 * (stages as f64 * BAR);
    rise = rise.max(100.0);
    let (start, speed) = (0.7, -rise.sqrt());
    let mut lift = Run::new(scissor_lift(stages, start, speed, masses)).started();
    let energy = scissor_energy(stages, start, speed, masses);
    let mut least = start;
    while least > start - turns * 2.0 * PI {
        lift.step(0.013);
        let (phi, speed) = (lift.get("a1.angle"), lift.get("a1.speed"));
        assert!(phi < least, "{stages} stages: turns back at {phi}");
        least = phi;
        for k in [1, stages] {
            let [a, b] = ["a", "b"].map(|bar| lift.get(&format!("{bar}{k}.angle")));
            assert!((a - phi).abs() < 1e-11 && (b - (PI - phi)).abs() < 1e-11, "{stages} stages at {phi}: {a} {b}");
        }
        assert!((lift.get("rail.position") - BAR * phi.cos()).abs() < 1e-11);
        let now = scissor_energy(stages, phi, speed, masses);
        assert!((now - energy).abs() < allowed * energy, "{stages} stages at {phi}: {now} of {energy}");
    }
}

#[test]
fn scissor_lifts_of_any_number_of_stages_pass_straight_on() {
    for (stages, turns) in [(1, 3.0), (2, 3.0), (3, 3.0), (4, 1.0), (5, 1.0), (7, 1.0), (10, 1.0), (20, 1.0), (40, 1.0)]
    {
        a_lift_passes_its_singular_positions(stages, [1.0, 1.0], turns);
    }
    a_lift_passes_its_singular_positions(80, [1.0, 1.0], 0.3);
}

#[test]
fn scissor_lifts_pass_whatever_their_masses() {
    let mut random = pseudo_random(7);
    for _ in 0..10 {
        let masses = [0.05 + 3.0 * random(), 0.05 + 3.0 * random()];
        a_lift_passes_its_singular_positions(3, masses, 1.0);
    }
}

/// Peaucellier's inversor: its end P moves on the straight line x = (l^2 - s^2) / (2 a), also through the positions in
/// which its halves coincide and all its loops are singular.
#[test]
fn peaucelliers_inversor_draws_a_straight_line_whatever_the_masses() {
    let (a, l, s) = (0.5, 1.5, 0.6);
    let start: f64 = 0.5;
    let b = Vec2::new(a, 0.0) + a * Vec2::new(start.cos(), start.sin());
    let half = ((l * l + b.norm_squared() - s * s) / (2.0 * l * b.norm())).acos();
    let along = angle(Vec2::zeros(), b);
    let [c, d] = [along + half, along - half].map(|t: f64| l * Vec2::new(t.cos(), t.sin()));
    let p = (l * l - s * s) / b.norm_squared() * b;
    let mut random = pseudo_random(3);
    for case in 0..100 {
        let names = ["crank", "oc", "od", "cb", "db", "cp", "dp"];
        let lengths = [a, l, l, s, s, s, s];
        let mut bodies = json!({ "ground": { "length": a } });
        for (name, length) in names.iter().zip(lengths) {
            bodies[name] = rod(length, 0.1 + 5.0 * random().powi(2));
        }
        let joints = json!({
            "a": pin("ground.end", "crank.origin"), "o1": pin("ground.origin", "oc.origin"),
            "o2": pin("ground.origin", "od.origin"), "c1": pin("oc.end", "cb.origin"), "c2": pin("oc.end", "cp.origin"),
            "d1": pin("od.end", "db.origin"), "d2": pin("od.end", "dp.origin"), "b1": pin("crank.end", "cb.end"),
            "b2": pin("crank.end", "db.end"), "p": pin("cp.end", "dp.end")
        });
        let guess = json!({
            "crank": start, "oc": along + half, "od": along - half, "cb": angle(c, b), "db": angle(d, b),
            "cp": angle(c, p), "dp": angle(d, p)
        });
        let begin = json!({ "body": "crank", "angle": start, "speed": 9.0 });
        let mut inversor = Run::new(mechanism(&bodies, &joints, "crank", &begin, &guess)).started();
        let energy = inversor.get("energy.kinetic") + inversor.get("energy.potential");
        let mut swapped = [false; 2];
        for _ in 0..if case < 10 { 150 } else { 30 } {
            inversor.step(0.011);
            let [oc, od, cp] = ["oc", "od", "cp"].map(|body| inversor.get(&format!("{body}.angle")));
            let end = turned(Vec2::new(l, 0.0), oc) + turned(Vec2::new(s, 0.0), cp);
            assert!((end.x - (l * l - s * s) / (2.0 * a)).abs() < 1e-11, "case {case}: {}", end.x);
            swapped[usize::from(oc < od)] = true;
            let now = inversor.get("energy.kinetic") + inversor.get("energy.potential");
            assert!((now - energy).abs() < 1e-9 * energy.abs().max(10.0), "case {case}: {now} of {energy}");
        }
        assert_eq!(swapped, [true; 2], "case {case} must pass the position in which the halves coincide");
    }
}

/// Hart's inversor: an antiparallelogram with O, P and Q at the same fraction of three of its sides. P moves on a
/// circle through O with its centre at E. Q then moves on the straight line normal to OE at the distance OP OQ / (2 OE)
/// from O, on the side opposite to E.
#[test]
fn harts_inversor_draws_a_straight_line_whatever_the_masses() {
    let (long, short, part, diagonal): (f64, f64, f64, f64) = (2.0, 1.0, 0.4, 1.9);
    let other = (long * long - short * short) / diagonal;
    let x = 0.5 * (diagonal + other);
    let y = (long * long - x * x).sqrt();
    let [a, b, c, d] = [Vec2::zeros(), Vec2::new(x, y), Vec2::new(diagonal, 0.0), Vec2::new(diagonal - x, y)];
    let o = a + part * (b - a);
    let p = a + part * (d - a) - o;
    let radius: f64 = 0.45;
    let to_center = angle(Vec2::zeros(), p) + (p.norm() / (2.0 * radius)).acos();
    let e = radius * Vec2::new(to_center.cos(), to_center.sin());
    let product = part * (1.0 - part) * (long * long - short * short);
    let mut random = pseudo_random(5);
    for case in 0..100 {
        let mut bar = |length: f64| {
            let mut bar = rod(length, 0.1 + 5.0 * random().powi(2));
            bar["points"] = json!({ "x": [part * length, 0.0] });
            bar
        };
        let bodies = json!({
            "ground": { "points": { "e": [e.x, e.y] } }, "crank": bar(radius), "ab": bar(long), "ad": bar(short),
            "cb": bar(short), "cd": bar(long)
        });
        let joints = json!({
            "e": pin("ground.e", "crank.origin"), "o": pin("ground.origin", "ab.x"), "p": pin("crank.end", "ad.x"),
            "a": pin("ab.origin", "ad.origin"), "b": pin("ab.end", "cb.end"), "c": pin("cb.origin", "cd.origin"),
            "d": pin("cd.end", "ad.end")
        });
        let crank = angle(e, p);
        let guess =
            json!({ "crank": crank, "ab": angle(a, b), "ad": angle(a, d), "cb": angle(c, b), "cd": angle(c, d) });
        let begin = json!({ "body": "crank", "angle": crank, "speed": 12.0 });
        let mut inversor = Run::new(mechanism(&bodies, &joints, "crank", &begin, &guess)).started();
        for _ in 0..60 {
            inversor.step(0.017);
            let [ab, cb] = ["ab", "cb"].map(|body| inversor.get(&format!("{body}.angle")));
            let q = turned(Vec2::new(long * (1.0 - part), 0.0), ab) - turned(Vec2::new(short * (1.0 - part), 0.0), cb);
            let along = q.dot(&e) / radius;
            assert!((along + product / (2.0 * radius)).abs() < 1e-11, "case {case}: {along}");
        }
    }
}
