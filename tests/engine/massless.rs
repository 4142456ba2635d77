//! Definitions without masses: kinematics against closed forms and against the same mechanism with masses; missing
//! variables, rejected definitions. No output depends on the nominal metric.
use crate::support::definition::{self, With, block, weight};
use crate::support::{
    CURVES, FOUR_BAR, GEAR, JIB, Run, TAILGATE, Vec2, assert_near, assert_says, changed, reals, refusal, turned, values,
};
use linkage_fmu::mechanism::inspection::inspect;
use linkage_fmu::variables::Causality;
use serde_json::{Value, json};
use std::f64::consts::TAU;

const SPEED: f64 = -7.0;

/// Remove every mass and inertia.
fn massless(mut definition: Value) -> Value {
    for (_, body) in definition["bodies"].as_object_mut().unwrap() {
        for key in ["mass", "inertia", "shape", "center"] {
            body.as_object_mut().unwrap().remove(key);
        }
    }
    definition
}

/// A crank at constant speed about a joint.
fn turning(joint: &str) -> Value {
    json!({ "motor": { "joint": joint, "motion": { "profile": "constant_speed", "speed": SPEED } } })
}

fn four_bar() -> Value {
    let rods = definition::four_bar([0.1, 0.04, 0.12, 0.08], [0.7, 0.36, 1.0]);
    rods.with(json!({ "actuators": turning("a"), "markers": { "m": { "at": "coupler.p" } },
        "bodies": { "coupler": { "points": { "p": [0.05, 0.03] } } } }))
}

