//! Friction in mechanisms whose branches cross: at a crossing reactions may grow without bound.

use crate::support::definition::{self, G, With, pin, rod, slide, slider_crank, weight};
use crate::support::numeric::runge_kutta;
use crate::support::{CHAIN, Run, Vec2, changed};
use linkage_fmu::component::Component;
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A definition with gravity and with friction in all its joints.
fn rubbing(definition: Value) -> String {
    let friction = json!({ "enabled": true, "static_coefficient": 0.15, "kinetic_coefficient": 0.1 });
    changed(definition, |m| {
        m["friction"] = friction;
        m["gravity"] = weight();
        m["solver"] = json!({ "tolerance": 1e-9 });
        let joints = m["joints"].as_object_mut().unwrap().values_mut();
        joints.filter(|joint| joint["type"] == "revolute").for_each(|joint| joint["pin_radius"] = json!(RADIUS));
    })
}

fn mechanism(bodies: &Value, joints: &Value, start: &Value, guess: &Value) -> String {
    rubbing(json!({ "name": "Mechanism", "bodies": bodies, "joints": joints, "start": start, "guess": guess }))
}

/// Radius of every pin [m], in mechanisms of some metres.
const RADIUS: f64 = 0.01;

fn angle(from: Vec2, to: Vec2) -> f64 {
    (to.y - from.y).atan2(to.x - from.x)
}

/// Intersection of two circles about two points: left of the line from the first point to the second (1), or right of
/// it (-1).
fn intersection([a, b]: [Vec2; 2], [ra, rb]: [f64; 2], side: f64) -> Vec2 {
    let (way, distance) = (b - a, (b - a).norm());
    let along = (distance * distance + ra * ra - rb * rb) / (2.0 * distance);
    let unit = way / distance;
    a + along * unit + side * (ra * ra - along * along).sqrt() * Vec2::new(-unit.y, unit.x)
}

/// A four-bar: lengths of ground, crank, coupler, rocker.
fn four_bar(lengths: [f64; 4], start: f64, speed: f64, side: f64) -> String {
    let [ground, crank, coupler, rocker] = lengths;
    let (b, d) = (crank * Vec2::new(start.cos(), start.sin()), Vec2::new(ground, 0.0));
    let c = intersection([b, d], [coupler, rocker], side);
    let bars = definition::four_bar(lengths, [start, angle(b, c), angle(d, c)]);
    rubbing(bars.with(json!({ "start": { "speed": speed } })))
}

/// A plate on three parallel cranks.
fn double_parallelogram() -> String {
    let ground = json!({ "points": { "second": [1.0, 0.0], "third": [1.8, 0.0] } });
    let plate = json!({ "length": 1.8, "mass": 2.0, "shape": "uniform_rod", "points": { "second": [1.0, 0.0] } });
    mechanism(
        &json!({
            "ground": ground, "plate": plate, "one": rod(0.4, 0.4), "two": rod(0.4, 0.4), "three": rod(0.4, 0.4)
        }),
        &json!({
            "a": pin("ground.origin", "one.origin"), "b": pin("one.end", "plate.origin"),
            "c": pin("ground.second", "two.origin"), "d": pin("two.end", "plate.second"),
            "e": pin("ground.third", "three.origin"), "f": pin("three.end", "plate.end")
        }),
        &json!({ "body": "one", "angle": 1.0, "speed": 5.0 }),
        &json!({ "one": 1.0, "two": 1.0, "three": 1.0, "plate": 0.0 }),
    )
}

/// A jaw on a parallelogram that a slider moves through a rod.
fn gripper() -> String {
    let (crank, start, link) = (0.5, 1.2_f64, 0.9);
    let end = crank * Vec2::new(start.cos(), start.sin());
    let place = end.x - (link * link - end.y * end.y).sqrt();
    let ground = json!({ "points": { "second": [0.3, 0.0] } });
    mechanism(
        &json!({
            "ground": ground, "one": rod(crank, crank), "two": rod(crank, crank), "jaw": rod(0.3, 0.3),
            "link": rod(link, link), "slider": { "mass": 0.5 }
        }),
        &json!({
            "a": pin("ground.origin", "one.origin"), "b": pin("one.end", "jaw.origin"),
            "c": pin("ground.second", "two.origin"), "d": pin("two.end", "jaw.end"),
            "e": pin("slider.origin", "link.origin"), "f": pin("link.end", "one.end"),
            "rail": slide("ground.origin", "slider.origin", 0.0)
        }),
        &json!({ "body": "one", "angle": start, "speed": 2.0 }),
        &json!({ "one": start, "two": start, "jaw": 0.0, "rail": place, "link": angle(Vec2::new(place, 0.0), end) }),
    )
}

