//! Equilibria and small oscillations: closed forms, finite differences, and the decay of a simulated oscillation.

use crate::support::definition::{self, G, With, arm, block, rod, weight};
use crate::support::{Run, assert_says, refusal};
use linkage_fmu::component::{Component, Linearisation, Linearised};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Rounding of a sum of a few tables, 1e-13 of their largest values each.
const ACCURACY: f64 = 1e-11;

/// A mass of 2 kg on a massless rod of 0.5 m.
fn pendulum() -> Value {
    let mut pendulum = arm(0.5, 2.0, -1.5).with(json!({
        "gravity": weight(), "actuators": { "motor": { "joint": "pivot", "torque": 0 } }, "linearisation": true,
        "start": { "angle": -1.2, "equilibrium": true },
    }));
    pendulum["bodies"]["arm"] = json!({ "length": 0.5, "mass": 2, "center": [0.5, 0] });
    pendulum
}

/// A carriage of 3 kg on a horizontal rail, with a spring and damper to the ground.
fn carriage(stiffness: f64, damping: f64) -> Value {
    let spring = json!({ "joint": "slide", "stiffness": stiffness, "damping": damping, "free_length": 0.2 });
    block(3.0).with(json!({
        "forces": { "push": { "at": "block.origin", "force": [0, 0] } }, "springs": { "spring": spring },
        "stops": {
            "left": { "joint": "slide", "position": -1, "limit": "lower" },
            "right": { "joint": "slide", "position": 1, "limit": "upper" },
        },
        "start": { "position": 0.5, "equilibrium": true }, "linearisation": true,
    }))
}

/// Linearise at the start with respect to this coordinate and these inputs and outputs.
fn here(definition: &Value, coordinate: &str, inputs: &[&str], outputs: &[&str]) -> Linearised {
    let mut model = Component::from_definition("mechanism.json", &definition.to_string()).unwrap();
    let what = asked(&model, coordinate, inputs, outputs, None);
    model.linearise_here(&what).unwrap()
}

fn asked(
    model: &Component,
    coordinate: &str,
    inputs: &[&str],
    outputs: &[&str],
    held_by: Option<&str>,
) -> Linearisation {
    let find = |name: &str| model.interface().find(name).unwrap();
    let all = |names: &[&str]| names.iter().map(|name| find(name)).collect();
    let (inputs, outputs) = (all(inputs), all(outputs));
    Linearisation { coordinate: find(coordinate), inputs, outputs, held_by: held_by.map(find) }
}

fn close(value: f64, expected: f64, scale: f64) {
    assert!((value - expected).abs() <= ACCURACY * scale, "{value} instead of {expected}");
}

#[test]
fn a_pendulum_starts_hanging_and_swings_at_the_root_of_g_over_l() {
    let mut run = Run::new(pendulum()).started();
    close(run.get("arm.angle"), -FRAC_PI_2, 1.0);
    let omega = (G / 0.5).sqrt();
    close(run.get("linearisation.eigenfrequency"), omega / TAU, 1.0);
    close(run.get("linearisation.damping_ratio"), 0.0, 1.0);
    run.step(0.5);
    close(run.get("arm.angle"), -FRAC_PI_2, 1.0);
    let at = here(&pendulum(), "arm.angle", &["motor.torque", "load_factor"], &["arm.acceleration", "arm.speed"]);
    // m l^2 theta'' = T - n m g l cos(theta), about theta = -pi / 2.
    let inertia = 2.0 * 0.25;
    close(at.a[1][0], -omega * omega, 20.0);
    assert_eq!((&*at.a[0], at.b[0][0]), (&[0.0, 1.0][..], 0.0));
    close(at.b[0][1], 1.0 / inertia, 1.0);
    close(at.b[1][1], 0.0, 20.0);
    close(at.c[0][0], -omega * omega, 20.0);
    close(at.d[0][0], 1.0 / inertia, 1.0);
    assert_eq!((&*at.c[1], &at.d[1][..]), (&[0.0, 1.0][..], &[0.0, 0.0][..]));
    close(at.eigenvalues[0][1], omega, 10.0);
}

