//! Coulomb friction where two curves touch: pins in slots, against slides and links; teeth with a pressure angle; cams.
use crate::slots::{arc, slot};
use crate::support::definition::{With, friction, pin, rod, slide, weight};
use crate::support::{Run, assert_near};
use serde_json::{Value, json};

const MU: [f64; 2] = [0.25, 0.12];

/// A crank whose pin drives a lever, with gravity and a motor; pins with friction. `guided`: the joints between pin and
/// lever, the bodies there and their guesses.
fn lever([bodies, joints, guess]: [Value; 3], law: &str) -> Value {
    json!({
        "name": "Lever", "gravity": weight(),
        "bodies": { "ground": { "points": { "low": [0, -0.3] } }, "crank": rod(0.1, 1.0), "lever": rod(0.6, 2.0) },
        "joints": {
            "bearing": pin("ground.origin", "crank.origin").with(json!({ "pin_radius": 0.02 })),
            "pivot": pin("ground.low", "lever.origin").with(json!({ "pin_radius": 0.03 })),
        },
        "actuators": { "motor": { "joint": "bearing", "torque": 3 } },
        "friction": friction(MU, [0.05, 0.4]).with(json!({ "law": law })),
        "start": { "body": "crank", "angle": 0.3, "speed": 1.0 },
        "guess": { "crank": 0.3, "lever": 1.28 },
        "solver": { "tolerance": 1e-12 },
    })
    .with(json!({ "bodies": bodies, "joints": joints, "guess": guess }))
}

/// A pin in a straight slot of a moving lever rubs as a block without mass that slides on the lever.
#[test]
fn a_pin_in_a_straight_slot_rubs_as_a_slide() {
    let own = json!({ "static_coefficient": 0.3, "kinetic_coefficient": 0.2 });
    for law in ["viscous", "stick"] {
        let keys = json!({ "path": [[0, 0], [0.6, 0]] }).with(own.clone());
        let in_slot = lever(
            [json!({}), json!({ "guide": slot("lever.origin", "crank.end", keys) }), json!({ "guide": 0.34 })],
            law,
        );
        let guide = slide("lever.origin", "block.origin", 0.0).with(own.clone());
        let on_slide = lever(
            [
                json!({ "block": {} }),
                json!({ "guide": guide, "wrist": pin("block.origin", "crank.end") }),
                json!({ "guide": 0.34 }),
            ],
            law,
        );
        let [mut pin, mut block] = [in_slot, on_slide].map(|text| Run::new(text).started());
        for _ in 0..60 {
            [&mut pin, &mut block].into_iter().for_each(|run| run.step(0.02));
            for name in [
                "crank.angle", "crank.speed", "crank.acceleration", "guide.friction_force", "guide.slip_speed",
                "pivot.friction_torque", "guide.force_x", "guide.force_y", "motor.required_torque",
                "motor.breakaway_torque_forward", "motor.breakaway_torque_backward",
            ] {
                let expected = block.get(name);
                pin.near(name, expected, 1e-8 * expected.abs().max(1.0));
            }
            pin.near("energy.drift", 0.0, 1e-9);
        }
    }
}

/// A pin in an arc of the ground rubs as the pin of a link without mass, as large as the arc. The torque in the pin of
/// the link is a force across the link, so that its reaction is larger than the force N along the link: the friction
/// force F = mu sqrt(N^2 + F^2) is that of the coefficient mu / sqrt(1 - mu^2) in the slot.
#[test]
fn a_pin_in_an_arc_rubs_as_a_large_pin() {
    let law = json!({ "friction": friction([0.0; 2], [0.0; 2]).with(json!({ "law": "stick" })) });
    let mu: f64 = 0.28;
    let own = |mu: f64| json!({ "static_coefficient": mu, "kinetic_coefficient": mu });
    let mut links = Run::new(
        crate::slots::bars(&["rocker"])
            .with(law.clone())
            .with(json!({ "joints": { "d": own(mu).with(json!({ "pin_radius": 0.3 })) } })),
    )
    .started();
    let mut in_slot = Run::new(arc(own(mu / (1.0 - mu * mu).sqrt())).with(law)).started();
    for _ in 0..60 {
        [&mut links, &mut in_slot].into_iter().for_each(|run| run.step(0.021));
        for name in ["crank.angle", "crank.speed", "a.force_x", "b.force_y"] {
            let expected = links.get(name);
            in_slot.near(name, expected, 1e-8 * expected.abs().max(1.0));
        }
        in_slot.near("c.friction_force", links.get("d.friction_torque") / 0.3, 1e-8);
        in_slot.near("energy.drift", 0.0, 1e-9);
    }
    assert_near(in_slot.get("c.friction_force").abs() / in_slot.get("c.force"), mu / (1.0 - mu * mu).sqrt(), 1e-12, "mu");
}