/// A slider-crank whose rod is as long as its crank.
fn isosceles() -> String {
    let bodies = [rod(0.5, 0.5), rod(0.5, 0.5), json!({ "mass": 1.0 })];
    rubbing(slider_crank(bodies, 0.7).with(json!({ "start": { "speed": 6.0 } })))
}

const CRANK: f64 = 0.3;
const AXLES: f64 = 2.0;
const WHEEL: [f64; 2] = [40.0, 5.0];
const COUPLING: f64 = 12.0;

/// Two wheels, coupled by rods on cranks at right angles.
fn coupled_cranks(speed: f64) -> String {
    let wheel = json!({
        "mass": WHEEL[0], "inertia": WHEEL[1], "center": [0.0, 0.0], "points": { "p": [CRANK, 0.0], "q": [0.0, CRANK] }
    });
    let rod = rod(AXLES, COUPLING);
    mechanism(
        &json!({ "ground": { "length": AXLES }, "one": wheel, "two": wheel, "left": rod, "right": rod }),
        &json!({
            "a": pin("ground.origin", "one.origin"), "b": pin("ground.end", "two.origin"),
            "c": pin("one.p", "left.origin"), "d": pin("left.end", "two.p"),
            "e": pin("one.q", "right.origin"), "f": pin("right.end", "two.q")
        }),
        &json!({ "body": "one", "angle": 0.5, "speed": speed }),
        &json!({ "one": 0.5, "two": 0.5, "left": 0.0, "right": 0.0 }),
    )
}

/// A chain with friction, with its own tolerance and gravity.
fn chain(text: &str) -> String {
    let own: Value = serde_json::from_str(text).unwrap();
    changed(rubbing(own.clone()), |m| ["gravity", "solver"].iter().for_each(|key| m[key] = own[key].clone()))
}

/// The chain with this many four-bars.
fn chain_of(count: usize) -> String {
    changed(CHAIN, |m| {
        for k in 3..=count {
            m["bodies"]["ground"]["points"][format!("pivot{k}")] = json!([k, 0.0]);
            for name in ["bar", "link"] {
                m["bodies"][format!("{name}{k}")] = rod(1.0, 1.0);
            }
            m["joints"][format!("pivot{k}")] = pin(&format!("ground.pivot{k}"), &format!("bar{k}.origin"));
            m["joints"][format!("left{k}")] = pin(&format!("bar{}.end", k - 1), &format!("link{k}.origin"));
            m["joints"][format!("right{k}")] = pin(&format!("link{k}.end"), &format!("bar{k}.end"));
            (m["guess"][format!("bar{k}")], m["guess"][format!("link{k}")]) = (json!(FRAC_PI_2), json!(0.0));
        }
    })
}

fn all() -> Vec<(&'static str, String)> {
    vec![
        ("chain of four-bars", chain(CHAIN)),
        ("A02 with eight four-bars", chain(&chain_of(8))),
        ("parallelogram", four_bar([1.0, 0.4, 1.0, 0.4], 1.0, 8.0, 1.0)),
        ("rhombus", four_bar([1.0, 1.0, 1.0, 1.0], 1.0, 3.0, 1.0)),
        ("antiparallelogram", four_bar([1.0, 0.4, 1.0, 0.4], 1.0, 8.0, -1.0)),
        ("double parallelogram", double_parallelogram()),
        ("gripper", gripper()),
        ("isosceles slider-crank", isosceles()),
        ("Galloway", four_bar([1.0, 0.4, 0.4, 1.0], 2.0, 5.0, -1.0)),
        ("coupled cranks", coupled_cranks(20.0)),
    ]
}

/// Two cranks with axles in a line, coupled by rods between crank pins: closed form. One rod makes a parallelogram.
struct Cranks {
    /// Radius of the crank pins, and distance of the axles [m].
    radius: f64,
    axles: f64,
    /// Mass of each crank, distance of its centre of mass from the axle, and moment of inertia about the axle.
    mass: f64,
    center: f64,
    inertia: f64,
    /// Mass of a rod, and the angle of each rod's crank pins relative to the crank.
    rod: f64,
    phases: Vec<f64>,
    /// Torques on both cranks.
    torques: [f64; 2],
}