/// Under a torque T the pendulum hangs at cos(theta) = T / (m g l). The gravity component along the rod determines its
/// frequency.
#[test]
fn inputs_before_the_end_of_the_initialisation_move_the_equilibrium_and_later_ones_do_not() {
    let mut run = Run::new(pendulum());
    let weight = 2.0 * G * 0.5;
    let theta = |torque: f64| -(torque / weight).acos();
    for torque in [3.0, -2.0] {
        run.set("motor.torque", torque);
        close(run.get("arm.angle"), theta(torque), 1.0);
    }
    let snapshot = run.snapshot();
    run.set("motor.torque", 1.0);
    run.restore(&snapshot).unwrap();
    close(run.get("arm.angle"), theta(-2.0), 1.0);
    run.initialize();
    let omega = (G / 0.5 * -theta(-2.0).sin()).sqrt();
    close(run.get("linearisation.eigenfrequency"), omega / TAU, 1.0);
    run.set("motor.torque", 1.0);
    close(run.get("arm.angle"), theta(-2.0), 1.0);
    let snapshot = run.snapshot();
    run.step(0.1);
    let moved = run.get("arm.angle");
    run.restore(&snapshot).unwrap();
    run.step(0.1);
    assert_eq!(run.get("arm.angle").to_bits(), moved.to_bits());
    // A torque larger than the moment of the weight turns the pendulum without end.
    let mut definition = pendulum();
    definition["actuators"]["motor"]["torque"] = json!(1.01 * weight);
    assert_says(
        refusal(&definition),
        &["start.equilibrium", "move the mechanism at every position", "spring or a stop"],
    );
}

#[test]
fn a_carriage_rests_where_spring_and_force_balance() {
    for damping in [0.0, 6.0, 60.0, 600.0] {
        let mut definition = carriage(300.0, damping);
        definition["forces"]["push"]["force"] = json!([45, 7]);
        let mut run = Run::new(&definition).started();
        close(run.get("slide.position"), 0.2 + 45.0 / 300.0, 1.0);
        close(run.get("linearisation.eigenfrequency"), 10.0 / TAU, 10.0);
        close(run.get("linearisation.damping_ratio"), damping / (2.0 * 3.0 * 10.0), 10.0);
        let at = here(&definition, "slide.position", &["push.force_x", "push.force_y"], &["spring.force"]);
        close(at.a[1][0], -100.0, 100.0);
        close(at.a[1][1], -damping / 3.0, 100.0);
        close(at.b[0][1], 1.0 / 3.0, 1.0);
        close(at.b[1][1], 0.0, 1.0);
        close(at.c[0][0].abs(), 300.0, 300.0);
        close(at.c[0][1].abs(), damping, 300.0);
        assert_eq!(at.d, [[0.0, 0.0]]);
        let [one, other] = [at.eigenvalues[0], at.eigenvalues[1]];
        close(one[0] + other[0], -damping / 3.0, 200.0);
        close(one[0] * other[0] - one[1] * other[1], 100.0, 1e4);
    }
}

#[test]
fn positions_without_an_equilibrium_are_rejected_with_the_reason() {
    let neutral = carriage(0.0, 0.0);
    assert_says(refusal(&neutral), &["start.equilibrium", "no load acts", "give a start position"]);
    let mut pressed = carriage(0.0, 0.0);
    pressed["forces"]["push"]["force"] = json!([-5, 0]);
    let mut run = Run::new(&pressed).started();
    close(run.get("slide.position"), -1.0, 1.0);
    run.step(0.1);
    close(run.get("slide.position"), -1.0, 1.0);
    pressed["stops"]["left"] = json!({
        "joint": "slide", "position": -1, "limit": "lower", "rigid": false, "stiffness": 1e4, "damping": 10
    });
    // The bumper balances the push of 5 N at this depth.
    close(Run::new(&pressed).started().get("slide.position"), -1.0 - 5.0 / 1e4, 1.0);
    let mut open_rail = carriage(300.0, 1.0);
    open_rail.as_object_mut().unwrap().remove("stops");
    open_rail["forces"]["push"]["force"] = json!([30_000, 0]);
    close(Run::new(&open_rail).started().get("slide.position"), 100.2, 1e3);
    for wrong in [json!("equilibrum"), json!(3), json!({ "equilibrium": true, "speed": 1 }), json!({})] {
        let mut definition = pendulum();
        definition["start"] = wrong;
        assert_says(refusal(&definition), &["start"]);
    }
}

/// The key `equilibrium` alone searches from the guess, and adds no parameters of the start.
#[test]
fn equilibrium_true_searches_from_the_guess() {
    let mut definition = pendulum();
    definition["start"] = json!("equilibrium");
    let mut run = Run::new(&definition).started();
    close(run.get("arm.angle"), -FRAC_PI_2, 1.0);
    assert!(run.0.reference("arm.start_angle").is_err());
    let inspection = Component::inspect("mechanism.json", &definition.to_string()).unwrap();
    assert_eq!(inspection.findings, []);
    let equilibria: Vec<_> = inspection.facts.iter().filter(|fact| fact.topic.starts_with("Equilibria")).collect();
    assert_eq!(equilibria.len(), 2, "{equilibria:?}");
    let stable = equilibria.iter().find(|fact| fact.text.starts_with("stable")).unwrap();
    let eigenfrequency = stable.quantities.iter().find(|quantity| quantity.unit == "Hz").unwrap();
    close(eigenfrequency.value, (G / 0.5).sqrt() / TAU, 1.0);
    assert!(equilibria.iter().any(|fact| fact.text.starts_with("unstable")));
    // A guess beyond a stop, as the rounded coordinates of a drawing: the search begins at the stop, and may end there.
    for (limit, angle, expected) in [("lower", -0.5, -0.5), ("upper", -0.2, -FRAC_PI_2)] {
        definition["guess"] = json!({ "arm": if limit == "lower" { -0.6 } else { -0.1 } });
        definition["stops"] = json!({ "s": { "body": "arm", "limit": limit, "angle": angle } });
        close(Run::new(&definition).started().get("arm.angle"), expected, 1.0);
    }
    // With `equilibrium` in an object, a change of its parameters starts a new search.
    let mut run = Run::new(pendulum());
    run.set("arm.start_angle", -1.2 + TAU);
    run.initialize();
    close(run.get("arm.angle"), -FRAC_PI_2 + TAU, 1.0);
}

