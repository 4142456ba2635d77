//! Pins in curved slots: arcs against the links that they stand for, a trammel against its closed form, a spline
//! against its points and against an arc, elements along a slot, refusals.
use crate::support::definition::{G, With, four_bar, rod, weight};
use crate::support::{Run, assert_near, assert_rejected, assert_says, refusal};
use linkage_fmu::mechanism::inspection::inspect;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

const LENGTHS: [f64; 4] = [0.5, 0.15, 0.4, 0.3];
const GUESS: [f64; 3] = [1.1, 0.411, 1.79];

pub fn slot(first: &str, second: &str, more: Value) -> Value {
    json!({ "type": "slot", "first": first, "second": second }).with(more)
}

/// The four-bar with gravity, a motor and a speed; links with these names have no mass.
pub fn bars(massless: &[&str]) -> Value {
    let mut bars = four_bar(LENGTHS, GUESS).with(json!({
        "gravity": weight(), "actuators": { "motor": { "joint": "a", "torque": 0.4 } },
        "start": { "speed": 9 }, "solver": { "tolerance": 1e-12 },
    }));
    for name in massless {
        let length = bars["bodies"][name]["length"].clone();
        bars["bodies"][name] = json!({ "length": length });
    }
    bars
}

/// The four-bar without this body, with these joints in the place of those that it had.
fn without(body: &str, joints: Value, guess: Value) -> Value {
    let mut bars = bars(&[]);
    bars["bodies"].as_object_mut().unwrap().remove(body);
    bars["guess"].as_object_mut().unwrap().remove(body);
    let old = bars["joints"].as_object_mut().unwrap();
    old.retain(|_, joint| ["first", "second"].iter().all(|end| !joint[end].as_str().unwrap().starts_with(body)));
    bars.with(json!({ "joints": joints, "guess": guess }))
}

/// The end of the coupler on an arc around the rocker's pivot, in the place of the rocker.
pub fn arc(more: Value) -> Value {
    let keys = json!({ "radius": LENGTHS[3], "from_angle": 0.5, "to_angle": 2.8 }).with(more);
    without("rocker", json!({ "c": slot("ground.end", "coupler.end", keys) }), json!({ "c": 0.39 }))
}

#[test]
fn an_arc_in_the_ground_is_a_link() {
    let mut links = Run::new(bars(&["rocker"])).started();
    let mut slot = Run::new(arc(json!({}))).started();
    for _ in 0..60 {
        [&mut links, &mut slot].into_iter().for_each(|run| run.step(0.021));
        for name in ["crank.angle", "coupler.angle", "crank.speed", "motor.reduced_inertia"] {
            slot.near(name, links.get(name), 1e-10);
        }
        for name in ["a.force_x", "a.force_y", "b.force_x", "crank.acceleration", "motor.required_force"] {
            let expected = links.get(name);
            slot.near(name, expected, 1e-8 * expected.abs().max(1.0));
        }
        slot.near("c.position", 0.3 * (links.get("rocker.angle") - 0.5), 1e-10);
        slot.near("c.speed", 0.3 * links.get("rocker.speed"), 1e-9);
        slot.near("c.acceleration", 0.3 * links.get("rocker.acceleration"), 1e-7);
        // The link pulls the coupler as the slot does: along the radius, with no force along the slot.
        let [given, taken] = [slot.force("c"), links.force("c")];
        assert!((given + taken).norm() < 1e-8 * taken.norm().max(1.0), "{given} {taken}");
        let (sin, cos) = links.get("rocker.angle").sin_cos();
        assert!((given.y * cos - given.x * sin).abs() < 1e-8 * given.norm().max(1.0));
        slot.near("energy.drift", 0.0, 1e-9);
    }
}