impl Cranks {
    fn locomotive(torques: [f64; 2]) -> Self {
        let (mass, inertia) = (WHEEL[0], WHEEL[1]);
        let phases = vec![0.0, FRAC_PI_2];
        Self { radius: CRANK, axles: AXLES, mass, center: 0.0, inertia, rod: COUPLING, phases, torques }
    }

    fn parallelogram() -> Self {
        let r = 0.4;
        let (mass, center, inertia) = (r, r / 2.0, r * r * r / 3.0);
        Self { radius: r, axles: 1.0, mass, center, inertia, rod: 1.0, phases: vec![0.0], torques: [0.0; 2] }
    }

    /// Friction arm of every pin, with the sign of the motion: all pins slip at the speed of the cranks.
    fn arm(omega: f64) -> f64 {
        let v = (RADIUS * omega).abs();
        let s = ((v - 0.01) / 0.99).clamp(0.0, 1.0);
        let mu = if v < 0.01 { 0.15 * v / 0.01 } else { 0.15 - 0.05 * s * s * (3.0 - 2.0 * s) };
        (RADIUS * mu).copysign(omega)
    }

    /// Angular acceleration, and the reactions in the axles and in both pins of each rod, for friction caused by
    /// reactions of these sizes. With two rods one rod is redundant: the rod forces are those of least norm.
    fn balance(&self, [theta, omega]: [f64; 2], sizes: &[f64]) -> (f64, Vec<f64>) {
        let (r, n) = (self.radius, self.phases.len());
        let friction: Vec<f64> = sizes.iter().map(|size| Self::arm(omega) * size).collect();
        let psi: Vec<(f64, f64)> = self.phases.iter().map(|phase| (theta + phase).sin_cos()).collect();
        let cosines: f64 = psi.iter().map(|(_, cos)| cos).sum();
        let weight = 2.0 * self.mass * G * self.center * theta.cos() + r * self.rod * G * cosines;
        let lost: f64 = friction.iter().sum();
        let inertia = 2.0 * self.inertia + n as f64 * self.rod * r * r;
        let alpha = (self.torques[0] + self.torques[1] - weight - lost) / inertia;
        // The rods carry the difference of the torques of both cranks.
        let mut difference = friction[0] - friction[1] - (self.torques[0] - self.torques[1]);
        for k in 0..n {
            difference += friction[2 + 2 * k] - friction[3 + 2 * k];
        }
        let mut carried = difference / (2.0 * r);
        for (k, (_, cos)) in psi.iter().enumerate() {
            carried += cos * (friction[2 + 2 * k] + friction[3 + 2 * k]) / self.axles;
        }
        // Least sum of squares of the forces of both rods and both axles.
        let sum: f64 = psi.iter().map(|(sin, _)| sin).sum();
        let along: Vec<f64> = match n {
            1 => vec![carried / psi[0].0],
            _ => {
                let factor = carried / (psi.iter().map(|(sin, _)| sin * sin).sum::<f64>() - sum * sum / 3.0);
                psi.iter().map(|(sin, _)| factor * (sin - sum / 3.0)).collect()
            }
        };
        let acceleration = |(sin, cos): (f64, f64), r: f64| {
            [r * (-alpha * sin - omega * omega * cos), r * (alpha * cos - omega * omega * sin)]
        };
        let own = acceleration(theta.sin_cos(), self.center);
        let mut axles = [[self.mass * own[0], self.mass * (own[1] + G)]; 2];
        let mut pins = Vec::new();
        for (k, &at) in psi.iter().enumerate() {
            let [x, y] = acceleration(at, r);
            let lift = (friction[2 + 2 * k] + friction[3 + 2 * k]) / self.axles;
            let half = [0.5 * self.rod * x, 0.5 * self.rod * (y + G)];
            let ends = [[half[0] + along[k], half[1] + lift], [half[0] - along[k], half[1] - lift]];
            for (axle, end) in axles.iter_mut().zip(ends) {
                (axle[0], axle[1]) = (axle[0] + end[0], axle[1] + end[1]);
                pins.push(end[0].hypot(end[1]));
            }
        }
        let all = axles.iter().map(|[x, y]| x.hypot(*y)).chain(pins).collect();
        (alpha, all)
    }

