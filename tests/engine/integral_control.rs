//! Integral parts of controllers: closed form of the third order, no deviation under a constant load, anti-windup
//! against another integration, setting off from static friction at the instant, linearisation, saved states, changes
//! between steps, refusals.
use crate::stiction;
use crate::support::definition::{G, With, arm, block, weight, wheel};
use crate::support::numeric::{exponential, runge_kutta};
use crate::support::{Run, assert_near, assert_rejected};
use linkage_fmu::component::{Component, Linearisation, Linearised};
use nalgebra::{Complex, Matrix4, Matrix5, Vector4, Vector5};
use serde_json::{Value, json};

pub const INERTIA: f64 = 0.2;
pub const GAIN: f64 = 30.0;
pub const SPEED_GAIN: f64 = 2.2;
pub const INTEGRAL_GAIN: f64 = 45.0;

/// A rotor at 0 with a servo with these further keys of its controller, integrated to 1e-12.
pub fn controlled(more: Value) -> Value {
    let control = json!({ "position_gain": GAIN, "speed_gain": SPEED_GAIN });
    wheel(INERTIA).with(json!({
        "actuators": { "servo": { "joint": "hub", "torque": 0, "control": control.with(more) } },
        "solver": { "tolerance": 1e-12 },
    }))
}

fn rotor(more: Value) -> Value {
    controlled(json!({ "integral_gain": INTEGRAL_GAIN }).with(more))
}

/// The matrix of (angle, speed, integral part, 1) of the rotor under a command and a constant torque.
fn system(command: f64, command_speed: f64, torque: f64) -> Matrix4<f64> {
    let j = INERTIA;
    let push = GAIN * command + SPEED_GAIN * command_speed + torque;
    let rates = [
        [0.0, 1.0, 0.0, 0.0],
        [-GAIN / j, -SPEED_GAIN / j, 1.0 / j, push / j],
        [-INTEGRAL_GAIN, 0.0, 0.0, INTEGRAL_GAIN * command],
        [0.0; 4],
    ];
    Matrix4::from_fn(|row, column| rates[row][column])
}

#[test]
fn a_rotor_moves_as_its_third_order_response() {
    let start = Vector4::new(0.0, 0.0, 3.0, 1.0);
    let control = json!({ "command": 0.4, "command_speed": 0.1, "start_integral": 3 });
    for count in [1, 7, 40] {
        let mut run = Run::new(rotor(control.clone())).with(&[("servo.torque", -2.0)]).started();
        run.near("servo.integral_torque", 3.0, 0.0);
        for k in 1..=count {
            let h = 2.0 / f64::from(count);
            run.step(h);
            let y = exponential(system(0.4, 0.1, -2.0) * (h * f64::from(k)), start);
            let torque = -2.0 + GAIN * (0.4 - y[0]) + SPEED_GAIN * (0.1 - y[1]) + y[2];
            run.near("wheel.angle", y[0], 1e-11);
            run.near("wheel.speed", y[1], 1e-10);
            run.near("servo.integral_torque", y[2], 1e-9);
            run.near("servo.integral_torque_rate", INTEGRAL_GAIN * (0.4 - y[0]), 1e-9);
            run.near("servo.acting_torque", torque, 1e-9);
            run.near("wheel.acceleration", torque / INERTIA, 1e-8);
            run.near("energy.drift", 0.0, 1e-10);
        }
    }
}

/// Two drives of one joint, each with an integral part: one system of the fourth order.
#[test]
fn two_integral_parts_are_two_states() {
    let other = json!({ "joint": "hub", "control": {
        "position_gain": 10, "integral_gain": 20, "command": -0.2, "start_integral": -1 } });
    let text = rotor(json!({ "command": 0.5 })).with(json!({ "actuators": { "other": other } }));
    let mut run = Run::new(text).started();
    let j = INERTIA;
    let mut a = Matrix5::zeros();
    (a[(0, 1)], a[(1, 1)], a[(1, 2)], a[(1, 3)]) = (1.0, -SPEED_GAIN / j, 1.0 / j, 1.0 / j);
    (a[(1, 0)], a[(1, 4)]) = (-(GAIN + 10.0) / j, (GAIN * 0.5 - 10.0 * 0.2) / j);
    (a[(2, 0)], a[(2, 4)], a[(3, 0)], a[(3, 4)]) = (-INTEGRAL_GAIN, INTEGRAL_GAIN * 0.5, -20.0, -20.0 * 0.2);
    let start = Vector5::new(0.0, 0.0, 0.0, -1.0, 1.0);
    for k in 1..=8 {
        run.step(0.15);
        let y = exponential(a * (0.15 * f64::from(k)), start);
        run.near("wheel.angle", y[0], 1e-10);
        run.near("servo.integral_torque", y[2], 1e-9);
        run.near("other.integral_torque", y[3], 1e-9);
        run.near("energy.drift", 0.0, 1e-10);
    }
}