/// The arc turns with the rocker, around its end, and takes the place of the coupler.
#[test]
fn an_arc_in_a_moving_body_is_a_link() {
    let keys = json!({ "radius": LENGTHS[2], "from_angle": -4.0, "to_angle": 4.0 });
    let joint = json!({ "c": slot("rocker.end", "crank.end", keys) });
    // From the rocker's end to the crank's, in the frame of the rocker.
    let position = 0.4 * (GUESS[1] + 2.0 * FRAC_PI_2 - GUESS[2] + 4.0);
    let mut slot = Run::new(without("coupler", joint, json!({ "c": position }))).started();
    let mut links = Run::new(bars(&["coupler"])).started();
    for _ in 0..60 {
        [&mut links, &mut slot].into_iter().for_each(|run| run.step(0.021));
        for name in ["crank.angle", "rocker.angle", "rocker.speed"] {
            let expected = links.get(name);
            slot.near(name, expected, 1e-10 * expected.abs().max(1.0));
        }
        for name in ["a.force_x", "d.force_y", "rocker.acceleration"] {
            let expected = links.get(name);
            slot.near(name, expected, 1e-8 * expected.abs().max(1.0));
        }
        let turned = links.get("coupler.angle") - links.get("rocker.angle") - (GUESS[1] - GUESS[2]);
        slot.near("c.position", position + 0.4 * turned, 1e-6);
        slot.near("c.speed", 0.4 * (links.get("coupler.speed") - links.get("rocker.speed")), 1e-9);
        // The force of the rocker on the crank is that of the coupler on the crank.
        let [given, taken] = [slot.force("c"), links.force("b")];
        assert!((given + taken).norm() < 1e-8 * taken.norm().max(1.0), "{given} {taken}");
        slot.near("energy.drift", 0.0, 1e-9);
    }
}

/// A plate with two arcs over two pins of the ground: no other joint holds it. It moves as on two links.
#[test]
fn a_plate_that_only_slots_hold_moves_as_on_links() {
    let mut links = Run::new(
        bars(&["crank", "rocker"])
            .with(json!({
                "actuators": Value::Null, "start": { "body": "coupler", "angle": 0.411, "speed": 0.7 },
            }))
            .to_string()
            .replace("\"actuators\":null,", ""),
    )
    .started();
    let plate = json!({
        "name": "Plate", "gravity": weight(),
        "bodies": { "ground": { "length": LENGTHS[0] }, "coupler": rod(LENGTHS[2], LENGTHS[2]) },
        "joints": {
            "a": slot("coupler.origin", "ground.origin", json!({ "radius": 0.15, "from_angle": -9, "to_angle": 9 })),
            "d": slot("coupler.end", "ground.end", json!({ "radius": 0.3, "from_angle": -9, "to_angle": 9 })),
        },
        "start": { "body": "coupler", "angle": 0.411, "speed": 0.7 },
        "guess": { "coupler": 0.411, "a": 0.15 * (1.1 + 2.731 + 9.0), "d": 0.3 * (1.79 + 2.731 + 9.0) },
        "solver": { "tolerance": 1e-12 },
    });
    let mut plate = Run::new(plate).started();
    for _ in 0..40 {
        [&mut links, &mut plate].into_iter().for_each(|run| run.step(0.017));
        for name in ["coupler.angle", "coupler.speed"] {
            plate.near(name, links.get(name), 1e-9);
        }
        plate.near("a.speed", 0.15 * (links.get("crank.speed") - links.get("coupler.speed")), 1e-8);
        // The plate presses on the pin as the link on its bearing.
        let [given, taken] = [plate.force("d"), links.force("d")];
        assert!((given + taken).norm() < 1e-7 * taken.norm().max(1.0), "{given} {taken}");
        plate.near("energy.drift", 0.0, 1e-9);
    }
}

