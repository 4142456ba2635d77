//! Forces of controlled drives that follow with a time constant and at a limited rate: closed form of a ramp, matrix
//! exponential, another integration with all limits, setting off from static friction at the instant, start values,
//! linearisation, derivatives, saved states, refusals.
use crate::integral_control::{GAIN, INERTIA, INTEGRAL_GAIN, SPEED_GAIN};
use crate::integral_control::{assert_linear, breaks_away, controlled, from_rest};
use crate::stiction;
use crate::support::definition::{G, With, arm, block, weight, wheel};
use crate::support::numeric::exponential;
use crate::support::{Run, assert_near, assert_rejected};
use linkage_fmu::component::Component;
use nalgebra::{Matrix5, Vector5};
use serde_json::{Value, json};

const TIME: f64 = 0.02;

/// A rotor at 0 with a servo whose torque follows with [`TIME`].
fn rotor(more: Value) -> Value {
    controlled(json!({ "force_time_constant": TIME }).with(more))
}

/// A block of 2 kg whose force is that of the input, at a limited rate.
fn pushed(rate: f64) -> Value {
    let control = json!({ "speed_gain": 0, "force_time_constant": TIME, "max_force_rate": rate });
    block(2.0).with(json!({
        "actuators": { "motor": { "joint": "slide", "control": control } }, "solver": { "tolerance": 1e-12 },
    }))
}

/// A step of the demanded force from 0 to 40 N, and back to -10 N: the force is a ramp, then approaches its end.
#[test]
fn a_step_of_the_input_is_a_ramp_of_the_force() {
    let (rate, force) = (100.0, 40.0);
    // F_u - F = R T at the end of the ramp.
    let ramp = force / rate - TIME;
    let impulse = |t: f64| {
        let s = t - ramp;
        let ([v, x], left) = ([0.5 * rate * ramp * ramp, rate * ramp.powi(3) / 6.0], rate * TIME);
        match s > 0.0 {
            false => [rate * t, 0.5 * rate * t * t, rate * t.powi(3) / 6.0],
            true => {
                let decay = (-s / TIME).exp();
                let lost = left * TIME * (1.0 - decay);
                let all = x + v * s + 0.5 * force * s * s - left * TIME * s + TIME * lost;
                [force - left * decay, v + force * s - lost, all]
            }
        }
    };
    for count in [1, 7, 40] {
        let mut run = Run::new(pushed(rate)).started();
        run.set("motor.force", force);
        let place = run.get("slide.position");
        run.near("motor.acting_force", 0.0, 0.0);
        run.near("motor.acting_force_rate", rate, 0.0);
        for k in 1..=count {
            let t = 0.5 * f64::from(k) / f64::from(count);
            run.step(0.5 / f64::from(count));
            let [now, speed, path] = impulse(t);
            run.near("motor.acting_force", now, 1e-9);
            run.near("motor.acting_force_rate", if t < ramp { rate } else { (force - now) / TIME }, 1e-7);
            run.near("slide.speed", speed / 2.0, 1e-10);
            run.near("slide.position", place + path / 2.0, 1e-11);
            run.near("energy.drift", 0.0, 1e-10);
        }
        run.set("motor.force", -10.0);
        let before = run.get("motor.acting_force");
        run.step(0.1);
        run.near("motor.acting_force", before - 10.0, 1e-9);
    }
}

/// Angle, speed, integral part, torque: a system of the fourth order, from a torque that is that of the controller.
#[test]
fn a_rotor_moves_as_its_fourth_order_response() {
    let (j, command, feed) = (INERTIA, 0.4, -2.0);
    let start = Vector5::new(0.0, 0.0, 3.0, feed + GAIN * command + 3.0, 1.0);
    let mut a = Matrix5::zeros();
    (a[(0, 1)], a[(1, 3)]) = (1.0, 1.0 / j);
    (a[(2, 0)], a[(2, 4)]) = (-INTEGRAL_GAIN, INTEGRAL_GAIN * command);
    let demanded = [-GAIN, -SPEED_GAIN, 1.0, -1.0, feed + GAIN * command];
    demanded.into_iter().enumerate().for_each(|(k, gain)| a[(3, k)] = gain / TIME);
    let text = rotor(json!({ "command": command, "integral_gain": INTEGRAL_GAIN, "start_integral": 3 }));
    for count in [1, 7, 40] {
        let mut run = Run::new(&text).with(&[("servo.torque", feed)]).started();
        for k in 0..=count {
            let h = 2.0 / f64::from(count);
            let y = exponential(a * (h * f64::from(k)), start);
            run.near("wheel.angle", y[0], 1e-11);
            run.near("wheel.speed", y[1], 1e-10);
            run.near("servo.integral_torque", y[2], 1e-9);
            run.near("servo.acting_torque", y[3], 1e-9);
            run.near("servo.acting_torque_rate", (a.row(3) * y)[0], 1e-6);
            run.near("wheel.acceleration", y[3] / j, 1e-8);
            run.near("energy.drift", 0.0, 1e-10);
            run.step(h);
        }
    }
}