    /// Sizes of the reactions with friction. Newton's method with finite differences follows the solution while
    /// friction grows from zero to its full size. None if the solution ends before, where the determinant of the
    /// equations vanishes.
    fn solve(&self, state: [f64; 2]) -> Option<Vec<f64>> {
        const PARTS: u32 = 200;
        let mut sizes = self.balance(state, &vec![0.0; 2 + 2 * self.phases.len()]).1;
        for part in 1..=PARTS {
            sizes = self.newton(state, f64::from(part) / f64::from(PARTS), sizes)?;
        }
        Some(sizes)
    }

    /// The sizes for this part of friction, from the sizes for a slightly smaller part.
    fn newton(&self, state: [f64; 2], part: f64, mut sizes: Vec<f64>) -> Option<Vec<f64>> {
        let n = sizes.len();
        let next = |sizes: &[f64]| self.balance(state, &sizes.iter().map(|size| part * size).collect::<Vec<_>>()).1;
        for _ in 0..20 {
            let found = next(&sizes);
            let largest = sizes.iter().fold(1.0, |a: f64, b| a.max(*b));
            let slopes = DMatrix::from_fn(n, n, |i, j| {
                let mut other = sizes.clone();
                other[j] += 1e-7 * largest;
                f64::from(u8::from(i == j)) - (next(&other)[i] - found[i]) / (1e-7 * largest)
            });
            if slopes.determinant() <= 0.0 {
                return None;
            }
            let step = slopes.lu().solve(&DVector::from_fn(n, |i, _| found[i] - sizes[i]))?;
            sizes.iter_mut().zip(step.iter()).for_each(|(size, step)| *size += step);
            if step.amax() < 1e-11 * largest {
                return Some(sizes);
            }
        }
        None
    }

    /// Angular acceleration.
    fn acceleration(&self, state: [f64; 2]) -> f64 {
        let mut sizes = self.balance(state, &vec![0.0; 2 + 2 * self.phases.len()]).1;
        for _ in 0..30 {
            let next = self.balance(state, &sizes).1;
            let change = next.iter().zip(&sizes).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs() / a.max(1.0)));
            sizes = next;
            if change < 1e-15 {
                return self.balance(state, &sizes).0;
            }
        }
        let sizes = self.solve(state).expect("friction has a solution");
        self.balance(state, &sizes).0
    }

    fn run(&self, start: [f64; 2], span: f64, steps: u32) -> [f64; 2] {
        runge_kutta(|_, state| [state[1], self.acceleration(state)], start, span, steps)
    }
}

/// Steps of 1 ms until the motion locks or `span` ends, then shorter steps. Returns the message if friction locks.
fn run_to_the_lock(run: &mut Run, span: f64) -> Option<String> {
    let mut said = None;
    let mut h = 1e-3;
    while h > 1e-9 && run.0.time() < span {
        if let Err(error) = run.0.step(h) {
            said = Some(error.to_string());
            h *= 0.1;
        }
    }
    said
}

#[test]
fn all_are_accepted_and_move_until_friction_locks() {
    for (name, text) in all() {
        let mut run = Run::new(&text).started();
        let energy = run.get("energy.kinetic");
        if let Some(said) = run_to_the_lock(&mut run, 1.0) {
            assert!(
                said.starts_with("friction locks the mechanism near ") && said.contains("add a stop before"),
                "{said}"
            );
        }
        let drift = run.get("energy.drift").abs();
        assert!(drift < 1e-7 * energy.max(1.0), "{name}: {drift}");
        println!("{name}: {} s of 1 s, drift {drift:e} J of {energy} J", run.0.time());
    }
}

#[test]
fn a_parallelogram_moves_as_in_closed_form_and_locks_where_the_law_ends() {
    let cranks = Cranks::parallelogram();
    let mut run = Run::new(four_bar([1.0, 0.4, 1.0, 0.4], 1.0, 8.0, 1.0)).started();
    run.steps(20, 0.2);
    let [theta, omega] = cranks.run([1.0, 8.0], 0.2, 10_000);
    let miss = (run.get("crank.angle") - theta).abs().max((run.get("crank.speed") - omega).abs() / 8.0);
    println!("after 0.2 s: {miss:e}");
    assert!(miss < 1e-7, "{miss:e}: {theta} {omega}");
    let said = run_to_the_lock(&mut run, 2.0).unwrap();
    let state = [run.get("crank.angle"), run.get("crank.speed")];
    // The closed-form solution ends there too: the model stops only where the friction law has no solution.
    println!("{said}: {state:?}");
    assert!((state[0] - PI).abs() < 0.01 && state[0] < PI);
    assert!([1e-6, 1e-5, 1e-3].iter().all(|before| cranks.solve([state[0] - before, state[1]]).is_some()));
    assert!([1e-6, 1e-5, 1e-4].iter().all(|after| cranks.solve([state[0] + after, state[1]]).is_none()));
}

