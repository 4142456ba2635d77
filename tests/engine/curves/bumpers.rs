//! Curves over the depth: of bumpers.
use super::{MASS, body, joint, names};
use crate::support::Run;
use crate::support::numeric::runge_kutta;
use linkage_fmu::numerics::monotone::monotone;
use linkage_fmu::numerics::piecewise::Piecewise;
use serde_json::json;

const BUFFER: [[f64; 2]; 5] = [[0.0, 0.0], [0.02, 15.0], [0.05, 90.0], [0.06, 90.0], [0.1, 800.0]];

#[test]
fn a_progressive_bumper_returns_the_energy_it_absorbs() {
    let law = monotone(&BUFFER).unwrap();
    for (is_rotary, limit, sign) in [(false, "upper", 1.0), (false, "lower", -1.0), (true, "upper", 1.0)] {
        for speed in [0.4, 1.7, 4.0] {
            let mut text = body(is_rotary, [0.0, sign * speed]);
            let value = if is_rotary { "angle" } else { "position" };
            let mut stop = json!({ "joint": joint(is_rotary), "limit": limit, "rigid": false, "points": BUFFER });
            stop[value] = json!(sign * 0.3);
            text["stops"] = json!({ "buffer": stop });
            let mut run = Run::new(&text).started();
            let [position, rate] = names(is_rotary);
            let (mut deepest, mut h) = (0.0_f64, 0.0);
            while run.get(rate) * sign > -0.5 * speed || run.get(position) * sign > 0.3 {
                run.step(1e-3);
                h += 1e-3;
                let depth = run.get(position) * sign - 0.3;
                deepest = deepest.max(depth);
                let push = run.get(if is_rotary { "buffer.torque" } else { "buffer.force" });
                assert!((push + sign * law.at(depth)[0] * f64::from(u8::from(depth > 0.0))).abs() < 1e-6, "{push}");
                // The kinetic energy at the start minus the present kinetic energy is the energy stored in the bumper.
                let stored = if depth > 0.0 { law.integral(depth) } else { 0.0 };
                let kinetic = run.get("energy.kinetic");
                assert!((kinetic + stored - 0.5 * MASS * speed * speed).abs() < 1e-9, "{depth}");
                assert!(h < 5.0);
            }
            assert!((run.get(rate) + sign * speed).abs() < 1e-9, "{}", run.get(rate));
            assert_eq!(run.get("buffer.impact_count"), 1.0);
            assert!((run.get("buffer.impact_time") - 0.3 / speed).abs() < 1e-9);
            assert!(run.get("energy.drift").abs() < 1e-10, "{:e}", run.get("energy.drift"));
            assert!(deepest > 0.01, "{deepest}");
        }
    }
}

#[test]
fn a_damped_bumper_with_a_curve_lets_go_where_its_push_ends() {
    let law = monotone(&BUFFER).unwrap();
    let mut text = body(false, [0.3, 2.0]);
    text["stops"] = json!({ "buffer": { "joint": "slide", "limit": "upper", "position": 0.3, "rigid": false,
        "damping": 25,
                                        "stiffness": 40, "points": BUFFER } });
    let mut run = Run::new(&text).started();
    let (mut y, h) = ([0.0, 2.0], 1e-5);
    let mut pushes = true;
    let rate = |pushes: bool| {
        move |_: f64, [x, v]: [f64; 2], law: &Piecewise| {
            let push = if pushes { law.at(x)[0] + 40.0 * x + 25.0 * v } else { 0.0 };
            [v, -push / MASS]
        }
    };
    for k in 1..=200 {
        run.step(2e-3);
        for _ in 0..200 {
            y = runge_kutta(|t, y| rate(pushes)(t, y, &law), y, h, 1);
            pushes &= law.at(y[0])[0] + 40.0 * y[0] + 25.0 * y[1] > 0.0;
        }
        // The end of the contact is located to within one step of the reference method.
        run.near("slide.position", 0.3 + y[0], 1e-6);
        assert!((run.get("slide.speed") - y[1]).abs() < 1e-5, "{k} {} {}", run.get("slide.speed"), y[1]);
    }
    assert!(!pushes && run.get("buffer.force") == 0.0 && run.get("slide.position") > 0.3 - 2.0 && y[1] < -0.1);
    assert!(run.get("energy.drift").abs() < 1e-9);
}
