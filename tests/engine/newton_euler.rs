//! Reactions of the gear against Newton and Euler's equations of each body, from positions, accelerations and joint
//! forces alone: nothing of the engine's reduction is used, the geometry is written out again from the paper's table.
//! With friction its torques, with air the drag, act on the bodies too.

use crate::support::{Run, Vec2, changed, turned, without_stops};
use proptest::prelude::*;
use serde_json::json;

/// Acceleration of a point fixed in a body at `arm` from a point that accelerates by `base`.
fn acceleration(base: Vec2, arm: Vec2, omega: f64, alpha: f64) -> Vec2 {
    base + alpha * Vec2::new(-arm.y, arm.x) - omega * omega * arm
}

/// One mass point or rod: mass, moment of inertia about its centre, position of its centre, acceleration of its centre.
struct Part {
    mass: f64,
    inertia: f64,
    position: Vec2,
    acceleration: Vec2,
}

/// Largest violation of a body's balance, relative to its largest force: parts, turning acceleration, forces at
/// positions, couples; moments about the origin of the mechanism frame.
fn imbalance(parts: &[Part], alpha: f64, forces: &[(Vec2, Vec2)], couple: f64, gravity: Vec2) -> f64 {
    let (mut force, mut moment, mut size) = (Vec2::zeros(), couple, couple.abs());
    for (position, f) in forces {
        force += f;
        moment += position.perp(f);
        size = size.max(f.norm());
    }
    for p in parts {
        let need = p.mass * (p.acceleration - gravity);
        force -= need;
        moment -= p.inertia * alpha + p.position.perp(&need);
        size = size.max(need.norm()).max((p.inertia * alpha).abs());
    }
    force.norm().max(moment.abs()) / size
}

fn worst_imbalance(start: f64, speed: f64, loads: [f64; 6], friction: bool, airspeed: f64) -> f64 {
    let names = ["actuator.force", "load_factor", "wheel.force_x", "wheel.force_y", "crank.torque", "follower.torque"];
    let text = changed(&without_stops(), |m| m["friction"]["enabled"] = json!(friction));
    let mut gear = Run::shared(&text).with(&[("airspeed", airspeed)]);
    names.iter().zip(loads).for_each(|(name, value)| gear.set(name, value));
    gear.place(("crank.start_angle", start), ("crank.start_speed", speed));
    gear.step(2e-4);
    let mut get = |name: &str| gear.get(name);
    let body = ["crank", "coupler", "follower"]
        .map(|b| (get(&format!("{b}.angle")), get(&format!("{b}.speed")), get(&format!("{b}.acceleration"))));
    let joint = [1, 2, 3, 4].map(|j| Vec2::new(get(&format!("joint{j}.force_x")), get(&format!("joint{j}.force_y"))));
    let friction = [1, 2, 3, 4].map(|j| get(&format!("joint{j}.friction_torque")));
    let along = |length: f64, angle: f64| turned(Vec2::new(length, 0.0), angle);
    let drag = ["leg.drag", "wheel.drag"].map(|name| along(get(name), 1.13 - std::f64::consts::FRAC_PI_2));
    let [(th2, w2, a2), (th3, w3, a3), (th4, w4, a4)] = body;
    let (a, d) = (Vec2::zeros(), Vec2::new(0.5729, 0.0));
    let (ab, bc, dc) = (along(0.1755, th2), along(0.217, th3), along(0.34, th4));
    let (b, c) = (a + ab, d + dc);
    let chi = std::f64::consts::FRAC_PI_2 - 1.13;
    let [force, factor, fx, fy, t1, t2] = loads;
    let gravity = -factor * 9.81 * Vec2::new(chi.sin(), chi.cos());
    let rod = |mass: f64, length: f64, from: Vec2, base: Vec2, along: Vec2, omega: f64, alpha: f64| Part {
        mass,
        inertia: mass * length * length / 12.0,
        position: from + 0.5 * along,
        acceleration: acceleration(base, 0.5 * along, omega, alpha),
    };
    let zero = Vec2::zeros();
    let leg = along(0.759, th2 - 2.4);
    let wheel = Part { mass: 19.5, inertia: 0.0, position: leg, acceleration: acceleration(zero, leg, w2, a2) };
    let (p, q) = (turned(Vec2::new(-0.050, -0.138), th2), d + turned(Vec2::new(0.020, 0.120), th4));
    let push = force * (q - p).normalize();
    let base_b = acceleration(zero, ab, w2, a2);
    let crank = imbalance(
        &[rod(13.689, 0.1755, a, zero, ab, w2, a2), rod(36.8, 0.759, a, zero, leg, w2, a2), wheel],
        a2,
        &[(a, joint[0]), (b, -joint[1]), (p, -push), (leg, Vec2::new(fx, fy) + drag[1]), (0.5 * leg, drag[0])],
        t1 + friction[0] - friction[1],
        gravity,
    );
    let coupler = imbalance(
        &[rod(0.72037056, 0.217, b, base_b, bc, w3, a3)],
        a3,
        &[(b, joint[1]), (c, -joint[2])],
        friction[1] - friction[2],
        gravity,
    );
    let follower = imbalance(
        &[rod(3.850704, 0.34, d, zero, dc, w4, a4)],
        a4,
        &[(d, joint[3]), (c, joint[2]), (q, push)],
        t2 + friction[2] + friction[3],
        gravity,
    );
    crank.max(coupler).max(follower)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn every_body_is_in_balance_without_and_with_friction_and_drag(
        start in -1.3..1.3f64,
        speed in -60.0..60.0f64,
        loads in [-4e4..4e4f64, -6.0..6.0f64, -5e3..5e3f64, -5e3..5e3f64, -4e3..4e3f64, -4e3..4e3f64],
        airspeed in -90.0..90.0f64,
    ) {
        for (friction, airspeed) in [(false, 0.0), (true, airspeed)] {
            let worst = worst_imbalance(start, speed, loads, friction, airspeed);
            prop_assert!(worst < 1e-10, "imbalance {worst:e}");
        }
    }
}
