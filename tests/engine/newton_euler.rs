//! Reactions of the gear against Newton and Euler's equations of each body, from positions, accelerations and joint
//! forces alone: nothing of the engine's reduction is used, the geometry is written out again from the paper's table.
//! With friction its torques, with air the drag, act on the bodies too.

use linkage_fmu::mechanism::Model;
use proptest::prelude::*;
use std::sync::OnceLock;

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");

type Vector = [f64; 2];

fn turn([x, y]: Vector, angle: f64) -> Vector {
    let (s, c) = angle.sin_cos();
    [c * x - s * y, s * x + c * y]
}

fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

fn cross(a: Vector, b: Vector) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Acceleration of a point fixed in a body at `arm` from a point that accelerates by `base`.
fn acceleration(base: Vector, arm: Vector, omega: f64, alpha: f64) -> Vector {
    [base[0] - alpha * arm[1] - omega * omega * arm[0], base[1] + alpha * arm[0] - omega * omega * arm[1]]
}

/// One mass point or rod: mass, moment of inertia about its centre, place of its centre, acceleration of its centre.
struct Part {
    mass: f64,
    inertia: f64,
    place: Vector,
    acceleration: Vector,
}

/// Largest violation of a body's balance, relative to its largest force: parts, turning acceleration, forces at places,
/// couples; moments about the origin of the mechanism frame.
fn imbalance(parts: &[Part], alpha: f64, forces: &[(Vector, Vector)], couple: f64, gravity: Vector) -> f64 {
    let (mut force, mut moment, mut size) = ([0.0; 2], couple, couple.abs());
    for (place, f) in forces {
        force = plus(force, *f);
        moment += cross(*place, *f);
        size = size.max(f[0].hypot(f[1]));
    }
    for p in parts {
        let need = [p.mass * (p.acceleration[0] - gravity[0]), p.mass * (p.acceleration[1] - gravity[1])];
        force = minus(force, need);
        moment -= p.inertia * alpha + cross(p.place, need);
        size = size.max(need[0].hypot(need[1])).max((p.inertia * alpha).abs());
    }
    force[0].hypot(force[1]).max(moment.abs()) / size
}

/// The gear without its stops.
fn free() -> String {
    GEAR.replace("\"flag\"", "\"enabled\": false, \"flag\"")
}

/// With or without friction; shared by the cases: the tables are built once.
fn gear(friction: bool) -> Model {
    static MODELS: [OnceLock<Model>; 2] = [OnceLock::new(), OnceLock::new()];
    let build = || {
        let mut model = Model::from_json(&free()).unwrap();
        let reference = model.variables().find("friction.enabled").unwrap();
        model.set_boolean(reference, friction).unwrap();
        model.initialize().unwrap();
        model
    };
    MODELS[usize::from(friction)].get_or_init(build).clone()
}