/// The weight of an arm leaves no deviation, and the integral part is the torque that holds the arm.
#[test]
fn a_constant_load_leaves_no_deviation() {
    let control = json!({ "position_gain": 60, "speed_gain": 8, "integral_gain": 80, "command": 0.3 });
    let text = arm(0.6, 4.0, -1.2).with(json!({
        "gravity": weight(), "actuators": { "servo": { "joint": "pivot", "control": control } },
        "solver": { "tolerance": 1e-10 },
    }));
    let mut run = Run::new(text).started();
    run.steps(4, 30.0);
    run.near("arm.angle", 0.3, 1e-9);
    run.near("servo.integral_torque", 0.5 * 4.0 * G * 0.6 * 0.3_f64.cos(), 1e-7);
    run.near("servo.holding_torque", 0.5 * 4.0 * G * 0.6 * 0.3_f64.cos(), 1e-7);
    run.near("energy.drift", 0.0, 1e-6);
}

/// The rotor from rest at 0 to the command 1 within limits, integrated with small steps of another method: angle, speed
/// and integral part at the end, and the largest angle.
fn limited(limits: [f64; 2], tracking: f64, span: f64) -> ([f64; 3], f64) {
    let rates = |y: [f64; 3]| {
        let demanded = GAIN * (1.0 - y[0]) - SPEED_GAIN * y[1] + y[2];
        let torque = demanded.clamp(limits[0], limits[1]);
        [y[1], torque / INERTIA, INTEGRAL_GAIN * (1.0 - y[0]) + (torque - demanded) / tracking]
    };
    from_rest(rates, span)
}

/// The state after a motion from 0, and the largest first component on the way.
pub fn from_rest<const N: usize>(rates: impl Fn([f64; N]) -> [f64; N], span: f64) -> ([f64; N], f64) {
    let (mut y, mut most) = ([0.0; N], 0.0_f64);
    for _ in 0..400 {
        y = runge_kutta(|_, y| rates(y), y, span / 400.0, 1000);
        most = most.max(y[0]);
    }
    (y, most)
}

#[test]
fn the_integral_part_tracks_the_limits_of_the_force() {
    let limits = [-1.0, 1.5];
    let span = 3.0;
    let text = |more: Value| rotor(json!({ "command": 1, "min_force": limits[0], "max_force": limits[1] }).with(more));
    for (more, tracking) in [(json!({}), GAIN / INTEGRAL_GAIN), (json!({ "tracking_time": 0.05 }), 0.05)] {
        let (expected, _) = limited(limits, tracking, span);
        for count in [1, 13, 300] {
            let mut run = Run::new(text(more.clone())).started();
            run.near("servo.acting_torque", limits[1], 0.0);
            run.near("servo.integral_torque_rate", INTEGRAL_GAIN - (GAIN - limits[1]) / tracking, 1e-10);
            run.steps(count, span);
            run.near("wheel.angle", expected[0], 1e-8);
            run.near("wheel.speed", expected[1], 1e-8);
            run.near("servo.integral_torque", expected[2], 1e-7);
            run.near("energy.drift", 0.0, 1e-9);
        }
    }
    // Without anti-windup the overshoot would be larger.
    let overshoot = |tracking: f64| limited(limits, tracking, span).1;
    assert!(overshoot(GAIN / INTEGRAL_GAIN) < 0.8 * overshoot(1e9), "{}", overshoot(1e9));
}

/// Static friction holds the block at its place, while the integral part grows at a constant rate, until it breaks away
/// at the instant that follows.
#[test]
fn a_block_breaks_away_when_the_integral_part_has_grown() {
    let control = json!({ "position_gain": 10, "speed_gain": 5, "integral_gain": 20 });
    let text =
        stiction::block(0.0, 0.0).with(json!({ "actuators": { "motor": { "joint": "slide", "control": control } } }));
    let mut run = Run::new(&text).started();
    let place = run.get("slide.position");
    let (error, breakaway) = (0.2, 0.3 * 2.0 * G);
    run.set("motor.command", place + error);
    breaks_away(&mut run, (breakaway - 10.0 * error) / (20.0 * error), "motor.integral_force", 20.0 * error);
    // Then it hunts: it slips, and sticks again beyond the command.
    let (mut stuck, mut passed) = (0, 0);
    for _ in 0..400 {
        run.step(0.05);
        stuck += u32::from(run.get("slide.speed") == 0.0);
        passed += u32::from(run.get("slide.position") > place + error);
        run.near("energy.drift", 0.0, 1e-6);
    }
    assert!(stuck > 50 && passed > 50, "{stuck} {passed}");
}