#[test]
fn coupled_cranks_turn_a_hundred_times_as_in_closed_form() {
    let torques = [60.0, -45.0];
    let cranks = Cranks::locomotive(torques);
    let text = changed(coupled_cranks(20.0), |m| {
        m["torques"] = json!({
            "drive": { "on": "one", "torque": torques[0] }, "load": { "on": "two", "torque": torques[1] }
        });
    });
    let span = 32.0;
    let [fine, rate] = cranks.run([0.5, 20.0], span, 64_000);
    let [coarse, _] = cranks.run([0.5, 20.0], span, 32_000);
    assert!(fine > 100.0 * TAU && (fine - coarse).abs() < 1e-9);
    let mut run = Run::new(&text);
    for tolerance in [1e-6, 1e-9, 1e-12] {
        run.set("solver.tolerance", tolerance);
        run.initialize();
        run.steps(3200, span);
        // Allowed error: 100 times the tolerance per radian of travel, and accumulated rounding.
        let (theta, omega) = (run.get("one.angle") - fine, run.get("one.speed") - rate);
        println!("{} turns at {tolerance:e}: angle off by {theta:e} rad, speed by {omega:e} rad/s", fine / TAU);
        let allowed = 100.0 * tolerance * fine;
        assert!(theta.abs() < allowed && omega.abs() < allowed, "{tolerance:e}: {theta:e} {omega:e}");
    }
    // Reactions of least norm, with friction.
    let sizes = cranks.solve([fine, rate]).unwrap();
    for (joint, size) in ["a", "b", "c", "d", "e", "f"].into_iter().zip(sizes) {
        run.near(&format!("{joint}.force"), size, 1e-6 * size);
    }
}

/// Arcs of the travel in which friction locks are reported before the first step.
#[test]
fn arcs_with_locking_friction_are_reported_at_the_start() {
    let inspect = |text: &str| Component::inspect("mechanism.json", text).unwrap();
    let text = four_bar([1.0, 0.4, 1.0, 0.4], 1.0, 8.0, 1.0);
    let mut run = Run::new(&text).started();
    run_to_the_lock(&mut run, 2.0).unwrap();
    let place = run.get("crank.angle");
    let inspection = inspect(&text);
    let arcs: Vec<&str> =
        inspection.facts.iter().filter(|fact| fact.topic == "Friction").map(|fact| fact.text.as_str()).collect();
    println!("{arcs:?}, {place}");
    let angle = |text: &str| text.split("crank = ").nth(1).unwrap().split(' ').next().unwrap().parse::<f64>().unwrap();
    let holds = |arc: &&str| {
        let (from, to) = arc.split_once(" to ").unwrap();
        let [from, to] = [angle(from), angle(to)];
        [-TAU, 0.0, TAU].iter().any(|turn| (from - 0.01..=to + 0.01).contains(&(place + turn)))
    };
    assert!(arcs.iter().any(|arc| arc.contains("forward") && holds(arc)), "{arcs:?} {place}");
    let warned = inspection.findings.iter().find(|finding| finding.path == "friction").unwrap();
    assert!(warned.message.contains("locks slow motion in"), "{warned}");
    let free = inspect(&coupled_cranks(20.0));
    assert!(free.facts.iter().all(|fact| fact.topic != "Friction"));
}

/// At an exact crossing the reactions are the common limit from both sides, if it exists.
#[test]
fn a_start_at_a_crossing_has_the_limit_of_its_reactions() {
    let at = |angle: f64| {
        let text = changed(coupled_cranks(20.0), |m| m["start"]["angle"] = json!(angle));
        let mut run = Run::new(&text).started();
        ["a", "b", "c", "d", "e", "f"].map(|joint| run.get(&format!("{joint}.force")))
    };
    for flat in [0.0, FRAC_PI_2, PI] {
        let [before, here, after] = [flat - 1e-3, flat, flat + 1e-3].map(at);
        for ((before, here), after) in before.iter().zip(here).zip(after) {
            let mean = 0.5 * (before + after);
            assert!((here - mean).abs() < 1e-5 * mean, "{flat}: {before} {here} {after}");
        }
    }
}