fn worst_imbalance(start: f64, speed: f64, loads: [f64; 6], friction: bool, airspeed: f64) -> f64 {
    let mut model = gear(friction);
    let names = ["actuator.force", "load_factor", "wheel.force_x", "wheel.force_y", "crank.torque", "follower.torque"];
    for (name, value) in names.iter().zip(loads) {
        let reference = model.variables().find(name).unwrap();
        model.set_real(reference, value).unwrap();
    }
    for (name, value) in [("crank.start_angle", start), ("crank.start_speed", speed), ("airspeed", airspeed)] {
        let reference = model.variables().find(name).unwrap();
        model.set_real(reference, value).unwrap();
    }
    model.initialize().unwrap();
    model.step(2e-4).unwrap();
    let mut get = |name: &str| {
        let reference = model.variables().find(name).unwrap();
        model.real(reference).unwrap()
    };
    let body = ["crank", "coupler", "follower"]
        .map(|b| (get(&format!("{b}.angle")), get(&format!("{b}.speed")), get(&format!("{b}.acceleration"))));
    let joint = [1, 2, 3, 4].map(|j| [get(&format!("joint{j}.force_x")), get(&format!("joint{j}.force_y"))]);
    let rub = [1, 2, 3, 4].map(|j| get(&format!("joint{j}.friction_torque")));
    let drag = ["leg.drag", "wheel.drag"].map(|name| turn([get(name), 0.0], 1.13 - std::f64::consts::FRAC_PI_2));
    let [(th2, w2, a2), (th3, w3, a3), (th4, w4, a4)] = body;
    let (a, d) = ([0.0, 0.0], [0.5729, 0.0]);
    let (ab, bc, dc) = (turn([0.1755, 0.0], th2), turn([0.217, 0.0], th3), turn([0.34, 0.0], th4));
    let (b, c) = (plus(a, ab), plus(d, dc));
    let chi = std::f64::consts::FRAC_PI_2 - 1.13;
    let [force, factor, fx, fy, t1, t2] = loads;
    let gravity = [-factor * 9.81 * chi.sin(), -factor * 9.81 * chi.cos()];
    let rod = |mass: f64, length: f64, from: Vector, base: Vector, along: Vector, omega: f64, alpha: f64| Part {
        mass,
        inertia: mass * length * length / 12.0,
        place: plus(from, [0.5 * along[0], 0.5 * along[1]]),
        acceleration: acceleration(base, [0.5 * along[0], 0.5 * along[1]], omega, alpha),
    };
    let zero = [0.0, 0.0];
    let leg = turn([0.759, 0.0], th2 - 2.4);
    let wheel = Part { mass: 19.5, inertia: 0.0, place: leg, acceleration: acceleration(zero, leg, w2, a2) };
    let (p, q) = (turn([-0.050, -0.138], th2), plus(d, turn([0.020, 0.120], th4)));
    let pq = minus(q, p);
    let length = pq[0].hypot(pq[1]);
    let push = [force * pq[0] / length, force * pq[1] / length];
    let negative = |v: Vector| [-v[0], -v[1]];
    let base_b = acceleration(zero, ab, w2, a2);
    let crank = imbalance(
        &[rod(13.689, 0.1755, a, zero, ab, w2, a2), rod(36.8, 0.759, a, zero, leg, w2, a2), wheel],
        a2,
        &[
            (a, joint[0]),
            (b, negative(joint[1])),
            (p, negative(push)),
            (leg, plus([fx, fy], drag[1])),
            ([0.5 * leg[0], 0.5 * leg[1]], drag[0]),
        ],
        t1 + rub[0] - rub[1],
        gravity,
    );
    let coupler = imbalance(
        &[rod(0.72037056, 0.217, b, base_b, bc, w3, a3)],
        a3,
        &[(b, joint[1]), (c, negative(joint[2]))],
        rub[1] - rub[2],
        gravity,
    );
    let follower = imbalance(
        &[rod(3.850704, 0.34, d, zero, dc, w4, a4)],
        a4,
        &[(d, joint[3]), (c, joint[2]), (q, push)],
        t2 + rub[2] + rub[3],
        gravity,
    );
    crank.max(coupler).max(follower)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn every_body_is_in_balance(
        start in -1.3..1.3f64,
        speed in -60.0..60.0f64,
        loads in [-4e4..4e4f64, -6.0..6.0f64, -5e3..5e3f64, -5e3..5e3f64, -4e3..4e3f64, -4e3..4e3f64],
    ) {
        let worst = worst_imbalance(start, speed, loads, false, 0.0);
        prop_assert!(worst < 1e-10, "imbalance {worst:e}");
    }

    #[test]
    fn every_body_is_in_balance_with_friction_and_drag(
        start in -1.3..1.3f64,
        speed in -60.0..60.0f64,
        loads in [-4e4..4e4f64, -6.0..6.0f64, -5e3..5e3f64, -5e3..5e3f64, -4e3..4e3f64, -4e3..4e3f64],
        airspeed in -90.0..90.0f64,
    ) {
        let worst = worst_imbalance(start, speed, loads, true, airspeed);
        prop_assert!(worst < 1e-10, "imbalance {worst:e}");
    }
}
