//! Random mechanisms: a landing gear, a slider-crank, a four-bar linkage, a block on a slide, a jib, with any of the
//! features of a definition.
//!
//! In: random numbers. Out: the text of a definition, with the sizes of its loads.
//! Must not know what the test checks.
use super::prepared::Definition;
use super::random::Random;
use serde_json::{Map, Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

const GEAR: &str = example!("LandingGearRetraction");

/// A random definition; it may have no start, or start beyond a stop.
pub fn definition(random: &mut Random) -> Definition {
    let (mut json, force, torque, h) = match random.below(6) {
        0 | 1 => gear(random),
        2 => slider_crank(random),
        3 => four_bar(random),
        4 => block(random),
        _ => jib(random),
    };
    solver(random, &mut json);
    Definition { file: "mechanism.json", text: json.to_string(), force, torque, h }
}

/// Name, gravity and law of friction, as every mechanism may have them.
fn basis(random: &mut Random, name: &str) -> Value {
    let mut json = json!({ "name": name });
    if random.chance(0.8) {
        json["gravity"] = json!({ "acceleration": 9.81, "up_angle": random.within(-PI, PI) });
    }
    if random.chance(0.5) {
        friction(random, &mut json);
    }
    json
}

fn friction(random: &mut Random, json: &mut Value) {
    let static_speed = random.decades(1e-3, 0.1);
    json["friction"] = json!({
        "enabled": random.chance(0.9),
        "static_coefficient": random.within(0.0, 0.35),
        "kinetic_coefficient": random.within(0.0, 0.3),
        "static_speed": static_speed,
        "kinetic_speed": static_speed * random.decades(1.5, 200.0),
    });
}

pub fn solver(random: &mut Random, json: &mut Value) {
    let mut solver = Map::new();
    if let Value::Object(given) = &json["solver"] {
        solver.clone_from(given);
    }
    solver.insert("tolerance".into(), json!(random.decades(1e-11, 1e-3)));
    if random.chance(0.1) {
        solver.insert("max_steps".into(), json!(random.decades(5.0, 2000.0).floor()));
    }
    if random.chance(0.2) {
        solver.insert("speed_floor".into(), json!(random.decades(1e-9, 1.0)));
    }
    if random.chance(0.02) {
        solver.insert("tables".into(), json!(false));
    }
    json["solver"] = solver.into();
}

/// A quantity that a stop limits: its keys, the key of the limit, the value at the start, and a size.
type Quantity = (Value, &'static str, f64, f64);

/// Up to six stops of these quantities, some of them with locks.
fn stops(random: &mut Random, json: &mut Value, quantities: &[Quantity], stiffness: f64, at: &str) {
    let (mut stops, mut locks) = (Map::new(), Map::new());
    for k in 0..random.below(7) {
        let (keys, key, value, size) = &quantities[random.below(quantities.len())];
        let upper = random.chance(0.5);
        let gap = if random.chance(0.1) { 0.0 } else { size * random.decades(1e-3, 1.0) };
        let place = value + if upper { gap } else { -gap };
        if *key == "length" && place < 0.0 {
            continue;
        }
        let mut stop = keys.clone();
        stop[*key] = json!(place);
        stop["limit"] = json!(if upper { "upper" } else { "lower" });
        if random.chance(0.5) {
            stop["restitution"] = json!(if random.chance(0.3) { 0.0 } else { random.part() });
        } else {
            stop["rigid"] = json!(false);
            stop["stiffness"] = json!(stiffness * random.decades(0.01, 100.0));
            stop["damping"] = json!(if random.chance(0.3) { 0.0 } else { stiffness * random.decades(1e-4, 0.1) });
        }
        let name = format!("s{k}");
        if random.chance(0.3) {
            locks.insert(format!("lock{k}"), json!({ "stop": name, "at": at, "engage": random.chance(0.2) }));
        }
        stops.insert(name, stop);
    }
    json["stops"] = stops.into();
    json["locks"] = locks.into();
}

/// The drive, possibly with an efficiency.
fn lossy(random: &mut Random, mut drive: Value) -> Value {
    if random.chance(0.3) {
        drive["efficiency"] = json!(random.within(0.3, 1.0));
    }
    drive
}

/// Possibly a wind on an area at a point.
fn air(random: &mut Random, json: &mut Value, at: &str) {
    if random.chance(0.3) {
        json["air"] = json!({
            "density": 1.225, "flow_angle": random.within(-PI, PI), "relative_wind": random.chance(0.5),
            "airspeed": if random.chance(0.5) { 0.0 } else { random.within(-40.0, 40.0) },
        });
        let mut sail = json!({ "at": at, "area": random.decades(1e-3, 0.3), "drag_coefficient": 1.1 });
        if random.chance(0.5) {
            sail["surface_angle"] = json!(random.within(-PI, PI));
        }
        json["surfaces"] = json!({ "sail": sail });
    }
}

/// Possibly a spring.
fn spring(random: &mut Random, json: &mut Value, mut spring: Value, stiffness: f64) {
    if random.chance(0.3) {
        spring["stiffness"] = json!(stiffness * random.decades(0.01, 1.0));
        spring["damping"] = json!(stiffness * random.decades(1e-4, 0.01));
        json["springs"] = json!({ "spring": spring });
    }
}

fn speed(random: &mut Random, size: f64) -> f64 {
    if random.chance(0.4) { 0.0 } else { random.within(-size, size) }
}

/// Definition, force, torque, step.
pub type Parts = (Value, f64, f64, f64);

pub fn gear(random: &mut Random) -> Parts {
    let mut json: Value = serde_json::from_str(GEAR).unwrap_or_default();
    let angle = random.within(-1.29, 0.79);
    json["start"] = json!({ "body": "crank", "angle": angle, "speed": speed(random, 6.0) });
    if random.chance(0.4) {
        friction(random, &mut json);
    }
    json["air"]["relative_wind"] = json!(random.chance(0.3));
    json["actuators"]["actuator"]["efficiency"] = json!(if random.chance(0.3) { random.within(0.4, 1.0) } else { 1.0 });
    if random.chance(0.8) {
        let ends = json!({ "first": "crank.actuator", "second": "follower.actuator" });
        let body = |name: &str| json!({ "body": name });
        let mut quantities = vec![(body("crank"), "angle", angle, 1.0)];
        if angle > 0.7 {
            quantities.push((ends, "length", 0.57, 0.3));
        }
        stops(random, &mut json, &quantities, 1e4, "wheel.origin");
    }
    for stop in ["upstop", "downstop"] {
        if random.chance(0.3) && json["stops"][stop].is_object() {
            json["stops"][stop]["restitution"] = json!(random.part());
        }
    }
    (json, 4e4, 2e3, 3e-3)
}

fn slider_crank(random: &mut Random) -> Parts {
    let mut json = basis(random, "SliderCrank");
    let crank = random.within(0.05, 0.3);
    let rod = crank * random.within(1.3, 5.0);
    let offset = (rod - crank) * random.within(-0.6, 0.6);
    let angle = random.within(-PI, PI);
    let (sin, cos) = angle.sin_cos();
    let lift: f64 = (crank * sin - offset) / rod;
    let slide = crank * cos + rod * (1.0 - lift * lift).sqrt();
    let mass = random.decades(0.1, 10.0);
    json["bodies"] = json!({
        "ground": { "points": { "guide": [0, offset], "post": [0.2, 0.7] } },
        "crank": { "length": crank, "mass": mass, "shape": "uniform_rod" },
        "rod": { "length": rod, "mass": 0.7 * mass, "shape": "uniform_rod" },
        "slider": { "mass": mass * random.decades(0.1, 3.0) },
    });
    let radius = |random: &mut Random| crank * random.within(0.0, 0.15);
    json["joints"] = json!({
        "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin",
            "pin_radius": radius(random) },
        "pin": { "type": "revolute", "first": "crank.end", "second": "rod.origin", "pin_radius": radius(random) },
        "wrist": { "type": "revolute", "first": "rod.end", "second": "slider.origin" },
        "guide": { "type": "prismatic", "first": "ground.guide", "second": "slider.origin" },
    });
    json["actuators"] = json!({ "servo": lossy(random, json!({ "joint": "bearing" })) });
    if random.chance(0.3) {
        json["actuators"]["ram"] = lossy(random, json!({ "joint": "guide" }));
    }
    json["forces"] = json!({ "push": { "at": "slider.origin" } });
    json["markers"] = json!({ "eye": { "at": "rod.end" } });
    let at = |x: f64, y: f64| (x - 0.2).hypot(y - 0.7);
    let quantities = [
        (json!({ "body": "crank" }), "angle", angle, 8.0),
        (json!({ "joint": "guide" }), "position", slide, crank),
        (json!({ "first": "ground.post", "second": "crank.end" }), "length", at(crank * cos, crank * sin), crank),
    ];
    let stiffness = 10.0 * mass * 9.81 / crank;
    stops(random, &mut json, &quantities, stiffness, "crank.end");
    air(random, &mut json, "slider.origin");
    spring(random, &mut json, json!({ "first": "ground.post", "second": "crank.end", "free_length": 0.5 }), stiffness);
    json["start"] = json!({ "body": "crank", "angle": angle, "speed": speed(random, 10.0) });
    json["guess"] = json!({ "crank": angle, "rod": -lift.asin(), "guide": slide });
    (json, 30.0 * mass, 30.0 * mass * crank, 5e-3)
}

fn four_bar(random: &mut Random) -> Parts {
    let mut json = basis(random, "FourBar");
    // Lengths and angles of four chosen points.
    let (ground, angle) = (random.within(0.2, 0.6), random.within(-PI, PI));
    let crank = random.within(0.05, 0.4);
    let (bx, by) = (crank * angle.cos(), crank * angle.sin());
    let (cx, cy) = (random.within(0.0, 0.8), random.within(0.1, 0.7) * random.pick(&[-1.0, 1.0]));
    let (coupler, follower) = ((cx - bx).hypot(cy - by), (cx - ground).hypot(cy));
    let (beta, gamma) = ((cy - by).atan2(cx - bx), cy.atan2(cx - ground));
    let mass = random.decades(0.1, 10.0);
    let fem = random.chance(0.06);
    let body = |length: f64, mass: f64| {
        let mut body = json!({ "length": length, "mass": mass, "shape": "uniform_rod" });
        if fem {
            body["axial_stiffness"] = json!(1e7);
        }
        body
    };
    json["bodies"] = json!({
        "ground": { "length": ground, "points": { "post": [0.2, 0.9] } },
        "crank": body(crank, mass), "coupler": body(coupler, 0.5 * mass), "follower": body(follower, 2.0 * mass),
    });
    let joint = |random: &mut Random, first: &str, second: &str| {
        let mut joint = json!({ "type": "revolute", "first": first, "second": second });
        if !fem && random.chance(0.7) {
            joint["pin_radius"] = json!(0.05 * crank * random.part());
        }
        joint
    };
    json["joints"] = json!({
        "a": joint(random, "ground.origin", "crank.origin"), "b": joint(random, "crank.end", "coupler.origin"),
        "c": joint(random, "coupler.end", "follower.end"), "d": joint(random, "ground.end", "follower.origin"),
    });
    json["forces"] = json!({ "push": { "at": "coupler.end" } });
    json["start"] = json!({ "body": "crank", "angle": angle, "speed": speed(random, 5.0) });
    json["guess"] = json!({ "crank": angle, "coupler": beta, "follower": gamma });
    if fem {
        json["torques"] = json!({ "motor": { "on": "crank" } });
        json["solver"] =
            json!({ "method": random.pick(&["rigid_fem", "reduced"]), "fem_step": random.decades(2e-5, 1e-3) });
        if let Some(json) = json.as_object_mut() {
            json.remove("friction");
        }
        return (json, 10.0 * mass, 10.0 * mass * crank, 2e-3);
    }
    json["actuators"] = json!({ "servo": lossy(random, json!({ "joint": "a" })) });
    if random.chance(0.4) {
        let ends = json!({ "first": "ground.post", "second": "follower.end" });
        json["actuators"]["cylinder"] = lossy(random, ends);
    }
    let at = (bx - 0.2).hypot(by - 0.9);
    let quantities = [
        (json!({ "body": "crank" }), "angle", angle, 3.0),
        (json!({ "body": "follower" }), "angle", gamma, 1.0),
        (json!({ "joint": "b" }), "angle", beta - angle, 1.0),
        (json!({ "first": "ground.post", "second": "crank.end" }), "length", at, crank),
    ];
    let stiffness = 10.0 * mass * 9.81;
    stops(random, &mut json, &quantities, stiffness, "crank.end");
    air(random, &mut json, "follower.end");
    spring(random, &mut json, json!({ "joint": "d", "free_angle": gamma }), stiffness);
    (json, 20.0 * mass, 20.0 * mass * crank, 5e-3)
}

fn block(random: &mut Random) -> Parts {
    let mut json = basis(random, "Block");
    let mass = random.decades(0.1, 100.0);
    let at = random.within(-1.0, 1.0);
    let slope = random.within(-FRAC_PI_2, FRAC_PI_2);
    json["bodies"] = json!({ "ground": { "points": { "post": [0.2, 2.5] } }, "block": { "mass": mass } });
    json["joints"] = json!({
        "slide": { "type": "prismatic", "first": "ground.origin", "second": "block.origin", "axis_angle": slope },
    });
    json["actuators"] = json!({ "ram": lossy(random, json!({ "joint": "slide" })) });
    let (x, y) = (at * slope.cos(), at * slope.sin());
    let quantities = [
        (json!({ "joint": "slide" }), "position", at, 0.5),
        (json!({ "first": "ground.post", "second": "block.origin" }), "length", (x - 0.2).hypot(y - 2.5), 0.3),
    ];
    stops(random, &mut json, &quantities, 100.0 * mass, "block.origin");
    air(random, &mut json, "block.origin");
    spring(random, &mut json, json!({ "joint": "slide", "free_length": 0.1 }), 100.0 * mass);
    json["start"] = json!({ "joint": "slide", "position": at, "speed": speed(random, 3.0) });
    json["guess"] = json!({ "slide": at });
    (json, 40.0 * mass, 10.0 * mass, 1e-2)
}

fn jib(random: &mut Random) -> Parts {
    let mut json = basis(random, "Jib");
    let (length, mass) = (random.within(1.0, 5.0), random.decades(10.0, 1000.0));
    let angle = random.within(-0.9, 1.2);
    let (b, s) = (length * random.within(0.2, 0.6), -random.within(0.7, 1.5));
    let arm = [b * angle.cos(), b * angle.sin()];
    json["bodies"] = json!({
        "ground": { "points": { "s": [0.3, s] } },
        "jib": { "length": length, "mass": 0.2 * mass, "shape": "uniform_rod", "points": { "b": [b, 0] } },
        "load": { "fixed_to": "jib.end", "mass": mass },
    });
    let radius = random.within(0.0, 0.1);
    json["joints"] =
        json!({ "a": { "type": "revolute", "first": "ground.origin", "second": "jib.origin", "pin_radius": radius } });
    json["actuators"] = json!({ "cylinder": lossy(random, json!({ "first": "ground.s", "second": "jib.b" })) });
    json["forces"] = json!({ "tip": { "at": "jib.end" } });
    let quantities = [
        (json!({ "body": "jib" }), "angle", angle, 0.5),
        (json!({ "first": "ground.s", "second": "jib.b" }), "length", (arm[0] - 0.3).hypot(arm[1] - s), 0.2),
    ];
    stops(random, &mut json, &quantities, 1e3 * mass, "jib.end");
    if let Some(stops) = json["stops"].as_object_mut() {
        // The cylinder's ends never coincide.
        stops.insert("down".into(), json!({ "body": "jib", "limit": "lower", "angle": -1.05, "restitution": 0.3 }));
        stops.insert("up".into(), json!({ "body": "jib", "limit": "upper", "angle": 1.4 }));
    }
    air(random, &mut json, "jib.end");
    json["start"] = json!({ "body": "jib", "angle": angle, "speed": speed(random, 1.0) });
    json["guess"] = json!({ "jib": angle });
    (json, 40.0 * mass, 20.0 * mass, 1e-2)
}
