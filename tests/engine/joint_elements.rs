//! Rotors and constant friction of joints: closed forms, the balance of moments of a body, exact rest, rejected
//! definitions.
use crate::support::definition::{G, With, block, friction, rod, slider_crank, weight, wheel};
use crate::support::{Run, assert_near, assert_says, refusal};
use serde_json::{Value, json};
use std::f64::consts::PI;

const ROTOR: f64 = 0.3;
const FRICTION: f64 = 1.5;

/// A wheel of 0.2 kg.m2 with a motor, and these keys of its joint.
fn spun(joint: Value, speed: f64) -> Value {
    wheel(0.2).with(json!({
        "joints": { "hub": joint }, "actuators": { "motor": { "joint": "hub", "torque": 0 } },
        "start": { "speed": speed }, "solver": { "tolerance": 1e-12 },
    }))
}

#[test]
fn a_rotor_adds_its_inertia_to_the_relative_motion() {
    let mut run = Run::new(spun(json!({ "armature": ROTOR }), 0.0)).with(&[("motor.torque", 4.0)]).started();
    run.near("motor.reduced_inertia", 0.5, 1e-13);
    run.near("wheel.acceleration", 8.0, 1e-12);
    run.step(0.5);
    run.near("wheel.speed", 4.0, 1e-12);
    run.near("energy.kinetic", 4.0, 1e-12);
    // The rotor is the only inertia.
    let mut bare = spun(json!({ "armature": ROTOR }), 0.0);
    bare["bodies"]["wheel"] = json!({});
    let mut run = Run::new(bare).with(&[("motor.torque", 6.0)]).started();
    run.near("wheel.acceleration", 20.0, 1e-12);
    let mut run = Run::new(spun(json!({ "armature": ROTOR }), 0.0)).with(&[("hub.armature", 1.8)]).started();
    run.near("motor.reduced_inertia", 2.0, 1e-13);
}

/// A slider-crank with a motor and gravity, and these keys of its joints.
fn machine(joints: Value, speed: f64) -> Value {
    slider_crank([rod(0.1, 1.2), rod(0.3, 0.9), json!({ "mass": 0.5 })], 0.7).with(json!({ "joints": joints })).with(
        json!({
            "gravity": weight(), "actuators": { "motor": { "joint": "bearing", "torque": 3 } },
            "markers": { "middle": { "at": "rod.middle" } },
            "bodies": { "rod": { "points": { "middle": [0.15, 0] } } },
            "start": { "speed": speed }, "solver": { "tolerance": 1e-12 },
        }),
    )
}

/// The kinetic energy includes the rotor, and the total energy is constant. The rod is in balance under its own
/// inertia, the forces at its ends and the couple of the rotor.
#[test]
fn a_rotor_between_moving_bodies_takes_its_couple() {
    let mut run = Run::new(machine(json!({ "pin": { "armature": 0.02 } }), 9.0)).started();
    let mut plain = Run::new(machine(json!({}), 9.0)).started();
    let spin = run.get("rod.speed") - run.get("crank.speed");
    assert_near(run.get("energy.kinetic"), plain.get("energy.kinetic") + 0.01 * spin * spin, 1e-12, "energy");
    let inertia = 0.9 * 0.09 / 12.0;
    for _ in 0..40 {
        run.step(0.013);
        run.near("energy.drift", 0.0, 1e-9);
        let angle = run.get("rod.angle");
        let arm = [0.15 * angle.cos(), 0.15 * angle.sin()];
        let (at_pin, at_wrist) = (run.force("pin"), run.force("wrist"));
        let moment = -arm[0] * at_pin.y + arm[1] * at_pin.x - (arm[0] * at_wrist.y - arm[1] * at_wrist.x);
        let [rod, crank] = ["rod", "crank"].map(|body| run.get(&format!("{body}.acceleration")));
        assert_near(inertia * rod, moment - 0.02 * (rod - crank), 1e-9, "moment on the rod");
        let force = at_pin - at_wrist;
        run.near("middle.acceleration_x", force.x / 0.9, 1e-8);
        run.near("middle.acceleration_y", force.y / 0.9 - G, 1e-8);
    }
}