/// The rotor to the command 1 with limits of the torque and of its rate and with an integral part, integrated with
/// small steps of another method: angle, speed, integral part and torque at the end, and the largest angle.
fn limited(limits: [f64; 2], rate: f64, tracking: f64, span: f64) -> ([f64; 4], f64) {
    let rates = |y: [f64; 4]| {
        let demanded = GAIN * (1.0 - y[0]) - SPEED_GAIN * y[1] + y[2];
        let change = (demanded.clamp(limits[0], limits[1]) - y[3]).clamp(-rate * TIME, rate * TIME);
        let integral = INTEGRAL_GAIN * (1.0 - y[0]) + (y[3] + change - demanded) / tracking;
        [y[1], y[3] / INERTIA, integral, change / TIME]
    };
    from_rest(rates, span)
}

#[test]
fn limits_of_force_and_rate_act_with_an_integral_part() {
    let (rate, span) = (8.0, 3.0);
    let names = ["wheel.angle", "wheel.speed", "servo.integral_torque", "servo.acting_torque"];
    let own = json!({ "integral_gain": INTEGRAL_GAIN, "max_force_rate": rate, "command": 1, "start_force": 0 });
    for (keys, limits) in
        [(json!({ "min_force": -1, "max_force": 1.5 }), [-1.0, 1.5]), (json!({}), [f64::NEG_INFINITY, f64::INFINITY])]
    {
        let (expected, most) = limited(limits, rate, GAIN / INTEGRAL_GAIN, span);
        let text = rotor(own.clone().with(keys));
        for count in [1, 13, 300] {
            let mut run = Run::new(&text).started();
            run.steps(count, span);
            for (name, exact) in names.into_iter().zip(expected) {
                run.near(name, exact, 1e-7 * (1.0 + exact.abs()));
            }
            run.near("energy.drift", 0.0, 1e-9);
        }
        // The anti-windup counts what the limit of the rate takes away.
        assert!(most < 0.9 * limited(limits, rate, 1e9, span).1, "{most}");
    }
}

/// Static friction holds the block while the force rises, until it breaks away at the instant that follows.
#[test]
fn a_block_breaks_away_when_the_force_has_risen() {
    let rate = 20.0;
    let control = json!({ "speed_gain": 0, "force_time_constant": TIME, "max_force_rate": rate });
    let text =
        stiction::block(0.0, 0.0).with(json!({ "actuators": { "motor": { "joint": "slide", "control": control } } }));
    let mut run = Run::new(&text).started();
    run.set("motor.force", 50.0);
    breaks_away(&mut run, 0.3 * 2.0 * G / rate, "motor.acting_force", rate);
}

/// The force starts as that of the controller under the inputs of the start, or as stated.
#[test]
fn the_force_starts_without_a_change_or_as_stated() {
    let text = rotor(json!({ "command": 0.4, "command_speed": 1, "max_force": 20 }));
    let mut run = Run::new(&text).with(&[("servo.torque", 1.0)]).started();
    run.near("servo.acting_torque", 1.0 + GAIN * 0.4 + SPEED_GAIN, 1e-12);
    run.near("servo.acting_torque_rate", 0.0, 0.0);
    let mut run = Run::new(&text).with(&[("servo.torque", 9.0)]).started();
    run.near("servo.acting_torque", 20.0, 0.0);
    let mut run = Run::new(rotor(json!({ "command": 0.4, "start_force": -5 }))).started();
    run.near("servo.acting_torque", -5.0, 0.0);
    run.near("servo.acting_torque_rate", (GAIN * 0.4 + 5.0) / TIME, 1e-9);
}

/// At an equilibrium the delayed torque holds the arm: nothing moves.
#[test]
fn an_equilibrium_is_that_of_the_force_without_a_delay() {
    let control = json!({ "position_gain": 60, "speed_gain": 8, "command": 0.3, "force_time_constant": TIME });
    let text = arm(0.6, 4.0, -1.2).with(json!({
        "gravity": weight(), "actuators": { "servo": { "joint": "pivot", "control": control } },
        "start": { "equilibrium": true }, "solver": { "tolerance": 1e-10 },
    }));
    let mut run = Run::new(&text).with(&[("servo.command", 0.5)]).started();
    let angle = run.get("arm.angle");
    let torque = 0.5 * 4.0 * G * 0.6 * angle.cos();
    assert_near(60.0 * (0.5 - angle), torque, 1e-9, "balance");
    run.near("servo.acting_torque", torque, 1e-9);
    run.near("servo.holding_torque", torque, 1e-12);
    run.steps(5, 1.0);
    run.near("arm.angle", angle, 1e-9);
}

