//! Conveyors, whose surface moves with a speed of its own: closed forms, balances of force, power and energy, input
//! derivatives, saved states, rejected definitions.
use crate::support::definition::{G, With, block, friction, rod, slider_crank, weight, wheel};
use crate::support::numeric::runge_kutta;
use crate::support::{Run, assert_near, assert_says, refusal};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

const MASS: f64 = 2.0;

/// A parcel of 2 kg on a level belt with this speed, with these laws of friction.
fn parcel(speed: f64, coefficients: [f64; 2], speeds: [f64; 2]) -> Value {
    block(MASS).with(json!({
        "gravity": weight(), "joints": { "slide": { "surface_speed": speed } },
        "friction": friction(coefficients, speeds), "solver": { "tolerance": 1e-12 },
    }))
}

/// Below `static_speed` the friction is viscous: the parcel follows the belt with the time constant V_S / (mu_S g).
#[test]
fn a_parcel_follows_its_belt_exponentially() {
    let (belt, time) = (0.5, 1.0 / (0.3 * G));
    for sign in [1.0, -1.0] {
        let mut run = Run::new(parcel(sign * belt, [0.3, 0.2], [1.0, 2.0])).started();
        run.near("slide.slip_speed", -sign * belt, 0.0);
        run.near("slide.friction_force", sign * 0.3 * belt * MASS * G, 1e-12);
        for k in 1..=10 {
            run.step(0.07);
            let t = 0.07 * f64::from(k);
            let rest = (-t / time).exp();
            run.near("slide.speed", sign * belt * (1.0 - rest), 1e-11);
            run.near("slide.position", sign * belt * (t - time * (1.0 - rest)), 1e-11);
            run.near("slide.slip_speed", -sign * belt * rest, 1e-11);
            let force = 0.3 * belt * rest * MASS * G;
            run.near("slide.friction_force", sign * force, 1e-10);
            run.near("slide.surface_power", force * belt, 1e-10);
            run.near("slide.force_y", MASS * G, 1e-12);
            let work = 0.5 * MASS * (belt * (1.0 - rest)).powi(2);
            run.near("energy.drift", 0.0, 1e-11 * work);
        }
    }
}

/// On a fast belt the friction is kinetic first, then that of the cubic, then viscous: each border is an event.
#[test]
fn the_regimes_of_friction_are_those_of_the_slip_on_the_belt() {
    let ([high, low], [first, last], belt) = ([0.4, 0.2], [0.1, 0.9], 3.0);
    let mut run = Run::new(parcel(belt, [high, low], [first, last])).started();
    let kinetic = (belt - last) / (low * G);
    run.step(kinetic);
    run.near("slide.speed", belt - last, 1e-11);
    let acceleration = |slip: f64| {
        let s = (slip - first) / (last - first);
        G * if slip < first { high * slip / first } else { high + (low - high) * s * s * (3.0 - 2.0 * s) }
    };
    let rate = |_: f64, [v]: [f64; 1]| [acceleration(belt - v)];
    let mut speed = [belt - last];
    for k in 0..40 {
        run.step(0.0125);
        speed = runge_kutta(rate, speed, 0.0125, 400);
        // The reference passes one border within a step of its own.
        run.near("slide.speed", speed[0], 1e-7);
        let energy = run.get("energy.kinetic");
        run.near("energy.drift", 0.0, 1e-10 * energy);
        assert!(k < 30 || run.get("slide.slip_speed").abs() < first);
    }
}

/// The speed of the belt is an input: a ramp by an input derivative gives the ramp of the parcel with its lag, in one
/// step. A parabola through all regimes gives in one step what it gives in many.
#[test]
fn the_belt_follows_its_input() {
    let (time, ramp) = (1.0 / (0.3 * G), 0.4);
    let mut run = Run::new(parcel(0.0, [0.3, 0.2], [1.0, 2.0])).started();
    run.set_derivative("slide.surface_speed", 1, ramp);
    run.step(0.8);
    let rest = (-0.8 / time).exp();
    run.near("slide.surface_speed", 0.8 * ramp, 1e-14);
    run.near("slide.speed", ramp * (0.8 - time * (1.0 - rest)), 1e-11);
    // The rate of the slip speed, which follows from the acceleration and the rate of the input.
    let acceleration = run.get("slide.acceleration");
    run.near("slide.acceleration", ramp * (1.0 - rest), 1e-11);
    assert_near(run.derivative("slide.slip_speed"), acceleration - ramp, 1e-11, "rate of the slip speed");

    let after = |steps: u32| {
        let mut run = Run::new(parcel(1.5, [0.4, 0.2], [0.1, 0.6])).started();
        run.follow("slide.surface_speed", [1.5, -8.0, 8.0], (steps, 1.5), |_, _| {});
        assert!(run.get("energy.drift").abs() < 1e-9);
        ["slide.position", "slide.speed", "slide.slip_speed"].map(|name| run.get(name))
    };
    let (one, many) = (after(1), after(83));
    one.iter().zip(many).for_each(|(one, many)| assert_near(*one, many, 1e-9, "one step and many"));
}

