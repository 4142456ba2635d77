//! Coulomb friction where two curves touch: pins in slots, against slides and links; teeth with a pressure angle; cams.
use crate::cams::{ROLLER, elliptic, lift, oscillating, parsed, translating};
use crate::friction_balance::coefficient;
use crate::slots::{arc, slot};
use crate::support::definition::{G, With, friction, pin, rod, slide, weight};
use crate::support::numeric::runge_kutta;
use crate::support::{Run, Vec2, assert_near, assert_says, refusal, turned};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

const MU: [f64; 2] = [0.25, 0.12];

/// Gears with a pressure angle on pins with friction, with a spring.
pub const TEETH: &str = include_str!("../fixtures/rubbing_teeth.json");

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
                "crank.angle",
                "crank.speed",
                "crank.acceleration",
                "guide.friction_force",
                "guide.slip_speed",
                "pivot.friction_torque",
                "guide.force_x",
                "guide.force_y",
                "motor.required_force",
                "motor.breakaway_torque_forward",
                "motor.breakaway_torque_backward",
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
        in_slot.near("c.friction_force", links.get("d.friction_torque") / 0.3, 1e-7);
        in_slot.near("energy.drift", 0.0, 1e-9);
    }
    assert_near(
        in_slot.get("c.friction_force").abs() / in_slot.get("c.force"),
        mu / (1.0 - mu * mu).sqrt(),
        1e-12,
        "mu",
    );
}

const ALPHA: f64 = 0.4;
const RHO: [f64; 2] = [0.02, 0.03];
const J: [f64; 2] = [0.02, 0.5];
/// Pitch radii [m].
const R: [f64; 2] = [0.3 * 17.0 / 60.0, 0.3 * 43.0 / 60.0];

/// Two shafts 0.3 m apart on pins with friction. The teeth of their gears have a pressure angle.
fn gears(motor: f64, load: f64, mu: f64, more: Value) -> Value {
    let on = |point: &str, body: &str, radius: f64| pin(point, body).with(json!({ "pin_radius": radius }));
    json!({
        "name": "Teeth",
        "bodies": { "ground": { "points": { "far": [0.3, 0] } }, "one": { "mass": 2, "inertia": J[0] },
            "two": { "mass": 5, "inertia": J[1] } },
        "joints": { "a": on("ground.origin", "one.origin", RHO[0]), "b": on("ground.far", "two.origin", RHO[1]) },
        "couplings": { "mesh": { "type": "gears", "first": "one.origin", "second": "two.origin", "first_teeth": 17,
            "second_teeth": 43, "pressure_angle": ALPHA } },
        "torques": { "motor": { "on": "one", "torque": motor }, "load": { "on": "two", "torque": load } },
        "friction": friction([mu; 2], [0.0; 2]).with(json!({ "law": "stick" })),
        "start": { "body": "one", "angle": 0.4, "speed": 0 }, "guess": { "one": 0.4, "two": 1.1 },
        "solver": { "tolerance": 1e-12 },
    })
    .with(more)
}

/// Acceleration of the first shaft and tangential force F of the teeth, positive where the motor drives the load, for a
/// direction of motion: J1 a = M - F r1 - T1, J2 a r1 / r2 = F r2 - L - T2, with the friction torques
/// T = mu rho |F| / cos(alpha) against the motion.
fn of_gears(motor: f64, load: f64, mu: f64, direction: f64) -> [f64; 2] {
    let solved = |sign: f64| {
        let [c1, c2] = RHO.map(|rho| direction * sign * mu * rho / ALPHA.cos());
        let i = R[0] / R[1];
        let force = (motor * J[1] * i + load * J[0]) / (J[0] * (R[1] - c2) + J[1] * i * (R[0] + c1));
        ([(motor - force * (R[0] + c1)) / J[0], force], sign * force >= 0.0)
    };
    [1.0, -1.0].map(solved).into_iter().find(|(_, fits)| *fits).unwrap().0
}