/// A crank r with the moment of inertia J, a rod l without mass, and a slider of mass m. A spring of stiffness c,
/// without force at this crank angle, and a damper d act between slider and ground. About this angle: (J + m x'^2)
/// theta'' = -c x'^2 theta - d x'^2 theta', with x' = dx / dtheta of the slider.
const J: f64 = 0.002;

fn slider_crank(angle: f64, damping: f64) -> Value {
    let bodies = [json!({ "length": 0.1, "inertia": J }), json!({ "length": 0.3 }), json!({ "mass": 0.5 })];
    let machine = definition::slider_crank(bodies, angle);
    let slack = machine["guess"]["guide"].clone();
    machine.with(json!({
        "actuators": { "servo": { "joint": "bearing", "torque": 0 } },
        "springs": { "spring": { "joint": "guide", "stiffness": 200, "damping": damping, "free_length": slack } },
        "start": { "angle": angle + 0.1, "equilibrium": true }, "linearisation": true,
    }))
}

#[test]
fn a_slider_crank_with_a_spring_has_the_eigenfrequency_of_the_closed_form() {
    for (angle, damping) in [(0.9, 0.0), (1.7, 4.0), (2.4, 1.0)] {
        let definition = slider_crank(angle, damping);
        let mut run = Run::new(&definition).started();
        close(run.get("crank.angle"), angle, 1.0);
        let (r, l) = (0.1, 0.3);
        let (sin, cos) = f64::sin_cos(angle);
        let slope = -r * sin - r * r * sin * cos / (l * l - (r * sin).powi(2)).sqrt();
        let inertia = J + 0.5 * slope * slope;
        let omega = (200.0 * slope * slope / inertia).sqrt();
        let zeta = damping * slope * slope / (2.0 * inertia * omega);
        close(run.get("linearisation.eigenfrequency"), omega / TAU, 10.0);
        close(run.get("linearisation.damping_ratio"), zeta, 10.0);
        let at = here(&definition, "crank.angle", &["servo.torque"], &["guide.position", "servo.holding_torque"]);
        close(at.a[1][0], -omega * omega, 1e3);
        close(at.a[1][1], -2.0 * zeta * omega, 1e3);
        close(at.b[0][1], 1.0 / inertia, 1e3);
        close(at.c[0][0], slope, 1.0);
        // Torque that holds the crank at another angle: k (x - x0) dx / dtheta.
        close(at.c[1][0], 200.0 * slope * slope, 10.0);
    }
}

/// If a drive holds the mechanism, each position is an equilibrium. A then has the eigenvalues of the table.
#[test]
fn held_positions_are_at_rest_and_their_matrix_has_the_eigenvalues() {
    let mut model = Component::from_definition("mechanism.json", &slider_crank(1.1, 0.7).to_string()).unwrap();
    let what = asked(&model, "crank.angle", &["servo.torque"], &["guide.position"], Some("servo.torque"));
    let all = model.linearise(&what, 40).unwrap();
    assert_eq!(all.len(), 41);
    let mut checked = 0;
    for at in all.iter().filter(|at| at.a[1][0].is_finite() && at.coordinate.sin().abs() > 0.1) {
        close(at.acceleration, 0.0, 1e5);
        let [[re, im], [other_re, other_im]] = [at.eigenvalues[0], at.eigenvalues[1]];
        let scale = 1e3 + at.a[1][0].abs();
        close(at.a[1][1], re + other_re, scale);
        close(-at.a[1][0], re * other_re - im * other_im, 10.0 * scale);
        checked += 1;
    }
    assert!(checked > 20);
    let other = asked(&model, "guide.position", &[], &[], Some("servo.torque"));
    for (one, other) in all.iter().zip(model.linearise(&other, 40).unwrap()) {
        assert_eq!(
            one.eigenvalues.as_flattened().iter().map(|part| part.to_bits()).collect::<Vec<_>>(),
            other.eigenvalues.as_flattened().iter().map(|part| part.to_bits()).collect::<Vec<_>>()
        );
    }
}