/// The block rests for this time while a part of the force grows at this rate, and then moves.
#[track_caller]
pub fn breaks_away(run: &mut Run, time: f64, force: &str, rate: f64) {
    let place = run.get("slide.position");
    for k in 1..=9 {
        run.step(0.111 * time);
        assert_eq!([run.get("slide.position"), run.get("slide.speed")], [place, 0.0]);
        run.near(force, rate * 0.111 * time * f64::from(k), 1e-10);
        run.near("slide.acceleration", 0.0, 0.0);
    }
    run.step(0.00099 * time);
    assert_eq!(run.get("slide.position"), place);
    run.step(0.0005 * time);
    assert!(run.get("slide.speed") > 0.0);
}

/// At a rigid stop the force comes to its limit, and the integral part to the value with which it stays there.
#[test]
fn a_stop_holds_the_block_while_the_integral_part_goes_on() {
    let control =
        json!({ "position_gain": 100, "speed_gain": 20, "integral_gain": 300, "command": 1, "max_force": 60 });
    let text = block(2.0).with(json!({
        "actuators": { "motor": { "joint": "slide", "control": control } },
        "stops": { "wall": { "joint": "slide", "position": 0.2, "limit": "upper" } },
        "solver": { "tolerance": 1e-12 },
    }));
    let mut run = Run::new(&text).started();
    run.steps(5, 1.0);
    let before = run.get("motor.integral_force");
    assert_eq!(run.get("slide.speed"), 0.0);
    run.near("wall.force", -60.0, 1e-12);
    // dI/dt = (60 - 20 * 0 - I) / T_t with T_t = 1 / 3.
    run.step(0.4);
    run.near("motor.integral_force", 60.0 + (before - 60.0) * (-1.2_f64).exp(), 1e-9);
    run.set("motor.command", 0.1);
    run.steps(40, 16.0);
    run.near("slide.position", 0.1, 1e-8);
    run.near("motor.integral_force", 0.0, 1e-6);
}

/// A lock holds the block. The force comes to its limit there, which the integral part then approaches.
#[test]
fn a_limit_that_is_reached_at_rest_counts() {
    let control =
        json!({ "position_gain": 100, "speed_gain": 20, "integral_gain": 300, "command": 0.5, "max_force": 60 });
    let text = block(2.0).with(json!({
        "actuators": { "motor": { "joint": "slide", "control": control } },
        "stops": { "wall": { "joint": "slide", "position": 0.2, "limit": "upper" } },
        "locks": { "latch": { "stop": "wall", "at": "block.origin" } },
        "solver": { "tolerance": 1e-12 },
    }));
    let mut run = Run::new(&text).with(&[("latch.engage", true)]).started();
    run.step(0.2);
    run.near("slide.position", 0.2, 1e-12);
    assert!(run.get("slide.speed") == 0.0 && run.get("motor.acting_force") < 60.0);
    run.step(6.0);
    // dI/dt = 300 * 0.3 + 3 (60 - 30 - I) beyond the limit.
    run.near("motor.integral_force", 60.0, 1e-5);
    run.near("motor.acting_force", 60.0, 0.0);
}

/// The servo of a rotor linearised at its start, by command, commanded speed and torque: matrices A, B, C and D, and
/// eigenvalues that are the roots of a polynomial of the third degree.
pub fn assert_linear(
    definition: &Value,
    (outputs, held_by): ([&str; 2], Option<&str>),
    matrices: [&[[f64; 3]]; 4],
    polynomial: [f64; 4],
) -> Linearised {
    let mut model = Component::from_definition("mechanism.json", &definition.to_string()).unwrap();
    let find = |name: &str| model.interface().find(name).unwrap();
    let asked = Linearisation {
        coordinate: find("wheel.angle"),
        inputs: ["command", "command_speed", "torque"].map(|name| find(&format!("servo.{name}"))).to_vec(),
        outputs: outputs.map(find).to_vec(),
        held_by: held_by.map(find),
    };
    let at = model.linearise_here(&asked).unwrap();
    for (found, expected) in [&at.a, &at.b, &at.c, &at.d].into_iter().zip(matrices) {
        assert_eq!(found.len(), expected.len());
        for (value, exact) in found.iter().flatten().zip(expected.as_flattened()) {
            assert_near(*value, *exact, 1e-10 * (1.0 + exact.abs()), "matrix");
        }
    }
    assert_eq!(at.eigenvalues.len(), 3);
    let roots = at.eigenvalues.iter().map(|[re, im]| Complex::new(*re, *im));
    for s in roots.clone() {
        let residual = polynomial.into_iter().fold(Complex::<f64>::ZERO, |sum, factor| sum * s + factor);
        assert!(residual.norm() < 1e-9 * (1.0 + s.norm().powi(3)), "{s}: {residual}");
    }
    // All three, each once.
    let product = -polynomial[3] / polynomial[0];
    assert_near(roots.product::<Complex<f64>>().re, product, 4e-11 * product.abs(), "product of the eigenvalues");
    at
}