/// In a slide the rotor acts like the mass of a screw with the lead 2 pi.
#[test]
fn a_rotor_of_a_slide_is_a_screw() {
    let screw = json!({ "screw": { "lead": 2.0 * PI, "inertia": 0.7 }, "torque": 0, "joint": "guide" });
    let mut rotor = Run::new(machine(json!({ "guide": { "armature": 0.7 } }), 9.0)).started();
    let mut screwed = Run::new(machine(json!({}), 9.0).with(json!({ "actuators": { "screw": screw } }))).started();
    for _ in 0..20 {
        [&mut rotor, &mut screwed].into_iter().for_each(|run| run.step(0.02));
        for name in ["crank.speed", "pin.force", "guide.force", "guide.torque"] {
            let expected = screwed.get(name);
            rotor.near(name, expected, 1e-8 * (1.0 + expected.abs()));
        }
    }
}

#[test]
fn constant_friction_stops_a_wheel_at_the_instant_and_holds_it() {
    let mut run = Run::new(spun(json!({ "frictionloss": FRICTION }), 6.0)).started();
    // The wheel decelerates at 7.5 rad/s2 for 0.8 s.
    for k in 1..=4 {
        run.step(0.19);
        let t = 0.19 * f64::from(k);
        run.near("wheel.speed", 6.0 - 7.5 * t, 1e-12);
        run.near("wheel.angle", t * (6.0 - 3.75 * t), 1e-12);
        run.near("hub.friction_torque", -FRICTION, 0.0);
        run.near("energy.drift", 0.0, 1e-11);
    }
    run.step(5.0);
    let rest = run.get("wheel.angle");
    assert_near(rest, 2.4, 1e-12, "angle at rest");
    assert_eq!(run.get("wheel.speed"), 0.0);
    for (torque, held) in [(1.49, true), (-1.49, true), (1.51, false)] {
        run.set("motor.torque", torque);
        run.near("wheel.acceleration", if held { 0.0 } else { 0.05 }, 1e-12);
        run.near("hub.friction_torque", if held { -torque } else { -FRICTION }, 1e-12);
        run.step(0.5);
        assert_eq!(run.get("wheel.angle") == rest, held, "{torque}");
    }
    run.near("motor.breakaway_torque_forward", FRICTION, 1e-12);
    run.near("motor.breakaway_torque_backward", -FRICTION, 1e-12);
    run.set("hub.frictionloss", 0.51);
    run.near("wheel.acceleration", 5.0, 1e-12);
}

/// Coulomb's oscillator: each half swing is a cosine. Its amplitude decreases by 2 F / k.
#[test]
fn a_spring_against_constant_friction_loses_the_same_in_each_swing() {
    let [mass, stiffness, force, start]: [f64; 4] = [2.0, 50.0, 4.0, 0.9];
    let text = block(mass).with(json!({
        "joints": { "slide": { "frictionloss": force } }, "start": { "position": start }, "guess": { "slide": start },
        "springs": { "spring": { "joint": "slide", "stiffness": stiffness } }, "solver": { "tolerance": 1e-12 },
    }));
    let (half, loss) = (PI * (mass / stiffness).sqrt(), 2.0 * force / stiffness);
    let mut run = Run::new(text).started();
    for k in 0..5 {
        let (from, sign) = (start - loss * f64::from(k), if k % 2 == 0 { 1.0 } else { -1.0 });
        run.step(0.5 * half);
        run.near("slide.position", sign * 0.5 * loss, 1e-10);
        run.step(0.5 * half);
        run.near("slide.position", -sign * (from - loss), 1e-10);
        run.near("energy.drift", 0.0, 1e-10);
    }
    // Within F / k of the middle, friction holds the block.
    run.step(10.0 * half);
    let rest = run.get("slide.position");
    assert!(rest.abs() <= 0.5 * loss + 1e-9 && run.get("slide.speed") == 0.0);
    run.step(100.0);
    assert_eq!(run.get("slide.position"), rest);
}