/// A rod whose ends move along two lines at right angles: its middle moves on a circle.
#[test]
fn a_trammel_falls_as_its_closed_form() {
    let (length, mass, angle): (f64, f64, f64) = (0.6, 2.0, 1.2);
    let mut run = Run::new(json!({
        "name": "Trammel", "gravity": weight(),
        "bodies": { "ground": {}, "rod": rod(length, mass) },
        "joints": {
            "wall": slot("ground.origin", "rod.end", json!({ "path": [[0, -1], [0, 0.2], [0, 1]] })),
            "floor": slot("ground.origin", "rod.origin", json!({ "path": [[-1, 0], [1, 0]] })),
        },
        "start": { "body": "rod", "angle": angle },
        "guess": { "rod": angle, "floor": 0.8, "wall": 1.5 },
        "solver": { "tolerance": 1e-12 },
    }))
    .started();
    for _ in 0..20 {
        run.step(0.017);
        let [theta, omega] = ["rod.angle", "rod.speed"].map(|name| run.get(name));
        let (sin, cos) = theta.sin_cos();
        // T = m l^2 omega^2 / 6, V = m g l sin(theta) / 2.
        let alpha = -1.5 * G / length * cos;
        assert_near(omega * omega, 3.0 * G / length * (angle.sin() - sin), 1e-9, "speed");
        run.near("rod.acceleration", alpha, 1e-9);
        run.near("floor.position", 1.0 - length * cos, 1e-10);
        run.near("wall.position", 1.0 + length * sin, 1e-10);
        run.near("floor.speed", length * sin * omega, 1e-10);
        run.near("wall.force_x", mass * 0.5 * length * (sin * alpha + cos * omega * omega), 1e-8);
        run.near("floor.force_y", mass * (G + 0.5 * length * (cos * alpha - sin * omega * omega)), 1e-8);
        run.near("wall.force_y", 0.0, 1e-9);
        run.near("floor.force_x", 0.0, 1e-9);
        run.near("energy.drift", 0.0, 1e-9);
    }
}

/// The end of the coupler on a smooth curve.
pub fn track(path: Value, more: Value) -> Value {
    without(
        "rocker",
        json!({ "c": slot("ground.origin", "coupler.end", json!({ "path": path })) }),
        json!({ "c": 0.35 }),
    )
    .with(json!({ "markers": { "pin": { "at": "coupler.end" } } }))
    .with(more)
}

/// Points of the arc that the rocker's end describes.
pub fn on_arc(count: usize) -> Value {
    let angle = |k: usize| 2.9 - 2.4 * k as f64 / (count - 1) as f64;
    (0..count).map(|k| json!([0.5 + 0.3 * angle(k).cos(), 0.3 * angle(k).sin()])).collect()
}

#[test]
fn a_spline_slot_keeps_its_pin_and_tends_to_an_arc() {
    let arc = Run::new(arc(json!({}))).started();
    let mut errors = Vec::new();
    for count in [12, 24, 48] {
        let mut run = Run::new(track(on_arc(count), json!({}))).started();
        let mut arc = arc.clone();
        let mut worst: f64 = 0.0;
        for _ in 0..30 {
            [&mut run, &mut arc].into_iter().for_each(|run| run.step(0.021));
            worst = worst.max((run.get("crank.angle") - arc.get("crank.angle")).abs());
            // The position is the length along the curve, and the force acts across it.
            let [x, y] = ["pin.velocity_x", "pin.velocity_y"].map(|name| run.get(name));
            let (speed, force) = (run.get("c.speed"), run.force("c"));
            assert!((x.hypot(y) - speed.abs()).abs() < 1e-9, "{x} {y} {speed}");
            assert!((force.x * x + force.y * y).abs() < 1e-8 * force.norm() * x.hypot(y).max(1e-3));
            run.near("energy.drift", 0.0, 1e-8);
        }
        errors.push(worst);
    }
    assert!(errors[1] < errors[0] / 8.0 && errors[2] < errors[1] / 8.0 && errors[2] < 1e-5, "{errors:?}");
}

#[test]
fn a_pin_passes_the_points_of_its_slot() {
    let path = json!([[0.25, 0.13], [0.35, 0.25], [0.5, 0.3], [0.6, 0.29]]);
    let text = track(path.clone(), json!({ "actuators": { "motor": { "torque": 0 } }, "start": { "speed": 0 } }));
    // Where the pin is at a point, its position is that of the point; found by setting the start.
    let mut run = Run::new(
        text.with(json!({ "start": { "body": Value::Null } }))
            .to_string()
            .replace("\"body\":null,", "")
            .replace("\"angle\":1.1", "\"joint\":\"c\",\"position\":0.2"),
    );
    run.initialize();
    run.near("c.position", 0.2, 1e-12);
    let lengths = |run: &mut Run| {
        let [x, y] = ["pin.x", "pin.y"].map(|name| run.get(name));
        let at = |k: usize| [0, 1].map(|axis| path[k][axis].as_f64().unwrap());
        (0..4).map(|k| (x - at(k)[0]).hypot(y - at(k)[1])).fold(f64::INFINITY, f64::min)
    };
    let mut least = f64::INFINITY;
    for k in 0..=400 {
        run.set("c.start_position", 0.15 + 0.0002 * f64::from(k));
        run.initialize();
        least = least.min(lengths(&mut run));
    }
    // The point [0.35, 0.25] is about 0.157 m from the start.
    assert!(least < 1.1e-4, "{least}");
}