fn cross(a: Vec2, b: Vec2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Rates (w1, w2) with w1 n1 + w2 n2 = b, where n = (-y, x) of an arm.
fn rates([one, other]: [Vec2; 2], b: Vec2) -> [f64; 2] {
    // Each unknown by the product with the other arm.
    [b.dot(&other) / cross(one, other), b.dot(&one) / cross(other, one)]
}

/// Angle, speed and acceleration of coupler and rocker, from the intersection of two circles and the differentiated
/// loop equation.
fn two_circles([ground, crank, coupler, rocker]: [f64; 4], angle: f64, speed: f64) -> [[f64; 3]; 2] {
    let left = |v: Vec2| Vec2::new(-v.y, v.x);
    let a = turned(Vec2::new(crank, 0.0), angle);
    let to = Vec2::new(ground, 0.0) - a;
    let d = to.norm();
    // The joint C is to the left of the line from the crank's pin to the rocker's pivot.
    let along = (d * d + coupler * coupler - rocker * rocker) / (2.0 * d);
    let c = to / d * along + left(to / d) * (coupler * coupler - along * along).sqrt();
    let e = a + c - Vec2::new(ground, 0.0);
    // a' + w left(c) = v left(e); a'' + w' left(c) - w^2 c = v' left(e) - v^2 e.
    let [w, v] = rates([c, -e], -speed * left(a));
    let [alpha, beta] = rates([c, -e], speed * speed * a + w * w * c - v * v * e);
    [[c.y.atan2(c.x), w, alpha], [e.y.atan2(e.x), v, beta]]
}

#[test]
fn a_four_bar_at_constant_speed_is_that_of_two_circles() {
    let lengths = [0.1, 0.04, 0.12, 0.08];
    let mut run = Run::new(massless(four_bar())).started();
    for k in 0..=120 {
        let angle = 0.7 + SPEED * run.0.time();
        run.near("crank.angle", angle, 1e-12);
        run.near("motor.angle", angle, 1e-12);
        run.near("motor.speed", SPEED, 1e-11);
        run.near("motor.acceleration", 0.0, 1e-10);
        let [coupler, rocker] = two_circles(lengths, angle, SPEED);
        for (name, [exact, speed, acceleration]) in [("coupler", coupler), ("rocker", rocker)] {
            run.near(&format!("{name}.angle"), exact, 1e-12);
            run.near(&format!("{name}.speed"), speed, 1e-10);
            run.near(&format!("{name}.acceleration"), acceleration, 1e-8);
        }
        // A marker on the coupler.
        let arm = turned(Vec2::new(0.05, 0.03), coupler[0]);
        let crank = turned(Vec2::new(0.04, 0.0), angle);
        let [at, v] = [crank + arm, SPEED * turned(crank, TAU / 4.0) + coupler[1] * turned(arm, TAU / 4.0)];
        let second = -SPEED * SPEED * crank + coupler[2] * turned(arm, TAU / 4.0) - coupler[1] * coupler[1] * arm;
        for (suffix, exact, allowed) in [("", at, 1e-13), ("velocity_", v, 1e-11), ("acceleration_", second, 1e-9)] {
            run.near(&format!("m.{suffix}x"), exact.x, allowed);
            run.near(&format!("m.{suffix}y"), exact.y, allowed);
        }
        // More than one turn, in steps of different sizes.
        run.step(if k % 2 == 0 { 0.001 } else { 0.019 });
    }
}

/// Without power and energy no quantity limits the length of a step ahead. A long run stays fast and exact.
#[test]
fn a_long_run_is_exact_in_steps_of_any_size() {
    for (steps, h) in [(20_000, 0.01), (1, 200.0)] {
        let mut run = Run::new(massless(four_bar())).started();
        (0..steps).for_each(|_| run.step(h));
        let angle = 0.7 + SPEED * 200.0;
        run.near("crank.angle", angle, 1e-9);
        run.near("rocker.acceleration", two_circles([0.1, 0.04, 0.12, 0.08], angle, SPEED)[1][2], 1e-6);
    }
}

#[test]
fn a_slider_crank_at_constant_speed_is_that_of_the_closed_form() {
    let (r, l) = (0.1, 0.35);
    let bodies = [json!({ "length": r }), json!({ "length": l }), json!({})];
    let definition = definition::slider_crank(bodies, 0.3).with(json!({ "actuators": turning("bearing") }));
    let mut run = Run::new(definition).started();
    for _ in 0..100 {
        let (s, c) = (0.3 + SPEED * run.0.time()).sin_cos();
        // x = r c + w, w^2 = l^2 - r^2 s^2.
        let w = (l * l - r * r * s * s).sqrt();
        let w_first = -r * r * s * c / w;
        let w_second = (-r * r * (c * c - s * s) - w_first * w_first) / w;
        run.near("guide.position", r * c + w, 1e-12);
        run.near("guide.speed", SPEED * (w_first - r * s), 1e-11);
        run.near("guide.acceleration", SPEED * SPEED * (w_second - r * c), 1e-9);
        run.step(0.0137);
    }
}

/// Positions, speeds and accelerations do not depend on masses: the nominal metric only changes the parameter of the
/// curve.
#[test]
fn the_same_mechanism_with_masses_moves_the_same() {
    let gear = serde_json::from_str::<Value>(GEAR).unwrap();
    let tailgate = serde_json::from_str::<Value>(TAILGATE).unwrap();
    let smooth = |distance: f64| json!({ "profile": "polynomial_345", "duration": 0.9, "distance": distance });
    let cases = [four_bar(), gear.with(json!({ "actuators": { "actuator": { "motion": smooth(0.3) } } })), tailgate];
    for (k, mut heavy) in cases.into_iter().enumerate() {
        if k == 2 {
            // The tailgate has no drive.
            let joint = heavy["joints"].as_object().unwrap().keys().next().unwrap().clone();
            heavy = heavy.with(json!({ "actuators": { "hand": { "joint": joint, "motion": smooth(0.4) } } }));
        }
        let mut with = Run::new(&heavy).started();
        let mut without = Run::new(massless(heavy)).started();
        let kinematic = reals(&without, Causality::Output);
        let names: Vec<String> =
            kinematic.iter().map(|reference| without.variables().get(*reference).unwrap().name.clone()).collect();
        assert!(names.len() > 8, "{names:?}");
        let mut largest = vec![0.0_f64; names.len()];
        let mut errors = vec![0.0_f64; names.len()];
        for _ in 0..40 {
            let light = values(&mut without, &kinematic);
            for (i, (name, value)) in names.iter().zip(light).enumerate() {
                let heavy = with.get(name);
                largest[i] = largest[i].max(heavy.abs());
                errors[i] = errors[i].max((heavy - value).abs());
            }
            with.step(0.025);
            without.step(0.025);
        }
        for (i, name) in names.iter().enumerate() {
            let limit = 1e-12 * largest[i].max(1.0);
            assert!(errors[i] <= limit, "{name}: {:e} of {:e}", errors[i], largest[i]);
        }
    }
}

#[test]
fn variables_that_need_masses_do_not_exist_and_the_error_states_why() {
    let loaded = massless(four_bar()).with(json!({
        "gravity": weight(), "forces": { "push": { "at": "coupler.end" } }, "torques": { "turn": { "on": "rocker" } },
        "friction": { "enabled": true, "static_coefficient": 0.2, "kinetic_coefficient": 0.1 }, "linearisation": true,
        "joints": { "a": { "pin_radius": 0.01 } }, "actuators": { "motor": { "torque": 3, "efficiency": 0.9 } },
        "air": { "density": 1.2, "flow_angle": 0 }, "solver": { "method": "reduced", "tolerance": 1e-9 },
        "surfaces": { "sail": { "from": "rocker.origin", "to": "rocker.end", "width": 0.1, "drag_coefficient": 1 } },
        "stops": { "end": { "body": "rocker", "limit": "upper", "angle": 3.0, "flag": "there" } },
        "locks": { "hook": { "stop": "end", "at": "coupler.end" } },
    }));
    let run = Run::new(&loaded).started();
    let of = |causality: Causality| {
        let list = run.variables().list().iter().filter(move |v| v.causality == causality);
        list.map(|v| v.name.as_str()).collect::<Vec<_>>()
    };
    assert_eq!(of(Causality::Input), Vec::<&str>::new());
    let allowed = "angle speed acceleration there x y velocity_x velocity_y acceleration_x acceleration_y";
    let others: Vec<&str> = of(Causality::Output)
        .into_iter()
        .filter(|name| !allowed.split(' ').any(|own| name.rsplit('.').next() == Some(own)))
        .collect();
    assert_eq!(others, Vec::<&str>::new());
    let parameters = of(Causality::Parameter);
    for absent in ["mass", "inertia", "pin_radius", "friction", "gravity", "efficiency", "density", "method"] {
        assert!(!parameters.iter().any(|name| name.contains(absent)), "{absent}: {parameters:?}");
    }
    let warnings = run.warnings().join("\n");
    let idle = "gravity forces.push torques.turn friction linearisation actuators.motor.torque \
        actuators.motor.efficiency air surfaces.sail locks.hook solver.method";
    for key in idle.split(' ') {
        assert!(
            warnings.contains(&format!("{key}: this key has no effect, because no body has a mass")),
            "{key}\n{warnings}"
        );
    }
    // A mass of 0 counts as no mass.
    let zero = massless(four_bar()).with(json!({ "bodies": { "crank": { "mass": 0 }, "rocker": { "inertia": 0 } } }));
    assert_eq!(Run::new(zero).variables().list().len(), Run::new(massless(four_bar())).variables().list().len());
}

#[test]
fn without_a_motion_there_is_a_travel_and_no_run() {
    let mut still = massless(four_bar());
    still["actuators"]["motor"].as_object_mut().unwrap().remove("motion");
    let mut run = Run::new(&still).started();
    run.near("crank.angle", 0.7, 1e-15);
    assert!(run.variables().find("crank.acceleration").is_none() && run.variables().find("m.acceleration_x").is_none());
    let before = run.saved();
    assert_says(run.0.step(0.1).unwrap_err(), &["no body has a mass", "one of coupler, crank, rocker", "key `motion`"]);
    assert_eq!(before, run.saved());
    assert_says(run.serve_exchange().unwrap_err(), &["without masses", "use co-simulation"]);
    assert_says(run.equilibria().unwrap_err(), &["no body has a mass"]);
    assert_says(run.warnings().join("\n"), &["bodies: no body has a mass and no drive has the key `motion`"]);
    let sweep = run.sweep(90).unwrap();
    assert!(sweep.is_closed);
    // The facts of `check`.
    let facts = inspect(&still.to_string());
    let text = |topic: &str| facts.facts.iter().filter(|f| f.topic.starts_with(topic)).count();
    assert_eq!([text("Reduced mass"), text("Equilibrium at"), text("Equilibria"), text("Drives")], [0, 0, 1, 1]);
    assert!(!facts.facts.iter().any(|fact| fact.quantities.iter().any(|q| q.unit.contains("kg"))));
}

/// Along the travel the rate of each output is its influence coefficient, with or without a prescribed motion.
#[test]
fn the_travel_has_the_influence_coefficients_of_the_closed_form() {
    for definition in [four_bar(), massless(four_bar())] {
        let mut run = Run::new(definition);
        run.serve_travel().unwrap();
        run.initialize();
        let [x, ..] = run.continuous_states().unwrap();
        for k in 0..40 {
            run.set_continuous_states(&[x + 0.01 * f64::from(k), 1.0]).unwrap();
            let [_, rocker] = two_circles([0.1, 0.04, 0.12, 0.08], run.get("crank.angle"), 1.0);
            let [by, of] = ["crank.angle", "rocker.angle"].map(|name| run.derivative(name));
            assert_near(of / by, rocker[1], 1e-10, "first");
            let [by_second, of_second] = ["crank.speed", "rocker.speed"].map(|name| run.derivative(name));
            assert_near((of_second - of / by * by_second) / (by * by), rocker[2], 1e-8, "second");
        }
    }
}

#[test]
fn motion_by_inputs_has_exact_derivatives_and_saved_states() {
    let mut definition = massless(four_bar());
    definition["actuators"]["motor"]["motion"] = json!({ "position": 0.7 });
    let mut run = Run::new(definition);
    let inputs = reals(&run, Causality::Input);
    let names: Vec<&str> = inputs.iter().map(|r| run.variables().get(*r).unwrap().name.as_str()).collect();
    assert_eq!(names, ["motor.motion.position", "motor.motion.speed", "motor.motion.acceleration"]);
    let [position, speed, acceleration] = [inputs[0], inputs[1], inputs[2]];
    run.set_all(&[("motor.motion.speed", 3.0), ("motor.motion.acceleration", 2.0)]);
    run.initialize();
    let unit = two_circles([0.1, 0.04, 0.12, 0.08], 0.7, 1.0)[1];
    run.near("rocker.speed", 3.0 * unit[1], 1e-12);
    run.near("rocker.acceleration", 9.0 * unit[2] + 2.0 * unit[1], 1e-10);
    let [angle, rate, second] =
        ["rocker.angle", "rocker.speed", "rocker.acceleration"].map(|n| run.variables().find(n).unwrap());
    for (of, by, exact) in [
        (angle, position, unit[1]),
        (angle, speed, 0.0),
        (rate, speed, unit[1]),
        (rate, position, 3.0 * unit[2]),
        (second, acceleration, unit[1]),
        (second, speed, 6.0 * unit[2]),
    ] {
        let mut slope = f64::NAN;
        run.directional_derivative(&[of], &[by], &[1.0], &mut |_, value| slope = value).unwrap();
        assert_near(slope, exact, 1e-9, "derivative");
    }
    run.set_derivative("motor.motion.acceleration", 1, 6.0);
    run.step(0.05);
    let now = 0.7 + 0.05 * (3.0 + 0.05 * (1.0 + 0.05));
    run.near("crank.angle", now, 1e-14);
    run.near("rocker.angle", two_circles([0.1, 0.04, 0.12, 0.08], now, 1.0)[1][0], 1e-12);
    run.repeats(|run| run.step(0.07));
}

/// The force of a spring follows from its length and speed without masses.
#[test]
fn springs_without_masses_follow_their_laws() {
    let mut light = block(1.0).with(json!({
        "springs": { "s": { "joint": "slide", "stiffness": 100, "damping": 5, "free_length": 0.1 } },
        "actuators": { "ram": { "joint": "slide",
            "motion": { "profile": "constant_speed", "speed": 0.2, "start_time": 0.5 } } },
    }));
    light["bodies"]["block"] = json!({});
    let mut run = Run::new(light).started();
    run.near("s.force", -10.0, 1e-12);
    run.near("slide.speed", 0.0, 0.0);
    run.step(1.0);
    run.near("slide.position", 0.1, 1e-13);
    run.near("s.force", 1.0, 1e-12);
    assert!(run.variables().find("energy.potential").is_none());
}

/// Gears, cams and drawings with elements of all kinds can be viewed and checked without masses.
#[test]
fn any_mechanism_without_masses_can_be_checked() {
    for text in [
        FOUR_BAR,
        GEAR,
        TAILGATE,
        JIB,
        CURVES,
        include_str!("../../modelDescription/GearTrain/resources/mechanism.json"),
        include_str!("../../modelDescription/ValveTrain/resources/mechanism.json"),
    ] {
        let mut bare = massless(serde_json::from_str(text).unwrap());
        bare["start"].as_object_mut().map(|start| start.remove("speed"));
        let inspection = inspect(&bare.to_string());
        let errors: Vec<String> =
            inspection.findings.iter().map(ToString::to_string).filter(|f| f.starts_with("error")).collect();
        assert_eq!(errors, Vec::<String>::new());
        let mut run = Run::new(&bare).started();
        assert_says(run.0.step(0.1).expect_err(bare["name"].as_str().unwrap()), &["no body has a mass"]);
        run.sweep(20).unwrap();
    }
}

#[test]
fn elements_that_need_masses_are_rejected_without_them() {
    let base = massless(four_bar());
    for (more, says) in [
        (
            json!({ "solver": { "method": "rigid_fem", "tolerance": 1e-9 } }),
            ["solver.method", "no body has a mass: give a mass to one of coupler, crank, rocker"],
        ),
        (
            json!({ "gravity": { "acceleration": 9.81, "up_angle": 0 },
                "forces": { "f": { "at": "rocker.end", "constant": true,
            "force": ["gravity.acceleration", 0] } }, "parameters": { "k": "2 * gravity.acceleration" } }),
            ["parameters.k", "uses gravity.acceleration, which has no effect"],
        ),
    ] {
        assert_says(refusal(base.clone().with(more)), &says);
    }
    let unplaced = changed(&base, |d| {
        d["actuators"] = json!({});
        d["start"] = json!("equilibrium");
    });
    assert_says(refusal(unplaced), &["start", "an equilibrium needs masses"]);
    let hydraulic: Value = serde_json::from_str(crate::support::HYDRAULIC_GEAR).unwrap();
    assert_says(refusal(massless(hydraulic)), &["actuators.actuator.hydraulics", "a hydraulic circuit needs masses"]);
    // An expression counts as a mass, also if its value is 0.
    let named = changed(base, |d| {
        d["parameters"] = json!({ "m": 0 });
        d["bodies"]["crank"]["mass"] = json!("m");
    });
    assert_says(refusal(named), &["reduced inertia is zero"]);
    // A single mass makes the definition one with masses.
    let mixed = massless(four_bar()).with(json!({ "bodies": { "crank": { "mass": 1, "center": [0.02, 0] } } }));
    Run::new(mixed).started().near("energy.kinetic", 0.5 * (0.02 * SPEED).powi(2), 1e-12);
}