#[test]
fn teeth_press_the_shafts_onto_pins_that_rub() {
    let mu = 0.3;
    for (motor, load, speed) in
        [(3.0, 1.0, 0.0), (0.1, 5.0, 0.0), (3.0, -1.0, -80.0), (-2.0, 4.0, 300.0), (-3.0, 0.0, 0.0), (1.0, 2.53, 0.0)]
    {
        let mut run = Run::new(gears(motor, load, mu, json!({ "start": { "speed": speed } }))).started();
        let frictionless = motor * R[1] - load * R[0];
        let direction = if speed == 0.0 { frictionless.signum() } else { f64::signum(speed) };
        let [a, force] = of_gears(motor, load, mu, direction);
        if speed == 0.0 && a * direction < 0.0 {
            assert!(run.is("friction.sticking"));
            run.step(10.0);
            assert_eq!(run.get("one.speed"), 0.0);
            continue;
        }
        let size = a.abs().max(1.0);
        run.near("one.acceleration", a, 1e-12 * size);
        run.near("mesh.transmitted_force", -force, 1e-11 * size);
        for joint in ["a", "b"] {
            run.near(&format!("{joint}.force"), force.abs() / ALPHA.cos(), 1e-11 * size);
        }
        run.near("b.friction_torque", direction * mu * RHO[1] * force.abs() / ALPHA.cos(), 1e-11 * size);
        run.near("mesh.force", force.abs() / ALPHA.cos(), 1e-11 * size);
        run.steps(9, 0.3);
        run.near("one.speed", speed + 0.3 * a, 1e-9 * size);
        run.near("energy.drift", 0.0, 1e-9 * run.clone().get("energy.kinetic").max(1.0));
    }
}

/// A spring on the second shaft passes its free angle, where the other flanks of the teeth bear: the friction has a
/// kink there. Saved in the middle, the run continues as it would.
#[test]
fn the_teeth_change_flanks_in_a_swing() {
    let (mu, free, stiffness) = (0.3, 0.8, 40.0);
    let coil = json!({ "springs": { "coil": { "joint": "b", "stiffness": stiffness, "free_angle": free } },
        "start": { "speed": 40 } });
    let text = gears(0.0, 0.0, mu, coil).to_string();
    let mut run = Run::new(&text).started();
    let i = R[0] / R[1];
    let load = |x: f64| -stiffness * (1.1 - i * (x - 0.4) - free);
    let rate = |[x, v]: [f64; 2]| [v, of_gears(0.0, load(x), mu, 1.0)[0]];
    let (mut y, mut forces) = ([0.4, 40.0], Vec::new());
    for _ in 0..8 {
        run.repeats(|run| run.step(0.01));
        y = runge_kutta(|_, y| rate(y), y, 0.01, 400);
        assert!(y[1] > 0.0);
        run.near("one.angle", y[0], 1e-8);
        run.near("one.speed", y[1], 1e-6);
        run.near("energy.drift", 0.0, 1e-9);
        forces.push(run.get("mesh.transmitted_force"));
    }
    assert!(forces[0] * forces[7] < 0.0, "{forces:?}");
}

/// A pinion presses its rack away: F_t tan(alpha) and the weight of the table are the normal force of the slide.
#[test]
fn a_rack_presses_its_slide() {
    let (mu, mass, radius, inertia, torque) = (0.2, 4.0, 0.02, 0.001, 3.0);
    for side in ["left", "right"] {
        let mut run = Run::new(json!({
            "name": "Rack", "gravity": weight(),
            "bodies": { "ground": {}, "pinion": { "inertia": inertia }, "table": { "mass": mass } },
            "joints": { "hub": pin("ground.origin", "pinion.origin"),
                "slide": slide("ground.origin", "table.origin", 0.0) },
            "couplings": { "teeth": { "type": "rack", "first": "pinion.origin", "joint": "slide", "radius": radius,
                "side": side, "pressure_angle": ALPHA } },
            "torques": { "motor": { "on": "pinion", "torque": torque } },
            "friction": friction([mu; 2], [0.0; 2]).with(json!({ "law": "stick" })),
            "start": { "joint": "slide", "position": 0, "speed": 0 }, "guess": { "slide": 0, "pinion": 0 },
        }))
        .started();
        // The rack on the left of the axis is above the pinion, and pressed upward.
        let up = if side == "left" { 1.0 } else { -1.0 };
        let [normal, force] = [1.0, -1.0]
            .map(|sign: f64| {
                // m a = F - mu sign N, N = m g - up F tan(alpha), J a / r^2 = M / r - F.
                let (c, m) = (1.0 + mu * sign * up * ALPHA.tan(), inertia / (radius * radius));
                let force = (torque / radius + mu * sign * m * G) / (1.0 + m / mass * c);
                [mass * G - up * force * ALPHA.tan(), force]
            })
            .into_iter()
            .zip([1.0, -1.0])
            .find(|([normal, _], sign)| normal * sign >= 0.0)
            .unwrap()
            .0;
        run.near("slide.force", normal.abs(), 1e-9 * force);
        let forward = run.get("slide.acceleration").signum();
        run.near("teeth.transmitted_force", force * forward, 1e-9 * force);
        run.near("slide.friction_force", -mu * normal.abs() * forward, 1e-9 * force);
    }
}