#[test]
fn a_delayed_servo_has_its_eigenvalues_and_matrices() {
    let text = rotor(json!({ "command": 0.1, "max_force_rate": 50 }));
    let j = INERTIA;
    let rows = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0 / j], [-GAIN / TIME, -SPEED_GAIN / TIME, -1.0 / TIME]];
    let columns = [[0.0, 0.0, GAIN / TIME], [0.0, 0.0, SPEED_GAIN / TIME], [0.0, 0.0, 1.0 / TIME]];
    let at = assert_linear(
        &text,
        (["servo.acting_torque", "wheel.acceleration"], Some("servo.torque")),
        [&rows, &columns, &[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0 / j]], &[[0.0; 3]; 2]],
        [TIME * j, j, SPEED_GAIN, GAIN],
    );
    // Held at rest, the torque of the servo is 0.
    assert_near(at.acceleration, 0.0, 1e-12, "acceleration");
    assert_near(at.holding.unwrap(), -GAIN * 0.1, 1e-12, "holding torque");
    // An equilibrium is that of the torque without a delay.
    let all = Run::new(&text).started().equilibria().unwrap();
    assert!(all.iter().any(|found| found.is_stable && (found.stiffness - GAIN / j).abs() < 1e-9), "{all:?}");
}

/// Rates of outputs in time, within the limit of the rate and at it.
#[test]
fn derivatives_of_outputs_count_the_force() {
    for (most, at_limit) in [(1e6, false), (5.0, true)] {
        let mut run = Run::new(rotor(json!({ "command": 0.4, "start_force": 1, "max_force_rate": most }))).started();
        run.step(0.004);
        let [angle, speed, torque] = ["wheel.angle", "wheel.speed", "servo.acting_torque"].map(|n| run.get(n));
        let demanded = GAIN * (0.4 - angle) - SPEED_GAIN * speed;
        assert_eq!((demanded - torque).abs() / TIME > most, at_limit);
        let rate = ((demanded - torque) / TIME).clamp(-most, most);
        let slope = if at_limit { 0.0 } else { (-GAIN * speed - SPEED_GAIN * torque / INERTIA - rate) / TIME };
        for (name, expected) in
            [("servo.acting_torque", rate), ("wheel.acceleration", rate / INERTIA), ("servo.acting_torque_rate", slope)]
        {
            assert_near(run.derivative(name), expected, 1e-9 * (1.0 + expected.abs()), name);
        }
    }
}

/// Outputs are the states of model exchange, in the order of the states.
#[test]
fn the_states_of_model_exchange_are_in_order() {
    let text = rotor(json!({ "integral_gain": INTEGRAL_GAIN }));
    let model = Component::from_definition("mechanism.json", &text.to_string()).unwrap();
    let all = model.continuous_time().unwrap();
    let name = |reference: &u32| model.interface().list()[*reference as usize].name.clone();
    let names = |list: &[u32]| list[2..].iter().map(name).collect::<Vec<_>>();
    assert_eq!(names(&all.states), ["servo.integral_torque", "servo.acting_torque"]);
    assert_eq!(names(&all.derivatives), ["servo.integral_torque_rate", "servo.acting_torque_rate"]);
}

#[test]
fn a_saved_state_continues_with_its_force() {
    let control = json!({ "command": 1, "max_force": 3, "max_force_rate": 20, "start_force": 0 });
    let mut run = Run::new(rotor(control)).started();
    for _ in 0..6 {
        run.step(0.13);
        run.clone().repeats(|run| run.steps(3, 0.4));
    }
}

/// A rate that changes between two steps changes the rate of the force, which does not jump itself.
#[test]
fn the_rate_of_the_force_is_tunable() {
    let mut run = Run::new(pushed(100.0)).started();
    run.set("motor.force", 40.0);
    run.step(0.1);
    run.set_all(&[("motor.control.max_force_rate", 30.0)]);
    run.near("motor.acting_force", 10.0, 1e-12);
    run.near("motor.acting_force_rate", 30.0, 0.0);
    run.step(0.1);
    run.near("motor.acting_force", 13.0, 1e-10);
    run.near("energy.drift", 0.0, 1e-9);
}

#[test]
fn what_is_no_delayed_force_is_refused() {
    let delayed = json!({ "position_gain": 1, "force_time_constant": 0.1 });
    let servo = json!({ "actuators": { "servo": { "joint": "hub", "control": delayed } } });
    assert_rejected("delayed forces", wheel(INERTIA).with(servo));
}