/// A parcel on a spring and a belt, with `static_speed` = `first`.
fn sprung(first: f64) -> Run {
    let spring = json!({ "springs": { "spring": { "joint": "slide", "stiffness": 50 } } });
    Run::new(parcel(0.1, [0.4, 0.25], [first, 2.0 * first]).with(spring)).started()
}

/// A parcel on a spring and a belt sticks and slips: the motion is that of an independent integration.
#[test]
fn a_sprung_parcel_moves_as_integrated_elsewhere() {
    let first = 1e-3;
    let mut run = sprung(first);
    let friction = |slip: f64| {
        let s = slip.abs() / first;
        let x = (s - 1.0).clamp(0.0, 1.0);
        G * (0.4 * s.min(1.0) - 0.15 * x * x * (3.0 - 2.0 * x)).copysign(slip)
    };
    let rate = |_: f64, [x, v]: [f64; 2]| [v, -25.0 * x - friction(v - 0.1)];
    let mut y = [0.0; 2];
    for _ in 0..40 {
        run.step(0.1);
        y = runge_kutta(rate, y, 0.1, 5000);
        run.near("slide.position", y[0], 1e-7);
        run.near("slide.speed", y[1], 1e-6);
    }
}

/// With `static_speed` -> 0 the friction is Coulomb's with mu_S and mu_d: the parcel moves with the belt until the
/// spring pulls with mu_S N, and then swings about mu_d N / k until it has the speed of the belt again. The period of
/// this limit cycle has a closed form.
#[test]
fn a_sprung_parcel_sticks_and_slips() {
    let (omega, belt) = (5.0, 0.1);
    let rise = 0.15 * MASS * G / 50.0;
    let period = (PI - (rise * omega / belt).atan()) * 2.0 / omega + 2.0 * rise / belt;
    let error = |first: f64| {
        let mut run = sprung(first);
        let (mut turns, mut t, mut work, h) = (Vec::new(), 0.0, 0.0, 0.004);
        while turns.len() < 3 {
            let before = run.get("slide.speed");
            run.step(h);
            t += h;
            work += h * run.get("slide.surface_power");
            let (after, rate) = (run.get("slide.speed"), run.get("slide.acceleration"));
            if before > 0.0 && after <= 0.0 {
                turns.push(t - after / rate);
            }
            run.near("energy.drift", 0.0, 1e-9 * work.max(0.1));
        }
        ((turns[2] - turns[1]) / period - 1.0).abs()
    };
    let errors = [1e-3, 1e-4, 1e-5].map(error);
    assert!(errors[0] < 1.2e-2 && errors[1] < 2.2e-3 && errors[2] < 4.5e-4, "{errors:?}");
}

/// A slider-crank whose slider lies on a belt, with a motor and gravity.
pub fn machine(speed: f64, keys: Value) -> Value {
    slider_crank([rod(0.1, 1.2), rod(0.3, 0.9), json!({ "mass": 0.5 })], 0.7)
        .with(json!({
            "joints": { "guide": { "surface_speed": speed }, "bearing": { "pin_radius": 0.01 } },
            "gravity": weight(), "actuators": { "motor": { "joint": "bearing", "torque": 1.5 } },
            "friction": friction([0.5, 0.3], [0.2, 0.8]),
            "start": { "speed": 4 }, "solver": { "tolerance": 1e-12 },
        }))
        .with(keys)
}

/// Momentum of the slider, power and energy in a mechanism, and a state that is saved under way.
#[test]
fn a_belt_drives_a_mechanism() {
    let mut run = Run::new(machine(1.5, json!({}))).started();
    let (mut saved, mut work) = (Vec::new(), 0.0);
    for k in 0..60 {
        if k == 23 {
            run.set("guide.surface_speed", 2.0);
            saved = run.saved();
        }
        run.step(0.013);
        let along = run.get("guide.friction_force");
        // The slider moves along x under its friction and the forces of both joints.
        let (force, acceleration) = (run.force("guide") + run.force("wrist"), run.get("guide.acceleration"));
        assert_near(force.y, 0.5 * G, 1e-9, "weight");
        assert_near(force.x + along, 0.5 * acceleration, 1e-9, "force along the guide");
        let speed = run.get("guide.surface_speed");
        run.near("guide.surface_power", along * speed, 1e-11);
        let slip = run.get("guide.speed") - speed;
        run.near("guide.slip_speed", slip, 1e-12);
        assert!(along * slip <= 0.0);
        work += 0.013 * run.get("guide.surface_power").abs();
        run.near("energy.drift", 0.0, 1e-9 * work);
    }
    let end = run.bits(["crank.angle", "crank.speed", "guide.friction_force", "energy.drift"]);
    let mut again = Run::new(machine(1.5, json!({}))).started();
    again.take(&saved);
    (23..60).for_each(|_| again.step(0.013));
    assert_eq!(again.bits(["crank.angle", "crank.speed", "guide.friction_force", "energy.drift"]), end);
    // A belt at rest is an ordinary guide.
    let mut still = machine(0.0, json!({}));
    let mut moved = Run::new(&still).started();
    still["joints"]["guide"].as_object_mut().unwrap().remove("surface_speed");
    let mut plain = Run::new(still).started();
    for _ in 0..20 {
        [&mut moved, &mut plain].into_iter().for_each(|run| run.step(0.02));
        for name in ["crank.angle", "crank.speed", "guide.force", "guide.friction_force", "motor.static_load"] {
            let expected = plain.get(name);
            moved.near(name, expected, 1e-10 * expected.abs().max(1.0));
        }
    }
}