/// Constant friction acts in addition to the friction caused by reactions, in the same joint and in other joints.
#[test]
fn constant_friction_adds_to_that_of_reactions() {
    let text = block(2.0).with(json!({
        "joints": { "slide": { "frictionloss": 3 } }, "gravity": weight(), "start": { "speed": 2 },
        "friction": friction([0.3, 0.2], [0.0; 2]).with(json!({ "law": "stick" })), "solver": { "tolerance": 1e-12 },
    }));
    let mut run = Run::new(&text).started();
    let slowing = 0.2 * G + 1.5;
    run.near("slide.acceleration", -slowing, 1e-12);
    run.near("slide.friction_force", -2.0 * slowing, 1e-12);
    run.step(0.3);
    run.near("slide.speed", 2.0 - 0.3 * slowing, 1e-12);
    // Without the friction of reactions the constant friction still acts.
    let mut run = Run::new(&text).with(&[("friction.enabled", false)]).started();
    run.near("slide.acceleration", -1.5, 1e-12);
    run.near("slide.friction_force", -3.0, 1e-12);
}

/// Constant friction in a joint acts on the crank with friction x slip per radian of crank angle.
#[test]
fn constant_friction_in_a_mechanism_does_the_work_of_its_slip() {
    let losses = [("bearing", 0.2), ("pin", 0.1), ("wrist", 0.05), ("guide", 4.0)];
    for pins in [false, true] {
        let text = |rubs: bool| {
            let mut text = machine(json!({}), 9.0);
            for (joint, loss) in losses.into_iter().filter(|_| rubs) {
                text["joints"][joint]["frictionloss"] = json!(loss);
            }
            if pins {
                text["friction"] = friction([0.2, 0.15], [0.0; 2]).with(json!({ "law": "stick" }));
                for joint in ["bearing", "pin", "wrist"] {
                    text["joints"][joint]["pin_radius"] = json!(0.01);
                }
            }
            text
        };
        let (mut rubbing, mut plain) = (Run::new(text(true)).started(), Run::new(text(false)).started());
        if pins {
            // Friction increases reactions and so other friction: the joint effect of both is not the sum of the single
            // effects.
            let more = plain.get("crank.acceleration") - rubbing.get("crank.acceleration");
            assert!(more > 0.0);
        } else {
            let [crank, rod, guide] = ["crank.speed", "rod.speed", "guide.speed"].map(|name| plain.get(name));
            let slips = [crank, rod - crank, rod, guide].map(f64::abs);
            let load: f64 = losses.iter().zip(slips).map(|((_, loss), slip)| loss * slip / crank).sum();
            let inertia = plain.get("motor.reduced_inertia");
            let less = plain.get("crank.acceleration") - rubbing.get("crank.acceleration");
            assert_near(less * inertia, load, 1e-11, "load of the friction");
        }
        for _ in 0..20 {
            rubbing.step(0.02);
            rubbing.near("energy.drift", 0.0, 1e-8);
        }
    }
}

/// Constant friction causes reactions, and these cause friction. The result is the same as for an applied torque.
#[test]
fn friction_of_reactions_counts_those_to_constant_friction() {
    let law = friction([0.2, 0.2], [0.0; 2]).with(json!({ "law": "stick" }));
    let base = machine(json!({ "pin": { "pin_radius": 0.02 }, "wrist": { "pin_radius": 0.02 } }), 9.0)
        .with(json!({ "friction": law }));
    let mut constant = Run::new(base.clone().with(json!({ "joints": { "pin": { "frictionloss": 0.4 } } }))).started();
    // The rod turns backward relative to the crank, so the friction acts forward on the rod and backward on the crank.
    let mut applied =
        Run::new(base.with(json!({ "actuators": { "brake": { "joint": "pin", "torque": 0.4 } } }))).started();
    assert!(applied.get("brake.speed") < 0.0);
    for name in ["crank.acceleration", "pin.force", "wrist.force", "wrist.friction_torque", "guide.friction_force"] {
        let expected = applied.get(name);
        constant.near(name, expected, 1e-11 * (1.0 + expected.abs()));
    }
}

#[test]
fn wrong_rotors_and_frictions_are_rejected() {
    for (joint, pieces) in [
        (json!({ "armature": -1 }), &["joints.hub.armature", "-1", ">= 0"][..]),
        (json!({ "frictionloss": -1 }), &["joints.hub.frictionloss", "-1", ">= 0"]),
    ] {
        assert_says(refusal(spun(joint, 0.0)), pieces);
    }
    let viscous =
        spun(json!({ "frictionloss": 1 }), 0.0).with(json!({ "friction": friction([0.2, 0.1], [0.01, 0.1]) }));
    assert_says(refusal(viscous), &["joints.hub.frictionloss", "\"law\": \"stick\""]);
}