/// A spring, a damper, a drive, a stop and friction along the slot act as about the pivot of the link.
#[test]
fn elements_along_a_slot_act_as_about_the_pivot() {
    let in_slot = json!({
        "springs": { "coil": { "joint": "c", "stiffness": 40, "damping": 0.9, "free_length": 0.3 } },
        "actuators": { "ram": { "joint": "c", "force": -3 } },
        "stops": { "end": { "joint": "c", "limit": "upper", "position": 0.42, "restitution": 0.5 } },
    });
    let about = json!({
        "springs": { "coil": { "joint": "d", "stiffness": 40.0 * 0.09, "damping": 0.9 * 0.09, "free_angle": 1.5 } },
        "actuators": { "ram": { "joint": "d", "torque": -3.0 * 0.3 } },
        "stops": { "end": { "joint": "d", "limit": "upper", "angle": 0.5 + 0.42 / 0.3, "restitution": 0.5 } },
    });
    let mut slot = Run::new(arc(json!({ "frictionloss": 2 })).with(in_slot)).started();
    let links = bars(&["rocker"]).with(about).with(json!({ "joints": { "d": { "frictionloss": 0.6 } } }));
    let mut links = Run::new(links).started();
    for _ in 0..40 {
        [&mut links, &mut slot].into_iter().for_each(|run| run.step(0.021));
        slot.near("crank.angle", links.get("crank.angle"), 1e-9);
        slot.near("coil.force", links.get("coil.torque") / 0.3, 1e-7);
        slot.near("ram.required_force", links.get("ram.required_force") / 0.3, 1e-6);
        slot.near("energy.drift", 0.0, 1e-8);
    }
    assert!(slot.get("end.impact_count") > 0.0);
    assert_near(slot.get("end.impact_count"), links.get("end.impact_count"), 0.0, "impacts");
}

#[test]
fn a_pin_that_leaves_its_slot_is_reported() {
    let found = |text: Value| {
        let all = inspect(&text.to_string()).findings;
        let own = all.into_iter().filter(|finding| finding.path == "joints.c");
        own.map(|finding| finding.message).collect::<Vec<_>>()
    };
    assert_eq!(found(arc(json!({}))), [""; 0]);
    let short = arc(json!({ "to_angle": 1.9 }));
    assert_says(found(short.clone()).join(" "), &["slot is 0.42 m long", "leaves the slot"]);
    let stop = json!({ "stops": { "end": { "joint": "c", "limit": "upper", "position": 0.42 } } });
    assert_eq!(found(short.with(stop)), [""; 0]);
}

#[test]
fn slots_that_are_none_are_refused() {
    let slot = json!({ "c": slot("ground.end", "coupler.end", json!({ "radius": 0.3 })) });
    assert_rejected("slots", without("rocker", slot, json!({ "c": 0.3 })));
    let wrong = bars(&[]).with(json!({ "joints": { "d": { "radius": 1 } } }));
    assert_says(refusal(wrong), &["joints.d.radius", "only a slot"]);
    let screw = arc(json!({})).with(json!({ "actuators": { "ram": { "joint": "c", "screw": { "lead": 0.01 } } } }));
    assert_says(refusal(screw), &["actuators.ram.screw", "straight line"]);
}

/// States are saved and restored in the middle of a piece, and linearised along the curve.
#[test]
fn a_slot_is_saved_and_linearised() {
    let mut run = Run::new(track(on_arc(9), json!({ "linearisation": true }))).started();
    run.steps(7, 0.1);
    run.repeats(|run| run.steps(7, 0.1));
}