/// A follower slides on its cam, with friction at the contact only. The test computes the lift and the geometry of the
/// contact. `r`: the contact from the axis of the cam; `n`, `t`: the normal out of the cam and the tangent clockwise.
#[test]
fn a_sliding_follower_rubs_on_its_cam() {
    let (law, mu) = ("polynomial_345", [0.3, 0.2]);
    let free = json!({ "static_coefficient": 0, "kinetic_coefficient": 0 });
    for is_flat in [true, false] {
        let follower = if is_flat { json!({ "follower": "flat" }) } else { parsed(ROLLER) };
        let own = json!({ "static_coefficient": mu[0], "kinetic_coefficient": mu[1] });
        let text = parsed(&translating(law, follower.with(own))).with(json!({
            "friction": friction(MU, [0.05, 0.4]), "joints": { "guide": free },
            "torques": { "motor": { "torque": 5 } }, "springs": { "spring": { "preload": 300 } },
            "bodies": { "disc": { "inertia": 0.3 } }, "start": { "speed": 10 }, "solver": { "tolerance": 1e-12 },
        }));
        let mut run = Run::new(text).started();
        let (offset, base) = if is_flat { (0.0, 0.04) } else { (0.012, 0.05) };
        let height = f64::sqrt(base * base - offset * offset);
        for step in 0..150 {
            run.step(0.01);
            let what = format!("flat {is_flat}, step {step}");
            let [theta, omega, alpha] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("disc.{o}")));
            let [s, s1, s2] = lift(law, 0.02, theta - 0.5);
            let (r, t) = if is_flat {
                (Vec2::new(s1, height + s), Vec2::new(1.0, 0.0))
            } else {
                let center = Vec2::new(0.012, height + s);
                let t = (Vec2::new(0.0, s1) - turned(center, PI / 2.0)).normalize();
                (center - 0.01 * turned(t, PI / 2.0), t)
            };
            let n = turned(t, PI / 2.0);
            // The cam turns anticlockwise, so the follower slips clockwise on it.
            let slip = t.dot(&(Vec2::new(0.0, s1) - turned(r, PI / 2.0))) * omega;
            assert_near(run.get("cam.slip_speed"), slip, 1e-12 * slip.abs(), &what);
            let (contact, friction) = (run.get("cam.contact_force"), run.get("cam.friction_force"));
            let expected = -coefficient(mu, [0.05, 0.4], slip.abs()) * contact.abs() * slip.signum();
            assert_near(friction, expected, 1e-11 * contact.abs(), &what);
            let given = contact * n + friction * t;
            let up = s1 * alpha + s2 * omega * omega;
            let spring = 1000.0 * (run.get("guide.position") + 0.12) + 300.0;
            let size = contact.abs().max(1.0);
            assert_near(given.y, 0.6 * (up + 9.81) + spring, 1e-10 * size, &what);
            let arm = turned(Vec2::new(0.005, 0.002), theta);
            let moment = 5.0 + arm.perp(&Vec2::new(0.0, -1.2 * 9.81)) - r.perp(&given);
            assert_near((0.3 + 1.2 * arm.norm_squared()) * alpha, moment, 1e-10 * size, &what);
            assert!(contact > 0.0, "{what}: {contact}");
            run.near("energy.drift", 0.0, 1e-9);
        }
        assert!(run.get("disc.angle") > TAU);
    }
}