#[test]
fn a_controlled_rotor_has_its_eigenvalues_and_matrices() {
    let j = INERTIA;
    let rows = [[0.0, 1.0, 0.0], [-GAIN / j, -SPEED_GAIN / j, 1.0 / j], [-INTEGRAL_GAIN, 0.0, 0.0]];
    let columns = [[0.0, GAIN / j, INTEGRAL_GAIN], [0.0, SPEED_GAIN / j, 0.0], [0.0, 1.0 / j, 0.0]];
    let outputs = [[-GAIN, -SPEED_GAIN, 1.0], [0.0, 0.0, 1.0]];
    let passed = [[GAIN, SPEED_GAIN, 1.0], [0.0, 0.0, 0.0]];
    assert_linear(
        &rotor(json!({ "command": 0.1 })),
        (["servo.acting_torque", "servo.integral_torque"], None),
        [&rows, &columns, &outputs, &passed],
        [j, SPEED_GAIN, GAIN, INTEGRAL_GAIN],
    );
}

/// Rates of outputs in time and derivatives by inputs, between the limits and at one.
#[test]
fn derivatives_of_outputs_count_the_integral_part() {
    for (limit, at_limit) in [(1e6, false), (0.5, true)] {
        let mut run = Run::new(rotor(json!({ "command": 0.4, "max_force": limit }))).started();
        run.step(0.05);
        let [angle, speed, integral] = ["wheel.angle", "wheel.speed", "servo.integral_torque"].map(|n| run.get(n));
        let demanded = GAIN * (0.4 - angle) - SPEED_GAIN * speed + integral;
        assert_eq!(demanded > limit, at_limit);
        let (torque, tracking) = (demanded.min(limit), INTEGRAL_GAIN / GAIN);
        let acceleration = torque / INERTIA;
        let rate = INTEGRAL_GAIN * (0.4 - angle) + tracking * (torque - demanded);
        let demanded_rate = -GAIN * speed - SPEED_GAIN * acceleration + rate;
        let torque_rate = if at_limit { 0.0 } else { demanded_rate };
        for (name, expected) in [
            ("servo.integral_torque", rate),
            ("servo.acting_torque", torque_rate),
            ("wheel.acceleration", torque_rate / INERTIA),
            ("servo.integral_torque_rate", -INTEGRAL_GAIN * speed + tracking * (torque_rate - demanded_rate)),
        ] {
            assert_near(run.derivative(name), expected, 1e-9 * (1.0 + expected.abs()), name);
        }
    }
}

#[test]
fn a_saved_state_continues_with_its_integral_part() {
    let control = json!({ "command": 1, "min_force": -1, "max_force": 1.5 });
    let mut run = Run::new(rotor(control)).started();
    for _ in 0..6 {
        run.step(0.13);
        run.clone().repeats(|run| run.steps(3, 0.4));
    }
}

/// A gain that changes between two steps changes the rate of the integral part, which does not jump itself.
#[test]
fn gains_of_the_integral_part_are_tunable() {
    let mut run = Run::new(rotor(json!({ "command": 0.4 }))).started();
    run.step(0.3);
    let [angle, integral] = ["wheel.angle", "servo.integral_torque"].map(|name| run.get(name));
    run.set_all(&[("servo.control.integral_gain", 0.0)]);
    run.near("servo.integral_torque", integral, 0.0);
    run.near("servo.integral_torque_rate", 0.0, 0.0);
    run.step(0.2);
    run.near("servo.integral_torque", integral, 1e-12);
    assert!(run.get("wheel.angle") != angle);
    run.near("energy.drift", 0.0, 1e-9);
}

#[test]
fn what_is_no_integral_part_is_refused() {
    let integrating = json!({ "position_gain": 1, "integral_gain": 2 });
    let servo = json!({ "actuators": { "servo": { "joint": "hub", "control": integrating } } });
    assert_rejected("integral parts", wheel(INERTIA).with(servo));
}