/// Logarithmic decrement and period of an oscillation with an amplitude small enough for linear behaviour.
#[test]
fn a_simulated_ring_down_has_the_eigenfrequency_and_the_damping_ratio() {
    let mut definition = slider_crank(1.3, 1.2);
    definition["gravity"] = json!({ "acceleration": G, "up_angle": 0.4 });
    definition["bodies"]["rod"] = rod(0.3, 0.2);
    definition["bodies"]["crank"] = rod(0.1, 0.4);
    definition["solver"] = json!({ "tolerance": 1e-12 });
    let mut run = Run::new(&definition).started();
    let [frequency, zeta] = ["eigenfrequency", "damping_ratio"].map(|of| run.get(&format!("linearisation.{of}")));
    let rest = run.get("crank.angle");
    run.set("crank.start_speed", 1e-4);
    run.initialize();
    let (h, mut crossings, mut peaks) = (1e-4, Vec::new(), Vec::new());
    let (mut before, mut speed_before, mut time) = (0.0, 1e-4, 0.0);
    while peaks.len() < 9 {
        run.step(h);
        time += h;
        let (angle, speed) = (run.get("crank.angle") - rest, run.get("crank.speed"));
        if before < 0.0 && angle >= 0.0 {
            crossings.push(time - h * angle / (angle - before));
        }
        if speed_before > 0.0 && speed <= 0.0 {
            // Extremum of the parabola with the slopes at both points.
            peaks.push(angle - 0.5 * speed * h * speed / (speed - speed_before));
        }
        (before, speed_before) = (angle, speed);
    }
    let periods = crossings.len() - 1;
    let damped = periods as f64 / (crossings[periods] - crossings[0]);
    let decrement = (peaks[0] / peaks[8]).ln() / 8.0;
    let measured = decrement / (decrement * decrement + 4.0 * PI * PI).sqrt();
    // The amplitude is 1e-5 rad. The relative nonlinear effect is some 1e-5.
    assert!((measured / zeta - 1.0).abs() < 1e-4, "damping ratio {measured} instead of {zeta}");
    let expected = frequency * (1.0 - zeta * zeta).sqrt();
    assert!((damped / expected - 1.0).abs() < 1e-5, "{damped} Hz instead of {expected} Hz");
}

/// Matrices against finite differences of the outputs, in a state without equilibrium.
#[test]
fn matrices_are_slopes_of_the_outputs() {
    let mut definition = slider_crank(1.3, 1.2);
    definition["gravity"] = json!({ "acceleration": G, "up_angle": 0.4 });
    definition["bodies"]["rod"] = rod(0.3, 0.2);
    definition["start"] = json!({ "body": "crank", "angle": 0.8 });
    let outputs = ["crank.acceleration", "pin.force_x", "spring.force", "energy.kinetic"];
    let at = here(&definition, "crank.angle", &["servo.torque", "load_factor"], &outputs);
    let mut run = Run::new(&definition);
    let mut value = |name: &str, changed: &str, by: f64| {
        let start = run.get(changed);
        run.set(changed, start + by);
        run.initialize();
        let value = run.get(name);
        run.set(changed, start);
        value
    };
    let h = 1e-5;
    let mut slope = |name: &str, changed: &str| (value(name, changed, h) - value(name, changed, -h)) / (2.0 * h);
    for (name, (c, d)) in outputs.iter().zip(at.c.iter().zip(&at.d)) {
        let found = [c[0], c[1], d[0], d[1]];
        let variables = ["crank.start_angle", "crank.start_speed", "servo.torque", "load_factor"];
        for (found, variable) in found.into_iter().zip(variables) {
            let expected = slope(name, variable);
            assert!(
                (found - expected).abs() <= 1e-6 * (10.0 + expected.abs()),
                "{name} by {variable}: {found} {expected}"
            );
        }
    }
    assert!(at.acceleration.abs() > 1.0);
}

/// An unstable position has no eigenfrequency, and the output states the reason. Without the key `linearisation` there
/// is no such output.
#[test]
fn an_unstable_position_has_no_eigenfrequency() {
    let mut definition = pendulum();
    definition["start"] = json!({ "body": "arm", "angle": FRAC_PI_2 + 0.1 });
    let mut run = Run::new(&definition).started();
    let reason = run.undefined("linearisation.eigenfrequency");
    assert_says(&reason, &["do not return the mechanism", "arm"]);
    let at = here(&definition, "arm.angle", &[], &[]);
    assert!(at.omega.is_nan() && at.eigenvalues[1][0] * at.eigenvalues[0][0] < 0.0);
    let mut plain = pendulum();
    plain.as_object_mut().unwrap().remove("linearisation");
    assert!(Run::new(&plain).0.reference("linearisation.eigenfrequency").is_err());
}