/// Under a prescribed motion the force of the drive balances the belt, and moves the free mechanism alike.
#[test]
fn a_prescribed_motion_feels_the_belt() {
    let motion = json!({ "actuators": { "motor": { "motion": { "profile": "constant_speed", "speed": 3 } } } });
    let mut driven = Run::new(machine(1.5, motion).with(json!({ "start": { "speed": 3 } }))).started();
    let mut free = Run::new(machine(1.5, json!({ "start": { "speed": 3 } }))).started();
    for _ in 0..50 {
        driven.step(0.01);
        let (angle, torque) = (driven.get("crank.angle"), driven.get("motor.acting_torque"));
        free.set_all(&[("crank.start_angle", angle), ("crank.start_speed", 3.0), ("motor.torque", torque)]);
        free.initialize();
        free.near("crank.acceleration", 0.0, 1e-8);
        let force = driven.get("guide.friction_force");
        free.near("guide.friction_force", force, 1e-9);
        driven.near("energy.drift", 0.0, 1e-9);
    }
}

/// A sleeve that turns about the pin of a wheel takes the wheel along; a drive holds the wheel against the sleeve.
#[test]
fn a_sleeve_turns_a_wheel() {
    let (inertia, radius, load) = (0.2, 0.03, 40.0);
    let sleeve = wheel(inertia).with(json!({
        "joints": { "hub": { "pin_radius": radius, "surface_speed": 0.06 } },
        "forces": { "load": { "at": "wheel.origin", "force": [0, -load] } },
        "actuators": { "brake": { "joint": "hub", "torque": 0 } },
        "friction": friction([0.3, 0.2], [0.1, 0.2]), "solver": { "tolerance": 1e-12 },
    }));
    let time = inertia * 0.1 / (0.3 * load * radius * radius);
    let mut run = Run::new(&sleeve).started();
    let held = 0.3 * 0.6 * load * radius;
    run.near("hub.friction_torque", held, 1e-13);
    run.near("brake.required_force", -held, 1e-13);
    run.near("brake.breakaway_torque_forward", -held, 1e-13);
    run.near("brake.breakaway_torque_backward", -held, 1e-13);
    run.step(1.3);
    let rest = (-1.3 / time).exp();
    run.near("wheel.speed", 2.0 * (1.0 - rest), 1e-11);
    run.near("hub.slip_speed", -0.06 * rest, 1e-12);
    run.near("hub.surface_power", 0.3 * 0.6 * rest * load * 0.06, 1e-11);
    // Without friction the sleeve has no effect.
    let mut free = Run::new(sleeve).with(&[("friction.enabled", false)]).started();
    free.step(1.0);
    free.near("wheel.speed", 0.0, 0.0);
}

/// A belt that presses a parcel against a rigid stop, and pulls it off when it turns back within a step.
#[test]
fn a_belt_that_turns_back_takes_a_parcel_off_a_stop() {
    let stop = json!({ "stops": { "end": { "joint": "slide", "limit": "upper", "position": 0.1 } } });
    let mut run = Run::new(parcel(0.5, [0.3, 0.2], [1.0, 2.0]).with(stop)).started();
    run.step(3.0);
    run.near("slide.position", 0.1, 1e-12);
    run.near("end.force", -0.15 * MASS * G, 1e-10);
    run.set_derivative("slide.surface_speed", 1, -1.0);
    run.step(1.0);
    // The belt stands still after 0.5 s.
    let time = 1.0 / (0.3 * G);
    run.near("slide.speed", -(0.5 - time * (1.0 - (-0.5 / time).exp())), 1e-10);
    run.near("energy.drift", 0.0, 1e-10);
}

#[test]
fn a_belt_needs_friction() {
    let mut bare = parcel(0.5, [0.3, 0.2], [0.01, 2.0]);
    bare.as_object_mut().unwrap().remove("friction");
    assert_says(refusal(bare), &["joints.slide.surface_speed", "add the key `friction`"]);
    let pin = machine(1.0, json!({ "joints": { "wrist": { "surface_speed": 1 } } }));
    assert_says(refusal(pin), &["joints.wrist.surface_speed", "add the key `pin_radius`"]);
    let incline =
        parcel(f64::MAX, [0.3, 0.2], [0.01, 2.0]).with(json!({ "joints": { "slide": { "axis_angle": FRAC_PI_2 } } }));
    Run::new(incline).started().step(0.1);
}