/// A lever turns on its cam: the velocity of the contact and the balance of both bodies. Derivatives of the slip speed
/// are those of differences.
#[test]
fn a_turning_follower_rubs_on_its_cam() {
    let (law, pivot, mu) = ("polynomial_4567", Vec2::new(0.14, 0.03), 0.2);
    for is_flat in [true, false] {
        let follower = if is_flat { json!({ "follower": "flat" }) } else { parsed(ROLLER) };
        let own = json!({ "static_coefficient": mu, "kinetic_coefficient": mu });
        let text = parsed(&oscillating(law, follower.with(own)))
            .with(json!({ "friction": friction([mu; 2], [0.0; 2]).with(json!({ "law": "stick" })) }))
            .to_string();
        let mut run = Run::new(&text).started();
        let mut slips = [0.0; 2];
        for step in 0..40 {
            run.repeats(|run| run.step(0.01));
            let what = format!("flat {is_flat}, step {step}");
            let [theta, omega, alpha] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("disc.{o}")));
            let [phi, psi] = ["angle", "acceleration"].map(|o| run.get(&format!("lever.{o}")));
            let [_, s1, _] = lift(law, 0.25, theta + 0.3);
            let arm = turned(Vec2::new(0.16, 0.0), phi);
            let (r, n) = if is_flat {
                let along = arm / 0.16;
                let normal = turned(along, if along.perp(&-pivot) > 0.0 { -PI / 2.0 } else { PI / 2.0 });
                let rate = |r: Vec2, ratio: f64| ratio * normal.dot(&turned(r, PI / 2.0));
                (pivot - rate(pivot, 1.0) / (rate(along, 1.0) + rate(along, s1)) * along, normal)
            } else {
                let center = pivot + arm;
                let relative = -s1 * turned(arm, PI / 2.0) - turned(center, PI / 2.0);
                let normal = turned(relative, PI / 2.0).normalize();
                (center - 0.01 * normal, normal)
            };
            let t = turned(n, -PI / 2.0);
            let slip = t.dot(&(-s1 * turned(r - pivot, PI / 2.0) - turned(r, PI / 2.0))) * omega;
            assert_near(run.get("cam.slip_speed"), slip, 1e-11 * slip.abs(), &what);
            let contact = run.get("cam.contact_force");
            let given = contact * n - mu * contact.abs() * slip.signum() * t;
            let size = 10.0 * contact.abs().max(1.0);
            assert_near(0.004 * alpha, -0.5 - r.perp(&given), 1e-11 * size, &what);
            assert_near(0.3 * 0.16 * 0.16 / 3.0 * psi, 1.5 + (r - pivot).perp(&given), 1e-11 * size, &what);
            run.near("energy.drift", 0.0, 1e-9);
            // Central difference over 2 us.
            let derivative = run.derivative("cam.slip_speed");
            for (slip, h) in slips.iter_mut().zip([1e-6, 2e-6]) {
                let mut ahead = run.clone();
                ahead.step(h);
                *slip = ahead.get("cam.slip_speed");
            }
            let now = run.get("cam.slip_speed");
            let difference = (4.0 * slips[0] - slips[1] - 3.0 * now) / 2e-6;
            assert_near(derivative, difference, 1e-6 * alpha.abs().max(100.0), &what);
        }
    }
}

#[test]
fn what_cannot_rub_is_refused() {
    let own = json!({ "follower": "flat", "kinetic_coefficient": 0.2 });
    let cam = parsed(&translating("cycloidal", own));
    assert_says(refusal(cam.clone()), &["couplings.cam.kinetic_coefficient", "add the key `friction`"]);
    let sticking = json!({ "friction": friction([0.1; 2], [0.0; 2]).with(json!({ "law": "stick" })) });
    assert_says(refusal(cam.clone().with(sticking.clone())), &["couplings.cam.kinetic_coefficient", "0.1", "0.2"]);
    let grooved = json!({ "couplings": { "cam": { "grooved": true } } }).with(sticking);
    assert_says(refusal(cam.with(grooved)), &["couplings.cam.kinetic_coefficient", "groove"]);

    let gears = elliptic(json!({ "eccentricity": 0.3, "pressure_angle": 0.3 }));
    let gears = parsed(&gears).with(json!({ "friction": friction([0.1; 2], [0.01, 0.1]) }));
    assert_says(refusal(gears), &["couplings.mesh.pressure_angle", "elliptic gears"]);
}

/// Gears with losses on pins that rub: the friction belongs to the reported reactions, with the force that pushes the
/// teeth apart. Without friction of the pins, the motion is that of the file without the key `friction`. Gears that
/// lock themselves hold the spring.
#[test]
fn teeth_with_losses_press_the_pins() {
    for (back, mu, enabled) in [(0.5, 0.2, true), (0.0, 0.2, true), (0.5, 0.2, false), (0.0, 0.0, true)] {
        let more = json!({
            "couplings": { "mesh": { "efficiency": 0.8, "backward_efficiency": back } },
            "springs": { "coil": { "joint": "b", "stiffness": 40, "free_angle": 0.8 } }, "start": { "speed": 40 },
        });
        let text = gears(0.0, 0.0, mu, more.with(json!({ "friction": { "enabled": enabled } })));
        let mut bare = text.clone();
        bare.as_object_mut().unwrap().remove("friction");
        ["a", "b"].iter().for_each(|joint| drop(bare["joints"][joint].as_object_mut().unwrap().remove("pin_radius")));
        let [mut run, mut bare] = [text, bare].map(|text| Run::new(text).started());
        for _ in 0..60 {
            run.step(0.01);
            bare.step(0.01);
            run.near("energy.drift", 0.0, 1e-9);
            if enabled && mu > 0.0 {
                let [torque, force] = ["b.friction_torque", "b.force"].map(|name| run.get(name).abs());
                let limit = mu * RHO[1] * force;
                let is_at_limit =
                    if run.is("friction.sticking") { torque <= limit } else { (torque - limit).abs() < 1e-9 };
                assert!(is_at_limit, "{torque} {limit}");
            } else {
                for name in ["one.angle", "a.force", "mesh.force"] {
                    run.near(name, bare.get(name), 1e-9);
                }
            }
        }
        assert_eq!(run.is("friction.sticking"), back == 0.0);
    }
}
